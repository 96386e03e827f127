/* downsample.c - the samples' places and weights along each axis.
 *
 * All rational, so that no rounding moves a sample: in units of 1/(2r) of a voxel sample i stands at (2i + 1)
 * n from the grid's corner, which is (2i + 1) n - r from the first centre. Placing each sample in the middle
 * of its own stretch makes the samples' boxes tile the grid, so the model neither shifts nor shrinks. */
#include "grid/downsample.h"

static int32_t *take_table(int32_t **from, int32_t count)
{
    int32_t *const t = *from;
    *from += count;
    return t;
}

static void fill_axis(bvxi_sample_axis *a, int32_t **memory)
{
    int64_t const n = a->n, r = a->r;

    a->at = take_table(memory, a->count);
    a->high = take_table(memory, a->count);
    a->begin = take_table(memory, a->count);
    a->end = take_table(memory, a->count);
    a->first = take_table(memory, a->count);
    a->last = take_table(memory, a->count);

    /* Tables once for each axis, so that the loop over samples has no division. */
    for (int32_t i = 0; i < a->count; i++) {
        int64_t const centre = (2 * (int64_t)i + 1) * n - r; /* >= 0, as n >= r */
        int64_t const low = i * n, up = (i + (int64_t)1) * n;
        /* The voxel whose centre lies at or below the sample, and how far above it, in units of 1/(2r). */
        a->at[i] = (int32_t)(centre / (2 * r));
        a->high[i] = (int32_t)(centre % (2 * r));
        /* The box's voxels, and the parts of the first and last that lie inside. */
        a->begin[i] = (int32_t)(low / r);
        a->end[i] = (int32_t)((up + r - 1) / r);
        a->first[i] = (int32_t)((a->begin[i] + (int64_t)1) * r - low);
        a->last[i] = (int32_t)(up - (a->end[i] - (int64_t)1) * r);
        if (a->end[i] - a->begin[i] == 1) a->first[i] = (int32_t)n; /* n = r: the voxel is the box */
    }
}

static bvx_status open_coarse(bvx_context *ctx, const char *function, bvxi_downsample *d)
{
    const bvx_grid *const fine = d->fine;
    double origin[3], spacing[3];
    int32_t dims[3];
    bvx_lattice lattice;
    bvx_window whole = {{0, 0, 0}, {0, 0, 0}};
    uint64_t *memory = NULL, words;

    for (int32_t a = 0; a < 3; a++) {
        /* One sample stands for n/r voxels, so its spacing is that much larger. */
        whole.size[a] = d->axis[a].count;
        origin[a] = fine->lattice.origin[a] + (double)fine->low[a] * fine->lattice.spacing[a];
        spacing[a] = fine->lattice.spacing[a] * d->axis[a].n / d->axis[a].r;
        dims[a] = d->axis[a].count;
    }
    BVXI_TRY(bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    words = bvx_grid_bound(&lattice, NULL); /* of at most 2^20 a side, so 64 bits hold it */
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, words * 8, "the level's samples", &memory));
    d->coarse.words = memory; /* scratch, so that an arena keeps results without gaps */
    d->coarse.word_capacity = words;
    return bvxi_grid_open(ctx, function, &lattice, &whole, &d->coarse);
}

bvx_status bvxi_downsample_open(bvx_context *ctx, const char *function, const bvx_grid *fine,
                                const bvxi_downsample_by *by, bvxi_downsample *d)
{
    const int32_t *const n = by->n, *const r = by->r;
    int32_t *memory;
    uint64_t entries = 0;
    bvx_status status;

    memset(d, 0, sizeof *d);
    d->fine = fine;

    /* In 16 bits: a threshold that is a whole number can be compared exactly. */
    d->threshold = (int32_t)(by->threshold * 65536.0 + 0.5);
    if (d->threshold < 1) d->threshold = 1;
    if (d->threshold > 65535) d->threshold = 65535;
    d->edge_samples = by->edge_samples;
    d->cpu = bvxi_cpu(ctx);
    for (int32_t a = 0; a < 3; a++) {
        bvxi_sample_axis *const axis = &d->axis[a];
        if (n[a] > BVXI_DOWNSAMPLE_SIDE)
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                "%s: levels are made of grids up to %d voxels along an axis, this one has %d", function,
                (int64_t)BVXI_DOWNSAMPLE_SIDE, (int64_t)n[a]);
        axis->n = n[a];
        axis->r = r[a];
        axis->voxels = fine->size[a];
        /* Rounded up: the last box may reach beyond the grid, where all is empty. */
        axis->count = (int32_t)(((int64_t)fine->size[a] * r[a] + n[a] - 1) / n[a]);
        entries += (uint64_t)axis->count * 6;
    }

    /* Six tables an axis, in one block. */
    d->table_bytes = entries * sizeof *d->tables;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, d->table_bytes, "the samples' places", &d->tables));
    memory = d->tables;
    for (int32_t a = 0; a < 3; a++) fill_axis(&d->axis[a], &memory);
    d->pieces = bvxi_piece_count((uint64_t)d->axis[1].count * (uint64_t)d->axis[2].count, 16);
    status = open_coarse(ctx, function, d);
    if (status != BVX_OK) bvxi_downsample_close(ctx, d);
    return status;
}

void bvxi_downsample_close(bvx_context *ctx, bvxi_downsample *d)
{
    bvxi_drop(ctx, d->value);
    bvxi_drop(ctx, d->coarse.words);
    bvxi_drop(ctx, d->tables);
    memset(d, 0, sizeof *d);
}
