/* write_npy.c - a grid to NumPy's .npy: one byte a voxel, axes [x,y,z].
 *
 * Source: numpy.lib.format, version 1.0. Fortran order says that x runs fastest, as it does in the grid. Eight bits
 * become eight bytes by a multiplication: it copies them into every byte, of which each keeps another one. */
#include "io/formats.h"

enum { NPY_PREFIX = 10, NPY_ALIGN = 64 };

static void npy_put_header(const bvx_grid *grid, bvxi_output *out)
{
    bvxi_output_text(out, "{'descr': '|b1', 'fortran_order': True, 'shape': (");
    for (int a = 0; a < 3; a++) {
        if (a > 0) bvxi_output_text(out, ", ");
        bvxi_output_number(out, (uint64_t)grid->size[a]);
    }
    bvxi_output_text(out, "), }");
}

/* Bytes of the header with its prefix, padded so that the data is aligned and a newline stands before it. */
static uint64_t npy_header_size(const bvx_grid *grid)
{
    bvxi_output out = {0};
    npy_put_header(grid, &out);
    return (NPY_PREFIX + out.size + 1 + NPY_ALIGN - 1) / NPY_ALIGN * NPY_ALIGN;
}

/* Eight voxels, the lowest bit first. */
static void npy_put_eight(uint8_t *p, uint64_t bits)
{
    uint64_t const one_each = (bits & 0xff) * UINT64_C(0x0101010101010101) & UINT64_C(0x8040201008040201);
    uint64_t const bytes = (one_each + UINT64_C(0x00406070787c7e7f)) >> 7 & UINT64_C(0x0101010101010101);
    bvxi_store_u32(p, (uint32_t)(bytes & 0xffffffffu));
    bvxi_store_u32(p + 4, (uint32_t)(bytes >> 32));
}

static void npy_put_row(uint8_t *p, const uint64_t *row, int32_t nx)
{
    int32_t x = 0;
    for (; x + 8 <= nx; x += 8) npy_put_eight(p + x, row[x >> 6] >> (x & 63));
    for (; x < nx; x++) p[x] = (uint8_t)(row[x >> 6] >> (x & 63) & 1);
}

static bvx_status npy_check_grid(bvx_context *ctx, const char *function, const bvx_grid *grid)
{
    if (grid->words == NULL) return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: grid.words is NULL", function);
    for (uint64_t a = 0; a < 3; a++)
        if (grid->size[a] < 1)
            return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: grid.size[%u] is %d", function, a, (int64_t)grid->size[a]);
    if (grid->words_per_row != (int32_t)(((int64_t)grid->size[0] + 63) / 64))
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: grid.words_per_row is %d for a row of %d voxels", function,
                         (int64_t)grid->words_per_row, (int64_t)grid->size[0]);
    return BVX_OK;
}

bvx_status bvx_write_grid(bvx_context *context, const bvx_grid *grid, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_grid";
    static const uint8_t magic[8] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0};
    bvx_buffer made = {0};
    bvxi_output out = {0};
    int fits = 1;
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (grid == NULL) return bvxi_fail_null(context, function, "grid");
    if (file == NULL) return bvxi_fail_null(context, function, "file");
    if (file->bytes != NULL)
        return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: file holds bytes already; free or zero it first", function);
    if (format != BVX_FORMAT_NPY)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: format %d holds no grid; take NPY", function,
                         (int64_t)format);
    BVXI_TRY(npy_check_grid(context, function, grid));

    uint64_t const header = npy_header_size(grid);
    uint64_t const rows = (uint64_t)grid->size[1] * (uint64_t)grid->size[2]; /* below 2^62 */
    uint64_t const size = bvxi_add(bvxi_mul(rows, (uint64_t)grid->size[0], &fits), header, &fits);
    if (!fits) return bvxi_fail(context, BVX_ERR_RANGE, "%s: the grid has 2^64 voxels or more", function);
    BVXI_TRY(bvxi_make_buffer(context, size, "the NPY file", &made));
    memset(made.bytes, ' ', (size_t)header);
    out.bytes = made.bytes;
    bvxi_output_add(&out, magic, sizeof magic);
    bvxi_store_u16(made.bytes + out.size, (uint16_t)(header - NPY_PREFIX));
    out.size = NPY_PREFIX;
    npy_put_header(grid, &out);
    made.bytes[header - 1] = '\n';
    for (uint64_t r = 0; r < rows; r++)
        npy_put_row(made.bytes + header + r * (uint64_t)grid->size[0],
                    grid->words + r * (uint64_t)grid->words_per_row, grid->size[0]);
    *file = made;
    return BVX_OK;
}
