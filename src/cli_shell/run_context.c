/* run_context.c - the context of a run: threads, memory, progress. */
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define RUN_POSIX       1
#else
#define RUN_POSIX 0
#endif

#include "cli_shell/shell.h"

#include <inttypes.h>
#include <stdio.h>
#if RUN_POSIX
#include <sys/resource.h>
#include <unistd.h>
#elif defined(_WIN32)
#include <windows.h>
#endif

uint64_t cli_memory_there(void)
{
    uint64_t memory = UINT64_MAX;

#if RUN_POSIX
    /* a number, or "max" */
    static const char *const container[2] = {"/sys/fs/cgroup/memory.max",
                                             "/sys/fs/cgroup/memory/memory.limit_in_bytes"};
    struct rlimit space;
#if defined(_SC_PHYS_PAGES)
    long const pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0) memory = (uint64_t)pages * (uint64_t)page;
#endif
    /* The least of what the machine, the shell and the container allow. */
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY && space.rlim_cur < memory)
        memory = (uint64_t)space.rlim_cur;
    for (int i = 0; i < 2; i++) {
        uint64_t most;
        FILE *const file = fopen(container[i], "r");
        if (file == NULL) continue;
        if (fscanf(file, "%" SCNu64, &most) == 1 && most < memory) memory = most;
        fclose(file);
    }
#elif defined(_WIN32)
    MEMORYSTATUSEX now;
    now.dwLength = sizeof now;
    if (GlobalMemoryStatusEx(&now)) memory = now.ullTotalPhys;
#endif
    return memory != UINT64_MAX ? memory : 0;
}

int cli_make_context(cli_run *run, uint64_t file_bytes)
{
    uint64_t const memory = run->general->memory_limit != 0 ? run->general->memory_limit : cli_memory_there();
    bvx_context_options o;
    const char *fault;
    bvx_status status;

    bvx_context_options_init(&o, sizeof o);
    o.threads = run->general->threads;
    cli_blocks_offer(&o);
    o.progress = cli_progress;
    o.progress_user = run;
    /* The file in memory counts against the same limit. */
    if (memory != 0) o.memory_limit = memory > file_bytes ? memory - file_bytes : 1;
    /* choices do not depend on the machine */
    run->context_limit = run->general->memory_limit != 0 ? o.memory_limit : 0;
    status = bvx_context_create(&o, &run->context);
    if (status == BVX_OK) return CLI_DONE;

    /* Without a context there is no message but this one. */
    fault = bvx_context_fault(BVX_VERSION, &o);
    return cli_fail(run, "%s", fault != NULL ? fault : bvx_status_text(status));
}
