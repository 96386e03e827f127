/* test_grid_files.c - every reader and writer of grid files with every allocation failing once, cancelled at
 * every progress call, under every memory limit, and in an arena. After each failure results are empty,
 * nothing is held, and the same context does the work. */
#include "fault/context.h"

/* Wide enough for several columns of words, deep enough for several pieces; each is one file of a format. */
static bvx_lattice lattice = {{1, -2, 3}, {0.5, 0.5, 0.5}, {250, 70, 60}, 16};
static bvx_grid solid;

enum { READ, WRITE, WRITE_HEAD, WRITE_SLICES, READ_LATTICE, WRITE_LATTICE };

typedef struct action {
    const char *name;
    int does;
    int32_t format;
    uint64_t allocations; /* at least */
    uint64_t calls;       /* of progress, at least */
} action;

static const action actions[] = {
    {"read NPY", READ, BVX_FORMAT_NPY, 1, 2},       {"write NPY", WRITE, BVX_FORMAT_NPY, 1, 2},
    {"read BINVOX", READ, BVX_FORMAT_BINVOX, 2, 4}, {"write BINVOX", WRITE, BVX_FORMAT_BINVOX, 3, 8},
    {"read VOX", READ, BVX_FORMAT_VOX, 1, 1},       {"write VOX", WRITE, BVX_FORMAT_VOX, 1, 1},
    {"read NRRD", READ, BVX_FORMAT_NRRD, 1, 2},     {"write NRRD", WRITE, BVX_FORMAT_NRRD, 1, 2},
    {"read VTI", READ, BVX_FORMAT_VTI, 1, 2},       {"write VTI", WRITE, BVX_FORMAT_VTI, 1, 2},
    {"read BVX", READ, BVX_FORMAT_BVX, 2, 4},       {"write BVX", WRITE, BVX_FORMAT_BVX, 2, 4},
    {"write a BVX head", WRITE_HEAD, 0, 1, 0},      {"write BVX slices", WRITE_SLICES, 0, 2, 4},
    {"read a lattice", READ_LATTICE, 0, 0, 0},      {"write a lattice", WRITE_LATTICE, 0, 1, 0},
};
enum { ACTIONS = sizeof actions / sizeof actions[0] };

static bvx_buffer files[BVX_FORMAT_BVX + 1], lattice_file;
static bvx_context *maker; /* what made them */

static bvx_status write_by(bvx_context *ctx, const action *a, bvx_buffer *file)
{
    switch (a->does) {
    case WRITE_HEAD: return bvx_write_head(ctx, &lattice, NULL, file);
    case WRITE_SLICES: return bvx_write_slices(ctx, &solid, file);
    case WRITE_LATTICE: return bvx_write_lattice(ctx, &solid, file);
    default: return bvx_write_grid(ctx, &solid, a->format, file);
    }
}

/* A ball with pores; the files that readers get, made with the C library's heap. */
static int make_files(void **state)
{
    uint64_t noise = 88172645463325252u;

    (void)state;
    maker = context_with(NULL);
    assert_int_equal(bvx_grid_create(maker, &lattice, NULL, &solid), BVX_OK);
    for (int32_t z = 0; z < 60; z++)
        for (int32_t y = 0; y < 70; y++)
            for (int32_t x = 0; x < 250; x++) {
                int32_t const d = (x - 125) * (x - 125) / 16 + (y - 35) * (y - 35) + (z - 30) * (z - 30);
                noise ^= noise << 13;
                noise ^= noise >> 7;
                noise ^= noise << 17;
                bvx_grid_set(&solid, x, y, z, d < 800 && (z != 20 || (noise >> 40 & 1) != 0));
            }
    for (int i = 0; i < ACTIONS; i++)
        if (actions[i].does == WRITE)
            assert_int_equal(write_by(maker, &actions[i], &files[actions[i].format]), BVX_OK);
    assert_int_equal(bvx_write_lattice(maker, &solid, &lattice_file), BVX_OK);
    return 0;
}

static int free_files(void **state)
{
    (void)state;
    for (int32_t i = 0; i <= BVX_FORMAT_BVX; i++) bvx_buffer_free(maker, &files[i]);
    bvx_buffer_free(maker, &lattice_file);
    bvx_grid_free(maker, &solid);
    bvx_context_destroy(maker);
    return 0;
}

/* One action, and what its result must hash to once a first run has set it. */
typedef struct working {
    const action *of;
    uint64_t hash;
    int left_behind, other;
} working;

static void note_hash(working *w, uint64_t hash)
{
    if (w->hash == 0) w->hash = hash;
    w->other |= hash != w->hash;
}

static bvx_status run_reading(working *w, bvx_context *ctx)
{
    static const bvx_grid empty = {0};
    const bvx_buffer *const file = &files[w->of->format];
    bvx_grid g = {0};
    uint64_t hash = 0;
    bvx_status const status = bvx_read_grid(ctx, file->bytes, file->size, w->of->format, NULL, &g);

    if (status == BVX_OK) {
        assert_int_equal(bvx_grid_hash(ctx, &g, &hash), BVX_OK);
        assert_memory_equal(g.words, solid.words,
                            8 * (size_t)g.size[1] * (size_t)g.size[2] * (size_t)g.words_per_row);
        note_hash(w, hash);
        bvx_grid_free(ctx, &g);
    } else w->left_behind |= memcmp(&g, &empty, sizeof g) != 0;
    return status;
}

static bvx_status run_action(void *user, bvx_context *ctx)
{
    working *const w = user;
    bvx_buffer file = {0};
    bvx_status status;

    if (w->of->does == READ) return run_reading(w, ctx);
    if (w->of->does == READ_LATTICE) {
        bvx_grid g = solid;
        status = bvx_read_lattice(ctx, lattice_file.bytes, lattice_file.size, &g);
        if (status == BVX_OK) note_hash(w, bvx_hash(&g.lattice, sizeof g.lattice, 0));
        else w->left_behind |= memcmp(&g, &solid, sizeof g) != 0;
        return status;
    }
    status = write_by(ctx, w->of, &file);
    if (status == BVX_OK) {
        note_hash(w, bvx_hash(file.bytes, (size_t)file.size, 0));
        bvx_buffer_free(ctx, &file);
    } else w->left_behind |= file.bytes != NULL || file.size != 0 || file.capacity != 0;
    return status;
}

static working start(int i, const bvx_context_options *o)
{
    working w = {NULL, 0, 0, 0};
    bvx_context *const ctx = context_with(o);
    w.of = &actions[i];
    if (run_action(&w, ctx) != BVX_OK) fail_msg("%s: %s", w.of->name, bvx_last_message(ctx));
    bvx_context_destroy(ctx);
    return w;
}

static void assert_working(const working *w, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", w->of->name, wrong);
    if (w->left_behind) fail_msg("%s: a failed call left something in its result", w->of->name);
    if (w->other) fail_msg("%s: another result than usual", w->of->name);
}

static void test_every_allocation_of_grid_files_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < ACTIONS; i++) {
            bvx_context_options o = default_options();
            uint64_t allocations = 0;
            o.threads = threads;
            working w = start(i, &o);
            assert_working(&w, fault_every_allocation(run_action, &w, &o, &allocations));
            if (allocations < actions[i].allocations)
                fail_msg("%s: %lu allocations", actions[i].name, (unsigned long)allocations);
        }
}

static void test_cancel_grid_files_at_every_progress_call(void **state)
{
    (void)state;
    for (int i = 0; i < ACTIONS; i++) {
        bvx_context_options o = default_options();
        uint64_t calls = 0;
        o.threads = 1;
        working w = start(i, &o);
        assert_working(&w, fault_every_cancel(run_action, &w, &o, &calls));
        if (calls < actions[i].calls)
            fail_msg("%s: %lu progress calls", actions[i].name, (unsigned long)calls);
    }
}

static void test_grid_files_under_memory_limits(void **state)
{
    (void)state;
    for (int i = 0; i < ACTIONS; i++) {
        bvx_context_options o = default_options();
        bvx_status status = BVX_ERR_BUDGET;
        o.threads = 2;
        working w = start(i, &o);
        for (uint64_t limit = 1; status != BVX_OK; limit += limit / 16 + 1) {
            o.memory_limit = limit;
            bvx_context *const ctx = context_with(&o);
            status = run_action(&w, ctx);
            assert_true(status == BVX_OK || status == BVX_ERR_BUDGET);
            assert_true(bvx_memory_peak(ctx) <= limit);
            assert_int_equal(bvx_memory_used(ctx), 0);
            bvx_context_destroy(ctx);
        }
        assert_working(&w, NULL);
    }
}

static void test_grid_files_in_arenas(void **state)
{
    enum { ARENA = 4 << 20 };
    unsigned char *const memory = malloc(ARENA);
    (void)state;
    assert_non_null(memory);
    for (int i = 0; i < ACTIONS; i++) {
        bvx_context_options o = default_options();
        o.threads = 2;
        working w = start(i, &o);
        o.arena.memory = memory;
        for (uint64_t size = ARENA; size > 4096; size -= size / 5) {
            o.arena.size = size;
            bvx_context *const ctx = context_with(&o);
            for (int again = 0; again < 2; again++) {
                bvx_status const status = run_action(&w, ctx);
                assert_true(status == BVX_OK || (size < ARENA && status == BVX_ERR_MEMORY));
                assert_int_equal(bvx_memory_used(ctx), 0);
            }
            bvx_context_destroy(ctx);
        }
        assert_working(&w, NULL);
    }
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_grid_files_fails_once),
        cmocka_unit_test(test_cancel_grid_files_at_every_progress_call),
        cmocka_unit_test(test_grid_files_under_memory_limits),
        cmocka_unit_test(test_grid_files_in_arenas),
    };
    return cmocka_run_group_tests(tests, make_files, free_files);
}
