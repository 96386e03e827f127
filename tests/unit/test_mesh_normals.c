/* test_mesh_normals.c - normals as arrays against sums over all facets, on
 * round bodies, far from and close to the origin, and refusals. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh mesh;
static float vertex[3 * 4000], facet[2][3 * 4000];

void setUp(void)
{
    suite_open(0);
    maker_clear(&mesh);
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static void all_normals(void)
{
    bvx_mesh_view const view = maker_view(&mesh);
    TEST_ASSERT_TRUE(mesh.vertices <= 4000 && mesh.triangles <= 4000);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_normals(ctx, &view, 0, vertex, facet[0]));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_normals(ctx, &view, 1, NULL, facet[1]));
}

/* The normal of facet t by its definition, not of length 1. */
static void own_normal(size_t t, double n[3])
{
    const double *const a = mesh.p + 3 * mesh.t[3 * t];
    const double *const b = mesh.p + 3 * mesh.t[3 * t + 1];
    const double *const c = mesh.p + 3 * mesh.t[3 * t + 2];
    for (int k = 0; k < 3; k++) {
        int const l = (k + 1) % 3, m = (k + 2) % 3;
        n[k] = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
    }
}

static void assert_direction(const double n[3], const float got[3])
{
    double const length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-6, n[k] / length, (double)got[k]);
}

static void make_star(double size)
{
    double const centre[3] = {0.5 * size, -size, 2 * size}, radius[3] = {size, 0.7 * size, 0.9 * size};
    uint64_t seed = 5;
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.2, 9, 14, 1 << 20);
}

static void test_normals_against_their_definition(void)
{
    make_star(4.0);
    all_normals();
    for (size_t t = 0; t < mesh.triangles; t++) {
        double n[3], mean[3] = {0, 0, 0};
        own_normal(t, n);
        assert_direction(n, facet[0] + 3 * t);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++)
                mean[k] += (double)vertex[3 * mesh.t[3 * t + (size_t)i] + (uint32_t)k];
        assert_direction(mean, facet[1] + 3 * t);
    }
    for (size_t v = 0; v < mesh.vertices; v++) {
        double sum[3] = {0, 0, 0}, n[3];
        int used = 0;
        for (size_t t = 0; t < mesh.triangles; t++) {
            if (mesh.t[3 * t] != v && mesh.t[3 * t + 1] != v && mesh.t[3 * t + 2] != v) continue;
            own_normal(t, n);
            for (int k = 0; k < 3; k++) sum[k] += n[k];
            used = 1;
        }
        if (used) assert_direction(sum, vertex + 3 * v);
    }
}

/* Coordinates whose products no double holds. */
static void test_normals_of_huge_and_tiny_meshes(void)
{
    static float usual[3 * 4000];

    make_star(1.0);
    all_normals();
    memcpy(usual, vertex, sizeof usual);
    for (int down = 0; down < 2; down++) {
        make_star(1.0);
        for (size_t v = 0; v < 3 * mesh.vertices; v++)
            for (int i = 0; i < 900; i++) mesh.p[v] *= down ? 0.5 : 2.0;
        all_normals();
        TEST_ASSERT_EQUAL_MEMORY(usual, vertex, mesh.vertices * 12);
    }
}

static void test_normals_where_there_is_none(void)
{
    for (int i = 0; i < 4; i++) maker_vertex(&mesh, i, 0, 0); /* on one line, the last one unused */
    maker_triangle(&mesh, 0, 1, 2);
    all_normals();
    for (int i = 0; i < 4; i++)
        TEST_ASSERT_TRUE(vertex[3 * i] == 0.0f && vertex[3 * i + 1] == 0.0f && vertex[3 * i + 2] == 1.0f);
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_TRUE(facet[i][0] == 0.0f && facet[i][1] == 0.0f && facet[i][2] == 1.0f);
}

static void test_normals_refuse(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    bvx_mesh_view view;

    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_normals(NULL, &view, 0, vertex, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_normals(ctx, NULL, 0, vertex, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_normals(ctx, &view, 0, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_normals(ctx, &view, 2, vertex, NULL));
    view.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_mesh_normals(ctx, &view, 0, vertex, NULL));
    mesh.t[10] = 8;
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_mesh_normals(ctx, &view, 0, vertex, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "triangle 3"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_normals_against_their_definition);
    RUN_TEST(test_normals_of_huge_and_tiny_meshes);
    RUN_TEST(test_normals_where_there_is_none);
    RUN_TEST(test_normals_refuse);
    return UNITY_END();
}
