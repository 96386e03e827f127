/* volume.c - views of volumes, checked before anything is read through them: type, strides of either sign,
 * and that all samples lie within what addresses can express. */
#include "volume/room.h"

bvx_status bvxi_volume_check(bvx_context *ctx, const char *function, const bvx_volume_view *volume,
                             int64_t stride[3])
{
    bvx_window window, unused;
    uint32_t const size = volume == NULL ? 0 : bvxi_type_size(volume->sample_type);
    int fits = 1;

    if (volume == NULL) return bvxi_fail_null(ctx, function, "volume");
    if (volume->samples == NULL) return bvxi_fail_null(ctx, function, "volume.samples");
    if (size == 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: sample type %d is unknown",
                             function, (int64_t)volume->sample_type);
    if (volume->reserved0 != 0) return bvxi_fail_reserved(ctx, function, "volume.");
    for (uint64_t i = 0; i < 4; i++)
        if (volume->reserved[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED,
                                 "%s: volume.reserved[%u] must be 0", function, i);
    BVXI_TRY(bvxi_lattice_check(ctx, function, &volume->lattice));
    memcpy(window.low, volume->low, sizeof window.low);
    memcpy(window.size, volume->size, sizeof window.size);

    /* One voxel along x at least: a size of 0 may stand for the whole lattice. */
    if (volume->size[0] < 1)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the volume's size is %d along x", function,
                         (int64_t)volume->size[0]);
    BVXI_TRY(bvxi_window_take(ctx, function, &volume->lattice, &window, &unused));
    memcpy(stride, volume->strides, 3 * sizeof *stride);
    /* No strides: samples lie one after the other, x fastest. */
    if (stride[0] == 0 && stride[1] == 0 && stride[2] == 0) {
        uint64_t const row = bvxi_mul(size, (uint64_t)volume->size[0], &fits);
        uint64_t const slice = bvxi_mul(row, (uint64_t)volume->size[1], &fits);
        if (!fits || slice > INT64_MAX)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                                 "%s: the volume's samples are more than addresses can tell", function);
        stride[0] = (int64_t)size;
        stride[1] = (int64_t)row;
        stride[2] = (int64_t)slice;
    }
    /* The way from the first sample to the last along all axes must be one that addresses can tell. */
    uint64_t reach = bvxi_type_size(volume->sample_type);
    for (int a = 0; a < 3; a++) {
        /* Taken apart for negative strides: the lowest number has no opposite. */
        uint64_t const step = stride[a] < 0 ? 0 - (uint64_t)stride[a] : (uint64_t)stride[a];
        reach = bvxi_add(reach, bvxi_mul(step, (uint64_t)(volume->size[a] - 1), &fits), &fits);
    }
    if (fits && reach <= PTRDIFF_MAX) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                         "%s: the volume's strides reach beyond this machine's addresses", function);
}
