/* oblique.c - the closed surface of a body through contours on planes of any position.
 *
 * A smooth number at every place has the planes' signed distances on them (oblique_field.c); where the
 * lattice's vertices change sign there is the surface. Cells that planes and surface share become
 * tetrahedra, which the planes split (oblique_cells.c), and in which the contours become edges
 * (oblique_contours.c); signs there are those of the contours' regions, so the surface meets each plane in
 * its contours and nowhere else. All of it is a matter of who is next to whom: however it is rounded, the
 * surface is closed. */
#include "section/oblique.h"

static void close_oblique(bvxi_oblique *o)
{
    bvxi_drop(o->ctx, o->output);
    bvxi_drop(o->ctx, o->owner);
    bvxi_drop(o->ctx, o->triangle);
    bvxi_drop(o->ctx, o->kept);
    bvxi_drop(o->ctx, o->position);
    bvxi_edge_free(o, &o->crossing);
    bvxi_drop(o->ctx, o->point_vertex);
    bvxi_edge_free(o, &o->contour_edge);
    bvxi_drop(o->ctx, o->star);
    bvxi_drop(o->ctx, o->ring);
    bvxi_drop(o->ctx, o->on);
    bvxi_drop(o->ctx, o->vertex);
    bvxi_drop(o->ctx, o->stamp);
    bvxi_drop(o->ctx, o->twin);
    bvxi_drop(o->ctx, o->chain);
    bvxi_drop(o->ctx, o->tetra);
    bvxi_drop(o->ctx, o->touch_cell);
    bvxi_drop(o->ctx, o->plane_touch);
    bvxi_drop(o->ctx, o->touch);
    bvxi_drop(o->ctx, o->cell);
    bvxi_drop(o->ctx, o->active);
    bvxi_drop(o->ctx, o->mark);
    bvxi_drop(o->ctx, o->crossed);
    bvxi_drop(o->ctx, o->vertex_at);
    bvxi_drop(o->ctx, o->touch_first);
    bvxi_drop(o->ctx, o->split_first);
    bvxi_drop(o->ctx, o->split);
    bvxi_drop(o->ctx, o->inside);
    bvxi_edge_free(o, &o->lattice_vertex);
    bvxi_drop(o->ctx, o->value);
    bvxi_drop(o->ctx, o->known);
    bvxi_drop(o->ctx, o->contour_cells);
    bvxi_drop(o->ctx, o->block_at);
    bvxi_drop(o->ctx, o->block_kind);
    bvxi_drop(o->ctx, o->smooth.node);
    bvxi_drop(o->ctx, o->knot);
    bvxi_oblique_free_planes(o);
}

static bvx_status make_oblique(bvxi_oblique *o, bvx_mesh *mesh)
{
    /* What contours say where planes cross is settled before anything is measured from them. */
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.02, bvxi_oblique_take_planes(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.02, 0.05, bvxi_oblique_settle(o)));

    /* The number between the planes: distances on them, the plate through these, and what it leaves of
     * them. */
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.05, 0.15, bvxi_oblique_raster(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.15, 0.2, bvxi_oblique_smooth(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.2, 0.25, bvxi_oblique_rest(o)));

    /* Then the cells that the surface may meet, and the tetrahedra of those with planes in them. */
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
    bvxi_oblique o;
    bvx_status status;

    /* All zero is a state that can be closed, whatever step fails. */
    memset(&o, 0, sizeof o);
    o.ctx = ctx;
    o.function = function;
    o.given = given;
    o.options = *options;
    status = make_oblique(&o, mesh);

    /* A failure leaves the caller's report as it was. */
    if (status == BVX_OK) *report = o.report;
    close_oblique(&o);
    return status;
}
