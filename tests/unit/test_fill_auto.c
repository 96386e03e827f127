/* test_fill_auto.c - the rule that suits a mesh: which one is chosen and why, its bits against rules asked
 * for by name on the mesh as it should have been, and what may not change them. */
#include "solid_support.h"
#include <math.h>

enum { SIDE = 48 };

/* ---- Shapes ---- */

static void add_ball(double x, double y, double z, double r)
{
    double const centre[3] = {x, y, z}, radius[3] = {r, r, r};
    maker_star(&mesh, &seed, centre, radius, 0, 40, 32, 1 << 16);
}

/* A box of 2 n n triangles a side. */
static void add_fine_box(const double low[3], const double high[3], int32_t n)
{
    for (int axis = 0; axis < 3; axis++)
        for (int side = 0; side < 2; side++) {
            int const u = (axis + 1) % 3, v = (axis + 2) % 3;
            uint32_t const first = (uint32_t)mesh.vertices;
            double p[3];

            p[axis] = side ? high[axis] : low[axis];
            for (int32_t j = 0; j <= n; j++)
                for (int32_t i = 0; i <= n; i++) {
                    p[u] = low[u] + (high[u] - low[u]) * i / n;
                    p[v] = low[v] + (high[v] - low[v]) * j / n;
                    maker_vertex(&mesh, p[0], p[1], p[2]);
                }
            for (int32_t j = 0; j < n; j++)
                for (int32_t i = 0; i < n; i++) {
                    uint32_t const a = first + (uint32_t)(j * (n + 1) + i);
                    uint32_t const b = a + 1;
                    uint32_t const c = a + (uint32_t)n + 1;
                    uint32_t const d = c + 1;
                    if (side) maker_quad(&mesh, a, b, d, c, 0);
                    else maker_quad(&mesh, a, c, d, b, 0);
                }
        }
}

static bvx_grid by_auto(const bvx_lattice *l, bvx_solid_report *r)
{
    return solid_by(ctx, l, NULL, BVX_FILL_AUTO, r);
}

static void assert_chosen(const bvx_solid_report *r, int32_t fill, int32_t reason, uint64_t turned)
{
    TEST_ASSERT_EQUAL_INT32(fill, r->fill);
    TEST_ASSERT_EQUAL_INT32(reason, r->fill_reason);
    TEST_ASSERT_EQUAL_UINT64(turned, r->turned);
}

/* The mesh as it is now: auto takes this rule for this reason, and sets the bits of good. */
static void assert_auto_equals(const bvx_grid *good, int32_t fill, int32_t reason, uint64_t turned,
                               const char *what)
{
    bvx_solid_report r;
    bvx_grid g = by_auto(&good->lattice, &r);

    assert_same_bits(good, &g, what);
    assert_chosen(&r, fill, reason, turned);
    bvx_grid_free(ctx, &g);
}

/* The mesh as it is now: auto takes this rule for this reason, and sets this number of voxels. */
static void assert_auto_sets(const bvx_lattice *l, uint64_t voxels, int32_t fill, int32_t reason,
                             uint64_t turned)
{
    bvx_solid_report r;
    bvx_grid g = by_auto(l, &r);

    TEST_ASSERT_EQUAL_UINT64(voxels, set_voxels(&g));
    assert_chosen(&r, fill, reason, turned);
    bvx_grid_free(ctx, &g);
}

/* ---- Overlaps and flipped triangles ---- */

static void test_one_flipped_triangle_leaves_a_union_of_balls_whole(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;
    add_ball(19.3, 24.1, 24.2, 12);
    add_ball(29.6, 24.4, 23.7, 12);
    good = solid_of(&l, BVX_FILL_NONZERO);

    assert_auto_equals(&good, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 0, "two balls");

    maker_flip(&mesh, 700, 701);
    assert_auto_equals(&good, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 1, "one triangle flipped");
    bvx_grid_free(ctx, &good);
}

static void test_one_flipped_triangle_leaves_a_union_of_cubes_whole(void)
{
    double const low[3] = {4, 4, 4};
    double const high[3] = {36, 36, 36};
    double const bar_low[3] = {20, 10, 10};
    double const bar_high[3] = {46, 30, 30};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);

    add_fine_box(low, high, 8);
    add_fine_box(bar_low, bar_high, 8);
    maker_flip(&mesh, 1000, 1001);
    assert_auto_sets(&l, 32 * 32 * 32 + 10 * 20 * 20, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 1);
}

static void test_a_part_inside_out_that_overlaps_is_turned(void)
{
    double const low[3] = {4, 4, 4};
    double const high[3] = {36, 36, 36};
    double const bar_low[3] = {20, 10, 10};
    double const bar_high[3] = {46, 30, 30};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);

    add_fine_box(low, high, 2);
    size_t const first = mesh.triangles;
    add_fine_box(bar_low, bar_high, 2);
    maker_flip(&mesh, first, mesh.triangles);
    assert_auto_sets(&l, 32 * 32 * 32 + 10 * 20 * 20, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 48);
}

static void test_a_part_inside_out_beside_a_right_one_is_inside(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;

    add_ball(12.3, 14.1, 14.2, 9);
    size_t const first = mesh.triangles;
    add_ball(33.6, 30.4, 33.7, 11);
    good = solid_of(&l, BVX_FILL_PARITY);
    maker_flip(&mesh, first, mesh.triangles);
    assert_auto_equals(&good, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0, "one ball inside out");
    bvx_grid_free(ctx, &good);
}

static void test_doubled_triangles_are_there_once(void)
{
    double const low[3] = {4, 4, 4}, high[3] = {36, 36, 36};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    add_fine_box(low, high, 2);
    for (size_t i = 0, n = mesh.triangles; i < n; i++) maker_duplicate(&mesh, i);
    assert_auto_sets(&l, 32 * 32 * 32, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 0);
}

/* They reach beyond the lattice, and the grid is that of a solid before. */
static void test_triangles_without_area_set_nothing(void)
{
    float const at[] = {-20, 1, 1, 20, 5, 5, 3, 3, 30};
    uint32_t const flat[] = {0, 0, 1, 1, 1, 2, 2, 0, 2};
    double const low[3] = {-1, -1, -1}, high[3] = {9, 9, 9};
    bvx_lattice const l = lattice_of(8, 8, 8);
    bvx_mesh_view view;
    bvx_grid g = {0};

    add_fine_box(low, high, 2);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &l, NULL, &g));
    TEST_ASSERT_EQUAL_UINT64(512, set_voxels(&g));
    view = bvx_mesh_view_packed(at, 3, flat, 3);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &l, NULL, &g));
    TEST_ASSERT_EQUAL_UINT64(0, set_voxels(&g));
    bvx_grid_free(ctx, &g);
}

static void test_some_doubled_triangles_are_there_once(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;
    size_t count;

    add_ball(24.3, 24.1, 24.2, 20);
    good = solid_of(&l, BVX_FILL_PARITY);
    count = mesh.triangles;
    for (size_t t = 0; t < count; t += 7) maker_duplicate(&mesh, t);
    maker_flip(&mesh, count + 3, count + 9);

    assert_auto_equals(&good, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0, "every seventh triangle twice");
    bvx_grid_free(ctx, &good);
}

/* Every triangle once either way, as in models for games: their edges
 * balance, and what they enclose cancels out. */
static void test_two_sided_triangles_are_there_once(void)
{
    bvx_window const w = {{20, 3, 11}, {17, 40, 9}};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_solid_report r;
    bvx_grid good, good_window, g;
    size_t count;

    add_ball(24.3, 24.1, 24.2, 20);
    good = solid_of(&l, BVX_FILL_PARITY);
    good_window = solid_by(ctx, &l, &w, BVX_FILL_PARITY, &r);
    count = mesh.triangles;
    for (size_t t = 0; t < count; t++) maker_duplicate(&mesh, t);
    maker_flip(&mesh, count, mesh.triangles);

    assert_auto_equals(&good, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0, "a ball of two sides");
    g = solid_by(ctx, &l, &w, BVX_FILL_AUTO, &r);
    assert_same_bits(&good_window, &g, "a window of it");
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &good_window);
    bvx_grid_free(ctx, &good);
}

static void test_a_sheet_of_two_sides_encloses_nothing(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    size_t count;

    /* A ball without its upper part. */
    add_ball(24.3, 24.1, 24.2, 20);
    for (int i = 0; i < 300; i++) maker_remove(&mesh, mesh.triangles - 1);
    count = mesh.triangles;
    for (size_t t = 0; t < count; t++) maker_duplicate(&mesh, t);
    maker_flip(&mesh, count, mesh.triangles);

    assert_auto_sets(&l, 0, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0);
}

/* ---- Cavities ---- */

static void test_cavities_stay_cavities(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;
    add_ball(24.3, 24.1, 24.2, 20);
    size_t const first = mesh.triangles;
    add_ball(25.3, 23.1, 24.2, 9);
    good = solid_of(&l, BVX_FILL_PARITY);

    assert_auto_equals(&good, BVX_FILL_PARITY, BVX_FILL_REASON_NESTED, 0, "a cavity that faces outwards");

    maker_flip(&mesh, first, mesh.triangles);
    assert_auto_equals(&good, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0, "a cavity that faces inwards");

    maker_flip(&mesh, first + 3, first + 5);
    assert_auto_equals(&good, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 2,
                       "a cavity with two triangles flipped");
    bvx_grid_free(ctx, &good);
}

/* A cavity inside one of two parts that overlap is one deep less one. */
static void test_cavities_stay_beside_overlaps(void)
{
    double const low[3] = {2, 2, 2};
    double const high[3] = {30, 30, 30};
    double const bar_low[3] = {20, 10, 10};
    double const bar_high[3] = {46, 30, 30};
    double const hole_low[3] = {6, 6, 6}, hole_high[3] = {14, 16, 12};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);

    add_fine_box(low, high, 2);
    add_fine_box(bar_low, bar_high, 2);
    size_t const first = mesh.triangles;
    add_fine_box(hole_low, hole_high, 2);
    maker_flip(&mesh, first, mesh.triangles);
    assert_auto_sets(&l, 28 * 28 * 28 + 26 * 20 * 20 - 10 * 20 * 20 - 8 * 10 * 6, BVX_FILL_NONZERO,
                     BVX_FILL_REASON_OVERLAP, 0);
}

/* ---- Holes ---- */

static void test_holes_are_filled_by_winding_after_turning(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;

    add_ball(19.3, 24.1, 24.2, 12);
    add_ball(29.6, 24.4, 23.7, 12);
    maker_remove(&mesh, 300);
    good = solid_of(&l, BVX_FILL_WINDING);
    maker_flip(&mesh, 100, 103);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 3,
                       "a hole, and three triangles flipped");
    bvx_grid_free(ctx, &good);
}

/* Sides of a box whose edges are parted differently: on each of them ends of one side lie on the middle of
 * another's, at places of the lattice and off it. */
static void add_cracked_box(const double low[3], const double high[3])
{
    size_t const first = mesh.triangles;
    size_t kept = first;

    for (int32_t n = 1; n <= 6; n++) {
        size_t const from = mesh.triangles;
        add_fine_box(low, high, n == 5 ? 8 : n);
        for (size_t t = 0, side = (size_t)(n - 1), per = (mesh.triangles - from) / 6; t < per; t++)
            memcpy(mesh.t + 3 * kept++, mesh.t + 3 * (from + side * per + t), 3 * sizeof *mesh.t);
        mesh.triangles = kept;
    }
}

static void test_sides_that_shorter_ones_cover_are_closed(void)
{
    double const low[3] = {3.5, 4, 5.25}, high[3] = {38.5, 28, 41.25}, far_low[3] = {20, 20.5, 20},
                 far_high[3] = {44, 45, 44};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid one, both, g;
    bvx_solid_report r;

    maker_box(&mesh, low, high);
    one = solid_of(&l, BVX_FILL_PARITY);
    maker_box(&mesh, far_low, far_high);
    both = solid_of(&l, BVX_FILL_NONZERO);

    maker_clear(&mesh);
    add_cracked_box(low, high);
    assert_auto_equals(&one, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0, "a cracked box");
    for (int32_t fill = BVX_FILL_VOTE; fill <= BVX_FILL_WINDING; fill += BVX_FILL_WINDING - BVX_FILL_VOTE) {
        g = solid_by(ctx, &l, NULL, fill, &r);
        assert_same_bits(&one, &g, "a cracked box by name");
        TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
        bvx_grid_free(ctx, &g);
    }

    add_cracked_box(far_low, far_high);
    assert_auto_equals(&both, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 0, "two cracked boxes");

    /* A side that is not there is a hole all the same. */
    mesh.triangles -= 2 * 6 * 6;
    g = by_auto(&l, &r);
    assert_chosen(&r, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0);
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &one);
    bvx_grid_free(ctx, &both);
}

/* Without the sides that rows along x meet, every row is empty and so balanced. */
static void test_a_box_without_two_sides_is_open(void)
{
    double const low[3] = {8, 8, 8}, high[3] = {40, 40, 40};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_solid_report r;
    bvx_grid g;

    maker_box(&mesh, low, high);
    for (int i = 0; i < 4; i++) maker_remove(&mesh, 0);
    g = by_auto(&l, &r);
    assert_chosen(&r, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0);
    TEST_ASSERT_TRUE(set_voxels(&g) > 15000);
    bvx_grid_free(ctx, &g);
}

/* ---- Whole patches that face inward ---- */

/* A box without one of its sides: 0, 1 low and high along x, 2, 3 along y, 4, 5 along z. */
static void add_open_box(const double low[3], const double high[3], size_t without, int inside_out)
{
    size_t const first = mesh.triangles;

    maker_box(&mesh, low, high);
    memmove(mesh.t + 3 * (first + 2 * without), mesh.t + 3 * (first + 2 * without + 2),
            (10 - 2 * without) * 3 * sizeof *mesh.t);
    mesh.triangles -= 2;
    if (inside_out) maker_flip(&mesh, first, mesh.triangles);
}

/* Two halves of a box whose borders face each other, a tenth of a voxel apart. */
static void add_halves(int first_inside_out, int second_inside_out)
{
    double const low[3] = {4, 5, 6}, middle[3] = {23.9, 43, 41}, from[3] = {24, 5, 6}, high[3] = {44, 43, 41};

    add_open_box(low, middle, 1, first_inside_out);
    add_open_box(from, high, 0, second_inside_out);
}

static void test_an_open_half_inside_out_is_turned(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;

    add_halves(0, 0);
    good = solid_of(&l, BVX_FILL_WINDING);
    TEST_ASSERT_EQUAL_UINT64(40 * 38 * 35, set_voxels(&good));
    for (int inside_out = 0; inside_out < 3; inside_out++) {
        maker_clear(&mesh);
        add_halves(inside_out == 1, inside_out == 2);
        assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, inside_out != 0 ? 10 : 0,
                           "two halves of a box");
    }

    /* Where both face inward nothing says that one should not. */
    maker_clear(&mesh);
    add_halves(1, 1);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0, "both inside out");
    bvx_grid_free(ctx, &good);
}

static void test_an_open_half_inside_out_is_turned_in_any_order(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;

    add_halves(0, 0);
    good = solid_of(&l, BVX_FILL_WINDING);
    maker_clear(&mesh);
    add_halves(0, 1);
    for (int trial = 0; trial < 10; trial++) {
        maker_shuffle_triangles(&mesh, &seed);
        maker_shuffle_vertices(&mesh, &seed);
        assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 10, "shuffled halves");
    }
    bvx_grid_free(ctx, &good);
}

static void test_a_body_inside_out_is_turned_where_it_overlaps_an_open_one(void)
{
    double const low[3] = {4, 4, 4}, high[3] = {28, 28, 28}, from[3] = {18, 16, 12}, to[3] = {44, 42, 24};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);

    for (size_t without = 0; without < 6; without += 5) {
        bvx_grid good;

        maker_clear(&mesh);
        add_open_box(low, high, 4, 0);
        add_open_box(from, to, without, 0);
        good = solid_of(&l, BVX_FILL_WINDING);
        maker_flip(&mesh, 10, 20);
        assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 10, "an open box inside out");
        bvx_grid_free(ctx, &good);

        maker_clear(&mesh);
        add_open_box(low, high, 4, 0);
        maker_box(&mesh, from, to);
        good = solid_of(&l, BVX_FILL_WINDING);
        maker_flip(&mesh, 10, 22);
        assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 12, "a closed box inside out");
        bvx_grid_free(ctx, &good);
    }
}

/* Of three that overlap, parity has some crossings right by chance: two were turned, and cut out of the third. Beside
 * a ball that faces outward all three are turned. */
static void test_open_parts_that_overlap_and_all_face_inward_are_one_body(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;

    for (int inside_out = 0; inside_out < 2; inside_out++) {
        maker_clear(&mesh);
        for (size_t i = 0; i < 3; i++) {
            double const at = 4.0 + 7.0 * (double)i, low[3] = {at, 5, at}, high[3] = {at + 22, 37, at + 20};

            add_open_box(low, high, 4, inside_out);
        }
        if (!inside_out) good = solid_of(&l, BVX_FILL_WINDING);
        assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0, "three open boxes");
    }
    bvx_grid_free(ctx, &good);

    for (int inside_out = 0; inside_out < 2; inside_out++) {
        size_t first;

        maker_clear(&mesh);
        add_ball(10, 24, 24, 9);
        maker_remove(&mesh, 5);
        first = mesh.triangles;
        for (int i = 0; i < 3; i++) {
            add_ball(29 + 4 * i, 24 - 2 * i, 23 + 2 * i, 9);
            maker_remove(&mesh, mesh.triangles - 40);
        }
        if (inside_out) maker_flip(&mesh, first, mesh.triangles);
        else good = solid_of(&l, BVX_FILL_WINDING);
        assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN,
                           inside_out ? mesh.triangles - first : 0, "three open balls");
    }
    bvx_grid_free(ctx, &good);
}

/* A smaller ball inside out that overlaps a larger one: whatever else there is, its volume says so. */
static void test_a_closed_part_inside_out_is_turned_beside_an_open_one(void)
{
    double const low[3] = {36, 36, 36}, high[3] = {44, 44, 44};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    size_t first;
    bvx_grid good;

    add_ball(18, 16, 16, 14);
    first = mesh.triangles;
    add_ball(30, 16, 16, 8);
    add_open_box(low, high, 4, 0);
    good = solid_of(&l, BVX_FILL_WINDING);
    maker_flip(&mesh, first, mesh.triangles - 10);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, mesh.triangles - 10 - first,
                       "a ball inside out beside an open box");
    bvx_grid_free(ctx, &good);
}

/* What faces inward and should: the inner walls of a tub, a cavity of an open body, a room about its
 * furniture; and sheets that face one way, one above the other. */
static void test_what_faces_inward_rightly_is_not_turned(void)
{
    double const low[3] = {4, 4, 4}, high[3] = {44, 44, 40}, inner[3] = {10, 9, 8}, rim[3] = {38, 39, 40},
                 ceiling[3] = {38, 39, 32}, deep[3] = {30, 31, 24};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_grid good;

    add_open_box(low, high, 5, 0);
    add_open_box(inner, rim, 5, 1);
    good = solid_of(&l, BVX_FILL_WINDING);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0, "a tub");
    bvx_grid_free(ctx, &good);

    maker_clear(&mesh);
    add_open_box(low, high, 5, 0);
    maker_box(&mesh, inner, ceiling);
    maker_flip(&mesh, 10, 22);
    good = solid_of(&l, BVX_FILL_WINDING);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0, "a cavity");
    bvx_grid_free(ctx, &good);

    maker_clear(&mesh);
    add_open_box(low, high, 5, 1);
    maker_box(&mesh, inner, deep);
    good = solid_of(&l, BVX_FILL_WINDING);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0, "a room with a box in it");
    bvx_grid_free(ctx, &good);

    maker_clear(&mesh);
    for (int sheet = 0; sheet < 2; sheet++) {
        double const z = 12 + 20 * sheet;
        uint32_t const a = maker_vertex(&mesh, 5, 5, z), b = maker_vertex(&mesh, 43, 5, z);
        uint32_t const c = maker_vertex(&mesh, 43, 43, z), d = maker_vertex(&mesh, 5, 43, z);
        uint32_t const deepest = maker_vertex(&mesh, 24, 24, z - 5);

        maker_triangle(&mesh, a, b, deepest);
        maker_triangle(&mesh, b, c, deepest);
        maker_triangle(&mesh, c, d, deepest);
        maker_triangle(&mesh, d, a, deepest);
    }
    good = solid_of(&l, BVX_FILL_WINDING);
    assert_auto_equals(&good, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN, 0, "two valleys");
    bvx_grid_free(ctx, &good);
}

/* Boxes whose extent no double holds, each triangle twice, once either way: no ray lies in them. */
static void test_patches_at_the_ends_of_doubles_are_left(void)
{
    double const most = 1.7e308, low[3] = {-most, -most, -most}, high[3] = {most, most, most};
    double const from[3] = {-most / 2, -most / 2, -most / 2}, to[3] = {most / 2, most / 2, most / 2};
    bvx_lattice l = lattice_of(16, 16, 16);
    bvx_solid_report r;
    bvx_grid g;

    for (int a = 0; a < 3; a++) {
        l.origin[a] = 0;
        l.spacing[a] = 1e307;
    }
    add_open_box(low, high, 1, 0);
    add_open_box(from, to, 0, 1);
    /* In the far corner of two axes. */
    for (int k = -1; k < 2; k++) maker_vertex(&mesh, most, most, k * most);
    maker_triangle(&mesh, (uint32_t)mesh.vertices - 3, (uint32_t)mesh.vertices - 2,
                   (uint32_t)mesh.vertices - 1);
    for (size_t t = 0, n = mesh.triangles; t < n; t++) maker_duplicate(&mesh, t);
    maker_flip(&mesh, mesh.triangles / 2, mesh.triangles);

    g = by_auto(&l, &r);
    TEST_ASSERT_EQUAL_UINT64(0, r.turned);
    bvx_grid_free(ctx, &g);
}

/* docs/rules.md: what each solid takes, and where edges are examined. */
static void test_memory_where_edges_are_examined(void)
{
    double const centre[3] = {24, 24, 24}, radius[3] = {20, 20, 20};
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    uint64_t n, vertices, given, before;
    bvx_solid_report r;
    bvx_grid g;

    maker_star(&mesh, &seed, centre, radius, 0, 120, 100, 1 << 16);
    maker_flip(&mesh, 700, 701);
    n = mesh.triangles;
    vertices = mesh.vertices;
    given = 16 * vertices + SIDE * SIDE + (n / 4096 + 1) * 100 * 1024 + 160 * 1024 + SIDE * SIDE * 8;
    bvx_memory_reset_peak(ctx);
    before = bvx_memory_peak(ctx);
    g = by_auto(&l, &r);
    assert_chosen(&r, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 1);
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - before <= given + 4 * vertices + 122 * n);
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - before > 4 * vertices + 122 * n);
    bvx_grid_free(ctx, &g);
}

static void test_what_cannot_be_oriented_is_voted_on(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_solid_report r;
    bvx_grid good, g;
    uint32_t first;

    add_ball(24.3, 24.1, 24.2, 12);
    first = (uint32_t)mesh.vertices; /* a strip of five triangles that is turned once: Moebius' band */
    for (int i = 0; i < 5; i++) maker_vertex(&mesh, 4 + 3 * (i % 3), 4 + 5 * (i % 2), 4 + i);
    for (uint32_t i = 0; i < 5; i++)
        maker_triangle(&mesh, first + i, first + (i + 1) % 5, first + (i + 2) % 5);
    good = solid_of(&l, BVX_FILL_VOTE);
    g = by_auto(&l, &r);
    assert_same_bits(&good, &g, "a band with one side");
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_VOTE, r.fill);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_REASON_UNORIENTABLE, r.fill_reason);
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &good);
}

/* ---- What changes nothing ---- */

static void make_some_balls(int32_t trial)
{
    maker_clear(&mesh);
    if (trial % 7 == 3) {
        add_ball(24, 24, 24, 20);
        add_ball(24, 25, 24, 12);
        return;
    }
    for (int n = 0; n < 1 + trial % 4; n++) {
        double const centre[3] = {maker_between(&seed, 10, 38, 16), maker_between(&seed, 10, 38, 16),
                                  maker_between(&seed, 10, 38, 16)};
        double const radius[3] = {4 + maker_below(&seed, 12), 4 + maker_below(&seed, 12),
                                  4 + maker_below(&seed, 12)};
        size_t const first = mesh.triangles;
        maker_star(&mesh, &seed, centre, radius, 0.4, 6 + maker_below(&seed, 4), 5 + maker_below(&seed, 4),
                   16);
        if (maker_below(&seed, 3) == 0) maker_flip(&mesh, first, mesh.triangles);
    }
    for (int n = trial % 3; n-- > 0;) {
        size_t const i = (size_t)maker_below(&seed, (int32_t)mesh.triangles);
        maker_flip(&mesh, i, i + 1);
    }
    if (trial % 5 == 0) maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

static void test_windows_are_cut_out_of_the_whole(void)
{
    bvx_lattice const l = lattice_of(SIDE, 47, 49);
    int32_t seen[6] = {0};

    for (int32_t trial = 0; trial < (quick ? 20 : 120); trial++) {
        bvx_solid_report whole_report, r;
        bvx_window w;
        bvx_grid whole, g;
        make_some_balls(trial);
        whole = by_auto(&l, &whole_report);
        seen[whole_report.fill_reason]++;
        for (int a = 0; a < 3; a++) {
            w.low[a] = maker_below(&seed, 30);
            w.size[a] = 1 + maker_below(&seed, 17);
        }
        g = solid_by(ctx, &l, &w, BVX_FILL_AUTO, &r);
        TEST_ASSERT_EQUAL_INT32(whole_report.fill_reason, r.fill_reason);
        TEST_ASSERT_EQUAL_UINT64(whole_report.turned, r.turned);
        for (int32_t z = 0; z < w.size[2]; z++)
            for (int32_t y = 0; y < w.size[1]; y++)
                for (int32_t x = 0; x < w.size[0]; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole, w.low[0] + x, w.low[1] + y, w.low[2] + z),
                                          bvx_grid_get(&g, x, y, z));
        bvx_grid_free(ctx, &g);
        bvx_grid_free(ctx, &whole);
    }
    for (int32_t i = BVX_FILL_REASON_SOUND; i <= BVX_FILL_REASON_OPEN; i++) TEST_ASSERT_TRUE(seen[i] > 0);
}

/* Lattices of so many rows are looked at with longer voxels: a window must
 * choose as the whole does, and cost as little as it is. */
static void test_windows_of_many_rows_choose_as_the_whole(void)
{
    bvx_lattice const l = lattice_of(8, 2100, 2100);
    bvx_window const w = {{1, 1000, 1000}, {6, 40, 50}};
    double const first[2][3] = {{1, 100, 100}, {5, 1100, 1100}};
    double const second[2][3] = {{3, 900, 900}, {7, 1900, 1900}};
    bvx_solid_report whole_report, r;
    bvx_grid whole, g;

    maker_clear(&mesh);
    add_fine_box(first[0], first[1], 2);
    add_fine_box(second[0], second[1], 2);
    whole = by_auto(&l, &whole_report);
    g = solid_by(ctx, &l, &w, BVX_FILL_AUTO, &r);

    assert_chosen(&whole_report, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 0);
    assert_chosen(&r, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 0);
    for (int32_t z = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++)
                TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole, w.low[0] + x, w.low[1] + y, w.low[2] + z),
                                      bvx_grid_get(&g, x, y, z));
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &whole);
}

static void test_sound_meshes_have_the_bits_of_parity(void)
{
    bvx_lattice const l = lattice_of(SIDE, 47, 130);

    for (int32_t trial = 0; trial < (quick ? 4 : 20); trial++) {
        double const centre[3] = {24, 24, 60}, radius[3] = {20, 18, 50};
        bvx_solid_report r;
        bvx_grid good, g;
        maker_clear(&mesh);
        maker_star(&mesh, &seed, centre, radius, 0.5, 7 + trial, 9 + trial, 4);
        if (trial % 2) maker_flip(&mesh, 0, mesh.triangles);
        good = solid_of(&l, BVX_FILL_PARITY);
        g = by_auto(&l, &r);
        assert_same_bits(&good, &g, "a star");
        assert_chosen(&r, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND, 0);
        bvx_grid_free(ctx, &g);
        bvx_grid_free(ctx, &good);
    }
}

static void test_order_and_threads_change_nothing(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);

    for (int32_t trial = 0; trial < (quick ? 8 : 40); trial++) {
        bvx_context *const three = suite_context(3, 0);
        bvx_solid_report r, shuffled;
        bvx_grid g, again;
        make_some_balls(trial);
        g = by_auto(&l, &r);
        maker_shuffle_triangles(&mesh, &seed);
        maker_shuffle_vertices(&mesh, &seed);
        again = solid_by(three, &l, NULL, BVX_FILL_AUTO, &shuffled);
        assert_same_bits(&g, &again, "shuffled, three threads");
        assert_chosen(&shuffled, r.fill, r.fill_reason, r.turned);
        bvx_grid_free(three, &again);
        bvx_context_destroy(three);
        bvx_grid_free(ctx, &g);
    }
}

/* Triangles without indices share no vertex, only positions; vertices that nobody uses may be anything. */
static void test_soups_and_unused_vertices(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    maker_mesh shared;
    bvx_solid_report r;
    bvx_grid good, g;
    add_ball(19.3, 24.1, 24.2, 12);
    add_ball(29.6, 24.4, 23.7, 12);
    good = solid_of(&l, BVX_FILL_NONZERO);
    maker_vertex(&mesh, (double)NAN, 0, 0);
    g = by_auto(&l, &r);
    assert_same_bits(&good, &g, "a vertex that nobody uses");
    bvx_grid_free(ctx, &g);

    shared = mesh;
    memset(&mesh, 0, sizeof mesh);
    for (size_t i = 0; i < 3 * shared.triangles; i++) {
        const double *const p = shared.p + 3 * (size_t)shared.t[i];
        maker_vertex(&mesh, p[0], p[1], p[2]);
    }
    for (uint32_t i = 0; i < shared.triangles; i++) maker_triangle(&mesh, 3 * i, 3 * i + 1, 3 * i + 2);
    maker_free(&shared);
    assert_auto_equals(&good, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP, 0, "a soup");
    bvx_grid_free(ctx, &good);
}

static void test_indices_beyond_the_vertices_are_refused(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);
    bvx_mesh_view view;
    bvx_grid g = {0};

    add_ball(24, 24, 24, 9);
    mesh.t[100] = (uint32_t)mesh.vertices;
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, fill_with(ctx, &view, &l, NULL, BVX_FILL_AUTO, &g, NULL));
    TEST_ASSERT_NULL(g.words);
}

/* Rules requested by name are reported as such. */
static void test_rules_by_name_are_reported(void)
{
    bvx_lattice const l = lattice_of(SIDE, SIDE, SIDE);

    add_ball(24, 24, 24, 9);
    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_WINDING; fill++) {
        bvx_solid_report r;
        bvx_grid g = solid_by(ctx, &l, NULL, fill, &r);
        assert_chosen(&r, fill, BVX_FILL_REASON_ASKED, 0);
        bvx_grid_free(ctx, &g);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_one_flipped_triangle_leaves_a_union_of_balls_whole);
    RUN_TEST(test_one_flipped_triangle_leaves_a_union_of_cubes_whole);
    RUN_TEST(test_a_part_inside_out_that_overlaps_is_turned);
    RUN_TEST(test_a_part_inside_out_beside_a_right_one_is_inside);
    RUN_TEST(test_doubled_triangles_are_there_once);
    RUN_TEST(test_triangles_without_area_set_nothing);
    RUN_TEST(test_some_doubled_triangles_are_there_once);
    RUN_TEST(test_two_sided_triangles_are_there_once);
    RUN_TEST(test_a_sheet_of_two_sides_encloses_nothing);
    RUN_TEST(test_cavities_stay_cavities);
    RUN_TEST(test_cavities_stay_beside_overlaps);
    RUN_TEST(test_holes_are_filled_by_winding_after_turning);
    RUN_TEST(test_sides_that_shorter_ones_cover_are_closed);
    RUN_TEST(test_a_box_without_two_sides_is_open);
    RUN_TEST(test_an_open_half_inside_out_is_turned);
    RUN_TEST(test_an_open_half_inside_out_is_turned_in_any_order);
    RUN_TEST(test_a_body_inside_out_is_turned_where_it_overlaps_an_open_one);
    RUN_TEST(test_open_parts_that_overlap_and_all_face_inward_are_one_body);
    RUN_TEST(test_a_closed_part_inside_out_is_turned_beside_an_open_one);
    RUN_TEST(test_what_faces_inward_rightly_is_not_turned);
    RUN_TEST(test_patches_at_the_ends_of_doubles_are_left);
    RUN_TEST(test_memory_where_edges_are_examined);
    RUN_TEST(test_what_cannot_be_oriented_is_voted_on);
    RUN_TEST(test_windows_are_cut_out_of_the_whole);
    RUN_TEST(test_windows_of_many_rows_choose_as_the_whole);
    RUN_TEST(test_sound_meshes_have_the_bits_of_parity);
    RUN_TEST(test_order_and_threads_change_nothing);
    RUN_TEST(test_soups_and_unused_vertices);
    RUN_TEST(test_indices_beyond_the_vertices_are_refused);
    RUN_TEST(test_rules_by_name_are_reported);
    return UNITY_END();
}
