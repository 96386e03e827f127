/* cmd_info.c - bitvox info: what a mesh is. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *yes_or_no(int v)
{
    return v ? "yes" : "no";
}

static void say_certificate(cli_run *run, const bvx_certificate *c)
{
    static const char axis[] = "xyz";
    cli_say(run, "  triangles   %" PRIu64 " of %" PRIu64 " vertices and %" PRIu64 " edges\n", c->triangles, c->vertices, c->edges);
    if (c->unused_vertices != 0) cli_say(run, "  unused      %" PRIu64 " vertices\n", c->unused_vertices);
    if (c->collapsed + c->degenerate + c->duplicates != 0)
        cli_say(run, "  harmless    %" PRIu64 " collapsed, %" PRIu64 " without area, %" PRIu64 " duplicate triangles\n",
                c->collapsed, c->degenerate, c->duplicates);
    for (int a = 0; a < 3; a++)
        cli_say(run, "  %c           %.9g .. %.9g (%.9g)\n", axis[a], c->low[a], c->high[a], c->high[a] - c->low[a]);
    cli_say(run, "  closed      %s", yes_or_no(c->closed));
    if (c->boundary_edges != 0) cli_say(run, ", %" PRIu64 " boundary edges", c->boundary_edges);
    cli_say(run, "\n  manifold    %s", yes_or_no(c->edge_manifold && c->vertex_manifold));
    if (c->nonmanifold_edges + c->nonmanifold_vertices != 0)
        cli_say(run, ", %" PRIu64 " edges and %" PRIu64 " vertices are not", c->nonmanifold_edges, c->nonmanifold_vertices);
    cli_say(run, "\n  oriented    %s", yes_or_no(c->oriented));
    if (c->flipped_edges != 0) cli_say(run, ", %" PRIu64 " edges between triangles of opposite sense", c->flipped_edges);
    if (c->closed && c->oriented && c->volume < 0) cli_say(run, ", inside out");
    cli_say(run, "\n  components  %" PRIu64 ", Euler number %" PRId64 "\n", c->components, c->euler);
    cli_say(run, "  volume      %.9g%s\n  area        %.9g\n", c->volume, c->closed ? "" : " (of an open mesh: depends on its place)", c->area);
}

static int check(cli_run *run, const bvx_mesh *mesh, int weld, bvx_certificate *c)
{
    bvx_mesh_view view;
    double const start = cli_seconds();
    bvx_status status;
    bvx_mesh_view_of(mesh, &view);
    status = bvx_mesh_check(run->context, &view, weld, c);
    cli_stage(run, start, weld ? "check welded" : "check");
    if (status != BVX_OK) return cli_fail_status(run, status, run->options.input[0]);
    return cli_interrupted() ? cli_fail_interrupted(run) : CLI_DONE;
}

/* Many files repeat a vertex where colours or normals change: then the surface is closed although the indices are not. */
static int check_both(cli_run *run, const bvx_mesh *mesh, bvx_certificate *c, bvx_certificate *welded, int *differs)
{
    int const stl = bvx_format_of_name(run->options.input[0]) == BVX_FORMAT_STL;
    int status = check(run, mesh, stl, c); /* STL has no indices */
    *differs = 0;
    if (status != CLI_DONE || stl || c->closed) return status;
    status = check(run, mesh, 1, welded);
    *differs = status == CLI_DONE && welded->vertices != c->vertices;
    return status;
}

static int run_info(cli_run *run)
{
    static bvx_certificate certificate, welded; /* the report points at them until the program ends */
    const char *const path = run->options.input[0];
    bvx_mesh mesh = {0};
    int differs, status = cli_read_mesh(run, path, &mesh);
    if (status == CLI_DONE) status = check_both(run, &mesh, &certificate, &welded, &differs);
    bvx_mesh_free(run->context, &mesh);
    if (status != CLI_DONE) return status;
    cli_mesh_entry *const entry = &run->report.mesh[run->report.meshes++];
    entry->path = path;
    entry->certificate = certificate;
    entry->welded = differs ? &welded : NULL;
    cli_say(run, "%s\n", path);
    say_certificate(run, &certificate);
    if (differs) {
        cli_say(run, "the same with vertices at equal positions joined\n");
        say_certificate(run, &welded);
    }
    return CLI_DONE;
}

const cli_command cli_info = {
    "info", CLI_INFO, 1, "IN [options]", "what a mesh is: counts, bounds, closed, manifold, oriented, volume, area",
    "Reads a mesh (.stl .obj .ply, also with .gz) and tells whether it is closed, manifold and\n"
    "oriented, how many components it has, its volume and its area.",
    "bitvox info fixtures/knot.ply", run_info};
