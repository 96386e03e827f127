/* test_surface.c - bvx_extract_surface against marching cubes done cell by
 * cell: every position, every triangle. */
#include "tools/surface_oracle.h"

#include <math.h>

#include "suite.h"

static uint64_t seed;
static bvx_grid grid;

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0x5a7face);
}

void tearDown(void)
{
    bvx_grid_free(ctx, &grid);
    suite_close();
}

static bvx_extract_options extract_options(void)
{
    bvx_extract_options const o = {.struct_size = sizeof o, .position_type = BVX_F32};
    return o;
}

static double const odd_origin[3] = {-3.7, 12.1, 0.3}, odd_spacing[3] = {0.1, 0.3, 0.7};

/* An empty grid of this window size; low shifts the window within its lattice. */
static void open_grid(const double origin[3], const double spacing[3], int32_t x, int32_t y, int32_t z,
                      int32_t low)
{
    int32_t const dims[3] = {x + 2 * low, y + 2 * low, z + 2 * low};
    bvx_window const w = {{low, low, low}, {x, y, z}};
    bvx_lattice l;
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &grid));
}

/* Noise; full out of 16 voxels are set. */
static void sprinkle(int32_t full)
{
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                bvx_grid_set(&grid, x, y, z, maker_below(&seed, 16) < full);
}

static bvx_mesh surface_by(bvx_context *c, const bvx_extract_options *o)
{
    bvx_mesh m = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_surface(c, &grid, o, &m), bvx_last_message(c));
    return m;
}

static void assert_mesh_is(const oracle_surface *s, const bvx_extract_options *o, const bvx_mesh *m)
{
    uint64_t vertices = 0, triangles = 0;

    TEST_ASSERT_EQUAL_UINT64(s->vertices, m->vertex_count);
    TEST_ASSERT_EQUAL_UINT64(s->triangle_count, m->triangle_count);
    TEST_ASSERT_EQUAL_INT32(o->position_type, m->position_type);
    if (s->triangle_count != 0)
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, memcmp(s->triangles, m->triangles, (size_t)s->triangle_count * 12),
                                      "triangles");
    for (uint64_t i = 0; i < 3 * s->vertices; i++) {
        if (o->position_type == BVX_F32) {
            if (((const float *)m->positions)[i] != (float)s->positions[i])
                TEST_FAIL_MESSAGE("a position (f32)");
        } else {
            if (((const double *)m->positions)[i] != s->positions[i]) TEST_FAIL_MESSAGE("a position (f64)");
        }
    }
    for (int a = 0; a < 3; a++)
        TEST_ASSERT_TRUE(m->frame[a] == (o->local_frame ? grid.lattice.origin[a] : 0.0));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_count(ctx, &grid, o, &vertices, &triangles));
    TEST_ASSERT_EQUAL_UINT64(s->vertices, vertices);
    TEST_ASSERT_EQUAL_UINT64(s->triangle_count, triangles);
}

static void assert_is_oracle(const bvx_extract_options *o)
{
    oracle_surface s = oracle_extract(&grid, o);
    bvx_mesh m = surface_by(ctx, o);
    assert_mesh_is(&s, o, &m);
    TEST_ASSERT_TRUE(m.vertex_count == 0 || m.positions != NULL);
    TEST_ASSERT_TRUE(o->keys || (m.vertex_keys == NULL && m.triangle_keys == NULL));
    bvx_mesh_free(ctx, &m);
    oracle_surface_free(&s);
}

static void assert_same_mesh(const bvx_mesh *a, const bvx_mesh *b)
{
    TEST_ASSERT_EQUAL_UINT64(a->vertex_count, b->vertex_count);
    TEST_ASSERT_EQUAL_UINT64(a->triangle_count, b->triangle_count);
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->positions, b->positions,
                                    (size_t)a->vertex_count * (a->position_type == BVX_F32 ? 12 : 24)));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * 12));
    TEST_ASSERT_EQUAL_INT(a->vertex_keys == NULL, b->vertex_keys == NULL);
    if (a->vertex_keys == NULL) return;
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->vertex_keys, b->vertex_keys, (size_t)a->vertex_count * 8));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->triangle_keys, b->triangle_keys, (size_t)a->triangle_count * 8));
}

/* ---- By hand ---- */

static void test_one_voxel_is_an_octahedron(void)
{
    static const float want[18] = {2.5f, 3.5f, 4,    2.5f, 3, 4.5f, 2,    3.5f, 4.5f,
                                   3,    3.5f, 4.5f, 2.5f, 4, 4.5f, 2.5f, 3.5f, 5};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    bvx_extract_options const o = extract_options();
    bvx_mesh m;
    bvx_mesh_view view;
    bvx_certificate c;

    TEST_ASSERT_EQUAL_INT32(BVX_FACE_SEPARATE, o.face_rule);
    TEST_ASSERT_EQUAL_INT32(BVX_F32, o.position_type);
    open_grid(origin, spacing, 5, 6, 7, 0);
    bvx_grid_set(&grid, 2, 3, 4, 1);
    m = surface_by(ctx, NULL);
    TEST_ASSERT_EQUAL_UINT64(6, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(8, m.triangle_count);

    /* by (z, y, axis, x): the z-edge below, then row y = 2's y-edge, row y
     * = 3's x-edges, its y-edge, its z-edge */
    TEST_ASSERT_EQUAL_FLOAT_ARRAY(want, m.positions, 18);
    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
    TEST_ASSERT_EQUAL_INT64(2, c.euler);
    TEST_ASSERT_EQUAL_DOUBLE(1.0 / 6, c.volume);
    bvx_mesh_free(ctx, &m);
    TEST_ASSERT_NULL(m.positions);
}

/* Two voxels that touch along an edge: one piece or two. */
static void test_face_rules_join_or_separate(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};

    for (int32_t rule = 0; rule < 2; rule++) {
        bvx_extract_options o = extract_options();
        bvx_mesh m;
        bvx_mesh_view view;
        bvx_certificate c;
        o.face_rule = rule;
        open_grid(origin, spacing, 3, 3, 3, 0);
        bvx_grid_set(&grid, 0, 0, 1, 1);
        bvx_grid_set(&grid, 1, 1, 1, 1);
        m = surface_by(ctx, &o);
        bvx_mesh_view_of(&m, &view);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
        TEST_ASSERT_EQUAL_UINT64(rule == BVX_FACE_JOIN ? 1 : 2, c.components);
        TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented && c.volume > 0);
        bvx_mesh_free(ctx, &m);
    }
}

static void test_empty_and_full_grids(void)
{
    static const int32_t widths[] = {1, 63, 64, 65, 128};

    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (int32_t sides = 0; sides < 64; sides++) {
            bvx_extract_options o = extract_options();
            bvx_mesh m;
            o.open_sides = sides;
            open_grid(odd_origin, odd_spacing, widths[w], 3, 4, 1);
            m = surface_by(ctx, &o);
            TEST_ASSERT_EQUAL_UINT64(0, m.vertex_count);
            TEST_ASSERT_EQUAL_UINT64(0, m.triangle_count);
            bvx_mesh_free(ctx, &m);
            assert_is_oracle(&o);
            sprinkle(16);
            assert_is_oracle(&o);
            m = surface_by(ctx, &o);
            if (sides == 63) TEST_ASSERT_EQUAL_UINT64(0, m.vertex_count);
            bvx_mesh_free(ctx, &m);
        }
}

/* ---- Noise against the oracle ---- */

static void test_noise_at_all_widths(void)
{
    static const int32_t widths[] = {1, 2, 63, 64, 65, 127, 128, 129, 191, 192, 193};
    static const int32_t densities[] = {1, 4, 8, 12, 15};

    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (size_t d = 0; d < sizeof densities / sizeof densities[0]; d++)
            for (int32_t kind = 0; kind < 8; kind++) {
                bvx_extract_options o = extract_options();
                o.face_rule = kind & 1;
                o.position_type = kind & 2 ? BVX_F64 : BVX_F32;
                o.local_frame = kind >> 2;
                open_grid(odd_origin, odd_spacing, widths[w], 2 + kind % 3 * 5, 9 - kind, (int32_t)d);
                sprinkle(densities[d]);
                assert_is_oracle(&o);
            }
}

static void test_noise_on_flat_grids(void)
{
    static const int32_t sizes[][3] = {{1, 1, 1},  {1, 1, 50}, {1, 50, 1}, {64, 1, 1}, {65, 1, 9},
                                       {65, 9, 1}, {1, 9, 9},  {2, 2, 2},  {64, 2, 1}};

    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (int32_t density = 2; density <= 16; density += 7)
            for (int32_t rule = 0; rule < 2; rule++) {
                bvx_extract_options o = extract_options();
                o.face_rule = rule;
                open_grid(odd_origin, odd_spacing, sizes[s][0], sizes[s][1], sizes[s][2], 2);
                sprinkle(density);
                assert_is_oracle(&o);
            }
}

static void test_all_combinations_of_open_sides(void)
{
    static const int32_t sizes[][3] = {{2, 2, 2},  {5, 4, 3},   {63, 3, 4}, {64, 4, 3},
                                       {65, 3, 3}, {128, 2, 3}, {129, 3, 2}};

    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (int32_t sides = 0; sides < 64; sides++)
            for (int32_t density = 4; density <= 12; density += 4) {
                bvx_extract_options o = extract_options();
                o.open_sides = sides;
                o.face_rule = density / 4 % 2;
                o.keys = sides % 2;
                open_grid(odd_origin, odd_spacing, sizes[s][0], sizes[s][1], sizes[s][2], 1);
                sprinkle(density);
                assert_is_oracle(&o);
            }
}

/* Windows of one voxel along some axis, where open sides leave no cell: no vertex that no triangle uses. */
static void test_open_sides_of_flat_windows(void)
{
    static const int32_t sizes[][3] = {{1, 1, 1}, {1, 5, 6},  {66, 1, 6}, {66, 6, 1},
                                       {1, 1, 6}, {66, 1, 1}, {1, 6, 1}};

    for (int32_t sides = 0; sides < 64; sides++)
        for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
            for (int32_t density = 8; density <= 16; density += 8) {
                bvx_extract_options o = extract_options();
                o.open_sides = sides;
                open_grid(odd_origin, odd_spacing, sizes[s][0], sizes[s][1], sizes[s][2], 1);
                sprinkle(density);
                assert_is_oracle(&o);
            }
}

/* Long rows: several blocks of words, with every edge crossed in some. */
static void test_long_rows(void)
{
    static const int32_t widths[] = {1022, 1023, 1024, 1025, 2047, 2048, 2049, 3100};

    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (int32_t density = 1; density <= 15; density += 7) {
            bvx_extract_options o = extract_options();
            o.face_rule = density & 1;
            o.open_sides = density == 8 ? 3 : 0;
            open_grid(odd_origin, odd_spacing, widths[w], 2, 3, 1);
            sprinkle(density);
            /* a chessboard: all edges but the outermost */
            for (int32_t x = 0; x < widths[w] && density == 15; x++)
                for (int32_t y = 0; y < 6; y++) bvx_grid_set(&grid, x, y % 2, y / 2, (x + y % 2 + y / 2) % 2);
            assert_is_oracle(&o);
        }
}

/* Long runs that begin and end at or near the edges of words, alike in most rows: words all set, all empty,
 * and every change between them, also where blocks of words meet. */
static void test_runs_at_the_edges_of_words(void)
{
    static const int32_t widths[] = {64, 128, 129, 320, 1023, 1024, 1025, 1088, 1089, 2048, 2113};

    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (int32_t trial = 0; trial < (quick ? 4 : 24); trial++) {
            int32_t const nx = widths[w], ny = 1 + trial % 3, nz = 1 + trial / 3 % 3;
            bvx_extract_options o = extract_options();
            o.face_rule = trial & 1;
            o.open_sides = trial % 4 == 3 ? maker_below(&seed, 64) : 0;
            open_grid(odd_origin, odd_spacing, nx, ny, nz, 1);
            for (int32_t run = 0; run < 1 + nx / 160; run++) {
                int32_t const near_edge = maker_below(&seed, 3), off = maker_below(&seed, 3) - 1;
                int32_t const begin = near_edge ? maker_below(&seed, nx / 64 + 1) * 64 + off
                                                : maker_below(&seed, nx);
                int32_t const end = begin +
                                    (near_edge ? (1 + maker_below(&seed, 4)) * 64 + maker_below(&seed, 3) - 1
                                               : maker_below(&seed, 300));
                int32_t const value = maker_below(&seed, 4) != 0, some = maker_below(&seed, 4) == 0;
                for (int32_t row = 0; row < ny * nz; row++)
                    for (int32_t x = begin < 0 ? 0 : begin;
                         x < end && x < nx && !(some && maker_below(&seed, 300) == 0); x++)
                        bvx_grid_set(&grid, x, row % ny, row / ny, value);
            }
            assert_is_oracle(&o);
        }
}

/* Many rows: more slots than pieces, rows of several words. */
static void test_noise_in_many_pieces(void)
{
    static const int32_t sizes[][3] = {{300, 40, 37}, {70, 130, 150}};

    for (int32_t s = 0; s < (quick ? 1 : 2); s++) {
        bvx_extract_options o = extract_options();
        open_grid(odd_origin, odd_spacing, sizes[s][0], sizes[s][1], sizes[s][2], 0);
        sprinkle(3 + 5 * s);
        o.position_type = BVX_F64;
        assert_is_oracle(&o);
        o.face_rule = BVX_FACE_JOIN;
        assert_is_oracle(&o);
    }
}

/* ---- The certificate ---- */

static void assert_certified(const bvx_extract_options *o)
{
    bvx_mesh m = surface_by(ctx, o);
    bvx_mesh_view view;
    uint64_t voxels;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &grid, &voxels));
    bvx_mesh_view_of(&m, &view);
    for (int32_t weld = 0; weld < 2; weld++) {
        bvx_certificate c;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, weld, &c));
        if (voxels == 0) {
            TEST_ASSERT_EQUAL_UINT64(0, c.triangles);
            continue;
        }
        TEST_ASSERT_EQUAL_INT32(1, c.closed);
        TEST_ASSERT_EQUAL_INT32(1, c.edge_manifold);
        TEST_ASSERT_EQUAL_INT32(1, c.vertex_manifold);
        TEST_ASSERT_EQUAL_INT32(1, c.oriented);
        TEST_ASSERT_EQUAL_UINT64(m.vertex_count, c.vertices); /* also in f32 no two positions are equal */
        TEST_ASSERT_EQUAL_UINT64(m.triangle_count, c.triangles);
        TEST_ASSERT_EQUAL_UINT64(0, c.unused_vertices);
        TEST_ASSERT_EQUAL_UINT64(0, c.collapsed);
        TEST_ASSERT_EQUAL_UINT64(0, c.degenerate);
        TEST_ASSERT_EQUAL_UINT64(0, c.duplicates);
        TEST_ASSERT_TRUE(c.volume > 0);
        TEST_ASSERT_TRUE(c.area > 0);
    }
    bvx_mesh_free(ctx, &m);
}

static void test_noise_is_closed_and_manifold(void)
{
    static const int32_t sizes[][3] = {{1, 1, 1},    {63, 7, 8},  {64, 8, 7},  {65, 20, 20},
                                       {129, 9, 10}, {4, 40, 40}, {30, 30, 30}};

    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (int32_t density = 0; density <= 16; density += quick ? 4 : 1)
            for (int32_t rule = 0; rule < 2; rule++) {
                bvx_extract_options o = extract_options();
                o.face_rule = rule;
                o.position_type = density % 2 ? BVX_F64 : BVX_F32;
                open_grid(odd_origin, odd_spacing, sizes[s][0], sizes[s][1], sizes[s][2], 0);
                sprinkle(density);
                assert_certified(&o);
            }
}

/* All sets of 2 x 2 x 2 voxels and many of 3 x 3 x 3. */
static void test_all_small_sets_are_closed_and_manifold(void)
{
    for (int32_t n = 0; n < (quick ? 300 : 2256); n++)
        for (int32_t rule = 0; rule < 2; rule++) {
            int32_t const side = n < 256 ? 2 : 3;
            bvx_extract_options o = extract_options();
            o.face_rule = rule;
            open_grid(odd_origin, odd_spacing, side, side, side, 0);
            if (n < 256)
                for (int i = 0; i < 8; i++) bvx_grid_set(&grid, i & 1, i >> 1 & 1, i >> 2, n >> i & 1);
            else sprinkle(8);
            assert_is_oracle(&o);
            assert_certified(&o);
        }
}

/* ---- Keys ---- */

static void test_keys_are_in_order_and_belong_to_the_lattice(void)
{
    bvx_extract_options o = extract_options();
    bvx_mesh m;

    o.keys = 1;
    open_grid(odd_origin, odd_spacing, 70, 6, 7, 3);
    sprinkle(7);
    assert_is_oracle(&o);
    m = surface_by(ctx, &o);
    TEST_ASSERT_NOT_NULL(m.vertex_keys);
    TEST_ASSERT_NOT_NULL(m.triangle_keys);
    for (uint64_t i = 1; i < m.vertex_count; i++) TEST_ASSERT_TRUE(m.vertex_keys[i - 1] < m.vertex_keys[i]);
    for (uint64_t i = 1; i < m.triangle_count; i++)
        TEST_ASSERT_TRUE(m.triangle_keys[i - 1] <= m.triangle_keys[i]);
    bvx_mesh_free(ctx, &m);
}

/* [Limit: dims < 2^20] */
static void test_keys_have_a_limit(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};

    for (int a = 0; a < 3; a++)
        for (int32_t over = 0; over < 2; over++) {
            int32_t dims[3] = {2, 2, 2};
            bvx_extract_options o = extract_options();
            bvx_window w = {{0, 0, 0}, {2, 2, 2}};
            bvx_lattice l;
            bvx_mesh m = {0};
            bvx_status status;
            dims[a] = (1 << 20) - 1 + over;
            w.low[a] = dims[a] - 2;
            o.keys = 1;
            o.position_type = BVX_F64;
            bvx_grid_free(ctx, &grid);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &grid));
            sprinkle(16);
            status = bvx_extract_surface(ctx, &grid, &o, &m);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(over ? BVX_ERR_RANGE : BVX_OK, status, bvx_last_message(ctx));
            for (uint64_t i = 1; i < m.vertex_count; i++)
                TEST_ASSERT_TRUE(m.vertex_keys[i - 1] < m.vertex_keys[i]);
            bvx_mesh_free(ctx, &m);
        }
}

/* ---- What may not matter ---- */

static void test_threads_and_code_paths_agree(void)
{
    for (int32_t trial = 0; trial < 4; trial++) {
        bvx_extract_options o = extract_options();
        bvx_mesh a;
        o.face_rule = trial % 2;
        o.position_type = trial / 2 ? BVX_F64 : BVX_F32;
        o.keys = trial == 3;
        o.open_sides = trial == 2 ? 0x29 : 0;
        open_grid(odd_origin, odd_spacing, 130 + trial, 50, 60 - trial, 1);
        sprinkle(2 + 4 * trial);
        a = surface_by(ctx, &o);
        for (int32_t n = 1; n <= 10; n++) {
            bvx_context *const c = suite_context(n <= 8 ? n : n - 8,
                                                 n <= 8 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            bvx_mesh b = surface_by(c, &o);
            assert_same_mesh(&a, &b);
            bvx_mesh_free(c, &b);
            bvx_context_destroy(c);
        }
        bvx_mesh_free(ctx, &a);
    }
}

/* ---- Positions too fine for f32 ---- */

static bvx_mesh nothing; /* stays empty */

static void assert_refused(bvx_status status, const bvx_extract_options *o, const char *text)
{
    bvx_mesh const empty = {0};
    TEST_ASSERT_EQUAL_INT32(status, bvx_extract_surface(ctx, &grid, o, &nothing));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&empty, &nothing, sizeof empty);
}

static void test_f32_is_refused_where_it_is_too_coarse(void)
{
    static const double origin[3] = {500000, 5000000, 100}, spacing[3] = {0.01, 0.01, 0.01};
    bvx_extract_options o = extract_options();
    uint64_t vertices, triangles;

    open_grid(origin, spacing, 20, 21, 22, 0);
    sprinkle(8);
    assert_refused(BVX_ERR_RANGE, &o, "f64");
    assert_refused(BVX_ERR_RANGE, &o, "local frame");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_extract_count(ctx, &grid, &o, &vertices, &triangles));
    o.position_type = BVX_F64;
    assert_is_oracle(&o);
    assert_certified(&o);
    o.position_type = BVX_F32;
    o.local_frame = 1;
    assert_is_oracle(&o);
    assert_certified(&o);
    {
        bvx_mesh m = surface_by(ctx, &o);
        TEST_ASSERT_EQUAL_MEMORY(origin, m.frame, sizeof origin);
        bvx_mesh_free(ctx, &m);
    }
}

/* The step of f32 doubles at 65536 to 1/128: voxels of 1 just fit below, not there. */
static void test_f32_is_accepted_to_the_last_step(void)
{
    for (int a = 0; a < 3; a++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double origin[3] = {0, 0, 0};
            static const double spacing[3] = {1, 1, 1};
            bvx_extract_options const o = extract_options();
            origin[a] = sign > 0 ? 65536.0 - 10 : -65535.99;
            open_grid(origin, spacing, 9, 9, 9, 0);
            sprinkle(16);
            assert_is_oracle(&o);
            assert_certified(&o);
            origin[a] = sign > 0 ? 65536.0 - 9 : -65536.0;
            open_grid(origin, spacing, 9, 9, 9, 0);
            sprinkle(16);
            assert_refused(BVX_ERR_RANGE, &o, "65536");
        }
}

/* Far below and far above one: f32 keeps 24 bits there as well. */
static void test_f32_at_other_scales(void)
{
    static const int scales[6] = {-100, -90, -30, 30, 90, 110};

    for (int i = 0; i < 6; i++) {
        double const origin[3] = {0, 0, 0}, step = ldexp(1, scales[i]), spacing[3] = {step, step, step};
        bvx_extract_options const o = extract_options();
        open_grid(origin, spacing, 9, 9, 9, 0);
        sprinkle(8);
        assert_is_oracle(&o);
    }
    {
        double const origin[3] = {0, 0, 3.4e38}, spacing[3] = {1e36, 1e36, 1e36};
        bvx_extract_options const o = extract_options();
        open_grid(origin, spacing, 9, 9, 9, 0);
        assert_refused(BVX_ERR_RANGE, &o, "f32");
    }
}

/* ---- Arrays of the caller's ---- */

static void test_callers_arrays(void)
{
    for (int32_t kind = 0; kind < 4; kind++) {
        bvx_extract_options o = extract_options();
        oracle_surface s;
        uint64_t vertices, triangles;
        size_t point;
        unsigned char *positions, *tri;
        uint64_t *vertex_keys, *triangle_keys;
        o.position_type = kind & 1 ? BVX_F64 : BVX_F32;
        o.keys = kind >> 1;
        point = kind & 1 ? 24 : 12;
        open_grid(odd_origin, odd_spacing, 66, 7, 8, 1);
        sprinkle(6);
        s = oracle_extract(&grid, &o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_count(ctx, &grid, &o, &vertices, &triangles));
        positions = maker_grow(NULL, (size_t)(vertices + 40) * point);
        tri = maker_grow(NULL, (size_t)(triangles + 40) * 12);
        vertex_keys = maker_grow(NULL, (size_t)(vertices + 40) * 8);
        triangle_keys = maker_grow(NULL, (size_t)(triangles + 40) * 8);
        /* -2: a vertex short, -1: a triangle short */
        for (int32_t more = -2; more <= 40; more += more < 1 ? 1 : 13) {
            bvx_mesh m;
            bvx_status status;
            uint64_t const room = more > 0 ? (uint64_t)more : 0;
            memset(positions, 0xEE, (size_t)(vertices + 40) * point);
            memset(tri, 0xEE, (size_t)(triangles + 40) * 12);
            memset(vertex_keys, 0xEE, (size_t)(vertices + 40) * 8);
            memset(triangle_keys, 0xEE, (size_t)(triangles + 40) * 8);
            memset(&m, 0, sizeof m);
            m.positions = positions;
            m.triangles = (uint32_t *)(void *)tri;
            m.vertex_keys = o.keys ? vertex_keys : NULL;
            m.triangle_keys = o.keys ? triangle_keys : NULL;
            m.vertex_capacity = vertices + room - (more == -2);
            m.triangle_capacity = triangles + room - (more == -1);
            m.position_type = o.position_type;
            m.frame[1] = 5; /* of a use before */
            status = bvx_extract_surface(ctx, &grid, &o, &m);
            if (more < 0) {
                char text[40];
                TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, status);
                snprintf(text, sizeof text, "%lu vertices and %lu triangles", (unsigned long)vertices,
                         (unsigned long)triangles);
                TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
                TEST_ASSERT_EACH_EQUAL_HEX8(0xEE, positions, (size_t)(vertices + 40) * point);
                TEST_ASSERT_EACH_EQUAL_HEX8(0xEE, tri, (size_t)(triangles + 40) * 12);
                continue;
            }
            TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
            TEST_ASSERT_EQUAL_PTR(positions, m.positions);
            TEST_ASSERT_EQUAL_INT32(0, m.owned);
            TEST_ASSERT_EQUAL_UINT64(vertices + room, m.vertex_capacity);
            assert_mesh_is(&s, &o, &m);
            TEST_ASSERT_EACH_EQUAL_HEX8(0xEE, positions + vertices * point, 40 * point);
            TEST_ASSERT_EACH_EQUAL_HEX8(0xEE, tri + triangles * 12, 40 * 12);
            TEST_ASSERT_EACH_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), vertex_keys + (o.keys ? vertices : 0),
                                         40);
            TEST_ASSERT_EACH_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE),
                                         triangle_keys + (o.keys ? triangles : 0), 40);
        }
        free(positions);
        free(tri);
        free(vertex_keys);
        free(triangle_keys);
        oracle_surface_free(&s);
    }
}

static void test_callers_arrays_that_do_not_fit_the_request(void)
{
    float positions[300];
    uint32_t triangles[300];
    bvx_extract_options o = extract_options();
    bvx_mesh m = {0}, before;

    open_grid(odd_origin, odd_spacing, 3, 3, 3, 0);
    bvx_grid_set(&grid, 1, 1, 1, 1);
    m.positions = positions;
    m.triangles = triangles;
    m.vertex_capacity = m.triangle_capacity = 100;
    m.position_type = BVX_F32;
    before = m;
    o.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &grid, &o, &m));
    o.position_type = BVX_F32;
    o.keys = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &grid, &o, &m));
    o.keys = 0;
    TEST_ASSERT_EQUAL_MEMORY(&before, &m, sizeof m);
    m.triangles = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &grid, &o, &m));
    m.triangles = triangles;
    m.positions = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &grid, &o, &m));
}

/* A mesh of the library's is filled again when it is large enough. */
static void test_a_mesh_is_used_again(void)
{
    bvx_extract_options const o = extract_options();
    oracle_surface s;
    bvx_mesh m;

    open_grid(odd_origin, odd_spacing, 66, 7, 8, 1);
    sprinkle(8);
    m = surface_by(ctx, &o);
    bvx_grid_set(&grid, 5, 5, 5, 0);
    for (int32_t x = 0; x < 66; x++) bvx_grid_set(&grid, x, 2, 2, 0);
    sprinkle(1);
    s = oracle_extract(&grid, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &grid, &o, &m));
    assert_mesh_is(&s, &o, &m);
    TEST_ASSERT_EQUAL_INT32(1, m.owned);
    bvx_mesh_free(ctx, &m);
    oracle_surface_free(&s);
}

/* ---- Refusals ---- */

static void test_refusals_of_arguments(void)
{
    bvx_extract_options o = extract_options();
    uint64_t vertices, triangles;
    bvx_mesh m = {0};

    open_grid(odd_origin, odd_spacing, 5, 5, 5, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(NULL, &grid, NULL, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, NULL, NULL, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &grid, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_count(NULL, &grid, NULL, &vertices, &triangles));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_count(ctx, NULL, NULL, &vertices, &triangles));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_count(ctx, &grid, NULL, NULL, &triangles));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_count(ctx, &grid, NULL, &vertices, NULL));
    o.face_rule = 2;
    assert_refused(BVX_ERR_ARGUMENT, &o, "face_rule 2");
    o.face_rule = -1;
    assert_refused(BVX_ERR_ARGUMENT, &o, "face_rule -1");
    o = extract_options();
    o.position_type = 3;
    assert_refused(BVX_ERR_ARGUMENT, &o, "position_type 3");
    o.position_type = -1;
    assert_refused(BVX_ERR_ARGUMENT, &o, "position_type -1");
    o = extract_options();
    o.open_sides = 64;
    assert_refused(BVX_ERR_ARGUMENT, &o, "open_sides is 64");
    o.open_sides = -1;
    assert_refused(BVX_ERR_ARGUMENT, &o, "open_sides is -1");
    o = extract_options();
    o.keys = 2;
    assert_refused(BVX_ERR_ARGUMENT, &o, "keys");
    o = extract_options();
    o.local_frame = -1;
    assert_refused(BVX_ERR_ARGUMENT, &o, "local_frame");
    o = extract_options();
    o.reserved = 1;
    assert_refused(BVX_ERR_ARGUMENT, &o, "reserved");
    o = extract_options();
    o.struct_size = 1;
    assert_refused(BVX_ERR_ARGUMENT, &o, "size");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_count(ctx, &grid, &o, &vertices, &triangles));
    {
        bvx_grid bad = grid;
        bad.size[1] = 6;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_extract_surface(ctx, &bad, NULL, &m));
        bad = grid;
        bad.word_capacity = 24;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_extract_surface(ctx, &bad, NULL, &m));
        bad = grid;
        bad.words = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &bad, NULL, &m));
    }
}

/* Bits past a row's end cannot be counted and placed alike, so words that
 * hold one are refused wherever it is. */
static void test_bits_past_the_rows_are_refused(void)
{
    static const int32_t widths[4] = {5, 63, 65, 130};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};

    for (int32_t w = 0; w < 4; w++) {
        open_grid(origin, spacing, widths[w], 4, 3, 0);
        for (uint64_t row = 0; row < 12; row++)
            for (int32_t bit = widths[w] % 64; bit < 64; bit += bit < 62 ? 62 - bit : 1) {
                uint64_t *const word = &grid.words[(row + 1) * (uint64_t)grid.words_per_row - 1];
                bvx_extract_options const o = extract_options();
                bvx_mesh mesh = {0};
                uint64_t vertices, triangles;
                *word |= UINT64_C(1) << bit;
                TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_surface(ctx, &grid, &o, &mesh));
                TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bits set past the"));
                TEST_ASSERT_NULL(mesh.positions);
                TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                                        bvx_extract_count(ctx, &grid, &o, &vertices, &triangles));
                *word &= ~(UINT64_C(1) << bit);
            }
        bvx_grid_free(ctx, &grid);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_one_voxel_is_an_octahedron);
    RUN_TEST(test_face_rules_join_or_separate);
    RUN_TEST(test_empty_and_full_grids);
    RUN_TEST(test_noise_at_all_widths);
    RUN_TEST(test_noise_on_flat_grids);
    RUN_TEST(test_all_combinations_of_open_sides);
    RUN_TEST(test_open_sides_of_flat_windows);
    RUN_TEST(test_long_rows);
    RUN_TEST(test_runs_at_the_edges_of_words);
    RUN_TEST(test_noise_in_many_pieces);
    RUN_TEST(test_noise_is_closed_and_manifold);
    RUN_TEST(test_all_small_sets_are_closed_and_manifold);
    RUN_TEST(test_keys_are_in_order_and_belong_to_the_lattice);
    RUN_TEST(test_keys_have_a_limit);
    RUN_TEST(test_threads_and_code_paths_agree);
    RUN_TEST(test_f32_is_refused_where_it_is_too_coarse);
    RUN_TEST(test_f32_is_accepted_to_the_last_step);
    RUN_TEST(test_f32_at_other_scales);
    RUN_TEST(test_callers_arrays);
    RUN_TEST(test_callers_arrays_that_do_not_fit_the_request);
    RUN_TEST(test_a_mesh_is_used_again);
    RUN_TEST(test_refusals_of_arguments);
    RUN_TEST(test_bits_past_the_rows_are_refused);
    return UNITY_END();
}
