/* nearest.c - a mesh made ready for questions about the closest points of a lattice's centres.
 *
 * The closest point is that of the least (distance squared, triangle index) of the evaluation in
 * point_triangle.c, over all triangles. Centres are origin + (index + 1/2) spacing in doubles; centre and
 * corners are multiplied by the power of two that brings the mesh within [-1, 1] first, which is exact, so
 * vectors and distances are those of bvx_closest_find at the centre. Error: the distance is that to some
 * point of the mesh but for rounding, and never above the true one by more than 2^-26 of the longest edge of
 * a needle, 10^-15 of the largest coordinate without needles (point_triangle.c).
 * How: a tree of boxes over eight triangles a leaf (nearest_build.c), leaves listed for 64
 * centres at once (nearest_cell.c), sieved for eight (nearest_eight.c), the last candidates evaluated
 * (nearest_pairs.c, nearest_brick.c). */
#include "nearest/nearest_walk.h"
#include "mesh/facet.h"
#include "mesh/view.h"

static bvx_status require_near_area(bvx_context *ctx, const char *function, const bvxi_nearest *n)
{
    double t[3][3], normal[3];
    /* Usually the first triangle answers. */
    for (uint64_t i = 0; i < n->triangle_count; i++) {
        bvxi_near_corners(n, (uint32_t)i, t);
        if (bvxi_facet_normal((const double(*)[3])t, normal) > 0.0) return BVX_OK;
    }
    return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no triangle has an area", function);
}

/* Every centre has a finite place, and so has every difference of places and every distance. */
static bvx_status check_near_range(bvx_context *ctx, const char *function, const bvx_lattice *l,
                                   const double low[3], const double high[3])
{
    static const char axis_name[3][2] = {"x", "y", "z"};

    /* Ends stand for all between them, on the lattice and in the mesh. */
    for (int a = 0; a < 3; a++) {
        double const first = l->origin[a], last = first + (double)l->dims[a] * l->spacing[a];
        double const below = first < low[a] ? first : low[a], above = last > high[a] ? last : high[a];
        if (!(last - last == 0.0))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: the lattice's last voxel has no finite place along %s", function,
                                 axis_name[a]);
        if (!(above - below < 0x1p1023))
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                "%s: along %s lattice and mesh reach from %g to %g, too far for distances in doubles",
                function, axis_name[a], below, above);
    }
    return BVX_OK;
}

bvx_status bvxi_nearest_check(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvx_lattice *lattice)
{
    double low[3], high[3];
    BVXI_TRY(bvxi_view_bounds(ctx, function, mesh, low, high));
    return check_near_range(ctx, function, lattice, low, high);
}

static bvx_status open_near(bvxi_call call, bvxi_nearest *n)
{
    double low[3], high[3];
    /* What is refused is refused before memory is taken for the tree. */
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, &n->view, low, high));
    BVXI_TRY(check_near_range(call.ctx, call.function, &n->lattice, low, high));

    /* The power of two of the evaluation; a lattice that reaches beyond 2^300 meshes could not be squared, so
     * the mesh gives way. */
    double s = bvxi_unit_scale(low, high), farthest = 0.0;
    /* Centres beyond the mesh are squared too, so the lattice counts with it. */
    for (int a = 0; a < 3; a++) {
        double const first = n->lattice.origin[a];
        double const end = first + (double)n->lattice.dims[a] * n->lattice.spacing[a];
        farthest = -first > farthest ? -first : first > farthest ? first : farthest;
        farthest = end > farthest ? end : -end > farthest ? -end : farthest;
    }
    while (farthest * s > 0x1p300) s *= 0.5; /* A power of two, so that scaling rounds nothing. */
    n->scale = s;
    BVXI_TRY(require_near_area(call.ctx, call.function, n));
    BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, sizeof *n->memo, "the field's memory", &n->memo));
    BVXI_TRY(bvxi_near_build(call, low, high, n));

    /* Above all rounding of the evaluation: 2^-48 of the largest coordinate [Units: box]. */
    double largest = 1.0;
    /* Rounding grows with the coordinates, not with the distance. */
    for (int a = 0; a < 3; a++) {
        double const first = n->lattice.origin[a] * n->scale;
        double const end = first + (double)n->lattice.dims[a] * n->lattice.spacing[a] * n->scale;
        largest = first > largest ? first : -first > largest ? -first : largest;
        largest = end > largest ? end : -end > largest ? -end : largest;
    }
    n->rounding = largest * n->box_scale * 0x1p-48;
    return BVX_OK;
}

bvx_status bvxi_nearest_open(bvxi_call call, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             bvxi_nearest **nearest)
{
    uint64_t const mark = bvxi_scratch_begin(call.ctx);
    bvxi_nearest *n = NULL;
    *nearest = NULL;
    BVXI_TRY(bvxi_view_check(call.ctx, call.function, mesh));
    BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, sizeof *n, "the search tree's head", &n));
    /* A copy of the view, as that of the caller may end with its function. */
    n->view = *mesh;
    n->lattice = *lattice;
    n->triangle_count = mesh->triangle_count;
    BVXI_TRY(bvxi_scratch_keep(call.ctx, mark, open_near(call, n)));
    *nearest = n;
    return BVX_OK;
}

void bvxi_nearest_prefer_planes(bvxi_nearest *nearest)
{
    nearest->by_planes = 1;
}

void bvxi_nearest_close(bvx_context *ctx, bvxi_nearest *nearest)
{
    if (nearest == NULL) return;
    bvxi_near_free(ctx, nearest);
    if (nearest->memo != NULL) bvxi_near_forget(ctx, nearest->memo);
    bvxi_drop(ctx, nearest->memo);
    bvxi_drop(ctx, nearest);
}
