/* test_hash.c - the hash of bytes against its recipe, in pieces and by types, and the hash of meshes. */
#include "core/hash.h"
#include "suite.h"

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

/* The recipe of the header, byte by byte. */
static uint64_t recipe(const unsigned char *bytes, size_t size, uint64_t seed)
{
    uint64_t h = seed ^ UINT64_C(0xcbf29ce484222325), word = 0;

    for (size_t i = 0; i < (size + 7) / 8 * 8; i++) {
        if (i < size) word |= (uint64_t)bytes[i] << 8 * (i % 8);
        if (i % 8 != 7) continue;
        h = (h ^ word) * UINT64_C(0x100000001b3);
        h ^= h >> 32;
        word = 0;
    }
    h = (h ^ size) * UINT64_C(0x100000001b3);
    return h ^ h >> 32;
}

static void fill(unsigned char *bytes, size_t size, uint32_t seed)
{
    for (size_t i = 0; i < size; i++) {
        seed = seed * 1664525u + 1013904223u;
        bytes[i] = (unsigned char)(seed >> 24);
    }
}

static void test_hash_follows_the_recipe_at_every_size_and_alignment(void)
{
    unsigned char bytes[120];
    for (size_t size = 0; size <= 100; size++)
        for (size_t shift = 0; shift < 9; shift++) {
            uint64_t const seed = size * UINT64_C(0x9e3779b97f4a7c15) * (shift & 1);
            fill(bytes, sizeof bytes, (uint32_t)(size * 31 + shift));
            TEST_ASSERT_EQUAL_HEX64(recipe(bytes + shift, size, seed), bvx_hash(bytes + shift, size, seed));
        }
}

/* Computed from the header's words by another program in another language. */
static void test_hash_golden(void)
{
    unsigned char all[256];

    for (int i = 0; i < 256; i++) all[i] = (unsigned char)i;
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xaf63bd4c29620a93), bvx_hash("", 0, 0));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xaf63bd4c29620a93), bvx_hash(NULL, 0, 0));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x68e0166a3938c199), bvx_hash("a", 1, 0));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x68e0176a3938cecc), bvx_hash("a\0", 2, 0));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xdc041ecf36a1f55a), bvx_hash("voxels!!", 8, 0));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xee297f532a82a668), bvx_hash("bit-packed voxels", 17, 2026));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x4dd7c786980dbffc), bvx_hash(all, 256, UINT64_MAX));
}

static void test_hash_in_pieces_is_the_hash_of_the_whole(void)
{
    unsigned char bytes[64];
    bvxi_hash h;

    fill(bytes, sizeof bytes, 5);
    for (size_t a = 0; a <= 40; a++)
        for (size_t b = a; b <= 40; b++) {
            bvxi_hash_start(&h, 77);
            bvxi_hash_bytes(&h, bytes, a);
            bvxi_hash_bytes(&h, bytes + a, b - a);
            bvxi_hash_bytes(&h, bytes + b, 50 - b);
            TEST_ASSERT_EQUAL_HEX64(recipe(bytes, 50, 77), bvxi_hash_end(&h));
        }
}

static void put_little(unsigned char *to, uint64_t value, size_t n)
{
    for (size_t i = 0; i < n; i++) to[i] = (unsigned char)(value >> 8 * i);
}

/* Numbers behind 0..8 single bytes, so that they begin at every place of a word. */
static void test_numbers_stand_for_their_little_endian_bytes(void)
{
    uint32_t const u[5] = {1, 0xdeadbeef, 0, UINT32_MAX, 0x01020304};
    int32_t const s[3] = {-1, INT32_MIN, 7};
    uint64_t const w[4] = {1, UINT64_C(0x0102030405060708), UINT64_MAX, UINT64_C(0x8000000000000000)};
    float const f[3] = {1.0f, -0.0f, 3.14159f};
    double const d[3] = {-2.5, 1e300, 0.0};

    for (size_t before = 0; before <= 8; before++)
        for (size_t n = 0; n <= 3; n++) {
            unsigned char bytes[8 + 4 * 5 + 4 * 3 + 8 * 4 + 4 * 3 + 8 * 3], *to = bytes;
            bvxi_hash h;
            fill(bytes, before, 3);
            bvxi_hash_start(&h, before);
            bvxi_hash_bytes(&h, bytes, before);
            to += before;
            for (size_t i = 0; i < n + 2; i++, to += 4) put_little(to, u[i], 4);
            bvxi_hash_u32(&h, u, n + 2);
            for (size_t i = 0; i < n; i++, to += 4) put_little(to, (uint32_t)s[i], 4);
            bvxi_hash_i32(&h, s, n);
            for (size_t i = 0; i < n + 1; i++, to += 8) put_little(to, w[i], 8);
            bvxi_hash_u64(&h, w, n + 1);
            for (size_t i = 0; i < n; i++, to += 4) {
                uint32_t bits;
                memcpy(&bits, &f[i], 4);
                put_little(to, bits, 4);
            }
            bvxi_hash_f32(&h, f, n);
            for (size_t i = 0; i < n; i++, to += 8) {
                uint64_t bits;
                memcpy(&bits, &d[i], 8);
                put_little(to, bits, 8);
            }
            bvxi_hash_f64(&h, d, n);
            TEST_ASSERT_EQUAL_HEX64(recipe(bytes, (size_t)(to - bytes), before), bvxi_hash_end(&h));
        }
}

static float float_positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static double double_positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
static uint32_t triangle[3] = {0, 1, 2};

static bvx_mesh one_triangle(int32_t type)
{
    bvx_mesh m;

    memset(&m, 0, sizeof m);
    m.positions = type == BVX_F32 ? (void *)float_positions : (void *)double_positions;
    m.triangles = triangle;
    m.vertex_count = 3;
    m.triangle_count = 1;
    m.position_type = type;
    m.frame[0] = 0.5;
    m.frame[1] = -1.0;
    m.frame[2] = 2.0;
    return m;
}

static uint64_t mesh_hash(const bvx_mesh *m)
{
    uint64_t h = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, m, &h));
    return h;
}

static void test_mesh_hash_golden(void)
{
    bvx_mesh m = one_triangle(BVX_F32);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x7a0ab9b44777d043), mesh_hash(&m));
    m = one_triangle(BVX_F64);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xa59edeb971bc4f01), mesh_hash(&m));
    memset(&m, 0, sizeof m);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x15bf9c50fac6413e), mesh_hash(&m));
}

/* Capacities, keys and ownership are no part of the mesh. */
static void test_mesh_hash_sees_the_mesh_and_nothing_else(void)
{
    bvx_mesh m = one_triangle(BVX_F32);
    uint64_t const h = mesh_hash(&m);
    uint64_t key = 5;

    m.vertex_capacity = 10;
    m.triangle_capacity = 10;
    m.vertex_keys = m.triangle_keys = &key;
    TEST_ASSERT_EQUAL_HEX64(h, mesh_hash(&m));
    m.frame[2] = 3.0;
    TEST_ASSERT_TRUE(h != mesh_hash(&m));
    m = one_triangle(BVX_F32);
    m.vertex_count = 2;
    TEST_ASSERT_TRUE(h != mesh_hash(&m));
    m = one_triangle(BVX_F32);
    float_positions[8] = -0.0f;
    TEST_ASSERT_TRUE(h != mesh_hash(&m));
    float_positions[8] = 0.0f;
    triangle[2] = 1;
    TEST_ASSERT_TRUE(h != mesh_hash(&m));
    triangle[2] = 2;
    TEST_ASSERT_EQUAL_HEX64(h, mesh_hash(&m));
}

static void refuse(const bvx_mesh *m, bvx_status status, const char *word)
{
    uint64_t h = 99;
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_hash(ctx, m, &h));
    TEST_ASSERT_EQUAL_UINT64(99, h);
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), word));
}

static void test_mesh_hash_refuses(void)
{
    bvx_mesh m = one_triangle(BVX_F32);
    uint64_t h;

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_hash(NULL, &m, &h));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_hash(ctx, &m, NULL));
    refuse(NULL, BVX_ERR_ARGUMENT, "mesh is NULL");
    m.position_type = 0, refuse(&m, BVX_ERR_ARGUMENT, "position_type"), m = one_triangle(BVX_F32);
    m.position_type = 3, refuse(&m, BVX_ERR_ARGUMENT, "position_type"), m = one_triangle(BVX_F32);
    m.positions = NULL, refuse(&m, BVX_ERR_ARGUMENT, "positions is NULL"), m = one_triangle(BVX_F32);
    m.triangles = NULL, refuse(&m, BVX_ERR_ARGUMENT, "triangles is NULL"), m = one_triangle(BVX_F32);
    m.vertex_count = UINT64_C(1) << 32, refuse(&m, BVX_ERR_RANGE, "4294967296"), m = one_triangle(BVX_F32);
    m.triangle_count = UINT64_C(1) << 31, refuse(&m, BVX_ERR_RANGE, "2147483648");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_hash_follows_the_recipe_at_every_size_and_alignment);
    RUN_TEST(test_hash_golden);
    RUN_TEST(test_hash_in_pieces_is_the_hash_of_the_whole);
    RUN_TEST(test_numbers_stand_for_their_little_endian_bytes);
    RUN_TEST(test_mesh_hash_golden);
    RUN_TEST(test_mesh_hash_sees_the_mesh_and_nothing_else);
    RUN_TEST(test_mesh_hash_refuses);
    return UNITY_END();
}
