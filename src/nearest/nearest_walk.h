/* nearest_walk.h - the order in which centres of a window are visited: cubes of 16 x 16 x 16, in them bricks
 * of 4 x 4 x 4, so that neighbours in time are neighbours in space. It follows from the window only. Not
 * installed. */
#ifndef BVXI_NEAREST_WALK_H
#define BVXI_NEAREST_WALK_H

#include "nearest/nearest_brick.h"

enum { BVXI_NEAR_CUBE_SLOTS = 4096, BVXI_NEAR_RUN = 64 /* cubes along x that one task walks */ };

/* How a window is cut. Cube number x + count[0] * (y + count[1] * z). */
typedef struct bvxi_near_plan {
    int32_t count[3]; /* cubes along each axis */
    int32_t runs;     /* tasks along x */
    uint64_t cubes;
} bvxi_near_plan;

/* A task: cubes begin .. end - 1 along x, at y and z. */
typedef struct bvxi_near_run {
    int32_t begin, end, y, z;
} bvxi_near_run;

static inline bvxi_near_plan bvxi_near_plan_of(const bvx_grid *g)
{
    bvxi_near_plan p;
    for (int a = 0; a < 3; a++) p.count[a] = (g->size[a] + BVXI_NEAR_CUBE - 1) / BVXI_NEAR_CUBE;
    p.runs = (p.count[0] + BVXI_NEAR_RUN - 1) / BVXI_NEAR_RUN;
    p.cubes = (uint64_t)p.count[0] * (uint64_t)p.count[1] * (uint64_t)p.count[2];
    return p;
}

static inline uint64_t bvxi_near_plan_runs(const bvxi_near_plan *p)
{
    return (uint64_t)p->runs * (uint64_t)p->count[1] * (uint64_t)p->count[2];
}

static inline bvxi_near_run bvxi_near_run_of(const bvxi_near_plan *p, uint64_t i)
{
    bvxi_near_run r;
    uint64_t const row = i / (uint64_t)p->runs;
    r.begin = (int32_t)(i % (uint64_t)p->runs) * BVXI_NEAR_RUN;
    r.end = r.begin + BVXI_NEAR_RUN < p->count[0] ? r.begin + BVXI_NEAR_RUN : p->count[0];
    r.y = (int32_t)(row % (uint64_t)p->count[1]);
    r.z = (int32_t)(row / (uint64_t)p->count[1]);
    return r;
}

static inline uint64_t bvxi_near_cube_number(const bvxi_near_plan *p, const bvxi_near_run *r, int32_t x)
{
    return (uint64_t)x + (uint64_t)p->count[0] * ((uint64_t)r->y + (uint64_t)p->count[1] * (uint64_t)r->z);
}

/* First voxel of brick b (x + 4 y + 16 z) of a cube, in the window. */
static inline void bvxi_near_brick_first(const bvxi_near_run *r, int32_t x, int32_t b, int32_t first[3])
{
    first[0] = x * BVXI_NEAR_CUBE + (b & 3) * BVXI_NEAR_SIDE;
    first[1] = r->y * BVXI_NEAR_CUBE + (b >> 2 & 3) * BVXI_NEAR_SIDE;
    first[2] = r->z * BVXI_NEAR_CUBE + (b >> 4) * BVXI_NEAR_SIDE;
}

/* Slots that are set; slots outside are not. */
uint64_t bvxi_near_slots_of(const bvx_grid *g, const int32_t first[3]);

/* One worker a thread. */
bvx_status bvxi_near_workers(bvx_context *ctx, int32_t few_reached, bvxi_near_worker **workers);
/* Free what is remembered. */
void bvxi_near_forget(bvx_context *ctx, bvxi_near_memo *memo);

#endif
