/* shell.h - of the bitvox program: what it says, writes and hears; no
 * command and no option of one is known here. */
#ifndef BVX_CLI_SHELL_H
#define BVX_CLI_SHELL_H

#include "bitvox_io.h"
#include "cli_shell/endings.h"

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

/* Exit statuses. */
enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_USAGE = 2, CLI_INTERRUPTED = 130 };

enum {
    CLI_MAX_INPUTS = 64,
    CLI_MAX_FILES = 8192, /* inputs with --output-dir */
    CLI_MAX_LEVELS = 64,
    CLI_MAX_OUTPUTS = 512,
    CLI_MAX_STAGES = 6 * CLI_MAX_LEVELS,
    CLI_MAX_WARNINGS = 32,
    CLI_MAX_OPTIONS = 128
};

typedef struct cli_run cli_run;
typedef struct cli_options cli_options; /* cli_args/args.h */
typedef struct cli_command cli_command;
typedef struct cli_job cli_job;
typedef struct cli_made cli_made; /* cli_results/results.h */

enum { CLI_BAR_AUTO = 0, CLI_BAR_DRAW = 1, CLI_BAR_JSON = 2, CLI_BAR_NONE = 3 };

/* What the command line says to all commands. */
typedef struct cli_general {
    int32_t help, json, quiet;
    int32_t progress; /* CLI_BAR_... */
    int32_t threads;
    uint64_t memory_limit; /* 0: not given */
} cli_general;

/* ---- text.c: text that grows; what does not fit into memory is left out and marked ---- */

typedef struct cli_text {
    char *bytes; /* ends with a zero byte; NULL: empty */
    size_t size, room;
    int failed;
} cli_text;

void cli_text_add(cli_text *text, const char *format, ...);
void cli_text_free(cli_text *text);
/* Length of the UTF-8 sequence at p, 0 when there is none. */
int cli_utf8_length(const char *p);
/* Pieces of JSON. A string, with bytes that are no UTF-8 replaced; a number, null when it is none; "key":
 * with a comma and a space before it, but for the first. */
void cli_json_string(cli_text *text, const char *string);
void cli_json_number(cli_text *text, double value);
void cli_json_key(cli_text *text, const char *key, int first);
/* , "key": value */
void cli_json_count(cli_text *text, const char *key, uint64_t value);
void cli_json_value(cli_text *text, const char *key, double value);
void cli_json_truth(cli_text *text, const char *key, int value);
void cli_json_triple(cli_text *text, const char *key, const double value[3]);
void cli_json_ints(cli_text *text, const char *key, const int32_t value[3]);
void cli_json_box(cli_text *text, const char *key, const double low[3], const double high[3]);

/* ---- report.c: the report of --json ---- */

typedef struct cli_mesh_entry {
    const char *path;
    bvx_certificate certificate;
    const bvx_certificate *welded; /* with vertices at equal positions joined, or NULL */
    int colours, uvs;              /* it has them */
    int has_crossings;             /* they were counted */
    uint64_t crossings;
    const bvx_lod_report *lod;           /* or NULL */
    const bvx_level_report *level;       /* or NULL */
    int number;                          /* of the level, beside both */
    double milliseconds, rate;           /* milliseconds beside lod, rate beside both */
    int solid;                           /* beside level: 1, it was made from a measured surface */
    const bvx_distance_report *distance; /* to the input, or NULL */
} cli_mesh_entry;

/* What vertices and triangles of a mesh have beside their positions; normals follow from these. */
enum { CLI_HAS_COLOURS = 1, CLI_HAS_UVS = 2, CLI_HAS_SECOND_UVS = 4, CLI_HAS_MATERIALS = 8 };

typedef struct cli_warning {
    const char *code; /* "BVX_WARN_..." */
    char *text;
    int values, placed;
    double value[6], low[3], high[3];
} cli_warning;

typedef struct cli_report {
    bvx_lattice lattice;
    int has_lattice, has_set;
    uint64_t set;
    bvx_keep_report parts; /* of voxels, where some were to be dropped */
    int has_parts;
    uint64_t nonfinite; /* triangles of the inputs that were left out */
    uint32_t had, kept; /* CLI_HAS_...: attributes of the inputs, of the meshes in files */
    int materials;      /* of the inputs */
    int seams;          /* 1: those of the texture were looked for */
    struct {
        char name[32];
        double seconds;
    } stage[CLI_MAX_STAGES];
    int stages;
    cli_mesh_entry mesh[CLI_MAX_OUTPUTS];
    int meshes;
    cli_text more; /* further members as JSON, each with ", " before it */
    cli_warning warning[CLI_MAX_WARNINGS];
    int warnings, warnings_said;
    uint64_t peak_bytes; /* most bytes held for data */
    cli_text batch;      /* the whole report of several inputs, in place of the above */
    char error_code[32];
    char error_message[1024];
} cli_report;

/* The report as one line; status is the exit status. */
void cli_report_text(const cli_run *run, int status, cli_text *text);
/* Write it to standard output, or with -o - to standard error; 0 when that failed. */
int cli_report_print(cli_run *run, int status);

/* ---- messages.c: what is said to people ---- */
/* 1 for the name that stands for standard output. */
int cli_is_standard_output(const cli_run *run, const char *path);
/* The path as lines name it. */
const char *cli_output_name(const cli_run *run, const char *path);

/* Leave the function at the first step that fails, or call of the library in a function that returns its status; what
 * it holds is the command's to free. */
#define CLI_TRY(step)                                  \
    do {                                               \
        int const cli_failed = (step);                 \
        if (cli_failed != CLI_DONE) return cli_failed; \
    } while (0)

/* Print "bitvox: ..." to standard error, keep it for the report, return the exit status. */
int cli_fail(cli_run *run, const char *format, ...);
int cli_usage(cli_run *run, const char *format, ...);
/* The same for a call of the library that failed; about names the file or
 * is NULL. CLI_INTERRUPTED when cancelled. */
int cli_fail_status(cli_run *run, bvx_status status, const char *about);
/* CLI_DONE and its warnings taken where the call succeeded, else the same; the second also ends the stage that it was made in. */
int cli_check_call(cli_run *run, bvx_status status, const char *about);
int cli_stage_check(cli_run *run, bvx_status status, const char *about);
/* The same, with an advice after the message. */
int cli_fail_advised(cli_run *run, bvx_status status, const char *about, const char *advice);
int cli_fail_interrupted(cli_run *run);
/* A warning, of code BVX_WARN_..., that is said with the next ones; or now. */
void cli_keep_warning(cli_run *run, int32_t code, const char *format, ...);
#define cli_warn(run, ...) (cli_keep_warning(run, __VA_ARGS__), cli_say_warnings(run))
/* Keep what the call of the library that has just succeeded warns of; about: names for its result or only input, or
 * NULL, for its first and for its second input. Say what was kept. */
void cli_take_warnings(cli_run *run, const char *const about[3]);
void cli_say_warnings(cli_run *run);
/* Print to standard output unless --quiet, --json or an output takes it; to standard error with -o -. */
void cli_say(cli_run *run, const char *format, ...);
/* All of a text, which is freed. */
void cli_say_lines(cli_run *run, cli_text *lines);

/* ---- names.c: names of files, UTF-8 on Windows too ---- */

/* As fopen, remove and rename; a rename replaces what stands at the new name. */
FILE *cli_open_file(const char *name, const char *mode);
int cli_remove_file(const char *name);
int cli_rename_file(const char *from, const char *to);
/* The words of the command line; standard streams pass bytes as they are from here on. */
char **cli_words(int *count, char **word);
/* 1 when two files cannot bear both names: capitals do not count on Windows. */
int cli_same_name(const char *a, const char *b);
/* 1 when both are there and are the same. */
int cli_are_one_file(const char *a, const char *b);

#if defined(_WIN32)
enum { CLI_NAME_NONE = 0, CLI_NAME_FILE = 1, CLI_NAME_FOLDER = 2, CLI_NAME_DEVICE = 3 };
int cli_kind_of_name(const char *name); /* CLI_NAME_... */
int cli_make_folder(const char *name);  /* 0 when it is there */
#endif

/* ---- outputs.c: whole files out ---- */

enum { CLI_OUT_NEW = 0, CLI_OUT_IN_PLACE = 1, CLI_OUT_STANDARD = 2 };

typedef struct cli_output {
    char *path;      /* as it was given */
    char *target;    /* behind symbolic links */
    char *temporary; /* CLI_OUT_NEW, until it is kept */
    int kind;        /* CLI_OUT_... */
    int begun;       /* something was written in place */
} cli_output;

/* Make sure that a file can be written: a file with a temporary name is made beside it. */
int cli_open_output(cli_run *run, const char *path);
/* Fill an output, numbered in the order of opening; it gets its name by cli_keep_outputs. */
int cli_write_output(cli_run *run, int number, const bvx_buffer *file);
/* An output that gets no file after all; those opened later move up by one. What stands there stays. */
void cli_forget_output(cli_run *run, int number);
/* Give all outputs their names, one after the other. */
int cli_keep_outputs(cli_run *run);
/* Remove what was not kept. */
void cli_drop_outputs(cli_run *run);

/* ---- pack.c: outputs whose names end in .gz ---- */

/* Pack a file by gzip; packed->bytes is to be freed in any case. Not in builds without zlib. */
int cli_pack(cli_run *run, const char *path, const bvx_buffer *plain, bvx_buffer *packed);
int cli_is_packed(const char *path); /* ends in .gz */

/* ---- terminal.c: time and progress ---- */

double cli_seconds(void); /* of a clock that only goes forward */
/* A stage begins and ends, under the name that the report and the progress tell; the end returns its
 * seconds. */
void cli_stage_begin(cli_run *run, const char *format, ...);
double cli_stage_end(cli_run *run);
/* So many bytes are held beside what the context has now. */
void cli_note_peak(cli_run *run, uint64_t bytes);
/* A stage of one call of the library, and what came of it. */
#define CLI_STAGE(run, name, call, about) (cli_stage_begin(run, name), cli_stage_check(run, call, about))
int32_t cli_progress(void *run, const char *stage, double fraction); /* a bvx_progress_fn */
/* The last line, of fraction 1 after a success; no bar stays after. */
void cli_progress_end(cli_run *run, int status);
void cli_clear_bar(cli_run *run);

typedef struct cli_progress_state {
    char stage[32];      /* "" before the first */
    int named;           /* the command has begun it and not ended it */
    double low, high;    /* its share of the run */
    int rounds;          /* levels or pictures that stages are repeated for; 0: one */
    double start, ended; /* of the stage, seconds; ended 0: it still runs */
    double reached;      /* of the run */
    double told;         /* when the last line or bar was shown */
    int bar;             /* a bar stands on the terminal */
    int way;             /* CLI_BAR_..., 0: not yet decided */
} cli_progress_state;

/* ---- watch.c: interrupts ---- */

/* Before any other thread starts. */
void cli_watch_start(void);
int cli_interrupted(void);
/* What is said where an interrupt ends a program that waits, "" where all is said; NULL: there are files to tidy up. */
void cli_watch_last(const char *words);

/* ---- the run ---- */

struct cli_run {
    const char *name;                   /* of the command; NULL: none */
    const cli_command *command;         /* not looked at in this room */
    const cli_job *job;                 /* of the command, likewise */
    void *work;                         /* the job's own */
    const bvx_mesh *source;             /* of the job, whose materials files of levels get; NULL: none */
    const char *const *names;           /* of meshes that are no levels, for a .glb; NULL: none */
    const uint8_t *colours;             /* of these */
    cli_options *options;               /* likewise */
    void *own;                          /* the options of the command alone */
    const cli_command *const *commands; /* all of them, NULL after the last */
    const cli_general *general;         /* a part of the options */
    const char *about;                  /* the input that messages name, one of several; NULL: no need */
    uint64_t unheard; /* 1 << BVX_WARN_...: warnings of calls that say nothing of the result */
    const struct cli_argument *row[CLI_MAX_OPTIONS]; /* of the command's options */
    int rows;
    unsigned char given[CLI_MAX_OPTIONS]; /* by row */
    cli_report report;
    bvx_context *context;
    uint64_t context_limit; /* of its memory, when one was requested; 0: none */
    cli_output output[CLI_MAX_OUTPUTS];
    int outputs;
    int standard_taken;     /* standard output belongs to an output */
    char standard_name[32]; /* of -o -, with an ending; "" without */
    double start;
    cli_progress_state progress;
};

/* ---- run_end.c: the last words ---- */

/* The report of --json or what is left of the text; returns the exit status. */
int cli_end_of_run(cli_run *run, int status);
/* A reader that has seen enough, as head has, is not a failure: the program ends as others do, by the signal
 * and without a word. Only to be called where no file is still to be written. Returns where there is a reader. */
void cli_end_without_reader(void);
/* All text has gone to standard output. */
int cli_end_of_output(cli_run *run);

/* ---- run_context.c: the context of the run, and memory ---- */

/* Memory that this process may use: the machine's, or less where a container
 * or a limit of the shell allows less; 0 where the system does not report. */
uint64_t cli_memory_there(void);
/* Ask for huge pages behind a block, when it is large. */
void cli_large_block(void *block, size_t size);

/* The context of the run, where there is none yet; it knows how many bytes of the limit are taken by the
 * file in memory. */
int cli_make_context(cli_run *run, uint64_t file_bytes);

#endif
