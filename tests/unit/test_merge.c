/* test_merge.c - surfaces of windows joined: the bytes of the whole surface, however it was cut. */
#include "tools/mesh_maker.h"

#include "suite.h"

enum { MOST_PARTS = 128 };

static uint64_t seed;
static bvx_grid grid;
static bvx_mesh part[MOST_PARTS];
static uint64_t parts;

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0x3e29e);
}

static void free_parts(void)
{
    while (parts > 0) bvx_mesh_free(ctx, &part[--parts]);
}

void tearDown(void)
{
    free_parts();
    bvx_grid_free(ctx, &grid);
    suite_close();
}

static bvx_extract_options extract_options(void)
{
    bvx_extract_options o = {.struct_size = sizeof o};
    o.keys = 1;
    return o;
}

/* A grid of noise; low: its window begins that far inside its lattice. */
static void open_noise(int32_t x, int32_t y, int32_t z, int32_t low, int32_t density)
{
    static const double origin[3] = {-13.7, 2.1, 0.3}, spacing[3] = {0.1, 0.3, 0.7};
    int32_t const dims[3] = {x + 2 * low, y + 2 * low, z + 2 * low};
    bvx_window const w = {{low, low, low}, {x, y, z}};
    bvx_lattice l;

    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &grid));
    for (int32_t k = 0; k < z; k++)
        for (int32_t j = 0; j < y; j++)
            for (int32_t i = 0; i < x; i++) bvx_grid_set(&grid, i, j, k, maker_below(&seed, 16) < density);
}

static bvx_mesh surface_of(const bvx_grid *g, const bvx_extract_options *o)
{
    bvx_mesh m = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_surface(ctx, g, o, &m), bvx_last_message(ctx));
    return m;
}

/* Extract voxels low .. high of the grid along each axis, open towards the neighbours. */
static void extract_part(const int32_t low[3], const int32_t high[3], const bvx_extract_options *whole)
{
    bvx_extract_options o = *whole;
    bvx_window w;
    bvx_grid g = {0};

    for (int a = 0; a < 3; a++) {
        w.low[a] = grid.low[a] + low[a];
        w.size[a] = high[a] - low[a] + 1;
        if (low[a] > 0) o.open_sides |= 1 << 2 * a;
        if (high[a] < grid.size[a] - 1) o.open_sides |= 2 << 2 * a;
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &grid.lattice, &w, &g));
    for (int32_t z = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++)
                bvx_grid_set(&g, x, y, z, bvx_grid_get(&grid, low[0] + x, low[1] + y, low[2] + z));
    part[parts++] = surface_of(&g, &o);
    bvx_grid_free(ctx, &g);
}

/* Random places to cut n voxels into pieces that share one layer: cut[0] = 0, ..., cut[count] = n - 1. */
static int32_t choose_cuts(int32_t n, int32_t most, int32_t cut[6])
{
    int32_t count = 0;
    cut[0] = 0;
    for (int32_t at = 1; at < n - 1 && count < most - 1; at++)
        if (maker_below(&seed, n) < most) cut[++count] = at;
    cut[++count] = n - 1;
    return count;
}

static void extract_parts(const bvx_extract_options *o)
{
    int32_t cut[3][6], count[3], at[3];

    for (int a = 0; a < 3; a++) count[a] = choose_cuts(grid.size[a], 4, cut[a]);
    for (at[2] = 0; at[2] < count[2]; at[2]++)
        for (at[1] = 0; at[1] < count[1]; at[1]++)
            for (at[0] = 0; at[0] < count[0]; at[0]++) {
                int32_t low[3], high[3];
                for (int a = 0; a < 3; a++) {
                    low[a] = cut[a][at[a]];
                    high[a] = cut[a][at[a] + 1];
                }
                extract_part(low, high, o);
            }
}

static void assert_same_bytes(const bvx_mesh *want, const bvx_mesh *got)
{
    size_t const point = want->position_type == BVX_F32 ? 12 : 24;
    uint64_t a, b;

    TEST_ASSERT_EQUAL_UINT64(want->vertex_count, got->vertex_count);
    TEST_ASSERT_EQUAL_UINT64(want->triangle_count, got->triangle_count);
    TEST_ASSERT_EQUAL_INT32(want->position_type, got->position_type);
    TEST_ASSERT_EQUAL_MEMORY(want->frame, got->frame, sizeof want->frame);
    TEST_ASSERT_EQUAL_INT(0, memcmp(want->positions, got->positions, (size_t)want->vertex_count * point));
    TEST_ASSERT_EQUAL_INT(0, memcmp(want->triangles, got->triangles, (size_t)want->triangle_count * 12));
    TEST_ASSERT_EQUAL_INT(0, memcmp(want->vertex_keys, got->vertex_keys, (size_t)want->vertex_count * 8));
    TEST_ASSERT_EQUAL_INT(0,
                          memcmp(want->triangle_keys, got->triangle_keys, (size_t)want->triangle_count * 8));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, want, &a));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, got, &b));
    TEST_ASSERT_EQUAL_HEX64(a, b);
}

static void shuffle_parts(void)
{
    for (uint64_t i = parts; i-- > 1;) {
        uint64_t const k = (uint64_t)maker_below(&seed, (int32_t)i + 1);
        bvx_mesh const swap = part[i];
        part[i] = part[k];
        part[k] = swap;
    }
}

static void assert_parts_make_the_whole(const bvx_extract_options *o)
{
    bvx_mesh whole = surface_of(&grid, o), merged = {0};

    extract_parts(o);
    shuffle_parts();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_merge(ctx, part, parts, &merged), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(1, merged.owned);
    assert_same_bytes(&whole, &merged);
    bvx_mesh_free(ctx, &merged);
    bvx_mesh_free(ctx, &whole);
    free_parts();
}

/* ---- Tests ---- */

static void test_windows_merge_to_the_wholes_bytes(void)
{
    static const int32_t sizes[][3] = {{1, 1, 1},  {2, 2, 2},   {63, 8, 9},  {64, 9, 8},
                                       {65, 7, 7}, {129, 6, 9}, {5, 20, 21}, {1, 9, 9}};

    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (int32_t trial = 0; trial < (quick ? 2 : 16); trial++) {
            bvx_extract_options o = extract_options();
            o.face_rule = trial & 1;
            o.position_type = trial & 2 ? BVX_F64 : BVX_F32;
            o.local_frame = trial >> 2 & 1;
            open_noise(sizes[s][0], sizes[s][1], sizes[s][2], trial % 3, 1 + trial);
            assert_parts_make_the_whole(&o);
        }
}

static void test_wholes_with_open_sides(void)
{
    for (int32_t sides = 0; sides < 64; sides++) {
        bvx_extract_options o = extract_options();
        o.open_sides = sides;
        open_noise(66, 7, 6, 1, 8);
        assert_parts_make_the_whole(&o);
    }
}

/* Parts merge in steps as well as at once, and one part is its own merging. */
static void test_merging_in_steps(void)
{
    bvx_extract_options const o = extract_options();
    bvx_mesh whole, merged = {0}, step = {0};

    open_noise(70, 10, 11, 0, 7);
    whole = surface_of(&grid, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_merge(ctx, &whole, 1, &merged));
    assert_same_bytes(&whole, &merged);
    bvx_mesh_free(ctx, &merged);
    do {
        free_parts();
        extract_parts(&o);
    } while (parts < 3);
    merged = part[--parts];
    memset(&part[parts], 0, sizeof part[parts]);
    while (parts > 0) {
        bvx_mesh two[2];
        two[0] = merged;
        two[1] = part[parts - 1];
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_merge(ctx, two, 2, &step));
        bvx_mesh_free(ctx, &merged);
        bvx_mesh_free(ctx, &part[--parts]);
        merged = step;
        memset(&step, 0, sizeof step);
    }
    assert_same_bytes(&whole, &merged);
    bvx_mesh_free(ctx, &merged);
    bvx_mesh_free(ctx, &whole);
}

/* Windows where nothing is, and nothing but such windows. */
static void test_empty_parts(void)
{
    static const int32_t low[3] = {0, 0, 0}, high[3] = {3, 3, 3};
    bvx_extract_options const o = extract_options();
    bvx_mesh merged = {0};

    open_noise(4, 4, 4, 0, 0);
    for (int i = 0; i < 3; i++) extract_part(low, high, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_merge(ctx, part, parts, &merged));
    TEST_ASSERT_EQUAL_UINT64(0, merged.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(0, merged.triangle_count);
    bvx_mesh_free(ctx, &merged);
    bvx_grid_set(&grid, 1, 1, 1, 1);
    extract_part(low, high, &o);
    for (uint64_t place = 0; place < 4; place++) { /* the one that is not empty, at every place */
        bvx_mesh order[4];
        memset(order, 0, sizeof order);
        for (uint64_t i = 0; i < 4; i++) order[i] = part[i == place ? 3 : 0];
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_merge(ctx, order, 4, &merged));
        assert_same_bytes(&part[3], &merged);
        bvx_mesh_free(ctx, &merged);
    }
}

static bvx_mesh nothing;

static void assert_refused(bvx_status status, const bvx_mesh *from, uint64_t count, const char *text)
{
    bvx_mesh const empty = {0};
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_merge(ctx, from, count, &nothing));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&empty, &nothing, sizeof empty);
}

static void test_refusals(void)
{
    static const int32_t low[3] = {0, 0, 0}, high[3] = {5, 5, 5};
    bvx_extract_options o = extract_options();
    bvx_mesh bad[2];

    open_noise(6, 6, 6, 0, 8);
    extract_part(low, high, &o);
    extract_part(low, high, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_merge(NULL, part, 2, &nothing));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_merge(ctx, part, 2, NULL));
    assert_refused(BVX_ERR_ARGUMENT, NULL, 2, "parts");
    assert_refused(BVX_ERR_ARGUMENT, part, 0, "no parts");
    memcpy(bad, part, sizeof bad);
    bad[1].vertex_keys = NULL;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "part 1 has no vertex keys");
    memcpy(bad, part, sizeof bad);
    bad[0].triangle_keys = NULL;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "part 0 has no triangle keys");
    memcpy(bad, part, sizeof bad);
    bad[1].positions = NULL;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "part 1");
    memcpy(bad, part, sizeof bad);
    bad[1].triangles = NULL;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "part 1");
    memcpy(bad, part, sizeof bad);
    bad[1].position_type = BVX_F64;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "position type");
    bad[0].position_type = bad[1].position_type = 7;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "position type");
    memcpy(bad, part, sizeof bad);
    bad[1].frame[2] = 1;
    assert_refused(BVX_ERR_ARGUMENT, bad, 2, "frame");
    memcpy(bad, part, sizeof bad);
    nothing.positions = bad; /* whole is not empty */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_merge(ctx, part, 2, &nothing));
    TEST_ASSERT_EQUAL_PTR(bad, nothing.positions);
    memset(&nothing, 0, sizeof nothing);
}

/* A triangle that names no vertex of its part is an error and not a read beyond the array. */
static void test_an_index_beyond_the_vertices_is_refused(void)
{
    static const int32_t low[3] = {0, 0, 0}, high[3] = {5, 5, 5};
    bvx_extract_options const o = extract_options();

    open_noise(6, 6, 6, 0, 8);
    extract_part(low, high, &o);
    extract_part(low, high, &o);
    part[1].triangles[3 * 7 + 1] = (uint32_t)part[1].vertex_count;
    assert_refused(BVX_ERR_RANGE, part, 2, "triangle 7");
    part[1].triangles[3 * 7 + 1] = UINT32_MAX;
    assert_refused(BVX_ERR_RANGE, part, 2, "part 1");
}

/* Counts beyond what numbers of 32 bits can name are refused before
 * anything is read, also where their sum wraps round. */
static void test_too_many_vertices_are_refused(void)
{
    static const int32_t low[3] = {0, 0, 0}, high[3] = {5, 5, 5};
    bvx_extract_options const o = extract_options();
    bvx_mesh bad[2];

    open_noise(6, 6, 6, 0, 8);
    extract_part(low, high, &o);
    bad[0] = bad[1] = part[0];
    bad[1].vertex_count = UINT32_MAX;
    assert_refused(BVX_ERR_RANGE, bad, 2, "vertices");
    bad[0].vertex_count = bad[1].vertex_count = UINT64_C(1) << 63;
    assert_refused(BVX_ERR_RANGE, bad, 2, "vertices");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_windows_merge_to_the_wholes_bytes);
    RUN_TEST(test_wholes_with_open_sides);
    RUN_TEST(test_merging_in_steps);
    RUN_TEST(test_empty_parts);
    RUN_TEST(test_refusals);
    RUN_TEST(test_an_index_beyond_the_vertices_is_refused);
    RUN_TEST(test_too_many_vertices_are_refused);
    return UNITY_END();
}
