/* mesh_lattice.c - where the voxels of a mesh lie: --resolution, --spacing, --origin, --padding, --window;
 * and whether a few points far from all others make them many. */
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

/* From a given corner up to the mesh's high end. */
static bvx_status lattice_from_origin(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    const cli_options *const o = run->options;
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

bvx_status cli_make_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    const cli_options *const o = run->options;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    if (o->origin.given) return lattice_from_origin(run, view, lattice);
    fit.padding = o->padding;
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

/* ---- points far from all others ---- */

/* One of them must not cost memory by the size of the box around all. With --spacing a lattice is as large
 * as the box. Where it is large, and mostly for the sake of a few points that lie many times as far from
 * the others as these lie from each other, the command refuses it and names them. The others are looked
 * for among some thousand points: between the places that a twentieth of them lies below and above. */

enum { FAR_SAMPLES = 4096, FAR_TIMES = 50, FAR_SHARE = 100, FAR_SAVED = 16, NEAR_VOXELS = 8 };

#define FAR_BYTES 268435456.0 /* smaller lattices are made, whatever they are for */

typedef struct far_points {
    const bvx_mesh_view *view;
    int cloud;
    uint64_t count;                   /* corners of triangles, or points */
    double low[3], high[3];           /* what lies beyond is far */
    double near_low[3], near_high[3]; /* box of the others */
    uint64_t far, first;              /* how many, and the number of the first */
    double at[3];
} far_points;

/* The vertex that corner number i is, or point number i. */
static uint64_t vertex_of(const far_points *f, uint64_t i)
{
    return f->cloud || f->view->indices == NULL ? i : ((const uint32_t *)f->view->indices)[i];
}

int cli_compare_doubles(const void *a, const void *b)
{
    double const x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The box beyond which points are far. 0 without memory. */
static int find_near_box(far_points *f)
{
    uint64_t const n = f->count < FAR_SAMPLES ? f->count : FAR_SAMPLES;
    double *const value = malloc((size_t)n * 3 * sizeof *value);
    double span = 0.0;

    if (value == NULL) return 0;
    /* A sample, evenly over the file, is enough to find where most points lie. */
    for (uint64_t i = 0; i < n; i++) {
        double p[3];
        position_of(f->view->positions, f->view->position_type,
                    vertex_of(f, (uint64_t)((double)i * (double)f->count / (double)n)), p);
        for (uint64_t a = 0; a < 3; a++) value[a * n + i] = p[a];
    }
    for (uint64_t a = 0; a < 3; a++) {
        qsort(value + a * n, (size_t)n, sizeof *value, cli_compare_doubles);
        f->low[a] = value[a * n + n / 20];
        f->high[a] = value[a * n + n - 1 - n / 20];
        /* A twentieth at either end may be far without moving the box. */
        span = fmax(span, f->high[a] - f->low[a]);
    }
    /* By the longest span, so that a flat mesh is not far from itself. */
    for (int a = 0; a < 3; a++) {
        f->low[a] -= FAR_TIMES * span;
        f->high[a] += FAR_TIMES * span;
    }
    free(value);
    return 1;
}

static int is_beyond(const far_points *f, const double p[3])
{
    return p[0] < f->low[0] || p[0] > f->high[0] || p[1] < f->low[1] || p[1] > f->high[1] ||
           p[2] < f->low[2] || p[2] > f->high[2];
}

/* Far points by number: a vertex counts once for each triangle, harmless in a share. */
static void count_far(far_points *f)
{
    double p[3];
    uint64_t v = 0;

    /* Most meshes have no vertex there; then corners, six times as many, need no look. */
    for (; v < f->view->vertex_count; v++) {
        position_of(f->view->positions, f->view->position_type, v, p);
        if (is_beyond(f, p)) break;
    }
    if (v == f->view->vertex_count) return;
    for (int a = 0; a < 3; a++) {
        f->near_low[a] = HUGE_VAL;
        f->near_high[a] = -HUGE_VAL;
    }
    for (uint64_t i = 0; i < f->count; i++) {
        uint64_t const vertex = vertex_of(f, i);
        position_of(f->view->positions, f->view->position_type, vertex, p);
        int const beyond = is_beyond(f, p);
        if (beyond && f->far++ == 0) {
            f->first = vertex;
            memcpy(f->at, p, sizeof f->at);
        }
        for (int a = 0; a < 3 && !beyond; a++) {
            f->near_low[a] = fmin(f->near_low[a], p[a]);
            f->near_high[a] = fmax(f->near_high[a], p[a]);
        }
    }
}

/* Two ways in which far points do harm. By --resolution one costs no memory, but leaves the others a few voxels:
 * where they lie in fewer than NEAR_VOXELS along each axis of a lattice that has many more. */
int cli_check_far(cli_run *run, const char *path, const bvx_mesh_view *view, int cloud,
                  const bvx_lattice *lattice)
{
    const char *const what = cloud ? "point" : "vertex", *const name = cli_input_name(path);
    double bytes = 8.0, near = 8.0, most = 0.0, limit = (double)run->context_limit;
    far_points f = {.view = view, .cloud = cloud};
    int32_t longest = 0;

    f.count = cloud ? view->vertex_count : view->triangle_count * 3;
    if (f.count == 0 || !find_near_box(&f)) return CLI_DONE;
    count_far(&f);
    /* Many far points are a shape of two parts, not a mistake. */
    if (f.far == 0 || f.far > f.count / FAR_SHARE) return CLI_DONE;
    for (int a = 0; a < 3; a++) {
        double const length = (f.near_high[a] - f.near_low[a]) / lattice->spacing[a], n = floor(length) + 1.0;
        most = fmax(most, length);
        longest = lattice->dims[a] > longest ? lattice->dims[a] : longest;
        bytes *= a == 0 ? ceil(lattice->dims[a] / 64.0) : (double)lattice->dims[a];
        near *= a == 0 ? ceil(n / 64.0) : n;
    }

    const char *const more = f.far == 1 ? "" : ", and it is not the only one";
    if (most < NEAR_VOXELS && longest >= 4 * NEAR_VOXELS)
        cli_warn(run, BVX_WARN_FAR,
                 "%s: %s %" PRIu64
                 " at %.9g, %.9g, %.9g lies far from the others%s, which are %.2g of %" PRId32
                 " voxels long; take it out of the file, or choose voxels by --spacing",
                 name, what, f.first, f.at[0], f.at[1], f.at[2], more, most, longest);
    if (bytes < FAR_BYTES || bytes <= limit || near * FAR_SAVED > bytes) return CLI_DONE;
    return cli_fail(
        run,
        "%s: %s %" PRIu64 " at %.9g, %.9g, %.9g lies far from the others%s: a lattice of %" PRId32
        " x %" PRId32 " x %" PRId32
        " voxels around both takes %.3g bytes, without it %.3g; take it out of the file, or allow so much "
        "by --memory-limit",
        name, what, f.first, f.at[0], f.at[1], f.at[2], more, lattice->dims[0], lattice->dims[1],
        lattice->dims[2], bytes, near);
}
