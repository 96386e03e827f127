/* options.c - option structs whose size tells their age.
 *
 * A caller older than the library gives a shorter struct: what it lacks keeps its default. A newer caller gives a
 * longer one: what the library does not know must be zero, so that no option is silently ignored. */
#include "core.h"

bvx_status bvxi_take_options(bvx_context *ctx, const char *function, const void *given, void *options, size_t size)
{
    size_t given_size;
    if (given == NULL) return BVX_OK;
    memcpy(&given_size, given, sizeof given_size);
    if (given_size < sizeof given_size || given_size > 65536)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OPTIONS, "%s: options carry the size %u; fill them with their _init function",
                         function, (uint64_t)given_size);
    memcpy(options, given, given_size < size ? given_size : size);
    for (size_t i = size; i < given_size; i++)
        if (((const unsigned char *)given)[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_VERSION, BVX_REASON_OPTIONS, "%s: options set a field (byte %u) that this library does not know",
                             function, (uint64_t)i);
    return BVX_OK;
}

void bvxi_give_options(void *options, size_t size, const void *defaults, size_t default_size)
{
    if (options == NULL || size < sizeof size) return;
    memset(options, 0, size);
    memcpy(options, defaults, size < default_size ? size : default_size);
    memcpy(options, &size, sizeof size);
}
