/* test_repair_order.c - a repaired surface does not depend on how triangles, vertices and corners are
 * numbered, nor on which way the mesh is turned: equally near triangles are distinguished by geometry
 * alone. */
#include "solid_support.h"

#include <math.h>

typedef void order_shape(void);

static int32_t thin = BVX_THIN_SHELL;

static bvx_mesh surface_of(int32_t resolution, int32_t sharp, int32_t type)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_mesh out = {0};

    o.fit.resolution = resolution;
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    o.thin = thin;
    o.placing.position_type = type;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_repair(ctx, &view, &o, &out), bvx_last_message(ctx));
    return out;
}

/* Corner b, c, a for a, b, c: the same triangle. */
static void roll_corners(void)
{
    for (size_t t = 0; t < mesh.triangles; t++) {
        uint32_t *const c = mesh.t + 3 * t, first = c[0];
        if (maker_below(&seed, 3) == 0) continue;
        c[0] = c[1];
        c[1] = c[2];
        c[2] = first;
    }
}

static void renumber(int trial)
{
    maker_shuffle_triangles(&mesh, &seed);
    maker_shuffle_vertices(&mesh, &seed);
    roll_corners();
    if (trial & 1) maker_flip(&mesh, 0, mesh.triangles);
}

/* off: lids are placed by sums that go by the order of triangles, so their last digits differ. */
static void assert_order_is_within(order_shape *make, double off)
{
    for (int32_t sharp = 0; sharp < 2; sharp++) {
        bvx_mesh first;
        make();
        first = surface_of(30, sharp, BVX_F64);
        for (int trial = 0; trial < (quick ? 2 : 6); trial++) {
            bvx_mesh again;
            renumber(trial);
            again = surface_of(30, sharp, BVX_F64);
            TEST_ASSERT_EQUAL_UINT64(first.vertex_count, again.vertex_count);
            TEST_ASSERT_EQUAL_UINT64(first.triangle_count, again.triangle_count);
            if (off == 0) TEST_ASSERT_EQUAL_MEMORY(first.positions, again.positions, first.vertex_count * 24);
            for (size_t i = 0; i < 3 * first.vertex_count; i++)
                TEST_ASSERT_DOUBLE_WITHIN(off, ((double *)first.positions)[i],
                                          ((double *)again.positions)[i]);
            TEST_ASSERT_EQUAL_MEMORY(first.triangles, again.triangles, first.triangle_count * 12);
            bvx_mesh_free(ctx, &again);
        }
        bvx_mesh_free(ctx, &first);
    }
}

static void assert_order_does_not_show(order_shape *make)
{
    assert_order_is_within(make, 0);
    thin = BVX_THIN_KEEP;
    assert_order_is_within(make, 0);
    thin = BVX_THIN_SHELL;
}

/* ---- Shapes ---- */

static void make_turned_box(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {3, 4, 5};
    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    maker_turn(&mesh);
}

/* Even along the lattice: centres in the middle are equally far from several sides. */
static void make_even_box(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {4, 4, 4};
    maker_clear(&mesh);
    maker_box(&mesh, low, high);
}

static void make_spiky_star(void)
{
    double const at[3] = {0, 0, 0}, radius[3] = {2, 2, 2};
    uint64_t same = 77;
    maker_clear(&mesh);
    maker_star(&mesh, &same, at, radius, 0.6, 9, 12, 65536);
}

/* An edge of 10 degrees. */
static void make_turned_wedge(void)
{
    static const double outline[3][2] = {{0, 0}, {8, 0}, {8, 1.40625}};

    maker_clear(&mesh);
    for (int k = 0; k < 2; k++)
        for (int i = 0; i < 3; i++) maker_vertex(&mesh, outline[i][0], outline[i][1], 4.0 * k);
    for (uint32_t i = 0; i < 3; i++) maker_quad(&mesh, i, (i + 1) % 3, (i + 1) % 3 + 3, i + 3, 0);
    maker_triangle(&mesh, 2, 1, 0);
    maker_triangle(&mesh, 3, 4, 5);
    maker_turn(&mesh);
}

/* A star with triangles missing: lids close it. */
static void make_holey_star(void)
{
    make_spiky_star();
    for (size_t t = 5; t < mesh.triangles; t += 17) maker_remove(&mesh, t);
}

/* Two boxes that overlap: centres lie behind walls of both. */
static void make_crossed_boxes(void)
{
    double const low[3] = {0, 0, 0};
    double const high[3] = {3, 2, 2};
    double const other_low[3] = {1, -1, 0.5};
    double const other_high[3] = {2, 3, 1.5};

    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    maker_box(&mesh, other_low, other_high);
    maker_turn(&mesh);
}

static void test_order_of_a_turned_box(void)
{
    assert_order_does_not_show(make_turned_box);
}
static void test_order_of_an_even_box(void)
{
    assert_order_does_not_show(make_even_box);
}
static void test_order_of_a_spiky_star(void)
{
    assert_order_does_not_show(make_spiky_star);
}
static void test_order_of_a_wedge(void)
{
    assert_order_does_not_show(make_turned_wedge);
}
static void test_order_of_a_holey_star(void)
{
    assert_order_is_within(make_holey_star, 1e-12);
}
static void test_order_of_crossed_boxes(void)
{
    assert_order_does_not_show(make_crossed_boxes);
}

/* ---- Turned and mirrored ---- */

/* Axes exchanged and mirrored: the lattice goes along, so each vertex has its image but for rounding.
 * Marching cubes' triangles do not, nor which of two equally good planes is taken. */
static void test_images_are_the_same_shape(void)
{
    static const int axis[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {1, 0, 2}, {0, 2, 1}, {2, 1, 0}};
    bvx_mesh first;
    bvx_mesh_view a, b;

    make_spiky_star();
    first = surface_of(30, 1, BVX_F64);
    bvx_mesh_view_of(&first, &a);
    for (int k = 0; k < 6; k++)
        for (int mirror = 0; mirror < 2; mirror++) {
            bvx_distance_report d;
            bvx_mesh image;
            make_spiky_star();
            for (size_t v = 0; v < mesh.vertices; v++) {
                double const p[3] = {mesh.p[3 * v], mesh.p[3 * v + 1], mesh.p[3 * v + 2]};
                for (int i = 0; i < 3; i++) mesh.p[3 * v + (size_t)i] = p[axis[k][i]];
            }
            /* or the axes' exchange alone turns it inside out */
            if (mirror) maker_flip(&mesh, 0, mesh.triangles);
            image = surface_of(30, 1, BVX_F64);
            for (size_t v = 0; v < image.vertex_count; v++) {
                double *const p = (double *)image.positions + 3 * v, q[3] = {p[0], p[1], p[2]};
                for (int i = 0; i < 3; i++) p[axis[k][i]] = q[i];
            }
            bvx_mesh_view_of(&image, &b);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &a, &b, 20000, 1, &d));
            /* a voxel is 0.13 */
            TEST_ASSERT_TRUE(d.mean_a_to_b < 1e-3 && d.mean_b_to_a < 1e-3 && d.max_a_to_b < 0.1);
            bvx_mesh_free(ctx, &image);
        }
    bvx_mesh_free(ctx, &first);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_order_of_a_turned_box);
    RUN_TEST(test_order_of_an_even_box);
    RUN_TEST(test_order_of_a_spiky_star);
    RUN_TEST(test_order_of_a_wedge);
    RUN_TEST(test_order_of_a_holey_star);
    RUN_TEST(test_order_of_crossed_boxes);
    RUN_TEST(test_images_are_the_same_shape);
    return UNITY_END();
}
