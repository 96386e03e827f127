/* test_hole_lines.c - open edges that lie on each other, against counts of the least steps that they run
 * along. */
#include "bitvox_io.h"
#include "tools/mesh_maker.h"
#include "winding/holes.h"
#include "suite.h"

enum { EDGES = 300, SIDE = 8, PLACES = SIDE * SIDE * SIDE, STEPS = EDGES * SIDE };

static uint64_t seed = 5;
static int32_t place[PLACES][3];
static bvxi_snapped snapped;

/* A step from a place of the grid to the next on a line, and how often it is run along. */
typedef struct line_step {
    int32_t at[3], d[3], net, all;
} line_step;

static line_step steps[2][STEPS];
static size_t step_count[2];

void setUp(void)
{
    suite_open(0);
    for (int32_t i = 0; i < PLACES; i++) {
        place[i][0] = i % SIDE;
        place[i][1] = i / SIDE % SIDE;
        place[i][2] = i / SIDE / SIDE;
    }
    snapped.xyz = &place[0][0];
    snapped.vertex_count = PLACES;
}

void tearDown(void)
{
    suite_close();
}

static int32_t divisor_of(const int32_t d[3])
{
    int32_t n = SIDE;

    while (d[0] % n != 0 || d[1] % n != 0 || d[2] % n != 0) n--;
    return n;
}

static void count_step(int list, const int32_t at[3], const int32_t d[3], int32_t net)
{
    size_t i = 0;

    while (i < step_count[list] &&
           (memcmp(steps[list][i].at, at, 12) != 0 || memcmp(steps[list][i].d, d, 12) != 0))
        i++;
    if (i == step_count[list]) {
        memset(&steps[list][i], 0, sizeof steps[list][i]);
        memcpy(steps[list][i].at, at, 12);
        memcpy(steps[list][i].d, d, 12);
        step_count[list]++;
    }
    steps[list][i].net += net;
    steps[list][i].all++;
}

static void count_steps(int list, const uint64_t *edges, uint64_t count)
{
    step_count[list] = 0;
    for (uint64_t e = 0; e < count; e++) {
        const int32_t *low = place[edges[e] >> 32], *high = place[(uint32_t)edges[e]];
        int32_t net = 1, at[3], d[3], n;

        if (edges[e] >> 32 > (uint32_t)edges[e]) { /* places are in order along any line */
            const int32_t *const other = low;
            low = high;
            high = other;
            net = -1;
        }
        for (int a = 0; a < 3; a++) d[a] = high[a] - low[a];
        n = divisor_of(d);
        for (int32_t k = 0; k < n; k++) {
            for (int a = 0; a < 3; a++) at[a] = low[a] + d[a] / n * k;
            int32_t const one[3] = {d[0] / n, d[1] / n, d[2] / n};
            count_step(list, at, one, net);
        }
    }
}

static const line_step *step_like(int list, const line_step *s)
{
    for (size_t i = 0; i < step_count[list]; i++)
        if (memcmp(steps[list][i].at, s->at, 12) == 0 && memcmp(steps[list][i].d, s->d, 12) == 0)
            return &steps[list][i];
    return NULL;
}

/* Nothing is left that runs both ways, or with odd_once twice, and the rest is as it was. */
static void assert_cancelled(const uint64_t *given, uint64_t count, int odd_once)
{
    uint64_t *left = NULL, n = count;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "edges", &left));
    memcpy(left, given, (size_t)count * 8);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_cancel_lines(ctx, &snapped, odd_once, &left, &n));
    TEST_ASSERT_TRUE(n <= count);
    count_steps(0, given, count);
    count_steps(1, left, n);
    for (size_t i = 0; i < step_count[0]; i++) {
        const line_step *const s = &steps[0][i], *const t = step_like(1, s);
        int32_t const want = odd_once ? s->net & 1 : s->net;

        TEST_ASSERT_EQUAL_INT32(want < 0 ? -want : want, t == NULL ? 0 : t->all);
        if (t != NULL && !odd_once) TEST_ASSERT_EQUAL_INT32(want, t->net);
        if (t != NULL) TEST_ASSERT_EQUAL_INT32(t->all, t->net < 0 ? -t->net : t->net);
    }
    for (size_t i = 0; i < step_count[1]; i++) TEST_ASSERT_NOT_NULL(step_like(0, &steps[1][i]));
    bvxi_free(ctx, left, n * 8);
}

/* Along few lines, so that many lie on each other; in the first trials along all. */
static uint64_t random_edge(int32_t trial)
{
    for (;;) {
        uint64_t const a = (uint64_t)maker_below(&seed, PLACES);
        int32_t to[3];
        int32_t const axis = maker_below(&seed, 7) + 1, n = maker_below(&seed, SIDE);
        uint64_t b = (uint64_t)maker_below(&seed, PLACES);

        if (trial % 3 != 0) { /* an axis or a diagonal near the corner */
            for (int k = 0; k < 3; k++)
                to[k] = place[a][k] % (1 + trial % 4) + ((axis >> k & 1) != 0 ? n : 0);
            if (to[0] >= SIDE || to[1] >= SIDE || to[2] >= SIDE) continue;
            b = (uint64_t)(to[0] + SIDE * (to[1] + SIDE * to[2]));
            for (int k = 0; k < 3; k++) to[k] = place[a][k] % (1 + trial % 4);
            uint64_t const from = (uint64_t)(to[0] + SIDE * (to[1] + SIDE * to[2]));
            if (from != b) return maker_below(&seed, 2) != 0 ? from << 32 | b : b << 32 | from;
        } else if (a != b) {
            return a << 32 | b;
        }
    }
}

static void test_random_edges_keep_what_does_not_cancel(void)
{
    static uint64_t edges[EDGES];

    for (int32_t trial = 0; trial < 60; trial++) {
        uint64_t const count = 1 + (uint64_t)maker_below(&seed, trial % 2 != 0 ? EDGES : 20);

        for (uint64_t i = 0; i < count; i++) edges[i] = random_edge(trial);
        assert_cancelled(edges, count, 0);
        assert_cancelled(edges, count, 1);
    }
}

/* The farthest places that are snapped to: directions of 31 bits, moments of 62. */
static void test_the_farthest_places(void)
{
    int32_t const most = (1 << 30) - 1;
    uint64_t const given[3] = {(uint64_t)0 << 32 | 2, (uint64_t)1 << 32 | 0, (uint64_t)2 << 32 | 1};
    uint64_t *edges = NULL, count = 3;

    for (int k = 0; k < 3; k++) {
        place[0][k] = k == 1 ? most : -most;
        place[1][k] = 0;
        place[2][k] = k == 1 ? -most : most;
        place[3][k] = k == 1 ? -most : most - 1;
    }
    for (uint32_t other = 2; other < 4; other++) {
        count = 3;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_SCRATCH, 24, "edges", &edges));
        memcpy(edges, given, 24);
        edges[0] = other;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_cancel_lines(ctx, &snapped, 0, &edges, &count));
        TEST_ASSERT_EQUAL_UINT64(other == 2 ? 0 : 3, count);
        bvxi_free(ctx, edges, count * 8);
    }
}

/* Both ways in part: what remains keeps its direction; where nothing cancels edges stay as they are. */
static void test_by_hand(void)
{
    uint64_t const given[4] = {(uint64_t)0 << 32 | 7, (uint64_t)5 << 32 | 3, (uint64_t)8 << 32 | 9,
                               (uint64_t)9 << 32 | 11};
    uint64_t *edges = NULL, count = 4;
    uint64_t const want[4] = {(uint64_t)0 << 32 | 3, (uint64_t)5 << 32 | 7, given[2], given[3]};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_SCRATCH, 32, "edges", &edges));
    memcpy(edges, given, 32);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_cancel_lines(ctx, &snapped, 0, &edges, &count));
    TEST_ASSERT_EQUAL_UINT64(4, count);
    for (int i = 0; i < 4; i++) {
        int there = 0;
        for (int k = 0; k < 4; k++) there += edges[k] == want[i];
        TEST_ASSERT_EQUAL_INT(1, there);
    }
    bvxi_free(ctx, edges, count * 8);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_random_edges_keep_what_does_not_cancel);
    RUN_TEST(test_the_farthest_places);
    RUN_TEST(test_by_hand);
    return UNITY_END();
}
