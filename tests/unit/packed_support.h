/* packed_support.h - what the tests of packed grid files share: grids of many kinds, reading from blocks of
 * exact size, and the checks that hold after every call. */
#ifndef TEST_PACKED_SUPPORT_H
#define TEST_PACKED_SUPPORT_H

#include "read_support.h"

enum { KIND_EMPTY, KIND_FULL, KIND_NOISE, KIND_SPARSE, KIND_RUNS, KIND_BLOCKS, KINDS };

static inline int kind_voxel(int kind, int32_t x, int32_t y, int32_t z, uint64_t *state)
{
    uint64_t const r = next_random(state) >> 20;

    switch (kind) {
    case KIND_EMPTY: return 0;
    case KIND_FULL: return 1;
    case KIND_NOISE: return r % 2 == 0;
    case KIND_SPARSE: return r % 50 == 0;
    case KIND_RUNS: return (x / 21 + y / 5 + z) % 2 == 0;
    default: return x >= 2 && x < 70 && y >= 1 && y < 66 && r % 40 != 0;
    }
}

static inline void grid_of(bvx_grid *g, const bvx_lattice *lattice, const bvx_window *window, int kind,
                           uint64_t seed)
{
    uint64_t state = seed * 2 + 1;
    memset(g, 0, sizeof *g);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_grid_create(ctx, lattice, window, g), bvx_last_message(ctx));
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                bvx_grid_set(g, x, y, z, kind_voxel(kind, x, y, z, &state));
}

static inline bvx_lattice lattice_of(int32_t nx, int32_t ny, int32_t nz, double origin, double sx, double sy,
                                     double sz)
{
    double const corner[3] = {origin, origin * 0.5 - 3, -origin}, spacing[3] = {sx, sy, sz};
    int32_t const dims[3] = {nx, ny, nz};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, corner, spacing, dims, &l));
    return l;
}

static inline bvx_window window_of(int32_t x, int32_t y, int32_t z, int32_t nx, int32_t ny, int32_t nz)
{
    bvx_window const w = {{x, y, z}, {nx, ny, nz}};
    return w;
}

static inline size_t grid_words(const bvx_grid *g)
{
    return (size_t)g->words_per_row * (size_t)g->size[1] * (size_t)g->size[2];
}

static inline void check_valid_grid(const bvx_grid *g)
{
    TEST_ASSERT_EQUAL_INT32((g->size[0] + 63) / 64, g->words_per_row);
    TEST_ASSERT_TRUE(g->word_capacity >= grid_words(g));
    if (g->size[0] % 64 != 0)
        for (size_t i = (size_t)g->words_per_row - 1; i < grid_words(g); i += (size_t)g->words_per_row)
            TEST_ASSERT_EQUAL_HEX64(0, g->words[i] >> g->size[0] % 64);
}

/* From a block that ends where the file ends, so that a sanitizer sees a read beyond it. */
static inline bvx_status read_packed(const void *bytes, size_t size, int32_t format, const bvx_window *window,
                                     bvx_grid *grid)
{
    static const bvx_grid empty = {0};
    uint64_t const used = bvx_memory_used(ctx);
    uint8_t *const copy = malloc(size > 0 ? size : 1);

    memset(grid, 0, sizeof *grid);
    memcpy(copy, bytes, size);
    bvx_status const status = bvx_read_grid(ctx, copy, size, format, window, grid);
    free(copy);
    if (status == BVX_OK) {
        check_valid_grid(grid);
        TEST_ASSERT_EQUAL_UINT64(used + 8 * grid_words(grid), bvx_memory_used(ctx));
    } else {
        TEST_ASSERT_EQUAL_MEMORY(&empty, grid, sizeof empty);
        TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_used(ctx));
        TEST_ASSERT_TRUE(strlen(bvx_last_message(ctx)) > 0 && strchr(bvx_last_message(ctx), '\n') == NULL);
    }
    return status;
}

static inline void check_packed_refused(const void *bytes, size_t size, int32_t format, bvx_status status,
                                        const char *words)
{
    bvx_grid g;
    bvx_status const got = read_packed(bytes, size, format, NULL, &g);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, got, got == BVX_OK ? words : bvx_last_message(ctx));
    if (strstr(bvx_last_message(ctx), words) == NULL)
        TEST_ASSERT_EQUAL_STRING_MESSAGE(words, bvx_last_message(ctx), "the message lacks these words");
}

static inline void check_same_grid(const bvx_grid *a, const bvx_grid *b)
{
    TEST_ASSERT_EQUAL_MEMORY(&a->lattice, &b->lattice, sizeof a->lattice);
    TEST_ASSERT_EQUAL_INT32_ARRAY(a->low, b->low, 3);
    TEST_ASSERT_EQUAL_INT32_ARRAY(a->size, b->size, 3);
    TEST_ASSERT_EQUAL_MEMORY(a->words, b->words, 8 * grid_words(a));
}

/* part holds what whole has in the box w, counted from whole's first voxel. */
static inline void check_crop(const bvx_grid *whole, const bvx_grid *part, const bvx_window *w)
{
    TEST_ASSERT_EQUAL_INT32_ARRAY(w->size, part->size, 3);
    for (int a = 0; a < 3; a++) TEST_ASSERT_EQUAL_INT32(whole->low[a] + w->low[a], part->low[a]);
    for (int32_t z = 0; z < w->size[2]; z++)
        for (int32_t y = 0; y < w->size[1]; y++)
            for (int32_t x = 0; x < w->size[0]; x++)
                if (bvx_grid_get(part, x, y, z) !=
                    bvx_grid_get(whole, x + w->low[0], y + w->low[1], z + w->low[2]))
                    TEST_FAIL_MESSAGE("a voxel of the window differs");
}

static inline bvx_window random_window(const int32_t size[3], uint64_t *state)
{
    bvx_window w;
    for (int a = 0; a < 3; a++) {
        w.low[a] = (int32_t)((next_random(state) >> 20) % (uint64_t)size[a]);
        w.size[a] = 1 + (int32_t)((next_random(state) >> 20) % (uint64_t)(size[a] - w.low[a]));
    }
    return w;
}

/* Random windows of a file against the grid that is in it; then windows that are not inside. */
static inline void check_windows(const bvx_buffer *file, int32_t format, const bvx_grid *whole, int count)
{
    uint64_t state = file->size * 2 + 1;
    bvx_grid part;

    for (int i = 0; i < count; i++) {
        bvx_window const w = random_window(whole->size, &state);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(
            BVX_OK, read_packed(file->bytes, (size_t)file->size, format, &w, &part), bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_MEMORY(&whole->lattice, &part.lattice, sizeof part.lattice);
        check_crop(whole, &part, &w);
        bvx_grid_free(ctx, &part);
    }
    for (int i = 0; i < 12; i++) {
        bvx_window w = window_of(0, 0, 0, 1, 1, 1);
        int const a = i % 3;
        if (i < 3) w.low[a] = whole->size[a];
        else if (i < 6) w.low[a] = -1;
        else if (i < 9) w.size[a] = whole->size[a] + 1;
        else w.low[a] = INT32_MAX, w.size[a] = INT32_MAX;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                                read_packed(file->bytes, (size_t)file->size, format, &w, &part));
    }
}

static inline bvx_context *swap_context(const bvx_context_options *o)
{
    bvx_context *const plain = ctx;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(o, &ctx));
    return plain;
}

static inline bvx_context_options plain_options(int32_t threads)
{
    bvx_context_options o = {.struct_size = sizeof o};
    o.threads = threads;
    return o;
}

/* A parallel-for that runs its pieces backwards and gives every one another worker. */
typedef struct backwards_pool {
    int32_t threads;
} backwards_pool;

static void run_backwards(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    const backwards_pool *const pool = user;
    for (int32_t i = count; i-- > 0;) task(task_user, i, (i * 7 + 3) % pool->threads);
}

/* The same bytes and the same grid for any number of workers. */
static inline void check_workers(const bvx_grid *g, int32_t format)
{
    bvx_buffer one = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, g, format, &one));
    for (int32_t threads = 1; threads <= 8; threads++) {
        backwards_pool pool = {threads};
        bvx_context_options o = plain_options(threads);
        bvx_buffer b = {0};
        bvx_grid back;
        o.parallel.call = run_backwards;
        o.parallel.user = &pool;
        bvx_context *const plain = swap_context(&o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, g, format, &b));
        TEST_ASSERT_EQUAL_UINT64(one.size, b.size);
        TEST_ASSERT_EQUAL_MEMORY(one.bytes, b.bytes, (size_t)b.size);
        bvx_buffer_free(ctx, &b);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, read_packed(one.bytes, (size_t)one.size, format, NULL, &back));
        TEST_ASSERT_EQUAL_MEMORY(g->words, back.words, 8 * grid_words(g));
        bvx_grid_free(ctx, &back);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
        bvx_context_destroy(ctx);
        ctx = plain;
    }
    bvx_buffer_free(ctx, &one);
}

/* Cancel at every progress call of reading; returns how many there were. */
static inline int check_cancelled_reading(const bvx_buffer *file, int32_t format)
{
    for (int stop = 0;; stop++) {
        bvx_context_options o = plain_options(1);
        int left = stop;
        bvx_grid g;
        o.progress.call = cancel_at;
        o.progress.user = &left;
        bvx_context *const plain = swap_context(&o);
        bvx_status const status = read_packed(file->bytes, (size_t)file->size, format, NULL, &g);
        bvx_grid_free(ctx, &g);
        bvx_context_destroy(ctx);
        ctx = plain;
        if (status == BVX_OK) return stop;
        TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, status);
    }
}

static inline int check_cancelled_writing(const bvx_grid *grid, int32_t format)
{
    for (int stop = 0;; stop++) {
        bvx_context_options o = plain_options(1);
        int left = stop;
        bvx_buffer b = {0};
        o.progress.call = cancel_at;
        o.progress.user = &left;
        bvx_context *const plain = swap_context(&o);
        bvx_status const status = bvx_write_grid(ctx, grid, format, &b);
        if (status != BVX_OK) TEST_ASSERT_TRUE(b.bytes == NULL && b.size == 0);
        bvx_buffer_free(ctx, &b);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
        bvx_context_destroy(ctx);
        ctx = plain;
        if (status == BVX_OK) return stop;
        TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, status);
    }
}

/* Memory limits below what reading and writing take are refused in words. */
static inline void check_memory_limits(const bvx_grid *grid, const bvx_buffer *file, int32_t format)
{
    bvx_status status = BVX_ERR_BUDGET;

    for (uint64_t limit = 1; status != BVX_OK; limit += limit / 8 + 1) {
        bvx_context_options o = plain_options(2);
        bvx_buffer b = {0};
        bvx_grid g;
        o.memory_limit = limit;
        bvx_context *const plain = swap_context(&o);
        bvx_status const reading = read_packed(file->bytes, (size_t)file->size, format, NULL, &g);
        bvx_grid_free(ctx, &g);
        status = bvx_write_grid(ctx, grid, format, &b);
        bvx_buffer_free(ctx, &b);
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= limit);
        TEST_ASSERT_TRUE((status == BVX_OK || status == BVX_ERR_BUDGET) &&
                         (reading == BVX_OK || reading == BVX_ERR_BUDGET));
        if (reading != BVX_OK) status = reading;
        bvx_context_destroy(ctx);
        ctx = plain;
    }
}

/* Cut at every byte: always refused, without much memory. */
static inline void check_every_cut(const bvx_buffer *file, int32_t format)
{
    bvx_grid g;
    for (size_t n = 0; n < file->size; n++) {
        bvx_memory_reset_peak(ctx);
        bvx_status const status = read_packed(file->bytes, n, format, NULL, &g);
        TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || status == BVX_ERR_UNSUPPORTED);
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= bvx_memory_used(ctx) + 16 * file->size);
    }
}

/* Into words that the caller brings: filled in place when they suffice, refused when not. */
static inline void check_own_words(const bvx_grid *grid, const bvx_buffer *file, int32_t format)
{
    size_t const n = grid_words(grid);
    uint64_t *const words = malloc(8 * n + 8);
    uint64_t const used = bvx_memory_used(ctx);
    bvx_grid g;

    for (size_t i = 0; i <= n; i++) words[i] = UINT64_C(0x5555555555555555);
    memset(&g, 0, sizeof g);
    g.words = words;
    g.word_capacity = n;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_grid(ctx, file->bytes, file->size, format, NULL, &g));
    TEST_ASSERT_TRUE(g.words == words && g.owned == 0);
    TEST_ASSERT_EQUAL_MEMORY(grid->words, words, 8 * n);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x5555555555555555), words[n]);
    TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_used(ctx));
    memset(&g, 0, sizeof g);
    g.words = words;
    g.word_capacity = n - 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_read_grid(ctx, file->bytes, file->size, format, NULL, &g));
    TEST_ASSERT_TRUE(g.words == words);
    free(words);
}

#endif
