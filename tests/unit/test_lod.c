/* test_lod.c - levels of detail against exact references, on solids whose place is known, and in every way to
 * fail. BVX_QUICK in the environment makes it shorter, for slow machines. */
#include "lod_oracle.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#define PI       3.14159265358979323846
#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

enum { MAX_LEVELS = 8 };

static bvx_grid grid;
static bvx_mesh level[MAX_LEVELS];
static bvx_lod_report report[MAX_LEVELS];
static bvx_lod_options options;
static uint64_t seed;

void setUp(void)
{
    suite_open(1);
    seed = 1;
    memset(&grid, 0, sizeof grid);
    memset(level, 0, sizeof level);
    memset(report, 0, sizeof report);
    options = (bvx_lod_options){.struct_size = sizeof options};
    options.sampling.threshold = 0.5; /* the default, which oracles read */
    options.reports = report;
}

static void free_levels(void)
{
    for (int l = 0; l < MAX_LEVELS; l++) bvx_mesh_free(ctx, &level[l]);
}

void tearDown(void)
{
    free_levels();
    bvx_grid_free(ctx, &grid);
    suite_close();
}

/* ---- grids ---- */

/* A window of x, y, z voxels whose low corner is voxel (low, low, low) of a lattice a little larger. */
static void make_grid(int32_t x, int32_t y, int32_t z, int32_t low, const double origin[3],
                      const double spacing[3])
{
    int32_t const dims[3] = {x + 2 * low, y + 2 * low, z + 2 * low};
    bvx_window const window = {{low, low, low}, {x, y, z}};
    bvx_lattice lattice;
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, &window, &grid));
}

static void make_unit_grid(int32_t x, int32_t y, int32_t z)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    make_grid(x, y, z, 0, origin, spacing);
}

/* Voxels set with a probability of percent / 100 in blocks of block voxels,
 * so that boxes are full, empty and mixed. */
static void scatter(int32_t percent, int32_t block)
{
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                uint64_t s = (uint64_t)(x / block + 1) * UINT64_C(0x9E3779B97F4A7C15) ^
                             (uint64_t)(y / block + 1) << 40 ^ (uint64_t)(z / block + 1) << 20 ^
                             (uint64_t)(percent + 101 * block);
                maker_random(&s);
                bvx_grid_set(&grid, x, y, z, maker_below(&s, 100) < percent);
            }
}

static void set_box(const int32_t low[3], const int32_t high[3])
{
    for (int32_t z = low[2]; z < high[2]; z++)
        for (int32_t y = low[1]; y < high[1]; y++)
            for (int32_t x = low[0]; x < high[0]; x++) bvx_grid_set(&grid, x, y, z, 1);
}

/* The voxels whose centres lie inside a ball, in voxels from the window's corner. */
static void set_ball(const double centre[3], double radius)
{
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                double const d[3] = {x + 0.5 - centre[0], y + 0.5 - centre[1], z + 0.5 - centre[2]};
                if (d[0] * d[0] + d[1] * d[1] + d[2] * d[2] < radius * radius)
                    bvx_grid_set(&grid, x, y, z, 1);
            }
}

static bvx_status build(uint64_t count)
{
    return bvx_build_lods(ctx, &grid, &options, count, level);
}

static void must_build(uint64_t count)
{
    bvx_status const status = build(count);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
}

/* ---- against the references ---- */

static const char *what_runs(void)
{
    static char text[200];
    snprintf(text, sizeof text, "%s %dx%dx%d at %g %g %g, threshold %g, edge_samples %d",
             options.sampling.method == BVX_LOD_COVERAGE ? "coverage" : "edge ratio", (int)grid.size[0],
             (int)grid.size[1], (int)grid.size[2], report[0].ratio[0], report[0].ratio[1], report[0].ratio[2],
             options.sampling.threshold, (int)options.sampling.edge_samples);
    return text;
}

/* Triangles are those that extraction gives for the reference's bits. */
static void same_triangles(const oracle *o, const bvx_mesh *mesh)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    bvx_lattice lattice;
    bvx_grid coarse = {0};
    bvx_mesh plain = {0};
    bvx_extract_options e = {.struct_size = sizeof e};
    int32_t i[3];

    e.face_rule = options.face_rule;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, o->count, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &coarse));
    for (i[2] = 0; i[2] < o->count[2]; i[2]++)
        for (i[1] = 0; i[1] < o->count[1]; i[1]++)
            for (i[0] = 0; i[0] < o->count[0]; i[0]++)
                bvx_grid_set(&coarse, i[0], i[1], i[2], *oracle_at(o, i));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &coarse, &e, &plain));
    TEST_ASSERT_EQUAL_UINT64(plain.triangle_count, mesh->triangle_count);
    if (mesh->triangle_count != 0)
        TEST_ASSERT_EQUAL_INT(0, memcmp(plain.triangles, mesh->triangles, (size_t)mesh->triangle_count * 12));
    bvx_mesh_free(ctx, &plain);
    bvx_grid_free(ctx, &coarse);
}

/* One level of the grid as it is, by the options as they are, in f64.
 * Returns whether anything was left of the solid. */
static int check_level(const int32_t n[3], const int32_t r[3])
{
    oracle o;
    bvx_status status;
    int64_t wrong;

    options.position_type = BVX_F64;
    oracle_open(&o, &grid, &options, n, r);
    status = build(1);
    wrong = status == BVX_OK ? oracle_compare(&o, &level[0], 1e-9) : -1;
    if (status == BVX_OK) {
        TEST_ASSERT_EQUAL_INT64_MESSAGE(-1, wrong, what_runs());
        same_triangles(&o, &level[0]);
        for (int a = 0; a < 3; a++) {
            TEST_ASSERT_EQUAL_INT32(o.count[a], report[0].resolution[a]);
            TEST_ASSERT_EQUAL_DOUBLE((double)n[a] / (double)r[a], report[0].ratio[a]);
        }
        TEST_ASSERT_EQUAL_UINT64(level[0].vertex_count, report[0].vertices);
        TEST_ASSERT_EQUAL_UINT64(level[0].triangle_count, report[0].triangles);
    } else { /* only when the reference keeps nothing either */
        size_t const samples = (size_t)(o.count[0] + 2) * (size_t)(o.count[1] + 2) * (size_t)(o.count[2] + 2);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_EMPTY, status, bvx_last_message(ctx));
        TEST_ASSERT_NULL(memchr(o.bit, 1, samples));
    }
    bvx_mesh_free(ctx, &level[0]);
    oracle_close(&o);
    return status == BVX_OK;
}

/* One ratio for all axes. */
static int check_common(int32_t resolution)
{
    int32_t n[3], r[3];
    n[0] = grid.size[0] > grid.size[1] ? grid.size[0] : grid.size[1];
    n[0] = n[1] = n[2] = n[0] > grid.size[2] ? n[0] : grid.size[2];
    r[0] = r[1] = r[2] = resolution;
    options.resolutions = &resolution;
    options.axis_resolutions = NULL;
    return check_level(n, r);
}

/* Each axis by its own. */
static int check_axes(int32_t x, int32_t y, int32_t z)
{
    int32_t const r[3] = {x, y, z};
    options.resolutions = NULL;
    options.axis_resolutions = r;
    int const kept = check_level(grid.size, r);
    options.axis_resolutions = NULL;
    return kept;
}

static const double thresholds[] = {0.1, 0.25, 0.5, 0.9, 0.5 + 1.0 / 65536};
static const double odd_origin[3] = {-3.25, 100.5, 7.0}, odd_spacing[3] = {0.5, 0.75, 2.0};

/* Random grids of one method: sizes at word edges, ratios of all kinds, both ways to ask. */
static void random_grids(int32_t method, int32_t rounds)
{
    static const int32_t sides[] = {1, 2, 63, 64, 65, 127, 128, 129};
    static const int32_t samples[] = {0, 1, 2, 5};
    int32_t kept = 0;

    if (quick) rounds /= 4;
    for (int32_t i = 0; i < rounds; i++) {
        int32_t const x = sides[i % (int32_t)COUNT(sides)], flat = maker_below(&seed, 4);
        int32_t const y = flat == 1 ? 1 : 1 + maker_below(&seed, 12);
        int32_t const z = flat == 2 ? 1 : 1 + maker_below(&seed, 12);
        int32_t const longest = x > y ? (x > z ? x : z) : (y > z ? y : z);
        make_grid(x, y, z, maker_below(&seed, 3) == 0 ? 5 : 0, odd_origin, odd_spacing);
        scatter(20 + maker_below(&seed, 60), 1 + maker_below(&seed, 8));
        options.sampling.method = method;
        options.face_rule = maker_below(&seed, 2);
        options.sampling.threshold = thresholds[maker_below(&seed, (int32_t)COUNT(thresholds))];
        options.sampling.edge_samples = method == BVX_LOD_EDGE_RATIO
                                            ? samples[maker_below(&seed, (int32_t)COUNT(samples))]
                                            : 0;
        if (i % 3 != 2) kept += check_common(longest / 20 + 1 + maker_below(&seed, longest - longest / 20));
        else
            kept += check_axes(1 + maker_below(&seed, x), 1 + maker_below(&seed, y),
                               1 + maker_below(&seed, z));
    }
    TEST_ASSERT_GREATER_THAN_INT32(rounds / 2, kept);
}

static void test_edge_ratio_equals_the_reference_on_random_grids(void)
{
    random_grids(BVX_LOD_EDGE_RATIO, 400);
}

static void test_coverage_equals_the_reference_on_random_grids(void)
{
    random_grids(BVX_LOD_COVERAGE, 400);
}

/* The ratio itself, whole and not, along each axis as the longest; 130 = 2 * 5 * 13, 63 = 7 * 9. */
static void named_ratios(int32_t method)
{
    static const int32_t n_r[][2] = {{63, 27}, {65, 25}, {63, 63},  {64, 32}, {64, 43},   {65, 13}, {129, 43},
                                     {128, 8}, {129, 7}, {127, 11}, {60, 3},  {128, 127}, {65, 64}};

    options.sampling.method = method;
    for (size_t i = 0; i < COUNT(n_r); i++) {
        if (quick && i % 4 != 0) continue;
        for (int longest = 0; longest < 3; longest++) {
            int32_t size[3] = {11, 9, 10};
            size[longest] = n_r[i][0];
            make_grid(size[0], size[1], size[2], 0, odd_origin, odd_spacing);
            scatter(55, 3);
            options.sampling.threshold = thresholds[i % COUNT(thresholds)];
            check_common(n_r[i][1]);
        }
    }
}

static void test_edge_ratio_at_named_ratios(void)
{
    named_ratios(BVX_LOD_EDGE_RATIO);
}

static void test_coverage_at_named_ratios(void)
{
    named_ratios(BVX_LOD_COVERAGE);
}

/* Every threshold falls on some weight: at a ratio of 2 all weights are eighths. */
static void test_inside_means_above_the_threshold(void)
{
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++)
        for (int32_t eighth = 0; eighth <= 8; eighth++) {
            make_unit_grid(6, 6, 6);
            for (int32_t v = 0; v < eighth; v++)
                bvx_grid_set(&grid, 2 + (v & 1), 2 + (v >> 1 & 1), 2 + (v >> 2), 1);
            options.sampling.method = method;
            options.sampling.threshold = eighth / 8.0;
            if (eighth > 0 && eighth < 8) TEST_ASSERT_FALSE(check_common(3)); /* equal is not above */
            options.sampling.threshold = (eighth - 0.5) / 8.0;
            if (eighth > 0) TEST_ASSERT_TRUE(check_common(3));
        }
}

/* A threshold is kept in steps of 2^-16, and the ends of (0,1) stay inside it. */
static void test_threshold_is_kept_in_steps(void)
{
    static const double given[] = {1e-9, 1.0 - 1e-12, 0.3, 0.3 + 0.4 / 65536};

    make_unit_grid(40, 9, 9);
    scatter(50, 2);
    for (size_t i = 0; i < COUNT(given); i++) {
        options.sampling.threshold = given[i];
        options.sampling.method = BVX_LOD_COVERAGE;
        check_common(17);
        options.sampling.method = BVX_LOD_EDGE_RATIO;
        check_common(17);
    }
}

static void test_edge_samples_of_any_number(void)
{
    static const int32_t samples[] = {1, 2, 3, 5, 64, 1000};

    make_unit_grid(33, 9, 8);
    scatter(50, 2);
    for (size_t i = 0; i < COUNT(samples); i++) {
        options.sampling.edge_samples = samples[i];
        TEST_ASSERT_TRUE(check_common(10));
    }
    options.sampling.edge_samples = 65536;
    options.resolutions = (const int32_t[]){10};
    must_build(1);
}

/* Rows of more than 64 words, boxes of more than 64 and more than 4096
 * voxels: beyond what a row is seen at a time. */
static void test_coverage_of_long_rows_and_wide_boxes(void)
{
    static const int32_t x[] = {5000, 2143, 129, 71, 16, 7, 2, 1};
    int32_t kept = 0;

    options.sampling.method = BVX_LOD_COVERAGE;
    for (size_t i = 0; i < COUNT(x); i += quick ? 3 : 1)
        for (int32_t part = 0; part < 3; part++) {
            make_unit_grid(part == 1 ? 9000 : 5000, 3, 2);
            /* the last words only */
            if (part == 2) set_box((const int32_t[]){4200, 0, 0}, (const int32_t[]){5000, 3, 2});
            else scatter(60, part == 0 ? 3 : 700);
            options.sampling.threshold = part == 2 ? 0.1 : 0.5;
            kept += check_axes(x[i], 1 + maker_below(&seed, 3), 1 + maker_below(&seed, 2));
        }
    TEST_ASSERT_GREATER_THAN_INT32(6, kept);
}

static void test_coverage_of_a_wide_box_that_stands_out_of_the_grid(void)
{
    int32_t const one = 1;

    make_unit_grid(5000, 5001, 1);
    /* 3.6e-5 of a box 5001 voxels wide */
    set_box((const int32_t[]){4100, 0, 0}, (const int32_t[]){5000, 5001, 1});
    options.sampling.method = BVX_LOD_COVERAGE;
    options.sampling.threshold = 1.0 / 65536;
    options.resolutions = &one;
    must_build(1);
    TEST_ASSERT_EQUAL_UINT64(8, level[0].triangle_count);
}

/* The longest grids: one ratio for all axes needs more than 63 bits for the
 * weights and is refused, each axis by its own does not. */
static void test_longest_grids(void)
{
    static const int32_t common[] = {1 << 20, (1 << 20) - 1}, axes[] = {1 << 20, 1, 1};

    make_unit_grid(1 << 20, 1, 1);
    for (int32_t x = 0; x < 1 << 20; x += 64) bvx_grid_set(&grid, x, 0, 0, 1);
    options.position_type = BVX_F64;
    for (size_t i = 0; i < COUNT(common); i++) {
        options.axis_resolutions = NULL;
        options.resolutions = &common[i];
        options.sampling.method = BVX_LOD_COVERAGE;
        must_build(1);
        TEST_ASSERT_TRUE(level[0].triangle_count > 100000);
        free_levels();
        options.sampling.method = BVX_LOD_EDGE_RATIO;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, build(1));
        options.resolutions = NULL;
        options.axis_resolutions = axes;
        options.sampling.method = i == 0 ? BVX_LOD_EDGE_RATIO : BVX_LOD_COVERAGE;
        must_build(1);
        TEST_ASSERT_EQUAL_UINT64((1 << 14) * 8, level[0].triangle_count);
        free_levels();
    }
    make_unit_grid((1 << 20) + 1, 1, 1);
    bvx_grid_set(&grid, 5, 0, 0, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, build(1));
}

/* At the grid's own resolution the level has the triangles of the grid's surface. */
static void test_own_resolution_is_the_surface_itself(void)
{
    int32_t const own = 65;
    bvx_mesh plain = {0};

    make_unit_grid(65, 20, 30);
    scatter(45, 2);
    options.resolutions = &own;
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++) {
        options.sampling.method = method;
        must_build(1);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &grid, NULL, &plain));
        TEST_ASSERT_EQUAL_UINT64(plain.triangle_count, level[0].triangle_count);
        TEST_ASSERT_EQUAL_UINT64(plain.vertex_count, level[0].vertex_count);
        TEST_ASSERT_EQUAL_INT(0,
                              memcmp(plain.triangles, level[0].triangles, (size_t)plain.triangle_count * 12));
        if (method == BVX_LOD_COVERAGE) /* 0 and 1 cross one half in the middle, to 2^-32 */
            for (uint64_t i = 0; i < 3 * plain.vertex_count; i++)
                TEST_ASSERT_FLOAT_WITHIN(1e-5f, ((float *)plain.positions)[i],
                                         ((float *)level[0].positions)[i]);
        bvx_mesh_free(ctx, &plain);
        free_levels();
    }
}

/* ---- place and size ---- */

/* Volume and centroid of a closed mesh of f64. */
static double measure(const bvx_mesh *m, double centroid[3])
{
    const double *const p = m->positions;
    double volume = 0.0;

    memset(centroid, 0, 3 * sizeof *centroid);
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        const double *const a = p + 3 * (size_t)m->triangles[3 * t];
        const double *const b = p + 3 * (size_t)m->triangles[3 * t + 1];
        const double *const c = p + 3 * (size_t)m->triangles[3 * t + 2];
        double const v = (a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                          a[2] * (b[0] * c[1] - b[1] * c[0])) /
                         6;
        volume += v;
        for (int k = 0; k < 3; k++) centroid[k] += v * (a[k] + b[k] + c[k]) / 4;
    }
    for (int k = 0; k < 3; k++) centroid[k] /= volume;
    return volume;
}

/* How far a vertex may sit from a place where the solid's surface crosses its
 * edge squarely, in voxels: the most by which linear positions miss a plane, (3 -
 * 2 sqrt 2) / 2 of a step, or for coverage of a sample. Ends of edges keep 1/128. */
static double place_error(int32_t method, double h)
{
    return 0.0858 * (method == BVX_LOD_EDGE_RATIO ? h / ceil(h - 1e-9) : h);
}

/* A ball of radius R at samples h apart. Vertices lie near it and chords inside it: a triangle in a cell,
 * edges a b c, lies (aa + bb + cc) / 24R below a sphere on average, at most 6 h h / 24 R for most, and the
 * box of a coverage sample blurs the ball by as much as h h / 12 R more. So the volume lacks about (h / R)^2,
 * and 1.1 of it is allowed. Beyond that, a shell is allowed that stands for placement: 0.05 voxels inwards
 * (what is exactly at the threshold is outside), 0.02 outwards. Half a voxel of shrinking, or samples placed
 * at stretch ends, would show. The centroid may move by what chords differ from side to side, 0.06 h h / R,
 * and by 0.06 voxels: at ratios near whole numbers the samples' place within voxels drifts slowly over the
 * grid, and a ball on one side of it sees one part of that. A centred ball stays put. */
static void ball_levels(int32_t side, double radius, const double centre[3])
{
    static const double ratios[20] = {1,   1.2, 1.5, 1.75, 2, 7.0 / 3, 2.6, 3,    3.5, 4,
                                      4.7, 5,   6,   7.3,  8, 10,      12,  14.5, 17,  20};
    double const truth = 4.0 / 3.0 * PI * radius * radius * radius;

    make_grid(side, side, side, 3, odd_origin, (const double[]){2, 2, 2});
    set_ball(centre, radius);
    options.position_type = BVX_F64;
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++)
        for (int i = 0; i < 20; i += quick ? 5 : 1) {
            int32_t const resolution = (int32_t)(side / ratios[i] + 0.5);
            double const h = (double)side / resolution, curve = h * h / radius;
            double c[3], lack;
            char text[100];
            options.sampling.method = method;
            options.resolutions = &resolution;
            must_build(1);
            lack = 1 - measure(&level[0], c) / 8 / truth;
            snprintf(text, sizeof text, "method %d, ratio %.3f, radius %g: volume lacks %.5f", (int)method, h,
                     radius, lack);
            TEST_ASSERT_TRUE_MESSAGE(lack * radius / 3 < 1.1 / 3 * curve + 0.05, text);
            TEST_ASSERT_TRUE_MESSAGE(lack * radius / 3 > -0.02, text);
            for (int a = 0; a < 3; a++)
                TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(centre[a] * 2 == side ? 1e-6 : 0.06 + 0.06 * curve,
                                                  centre[a] + 3, (c[a] - odd_origin[a]) / 2, text);
            free_levels();
        }
}

static void test_a_ball_in_the_middle_keeps_volume_and_centre(void)
{
    if (quick) TEST_IGNORE_MESSAGE("left out of a quick run");
    ball_levels(160, 70, (const double[]){80, 80, 80});
    ball_levels(160, 70, (const double[]){81.37, 78.61, 80.22});
}

static void test_a_ball_off_the_middle_keeps_volume_and_centre(void)
{
    ball_levels(110, 40.3, (const double[]){60.1, 67.7, 41.9});
}

/* A box on voxel planes: vertices along an axis, away from the box's edges, stand on its two faces. */
static void box_faces(int32_t method, int32_t resolution, const int32_t low[3], const int32_t high[3])
{
    double const h = (double)grid.size[0] / resolution, error = place_error(method, h) + h / 128 + 1e-9;
    const double *p;
    int32_t seen[3][2] = {{0}};

    options.sampling.method = method;
    options.resolutions = &resolution;
    must_build(1);
    p = level[0].positions;
    for (uint64_t v = 0; v < level[0].vertex_count; v++, p += 3)
        for (int a = 0; a < 3; a++) {
            int const u = (a + 1) % 3, w = (a + 2) % 3, upper = p[a] > 0.5 * (low[a] + high[a]);
            double const inside = h + 1;
            if (p[u] < low[u] + inside || p[u] > high[u] - inside || p[w] < low[w] + inside ||
                p[w] > high[w] - inside)
                continue;
            TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(error, upper ? high[a] : low[a], p[a], what_runs());
            seen[a][upper]++;
        }
    for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE_MESSAGE(seen[a][0] > 0 && seen[a][1] > 0, what_runs());
    free_levels();
}

static void test_a_box_keeps_its_faces_on_both_sides(void)
{
    int32_t const low[3] = {13, 17, 11}, high[3] = {83, 76, 80};
    make_unit_grid(96, 90, 94);
    set_box(low, high);
    options.position_type = BVX_F64;
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++)
        for (int32_t r = 5; r <= 96; r += quick ? 13 : 3) box_faces(method, r, low, high);
}

/* A solid that fills the grid has its faces at the grid's: what is beyond
 * is empty, also for the last samples. */
static void test_a_full_grid_keeps_its_faces(void)
{
    int32_t const low[3] = {0, 0, 0}, high[3] = {60, 40, 50};

    make_unit_grid(60, 40, 50);
    set_box(low, high);
    options.position_type = BVX_F64;
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++)
        for (int32_t r = 6; r <= 60; r += 3) {
            if (60 % r == 0 || 40 * r % 60 == 0) box_faces(method, r, low, high);
        }
}

/* ---- certificates ---- */

static void certify(const bvx_mesh *mesh)
{
    bvx_mesh_view view;
    bvx_certificate c;

    bvx_mesh_view_of(mesh, &view);
    for (int32_t weld = 0; weld < 2; weld++) { /* welded: no two vertices share a place */
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, weld, &c));
        TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented, what_runs());
        TEST_ASSERT_EQUAL_UINT64(mesh->vertex_count, c.vertices);
        TEST_ASSERT_EQUAL_UINT64(mesh->triangle_count, c.triangles);
        TEST_ASSERT_EQUAL_UINT64(0, c.collapsed + c.degenerate + c.duplicates + c.unused_vertices);
        TEST_ASSERT_TRUE(c.volume > 0);
    }
}

/* Noise of all densities, to the window's border. */
static void test_levels_of_noise_are_closed_manifolds(void)
{
    static const int32_t percents[] = {3, 30, 50, 70, 97, 100};

    for (size_t i = 0; i < COUNT(percents); i++)
        for (int32_t round = 0; round < (quick ? 2 : 12); round++) {
            int32_t resolutions[4] = {28, 23, 12, 5};
            make_grid(28, 23, 25, 0, odd_origin, odd_spacing);
            scatter(percents[i], 1 + round % 3);
            options.sampling.method = round % 2 ? BVX_LOD_COVERAGE : BVX_LOD_EDGE_RATIO;
            options.face_rule = round / 2 % 2;
            options.position_type = round / 4 % 2 ? BVX_F64 : BVX_F32;
            options.sampling.threshold = percents[i] == 3 ? 0.001 : thresholds[round % 3];
            options.resolutions = resolutions;
            must_build(4);
            for (int l = 0; l < 4; l++) certify(&level[l]);
            free_levels();
        }
}

/* Solids of a mesh, f32 at the coarsest lattice that it is allowed for, so that rounding has its say. */
static void test_levels_of_solids_are_closed_manifolds(void)
{
    static const double origin[3] = {32767 - 90, -32767, 100}, spacing[3] = {1, 1, 1};
    int32_t const resolutions[5] = {80, 47, 24, 11, 5};

    for (int32_t round = 0; round < (quick ? 2 : 8); round++) {
        maker_mesh m = {0};
        bvx_mesh_view view;
        double const centre[3] = {origin[0] + 40, origin[1] + 40, origin[2] + 40}, radius[3] = {39, 36, 30};
        maker_star(&m, &seed, centre, radius, round % 2 ? 0.3 : 0.05, 14, 22, 256);
        view = maker_view(&m);
        make_grid(80, 80, 80, 0, origin, spacing);
        {
            bvx_grid solid = {0};
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &grid.lattice, NULL, &solid));
            bvx_grid_free(ctx, &grid);
            grid = solid;
        }
        options.sampling.method = round % 4 < 2 ? BVX_LOD_EDGE_RATIO : BVX_LOD_COVERAGE;
        options.resolutions = resolutions;
        must_build(5);
        for (int l = 0; l < 5; l++) certify(&level[l]);
        free_levels();
        maker_free(&m);
    }
}

/* ---- by target ---- */

static uint64_t triangles_at(int32_t resolution)
{
    bvx_lod_options o = options;
    bvx_mesh m = {0};
    uint64_t count;
    bvx_status status;

    o.target_triangles = NULL;
    o.resolutions = &resolution;
    o.reports = NULL;
    status = bvx_build_lods(ctx, &grid, &o, 1, &m);
    TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_EMPTY);
    count = m.triangle_count;
    bvx_mesh_free(ctx, &m);
    return count;
}

/* Eight targets at a time; x is the longest axis. */
static void check_targets(int32_t most)
{
    uint64_t targets[MAX_LEVELS];

    for (int l = 0; l < MAX_LEVELS; l++) targets[l] = (uint64_t)(64 + maker_below(&seed, most) / (1 + l * l));
    options.target_triangles = targets;
    must_build(MAX_LEVELS);
    for (int l = 0; l < MAX_LEVELS; l++) {
        int32_t const r = report[l].resolution[0];
        TEST_ASSERT_TRUE(level[l].triangle_count > 0 && level[l].triangle_count <= targets[l]);
        TEST_ASSERT_EQUAL_UINT64(level[l].triangle_count, triangles_at(r));
        if (r < grid.size[0]) TEST_ASSERT_TRUE(triangles_at(r + 1) > targets[l]);
        TEST_ASSERT_TRUE(report[l].searched >= 2 && report[l].searched < 30);
    }
    free_levels();
    options.target_triangles = NULL;
}

static void test_targets_take_the_largest_resolution_that_keeps_them(void)
{
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++) {
        options.sampling.method = method;
        make_unit_grid(100, 80, 90);
        set_ball((const double[]){48, 41, 44}, 37);
        for (int i = 0; i < (quick ? 1 : 8); i++) check_targets(30000);
        set_box((const int32_t[]){40, 40, 0}, (const int32_t[]){47, 48, 90});
        for (int i = 0; i < (quick ? 1 : 8); i++) check_targets(10000);
        make_unit_grid(60, 50, 40); /* counts that jump up and down */
        scatter(50, 5);
        for (int i = 0; i < (quick ? 1 : 8); i++) check_targets(20000);
    }
}

static void test_a_target_above_the_finest_gives_the_own_resolution(void)
{
    uint64_t const target = UINT64_MAX;

    make_unit_grid(70, 50, 20);
    set_box((const int32_t[]){3, 3, 3}, (const int32_t[]){66, 44, 18});
    options.target_triangles = &target;
    must_build(1);
    TEST_ASSERT_EQUAL_INT32(70, report[0].resolution[0]);
    TEST_ASSERT_EQUAL_INT32(50, report[0].resolution[1]);
    TEST_ASSERT_EQUAL_INT32(20, report[0].resolution[2]);
}

static void test_a_target_below_the_coarsest_is_refused_by_name(void)
{
    uint64_t const targets[3] = {500, 100, 7};

    make_unit_grid(30, 30, 30);
    set_box((const int32_t[]){3, 3, 3}, (const int32_t[]){27, 27, 27});
    options.target_triangles = targets;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, build(3));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "level 2"));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "7 triangles"));
    for (int l = 0; l < 3; l++) TEST_ASSERT_NULL(level[l].positions);
}

/* A sheet between samples is lost at most resolutions: what others keep is found. */
static void test_a_target_finds_the_levels_that_keep_a_thin_sheet(void)
{
    uint64_t const targets[2] = {5200, 100};

    make_unit_grid(64, 64, 64);
    set_box((const int32_t[]){0, 0, 31}, (const int32_t[]){64, 64, 32});
    options.target_triangles = targets;
    must_build(1);
    TEST_ASSERT_TRUE(level[0].triangle_count > 0 && level[0].triangle_count <= 5200);
    free_levels();
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, build(2)); /* none keeps it in 100 triangles */
}

/* ---- windows, types, arrays ---- */

static void test_a_window_of_a_lattice_lies_at_its_place(void)
{
    bvx_grid part = {0}, whole;
    int32_t const resolution = 21;
    bvx_mesh other = {0};
    double const far[3] = {odd_origin[0] + 7 * odd_spacing[0], odd_origin[1] + 7 * odd_spacing[1],
                           odd_origin[2] + 7 * odd_spacing[2]};

    options.resolutions = &resolution;
    options.position_type = BVX_F64;
    make_grid(50, 40, 30, 7, odd_origin, odd_spacing);
    scatter(40, 4);
    must_build(1);
    whole = grid; /* the same bits as a lattice of their own */
    memset(&grid, 0, sizeof grid);
    make_grid(50, 40, 30, 0, far, odd_spacing);
    part = grid;
    grid = whole;
    memcpy(part.words, whole.words, (size_t)part.word_capacity * 8);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_lods(ctx, &part, &options, 1, &other));
    TEST_ASSERT_EQUAL_UINT64(other.vertex_count, level[0].vertex_count);
    for (uint64_t i = 0; i < 3 * other.vertex_count; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, ((double *)other.positions)[i], ((double *)level[0].positions)[i]);
    bvx_mesh_free(ctx, &other);
    bvx_grid_free(ctx, &part);
}

static void test_types_and_frames_hold_one_place(void)
{
    int32_t const resolution = 17;
    bvx_mesh f64;

    make_grid(40, 37, 31, 2, odd_origin, odd_spacing);
    scatter(50, 3);
    options.resolutions = &resolution;
    options.position_type = BVX_F64;
    must_build(1);
    f64 = level[0];
    memset(level, 0, sizeof level);
    for (int32_t i = 0; i < 4; i++) {
        options.position_type = i & 1 ? BVX_F64 : BVX_F32;
        options.local_frame = i >> 1;
        must_build(1);
        TEST_ASSERT_EQUAL_INT32(options.position_type, level[0].position_type);
        TEST_ASSERT_EQUAL_UINT64(f64.vertex_count, level[0].vertex_count);
        TEST_ASSERT_EQUAL_INT(0, memcmp(f64.triangles, level[0].triangles, (size_t)f64.triangle_count * 12));
        for (uint64_t v = 0; v < 3 * f64.vertex_count; v++) {
            double const at = i & 1 ? ((double *)level[0].positions)[v]
                                    : (double)((float *)level[0].positions)[v];
            double const truth = ((double *)f64.positions)[v];
            if (!options.local_frame)
                TEST_ASSERT_TRUE(level[0].frame[v % 3] == 0 && at == (i & 1 ? truth : (double)(float)truth));
            TEST_ASSERT_DOUBLE_WITHIN(i & 1 ? 1e-9 : 1e-5, truth, level[0].frame[v % 3] + at);
        }
        free_levels();
    }
    bvx_mesh_free(ctx, &f64);
}

static void test_f32_far_away_is_refused_and_local_is_not(void)
{
    static const double origin[3] = {500000, 5600000, 0}, spacing[3] = {0.01, 0.01, 0.01};
    int32_t const resolution = 10;

    make_grid(40, 40, 40, 0, origin, spacing);
    set_box((const int32_t[]){5, 5, 5}, (const int32_t[]){30, 30, 30});
    options.resolutions = &resolution;
    options.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, build(1));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "f64"));
    options.local_frame = 1;
    must_build(1);
    certify(&level[0]);
    TEST_ASSERT_EQUAL_DOUBLE(origin[1], level[0].frame[1]);
}

static void test_arrays_of_the_callers_are_filled(void)
{
    static float positions[2][3 * 4000];
    static uint32_t triangles[2][3 * 8000];
    int32_t const resolutions[2] = {16, 8};
    bvx_mesh made[2];

    make_unit_grid(40, 40, 40);
    set_ball((const double[]){20, 20, 20}, 17);
    options.resolutions = resolutions;
    must_build(2);
    memcpy(made, level, sizeof made);
    memset(level, 0, sizeof level);
    for (int round = 0; round < 2; round++) {
        for (int l = 0; l < 2; l++) {
            level[l].positions = positions[l];
            level[l].triangles = triangles[l];
            level[l].position_type = BVX_F32;
            level[l].vertex_capacity = made[l].vertex_count;
            level[l].triangle_capacity = made[l].triangle_count;
        }
        if (round == 1) level[1].triangle_capacity--;
        TEST_ASSERT_EQUAL_INT32(round == 0 ? BVX_OK : BVX_ERR_CAPACITY, build(2));
        for (int l = 0; l < 2; l++) {
            TEST_ASSERT_TRUE(level[l].positions == positions[l] && level[l].triangles == triangles[l] &&
                             !level[l].owned);
            TEST_ASSERT_EQUAL_UINT64(round == 0 ? made[l].triangle_count : 0, level[l].triangle_count);
            TEST_ASSERT_EQUAL_INT(0,
                                  memcmp(positions[l], made[l].positions, (size_t)made[l].vertex_count * 12));
            TEST_ASSERT_EQUAL_INT(
                0, memcmp(triangles[l], made[l].triangles, (size_t)made[l].triangle_count * 12));
        }
    }
    level[0].position_type = BVX_F64; /* the array is of floats */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build(1));
    memset(level, 0, sizeof level);
    for (int l = 0; l < 2; l++) bvx_mesh_free(ctx, &made[l]);
}

/* ---- refusals ---- */

static void refuses(bvx_status expected, const char *word)
{
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected, build(2), word);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    for (int l = 0; l < 2; l++) TEST_ASSERT_NULL(level[l].positions);
    TEST_ASSERT_EQUAL_UINT64(grid.word_capacity * 8, bvx_memory_used(ctx));
}

#define REFUSES(field, value, word)             \
    do {                                        \
        bvx_lod_options const before = options; \
        options.field = (value);                \
        refuses(BVX_ERR_ARGUMENT, word);        \
        options = before;                       \
    } while (0)

static void test_options_out_of_range_are_named(void)
{
    int32_t resolutions[2] = {10, 10}, axes[6] = {5, 5, 5, 5, 5, 5};
    uint64_t const targets[2] = {100, 100};

    make_unit_grid(20, 12, 16);
    set_box((const int32_t[]){2, 2, 2}, (const int32_t[]){18, 10, 14});
    options.resolutions = resolutions;
    REFUSES(sampling.method, 2, "method");
    REFUSES(sampling.method, 3, "method");
    REFUSES(sampling.threshold, 1.0, "threshold");
    REFUSES(sampling.threshold, -0.5, "threshold");
    REFUSES(sampling.threshold, (double)NAN, "threshold");
    REFUSES(sampling.edge_samples, -1, "edge_samples");
    REFUSES(sampling.edge_samples, 65537, "edge_samples");
    REFUSES(face_rule, 2, "face_rule");
    REFUSES(position_type, 3, "position_type");
    REFUSES(local_frame, 2, "local_frame");
    REFUSES(first_level, -1, "first_level");
    REFUSES(struct_size, 3, "size");
    REFUSES(resolutions, NULL, "resolutions");
    REFUSES(axis_resolutions, axes, "exactly one");
    REFUSES(target_triangles, targets, "exactly one");
    options.sampling.method = BVX_LOD_COVERAGE;
    REFUSES(sampling.edge_samples, 4, "edge_samples");
    for (int l = 0; l < 2; l++) {
        char name[16];
        snprintf(name, sizeof name, "level %d", l);
        for (int i = 0; i < 3; i++) {
            resolutions[l] = i == 0 ? 0 : i == 1 ? -1 : 21;
            refuses(BVX_ERR_RANGE, name);
        }
        resolutions[l] = 10;
    }
    options.resolutions = NULL;
    options.axis_resolutions = axes;
    axes[4] = 13; /* y of the second level: 12 are there */
    refuses(BVX_ERR_RANGE, "level 1");
    axes[4] = 12;
    must_build(2);
}

static void test_what_is_missing_is_named(void)
{
    int32_t const resolution = 5;
    bvx_grid none = {0};

    make_unit_grid(20, 12, 16);
    bvx_grid_set(&grid, 5, 5, 5, 1);
    options.resolutions = &resolution;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(NULL, &grid, &options, 1, level));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(ctx, NULL, &options, 1, level));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(ctx, &none, &options, 1, level));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(ctx, &grid, &options, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(ctx, &grid, &options, 0, level));
    /* no resolution is a default */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(ctx, &grid, NULL, 1, level));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "resolutions"));
}

/* The third of four levels keeps nothing: its number is said and none is left. */
static void test_a_level_that_keeps_nothing_fails_by_name(void)
{
    int32_t const resolutions[4] = {32, 16, 2, 32};

    make_unit_grid(32, 32, 32);
    /* samples of level 2 stand at 8 and 24 */
    set_box((const int32_t[]){17, 17, 17}, (const int32_t[]){22, 22, 22});
    options.resolutions = resolutions;
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++) {
        options.sampling.method = method;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build(4));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "level 2"));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "take more samples for it, or a lower threshold"));
        for (int l = 0; l < 4; l++)
            TEST_ASSERT_TRUE(level[l].positions == NULL && level[l].vertex_count == 0 &&
                             level[l].triangle_count == 0);
        TEST_ASSERT_EQUAL_UINT64(grid.word_capacity * 8, bvx_memory_used(ctx));
    }
}

static void test_an_empty_solid_is_empty_however_asked(void)
{
    int32_t const resolution = 5;
    uint64_t const target = 100;

    make_unit_grid(20, 12, 16);
    options.resolutions = &resolution;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build(1));
    options.resolutions = NULL;
    options.target_triangles = &target;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build(1));
}

/* ---- same bytes, memory, failures ---- */

static void backwards(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    (void)user;
    for (int32_t i = count; i-- > 0;) task(task_user, i, i % 5);
}

static void hash_levels(bvx_context *c, uint64_t hash[6])
{
    static const int32_t resolutions[2] = {40, 13};
    static const uint64_t targets[1] = {800};
    bvx_lod_options o = options;
    bvx_mesh m[2];

    for (int32_t i = 0; i < 4; i++) {
        uint64_t const count = i & 1 ? 1 : 2;
        memset(m, 0, sizeof m);
        o.sampling.method = i < 2 ? BVX_LOD_EDGE_RATIO : BVX_LOD_COVERAGE;
        o.resolutions = i & 1 ? NULL : resolutions;
        o.target_triangles = i & 1 ? targets : NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_lods(c, &grid, &o, count, m));
        for (uint64_t l = 0; l < count; l++) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(c, &m[l], hash++));
            bvx_mesh_free(c, &m[l]);
        }
    }
}

static void test_threads_and_processors_change_no_byte(void)
{
    uint64_t first[6], hash[6];

    make_unit_grid(90, 70, 80);
    scatter(50, 9);
    hash_levels(ctx, first);
    for (int32_t i = 1; i <= 9; i++)
        for (int32_t cpu = BVX_CPU_BEST; cpu <= BVX_CPU_PORTABLE; cpu++) {
            bvx_context_options o = {.struct_size = sizeof o};
            bvx_context *c;
            o.threads = i <= 8 ? i : 5;
            o.parallel.call = i <= 8 ? NULL : backwards;
            o.cpu = cpu;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &c));
            hash_levels(c, hash);
            TEST_ASSERT_EQUAL_HEX64_ARRAY(first, hash, 6);
            bvx_context_destroy(c);
        }
}

/* What the header says: the meshes, a coarse grid, 24 bytes a sample row
 * and column, 4 a sample for coverage; small change. */
static void test_memory_is_what_the_header_says(void)
{
    int32_t const resolution = 60;

    make_unit_grid(128, 128, 128);
    set_ball((const double[]){64, 64, 64}, 60);
    options.resolutions = &resolution;
    for (int32_t method = BVX_LOD_EDGE_RATIO; method <= BVX_LOD_COVERAGE; method++) {
        uint64_t allowed = 60 * 60 * 8 + 24 * (60 * 60 + 60) + 16384;
        options.sampling.method = method;
        bvx_memory_reset_peak(ctx);
        must_build(1);
        allowed += level[0].vertex_count * 12 + level[0].triangle_count * 12 + grid.word_capacity * 8;
        if (method == BVX_LOD_COVERAGE) allowed += 4 * 60 * 60 * 60;
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= allowed);
        free_levels();
    }
}

/* Scratch leaves an arena as it found it: three levels need little more room than the largest and the
 * meshes. */
static void test_an_arena_holds_the_levels_alone_afterwards(void)
{
    int32_t const resolutions[3] = {56, 60, 64}, largest = 64;
    uint64_t kept = 0, most = 0;
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *c;
    bvx_mesh m[3] = {{0}};
    void *arena;

    make_unit_grid(64, 64, 64);
    set_ball((const double[]){32, 32, 32}, 5);
    options.resolutions = resolutions;
    options.sampling.method = BVX_LOD_COVERAGE;
    bvx_memory_reset_peak(ctx);
    must_build(3);
    for (int l = 0; l < 3; l++) kept += level[l].vertex_count * 12 + level[l].triangle_count * 12;
    free_levels();
    options.resolutions = &largest;
    bvx_memory_reset_peak(ctx);
    must_build(1);
    most = bvx_memory_peak(ctx) - grid.word_capacity * 8;
    free_levels();
    options.resolutions = resolutions;
    o.arena.size = most + kept + 16384;
    o.arena.memory = arena = malloc((size_t)o.arena.size);
    TEST_ASSERT_NOT_NULL(arena);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &c));
    {
        bvx_status const status = bvx_build_lods(c, &grid, &options, 3, m);
        for (int l = 3; l-- > 0;) bvx_mesh_free(c, &m[l]);
        bvx_context_destroy(c);
        free(arena);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
    }
}

static bvx_status build_and_free(void *user, bvx_context *c)
{
    bvx_mesh m[2] = {{0}};
    bvx_status const status = bvx_build_lods(c, &grid, user, 2, m);
    for (int l = 0; l < 2; l++) {
        if (status == BVX_OK) bvx_mesh_free(c, &m[l]);
        else TEST_ASSERT_TRUE(m[l].positions == NULL && m[l].triangle_count == 0);
    }
    return status;
}

static void test_every_allocation_and_every_progress_call_may_fail(void)
{
    int32_t const resolutions[2] = {9, 4};
    uint64_t const targets[2] = {150, 40};
    bvx_context_options many = {.struct_size = sizeof many};

    many.threads = 5;
    many.parallel.call = backwards;
    make_unit_grid(18, 15, 16);
    set_ball((const double[]){9, 8, 8}, 6.5);
    for (int32_t i = 0; i < 4; i++) {
        uint64_t places = 0;
        options.sampling.method = i & 1 ? BVX_LOD_COVERAGE : BVX_LOD_EDGE_RATIO;
        options.resolutions = i < 2 ? resolutions : NULL;
        options.target_triangles = i < 2 ? NULL : targets;
        options.collapse = i == 3 ? 2 : 0;
        TEST_ASSERT_EQUAL_STRING(
            NULL, fault_every_allocation(build_and_free, &options, i & 1 ? &many : NULL, &places));
        TEST_ASSERT_TRUE(places >= 10);
        TEST_ASSERT_EQUAL_STRING(NULL,
                                 fault_every_cancel(build_and_free, &options, i & 1 ? &many : NULL, &places));
        TEST_ASSERT_TRUE(places >= 6); /* two levels, each samples, counts and emits */
    }
}

static void test_a_memory_limit_is_kept(void)
{
    int32_t const resolutions[2] = {30, 20};
    bvx_status status = BVX_ERR_BUDGET;

    make_unit_grid(60, 60, 60);
    set_ball((const double[]){30, 30, 30}, 25);
    options.resolutions = resolutions;
    for (uint64_t limit = 1000; status != BVX_OK; limit += 20000) {
        bvx_context_options o = {.struct_size = sizeof o};
        bvx_context *c;
        o.memory_limit = limit;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &c));
        status = build_and_free(&options, c);
        TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_BUDGET);
        TEST_ASSERT_TRUE(bvx_memory_peak(c) <= limit && bvx_memory_used(c) == 0);
        TEST_ASSERT_TRUE(limit < 1000000);
        bvx_context_destroy(c);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_edge_ratio_equals_the_reference_on_random_grids);
    RUN_TEST(test_coverage_equals_the_reference_on_random_grids);
    RUN_TEST(test_edge_ratio_at_named_ratios);
    RUN_TEST(test_coverage_at_named_ratios);
    RUN_TEST(test_inside_means_above_the_threshold);
    RUN_TEST(test_threshold_is_kept_in_steps);
    RUN_TEST(test_edge_samples_of_any_number);
    RUN_TEST(test_coverage_of_long_rows_and_wide_boxes);
    RUN_TEST(test_coverage_of_a_wide_box_that_stands_out_of_the_grid);
    RUN_TEST(test_longest_grids);
    RUN_TEST(test_own_resolution_is_the_surface_itself);
    RUN_TEST(test_a_ball_in_the_middle_keeps_volume_and_centre);
    RUN_TEST(test_a_ball_off_the_middle_keeps_volume_and_centre);
    RUN_TEST(test_a_box_keeps_its_faces_on_both_sides);
    RUN_TEST(test_a_full_grid_keeps_its_faces);
    RUN_TEST(test_levels_of_noise_are_closed_manifolds);
    RUN_TEST(test_levels_of_solids_are_closed_manifolds);
    RUN_TEST(test_targets_take_the_largest_resolution_that_keeps_them);
    RUN_TEST(test_a_target_above_the_finest_gives_the_own_resolution);
    RUN_TEST(test_a_target_below_the_coarsest_is_refused_by_name);
    RUN_TEST(test_a_target_finds_the_levels_that_keep_a_thin_sheet);
    RUN_TEST(test_a_window_of_a_lattice_lies_at_its_place);
    RUN_TEST(test_types_and_frames_hold_one_place);
    RUN_TEST(test_f32_far_away_is_refused_and_local_is_not);
    RUN_TEST(test_arrays_of_the_callers_are_filled);
    RUN_TEST(test_options_out_of_range_are_named);
    RUN_TEST(test_what_is_missing_is_named);
    RUN_TEST(test_a_level_that_keeps_nothing_fails_by_name);
    RUN_TEST(test_an_empty_solid_is_empty_however_asked);
    RUN_TEST(test_threads_and_processors_change_no_byte);
    RUN_TEST(test_memory_is_what_the_header_says);
    RUN_TEST(test_an_arena_holds_the_levels_alone_afterwards);
    RUN_TEST(test_every_allocation_and_every_progress_call_may_fail);
    RUN_TEST(test_a_memory_limit_is_kept);
    return UNITY_END();
}
