/* crossing_pairs.c - pairs of triangles that cross: bvx_mesh_crossings.
 *
 * The search tree of closest.h packs triangles in fours along a curve through space. Each four goes down that
 * tree to the fours that follow it and whose boxes meet its own, and the triangles of two fours are looked at
 * in pairs, those with boxes that meet by cross.h. The boxes are rounded by functions that never fall, then
 * outwards, so two that are apart hold points that are apart; the test itself reads the caller's coordinates,
 * which are scaled nowhere.
 *
 * Source: Brinkhoff, Kriegel, Seeger. Efficient Processing of Spatial Joins Using R-trees. 1993.
 *
 * A first run counts and marks the fours that have crossings; a second one, when pairs are wanted, visits the
 * marked ones and writes to where the counts say. Pairs are then sorted, so neither threads nor the curve
 * show. */
#include "nearest/closest.h"
#include "mesh/cross.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "mesh/topology.h"

enum {
    CROSSINGS_GRAIN = 128, /* minimum fours a task */
    CROSSINGS_STACK = 4 * BVXI_CLOSEST_LEVELS
};

#define CROSSINGS_NO_VERTEX UINT32_MAX /* no mesh has so many */

typedef struct crossings_job {
    const bvx_mesh_view *view;
    const uint32_t *representative; /* [Size: vertices of the view] */
    bvxi_closest_tree tree;
    /* representatives along the curve, CROSSINGS_NO_VERTEX without area [Size: triangles * 3] */
    uint32_t *corner;
    uint8_t *marks;   /* 1: the four has crossings with itself or later ones [Size: fours] */
    uint64_t *counts; /* of each piece, then where its pairs begin [Size: pieces] */
    uint64_t *keys;   /* lower index * 2^32 + higher index [Size: pairs], or NULL */
    int32_t pieces;
} crossings_job;

/* Up to four triangles that follow each other along the curve. */
typedef struct crossings_four {
    const bvxi_closest_node *boxes;
    const uint32_t *corner;
    const uint32_t *index; /* of the triangles in the mesh */
    int count;
    double position[BVXI_CLOSEST_WIDTH][3][3];
    bvxi_orient_plane plane[BVXI_CLOSEST_WIDTH]; /* of the four whose turn it is */
} crossings_four;

/* ---- Triangles along the curve ---- */

/* Corners as the caller gave them: a scale could lose digits of subnormal numbers. */
static void crossings_positions(const bvxi_closest_tree *tree, uint64_t position, double t[3][3])
{
    bvxi_closest_corners_by(tree, position, 1.0, t);
}

static void crossings_open_four(const crossings_job *job, uint64_t four, crossings_four *f)
{
    uint64_t const first = four * BVXI_CLOSEST_WIDTH;
    /* Boxes, corners and numbers stay where they are; positions are unpacked once for all partners. */
    f->boxes = &job->tree.nodes[four];
    f->corner = job->corner + 3 * (size_t)first;
    f->index = job->tree.order + (size_t)first;
    f->count = bvxi_closest_children(job->tree.triangle_count, first);
    for (int i = 0; i < f->count; i++) crossings_positions(&job->tree, first + (uint64_t)i, f->position[i]);
}

/* Task: which vertices the triangles of a piece have; those without area get none. */
static void crossings_corners(void *user, uint64_t begin, uint64_t end)
{
    const crossings_job *const job = user;
    double t[3][3];
    const double *const p[3] = {t[0], t[1], t[2]};

    /* Pieces are of fours, so the last may reach beyond the last triangle. */
    end = end * BVXI_CLOSEST_WIDTH < job->tree.triangle_count ? end * BVXI_CLOSEST_WIDTH
                                                              : job->tree.triangle_count;

    for (uint64_t i = begin * BVXI_CLOSEST_WIDTH; i < end; i++) {
        uint32_t *const corner = job->corner + 3 * (size_t)i;
        bvxi_view_triangle(job->view, job->tree.order[i], corner);
        crossings_positions(&job->tree, i, t);

        /* A triangle without area has no plane that anything could cross. */
        int const has_area = bvxi_has_area(p);
        for (int k = 0; k < 3; k++)
            corner[k] = has_area ? job->representative[corner[k]] : CROSSINGS_NO_VERTEX;
    }
}

/* ---- Pairs ---- */

/* Bit k: the box given meets box k of the node, of its first count ones. */
static unsigned crossings_boxes_met(const bvxi_closest_node *node, int count, const float low[3],
                                    const float high[3])
{
    uint32_t x[BVXI_CLOSEST_WIDTH], y[BVXI_CLOSEST_WIDTH], z[BVXI_CLOSEST_WIDTH];
    /* One axis a loop, four boxes side by side: compilers make vector code of it. */
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++)
        x[k] = (node->low[0][k] <= high[0]) & (low[0] <= node->high[0][k]);
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++)
        y[k] = (node->low[1][k] <= high[1]) & (low[1] <= node->high[1][k]);
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++)
        z[k] = (node->low[2][k] <= high[2]) & (low[2] <= node->high[2][k]);
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++) x[k] = (x[k] & y[k] & z[k]) << k;
    return (x[0] | x[1] | x[2] | x[3]) & ((1u << count) - 1);
}

static void crossings_box_of(const bvxi_closest_node *node, int k, float low[3], float high[3])
{
    for (int a = 0; a < 3; a++) {
        low[a] = node->low[a][k];
        high[a] = node->high[a][k];
    }
}

/* 1 when triangle i of a crosses triangle k of b. */
static int crossings_pair(const crossings_four *a, int i, const crossings_four *b, int k)
{
    const uint32_t *const u = a->corner + 3 * i, *const v = b->corner + 3 * k;
    const double(*const t)[3] = a->position[i];
    const double *const p[3] = {t[0], t[1], t[2]}, *q[3];
    /* Without area on one side there is nothing to cross. */
    if (u[0] == CROSSINGS_NO_VERTEX || v[0] == CROSSINGS_NO_VERTEX) return 0;
    /* The test knows common corners by their pointers. */
    for (int j = 0; j < 3; j++)
        q[j] = v[j] == u[0] ? t[0] : v[j] == u[1] ? t[1] : v[j] == u[2] ? t[2] : b->position[k][j];
    return bvxi_triangles_cross_at(&a->plane[i], p, q);
}

/* Count the crossings between two fours, or of one four with itself; write them to keys if given. */
static uint64_t crossings_of_fours(const crossings_four *a, const crossings_four *b, uint64_t *keys)
{
    uint64_t found = 0;

    for (int i = 0; i < a->count; i++) {
        float low[3], high[3];

        crossings_box_of(a->boxes, i, low, high);
        unsigned met = crossings_boxes_met(b->boxes, b->count, low, high);
        if (a->boxes == b->boxes) met &= ~0u << (i + 1); /* each pair once, and none with itself */

        for (int k = 0; met != 0; k++, met >>= 1) {
            uint64_t const s = a->index[i], t = b->index[k];

            /* The lesser index stands first, whichever of both was found first, so keys sort as pairs do. */
            if ((met & 1) == 0 || !crossings_pair(a, i, b, k)) continue;
            if (keys != NULL) keys[found] = s < t ? s << 32 | t : t << 32 | s;
            found++;
        }
    }
    return found;
}

/* Crossings of a four with itself and all that follow it. */
static uint64_t crossings_of_four(const crossings_job *job, uint64_t four, uint64_t *keys)
{
    const bvxi_closest_tree *const tree = &job->tree;
    struct {
        uint64_t node;
        int32_t level;
    } stack[CROSSINGS_STACK];
    crossings_four a, b;
    float low[3], high[3], l[3], h[3];
    int depth = 0;

    crossings_open_four(job, four, &a);
    for (int i = 0; i < a.count; i++) {
        const double *const t[3] = {a.position[i][0], a.position[i][1], a.position[i][2]};
        bvxi_orient_plane_of(t, &a.plane[i]);
    }

    /* Each pair is found by the one of both that comes first along the curve: here those within the four. */
    uint64_t found = crossings_of_fours(&a, &a, keys);

    /* Then what follows it, by one box around all four, so that the tree is walked once for all. */
    crossings_box_of(a.boxes, 0, low, high);
    for (int i = 1; i < a.count; i++) {
        crossings_box_of(a.boxes, i, l, h);
        for (int k = 0; k < 3; k++) {
            low[k] = l[k] < low[k] ? l[k] : low[k];
            high[k] = h[k] > high[k] ? h[k] : high[k];
        }
    }

    if (tree->level_count > 1) {
        stack[depth].node = 0;
        stack[depth++].level = tree->level_count - 1;
    }
    while (depth > 0) {
        uint64_t const node = stack[--depth].node;
        int32_t const level = stack[depth].level - 1; /* of its children */
        uint64_t const first = node * BVXI_CLOSEST_WIDTH;
        int const count = bvxi_closest_children(tree->level_nodes[level], first);
        unsigned met = crossings_boxes_met(&tree->nodes[tree->level_first[level + 1] + node], count, low,
                                           high);

        for (uint64_t child = first; met != 0; child++, met >>= 1) {
            /* A child of this level holds 4^level fours. Those up to this four have had their turn. */
            if ((met & 1) == 0 || (child + 1) << 2 * level <= four + 1) continue;
            if (level > 0) {
                stack[depth].node = child;
                stack[depth++].level = level;
                continue;
            }
            crossings_open_four(job, child, &b);
            found += crossings_of_fours(&a, &b, keys != NULL ? keys + found : NULL);
        }
    }
    return found;
}

static void count_crossings_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const crossings_job *const job = user;
    uint64_t count = 0;
    for (uint64_t i = begin; i < end; i++) {
        uint64_t const found = crossings_of_four(job, i, NULL);
        /* Most fours cross nothing: the second run, which writes, leaves them out. */
        job->marks[i] = found != 0;
        count += found;
    }
    job->counts[index] = count;
}

static void write_crossings_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const crossings_job *const job = user;
    uint64_t *to = job->keys + job->counts[index];
    /* Each piece writes from the place that the counts have given it. */
    for (uint64_t i = begin; i < end; i++)
        if (job->marks[i]) to += crossings_of_four(job, i, to);
}

/* ---- The whole mesh ---- */

static bvx_status write_crossings(bvx_context *ctx, crossings_job *job, uint64_t count, uint32_t *pairs)
{
    uint32_t *numbers = NULL;

    /* Pieces write side by side, and no thread shows. */
    (void)bvxi_place_counts(job->counts, (uint64_t)job->pieces);
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the crossings' keys", job->keys));
    BVXI_TRY(BVXI_ZEROS(ctx, count, "the crossings' numbers", numbers));
    BVXI_TRY(bvxi_for_pieces(ctx, "crossings", 0.9, 1.0, job->pieces, job->tree.level_nodes[0],
                             write_crossings_piece, job));

    /* The order of the search shows in nothing: pairs are listed by their indices. */
    BVXI_TRY(bvxi_radix_sort(ctx, job->keys, numbers, count));

    for (uint64_t i = 0; i < count; i++) {
        pairs[2 * i] = (uint32_t)(job->keys[i] >> 32);
        pairs[2 * i + 1] = (uint32_t)(job->keys[i] & UINT32_MAX);
    }
    return BVX_OK;
}

static bvx_status search_crossings(bvx_context *ctx, crossings_job *job, uint64_t *count)
{
    uint64_t const fours = job->tree.level_nodes[0];
    uint64_t sum = 0;

    job->pieces = bvxi_piece_count(fours, CROSSINGS_GRAIN);
    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, job->tree.triangle_count * 12, "the crossings' corners", &job->corner));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, fours, "the crossings' marks", &job->marks));
    BVXI_TRY(BVXI_ARRAY(ctx, (uint64_t)job->pieces, "the crossings' counts", job->counts));

    BVXI_TRY(BVXI_SHARE(ctx, 0.3, 0.35,
                        bvxi_for(ctx, "crossings", fours, CROSSINGS_GRAIN, crossings_corners, job)));
    BVXI_TRY(bvxi_for_pieces(ctx, "crossings", 0.35, 0.9, job->pieces, job->tree.level_nodes[0],
                             count_crossings_piece, job));

    /* In the order of pieces, though a sum of whole numbers has no order. */
    for (int32_t i = 0; i < job->pieces; i++) sum += job->counts[i];
    *count = sum;
    return BVX_OK;
}

static bvx_status give_crossings(bvx_context *ctx, const char *function, crossings_job *job, uint64_t *count,
                                 uint32_t *pairs, uint64_t capacity)
{
    uint64_t found = 0;

    BVXI_TRY(search_crossings(ctx, job, &found));

    /* The count is right also where the array is too small: the caller learns what would be enough. */
    if (pairs != NULL && capacity < found) {
        *count = found;
        return bvxi_fail(ctx, BVX_ERR_CAPACITY, "%s: there are %u pairs, the array given holds %u", function,
                         found, capacity);
    }
    if (pairs != NULL && found > UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: there are %u pairs, the limit of a list is %u", function, found,
                             (uint64_t)UINT32_MAX);

    if (pairs != NULL && found != 0) BVXI_TRY(BVXI_SCOPE(ctx, write_crossings(ctx, job, found, pairs)));
    *count = found;
    return BVX_OK;
}

bvx_status bvxi_mesh_crossings(bvx_context *ctx, const char *function, const bvxi_welded *mesh,
                               uint64_t *count, uint32_t *pairs, uint64_t capacity)
{
    uint64_t const mark = bvxi_scratch_begin(ctx);
    crossings_job job;
    memset(&job, 0, sizeof job);
    job.view = mesh->view;
    job.representative = mesh->representative;
    bvx_status status = bvxi_closest_build(bvxi_call_of(ctx, NULL, "crossings", 0.0, 0.3), mesh->view,
                                           mesh->low, mesh->high, bvxi_unit_scale(mesh->low, mesh->high),
                                           &job.tree);
    if (status == BVX_OK) status = give_crossings(ctx, function, &job, count, pairs, capacity);
    return bvxi_scratch_end(ctx, mark, status);
}

static bvx_status run_mesh_crossings(bvx_context *context, const bvx_mesh_view *mesh, uint64_t *count,
                                     uint32_t *pairs, uint64_t capacity)
{
    static const char *const function = "bvx_mesh_crossings";
    uint32_t *representative = NULL;
    bvxi_welded welded = {.view = mesh};

    if (count == NULL) return bvxi_fail_null(context, function, "count");
    *count = 0;
    BVXI_TRY(bvxi_view_check(context, function, mesh));
    if (mesh->triangle_count == 0) return BVX_OK;
    BVXI_TRY(bvxi_view_bounds(context, function, mesh, welded.low, welded.high));

    /* Triangles that share a position share a corner, whatever their vertices' indices. */
    BVXI_TRY(
        bvxi_alloc(context, BVXI_SCRATCH, mesh->vertex_count * 4, "the crossings' welding", &representative));
    welded.representative = representative;
    BVXI_TRY(bvxi_weld(context, mesh, representative, &welded.different));
    return bvxi_mesh_crossings(context, function, &welded, count, pairs, capacity);
}

bvx_status bvx_mesh_crossings(bvx_context *context, const bvx_mesh_view *mesh, uint64_t *count,
                              uint32_t *pairs, uint64_t capacity)
{
    return BVXI_CALL(context, run_mesh_crossings(context, mesh, count, pairs, capacity));
}
