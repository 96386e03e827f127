/* mesh_output.c - meshes as files: the names that are good for them, fewer triangles where that is requested,
 * what formats cannot hold. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define WARNED_SHARE 64.0 /* rounding by more than this part of a mean edge turns triangles by a degree */

/* Where a pattern has its %d, or %03d with so many digits: its length there; NULL where it has none. */
static const char *number_place(const char *pattern, size_t *length, int *digits)
{
    for (const char *p = strchr(pattern, '%'); p != NULL; p = strchr(p + 1, '%')) {
        int const padded = p[1] == '0' && p[2] >= '1' && p[2] <= '9';
        size_t const n = padded ? 4 : 2;
        if (p[n - 1] != 'd') continue;
        *length = n;
        *digits = padded ? p[2] - '0' : 0;
        return p;
    }
    return NULL;
}

int cli_has_number(const char *pattern)
{
    size_t length;
    int digits;
    return number_place(pattern, &length, &digits) != NULL;
}

int cli_has_two_numbers(const char *pattern)
{
    size_t length;
    int digits;
    const char *const place = number_place(pattern, &length, &digits);
    return place != NULL && cli_has_number(place + length);
}

char *cli_numbered_path(const char *pattern, int64_t number)
{
    size_t const room = strlen(pattern) + 32;
    size_t length = 0;
    int digits = 0;
    const char *const place = number_place(pattern, &length, &digits);
    /* Room for the longest number and for the digits that %09d asks of it. */
    char *const path = malloc(room);

    if (path == NULL) return NULL;
    if (place == NULL) snprintf(path, room, "%s", pattern);
    else
        snprintf(path, room, "%.*s%0*" PRId64 "%s", (int)(place - pattern), pattern, digits, number,
                 place + length);
    return path;
}

int cli_check_pattern(cli_run *run)
{
    int32_t const numbering = CLI_LOD | CLI_SIMPLIFY | CLI_HULL | CLI_SECTIONS;
    const char *const out = run->options->output;

    for (const char *p = out; p != NULL && (p = strchr(p, '%')) != NULL; p++) {
        const char *end = p + 1;
        while (*end >= '0' && *end <= '9') end++;
        /* 50%scaled.ply is a name like any other. */
        if (*end == 0 || (end[1] >= 'a' && end[1] <= 'z')) continue;
        if (run->command->bit == CLI_LABELS && end == p + 1 && *end == 's') continue;
        if (run->command->bit == CLI_LABELS && strchr("sifuxgd", *end) != NULL)
            return cli_usage(
                run, "%s: %.*s is not replaced in a name; %%s is, by the name or number of each label", out,
                (int)(end + 1 - p), p);
        if (strchr("sifuxg", *end) != NULL)
            return cli_usage(run, "%s: %.*s is not replaced in a name; %%d is, by the number of each file",
                             out, (int)(end + 1 - p), p);
        if (*end == 'd' && (run->command->bit & numbering) == 0)
            return cli_usage(run, "%s: %.*s is for the numbers of several files; %s writes one", out,
                             (int)(end + 1 - p), p, run->command->name);
    }
    return CLI_DONE;
}

int cli_check_level_names(cli_run *run, int count)
{
    const char *const out = run->options->output;

    if (cli_has_two_numbers(out)) return cli_usage(run, "%s: the name has two %%d", out);
    if (cli_has_number(out) || count == 1 || bvx_format_of_name(out) == BVX_FORMAT_GLB) return CLI_DONE;
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
    const char *const in = cli_first_name(run), *const out = run->options->output;
    if (!run->options->carry) return CLI_DONE;
    if (mesh->colours == NULL && mesh->uvs == NULL)
        return cli_usage(run, "%s has neither colours nor texture coordinates that --carry could carry", in);
    /* .stl is refused by a row, whatever the mesh has. */
    if (mesh->colours == NULL && bvx_format_of_name(out) == BVX_FORMAT_OFF)
        return cli_usage(run, "%s: .off holds no texture coordinates, and %s has no colours for --carry", out,
                         in);
    return CLI_DONE;
}

int cli_carry(cli_run *run, const bvx_mesh *input, bvx_mesh *mesh, const char *stage, const char *about)
{
    if (!run->options->carry) return CLI_DONE;

    /* A seam: two triangles at a vertex have different texture coordinates there. Without memory none is known. */
    int const asked = !run->report.seams && input->uv_triangles != NULL;
    const float **const first = asked ? calloc((size_t)input->vertex_count, sizeof *first) : NULL;
    int found = 0;
    for (uint64_t i = 0; first != NULL && !found && i < input->triangle_count * 3; i++) {
        const float *const uv = input->uvs + 2 * (size_t)input->uv_triangles[i];
        const float **const at = &first[input->triangles[i]];
        if (*at == NULL) *at = uv;
        found = (*at)[0] != uv[0] || (*at)[1] != uv[1];
    }
    free(first);
    if (found)
        cli_warn(
            run, BVX_WARN_LOST,
            "%s: seams of its texture are not kept: triangles across them stretch; levels of the mesh as it "
            "is keep them",
            cli_first_name(run));
    run->report.seams = 1;
    cli_stage_begin(run, "%s", stage);
    return cli_stage_check(run, bvx_mesh_carry(run->context, input, mesh), about);
}

static uint32_t attributes_of_format(int32_t format)
{
    return format == BVX_FORMAT_GLB ? CLI_HAS_COLOURS | CLI_HAS_UVS | CLI_HAS_SECOND_UVS | CLI_HAS_MATERIALS
           : format == BVX_FORMAT_STL || format == BVX_FORMAT_3MF ? 0
           : format == BVX_FORMAT_OFF                             ? CLI_HAS_COLOURS
                                                                  : CLI_HAS_COLOURS | CLI_HAS_UVS;
}

/* What would have kept the attributes; "" where nothing does. */
static const char *remedy_of_loss(const cli_run *run, uint32_t lost)
{
    int const held = (lost & ~attributes_of_format(bvx_format_of_name(run->options->output))) == 0;
    uint32_t const carried = lost & (CLI_HAS_COLOURS | CLI_HAS_UVS);
    const cli_mesh_entry *const first = run->report.meshes > 0 ? run->report.mesh : NULL;
    /* What is written has what the input has, where its format does. */
    int const kept = run->command->bit == CLI_CONVERT || run->command->bit == CLI_SIMPLIFY ||
                     (run->command->bit == CLI_LOD && first != NULL && first->level != NULL && !first->solid);
    if (kept || run->options->carry)
        return held || (run->options->carry && carried != lost) ? "" : "; .glb keeps them";
    if (!cli_takes(run, "--carry") || carried == 0) return "";
    if (carried != lost) return held ? "; --carry keeps colours and texture coordinates" : "";
    return held ? "; --carry keeps them" : "; .glb with --carry keeps them";
}

void cli_tell_lost(const cli_run *run, cli_made *made)
{
    uint32_t const lost = run->report.had & ~run->report.kept;
    static const char *const words[] = {"colours", "texture coordinates", "second texture coordinates"};
    int const materials = run->report.materials;
    cli_text names = {NULL, 0, 0, 0};
    if (lost == 0 || !CLI_HOLDS(run, CLI_TO_MESH)) return;
    for (uint32_t i = 0; i < 4; i++) {
        uint32_t const bit = 1u << i;
        if ((lost & bit) == 0) continue;
        if ((lost & (bit - 1)) != 0) cli_text_add(&names, lost >> (i + 1) != 0 ? ", " : " and ");
        if (bit == CLI_HAS_MATERIALS)
            cli_text_add(&names, "%d material%s", materials, materials == 1 ? "" : "s");
        else cli_text_add(&names, "%s", words[i]);
    }
    cli_advise(made, BVX_WARN_LOST, "%s: %s %s not kept%s", run->options->output, names.bytes,
               lost == CLI_HAS_MATERIALS && materials == 1 ? "is" : "are", remedy_of_loss(run, lost));
    cli_text_free(&names);
}

void cli_tell_turn(const cli_run *run, cli_made *made)
{
    int32_t const turn = CLI_HOLDS(run, CLI_TO_MESH) ? cli_turn_of(run) : BVX_TURN_NONE;
    int const to_y = turn == BVX_TURN_Z_TO_Y;
    if (turn == BVX_TURN_NONE) return;
    cli_tell(made, "  turned      from %s up to %s up, x,y,z became %s; --up %s leaves them\n",
             to_y ? "z" : "y", to_y ? "y" : "z", to_y ? "x,z,-y" : "x,-z,y", to_y ? "z" : "y");
    cli_text_add(&made->members, ", \"turned\": \"%s\"", to_y ? "z to y" : "y to z");
}

/* ---- --triangles and --error of the commands that make one mesh ---- */

/* Its edges collapse once it is made: --error is the distance from the mesh as it was made, not from what
 * it was made of. */
int cli_reduce(cli_run *run, bvx_mesh *mesh, cli_reduction *r)
{
    const cli_options *const o = run->options;
    uint64_t const target = o->triangles.count != 0 ? (uint64_t)o->triangles.value[0] : 0;
    double error = o->errors.value[0];
    bvx_mesh less = {0};
    bvx_simplify_options s = {.struct_size = sizeof s};
    cli_box box;

    r->before = mesh->triangle_count;
    if (!cli_reduces(run) || mesh->triangle_count == 0) return CLI_DONE;
    cli_mesh_box(mesh, &box);
    if (o->errors.percent[0]) error *= cli_diagonal(box.low, box.high) / 100.0;

    if (target != 0) s.targets.triangles = &target;
    else s.targets.errors = &error;
    s.targets.error_kind = o->error_kind;
    s.reports = &r->level;

    bvx_mesh_view const view = cli_view(mesh);
    CLI_TRY(CLI_STAGE(run, "simplify", bvx_mesh_simplify(run->context, &view, &s, 1, &less),
                      run->options->output));

    bvx_mesh_free(run->context, mesh);
    *mesh = less;
    r->done = 1;
    return CLI_DONE;
}

void cli_tell_reduction(const cli_reduction *r, cli_made *made)
{
    cli_text *const t = &made->members;

    if (!r->done) return;
    cli_tell(made,
             "  collapsed   %" PRIu64 " of %" PRIu64
             " triangles are left%s; smallest angle %.2f degrees, %" PRIu64 " crossings\n",
             r->level.triangles, r->before, r->level.met ? "" : ", more than requested", r->level.least_angle,
             r->level.crossings);
    cli_text_add(t, ", \"simplify\": {\"triangles_before\": %" PRIu64, r->before);
    cli_json_count(t, "triangles", r->level.triangles);
    cli_json_truth(t, "met", r->level.met);
    cli_json_value(t, "least_angle", r->level.least_angle);
    cli_json_count(t, "crossings", r->level.crossings);
    cli_text_add(t, "}");
}

/* ---- what the file holds ---- */

/* The mesh as its file has it: less --output-origin. The arrays stay those of the mesh. */
static bvx_mesh placed_mesh(const cli_run *run, const bvx_mesh *mesh)
{
    bvx_mesh placed = *mesh;
    for (int a = 0; a < 3; a++) placed.frame[a] -= run->options->output_origin.value[a];
    return placed;
}

/* A round origin that brings a box near to 0: whole multiples of a power of
 * ten not below its longest side. 0 when the box is not far. */
static int near_origin(const bvx_certificate *c, double origin[3])
{
    double longest = 0.0, farthest = 0.0, step = 1.0;

    for (int a = 0; a < 3; a++) {
        longest = fmax(longest, c->box.high[a] - c->box.low[a]);
        farthest = fmax(farthest, fmax(fabs(c->box.low[a]), fabs(c->box.high[a])));
    }
    /* A box near 0 loses nothing by floats that another origin would save. */
    if (!(farthest > 16.0 * longest) || farthest > 1e15) return 0;

    while (step < longest) step *= 10.0;
    for (int a = 0; a < 3; a++)
        origin[a] = floor((c->box.low[a] * 0.5 + c->box.high[a] * 0.5) / step + 0.5) * step + 0.0;
    return 1;
}

static int refuse_rounding(cli_run *run, const bvx_mesh *placed, const char *path, const bvx_write_report *r)
{
    int32_t const format = bvx_format_of_name(path);
    double origin[3];
    bvx_certificate box = {0};
    char advice[128] = "";

    bvx_mesh_view const view = cli_view(placed);
    /* The advice is worth a check: it names an origin that can be copied. */
    if (!run->options->quantize && bvx_mesh_check(run->context, &view, 0, &box) == BVX_OK &&
        near_origin(&box, origin))
        snprintf(advice, sizeof advice, ", or --output-origin %.15g,%.15g,%.15g to bring it near", origin[0],
                 origin[1], origin[2]);
    return cli_fail(
        run,
        "%s: .%s holds %s: they would move vertices by up to %.2g, where edges have a mean "
        "length of "
        "%.2g, and %" PRIu64 " of %" PRIu64 " triangles would lose their area or be turned over; take %s%s",
        path, cli_format_name(format), run->options->quantize ? "quantized positions" : "32-bit floats",
        r->largest_move, r->mean_edge, r->spoilt, placed->triangle_count,
        run->options->quantize     ? "it without --quantize"
        : format == BVX_FORMAT_STL ? ".ply, .obj, .off or .glb"
                                   : ".ply, .obj or .off",
        advice);
}

static void warn_of_rounding(cli_run *run, const bvx_mesh *placed, const char *path,
                             const bvx_write_report *r)
{
    const char *const format = cli_format_name(bvx_format_of_name(path));
    int const quantized = run->options->quantize;
    const char *const what = quantized ? "quantized positions" : "32-bit floats";
    bvx_certificate own;

    if (r->spoilt != 0)
        cli_warn(run, BVX_WARN_ROUNDED,
                 "%s: the %s of .%s leave %" PRIu64 " of %" PRIu64 " triangles without area or turned over",
                 path, what, format, r->spoilt, placed->triangle_count);
    else if (r->largest_move * WARNED_SHARE > r->mean_edge)
        cli_warn(run, BVX_WARN_ROUNDED,
                 "%s: the %s of .%s move vertices by up to %.2g, where edges have a mean length of "
                 "%.2g%s",
                 path, what, format, r->largest_move, r->mean_edge,
                 quantized ? "" : "; --output-origin brings the mesh near 0");
    if (cli_is_sound(&r->file)) return;

    bvx_mesh_view const view = cli_view(placed);
    /* Only a mesh that was sound can lose that by its file. */
    if (bvx_mesh_check(run->context, &view, 0, &own) != BVX_OK || !cli_is_sound(&own)) return;
    cli_warn(
        run, BVX_WARN_ROUNDED,
        "%s: the mesh is closed, manifold and oriented, but not as .%s: its readers join vertices at equal "
        "positions, "
        "and %" PRIu64 " edges and %" PRIu64 " vertices are not manifold then",
        path, format, r->file.nonmanifold_edges, r->file.nonmanifold_vertices);
}

static bvx_write_options write_options(const cli_run *run, const bvx_mesh *meshes, int count)
{
    bvx_write_options o = {.struct_size = sizeof o,
                           .normals = run->options->normals,
                           .quantize = run->options->quantize,
                           .turn = cli_turn_of(run)};
    if (run->names != NULL && CLI_HOLDS(run, CLI_TO_GLB)) {
        o.names = run->names;
        o.colours = run->colours;
    }
    /* what rounding spoils was refused or warned of before */
    o.rounding = BVX_ROUNDING_ALLOW;
    if (run->options->keep_vertices) o.source = run->source;
    for (int i = 0; i < count; i++)
        if (meshes[i].materials != NULL && meshes[i].assets == NULL) o.source = run->source;
    return o;
}

/* Certify meshes as one file holds them; number: the report's entry of the first, if it has one. */
static int certify_file(cli_run *run, const bvx_mesh *placed, int count, int number, const char *path)
{
    bvx_write_report *const report = calloc((size_t)count, sizeof *report);
    bvx_write_options o = write_options(run, placed, count);
    int result = CLI_DONE;

    o.reports = report;
    if (report == NULL) return cli_fail(run, "no memory for the report of %d meshes", count);
    cli_stage_begin(run, "check file");
    bvx_status status = bvx_write_mesh(run->context, placed, (uint64_t)count, &o, bvx_format_of_name(path),
                                       NULL);
    cli_stage_end(run);
    if (status != BVX_OK) result = cli_fail_status(run, status, path);

    for (int i = 0; i < count && result == CLI_DONE; i++) {
        if (!report[i].fits) {
            result = refuse_rounding(run, &placed[i], path, &report[i]);
            continue;
        }
        warn_of_rounding(run, &placed[i], path, &report[i]);
        if (number + i < run->report.meshes) run->report.mesh[number + i].certificate = report[i].file;
    }
    free(report);
    return result;
}

int cli_check_mesh(cli_run *run, const bvx_mesh *mesh, int number, const char *path, const char *stage)
{
    cli_mesh_entry *const entry = &run->report.mesh[number];
    bvx_mesh_view const view = cli_view(mesh);
    /* The stage may have %d in its name: levels are checked one by one. */
    cli_stage_begin(run, stage, number);
    CLI_TRY(cli_stage_check(run, bvx_mesh_check(run->context, &view, 0, &entry->certificate), path));
    entry->path = path;
    run->report.meshes = number + 1;
    return CLI_DONE;
}

/* ---- out ---- */

static int judge_mesh(cli_run *run, const bvx_mesh *mesh, int number, const char *path)
{
    bvx_mesh const placed = placed_mesh(run, mesh);

    /* Readers may not simply get the mesh: STL has no indices, STL and GLB hold floats. */
    int32_t const format = bvx_format_of_name(path);
    int const framed = placed.frame[0] != 0.0 || placed.frame[1] != 0.0 || placed.frame[2] != 0.0;
    return (format == BVX_FORMAT_STL || framed || cli_turn_of(run) != BVX_TURN_NONE ||
            (format == BVX_FORMAT_GLB && (placed.position_type == BVX_F64 || run->options->quantize)))
               ? certify_file(run, &placed, 1, number, path)
               : CLI_DONE;
}

/* What of its inputs the run's files have. */
static void note_kept(cli_run *run, const bvx_mesh *mesh, const char *path)
{
    run->report.kept |= cli_attributes_of(mesh) & attributes_of_format(bvx_format_of_name(path));
}

static int put_mesh(cli_run *run, const bvx_mesh *mesh, int number, const char *path)
{
    bvx_mesh const placed = placed_mesh(run, mesh);
    bvx_write_options const o = write_options(run, mesh, 1);
    bvx_buffer file = {0};
    note_kept(run, mesh, path);
    return cli_write_buffer(run, number,
                            bvx_write_mesh(run->context, &placed, 1, &o, bvx_format_of_name(path), &file),
                            &file, path);
}

static int write_judged(cli_run *run, const bvx_mesh *mesh, int number, const char *path, int keep)
{
    CLI_TRY(judge_mesh(run, mesh, number, path));
    cli_stage_begin(run, "write");
    int result = put_mesh(run, mesh, number, path);
    if (result == CLI_DONE && keep) result = cli_keep_outputs(run);
    cli_stage_end(run);
    return result;
}

int cli_write_mesh_as(cli_run *run, const bvx_mesh *mesh, int number, const char *path)
{
    return write_judged(run, mesh, number, path, 0);
}

int cli_write_mesh(cli_run *run, const bvx_mesh *mesh)
{
    return write_judged(run, mesh, 0, run->options->output, 1);
}

int cli_open_levels(cli_run *run, int count, char **path)
{
    int const in_one = !cli_has_number(run->options->output);
    int status = CLI_DONE;
    for (int i = 0; i < count && status == CLI_DONE; i++) {
        path[i] = in_one && i > 0 ? path[0] : cli_numbered_path(run->options->output, i);
        if (path[i] == NULL) return cli_fail(run, "no memory for a file's name");
        if (!in_one || i == 0) status = cli_open_output(run, path[i]);
    }
    return status;
}

int cli_write_levels(cli_run *run, const bvx_mesh *levels, int count, char *const *path)
{
    int result = CLI_DONE;
    if (count > 1 && path[1] == path[0]) {
        bvx_mesh *const placed = malloc((size_t)count * sizeof *placed);
        bvx_write_options const o = write_options(run, levels, count);
        bvx_buffer file = {0};

        if (placed == NULL) return cli_fail(run, "no memory for %d levels", count);
        for (int i = 0; i < count; i++) {
            placed[i] = placed_mesh(run, &levels[i]);
            note_kept(run, &levels[i], path[0]);
        }

        result = certify_file(run, placed, count, 0, path[0]);
        cli_stage_begin(run, "write");
        if (result == CLI_DONE)
            result = cli_write_buffer(
                run, 0,
                bvx_write_mesh(run->context, placed, (uint64_t)count, &o, bvx_format_of_name(path[0]), &file),
                &file, path[0]);
        if (result == CLI_DONE) result = cli_keep_outputs(run);
        if (result == CLI_DONE) cli_stage_end(run);
        free(placed);
        return result;
    }
    for (int i = 0; i < count && result == CLI_DONE; i++) result = judge_mesh(run, &levels[i], i, path[i]);
    cli_stage_begin(run, "write");
    for (int i = 0; i < count && result == CLI_DONE; i++) result = put_mesh(run, &levels[i], i, path[i]);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    if (result == CLI_DONE) cli_stage_end(run);
    return result;
}
