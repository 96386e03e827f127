/* args.h - of the bitvox program: what the command line says. */
#ifndef BVX_CLI_ARGS_H
#define BVX_CLI_ARGS_H

#include "cli_shell/shell.h"

/* Commands, as bits: an option says which of them take it. A new command takes the next bit. */
enum {
    CLI_INFO = 1 << 0,
    CLI_VOXELIZE = 1 << 1,
    CLI_LOD = 1 << 2,
    CLI_RENDER = 1 << 3,
    CLI_CONVERT = 1 << 4,
    CLI_COMPARE = 1 << 5,
    CLI_FACES = 1 << 6,
    CLI_REFINE = 1 << 7,
    CLI_FILL = 1 << 8,
    CLI_SECTIONS = 1 << 12,
    CLI_SLICE = 1 << 13,
    CLI_REPAIR = 1 << 9,
    CLI_BOOLEAN = 1 << 10,
    CLI_MORPH = 1 << 16,
    CLI_COMPONENTS = 1 << 19,
    CLI_SIMPLIFY = 1 << 20,
    CLI_ALL = 0x7fffffff
};

struct cli_command {
    const char *name;
    int32_t bit;
    int least_inputs, most_inputs;
    const char *usage;   /* after "bitvox NAME" */
    const char *does;    /* one line */
    const char *details; /* lines for its help */
    const char *example; /* command lines that work in the project's folder, one a line */
    size_t job;          /* bytes of what it works with: run->job */
    /* Check, open, read, call the library: all but writing. */
    int (*make)(cli_run *run, void *job, cli_made *made);
    /* After writing, what is to be said of it; may be NULL, as the next. */
    void (*tell)(const cli_run *run, const void *job, cli_made *made);
    void (*free)(cli_run *run, void *job);
};

/* ---- option_table.c, option_values.c, arguments.c: what the command line says ---- */

typedef struct cli_list {
    int count;
    int64_t value[CLI_MAX_LEVELS];
} cli_list;

/* Planes square to the axes. */
typedef struct cli_planes {
    int given[3];
    double value[3];
} cli_planes;

typedef struct cli_sheet {
    int32_t axis, count; /* count 0: not given */
} cli_sheet;

/* Two numbers; an end that is left out is infinite. */
typedef struct cli_pair {
    int given;
    double value[2];
} cli_pair;

typedef struct cli_triple {
    int given;
    double value[3];
} cli_triple;

/* Distances, each in the mesh's unit or in percent of its diagonal. */
typedef struct cli_errors {
    int count;
    double value[CLI_MAX_LEVELS];
    int32_t percent[CLI_MAX_LEVELS];
} cli_errors;

/* Zero stands for "not given" unless said otherwise. */
struct cli_options {
    cli_general general;
    const char *input[CLI_MAX_FILES];
    int inputs;
    const char *output;
    const char *output_dir; /* a folder for the outputs of several inputs */
    int32_t format;         /* of standard input and output, BVX_FORMAT_... */
    cli_list resolution, levels, triangles, window, size;
    double spacing;
    double agree;
    cli_triple origin, from, up;
    int32_t padding;
    int32_t fill;          /* BVX_FILL_... */
    int32_t method;        /* BVX_LOD_... or CLI_METHOD_COLLAPSE */
    cli_errors errors;     /* of levels that edges collapse to, and what else these need: */
    int32_t error_kind;    /* BVX_ERROR_... */
    int32_t count, source; /* source: BVX_LEVELS_... */
    int32_t open;          /* BVX_OPEN_... */
    int32_t no_sharp, outer_hull, strict, if_needed;
    double even, colour_weight;
    double threshold;
    int32_t edge_samples;
    double collapse;
    int64_t samples; /* -1: not given */
    int32_t smooth;
    int32_t voxels; /* along the longest axis; 0: draw the mesh */
    int32_t carry, wireframe, difference, turntable;
    int64_t seed;
    cli_planes cut;
    cli_sheet slices;
    int32_t mode; /* of voxelize: CLI_MODE_... */
    int32_t close_gaps, add_shell, check_edges, check_thin, compare_fills;
    double base;        /* height that columns stand on */
    const char *second; /* the other terrain's file */
    int32_t up_axis;    /* 1 to 3 */
    int32_t merge;
    int32_t base_voxels, depth, outer_levels, expand, leaves;
    int32_t states; /* BVX_STATE_... added */
    double adaptive;
    cli_list seeds;   /* three numbers each */
    const char *mesh; /* the file of a surface's mesh */
    int32_t connectivity;
    int32_t layers, blend, caps, nesting, mend, crossings, subdivide, label, cells; /* sections */
    const char *block_model;
    cli_triple block;
    double close_gap;      /* between the ends of a contour */
    int32_t sign;          /* BVX_SIGN_... */
    int32_t interpolation; /* BVX_EDGE_... */
    int32_t sharp, measure;
    int32_t count_crossings;  /* info: of meshes */
    int32_t normals;          /* of vertices, in a mesh's file */
    cli_triple output_origin; /* taken from the positions of a mesh's file */
    int32_t resample;         /* boolean: grids of other lattices are sampled */
    double shell;             /* thickness in voxels */
    int32_t thin;             /* BVX_THIN_... */
    int64_t least_part, least_cavity;
    double half_width;              /* of a field's band; 0: no end */
    int64_t keep_largest, at_least; /* components */
    int32_t fill_cavities;
    const char *labels;                                     /* the file of their numbers */
    int32_t minimum, body;                                  /* clouds of points */
    int32_t vectors, value_type;                            /* value_type: BVX_F32, BVX_F64 */
    int32_t neighbourhood, steps, beyond, side, drain_side; /* morph: by the places among their names */
    double radius, thickness, drain;
    double level; /* of volumes */
    cli_pair range;
    int64_t value_label;
    int32_t all_labels, below;
    cli_list shape;      /* of samples only */
    int32_t sample_type; /* BVX_SAMPLE_... */
    int32_t big_endian;
    int64_t skip; /* bytes before the samples */
    cli_triple voxel_size;
};

/* The method of lod that is neither of BVX_LOD_... */
enum { CLI_METHOD_COLLAPSE = 3 };

/* What voxelize sets: the solid, or 1 + BVX_SURFACE_...; or distances in place of voxels. */
enum {
    CLI_MODE_SOLID = 0,
    CLI_MODE_CONSERVATIVE = 1,
    CLI_MODE_THIN = 2,
    CLI_MODE_SAMPLED = 3,
    CLI_MODE_FIELD = 4
};

/* What a value is, and the type of its field: */
typedef enum cli_kind {
    CLI_FLAG,   /* int32_t; no value */
    CLI_INT,    /* int32_t, low to high; or one of the names, which stand for base, base + 1 .. */
    CLI_LONG,   /* int64_t, low to high */
    CLI_REAL,   /* double, above low and below high; with least 1: from low to high */
    CLI_TRIPLE, /* cli_triple */
    CLI_PAIR,   /* cli_pair */
    CLI_LIST,   /* cli_list, least to most whole numbers, each low to high; 1 to 3 means 1 or 3 */
    CLI_BYTES,  /* uint64_t */
    CLI_CHOICE, /* int32_t, base and the place among the names */
    CLI_SIZE,   /* cli_list of width and height */
    CLI_CUT,    /* cli_planes; the option may stand again for another axis */
    CLI_SLICES, /* cli_sheet, count from low to high */
    CLI_FILE,   /* const char *, the name of a file */
    CLI_NUMBER, /* double, any */
    CLI_ERRORS, /* cli_errors, 1 to most of them */
    CLI_SET,    /* int32_t, a bit for each name of a list: base << the place among the names */
    CLI_TEXT    /* const char *, any text but none */
} cli_kind;

typedef struct cli_argument {
    const char *name;  /* with its dashes */
    const char *value; /* as the help shows it; NULL for a flag */
    cli_kind kind;
    int32_t commands; /* bits */
    size_t field;     /* in cli_options */
    double low, high;
    int least, most;
    const char *const *choice; /* names, NULL after the last */
    int base;
    const char *help; /* lines */
} cli_argument;

/* The rules of --fill by BVX_FILL_..., and the modes of voxelize by CLI_MODE_...; NULL after the last. */
extern const char *const cli_fill_names[], *const cli_fill_reasons[], *const cli_mode_names[];
/* The names of a list of the header, in the order of their numbers. */
#define CLI_NAME_OF(name, value, text) text,

/* By the place of a connectivity among its names: 6, 18, 26. */
extern const int32_t cli_neighbours[];
/* By BVX_SAMPLE_..., from BVX_SAMPLE_U8. */
extern const char *const cli_sample_names[];
/* By BVX_SIGN_... */
extern const char *const cli_sign_names[];
/* Row i of the table, NULL after the last; one name may stand in several rows for different commands. */
const cli_argument *cli_argument_at(int i);
/* Store an option's value in its field; 0 when it is malformed. */
int cli_take_value(const cli_argument *a, const char *text, cli_options *o);
/* "a whole number from 0 to 1024": what a value must be. */
void cli_describe_value(const cli_argument *a, char *text, size_t room);
/* Fill run->options; CLI_DONE or CLI_USAGE with a message. */
int cli_parse(cli_run *run, int count, char **word);
/* 1 when the command has an option of this name. */
int cli_takes(const cli_run *run, const char *name);
/* 1 when this option of the command stands on its command line. */
int cli_given(const cli_run *run, const char *name);
/* The same of a name of so many bytes: the name, or NULL. */
const char *cli_given_name(const cli_run *run, const char *name, size_t length);
/* The options of a command, for its help. */
void cli_print_options(int32_t command_bit);
/* Another option of the command whose name differs by one letter, or NULL. */
const char *cli_mistaken_for(const cli_run *run, const char *name);
/* The nearest of the names, or NULL when none is near; next gives name i, NULL after the last. */
const char *cli_nearest(const char *word, const char *(*next)(const void *user, int i), const void *user);
/* 1 when --triangles or --error is given. */
int cli_reduces(const cli_run *run);

/* ---- plan.c: the stages of a command ---- */

/* The share of the run that the stage which begins now has; 0 when it is not in the command's plan. */
int cli_plan_stage(cli_run *run, const char *name, double *low, double *high);

/* ---- manual.c: the man page and the completion of bash, from the same tables ---- */

/* NULL stands after the last command. */
void cli_print_manual(const cli_command *const *commands);
void cli_print_completion(const cli_command *const *commands);

#endif
