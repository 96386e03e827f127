/* solid_rounds.c - crossings of triangles with rows, in rounds: pieces of the mesh find theirs, tiles of
 * rows take them. There are as many rounds as the memory for crossings requires.
 *
 * A tile is one task and alone writes its rows, so nothing is atomic. Guarantee: what a row gets does not
 * depend on rounds or threads. */
#include "solid/solid.h"

/* Bit i becomes the parity of the toggles at 0..i. Returns the parity of them all. summed: the steps of the
 * row's runs are added to *sum, up where one begins, down where it ends. */
static inline uint32_t close_row(uint64_t *words, int32_t n, uint64_t row, int summed, uint64_t *sum)
{
    uint64_t carry = 0;

    for (int32_t k = 0; k < n; k++) {
        uint64_t const w = words[k];

        /* Most words of a row hold no crossing: they are all inside or all outside. */
        if (w == 0) {
            words[k] = carry;
            while (carry == 0 && n - k > 4 &&
                   (words[k + 1] | words[k + 2] | words[k + 3] | words[k + 4]) == 0)
                k += 4;
            continue;
        }

        /* The carry is all ones after an odd number of toggles, so it turns a whole word at once. */
        uint64_t const in = bvxi_prefix_parity(w) ^ carry;
        words[k] = in;
        for (uint64_t left = summed ? w : 0; left != 0; left &= left - 1) {
            int32_t const bit = bvxi_lowest(left);
            uint64_t const step = bvxi_step_sum(row, k * BVXI_WORD_BITS + bit);
            *sum += (in >> bit & 1) != 0 ? step : 0 - step;
        }
        carry = 0 - (in >> 63);
    }
    return (uint32_t)(carry & 1);
}

static void close_tile(bvxi_solid_job *job, int32_t tile)
{
    const bvx_grid *const g = job->grid;
    bvxi_rows const r = bvxi_tiles_rows(&job->tiles, tile);
    uint64_t const tail = bvxi_tail_mask(g->size[0]);
    uint64_t sum = 0;

    for (int32_t k = r.k0; k < r.k1; k++) {
        for (int32_t j = r.j0; j < r.j1; j++) {
            uint64_t *const words = bvxi_block_words(job, j, k);
            uint64_t const row = bvxi_block_row(job, j, k), in_window = bvxi_window_row(job, j, k);
            uint32_t const odd = close_row(words, g->words_per_row, in_window, job->summed, &sum) ^
                                 job->beyond[row];

            /* A run that is open at the end of the window would set bits past the row. */
            words[g->words_per_row - 1] &= tail;
            job->beyond[row] = (uint8_t)odd; /* from here on: rows that do not balance */
            if (job->odd_rows != NULL) job->odd_rows[in_window] = (uint8_t)odd;
            job->unbalanced[tile] += odd;
        }
    }
    job->tile_sums[tile][1] = sum;
}

/* Where the rows of a tile are, by themselves: stores of words cannot change them. */
typedef struct row_places {
    uint64_t *words; /* of the block's first row */
    size_t row, slice;
    int32_t low, size; /* of the window along a row */
} row_places;

/* sum: of the steps of crossings (BVXI_TOGGLE_SUMMED), else it is left alone. */
static inline void take_crossing(bvxi_solid_job *job, const row_places *p, uint32_t at, int32_t code,
                                 int mode, uint64_t *sum)
{
    int32_t const j = (int32_t)(at & 0xffff), k = (int32_t)(at >> 16);

    if (mode == BVXI_TOGGLE || mode == BVXI_TOGGLE_SUMMED) {
        int32_t const x = bvxi_floor_shift(code, 1) - p->low;

        /* A crossing before the window is taken as one at its first voxel: it turns all that follows. One
         * beyond it only counts for the row's balance. */
        if (x < p->size) {
            int32_t const bit = x < 0 ? 0 : x;
            p->words[(size_t)k * p->slice + (size_t)j * p->row + (size_t)(bit >> 6)] ^= UINT64_C(1)
                                                                                        << (bit & 63);
            if (mode == BVXI_TOGGLE_SUMMED) {
                uint64_t const step = bvxi_step_sum(bvxi_window_row(job, j, k), bit);
                *sum += (code & 1) != 0 ? 0 - step : step;
            }
        } else {
            job->beyond[bvxi_block_row(job, j, k)] ^= 1;
        }
    } else if (mode == BVXI_HIGHEST) {
        int32_t *const highest = job->highest + bvxi_window_row(job, j, k);
        int32_t const x = bvxi_floor_shift(code, 1);
        if (x > *highest) *highest = x;
    } else {
        uint64_t const row = bvxi_block_row(job, j, k);
        if (job->listed != NULL && !job->listed[row]) return;
        if (mode == BVXI_FILL_LIST) job->lists.crossing[job->lists.row_end[row]] = code;
        job->lists.row_end[row]++;
    }
}

typedef struct tile_sink {
    bvxi_solid_job *job;
    row_places places;
    int32_t tile;
    uint64_t sum;
} tile_sink;

static void take_large(void *user, uint32_t row, int32_t code)
{
    tile_sink *const sink = user;
    if (sink->job->mode != BVXI_COUNT_LIST && sink->job->mode != BVXI_FILL_LIST)
        sink->job->crossings[sink->tile]++;
    take_crossing(sink->job, &sink->places, row, code, sink->job->mode, &sink->sum);
}

static void take_tile(void *user, int32_t tile)
{
    bvxi_solid_job *const job = user;
    bvxi_rows const rows = bvxi_tiles_rows(&job->tiles, tile);
    const bvx_grid *const g = job->grid;
    size_t const row = (size_t)g->words_per_row;
    row_places const places = {bvxi_block_words(job, 0, 0), row, row * (size_t)g->size[1], g->low[0],
                               g->size[0]};
    int const toggles = job->mode == BVXI_TOGGLE || job->mode == BVXI_TOGGLE_SUMMED;
    tile_sink sink = {job, places, tile, 0};

    /* A tile's words stay in the cache from the first crossing to the runs between them. */
    if (toggles && job->rounds == 1)
        for (int32_t k = rows.k0; k < rows.k1; k++)
            memset(bvxi_block_words(job, rows.j0, k), 0, (size_t)(rows.j1 - rows.j0) * row * 8);

    for (int32_t c = 0; c < job->chunks; c++) {
        const bvxi_chunk *const chunk = job->chunk + c;
        uint32_t const begin = chunk->tile_end[tile], end = chunk->tile_end[tile + 1];
        const bvxi_crossing *const x = chunk->sorted;

        /* The mode as a constant: the compiler makes one loop of each, without the questions in between. */
        if (job->mode == BVXI_TOGGLE) {
            for (uint32_t i = begin; i < end; i++)
                take_crossing(job, &places, x[i].row, x[i].code, BVXI_TOGGLE, &sink.sum);
            job->crossings[tile] += end - begin;
        } else if (job->mode == BVXI_TOGGLE_SUMMED) {
            for (uint32_t i = begin; i < end; i++)
                take_crossing(job, &places, x[i].row, x[i].code, BVXI_TOGGLE_SUMMED, &sink.sum);
            job->crossings[tile] += end - begin;
        } else {
            for (uint32_t i = begin; i < end; i++)
                take_crossing(job, &places, x[i].row, x[i].code, job->mode, &sink.sum);
            if (job->mode == BVXI_HIGHEST) job->crossings[tile] += end - begin;
        }

        /* Each tile cuts large triangles to its own rows, which needs no list and no lock. */
        for (uint32_t i = 0; i < chunk->large_count; i++)
            bvxi_cover_spans(job, rows, chunk->large[i], take_large, &sink);
    }
    job->tile_sums[tile][0] += sink.sum;
    if (toggles && job->last_round) close_tile(job, tile);
}

bvx_status bvxi_solid_rounds(bvx_context *ctx, bvxi_solid_job *job, int32_t mode, double from, double to)
{
    uint64_t const all = job->view->triangle_count;
    uint64_t left = all;

    job->mode = mode;
    job->rounds = 0;
    for (int32_t c = 0; c < job->chunks; c++) {
        bvxi_piece(all, job->chunks, c, &job->chunk[c].next, &job->chunk[c].end);
        job->chunk[c].bad = UINT64_MAX;
    }

    /* A round goes as far as the buffers hold; memory stays bounded whatever the mesh, at the price of
     * visiting tiles again. */
    while (left > 0) {
        double const at = bvxi_solid_progress(job, from + (to - from) * (1.0 - (double)left / (double)all));
        BVXI_TRY(bvxi_parallel(ctx, "solid", at, at, job->chunks, bvxi_find_crossings, job));
        left = 0;
        job->rounds++;
        for (int32_t c = 0; c < job->chunks; c++) {
            if (job->chunk[c].bad != UINT64_MAX)
                return bvxi_view_fail_index(ctx, job->function, job->view, job->chunk[c].bad);
            left += job->chunk[c].end - job->chunk[c].next;
        }
        job->last_round = left == 0;
        BVXI_TRY(bvxi_each(ctx, "solid", at, at, job->tiles.count, take_tile, job));
    }
    return BVX_OK;
}

bvx_status bvxi_solid_again(bvx_context *ctx, bvxi_solid_job *job, int32_t mode, double from, double to)
{
    /* After a single round all crossings are still in the buffers, so they need not be found again. */
    if (job->rounds != 1) return bvxi_solid_rounds(ctx, job, mode, from, to);
    job->mode = mode;
    return bvxi_each(ctx, "solid", bvxi_solid_progress(job, from), bvxi_solid_progress(job, to),
                     job->tiles.count, take_tile, job);
}
