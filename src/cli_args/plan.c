/* plan.c - what a command does, in its order, and about how long each stage takes beside the others: where in
 * the run's progress a stage begins and ends.
 *
 * Measured on meshes of 100,000 triangles and grids of 200 to 300 voxels a side. A stage that is left out
 * costs a jump, one that is not listed stands where the run is; neither lets the fraction fall. */
#include "cli_args/args.h"

#include <stdlib.h>
#include <string.h>

/* Rows that follow each other with the same number are gone through again and again, once for each of
 * them. */
enum { PLAN_ONCE, PLAN_FILES, PLAN_MADE, PLAN_CARRIED, PLAN_MEASURED };

typedef struct plan_row {
    int32_t commands;
    const char *stage; /* without the number of a level */
    double weight;
    int each;
    const char *given;   /* only with this option; NULL: always */
    const char *lacking; /* not with this one */
} plan_row;

enum {
    PLAN_READERS = CLI_ALL & ~CLI_RENDER,
    PLAN_CHAINS = CLI_LOD | CLI_SIMPLIFY,
    PLAN_VOXELS = CLI_VOXELIZE | CLI_MORPH | CLI_FILL | CLI_COMPONENTS,
    PLAN_GRIDS = CLI_FILL | CLI_MORPH | CLI_COMPONENTS | CLI_FACES | CLI_COMPARE | CLI_CONVERT
};

enum { MORPH_WEIGHT = 40 }; /* of each of its operations, one of which is done */

static const plan_row plan_rows[] = {
    {PLAN_READERS, "read", 8, .each = PLAN_FILES},
    {PLAN_READERS, "read samples", 1, .each = PLAN_FILES},
    {PLAN_READERS, "parse", 7, .each = PLAN_FILES},
    {PLAN_READERS, "threshold", 1, .each = PLAN_FILES},
    {CLI_RENDER, "read", 6, .each = PLAN_FILES},
    {CLI_RENDER, "read samples", 1, .each = PLAN_FILES},
    {CLI_RENDER, "parse", 4, .each = PLAN_FILES},
    {CLI_RENDER, "threshold", 1, .each = PLAN_FILES},
    {CLI_RENDER, "voxelize", 5, .each = PLAN_FILES},
    {CLI_RENDER, "compare", 2, .each = PLAN_FILES},
    {CLI_RENDER, "render", 80, .each = PLAN_FILES, .lacking = "--turntable"},
    {CLI_RENDER, "frames", 80, .each = PLAN_MADE, .given = "--turntable"},
    {PLAN_CHAINS, "check input", 5, .each = PLAN_ONCE},
    {CLI_VOXELIZE, "voxelize", 30, .each = PLAN_ONCE},
    {CLI_LOD, "voxelize", 20, .each = PLAN_ONCE},
    {PLAN_GRIDS, "voxelize", 10, .each = PLAN_ONCE},
    {CLI_VOXELIZE, "compare fills", 60, .each = PLAN_ONCE, .given = "--compare-fills"},
    {CLI_INFO, "samples", 10, .each = PLAN_ONCE},
    {CLI_CONVERT, "labels", 5, .each = PLAN_ONCE},
    {CLI_FILL, "seeds", 40, .each = PLAN_ONCE},
    {CLI_FILL, "fill", 40, .each = PLAN_ONCE},
    {CLI_COMPONENTS, "keep", 12, .each = PLAN_ONCE},
    {CLI_COMPONENTS, "components", 60, .each = PLAN_ONCE},
    {CLI_COMPONENTS, "labels", 20, .each = PLAN_ONCE},
    {CLI_MORPH, "dilate", MORPH_WEIGHT, .each = PLAN_ONCE},
    {CLI_MORPH, "erode", MORPH_WEIGHT, .each = PLAN_ONCE},
    {CLI_MORPH, "open", MORPH_WEIGHT, .each = PLAN_ONCE},
    {CLI_MORPH, "close", MORPH_WEIGHT, .each = PLAN_ONCE},
    {CLI_MORPH, "hollow", MORPH_WEIGHT, .each = PLAN_ONCE},
    {CLI_MORPH, "distance", MORPH_WEIGHT, .each = PLAN_ONCE},
    {CLI_REFINE, "refine", 40, .each = PLAN_ONCE},
    {CLI_REFINE | CLI_CONVERT, "expand", 10, .each = PLAN_ONCE},
    {CLI_REPAIR, "repair", 100, .each = PLAN_ONCE},
    {CLI_BOOLEAN, "boolean", 70, .each = PLAN_ONCE},
    {CLI_SECTIONS, "sections", 70, .each = PLAN_ONCE},
    {CLI_SECTIONS, "blocks", 70, .each = PLAN_ONCE},
    {CLI_LOD | CLI_CONVERT | CLI_SLICE, "surface", 10, .each = PLAN_ONCE},
    {CLI_REFINE, "surface", 90, .each = PLAN_ONCE},
    {PLAN_VOXELS, "surface", 60, .each = PLAN_ONCE},
    {CLI_FACES, "faces", 10, .each = PLAN_ONCE},
    {CLI_REPAIR | CLI_BOOLEAN | CLI_SECTIONS | CLI_CONVERT | PLAN_VOXELS, "simplify", 60, .each = PLAN_ONCE},
    {CLI_SLICE, "slice", 40, .each = PLAN_ONCE},
    {PLAN_CHAINS, "level", 90, .each = PLAN_MADE},
    {PLAN_CHAINS, "carry", 10, .each = PLAN_MADE, .given = "--carry"},
    {PLAN_CHAINS, "check", 2, .each = PLAN_MADE},
    {PLAN_CHAINS, "carry", 10, .each = PLAN_CARRIED, .given = "--carry"},
    {PLAN_CHAINS, "distance", 50, .each = PLAN_MEASURED},
    {CLI_COMPARE, "compare", 20, .each = PLAN_ONCE},
    {CLI_COMPARE, "check A", 3, .each = PLAN_ONCE},
    {CLI_COMPARE, "check B", 20, .each = PLAN_ONCE},
    {CLI_REPAIR, "distance", 60, .each = PLAN_ONCE, .given = "--measure"},
    {CLI_REPAIR, "carry", 20, .each = PLAN_ONCE, .given = "--carry"},
    {CLI_INFO, "check", 15, .each = PLAN_ONCE},
    {CLI_INFO, "check welded", 15, .each = PLAN_ONCE},
    {CLI_INFO, "crossings", 60, .each = PLAN_ONCE, .given = "--crossings"},
    {CLI_BOOLEAN | CLI_SECTIONS | CLI_CONVERT | PLAN_VOXELS, "check", 15, .each = PLAN_ONCE},
    {CLI_FACES, "check", 35, .each = PLAN_ONCE},
    {CLI_COMPARE, "distance", 70, .each = PLAN_ONCE},
    {CLI_ALL & ~CLI_INFO & ~CLI_COMPARE & ~CLI_RENDER, "check file", 2, .each = PLAN_ONCE},
    {CLI_SLICE, "write", 70, .each = PLAN_ONCE},
    {CLI_FACES | CLI_MORPH | CLI_CONVERT | CLI_SECTIONS, "write", 15, .each = PLAN_ONCE},
    {CLI_ALL & ~(CLI_INFO | CLI_COMPARE | CLI_SLICE | CLI_FACES | CLI_MORPH | CLI_CONVERT | CLI_SECTIONS),
     "write", 4, .each = PLAN_ONCE},
};
enum { PLAN_ROWS = sizeof plan_rows / sizeof plan_rows[0] };

/* formats: BVX_..._READ or _WRITTEN. */
static int is_name_of(const char *name, uint64_t formats)
{
    int32_t const format = name == NULL ? BVX_FORMAT_UNKNOWN : bvx_format_of_name(name);

    return format > 0 && format < 32 && (formats >> format & 1) != 0;
}

/* What the kinds of files leave out, as far as their names tell. */
static int suits_files(const cli_run *run, const char *stage)
{
    const cli_options *const o = run->options;
    int32_t const bit = run->command->bit;
    int const mesh_in = is_name_of(o->inputs > 0 ? o->input[0] : NULL, BVX_MESHES_READ);
    int const mesh_out = is_name_of(o->output, BVX_MESHES_WRITTEN);

    /* Two meshes are measured, two grids are counted. */
    if (bit == CLI_COMPARE) {
        if (strcmp(stage, "compare") == 0) return !mesh_in;
        if (strncmp(stage, "check", 5) == 0 || strcmp(stage, "distance") == 0) return mesh_in;
    }
    /* Only a level of the tree is expanded or gets a surface; the tree itself goes to its file as it is. */
    if (bit == CLI_REFINE) {
        if (strcmp(stage, "expand") == 0)
            return is_name_of(o->output, BVX_GRIDS_READ) && bvx_format_of_name(o->output) != BVX_FORMAT_BVX;
        if (strcmp(stage, "surface") == 0) return mesh_out;
    }
    /* Voxels that stay voxels have neither surface nor certificate. */
    if ((bit & PLAN_VOXELS) != 0 && (strcmp(stage, "surface") == 0 || strcmp(stage, "check") == 0))
        return mesh_out;
    /* From mesh to mesh nothing is voxelized on the way. */
    if (bit == CLI_CONVERT && mesh_in && mesh_out)
        return strncmp(stage, "read", 4) == 0 || strcmp(stage, "parse") == 0 ||
               strcmp(stage, "simplify") == 0 || strcmp(stage, "check file") == 0 ||
               strcmp(stage, "write") == 0;
    return 1;
}

/* What the options leave out. */
static int is_planned(const cli_run *run, const plan_row *row)
{
    const cli_options *const o = run->options;
    const char *const s = row->stage;
    int32_t const bit = run->command->bit;

    if ((row->commands & bit) == 0 || !suits_files(run, s)) return 0;
    /* What the row itself says comes first; the rest depends on more than one option. */
    if (row->given != NULL && !cli_given(run, row->given)) return 0;
    if (row->lacking != NULL && cli_given(run, row->lacking)) return 0;
    /* Each action of morph is a row, and one of them runs. */
    if (bit == CLI_MORPH && row->weight == MORPH_WEIGHT) return strcmp(s, o->input[0]) == 0;
    if (strcmp(s, "simplify") == 0) return cli_reduces(run);
    if (strcmp(s, "distance") == 0) return bit == CLI_REPAIR ? cli_reduces(run) : o->samples != 0;
    return 1;
}

static int times_of(const cli_run *run, int each)
{
    const cli_options *const o = run->options;
    int times = 1;

    /* The first word of boolean and morph is what they do, not a file. */
    if (each == PLAN_FILES) times = o->inputs - ((run->command->bit & (CLI_BOOLEAN | CLI_MORPH)) != 0);
    if (each == PLAN_MADE) times = run->progress.made;
    if (each == PLAN_CARRIED || each == PLAN_MEASURED) times = run->progress.measured;
    return times < 1 ? 1 : times;
}

/* A stage's name without its level, which becomes *number; -1: it has none. */
static size_t split_name(const char *name, int *number)
{
    size_t const all = strlen(name);
    size_t n = all;

    /* Only digits after a space are a level: "f32" keeps its own. */
    while (n > 0 && name[n - 1] >= '0' && name[n - 1] <= '9') n--;
    *number = -1;
    if (n == all || n == 0 || name[n - 1] != ' ') return all;
    *number = atoi(name + n);
    return n - 1;
}

static int is_row(const cli_run *run, int row, const char *name, size_t length)
{
    const char *const s = strncmp(name, "render", length) == 0 && cli_given(run, "--turntable") ? "frames"
                                                                                                : name;
    size_t const n = s == name ? length : strlen(s);

    return is_planned(run, &plan_rows[row]) && strlen(plan_rows[row].stage) == n &&
           strncmp(plan_rows[row].stage, s, n) == 0;
}

/* The first and the last row of what is gone through together. */
static int group_begin(int row)
{
    while (row > 0 && plan_rows[row].each != PLAN_ONCE && plan_rows[row - 1].each == plan_rows[row].each)
        row--;
    return row;
}

static int group_end(int row)
{
    while (row + 1 < PLAN_ROWS && plan_rows[row].each != PLAN_ONCE &&
           plan_rows[row + 1].each == plan_rows[row].each)
        row++;
    return row;
}

/* The row of a stage that begins: in the present group, in its next round,
 * or further on; -1: none. *time: which round. */
static int find_row(const cli_run *run, const char *name, int *time)
{
    int const now = run->progress.row;
    int number;
    size_t const length = split_name(name, &number);

    if (now >= 0) {
        int const begin = group_begin(now), end = group_end(now), times = times_of(run, plan_rows[now].each);

        /* A row at or before the present one means that the next round has begun. */
        for (int row = begin; row <= end; row++) {
            *time = number >= 0 ? number : run->progress.time + (row <= now);
            if (*time < times && is_row(run, row, name, length)) return row;
        }
    }
    /* Stages that were left out are jumped over; none is gone back to. */
    for (int row = now < 0 ? 0 : group_end(now) + 1; row < PLAN_ROWS; row++) {
        *time = number >= 0 && plan_rows[row].each != PLAN_ONCE ? number : 0;
        if (*time < times_of(run, plan_rows[row].each) && is_row(run, row, name, length)) return row;
    }
    return -1;
}

/* Sampling takes time by the samples; a level that is taken from voxels is
 * soon made beside one whose edges collapse. */
static double weight_of(const cli_run *run, const plan_row *row)
{
    double const usual = 20000.0, samples = run->options->samples < 0 ? usual : (double)run->options->samples;

    if (!is_planned(run, row)) return 0.0;
    if (strcmp(row->stage, "write") == 0 && run->progress.writing > 0.0)
        return row->weight * run->progress.writing;
    if (strcmp(row->stage, "distance") == 0 && run->command->bit != CLI_MORPH &&
        run->command->bit != CLI_REPAIR)
        return row->weight * samples / usual;
    /* The first level does most of the work, the others continue from it. */
    if (strcmp(row->stage, "level") == 0 && run->progress.made > 1) return row->weight / 9.0;
    return row->weight;
}

static double weight_between(const cli_run *run, int begin, int end)
{
    double sum = 0.0;

    for (int row = begin; row < end; row++) sum += weight_of(run, &plan_rows[row]);
    return sum;
}

int cli_plan_stage(cli_run *run, const char *name, double *low, double *high)
{
    int time = 0, begin, end, times;
    int const row = find_row(run, name, &time);
    double all, before, round;

    if (row < 0) return 0;
    run->progress.row = row;
    run->progress.time = time;

    /* Rounds share the weight of their group evenly. */
    begin = group_begin(row);
    end = group_end(row) + 1;
    times = times_of(run, plan_rows[row].each);
    all = weight_between(run, 0, PLAN_ROWS);
    round = weight_between(run, begin, end) / times;
    before = weight_between(run, 0, begin) + round * time + weight_between(run, begin, row) / times;
    *low = before / all;
    *high = (before + weight_of(run, &plan_rows[row]) / times) / all;
    return 1;
}
