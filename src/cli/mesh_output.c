/* mesh_output.c - a mesh as one file. */
#include "cli/cli.h"

int cli_check_normals(cli_run *run)
{
    const char *const out = run->options.output;
    int32_t const format = bvx_format_of_name(out);
    int const holds = format == BVX_FORMAT_PLY || format == BVX_FORMAT_OBJ || format == BVX_FORMAT_GLB;

    if (!run->options.normals || holds) return CLI_DONE;
    return cli_usage(run, "%s: --normals is for .ply and .obj; %s", out,
                     format == BVX_FORMAT_STL ? ".stl has the normals of triangles only"
                                              : "no normals are written to this format");
}

int cli_write_mesh(cli_run *run, const bvx_mesh *mesh)
{
    const char *const out = run->options.output;
    bvx_write_options o;
    bvx_buffer file = {0};
    bvx_status status;
    int result;

    bvx_write_options_init(&o, sizeof o);
    o.normals = run->options.normals;
    cli_stage_begin(run, "write");
    status = bvx_write_mesh_with(run->context, mesh, &o, bvx_format_of_name(out), &file);
    result = status == BVX_OK ? cli_write_output(run, 0, &file) : cli_fail_status(run, status, out);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);

    bvx_buffer_free(run->context, &file);
    return result;
}
