/* nearest_build.c - the tree that nearest_brick.c searches: triangles along a curve through space, eight a
 * leaf, eight boxes a node.
 *
 * A leaf keeps each triangle in a frame of its own, in which a distance is one in a plane and a height.
 * Sources at the headings below. */
#include "nearest/closest.h"
#include "nearest/nearest_brick.h"
#include "core/simd.h"
#include "core/vec3.h"
#include "mesh/view.h"

#include <math.h>

/* ---- Triangles in frames of their own, eight at a time ---- */

/* Source: Jones. 3D Distance from a Point to a Triangle. 1995: turn the triangle into a plane, so that a
 * distance is one in two dimensions and a height. Here the frame stands on the longest edge, at the foot of
 * the altitude: the nearest point to one with x < 0 then lies in the left part, a right triangle (going along
 * x to the altitude never leaves the triangle), so one edge is asked beside the base instead of two.
 * Guarantee: the triangle with the corners foot - p e1, foot + q e1, foot + h e2 lies within 2^-21 of the
 * leaf's extent of the one given, for every triangle: e2 gets a trace of a direction across e1, so there is
 * one where the height is 0, and is made orthogonal a second time, so a needle turns about its own axis by no
 * more than its corner's rounding. */

#define NEAR_LEAST 0x1p-120f /* below it lengths and squares are 0 */
#define NEAR_TRACE 0x1p-30f

typedef struct near_box {
    float low[3], high[3];
    float point[3]; /* of a leaf: from low to the foot of the first triangle's frame */
} near_box;

#define BVXI_SIMD_LEVEL _base
#include "nearest/nearest_leaf_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/nearest_leaf_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_near_make_leaf(const uint32_t number[BVXI_NEAR_WIDTH], const float corner[9][BVXI_NEAR_WIDTH],
                         const float low[3], int32_t fast, bvxi_near_leaf *leaf)
{
    BVXI_PATH(fast, frame_near_leaf_base(corner, low, leaf), frame_near_leaf_avx2(corner, low, leaf));
    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) leaf->frame[k].triangle = number[k];
}

/* ---- The hierarchy of boxes over a mesh's triangles ---- */

/* Source: Kamel, Faloutsos. On Packing R-trees. 1993: sort by a curve through space (nearest_order.c), then
 * pack up to eight neighbours into a leaf and eight boxes into a node, level by level; no pointers, no recursion.
 * Where the curve jumps a leaf ends before its eighth child. Boxes are floats rounded outwards. */

enum {
    NEAR_LEAF_GRAIN = 4096, /* least triangles a task */
    NEAR_AHEAD = 24         /* triangles that memory is requested ahead */
};

typedef struct near_builder {
    bvxi_nearest *n;
    bvxi_curve curve;
    near_box *boxes;                  /* of leaves [Size: leaves] */
    uint64_t first[BVXI_MOST_PIECES]; /* leaves of each piece, then the first one */
    int32_t pieces, fast;
} near_builder;

/* ---- Boxes ---- */

/* Ask for the memory of a triangle some leaves ahead: first of its indices, then of its vertices. */
static inline void prefetch_near(const near_builder *b, uint64_t i, uint64_t end)
{
    const bvx_mesh_view *const v = &b->n->view;
    uint32_t c[3];
    /* Meshes with indices wait twice, for those and then for the vertices. */
    if (i + 2 * NEAR_AHEAD >= end || v->indices == NULL) return;
    BVXI_PREFETCH(bvxi_view_index_at(v, b->curve.order[i + 2 * NEAR_AHEAD]));
    bvxi_view_triangle(v, b->curve.order[i + NEAR_AHEAD], c);
    for (int k = 0; k < 3; k++) BVXI_PREFETCH(bvxi_view_position_at(v, c[k]));
}

static uint32_t near_leaf_run(const near_builder *b, uint64_t first, uint64_t end)
{
    return bvxi_near_cut(b->curve.keys + first, end - first, b->n->triangle_count < BVXI_NEAR_CUT_BELOW);
}

static void count_near_leaves(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    near_builder *const b = user;
    uint64_t leaves = 0;
    /* Cuts are looked for within the piece only, so that pieces need not wait for each other. */
    for (; begin < end; leaves++) begin += near_leaf_run(b, begin, end);
    b->first[index] = leaves;
}

static void fill_near_leaves(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const near_builder *const b = user;
    uint64_t leaf = b->first[index];
    while (begin < end) {
        uint32_t const count = near_leaf_run(b, begin, end);
        const bvxi_nearest *const n = b->n;
        uint32_t order[BVXI_NEAR_WIDTH];
        double corner[9][BVXI_NEAR_WIDTH];
        float local[9][BVXI_NEAR_WIDTH];

        /* A leaf that is not full holds its last triangle again: eight are always measured. */
        for (uint32_t k = 0; k < BVXI_NEAR_WIDTH; k++) {
            order[k] = b->curve.order[begin + (k < count ? k : count - 1)];
            prefetch_near(b, begin + k, end);
        }

        bvxi_curve_gather(&n->view, order, corner);
        BVXI_PATH(b->fast,
                  bound_near_leaf_base(n, (const double(*)[BVXI_NEAR_WIDTH])corner, &b->boxes[leaf], local),
                  bound_near_leaf_avx2(n, (const double(*)[BVXI_NEAR_WIDTH])corner, &b->boxes[leaf], local));
        bvxi_near_make_leaf(order, (const float(*)[BVXI_NEAR_WIDTH])local, b->boxes[leaf].low, b->fast,
                            &n->leaves[leaf]);

        /* A point of the first triangle bounds how far the leaf's nearest can be. */
        for (int a = 0; a < 3; a++)
            b->boxes[leaf].point[a] = n->leaves[leaf].frame[0].f[BVXI_NEAR_FOOT + a] - b->boxes[leaf].low[a];
        begin += count;
        leaf++;
    }
}

/* ---- Nodes ---- */

/* Make the nodes of a level; their own boxes take the place of their
 * children's. Children that there are not are points far from everything. */
static void fill_near_nodes(near_box *boxes, uint64_t count, bvxi_near_node *nodes)
{
    for (uint64_t first = 0, made = 0; first < count; first += BVXI_NEAR_WIDTH, made++) {
        uint32_t const run = count - first < BVXI_NEAR_WIDTH ? (uint32_t)(count - first) : BVXI_NEAR_WIDTH;
        near_box box = boxes[first];

        /* Children stand side by side, so that one number finds them all. */
        nodes[made].first = (uint32_t)first;
        for (uint32_t k = 0; k < BVXI_NEAR_WIDTH; k++)
            for (int a = 0; a < 3; a++) {
                nodes[made].low[a][k] = k < run ? boxes[first + k].low[a] : 0x1p62f;
                nodes[made].high[a][k] = k < run ? boxes[first + k].high[a] : 0x1p62f;
                nodes[made].point[a][k] = k < run ? boxes[first + k].point[a] : 0.0f;
            }
        for (uint32_t k = 1; k < run; k++)
            for (int a = 0; a < 3; a++) {
                float const low = boxes[first + k].low[a], high = boxes[first + k].high[a];
                box.low[a] = low < box.low[a] ? low : box.low[a];
                box.high[a] = high > box.high[a] ? high : box.high[a];
            }
        boxes[made] = box; /* made <= first: that child is in a node already */
    }
}

/* ---- The whole ---- */

/* Box units: floats are finest around the lattice's middle. The curve's grid lies where mesh and lattice are,
 * so that triangles far off leave it fine: their places are moved onto its sides. */
static void plan_near_tree(const double low[3], const double high[3], near_builder *b)
{
    bvxi_nearest *const n = b->n;
    const bvx_lattice *const l = &n->lattice;
    double half[3], minus[3], side = 0.0;

    for (int a = 0; a < 3; a++) {
        double const first = l->origin[a] * n->scale;
        double const last = (l->origin[a] + (double)l->dims[a] * l->spacing[a]) * n->scale;
        n->middle[a] = first + (last - first) * 0.5;
        half[a] = (last - first) * 0.5;
        minus[a] = -half[a];
    }

    /* A power of two, so that changing units rounds nothing. */
    n->box_scale = bvxi_unit_scale(minus, half);
    while (n->box_scale > 0x1p50) n->box_scale *= 0.5; /* the mesh itself must be within reach of floats */
    for (int a = 0; a < 3; a++) {
        /* At most twice the lattice's box: cells farther off would serve few centres. */
        double const x = (low[a] * n->scale - n->middle[a]) * n->box_scale;
        double const y = (high[a] * n->scale - n->middle[a]) * n->box_scale;
        double const from = x > -2.0 ? x : y < -2.0 ? x : -2.0, to = y < 2.0 ? y : x > 2.0 ? y : 2.0;
        b->curve.centre[a] = n->middle[a] + (from + to) * 0.5 / n->box_scale;
        side = to - from > side ? to - from : side;
    }
    /* Cells about as large as voxels and triangles are fine enough, and fewer digits are sorted sooner. */
    for (b->curve.bits = 8; b->curve.bits < BVXI_CURVE_BITS; b->curve.bits++) {
        int32_t const cells = 1 << b->curve.bits;
        if (cells >= l->dims[0] && cells >= l->dims[1] && cells >= l->dims[2] &&
            (uint64_t)cells * (uint64_t)cells >= n->triangle_count)
            break;
    }
    b->curve.fast = b->fast;
    b->curve.view = &n->view;
    b->curve.scale = n->scale;
    b->curve.units = 2.0 * n->box_scale / side;
}

bvx_status bvxi_near_build(bvxi_call call, const double low[3], const double high[3], bvxi_nearest *n)
{
    double const middle = (call.from + call.to) * 0.5;
    near_builder b = {.n = n, .fast = bvxi_cpu(call.ctx) == BVX_CPU_AVX2};

    /* The order first, then leaves of what it puts side by side, then levels of boxes above them. */
    plan_near_tree(low, high, &b);
    BVXI_TRY(BVXI_ARRAY(call.ctx, n->triangle_count, "the search tree's keys", b.curve.keys));
    BVXI_TRY(BVXI_ARRAY(call.ctx, n->triangle_count, "the search tree's order", b.curve.order));
    BVXI_TRY(bvxi_curve_sort(bvxi_call_part(call, call.from, middle), &b.curve));

    /* How many leaves a piece makes shows only after it was cut, so all are counted before any is written. */
    call = bvxi_call_part(call, middle, call.to);
    double const counted = call.from + (call.to - call.from) * 0.125;
    b.pieces = bvxi_piece_count(n->triangle_count, NEAR_LEAF_GRAIN);
    BVXI_TRY(bvxi_for_pieces(call.ctx, call.stage, call.from, counted, b.pieces, n->triangle_count,
                             count_near_leaves, &b));
    n->leaf_count = bvxi_place_counts(b.first, (uint64_t)b.pieces);
    BVXI_TRY(BVXI_ARRAY(call.ctx, n->leaf_count, "the search tree's triangles", n->leaves));
    BVXI_TRY(BVXI_ARRAY(call.ctx, n->leaf_count, "the search tree's boxes", b.boxes));
    BVXI_TRY(bvxi_for_pieces(call.ctx, call.stage, counted, call.to, b.pieces, n->triangle_count,
                             fill_near_leaves, &b));

    uint64_t count = n->leaf_count;

    do {
        bvxi_near_node **const nodes = &n->level[n->level_count++];
        uint64_t const made = (count + BVXI_NEAR_WIDTH - 1) / BVXI_NEAR_WIDTH;
        BVXI_TRY(BVXI_ARRAY(call.ctx, made, "the search tree's nodes", *nodes));
        fill_near_nodes(b.boxes, count, *nodes);
        count = made;
    } while (count > 1);
    bvxi_drop(call.ctx, b.boxes);
    bvxi_drop(call.ctx, b.curve.order);
    bvxi_drop(call.ctx, b.curve.keys);
    return BVX_OK;
}

void bvxi_near_free(bvx_context *ctx, bvxi_nearest *n)
{
    for (int32_t l = n->level_count; l-- > 0;) bvxi_drop(ctx, n->level[l]);
    bvxi_drop(ctx, n->leaves);
}
