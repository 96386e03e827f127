/* test_components.c - components of runs against a flood over single voxels, for all three connectivities. */
#include "components/room.h"
#include "tools/mesh_maker.h"
#include "suite.h"

static bvx_context *portable;
static uint64_t seed;

void setUp(void)
{
    suite_open(0);
    portable = suite_context(0, BVX_CPU_PORTABLE);
    seed = 77;
}

void tearDown(void)
{
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(portable));
    bvx_context_destroy(portable);
    suite_close();
}

/* ---- Boxes of bytes, and the flood ---- */

typedef struct box {
    int32_t size[3];
    uint8_t *set;
    int32_t *label; /* -1: not set */
    int32_t labels;
} box;

static size_t at(const box *b, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)b->size[1] + (size_t)y) * (size_t)b->size[0] + (size_t)x;
}

static box box_of(int32_t x, int32_t y, int32_t z)
{
    box b = {{0, 0, 0}, NULL, NULL, 0};
    size_t const n = (size_t)x * (size_t)y * (size_t)z;

    b.size[0] = x;
    b.size[1] = y;
    b.size[2] = z;
    b.set = calloc(n, 1);
    b.label = calloc(n, sizeof *b.label);
    TEST_ASSERT_NOT_NULL(b.set);
    TEST_ASSERT_NOT_NULL(b.label);
    return b;
}

static void box_free(box *b)
{
    free(b->set);
    free(b->label);
}

/* Neighbours differ in at most one (6), two (18) or three (26) of their indices. */
static void flood(box *b, int32_t connectivity)
{
    int32_t const most = connectivity == 6 ? 1 : connectivity == 18 ? 2 : 3;
    size_t const n = (size_t)b->size[0] * (size_t)b->size[1] * (size_t)b->size[2];
    size_t *const stack = malloc((n + 1) * sizeof *stack);

    TEST_ASSERT_NOT_NULL(stack);
    b->labels = 0;
    for (size_t i = 0; i < n; i++) b->label[i] = -1;
    for (size_t first = 0; first < n; first++) {
        size_t used = 0;
        if (!b->set[first] || b->label[first] >= 0) continue;
        b->label[first] = b->labels;
        stack[used++] = first;
        while (used > 0) {
            size_t const i = stack[--used], row = i / (size_t)b->size[0];
            int32_t const x = (int32_t)(i % (size_t)b->size[0]), y = (int32_t)(row % (size_t)b->size[1]);
            int32_t const z = (int32_t)(row / (size_t)b->size[1]);
            for (int32_t d = 0; d < 27; d++) {
                int32_t const dx = d % 3 - 1, dy = d / 3 % 3 - 1, dz = d / 9 - 1;
                int32_t const u = x + dx, v = y + dy, w = z + dz;
                if ((dx != 0) + (dy != 0) + (dz != 0) > most) continue;
                if (u < 0 || v < 0 || w < 0 || u >= b->size[0] || v >= b->size[1] || w >= b->size[2])
                    continue;
                size_t const j = at(b, u, v, w);
                if (!b->set[j] || b->label[j] >= 0) continue;
                b->label[j] = b->labels;
                stack[used++] = j;
            }
        }
        b->labels++;
    }
    free(stack);
}

/* ---- Runs of a box ---- */

static void add_rows(const box *b, bvxi_components *c)
{
    int32_t const words = bvxi_row_words(b->size[0]);

    for (int32_t z = 0; z < b->size[2]; z++)
        for (int32_t y = 0; y < b->size[1]; y++) {
            uint64_t *const row = bvxi_components_row(c, y, z);
            memset(row, 0, (size_t)words * 8);
            for (int32_t x = 0; x < b->size[0]; x++)
                row[x >> 6] |= (uint64_t)b->set[at(b, x, y, z)] << (x & 63);
            bvxi_components_add(c, y, z);
        }
}

/* Labels of the runs in the order of their voxels; NULL counts. */
static uint64_t runs_of(const box *b, int32_t *labels)
{
    uint64_t n = 0;

    for (int32_t z = 0; z < b->size[2]; z++)
        for (int32_t y = 0; y < b->size[1]; y++)
            for (int32_t x = 0; x < b->size[0]; x++) {
                if (!b->set[at(b, x, y, z)] || (x > 0 && b->set[at(b, x - 1, y, z)])) continue;
                if (labels != NULL) labels[n] = b->label[at(b, x, y, z)];
                n++;
            }
    return n;
}

static void expect_flood(box *b)
{
    static const int32_t kinds[3] = {BVXI_CONNECT_6, BVXI_CONNECT_18, BVXI_CONNECT_26};
    uint64_t const count = runs_of(b, NULL);
    int32_t *const want = malloc((size_t)(count + 1) * sizeof *want);

    TEST_ASSERT_NOT_NULL(want);
    for (int k = 0; k < 6; k++) {
        bvx_context *const with = k < 3 ? ctx : portable;
        bvxi_components c;
        flood(b, kinds[k % 3]);
        runs_of(b, want);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_components_open(with, "test", kinds[k % 3], b->size, count, &c));
        add_rows(b, &c);
        bvxi_components_number(&c);
        TEST_ASSERT_EQUAL_UINT64((uint64_t)b->labels, c.component_count);
        for (uint64_t i = 0; i < count; i++) TEST_ASSERT_EQUAL_UINT32((uint32_t)want[i], c.label[i]);
        bvxi_components_free(&c);
    }
    free(want);
}

static void scatter(box *b, int32_t percent)
{
    size_t const n = (size_t)b->size[0] * (size_t)b->size[1] * (size_t)b->size[2];
    for (size_t i = 0; i < n; i++) b->set[i] = maker_below(&seed, 100) < percent;
}

/* ---- Tests ---- */

static void test_components_equal_a_flood(void)
{
    static const int32_t sides[7] = {1, 63, 64, 65, 127, 128, 129}, percents[7] = {0, 2, 10, 31, 50, 80, 100};

    for (int s = 0; s < 7; s++)
        for (int p = 0; p < 7; p++) {
            box b = box_of(sides[s], 1 + maker_below(&seed, 9), 1 + maker_below(&seed, 9));
            scatter(&b, percents[p]);
            expect_flood(&b);
            box_free(&b);
        }
}

/* Shapes whose parts meet late, so that trees of runs are joined deep down: combs, spirals, shells. */
static void test_components_join_what_meets_late(void)
{
    for (int32_t turn = 0; turn < 3; turn++) {
        box b = box_of(33, 31, 9);
        for (int32_t z = 0; z < 9; z++)
            for (int32_t y = 0; y < 31; y++)
                for (int32_t x = 0; x < 33; x++) {
                    int32_t const ring = y < 30 - y ? y : 30 - y;
                    int32_t const side = x < 32 - x ? x : 32 - x;
                    int32_t const r = ring < side ? ring : side;
                    int32_t set = 0;
                    /* teeth joined at the last slice */
                    if (turn == 0) set = z == 8 || (x % 2 == 0 && y % 2 == 0);
                    /* a spiral of open rings */
                    if (turn == 1) set = r % 2 == 0 && !(x == r && y == r + 1 && r < 14);
                    /* touches across edges only */
                    if (turn == 2) set = (x + y + z) % 2 == 0;
                    b.set[at(&b, x, y, z)] = (uint8_t)set;
                }
        expect_flood(&b);
        box_free(&b);
    }
}

/* Voxels that touch across a face, an edge, a corner, and not at all: on
 * each side, also where rows and slices wrap. */
static void test_components_of_two_voxels(void)
{
    box b = box_of(4, 4, 4);

    for (int32_t i = 0; i < 64; i++)
        for (int32_t j = 0; j < i; j++) {
            memset(b.set, 0, 64);
            b.set[i] = b.set[j] = 1;
            expect_flood(&b);
        }
    box_free(&b);
}

/* Rows and slices without a run between those that have some. */
static void test_components_pass_over_gaps(void)
{
    for (int round = 0; round < 40; round++) {
        box b = box_of(5 + maker_below(&seed, 70), 12, 12);
        scatter(&b, 40);
        for (int32_t z = 0; z < 12; z++)
            for (int32_t y = 0; y < 12; y++)
                if (maker_below(&seed, 3) == 0 || z % 5 == round % 5)
                    memset(b.set + at(&b, 0, y, z), 0, (size_t)b.size[0]);
        expect_flood(&b);
        box_free(&b);
    }
}

static void test_components_keep_to_their_memory(void)
{
    static const int32_t size[3] = {8, 3, 1000};
    bvxi_components c;

    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_components_open(ctx, "test", BVXI_CONNECT_6, size, 3000, &c));
    /* five rows of a word, with a word on either side */
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= 3000 * 4 + 3 * 5 * 24);
    for (int32_t z = 0; z < 1000; z++)
        for (int32_t y = 0; y < 3; y++) {
            *bvxi_components_row(&c, y, z) = 0xff;
            bvxi_components_add(&c, y, z);
        }
    bvxi_components_number(&c);
    TEST_ASSERT_EQUAL_UINT64(1, c.component_count);
    TEST_ASSERT_EQUAL_UINT64(3000, c.added);
    bvxi_components_free(&c);
    bvxi_components_free(&c);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_components_open(ctx, "test", BVXI_CONNECT_26, size, 0, &c));
    bvxi_components_number(&c);
    TEST_ASSERT_EQUAL_UINT64(0, c.component_count);
    bvxi_components_free(&c);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                            bvxi_components_open(ctx, "test", BVXI_CONNECT_6, size, UINT32_MAX, &c));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "4294967295 runs"));
}

static void test_highest_is_the_highest_bit(void)
{
    for (int32_t i = 0; i < 64; i++) {
        uint64_t const bit = UINT64_C(1) << i;
        TEST_ASSERT_EQUAL_INT32(i, bvxi_highest(bit));
        TEST_ASSERT_EQUAL_INT32(i, bvxi_highest(bit | (maker_random(&seed) & (bit - 1))));
    }
}

static void test_run_changes_mark_begins_and_ends(void)
{
    for (int round = 0; round < 200; round++) {
        uint64_t words[3], last = 0;
        int before = 0;
        for (int k = 0; k < 3; k++) {
            words[k] = round % 4 == 0 ? ~UINT64_C(0) : maker_random(&seed);
            if (round % 4 == 1) words[k] |= maker_random(&seed);
        }
        for (int k = 0; k < 3; k++) {
            uint64_t const changes = bvxi_run_changes(words[k], &last);
            for (int i = 0; i < 64; i++) {
                int const bit = (int)(words[k] >> i & 1);
                TEST_ASSERT_EQUAL_INT(bit != before, (int)(changes >> i & 1));
                before = bit;
            }
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_components_equal_a_flood);
    RUN_TEST(test_components_join_what_meets_late);
    RUN_TEST(test_components_of_two_voxels);
    RUN_TEST(test_components_pass_over_gaps);
    RUN_TEST(test_components_keep_to_their_memory);
    RUN_TEST(test_highest_is_the_highest_bit);
    RUN_TEST(test_run_changes_mark_begins_and_ends);
    return UNITY_END();
}
