/* test_sheets.c - meshes with borders by bvx_mesh_simplify and bvx_build_levels: borders keep their corners, never meet; what is no sheet is parted or cut. */
#include "levels_support.h"

/* Sheets are quarter as large and lie away from 0: within [1, 16), as the oracle of crossings needs it. */
enum { AWAY = 4, PART = 4 };

static void put_vertex(double x, double y, double z)
{
    maker_vertex(&mesh, AWAY + x / PART, AWAY + y / PART, AWAY + z / PART);
}

typedef double height_at(int32_t x, int32_t y);

static double flat(int32_t x, int32_t y)
{
    (void)x;
    (void)y;
    return 0;
}
static double wavy(int32_t x, int32_t y)
{
    return 0.5 * maker_wave(x / 16.0) + 0.25 * maker_wave(y / 7.0);
}

/* Squares of a lattice for which keep says so, or all, as two triangles each; unused vertices stay. */
static void make_sheet(int32_t nx, int32_t ny, height_at *height, level_inside *keep)
{
    maker_clear(&mesh);
    for (int32_t y = 0; y <= ny; y++)
        for (int32_t x = 0; x <= nx; x++) put_vertex(x, y, height(x, y));
    for (int32_t y = 0; y < ny; y++)
        for (int32_t x = 0; x < nx; x++) {
            uint32_t const a = (uint32_t)(y * (nx + 1) + x), b = a + 1, c = b + (uint32_t)nx + 1, d = c - 1;
            if (keep == NULL || keep(x, y, 0)) maker_quad(&mesh, a, b, c, d, (x + y) & 1);
        }
}

static int exact; /* 1: nothing but planes pulls */

static bvx_simplify_options defaults(void)
{
    bvx_simplify_options o = {.struct_size = sizeof o};
    o.reports = report;
    o.collapse.position_type = BVX_F64;
    if (exact) o.targets.even = BVX_NONE;
    return o;
}

static void simplify_to(const uint64_t *targets, uint64_t count)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_simplify_options o = defaults();
    o.targets.triangles = targets;
    drop_levels();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, count, level),
                                    bvx_last_message(ctx));
}

/* Open, manifold, oriented, with the borders and pieces of what was given. */
static void assert_open(int i, int64_t euler, uint64_t components)
{
    bvx_certificate const c = certificate_of(&level[i]);

    snprintf(where, sizeof where, "level %d: %lu triangles, %lu border edges, euler %ld", i,
             (unsigned long)c.triangles, (unsigned long)c.boundary_edges, (long)c.euler);
    TEST_ASSERT_FALSE_MESSAGE(c.closed, where);
    TEST_ASSERT_TRUE_MESSAGE(c.edge_manifold && c.vertex_manifold && c.oriented, where);
    TEST_ASSERT_TRUE_MESSAGE(c.boundary_edges >= 3, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, c.degenerate + c.duplicates + c.collapsed + c.unused_vertices, where);
    TEST_ASSERT_EQUAL_INT64_MESSAGE(euler, c.euler, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(components, c.components, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(c.boundary_edges, report[i].certificate.boundary_edges, where);
}

static void assert_sheet(int i, int64_t euler, uint64_t components)
{
    assert_open(i, euler, components);
    assert_no_crossings(&level[i]);
}

static int has_position(const bvx_mesh *m, double x, double y, double z)
{
    for (uint64_t v = 0; v < m->vertex_count; v++)
        if (fabs(position_of(m, 3 * v) - AWAY - x / PART) +
                fabs(position_of(m, 3 * v + 1) - AWAY - y / PART) +
                fabs(position_of(m, 3 * v + 2) - AWAY - z / PART) <
            1e-6)
            return 1;
    return 0;
}

/* ---- Borders ---- */

static void test_a_rectangle_comes_down_to_its_corners(void)
{
    static const uint64_t targets[] = {50, 2};

    make_sheet(16, 9, flat, NULL);
    exact = 1;
    simplify_to(targets, 2);
    exact = 0;
    assert_sheet(0, 1, 1);
    assert_sheet(1, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(2, level[1].triangle_count);
    TEST_ASSERT_TRUE(report[1].met);
    for (int i = 0; i < 4; i++) TEST_ASSERT_TRUE(has_position(&level[1], i % 2 * 16, i / 2 * 9, 0));
    TEST_ASSERT_TRUE(fabs(report[1].certificate.area * PART * PART - 16 * 9) < 1e-6);
}

static int in_l(int32_t x, int32_t y, int32_t z)
{
    (void)z;
    return x < 5 || y < 4;
}
static int beside_holes(int32_t x, int32_t y, int32_t z)
{
    (void)z;
    return (x < 3 || x > 5 || y < 3 || y > 6) && (x < 8 || x > 11 || y < 4 || y > 5);
}

static void test_corners_of_borders_stay(void)
{
    static const double corner[8][2] = {{3, 3}, {6, 3}, {6, 7}, {3, 7}, {8, 4}, {12, 4}, {12, 6}, {8, 6}};
    static const uint64_t few[] = {4}, target[] = {14};
    make_sheet(12, 10, flat, in_l);
    exact = 1;
    simplify_to(few, 1);
    assert_sheet(0, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(4, level[0].triangle_count);
    TEST_ASSERT_TRUE(has_position(&level[0], 5, 4, 0) && has_position(&level[0], 12, 4, 0) &&
                     has_position(&level[0], 5, 10, 0));
    TEST_ASSERT_TRUE(fabs(report[0].certificate.area * PART * PART - (5 * 10 + 7 * 4)) < 1e-6);

    make_sheet(15, 10, flat, beside_holes);
    simplify_to(target, 1);
    exact = 0;
    assert_sheet(0, -1, 1);
    TEST_ASSERT_EQUAL_UINT64(14, level[0].triangle_count); /* 12 corners and two holes take no fewer */
    for (int i = 0; i < 8; i++) TEST_ASSERT_TRUE(has_position(&level[0], corner[i][0], corner[i][1], 0));
    TEST_ASSERT_TRUE(fabs(report[0].certificate.area * PART * PART - (150 - 12 - 8)) < 1e-6);
}

/* Down to as little as there can be, with both types: no border folds or meets another one. */
static void test_every_level_keeps_the_guarantee(void)
{
    static const uint64_t targets[] = {300, 120, 40, 1};
    make_sheet(30, 20, wavy, NULL);
    simplify_to(targets, 4);
    for (int i = 0; i < 4; i++) assert_sheet(i, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(1, level[3].triangle_count);

    make_sheet(30, 20, wavy, beside_holes);
    simplify_to(targets, 4);
    for (int i = 0; i < 4; i++) assert_sheet(i, -1, 1);
    TEST_ASSERT_FALSE(report[3].met);
}

/* A border of teeth at random, so that collapses along it would fold it. */
static int32_t tooth[80];
static int in_teeth(int32_t x, int32_t y, int32_t z)
{
    (void)z;
    return y < tooth[x] && y >= tooth[40 + x];
}

static void test_ragged_borders(void)
{
    static const uint64_t targets[] = {200, 90, 40, 12};

    for (int trial = 0; trial < (quick ? 2 : 12); trial++) {
        bvx_certificate before;
        bvx_mesh_view view;
        for (int i = 0; i < 40; i++) {
            tooth[i] = 8 + maker_below(&seed, 7);
            tooth[40 + i] = maker_below(&seed, 7);
        }
        make_sheet(40, 15, trial % 2 ? wavy : flat, in_teeth);
        view = maker_view(&mesh);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &before));
        simplify_to(targets, 4);
        for (int i = 0; i < 4; i++) {
            assert_sheet(i, before.euler, before.components);
            if (trial % 2 == 0)
                TEST_ASSERT_TRUE_MESSAGE(report[i].certificate.area < 1.2 * before.area, where);
        }
    }
}

/* A sheet rolled up: its layers lie close, and its borders over each other. */
static void test_a_scroll_does_not_cross_itself(void)
{
    static const uint64_t targets[] = {900, 300, 100};

    make_sheet(120, 8, flat, NULL);
    for (size_t v = 0; v < mesh.vertices; v++) {
        double const turn = (mesh.p[3 * v] - AWAY) * PART / 24, radius = 1 + 0.1 * turn;
        mesh.p[3 * v] = AWAY + radius * maker_wave(turn);
        mesh.p[3 * v + 2] = AWAY + radius * maker_wave(turn + 0.25);
    }
    simplify_to(targets, 3);
    for (int i = 0; i < 3; i++) assert_sheet(i, 1, 1);
}

static void test_a_tube_keeps_both_ends(void)
{
    static const uint64_t targets[] = {200, 1};

    maker_clear(&mesh);
    for (int32_t z = 0; z <= 20; z++)
        for (int32_t i = 0; i < 24; i++)
            put_vertex(3 * maker_wave(i / 24.0), 3 * maker_wave(i / 24.0 + 0.25), z);
    for (uint32_t z = 0; z < 20; z++)
        for (uint32_t i = 0; i < 24; i++)
            maker_quad(&mesh, 24 * z + i, 24 * z + (i + 1) % 24, 24 * (z + 1) + (i + 1) % 24,
                       24 * (z + 1) + i, 0);
    simplify_to(targets, 2);
    assert_sheet(0, 0, 1);
    assert_sheet(1, 0, 1);
    TEST_ASSERT_EQUAL_UINT64(8, level[1].triangle_count); /* six would be a prism: further off */
}

static void test_order_does_not_matter(void)
{
    static const uint64_t targets[] = {200, 40};
    bvx_mesh first[2];

    make_sheet(30, 20, wavy, beside_holes);
    simplify_to(targets, 2);
    memcpy(first, level, sizeof first);
    memset(level, 0, sizeof level);
    maker_shuffle_triangles(&mesh, &seed);
    maker_shuffle_vertices(&mesh, &seed);
    simplify_to(targets, 2);
    for (int i = 0; i < 2; i++) {
        assert_same_bytes(&first[i], &level[i]);
        bvx_mesh_free(ctx, &first[i]);
    }
}

/* ---- What is no sheet as it is ---- */

static void test_doubles_and_flipped_triangles_are_mended(void)
{
    static const uint64_t targets[] = {200, 40};
    bvx_mesh first[2];
    size_t triangles;

    make_sheet(30, 20, wavy, NULL);
    simplify_to(targets, 2);
    memcpy(first, level, sizeof first);
    memset(level, 0, sizeof level);
    triangles = mesh.triangles;
    for (size_t t = 0; t < triangles; t += 3) maker_flip(&mesh, t, t + 1);
    for (size_t t = 0; t < triangles; t += 2) {
        maker_duplicate(&mesh, t);
        if (t % 3 == 1) maker_flip(&mesh, mesh.triangles - 1, mesh.triangles);
    }
    simplify_to(targets, 2);
    for (int i = 0; i < 2; i++) {
        assert_same_bytes(&first[i], &level[i]);
        bvx_mesh_free(ctx, &first[i]);
    }
}

/* A closed mesh that is turned inside out in parts comes out as whole. */
static void test_a_closed_mesh_stays_closed(void)
{
    static const uint64_t targets[] = {200};
    make_shape(shape_named("torus"));
    for (size_t t = 0; t < mesh.triangles; t += 5) maker_flip(&mesh, t, t + 1);
    simplify_to(targets, 1);
    assert_whole(&level[0], 0, 1);
    assert_no_crossings(&level[0]);
}

static void test_parts_that_touch_in_a_vertex_part(void)
{
    static const uint64_t targets[] = {4};
    bvx_certificate c;

    make_sheet(4, 4, flat, NULL);
    /* (0,-1) (-1,-1) (0,-2) */
    for (uint32_t i = 0; i < 3; i++) put_vertex(0 - (double)(i % 2), 0 - (double)(i / 2) - 1, 0);
    maker_triangle(&mesh, 0, (uint32_t)mesh.vertices - 2, (uint32_t)mesh.vertices - 3);
    simplify_to(targets, 1);
    c = certificate_of(&level[0]);
    TEST_ASSERT_TRUE(c.edge_manifold && c.vertex_manifold && c.oriented && !c.closed);
    TEST_ASSERT_EQUAL_UINT64(2, c.components);
    TEST_ASSERT_EQUAL_UINT64(3, c.triangles);
    TEST_ASSERT_EQUAL_UINT64(7, c.vertices);
}

/* Three sheets that meet along x = 8 at z = 0. */
static void make_joint(void)
{
    uint32_t const first = 17 * 9;

    make_sheet(16, 8, flat, NULL);
    for (int32_t z = 1; z <= 5; z++)
        for (int32_t y = 0; y <= 8; y++) put_vertex(8, y, z);
    for (uint32_t z = 0; z < 5; z++)
        for (uint32_t y = 0; y < 8; y++) {
            uint32_t const low = z == 0 ? 17 * y + 8 : first + 9 * (z - 1) + y;
            uint32_t const low_next = z == 0 ? low + 17 : low + 1;
            maker_quad(&mesh, low, low_next, first + 9 * z + y + 1, first + 9 * z + y, 0);
        }
}

static void test_joints_are_cut(void)
{
    static const uint64_t targets[] = {100, 6};

    make_joint();
    simplify_to(targets, 2);
    assert_open(0, 3, 3);
    assert_open(1, 3, 3);
    TEST_ASSERT_EQUAL_UINT64(6, level[1].triangle_count);
    for (int i = 0; i < 9; i++)
        TEST_ASSERT_TRUE(has_position(&level[1], i % 3 * 8, i / 3 * 4, 0) || i / 3 == 1);
}

/* A fin on a sheet, whose triangles go on around the fin's end: the sheet stays whole, the fin gets a border. */
static void test_a_fin_leaves_a_sheet_whole(void)
{
    static const uint64_t targets[] = {100, 20};

    for (uint32_t length = 1; length < 4; length++) {
        bvx_certificate c;
        make_sheet(16, 8, flat, NULL);
        put_vertex(8, 4, 5);
        for (uint32_t i = 0; i < length; i++)
            maker_triangle(&mesh, 17 * 4 + 6 + i, 17 * 4 + 7 + i, (uint32_t)mesh.vertices - 1);
        simplify_to(targets, 2);
        for (int i = 0; i < 2; i++) {
            c = certificate_of(&level[i]);
            TEST_ASSERT_TRUE(c.edge_manifold && c.vertex_manifold && c.oriented && !c.closed);
            TEST_ASSERT_EQUAL_UINT64(2, c.components);
            TEST_ASSERT_EQUAL_INT64(2, c.euler); /* two discs */
        }
    }
}

/* A band with one side has an edge where its triangles cannot agree. */
static void test_a_band_with_one_side(void)
{
    static const uint64_t targets[] = {60};

    maker_clear(&mesh);
    for (int32_t i = 0; i < 40; i++)
        for (int32_t k = 0; k < 3; k++) {
            double const turn = i / 40.0, half = maker_wave(turn / 2), other = maker_wave(turn / 2 + 0.75);
            put_vertex((6 + (k - 1) * half) * maker_wave(turn),
                       (6 + (k - 1) * half) * maker_wave(turn + 0.75), (k - 1) * other);
        }
    for (uint32_t i = 0; i < 40; i++)
        for (uint32_t k = 0; k < 2; k++) {
            uint32_t const n = (i + 1) % 40, a = i == 39 ? 2 - k : k, b = i == 39 ? 1 - k : k + 1;
            maker_quad(&mesh, 3 * i + k, 3 * n + a, 3 * n + b, 3 * i + k + 1, 0);
        }
    simplify_to(targets, 1);
    {
        bvx_certificate const c = certificate_of(&level[0]);
        TEST_ASSERT_TRUE(c.edge_manifold && c.vertex_manifold && c.oriented && !c.closed);
        TEST_ASSERT_EQUAL_UINT64(1, c.components);
        TEST_ASSERT_EQUAL_INT64(1, c.euler);
    }
}

/* ---- Levels ---- */

static bvx_levels_report levels_report;

static void build(int32_t solid)
{
    static const uint64_t targets[] = {120, 30};
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_levels_options o = {.struct_size = sizeof o};

    o.targets.triangles = targets;
    o.solid = solid;
    o.report = &levels_report;
    o.reports = report;
    drop_levels();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_build_levels(ctx, &view, &o, 2, level),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(solid, levels_report.solid);
}

static void test_levels_of_a_sheet(void)
{
    make_sheet(30, 20, wavy, NULL);
    build(0);
    TEST_ASSERT_EQUAL_UINT64(100, levels_report.before.boundary_edges);
    assert_sheet(0, 1, 1);
    assert_sheet(1, 1, 1);

    build(1);
    assert_whole(&level[1], 2, 1);
}

/* What is no sheet is cut, and the report says where that shows; a solid joins it. */
static void test_levels_of_a_joint(void)
{
    make_joint();
    build(0);
    TEST_ASSERT_EQUAL_UINT64(8, levels_report.cut);
    TEST_ASSERT_EQUAL_UINT64(0, levels_report.parted);
    TEST_ASSERT_EQUAL_UINT64(9, levels_report.split);
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_TRUE(levels_report.cut_edge[i][0] == AWAY + 2 && levels_report.cut_edge[i][2] == AWAY);
    assert_open(1, 3, 3);

    build(1);
    assert_whole(&level[1], certificate_of(&level[1]).euler, 1);
}

static void test_levels_say_what_was_mended(void)
{
    make_sheet(30, 20, wavy, NULL);
    maker_flip(&mesh, 7, 10);
    maker_duplicate(&mesh, 50);
    maker_triangle(&mesh, 3, 3, 4);
    build(0);
    TEST_ASSERT_EQUAL_UINT64(1, levels_report.collapsed);
    TEST_ASSERT_EQUAL_UINT64(1, levels_report.doubles);
    TEST_ASSERT_EQUAL_UINT64(3, levels_report.turned);
    TEST_ASSERT_EQUAL_UINT64(0, levels_report.split + levels_report.parted + levels_report.cut);
    TEST_ASSERT_EQUAL_UINT64(1200, levels_report.triangles);
    assert_sheet(1, 1, 1);
}

/* The part of less area is turned, however many triangles it has. */
static void test_the_least_area_is_turned(void)
{
    make_sheet(8, 8, flat, NULL);
    for (size_t v = 0; v < mesh.vertices; v++)
        if (v % 9 > 1) mesh.p[3 * v] += 8; /* the second column is wider than all others */
    for (size_t t = 0; t < mesh.triangles; t++)
        if (t / 2 % 8 != 1) maker_flip(&mesh, t, t + 1);
    build(0);
    TEST_ASSERT_EQUAL_UINT64(112, levels_report.turned);
    assert_sheet(1, 1, 1);
}

/* ---- Bodies that touch ---- */

static void add_box(double x, double y, double z, double size)
{
    double const low[3] = {AWAY + x, AWAY + y, AWAY + z};
    double const high[3] = {low[0] + size, low[1] + size, low[2] + size};

    maker_box(&mesh, low, high);
}

/* A level that is closed, in so many pieces, of such a volume. */
static void assert_bodies(int levels, uint64_t pieces, double volume, uint64_t parted)
{
    for (int i = 0; i < levels; i++) {
        bvx_certificate const c = certificate_of(&level[i]);

        snprintf(where, sizeof where, "level %d: %lu triangles, %lu pieces, volume %g; %lu parted, %lu cut",
                 i, (unsigned long)c.triangles, (unsigned long)c.components, c.volume,
                 (unsigned long)levels_report.parted, (unsigned long)levels_report.cut);
        TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(pieces, c.components, where);
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(1e-6, volume, c.volume, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, levels_report.cut, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(parted, levels_report.parted, where);
    }
}

/* Cubes that touch along an edge, in a face, in a vertex, and one that three others touch. */
static void test_bodies_that_touch_keep_their_volumes(void)
{
    add_box(0, 0, 0, 1);
    add_box(1, 1, 0, 1);
    build(0);
    assert_bodies(2, 2, 2, 1);
    maker_clear(&mesh);
    add_box(0, 0, 0, 1);
    add_box(1, 0, 0, 1);
    build(0);
    assert_bodies(2, 2, 2, 4);
    maker_clear(&mesh);
    add_box(0, 0, 0, 1);
    add_box(1, 1, 1, 1);
    build(0);
    assert_bodies(2, 2, 2, 0);
    TEST_ASSERT_EQUAL_UINT64(1, levels_report.split);
    maker_clear(&mesh);
    add_box(0, 0, 0, 1);
    add_box(1, 1, 0, 1);
    add_box(1, 0, 0, 1);
    add_box(0, 1, 0, 1);
    build(0);
    assert_bodies(1, 4, 4, 13);
}

/* Faces of voxels: two that touch along an edge, in one body. */
static int is_voxel(int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x > 1 || y > 1 || z > 2) return 0;
    return z != 1 || x == y;
}

static void test_an_edge_in_one_body_is_parted_too(void)
{
    static const int32_t side[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};

    for (int32_t i = 0; i < 48; i++) maker_vertex(&mesh, AWAY + i % 4, AWAY + i / 4 % 3, AWAY + i / 12);
    for (int32_t i = 0; i < 12 * 6; i++) {
        int32_t const x = i % 2, y = i / 2 % 2, z = i / 4 % 3;
        const int32_t *const s = side[i / 12];
        int const axis = s[0] != 0 ? 0 : s[1] != 0 ? 1 : 2, up = s[axis] > 0;
        uint32_t corner[4];

        if (!is_voxel(x, y, z) || is_voxel(x + s[0], y + s[1], z + s[2])) continue;
        for (int k = 0; k < 4; k++) {
            int32_t at[3] = {x, y, z};

            at[axis] += up;
            at[(axis + 1) % 3] += (k == 1 || k == 2) ? up : 0;
            at[(axis + 2) % 3] += k > 1;
            if (!up) at[(axis + 1) % 3] += k == 0 || k == 3;
            corner[k] = (uint32_t)(at[0] + 4 * at[1] + 12 * at[2]);
        }
        maker_quad(&mesh, corner[0], corner[1], corner[2], corner[3], 0);
    }
    build(0);
    assert_bodies(1, 1, 10, 1);
}

/* A leaf with two sides keeps both, as one piece; what lies on a sheet a second time does not. */
static void test_both_sides_of_a_leaf_stay(void)
{
    size_t triangles;

    make_sheet(8, 8, wavy, NULL);
    triangles = mesh.triangles;
    for (size_t t = 0; t < triangles; t++) maker_duplicate(&mesh, t);
    maker_flip(&mesh, triangles, mesh.triangles);
    build(0);
    TEST_ASSERT_EQUAL_UINT64(0, levels_report.doubles + levels_report.cut);
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_TRUE(certificate_of(&level[i]).closed);
        TEST_ASSERT_EQUAL_UINT64(1, report[i].certificate.components);
        TEST_ASSERT_TRUE(report[i].met);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_rectangle_comes_down_to_its_corners);
    RUN_TEST(test_corners_of_borders_stay);
    RUN_TEST(test_every_level_keeps_the_guarantee);
    RUN_TEST(test_ragged_borders);
    RUN_TEST(test_a_scroll_does_not_cross_itself);
    RUN_TEST(test_a_tube_keeps_both_ends);
    RUN_TEST(test_order_does_not_matter);
    RUN_TEST(test_doubles_and_flipped_triangles_are_mended);
    RUN_TEST(test_a_closed_mesh_stays_closed);
    RUN_TEST(test_parts_that_touch_in_a_vertex_part);
    RUN_TEST(test_joints_are_cut);
    RUN_TEST(test_a_fin_leaves_a_sheet_whole);
    RUN_TEST(test_a_band_with_one_side);
    RUN_TEST(test_levels_of_a_sheet);
    RUN_TEST(test_levels_of_a_joint);
    RUN_TEST(test_levels_say_what_was_mended);
    RUN_TEST(test_the_least_area_is_turned);
    RUN_TEST(test_bodies_that_touch_keep_their_volumes);
    RUN_TEST(test_an_edge_in_one_body_is_parted_too);
    RUN_TEST(test_both_sides_of_a_leaf_stay);
    return UNITY_END();
}
