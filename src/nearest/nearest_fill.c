/* nearest_fill.c - vectors, distances, triangles and features at the set voxels of a grid.
 *
 * A brick's nearest triangles come from what a band remembered, or from a search: first within the distance
 * that is guessed, then without bounds for what lies further off. Then all of its centres are evaluated in
 * doubles together and each value goes to the rank of its voxel. */
#include "nearest/nearest_walk.h"
#include "nearest/closest.h"

#include <math.h>

typedef struct fill_work {
    const bvxi_nearest *n;
    const bvx_grid *where; /* of values */
    const bvxi_sparse *values;
    double guess, to_world; /* the inverse of the tree's scale, a power of two too */
    bvxi_near_plan plan;
    bvxi_near_worker *workers;
    int32_t pieces, remembered; /* 1: the memo is of this window */
} fill_work;

/* ---- Ranks ---- */

enum { FILL_BRICK_ROWS = 16, FILL_RUN_WORDS = BVXI_NEAR_RUN * BVXI_NEAR_CUBE / BVXI_WORD_BITS };

/* A run of cubes: the number of each row's next value, and where along x each row of bricks has any. */
typedef struct fill_ranks {
    uint64_t next[BVXI_NEAR_CUBE][BVXI_NEAR_CUBE]; /* z, y */
    /* row of bricks y + 4 z; bits from the run's first centre on */
    uint64_t any[FILL_BRICK_ROWS][FILL_RUN_WORDS];
} fill_ranks;

/* ---- One brick ---- */

static void put_near_numbers(int32_t type, void *to, uint64_t i, const double *x, int32_t count)
{
    /* Everything is computed in doubles; only what is kept is rounded, once. */
    for (int32_t k = 0; k < count; k++) {
        if (type == BVX_F32) ((float *)to)[i * (uint64_t)count + (uint64_t)k] = (float)x[k];
        else ((double *)to)[i * (uint64_t)count + (uint64_t)k] = x[k];
    }
}

/* Value number i is that of pair p. Adding 0 makes one zero of two. */
static void put_near_value(const fill_work *w, const bvxi_near_pairs *pairs, int32_t p, uint64_t i)
{
    const bvxi_sparse *const v = w->values;

    if (v->vectors != NULL) {
        double d[3];
        for (int a = 0; a < 3; a++) d[a] = (pairs->closest[a][p] - pairs->point[a][p]) * w->to_world + 0.0;
        put_near_numbers(v->value_type, v->vectors, i, d, 3);
    }
    if (v->distances != NULL) {
        double const d = sqrt(pairs->distance2[p]) * w->to_world;
        put_near_numbers(v->value_type, v->distances, i, &d, 1);
    }
    if (v->features != NULL) {
        bvx_closest_point place;
        double t[3][3], point[3], q[3];
        for (int k = 0; k < 9; k++) t[k / 3][k % 3] = pairs->corner[k][p];
        for (int a = 0; a < 3; a++) {
            point[a] = pairs->point[a][p];
            q[a] = pairs->closest[a][p];
        }
        bvxi_closest_place(point, (const double(*)[3])t, q, &place);
        v->features[i] = (uint8_t)place.feature;
    }
}

/* Searches in the cube begin with what lies within width of it, or within more. */
static void start_fill_cube(const fill_work *w, const int32_t cube[3], double width, bvxi_near_worker *worker)
{
    if (worker->started && worker->started_width >= width) return;
    /* A wider search finds all that a narrower one would, so it stays for the bricks that follow. */
    bvxi_near_cube_begin(w->n, cube, width, worker);
    worker->started = 1;
    worker->started_width = width;
}

static void search_fill_brick(const fill_work *w, const int32_t cube[3], uint64_t wanted,
                              bvxi_near_worker *worker)
{
    uint32_t triangle[BVXI_NEAR_SLOTS];
    uint64_t found = 0;

    /* A bounded search leaves most boxes out; only what it leaves open is searched without bounds. */
    if (w->guess < HUGE_VAL) {
        start_fill_cube(w, cube, w->guess, worker);
        found = bvxi_near_brick_find(w->n, wanted, w->guess, worker);
        if (found == wanted) return;
        memcpy(triangle, worker->triangle, sizeof triangle);
    }
    start_fill_cube(w, cube, HUGE_VAL, worker);
    bvxi_near_brick_find(w->n, wanted & ~found, HUGE_VAL, worker);
    for (; found != 0; found &= found - 1)
        worker->triangle[bvxi_lowest(found)] = triangle[bvxi_lowest(found)];
}

static void fill_near_brick(const fill_work *w, const int32_t cube[3], const int32_t first[3],
                            const uint32_t *remembered, fill_ranks *ranks, bvxi_near_worker *worker)
{
    uint64_t const set = bvxi_near_slots_of(w->where, first);
    const bvxi_sparse *const v = w->values;
    bvxi_near_pairs *const pairs = &worker->pairs;
    uint64_t value[BVXI_NEAR_SLOTS]; /* the number of each pair's */
    int32_t index[3];

    for (int a = 0; a < 3; a++) index[a] = w->where->low[a] + first[a];
    bvxi_near_brick_begin(w->n, (const int32_t *)index, worker);

    /* Nearest triangles of a brick: remembered ones, and of unknown slots by a search. */
    uint64_t unknown = remembered == NULL ? set : 0;
    /* The band remembers what lay within its width; other slots were not asked for. */
    for (uint64_t m = set & ~unknown; m != 0; m &= m - 1)
        unknown |= (uint64_t)(remembered[bvxi_lowest(m)] == BVXI_NEAR_NONE) << bvxi_lowest(m);
    if (unknown != 0) search_fill_brick(w, cube, unknown, worker);
    for (uint64_t m = set & ~unknown; m != 0; m &= m - 1)
        worker->triangle[bvxi_lowest(m)] = remembered[bvxi_lowest(m)];

    pairs->count = 0;

    /* Slots of a brick lie in the order of its rows, and so do the values. */
    for (uint64_t m = set; m != 0; m &= m - 1) {
        int32_t const s = bvxi_lowest(m);
        int32_t const y = first[1] % BVXI_NEAR_CUBE + (s >> 2 & 3);
        int32_t const z = first[2] % BVXI_NEAR_CUBE + (s >> 4);
        uint64_t const i = ranks->next[z][y]++;
        double const point[3] = {worker->centre[0][s & 3], worker->centre[1][s >> 2 & 3],
                                 worker->centre[2][s >> 4]};

        if (v->triangles != NULL) v->triangles[i] = worker->triangle[s];
        if (v->vectors == NULL && v->distances == NULL && v->features == NULL) continue;
        value[pairs->count] = i;
        bvxi_near_take_pair(w->n, pairs, point, worker->triangle[s], s);
    }

    /* Values come from the evaluation in doubles alone, whoever found the triangle. */
    bvxi_near_evaluate(w->n, worker->fast, pairs);
    for (int32_t p = 0; p < pairs->count; p++) put_near_value(w, pairs, p, value[p]);
}

/* ---- All ---- */

static void fill_near_cube(const fill_work *w, const bvxi_near_run *r, int32_t x, fill_ranks *ranks,
                           bvxi_near_worker *worker)
{
    uint32_t slot = BVXI_NEAR_NONE;
    int32_t const cube[3] = {w->where->low[0] + x * BVXI_NEAR_CUBE, w->where->low[1] + r->y * BVXI_NEAR_CUBE,
                             w->where->low[2] + r->z * BVXI_NEAR_CUBE};

    /* A search is begun by the first brick that needs one; most cubes' bricks are remembered. */
    worker->started = 0;
    if (w->remembered) slot = w->n->memo->cube_slot[bvxi_near_cube_number(&w->plan, r, x)];
    for (int32_t b = 0; b < 64; b++) {
        /* from the run's first centre */
        int32_t const at = (x - r->begin) * BVXI_NEAR_CUBE + (b & 3) * BVXI_NEAR_SIDE;
        int32_t first[3];

        /* Most bricks of a band's cubes are empty: one look at four rows' words says so. */
        if ((ranks->any[b >> 2][at / BVXI_WORD_BITS] >> at % BVXI_WORD_BITS & 15) == 0) continue;
        bvxi_near_brick_first(r, x, b, first);
        fill_near_brick(w, cube, (const int32_t *)first,
                        slot == BVXI_NEAR_NONE
                            ? NULL
                            : w->n->memo->triangle + (uint64_t)slot * BVXI_NEAR_CUBE_SLOTS +
                                  (uint64_t)b * BVXI_NEAR_SLOTS,
                        ranks, worker);
    }
}

static void fill_near_runs(void *user, int32_t index, int32_t worker)
{
    const fill_work *const w = user;
    uint64_t begin, end;
    bvxi_piece(bvxi_near_plan_runs(&w->plan), w->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        bvxi_near_run const r = bvxi_near_run_of(&w->plan, i);
        fill_ranks ranks;
        int32_t const words = r.begin * BVXI_NEAR_CUBE / BVXI_WORD_BITS;
        int32_t const last = (r.end * BVXI_NEAR_CUBE + BVXI_WORD_BITS - 1) / BVXI_WORD_BITS;
        int32_t const most = last < w->where->words_per_row ? last : w->where->words_per_row;

        memset(ranks.any, 0, sizeof ranks.any);
        for (int32_t z = 0; z < BVXI_NEAR_CUBE && r.z * BVXI_NEAR_CUBE + z < w->where->size[2]; z++)
            for (int32_t y = 0; y < BVXI_NEAR_CUBE && r.y * BVXI_NEAR_CUBE + y < w->where->size[1]; y++) {
                int32_t const j = r.y * BVXI_NEAR_CUBE + y, k = r.z * BVXI_NEAR_CUBE + z;
                const uint64_t *const row = bvxi_grid_row(w->where, j, k);
                uint64_t n = w->values->first[(uint64_t)k * (uint64_t)w->where->size[1] + (uint64_t)j];

                /* The row's prefix is stored, what lies before the run is counted: once for 64 cubes. */
                for (int32_t x = 0; x < words; x++) n += bvxi_popcount(row[x]);
                ranks.next[z][y] = n;
                for (int32_t x = words; x < most; x++)
                    ranks.any[y / BVXI_NEAR_SIDE + z / BVXI_NEAR_SIDE * 4][x - words] |= row[x];
            }
        for (int32_t x = r.begin; x < r.end; x++) fill_near_cube(w, &r, x, &ranks, &w->workers[worker]);
    }
}

bvx_status bvxi_nearest_fill(bvxi_call call, const bvxi_nearest *nearest, double guess,
                             const bvxi_sparse *values)
{
    const bvx_grid *const where = &values->where;
    fill_work w = {.n = nearest,
                   .where = where,
                   .values = values,
                   .guess = guess,
                   .to_world = 1.0 / nearest->scale,
                   .plan = bvxi_near_plan_of(where)};
    const bvxi_near_memo *const m = nearest->memo;

    BVXI_TRY(bvxi_near_workers(call.ctx, 0, &w.workers));
    w.pieces = bvxi_piece_count(bvxi_near_plan_runs(&w.plan), 1);

    /* What the band remembered is of use only where it lay as these values do. */
    w.remembered = m->cubes != 0 && memcmp(m->low, where->low, sizeof m->low) == 0 &&
                   memcmp(m->size, where->size, sizeof m->size) == 0;
    BVXI_TRY(bvxi_parallel(call.ctx, call.stage, call.from, call.to, w.pieces, fill_near_runs, &w));
    bvxi_drop(call.ctx, w.workers);
    return BVX_OK;
}
