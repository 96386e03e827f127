/* closest_build.c - a hierarchy of boxes over triangles.
 *
 * Source: Kamel, Faloutsos. On Packing R-trees. 1993: sort by a curve through space, then pack each four
 * neighbours into a node, level by level; no pointers, no recursion, the shape follows from the count only.
 * The curve is Morton's over the centres of the triangles' boxes; equal places keep the order of triangle
 * indices, or are ordered by a hash of the corners' positions where no numbering may show.
 * Boxes are floats rounded outwards, in units in which the mesh lies within [-1, 1]. */
#include "nearest/closest.h"
#include "bits/sort.h"
#include "core/vec3.h"
#include "mesh/facet.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

enum {
    CLOSEST_BITS = 16,   /* of the curve along each axis */
    CLOSEST_FEW = 16,    /* triangles of one key that are sorted one by one */
    CLOSEST_GRAIN = 4096 /* least triangles or nodes a task */
};

typedef struct closest_builder {
    bvxi_closest_tree *tree;
    const bvx_mesh_view *view;
    uint64_t *keys;
    int unnumbered; /* 1: the numbers of triangles, vertices and corners do not show */
} closest_builder;

/* Bounds of a triangle in box units. */
static void closest_triangle_box(const bvxi_closest_tree *tree, const double t[3][3], double low[3],
                                 double high[3])
{
    for (int a = 0; a < 3; a++) {
        double lo = t[0][a], hi = t[0][a];
        for (int k = 1; k < 3; k++) {
            lo = t[k][a] < lo ? t[k][a] : lo;
            hi = t[k][a] > hi ? t[k][a] : hi;
        }
        /* Box units lie in [-1, 1] about the middle, where floats are densest. */
        low[a] = (lo - tree->centre[a]) * tree->box_scale;
        high[a] = (hi - tree->centre[a]) * tree->box_scale;
    }
}

/* Place on the curve; box units lie in [-1, 1]. */
static uint64_t curve_key(const double low[3], const double high[3])
{
    double const most = (double)((1 << CLOSEST_BITS) - 1);
    uint64_t key = 0;
    /* Bits of the three axes in turn: neighbours on the curve are neighbours in space. */
    for (int a = 0; a < 3; a++) {
        double const x = ((low[a] + high[a]) * 0.25 + 0.5) * most;
        key |= bvxi_curve_spread(x <= 0.0 ? 0 : x >= most ? (uint64_t)most : (uint64_t)x) << a;
    }
    return key;
}

static void make_curve_keys(void *user, uint64_t begin, uint64_t end)
{
    const closest_builder *const b = user;
    uint64_t *const keys = b->keys;
    uint32_t *const order = b->tree->order;
    double t[3][3], low[3], high[3];
    uint32_t c[3];

    for (uint64_t i = begin; i < end; i++) {
        bvxi_view_triangle(b->view, i, c);
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(b->view, c[k], t[k]);
            for (int a = 0; a < 3; a++) t[k][a] *= b->tree->scale;
        }

        /* The middle of the triangle's box, which no order of corners changes. */
        closest_triangle_box(b->tree, (const double(*)[3])t, low, high);
        keys[i] = curve_key(low, high);
        order[i] = (uint32_t)i;
    }
}

/* Turn a triangle's corners: the lowest position first, of two such corners the one whose next is lower. */
static void turn_to_lowest(const bvx_mesh_view *view, uint32_t c[3])
{
    double p[3][3];
    uint32_t const was[3] = {c[0], c[1], c[2]};
    int first = 0;
    for (int k = 0; k < 3; k++) bvxi_view_position(view, c[k], p[k]);
    /* Two corners may lie at one place; then what follows them decides. */
    for (int k = 1; k < 3; k++)
        if (bvxi_corner_before(p[k], p[first]) ||
            (!bvxi_corner_before(p[first], p[k]) && bvxi_corner_before(p[(k + 1) % 3], p[(first + 1) % 3])))
            first = k;
    for (int k = 0; k < 3; k++) c[k] = was[(first + k) % 3];
}

static uint64_t hash_of_corners(const bvx_mesh_view *view, uint64_t triangle)
{
    uint32_t c[3];
    bvxi_view_triangle(view, triangle, c);
    turn_to_lowest(view, c);
    return bvxi_view_corners_hash(view, c, 1.0);
}

/* A few triangles of one key by their hashes, which are in keys. */
static void order_few(uint64_t *keys, uint32_t *order, uint64_t count)
{
    /* Insertion: runs are short, and a sort by digits would clear its counts for each of them. */
    for (uint64_t i = 1; i < count; i++) {
        uint64_t const key = keys[i];
        uint32_t const triangle = order[i];
        uint64_t j = i;
        for (; j > 0 && keys[j - 1] > key; j--) {
            keys[j] = keys[j - 1];
            order[j] = order[j - 1];
        }
        keys[j] = key;
        order[j] = triangle;
    }
}

/* Triangles of equal keys by a hash of their positions, which takes the place of their keys. Few share one. */
static bvx_status order_by_positions(bvx_context *ctx, const closest_builder *b)
{
    uint64_t const n = b->tree->triangle_count;
    uint64_t end;

    for (uint64_t first = 0; first < n; first = end) {
        uint64_t *const key = b->keys + first;
        uint32_t *const order = b->tree->order + first;
        for (end = first + 1; end < n && b->keys[end] == *key;) end++;
        if (end - first == 1) continue;
        for (uint64_t i = 0; i < end - first; i++) key[i] = hash_of_corners(b->view, order[i]);
        if (end - first <= CLOSEST_FEW) order_few(key, order, end - first);
        else BVXI_TRY(bvxi_radix_sort(ctx, key, order, end - first));
    }
    return BVX_OK;
}

static void copy_curve_corners(const closest_builder *b, uint64_t place)
{
    size_t const point = b->tree->position_type == BVX_F32 ? 12 : 24;
    unsigned char *const to = (unsigned char *)b->tree->corners + 3 * point * (size_t)place;
    uint32_t c[3];
    bvxi_view_triangle(b->view, b->tree->order[place], c);
    if (b->unnumbered) turn_to_lowest(b->view, c);
    /* As bytes, of any alignment. */
    for (size_t k = 0; k < 3; k++) {
        double p[3];
        if (point == 24) bvxi_view_position(b->view, c[k], p);
        memcpy(to + k * point, point == 24 ? (const void *)p : bvxi_view_position_at(b->view, c[k]), point);
    }
}

static void fill_lowest_boxes(void *user, uint64_t begin, uint64_t end)
{
    const closest_builder *const b = user;
    bvxi_closest_tree *const tree = b->tree;
    double t[3][3], low[3], high[3];

    for (uint64_t i = begin; i < end; i++) {
        uint64_t const first = i * BVXI_CLOSEST_WIDTH;
        int const n = bvxi_closest_children(tree->triangle_count, first);
        memset(&tree->nodes[i], 0, sizeof tree->nodes[i]); /* slots without a triangle hold numbers too */
        for (int k = 0; k < n; k++) {
            /* Corners lie in the order of the curve, so that a search reads memory that is near. */
            copy_curve_corners(b, first + (uint64_t)k);
            bvxi_closest_corners(tree, first + (uint64_t)k, t);
            closest_triangle_box(tree, (const double(*)[3])t, low, high);
            for (int a = 0; a < 3; a++) {
                tree->nodes[i].low[a][k] = bvxi_float_below(low[a]);
                tree->nodes[i].high[a][k] = bvxi_float_above(high[a]);
            }
        }
    }
}

/* A level above the lowest; slots counts what the nodes of the level below hold. */
typedef struct box_level {
    bvxi_closest_tree *tree;
    uint64_t slots;
    int32_t level, pieces;
} box_level;

/* Boxes around the nodes of the level below. */
static void fill_box_level(void *user, int32_t index)
{
    const box_level *const l = user;
    bvxi_closest_tree *const tree = l->tree;
    const bvxi_closest_node *const from = tree->nodes + tree->level_first[l->level - 1];
    bvxi_closest_node *const to = tree->nodes + tree->level_first[l->level];
    uint64_t const below = tree->level_nodes[l->level - 1];
    uint64_t begin, end;

    bvxi_piece(tree->level_nodes[l->level], l->pieces, index, &begin, &end);
    memset(to + begin, 0, (size_t)(end - begin) * sizeof *to);

    /* A node of this level holds the boxes of four below, each around all that its own four hold. */
    for (uint64_t i = begin * BVXI_CLOSEST_WIDTH; i < end * BVXI_CLOSEST_WIDTH && i < below; i++) {
        bvxi_closest_node *const node = &to[i / BVXI_CLOSEST_WIDTH];
        int const used = bvxi_closest_children(l->slots, i * BVXI_CLOSEST_WIDTH);
        for (int a = 0; a < 3; a++) {
            float low = from[i].low[a][0], high = from[i].high[a][0];
            for (int j = 1; j < used; j++) {
                low = from[i].low[a][j] < low ? from[i].low[a][j] : low;
                high = from[i].high[a][j] > high ? from[i].high[a][j] : high;
            }
            node->low[a][i % BVXI_CLOSEST_WIDTH] = low;
            node->high[a][i % BVXI_CLOSEST_WIDTH] = high;
        }
    }
}

static void plan_closest_tree(const bvx_mesh_view *view, const double low[3], const double high[3],
                              double scale, bvxi_closest_tree *tree)
{
    uint64_t n = view->triangle_count;
    double half[3], minus[3];

    memset(tree, 0, sizeof *tree);
    tree->triangle_count = n;
    tree->position_type = (int32_t)bvxi_view_type(view);
    tree->scale = scale;

    /* Around the middle a float has most digits for what lies at the mesh's rim. */
    for (int a = 0; a < 3; a++) {
        tree->centre[a] = (low[a] * scale + high[a] * scale) * 0.5;
        half[a] = (high[a] * scale - low[a] * scale) * 0.5;
        minus[a] = -half[a];
    }
    tree->box_scale = bvxi_unit_scale(minus, half);

    /* The shape follows from the count only: levels need no pointers. */
    do {
        n = (n + BVXI_CLOSEST_WIDTH - 1) / BVXI_CLOSEST_WIDTH;
        tree->level_first[tree->level_count] = tree->node_count;
        tree->level_nodes[tree->level_count++] = n;
        tree->node_count += n;
    } while (n > 1);
}

static uint64_t closest_corner_bytes(const bvxi_closest_tree *tree)
{
    return tree->triangle_count * (tree->position_type == BVX_F32 ? 36 : 72);
}

static bvx_status sort_along_curve(bvxi_call call, closest_builder *b)
{
    uint64_t const n = b->tree->triangle_count;
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, n * sizeof *b->keys, "the search tree's keys", &b->keys));
    /* Keys side by side; the sort is stable, so equal keys stay in the order of their indices. */
    BVXI_TRY(BVXI_SHARE(call.ctx, call.from, call.to,
                        bvxi_for(call.ctx, call.stage, n, CLOSEST_GRAIN, make_curve_keys, b)));
    BVXI_TRY(bvxi_radix_sort(call.ctx, b->keys, b->tree->order, n));
    if (b->unnumbered) BVXI_TRY(order_by_positions(call.ctx, b));
    bvxi_drop(call.ctx, b->keys);
    return BVX_OK;
}

static bvx_status build_closest_tree(bvxi_call call, closest_builder *b)
{
    bvxi_closest_tree *const tree = b->tree;
    double const middle = (call.from + call.to) * 0.5;
    uint64_t const order_bytes = tree->triangle_count * sizeof *tree->order;
    uint64_t const node_bytes = tree->node_count * sizeof *tree->nodes;

    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, order_bytes, "the search tree's order", &tree->order));
    BVXI_TRY(sort_along_curve(bvxi_call_part(call, call.from, middle), b));

    /* The keys are gone by now, so both are never held at once. */
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, closest_corner_bytes(tree), "the search tree's corners",
                        &tree->corners));
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, node_bytes, "the search tree's boxes", &tree->nodes));

    BVXI_TRY(BVXI_SHARE(
        call.ctx, middle, call.to,
        bvxi_for(call.ctx, call.stage, tree->level_nodes[0], CLOSEST_GRAIN, fill_lowest_boxes, b)));
    for (int32_t l = 1; l < tree->level_count; l++) {
        box_level level = {tree, l == 1 ? tree->triangle_count : tree->level_nodes[l - 2], l,
                           bvxi_piece_count(tree->level_nodes[l], CLOSEST_GRAIN)};
        bvxi_tasks(call.ctx, level.pieces, fill_box_level, &level);
    }
    return BVX_OK;
}

/* b holds the tree, the view, and whether numbers show. A tree that is half made has arrays already. */
static bvx_status build_or_free(bvxi_call call, closest_builder *b, const double low[3], const double high[3],
                                double scale)
{
    plan_closest_tree(b->view, low, high, scale, b->tree);
    b->tree->fast = bvxi_cpu(call.ctx) == BVX_CPU_AVX2;
    bvx_status const status = build_closest_tree(call, b);
    if (status != BVX_OK) bvxi_closest_free(call.ctx, b->tree);
    return status;
}

bvx_status bvxi_closest_build(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                              const double high[3], double scale, bvxi_closest_tree *tree)
{
    closest_builder b = {.tree = tree, .view = view};
    return build_or_free(call, &b, low, high, scale);
}

bvx_status bvxi_closest_build_unnumbered(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                                         const double high[3], double scale, bvxi_closest_tree *tree)
{
    closest_builder b = {.tree = tree, .view = view, .unnumbered = 1};
    BVXI_TRY(build_or_free(call, &b, low, high, scale));
    /* Of equally near triangles the one that comes first along the curve counts. */
    for (uint64_t i = 0; i < tree->triangle_count; i++) tree->order[i] = (uint32_t)i;
    return BVX_OK;
}

void bvxi_closest_free(bvx_context *ctx, bvxi_closest_tree *tree)
{
    bvxi_free(ctx, tree->nodes, tree->node_count * sizeof *tree->nodes);
    bvxi_free(ctx, tree->corners, closest_corner_bytes(tree));
    bvxi_free(ctx, tree->order, tree->triangle_count * sizeof *tree->order);
    memset(tree, 0, sizeof *tree);
}
