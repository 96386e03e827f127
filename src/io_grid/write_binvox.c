/* write_binvox.c - a grid to Patrick Min's .binvox, version 1.
 *
 * Source: https://www.patrickmin.com/binvox/binvox.html. Behind a header of lines stand pairs of bytes, a
 * value (0 or 1) and how often it comes (1 to 255), for the voxels with y running fastest, then z, then x.
 * Where voxels lie is reported in read_binvox.c. dim is written x y z.
 *
 * Bits run along x in a grid and along y in the file, so blocks of 64 x 64 bits are turned over, 64 layers of
 * x at a time, and runs are then found in words along y. The layers of x are worked on in parallel twice:
 * first what their runs take, then, when it is known where each begins, the bytes. A run that goes on from
 * one such group of layers to the next is joined and written by itself in between; so the file is the one
 * with the fewest pairs, whatever the threads. */
#include "bits/runs.h"
#include "bits/bits.h"
#include "io/formats.h"
#include "io_grid/grid_formats.h"

enum { BINVOX_LONGEST_RUN = 255, BINVOX_LINE = 8 /* words of a cache line */ };

/* The runs of 64 layers (or the last few), without their first and last run, which neighbours may go on
 * with. */
typedef struct binvox_layers {
    /* lengths of the first run and of the last; the same run when single is set */
    uint64_t first, last;
    uint64_t inner; /* bytes of the runs between them */
    uint64_t place; /* where these stand in the file */
    uint8_t first_value, last_value;
    uint8_t single;
} binvox_layers;

typedef struct binvox_writing {
    const bvx_grid *grid;
    binvox_layers *layers; /* of each word column of the grid */
    uint64_t *turned;      /* 64 layers for each worker, or for each column when these are fewer */
    int32_t buffers;
    uint64_t layer_words; /* words of one layer: rows of y, one for each z */
    uint64_t worker_words;
    uint8_t *bytes; /* the file; NULL in the first pass */
} binvox_writing;

/* ---- 64 layers turned, so that bits run along y ---- */

static void binvox_turn_block(const bvx_grid *g, int32_t column, int32_t y, int32_t z, uint64_t block[64])
{
    int32_t const rows = g->size[1] - y < 64 ? g->size[1] - y : 64;
    const uint64_t *from = g->words +
                           ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->words_per_row +
                           (uint64_t)column;
    uint64_t any = 0, all = ~UINT64_C(0);

    /* Whether the block is all empty or all set is seen on the way: then turning changes nothing. */
    for (int32_t i = 0; i < 64; i++) {
        block[i] = i < rows ? *from : 0;
        if (i + 1 < rows) from += g->words_per_row;
        any |= block[i];
        all &= block[i];
    }
    if (any != 0 && all != ~UINT64_C(0)) bvxi_transpose_64(block);
}

/* Layers of a cube lie a power of two apart, which all falls into one
 * corner of a cache: so lines of it are written whole. */
static void binvox_turn_layers(const binvox_writing *job, int32_t column, uint64_t *turned)
{
    const bvx_grid *const g = job->grid;
    int32_t const row_words = bvxi_row_words(g->size[1]);
    int32_t const count = g->size[0] - column * 64 < 64 ? g->size[0] - column * 64 : 64;
    uint64_t block[BINVOX_LINE][64];

    /* A cache line of eight blocks is turned together and written layer by layer. */
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t k = 0; k < row_words; k += BINVOX_LINE) {
            uint64_t *to = turned + (uint64_t)z * (uint64_t)row_words + (uint64_t)k;
            int32_t const n = row_words - k < BINVOX_LINE ? row_words - k : BINVOX_LINE;
            for (int32_t j = 0; j < n; j++) binvox_turn_block(g, column, (k + j) * 64, z, block[j]);
            for (int32_t i = 0; i < count; i++, to += job->layer_words)
                for (int32_t j = 0; j < n; j++) to[j] = block[j][i];
        }
}

/* ---- runs ---- */

static uint64_t binvox_run_bytes(uint64_t length)
{
    return (length + BINVOX_LONGEST_RUN - 1) / BINVOX_LONGEST_RUN * 2;
}

static uint8_t *binvox_put_run(uint8_t *p, uint8_t value, uint64_t length)
{
    for (; length > BINVOX_LONGEST_RUN; length -= BINVOX_LONGEST_RUN) {
        *p++ = value;
        *p++ = BINVOX_LONGEST_RUN;
    }
    *p++ = value;
    *p++ = (uint8_t)length;
    return p;
}

/* All layers of one column of words: counted in the first pass, written in the second. */
static void binvox_column_task(void *user, int32_t column, int32_t worker)
{
    binvox_writing *const job = user;
    const bvx_grid *const g = job->grid;
    binvox_layers *const layers = &job->layers[column];
    uint64_t *const turned = job->turned + (uint64_t)(g->words_per_row == job->buffers ? column : worker) *
                                               job->worker_words;
    uint64_t const count = (uint64_t)(g->size[0] - column * 64 < 64 ? g->size[0] - column * 64 : 64);
    uint64_t left = count * (uint64_t)g->size[1] * (uint64_t)g->size[2];
    uint8_t *p = job->bytes != NULL ? job->bytes + layers->place : NULL;
    bvxi_runs runs;
    uint8_t value = 0;
    uint64_t length;

    /* The runs are taken from the turned layers in both passes, rather than kept in between. */
    binvox_turn_layers(job, column, turned);
    bvxi_runs_start(&runs, turned, count * (uint64_t)g->size[2], g->size[1]);
    length = bvxi_runs_next(&runs);
    /* The first run may have no length, where the column begins with a set voxel. */
    if (length == 0) {
        length = bvxi_runs_next(&runs);
        value = 1;
    }
    left -= length;

    /* First and last run may go on in the neighbours, so
     * they are measured here and written by who joins them. */
    layers->first = length;
    layers->first_value = value;
    layers->single = left == 0;
    layers->inner = 0;
    /* Runs alternate; the last is known by nothing being left after it. */
    while (left > 0) {
        length = bvxi_runs_next(&runs);
        value ^= 1;
        left -= length;
        if (left == 0) break;
        if (p != NULL) p = binvox_put_run(p, value, length);
        layers->inner += binvox_run_bytes(length);
    }
    layers->last = length;
    layers->last_value = value;
}

/* ---- the columns joined ---- */

typedef struct binvox_joint {
    uint8_t *bytes; /* NULL: only count */
    uint64_t size;
    uint64_t length; /* of the run that is open */
    uint8_t value;
} binvox_joint;

static void binvox_close_run(binvox_joint *joint)
{
    if (joint->length == 0) return;
    if (joint->bytes != NULL) binvox_put_run(joint->bytes + joint->size, joint->value, joint->length);
    joint->size += binvox_run_bytes(joint->length);
    joint->length = 0;
}

static void binvox_add_run(binvox_joint *joint, uint8_t value, uint64_t length)
{
    if (value != joint->value) binvox_close_run(joint);
    joint->value = value;
    joint->length += length;
}

/* Where each column's inner runs stand, and the runs between them. Returns the file's size. */
static uint64_t binvox_join(binvox_layers *layers, int32_t columns, uint8_t *bytes, uint64_t header)
{
    binvox_joint joint = {0};

    joint.bytes = bytes;
    joint.size = header;
    /* A column of one single run has neither inner runs nor an end: it only makes the open run longer. */
    for (int32_t i = 0; i < columns; i++) {
        binvox_add_run(&joint, layers[i].first_value, layers[i].first);
        if (!layers[i].single) binvox_close_run(&joint);
        layers[i].place = joint.size;
        if (layers[i].single) continue;
        joint.size += layers[i].inner;
        binvox_add_run(&joint, layers[i].last_value, layers[i].last);
    }
    binvox_close_run(&joint);
    return joint.size;
}

/* ---- header ---- */

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

static void binvox_put_numbers(bvxi_output *out, const char *name, const double *numbers, int32_t count)
{
    bvxi_output_text(out, name);
    for (int32_t i = 0; i < count; i++) {
        bvxi_output_text(out, " ");
        bvxi_output_double(out, numbers[i]);
    }
    bvxi_output_text(out, "\n");
}

static void binvox_put_header(bvxi_output *out, const bvx_grid *grid, const double corner[3], double scale)
{
    bvxi_output_text(out, "#binvox 1\ndim");
    for (int32_t a = 0; a < 3; a++) {
        bvxi_output_text(out, " ");
        bvxi_output_number(out, (uint64_t)grid->size[a]);
    }
    bvxi_output_text(out, "\n");
    binvox_put_numbers(out, "translate", corner, 3);
    binvox_put_numbers(out, "scale", &scale, 1);
    bvxi_output_text(out, "data\n");
}

/* What the header says of the lattice; refuses what it cannot say. */
static bvx_status binvox_place(bvx_context *ctx, const bvx_grid *grid, double corner[3], double *scale)
{
    const double *const s = grid->lattice.spacing;
    int32_t longest = 1;

    /* The format has one scale for all axes. */
    if (!(s[0] == s[1] && s[1] == s[2]))
        return bvxi_fail(ctx, BVX_ERR_UNSUPPORTED,
                         "BINVOX: voxels must be cubes, the spacing is %g, %g, %g; take BVX, NRRD or VTI",
                         s[0], s[1], s[2]);
    for (int32_t a = 0; a < 3; a++)
        if (grid->size[a] > longest) longest = grid->size[a];
    BVXI_TRY(bvxi_check_written_corner(ctx, "BINVOX", grid));
    *scale = binvox_scale(s[0], longest);
    bvxi_grid_corner(grid, corner);
    if (!(*scale - *scale == 0.0))
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                             "BINVOX: %d voxels of %g are longer than a number can be", (int64_t)longest,
                             s[0]);
    return BVX_OK;
}

/* ---- the file ---- */

static bvx_status binvox_pack(bvx_context *ctx, binvox_writing *job, const double corner[3], double scale,
                              bvx_buffer *file)
{
    static const char *const stage = "write";
    int32_t const columns = job->grid->words_per_row;
    bvxi_output header = {0};
    bvx_buffer made = {0};
    bvx_status status;

    /* Counted first, so that the file is made once, in its exact size. */
    BVXI_TRY(bvxi_parallel(ctx, stage, 0.0, 0.5, columns, binvox_column_task, job));
    binvox_put_header(&header, job->grid, corner, scale);
    BVXI_TRY(bvxi_make_buffer(ctx, binvox_join(job->layers, columns, NULL, header.size), "the BINVOX file",
                              &made));
    job->bytes = header.bytes = made.bytes;
    header.size = 0;

    binvox_put_header(&header, job->grid, corner, scale);
    binvox_join(job->layers, columns, made.bytes, header.size);
    status = bvxi_parallel(ctx, stage, 0.5, 1.0, columns, binvox_column_task, job);
    if (status == BVX_OK) *file = made;
    else bvx_buffer_free(ctx, &made);
    return status;
}

bvx_status bvxi_write_binvox(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    uint64_t const columns = (uint64_t)grid->words_per_row * sizeof(binvox_layers);
    uint64_t const layers = (uint64_t)(grid->size[0] < 64 ? grid->size[0] : 64);
    uint64_t turned;
    binvox_writing job = {0};
    double corner[3], scale = 0;
    int fits = 1;

    BVXI_TRY(binvox_place(ctx, grid, corner, &scale));
    job.grid = grid;
    /* Buffers follow the threads, not the columns: memory stays small for long grids. */
    job.buffers = bvxi_threads(ctx) < grid->words_per_row ? bvxi_threads(ctx) : grid->words_per_row;
    job.layer_words = (uint64_t)grid->size[2] * (uint64_t)bvxi_row_words(grid->size[1]);
    job.worker_words = bvxi_mul(job.layer_words, layers, &fits);
    turned = bvxi_mul(bvxi_mul(job.worker_words, (uint64_t)job.buffers, &fits), 8, &fits);
    if (!fits) turned = UINT64_MAX; /* refused by the allocation */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, columns, "the columns' runs", &job.layers));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, turned, "layers along y", &job.turned));
    BVXI_TRY(binvox_pack(ctx, &job, corner, scale, file));
    return BVX_OK;
}
