/* file_grid.c - the lattice that a file of voxels says it has, and the grid for the part of it that is
 * wanted. */
#include "io_grid/grid_formats.h"

bvx_status bvxi_file_box(bvx_context *ctx, const char *format, const double origin[3],
                         const double spacing[3], const uint64_t dims[3], bvx_lattice *box)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    bvx_lattice made = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, BVXI_MIN_FRACTION};
    int32_t longest = 1;

    for (int a = 0; a < 3; a++) {
        if (dims[a] == 0)
            return bvxi_fail(ctx, BVX_ERR_FORMAT, "%s: the file has no voxels along %s", format,
                             axis_name[a]);
        if (dims[a] > BVXI_MAX_SIDE)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the file has %u voxels along %s; 1 to %d are possible", format, dims[a],
                                 axis_name[a], (int64_t)BVXI_MAX_SIDE);
        /* x - x is 0 for every finite number, and NaN for the others. */
        if (!(origin[a] - origin[a] == 0.0))
            return bvxi_fail_for(ctx, BVX_ERR_FORMAT, BVX_REASON_NOT_FINITE,
                                 "%s: the origin is not finite along %s", format, axis_name[a]);
        if (!(spacing[a] - spacing[a] == 0.0) || !(spacing[a] > 0.0))
            return bvxi_fail(ctx, BVX_ERR_FORMAT,
                             "%s: the spacing along %s is %g; it must be above 0 and finite", format,
                             axis_name[a], spacing[a]);
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
static bvx_status take_file_part(const bvxi_grid_source *source, const char *format, const int32_t size[3],
                                 bvx_window *part)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
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
            return bvxi_fail_for(source->ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                 "%s: the window's voxels %d to %d along %s are not inside the file's %d",
                                 format, (int64_t)w->low[a], (int64_t)w->low[a] + w->size[a] - 1,
                                 axis_name[a], (int64_t)size[a]);
    *part = *w;
    return BVX_OK;
}

bvx_status bvxi_open_file_grid(const bvxi_grid_source *source, const char *format, const bvx_lattice *lattice,
                               const bvx_window *file_window, bvx_window *part, bvx_grid *grid)
{
    bvx_window whole, wanted;

    /* The lattice and the file's own window are what the
     * file says; only the part of it comes from the caller. */
    BVXI_TRY(bvxi_lattice_check(source->ctx, format, lattice));
    BVXI_TRY(bvxi_window_take(source->ctx, format, lattice, file_window, &whole));
    BVXI_TRY(take_file_part(source, format, whole.size, part));
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
    bvxi_set_run(grid->words + ((size_t)k * (size_t)grid->size[1] + (size_t)j) * (size_t)grid->words_per_row,
                 (int32_t)first, (int32_t)stop);
}
