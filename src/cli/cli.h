/* cli.h - the bitvox program: what its files share. */
#ifndef BVX_CLI_H
#define BVX_CLI_H

#include "bitvox.h"

#include <stddef.h>
#include <stdint.h>

/* Exit statuses. */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_INTERRUPTED = 130 };

enum { CLI_MAX_INPUTS = 64, CLI_MAX_LEVELS = 64, CLI_MAX_STAGES = 4 * CLI_MAX_LEVELS, CLI_MAX_WARNINGS = 32 };

/* Commands, as bits: an option says which of them take it. */
enum { CLI_INFO = 1, CLI_VOXELIZE = 2, CLI_LOD = 4, CLI_RENDER = 8, CLI_ALL = 15 };

typedef struct cli_run cli_run;

typedef struct cli_command {
    const char *name;
    int bit;
    int most_inputs;
    const char *usage;   /* behind "bitvox NAME" */
    const char *does;    /* one line */
    const char *details; /* lines for its help */
    const char *example; /* a command line that works in the project's folder */
    int (*run)(cli_run *run);
} cli_command;

/* ---- arguments.c: what the command line says ---- */

typedef struct cli_list {
    int count;
    int64_t value[CLI_MAX_LEVELS];
} cli_list;

typedef struct cli_triple {
    int given;
    double value[3];
} cli_triple;

/* Zero stands for "not given" unless said otherwise. */
typedef struct cli_options {
    const char *input[CLI_MAX_INPUTS];
    int inputs;
    const char *output;
    int help, json, quiet;
    int32_t threads;
    uint64_t memory_limit;
    cli_list resolution, levels, triangles, window, size;
    double spacing;
    cli_triple origin, from, up;
    int32_t padding;
    int32_t fill;               /* BVX_FILL_... */
    int32_t method;             /* BVX_LOD_... */
    double threshold;
    int32_t edge_samples;
    double collapse;
    int64_t samples;            /* -1: not given */
    int32_t smooth;
    int32_t voxels;             /* along the longest axis; 0: draw the mesh */
} cli_options;

/* Fill run->options; CLI_DONE or CLI_USAGE with a message. */
int cli_parse(cli_run *run, int count, char **word);
/* The options of a command, for its help. */
void cli_print_options(int command_bit);
/* The nearest of the names, or NULL when none is near; next gives name i, NULL behind the last. */
const char *cli_nearest(const char *word, const char *(*next)(const void *user, int i), const void *user);

/* ---- report.c: messages, and the report of --json ---- */

typedef struct cli_mesh_entry {
    const char *path;
    bvx_certificate certificate;
    const bvx_certificate *welded;        /* with vertices at equal positions joined, or NULL */
    const bvx_lod_report *lod;            /* or NULL */
    double milliseconds, rate;            /* beside lod */
    const bvx_distance_report *distance;  /* to the input, or NULL */
} cli_mesh_entry;

typedef struct cli_report {
    bvx_lattice lattice;
    int has_lattice, has_set;
    uint64_t set;
    struct {
        char name[32];
        double seconds;
    } stage[CLI_MAX_STAGES];
    int stages;
    cli_mesh_entry mesh[CLI_MAX_INPUTS];
    int meshes;
    char *warning[CLI_MAX_WARNINGS];
    int warnings;
    uint64_t peak_bytes;     /* most bytes held for data */
    char error_code[32];
    char error_message[1024];
} cli_report;

/* Print "bitvox: ..." to standard error, keep it for the report, return the exit status. */
int cli_fail(cli_run *run, const char *format, ...);
int cli_usage(cli_run *run, const char *format, ...);
/* The same for a call of the library that failed; about names the file or is NULL. CLI_INTERRUPTED when cancelled. */
int cli_fail_status(cli_run *run, bvx_status status, const char *about);
int cli_fail_interrupted(cli_run *run);
void cli_warn(cli_run *run, const char *format, ...);
/* Print to standard output unless --quiet or --json. */
void cli_say(cli_run *run, const char *format, ...);
void cli_stage(cli_run *run, double start, const char *format, ...);
/* The object of --json; status is the exit status. Returns 0 when it could not be written. */
int cli_report_print(const cli_run *run, int status);
void cli_report_free(cli_report *report);

/* ---- files.c: whole files in, whole files out ---- */

typedef struct cli_output {
    char *path;
    char *temporary; /* NULL: written in place, because it is no plain file */
} cli_output;

/* Read a mesh from a file, .gz included; creates run->context when there is none. */
int cli_read_mesh(cli_run *run, const char *path, bvx_mesh *mesh);
/* Make sure that a file can be written: a file with a temporary name is made beside it. */
int cli_open_output(cli_run *run, const char *path);
/* Fill an output, numbered in the order of opening; it gets its name by cli_keep_outputs. */
int cli_write_output(cli_run *run, int number, const bvx_buffer *file);
int cli_keep_outputs(cli_run *run);
/* Remove what was not kept. */
void cli_drop_outputs(cli_run *run);

/* ---- terminal.c: time, interrupts, the progress bar ---- */

double cli_seconds(void); /* of a clock that only goes forward */
void cli_catch_interrupts(void);
int cli_interrupted(void);
int32_t cli_progress(void *run, const char *stage, double fraction); /* a bvx_progress_fn */
void cli_clear_bar(cli_run *run);

/* ---- main.c ---- */

struct cli_run {
    const cli_command *command;
    cli_options options;
    cli_report report;
    bvx_context *context;
    uint64_t context_limit; /* of its memory; 0: none */
    cli_output output[CLI_MAX_LEVELS];
    int outputs;
    double start;
    double bar_drawn; /* when; 0: no bar stands on the terminal */
    int bar;          /* 1: a bar may be shown */
};

/* The context of the run, which knows how many bytes of the limit are taken by the file in memory. */
int cli_make_context(cli_run *run, uint64_t file_bytes);

extern const cli_command cli_info, cli_voxelize, cli_lod, cli_render;

/* ---- pool.c ---- */

/* Give options the program's own threads, as many as they ask for (0: one a processor). */
void cli_pool_offer(bvx_context_options *options);

#endif
