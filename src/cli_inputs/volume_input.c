/* volume_input.c - scalar volumes by their files, and the voxels that --level, --range and --label choose of
 * them.
 *
 * The samples stay in the file's bytes where they can. The data files of a detached head are looked for
 * beside it. */
#include "cli_inputs/inputs.h"

#include <float.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { DATA_NAME_ROOM = 4096 };

/* ---- what is requested ---- */

#define OF_RAW     "--shape --sample-type --big-endian --skip --voxel-size"
#define OF_VOLUMES "--level --range --label --below"

enum { IS_RAW = 1 << CLI_FIRST_FACT }; /* a .raw file is read */

/* The word is the input's name. */
static const cli_rule selection_rules[] = {
    {.given = "--below", .lacking = "--level", .message = "%o needs --level"},
    {.unless = IS_RAW, .given = OF_RAW, .message = "%o is for .raw files; %w states it itself"},
    {0}};

static const cli_rule raw_rules[] = {
    {.lacking = "--shape",
     .message = "%w holds bare samples: --shape X,Y,Z and --sample-type say what they are"},
    {.lacking = "--sample-type",
     .message = "%w holds bare samples: --shape X,Y,Z and --sample-type say what they are"},
    {0}};

int cli_check_volume_options(cli_run *run)
{
    const char *const given = cli_given_of(run, OF_VOLUMES " " OF_RAW);
    const cli_options *const o = run->options;
    int volumes = 0, raw = 0;

    if ((run->command->bit & (CLI_VOXELIZE | CLI_LOD | CLI_FACES | CLI_RENDER | CLI_CONVERT | CLI_INFO)) == 0)
        return CLI_DONE;
    for (int i = 0; i < o->inputs; i++) {
        int32_t const format = cli_input_format(run, o->input[i]);
        /* refused later, by its name */
        if (cli_kind_of_input(format) == 0 && format != BVX_FORMAT_RAW && format != BVX_FORMAT_XYZ)
            return CLI_DONE;
        volumes += cli_may_be_volume(format);
        raw += format == BVX_FORMAT_RAW;
    }

    if (given == NULL) return CLI_DONE;
    /* Which of several inputs is meant is not said: one volume among them is enough. */
    if (volumes == 0) {
        int32_t const format = cli_input_format(run, o->input[0]);
        const char *const kind = cli_kind_of_input(format) == CLI_MESH ? "a mesh"
                                 : format == BVX_FORMAT_XYZ            ? "a cloud of points"
                                                                       : "a grid";
        /* --level and --levels differ by a letter: the other one may be meant. */
        const char *const meant = cli_mistaken_for(run, given);
        return cli_usage(run, "%s is for volumes (.nrrd .nhdr .npy .vti .raw); %s is %s%s%s%s", given,
                         cli_input_name(o->input[0]), kind, meant != NULL ? "; did you mean " : "",
                         meant != NULL ? meant : "", meant != NULL ? "?" : "");
    }
    return cli_check_rules(run, selection_rules, raw != 0 ? IS_RAW : 0, cli_first_name(run));
}

int cli_check_selection(cli_run *run, const char *path)
{
    int const raw = cli_input_format(run, path) == BVX_FORMAT_RAW;
    if (cli_selects(run) > 1) return cli_usage(run, "--level, --range and --label exclude each other");
    CLI_TRY(cli_check_rules(run, selection_rules, raw ? IS_RAW : 0, cli_input_name(path)));
    return raw ? cli_check_rules(run, raw_rules, 0, cli_input_name(path)) : CLI_DONE;
}

/* ---- data files ---- */

/* 1: what the name says lies in the head's folder or below. A head from a
 * stranger must not choose what else is read. */
static int stays_below(const char *name)
{
#if defined(_WIN32)
    if (strpbrk(name, "\\:") != NULL) return 0;
#endif
    if (name[0] == '/') return 0;
    for (const char *part = name;;) {
        size_t const n = strcspn(part, "/");
        /* By parts: a name may well hold two dots, "a..raw". */
        if (n == 2 && part[0] == '.' && part[1] == '.') return 0;
        if (part[n] == 0) return 1;
        part += n + 1;
    }
}

/* A head of a few bytes may name a file many times: head and data count together against the memory there
 * is. */
static int add_data_file(cli_run *run, const char *path, uint64_t head_size, cli_bytes *all)
{
    cli_bytes one = {NULL, 0, 0, 0};
    int status = cli_read_bytes(run, path, head_size + all->size, &one);

    if (status == CLI_DONE && all->bytes == NULL) {
        *all = one;
        return CLI_DONE;
    }
    if (status == CLI_DONE) {
        unsigned char *const more = one.size <= SIZE_MAX - all->size
                                        ? realloc(all->bytes, all->size + one.size + 1)
                                        : NULL;
        if (more == NULL) {
            status = cli_fail(run, "%s: no memory for %" PRIu64 " bytes of it", path, (uint64_t)one.size);
        } else {
            memcpy(more + all->size, one.bytes, one.size);
            all->bytes = more;
            all->size += one.size;
        }
    }
    free(one.bytes);
    return status;
}

/* The bytes of all files that a detached head names, one after the other; of one that is attached none. */
static int read_data_files(cli_run *run, const char *head, cli_volume *v)
{
    char name[DATA_NAME_ROOM];
    uint64_t count = 0;
    bvx_status found = bvx_volume_data_name(run->context, v->file.bytes, v->file.size, 0, NULL, 0, &count);
    int status = found == BVX_OK ? CLI_DONE : cli_fail_status(run, found, cli_input_name(head));

    if (count == 0) return status;
    cli_stage_begin(run, "read samples");
    for (uint64_t i = 0; i < count && status == CLI_DONE; i++) {
        found = bvx_volume_data_name(run->context, v->file.bytes, v->file.size, i, name, sizeof name, &count);
        if (found != BVX_OK) return cli_fail_status(run, found, cli_input_name(head));
        if (!stays_below(name))
            return cli_fail(
                run,
                "%s: its samples are said to be in %s; only files in its own folder or below are read: put "
                "them there",
                cli_input_name(head), name);
        const char *const slash = strrchr(head, '/');
        size_t const folder = slash == NULL ? 0 : (size_t)(slash - head) + 1;
        char *const path = malloc(folder + strlen(name) + 1);
        if (path != NULL) {
            memcpy(path, head, folder);
            strcpy(path + folder, name);
        }
        status = path != NULL ? add_data_file(run, path, v->file.size, &v->data)
                              : cli_fail(run, "no memory for a file's name");
        free(path);
    }
    if (status == CLI_DONE) cli_stage_end(run);
    return status;
}

/* ---- the volume ---- */

int64_t cli_sample_bytes(int32_t type)
{
    static const int64_t bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return bytes[type];
}

void cli_volume_strides(const bvx_volume_view *view, int64_t stride[3])
{
    memcpy(stride, view->strides, 3 * sizeof *stride);
    if (stride[0] != 0 || stride[1] != 0 || stride[2] != 0) return;
    stride[0] = cli_sample_bytes(view->sample_type);
    stride[1] = stride[0] * view->size[0];
    stride[2] = stride[1] * view->size[1];
}

static int take_window(cli_run *run, const char *path, const bvx_window *window, cli_volume *v)
{
    const bvx_volume_view *const whole = &v->volume.view;
    static const char axis[] = "xyz";
    int64_t stride[3], at = 0;

    v->view = *whole;
    if (window == NULL || window->size[0] == 0) return CLI_DONE;
    for (int a = 0; a < 3; a++) /* Without an overflow: low and size are both within the lattice's limit. */
        if (window->low[a] > whole->size[a] - window->size[a])
            return cli_fail(run,
                            "%s: the window's voxels %" PRId32 " to %" PRId32
                            " along %c are not inside the file's %" PRId32,
                            cli_input_name(path), window->low[a], window->low[a] + window->size[a] - 1,
                            axis[a], whole->size[a]);

    /* packed samples are packed no more where rows are left out */
    cli_volume_strides(whole, stride);
    for (int a = 0; a < 3; a++) {
        v->view.low[a] += window->low[a];
        v->view.size[a] = window->size[a];
        v->view.strides[a] = stride[a];
        at += window->low[a] * stride[a];
    }
    v->view.samples = (const char *)whole->samples + at;
    return CLI_DONE;
}

/* The side-car of an .npy file says where its voxels lie. */
static int place_volume(cli_run *run, const char *path, cli_volume *v)
{
    bvx_volume_view *const w = &v->volume.view;

    v->placed = v->volume.placed;
    if (!cli_needs_sidecar(cli_input_format(run, path))) return CLI_DONE;
    /* Side-cars are read for grids: one without voxels carries the lattice through. */
    bvx_grid grid = {.lattice = w->lattice};
    memcpy(grid.size, w->size, sizeof grid.size);
    int status = cli_read_sidecar(run, path, &grid, &v->placed);
    w->lattice = grid.lattice;
    memcpy(w->low, grid.low, sizeof w->low);
    return status;
}

int cli_take_volume(cli_run *run, const char *path, const bvx_window *window, cli_volume *v)
{
    int32_t const format = cli_input_format(run, path);
    bvx_read_volume_options o = {.struct_size = sizeof o};

    if (format == BVX_FORMAT_NRRD) CLI_TRY(read_data_files(run, path, v));
#ifdef BVX_HAVE_ZLIB
    o.inflate = cli_inflate;
#else
    if (v->data.bytes != NULL) o.inflate = cli_inflate; /* plain bytes, as it turns out, or a refusal */
#endif
    o.inflate_user = format == BVX_FORMAT_NRRD ? v : NULL;
    o.data = v->data.bytes;
    o.data_size = v->data.size;

    const cli_options *const given = run->options;

    o.sample_type = given->sample_type;
    o.big_endian = given->big_endian;
    o.offset = (uint64_t)given->skip;
    for (int a = 0; a < 3; a++) {
        o.size[a] = given->shape.count == 3 ? (int32_t)given->shape.value[a] : 0;
        if (given->voxel_size.given) o.spacing[a] = given->voxel_size.value[a];
    }

    cli_stage_begin(run, "parse");
    bvx_status const read = bvx_read_volume(run->context, v->file.bytes, v->file.size, format, &o,
                                            &v->volume);
    cli_end_parse(run, (uint64_t)v->file.size + v->data.size);
#ifndef BVX_HAVE_ZLIB
    if (read == BVX_ERR_UNSUPPORTED && bvx_last_error(run->context)->reason == BVX_REASON_COMPRESSED)
        return cli_fail(run, "%s: packed samples, which this build cannot unpack: it was made without zlib",
                        cli_input_name(path));
#endif
    CLI_TRY(cli_check_call(run, read, cli_input_name(path)));
    CLI_TRY(place_volume(run, path, v));
    return take_window(run, path, window, v);
}

int cli_read_volume(cli_run *run, const char *path, const bvx_window *window, cli_volume *v)
{
    memset(v, 0, sizeof *v);
    CLI_TRY(cli_check_selection(run, path));
    CLI_TRY(cli_open_input(run, path, &v->file));
    return cli_take_volume(run, path, window, v);
}

void cli_free_volume(cli_run *run, cli_volume *v)
{
    bvx_volume_free(run->context, &v->volume);
    free(v->data.bytes);
    free(v->file.bytes);
    memset(v, 0, sizeof *v);
}

/* ---- voxels of it ---- */

bvx_status cli_select_voxels(cli_run *run, const cli_volume *v, bvx_volume_report *report, bvx_grid *grid)
{
    const cli_options *const o = run->options;
    int64_t const label = o->value_label;
    if (o->range.given)
        return bvx_threshold(run->context, &v->view, o->range.value[0], o->range.value[1], report, grid);
    /* What is not 0 lies on two sides of it. */
    if (!cli_selects(run)) {
        double const least = DBL_MIN * DBL_EPSILON; /* the least double above 0 */
        bvx_grid under = {0};
        uint64_t words;

        CLI_TRY(bvx_threshold(run->context, &v->view, least, HUGE_VAL, report, grid));
        CLI_TRY(bvx_threshold(run->context, &v->view, -HUGE_VAL, -least, NULL, &under));
        words = (uint64_t)grid->words_per_row * (uint64_t)grid->size[1] * (uint64_t)grid->size[2];
        for (uint64_t w = 0; w < words; w++) grid->words[w] |= under.words[w];
        bvx_grid_free(run->context, &under);
        return bvx_grid_count(run->context, grid, &report->inside);
    }
    if (cli_given(run, "--label") && v->view.sample_type < BVX_SAMPLE_F32)
        return bvx_threshold_whole(run->context, &v->view, label, label, report, grid);
    if (cli_given(run, "--label"))
        return bvx_threshold(run->context, &v->view, (double)label, (double)label, report, grid);
    return bvx_threshold(run->context, &v->view, o->below ? -HUGE_VAL : o->level,
                         o->below ? o->level : HUGE_VAL, report, grid);
}

void cli_tell_volume(cli_run *run, const cli_volume *v, const bvx_volume_report *r, cli_text *t)
{
    cli_text_add(t, ", \"volume\": {\"type\": \"%s\"", cli_sample_names[v->view.sample_type - BVX_SAMPLE_U8]);
    cli_json_ints(t, "size", v->view.size);
    cli_json_value(t, "least", r->least);
    cli_json_value(t, "greatest", r->greatest);
    cli_json_count(t, "nan", r->nan);
    cli_json_count(t, "infinite", r->infinite);
    cli_text_add(t, "}");
    if (r->nan + r->infinite != 0)
        cli_keep_warning(run, BVX_WARN_READ,
                         "%" PRIu64 " samples are NaN and %" PRIu64 " infinite: they count as outside",
                         r->nan, r->infinite);
}
