/* bench_refine.c - refinement beside the paper's own route and beside uniform grids, with the paper's tables.
 *
 *   bench_refine MESH_FOLDER OUT [RUNS]   prints Markdown; writes OUT/refine.jsonl: targets
 *
 * One thread, processor time, warm memory, from the mesh's arrays to the tree or grid. The contenders of a
 * row take turns in every run, the least of the runs is compared and the median stands in brackets.
 * Balls are generated; the bunny's holes are closed by fans, because a flood from outside would empty it.
 * What bvx_refine makes equals surface and flood of the uniform grid bit for bit; so that pair is the uniform
 * route: the conservative surface on a lattice with one more voxel on each side, and the flood from its
 * corner. */
#include "bench_models.h"
#include "paper_refine.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { FINEST = 512, ALL_STATES = BVX_STATE_OUTSIDE | BVX_STATE_INSIDE | BVX_STATE_SURFACE };
static int runs = 5;

typedef enum job_kind { REFINE, PAPER, SOLID, SURFACE, SURFACE_AND_FLOOD, FLOOD_AND_VOTES } job_kind;

typedef struct job {
    job_kind kind;
    int32_t resolution, levels; /* of the base, and below it; uniform ones: of the grid */
    int most;                   /* slow ones run at most so often; 0: as the others */
    bench_times times;
    uint64_t peak;            /* bytes of the library's, beside the input */
    uint64_t surface, inside; /* leaves; uniform ones: their sum in surface */
    uint64_t outside;
    uint64_t base_surface, base_inside, base_outside; /* REFINE: voxels of level 0: split ones, leaves */
    /* REFINE: surface and inside in voxels of the last level */
    uint64_t solid;
} job;

typedef struct stage {
    bench_memory memory;
    bvx_context *ctx;
    const bench_model *model;
} stage;

/* ---- one run ---- */

static void count_tree(const stage *s, const bvx_octree *tree, job *j)
{
    bvx_octree_level counts[26];
    int32_t const last = bvx_octree_levels(tree);

    bench_try(s->ctx, bvx_octree_count(s->ctx, tree, counts, 26), "counts");
    j->surface = j->inside = j->outside = j->solid = 0;
    for (int32_t l = 0; l <= last; l++) {
        j->surface += counts[l].surface;
        j->inside += counts[l].inside;
        j->outside += counts[l].outside;
        j->solid += counts[l].surface + (counts[l].inside << 3 * (last - l));
    }
    j->base_surface = counts[0].split + counts[0].surface;
    j->base_inside = counts[0].inside;
    j->base_outside = counts[0].outside;
}

static double run_refine(stage *s, job *j)
{
    const bench_model *const m = s->model;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL;
    double const start = bench_clock(1);

    o.levels = j->levels != 0 ? j->levels : BVX_NONE;
    bench_try(s->ctx, bvx_lattice_fit(s->ctx, &m->view, j->resolution, &base), m->name);
    bench_try(s->ctx, bvx_refine(s->ctx, &m->view, &base, &o, &tree), m->name);
    double const ms = bench_clock(1) - start;
    count_tree(s, tree, j);
    bvx_octree_free(s->ctx, tree);
    return ms;
}

static double run_paper(stage *s, job *j)
{
    const bench_model *const m = s->model;
    bvx_lattice base;
    paper_counts counts;

    bench_try(s->ctx, bvx_lattice_fit(s->ctx, &m->view, j->resolution, &base), m->name);
    double const start = bench_clock(1);
    paper_tree *const tree = paper_refine(&s->memory, m->points, m->point_count, m->triangles,
                                          m->triangle_count, &base, j->levels, 1);
    double const ms = bench_clock(1) - start;
    paper_tree_count(tree, &counts);
    j->surface = counts.surface;
    j->inside = counts.inside;
    j->outside = counts.outside;
    j->peak = counts.bytes;
    paper_tree_free(tree);
    return ms;
}

static double run_surface_and_flood(stage *s, job *j)
{
    static const int32_t corner[3] = {0, 0, 0};
    const bench_model *const m = s->model;
    bvx_lattice_options o = {.struct_size = sizeof o};
    bvx_lattice lattice;
    bvx_grid surface = {0}, outside = {0};
    uint64_t count = 0;
    double const start = bench_clock(1);

    o.resolution = j->resolution;
    o.padding = 1;
    bench_try(s->ctx, bvx_lattice_fit_with(s->ctx, &m->view, &o, &lattice), m->name);
    bench_try(s->ctx, bvx_voxelize_surface(s->ctx, &m->view, &lattice, NULL, &surface), m->name);
    bench_try(s->ctx, bvx_grid_fill(s->ctx, &surface, corner, 1, 6, &outside), m->name);
    double const ms = bench_clock(1) - start;
    bench_try(s->ctx, bvx_grid_count(s->ctx, &outside, &count), m->name);
    j->surface = (uint64_t)lattice.dims[0] * (uint64_t)lattice.dims[1] * (uint64_t)lattice.dims[2] - count;
    bvx_grid_free(s->ctx, &outside);
    bvx_grid_free(s->ctx, &surface);
    return ms;
}

static double run_grid(stage *s, job *j)
{
    const bench_model *const m = s->model;
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_lattice lattice;
    bvx_grid grid = {0};
    double const start = bench_clock(1);

    if (j->kind == FLOOD_AND_VOTES) o.fill = BVX_FILL_FLOOD;
    bench_try(s->ctx, bvx_lattice_fit(s->ctx, &m->view, j->resolution, &lattice), m->name);
    if (j->kind == SURFACE)
        bench_try(s->ctx, bvx_voxelize_surface(s->ctx, &m->view, &lattice, NULL, &grid), m->name);
    else bench_try(s->ctx, bvx_voxelize_solid(s->ctx, &m->view, &lattice, &o, &grid), m->name);
    double const ms = bench_clock(1) - start;
    bench_try(s->ctx, bvx_grid_count(s->ctx, &grid, &j->surface), m->name);
    bvx_grid_free(s->ctx, &grid);
    return ms;
}

static void run_job(stage *s, job *j)
{
    uint64_t const before = bvx_memory_used(s->ctx);
    double ms = 0.0;

    bvx_memory_reset_peak(s->ctx);
    switch (j->kind) {
    case REFINE: ms = run_refine(s, j); break;
    case PAPER: ms = run_paper(s, j); break;
    case SURFACE_AND_FLOOD: ms = run_surface_and_flood(s, j); break;
    case SOLID:
    case SURFACE:
    case FLOOD_AND_VOTES: ms = run_grid(s, j); break;
    }
    if (j->kind != PAPER) j->peak = bvx_memory_peak(s->ctx) - before;
    bench_add(&j->times, ms);
}

/* Once to warm memory, then in turns, on memory of their own. */
static void run_jobs(const bench_model *m, job *jobs, int count, int rounds)
{
    static stage s;

    memset(&s, 0, sizeof s);
    s.model = m;
    s.ctx = bench_context(1, BVX_CPU_BEST, &s.memory);
    for (int i = 0; i < count; i++) {
        run_job(&s, &jobs[i]);
        jobs[i].times.count = 0;
    }
    for (int run = 0; run < rounds; run++)
        for (int i = 0; i < count; i++)
            if (jobs[i].most == 0 || run < jobs[i].most) run_job(&s, &jobs[i]);
    bvx_context_destroy(s.ctx);
    bench_memory_release(&s.memory);
}

static void set_job(job *j, job_kind kind, int32_t resolution, int32_t levels, int most)
{
    memset(j, 0, sizeof *j);
    j->kind = kind;
    j->resolution = resolution;
    j->levels = levels;
    j->most = most;
}

static void print_ms(const job *j)
{
    printf(" %.1f (%.1f) |", bench_min(&j->times), bench_median(&j->times));
}

static double mib(uint64_t bytes)
{
    return (double)bytes / 1048576.0;
}

static uint64_t apart(uint64_t a, uint64_t b)
{
    return a > b ? a - b : b - a;
}

/* ---- 8 x 8 x 8 by six levels ---- */

static void show_main(const bench_model *m, FILE *targets)
{
    static job j[6];
    char title[160];

    set_job(&j[0], REFINE, 8, 6, 0);
    set_job(&j[1], PAPER, 8, 6, 3);
    set_job(&j[2], SOLID, FINEST, 0, 0);
    set_job(&j[3], SURFACE, FINEST, 0, 0);
    set_job(&j[4], SURFACE_AND_FLOOD, FINEST, 0, 0);
    set_job(&j[5], FLOOD_AND_VOTES, FINEST, 0, 0);
    run_jobs(m, j, 6, runs);
    double const ours = bench_min(&j[0].times);
    printf("| %s | %" PRIu64 " |", m->name, m->triangle_count);
    print_ms(&j[0]);
    printf(" %.0f |", mib(j[0].peak));
    print_ms(&j[1]);
    printf(" %.0f | %.1f | %" PRIu64 " |", mib(j[1].peak), bench_min(&j[1].times) / ours,
           apart(j[0].surface, j[1].surface) + apart(j[0].inside, j[1].inside) +
               apart(j[0].outside, j[1].outside));
    for (int i = 2; i < 6; i++) {
        print_ms(&j[i]);
        printf(" %.2f |", ours / bench_min(&j[i].times));
    }
    printf(" %" PRIu64 " |\n", apart(j[0].solid, j[4].surface));
    fflush(stdout);
    snprintf(title, sizeof title, "refine 8 by 6, %s: the paper's route : ours", m->name);
    bench_say_target(targets, title, bench_min(&j[1].times) / ours, "times", 20.0, 0);
    snprintf(title, sizeof title, "refine 8 by 6, %s: ours : uniform surface and flood at 512", m->name);
    bench_say_target(targets, title, ours / bench_min(&j[4].times), "times", 3.0, 1);
}

/* ---- where refinement passes the uniform grid ---- */

static void show_crossing(const bench_model *m, FILE *targets)
{
    char title[160];

    for (int32_t n = 64, levels = 3; n <= 4096; n *= 2, levels++) {
        static job j[3];
        int const uniform = n <= 2048; /* beyond it grids take more memory than most machines have */
        set_job(&j[0], REFINE, 8, levels, 0);
        set_job(&j[1], SURFACE_AND_FLOOD, n, 0, 0);
        set_job(&j[2], SOLID, n, 0, 0);
        run_jobs(m, j, uniform ? 3 : 1, n <= 512 ? runs : n == 1024 ? 3 : 2);
        printf("| %s | %" PRId32 " |", m->name, n);
        print_ms(&j[0]);
        printf(" %.0f |", mib(j[0].peak));
        for (int i = 1; i < 3; i++) {
            if (!uniform) {
                printf(" | | |");
                continue;
            }
            print_ms(&j[i]);
            printf(" %.0f | %.2f |", mib(j[i].peak), bench_min(&j[i].times) / bench_min(&j[0].times));
        }
        printf("\n");
        fflush(stdout);
        if (n != 2048) continue;
        snprintf(title, sizeof title, "refine 8 by 8, %s: uniform surface and flood at 2048 : ours", m->name);
        bench_say_target(targets, title, bench_min(&j[1].times) / bench_min(&j[0].times), "times", 1.0, 0);
    }
}

/* ---- the paper's Tables 2 and 3 ---- */

enum { PAIRS = 10 };

static job pairs[3][PAIRS]; /* model; levels */

static void show_pairs(const bench_model *m, job *ours)
{
    for (int32_t levels = 0; levels < PAIRS; levels++) {
        job j[2];
        int const theirs = levels >= 2; /* nodes of a base of 256 and more would fill the memory */
        set_job(&j[0], REFINE, FINEST >> levels, levels, 0);
        set_job(&j[1], PAPER, FINEST >> levels, levels, 1);
        run_jobs(m, j, theirs ? 2 : 1, runs);
        ours[levels] = j[0];
        printf("| %s | %" PRId32 " | %" PRId32 " |", m->name, FINEST >> levels, levels);
        print_ms(&j[0]);
        printf(" %" PRIu64 " | %" PRIu64 " | %" PRIu64 " |", j[0].surface + j[0].inside, j[0].inside,
               j[0].outside);
        if (theirs)
            printf(" %.0f | %" PRIu64 " |", bench_min(&j[1].times),
                   apart(j[0].surface + j[0].inside, j[1].surface + j[1].inside));
        else printf(" | |");
        printf("\n");
        fflush(stdout);
    }
}

/* How many fewer, in percent. */
static double saved(double with, double without)
{
    return without > 0.0 ? 100.0 * (1.0 - with / without) : 0.0;
}

/* One split: each voxel of the base that triangles touch becomes N x N x N.
 * kept: those outside are deleted, as in the tree (what the base's voxels
 * hold of the solid is the solid less its whole inside voxels); all: none is. */
static void show_one_split(const bench_model *const *models, int count, FILE *targets)
{
    double sum_kept = 0.0, sum_all = 0.0;
    int summed = 0, same = 0;

    for (int i = 0; i < count; i++) {
        for (int levels = 1; levels <= 7; levels++) {
            const job *const j = &pairs[i][levels];
            double const cubes = ldexp(1.0, 3 * levels);
            double const inside = (double)j->base_inside;
            double const one_kept = (double)j->solid - inside * cubes + inside;
            double const one_all = (double)j->base_surface * cubes + inside;
            double const tree_kept = (double)(j->surface + j->inside);
            double const tree_all = tree_kept + (double)(j->outside - j->base_outside);
            printf("| %s | %d to %d, N = %d | %.0f | %.0f | %.1f | %.0f | %.0f | %.1f |\n", models[i]->name,
                   FINEST >> levels, FINEST, 1 << levels, tree_kept, one_kept, saved(tree_kept, one_kept),
                   tree_all, one_all, saved(tree_all, one_all));
            if (levels < 2) { /* the same split: nothing is saved */
                same++;
                continue;
            }
            sum_kept += saved(tree_kept, one_kept);
            sum_all += saved(tree_all, one_all);
            summed++;
        }
    }
    if (summed == 0) return;
    printf("| mean of N = 4 to 128 | | | | %.2f | | | %.2f |\n", sum_kept / summed, sum_all / summed);
    printf("| mean of N = 2 to 128 | | | | %.2f | | | %.2f |\n", sum_kept / (summed + same),
           sum_all / (summed + same));
    bench_say_target(targets,
                     "voxels saved against one split, mean of N = 4 to 128, those outside not counted",
                     sum_kept / summed, "%", 71.5, 0);
}

/* ---- large lattices ---- */

static void show_large(const bench_model *m, FILE *targets)
{
    static job j[1];

    set_job(&j[0], REFINE, 8, 9, 0);
    run_jobs(m, j, 1, 3);
    printf("| %s | 4096 from 8 by 9 levels |", m->name);
    print_ms(&j[0]);
    printf(" %.0f | %" PRIu64 " surface, %" PRIu64 " inside |\n", mib(j[0].peak), j[0].surface, j[0].inside);
    fflush(stdout);
    bench_say_target(targets, "refine to 4096, dragon of 100,000 triangles", bench_min(&j[0].times) * 1e-3,
                     "s", 10.0, 1);
    bench_say_target(targets, "its peak", mib(j[0].peak) / 1024.0, "GiB", 2.0, 1);
}

/* A window around a vertex of the mesh. */
static double window_ms(stage *s, uint64_t vertex, uint64_t *peak, uint64_t *surface)
{
    const bench_model *const m = s->model;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL;
    bvx_grid grid = {0};
    uint64_t const before = bvx_memory_used(s->ctx);

    bench_try(s->ctx, bvx_lattice_fit(s->ctx, &m->view, 16, &base), m->name);
    o.levels = 12;
    for (int i = 0; i < 3; i++) {
        double const voxel = (m->points[3 * vertex + (uint64_t)i] - base.origin[i]) / base.spacing[i] *
                             4096.0;
        int32_t const most = (base.dims[i] << 12) - 512;
        o.window.low[i] = voxel > 256.0 ? (int32_t)voxel - 256 : 0;
        if (o.window.low[i] > most) o.window.low[i] = most;
        o.window.size[i] = 512;
    }
    bvx_memory_reset_peak(s->ctx);
    double const start = bench_clock(1);
    bench_try(s->ctx, bvx_refine(s->ctx, &m->view, &base, &o, &tree), m->name);
    double const ms = bench_clock(1) - start;
    *peak = bvx_memory_peak(s->ctx) - before;
    bench_try(s->ctx, bvx_octree_expand(s->ctx, tree, 12, BVX_STATE_SURFACE, &o.window, &grid), m->name);
    bench_try(s->ctx, bvx_grid_count(s->ctx, &grid, surface), m->name);
    bvx_grid_free(s->ctx, &grid);
    bvx_octree_free(s->ctx, tree);
    return ms;
}

static void show_windows(const bench_model *m, FILE *targets)
{
    enum { WINDOWS = 5 };
    static stage s;
    double worst = 0.0;
    memset(&s, 0, sizeof s);
    s.model = m;
    s.ctx = bench_context(1, BVX_CPU_BEST, &s.memory);
    for (uint64_t w = 0; w < WINDOWS; w++) {
        static bench_times times;
        uint64_t const vertex = m->point_count * w / WINDOWS;
        uint64_t peak = 0, surface = 0;
        times.count = 0;
        window_ms(&s, vertex, &peak, &surface);
        for (int run = 0; run < runs; run++) bench_add(&times, window_ms(&s, vertex, &peak, &surface));
        printf("| %s | window of 512 x 512 x 512 in 65536, around vertex %" PRIu64
               " | %.1f (%.1f) | %.0f | %" PRIu64 " surface in it |\n",
               m->name, vertex, bench_min(&times), bench_median(&times), mib(peak), surface);
        if (bench_min(&times) > worst) worst = bench_min(&times);
    }
    bench_say_target(targets, "window of 512 in 65536, the slowest of five", worst, "ms", 100.0, 1);
    bvx_context_destroy(s.ctx);
    bench_memory_release(&s.memory);
}

int main(int argc, char **argv)
{
    static bench_model ball, bunny, dragon, small;
    const bench_model *models[3];
    char path[1024];
    int count = 0;
    if (argc < 3) {
        fprintf(stderr, "usage: bench_refine MESH_FOLDER OUT [RUNS]\n");
        return 2;
    }
    if (argc > 3 && atoi(argv[3]) > 0)
        runs = atoi(argv[3]) < BENCH_MOST_RUNS ? atoi(argv[3]) : BENCH_MOST_RUNS;
    snprintf(path, sizeof path, "%s/refine.jsonl", argv[2]);
    FILE *const targets = bench_open(path);
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    bench_model_ball(4, "ball", &ball);
    models[count++] = &ball;
    if (bench_model_open(ctx, argv[1], "bunny_scan_69451.ply.gz", "bunny", &bunny)) {
        int const holes = bench_model_close(&bunny);
        printf("The bunny's %d holes are closed by fans: %" PRIu64 " triangles.\n\n", holes,
               bunny.triangle_count);
        models[count++] = &bunny;
    }
    if (bench_model_open(ctx, argv[1], "dragon_vrip_871414.ply.gz", "dragon", &dragon))
        models[count++] = &dragon;

    printf(
        "8 x 8 x 8 by six levels, to 512: least ms (median); MiB beside the input; leaves by which the paper's route (doubles) differs;\n"
        "uniform grids at 512 with ours : theirs, and by how many voxels surface and flood (lattice moved by one voxel) differs.\n\n"
        "| mesh | triangles | refine | MiB | the paper's route | MiB | times ours | differs | solid | ours : it | surface | ours : it "
        "| surface and flood | ours : it | rule flood | ours : it | differs |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < count; i++) show_main(models[i], targets);
    printf(
        "\nFrom 8 x 8 x 8 to n, and uniform grids: least ms (median), MiB, uniform : refined.\n\n"
        "| mesh | n | refine | MiB | surface and flood | MiB | ratio | solid alone | MiB | ratio |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < count; i++) show_crossing(models[i], targets);
    printf(
        "\nTable 2: all pairs that end at 512. Voxels: leaves of surface and inside. The paper's route: ms, one run, and by how many\n"
        "voxels it differs.\n\n"
        "| mesh | base | levels | ms (median) | voxels | of them inside | outside | the paper's route | differs |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < count; i++) show_pairs(models[i], pairs[i]);
    printf(
        "\nTable 3: voxels of the tree beside those of one split of each touched voxel of the base into N x N x N, and percent\n"
        "fewer; first without voxels that lie outside, then with those that the splits make.\n\n"
        "| mesh | pair | tree | one split | fewer %% | tree, all | one split, all | fewer %% |\n|---|---|--:|--:|--:|--:|--:|--:|\n");
    show_one_split(models, count, targets);
    if (bench_model_open(ctx, argv[1], "dragon_100k.obj.gz", "dragon 100k", &small)) {
        printf(
            "\nLarge lattices: least ms (median), MiB beside the input.\n\n| mesh | | ms | MiB | voxels |\n|---|---|--:|--:|--:|\n");
        show_large(&small, targets);
        show_windows(&small, targets);
    }
    bench_model_free(ctx, &ball);
    bench_model_free(ctx, &bunny);
    bench_model_free(ctx, &dragon);
    bench_model_free(ctx, &small);
    bvx_context_destroy(ctx);
    fclose(targets);
    return 0;
}
