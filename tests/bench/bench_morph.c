/* bench_morph.c - morphology and distances of a solid dragon and of a random tenth, both 512 voxels a side.
 *
 *   bench_morph MESH_FOLDER OUT [RUNS]   prints Markdown; writes OUT/morph.jsonl: targets, and
 *   OUT/morph_dragon.npy and OUT/morph_random.npy: the grids
 *
 * Warm memory, one thread by processor time and two by the clock; the least of the runs is reported. The
 * dragon's grid is padded to 512 along each axis. */
#include "bench_models.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = 512, THREADS = 2 };
static int runs = 9;

typedef struct stage {
    bvx_context *ctx[THREADS + 1];
    bench_memory memory[THREADS + 1];
    bvx_grid grid[2], result; /* dragon, random */
    uint32_t *squares;
} stage;

static const char *const grid_names[2] = {"dragon", "random"};

static void make_dragon(stage *s, const char *folder)
{
    bench_model m;
    bvx_lattice l;
    bvx_context *const ctx = s->ctx[1];

    if (!bench_model_open(ctx, folder, "dragon_vrip_871414.ply.gz", "dragon", &m)) exit(1);
    bench_try(ctx, bvx_lattice_fit(ctx, &m.view, SIDE, &l), "dragon");
    int32_t const dims[3] = {SIDE, SIDE, SIDE};
    bench_try(ctx, bvx_lattice_make(ctx, l.origin, l.spacing, dims, &l), "dragon");
    bench_try(ctx, bvx_voxelize_solid(ctx, &m.view, &l, NULL, &s->grid[0]), "dragon");
    bench_try(ctx, bvx_grid_create(ctx, &l, NULL, &s->grid[1]), "random");
    bench_try(ctx, bvx_grid_create(ctx, &l, NULL, &s->result), "result");
    bench_model_free(ctx, &m);
}

static void scatter_tenth(bvx_grid *g)
{
    uint64_t r = UINT64_C(88172645463325252);

    for (int32_t z = 0; z < SIDE; z++)
        for (int32_t y = 0; y < SIDE; y++)
            for (int32_t x = 0; x < SIDE; x++) {
                r ^= r << 13;
                r ^= r >> 7;
                r ^= r << 17;
                if ((r >> 40) % 10 == 0) bvx_grid_set(g, x, y, z, 1);
            }
}

static void save_grid(const stage *s, int which, const char *out)
{
    char path[1024];
    bvx_buffer file = {0};
    FILE *to;

    snprintf(path, sizeof path, "%s/morph_%s.npy", out, grid_names[which]);
    bench_try(s->ctx[1], bvx_write_grid(s->ctx[1], &s->grid[which], BVX_FORMAT_NPY, &file), path);
    to = bench_open(path);
    fwrite(file.bytes, 1, (size_t)file.size, to);
    fclose(to);
    bvx_buffer_free(s->ctx[1], &file);
}

/* ---- jobs ---- */

typedef enum job_kind { COPY, STEPS, BALL, CLOSE, SQUARES, LENGTHS } job_kind;

typedef struct job {
    const char *name;
    job_kind kind;
    int32_t neighbourhood, steps;
    double radius; /* [Units: voxels] */
    bench_times times[THREADS + 1];
} job;

static void run_job(stage *s, const bvx_grid *g, const job *j, int threads)
{
    bvx_context *const ctx = s->ctx[threads];
    uint64_t const voxels = (uint64_t)SIDE * SIDE * SIDE;
    bvx_morph_options m = {.struct_size = sizeof m};

    m.neighbourhood = j->neighbourhood != 0 ? j->neighbourhood : BVX_BALL;
    m.steps = j->steps;
    m.radius = j->radius * g->lattice.spacing[0];
    switch (j->kind) {
    case COPY: memcpy(s->result.words, g->words, (size_t)voxels / 8); break;
    case STEPS:
    case BALL: bench_try(ctx, bvx_grid_morph(ctx, g, BVX_MORPH_DILATE, &m, &s->result), j->name); break;
    case CLOSE: bench_try(ctx, bvx_grid_morph(ctx, g, BVX_MORPH_CLOSE, &m, &s->result), j->name); break;
    case SQUARES:
        bench_try(ctx, bvx_grid_distance(ctx, g, NULL, BVX_SQUARES, s->squares, voxels), j->name);
        break;
    case LENGTHS:
        bench_try(ctx, bvx_grid_distance(ctx, g, NULL, BVX_F32, s->squares, voxels), j->name);
        break;
    }
}

static void run_jobs(stage *s, const bvx_grid *g, job *jobs, int count)
{
    for (int run = 0; run <= runs; run++)
        for (int i = 0; i < count; i++)
            for (int threads = 1; threads <= THREADS; threads++) {
                double const start = bench_clock(threads);
                run_job(s, g, &jobs[i], threads);
                if (run > 0) bench_add(&jobs[i].times[threads], bench_clock(threads) - start);
            }
}

int main(int count, char **word)
{
    static job jobs[2][9];
    static const job all[] = {
        {"copy of the grid", COPY, 6, 1, 0, {{{0}, 0}}},
        {"dilate, 6 neighbours", STEPS, 6, 1, 0, {{{0}, 0}}},
        {"dilate, 26 neighbours", STEPS, 26, 1, 0, {{{0}, 0}}},
        {"dilate, 6 neighbours, 10 steps", STEPS, 6, 10, 0, {{{0}, 0}}},
        {"dilate, ball of 3", BALL, 0, 1, 3, {{{0}, 0}}},
        {"dilate, ball of 10", BALL, 0, 1, 10, {{{0}, 0}}},
        {"close, ball of 3", CLOSE, 0, 1, 3, {{{0}, 0}}},
        {"distance, whole squares", SQUARES, 6, 1, 0, {{{0}, 0}}},
        {"distance, f32", LENGTHS, 6, 1, 0, {{{0}, 0}}},
    };

    enum { JOBS = sizeof all / sizeof all[0] };
    static stage s;
    char path[1024];
    FILE *targets;
    if (count < 3) {
        fprintf(stderr, "bench_morph MESH_FOLDER OUT [RUNS]\n");
        return 2;
    }
    if (count > 3) runs = atoi(word[3]);
    for (int t = 1; t <= THREADS; t++) s.ctx[t] = bench_context(t, BVX_CPU_BEST, &s.memory[t]);
    s.squares = malloc((size_t)SIDE * SIDE * SIDE * 4);
    if (s.squares == NULL) return 1;
    make_dragon(&s, word[1]);
    scatter_tenth(&s.grid[1]);
    printf("| 512 x 512 x 512 [ms] | dragon, 1 thread | 2 | random tenth, 1 | 2 |\n|---|---|---|---|---|\n");
    for (int g = 0; g < 2; g++) {
        save_grid(&s, g, word[2]);
        memcpy(jobs[g], all, sizeof all);
        run_jobs(&s, &s.grid[g], jobs[g], JOBS);
    }
    for (int i = 0; i < JOBS; i++) {
        printf("| %s |", all[i].name);
        for (int g = 0; g < 2; g++)
            for (int t = 1; t <= THREADS; t++) printf(" %.2f |", bench_min(&jobs[g][i].times[t]));
        printf("\n");
    }
    snprintf(path, sizeof path, "%s/morph.jsonl", word[2]);
    targets = bench_open(path);
    bench_say_target(targets, "dilate by 6 neighbours beside a copy of the grid",
                     bench_min(&jobs[0][1].times[1]) / bench_min(&jobs[0][0].times[1]), "times", 4.0, 1);
    fclose(targets);
    free(s.squares);
    for (int g = 0; g < 2; g++) bvx_grid_free(s.ctx[1], &s.grid[g]);
    bvx_grid_free(s.ctx[1], &s.result);
    for (int t = 1; t <= THREADS; t++) {
        bvx_context_destroy(s.ctx[t]);
        bench_memory_release(&s.memory[t]);
    }
    return 0;
}
