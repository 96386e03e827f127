/* write_binvox.c - a grid to Patrick Min's .binvox, version 1.
 *
 * Source: https://www.patrickmin.com/binvox/binvox.html. Behind a header of lines stand pairs of bytes, a
 * value (0 or 1) and how often it comes (1 to 255), for the voxels with y running fastest, then z, then x.
 * Where voxels lie is reported in read_binvox.c. dim is written x y z.
 *
 * Bits run along x in a grid and along y in the file, so 64 layers of x at a time are turned. Runs go on from
 * layers to layers: the file has the fewest pairs that there can be. */
#include "bits/runs.h"
#include "io_grid/grid_formats.h"

enum { BINVOX_LONGEST_RUN = 255 };

/* The same number, some units in the last place away; v is above 0 and finite. */
static double binvox_neighbour(double v, int64_t steps)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    /* Neighbouring doubles of one sign have neighbouring bits, also across a power of two. */
    bits += (uint64_t)steps;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* A scale that gives back the spacing when it is divided by the longest side. Not every spacing has one: when
 * the product's power of two is above those of spacing and side together, quotients lie further apart than
 * spacings do. Then the spacing that is read is its neighbour. */
static double binvox_scale(double spacing, int32_t longest)
{
    double const n = (double)longest, scale = spacing * n;
    /* An infinite scale is refused by the caller, with the spacing in its message. */
    if (!(scale - scale == 0.0)) return scale;
    for (int64_t steps = 0; steps <= 4; steps++) {
        if (binvox_neighbour(scale, steps) / n == spacing) return binvox_neighbour(scale, steps);
        if (binvox_neighbour(scale, -steps) / n == spacing) return binvox_neighbour(scale, -steps);
    }
    return scale;
}

static void binvox_put_header(bvxi_output *out, const bvx_grid *grid, const double corner[3], double scale)
{
    bvxi_output_print(out, "#binvox 1\ndim %w\ntranslate %v\nscale %g\ndata\n", grid->size, " ", corner, " ",
                      scale);
}

typedef struct binvox_writing {
    const bvx_grid *grid;
    bvx_grid layers, turned; /* 64 of x, and these with rows along y */
    bvxi_output out;
    uint64_t length; /* of the run that is open */
    uint8_t value;
} binvox_writing;

static void binvox_close_run(binvox_writing *w)
{
    uint8_t pair[2] = {w->value, 0};
    for (; w->length > 0; w->length -= pair[1]) {
        pair[1] = (uint8_t)(w->length < BINVOX_LONGEST_RUN ? w->length : BINVOX_LONGEST_RUN);
        bvxi_output_add(&w->out, pair, sizeof pair);
    }
}

/* All layers, as the part [from, to] of the work; counted where out has no bytes. */
static bvx_status binvox_put_layers(bvx_context *ctx, binvox_writing *w, double from, double to)
{
    static const int32_t file_order[3] = {1, 2, 0};
    const bvx_grid *const g = w->grid;
    double const share = (to - from) / g->words_per_row;
    bvxi_runs runs;

    w->value = 0;
    for (int32_t c = 0; c < g->words_per_row; c++) {
        uint64_t const count = (uint64_t)(g->size[0] - 64 * c < 64 ? g->size[0] - 64 * c : 64);
        uint64_t left = count * (uint64_t)g->size[1] * (uint64_t)g->size[2];

        for (uint64_t row = 0; row < bvxi_grid_rows(g); row++)
            w->layers.words[row] = g->words[row * (uint64_t)g->words_per_row + (uint64_t)c];
        BVXI_TRY(BVXI_SHARE(ctx, from + share * c, from + share * (c + 1),
                            bvx_grid_permute(ctx, &w->layers, file_order, NULL, &w->turned)));
        bvxi_runs_start(&runs, w->turned.words, count * (uint64_t)g->size[2], g->size[1]);
        for (uint8_t value = 0; left > 0; value ^= 1) {
            uint64_t const length = bvxi_runs_next(&runs);
            left -= length;
            if (length != 0 && value != w->value) binvox_close_run(w);
            if (length != 0) w->value = value;
            w->length += length;
        }
    }
    binvox_close_run(w);
    return BVX_OK;
}

static bvx_status binvox_put(bvx_context *ctx, binvox_writing *w, bvx_buffer *file)
{
    const int32_t *const n = w->grid->size;
    bvx_lattice const box = {{0, 0, 0}, {1, 1, 1}, {n[0] < 64 ? n[0] : 64, n[1], n[2]}, BVXI_MIN_FRACTION};
    double corner[3], scale = 0;

    /* What the header says of the lattice; refuses what it cannot say. */
    const double *const s = w->grid->lattice.spacing;
    int32_t longest = 1;

    /* The format has one scale for all axes. */
    if (!(s[0] == s[1] && s[1] == s[2]))
        return bvxi_fail(ctx, BVX_ERR_UNSUPPORTED,
                         "BINVOX: voxels must be cubes, the spacing is %g, %g, %g; take BVX, NRRD or VTI",
                         s[0], s[1], s[2]);
    for (int32_t a = 0; a < 3; a++)
        if (w->grid->size[a] > longest) longest = w->grid->size[a];
    BVXI_TRY(bvxi_check_written_corner(ctx, "BINVOX", w->grid));
    scale = binvox_scale(s[0], longest);
    bvxi_grid_corner(w->grid, corner);
    if (!(scale - scale == 0.0))
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                             "BINVOX: %d voxels of %g are longer than a number can be", (int64_t)longest,
                             s[0]);
    BVXI_TRY(bvx_grid_create(ctx, &box, NULL, &w->layers));
    binvox_put_header(&w->out, w->grid, corner, scale);
    BVXI_TRY(binvox_put_layers(ctx, w, 0.0, 0.5));
    BVXI_TRY(bvxi_make_buffer(ctx, w->out.size, "the BINVOX file", file));
    w->out.bytes = file->bytes;
    w->out.size = 0;
    binvox_put_header(&w->out, w->grid, corner, scale);
    return binvox_put_layers(ctx, w, 0.5, 1.0);
}

bvx_status bvxi_write_binvox(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    binvox_writing w = {.grid = grid};
    bvx_buffer made = {0};
    bvx_status const status = binvox_put(ctx, &w, &made);
    bvx_grid_free(ctx, &w.turned);
    bvx_grid_free(ctx, &w.layers);
    if (status != BVX_OK) bvx_buffer_free(ctx, &made);
    else *file = made;
    return status;
}
