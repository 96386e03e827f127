/* test_below.c - the rule below against every triangle and centre by themselves; volumes of terrains by
 * hand. */
#include "solid_support.h"
#include "tools/fill_oracle.h"

typedef struct below_terms {
    int32_t axis;
    double base;
    const maker_mesh *second;
    const bvx_window *window;
} below_terms;

static bvx_grid below_by(bvx_context *c, const bvx_lattice *l, const below_terms *b, bvx_solid_report *r)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_mesh_view other;
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};

    o.fill = BVX_FILL_BELOW;
    o.up = (b->axis + 1) % 3; /* BVX_UP_Z, X, Y */
    o.has_base = 1;
    o.base = b->base;
    o.report = r;
    if (b->window != NULL) o.window = *b->window;
    if (b->second != NULL) {
        other = maker_view(b->second);
        o.second = &other;
    }
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_voxelize_solid(c, &view, l, &o, &g), bvx_last_message(c));
    return g;
}

static int64_t *snapped_mesh(const maker_mesh *m, const bvx_lattice *l)
{
    int64_t *const q = maker_grow(NULL, (m->vertices + 1) * 3 * sizeof *q);
    for (size_t i = 0; i < 3 * m->vertices; i++)
        q[i] = oracle_snap(m->p[i], l->origin[i % 3], l->spacing[i % 3], l->fraction_bits);
    return q;
}

/* 0: nothing on the line; 1: all crossings lie before the centre; 2: one lies behind it. */
static int look_up(const maker_mesh *m, const int64_t *q, const int64_t c[3], int axis)
{
    int found = 0;

    for (size_t t = 0; t < m->triangles; t++) {
        const int64_t *p[3];
        int where;
        for (int k = 0; k < 3; k++) p[k] = q + 3 * (size_t)m->t[3 * t + (size_t)k];
        where = fill_crosses(p, c, axis);
        if (where > found) found = where;
    }
    return found;
}

static void assert_below_is_oracle(const bvx_lattice *l, const below_terms *b)
{
    int64_t *const q = snapped_mesh(&mesh, l);
    int64_t *const s = b->second != NULL ? snapped_mesh(b->second, l) : NULL;
    double const v = (b->base - l->origin[b->axis]) * (double)(1 << l->fraction_bits) / l->spacing[b->axis];
    uint64_t cut = 0, fill = 0;
    bvx_solid_report r;
    bvx_grid g = below_by(ctx, l, b, &r);

    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.size[0]; x++) {
                int64_t const c[3] = {oracle_centre(g.low[0] + x, l->fraction_bits),
                                      oracle_centre(g.low[1] + y, l->fraction_bits),
                                      oracle_centre(g.low[2] + z, l->fraction_bits)};
                int const above = (double)c[b->axis] >= floor(v + 0.5);
                int const first = look_up(&mesh, q, c, b->axis);
                int const other = s != NULL ? look_up(b->second, s, c, b->axis) : 1;
                int const want = above && first != 0 && other != 0 && (first == 2) != (other == 2);
                TEST_ASSERT_EQUAL_INT(want, bvx_grid_get(&g, x, y, z));
                cut += want && s != NULL && first == 2;
                fill += want && s != NULL && other == 2;
            }
    TEST_ASSERT_EQUAL_UINT64(cut, r.cut_voxels);
    TEST_ASSERT_EQUAL_UINT64(fill, r.fill_voxels);
    TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
    bvx_grid_free(ctx, &g);
    free(s);
    free(q);
}

static double some_base(const bvx_lattice *l, int32_t axis)
{
    switch (maker_below(&seed, 4)) {
    case 0: return -(double)INFINITY;
    case 1: return maker_below(&seed, 2 * l->dims[axis]) / 2.0; /* on planes and centres */
    case 2: return maker_between(&seed, -3, l->dims[axis] + 3, 1000);
    default: return maker_below(&seed, 2) ? 1e30 : -1e30;
    }
}

static void test_any_triangles_along_any_axis(void)
{
    static const int32_t sizes[][3] = {{66, 9, 8}, {9, 65, 10}, {8, 10, 70},
                                       {1, 9, 12}, {12, 1, 9},  {12, 9, 1}};

    for (int32_t trial = 0; trial < (quick ? 30 : 150); trial++) {
        bvx_lattice const l = lattice_of(sizes[trial % 6][0], sizes[trial % 6][1], sizes[trial % 6][2]);
        below_terms b = {trial / 6 % 3, 0, NULL, NULL};
        bvx_window w;
        maker_mesh second = {0};
        b.base = some_base(&l, b.axis);
        make_random(trial % KINDS, 12, l.dims, 16);
        if (trial % 2) { /* what was made becomes the second */
            second = mesh;
            memset(&mesh, 0, sizeof mesh);
            make_random((trial + 3) % KINDS, 12, l.dims, 16);
            b.second = &second;
        }
        assert_below_is_oracle(&l, &b);
        for (int a = 0; a < 3; a++) {
            w.size[a] = 1 + maker_below(&seed, l.dims[a]);
            w.low[a] = maker_below(&seed, l.dims[a] - w.size[a] + 1);
        }
        b.window = &w;
        assert_below_is_oracle(&l, &b);
        maker_free(&second);
    }
}

/* A net of squares over [0, nx] x [0, ny], z from a function of the corner. */
static void make_terrain(int32_t nx, int32_t ny, double rise, double level)
{
    uint32_t const stride = (uint32_t)nx + 1;

    maker_clear(&mesh);
    for (int32_t y = 0; y <= ny; y++)
        for (int32_t x = 0; x <= nx; x++) maker_vertex(&mesh, x, y, level + rise * x);
    for (int32_t y = 0; y < ny; y++)
        for (int32_t x = 0; x < nx; x++) {
            uint32_t const o = (uint32_t)y * stride + (uint32_t)x;
            maker_quad(&mesh, o, o + 1, o + stride + 1, o + stride, (x + y) % 2);
        }
}

/* Ground that rises by half a voxel a column: column x holds the centres below 5 + x / 2 + 1 / 4. */
static void test_ground_by_hand(void)
{
    bvx_lattice const l = lattice_of(20, 10, 30);
    below_terms b = {2, 2.0, NULL, NULL};
    bvx_solid_report r;
    bvx_grid g;
    uint64_t expected = 0;

    make_terrain(16, 10, 0.5, 5);
    g = below_by(ctx, &l, &b, &r);
    for (int32_t x = 0; x < 16; x++) { /* height at the centre: 5 + (x + 1/2) / 2 */
        /* centres k + 1/2 below it: 4 k + 2 < 20 + 2 x + 1 */
        int32_t const top = (5 * 4 + 2 * x + 1 + 1) / 4;
        expected += (uint64_t)(top - 2) * 10;
        for (int32_t k = 0; k < 30; k++) TEST_ASSERT_EQUAL_INT(k >= 2 && k < top, bvx_grid_get(&g, x, 4, k));
    }
    TEST_ASSERT_EQUAL_UINT64(expected, set_voxels(&g));
    bvx_grid_free(ctx, &g);
}

/* Cut and fill: level ground at 8 against a slope through it. */
static void test_cut_and_fill_by_hand(void)
{
    bvx_lattice const l = lattice_of(16, 10, 30);
    maker_mesh slope;
    bvx_solid_report r;
    bvx_grid g;
    below_terms b = {2, -(double)INFINITY, NULL, NULL};

    make_terrain(16, 10, 1, 0.25);
    slope = mesh;
    memset(&mesh, 0, sizeof mesh);
    make_terrain(12, 10, 0, 8); /* ends before the slope does */
    b.second = &slope;
    g = below_by(ctx, &l, &b, &r);

    /* the slope's column x reaches z = x + 3/4: x + 1 centres are below it */
    TEST_ASSERT_EQUAL_UINT64((7 + 6 + 5 + 4 + 3 + 2 + 1) * 10, r.cut_voxels);
    TEST_ASSERT_EQUAL_UINT64((1 + 2 + 3 + 4) * 10, r.fill_voxels);
    TEST_ASSERT_EQUAL_UINT64(r.cut_voxels + r.fill_voxels, set_voxels(&g));
    bvx_grid_free(ctx, &g);
    maker_free(&slope);
}

static void test_threads_change_nothing(void)
{
    static const int32_t threads[] = {1, 2, 3, 8};

    for (int32_t axis = 0; axis < 3; axis++) {
        bvx_lattice const l = lattice_of(70, 75, 80);
        below_terms b = {axis, 11.3, NULL, NULL};
        bvx_solid_report r, s;
        bvx_grid first;
        make_random(MIXED, 4000, l.dims, 16);
        first = below_by(ctx, &l, &b, &r);
        for (int i = 0; i < 8; i++) {
            bvx_context *const c = suite_context(threads[i % 4], i < 4 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            bvx_grid g = below_by(c, &l, &b, &s);
            assert_same_bits(&first, &g, "threads");
            TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            bvx_grid_free(c, &g);
            bvx_context_destroy(c);
        }
        bvx_grid_free(ctx, &first);
    }
}

static void test_refusals_name_the_second_mesh(void)
{
    bvx_lattice const l = lattice_of(10, 10, 10);
    bvx_mesh_view view, other;
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};

    make_terrain(4, 4, 0, 3);
    view = other = maker_view(&mesh);
    o.fill = BVX_FILL_BELOW;
    o.second = &other;
    other.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "second"));
    other = view;
    other.vertex_count = 7;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    other = view;
    other.positions = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    TEST_ASSERT_NULL(g.words);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_any_triangles_along_any_axis);
    RUN_TEST(test_ground_by_hand);
    RUN_TEST(test_cut_and_fill_by_hand);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_refusals_name_the_second_mesh);
    return UNITY_END();
}
