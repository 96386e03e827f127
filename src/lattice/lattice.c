/* lattice.c - lattices checked, made from parts (bvx_lattice_make), and windows of them.
 *
 * The number of fraction bits follows from the size, so that lattice coordinates stay below 2^30 (lattice.h
 * has the bit budget). */
#include "lattice/lattice.h"

int32_t bvxi_fraction_bits(int32_t n)
{
    int32_t log2 = 0;
    while (log2 < 30 && ((int64_t)1 << log2) < n) log2++;
    return 29 - log2 < BVXI_MAX_FRACTION ? 29 - log2 : BVXI_MAX_FRACTION;
}

static int lattice_number_ok(double v)
{
    return v - v == 0.0; /* neither NaN nor infinite */
}

bvx_status bvxi_lattice_check(bvx_context *ctx, const char *function, const bvx_lattice *lattice)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    if (lattice == NULL) return bvxi_fail_null(ctx, function, "lattice");
    for (int32_t a = 0; a < 3; a++) {
        if (!lattice_number_ok(lattice->origin[a]))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: the lattice's origin is not finite along %s", function, axis_name[a]);
        if (!lattice_number_ok(lattice->spacing[a]) || !(lattice->spacing[a] > 0))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: the lattice's spacing along %s is %g; it must be above 0 and finite",
                                 function, axis_name[a], lattice->spacing[a]);
        if (lattice->dims[a] < 1 || lattice->dims[a] > BVXI_MAX_SIDE)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the lattice has %d voxels along %s; 1 to %d are possible", function,
                                 (int64_t)lattice->dims[a], axis_name[a], (int64_t)BVXI_MAX_SIDE);
    }
    if (lattice->fraction_bits < BVXI_MIN_FRACTION || lattice->fraction_bits > BVXI_MAX_FRACTION)
        return bvxi_fail_for(
            ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
            "%s: the lattice has %d fraction bits; 4 to 16 are possible (bvx_lattice_make sets them)",
            function, (int64_t)lattice->fraction_bits);

    /* Sides in fixed point stay within 2^29: products of two differences then fit 64 bits. */
    for (int32_t a = 0; a < 3; a++)
        if ((int64_t)lattice->dims[a] << lattice->fraction_bits > (int64_t)1 << 29)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: %d voxels along %s leave room for %d fraction bits, not %d", function,
                                 (int64_t)lattice->dims[a], axis_name[a],
                                 (int64_t)bvxi_fraction_bits(lattice->dims[a]),
                                 (int64_t)lattice->fraction_bits);
    return BVX_OK;
}

bvx_status bvxi_window_take(bvx_context *ctx, const char *function, const bvx_lattice *lattice,
                            const bvx_window *given, bvx_window *window)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    static const bvx_window none = {{0, 0, 0}, {0, 0, 0}};

    /* All zeros stand for the whole lattice. */
    if (given == NULL || memcmp(given, &none, sizeof none) == 0) {
        memcpy(window->low, none.low, sizeof window->low);
        memcpy(window->size, lattice->dims, sizeof window->size);
        return BVX_OK;
    }
    /* Differences, not sums, as sums might overflow. */
    for (int32_t a = 0; a < 3; a++)
        if (given->low[a] < 0 || given->size[a] < 1 || given->low[a] > lattice->dims[a] - given->size[a])
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                 "%s: the window's voxels %d to %d along %s are not inside the lattice's %d",
                                 function, (int64_t)given->low[a],
                                 (int64_t)given->low[a] + given->size[a] - 1, axis_name[a],
                                 (int64_t)lattice->dims[a]);
    *window = *given;
    return BVX_OK;
}

int bvxi_lattice_equal(const bvx_lattice *a, const bvx_lattice *b)
{
    for (int32_t i = 0; i < 3; i++) {
        if (!(a->origin[i] == b->origin[i]) || !(a->spacing[i] == b->spacing[i])) return 0;
        if (a->dims[i] != b->dims[i]) return 0;
    }
    return a->fraction_bits == b->fraction_bits;
}

bvx_status bvxi_lattice_build(bvx_context *ctx, const char *function, const double origin[3],
                              const double spacing[3], const int32_t dims[3], bvx_lattice *lattice)
{
    bvx_lattice made = {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, BVXI_MIN_FRACTION};
    int32_t longest = 1;

    memcpy(made.origin, origin, sizeof made.origin);
    memcpy(made.spacing, spacing, sizeof made.spacing);
    memcpy(made.dims, dims, sizeof made.dims);
    /* As fine as the longest side allows. */
    for (int32_t a = 0; a < 3; a++)
        if (dims[a] > longest) longest = dims[a];
    /* Longer ones are refused by the check. */
    if (longest <= BVXI_MAX_SIDE) made.fraction_bits = bvxi_fraction_bits(longest);
    BVXI_TRY(bvxi_lattice_check(ctx, function, &made));
    *lattice = made;
    return BVX_OK;
}

bvx_status bvx_lattice_make(bvx_context *context, const double origin[3], const double spacing[3],
                            const int32_t dims[3], bvx_lattice *lattice)
{
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (origin == NULL || spacing == NULL || dims == NULL || lattice == NULL)
        return bvxi_fail_null(context, "bvx_lattice_make", "an argument");
    return bvxi_lattice_build(context, "bvx_lattice_make", origin, spacing, dims, lattice);
}
