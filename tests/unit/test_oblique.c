/* test_oblique.c - bodies from contours on planes that are not parallel: balls, shells and a torus whose
 * contours are known, what is inside on the planes, contradictions, planes that are nearly something. */
#include "section_support.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* ---- what is looked at ---- */

static uint64_t warned(int32_t code)
{
    return report.warnings >> code & 1;
}

static void assert_no_crossings(void)
{
    bvx_mesh_view view;
    uint64_t count = 1;

    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(0, count);
}

/* Each contour point but those that are counted as not kept is a vertex within 1e-12 of the extent: points that two
 * planes share but for rounding are one vertex, which has the coordinates of the first. */
static void assert_lost_points_are_counted(void)
{
    const double *const p = mesh.positions;
    double const most = 1e-12 * 2.8;
    uint64_t exact = 0, lost = 0;

    for (uint64_t i = 0; i < stack.s.point_count; i++) {
        double least = 1e300;
        for (uint64_t v = 0; v < mesh.vertex_count && least > 0.0; v++) {
            double off = fabs(p[3 * v] - stack.point[3 * i]);
            if (off >= least) continue; /* as most are, by one coordinate */
            for (uint64_t k = 1; k < 3; k++) {
                double const by = fabs(p[3 * v + k] - stack.point[3 * i + k]);
                off = by > off ? by : off;
            }
            least = off < least ? off : least;
        }
        lost += least > most;
        exact += least == 0.0;
    }
    TEST_ASSERT_TRUE(lost <= report.unkept_points);
    TEST_ASSERT_TRUE(exact * 10 >= stack.s.point_count * 9);
}

static void assert_contours_kept(void)
{
    TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points + report.unkept_edges);
    assert_lost_points_are_counted();
}

/* Places on a section at random: inside where an odd number of its loops' balls are, and not where those say
 * nothing, between a circle and its polygon. */
static void assert_sides(uint64_t *seed, int places, const double *radius, int radii)
{
    for (int i = 0; i < places; i++) {
        uint64_t const k = (uint64_t)maker_below(seed, (int)stack.s.section_count);
        const double *const n = stack.normal + 3 * k;
        double const size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double at[3], off, r;
        int inside = 0, sure = 1;

        for (int x = 0; x < 3; x++) at[x] = maker_between(seed, -1.1, 1.1, 1000);
        off = (n[0] * at[0] + n[1] * at[1] + n[2] * at[2]) / size - stack.position[k];
        for (int x = 0; x < 3; x++) at[x] -= off * n[x] / size;
        r = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
        for (int x = 0; x < radii; x++) {
            inside ^= r < radius[x];
            sure &= fabs(r - radius[x]) > 0.03;
        }
        if (sure) TEST_ASSERT_TRUE(fabs(inside - stack_winding(&mesh, at)) < 1e-6);
    }
}

static void make_ball(uint64_t seed, int planes, double cavity)
{
    stack_oblique(&stack);
    for (int i = 0; i < planes; i++) {
        uint32_t const k = stack_any_plane(&stack, &seed, 0.85);
        stack_ball_cut(&stack, k, 0, 0, 0, 1.0, 100);
        if (cavity > 0.0) stack_ball_cut(&stack, k, 0, 0, 0, cavity, 60);
    }
}

static void refuse_with(bvx_status status, const char *words)
{
    TEST_ASSERT_EQUAL_INT32(status, build());
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    TEST_ASSERT_NULL(mesh.positions);
}

/* ---- bodies ---- */

static void test_a_ball_through_planes_of_any_direction(void)
{
    static const int planes[] = {3, 6, 12, 24};
    double const volume = 4.0 / 3.0 * pi, radius[1] = {1.0};
    int const sets = long_run ? 4 : 3;
    double worst[4];

    for (int i = 0; i < sets; i++) {
        double sum = 0.0;
        for (uint64_t seed = 1; seed <= 3; seed++) {
            uint64_t places = seed;
            make_ball(10 * (uint64_t)i + seed, planes[i], 0.0);
            o.cells = 24;
            build_good();
            assert_no_crossings();
            assert_contours_kept();
            TEST_ASSERT_EQUAL_UINT64((uint64_t)planes[i], report.planes);
            assert_sides(&places, 30, radius, 1);
            for (uint64_t v = 0; v < mesh.vertex_count; v++) {
                const double *const p = (const double *)mesh.positions + 3 * v;
                double const off = fabs(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1.0);
                sum += off / (3.0 * (double)mesh.vertex_count);
            }
        }
        worst[i] = sum;
        if (i > 0) TEST_ASSERT_TRUE(worst[i] < worst[i - 1]);
    }
    /* a blend of the planes' distances alone is 0.06, 0.028 and 0.014 off */
    TEST_ASSERT_TRUE(worst[1] < 0.0115 && worst[2] < 0.0031 && (sets < 4 || worst[3] < 0.0014));
    TEST_ASSERT_TRUE(fabs(volume - certificate.volume) < 0.02 * volume);
}

/* Chords of contours and straight lines along edges of cells both lie in the hollow of a ball: what is between
 * the planes must not follow either. Both together would be 2.4e-4 off on average. */
static void test_a_ball_is_not_hollowed_by_chords(void)
{
    double sum = 0.0;
    uint64_t count = 0;

    make_ball(24, 24, 0.0);
    o.cells = 48;
    build_good();
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        const double *const p = (const double *)mesh.positions + 3 * v;
        double nearest = 1e300;
        for (uint64_t k = 0; k < stack.s.section_count; k++) {
            const double *const n = stack.s.normals + 3 * k;
            double const h = fabs(n[0] * p[0] + n[1] * p[1] + n[2] * p[2] - stack.s.positions[k]);
            nearest = h < nearest ? h : nearest;
        }
        /* on a plane, or farther off than half a cell, where what the ball is gets a guess */
        if (nearest < 1e-6 || nearest > 0.02) continue;
        sum += sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1.0;
        count++;
    }
    sum /= (double)count;
    TEST_ASSERT_TRUE(count > 10000 && sum > -1e-4 && sum < 1e-4);
}

static void test_a_shell_keeps_its_cavity(void)
{
    double const radius[2] = {1.0, 0.5};

    for (uint64_t seed = 1; seed <= 3; seed++) {
        uint64_t places = seed;
        make_ball(seed, 14, 0.5);
        o.cells = 28;
        build_good();
        assert_no_crossings();
        assert_contours_kept();
        TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
        TEST_ASSERT_TRUE(fabs(4.0 / 3.0 * pi * 0.875 - certificate.volume) < 0.25);
        assert_sides(&places, 20, radius, 2);
    }
}

/* Sets of planes that had handles where signs next to contours contradict each other. */
static void test_near_tangent_crossings_make_no_handle(void)
{
    static const struct {
        uint64_t seed;
        double cavity;
        int32_t cells;
    } set[] = {{34, 0.0, 32},   {2, 0.5, 32},  {9, 0.5, 32}, {5001, 0.5, 32},
               {5006, 0.0, 32}, {14, 0.5, 32}, {3, 0.0, 64}};
    size_t const sets = sizeof set / sizeof *set - (long_run ? 0 : 1);

    for (size_t i = 0; i < sets; i += long_run ? 1 : quick ? 3 : 2) {
        int const shells = set[i].cavity > 0.0 ? 2 : 1;
        make_ball(set[i].seed, 30, set[i].cavity);
        o.cells = set[i].cells;
        build_good();
        assert_no_crossings();
        TEST_ASSERT_EQUAL_UINT64(shells, certificate.components);
        TEST_ASSERT_EQUAL_INT64(2 * shells, certificate.euler);
    }
}

/* Three planes that have a corner between their contours there: one is outvoted, and meets the others in the
 * other order. Before, points were lost there, and planes had another side than their contours. */
static void test_corners_of_three_planes_have_one_side(void)
{
    make_ball(7006, 60, 0.0);
    o.cells = 32;
    build_good();
    assert_no_crossings();
    TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points + report.unkept_edges);
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
}

/* A torus by half planes through its axis, all of which cross in one line, and one across it. */
static void test_many_planes_in_one_line(void)
{
    stack_oblique(&stack);
    for (int i = 0; i < 9; i++) {
        double x, y;
        uint32_t k;
        stack_circle(i / 18.0, &x, &y);
        k = stack_plane(&stack, -y, x, 0.0, 0.0);
        stack_ball_cut(&stack, k, x, y, 0, 0.4, 40);
        stack_ball_cut(&stack, k, -x, -y, 0, 0.4, 40);
    }
    stack_plane(&stack, 0, 0, 1, 0.0);
    stack_ball_cut(&stack, 9, 0, 0, 0, 1.4, 72);
    stack_ball_cut(&stack, 9, 0, 0, 0, 0.6, 72);
    o.cells = 32;
    build_good();
    assert_no_crossings();
    assert_contours_kept();
    TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_TRUE(fabs(3.158 - certificate.volume) < 0.1 * 3.158);

    /* and a body that has the line inside */
    stack_oblique(&stack);
    for (int i = 0; i < 9; i++) {
        double x, y;
        stack_circle(i / 18.0, &x, &y);
        stack_ball_cut(&stack, stack_plane(&stack, -y, x, 0.0, 0.0), 0, 0, 0, 1.0, 80);
    }
    build_good();
    assert_no_crossings();
    assert_contours_kept();
    TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
}

/* Planes along the axes, where the lattice's own planes are. */
static void test_planes_along_the_axes(void)
{
    stack_oblique(&stack);
    for (int i = 0; i < 3; i++)
        for (int j = -1; j < 2; j++)
            stack_ball_cut(&stack, stack_plane(&stack, i == 0, i == 1, i == 2, 0.4 * j), 0, 0, 0, 1.0, 64);
    for (int32_t cells = 8; cells <= 40; cells += 16) {
        o.cells = cells;
        build_good();
        assert_no_crossings();
        assert_contours_kept();
        TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
    }
}

/* A plane's own axes and the point of it that is nearest to the origin. */
static void plane_axes(uint32_t section, double foot[3], double u[3], double v[3])
{
    const double *const n = stack.normal + 3 * section;
    double const size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    double length = 0.0;
    int const a = fabs(n[0]) < fabs(n[1]) ? 0 : 1;

    for (int k = 0; k < 3; k++) foot[k] = stack.position[section] * n[k] / size;
    for (int k = 0; k < 3; k++) u[k] = (k == a) - n[a] * n[k] / (size * size);
    for (int k = 0; k < 3; k++) length += u[k] * u[k];
    for (int k = 0; k < 3; k++) u[k] /= sqrt(length);
    for (int k = 0; k < 3; k++)
        v[k] = (n[(k + 1) % 3] * u[(k + 2) % 3] - n[(k + 2) % 3] * u[(k + 1) % 3]) / size;
}

/* A loop of a plane where a body that is a star about the origin on it ends: places along rays. */
static void add_star_loop(uint32_t section, double (*outside)(const double at[3]), int points)
{
    double foot[3], u[3], v[3];

    plane_axes(section, foot, u, v);
    stack_loop(&stack, section);
    for (int i = 0; i < points; i++) {
        double low = 0.0, high = 3.0, x, y;
        double *p;
        stack_circle((double)i / points, &x, &y);
        for (int step = 0; step < 60; step++) {
            double const middle = 0.5 * (low + high);
            double at[3];
            for (int k = 0; k < 3; k++) at[k] = foot[k] + middle * (x * u[k] + y * v[k]);
            if (outside(at) > 0.0) high = middle;
            else low = middle;
        }
        stack_point(&stack, 0.0, 0.0);
        p = stack.point + 3 * (stack.s.point_count - 1);
        for (int k = 0; k < 3; k++) p[k] = foot[k] + low * (x * u[k] + y * v[k]);
    }
}

/* Two balls that run into one: below 0 inside. */
static double outside_two_balls(const double at[3])
{
    double product = 1.0;

    for (int side = -1; side < 2; side += 2) {
        double const x = at[0] - 0.5 * side;
        product *= x * x + at[1] * at[1] + at[2] * at[2];
    }
    return product - 0.2; /* an oval of Cassini, turned: in one piece above 1/16 */
}

static void test_two_balls_that_merge(void)
{
    static const int planes[] = {6, 12, 24, 60};
    double last = 1e300;

    for (int i = 0; i < (quick ? 2 : long_run ? 4 : 3); i++) {
        uint64_t seed = 7;
        double off = 0.0;
        stack_oblique(&stack);
        for (int k = 0; k < planes[i]; k++)
            add_star_loop(stack_any_plane(&stack, &seed, 0.25), outside_two_balls, 100);
        o.cells = 24;
        build_good();
        assert_no_crossings();
        assert_contours_kept();
        TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
        TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
        for (uint64_t v = 0; v < mesh.vertex_count; v++)
            off += fabs(outside_two_balls((const double *)mesh.positions + 3 * v)) /
                   (double)mesh.vertex_count;
        TEST_ASSERT_TRUE(off < last); /* nearer to the body with every plane more */
        last = off;
    }
}

/* A plane beside the body says that there is none on it, and changes little. */
static void test_a_plane_that_misses_the_body(void)
{
    double volume;

    make_ball(4, 10, 0.0);
    o.cells = 24;
    build_good();
    volume = certificate.volume;
    stack_plane(&stack, 0.2, 0.1, 1, 1.3);
    build_good();
    assert_no_crossings();
    assert_contours_kept();
    TEST_ASSERT_EQUAL_UINT64(10, report.sections);
    TEST_ASSERT_TRUE(fabs(certificate.volume - volume) < 0.01 * volume);
    TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
}

/* ---- contours of any body, traced on a plane ---- */

enum { TRACE_SIDE = 49 };

/* Where a body, below 0 inside, ends on a plane: by marching squares on a lattice over [-1.7, 1.7]^2, each point
 * by bisection. Returns how many loops there are. */
static int trace_body(uint32_t section, double (*outside)(const double at[3]))
{
    static double value[TRACE_SIDE][TRACE_SIDE];
    static char seen[TRACE_SIDE][TRACE_SIDE];
    static const int step[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    double foot[3], u[3], v[3], at[3];
    double const low = -1.7, side = 3.4 / (TRACE_SIDE - 1);
    int loops = 0;

    plane_axes(section, foot, u, v);
    memset(seen, 0, sizeof seen);
    for (int j = 0; j < TRACE_SIDE; j++)
        for (int i = 0; i < TRACE_SIDE; i++) {
            for (int k = 0; k < 3; k++) at[k] = foot[k] + (low + i * side) * u[k] + (low + j * side) * v[k];
            value[j][i] = outside(at);
        }
    for (int y = 1; y + 1 < TRACE_SIDE; y++)
        for (int x = 0; x + 1 < TRACE_SIDE; x++) {
            int i = x, j = y, from = 0;
            /* An edge whose low end is inside: its loop goes up there, inside on its left. */
            if (!(value[y][x] < 0.0) || value[y][x + 1] < 0.0 || seen[y][x]) continue;
            stack_loop(&stack, section);
            loops++;
            do {
                /* The ends of the edge by which the cell is entered: the one inside, then the other. */
                static const int end[4][2][2] = {
                    {{0, 0}, {1, 0}}, {{1, 0}, {1, 1}}, {{1, 1}, {0, 1}}, {{0, 1}, {0, 0}}};
                int const *const a = end[from][0], *const b = end[from][1];
                double in = 0.0, out = 1.0, *p;
                int inside[4], turn, to;
                for (int n = 0; n < 60; n++) {
                    double const t = 0.5 * (in + out), s = i + a[0] + t * (b[0] - a[0]),
                                 r = j + a[1] + t * (b[1] - a[1]);
                    for (int k = 0; k < 3; k++)
                        at[k] = foot[k] + (low + s * side) * u[k] + (low + r * side) * v[k];
                    if (outside(at) < 0.0) in = t;
                    else out = t;
                }
                stack_point(&stack, 0.0, 0.0);
                p = stack.point + 3 * (stack.s.point_count - 1);
                memcpy(p, at, sizeof at);
                if (from == 0) seen[j][i] = 1;

                /* Right where the middle of a cell that all sides of are crossed is inside, else the next side that is. */
                for (int n = 0; n < 4; n++) inside[n] = value[j + end[n][0][1]][i + end[n][0][0]] < 0.0;
                turn = inside[0] != inside[1] && inside[1] != inside[2] && inside[2] != inside[3] &&
                               value[j][i] + value[j][i + 1] + value[j + 1][i] + value[j + 1][i + 1] >= 0.0
                           ? 3
                           : 1;
                for (to = (from + turn) & 3; inside[to] == inside[(to + 1) & 3];) to = (to + 1) & 3;
                i += step[to][0];
                j += step[to][1];
                from = (to + 2) & 3;
            } while (i != x || j != y || from != 0);
        }
    return loops;
}

/* A torus about a turned axis: a radius of 1, a tube of 0.45. */
static double outside_torus(const double at[3])
{
    double const z = 0.6 * at[0] + 0.8 * at[2];
    double const ring = sqrt(fmax(0.0, at[0] * at[0] + at[1] * at[1] + at[2] * at[2] - z * z)) - 1.0;

    return sqrt(ring * ring + z * z) - 0.45;
}

/* A torus through random planes: nearer to it with every plane more, and with enough of them in one piece with one
 * handle. */
static void test_a_torus_through_random_planes(void)
{
    static const int planes[] = {6, 12, 24};
    double last = 1e300;

    for (int i = 0; i < (quick ? 2 : 3); i++) {
        double off = 0.0;
        for (uint64_t seed = 1; seed <= 2; seed++) {
            uint64_t places = 9, s = seed;
            stack_oblique(&stack);
            for (int k = 0; k < planes[i]; k++) trace_body(stack_any_plane(&stack, &s, 0.7), outside_torus);
            o.cells = 24;
            build_good();
            assert_no_crossings();
            assert_lost_points_are_counted();
            /* Where chords of two contours of the torus contradict each other, there may be a handle too many. */
            TEST_ASSERT_TRUE(report.unkept_points + report.unkept_edges <= report.gaps);
            if (planes[i] >= 24 && report.gaps == 0) {
                TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
                TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
                TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.0, certificate.volume / (2.0 * pi * pi * 0.45 * 0.45));
            }
            for (uint64_t v = 0; v < mesh.vertex_count; v++)
                off += fabs(outside_torus((const double *)mesh.positions + 3 * v)) /
                       (double)mesh.vertex_count;

            /* On the planes, but in the sliver between the torus and the chords of its contours. */
            for (int n = 0; n < 20; n++) {
                uint32_t const k = (uint32_t)maker_below(&places, planes[i]);
                double const x = maker_between(&places, -1.4, 1.4, 1000),
                             y = maker_between(&places, -1.4, 1.4, 1000);
                double foot[3], u[3], v[3], at[3], far;
                plane_axes(k, foot, u, v);
                for (int a = 0; a < 3; a++) at[a] = foot[a] + x * u[a] + y * v[a];
                far = outside_torus(at);
                if (fabs(far) > 0.03) TEST_ASSERT_TRUE(fabs((far < 0.0) - stack_winding(&mesh, at)) < 1e-6);
            }
        }
        TEST_ASSERT_TRUE(off < last);
        last = off;
    }
}

/* Handles of the lattice that few vertices at once could not settle: bridges and holes that run along contours, as
 * long as a cell or more. */
static void test_long_handles_between_planes_are_settled(void)
{
    static const uint64_t seed[] = {1060, 10060};

    for (size_t i = 0; i < (long_run ? sizeof seed / sizeof *seed : 1); i++) {
        uint64_t s = seed[i];
        stack_oblique(&stack);
        for (int k = 0; k < 60; k++) trace_body(stack_any_plane(&stack, &s, 0.7), outside_torus);
        o.cells = 32;
        build_good();
        assert_no_crossings();
        assert_lost_points_are_counted();
        TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
        TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
        /* What was put between the planes for the search has moved nothing: 0.043 off without it, tongues of 0.1 else. */
        for (uint64_t v = 0; v < mesh.vertex_count; v++)
            TEST_ASSERT_TRUE(fabs(outside_torus((const double *)mesh.positions + 3 * v)) <
                             (i == 0 ? 0.05 : 0.1));
        TEST_ASSERT_EQUAL_UINT64(0, warned(BVX_WARN_EXTRA_HANDLES));
    }
}

/* A handle that stays, as two contours contradict each other by less than a thousandth of a cell there, is counted. */
static void test_handles_that_stay_are_counted(void)
{
    make_ball(60 + 11000, 60, 0.0);
    o.cells = 32;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_UINT64(1, warned(BVX_WARN_EXTRA_HANDLES));
    TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
}

/* Many planes through a torus, whose contours' chords contradict each other in places: where they leave a surface
 * torn there is a refusal and no mesh, else it is closed and each point that is not kept is counted. */
static void test_a_torn_surface_is_not_handed_out(void)
{
    for (uint64_t seed = 1; seed <= (long_run ? 2 : 1); seed++) {
        uint64_t s = seed;
        stack_oblique(&stack);
        for (int k = 0; k < (long_run ? 60 : 30); k++)
            trace_body(stack_any_plane(&stack, &s, 0.7), outside_torus);
        o.cells = 24;
        if (build() != BVX_OK) {
            refuse_with(BVX_ERR_FORMAT,
                        "the contours contradict each other too much for a closed, manifold mesh");
            continue;
        }
        assert_good();
        assert_lost_points_are_counted();
        TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    }
}

/* Sixty planes through a ball with a cavity: as many as the table of docs/measured.md has. */
static void test_sixty_planes(void)
{
    double const radius[2] = {1.0, 0.5};
    uint64_t places = 60;

    make_ball(60, 60, 0.5);
    o.cells = 24;
    build_good();
    assert_no_crossings();
    assert_contours_kept();
    TEST_ASSERT_EQUAL_UINT64(60, report.planes);
    assert_sides(&places, 20, radius, 2);
    TEST_ASSERT_DOUBLE_WITHIN(0.01, 1.0, certificate.volume / (4.0 / 3.0 * pi * 0.875));
}

/* Planes that have one point of the body, and so no contour, or a contour of some hundredths of a cell there. The
 * latter may come out as a speck of its own, with its contour. */
static void test_planes_that_only_touch_the_body(void)
{
    static const double depth[] = {0.0, 1e-6, 1e-5, 1e-4, 3e-3};

    for (size_t i = 0; i < sizeof depth / sizeof *depth; i++)
        for (uint64_t seed = 1; seed <= (long_run ? 4 : 2); seed++) {
            uint32_t k;
            make_ball(seed, 10, 0.0);
            k = stack_plane(&stack, 0.3, 0.2, 1, 1.0 - depth[i]);
            TEST_ASSERT_EQUAL_INT(depth[i] > 0.0, stack_ball_cut(&stack, k, 0, 0, 0, 1.0, 20));
            o.cells = 24;
            build_good();
            assert_no_crossings();
            assert_contours_kept();
            TEST_ASSERT_EQUAL_UINT64(10 + (depth[i] > 0.0), report.sections);
            TEST_ASSERT_TRUE(certificate.components == 1 || (depth[i] > 0.0 && certificate.components == 2));
            TEST_ASSERT_EQUAL_UINT64(certificate.components - 1, warned(BVX_WARN_SPECKS));
            TEST_ASSERT_EQUAL_INT64(2 * certificate.components, certificate.euler);
            TEST_ASSERT_DOUBLE_WITHIN(0.03, 1.0, certificate.volume / (4.0 / 3.0 * pi));
        }
}

/* Thousands of points in a cell: each is looked for from the one before, since all that those before have split
 * would have to be gone through else. */
static void test_cells_crowded_with_points(void)
{
    stack_oblique(&stack);
    for (int i = 0; i < 3; i++)
        stack_ball_cut(&stack, stack_plane(&stack, i == 0, i == 1, i == 2, 0.1), 0, 0, 0, 1.0,
                       quick ? 2000 : 5000);
    o.cells = 8;
    build_good();
    assert_contours_kept();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
}

/* Contours next to the body and beside it, down to less than what counts as one place: whatever of them is no vertex
 * is counted. */
static void test_tiny_contours_are_kept_or_counted(void)
{
    static const double radius[] = {5e-9, 5e-7, 5e-6, 5e-4, 5e-3};

    for (size_t i = 0; i < sizeof radius / sizeof *radius; i++)
        for (int beside = 0; beside < 2; beside++) {
            double const far = beside ? 1.3 : 0.999, size = sqrt(0.3 * 0.3 + 0.2 * 0.2 + 1.0);
            make_ball(2, 10, 0.0);
            stack_ball_cut(&stack, stack_plane(&stack, 0.3, 0.2, 1, far), 0.3 * far / size, 0.2 * far / size,
                           far / size, radius[i], 20);
            o.cells = 24;
            build_good();
            assert_no_crossings();
            assert_lost_points_are_counted();
            TEST_ASSERT_EQUAL_UINT64(0, report.unkept_edges);
            /* From 1e-4 of a cell on all points are there, by themselves or on the body. */
            if (i >= 2) TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points);
            if (i == 0) TEST_ASSERT_TRUE(report.unkept_points >= 19);
            TEST_ASSERT_EQUAL_UINT64(certificate.components - 1, warned(BVX_WARN_SPECKS));
            if (beside) TEST_ASSERT_EQUAL_UINT64(i > 0, warned(BVX_WARN_SPECKS));
        }
}

/* Whether a contour beside the body fits into a cell does not depend on the point that it begins with. */
static void test_specks_are_small_wherever_they_begin(void)
{
    static const double corner[6][2] = {{-1, -0.7}, {-0.7, -1}, {0.2, -0.2}, {1, 0.7}, {0.7, 1}, {-0.2, 0.2}};
    static const double cells[] = {0.9, 1.6};

    for (int wide = 0; wide < 2; wide++)
        for (int begin = 0; begin < 6; begin += long_run ? 1 : 2) {
            double const half = 0.5 * 0.09 * cells[wide];
            make_ball(2, 10, 0.0);
            o.spacing = 0.09;
            stack_loop(&stack, stack_plane(&stack, 0, 0, 1, 0.1));
            for (int i = 0; i < 6; i++)
                stack_point(&stack, 1.4 + half * corner[(begin + i) % 6][0],
                            half * corner[(begin + i) % 6][1]);
            stack_ball_cut(&stack, (uint32_t)stack.s.section_count - 1, 0, 0, 0, 1.0, 100);
            build_good();
            TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
            TEST_ASSERT_EQUAL_UINT64(wide == 0, warned(BVX_WARN_SPECKS));
        }
}

static uint64_t reports, field_reports;

static int32_t count_report(void *user, const char *stage, double fraction)
{
    (void)user;
    (void)fraction;
    reports++;
    field_reports += strcmp(stage, "field") == 0;
    return 0;
}

static void count_reports(void)
{
    bvx_context_options with = {.struct_size = sizeof with};

    suite_close();
    with.progress.call = count_report;
    with.threads = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&with, &ctx));
    reports = field_reports = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, build());
    bvx_mesh_free(ctx, &mesh);
    bvx_context_destroy(ctx);
    suite_open(0);
}

/* A call of three planes is heard while their points become vertices and their segments edges, not only between
 * planes. */
static void test_many_points_are_reported(void)
{
    uint64_t count[2];

    for (int many = 0; many < 2; many++) {
        stack_oblique(&stack);
        for (int i = 0; i < 3; i++)
            stack_ball_cut(&stack, stack_plane(&stack, i == 0, i == 1, i == 2, 0.1), 0, 0, 0, 1.0,
                           many ? 5000 : 100);
        o.cells = 16;
        count_reports();
        count[many] = reports;
    }
    TEST_ASSERT_TRUE(count[1] >= count[0] + 40);
}

/* The plate is tied to many planes, on each of its three levels along three axes: 90 reports more than the 60 rounds a
 * level that it takes at most. */
static void test_many_planes_are_reported(void)
{
    stack_oblique(&stack);
    for (int k = 0; k < 80; k++)
        stack_ball_cut(&stack, stack_plane(&stack, 0.001 * (k % 3), 0, 1, 0.023 * (k - 40)), 0, 0, 0, 1.0,
                       12);
    o.cells = 8;
    count_reports();
    TEST_ASSERT_TRUE(field_reports >= 240);
}

/* Three planes in one line, through the body's middle, near its border and beside it; and with a fourth across. */
static void test_three_planes_in_one_line(void)
{
    static const double aside[] = {0.0, 0.9, 1.2};

    for (size_t i = 0; i < sizeof aside / sizeof *aside; i++)
        for (int across = 0; across < 2; across++) {
            stack_oblique(&stack);
            for (int k = 0; k < 3; k++) {
                double x, y;
                stack_circle((k + 1) / 7.0, &x, &y);
                /* The line x = aside, y = 0: on each plane. */
                stack_ball_cut(&stack, stack_plane(&stack, x, y, 0, aside[i] * x), 0, 0, 0, 1.0, 60);
            }
            if (across) stack_ball_cut(&stack, stack_plane(&stack, 0, 0, 1, 0.25), 0, 0, 0, 1.0, 60);
            o.cells = 24;
            build_good();
            assert_no_crossings();
            assert_contours_kept();
            TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
            TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
        }
}

/* Two planes that are all but one: side by side, or turned by as little; a thousandth of a cell is the least. */
static void test_nearly_coincident_planes(void)
{
    static const double little[] = {1e-1, 1e-2, 1e-3, 1e-6, 1e-9};

    for (size_t i = 0; i < sizeof little / sizeof *little; i++)
        for (int turned = 0; turned < 2; turned++) {
            double const lean = turned ? little[i] : 0.0, up = turned ? 0.0 : little[i];
            make_ball(4, 8, 0.0);
            stack_ball_cut(&stack, stack_plane(&stack, 0, 0, 1, 0.1), 0, 0, 0, 1.0, 60);
            stack_ball_cut(&stack, stack_plane(&stack, lean, 0, 1, 0.1 + up), 0, 0, 0, 1.0, 60);
            o.cells = 24;
            if (little[i] < 1e-4) {
                refuse_with(BVX_ERR_FORMAT, "sections 8 and 9 lie on one plane");
                continue;
            }
            build_good();
            assert_no_crossings();
            assert_contours_kept();
            TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
        }
}

/* ---- options and their like ---- */

static void test_normals_of_parallel_planes_change_nothing(void)
{
    uint64_t one, two;

    stack_oblique(&stack);
    for (int i = 0; i < 3; i++) {
        uint32_t const k = stack_plane(&stack, 0, 0, 2, 0.5 * i);
        stack_round(&stack, k, 0.1 * i, 0, 1, 1, 20, 0.1, 0, 0);
    }
    build_good();
    TEST_ASSERT_EQUAL_UINT64(0, report.planes);
    bvx_mesh_hash(ctx, &mesh, &one);
    stack.normal[3 + 2] = -1.0;
    stack.position[1] = -0.5;
    build_good();
    bvx_mesh_hash(ctx, &mesh, &two);
    TEST_ASSERT_EQUAL_HEX64(one, two);
    stack.s.normals = NULL;
    stack.position[1] = 0.5;
    build_good();
    bvx_mesh_hash(ctx, &mesh, &two);
    TEST_ASSERT_EQUAL_HEX64(one, two);
}

/* Both ends of a bar by a plane each: what is between is a guess, unless a plane along the bar shows it. */
static void test_parts_that_contours_leave_open_are_counted(void)
{
    for (int along = 0; along < 2; along++) {
        const bvx_warning *w;
        uint32_t k;
        stack_oblique(&stack);
        for (int side = -1; side <= 1; side += 2) {
            k = stack_plane(&stack, 1, 0, 0.05 * side, 3 * side / sqrt(1.0025));
            stack_ball_cut(&stack, k, 3 * side, 0, 0, 0.4, 40);
        }
        if (along) {
            k = stack_plane(&stack, 0, 0, 1, 0);
            stack_loop(&stack, k);
            for (int i = 0; i < 4; i++)
                stack_point(&stack, i == 0 || i == 3 ? -3.5 : 3.5, i < 2 ? -0.4 : 0.4);
        }
        o.cells = 32;
        build_good();
        TEST_ASSERT_EQUAL_UINT64(along ? 1 : 2, certificate.components);
        TEST_ASSERT_EQUAL_UINT64(!along, warned(BVX_WARN_OPEN_PARTS));
        if (along) continue;
        /* The place, before another call forgets it. */
        TEST_ASSERT_EQUAL_INT32(BVX_OK, build());
        w = bvx_next_warning(ctx);
        TEST_ASSERT_TRUE(w != NULL && w->code == BVX_WARN_OPEN_PARTS && w->placed);
        TEST_ASSERT_EQUAL_DOUBLE(1, w->value[0]);
        TEST_ASSERT_DOUBLE_WITHIN(0.1, 3.0, fabs(w->low[0]));
    }

    /* Balls apart, with planes between. */
    for (uint64_t seed = 1; seed <= 3; seed++) {
        uint64_t places = seed;
        stack_oblique(&stack);
        for (int i = 0; i < 16; i++) {
            uint32_t const k = stack_any_plane(&stack, &places, 2.5);
            stack_ball_cut(&stack, k, -2, 0, 0, 1.0, 60);
            stack_ball_cut(&stack, k, 2, 0, 0, 1.0, 60);
        }
        build_good();
        TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
        TEST_ASSERT_EQUAL_UINT64(0, warned(BVX_WARN_OPEN_PARTS));
    }
}

static void test_threads_change_no_oblique_body(void)
{
    uint64_t hash[3];

    make_ball(5, 12, 0.5);
    o.cells = 32;
    for (int i = 0; i < 3; i++) {
        bvx_context_options c = {.struct_size = sizeof c};
        bvx_context *other;
        bvx_mesh made = {0};
        c.threads = 1 + 3 * i;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_sections(other, &stack.s, &o, &made));
        bvx_mesh_hash(ctx, &made, &hash[i]);
        bvx_mesh_free(other, &made);
        bvx_context_destroy(other);
    }
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[2]);
}

static void test_cells_and_spacing_are_one_thing(void)
{
    uint64_t one, two;

    make_ball(5, 5, 0.0);
    o.cells = 16;
    build_good();
    bvx_mesh_hash(ctx, &mesh, &one);
    o.spacing = report.cell[0];
    o.cells = 0;
    build_good();
    bvx_mesh_hash(ctx, &mesh, &two);
    TEST_ASSERT_EQUAL_HEX64(one, two);
    o.cells = 16;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    o.spacing = 0.0;
    o.cells = 7;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    o.cells = 1025;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
}

/* ---- contradictions ---- */

static void test_contradictions_are_named_or_settled(void)
{
    stack_oblique(&stack);
    stack_ball_cut(&stack, stack_plane(&stack, 0, 0, 1, 0), 0, 0, 0, 1.0, 64);
    stack_ball_cut(&stack, stack_plane(&stack, 1, 0, 0, 0), 0, 0, 0, 0.95, 64);
    o.cells = 24;
    refuse_with(BVX_ERR_FORMAT,
                "sections 0 and 1 contradict each other where their planes cross, near (0, -");
    o.agree = 0.1;
    build_good();
    assert_no_crossings();
    TEST_ASSERT_TRUE(fabs(0.05 - report.largest_gap) < 1e-3);

    /* a section that says that there is nothing */
    stack_plane(&stack, 0, 1, 0, 0.5);
    refuse_with(BVX_ERR_FORMAT, "sections 0 and 2 contradict each other");
    stack.position[2] = 1.5; /* where there is nothing */
    build_good();
    TEST_ASSERT_EQUAL_UINT64(2, report.sections);
}

static void add_rectangle(uint32_t section, const double corner[4][3])
{
    stack_loop(&stack, section);
    for (int i = 0; i < 4; i++, stack.s.point_count++)
        memcpy(stack.point + 3 * stack.s.point_count, corner[i], 24);
    stack.loop[stack.s.loop_count - 1].point_count = 4;
}

/* Contours that are moved by many cells: what they sweep on their way is looked at too. */
static void test_contours_moved_far(void)
{
    static const double flat[4][3] = {{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}};
    static const double upright[4][3] = {{2, 0, -2}, {2, 6, -2}, {2, 6, 2}, {2, 0, 2}};

    for (int32_t cells = 8; cells <= 64; cells += 8) {
        stack_oblique(&stack);
        add_rectangle(stack_plane(&stack, 0, 0, 1, 0), flat);
        add_rectangle(stack_plane(&stack, 1, 0, 0, 2), upright);
        o.cells = cells;
        o.agree = 2.5;
        build_good();
        if (cells <= 24) assert_no_crossings();
    }
}

/* However contours contradict each other: once they are allowed to, the surface is closed. */
static void test_contours_that_do_not_belong_together(void)
{
    for (uint64_t seed = 1; seed <= 12; seed++) {
        uint64_t s = seed;
        stack_oblique(&stack);
        for (int i = 0; i < 6; i++) {
            uint32_t const k = stack_any_plane(&stack, &s, 0.5);
            double const x = maker_between(&s, -0.4, 0.4, 100), y = maker_between(&s, -0.4, 0.4, 100);
            double const r = maker_between(&s, 0.6, 1.0, 100);
            stack_ball_cut(&stack, k, x, y, 0.0, r, 12 + (int)seed);
        }
        o.cells = 20;
        o.agree = 1e3;
        build_good();
        assert_no_crossings();
    }
}

/* Contours with a few points moved far within their planes: a closed body, or a refusal and no mesh at all. */
static void test_damaged_contours_make_no_open_body(void)
{
    uint64_t made = 0, seed = 41;

    for (uint64_t i = 0; i < 150; i++) {
        bvx_status status;
        make_ball(i, 3 + (int)(i % 3), 0.0);
        for (uint64_t n = 0; n <= i % 4; n++) {
            const bvx_sections *const v = &stack.s;
            int32_t const l = maker_below(&seed, (int32_t)v->loop_count);
            int32_t const count = (int32_t)v->loops[l].point_count;
            uint64_t const from = v->loops[l].first_point;
            uint64_t const a = from + (uint64_t)maker_below(&seed, count);
            uint64_t const b = from + (uint64_t)maker_below(&seed, count);
            double const t = maker_between(&seed, -3.0, 3.0, 100);
            for (uint64_t k = 0; k < 3; k++)
                stack.point[3 * a + k] += t * (stack.point[3 * b + k] - stack.point[3 * a + k]);
        }
        o.cells = 12;
        o.agree = 1e9;
        status = bvx_build_sections(ctx, &stack.s, &o, &mesh);
        if (status == BVX_OK) {
            bvx_certificate c;
            bvx_mesh_view view;
            bvx_mesh_view_of(&mesh, &view);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
            TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
            made++;
        } else {
            TEST_ASSERT_NULL(mesh.positions);
        }
        bvx_mesh_free(ctx, &mesh);
    }
    TEST_ASSERT_TRUE(made > 20);
}

/* As the header has it, of balls. */
static void test_oblique_bodies_take_no_more_memory_than_said(void)
{
    for (uint64_t cells = 32; cells <= (quick ? 32 : 64); cells *= 2)
        for (uint64_t planes = 5; planes <= 20; planes *= 4) {
            uint64_t const most = 10000000 + 3500 * cells * cells + 15000 * cells * planes +
                                  38000 * planes * planes;
            uint64_t held;

            make_ball(3, (int)planes, 0.0);
            o.cells = (int32_t)cells;
            bvx_mesh_free(ctx, &mesh);
            held = bvx_memory_used(ctx);
            bvx_memory_reset_peak(ctx);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, build());
            TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - held <= most);
            TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - held >= most / 4); /* said is not far too much */
        }
}

static void test_what_planes_are_refused(void)
{
    make_ball(3, 4, 0.0);
    memcpy(stack.normal + 3, stack.normal, 24);
    stack.position[1] = stack.position[0];
    refuse_with(BVX_ERR_FORMAT, "sections 0 and 1 lie on one plane");
    for (int k = 0; k < 3; k++) stack.normal[3 + k] = -2.0 * stack.normal[k];
    stack.position[1] = -stack.position[0];
    refuse_with(BVX_ERR_FORMAT, "sections 0 and 1 lie on one plane");
    make_ball(3, 4, 0.0);
    stack.normal[3] = stack.normal[4] = stack.normal[5] = 0.0;
    refuse_with(BVX_ERR_ARGUMENT, "no length");
    make_ball(3, 4, 0.0);
    stack.normal[3] = NAN;
    refuse_with(BVX_ERR_RANGE, "the normal of section 1 is not finite");
    make_ball(3, 4, 0.0);
    stack.position[2] += 0.1;
    refuse_with(BVX_ERR_FORMAT, "off its plane");
    make_ball(3, 4, 0.0);
    stack.loop[1].label = 2;
    refuse_with(BVX_ERR_ARGUMENT, "several bodies");
    make_ball(3, 4, 0.0);
    stack.loop[1].point_count = 2;
    refuse_with(BVX_ERR_EMPTY, "2 different points");
}

/* Planes that cross at a small angle, within the body and beside it. */
static void test_nearly_parallel_planes(void)
{
    for (int i = 0; i < 4; i++) {
        static const double lean[] = {0.3, 0.03, 0.003, 0.0003};
        stack_oblique(&stack);
        for (int j = -2; j < 3; j++)
            stack_ball_cut(&stack, stack_plane(&stack, (j & 1) ? lean[i] : 0.0, 0, 1, 0.3 * j), 0, 0, 0, 1.0,
                           64);
        stack_ball_cut(&stack, stack_plane(&stack, lean[i], 0, 1, 0), 0, 0, 0, 1.0, 64);
        o.cells = 24;
        build_good();
        assert_no_crossings();
        assert_contours_kept();
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_ball_through_planes_of_any_direction);
    RUN_TEST(test_a_ball_is_not_hollowed_by_chords);
    RUN_TEST(test_a_shell_keeps_its_cavity);
    RUN_TEST(test_near_tangent_crossings_make_no_handle);
    RUN_TEST(test_corners_of_three_planes_have_one_side);
    RUN_TEST(test_many_planes_in_one_line);
    RUN_TEST(test_planes_along_the_axes);
    RUN_TEST(test_two_balls_that_merge);
    RUN_TEST(test_a_plane_that_misses_the_body);
    RUN_TEST(test_a_torus_through_random_planes);
    RUN_TEST(test_long_handles_between_planes_are_settled);
    RUN_TEST(test_handles_that_stay_are_counted);
    RUN_TEST(test_a_torn_surface_is_not_handed_out);
    RUN_TEST(test_sixty_planes);
    RUN_TEST(test_planes_that_only_touch_the_body);
    RUN_TEST(test_cells_crowded_with_points);
    RUN_TEST(test_tiny_contours_are_kept_or_counted);
    RUN_TEST(test_specks_are_small_wherever_they_begin);
    RUN_TEST(test_many_points_are_reported);
    RUN_TEST(test_many_planes_are_reported);
    RUN_TEST(test_three_planes_in_one_line);
    RUN_TEST(test_nearly_coincident_planes);
    RUN_TEST(test_nearly_parallel_planes);
    RUN_TEST(test_normals_of_parallel_planes_change_nothing);
    RUN_TEST(test_parts_that_contours_leave_open_are_counted);
    RUN_TEST(test_threads_change_no_oblique_body);
    RUN_TEST(test_cells_and_spacing_are_one_thing);
    RUN_TEST(test_contradictions_are_named_or_settled);
    RUN_TEST(test_contours_moved_far);
    RUN_TEST(test_contours_that_do_not_belong_together);
    RUN_TEST(test_damaged_contours_make_no_open_body);
    RUN_TEST(test_what_planes_are_refused);
    RUN_TEST(test_oblique_bodies_take_no_more_memory_than_said);
    return UNITY_END();
}
