/* cmd_render.c - bitvox render: a shaded picture of a mesh, or of several side by side. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

/* Several pictures on one sheet, row by row; at most four a row, as even as it goes. */
typedef struct sheet {
    bvx_image image;
    int32_t width, height; /* of one picture */
    int32_t columns, rows;
} sheet;

static int open_sheet(cli_run *run, sheet *s)
{
    const cli_options *const o = &run->options;
    int32_t const n = o->inputs;
    uint64_t bytes;
    s->width = o->size.count != 0 ? (int32_t)o->size.value[0] : n == 1 ? 1024 : 640;
    s->height = o->size.count != 0 ? (int32_t)o->size.value[1] : n == 1 ? 768 : 480;
    s->rows = (n + 3) / 4;
    s->columns = (n + s->rows - 1) / s->rows;
    s->image.width = s->width * s->columns;
    s->image.height = s->height * s->rows;
    bytes = (uint64_t)s->image.width * (uint64_t)s->image.height * 3;
    if (o->memory_limit != 0 && bytes > o->memory_limit)
        return cli_fail(run, "a picture of %" PRIu64 " bytes is more than --memory-limit allows", bytes);
    s->image.pixels = bytes <= SIZE_MAX ? malloc((size_t)bytes) : NULL;
    if (s->image.pixels == NULL) return cli_fail(run, "no memory for a picture of %" PRIu64 " bytes", bytes);
    memset(s->image.pixels, 255, (size_t)bytes);
    return CLI_DONE;
}

static void place_picture(const sheet *s, int32_t number, const bvx_image *picture)
{
    size_t const line = (size_t)s->width * 3, whole = (size_t)s->image.width * 3;
    uint8_t *const corner = s->image.pixels + (size_t)(number / s->columns) * (size_t)s->height * whole +
                            (size_t)(number % s->columns) * line;
    for (int32_t y = 0; y < s->height; y++) memcpy(corner + (size_t)y * whole, picture->pixels + (size_t)y * line, line);
}

/* The mesh's solid, drawn voxel by voxel. */
static bvx_status render_voxels(cli_run *run, const bvx_mesh_view *view, const bvx_render_options *r, bvx_image *picture)
{
    bvx_voxelize_options v;
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_status status;
    bvx_voxelize_options_init(&v, sizeof v);
    v.fill = run->options.fill;
    status = bvx_lattice_fit(run->context, view, (int32_t)run->options.voxels, &lattice);
    if (status == BVX_OK) status = bvx_voxelize_solid(run->context, view, &lattice, &v, &solid);
    if (status == BVX_OK) status = bvx_render_grid(run->context, &solid, r, picture);
    bvx_grid_free(run->context, &solid);
    return status;
}

static int render_one(cli_run *run, const char *path, int32_t number, const sheet *s)
{
    const cli_options *const o = &run->options;
    bvx_render_options r;
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    bvx_image picture = {0};
    bvx_status status;
    int result = cli_read_mesh(run, path, &mesh);
    double const start = cli_seconds();
    if (result != CLI_DONE) return result;
    bvx_mesh_view_of(&mesh, &view);
    bvx_render_options_init(&r, sizeof r);
    r.width = s->width;
    r.height = s->height;
    r.smooth = o->smooth;
    if (o->from.given) memcpy(r.direction, o->from.value, sizeof r.direction);
    if (o->up.given) memcpy(r.up, o->up.value, sizeof r.up);
    status = o->voxels != 0 ? render_voxels(run, &view, &r, &picture) : bvx_render_mesh(run->context, &view, &r, &picture);
    cli_stage(run, start, "render");
    if (status != BVX_OK) result = cli_fail_status(run, status, path);
    else place_picture(s, number, &picture);
    bvx_image_free(run->context, &picture);
    bvx_mesh_free(run->context, &mesh);
    return result;
}

static int write_picture(cli_run *run, const sheet *s)
{
    bvx_buffer file = {0};
    double const start = cli_seconds();
    bvx_status const status = bvx_write_png(run->context, &s->image, &file);
    int result = status == BVX_OK ? cli_write_output(run, 0, &file) : cli_fail_status(run, status, run->options.output);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage(run, start, "write");
    bvx_buffer_free(run->context, &file);
    if (result == CLI_DONE) cli_say(run, "%s: %" PRId32 " x %" PRId32 " pixels\n", run->options.output, s->image.width, s->image.height);
    return result;
}

static int check_render_options(cli_run *run)
{
    const cli_options *const o = &run->options;
    size_t const n = strlen(o->output);
    if (bvx_format_of_name(o->output) != BVX_FORMAT_PNG || (n > 3 && strcmp(o->output + n - 3, ".gz") == 0))
        return cli_usage(run, "%s: the name ends in no picture format that is written (.png)", o->output);
    if (o->fill != 0 && o->voxels == 0) return cli_usage(run, "--fill needs --voxels");
    if (o->from.given && o->from.value[0] == 0.0 && o->from.value[1] == 0.0 && o->from.value[2] == 0.0)
        return cli_usage(run, "--from 0,0,0 points nowhere");
    if (o->up.given && o->up.value[0] == 0.0 && o->up.value[1] == 0.0 && o->up.value[2] == 0.0)
        return cli_usage(run, "--up 0,0,0 points nowhere");
    return CLI_DONE;
}

static int run_render(cli_run *run)
{
    sheet s;
    int status = check_render_options(run);
    memset(&s, 0, sizeof s);
    if (status == CLI_DONE) status = cli_open_output(run, run->options.output);
    if (status == CLI_DONE) status = open_sheet(run, &s);
    for (int i = 0; i < run->options.inputs && status == CLI_DONE; i++) status = render_one(run, run->options.input[i], i, &s);
    if (status == CLI_DONE) status = write_picture(run, &s);
    free(s.image.pixels);
    return status;
}

const cli_command cli_render = {
    "render", CLI_RENDER, CLI_MAX_INPUTS, "IN... -o OUT.png [options]", "a shaded picture of a mesh, or of several side by side",
    "Reads meshes (.stl .obj .ply, also with .gz) and writes a picture; each mesh fills its frame.\n"
    "Triangles seen from behind are reddish, so holes and flipped triangles show. With --voxels the solid is drawn instead.",
    "bitvox render fixtures/knot.ply -o knot.png --from 1,-2,2", run_render};
