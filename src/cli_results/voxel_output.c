/* voxel_output.c - voxels as the file that the output's ending tells: a grid, or the mesh of their surface.
 *
 * Where they were made from a mesh the surface is that mesh's wherever they still end where it does, walls
 * that were moved stand at their distance from it, and a drilled hole is round. All else lies half way
 * between a set and an empty centre. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

int cli_check_voxel_name(cli_run *run)
{
    return cli_check_rules(run, cli_to_voxels_rules, 0, NULL);
}

int cli_open_voxels(cli_run *run)
{
    const char *const out = run->options->output;
    return CLI_HOLDS(run, CLI_TO_MESH) ? cli_open_output(run, out) : cli_open_grid_output(run, out);
}

bvx_status cli_measure_source(cli_run *run, const bvx_mesh *source, const bvx_grid *solid, double far,
                              bvx_field *field)
{
    const bvx_lattice *const l = &solid->lattice;
    double const spacing = fmax(l->spacing[0], fmax(l->spacing[1], l->spacing[2]));

    bvx_field_options o = {.struct_size = sizeof o, .sign = BVX_FILL_NONE, .features = 1};
    o.half_width = 2.0 + far / spacing; /* both ends of an edge that the wall passes */
    memcpy(o.window.low, solid->low, sizeof o.window.low);
    memcpy(o.window.size, solid->size, sizeof o.window.size);
    bvx_mesh_view const view = cli_view(source);
    bvx_status const status = bvx_measure_field(run->context, &view, l, &o, field);
    if (status != BVX_OK) return status;

    field->inside = *solid;
    field->inside.owned = 0;
    field->sign = BVX_FILL_PARITY;
    return BVX_OK;
}

/* ---- A round hole ---- */

/* The lattice edge that has a point in its middle: its axis and low end in the window; -1: none. */
static int32_t edge_of_middle(const bvx_grid *g, const double p[3], int32_t low[3])
{
    int32_t axis = -1;

    for (int32_t a = 0; a < 3; a++) {
        double const q = (p[a] - g->lattice.origin[a]) / g->lattice.spacing[a] - g->low[a] - 0.5;
        double const part = q - floor(q);

        /* Half way between two centres along one axis, on a centre along the others; else no such edge. */
        if (fabs(part - 0.5) < 0.01) {
            if (axis >= 0) return -1;
            axis = a;
            low[a] = (int32_t)floor(q);
        } else if (part < 0.01 || part > 0.99) {
            low[a] = (int32_t)floor(q + 0.5);
        } else {
            return -1;
        }
    }
    return axis;
}

static int is_set(const bvx_grid *g, const int32_t v[3])
{
    for (int32_t a = 0; a < 3; a++)
        if (v[a] < 0 || v[a] >= g->size[a]) return 0;
    return bvx_grid_get(g, v[0], v[1], v[2]);
}

/* Vertices half way between drilled and left go onto the drill's cylinder, along their edges. */
static void round_hole(cli_voxels *v)
{
    const bvx_grid *const g = v->grid;

    for (uint64_t n = 0; n < v->mesh.vertex_count && v->drill.hole != NULL; n++) {
        int const wide = v->mesh.position_type == BVX_F64;
        double p[3];
        int32_t low[3], high[3];

        for (int a = 0; a < 3; a++)
            p[a] = wide ? ((double *)v->mesh.positions)[3 * n + (uint64_t)a]
                        : (double)((float *)v->mesh.positions)[3 * n + (uint64_t)a];
        int32_t const axis = edge_of_middle(g, p, low);
        /* Along the drill the wall is flat and stays half way. */
        if (axis < 0 || axis == v->drill.axis) continue;
        memcpy(high, low, sizeof high);
        high[axis]++;
        /* Both ends drilled or both left: the hole's wall does not pass here. */
        if (is_set(v->drill.hole, low) == is_set(v->drill.hole, high)) continue;

        /* Where the cylinder cuts the edge, as a part of it; beyond its ends it is kept inside. */
        int32_t const across = 3 - v->drill.axis - axis;
        double start[3], s;
        for (int32_t a = 0; a < 3; a++)
            start[a] = g->lattice.origin[a] + (g->low[a] + low[a] + 0.5) * g->lattice.spacing[a] -
                       v->drill.at[a];
        double const half = sqrt(
            fmax(0.0, v->drill.radius * v->drill.radius - start[across] * start[across]));
        double const middle = start[axis] + 0.5 * g->lattice.spacing[axis];
        s = ((middle < 0.0 ? -half : half) - start[axis]) / g->lattice.spacing[axis];
        p[axis] = g->lattice.origin[axis] +
                  (g->low[axis] + low[axis] + 0.5 + (s > 0.02 ? s < 0.98 ? s : 0.98 : 0.02)) *
                      g->lattice.spacing[axis];
        if (wide) ((double *)v->mesh.positions)[3 * n + (uint64_t)axis] = p[axis];
        else ((float *)v->mesh.positions)[3 * n + (uint64_t)axis] = (float)p[axis];
    }
}

static bvx_status make_surface_mesh(cli_run *run, cli_voxels *v)
{
    bvx_field own = {0};
    bvx_field_surface_options s = {.struct_size = sizeof s};

    if (v->source == NULL) {
        CLI_TRY(bvx_extract_surface(run->context, v->grid, NULL, &v->mesh));
        v->surface.edges = v->surface.own = v->surface.middle = v->mesh.vertex_count;
        return BVX_OK;
    }
    /* A command that moved walls has measured already, farther out. */
    if (v->field == NULL) CLI_TRY(cli_measure_source(run, v->source, v->solid, 0.0, &own));
    s.placing.sharp = cli_sharp(run->options);
    s.grid = v->grid;
    s.offset = v->offset;
    s.report = &v->surface;
    bvx_mesh_view const view = cli_view(v->source);
    bvx_status const status = bvx_extract_field_surface(run->context, v->field != NULL ? v->field : &own,
                                                        &view, &s, &v->mesh);
    bvx_field_free(run->context, &own);
    CLI_TRY(status);
    round_hole(v);
    return BVX_OK;
}

int cli_write_voxels(cli_run *run, cli_voxels *v)
{
    if (CLI_HOLDS(run, CLI_TO_MESH)) {
        CLI_TRY(CLI_STAGE(run, "surface", make_surface_mesh(run, v), cli_input_name(v->name)));
        if (v->mesh.triangle_count == 0)
            return cli_fail(run, "%s: the result is empty, so there is no surface to write",
                            cli_input_name(v->name));
        CLI_TRY(cli_reduce(run, &v->mesh, &v->reduction));
        CLI_TRY(cli_check_mesh(run, &v->mesh, 0, run->options->output, "check"));
        return cli_write_mesh(run, &v->mesh);
    }
    CLI_TRY(cli_check_grid_format(run, run->options->output, &v->grid->lattice));
    return v->labels_of != NULL ? cli_write_segments(run, v->grid, v->labels_of)
                                : cli_write_grid(run, v->grid);
}

void cli_tell_voxels(const cli_run *run, const cli_voxels *v, cli_made *made)
{
    const bvx_field_surface_report *const s = &v->surface;
    uint64_t const moved = s->own > s->middle ? s->own - s->middle : 0;
    cli_text *const t = &made->members;

    if (!CLI_HOLDS(run, CLI_TO_MESH)) return;
    if (v->source != NULL) {
        cli_tell(made, "  surface     %" PRIu64 " vertices on the mesh", s->edges - s->own);
        if (moved != 0) cli_tell(made, ", %" PRIu64 " at its distance %.9g", moved, fabs(v->offset));
        if (s->middle != 0) cli_tell(made, ", %" PRIu64 " half way between voxels", s->middle);
        cli_tell(made, "%s\n", s->sharp != 0 && s->edges > s->own ? "; sharp edges kept" : "");
    } else {
        cli_tell(made, "  surface     half way between set and empty voxels\n");
    }
    cli_text_add(t, ", \"voxel_surface\": {\"on_mesh\": %" PRIu64, s->edges - s->own);
    cli_json_count(t, "at_distance", moved);
    cli_json_count(t, "half_way", s->middle);
    cli_json_truth(t, "sharp", s->sharp != 0);
    cli_text_add(t, "}");
    cli_tell_reduction(&v->reduction, made);
    cli_tell_result(&run->report.mesh[0].certificate, made);
}

void cli_free_voxels(cli_run *run, cli_voxels *v)
{
    bvx_mesh_free(run->context, &v->mesh);
}
