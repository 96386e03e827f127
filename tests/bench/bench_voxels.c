/* bench_voxels.c - surfaces, fills and refinement: bench_voxels MESH_FOLDER [RUNS]. Prints Markdown.
 *
 * One thread, processor time, warm memory, least of the runs. The TIN paper's Table 1 columns stand in the first table: mean
 * subdivision coefficient, time and voxels of its sampling, beside the exact surfaces; meshes of many small triangles and of few
 * large ones. The refinement paper's Tables 2 and 3 follow: time by (base, levels), and voxels kept beside one split. */
#include "bench.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static int runs = 5;

typedef struct model {
    const char *name;
    bvx_mesh mesh;
    bvx_mesh_view view;
} model;

static int open_model(bvx_context *ctx, const char *folder, const char *name, model *m)
{
    char path[1024];
    memset(m, 0, sizeof *m);
    m->name = name;
    snprintf(path, sizeof path, "%s/%s", folder, name);
    if (!bench_read_mesh(ctx, path, &m->mesh)) return 0;
    bvx_mesh_view_of(&m->mesh, &m->view);
    return 1;
}

static double solid_ms(bvx_context *ctx, const model *m, const bvx_lattice *lattice, int32_t fill, uint64_t *set)
{
    static bench_times t;
    t.count = 0;
    for (int i = 0; i < runs; i++) {
        bvx_voxelize_options o;
        bvx_grid grid = {0};
        bvx_status status;
        double const start = bench_clock(1);
        bvx_voxelize_options_init(&o, sizeof o);
        o.fill = fill;
        status = bvx_voxelize_solid(ctx, &m->view, lattice, &o, &grid);
        bench_add(&t, bench_clock(1) - start);
        if (status == BVX_ERR_EMPTY) { /* a flood that finds nothing, after all its work */
            *set = UINT64_MAX;
            continue;
        }
        bench_try(ctx, status, m->name);
        bench_try(ctx, bvx_grid_count(ctx, &grid, set), m->name);
        bvx_grid_free(ctx, &grid);
    }
    return bench_min(&t);
}

static double surface_ms(bvx_context *ctx, const model *m, const bvx_lattice *lattice, int32_t mode, uint64_t *set,
                         bvx_surface_report *report)
{
    static bench_times t;
    t.count = 0;
    for (int i = 0; i < runs; i++) {
        bvx_surface_options o;
        bvx_grid grid = {0};
        double const start = bench_clock(1);
        bvx_surface_options_init(&o, sizeof o);
        o.mode = mode;
        o.report = report;
        bench_try(ctx, bvx_voxelize_surface(ctx, &m->view, lattice, &o, &grid), m->name);
        bench_add(&t, bench_clock(1) - start);
        bench_try(ctx, bvx_grid_count(ctx, &grid, set), m->name);
        bvx_grid_free(ctx, &grid);
    }
    return bench_min(&t);
}

static void show_surfaces(bvx_context *ctx, const model *m)
{
    static const int32_t resolutions[] = {128, 256, 512};
    for (int r = 0; r < 3; r++) {
        bvx_lattice lattice;
        bvx_surface_report report;
        uint64_t set[4];
        double ms[4];
        bench_try(ctx, bvx_lattice_fit(ctx, &m->view, resolutions[r], &lattice), m->name);
        ms[0] = solid_ms(ctx, m, &lattice, BVX_FILL_PARITY, &set[0]);
        ms[1] = surface_ms(ctx, m, &lattice, BVX_SURFACE_CONSERVATIVE, &set[1], &report);
        ms[2] = surface_ms(ctx, m, &lattice, BVX_SURFACE_THIN, &set[2], &report);
        ms[3] = surface_ms(ctx, m, &lattice, BVX_SURFACE_SAMPLED, &set[3], &report);
        printf("| %s | %" PRId32 " | %.1f | %.1f, %.2f | %" PRIu64 " | %.1f | %" PRIu64 " | %.1f | %" PRIu64 " | %.2f |\n", m->name,
               resolutions[r], ms[0], ms[1], ms[1] / ms[0], set[1], ms[2], set[2], ms[3], set[3],
               report.triangles != 0 ? (double)report.parts / (double)report.triangles : 0.0);
    }
}

static void show_fills(bvx_context *ctx, const model *m)
{
    static const int32_t rules[] = {BVX_FILL_PARITY, BVX_FILL_NONZERO, BVX_FILL_VOTE, BVX_FILL_REGIONS, BVX_FILL_FLOOD};
    bvx_lattice lattice;
    bench_try(ctx, bvx_lattice_fit(ctx, &m->view, 256, &lattice), m->name);
    printf("| %s |", m->name);
    for (int i = 0; i < 5; i++) {
        uint64_t set = 0;
        double const ms = solid_ms(ctx, m, &lattice, rules[i], &set);
        if (set == UINT64_MAX) printf(" %.1f, leaks |", ms);
        else printf(" %.1f, %" PRIu64 " |", ms, set);
    }
    printf("\n");
}

/* What refinement is measured against: the surface and the flood of the whole fine lattice. */
static double uniform_ms(bvx_context *ctx, const model *m, const bvx_lattice *lattice)
{
    uint64_t set;
    return solid_ms(ctx, m, lattice, BVX_FILL_FLOOD, &set);
}

static double refine_ms(bvx_context *ctx, const model *m, int32_t base, int32_t levels, uint64_t *leaves, bvx_lattice *fine)
{
    static bench_times t;
    t.count = 0;
    for (int i = 0; i < runs; i++) {
        bvx_refine_options o;
        bvx_lattice coarse;
        bvx_octree *tree = NULL;
        double const start = bench_clock(1);
        bvx_refine_options_init(&o, sizeof o);
        o.levels = levels;
        bench_try(ctx, bvx_lattice_fit(ctx, &m->view, base, &coarse), m->name);
        bench_try(ctx, bvx_refine(ctx, &m->view, &coarse, &o, &tree), m->name);
        bench_add(&t, bench_clock(1) - start);
        bench_try(ctx, bvx_octree_leaves(ctx, tree, BVX_STATE_OUTSIDE | BVX_STATE_INSIDE | BVX_STATE_SURFACE, NULL, 0, leaves), m->name);
        bench_try(ctx, bvx_octree_lattice(ctx, tree, levels, fine), m->name);
        bvx_octree_free(ctx, tree);
    }
    return bench_min(&t);
}

static void show_refinement(bvx_context *ctx, const model *m)
{
    static const int32_t pairs[][2] = {{256, 1}, {128, 2}, {64, 3}, {32, 4}, {16, 5}, {8, 6}, {4, 7}, {2, 8}};
    double uniform = 0.0, kept = 0.0;
    printf("| %s |", m->name);
    for (size_t i = 0; i < sizeof pairs / sizeof *pairs; i++) {
        bvx_lattice fine;
        uint64_t leaves = 0;
        double const ms = refine_ms(ctx, m, pairs[i][0], pairs[i][1], &leaves, &fine);
        if (pairs[i][0] == 8) {
            uniform = uniform_ms(ctx, m, &fine);
            kept = 100.0 * (1.0 - (double)leaves / ((double)fine.dims[0] * fine.dims[1] * fine.dims[2]));
            printf(" **%.0f** (%.2f of the uniform) |", ms, ms / uniform);
        } else printf(" %.0f |", ms);
        fflush(stdout);
    }
    printf(" %.0f | %.1f %% |\n", uniform, kept);
}

int main(int argc, char **argv)
{
    static const char *const names[] = {"dragon_vrip_871414.ply.gz", "bunny_scan_69451.ply.gz", "unit_sphere.stl.gz", "fandisk.obj.gz",
                                        "dungeon.obj.gz"};
    enum { MODELS = sizeof names / sizeof *names };
    static model models[MODELS];
    static bench_memory memory;
    bvx_context *ctx;
    if (argc < 2) {
        fprintf(stderr, "usage: bench_voxels MESH_FOLDER [RUNS]\n");
        return 2;
    }
    if (argc > 2) runs = atoi(argv[2]) > 0 ? atoi(argv[2]) : runs;
    ctx = bench_context(1, BVX_CPU_BEST, &memory);
    printf("| mesh | resolution | solid ms | conservative ms, times solid | voxels | thin ms | voxels | sampled ms | voxels | mean coefficient |\n"
           "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < MODELS; i++)
        if (open_model(ctx, argv[1], names[i], &models[i])) show_surfaces(ctx, &models[i]);
    printf("\n| fills at 256: ms, voxels | parity | nonzero | vote | regions | flood |\n|---|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < MODELS; i++)
        if (models[i].name != NULL) show_fills(ctx, &models[i]);
    printf("\n| refined to 512: ms by base | 256 | 128 | 64 | 32 | 16 | 8 | 4 | 2 | uniform surface and flood | fewer voxels |\n"
           "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < 3; i++)
        if (models[i].name != NULL) show_refinement(ctx, &models[i]);
    for (int i = 0; i < MODELS; i++) bvx_mesh_free(ctx, &models[i].mesh);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}
