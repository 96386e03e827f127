/* cmd_labels.c - bitvox labels: the bodies of a segmentation with shared faces, a file for each or one .glb.
 *
 * Source: slicer.org, "Segmentations: file format" (the keys SegmentN_LabelValue, _Name and _Color of an NRRD's
 * head). */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct labels_options {
    bvx_labels_options surfaces;
    const char *only;  /* names or values, commas between */
    const char *names; /* a file */
} labels_options;

static void start_labels(void *options)
{
    labels_options *const o = options;
    o->surfaces = (bvx_labels_options){.struct_size = sizeof o->surfaces};
}

#define OWN(name) CLI_OWN(labels_options, name)

static const cli_argument labels_rows[] = {
    {.also = cli_takes_output},
    TEXT("--only", "A,B,C", OWN(only), "these labels, by their names or values [all]"),
    FILE_NAME("--names", "FILE", OWN(names),
              "lines of a number, a name and red, green, blue: FreeSurfer's, .csv, .tsv;\n"
              "or ITK-SNAP's"),
    LONG("--background", "N", OWN(surfaces.background), 0, 9223372036854774784.0,
         "the label that is no body [0]"),
    FLAG("--staircase", OWN(surfaces.staircase), "vertices stay at the corners of voxels [smoothed]"),
    LONG("--triangles", "N", OWN(surfaces.triangles), 1, 4294967295.0,
         "fewer triangles, so many of all labels together; faces stay shared [all]"),
    BETWEEN("--error", "D", OWN(surfaces.error), 0, 1e30,
            "fewer triangles, the fewest found whose mean distance from all is D at\n"
            "most, in the volume's unit"),
    LIST("--window", "A,B,C,D,E,F", SHARED(window), 0, LARGEST_SIDE, 6, 6,
         "only voxels A..D-1, B..E-1, C..F-1 of the volume"),
    FLAG("--open", OWN(surfaces.open),
         "the window has one voxel more where the volume goes on, and bodies end\n"
         "there where those of the next window begin"),
    {.also = cli_takes_raw},
    {.also = cli_takes_normals},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_all},
    {0}};

enum { VALUE_ROOM = 24, HEAD_ROOM = 1 << 20, KEY_ROOM = 64, LINE_ROOM = 512 };

typedef struct label_body {
    uint64_t at; /* index of the complex's labels */
    char value[VALUE_ROOM], *path;
    const char *name; /* of the file, or the value */
    char *named;
    int32_t coloured, chosen;
    uint8_t colour[4];
} label_body;

typedef struct labels_job {
    cli_volume volume;
    cli_bytes table; /* of names */
    bvx_complex complex;
    label_body *body, **chosen;
    int count, meshes; /* of labels, of those chosen */
    bvx_mesh *mesh;
    const char **names;
    uint8_t *colours;
} labels_job;

/* ---- what is requested ---- */

enum { IS_VOLUME = 1 << CLI_FIRST_FACT, HAS_TWO = 2 << CLI_FIRST_FACT /* %s */ };

static const cli_rule labels_rules[] = {
    {.unless = IS_VOLUME, .message = "labels are of volumes (.nrrd .nhdr .npy .vti .raw), which %i is not%w"},
    {.given = "--triangles", .beside = "--error", .message = "%o and %b exclude each other"},
    {.given = "--triangles --error", .beside = "--staircase", .message = "%o and %b exclude each other"},
    {.given = "--open", .lacking = "--window", .message = "%o needs --window"},
    {.also = cli_to_mesh_rules},
    {.also = cli_mesh_file_rules},
    {.when = HAS_TWO, .message = "%f: the name has two %s"},
    {0}};

/* ---- names and colors ---- */

/* The text after "SegmentN_KEY:=" in an NRRD's head; NULL where there is none. */
static const char *find_segment(const cli_bytes *file, int n, const char *key, size_t *size)
{
    const char *p = (const char *)file->bytes;
    const char *const end = p + (file->size < HEAD_ROOM ? file->size : HEAD_ROOM);
    char start[KEY_ROOM];
    size_t const length = (size_t)snprintf(start, sizeof start, "\nSegment%d_%s:=", n, key);

    for (; p != NULL && (size_t)(end - p) > length; p = memchr(p + 1, '\n', (size_t)(end - p - 1))) {
        if (*p == '\n' && (p[1] == '\n' || (p[1] == '\r' && p[2] == '\n'))) return NULL;
        if (memcmp(p, start, length) != 0) continue;
        p += length;
        for (*size = 0; p + *size < end && p[*size] != '\n' && p[*size] != '\r';) ++*size;
        return *size != 0 ? p : NULL;
    }
    return NULL;
}

static label_body *find_body(labels_job *j, const char *text, size_t size, int by_name)
{
    for (int i = 0; i < j->count; i++) {
        const char *const own = by_name ? j->body[i].name : j->body[i].value;
        if (strlen(own) == size && memcmp(own, text, size) == 0) return &j->body[i];
    }
    return NULL;
}

static int take_name(cli_run *run, label_body *b, const char *text, size_t size)
{
    if ((b->named = malloc(size + 1)) == NULL) return cli_fail(run, "no memory for names");
    memcpy(b->named, text, size);
    b->named[size] = 0;
    b->name = b->named;
    for (char *p = b->named; *p != 0; p += cli_utf8_length(p) + (cli_utf8_length(p) == 0))
        if (cli_utf8_length(p) == 0 || (unsigned char)*p < ' ') *p = '?';
    return CLI_DONE;
}

static int take_segments(cli_run *run, labels_job *j)
{
    const cli_bytes *const file = &j->volume.file;
    const char *text;
    char colour[KEY_ROOM];
    size_t size;

    for (int n = 0; (text = find_segment(file, n, "LabelValue", &size)) != NULL; n++) {
        label_body *const b = find_body(j, text, size, 0);
        if (b == NULL || b->named != NULL) continue;
        text = find_segment(file, n, "Color", &size);
        int const coloured = text != NULL && size < sizeof colour;
        char *p = colour;
        if (coloured) snprintf(colour, sizeof colour, "%.*s", (int)size, text);
        if (coloured) b->coloured = 1;
        for (int c = 0; coloured && c < 3; c++) {
            double const v = strtod(p, &p);
            b->colour[c] = (uint8_t)(v >= 1.0 ? 255.0 : v > 0.0 ? v * 255.0 + 0.5 : 0.0);
        }
        if ((text = find_segment(file, n, "Name", &size)) == NULL) continue;
        CLI_TRY(take_name(run, b, text, size));
    }
    return CLI_DONE;
}

static int take_table(cli_run *run, labels_job *j, const char *path)
{
    static const char *const forms[3] = {
        " %23[^,;\t]%*1[,;\t]\"%511[^\"]\"%*1[,;\t]%3d%*1[,;\t]%3d%*1[,;\t]%3d",
        " %23[^,;\t]%*1[,;\t]%511[^,;\t\r]%*1[,;\t]%3d%*1[,;\t]%3d%*1[,;\t]%3d", "%23s %511s %3d %3d %3d"};
    char line[LINE_ROOM];
    int named = 0;

    CLI_TRY(cli_read_bytes(run, path, j->volume.file.size, &j->table));
    for (size_t at = 0, n = 0; at < j->table.size; at++) {
        char const c = (char)j->table.bytes[at];
        if (c != '\n' && n + 1 < sizeof line) line[n++] = c;
        if (c != '\n' && at + 1 < j->table.size) continue;
        line[n] = 0;
        n = 0;

        /* A line of ITK-SNAP, of .csv or .tsv with a name that may stand in quotes, or of FreeSurfer. */
        char value[VALUE_ROOM], name[LINE_ROOM];
        int rgb[3], got = sscanf(line, "%23s %3d %3d %3d %*d %*d %*d \"%511[^\"]", value, &rgb[0], &rgb[1],
                                 &rgb[2], name);

        if (got < 5) got = 0;
        for (int i = 0; i < 3 && got < 2; i++)
            got = sscanf(line, forms[i], value, name, &rgb[0], &rgb[1], &rgb[2]);
        label_body *const b = got < 2 ? NULL : find_body(j, value, strlen(value), 0);
        if (b == NULL || b->named != NULL) continue;
        b->coloured = got == 5 && (uint32_t)(rgb[0] | rgb[1] | rgb[2]) < 256;
        for (int i = 0; i < 3 && b->coloured; i++) b->colour[i] = (uint8_t)rgb[i];
        CLI_TRY(take_name(run, b, name, strlen(name)));
    }
    for (int i = 0; i < j->count; i++) named += j->body[i].named != NULL;
    return named != 0 ? CLI_DONE : cli_fail(run, "%s: no line has the number of a label and a name", path);
}

static int list_bodies(cli_run *run, labels_job *j)
{
    const bvx_complex *const c = &j->complex;
    const char *const in = cli_first_name(run);

    if (c->label_count == 0) return cli_fail(run, "%s: all samples are the background", in);
    if (c->label_count >= INT32_MAX || (j->body = calloc((size_t)c->label_count, sizeof *j->body)) == NULL)
        return cli_fail(run, "no memory for %" PRIu64 " labels", c->label_count);
    for (uint64_t i = 0; i < c->label_count; i++) {
        label_body *const b = &j->body[j->count];
        int64_t const value = c->labels[i].value;

        /* Of an open window some have all their faces in others. */
        if (c->first[i] == c->first[i + 1]) continue;
        j->count++;
        b->at = i;
        if (j->volume.view.sample_type == BVX_SAMPLE_U64)
            snprintf(b->value, sizeof b->value, "%" PRIu64, (uint64_t)value);
        else snprintf(b->value, sizeof b->value, "%" PRId64, value);
        b->name = b->value;
    }
    if (j->count == 0) return cli_fail(run, "%s: no label has a face of its own in this window", in);
    const char *const names = ((const labels_options *)run->own)->names;
    if (names != NULL) CLI_TRY(take_table(run, j, names));
    return cli_input_format(run, run->options->input[0]) == BVX_FORMAT_NRRD ? take_segments(run, j)
                                                                            : CLI_DONE;
}

static int choose_bodies(cli_run *run, labels_job *j)
{
    const labels_options *const own = run->own;

    for (const char *p = own->only; p != NULL;) {
        size_t const n = strcspn(p, ",");
        label_body *b = find_body(j, p, n, 0);
        if (b == NULL) b = find_body(j, p, n, 1);
        if (b == NULL)
            return cli_fail(run, "%s: --only: there is no label '%.*s'; the first is %s, the last %s",
                            cli_first_name(run), (int)n, p, j->body[0].name, j->body[j->count - 1].name);
        b->chosen = 1;
        p = p[n] == ',' ? p + n + 1 : NULL;
    }
    if ((j->chosen = calloc((size_t)j->count, sizeof *j->chosen)) == NULL)
        return cli_fail(run, "no memory for %d labels", j->count);
    for (int i = 0; i < j->count; i++)
        if (own->only == NULL || j->body[i].chosen) j->chosen[j->meshes++] = &j->body[i];
    return CLI_DONE;
}

static int take_labels(cli_run *run, labels_job *j)
{
    const labels_options *const own = run->own;
    const char *const out = run->options->output;

    cli_stage_begin(run, "surfaces");
    CLI_TRY(cli_stage_check(run,
                            bvx_label_surfaces(run->context, &j->volume.view, &own->surfaces, &j->complex),
                            cli_first_name(run)));
    CLI_TRY(list_bodies(run, j));

    /* Colors of the theme "Set2" and "Dark2" of colorbrewer2.org, by turns. */
    static const uint8_t of[14][3] = {{102, 194, 165}, {217, 95, 2},    {141, 160, 203}, {231, 41, 138},
                                      {166, 216, 84},  {117, 112, 179}, {255, 217, 47},  {27, 158, 119},
                                      {252, 141, 98},  {102, 166, 30},  {231, 138, 195}, {166, 118, 29},
                                      {229, 196, 148}, {102, 102, 102}};

    for (int i = 0; i < j->count; i++) {
        if (!j->body[i].coloured) memcpy(j->body[i].colour, of[j->body[i].at % 14], 3);
        j->body[i].colour[3] = 255;
    }

    CLI_TRY(choose_bodies(run, j));
    if (j->meshes > CLI_MAX_OUTPUTS)
        return cli_fail(run, "%s: %d labels, more than the %d meshes of one run; choose some by --only",
                        cli_first_name(run), j->meshes, CLI_MAX_OUTPUTS);
    if (j->meshes > 1 && strstr(out, "%s") == NULL && !CLI_HOLDS(run, CLI_TO_GLB))
        return cli_usage(
            run,
            "%s: %d labels need %%s in the name, for the name or number of each; only .glb holds "
            "several, and --only chooses one",
            out, j->meshes);
    return CLI_DONE;
}

/* ---- files ---- */

/* The output's name with a label's name in it, of which files' names may have no part; the value where another
 * label has this name too. */
static char *path_of(const cli_run *run, const labels_job *j, const label_body *b)
{
    const char *const out = run->options->output, *const place = strstr(out, "%s");
    const char *word = b->name;
    size_t const before = place != NULL ? (size_t)(place - out) : strlen(out);

    for (int i = 0; i < j->meshes; i++)
        if (j->chosen[i] != b && cli_same_name(j->chosen[i]->name, b->name)) word = b->value;
    char *path = malloc(strlen(out) + strlen(word) + 1);
    if (path == NULL) return NULL;
    sprintf(path, "%.*s%s%s", (int)before, out, place != NULL ? word : "", place != NULL ? place + 2 : "");
    for (char *p = path + before; place != NULL && p < path + before + strlen(word); p++)
        if (strchr("/\\:*?\"<>|", *p) != NULL) *p = '_';
    return path;
}

static int write_label_bodies(cli_run *run, void *work)
{
    labels_job *const j = work;
    char *const path[2] = {j->chosen[0]->path, j->chosen[0]->path};

    if (strstr(run->options->output, "%s") != NULL) return cli_keep_outputs(run);
    run->names = j->names;
    run->colours = j->colours;
    return cli_write_levels(run, j->mesh, j->meshes, path);
}

static int make_labels(cli_run *run, void *work, cli_made *made)
{
    labels_job *const j = work;
    bvx_window window;

    made->write = write_label_bodies;

    const cli_options *const o = run->options;
    const char *const place = strstr(o->output, "%s");
    uint32_t facts = cli_may_be_volume(cli_input_format(run, o->input[0])) ? IS_VOLUME : 0;

    if (place != NULL && strstr(place + 2, "%s") != NULL) facts |= HAS_TWO;
    CLI_TRY(cli_check_rules(run, labels_rules, facts, cli_way_around(cli_first_name(run), 0)));
    CLI_TRY(cli_window_option(run, &window));

    if (strstr(run->options->output, "%s") == NULL) CLI_TRY(cli_open_output(run, run->options->output));
    CLI_TRY(cli_read_volume(run, run->options->input[0], &window, &j->volume));
    CLI_TRY(take_labels(run, j));
    int const several = strstr(run->options->output, "%s") != NULL;

    j->mesh = calloc((size_t)j->meshes, sizeof *j->mesh);
    j->names = calloc((size_t)j->meshes, sizeof *j->names);
    j->colours = calloc((size_t)j->meshes, 4);
    if (j->mesh == NULL || j->names == NULL || j->colours == NULL)
        return cli_fail(run, "no memory for %d meshes", j->meshes);
    run->progress.rounds = j->meshes;
    for (int i = 0; i < j->meshes; i++) {
        label_body *const b = j->chosen[i];

        if ((b->path = path_of(run, j, b)) == NULL) return cli_fail(run, "no memory for a file's name");
        j->names[i] = b->name;
        memcpy(j->colours + 4 * i, b->colour, 4);
        if (several) CLI_TRY(cli_open_output(run, b->path));
        CLI_TRY(
            CLI_STAGE(run, "body", bvx_label_mesh(run->context, &j->complex, b->at, &j->mesh[i]), b->name));
        CLI_TRY(cli_check_mesh(run, &j->mesh[i], i, b->path, "check"));
        if (!several) continue;
        /* One file after the other, so that one mesh is held. */
        run->names = &j->names[i];
        run->colours = j->colours + 4 * i;
        CLI_TRY(cli_write_mesh_as(run, &j->mesh[i], i, b->path));
        bvx_mesh_free(run->context, &j->mesh[i]);
        if (cli_interrupted()) return cli_fail_interrupted(run);
    }
    return CLI_DONE;
}

static void tell_label_bodies(const cli_run *run, const void *work, cli_made *made)
{
    const labels_job *const j = work;
    cli_text *const t = &made->members;

    cli_text_add(t, ", \"labels\": [");
    for (int i = 0; i < j->meshes; i++) {
        const label_body *const b = j->chosen[i];
        const bvx_label *const label = &j->complex.labels[b->at];
        cli_text_add(t, "%s{\"value\": %s, \"name\": ", i == 0 ? "" : ", ", b->value);
        cli_json_string(t, b->name);
        cli_json_count(t, "voxels", label->voxels);
        cli_json_ints(t, "low", label->low);
        cli_json_ints(t, "size", label->size);
        cli_text_add(t, "}");
        cli_tell_mesh_of(run, i, strstr(run->options->output, "%s") != NULL ? b->path : b->name, made);
    }
    cli_text_add(t, "]");
}

static void free_labels(cli_run *run, void *work)
{
    labels_job *const j = work;

    for (int i = 0; i < j->meshes && j->mesh != NULL; i++) bvx_mesh_free(run->context, &j->mesh[i]);
    for (int i = 0; i < j->count; i++) {
        free(j->body[i].named);
        free(j->body[i].path);
    }
    free(j->body);
    free(j->mesh);
    bvx_complex_free(run->context, &j->complex);
}

static const cli_owned labels_owns[] = {
    CLI_OWNS(BYTES, labels_job, names),   CLI_OWNS(BYTES, labels_job, colours),
    CLI_OWNS(BYTES, labels_job, chosen),  CLI_OWNS(BYTES, labels_job, table.bytes),
    CLI_OWNS(VOLUME, labels_job, volume), {0}};

const cli_command cli_labels = {
    .name = "labels",
    .bit = CLI_LABELS,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT_%s.EXT [options]",
    .does = "a closed body of each label of a segmentation, with shared faces",
    .details =
        "Reads a volume of whole numbers (.nrrd .nhdr .npy .vti .raw) and writes the surface of each label's\n"
        "voxels, smoothed: closed, manifold, and where two labels touch the same faces in both. %s in the name\n"
        "is the label's name, of --names or of an NRRD of 3D Slicer, or its number. Without %s a .glb has a node\n"
        "for each label, with its name and color. 'bitvox voxelize --label' makes a grid of one label.",
    .example = "bitvox labels fixtures/labels.npy -o body_%s.ply\n"
               "bitvox labels fixtures/labels.npy -o bodies.glb --only 1,7 --triangles 1000",
    .most =
        "--only --names --background --staircase --triangles --error --window --open --threads --memory-limit --json",
    .rows = labels_rows,
    .start = start_labels,
    .own = sizeof(labels_options),
    .job = {.size = sizeof(labels_job),
            .make = make_labels,
            .tell = tell_label_bodies,
            .owns = labels_owns,
            .free = free_labels}};
