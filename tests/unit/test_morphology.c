/* test_morphology.c - dilation, erosion, opening, closing and hollowing
 * against voxel by voxel; BVX_QUICK makes it shorter. */
#include "morph_support.h"

enum { DILATE = BVX_MORPH_DILATE, ERODE, OPEN, CLOSE };

static bvx_morph_options steps_of(int32_t neighbourhood, int32_t steps, int32_t beyond)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    o.neighbourhood = neighbourhood != 0 ? neighbourhood : BVX_BALL;
    o.steps = steps;
    o.beyond = beyond;
    return o;
}

static bvx_morph_options ball_of(double radius, int32_t beyond)
{
    bvx_morph_options o = steps_of(0, 1, beyond);
    o.radius = radius;
    return o;
}

/* ---- The oracle: bytes in a box that is wide enough for what lies beyond ---- */

typedef struct wide_box {
    int32_t size[3], room;
    uint8_t *set, *spare;
    int32_t beyond;
} wide_box;

static size_t wide_at(const wide_box *b, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)b->size[1] + (size_t)y) * (size_t)b->size[0] + (size_t)x;
}

static wide_box wide_of(const bvx_grid *g, int32_t room, int32_t beyond)
{
    wide_box b;
    size_t n = 1;

    b.room = room;
    b.beyond = beyond;
    for (int a = 0; a < 3; a++) n *= (size_t)(b.size[a] = g->size[a] + 2 * room);
    b.set = room_for(n, 1);
    b.spare = room_for(n, 1);
    memset(b.set, beyond, n);
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                b.set[wide_at(&b, x + room, y + room, z + room)] = (uint8_t)bvx_grid_get(g, x, y, z);
    return b;
}

static void wide_free(wide_box *b)
{
    free(b->set);
    free(b->spare);
}

/* Offsets of one step, or of the ball. */
static int in_reach(const bvx_morph_options *o, const double s[3], int32_t dx, int32_t dy, int32_t dz)
{
    int32_t const axes = (dx != 0) + (dy != 0) + (dz != 0);
    if (o->neighbourhood == BVX_BALL) {
        double const x = dx * s[0], y = dy * s[1], z = dz * s[2];
        return x * x + y * y + z * z <= o->radius * o->radius * (1.0 + 1e-12);
    }
    if (dx * dx > 1 || dy * dy > 1 || dz * dz > 1) return 0;
    return axes <= (o->neighbourhood == 6 ? 1 : o->neighbourhood == 18 ? 2 : 3);
}

/* What any offset finds that equals value makes the voxel so. */
static void wide_step(wide_box *b, const bvx_morph_options *o, const double s[3], int value)
{
    int32_t offset[4096][3], count = 0, reach[3] = {1, 1, 1};
    uint8_t *made = b->spare;

    for (int a = 0; a < 3 && o->neighbourhood == BVX_BALL; a++) reach[a] = (int32_t)(o->radius / s[a]) + 1;
    for (int32_t dz = -reach[2]; dz <= reach[2]; dz++)
        for (int32_t dy = -reach[1]; dy <= reach[1]; dy++)
            for (int32_t dx = -reach[0]; dx <= reach[0]; dx++)
                if (in_reach(o, s, dx, dy, dz)) {
                    TEST_ASSERT_TRUE(count < 4096);
                    offset[count][0] = dx;
                    offset[count][1] = dy;
                    offset[count++][2] = dz;
                }
    for (int32_t z = 0; z < b->size[2]; z++)
        for (int32_t y = 0; y < b->size[1]; y++)
            for (int32_t x = 0; x < b->size[0]; x++) {
                int found = 0;
                for (int32_t i = 0; i < count && !found; i++) {
                    int32_t const u = x + offset[i][0], v = y + offset[i][1], w = z + offset[i][2];
                    int const inside = u >= 0 && v >= 0 && w >= 0 && u < b->size[0] && v < b->size[1] &&
                                       w < b->size[2];
                    found = (inside ? b->set[wide_at(b, u, v, w)] : b->beyond) == value;
                }
                made[wide_at(b, x, y, z)] = (uint8_t)(found ? value : !value);
            }
    b->spare = b->set;
    b->set = made;
}

static void expect_voxel_by_voxel(int operation, const bvx_morph_options *o)
{
    const double *const s = grid.lattice.spacing;
    double least = s[0] < s[1] ? s[0] : s[1];

    if (s[2] < least) least = s[2];
    int32_t const reach = o->neighbourhood != BVX_BALL ? o->steps : (int32_t)(o->radius / least) + 1;
    wide_box b = wide_of(&grid, 2 * reach + 1, o->beyond);
    bvx_grid result = {0};
    int32_t wrong = 0;
    for (int part = 0; part < (operation < OPEN ? 1 : 2); part++)
        for (int32_t i = 0; i < o->steps; i++)
            wide_step(&b, o, s, (operation == ERODE || operation == OPEN) ? part : !part);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_morph(ctx, &grid, operation, o, &result));
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                wrong += bvx_grid_get(&result, x, y, z) !=
                         b.set[wide_at(&b, x + b.room, y + b.room, z + b.room)];
    TEST_ASSERT_EQUAL_INT32(0, wrong);
    for (size_t row = 0; row < (size_t)result.size[1] * (size_t)result.size[2] && result.size[0] % 64 != 0;
         row++)
        TEST_ASSERT_EQUAL_HEX64(0, result.words[(row + 1) * (size_t)result.words_per_row - 1] >>
                                       (result.size[0] % 64));
    bvx_grid_free(ctx, &result);
    wide_free(&b);
}

/* ---- Small things ---- */

static bvx_grid made_by(int operation, const bvx_grid *g, const bvx_morph_options *o)
{
    bvx_grid result = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_morph(ctx, g, operation, o, &result));
    return result;
}

static size_t words_of(const bvx_grid *g)
{
    return (size_t)g->words_per_row * (size_t)g->size[1] * (size_t)g->size[2];
}

static int is_part(const bvx_grid *a, const bvx_grid *b)
{
    for (size_t i = 0; i < words_of(a); i++)
        if ((a->words[i] & ~b->words[i]) != 0) return 0;
    return 1;
}

static int is_same(const bvx_grid *a, const bvx_grid *b)
{
    return memcmp(a->words, b->words, words_of(a) * 8) == 0;
}

static void complement(bvx_grid *g)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++) bvx_grid_set(g, x, y, z, !bvx_grid_get(g, x, y, z));
}

static uint64_t set_voxels(const bvx_grid *g)
{
    uint64_t n = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, g, &n));
    return n;
}

/* ---- Tests ---- */

static void test_neighbours_of_one_voxel_at_a_word_edge(void)
{
    static const int32_t neighbourhoods[3] = {6, 18, 26};

    open_grid(130, 3, 3, 1, 1, 1);
    bvx_grid_set(&grid, 64, 1, 1, 1);
    for (int i = 0; i < 3; i++) {
        bvx_morph_options const o = steps_of(neighbourhoods[i], 1, 0);
        bvx_grid g = made_by(DILATE, &grid, &o);
        TEST_ASSERT_EQUAL_UINT64(neighbourhoods[i] + 1, set_voxels(&g));
        TEST_ASSERT_TRUE(bvx_grid_get(&g, 63, 1, 1) && bvx_grid_get(&g, 65, 1, 1));
        bvx_grid_free(ctx, &g);
    }
    bvx_grid six = made_by(DILATE, &grid, NULL);
    TEST_ASSERT_EQUAL_UINT64(7, set_voxels(&six));
    bvx_grid_free(ctx, &six);
}

static void test_steps_equal_voxel_by_voxel_at_word_edges(void)
{
    static const int32_t neighbourhoods[3] = {6, 18, 26}, parts[3] = {30, 500, 960};
    int n = 0;

    for (int e = 0; e < 7; e++)
        for (int k = 0; k < 3; k++)
            for (int operation = 0; operation < 4; operation++, n++) {
                bvx_morph_options const o = steps_of(neighbourhoods[k], 1 + n % 3, n / 3 % 2);
                if (quick && n % 7 != 0) continue;
                open_grid(word_edges[e], 1 + maker_below(&seed, 6), 1 + maker_below(&seed, 5), 1, 1, 1);
                scatter(parts[n % 3]);
                expect_voxel_by_voxel(operation, &o);
            }
}

/* More than one sweep, and pieces of slices. */
static void test_many_steps_equal_voxel_by_voxel(void)
{
    static const int32_t steps[4] = {17, 18, 5, 9}; /* by operation */
    for (int i = 0; i < (quick ? 2 : 8); i++) {
        bvx_morph_options const o = steps_of(i % 3 == 0 ? 6 : i % 3 == 1 ? 18 : 26, steps[i % 4], i / 4);
        open_grid(9, 5, i % 2 ? 12 : 50, 1, 1, 1);
        scatter(i / 4 ? 998 : 2);
        expect_voxel_by_voxel(i % 4, &o);
    }
}

static void test_balls_equal_voxel_by_voxel(void)
{
    static const double spacings[3][3] = {{1, 1, 1}, {0.1, 0.1, 0.1}, {1, 0.5, 2}};
    static const double radii[4] = {1, 1.5, 2.6, 2.3};
    int n = 0;

    for (int k = 0; k < 3; k++)
        for (int r = 0; r < 4; r++)
            for (int operation = 0; operation < 4; operation++, n++) {
                const double *const s = spacings[k];
                bvx_morph_options const o = ball_of(radii[r] * s[0], n / 4 % 2);
                if (quick && n % 5 != 0) continue;
                open_grid(word_edges[n % 7] / 2 + 1, 1 + maker_below(&seed, 9), 1 + maker_below(&seed, 9),
                          s[0], s[1], s[2]);
                if (n % 2) scatter(operation == ERODE || operation == OPEN ? 970 : 30);
                else scatter_balls(5, 6);
                expect_voxel_by_voxel(operation, &o);
            }
}

/* A ball is a threshold of distances; radii from 2 to 70 take one way and the other. */
static void test_balls_equal_distances(void)
{
    static const double radii[4] = {2.0, 20.0, 40.0, 70.0};

    for (int i = 0; i < (quick ? 4 : 16); i++) {
        int32_t const erode = i / 4 % 2, beyond = i % 3 == 0;
        double const r = radii[i % 4];
        open_grid(129, 33, 40, 1, 1, i < 8 ? 1 : 0.75);
        scatter(erode ? 1000 : 0);
        for (int k = 0; k < 4; k++)
            bvx_grid_set(&grid, maker_below(&seed, 129), maker_below(&seed, 33), maker_below(&seed, 40),
                         !erode);
        size_t const n = voxels_of(&grid);
        double *const d = room_for(n, sizeof *d);
        bvx_morph_options const o = ball_of(r, beyond);
        bvx_distance_options far = {.struct_size = sizeof far};
        far.side = erode ? BVX_DISTANCE_INSIDE : BVX_DISTANCE_OUTSIDE;
        far.beyond = beyond ? BVX_BEYOND_SET : BVX_BEYOND_EMPTY;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &far, BVX_F64, d, n));
        bvx_grid g = made_by(erode ? ERODE : DILATE, &grid, &o);
        for (size_t k = 0; k < n; k++) {
            int const within = d[k] <= r;
            TEST_ASSERT_EQUAL_INT(
                within != erode,
                bvx_grid_get(&g, (int32_t)(k % 129), (int32_t)(k / 129 % 33), (int32_t)(k / 129 / 33)));
        }
        bvx_grid_free(ctx, &g);
        free(d);
    }
}

static void test_a_ball_of_one_voxel_is_a_cross(void)
{
    open_grid(70, 9, 9, 0.1, 0.1, 0.1);
    scatter(50);
    bvx_morph_options const ball = ball_of(0.1, 0), point = ball_of(0.0, 0), three = ball_of(0.3, 0);
    bvx_grid a = made_by(DILATE, &grid, &ball);
    bvx_grid b = made_by(DILATE, &grid, NULL);
    bvx_grid c = made_by(ERODE, &grid, &point);
    TEST_ASSERT_TRUE(is_same(&a, &b));
    TEST_ASSERT_TRUE(is_same(&c, &grid));
    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
    bvx_grid_free(ctx, &c);
    open_grid(9, 1, 1, 0.1, 0.1, 0.1);
    bvx_grid_set(&grid, 4, 0, 0, 1);
    a = made_by(DILATE, &grid, &three);
    TEST_ASSERT_EQUAL_UINT64(7, set_voxels(&a)); /* 3 * 0.1 is a little more than 0.3 */
    bvx_grid_free(ctx, &a);
}

static void test_identities(void)
{
    for (int i = 0; i < (quick ? 4 : 16); i++) {
        int32_t const beyond = i % 2;
        bvx_morph_options o = i % 4 == 3 ? ball_of(2.3, beyond)
                                         : steps_of(i % 4 == 0   ? 6
                                                    : i % 4 == 1 ? 18
                                                                 : 26,
                                                    1 + i % 5, beyond);
        open_grid(word_edges[i % 7], 20, 20, 1, 1, 1);
        scatter_balls(12, 8);
        bvx_grid opened = made_by(OPEN, &grid, &o);
        bvx_grid closed = made_by(CLOSE, &grid, &o);
        bvx_grid eroded = made_by(ERODE, &grid, &o);
        bvx_grid dilated = made_by(DILATE, &grid, &o), again = made_by(OPEN, &opened, &o);
        TEST_ASSERT_TRUE(is_part(&eroded, &opened) && is_part(&opened, &grid) && is_part(&grid, &closed) &&
                         is_part(&closed, &dilated));
        /* with beyond 1 what was opened ends in another outside */
        if (beyond == 0) TEST_ASSERT_TRUE(is_same(&again, &opened));
        complement(&grid);
        o.beyond = !beyond;
        bvx_grid dual = made_by(DILATE, &grid, &o), dual_open = made_by(CLOSE, &grid, &o);
        complement(&dual);
        complement(&dual_open);
        TEST_ASSERT_TRUE(is_same(&dual, &eroded));
        TEST_ASSERT_TRUE(is_same(&dual_open, &opened));
        bvx_grid_free(ctx, &opened);
        bvx_grid_free(ctx, &closed);
        bvx_grid_free(ctx, &eroded);
        bvx_grid_free(ctx, &dilated);
        bvx_grid_free(ctx, &again);
        bvx_grid_free(ctx, &dual);
        bvx_grid_free(ctx, &dual_open);
    }
}

/* The grid moved by whole voxels, for all that lies far enough from the sides. */
static void test_moving_the_set_moves_the_result(void)
{
    bvx_grid first = {0}, moved = {0};
    int32_t const by[3] = {61, 5, 3};

    for (int i = 0; i < 4; i++) {
        bvx_morph_options const o = i == 3 ? ball_of(3.0, 0) : steps_of(i == 0 ? 6 : i == 1 ? 18 : 26, 3, 0);
        open_grid(200, 24, 24, 1, 1, 1);
        for (int k = 0; k < 300; k++)
            bvx_grid_set(&grid, 10 + maker_below(&seed, 60), 7 + maker_below(&seed, 5),
                         7 + maker_below(&seed, 7), 1);
        first = made_by(CLOSE, &grid, &o);
        for (int32_t z = grid.size[2] - 1; z >= 0; z--)
            for (int32_t y = grid.size[1] - 1; y >= 0; y--)
                for (int32_t x = grid.size[0] - 1; x >= 0; x--)
                    bvx_grid_set(&grid, x, y, z,
                                 x >= by[0] && y >= by[1] && z >= by[2] &&
                                     bvx_grid_get(&grid, x - by[0], y - by[1], z - by[2]));
        moved = made_by(CLOSE, &grid, &o);
        for (int32_t z = by[2]; z < grid.size[2]; z++)
            for (int32_t y = by[1]; y < grid.size[1]; y++)
                for (int32_t x = by[0]; x < grid.size[0]; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&first, x - by[0], y - by[1], z - by[2]),
                                          bvx_grid_get(&moved, x, y, z));
        bvx_grid_free(ctx, &first);
        bvx_grid_free(ctx, &moved);
    }
}

static void test_threads_and_processors_do_not_show(void)
{
    static const int32_t threads[4] = {1, 2, 3, 8};

    for (int i = 0; i < 6; i++) {
        bvx_morph_options const o = i % 2 ? ball_of(3.7, 0) : steps_of(i == 0 ? 6 : i == 2 ? 18 : 26, 3, 0);
        int const operation = i % 4;
        uint64_t want = 0, got = 0;
        open_grid(129, 64, quick ? 20 : 90, 1, 1, 1);
        scatter_balls(20, 9);
        for (int t = 0; t < 5; t++) {
            bvx_context *const other = suite_context(t == 0 ? 1 : threads[t - 1],
                                                     t == 0 ? BVX_CPU_PORTABLE : BVX_CPU_BEST);
            bvx_grid g = {0};
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_morph(other, &grid, operation, &o, &g));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(other, &g, t == 0 ? &want : &got));
            if (t > 0) TEST_ASSERT_EQUAL_HEX64(want, got);
            bvx_grid_free(other, &g);
            bvx_context_destroy(other);
        }
    }
}

static void test_windows_with_a_halo_equal_the_whole(void)
{
    for (int i = 0; i < 8; i++) {
        bvx_morph_options const o = i < 4 ? steps_of(18, 2, 0) : ball_of(2.9, 0);
        int32_t const halo = i % 4 < 2 ? (i < 4 ? 2 : 3) : (i < 4 ? 4 : 6); /* one operation or two */
        bvx_window w;
        bvx_grid cut = {0}, part = {0}, whole = {0};
        open_grid(150, 30, 30, 1, 1, 1);
        scatter_balls(30, 8);
        for (int a = 0; a < 3; a++) {
            w.size[a] = 2 * halo + 1 + maker_below(&seed, grid.size[a] - 2 * halo);
            w.low[a] = maker_below(&seed, grid.size[a] - w.size[a] + 1);
        }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &grid.lattice, &w, &cut));
        for (int32_t z = 0; z < w.size[2]; z++)
            for (int32_t y = 0; y < w.size[1]; y++)
                for (int32_t x = 0; x < w.size[0]; x++)
                    bvx_grid_set(&cut, x, y, z,
                                 bvx_grid_get(&grid, x + w.low[0], y + w.low[1], z + w.low[2]));
        whole = made_by(i % 4, &grid, &o);
        part = made_by(i % 4, &cut, &o);
        for (int32_t z = halo; z < w.size[2] - halo; z++)
            for (int32_t y = halo; y < w.size[1] - halo; y++)
                for (int32_t x = halo; x < w.size[0] - halo; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole, x + w.low[0], y + w.low[1], z + w.low[2]),
                                          bvx_grid_get(&part, x, y, z));
        bvx_grid_free(ctx, &cut);
        bvx_grid_free(ctx, &part);
        bvx_grid_free(ctx, &whole);
    }
}

static void test_words_of_the_callers(void)
{
    uint64_t words[2 * 9];
    bvx_grid g = {0};

    open_grid(70, 3, 3, 1, 1, 1);
    bvx_grid_set(&grid, 3, 1, 1, 1);
    g.words = words;
    g.word_capacity = 17;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_grid_morph(ctx, &grid, BVX_MORPH_DILATE, NULL, &g));
    g.word_capacity = 18;
    memset(words, 0xAA, sizeof words);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_morph(ctx, &grid, BVX_MORPH_DILATE, NULL, &g));
    TEST_ASSERT_EQUAL_UINT64(7, set_voxels(&g));
}

static void test_what_morphology_refuses(void)
{
    bvx_grid g = {0}, same;
    bvx_morph_options o;

    open_grid(4, 4, 4, 1, 1, 1);
    same = grid;
    for (int k = 0; k < 4; k++) {
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_morph(NULL, &grid, k, NULL, &g));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_morph(ctx, NULL, k, NULL, &g));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_morph(ctx, &grid, k, NULL, NULL));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_morph(ctx, &grid, k, NULL, &same));
        for (int bad = 0; bad < 9; bad++) {
            o = steps_of(6, 1, 0);
            if (bad == 0) o.neighbourhood = 7;
            if (bad == 1) o.steps = -1;
            if (bad == 2) o.steps = 65537;
            if (bad == 3) o.radius = 1.0;
            if (bad == 4) o.beyond = 2;
            if (bad == 5) o.reserved = 1;
            if (bad == 6) o = ball_of(-1.0, 0);
            if (bad == 7) o = ball_of((double)INFINITY, 0);
            if (bad == 8) {
                o = ball_of(1.0, 0);
                o.steps = 2;
            }
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_morph(ctx, &grid, k, &o, &g));
            TEST_ASSERT_NULL(g.words);
        }
    }
    o = ball_of(1e12, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, bvx_grid_morph(ctx, &grid, BVX_MORPH_CLOSE, &o, &g));
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvx_grid_morph(ctx, &grid, BVX_MORPH_OPEN, &o, &g)); /* needs nothing beyond the window */
    bvx_grid_free(ctx, &g);
}

/* ---- Hollow ---- */

static bvx_hollow_options hollow_of(double thickness, bvx_hollow_report *report)
{
    bvx_hollow_options o = {.struct_size = sizeof o};
    o.thickness = thickness;
    o.report = report;
    return o;
}

static void test_hollow_takes_what_is_deeper(void)
{
    bvx_hollow_report report;

    for (int i = 0; i < 4; i++) {
        bvx_hollow_options o = hollow_of(2.0, &report);
        bvx_grid shell = {0}, inner = {0};
        bvx_morph_options const ball = ball_of(2.0, i % 2);
        open_grid(70, 30, 30, 1, 1, i < 2 ? 1 : 0.5);
        scatter_balls(12, 12);
        o.beyond = i % 2;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hollow(ctx, &grid, &o, &shell));
        inner = made_by(ERODE, &grid, &ball);
        for (size_t k = 0; k < words_of(&grid); k++)
            TEST_ASSERT_EQUAL_HEX64(grid.words[k] & ~inner.words[k], shell.words[k]);
        TEST_ASSERT_EQUAL_UINT64(set_voxels(&inner), report.hollowed);
        TEST_ASSERT_TRUE(report.hollowed > 0 && report.drained == 0);
        bvx_grid_free(ctx, &shell);
        bvx_grid_free(ctx, &inner);
    }
}

/* A box of 20 x 12 x 10 voxels at 5, 4, 3 with walls of two voxels; the hole from each side. */
static void test_hollow_drains_from_any_side(void)
{
    static const int32_t low[3] = {5, 4, 3}, side[3] = {20, 12, 10};

    open_grid(30, 20, 16, 1, 1, 1);
    for (int32_t z = 0; z < side[2]; z++)
        for (int32_t y = 0; y < side[1]; y++)
            for (int32_t x = 0; x < side[0]; x++) bvx_grid_set(&grid, x + low[0], y + low[1], z + low[2], 1);
    for (int32_t s = 0; s < 6; s++)
        for (int placed = 0; placed < 2; placed++) {
            int32_t const axis = s / 2, a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
            bvx_hollow_report report;
            bvx_hollow_options o = hollow_of(2.0, &report);
            bvx_grid shell = {0};
            o.drain_radius = 1.0;
            o.drain_side = 1 << s;
            o.drain_placed = placed;
            o.drain_at[0] = grid.lattice.origin[a] + low[a] + 3.5;
            o.drain_at[1] = grid.lattice.origin[b] + low[b] + 4.5;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hollow(ctx, &grid, &o, &shell));
            TEST_ASSERT_EQUAL_UINT64(16 * 8 * 6, report.hollowed);
            TEST_ASSERT_EQUAL_UINT64(2 * 5, report.drained); /* a cross through a wall of two */
            TEST_ASSERT_EQUAL_UINT64(set_voxels(&grid) - 16 * 8 * 6 - 10, set_voxels(&shell));
            TEST_ASSERT_EQUAL_DOUBLE(grid.lattice.origin[axis] + low[axis] + (s % 2 ? side[axis] - 2.5 : 2.5),
                                     report.drain[axis]);
            if (placed) TEST_ASSERT_EQUAL_DOUBLE(o.drain_at[0], report.drain[a]);
            bvx_grid_free(ctx, &shell);
        }
}

static void test_what_hollow_refuses(void)
{
    bvx_hollow_report report;
    bvx_hollow_options o = hollow_of(0.0, NULL);
    bvx_grid g = {0};

    open_grid(20, 20, 20, 1, 1, 1);
    scatter(1000);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hollow(ctx, &grid, NULL, &g)); /* no thickness */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hollow(NULL, &grid, &o, &g));
    o.thickness = grid.lattice.spacing[0] * 0.75; /* would leave nothing */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_hollow(ctx, &grid, &o, &g));
    TEST_ASSERT_NULL(g.words);
    for (int bad = 0; bad < 9; bad++) {
        bvx_grid same = grid;
        o = hollow_of(1.0, NULL);
        if (bad == 0) o.thickness = -1;
        if (bad == 1) o.drain_radius = -1;
        if (bad == 2) o.drain_side = 3;
        if (bad == 3) o.drain_side = 64;
        if (bad == 4) o.drain_placed = 2;
        if (bad == 5) o.beyond = 2;
        if (bad == 6) o.reserved = 1;
        if (bad >= 7) {
            o.drain_radius = 1.0;
            o.drain_placed = 1;
            /* outside; through the wall only */
            o.drain_at[0] = bad == 7 ? 1e9 : grid.lattice.origin[0] + 0.5;
            o.drain_at[1] = grid.lattice.origin[1] + 0.5;
        }
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hollow(ctx, &grid, &o, &g));
        TEST_ASSERT_NULL(g.words);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hollow(ctx, &grid, &o, &same));
    }
    o = hollow_of(50.0, &report); /* nothing is deep enough: the grid itself */
    o.drain_radius = 2.0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hollow(ctx, &grid, &o, &g));
    TEST_ASSERT_TRUE(is_same(&g, &grid) && report.hollowed == 0 && report.drained == 0);
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_neighbours_of_one_voxel_at_a_word_edge);
    RUN_TEST(test_steps_equal_voxel_by_voxel_at_word_edges);
    RUN_TEST(test_many_steps_equal_voxel_by_voxel);
    RUN_TEST(test_balls_equal_voxel_by_voxel);
    RUN_TEST(test_balls_equal_distances);
    RUN_TEST(test_a_ball_of_one_voxel_is_a_cross);
    RUN_TEST(test_identities);
    RUN_TEST(test_moving_the_set_moves_the_result);
    RUN_TEST(test_threads_and_processors_do_not_show);
    RUN_TEST(test_windows_with_a_halo_equal_the_whole);
    RUN_TEST(test_words_of_the_callers);
    RUN_TEST(test_what_morphology_refuses);
    RUN_TEST(test_hollow_takes_what_is_deeper);
    RUN_TEST(test_hollow_drains_from_any_side);
    RUN_TEST(test_what_hollow_refuses);
    return UNITY_END();
}
