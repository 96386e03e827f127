/* field_surface.c - the surface of a distance field: bvx_extract_field_surface.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013, section 2.3
 * (edge_cut.c says how its formula is mended).
 *
 * Marching cubes between inside and outside centres, then each vertex is put where the field's closest points
 * say, strictly inside its edge. The triangulations of the tables do not cross for any places inside the
 * edges, so the result is closed, manifold and free of crossings whatever the field holds; sharp.c adds
 * vertices inside cells and keeps that. */
#include "surface/sharp.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/view.h"

static const bvxi_option field_surface_rows[] = {
    BVXI_PLACING(bvx_field_surface_options),
    BVXI_OR(bvx_field_surface_options, sharp_angle, REAL, BVXI_SHARP_ANGLE, -1.0, 1.0),
    BVXI_REAL(bvx_field_surface_options, offset, -BVXI_FINITE, BVXI_FINITE),
};

/* Voxels in place of the field's own stand on the same window. */
static bvx_status check_changed(bvx_context *ctx, const char *function, const bvx_field *f,
                                const bvx_field_surface_options *o)
{
    if (o->grid == NULL && o->offset != 0.0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: offset is used with grid, which is NULL", function);
    if (o->grid == NULL) return BVX_OK;
    BVXI_TRY(bvxi_grid_check(ctx, function, o->grid));
    /* Voxels are looked up by their place in both grids. */
    if (!bvxi_lattice_equal(&o->grid->lattice, &f->inside.lattice) ||
        memcmp(o->grid->low, f->inside.low, sizeof o->grid->low) != 0 ||
        memcmp(o->grid->size, f->inside.size, sizeof o->grid->size) != 0)
        return bvxi_fail(ctx, BVX_ERR_LATTICE,
                         "%s: grid and the field's inside have different lattices or windows", function);
    return BVX_OK;
}

static bvx_status check_field(bvx_context *ctx, const char *function, const bvx_field *f,
                              const bvx_field_surface_options *o)
{
    int const vectors = (o->placing.interpolation != BVX_EDGE_SCALAR &&
                         o->placing.interpolation != BVX_EDGE_MIDDLE) ||
                        o->placing.sharp != BVX_SHARP_NEVER;

    for (uint64_t i = 0; i < 4; i++)
        if (f->reserved[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED,
                                 "%s: field.reserved[%u] must be 0", function, i);
    if (f->sign == BVX_FILL_NONE || f->inside.words == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: the field has no inside; measure it with a sign", function);
    BVXI_TRY(bvxi_grid_check(ctx, function, &f->inside));
    BVXI_TRY(check_changed(ctx, function, f, o));

    /* Doubles, where they are taken, must distinguish neighbouring positions; floats round, and the surface stays
     * closed. */
    static const double local_origin[3] = {0, 0, 0};
    const double *const origin = o->placing.local_frame ? local_origin : f->inside.lattice.origin;
    if (o->placing.position_type != BVX_F32 &&
        (o->placing.position_type != BVX_POSITION_AUTO || !bvxi_fits_f32(&f->inside, origin)))
        BVXI_TRY(bvxi_check_f64(ctx, function, &f->inside, origin));
    /* Middles need no value of the field. */
    if (o->placing.interpolation == BVX_EDGE_MIDDLE && o->placing.sharp == BVX_SHARP_NEVER) return BVX_OK;
    BVXI_TRY(bvxi_grid_check(ctx, function, &f->band));
    if (!bvxi_lattice_equal(&f->band.lattice, &f->inside.lattice) ||
        memcmp(f->band.low, f->inside.low, sizeof f->band.low) != 0 ||
        memcmp(f->band.size, f->inside.size, sizeof f->band.size) != 0)
        return bvxi_fail(ctx, BVX_ERR_LATTICE,
                         "%s: the field's band and inside have different lattices or windows", function);
    if (f->value_type != BVX_F32 && f->value_type != BVX_F64)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: field.value_type %d is neither BVX_F32 nor BVX_F64", function,
                             (int64_t)f->value_type);
    if (f->row_values == NULL) return bvxi_fail_null(ctx, function, "field.row_values");
    BVXI_TRY(bvxi_sparse_check(ctx, function, f));
    if (vectors && f->vectors == NULL && f->value_count != 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: the field has no vectors; measure it with them or take BVX_EDGE_SCALAR",
                             function);
    if (f->vectors == NULL && f->distances == NULL && f->value_count != 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: the field has neither vectors nor distances", function);
    return BVX_OK;
}

/* Sharp edges: as asked for, or where the mesh has them. */
static bvx_status choose_field_sharp(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                                     bvx_field_surface_options *o)
{
    double low[3], high[3];
    int32_t sharp;
    if (o->placing.sharp != BVX_SHARP_AUTO) return BVX_OK;
    BVXI_TRY(bvxi_view_check(ctx, function, mesh));
    BVXI_TRY(bvxi_view_bounds(ctx, function, mesh, low, high));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.2, BVXI_SCOPE(ctx, bvxi_sharp_edges(ctx, mesh, NULL, &sharp))));
    o->placing.sharp = sharp ? BVX_SHARP_ALWAYS : BVX_SHARP_NEVER;
    return BVX_OK;
}

static bvx_status place_cuts(bvx_context *ctx, bvxi_cuts *c, bvx_field_surface_report *report)
{
    uint64_t const bytes = (uint64_t)c->march->pieces * (BVXI_CUT_KINDS + 1) * sizeof *c->piece_counts;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the counts of cuts", &c->piece_counts));
    BVXI_TRY(bvxi_for_pieces(ctx, "vertices", 0.0, 1.0, c->march->pieces, c->march->slot_count,
                             bvxi_cuts_piece, c));
    for (int32_t p = 0; p < c->march->pieces; p++) {
        report->own += c->piece_counts[(BVXI_CUT_KINDS + 1) * p + BVXI_CUT_KINDS];
        for (int32_t by = 0; by < BVXI_CUT_KINDS; by++) {
            uint64_t const n = c->piece_counts[(BVXI_CUT_KINDS + 1) * p + by];
            /* Lids are edges over holes, where the field has no value. */
            report->edges += n;
            report->scalar += by == BVXI_CUT_SCALAR ? n : 0;
            report->middle += by == BVXI_CUT_MIDDLE ? n : 0;
            report->lids += by == BVXI_CUT_LID ? n : 0;
        }
    }
    return BVX_OK;
}

bvx_status bvxi_field_surface(bvx_context *ctx, const char *function, const bvx_grid *inside,
                              const bvxi_cut_rule *values, const bvx_field_surface_options *options,
                              bvx_mesh *surface)
{
    int const sharp = options->placing.sharp == BVX_SHARP_ALWAYS;
    /* Choices of the field's surface that marching cubes has too. */
    bvx_extract_options extract = {.face_rule = options->placing.face_rule,
                                   .position_type = options->placing.position_type,
                                   .local_frame = options->placing.local_frame};
    bvx_field_surface_report report = {.sharp = sharp ? 1 : 0};
    bvxi_march m = {0};

    m.function = function;
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.1, bvxi_march_open(ctx, &m, inside, &extract)));
    bvxi_cuts cuts = {.march = &m,
                      .values = values,
                      .interpolation = options->placing.interpolation,
                      .unit = bvxi_largest_spacing(&inside->lattice)};
    if (sharp) {
        /* The surface by cuts becomes scratch. */
        uint64_t const plane_bytes = m.vertex_count * 2 * sizeof *cuts.planes;
        uint64_t const triangle_bytes = m.triangle_count * 12;
        uint64_t const position_bytes = m.vertex_count * (m.options.position_type == BVX_F32 ? 12 : 24);

        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, plane_bytes, "the facets' planes", &cuts.planes));
        bvx_mesh plain = {.position_type = m.options.position_type,
                          .vertex_capacity = m.vertex_count,
                          .triangle_capacity = m.triangle_count};
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, position_bytes, "the positions before sharpening",
                            &plain.positions));
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, triangle_bytes, "the triangles before sharpening",
                            &plain.triangles));
        BVXI_TRY(BVXI_SHARE(ctx, 0.1, 0.15, bvxi_march_fill(ctx, &m, &plain)));
        BVXI_TRY(BVXI_SHARE(ctx, 0.15, 0.5, BVXI_SCOPE(ctx, place_cuts(ctx, &cuts, &report))));
        BVXI_TRY(
            BVXI_SHARE(ctx, 0.5, 1.0, bvxi_sharpen(ctx, &m, &cuts, options->sharp_angle, surface, &report)));
    } else {
        int const mine = surface->positions == NULL;
        BVXI_TRY(BVXI_SHARE(ctx, 0.1, 0.3, bvxi_march_fill(ctx, &m, surface)));
        BVXI_TRY(
            bvxi_mesh_made(ctx, BVXI_SHARE(ctx, 0.3, 1.0, place_cuts(ctx, &cuts, &report)), mine, surface));
    }
    if (options->report != NULL) *options->report = report;
    return BVX_OK;
}

static bvx_status run_extract_field_surface(bvx_context *context, const bvx_field *field,
                                            const bvx_mesh_view *mesh,
                                            const bvx_field_surface_options *options, bvx_mesh *surface)
{
    static const char name[] = "bvx_extract_field_surface";
    bvx_field_surface_options o;
    bvxi_cut_rule v = {0};

    if (field == NULL || surface == NULL)
        return bvxi_fail_null(context, name, field == NULL ? "field" : "surface");
    BVXI_TRY(bvxi_take_options(context, name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, name, &o, BVXI_OPTIONS(field_surface_rows)));
    if (o.placing.sharp == BVX_SHARP_AUTO && (mesh == NULL || field->vectors == NULL))
        o.placing.sharp = BVX_SHARP_NEVER;
    BVXI_TRY(check_field(context, name, field, &o));
    /* Remembered, as looking for sharp edges takes its share of progress. */
    int32_t const asked = o.placing.sharp;
    BVXI_TRY(choose_field_sharp(context, name, mesh, &o));
    /* Triangles make planes exact; without them vectors stand in. */
    if (o.placing.sharp == BVX_SHARP_ALWAYS && mesh != NULL && field->triangles != NULL) {
        /* Triangles of the field are looked up in the mesh. */
        double low[3], high[3];
        BVXI_TRY(bvxi_view_check(context, name, mesh));
        BVXI_TRY(bvxi_view_bounds(context, name, mesh, low, high));
        for (uint64_t n = 0; n < field->value_count; n++)
            if (field->triangles[n] >= mesh->triangle_count)
                return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                     "%s: field.triangles[%i] is %u, the mesh has %u triangles", name, n,
                                     (uint64_t)field->triangles[n], mesh->triangle_count);

        BVXI_TRY(bvxi_view_apart(context, name, mesh, surface));
        v.mesh = mesh;
    }
    bvxi_sparse values = bvxi_sparse_of_field(field);
    v.values = &values;
    v.inside = o.grid != NULL ? &field->inside : NULL;
    v.offset = o.offset;
    return BVXI_SHARE(
        context, asked == BVX_SHARP_AUTO ? 0.2 : 0.0, 1.0,
        bvxi_field_surface(context, name, o.grid != NULL ? o.grid : &field->inside, &v, &o, surface));
}

bvx_status bvx_extract_field_surface(bvx_context *context, const bvx_field *field, const bvx_mesh_view *mesh,
                                     const bvx_field_surface_options *options, bvx_mesh *surface)
{
    return BVXI_CALL(context, run_extract_field_surface(context, field, mesh, options, surface));
}
