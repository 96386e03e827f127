/* regions.c - every region that the conservative surface leaves is inside or outside as a whole.
 *
 * Source: the interior fill of Chen, Qiu, Fu, Ma. Fast voxelization based on triangulated irregular network
 * model. 2010, section 3, with a seed for every region in place of one, and each seed's side decided by the
 * exact rule.
 *
 * A conservative surface lets no path between face neighbours through, so on a mesh without holes all
 * centres of a region lie on one side, and those on which the three axes agree say on which. A single wrong
 * row is outvoted by its region. Where a hole joins inside and outside the region has both; then each
 * centre keeps its own vote.
 * Guarantee: exact, global. */
#include "fill/fills.h"
#include "components/room.h"

enum { REGION_SURE_IN = 1, REGION_SURE_OUT = 2 };

typedef struct region_work {
    const uint64_t *sure;
    bvx_grid *solid;
    uint8_t *sides; /* by region: sides on which it has sure centres */
    bvx_solid_report *report;
} region_work;

static size_t region_row(const bvx_grid *g, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->words_per_row;
}

/* For bvxi_spaces_each, one run after another: both sides of a region are known after its last run only. */
static void look_at_run(void *user, uint32_t region, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    region_work *const w = user;
    size_t const row = region_row(w->solid, y, z);
    const uint64_t *const in = w->solid->words + row, *const sure = w->sure + row;
    uint8_t *const sides = w->sides + region;

    for (int32_t k = begin >> 6; k <= (end - 1) >> 6 && *sides != (REGION_SURE_IN | REGION_SURE_OUT); k++) {
        uint64_t const known = sure[k] & bvxi_run_mask(begin, end, k);
        if ((known & in[k]) != 0) *sides |= REGION_SURE_IN;
        if ((known & ~in[k]) != 0) *sides |= REGION_SURE_OUT;
    }
}

static void settle_run(void *user, uint32_t region, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    region_work *const w = user;
    uint64_t *const row = w->solid->words + region_row(w->solid, y, z);

    if (w->sides[region] == REGION_SURE_IN) {
        bvxi_set_run(row, begin, end);
    } else if (w->sides[region] == REGION_SURE_OUT) {
        for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] &= ~bvxi_run_mask(begin, end, k);
    } else {
        /* Both sides, or neither: centres keep their own votes. */
        w->report->mixed_voxels += (uint64_t)(end - begin);
    }
}

bvx_status bvxi_regions(bvx_context *ctx, const char *function, const bvx_grid *surface, const uint64_t *sure,
                        bvx_grid *solid, bvx_solid_report *report)
{
    region_work work = {sure, solid, NULL, report};
    bvxi_spaces spaces;

    BVXI_TRY(bvxi_spaces_open(ctx, function, "regions", surface, 1, BVXI_CONNECT_6, &spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, spaces.count, "the regions' sides", &work.sides));
    bvxi_spaces_each(&spaces, look_at_run, &work);
    bvxi_spaces_each(&spaces, settle_run, &work);
    report->regions = spaces.count;
    for (uint64_t r = 0; r < spaces.count; r++)
        report->mixed_regions += work.sides[r] != REGION_SURE_IN && work.sides[r] != REGION_SURE_OUT;
    return BVX_OK;
}
