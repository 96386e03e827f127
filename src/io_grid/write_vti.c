/* write_vti.c - a grid to VTK's XML image data: cells of uint8 named "solid", raw after an underscore at the
 * end.
 *
 * Source: VTK File Formats (docs.vtk.org), version 1.0 with 64-bit counts. Cells are voxels, so Origin is the
 * low corner and the extent counts the points around them. */
#include "io_grid/grid_formats.h"

static void vti_put_doubles(bvxi_output *out, const double v[3])
{
    char text[32];
    for (int a = 0; a < 3; a++) {
        if (a > 0) bvxi_output_text(out, " ");
        bvxi_output_add(out, text, (size_t)bvxi_print_double(v[a], text));
    }
}

static void vti_put_extent(bvxi_output *out, const bvx_grid *grid)
{
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, a > 0 ? " 0 " : "0 ");
        bvxi_output_number(out, (uint64_t)grid->size[a]);
    }
}

static void vti_put_head(const bvx_grid *grid, bvxi_output *out)
{
    uint64_t const voxels = bvxi_grid_rows(grid) * (uint64_t)grid->size[0];
    uint8_t length[8];
    double corner[3];

    bvxi_grid_corner(grid, corner);
    /* Cells are the voxels, so the extent ends at size, a point beyond the last cell's. */
    bvxi_output_text(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n  <ImageData WholeExtent=\"");
    vti_put_extent(out, grid);
    bvxi_output_text(out, "\" Origin=\"");
    vti_put_doubles(out, corner);
    bvxi_output_text(out, "\" Spacing=\"");
    vti_put_doubles(out, grid->lattice.spacing);
    bvxi_output_text(out, "\">\n    <Piece Extent=\"");
    vti_put_extent(out, grid);
    bvxi_output_text(
        out,
        "\">\n      <PointData>\n      </PointData>\n      <CellData Scalars=\"solid\">\n        <DataArray "
        "type=\"UInt8\" Name=\"solid\" format=\"appended\" offset=\"0\"/>\n      </CellData>\n    </Piece>\n"
        "  </ImageData>\n  <AppendedData encoding=\"raw\">\n    _");

    /* The count of bytes before them, in 64 bits as the head said. */
    bvxi_store_u32(length, (uint32_t)(voxels & 0xffffffffu));
    bvxi_store_u32(length + 4, (uint32_t)(voxels >> 32));
    bvxi_output_add(out, length, sizeof length);
}

bvx_status bvxi_write_vti(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    static const bvxi_dense_file vti = {"the VTI file", vti_put_head, "\n  </AppendedData>\n</VTKFile>\n"};
    BVXI_TRY(bvxi_check_written_corner(ctx, "VTI", grid));
    return bvxi_write_dense(ctx, grid, &vti, file);
}
