/* colours.c - what it costs to move a vertex away from where its colour is; and colours for a surface that
 * was measured from a mesh.
 *
 * Source: Hoppe. New Quadric Metric for Simplifying Meshes with Appearance Attributes. 1999. */
#include "simplify/collapse_state.h"
#include "simplify/room.h"
#include "mesh/facet.h"
#include "core/vec3.h"
#include "mesh/view.h"

/* ---- What it costs to move a vertex away from where its colour is ---- */

/* Source: Hoppe. New Quadric Metric for Simplifying Meshes with Appearance Attributes. 1999.
 *
 * On a triangle each channel is a linear function g x + d of the position. A vertex at x with the colour s
 * costs the sum of (g x + d - s)^2 by area over the triangles that it stands for; the best s is their mean
 * value at x, and with it the cost is a quadric of x alone: the sum of (g x + d)^2 less the squared sum of g
 * x + d by the area. So a vertex slides for free along a border of colours and where there is one colour, and
 * not across. Sums are additive, as plane quadrics are. */

/* ---- Sums ---- */

static void colours_times(const double a[6], const double x[3], double y[3])
{
    y[0] = a[0] * x[0] + a[1] * x[1] + a[2] * x[2];
    y[1] = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
    y[2] = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
}

void bvxi_colours_move(bvxi_colour_quadric *q, const double offset[3])
{
    double y[3];

    /* g (x + offset) + d has the value d + g offset where it is centred now. */
    colours_times(q->a, offset, y);
    q->c += 2 * bvxi_vec_dot(q->b, offset) + bvxi_vec_dot(y, offset);
    for (int k = 0; k < 3; k++) q->b[k] += y[k];
    for (int j = 0; j < 3; j++) q->d[j] += bvxi_vec_dot(q->g[j], offset);
}

void bvxi_colours_join(const bvxi_colour_quadric *u, const bvxi_colour_quadric *v, const double offset[3],
                       bvxi_colour_quadric *both)
{
    double const back[3] = {-offset[0], -offset[1], -offset[2]};

    *both = *v;
    bvxi_colours_move(both, back);
    for (int i = 0; i < 6; i++) both->a[i] += u->a[i];
    for (int k = 0; k < 3; k++) both->b[k] += u->b[k];
    both->c += u->c;
    for (int j = 0; j < 3; j++) {
        for (int k = 0; k < 3; k++) both->g[j][k] += u->g[j][k];
        both->d[j] += u->d[j];
    }
    both->w += u->w;
}

void bvxi_colours_add(const bvxi_colour_quadric *q, double a[6], double b[3], double *c)
{
    double const share = q->w > 0 ? 1 / q->w : 0;

    for (int i = 0; i < 6; i++) a[i] += q->a[i];
    for (int k = 0; k < 3; k++) b[k] += q->b[k];
    *c += q->c;

    /* Less what the best colour of the vertex makes good. */
    for (int j = 0; j < 3; j++) {
        const double *const g = q->g[j];
        int index = 0;

        for (int k = 0; k < 3; k++)
            for (int l = k; l < 3; l++) a[index++] -= share * g[k] * g[l];
        for (int k = 0; k < 3; k++) b[k] -= share * g[k] * q->d[j];
        *c -= share * q->d[j] * q->d[j];
    }
}

void bvxi_colours_pack(bvxi_colour_quadric *at, uint64_t vertices, const uint32_t *moved)
{
    for (uint64_t v = 0; v < vertices; v++)
        if (moved[v] != BVXI_VERTEX_NONE) at[moved[v]] = at[v];
}

/* ---- Triangles ---- */

/* The gradient in a triangle's plane of what has a value at each corner. u,
 * v: sides from the first corner; 0: the triangle has no area. */
static int colour_gradient(const double u[3], const double v[3], const double value[3], double g[3])
{
    double const uu = bvxi_vec_dot(u, u), uv = bvxi_vec_dot(u, v), vv = bvxi_vec_dot(v, v);
    double const rise_u = value[1] - value[0], rise_v = value[2] - value[0], det = uu * vv - uv * uv;
    double alpha, beta;

    if (!(det > uu * vv * 1e-12)) return 0;
    alpha = (rise_u * vv - rise_v * uv) / det;
    beta = (rise_v * uu - rise_u * uv) / det;
    for (int k = 0; k < 3; k++) g[k] = alpha * u[k] + beta * v[k];
    return 1;
}

/* A channel of a triangle to one of its corners, where it has the value. */
static void add_channel(bvxi_colour_quadric *q, int channel, const double g[3], double value, double weight)
{
    int index = 0;

    for (int k = 0; k < 3; k++)
        for (int l = k; l < 3; l++) q->a[index++] += weight * g[k] * g[l];
    for (int k = 0; k < 3; k++) q->b[k] += weight * value * g[k];
    q->c += weight * value * value;
    for (int k = 0; k < 3; k++) q->g[channel][k] += weight * g[k];
    q->d[channel] += weight * value;
}

void bvxi_colours_start(const bvxi_corners *mesh, const uint8_t *colours, double weight, double scale,
                        bvxi_colour_quadric *at)
{
    for (uint64_t t = 0; t < mesh->triangles; t++) {
        const uint32_t *const corner = mesh->triangle[t].vertex;
        double p[3][3], u[3], v[3], n[3], area;

        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) p[k][a] = mesh->at[corner[k]].p[a] * scale;
        for (int a = 0; a < 3; a++) {
            u[a] = p[1][a] - p[0][a];
            v[a] = p[2][a] - p[0][a];
        }
        area = bvxi_facet_normal((const double(*)[3])p, n);

        for (int channel = 0; channel < 3; channel++) {
            double value[3], g[3];

            for (int k = 0; k < 3; k++)
                value[k] = colours[4 * (uint64_t)corner[k] + (uint64_t)channel] / 255.0 * weight;
            if (!colour_gradient(u, v, value, g)) continue;
            for (int k = 0; k < 3; k++) add_channel(&at[corner[k]], channel, g, value[k], area);
        }
        if (area > 0)
            for (int k = 0; k < 3; k++) at[corner[k]].w += area;
    }
}

/* ---- Colours for a surface measured from a mesh: those of the mesh's nearest points, blended by their
 * weights ---- */

enum { NEAREST_BLOCK = 256 };

static void blend_nearest(const bvx_mesh_view *mesh, const bvx_closest_point *at, uint8_t *to)
{
    uint32_t corner[3];

    bvxi_view_triangle(mesh, at->triangle, corner);
    for (int i = 0; i < 4; i++) {
        double sum = 0.5;

        for (int k = 0; k < 3; k++) sum += at->weight[k] * mesh->colours[4 * (size_t)corner[k] + (size_t)i];
        to[i] = (uint8_t)(sum >= 255.0 ? 255 : (int32_t)sum);
    }
}

static bvx_status blend_all(bvx_context *ctx, const bvx_closest *closest, const bvx_mesh_view *mesh,
                            const bvx_mesh_view *surface, uint8_t *colours)
{
    bvx_closest_point found[NEAREST_BLOCK];
    double p[3 * NEAREST_BLOCK];

    for (uint64_t first = 0; first < surface->vertex_count; first += NEAREST_BLOCK) {
        uint64_t const left = surface->vertex_count - first;
        uint64_t const count = left < NEAREST_BLOCK ? left : NEAREST_BLOCK;

        for (uint64_t i = 0; i < count; i++) bvxi_view_position(surface, first + i, p + 3 * i);
        BVXI_TRY(bvx_closest_find(ctx, closest, p, count, found));
        for (uint64_t i = 0; i < count; i++) blend_nearest(mesh, &found[i], colours + 4 * (first + i));
    }
    return BVX_OK;
}

bvx_status bvxi_nearest_colours(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_mesh_view *surface,
                                uint8_t *colours)
{
    bvx_closest *closest = NULL;
    bvx_status status;

    BVXI_TRY(bvx_closest_create(ctx, mesh, &closest));
    status = blend_all(ctx, closest, mesh, surface, colours);
    bvx_closest_free(ctx, closest);
    return status;
}
