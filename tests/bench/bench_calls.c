/* bench_calls.c - what a call costs by itself: the smallest call of each kind, on a tetrahedron and four voxels a side.
 *
 *   bench_calls [BATCHES]
 *
 * Prints Markdown: nanoseconds a call, the least of so many batches [200], each of about a millisecond; results are freed within it. */
#include "bench.h"

#include <stdlib.h>
#include <string.h>

static bvx_context *ctx;
static bvx_mesh_view mesh;
static bvx_lattice lattice;
static bvx_grid solid, made;
static bvx_closest *closest;
static bvx_buffer file;

static float const corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static uint32_t const triangle[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

/* ---- calls: each returns 1 when its status is as it must be ---- */

static int make_context(void)
{
    bvx_context *one;
    int const good = bvx_context_create(NULL, &one) == BVX_OK;

    bvx_context_destroy(one);
    return good;
}

static int make_lattice(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {4, 4, 4};
    bvx_lattice l;

    return bvx_lattice_make(ctx, origin, spacing, dims, &l) == BVX_OK;
}

static int fit_lattice(void)
{
    bvx_lattice l;

    return bvx_lattice_fit(ctx, &mesh, 4, &l) == BVX_OK;
}

static int count_voxels(void)
{
    uint64_t count;

    return bvx_grid_count(ctx, &solid, &count) == BVX_OK;
}

static int unite_grids(void)
{
    return bvx_grid_combine(ctx, &solid, &solid, BVX_BOOLEAN_UNION, &made) == BVX_OK;
}

static int dilate_grid(void)
{
    return bvx_grid_morph(ctx, &solid, BVX_MORPH_DILATE, NULL, &made) == BVX_OK;
}

static int count_parts(void)
{
    uint64_t count;

    return bvx_grid_components(ctx, &solid, 6, NULL, 0, &count) == BVX_OK;
}

static int voxelize(void)
{
    return bvx_voxelize_solid(ctx, &mesh, &lattice, NULL, &made) == BVX_OK;
}

static int voxelize_surface(void)
{
    return bvx_voxelize_surface(ctx, &mesh, &lattice, NULL, &made) == BVX_OK;
}

static int extract_surface(void)
{
    bvx_mesh m = {0};
    int const good = bvx_extract_surface(ctx, &solid, NULL, &m) == BVX_OK;

    bvx_mesh_free(ctx, &m);
    return good;
}

static int measure_field(void)
{
    bvx_field f = {0};
    int const good = bvx_measure_field(ctx, &mesh, &lattice, NULL, &f) == BVX_OK;

    bvx_field_free(ctx, &f);
    return good;
}

static int check_mesh(void)
{
    bvx_certificate c;

    return bvx_mesh_check(ctx, &mesh, 0, &c) == BVX_OK;
}

static int find_closest(void)
{
    static const double point[3] = {2, 2, 2};
    bvx_closest_point found;

    return bvx_closest_find(ctx, closest, point, 1, &found) == BVX_OK;
}

static int read_file(void)
{
    bvx_mesh m = {0};
    int const good = bvx_read_mesh(ctx, file.bytes, file.size, BVX_FORMAT_PLY, NULL, &m) == BVX_OK;

    bvx_mesh_free(ctx, &m);
    return good;
}

static int refuse_null(void)
{
    bvx_lattice l;

    return bvx_lattice_fit(ctx, NULL, 4, &l) == BVX_ERR_ARGUMENT;
}

static int refuse_option(void)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};

    o.close_gaps = -1;
    return bvx_voxelize_solid(ctx, &mesh, &lattice, &o, &made) == BVX_ERR_ARGUMENT;
}

static const struct {
    const char *name;
    int (*call)(void);
} calls[] = {{"context, made and destroyed", make_context},
             {"bvx_lattice_make", make_lattice},
             {"bvx_lattice_fit", fit_lattice},
             {"bvx_grid_count", count_voxels},
             {"bvx_grid_combine, into itself again", unite_grids},
             {"bvx_grid_morph", dilate_grid},
             {"bvx_grid_components", count_parts},
             {"bvx_voxelize_solid", voxelize},
             {"bvx_voxelize_surface", voxelize_surface},
             {"bvx_extract_surface", extract_surface},
             {"bvx_measure_field", measure_field},
             {"bvx_mesh_check", check_mesh},
             {"bvx_closest_find, one point", find_closest},
             {"bvx_read_mesh, PLY", read_file},
             {"refused: NULL", refuse_null},
             {"refused: an option out of range", refuse_option}};
enum { CALLS = sizeof calls / sizeof calls[0] };

/* ---- running ---- */

static double milliseconds_of(int (*call)(void), int times)
{
    double const start = bench_clock(1);

    for (int i = 0; i < times; i++)
        if (!call()) abort();
    return bench_clock(1) - start;
}

static void prepare(void)
{
    bvx_mesh whole = {0};

    mesh = (bvx_mesh_view){.positions = corner,
                           .indices = triangle,
                           .vertex_count = 4,
                           .triangle_count = 4,
                           .position_type = BVX_F32,
                           .index_type = BVX_U32};
    if (bvx_context_create(NULL, &ctx) != BVX_OK || bvx_lattice_fit(ctx, &mesh, 4, &lattice) != BVX_OK ||
        bvx_voxelize_solid(ctx, &mesh, &lattice, NULL, &solid) != BVX_OK ||
        bvx_closest_create(ctx, &mesh, &closest) != BVX_OK ||
        bvx_extract_surface(ctx, &solid, NULL, &whole) != BVX_OK ||
        bvx_write_mesh(ctx, &whole, 1, NULL, BVX_FORMAT_PLY, &file) != BVX_OK) {
        fprintf(stderr, "bench_calls: %s\n", bvx_last_message(ctx));
        exit(1);
    }
    bvx_mesh_free(ctx, &whole);
}

int main(int argc, char **argv)
{
    int const batches = argc > 1 ? atoi(argv[1]) : 200;

    prepare();
    printf("| the smallest call | ns |\n|---|--:|\n");
    for (int i = 0; i < CALLS; i++) {
        double const once = milliseconds_of(calls[i].call, 100) / 100.0;
        int const times = once < 0.001 ? 1000 : once > 1.0 ? 1 : (int)(1.0 / once);
        double least = 1e300;

        for (int k = 0; k < batches; k++) {
            double const ms = milliseconds_of(calls[i].call, times) / times;
            if (ms < least) least = ms;
        }
        printf("| %s | %.0f |\n", calls[i].name, least * 1e6);
    }
    bvx_closest_free(ctx, closest);
    bvx_buffer_free(ctx, &file);
    bvx_grid_free(ctx, &made);
    bvx_grid_free(ctx, &solid);
    bvx_context_destroy(ctx);
    return 0;
}
