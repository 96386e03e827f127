/* hole_strips.c - loops of a torn mesh parted anew, into strips along its cracks.
 *
 * What a sheet adds at a place follows from its border only, but its cost grows with its area: where loose
 * triangles nearly touch, sheets over each of them are the whole surface once more, strips between them next
 * to nothing. So an edge is paired with one beside it that runs the other way, the two with the short ways
 * between their ends are a loop, and these ways, walked back, take the edges' place in the other loops.
 * Whatever is paired, the border is the same.
 *
 * Source: Morton. A computer oriented geodetic data base. 1966 (neighbours by their middles' places on a
 * curve, on two curves as one has seams).
 * Guarantee: the sum of all loops' directed edges is kept. Pairs follow from the loops. */
#include "bits/sort.h"
#include "mesh/mesh.h"
#include "winding/sheet.h"

enum { STRIP_LOOK = 6, STRIP_EDGES = 256 };
#define STRIP_NONE UINT32_MAX
static const double strip_width = 1.0 / 16; /* squares of the ends' distances, over that of the edge */

typedef struct strip_work {
    const bvxi_snapped *snapped;
    const double *scale;
    uint64_t *edge; /* from << 32 | to [Size: count] */
    uint64_t count, pairs;
    uint64_t *key;   /* places on the curve [Size: count] */
    uint32_t *order; /* edges along it [Size: count] */
    uint32_t *other; /* by edge: the one across the crack, or STRIP_NONE [Size: count] */
} strip_work;

static double ends_apart(const strip_work *w, uint64_t a, uint64_t b)
{
    const int32_t *const p = w->snapped->xyz + 3 * a, *const q = w->snapped->xyz + 3 * b;
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double const d = ((double)p[i] - q[i]) * w->scale[i];
        sum += d * d;
    }
    return sum;
}

/* Pair neighbours along a curve that is moved by `moved`. */
static bvx_status pair_along(bvx_context *ctx, strip_work *w, uint32_t moved)
{
    for (uint64_t i = 0; i < w->count; i++) {
        const int32_t *const p = w->snapped->xyz + 3 * (w->edge[i] >> 32);
        const int32_t *const q = w->snapped->xyz + 3 * (uint64_t)(uint32_t)w->edge[i];
        /* Coordinates lie within 2^30 of 0, so the sum of two is below 2^32, with the move below 2^33. */
        w->key[i] = 0;
        for (int a = 0; a < 3; a++)
            w->key[i] |=
                bvxi_curve_spread(((uint64_t)((int64_t)p[a] + q[a] + INT64_C(0x80000000)) + moved) >> 12)
                << a;
        w->order[i] = (uint32_t)i;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, w->key, w->order, w->count));

    for (uint64_t i = 0; i < w->count; i++) {
        uint32_t const e = w->order[i];
        for (uint64_t k = i + 1; k < w->count && k <= i + STRIP_LOOK && w->other[e] == STRIP_NONE; k++) {
            uint32_t const f = w->order[k];
            uint64_t const own = w->edge[e], next = w->edge[f];
            double const apart = ends_apart(w, (uint32_t)own, next >> 32) +
                                 ends_apart(w, own >> 32, (uint32_t)next);

            /* Both lie on a crack that is narrow beside their length, one each way. */
            if (w->other[f] != STRIP_NONE ||
                !(apart <= strip_width * ends_apart(w, own >> 32, (uint32_t)own)))
                continue;
            w->other[e] = f;
            w->other[f] = e;
            w->pairs++;
        }
    }
    return BVX_OK;
}

/* The strip from e to f becomes a loop, its short ends walked back are edges of the rest; returns how many. */
static uint64_t add_strip(uint64_t e, uint64_t f, bvxi_holes *strips, uint64_t *rest)
{
    uint32_t const p = (uint32_t)(e >> 32), q = (uint32_t)e, r = (uint32_t)(f >> 32), s = (uint32_t)f;
    uint32_t *const v = strips->vertex + strips->points;
    uint64_t n = 0;

    if (q == r && p == s) return 0;
    *v = p;
    v[1] = q;
    if (r != q) v[2] = r;
    if (s != p) v[r != q ? 3 : 2] = s;
    strips->points += 2 + (uint64_t)(r != q) + (uint64_t)(s != p);
    strips->loop_end[strips->loops++] = strips->points;
    if (r != q) rest[n++] = (uint64_t)r << 32 | q;
    if (s != p) rest[n++] = (uint64_t)p << 32 | s;
    return n;
}

static bvx_status part_loops(bvx_context *ctx, strip_work *w, const bvxi_holes *holes, bvxi_holes *strips)
{
    uint64_t const most = 3 * w->count; /* a pair has four points in its strip and two edges in the rest */
    uint64_t begin = 0, rest = 0;

    BVXI_TRY(BVXI_ARRAY(ctx, 3 * w->count, "the loops' edges", w->edge));
    w->key = w->edge + w->count;
    w->order = (uint32_t *)(void *)(w->key + w->count);
    w->other = w->order + w->count;
    for (uint64_t l = 0, i = 0; l < holes->loops; begin = holes->loop_end[l++])
        for (; i < holes->loop_end[l]; i++) {
            uint64_t const next = i + 1 < holes->loop_end[l] ? i + 1 : begin;
            w->edge[i] = (uint64_t)holes->vertex[i] << 32 | holes->vertex[next];
            w->other[i] = STRIP_NONE;
        }

    BVXI_TRY(pair_along(ctx, w, 0));
    BVXI_TRY(pair_along(ctx, w, 0x55555555u));
    /* Loops of many edges without another one lead far: their sheet may be larger than it was. */
    if (40 * w->pairs < 19 * w->count) return BVX_OK;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, most * 4, "the strips' points", &strips->vertex));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, 2 * w->count * 8, "the strips' ends", &strips->loop_end));
    for (uint64_t i = 0; i < w->count; i++) {
        uint32_t const f = w->other[i];
        /* Places on the curve are of no more use: a pair leaves two edges at most, so the rest fits there. */
        if (f == STRIP_NONE) w->key[rest++] = w->edge[i];
        else if (i < f) rest += add_strip(w->edge[i], w->edge[f], strips, w->key + rest);
    }
    return rest == 0 ? BVX_OK : BVXI_SCOPE(ctx, bvxi_holes_append(ctx, w->snapped, w->key, rest, strips));
}

bvx_status bvxi_holes_strips(bvx_context *ctx, const bvxi_holes *holes, const bvxi_snapped *snapped,
                             const double scale[3], bvxi_holes *strips)
{
    strip_work w = {.snapped = snapped, .scale = scale, .count = holes->points};
    memset(strips, 0, sizeof *strips);
    /* Strips have up to three times as many points, which are counted in 32 bits. */
    if (holes->points < STRIP_EDGES || holes->points > UINT32_MAX / 8) return BVX_OK;
    BVXI_TRY(part_loops(ctx, &w, holes, strips));
    bvxi_drop(ctx, w.edge);
    return BVX_OK;
}
