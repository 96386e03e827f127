/* sign_pseudonormal.c - inside by the angle-weighted normal of the closest feature.
 *
 * Source: Baerentzen, Aanaes. Signed Distance Computation Using the Angle Weighted Pseudonormal. 2005. The
 * outwards direction at a triangle is its normal, at an edge the sum of the unit normals of its triangles, at
 * a vertex that of its triangles weighted by their angles there. On a closed, oriented mesh that does not
 * cross itself the sign is right wherever the closest point is; the proof asks of the weights
 * no more than that they come near the angles, which bvxi_angle gives to 1e-10.
 *
 * Vertices at equal positions are one vertex, so meshes without shared vertices are served too; triangles
 * without area count for nothing. Sums go in the order of triangle indices: the same bits everywhere.
 * Vertices' sums are made beforehand, an edge's when it is requested, from the triangles at that end which
 * has fewer. */
#include "core/vec3.h"
#include "field/signs.h"
#include "mesh/facet.h"
#include "mesh/view.h"
#include "mesh/topology.h"

enum { PSEUDO_GRAIN = 1 << 12 /* least vertices a task */ };

typedef struct pseudo_rule {
    const bvx_mesh_view *mesh;
    uint32_t *same;   /* vertex -> least vertex at its position [Size: vertex_count] */
    uint32_t *start;  /* of such a vertex's triangles in list [Size: vertex_count + 1] */
    uint32_t *list;   /* triangles by vertex, ascending [Size: triangle_count * 3] */
    double *outwards; /* of such a vertex [Size: vertex_count * 3] */
    double scale;
    int32_t pieces;
} pseudo_rule;

/* ---- triangles ---- */

static void pseudo_corners(const pseudo_rule *rule, uint32_t triangle, uint32_t c[3])
{
    bvxi_view_triangle(rule->mesh, triangle, c);
    for (int k = 0; k < 3; k++) c[k] = rule->same[c[k]];
}

/* Unit normal; 0 for a triangle without area. */
static int pseudo_normal(const pseudo_rule *rule, const uint32_t c[3], double t[3][3], double n[3])
{
    double length;

    /* About the size of 1, as products of lengths are taken. */
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(rule->mesh, c[k], t[k]);
        for (int a = 0; a < 3; a++) t[k][a] *= rule->scale;
    }
    length = bvxi_facet_normal((const double(*)[3])t, n);
    /* Without area it has no direction. */
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

/* ---- directions ---- */

static void sum_at_vertex(const pseudo_rule *rule, uint32_t vertex, double sum[3])
{
    /* Ascending triangles: sums are the same on every machine. */
    for (uint32_t i = rule->start[vertex]; i < rule->start[vertex + 1]; i++) {
        uint32_t c[3];
        double t[3][3], n[3], angle;
        int k = 0;
        pseudo_corners(rule, rule->list[i], c);
        if (!pseudo_normal(rule, c, t, n)) continue;
        /* The corner that is at the vertex. */
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
        /* Of that end's triangles those that have the other one too. */
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
    /* 0: the triangle's face; 1 to 3: its edges; then its corners. */
    if (feature == 0) pseudo_normal(rule, c, t, outwards);
    else if (feature <= 3) sum_at_edge(rule, c[feature - 1], c[feature % 3], outwards);
    else memcpy(outwards, rule->outwards + 3 * (size_t)c[feature - 4], 3 * sizeof outwards[0]);
}

static void sum_at_vertices(void *user, int32_t piece, int32_t worker)
{
    const pseudo_rule *const rule = user;
    uint64_t v, end;

    (void)worker;
    bvxi_piece(rule->mesh->vertex_count, rule->pieces, piece, &v, &end);
    for (; v < end; v++) {
        double *const sum = rule->outwards + 3 * (size_t)v;
        memset(sum, 0, 3 * sizeof *sum);
        /* Only the first vertex at a place has a sum; the others are read through it. */
        if (rule->same[v] == v) sum_at_vertex(rule, (uint32_t)v, sum);
    }
}

/* ---- tables ---- */

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
    for (uint64_t v = 0, sum = 0; v <= vertices; v++) {
        uint32_t const n = rule->start[v];
        rule->start[v] = (uint32_t)sum;
        sum += n;
    }
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

static void pseudo_close(bvx_context *ctx, pseudo_rule *rule)
{
    bvxi_drop(ctx, rule->outwards);
    bvxi_drop(ctx, rule->list);
    bvxi_drop(ctx, rule->start);
    bvxi_drop(ctx, rule->same);
}

bvx_status bvxi_sign_pseudonormal(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                                  bvx_grid *inside)
{
    double const middle = call.from + (call.to - call.from) * 0.3;
    pseudo_rule rule = {0};
    double low[3], high[3];
    bvx_status status;

    if (mesh->triangle_count > UINT32_MAX / 3)
        return bvxi_fail_for(call.ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.triangle_count is %u, the limit of BVX_SIGN_PSEUDONORMAL is %u",
                             call.function, mesh->triangle_count, (uint64_t)(UINT32_MAX / 3));
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    rule.mesh = mesh;
    rule.scale = bvxi_unit_scale(low, high);
    status = pseudo_open(call.ctx, &rule);
    rule.pieces = bvxi_piece_count(rule.mesh->vertex_count, PSEUDO_GRAIN);
    if (status == BVX_OK)
        status = bvxi_parallel(call.ctx, call.stage, call.from, middle, rule.pieces, sum_at_vertices, &rule);
    if (status == BVX_OK)
        status = bvxi_sign_side(bvxi_call_part(call, middle, call.to), mesh, band, outwards_of_feature, &rule,
                                inside);
    pseudo_close(call.ctx, &rule);
    return status;
}
