/* bench_volumes.c - scalar volumes: thresholds and surfaces of a level in 512 x 512 x 512 samples of the
 * dragon's distance field.
 *
 *   bench_volumes MESHES OUT [RUNS]   prints Markdown; OUT/volume_dragon.f32 holds the samples for others,
 *   OUT/volumes.ms our time
 *
 * Processor time of one thread, memory warm, the least and the median of the runs. */
#include "bench.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { VOLUME_SIDE = 512, VOLUME_RUNS = 9 };

/* The field in a cube of samples, positive inside, and the bytes that hold it. */
static void make_samples(bvx_context *ctx, const bvx_mesh_view *mesh, bvx_buffer *file, bvx_volume *volume)
{
    static const int32_t dims[3] = {VOLUME_SIDE, VOLUME_SIDE, VOLUME_SIDE};
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_lattice fitted, cube;
    bvx_field field;
    double origin[3];

    memset(&field, 0, sizeof field);
    bench_try(ctx, bvx_lattice_fit(ctx, mesh, VOLUME_SIDE - 16, &fitted), "bvx_lattice_fit");
    for (int a = 0; a < 3; a++)
        origin[a] = fitted.origin[a] - 0.5 * (VOLUME_SIDE - fitted.dims[a]) * fitted.spacing[a];
    bench_try(ctx, bvx_lattice_make(ctx, origin, fitted.spacing, dims, &cube), "bvx_lattice_make");
    o.half_width = 6;
    o.no_vectors = 1;
    bench_try(ctx, bvx_measure_field(ctx, mesh, &cube, &o, &field), "bvx_measure_field");
    bench_try(ctx, bvx_write_field(ctx, &field, 0, BVX_FORMAT_NPY, file), "bvx_write_field");
    bvx_field_free(ctx, &field);
    bench_try(ctx, bvx_read_volume(ctx, file->bytes, file->size, BVX_FORMAT_NPY, NULL, volume),
              "bvx_read_volume");
    volume->view.lattice = cube;
}

static void write_samples(const char *out, const bvx_volume *v)
{
    char path[1024];
    FILE *file;
    snprintf(path, sizeof path, "%s/volume_dragon.f32", out);
    file = bench_open(path);
    if (fwrite(v->view.samples, 4, (size_t)VOLUME_SIDE * VOLUME_SIDE * VOLUME_SIDE, file) == 0) exit(1);
    fclose(file);
}

/* ---- jobs ---- */

typedef struct volume_bench {
    bvx_context *ctx;
    bvx_volume_view floats, shorts, turned; /* turned: z fastest */
    double sum;
    uint64_t triangles;
} volume_bench;

typedef void volume_job_fn(volume_bench *b);

static void read_all(volume_bench *b)
{
    const float *const p = b->floats.samples;
    float lane[16] = {0};
    for (size_t i = 0; i < (size_t)VOLUME_SIDE * VOLUME_SIDE * VOLUME_SIDE; i += 16)
        for (size_t l = 0; l < 16; l++) lane[l] += p[i + l];
    for (size_t l = 0; l < 16; l++) b->sum += (double)lane[l];
}

static void threshold_of(volume_bench *b, const bvx_volume_view *v, int counted)
{
    bvx_volume_report r;
    bvx_grid grid = {0};
    bench_try(b->ctx, bvx_threshold(b->ctx, v, -HUGE_VAL, 0, counted ? &r : NULL, &grid), "bvx_threshold");
    bvx_grid_free(b->ctx, &grid);
}

static void threshold_floats(volume_bench *b)
{
    threshold_of(b, &b->floats, 0);
}

static void threshold_counted(volume_bench *b)
{
    threshold_of(b, &b->floats, 1);
}

static void threshold_shorts(volume_bench *b)
{
    threshold_of(b, &b->shorts, 1);
}

static void threshold_turned(volume_bench *b)
{
    threshold_of(b, &b->turned, 1);
}

static void surface_of(volume_bench *b, const bvx_volume_view *v)
{
    bvx_volume_report r;
    bvx_scalar_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};

    o.below = 1;
    o.report = &r;
    bench_try(b->ctx, bvx_extract_scalar(b->ctx, v, &o, &mesh), "bvx_extract_scalar");
    b->triangles = mesh.triangle_count;
    bvx_mesh_free(b->ctx, &mesh);
}

static void surface_floats(volume_bench *b)
{
    surface_of(b, &b->floats);
}

static void surface_shorts(volume_bench *b)
{
    surface_of(b, &b->shorts);
}

static void surface_turned(volume_bench *b)
{
    surface_of(b, &b->turned);
}

static double show_job(volume_bench *b, const char *name, volume_job_fn *job, int runs)
{
    bench_times times = {{0}, 0};

    job(b);
    for (int i = 0; i < runs; i++) {
        double const start = bench_clock(1);
        job(b);
        bench_add(&times, bench_clock(1) - start);
    }
    printf("| %s | %.1f | %.1f |\n", name, bench_min(&times), bench_median(&times));
    return bench_min(&times);
}

/* Whole numbers of 16 bits from the same field: a sixteenth of a voxel each. */
static int16_t *make_shorts(const bvx_volume *v)
{
    size_t const n = (size_t)VOLUME_SIDE * VOLUME_SIDE * VOLUME_SIDE;
    const float *const p = v->view.samples;
    double const scale = 16.0 / v->view.lattice.spacing[0];
    int16_t *const made = malloc(n * sizeof *made);
    if (made == NULL) exit(1);
    for (size_t i = 0; i < n; i++) made[i] = (int16_t)floor((double)p[i] * scale);
    return made;
}

int main(int argc, char **argv)
{
    static bench_memory memory;
    int const runs = argc > 3 && atoi(argv[3]) > 0 && atoi(argv[3]) < BENCH_MOST_RUNS ? atoi(argv[3])
                                                                                      : VOLUME_RUNS;
    bvx_buffer file = {0};
    bvx_volume volume = {0};
    bvx_mesh_view view;
    bvx_mesh mesh = {0};
    volume_bench b = {0};
    char path[1024];
    int16_t *shorts;
    double ours;
    FILE *out;

    if (argc < 3) {
        fprintf(stderr, "usage: bench_volumes MESHES OUT [RUNS]\n");
        return 2;
    }
    b.ctx = bench_context(1, BVX_CPU_BEST, &memory);
    snprintf(path, sizeof path, "%s/dragon_vrip_871414.ply.gz", argv[1]);
    if (!bench_read_mesh(b.ctx, path, &mesh)) {
        printf("Missing: %s\n", path);
        return 0;
    }
    bvx_mesh_view_of(&mesh, &view);
    make_samples(b.ctx, &view, &file, &volume);
    write_samples(argv[2], &volume);
    shorts = make_shorts(&volume);
    b.floats = b.shorts = b.turned = volume.view;
    b.shorts.samples = shorts;
    b.shorts.sample_type = BVX_SAMPLE_I16;
    memset(b.shorts.strides, 0, sizeof b.shorts.strides);
    b.turned.strides[0] = volume.view.strides[2]; /* the same samples, x and z exchanged */
    b.turned.strides[2] = volume.view.strides[0];
    printf(
        "### Volumes: %d^3 samples of the dragon's distance field, one thread\n\n| job | least ms | median ms |\n|---|--:|--:|\n",
        VOLUME_SIDE);
    show_job(&b, "reading f32 alone", read_all, runs);
    show_job(&b, "threshold, f32", threshold_floats, runs);
    show_job(&b, "threshold with counts and extremes, f32", threshold_counted, runs);
    show_job(&b, "threshold with counts and extremes, i16", threshold_shorts, runs);
    show_job(&b, "threshold with counts and extremes, f32 with z fastest", threshold_turned, runs);
    ours = show_job(&b, "surface of the level, f32", surface_floats, runs);
    printf("\n%llu triangles\n\n| job | least ms | median ms |\n|---|--:|--:|\n",
           (unsigned long long)b.triangles);
    show_job(&b, "surface of the level, i16", surface_shorts, runs);
    show_job(&b, "surface of the level, f32 with z fastest", surface_turned, runs);
    printf("\n");
    snprintf(path, sizeof path, "%s/volumes.ms", argv[2]);
    out = bench_open(path);
    fprintf(out, "%.3f\n", ours);
    fclose(out);
    free(shorts);
    bvx_volume_free(b.ctx, &volume);
    bvx_buffer_free(b.ctx, &file);
    bvx_mesh_free(b.ctx, &mesh);
    bvx_context_destroy(b.ctx);
    bench_memory_release(&memory);
    return b.sum != b.sum;
}
