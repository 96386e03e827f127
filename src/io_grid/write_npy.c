/* write_npy.c - a grid to NumPy's .npy: one byte a voxel, axes [x,y,z].
 *
 * Source: numpy.lib.format, version 1.0. Fortran order says that x runs fastest, as it does in the grid. */
#include "io_grid/grid_formats.h"

enum { NPY_PREFIX = 10, NPY_ALIGN = 64 };

static void npy_put_dict(const bvx_grid *grid, bvxi_output *out)
{
    bvxi_output_text(out, "{'descr': '|b1', 'fortran_order': True, 'shape': (");
    for (int a = 0; a < 3; a++) {
        if (a > 0) bvxi_output_text(out, ", ");
        bvxi_output_number(out, (uint64_t)grid->size[a]);
    }
    bvxi_output_text(out, "), }");
}

/* The dictionary with its prefix, padded so that the data is aligned and a newline stands before it. */
static void npy_put_head(const bvx_grid *grid, bvxi_output *out)
{
    static const uint8_t magic[8] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    bvxi_output dict = {0};
    uint8_t length[2];

    /* The dictionary is measured first, as its length stands before it. */
    npy_put_dict(grid, &dict);
    uint64_t const size = (NPY_PREFIX + dict.size + 1 + NPY_ALIGN - 1) / NPY_ALIGN * NPY_ALIGN;
    bvxi_store_u16(length, (uint16_t)(size - NPY_PREFIX));
    bvxi_output_add(out, magic, sizeof magic);
    bvxi_output_add(out, length, sizeof length);
    npy_put_dict(grid, out);
    while (out->size < size - 1) bvxi_output_text(out, " ");
    bvxi_output_text(out, "\n");
}

bvx_status bvxi_write_npy(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    static const bvxi_dense_file npy = {"the NPY file", npy_put_head, ""};
    return bvxi_write_dense(ctx, grid, &npy, file);
}
