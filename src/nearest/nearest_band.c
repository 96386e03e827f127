/* nearest_band.c - the centres within a width of a mesh.
 *
 * Cubes of 16 x 16 x 16 centres that no triangle reaches are passed by. In the others every brick is searched
 * for centres within the width: floats decide where they can, the evaluation in doubles where they cannot
 * (nearest_brick.c). The nearest triangles found that way are remembered, so that filling in the values needs
 * no second search.
 * Memory: 16 KiB for each cube that the mesh reaches, until the mesh is closed or another band is
 * requested. */
#include "nearest/nearest_walk.h"

typedef struct band_work {
    bvxi_nearest const *n;
    const bvx_grid *band;
    bvxi_near_plan plan;
    double width;
    bvxi_near_worker *workers;
    uint8_t *reached; /* [Size: cubes] */
    uint64_t *first;  /* [Size: rows] */
    int32_t pieces;
} band_work;

uint64_t bvxi_near_slots_of(const bvx_grid *g, const int32_t first[3])
{
    uint64_t slots = 0;
    if (first[0] >= g->size[0]) return 0;
    for (int32_t z = 0; z < BVXI_NEAR_SIDE && first[2] + z < g->size[2]; z++)
        for (int32_t y = 0; y < BVXI_NEAR_SIDE && first[1] + y < g->size[1]; y++)
            slots |= (bvxi_grid_row(g, first[1] + y, first[2] + z)[first[0] >> 6] >> (first[0] & 63) & 15)
                     << (4 * y + 16 * z);
    return slots;
}

/* Lattice indices of a cube's first centre. */
static void first_of_cube(const bvx_grid *g, const bvxi_near_run *r, int32_t x, int32_t first[3])
{
    first[0] = g->low[0] + x * BVXI_NEAR_CUBE;
    first[1] = g->low[1] + r->y * BVXI_NEAR_CUBE;
    first[2] = g->low[2] + r->z * BVXI_NEAR_CUBE;
}

static void find_reached_cubes(void *user, int32_t index, int32_t worker)
{
    const band_work *const w = user;
    uint64_t begin, end;
    bvxi_piece(bvxi_near_plan_runs(&w->plan), w->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        bvxi_near_run const r = bvxi_near_run_of(&w->plan, i);
        for (int32_t x = r.begin; x < r.end; x++) {
            int32_t first[3];
            first_of_cube(w->band, &r, x, first);
            w->reached[bvxi_near_cube_number(&w->plan, &r, x)] = (uint8_t)bvxi_near_cube_reaches(
                w->n, (const int32_t *)first, w->width, &w->workers[worker]);
        }
    }
}

void bvxi_near_forget(bvx_context *ctx, bvxi_near_memo *memo)
{
    bvxi_drop(ctx, memo->triangle);
    bvxi_drop(ctx, memo->cube_slot);
    memset(memo, 0, sizeof *memo);
}

static void set_near_slots(const bvx_grid *g, const int32_t first[3], uint64_t slots)
{
    /* Four bits a row: a brick never reaches over the end of a word. */
    for (int32_t z = 0; z < BVXI_NEAR_SIDE; z++)
        for (int32_t y = 0; y < BVXI_NEAR_SIDE; y++) {
            uint64_t const row = slots >> (4 * y + 16 * z) & 15;
            if (row != 0)
                bvxi_grid_row(g, first[1] + y, first[2] + z)[first[0] >> 6] |= row << (first[0] & 63);
        }
}

static void find_cube_band(const band_work *w, const bvxi_near_run *r, int32_t x, bvxi_near_worker *worker)
{
    uint32_t const slot = w->n->memo->cube_slot[bvxi_near_cube_number(&w->plan, r, x)];
    int32_t corner[3];

    if (slot == BVXI_NEAR_NONE) return;
    first_of_cube(w->band, r, x, corner);

    /* Where the searches of the 64 bricks begin is found once for all of them. */
    bvxi_near_cube_begin(w->n, (const int32_t *)corner, w->width, worker);
    for (int32_t b = 0; b < 64; b++) {
        uint32_t *const triangle = w->n->memo->triangle + (uint64_t)slot * BVXI_NEAR_CUBE_SLOTS +
                                   (uint64_t)b * BVXI_NEAR_SLOTS;
        int32_t first[3], index[3];
        bvxi_near_brick_first(r, x, b, first);

        /* Slots of a brick that lie in the window. */
        const bvx_grid *const g = w->band;
        uint64_t slots = 0;
        int32_t const nx = g->size[0] - first[0];
        uint64_t const row = nx >= BVXI_NEAR_SIDE ? 15 : nx > 0 ? (UINT64_C(1) << nx) - 1 : 0;
        for (int32_t z = 0; z < BVXI_NEAR_SIDE && first[2] + z < g->size[2]; z++)
            for (int32_t y = 0; y < BVXI_NEAR_SIDE && first[1] + y < g->size[1]; y++)
                slots |= row << (4 * y + 16 * z);
        uint64_t const inside = slots;

        /* A brick beyond the window has no centre, but its slots in the memory say so. */
        if (inside == 0) {
            for (int32_t s = 0; s < BVXI_NEAR_SLOTS; s++) triangle[s] = BVXI_NEAR_NONE;
            continue;
        }
        for (int a = 0; a < 3; a++) index[a] = w->band->low[a] + first[a];
        bvxi_near_brick_begin(w->n, (const int32_t *)index, worker);
        set_near_slots(w->band, (const int32_t *)first, bvxi_near_brick_find(w->n, inside, w->width, worker));
        memcpy(triangle, worker->triangle, sizeof worker->triangle);
    }
}

static void find_near_band(void *user, int32_t index, int32_t worker)
{
    const band_work *const w = user;
    uint64_t begin, end;
    bvxi_piece(bvxi_near_plan_runs(&w->plan), w->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        bvxi_near_run const r = bvxi_near_run_of(&w->plan, i);
        for (int32_t x = r.begin; x < r.end; x++) find_cube_band(w, &r, x, &w->workers[worker]);
    }
}

static bvx_status make_near_band(bvx_context *ctx, const char *stage, double from, double to, band_work *w)
{
    double const begin = from + (to - from) * 0.03;
    /* First which cubes, then their memory, then the search: nothing is allocated in between. */
    BVXI_TRY(bvxi_parallel(ctx, stage, from, begin, w->pieces, find_reached_cubes, w));

    bvxi_near_memo *const m = w->n->memo;
    uint64_t slots = 0;

    /* Only cubes that the mesh reaches get memory: far ones are most of a lattice. */
    bvxi_near_forget(ctx, m);
    BVXI_TRY(BVXI_ARRAY(ctx, w->plan.cubes, "the field's cubes", m->cube_slot));
    m->cubes = w->plan.cubes;
    for (uint64_t i = 0; i < w->plan.cubes; i++)
        m->cube_slot[i] = w->reached[i] ? (uint32_t)slots++ : BVXI_NEAR_NONE;
    BVXI_TRY(BVXI_ARRAY(ctx, slots * BVXI_NEAR_CUBE_SLOTS, "the field's nearest triangles", m->triangle));
    m->slots = slots;
    memcpy(m->low, w->band->low, sizeof m->low);
    memcpy(m->size, w->band->size, sizeof m->size);

    BVXI_TRY(bvxi_parallel(ctx, stage, begin, to, w->pieces, find_near_band, w));
    bvxi_sparse_number(w->band, w->first);
    return BVX_OK;
}

bvx_status bvxi_near_workers(bvx_context *ctx, int32_t few_reached, bvxi_near_worker **workers)
{
    int32_t const threads = bvxi_threads(ctx);
    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)threads * sizeof **workers, "the field's workers", workers));
    /* Only what a search reads before it writes is set; the rest of a worker is large. */
    for (int32_t i = 0; i < threads; i++) {
        (*workers)[i].known = 0;
        (*workers)[i].few_reached = few_reached;
        (*workers)[i].fast = bvxi_cpu(ctx) == BVX_CPU_AVX2;
    }
    return BVX_OK;
}

bvx_status bvxi_nearest_band(bvxi_call call, const bvxi_nearest *nearest, double width, bvx_grid *band,
                             uint64_t *first)
{
    band_work w = {nearest, band, bvxi_near_plan_of(band), width, NULL, NULL, first, 0};
    BVXI_TRY(bvxi_near_workers(call.ctx, 1, &w.workers));
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, w.plan.cubes, "the field's cubes", &w.reached));
    /* Small tasks: runs near the mesh take far longer than others. */
    w.pieces = bvxi_piece_count(bvxi_near_plan_runs(&w.plan), 1);
    bvx_status const status = make_near_band(call.ctx, call.stage, call.from, call.to, &w);
    bvxi_drop(call.ctx, w.reached);
    bvxi_drop(call.ctx, w.workers);
    if (status != BVX_OK) bvxi_near_forget(call.ctx, nearest->memo);
    return status;
}
