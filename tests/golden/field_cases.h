/* field_cases.h - golden cases of distance fields, their surfaces and repair; read in by golden.c. */
#ifndef FIELD_CASES_H
#define FIELD_CASES_H

static void mesh_value(golden *g, const char *key, bvx_status status, bvx_mesh *mesh)
{
    uint64_t hash = 0;
    if (golden_good(g, status) && golden_good(g, bvx_mesh_hash(g->context, mesh, &hash)))
        golden_hex(g, key, hash);
    bvx_mesh_free(g->context, mesh);
}

/* Fields by every sign: the file's bytes, and the surface by every interpolation. */
static void field_values(golden *g, const char *name, const bvx_mesh_view *view, int32_t resolution)
{
    static const char *const sign[] = {"exact", "normal", "winding", "vote", "none"};
    static const int32_t rule[] = {BVX_FILL_PARITY, BVX_FILL_NORMAL, BVX_FILL_WINDING, BVX_FILL_VOTE,
                                   BVX_FILL_NONE};
    static const int32_t vectors[] = {1, 0, 0, 1, 0};
    static const char *const edge[] = {"vector", "scalar", "middle", "paper", "tangent"};
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice lattice;

    if (golden_skips(g, name)) return;
    fit.resolution = resolution;
    fit.padding = 3;
    golden_begin(g, name);
    if (golden_good(g, bvx_lattice_fit_with(g->context, view, &fit, &lattice)))
        for (int32_t s = 0; s < 5; s++) {
            bvx_field_options o = {.struct_size = sizeof o};
            bvx_field field = {0};
            bvx_buffer file = {0};
            o.sign = rule[s];
            o.features = 1;
            if (!golden_good(g, bvx_measure_field(g->context, view, &lattice, &o, &field))) break;
            if (golden_good(g, bvx_write_field(g->context, &field, vectors[s], BVX_FORMAT_NRRD, &file)))
                golden_hex(g, sign[s], bvx_hash(file.bytes, (size_t)file.size, field.value_count));
            bvx_buffer_free(g->context, &file);
            for (int32_t e = 0; rule[s] == BVX_FILL_WINDING && e < 10; e++) {
                bvx_field_surface_options so = {.struct_size = sizeof so};
                bvx_mesh mesh = {0};
                so.placing.interpolation = (e + 1) % 5; /* TANGENT last */
                so.placing.sharp = BVX_SHARP_NEVER + (e / 5);
                if (so.placing.sharp == BVX_SHARP_ALWAYS) golden_text(g, "sharp", "1");
                mesh_value(g, edge[e % 5], bvx_extract_field_surface(g->context, &field, view, &so, &mesh),
                           &mesh);
            }
            bvx_field_free(g->context, &field);
        }
    golden_end(g);
}

/* The surface of a shell, plain and sharp: outside the mesh's, inside an even wall. */
static void changed_values(golden *g, const char *name, const bvx_mesh_view *view, int32_t resolution)
{
    bvx_lattice lattice;
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_field field = {0};
    bvx_grid shell = {0};

    golden_begin(g, name);
    o.half_width = 5;
    if (golden_good(g, bvx_lattice_fit(g->context, view, resolution, &lattice)) &&
        golden_good(g, bvx_measure_field(g->context, view, &lattice, &o, &field)) &&
        golden_good(g,
                    bvx_grid_combine(g->context, &field.inside, &field.inside, BVX_BOOLEAN_UNION, &shell))) {
        double const thickness = 2.25 * lattice.spacing[0];
        for (int32_t z = 0; z < shell.size[2]; z++)
            for (int32_t y = 0; y < shell.size[1]; y++)
                for (int32_t x = 0; x < shell.size[0]; x++) {
                    uint64_t const n = bvx_field_value(&field, x, y, z);
                    int const wall = n != UINT64_MAX && ((const float *)field.distances)[n] > -thickness;
                    if (bvx_grid_get(&shell, x, y, z) && !wall) bvx_grid_set(&shell, x, y, z, 0);
                }
        for (int32_t sharp = 0; sharp < 2; sharp++) {
            bvx_field_surface_options so = {.struct_size = sizeof so};
            bvx_mesh mesh = {0};
            so.placing.sharp = BVX_SHARP_NEVER + sharp;
            so.grid = &shell;
            so.offset = -thickness;
            mesh_value(g, sharp ? "sharp" : "plain",
                       bvx_extract_field_surface(g->context, &field, view, &so, &mesh), &mesh);
        }
    }
    bvx_grid_free(g->context, &shell);
    bvx_field_free(g->context, &field);
    golden_end(g);
}

static void field_cases(golden *g)
{
    bvx_mesh_view view;
    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    shape_view(&golden_shape, &view);
    field_values(g, "torus_40", &view, 40);
    changed_values(g, "torus_40_shell", &view, 40);
    shape_soup(&golden_shape, 300, 11);
    shape_view(&golden_shape, &view);
    field_values(g, "soup_24", &view, 24);
    shape_ball(&golden_shape, 10);
    shape_view(&golden_shape, &view);
    field_values(g, "ball_12", &view, 12);
}

static void repair_values_of(golden *g, const char *name, const bvx_mesh_view *view, int32_t resolution,
                             int32_t sign, int32_t thin)
{
    if (golden_skips(g, name)) return;
    golden_begin(g, name);
    for (int32_t sharp = 0; sharp < 2; sharp++) {
        bvx_repair_options o = {.struct_size = sizeof o};
        bvx_mesh mesh = {0};
        o.fit.resolution = resolution;
        o.sign = sign;
        o.placing.sharp = BVX_SHARP_NEVER + sharp;
        o.thin = thin;
        mesh_value(g, sharp ? "sharp" : "plain", bvx_repair(g->context, view, &o, &mesh), &mesh);
    }
    golden_end(g);
}

static void hull_values(golden *g, const char *name, const bvx_mesh_view *view, int32_t close_gaps)
{
    if (golden_skips(g, name)) return;
    golden_begin(g, name);
    for (int32_t sharp = 0; sharp < 2; sharp++) {
        bvx_hull_options o = {.struct_size = sizeof o, .close_gaps = close_gaps};
        bvx_mesh mesh = {0};
        o.fit.resolution = 48;
        o.placing.sharp = BVX_SHARP_NEVER + sharp;
        mesh_value(g, sharp ? "sharp" : "plain", bvx_hull(g->context, view, &o, 1, &mesh), &mesh);
    }
    golden_end(g);
}

/* Around every triangle, at a tenth of the torus's radius. */
static void enclosed_values(golden *g, const char *name, const bvx_mesh_view *view)
{
    uint64_t const target = 600;
    bvx_hull_options o = {.struct_size = sizeof o, .targets = {.triangles = &target}, .enclose = 0.1};
    bvx_mesh mesh = {0};

    if (golden_skips(g, name)) return;
    golden_begin(g, name);
    mesh_value(g, "level", bvx_hull(g->context, view, &o, 1, &mesh), &mesh);
    golden_end(g);
}

static void repair_cases(golden *g)
{
    bvx_mesh_view view;

    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    shape_view(&golden_shape, &view);
    view.triangle_count -= 700;
    repair_values_of(g, "torus_48_open", &view, 48, BVX_FILL_AUTO, BVX_THIN_KEEP);
    repair_values_of(g, "torus_48_open_vote", &view, 48, BVX_FILL_VOTE, BVX_THIN_KEEP);
    repair_values_of(g, "torus_48_open_shell", &view, 48, BVX_FILL_AUTO, BVX_THIN_SHELL);
    hull_values(g, "torus_48_open_hull", &view, 0);
    hull_values(g, "torus_48_closed_hull", &view, 9);
    enclosed_values(g, "torus_enclosed", &view);
    shape_ball(&golden_shape, 24);
    for (uint32_t v = 0; v < golden_shape.vertices; v++) golden_shape.v[v][2] *= 0.01;
    shape_view(&golden_shape, &view);
    repair_values_of(g, "thin_disc_48", &view, 48, BVX_FILL_AUTO, BVX_THIN_KEEP);
    repair_values_of(g, "thin_disc_48_shell", &view, 48, BVX_FILL_AUTO, BVX_THIN_SHELL);
    shape_soup(&golden_shape, 300, 11);
    shape_view(&golden_shape, &view);
    repair_values_of(g, "soup_32", &view, 32, BVX_FILL_AUTO, BVX_THIN_KEEP);
    repair_values_of(g, "soup_32_vote", &view, 32, BVX_FILL_VOTE, BVX_THIN_KEEP);
}

#endif
