/* test_cast.c - rays against asking every voxel: once by the numbers that cast.c states, which must agree to
 * the last bit, and once by slabs in the world, which must agree up to rounding. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static uint64_t seed;
static bvx_grid grid;

void setUp(void)
{
    suite_open(0);
    seed = 99;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &grid);
    suite_close();
}

static void make_grid(const double origin[3], const double spacing[3], const int32_t low[3],
                      const int32_t size[3])
{
    int32_t const dims[3] = {low[0] + size[0] + 2, low[1] + size[1] + 1, low[2] + size[2]};
    bvx_window w;
    bvx_lattice l;

    memcpy(w.low, low, sizeof w.low);
    memcpy(w.size, size, sizeof w.size);
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &grid));
}

/* A grid of unit voxels from the origin on. */
static void make_plain(int32_t x, int32_t y, int32_t z)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t low[3] = {0, 0, 0};
    int32_t const size[3] = {x, y, z};
    make_grid(origin, spacing, low, size);
}

static void scatter(int32_t per_mille)
{
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                bvx_grid_set(&grid, x, y, z, maker_below(&seed, 1000) < per_mille);
}

static bvx_ray_hit cast_one(const double ray[6], double t_max)
{
    bvx_ray_hit hit;
    memset(&hit, 0x55, sizeof hit);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &grid, ray, 1, t_max, &hit));
    TEST_ASSERT_EQUAL_INT32(0, hit.reserved);
    return hit;
}

/* ---- Every voxel, by the numbers that cast.c states ---- */

/* When the ray is between planes i and i + 1 (of the lattice) of an axis:
 * [*enter, *leave], or always, or never. */
static void stated_slab(const double ray[6], int axis, int32_t i, double *enter, double *leave)
{
    double const u = (ray[axis] - grid.lattice.origin[axis]) / grid.lattice.spacing[axis];
    double const step = ray[3 + axis] / grid.lattice.spacing[axis], per = 1.0 / step;
    double const s = ((double)i - u) * per, t = ((double)i + 1.0 - u) * per;

    *enter = step > 0.0 ? s : t;
    *leave = step > 0.0 ? t : s;
    if (step != 0.0) return;
    *enter = -HUGE_VAL;
    *leave = u >= (double)i && u <= (double)i + 1.0 ? HUGE_VAL : -HUGE_VAL;
}

static bvx_ray_hit stated_cast(const double ray[6], double t_max)
{
    bvx_ray_hit best;

    memset(&best, 0, sizeof best);
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                int32_t const v[3] = {x, y, z};
                double from = 0.0, to = t_max;
                int32_t axis = -1;
                if (!bvx_grid_get(&grid, x, y, z)) continue;
                for (int a = 0; a < 3; a++) {
                    double enter, leave;
                    stated_slab(ray, a, v[a] + grid.low[a], &enter, &leave);
                    if (enter > from) {
                        from = enter;
                        axis = a;
                    }
                    to = leave < to ? leave : to;
                }
                /* the first in (z, y, x) wins ties */
                if (!(from <= to) || (best.hit && from >= best.t)) continue;
                best.hit = 1;
                best.t = from;
                best.axis = axis;
                memcpy(best.voxel, v, sizeof v);
                for (int a = 0; a < 3; a++) best.position[a] = ray[a] + from * ray[3 + a];
            }
    return best;
}

/* ---- Every voxel, by slabs in the world ---- */

static int world_slabs(const double ray[6], const int32_t v[3], double *t, double tolerance)
{
    double from = 0.0, to = HUGE_VAL;

    for (int a = 0; a < 3; a++) {
        double const low = grid.lattice.origin[a] + (v[a] + grid.low[a]) * grid.lattice.spacing[a];
        double const high = low + grid.lattice.spacing[a], d = ray[3 + a];
        double const slack = tolerance * grid.lattice.spacing[a];
        if (d == 0.0) {
            if (ray[a] < low - slack || ray[a] > high + slack) return 0;
            continue;
        }
        double const s = ((d > 0.0 ? low : high) - ray[a]) / d, e = ((d > 0.0 ? high : low) - ray[a]) / d;
        from = s > from ? s : from;
        to = e < to ? e : to;
    }
    *t = from;
    return from <= to + tolerance;
}

/* The hit's voxel is set and met at that t, and no set voxel is met clearly before. */
static void expect_world(const double ray[6], double t_max, const bvx_ray_hit *hit)
{
    double const eps = 1e-9;
    double t;

    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                int32_t const v[3] = {x, y, z};
                if (!bvx_grid_get(&grid, x, y, z) || !world_slabs(ray, v, &t, -eps) || t > t_max - eps)
                    continue;
                TEST_ASSERT_TRUE(hit->hit);
                TEST_ASSERT_TRUE(hit->t <= t + eps * (1 + t));
            }
    if (!hit->hit) return;
    TEST_ASSERT_TRUE(bvx_grid_get(&grid, hit->voxel[0], hit->voxel[1], hit->voxel[2]));
    TEST_ASSERT_TRUE(world_slabs(ray, hit->voxel, &t, eps));
    TEST_ASSERT_DOUBLE_WITHIN(eps * (1 + t), t, hit->t);
    TEST_ASSERT_TRUE(hit->t >= 0.0 && hit->t <= t_max);
}

/* Rays one by one, and in company: enough of them for bricks. */
enum { COMPANY = 256 };

static uint64_t hits_seen, misses_seen;

static void expect_all(const double rays[6 * COMPANY], double t_max)
{
    static bvx_ray_hit hits[COMPANY];

    memset(hits, 0x55, sizeof hits);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &grid, rays, COMPANY, t_max, hits));
    for (int i = 0; i < COMPANY; i++) {
        const double *const ray = rays + 6 * i;
        bvx_ray_hit const got = cast_one(ray, t_max), want = stated_cast(ray, t_max);
        TEST_ASSERT_EQUAL_INT32(want.hit, got.hit);
        TEST_ASSERT_EQUAL_INT32_ARRAY(want.voxel, got.voxel, 3);
        TEST_ASSERT_EQUAL_INT32(want.axis, got.axis);
        TEST_ASSERT_TRUE(want.t == got.t);
        TEST_ASSERT_EQUAL_MEMORY(want.position, got.position, sizeof got.position);
        TEST_ASSERT_EQUAL_MEMORY(&got, &hits[i], sizeof got);
        expect_world(ray, t_max, &got);
        if (got.hit) hits_seen++;
        else misses_seen++;
    }
}

/* ---- Tests ---- */

static void random_grid(int anisotropic)
{
    static const int32_t sides[7] = {1, 63, 64, 65, 127, 128, 129};
    double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t low[3] = {0, 0, 0}, size[3];

    size[0] = maker_below(&seed, 2) ? sides[maker_below(&seed, 7)] : 1 + maker_below(&seed, 20);
    size[1] = 1 + maker_below(&seed, 20);
    size[2] = 1 + maker_below(&seed, 20);
    for (int a = 0; a < 3 && anisotropic; a++) {
        origin[a] = maker_between(&seed, -50, 50, 1000);
        spacing[a] = maker_between(&seed, 0.1, 3, 1000);
        low[a] = maker_below(&seed, 70);
    }
    make_grid(origin, spacing, low, size);
}

/* A place in voxels of the window; from -3 to 3 beyond it, a multiple of 1/steps. */
static double world_place(int a, int32_t steps)
{
    double const at = maker_between(&seed, -3, grid.size[a] + 3, steps);
    return grid.lattice.origin[a] + (at + grid.low[a]) * grid.lattice.spacing[a];
}

static void test_cast_equals_asking_every_voxel(void)
{
    static const int32_t densities[5] = {0, 1, 5, 100, 1000};
    double rays[6 * COMPANY];

    hits_seen = misses_seen = 0;
    for (int round = 0; round < 60; round++) {
        random_grid(1);
        scatter(densities[round % 5]);
        for (int i = 0; i < COMPANY; i++) {
            double *const ray = rays + 6 * i;
            do
                for (int a = 0; a < 3; a++) {
                    ray[a] = world_place(a, 1000);
                    ray[3 + a] = i % 4 == 3 && a != i / 4 % 3 ? 0.0 : world_place(a, 1000) - ray[a];
                }
            while (ray[3] == 0.0 && ray[4] == 0.0 && ray[5] == 0.0);
        }
        expect_all(rays, round % 4 == 0 ? maker_between(&seed, 0, 2, 100) : round % 16 == 1 ? 0.0 : HUGE_VAL);
    }
    TEST_ASSERT_TRUE(hits_seen > 2000 && misses_seen > 2000);
}

/* Starts on planes, edges and corners, directions along axes and diagonals: everything ties. */
static void test_cast_through_edges_and_corners(void)
{
    static const int32_t densities[4] = {2, 10, 100, 500};
    double rays[6 * COMPANY];

    hits_seen = misses_seen = 0;
    for (int round = 0; round < 60; round++) {
        random_grid(0);
        scatter(densities[round % 4]);
        for (int i = 0; i < COMPANY; i++) {
            double *const ray = rays + 6 * i;
            do
                for (int a = 0; a < 3; a++) {
                    ray[a] = world_place(a, i % 3 == 0 ? 2 : 1);
                    ray[3 + a] = (maker_below(&seed, 3) - 1) * (i % 7 == 0 ? 1 + maker_below(&seed, 3) : 1);
                }
            while (ray[3] == 0.0 && ray[4] == 0.0 && ray[5] == 0.0);
        }
        expect_all(rays, round % 4 == 0 ? maker_below(&seed, 9) : HUGE_VAL);
    }
    TEST_ASSERT_TRUE(hits_seen > 2000 && misses_seen > 2000);
}

/* One layer of voxels with x + y + z constant touches only across edges;
 * yet no ray passes, least of all through corners. */
static void test_cast_does_not_pass_a_diagonal_wall(void)
{
    enum { RAYS = 4000 };
    static double rays[6 * RAYS];
    static bvx_ray_hit hits[RAYS];
    make_plain(70, 24, 24);
    for (int32_t z = 0; z < 24; z++)
        for (int32_t y = 0; y < 24; y++)
            for (int32_t x = 0; x < 70; x++) bvx_grid_set(&grid, x, y, z, x + y + z == 60);
    for (int i = 0; i < RAYS; i++) {
        int32_t const steps = i % 2 ? 1 : 1000;
        double ends[2][3]; /* below the wall and above it */
        for (int a = 0; a < 3; a++) {
            ends[0][a] = maker_between(&seed, 0, a == 0 ? 12 : 22, steps);
            ends[1][a] = maker_between(&seed, a == 0 ? 64 : 1, a == 0 ? 70 : 24, steps);
            if (i % 3 != 0) continue;
            ends[0][a] = a == 0 ? 20 : maker_between(&seed, 0, 10, steps); /* along the diagonal */
            ends[1][a] = ends[0][a] + 14;
        }
        for (int a = 0; a < 3; a++) {
            rays[6 * i + a] = ends[i % 5 == 0][a];
            rays[6 * i + 3 + a] = ends[i % 5 != 0][a] - ends[i % 5 == 0][a];
        }
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &grid, rays, RAYS, 1.0, hits));
    for (int i = 0; i < RAYS; i++) {
        bvx_ray_hit const alone = cast_one(rays + 6 * i, 1.0);
        TEST_ASSERT_EQUAL_MEMORY(&alone, &hits[i], sizeof alone);
        TEST_ASSERT_TRUE(hits[i].hit);
        TEST_ASSERT_EQUAL_INT32(60, hits[i].voxel[0] + hits[i].voxel[1] + hits[i].voxel[2]);
    }
}

static void test_cast_by_hand(void)
{
    static const double along[6] = {-2, 1.5, 2.5, 4, 0, 0}, inside[6] = {65.5, 1.5, 2.5, 1, 1, 1};
    static const double on_face[6] = {65, 1.5, 2.5, -1, 0, 0}, down[6] = {65.25, 1.5, 40, 0, 0, -2};
    static const double between[6] = {0.5, 1, 2.5, 1, 0, 0}, beside[6] = {0.5, 4.001, 2.5, 1, 0, 0};
    bvx_ray_hit hit;

    make_plain(130, 4, 5);
    bvx_grid_set(&grid, 65, 1, 2, 1);
    hit = cast_one(along, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 16.75 && hit.axis == 0);
    TEST_ASSERT_TRUE(hit.voxel[0] == 65 && hit.voxel[1] == 1 && hit.voxel[2] == 2);
    TEST_ASSERT_TRUE(hit.position[0] == 65.0 && hit.position[1] == 1.5 && hit.position[2] == 2.5);
    hit = cast_one(along, 16.75);
    TEST_ASSERT_TRUE(hit.hit == 1);
    hit = cast_one(along, 16.74);
    TEST_ASSERT_TRUE(hit.hit == 0 && hit.t == 0.0 && hit.axis == 0 && hit.position[0] == 0.0);
    hit = cast_one(inside, 0.0);
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 0.0 && hit.axis == -1 && hit.position[0] == 65.5);
    hit = cast_one(on_face, 3.0); /* closed boxes: the start touches it */
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 0.0 && hit.axis == -1);
    hit = cast_one(down, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 18.5 && hit.axis == 2);
    hit = cast_one(between, HUGE_VAL); /* slides between rows 0 and 1 */
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 64.5 && hit.voxel[1] == 1);
    bvx_grid_set(&grid, 65, 0, 2, 1);
    hit = cast_one(between, HUGE_VAL); /* both: the lower is reported */
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 64.5 && hit.voxel[1] == 0);
    hit = cast_one(beside, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 0);
}

/* Far starts, long and short directions: right up to rounding where that means something, and never
 * nonsense. */
static void test_cast_at_the_ends_of_doubles(void)
{
    static const double far[6] = {-1e300, 1.5, 2.5, 1e290, 0, 0}, back[6] = {1e15, 1.5, 2.5, -1, 0, 0};
    static const double away[6] = {1e300, 1.5, 2.5, 1, 0, 0};
    static const double skew[6] = {-1e9, -1e9, -1e9, 1e9 + 65, 1e9 + 1.5, 1e9 + 2.5};
    static const double least[6] = {64.5, 1.5, 2.5, 5e-324, 0, 0};
    static const double vast[6] = {-5, -5, -5, 1.7e308, 1.7e308, 1.7e308};
    static const double diagonal[6] = {-1e300, -1e300, -1e300, 1, 1, 1};
    bvx_ray_hit hit;

    make_plain(130, 4, 5);
    bvx_grid_set(&grid, 65, 1, 2, 1);
    hit = cast_one(far, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 1 && fabs(hit.t - 1e10) < 1e-5 && hit.voxel[0] == 65);
    hit = cast_one(back, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.t == 1e15 - 66 && hit.voxel[0] == 65);
    hit = cast_one(away, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 0);
    hit = cast_one(skew, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 1 && fabs(hit.t - 1.0) < 1e-8);
    hit = cast_one(least, HUGE_VAL); /* it does not come to the next voxel before t ends */
    TEST_ASSERT_TRUE(hit.hit == 0);
    hit = cast_one(vast, HUGE_VAL); /* x = y = z: not through (65, 1, 2) */
    TEST_ASSERT_TRUE(hit.hit == 0);
    bvx_grid_set(&grid, 3, 3, 3, 1);
    hit = cast_one(vast, HUGE_VAL);
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.voxel[0] == 3 && hit.t > 0.0 && hit.t < 1e-300);
    hit = cast_one(diagonal, HUGE_VAL); /* all planes at one t: some set voxel or none, and an end */
    if (hit.hit) TEST_ASSERT_TRUE(bvx_grid_get(&grid, hit.voxel[0], hit.voxel[1], hit.voxel[2]));
    grid.lattice.spacing[0] = grid.lattice.spacing[1] = grid.lattice.spacing[2] = 5e-324;
    hit = cast_one(far, HUGE_VAL); /* beyond doubles in voxels */
    TEST_ASSERT_TRUE(hit.hit == 0);
}

/* What lies in the window is hit as in the whole lattice. */
static void test_cast_is_the_same_in_a_window(void)
{
    static const double origin[3] = {0.1, 0.2, 0.3}, spacing[3] = {0.7, 0.9, 1.1};
    static const int32_t none[3] = {0, 0, 0};
    static const int32_t size[3] = {150, 30, 30};
    static const int32_t low[3] = {37, 11, 7};
    static const int32_t part[3] = {70, 10, 15};
    bvx_grid whole;
    uint64_t hits = 0;

    make_grid(origin, spacing, none, size);
    for (int i = 0; i < 40; i++) {
        int32_t const x = low[0] + maker_below(&seed, part[0]), y = low[1] + maker_below(&seed, part[1]);
        bvx_grid_set(&grid, x, y, low[2] + maker_below(&seed, part[2]), 1);
    }
    whole = grid;
    memset(&grid, 0, sizeof grid);
    make_grid(origin, spacing, low, part);
    grid.lattice = whole.lattice;
    for (int32_t z = 0; z < part[2]; z++)
        for (int32_t y = 0; y < part[1]; y++)
            for (int32_t x = 0; x < part[0]; x++)
                bvx_grid_set(&grid, x, y, z, bvx_grid_get(&whole, low[0] + x, low[1] + y, low[2] + z));
    for (int i = 0; i < 20000; i++) {
        double ray[6];
        bvx_ray_hit in_whole, in_part;
        for (int a = 0; a < 3; a++) {
            ray[a] = maker_between(&seed, -10, 120, 1000);
            ray[3 + a] = maker_between(&seed, 0.2 + 0.7 * low[a], 0.2 + 0.9 * (low[a] + part[a]), 1000) -
                         ray[a];
        }
        in_part = cast_one(ray, HUGE_VAL);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &whole, ray, 1, HUGE_VAL, &in_whole));
        for (int a = 0; a < 3 && in_part.hit; a++) in_part.voxel[a] += low[a];
        TEST_ASSERT_EQUAL_MEMORY(&in_whole, &in_part, sizeof in_part);
        hits += (uint64_t)in_part.hit;
    }
    TEST_ASSERT_TRUE(hits > 1000);
    bvx_grid_free(ctx, &whole);
}

static void test_cast_is_the_same_for_any_threads(void)
{
    enum { RAYS = 3000 };
    static double rays[6 * RAYS];
    static bvx_ray_hit one[RAYS], many[RAYS];
    bvx_context_options o = {.struct_size = sizeof o};
    make_plain(100, 50, 50);
    scatter(5);
    for (int i = 0; i < 6 * RAYS; i++)
        rays[i] = maker_between(&seed, -10, 60, 100) - (i % 6 > 2 ? 25.005 : 0);
    for (o.threads = 1; o.threads <= 8; o.threads++) {
        bvx_context *other;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvx_grid_cast(other, &grid, rays, RAYS, 1e9, o.threads == 1 ? one : many));
        if (o.threads > 1) TEST_ASSERT_EQUAL_MEMORY(one, many, sizeof one);
        bvx_context_destroy(other);
    }
    for (int i = 0; i < RAYS; i += 37) { /* and the same alone as in company */
        bvx_ray_hit const hit = cast_one(rays + 6 * i, 1e9);
        TEST_ASSERT_EQUAL_MEMORY(&one[i], &hit, sizeof hit);
    }
}

/* ---- Bricks kept ---- */

static bvx_rays *caster;

/* One by one and together by the handle, as without bricks. */
static void expect_kept(const double rays[6 * COMPANY])
{
    static bvx_ray_hit hits[COMPANY];

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_cast(ctx, caster, rays, COMPANY, 1e9, hits));
    for (int i = 0; i < COMPANY; i++) {
        bvx_ray_hit const want = cast_one(rays + 6 * i, 1e9);
        bvx_ray_hit got;
        memset(&got, 0x55, sizeof got);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_cast(ctx, caster, rays + 6 * i, 1, 1e9, &got));
        TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
        TEST_ASSERT_EQUAL_MEMORY(&want, &hits[i], sizeof got);
        hits_seen += (uint64_t)got.hit;
    }
}

/* A window of the lattice that begins and ends in, at or beyond the grid's own; where they meet voxels change. */
static bvx_window change_part(int32_t per_mille)
{
    bvx_window w;
    int32_t low[3], end[3];

    for (int a = 0; a < 3; a++) {
        w.low[a] = maker_below(&seed, grid.lattice.dims[a]);
        w.size[a] = 1 + maker_below(&seed, grid.lattice.dims[a] - w.low[a]);
        low[a] = w.low[a] > grid.low[a] ? w.low[a] - grid.low[a] : 0;
        end[a] = w.low[a] + w.size[a] - grid.low[a];
        end[a] = end[a] < grid.size[a] ? end[a] : grid.size[a];
    }
    for (int32_t z = low[2]; z < end[2]; z++)
        for (int32_t y = low[1]; y < end[1]; y++)
            for (int32_t x = low[0]; x < end[0]; x++)
                bvx_grid_set(&grid, x, y, z, maker_below(&seed, 1000) < per_mille);
    return w;
}

/* Whole grids and changes by windows, also to nothing and to all. */
static void test_bricks_kept_give_the_same_hits(void)
{
    static const int32_t densities[5] = {0, 1, 5, 100, 1000};
    double rays[6 * COMPANY];

    hits_seen = 0;
    for (int round = 0; round < 30; round++) {
        random_grid(1);
        scatter(densities[round % 5]);
        for (int i = 0; i < 6 * COMPANY; i++) rays[i] = world_place(i % 3, 1000);
        for (int i = 0; i < 6 * COMPANY; i++)
            if (i % 6 > 2) rays[i] -= rays[i - 3] - 1e-3;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_create(ctx, &grid, &caster));
        expect_kept(rays);
        for (int change = 0; change < 4; change++) {
            bvx_window const w = change_part(densities[(round + change) % 5]);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_update(ctx, caster, &grid, &w));
            expect_kept(rays);
        }
        bvx_rays_free(ctx, caster);
    }
    TEST_ASSERT_TRUE(hits_seen > 2000);
}

static int32_t stop_at_once(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)stage;
    (void)fraction;
    return 1;
}

/* Another grid's words by an update; a refused or stopped one leaves the handle as it was; no cast takes memory. */
static void test_an_update_is_whole_or_none(void)
{
    double const ray[6] = {-5, 1.5, 1.5, 1, 0, 0};
    bvx_context_options o = {.struct_size = sizeof o, .progress.call = stop_at_once};
    bvx_window const beside = {{0, 0, 0}, {10, 5, 5}};
    bvx_window bad = {{0, 0, 0}, {200, 1, 1}};
    bvx_context *stopping;
    bvx_grid other = {0};
    bvx_ray_hit hit;
    uint64_t held;

    make_plain(130, 4, 5);
    bvx_grid_set(&grid, 65, 1, 1, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &grid, &other));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &stopping));
    TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, bvx_rays_create(stopping, &grid, &caster));
    TEST_ASSERT_NULL(caster);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_create(ctx, &grid, &caster));
    held = bvx_memory_used(ctx);
    bvx_memory_reset_peak(ctx);

    TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, bvx_rays_update(stopping, caster, &other, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_rays_update(ctx, caster, &other, &bad));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_rays_update(ctx, caster, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_rays_update(ctx, NULL, &other, NULL));
    other.lattice.spacing[1] = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_LATTICE, bvx_rays_update(ctx, caster, &other, NULL));
    other.lattice = grid.lattice;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_cast(ctx, caster, ray, 1, 1e9, &hit));
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.voxel[0] == 65);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_update(ctx, caster, &other, &beside));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_cast(ctx, caster, ray, 1, 1e9, &hit));
    TEST_ASSERT_TRUE(hit.hit == 1 && hit.voxel[0] == 0);
    TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_peak(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_rays_cast(ctx, NULL, ray, 1, 1e9, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_rays_cast(ctx, caster, NULL, 1, 1e9, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_rays_cast(ctx, caster, ray, 1, -1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_rays_create(ctx, &grid, NULL));
    bvx_rays_free(ctx, caster);
    bvx_grid_free(ctx, &other);
    bvx_context_destroy(stopping);
}

static void test_cast_refuses_what_is_no_ray(void)
{
    double rays[12] = {0, 0, 0, 1, 0, 0, 5, 5, 5, 0, 1, 0};
    bvx_ray_hit hits[2];
    bvx_grid good;
    uint64_t held;

    make_plain(5, 5, 5);
    held = bvx_memory_used(ctx);
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &grid, rays, 2, 1, hits));
    TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_peak(ctx)); /* none for few rays */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &grid, NULL, 0, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(NULL, &grid, rays, 2, 1, hits));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, NULL, rays, 2, 1, hits));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, &grid, NULL, 2, 1, hits));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "rays is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, &grid, rays, 2, 1, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "hits is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, &grid, rays, 2, -1, hits));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, &grid, rays, 2, nan(""), hits));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "t_max"));
    rays[10] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, &grid, rays, 2, 1, hits));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "ray 1 has a direction of length 0"));
    for (int k = 0; k < 6; k++) {
        static const char *const part[6] = {"origin x",    "origin y",    "origin z",
                                            "direction x", "direction y", "direction z"};
        double const kept = rays[k];
        rays[k] = k % 2 ? HUGE_VAL : nan("");
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_cast(ctx, &grid, rays, 2, 1, hits));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "ray 0"));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), part[k]));
        rays[k] = kept;
    }
    good = grid;
    grid.words_per_row = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_cast(ctx, &grid, rays, 1, 1, hits));
    grid = good;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cast_equals_asking_every_voxel);
    RUN_TEST(test_cast_through_edges_and_corners);
    RUN_TEST(test_cast_does_not_pass_a_diagonal_wall);
    RUN_TEST(test_cast_by_hand);
    RUN_TEST(test_cast_at_the_ends_of_doubles);
    RUN_TEST(test_cast_is_the_same_in_a_window);
    RUN_TEST(test_cast_is_the_same_for_any_threads);
    RUN_TEST(test_bricks_kept_give_the_same_hits);
    RUN_TEST(test_an_update_is_whole_or_none);
    RUN_TEST(test_cast_refuses_what_is_no_ray);
    return UNITY_END();
}
