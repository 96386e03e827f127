/* test_carry.c - colours and texture coordinates carried from mesh to mesh: blends worked by hand, and
 * against the nearest points that bvx_closest_find gives. */
#include "mesh/mesh.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh m;
static uint64_t seed;
static bvx_mesh source, target;

void setUp(void)
{
    suite_open(0);
    seed = 12;
    maker_clear(&m);
}

void tearDown(void)
{
    bvx_mesh_free(ctx, &source);
    bvx_mesh_free(ctx, &target);
    maker_free(&m);
    suite_close();
}

/* ---- Meshes that the library owns ---- */

/* What the maker holds, of a type. */
static void take_mesh(bvx_mesh *mesh, int32_t type)
{
    bvx_mesh_free(ctx, mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_mesh_open(ctx, "test", type, 0, m.vertices, m.triangles, mesh));
    memcpy(mesh->triangles, m.t, m.triangles * 12);
    for (size_t i = 0; i < 3 * m.vertices; i++) {
        if (type == BVX_F32) ((float *)mesh->positions)[i] = (float)m.p[i];
        else ((double *)mesh->positions)[i] = m.p[i];
    }
}

static void give_colours(bvx_mesh *mesh)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvxi_alloc(ctx, BVXI_RESULT, mesh->vertex_capacity * 4, "test", &mesh->colours));
    for (uint64_t i = 0; i < mesh->vertex_capacity * 4; i++)
        mesh->colours[i] = (uint8_t)maker_below(&seed, 256);
}

static void give_uvs(bvx_mesh *mesh, uint64_t count, int by_corner)
{
    mesh->uv_count = count;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, count * 8, "test", &mesh->uvs));
    for (uint64_t i = 0; i < count * 2; i++) mesh->uvs[i] = (float)maker_below(&seed, 1000) / 256.0f;
    if (!by_corner) return;
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, mesh->triangle_capacity * 12, "test", &mesh->uv_triangles));
    for (uint64_t i = 0; i < mesh->triangle_count * 3; i++)
        mesh->uv_triangles[i] = (uint32_t)maker_below(&seed, (int32_t)count);
}

/* Two triangles of a square, and points on it as a mesh of their own. */
static void make_square(void)
{
    maker_clear(&m);
    maker_vertex(&m, 0, 0, 0);
    maker_vertex(&m, 8, 0, 0);
    maker_vertex(&m, 8, 8, 0);
    maker_vertex(&m, 0, 8, 0);
    maker_triangle(&m, 0, 1, 2);
    maker_triangle(&m, 0, 2, 3);
    take_mesh(&source, BVX_F64);
}

static void make_points(const double (*p)[3], int count)
{
    maker_clear(&m);
    for (int i = 0; i < count; i++) maker_vertex(&m, p[i][0], p[i][1], p[i][2]);
    maker_triangle(&m, 0, 0, 0);
    take_mesh(&target, BVX_F64);
}

static void make_star(bvx_mesh *mesh, int32_t type, double size, int32_t rings)
{
    double const centre[3] = {1, 2, 3}, radius[3] = {size, size * 0.9, size * 0.8};
    maker_clear(&m);
    maker_star(&m, &seed, centre, radius, 0.1, rings, 2 * rings, 65536);
    take_mesh(mesh, type);
}

/* ---- By hand ---- */

static void test_carry_blends_by_hand(void)
{
    static const double points[6][3] = {{8, 0, 5}, {4, 0, 0}, {7, 0, -1}, {6, 2, 1}, {-3, -3, 0}, {8, 9, 0}};
    static const uint8_t colours[16] = {0, 10, 255, 255, 255, 20, 0, 255, 255, 40, 0, 0, 1, 2, 3, 4};
    static const uint8_t want[24] = {255, 20, 0, 255,   /* corner 1 */
                                     128, 15, 128, 255, /* halves go up */
                                     223, 19, 32, 255,  /* 223.125, 18.75, 31.875 */
                                     191, 23, 64, 191,  /* a quarter, a half, a quarter */
                                     /* corners 0 and 2, from beyond them */
                                     0, 10, 255, 255, 255, 40, 0, 0};

    make_square();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, 16, "test", &source.colours));
    memcpy(source.colours, colours, 16);
    make_points(points, 6);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
    TEST_ASSERT_EQUAL_UINT8_ARRAY(want, target.colours, 24);
    TEST_ASSERT_NULL(target.uvs);
    TEST_ASSERT_EQUAL_UINT64(0, target.uv_count);
}

/* On either side of a seam the texture is another one. */
static void test_carry_keeps_to_the_side_of_a_seam(void)
{
    static const double points[3][3] = {{6, 2, 0}, {2, 6, 0}, {0, 8, 3}};
    static const float uvs[12] = {0, 0, 1, 0, 1, 1, 10, 10, 20, 20, 10, 20};
    static const float want[6] = {0.75f, 0.25f, 12.5f, 17.5f, 10, 20};

    make_square();
    give_uvs(&source, 6, 1);
    memcpy(source.uvs, uvs, sizeof uvs);
    for (uint32_t i = 0; i < 6; i++) source.uv_triangles[i] = i;
    make_points(points, 3);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
    TEST_ASSERT_EQUAL_UINT64(target.vertex_capacity, target.uv_count);
    TEST_ASSERT_NULL(target.uv_triangles);
    TEST_ASSERT_NULL(target.colours);
    for (int i = 0; i < 6; i++) TEST_ASSERT_TRUE(target.uvs[i] == want[i]);
}

/* ---- Against the nearest points ---- */

static void world_of(const bvx_mesh *mesh, uint64_t i, double p[3])
{
    for (int a = 0; a < 3; a++)
        p[a] = (mesh->position_type == BVX_F32 ? (double)((const float *)mesh->positions)[3 * i + (uint64_t)a]
                                               : ((const double *)mesh->positions)[3 * i + (uint64_t)a]) +
               mesh->frame[a];
}

static void expect_carried(const bvx_mesh *from, const bvx_mesh *to)
{
    bvx_mesh_view view;
    bvx_closest *closest;

    TEST_ASSERT_NULL(to->uv_triangles);
    bvx_mesh_view_of(from, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &view, &closest));
    for (uint64_t i = 0; i < to->vertex_count; i++) {
        double p[3];
        bvx_closest_point f;
        world_of(to, i, p);
        for (int a = 0; a < 3; a++) p[a] -= from->frame[a];
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, p, 1, &f));
        const uint32_t *const c = from->triangles + 3 * (size_t)f.triangle;
        const uint32_t *const n = from->uv_triangles != NULL ? from->uv_triangles + 3 * (size_t)f.triangle
                                                             : c;
        for (int k = 0; k < 4 && from->colours != NULL; k++) {
            double v = 0.0;
            for (int j = 0; j < 3; j++) v += f.weight[j] * from->colours[4 * c[j] + (uint32_t)k];
            TEST_ASSERT_EQUAL_UINT8((uint8_t)floor(v + 0.5), to->colours[4 * i + (uint64_t)k]);
        }
        for (int k = 0; k < 2 && from->uvs != NULL; k++) {
            double v = 0.0;
            for (int j = 0; j < 3; j++) v += f.weight[j] * (double)from->uvs[2 * n[j] + (uint32_t)k];
            TEST_ASSERT_TRUE(to->uvs[2 * i + (uint64_t)k] == (float)v);
        }
    }
    bvx_closest_free(ctx, closest);
}

static void test_carry_equals_nearest_points(void)
{
    for (int i = 0; i < 8; i++) {
        make_star(&source, i & 1 ? BVX_F32 : BVX_F64, 7, 11);
        make_star(&target, i & 2 ? BVX_F32 : BVX_F64, 6.5, 9);
        give_colours(&source);
        give_uvs(&source, i & 4 ? 50 : source.vertex_capacity, i & 4);
        if (i >= 2) give_colours(&target); /* to be replaced */
        if (i >= 3) give_uvs(&target, 33, i & 1);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
        TEST_ASSERT_EQUAL_UINT64(target.vertex_capacity, target.uv_count);
        expect_carried(&source, &target);
    }
}

/* The same vertices take the same values, to the bit. */
static void test_carry_to_the_same_vertices_copies(void)
{
    make_star(&source, BVX_F32, 7, 12);
    take_mesh(&target, BVX_F32);
    give_colours(&source);
    give_uvs(&source, source.vertex_capacity, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
    TEST_ASSERT_EQUAL_MEMORY(source.colours, target.colours, source.vertex_count * 4);
    TEST_ASSERT_EQUAL_MEMORY(source.uvs, target.uvs, source.vertex_count * 8);
}

/* Frames say where meshes lie; the numbers in the arrays do not. */
static void test_carry_adds_the_frames(void)
{
    static const double shift[3] = {4096, -2048, 512};
    bvx_mesh_view view;
    uint8_t *plain;

    make_star(&source, BVX_F64, 7, 12);
    give_colours(&source);
    make_star(&target, BVX_F64, 6, 10);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
    plain = malloc((size_t)target.vertex_count * 4);
    TEST_ASSERT_NOT_NULL(plain);
    memcpy(plain, target.colours, (size_t)target.vertex_count * 4);
    /* source, then target, then both move their numbers into the frame */
    for (int round = 0; round < 3; round++) {
        bvx_mesh *const mesh = round == 0 ? &source : &target;
        if (round < 2)
            for (uint64_t i = 0; i < mesh->vertex_count * 3; i++)
                ((double *)mesh->positions)[i] -= shift[i % 3];
        if (round < 2) memcpy(mesh->frame, shift, sizeof shift);
        if (round == 2) TEST_ASSERT_TRUE(source.frame[0] == 4096 && target.frame[0] == 4096);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
        TEST_ASSERT_EQUAL_UINT8_ARRAY(plain, target.colours, target.vertex_count * 4);
    }
    bvx_mesh_view_of(&target, &view);
    TEST_ASSERT_TRUE(view.colours == target.colours);
    free(plain);
}

static void test_carry_leaves_alone_what_the_source_lacks(void)
{
    bvx_mesh before;

    make_square();
    make_star(&target, BVX_F32, 6, 10);
    give_colours(&target);
    give_uvs(&target, 20, 1);
    before = target;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target)); /* nothing at all */
    TEST_ASSERT_EQUAL_MEMORY(&before, &target, sizeof before);
    give_colours(&source);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target)); /* colours only */
    TEST_ASSERT_TRUE(target.uvs == before.uvs && target.uv_triangles == before.uv_triangles &&
                     target.uv_count == 20);
    TEST_ASSERT_TRUE(target.positions == before.positions && target.triangles == before.triangles);
}

static void test_carry_clears_what_the_capacity_leaves(void)
{
    make_square();
    give_colours(&source);
    give_uvs(&source, 4, 0);
    make_star(&target, BVX_F32, 6, 10);
    target.vertex_count -= 5;
    target.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(ctx, &source, &target));
    TEST_ASSERT_EQUAL_UINT64(target.vertex_count + 5, target.uv_count);
    for (uint64_t i = 4 * target.vertex_count; i < 4 * target.vertex_capacity; i++)
        TEST_ASSERT_EQUAL_UINT8(0, target.colours[i]);
    for (uint64_t i = 2 * target.vertex_count; i < 2 * target.vertex_capacity; i++)
        TEST_ASSERT_TRUE(target.uvs[i] == 0.0f);
}

static void test_carry_is_the_same_for_any_threads(void)
{
    uint8_t *one = NULL;
    bvx_context_options o = {.struct_size = sizeof o};

    make_star(&source, BVX_F32, 7, 12);
    give_colours(&source);
    make_star(&target, BVX_F32, 6, 30);
    for (o.threads = 1; o.threads <= 4; o.threads++) {
        bvx_context *other;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_carry(other, &source, &target));
        if (one == NULL) {
            one = malloc((size_t)target.vertex_count * 4);
            TEST_ASSERT_NOT_NULL(one);
            memcpy(one, target.colours, (size_t)target.vertex_count * 4);
        }
        TEST_ASSERT_EQUAL_UINT8_ARRAY(one, target.colours, target.vertex_count * 4);
        bvxi_free(other, target.colours, target.vertex_capacity * 4); /* to the context that it counts in */
        target.colours = NULL;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
        bvx_context_destroy(other);
    }
    free(one);
}

/* ---- Refusals: the target stays as it was ---- */

static void expect_refusal(bvx_status status, const char *word)
{
    bvx_mesh const before = target;
    uint64_t const used = bvx_memory_used(ctx);
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_carry(ctx, &source, &target));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&before, &target, sizeof before);
    TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_used(ctx));
}

static void test_carry_refuses_sources(void)
{
    bvx_mesh good;

    make_square();
    give_colours(&source);
    give_uvs(&source, 6, 1);
    make_star(&target, BVX_F32, 6, 10);
    give_colours(&target);
    good = source;
    source.triangle_count = 0, expect_refusal(BVX_ERR_EMPTY, "source: the mesh has no triangles"),
    source = good;
    source.triangles = NULL, expect_refusal(BVX_ERR_ARGUMENT, "source: mesh.triangles is NULL"),
    source = good;
    source.position_type = 9, expect_refusal(BVX_ERR_ARGUMENT, "source: mesh.position_type is 9"),
    source = good;
    source.reserved[1] = 1, expect_refusal(BVX_ERR_ARGUMENT, "source: mesh.reserved[1]"), source = good;
    source.frame[1] = HUGE_VAL, expect_refusal(BVX_ERR_RANGE, "source: mesh.frame"), source = good;
    source.vertex_count = 3, expect_refusal(BVX_ERR_RANGE, "source: triangle 1 has vertex index 3"),
    source = good;
    source.uvs = NULL, expect_refusal(BVX_ERR_ARGUMENT, "uv_triangles is given"), source = good;
    source.uvs = NULL, source.colours = NULL, expect_refusal(BVX_ERR_ARGUMENT, "uv_triangles is given"),
    source = good;
    source.uv_triangles[4] = 6,
    expect_refusal(BVX_ERR_RANGE, "triangle 1 has texture coordinate number 6, but there are 6");
    source.uv_triangles[4] = 5;
    source.uvs[11] = (float)HUGE_VAL, expect_refusal(BVX_ERR_RANGE, "texture coordinate 5 is not finite");
    source.uvs[11] = 0;
    source.uv_triangles = NULL, source.uv_count = 3;
    expect_refusal(BVX_ERR_RANGE, "triangle 1 has texture coordinate number 3, but there are 3"),
        source = good;
    ((double *)source.positions)[7] = nan("");
    expect_refusal(BVX_ERR_RANGE, "source: vertex 2 has y = nan");
}

static void test_carry_refuses_targets(void)
{
    bvx_mesh good;

    make_square();
    give_colours(&source);
    make_star(&target, BVX_F64, 6, 10);
    good = target;
    target.owned = 0, expect_refusal(BVX_ERR_ARGUMENT, "target: its arrays are not the library's"),
    target = good;
    target.position_type = 0, expect_refusal(BVX_ERR_ARGUMENT, "target: mesh.position_type is 0"),
    target = good;
    target.reserved[0] = 1, expect_refusal(BVX_ERR_ARGUMENT, "target: mesh.reserved[0]"), target = good;
    target.frame[2] = nan(""), expect_refusal(BVX_ERR_RANGE, "target: mesh.frame"), target = good;
    target.vertex_capacity = 3, expect_refusal(BVX_ERR_ARGUMENT, "with a vertex_capacity of 3"),
    target = good;
    target.vertex_capacity = (UINT64_C(1) << 61) + 4,
    expect_refusal(BVX_ERR_ARGUMENT, "target: mesh.vertex_capacity is 2305843009213693956"), target = good;
    target.positions = NULL, expect_refusal(BVX_ERR_ARGUMENT, "target: mesh.positions is NULL"),
    target = good;
    ((double *)target.positions)[3] = nan(""), expect_refusal(BVX_ERR_RANGE, "target: vertex 1 has x = nan");
    ((double *)target.positions)[3] = 1.7e308, target.frame[0] = 1.7e308;
    expect_refusal(BVX_ERR_RANGE, "target: vertex 1 is beyond a double's range"), target = good;
    ((double *)target.positions)[3] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_carry(NULL, &source, &target));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_carry(ctx, NULL, &target));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "source is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_carry(ctx, &source, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "target is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_carry(ctx, &source, &source));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "are one mesh"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_carry_blends_by_hand);
    RUN_TEST(test_carry_keeps_to_the_side_of_a_seam);
    RUN_TEST(test_carry_equals_nearest_points);
    RUN_TEST(test_carry_to_the_same_vertices_copies);
    RUN_TEST(test_carry_adds_the_frames);
    RUN_TEST(test_carry_leaves_alone_what_the_source_lacks);
    RUN_TEST(test_carry_clears_what_the_capacity_leaves);
    RUN_TEST(test_carry_is_the_same_for_any_threads);
    RUN_TEST(test_carry_refuses_sources);
    RUN_TEST(test_carry_refuses_targets);
    return UNITY_END();
}
