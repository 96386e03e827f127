/* fail_calls.c - runs a program whose calls to the system fail where they are told to, or do a part of what
 * they are asked.
 *
 *   fail_calls SEEN CALL WAY FIRST LAST PROGRAM ARGUMENTS...
 *
 * CALL: read, write, open, close, rename, link, remove, look (stat), memory (mmap), thread.
 * WAY: an error by its name, which the calls FIRST to LAST return (LAST 0: all from FIRST on); a signal by
 * its name, which the program gets when it makes them; or "short": they are requested a third of their bytes,
 * one at least. Calls are numbered from the moment when the program looks at its standard streams, so that
 * the loader's are left alone; writes to standard error are not counted. SEEN is a file that gets the number
 * of calls. Exit status: the program's, 128 and the signal's number when one ended it, 125 when nothing ran.
 *
 * It traces the program (ptrace), because calls inside the C library cannot be replaced by preloading. Linux
 * on x86-64 only; elsewhere it says so with status 77. */
#define _GNU_SOURCE
#include <stdio.h>
#include <stdlib.h>

enum { NOT_RUN = 125, NOT_HERE = 77 };

#if defined(__linux__) && defined(__x86_64__)

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <string.h>
#include <sys/ptrace.h>
#include <sys/syscall.h>
#include <sys/user.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MAX_THREADS = 64, MAX_CALLS = 5 };

static const struct kind {
    const char *name;
    long number[MAX_CALLS]; /* -1: none */
} kinds[] = {
    {"read", {SYS_read, SYS_readv, SYS_pread64, -1, -1}},
    {"write", {SYS_write, SYS_writev, SYS_pwrite64, -1, -1}},
    {"open", {SYS_open, SYS_openat, SYS_creat, -1, -1}},
    {"close", {SYS_close, -1, -1, -1, -1}},
    {"rename", {SYS_rename, SYS_renameat, SYS_renameat2, -1, -1}},
    {"link", {SYS_link, SYS_linkat, -1, -1, -1}},
    {"remove", {SYS_unlink, SYS_unlinkat, -1, -1, -1}},
    {"look", {SYS_stat, SYS_lstat, SYS_fstat, SYS_newfstatat, -1}},
    {"memory", {SYS_mmap, -1, -1, -1, -1}},
    {"thread", {SYS_clone, SYS_clone3, -1, -1, -1}},
};

static const struct error {
    const char *name;
    int number;
} errors[] = {{"EINTR", EINTR},   {"EIO", EIO},       {"ENOSPC", ENOSPC}, {"EAGAIN", EAGAIN},
              {"ENOENT", ENOENT}, {"EACCES", EACCES}, {"EROFS", EROFS},   {"EMFILE", EMFILE},
              {"ENOMEM", ENOMEM}, {"EPERM", EPERM},   {"EXDEV", EXDEV},   {"ENOSYS", ENOSYS}};

static const struct sent {
    const char *name;
    int number;
} signals[] = {{"SIGINT", SIGINT}, {"SIGTERM", SIGTERM}, {"SIGHUP", SIGHUP}, {"SIGKILL", SIGKILL}};

/* What was changed in the call that a thread is in. */
typedef struct thread {
    pid_t id;
    int inside;
    int error;                /* to be returned; 0: none */
    int cut;                  /* asked is to be put back */
    unsigned long long asked; /* bytes */
} thread;

static struct fault {
    const struct kind *kind;
    int error, signal; /* 0: none; both: short */
    pid_t program;
    long first, last;
    long seen;
    int counting;
} fault;

static thread threads[MAX_THREADS];

static thread *find_thread(pid_t id)
{
    thread *unused = NULL;
    for (int i = 0; i < MAX_THREADS; i++) {
        if (threads[i].id == id) return &threads[i];
        if (threads[i].id == 0 && unused == NULL) unused = &threads[i];
    }
    return unused;
}

static int is_counted(long call, const struct user_regs_struct *r)
{
    if (!fault.counting) return 0;
    if ((call == SYS_write || call == SYS_writev) && r->rdi == STDERR_FILENO) return 0;
    for (int i = 0; i < MAX_CALLS && fault.kind->number[i] >= 0; i++)
        if (fault.kind->number[i] == call) return 1;
    return 0;
}

static void enter_call(thread *t, struct user_regs_struct *r)
{
    long const call = (long)r->orig_rax;

    if (call == SYS_fcntl && r->rdi == 0 && r->rsi == F_GETFD) fault.counting = 1;
    if (!is_counted(call, r)) return;
    fault.seen++;
    if (fault.seen < fault.first || (fault.last != 0 && fault.seen > fault.last)) return;
    if (fault.signal != 0) {
        kill(fault.program, fault.signal);
        return;
    }
    if (fault.error != 0) {
        t->error = fault.error;
        r->orig_rax = (unsigned long long)-1; /* no call at all */
    } else if (call != SYS_readv && call != SYS_writev && r->rdx > 1) {
        t->cut = 1;
        t->asked = r->rdx;
        r->rdx = r->rdx / 3 + (r->rdx < 3);
    } else {
        return;
    }
    ptrace(PTRACE_SETREGS, t->id, NULL, r);
}

static void leave_call(thread *t, struct user_regs_struct *r)
{
    if (t->error != 0) r->rax = (unsigned long long)-(long long)t->error;
    else if (t->cut) r->rdx = t->asked;
    else return;
    t->error = t->cut = 0;
    ptrace(PTRACE_SETREGS, t->id, NULL, r);
}

static void stop_at_call(pid_t id)
{
    thread *const t = find_thread(id);
    struct user_regs_struct r;
    if (t == NULL || ptrace(PTRACE_GETREGS, id, NULL, &r) != 0) return;
    t->id = id;
    t->inside = !t->inside;
    if (t->inside) enter_call(t, &r);
    else leave_call(t, &r);
}

/* Until the program ends; its status. */
static int follow(pid_t program)
{
    for (;;) {
        int status, pass = 0;
        pid_t const id = waitpid(-1, &status, __WALL);
        if (id < 0) return NOT_RUN;
        if (WIFEXITED(status) || WIFSIGNALED(status)) {
            thread *const t = find_thread(id);
            if (t != NULL) memset(t, 0, sizeof *t);
            if (id == program) return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
            continue;
        }
        if (WSTOPSIG(status) == (SIGTRAP | 0x80)) stop_at_call(id);
        else if (WSTOPSIG(status) != SIGTRAP && WSTOPSIG(status) != SIGSTOP) pass = WSTOPSIG(status);
        ptrace(PTRACE_SYSCALL, id, NULL, (void *)(long)pass);
    }
}

static int run_traced(char **words)
{
    int status;
    pid_t const program = fork();

    if (program == 0) {
        if (ptrace(PTRACE_TRACEME, 0, NULL, NULL) != 0) _exit(NOT_RUN);
        raise(SIGSTOP);
        execv(words[0], words);
        _exit(NOT_RUN);
    }
    if (program < 0 || waitpid(program, &status, 0) != program || !WIFSTOPPED(status)) return NOT_RUN;
    if (ptrace(PTRACE_SETOPTIONS, program, NULL,
               (void *)(long)(PTRACE_O_TRACESYSGOOD | PTRACE_O_TRACECLONE | PTRACE_O_TRACEEXEC |
                              PTRACE_O_EXITKILL)) != 0) {
        kill(program, SIGKILL);
        return NOT_RUN;
    }
    fault.program = program;
    ptrace(PTRACE_SYSCALL, program, NULL, NULL);
    return follow(program);
}

static int take_words(char **words)
{
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (strcmp(kinds[i].name, words[2]) == 0) fault.kind = &kinds[i];
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++)
        if (strcmp(errors[i].name, words[3]) == 0) fault.error = errors[i].number;
    for (size_t i = 0; i < sizeof signals / sizeof signals[0]; i++)
        if (strcmp(signals[i].name, words[3]) == 0) fault.signal = signals[i].number;
    fault.first = strtol(words[4], NULL, 10);
    fault.last = strtol(words[5], NULL, 10);
    return fault.kind != NULL && (fault.error != 0 || fault.signal != 0 || strcmp(words[3], "short") == 0);
}

int main(int count, char **words)
{
    int status;
    FILE *seen;

    if (count < 7 || !take_words(words)) {
        fprintf(stderr, "usage: fail_calls SEEN CALL WAY FIRST LAST PROGRAM ARGUMENTS...\n");
        return NOT_RUN;
    }
    status = run_traced(words + 6);
    seen = fopen(words[1], "w");
    if (seen == NULL) return NOT_RUN;
    fprintf(seen, "%ld\n", fault.seen);
    return fclose(seen) == 0 ? status : NOT_RUN;
}

#else

int main(void)
{
    fprintf(stderr, "fail_calls: for Linux on x86-64 alone\n");
    return NOT_HERE;
}

#endif
