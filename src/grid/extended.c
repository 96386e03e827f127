/* extended.c - the extended voxel function: trilinear between voxel centres, compared with a threshold.
 *
 * Source: "LOD by voxelization and downsampling" 2.4.2 and 2.4.4 (VoxExt, EdgeRatio), with two corrections: an edge's
 * vertex sits in the middle of the step in which the state changes, and samples stand in the middle of their stretches.
 * Guarantee: weights are integers, sums are exact, every comparison is; each edge is walked once, from its low end. */
#include "grid/downsample.h"

static inline int64_t row_bit(const uint64_t *row, int32_t i, int32_t voxels)
{
    return row != NULL && i >= 0 && i < voxels ? (int64_t)(row[i >> 6] >> (i & 63) & 1) : 0;
}

/* The four fine rows around a sample row, and their weights in 1/(2r_y 2r_z). */
typedef struct sample_rows {
    const uint64_t *row[4];
    int64_t weight[4];
} sample_rows;

static void gather_rows(const bvxi_downsample *d, int32_t at_y, int64_t high_y, int64_t whole_y, int32_t at_z, int64_t high_z,
                        int64_t whole_z, sample_rows *s)
{
    for (int32_t i = 0; i < 4; i++) {
        s->weight[i] = ((i & 1) != 0 ? high_y : whole_y - high_y) * ((i >> 1) != 0 ? high_z : whole_z - high_z);
        s->row[i] = s->weight[i] != 0 ? bvxi_fine_row(d, at_y + (i & 1), at_z + (i >> 1)) : NULL;
    }
}

/* Weighted bits of the four rows at voxel i. */
static inline int64_t sum_at(const sample_rows *s, int32_t i, int32_t voxels)
{
    int64_t sum = 0;
    for (int32_t r = 0; r < 4; r++) sum += row_bit(s->row[r], i, voxels) * s->weight[r];
    return sum;
}

static void sample_row(const bvxi_downsample *d, int32_t j, int32_t k)
{
    const bvxi_sample_axis *const x = &d->axis[0], *const y = &d->axis[1], *const z = &d->axis[2];
    uint64_t *const out = d->coarse.words + ((uint64_t)k * (uint64_t)y->count + (uint64_t)j) * (uint64_t)d->coarse.words_per_row;
    int64_t const whole = 2 * (int64_t)x->r;
    sample_rows s;
    gather_rows(d, y->at[j], y->high[j], 2 * (int64_t)y->r, z->at[k], z->high[k], 2 * (int64_t)z->r, &s);
    if (s.row[0] == NULL && s.row[1] == NULL && s.row[2] == NULL && s.row[3] == NULL) return;
    for (int32_t i = 0; i < x->count; i++) {
        int32_t const at = x->at[i];
        int64_t const low = sum_at(&s, at, x->voxels), high = sum_at(&s, at + 1, x->voxels);
        int64_t const sum = low * (whole - x->high[i]) + high * x->high[i];
        out[i >> 6] |= (uint64_t)(sum > d->limit) << (i & 63);
    }
}

static void sample_piece(void *user, int32_t piece, int32_t worker)
{
    const bvxi_downsample *const d = user;
    uint64_t begin, end;
    (void)worker;
    bvxi_piece((uint64_t)d->axis[1].count * (uint64_t)d->axis[2].count, d->pieces, piece, &begin, &end);
    for (uint64_t row = begin; row < end; row++)
        sample_row(d, (int32_t)(row % (uint64_t)d->axis[1].count), (int32_t)(row / (uint64_t)d->axis[1].count));
}

static int32_t edge_steps(const bvxi_downsample *d, int32_t axis)
{
    int32_t const n = d->axis[axis].n, r = d->axis[axis].r;
    int64_t const whole = ((int64_t)n + r - 1) / r; /* voxels a sample; quarter steps use what the other two axes blend in */
    return d->edge_samples != 0 ? d->edge_samples : whole < 16384 ? (int32_t)(4 * whole) : 65536;
}

bvx_status bvxi_extended_sample(bvx_context *ctx, bvxi_downsample *d)
{
    uint64_t total = 1, most = 1;
    int fits = 1;
    for (int32_t a = 0; a < 3; a++) {
        uint64_t const steps = (uint64_t)edge_steps(d, a);
        total = bvxi_mul(total, 2 * (uint64_t)d->axis[a].r, &fits);
        if (steps > most) most = steps;
    }
    if (!fits || total > INT64_MAX / 2 / most)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "bvx_build_lods: %d x %d x %d samples with %u steps an edge need more than 63 bits; take fewer steps or coverage",
                         (int64_t)d->axis[0].r, (int64_t)d->axis[1].r, (int64_t)d->axis[2].r, most);
    d->total = (int64_t)total;
    d->limit = bvxi_weight_limit(d->total, d->threshold);
    return bvxi_parallel(ctx, "lod", 0.0, 0.5, d->pieces, sample_piece, d);
}

/* The place of sample i, also of -1 and count, just outside. */
static void place_sample(const bvxi_sample_axis *a, int32_t i, int32_t *at, int64_t *high)
{
    int64_t const whole = 2 * (int64_t)a->r, centre = (2 * (int64_t)i + 1) * a->n - a->r;
    int64_t const down = centre >= 0 ? centre / whole : -((whole - 1 - centre) / whole);
    *at = (int32_t)down;
    *high = centre - down * whole;
}

/* Weighted bits across the edge at voxel i along its axis: bilinear in the other two. */
static int64_t sum_across(const bvxi_downsample *d, int32_t axis, int32_t i, const int32_t at[3], const int64_t high[3])
{
    int32_t const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2; /* the other two axes */
    int64_t sum = 0;
    for (int32_t n = 0; n < 4; n++) {
        int32_t p[3];
        int64_t const wu = (n & 1) != 0 ? high[u] : 2 * (int64_t)d->axis[u].r - high[u];
        int64_t const wv = (n >> 1) != 0 ? high[v] : 2 * (int64_t)d->axis[v].r - high[v];
        p[axis] = i;
        p[u] = at[u] + (n & 1);
        p[v] = at[v] + (n >> 1);
        if (wu * wv != 0) sum += row_bit(bvxi_fine_row(d, p[1], p[2]), p[0], d->axis[0].voxels) * wu * wv;
    }
    return sum;
}

double bvxi_extended_ratio(const void *downsample, int32_t axis, int32_t i, int32_t j, int32_t k)
{
    const bvxi_downsample *const d = downsample;
    const bvxi_sample_axis *const a = &d->axis[axis];
    int32_t const steps = edge_steps(d, axis), sample[3] = {i, j, k};
    int64_t const unit = 2 * (int64_t)a->r * steps; /* one voxel */
    int64_t const limit = bvxi_weight_limit(d->total * steps, d->threshold);
    int64_t high[3], place, low_sum, high_sum;
    int32_t at[3], voxel;
    int start;
    for (int32_t b = 0; b < 3; b++) place_sample(&d->axis[b], sample[b], &at[b], &high[b]);
    voxel = at[axis];
    place = high[axis] * steps; /* from that voxel's centre */
    low_sum = sum_across(d, axis, voxel, at, high);
    high_sum = sum_across(d, axis, voxel + 1, at, high);
    start = low_sum * (unit - place) + high_sum * place > limit;
    for (int32_t s = 1; s <= steps; s++) {
        for (place += 2 * (int64_t)a->n; place >= unit; place -= unit) {
            voxel++;
            low_sum = high_sum;
            high_sum = sum_across(d, axis, voxel + 1, at, high);
        }
        if ((low_sum * (unit - place) + high_sum * place > limit) != start) return (2.0 * s - 1.0) / (2.0 * steps);
    }
    return 0.5; /* not reached: the ends differ */
}
