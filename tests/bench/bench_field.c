/* bench_field.c - distance fields and repair: the dragon's band, the bunny's scan.
 *
 *   bench_field MESH_FOLDER OUT [RUNS]   prints Markdown; writes OUT/field.jsonl: targets
 *   bench_field turns MESH_FOLDER OUT    writes the arrays of dragon, scan and repaired scan to OUT, then
 *                                        does one job for each line "field|repair THREADS" of standard input
 *                                        and answers with milliseconds and counts
 *
 * From arrays to arrays in warm memory. One thread: processor time; two: time of day. The least of the runs
 * is compared, the median stands in brackets. The lattice of the field is the fitted one with room for the
 * band on all sides. */
#include "bench_models.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { RESOLUTION = 256, ROOM = 4 };
static const char dragon_file[] = "dragon_vrip_871414.ply.gz", bunny_file[] = "bunny_scan_69451.ply.gz";
static int runs = 9;

/* The fitted lattice with ROOM voxels more on each side. */
static void lattice_with_room(bvx_context *ctx, const bench_model *m, bvx_lattice *lattice)
{
    bench_try(ctx, bvx_lattice_fit(ctx, &m->view, RESOLUTION, lattice), m->name);
    for (int i = 0; i < 3; i++) {
        lattice->origin[i] -= ROOM * lattice->spacing[i];
        lattice->dims[i] += 2 * ROOM;
    }
}

/* ---- the field ---- */

typedef struct field_job {
    const char *title;
    int32_t sign, no_vectors;
} field_job;

static double run_field(bvx_context *ctx, const bench_model *m, const bvx_lattice *lattice,
                        const field_job *job, int threads, bvx_field *field)
{
    bvx_field_options o = {.struct_size = sizeof o};
    double const start = bench_clock(threads);

    o.half_width = 3.0;
    o.sign = job->sign;
    o.no_vectors = job->no_vectors;
    bench_try(ctx, bvx_measure_field(ctx, &m->view, lattice, &o, field), m->name);
    return bench_clock(threads) - start;
}

static int same_fields(const bvx_field *a, const bvx_field *b)
{
    return a->value_count == b->value_count &&
           memcmp(a->distances, b->distances, (size_t)a->value_count * sizeof(float)) == 0 &&
           ((a->vectors == NULL && b->vectors == NULL) ||
            memcmp(a->vectors, b->vectors, (size_t)a->value_count * 3 * sizeof(float)) == 0);
}

/* One row of the table: one thread, two threads. Returns the least milliseconds of one thread. */
static double show_field(const bench_model *m, const field_job *job, double *ns)
{
    static bench_memory memory;
    static bench_times times[2];
    bvx_field fields[2] = {0};
    bvx_context *contexts[2];
    bvx_lattice lattice;

    for (int n = 0; n < 2; n++) { /* a context of its own for each, so that its peak is this job's */
        contexts[n] = bench_context(n + 1, BVX_CPU_BEST, &memory);
        lattice_with_room(contexts[n], m, &lattice);
        times[n].count = 0;
        for (int run = -1; run < runs; run++) { /* the first warms memory and is not counted */
            bvx_field_free(contexts[n], &fields[n]);
            double const ms = run_field(contexts[n], m, &lattice, job, n + 1, &fields[n]);
            if (run >= 0) bench_add(&times[n], ms);
        }
    }
    double const least = bench_min(&times[0]), centres = (double)fields[0].value_count;
    *ns = least * 1e6 / centres;
    printf("| %s | %" PRIu64 " | %.1f (%.1f) | %.0f | %.1f (%.1f) | %.2f | %.1f | %.1f | %s |\n", job->title,
           fields[0].value_count, least, bench_median(&times[0]), *ns, bench_min(&times[1]),
           bench_median(&times[1]), least / bench_min(&times[1]),
           (double)bvx_memory_peak(contexts[0]) / 1048576.0, (double)bvx_memory_peak(contexts[1]) / 1048576.0,
           same_fields(&fields[0], &fields[1]) ? "same" : "DIFFERENT");
    fflush(stdout);
    for (int n = 0; n < 2; n++) {
        bvx_field_free(contexts[n], &fields[n]);
        bvx_context_destroy(contexts[n]);
    }
    bench_memory_release(&memory);
    return least;
}

static void show_fields(const bench_model *m, FILE *targets)
{
    static const field_job jobs[] = {{"sign exact", BVX_FILL_PARITY, 0},
                                     {"sign exact, no vectors", BVX_FILL_PARITY, 1},
                                     {"no sign", BVX_FILL_NONE, 0},
                                     {"sign auto", BVX_FILL_AUTO, 0}};
    double ns;

    printf(
        "Band of three voxels around the %s of %" PRIu64
        " triangles at %d: distances and vectors in floats.\n\n"
        "| | centres | one thread, ms | ns a centre | two threads, ms | ratio | peak MiB | of two | bytes of one and two |\n"
        "|---|--:|--:|--:|--:|--:|--:|--:|---|\n",
        m->name, m->triangle_count, RESOLUTION);
    for (size_t i = 0; i < sizeof jobs / sizeof *jobs; i++) {
        double const ms = show_field(m, &jobs[i], &ns);
        if (i != 0) continue;
        bench_say_target(targets, "field of the dragon at 256, one thread", ms, "ms", 150, 1);
        bench_say_target(targets, "a centre of it", ns, "ns", 220, 1);
    }
}

/* ---- repair ---- */

static double run_repair(bvx_context *ctx, const bench_model *m, int threads, bvx_repair_report *report,
                         int measure, bvx_mesh *repaired)
{
    bvx_repair_options o = {.struct_size = sizeof o};
    double const start = bench_clock(threads);

    o.fit.resolution = RESOLUTION;
    o.samples = measure ? 100000 : 0;
    o.report = report;
    bench_try(ctx, bvx_repair(ctx, &m->view, &o, repaired), m->name);
    return bench_clock(threads) - start;
}

static void show_repair(const bench_model *m, FILE *targets)
{
    static bench_memory memory;
    static bench_times times[2];
#define TEXT(name, value, text) text,
    static const char *const signs[] = {BVX_FILL_LIST(TEXT)};
#undef TEXT
    bvx_mesh repaired[2] = {{0}}, once = {0};
    bvx_context *contexts[2];
    bvx_repair_report r;
    uint64_t peaks[2];

    for (int n = 0; n < 2; n++) {
        contexts[n] = bench_context(n + 1, BVX_CPU_BEST, &memory);
        times[n].count = 0;
        for (int run = -1; run < runs; run++) {
            bvx_mesh_free(contexts[n], &repaired[n]);
            double const ms = run_repair(contexts[n], m, n + 1, NULL, 0, &repaired[n]);
            if (run >= 0) bench_add(&times[n], ms);
        }
        peaks[n] = bvx_memory_peak(contexts[n]);
    }
    const bvx_mesh *const a = &repaired[0], *const b = &repaired[1];
    int const same = a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count &&
                     memcmp(a->positions, b->positions, (size_t)a->vertex_count * 3 * sizeof(float)) == 0 &&
                     memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * 3 * sizeof(uint32_t)) ==
                         0;
    memset(&r, 0, sizeof r);
    run_repair(contexts[0], m, 1, &r, 1, &once);
    double const voxel = r.lattice.spacing[0];
    printf(
        "\nRepair of the %s of %" PRIu64 " triangles at %d, default options.\n\n"
        "| one thread, ms | two threads, ms | ratio | peak MiB | of two | triangles | bytes of one and two |\n|--:|--:|--:|--:|--:|--:|---|\n",
        m->name, m->triangle_count, RESOLUTION);
    printf("| %.1f (%.1f) | %.1f (%.1f) | %.2f | %.1f | %.1f | %" PRIu64 " | %s |\n", bench_min(&times[0]),
           bench_median(&times[0]), bench_min(&times[1]), bench_median(&times[1]),
           bench_min(&times[0]) / bench_min(&times[1]), (double)peaks[0] / 1048576.0,
           (double)peaks[1] / 1048576.0, a->triangle_count, same ? "same" : "DIFFERENT");
    printf("\nSign by %s; %" PRIu64 " holes. Result: %" PRIu64 " boundary, %" PRIu64
           " non-manifold and %" PRIu64 " flipped edges.\n",
           r.sign >= 0 && r.sign <= BVX_FILL_NONE ? signs[r.sign] : "?", r.holes, r.after.boundary_edges,
           r.after.nonmanifold_edges, r.after.flipped_edges);
    printf("The scan lies %.4f voxels from the result on average, %.3f at most.\n",
           r.distance.mean_a_to_b / voxel, r.distance.max_a_to_b / voxel);
    fflush(stdout);
    bench_say_target(targets, "scan : repaired bunny at 256, mean", r.distance.mean_a_to_b / voxel, "voxels",
                     0.1, 1);
    bvx_mesh_free(contexts[0], &once);
    for (int n = 0; n < 2; n++) {
        bvx_mesh_free(contexts[n], &repaired[n]);
        bvx_context_destroy(contexts[n]);
    }
    bench_memory_release(&memory);
}

/* ---- turns ---- */

static void write_values(const char *folder, const char *name, const char *end, const void *bytes,
                         size_t size)
{
    char path[1024];
    snprintf(path, sizeof path, "%s/field_%s.%s", folder, name, end);
    FILE *const file = bench_open(path);
    if (fwrite(bytes, 1, size, file) != size || fclose(file) != 0) {
        fprintf(stderr, "bench_field: cannot write %s\n", path);
        exit(1);
    }
}

static void write_model(const char *folder, const bench_model *m)
{
    write_values(folder, m->name, "points", m->points, (size_t)m->point_count * 3 * sizeof *m->points);
    write_values(folder, m->name, "triangles", m->triangles,
                 (size_t)m->triangle_count * 3 * sizeof *m->triangles);
}

/* Our field without vectors as a list: index of each centre (x y z), distance. */
static void write_field(const char *folder, bvx_context *ctx, const bench_model *m,
                        const bvx_lattice *lattice)
{
    static const field_job job = {"", BVX_FILL_PARITY, 1};
    bvx_field field = {0};
    uint64_t n = 0;

    run_field(ctx, m, lattice, &job, 1, &field);
    int32_t *const places = malloc((size_t)field.value_count * 3 * sizeof *places);
    if (places == NULL) exit(1);
    for (int32_t z = 0; z < lattice->dims[2]; z++)
        for (int32_t y = 0; y < lattice->dims[1]; y++) {
            uint64_t const row = (uint64_t)z * (uint64_t)lattice->dims[1] + (uint64_t)y;
            if (field.row_values[row] == field.row_values[row + 1]) continue;
            for (int32_t x = 0; x < lattice->dims[0]; x++) {
                if (bvx_field_value(&field, x, y, z) == UINT64_MAX) continue;
                places[3 * n] = x;
                places[3 * n + 1] = y;
                places[3 * n++ + 2] = z;
            }
        }
    write_values(folder, m->name, "places", places, (size_t)n * 3 * sizeof *places);
    write_values(folder, m->name, "distances", field.distances, (size_t)n * sizeof(float));
    free(places);
    bvx_field_free(ctx, &field);
}

static int take_turns(const char *meshes, const char *out)
{
    static bench_memory memory;
    static const field_job exact = {"", BVX_FILL_PARITY, 0};
    bvx_context *contexts[2];
    bench_model dragon, bunny;
    bvx_lattice lattice;
    bvx_mesh repaired = {0};
    char word[16];
    int threads;

    for (int n = 0; n < 2; n++) contexts[n] = bench_context(n + 1, BVX_CPU_BEST, &memory);
    if (!bench_model_open(contexts[0], meshes, dragon_file, "dragon", &dragon)) return 1;
    if (!bench_model_open(contexts[0], meshes, bunny_file, "bunny", &bunny)) return 1;
    lattice_with_room(contexts[0], &dragon, &lattice);
    write_model(out, &dragon);
    write_model(out, &bunny);
    write_field(out, contexts[0], &dragon, &lattice);
    run_repair(contexts[0], &bunny, 1, NULL, 0, &repaired);
    write_values(out, "repaired", "points", repaired.positions,
                 (size_t)repaired.vertex_count * 3 * sizeof(float));
    write_values(out, "repaired", "triangles", repaired.triangles,
                 (size_t)repaired.triangle_count * 3 * sizeof(uint32_t));
    bvx_mesh_free(contexts[0], &repaired);
    printf("ready %.17g %.17g %.17g %.17g %d %d %d\n", lattice.spacing[0], lattice.origin[0],
           lattice.origin[1], lattice.origin[2], lattice.dims[0], lattice.dims[1], lattice.dims[2]);
    fflush(stdout);
    while (scanf("%15s %d", word, &threads) == 2) {
        bvx_context *const ctx = contexts[threads == 1 ? 0 : 1];
        double ms;
        uint64_t count;
        if (strcmp(word, "field") == 0) {
            bvx_field field = {0};
            ms = run_field(ctx, &dragon, &lattice, &exact, threads, &field);
            count = field.value_count;
            bvx_field_free(ctx, &field);
        } else {
            ms = run_repair(ctx, &bunny, threads, NULL, 0, &repaired);
            count = repaired.triangle_count;
            bvx_mesh_free(ctx, &repaired);
        }
        printf("%.6f %" PRIu64 "\n", ms, count);
        fflush(stdout);
    }
    bench_model_free(contexts[0], &dragon);
    bench_model_free(contexts[0], &bunny);
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
        fprintf(stderr, "usage: bench_field MESH_FOLDER OUT [RUNS], bench_field turns MESH_FOLDER OUT\n");
        return 2;
    }
    if (argc > 3 && atoi(argv[3]) > 0)
        runs = atoi(argv[3]) < BENCH_MOST_RUNS ? atoi(argv[3]) : BENCH_MOST_RUNS;
    snprintf(path, sizeof path, "%s/field.jsonl", argv[2]);
    FILE *const targets = bench_open(path);
    bvx_context *const ctx = bench_context(1, BVX_CPU_BEST, NULL);
    if (bench_model_open(ctx, argv[1], dragon_file, "dragon", &m)) {
        show_fields(&m, targets);
        bench_model_free(ctx, &m);
    } else {
        printf("Missing: %s\n\n", dragon_file);
    }
    if (bench_model_open(ctx, argv[1], bunny_file, "bunny", &m)) {
        show_repair(&m, targets);
        bench_model_free(ctx, &m);
    } else {
        printf("Missing: %s\n\n", bunny_file);
    }
    bvx_context_destroy(ctx);
    fclose(targets);
    return 0;
}
