/* terminal.c - time, and the progress of a run: a bar for people, lines of JSON for programs.
 *
 * A stage is what the command names: "level 0". The library may do several works in it, one after the other or in
 * turns, each counting from 0 to 1; a new work shares what the stage still lacks, so that the fraction told never falls.
 * The time left is estimated only where one work is the whole stage. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define TERMINAL_POSIX 1
#else
#define TERMINAL_POSIX 0
#endif

#include "cli/cli.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#if TERMINAL_POSIX
#include <unistd.h>
#endif

#define BAR_AFTER 0.5    /* seconds of work before a bar is shown */
#define TOLD_EVERY 0.1   /* seconds between two looks of it, or two lines */
#define LEFT_AFTER 1.0   /* seconds of a stage before the rest is estimated */
#define LEFT_FRACTION 0.02 /* of the stage, likewise */

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
    return isatty(STDERR_FILENO) && (term == NULL || strcmp(term, "dumb") != 0);
#else
    return 0;
#endif
}

static int progress_way(cli_run *run)
{
    if (run->progress.way == 0) {
        run->progress.way = run->options.progress;
        if (run->progress.way == CLI_BAR_AUTO)
            run->progress.way = !run->options.quiet && terminal_takes_a_bar() ? CLI_BAR_DRAW : CLI_BAR_NONE;
    }
    return run->progress.way;
}

/* Names are kept cut to their room. */
static int is_named(const char *kept, size_t room, const char *name)
{
    return strncmp(kept, name, room - 1) == 0;
}

static void note_bar(cli_run *run, int stands)
{
    cli_lock();
    run->progress.bar = stands;
    cli_unlock();
}

/* "12 s left" where that can be told. */
static void time_left(const cli_progress_state *p, double now, char *text, size_t room)
{
    double const elapsed = now - p->start;
    double left;
    text[0] = 0;
    if (p->parts > 1 || elapsed < LEFT_AFTER || p->reached < LEFT_FRACTION) return;
    left = elapsed / p->reached * (1.0 - p->reached);
    if (left < 1.0) return;
    if (left < 100.0) snprintf(text, room, ", %.0f s left", left);
    else if (left < 6000.0) snprintf(text, room, ", %.0f min left", left / 60.0);
    else if (left < 360000.0) snprintf(text, room, ", %.0f h left", left / 3600.0);
}

static void draw_bar(cli_run *run, double now)
{
    const cli_progress_state *const p = &run->progress;
    char bar[BAR_WIDTH + 1], left[32];
    int const filled = (int)(p->reached * BAR_WIDTH);
    for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR_WIDTH] = 0;
    time_left(p, now, left, sizeof left);
    note_bar(run, 1);
    fprintf(stderr, "\r[%s] %3.0f %% %s%s\033[K", bar, p->reached * 100.0, p->stage, left);
    fflush(stderr);
}

static void print_line(const cli_progress_state *p, double now)
{
    cli_text text = {NULL, 0, 0, 0};
    cli_text_add(&text, "{\"stage\": ");
    cli_json_string(&text, p->stage);
    cli_text_add(&text, ", \"fraction\": %.4f, \"elapsed\": %.3f}\n", p->reached, now - p->start);
    if (!text.failed) fwrite(text.bytes, 1, text.size, stderr);
    fflush(stderr);
    cli_text_free(&text);
}

static void tell_progress(cli_run *run, int last)
{
    cli_progress_state *const p = &run->progress;
    double const now = p->ended != 0.0 ? p->ended : cli_seconds();
    int const way = progress_way(run);
    if (!last && now - p->told < TOLD_EVERY) return;
    if (way == CLI_BAR_JSON) print_line(p, now);
    else if (way == CLI_BAR_DRAW && now - run->start > BAR_AFTER) draw_bar(run, now);
    else return;
    p->told = now;
}

/* The stage so far is over: that the run goes on shows that it succeeded. */
static void close_stage(cli_run *run, int done)
{
    cli_progress_state *const p = &run->progress;
    if (p->stage[0] == 0) return;
    if (done) p->reached = 1.0;
    if (progress_way(run) == CLI_BAR_JSON) tell_progress(run, 1);
    p->stage[0] = 0;
}

static void open_stage(cli_run *run, const char *name)
{
    cli_progress_state *const p = &run->progress;
    close_stage(run, 1);
    snprintf(p->stage, sizeof p->stage, "%s", name);
    p->parts = 0;
    p->start = cli_seconds();
    p->ended = p->base = p->reached = 0.0;
}

void cli_stage_begin(cli_run *run, const char *format, ...)
{
    char name[sizeof run->progress.stage];
    va_list args;
    va_start(args, format);
    vsnprintf(name, sizeof name, format, args);
    va_end(args);
    open_stage(run, name);
    run->progress.named = 1;
    if (!cli_interrupted()) tell_progress(run, 0);
}

double cli_stage_end(cli_run *run)
{
    cli_progress_state *const p = &run->progress;
    cli_report *const r = &run->report;
    p->ended = cli_seconds();
    p->named = 0;
    cli_note_peak(run, 0);
    cli_lock();
    if (r->stages < CLI_MAX_STAGES) {
        snprintf(r->stage[r->stages].name, sizeof r->stage[0].name, "%s", p->stage);
        r->stage[r->stages++].seconds = p->ended - p->start;
    }
    cli_unlock();
    return p->ended - p->start;
}

int32_t cli_progress(void *user, const char *work, double fraction)
{
    cli_run *const run = user;
    cli_progress_state *const p = &run->progress;
    if (cli_interrupted()) return 1;
    if (!p->named && (p->stage[0] == 0 || p->ended != 0.0 || !is_named(p->stage, sizeof p->stage, work))) open_stage(run, work);
    fraction = fraction >= 0.0 ? fraction < 1.0 ? fraction : 1.0 : 0.0; /* also when it is no number */
    if (p->parts == 0 || p->base + (1.0 - p->base) * fraction < p->reached) {
        p->parts++;
        p->base = p->reached;
    }
    p->reached = p->base + (1.0 - p->base) * fraction;
    tell_progress(run, 0);
    return 0;
}

void cli_progress_end(cli_run *run, int status)
{
    if (status == CLI_DONE) close_stage(run, 1);
    else if (status != CLI_INTERRUPTED) close_stage(run, 0);
    cli_clear_bar(run);
}

void cli_clear_bar(cli_run *run)
{
    if (!run->progress.bar) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    note_bar(run, 0);
}
