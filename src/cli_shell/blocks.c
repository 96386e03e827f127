/* blocks.c - the memory of a run: large blocks ask for huge pages.
 *
 * They are touched for the first time in a fraction of the time, and what matters more to somebody who
 * presses Ctrl-C: the system takes a gigabyte of them back in milliseconds, where small pages need a fifth of
 * a second. */
#if defined(__linux__)
#define _DEFAULT_SOURCE
#define _POSIX_C_SOURCE 200809L
#include <sys/mman.h>
#include <unistd.h>
#endif

#include "cli_shell/shell.h"

#include <stdlib.h>

enum { BLOCK_LARGE = 4 << 20 };

void cli_large_block(void *block, size_t size)
{
#if defined(__linux__) && defined(MADV_HUGEPAGE)
    long const page = sysconf(_SC_PAGESIZE);
    /* outwards to whole pages: a mapping that is advised as a whole can still grow in its place */
    size_t before;
    if (block == NULL || size < BLOCK_LARGE || page <= 0) return;
    before = (uintptr_t)block % (size_t)page;
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

void cli_blocks_offer(bvx_context_options *options)
{
    options->alloc = take_block;
    options->free = give_block;
}

#else

void cli_blocks_offer(bvx_context_options *options)
{
    (void)options; /* the library's own */
}

#endif
