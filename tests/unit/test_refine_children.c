/* test_refine_children.c - octants that a triangle touches against separating axes in 192 bits. */
#include "bitvox_io.h"
#include "refine/cubes.h"
#include "tools/exact.h"
#include "tools/mesh_maker.h"

#include "unity.h"

#include <stdio.h>

void setUp(void)
{
}

void tearDown(void)
{
}

/* ---- oracle: thirteen axes, interval against interval ---- */

typedef struct axis3 {
    exact_number c[3];
} axis3;

static exact_number exact_minus(exact_number a)
{
    return exact_mul(a, exact_of(-1));
}

static axis3 cross_of(const int64_t u[3], const int64_t v[3])
{
    axis3 n;
    for (int a = 0; a < 3; a++)
        n.c[a] = exact_add(exact_mul(exact_of(u[(a + 1) % 3]), exact_of(v[(a + 2) % 3])),
                           exact_minus(exact_mul(exact_of(u[(a + 2) % 3]), exact_of(v[(a + 1) % 3]))));
    return n;
}

static exact_number along(const axis3 *n, const int64_t p[3])
{
    exact_number s = exact_of(0);
    for (int a = 0; a < 3; a++) s = exact_add(s, exact_mul(n->c[a], exact_of(p[a])));
    return s;
}

static int above(exact_number a, exact_number b)
{
    return exact_sign(exact_add(a, exact_minus(b))) > 0;
}

static int axis_separates(const axis3 *n, int64_t p[3][3], const int64_t low[3], int64_t side)
{
    exact_number t[2] = {{{0}}, {{0}}}, b[2] = {{{0}}, {{0}}};

    for (int i = 0; i < 3; i++) {
        exact_number const v = along(n, p[i]);
        if (i == 0 || above(t[0], v)) t[0] = v;
        if (i == 0 || above(v, t[1])) t[1] = v;
    }
    for (int c = 0; c < 8; c++) {
        int64_t const corner[3] = {low[0] + (c & 1) * side, low[1] + (c >> 1 & 1) * side,
                                   low[2] + (c >> 2) * side};
        exact_number const v = along(n, corner);
        if (c == 0 || above(b[0], v)) b[0] = v;
        if (c == 0 || above(v, b[1])) b[1] = v;
    }
    return above(t[0], b[1]) || above(b[0], t[1]);
}

static int box_touched(int64_t p[3][3], const int64_t low[3], int64_t side)
{
    int64_t edge[3][3];
    axis3 n;

    for (int i = 0; i < 3; i++)
        for (int a = 0; a < 3; a++) edge[i][a] = p[(i + 1) % 3][a] - p[i][a];
    for (int a = 0; a < 3; a++) {
        int64_t const u[3] = {a == 0, a == 1, a == 2}, v[3] = {a == 2, a == 0, a == 1};
        n = cross_of(u, v);
        if (axis_separates(&n, p, low, side)) return 0;
        for (int i = 0; i < 3; i++) {
            n = cross_of(edge[i], u);
            if (axis_separates(&n, p, low, side)) return 0;
        }
    }
    n = cross_of(edge[0], edge[1]);
    return !axis_separates(&n, p, low, side);
}

/* ---- triangles ---- */

static int64_t between(uint64_t *seed, int64_t low, int64_t high)
{
    return low + (int64_t)(maker_random(seed) % (uint64_t)(high - low + 1));
}

static int checked, multiple;
static bvxi_children_batch batch;
static uint8_t in_batch[BVXI_CHILDREN_BATCH];
static uint32_t batched;
static int64_t batch_half;

/* What waits in the batch comes out the same, on both paths. */
static void check_batch(void)
{
    for (int32_t cpu = BVX_CPU_PORTABLE; cpu <= BVX_CPU_AVX2; cpu++) {
        bvx_context *ctx = NULL;
        bvx_context_options o = {.struct_size = sizeof o};
        o.cpu = cpu;
        if (bvx_context_create(&o, &ctx) != BVX_OK) continue; /* this processor has it not */
        bvxi_children_of_batch(&batch, batched, (int32_t)batch_half, bvxi_cpu(ctx));
        bvx_context_destroy(ctx);
        for (uint32_t i = 0; i < batched; i++)
            if (in_batch[i] != batch.touched[i]) {
                char text[240];
                snprintf(text, sizeof text,
                         "in a batch octants %02x, not %02x: half %ld, (%d %d %d) (%d %d %d) (%d %d %d)",
                         batch.touched[i], in_batch[i], (long)batch_half, batch.p[0][0][i], batch.p[0][1][i],
                         batch.p[0][2][i], batch.p[1][0][i], batch.p[1][1][i], batch.p[1][2][i],
                         batch.p[2][0][i], batch.p[2][1][i], batch.p[2][2][i]);
                TEST_FAIL_MESSAGE(text);
            }
    }
    batched = 0;
}

static void check_children(int64_t p[3][3], int64_t half)
{
    int64_t const cube[3] = {-half, -half, -half};
    int32_t q[3][3];
    uint32_t want = 0;

    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++) q[c][a] = (int32_t)p[c][a];
    if (!box_touched(p, cube, 2 * half)) return;
    for (uint32_t o = 0; o < 8; o++) {
        int64_t low[3];
        for (int a = 0; a < 3; a++) low[a] = o >> a & 1 ? 0 : -half;
        if (box_touched(p, low, half)) want |= 1u << o;
    }
    uint32_t const got = bvxi_children_touched((const int32_t(*)[3])q, (int32_t)half);
    if (batched == BVXI_CHILDREN_BATCH || half != batch_half) check_batch();
    batch_half = half;
    for (int k = 0; k < 9; k++) batch.p[k / 3][k % 3][batched] = q[k / 3][k % 3];
    in_batch[batched++] = (uint8_t)want;
    checked++;
    multiple += (want & (want - 1)) != 0;
    if (got != want) {
        char text[240];
        snprintf(text, sizeof text, "octants %02x, not %02x: half %ld, (%d %d %d) (%d %d %d) (%d %d %d)", got,
                 want, (long)half, q[0][0], q[0][1], q[0][2], q[1][0], q[1][1], q[1][2], q[2][0], q[2][1],
                 q[2][2]);
        TEST_FAIL_MESSAGE(text);
    }
}

/* Corners about a place near the cube, at most reach from it along each axis. */
static void try_triangles(uint64_t *seed, int count, int64_t half, int64_t reach, int64_t grain)
{
    for (int n = 0; n < count; n++) {
        int64_t p[3][3], place[3];
        for (int a = 0; a < 3; a++) place[a] = between(seed, -half, half);
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++) {
                int64_t const v = place[a] + between(seed, -reach, reach);
                p[c][a] = v / grain * grain;
                if (p[c][a] > 1610612735) p[c][a] = 1610612735; /* 1.5 * 2^30 - 1 */
                if (p[c][a] < -1610612735) p[c][a] = -1610612735;
            }
        if (n % 11 == 0) memcpy(p[2], p[1], sizeof p[2]);
        if (n % 23 == 0) memcpy(p[1], p[0], sizeof p[1]);
        if (n % 7 == 0)
            for (int a = 0; a < 3; a++) p[2][a] = p[0][a] + (p[1][a] - p[0][a]) / 2;
        if (n % 5 == 0) p[1][n % 3] = p[0][n % 3];
        if (n % 10 == 0) p[2][n % 3] = p[0][n % 3];
        check_children(p, half);
    }
}

static void test_small_numbers_hit_every_tie(void)
{
    uint64_t seed = 1;
    checked = multiple = 0;
    for (int64_t half = 1; half <= 16; half *= 2)
        for (int64_t reach = 1; reach <= 4 * half + 4; reach += 1 + reach / 2)
            try_triangles(&seed, 120, half, reach, 1);
    check_batch();
    TEST_ASSERT_GREATER_THAN(1000, checked);
    TEST_ASSERT_GREATER_THAN(500, multiple);
}

static void test_sizes_from_far_smaller_to_far_larger(void)
{
    uint64_t seed = 2;

    checked = multiple = 0;
    for (int shift = 4; shift <= 28; shift += 4)
        for (int64_t reach = 4; reach <= (int64_t)1 << 30; reach *= 8) {
            int64_t const half = (int64_t)1 << shift;
            try_triangles(&seed, 60, half, reach, 1);
            try_triangles(&seed, 60, half, reach, half > reach ? 1 : half);
        }
    check_batch();
    TEST_ASSERT_GREATER_THAN(2000, checked);
    TEST_ASSERT_GREATER_THAN(500, multiple);
}

/* The largest numbers that the bit budget allows. */
static void test_extremes(void)
{
    /* differences stay below 2^31 for a pair of such corners: */
    int64_t const most = 1610612735, half = (int64_t)1 << 28;

    checked = 0;
    for (int n = 0; n < 729; n++) {
        int64_t p[3][3], fits = 1;
        for (int i = 0, k = n * 27 + n / 27; i < 9; i++, k /= 3)
            p[i / 3][i % 3] = (k % 3 - 1) * (i % 2 ? most / 2 : most * 2 / 3);
        for (int a = 0; a < 3; a++)
            for (int c = 0; c < 3; c++) {
                int64_t const d = p[c][a] - p[(c + 1) % 3][a];
                fits &= d < INT32_MAX && d > -INT32_MAX;
            }
        if (fits) check_children(p, half);
    }
    check_batch();
    TEST_ASSERT_GREATER_THAN(50, checked);
}

/* Two octants that lie side by side: one axis alone distinguishes them. */
static void test_pairs_are_neighbours(void)
{
    for (uint32_t mask = 1; mask < 256; mask++) {
        int want = 0;
        for (uint32_t o = 0; o < 8; o++)
            for (uint32_t a = 0; a < 3; a++) want |= mask == (1u << o | 1u << (o ^ 1u << a));
        TEST_ASSERT_EQUAL_INT(want, bvxi_children_are_pair(mask));
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_small_numbers_hit_every_tie);
    RUN_TEST(test_sizes_from_far_smaller_to_far_larger);
    RUN_TEST(test_extremes);
    RUN_TEST(test_pairs_are_neighbours);
    return UNITY_END();
}
