/* test_solid.c - bvx_voxelize_solid by hand, its kinds of input, its refusals, arrays of the caller's. */
#include "solid_support.h"

/* ---- By hand ---- */

static void test_box_on_voxel_planes_fills_its_voxels(void)
{
    for (int32_t at = -2; at <= 6; at++) {
        bvx_lattice const l = lattice_of(6, 7, 8);
        double const low[3] = {at, at, at}, high[3] = {at + 4, at + 4, at + 4};
        for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
            uint64_t expected = 1;
            bvx_grid g;
            maker_clear(&mesh);
            maker_box(&mesh, low, high);
            g = solid_of(&l, fill);
            for (int a = 0; a < 3; a++) {
                int32_t const from = at < 0 ? 0 : at, to = at + 4 > l.dims[a] ? l.dims[a] : at + 4;
                expected *= from < to ? (uint64_t)(to - from) : 0;
            }
            TEST_ASSERT_EQUAL_UINT64(expected, set_voxels(&g));
            if (at == 0) TEST_ASSERT_EQUAL_UINT64(64, set_voxels(&g));
            for (int32_t z = 0; z < 8; z++)
                for (int32_t y = 0; y < 7; y++)
                    for (int32_t x = 0; x < 6; x++)
                        TEST_ASSERT_EQUAL_INT(x >= at && x < at + 4 && y >= at && y < at + 4 && z >= at &&
                                                  z < at + 4,
                                              bvx_grid_get(&g, x, y, z));
            bvx_grid_free(ctx, &g);
        }
    }
}

/* Faces through the centres: a centre on the low face is inside, on the
 * high face outside, as all centres move up. */
static void test_box_on_centres_is_half_open(void)
{
    bvx_lattice const l = lattice_of(70, 6, 6);
    double const low[3] = {1.5, 2.5, 0.5}, high[3] = {66.5, 4.5, 3.5};

    maker_box(&mesh, low, high);
    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
        bvx_grid g = solid_of(&l, fill);
        for (int32_t z = 0; z < 6; z++)
            for (int32_t y = 0; y < 6; y++)
                for (int32_t x = 0; x < 70; x++)
                    TEST_ASSERT_EQUAL_INT(x >= 1 && x < 66 && y >= 2 && y < 4 && z >= 0 && z < 3,
                                          bvx_grid_get(&g, x, y, z));
        bvx_grid_free(ctx, &g);
    }
}

static void test_report_by_hand(void)
{
    bvx_lattice const l = lattice_of(10, 10, 10);
    double const low[3] = {2, 3, 4}, high[3] = {6, 5, 7};
    bvx_solid_report r;
    bvx_grid g;

    maker_box(&mesh, low, high);
    g = solid_by(ctx, &l, NULL, BVX_FILL_PARITY, &r);
    TEST_ASSERT_EQUAL_UINT64(2 * 2 * 3, r.crossings);
    TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
    TEST_ASSERT_EQUAL_UINT64(0, r.reserved);
    TEST_ASSERT_EQUAL_UINT64(4 * 2 * 3, set_voxels(&g));
    bvx_grid_free(ctx, &g);
    maker_remove(&mesh, 3); /* one triangle of the face at x = 6 */
    maker_remove(&mesh, 2);
    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
        g = solid_by(ctx, &l, NULL, fill, &r);
        TEST_ASSERT_EQUAL_UINT64(2 * 3, r.crossings);
        TEST_ASSERT_EQUAL_UINT64(2 * 3, r.unbalanced_rows);
        TEST_ASSERT_EQUAL_UINT64(0, set_voxels(&g)); /* nothing leaks through the hole */
        bvx_grid_free(ctx, &g);
    }
}

/* One row, crossed where and how the text says: '<' enters, '>' leaves, before the voxel of its column. */
static void assert_row(const char *crossings, int32_t fill, const char *voxels, uint64_t dropped)
{
    bvx_lattice const l = lattice_of((int32_t)strlen(voxels), 1, 1);
    bvx_solid_report r;
    bvx_grid g;
    char seen[80] = "";

    maker_clear(&mesh);
    for (int32_t i = 0; crossings[i] != 0; i++) {
        if (crossings[i] == '<' || crossings[i] == 'X') wall(i, 4, 0);
        if (crossings[i] == '>' || crossings[i] == 'X') wall(i, 4, 1);
    }
    g = solid_by(ctx, &l, NULL, fill, &r);
    for (int32_t x = 0; voxels[x] != 0; x++) seen[x] = bvx_grid_get(&g, x, 0, 0) ? '#' : '.';
    TEST_ASSERT_EQUAL_STRING(voxels, seen);
    TEST_ASSERT_EQUAL_UINT64(dropped != 0, r.unbalanced_rows);
    bvx_grid_free(ctx, &g);
}

static void test_rows_by_hand(void)
{
    assert_row(" <  > ", BVX_FILL_PARITY, ".###...", 0);
    assert_row(" <  > ", BVX_FILL_NONZERO, ".###...", 0);
    assert_row(" >  < ", BVX_FILL_NONZERO, ".###...", 0);      /* turned inside out */
    assert_row("< <  >  >", BVX_FILL_PARITY, "##...###..", 0); /* a cavity */
    assert_row("< <  >  >", BVX_FILL_NONZERO, "########..", 0);
    assert_row("< >  >  <", BVX_FILL_NONZERO, "##...###..", 0);
    assert_row("X  X", BVX_FILL_NONZERO, "......", 0);
    assert_row("X  X", BVX_FILL_PARITY, "......", 0);

    /* a crossing too many */
    assert_row(" < >   > ", BVX_FILL_PARITY, ".##......", 1);
    assert_row(" <   > > ", BVX_FILL_PARITY, ".....##..", 1);
    assert_row(" <  >  > ", BVX_FILL_PARITY, ".###.....", 1); /* equal: the later goes */
    assert_row(" <  >  > ", BVX_FILL_NONZERO, ".###.....", 1);
    assert_row(" > <  > ", BVX_FILL_NONZERO, "...###..", 1);
    assert_row(" <  > < ", BVX_FILL_NONZERO, ".###....", 1);
    assert_row(" <  <  > ", BVX_FILL_NONZERO, "....###..", 1);
    assert_row(" <<  >  ", BVX_FILL_NONZERO, "..###...", 1);
    assert_row(" >> < ", BVX_FILL_NONZERO, "..##..", 0 + 1);
    assert_row(" > ", BVX_FILL_NONZERO, "....", 1);
    assert_row(" < ", BVX_FILL_PARITY, "....", 1);
    assert_row(" <<< ", BVX_FILL_NONZERO, ".....", 3);
    assert_row("<>  X  >", BVX_FILL_NONZERO, "#.......", 1); /* entering stands before leaving in one voxel */
}

/* ---- Views ---- */

static void test_all_kinds_of_view_give_the_same_bits(void)
{
    bvx_lattice const l = lattice_of(65, 12, 13);
    bvx_grid want, got;
    size_t const most = 400;
    unsigned char *const positions = maker_grow(NULL, most * 3 * 64 + 64);
    unsigned char *const indices = maker_grow(NULL, most * 64 + 64);

    make_random(SOUP, 60, l.dims, 8); /* exact in floats too */
    want = solid_of(&l, BVX_FILL_PARITY);
    for (int32_t variant = 0; variant < 2 * 4 * 3 * 3; variant++) {
        int const f32 = variant % 2;
        int const index = variant / 2 % 4;
        int const stride = variant / 8 % 3;
        int const offset = variant / 24 % 3;
        size_t const point = f32 ? 12 : 24, three = index == 0 ? 0 : (size_t)3 << index;
        size_t const point_stride = point + (stride == 0 ? 0 : stride == 1 ? 4 : 13);
        size_t const three_stride = three + (stride == 0 ? 0 : stride == 1 ? 8 : 7);
        bvx_mesh_view v = maker_view(&mesh);
        unsigned char *const p0 = positions + offset, *const t0 = indices + 2 * offset + (offset == 2);
        size_t const vertices = index == 0 ? 3 * mesh.triangles : mesh.vertices;
        memset(positions, 0xA7, most * 3 * 64 + 64);
        memset(indices, 0xA7, most * 64 + 64);
        for (size_t i = 0; i < vertices; i++)
            for (size_t a = 0; a < 3; a++) {
                double const d = mesh.p[3 * (index == 0 ? mesh.t[i] : i) + a];
                float const f = (float)d;
                if (f32) memcpy(p0 + i * point_stride + 4 * a, &f, 4);
                else memcpy(p0 + i * point_stride + 8 * a, &d, 8);
            }
        for (size_t i = 0; i < mesh.triangles && index != 0; i++)
            for (size_t c = 0; c < 3; c++) {
                uint32_t const n = mesh.t[3 * i + c];
                uint16_t const n16 = (uint16_t)n;
                uint64_t const n64 = n;
                unsigned char *const to = t0 + i * three_stride;
                if (index == BVX_U16) memcpy(to + 2 * c, &n16, 2);
                else if (index == BVX_U32) memcpy(to + 4 * c, &n, 4);
                else memcpy(to + 8 * c, &n64, 8);
            }
        v.positions = p0;
        v.position_type = f32 ? BVX_F32 : BVX_F64;
        v.position_stride = stride == 0 ? 0 : (uint32_t)point_stride;
        v.vertex_count = vertices;
        v.indices = index == 0 ? NULL : t0;
        v.index_type = (uint32_t)index;
        v.index_stride = stride == 0 || index == 0 ? 0 : (uint32_t)three_stride;
        memset(&got, 0, sizeof got);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, fill_with(ctx, &v, &l, NULL, BVX_FILL_PARITY, &got, NULL),
                                        bvx_last_message(ctx));
        assert_same_bits(&want, &got, "view");
        bvx_grid_free(ctx, &got);
    }
    bvx_grid_free(ctx, &want);
    free(positions);
    free(indices);
}

/* ---- Refusals ---- */

static bvx_grid untouched; /* stays empty */

static void assert_refused(const bvx_lattice *l, const bvx_window *window, bvx_status status,
                           const char *text)
{
    float *floats;
    bvx_mesh_view const view = mesh_view(&floats);
    bvx_grid const empty = {0};
    uint64_t const held = bvx_memory_used(ctx);

    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
        bvx_solid_report report;
        TEST_ASSERT_EQUAL_INT32(status, fill_with(ctx, &view, l, window, fill, &untouched, &report));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
        TEST_ASSERT_NULL(strchr(bvx_last_message(ctx), '\n'));
        TEST_ASSERT_EQUAL_MEMORY(&empty, &untouched, sizeof empty);
        TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_used(ctx));
    }
    free(floats);
}

static void test_bad_vertices_are_named_only_when_used(void)
{
    bvx_lattice const l = lattice_of(65, 12, 13);
    double const bad[5] = {nan(""), HUGE_VAL, -HUGE_VAL, 1e30, -16400};
    static const size_t places[6] = {0, 63, 64, 130, 179, 199};

    for (int32_t trial = 0; trial < 2 * 6 * 3 * 5; trial++) {
        size_t const at = places[trial / 2 % 6];
        int const a = trial / 12 % 3, i = trial / 36;
        char name[60];
        bvx_grid want, got;
        make_random(SOUP, 60, l.dims, 8);                          /* exact in floats too */
        for (int n = 0; n < 20; n++) maker_vertex(&mesh, 1, 2, 3); /* used by none */
        if (at < 180) mesh.t[at] = (uint32_t)(at + 1) % 180;
        as_floats = trial % 2;
        want = solid_of(&l, BVX_FILL_PARITY);
        mesh.p[3 * at + (size_t)a] = bad[i];
        got = solid_of(&l, BVX_FILL_PARITY);
        assert_same_bits(&want, &got, "an unused vertex");
        bvx_grid_free(ctx, &got);
        bvx_grid_free(ctx, &want);
        mesh.t[3 * 41 + 1] = (uint32_t)at;
        mesh.t[3 * 57 + 2] = (uint32_t)at;
        snprintf(name, sizeof name, "vertex %lu ", (unsigned long)at);
        assert_refused(&l, NULL, BVX_ERR_RANGE, name);
        assert_refused(&l, NULL, BVX_ERR_RANGE, i < 3 ? "triangle 41)" : "fraction bits");
        assert_refused(&l, NULL, BVX_ERR_RANGE, i < 3 ? "not finite" : "16384"); /* says what would fit */
    }
}

/* |q| < 2^30: the last coordinates that fit, and the first that do not. */
static void test_ends_of_the_fixed_point(void)
{
    bvx_lattice const l = lattice_of(8, 8, 8);
    double const most = 16384.0 - 1.0 / 65536;

    for (int a = 0; a < 3; a++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double const low[3] = {1, 1, 1}, high[3] = {6, 6, 6};
            maker_clear(&mesh);
            maker_box(&mesh, low, high);
            mesh.p[a] = sign * most;
            assert_both_rules(&l);
            mesh.p[a] = sign * 16384.0;
            assert_refused(&l, NULL, BVX_ERR_RANGE, "vertex 0");
            mesh.p[a] = sign * (16384.0 - 0.25 / 65536); /* rounds to 2^30 */
            assert_refused(&l, NULL, BVX_ERR_RANGE, "vertex 0");
        }
}

static void test_bad_indices_name_the_triangle(void)
{
    static const uint32_t bad[3] = {180, 181, UINT32_MAX};
    bvx_lattice const l = lattice_of(65, 12, 13);

    make_random(SOUP, 60, l.dims, 16);
    TEST_ASSERT_EQUAL_UINT64(180, mesh.vertices);
    for (size_t c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++) {
            uint32_t const kept = mesh.t[3 * 37 + c];
            mesh.t[3 * 37 + c] = bad[i];
            assert_refused(&l, NULL, BVX_ERR_RANGE, "triangle 37");
            mesh.t[3 * 37 + c] = kept;
        }
    {
        uint64_t wide[180]; /* indices of 64 bits are not cut short */
        bvx_mesh_view v = maker_view(&mesh);
        for (int i = 0; i < 180; i++) wide[i] = mesh.t[i];
        wide[3 * 20 + 2] += UINT64_C(1) << 32;
        v.indices = wide;
        v.index_type = BVX_U64;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                                fill_with(ctx, &v, &l, NULL, BVX_FILL_PARITY, &untouched, NULL));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "triangle 20"));
    }
    make_random(SOUP, 30000, l.dims, 16); /* of several, one is named, and the same whatever the threads */
    for (size_t t = 29999; t > 400; t -= 997) mesh.t[3 * t] = UINT32_MAX;
    assert_refused(&l, NULL, BVX_ERR_RANGE, "vertex index 4294967295");
    {
        bvx_mesh_view const v = maker_view(&mesh);
        for (int32_t threads = 2; threads <= 4; threads++) {
            bvx_context *const c = suite_context(threads, BVX_CPU_BEST);
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                                    fill_with(c, &v, &l, NULL, BVX_FILL_NONZERO, &untouched, NULL));
            TEST_ASSERT_EQUAL_STRING(bvx_last_message(ctx), bvx_last_message(c));
            bvx_context_destroy(c);
        }
    }
}

static void test_refusals_of_arguments(void)
{
    bvx_lattice l = lattice_of(10, 12, 13);
    bvx_window const outside[5] = {{{0, 0, 0}, {11, 12, 13}},
                                   {{-1, 0, 0}, {5, 5, 5}},
                                   {{0, 0, 9}, {1, 1, 5}},
                                   {{0, 3, 0}, {1, 0, 1}},
                                   {{INT32_MAX, 0, 0}, {INT32_MAX, 1, 1}}};
    bvx_mesh_view v;
    bvx_voxelize_options o = {.struct_size = sizeof o};

    make_random(SOUP, 10, l.dims, 16);
    v = maker_view(&mesh);
    for (int i = 0; i < 5; i++) assert_refused(&l, &outside[i], BVX_ERR_RANGE, "window");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(NULL, &v, &l, NULL, &untouched));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, NULL, &l, NULL, &untouched));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, NULL, NULL, &untouched));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, NULL, NULL));
    o.fill = 8;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    o.fill = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    o.fill = 0;
    o.struct_size = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    l.spacing[1] = 0;
    assert_refused(&l, NULL, BVX_ERR_ARGUMENT, "spacing");
    l.spacing[1] = 1;
    l.fraction_bits = 17;
    assert_refused(&l, NULL, BVX_ERR_ARGUMENT, "fraction");
    l.fraction_bits = 16;
    l.dims[2] = 0;
    assert_refused(&l, NULL, BVX_ERR_RANGE, "voxels");
    l.dims[2] = 13;
    mesh.triangles = 0;
    assert_refused(&l, NULL, BVX_ERR_EMPTY, "no triangles");
    l = lattice_of(1 << 25, 1 << 25, 1 << 25);
    make_random(SOUP, 10, outside[1].size, 4);
    assert_refused(&l, NULL, BVX_ERR_RANGE, "64 bits");
}

/* ---- Arrays of the caller's ---- */

static void test_callers_array_is_filled_in_place(void)
{
    bvx_lattice const l = lattice_of(70, 5, 6);
    bvx_window const w = {{3, 1, 2}, {66, 3, 4}};
    uint64_t words[40];
    bvx_mesh_view v;

    make_random(SOUP, 60, l.dims, 16);
    v = maker_view(&mesh);
    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
        bvx_grid want = solid_by(ctx, &l, &w, fill, NULL), g = {0};
        memset(words, 0xEE, sizeof words);
        g.words = words + 1;
        g.word_capacity = 23;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, fill_with(ctx, &v, &l, &w, fill, &g, NULL));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "24 words"));
        for (int i = 0; i < 40; i++) TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[i]);
        for (uint64_t capacity = 24; capacity <= 38; capacity += 14) {
            memset(words, 0xEE, sizeof words);
            memset(&g, 0, sizeof g);
            g.words = words + 1;
            g.word_capacity = capacity;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_with(ctx, &v, &l, &w, fill, &g, NULL));
            TEST_ASSERT_EQUAL_PTR(words + 1, g.words);
            TEST_ASSERT_EQUAL_UINT64(capacity, g.word_capacity);
            TEST_ASSERT_EQUAL_INT32(0, g.owned);
            assert_same_bits(&want, &g, "the caller's array");
            TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[0]);
            for (int i = 25; i < 40; i++) TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[i]);
        }
        bvx_grid_free(ctx, &want);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_box_on_voxel_planes_fills_its_voxels);
    RUN_TEST(test_box_on_centres_is_half_open);
    RUN_TEST(test_report_by_hand);
    RUN_TEST(test_rows_by_hand);
    RUN_TEST(test_all_kinds_of_view_give_the_same_bits);
    RUN_TEST(test_bad_vertices_are_named_only_when_used);
    RUN_TEST(test_ends_of_the_fixed_point);
    RUN_TEST(test_bad_indices_name_the_triangle);
    RUN_TEST(test_refusals_of_arguments);
    RUN_TEST(test_callers_array_is_filled_in_place);
    return UNITY_END();
}
