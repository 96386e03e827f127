/* read_dense.c - samples of a file, however it holds them, to a grid: every number other than 0 is a
 * voxel. */
#include "io_grid/grid_formats.h"

enum { TEXT_ASK_BYTES = 1 << 20 };

bvx_status bvxi_fail_short_array(const bvxi_source *source, const char *array, uint64_t size, const char *at)
{
    return bvxi_fail(source->ctx, BVX_ERR_FORMAT,
                     "%s: line %u: the array's %u bytes are not all there (byte %u)", source->format,
                     bvxi_source_line(source, array), size, bvxi_source_byte(source, at));
}

bvx_status bvxi_unpack_dense(const bvxi_grid_source *source, const bvxi_dense *d, uint8_t *bytes)
{
    const bvx_read_volume_options *const o = source->volume;
    bvxi_base64 b = d->base64;

    /* The unpacker is the caller's, as the library brings none. */
    if (d->encoding == BVXI_DENSE_GZIP) {
        if (o->inflate(o->inflate_user, d->begin, (uint64_t)(d->end - d->begin), bytes, d->size) == 0)
            return BVX_OK;
        return bvxi_fail(source->ctx, BVX_ERR_FORMAT,
                         "%s: the packed samples are damaged or do not make %u bytes", d->format, d->size);
    }
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
                /* Each sample is parsed, also outside the part:
                 * where the next one begins is not known otherwise. */
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
    bvx_status status = BVX_OK;

    /* Raw samples and text are read where they stand, straight into the grid. */
    if (dense->encoding == BVXI_DENSE_RAW || dense->encoding == BVXI_DENSE_TEXT) {
        BVXI_TRY(bvxi_open_file_grid(source, dense->format, &dense->box, NULL, &part, grid));
        return dense->encoding == BVXI_DENSE_TEXT ? read_text_grid(source, dense, &part, grid)
                                                  : bvxi_pack_samples(source->ctx, &samples, &part, grid);
    }

    /* Packed ones are unpacked whole first: a part of them cannot be found before. */
    BVXI_TRY(bvxi_alloc(source->ctx, BVXI_SCRATCH, dense->size, "the unpacked samples", &bytes));
    samples.first = bytes;
    status = bvxi_unpack_dense(source, dense, bytes);
    if (status == BVX_OK) status = bvxi_open_file_grid(source, dense->format, &dense->box, NULL, &part, grid);
    if (status == BVX_OK) status = bvxi_pack_samples(source->ctx, &samples, &part, grid);
    bvxi_drop(source->ctx, bytes);
    return status;
}
