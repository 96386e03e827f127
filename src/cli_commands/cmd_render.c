/* cmd_render.c - bitvox render: pictures of meshes and grids, alone, side by side or compared. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What the command takes for itself; zero stands for "not given". */
typedef struct cli_render_options {
    cli_list size;
    cli_triple from;
    cli_triple up;
    int32_t voxels; /* along the longest axis; 0: draw the mesh */
    bvx_render_options picture;
    cli_planes cut;
    int32_t difference; /* --compare */
} cli_render_options;

typedef struct cli_scene {
    cli_input input[2]; /* one, or the two that are compared */
    int compared;
    bvx_grid_difference difference; /* of two */
} cli_scene;

static void start_render(void *options)
{
    cli_render_options *const o = options;
    o->picture = (bvx_render_options){.struct_size = sizeof o->picture,
                                      .camera = {.direction = {3.0, -4.0, 2.0}, .up = {0.0, 0.0, 1.0}}};
}

#define OWN(name) CLI_OWN(cli_render_options, name)

static const cli_argument render_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_fill_of_solids},
    {.also = cli_takes_volumes},
    {.also = cli_takes_trees},
    {.also = cli_takes_kept_parts},
    SIZE("--size", "WxH", OWN(size), 16384,
         "pixels of a picture [1024x768; 640x480 each for several meshes]"),
    TRIPLE("--from", "X,Y,Z", OWN(from), "direction from the model to the eye [3,-4,2]"),
    DIRECTION("--up", "X,Y,Z", OWN(up), "what is up in the picture, also x, y or z [0,0,1]"),
    WHOLE("--voxels", "N", OWN(voxels), 1, LARGEST_SIDE,
          "draw the voxels of a mesh's solid, N along its longest axis\n"
          "[256 with --compare]"),
    FLAG("--smooth", OWN(picture.smooth), "smooth shading; sharp edges stay sharp"),
    FLAG("--wireframe", OWN(picture.wireframe), "draw the edges of triangles or voxels too"),
    PLANES("--cut", "AXIS=VALUE", OWN(cut),
           "take away what lies between a plane and the eye, in the model's unit;\n"
           "once for each axis, or x=0.5,z=1"),
    FLAG("--compare", OWN(difference),
         "two inputs in one picture: what the second adds green, what it lacks red"),
    {.also = cli_takes_all},
    {0}};

/* Several pictures on one sheet, row by row; at most four a row, as even as it goes. */
typedef struct sheet {
    bvx_image image;
    int32_t width, height; /* of one picture */
    int32_t columns, rows;
} sheet;

typedef struct render_job {
    cli_scene scene;
    sheet sheet;
} render_job;

/* ---- scenes ---- */

enum { COMPARED_RESOLUTION = 256 };

static int voxelize_scene(cli_run *run, cli_scene *s, int count)
{
    const cli_render_options *const own = run->own;
    int32_t const resolution = own->voxels != 0 ? own->voxels : COMPARED_RESOLUTION;
    bvx_lattice lattice;
    int status = CLI_DONE;

    cli_stage_begin(run, "voxelize");
    cli_box box, other;
    cli_mesh_box(&s->input[0].mesh, &box);
    cli_mesh_box(&s->input[count - 1].mesh, &other);
    cli_join_boxes(&box, &other);
    bvx_mesh_view const corners = cli_corners_of_box(&box);
    bvx_lattice_options fit = {.struct_size = sizeof fit, .resolution = resolution};
    bvx_status const fitted = bvx_lattice_fit_with(run->context, &corners, &fit, &lattice);
    if (fitted != BVX_OK) return cli_fail_status(run, fitted, cli_input_name(s->input[0].path));
    for (int i = 0; i < count && status == CLI_DONE; i++) {
        status = cli_fill_on(run, &lattice, &s->input[i]);
        s->input[i].kind = CLI_GRID;
        s->input[i].placed = 1;
    }
    cli_stage_end(run);
    return status;
}

/* Read input number first, or with --compare it and the next; meshes are voxelized where requested. */
static int cli_open_scene(cli_run *run, int first, cli_scene *s)
{
    const cli_render_options *const own = run->own;
    const cli_options *const o = run->options;
    int const count = own->difference ? 2 : 1;
    int status = CLI_DONE;

    memset(s, 0, sizeof *s);
    s->compared = own->difference;
    for (int i = 0; i < count && status == CLI_DONE; i++)
        status = cli_read_input(run, o->input[first + i], &s->input[i]);
    if (status == CLI_DONE && s->input[0].kind == CLI_MESH && (own->voxels != 0 || own->difference))
        status = voxelize_scene(run, s, count);
    if (status != CLI_DONE || !own->difference) return status;
    cli_stage_begin(run, "compare");
    status = cli_compare_grids(run, &s->input[0], &s->input[1], &s->difference);
    cli_stage_end(run);
    return status;
}

static int cli_draw_scene(cli_run *run, const cli_scene *s, int32_t width, int32_t height, bvx_image *image)
{
    const cli_render_options *const own = run->own;
    bvx_render_options r = own->picture;
    bvx_status status;

    r.width = width;
    r.height = height;
    if (own->from.given) memcpy(r.camera.direction, own->from.value, sizeof r.camera.direction);
    if (own->up.given) memcpy(r.camera.up, own->up.value, sizeof r.camera.up);

    /* What lies on the eye's side of each plane goes; the higher side where the plane looks at neither. */
    const cli_planes *const cut = &own->cut;
    const double *const direction = r.camera.direction;
    for (int a = 0; a < 3; a++) {
        if (!cut->given[a]) continue;
        r.cut.sides |= (direction[a] < 0.0 ? BVX_OPEN_X_LOW : BVX_OPEN_X_HIGH) << 2 * a;
        (direction[a] < 0.0 ? r.cut.low : r.cut.high)[a] = cut->value[a];
    }

    if (s->compared) {
        status = bvx_render_difference(run->context, &s->input[0].grid, &s->input[1].grid, &r, image);
    } else if (s->input[0].kind == CLI_GRID) {
        status = bvx_render_grid(run->context, &s->input[0].grid, &r, image);
    } else {
        bvx_mesh_view const view = cli_view(&s->input[0].mesh);
        status = bvx_render_mesh(run->context, &view, &r, image);
    }
    return cli_check_call(run, status, cli_input_name(s->input[0].path));
}

/* ---- sheets ---- */

/* ---- pictures ---- */

static int render_sheet(cli_run *run, cli_scene *scene, sheet *s)
{
    const cli_render_options *const own = run->own;
    const cli_options *const o = run->options;
    int const pictures = own->difference ? 1 : o->inputs;
    int status = CLI_DONE;

    CLI_TRY(cli_open_output(run, o->output));
    s->width = own->size.count != 0 ? (int32_t)own->size.value[0] : pictures == 1 ? 1024 : 640;
    s->height = own->size.count != 0 ? (int32_t)own->size.value[1] : pictures == 1 ? 768 : 480;
    s->rows = (pictures + 3) / 4;
    s->columns = (pictures + s->rows - 1) / s->rows;
    s->image.width = s->width * s->columns;
    s->image.height = s->height * s->rows;
    uint64_t const bytes = (uint64_t)s->image.width * (uint64_t)s->image.height * 3;
    if (o->general.memory_limit != 0 && bytes > o->general.memory_limit)
        return cli_fail(run, "a picture of %" PRIu64 " bytes is more than --memory-limit allows", bytes);
    s->image.pixels = bytes <= SIZE_MAX ? malloc((size_t)bytes) : NULL;
    if (s->image.pixels == NULL) return cli_fail(run, "no memory for a picture of %" PRIu64 " bytes", bytes);
    memset(s->image.pixels, 255, (size_t)bytes);
    for (int i = 0; i < pictures && status == CLI_DONE; i++) {
        bvx_image picture = {0};
        status = cli_open_scene(run, i, scene);
        cli_stage_begin(run, "render");
        if (status == CLI_DONE) status = cli_draw_scene(run, scene, s->width, s->height, &picture);
        cli_stage_end(run);
        if (status == CLI_DONE) {
            size_t const line = (size_t)s->width * 3, whole = (size_t)s->image.width * 3;
            uint8_t *const corner = s->image.pixels + (size_t)(i / s->columns) * (size_t)s->height * whole +
                                    (size_t)(i % s->columns) * line;
            for (int32_t y = 0; y < s->height; y++)
                memcpy(corner + (size_t)y * whole, picture.pixels + (size_t)y * line, line);
        }
        bvx_image_free(run->context, &picture);
        for (int k = 0; k < 2; k++) cli_free_input(run, &scene->input[k]);
    }
    return status;
}

static int write_pictures(cli_run *run, void *work)
{
    bvx_buffer file = {0};
    cli_stage_begin(run, "write");
    bvx_status const written = bvx_write_png(run->context, &((render_job *)work)->sheet.image, &file);
    int status = cli_write_buffer(run, 0, written, &file, run->output[0].path);
    if (status == CLI_DONE) status = cli_keep_outputs(run);
    cli_stage_end(run);
    return status;
}

static void tell_render(const cli_run *run, const void *work, cli_made *made)
{
    const render_job *const job = work;
    const bvx_image *const image = &job->sheet.image;
    cli_text *const t = &made->members;
    if (job->scene.compared) {
        const cli_input *const in = job->scene.input;
        const bvx_grid_difference *const d = &job->scene.difference;
        cli_tell(made,
                 "%s -> %s: %" PRIu64 " voxels of both, %" PRIu64 " added (green), %" PRIu64
                 " removed (red)\n",
                 cli_input_name(in[0].path), cli_input_name(in[1].path), d->both, d->only_b, d->only_a);
        cli_text_add(t, ", \"difference\": {\"both\": %" PRIu64, d->both);
        cli_json_count(t, "added", d->only_b);
        cli_json_count(t, "removed", d->only_a);
        cli_text_add(t, "}");
    }
    cli_text_add(t, ", \"pictures\": {\"path\": ");
    cli_json_string(t, cli_output_name(run, run->options->output));
    cli_text_add(t, ", \"count\": 1, \"width\": %" PRId32 ", \"height\": %" PRId32 "}", image->width,
                 image->height);
    cli_tell(made, "%s: %" PRId32 " x %" PRId32 " pixels\n", cli_output_name(run, run->options->output),
             image->width, image->height);
}

/* ---- what is requested ---- */

static int points_nowhere(const cli_triple *t)
{
    return t->given && t->value[0] == 0.0 && t->value[1] == 0.0 && t->value[2] == 0.0;
}

enum {
    HAS_MESH = 1 << CLI_FIRST_FACT, /* among the inputs */
    HAS_TWO = 2 << CLI_FIRST_FACT,  /* inputs */
    ARE_MIXED = 4 << CLI_FIRST_FACT /* a mesh and a grid, or more */
};

/* The word is how many inputs there are. */
static const cli_rule render_rules[] = {
    {.unless = HAS_MESH,
     .given = "--voxels",
     .message = "%o is for meshes; the voxels of a grid are drawn as they are"},
    {.unless = HAS_MESH, .given = "--fill", .message = "%o needs --voxels"},
    {.given = "--fill", .lacking = "--voxels --compare", .message = "%o needs --voxels"},
    {.unless = HAS_TWO, .given = "--compare", .message = "%o takes two inputs, not %w"},
    {.when = ARE_MIXED,
     .given = "--compare",
     .message = "%o takes two grids or two meshes: voxelize the mesh on the grid's lattice first"},
    {.also = cli_fill_rules},
    {0}};

static int make_render(cli_run *run, void *work, cli_made *made)
{
    render_job *const job = work;
    made->write = write_pictures;
    made->untitled = 1;

    const cli_render_options *const own = run->own;
    const cli_options *const o = run->options;
    if (bvx_format_of_name(o->output) != BVX_FORMAT_PNG || cli_is_packed(o->output))
        return cli_usage(run, "%s: the name does not end in a picture format that can be written (.png)",
                         o->output);
    if (points_nowhere(&own->from)) return cli_usage(run, "--from 0,0,0 points nowhere");
    if (points_nowhere(&own->up)) return cli_usage(run, "--up 0,0,0 points nowhere");

    /* Rules know facts, not numbers, so the count comes as the word of messages. */
    int meshes = 0, kind;
    char count[16];
    for (int i = 0; i < o->inputs; i++) {
        CLI_TRY(cli_input_kind(run, o->input[i], &kind));
        meshes += kind == CLI_MESH;
    }
    snprintf(count, sizeof count, "%d", o->inputs);
    CLI_TRY(cli_check_rules(run, render_rules,
                            (meshes != 0 ? HAS_MESH : 0u) | (o->inputs == 2 ? HAS_TWO : 0u) |
                                (meshes == 1 ? ARE_MIXED : 0u),
                            count));
    return render_sheet(run, &job->scene, &job->sheet);
}

static const cli_owned render_owns[] = {
    CLI_OWNS(BYTES, render_job, sheet.image.pixels), CLI_OWNS_ALL(INPUT, render_job, scene.input), {0}};

const cli_command cli_render = {
    .name = "render",
    .bit = CLI_RENDER,
    .least_inputs = 1,
    .most_inputs = CLI_MAX_INPUTS,
    .usage = "IN... -o OUT.png [options]",
    .does = "a shaded picture of a mesh or grid, or of several side by side",
    .details =
        "Reads meshes (" CLI_MESHES_READ ", also .gz) and grids (" CLI_GRIDS ")\n"
        "and writes a picture; each fills its frame, and colours of vertices are shown. Triangles seen from\n"
        "behind are reddish, so holes and flipped triangles show. --voxels draws a mesh's solid instead,\n"
        "--cut opens a model, --compare shows two in one.",
    .example = "bitvox render fixtures/knot.ply -o knot.png --from 1,-2,2\n"
               "bitvox render fixtures/knot.ply -o cut.png --voxels 96 --cut z=0",
    .most = "--size --from --up --level --fill --voxels --smooth --wireframe --cut --compare",
    .rows = render_rows,
    .start = start_render,
    .own = sizeof(cli_render_options),
    .job = {.size = sizeof(render_job), .make = make_render, .tell = tell_render, .owns = render_owns}};
