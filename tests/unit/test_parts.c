/* test_parts.c - parts of grids listed, numbered, kept, filled and counted,
 * against a flood over single voxels and cells counted one by one. */
#include "core/core.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static bvx_context *other; /* portable code, three threads */
static uint64_t seed;
static bvx_grid grid;
static int32_t *found; /* by the flood: -1 for voxels that were not asked about */
static int32_t found_count;

void setUp(void)
{
    suite_open(0);
    other = suite_context(3, BVX_CPU_PORTABLE);
    seed = 4711;
    memset(&grid, 0, sizeof grid);
}

void tearDown(void)
{
    bvx_grid_free(ctx, &grid);
    free(found);
    found = NULL;
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
    bvx_context_destroy(other);
    suite_close();
}

/* ---- Grids: windows of a lattice that is a little larger ---- */

static void make_grid(int32_t nx, int32_t ny, int32_t nz)
{
    static const double origin[3] = {1, 2, 3}, spacing[3] = {0.5, 1, 2};
    int32_t const dims[3] = {nx + 3, ny + 2, nz + 4};
    bvx_window const window = {{2, 1, 3}, {nx, ny, nz}};
    bvx_lattice lattice;
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, &window, &grid));
}

static void scatter(int32_t percent)
{
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                bvx_grid_set(&grid, x, y, z, maker_below(&seed, 100) < percent);
}

static size_t voxels_of(const bvx_grid *g)
{
    return (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2];
}

static size_t index_of(int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)grid.size[1] + (size_t)y) * (size_t)grid.size[0] + (size_t)x;
}

/* 0 beyond the window. */
static int set_at(int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= grid.size[0] || y >= grid.size[1] || z >= grid.size[2]) return 0;
    return bvx_grid_get(&grid, x, y, z);
}

/* Number the parts of the voxels whose value is `value`, from 0 in the order of their least voxels. */
static void flood(int value, int32_t connectivity)
{
    int32_t const most = connectivity == 6 ? 1 : connectivity == 18 ? 2 : 3;
    size_t const n = voxels_of(&grid);
    size_t *const stack = malloc((n + 1) * sizeof *stack);

    free(found);
    found = malloc((n + 1) * sizeof *found);
    TEST_ASSERT_NOT_NULL(stack);
    TEST_ASSERT_NOT_NULL(found);
    found_count = 0;
    for (size_t i = 0; i < n; i++) found[i] = -1;
    for (size_t first = 0; first < n; first++) {
        size_t used = 0;
        stack[used++] = first;
        if (found[first] >= 0) continue;
        for (int begun = 0; used > 0; begun = 1) {
            size_t const i = stack[--used], row = i / (size_t)grid.size[0];
            int32_t const x = (int32_t)(i % (size_t)grid.size[0]);
            int32_t const y = (int32_t)(row % (size_t)grid.size[1]);
            int32_t const z = (int32_t)(row / (size_t)grid.size[1]);
            if (!begun && bvx_grid_get(&grid, x, y, z) != value) break;
            if (!begun) found[i] = found_count++;
            for (int32_t d = 0; d < 27; d++) {
                int32_t const dx = d % 3 - 1;
                int32_t const dy = d / 3 % 3 - 1;
                int32_t const dz = d / 9 - 1;
                int32_t const u = x + dx;
                int32_t const v = y + dy;
                int32_t const w = z + dz;
                if ((dx != 0) + (dy != 0) + (dz != 0) > most) continue;
                if (u < 0 || v < 0 || w < 0 || u >= grid.size[0] || v >= grid.size[1] || w >= grid.size[2])
                    continue;
                if (bvx_grid_get(&grid, u, v, w) != value || found[index_of(u, v, w)] >= 0) continue;
                found[index_of(u, v, w)] = found[i];
                stack[used++] = index_of(u, v, w);
            }
        }
    }
    free(stack);
}

/* What the flood found, as the library lists it. */
static bvx_component *list_found(void)
{
    bvx_component *const parts = calloc((size_t)found_count + 1, sizeof *parts);

    TEST_ASSERT_NOT_NULL(parts);
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                int32_t const v[3] = {x, y, z}, part = found[index_of(x, y, z)];
                if (part < 0) continue;
                bvx_component *const p = &parts[part];
                if (p->voxels++ == 0) p->first = index_of(x, y, z);
                for (int32_t a = 0; a < 3; a++) {
                    int32_t const low = p->voxels == 1 || v[a] < p->low[a] ? v[a] : p->low[a];
                    int32_t const high = p->voxels == 1 || v[a] >= p->low[a] + p->size[a]
                                             ? v[a] + 1
                                             : p->low[a] + p->size[a];
                    p->low[a] = low;
                    p->size[a] = high - low;
                }
            }
    return parts;
}

static const int32_t kinds[3] = {6, 18, 26};

static void expect_parts(void)
{
    size_t const n = voxels_of(&grid);
    uint32_t *const labels = malloc(n * sizeof *labels);

    TEST_ASSERT_NOT_NULL(labels);
    for (int k = 0; k < 6; k++) {
        bvx_context *const with = k < 3 ? ctx : other;
        uint64_t count = 99, labelled = 99;
        bvx_component *want, *got;
        flood(1, kinds[k % 3]);
        want = list_found();
        got = calloc((size_t)found_count + 1, sizeof *got);
        TEST_ASSERT_NOT_NULL(got);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_components(with, &grid, kinds[k % 3], NULL, 0, &count));
        TEST_ASSERT_EQUAL_UINT64((uint64_t)found_count, count);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_components(with, &grid, kinds[k % 3], got, count, &count));
        TEST_ASSERT_EQUAL_MEMORY(want, got, ((size_t)found_count + 1) * sizeof *want);
        memset(labels, 0xee, n * sizeof *labels);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_label(with, &grid, kinds[k % 3], labels, n, &labelled));
        TEST_ASSERT_EQUAL_UINT64(count, labelled);
        for (size_t i = 0; i < n; i++) TEST_ASSERT_EQUAL_UINT32((uint32_t)(found[i] + 1), labels[i]);
        free(want);
        free(got);
    }
    free(labels);
}

static void test_parts_equal_a_flood(void)
{
    static const int32_t sides[7] = {1, 63, 64, 65, 127, 128, 129}, percents[6] = {0, 3, 12, 40, 85, 100};
    for (int s = 0; s < 7; s++)
        for (int p = quick ? 2 : 0; p < (quick ? 4 : 6); p++) {
            make_grid(sides[s], 1 + maker_below(&seed, 8), 1 + maker_below(&seed, 8));
            scatter(percents[p]);
            expect_parts();
        }
}

/* Long runs and short ones in a word, over word ends. */
static void test_labels_of_long_runs(void)
{
    make_grid(200, 1, 1);
    for (int32_t begin = 0; begin < 140; begin += quick ? 13 : 1)
        for (int32_t length = 1; length <= 60 && begin + length <= 200; length += quick ? 29 : 7) {
            for (int32_t x = 0; x < 200; x++) bvx_grid_set(&grid, x, 0, 0, x >= begin && x < begin + length);
            bvx_grid_set(&grid, 199, 0, 0, 1);
            expect_parts();
        }
}

/* ---- Keeping ---- */

static int hashes_equal(const bvx_grid *a, const bvx_grid *b)
{
    uint64_t first = 0, second = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, a, &first));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, b, &second));
    return first == second;
}

/* How many parts are larger, or as large and before this one, among those that are alive. */
static uint64_t rank_of_part(const bvx_component *parts, const uint8_t *alive, int32_t i)
{
    uint64_t n = 0;
    for (int32_t j = 0; j < found_count; j++)
        n += alive[j] && (parts[j].voxels > parts[i].voxels || (parts[j].voxels == parts[i].voxels && j < i));
    return n;
}

static void expect_kept(const bvx_keep_options *options)
{
    bvx_keep_options o = *options;
    bvx_keep_report report, want = {0, 0, 0, 0, {0}};
    bvx_grid kept = {0}, in_place = {0};
    bvx_component *parts;
    uint8_t *alive, *last;
    bvx_window const window = {{grid.low[0], grid.low[1], grid.low[2]},
                               {grid.size[0], grid.size[1], grid.size[2]}};

    flood(1, o.connectivity);
    parts = list_found();
    alive = calloc((size_t)found_count + 1, 1);
    last = calloc((size_t)found_count + 1, 1);
    TEST_ASSERT_NOT_NULL(alive);
    TEST_ASSERT_NOT_NULL(last);
    for (int32_t i = 0; i < found_count; i++) {
        int touched = o.seed_count == 0;
        for (uint64_t s = 0; s < o.seed_count; s++)
            touched |= found[index_of(o.seeds[3 * s], o.seeds[3 * s + 1], o.seeds[3 * s + 2])] == i;
        alive[i] = touched && parts[i].voxels >= o.at_least;
    }
    for (int32_t i = 0; i < found_count; i++) {
        last[i] = alive[i] && (o.largest == 0 || rank_of_part(parts, alive, i) < o.largest);
        *(last[i] ? &want.kept : &want.dropped) += 1;
        *(last[i] ? &want.voxels_kept : &want.voxels_dropped) += parts[i].voxels;
    }
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_keep(ctx, &grid, &o, &kept));
    TEST_ASSERT_EQUAL_MEMORY(&want, &report, sizeof want);
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                int32_t const part = found[index_of(x, y, z)];
                TEST_ASSERT_EQUAL_INT(part >= 0 && last[part], bvx_grid_get(&kept, x, y, z));
            }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &grid.lattice, &window, &in_place));
    memcpy(in_place.words, grid.words, (size_t)bvx_grid_bound(&grid.lattice, &window) * 8);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_keep(other, &in_place, &o, &in_place));
    TEST_ASSERT_TRUE(hashes_equal(&kept, &in_place));
    bvx_grid_free(ctx, &kept);
    bvx_grid_free(ctx, &in_place);
    free(parts);
    free(alive);
    free(last);
}

static void test_keep_by_every_rule(void)
{
    for (int round = 0; round < (quick ? 6 : 60); round++) {
        int32_t seeds[9];
        bvx_keep_options o = {.struct_size = sizeof o};
        make_grid(1 + maker_below(&seed, 130), 1 + maker_below(&seed, 9), 1 + maker_below(&seed, 9));
        scatter(5 + maker_below(&seed, 40));
        o.connectivity = kinds[round % 3];
        expect_kept(&o);
        o.at_least = (uint64_t)maker_below(&seed, 5);
        expect_kept(&o);
        o.largest = (uint64_t)maker_below(&seed, 6);
        expect_kept(&o);
        for (int i = 0; i < 9; i++) seeds[i] = maker_below(&seed, grid.size[i % 3]);
        o.seeds = seeds;
        o.seed_count = 3;
        expect_kept(&o);
        o.at_least = o.largest = 0;
        expect_kept(&o);
    }
}

/* ---- Cavities ---- */

static void expect_cavities(int32_t connectivity, uint64_t at_most)
{
    bvx_grid filled = {0};
    bvx_component *parts;
    uint64_t want = 0, got = 99;

    flood(0, connectivity);
    parts = list_found();
    for (int32_t i = 0; i < found_count; i++)
        for (int32_t a = 0; a < 3; a++)
            if (parts[i].low[a] == 0 || parts[i].low[a] + parts[i].size[a] == grid.size[a])
                parts[i].reserved = 1;
    for (int32_t i = 0; i < found_count; i++) {
        if (at_most != 0 && parts[i].voxels > at_most) parts[i].reserved = 1;
        want += parts[i].reserved ? 0 : parts[i].voxels;
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_fill_cavities(ctx, &grid, connectivity, at_most, &filled, &got));
    TEST_ASSERT_EQUAL_UINT64(want, got);
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                int32_t const part = found[index_of(x, y, z)];
                TEST_ASSERT_EQUAL_INT(part < 0 || !parts[part].reserved, bvx_grid_get(&filled, x, y, z));
            }
    free(parts);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_fill_cavities(other, &grid, connectivity, at_most, &grid, NULL));
    TEST_ASSERT_TRUE(hashes_equal(&filled, &grid));
    bvx_grid_free(ctx, &filled);
}

static void test_cavities_are_filled(void)
{
    static const int32_t sides[5] = {3, 63, 64, 65, 129};

    for (int s = 0; s < 5; s++)
        for (int k = 0; k < 3; k++)
            for (uint64_t at_most = 0; at_most < 3; at_most++) {
                make_grid(sides[s], 3 + maker_below(&seed, 8), 3 + maker_below(&seed, 8));
                scatter(70 + maker_below(&seed, 25));
                expect_cavities(kinds[k], at_most);
            }
}

/* ---- Topology ---- */

/* Vertices - edges + faces - voxels: a cell counts when any of its voxels is set (26), or with centres for
 * vertices all of them (6). Cells are numbered by twice their middle. */
static int64_t slow_euler(int32_t connectivity)
{
    int64_t sum = 0;

    for (int32_t z = -1; z <= 2 * grid.size[2]; z++)
        for (int32_t y = -1; y <= 2 * grid.size[1]; y++)
            for (int32_t x = -1; x <= 2 * grid.size[0]; x++) {
                int32_t const c[3] = {x, y, z}; /* odd: between two voxels */
                int any = 0, all = 1, between = 0;
                for (int32_t a = 0; a < 3; a++) between += (c[a] & 1) != 0;
                for (int32_t corner = 0; corner < 8; corner++) {
                    int32_t v[3], skip = 0;
                    for (int32_t a = 0; a < 3; a++) {
                        int32_t const side = corner >> a & 1;
                        if ((c[a] & 1) == 0) skip |= side;
                        v[a] = (c[a] & 1) != 0 ? (c[a] + 1) / 2 - 1 + side : c[a] / 2;
                    }
                    if (skip) continue;
                    any |= set_at(v[0], v[1], v[2]);
                    all &= set_at(v[0], v[1], v[2]);
                }
                if (connectivity == 26) sum += any ? ((3 - between) % 2 == 0 ? 1 : -1) : 0;
                else sum += all ? (between % 2 == 0 ? 1 : -1) : 0;
            }
    return sum;
}

static void expect_topology(int32_t connectivity)
{
    bvx_topology got, twin;
    bvx_component *parts;
    uint64_t components, cavities = 0, set = 0;
    int64_t const euler = slow_euler(connectivity);

    flood(1, connectivity);
    components = (uint64_t)found_count;
    for (size_t i = 0; i < voxels_of(&grid); i++) set += found[i] >= 0;
    flood(0, connectivity == 6 ? 26 : 6);
    parts = list_found();
    for (int32_t i = 0; i < found_count; i++) {
        int side = 0;
        for (int32_t a = 0; a < 3; a++)
            side |= parts[i].low[a] == 0 || parts[i].low[a] + parts[i].size[a] == grid.size[a];
        cavities += !side;
    }
    free(parts);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_topology(ctx, &grid, connectivity, &got));
    TEST_ASSERT_EQUAL_UINT64(set, got.voxels);
    TEST_ASSERT_EQUAL_UINT64(components, got.components);
    TEST_ASSERT_EQUAL_UINT64(cavities, got.cavities);
    TEST_ASSERT_EQUAL_INT64(euler, got.euler);
    TEST_ASSERT_EQUAL_INT64((int64_t)components + (int64_t)cavities - euler, got.tunnels);
    TEST_ASSERT_TRUE(got.tunnels >= 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_topology(other, &grid, connectivity, &twin));
    TEST_ASSERT_EQUAL_MEMORY(&got, &twin, sizeof got);
}

static void test_topology_equals_counted_cells(void)
{
    static const int32_t sides[7] = {1, 63, 64, 65, 127, 128, 129}, percents[6] = {0, 6, 30, 55, 90, 100};

    for (int s = 0; s < 7; s++)
        for (int p = quick ? 2 : 0; p < (quick ? 4 : 6); p++) {
            make_grid(sides[s], 1 + maker_below(&seed, 6), 1 + maker_below(&seed, 6));
            scatter(percents[p]);
            expect_topology(6);
            expect_topology(26);
        }
}

static double of_ring(double x, double y, double z, double radius)
{
    double const d = sqrt(x * x + y * y) - radius;
    return d * d + z * z;
}

/* A ball, a hollow ball, a ring, two rings that share a wall, two balls one in the other's cavity. */
static void test_topology_of_known_shapes(void)
{
    static const struct {
        uint64_t components, cavities;
        int64_t tunnels;
    } want[5] = {{1, 0, 0}, {1, 1, 0}, {1, 0, 1}, {1, 0, 2}, {2, 1, 0}};
    for (int shape = 0; shape < 5; shape++) {
        make_grid(70, 40, 24);
        for (int32_t k = 0; k < 24; k++)
            for (int32_t j = 0; j < 40; j++)
                for (int32_t i = 0; i < 70; i++) {
                    double const x = i - 34.5, y = j - 19.5, z = k - 11.5, r = x * x + y * y + z * z;
                    int set = 0;
                    if (shape == 0) set = r < 100;
                    if (shape == 1) set = r < 100 && r >= 36;
                    if (shape == 2) set = of_ring(x, y, z, 12) < 16;
                    if (shape == 3) set = of_ring(x - 12, y, z, 12) < 16 || of_ring(x + 12, y, z, 12) < 16;
                    if (shape == 4) set = (r < 110 && r >= 64) || r < 25;
                    bvx_grid_set(&grid, i, j, k, set);
                }
        for (int c = 0; c < 2; c++) {
            bvx_topology t;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_topology(ctx, &grid, c == 0 ? 6 : 26, &t));
            TEST_ASSERT_EQUAL_UINT64(want[shape].components, t.components);
            TEST_ASSERT_EQUAL_UINT64(want[shape].cavities, t.cavities);
            TEST_ASSERT_EQUAL_INT64(want[shape].tunnels, t.tunnels);
        }
    }
}

/* ---- Refusals ---- */

static void expect_refused(bvx_status want, bvx_status got, const char *word)
{
    TEST_ASSERT_EQUAL_INT32(want, got);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
}

static void test_parts_refuse(void)
{
    bvx_component parts[2];
    uint32_t labels[10];
    uint64_t count = 0;
    bvx_topology t;
    bvx_keep_options o = {.struct_size = sizeof o};
    bvx_grid result = {0}, none = {0};
    int32_t out[3] = {0, 1, 0};

    make_grid(10, 1, 1);
    for (int32_t x = 0; x < 10; x += 2) bvx_grid_set(&grid, x, 0, 0, 1);
    expect_refused(BVX_ERR_CAPACITY, bvx_grid_components(ctx, &grid, 6, parts, 2, &count), "5 parts");
    TEST_ASSERT_EQUAL_UINT64(5, count);
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_components(ctx, &grid, 8, parts, 2, &count),
                   "connectivity is 8");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_components(ctx, &grid, 6, parts, 2, NULL), "count is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_components(ctx, NULL, 6, parts, 2, &count), "grid is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_components(ctx, &none, 6, parts, 2, &count), "no words");
    expect_refused(BVX_ERR_CAPACITY, bvx_grid_label(ctx, &grid, 6, labels, 9, &count), "10 voxels");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_label(ctx, &grid, 6, NULL, 10, &count), "labels is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_label(ctx, &grid, 7, labels, 10, &count), "connectivity is 7");
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_label(ctx, &grid, 6, labels, 10, NULL));
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_topology(ctx, &grid, 18, &t), "not 6 or 26");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_topology(ctx, &grid, 6, NULL), "topology is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_fill_cavities(ctx, &grid, 0, 0, &result, NULL),
                   "connectivity is 0");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_fill_cavities(ctx, &grid, 6, 0, NULL, NULL), "result is NULL");
    o.connectivity = 4;
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_keep(ctx, &grid, &o, &result), "connectivity 4");
    o = (bvx_keep_options){.struct_size = sizeof o};
    o.seed_count = 1;
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_keep(ctx, &grid, &o, &result), "seeds is NULL");
    o.seeds = out;
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_keep(ctx, &grid, &o, &result), "seed 0 at (0, 1, 0)");
    o = (bvx_keep_options){.struct_size = sizeof o};
    o.reserved = 1;
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_keep(ctx, &grid, &o, &result), "reserved");
    expect_refused(BVX_ERR_ARGUMENT, bvx_grid_keep(ctx, &grid, NULL, NULL), "result is NULL");
    TEST_ASSERT_NULL(result.words);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_keep(ctx, &grid, NULL, &result));
    TEST_ASSERT_TRUE(hashes_equal(&grid, &result));
    bvx_grid_free(ctx, &result);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_parts_equal_a_flood);
    RUN_TEST(test_labels_of_long_runs);
    RUN_TEST(test_keep_by_every_rule);
    RUN_TEST(test_cavities_are_filled);
    RUN_TEST(test_topology_equals_counted_cells);
    RUN_TEST(test_topology_of_known_shapes);
    RUN_TEST(test_parts_refuse);
    return UNITY_END();
}
