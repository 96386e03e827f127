/* mesh_lattice.c - where the voxels of a mesh lie: --resolution, --spacing, --origin, --padding, --window. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { LATTICE_RESOLUTION = 256 };

static double coordinate_of(const bvx_mesh *mesh, uint32_t vertex, int axis)
{
    size_t const at = (size_t)vertex * 3 + (size_t)axis;
    return mesh->position_type == BVX_F32 ? (double)((const float *)mesh->positions)[at]
                                          : ((const double *)mesh->positions)[at];
}

void cli_mesh_box(const bvx_mesh *mesh, cli_box *box)
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = box->high[a] = mesh->triangle_count != 0 ? coordinate_of(mesh, mesh->triangles[0], a)
                                                               : 0.0;
        /* By triangles: a vertex that no triangle uses takes no room. */
        for (uint64_t i = 1; i < mesh->triangle_count * 3; i++) {
            double const p = coordinate_of(mesh, mesh->triangles[i], a);
            box->low[a] = p < box->low[a] ? p : box->low[a];
            box->high[a] = p > box->high[a] ? p : box->high[a];
        }
    }
}

void cli_join_boxes(cli_box *box, const cli_box *other)
{
    for (int a = 0; a < 3; a++) {
        box->low[a] = other->low[a] < box->low[a] ? other->low[a] : box->low[a];
        box->high[a] = other->high[a] > box->high[a] ? other->high[a] : box->high[a];
    }
}

/* What a lattice goes around: the first that is not NULL. */
typedef struct fit_target {
    const cli_box *box;
    const bvx_mesh_view *points, *mesh;
} fit_target;

static bvx_status fit_to(cli_run *run, const fit_target *target, const bvx_lattice_options *fit,
                         bvx_lattice *lattice)
{
    if (target->box != NULL)
        return bvx_lattice_fit_box(run->context, target->box->low, target->box->high, fit, lattice);
    if (target->points != NULL) return bvx_lattice_fit_points(run->context, target->points, fit, lattice);
    return bvx_lattice_fit_with(run->context, target->mesh, fit, lattice);
}

/* From a given corner up to the mesh's high end. */
static bvx_status lattice_from_origin(cli_run *run, const fit_target *target, bvx_lattice *lattice)
{
    const cli_options *const o = run->options;
    bvx_lattice_options fit;
    double spacing[3] = {o->spacing, o->spacing, o->spacing};
    int32_t dims[3];
    bvx_status status;

    bvx_lattice_options_init(&fit, sizeof fit);
    memcpy(fit.spacing, spacing, sizeof spacing);
    status = fit_to(run, target, &fit, lattice); /* its far end covers the mesh */
    if (status != BVX_OK) return status;
    for (int a = 0; a < 3; a++) {
        /* Rounded outwards, so that the last voxel covers the mesh's high end. */
        double const far_end = lattice->origin[a] + lattice->dims[a] * lattice->spacing[a];
        double const n = -floor((o->origin.value[a] - far_end) / o->spacing);
        dims[a] = n < 1.0 ? 1 : n > 2147483647.0 ? INT32_MAX : (int32_t)n;
    }
    return bvx_lattice_make(run->context, o->origin.value, spacing, dims, lattice);
}

static bvx_status make_lattice(cli_run *run, const fit_target *target, bvx_lattice *lattice)
{
    const cli_options *const o = run->options;
    bvx_lattice_options fit;

    if (o->origin.given) return lattice_from_origin(run, target, lattice);
    bvx_lattice_options_init(&fit, sizeof fit);
    fit.padding = o->padding;
    /* Rows exclude each other already: the first that is given decides. */
    if (o->spacing != 0.0)
        for (int a = 0; a < 3; a++) fit.spacing[a] = o->spacing;
    else if (o->resolution.count == 3)
        for (int a = 0; a < 3; a++) fit.axis_resolution[a] = (int32_t)o->resolution.value[a];
    else fit.resolution = o->resolution.count == 1 ? (int32_t)o->resolution.value[0] : LATTICE_RESOLUTION;
    return fit_to(run, target, &fit, lattice);
}

bvx_status cli_make_box_lattice(cli_run *run, const cli_box *box, bvx_lattice *lattice)
{
    fit_target const target = {.box = box};

    return make_lattice(run, &target, lattice);
}

bvx_status cli_make_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    fit_target const target = {.mesh = view};

    return make_lattice(run, &target, lattice);
}

bvx_status cli_make_cloud_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    fit_target const target = {.points = view};

    return make_lattice(run, &target, lattice);
}

int cli_window_option(cli_run *run, bvx_window *window)
{
    const cli_list *const l = &run->options->window;

    memset(window, 0, sizeof *window);
    for (int a = 0; a < 3 && l->count != 0; a++) {
        /* Ends are excluded, as in slices of arrays. */
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
