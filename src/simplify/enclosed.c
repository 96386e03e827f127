/* enclosed.c - a level that stays around a mesh: no triangle meets one of the mesh or lies far from it, and no piece of
 * the mesh gets out.
 *
 * What meets the mesh is found by exact signs, touching included. How far a triangle lies is bounded from above:
 * no point of it is further from a triangle of the mesh than one of its corners is; where none is near to all three,
 * its quarters are asked. As nothing meets, a piece is inside with all of it or with nothing. */
#include "nearest/closest.h"
#include "core/vec3.h"
#include "mesh/mesh.h"
#include "simplify/collapse_state.h"

#include <math.h>

enum { LEAVING_GRAIN = 256 }; /* triangles of a task */

/* Rounding of a distance, and more. */
#define ENCLOSED_SLACK 1e-12
/* Quarters that reach less far than this part of what is allowed count as far. */
#define ENCLOSED_FINEST 0.1

/* ---- The mesh ---- */

/* A vertex of each piece that triangles join. */
static bvx_status list_pieces(bvx_context *ctx, const bvx_mesh_view *mesh, bvxi_enclosed *e)
{
    uint32_t *same, *piece;
    uint8_t *used;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, mesh->vertex_count * 9, "the pieces of what is enclosed", &same));
    piece = same + mesh->vertex_count;
    used = (uint8_t *)(piece + mesh->vertex_count);
    memset(used, 0, (size_t)mesh->vertex_count);
    for (uint64_t v = 0; v < mesh->vertex_count; v++) same[v] = (uint32_t)v;
    bvxi_pieces(mesh, same, piece);
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t v[3];

        bvxi_view_triangle(mesh, t, v);
        e->pieces += !used[piece[v[0]]];
        used[piece[v[0]]] = 1;
    }
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * e->pieces, "a point of each piece", e->point));
    e->pieces = 0;
    for (uint64_t v = 0; v < mesh->vertex_count; v++)
        if (used[v]) bvxi_view_position(mesh, v, e->point + 3 * e->pieces++);
    bvxi_drop(ctx, same);
    return BVX_OK;
}

bvx_status bvxi_enclosed_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              double farthest, bvxi_enclosed *e)
{
    double high[3], size = 0;

    e->farthest = farthest * (1 - ENCLOSED_SLACK);
    BVXI_TRY(bvxi_view_bounds(ctx, function, mesh, e->tree.low, high));
    for (int a = 0; a < 3; a++)
        if (high[a] - e->tree.low[a] > size) size = high[a] - e->tree.low[a];
    e->tree.scale = size > 0 ? 1 / size : 1;
    BVXI_TRY(bvxi_closest_open(bvxi_call_of(ctx, function, "search tree", 0.0, 0.5), mesh, &e->closest));

    /* Corners of all triangles in an order of space, three vertices each. */
    const bvxi_closest_tree *const from = &e->closest.tree;
    uint64_t const n = from->triangle_count;
    double *at, t[3][3];
    uint32_t *vertex;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 72, "the corners of what is enclosed", &at));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 12, "the triangles of what is enclosed", &vertex));
    for (uint64_t i = 0; i < n; i++) {
        bvxi_closest_corners(from, i, t);
        for (uint64_t k = 0; k < 9; k++) at[9 * i + k] = t[k / 3][k % 3] / from->scale;
        for (uint64_t k = 0; k < 3; k++) vertex[3 * i + k] = (uint32_t)(3 * i + k);
    }
    e->tree.at = at;
    e->tree.vertex = vertex;
    e->tree.at_step = e->tree.vertex_step = 3;
    e->tree.triangles = n;
    e->tree.slanted = e->tree.touching = 1;
    BVXI_TRY(bvxi_crossing_tree_open(ctx, &e->tree));

    return list_pieces(ctx, mesh, e);
}

/* ---- Triangles of the level ---- */

/* asked: what is closest to its middle has been looked for, and is the hint's or near to it. */
static int is_far(const bvxi_enclosed *e, const double *const p[3], int asked, uint32_t *hint)
{
    double middle[3], reach = 0, half[3][3];
    const double *const inner[3] = {half[0], half[1], half[2]};
    bvx_closest_point found;

    /* Most are near to what the one before was near to, and need no search. */
    if (bvxi_closest_bound(&e->closest, p, *hint) <= e->farthest) return 0;
    for (int a = 0; a < 3; a++) middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3;
    if (!asked) {
        bvxi_closest_ask(&e->closest, middle, hint, &found);
        if (bvxi_closest_bound(&e->closest, p, *hint) <= e->farthest) return 0;
        if (found.distance > e->farthest) return 1;
    }
    for (int k = 0; k < 3; k++) {
        double const way = bvxi_vec_distance2(p[k], middle);

        reach = way > reach ? way : reach;
        for (int a = 0; a < 3; a++) half[k][a] = 0.5 * (p[k][a] + p[(k + 1) % 3][a]);
    }
    if (sqrt(reach) < ENCLOSED_FINEST * e->farthest || is_far(e, inner, 1, hint)) return 1;
    for (int k = 0; k < 3; k++) {
        const double *const corner[3] = {p[k], half[k], half[(k + 2) % 3]};

        if (is_far(e, corner, 0, hint)) return 1;
    }
    return 0;
}

static int meets(const bvxi_enclosed *e, const double *const p[3])
{
    return bvxi_crossing_tree_visit(&e->tree, p, BVXI_VERTEX_NONE, BVXI_VERTEX_NONE, NULL, NULL, NULL, NULL);
}

int bvxi_collapse_leaves(const bvxi_collapse *c, uint32_t t, uint32_t *hint)
{
    const bvxi_enclosed *const e = c->options.enclosed;
    const uint32_t *const v = c->mesh.triangle[t].vertex;
    const double *const p[3] = {c->mesh.at[v[0]].p, c->mesh.at[v[1]].p, c->mesh.at[v[2]].p};

    return e != NULL && (meets(e, p) || is_far(e, p, 0, hint));
}

/* Corners of the triangle from p to an edge of a link; 0: there is none. */
static int corners_at(const bvxi_collapse *c, const double *p, const uint32_t *edge, const double *corner[3])
{
    if (edge[0] == BVXI_VERTEX_GHOST || edge[1] == BVXI_VERTEX_GHOST) return 0;
    corner[0] = p;
    for (int k = 0; k < 2; k++) corner[k + 1] = c->mesh.at[edge[k]].p;
    return 1;
}

int bvxi_collapse_fan_leaves(const bvxi_collapse *c, const uint32_t *link, int32_t count, const double *p)
{
    const bvxi_enclosed *const e = c->options.enclosed;
    const double *corner[3];
    bvx_closest_point found;
    uint32_t hint = 0;

    if (e == NULL) return 0;
    /* What is cheap first. */
    bvxi_closest_ask(&e->closest, p, &hint, &found);
    if (found.distance > e->farthest) return 1;
    for (int32_t i = 0; i < count; i++)
        if (corners_at(c, p, link + i, corner) && meets(e, corner)) return 1;
    for (int32_t i = 0; i < count; i++)
        if (corners_at(c, p, link + i, corner) && is_far(e, corner, 0, &hint)) return 1;
    return 0;
}

typedef struct leaving_marks {
    const bvxi_collapse *c;
    uint8_t *leaves;
} leaving_marks;

static void leaving_piece(void *user, uint64_t begin, uint64_t end)
{
    const leaving_marks *const l = user;
    uint32_t hint = 0;

    for (uint64_t t = begin; t < end; t++) {
        const uint32_t *const v = l->c->mesh.triangle[t].vertex;
        int const changed = !bvxi_triangle_gone(&l->c->mesh.triangle[t]) &&
                            (l->c->fresh[v[0]] | l->c->fresh[v[1]] | l->c->fresh[v[2]]) != 0;

        l->leaves[t] = (uint8_t)(changed && bvxi_collapse_leaves(l->c, (uint32_t)t, &hint));
    }
}

bvx_status bvxi_collapse_mark_leaving(const bvxi_collapse *c, double at, uint8_t **leaves)
{
    uint64_t const n = c->mesh.triangles;

    BVXI_TRY(BVXI_ARRAY(c->ctx, n, "triangles that leave what they enclose", *leaves));
    leaving_marks l = {c, *leaves};
    return bvxi_for_ranges(c->ctx, "crossings", at, at, bvxi_piece_count(n, LEAVING_GRAIN), n, leaving_piece,
                           &l);
}

/* ---- Pieces of the mesh ---- */

static bvx_status count_turns(bvx_context *ctx, const bvx_mesh *level, const bvxi_enclosed *e, int64_t *turns)
{
    bvx_mesh_view view;
    bvx_closest *closest = NULL;

    bvx_mesh_view_of(level, &view);
    BVXI_TRY(bvx_closest_create(ctx, &view, &closest));
    bvx_status const status = bvx_closest_winding(ctx, closest, e->point, e->pieces, turns);
    bvx_closest_free(ctx, closest);
    return status;
}

bvx_status bvxi_collapse_escaped(bvxi_collapse *c, uint64_t *escaped)
{
    const bvxi_enclosed *const e = c->options.enclosed;
    bvx_mesh level = {0};
    int64_t *turns;

    *escaped = 0;
    BVXI_TRY(BVXI_ARRAY(c->ctx, e->pieces, "how often the level goes around pieces", turns));
    BVXI_TRY(bvxi_collapse_give_plain(c, &level));
    bvx_status const status = count_turns(c->ctx, &level, e, turns);
    bvx_mesh_free(c->ctx, &level);
    BVXI_TRY(status);
    for (uint64_t i = 0; i < e->pieces; i++) *escaped += turns[i] != 1;
    return BVX_OK;
}
