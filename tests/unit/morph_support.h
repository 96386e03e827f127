/* morph_support.h - random grids for the tests of morphology and distances. */
#ifndef MORPH_SUPPORT_H
#define MORPH_SUPPORT_H

#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static uint64_t seed;
static bvx_grid grid;

void setUp(void)
{
    suite_open(1);
    seed = 2718;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &grid);
    suite_close();
}

/* An empty grid in place of the last one. */
static inline void open_grid(int32_t nx, int32_t ny, int32_t nz, double sx, double sy, double sz)
{
    double const origin[3] = {-3.0, 0.5, 7.0}, spacing[3] = {sx, sy, sz};
    int32_t const dims[3] = {nx, ny, nz};
    bvx_lattice l;
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &grid));
}

static inline void scatter(int32_t per_thousand)
{
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                bvx_grid_set(&grid, x, y, z, maker_below(&seed, 1000) < per_thousand);
}

/* Bodies: some balls of set voxels, then some of empty ones. */
static inline void scatter_balls(int32_t count, int32_t most)
{
    for (int32_t i = 0; i < count; i++) {
        int32_t const r = 1 + maker_below(&seed, most), value = i < count - count / 3;
        int32_t c[3];
        for (int a = 0; a < 3; a++) c[a] = maker_below(&seed, grid.size[a]);
        for (int32_t z = 0; z < grid.size[2]; z++)
            for (int32_t y = 0; y < grid.size[1]; y++)
                for (int32_t x = 0; x < grid.size[0]; x++)
                    if ((x - c[0]) * (x - c[0]) + (y - c[1]) * (y - c[1]) + (z - c[2]) * (z - c[2]) <= r * r)
                        bvx_grid_set(&grid, x, y, z, value);
    }
}

static inline size_t voxels_of(const bvx_grid *g)
{
    return (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2];
}

static inline void *room_for(size_t count, size_t size)
{
    void *const made = malloc(count * size + 1);
    TEST_ASSERT_NOT_NULL(made);
    return made;
}

static const int32_t word_edges[7] = {1, 63, 64, 65, 127, 128, 129};

#endif
