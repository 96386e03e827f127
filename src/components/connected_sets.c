/* connected_sets.c - runs of empty or set voxels joined to spaces (components.c),
 * and handed out again with their numbers. */
#include "components/room.h"

static uint64_t count_space_runs(const bvx_grid *grid, int32_t empty)
{
    uint64_t const rows = bvxi_grid_rows(grid);
    uint64_t n = 0;

    for (uint64_t r = 0; r < rows; r++) {
        const uint64_t *const row = grid->words + (size_t)r * (size_t)grid->words_per_row;
        uint64_t last = 0;
        /* Empty voxels are set ones of the inverted word, without what lies past the row. */
        for (int32_t k = 0; k < grid->words_per_row; k++) {
            uint64_t w = empty ? ~row[k] : row[k];
            if (k + 1 == grid->words_per_row) w &= bvxi_tail_mask(grid->size[0]);
            n += bvxi_popcount(bvxi_run_changes(w, &last) & w);
        }
    }
    return n;
}

static bvx_status join_spaces(bvx_context *ctx, bvxi_spaces *s)
{
    const bvx_grid *const g = s->grid;
    int32_t const step = (g->size[2] + 7) / 8, words = g->words_per_row;
    uint64_t const flip = s->empty ? ~UINT64_C(0) : 0, tail = bvxi_tail_mask(g->size[0]);
    const uint64_t *from = g->words;

    for (int32_t z = 0; z < g->size[2]; z++) {
        /* Eight calls of progress over the grid, as a slice may be small. */
        if (z % step == 0) BVXI_TRY(bvxi_progress(ctx, s->stage, (double)z / (double)g->size[2]));
        for (int32_t y = 0; y < g->size[1]; y++, from += words) {
            uint64_t *const row = bvxi_components_row(&s->parts, y, z);
            /* The row is made where the components want it: no inverted grid is needed. */
            for (int32_t k = 0; k < words; k++) row[k] = from[k] ^ flip;
            row[words - 1] &= tail;
            bvxi_components_add(&s->parts, y, z);
        }
    }
    bvxi_components_number(&s->parts);
    s->count = s->parts.component_count;
    return BVX_OK;
}

bvx_status bvxi_spaces_open(bvx_context *ctx, const char *function, const char *stage, const bvx_grid *grid,
                            int32_t empty, int32_t connectivity, bvxi_spaces *spaces)
{
    bvx_status status;

    memset(spaces, 0, sizeof *spaces);

    /* The number of runs is known before, so the forest is made in its exact size. */
    BVXI_TRY(bvxi_components_open(ctx, function, connectivity, grid->size, count_space_runs(grid, empty),
                                  &spaces->parts));
    spaces->grid = grid;
    spaces->stage = stage;
    spaces->empty = empty;
    status = join_spaces(ctx, spaces);
    if (status != BVX_OK) bvxi_spaces_free(spaces);
    return status;
}

void bvxi_spaces_each(const bvxi_spaces *spaces, bvxi_spaces_fn *take, void *user)
{
    const bvx_grid *const g = spaces->grid;
    const uint32_t *label = spaces->parts.label;

    /* The same runs in the same order as they were joined, so labels go along with them. */
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            size_t const row = (size_t)z * (size_t)g->size[1] + (size_t)y;
            bvxi_row_runs runs;
            int32_t begin, end;
            bvxi_row_runs_start(&runs, g->words + row * (size_t)g->words_per_row, g->size[0], spaces->empty);
            while (bvxi_row_runs_next(&runs, &begin, &end)) take(user, *label++, begin, end, y, z);
        }
}

void bvxi_spaces_free(bvxi_spaces *spaces)
{
    bvxi_components_free(&spaces->parts);
    memset(spaces, 0, sizeof *spaces);
}

/* ---- What is done with all of them ---- */

typedef struct spaces_sizes {
    const bvx_grid *grid;
    uint64_t *voxels;
    uint8_t *at_side;
} spaces_sizes;

static void measure_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const spaces_sizes *const s = user;
    s->voxels[space] += (uint64_t)(end - begin);
    if (s->at_side != NULL && bvxi_spaces_at_side(s->grid, begin, end, y, z)) s->at_side[space] = 1;
}

void bvxi_spaces_measure(const bvxi_spaces *spaces, uint64_t *voxels, uint8_t *at_side)
{
    spaces_sizes s = {spaces->grid, voxels, at_side};
    bvxi_spaces_each(spaces, measure_space_run, &s);
}

typedef struct spaces_flip {
    const bvx_grid *grid;
    const uint8_t *marked;
    uint64_t *words;
} spaces_flip;

static void flip_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const spaces_flip *const f = user;
    uint64_t *const row = f->words +
                          ((size_t)z * (size_t)f->grid->size[1] + (size_t)y) * (size_t)f->grid->words_per_row;
    /* The run is cut into words; a flip turns empty voxels to set ones and back. */
    if (!f->marked[space]) return;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] ^= bvxi_run_mask(begin, end, k);
}

void bvxi_spaces_flip(const bvxi_spaces *spaces, const uint8_t *marked, uint64_t *words)
{
    spaces_flip f = {spaces->grid, marked, words};
    bvxi_spaces_each(spaces, flip_space_run, &f);
}

bvx_status bvxi_check_connectivity(bvx_context *ctx, const char *function, int32_t connectivity)
{
    if (connectivity == BVXI_CONNECT_6 || connectivity == BVXI_CONNECT_18 || connectivity == BVXI_CONNECT_26)
        return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: connectivity is %d, not 6, 18 or 26",
                         function, (int64_t)connectivity);
}
