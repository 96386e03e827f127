/* lod_input.c - what a chain of levels is made from: the solid of a mesh, at a resolution that suits its levels, or a grid
 * as it is, whose own surface then stands for the mesh. */
#include "cli/lod_chain.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { RATIO_WANTED = 8 };

#define GRID_BYTES_DEFAULT (UINT64_C(1) << 30) /* most bytes of the grid without --memory-limit */

/* Samples along the longest axis. A small grid gives smaller levels than usual, since none can be finer than it. */
int32_t cli_level_resolution(const cli_run *run, const cli_chain *c, int level)
{
    int32_t const finest = c->kind == CLI_GRID && c->resolution < 64 ? c->resolution : 64, usual = finest >> level;
    return run->options.levels.count != 0 ? (int32_t)run->options.levels.value[level] : usual > 0 ? usual : 1;
}

/* ---- the solid ---- */

/* Samples along the longest axis of the finest level. For a count of triangles: marching cubes makes about three for
 * each square of the surface as large as a sample. */
static double finest_level(const cli_run *run, const cli_chain *c)
{
    double finest = 1.0, longest = 0.0;
    if (c->by_triangles && !(c->certificate.area > 0.0)) return finest;
    if (!c->by_triangles) {
        for (int i = 0; i < c->count; i++) finest = cli_level_resolution(run, c, i) > finest ? cli_level_resolution(run, c, i) : finest;
        return finest;
    }
    for (int a = 0; a < 3; a++)
        longest = c->certificate.high[a] - c->certificate.low[a] > longest ? c->certificate.high[a] - c->certificate.low[a] : longest;
    for (int i = 0; i < c->count; i++) {
        double const more = run->options.collapse != 0.0 ? run->options.collapse : 1.0; /* before edges collapse */
        double const squares = (double)run->options.triangles.value[i] * more / 3.0;
        double const r = sqrt(squares * longest * longest / c->certificate.area);
        finest = r > finest ? r : finest;
    }
    return floor(finest + 0.5);
}

static bvx_status fit(cli_run *run, const cli_chain *c, int32_t resolution, bvx_lattice *lattice)
{
    bvx_lattice_options o;
    bvx_lattice_options_init(&o, sizeof o);
    o.resolution = resolution;
    o.padding = run->options.padding;
    return bvx_lattice_fit_with(run->context, &c->view, &o, lattice);
}

/* Bytes that the solid may take: half of what the limit leaves beside the mesh and its snapped copy; the other half is
 * for rows in work, for the levels and for checking them. */
static uint64_t room_for_solid(const cli_run *run, const cli_chain *c)
{
    uint64_t const beside = bvx_memory_used(run->context) + 16 * c->view.vertex_count + 4 * c->view.triangle_count;
    if (run->context_limit == 0) return GRID_BYTES_DEFAULT;
    return run->context_limit > beside ? (run->context_limit - beside) / 2 : 0;
}

/* The resolution of the solid: given, or RATIO_WANTED times the finest level where memory allows, else what it allows,
 * and never below the finest level. */
static int choose_resolution(cli_run *run, cli_chain *c)
{
    double const finest = finest_level(run, c), wanted = finest * RATIO_WANTED;
    uint64_t const room = room_for_solid(run, c);
    int32_t low, high; /* low is taken in any case */
    if (run->options.resolution.count != 0) {
        c->resolution = (int32_t)run->options.resolution.value[0];
        c->chosen = "given";
        return CLI_DONE;
    }
    low = finest < 33554432.0 ? (int32_t)finest : 33554432;
    high = wanted < 33554432.0 ? (int32_t)wanted : 33554432;
    c->chosen = "8 x the finest level";
    for (int32_t try = high; low < high; try = low + (high - low + 1) / 2) {
        bvx_lattice lattice;
        bvx_status const status = fit(run, c, try, &lattice);
        uint64_t const words = status == BVX_OK ? bvx_grid_bound(&lattice, NULL) : UINT64_MAX;
        if (status != BVX_OK && status != BVX_ERR_RANGE) return cli_fail_status(run, status, cli_input_name(run->options.input[0]));
        if (words <= room / 8) {
            low = try;
        } else {
            high = try - 1;
            c->chosen = "what memory allows";
        }
    }
    c->resolution = low;
    return CLI_DONE;
}

static int count_solid(cli_run *run, const cli_chain *c)
{
    bvx_grid_count(run->context, &c->solid, &run->report.set);
    run->report.has_set = 1;
    if (run->report.set != 0) return CLI_DONE;
    return cli_fail(run, c->kind == CLI_GRID ? "%s: no voxel is set; nothing is there to make levels of"
                                             : "%s: no voxel's centre lies inside the mesh; nothing is left to make levels of",
                    cli_input_name(run->options.input[0]));
}

static int make_solid(cli_run *run, cli_chain *c)
{
    const char *const path = cli_input_name(run->options.input[0]);
    bvx_voxelize_options v;
    bvx_status status;
    int result;
    cli_stage_begin(run, "check input");
    status = bvx_mesh_check(run->context, &c->view, 1, &c->certificate); /* the solid asks for places, not for numbers */
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    c->diagonal = cli_diagonal(c->certificate.low, c->certificate.high);
    if (choose_resolution(run, c) != CLI_DONE) return CLI_FAILED;
    cli_stage_begin(run, "voxelize");
    status = fit(run, c, c->resolution, &run->report.lattice);
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    run->report.has_lattice = 1;
    bvx_voxelize_options_init(&v, sizeof v);
    cli_take_fill(run, &v);
    v.report = &c->solid_report;
    status = bvx_voxelize_solid(run->context, &c->view, &run->report.lattice, &v, &c->solid);
    c->solid_seconds = cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    result = count_solid(run, c);
    if (result == CLI_DONE) cli_warn_of_solid(run, &c->solid, &c->solid_report);
    return result;
}

static int open_mesh(cli_run *run, cli_chain *c)
{
    int const status = cli_read_mesh(run, run->options.input[0], &c->input);
    if (status != CLI_DONE) return status;
    if (cli_check_carry(run, &c->input) != CLI_DONE) return CLI_USAGE;
    c->input_triangles = c->input.triangle_count;
    bvx_mesh_view_of(&c->input, &c->view);
    return make_solid(run, c);
}

/* The surface of all voxels; only its count where nothing is measured. */
static bvx_status surface_of_solid(cli_run *run, cli_chain *c)
{
    bvx_extract_options e;
    uint64_t vertices;
    bvx_status status;
    bvx_extract_options_init(&e, sizeof e);
    e.position_type = BVX_POSITION_AUTO;
    if (run->options.samples == 0)
        return bvx_extract_count(run->context, &c->solid, &e, &vertices, &c->input_triangles);
    status = bvx_extract_surface(run->context, &c->solid, &e, &c->input);
    c->input_triangles = c->input.triangle_count;
    return status;
}

static int open_grid(cli_run *run, cli_chain *c)
{
    const char *const path = run->options.input[0];
    double low[3], high[3];
    int placed, result = cli_read_grid(run, path, NULL, &c->solid, &placed);
    bvx_status status;
    if (result != CLI_DONE) return result;
    run->report.lattice = c->solid.lattice;
    run->report.has_lattice = 1;
    for (int a = 0; a < 3; a++) {
        c->resolution = c->solid.size[a] > c->resolution ? c->solid.size[a] : c->resolution;
        low[a] = c->solid.low[a] * c->solid.lattice.spacing[a];
        high[a] = low[a] + c->solid.size[a] * c->solid.lattice.spacing[a];
    }
    c->diagonal = cli_diagonal(low, high);
    result = count_solid(run, c);
    if (result != CLI_DONE) return result;
    cli_stage_begin(run, "surface");
    status = surface_of_solid(run, c);
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(path));
    bvx_mesh_view_of(&c->input, &c->view);
    return CLI_DONE;
}

int cli_open_chain(cli_run *run, cli_chain *c)
{
    return c->kind == CLI_GRID ? open_grid(run, c) : open_mesh(run, c);
}
