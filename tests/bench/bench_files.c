/* bench_files.c - files to meshes and grids and back: bench_files MESH.ply.gz OUT_FOLDER [RUNS].
 *
 * From bytes in memory to arrays and back, warm, one thread, least of the runs. Prints one line of JSON a job
 * and leaves the files in OUT_FOLDER/files, so that others can be timed on the very same bytes. */
#include "bench.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

enum { FINE = 512 };

typedef struct format_case {
    int32_t format;
    const char *name;
} format_case;

static void say(const char *job, const char *name, uint64_t bytes, const bench_times *t)
{
    double const ms = bench_min(t);
    printf("{\"job\": \"%s\", \"name\": \"%s\", \"bytes\": %" PRIu64 ", \"ms\": %.3f, \"mb_per_s\": %.0f}\n",
           job, name, bytes, ms, (double)bytes / 1e3 / ms);
    fflush(stdout);
}

static void keep(const char *folder, const char *name, const void *bytes, uint64_t size)
{
    char path[1024];
    FILE *file;

    snprintf(path, sizeof path, "%s/files/%s", folder, name);
    file = bench_open(path);
    if (fwrite(bytes, 1, (size_t)size, file) != size || fclose(file) != 0) {
        fprintf(stderr, "bench_files: %s cannot be written\n", path);
        exit(1);
    }
}

static void time_mesh_read(bvx_context *ctx, const char *name, const void *bytes, uint64_t size,
                           int32_t format, int runs)
{
    static bench_times t;

    t.count = 0;
    for (int i = 0; i < runs; i++) {
        bvx_mesh mesh = {0};
        double const start = bench_clock(1);
        bvx_status const status = bvx_read_mesh(ctx, bytes, size, format, NULL, &mesh);
        bench_add(&t, bench_clock(1) - start);
        bench_try(ctx, status, name);
        bvx_mesh_free(ctx, &mesh);
    }
    say("read", name, size, &t);
}

static void time_mesh_formats(bvx_context *ctx, const char *path, const char *folder, int runs)
{
    static const format_case cases[] = {{BVX_FORMAT_PLY, "dragon.ply"},
                                        {BVX_FORMAT_STL, "dragon.stl"},
                                        {BVX_FORMAT_OBJ, "dragon.obj"},
                                        {BVX_FORMAT_OFF, "dragon.off"},
                                        {BVX_FORMAT_GLB, "dragon.glb"}};
    size_t size;
    uint8_t *const original = bench_read_file(path, &size);
    bvx_mesh mesh = {0};

    if (original == NULL) exit(1);
    bench_try(ctx, bvx_read_mesh(ctx, original, size, BVX_FORMAT_PLY, NULL, &mesh), path);
    keep(folder, "dragon_ascii.ply", original, size);
    time_mesh_read(ctx, "dragon_ascii.ply", original, size, BVX_FORMAT_PLY, runs);
    free(original);
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        static bench_times t;
        bvx_buffer file = {0};
        t.count = 0;
        for (int i = 0; i < runs; i++) {
            bvx_buffer_free(ctx, &file);
            double const start = bench_clock(1);
            bvx_status const status = bvx_write_mesh(ctx, &mesh, 1, NULL, cases[c].format, &file);
            bench_add(&t, bench_clock(1) - start);
            bench_try(ctx, status, cases[c].name);
        }
        say("write", cases[c].name, file.size, &t);
        keep(folder, cases[c].name, file.bytes, file.size);
        if (cases[c].format != BVX_FORMAT_GLB)
            time_mesh_read(ctx, cases[c].name, file.bytes, file.size, cases[c].format, runs);
        bvx_buffer_free(ctx, &file);
    }
    bvx_mesh_free(ctx, &mesh);
}

static void time_grid_formats(bvx_context *ctx, const char *path, int runs)
{
    static const format_case cases[] = {{BVX_FORMAT_BVX, "512.bvx"},
                                        {BVX_FORMAT_NPY, "512.npy"},
                                        {BVX_FORMAT_BINVOX, "512.binvox"},
                                        {BVX_FORMAT_NRRD, "512.nrrd"},
                                        {BVX_FORMAT_VTI, "512.vti"}};
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid solid = {0};

    if (!bench_read_mesh(ctx, path, &mesh)) exit(1);
    bvx_mesh_view_of(&mesh, &view);
    bench_try(ctx, bvx_lattice_fit(ctx, &view, FINE, &lattice), "lattice");
    bench_try(ctx, bvx_voxelize_solid(ctx, &view, &lattice, NULL, &solid), "solid");
    for (size_t c = 0; c < sizeof cases / sizeof *cases; c++) {
        static bench_times write, read;
        bvx_buffer file = {0};
        write.count = read.count = 0;
        for (int i = 0; i < runs; i++) {
            bvx_grid back = {0};
            double start;
            bvx_buffer_free(ctx, &file);
            start = bench_clock(1);
            bench_try(ctx, bvx_write_grid(ctx, &solid, cases[c].format, &file), cases[c].name);
            bench_add(&write, bench_clock(1) - start);
            start = bench_clock(1);
            bench_try(ctx, bvx_read_grid(ctx, file.bytes, file.size, cases[c].format, NULL, &back),
                      cases[c].name);
            bench_add(&read, bench_clock(1) - start);
            if (memcmp(back.words, solid.words, (size_t)bvx_grid_bound(&solid.lattice, NULL) * 8) != 0) {
                fprintf(stderr, "bench_files: %s changed the voxels\n", cases[c].name);
                exit(1);
            }
            bvx_grid_free(ctx, &back);
        }
        say("write grid", cases[c].name, file.size, &write);
        say("read grid", cases[c].name, file.size, &read);
        bvx_buffer_free(ctx, &file);
    }
    bvx_grid_free(ctx, &solid);
    bvx_mesh_free(ctx, &mesh);
}

int main(int argc, char **argv)
{
    static bench_memory memory;
    int const runs = argc > 3 ? atoi(argv[3]) : 9;
    bvx_context *ctx;

    if (argc < 3 || runs < 1) {
        fprintf(stderr, "usage: bench_files MESH.ply.gz OUT_FOLDER [RUNS]\n");
        return 2;
    }
    ctx = bench_context(1, BVX_CPU_BEST, &memory);
    time_mesh_formats(ctx, argv[1], argv[2], runs);
    time_grid_formats(ctx, argv[1], runs);
    bvx_context_destroy(ctx);
    bench_memory_release(&memory);
    return 0;
}
