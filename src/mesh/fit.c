/* fit.c - a lattice around a mesh or a cloud of points.
 *
 * Low-aligned: the mesh's bounds begin on the low corner of the first voxel after the padding. dims are the
 * smallest count that covers the bounds; an excess below 2^-40 of the extent is the rounding of the division,
 * holds no centre, and does not cost a layer of voxels. */
#include "lattice/lattice.h"
#include "mesh/view.h"

#include <math.h>

static const bvxi_option lattice_rows[] = {
    BVXI_WHOLE(bvx_lattice_options, padding, 0, 65536),
    BVXI_RESERVED(bvx_lattice_options, reserved),
};

static bvx_status check_fit_options(bvx_context *ctx, const char *function, bvx_lattice_options *o,
                                    int32_t *per_axis, int32_t *by_spacing)
{
    *per_axis = o->axis_resolution[0] != 0 || o->axis_resolution[1] != 0 || o->axis_resolution[2] != 0;
    *by_spacing = o->spacing[0] != 0 || o->spacing[1] != 0 || o->spacing[2] != 0;
    BVXI_TRY(bvxi_check_options(ctx, function, o, BVXI_OPTIONS(lattice_rows)));

    /* Three ways to give a size; two at once might contradict each other. */
    if ((o->resolution != 0) + *per_axis + *by_spacing != 1)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: give exactly one of resolution, axis_resolution and spacing", function);

    /* A spacing gives the count; a resolution gives the spacing. */
    for (int32_t a = 0; a < 3; a++) {
        int32_t const n = *per_axis ? o->axis_resolution[a] : *by_spacing ? 1 : o->resolution;
        if (n < 1 || n > BVXI_MAX_SIDE)
            return bvxi_fail_for(ctx, n < 1 ? BVX_ERR_ARGUMENT : BVX_ERR_RANGE, BVX_REASON_RANGE,
                                 "%s: resolution %d is outside 1 to %d", function, (int64_t)n,
                                 (int64_t)BVXI_MAX_SIDE);
        if (*by_spacing && !(o->spacing[a] > 0 && o->spacing[a] - o->spacing[a] == 0.0))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: spacing %g must be above 0 and finite", function, o->spacing[a]);
    }
    return BVX_OK;
}

static double least_cover(double extent, double spacing)
{
    double const n = extent / spacing;
    /* 2^-40 of the count is taken off before rounding up: the division's rounding must not cost a layer. */
    double const whole = -floor(n * (1.0 / 1099511627776.0) - n);
    return whole < 1 ? 1 : whole;
}

static bvx_status take_bounds(bvx_context *ctx, const char *name, const bvx_mesh_view *mesh, double low[3],
                              double high[3])
{
    /* A cloud of points is a mesh without triangles: all its vertices count. */
    if (mesh->triangle_count == 0) {
        bvx_mesh_view cloud;
        BVXI_TRY(bvxi_view_take_points(ctx, name, mesh, &cloud));
        return bvxi_view_point_bounds(ctx, name, &cloud, low, high);
    }
    BVXI_TRY(bvxi_view_check(ctx, name, mesh));
    return bvxi_view_bounds(ctx, name, mesh, low, high);
}

static bvx_status fit_lattice(bvx_context *context, const char *name, const bvx_mesh_view *mesh,
                              const bvx_lattice_options *options, bvx_lattice *lattice)
{
    bvx_lattice_options o;
    int32_t per_axis, by_spacing, longest = 0, dims[3];
    double low[3], high[3], extent[3], spacing[3], origin[3];

    if (mesh == NULL) return bvxi_fail_null(context, name, "mesh");
    if (lattice == NULL) return bvxi_fail_null(context, name, "lattice");
    BVXI_TRY(bvxi_take_options(context, name, options, &o, sizeof o));
    BVXI_TRY(check_fit_options(context, name, &o, &per_axis, &by_spacing));
    BVXI_TRY(take_bounds(context, name, mesh, low, high));

    /* The longest side has the resolution, and the others follow its spacing. */
    for (int32_t a = 0; a < 3; a++) {
        extent[a] = high[a] - low[a];
        if (extent[a] > extent[longest]) longest = a;
    }

    if (!by_spacing && !(extent[longest] > 0))
        return bvxi_fail(context, BVX_ERR_EMPTY,
                         "%s: all vertices lie at one point, so a resolution gives no spacing", name);
    if (!(extent[longest] - extent[longest] == 0.0))
        return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                             "%s: the extent is too large for a double", name);
    for (int32_t a = 0; a < 3; a++) {
        double n;
        if (per_axis) {
            spacing[a] = (extent[a] > 0 ? extent[a] : extent[longest]) / o.axis_resolution[a];
            n = o.axis_resolution[a];
        } else {
            spacing[a] = by_spacing ? o.spacing[a] : extent[longest] / o.resolution;
            n = !by_spacing && a == longest ? o.resolution : least_cover(extent[a], spacing[a]);
        }

        /* A side of a few of the least doubles, divided. */
        if (!(spacing[a] > 0))
            return bvxi_fail_for(
                context, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                "%s: an extent of %g is too small for a double to hold a voxel's side; scale "
                "it up",
                name, extent[longest]);
        /* Compared as doubles, before the cast: counts may be far beyond 32 bits. */
        if (!(n + 2.0 * o.padding <= BVXI_MAX_SIDE))
            return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: spacing %g needs %g voxels; %d along an axis are possible", name,
                                 spacing[a], n + 2.0 * o.padding, (int64_t)BVXI_MAX_SIDE);

        /* Padding is the same on both sides, so the origin moves down by it. */
        dims[a] = (int32_t)n + 2 * o.padding;
        origin[a] = low[a] - o.padding * spacing[a];
    }
    return bvx_lattice_make(context, origin, spacing, dims, lattice);
}

bvx_status bvx_lattice_fit_with(bvx_context *context, const bvx_mesh_view *mesh,
                                const bvx_lattice_options *options, bvx_lattice *lattice)
{
    return BVXI_CALL(context, fit_lattice(context, "bvx_lattice_fit_with", mesh, options, lattice));
}

static bvx_status run_lattice_fit(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                  bvx_lattice *lattice)
{
    bvx_lattice_options const o = {.struct_size = sizeof o, .resolution = resolution};
    if (resolution < 1)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "bvx_lattice_fit: resolution %d is outside 1 to %d", (int64_t)resolution,
                             (int64_t)BVXI_MAX_SIDE);
    return fit_lattice(context, "bvx_lattice_fit", mesh, &o, lattice);
}

bvx_status bvx_lattice_fit(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                           bvx_lattice *lattice)
{
    return BVXI_CALL(context, run_lattice_fit(context, mesh, resolution, lattice));
}
