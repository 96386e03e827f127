/* flood.c - what a flood from outside cannot reach is inside.
 *
 * The spaces that the conservative surface leaves are joined by runs (components/room.h); those
 * that touch a side of the lattice are outside, all others inside, so that cavities fill. With gaps to close
 * the flood is run once more past the closed surface: what lies behind it is inside too, the voxels that
 * closing added vote like those of the surface. A space that the first flood does not reach stays inside as a
 * whole, so closing gaps never takes from it. Cavities are filled up to their walls (flood_rim.c).
 * Guarantee: exact, global. A conservative surface of a mesh without holes holds the flood. */
#include "fill/fills.h"
#include "components/room.h"

typedef struct flood_work {
    const bvx_grid *walls;
    const uint64_t *sure;
    bvx_grid *solid;
    uint8_t *reached; /* by space */
    int32_t keep;     /* 1: leave reached voxels as they are */
    uint64_t *filled; /* words of a grid: voxels that were filled against the vote */
    uint64_t held, filled_voxels, leaks;
} flood_work;

static void reach_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    flood_work *const w = user;
    if (bvxi_spaces_at_side(w->walls, begin, end, y, z)) w->reached[space] = 1;
}

static void flood_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    flood_work *const w = user;
    size_t const at = ((size_t)z * (size_t)w->solid->size[1] + (size_t)y) * (size_t)w->solid->words_per_row;
    uint64_t *const row = w->solid->words + at;

    /* What is filled against the vote is remembered: around it walls have a rim that belongs to it. */
    if (!w->reached[space]) {
        for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) {
            uint64_t const filled = ~row[k] & bvxi_run_mask(begin, end, k);
            w->filled[at + (size_t)k] |= filled;
            w->filled_voxels += bvxi_popcount(filled);
            row[k] |= filled;
        }
        w->held += (uint64_t)(end - begin);
    } else if (!w->keep) {
        for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) {
            uint64_t const mask = bvxi_run_mask(begin, end, k);

            /* Sure centres that the flood took are inside for certain, so they count leaks; nothing else
             * could tell a leak from an opening. */
            w->leaks += bvxi_popcount(row[k] & w->sure[at + (size_t)k] & mask);
            row[k] &= ~mask;
        }
    }
}

/* Flood the spaces that work's walls leave. */
static bvx_status flood_spaces(bvx_context *ctx, const char *function, flood_work *work)
{
    bvxi_spaces spaces;

    BVXI_TRY(bvxi_spaces_open(ctx, function, "flood", work->walls, 1, BVXI_CONNECT_6, &spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, spaces.count, "the flood's reach", &work->reached));
    /* Two walks: a space is known to be outside only after the last of its runs was seen. */
    bvxi_spaces_each(&spaces, reach_run, work);
    bvxi_spaces_each(&spaces, flood_run, work);
    bvxi_drop(ctx, work->reached);
    work->reached = NULL;
    bvxi_spaces_free(&spaces);
    return BVX_OK;
}

static bvx_status flood_twice(bvx_context *ctx, const char *function, const bvxi_flood_walls *walls,
                              flood_work *work, uint64_t *closed)
{
    uint64_t before = 0, after = 0;

    BVXI_TRY(flood_spaces(ctx, function, work));
    if (walls->close_gaps > 0) {
        BVXI_TRY(bvx_grid_count(ctx, walls->surface, &before));
        BVXI_TRY(bvxi_close_gaps(ctx, walls->surface, walls->close_gaps));
        BVXI_TRY(bvx_grid_count(ctx, walls->surface, &after));

        /* Only the second flood empties voxels, so what the first one could not reach stays filled. */
        work->keep = 0;
        BVXI_TRY(flood_spaces(ctx, function, work));
    }
    *closed = after - before;
    return BVX_OK;
}

bvx_status bvxi_flood(bvx_context *ctx, const char *function, const bvxi_flood_walls *walls, bvx_grid *solid,
                      bvx_solid_report *report, int32_t *leaked)
{
    uint64_t const bytes = bvxi_grid_words(solid) * 8;
    flood_work work = {
        .walls = walls->surface, .sure = walls->sure, .solid = solid, .keep = walls->close_gaps > 0};

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the voxels that the flood fills", &work.filled));
    BVXI_TRY(flood_twice(ctx, function, walls, &work, &report->closed_voxels));
    if (work.filled_voxels != 0) BVXI_TRY(bvxi_flood_rim(ctx, walls->surface, work.filled, solid));
    bvxi_drop(ctx, work.filled);
    report->leaks = work.leaks;
    *leaked = work.held == 0 && work.leaks != 0;
    return BVX_OK;
}
