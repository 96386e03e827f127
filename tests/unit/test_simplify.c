/* test_simplify.c - bvx_mesh_simplify: every level closed, manifold and without
 * crossing triangles, as many handles and pieces as before; shapes of planes come down
 * to their corners; the same bytes for every order of the input; targets of all kinds. */
#include "../golden/shapes.h"

#include "levels_support.h"

static bvx_simplify_options defaults(void)
{
    bvx_simplify_options o = {.struct_size = sizeof o};
    o.reports = report;
    return o;
}

static void simplify_view(const bvx_mesh_view *view, const bvx_simplify_options *o, uint64_t count)
{
    drop_levels();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, view, o, count, level),
                                    bvx_last_message(ctx));
}

static void simplify(const bvx_simplify_options *o, uint64_t count)
{
    bvx_mesh_view const view = maker_view(&mesh);
    simplify_view(&view, o, count);
}

static void to_targets(const uint64_t *targets, uint64_t count, int32_t type)
{
    bvx_simplify_options o = defaults();
    o.targets.triangles = targets;
    o.collapse.position_type = type;
    simplify(&o, count);
}

/* ---- The guarantee ---- */

/* A shape is what it says it is: else the tests below test nothing. */
static void test_shapes_are_whole_and_do_not_cross(void)
{
    for (int i = 0; i < LEVEL_SHAPES; i++) {
        bvx_mesh given = {0};
        make_shape(&level_shapes[i]);
        snprintf(where, sizeof where, "%s: %lu triangles", level_shapes[i].name,
                 (unsigned long)mesh.triangles);
        given.positions = mesh.p;
        given.triangles = mesh.t;
        given.vertex_count = given.vertex_capacity = mesh.vertices;
        given.triangle_count = given.triangle_capacity = mesh.triangles;
        given.position_type = BVX_F64;
        assert_whole(&given, level_shapes[i].euler, level_shapes[i].components);
        assert_no_crossings(&given);
        TEST_ASSERT_TRUE_MESSAGE(certificate_of(&given).volume > 0, where);
    }
}

/* Four levels down to as few as there can be; the last has met 0 unless one
 * triangle was reached, which cannot be. */
static void check_shape(const level_shape *s, int32_t type, double even)
{
    uint64_t targets[4];
    bvx_simplify_options o = defaults();

    make_shape(s);
    targets[0] = mesh.triangles / 2;
    targets[1] = mesh.triangles / 6;
    targets[2] = mesh.triangles / 24;
    targets[3] = 1;
    o.targets.triangles = targets;
    o.collapse.position_type = type;
    o.targets.even = even > 0 ? even : BVX_NONE;
    simplify(&o, 4);
    for (int i = 0; i < 4; i++) {
        snprintf(where, sizeof where, "%s, type %d, even %g, level %d: %lu of %lu triangles", s->name,
                 (int)type, even, i, (unsigned long)level[i].triangle_count, (unsigned long)targets[i]);
        assert_whole(&level[i], s->euler, s->components);
        assert_no_crossings(&level[i]);
        assert_report(&report[i], &level[i]);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(targets[i], report[i].target, where);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(level[i].triangle_count <= targets[i], report[i].met, where);
        if (i > 0) TEST_ASSERT_TRUE_MESSAGE(level[i].triangle_count <= level[i - 1].triangle_count, where);
        if (s->fewest == 0 || targets[i] >= s->fewest) /* a collapse takes two */
            TEST_ASSERT_TRUE_MESSAGE(!report[i].met || level[i].triangle_count + 2 > targets[i], where);
    }
    /* With as strong a pull as planes have the bent sheet keeps triangles that nothing turns over. */
    TEST_ASSERT_TRUE_MESSAGE(report[0].met || (even >= 1 && s == shape_named("bent sheet")), where);
    TEST_ASSERT_FALSE_MESSAGE(report[3].met, where);
}

static void test_every_level_keeps_the_guarantee(void)
{
    for (int i = 0; i < LEVEL_SHAPES; i++) check_shape(&level_shapes[i], BVX_F64, 0.000001);
}

static void test_every_level_of_floats_keeps_the_guarantee(void)
{
    for (int i = 0; i < LEVEL_SHAPES; i++) check_shape(&level_shapes[i], BVX_F32, 0.000001);
}

static void test_even_0_and_1_keep_the_guarantee(void)
{
    for (int i = 0; i < LEVEL_SHAPES; i += quick ? 3 : 1) {
        check_shape(&level_shapes[i], BVX_F64, 0);
        check_shape(&level_shapes[i], BVX_F64, 1);
    }
}

/* Bits of a lattice at random: pinched solids, thin walls, corners everywhere. */
static void test_surfaces_of_random_bits_keep_the_guarantee(void)
{
    static const double origin[3] = {2, 2, 2}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {11, 12, 10};
    bvx_lattice lattice;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    for (int every = 2; every < 9; every += quick ? 3 : 1)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            static const uint64_t targets[3] = {1500, 600, 1};
            bvx_grid noise = {0};
            bvx_mesh surface = {0};
            bvx_mesh_view view;
            bvx_certificate before;
            bvx_simplify_options o = defaults();
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &noise));
            for (int32_t z = 0; z < dims[2]; z++)
                for (int32_t y = 0; y < dims[1]; y++)
                    for (int32_t x = 0; x < dims[0]; x++)
                        bvx_grid_set(&noise, x, y, z, maker_below(&seed, every) == 0);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &noise, NULL, &surface));
            before = certificate_of(&surface);
            bvx_mesh_view_of(&surface, &view);
            o.targets.triangles = targets;
            o.collapse.position_type = type;
            simplify_view(&view, &o, 3);
            for (int i = 0; i < 3; i++) {
                snprintf(where, sizeof where, "one bit in %d, type %d, level %d: %lu of %lu triangles", every,
                         (int)type, i, (unsigned long)level[i].triangle_count,
                         (unsigned long)view.triangle_count);
                assert_whole(&level[i], before.euler, before.components);
                assert_no_crossings(&level[i]);
                assert_report(&report[i], &level[i]);
            }
            bvx_mesh_free(ctx, &surface);
            bvx_grid_free(ctx, &noise);
        }
}

/* Rods a voxel thick, along all axes: thinner than the triangles of a small level are long. */
static void make_rods(int32_t side, int32_t apart, bvx_mesh *surface)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {side, side, side};
    bvx_grid rods = {0};
    bvx_lattice lattice;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &rods));
    for (int32_t z = 0; z < side; z++)
        for (int32_t y = 0; y < side; y++)
            for (int32_t x = 0; x < side; x++)
                bvx_grid_set(&rods, x, y, z, (x % apart == 0) + (y % apart == 0) + (z % apart == 0) >= 2);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &rods, NULL, surface));
    bvx_grid_free(ctx, &rods);
}

/* A target that only crumpled rods keep is not met: what remains looks like rods. */
static void test_thin_parts_do_not_crumple(void)
{
    static const uint64_t targets[2] = {4000, 4};
    bvx_simplify_options o = defaults();
    bvx_mesh surface = {0};
    bvx_mesh_view view;

    make_rods(41, 10, &surface);
    bvx_mesh_view_of(&surface, &view);
    o.targets.triangles = targets;
    o.targets.samples = 4000;
    simplify_view(&view, &o, 2);
    snprintf(where, sizeof where, "%d triangles, mean %g and %g, max %g", (int)level[1].triangle_count,
             report[1].distance.mean_a_to_b, report[1].distance.mean_b_to_a, report[1].distance.max);
    TEST_ASSERT_TRUE_MESSAGE(report[0].met && report[0].distance.max < 0.5, where);
    TEST_ASSERT_TRUE_MESSAGE(!report[1].met && report[1].refused != 0, where);
    TEST_ASSERT_TRUE_MESSAGE(report[1].distance.mean_a_to_b < 0.3 && report[1].distance.mean_b_to_a < 0.5 &&
                                 report[1].distance.max < 4,
                             where);
    bvx_mesh_free(ctx, &surface);
}

/* ---- Planes ---- */

static int is_at(const double *a, const double p[3])
{
    return fabs(a[0] - p[0]) + fabs(a[1] - p[1]) + fabs(a[2] - p[2]) < 1e-12;
}

/* 1 when three facets of the given mesh that lie in different planes meet there. */
static int is_corner(const double p[3])
{
    double n[64][3];
    int count = 0;

    for (size_t t = 0; t < mesh.triangles; t++)
        for (int k = 0; k < 3; k++) {
            const double *const a = mesh.p + 3 * (size_t)mesh.t[3 * t + (size_t)k];
            const double *const b = mesh.p + 3 * (size_t)mesh.t[3 * t + (size_t)(k + 1) % 3];
            const double *const c = mesh.p + 3 * (size_t)mesh.t[3 * t + (size_t)(k + 2) % 3];
            if (!is_at(a, p) || count == 64) continue;
            for (int i = 0; i < 3; i++) {
                int const j = (i + 1) % 3, l = (i + 2) % 3;
                n[count][i] = (b[j] - a[j]) * (c[l] - a[l]) - (b[l] - a[l]) * (c[j] - a[j]);
            }
            count++;
        }
    for (int i = 0; i < count; i++)
        for (int j = 0; j < i; j++)
            for (int l = 0; l < j; l++) {
                double det = 0;
                for (int k = 0; k < 3; k++)
                    det += n[i][k] *
                           (n[j][(k + 1) % 3] * n[l][(k + 2) % 3] - n[j][(k + 2) % 3] * n[l][(k + 1) % 3]);
                if (det != 0) return 1;
            }
    return 0;
}

/* Finely divided, a shape comes down to the fewest triangles that have its
 * corners, and these are where they were. */
static double off; /* of the last shape that came down */

static int comes_down_exactly(const level_shape *s, int32_t type, double even)
{
    bvx_mesh_view level_view, view;
    bvx_simplify_options o = defaults();
    bvx_distance_report d;
    int exact = 1;

    make_shape(s);
    o.targets.triangles = &s->fewest;
    o.collapse.position_type = type;
    o.targets.even = even > 0 ? even : BVX_NONE;
    simplify(&o, 1);
    view = maker_view(&mesh);
    bvx_mesh_view_of(&level[0], &level_view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &view, &level_view, 2000, 1, &d));
    for (uint64_t v = 0; v < level[0].vertex_count; v++) {
        double const p[3] = {position_of(&level[0], 3 * v), position_of(&level[0], 3 * v + 1),
                             position_of(&level[0], 3 * v + 2)};
        exact &= is_corner(p);
    }
    snprintf(where, sizeof where, "%s, type %d, even %g: %lu triangles in place of %lu, at most %g off",
             s->name, (int)type, even, (unsigned long)level[0].triangle_count, (unsigned long)s->fewest,
             d.max);
    off = d.max;
    return exact && level[0].triangle_count == s->fewest && d.max < 1e-12;
}

/* Without a pull towards even triangles nothing but the planes decides. */
static void test_planes_come_down_to_their_corners(void)
{
    for (int32_t type = BVX_F32; type <= BVX_F64; type++)
        for (int n = 0; n < LEVEL_SHAPES; n++) {
            const level_shape *const s = &level_shapes[n];
            if (s->fewest == 0 || s == shape_named("thin plate") || s == shape_named("wedge of 10 degrees"))
                continue;
            TEST_ASSERT_TRUE_MESSAGE(comes_down_exactly(s, type, 0), where);
        }
}

/* Sides that meet at a sharp angle, and sides of hardly any area. */
static void test_planes_that_meet_at_ten_degrees_keep_their_corners(void)
{
    for (int32_t type = BVX_F32; type <= BVX_F64; type++)
        TEST_ASSERT_TRUE_MESSAGE(comes_down_exactly(shape_named("wedge of 10 degrees"), type, 0), where);
}

static void test_a_thin_plate_keeps_its_corners(void)
{
    for (int32_t type = BVX_F32; type <= BVX_F64; type++)
        TEST_ASSERT_TRUE_MESSAGE(comes_down_exactly(shape_named("thin plate"), type, 0), where);
}

/* The default pull moves corners by little: most where sides have hardly any area, as a thin plate has. */
static void test_planes_keep_their_corners_by_default(void)
{
    bvx_simplify_options const o = defaults();

    for (int n = 0; n < LEVEL_SHAPES; n++) {
        if (level_shapes[n].fewest == 0) continue;
        if (comes_down_exactly(&level_shapes[n], BVX_F64, o.targets.even)) continue;
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(level_shapes[n].fewest, level[0].triangle_count, where);
        TEST_ASSERT_TRUE_MESSAGE(off < 5e-5, where);
    }
}

/* ---- Every order and type of the input ---- */

/* The same mesh in every way that a view can hold it gives the same bytes, and the same reports. */
static void check_order_and_types(const uint64_t *targets, const double *errors)
{
    static const char *const names[] = {"dented torus", "octagonal prism", "cylinder", "spikes",
                                        "bent plates"};

    for (size_t n = 0; n < sizeof names / sizeof *names; n++)
        for (int way = 0; way < 9; way++) {
            bvx_mesh wanted[2];
            bvx_level_report told[2];
            bvx_mesh_view view;
            bvx_simplify_options o = defaults();
            void *made = NULL, *spread = NULL;
            make_shape(shape_named(names[n]));
            for (size_t i = 0; i < 3 * mesh.vertices; i++) mesh.p[i] = (double)(float)mesh.p[i];
            o.targets.triangles = targets;
            o.targets.errors = errors;
            o.targets.samples = 300;
            o.collapse.position_type = BVX_F64;
            simplify(&o, 2);
            memcpy(wanted, level, sizeof wanted);
            memcpy(told, report, sizeof told);
            memset(level, 0, sizeof level);
            if (way == 0 || way == 2) maker_shuffle_vertices(&mesh, &seed);
            if (way == 1 || way == 2) maker_shuffle_triangles(&mesh, &seed);
            view = maker_view(&mesh);
            if (way == 3 || way == 5) { /* floats, with other things between */
                float *const f = made = maker_grow(NULL, mesh.vertices * 20);
                for (size_t v = 0; v < mesh.vertices; v++)
                    for (size_t a = 0; a < 5; a++) f[5 * v + a] = a < 3 ? (float)mesh.p[3 * v + a] : NAN;
                view.positions = f;
                view.position_type = BVX_F32;
                view.position_stride = 20;
            }
            if (way == 4 || way == 5) {
                uint16_t *const u = spread = maker_grow(NULL, mesh.triangles * 6);
                for (size_t i = 0; i < 3 * mesh.triangles; i++) u[i] = (uint16_t)mesh.t[i];
                view.indices = u;
                view.index_type = BVX_U16;
            }
            if (way == 6) {
                uint64_t *const u = spread = maker_grow(NULL, mesh.triangles * 24);
                for (size_t i = 0; i < 3 * mesh.triangles; i++) u[i] = mesh.t[i];
                view.indices = u;
                view.index_type = BVX_U64;
            }
            /* corners one after the other, as in an STL file; then with
             * indices and vertices that nobody uses */
            if (way == 7 || way == 8) {
                double *const p = made = maker_grow(NULL, mesh.triangles * 72 + 24);
                uint32_t *const t = spread = maker_grow(NULL, mesh.triangles * 12);
                for (size_t i = 0; i < 3 * mesh.triangles; i++) {
                    memcpy(p + 3 * i, mesh.p + 3 * (size_t)mesh.t[i], 24);
                    t[i] = (uint32_t)i;
                }
                for (size_t a = 0; a < 3; a++) p[9 * mesh.triangles + a] = mesh.p[a];
                view.positions = p;
                view.vertex_count = 3 * mesh.triangles + (way == 8);
                view.indices = way == 8 ? t : NULL;
            }
            simplify_view(&view, &o, 2);
            for (int i = 0; i < 2; i++) {
                snprintf(where, sizeof where, "%s, way %d, level %d", names[n], way, i);
                assert_same_bytes(&wanted[i], &level[i]);
                TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&told[i], &report[i], sizeof told[i], where);
                bvx_mesh_free(ctx, &wanted[i]);
            }
            free(made);
            free(spread);
        }
}

static void test_order_and_types_of_the_input_do_not_matter(void)
{
    static const uint64_t targets[2] = {700, 150};

    check_order_and_types(targets, NULL);
}

/* Errors close to those of the tries, so that another sample here or there
 * would end a level a step earlier or later. */
static void test_order_and_types_do_not_matter_by_error(void)
{
    for (int n = 1; n < 6; n += long_run ? 1 : 4) {
        double const errors[2] = {0.003 * n, 0.02 * n};

        check_order_and_types(NULL, errors);
    }
}

static void test_threads_do_not_matter(void)
{
    static const uint64_t targets[3] = {2000, 500, 100};
    bvx_context_options c = {.struct_size = sizeof c};
    bvx_context *other;
    bvx_mesh many[3] = {{0}};
    bvx_simplify_options o = defaults();
    bvx_level_report more[3];
    bvx_mesh_view view;

    make_shape(shape_named("torus"));
    view = maker_view(&mesh);
    o.targets.triangles = targets;
    o.targets.samples = 500;
    simplify(&o, 3);
    c.threads = 4;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
    o.reports = more;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(other, &view, &o, 3, many));
    for (int i = 0; i < 3; i++) {
        snprintf(where, sizeof where, "level %d", i);
        assert_same_bytes(&level[i], &many[i]);
        TEST_ASSERT_EQUAL_MEMORY(&report[i], &more[i], sizeof more[i]);
        bvx_mesh_free(other, &many[i]);
    }
    bvx_context_destroy(other);
}

/* Of a mesh that crosses itself all over, with errors as targets too. */
static void test_reports_do_not_matter(void)
{
    static const double centre[3] = {8, 8, 8}, radius[3] = {4, 4, 3}, errors[3] = {0.05, 0.1, 0.3};
    static const uint64_t targets[3] = {1500, 700, 200};

    for (int way = 0; way < 4; way++) {
        bvx_simplify_options o = defaults();
        bvx_mesh_view view;
        bvx_mesh plain[3] = {{0}};

        maker_clear(&mesh);
        maker_star(&mesh, &seed, centre, radius, way < 2 ? 0.1 : 0.3, 30, 40, 1 << 20);
        maker_star(&mesh, &seed, centre, radius, 0.05, 30, 40, 1 << 20);
        view = maker_view(&mesh);
        if (way % 2 == 0) o.targets.triangles = targets;
        else o.targets.errors = errors;
        o.targets.samples = 500;
        simplify(&o, 3);
        o.reports = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 3, plain));
        for (int i = 0; i < 3; i++) {
            snprintf(where, sizeof where, "way %d, level %d", way, i);
            assert_same_bytes(&level[i], &plain[i]);
            bvx_mesh_free(ctx, &plain[i]);
        }
    }
}

/* A million units away, in doubles and in floats, whose steps are a sixteenth there: the same guarantee. */
static void test_meshes_far_from_the_origin_keep_the_guarantee(void)
{
    static const uint64_t targets[3] = {800, 200, 1};

    for (int32_t type = BVX_F32; type <= BVX_F64; type++)
        for (int n = 0; n < LEVEL_SHAPES; n++) {
            const level_shape *const s = &level_shapes[n];
            uint64_t before = 0;
            bvx_mesh_view const *view;
            bvx_mesh_view far_view;
            make_shape(s);
            for (size_t i = 0; i < 3 * mesh.vertices; i++)
                mesh.p[i] = type == BVX_F32 ? (double)(float)(mesh.p[i] * 16384 + 1e6) : mesh.p[i] + 1e6;
            far_view = maker_view(&mesh);
            view = &far_view;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, view, &before, NULL, 0));
            if (before != 0) continue; /* its own rounding made it cross */
            to_targets(targets, 3, type);
            for (int i = 0; i < 3; i++) {
                uint64_t count = 1;
                bvx_mesh_view level_view;
                snprintf(where, sizeof where, "%s far away, type %d, level %d", s->name, (int)type, i);
                assert_whole(&level[i], s->euler, s->components);
                bvx_mesh_view_of(&level[i], &level_view);
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &level_view, &count, NULL, 0));
                TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, count, where);
            }
        }
}

/* ---- Targets ---- */

static void test_levels_without_targets_halve(void)
{
    bvx_simplify_options o = defaults();
    uint64_t wanted;

    make_shape(shape_named("sphere"));
    wanted = mesh.triangles;
    simplify(&o, 4);
    for (int i = 0; i < 4; i++) {
        wanted /= 2;
        TEST_ASSERT_EQUAL_UINT64(wanted, report[i].target);
        TEST_ASSERT_EQUAL_UINT64(wanted - wanted % 2, level[i].triangle_count);
        TEST_ASSERT_EQUAL_INT32(1, report[i].met);
        TEST_ASSERT_EQUAL_INT32(0, report[i].measured);
        TEST_ASSERT_EQUAL_INT32(BVX_F64, level[i].position_type);
    }
}

/* The first levels of a chain are those of a shorter chain, and its targets need not fall. */
/* Beyond 63 halvings nothing is left of any count: the last levels are the smallest that is not crumpled, and none is
 * met. */
static void test_more_halvings_than_a_count_has_bits(void)
{
    static bvx_mesh many[70];
    static bvx_level_report told[70];
    bvx_simplify_options o = defaults();
    bvx_mesh_view view;

    make_shape(shape_named("cube"));
    view = maker_view(&mesh);
    o.reports = told;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 70, many));
    TEST_ASSERT_EQUAL_UINT64(mesh.triangles / 2, told[0].target);
    for (int i = 62; i < 70; i++) {
        TEST_ASSERT_EQUAL_UINT64(0, told[i].target);
        TEST_ASSERT_EQUAL_INT32(0, told[i].met);
        TEST_ASSERT_EQUAL_UINT64(6, many[i].triangle_count);
    }
    for (int i = 70; i-- > 0;) bvx_mesh_free(ctx, &many[i]);
}

static void test_a_chain_goes_on_from_level_to_level(void)
{
    static const uint64_t targets[4] = {1500, 600, 600, 900};
    bvx_mesh chain[4];

    make_shape(shape_named("dented torus"));
    to_targets(targets, 4, 0);
    memcpy(chain, level, sizeof chain);
    memset(level, 0, sizeof level);
    for (int i = 0; i < 4; i++) TEST_ASSERT_EQUAL_INT32(1, report[i].met);
    snprintf(where, sizeof where, "equal targets");
    assert_same_bytes(&chain[1], &chain[2]);
    TEST_ASSERT_EQUAL_UINT64(600, chain[3].triangle_count); /* from the one before */
    for (uint64_t n = 1; n < 4; n++) {
        to_targets(targets, n, 0);
        for (uint64_t i = 0; i < n; i++) {
            snprintf(where, sizeof where, "level %d of %d", (int)i, (int)n);
            assert_same_bytes(&chain[i], &level[i]);
        }
    }
    for (int i = 0; i < 4; i++) bvx_mesh_free(ctx, &chain[i]);
}

static void test_a_target_of_all_gives_the_mesh_back(void)
{
    uint64_t target;
    bvx_mesh_view view, level_view;
    bvx_distance_report d;

    make_shape(shape_named("spikes"));
    target = mesh.triangles;
    to_targets(&target, 1, 0);
    view = maker_view(&mesh);
    bvx_mesh_view_of(&level[0], &level_view);
    TEST_ASSERT_EQUAL_UINT64(mesh.triangles, level[0].triangle_count);
    TEST_ASSERT_EQUAL_UINT64(mesh.vertices, level[0].vertex_count);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &view, &level_view, 500, 1, &d));
    TEST_ASSERT_TRUE(d.max < 1e-14);
}

/* Measured again, with other points. */
static void check_errors(const char *name, int32_t kind, const double *errors, uint64_t count)
{
    bvx_simplify_options o = defaults();
    bvx_mesh_view const *view;
    bvx_mesh_view all;

    make_shape(shape_named(name));
    all = maker_view(&mesh);
    view = &all;
    o.targets.errors = errors;
    o.targets.error_kind = kind;
    o.targets.samples = 4000;
    simplify(&o, count);
    for (uint64_t i = 0; i < count; i++) {
        bvx_mesh_view level_view;
        bvx_distance_report d, again;
        bvx_mesh_view_of(&level[i], &level_view);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, view, &level_view, 4000, 1, &again));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, view, &level_view, 20000, 99, &d));
        snprintf(where, sizeof where, "%s, kind %d, level %d: %lu triangles, mean %g, maximum %g, allowed %g",
                 name, (int)kind, (int)i, (unsigned long)level[i].triangle_count, d.mean, d.max, errors[i]);
        assert_report(&report[i], &level[i]);
        assert_no_crossings(&level[i]);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(1, report[i].met, where);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(1, report[i].measured, where);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&again, &report[i].distance, sizeof again, where);
        TEST_ASSERT_TRUE_MESSAGE(report[i].target == 0 && report[i].target_error == errors[i], where);
        TEST_ASSERT_TRUE_MESSAGE((kind == BVX_ERROR_MEAN ? again.mean : again.max) <= errors[i], where);
        TEST_ASSERT_TRUE_MESSAGE((kind == BVX_ERROR_MEAN ? d.mean : d.max) <= 1.1 * errors[i], where);
        TEST_ASSERT_TRUE_MESSAGE(level[i].triangle_count < view->triangle_count, where);
        if (i > 0) TEST_ASSERT_TRUE_MESSAGE(level[i].triangle_count < level[i - 1].triangle_count, where);
        /* and it is used */
        TEST_ASSERT_TRUE_MESSAGE((kind == BVX_ERROR_MEAN ? d.mean : d.max) > errors[i] / 4, where);
    }
}

static void test_errors_are_kept_and_used(void)
{
    static const double mean[3] = {0.01, 0.03, 0.1}, most[3] = {0.05, 0.15, 0.5};
    check_errors("sphere", BVX_ERROR_MEAN, mean, 3);
    check_errors("sphere", BVX_ERROR_MAX, most, 3);
    check_errors("torus", BVX_ERROR_MEAN, mean, 3);
    check_errors("torus", BVX_ERROR_MAX, most, 3);
}

/* The second error of a chain gives what it would give alone, or fewer: no level has more than it must. */
static void test_an_error_below_every_collapse_keeps_the_mesh(void)
{
    static const double error = 1e-9, most = 1e9;
    bvx_simplify_options o = defaults();

    make_shape(shape_named("spikes"));
    o.targets.errors = &error;
    simplify(&o, 1);
    snprintf(where, sizeof where, "%lu of %lu triangles", (unsigned long)level[0].triangle_count,
             (unsigned long)mesh.triangles);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(mesh.triangles, level[0].triangle_count, where);
    TEST_ASSERT_EQUAL_INT32(1, report[0].met);
    o.targets.errors = &most;
    o.targets.strict = 1;
    simplify(&o, 1);
    TEST_ASSERT_EQUAL_INT32(1, report[0].met);
    assert_whole(&level[0], 2, 1);
    TEST_ASSERT_TRUE(level[0].triangle_count < 60);
}

/* A step too far has left the first level behind. What the second one may not be worse than is that level. */
static void test_an_error_that_the_way_has_passed_by_gives_the_level_before(void)
{
    static const double near[2] = {0.05, 0.0501}, less[2] = {0.05, 1e-9};
    bvx_simplify_options o = defaults();
    bvx_mesh_view view;

    make_shape(shape_named("torus"));
    view = maker_view(&mesh);
    for (int k = 0; k < 2; k++) {
        o.targets.errors = k == 0 ? near : less;
        simplify(&o, 2);
        TEST_ASSERT_EQUAL_INT32(1, report[0].met);
        TEST_ASSERT_EQUAL_INT32(k == 0, report[1].met);
        TEST_ASSERT_EQUAL_UINT64(level[0].triangle_count, level[1].triangle_count);
        TEST_ASSERT_TRUE(level[0].positions != level[1].positions);
        drop_levels();
    }

    /* The fewest triangles have nothing to do with it. */
    o.targets.strict = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_mesh_simplify(ctx, &view, &o, 2, level));
    TEST_ASSERT_EQUAL_INT32(BVX_REASON_TARGET, bvx_last_error(ctx)->reason);
    TEST_ASSERT_EQUAL_INT64(1, bvx_last_error(ctx)->index);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), "off by more than 1e-9 already"),
                                 bvx_last_message(ctx));
}

/* Nearly all of the error is used: a twentieth more of the triangles would not do. */
static void test_an_error_is_used_up(void)
{
    double const errors[1] = {0.01};
    bvx_simplify_options o = defaults();
    double part;

    make_shape(shape_named("torus"));
    o.targets.errors = errors;
    o.targets.samples = 20000;
    simplify(&o, 1);
    part = report[0].distance.mean / errors[0];
    snprintf(where, sizeof where, "%g of the error", part);
    TEST_ASSERT_TRUE_MESSAGE(part > 0.85 && part <= 1, where);
}

/* A torus has seven vertices at least, and 14 triangles; where the
 * guarantee stops before is not known, but near. */
static void test_a_torus_is_not_reduced_below_its_handle(void)
{
    static const uint64_t targets[2] = {10, 2};
    bvx_simplify_options o = defaults();

    make_shape(shape_named("torus"));
    o.targets.triangles = targets;
    simplify(&o, 2);
    for (int i = 0; i < 2; i++) {
        snprintf(where, sizeof where, "level %d: %lu triangles", i, (unsigned long)level[i].triangle_count);
        TEST_ASSERT_TRUE_MESSAGE(level[i].triangle_count >= 14 && level[i].triangle_count <= 60, where);
        TEST_ASSERT_EQUAL_INT32(0, report[i].met);
        TEST_ASSERT_TRUE(report[i].refused > 0);
        assert_whole(&level[i], 0, 1);
        assert_no_crossings(&level[i]);
    }
    {
        bvx_mesh_view const view = maker_view(&mesh);
        bvx_mesh const empty = {0};
        uint64_t const one = 1000, none[3] = {1000, 400, 3};
        drop_levels();
        o.targets.strict = 1;
        o.targets.triangles = none;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_mesh_simplify(ctx, &view, &o, 3, level));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), "bvx_mesh_simplify: level 2"),
                                     bvx_last_message(ctx));
        for (int i = 0; i < 3; i++) TEST_ASSERT_EQUAL_MEMORY(&empty, &level[i], sizeof empty);
        o.targets.triangles = &one;
        simplify(&o, 1);
        TEST_ASSERT_EQUAL_INT32(1, report[0].met);
    }
}

/* Nothing can go, and what nobody uses is not there. */
static void test_a_tetrahedron_stays_and_unused_vertices_go(void)
{
    static const double corner[15] = {5, 5, 5, 3, 3, 3, 9, 3, 3, 3, 9, 3, 3, 3, 9};
    static const uint64_t one = 1;

    for (int i = 0; i < 5; i++) maker_vertex(&mesh, corner[3 * i], corner[3 * i + 1], corner[3 * i + 2]);
    maker_tetrahedron(&mesh, 1, 2, 3, 4);
    to_targets(&one, 1, 0);
    TEST_ASSERT_EQUAL_UINT64(4, level[0].triangle_count);
    TEST_ASSERT_EQUAL_UINT64(4, level[0].vertex_count);
    TEST_ASSERT_EQUAL_INT32(0, report[0].met);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 45, report[0].least_angle);
}

/* A body without any volume, two facets that lie on each other: closed, and
 * all of it crosses; it gives an answer, not a wrong one. */
static void test_a_flat_body_is_closed_or_refused(void)
{
    static const uint64_t one = 1;
    bvx_mesh_view view;
    bvx_simplify_options o = defaults();
    bvx_status status;

    make_shape(shape_named("cube"));
    for (size_t v = 0; v < mesh.vertices; v++) mesh.p[3 * v + 2] = 5;
    view = maker_view(&mesh);
    o.targets.triangles = &one;
    status = bvx_mesh_simplify(ctx, &view, &o, 1, level);
    if (status == BVX_OK) {
        bvx_certificate const c = certificate_of(&level[0]);
        TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.oriented);
    } else {
        TEST_ASSERT_TRUE(status == BVX_ERR_ARGUMENT || status == BVX_ERR_EMPTY);
    }
}

/* ---- Arrays of the caller's ---- */

static void test_levels_fill_the_callers_arrays_or_refuse_small_ones(void)
{
    static const uint64_t targets[2] = {1000, 300};
    static double p[2][3 * 600];
    static uint32_t t[2][3 * 1000];
    bvx_mesh wanted[2];
    bvx_mesh_view view;
    bvx_simplify_options o = defaults();

    make_shape(shape_named("sphere"));
    view = maker_view(&mesh);
    to_targets(targets, 2, BVX_F64);
    memcpy(wanted, level, sizeof wanted);
    memset(level, 0, sizeof level);
    o.targets.triangles = targets;
    for (int small = 0; small < 2; small++) {
        for (int i = 0; i < 2; i++) {
            memset(&level[i], 0, sizeof level[i]);
            level[i].positions = p[i];
            level[i].triangles = t[i];
            level[i].vertex_capacity = small && i == 1 ? 100 : 600;
            level[i].triangle_capacity = 1000;
            level[i].position_type = BVX_F64;
        }
        TEST_ASSERT_EQUAL_INT32_MESSAGE(small ? BVX_ERR_CAPACITY : BVX_OK,
                                        bvx_mesh_simplify(ctx, &view, &o, 2, level), bvx_last_message(ctx));
        for (int i = 0; i < 2; i++) {
            TEST_ASSERT_TRUE(level[i].positions == p[i] && level[i].triangles == t[i]);
            snprintf(where, sizeof where, "level %d", i);
            if (!small) assert_same_bytes(&wanted[i], &level[i]);
            else TEST_ASSERT_EQUAL_UINT64(0, level[i].triangle_count + level[i].vertex_count);
        }
    }
    memset(level, 0, sizeof level);
    level[1].positions = mesh.p; /* the mesh's own */
    level[1].triangles = t[1];
    level[1].vertex_capacity = 600;
    level[1].triangle_capacity = 1000;
    level[1].position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_simplify(ctx, &view, &o, 2, level));
    TEST_ASSERT_NULL(level[0].positions);
    memset(level, 0, sizeof level);
    for (int i = 0; i < 2; i++) bvx_mesh_free(ctx, &wanted[i]);
}

/* ---- Refusals ---- */

static void refuse(bvx_status status, const bvx_simplify_options *o, uint64_t count, const char *text)
{
    static const bvx_mesh empty[LEVELS_MOST] = {{0}};
    bvx_mesh_view const view = maker_view(&mesh);
    uint64_t const held = bvx_memory_used(ctx);

    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_mesh_simplify(ctx, &view, o, count, level), text);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_mesh_simplify"));
    TEST_ASSERT_EQUAL_MEMORY(empty, level, sizeof empty);
    TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_used(ctx));
}

static void test_simplify_refuses_options_out_of_range_or_exclusive(void)
{
    static const uint64_t triangles[2] = {100, 0};
    static const double errors[5] = {0.1, 0, -1, (double)NAN, (double)INFINITY};
    bvx_simplify_options o = defaults();

    make_shape(shape_named("cube"));
    refuse(BVX_ERR_ARGUMENT, &o, 0, "level_count is 0");
    o.targets.triangles = triangles;
    refuse(BVX_ERR_ARGUMENT, &o, 2, "targets.triangles[1] is 0");
    o.targets.errors = errors;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "exclude each other");
    o = defaults();
    for (int i = 1; i < 5; i++) {
        o.targets.errors = errors + i;
        refuse(BVX_ERR_ARGUMENT, &o, 1, "targets.errors[0]");
    }
    o = defaults();
    o.targets.even = (double)NAN;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "even");
    o.targets.even = 1.0000001;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "even");
    o = defaults();
    o.targets.samples = (uint64_t)1 << 31;
    refuse(BVX_ERR_ARGUMENT, &o, 1, "samples");
    for (int i = 0; i < 3; i++) {
        static const double wrong[3] = {-1e-9, 1000.001, (double)NAN};
        o = defaults();
        o.collapse.attribute_weight = wrong[i];
        refuse(BVX_ERR_ARGUMENT, &o, 1, "attribute_weight");
    }
}

/* What is wrong with a mesh is mended where that needs no new shape, and stays where it does. */
static void test_meshes_of_any_quality_are_taken(void)
{
    bvx_simplify_options o = defaults();
    uint64_t border[5] = {3, 0, 0, 0, 0};

    for (int way = 0; way < 5; way++) {
        bvx_mesh_view view;

        make_shape(shape_named("cube"));
        if (way == 0) maker_remove(&mesh, 33);
        if (way == 1) maker_flip(&mesh, 33, 34);
        if (way == 2 || way == 3) maker_duplicate(&mesh, 33);
        if (way == 3) maker_flip(&mesh, mesh.triangles - 1, mesh.triangles);
        if (way == 4) { /* two tetrahedra that share a vertex */
            maker_clear(&mesh);
            for (int i = 0; i < 7; i++)
                maker_vertex(&mesh, 4 + (i % 2) * (i < 4 ? 1 : -1), 4 + (i / 2 % 2) * (i < 4 ? 1 : -1),
                             4 + (i % 3) * (i < 4 ? 1 : -1));
            maker_tetrahedron(&mesh, 0, 1, 2, 3);
            maker_tetrahedron(&mesh, 0, 4, 5, 6);
        }
        view = maker_view(&mesh);
        drop_levels();
        snprintf(where, sizeof where, "way %d", way);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, level),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(border[way], certificate_of(&level[0]).boundary_edges, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(way == 4 ? 2 : 1, certificate_of(&level[0]).components, where);
        if (way != 0) assert_whole(&level[0], way == 4 ? 4 : 2, way == 4 ? 2 : 1);
    }
}

static void test_meshes_of_nothing_or_out_of_range_are_refused(void)
{
    bvx_simplify_options o = defaults();

    maker_vertex(&mesh, 1, 1, 1);
    refuse(BVX_ERR_EMPTY, &o, 1, "no triangles");
    maker_triangle(&mesh, 0, 0, 0); /* nothing is left of it when it is welded */
    refuse(BVX_ERR_EMPTY, &o, 1, "no triangle");
    make_shape(shape_named("cube"));
    mesh.p[3 * 40 + 1] = (double)INFINITY;
    refuse(BVX_ERR_RANGE, &o, 1, "vertex 40 has y");
    make_shape(shape_named("cube"));
    mesh.t[100] = (uint32_t)mesh.vertices;
    refuse(BVX_ERR_RANGE, &o, 1, "vertex index");
}

/* Outside of these spans nothing collapsed, and triangles that could not be fewer were said to be why. */
static void test_spans_beyond_what_edges_collapse_in_are_refused(void)
{
    static const double scales[] = {1e-30, 1e-14, 1e14, 1e29, 1e-33, 1e-160, 1e33, 1e150};
    static const uint64_t target = 100;
    bvx_simplify_options o = defaults();

    o.targets.triangles = &target;
    for (int i = 0; i < 8; i++) {
        make_shape(shape_named("cube"));
        for (uint64_t k = 0; k < 3 * mesh.vertices; k++) mesh.p[k] *= scales[i];
        if (i < 4) {
            bvx_mesh_view const view = maker_view(&mesh);

            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, level),
                                            bvx_last_message(ctx));
            TEST_ASSERT_TRUE(level[0].triangle_count <= target);
            bvx_mesh_free(ctx, &level[0]);
        } else {
            refuse(BVX_ERR_RANGE, &o, 1, "edges collapse between spans of 1e-30 and 1e31: scale it");
        }
    }
}

/* ---- Memory ---- */

/* Bytes a triangle of what a call takes besides the mesh, between two
 * sizes, so that the fixed part is not in it. */
static double bytes_a_triangle(int loose, int with_reports, double *fixed)
{
    static shape s;
    static double corners[9 * SHAPE_MAX];
    static const uint64_t target = 100;
    uint64_t triangles[2], bytes[2];

    for (int i = 0; i < 2; i++) {
        bvx_mesh_view view;
        bvx_simplify_options o = defaults();
        o.targets.triangles = &target;
        o.reports = with_reports ? report : NULL;
        shape_torus(&s, i == 0 ? 64 : 120, i == 0 ? 64 : 80, 0.2, 5);
        shape_view(&s, &view);
        for (size_t c = 0; c < 3 * (size_t)s.triangles; c++)
            memcpy(corners + 3 * c, s.v[s.t[c / 3][c % 3]], 24);
        if (loose) {
            view.positions = corners;
            view.indices = NULL;
            view.vertex_count = 3 * view.triangle_count;
        }
        drop_levels();
        bvx_memory_reset_peak(ctx);
        simplify_view(&view, &o, 1);
        bytes[i] = bvx_memory_peak(ctx);
        triangles[i] = view.triangle_count;
    }
    *fixed = (double)bytes[0] -
             (double)(bytes[1] - bytes[0]) / (double)(triangles[1] - triangles[0]) * (double)triangles[0];
    return (double)(bytes[1] - bytes[0]) / (double)(triangles[1] - triangles[0]);
}

/* What the header states. */
static void test_memory_is_as_the_header_says(void)
{
    double fixed, bytes = bytes_a_triangle(0, 0, &fixed);

    snprintf(where, sizeof where, "%.1f bytes a triangle and %.0f", bytes, fixed);
    TEST_ASSERT_TRUE_MESSAGE(bytes > 120 && bytes <= 165 && fixed <= 300000, where);
    bytes = bytes_a_triangle(0, 1, &fixed);
    snprintf(where, sizeof where, "%.1f bytes a triangle and %.0f with reports", bytes, fixed);
    TEST_ASSERT_TRUE_MESSAGE(bytes <= 165 && fixed <= 300000, where);
    bytes = bytes_a_triangle(1, 0, &fixed);
    snprintf(where, sizeof where, "%.1f bytes a triangle and %.0f without indices", bytes, fixed);
    TEST_ASSERT_TRUE_MESSAGE(bytes <= 165 && fixed <= 300000, where);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_shapes_are_whole_and_do_not_cross);
    RUN_TEST(test_every_level_keeps_the_guarantee);
    RUN_TEST(test_every_level_of_floats_keeps_the_guarantee);
    RUN_TEST(test_even_0_and_1_keep_the_guarantee);
    RUN_TEST(test_surfaces_of_random_bits_keep_the_guarantee);
    RUN_TEST(test_planes_come_down_to_their_corners);
    RUN_TEST(test_planes_that_meet_at_ten_degrees_keep_their_corners);
    RUN_TEST(test_a_thin_plate_keeps_its_corners);
    RUN_TEST(test_planes_keep_their_corners_by_default);
    RUN_TEST(test_thin_parts_do_not_crumple);
    RUN_TEST(test_order_and_types_of_the_input_do_not_matter);
    RUN_TEST(test_order_and_types_do_not_matter_by_error);
    RUN_TEST(test_threads_do_not_matter);
    RUN_TEST(test_reports_do_not_matter);
    RUN_TEST(test_meshes_far_from_the_origin_keep_the_guarantee);
    RUN_TEST(test_levels_without_targets_halve);
    RUN_TEST(test_more_halvings_than_a_count_has_bits);
    RUN_TEST(test_a_chain_goes_on_from_level_to_level);
    RUN_TEST(test_a_target_of_all_gives_the_mesh_back);
    RUN_TEST(test_errors_are_kept_and_used);
    RUN_TEST(test_an_error_below_every_collapse_keeps_the_mesh);
    RUN_TEST(test_an_error_that_the_way_has_passed_by_gives_the_level_before);
    RUN_TEST(test_an_error_is_used_up);
    RUN_TEST(test_a_torus_is_not_reduced_below_its_handle);
    RUN_TEST(test_a_tetrahedron_stays_and_unused_vertices_go);
    RUN_TEST(test_a_flat_body_is_closed_or_refused);
    RUN_TEST(test_levels_fill_the_callers_arrays_or_refuse_small_ones);
    RUN_TEST(test_simplify_refuses_options_out_of_range_or_exclusive);
    RUN_TEST(test_meshes_of_any_quality_are_taken);
    RUN_TEST(test_meshes_of_nothing_or_out_of_range_are_refused);
    RUN_TEST(test_spans_beyond_what_edges_collapse_in_are_refused);
    RUN_TEST(test_memory_is_as_the_header_says);
    return UNITY_END();
}
