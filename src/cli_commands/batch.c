/* batch.c - one command over several inputs: with --output-dir each to a file of its name in a folder; info
 * tells of each.
 *
 * Each input is a run of its own, with its own context, report and output; what one of them meets does not
 * stop the others. All names are known before the first one, so that two inputs never go to one file, and
 * no input is replaced. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define BATCH_POSIX     1
#else
#define BATCH_POSIX 0
#endif

#include "cli_commands/commands.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#if BATCH_POSIX
#include <sys/stat.h>
#endif

typedef struct batch {
    cli_options asked; /* as the command line gave them */
    char **path;       /* of each output */
    cli_text reports;  /* of --json */
    cli_text lost;     /* inputs that failed */
    int done, failed;
    int status; /* of the first failure */
} batch;

/* The name in the folder, with the format's ending or the input's own, .gz included; number before it. */
static char *path_in_folder(const char *folder, const char *input, const char *number, const char *ending)
{
    const char *name = input, *dot;
    for (const char *p = input; *p != 0; p++) {
#if defined(_WIN32)
        if (*p == '\\' || *p == ':') name = p + 1;
#endif
        if (*p == '/') name = p + 1;
    }
    size_t const whole = strlen(name);
    size_t length = whole;
    size_t const room = strlen(folder) + length + 32;
    char *const path = malloc(room);

    if (path == NULL) return NULL;
    /* Both endings of a.stl.gz: number and a format stand before them, or in their place. */
    if (cli_is_packed(name)) length -= 3;
    dot = name + length;
    if (dot > name) dot--;
    while (dot > name && *dot != '.') dot--;
    if (dot > name) length = (size_t)(dot - name);
    if (ending != NULL) snprintf(path, room, "%s/%.*s%s.%s", folder, (int)length, name, number, ending);
    else snprintf(path, room, "%s/%.*s%s%s", folder, (int)length, name, number, name + length);
    return path;
}

static const char *ending_of_outputs(const cli_run *run, const char *input)
{
    int32_t const bit = run->command->bit;
    if (run->options->format != 0) return cli_format_name(run->options->format);
    if (bit == CLI_LOD && cli_kind_of_input(bvx_format_of_name(input)) != CLI_MESH) return "ply";
    if (bit == CLI_VOXELIZE) return "bvx";
    return bvx_format_of_name(input) == BVX_FORMAT_GLTF ? "glb" : NULL; /* the first is not written */
}

/* Levels have numbers, so that what a script finds does not depend on how many there are; .glb holds all. */
static const char *number_of_outputs(const cli_run *run, const cli_options *asked)
{
    int const several = asked->triangles.count > 1 || asked->errors.count > 1 || asked->count > 1;
    if (asked->format == BVX_FORMAT_GLB) return "";
    return run->command->bit == CLI_LOD || ((run->command->bit & (CLI_SIMPLIFY | CLI_HULL)) != 0 && several)
               ? "_%d"
               : "";
}

/* No input is replaced, by none of the files that an output may have. */
static int check_not_replaced(cli_run *run, const batch *b, int i)
{
    int const several = number_of_outputs(run, &b->asked)[0] != 0;
    int const numbers = several ? CLI_MAX_LEVELS : 1;

    for (int n = 0; n < numbers; n++) {
        char *const numbered = several ? cli_numbered_path(b->path[i], n) : NULL;
        const char *const path = several ? numbered : b->path[i];
        int status = path == NULL ? cli_fail(run, "no memory for a file's name") : CLI_DONE;

        /* By the file, not its name: a link is the same file. What does not exist is no input. */
        int const others = path != NULL && cli_are_one_file(path, path) ? b->asked.inputs : 0;

        for (int k = 0; status == CLI_DONE && k < others; k++)
            if (cli_are_one_file(path, b->asked.input[k]))
                status = cli_usage(run, "%s would replace the input %s; give another folder to --output-dir",
                                   path, b->asked.input[k]);
        free(numbered);
        CLI_TRY(status);
    }
    return CLI_DONE;
}

/* Every output by its name, before any work: none twice, none an input. */
static int name_outputs(cli_run *run, batch *b)
{
    const cli_options *const o = &b->asked;

    b->path = calloc((size_t)o->inputs, sizeof *b->path);
    if (b->path == NULL) return cli_fail(run, "no memory for %d files' names", o->inputs);

    for (int i = 0; i < o->inputs && o->output_dir != NULL; i++) {
        b->path[i] = path_in_folder(o->output_dir, o->input[i], number_of_outputs(run, o),
                                    ending_of_outputs(run, o->input[i]));
        if (b->path[i] == NULL) return cli_fail(run, "no memory for a file's name");
        for (int k = 0; k < i; k++)
            if (cli_same_name(b->path[i], b->path[k]))
                return cli_usage(run, "%s and %s would both become %s; nothing was done", o->input[k],
                                 o->input[i], b->path[i]);
    }
    for (int i = 0; i < o->inputs && o->output_dir != NULL; i++) CLI_TRY(check_not_replaced(run, b, i));
    return CLI_DONE;
}

static int make_folder(cli_run *run, const char *folder)
{
#if BATCH_POSIX
    struct stat s;

    /* It may be there already, or be made by another run at the same time. */
    if (mkdir(folder, 0777) == 0 || (stat(folder, &s) == 0 && S_ISDIR(s.st_mode))) return CLI_DONE;
    return cli_fail(run, "%s: the folder cannot be made: %s", folder, strerror(errno));
#else
#if defined(_WIN32)
    if (cli_make_folder(folder) != 0)
        return cli_fail(run, "%s: the folder cannot be made: %s", folder, strerror(errno));
#endif
    (void)run;
    (void)folder;
    return CLI_DONE;
#endif
}

static void keep_report(cli_run *run, batch *b, int status)
{
    cli_text text = {NULL, 0, 0, 0};
    cli_text *const t = &b->reports;

    if (!run->general->json) return;
    cli_report_text(run, status, &text);
    cli_text_add(t, "%s{\"input\": ", t->size == 0 ? "" : ", ");
    cli_json_string(t, run->options->input[0]);
    if (run->options->output != NULL) {
        cli_text_add(t, ", \"output\": ");
        cli_json_string(t, run->options->output);
    }
    /* less its { and line end */
    if (text.size > 2) cli_text_add(t, ", %.*s", (int)(text.size - 2), text.bytes + 1);
    if (text.failed) t->failed = 1;
    cli_text_free(&text);
}

static int run_file(cli_run *run, batch *b, int i)
{
    for (int k = 0; k < run->report.warnings; k++) free(run->report.warning[k].text);
    cli_text_free(&run->report.more);
    memset(&run->report, 0, sizeof run->report);
    for (int k = 0; k < run->outputs; k++) free(run->output[k].path);
    run->outputs = 0;
    memset(&run->progress, 0, sizeof run->progress);
    run->context = NULL;
    run->context_limit = 0;
    /* Commands fill in options that were not given, so each file starts from those of the line. */
    *run->options = b->asked;
    run->options->input[0] = b->asked.input[i];
    run->about = b->asked.input[i];
    run->options->inputs = 1;
    run->options->output = b->path[i];
    run->options->format = 0;
    run->options->output_dir = NULL;

    int status = cli_check_options(run);
    if (status == CLI_DONE) status = cli_perform(run);
    cli_progress_end(run, status);
    cli_note_peak(run, 0);
    cli_drop_outputs(run);
    keep_report(run, b, status);
    cli_release(run);
    bvx_context_destroy(run->context);
    run->context = NULL;

    if (status == CLI_DONE) b->done++;
    else cli_text_add(&b->lost, "%s %s", b->failed++ == 0 ? "; failed:" : ",", b->asked.input[i]);
    /* The first failure gives the exit status; an interrupt overrides it, and ends the rest. */
    if (b->status == CLI_DONE || status == CLI_INTERRUPTED) b->status = status;
    return status;
}

int cli_run_batch(cli_run *run)
{
    static batch b; /* zeroed */
    b.asked = *run->options;
    int status = name_outputs(run, &b);
    if (status == CLI_DONE && b.asked.output_dir != NULL) status = make_folder(run, b.asked.output_dir);
    if (status != CLI_DONE) return cli_end_of_run(run, status);

    for (int i = 0; i < b.asked.inputs && b.status != CLI_INTERRUPTED; i++) {
        if (i != 0 && b.asked.output_dir == NULL) cli_say(run, "\n");
        run_file(run, &b, i);
    }

    if (b.asked.general.json) {
        cli_text_add(
            &run->report.batch,
            "{\"status\": \"%s\", \"command\": \"%s\", \"done\": %d, \"failed\": %d, \"files\": [%s]}\n",
            b.status == CLI_DONE          ? "done"
            : b.status == CLI_INTERRUPTED ? "interrupted"
                                          : "failed",
            run->command->name, b.done, b.failed, b.reports.bytes != NULL ? b.reports.bytes : "");
        run->report.batch.failed |= b.reports.failed;
    }
    if (b.asked.output_dir != NULL)
        cli_say(run, "%d of %d files written to %s%s\n", b.done, b.asked.inputs, b.asked.output_dir,
                b.failed != 0 && !b.lost.failed ? b.lost.bytes : "");
    cli_text_free(&b.lost);
    return cli_end_of_run(run, b.status);
}
