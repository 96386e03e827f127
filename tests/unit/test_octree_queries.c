/* test_octree_queries.c - rays and neighbours against a look at every leaf. */
#include "tools/mesh_maker.h"

#include "suite.h"

static bvx_octree *tree;
static bvx_octree_leaf *leaf;
static uint64_t count;
static bvx_lattice lattice;
static uint64_t seed;

static void make_tree(int32_t nx, int32_t ny, int32_t nz, int32_t levels)
{
    const double origin[3] = {1, -2, 0.5}, spacing[3] = {1, 0.5, 2};
    const int32_t dims[3] = {nx, ny, nz};
    double centre[3], radius[3];
    bvx_lattice base;
    bvx_refine_options o = {.struct_size = sizeof o};
    maker_mesh m = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &base));
    for (int a = 0; a < 3; a++) {
        centre[a] = origin[a] + 0.5 * dims[a] * spacing[a];
        radius[a] = 0.4 * dims[a] * spacing[a];
    }
    maker_star(&m, &seed, centre, radius, 0.2, 6, 8, 1024);
    bvx_mesh_view const view = maker_view(&m);
    o.levels = levels != 0 ? levels : BVX_NONE;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree));
    maker_free(&m);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, tree, levels, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, NULL, 0, &count));
    leaf = maker_grow(NULL, (size_t)count * sizeof *leaf);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, leaf, count, &count));
}

static void drop_tree(void)
{
    bvx_octree_free(ctx, tree);
    free(leaf);
    tree = NULL;
    leaf = NULL;
}

void setUp(void)
{
    suite_open(0);
    seed = 19;
}

void tearDown(void)
{
    drop_tree();
    suite_close();
}

/* Low and high corner of a leaf [Units: voxels of the last level]. */
static void box_of(const bvx_octree_leaf *l, int32_t low[3], int32_t high[3])
{
    int32_t const up = bvx_octree_levels(tree) - l->level;
    for (int a = 0; a < 3; a++) {
        low[a] = l->ijk[a] << up;
        high[a] = (l->ijk[a] + 1) << up;
    }
}

/* ---- rays ---- */

static int meets(const double ray[6], double t_max, const bvx_octree_leaf *l, double *t)
{
    int32_t low[3], high[3];
    double enter = 0, leave = t_max;

    box_of(l, low, high);
    for (int a = 0; a < 3; a++) {
        double const u = (ray[a] - lattice.origin[a]) / lattice.spacing[a];
        double const step = ray[3 + a] / lattice.spacing[a];
        double const per = 1 / step;
        if (step == 0) {
            if (u < low[a] || u > high[a]) return 0;
            continue;
        }
        double const p = (low[a] - u) * per, q = (high[a] - u) * per;
        if ((p < q ? p : q) > enter) enter = p < q ? p : q;
        if ((p < q ? q : p) < leave) leave = p < q ? q : p;
    }
    *t = enter;
    return enter <= leave;
}

static int before_in_space(const bvx_octree_leaf *a, const bvx_octree_leaf *b)
{
    int32_t p[3], q[3], high[3];
    box_of(a, p, high);
    box_of(b, q, high);
    for (int k = 2; k >= 0; k--)
        if (p[k] != q[k]) return p[k] < q[k];
    return 0;
}

static uint64_t check_rays(int32_t states, int on_lattice)
{
    enum { RAYS = 300 };
    static double rays[6 * RAYS];
    static bvx_octree_hit hits[RAYS];
    int32_t const wanted = states != 0 ? states : BVX_STATE_SURFACE | BVX_STATE_INSIDE;
    uint64_t hit = 0;
    for (int i = 0; i < RAYS; i++)
        for (int a = 0; a < 3; a++) {
            double const side = lattice.dims[a] * lattice.spacing[a];
            double const way = maker_between(&seed, -1, 1, 64);
            if (on_lattice) { /* through planes, edges and corners of voxels */
                rays[6 * i + a] = lattice.origin[a] +
                                  maker_below(&seed, lattice.dims[a] + 5) * lattice.spacing[a] -
                                  2 * lattice.spacing[a];
                rays[6 * i + 3 + a] = (maker_below(&seed, 3) - 1) * lattice.spacing[a];
            } else {
                rays[6 * i + a] = lattice.origin[a] + side * maker_between(&seed, -0.3, 1.3, 1000);
                rays[6 * i + 3 + a] = i % 4 == a ? 0 : way;
            }
            if (a == 2 && rays[6 * i + 3] == 0 && rays[6 * i + 4] == 0 && rays[6 * i + 5] == 0)
                rays[6 * i + 5] = 1;
        }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_cast(ctx, tree, states, rays, RAYS, 20, hits));
    for (int i = 0; i < RAYS; i++) {
        const bvx_octree_leaf *best = NULL;
        double best_t = 0, t;
        for (uint64_t n = 0; n < count; n++) {
            if ((leaf[n].state & wanted) == 0 || !meets(rays + 6 * i, 20, &leaf[n], &t)) continue;
            if (best != NULL && (t > best_t || (t == best_t && !before_in_space(&leaf[n], best)))) continue;
            best = &leaf[n];
            best_t = t;
        }
        TEST_ASSERT_EQUAL_INT32(best != NULL, hits[i].hit);
        if (best == NULL) continue;
        hit++;
        TEST_ASSERT_EQUAL_MEMORY(best, &hits[i].leaf, sizeof *best);
        TEST_ASSERT_TRUE(best_t == hits[i].t);
        TEST_ASSERT_EQUAL_INT(best_t == 0, hits[i].axis == -1);
        for (int a = 0; a < 3; a++)
            TEST_ASSERT_TRUE(hits[i].position[a] == rays[6 * i + a] + hits[i].t * rays[6 * i + 3 + a]);
    }
    return hit;
}

static void test_rays_meet_the_first_leaf(void)
{
    static const int32_t shapes[4][4] = {{4, 4, 4, 3}, {1, 1, 1, 4}, {7, 2, 3, 2}, {3, 5, 4, 0}};

    for (int i = 0; i < 4; i++) {
        make_tree(shapes[i][0], shapes[i][1], shapes[i][2], shapes[i][3]);
        TEST_ASSERT_GREATER_THAN(20, check_rays(0, 0));
        check_rays(0, 1);
        check_rays(BVX_STATE_OUTSIDE, 0);
        check_rays(BVX_STATE_INSIDE, 1);
        check_rays(7, 1);
        drop_tree();
    }
}

/* ---- neighbours ---- */

static void test_neighbours_share_a_face(void)
{
    uint64_t pairs = 0, back = 0;

    make_tree(3, 2, 3, 3);
    for (uint64_t n = 0; n < count; n++)
        for (int32_t d = 0; d < 6; d++) {
            bvx_octree_leaf beside[70];
            int32_t low[3], high[3];
            uint64_t found = 0, want = 0, again = 0;
            box_of(&leaf[n], low, high);
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvx_octree_neighbours(ctx, tree, &leaf[n], d, beside, 70, &found));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_neighbours(ctx, tree, &leaf[n], d, NULL, 0, &again));
            TEST_ASSERT_EQUAL_UINT64(found, again);
            for (uint64_t k = 0; k < count; k++) {
                int32_t l[3], h[3];
                int shares = 1;
                box_of(&leaf[k], l, h);
                for (int a = 0; a < 3; a++) {
                    if (a == d % 3) shares &= d >= 3 ? l[a] == high[a] : h[a] == low[a];
                    else shares &= l[a] < high[a] && h[a] > low[a];
                }
                if (!shares) continue;
                want++;
                int listed = 0;
                for (uint64_t i = 0; i < found; i++)
                    listed += memcmp(&beside[i], &leaf[k], sizeof leaf[k]) == 0;
                TEST_ASSERT_EQUAL_INT(1, listed);
            }
            TEST_ASSERT_EQUAL_UINT64(want, found);
            *(d < 3 ? &pairs : &back) += found;
            if (found > 1)
                TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_octree_neighbours(ctx, tree, &leaf[n], d,
                                                                                beside, found - 1, &again));
        }
    TEST_ASSERT_EQUAL_UINT64(pairs, back);
    TEST_ASSERT_GREATER_THAN(100, pairs);
}

static void test_refusals(void)
{
    double ray[6] = {0, 0, 0, 0, 0, 0};
    bvx_octree_hit hit;
    bvx_octree_leaf none = {{0, 0, 0}, 9, 1, {0, 0}};
    uint64_t n;

    make_tree(2, 2, 2, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_cast(ctx, tree, 0, ray, 1, 1, &hit));
    ray[3] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_cast(ctx, tree, 0, ray, 1, -1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_cast(ctx, tree, 8, ray, 1, 1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_cast(ctx, tree, 0, NULL, 1, 1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_cast(ctx, tree, 0, ray, 1, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_cast(ctx, NULL, 0, ray, 1, 1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_cast(ctx, tree, 0, NULL, 0, 1, NULL));
    ray[0] = 1e308 * 10;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_octree_cast(ctx, tree, 0, ray, 1, 1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_octree_neighbours(ctx, tree, &none, 0, NULL, 0, &n));
    none.level = 1;
    none.ijk[2] = 4;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_octree_neighbours(ctx, tree, &none, 0, NULL, 0, &n));
    none.ijk[2] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_neighbours(ctx, tree, &none, 6, NULL, 0, &n));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_neighbours(ctx, tree, &none, 2, NULL, 0, &n));
    TEST_ASSERT_EQUAL_UINT64(0, n);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rays_meet_the_first_leaf);
    RUN_TEST(test_neighbours_share_a_face);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
