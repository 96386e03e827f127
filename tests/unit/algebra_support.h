/* algebra_support.h - windows of lattices with random voxels, read voxel by voxel, for tests of set
 * algebra. */
#ifndef ALGEBRA_SUPPORT_H
#define ALGEBRA_SUPPORT_H

#include "tools/mesh_maker.h"
#include "suite.h"

/* What is tried along x: below, at and above words. */
static const int32_t algebra_sizes[] = {1, 63, 64, 65, 127, 128, 129};
enum { ALGEBRA_SIZES = sizeof algebra_sizes / sizeof *algebra_sizes };

static uint64_t seed;

/* An empty window of size x, y, z at low of a lattice that has `more` voxels behind it. */
static inline bvx_grid algebra_grid(const int32_t size[3], const int32_t low[3], const int32_t more[3])
{
    double const origin[3] = {-3, 0.5, 1e3}, spacing[3] = {0.5, 1, 2};
    bvx_window window;
    bvx_lattice l;
    bvx_grid g = {0};
    int32_t dims[3];

    for (int a = 0; a < 3; a++) {
        dims[a] = low[a] + size[a] + more[a];
        window.low[a] = low[a];
        window.size[a] = size[a];
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &window, &g));
    return g;
}

/* Random voxels, percent of them set. */
static inline void algebra_scatter(bvx_grid *g, int32_t percent)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                bvx_grid_set(g, x, y, z, maker_below(&seed, 100) < percent);
}

/* Voxel (x, y, z) of the window; 0 beyond it. */
static inline int algebra_get(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2]) return 0;
    return bvx_grid_get(g, x, y, z);
}

/* The same lattice, window and bits, those at the ends of rows too. */
static inline void algebra_expect_equal(const bvx_grid *want, const bvx_grid *got)
{
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->size, got->size, 3);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->low, got->low, 3);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want->lattice.dims, got->lattice.dims, 3);
    TEST_ASSERT_EQUAL_INT32(want->lattice.fraction_bits, got->lattice.fraction_bits);
    TEST_ASSERT_EQUAL_MEMORY(want->lattice.origin, got->lattice.origin, sizeof want->lattice.origin);
    TEST_ASSERT_EQUAL_MEMORY(want->lattice.spacing, got->lattice.spacing, sizeof want->lattice.spacing);
    TEST_ASSERT_EQUAL_HEX64_ARRAY(want->words, got->words,
                                  (size_t)want->words_per_row * (size_t)(want->size[1] * want->size[2]));
}

/* A grid of stale words of the caller's, just large enough. */
static inline bvx_grid algebra_own(uint64_t *words, size_t count)
{
    bvx_grid g = {0};
    memset(words, 0xdb, count * sizeof *words);
    g.words = words;
    g.word_capacity = count;
    return g;
}

#endif
