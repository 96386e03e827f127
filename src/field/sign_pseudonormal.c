/* sign_pseudonormal.c - inside or outside by the closest feature: by the plane of the closest triangle, or
 * by the angle-weighted normal of the closest triangle, edge or vertex.
 *
 * Source: Baerentzen, Aanaes. Signed Distance Computation Using the Angle Weighted Pseudonormal. 2005.
 * Guarantee of the second: right on closed, oriented meshes that do not cross themselves. Threads do not
 * show: each value's side is decided by itself. */
#include "field/room.h"
#include "field/signs.h"
#include "nearest/closest.h"
#include "mesh/facet.h"
#include "core/vec3.h"

/* ---- On which side of its closest feature a centre lies ---- */

/* The closest point of the triangle is computed once more, in doubles, whatever type the field's values have;
 * a centre is inside when the outwards direction there points away from it. Square to the direction, or
 * without one, it is outside. A centre on the surface counts as moved by (e_x, e_y, e_z), e_x >> e_y >> e_z >
 * 0: on faces that is what the solid's rules do; on edges and corners the moved centre would have another
 * feature, and the direction alone decides. */

enum { SIDE_GRAIN = 1 << 10 /* values of the smallest task, about */ };

typedef struct side_job {
    const bvx_mesh_view *mesh;
    const bvxi_sparse *band;
    bvxi_outwards_fn *outwards;
    const void *rule;
    bvx_grid *inside;
    double scale; /* power of two that brings mesh and window into [-1, 1] */
} side_job;

static int is_rounding(double v)
{
    return v < 0x1p-40 && v > -0x1p-40;
}

static int side_of(const side_job *job, int32_t x, int32_t y, int32_t z, uint64_t value)
{
    uint32_t const triangle = job->band->triangles[value];
    double p[3], t[3][3], q[3], away[3], outwards[3] = {0.0, 0.0, 0.0};

    bvxi_field_centre(&job->band->where, x, y, z, p);
    for (int k = 0; k < 3; k++) p[k] *= job->scale;
    bvxi_view_scaled(job->mesh, triangle, job->scale, t);
    bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
    /* From the closest point to the centre, in the scaled world. */
    for (int a = 0; a < 3; a++) away[a] = p[a] - q[a];
    job->outwards(job->rule, triangle, job->band->features[value], outwards);

    /* away: from the closest point to the centre, where mesh and window lie within [-1, 1]. */
    double const along = outwards[0] * away[0] + outwards[1] * away[1] + outwards[2] * away[2];
    /* On the surface, as far as doubles know: the side that the moved centre lies on decides. */
    if (along != 0.0 || !is_rounding(away[0]) || !is_rounding(away[1]) || !is_rounding(away[2]))
        return along < 0.0;
    if (outwards[0] != 0.0) return outwards[0] < 0.0;
    return outwards[1] != 0.0 ? outwards[1] < 0.0 : outwards[2] < 0.0;
}

static void decide_sides(void *user, uint64_t row, uint64_t end)
{
    const side_job *const job = user;
    const bvx_grid *const g = &job->band->where;

    for (; row < end; row++) {
        uint64_t const at = row * (uint64_t)g->words_per_row;
        int32_t const y = (int32_t)(row % (uint64_t)g->size[1]), z = (int32_t)(row / (uint64_t)g->size[1]);
        uint64_t value = job->band->first[row];
        for (int32_t k = 0; k < g->words_per_row; k++) {
            uint64_t set = 0;
            for (uint64_t left = g->words[at + (uint64_t)k]; left != 0; left &= left - 1, value++) {
                int32_t const bit = bvxi_lowest(left);
                if (side_of(job, k * BVXI_WORD_BITS + bit, y, z, value)) set |= UINT64_C(1) << bit;
            }
            job->inside->words[at + (uint64_t)k] = set;
        }
    }
}

static bvx_status sign_side(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                            bvxi_outwards_fn *outwards, const void *rule, bvx_grid *inside)
{
    uint64_t const rows = bvxi_grid_rows(&band->where), each = band->count / rows;
    side_job job = {mesh, band, outwards, rule, inside, 1.0};
    double low[3], high[3];

    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    job.scale = bvxi_field_scale(&band->where, low, high);
    return BVXI_SHARE(call.ctx, call.from, call.to,
                      bvxi_for(call.ctx, call.stage, rows, 1 + SIDE_GRAIN / (1 + each), decide_sides, &job));
}

/* ---- Inside by the plane of the closest triangle ---- */

/* Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013. Where an edge or a
 * corner is closest, several triangles are at one distance and the one of least number decides, whose plane
 * may have the centre on its wrong side: sign_pseudonormal.c mends that. It is here because it is the paper's
 * rule. A triangle without area has no side: what is closest to it is outside. */

typedef struct normal_rule {
    const bvx_mesh_view *mesh;
    double scale; /* power of two, so that products neither vanish nor overflow */
} normal_rule;

static void outwards_of_facet(const void *user, uint32_t triangle, int32_t feature, double outwards[3])
{
    const normal_rule *const rule = user;
    double t[3][3];
    (void)feature;
    bvxi_view_scaled(rule->mesh, triangle, rule->scale, t);
    bvxi_facet_normal((const double(*)[3])t, outwards);
}

bvx_status bvxi_sign_normal(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                            bvx_grid *inside)
{
    normal_rule rule;
    double low[3], high[3];
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    rule.mesh = mesh;
    rule.scale = bvxi_unit_scale(low, high);
    return sign_side(call, mesh, band, outwards_of_facet, &rule, inside);
}

/* ---- Inside by the angle-weighted normal of the closest feature ---- */

/* Source: Baerentzen, Aanaes. Signed Distance Computation Using the Angle Weighted Pseudonormal. 2005. The
 * outwards direction at a triangle is its normal, at an edge the sum of the unit normals of its triangles, at
 * a vertex that of its triangles weighted by their angles there. On a closed, oriented mesh that does not
 * cross itself the sign is right wherever the closest point is; the proof asks of the weights
 * no more than that they come near the angles, which bvxi_angle gives to 1e-10.
 *
 * Vertices at equal positions are one vertex, so meshes without shared vertices are served too; triangles
 * without area count for nothing. Sums go in the order of triangle indices: the same bits everywhere.
 * Vertices' sums are made beforehand, an edge's when it is requested, from the triangles at that end which
 * has fewer. */

enum { PSEUDO_GRAIN = 1 << 12 /* least vertices a task */ };

typedef struct pseudo_rule {
    const bvx_mesh_view *mesh;
    uint32_t *same;   /* vertex -> least vertex at its position [Size: vertex_count] */
    uint32_t *start;  /* of such a vertex's triangles in list [Size: vertex_count + 1] */
    uint32_t *list;   /* triangles by vertex, ascending [Size: triangle_count * 3] */
    double *outwards; /* of such a vertex [Size: vertex_count * 3] */
    double scale;
} pseudo_rule;

static void pseudo_corners(const pseudo_rule *rule, uint32_t triangle, uint32_t c[3])
{
    bvxi_view_triangle(rule->mesh, triangle, c);
    for (int k = 0; k < 3; k++) c[k] = rule->same[c[k]];
}

/* Unit normal; 0 for a triangle without area. */
static int pseudo_normal(const pseudo_rule *rule, const uint32_t c[3], double t[3][3], double n[3])
{
    /* About the size of 1, as products of lengths are taken. */
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(rule->mesh, c[k], t[k]);
        for (int a = 0; a < 3; a++) t[k][a] *= rule->scale;
    }
    double const length = bvxi_facet_normal((const double(*)[3])t, n);
    if (!(length > 0.0)) return 0;
    for (int a = 0; a < 3; a++) n[a] /= length;
    return 1;
}

/* The angle of a triangle at corner k. */
static double pseudo_angle(const double t[3][3], int k)
{
    const double *const o = t[k], *const p = t[(k + 1) % 3], *const q = t[(k + 2) % 3];
    double const turned[3][3] = {{o[0], o[1], o[2]}, {p[0], p[1], p[2]}, {q[0], q[1], q[2]}};
    double n[3], along = 0.0;
    for (int a = 0; a < 3; a++) along += (p[a] - o[a]) * (q[a] - o[a]);
    return bvxi_angle(along, bvxi_facet_normal(turned, n));
}

static void sum_at_vertex(const pseudo_rule *rule, uint32_t vertex, double sum[3])
{
    /* Ascending triangles: sums are the same on every machine. */
    for (uint32_t i = rule->start[vertex]; i < rule->start[vertex + 1]; i++) {
        uint32_t c[3];
        double t[3][3], n[3], angle;
        int k = 0;
        pseudo_corners(rule, rule->list[i], c);
        if (!pseudo_normal(rule, c, t, n)) continue;
        while (k < 2 && c[k] != vertex) k++;
        angle = pseudo_angle((const double(*)[3])t, k);
        for (int a = 0; a < 3; a++) sum[a] += angle * n[a];
    }
}

static void sum_at_edge(const pseudo_rule *rule, uint32_t v, uint32_t w, double sum[3])
{
    uint32_t const v_count = rule->start[v + 1] - rule->start[v];
    uint32_t const w_count = rule->start[w + 1] - rule->start[w];
    uint32_t const at = v_count <= w_count ? v : w, other = at == v ? w : v;
    for (uint32_t i = rule->start[at]; i < rule->start[at + 1]; i++) {
        uint32_t c[3];
        double t[3][3], n[3];
        pseudo_corners(rule, rule->list[i], c);
        if ((c[0] != other && c[1] != other && c[2] != other) || !pseudo_normal(rule, c, t, n)) continue;
        for (int a = 0; a < 3; a++) sum[a] += n[a];
    }
}

static void outwards_of_feature(const void *user, uint32_t triangle, int32_t feature, double outwards[3])
{
    const pseudo_rule *const rule = user;
    uint32_t c[3];
    double t[3][3];
    pseudo_corners(rule, triangle, c);
    memset(outwards, 0, 3 * sizeof outwards[0]);
    if (feature == 0) pseudo_normal(rule, c, t, outwards);
    else if (feature <= 3) sum_at_edge(rule, c[feature - 1], c[feature % 3], outwards);
    else memcpy(outwards, rule->outwards + 3 * (size_t)c[feature - 4], 3 * sizeof outwards[0]);
}

static void sum_at_vertices(void *user, uint64_t v, uint64_t end)
{
    const pseudo_rule *const rule = user;
    for (; v < end; v++) {
        double *const sum = rule->outwards + 3 * (size_t)v;
        memset(sum, 0, 3 * sizeof *sum);
        /* Only the first vertex at a place has a sum; the others are read through it. */
        if (rule->same[v] == v) sum_at_vertex(rule, (uint32_t)v, sum);
    }
}

/* start[v + 1] counts, then ends, and while the list is filled runs from the start of v to its end. */
static void pseudo_list_triangles(pseudo_rule *rule)
{
    uint64_t const vertices = rule->mesh->vertex_count;
    uint32_t c[3];

    /* Counts, then places, then the list itself, in the order of the triangles. */
    memset(rule->start, 0, (size_t)(vertices + 1) * sizeof *rule->start);
    for (uint64_t t = 0; t < rule->mesh->triangle_count; t++) {
        pseudo_corners(rule, (uint32_t)t, c);
        for (int k = 0; k < 3; k++) rule->start[c[k]]++;
    }
    bvxi_place_counts32(rule->start, vertices + 1);
    for (uint64_t t = 0; t < rule->mesh->triangle_count; t++) {
        pseudo_corners(rule, (uint32_t)t, c);
        for (int k = 0; k < 3; k++) rule->list[rule->start[c[k]]++] = (uint32_t)t;
    }
    /* Filling moved each start to its end; all are moved back by one. */
    for (uint64_t v = vertices; v > 0; v--) rule->start[v] = rule->start[v - 1];
    rule->start[0] = 0;
}

static bvx_status pseudo_open(bvx_context *ctx, pseudo_rule *rule)
{
    const bvx_mesh_view *const m = rule->mesh;
    uint64_t unused;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, m->vertex_count * 4, "the vertices' places", &rule->same));
    BVXI_TRY(bvxi_weld(ctx, m, rule->same, &unused));
    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, (m->vertex_count + 1) * 4, "the vertices' triangles", &rule->start));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, m->triangle_count * 12, "the list of triangles", &rule->list));
    pseudo_list_triangles(rule);
    return bvxi_alloc(ctx, BVXI_SCRATCH, m->vertex_count * 24, "the vertices' directions", &rule->outwards);
}

bvx_status bvxi_sign_pseudonormal(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                                  bvx_grid *inside)
{
    double const middle = call.from + (call.to - call.from) * 0.3;
    uint64_t const mark = bvxi_scratch_begin(call.ctx);
    double low[3], high[3];

    if (mesh->triangle_count > UINT32_MAX / 3)
        return bvxi_fail_for(call.ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.triangle_count is %u, the limit of BVX_FILL_PSEUDONORMAL is %u",
                             call.function, mesh->triangle_count, (uint64_t)(UINT32_MAX / 3));
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    pseudo_rule rule = {.mesh = mesh, .scale = bvxi_unit_scale(low, high)};
    BVXI_TRY(pseudo_open(call.ctx, &rule));
    BVXI_TRY(
        BVXI_SHARE(call.ctx, call.from, middle,
                   bvxi_for(call.ctx, call.stage, mesh->vertex_count, PSEUDO_GRAIN, sum_at_vertices, &rule)));
    return bvxi_scratch_end(
        call.ctx, mark,
        sign_side(bvxi_call_part(call, middle, call.to), mesh, band, outwards_of_feature, &rule, inside));
}
