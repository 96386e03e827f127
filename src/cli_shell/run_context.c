/* run_context.c - the context of a run and its memory: how much there is, and large blocks of it.
 *
 * Large blocks ask for huge pages. They are touched for the first time in a fraction of the time, and what
 * matters more to somebody who presses Ctrl-C: the system takes a gigabyte of them back in milliseconds,
 * where small pages need a fifth of a second. */
#if defined(__linux__)
#define _DEFAULT_SOURCE
#endif
#if defined(__unix__) || defined(__APPLE__)
#define _POSIX_C_SOURCE 200809L
#define RUN_POSIX       1
#else
#define RUN_POSIX 0
#endif

#include "cli_shell/shell.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#if defined(__linux__)
#include <sys/mman.h>
#endif
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
    FILE *const container = fopen("/sys/fs/cgroup/memory.max", "r"); /* a number, or "max" */
    struct rlimit space;
#if defined(_SC_PHYS_PAGES)
    long const pages = sysconf(_SC_PHYS_PAGES), page = sysconf(_SC_PAGESIZE);
    if (pages > 0 && page > 0) memory = (uint64_t)pages * (uint64_t)page;
#endif
    /* The least of what the machine, the shell and the container allow. */
    if (getrlimit(RLIMIT_AS, &space) == 0 && space.rlim_cur != RLIM_INFINITY && space.rlim_cur < memory)
        memory = (uint64_t)space.rlim_cur;
    if (container != NULL) {
        uint64_t most;

        if (fscanf(container, "%" SCNu64, &most) == 1 && most < memory) memory = most;
        fclose(container);
    }
#elif defined(_WIN32)
    MEMORYSTATUSEX now;
    now.dwLength = sizeof now;
    if (GlobalMemoryStatusEx(&now)) memory = now.ullTotalPhys;
#endif
    return memory != UINT64_MAX ? memory : 0;
}

enum { BLOCK_LARGE = 4 << 20 };

void cli_large_block(void *block, size_t size)
{
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    long const page = sysconf(_SC_PAGESIZE);
    /* outwards to whole pages: a mapping that is advised as a whole can still grow in its place */
    if (block == NULL || size < BLOCK_LARGE || page <= 0) return;
    size_t before = (uintptr_t)block % (size_t)page;
    size = (size + before + (size_t)page - 1) / (size_t)page * (size_t)page;
    (void)madvise((char *)block - before, size, MADV_HUGEPAGE); /* a wish */
#else
    (void)block;
    (void)size;
#endif
}

#if defined(__linux__)

static void *take_block(void *user, size_t size, size_t align)
{
    void *block = NULL;
    (void)user;
    if (align < sizeof(void *)) align = sizeof(void *);
    if (posix_memalign(&block, align, size != 0 ? size : 1) != 0) return NULL;
    cli_large_block(block, size);
    return block;
}

static void give_block(void *user, void *block, size_t size, size_t align)
{
    (void)user;
    (void)size;
    (void)align;
    free(block);
}

static void offer_blocks(bvx_context_options *options)
{
    options->allocator.alloc = take_block;
    options->allocator.free = give_block;
}

#else

static void offer_blocks(bvx_context_options *options)
{
    (void)options; /* the library's own */
}

#endif

int cli_make_context(cli_run *run, uint64_t file_bytes)
{
    uint64_t const memory = run->general->memory_limit != 0 ? run->general->memory_limit : cli_memory_there();

    if (run->context != NULL) return CLI_DONE;
    bvx_context_options o = {.struct_size = sizeof o, .threads = run->general->threads};
    offer_blocks(&o);
    o.progress.call = cli_progress;
    o.progress.user = run;
    /* The file in memory counts against the same limit. */
    if (memory != 0) o.memory_limit = memory > file_bytes ? memory - file_bytes : 1;
    /* choices do not depend on the machine */
    run->context_limit = run->general->memory_limit != 0 ? o.memory_limit : 0;
    bvx_status status = bvx_context_create(&o, &run->context);
    /* Without a context there is no message but this one. */
    const char *const fault = status != BVX_OK ? bvx_context_fault(BVX_VERSION, &o) : NULL;
    if (status != BVX_OK) return cli_fail(run, "%s", fault != NULL ? fault : bvx_status_text(status));
    return CLI_DONE;
}
