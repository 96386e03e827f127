/* refine_oracle.h - the uniform surface and a plain flood around it, for tests of octrees. */
#ifndef REFINE_ORACLE_H
#define REFINE_ORACLE_H

#include "tools/mesh_maker.h"

#include "unity.h"

/* One state a voxel of the last level, x fastest. */
typedef struct uniform {
    bvx_lattice lattice;
    uint8_t *state;
    size_t count;
} uniform;

static inline size_t uniform_at(const uniform *u, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)u->lattice.dims[1] + (size_t)y) * (size_t)u->lattice.dims[0] + (size_t)x;
}

static inline void uniform_push(uniform *u, size_t *queue, size_t *tail, int32_t x, int32_t y, int32_t z)
{
    const int32_t *const d = u->lattice.dims;
    if (x < 0 || y < 0 || z < 0 || x >= d[0] || y >= d[1] || z >= d[2]) return;
    size_t const i = uniform_at(u, x, y, z);
    if (u->state[i] != BVX_STATE_INSIDE) return;
    u->state[i] = BVX_STATE_OUTSIDE;
    queue[(*tail)++] = i;
}

/* Breadth first from all sides of the lattice. */
static inline void uniform_flood(uniform *u)
{
    const int32_t *const d = u->lattice.dims;
    size_t *const queue = maker_grow(NULL, u->count * sizeof *queue), nx = (size_t)d[0], ny = (size_t)d[1];
    size_t head = 0, tail = 0;

    for (int32_t z = 0; z < d[2]; z++)
        for (int32_t y = 0; y < d[1]; y++)
            for (int32_t x = 0; x < d[0]; x++)
                if (x == 0 || y == 0 || z == 0 || x == d[0] - 1 || y == d[1] - 1 || z == d[2] - 1)
                    uniform_push(u, queue, &tail, x, y, z);
    while (head < tail) {
        size_t const i = queue[head++];
        int32_t const x = (int32_t)(i % nx), y = (int32_t)(i / nx % ny), z = (int32_t)(i / nx / ny);
        uniform_push(u, queue, &tail, x - 1, y, z);
        uniform_push(u, queue, &tail, x + 1, y, z);
        uniform_push(u, queue, &tail, x, y - 1, z);
        uniform_push(u, queue, &tail, x, y + 1, z);
        uniform_push(u, queue, &tail, x, y, z - 1);
        uniform_push(u, queue, &tail, x, y, z + 1);
    }
    free(queue);
}

static inline void uniform_make(bvx_context *ctx, const bvx_mesh_view *view, const bvx_lattice *lattice,
                                uniform *u)
{
    bvx_grid grid = {0};

    u->lattice = *lattice;
    u->count = (size_t)lattice->dims[0] * (size_t)lattice->dims[1] * (size_t)lattice->dims[2];
    u->state = maker_grow(NULL, u->count);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, view, lattice, NULL, &grid));
    for (int32_t z = 0; z < lattice->dims[2]; z++)
        for (int32_t y = 0; y < lattice->dims[1]; y++)
            for (int32_t x = 0; x < lattice->dims[0]; x++)
                u->state[uniform_at(u, x, y, z)] = bvx_grid_get(&grid, x, y, z) ? BVX_STATE_SURFACE
                                                                                : BVX_STATE_INSIDE;
    bvx_grid_free(ctx, &grid);
    uniform_flood(u);
}

static inline void uniform_free(uniform *u)
{
    free(u->state);
    memset(u, 0, sizeof *u);
}

/* Voxels in a state. */
static inline size_t uniform_count(const uniform *u, int state)
{
    size_t n = 0;
    for (size_t i = 0; i < u->count; i++) n += u->state[i] == state;
    return n;
}

#endif
