/* closest_build.c - a hierarchy of boxes over triangles.
 *
 * Source: Kamel, Faloutsos. On Packing R-trees. 1993: sort by a curve through space (nearest_order.c), then pack
 * each four neighbours into a node, level by level; no pointers, no recursion, the shape follows from the count only.
 * Equal places keep the order of triangle indices, or are ordered by a hash of the corners' positions where no
 * numbering may show.
 * Boxes are floats rounded outwards, in units in which the mesh lies within [-1, 1]. */
#include "nearest/closest.h"
#include "bits/sort.h"
#include "core/vec3.h"
#include "mesh/facet.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

enum {
    CLOSEST_FEW = 16,    /* triangles of one key that are sorted one by one */
    CLOSEST_GRAIN = 4096 /* least triangles or nodes a task */
};

typedef struct closest_builder {
    bvxi_closest_tree *tree;
    bvxi_curve curve;
    int unnumbered; /* 1: the numbers of triangles, vertices and corners do not show */
} closest_builder;

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
            uint64_t const place = first + (uint64_t)k;
            size_t const point = b->tree->position_type == BVX_F32 ? 12 : 24;
            unsigned char *const to = (unsigned char *)b->tree->corners + 3 * point * (size_t)place;
            uint32_t c[3];
            bvxi_view_triangle(b->curve.view, b->tree->order[place], c);
            if (b->unnumbered) turn_to_lowest(b->curve.view, c);
            /* As bytes, of any alignment. */
            for (size_t m = 0; m < 3; m++) {
                double p[3];
                if (point == 24) bvxi_view_position(b->curve.view, c[m], p);
                memcpy(to + m * point,
                       point == 24 ? (const void *)p : bvxi_view_position_at(b->curve.view, c[m]), point);
            }
            bvxi_closest_corners(tree, first + (uint64_t)k, t);
            bvxi_curve_box(&b->curve, (const double(*)[3])t, low, high);
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
    int32_t level;
} box_level;

/* Boxes around the nodes of the level below. */
static void fill_box_level(void *user, uint64_t begin, uint64_t end)
{
    const box_level *const l = user;
    bvxi_closest_tree *const tree = l->tree;
    const bvxi_closest_node *const from = tree->nodes + tree->level_first[l->level - 1];
    bvxi_closest_node *const to = tree->nodes + tree->level_first[l->level];
    uint64_t const below = tree->level_nodes[l->level - 1];

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

static uint64_t closest_corner_bytes(const bvxi_closest_tree *tree)
{
    return tree->triangle_count * (tree->position_type == BVX_F32 ? 36 : 72);
}

static bvx_status sort_closest_triangles(bvxi_call call, closest_builder *b)
{
    BVXI_TRY(BVXI_ARRAY(call.ctx, b->tree->triangle_count, "the search tree's keys", b->curve.keys));
    BVXI_TRY(bvxi_curve_sort(call, &b->curve));
    if (!b->unnumbered) return BVX_OK;

    uint64_t *const keys = b->curve.keys, n = b->tree->triangle_count, end;
    uint32_t *const order = b->tree->order;

    for (uint64_t first = 0; first < n; first = end) {
        for (end = first + 1; end < n && keys[end] == keys[first];) end++;
        for (uint64_t i = first; i < end && end - first > 1; i++) {
            double p[3][3];
            uint32_t c[3];
            bvxi_view_triangle(b->curve.view, order[i], c);
            turn_to_lowest(b->curve.view, c);
            for (int k = 0; k < 3; k++) bvxi_view_position(b->curve.view, c[k], p[k]);
            keys[i] = bvxi_corners_hash((const double(*)[3])p, 1.0);
        }
        if (end - first <= CLOSEST_FEW) order_few(keys + first, order + first, end - first);
        else BVXI_TRY(bvxi_radix_sort(call.ctx, keys + first, order + first, end - first));
    }
    return BVX_OK;
}

static bvx_status build_closest_tree(bvxi_call call, closest_builder *b)
{
    bvxi_closest_tree *const tree = b->tree;
    double const middle = (call.from + call.to) * 0.5;

    BVXI_TRY(BVXI_ARRAY(call.ctx, tree->triangle_count, "the search tree's order", tree->order));
    b->curve.order = tree->order;
    /* The keys go before corners and boxes come, so that both are never held at once. */
    BVXI_TRY(BVXI_SCOPE(call.ctx, sort_closest_triangles(bvxi_call_part(call, call.from, middle), b)));
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, closest_corner_bytes(tree), "the search tree's corners",
                        &tree->corners));
    BVXI_TRY(BVXI_ARRAY(call.ctx, tree->node_count, "the search tree's boxes", tree->nodes));
    BVXI_TRY(BVXI_SHARE(
        call.ctx, middle, call.to,
        bvxi_for(call.ctx, call.stage, tree->level_nodes[0], CLOSEST_GRAIN, fill_lowest_boxes, b)));
    for (int32_t l = 1; l < tree->level_count; l++) {
        box_level level = {tree, l == 1 ? tree->triangle_count : tree->level_nodes[l - 2], l};
        BVXI_TRY(bvxi_for_ranges(call.ctx, call.stage, call.to, call.to,
                                 bvxi_piece_count(tree->level_nodes[l], CLOSEST_GRAIN), tree->level_nodes[l],
                                 fill_box_level, &level));
    }
    return BVX_OK;
}

static bvx_status plan_and_build(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                                 const double high[3], double scale, int unnumbered, bvxi_closest_tree *tree)
{
    uint64_t const mark = bvxi_scratch_begin(call.ctx);
    closest_builder b = {.tree = tree, .unnumbered = unnumbered};

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

    tree->fast = bvxi_cpu(call.ctx) == BVX_CPU_AVX2;
    b.curve.bits = BVXI_CURVE_BITS;
    b.curve.fast = tree->fast;
    b.curve.view = view;
    b.curve.scale = scale;
    b.curve.units = tree->box_scale;
    memcpy(b.curve.centre, tree->centre, sizeof tree->centre);
    bvx_status const status = bvxi_scratch_keep(call.ctx, mark, build_closest_tree(call, &b));
    if (status != BVX_OK) memset(tree, 0, sizeof *tree);
    return status;
}

bvx_status bvxi_closest_build(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                              const double high[3], double scale, bvxi_closest_tree *tree)
{
    return plan_and_build(call, view, low, high, scale, 0, tree);
}

bvx_status bvxi_closest_build_unnumbered(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                                         const double high[3], double scale, bvxi_closest_tree *tree)
{
    BVXI_TRY(plan_and_build(call, view, low, high, scale, 1, tree));
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
