/* surface_voxels_support.h - what the tests of bvx_voxelize_surface share:
 * the call, and its comparison with the oracle. */
#ifndef SURFACE_VOXELS_SUPPORT_H
#define SURFACE_VOXELS_SUPPORT_H

#include "solid_support.h"
#include "tools/touch_oracle.h"

enum {
    CONSERVATIVE = BVX_SURFACE_CONSERVATIVE,
    THIN = BVX_SURFACE_THIN,
    SAMPLED = BVX_SURFACE_SAMPLED,
    MODES
};

/* Contexts that must agree: one tile or many, fast code or portable. */
static const int32_t surface_threads[] = {1, 2, 1, 3, 8},
                     surface_cpu[] = {BVX_CPU_BEST, BVX_CPU_BEST, BVX_CPU_PORTABLE, BVX_CPU_PORTABLE,
                                      BVX_CPU_BEST};
enum { SURFACE_CONTEXTS = sizeof surface_threads / sizeof *surface_threads };

static inline bvx_context *surface_context(int n)
{
    return suite_context(surface_threads[n % SURFACE_CONTEXTS], surface_cpu[n % SURFACE_CONTEXTS]);
}

static inline bvx_window window_of(const bvx_lattice *l, const bvx_window *given)
{
    bvx_window w = {{0, 0, 0}, {0, 0, 0}};
    if (given != NULL) return *given;
    memcpy(w.size, l->dims, sizeof w.size);
    return w;
}

static inline bvx_grid surface_by(bvx_context *c, const bvx_mesh_view *view, const bvx_lattice *l,
                                  const bvx_window *window, int32_t mode)
{
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_grid grid = {0};
    bvx_status status;

    o.mode = mode;
    if (window != NULL) o.window = *window;
    status = bvx_voxelize_surface(c, view, l, &o, &grid);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(c));
    return grid;
}

static inline bvx_grid surface_of(const bvx_lattice *l, int32_t mode)
{
    bvx_mesh_view const view = maker_view(&mesh);
    return surface_by(ctx, &view, l, NULL, mode);
}

static inline touch_oracle triangle_oracle(const int64_t *q, size_t t, const bvx_lattice *l)
{
    touch_oracle o;
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) o.p[i][a] = q[3 * (size_t)mesh.t[3 * t + (size_t)i] + (size_t)a];
    o.f = l->fraction_bits;
    return o;
}

static inline void assert_bytes(const bvx_grid *g, const uint8_t *bytes, const char *what)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->words_per_row * 64; x++) {
                int const want =
                    x < g->size[0]
                        ? bytes[((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->size[0] + (size_t)x]
                        : 0;
                char text[200];
                if (bvx_grid_get(g, x, y, z) == want) continue;
                snprintf(text, sizeof text, "%s: voxel (%d, %d, %d) of a %d x %d x %d window is %d", what,
                         (int)x, (int)y, (int)z, (int)g->size[0], (int)g->size[1], (int)g->size[2], !want);
                TEST_FAIL_MESSAGE(text);
            }
}

static uint64_t surface_set, surface_clear; /* voxels that comparisons saw */

/* The mesh in a window is what the oracle says, in a context. */
static inline void assert_surface(bvx_context *c, const bvx_lattice *l, const bvx_window *window,
                                  int32_t mode, const char *what)
{
    bvx_window const w = window_of(l, window);
    bvx_mesh_view const view = maker_view(&mesh);
    int64_t *const q = snapped(l);
    uint8_t *const bytes = maker_grow(NULL, (size_t)w.size[0] * (size_t)w.size[1] * (size_t)w.size[2]);
    bvx_grid g;

    memset(bytes, 0, (size_t)w.size[0] * (size_t)w.size[1] * (size_t)w.size[2]);
    for (size_t t = 0; t < mesh.triangles; t++) {
        touch_oracle const o = triangle_oracle(q, t, l);
        touch_mark(&o, mode, &w, bytes);
    }
    g = surface_by(c, &view, l, window, mode);
    TEST_ASSERT_EQUAL_MEMORY(w.low, g.low, sizeof w.low);
    TEST_ASSERT_EQUAL_MEMORY(w.size, g.size, sizeof w.size);
    assert_bytes(&g, bytes, what);
    surface_set += set_voxels(&g);
    surface_clear += (uint64_t)w.size[0] * (uint64_t)w.size[1] * (uint64_t)w.size[2] - set_voxels(&g);
    bvx_grid_free(c, &g);
    free(bytes);
    free(q);
}

/* One triangle of corners in whole parts of 2^-grain voxels, about as far from each other as reach parts, in
 * a box of side voxels; every now and then a special one. */
static inline void make_small(int32_t trial, int32_t side, int32_t grain, int32_t reach)
{
    int32_t const part = 1 << grain;
    int32_t centre[3], p[3][3];
    uint32_t v[3];

    for (int a = 0; a < 3; a++) centre[a] = maker_below(&seed, side * part);
    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) p[i][a] = centre[a] + maker_below(&seed, 2 * reach + 1) - reach;
    if (trial % 7 == 0) memcpy(p[2], p[1], sizeof p[2]); /* a segment */
    if (trial % 11 == 0)
        for (int a = 0; a < 3; a++) p[2][a] = 2 * p[1][a] - p[0][a];          /* in line */
    if (trial % 13 == 0) p[0][trial % 3] = p[1][trial % 3] = p[2][trial % 3]; /* along a plane */
    /* on a lattice plane */
    if (trial % 17 == 0) p[0][trial % 3] = p[1][trial % 3] = p[2][trial % 3] = part * (trial % side);
    if (trial % 19 == 0) p[0][trial % 3] = p[1][trial % 3]; /* an edge across an axis */
    if (trial % 101 == 0) {
        memcpy(p[0], p[1], sizeof p[0]);
        memcpy(p[2], p[1], sizeof p[2]);
    }
    maker_clear(&mesh);
    for (int i = 0; i < 3; i++)
        v[i] = maker_vertex(&mesh, (double)p[i][0] / part, (double)p[i][1] / part, (double)p[i][2] / part);
    maker_triangle(&mesh, v[0], v[1], v[2]);
}

/* Random triangles of all sizes up to a few voxels. */
static inline void make_scan(int32_t count, const int32_t n[3], int32_t grain)
{
    int32_t const part = 1 << grain;

    maker_clear(&mesh);
    for (int32_t i = 0; i < count; i++) {
        int32_t const reach = 1 + maker_below(&seed, maker_below(&seed, 3) == 0 ? 4 * part : part);
        uint32_t v[3];
        double centre[3];
        for (int a = 0; a < 3; a++) centre[a] = (double)(maker_below(&seed, (n[a] + 2) * part) - part) / part;
        for (int c = 0; c < 3; c++) {
            double p[3];
            for (int a = 0; a < 3; a++)
                p[a] = centre[a] + (double)(maker_below(&seed, 2 * reach + 1) - reach) / part;
            v[c] = maker_vertex(&mesh, p[0], p[1], p[2]);
        }
        maker_triangle(&mesh, v[0], v[1], v[2]);
    }
}

static inline bvx_window random_window(const bvx_lattice *l)
{
    bvx_window w;
    for (int a = 0; a < 3; a++) {
        w.low[a] = maker_below(&seed, l->dims[a]);
        w.size[a] = 1 + maker_below(&seed, l->dims[a] - w.low[a]);
    }
    return w;
}

/* The tests that all definitions share, in the order of their cost. */

static inline void check_small_triangles(int32_t mode, int32_t trials)
{
    static const int32_t grains[] = {0, 1, 2, 4, 10, 16};
    bvx_lattice const l = lattice_of(9, 9, 9);
    bvx_context *c[SURFACE_CONTEXTS];

    for (int i = 0; i < SURFACE_CONTEXTS; i++) c[i] = surface_context(i);
    for (size_t g = 0; g < sizeof grains / sizeof *grains; g++) {
        int32_t const part = 1 << grains[g];
        int32_t const reach[6] = {part / 2, part, 3 * part / 2, 2 * part, 5 * part, 20 * part};
        for (int32_t n = 0; n < trials; n++) {
            make_small(n, 9, grains[g], reach[n % 6]);
            assert_surface(c[n / 6 % SURFACE_CONTEXTS], &l, NULL, mode, "a small triangle");
        }
    }
    for (int i = 0; i < SURFACE_CONTEXTS; i++) bvx_context_destroy(c[i]);
}

/* Meshes of all kinds in lattices of all shapes, and in windows. */
static inline void check_meshes(int32_t mode, int32_t trials)
{
    static const int32_t shapes[][3] = {{20, 15, 13}, {70, 9, 7}, {200, 5, 6}, {64, 6, 5},
                                        {65, 1, 9},   {9, 65, 1}, {1, 9, 20},  {13, 1, 1},
                                        {1, 1, 1},    {3, 70, 2}, {5, 2, 40},  {128, 3, 3}};

    for (int32_t n = 0; n < trials; n++) {
        const int32_t *const s = shapes[n % (int32_t)(sizeof shapes / sizeof *shapes)];
        bvx_lattice const l = lattice_of(s[0], s[1], s[2]);
        bvx_context *const c = surface_context(n / 12);
        if (n % 3 == 0) make_scan(60, s, n % 2 == 0 ? 16 : 1);
        else make_random(n % KINDS == HUGE ? MIXED : n % KINDS, 24, s, l.fraction_bits);
        assert_surface(c, &l, NULL, mode, "the whole");
        for (int32_t k = 0; k < 3; k++) {
            bvx_window const w = random_window(&l);
            assert_surface(c, &l, &w, mode, "a window");
        }
        bvx_context_destroy(c);
    }
}

/* Index types, strides, no indices; the order of triangles and corners. */
static inline void check_views(int32_t mode)
{
    bvx_lattice const l = lattice_of(75, 11, 12);

    for (int32_t trial = 0; trial < (quick ? 5 : 30); trial++) {
        bvx_context *const c = surface_context(trial);
        bvx_mesh_view view;
        bvx_grid whole, other;
        size_t n;
        uint16_t *u16;
        uint64_t *u64;
        double *corners;
        float *floats;
        if (trial % 2 == 0) make_scan(300, l.dims, 10);
        else make_random(MIXED, 60, l.dims, 10);
        n = 3 * mesh.triangles;
        u16 = maker_grow(NULL, n * sizeof *u16);
        u64 = maker_grow(NULL, (n + mesh.triangles) * sizeof *u64);
        corners = maker_grow(NULL, 3 * n * sizeof *corners);
        floats = maker_grow(NULL, 3 * mesh.vertices * sizeof *floats);
        for (size_t i = 0; i < n; i++) {
            u16[i] = (uint16_t)mesh.t[i];
            u64[i / 3 * 4 + i % 3] = mesh.t[i];
            memcpy(corners + 3 * i, mesh.p + 3 * (size_t)mesh.t[i], 3 * sizeof *corners);
        }
        for (size_t i = 0; i < 3 * mesh.vertices; i++) floats[i] = (float)mesh.p[i];
        view = maker_view(&mesh);
        whole = surface_by(c, &view, &l, NULL, mode);
        view.indices = u16;
        view.index_type = BVX_U16;
        other = surface_by(c, &view, &l, NULL, mode);
        assert_same_bits(&whole, &other, "u16");
        bvx_grid_free(c, &other);
        view.indices = u64;
        view.index_type = BVX_U64;
        view.index_stride = 32;
        view.positions = floats; /* multiples of 2^-10: the same numbers */
        view.position_type = BVX_F32;
        other = surface_by(c, &view, &l, NULL, mode);
        assert_same_bits(&whole, &other, "u64, floats");
        bvx_grid_free(c, &other);
        view = maker_view(&mesh);
        view.indices = NULL;
        view.index_type = 0;
        view.positions = corners;
        view.vertex_count = n;
        other = surface_by(c, &view, &l, NULL, mode);
        assert_same_bits(&whole, &other, "no indices");
        bvx_grid_free(c, &other);
        maker_shuffle_triangles(&mesh, &seed);
        maker_shuffle_vertices(&mesh, &seed);
        for (size_t i = 0; i < mesh.triangles; i++)
            if (maker_below(&seed, 2)) maker_flip(&mesh, i, i + 1);
        view = maker_view(&mesh);
        other = surface_by(c, &view, &l, NULL, mode);
        assert_same_bits(&whole, &other, "order");
        bvx_grid_free(c, &other);
        bvx_grid_free(c, &whole);
        free(u16);
        free(u64);
        free(corners);
        free(floats);
        bvx_context_destroy(c);
    }
}

/* All contexts make the same of meshes with many triangles of all sizes. */
static inline void check_contexts(int32_t mode)
{
    for (int32_t trial = 0; trial < (quick ? 2 : 6); trial++) {
        bvx_lattice const l = lattice_of(trial % 2 == 0 ? 130 : 60, 90, 80);
        bvx_mesh_view view;
        bvx_grid first;
        /* one thread takes the many in pieces */
        if (trial < 2) make_scan(trial == 0 && !quick ? 140000 : 30000, l.dims, 16);
        else make_random(trial % KINDS == HUGE ? MIXED : trial % KINDS, 300, l.dims, 12);
        view = maker_view(&mesh);
        first = surface_by(ctx, &view, &l, NULL, mode);
        for (int i = 0; i < SURFACE_CONTEXTS; i++) {
            bvx_context *const c = surface_context(i);
            bvx_window const w = random_window(&l);
            bvx_grid other = surface_by(c, &view, &l, NULL, mode);
            assert_same_bits(&first, &other, "contexts");
            bvx_grid_free(c, &other);
            other = surface_by(c, &view, &l, &w, mode);
            for (int32_t z = 0; z < w.size[2]; z++)
                for (int32_t y = 0; y < w.size[1]; y++)
                    for (int32_t x = 0; x < w.size[0]; x++)
                        TEST_ASSERT_EQUAL_INT(bvx_grid_get(&first, x + w.low[0], y + w.low[1], z + w.low[2]),
                                              bvx_grid_get(&other, x, y, z));
            bvx_grid_free(c, &other);
            bvx_context_destroy(c);
        }
        bvx_grid_free(ctx, &first);
    }
}

/* The same by workers in turns as by one, counts and sums too, in the memory that the header gives. */
static inline void check_worker_count(int32_t mode, const bvx_lattice *l, int32_t workers)
{
    bvx_surface_report one = {0}, many = {0};
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_surface_options how = {.struct_size = sizeof how};
    bvx_grid first = {0}, other = {0};
    bvx_context *c;
    uint64_t formula;

    how.mode = mode;
    how.report = &one;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, l, &how, &first));

    c = context_in_turns(&workers);
    formula = bvx_memory_used(c) + 8 * bvx_grid_bound(l, NULL) + 16 * view.vertex_count +
              8 * view.triangle_count + 65536;
    bvx_memory_reset_peak(c);
    how.report = &many;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(c, &view, l, &how, &other));
    assert_same_bits(&first, &other, "workers in turns");
    TEST_ASSERT_EQUAL_MEMORY(&one, &many, sizeof one);
    TEST_ASSERT_TRUE(bvx_memory_peak(c) <= formula);
    bvx_grid_free(c, &other);
    bvx_grid_free(ctx, &first);
    bvx_context_destroy(c);
}

/* A mesh of many triangles for its grid goes to workers piece by piece, and a grid each is joined. Of a small
 * grid hundreds of workers could have one, but not what they count beside it. */
static inline void check_workers(int32_t mode)
{
    bvx_lattice const l = lattice_of(150, 40, 30), small = lattice_of(60, 2, 2);

    make_scan(quick ? 15000 : 40000, l.dims, 16);
    TEST_ASSERT_TRUE((MANY_WORKERS - 1) * bvx_grid_bound(&l, NULL) <= mesh.triangles);
    check_worker_count(mode, &l, MANY_WORKERS);
    make_scan(1000, small.dims, 16);
    check_worker_count(mode, &small, 200);
}

#endif
