/* mesh_lattice.c - where the voxels of a mesh lie: --resolution, --spacing, --origin, --padding, --window;
 * and whether a point far from most others leaves these few. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LATTICE_RESOLUTION = 256 };

static inline void position_of(const void *positions, uint32_t type, uint64_t vertex, double p[3])
{
    const float *const f = (const float *)positions + 3 * (size_t)vertex;
    const double *const d = (const double *)positions + 3 * (size_t)vertex;
    /* Unrolled by hand: the program, unlike the library, is built with -O1. */
    p[0] = type == BVX_F32 ? (double)f[0] : d[0];
    p[1] = type == BVX_F32 ? (double)f[1] : d[1];
    p[2] = type == BVX_F32 ? (double)f[2] : d[2];
}

static inline void widen(double x, double *low, double *high)
{
    *low = x < *low ? x : *low;
    *high = x > *high ? x : *high;
}

void cli_mesh_box(const bvx_mesh *mesh, cli_box *box)
{
    cli_box b = {{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}};
    double p[3];

    if (mesh->triangle_count != 0) {
        position_of(mesh->positions, (uint32_t)mesh->position_type, mesh->triangles[0], b.low);
        memcpy(b.high, b.low, sizeof b.high);
    }
    /* By triangles: a vertex that no triangle uses takes no room. */
    for (uint64_t i = 0; i < mesh->triangle_count * 3; i++) {
        position_of(mesh->positions, (uint32_t)mesh->position_type, mesh->triangles[i], p);
        widen(p[0], &b.low[0], &b.high[0]);
        widen(p[1], &b.low[1], &b.high[1]);
        widen(p[2], &b.low[2], &b.high[2]);
    }
    *box = b;
}

void cli_box_of_points(const void *positions, int32_t type, uint64_t count, cli_box *box)
{
    double p[3];
    for (int a = 0; a < 3; a++) {
        box->low[a] = HUGE_VAL;
        box->high[a] = -HUGE_VAL;
    }
    for (uint64_t i = 0; i < count; i++) {
        position_of(positions, (uint32_t)type, i, p);
        for (int a = 0; a < 3; a++) widen(p[a], &box->low[a], &box->high[a]);
    }
}

void cli_join_boxes(cli_box *box, const cli_box *other)
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = other->low[a] < box->low[a] ? other->low[a] : box->low[a];
        box->high[a] = other->high[a] > box->high[a] ? other->high[a] : box->high[a];
    }
}

bvx_mesh_view cli_corners_of_box(const cli_box *box)
{
    return (bvx_mesh_view){.positions = box, .vertex_count = 2, .position_type = BVX_F64};
}

bvx_status cli_make_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    const cli_options *const o = run->options;
    if (o->origin.given) {
        bvx_lattice_options fit = {.struct_size = sizeof fit};
        double spacing[3] = {o->spacing, o->spacing, o->spacing};
        int32_t dims[3];

        memcpy(fit.spacing, spacing, sizeof spacing);
        bvx_status const status = bvx_lattice_fit_with(run->context, view, &fit,
                                                       lattice); /* its far end covers the mesh */
        if (status != BVX_OK) return status;
        for (int a = 0; a < 3; a++) {
            /* Rounded outwards, so that the last voxel covers the mesh's high end. */
            double const far_end = lattice->origin[a] + lattice->dims[a] * lattice->spacing[a];
            double const n = -floor((o->origin.value[a] - far_end) / o->spacing);
            dims[a] = n < 1.0 ? 1 : n > 2147483647.0 ? INT32_MAX : (int32_t)n;
        }
        return bvx_lattice_make(run->context, o->origin.value, spacing, dims, lattice);
    }
    bvx_lattice_options fit = {.struct_size = sizeof fit, .padding = o->padding};
    if (o->spacing != 0.0)
        for (int a = 0; a < 3; a++) fit.spacing[a] = o->spacing;
    else if (o->resolution.count == 3)
        for (int a = 0; a < 3; a++) fit.axis_resolution[a] = (int32_t)o->resolution.value[a];
    else fit.resolution = o->resolution.count == 1 ? (int32_t)o->resolution.value[0] : LATTICE_RESOLUTION;
    return bvx_lattice_fit_with(run->context, view, &fit, lattice);
}

int cli_window_option(cli_run *run, bvx_window *window)
{
    const cli_list *const l = &run->options->window;
    memset(window, 0, sizeof *window);
    for (int a = 0; a < 3 && l->count != 0; a++) {
        if (l->value[a] >= l->value[a + 3])
            return cli_usage(run, "--window is empty: it ends at %" PRId64 ", not after %" PRId64,
                             l->value[a + 3], l->value[a]);
        window->low[a] = (int32_t)l->value[a];
        window->size[a] = (int32_t)(l->value[a + 3] - l->value[a]);
    }
    return CLI_DONE;
}

double cli_diagonal(const double low[3], const double high[3])
{
    double longest = 0.0, sum = 0.0;
    for (int a = 0; a < 3; a++) longest = high[a] - low[a] > longest ? high[a] - low[a] : longest;
    for (int a = 0; a < 3 && longest > 0.0; a++) { /* squares of large sides would be infinite */
        double const side = (high[a] - low[a]) / longest;
        sum += side * side;
    }
    return longest * sqrt(sum);
}

/* ---- points far from most others ---- */

enum { FAR_SAMPLES = 4096, FAR_TIMES = 50, NEAR_VOXELS = 8 };

#define FAR_BYTES 268435456.0 /* smaller lattices are made, whatever they are for */

int cli_compare_doubles(const void *a, const void *b)
{
    double const x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Between the places that a twentieth of some thousand points lies below and above. 0 without memory. */
static int find_near_box(const bvx_mesh_view *view, cli_box *box)
{
    uint64_t const n = view->vertex_count < FAR_SAMPLES ? view->vertex_count : FAR_SAMPLES;
    double *const value = malloc((size_t)n * 3 * sizeof *value);

    if (value == NULL) return 0;
    for (uint64_t i = 0; i < n; i++) {
        double p[3];
        position_of(view->positions, view->position_type,
                    (uint64_t)((double)i * (double)view->vertex_count / (double)n), p);
        for (uint64_t a = 0; a < 3; a++) value[a * n + i] = p[a];
    }
    for (uint64_t a = 0; a < 3; a++) {
        qsort(value + a * n, (size_t)n, sizeof *value, cli_compare_doubles);
        box->low[a] = value[a * n + n / 20];
        box->high[a] = value[a * n + n - 1 - n / 20];
    }
    free(value);
    return 1;
}

/* By --spacing such a point makes the lattice large, by --resolution it leaves the others a few voxels. */
int cli_check_far(cli_run *run, const char *path, const bvx_mesh_view *view, const bvx_lattice *lattice)
{
    double most = 0.0, farthest = 0.0, bytes = 0.125, p[3], at[3] = {0, 0, 0};
    uint64_t far = 0;
    int32_t longest = 0;
    cli_box near;

    if (view->vertex_count == 0 || !find_near_box(view, &near)) return CLI_DONE;
    for (int a = 0; a < 3; a++) {
        most = fmax(most, (near.high[a] - near.low[a]) / lattice->spacing[a]);
        longest = lattice->dims[a] > longest ? lattice->dims[a] : longest;
        bytes *= lattice->dims[a];
    }
    int const large = bytes > FAR_BYTES && bytes > (double)run->context_limit;
    if (longest < FAR_TIMES * most || (!large && (most >= NEAR_VOXELS || longest < 4 * NEAR_VOXELS)))
        return CLI_DONE;
    for (uint64_t v = 0; v < view->vertex_count; v++) {
        double beyond = 0.0;
        position_of(view->positions, view->position_type, v, p);
        for (int a = 0; a < 3; a++) beyond = fmax(beyond, fmax(near.low[a] - p[a], p[a] - near.high[a]));
        if (!(beyond > farthest)) continue;
        farthest = beyond;
        far = v;
        memcpy(at, p, sizeof at);
    }
    if (large)
        return cli_fail(run,
                        "%s: point %" PRIu64
                        " at %.9g, %.9g, %.9g lies far from most others: a lattice around "
                        "all takes %.3g bytes; take it out of the file, or allow so much by --memory-limit",
                        cli_input_name(path), far, at[0], at[1], at[2], bytes);
    cli_warn(run, BVX_WARN_FAR,
             "%s: point %" PRIu64 " at %.9g, %.9g, %.9g lies far from most others, which are %.2g of %" PRId32
             " voxels long; take it out of the file, or choose voxels by --spacing",
             cli_input_name(path), far, at[0], at[1], at[2], most, longest);
    return CLI_DONE;
}
