/* euler.c - parts, cavities and tunnels of a grid: bvx_grid_topology.
 *
 * Source: Gray. Local Properties of Binary Images in Two Dimensions. 1971 (Euler numbers from local
 * patterns), by rows of words.
 *
 * For four rows a (y, z), b (y + 1, z), c (y, z + 1), d (y + 1, z + 1) the cells that belong to (y, z) are
 * counted at once: voxels less pairs along x are the runs of a, pairs along y less squares those of a & b,
 * and so on, so that
 *   connectivity 6   euler = sum of runs(a) - runs(a & b) - runs(a & c) + runs(a & b & c & d) is voxels -
 * pairs + squares - cubes of centres. With closed boxes vertices, edges and faces belong to the body where
 * any of their voxels does; in the same way
 *   connectivity 26  euler = sum of runs(a) - runs(a | b) - runs(a | c) + runs(a | b | c | d), from y = -1
 * and z = -1 on. What is not told by the Euler number is counted: parts, and spaces that touch no side of the
 * window.
 * Guarantee: exact. */
#include "components/room.h"

static const char topology_name[] = "bvx_grid_topology";

/* Runs that begin in a word; *last is the bit before it, then its last one. */
static inline int64_t count_begins(uint64_t w, uint64_t *last)
{
    uint64_t const begins = w & ~(w << 1 | *last);
    *last = w >> 63;
    return (int64_t)bvxi_popcount(begins);
}

/* Rows that are not there are NULL. */
static int64_t euler_of_rows(const uint64_t *const rows[4], int32_t words, uint64_t tail, int any)
{
    uint64_t last[4] = {0, 0, 0, 0};
    int64_t sum = 0;

    for (int32_t k = 0; k < words; k++) {
        uint64_t w[4], ab, ac, all;
        for (int32_t i = 0; i < 4; i++)
            w[i] = rows[i] == NULL ? 0 : k + 1 == words ? rows[i][k] & tail : rows[i][k];
        ab = any ? w[0] | w[1] : w[0] & w[1];
        ac = any ? w[0] | w[2] : w[0] & w[2];
        all = any ? ab | w[2] | w[3] : ab & w[2] & w[3];
        sum += count_begins(w[0], &last[0]) - count_begins(ab, &last[1]) - count_begins(ac, &last[2]) +
               count_begins(all, &last[3]);
    }
    return sum;
}

static const uint64_t *euler_row(const bvx_grid *g, int32_t y, int32_t z)
{
    if (y < 0 || z < 0 || y >= g->size[1] || z >= g->size[2]) return NULL;
    return bvxi_grid_row(g, y, z);
}

typedef struct cavity_sides {
    const bvx_grid *grid;
    uint8_t *at_side;
} cavity_sides;

static void mark_cavity_side(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const cavity_sides *const s = user;
    if (bvxi_spaces_at_side(s->grid, begin, end, y, z)) s->at_side[space] = 1;
}

static bvx_status count_cavities(bvx_context *ctx, const bvx_grid *grid, int32_t connectivity,
                                 uint64_t *count)
{
    cavity_sides sides = {grid, NULL};
    bvxi_spaces spaces;
    /* A cavity touches no side of the window; the empty space takes the other connectivity. */
    BVXI_TRY(bvxi_spaces_open(ctx, topology_name, "cavities", grid, 1, connectivity, &spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, spaces.count, "the sides of cavities", &sides.at_side));
    bvxi_spaces_each(&spaces, mark_cavity_side, &sides);
    for (uint64_t i = 0; i < spaces.count; i++) *count += !sides.at_side[i];
    return BVX_OK;
}

static bvx_status run_grid_topology(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                    bvx_topology *topology)
{
    bvx_topology t = {0};

    if (topology == NULL) return bvxi_fail_null(context, topology_name, "topology");
    BVXI_TRY(bvxi_grid_check(context, topology_name, grid));
    if (connectivity != BVXI_CONNECT_6 && connectivity != BVXI_CONNECT_26)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: connectivity is %d, not 6 or 26", topology_name, (int64_t)connectivity);
    BVXI_TRY(bvx_grid_count(context, grid, &t.voxels));
    bvxi_spaces spaces;
    BVXI_TRY(bvxi_spaces_open(context, topology_name, "parts", grid, 0, connectivity, &spaces));
    t.components = spaces.count;
    bvxi_spaces_free(&spaces);
    /* Body and cavities have opposite connectivities, or the Euler number would not hold. */
    BVXI_TRY(
        BVXI_SCOPE(context, count_cavities(context, grid,
                                           connectivity == BVXI_CONNECT_6 ? BVXI_CONNECT_26 : BVXI_CONNECT_6,
                                           &t.cavities)));
    int const any = connectivity == BVXI_CONNECT_26;
    for (int32_t z = any ? -1 : 0; z < grid->size[2]; z++)
        for (int32_t y = any ? -1 : 0; y < grid->size[1]; y++) {
            const uint64_t *const rows[4] = {euler_row(grid, y, z), euler_row(grid, y + 1, z),
                                             euler_row(grid, y, z + 1), euler_row(grid, y + 1, z + 1)};
            t.euler += euler_of_rows(rows, grid->words_per_row, bvxi_tail_mask(grid->size[0]), any);
        }
    /* Euler's formula in three dimensions: parts less tunnels plus cavities. */
    t.tunnels = (int64_t)(t.components + t.cavities) - t.euler;
    *topology = t;
    return BVX_OK;
}

bvx_status bvx_grid_topology(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                             bvx_topology *topology)
{
    return BVXI_CALL(context, run_grid_topology(context, grid, connectivity, topology));
}
