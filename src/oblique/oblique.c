/* oblique.c - the closed surface of a body through contours on planes of any position.
 *
 * A smooth number at every place has the planes' signed distances on them (oblique_field.c); where the
 * lattice's vertices change sign there is the surface. Cells that planes and surface share become
 * tetrahedra, which the planes split (oblique_cells.c), and in which the contours become edges
 * (oblique_contours.c); signs there are those of the contours' regions, so the surface meets each plane in
 * its contours and nowhere else. All of it is a matter of who is next to whom: however it is rounded, the
 * surface is closed. */
#include "oblique/oblique.h"

static bvx_status make_oblique(bvxi_oblique *o, bvx_mesh *mesh)
{
    /* What contours say where planes cross is settled before anything is measured from them. */
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.02, bvxi_oblique_take_planes(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.02, 0.05, bvxi_oblique_settle(o)));

    BVXI_TRY(BVXI_SHARE(o->ctx, 0.05, 0.15, bvxi_oblique_raster(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.15, 0.2, bvxi_oblique_smooth(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.2, 0.25, bvxi_oblique_rest(o)));

    BVXI_TRY(BVXI_SHARE(o->ctx, 0.25, 0.4, bvxi_oblique_lattice(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.4, 0.5, bvxi_oblique_cells(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.5, 0.6, bvxi_oblique_split_planes(o)));

    /* Signs come last of all, once every contour's edge is one of a tetrahedron. */
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.6, 0.7, bvxi_oblique_contours(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.7, 0.8, bvxi_oblique_signs(o)));
    return BVXI_SHARE(o->ctx, 0.8, 1.0, bvxi_oblique_surface(o, mesh));
}

bvx_status bvxi_oblique_body(bvx_context *ctx, const char *function, const bvx_sections *given,
                             const bvx_sections_options *options, bvx_sections_report *report, bvx_mesh *mesh)
{
    bvxi_oblique o = {.ctx = ctx, .function = function, .given = given, .options = *options};
    int const own = mesh->positions == NULL;
    int sound;

    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.98, BVXI_SCOPE(ctx, make_oblique(&o, mesh))));
    /* In plain cells the surface is closed whatever the signs are; contours that are far from agreeing may leave
     * a tear where tetrahedra have been split. */
    BVXI_TRY(BVXI_SHARE(ctx, 0.98, 1.0, bvxi_section_check_mesh(ctx, mesh, own, &sound)));
    if (!sound)
        return bvxi_fail_for(
            ctx, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET,
            "%s: the contours contradict each other too much for a closed, manifold mesh; move "
            "those apart that cross where their planes meet, or take a smaller agree",
            function);

    *report = o.report;
    if (options->report == NULL) return BVX_OK;
    if (o.apart != 0) {
        bvx_warning *const w = BVXI_WARN(ctx, BVX_WARN_OPEN_PARTS, (double)o.apart);
        w->placed = 1;
        memcpy(w->low, o.apart_at, sizeof w->low);
        memcpy(w->high, o.apart_at, sizeof w->high);
    }
    if (o.specks != 0) BVXI_WARN(ctx, BVX_WARN_SPECKS, (double)o.specks);
    if (o.handles_left != 0) BVXI_WARN(ctx, BVX_WARN_EXTRA_HANDLES, (double)o.handles_left);
    return BVX_OK;
}
