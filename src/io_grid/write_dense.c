/* write_dense.c - files of a head, a byte for each voxel and a tail. */
#include "io/formats.h"
#include "io_grid/grid_formats.h"

bvx_status bvxi_write_dense(bvx_context *ctx, const bvx_grid *grid, const bvxi_dense_file *kind,
                            bvx_buffer *file)
{
    uint64_t const tail = bvxi_text_length(kind->tail);
    bvx_buffer made = {0};
    bvxi_output head = {0};
    bvx_status status;
    int fits = 1;

    /* The head is made twice, to learn its length and to write it. */
    kind->put_head(grid, &head);
    uint64_t const voxels = bvxi_mul(bvxi_grid_rows(grid), (uint64_t)grid->size[0], &fits);
    uint64_t const size = bvxi_add(voxels, head.size + tail, &fits);
    if (!fits)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "bvx_write_grid: the grid has 2^64 voxels or more");
    BVXI_TRY(bvxi_make_buffer(ctx, size, kind->what, &made));
    head.bytes = made.bytes;
    head.size = 0;
    kind->put_head(grid, &head);

    /* The voxels lie between head and tail, and nothing else is in the file. */
    memcpy(made.bytes + size - tail, kind->tail, (size_t)tail);
    status = bvxi_unpack_grid(ctx, grid, made.bytes + head.size);
    if (status != BVX_OK) bvx_buffer_free(ctx, &made);
    else *file = made;
    return status;
}

bvx_status bvxi_check_written_corner(bvx_context *ctx, const char *format, const bvx_grid *grid)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    double corner[3];

    bvxi_grid_corner(grid, corner);
    for (int a = 0; a < 3; a++) {
        /* Both are checked: formats keep the corner, the centre, or both. */
        double const centre = corner[a] + 0.5 * grid->lattice.spacing[a];
        if (!(corner[a] - corner[a] == 0.0) || !(centre - centre == 0.0))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: the window's first voxel has no finite place along %s", format,
                                 axis_name[a]);
    }
    return BVX_OK;
}
