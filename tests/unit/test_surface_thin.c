/* test_surface_thin.c - the thin surface against its definition, and what
 * it is for: it keeps apart what a solid is and is not. */
#include "surface_voxels_support.h"

static void test_small_triangles_meet_axis_crosses(void)
{
    check_small_triangles(THIN, quick ? 150 : 1200);
}

static void test_meshes_and_windows_are_the_oracles(void)
{
    check_meshes(THIN, quick ? 24 : 240);
}

static void test_order_types_and_strides_change_nothing(void)
{
    check_views(THIN);
}

static void test_contexts_and_windows_agree(void)
{
    check_contexts(THIN);
}

static void test_workers_share_the_triangles(void)
{
    check_workers(THIN);
}

/* ---- Closed meshes ---- */

enum { STAR, STARS, CUBES, TETRAHEDRA, ALIGNED_BOXES, CLOSED_KINDS };

static void make_closed(int32_t kind, const int32_t n[3])
{
    maker_clear(&mesh);
    switch (kind) {
    case STAR:
    case STARS:
        for (int i = 0; i < (kind == STAR ? 1 : 3); i++) {
            double centre[3], radius[3];
            for (int a = 0; a < 3; a++) {
                radius[a] = n[a] * (kind == STAR ? 0.42 : 0.2 + 0.05 * i);
                centre[a] = n[a] * 0.5 + (kind == STAR ? 0 : maker_below(&seed, 7) - 3);
            }
            maker_star(&mesh, &seed, centre, radius, 0.4, 5 + maker_below(&seed, 20),
                       7 + maker_below(&seed, 20), maker_below(&seed, 2) ? 65536 : 2);
        }
        break;
    case CUBES: { /* faces on lattice planes, or on planes of centres */
        int32_t const size[3] = {n[0] - 4, n[1] - 4, n[2] - 4};
        double const at[3] = {2 + 0.5 * maker_below(&seed, 2), 2, 2 + 0.5 * maker_below(&seed, 2)};
        size_t const voxels = (size_t)size[0] * (size_t)size[1] * (size_t)size[2];
        uint8_t *const solid = maker_grow(NULL, voxels);
        for (size_t i = 0; i < voxels; i++) solid[i] = (uint8_t)(maker_below(&seed, 3) == 0);
        maker_cubes(&mesh, &seed, solid, size, at);
        free(solid);
        break;
    }
    case TETRAHEDRA:
        for (int i = 0; i < 6; i++) {
            uint32_t v[4];
            for (int c = 0; c < 4; c++) {
                double const x = maker_between(&seed, 1, n[0] - 1, 8);
                double const y = maker_between(&seed, 1, n[1] - 1, 8);
                v[c] = maker_vertex(&mesh, x, y, maker_between(&seed, 1, n[2] - 1, 8));
            }
            maker_tetrahedron(&mesh, v[0], v[1], v[2], v[3]);
        }
        break;
    default:
        for (int i = 0; i < 4; i++) {
            double low[3], high[3];
            for (int a = 0; a < 3; a++) {
                low[a] = 1 + 0.5 * maker_below(&seed, n[a]);
                high[a] = low[a] + 0.5 * (1 + maker_below(&seed, n[a]));
                if (high[a] > n[a] - 1) high[a] = n[a] - 1;
                if (low[a] >= high[a]) low[a] = high[a] - 0.5;
            }
            maker_box(&mesh, low, high);
        }
    }
}

/* Of two neighbours on different sides at least one is marked. The solid ends within the lattice. */
static void assert_separates(const bvx_grid *solid, const bvx_grid *thin)
{
    uint64_t pairs = 0;

    for (int32_t z = 0; z < solid->size[2]; z++)
        for (int32_t y = 0; y < solid->size[1]; y++)
            for (int32_t x = 0; x < solid->size[0]; x++)
                for (int a = 0; a < 3; a++) {
                    int32_t const u = x + (a == 0), v = y + (a == 1), w = z + (a == 2);
                    if (u >= solid->size[0] || v >= solid->size[1] || w >= solid->size[2]) continue;
                    if (bvx_grid_get(solid, x, y, z) == bvx_grid_get(solid, u, v, w)) continue;
                    pairs++;
                    TEST_ASSERT_TRUE(bvx_grid_get(thin, x, y, z) || bvx_grid_get(thin, u, v, w));
                }
    TEST_ASSERT_TRUE(pairs > 0);
}

/* A flood across faces from the lattice's sides over unmarked voxels stays
 * outside the solid, one from an inner voxel inside. */
static void assert_floods_stay(const bvx_grid *solid, const bvx_grid *thin)
{
    int32_t const nx = solid->size[0], ny = solid->size[1], nz = solid->size[2];
    size_t const n = (size_t)nx * (size_t)ny * (size_t)nz;
    int32_t *const stack = maker_grow(NULL, n * sizeof *stack);
    uint8_t *const seen = maker_grow(NULL, n);

    memset(seen, 0, n);
    for (size_t start = 0; start < n; start++) {
        size_t depth = 0;
        int const side = bvx_grid_get(solid, (int32_t)start % nx, (int32_t)start / nx % ny,
                                      (int32_t)start / nx / ny);
        if (seen[start] ||
            bvx_grid_get(thin, (int32_t)start % nx, (int32_t)start / nx % ny, (int32_t)start / nx / ny))
            continue;
        stack[depth++] = (int32_t)start;
        seen[start] = 1;
        while (depth > 0) {
            int32_t const at = stack[--depth], x = at % nx, y = at / nx % ny, z = at / nx / ny;
            TEST_ASSERT_EQUAL_INT(side, bvx_grid_get(solid, x, y, z));
            for (int d = 0; d < 6; d++) {
                int32_t const s = d % 2 == 0 ? 1 : -1;
                int32_t const u = x + (d / 2 == 0 ? s : 0);
                int32_t const v = y + (d / 2 == 1 ? s : 0);
                int32_t const w = z + (d / 2 == 2 ? s : 0);
                size_t const next = ((size_t)w * (size_t)ny + (size_t)v) * (size_t)nx + (size_t)u;
                if (u < 0 || v < 0 || w < 0 || u >= nx || v >= ny || w >= nz || seen[next] ||
                    bvx_grid_get(thin, u, v, w))
                    continue;
                seen[next] = 1;
                stack[depth++] = (int32_t)next;
            }
        }
    }
    free(stack);
    free(seen);
}

static void test_separates_what_parity_tells_apart(void)
{
    for (int32_t trial = 0; trial < (quick ? 10 : 100); trial++) {
        int32_t const n[3] = {12 + maker_below(&seed, 70), 12 + maker_below(&seed, 20),
                              12 + maker_below(&seed, 20)};
        bvx_lattice const l = lattice_of(n[0], n[1], n[2]);
        bvx_grid solid, thin;
        make_closed(trial % CLOSED_KINDS, n);
        solid = solid_of(&l, BVX_FILL_PARITY);
        thin = surface_of(&l, THIN);
        assert_separates(&solid, &thin);
        assert_floods_stay(&solid, &thin);
        bvx_grid_free(ctx, &solid);
        bvx_grid_free(ctx, &thin);
    }
}

/* A wall on a lattice plane is one voxel thick: the displaced centres' segments end just beyond the plane. */
static void test_a_wall_is_one_voxel_thick(void)
{
    for (int32_t axis = 0; axis < 3; axis++) {
        bvx_lattice const l = lattice_of(10, 10, 10);
        uint32_t v[4];
        bvx_grid g;
        maker_clear(&mesh);
        for (int i = 0; i < 4; i++) {
            double p[3];
            p[axis] = 4;
            p[(axis + 1) % 3] = i == 1 || i == 2 ? 9 : 1;
            p[(axis + 2) % 3] = i >= 2 ? 9 : 1;
            v[i] = maker_vertex(&mesh, p[0], p[1], p[2]);
        }
        maker_quad(&mesh, v[0], v[1], v[2], v[3], axis == 1);
        g = surface_of(&l, THIN);
        TEST_ASSERT_EQUAL_UINT64(64, set_voxels(&g));
        for (int32_t y = 1; y < 9; y++)
            for (int32_t x = 1; x < 9; x++) {
                int32_t at[3];
                at[axis] = 3;
                at[(axis + 1) % 3] = x;
                at[(axis + 2) % 3] = y;
                TEST_ASSERT_TRUE(bvx_grid_get(&g, at[0], at[1], at[2]));
            }
        bvx_grid_free(ctx, &g);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_small_triangles_meet_axis_crosses);
    RUN_TEST(test_meshes_and_windows_are_the_oracles);
    RUN_TEST(test_order_types_and_strides_change_nothing);
    RUN_TEST(test_contexts_and_windows_agree);
    RUN_TEST(test_workers_share_the_triangles);
    RUN_TEST(test_separates_what_parity_tells_apart);
    RUN_TEST(test_a_wall_is_one_voxel_thick);
    return UNITY_END();
}
