/* dense_file.c - what formats with a number for each voxel share: the lattice that a file says it has,
 * samples of any type to bits, bits to bytes.
 *
 * Guarantee: a file's size is held against its header before a grid is made, so a small file cannot request
 * a large one. */
#include "io_grid/grid_formats.h"

bvx_status bvxi_take_grid_file(bvx_context *ctx, const char *function, const void *bytes, uint64_t size,
                               int32_t format, bvxi_grid_source *source)
{
    static const char *const names[] = {
        [BVX_FORMAT_BINVOX] = "BINVOX", [BVX_FORMAT_VOX] = "VOX", [BVX_FORMAT_NPY] = "NPY",
        [BVX_FORMAT_NRRD] = "NRRD",     [BVX_FORMAT_VTI] = "VTI", [BVX_FORMAT_BVX] = "BVX",
        [BVX_FORMAT_RAW] = "RAW"};
    BVXI_TRY(bvxi_check_bytes(ctx, function, bytes, size));
    memset(source, 0, sizeof *source);
    source->ctx = ctx;
    source->begin = bytes;
    source->end = source->begin + (size_t)size;
    if (format >= 0 && format < (int32_t)(sizeof names / sizeof names[0])) source->format = names[format];
    return BVX_OK;
}

bvx_status bvxi_file_box(const bvxi_grid_source *source, const double origin[3], const double spacing[3],
                         const uint64_t dims[3], bvx_lattice *box)
{
    bvx_lattice made = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, BVXI_MIN_FRACTION};
    int32_t longest = 1;

    for (int a = 0; a < 3; a++) {
        if (dims[a] == 0)
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "the file has no voxels along %s",
                                  bvxi_axis_name[a]);
        if (dims[a] > BVXI_MAX_SIDE)
            return BVXI_FILE_FAIL_FOR(source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                      "the file has %u voxels along %s; 1 to %d are possible", dims[a],
                                      bvxi_axis_name[a], (int64_t)BVXI_MAX_SIDE);
        /* x - x is 0 for every finite number, and NaN for the others. */
        if (!(origin[a] - origin[a] == 0.0))
            return BVXI_FILE_FAIL_FOR(source, BVX_ERR_FORMAT, BVX_REASON_NOT_FINITE,
                                      "the origin is not finite along %s", bvxi_axis_name[a]);
        if (!(spacing[a] - spacing[a] == 0.0) || !(spacing[a] > 0.0))
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                                  "the spacing along %s is %g; it must be above 0 and finite",
                                  bvxi_axis_name[a], spacing[a]);
        made.origin[a] = origin[a];
        made.spacing[a] = spacing[a];
        made.dims[a] = (int32_t)dims[a];
        if (made.dims[a] > longest) longest = made.dims[a];
    }

    /* The most fraction bits that a box of this size leaves: files have none of their own. */
    made.fraction_bits = bvxi_fraction_bits(longest);
    *box = made;
    return BVX_OK;
}

/* What is wanted of a file, counted from its first voxel; NULL or all zero stands for all of it. */
static bvx_status take_file_part(const bvxi_grid_source *source, const int32_t size[3], bvx_window *part)
{
    static const bvx_window none = {{0, 0, 0}, {0, 0, 0}};
    const bvx_window *const w = source->window;

    memset(part, 0, sizeof *part);
    if (w == NULL || memcmp(w, &none, sizeof none) == 0) {
        memcpy(part->size, size, sizeof part->size);
        return BVX_OK;
    }

    /* Written as low > size - wanted, as low + wanted might overflow. */
    for (int a = 0; a < 3; a++)
        if (w->low[a] < 0 || w->size[a] < 1 || w->low[a] > size[a] - w->size[a])
            return BVXI_FILE_FAIL_FOR(source, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                      "the window's voxels %d to %d along %s are not inside the file's %d",
                                      (int64_t)w->low[a], (int64_t)w->low[a] + w->size[a] - 1,
                                      bvxi_axis_name[a], (int64_t)size[a]);
    *part = *w;
    return BVX_OK;
}

bvx_status bvxi_open_file_grid(const bvxi_grid_source *source, const bvx_lattice *lattice,
                               const bvx_window *file_window, bvx_window *part, bvx_grid *grid)
{
    bvx_window whole, wanted;

    BVXI_TRY(bvxi_lattice_check(source->ctx, source->format, lattice));
    BVXI_TRY(bvxi_window_take(source->ctx, source->format, lattice, file_window, &whole));
    BVXI_TRY(take_file_part(source, whole.size, part));
    for (int a = 0; a < 3; a++) {
        wanted.low[a] = whole.low[a] + part->low[a];
        wanted.size[a] = part->size[a];
    }
    bvxi_grid_renew(source->ctx, lattice, &wanted, grid);
    BVXI_TRY(bvxi_grid_open(source->ctx, "bvx_read_grid", lattice, &wanted, grid));
    /* Readers only set bits, so what they pass over must be 0. */
    memset(grid->words, 0, (size_t)bvxi_grid_words(grid) * 8);
    return BVX_OK;
}

void bvxi_set_file_run(bvx_grid *grid, const bvx_window *part, int64_t x, int64_t end, int64_t y, int64_t z)
{
    int64_t const j = y - part->low[1], k = z - part->low[2];
    int64_t const first = x - part->low[0] < 0 ? 0 : x - part->low[0];
    int64_t const stop = end - part->low[0] > part->size[0] ? part->size[0] : end - part->low[0];
    if (j < 0 || j >= part->size[1] || k < 0 || k >= part->size[2] || first >= stop) return;
    bvxi_set_run(bvxi_grid_row(grid, (int32_t)j, (int32_t)k), (int32_t)first, (int32_t)stop);
}

enum { TEXT_ASK_BYTES = 1 << 20 };

bvx_status bvxi_fail_short_array(const bvxi_source *source, const char *array, uint64_t size, const char *at)
{
    return BVXI_LINE_FAIL(source, array, BVX_ERR_FORMAT, "the array's %u bytes are not all there (byte %u)",
                          size, bvxi_source_byte(source, at));
}

bvx_status bvxi_unpack_dense(const bvxi_grid_source *source, const bvxi_dense *d, uint8_t *bytes)
{
    const bvx_read_volume_options *const o = source->volume;
    bvxi_base64 b = d->base64;

    if (d->encoding == BVXI_DENSE_GZIP) {
        if (o->inflate(o->inflate_user, d->begin, (uint64_t)(d->end - d->begin), bytes, d->size) == 0)
            return BVX_OK;
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "the packed samples are damaged or do not make %u bytes", d->size);
    }
    if (d->encoding == BVXI_DENSE_BLOCKS) return bvxi_unpack_blocks(source, d, bytes);
    if (!bvxi_base64_take(&b, bytes, d->size))
        return bvxi_fail_short_array(&d->source, d->array, d->size, b.p);
    /* An array in a tag must end where its text does; appended data goes on with other arrays. */
    if (d->behind != NULL && (b.held_count != 0 || bvxi_skip_space(b.p, b.end) != b.end))
        return bvxi_fail_expected(&d->source, b.p, d->behind);
    return BVX_OK;
}

/* x fastest, one for each voxel of the file; white space is between them. */
static bvx_status read_text_grid(const bvxi_grid_source *source, const bvxi_dense *d, const bvx_window *part,
                                 bvx_grid *grid)
{
    const int32_t *const n = d->box.dims;
    const char *p = d->begin, *ask = d->begin;
    uint64_t done = 0;

    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                double v;
                /* Progress follows the bytes, not the samples: their number is what the file says only. */
                if (p >= ask) {
                    double const all = (double)(d->end - d->begin);
                    BVXI_TRY(
                        bvxi_progress(source->ctx, "read", all > 0.0 ? (double)(p - d->begin) / all : 0.0));
                    ask = d->end - p > TEXT_ASK_BYTES ? p + TEXT_ASK_BYTES : d->end;
                }
                /* Samples outside the part are parsed too: else the next one's begin is unknown. */
                BVXI_TRY(bvxi_take_sample(&d->source, n, done++, &p, &v));
                if (v != 0.0) bvxi_set_file_run(grid, part, x, (int64_t)x + 1, y, z); /* NaN is not 0 */
            }
    p = bvxi_skip_space(p, d->end);
    return p == d->end ? BVX_OK : bvxi_fail_expected(&d->source, p, d->behind);
}

bvx_status bvxi_read_dense_grid(const bvxi_grid_source *source, const bvxi_dense *dense, bvx_grid *grid)
{
    bvxi_samples samples = dense->samples;
    uint8_t *bytes = NULL;
    bvx_window part;

    if (dense->encoding == BVXI_DENSE_RAW || dense->encoding == BVXI_DENSE_TEXT) {
        BVXI_TRY(bvxi_open_file_grid(source, &dense->box, NULL, &part, grid));
        return dense->encoding == BVXI_DENSE_TEXT ? read_text_grid(source, dense, &part, grid)
                                                  : bvxi_pack_samples(source->ctx, &samples, &part, grid);
    }

    /* Packed ones are unpacked whole first: a part of them cannot be found before. */
    BVXI_TRY(bvxi_alloc(source->ctx, BVXI_SCRATCH, dense->size, "the unpacked samples", &bytes));
    samples.first = bytes;
    BVXI_TRY(bvxi_unpack_dense(source, dense, bytes));
    BVXI_TRY(bvxi_open_file_grid(source, &dense->box, NULL, &part, grid));
    return bvxi_pack_samples(source->ctx, &samples, &part, grid);
}

bvx_status bvxi_check_written_corner(bvx_context *ctx, const char *format, const bvx_grid *grid)
{
    double corner[3];
    bvxi_grid_corner(grid, corner);
    for (int a = 0; a < 3; a++) {
        /* Both are checked: formats keep the corner, the centre, or both. */
        double const centre = corner[a] + 0.5 * grid->lattice.spacing[a];
        if (!(corner[a] - corner[a] == 0.0) || !(centre - centre == 0.0))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: the window's first voxel has no finite place along %s", format,
                                 bvxi_axis_name[a]);
    }
    return BVX_OK;
}
