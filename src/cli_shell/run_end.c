/* run_end.c - the last words of a run, and its exit status. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define END_POSIX       1
#else
#define END_POSIX 0
#endif

#include "cli_shell/shell.h"

#include <stdio.h>
#if END_POSIX
#include <poll.h>
#include <signal.h>
#include <unistd.h>
#endif

void cli_end_without_reader(void)
{
#if END_POSIX
    struct pollfd out = {.fd = STDOUT_FILENO, .events = POLLOUT};
    /* POLLERR on a pipe: nobody reads it any more. */
    if (poll(&out, 1, 0) != 1 || (out.revents & POLLERR) == 0) return;
    signal(SIGPIPE, SIG_DFL);
    raise(SIGPIPE);
#endif
}

static int fail_output(cli_run *run)
{
    if (cli_interrupted()) return cli_fail_interrupted(run);
    cli_end_without_reader();
    return cli_fail(run, "standard output cannot be written");
}

int cli_end_of_output(cli_run *run)
{
    return fflush(stdout) == 0 && !ferror(stdout) ? CLI_DONE : fail_output(run);
}

int cli_end_of_run(cli_run *run, int status)
{
    /* A report that cannot be written turns a success into a failure, and leaves a failure what it is. */
    if (!run->general->json || cli_report_print(run, status))
        return status == CLI_DONE ? cli_end_of_output(run) : status;
    return status == CLI_DONE ? fail_output(run) : status;
}
