/* messages.c - what is said to people: errors in one line, warnings, text. */
#include "cli_shell/shell.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* One line, whatever a file's name holds. */
static void tame(char *text)
{
    for (char *p = text; *p != 0; p++)
        if ((unsigned char)*p < 32 || *p == 127) *p = '?';
}

const char *cli_output_name(const cli_run *run, const char *path)
{
    return cli_is_standard_output(run, path) ? "standard output" : path;
}

int cli_is_standard_output(const cli_run *run, const char *path)
{
    return run->standard_name[0] != 0 && strcmp(path, run->standard_name) == 0;
}

/* What is written to standard output is called that, without the ending that its format goes by. */
static void name_standard(const cli_run *run, char *text)
{
    char *const at = run->standard_name[0] != 0 ? strstr(text, run->standard_name) : NULL;
    const char *const end = at != NULL ? at + strlen(run->standard_name) : NULL;
    if (at != NULL) memmove(at + strcspn(at, "."), end, strlen(end) + 1);
}

/* "IN: " in front of a message about one of several inputs that does not name it itself, else "". */
static void name_input(const cli_run *run, const char *message, char *prefix, size_t room)
{
    const char *const in = run->about;
    prefix[0] = 0;
    if (in != NULL && strncmp(message, in, strlen(in)) != 0) snprintf(prefix, room, "%s: ", in);
    tame(prefix);
}

static int tell_error(cli_run *run, int status, const char *code, const char *message)
{
    cli_report *const r = &run->report;
    char prefix[512];

    name_input(run, message, prefix, sizeof prefix);
    snprintf(r->error_code, sizeof r->error_code, "%s", code);
    snprintf(r->error_message, sizeof r->error_message, "%s", message);
    name_standard(run, r->error_message);
    tame(r->error_message);
    cli_clear_bar(run);
    fflush(stdout);
    fprintf(stderr, "bitvox: %s%s\n", prefix, r->error_message);
    return status;
}

int cli_fail(cli_run *run, const char *format, ...)
{
    char text[sizeof run->report.error_message];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return tell_error(run, CLI_FAILED, "FILE", text);
}

int cli_usage(cli_run *run, const char *format, ...)
{
    char text[sizeof run->report.error_message];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    return tell_error(run, CLI_USAGE, "USAGE", text);
}

/* Only what is written in place can be cut. */
int cli_fail_interrupted(cli_run *run)
{
    char text[sizeof run->report.error_message] = "interrupted; nothing was written";
    for (int i = 0; i < run->outputs; i++)
        if (run->output[i].begun)
            snprintf(text, sizeof text, "interrupted; %s may have received a part of its bytes",
                     run->output[i].path);
    return tell_error(run, CLI_INTERRUPTED, "BVX_CANCELLED", text);
}

int cli_fail_status(cli_run *run, bvx_status status, const char *about)
{
    return cli_fail_advised(run, status, about, "");
}

int cli_fail_advised(cli_run *run, bvx_status status, const char *about, const char *advice)
{
    char text[sizeof run->report.error_message], held[96] = "";
    const char *const message = run->context != NULL ? bvx_last_error(run->context)->text : "";
    if (status == BVX_CANCELLED) return cli_fail_interrupted(run);
    /* A call that failed without a context has no message of its own. */
    /* What the library was given is less than what the option says. */
    if (status == BVX_ERR_BUDGET && run->context_limit != 0)
        snprintf(held, sizeof held, "; the file takes %" PRIu64 " bytes of --memory-limit besides",
                 run->general->memory_limit - run->context_limit);
    snprintf(text, sizeof text, "%s%s%s%s%s", about != NULL ? about : "", about != NULL ? ": " : "",
             message[0] != 0 ? message : bvx_status_text(status), held, advice);
    switch (status) {
#define FAIL_BY_NAME(name, value, words) \
    case name: return tell_error(run, CLI_FAILED, #name, text);
        BVX_STATUS_LIST(FAIL_BY_NAME)
#undef FAIL_BY_NAME
    default: return tell_error(run, CLI_FAILED, "UNKNOWN", text);
    }
}

int cli_check_call(cli_run *run, bvx_status status, const char *about)
{
    const char *const of[3] = {NULL, about, about};
    if (status != BVX_OK) return cli_fail_status(run, status, about);
    cli_take_warnings(run, of);
    return CLI_DONE;
}

int cli_stage_check(cli_run *run, bvx_status status, const char *about)
{
    cli_stage_end(run);
    return cli_check_call(run, status, about);
}

static void keep_warning(cli_run *run, const cli_warning *warning, char *text)
{
    cli_report *const r = &run->report;
    cli_warning w = *warning;
    name_standard(run, text);
    tame(text);
    w.text = malloc(strlen(text) + 1);
    if (w.text == NULL || r->warnings == CLI_MAX_WARNINGS) {
        free(w.text);
        return;
    }
    memcpy(w.text, text, strlen(text) + 1);
    r->warning[r->warnings++] = w;
}

#define NAME_OF_WARNING(name, value) [value] = #name,
static const char *const warning_names[] = {BVX_WARN_LIST(NAME_OF_WARNING)};

void cli_keep_warning(cli_run *run, int32_t code, const char *format, ...)
{
    cli_warning const plain = {.code = warning_names[code]};
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    keep_warning(run, &plain, text);
}

void cli_take_warnings(cli_run *run, const char *const about[3])
{
    const bvx_warning *w;
    while ((w = bvx_next_warning(run->context)) != NULL) {
        cli_warning kept = {.code = w->name, .values = w->value_count, .placed = w->placed};
        const char *const of = about[w->input + 1];
        char text[1024];
        if ((run->unheard >> w->code & 1) != 0) continue;
        memcpy(kept.value, w->value, sizeof kept.value);
        memcpy(kept.low, w->low, sizeof kept.low);
        memcpy(kept.high, w->high, sizeof kept.high);
        snprintf(text, sizeof text, "%s%s%s", of != NULL ? of : "", of != NULL ? ": " : "", w->text);
        keep_warning(run, &kept, text);
    }
}

void cli_say_warnings(cli_run *run)
{
    cli_report *const r = &run->report;
    for (; r->warnings_said < r->warnings; r->warnings_said++) {
        const cli_warning *const w = &r->warning[r->warnings_said];
        char prefix[512];
        cli_clear_bar(run);
        fflush(stdout);
        name_input(run, w->text, prefix, sizeof prefix);
        if (!run->general->quiet) fprintf(stderr, "bitvox: warning: %s%s [%s]\n", prefix, w->text, w->code);
    }
}

void cli_say(cli_run *run, const char *format, ...)
{
    va_list args;
    /* With -o - the text moves to standard error; none where standard output is an output's path. */
    if (run->general->quiet || run->general->json || (run->standard_taken && run->standard_name[0] == 0))
        return;
    cli_clear_bar(run);
    va_start(args, format);
    vfprintf(run->standard_taken ? stderr : stdout, format, args);
    va_end(args);
}

void cli_say_lines(cli_run *run, cli_text *lines)
{
    if (lines->size != 0) cli_say(run, "%s", lines->bytes);
    cli_text_free(lines);
}
