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
 * 64 layers of x at a time are decoded to rows along y, and turned to a column of words of the grid. */
#include "io_grid/grid_formats.h"

typedef struct binvox_reading {
    const bvxi_grid_source *source;
    const char *at, *end; /* the header's line that is read */
    uint64_t line;
    uint64_t dims[3];
    double translate[3], scale;
    int has_dims;
    const uint8_t *data;
} binvox_reading;

/* ---- header ---- */

static bvx_status binvox_fail_line(const binvox_reading *r, const char *what)
{
    return BVXI_FILE_FAIL(r->source, BVX_ERR_FORMAT, "line %u: %s", r->line, what);
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

static bvx_status binvox_take_header(binvox_reading *r)
{
    const char *next = (const char *)r->source->begin;
    uint64_t version = 0;
    int done = 0;

    /* The scale may be missing; then a voxel is 1 / d wide. */
    r->scale = 1.0;
    if (!binvox_next_line(r, &next) || !binvox_take_word(r, "#binvox"))
        return BVXI_FILE_FAIL(r->source, BVX_ERR_FORMAT, "line 1: the file does not begin with #binvox");
    if (!binvox_take_whole(r, &version) || !binvox_line_ends(r))
        return binvox_fail_line(r, "#binvox wants a version");
    if (version < 1 || version > 2)
        return BVXI_FILE_FAIL(r->source, BVX_ERR_UNSUPPORTED, "line 1: version %u; 1 and 2 can be read",
                              version);
    while (!done) {
        if (!binvox_next_line(r, &next))
            return binvox_fail_line(r, "the file ends before the line that says data");

        /* A line after the first; unknown words are passed, as viewvox does. */
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
            done = 1;
        }
    }
    r->data = (const uint8_t *)next;
    if (!r->has_dims) return binvox_fail_line(r, "data comes, but no line has said dim");
    return BVX_OK;
}

/* ---- pairs ---- */

/* Where decoding stands: used voxels of the run at p are done. */
typedef struct binvox_cursor {
    const uint8_t *p;
    uint64_t used;
} binvox_cursor;

/* The next so many voxels, which begin a layer: y runs fastest, then z, then x; part in this order. */
static void binvox_decode(const binvox_reading *r, uint64_t voxels, const bvx_window *part, bvx_grid *turned,
                          binvox_cursor *place)
{
    uint64_t x = 0, y = 0, z = 0;

    for (uint64_t n; voxels > 0; voxels -= n) {
        uint64_t const run = place->p[1] - place->used;
        n = run < r->dims[1] - y ? run : r->dims[1] - y; /* row by row */
        if (place->p[0] != 0 && turned != NULL)
            bvxi_set_file_run(turned, part, (int64_t)y, (int64_t)(y + n), (int64_t)z, (int64_t)x);
        place->used += n;
        if (n == run) {
            place->p += 2;
            place->used = 0;
        }
        y += n;
        if (y < r->dims[1]) continue;
        y = 0;
        if (++z < r->dims[2]) continue;
        z = 0;
        x++;
    }
}

static bvx_status binvox_fill(const binvox_reading *r, const bvx_window *part, bvx_grid *turned,
                              bvx_grid *layers, bvx_grid *grid)
{
    static const int32_t back[3] = {2, 0, 1};
    bvx_context *const ctx = r->source->ctx;
    int32_t const deep = grid->size[0] < 64 ? grid->size[0] : 64;
    bvx_lattice const box = {{0, 0, 0}, {1, 1, 1}, {grid->size[1], grid->size[2], deep}, BVXI_MIN_FRACTION};
    uint64_t const layer = r->dims[1] * r->dims[2];
    double const columns = (double)grid->words_per_row;
    binvox_cursor place = {r->data, 0};

    BVXI_TRY(bvx_grid_create(ctx, &box, NULL, turned));
    binvox_decode(r, (uint64_t)part->low[0] * layer, NULL, NULL, &place);
    for (int32_t c = 0; c < grid->words_per_row; c++) {
        int32_t const left = grid->size[0] - 64 * c;
        bvx_window const wanted = {{part->low[1], part->low[2], 0}, {part->size[1], part->size[2], deep}};
        memset(turned->words, 0, (size_t)bvxi_grid_words(turned) * 8);
        binvox_decode(r, (uint64_t)(left < 64 ? left : 64) * layer, &wanted, turned, &place);
        BVXI_TRY(BVXI_SHARE(ctx, c / columns, (c + 1) / columns,
                            bvx_grid_permute(ctx, turned, back, NULL, layers)));
        for (uint64_t row = 0; row < bvxi_grid_rows(grid); row++)
            grid->words[row * (uint64_t)grid->words_per_row + (uint64_t)c] = layers->words[row];
    }
    return BVX_OK;
}

bvx_status bvxi_read_binvox(const bvxi_grid_source *source, bvx_grid *grid)
{
    bvx_lattice box;
    bvx_window part;
    bvx_grid turned = {0}, layers = {0};

    binvox_reading r = {.source = source};
    BVXI_TRY(binvox_take_header(&r));

    uint64_t longest = 0;
    double spacing[3];
    for (int32_t a = 0; a < 3; a++)
        if (r.dims[a] > longest) longest = r.dims[a];
    /* no side at all gives what the box refuses */
    spacing[0] = spacing[1] = spacing[2] = r.scale / (double)longest;
    BVXI_TRY(bvxi_file_box(r.source, r.translate, spacing, r.dims, &box));

    bvx_context *const ctx = source->ctx;
    const uint8_t *const end = source->end;
    int fits = 1;
    uint64_t const voxels = bvxi_mul(bvxi_mul(r.dims[0], r.dims[1], &fits), r.dims[2], &fits);
    uint64_t const pairs = (uint64_t)(end - r.data) / 2;
    uint64_t left = voxels;
    const uint8_t *p = r.data;

    /* 255 is the longest run: too few pairs are refused before their bytes are walked. */
    if (fits && voxels <= pairs * 255)
        for (; end - p >= 2 && left >= p[1]; p += 2) left -= p[1];
    else left = UINT64_MAX;
    if (left != 0 && end - p < 2)
        return bvxi_fail(ctx, BVX_ERR_FORMAT,
                         "BINVOX: byte %u: the runs end before the %u x %u x %u voxels do",
                         (uint64_t)(end - source->begin), r.dims[0], r.dims[1], r.dims[2]);
    /* Beyond the last voxel not even an empty pair may follow. */
    if (left != 0 || end != p)
        return bvxi_fail(ctx, BVX_ERR_FORMAT, "BINVOX: byte %u: more runs than the %u x %u x %u voxels take",
                         (uint64_t)(p - source->begin), r.dims[0], r.dims[1], r.dims[2]);
    BVXI_TRY(bvxi_open_file_grid(source, &box, NULL, &part, grid));
    bvx_status const status = binvox_fill(&r, &part, &turned, &layers, grid);
    bvx_grid_free(source->ctx, &layers);
    bvx_grid_free(source->ctx, &turned);
    return status;
}
