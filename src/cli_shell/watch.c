/* watch.c - an interrupt ends a run between two pieces of work, so that nothing is left half-written.
 *
 * SIGINT, SIGTERM and SIGHUP raise a flag that progress reads. No call of the system is restarted after them, so
 * what waits for a pipe or a slow disk ends too. An alarm follows each second: where no file is left to tidy up it
 * ends the program, which may be waiting for a reader of its text. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define WATCH_POSIX     1
#else
#define WATCH_POSIX 0
#endif

#include "cli_shell/shell.h"

#include <signal.h>
#include <string.h>
#if WATCH_POSIX
#include <unistd.h>
#endif

static volatile sig_atomic_t signalled;
static const char *volatile watch_last = "bitvox: interrupted; nothing was written\n";

void cli_watch_last(const char *words)
{
    watch_last = words;
}

int cli_interrupted(void)
{
    return signalled != 0;
}

#if WATCH_POSIX

static void note_signal(int number)
{
    const char *const words = watch_last;
    signalled = 1;
    if (number == SIGALRM && words != NULL) {
        (void)!write(STDERR_FILENO, words, strlen(words));
        _exit(CLI_INTERRUPTED);
    }
    alarm(1);
}

/* What was ignored when the program started stays ignored (nohup, jobs in the background of a script). A pipe
 * that nobody reads, or a file beyond the shell's limit of sizes, is an error of writing like any other, not
 * the end of a program with files to tidy up. */
void cli_watch_start(void)
{
    static const int caught[3] = {SIGINT, SIGTERM, SIGHUP};
    struct sigaction act, old;

    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    memset(&act, 0, sizeof act);
    act.sa_handler = note_signal;
    sigemptyset(&act.sa_mask);
    sigaction(SIGALRM, &act, NULL);
    for (int i = 0; i < 3; i++)
        if (sigaction(caught[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN)
            sigaction(caught[i], &act, NULL);
}

#else

static void note_signal(int number)
{
    signalled = 1;
    signal(number, note_signal); /* some systems forget it */
}

void cli_watch_start(void)
{
    signal(SIGINT, note_signal);
    signal(SIGTERM, note_signal);
}

#endif
