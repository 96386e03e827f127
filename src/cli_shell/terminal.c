/* terminal.c - time, and the progress of a run: a bar for people, lines of JSON for programs.
 *
 * A stage is what the command names: "level 0". It has the share of the run that the plan of its command
 * gives it; of several calls of the library in one stage, that each report 0 to 1, the first moves it. One
 * fraction rises from 0 to 1 over the whole run; 1 is reported when the run has succeeded. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define TERMINAL_POSIX  1
#else
#define TERMINAL_POSIX 0
#endif

#include "cli_shell/shell.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#if TERMINAL_POSIX
#include <unistd.h>
#endif

#define BAR_AFTER     0.5  /* seconds of work before a bar is shown */
#define TOLD_EVERY    0.1  /* seconds between two looks of it, or two lines */
#define LEFT_AFTER    1.0  /* seconds of a run before the rest is estimated */
#define LEFT_FRACTION 0.05 /* of the run, likewise */

enum { BAR_WIDTH = 24 };

double cli_seconds(void)
{
#if TERMINAL_POSIX
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
#else
    return (double)clock() / CLOCKS_PER_SEC;
#endif
}

static int terminal_takes_a_bar(void)
{
#if TERMINAL_POSIX
    const char *const term = getenv("TERM");
    /* A dumb terminal does not know how to clear a line. */
    return isatty(STDERR_FILENO) && (term == NULL || strcmp(term, "dumb") != 0);
#else
    return 0;
#endif
}

static int progress_way(cli_run *run)
{
    if (run->progress.way == 0) {
        run->progress.way = run->general->progress;
        if (run->progress.way == CLI_BAR_AUTO)
            run->progress.way = !run->general->quiet && terminal_takes_a_bar() ? CLI_BAR_DRAW : CLI_BAR_NONE;
    }
    return run->progress.way;
}

/* "12 s left" where that is known. */
static void time_left(const cli_run *run, double now, char *text, size_t room)
{
    const cli_progress_state *const p = &run->progress;
    double const elapsed = now - run->start;
    text[0] = 0;
    /* An estimate from little is worse than none. */
    if (elapsed < LEFT_AFTER || p->reached < LEFT_FRACTION) return;
    double const left = elapsed / p->reached * (1.0 - p->reached);
    if (left < 1.0) return;
    if (left < 100.0) snprintf(text, room, ", %.0f s left", left);
    else if (left < 6000.0) snprintf(text, room, ", %.0f min left", left / 60.0);
    else if (left < 360000.0) snprintf(text, room, ", %.0f h left", left / 3600.0);
}

static void tell_progress(cli_run *run, int last)
{
    cli_progress_state *const p = &run->progress;
    double const now = p->ended != 0.0 ? p->ended : cli_seconds();
    int const way = progress_way(run);
    if (!last && now - p->told < TOLD_EVERY) return;
    if (way == CLI_BAR_JSON) {
        cli_text text = {NULL, 0, 0, 0};
        cli_text_add(&text, "{\"stage\": ");
        cli_json_string(&text, p->stage);
        cli_text_add(&text, ", \"fraction\": %.4f, \"elapsed\": %.3f}\n", p->reached, now - run->start);
        /* In one piece, so that lines of several threads or programs do not mix. */
        if (!text.failed) fwrite(text.bytes, 1, text.size, stderr);
        cli_text_free(&text);
    } else if (way == CLI_BAR_DRAW && now - run->start > BAR_AFTER) {
        char bar[BAR_WIDTH + 1], left[32];
        int const filled = (int)(p->reached * BAR_WIDTH);
        for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
        bar[BAR_WIDTH] = 0;
        time_left(run, now, left, sizeof left);
        p->bar = 1;
        fprintf(stderr, "\r[%s] %3.0f %% %s%s\033[K", bar, p->reached * 100.0, p->stage, left);
    } else return;
    fflush(stderr);
    p->told = now;
}

/* The stage so far is over: that the run goes on shows that it succeeded. */
static void close_stage(cli_run *run, int done)
{
    cli_progress_state *const p = &run->progress;
    if (p->stage[0] == 0) return;
    /* A stage may end before its share does. */
    if (done && p->high > p->reached) p->reached = p->high;
    if (progress_way(run) == CLI_BAR_JSON) tell_progress(run, 1);
    p->stage[0] = 0;
}

void cli_stage_begin(cli_run *run, const char *format, ...)
{
    char name[sizeof run->progress.stage];
    va_list args;
    va_start(args, format);
    vsnprintf(name, sizeof name, format, args);
    va_end(args);

    cli_progress_state *const p = &run->progress;
    double part = 0.5 / (p->rounds > 1 ? p->rounds : 1);
    /* What takes little beside that for which a command is called. */
    static const char *const starts[] = {"read", "parse", "threshold", "check"};
    for (size_t i = 0; i < sizeof starts / sizeof starts[0]; i++)
        if (strncmp(name, starts[i], strlen(starts[i])) == 0) part = 0.1;
    close_stage(run, 1);
    snprintf(p->stage, sizeof p->stage, "%s", name);
    p->start = cli_seconds();
    p->ended = 0.0;
    /* A fixed part of what is left of the bar, as the stages that follow are not known. */
    p->low = p->reached;
    p->high = p->low + (1.0 - p->low) * part;

    run->progress.named = 1;
    if (!cli_interrupted()) tell_progress(run, 0);
}

void cli_note_peak(cli_run *run, uint64_t bytes)
{
    uint64_t const all = bytes + bvx_memory_peak(run->context);
    if (all > run->report.peak_bytes) run->report.peak_bytes = all;
}

double cli_stage_end(cli_run *run)
{
    cli_progress_state *const p = &run->progress;
    cli_report *const r = &run->report;

    p->ended = cli_seconds();
    p->named = 0;
    cli_note_peak(run, 0);
    /* A run of more stages than the report holds goes on without naming them. */
    if (r->stages < CLI_MAX_STAGES) {
        snprintf(r->stage[r->stages].name, sizeof r->stage[0].name, "%s", p->stage);
        r->stage[r->stages++].seconds = p->ended - p->start;
    }
    return p->ended - p->start;
}

/* The fraction never falls, whatever order the calls of a stage report in. The end of a call is not that of the
 * stage. */
int32_t cli_progress(void *user, const char *work, double fraction)
{
    cli_run *const run = user;
    cli_progress_state *const p = &run->progress;
    (void)work;
    if (cli_interrupted()) return 1;
    double const at = p->low + (p->high - p->low) * fraction;
    if (!p->named || at <= p->reached || fraction >= 1.0) return 0;
    p->reached = at;
    tell_progress(run, 0);
    return 0;
}

void cli_progress_end(cli_run *run, int status)
{
    if (status == CLI_DONE) {
        run->progress.high = 1.0;
        close_stage(run, 1);
    } else if (status != CLI_INTERRUPTED) {
        close_stage(run, 0);
    }
    cli_clear_bar(run);
}

void cli_clear_bar(cli_run *run)
{
    if (!run->progress.bar) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    run->progress.bar = 0;
}
