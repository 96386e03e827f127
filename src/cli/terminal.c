/* terminal.c - time, interrupts, the progress bar. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define CLI_POSIX 1
#else
#define CLI_POSIX 0
#endif

#include "cli/cli.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <time.h>
#if CLI_POSIX
#include <unistd.h>
#endif

#define BAR_AFTER 0.5 /* seconds of work before a bar is shown */
#define BAR_EVERY 0.1 /* seconds between two looks of it */

enum { BAR_WIDTH = 30 };

static volatile sig_atomic_t terminal_interrupted;

double cli_seconds(void)
{
#if CLI_POSIX
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
#else
    return (double)clock() / CLOCKS_PER_SEC;
#endif
}

static void note_interrupt(int number)
{
    (void)number;
    terminal_interrupted = 1;
#if !CLI_POSIX
    signal(number, note_interrupt); /* some systems forget it */
#endif
}

/* A program started in the background with interrupts ignored keeps ignoring them, but for a plain SIGTERM. */
void cli_catch_interrupts(void)
{
#if CLI_POSIX
    static const int caught[3] = {SIGINT, SIGTERM, SIGHUP};
    for (int i = 0; i < 3; i++) {
        struct sigaction old, act;
        memset(&act, 0, sizeof act);
        act.sa_handler = note_interrupt; /* no SA_RESTART: a read that waits ends */
        sigemptyset(&act.sa_mask);
        if (sigaction(caught[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN) sigaction(caught[i], &act, NULL);
    }
#else
    signal(SIGINT, note_interrupt);
    signal(SIGTERM, note_interrupt);
#endif
}

int cli_interrupted(void)
{
    return terminal_interrupted != 0;
}

static int is_terminal(FILE *file)
{
#if CLI_POSIX
    return isatty(fileno(file));
#else
    (void)file;
    return 0;
#endif
}

/* Stages are named by the library's functions: "bvx_voxelize_solid" reads "voxelize solid". */
static void draw_bar(const char *stage, double fraction)
{
    char bar[BAR_WIDTH + 1], name[40];
    int const filled = (int)(fraction * BAR_WIDTH);
    for (int i = 0; i < BAR_WIDTH; i++) bar[i] = i < filled ? '#' : '.';
    bar[BAR_WIDTH] = 0;
    snprintf(name, sizeof name, "%s", strncmp(stage, "bvx_", 4) == 0 ? stage + 4 : stage);
    for (char *p = name; *p != 0; p++)
        if (*p == '_') *p = ' ';
    fprintf(stderr, "\r[%s] %3.0f %% %s\033[K", bar, fraction * 100.0, name);
    fflush(stderr);
}

int32_t cli_progress(void *user, const char *stage, double fraction)
{
    cli_run *const run = user;
    double const now = cli_seconds();
    if (run->bar == 0) run->bar = !run->options.quiet && is_terminal(stderr) ? 1 : -1;
    if (run->bar == 1 && now - run->start > BAR_AFTER && now - run->bar_drawn > BAR_EVERY) {
        draw_bar(stage, fraction < 0.0 ? 0.0 : fraction > 1.0 ? 1.0 : fraction);
        run->bar_drawn = now;
    }
    return cli_interrupted();
}

void cli_clear_bar(cli_run *run)
{
    if (run->bar_drawn == 0.0) return;
    fprintf(stderr, "\r\033[K");
    fflush(stderr);
    run->bar_drawn = 0.0;
}
