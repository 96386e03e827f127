/* args.h - of the bitvox program: what the command line says. */
#ifndef BVX_CLI_ARGS_H
#define BVX_CLI_ARGS_H

#include "cli_shell/shell.h"

/* Commands, as bits. A new command takes the next one. */
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
    CLI_LABELS = 1 << 21,
    CLI_HULL = 1 << 22,
    CLI_CHECK = 1 << 23,
    CLI_ALL = 0x7fffffff
};

typedef struct cli_argument cli_argument;

/* What a job holds to its end: members of its memory, all zero where they were not reached. */
enum {
    CLI_OWNS_BYTES = 1, /* of malloc */
    CLI_OWNS_MESH,
    CLI_OWNS_GRID,
    CLI_OWNS_FIELD,
    CLI_OWNS_SECTIONS,
    CLI_OWNS_INPUT,
    CLI_OWNS_VOLUME,
    CLI_OWNS_TREE,
    CLI_OWNS_VOXELS
};

typedef struct cli_owned {
    int32_t kind, count;
    size_t at, size; /* of the first, of each */
} cli_owned;

#define CLI_OWNS(kind, type, member)                  \
    {                                                 \
        CLI_OWNS_##kind, 1, offsetof(type, member), 0 \
    }
#define CLI_OWNS_ALL(kind, type, member)                                               \
    {                                                                                  \
        CLI_OWNS_##kind, sizeof(((type *)0)->member) / sizeof(((type *)0)->member[0]), \
            offsetof(type, member), sizeof(((type *)0)->member[0])                     \
    }

/* A command's way from the input to the result. */
struct cli_job {
    size_t size; /* bytes of what it works with: run->work */
    /* Check, open, read, call the library: all but writing. */
    int (*make)(cli_run *run, void *work, cli_made *made);
    /* After writing, what is to be said of it; may be NULL, as the next. */
    void (*tell)(const cli_run *run, const void *work, cli_made *made);
    const cli_owned *owns; /* ends with a kind of 0; freed in this order */
    void (*free)(cli_run *run, void *work);
};

struct cli_command {
    const char *name;
    int32_t bit;
    int least_inputs, most_inputs;
    const char *usage;        /* after "bitvox NAME" */
    const char *does;         /* one line */
    const char *details;      /* lines for its help */
    const char *example;      /* command lines that work in the project's folder, one a line */
    const char *most;         /* what its short help shows besides -o and --help, NULL: all of few */
    const cli_argument *rows; /* the options that it takes, in the order of its help */
    size_t own;               /* bytes of those that are its own: run->own */
    void (*start)(void *own); /* what they are where nothing is given; NULL: zero */
    cli_job job;              /* what it does; or one of several jobs, which this chooses by the line: */
    int (*choose)(cli_run *run, const cli_job **job);
};

/* ---- shared_rows.c, option_values.c, arguments.c: what the command line says; rows.h: rows ---- */

typedef struct cli_list {
    int count;
    int64_t value[CLI_MAX_LEVELS];
} cli_list;

/* Planes square to the axes. */
typedef struct cli_planes {
    int given[3];
    double value[3];
} cli_planes;

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

/* What several commands take, or the rooms below them read; what one command takes for itself stands in its
 * file. Zero stands for "not given" unless said otherwise. */
struct cli_options {
    cli_general general;
    const char *input[CLI_MAX_FILES];
    int inputs;
    const char *output;
    const char *output_dir; /* a folder for the outputs of several inputs */
    uint32_t facts;         /* CLI_TO_MESH, CLI_KEEPS_PARTS ..: what the line says, known once it is read */
    int32_t format;         /* of standard input and output, BVX_FORMAT_... */

    /* where voxels lie */
    cli_list resolution, window;
    double spacing;
    cli_triple origin;
    int32_t padding;

    /* what is inside a mesh */
    int32_t fill; /* BVX_FILL_... */
    int32_t close_gaps, add_shell;
    int32_t sign;          /* BVX_FILL_... */
    int32_t interpolation; /* BVX_EDGE_... */
    int32_t sharp, no_sharp;
    double shell; /* thickness in voxels */
    int64_t least_part, least_cavity;

    /* fewer triangles */
    cli_list triangles;
    cli_errors errors, enclose;
    int32_t error_kind; /* BVX_ERROR_... */
    int32_t count;      /* levels */
    int32_t strict;
    double even, attributes;
    int32_t lock_border, keep_vertices;
    int32_t topology; /* BVX_TOPOLOGY_... */
    int64_t samples;  /* -1: not given */

    /* meshes in files */
    int32_t carry, normals, quantize;
    cli_triple output_origin; /* taken from the positions */
    int32_t up, input_up;     /* CLI_UP_..., 0: by the format */

    /* volumes, .raw files, parts of voxels */
    double level;
    cli_pair range;
    int64_t value_label;
    int32_t below;
    cli_list shape;
    int32_t sample_type; /* BVX_SAMPLE_... */
    int32_t big_endian;
    int64_t skip; /* bytes before the samples */
    cli_triple voxel_size;
    int64_t keep_largest;
    int32_t connectivity; /* index into cli_neighbours */

    /* fields */
    int32_t vectors;

    /* octrees */
    int32_t states; /* BVX_STATE_... added */
    int32_t expand;

    double close_gap; /* between the ends of a contour */
};

/* The axis that is up in a mesh's file. */
enum { CLI_UP_NONE = 0, CLI_UP_Y = 1, CLI_UP_Z = 2 };

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
    CLI_FILE,   /* const char *, the name of a file */
    CLI_NUMBER, /* double, any */
    CLI_ERRORS, /* cli_errors, 1 to most of them */
    CLI_SET,    /* int32_t, a bit for each name of a list: base << the place among the names */
    CLI_TEXT    /* const char *, any text but none */
} cli_kind;

struct cli_argument {
    const char *name;  /* with its dashes */
    const char *value; /* as the help shows it; NULL for a flag */
    cli_kind kind;
    size_t field; /* in cli_options */
    int own;      /* 1: in the command's own options */
    double low, high;
    int least, most;
    const char *const *choice; /* names, NULL after the last */
    int base;
    const char *help;                /* lines */
    const struct cli_argument *also; /* in place of a row: the rows of this table */
};

/* The rules of --fill by BVX_FILL_..., and the modes of voxelize by CLI_MODE_...; NULL after the last. */
extern const char *const cli_fill_names[], *const cli_fill_reasons[], *const cli_mode_names[];
/* The names of a list of the header, in the order of their numbers. */
#define CLI_NAME_OF(name, value, text) text,

/* By the place of a connectivity among its names: 6, 18, 26. */
extern const int32_t cli_neighbours[];
/* By BVX_SAMPLE_..., from BVX_SAMPLE_U8. */
extern const char *const cli_sample_names[];
/* The rules that fields take, "" for others. */
extern const char *const cli_sign_names[];
/* All rows of a command, those of other tables in their places; returns how many there are. */
int cli_list_rows(const cli_command *command, const cli_argument *row[CLI_MAX_OPTIONS]);
/* 1 for what all commands take. */
int cli_is_common(const cli_argument *a);
/* Store an option's value in its field; 0 when it is malformed. */
int cli_take_value(cli_run *run, const cli_argument *a, const char *text);
/* "a whole number from 0 to 1024": what a value must be. */
void cli_describe_value(const cli_argument *a, char *text, size_t room);
/* Fill run->options and run->own; CLI_DONE or CLI_USAGE with a message. */
int cli_parse(cli_run *run, int count, char **word);
/* 1 when the command has an option of this name. */
int cli_takes(const cli_run *run, const char *name);
/* 1 when this option of the command stands on its command line. */
int cli_given(const cli_run *run, const char *name);
/* The same of a name of so many bytes: the name, or NULL. */
const char *cli_given_name(const cli_run *run, const char *name, size_t length);
/* The options of a command, for its help: those that most runs need, or all in groups. */
void cli_print_options(const cli_command *command, int all);
/* Another option of the command whose name differs by one letter, or NULL. */
const char *cli_mistaken_for(const cli_run *run, const char *name);
/* The nearest of the names, or NULL when none is near; next gives name i, NULL after the last. */
const char *cli_nearest(const char *word, const char *(*next)(const void *user, int i), const void *user);
/* A number as options of the library take it, where their 0 is a default. */
static inline double cli_or_none(double value)
{
    return value != 0.0 ? value : BVX_NONE;
}
/* BVX_SHARP_... */
static inline int32_t cli_sharp(const cli_options *o)
{
    return o->sharp ? BVX_SHARP_ALWAYS : o->no_sharp ? BVX_SHARP_NEVER : BVX_SHARP_AUTO;
}
bvx_parts cli_parts(const cli_run *run);
/* 1 when --triangles or --error is given. */
int cli_reduces(const cli_run *run);

/* ---- manual.c: the man page and the completion of bash, from the same tables ---- */

/* NULL stands after the last command. */
void cli_print_manual(const cli_command *const *commands);
void cli_print_completion(const cli_command *const *commands);

#endif
