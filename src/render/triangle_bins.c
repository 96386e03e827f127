/* triangle_bins.c - triangles sorted into bands by counting.
 *
 * Pieces of triangles count how many reach each band, prefix sums give each piece its places, and the pieces
 * fill them in. A band has its triangles in ascending order, so the result depends on no thread. */
#include "render/raster.h"

enum { BINS_GRAIN = 16384 /* triangles a piece, at least */, BINS_PIECES = 64 };

typedef struct bins_work {
    bvxi_triangle_bins *bins;
    uint64_t triangle_count;
    int32_t pieces;
    bvxi_bands_fn *reach;
    const void *user;
    uint64_t *place; /* of each piece and band: first a count, then where its next triangle goes */
} bins_work;

static void walk_bins_piece(const bins_work *w, int32_t index, int fill)
{
    uint64_t *const place = w->place + (size_t)index * (size_t)w->bins->bands;
    uint64_t begin, end;
    int32_t first, last;

    bvxi_piece(w->triangle_count, w->pieces, index, &begin, &end);
    for (uint64_t t = begin; t < end; t++) {
        if (!w->reach(w->user, (uint32_t)t, &first, &last)) continue;
        /* A triangle over several bands is in each of them. */
        for (int32_t b = first; b <= last; b++) {
            if (fill) w->bins->triangle[place[b]] = (uint32_t)t;
            place[b]++;
        }
    }
}

static void count_bins_piece(void *user, int32_t index, int32_t worker)
{
    (void)worker;
    walk_bins_piece(user, index, 0);
}

static void fill_bins_piece(void *user, int32_t index, int32_t worker)
{
    (void)worker;
    walk_bins_piece(user, index, 1);
}

static void place_bins(const bins_work *w)
{
    uint64_t sum = 0;

    /* Bands outermost, so that in each of them the pieces stand in their order. */
    for (int32_t b = 0; b < w->bins->bands; b++) {
        w->bins->begin[b] = sum;
        for (int32_t p = 0; p < w->pieces; p++) {
            uint64_t *const place = &w->place[(size_t)p * (size_t)w->bins->bands + (size_t)b];
            uint64_t const n = *place;
            *place = sum;
            sum += n;
        }
    }
    w->bins->begin[w->bins->bands] = sum;
    w->bins->total = sum;
}

bvx_status bvxi_triangle_bins_open(bvx_context *ctx, uint64_t triangle_count, int32_t bands,
                                   bvxi_bands_fn *reach, const void *user, bvxi_triangle_bins *bins)
{
    bins_work w = {bins, triangle_count, bvxi_piece_count(triangle_count, BINS_GRAIN), reach, user, NULL};
    uint64_t places;
    bvx_status status;

    w.pieces = w.pieces < BINS_PIECES ? w.pieces : BINS_PIECES;
    places = (uint64_t)w.pieces * (uint64_t)bands;
    bins->bands = bands;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, ((uint64_t)bands + 1) * 8, "the picture's bands", &bins->begin));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, places * 8, "the picture's bands", &w.place));
    status = bvxi_parallel(ctx, "render", 0.1, 0.15, w.pieces, count_bins_piece, &w);
    /* Counts are places now, and their sum is the size of the list. */
    if (status == BVX_OK) {
        place_bins(&w);
        status = bvxi_alloc(ctx, BVXI_SCRATCH, bins->total * 4, "the picture's triangles", &bins->triangle);
    }
    if (status == BVX_OK) status = bvxi_parallel(ctx, "render", 0.15, 0.2, w.pieces, fill_bins_piece, &w);
    bvxi_drop(ctx, w.place);
    return status;
}

void bvxi_triangle_bins_close(bvx_context *ctx, bvxi_triangle_bins *bins)
{
    bvxi_drop(ctx, bins->triangle);
    bvxi_drop(ctx, bins->begin);
}
