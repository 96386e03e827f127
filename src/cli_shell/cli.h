/* cli.h - the bitvox program: what its files share. */
#ifndef BVX_CLI_H
#define BVX_CLI_H

#include "cli_shell/endings.h"
#include "bitvox.h"

#include <stddef.h>
#include <stdint.h>

/* Exit statuses. */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_INTERRUPTED = 130 };

enum {
    CLI_MAX_INPUTS = 64,
    CLI_MAX_FILES = 8192, /* inputs with --output-dir */
    CLI_MAX_LEVELS = 64,
    CLI_MAX_OUTPUTS = 512,
    CLI_MAX_STAGES = 6 * CLI_MAX_LEVELS,
    CLI_MAX_WARNINGS = 32,
    CLI_MAX_OPTIONS = 256
};

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

typedef struct cli_run cli_run;

typedef struct cli_command {
    const char *name;
    int32_t bit;
    int least_inputs, most_inputs;
    const char *usage;   /* behind "bitvox NAME" */
    const char *does;    /* one line */
    const char *details; /* lines for its help */
    const char *example; /* command lines that work in the project's folder, one a line */
    int (*run)(cli_run *run);
} cli_command;

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

enum { CLI_BAR_AUTO = 0, CLI_BAR_DRAW = 1, CLI_BAR_JSON = 2, CLI_BAR_NONE = 3 };

/* Zero stands for "not given" unless said otherwise. */
typedef struct cli_options {
    const char *input[CLI_MAX_FILES];
    int inputs;
    const char *output;
    const char *output_dir;     /* a folder for the outputs of several inputs */
    int32_t help, json, quiet;
    int32_t progress;           /* CLI_BAR_... */
    int32_t format;             /* of standard input and output, BVX_FORMAT_... */
    int32_t threads;
    uint64_t memory_limit;
    cli_list resolution, levels, triangles, window, size;
    double spacing;
    cli_triple origin, from, up;
    int32_t padding;
    int32_t fill;               /* BVX_FILL_... */
    int32_t method;             /* BVX_LOD_... or CLI_METHOD_COLLAPSE */
    cli_errors errors;          /* of levels that edges collapse to, and what else these need: */
    int32_t error_kind;         /* BVX_ERROR_... */
    int32_t count, source;      /* source: BVX_LEVELS_... */
    int32_t open;               /* BVX_OPEN_... */
    int32_t no_sharp, outer_hull, strict, if_needed;
    double even, colour_weight;
    double threshold;
    int32_t edge_samples;
    double collapse;
    int64_t samples;            /* -1: not given */
    int32_t smooth;
    int32_t voxels;             /* along the longest axis; 0: draw the mesh */
    int32_t carry, wireframe, difference, turntable;
    int64_t seed;
    cli_planes cut;
    cli_sheet slices;
    int32_t mode;               /* of voxelize: CLI_MODE_... */
    int32_t close_gaps, add_shell, check_edges, check_thin, compare_fills;
    double base;                /* height that columns stand on */
    const char *second;         /* the other terrain's file */
    int32_t up_axis;            /* 1 to 3 */
    int32_t merge;
    int32_t base_voxels, depth, outer_levels, expand, leaves;
    int32_t states;             /* BVX_STATE_... added */
    double adaptive;
    cli_list seeds;             /* three numbers each */
    const char *mesh;           /* the file of a surface's mesh */
    int32_t connectivity;
    int32_t layers, caps, nesting, mend, crossings, subdivide, label; /* sections */
    const char *block_model;
    cli_triple block;
    double close_gap;           /* between the ends of a contour */
    int32_t sign;               /* BVX_SIGN_... */
    int32_t interpolation;      /* BVX_EDGE_... */
    int32_t sharp, measure;
    int32_t count_crossings;    /* info: of meshes */
    int32_t normals;            /* of vertices, in a mesh's file */
    cli_triple output_origin;   /* taken from the positions of a mesh's file */
    int32_t resample;           /* boolean: grids of other lattices are sampled */
    double shell;               /* thickness in voxels */
    int32_t thin;               /* BVX_THIN_... */
    int64_t least_part, least_cavity;
    double half_width;          /* of a field's band; 0: no end */
    int64_t keep_largest, at_least; /* components */
    int32_t fill_cavities;
    const char *labels;             /* the file of their numbers */
    int32_t minimum, body;          /* clouds of points */
    int32_t vectors, value_type; /* value_type: BVX_F32, BVX_F64 */
    int32_t neighbourhood, steps, beyond, side, drain_side; /* morph: by the places among their names */
    double radius, thickness, drain;
    double level;               /* of volumes */
    cli_pair range;
    int64_t value_label;
    int32_t all_labels, below;
    cli_list shape;             /* of samples alone */
    int32_t sample_type;        /* BVX_SAMPLE_... */
    int32_t big_endian;
    int64_t skip;               /* bytes before the samples */
    cli_triple voxel_size;
} cli_options;

/* The method of lod that is neither of BVX_LOD_... */
enum { CLI_METHOD_COLLAPSE = 3 };

/* What voxelize sets: the solid, or 1 + BVX_SURFACE_...; or distances in place of voxels. */
enum { CLI_MODE_SOLID = 0, CLI_MODE_CONSERVATIVE = 1, CLI_MODE_THIN = 2, CLI_MODE_SAMPLED = 3, CLI_MODE_FIELD = 4 };

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
    const char *name;          /* with its dashes */
    const char *value;         /* as the help shows it; NULL for a flag */
    cli_kind kind;
    int32_t commands;          /* bits */
    size_t field;              /* in cli_options */
    double low, high;
    int least, most;
    const char *const *choice; /* names, NULL behind the last */
    int base;
    const char *help;          /* lines */
} cli_argument;

/* The rules of --fill by BVX_FILL_..., and the modes of voxelize by CLI_MODE_...; NULL behind the last. */
extern const char *const cli_fill_names[], *const cli_fill_reasons[], *const cli_mode_names[];
/* By BVX_SIGN_... */
extern const char *const cli_sign_names[];
/* Row i of the table, NULL behind the last; one name may stand in several rows for different commands. */
const cli_argument *cli_argument_at(int i);
/* Store an option's value in its field; 0 when it is malformed. */
int cli_take_value(const cli_argument *a, const char *text, cli_options *o);
/* "a whole number from 0 to 1024": what a value must be. */
void cli_describe_value(const cli_argument *a, char *text, size_t room);
/* Fill run->options; CLI_DONE or CLI_USAGE with a message. */
int cli_parse(cli_run *run, int count, char **word);
/* What options contradict each other or the names of inputs and output. */
int cli_check_options(cli_run *run);
/* 1 when this option of the command stands on its command line. */
int cli_given(const cli_run *run, const char *name);
/* The options of a command, for its help. */
void cli_print_options(int32_t command_bit);
/* Another option of the command whose name differs by one letter, or NULL. */
const char *cli_mistaken_for(const cli_run *run, const char *name);
/* The nearest of the names, or NULL when none is near; next gives name i, NULL behind the last. */
const char *cli_nearest(const char *word, const char *(*next)(const void *user, int i), const void *user);

/* ---- text.c: text that grows; what does not fit into memory is left out and marked ---- */

typedef struct cli_text {
    char *bytes; /* ends with a zero byte; NULL: empty */
    size_t size, room;
    int failed;
} cli_text;

void cli_text_add(cli_text *text, const char *format, ...);
void cli_text_free(cli_text *text);
/* Pieces of JSON. A string, with bytes that are no UTF-8 replaced; a number, null when it is none; "key": with a comma
 * and a space before it, but for the first. */
void cli_json_string(cli_text *text, const char *string);
void cli_json_number(cli_text *text, double value);
void cli_json_key(cli_text *text, const char *key, int first);
/* , "key": value */
void cli_json_count(cli_text *text, const char *key, uint64_t value);
void cli_json_value(cli_text *text, const char *key, double value);
void cli_json_truth(cli_text *text, const char *key, int value);
void cli_json_triple(cli_text *text, const char *key, const double value[3]);
void cli_json_ints(cli_text *text, const char *key, const int32_t value[3]);

/* ---- report.c: the report of --json ---- */

typedef struct cli_mesh_entry {
    const char *path;
    bvx_certificate certificate;
    const bvx_certificate *welded;        /* with vertices at equal positions joined, or NULL */
    int colours, uvs;                     /* it has them */
    int has_crossings;                    /* they were counted */
    uint64_t crossings;
    const bvx_lod_report *lod;            /* or NULL */
    const bvx_level_report *level;        /* or NULL */
    double milliseconds, rate;            /* milliseconds beside lod, rate beside both */
    const char *source;                   /* beside level: what it was made from, "mesh" or "measured" */
    const bvx_distance_report *distance;  /* to the input, or NULL */
} cli_mesh_entry;

/* Stages, warnings, peak and error change under cli_lock, since an interrupt may report them at any time. */
typedef struct cli_report {
    bvx_lattice lattice;
    int has_lattice, has_set;
    uint64_t set;
    bvx_keep_report parts;   /* of voxels, where some were to be dropped */
    int has_parts;
    uint64_t nonfinite;      /* triangles of the inputs that were left out */
    struct {
        char name[32];
        double seconds;
    } stage[CLI_MAX_STAGES];
    int stages;
    cli_mesh_entry mesh[CLI_MAX_OUTPUTS];
    int meshes;
    cli_text more;           /* further members as JSON, each with ", " before it */
    char *warning[CLI_MAX_WARNINGS];
    int warnings;
    uint64_t peak_bytes;     /* most bytes held for data */
    cli_text batch;          /* the whole report of several inputs, in place of the above */
    char error_code[32];
    char error_message[1024];
} cli_report;

/* The report as one line; status is the exit status. brief leaves out what only the main thread may read. */
void cli_report_text(const cli_run *run, int status, int brief, cli_text *text);
/* Write it to standard output, or with -o - to standard error; 0 when that failed. */
int cli_report_print(cli_run *run, int status);
/* So many bytes are held beside what the context has now. */
void cli_note_peak(cli_run *run, uint64_t bytes);

/* ---- messages.c: what is said to people ---- */

/* Print "bitvox: ..." to standard error, keep it for the report, return the exit status. */
int cli_fail(cli_run *run, const char *format, ...);
int cli_usage(cli_run *run, const char *format, ...);
/* The same for a call of the library that failed; about names the file or is NULL. CLI_INTERRUPTED when cancelled. */
int cli_fail_status(cli_run *run, bvx_status status, const char *about);
/* The same, with an advice behind the message. */
int cli_fail_advised(cli_run *run, bvx_status status, const char *about, const char *advice);
int cli_fail_interrupted(cli_run *run);
/* What an interrupt left, as the message says it. */
void cli_interrupt_text(const cli_run *run, char *text, size_t room);
void cli_warn(cli_run *run, const char *format, ...);
/* Print to standard output unless --quiet, --json or an output takes it; to standard error with -o -. */
void cli_say(cli_run *run, const char *format, ...);

/* ---- files.c: whole files in ---- */

/* Memory that this process may use: the machine's, or less where a container or a limit of the shell allows less; 0 where the
 * system does not tell. */
uint64_t cli_memory_there(void);

typedef struct cli_bytes {
    unsigned char *bytes;
    size_t size, room;
    uint64_t limit;          /* of room */
} cli_bytes;

/* Read a file, gzip data unpacked; "-" is standard input. */
int cli_read_file(cli_run *run, const char *path, cli_bytes *bytes);
/* The same within a stage of the caller's, where so many bytes of other files are held already and count against the same limit. */
int cli_read_bytes(cli_run *run, const char *path, uint64_t held, cli_bytes *bytes);
/* The format of an input by --format or its name, BVX_FORMAT_... */
int32_t cli_input_format(const cli_run *run, const char *path);
/* How messages call an input. */
const char *cli_input_name(const char *path);
/* Read a mesh from a file; creates run->context when there is none. */
int cli_read_mesh(cli_run *run, const char *path, bvx_mesh *mesh);
/* The same, or a cloud of points: .xyz, or .ply without faces. */
int cli_read_mesh_or_cloud(cli_run *run, const char *path, bvx_mesh *mesh, int *cloud);

/* ---- vti_blocks.c: VTK's XML images with packed arrays ---- */

/* A .vti file with blocks of zlib becomes the same without; others stay. */
int cli_unpack_vti(cli_run *run, const char *path, cli_bytes *bytes);

/* ---- inputs.c: any input by its ending ---- */

enum { CLI_MESH = 1, CLI_GRID = 2, CLI_TREE = 3 };

typedef struct cli_input {
    const char *path;
    int kind;       /* CLI_MESH, CLI_GRID, or CLI_TREE where that is asked for */
    bvx_mesh mesh;
    bvx_grid grid;
    bvx_octree *tree;
    int placed;     /* 0: neither file nor side-car tells a grid's lattice */
} cli_input;

/* CLI_MESH, CLI_GRID or 0, of any BVX_FORMAT_... */
int cli_kind_of_format(int32_t format);
/* The diagonal of a box, wherever doubles hold it. */
double cli_diagonal(const double low[3], const double high[3]);
const char *cli_format_name(int32_t format);
int cli_is_packed(const char *path);         /* ends in .gz */
int cli_needs_sidecar(int32_t format);       /* it keeps no lattice */
char *cli_sidecar_name(const char *path);    /* to be freed; NULL without memory */
/* What an input would be by its name; refuses what is not read. */
int cli_input_kind(cli_run *run, const char *path, int *kind);
/* Read a grid, or a window of it (NULL or all zero: all), and its side-car; creates run->context when there is none. An octree
 * becomes the grid of its last level, or that of --expand. */
int cli_read_grid(cli_run *run, const char *path, const bvx_window *window, bvx_grid *grid, int *placed);
/* The same, but an octree stays what it is. */
int cli_read_grid_or_tree(cli_run *run, const char *path, const bvx_window *window, cli_input *input);
/* --window; all zero when it is not given. */
int cli_window_option(cli_run *run, bvx_window *window);
int cli_read_input(cli_run *run, const char *path, cli_input *input); /* a mesh or a grid */
void cli_free_input(cli_run *run, cli_input *input);

/* ---- volume_input.c: scalar volumes, and the voxels that are chosen of them ---- */

typedef struct cli_volume {
    cli_bytes file, data;   /* samples may stand in either */
    bvx_volume volume;
    bvx_volume_view view;   /* the window of it that is wanted */
    int placed;             /* 0: neither file nor side-car tells its lattice */
} cli_volume;

/* 1 when options choose voxels of a volume by their samples. */
int cli_selects(const cli_run *run);
/* 1 when the samples of an input are needed, and not what is other than 0. */
int cli_is_volume(const cli_run *run, const char *path);
/* Refuse options of volumes where no input is one: nothing would come of them. */
int cli_check_volume_options(cli_run *run);
/* Refuse options that contradict each other. */
int cli_check_selection(cli_run *run, const char *path);
/* Read a volume, or a window of it (NULL or all zero: all); creates run->context when there is none. */
int cli_read_volume(cli_run *run, const char *path, const bvx_window *window, cli_volume *volume);
void cli_free_volume(cli_run *run, cli_volume *volume);
/* volume_info.c: tell the type, range and histogram of a volume's samples, where they are more than bits. */
int cli_tell_samples(cli_run *run, const char *path);
/* The voxels of --level, --range or --label; without any those whose sample is not 0. */
bvx_status cli_select_voxels(cli_run *run, const cli_volume *volume, bvx_volume_report *report, bvx_grid *grid);
/* What was found in it: a member of the JSON report, lines of text, a warning. */
void cli_tell_volume(cli_run *run, const cli_volume *volume, const bvx_volume_report *report);
/* The side-car of a file without a lattice, where there is one; grid is all of the file or a part of it. */
int cli_read_sidecar(cli_run *run, const char *path, bvx_grid *grid, int *placed);

/* ---- kept_parts.c: --keep-largest and --least-part of voxels ---- */

/* 1 when parts may be dropped. */
int cli_keeps_parts(const cli_run *run);
/* Refuse these options for meshes of commands that read grids. */
int cli_check_parts(cli_run *run);
/* Keep the parts asked for, of a grid in itself or in another one, and count them for the report. */
bvx_status cli_keep_parts(cli_run *run, const bvx_grid *grid, bvx_grid *kept);
void cli_say_parts(cli_run *run);
void cli_report_parts(const cli_report *report, cli_text *text);

/* ---- section_info.c: contours of sections ---- */

/* 1 for .csl and .csv. */
int cli_is_contours(const cli_run *run, const char *path);
/* Read contours; creates run->context when there is none. */
int cli_read_sections(cli_run *run, const char *path, bvx_sections *sections);
/* Read them and say what they are. */
int cli_tell_sections(cli_run *run, const char *path);

/* ---- volume_output.c: voxelize of a volume ---- */

/* To a grid, or by the output's ending to one mesh or one a label. */
int cli_voxelize_volume(cli_run *run, const bvx_window *window);

/* ---- mesh_lattice.c: where voxels of a mesh lie ---- */

typedef struct cli_box {
    double low[3], high[3];
} cli_box;

/* Refuse what of --resolution, --spacing, --origin and --padding contradicts itself. */
int cli_check_lattice(cli_run *run);
/* The box of the vertices that a mesh's triangles use; one that holds two. */
void cli_mesh_box(const bvx_mesh *mesh, cli_box *box);
void cli_join_boxes(cli_box *box, const cli_box *other);
/* A lattice by the options, around a box, a mesh or a cloud of points. */
bvx_status cli_make_box_lattice(cli_run *run, const cli_box *box, bvx_lattice *lattice);
bvx_status cli_make_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice);
bvx_status cli_make_cloud_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice);

/* ---- far_points.c ---- */

/* Refuse a large lattice that is large because of few points far from the others. */
int cli_check_far(cli_run *run, const char *path, const bvx_mesh_view *view, int cloud, const bvx_lattice *lattice);

/* ---- solids.c: the rules that fill a mesh ---- */

/* Refuse options that speak of voxelizing beside a grid; path names it. */
int cli_refuse_for_grid(cli_run *run, const char *path);
/* The mesh of an input becomes its solid. */
int cli_fill_input(cli_run *run, cli_input *in);

/* Refuse options that the rule of --fill has no use for. */
int cli_check_fill(cli_run *run);
/* --fill and its options; second and the report are the caller's. */
void cli_take_fill(const cli_run *run, bvx_voxelize_options *v);
/* The rule that filled, and why. */
void cli_say_fill(cli_run *run, const bvx_solid_report *report);
/* What the report of a solid tells: warnings; lines of text; a member of the JSON report. */
/* Of the thin walls and the volume that a solid has lost; of: an input among several with ": ", or "". */
void cli_warn_of_losses(cli_run *run, const char *of, const bvx_lattice *lattice, const bvx_solid_report *report);
void cli_json_losses(cli_text *text, const bvx_lattice *lattice, const bvx_solid_report *report);
void cli_warn_of_solid(cli_run *run, const bvx_grid *grid, const bvx_solid_report *report);
void cli_say_solid(cli_run *run, const bvx_lattice *lattice, const bvx_solid_report *report);
void cli_report_solid(cli_run *run, const bvx_lattice *lattice, const bvx_solid_report *report);

/* ---- clouds.c: voxels of a cloud of points ---- */

/* Refuse options of clouds for another kind of input. */
int cli_check_cloud_options(cli_run *run, const char *kind);
/* Refuse the options of clouds for meshes, and those of meshes for clouds. */
int cli_check_cloud(cli_run *run, int cloud);
/* A grid of the window from the options, on the report's lattice; told, written and warned of. */
int cli_voxelize_cloud(cli_run *run, const bvx_mesh_view *points, const bvx_window *window);

/* ---- fill_table.c: --compare-fills ---- */

int cli_compare_fills(cli_run *run, const bvx_mesh_view *mesh, const bvx_lattice *lattice, bvx_fill_comparison *comparison);
/* The comparison as lines of text and as a member of the JSON report. */
void cli_tell_fills(cli_run *run, const bvx_fill_comparison *comparison);

/* ---- tree_output.c, tree_report.c: octrees ---- */

enum { CLI_TREE_LEVELS = 25 };

typedef struct cli_tree {
    bvx_octree *tree;
    bvx_lattice base;
    int32_t levels;
    bvx_octree_level level[CLI_TREE_LEVELS + 1];
    int kind;           /* of the output: CLI_MESH, CLI_GRID, or 0 for a tree */
    bvx_window window;  /* of the last level */
    bvx_grid grid;      /* what is written of it: a level, a mesh */
    bvx_mesh surface;
    uint64_t triangles; /* of the mesh that was refined; 0: the tree was read */
    double seconds;     /* that it took */
} cli_tree;

/* Refuse outputs that octrees have no use for, and options that have none for the output; sets kind. */
int cli_check_tree_output(cli_run *run, cli_tree *t);
/* Refuse --expand beyond the last level. */
int cli_check_tree_level(cli_run *run, int32_t levels);
int cli_open_tree_output(cli_run *run, const cli_tree *t);
/* Take over an octree, also on failure: its levels are counted, its lattice is reported. */
int cli_take_tree(cli_run *run, bvx_octree *tree, cli_tree *t);
/* The last level, or that of --expand, as a grid, or a window of it (all zero: all); path is named in messages. */
int cli_expand_tree(cli_run *run, const bvx_octree *tree, const bvx_window *finest, const char *path, bvx_grid *grid);
/* Write run->options.output and keep it. */
int cli_write_tree(cli_run *run, cli_tree *t);
void cli_free_tree(cli_run *run, cli_tree *t);
void cli_say_levels(cli_run *run, const cli_tree *t);
void cli_say_tree_output(cli_run *run, const cli_tree *t);
void cli_report_tree(cli_run *run, const cli_tree *t);

/* ---- leaf_mesh.c: refine --leaves ---- */

/* The leaves in the states asked for, less what --cut takes away, as boxes; to be freed here in any case. */
int cli_make_leaf_mesh(cli_run *run, const bvx_octree *tree, bvx_mesh *mesh);
void cli_free_leaf_mesh(bvx_mesh *mesh);

/* ---- grid_output.c: a grid out, with its side-car where the format keeps no lattice ---- */

/* Refuse an ending that stands for no grid; refuse a lattice that the format cannot hold. */
int cli_check_grid_name(cli_run *run, const char *path);
int cli_check_grid_format(cli_run *run, const char *path, const bvx_lattice *lattice, const int32_t size[3]);
/* Open the outputs of a grid, write it as run->options.output and keep it. */
int cli_open_grid_output(cli_run *run, const char *path);
int cli_write_grid(cli_run *run, const bvx_grid *grid);
void cli_say_grid(cli_run *run, const bvx_grid *grid, uint64_t set, int placed);
/* The place of a part (0: the low corner, 0.5: the centre) of a grid's first voxel. */
void cli_grid_corner(const bvx_grid *grid, double part, double corner[3]);

/* Say what a format leaves out of a window's grid. */
void cli_warn_of_window(cli_run *run, const char *path, const bvx_grid *grid);

/* ---- mesh_output.c: meshes as files ---- */

/* Where a pattern has its %d, or %03d with so many digits: its length there; NULL where it has none. */
const char *cli_number_place(const char *pattern, size_t *length, int *digits);
int cli_has_number(const char *pattern);
int cli_has_two_numbers(const char *pattern);
/* A pattern with its %d or %03d replaced, to be freed; NULL without memory. */
char *cli_numbered_path(const char *pattern, int64_t number);
/* Refuse an ending that stands for no mesh format. */
int cli_check_mesh_name(cli_run *run, const char *path);
/* Refuse a name without %d for several levels (count 0: several in any case), but for one .glb, which may hold them. */
int cli_check_level_names(cli_run *run, int count);
/* Refuse --carry to a format that holds nothing to carry, or of a mesh that has nothing. */
int cli_check_carry_name(cli_run *run);
int cli_check_carry(cli_run *run, const bvx_mesh *mesh);
/* Refuse --normals for a format without. */
int cli_check_normals(cli_run *run);
int cli_check_sharp(cli_run *run);
/* What of a mesh a format cannot hold, as a warning. */
void cli_warn_of_lost(cli_run *run, const char *path, const bvx_mesh *mesh);
/* Refuse --output-origin for outputs other than meshes. */
int cli_check_output_origin(cli_run *run);
/* Write the mesh as the output of this number, which is open, but do not keep it: less --output-origin; --normals adds the
 * normals of vertices. Where the file holds other positions than the mesh, or joins them, the certificate of the report's
 * entry of this number, if there is one, becomes the file's; a mesh that the format would spoil is refused. */
int cli_write_mesh_as(cli_run *run, const bvx_mesh *mesh, int number, const char *path);
/* The same as run->options.output, and keep it. */
int cli_write_mesh(cli_run *run, const bvx_mesh *mesh);

/* Open an output for each level; path receives their names, the first one for all where one file holds them. */
int cli_open_levels(cli_run *run, int count, char **path);
/* Write all levels to these outputs and keep them. */
int cli_write_levels(cli_run *run, const bvx_mesh *levels, int count, char *const *path);

/* ---- reduce_mesh.c: --triangles and --error of commands that make one mesh ---- */

typedef struct cli_reduction {
    int done;               /* fewer triangles were asked for and made */
    uint64_t before;        /* triangles */
    bvx_level_report level;
} cli_reduction;

/* 1 when --triangles or --error is given. */
int cli_reduces(const cli_run *run);
/* Refuse both together. */
int cli_check_reduction(cli_run *run);
/* Refuse each of them, with the reason behind its name. */
int cli_refuse_reduction(cli_run *run, const char *why);
/* The edges of a closed mesh collapse, where that is asked for. */
int cli_reduce(cli_run *run, bvx_mesh *mesh, cli_reduction *r);
/* What became of it: a line of text, a member of the JSON report. */
void cli_tell_reduction(cli_run *run, const cli_reduction *r);

/* ---- level_tables.c: what is told of levels ---- */

/* 1 when a mesh is closed, manifold and oriented. */
int cli_is_sound(const bvx_certificate *certificate);
/* The first line: the input's triangles, whether it is sound, its diagonal. */
void cli_say_input(cli_run *run, uint64_t triangles, const bvx_certificate *certificate, double diagonal);
/* The report's levels that edges collapsed to: triangles, targets, what they are. */
void cli_say_collapsed(cli_run *run, int count, double diagonal);
/* The distances of the report's meshes to the input; to says what that is where it is no mesh, unit_of whose unit they have;
 * decimals of percent. */
void cli_say_distances(cli_run *run, int count, double diagonal, int decimals, const char *to, const char *unit_of);
/* The files' names. */
void cli_say_written(cli_run *run, int count);

/* ---- field_output.c: distances as files; voxelize --mode field ---- */

/* Refuse options and names that the mode has no use for; choose the padding. */
int cli_check_field(cli_run *run);
/* Write a field as one file or two. */
int cli_write_field(cli_run *run, const bvx_field *field);
/* Measure on the report's lattice, write, tell; ends the stage that the caller began. */
int cli_voxelize_field(cli_run *run, const bvx_mesh_view *view, const bvx_window *window);

/* ---- turntable.c ---- */

/* A direction turned round an axis by i / n of a turn; 0 when it lies along the axis. */
int cli_turn(const double direction[3], const double axis[3], int32_t i, int32_t n, double turned[3]);
/* What a picture from a direction shows of a box on either side of a middle: its half width and height. What is there
 * already grows to it. */
void cli_turn_room(const double low[3], const double high[3], const double middle[3], const double direction[3],
                   const double axis[3], double room[2]);

/* ---- outputs.c: whole files out, all or none ---- */

enum { CLI_OUT_NEW = 0, CLI_OUT_IN_PLACE = 1, CLI_OUT_STANDARD = 2 };

typedef struct cli_output {
    char *path;      /* as it was given */
    char *target;    /* behind symbolic links */
    char *temporary; /* CLI_OUT_NEW, until it is kept */
    char *older;     /* what stood at target, under another name while several outputs are kept */
    int kind;        /* CLI_OUT_... */
    int begun;       /* something was written in place */
    int kept;
} cli_output;

/* Make sure that a file can be written: a file with a temporary name is made beside it. */
int cli_open_output(cli_run *run, const char *path);
/* Fill an output, numbered in the order of opening; it gets its name by cli_keep_outputs. */
int cli_write_output(cli_run *run, int number, const bvx_buffer *file);
/* Give all outputs their names, or none of them. */
int cli_keep_outputs(cli_run *run);
/* 1 when both are there and are the same. */
int cli_are_one_file(const char *a, const char *b);
/* Remove what was not kept. */
void cli_drop_outputs(cli_run *run);
/* The part of it that an interrupt does, with the lock held. */
void cli_remove_temporaries(cli_run *run);

/* ---- pack.c: outputs whose names end in .gz ---- */

/* 0 in builds without zlib. */
int cli_can_pack(void);
/* Pack a file by gzip; packed->bytes is to be freed in any case. */
int cli_pack(cli_run *run, const char *path, const bvx_buffer *plain, bvx_buffer *packed);

/* ---- batch.c: --output-dir ---- */

/* Refuse what does not fit it; run the command on each input. */
int cli_check_batch(cli_run *run);
int cli_run_batch(cli_run *run);

/* ---- standard_output.c: -o - ---- */

/* run->options.output becomes a name that stands for standard output; refuses a terminal. */
int cli_take_standard_output(cli_run *run);
int cli_is_standard_output(const cli_run *run, const char *path);

/* ---- terminal.c: time and progress ---- */

double cli_seconds(void); /* of a clock that only goes forward */
/* A stage begins and ends, under the name that the report and the progress tell; the end returns its seconds. */
void cli_stage_begin(cli_run *run, const char *format, ...);
double cli_stage_end(cli_run *run);
/* How many calls of the library, and files written, the stage is made of; 1 where nothing is said. */
void cli_stage_calls(cli_run *run, int calls);
int32_t cli_progress(void *run, const char *stage, double fraction); /* a bvx_progress_fn */
/* The last line, of fraction 1 after a success; no bar stays behind. */
void cli_progress_end(cli_run *run, int status);
void cli_clear_bar(cli_run *run);

typedef struct cli_progress_state {
    char stage[32];   /* "" before the first */
    int named;        /* the command has begun it and not ended it */
    double low, high; /* its share of the run */
    int calls, call;  /* of the library in it: how many, and which one runs */
    int moved;        /* it has reported something */
    int row, time;    /* of the plan; row -1: before the first */
    int made, measured; /* levels, for the plan: made one after the other, measured likewise */
    double start, ended; /* of the stage, seconds; ended 0: it still runs */
    double reached;   /* of the run */
    double told;      /* when the last line or bar was shown */
    int bar;          /* a bar stands on the terminal */
    int way;          /* CLI_BAR_..., 0: not yet decided */
} cli_progress_state;

/* ---- plan.c: the stages of a command ---- */

/* The share of the run that the stage which begins now has; 0 when it is not in the command's plan. */
int cli_plan_stage(cli_run *run, const char *name, double *low, double *high);

/* ---- watch.c: interrupts ---- */

/* Before any other thread starts. */
void cli_watch_start(void);
/* From now on an interrupt that the run does not heed soon ends the program by itself. */
void cli_watch_run(cli_run *run);
int cli_interrupted(void);
/* Around what an interrupt must find whole: outputs and their names, the report's texts. Nothing that may wait for
 * others (pipes, terminals) happens inside. Does not return once an interrupt is ending the program. */
void cli_lock(void);
void cli_unlock(void);
/* With the lock held: the outputs have their names, so nothing is cancelled any more. */
void cli_watch_kept(void);
/* With the lock held: the exit status is known, and a message about it is said until cli_watch_told. */
void cli_watch_decide(int status);
/* The report is written until cli_watch_told. */
void cli_watch_report(void);
void cli_watch_told(void);
/* With the lock held: another input follows. */
void cli_watch_again(void);
/* All is said; the program only has to end. */
void cli_watch_end(int status);

/* ---- manual.c: the man page and the completion of bash, from the same tables ---- */

void cli_print_manual(void);
void cli_print_completion(void);

/* ---- main.c ---- */

struct cli_run {
    const cli_command *command;
    cli_options options;
    unsigned char given[CLI_MAX_OPTIONS]; /* by row of the table */
    cli_report report;
    bvx_context *context;
    uint64_t context_limit; /* of its memory, when one was asked for; 0: none */
    cli_output output[CLI_MAX_OUTPUTS];
    int outputs;
    int standard_taken;     /* standard output belongs to an output */
    int batch;              /* 1: one of several inputs, so messages name it */
    char standard_name[32]; /* of -o -, with an ending; "" without */
    uint64_t removed_bytes; /* of files that the system takes apart at the exit */
    double start;
    cli_progress_state progress;
};

/* The last words, with the exit status. */
int cli_end_of_run(cli_run *run, int status);
/* Command i in the order of the help, NULL behind the last. */
const cli_command *cli_command_at(int i);
/* The context of the run, which knows how many bytes of the limit are taken by the file in memory. */
int cli_make_context(cli_run *run, uint64_t file_bytes);

extern const cli_command cli_info, cli_voxelize, cli_lod, cli_render, cli_convert, cli_compare, cli_faces, cli_refine, cli_fill,
    cli_sections, cli_slice, cli_repair, cli_boolean, cli_morph, cli_components, cli_simplify;

/* cmd_compare.c: bvx_grid_compare with a message that names both. */
int cli_compare_grids(cli_run *run, const cli_input *a, const cli_input *b, bvx_grid_difference *difference);
/* cmd_repair.c: the numbers of a repair as a member of the JSON report. */
void cli_report_repair(cli_run *run, const bvx_repair_report *repair, int measured);

/* ---- blocks.c ---- */

/* Ask for huge pages behind a block, when it is large. */
void cli_large_block(void *block, size_t size);
/* Give options an allocator that does so. */
void cli_blocks_offer(bvx_context_options *options);

#endif
