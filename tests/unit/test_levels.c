/* test_levels.c - bvx_build_levels: meshes as they are, with what they have and no new fault;
 * solids closed, manifold and without crossing triangles, whatever the input. */
#include "tools/defect_maker.h"

#include "levels_support.h"

static bvx_levels_report found;

static bvx_levels_options defaults(void)
{
    bvx_levels_options o = {.struct_size = sizeof o};
    o.reports = report;
    o.report = &found;
    return o;
}

static void build(const bvx_levels_options *o, uint64_t count)
{
    bvx_mesh_view const view = maker_view(&mesh);
    drop_levels();
    memset(&found, 0x55, sizeof found);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_build_levels(ctx, &view, o, count, level),
                                    bvx_last_message(ctx));
}

/* Levels of a surface of that many handles and pieces; -1 pieces: any, since nobody knows. */
static void check_levels(const char *name, const uint64_t *targets, uint64_t count, int64_t euler,
                         int64_t components)
{
    for (uint64_t i = 0; i < count; i++) {
        bvx_certificate const c = certificate_of(&level[i]), first = certificate_of(&level[0]);
        snprintf(where, sizeof where, "%s, level %d: %lu triangles of %lu, %lu crumbs, %lu pieces", name,
                 (int)i, (unsigned long)level[i].triangle_count, (unsigned long)found.triangles,
                 (unsigned long)found.crumbs, (unsigned long)c.components);
        assert_whole(&level[i], components < 0 ? first.euler : euler,
                     components < 0 ? first.components : (uint64_t)components);
        assert_no_crossings(&level[i]);
        assert_report(&report[i], &level[i]);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(targets[i], report[i].target, where);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(level[i].triangle_count <= targets[i], report[i].met, where);
        TEST_ASSERT_TRUE_MESSAGE(c.volume > 0, where);
    }
}

/* All defaults, of a mesh with a hole: as with options that are all zero. */
static void test_no_options_are_the_defaults(void)
{
    bvx_levels_options o = {.struct_size = sizeof o};
    bvx_mesh plain[2] = {{0}};
    bvx_mesh_view view;

    make_shape(&level_shapes[0]);
    maker_remove(&mesh, 7);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_build_levels(ctx, &view, NULL, 2, plain),
                                    bvx_last_message(ctx));
    drop_levels();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_levels(ctx, &view, &o, 2, level));
    for (int i = 0; i < 2; i++) {
        assert_same_bytes(&plain[i], &level[i]);
        bvx_mesh_free(ctx, &plain[i]);
    }
}

/* ---- Sound meshes ---- */

static void test_a_sound_mesh_is_simplified_as_it_is(void)
{
    for (int n = 0; n < LEVEL_SHAPES; n++) {
        static const uint64_t targets[2] = {900, 200};
        bvx_mesh alone[2] = {{0}};
        bvx_levels_options o = defaults();
        bvx_simplify_options s = {.struct_size = sizeof s};
        bvx_certificate before;
        bvx_mesh_view view;
        make_shape(&level_shapes[n]);
        view = maker_view(&mesh);
        o.targets.triangles = targets;
        o.collapse.position_type = BVX_F64;
        build(&o, 2);
        check_levels(level_shapes[n].name, targets, 2, level_shapes[n].euler,
                     (int64_t)level_shapes[n].components);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(0, found.solid, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(mesh.triangles, found.triangles, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0,
                                         found.collapsed + found.doubles + found.turned + found.split +
                                             found.parted + found.cut + found.crumbs,
                                         where);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &before));
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before, &found.before, sizeof before, where);
        s.targets.triangles = targets;
        s.collapse.position_type = BVX_F64;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &s, 2, alone));
        for (int i = 0; i < 2; i++) {
            assert_same_bytes(&alone[i], &level[i]);
            bvx_mesh_free(ctx, &alone[i]);
        }
    }
}

static void add_sphere(double at, double scale, int inside_out)
{
    size_t const vertex = mesh.vertices, triangle = mesh.triangles;

    level_sphere(&mesh, &seed);
    for (size_t i = 3 * vertex; i < 3 * mesh.vertices; i++) mesh.p[i] = 8 + (mesh.p[i] - 8) * scale;
    maker_shift(&mesh, vertex, at, 0, 0);
    if (inside_out) maker_flip(&mesh, triangle, mesh.triangles);
}

/* Each way that two spheres can face, apart from and within each other: levels face as the mesh does, and a
 * solid faces outward. */
static void test_levels_face_as_the_mesh_does(void)
{
    static const struct {
        double at, scale;
        int first_out, second_out; /* 1: inside out */
        double volume, solid;      /* of a sphere's */
    } rows[] = {
        {5, 0.4, 0, 0, 2, 2},         {5, 0.4, 1, 1, -2, 2},         {5, 0.4, 0, 1, 0, 2},
        {0, 0.2, 0, 1, 0.875, 0.875}, {0, 0.2, 1, 0, -0.875, 0.875}, {0, 0.2, 0, 0, 1.125, 1},
    };
    double sphere;

    for (size_t i = 0; i < 2 * sizeof rows / sizeof rows[0]; i++) {
        static const uint64_t targets[1] = {900};
        size_t const row = i / 2;
        bvx_levels_options o = defaults();
        bvx_certificate c;
        bvx_mesh_view view;

        maker_clear(&mesh);
        add_sphere(0, 0.4, 0);
        view = maker_view(&mesh);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
        sphere = c.volume;

        maker_clear(&mesh);
        add_sphere(0, 0.4, rows[row].first_out);
        add_sphere(rows[row].at, rows[row].scale, rows[row].second_out);
        o.targets.triangles = targets;
        o.targets.samples = 1000;
        o.solid = i % 2;
        build(&o, 1);
        snprintf(where, sizeof where, "row %d, solid %d: %g of %g spheres, turned %lu, normals %g", (int)row,
                 (int)found.solid, certificate_of(&level[0]).volume / sphere, rows[row].volume,
                 (unsigned long)found.turned, report[0].distance.normal_b_to_a);
        assert_no_crossings(&level[0]);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(0.04 * sphere,
                                          (o.solid ? rows[row].solid : rows[row].volume) * sphere,
                                          certificate_of(&level[0]).volume, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, found.turned, where);
        if (!o.solid) TEST_ASSERT_TRUE_MESSAGE(report[0].distance.normal_b_to_a < 0.5, where);
    }
}

/* ---- Meshes that are not ---- */

enum {
    SPOILT_FLIPPED,
    SPOILT_OPEN,
    SPOILT_DOUBLED,
    SPOILT_OVERLAPPING,
    SPOILT_TOUCHING,
    SPOILT_SOUP,
    SPOILT_FLAT,
    SPOILT_WAYS
};
static const char *const spoilt_names[SPOILT_WAYS] = {
    "flipped", "open", "doubled", "overlapping", "touching", "soup", "with a flat triangle"};

/* Thin, so that few voxels of the 256 along the longest axis are near it. */
static void squeeze(void)
{
    for (size_t i = 0; i < 3 * mesh.vertices; i++)
        if (i % 3 != 0) mesh.p[i] = 8 + (mesh.p[i] - 8) / 8;
}

static void spoil(int way)
{
    static const double low[3] = {5, 5, 5}, high[3] = {11, 11, 11};

    make_shape(shape_named("sphere"));
    switch (way) {
    case SPOILT_FLIPPED: maker_flip(&mesh, 100, 300); break;
    case SPOILT_OPEN:
        for (int i = 0; i < 9; i++) maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        break;
    case SPOILT_DOUBLED:
        for (size_t t = 0; t < 50; t++) maker_duplicate(&mesh, 7 * t);
        break;
    case SPOILT_OVERLAPPING: {
        size_t const first = mesh.vertices;
        level_round(&mesh, &seed, 4, 0, 16);
        maker_shift(&mesh, first, 1.5, 1, 0.5);
        break;
    }
    case SPOILT_TOUCHING: { /* two cubes that share a part of a face */
        static const double a[3] = {3, 3, 3}, b[3] = {7, 7, 7}, c[3] = {7, 4, 4}, d[3] = {9, 6, 6};
        maker_clear(&mesh);
        maker_box(&mesh, a, b);
        maker_box(&mesh, c, d);
        break;
    }
    case SPOILT_FLAT: { /* an edge split on one side only, and the gap filled by a triangle without area */
        uint32_t const a = mesh.t[0], b = mesh.t[1], c = mesh.t[2];
        const double *const p = mesh.p + 3 * (size_t)a, *const q = mesh.p + 3 * (size_t)b;
        uint32_t const v = maker_vertex(&mesh, 0.5 * (p[0] + q[0]), 0.5 * (p[1] + q[1]), 0.5 * (p[2] + q[2]));
        mesh.t[1] = v;
        maker_triangle(&mesh, v, b, c);
        maker_triangle(&mesh, a, b, v);
        break;
    }
    default: maker_clear(&mesh); maker_soup(&mesh, &seed, 40, low, high, 1024);
    }
    squeeze();
}

static void test_a_solid_of_what_is_not_sound(void)
{
    for (int way = 0; way < SPOILT_WAYS; way++) {
        static const uint64_t targets[3] = {2000, 400, 60};
        bvx_levels_options o = defaults();
        if (quick && way % 3 != 0) continue;
        spoil(way);
        o.targets.triangles = targets;
        o.solid = 1;
        build(&o, 3);
        check_levels(spoilt_names[way], targets, 3, 2, way == SPOILT_SOUP ? -1 : 1);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(1, found.solid, where);
        for (int a = 0; a < 3; a++)
            TEST_ASSERT_TRUE_MESSAGE(found.repair.lattice.dims[a] <= found.planned_resolution + 16, where);
        TEST_ASSERT_TRUE_MESSAGE(found.repair.lattice.dims[0] >= found.planned_resolution / 2, where);
        TEST_ASSERT_TRUE_MESSAGE(report[0].met, where);
        if (way == SPOILT_OPEN || way == SPOILT_FLIPPED || way == SPOILT_DOUBLED || way == SPOILT_FLAT) {
            bvx_certificate whole;
            make_shape(shape_named("sphere"));
            squeeze();
            bvx_mesh_view const view = maker_view(&mesh);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &whole));
            TEST_ASSERT_TRUE_MESSAGE(
                fabs(certificate_of(&level[0]).volume - whole.volume) < 0.03 * whole.volume, where);
        }
    }
}

/* What is not sound stays as it is: parts, borders, own crossings, and no new ones. */
static void test_what_is_not_sound_stays_as_it_is(void)
{
    for (int way = 0; way < SPOILT_WAYS; way++) {
        static const uint64_t target = 300;
        bvx_levels_options o = defaults();
        bvx_certificate c, before;
        bvx_mesh_view view;
        uint64_t crossings;
        spoil(way);
        view = maker_view(&mesh);
        o.targets.triangles = &target;
        build(&o, 1);
        c = certificate_of(&level[0]);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &before));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &crossings, NULL, 0));
        snprintf(where, sizeof where, "%s: %lu triangles, %lu border edges, %lu pieces, %lu crossings of %lu",
                 spoilt_names[way], (unsigned long)c.triangles, (unsigned long)c.boundary_edges,
                 (unsigned long)c.components, (unsigned long)report[0].crossings, (unsigned long)crossings);
        TEST_ASSERT_EQUAL_INT32(0, found.solid);
        TEST_ASSERT_TRUE_MESSAGE(c.edge_manifold && c.vertex_manifold && c.oriented, where);
        TEST_ASSERT_EQUAL_INT_MESSAGE(before.closed, c.closed, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, found.cut, where);
        TEST_ASSERT_TRUE_MESSAGE(c.triangles <= mesh.triangles && c.components >= before.components, where);
        TEST_ASSERT_TRUE_MESSAGE(report[0].crossings <= crossings, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(way == SPOILT_DOUBLED ? 50 : 0, found.doubles, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(way == SPOILT_FLIPPED ? 200 : 0, found.turned, where);
    }
}

/* Turned faces of a cube: measured with its sharp edges, its twelve triangles come back. */
static void test_a_cube_with_turned_faces_has_twelve_triangles(void)
{
    static const double low[3] = {4, 4, 4}, high[3] = {12, 12, 12};
    static const uint64_t targets[2] = {400, 12}; /* no level has more than the mesh */
    bvx_levels_options o = defaults();
    bvx_distance_report d;
    bvx_mesh_view view, level_view;

    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    maker_flip(&mesh, 0, 5);
    o.targets.triangles = targets;
    o.solid = 1;
    build(&o, 2);
    check_levels("turned cube", targets, 2, 2, 1);
    bvx_mesh_view_of(&level[1], &level_view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &view, &level_view, 4000, 1, &d));
    snprintf(where, sizeof where, "%lu triangles, at most %g off", (unsigned long)level[1].triangle_count,
             d.max);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(12, level[1].triangle_count, where);
    TEST_ASSERT_TRUE_MESSAGE(d.max < 0.08, where); /* a hundredth of the side */
}

/* Every defect that a shape can have, at two targets. */
static void all_defects(int32_t resolution, int32_t sharp)
{
    defect_shape shape;

    memset(&shape, 0, sizeof shape);
    for (int kind = 0; kind < DEFECT_KINDS; kind++)
        for (int32_t which = 0; which < (defect_kinds[kind].any_shape ? DEFECT_SHAPES : 1); which++) {
            static const uint64_t targets[2] = {900, 120};
            bvx_levels_options o = defaults();
            bvx_certificate before;
            bvx_mesh_view view;
            char name[120];
            defect_begin(&shape, which, &seed, resolution);
            defect_kinds[kind].make(&shape, &seed);
            mesh = shape.mesh;
            o.fit.resolution = resolution;
            o.sharp = BVX_SHARP_NEVER + sharp;
            o.targets.triangles = targets;
            o.collapse.position_type = kind % 2 == 0 ? BVX_F32 : BVX_F64;
            snprintf(name, sizeof name, "%s with %s at %d, sharp %d", defect_shape_names[which],
                     defect_kinds[kind].name, (int)resolution, (int)sharp);
            snprintf(where, sizeof where, "%s", name);
            build(&o, 2);
            check_levels(name, targets, 2, 0, -1);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(1, found.solid, where);
            TEST_ASSERT_TRUE_MESSAGE(report[0].met, where);
            view = maker_view(&mesh);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &before));
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&before, &found.repair.before, sizeof before, where);
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(o.sharp == 1 ? found.triangles : found.repair.after.triangles,
                                             found.triangles, where);
            memset(&mesh, 0, sizeof mesh);
        }
    defect_end(&shape);
}

static void test_every_defect_gives_whole_levels(void)
{
    all_defects(20, 0);
}

static void test_every_defect_gives_whole_levels_when_sharp(void)
{
    all_defects(20, 1);
}

static void test_every_defect_gives_whole_levels_by_default(void)
{
    if (!quick) all_defects(41, -1);
}

/* ---- Options of the measured surface ---- */

static void test_outer_and_parts_and_cavities(void)
{
    static const uint64_t target = 600;
    bvx_levels_options o = defaults();

    make_shape(shape_named("shell of a cube"));
    level_round(&mesh, &seed, 0.3, 0, 6); /* a speck in the cavity, which is from 5 to 9 */
    maker_shift(&mesh, mesh.vertices - (size_t)(5 * 9 + 2), -1, -1, -1);
    o.targets.triangles = &target;
    o.fit.resolution = 60;
    build(&o, 1);
    check_levels("all", &target, 1, 6, 3);
    o.parts.least_part = 100;
    build(&o, 1);
    check_levels("no speck", &target, 1, 4, 2);
    o.parts.least_cavity = UINT64_MAX;
    build(&o, 1);
    check_levels("no cavity", &target, 1, 2, 1);
    o.parts.least_part = o.parts.least_cavity = 0;
    o.parts.keep_largest = 1;
    build(&o, 1);
    check_levels("the largest", &target, 1, 4, 2);
    TEST_ASSERT_EQUAL_UINT64(1, found.repair.parts_dropped);
    /* It asks for a solid by itself. */
    o.fit.resolution = 0;
    build(&o, 1);
    TEST_ASSERT_EQUAL_INT32(1, found.solid);
    o.fit.resolution = 60;
    o.parts.keep_largest = 0;
    o.parts.least_cavity = UINT64_MAX;
    build(&o, 1);
    check_levels("outer", &target, 1, 2, 1);
    TEST_ASSERT_EQUAL_INT32(1, found.solid);
}

static void test_a_lattice_of_the_callers(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {0.4, 0.4, 0.4};
    static const int32_t dims[3] = {40, 40, 40};
    static const uint64_t target = 500;
    bvx_lattice lattice;
    bvx_levels_options o = defaults();

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    make_shape(shape_named("torus"));
    o.fit.lattice = &lattice;
    o.targets.triangles = &target;
    build(&o, 1);
    check_levels("lattice", &target, 1, 0, 1);
    TEST_ASSERT_EQUAL_INT32(1, found.solid);
    TEST_ASSERT_EQUAL_MEMORY(&lattice, &found.repair.lattice, sizeof lattice);
}

/* Floats where nobody asked, and doubles where floats are too coarse. */
static void test_types_far_from_the_origin(void)
{
    static const uint64_t target = 300;

    for (int way = 0; way < 2; way++) {
        bvx_levels_options o = defaults();
        bvx_mesh_view view;
        uint64_t crossings = 1;
        make_shape(shape_named("sphere"));
        maker_flip(&mesh, 3, 30);
        maker_shift(&mesh, 0, way == 0 ? 0 : 1e7, 0, 0);
        o.targets.triangles = &target;
        o.fit.resolution = 40;
        build(&o, 1);
        TEST_ASSERT_EQUAL_INT32(way == 0 ? BVX_F32 : BVX_F64, level[0].position_type);
        snprintf(where, sizeof where, "way %d", way);
        assert_whole(&level[0], 2, 1);
        bvx_mesh_view_of(&level[0], &view);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &crossings, NULL, 0));
        TEST_ASSERT_EQUAL_UINT64(0, crossings);
        if (way == 1) {
            o.collapse.position_type = BVX_F32;
            view = maker_view(&mesh);
            drop_levels();
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_build_levels(ctx, &view, &o, 1, level));
            TEST_ASSERT_NULL(level[0].positions);
        }
    }
}

/* ---- Targets ---- */

static void test_errors_are_of_the_input(void)
{
    static const double errors[2] = {0.05, 0.2};

    for (int32_t kind = BVX_ERROR_MEAN; kind <= BVX_ERROR_MAX; kind++) {
        bvx_levels_options o = defaults();
        bvx_mesh_view view;
        make_shape(shape_named("torus"));
        maker_flip(&mesh, 10, 60);
        view = maker_view(&mesh);
        o.targets.errors = errors;
        o.targets.error_kind = kind;
        o.targets.samples = 2000;
        o.fit.resolution = 70;
        build(&o, 2);
        for (int i = 0; i < 2; i++) {
            bvx_mesh_view level_view;
            bvx_distance_report d;
            bvx_mesh_view_of(&level[i], &level_view);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &view, &level_view, 2000, 1, &d));
            snprintf(where, sizeof where, "kind %d, level %d: %lu triangles, mean %g, maximum %g", (int)kind,
                     i, (unsigned long)level[i].triangle_count, d.mean, d.max);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&d, &report[i].distance, sizeof d, where);
            TEST_ASSERT_EQUAL_INT32_MESSAGE((kind == BVX_ERROR_MEAN ? d.mean : d.max) <= errors[i],
                                            report[i].met, where);
            TEST_ASSERT_TRUE_MESSAGE(report[i].met, where);
            assert_whole(&level[i], 0, 1);
            assert_no_crossings(&level[i]);
        }
    }
}

/* Halving starts from the input, also where the surface that was measured has many times as many. */
static void test_halving_starts_from_the_input(void)
{
    bvx_levels_options o = defaults();

    make_shape(shape_named("cylinder"));
    maker_remove(&mesh, 7);
    o.fit.resolution = 64;
    build(&o, 3);
    TEST_ASSERT_TRUE(found.triangles > 3 * mesh.triangles);
    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_UINT64(mesh.triangles >> (i + 1), report[i].target);
        TEST_ASSERT_TRUE(report[i].met && level[i].triangle_count <= report[i].target &&
                         level[i].triangle_count + 2 > report[i].target);
    }
}

/* By error too: the measured surface has many times the mesh's triangles. */
static void test_a_solid_has_no_more_triangles_than_the_mesh(void)
{
    static const double errors[2] = {1e-9, 0.5};
    static const uint64_t targets[2] = {1 << 20, 1000};
    bvx_levels_options o = defaults();

    make_shape(shape_named("cylinder"));
    maker_remove(&mesh, 7);
    o.fit.resolution = 64;
    for (int way = 0; way < 2; way++) {
        o.targets.errors = way == 0 ? errors : NULL;
        o.targets.triangles = way == 0 ? NULL : targets;
        build(&o, 2);
        TEST_ASSERT_TRUE(found.triangles > 3 * mesh.triangles);
        for (int i = 0; i < 2; i++) TEST_ASSERT_TRUE(level[i].triangle_count <= mesh.triangles);
        TEST_ASSERT_EQUAL_INT32(way, report[0].met);
        TEST_ASSERT_EQUAL_INT32(1, report[1].met);
    }
}

static void test_distances_that_nothing_measured_are_no_numbers(void)
{
    static const double error = 0.1;
    bvx_levels_options o = defaults();
    bvx_distance_report d;
    bvx_mesh_view view, level_view;

    make_shape(shape_named("torus"));
    build(&o, 1);
    TEST_ASSERT_EQUAL_INT32(0, report[0].measured);
    TEST_ASSERT_TRUE(isnan(report[0].distance.mean) && isnan(report[0].distance.max) &&
                     isnan(report[0].distance.mean_a_to_b) && isnan(report[0].distance.max_b_to_a));

    /* A level by its error has been measured to be found. */
    o.targets.errors = &error;
    build(&o, 1);
    view = maker_view(&mesh);
    bvx_mesh_view_of(&level[0], &level_view);
    TEST_ASSERT_EQUAL_INT32(1, report[0].measured);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &view, &level_view, 20000, 1, &d));
    TEST_ASSERT_EQUAL_MEMORY(&d, &report[0].distance, sizeof d);
}

static void test_strict_refuses_what_cannot_be(void)
{
    static const uint64_t targets[2] = {200, 5};
    bvx_levels_options o = defaults();
    bvx_mesh_view view;

    o.targets.triangles = targets;
    o.targets.strict = 1;
    for (int32_t solid = 0; solid <= 1; solid++) {
        make_shape(shape_named("torus"));
        view = maker_view(&mesh);
        o.fit.resolution = solid ? 30 : 0;
        o.solid = solid;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_build_levels(ctx, &view, &o, 2, level));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), "bvx_build_levels: level 1"),
                                     bvx_last_message(ctx));
        for (int i = 0; i < 2; i++) TEST_ASSERT_NULL(level[i].positions);
    }
}

static void test_threads_do_not_matter(void)
{
    static const uint64_t targets[2] = {1500, 200};

    for (int way = 0; way < 2; way++) {
        bvx_context_options c = {.struct_size = sizeof c};
        bvx_context *other;
        bvx_levels_options o = defaults();
        bvx_levels_report more;
        bvx_level_report reports[2];
        bvx_mesh many[2] = {{0}};
        bvx_mesh_view view;
        make_shape(shape_named("dented torus"));
        if (way == 1) maker_flip(&mesh, 3, 90);
        view = maker_view(&mesh);
        o.targets.triangles = targets;
        if (way == 1) o.fit.resolution = 80;
        build(&o, 2);
        c.threads = 4;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
        o.report = &more;
        o.reports = reports;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_levels(other, &view, &o, 2, many));
        TEST_ASSERT_EQUAL_MEMORY(&found, &more, sizeof more);
        for (int i = 0; i < 2; i++) {
            snprintf(where, sizeof where, "way %d, level %d", way, i);
            assert_same_bytes(&level[i], &many[i]);
            bvx_mesh_free(other, &many[i]);
        }
        bvx_context_destroy(other);
    }
}

/* ---- The plan ---- */

static int32_t plan(const uint64_t *targets, uint64_t count)
{
    bvx_levels_options o = defaults();
    o.targets.triangles = targets;
    o.solid = 1;
    build(&o, count);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(found.resolution, found.planned_resolution, where);
    return found.planned_resolution;
}

/* It rises with the finest target, between its ends. */
static void test_the_plan(void)
{
    static const uint64_t few = 1, chain[3] = {10, 40000, 3}, many = 1000000;
    int32_t between;

    make_shape(shape_named("sphere"));
    TEST_ASSERT_EQUAL_INT32(256, plan(&few, 1));
    between = plan(chain, 3);
    TEST_ASSERT_TRUE(between > 256 && between < 320);
    TEST_ASSERT_EQUAL_INT32(320, plan(&many, 1));
}

/* ---- Refusals ---- */

static void refuse(bvx_status status, const bvx_levels_options *o, uint64_t count, const char *text)
{
    static const bvx_mesh empty[LEVELS_MOST] = {{0}};
    bvx_mesh_view const view = maker_view(&mesh);
    uint64_t const held = bvx_memory_used(ctx);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_build_levels(ctx, &view, o, count, level), text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(empty, level, sizeof empty);
    TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_used(ctx));
}

static void test_contradictions(void)
{
    static const uint64_t triangles = 100, none = 0;
    static const double error = 0.1, no_error = 0;
    bvx_lattice lattice;
    bvx_mesh_view view;
    bvx_levels_options o = defaults();

    make_shape(shape_named("cube"));
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, 20, &lattice));
    refuse(BVX_ERR_ARGUMENT, &o, 0, "level_count is 0");
    o.targets.triangles = &triangles;
    o.targets.errors = &error;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "exclude each other");
    o.targets.errors = NULL;
    o.targets.triangles = &none;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "targets.triangles[0] is 0");
    o.targets.triangles = NULL;
    o.targets.errors = &no_error;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "targets.errors[0]");
    for (int way = 0; way < 11 * 3; way++) { /* a new surface has none of the mesh's vertices */
        static const uint8_t locked[1000] = {0};

        o = defaults();
        if (way / 3 == 0) o.fit.lattice = &lattice;
        if (way / 3 == 1) o.fit.resolution = 50;
        if (way / 3 == 2) o.sign = BVX_FILL_VOTE;
        if (way / 3 == 3) o.parts.least_part = 1;
        if (way / 3 == 4) o.parts.least_cavity = 1;
        if (way / 3 == 5) o.parts.least_cavity = UINT64_MAX;
        if (way / 3 == 6) o.solid = 1;
        if (way / 3 == 7) o.sharp = BVX_SHARP_NEVER;
        if (way / 3 == 8) o.sharp = BVX_SHARP_ALWAYS;
        if (way / 3 == 9) o.shell = 3;
        if (way / 3 == 10) o.parts.keep_largest = 1;
        if (way % 3 == 0) o.collapse.lock_border = 1;
        if (way % 3 == 1) o.collapse.locked = locked;
        if (way % 3 == 2) o.collapse.vertices = BVX_VERTICES_KEPT;
        refuse(BVX_ERR_ARGUMENT, &o, 1, "measure a new surface");
        o.collapse.lock_border = 0, o.collapse.locked = NULL, o.collapse.vertices = BVX_VERTICES_PLACED,
        o.collapse.attribute_weight = 2;
        refuse(BVX_ERR_ARGUMENT, &o, 1, "has no attributes");
    }
    o = defaults();
    o.fit.lattice = &lattice;
    o.fit.resolution = 50;
    {
        bvx_status const status = bvx_build_levels(ctx, &view, &o, 1, level);
        snprintf(where, sizeof where, "a lattice and a resolution: status %d, %s", (int)status,
                 bvx_last_message(ctx));
        if (status == BVX_OK) drop_levels();
        TEST_ASSERT_TRUE_MESSAGE(status == BVX_ERR_ARGUMENT || status == BVX_OK, where);
    }
}

static void test_meshes_of_nothing(void)
{
    bvx_levels_options o = defaults();

    maker_vertex(&mesh, 1, 2, 3);
    maker_vertex(&mesh, 2, 3, 4);
    maker_vertex(&mesh, 3, 4, 5);
    refuse(BVX_ERR_EMPTY, &o, 2, "no triangles");
    maker_triangle(&mesh, 0, 1, 2);
    maker_triangle(&mesh, 0, 0, 2);
    refuse(BVX_ERR_EMPTY, &o, 2, "has an area");
    make_shape(shape_named("cube"));
    o.parts.least_part = UINT64_MAX;
    o.fit.resolution = 20;
    refuse(BVX_ERR_EMPTY, &o, 2, "bvx_");
    mesh.p[100] = (double)NAN;
    refuse(BVX_ERR_RANGE, &o, 2, "vertex 33 has y");
}

/* ---- Thin walls ---- */

/* Spikes whose tips are thinner than a voxel, side by side on a ball: it has no handle. */
static bvx_mesh_view spiky_ball(uint64_t number)
{
    static const double centre[3] = {8, 8, 8}, radius[3] = {4, 3, 3};
    uint64_t own = number;

    maker_clear(&mesh);
    maker_star(&mesh, &own, centre, radius, 0.2, 24, 24, 1 << 20);
    return maker_view(&mesh);
}

/* A level of the surface that repair makes: its distance, and what it was made from. */
static double level_of_repaired(const bvx_mesh_view *view, int32_t thin, uint64_t target,
                                bvx_repair_report *r)
{
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_simplify_options s = {.struct_size = sizeof s};
    bvx_mesh surface = {0}, small = {0};
    bvx_mesh_view repaired;
    bvx_distance_report d;

    o.fit.resolution = 64;
    o.thin = thin;
    o.report = r;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_repair(ctx, view, &o, &surface));
    bvx_mesh_view_of(&surface, &repaired);
    s.targets.triangles = &target;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &repaired, &s, 1, &small));
    bvx_mesh_view_of(&small, &repaired);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, view, &repaired, 5000, 1, &d));
    bvx_mesh_free(ctx, &small);
    bvx_mesh_free(ctx, &surface);
    return d.mean;
}

/* Where thin walls, once kept, make handles, and there are fewer without
 * them, they are not kept; else they are. */
static void test_thin_walls_do_not_make_handles(void)
{
    static const uint64_t number[6] = {16, 24, 32, 40, 48, 8}, target = 150;
    int left = 0;

    for (int i = 0; i < 6; i++) {
        bvx_mesh_view const view = spiky_ball(number[i]);
        bvx_repair_report kept, lost;
        bvx_levels_options o = {.struct_size = sizeof o};
        int is_left;
        double const with = level_of_repaired(&view, BVX_THIN_KEEP, target, &kept);

        level_of_repaired(&view, BVX_THIN_SHELL, target, &lost);
        TEST_ASSERT_TRUE(kept.thin_kept && kept.after.components == 1 && lost.after.components == 1);
        drop_levels();
        o.fit.resolution = 64;
        o.targets.triangles = &target;
        o.targets.samples = 5000;
        o.report = &found;
        o.reports = report;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_levels(ctx, &view, &o, 1, level));
        snprintf(where, sizeof where,
                 "ball %d: Euler number %d with thin walls, %d without, %d here, off by %.4f, %.4f with",
                 (int)number[i], (int)kept.after.euler, (int)lost.after.euler,
                 (int)report[0].certificate.euler, report[0].distance.mean, with);
        left += is_left = kept.after.euler < lost.after.euler &&
                          kept.after.area - lost.after.area < 0.01 * kept.after.area;
        TEST_ASSERT_EQUAL_INT_MESSAGE(!is_left, found.repair.thin_kept, where);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(is_left ? lost.after.euler : kept.after.euler,
                                        report[0].certificate.euler, where);
        TEST_ASSERT_TRUE_MESSAGE(is_left ? report[0].distance.mean < with : report[0].distance.mean == with,
                                 where);
    }
    TEST_ASSERT_TRUE(left >= 3 && left < 6);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_no_options_are_the_defaults);
    RUN_TEST(test_a_sound_mesh_is_simplified_as_it_is);
    RUN_TEST(test_levels_face_as_the_mesh_does);
    RUN_TEST(test_a_solid_of_what_is_not_sound);
    RUN_TEST(test_what_is_not_sound_stays_as_it_is);
    RUN_TEST(test_a_solid_has_no_more_triangles_than_the_mesh);
    RUN_TEST(test_distances_that_nothing_measured_are_no_numbers);
    RUN_TEST(test_a_cube_with_turned_faces_has_twelve_triangles);
    RUN_TEST(test_every_defect_gives_whole_levels);
    RUN_TEST(test_every_defect_gives_whole_levels_when_sharp);
    RUN_TEST(test_every_defect_gives_whole_levels_by_default);
    RUN_TEST(test_outer_and_parts_and_cavities);
    RUN_TEST(test_a_lattice_of_the_callers);
    RUN_TEST(test_types_far_from_the_origin);
    RUN_TEST(test_errors_are_of_the_input);
    RUN_TEST(test_halving_starts_from_the_input);
    RUN_TEST(test_strict_refuses_what_cannot_be);
    RUN_TEST(test_threads_do_not_matter);
    RUN_TEST(test_the_plan);
    RUN_TEST(test_contradictions);
    RUN_TEST(test_meshes_of_nothing);
    RUN_TEST(test_thin_walls_do_not_make_handles);
    return UNITY_END();
}
