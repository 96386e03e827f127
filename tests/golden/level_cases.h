/* level_cases.h - golden cases of levels of detail, of meshes as they are
 * and of measured surfaces; read in by golden.c. */
#ifndef LEVEL_CASES_H
#define LEVEL_CASES_H

static void level_values(golden *g, bvx_mesh *levels, const bvx_level_report *reports)
{
    static const char *const keys[2] = {"fine", "coarse"};

    for (int i = 0; i < 2; i++) {
        uint64_t hash = 0;
        golden_u64(g, "triangles", levels[i].triangle_count);
        if (golden_good(g, bvx_mesh_hash(g->context, &levels[i], &hash))) golden_hex(g, keys[i], hash);
        golden_hex(g, "angle", mixed_doubles(0, &reports[i].least_angle, 1));
        golden_u64(g, "met", (uint64_t)reports[i].met);
        bvx_mesh_free(g->context, &levels[i]);
    }
}

static void simplified_mesh(golden *g, const char *name, const bvx_mesh_view *view, int32_t type, double even)
{
    static const uint64_t targets[2] = {900, 120};
    bvx_level_report reports[2];
    bvx_mesh levels[2] = {{0}};
    bvx_simplify_options o = {.struct_size = sizeof o};

    if (golden_skips(g, name)) return;
    o.targets.triangles = targets;
    o.collapse.position_type = type;
    o.targets.even = even > 0 ? even : BVX_NONE;
    o.reports = reports;
    golden_begin(g, name);
    if (golden_good(g, bvx_mesh_simplify(g->context, view, &o, 2, levels))) level_values(g, levels, reports);
    golden_end(g);
}

/* Measured on a lattice of that many voxels; 0: as it is. By errors where no targets are given. source: 1 the
 * mesh, 2 its measured surface. */
static void built_levels(golden *g, const char *name, const bvx_mesh_view *view, int32_t type,
                         int32_t resolution, int32_t sharp, const double *errors)
{
    static const uint64_t targets[2] = {1500, 100};
    bvx_level_report reports[2];
    bvx_levels_report report;
    bvx_mesh levels[2] = {{0}};
    bvx_levels_options o = {.struct_size = sizeof o};

    if (golden_skips(g, name)) return;
    if (errors == NULL) o.targets.triangles = targets;
    else o.targets.errors = errors;
    o.collapse.position_type = type;
    o.fit.resolution = resolution;
    o.sharp = BVX_SHARP_NEVER + sharp;
    o.reports = reports;
    o.report = &report;
    golden_begin(g, name);
    if (golden_good(g, bvx_build_levels(g->context, view, &o, 2, levels))) {
        golden_u64(g, "source", 1 + (uint64_t)report.solid);
        golden_u64(g, "surface", report.triangles);
        golden_u64(g, "crumbs", report.crumbs);
        level_values(g, levels, reports);
    }
    golden_end(g);
}

/* The bundled knot, read from its file. */
static void knot_levels(golden *g)
{
    static uint8_t bytes[1 << 20];
    FILE *const file = fopen("fixtures/knot.ply", "rb");
    bvx_mesh knot = {0};
    bvx_mesh_view view;
    size_t size = 0;

    if (file != NULL) {
        size = fread(bytes, 1, sizeof bytes, file);
        fclose(file);
    }
    golden_begin(g, "knot_read");
    if (golden_good(g, bvx_read_mesh(g->context, bytes, size, BVX_FORMAT_PLY, NULL, &knot)))
        golden_u64(g, "triangles", knot.triangle_count);
    golden_end(g);
    bvx_mesh_view_of(&knot, &view);
    simplified_mesh(g, "knot_f32", &view, BVX_F32, 0.000001);
    simplified_mesh(g, "knot_f64", &view, BVX_F64, 0.000001);
    bvx_mesh_free(g->context, &knot);
}

/* How fine the solid is planned for levels by samples. */
static void planned_samples(golden *g, const bvx_mesh_view *view)
{
    static const int32_t sides[2] = {40, 90};
    static const uint64_t targets[2] = {50000, 300};
    int32_t by_sides = 0, by_triangles = 0, limited = -1;
    bvx_lod_options o = {.struct_size = sizeof o};

    golden_begin(g, "torus_planned_samples");
    o.resolutions = sides;
    if (golden_good(g, bvx_plan_lods(g->context, view, &o, 2, 1, &by_sides, &limited))) {
        golden_u64(g, "by_sides", (uint64_t)by_sides);
        golden_u64(g, "limited", (uint64_t)limited);
    }
    o.resolutions = NULL;
    o.target_triangles = targets;
    if (golden_good(g, bvx_plan_lods(g->context, view, &o, 2, 0, &by_triangles, NULL)))
        golden_u64(g, "by_triangles", (uint64_t)by_triangles);
    golden_end(g);
}

static void level_cases(golden *g)
{
    static const double errors[2] = {0.02, 0.08};
    bvx_mesh_view view;

    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    shape_view(&golden_shape, &view);
    simplified_mesh(g, "torus_f32", &view, BVX_F32, 0.000001);
    simplified_mesh(g, "torus_f64", &view, BVX_F64, 0.000001);
    simplified_mesh(g, "torus_even", &view, BVX_F64, 0.5);
    view.triangle_count -= 2000;
    simplified_mesh(g, "sheet_f32", &view, BVX_F32, 0.000001);
    simplified_mesh(g, "sheet_f64", &view, BVX_F64, 0.000001);
    view.triangle_count += 2000;
    planned_samples(g, &view);
    built_levels(g, "torus_sound", &view, 0, 0, -1, NULL);
    built_levels(g, "torus_measured", &view, BVX_F32, 60, 0, NULL);
    built_levels(g, "torus_measured_f64_sharp", &view, BVX_F64, 60, 1, NULL);
    built_levels(g, "torus_by_error", &view, 0, 0, -1, errors);
    for (uint32_t t = 0; t < golden_shape.triangles; t += 7) {
        uint32_t const a = golden_shape.t[t][0];
        golden_shape.t[t][0] = golden_shape.t[t][1];
        golden_shape.t[t][1] = a;
    }
    simplified_mesh(g, "torus_turned", &view, BVX_F64, 0.000001);
    built_levels(g, "torus_flipped", &view, 0, 50, -1, NULL);
    for (uint32_t t = 0; t < golden_shape.triangles; t += 97)
        golden_shape.t[t][0] = golden_shape.t[golden_shape.triangles - 1 - t][0];
    simplified_mesh(g, "joints_cut", &view, BVX_F64, 0.000001);
    shape_soup(&golden_shape, 60, 11);
    shape_view(&golden_shape, &view);
    built_levels(g, "soup", &view, 0, 40, -1, NULL);
    shape_ball(&golden_shape, 20);
    shape_view(&golden_shape, &view);
    simplified_mesh(g, "ball_loose", &view, BVX_F64, 0.000001);
    knot_levels(g);
}

#endif
