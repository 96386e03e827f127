/* vti_blocks.c - arrays of VTK's XML files that are packed in blocks.
 *
 * Source: VTK File Formats (docs.vtk.org). An array is a head of numbers - blocks, bytes of a block, bytes of
 * the last one or 0, packed bytes of each - and the packed blocks; in base 64 the head is one text and the
 * blocks together are another. Guarantee: a head is held against the file's bytes before anything is made. */
#include "io_grid/grid_formats.h"

enum { WORST_RATIO = 1032 }; /* deflate packs no better */

static BVXI_COLD bvx_status fail_blocks(const bvxi_dense *d, const char *why)
{
    return BVXI_LINE_FAIL(&d->source, d->array, BVX_ERR_FORMAT, "%s", why);
}

static int take_number(const bvxi_dense *d, bvxi_base64 *from, uint64_t *number)
{
    uint64_t const n = (uint64_t)d->number_size;
    uint8_t bytes[8];
    if (d->is_text) {
        if (!bvxi_base64_take(from, bytes, n)) return 0;
    } else {
        if ((uint64_t)(from->end - from->p) < n) return 0;
        memcpy(bytes, from->p, (size_t)n);
        from->p += n;
    }
    *number = n == 4 ? bvxi_load_u32(bytes, d->samples.big) : bvxi_load_u64(bytes, d->samples.big);
    return 1;
}

bvx_status bvxi_check_blocks(const bvxi_dense *d, uint64_t *size)
{
    bvxi_base64 from = d->base64;
    uint64_t const have = (uint64_t)(from.end - from.p);
    uint64_t blocks, block = 0, last = 0, packed = 0, n;
    int whole = take_number(d, &from, &blocks);

    if (whole && blocks > have / (uint64_t)d->number_size)
        return fail_blocks(d, "the array has more blocks than the file has bytes for");
    if (whole && blocks != 0) whole = take_number(d, &from, &block) && take_number(d, &from, &last);
    for (uint64_t i = 0; whole && i < blocks; i++) {
        whole = take_number(d, &from, &n);
        /* Sums that stay below what the file has do not wrap. */
        if (whole && n > have - packed)
            return fail_blocks(d, "packed blocks continue after the end of the file");
        if (whole) packed += n;
    }
    if (!whole) return fail_blocks(d, "the array ends within its head");
    if (packed > (uint64_t)(from.end - from.p))
        return fail_blocks(d, "packed blocks continue after the end of the file");

    /* More than deflate can hold is a lie that memory would pay for. */
    uint64_t const most = packed * WORST_RATIO + 64;
    if (blocks != 0 && (block > most || last > block || blocks > most / (block != 0 ? block : 1) + 1))
        return fail_blocks(d, "packed blocks are said to hold more than they can");
    *size = blocks == 0 ? 0 : block * (blocks - 1) + (last != 0 ? last : block);
    return BVX_OK;
}

bvx_status bvxi_unpack_blocks(const bvxi_grid_source *source, const bvxi_dense *d, uint8_t *bytes)
{
    const bvx_read_volume_options *const o = source->volume;
    bvxi_base64 head = d->base64, data;
    uint64_t blocks = 0, block = 0, last = 0, n = 0, largest = 0;
    uint8_t *text = NULL;

    /* bvxi_check_blocks has seen that all numbers are there. */
    (void)(take_number(d, &head, &blocks) && take_number(d, &head, &block) && take_number(d, &head, &last));
    data = head;
    for (uint64_t i = 0; i < blocks && take_number(d, &data, &n); i++) largest = n > largest ? n : largest;
    if (d->is_text) BVXI_TRY(bvxi_alloc(source->ctx, BVXI_SCRATCH, largest, "a packed block", &text));

    for (uint64_t i = 0; i < blocks && take_number(d, &head, &n); i++) {
        uint64_t const plain = i + 1 == blocks && last != 0 ? last : block;
        const void *const packed = d->is_text ? (const void *)text : data.p;
        if (!d->is_text) data.p += n;
        else if (!bvxi_base64_take(&data, text, n))
            return fail_blocks(d, "the text of the packed blocks ends too soon");
        if (o->inflate(o->inflate_user, packed, n, bytes, plain) != 0)
            return fail_blocks(d, "a packed block is damaged");
        bytes += plain;
        BVXI_TRY(bvxi_progress(source->ctx, "read", (double)(i + 1) / (double)blocks));
    }
    bvxi_drop(source->ctx, text);
    return BVX_OK;
}
