/* read_binvox.c - a grid from Patrick Min's .binvox, versions 1 and 2.
 *
 * Source: https://www.patrickmin.com/binvox/binvox.html. A header of lines ("#binvox 1", dim, translate,
 * scale, data), then pairs of bytes, a value and how often it comes, with y running fastest, then z, then x.
 * Version 2 has values above 1 for set voxels; any value but 0 is set here. The counts must add up to dim
 * exactly; a count of 0, which trimesh writes, is none.
 *
 * Where voxels lie: the page puts the centre of voxel (i,j,k) of a cube of d voxels at translate + scale *
 * ((i,j,k) + 1/2) / d, so translate is the low corner of voxel (0,0,0) and a voxel's edge is scale / d. With
 * unequal sides d is the longest one, as cuda_voxelizer has it. viewvox draws voxels only and looks at
 * neither number. trimesh differs: translate is the centre of voxel (0,0,0), and the step from voxel to voxel
 * is scale / (d - 1). So it shows our files half a voxel lower and d / (d - 1) times as large, and what it
 * writes has here voxels (d - 1) / d as large.
 *
 * Which side dim names first matters with unequal sides only. The page says depth, width, height for x, y,
 * z, and trimesh and cuda_voxelizer do so; the page's sample reader takes the second number for z. Here it is
 * x y z.
 *
 * 64 layers of x are decoded to bits along y, then turned in blocks of 64 x 64 to bits along x. Groups of
 * layers are worked on in parallel, once a pass over the pairs has found where each begins. */
#include "bits/bits.h"
#include "io/formats.h"
#include "io_grid/grid_formats.h"

enum { BINVOX_MAX_TASKS = 256 };

/* A place in the pairs: the next voxel is number used of the run at p. */
typedef struct binvox_mark {
    const uint8_t *p;
    uint64_t used;
} binvox_mark;

typedef struct binvox_reading {
    const bvxi_grid_source *source;
    const char *at, *end; /* the header's line that is read */
    uint64_t line;
    uint64_t dims[3];
    double translate[3], scale;
    int has_dims;
    const uint8_t *data;
    bvx_window part;
    bvx_grid *grid;
    uint64_t *layers;     /* 64 layers of the part for each worker, or for each task when these are fewer */
    uint64_t layer_words; /* rows of y, one for each z */
    uint64_t worker_words;
    int32_t tasks, buffers;
    binvox_mark mark[BINVOX_MAX_TASKS];
} binvox_reading;

/* ---- header ---- */

static bvx_status binvox_fail_line(const binvox_reading *r, const char *what)
{
    return bvxi_fail(r->source->ctx, BVX_ERR_FORMAT, "BINVOX: line %u: %s", r->line, what);
}

static void binvox_skip_blank(binvox_reading *r)
{
    while (r->at < r->end && bvxi_is_blank(*r->at)) r->at++;
}

/* 1 and past it when the line goes on with this word. */
static int binvox_take_word(binvox_reading *r, const char *word)
{
    size_t const n = bvxi_text_length(word);
    binvox_skip_blank(r);
    if ((size_t)(r->end - r->at) < n || memcmp(r->at, word, n) != 0) return 0;
    if (r->at + n < r->end && !bvxi_is_blank(r->at[n])) return 0;
    r->at += n;
    return 1;
}

static int binvox_take_whole(binvox_reading *r, uint64_t *value)
{
    /* The sum is checked as it grows, since dim may be any number. */
    const char *const begin = (binvox_skip_blank(r), r->at);
    int fits = 1;
    *value = 0;
    for (; r->at < r->end && *r->at >= '0' && *r->at <= '9'; r->at++)
        *value = bvxi_add(bvxi_mul(*value, 10, &fits), (uint64_t)(*r->at - '0'), &fits);
    return r->at != begin && fits && (r->at == r->end || bvxi_is_blank(*r->at));
}

static int binvox_take_double(binvox_reading *r, double *value)
{
    binvox_skip_blank(r);
    size_t const n = bvxi_parse_double(r->at, r->end, value);
    r->at += n;
    return n != 0 && (r->at == r->end || bvxi_is_blank(*r->at));
}

static int binvox_line_ends(binvox_reading *r)
{
    binvox_skip_blank(r);
    return r->at == r->end;
}

/* The next line; 0 when there is none that ends. */
static int binvox_next_line(binvox_reading *r, const char **next)
{
    const char *const end = (const char *)r->source->end;
    r->at = *next;
    r->end = bvxi_find_byte(r->at, end, '\n');
    r->line++;
    if (r->end == end) return 0;
    *next = r->end + 1;
    return 1;
}

/* One line after the first; unknown words are passed, as viewvox does. *done: it was the last one. */
static bvx_status binvox_take_line(binvox_reading *r, int *done)
{
    if (binvox_take_word(r, "dim")) {
        if (r->has_dims) return binvox_fail_line(r, "dim comes twice");
        r->has_dims = 1;
        if (!binvox_take_whole(r, &r->dims[0]) || !binvox_take_whole(r, &r->dims[1]) ||
            !binvox_take_whole(r, &r->dims[2]) || !binvox_line_ends(r))
            return binvox_fail_line(r, "dim wants three whole numbers");
    } else if (binvox_take_word(r, "translate")) {
        if (!binvox_take_double(r, &r->translate[0]) || !binvox_take_double(r, &r->translate[1]) ||
            !binvox_take_double(r, &r->translate[2]) || !binvox_line_ends(r))
            return binvox_fail_line(r, "translate wants three numbers");
    } else if (binvox_take_word(r, "scale")) {
        if (!binvox_take_double(r, &r->scale) || !binvox_line_ends(r))
            return binvox_fail_line(r, "scale wants one number");
    } else if (binvox_take_word(r, "data")) {
        if (!binvox_line_ends(r)) return binvox_fail_line(r, "something follows data");
        *done = 1;
    }
    return BVX_OK;
}

static bvx_status binvox_take_header(binvox_reading *r)
{
    const char *next = (const char *)r->source->begin;
    uint64_t version = 0;
    int done = 0;

    /* The scale may be missing; then a voxel is 1 / d wide. */
    r->scale = 1.0;
    if (!binvox_next_line(r, &next) || !binvox_take_word(r, "#binvox"))
        return bvxi_fail(r->source->ctx, BVX_ERR_FORMAT,
                         "BINVOX: line 1: the file does not begin with #binvox");
    if (!binvox_take_whole(r, &version) || !binvox_line_ends(r))
        return binvox_fail_line(r, "#binvox wants a version");
    if (version < 1 || version > 2)
        return bvxi_fail(r->source->ctx, BVX_ERR_UNSUPPORTED,
                         "BINVOX: line 1: version %u; 1 and 2 can be read", version);
    while (!done) {
        if (!binvox_next_line(r, &next))
            return binvox_fail_line(r, "the file ends before the line that says data");
        BVXI_TRY(binvox_take_line(r, &done));
    }
    r->data = (const uint8_t *)next;
    if (!r->has_dims) return binvox_fail_line(r, "data comes, but no line has said dim");
    return BVX_OK;
}

static bvx_status binvox_make_box(const binvox_reading *r, bvx_lattice *box)
{
    uint64_t longest = 0;
    double spacing[3];
    for (int32_t a = 0; a < 3; a++)
        if (r->dims[a] > longest) longest = r->dims[a];
    /* no side at all gives what the box refuses */
    spacing[0] = spacing[1] = spacing[2] = r->scale / (double)longest;
    return bvxi_file_box(r->source->ctx, "BINVOX", r->translate, spacing, r->dims, box);
}

/* ---- pairs ---- */

/* Go on by voxels; 0 when the pairs end before. */
static int binvox_skip(binvox_mark *mark, const uint8_t *end, uint64_t voxels)
{
    const uint8_t *p = mark->p;

    /* Counted from the beginning of the run at p, so that used needs no case of its own. */
    voxels += mark->used;
    while (end - p >= 2 && voxels >= p[1]) {
        voxels -= p[1];
        p += 2;
    }
    mark->p = p;
    mark->used = voxels;
    return voxels == 0 || end - p >= 2;
}

/* The pairs must be whole and add up to all voxels. */
static bvx_status binvox_check_pairs(const binvox_reading *r)
{
    bvx_context *const ctx = r->source->ctx;
    const uint8_t *const end = r->source->end;
    int fits = 1;
    uint64_t const voxels = bvxi_mul(bvxi_mul(r->dims[0], r->dims[1], &fits), r->dims[2], &fits);
    uint64_t const pairs = (uint64_t)(end - r->data) / 2;
    binvox_mark mark = {NULL, 0};

    mark.p = r->data;

    /* 255 is the longest run: too few pairs are refused before their bytes are walked. */
    if (!fits || voxels > pairs * 255 || !binvox_skip(&mark, end, voxels))
        return bvxi_fail(ctx, BVX_ERR_FORMAT,
                         "BINVOX: byte %u: the runs end before the %u x %u x %u voxels do",
                         (uint64_t)(end - r->source->begin), r->dims[0], r->dims[1], r->dims[2]);
    /* Beyond the last voxel not even an empty pair may follow. */
    if (mark.used != 0 || end != mark.p)
        return bvxi_fail(ctx, BVX_ERR_FORMAT, "BINVOX: byte %u: more runs than the %u x %u x %u voxels take",
                         (uint64_t)(mark.p - r->source->begin), r->dims[0], r->dims[1], r->dims[2]);
    return BVX_OK;
}

/* Where each task's first layer begins. */
static void binvox_find_marks(binvox_reading *r)
{
    uint64_t const layer = r->dims[1] * r->dims[2];
    binvox_mark mark = {NULL, 0};
    uint64_t x = 0;

    mark.p = r->data;
    for (int32_t task = 0; task < r->tasks; task++) {
        /* Tasks take columns of 64 voxels along x, so that each writes its own words. */
        uint64_t column, end;
        bvxi_piece((uint64_t)r->grid->words_per_row, r->tasks, task, &column, &end);
        binvox_skip(&mark, r->source->end, ((uint64_t)r->part.low[0] + column * 64 - x) * layer);
        x = (uint64_t)r->part.low[0] + column * 64;
        r->mark[task] = mark;
    }
}

/* ---- layers ---- */

/* Voxels [y, end) of row z of a layer are set. */
static inline void binvox_set_run(const binvox_reading *r, uint64_t *layer, uint64_t y, uint64_t end,
                                  uint64_t z)
{
    int64_t const row = (int64_t)z - r->part.low[2];
    int64_t begin = (int64_t)y - r->part.low[1], stop = (int64_t)end - r->part.low[1];
    if (row < 0 || row >= r->part.size[2]) return;
    if (begin < 0) begin = 0;
    if (stop > r->part.size[1]) stop = r->part.size[1];
    if (begin < stop)
        bvxi_set_run(layer + row * bvxi_row_words(r->part.size[1]), (int32_t)begin, (int32_t)stop);
}

/* Decode one layer of x; its words are zero. */
static void binvox_decode_layer(const binvox_reading *r, binvox_mark *mark, uint64_t *layer)
{
    uint64_t const ny = r->dims[1];
    uint64_t left = ny * r->dims[2], y = 0, z = 0;
    const uint8_t *p = mark->p;
    uint64_t used = mark->used;

    while (left > 0) {
        /* A run may cross layers: what is left of it stays in used for the next one. */
        uint64_t run = p[1] - used;
        int const set = p[0] != 0;
        if (run > left) {
            run = left;
            used += run;
        } else {
            p += 2;
            used = 0;
        }
        left -= run;
        while (run > 0) { /* row by row */
            uint64_t const n = run < ny - y ? run : ny - y;
            if (set) binvox_set_run(r, layer, y, y + n, z);
            run -= n;
            y += n;
            if (y == ny) {
                y = 0;
                z++;
            }
        }
    }
    mark->p = p;
    mark->used = used;
}

/* count layers become column number column of the grid's words. */
static void binvox_turn_back(const binvox_reading *r, const uint64_t *layers, int32_t count, int32_t column)
{
    bvx_grid *const g = r->grid;
    int32_t const row_words = bvxi_row_words(g->size[1]);
    uint64_t block[64];

    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t k = 0; k < row_words; k++) {
            const uint64_t *const from = layers + (uint64_t)z * (uint64_t)row_words + (uint64_t)k;
            uint64_t *to = g->words +
                           ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)k * 64) *
                               (uint64_t)g->words_per_row +
                           (uint64_t)column;
            int32_t const rows = g->size[1] - k * 64 < 64 ? g->size[1] - k * 64 : 64;
            uint64_t any = 0;
            /* Layers beyond the count are 0, and so are the bits past the row's end. */
            for (int32_t i = 0; i < 64; i++) {
                block[i] = i < count ? from[(uint64_t)i * r->layer_words] : 0;
                any |= block[i];
            }
            /* Empty blocks are frequent: the grid is 0 already. */
            if (any == 0) continue;
            bvxi_transpose_64(block);
            for (int32_t i = 0; i < rows; i++) to[(uint64_t)i * (uint64_t)g->words_per_row] = block[i];
        }
}

static void binvox_layers_task(void *user, int32_t task, int32_t worker)
{
    const binvox_reading *const r = user;
    /* Each worker has a buffer; with a buffer for each task, the task's number serves as well. */
    uint64_t *const layers = r->layers + (uint64_t)(r->tasks == r->buffers ? task : worker) * r->worker_words;
    binvox_mark mark = r->mark[task];
    uint64_t column, end;

    bvxi_piece((uint64_t)r->grid->words_per_row, r->tasks, task, &column, &end);
    for (; column < end; column++) {
        int32_t const left = r->grid->size[0] - (int32_t)column * 64, count = left < 64 ? left : 64;
        memset(layers, 0, (size_t)((uint64_t)count * r->layer_words * 8));
        for (int32_t i = 0; i < count; i++)
            binvox_decode_layer(r, &mark, layers + (uint64_t)i * r->layer_words);
        binvox_turn_back(r, layers, count, (int32_t)column);
    }
}

static bvx_status binvox_fill(binvox_reading *r)
{
    bvx_context *const ctx = r->source->ctx;
    const bvx_grid *const g = r->grid;
    uint64_t size;
    int fits = 1;

    /* The buffers follow the threads, so memory does not grow with the file. */
    r->tasks = g->words_per_row < BINVOX_MAX_TASKS ? g->words_per_row : BINVOX_MAX_TASKS;
    r->buffers = bvxi_threads(ctx) < r->tasks ? bvxi_threads(ctx) : r->tasks;
    r->layer_words = (uint64_t)g->size[2] * (uint64_t)bvxi_row_words(g->size[1]);
    r->worker_words = bvxi_mul(r->layer_words, (uint64_t)(g->size[0] < 64 ? g->size[0] : 64), &fits);
    size = bvxi_mul(bvxi_mul(r->worker_words, (uint64_t)r->buffers, &fits), 8, &fits);
    if (!fits) size = UINT64_MAX; /* refused by the allocation */
    binvox_find_marks(r);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size, "layers along y", &r->layers));
    BVXI_TRY(bvxi_parallel(ctx, "read", 0.0, 1.0, r->tasks, binvox_layers_task, r));
    bvxi_drop(ctx, r->layers);
    return BVX_OK;
}

bvx_status bvxi_read_binvox(const bvxi_grid_source *source, bvx_grid *grid)
{
    binvox_reading r;
    bvx_lattice box;
    bvx_window whole;

    memset(&r, 0, sizeof r);
    r.source = source;
    BVXI_TRY(binvox_take_header(&r));
    BVXI_TRY(binvox_make_box(&r, &box));
    BVXI_TRY(binvox_check_pairs(&r));
    memset(whole.low, 0, sizeof whole.low);
    memcpy(whole.size, box.dims, sizeof whole.size);
    BVXI_TRY(bvxi_open_file_grid(source, "BINVOX", &box, &whole, &r.part, grid));
    r.grid = grid;
    return binvox_fill(&r);
}
