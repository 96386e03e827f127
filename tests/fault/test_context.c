/* test_context.c - status texts, creation, options of older and newer callers, resizing, messages. */
#include "core/core.h"
#include "fault/context.h"

#include <fenv.h>

/* ---- Status ---- */

static void test_status_text_of_every_number(void **state)
{
    static const struct {
        bvx_status value;
        const char *text;
    } list[] = {
#define AS_ROW(name, value, text) {name, text},
        BVX_STATUS_LIST(AS_ROW)
#undef AS_ROW
    };
    (void)state;
    assert_int_equal(sizeof list / sizeof list[0], BVX_STATUS_COUNT);
    for (int32_t i = 0; i < BVX_STATUS_COUNT; i++) {
        assert_int_equal(list[i].value, i); /* frozen, without gaps */
        assert_string_equal(bvx_status_text(i), list[i].text);
        assert_true(strlen(list[i].text) > 3);
        for (int32_t k = 0; k < i; k++) assert_string_not_equal(list[i].text, list[k].text);
    }
}

static void test_status_text_of_other_numbers(void **state)
{
    static const bvx_status others[] = {-1,   BVX_STATUS_COUNT, BVX_STATUS_COUNT + 1,
                                        1000, INT32_MAX,        INT32_MIN};
    (void)state;
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        assert_string_equal(bvx_status_text(others[i]), "unknown status");
}

/* ---- Creation ---- */

static void test_create_with_every_allocation_failing(void **state)
{
    fault_heap heap = {0};
    bvx_context_options const o = fault_options(NULL, &heap);
    bvx_context *ctx = NULL;
    uint64_t n = 0;

    (void)state;
    for (;;) {
        bvx_status status;
        memset(&heap, 0, sizeof heap);
        heap.fail_at = ++n;
        ctx = (bvx_context *)(void *)&heap; /* not NULL, to see that it becomes so */
        status = bvx_context_create(&o, &ctx);
        if (heap.failed == 0) {
            assert_int_equal(status, BVX_OK);
            break;
        }
        assert_int_equal(status, BVX_ERR_MEMORY);
        assert_null(ctx);
        assert_null(fault_end(&heap));
    }
    assert_true(n > 1);
    bvx_context_destroy(ctx);
    assert_null(fault_end(&heap));
}

/* Before 1.0 a minor version may change the interface. */
static void test_create_refuses_another_interface(void **state)
{
    bvx_context *ctx = NULL;

    (void)state;
    assert_int_equal(bvx_version(), BVX_VERSION);
    for (int32_t major = 0; major < 3; major++)
        for (int32_t minor = 0; minor < 100; minor++) {
            int const same = major == BVX_VERSION_MAJOR && (major != 0 || minor == BVX_VERSION_MINOR);
            bvx_status const status = bvx_context_create_version(major * 10000 + minor * 100 + 99, NULL,
                                                                 &ctx);
            assert_int_equal(status, same ? BVX_OK : BVX_ERR_VERSION);
            assert_int_equal(ctx != NULL, same);
            assert_int_equal(bvx_context_fault(major * 10000 + minor * 100 + 99, NULL) == NULL, same);
            bvx_context_destroy(ctx);
        }
}

static void test_create_refuses_other_rounding(void **state)
{
    static const int modes[] = {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};
    bvx_context *ctx = NULL;

    (void)state;
    assert_null(bvx_context_fault(BVX_VERSION, NULL));
    for (size_t i = 0; i < sizeof modes / sizeof modes[0]; i++) {
        bvx_status status;
        const char *fault;
        if (fesetround(modes[i]) != 0) continue;
        status = bvx_context_create(NULL, &ctx);
        fault = bvx_context_fault(BVX_VERSION, NULL);
        fesetround(FE_TONEAREST);
        assert_int_equal(status, BVX_ERR_UNSUPPORTED);
        assert_null(ctx);
        assert_non_null(strstr(fault, "nearest"));
    }
}

/* A caller may have these exceptions made signals. */
static void test_create_raises_no_floating_exception(void **state)
{
    bvx_context *ctx = NULL;
    (void)state;
    feclearexcept(FE_ALL_EXCEPT);
    assert_int_equal(bvx_context_create(NULL, &ctx), BVX_OK);
    assert_int_equal(fetestexcept(FE_INVALID | FE_OVERFLOW | FE_DIVBYZERO), 0);
    bvx_context_destroy(ctx);
}

static void test_create_refuses_bad_options(void **state)
{
    static unsigned char memory[4096];
    static const char *const why[8] = {"allocator.alloc and .free are given together",
                                       "allocator.alloc and .free are given together",
                                       "allocator and arena exclude each other",
                                       "arena.memory and .size are given together",
                                       "arena.memory and .size are given together",
                                       "threads is 0 to 1024",
                                       "threads is 0 to 1024",
                                       "cpu is BVX_CPU_BEST, BVX_CPU_PORTABLE or BVX_CPU_AVX2"};
    fault_heap heap = {0};
    bvx_context_options bad[8];
    bvx_context *ctx = NULL;

    (void)state;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) bad[i] = default_options();
    bad[0].allocator.alloc = fault_alloc; /* alloc without free */
    bad[1].allocator.free = fault_free;   /* free without alloc */
    bad[2] = fault_options(NULL, &heap);  /* an allocator and an arena */
    bad[2].arena.memory = memory;
    bad[2].arena.size = sizeof memory;
    bad[3].arena.memory = memory;      /* an arena without size */
    bad[4].arena.size = sizeof memory; /* a size without arena */
    bad[5].threads = -1;
    bad[6].threads = 1025;
    bad[7].cpu = BVX_CPU_AVX2 + 1;
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        assert_int_equal(bvx_context_create(&bad[i], &ctx), BVX_ERR_ARGUMENT);
        assert_null(ctx);
        assert_string_equal(bvx_context_fault(BVX_VERSION, &bad[i]), why[i]);
    }
    bad[0] = default_options();
    assert_null(bvx_context_fault(BVX_VERSION, &bad[0]));
    assert_null(bvx_context_fault(BVX_VERSION, NULL));
    bad[0].cpu = -1;
    assert_int_equal(bvx_context_create(&bad[0], &ctx), BVX_ERR_ARGUMENT);
    assert_string_equal(bvx_context_fault(BVX_VERSION, &bad[0]), why[7]);
    assert_int_equal(bvx_context_create(NULL, NULL), BVX_ERR_ARGUMENT);
    assert_int_equal(heap.asked, 0);
}

/* What is told of an arena is what creating a context in it finds, and the arena keeps its bytes. */
static void test_fault_of_an_arena_is_that_of_its_context(void **state)
{
    static unsigned char memory[65536], same[65536];
    bvx_context_options o = default_options();
    uint64_t least = 0;

    (void)state;
    o.threads = 4;
    memset(same, 0xEE, sizeof same);
    for (uint64_t size = 1; size + 3 <= sizeof memory; size += size < 4096 ? 1 : 61) {
        bvx_context *ctx = NULL;
        const char *fault;
        bvx_status status;

        memset(memory, 0xEE, sizeof memory);
        o.arena.memory = memory + 3;
        o.arena.size = size;
        fault = bvx_context_fault(BVX_VERSION, &o);
        assert_memory_equal(memory, same, sizeof memory);
        status = bvx_context_create(&o, &ctx);
        assert_int_equal(fault == NULL, status == BVX_OK);
        if (fault != NULL) {
            assert_int_equal(status, BVX_ERR_MEMORY);
            assert_string_equal(fault, "the arena is too small for the context and its threads");
        } else if (least == 0) least = size;
        bvx_context_destroy(ctx);
    }
    assert_in_range(least, 1, sizeof memory - 3);
}

static void test_destroy_and_queries_take_null(void **state)
{
    (void)state;
    bvx_context_destroy(NULL);
    bvx_memory_reset_peak(NULL);
    assert_int_equal(bvx_memory_used(NULL), 0);
    assert_int_equal(bvx_memory_peak(NULL), 0);
    assert_int_equal(bvx_context_threads(NULL), 0);
    assert_non_null(bvx_last_message(NULL));
}

static void test_create_keeps_to_the_portable_path(void **state)
{
    bvx_context_options o = default_options();
    bvx_context *ctx = context_with(NULL);

    (void)state;
    assert_in_range(bvxi_cpu(ctx), BVX_CPU_PORTABLE, BVX_CPU_AVX2);
    assert_string_equal(bvx_last_message(ctx), "");
    bvx_context_destroy(ctx);
    o.cpu = BVX_CPU_PORTABLE;
    ctx = context_with(&o);
    assert_int_equal(bvxi_cpu(ctx), BVX_CPU_PORTABLE);
    bvx_context_destroy(ctx);
}

/* ---- Options of older and newer callers ---- */

static void test_create_takes_options_of_an_older_caller(void **state)
{
    bvx_context_options o = default_options();
    bvx_context *ctx;

    (void)state;
    o.struct_size = offsetof(bvx_context_options, memory_limit);
    o.memory_limit = 1; /* beyond the stated size: not the caller's */
    o.threads = -5;
    ctx = context_with(&o);
    bvxi_free(ctx, get(ctx, BVXI_RESULT, 1000), 1000);
    bvx_context_destroy(ctx);
}

typedef struct newer_options {
    bvx_context_options known;
    uint64_t unknown[3];
} newer_options;

static void test_create_takes_options_of_a_newer_caller_with_a_zero_tail(void **state)
{
    newer_options o = {{0}, {0}};
    bvx_context *ctx = NULL;

    (void)state;
    o.known = default_options();
    o.known.struct_size = sizeof o;
    o.known.memory_limit = 100;
    ctx = context_with(&o.known);
    assert_int_equal(bvxi_alloc(ctx, BVXI_RESULT, 101, "too much", &(void *){NULL}), BVX_ERR_BUDGET);
    bvx_context_destroy(ctx);
    for (size_t i = 0; i < sizeof o.unknown; i++) { /* a field the library does not know is never ignored */
        unsigned char *const tail = (unsigned char *)o.unknown;
        tail[i] = 1;
        assert_int_equal(bvx_context_create(&o.known, &ctx), BVX_ERR_VERSION);
        assert_string_equal(bvx_context_fault(BVX_VERSION, &o.known),
                            "a field is set that this library does not know");
        assert_null(ctx);
        tail[i] = 0;
    }
}

static void test_create_refuses_a_size_that_is_none(void **state)
{
    static const size_t sizes[] = {0, 1, sizeof(size_t) - 1, 65537, SIZE_MAX};
    bvx_context_options o = default_options();
    bvx_context *ctx = NULL;

    (void)state;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        o.struct_size = sizes[i];
        assert_int_equal(bvx_context_create(&o, &ctx), BVX_ERR_ARGUMENT);
        assert_null(ctx);
        assert_string_equal(bvx_context_fault(BVX_VERSION, &o),
                            "struct_size is not the sizeof of the options");
    }
}

static void test_take_options_by_size(void **state)
{
    typedef struct some_options {
        size_t struct_size;
        int32_t first, second;
    } some_options;
    struct {
        some_options known;
        int32_t tail[2];
    } given;
    some_options taken = {sizeof taken, 7, 8};
    bvx_context *const ctx = context_with(NULL);
    (void)state;
    memset(&given, 0, sizeof given);

    assert_int_equal(bvxi_take_options(ctx, "f", NULL, &taken, sizeof taken), BVX_OK);
    assert_int_equal(taken.first, 0); /* NULL: all is 0, the default */

    given.known.struct_size = offsetof(some_options, second);
    given.known.first = 1;
    given.known.second = 2;
    assert_int_equal(bvxi_take_options(ctx, "f", &given, &taken, sizeof taken), BVX_OK);
    assert_int_equal(taken.first, 1);
    assert_int_equal(taken.second, 0); /* older caller: 0, the default */

    given.known.struct_size = sizeof given;
    assert_int_equal(bvxi_take_options(ctx, "f", &given, &taken, sizeof taken), BVX_OK);
    assert_int_equal(taken.second, 2);

    given.tail[1] = 1;
    assert_int_equal(bvxi_take_options(ctx, "bvx_some", &given, &taken, sizeof taken), BVX_ERR_VERSION);
    assert_non_null(strstr(bvx_last_message(ctx), "bvx_some"));

    given.known.struct_size = 3;
    assert_int_equal(bvxi_take_options(ctx, "bvx_some", &given, &taken, sizeof taken), BVX_ERR_ARGUMENT);
    assert_non_null(strstr(bvx_last_message(ctx), "3"));
    bvx_context_destroy(ctx);
}

/* ---- Memory ---- */

static bvx_status grow_and_shrink(void *user, bvx_context *ctx)
{
    unsigned char *block = NULL;
    bvx_status status = bvxi_alloc_zero(ctx, BVXI_RESULT, 100, "a block", &block);
    uint64_t size = 100;
    static const uint64_t sizes[] = {300, 300, 50, 1000};

    (void)user;
    if (status != BVX_OK) return status;
    for (size_t i = 0; i < 100; i++) {
        assert_int_equal(block[i], 0);
        block[i] = (unsigned char)i;
    }
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0] && status == BVX_OK; k++) {
        status = bvxi_resize(ctx, BVXI_RESULT, &block, size, sizes[k], "a block");
        if (status == BVX_OK) size = sizes[k];
        /* kept, also by a resize that failed */
        for (size_t i = 0; i < 50; i++) assert_int_equal(block[i], i);
    }
    bvxi_free(ctx, block, size);
    return status;
}

static void test_resize_with_every_allocation_failing(void **state)
{
    uint64_t allocations = 0;
    (void)state;
    assert_null(fault_every_allocation(grow_and_shrink, NULL, NULL, &allocations));
    assert_int_equal(allocations, 4);
}

/* ---- Messages ---- */

static void test_fail_formats(void **state)
{
    bvx_context *const ctx = context_with(NULL);

    (void)state;
    assert_int_equal(bvxi_fail(ctx, BVX_ERR_RANGE, "%s: %d, %d, %d; %u; 100%%", "vertex", (int64_t)-5,
                               INT64_MIN, INT64_MAX, UINT64_MAX),
                     BVX_ERR_RANGE);
    assert_string_equal(bvx_last_message(ctx), "vertex: -5, -9223372036854775808, 9223372036854775807; "
                                               "18446744073709551615; 100%");
    assert_int_equal(bvxi_fail(ctx, BVX_ERR_FORMAT, "%u is %g, not %g", (uint64_t)0, 0.5, -0.25),
                     BVX_ERR_FORMAT);
    assert_string_equal(bvx_last_message(ctx), "0 is 0.5, not -0.25");
    assert_int_equal(bvxi_fail_null(ctx, "bvx_some", "mesh"), BVX_ERR_ARGUMENT);
    assert_string_equal(bvx_last_message(ctx), "bvx_some: mesh is NULL");
    bvx_context_destroy(ctx);
}

static void test_fail_keeps_to_one_line_and_to_its_room(void **state)
{
    bvx_context *const ctx = context_with(NULL);
    char text[2 * BVXI_MESSAGE_SIZE];

    (void)state;
    bvxi_fail(ctx, BVX_ERR_FORMAT, "%s|", "two\nlines\t\x7f");
    assert_string_equal(bvx_last_message(ctx), "two?lines??|");
    for (size_t n = BVXI_MESSAGE_SIZE - 12; n < sizeof text; n++) {
        size_t const kept = n + 10 < BVXI_MESSAGE_SIZE - 1 ? n + 10 : BVXI_MESSAGE_SIZE - 1;
        memset(text, 'x', n);
        text[n] = 0;
        bvxi_fail(ctx, BVX_ERR_FORMAT, "%s%u", text, (uint64_t)1234567890);
        assert_int_equal(strlen(bvx_last_message(ctx)), kept);
    }
    bvx_context_destroy(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_status_text_of_every_number),
        cmocka_unit_test(test_status_text_of_other_numbers),
        cmocka_unit_test(test_create_with_every_allocation_failing),
        cmocka_unit_test(test_create_refuses_another_interface),
        cmocka_unit_test(test_create_refuses_other_rounding),
        cmocka_unit_test(test_create_raises_no_floating_exception),
        cmocka_unit_test(test_create_refuses_bad_options),
        cmocka_unit_test(test_fault_of_an_arena_is_that_of_its_context),
        cmocka_unit_test(test_destroy_and_queries_take_null),
        cmocka_unit_test(test_create_keeps_to_the_portable_path),
        cmocka_unit_test(test_create_takes_options_of_an_older_caller),
        cmocka_unit_test(test_create_takes_options_of_a_newer_caller_with_a_zero_tail),
        cmocka_unit_test(test_create_refuses_a_size_that_is_none),
        cmocka_unit_test(test_take_options_by_size),
        cmocka_unit_test(test_resize_with_every_allocation_failing),
        cmocka_unit_test(test_fail_formats),
        cmocka_unit_test(test_fail_keeps_to_one_line_and_to_its_room),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
