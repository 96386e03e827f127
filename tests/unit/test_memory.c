/* test_memory.c - limit, counts and the two-ended arena. */
#include "core/core.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"

#include "unity.h"

void setUp(void)
{
}
void tearDown(void)
{
}

static bvx_context_options default_options(void)
{
    bvx_context_options o = {.struct_size = sizeof o};
    return o;
}

static bvx_context *context_with(const bvx_context_options *options)
{
    bvx_context *ctx = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(options, &ctx));
    TEST_ASSERT_NOT_NULL(ctx);
    return ctx;
}

static void *get(bvx_context *ctx, int kind, uint64_t size)
{
    void *block = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, kind, size, "a test's block", &block));
    TEST_ASSERT_NOT_NULL(block);
    TEST_ASSERT_EQUAL_UINT64(0, (uintptr_t)block % BVXI_ALIGN);
    memset(block, 0x5A, (size_t)size);
    return block;
}

/* ---- Memory ---- */

static void test_used_and_peak_are_counted(void)
{
    fault_heap heap = {0};
    bvx_context_options const o = fault_options(NULL, &heap);
    bvx_context *const ctx = context_with(&o);
    void *a, *b;

    TEST_ASSERT_EQUAL_INT64(0, bvx_memory_used(ctx));
    TEST_ASSERT_EQUAL_INT64(0, bvx_memory_peak(ctx));
    a = get(ctx, BVXI_RESULT, 1000);
    b = get(ctx, BVXI_SCRATCH, 500);
    TEST_ASSERT_EQUAL_INT64(1500, bvx_memory_used(ctx));
    bvxi_free(ctx, b, 500);
    TEST_ASSERT_EQUAL_INT64(1000, bvx_memory_used(ctx));
    TEST_ASSERT_EQUAL_INT64(1500, bvx_memory_peak(ctx));
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT64(1000, bvx_memory_peak(ctx));
    bvxi_free(ctx, NULL, 77);
    TEST_ASSERT_EQUAL_INT64(1000, bvx_memory_used(ctx));
    bvxi_free(ctx, a, 1000);
    TEST_ASSERT_EQUAL_INT64(0, bvx_memory_used(ctx));
    TEST_ASSERT_EQUAL_INT64(1000, bvx_memory_peak(ctx));
    bvx_context_destroy(ctx);
    TEST_ASSERT_NULL(fault_end(&heap));
}

static void test_blocks_of_no_bytes_are_blocks(void)
{
    fault_heap heap = {0};
    bvx_context_options const o = fault_options(NULL, &heap);
    bvx_context *const ctx = context_with(&o);
    void *const a = get(ctx, BVXI_RESULT, 0), *const b = get(ctx, BVXI_SCRATCH, 0);

    TEST_ASSERT_TRUE(a != b);
    bvxi_free(ctx, a, 0);
    bvxi_free(ctx, b, 0);
    TEST_ASSERT_EQUAL_INT64(0, bvx_memory_used(ctx));
    bvx_context_destroy(ctx);
    TEST_ASSERT_NULL(fault_end(&heap));
}

static void test_limit_refuses_with_a_message(void)
{
    bvx_context_options o = default_options();
    bvx_context *ctx;
    void *a, *none = NULL;

    o.memory_limit = 1000;
    ctx = context_with(&o);
    a = get(ctx, BVXI_RESULT, 600);
    TEST_ASSERT_EQUAL_INT64(BVX_ERR_BUDGET, bvxi_alloc(ctx, BVXI_SCRATCH, 401, "the row table", &none));
    TEST_ASSERT_EQUAL_STRING("the row table would take 401 bytes; 600 are in use and the limit is 1000",
                             bvx_last_message(ctx));
    TEST_ASSERT_NULL(none);
    TEST_ASSERT_EQUAL_INT64(BVX_ERR_BUDGET,
                            bvxi_alloc(ctx, BVXI_SCRATCH, UINT64_MAX, "the row table", &none));
    TEST_ASSERT_EQUAL_INT64(600, bvx_memory_used(ctx));
    TEST_ASSERT_EQUAL_INT64(600, bvx_memory_peak(ctx));
    bvxi_free(ctx, get(ctx, BVXI_SCRATCH, 400), 400); /* the last byte may be used */
    bvxi_free(ctx, a, 600);
    bvx_context_destroy(ctx);
}

static void test_sizes_beyond_the_machine_are_refused(void)
{
    bvx_context *const ctx = context_with(NULL);
    void *none = NULL;

    for (uint64_t back = 0; back < 200; back++) {
        bvx_status const status = bvxi_alloc(ctx, BVXI_RESULT, UINT64_MAX - back, "a block", &none);
        int const beyond = UINT64_MAX - back > SIZE_MAX - BVXI_ALIGN; /* always so where size_t has 32 bits */
        TEST_ASSERT_EQUAL_INT32(beyond ? BVX_ERR_BUDGET : BVX_ERR_MEMORY, status);
        TEST_ASSERT_NULL(none);
        TEST_ASSERT_EQUAL_INT64(0, bvx_memory_used(ctx));
    }
    bvx_context_destroy(ctx);
}

/* ---- Arena ---- */

enum { ARENA_BYTES = 16384, ARENA_ROOM = ARENA_BYTES + 256 };

typedef struct arena_room {
    unsigned char bytes[ARENA_ROOM];
    unsigned char *start;
    size_t size;
} arena_room;

static bvx_status arena_context(arena_room *room, size_t shift, size_t size, bvx_context **ctx)
{
    bvx_context_options o = default_options();
    memset(room->bytes, 0xEE, sizeof room->bytes);
    room->start = room->bytes + 64 + shift;
    room->size = size;
    o.arena.memory = room->start;
    o.arena.size = size;
    return bvx_context_create(&o, ctx);
}

static void arena_kept_inside(const arena_room *room)
{
    const unsigned char *const end = room->start + room->size;
    for (const unsigned char *p = room->bytes; p < room->start; p++) TEST_ASSERT_EQUAL_INT64(0xEE, *p);
    for (const unsigned char *p = end; p < room->bytes + ARENA_ROOM; p++) TEST_ASSERT_EQUAL_INT64(0xEE, *p);
}

static uint64_t largest_block(bvx_context *ctx, int kind)
{
    uint64_t low = 0, high = ARENA_ROOM; /* low fits, high does not */

    while (high - low > 1) {
        uint64_t const middle = (low + high) / 2;
        void *block = NULL;
        if (bvxi_alloc(ctx, kind, middle, "a block", &block) == BVX_OK) {
            bvxi_free(ctx, block, middle);
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

static void test_arena_gives_results_low_and_scratch_high(void)
{
    static arena_room room;
    bvx_context *ctx = NULL;
    unsigned char *r[3], *s[3];

    TEST_ASSERT_EQUAL_INT64(BVX_OK, arena_context(&room, 0, ARENA_BYTES, &ctx));
    for (int i = 0; i < 3; i++) {
        r[i] = get(ctx, BVXI_RESULT, 100);
        s[i] = get(ctx, BVXI_SCRATCH, 200);
    }
    for (int i = 1; i < 3; i++) {
        TEST_ASSERT_TRUE(r[i] >= r[i - 1] + 100);
        TEST_ASSERT_TRUE(s[i] + 200 <= s[i - 1]);
    }
    TEST_ASSERT_TRUE(r[2] + 100 <= s[2]);
    TEST_ASSERT_TRUE(r[0] > room.start && s[0] + 200 <= room.start + room.size);
    TEST_ASSERT_EQUAL_INT64(900, bvx_memory_used(ctx));
    bvx_context_destroy(ctx);
    arena_kept_inside(&room);
}

/* All orders of freeing n blocks, by Heap's algorithm without recursion. */
static int next_order(int *order, int *counter, int n)
{
    int i = 1;

    while (i < n && counter[i] >= i) counter[i++] = 0;
    if (i >= n) return 0;
    {
        int const k = i % 2 == 0 ? 0 : counter[i];
        int const t = order[i];
        order[i] = order[k];
        order[k] = t;
    }
    counter[i]++;
    return 1;
}

static void test_arena_is_empty_after_any_order_of_freeing(void)
{
    static arena_room room;
    static const uint64_t sizes[6] = {1, 64, 65, 700, 0, 128};
    int order[6] = {0, 1, 2, 3, 4, 5}, counter[6] = {0}, orders = 0;
    bvx_context *ctx = NULL;
    uint64_t free_result, free_scratch;

    TEST_ASSERT_EQUAL_INT64(BVX_OK, arena_context(&room, 0, ARENA_BYTES, &ctx));
    free_result = largest_block(ctx, BVXI_RESULT);
    free_scratch = largest_block(ctx, BVXI_SCRATCH);
    TEST_ASSERT_TRUE(free_result > ARENA_BYTES / 2 && free_scratch > ARENA_BYTES / 2);
    do {
        unsigned char *block[6];
        for (int i = 0; i < 6; i++) {
            block[i] = get(ctx, i % 2 == 0 ? BVXI_RESULT : BVXI_SCRATCH, sizes[i]);
            memset(block[i], i + 1, (size_t)sizes[i]);
        }
        for (int i = 0; i < 6; i++) {
            int const b = order[i];
            for (size_t k = 0; k < sizes[b]; k++) TEST_ASSERT_EQUAL_INT64(b + 1, block[b][k]);
            bvxi_free(ctx, block[b], sizes[b]);
        }
        TEST_ASSERT_EQUAL_INT64(0, bvx_memory_used(ctx));
        { /* one block over all that was free before */
            void *const all = get(ctx, orders % 2 == 0 ? BVXI_RESULT : BVXI_SCRATCH,
                                  orders % 2 == 0 ? free_result : free_scratch);
            bvxi_free(ctx, all, orders % 2 == 0 ? free_result : free_scratch);
        }
        orders++;
    } while (next_order(order, counter, 6));
    TEST_ASSERT_EQUAL_INT64(720, orders);
    bvx_context_destroy(ctx);
    arena_kept_inside(&room);
}

static void test_arena_reuses_its_ends_under_mixed_work(void)
{
    static arena_room room;

    enum { SLOTS = 24, ROUNDS = 20000 };
    static struct {
        unsigned char *block;
        uint64_t size;
        unsigned char mark;
    } slot[SLOTS];
    bvx_context *ctx = NULL;
    uint32_t random = 1, given = 0, refused = 0;
    uint64_t used = 0, whole;
    memset(slot, 0, sizeof slot);
    TEST_ASSERT_EQUAL_INT64(BVX_OK, arena_context(&room, 0, ARENA_BYTES, &ctx));
    whole = largest_block(ctx, BVXI_RESULT);
    for (int round = 0; round < ROUNDS + SLOTS; round++) {
        size_t const i = round < ROUNDS ? (random >> 8) % SLOTS : (size_t)(round - ROUNDS);
        random = random * 1664525u + 1013904223u;
        if (slot[i].block != NULL) {
            for (size_t k = 0; k < slot[i].size; k++) TEST_ASSERT_EQUAL_INT64(slot[i].mark, slot[i].block[k]);
            bvxi_free(ctx, slot[i].block, slot[i].size);
            used -= slot[i].size;
            slot[i].block = NULL;
        } else if (round < ROUNDS) {
            slot[i].size = 1 + (random >> 10) % 1500;
            slot[i].mark = (unsigned char)(random >> 24);
            if (bvxi_alloc(ctx, (int)(random >> 9 & 1), slot[i].size, "a block", &slot[i].block) == BVX_OK) {
                memset(slot[i].block, slot[i].mark, (size_t)slot[i].size);
                used += slot[i].size;
                given++;
            } else {
                slot[i].block = NULL;
                refused++;
            }
        }
        TEST_ASSERT_EQUAL_INT64(used, bvx_memory_used(ctx));
    }
    TEST_ASSERT_TRUE(given > 1000 && refused > 100); /* both ways were taken */
    TEST_ASSERT_EQUAL_INT64(whole, largest_block(ctx, BVXI_RESULT));
    arena_kept_inside(&room);
}

static void test_arena_exhaustion_is_clean(void)
{
    static arena_room room;
    bvx_context *ctx = NULL;

    for (int kind = BVXI_RESULT; kind <= BVXI_SCRATCH; kind++) {
        unsigned char *block[ARENA_BYTES / 100];
        uint64_t n = 0, whole;
        void *none = NULL;
        TEST_ASSERT_EQUAL_INT64(BVX_OK, arena_context(&room, 0, ARENA_BYTES, &ctx));
        whole = largest_block(ctx, kind);
        while (bvxi_alloc(ctx, kind, 100, "a block", &block[n]) == BVX_OK) {
            memset(block[n], (int)n, 100);
            n++;
        }
        TEST_ASSERT_TRUE(n > 50);
        TEST_ASSERT_EQUAL_INT64(n * 100, bvx_memory_used(ctx));
        for (uint64_t size = 64; size < 400; size++) { /* nothing of that size fits at either end */
            TEST_ASSERT_EQUAL_INT64(BVX_ERR_MEMORY,
                                    bvxi_alloc(ctx, BVXI_RESULT, size + 64, "a block", &none));
            TEST_ASSERT_EQUAL_INT64(BVX_ERR_MEMORY,
                                    bvxi_alloc(ctx, BVXI_SCRATCH, size + 64, "a block", &none));
        }
        TEST_ASSERT_NULL(none);
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "no memory for 463 bytes in the arena of "));
        for (uint64_t i = 0; i < n; i++) {
            for (size_t k = 0; k < 100; k++) TEST_ASSERT_EQUAL_INT64((unsigned char)i, block[i][k]);
            bvxi_free(ctx, block[i], 100);
        }
        TEST_ASSERT_EQUAL_INT64(0, bvx_memory_used(ctx));
        TEST_ASSERT_EQUAL_INT64(whole, largest_block(ctx, kind));
        arena_kept_inside(&room);
    }
}

static void test_arena_of_any_alignment(void)
{
    static arena_room room;

    for (size_t shift = 0; shift < 64; shift++) {
        bvx_context *ctx = NULL;
        uint64_t whole;
        TEST_ASSERT_EQUAL_INT64(BVX_OK, arena_context(&room, shift, ARENA_BYTES - shift, &ctx));
        whole = largest_block(ctx, BVXI_RESULT);
        bvxi_free(ctx, get(ctx, BVXI_RESULT, whole), whole);
        whole = largest_block(ctx, BVXI_SCRATCH);
        bvxi_free(ctx, get(ctx, BVXI_SCRATCH, whole), whole);
        bvx_context_destroy(ctx);
        arena_kept_inside(&room);
    }
}

static void test_arena_of_any_size(void)
{
    static arena_room room;
    static const size_t shifts[] = {0, 1, 63};

    for (size_t i = 0; i < sizeof shifts / sizeof shifts[0]; i++) {
        int made = 0, refused = 0;
        for (size_t size = 1; size < 6000; size++) {
            bvx_context *ctx = NULL;
            bvx_status const status = arena_context(&room, shifts[i], size, &ctx);
            if (status == BVX_OK) {
                uint64_t const whole = largest_block(ctx, BVXI_RESULT);
                if (whole > 0) bvxi_free(ctx, get(ctx, BVXI_RESULT, whole), whole);
                made++;
            } else {
                TEST_ASSERT_EQUAL_INT64(BVX_ERR_MEMORY, status);
                TEST_ASSERT_NULL(ctx);
                TEST_ASSERT_EQUAL_INT64(0, made); /* what fits in a small arena fits in a larger one */
                refused++;
            }
            arena_kept_inside(&room);
        }
        TEST_ASSERT_TRUE(made > 1000 && refused > 100);
    }
}

static void test_arena_counts_against_the_limit(void)
{
    static unsigned char memory[ARENA_BYTES];
    bvx_context_options o = default_options();
    bvx_context *ctx;
    void *none = NULL;

    o.arena.memory = memory;
    o.arena.size = sizeof memory;
    o.memory_limit = 256;
    ctx = context_with(&o);
    bvxi_free(ctx, get(ctx, BVXI_SCRATCH, 256), 256);
    TEST_ASSERT_EQUAL_INT64(BVX_ERR_BUDGET, bvxi_alloc(ctx, BVXI_SCRATCH, 257, "a block", &none));
}

/* ---- What is enough ---- */

enum { LARGE_ARENA = 8 << 20 };

/* Calls that a game makes of a mesh, with results that live on. */
static bvx_status make_all(bvx_context *ctx, const bvx_mesh_view *view, int32_t fill)
{
    bvx_voxelize_options const o = {.struct_size = sizeof o, .fill = fill};
    bvx_lattice lattice;
    bvx_grid solid = {0}, filled = {0};
    bvx_mesh surface = {0}, level[2] = {{0}};

    BVXI_TRY(bvx_lattice_fit(ctx, view, 64, &lattice));
    BVXI_TRY(bvx_voxelize_solid(ctx, view, &lattice, &o, &solid));
    if (fill != BVX_FILL_AUTO) return BVX_OK;
    BVXI_TRY(bvx_grid_fill_cavities(ctx, &solid, 6, 0, &filled, NULL));
    BVXI_TRY(bvx_extract_surface(ctx, &filled, NULL, &surface));
    return bvx_build_levels(ctx, view, NULL, 2, level);
}

/* The peak in an arena of so many bytes, 0 where they are too few. */
static uint64_t peak_within(const bvx_mesh_view *view, int32_t fill, uint64_t size)
{
    static unsigned char memory[LARGE_ARENA + 64];
    bvx_context_options o = default_options();
    bvx_context *ctx;
    bvx_status status;
    uint64_t peak;

    o.threads = 1;
    /* Of the worst alignment. */
    o.arena.memory = memory + (BVXI_ALIGN + 1 - (uintptr_t)memory % BVXI_ALIGN) % BVXI_ALIGN;
    o.arena.size = size;
    ctx = context_with(&o);
    status = make_all(ctx, view, fill);
    TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_MEMORY);
    peak = bvx_memory_peak(ctx);
    TEST_ASSERT_TRUE(peak <= size);
    bvx_context_destroy(ctx);
    return status == BVX_OK ? peak : 0;
}

static bvx_mesh_view ball_of(maker_mesh *mesh, int32_t rings, int32_t segments)
{
    static const double centre[3] = {0, 0, 0}, radius[3] = {1, 1, 1};
    uint64_t seed = 1;

    maker_clear(mesh);
    maker_star(mesh, &seed, centre, radius, 0, rings, segments, 1 << 20);
    return maker_view(mesh);
}

static void test_the_peak_of_an_arena_is_enough(void)
{
    static const int32_t fills[] = {BVX_FILL_AUTO,  BVX_FILL_NONZERO, BVX_FILL_VOTE,
                                    BVX_FILL_FLOOD, BVX_FILL_REGIONS, BVX_FILL_WINDING};
    maker_mesh mesh = {0};
    bvx_mesh_view const view = ball_of(&mesh, 40, 40);

    for (size_t i = 0; i < sizeof fills / sizeof *fills; i++) {
        uint64_t const peak = peak_within(&view, fills[i], LARGE_ARENA);
        TEST_ASSERT_EQUAL_UINT64(peak, peak_within(&view, fills[i], peak));
        TEST_ASSERT_EQUAL_UINT64(0, peak_within(&view, fills[i], peak - BVXI_ALIGN));
    }
    maker_free(&mesh);
}

static void test_a_small_solid_takes_a_small_arena(void)
{
    maker_mesh mesh = {0};
    bvx_mesh_view const view = ball_of(&mesh, 26, 25);

    TEST_ASSERT_EQUAL_UINT64(1250, view.triangle_count);
    TEST_ASSERT_NOT_EQUAL_UINT64(0, peak_within(&view, BVX_FILL_PARITY, 128 << 10));
    maker_free(&mesh);
}

/* ---- Marks ---- */

/* Contexts of both kinds: a heap that counts what it gives, and an arena. */
static bvx_context *marked_context(int kind, fault_heap *heap)
{
    static unsigned char memory[1 << 16];
    bvx_context_options o = fault_options(NULL, heap);

    if (kind == 1) {
        o = default_options();
        o.arena.memory = memory;
        o.arena.size = sizeof memory;
    }
    return context_with(&o);
}

/* Enough blocks that the table behind the context does not hold them. */
static void test_a_mark_frees_what_came_after_it(void)
{
    for (int kind = 0; kind < 2; kind++) {
        fault_heap heap = {0};
        bvx_context *const ctx = marked_context(kind, &heap);
        void *const before = get(ctx, BVXI_SCRATCH, 100), *const gone = get(ctx, BVXI_SCRATCH, 70);
        uint64_t const mark = bvxi_scratch_begin(ctx);
        void *const result = get(ctx, BVXI_RESULT, 50), *block[200];

        for (int i = 0; i < 200; i++) block[i] = get(ctx, BVXI_SCRATCH, (uint64_t)i);
        bvxi_drop(ctx, gone); /* older than the mark */
        for (int i = 0; i < 200; i += 3) bvxi_drop(ctx, block[i]);
        bvxi_drop(ctx, NULL);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvxi_scratch_end(ctx, mark, BVX_ERR_EMPTY));
        TEST_ASSERT_EQUAL_UINT64(150, bvx_memory_used(ctx));

        /* What comes after lies where the freed blocks were, and the older mark still holds. */
        (void)get(ctx, BVXI_SCRATCH, 10);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_scratch_end(ctx, mark, BVX_OK));
        TEST_ASSERT_EQUAL_UINT64(150, bvx_memory_used(ctx));
        bvxi_drop(ctx, before);
        bvxi_free(ctx, result, 50);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
        bvx_context_destroy(ctx);
        TEST_ASSERT_EQUAL_UINT64(0, heap.live_blocks);
        TEST_ASSERT_EQUAL_STRING("", heap.error);
    }
}

static void test_a_mark_keeps_what_succeeded_and_what_is_adopted(void)
{
    for (int kind = 0; kind < 2; kind++) {
        fault_heap heap = {0};
        bvx_context *const ctx = marked_context(kind, &heap);
        uint64_t const mark = bvxi_scratch_begin(ctx);
        void *const own = get(ctx, BVXI_SCRATCH, 33), *later;

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_scratch_keep(ctx, mark, BVX_OK));
        TEST_ASSERT_EQUAL_UINT64(33, bvx_memory_used(ctx));
        bvxi_scratch_adopt(ctx, mark);
        later = get(ctx, BVXI_SCRATCH, 5);
        (void)later;
        TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, bvxi_scratch_keep(ctx, mark, BVX_CANCELLED));
        TEST_ASSERT_EQUAL_UINT64(33, bvx_memory_used(ctx));
        bvxi_free(ctx, own, 33);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
        bvx_context_destroy(ctx);
        TEST_ASSERT_EQUAL_UINT64(0, heap.live_blocks);
        TEST_ASSERT_EQUAL_STRING("", heap.error);
    }
}

/* The end of a public call frees what its works have left, but nothing that was there before. */
static void test_the_end_of_a_call_frees_its_scratch(void)
{
    for (int kind = 0; kind < 2; kind++) {
        fault_heap heap = {0};
        bvx_context *const ctx = marked_context(kind, &heap);
        void *const before = get(ctx, BVXI_SCRATCH, 40);

        bvxi_call_begin(ctx, "outer");
        (void)get(ctx, BVXI_SCRATCH, 7);
        bvxi_call_begin(ctx, "inner");
        (void)get(ctx, BVXI_SCRATCH, 8);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvxi_call_end(ctx, BVX_ERR_EMPTY));
        TEST_ASSERT_EQUAL_UINT64(47, bvx_memory_used(ctx)); /* the outer one goes on with its own */
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_call_end(ctx, BVX_OK));
        TEST_ASSERT_EQUAL_UINT64(40, bvx_memory_used(ctx));
        bvxi_drop(ctx, before);
        bvx_context_destroy(ctx);
        TEST_ASSERT_EQUAL_UINT64(0, heap.live_blocks);
        TEST_ASSERT_EQUAL_STRING("", heap.error);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_used_and_peak_are_counted);
    RUN_TEST(test_blocks_of_no_bytes_are_blocks);
    RUN_TEST(test_limit_refuses_with_a_message);
    RUN_TEST(test_sizes_beyond_the_machine_are_refused);
    RUN_TEST(test_arena_gives_results_low_and_scratch_high);
    RUN_TEST(test_arena_is_empty_after_any_order_of_freeing);
    RUN_TEST(test_arena_reuses_its_ends_under_mixed_work);
    RUN_TEST(test_arena_exhaustion_is_clean);
    RUN_TEST(test_arena_of_any_alignment);
    RUN_TEST(test_arena_of_any_size);
    RUN_TEST(test_arena_counts_against_the_limit);
    RUN_TEST(test_the_peak_of_an_arena_is_enough);
    RUN_TEST(test_a_small_solid_takes_a_small_arena);
    RUN_TEST(test_a_mark_frees_what_came_after_it);
    RUN_TEST(test_a_mark_keeps_what_succeeded_and_what_is_adopted);
    RUN_TEST(test_the_end_of_a_call_frees_its_scratch);
    return UNITY_END();
}
