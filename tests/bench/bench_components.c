/* bench_components.c - parts of grids: counted, listed, numbered, and their topology.
 *
 *   bench_components MESH_FOLDER OUT [RUNS]   prints Markdown
 *   bench_components turns MESH_FOLDER OUT    writes the grids to OUT/components_NAME.npy, then does one run
 *                                             for each line "NAME CONNECTIVITY" of standard input and answers
 *                                             with the milliseconds for counting, numbering into fresh memory
 *                                             and into warm memory, and the number of parts
 *
 * Grids of 512 x 512 x 512: the dragon's solid, and voxels at random, a tenth of them set. One thread,
 * processor time, least of the runs. */
#include "bench_models.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { SIDE = BENCH_FINE };

static const int32_t sides[3] = {SIDE, SIDE, SIDE};
static const char *const names[2] = {"dragon", "random"};
static bvx_grid grids[2];
static bvx_context *ctx;
static uint32_t *warm;

static uint64_t voxels(void)
{
    return (uint64_t)SIDE * SIDE * SIDE;
}

static void make_dragon(const char *folder)
{
    bench_model model;
    bvx_lattice fitted, lattice;

    if (!bench_model_open(ctx, folder, "dragon_vrip_871414.ply.gz", "dragon", &model)) {
        fprintf(stderr, "bench_components: no dragon in %s\n", folder);
        exit(1);
    }
    bench_try(ctx, bvx_lattice_fit(ctx, &model.view, SIDE, &fitted), "lattice");
    bench_try(ctx, bvx_lattice_make(ctx, fitted.origin, fitted.spacing, sides, &lattice), "lattice");
    bench_try(ctx, bvx_voxelize_solid(ctx, &model.view, &lattice, NULL, &grids[0]), "solid");
    bench_model_free(ctx, &model);
}

static void make_random(void)
{
    uint64_t const words = bvx_grid_bound(&grids[0].lattice, NULL);
    uint64_t state = 88172645463325252u;

    bench_try(ctx, bvx_grid_create(ctx, &grids[0].lattice, NULL, &grids[1]), "grid");
    for (uint64_t i = 0; i < words; i++) {
        uint64_t w = 0;
        for (int b = 0; b < 64; b++) {
            state ^= state << 13, state ^= state >> 7, state ^= state << 17;
            w |= (uint64_t)((state >> 11) % 10 == 0) << b;
        }
        grids[1].words[i] = w;
    }
}

static double time_count(const bvx_grid *g, int32_t connectivity, uint64_t *count)
{
    double const start = bench_clock(1);
    bench_try(ctx, bvx_grid_components(ctx, g, connectivity, NULL, 0, count), "components");
    return bench_clock(1) - start;
}

static double time_list(const bvx_grid *g, int32_t connectivity, uint64_t count)
{
    bvx_component *const parts = malloc((size_t)count * sizeof *parts + 1);
    double start;

    if (parts == NULL) exit(1);
    memset(parts, 1, (size_t)count * sizeof *parts);
    start = bench_clock(1);
    bench_try(ctx, bvx_grid_components(ctx, g, connectivity, parts, count, &count), "components");
    start = bench_clock(1) - start;
    free(parts);
    return start;
}

static double time_label(const bvx_grid *g, int32_t connectivity, int fresh)
{
    double const start = bench_clock(1);
    uint32_t *const labels = fresh ? malloc((size_t)voxels() * 4) : warm;
    double ms;

    if (labels == NULL) exit(1);
    bench_try(ctx, bvx_grid_label(ctx, g, connectivity, labels, voxels(), NULL), "labels");
    ms = bench_clock(1) - start;
    if (fresh) free(labels);
    return ms;
}

static double time_topology(const bvx_grid *g, int32_t connectivity)
{
    bvx_topology t;
    double const start = bench_clock(1);
    bench_try(ctx, bvx_grid_topology(ctx, g, connectivity, &t), "topology");
    return bench_clock(1) - start;
}

static double less(double a, double b)
{
    return a == 0.0 || b < a ? b : a;
}

static void table(int runs)
{
    printf(
        "| grid | connectivity | parts | count ms | list ms | labels, warm ms | labels, fresh ms | topology ms |\n|---|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            int32_t const connectivity = k == 0 ? 6 : k == 1 ? 18 : 26;
            double t[5] = {0, 0, 0, 0, 0};
            uint64_t count = 0;
            for (int r = 0; r < runs; r++) {
                t[0] = less(t[0], time_count(&grids[i], connectivity, &count));
                t[1] = less(t[1], time_list(&grids[i], connectivity, count));
                t[2] = less(t[2], time_label(&grids[i], connectivity, 0));
                t[3] = less(t[3], time_label(&grids[i], connectivity, 1));
                if (connectivity != 18) t[4] = less(t[4], time_topology(&grids[i], connectivity));
            }
            printf("| %s | %d | %" PRIu64 " | %.1f | %.1f | %.1f | %.1f | %.1f |\n", names[i],
                   (int)connectivity, count, t[0], t[1], t[2], t[3], t[4]);
        }
}

static void write_grid(const char *out, int i)
{
    char path[4096];
    bvx_buffer file = {0};
    FILE *to;

    snprintf(path, sizeof path, "%s/components_%s.npy", out, names[i]);
    bench_try(ctx, bvx_write_grid(ctx, &grids[i], BVX_FORMAT_NPY, &file), path);
    to = fopen(path, "wb");
    if (to == NULL || fwrite(file.bytes, 1, (size_t)file.size, to) != (size_t)file.size || fclose(to) != 0)
        exit(1);
    bvx_buffer_free(ctx, &file);
}

static void take_turns(const char *out)
{
    char name[16];
    int connectivity;

    write_grid(out, 0);
    write_grid(out, 1);
    puts("ready");
    fflush(stdout);
    while (scanf("%15s %d", name, &connectivity) == 2) {
        const bvx_grid *const g = &grids[strcmp(name, names[0]) != 0];
        uint64_t count = 0;
        double const counted = time_count(g, connectivity, &count), fresh = time_label(g, connectivity, 1);
        printf("%.3f %.3f %.3f %" PRIu64 "\n", counted, fresh, time_label(g, connectivity, 0), count);
        fflush(stdout);
    }
}

int main(int argc, char **argv)
{
    static bench_memory memory;
    int const turns = argc == 4 && strcmp(argv[1], "turns") == 0;

    if (argc < 3) {
        fprintf(stderr, "usage: bench_components [turns] MESH_FOLDER OUT [RUNS]\n");
        return 2;
    }
    ctx = bench_context(1, BVX_CPU_BEST, &memory);
    make_dragon(argv[1 + turns]);
    make_random();
    warm = malloc((size_t)voxels() * 4);
    if (warm == NULL) return 1;
    memset(warm, 1, (size_t)voxels() * 4);
    if (turns) take_turns(argv[3]);
    else table(argc > 3 ? (int)strtol(argv[3], NULL, 10) : 5);
    free(warm);
    bvx_grid_free(ctx, &grids[0]);
    bvx_grid_free(ctx, &grids[1]);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}
