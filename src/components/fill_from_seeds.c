/* fill_from_seeds.c - interior fill from seeds: bvx_grid_fill.
 *
 * Source: the fill of Chen, Qiu, Fu, Ma. Fast voxelization based on triangulated irregular network model.
 * 2010, section 3, by runs: empty voxels are joined to spaces once (components.c), and a space that holds
 * a seed is filled. No queue, and any number of seeds costs no more than one.
 * Guarantee: exact; no order of seeds plays a part. */
#include "components/room.h"

static const char grid_fill_name[] = "bvx_grid_fill";

typedef struct fill_spaces_work {
    bvx_grid *filled; /* seeds at first */
    uint8_t *wanted;  /* by space */
} fill_spaces_work;

static void look_for_seed(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    fill_spaces_work *const w = user;
    const uint64_t *const row = bvxi_grid_row(w->filled, y, z);
    /* A run is known to be wanted at the first seed in it. */
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6 && !w->wanted[space]; k++)
        w->wanted[space] = (row[k] & bvxi_run_mask(begin, end, k)) != 0;
}

static void fill_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    fill_spaces_work *const w = user;
    if (w->wanted[space]) bvxi_set_run(bvxi_grid_row(w->filled, y, z), begin, end);
}

bvx_status bvxi_seed_check(bvx_context *ctx, const char *function, const bvx_grid *grid, const int32_t *seed,
                           uint64_t index)
{
    for (int a = 0; a < 3; a++)
        if (seed[a] < 0 || seed[a] >= grid->size[a])
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                                 "%s: seed %i at (%d, %d, %d) is outside the window of %d x %d x %d voxels",
                                 function, index, (int64_t)seed[0], (int64_t)seed[1], (int64_t)seed[2],
                                 (int64_t)grid->size[0], (int64_t)grid->size[1], (int64_t)grid->size[2]);
    return BVX_OK;
}

static bvx_status fill_from_seeds(bvx_context *ctx, const bvx_grid *walls, const int32_t *seeds,
                                  uint64_t count, int32_t connectivity, bvx_grid *filled)
{
    fill_spaces_work work = {filled, NULL};
    bvxi_spaces spaces;

    BVXI_TRY(bvxi_spaces_open(ctx, grid_fill_name, "fill", walls, 1, connectivity, &spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, spaces.count, "the spaces' marks", &work.wanted));
    /* The result holds the seeds first, so that runs are
     * compared with words and no seed is searched for. */
    memset(filled->words, 0, (size_t)bvxi_grid_words(filled) * 8);
    for (uint64_t i = 0; i < count; i++)
        bvx_grid_set(filled, seeds[3 * i], seeds[3 * i + 1], seeds[3 * i + 2], 1);
    bvxi_spaces_each(&spaces, look_for_seed, &work);
    /* Filling comes after all looking, as a space may have its seed in its last run. */
    bvxi_spaces_each(&spaces, fill_space_run, &work);
    return BVX_OK;
}

static bvx_status run_grid_fill(bvx_context *context, const bvx_grid *walls, const int32_t *seeds,
                                uint64_t seed_count, int32_t connectivity, bvx_grid *filled)
{
    bvx_window window;

    BVXI_TRY(bvxi_grid_check(context, grid_fill_name, walls));
    if (filled == NULL) return bvxi_fail_null(context, grid_fill_name, "filled");
    if (seeds == NULL && seed_count != 0) return bvxi_fail_null(context, grid_fill_name, "seeds");
    BVXI_TRY(bvxi_check_connectivity(context, grid_fill_name, connectivity));
    BVXI_TRY(bvxi_grid_apart(context, grid_fill_name, walls, filled));

    for (uint64_t i = 0; i < seed_count; i++) {
        const int32_t *const s = seeds + 3 * i;
        BVXI_TRY(bvxi_seed_check(context, grid_fill_name, walls, s, i));
        if (bvx_grid_get(walls, s[0], s[1], s[2]))
            return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: seed %i at (%d, %d, %d) lies on a set voxel",
                             grid_fill_name, i, (int64_t)s[0], (int64_t)s[1], (int64_t)s[2]);
    }

    memcpy(window.low, walls->low, sizeof window.low);
    memcpy(window.size, walls->size, sizeof window.size);
    bvxi_grid_renew(context, &walls->lattice, &window, filled);

    bvx_grid made = *filled;
    BVXI_TRY(bvxi_grid_open(context, grid_fill_name, &walls->lattice, &window, &made));
    bvx_status const status = fill_from_seeds(context, walls, seeds, seed_count, connectivity, &made);
    return bvxi_grid_put(context, status, &made, filled);
}

bvx_status bvx_grid_fill(bvx_context *context, const bvx_grid *walls, const int32_t *seeds,
                         uint64_t seed_count, int32_t connectivity, bvx_grid *filled)
{
    return BVXI_CALL(context, run_grid_fill(context, walls, seeds, seed_count, connectivity, filled));
}
