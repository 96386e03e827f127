/* solid_support.h - what the tests of bvx_voxelize_solid share: contexts,
 * meshes, and the comparison with the oracle. */
#ifndef SOLID_SUPPORT_H
#define SOLID_SUPPORT_H

#include "tools/fault.h"
#include "tools/solid_oracle.h"

#include "suite.h"

static maker_mesh mesh;
static uint64_t seed;
static int as_floats; /* hand the mesh over as packed floats */

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0x5eed5011d);
    as_floats = 0;
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

enum { MANY_WORKERS = 5 };

/* Tasks from the last to the first, each by another worker than the one before; nobody runs beside anybody. */
static inline void in_turns(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    const int32_t *const workers = user;

    for (int32_t i = count - 1; i >= 0; i--) task(task_user, i, i % *workers);
}

/* workers: lives as long as the context. */
static inline bvx_context *context_in_turns(int32_t *workers)
{
    bvx_context_options plain = suite_options(*workers, BVX_CPU_BEST), o;
    bvx_context *made = NULL;

    plain.parallel.call = in_turns;
    plain.parallel.user = workers;
    o = fault_options(&plain, &suite_heap);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &made));
    return made;
}

static inline bvx_lattice lattice_of(int32_t x, int32_t y, int32_t z)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {x, y, z};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    return l;
}

static inline bvx_status fill_with(bvx_context *c, const bvx_mesh_view *view, const bvx_lattice *l,
                                   const bvx_window *window, int32_t fill, bvx_grid *grid,
                                   bvx_solid_report *report)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    o.fill = fill;
    o.report = report;
    if (window != NULL) o.window = *window;
    return bvx_voxelize_solid(c, view, l, &o, grid);
}

/* The mesh as doubles, or as packed floats in an array that the caller frees. */
static inline bvx_mesh_view mesh_view(float **floats)
{
    bvx_mesh_view view = maker_view(&mesh);

    *floats = NULL;
    if (as_floats) {
        *floats = maker_grow(NULL, (mesh.vertices + 1) * 3 * sizeof **floats);
        for (size_t i = 0; i < 3 * mesh.vertices; i++) (*floats)[i] = (float)mesh.p[i];
        view.positions = *floats;
        view.position_type = BVX_F32;
    }
    return view;
}

static inline bvx_grid solid_by(bvx_context *c, const bvx_lattice *l, const bvx_window *window, int32_t fill,
                                bvx_solid_report *report)
{
    float *floats;
    bvx_mesh_view const view = mesh_view(&floats);
    bvx_grid grid = {0};
    bvx_status const status = fill_with(c, &view, l, window, fill, &grid, report);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(c));
    free(floats);
    return grid;
}

static inline bvx_grid solid_of(const bvx_lattice *l, int32_t fill)
{
    return solid_by(ctx, l, NULL, fill, NULL);
}

static inline uint64_t set_voxels(const bvx_grid *g)
{
    uint64_t n;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, g, &n));
    return n;
}

static inline void assert_same_bits(const bvx_grid *a, const bvx_grid *b, const char *what)
{
    size_t const words = (size_t)a->words_per_row * (size_t)a->size[1] * (size_t)a->size[2];
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a->size, b->size, sizeof a->size, what);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, memcmp(a->words, b->words, words * 8), what);
}

static inline int64_t *snapped(const bvx_lattice *l)
{
    int64_t *const q = maker_grow(NULL, (mesh.vertices + 1) * 3 * sizeof *q);
    for (size_t i = 0; i < 3 * mesh.vertices; i++)
        q[i] = oracle_snap(mesh.p[i], l->origin[i % 3], l->spacing[i % 3], l->fraction_bits);
    return q;
}

/* The window's bits and counts are the oracle's; what lies beyond a row's end is zero. */
static inline void assert_is_oracle(const bvx_lattice *l, const bvx_window *window, int32_t fill)
{
    int64_t *const q = snapped(l);
    oracle_solid o = oracle_make(l, window, q, mesh.t, mesh.triangles, fill);
    bvx_solid_report r;
    bvx_grid g = solid_by(ctx, l, window, fill, &r);
    char text[120];

    TEST_ASSERT_EQUAL_MEMORY(o.window.low, g.low, sizeof g.low);
    TEST_ASSERT_EQUAL_MEMORY(o.window.size, g.size, sizeof g.size);
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++) {
            size_t const row = (size_t)z * (size_t)g.size[1] + (size_t)y;
            for (int32_t x = 0; x < g.words_per_row * 64; x++) {
                int const want = x < g.size[0] ? o.voxel[row * (size_t)g.size[0] + (size_t)x] : 0;
                if (bvx_grid_get(&g, x, y, z) == want) continue;
                snprintf(text, sizeof text, "voxel (%d, %d, %d) of a %d x %d x %d window is %d under rule %d",
                         (int)x, (int)y, (int)z, (int)g.size[0], (int)g.size[1], (int)g.size[2], !want,
                         (int)fill);
                TEST_FAIL_MESSAGE(text);
            }
        }
    TEST_ASSERT_EQUAL_UINT64(o.crossings, r.crossings);
    TEST_ASSERT_EQUAL_UINT64(o.unbalanced_rows, r.unbalanced_rows);
    bvx_grid_free(ctx, &g);
    oracle_free(&o);
    free(q);
}

static inline void assert_both_rules(const bvx_lattice *l)
{
    assert_is_oracle(l, NULL, BVX_FILL_PARITY);
    assert_is_oracle(l, NULL, BVX_FILL_NONZERO);
}

static inline void wall(double x, double size, int leaving)
{
    uint32_t const a = maker_vertex(&mesh, x, 0, 0);
    uint32_t const b = maker_vertex(&mesh, x, size, 0);
    uint32_t const c = maker_vertex(&mesh, x, 0, size);
    if (leaving) maker_triangle(&mesh, a, b, c);
    else maker_triangle(&mesh, a, c, b);
}

enum { SOUP, NEEDLES, DEGENERATE, ALIGNED, HUGE, TINY, MIXED, KINDS };

static inline void make_random(int32_t kind, int32_t count, const int32_t n[3], int32_t fraction_bits)
{
    int32_t const steps = 1 << fraction_bits;
    double low[3], high[3];

    for (int a = 0; a < 3; a++) {
        low[a] = -2;
        high[a] = n[a] + 2;
    }
    maker_clear(&mesh);
    switch (kind) {
    case SOUP: maker_soup(&mesh, &seed, count, low, high, steps); break;
    case NEEDLES: maker_needles(&mesh, &seed, count, low, high, steps); break;
    case DEGENERATE: maker_degenerate(&mesh, &seed, count, low, high, steps); break;
    case ALIGNED: maker_soup(&mesh, &seed, count, low, high, 2); break; /* corners and centres of voxels */
    case HUGE:
        for (int a = 0; a < 3; a++) {
            high[a] = (double)((1 << 30) - 1) / steps;
            low[a] = -high[a];
        }
        maker_soup(&mesh, &seed, count / 2 + 1, low, high, steps);
        maker_needles(&mesh, &seed, count / 8 + 1, low, high, 1); /* may leave the range */
        for (size_t i = 0; i < 3 * mesh.vertices; i++)
            mesh.p[i] = mesh.p[i] > high[0] ? high[0] : mesh.p[i] < low[0] ? low[0] : mesh.p[i];
        break;
    case TINY:
        for (int32_t i = 0; i < count; i++) {
            double near_low[3], near_high[3];
            for (int a = 0; a < 3; a++) {
                near_low[a] = maker_below(&seed, n[a]) + (maker_below(&seed, 2) ? 0.5 : 0.0);
                near_high[a] = near_low[a] + 4.0 / steps;
                near_low[a] -= 4.0 / steps;
            }
            maker_soup(&mesh, &seed, 3, near_low, near_high, steps);
        }
        break;
    default:
        maker_soup(&mesh, &seed, count / 4 + 1, low, high, steps);
        maker_needles(&mesh, &seed, count / 4 + 1, low, high, steps);
        maker_soup(&mesh, &seed, count / 4 + 1, low, high, 2);
        maker_degenerate(&mesh, &seed, count / 4 + 1, low, high, 2);
    }
}

#endif
