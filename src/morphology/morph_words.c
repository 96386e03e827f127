/* morph_words.c - masks that keep the bits of one row of a slice out of the next. */
#include "morphology/morph.h"

bvx_status bvxi_row_ends_open(bvx_context *ctx, const bvxi_bit_box *box, bvxi_row_ends *ends)
{
    size_t const words = (size_t)box->row_words, slice = words * (size_t)box->size[1];

    /* A word for each of the slice: one long loop without a test for row ends. */
    ends->bytes = (uint64_t)slice * 16; /* no more than two slices of a grid that is there */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, ends->bytes, "masks of a slice", &ends->before));
    ends->behind = ends->before + slice;
    for (size_t k = 0; k < slice; k++) {
        ends->before[k] = k % words == 0 ? 0 : 1;
        ends->behind[k] = k % words == words - 1 ? 0 : BVXI_TOP_BIT;
    }
    return BVX_OK;
}

void bvxi_row_ends_free(bvx_context *ctx, bvxi_row_ends *ends)
{
    bvxi_drop(ctx, ends->before);
    ends->before = ends->behind = NULL;
}
