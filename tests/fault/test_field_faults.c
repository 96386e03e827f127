/* test_field_faults.c - distance fields by every sign rule, dense and as files, with every allocation failing
 * once, cancelled at every progress call, under every memory limit and in arenas of every size. */
#include "fault/context.h"
#include "tools/mesh_maker.h"

/* ---- Inputs, made once ---- */

static maker_mesh closed, holes; /* holes: triangles missing */
static bvx_mesh_view closed_view, holes_view;
static bvx_lattice lattice;
static bvx_field field; /* of closed, with features */
static bvx_context *maker;

static int make_inputs(void **state)
{
    static const double centre[3] = {9, 8, 8}, radius[3] = {7, 6, 5};
    uint64_t seed = 4714;
    bvx_context_options o = default_options();
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_field_options f = {.struct_size = sizeof f};

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&closed, &seed, centre, radius, 0.2, 6, 9, 65536);
    maker_star(&holes, &seed, centre, radius, 0.2, 6, 9, 65536);
    for (int i = 0; i < 9; i++)
        maker_remove(&holes, (size_t)maker_below(&seed, (int32_t)holes.triangles / 3));
    closed_view = maker_view(&closed);
    holes_view = maker_view(&holes);
    fit.resolution = 18;
    fit.padding = 2;
    assert_int_equal(bvx_lattice_fit_with(maker, &closed_view, &fit, &lattice), BVX_OK);
    f.half_width = 1.5;
    f.features = 1;
    assert_int_equal(bvx_measure_field(maker, &closed_view, &lattice, &f, &field), BVX_OK);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_field_free(maker, &field);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&closed);
    maker_free(&holes);
    return 0;
}

/* ---- Operations: each frees what it got, leaves its mark, and says on failure whether its results are empty  */

static uint64_t mark;   /* a hash of what the last good run made */
static int left_behind; /* a failed call left something in a result */

static bvx_status measure(bvx_context *ctx, const bvx_mesh_view *view, int32_t sign, double half_width,
                          int window, int features)
{
    static const bvx_field empty = {0};
    bvx_field f = {0};
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_status status;

    o.sign = sign;
    o.half_width = half_width;
    o.features = features;
    for (int a = 0; a < 3 && window; a++) {
        o.window.low[a] = 3;
        o.window.size[a] = 10;
    }
    status = bvx_measure_field(ctx, view, &lattice, &o, &f);
    if (status != BVX_OK) {
        left_behind |= memcmp(&f, &empty, sizeof f) != 0;
        return status;
    }
    mark = bvx_hash(f.distances, (size_t)f.value_count * 4, 0);
    for (int32_t x = 0; x < f.band.size[0]; x++)
        mark += bvx_field_value(&f, x, f.band.size[1] / 2, f.band.size[2] / 2);
    mark = bvx_hash(f.vectors, (size_t)f.value_count * 12, mark);
    if (f.inside.words != NULL)
        mark = bvx_hash(f.inside.words, (size_t)f.inside.size[1] * (size_t)f.inside.size[2] * 8, mark);
    bvx_field_free(ctx, &f);
    return BVX_OK;
}

static bvx_status write(bvx_context *ctx, int32_t format, int32_t vectors)
{
    bvx_buffer b = {0};
    bvx_status const status = bvx_write_field(ctx, &field, vectors, format, &b);

    if (status != BVX_OK) {
        left_behind |= b.bytes != NULL || b.size != 0;
        return status;
    }
    mark = bvx_hash(b.bytes, (size_t)b.size, 0);
    bvx_buffer_free(ctx, &b);
    return BVX_OK;
}

static bvx_status dense(bvx_context *ctx, int32_t vectors)
{
    size_t const count = (size_t)lattice.dims[0] * (size_t)lattice.dims[1] * (size_t)lattice.dims[2] *
                         (vectors ? 3 : 1);
    float *const values = maker_grow(NULL, count * 4);
    bvx_status const status = bvx_field_dense(ctx, &field, vectors, values);
    if (status == BVX_OK) mark = bvx_hash(values, count * 4, 0);
    free(values);
    return status;
}

enum {
    EXACT,
    NORMAL,
    NORMAL_WINDOW,
    NORMAL_HOLES,
    NORMAL_THIN,
    ALL,
    WINDING,
    VOTE,
    AUTO,
    NONE,
    NPY,
    NRRD,
    VTI,
    DISTANCES,
    VECTORS,
    KINDS
};
static const char *const names[KINDS] = {"exact",
                                         "normal",
                                         "a window's normal",
                                         "normal with holes",
                                         "a thin band",
                                         "all centres",
                                         "winding",
                                         "vote",
                                         "auto",
                                         "none",
                                         "npy",
                                         "nrrd",
                                         "vti",
                                         "dense distances",
                                         "dense vectors"};

static bvx_status operate(void *user, bvx_context *ctx)
{
    switch (*(const int *)user) {
    case EXACT: return measure(ctx, &closed_view, BVX_FILL_PARITY, 2, 0, 1);
    case NORMAL: return measure(ctx, &closed_view, BVX_FILL_NORMAL, 2, 0, 0);
    case NORMAL_WINDOW: return measure(ctx, &closed_view, BVX_FILL_NORMAL, 1, 1, 0);
    case NORMAL_HOLES: return measure(ctx, &holes_view, BVX_FILL_NORMAL, 1, 0, 0);
    case NORMAL_THIN: return measure(ctx, &holes_view, BVX_FILL_NORMAL, 0.25, 0, 0);
    case ALL: return measure(ctx, &closed_view, BVX_FILL_PARITY, 1e9, 0, 0);
    case WINDING: return measure(ctx, &holes_view, BVX_FILL_WINDING, 2, 0, 0);
    case VOTE: return measure(ctx, &holes_view, BVX_FILL_VOTE, 2, 1, 0);
    case AUTO: return measure(ctx, &closed_view, BVX_FILL_AUTO, 2, 0, 0);
    case NONE: return measure(ctx, &closed_view, BVX_FILL_NONE, 2, 0, 0);
    case NPY: return write(ctx, BVX_FORMAT_NPY, 1);
    case NRRD: return write(ctx, BVX_FORMAT_NRRD, 0);
    case VTI: return write(ctx, BVX_FORMAT_VTI, 1);
    case DISTANCES: return dense(ctx, 0);
    default: return dense(ctx, 1);
    }
}

static uint64_t wanted[KINDS];

static void assert_well(int kind, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", names[kind], wrong);
    if (left_behind) fail_msg("%s: a failed call left something in its result", names[kind]);
}

/* What the operation makes when nothing is in its way. */
static void know(int kind)
{
    left_behind = 0;
    if (wanted[kind] == 0) {
        assert_int_equal(operate(&kind, maker), BVX_OK);
        wanted[kind] = mark;
    }
    mark = 0;
}

/* Dense fields take no memory. */
static void test_every_allocation_fails_once(void **state)
{
    (void)state;
    for (int kind = 0; kind < DISTANCES; kind++)
        for (int32_t threads = 1; threads <= 2; threads++) {
            bvx_context_options o = default_options();
            uint64_t allocations = 0;
            o.threads = threads;
            know(kind);
            assert_well(kind, fault_every_allocation(operate, &kind, &o, &allocations));
            assert_true(mark == wanted[kind]);
            assert_true(allocations >= (kind >= NPY ? 1 : 5));
        }
}

static void test_cancelled_at_every_progress_call(void **state)
{
    (void)state;
    for (int kind = 0; kind < KINDS; kind++) {
        bvx_context_options o = default_options();
        uint64_t calls = 0;
        o.threads = 1;
        know(kind);
        assert_well(kind, fault_every_cancel(operate, &kind, &o, &calls));
        assert_true(mark == wanted[kind]);
        assert_true(calls >= 1);
    }
}

static void test_under_every_memory_limit(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int kind = 0; kind < DISTANCES; kind++) {
        know(kind);
        assert_well(kind, fault_every_limit(operate, &kind, &o, 25));
    }
}

static void test_in_arenas_of_every_size(void **state)
{
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    for (int kind = 0; kind < KINDS; kind++) {
        know(kind);
        assert_well(kind, fault_every_arena(operate, &kind, &o, 4 << 20, 25));
        assert_true(mark == wanted[kind]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_cancelled_at_every_progress_call),
        cmocka_unit_test(test_under_every_memory_limit),
        cmocka_unit_test(test_in_arenas_of_every_size),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
