/* mesh_output.c - a mesh as one file. */
#include "cli/cli.h"

int cli_write_mesh(cli_run *run, const bvx_mesh *mesh)
{
    const char *const out = run->options.output;
    bvx_buffer file = {0};
    bvx_status status;
    int result;
    cli_stage_begin(run, "write");
    status = bvx_write_mesh(run->context, mesh, bvx_format_of_name(out), &file);
    result = status == BVX_OK ? cli_write_output(run, 0, &file) : cli_fail_status(run, status, out);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);
    bvx_buffer_free(run->context, &file);
    return result;
}
