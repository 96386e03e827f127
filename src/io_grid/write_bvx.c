/* write_bvx.c - a grid to our own format, whole or slice by slice; the layout stands in bvx_file.h.
 *
 * Two passes over the slices, both in parallel: what each slice takes in its shorter encoding, then, with the
 * places known, the bytes and their checksums. So the file is allocated once in its exact size, and its bytes
 * follow from the bits only. */
#include "bits/runs.h"
#include "io_grid/bvx_file.h"
#include "io_grid/grid_formats.h"

typedef struct bvx_packing {
    const bvx_grid *grid;
    /* bytes of slice k's payload; after the first pass: where slice k starts, and one more: the end */
    uint64_t *place;
    uint8_t *bytes; /* the file */
    uint64_t frame; /* seed of the checksums */
    uint64_t raw;   /* bytes of a slice as words */
} bvx_packing;

static void bvx_put_head(const bvx_lattice *lattice, const bvx_window *window, uint8_t head[BVXI_BVX_HEAD])
{
    bvxi_bvx_put_start(head, BVXI_BVX_GRID, lattice, lattice->dims);
    for (int32_t a = 0; a < 2; a++) {
        bvxi_store_u32(head + BVXI_BVX_AT_LOW + 4 * a, (uint32_t)window->low[a]);
        bvxi_store_u32(head + BVXI_BVX_AT_SIZE + 4 * a, (uint32_t)window->size[a]);
    }
    bvxi_store_u32(head + BVXI_BVX_AT_Z, (uint32_t)window->low[2]);
    bvxi_store_u32(head + BVXI_BVX_AT_Z + 4, (uint32_t)window->size[2]);
    bvxi_store_u64(head + BVXI_BVX_AT_CHECK, bvx_hash(head, BVXI_BVX_AT_CHECK, 0));
}

/* ---- one slice ---- */

static void bvx_start_runs(const bvx_packing *job, int32_t k, bvxi_runs *runs)
{
    const bvx_grid *const g = job->grid;
    bvxi_runs_start(runs, g->words + (uint64_t)k * (job->raw / 8), (uint64_t)g->size[1], g->size[0]);
}

static uint64_t bvx_slice_voxels(const bvx_grid *grid)
{
    return (uint64_t)grid->size[0] * (uint64_t)grid->size[1]; /* at most 2^50 */
}

/* Bytes of the slice's runs, or those of its words when they are not more. */
static uint64_t bvx_measure_slice(const bvx_packing *job, int32_t k)
{
    bvxi_runs runs;
    uint64_t left = bvx_slice_voxels(job->grid), bytes = 0;
    bvx_start_runs(job, k, &runs);
    while (left > 0) {
        /* Seven bits of a length take a byte. Words win a tie, as they are read faster. */
        uint64_t length = bvxi_runs_next(&runs);
        left -= length;
        for (bytes++; length > 127; length >>= 7) bytes++;
        if (bytes >= job->raw) return job->raw;
    }
    return bytes;
}

static void bvx_put_slice(const bvx_packing *job, int32_t k)
{
    uint8_t *const p = job->bytes + job->place[k];
    /* The kind follows from the length alone: runs are only taken where they are shorter than the words. */
    uint64_t const n = job->place[k + 1] - job->place[k] - BVXI_BVX_SLICE_HEAD;
    int const raw = n == job->raw;
    bvxi_store_u32(p + 8, (uint32_t)(job->grid->low[2] + k));
    bvxi_store_u32(p + 12, raw ? BVXI_BVX_RAW : BVXI_BVX_RUNS);
    bvxi_store_u64(p + 16, n);
    uint8_t *to = p + BVXI_BVX_SLICE_HEAD;
    if (raw) {
        const bvx_grid *const g = job->grid;
        const uint64_t *word = g->words + (uint64_t)k * (job->raw / 8);
        uint64_t const tail = bvxi_tail_mask(g->size[0]);
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t i = 0; i < g->words_per_row; i++, to += 8)
                bvxi_store_u64(to, i + 1 < g->words_per_row ? *word++ : *word++ & tail);
    } else {
        bvxi_runs runs;
        uint64_t left = bvx_slice_voxels(job->grid);
        bvx_start_runs(job, k, &runs);
        while (left > 0) {
            uint64_t length = bvxi_runs_next(&runs);
            left -= length;
            for (; length > 127; length >>= 7) *to++ = (uint8_t)(length & 127) | 128;
            *to++ = (uint8_t)length;
        }
    }
    bvxi_store_u64(p, bvxi_bvx_slice_check(p, n, job->frame));
}

/* ---- all slices ---- */

static void bvx_measure_piece(void *user, uint64_t k, uint64_t end)
{
    bvx_packing *const job = user;
    for (; k < end; k++) job->place[k] = bvx_measure_slice(job, (int32_t)k);
}

static void bvx_put_piece(void *user, uint64_t k, uint64_t end)
{
    bvx_packing *const job = user;
    for (; k < end; k++) bvx_put_slice(job, (int32_t)k);
}

static bvx_status bvx_pack_grid(bvx_context *ctx, const bvx_grid *grid, int with_head, bvx_buffer *file)
{
    uint8_t head[BVXI_BVX_HEAD];
    bvx_window window;
    memcpy(window.low, grid->low, sizeof window.low);
    memcpy(window.size, grid->size, sizeof window.size);
    bvx_put_head(&grid->lattice, &window, head);
    static const char *const stage = "write";
    uint64_t const places = ((uint64_t)grid->size[2] + 1) * sizeof(uint64_t);
    uint64_t const slices = (uint64_t)grid->size[2];
    uint64_t const grain = 1 + 8192 * slices / bvxi_grid_words(grid); /* of many words, or one slice */
    bvx_buffer made = {0};

    bvx_packing job = {.grid = grid,
                       .frame = bvxi_bvx_frame(head),
                       .raw = (uint64_t)grid->size[1] * (uint64_t)grid->words_per_row * 8};

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, places, "the places of slices", &job.place));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.5, bvxi_for(ctx, stage, slices, grain, bvx_measure_piece, &job)));
    /* From bytes to places: the sizes sum up after the first bytes of the file. */
    uint64_t first = with_head ? BVXI_BVX_HEAD : 0;
    for (int32_t k = 0; k < grid->size[2]; k++) {
        /* The bytes of the slice give way to its place; the last is the end: lengths are differences. */
        uint64_t const n = job.place[k];
        job.place[k] = first;
        first += BVXI_BVX_SLICE_HEAD + n;
    }
    job.place[grid->size[2]] = first;
    BVXI_TRY(bvxi_make_buffer(ctx, first, "the BVX file", &made));

    /* The second pass finds the same lengths as the first, so each slice fills its place exactly. */
    if (with_head) memcpy(made.bytes, head, BVXI_BVX_HEAD);
    job.bytes = made.bytes;
    bvx_status const status = BVXI_SHARE(ctx, 0.5, 1.0,
                                         bvxi_for(ctx, stage, slices, grain, bvx_put_piece, &job));
    if (status != BVX_OK) bvx_buffer_free(ctx, &made);
    else *file = made;
    return status;
}

bvx_status bvxi_write_bvx(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    return bvx_pack_grid(ctx, grid, 1, file);
}

/* ---- in parts ---- */

static bvx_status run_write_head(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                                 bvx_buffer *file)
{
    static const char *const function = "bvx_write_head";
    bvx_buffer made = {0};
    /* The head alone names the window: its slices may be written by other calls, or other machines. */
    bvx_window whole;
    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_lattice_check(context, function, lattice));
    BVXI_TRY(bvxi_window_take(context, function, lattice, window, &whole));
    BVXI_TRY(bvxi_make_buffer(context, BVXI_BVX_HEAD, "the head of a BVX file", &made));
    bvx_put_head(lattice, &whole, made.bytes);
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_head(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                          bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_head(context, lattice, window, file));
}

/* No part knows the others: that they follow each other in z and that they end
 * where the head says is checked by who reads the file. A part of another lattice,
 * or not of the head's window in x and y, shows there too, by its checksums. */
static bvx_status run_write_slices(bvx_context *context, const bvx_grid *part, bvx_buffer *file)
{
    static const char *const function = "bvx_write_slices";
    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_grid_check(context, function, part));
    return bvx_pack_grid(context, part, 0, file);
}

bvx_status bvx_write_slices(bvx_context *context, const bvx_grid *part, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_slices(context, part, file));
}
