/* flood.c - what a flood from outside cannot reach is inside.
 *
 * The spaces that the conservative surface leaves are joined by runs (components/room.h); those
 * that touch a side of the lattice are outside, all others inside, so that cavities fill. With gaps to close
 * the flood is run once more past the closed surface: what lies behind it is inside too, the voxels that
 * closing added vote like those of the surface. A space that the first flood does not reach stays inside as a
 * whole, so closing gaps never takes from it. Cavities are filled up to their walls.
 * Guarantee: exact, global. A conservative surface of a mesh without holes holds the flood. */
#include "fill/fills.h"
#include "components/room.h"

/* ---- The inner rim of what a flood filled ---- */

/* Where the flood filled against the vote (a cavity), the walls' voxels around it vote outside and would
 * stay as a thin empty skin. Each wall voxel that votes outside goes to what it reaches first in steps from
 * voxel to voxel, corners included, by others of its kind: to the filled, then it is inside, or to what the
 * flood reached or the lattice's end, then it stays outside; so it does when both are equally far. One
 * queue holds the voxels in the order of their steps, those from outside first among equals. Exact, from
 * the grids only; where nothing was filled against the vote nothing changes. */

enum { RIM_NONE = 0, RIM_OUTSIDE = 1, RIM_FILLED = 2 };

typedef struct rim_work {
    const bvx_grid *walls;
    bvx_grid *solid;
    bvx_grid filled; /* not of the walls: filled against the vote; of the walls: in the queue */
    uint64_t *queue; /* voxel numbers */
    uint64_t count;
} rim_work;

static void voxel_of_rim(const bvx_grid *g, uint64_t number, int32_t v[3])
{
    uint64_t const nx = (uint64_t)g->size[0], ny = (uint64_t)g->size[1];
    v[0] = (int32_t)(number % nx);
    v[1] = (int32_t)(number / nx % ny);
    v[2] = (int32_t)(number / nx / ny);
}

/* One of the voxels around, 0 .. 26 with itself; 0 when it lies beyond the lattice. */
static int step_from_rim(const bvx_grid *g, const int32_t v[3], int32_t way, int32_t n[3])
{
    n[0] = v[0] + way % 3 - 1;
    n[1] = v[1] + way / 3 % 3 - 1;
    n[2] = v[2] + way / 9 - 1;
    return n[0] >= 0 && n[1] >= 0 && n[2] >= 0 && n[0] < g->size[0] && n[1] < g->size[1] && n[2] < g->size[2];
}

/* What a wall voxel lies beside. */
static int side_of_rim(const rim_work *w, const int32_t v[3])
{
    int32_t n[3];
    int side = RIM_NONE;

    for (int32_t way = 0; way < 27; way++) {
        if (!step_from_rim(w->walls, v, way, n)) return RIM_OUTSIDE;

        /* Outside ends the look at once, since it wins among equals; filled only counts when nothing outside
         * is as near. */
        if (bvx_grid_get(&w->filled, n[0], n[1], n[2])) side = RIM_FILLED;
        else if (!bvx_grid_get(w->walls, n[0], n[1], n[2]) && !bvx_grid_get(w->solid, n[0], n[1], n[2]))
            return RIM_OUTSIDE;
    }
    return side;
}

enum { RIM_REPORT = 1 << 15 /* looks at voxels between reports */ };

/* Put the wall voxels of one side that vote outside to the queue; RIM_NONE: count them all. */
static bvx_status look_along_rim(bvx_context *ctx, rim_work *w, int side, uint64_t *counted)
{
    const bvx_grid *const g = w->walls;
    uint64_t voxels = 0, reported = 0;

    for (int32_t z = 0; z < g->size[2]; z++) {
        if (z == 0 || voxels - reported > RIM_REPORT) {
            BVXI_TRY(bvxi_progress(ctx, "flood", (double)z / (double)g->size[2]));
            reported = voxels;
        }
        for (int32_t y = 0; y < g->size[1]; y++) {
            uint64_t const row = (uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y;
            size_t const at = (size_t)row * (size_t)g->words_per_row;
            for (int32_t k = 0; k < g->words_per_row; k++) {
                uint64_t left = g->words[at + (size_t)k] & ~w->solid->words[at + (size_t)k];
                voxels += bvxi_popcount(left);
                for (; left != 0 && side != RIM_NONE; left &= left - 1) {
                    int32_t const v[3] = {k * BVXI_WORD_BITS + bvxi_lowest(left), y, z};
                    if (side_of_rim(w, v) == side)
                        w->queue[w->count++] = row * (uint64_t)g->size[0] + (uint64_t)v[0];
                }
            }
        }
    }
    *counted = voxels;
    return BVX_OK;
}

static void take_for_rim(rim_work *w, const int32_t v[3], int inside)
{
    bvx_grid_set(&w->filled, v[0], v[1], v[2], 1);
    if (inside) bvx_grid_set(w->solid, v[0], v[1], v[2], 1);
}

/* From voxel to voxel, in the order of the queue. */
static bvx_status follow_rim(bvx_context *ctx, rim_work *w, uint64_t voxels)
{
    int32_t v[3], n[3];

    for (uint64_t i = 0; i < w->count; i++) {
        if (i % RIM_REPORT == 0) BVXI_TRY(bvxi_progress(ctx, "flood", (double)i / (double)voxels));
        voxel_of_rim(w->walls, w->queue[i], v);
        for (int32_t way = 0; way < 27; way++) {
            if (!step_from_rim(w->walls, v, way, n) || !bvx_grid_get(w->walls, n[0], n[1], n[2])) continue;
            if (bvx_grid_get(w->solid, n[0], n[1], n[2]) || bvx_grid_get(&w->filled, n[0], n[1], n[2]))
                continue;
            take_for_rim(w, n, bvx_grid_get(w->solid, v[0], v[1], v[2]));
            w->queue[w->count++] = ((uint64_t)n[2] * (uint64_t)w->walls->size[1] + (uint64_t)n[1]) *
                                       (uint64_t)w->walls->size[0] +
                                   (uint64_t)n[0];
        }
    }
    return BVX_OK;
}

/* Walls' voxels that vote outside become inside where what the flood filled is nearer than what
 * it reached. filled: words of the shape of solid, set where the flood filled against the vote; used up.
 * Scratch: 8 bytes a wall voxel that votes outside. */
static bvx_status fill_flood_rim(bvx_context *ctx, const bvx_grid *walls, uint64_t *filled, bvx_grid *solid)
{
    rim_work work = {walls, solid, *solid, NULL, 0};
    uint64_t voxels = 0;
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.0, look_along_rim(ctx, &work, RIM_NONE, &voxels)));
    work.filled.words = filled;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, voxels * 8, "the rim of what was filled", &work.queue));

    uint64_t outside, first, counted;
    int32_t v[3];

    /* The order of the queue is the rule: those from outside before those from the filled, then step by
     * step. */
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.25, look_along_rim(ctx, &work, RIM_OUTSIDE, &counted)));
    outside = work.count;
    BVXI_TRY(BVXI_SHARE(ctx, 0.25, 0.5, look_along_rim(ctx, &work, RIM_FILLED, &counted)));
    first = work.count;

    /* Only after both looks: a bit set earlier would look like a filled voxel to its neighbours. */
    for (uint64_t i = 0; i < first; i++) {
        voxel_of_rim(work.walls, work.queue[i], v);
        take_for_rim(&work, v, i >= outside);
    }
    return BVXI_SHARE(ctx, 0.5, 1.0, follow_rim(ctx, &work, voxels));
}

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
    uint64_t *const row = bvxi_grid_row(w->solid, y, z), *const to = w->filled + (row - w->solid->words);
    const uint64_t *const sure = w->sure + (row - w->solid->words);

    if (!w->reached[space]) {
        for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) {
            uint64_t const filled = ~row[k] & bvxi_run_mask(begin, end, k);
            to[k] |= filled;
            w->filled_voxels += bvxi_popcount(filled);
            row[k] |= filled;
        }
        w->held += (uint64_t)(end - begin);
    } else if (!w->keep) {
        for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) {
            uint64_t const mask = bvxi_run_mask(begin, end, k);

            /* Sure centres that the flood took are inside for certain, so they count leaks; nothing else
             * could tell a leak from an opening. */
            w->leaks += bvxi_popcount(row[k] & sure[k] & mask);
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
    return BVX_OK;
}

bvx_status bvxi_flood(bvx_context *ctx, const char *function, const bvxi_flood_walls *walls, bvx_grid *solid,
                      bvx_solid_report *report, int32_t *leaked)
{
    uint64_t const bytes = bvxi_grid_words(solid) * 8;
    flood_work work = {
        .walls = walls->surface, .sure = walls->sure, .solid = solid, .keep = walls->close_gaps > 0};

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the voxels that the flood fills", &work.filled));

    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.3, BVXI_SCOPE(ctx, flood_spaces(ctx, function, &work))));
    if (walls->close_gaps > 0) {
        BVXI_TRY(
            BVXI_SHARE(ctx, 0.3, 0.5, bvxi_close_gaps(ctx, NULL, walls->surface, walls->close_gaps, NULL)));

        /* Only the second flood empties voxels, so what the first one could not reach stays filled. */
        work.keep = 0;
        BVXI_TRY(BVXI_SHARE(ctx, 0.5, 0.6, BVXI_SCOPE(ctx, flood_spaces(ctx, function, &work))));
    }

    if (work.filled_voxels != 0)
        BVXI_TRY(BVXI_SHARE(ctx, 0.6, 1.0, fill_flood_rim(ctx, walls->surface, work.filled, solid)));
    report->leaks = work.leaks;
    *leaked = work.held == 0 && work.leaks != 0;
    return BVX_OK;
}
