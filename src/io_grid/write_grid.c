/* write_grid.c - a grid to the bytes of a file: the checks around the
 * writers, and what those of one byte a voxel share. */
#include "io/formats.h"
#include "io_grid/grid_formats.h"

static bvx_status run_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_grid";

    if (context == NULL) return BVX_ERR_ARGUMENT;
    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    /* Each writer checks what its format cannot hold. */
    switch (format) {
    case BVX_FORMAT_NPY: return bvxi_write_npy(context, grid, file);
    case BVX_FORMAT_BINVOX: return bvxi_write_binvox(context, grid, file);
    case BVX_FORMAT_VOX: return bvxi_write_vox(context, grid, file);
    case BVX_FORMAT_NRRD: return bvxi_write_nrrd(context, grid, file);
    case BVX_FORMAT_VTI: return bvxi_write_vti(context, grid, file);
    case BVX_FORMAT_BVX: return bvxi_write_bvx(context, grid, file);
    default:
        return bvxi_fail_format(context, BVX_ERR_UNSUPPORTED, function, "grid", format, BVX_GRIDS_WRITTEN);
    }
}

bvx_status bvx_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_grid(context, grid, format, file));
}
