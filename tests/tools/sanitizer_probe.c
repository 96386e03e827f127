/* sanitizer_probe.c race|clean|memory - what a sanitizer must find, and what it must not: tasks of the
 * library that write one number, tasks that write a number each, a decision by memory that nobody wrote. A
 * build that finds none of it proves nothing. */
#include "core/core.h"

#include <stdio.h>
#include <string.h>

enum { TASKS = 512, WORKERS = 1024 };

typedef struct probe {
    unsigned sum, each[TASKS];
    int race, seen[WORKERS];
} probe;

static void add_index(void *user, int32_t index, int32_t worker)
{
    probe *const p = user;
    p->seen[worker] = 1;
    p->each[index] = (unsigned)index;
    if (p->race) p->sum += (unsigned)index;
}

int main(int argc, char **argv)
{
    static probe p;
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx = NULL;
    int *block = NULL, workers = 0;

    if (argc != 2) return 2;
    o.threads = 1;
    if (bvx_context_create(&o, &ctx) != BVX_OK) return 2;
    p.race = strcmp(argv[1], "race") == 0;
    if (bvxi_parallel(ctx, "probe", 0, 1, TASKS, add_index, &p) != BVX_OK) return 2;
    for (int i = 0; i < TASKS; i++) p.sum += p.each[i];
    for (int i = 0; i < WORKERS; i++) workers += p.seen[i];
    if (bvxi_alloc(ctx, BVXI_SCRATCH, 16 * sizeof *block, "probe", &block) != BVX_OK) return 2;
    if (strcmp(argv[1], "memory") == 0 && block[3] == 7) puts("nobody wrote it");
    bvxi_free(ctx, block, 16 * sizeof *block);
    bvx_context_destroy(ctx);
    printf("%d workers, %u\n", workers, p.sum);
    return 0;
}
