/* bench_turns.c - one run of ours at a time, on demand, so that another library can take turns with it.
 *
 *   bench_turns FOLDER
 *
 * Works on mesh.positions and mesh.triangles in FOLDER. Reads lines "JOB THREADS" (JOB: solid, surface, job,
 * level) from standard input, does the job once on warm memory and answers with its milliseconds. The jobs
 * are those of bench_core; level is the main job's finest level only, from mesh to arrays. */
#include "bench.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_THREADS = 2 };

typedef struct turns {
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_context *ctx[MOST_THREADS + 1];
    bench_memory memory[MOST_THREADS + 1];
    bvx_grid solid; /* what surfaces are made of */
} turns;

static double solid_once(const turns *t, bvx_context *ctx)
{
    bvx_grid solid = {0};
    double const start = bench_clock(bvx_context_threads(ctx));
    bench_try(ctx, bvx_voxelize_solid(ctx, &t->view, &t->lattice, NULL, &solid), "solid");
    double const ms = bench_clock(bvx_context_threads(ctx)) - start;
    bvx_grid_free(ctx, &solid);
    return ms;
}

static double surface_once(const turns *t, bvx_context *ctx)
{
    bvx_mesh surface = {0};
    double const start = bench_clock(bvx_context_threads(ctx));
    bench_try(ctx, bvx_extract_surface(ctx, &t->solid, NULL, &surface), "surface");
    double const ms = bench_clock(bvx_context_threads(ctx)) - start;
    bvx_mesh_free(ctx, &surface);
    return ms;
}

static double levels_once(const turns *t, bvx_context *ctx, uint64_t level_count)
{
    bvx_mesh levels[BENCH_LEVELS] = {{0}};
    double const start = bench_clock(bvx_context_threads(ctx));
    bench_main_job(ctx, &t->view, level_count, levels, NULL);
    double const ms = bench_clock(bvx_context_threads(ctx)) - start;
    for (uint64_t i = 0; i < level_count; i++) bvx_mesh_free(ctx, &levels[i]);
    return ms;
}

static double turn(const turns *t, const char *job, int threads)
{
    bvx_context *const ctx = t->ctx[threads];
    if (strcmp(job, "solid") == 0) return solid_once(t, ctx);
    if (strcmp(job, "surface") == 0) return surface_once(t, ctx);
    if (strcmp(job, "job") == 0) return levels_once(t, ctx, BENCH_LEVELS);
    if (strcmp(job, "level") == 0) return levels_once(t, ctx, 1);
    return -1.0;
}

static const void *load(const char *folder, const char *name, size_t *size)
{
    char path[1024];

    snprintf(path, sizeof path, "%s/%s", folder, name);
    const void *const bytes = bench_read_file(path, size);
    if (bytes == NULL) {
        fprintf(stderr, "bench_turns: %s cannot be read\n", path);
        exit(1);
    }
    return bytes;
}

int main(int argc, char **argv)
{
    static turns t;
    static const char *const jobs[] = {"solid", "surface", "job", "level"};
    char job[16];
    int threads;
    size_t size;

    if (argc != 2) {
        fprintf(stderr, "usage: bench_turns FOLDER\n");
        return 2;
    }
    t.view.positions = load(argv[1], "mesh.positions", &size);
    t.view.vertex_count = size / 12;
    t.view.indices = load(argv[1], "mesh.triangles", &size);
    t.view.triangle_count = size / 12;
    t.view.position_type = BVX_F32;
    t.view.index_type = BVX_U32;
    for (int i = 1; i <= MOST_THREADS; i++) t.ctx[i] = bench_context(i, BVX_CPU_BEST, &t.memory[i]);
    bench_try(t.ctx[1], bvx_lattice_fit(t.ctx[1], &t.view, BENCH_FINE, &t.lattice), "lattice");
    bench_try(t.ctx[1], bvx_voxelize_solid(t.ctx[1], &t.view, &t.lattice, NULL, &t.solid), "solid");
    for (int i = 1; i <= MOST_THREADS; i++) /* warm */
        for (size_t j = 0; j < sizeof jobs / sizeof *jobs; j++) turn(&t, jobs[j], i);
    while (scanf("%15s %d", job, &threads) == 2) {
        printf("%.6f\n", threads >= 1 && threads <= MOST_THREADS ? turn(&t, job, threads) : -1.0);
        fflush(stdout);
    }
    return 0;
}
