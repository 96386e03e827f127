/* bench.h - what the measuring programs share: a clock, times, warm memory, meshes from files. */
#ifndef BENCH_H
#define BENCH_H

#include "bitvox_io.h"

#include <stdio.h>

/* ---- times ---- */

/* [Units: ms] One thread: its processor time, so that others on the machine
 * count little; more: the time of day. */
double bench_clock(int threads);

enum { BENCH_MOST_RUNS = 1024 };

/* The times of one piece of work. */
typedef struct bench_times {
    double ms[BENCH_MOST_RUNS];
    int count;
} bench_times;

void bench_add(bench_times *times, double ms);
double bench_min(const bench_times *times);
double bench_median(const bench_times *times);

/* ---- memory ---- */

enum { BENCH_BLOCKS = 2048 };

/* Keeps what was freed and hands it out again, so that no page is touched
 * for the first time while the clock runs. */
typedef struct bench_memory {
    struct {
        void *bytes;
        size_t room, asked;
        int used;
    } block[BENCH_BLOCKS];
    uint64_t live, peak; /* bytes requested */
} bench_memory;

void *bench_alloc(void *memory, size_t size, size_t align);
void bench_free(void *memory, void *block, size_t size, size_t align);
void bench_memory_release(bench_memory *memory);

/* A context on such memory (NULL: the C library's heap); ends the program when there is none. */
bvx_context *bench_context(int threads, int cpu, bench_memory *memory);

/* ---- the main job ---- */

/* resolutions of the solids; levels of the main job */
enum { BENCH_FINE = 512, BENCH_MAIN = 256, BENCH_LEVELS = 4 };
extern const int32_t bench_resolutions[BENCH_LEVELS];

/* From the mesh's arrays to the arrays of the first level_count levels. */
void bench_main_job(bvx_context *ctx, const bvx_mesh_view *view, uint64_t level_count, bvx_mesh *levels,
                    bvx_lod_report *reports);

/* ---- checks ---- */

/* End the program when a call failed. */
void bench_try(const bvx_context *ctx, bvx_status status, const char *what);

/* ---- files ---- */

/* The bytes of a file; a name that ends in .gz goes through gzip. NULL when it cannot be read. */
uint8_t *bench_read_file(const char *path, size_t *size);
/* 0 when there is no such file; what is in it but no mesh ends the program. */
int bench_read_mesh(bvx_context *ctx, const char *path, bvx_mesh *mesh);
void bench_write_mesh(bvx_context *ctx, const char *path, const bvx_mesh *mesh);
FILE *bench_open(const char *path);

#endif
