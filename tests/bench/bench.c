/* bench.c - clock, times, warm memory and files of the measuring programs. */
#define _POSIX_C_SOURCE 200809L
#include "bench.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

/* ---- times ---- */

double bench_clock(int threads)
{
    struct timespec t;
    clock_gettime(threads == 1 ? CLOCK_THREAD_CPUTIME_ID : CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e3 + (double)t.tv_nsec * 1e-6;
}

void bench_add(bench_times *times, double ms)
{
    if (times->count < BENCH_MOST_RUNS) times->ms[times->count++] = ms;
}

double bench_min(const bench_times *times)
{
    double least = times->count ? times->ms[0] : 0.0;
    for (int i = 1; i < times->count; i++)
        if (times->ms[i] < least) least = times->ms[i];
    return least;
}

static int compare_times(const void *a, const void *b)
{
    double const x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

double bench_median(const bench_times *times)
{
    double sorted[BENCH_MOST_RUNS];
    int const n = times->count;
    if (n == 0) return 0.0;
    memcpy(sorted, times->ms, (size_t)n * sizeof *sorted);
    qsort(sorted, (size_t)n, sizeof *sorted, compare_times);
    return n % 2 ? sorted[n / 2] : 0.5 * (sorted[n / 2 - 1] + sorted[n / 2]);
}

/* ---- memory ---- */

/* A kept block is taken when it is at most twice too large: large ones are not spent on small requests. */
void *bench_alloc(void *user, size_t size, size_t align)
{
    bench_memory *const m = user;
    int best = -1, empty = -1;

    (void)align; /* at most 64, which every block has */
    for (int i = 0; i < BENCH_BLOCKS; i++) {
        if (m->block[i].bytes == NULL) {
            if (empty < 0) empty = i;
        } else if (!m->block[i].used && m->block[i].room >= size && m->block[i].room / 2 <= size + 2048 &&
                   (best < 0 || m->block[i].room < m->block[best].room)) {
            best = i;
        }
    }
    if (best < 0) {
        if (empty < 0) return NULL;
        best = empty;
        m->block[best].room = (size / 64 + 1) * 64;
        if (posix_memalign(&m->block[best].bytes, 64, m->block[best].room) != 0)
            return m->block[best].bytes = NULL;
    }
    m->block[best].used = 1;
    m->block[best].asked = size;
    m->live += size;
    if (m->live > m->peak) m->peak = m->live;
    return m->block[best].bytes;
}

void bench_free(void *user, void *block, size_t size, size_t align)
{
    bench_memory *const m = user;

    (void)align;
    if (block == NULL) return;
    for (int i = 0; i < BENCH_BLOCKS; i++) {
        if (m->block[i].bytes != block) continue;
        if (!m->block[i].used || m->block[i].asked != size) break;
        m->block[i].used = 0;
        m->live -= size;
        return;
    }
    fprintf(stderr, "bench: a block came back that was not given so\n");
    exit(1);
}

void bench_memory_release(bench_memory *m)
{
    for (int i = 0; i < BENCH_BLOCKS; i++) free(m->block[i].bytes);
    memset(m, 0, sizeof *m);
}

bvx_context *bench_context(int threads, int cpu, bench_memory *memory)
{
    bvx_context *ctx = NULL;
    bvx_context_options o = {.struct_size = sizeof o};

    o.threads = threads;
    o.cpu = cpu;
    if (memory != NULL) {
        o.allocator.alloc = bench_alloc;
        o.allocator.free = bench_free;
        o.allocator.user = memory;
    }
    bvx_status const status = bvx_context_create(&o, &ctx);
    if (status != BVX_OK) {
        fprintf(stderr, "bench: no context: %s\n", bvx_status_text(status));
        exit(1);
    }
    return ctx;
}

/* ---- the main job ---- */

const int32_t bench_resolutions[BENCH_LEVELS] = {64, 32, 16, 8};

void bench_main_job(bvx_context *ctx, const bvx_mesh_view *view, uint64_t level_count, bvx_mesh *levels,
                    bvx_lod_report *reports)
{
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_lod_options options = {.struct_size = sizeof options};

    options.resolutions = bench_resolutions;
    options.reports = reports;
    bench_try(ctx, bvx_lattice_fit(ctx, view, BENCH_MAIN, &lattice), "lattice");
    bench_try(ctx, bvx_voxelize_solid(ctx, view, &lattice, NULL, &solid), "solid");
    bench_try(ctx, bvx_build_lods(ctx, &solid, &options, level_count, levels), "levels");
    bvx_grid_free(ctx, &solid);
}

/* ---- checks ---- */

void bench_try(const bvx_context *ctx, bvx_status status, const char *what)
{
    if (status == BVX_OK) return;
    fprintf(stderr, "bench: %s: %s\n", what, ctx ? bvx_last_message(ctx) : bvx_status_text(status));
    exit(1);
}

/* ---- files ---- */

static int ends_in(const char *text, const char *end)
{
    size_t const n = strlen(text), k = strlen(end);
    return n >= k && strcmp(text + n - k, end) == 0;
}

uint8_t *bench_read_file(const char *path, size_t *size)
{
    char command[1200];
    size_t room = (size_t)1 << 20, n = 0, got;
    int const zipped = ends_in(path, ".gz");
    FILE *file = fopen(path, "rb");
    uint8_t *bytes = NULL;

    if (file == NULL) return NULL;
    if (zipped) {
        fclose(file);
        if (strlen(path) > 1000 || strchr(path, '\'')) return NULL;
        snprintf(command, sizeof command, "gzip -dc '%s'", path);
        file = popen(command, "r");
        if (file == NULL) return NULL;
    }
    for (;;) {
        uint8_t *const more = realloc(bytes, room);
        if (more == NULL) exit(1);
        bytes = more;
        got = fread(bytes + n, 1, room - n, file);
        n += got;
        if (got == 0) break;
        if (n == room) room *= 2;
    }
    if (zipped) pclose(file);
    else fclose(file);
    *size = n;
    return bytes;
}

int bench_read_mesh(bvx_context *ctx, const char *path, bvx_mesh *mesh)
{
    size_t size;
    uint8_t *const bytes = bench_read_file(path, &size);
    memset(mesh, 0, sizeof *mesh);
    if (bytes == NULL) return 0;
    bench_try(ctx, bvx_read_mesh(ctx, bytes, size, bvx_format_of_name(path), NULL, mesh), path);
    free(bytes);
    return 1;
}

FILE *bench_open(const char *path)
{
    FILE *const file = fopen(path, "wb");
    if (file == NULL) {
        fprintf(stderr, "bench: cannot write %s\n", path);
        exit(1);
    }
    return file;
}

void bench_write_mesh(bvx_context *ctx, const char *path, const bvx_mesh *mesh)
{
    bvx_buffer buffer = {0};

    bench_try(ctx, bvx_write_mesh(ctx, mesh, 1, NULL, bvx_format_of_name(path), &buffer), path);
    FILE *const file = bench_open(path);
    int const ok = fwrite(buffer.bytes, 1, (size_t)buffer.size, file) == buffer.size;
    if (fclose(file) != 0 || !ok) {
        fprintf(stderr, "bench: cannot write %s\n", path);
        exit(1);
    }
    bvx_buffer_free(ctx, &buffer);
}
