/* grid_file.c - grids from and to the bytes of files: bvx_read_grid and bvx_write_grid. Arguments are
 * checked here, then the format's own reader or writer runs. */
#include "io_grid/grid_formats.h"

static bvx_status read_grid_as(const bvxi_grid_source *source, int32_t format, bvx_grid *grid)
{
    bvxi_dense dense = {0};

    switch (format) {
    case BVX_FORMAT_NPY: BVXI_TRY(bvxi_find_npy(source, &dense)); break;
    case BVX_FORMAT_NRRD: BVXI_TRY(bvxi_find_nrrd(source, &dense)); break;
    case BVX_FORMAT_VTI: BVXI_TRY(bvxi_find_vti(source, &dense)); break;
    case BVX_FORMAT_BINVOX: return bvxi_read_binvox(source, grid);
    case BVX_FORMAT_VOX: return bvxi_read_vox(source, grid, NULL, NULL);
    case BVX_FORMAT_BVX: return bvxi_read_bvx(source, grid);
    default:
        return bvxi_fail_format(source->ctx, BVX_ERR_ARGUMENT, "bvx_read_grid", "grid", format,
                                BVX_GRIDS_READ);
    }
    return bvxi_read_dense_grid(source, &dense, grid);
}

static bvx_status run_read_grid(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                const bvx_window *window, bvx_grid *grid)
{
    static const char *const function = "bvx_read_grid";
    bvxi_grid_source source;

    if (grid == NULL) return bvxi_fail_null(context, function, "grid");
    BVXI_TRY(bvxi_take_grid_file(context, function, bytes, size, format, &source));
    if (size == 0) return bvxi_fail(context, BVX_ERR_FORMAT, "%s: the file has no bytes", function);
    source.window = window;
    bvx_grid made = *grid; /* brings the caller's words along */
    bvx_status const status = read_grid_as(&source, format, &made);
    /* The words may have been freed and made anew: the caller's grid must name those that exist. */
    if (status != BVX_OK) {
        if (grid->owned == 1) *grid = made; /* its words, or others in their stead */
        else if (made.words != grid->words) bvx_grid_free(context, &made);
        return status;
    }
    *grid = made;
    return BVX_OK;
}

bvx_status bvx_read_grid(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                         const bvx_window *window, bvx_grid *grid)
{
    return BVXI_CALL(context, run_read_grid(context, bytes, size, format, window, grid));
}

static bvx_status run_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_grid";
    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    switch (format) {
    case BVX_FORMAT_BINVOX: return bvxi_write_binvox(context, grid, file);
    case BVX_FORMAT_VOX: return bvxi_write_vox(context, grid, NULL, NULL, file);
    case BVX_FORMAT_NPY:
    case BVX_FORMAT_NRRD:
    case BVX_FORMAT_VTI: return bvxi_write_dense(context, grid, format, file);
    case BVX_FORMAT_BVX: return bvxi_write_bvx(context, grid, file);
    case BVX_FORMAT_VDB: return bvxi_write_vdb(context, grid, NULL, file);
    case BVX_FORMAT_NVDB: return bvxi_write_nvdb(context, grid, NULL, file);
    default:
        return bvxi_fail_format(context, BVX_ERR_UNSUPPORTED, function, "grid", format, BVX_GRIDS_WRITTEN);
    }
}

bvx_status bvx_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_grid(context, grid, format, file));
}

/* ---- with labels ---- */

static bvx_status run_read_labels(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                  bvx_buffer *labels, uint8_t *palette)
{
    static const char *const function = "bvx_read_labels";
    bvxi_grid_source source;
    bvx_grid grid = {0};

    BVXI_TRY(bvxi_renew_buffer(context, function, labels));
    if (palette == NULL) return bvxi_fail_null(context, function, "palette");
    BVXI_TRY(bvxi_take_grid_file(context, function, bytes, size, format, &source));
    if (size == 0) return bvxi_fail(context, BVX_ERR_FORMAT, "%s: the file has no bytes", function);
    if (format != BVX_FORMAT_VOX)
        return bvxi_fail_format(context, BVX_ERR_UNSUPPORTED, function, "grid", format, 1 << BVX_FORMAT_VOX);
    bvx_status const status = bvxi_read_vox(&source, &grid, labels, palette);
    bvx_grid_free(context, &grid);
    if (status != BVX_OK) bvx_buffer_free(context, labels);
    return status;
}

bvx_status bvx_read_labels(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                           bvx_buffer *labels, uint8_t *palette)
{
    return BVXI_CALL(context, run_read_labels(context, bytes, size, format, labels, palette));
}

static bvx_status run_write_labels(bvx_context *context, const bvx_grid *grid, const uint8_t *labels,
                                   const uint8_t *palette, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_labels";
    int32_t const set = 1 << BVX_FORMAT_VOX | 1 << BVX_FORMAT_NRRD;

    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    if (labels == NULL || palette == NULL)
        return bvxi_fail_null(context, function, labels == NULL ? "labels" : "palette");
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++) {
            const uint8_t *const row = labels + ((uint64_t)z * (uint64_t)grid->size[1] + (uint64_t)y) *
                                                    (uint64_t)grid->size[0];
            for (int32_t x = 0; x < grid->size[0]; x++)
                if ((row[x] != 0) != bvx_grid_get(grid, x, y, z))
                    return bvxi_fail(
                        context, BVX_ERR_ARGUMENT,
                        "%s: voxel %d,%d,%d has label %d; labels of set voxels are 1 to 255, others 0",
                        function, (int64_t)x, (int64_t)y, (int64_t)z, (int64_t)row[x]);
        }
    if (format == BVX_FORMAT_VOX) return bvxi_write_vox(context, grid, labels, palette, file);
    if (format == BVX_FORMAT_NRRD) return bvxi_write_segments(context, grid, labels, palette, file);
    return bvxi_fail_format(context, BVX_ERR_UNSUPPORTED, function, "grid", format, set);
}

bvx_status bvx_write_labels(bvx_context *context, const bvx_grid *grid, const uint8_t *labels,
                            const uint8_t *palette, int32_t format, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_labels(context, grid, labels, palette, format, file));
}
