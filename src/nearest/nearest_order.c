/* nearest_order.c - triangles in the order of a curve through space, and where that jumps.
 *
 * Source: Morton. A computer oriented geodetic data base. 1966. The curve runs over the sums of the
 * triangles' corners, ten bits an axis, which one sort of 30-bit keys arranges; where many triangles crowd
 * in few cells all are sorted again by 21 bits an axis. It jumps: eight neighbours may be two groups far
 * apart, in a box that reaches through half of the mesh. Such a run is cut in two where that makes the boxes
 * smaller. */
#include "nearest/nearest_tree.h"
#include "bits/sort.h"
#include "mesh/mesh.h"

enum {
    NEAR_COARSE_BITS = 10,
    NEAR_FINE_BITS = 21, /* of the curve along each axis */
    NEAR_CROWD = 32,     /* triangles of one cell that are too many for a leaf's box to be small */
    NEAR_GRAIN = 4096    /* least triangles a task */
};

typedef struct near_keys {
    const bvxi_nearest *n;
    const bvxi_near_order *order;
    uint64_t *vertex; /* coordinates of each vertex on the curve's grid, 21 bits each [Size: vertices] */
} near_keys;

/* ---- Keys ---- */

/* Coordinates become whole numbers of 19 bits, so that the sum of three fits 21. */
static void place_near_vertices(void *user, uint64_t begin, uint64_t end)
{
    const near_keys *const b = user;
    const bvxi_nearest *const n = b->n;
    double const most = (double)((1 << (NEAR_FINE_BITS - 2)) - 1);
    double const by = b->order->grid_side > 0.0 ? most / b->order->grid_side : 0.0;

    /* Each vertex once: a triangle then only adds up three words. */
    for (uint64_t i = begin; i < end; i++) {
        double p[3];
        uint64_t key = 0;
        bvxi_view_position(&n->view, i, p);
        for (int a = 0; a < 3; a++) {
            double const x = ((p[a] * n->scale - n->middle[a]) * n->box_scale - b->order->grid_low[a]) * by;
            /* unused ones may lie anywhere */
            key |= (uint64_t)(uint32_t)(int32_t)(x > 0.0 ? x < most ? x : most : 0.0) << NEAR_FINE_BITS * a;
        }
        b->vertex[i] = key;
    }
}

/* Ten bits an axis above the triangle's number, or all there are. */
static void make_near_keys(void *user, uint64_t begin, uint64_t end)
{
    const near_keys *const b = user;
    const bvxi_nearest *const n = b->n;
    uint64_t const mask = (UINT64_C(1) << NEAR_FINE_BITS) - 1;
    int const drop = NEAR_FINE_BITS - NEAR_COARSE_BITS;

    for (uint64_t i = begin; i < end; i++) {
        uint32_t c[3];
        bvxi_view_triangle(&n->view, i, c);

        /* Three coordinates of 21 bits in one word are added at once; none runs into the next. */
        uint64_t const sum = b->vertex[c[0]] + b->vertex[c[1]] + b->vertex[c[2]];
        uint64_t const x = sum & mask, y = sum >> NEAR_FINE_BITS & mask, z = sum >> 2 * NEAR_FINE_BITS;
        if (b->order->numbers != NULL) {
            b->order->keys[i] = bvxi_curve_spread(x) | bvxi_curve_spread(y) << 1 | bvxi_curve_spread(z) << 2;
            b->order->numbers[i] = (uint32_t)i;
        } else {
            uint64_t const key = bvxi_curve_spread(x >> drop) | bvxi_curve_spread(y >> drop) << 1 |
                                 bvxi_curve_spread(z >> drop) << 2;
            b->order->keys[i] = key << 32 | i;
        }
    }
}

/* Sort by bits 32 to 61, least significant ten first. */
static void sort_near_keys(uint64_t *keys, uint64_t *spare, uint64_t count,
                           uint32_t place[3][1 << NEAR_COARSE_BITS])
{
    uint32_t const mask = (1u << NEAR_COARSE_BITS) - 1;

    /* One reading counts the digits of all three rounds. */
    memset(place, 0, 3 * sizeof place[0]);
    for (uint64_t i = 0; i < count; i++) {
        place[0][keys[i] >> 32 & mask]++;
        place[1][keys[i] >> (32 + NEAR_COARSE_BITS) & mask]++;
        place[2][keys[i] >> (32 + 2 * NEAR_COARSE_BITS) & mask]++;
    }
    for (int d = 0; d < 3; d++) {
        uint64_t *const from = d == 1 ? spare : keys, *const to = d == 1 ? keys : spare;
        int const shift = 32 + NEAR_COARSE_BITS * d;

        /* Counts become places; equal digits keep their order, which the digits before have set. */
        uint32_t sum = 0;
        for (uint32_t v = 0; v <= mask; v++) {
            uint32_t const n = place[d][v];
            place[d][v] = sum;
            sum += n;
        }
        for (uint64_t i = 0; i < count; i++) to[place[d][from[i] >> shift & mask]++] = from[i];
    }
}

/* How many triangles share their cell with too many others. */
static uint64_t count_near_crowds(const uint64_t *keys, uint64_t count)
{
    uint64_t crowded = 0;
    /* In order, so equal cells at this distance have as many between them. */
    for (uint64_t i = NEAR_CROWD; i < count; i++) crowded += keys[i] >> 32 == keys[i - NEAR_CROWD] >> 32;
    return crowded;
}

static bvx_status sort_near_along_curve(bvx_context *ctx, const char *stage, double from, double to,
                                        near_keys *k, bvxi_near_order *o)
{
    uint32_t place[3][1 << NEAR_COARSE_BITS];
    uint64_t const count = o->count;

    /* Coarse first: three rounds over words that hold key and number together. */
    BVXI_TRY(
        BVXI_SHARE(ctx, from, (from + to) * 0.5, bvxi_for(ctx, stage, count, NEAR_GRAIN, make_near_keys, k)));
    sort_near_keys(o->keys, o->spare, count, place);
    o->sorted = o->spare;

    /* Ten bits do for most meshes; a mesh of very unequal triangles is worth a second, finer sort. */
    if (count_near_crowds(o->spare, count) <= count / 16) return BVX_OK;
    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, count * sizeof *o->numbers, "the search tree's order", &o->numbers));
    BVXI_TRY(
        BVXI_SHARE(ctx, (from + to) * 0.5, to, bvxi_for(ctx, stage, count, NEAR_GRAIN, make_near_keys, k)));
    o->sorted = o->keys;
    return bvxi_radix_sort(ctx, o->keys, o->numbers, count);
}

bvx_status bvxi_near_order_make(bvx_context *ctx, const char *stage, double from, double to,
                                const bvxi_nearest *n, bvxi_near_order *o)
{
    uint64_t const vertex_bytes = n->view.vertex_count * sizeof(uint64_t);
    uint64_t const key_bytes = n->triangle_count * sizeof *o->keys;
    near_keys k = {n, o, NULL};
    double const middle = from + (to - from) * 0.25;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertex_bytes, "the search tree's vertices", &k.vertex));
    o->count = n->triangle_count;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, key_bytes, "the search tree's keys", &o->keys));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, key_bytes, "the search tree's keys", &o->spare));
    BVXI_TRY(BVXI_SHARE(ctx, from, middle,
                        bvxi_for(ctx, stage, n->view.vertex_count, NEAR_GRAIN, place_near_vertices, &k)));
    BVXI_TRY(sort_near_along_curve(ctx, stage, middle, to, &k, o));
    bvxi_drop(ctx, k.vertex);
    return BVX_OK;
}

void bvxi_near_order_free(bvx_context *ctx, bvxi_near_order *o)
{
    bvxi_drop(ctx, o->numbers);
    bvxi_drop(ctx, o->spare);
    bvxi_drop(ctx, o->keys);
}

/* ---- Runs of triangles ---- */

/* Every third bit of the low 63. */
static inline uint32_t pack_near_bits(uint64_t x)
{
    x &= UINT64_C(0x1249249249249249);
    x = (x | x >> 2) & UINT64_C(0x10c30c30c30c30c3);
    x = (x | x >> 4) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x >> 8) & UINT64_C(0x001f0000ff0000ff);
    x = (x | x >> 16) & UINT64_C(0x001f00000000ffff);
    return (uint32_t)((x | x >> 32) & 0x1fffff);
}

/* Sum of the sides of the box around the cells of some keys. */
static uint64_t near_key_sides(const uint64_t *keys, uint32_t begin, uint32_t end, int shift)
{
    uint64_t sum = 0;
    /* In cells of the curve: sums of sides tell which box is small, and cost no square. */
    for (int a = 0; a < 3; a++) {
        uint32_t low = UINT32_MAX, high = 0;
        for (uint32_t i = begin; i < end; i++) {
            uint32_t const x = pack_near_bits(keys[i] >> shift >> a);
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        sum += high - low + 1;
    }
    return sum;
}

/* A jump is where two keys differ in a higher bit than any other neighbours do by two levels or more; it is
 * one if the boxes of both sides are small beside that of the whole. */
uint32_t bvxi_near_order_run(const bvxi_near_order *o, uint64_t first, uint64_t end)
{
    const uint64_t *const keys = o->sorted + first;
    int const shift = o->numbers == NULL ? 32 : 0;
    uint64_t const left = end - first;
    uint32_t count = left < BVXI_NEAR_WIDTH ? (uint32_t)left : BVXI_NEAR_WIDTH;

    while (o->count < BVXI_NEAR_CUT_BELOW) {
        uint64_t most = 0, second = 0;
        uint32_t at = 0;

        /* The highest bit in which neighbours differ is the size of the step between them. */
        for (uint32_t i = 1; i < count; i++) {
            uint64_t const x = (keys[i] ^ keys[i - 1]) >> shift;
            second = x > most ? most : x > second ? x : second;
            at = x > most ? i : at;
            most = x > most ? x : most;
        }
        if (at == 0 || second > most >> 6) return count;
        if (4 * (near_key_sides(keys, 0, at, shift) + near_key_sides(keys, at, count, shift)) >=
            3 * near_key_sides(keys, 0, count, shift))
            return count;
        count = at;
    }
    return count;
}
