/* below.c - everything under a terrain down to a base, or between two terrains.
 *
 * Source: the open terrains of Chen, Qiu, Fu, Ma. Fast voxelization based on triangulated irregular network
 * model. 2010, made solid as blocks of ground are.
 *
 * Rows run along the axis that is up. Each triangle gives its exact crossing to every row that it covers
 * (solid.h); of a row's crossings only the highest counts, so overhangs and doubled sheets need no balance.
 * With two surfaces a row is filled between their highest crossings where both have one.
 * Guarantee: exact; local; no order of triangles plays a part. */
#include "fill/fills.h"
#include "grid/turned_rows.h"

enum { BELOW_GRAIN = 256 };

typedef struct below_job {
    bvx_grid *grid;                /* rows along the axis */
    const int32_t *first, *second; /* highest crossings by row; second may be NULL */
    int32_t base, pieces;
    uint64_t cut[256], fill[256]; /* by piece */
} below_job;

static void fill_below_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    below_job *const job = user;
    const bvx_grid *const g = job->grid;
    uint64_t cut = 0, fill = 0;

    for (uint64_t r = begin; r < end; r++) {
        uint64_t *const row = g->words + (size_t)r * (size_t)g->words_per_row;
        int32_t const a = job->first[r], b = job->second != NULL ? job->second[r] : job->base;
        int32_t const least = job->second == NULL || b < a ? b : a;
        int32_t const most = job->second != NULL && b > a ? b : a;
        int64_t low = least > job->base ? least : job->base, high = most;
        memset(row, 0, (size_t)g->words_per_row * 8);
        if (a == INT32_MIN || (job->second != NULL && b == INT32_MIN)) continue;
        low = low - g->low[0] < 0 ? 0 : low - g->low[0];
        high = high - g->low[0] > g->size[0] ? g->size[0] : high - g->low[0];
        if (low >= high) continue;
        bvxi_set_run(row, (int32_t)low, (int32_t)high);
        /* Between two terrains: above the second one is what has to be dug away. */
        if (job->second != NULL && a > b) cut += (uint64_t)(high - low);
        if (job->second != NULL && a < b) fill += (uint64_t)(high - low);
    }
    job->cut[index] = cut;
    job->fill[index] = fill;
}

static bvx_status find_highest(bvxi_call step, bvxi_solid_job *job, const bvx_grid *turned, int32_t axis,
                               bvx_solid_report *report, int32_t **highest)
{
    uint64_t const rows = bvxi_grid_rows(turned);
    BVXI_TRY(bvxi_alloc(step.ctx, BVXI_SCRATCH, rows * 4, "the columns' heights", highest));
    /* Lower than any crossing, so that the first one counts. */
    for (uint64_t r = 0; r < rows; r++) (*highest)[r] = INT32_MIN;
    job->highest = *highest;
    return bvxi_solid_fill(step, job, turned, axis, BVX_FILL_BELOW, report);
}

/* Fill the rows of turned, which holds words. */
static bvx_status fill_columns(bvx_context *ctx, below_job *job, bvx_solid_report *report)
{
    uint64_t const rows = bvxi_grid_rows(job->grid);
    job->pieces = bvxi_piece_count(rows, BELOW_GRAIN);
    BVXI_TRY(bvxi_for_pieces(ctx, "solid", 0.8, 0.9, job->pieces, bvxi_grid_rows(job->grid), fill_below_piece,
                             job));
    for (int32_t i = 0; i < job->pieces; i++) {
        report->cut_voxels += job->cut[i];
        report->fill_voxels += job->fill[i];
    }
    return BVX_OK;
}

bvx_status bvxi_below(bvx_context *ctx, bvxi_solid_job *job, bvxi_solid_job *second_job,
                      const bvx_voxelize_options *o, bvx_grid *solid, bvx_solid_report *report)
{
    int32_t *first = NULL, *second = NULL;
    int32_t const axis = o->up == BVX_UP_Z ? 2 : o->up - BVX_UP_X;
    bvx_grid turned;

    bvxi_turn_shape(solid, axis, &turned);
    BVXI_TRY(find_highest(bvxi_solid_step(ctx, job, 0.1, 0.5), job, &turned, axis, report, &first));
    if (second_job != NULL)
        BVXI_TRY(
            find_highest(bvxi_solid_step(ctx, job, 0.5, 0.8), second_job, &turned, axis, report, &second));
    below_job below = {.first = first, .second = second, .base = INT32_MIN};

    /* The first centre at or above the base. */
    if (o->has_base) {
        const bvx_lattice *const l = &solid->lattice;
        double const v = (o->base - l->origin[axis]) * ((double)(1 << l->fraction_bits) / l->spacing[axis]);
        if (v > 0.5 - BVXI_FIXED_LIMIT)
            below.base = v < BVXI_FIXED_LIMIT - 0.5
                             ? bvxi_centres_below(bvxi_round_half_up(v), l->fraction_bits)
                             : INT32_MAX;
    }

    uint64_t const words = bvxi_grid_words(&turned);

    if (axis == 0) {
        below.grid = solid;
        return fill_columns(ctx, &below, report);
    }
    /* Before it is allocated, as sizes of turned grids may pass addresses. */
    if (words > SIZE_MAX / 8)
        return bvxi_fail(ctx, BVX_ERR_BUDGET,
                         "%s: a grid turned to another axis takes %u words, beyond this machine's addresses",
                         job->function, words);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, words * 8, "the grid along another axis", &turned.words));
    below.grid = &turned;
    BVXI_TRY(fill_columns(ctx, &below, report));
    return bvxi_turn_back(ctx, &turned, axis, 0.9, solid, NULL);
}
