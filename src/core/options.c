/* options.c - option structs whose size gives their age, and the ranges of their fields.
 *
 * A caller older than the library gives a shorter struct: what it lacks is 0, the default. A newer caller
 * gives a longer one: what the library does not know must be zero, so that no option is silently ignored. */
#include "core.h"

bvx_status bvxi_take_options(bvx_context *ctx, const char *function, const void *given, void *options,
                             size_t size)
{
    size_t given_size;

    /* What is taken may go on to another call, and so has the size of its own fields. */
    memset(options, 0, size);
    memcpy(options, &size, sizeof size);
    if (given == NULL) return BVX_OK;
    memcpy(&given_size, given, sizeof given_size);
    /* A size that no version had: options were not initialized. */
    if (given_size < sizeof given_size || given_size > 65536)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OPTIONS,
                             "%s: struct_size of the options is %u, not their sizeof", function,
                             (uint64_t)given_size);
    memcpy((unsigned char *)options + sizeof size, (const unsigned char *)given + sizeof size,
           (given_size < size ? given_size : size) - sizeof size);

    /* A caller newer than the library: what is not known must not be set. */
    for (size_t i = size; i < given_size; i++)
        if (((const unsigned char *)given)[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_VERSION, BVX_REASON_OPTIONS,
                                 "%s: options set a field (byte %u) that this library does not know",
                                 function, (uint64_t)i);
    return BVX_OK;
}

/* ---- Standards and ranges ---- */

static double stand_in(const bvxi_option *row, double value)
{
    int const has_none = row->kind == BVXI_IS_ZERO_OR || (row->kind != BVXI_IS_ABOVE && row->low == 0.0);
    return value == 0.0 ? row->standard : value == BVX_NONE && has_none ? 0.0 : value;
}

/* Only int32_t and double have a standard other than 0. */
static void put_standard(const bvxi_option *row, unsigned char *at)
{
    int32_t whole;
    double real;

    if (row->size == sizeof whole) {
        memcpy(&whole, at, sizeof whole);
        whole = (int32_t)stand_in(row, whole);
        memcpy(at, &whole, sizeof whole);
    } else {
        memcpy(&real, at, sizeof real);
        real = stand_in(row, real);
        memcpy(at, &real, sizeof real);
    }
}

BVXI_COLD static bvx_status fail_whole_option(bvx_context *ctx, const char *function, const bvxi_option *row,
                                              int64_t value)
{
    if (row->kind == BVXI_IS_AMONG)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: %s %d is none of its choices",
                             function, row->name, value);
    if (row->kind != BVXI_IS_WHOLE)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: %s %d is unknown", function,
                             row->name, value);
    if (row->low == 0.0 && row->high == 1.0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: %s is %d, not 0 or 1", function,
                             row->name, value);
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: %s is %d; %d to %d are possible",
                         function, row->name, value, (int64_t)row->low, (int64_t)row->high);
}

static inline bvx_status check_whole_option(bvx_context *ctx, const char *function, const bvxi_option *row,
                                            const unsigned char *at)
{
    int32_t value;
    memcpy(&value, at, sizeof value);
    /* Choices that are not consecutive: low holds the bits, one for each that is allowed. */
    if (BVXI_UNLIKELY(row->kind == BVXI_IS_AMONG)) {
        if (value >= 0 && value < 32 && ((uint32_t)row->low >> value & 1) != 0) return BVX_OK;
    } else if (BVXI_LIKELY(value >= row->low && value <= row->high)) {
        return BVX_OK;
    }
    return fail_whole_option(ctx, function, row, value);
}

BVXI_COLD static bvx_status fail_real_option(bvx_context *ctx, const char *function, const bvxi_option *row,
                                             double value)
{
    const char *const also = row->kind == BVXI_IS_ZERO_OR ? "0, or " : "";

    if (row->kind == BVXI_IS_ABOVE)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: %s is %g; it must be above %g%s",
                             function, row->name, value, row->low, row->high == 0.0 ? "" : " and finite");
    if (row->high == BVXI_FINITE)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: %s is %g; it must be %g or more and finite", function, row->name, value,
                             row->low);
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: %s is %g; %s%g to %g are possible",
                         function, row->name, value, also, row->low, row->high);
}

static inline bvx_status check_real_option(bvx_context *ctx, const char *function, const bvxi_option *row,
                                           const unsigned char *at)
{
    double value;
    memcpy(&value, at, sizeof value);
    int within = value >= row->low && value <= row->high;
    /* 0 as the upper end stands for none. */
    if (row->kind == BVXI_IS_ABOVE) within = value > row->low && (value <= row->high || row->high == 0.0);
    if (within || (row->kind == BVXI_IS_ZERO_OR && value == 0.0)) return BVX_OK;
    return fail_real_option(ctx, function, row, value);
}

bvx_status bvxi_check_options(bvx_context *ctx, const char *function, void *options, const bvxi_option *rows,
                              size_t count)
{
    for (const bvxi_option *row = rows; row != rows + count; row++) {
        unsigned char *const at = (unsigned char *)options + row->at;
        uint64_t value;

        if (row->standard != 0.0) put_standard(row, at);
        switch (row->kind) {
        case BVXI_IS_COUNT:
            memcpy(&value, at, sizeof value);
            if (value < (uint64_t)row->low || value > (uint64_t)row->high)
                return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                     "%s: %s is %u; %u to %u are possible", function, row->name, value,
                                     (uint64_t)row->low, (uint64_t)row->high);
            break;
        case BVXI_IS_REAL:
        case BVXI_IS_ABOVE:
        case BVXI_IS_ZERO_OR: BVXI_TRY(check_real_option(ctx, function, row, at)); break;
        case BVXI_IS_RESERVED:
            for (size_t k = 0; k < row->size; k++) {
                if (at[k] == 0) continue;
                if (row->size <= 8) return bvxi_fail_reserved(ctx, function, "");
                /* An array has 8-byte elements: name which. */
                return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED, "%s: reserved[%u] must be 0",
                                     function, (uint64_t)(k / 8));
            }
            break;
        default: BVXI_TRY(check_whole_option(ctx, function, row, at)); break;
        }
    }
    return BVX_OK;
}

static bvx_status check_places(bvx_context *ctx, const char *function, const double *places, uint64_t count,
                               size_t size, const char *what)
{
    if (places == NULL && count != 0) return bvxi_fail_null(ctx, function, what);
    if (count <= SIZE_MAX / size) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                         "%s: %u %s are beyond this machine's addresses", function, count, what);
}

bvx_status bvxi_check_points(bvx_context *ctx, const char *function, const double *points, uint64_t count,
                             size_t size)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    BVXI_TRY(check_places(ctx, function, points, count, size, "points"));
    /* x - x is 0 for finite numbers and NaN for all others. */
    for (uint64_t i = 0; i < 3 * count; i++)
        if (points[i] - points[i] != 0.0)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: point %i has %s = %g, which is not finite", function, i / 3,
                                 axis_name[i % 3], points[i]);
    return BVX_OK;
}

bvx_status bvxi_check_rays(bvx_context *ctx, const char *function, const double *rays, uint64_t count,
                           double t_max, size_t size)
{
    static const char *const part[6] = {"origin x",    "origin y",    "origin z",
                                        "direction x", "direction y", "direction z"};

    BVXI_TRY(check_places(ctx, function, rays, count, size, "rays"));
    if (!(t_max >= 0.0))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: t_max is %g; it must be 0 or above", function, t_max);
    for (uint64_t i = 0; i < count; i++) {
        const double *const ray = rays + 6 * i;

        for (int k = 0; k < 6; k++)
            if (ray[k] - ray[k] != 0.0)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                     "%s: ray %i has %s = %g, which is not finite", function, i, part[k],
                                     ray[k]);
        if (ray[3] == 0.0 && ray[4] == 0.0 && ray[5] == 0.0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: ray %i has a direction of length 0", function, i);
    }
    return BVX_OK;
}
