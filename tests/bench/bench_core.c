/* bench_core.c - speed and memory of the main job and its stages, beside the baseline loop.
 *
 *   bench_core MESH FOLDER [RUNS]
 *
 * Loading is left out, memory is warm on both sides, and the contenders take turns in every run, so that a
 * disturbance meets them all. The least of many runs is compared; the median beside it says how noisy the
 * machine was. Prints a table and writes FOLDER/core.json; for others to work on also the mesh's arrays, the
 * bits of the solid and solid.json, which says what they are. */
#include "bench.h"
#include "parity_loop.h"

#include <stdlib.h>
#include <string.h>

enum { FINE = BENCH_FINE, LEVELS = BENCH_LEVELS };

/* One way to run the library. */
typedef struct side {
    const char *name;
    int threads;
    bench_memory memory;
    bvx_context *ctx;
    bench_times solid, told, surface, job; /* told: the solid with its report, lost walls looked for */
    uint64_t solid_hash, surface_hash;
} side;

enum { PORTABLE_1, BEST_1, PORTABLE_2, BEST_2, SIDES };
static side sides[SIDES];

static void open_sides(void)
{
    static const char *const names[SIDES] = {"portable_1", "best_1", "portable_2", "best_2"};
    for (int i = 0; i < SIDES; i++) {
        sides[i].name = names[i];
        sides[i].threads = i < PORTABLE_2 ? 1 : 2;
        sides[i].ctx = bench_context(sides[i].threads, i % 2 ? BVX_CPU_BEST : BVX_CPU_PORTABLE,
                                     &sides[i].memory);
    }
}

typedef struct subject {
    bvx_mesh mesh; /* f32, u32, packed */
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid baseline;
    int runs;
    FILE *json;
} subject;

static double quotient(double a, double b)
{
    return b > 0.0 ? a / b : 0.0;
}

/* ---- stages ---- */

static void run_solid(subject *s, side *a, bvx_grid *solid)
{
    double const start = bench_clock(a->threads);
    bench_try(a->ctx, bvx_voxelize_solid(a->ctx, &s->view, &s->lattice, NULL, solid), "solid");
    bench_add(&a->solid, bench_clock(a->threads) - start);
}

static void run_told(subject *s, side *a, bvx_grid *solid)
{
    static bvx_solid_report report;
    bvx_voxelize_options const o = {.struct_size = sizeof o, .report = &report};
    double const start = bench_clock(a->threads);
    bench_try(a->ctx, bvx_voxelize_solid(a->ctx, &s->view, &s->lattice, &o, solid), "solid with report");
    bench_add(&a->told, bench_clock(a->threads) - start);
}

static void run_surface(side *a, const bvx_grid *solid, bvx_mesh *surface)
{
    double const start = bench_clock(a->threads);
    bench_try(a->ctx, bvx_extract_surface(a->ctx, solid, NULL, surface), "surface");
    bench_add(&a->surface, bench_clock(a->threads) - start);
}

static void free_levels(bvx_context *ctx, bvx_mesh levels[LEVELS])
{
    for (int i = 0; i < LEVELS; i++) bvx_mesh_free(ctx, &levels[i]);
}

static void run_all(subject *s, bench_times *baseline, bench_times *fit)
{
    for (int run = 0; run < s->runs; run++) {
        double start = bench_clock(1);
        parity_loop(s->mesh.positions, s->mesh.triangles, s->mesh.triangle_count, &s->baseline);
        bench_add(baseline, bench_clock(1) - start);
        start = bench_clock(1);
        bench_try(sides[BEST_1].ctx, bvx_lattice_fit(sides[BEST_1].ctx, &s->view, FINE, &s->lattice),
                  "lattice");
        bench_add(fit, bench_clock(1) - start);
        for (int i = 0; i < SIDES; i++) {
            side *const a = &sides[i];
            bvx_grid solid = {0};
            bvx_mesh surface = {0}, levels[LEVELS] = {{0}};
            run_told(s, a, &solid);
            run_solid(s, a, &solid);
            run_surface(a, &solid, &surface);
            if (run == 0) {
                bench_try(a->ctx, bvx_grid_hash(a->ctx, &solid, &a->solid_hash), "hash");
                bench_try(a->ctx, bvx_mesh_hash(a->ctx, &surface, &a->surface_hash), "hash");
            }
            bvx_mesh_free(a->ctx, &surface);
            bvx_grid_free(a->ctx, &solid);
            start = bench_clock(a->threads);
            bench_main_job(a->ctx, &s->view, LEVELS, levels, NULL);
            bench_add(&a->job, bench_clock(a->threads) - start);
            free_levels(a->ctx, levels);
        }
    }
}

/* ---- results must be right before they may be fast ---- */

static uint64_t bits_that_differ(const bvx_grid *a, const bvx_grid *b)
{
    uint64_t const n = bvx_grid_bound(&a->lattice, NULL);
    uint64_t count = 0;
    for (uint64_t i = 0; i < n; i++)
        for (uint64_t w = a->words[i] ^ b->words[i]; w != 0; w &= w - 1) count++;
    return count;
}

static int is_closed_manifold(const bvx_certificate *c)
{
    return c->closed && c->edge_manifold && c->vertex_manifold && c->oriented && c->duplicates == 0;
}

static int check_mesh(bvx_context *ctx, const bvx_mesh *mesh, const char *what)
{
    bvx_mesh_view view;
    bvx_certificate c;

    bvx_mesh_view_of(mesh, &view);
    bench_try(ctx, bvx_mesh_check(ctx, &view, 0, &c), what);
    printf("  %s: %llu triangles, %s, %llu components, volume %.6g\n", what, (unsigned long long)c.triangles,
           is_closed_manifold(&c) ? "closed, manifold, oriented" : "NOT CLOSED OR NOT MANIFOLD",
           (unsigned long long)c.components, c.volume);
    return is_closed_manifold(&c);
}

static void write_raw(const char *folder, const char *name, const void *bytes, uint64_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *const file = bench_open(path);
    if (fwrite(bytes, 1, (size_t)size, file) != size) exit(1);
    fclose(file);
}

static void write_inputs(const subject *s, const bvx_grid *solid, const char *folder)
{
    char path[1024];
    const bvx_lattice *const l = &s->lattice;

    write_raw(folder, "solid.bits", solid->words, bvx_grid_bound(l, NULL) * 8);
    write_raw(folder, "mesh.positions", s->mesh.positions, s->mesh.vertex_count * 12);
    write_raw(folder, "mesh.triangles", s->mesh.triangles, s->mesh.triangle_count * 12);
    snprintf(path, sizeof path, "%s/solid.json", folder);
    FILE *const file = bench_open(path);
    fprintf(
        file,
        "{\"dims\": [%d, %d, %d], \"words_per_row\": %d, \"spacing\": %.17g, \"origin\": [%.17g, %.17g, %.17g]}\n",
        l->dims[0], l->dims[1], l->dims[2], solid->words_per_row, l->spacing[0], l->origin[0], l->origin[1],
        l->origin[2]);
    fclose(file);
}

static int check_results(subject *s, const char *folder)
{
    bvx_context *const ctx = sides[BEST_1].ctx;
    bvx_grid solid = {0};
    bvx_mesh surface = {0}, levels[LEVELS] = {{0}};
    bvx_lod_report reports[LEVELS];
    uint64_t ours, theirs;
    int good = 1;
    char what[64];
    bench_try(ctx, bvx_voxelize_solid(ctx, &s->view, &s->lattice, NULL, &solid), "solid");
    bench_try(ctx, bvx_grid_count(ctx, &solid, &ours), "count");
    bench_try(ctx, bvx_grid_count(ctx, &s->baseline, &theirs), "count");
    uint64_t const differ = bits_that_differ(&solid, &s->baseline);
    printf(
        "results\n  solid %d x %d x %d: %llu voxels; the baseline has %llu, %llu differ (ties that its rounding decides)\n",
        s->lattice.dims[0], s->lattice.dims[1], s->lattice.dims[2], (unsigned long long)ours,
        (unsigned long long)theirs, (unsigned long long)differ);
    good &= differ < 1000;
    for (int i = 1; i < SIDES; i++)
        good &= sides[i].solid_hash == sides[0].solid_hash && sides[i].surface_hash == sides[0].surface_hash;
    printf("  %s bits and surfaces from portable and fast code, one and two threads\n",
           good ? "the same" : "DIFFERENT");
    write_inputs(s, &solid, folder);
    bench_try(ctx, bvx_extract_surface(ctx, &solid, NULL, &surface), "surface");
    good &= check_mesh(ctx, &surface, "surface");
    fprintf(
        s->json,
        "\"voxels\": %llu, \"baseline_voxels\": %llu, \"baseline_differs\": %llu, \"surface_triangles\": %llu,\n",
        (unsigned long long)ours, (unsigned long long)theirs, (unsigned long long)differ,
        (unsigned long long)surface.triangle_count);
    bvx_mesh_free(ctx, &surface);
    bvx_grid_free(ctx, &solid);

    bench_main_job(ctx, &s->view, LEVELS, levels, reports);
    fprintf(s->json, "\"levels\": [");
    for (int i = 0; i < LEVELS; i++) {
        const int32_t *const r = reports[i].resolution;
        snprintf(what, sizeof what, "level %d x %d x %d", r[0], r[1], r[2]);
        good &= check_mesh(ctx, &levels[i], what);
        fprintf(s->json, "%s%llu", i ? ", " : "", (unsigned long long)levels[i].triangle_count);
    }
    fprintf(s->json, "], \"good\": %d,\n", good);
    free_levels(ctx, levels);
    return good;
}

/* ---- where the time goes ---- */

/* What the fractions that the progress callback is given stand for, in order: solid.c and march.c name
 * them. */
static const struct phase {
    const char *name;
    int call; /* 0 solid, 1 surface */
    double from;
} phases[] = {{"snapping", 0, 0.0},         {"clearing the bits", 0, 0.1}, {"crossings of rows", 0, 0.15},
              {"toggles to runs", 0, 0.4},  {"unbalanced rows", 0, 0.5},   {"surface: counting", 1, 0.0},
              {"surface: writing", 1, 0.35}};
enum { PHASES = sizeof phases / sizeof *phases };

typedef struct phase_clock {
    double ms[PHASES], since;
    int call, now; /* now: -1 before the first word of a call */
} phase_clock;

/* The library says where it is; the time until it speaks again belongs to that place. */
static int32_t on_progress(void *user, const char *stage, double fraction)
{
    phase_clock *const c = user;
    double const t = bench_clock(1);

    (void)stage;
    if (c->now >= 0) c->ms[c->now] += t - c->since;
    for (int i = 0; i < PHASES; i++)
        if (phases[i].call == c->call && phases[i].from <= fraction + 1e-9) c->now = i;
    c->since = bench_clock(1);
    return 0;
}

static void begin_call(phase_clock *c, int call)
{
    c->call = call;
    c->now = -1;
}

static void end_call(phase_clock *c)
{
    if (c->now >= 0) c->ms[c->now] += bench_clock(1) - c->since;
}

static void show_phases(subject *s)
{
    static phase_clock clock;
    static bench_memory memory;
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx;

    o.threads = 1;
    o.allocator.alloc = bench_alloc;
    o.allocator.free = bench_free;
    o.allocator.user = &memory;
    o.progress.call = on_progress;
    o.progress.user = &clock;
    bench_try(NULL, bvx_context_create(&o, &ctx), "context");
    for (int run = 0; run < s->runs; run++) {
        bvx_grid solid = {0};
        bvx_mesh surface = {0};
        if (run == 1) memset(&clock, 0, sizeof clock); /* the first run warms the memory */
        begin_call(&clock, 0);
        bench_try(ctx, bvx_voxelize_solid(ctx, &s->view, &s->lattice, NULL, &solid), "solid");
        end_call(&clock);
        begin_call(&clock, 1);
        bench_try(ctx, bvx_extract_surface(ctx, &solid, NULL, &surface), "surface");
        end_call(&clock);
        bvx_mesh_free(ctx, &surface);
        bvx_grid_free(ctx, &solid);
    }
    int const counted = s->runs > 1 ? s->runs - 1 : 1;
    printf("phases at %d, one thread, means:", FINE);
    fprintf(s->json, "\"phases\": {");
    for (int i = 0; i < PHASES; i++) {
        printf("%s %s %.2f ms", i ? "," : "", phases[i].name, clock.ms[i] / counted);
        fprintf(s->json, "%s\"%s\": %.4f", i ? ", " : "", phases[i].name, clock.ms[i] / counted);
    }
    printf("\n");
    fprintf(s->json, "},\n");
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
}

/* The main job taken apart at its calls. */
static void show_job(subject *s)
{
    side *const a = &sides[BEST_1];
    bench_times fit = {{0}, 0}, solid_times = {{0}, 0}, level_times[LEVELS] = {{{0}, 0}};

    for (int run = 0; run < s->runs; run++) {
        bvx_lattice lattice;
        bvx_grid solid = {0};
        double start = bench_clock(1);
        bench_try(a->ctx, bvx_lattice_fit(a->ctx, &s->view, BENCH_MAIN, &lattice), "lattice");
        bench_add(&fit, bench_clock(1) - start);
        start = bench_clock(1);
        bench_try(a->ctx, bvx_voxelize_solid(a->ctx, &s->view, &lattice, NULL, &solid), "solid");
        bench_add(&solid_times, bench_clock(1) - start);
        for (int i = 0; i < LEVELS; i++) {
            bvx_mesh level = {0};
            bvx_lod_options options = {.struct_size = sizeof options};
            options.resolutions = &bench_resolutions[i];
            start = bench_clock(1);
            bench_try(a->ctx, bvx_build_lods(a->ctx, &solid, &options, 1, &level), "level");
            bench_add(&level_times[i], bench_clock(1) - start);
            bvx_mesh_free(a->ctx, &level);
        }
        bvx_grid_free(a->ctx, &solid);
    }
    printf("parts of the main job, one thread\n  lattice %.2f ms, solid %d %.2f ms", bench_min(&fit),
           BENCH_MAIN, bench_min(&solid_times));
    fprintf(s->json, "\"parts\": {\"lattice\": %.4f, \"solid\": %.4f, \"levels\": [", bench_min(&fit),
            bench_min(&solid_times));
    for (int i = 0; i < LEVELS; i++) {
        printf(", level %d %.2f ms", bench_resolutions[i], bench_min(&level_times[i]));
        fprintf(s->json, "%s%.4f", i ? ", " : "", bench_min(&level_times[i]));
    }
    printf("\n");
    fprintf(s->json, "]},\n");
}

/* ---- memory ---- */

static void show_memory(subject *s)
{
    double const mib = 1048576.0;
    uint64_t const view = s->mesh.vertex_count * 12 + s->mesh.triangle_count * 12;
    uint64_t const bits = bvx_grid_bound(&s->lattice, NULL) * 8;
    uint64_t const per_element = 16 * (s->mesh.vertex_count + s->mesh.triangle_count);

    fprintf(s->json, "\"memory\": {");
    for (int i = BEST_1; i <= BEST_2; i += BEST_2 - BEST_1) {
        bvx_grid solid = {0};
        bvx_mesh surface = {0};
        bvx_context *const ctx = sides[i].ctx;
        bvx_memory_reset_peak(ctx);
        sides[i].memory.peak = sides[i].memory.live;
        uint64_t const held = sides[i].memory.live;
        bench_try(ctx, bvx_voxelize_solid(ctx, &s->view, &s->lattice, NULL, &solid), "solid");
        bench_try(ctx, bvx_extract_surface(ctx, &solid, NULL, &surface), "surface");
        uint64_t const output = surface.vertex_count * 12 + surface.triangle_count * 12;
        uint64_t const bound = view + bits + per_element + output + 1048576;
        uint64_t const peak = view + sides[i].memory.peak - held;
        if (i == BEST_1)
            printf(
                "memory of voxelize and extract at %d: view %.2f, bits %.2f, 16 (V+T) %.2f, output %.2f MiB\n",
                FINE, (double)view / mib, (double)bits / mib, (double)per_element / mib,
                (double)output / mib);
        printf(
            "  %d thread%s: peak with view %.2f MiB, bound %.2f MiB: %s (library says %.2f MiB without the view)\n",
            sides[i].threads, sides[i].threads > 1 ? "s" : "", (double)peak / mib, (double)bound / mib,
            peak <= bound ? "kept" : "EXCEEDED", (double)bvx_memory_peak(ctx) / mib);
        fprintf(s->json, "%s\"peak_%d\": %llu, \"bound_%d\": %llu", i == BEST_1 ? "" : ", ", sides[i].threads,
                (unsigned long long)peak, sides[i].threads, (unsigned long long)bound);
        bvx_mesh_free(ctx, &surface);
        bvx_grid_free(ctx, &solid);
    }
    fprintf(s->json, "},\n");
}

/* ---- the table ---- */

static void write_times(FILE *json, const char *name, const bench_times *t, const char *end)
{
    fprintf(json, "\"%s\": {\"min\": %.4f, \"median\": %.4f}%s", name, bench_min(t), bench_median(t), end);
}

static void show_stage(subject *s, const char *title, const char *name, size_t offset,
                       const bench_times *baseline)
{
    const bench_times *t[SIDES];

    printf("%-34s", title);
    fprintf(s->json, "\"%s\": {", name);
    for (int i = 0; i < SIDES; i++) {
        t[i] = (const bench_times *)(const void *)((const char *)&sides[i] + offset);
        printf("  %8.2f %8.2f", bench_min(t[i]), bench_median(t[i]));
        write_times(s->json, sides[i].name, t[i], i + 1 < SIDES || baseline ? ", " : "");
    }
    printf("   %5.2f", quotient(bench_min(t[BEST_1]), bench_min(t[BEST_2])));
    if (baseline) {
        double const ms = bench_min(baseline);
        printf("\n%-34s  %8.2f %8.2f   = %.2f times ours portable, %.2f times ours best, one thread",
               "  baseline parity loop, one thread", ms, bench_median(baseline),
               quotient(ms, bench_min(t[PORTABLE_1])), quotient(ms, bench_min(t[BEST_1])));
        write_times(s->json, "baseline", baseline, "");
    }
    printf("\n");
    fprintf(s->json, "},\n");
}

int main(int argc, char **argv)
{
    static subject s;
    static bench_times baseline, fit;
    char path[1024];
    if (argc < 3) {
        fprintf(stderr, "usage: bench_core MESH FOLDER [RUNS]\n");
        return 2;
    }
    s.runs = argc > 3 ? atoi(argv[3]) : 25;
    if (s.runs < 1 || s.runs > BENCH_MOST_RUNS) s.runs = 25;
    open_sides();
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    if (!bench_read_mesh(ctx, argv[1], &s.mesh)) {
        printf("bench_core: %s is missing\n", argv[1]);
        return 77;
    }
    if (s.mesh.position_type != BVX_F32) {
        fprintf(stderr, "bench_core: %s has no float positions, which the baseline needs\n", argv[1]);
        return 1;
    }
    bvx_mesh_view_of(&s.mesh, &s.view);
    bench_try(ctx, bvx_lattice_fit(ctx, &s.view, FINE, &s.lattice), "lattice");
    bench_try(ctx, bvx_grid_create(ctx, &s.lattice, NULL, &s.baseline), "grid");
    snprintf(path, sizeof path, "%s/core.json", argv[2]);
    s.json = bench_open(path);
    fprintf(s.json, "{\"vertices\": %llu, \"triangles\": %llu, \"runs\": %d,\n",
            (unsigned long long)s.mesh.vertex_count, (unsigned long long)s.mesh.triangle_count, s.runs);

    run_all(&s, &baseline, &fit);
    printf("%s, %llu triangles, %d runs; least and median milliseconds (one thread: its processor time)\n",
           argv[1], (unsigned long long)s.mesh.triangle_count, s.runs);
    printf("%-34s  %-17s  %-17s  %-17s  %-17s  %s\n", "", "portable, 1 thread", "best, 1 thread",
           "portable, 2", "best, 2", "best 1 : 2");
    show_stage(&s, "solid 512", "solid", offsetof(side, solid), &baseline);
    show_stage(&s, "the same with its report", "told", offsetof(side, told), NULL);
    show_stage(&s, "surface of it", "surface", offsetof(side, surface), NULL);
    show_stage(&s, "main job: solid 256, four levels", "job", offsetof(side, job), NULL);
    printf("lattice fitted in %.2f ms (in the main job, not in solid 512)\n", bench_min(&fit));
    show_job(&s);
    show_phases(&s);
    show_memory(&s);
    int const good = check_results(&s, argv[2]);
    fprintf(s.json, "\"fit\": %.4f}\n", bench_min(&fit));
    fclose(s.json);

    bvx_grid_free(ctx, &s.baseline);
    bvx_mesh_free(ctx, &s.mesh);
    bvx_context_destroy(ctx);
    for (int i = 0; i < SIDES; i++) {
        bvx_context_destroy(sides[i].ctx);
        bench_memory_release(&sides[i].memory);
    }
    return good ? 0 : 1;
}
