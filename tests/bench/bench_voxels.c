/* bench_voxels.c - surfaces of voxels and fills, beside a loop over voxels and the TIN paper's tables.
 *
 *   bench_voxels MESH_FOLDER OUT [RUNS]   prints Markdown; writes OUT/voxels.jsonl: targets
 *   bench_voxels turns MESH_FOLDER OUT    writes the dragon's arrays to OUT, then does one conservative
 *                                         surface for each line "RESOLUTION" of standard input and answers
 *                                         with milliseconds, lattice and voxels
 *
 * One thread, processor time, warm memory; the contenders of a row take turns in every run, the least of the
 * runs is compared and the median stands in brackets. */
#include "bench_models.h"
#include "box_triangle_loop.h"
#include "paper_refine.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

static const char dragon_file[] = "dragon_vrip_871414.ply.gz";
static int runs = 9;

typedef enum job_kind { SOLID, SURFACE, ATTACHED, LOOP, OCTREE } job_kind;

typedef struct job {
    job_kind kind;
    int32_t rule; /* SOLID: BVX_FILL_...; SURFACE: BVX_SURFACE_...; OCTREE: levels below one voxel */
    int most;     /* slow ones run at most so often; 0: as the others */
    bench_times times;
    uint64_t set; /* UINT64_MAX: a flood that leaked */
    bvx_surface_report report;
} job;

/* What all jobs of a row work on. */
typedef struct stage {
    bvx_context *ctx;
    bench_memory *memory;
    const bench_model *model;
    bvx_lattice lattice;
    bvx_grid loop; /* room for LOOP */
} stage;

static double run_solid(const stage *s, job *j)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_grid grid = {0};
    double const start = bench_clock(1);

    o.fill = j->rule;
    bvx_status const status = bvx_voxelize_solid(s->ctx, &s->model->view, &s->lattice, &o, &grid);
    double const ms = bench_clock(1) - start;
    j->set = UINT64_MAX;
    if (status == BVX_ERR_EMPTY) return ms; /* a flood that finds nothing, after all its work */
    bench_try(s->ctx, status, s->model->name);
    bench_try(s->ctx, bvx_grid_count(s->ctx, &grid, &j->set), s->model->name);
    bvx_grid_free(s->ctx, &grid);
    return ms;
}

static double run_surface(const stage *s, job *j)
{
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_attached attached = {0};
    bvx_grid grid = {0};
    double const start = bench_clock(1);

    o.mode = j->rule;
    o.report = &j->report;
    if (j->kind == ATTACHED) o.attached = &attached;
    bench_try(s->ctx, bvx_voxelize_surface(s->ctx, &s->model->view, &s->lattice, &o, &grid), s->model->name);
    double const ms = bench_clock(1) - start;
    bench_try(s->ctx, bvx_grid_count(s->ctx, &grid, &j->set), s->model->name);
    bvx_grid_free(s->ctx, &grid);
    bvx_attached_free(s->ctx, &attached);
    return ms;
}

static double run_loop(stage *s, job *j)
{
    const bench_model *const m = s->model;
    if (s->loop.words == NULL)
        bench_try(s->ctx, bvx_grid_create(s->ctx, &s->lattice, NULL, &s->loop), m->name);
    double const start = bench_clock(1);
    box_triangle_loop(m->points, m->triangles, m->triangle_count, &s->loop);
    double const ms = bench_clock(1) - start;
    bench_try(s->ctx, bvx_grid_count(s->ctx, &s->loop, &j->set), m->name);
    return ms;
}

static double run_octree(const stage *s, job *j)
{
    const bench_model *const m = s->model;
    bvx_lattice one;
    paper_counts counts;

    bench_try(s->ctx, bvx_lattice_fit(s->ctx, &m->view, 1, &one), m->name);
    double const start = bench_clock(1);
    paper_tree *const tree = paper_refine(s->memory, m->points, m->point_count, m->triangles,
                                          m->triangle_count, &one, j->rule, 0);
    double const ms = bench_clock(1) - start;
    paper_tree_count(tree, &counts);
    j->set = counts.surface;
    paper_tree_free(tree);
    return ms;
}

static void run_job(stage *s, job *j)
{
    double ms = 0.0;

    switch (j->kind) {
    case SOLID: ms = run_solid(s, j); break;
    case SURFACE:
    case ATTACHED: ms = run_surface(s, j); break;
    case LOOP: ms = run_loop(s, j); break;
    case OCTREE: ms = run_octree(s, j); break;
    }
    bench_add(&j->times, ms);
}

/* Once to warm memory, then in turns. */
static void run_jobs(stage *s, job *jobs, int count)
{
    for (int i = 0; i < count; i++) {
        run_job(s, &jobs[i]);
        jobs[i].times.count = 0;
    }
    for (int run = 0; run < runs; run++)
        for (int i = 0; i < count; i++)
            if (jobs[i].most == 0 || run < jobs[i].most) run_job(s, &jobs[i]);
}

static void open_stage(stage *s, bvx_context *ctx, bench_memory *memory, const bench_model *m,
                       int32_t resolution)
{
    memset(s, 0, sizeof *s);
    s->ctx = ctx;
    s->memory = memory;
    s->model = m;
    bench_try(ctx, bvx_lattice_fit(ctx, &m->view, resolution, &s->lattice), m->name);
}

static void print_ms(const job *j)
{
    printf(" %.1f (%.1f) |", bench_min(&j->times), bench_median(&j->times));
}

/* ---- the exact surface beside our solid and the loop ---- */

static uint64_t voxels_that_differ(stage *s)
{
    bvx_grid grid = {0};
    uint64_t const words = bvx_grid_bound(&s->lattice, NULL);
    uint64_t count = 0;

    bench_try(s->ctx, bvx_voxelize_surface(s->ctx, &s->model->view, &s->lattice, NULL, &grid),
              s->model->name);
    for (uint64_t i = 0; i < words; i++)
        for (uint64_t w = grid.words[i] ^ s->loop.words[i]; w != 0; w &= w - 1) count++;
    bvx_grid_free(s->ctx, &grid);
    return count;
}

static void show_conservative(bvx_context *ctx, bench_memory *memory, const bench_model *m,
                              int32_t resolution, FILE *targets)
{
    static job jobs[5];
    stage s;

    memset(jobs, 0, sizeof jobs);
    jobs[0].kind = SOLID;
    jobs[1].kind = SURFACE;
    jobs[2].kind = ATTACHED;
    jobs[3].kind = SURFACE;
    jobs[3].rule = BVX_SURFACE_THIN;
    jobs[4].kind = LOOP;
    jobs[4].most = 3;
    open_stage(&s, ctx, memory, m, resolution);
    run_jobs(&s, jobs, 5);
    double const solid = bench_min(&jobs[0].times);
    double const surface = bench_min(&jobs[1].times);
    double const loop = bench_min(&jobs[4].times);
    printf("| %s | %" PRIu64 " | %" PRId32 " |", m->name, m->triangle_count, resolution);
    print_ms(&jobs[0]);
    print_ms(&jobs[1]);
    printf(" %.2f | %" PRIu64 " |", surface / solid, jobs[1].set);
    print_ms(&jobs[2]);
    print_ms(&jobs[3]);
    printf(" %" PRIu64 " |", jobs[3].set);
    print_ms(&jobs[4]);
    printf(" %.1f | %" PRIu64 " |\n", loop / surface, voxels_that_differ(&s));
    fflush(stdout);
    if (resolution == 512 && strcmp(m->name, "dragon") == 0)
        bench_say_target(targets, "conservative at 512 on the dragon : our solid", surface / solid, "times",
                         2.5, 1);
    bvx_grid_free(ctx, &s.loop);
}

/* ---- the TIN paper ---- */

static void show_sampled(bvx_context *ctx, bench_memory *memory, const bench_model *m)
{
    static const int32_t resolutions[] = {128, 256, 512};
    double least[3] = {0.0, 0.0, 0.0};

    printf("| %s | %" PRIu64 " |", m->name, m->triangle_count);
    for (int r = 0; r < 3; r++) {
        static job jobs[1];
        stage s;
        memset(jobs, 0, sizeof jobs);
        jobs[0].kind = SURFACE;
        jobs[0].rule = BVX_SURFACE_SAMPLED;
        open_stage(&s, ctx, memory, m, resolutions[r]);
        run_jobs(&s, jobs, 1);
        const bvx_surface_report *const p = &jobs[0].report;
        least[r] = bench_min(&jobs[0].times);
        printf(" %.2f | %.2f | %.1f | %.1f |",
               p->triangles != 0 ? (double)p->parts / (double)p->triangles : 0.0, least[r],
               (double)jobs[0].set * 1e-3, (double)p->samples / (double)jobs[0].set);
    }
    printf(" %.1f |\n", least[2] / least[0]);
    fflush(stdout);
}

static void show_octree(bvx_context *ctx, bench_memory *memory, const bench_model *m)
{
    static const int32_t resolutions[] = {128, 256};

    printf("| %s | %" PRIu64 " |", m->name, m->triangle_count);
    for (int r = 0; r < 2; r++) {
        static job jobs[3];
        stage s;
        memset(jobs, 0, sizeof jobs);
        jobs[0].kind = OCTREE;
        jobs[0].rule = 7 + r;
        jobs[1].kind = SURFACE;
        jobs[1].rule = BVX_SURFACE_SAMPLED;
        jobs[2].kind = SURFACE;
        open_stage(&s, ctx, memory, m, resolutions[r]);
        run_jobs(&s, jobs, 3);
        for (int i = 0; i < 3; i++)
            printf(" %.2f | %.1f |", bench_min(&jobs[i].times), (double)jobs[i].set * 1e-3);
        printf(" %.0f |", bench_min(&jobs[0].times) / bench_min(&jobs[1].times));
    }
    printf("\n");
    fflush(stdout);
}

static void show_seed(bvx_context *ctx, const bench_model *m)
{
    bvx_lattice lattice;
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_grid surface = {0};
    bvx_seed seed;

    bench_try(ctx, bvx_lattice_fit(ctx, &m->view, 256, &lattice), m->name);
    o.mode = BVX_SURFACE_SAMPLED;
    bench_try(ctx, bvx_voxelize_surface(ctx, &m->view, &lattice, &o, &surface), m->name);
    bench_try(ctx, bvx_find_seed(ctx, &surface, NULL, 0, &seed), m->name);
    printf("| %s | %" PRIu64 " | %" PRIu64 " | %" PRIu64 " |", m->name, seed.scans[0], seed.scans[1],
           seed.scans[2]);
    bench_try(ctx, bvx_find_seed(ctx, &surface, &m->view, 0, &seed), m->name);
    printf(" %s, %" PRIu64 " %" PRIu64 " %" PRIu64 " |\n", seed.found ? "yes" : "no", seed.scans[0],
           seed.scans[1], seed.scans[2]);
    bvx_grid_free(ctx, &surface);
}

/* ---- fills ---- */

static void show_fills(bvx_context *ctx, bench_memory *memory, const bench_model *m)
{
    static const int32_t rules[5] = {BVX_FILL_PARITY, BVX_FILL_NONZERO, BVX_FILL_VOTE, BVX_FILL_REGIONS,
                                     BVX_FILL_FLOOD};
    static job jobs[5];
    stage s;

    memset(jobs, 0, sizeof jobs);
    for (int i = 0; i < 5; i++) {
        jobs[i].kind = SOLID;
        jobs[i].rule = rules[i];
    }
    open_stage(&s, ctx, memory, m, 256);
    run_jobs(&s, jobs, 5);
    printf("| %s |", m->name);
    for (int i = 0; i < 5; i++) {
        printf(" %.1f |", bench_min(&jobs[i].times));
        if (jobs[i].set == UINT64_MAX) printf(" leaks |");
        else printf(" %" PRIu64 " |", jobs[i].set);
    }
    printf("\n");
    fflush(stdout);
}

/* ---- turns ---- */

static void write_array(const char *folder, const char *name, const void *bytes, size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *const file = bench_open(path);
    if (fwrite(bytes, 1, size, file) != size || fclose(file) != 0) {
        fprintf(stderr, "bench_voxels: cannot write %s\n", path);
        exit(1);
    }
}

static int take_turns(const char *meshes, const char *out)
{
    static bench_memory memory;
    static job surface;
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, &memory);
    bench_model m;
    stage s;
    int resolution;

    if (!bench_model_open(ctx, meshes, dragon_file, "dragon", &m)) return 1;
    write_array(out, "voxels.points", m.points, (size_t)m.point_count * 3 * sizeof *m.points);
    write_array(out, "voxels.triangles", m.triangles, (size_t)m.triangle_count * 3 * sizeof *m.triangles);
    surface.kind = SURFACE;
    printf("ready\n");
    fflush(stdout);
    while (scanf("%d", &resolution) == 1) {
        open_stage(&s, ctx, &memory, &m, resolution);
        printf("%.6f %" PRIu64 " %.17g %.17g %.17g %.17g %d %d %d\n", run_surface(&s, &surface), surface.set,
               s.lattice.spacing[0], s.lattice.origin[0], s.lattice.origin[1], s.lattice.origin[2],
               s.lattice.dims[0], s.lattice.dims[1], s.lattice.dims[2]);
        fflush(stdout);
    }
    bench_model_free(ctx, &m);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}

/* ---- all tables ---- */

enum { MOST_MODELS = 16 };

static bench_model models[MOST_MODELS];
static int model_count;

/* A model that is not there is said to be missing and left out. */
static void add_model(bvx_context *ctx, const char *folder, const char *file, const char *name)
{
    if (bench_model_open(ctx, folder, file, name, &models[model_count])) model_count++;
    else printf("Missing: %s\n\n", file);
}

static void add_ball(int halvings, const char *name)
{
    bench_model_ball(halvings, name, &models[model_count++]);
}

static void close_models(bvx_context *ctx)
{
    while (model_count > 0) bench_model_free(ctx, &models[--model_count]);
}

static void show_exact_surfaces(bvx_context *ctx, bench_memory *memory, const char *folder, FILE *targets)
{
    add_model(ctx, folder, dragon_file, "dragon");
    add_model(ctx, folder, "bunny_scan_69451.ply.gz", "bunny");
    add_ball(4, "ball");
    add_model(ctx, folder, "fandisk.obj.gz", "fandisk");
    printf(
        "Exact surfaces: least ms (median). The loop tests separating axes for each voxel of each triangle's box, in doubles.\n\n"
        "| mesh | triangles | resolution | our solid | conservative | times solid | voxels | with triangles | thin | voxels | loop "
        "| times ours | differs in |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < model_count; i++) {
        show_conservative(ctx, memory, &models[i], 256, targets);
        show_conservative(ctx, memory, &models[i], 512, targets);
    }
    printf(
        "\nFills at 256: least ms, voxels.\n\n"
        "| mesh | parity | | nonzero | | vote | | regions | | flood | |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < model_count; i++) show_fills(ctx, memory, &models[i]);
    close_models(ctx);
    add_model(ctx, folder, "dungeon.obj.gz", "dungeon");
    for (int i = 0; i < model_count; i++) show_fills(ctx, memory, &models[i]);
    close_models(ctx);
}

static void show_tin_tables(bvx_context *ctx, bench_memory *memory, const char *folder)
{
    add_ball(0, "ball of few");
    add_ball(2, "ball of some");
    add_ball(7, "ball of many");
    add_model(ctx, folder, "two-boxes-bad-self-union.ply", "two boxes");
    add_model(ctx, folder, "thingi_72214.stl.gz", "thingi 72214");
    add_model(ctx, folder, "cow.obj.gz", "cow");
    add_model(ctx, folder, "terrain_turbineSiting.stl.gz", "terrain");
    add_model(ctx, folder, "nefertiti_100k.obj.gz", "nefertiti");
    add_model(ctx, folder, dragon_file, "dragon");
    printf(
        "\nThe TIN paper's Table 1 (`sampled`): k is the mean subdivision coefficient, voxels in thousands, points for each voxel.\n\n"
        "| mesh | triangles | k 128 | ms | voxels | points | k 256 | ms | voxels | points | k 512 | ms | voxels | points "
        "| ms 512 : 128 |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < model_count; i++) show_sampled(ctx, memory, &models[i]);

    /* the paper's own, on a PC of 2 GHz; it counts no points */
    printf(
        "| paper: Robot 1 | 564 | 41 | 165 | 565.6 | | 68 | 637 | 1516.3 | | 136 | 2004 | 5908.6 | | 12.1 |\n"
        "| paper: Robot 2 | 712 | 10 | 206 | 54.1 | | 19 | 261 | 186.1 | | 39 | 472 | 687.7 | | 2.3 |\n"
        "| paper: Surface 1 | 5511 | 4 | 79 | 100.4 | | 7 | 156 | 307.3 | | 14 | 625 | 1056.8 | | 7.9 |\n"
        "| paper: Surface 2 | 24141 | 2 | 187 | 147.8 | | 3 | 284 | 360.6 | | 7 | 859 | 1055.0 | | 4.6 |\n");
    printf(
        "\nTable 2: lines scanned along x, y, z for a seed in the sampled surface at 256; and until one is verified as inside.\n\n"
        "| mesh | i | j | k | verified |\n|---|--:|--:|--:|--:|\n");
    for (int i = 0; i < model_count; i++)
        if (strcmp(models[i].name, "terrain") != 0) show_seed(ctx, &models[i]);
    printf("| paper: Robot 1, Robot 2, Machine, Cow | 1, 2, 2, 1 | 1, 2, 2, 1 | 1, 1, 2, 1 | |\n");
    close_models(ctx);
    add_ball(3, "ball");
    add_model(ctx, folder, "thingi_72214.stl.gz", "thingi 72214");
    add_model(ctx, folder, "blobby-shuffled.off.gz", "blobby");
    add_model(ctx, folder, "elephant-with-holes.off.gz", "elephant");
    printf(
        "\nTable 3: ms and voxels in thousands of an octree that is split down to single voxels by separating axes (the paper took the\n"
        "times of such a method by Wu, Liu, Wang 2005 on models of 1,196 to 4,748 triangles: 3 to 14 s at 128, 12 to 57 s at 256,\n"
        "against its own 0.08 s and 0.16 s for 5,511), of sampling, and of the exact surface; and octree : sampling.\n\n"
        "| mesh | triangles | octree 128 | voxels | sampled | voxels | conservative | voxels | ratio | octree 256 | voxels | sampled "
        "| voxels | conservative | voxels | ratio |\n|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n");
    for (int i = 0; i < model_count; i++) show_octree(ctx, memory, &models[i]);
    close_models(ctx);
}

int main(int argc, char **argv)
{
    static bench_memory memory;
    char path[1024];

    if (argc == 4 && strcmp(argv[1], "turns") == 0) return take_turns(argv[2], argv[3]);
    if (argc < 3) {
        fprintf(stderr, "usage: bench_voxels MESH_FOLDER OUT [RUNS], bench_voxels turns MESH_FOLDER OUT\n");
        return 2;
    }
    if (argc > 3 && atoi(argv[3]) > 0)
        runs = atoi(argv[3]) < BENCH_MOST_RUNS ? atoi(argv[3]) : BENCH_MOST_RUNS;
    snprintf(path, sizeof path, "%s/voxels.jsonl", argv[2]);
    FILE *const targets = bench_open(path);
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, &memory);
    show_exact_surfaces(ctx, &memory, argv[1], targets);
    show_tin_tables(ctx, &memory, argv[1]);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    fclose(targets);
    return 0;
}
