/* mesh_output.c - meshes as files: the names that are good for them, what formats cannot hold. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

char *cli_numbered_path(const char *pattern, int64_t number)
{
    size_t const room = strlen(pattern) + 32;
    const char *const place = strstr(pattern, "%d");
    char *const path = malloc(room);

    if (path == NULL) return NULL;
    if (place == NULL) snprintf(path, room, "%s", pattern);
    else snprintf(path, room, "%.*s%" PRId64 "%s", (int)(place - pattern), pattern, number, place + 2);
    return path;
}

int cli_check_mesh_name(cli_run *run, const char *path)
{
    if (cli_kind_of_format(bvx_format_of_name(path)) == CLI_MESH && !cli_is_packed(path)) return CLI_DONE;
    return cli_usage(run, "%s: the name ends in no mesh format that is written (.ply .obj .stl .off .glb)",
                     path);
}

int cli_check_level_names(cli_run *run, int count)
{
    const char *const out = run->options.output, *const place = strstr(out, "%d");

    if (place != NULL && strstr(place + 2, "%d") != NULL)
        return cli_usage(run, "%s: %%d stands twice in the name", out);
    if (place != NULL || count == 1 || bvx_format_of_name(out) == BVX_FORMAT_GLB) return CLI_DONE;
    if (count != 0)
        return cli_usage(
            run, "%s: %d levels need %%d in the name, for the number of each; only .glb holds several", out,
            count);
    return cli_usage(run,
                     "%s: several levels need %%d in the name, for the number of each; only .glb holds "
                     "several, and --count 1 or "
                     "--triangles N makes one",
                     out);
}

int cli_check_carry(cli_run *run, const bvx_mesh *mesh)
{
    const char *const in = cli_input_name(run->options.input[0]), *const out = run->options.output;

    if (!run->options.carry) return CLI_DONE;
    if (mesh->colours == NULL && mesh->uvs == NULL)
        return cli_usage(run, "%s has neither colours nor texture coordinates that --carry could carry", in);
    if (mesh->colours == NULL && bvx_format_of_name(out) == BVX_FORMAT_OFF)
        return cli_usage(run, "%s: .off holds no texture coordinates, and %s has no colours for --carry", out,
                         in);
    return CLI_DONE;
}

int cli_check_carry_name(cli_run *run)
{
    const char *const out = run->options.output;

    if (!run->options.carry || bvx_format_of_name(out) != BVX_FORMAT_STL) return CLI_DONE;
    return cli_usage(
        run, "%s: .stl holds neither colours nor texture coordinates; take .ply, .obj or .glb for --carry",
        out);
}

void cli_warn_of_lost(cli_run *run, const char *path, const bvx_mesh *mesh)
{
    int32_t const format = bvx_format_of_name(path);
    int const colours = mesh->colours != NULL && format == BVX_FORMAT_STL;
    int const uvs = mesh->uvs != NULL && (format == BVX_FORMAT_STL || format == BVX_FORMAT_OFF);

    if (!colours && !uvs) return;
    cli_warn(run, "%s: .%s cannot hold %s%s%s, which are lost", path, cli_format_name(format),
             colours ? "colours" : "", colours && uvs ? " and " : "", uvs ? "texture coordinates" : "");
}

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

int cli_write_mesh_as(cli_run *run, const bvx_mesh *mesh, int number, const char *path)
{
    bvx_write_options o;
    bvx_buffer file = {0};
    bvx_status status;
    int result;

    bvx_write_options_init(&o, sizeof o);
    o.normals = run->options.normals;
    status = bvx_write_mesh_with(run->context, mesh, &o, bvx_format_of_name(path), &file);
    result = status == BVX_OK ? cli_write_output(run, number, &file) : cli_fail_status(run, status, path);
    bvx_buffer_free(run->context, &file);
    return result;
}

int cli_write_mesh(cli_run *run, const bvx_mesh *mesh)
{
    int result;

    cli_stage_begin(run, "write");
    result = cli_write_mesh_as(run, mesh, 0, run->options.output);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);
    return result;
}

int cli_open_levels(cli_run *run, int count, char **path)
{
    int const in_one = strstr(run->options.output, "%d") == NULL;
    int status = CLI_DONE;

    for (int i = 0; i < count && status == CLI_DONE; i++) {
        path[i] = in_one && i > 0 ? path[0] : cli_numbered_path(run->options.output, i);
        if (path[i] == NULL) return cli_fail(run, "no memory for a file's name");
        if (!in_one || i == 0) status = cli_open_output(run, path[i]);
    }
    return status;
}

int cli_write_levels(cli_run *run, const bvx_mesh *levels, int count, char *const *path)
{
    bvx_buffer file = {0};
    bvx_status status;
    int result = CLI_DONE;

    cli_stage_begin(run, "write");
    if (count > 1 && path[1] == path[0]) {
        status = bvx_write_levels(run->context, levels, (uint64_t)count, bvx_format_of_name(path[0]), &file);
        result = status == BVX_OK ? cli_write_output(run, 0, &file) : cli_fail_status(run, status, path[0]);
        bvx_buffer_free(run->context, &file);
    } else {
        for (int i = 0; i < count && result == CLI_DONE; i++)
            result = cli_write_mesh_as(run, &levels[i], i, path[i]);
    }
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    if (result == CLI_DONE) cli_stage_end(run);
    return result;
}
