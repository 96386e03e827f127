/* spaces.c - runs of empty or set voxels joined to spaces (components.c), and handed out again with their numbers. */
#include "grid/spaces.h"

static uint64_t count_space_runs(const bvx_grid *grid, int32_t empty)
{
    uint64_t const rows = bvxi_grid_rows(grid);
    uint64_t n = 0;
    for (uint64_t r = 0; r < rows; r++) {
        const uint64_t *const row = grid->words + (size_t)r * (size_t)grid->words_per_row;
        uint64_t last = 0;
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
        if (z % step == 0) BVXI_TRY(bvxi_progress(ctx, s->stage, (double)z / (double)g->size[2]));
        for (int32_t y = 0; y < g->size[1]; y++, from += words) {
            uint64_t *const row = bvxi_components_row(&s->parts, y, z);
            for (int32_t k = 0; k < words; k++) row[k] = from[k] ^ flip;
            row[words - 1] &= tail;
            bvxi_components_add(&s->parts, y, z);
        }
    }
    bvxi_components_number(&s->parts);
    s->count = s->parts.component_count;
    return BVX_OK;
}

bvx_status bvxi_spaces_open(bvx_context *ctx, const char *function, const char *stage, const bvx_grid *grid, int32_t empty,
                            int32_t connectivity, bvxi_spaces *spaces)
{
    bvx_status status;
    memset(spaces, 0, sizeof *spaces);
    BVXI_TRY(bvxi_components_open(ctx, function, connectivity, grid->size, count_space_runs(grid, empty), &spaces->parts));
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
