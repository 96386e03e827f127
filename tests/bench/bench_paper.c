/* bench_paper.c - Tables 3-1 to 3-6 of "LOD by voxelization and downsampling" again, ours beside the paper's
 * figures.
 *
 *   bench_paper FOLDER_OF_MESHES [RUNS]
 *
 * Same resolutions of voxels and samples, stretched along each axis as there. The meshes are other copies of
 * the same models, so triangle counts of the input differ; Aphrodite is not to be had, Nefertiti stands for
 * it and for the head. The paper: one thread of an i7-4720HQ at 2.6 GHz. Ours: one thread of this machine,
 * the least of several runs; the lattice's fitting counts as voxelization. Both LOD methods are shown; totals
 * and rates are of the edge ratio, which is the paper's own. Writes the tables as Markdown to standard
 * output. */
#include "bench.h"

#include <stdlib.h>
#include <string.h>

typedef struct paper_row {
    const char *table, *model, *file;
    int32_t voxels, samples; /* along each axis */
    int input, output;       /* triangles in the paper */
    double voxelize_ms, rebuild_ms, rate;
} paper_row;

#define SPHERE    "sphere", "unit_sphere.stl.gz"
#define COW       "cow", "cow.obj.gz"
#define BUDDHA    "buddha", "buddha_113k.obj.gz"
#define DRAGON    "dragon", "dragon_100k.obj.gz"
#define HEAD      "head (ours: Nefertiti)", "nefertiti_100k.obj.gz"
#define APHRODITE "Aphrodite (ours: Nefertiti)", "nefertiti_100k.obj.gz"

static const paper_row rows[] = {
    {"3-1", SPHERE, 200, 20, 2401, 3740, 16.11, 14.67, 1.5577},
    {"3-1", COW, 200, 20, 8627, 3344, 19.91, 13.08, 0.3876},
    {"3-1", BUDDHA, 200, 20, 61892, 3976, 37.89, 14.84, 0.0642},
    {"3-1", DRAGON, 200, 20, 100001, 3988, 56.71, 15.27, 0.0399},
    {"3-1", HEAD, 200, 20, 499059, 2632, 91.62, 10.91, 0.0053},
    {"3-2", BUDDHA, 50, 50, 61892, 27080, 10.1721, 68.7677, 0.4375},
    {"3-2", BUDDHA, 100, 50, 61892, 27276, 18.9258, 76.2594, 0.4407},
    {"3-2", BUDDHA, 150, 50, 61892, 27252, 29.0245, 84.4376, 0.4403},
    {"3-2", BUDDHA, 200, 50, 61892, 27228, 42.878, 92.3311, 0.4399},
    {"3-2", BUDDHA, 300, 50, 61892, 27160, 73.0544, 104.834, 0.4388},
    {"3-2", BUDDHA, 500, 50, 61892, 27068, 151.841, 132.292, 0.4373},
    {"3-3", COW, 50, 20, 8627, 3548, 23.7292, 6.7152, 0.4113},
    {"3-3", COW, 100, 20, 8627, 3384, 27.6235, 9.0261, 0.3923},
    {"3-3", COW, 150, 20, 8627, 3408, 35.1337, 11.8841, 0.3950},
    {"3-3", COW, 200, 20, 8627, 3344, 40.0362, 13.0735, 0.3876},
    {"3-3", COW, 300, 20, 8627, 3344, 60.6014, 17.5745, 0.3876},
    {"3-3", COW, 500, 20, 8627, 3340, 108.269, 28.3968, 0.3872},
    {"3-4", APHRODITE, 100, 10, 579905, 832, 72.6059, 2.7088, 0.0014},
    {"3-4", APHRODITE, 100, 20, 579905, 3468, 73.7687, 8.9589, 0.0060},
    {"3-4", APHRODITE, 100, 30, 579905, 8204, 71.6364, 20.645, 0.0141},
    {"3-4", APHRODITE, 100, 50, 579905, 23112, 73.9485, 70.655, 0.0399},
    {"3-4", APHRODITE, 100, 100, 579905, 95036, 74.6696, 430.612, 0.1639},
    {"3-5", APHRODITE, 500, 10, 579905, 832, 278.678, 14.4915, 0.0014},
    {"3-5", APHRODITE, 500, 20, 579905, 3496, 278.245, 30.1771, 0.0060},
    {"3-5", APHRODITE, 500, 30, 579905, 8096, 279.213, 51.0057, 0.0140},
    {"3-5", APHRODITE, 500, 50, 579905, 23232, 275.612, 120.693, 0.0401},
    {"3-5", APHRODITE, 500, 100, 579905, 95368, 276.998, 551.183, 0.1645},
    {"3-6", DRAGON, 300, 10, 100001, 788, 90.125, 7.00376, 0.0079},
    {"3-6", DRAGON, 300, 20, 100001, 3932, 92.625, 25.4709, 0.0393},
    {"3-6", DRAGON, 300, 30, 100001, 9344, 91.3612, 41.0049, 0.0934},
    {"3-6", DRAGON, 300, 50, 100001, 27420, 89.1138, 114.834, 0.2742},
    {"3-6", DRAGON, 300, 100, 100001, 111840, 89.873, 532.142, 1.1184},
};

enum { METHODS = 2 };
static const int32_t methods[METHODS] = {BVX_LOD_EDGE_RATIO, BVX_LOD_COVERAGE};

typedef struct outcome {
    bench_times voxelize, rebuild[METHODS];
    uint64_t triangles[METHODS];
} outcome;

static void voxelize(bvx_context *ctx, const bvx_mesh_view *view, int32_t n, outcome *out, bvx_grid *solid)
{
    bvx_lattice lattice;
    bvx_lattice_options options = {.struct_size = sizeof options};

    for (int a = 0; a < 3; a++) options.axis_resolution[a] = n;
    double const start = bench_clock(1);
    bench_try(ctx, bvx_lattice_fit_with(ctx, view, &options, &lattice), "lattice");
    bench_try(ctx, bvx_voxelize_solid(ctx, view, &lattice, NULL, solid), "solid");
    bench_add(&out->voxelize, bench_clock(1) - start);
}

static void rebuild(bvx_context *ctx, const bvx_grid *solid, int32_t samples, int m, outcome *out)
{
    bvx_mesh level = {0};
    bvx_lod_options options = {.struct_size = sizeof options};
    int32_t const resolution[3] = {samples, samples, samples};

    options.sampling.method = methods[m];
    options.axis_resolutions = resolution;
    double const start = bench_clock(1);
    bench_try(ctx, bvx_build_lods(ctx, solid, &options, 1, &level), "level");
    bench_add(&out->rebuild[m], bench_clock(1) - start);
    out->triangles[m] = level.triangle_count;
    bvx_mesh_free(ctx, &level);
}

static void show(const paper_row *r, uint64_t input, const outcome *out)
{
    double const ours = bench_min(&out->voxelize);
    double const edge = bench_min(&out->rebuild[0]);
    double const cover = bench_min(&out->rebuild[1]);
    double const theirs = r->voxelize_ms + r->rebuild_ms;

    printf("| %s | %d | %d | %.3g |", r->model, r->voxels, r->samples, (double)r->voxels / r->samples);
    printf(" %llu : %d |", (unsigned long long)input, r->input);
    printf(" %llu, %llu : %d |", (unsigned long long)out->triangles[0], (unsigned long long)out->triangles[1],
           r->output);
    printf(" %.2f : %.1f | %.2f, %.2f : %.1f |", ours, r->voxelize_ms, edge, cover, r->rebuild_ms);
    printf(" %.2f : %.1f | %.4f : %.4f |", ours + edge, theirs, (double)out->triangles[0] / (double)input,
           r->rate);
    printf(" %.0f : %.0f %% |\n", 100.0 * ours / (ours + edge), 100.0 * r->voxelize_ms / theirs);
}

static void head(const char *table)
{
    printf("\nTable %s (ours : the paper's; two figures of ours: edge ratio, coverage)\n\n", table);
    printf(
        "| model | voxels | samples | ratio | input triangles | output triangles | voxelize ms | rebuild ms |"
        " total ms | rate | voxelize's share |\n");
    printf("|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
}

int main(int argc, char **argv)
{
    static bench_memory memory;
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, &memory);
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    const char *loaded = "", *table = "";
    char path[1024];

    if (argc < 2) {
        fprintf(stderr, "usage: bench_paper FOLDER_OF_MESHES [RUNS]\n");
        return 2;
    }
    int const runs = argc > 2 ? atoi(argv[2]) : 9;
    for (size_t i = 0; i < sizeof rows / sizeof *rows; i++) {
        const paper_row *const r = &rows[i];
        static outcome out;
        memset(&out, 0, sizeof out);
        if (strcmp(r->table, table) != 0) head(table = r->table);
        if (strcmp(r->file, loaded) != 0) {
            bvx_mesh_free(ctx, &mesh);
            loaded = r->file;
            snprintf(path, sizeof path, "%s/%s", argv[1], r->file);
            if (!bench_read_mesh(ctx, path, &mesh)) loaded = "";
        }
        if (loaded[0] == 0) {
            printf("| %s | %s is missing |\n", r->model, path);
            continue;
        }
        bvx_mesh_view_of(&mesh, &view);
        for (int run = 0; run < runs; run++) {
            bvx_grid solid = {0};
            voxelize(ctx, &view, r->voxels, &out, &solid);
            for (int m = 0; m < METHODS; m++) rebuild(ctx, &solid, r->samples, m, &out);
            bvx_grid_free(ctx, &solid);
        }
        show(r, mesh.triangle_count, &out);
        fflush(stdout);
    }
    bvx_mesh_free(ctx, &mesh);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}
