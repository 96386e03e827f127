/* attributes.c - texture coordinates, normals and colours while edges collapse: what it costs to move a vertex away
 * from where its attributes are, and their values at its new position.
 *
 * Source: Hoppe. New Quadric Metric for Simplifying Meshes with Appearance Attributes. 1999.
 *
 * A row is one set of attributes of a vertex. Around a vertex on a seam each side has its own. On a triangle each
 * channel is a linear function g x + d of the position. A row at x with the value s costs the sum of
 * (g x + d - s)^2 by area over the triangles that it stands for; the best s is their mean value at x, and with it
 * the cost is a quadric of x alone: the sum of (g x + d)^2 less the squared sum of g x + d by the area. Sums are
 * additive, as plane quadrics are.
 *
 * Channels are lengths: texture coordinates as long as they are on the surface, so that a texture that slides by a
 * length costs as much as the surface being off by a share of it.
 * Guarantee: a row never takes part of what lies across a seam. */
#include "core/vec3.h"
#include "mesh/facet.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

/* What an error costs beside that of the surface: of texture coordinates by their length on the surface; of
 * normals and colours by this share of the mesh's longest side for a difference of 1. */
#define UV_SHARE     0.3
#define NORMAL_SHARE 0.01
#define COLOUR_SHARE 0.01

enum {
    QUADRIC_A = 0,
    QUADRIC_B = 6,
    QUADRIC_C = 9,
    QUADRIC_W = 10,
    QUADRIC_CHANNELS = 11, /* g[3] and d of each */
    ROWS_COMPARED = 16     /* of a vertex that has very many */
};

/* ---- Rows ---- */

/* The corner of the given mesh at a corner. */
static uint64_t given_corner(const bvxi_collapse *c, int32_t corner)
{
    uint32_t const from = c->from[corner >> 2];
    uint64_t const at = 3 * (uint64_t)(from >> 2) + ((from & 3) + (uint64_t)(corner & 3)) % 3;
    return c->source != NULL ? c->source[at] : at;
}

uint32_t bvxi_given_vertex(const bvxi_collapse *c, int32_t corner)
{
    uint64_t const at = given_corner(c, corner);
    uint32_t v[3];
    bvxi_view_triangle(c->given, at / 3, v);
    return v[at % 3];
}

static int same_floats(const float *values, uint32_t i, uint32_t k, size_t count)
{
    return values == NULL || i == k ||
           memcmp(values + count * i, values + count * k, count * sizeof *values) == 0;
}

/* 1: two vertices have equal attributes. */
static int same_attributes(const bvx_mesh_view *m, uint32_t v, uint32_t w, uint32_t uv, uint32_t uw)
{
    return same_floats(m->uvs, uv, uw, 2) &&
           (v == w ||
            (same_floats(m->uvs2, v, w, 2) && same_floats(m->normals, v, w, 3) &&
             (m->colours == NULL || memcmp(m->colours + 4 * (size_t)v, m->colours + 4 * (size_t)w, 4) == 0)));
}

int bvxi_attributes_share(const bvxi_collapse *c, uint32_t row, uint32_t other)
{
    return same_attributes(c->given, c->attributes.vertex[row], c->attributes.vertex[other], 0, 0);
}

/* The row of a corner among those of its vertex, which began at first. Vertices that are kept stand for more than is
 * known here: two are one only where each corner has its own. */
static uint32_t row_of(bvxi_collapse *c, int32_t corner, uint64_t first)
{
    bvxi_attributes *const s = &c->attributes;
    uint32_t const v = bvxi_given_vertex(c, corner),
                   uv = c->given->uv_indices != NULL ? c->given->uv_indices[given_corner(c, corner)] : v;
    int const apart = c->options.given.vertices == BVX_VERTICES_KEPT &&
                      c->given->vertex_count < 3 * c->given->triangle_count;

    for (uint64_t r = s->rows; r > first && r + ROWS_COMPARED > s->rows; r--)
        if (apart ? s->vertex[r - 1] == v && s->uv[r - 1] == uv
                  : same_attributes(c->given, s->vertex[r - 1], v, s->uv[r - 1], uv))
            return (uint32_t)(r - 1);
    s->vertex[s->rows] = v;
    s->uv[s->rows] = uv;
    return (uint32_t)s->rows++;
}

static bvx_status find_rows(bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;
    bvxi_attributes *const s = &c->attributes;
    uint64_t const corners = 4 * (m->triangles + m->ghosts);

    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, corners * 4, "the corners' attributes", &s->row));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, m->triangles * 24, "the sets of attributes", &s->vertex));
    s->uv = s->vertex + 3 * m->triangles;
    memset(s->row, 0xff, (size_t)corners * 4);

    for (uint64_t v = 0; v < m->vertices; v++) {
        uint64_t const first = s->rows;
        int32_t at = c->any[v];

        do {
            if (!bvxi_corner_is_ghost(m, at)) s->row[at] = row_of(c, at, first);
            at = bvxi_corner_turn_left(m, at);
        } while (at != c->any[v]);
    }
    return BVX_OK;
}

/* ---- Channels ---- */

static double row_value(const bvxi_collapse *c, uint32_t row, int32_t channel)
{
    const bvxi_attributes *const s = &c->attributes;
    const bvx_mesh_view *const m = c->given;
    size_t const v = s->vertex[row], k = (size_t)channel;
    if (channel < s->uv2_at) return (double)m->uvs[2 * (size_t)s->uv[row] + k];
    if (channel < s->normal_at) return (double)m->uvs2[2 * v + k - (size_t)s->uv2_at];
    if (channel < s->colour_at) return (double)m->normals[3 * v + k - (size_t)s->normal_at];
    return m->colours[4 * v + k - (size_t)s->colour_at] / 255.0;
}

/* The length that a difference of 1 of texture coordinates has on the surface, in the mean. */
static double uv_length(const bvxi_collapse *c, int32_t first)
{
    const bvxi_corners *const m = &c->mesh;
    double area = 0;

    for (uint64_t t = 0; t < m->triangles; t++) {
        double uv[3][2], twice;

        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 2; i++)
                uv[k][i] = row_value(c, c->attributes.row[4 * t + (uint64_t)k], first + i);
        twice = (uv[1][0] - uv[0][0]) * (uv[2][1] - uv[0][1]) - (uv[1][1] - uv[0][1]) * (uv[2][0] - uv[0][0]);
        area += 0.5 * bvxi_absolute(twice);
    }
    return area > 0 && area - area == 0 ? sqrt(c->area / area) : 0;
}

/* ---- Sums ---- */

/* About a position that lies at an offset. */
static void move_sums(double *q, int32_t channels, const double offset[3])
{
    double y[3];

    /* g (x + offset) + d has the value d + g offset where it is centred now. */
    const double *const a = q + QUADRIC_A;
    y[0] = a[0] * offset[0] + a[1] * offset[1] + a[2] * offset[2];
    y[1] = a[1] * offset[0] + a[3] * offset[1] + a[4] * offset[2];
    y[2] = a[2] * offset[0] + a[4] * offset[1] + a[5] * offset[2];
    q[QUADRIC_C] += 2 * bvxi_vec_dot(q + QUADRIC_B, offset) + bvxi_vec_dot(y, offset);
    for (int k = 0; k < 3; k++) q[QUADRIC_B + k] += y[k];
    for (int32_t j = 0; j < channels; j++) {
        double *const g = q + QUADRIC_CHANNELS + 4 * j;

        g[3] += bvxi_vec_dot(g, offset);
    }
}

/* Both rows' sums about the first one's position; offset leads from there to the other's. */
static void join_sums(const bvxi_attributes *s, uint32_t u, uint32_t v, const double offset[3], double *both)
{
    const double *const other = s->q + (size_t)s->stride * u;
    double const back[3] = {-offset[0], -offset[1], -offset[2]};
    memcpy(both, s->q + (size_t)s->stride * v, (size_t)s->stride * sizeof *both);
    move_sums(both, s->channels, back);
    for (int32_t i = 0; i < s->stride; i++) both[i] += other[i];
}

/* The rows of an edge's two ends on both of its sides, each once; returns how many. */
static int rows_of_edge(const bvxi_collapse *c, int32_t edge, uint32_t u[2], uint32_t v[2])
{
    const uint32_t *const row = c->attributes.row;
    int32_t const across = bvxi_corner_opposite(&c->mesh, edge);
    int count = 0;

    if (row[bvxi_corner_next(edge)] != BVXI_VERTEX_NONE) {
        u[0] = row[bvxi_corner_next(edge)];
        v[0] = row[bvxi_corner_previous(edge)];
        count = 1;
    }
    if (row[bvxi_corner_previous(across)] != BVXI_VERTEX_NONE) {
        u[count] = row[bvxi_corner_previous(across)];
        v[count] = row[bvxi_corner_next(across)];
        count += count == 0 || u[1] != u[0] || v[1] != v[0];
    }
    return count;
}

int bvxi_attributes_match(const bvxi_collapse *c, int32_t edge)
{
    uint32_t u[2], v[2];
    return rows_of_edge(c, edge, u, v) < 2 || (u[0] != u[1] && v[0] != v[1]);
}

void bvxi_attributes_add(const bvxi_collapse *c, int32_t edge, const double offset[3], double a[6],
                         double b[3], double *cost)
{
    const bvxi_attributes *const s = &c->attributes;
    double both[QUADRIC_CHANNELS + 4 * ATTRIBUTE_CHANNELS];
    uint32_t u[2], v[2];
    for (int i = rows_of_edge(c, edge, u, v); i-- > 0;) {
        join_sums(s, u[i], v[i], offset, both);

        /* Add what a row costs that has its best value: a quadric of its position alone. */
        double const weight = c->options.given.attribute_weight * c->options.given.attribute_weight;
        double const share = both[QUADRIC_W] > 0 ? weight / both[QUADRIC_W] : 0;

        for (int n = 0; n < 6; n++) a[n] += weight * both[QUADRIC_A + n];
        for (int k = 0; k < 3; k++) b[k] += weight * both[QUADRIC_B + k];
        *cost += weight * both[QUADRIC_C];

        /* Less what the best value makes good. */
        for (int32_t j = 0; j < s->channels; j++) {
            const double *const g = both + QUADRIC_CHANNELS + 4 * j;
            int index = 0;

            for (int k = 0; k < 3; k++)
                for (int l = k; l < 3; l++) a[index++] -= share * g[k] * g[l];
            for (int k = 0; k < 3; k++) b[k] -= share * g[k] * g[3];
            *cost -= share * g[3] * g[3];
        }
    }
}

/* ---- Triangles ---- */

/* A channel of a triangle to one of its corners, where it has the value. */
static void add_channel(double *q, int32_t channel, const double g[3], double value, double weight)
{
    double *const own = q + QUADRIC_CHANNELS + 4 * channel;
    int index = QUADRIC_A;
    for (int k = 0; k < 3; k++)
        for (int l = k; l < 3; l++) q[index++] += weight * g[k] * g[l];
    for (int k = 0; k < 3; k++) q[QUADRIC_B + k] += weight * value * g[k];
    q[QUADRIC_C] += weight * value * value;
    for (int k = 0; k < 3; k++) own[k] += weight * g[k];
    own[3] += weight * value;
}

static void add_to_rows(bvxi_collapse *c, uint64_t t)
{
    const bvxi_attributes *const s = &c->attributes;
    const uint32_t *const row = s->row + 4 * t, *const corner = c->mesh.triangle[t].vertex;
    double p[3][3], u[3], v[3], n[3], area;

    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) p[k][a] = c->mesh.at[corner[k]].p[a] * c->scale;
    for (int a = 0; a < 3; a++) {
        u[a] = p[1][a] - p[0][a];
        v[a] = p[2][a] - p[0][a];
    }
    area = bvxi_facet_normal((const double(*)[3])p, n);
    if (!(area > 0)) return;

    /* Of each channel its gradient in the triangle's plane; none where the sides lie on one line. */
    double const uu = bvxi_vec_dot(u, u), uv = bvxi_vec_dot(u, v), vv = bvxi_vec_dot(v, v),
                 det = uu * vv - uv * uv;
    for (int32_t channel = 0; channel < s->channels && det > uu * vv * 1e-12; channel++) {
        double value[3], g[3];

        for (int k = 0; k < 3; k++) value[k] = row_value(c, row[k], channel) * s->length[channel];
        double const rise_u = value[1] - value[0], rise_v = value[2] - value[0];
        double const alpha = (rise_u * vv - rise_v * uv) / det, beta = (rise_v * uu - rise_u * uv) / det;
        for (int k = 0; k < 3; k++) g[k] = alpha * u[k] + beta * v[k];
        for (int k = 0; k < 3; k++)
            add_channel(s->q + (size_t)s->stride * row[k], channel, g, value[k], area);
    }
    for (int k = 0; k < 3; k++) s->q[(size_t)s->stride * row[k] + QUADRIC_W] += area;
}

bvx_status bvxi_attributes_open(bvxi_collapse *c)
{
    bvxi_attributes *const s = &c->attributes;
    const bvx_mesh_view *const m = c->given;

    if (m->materials != NULL) {
        BVXI_TRY(BVXI_ARRAY(c->ctx, c->mesh.triangles, "the triangles' materials", s->material));
        for (uint64_t t = 0; t < c->mesh.triangles; t++)
            s->material[t] = m->materials[given_corner(c, (int32_t)(4 * t)) / 3];
    }
    if (m->uvs == NULL && m->uvs2 == NULL && m->normals == NULL && m->colours == NULL &&
        c->options.given.vertices != BVX_VERTICES_KEPT)
        return BVX_OK;
    BVXI_TRY(find_rows(c));

    double length[4];

    s->uv2_at = m->uvs != NULL ? 2 : 0;
    s->normal_at = s->uv2_at + (m->uvs2 != NULL ? 2 : 0);
    s->colour_at = s->normal_at + (m->normals != NULL ? 3 : 0);
    s->channels = s->colour_at + (m->colours != NULL ? 4 : 0);
    s->stride = QUADRIC_CHANNELS + 4 * s->channels;

    length[0] = s->uv2_at > 0 ? UV_SHARE * uv_length(c, 0) : 0;
    length[1] = s->normal_at > s->uv2_at ? UV_SHARE * uv_length(c, s->uv2_at) : 0;
    length[2] = NORMAL_SHARE;
    length[3] = COLOUR_SHARE;
    for (int32_t i = 0; i < s->channels; i++)
        s->length[i] = length[i < s->uv2_at ? 0 : i < s->normal_at ? 1 : i < s->colour_at ? 2 : 3];
    BVXI_TRY(BVXI_ZEROS(c->ctx, s->rows * (uint64_t)s->stride, "the quadrics of attributes", s->q));
    for (uint64_t t = 0; t < c->mesh.triangles && s->channels > 0; t++) add_to_rows(c, t);
    return BVX_OK;
}

/* ---- Collapses ---- */

int bvxi_attributes_part(const bvxi_collapse *c, int32_t edge)
{
    const bvxi_attributes *const s = &c->attributes;
    int32_t const across = bvxi_corner_opposite(&c->mesh, edge);
    if (s->material != NULL && s->material[edge >> 2] != s->material[across >> 2]) return 1;
    return s->row != NULL && (s->row[bvxi_corner_next(edge)] != s->row[bvxi_corner_previous(across)] ||
                              s->row[bvxi_corner_previous(edge)] != s->row[bvxi_corner_next(across)]);
}

/* Rows of a vertex on none of the sides of an edge, which go along with it. */
typedef struct rows_along {
    uint32_t row[COLLAPSE_STAR];
    int32_t count;
} rows_along;

static void move_along(const bvxi_attributes *s, const rows_along *a, const double way[3])
{
    for (int32_t i = 0; i < a->count; i++) move_sums(s->q + (size_t)s->stride * a->row[i], s->channels, way);
}

/* A corner's row becomes the one at the other end, or goes along. */
static void change_row(uint32_t *row, const uint32_t *from, const uint32_t *to, int sides, rows_along *along)
{
    if (*row == BVXI_VERTEX_NONE) return;
    for (int k = 0; k < sides; k++) {
        if (*row != from[k]) continue;
        *row = to[k];
        return;
    }
    for (int32_t i = 0; i < along->count; i++)
        if (along->row[i] == *row) return;
    if (along->count < COLLAPSE_STAR) along->row[along->count++] = *row;
}

void bvxi_attributes_merge(bvxi_collapse *c, int32_t edge, const double offset[3], const double d[3],
                           const int32_t *corner, int32_t count)
{
    bvxi_attributes *const s = &c->attributes;
    double both[QUADRIC_CHANNELS + 4 * ATTRIBUTE_CHANNELS];
    double const way[3] = {d[0] - offset[0], d[1] - offset[1], d[2] - offset[2]};
    rows_along along = {.count = 0};
    uint32_t u[2], v[2];
    int const sides = rows_of_edge(c, edge, u, v);

    for (int i = 0; i < sides; i++) {
        join_sums(s, u[i], v[i], offset, both);
        move_sums(both, s->channels, d);
        memcpy(s->q + (size_t)s->stride * u[i], both, (size_t)s->stride * sizeof *both);
    }
    for (int32_t i = 0; i < count; i++) change_row(&s->row[corner[i]], v, u, sides, &along);
    move_along(s, &along, way);
}

void bvxi_attributes_move(bvxi_collapse *c, uint32_t row, const double way[3], const int32_t *corner,
                          int32_t count)
{
    for (int32_t i = 0; i < count; i++) c->attributes.row[corner[i]] = row;
    move_sums(c->attributes.q + (size_t)c->attributes.stride * row, c->attributes.channels, way);
}

void bvxi_attributes_restore(bvxi_collapse *c, int32_t edge, const double back[3])
{
    bvxi_attributes *const s = &c->attributes;
    const bvxi_corners *const m = &c->mesh;
    int32_t const across = bvxi_corner_opposite(m, edge);
    const double *const p = m->at[bvxi_corner_vertex_of(m, bvxi_corner_next(edge))].p;
    const double *const q = m->at[bvxi_corner_vertex_of(m, bvxi_corner_previous(edge))].p;
    double const way[3] = {(q[0] - p[0]) * c->scale, (q[1] - p[1]) * c->scale, (q[2] - p[2]) * c->scale};
    rows_along along = {.count = 0};
    uint32_t u[2], v[2];
    int const sides = rows_of_edge(c, edge, u, v);

    for (int i = 0; i < sides; i++) move_sums(s->q + (size_t)s->stride * u[i], s->channels, back);
    for (int32_t at = bvxi_corner_turn_left(m, bvxi_corner_next(across)); at >> 2 != edge >> 2;
         at = bvxi_corner_turn_left(m, at))
        change_row(&s->row[at], u, v, sides, &along);
    move_along(s, &along, way);
}

/* ---- Levels ---- */

/* The value of a row's channel at its vertex: where the vertex has not moved, its own. */
static double value_now(const bvxi_collapse *c, uint32_t row, int32_t channel, int moved)
{
    const bvxi_attributes *const s = &c->attributes;
    const double *const q = s->q + (size_t)s->stride * row;
    double const weight = q[QUADRIC_W] * s->length[channel];
    if (!moved || !(weight > 0)) return row_value(c, row, channel);
    return q[QUADRIC_CHANNELS + 4 * channel + 3] / weight;
}

void bvxi_attributes_give(const bvxi_collapse *c, uint32_t row, int moved, float uv[2], float uv2[2],
                          float normal[3], uint8_t colour[4])
{
    const bvxi_attributes *const s = &c->attributes;
    double n[3], length;

    for (int i = 0; i < 2 && s->uv2_at > 0; i++) uv[i] = (float)value_now(c, row, i, moved);
    for (int i = 0; i < 2 && s->normal_at > s->uv2_at; i++)
        uv2[i] = (float)value_now(c, row, s->uv2_at + i, moved);
    if (s->colour_at > s->normal_at) {
        for (int i = 0; i < 3; i++) n[i] = value_now(c, row, s->normal_at + i, moved);
        length = bvxi_vec_length(n);
        for (int i = 0; i < 3; i++)
            normal[i] = (float)(moved && length > 0 ? n[i] / length : row_value(c, row, s->normal_at + i));
    }
    for (int i = 0; i < 4 && s->channels > s->colour_at; i++) {
        double const value = 255 * value_now(c, row, s->colour_at + i, moved) + 0.5;

        colour[i] = (uint8_t)(value <= 0 ? 0 : value >= 255 ? 255 : (int32_t)value);
    }
}
