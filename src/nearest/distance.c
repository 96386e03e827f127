/* distance.c - how far two meshes are apart, by samples.
 *
 * Sample i of n takes its place in the i-th n-th of the surface's area, the triangles lying along the search
 * tree's curve through space (stratified, so noise falls faster than with independent points, and the next
 * search finds its boxes where the last one left them; no numbering of the mesh shows), and a uniform place
 * in the triangle that owns it. Its random numbers come from a counter, so samples do not depend on each
 * other. The closest point of the other mesh is exact up to rounding.
 * Blocks of samples, whose number follows from n only, are summed apart and added in order: threads never
 * show.
 * Source of the counter's mixing: Steele, Lea, Flood. Fast Splittable Pseudorandom Number Generators.
 * 2014. */
#include "nearest/closest.h"
#include "mesh/facet.h"
#include "mesh/view.h"

#include <math.h>

typedef struct distance_sums {
    double sum, max, normal_sum;
    uint64_t normal_count;
} distance_sums;

typedef struct distance_work {
    const bvxi_closest_tree *from, *to;
    /* twice the area along the curve up to and with place i [Size: triangles of from] */
    const double *area_before;
    uint64_t samples, key;
    int32_t blocks;
    distance_sums *sums; /* [Size: blocks] */
} distance_work;

static uint64_t distance_mix(uint64_t z)
{
    z = (z ^ z >> 30) * UINT64_C(0xbf58476d1ce4e5b9);
    z = (z ^ z >> 27) * UINT64_C(0x94d049bb133111eb);
    return z ^ z >> 31;
}

/* Random number of a counter, in [0, 1). */
static double distance_random(uint64_t key, uint64_t counter)
{
    /* 53 bits of it fill a double's digits. */
    return (double)(distance_mix(key + (counter + 1) * UINT64_C(0x9e3779b97f4a7c15)) >> 11) * 0x1p-53;
}

/* Which place of the curve owns a share of the area; never that of a triangle without area. */
static uint64_t owner_of_area(const double *area_before, uint64_t count, double share)
{
    uint64_t low = 0, high = count - 1;
    /* rounding reached the end */
    if (share >= area_before[high]) share = area_before[high] * (1.0 - 0x1p-53);
    /* The first place whose sum is above the share: places without area own nothing. */
    while (low < high) {
        uint64_t const middle = low + (high - low) / 2;
        if (area_before[middle] > share) high = middle;
        else low = middle + 1;
    }
    return low;
}

static void measure_distance_block(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const distance_work *const w = user;
    distance_sums s = {0.0, 0.0, 0.0, 0};
    bvxi_closest nearest = {{0.0, 0.0, 0.0}, 0.0, 0, 0};
    for (uint64_t i = begin; i < end; i++) {
        const bvxi_closest_tree *const from = w->from;
        double const total = w->area_before[from->triangle_count - 1];
        double const share = ((double)i + distance_random(w->key, 3 * i)) / (double)w->samples * total;
        double const r = sqrt(distance_random(w->key, 3 * i + 1)), q = distance_random(w->key, 3 * i + 2);
        double t[3][3], p[3], n[3], m[3], d;

        bvxi_closest_corners(from, owner_of_area(w->area_before, from->triangle_count, share), t);

        /* The root makes places uniform in the triangle (Osada and others. Shape Distributions. 2002). */
        for (int a = 0; a < 3; a++) p[a] = (1.0 - r) * t[0][a] + r * (1.0 - q) * t[1][a] + r * q * t[2][a];
        double const length = bvxi_facet_normal((const double(*)[3])t, n);

        /* Samples lie along the curve, so the last answer is a hint for the next. */
        bvxi_closest_find(w->to, p, nearest.place, &nearest);
        d = sqrt(nearest.distance2);
        s.sum += d;
        s.max = d > s.max ? d : s.max;
        bvxi_closest_corners(w->to, nearest.place, t);

        /* A triangle without area has no normal to compare. */
        double const other = bvxi_facet_normal((const double(*)[3])t, m);
        if (other > 0.0) {
            double const cosine = bvxi_vec_dot(n, m) / length / other;
            s.normal_sum += cosine < 1.0 ? 1.0 - cosine : 0.0;
            s.normal_count++;
        }
    }
    w->sums[index] = s;
}

typedef struct distance_way {
    double mean, max, normal;
} distance_way;

static bvx_status measure_distance_one_way(bvx_context *ctx, const bvxi_closest_tree *from,
                                           const bvxi_closest_tree *to, uint64_t samples, uint64_t key,
                                           double progress, distance_way *way)
{
    int32_t const blocks = bvxi_piece_count(samples, 64);
    double *areas = NULL;
    distance_sums *sums = NULL;
    distance_work w = {from, to, NULL, samples, key, blocks, NULL};

    BVXI_TRY(BVXI_ARRAY(ctx, from->triangle_count, "the distance's areas", areas));
    BVXI_TRY(BVXI_ARRAY(ctx, (uint64_t)blocks, "the distance's sums", sums));

    /* One after the other, since sums of doubles depend on their order. */
    double sum = 0.0, t[3][3], n[3];
    for (uint64_t i = 0; i < from->triangle_count; i++) {
        bvxi_closest_corners(from, i, t);
        areas[i] = sum += bvxi_facet_normal((const double(*)[3])t, n);
    }

    w.area_before = areas;
    w.sums = sums;
    BVXI_TRY(bvxi_for_pieces(ctx, "distance", progress, progress + 0.4, blocks, w.samples,
                             measure_distance_block, &w));
    distance_sums all = {0.0, 0.0, 0.0, 0};
    for (int32_t b = 0; b < w.blocks; b++) {
        all.sum += w.sums[b].sum;
        all.max = w.sums[b].max > all.max ? w.sums[b].max : all.max;
        all.normal_sum += w.sums[b].normal_sum;
        all.normal_count += w.sums[b].normal_count;
    }
    /* Back in the caller's units: a power of two, so nothing is rounded. */
    way->mean = all.sum / (double)w.samples / w.to->scale;
    way->max = all.max / w.to->scale;
    way->normal = all.normal_count != 0 ? all.normal_sum / (double)all.normal_count : 0.0;
    return BVX_OK;
}

/* A mesh and its bounds. */
typedef struct distance_side {
    const bvx_mesh_view *view;
    double low[3], high[3];
} distance_side;

/* Both meshes to one scale. */
typedef struct distance_pair {
    distance_side a, b;
    double scale;
} distance_pair;

/* Samples need an area to lie on. */
static bvx_status require_area(bvx_context *ctx, const char *function, const bvx_mesh_view *v, double scale)
{
    double t[3][3], n[3];
    /* The first triangle with an area answers. */
    for (uint64_t i = 0; i < v->triangle_count; i++) {
        bvxi_view_scaled(v, i, scale, t);
        if (bvxi_facet_normal((const double(*)[3])t, n) > 0.0) return BVX_OK;
    }
    return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no triangle has an area", function);
}

void bvxi_distance_forget(bvx_context *ctx, bvxi_distance_tree *kept)
{
    if (kept->built) bvxi_closest_free(ctx, &kept->tree);
    kept->built = 0;
}

static bvx_status measure_distance_both_ways(bvx_context *ctx, const distance_pair *pair,
                                             bvxi_distance_tree *kept, uint64_t samples, uint64_t seed,
                                             bvx_distance_report *report)
{
    const distance_side *const b = &pair->b;
    uint64_t const key_a = distance_mix(seed), key_b = distance_mix(key_a + 1);
    const bvxi_closest_tree *const tree_a = &kept->tree;
    bvxi_closest_tree tree_b;
    distance_way ab, ba;

    /* Another mesh beside it may ask for another scale: then the tree is built anew. */
    if (!kept->built || kept->tree.scale != pair->scale) {
        bvxi_distance_forget(ctx, kept);
        BVXI_TRY(bvxi_closest_build_unnumbered(bvxi_call_of(ctx, NULL, "distance", 0.0, 0.1), pair->a.view,
                                               pair->a.low, pair->a.high, pair->scale, &kept->tree));
        kept->built = 1;
    }
    BVXI_TRY(bvxi_closest_build_unnumbered(bvxi_call_of(ctx, NULL, "distance", 0.1, 0.2), b->view, b->low,
                                           b->high, pair->scale, &tree_b));

    /* Two keys from one seed: places on a and on b have nothing to do with each other. */
    BVXI_TRY(BVXI_SCOPE(ctx, measure_distance_one_way(ctx, tree_a, &tree_b, samples, key_a, 0.2, &ab)));
    BVXI_TRY(BVXI_SCOPE(ctx, measure_distance_one_way(ctx, &tree_b, tree_a, samples, key_b, 0.6, &ba)));
    report->samples = samples;
    report->seed = seed;
    report->mean_a_to_b = ab.mean;
    report->max_a_to_b = ab.max;
    report->normal_a_to_b = ab.normal;
    report->mean_b_to_a = ba.mean;
    report->max_b_to_a = ba.max;
    report->normal_b_to_a = ba.normal;
    report->mean = (ab.mean + ba.mean) * 0.5;
    report->max = ab.max > ba.max ? ab.max : ba.max;

    bvxi_closest_free(ctx, &tree_b);
    return BVX_OK;
}

bvx_status bvxi_mesh_distance(bvx_context *context, const bvx_mesh_view *a, bvxi_distance_tree *kept,
                              const bvx_mesh_view *b, uint64_t samples, uint64_t seed,
                              bvx_distance_report *report)
{
    static const char *const function_a = "bvx_mesh_distance, mesh a";
    static const char *const function_b = "bvx_mesh_distance, mesh b";
    distance_pair pair = {.a = {.view = a}, .b = {.view = b}};

    if (report == NULL) return bvxi_fail_null(context, "bvx_mesh_distance", "report");
    memset(report, 0, sizeof *report);
    BVXI_TRY(bvxi_view_check(context, function_a, a));
    BVXI_TRY(bvxi_view_check(context, function_b, b));
    if (samples < 1 || samples > INT32_MAX)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "bvx_mesh_distance: samples is %u, not 1 to 2147483647", samples);
    BVXI_TRY(bvxi_view_bounds(context, function_a, a, pair.a.low, pair.a.high));
    BVXI_TRY(bvxi_view_bounds(context, function_b, b, pair.b.low, pair.b.high));
    double low[3], high[3];
    /* Around both, as points of either are measured to the other. */
    for (int k = 0; k < 3; k++) {
        low[k] = pair.a.low[k] < pair.b.low[k] ? pair.a.low[k] : pair.b.low[k];
        high[k] = pair.a.high[k] > pair.b.high[k] ? pair.a.high[k] : pair.b.high[k];
    }
    pair.scale = bvxi_unit_scale(low, high);

    /* One scale for both, a power of two, so that distances of both ways compare. */
    BVXI_TRY(require_area(context, function_a, a, pair.scale));
    BVXI_TRY(require_area(context, function_b, b, pair.scale));
    return measure_distance_both_ways(context, &pair, kept, samples, seed, report);
}

static bvx_status run_mesh_distance(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                                    uint64_t samples, uint64_t seed, bvx_distance_report *report)
{
    bvxi_distance_tree tree = {.built = 0};
    BVXI_TRY(bvxi_mesh_distance(context, a, &tree, b, samples, seed, report));
    bvxi_distance_forget(context, &tree);
    return BVX_OK;
}

bvx_status bvx_mesh_distance(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                             uint64_t samples, uint64_t seed, bvx_distance_report *report)
{
    return BVXI_CALL(context, run_mesh_distance(context, a, b, samples, seed, report));
}
