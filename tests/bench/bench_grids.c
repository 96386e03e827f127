/* bench_grids.c - what is done with grids: set algebra, blocks, rays, booleans of meshes.
 *
 *   bench_grids MESH_FOLDER OUT [RUNS]   prints Markdown; writes OUT/grids.jsonl: targets
 *   bench_grids turns MESH_FOLDER OUT    writes the arrays of the peers' inputs to OUT, then does one job for
 *                                        each line "JOB THREADS" of standard input and answers with
 *                                        milliseconds and what it made
 *
 * From arrays to arrays in warm memory. One thread: processor time; two: time of day. The least of the runs
 * is compared, the median stands in brackets. Grids have 512 x 512 x 512 voxels: the dragon's solid and
 * random ones, one in ten set. */
#include "bench_models.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { GRID_SIDE = 512, GRID_WORDS = GRID_SIDE * GRID_SIDE * (GRID_SIDE / 64) };
static const char dragon_file[] = "dragon_vrip_871414.ply.gz";
static int runs = 9;

/* ---- grids ---- */

static bvx_grid cube_grid(bvx_context *ctx, const bvx_lattice *lattice)
{
    bvx_grid grid = {0};
    bench_try(ctx, bvx_grid_create(ctx, lattice, NULL, &grid), "a grid");
    return grid;
}

/* The dragon in the low corner of a cube. */
static bvx_grid dragon_grid(bvx_context *ctx, const bench_model *m)
{
    bvx_lattice lattice;
    bvx_grid grid = {0};
    bench_try(ctx, bvx_lattice_fit(ctx, &m->view, GRID_SIDE, &lattice), m->name);
    for (int a = 0; a < 3; a++) lattice.dims[a] = GRID_SIDE;
    bench_try(ctx, bvx_voxelize_solid(ctx, &m->view, &lattice, NULL, &grid), m->name);
    return grid;
}

static void scatter_tenth(bvx_grid *grid)
{
    uint64_t x = UINT64_C(88172645463325252);

    for (size_t i = 0; i < GRID_WORDS; i++) {
        uint64_t w = 0;
        for (int k = 0; k < 64; k++) {
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
            w |= (uint64_t)(x % 10 == 0) << k;
        }
        grid->words[i] = w;
    }
}

/* ---- set algebra ---- */

typedef struct algebra_bench {
    const bvx_grid *a, *b;
    bvx_grid result; /* warm words of a whole grid */
    uint32_t *counts;
} algebra_bench;

typedef void algebra_job(bvx_context *ctx, algebra_bench *j);

static void do_copy(bvx_context *ctx, algebra_bench *j)
{
    (void)ctx;
    memcpy(j->result.words, j->a->words, (size_t)GRID_WORDS * 8);
}

static void do_union(bvx_context *ctx, algebra_bench *j)
{
    bench_try(ctx, bvx_grid_combine(ctx, j->a, j->b, BVX_BOOLEAN_UNION, &j->result), "union");
}

static void do_union_in_place(bvx_context *ctx, algebra_bench *j)
{
    bench_try(ctx, bvx_grid_combine(ctx, &j->result, j->b, BVX_BOOLEAN_UNION, &j->result), "union");
}

static void do_complement(bvx_context *ctx, algebra_bench *j)
{
    bench_try(ctx, bvx_grid_complement(ctx, j->a, &j->result), "complement");
}

static void do_coverage(bvx_context *ctx, algebra_bench *j)
{
    static const int32_t factor[3] = {4, 4, 4};
    uint64_t n;
    bench_try(ctx,
              bvx_grid_coverage(ctx, j->a, factor, j->counts, GRID_SIDE * GRID_SIDE * (GRID_SIDE / 64), &n),
              "coverage");
}

static void reduce(bvx_context *ctx, algebra_bench *j, int32_t rule)
{
    static const int32_t factor[3] = {2, 2, 2};
    bvx_grid made = {0};
    bench_try(ctx, bvx_grid_downsample(ctx, j->a, factor, rule, &made), "downsample");
    bvx_grid_free(ctx, &made);
}

static void do_any(bvx_context *ctx, algebra_bench *j)
{
    reduce(ctx, j, BVX_REDUCE_ANY);
}

static void do_majority(bvx_context *ctx, algebra_bench *j)
{
    reduce(ctx, j, BVX_REDUCE_MAJORITY);
}

static void do_turn(bvx_context *ctx, algebra_bench *j)
{
    static const int32_t axes[3] = {1, 0, 2};
    bvx_grid made = {0};
    bench_try(ctx, bvx_grid_permute(ctx, j->a, axes, NULL, &made), "permute");
    bvx_grid_free(ctx, &made);
}

static void do_crop(bvx_context *ctx, algebra_bench *j)
{
    bvx_window const window = {{3, 2, 1}, {500, 500, 500}};
    bvx_grid made = {0};
    bench_try(ctx, bvx_grid_crop(ctx, j->a, &window, &made), "crop");
    bvx_grid_free(ctx, &made);
}

static void do_resample(bvx_context *ctx, algebra_bench *j)
{
    bvx_lattice lattice = j->a->lattice;
    bvx_grid made = {0};
    for (int a = 0; a < 3; a++) lattice.spacing[a] *= 0.9;
    bench_try(ctx, bvx_grid_resample(ctx, j->a, &lattice, NULL, &made), "resample");
    bvx_grid_free(ctx, &made);
}

static double time_algebra(bvx_context *ctx, algebra_bench *j, algebra_job *job, int threads)
{
    static bench_times times;

    times.count = 0;
    for (int run = -1; run < runs; run++) { /* the first warms memory and is not counted */
        double const start = bench_clock(threads);
        job(ctx, j);
        if (run >= 0) bench_add(&times, bench_clock(threads) - start);
    }
    return bench_min(&times);
}

static void show_algebra(const bench_model *dragon, FILE *targets)
{
    static const struct {
        const char *title;
        algebra_job *job;
    } jobs[] = {{"memcpy", do_copy},
                {"union", do_union},
                {"union, in place", do_union_in_place},
                {"complement", do_complement},
                {"coverage by 4", do_coverage},
                {"any by 2", do_any},
                {"majority by 2", do_majority},
                {"x and y changed", do_turn},
                {"crop, 3 voxels off", do_crop},
                {"resample to 0.9", do_resample}};
    static bench_memory memory;
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, &memory);
    bvx_grid solid = dragon_grid(ctx, dragon);
    bvx_grid random = cube_grid(ctx, &solid.lattice);
    bvx_grid result = cube_grid(ctx, &solid.lattice);
    uint32_t *const counts = calloc((size_t)1 << 21, sizeof *counts);
    double copy[2] = {1, 1};
    if (counts == NULL) exit(1);
    scatter_tenth(&random);
    printf(
        "Grids of 512 x 512 x 512 voxels (16 MiB), one thread.\n\n| | the dragon's solid, ms | of memcpy | a random tenth, ms | of memcpy |\n"
        "|---|--:|--:|--:|--:|\n");
    for (size_t i = 0; i < sizeof jobs / sizeof *jobs; i++) {
        double ms[2];
        for (int g = 0; g < 2; g++) {
            algebra_bench j = {g == 0 ? &solid : &random, g == 0 ? &random : &solid, result, counts};
            ms[g] = time_algebra(ctx, &j, jobs[i].job, 1);
            if (i == 0) copy[g] = ms[g];
        }
        printf("| %s | %.2f | %.1f | %.2f | %.1f |\n", jobs[i].title, ms[0], ms[0] / copy[0], ms[1],
               ms[1] / copy[1]);
        if (i == 1)
            bench_say_target(targets, "union of two 16 MiB grids : memcpy of one", ms[1] / copy[1], "times",
                             2, 1);
    }
    fflush(stdout);
    free(counts);
    bvx_grid_free(ctx, &solid);
    bvx_grid_free(ctx, &random);
    bvx_grid_free(ctx, &result);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
}

/* ---- booleans of meshes ---- */

enum { BOOLEAN_RESOLUTION = 256 };
static const char *const boolean_names[] = {"union", "intersection", "difference", "xor"};

/* The dragon once more, a quarter of its length further. */
typedef struct shifted_dragon {
    float *points;
    bvx_mesh_view view;
} shifted_dragon;

static void shift_dragon(const bench_model *m, shifted_dragon *s)
{
    static const double by[3] = {0.0512, 0.0187, 0.0093};

    s->points = malloc((size_t)m->point_count * 3 * sizeof *s->points);
    if (s->points == NULL) exit(1);
    for (uint64_t i = 0; i < 3 * m->point_count; i++) s->points[i] = (float)(m->points[i] + by[i % 3]);
    memset(&s->view, 0, sizeof s->view);
    s->view.positions = s->points;
    s->view.position_type = BVX_F32;
    s->view.vertex_count = m->point_count;
    s->view.indices = m->triangles;
    s->view.index_type = BVX_U32;
    s->view.triangle_count = m->triangle_count;
}

static double run_boolean(bvx_context *ctx, const bench_model *m, const shifted_dragon *s, int32_t operation,
                          int32_t sharp, int threads, bvx_boolean_report *report, bvx_mesh *made)
{
    bvx_boolean_options o = {.struct_size = sizeof o};
    double const start = bench_clock(threads);

    o.fit.resolution = BOOLEAN_RESOLUTION;
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    o.report = report;
    bench_try(ctx, bvx_boolean(ctx, &m->view, &s->view, operation, &o, made), "boolean");
    return bench_clock(threads) - start;
}

static double volume_of(bvx_context *ctx, const bvx_mesh *mesh)
{
    bvx_certificate c;
    bvx_mesh_view view;

    bvx_mesh_view_of(mesh, &view);
    bench_try(ctx, bvx_mesh_check(ctx, &view, 0, &c), "boolean");
    if (!c.closed || !c.edge_manifold || !c.vertex_manifold || !c.oriented) {
        fprintf(stderr, "bench_grids: a boolean is not closed, manifold and oriented\n");
        exit(1);
    }
    return c.volume;
}

static void show_booleans(const bench_model *m)
{
    static bench_memory memory;
    static bench_times times[2];
    bvx_context *contexts[2];
    shifted_dragon s;

    shift_dragon(m, &s);
    for (int n = 0; n < 2; n++) contexts[n] = bench_context(n + 1, BVX_CPU_BEST, &memory);
    printf(
        "\nTwo dragons of %" PRIu64 " triangles, one shifted, at %d voxels along both.\n\n"
        "| | one thread, ms | two threads, ms | ratio | triangles | volume | sharp: one thread, ms | volume |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|\n",
        m->triangle_count, BOOLEAN_RESOLUTION);
    for (int32_t op = 0; op < 4; op++) {
        bvx_mesh made[2] = {{0}}, sharp = {0};
        for (int n = 0; n < 2; n++) {
            times[n].count = 0;
            for (int run = -1; run < runs; run++) {
                bvx_mesh_free(contexts[n], &made[n]);
                double const ms = run_boolean(contexts[n], m, &s, op, 0, n + 1, NULL, &made[n]);
                if (run >= 0) bench_add(&times[n], ms);
            }
        }
        double const ms = run_boolean(contexts[0], m, &s, op, 1, 1, NULL, &sharp);
        printf("| %s | %.0f (%.0f) | %.0f (%.0f) | %.2f | %" PRIu64 " | %.9g | %.0f | %.9g |\n",
               boolean_names[op], bench_min(&times[0]), bench_median(&times[0]), bench_min(&times[1]),
               bench_median(&times[1]), bench_min(&times[0]) / bench_min(&times[1]), made[0].triangle_count,
               volume_of(contexts[0], &made[0]), ms, volume_of(contexts[0], &sharp));
        fflush(stdout);
        bvx_mesh_free(contexts[0], &sharp);
        for (int n = 0; n < 2; n++) bvx_mesh_free(contexts[n], &made[n]);
    }
    free(s.points);
    for (int n = 0; n < 2; n++) bvx_context_destroy(contexts[n]);
    bench_memory_release(&memory);
}

/* ---- rays ---- */

enum { RAY_SIDE = 1024, RAY_COUNT = 20000 };

/* From places around the box of a lattice to places in it. */
static void draw_rays(const bvx_lattice *l, double *rays)
{
    uint64_t x = UINT64_C(88172645463325252);

    for (int i = 0; i < RAY_COUNT; i++) {
        int const side = i % 3;
        for (int k = 0; k < 6; k++) {
            int const a = k % 3;
            x ^= x << 13;
            x ^= x >> 7;
            x ^= x << 17;
            double at = (double)(x >> 11) * 0x1p-53;
            if (k == side) at = at < 0.5 ? -0.25 : 1.25;
            rays[6 * i + k] = l->origin[a] + at * l->spacing[a] * l->dims[a];
        }
        for (int a = 0; a < 3; a++) rays[6 * i + 3 + a] -= rays[6 * i + a];
    }
}

/* Nanoseconds a ray, so many in each call; by the grid where there is no handle. */
static double time_rays(bvx_context *ctx, const bvx_grid *grid, const bvx_rays *caster, const double *rays,
                        int each, bvx_ray_hit *hits)
{
    double least = 1e300;

    for (int run = 0; run <= runs; run++) {
        double const start = bench_clock(1);
        for (int i = 0; i < RAY_COUNT; i += each)
            bench_try(ctx,
                      caster != NULL ? bvx_rays_cast(ctx, caster, rays + 6 * i, (uint64_t)each, 1e9, hits + i)
                                     : bvx_grid_cast(ctx, grid, rays + 6 * i, (uint64_t)each, 1e9, hits + i),
                      "rays");
        double const ns = (bench_clock(1) - start) * 1e6 / RAY_COUNT;
        if (ns < least) least = ns;
    }
    return least;
}

static void show_rays(const bench_model *dragon, FILE *targets)
{
    static double rays[6 * RAY_COUNT];
    static bvx_ray_hit together[RAY_COUNT], alone[RAY_COUNT];
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_rays *caster = NULL;
    int hits = 0;

    bench_try(ctx, bvx_lattice_fit(ctx, &dragon->view, RAY_SIDE, &lattice), "rays");
    for (int a = 0; a < 3; a++) lattice.dims[a] = RAY_SIDE;
    bench_try(ctx, bvx_voxelize_solid(ctx, &dragon->view, &lattice, NULL, &solid), "rays");
    draw_rays(&lattice, rays);
    double const start = bench_clock(1);
    bench_try(ctx, bvx_rays_create(ctx, &solid, &caster), "rays");
    double const create = bench_clock(1) - start;
    double const batched = time_rays(ctx, &solid, NULL, rays, RAY_COUNT, together);
    double const single = time_rays(ctx, &solid, NULL, rays, 1, alone);
    double const kept_batched = time_rays(ctx, &solid, caster, rays, RAY_COUNT, alone);
    double const kept = time_rays(ctx, &solid, caster, rays, 1, alone);
    if (memcmp(together, alone, sizeof alone) != 0) exit(1);
    for (int i = 0; i < RAY_COUNT; i++) hits += together[i].hit;
    printf("\nThe dragon's solid in 1024 x 1024 x 1024 voxels and %d rays, of which %d hit; one thread.\n\n"
           "| | ns a ray |\n|---|--:|\n| `bvx_grid_cast`, all in one call | %.0f |\n"
           "| `bvx_grid_cast`, one a call | %.0f |\n| `bvx_rays_cast`, all in one call | %.0f |\n"
           "| `bvx_rays_cast`, one a call | %.0f |\n| `bvx_rays_create`, ms | %.1f |\n",
           RAY_COUNT, hits, batched, single, kept_batched, kept, create);
    /* Beside the handle's own batch, which is without the bricks that each call of the grid makes. */
    bench_say_target(targets, "one ray of a 1024^3 grid, handle : batched", kept / kept_batched, "times", 2,
                     1);
    bvx_rays_free(ctx, caster);
    bvx_grid_free(ctx, &solid);
    bvx_context_destroy(ctx);
}

/* ---- turns ---- */

static void write_array(const char *folder, const char *name, const void *bytes, size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/grids_%s", folder, name);
    FILE *const file = bench_open(path);
    if (fwrite(bytes, 1, size, file) != size || fclose(file) != 0) {
        fprintf(stderr, "bench_grids: cannot write %s\n", path);
        exit(1);
    }
}

/* Inputs of the peers: both dragons, the random grid's words. */
static void write_inputs(const char *folder, const bench_model *m, const shifted_dragon *s,
                         const bvx_grid *random)
{
    float *const points = malloc((size_t)m->point_count * 3 * sizeof *points);

    if (points == NULL) exit(1);
    for (uint64_t i = 0; i < 3 * m->point_count; i++) points[i] = (float)m->points[i];
    write_array(folder, "a.points", points, (size_t)m->point_count * 3 * sizeof *points);
    write_array(folder, "b.points", s->points, (size_t)m->point_count * 3 * sizeof *points);
    write_array(folder, "triangles", m->triangles, (size_t)m->triangle_count * 3 * sizeof *m->triangles);
    write_array(folder, "random.words", random->words, (size_t)GRID_WORDS * 8);
    free(points);
}

static int take_turns(const char *meshes, const char *out)
{
    static bench_memory memory;
    bvx_context *contexts[2];
    bench_model dragon;
    shifted_dragon s;
    bvx_boolean_report report;
    bvx_mesh made = {0};
    char word[32];
    int threads;

    for (int n = 0; n < 2; n++) contexts[n] = bench_context(n + 1, BVX_CPU_BEST, &memory);
    if (!bench_model_open(contexts[0], meshes, dragon_file, "dragon", &dragon)) return 1;
    shift_dragon(&dragon, &s);
    bvx_grid solid = dragon_grid(contexts[0], &dragon), random = cube_grid(contexts[0], &solid.lattice);
    uint32_t *const counts = calloc((size_t)1 << 21, sizeof *counts);
    if (counts == NULL) return 1;
    scatter_tenth(&random);
    write_inputs(out, &dragon, &s, &random);
    run_boolean(contexts[0], &dragon, &s, 0, 0, 1, &report, &made);
    bvx_mesh_free(contexts[0], &made);
    printf("ready %.17g\n", report.lattice.spacing[0]);
    fflush(stdout);
    while (scanf("%31s %d", word, &threads) == 2) {
        bvx_context *const ctx = contexts[threads == 1 ? 0 : 1];
        if (strcmp(word, "coverage") == 0) {
            algebra_bench j = {&random, &solid, {0}, counts};
            double const start = bench_clock(threads);
            do_coverage(ctx, &j);
            printf("%.6f %016" PRIx64 "\n", bench_clock(threads) - start,
                   bvx_hash(counts, ((size_t)1 << 21) * sizeof *counts, 0));
        } else {
            int32_t op = 0;
            while (op < 3 && strcmp(word, boolean_names[op]) != 0) op++;
            double const ms = run_boolean(ctx, &dragon, &s, op, 0, threads, NULL, &made);
            printf("%.6f %.12g %" PRIu64 "\n", ms, volume_of(ctx, &made), made.triangle_count);
            bvx_mesh_free(ctx, &made);
        }
        fflush(stdout);
    }
    free(counts);
    free(s.points);
    bvx_grid_free(contexts[0], &solid);
    bvx_grid_free(contexts[0], &random);
    bench_model_free(contexts[0], &dragon);
    for (int n = 0; n < 2; n++) bvx_context_destroy(contexts[n]);
    bench_memory_release(&memory);
    return 0;
}

int main(int argc, char **argv)
{
    char path[1024];
    bench_model m;

    if (argc == 4 && strcmp(argv[1], "turns") == 0) return take_turns(argv[2], argv[3]);
    if (argc < 3) {
        fprintf(stderr, "usage: bench_grids MESH_FOLDER OUT [RUNS], bench_grids turns MESH_FOLDER OUT\n");
        return 2;
    }
    if (argc > 3 && atoi(argv[3]) > 0)
        runs = atoi(argv[3]) < BENCH_MOST_RUNS ? atoi(argv[3]) : BENCH_MOST_RUNS;
    snprintf(path, sizeof path, "%s/grids.jsonl", argv[2]);
    FILE *const targets = bench_open(path);
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    if (bench_model_open(ctx, argv[1], dragon_file, "dragon", &m)) {
        show_algebra(&m, targets);
        show_booleans(&m);
        show_rays(&m, targets);
        bench_model_free(ctx, &m);
    } else {
        printf("Missing: %s\n\n", dragon_file);
    }
    bvx_context_destroy(ctx);
    fclose(targets);
    return 0;
}
