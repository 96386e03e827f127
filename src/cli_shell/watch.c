/* watch.c - interrupts end a run at once and leave nothing half-written.
 *
 * SIGINT, SIGTERM and SIGHUP are blocked in every thread and taken by one thread that waits for them. It
 * raises the flag that progress reads, so that a run between two pieces of work stops by itself and tidies
 * up. A run that has not ended after PATIENCE (deep in one long step, or waiting for a pipe or a slow disk)
 * is ended here: temporaries are removed, the usual message and report are written by write(2), which waits
 * for no lock of stdio, and the program exits.
 *
 * One lock orders this with the main thread. It is held around every change of files' names and never
 * released once the program is being ended: outputs then have all got their names, or none has and none
 * will. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define WATCH_POSIX     1
#else
#define WATCH_POSIX 0
#endif

#define WATCH_HEAVY (UINT64_C(64) << 20) /* bytes that the system needs some milliseconds to take back */

#include "cli_shell/shell.h"

#include <signal.h>
#include <stdio.h>
#include <string.h>
#if WATCH_POSIX
#include <poll.h>
#include <pthread.h>
#include <sys/resource.h>
#include <sys/types.h>
#include <time.h>
#include <unistd.h>
#endif

static volatile sig_atomic_t watch_signalled; /* by a handler, where no thread waits */

#if WATCH_POSIX

enum {
    PATIENCE = 15,     /* milliseconds for a run to end by itself */
    GRACE = 10,        /* milliseconds more to end a message or report that is being printed */
    LATE_TRIES = 2000, /* milliseconds that a successor waits for this process to end */
    WRITE_PART = 512,  /* bytes that a pipe takes without waiting, once it takes any */
    WRITE_WAIT = 10    /* milliseconds to wait for a reader */
};

static struct watch {
    pthread_mutex_t lock;
    cli_run *run; /* NULL: nothing to leave yet */
    const cli_leaving *leaving;
    int interrupted;
    int kept;                                 /* the outputs have their names */
    int status;                               /* of the exit; -1: not known */
    enum { NOTHING, MESSAGE, REPORT } saying; /* by the main thread, now */
    int reported;                             /* the report is said, or its saying has begun */
} watch = {PTHREAD_MUTEX_INITIALIZER, NULL, NULL, 0, 0, -1, NOTHING, 0};

static sigset_t watch_signals;

void cli_lock(void)
{
    pthread_mutex_lock(&watch.lock);
}

void cli_unlock(void)
{
    pthread_mutex_unlock(&watch.lock);
}

void cli_watch_run(cli_run *run, const cli_leaving *leaving)
{
    cli_lock();
    watch.run = run;
    watch.leaving = leaving;
    cli_unlock();
}

int cli_interrupted(void)
{
    cli_lock();
    /* Once the files have their names the work is done and nothing is left to cancel. */
    int const now = !watch.kept && (watch.interrupted || watch_signalled);
    cli_unlock();
    return now;
}

void cli_watch_kept(void)
{
    watch.kept = 1;
}

void cli_watch_again(void)
{
    watch.kept = 0;
    watch.status = -1;
    watch.reported = 0;
}

void cli_watch_decide(int status)
{
    watch.status = status;
    watch.saying = MESSAGE;
}

void cli_watch_report(void)
{
    cli_lock();
    watch.saying = REPORT;
    watch.reported = 1;
    cli_unlock();
}

void cli_watch_told(void)
{
    cli_lock();
    watch.saying = NOTHING;
    cli_unlock();
}

static void wait_milliseconds(int n)
{
    struct timespec t = {0, 0};
    t.tv_nsec = (long)n * 1000000;
    nanosleep(&t, NULL);
}

/* As much as is taken without waiting for long. */
static void write_soon(int file, const char *bytes, size_t size)
{
    size_t done = 0;

    while (done < size) {
        struct pollfd p;
        size_t const part = size - done < WRITE_PART ? size - done : WRITE_PART;
        p.fd = file;
        p.events = POLLOUT;
        p.revents = 0;
        /* A reader that does not read must not hold up the end. */
        if (poll(&p, 1, WRITE_WAIT) != 1 || (p.revents & POLLOUT) == 0) return;
        ssize_t const n = write(file, bytes + done, part);
        if (n <= 0) return;
        done += (size_t)n;
    }
}

static void say_error(const cli_run *run, const char *message)
{
    cli_text line = {NULL, 0, 0, 0};
    cli_text_add(&line, "%sbitvox: %s\n", run != NULL && run->progress.bar ? "\r\033[K" : "", message);
    write_soon(STDERR_FILENO, line.bytes, line.size);
}

static void say_interrupt(cli_run *run)
{
    cli_report *const r = &run->report;
    watch.leaving->say(run, r->error_message, sizeof r->error_message);
    snprintf(r->error_code, sizeof r->error_code, "BVX_CANCELLED");
    say_error(run, r->error_message);
}

/* An exit takes long where much memory and large files, now without names, are to be taken back. A copy of
 * the process that waits for the exit inherits both, and the work. */
static void leave_heavy_things(void)
{
    pid_t const parent = getpid();
    struct rusage use;
    uint64_t bytes = watch.run != NULL ? watch.run->removed_bytes : 0;
    if (getrusage(RUSAGE_SELF, &use) == 0) bytes += (uint64_t)use.ru_maxrss * 1024;
    /* The parent exits at once; the child keeps memory and files alive until nobody waits. */
    if (bytes < WATCH_HEAVY || fork() != 0) return;
    for (int i = 0; i < 3; i++) close(i); /* who reads them must not wait */
    for (int i = 0; i < LATE_TRIES && getppid() == parent; i++) wait_milliseconds(1);
    _exit(0);
}

void cli_watch_end(int status)
{
    cli_lock();
    watch.status = status;
    if (watch.interrupted) leave_heavy_things();
    cli_unlock();
}

/* Called with the lock, which nobody gets any more. */
static void end_program(void)
{
    cli_run *const run = watch.run;
    int const status = watch.status >= 0 ? watch.status : CLI_INTERRUPTED;

    /* The command line is still being read. */
    if (run == NULL) {
        if (watch.status < 0) say_error(run, "interrupted; nothing was written");
        _exit(status);
    }
    watch.leaving->remove(run);
    if (watch.status < 0) say_interrupt(run);
    else if (watch.saying == MESSAGE)
        say_error(run, run->report.error_message); /* it waits for standard output */
    /* A report that the main thread has begun is its own to end. */
    if (run->general->json && !watch.reported) {
        cli_text text = {NULL, 0, 0, 0};
        watch.leaving->report(run, status, 1, &text);
        write_soon(run->standard_taken ? STDERR_FILENO : STDOUT_FILENO, text.bytes, text.size);
    }
    leave_heavy_things();
    _exit(status);
}

static void *wait_for_signal(void *unused)
{
    int number;

    (void)unused;
    while (sigwait(&watch_signals, &number) != 0) {}
    cli_lock();
    watch.interrupted = 1;
    cli_unlock();
    /* The run may heed the flag by itself, which is the tidier way. */
    wait_milliseconds(PATIENCE);
    cli_lock();
    /* A message that is being printed is not cut in the middle. */
    for (int i = 0; i < GRACE && watch.saying != NOTHING; i++) {
        cli_unlock();
        wait_milliseconds(1);
        cli_lock();
    }
    end_program();
    return NULL;
}

static void note_signal(int number)
{
    (void)number;
    watch_signalled = 1;
}

/* Without the thread the flag alone must do; no SA_RESTART, so that a read that waits ends. */
static void watch_by_handlers(const int *number, int count)
{
    struct sigaction act;
    memset(&act, 0, sizeof act);
    act.sa_handler = note_signal;
    sigemptyset(&act.sa_mask);
    for (int i = 0; i < count; i++)
        if (sigismember(&watch_signals, number[i]) == 1) sigaction(number[i], &act, NULL);
    pthread_sigmask(SIG_UNBLOCK, &watch_signals, NULL);
}

/* What was ignored when the program started stays ignored (nohup, jobs in the background of a script). A pipe
 * that nobody reads, or a file beyond the shell's limit of sizes, is an error of writing like any other, not
 * the end of a program with files to tidy up. */
void cli_watch_start(void)
{
    static const int caught[3] = {SIGINT, SIGTERM, SIGHUP};
    pthread_t thread;
    int count = 0;

    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    sigemptyset(&watch_signals);
    for (int i = 0; i < 3; i++) {
        struct sigaction old;
        /* Ignored by whoever started the program. */
        if (sigaction(caught[i], NULL, &old) != 0 || old.sa_handler == SIG_IGN) continue;
        sigaddset(&watch_signals, caught[i]);
        count++;
    }
    if (count == 0) return;
    pthread_sigmask(SIG_BLOCK, &watch_signals, NULL); /* for the threads that follow too */
    if (pthread_create(&thread, NULL, wait_for_signal, NULL) != 0) watch_by_handlers(caught, 3);
    else pthread_detach(thread);
}

#else

static int watch_kept; /* the outputs have their names */

static void note_signal(int number)
{
    watch_signalled = 1;
    signal(number, note_signal); /* some systems forget it */
}

void cli_watch_start(void)
{
    signal(SIGINT, note_signal);
    signal(SIGTERM, note_signal);
}

int cli_interrupted(void)
{
    return !watch_kept && watch_signalled != 0;
}

void cli_watch_kept(void)
{
    watch_kept = 1;
}

void cli_watch_again(void)
{
    watch_kept = 0;
}

void cli_watch_run(cli_run *run, const cli_leaving *leaving)
{
    (void)run;
    (void)leaving;
}

void cli_watch_decide(int status)
{
    (void)status;
}

void cli_watch_report(void)
{
}

void cli_watch_end(int status)
{
    (void)status;
}

void cli_watch_told(void)
{
}

void cli_lock(void)
{
}

void cli_unlock(void)
{
}

#endif
