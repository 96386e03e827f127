/* test_simplify_colours.c - levels with a weight of colours: the borders of colours
 * stay where they are, the geometry nearly as good, the guarantee the same; without
 * a weight not a bit changes. Quadrics against sums over all triangles. */
#include "collapse_support.h"

enum { COLOUR_RINGS = 70, COLOUR_TARGET = 400 };

/* A ball of radius 4 about (8, 8, 8), in two colours, beyond a tilted plane and before it. */
static const double border_normal[3] = {0.36, 0.48, 0.8};
static uint8_t tint[4 * 40000];

static double beyond(const double p[3])
{
    double sum = -1.0;

    for (int a = 0; a < 3; a++) sum += border_normal[a] * (p[a] - 8);
    return sum;
}

static void paint(void)
{
    static const uint8_t colour[2][4] = {{220, 30, 40, 255}, {20, 120, 230, 255}};

    TEST_ASSERT_TRUE(4 * mesh.vertices <= sizeof tint);
    for (size_t v = 0; v < mesh.vertices; v++) memcpy(tint + 4 * v, colour[beyond(mesh.p + 3 * v) > 0], 4);
}

static void make_ball(void)
{
    static const double centre[3] = {8, 8, 8}, radius[3] = {4, 4, 4};

    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0, COLOUR_RINGS, COLOUR_RINGS, 1 << 20);
    paint();
}

static bvx_mesh_view coloured_view(void)
{
    bvx_mesh_view view = maker_view(&mesh);

    view.colours = tint;
    return view;
}

static void simplify_coloured(double weight, uint64_t target)
{
    bvx_mesh_view const view = coloured_view();
    bvx_simplify_options o = {.struct_size = sizeof o};

    drop_levels();
    o.targets.triangles = &target;
    o.collapse.attribute_weight = weight > 0 ? weight : BVX_NONE;
    o.targets.samples = 20000;
    o.reports = report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, level),
                                    bvx_last_message(ctx));
}

/* How far the line lies from the border, by its length, where the level's
 * red is half of what both colours have. */
static double border_shift(const bvx_mesh *m)
{
    double sum = 0, length = 0;

    for (uint64_t t = 0; t < m->triangle_count; t++) {
        double end[3][3];
        int ends = 0;

        for (int k = 0; k < 3; k++) {
            uint64_t const u = m->triangles[3 * t + (uint64_t)k];
            uint64_t const v = m->triangles[3 * t + (uint64_t)(k + 1) % 3];
            /* whole numbers: never 0 */
            double const red_u = m->colours[4 * u] - 120.5, red_v = m->colours[4 * v] - 120.5;

            if ((red_u > 0) == (red_v > 0)) continue;
            for (uint64_t a = 0; a < 3; a++)
                end[ends][a] = position_of(m, 3 * u + a) +
                               (position_of(m, 3 * v + a) - position_of(m, 3 * u + a)) * red_u /
                                   (red_u - red_v);
            ends++;
        }
        if (ends == 2) {
            double const off = 0.5 * (fabs(beyond(end[0])) + fabs(beyond(end[1])));
            double square = 0;

            for (int a = 0; a < 3; a++) square += (end[0][a] - end[1][a]) * (end[0][a] - end[1][a]);
            sum += off * sqrt(square);
            length += sqrt(square);
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(length > 10, "the level has lost the border");
    return sum / length;
}

/* ---- What a weight does ---- */

static void test_borders_of_colours_stay(void)
{
    static const double weight[3] = {0, 1, 2}, most[3] = {1, 0.5, 0.3};
    double shift[3], distance[3];

    make_ball();
    for (int i = 0; i < 3; i++) {
        simplify_coloured(weight[i], COLOUR_TARGET);
        snprintf(where, sizeof where, "weight %g", weight[i]);
        TEST_ASSERT_TRUE_MESSAGE(report[0].met, where);
        assert_whole(&level[0], 2, 1);
        assert_no_crossings(&level[0]);
        shift[i] = border_shift(&level[0]);
        distance[i] = report[0].distance.mean;
        snprintf(where, sizeof where,
                 "weight %g: the border is off by %.4f of %.4f, the surface by %.4f of %.4f", weight[i],
                 shift[i], shift[0], distance[i], distance[0]);
        TEST_ASSERT_TRUE_MESSAGE(
            i == 0 || (shift[i] < most[i] * shift[0] && distance[i] < 1.25 * distance[0]), where);
    }
}

static void test_open_meshes_keep_their_borders_too(void)
{
    uint64_t loops;

    make_ball();
    maker_remove(&mesh, 2000);
    maker_remove(&mesh, 5000);
    simplify_coloured(1, COLOUR_TARGET);
    loops = report[0].certificate.boundary_edges;
    snprintf(where, sizeof where, "%d border edges, off by %.4f", (int)loops, border_shift(&level[0]));
    TEST_ASSERT_TRUE_MESSAGE(report[0].met && loops == 6, where);
    TEST_ASSERT_TRUE_MESSAGE(border_shift(&level[0]) < 0.06, where);
}

static int shared_vertices(const uint32_t a[3], const uint32_t b[3])
{
    int n = 0;

    for (int i = 0; i < 9; i++) n += a[i / 3] == b[i % 3];
    return n;
}

/* Take away two triangles of a vertex that have nothing else in common, so that two fans are left. */
static void pinch_at(uint32_t v)
{
    for (size_t i = 0; i < mesh.triangles; i++)
        for (size_t j = i + 1; j < mesh.triangles; j++) {
            const uint32_t *const a = mesh.t + 3 * i, *const b = mesh.t + 3 * j;

            if ((a[0] != v && a[1] != v && a[2] != v) || shared_vertices(a, b) != 1 ||
                (b[0] != v && b[1] != v && b[2] != v))
                continue;
            maker_remove(&mesh, j);
            maker_remove(&mesh, i);
            return;
        }
}

/* Vertices that join several fans are parted, each part with their colour. */
static void test_parts_that_touch_keep_their_colours(void)
{
    bvx_certificate before;
    bvx_mesh_view view;

    make_ball();
    for (uint32_t v = 1000; v < 4000; v += 150) pinch_at(v);
    view = coloured_view();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &before));
    TEST_ASSERT_EQUAL_INT32(0, before.vertex_manifold);

    simplify_coloured(1, 2000);
    TEST_ASSERT_EQUAL_INT32(1, report[0].certificate.vertex_manifold);
    TEST_ASSERT_TRUE(border_shift(&level[0]) < 0.06);
}

/* ---- What it does not ---- */

/* Vertices come in the order of triangles where they have attributes. */
static void assert_same_corners(const bvx_mesh *a, const bvx_mesh *b)
{
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(a->triangle_count, b->triangle_count, where);
    for (uint64_t i = 0; i < 3 * a->triangle_count; i++)
        for (uint64_t k = 0; k < 3; k++)
            TEST_ASSERT_TRUE_MESSAGE(position_of(a, 3 * (uint64_t)a->triangles[i] + k) ==
                                         position_of(b, 3 * (uint64_t)b->triangles[i] + k),
                                     where);
}

static void test_without_a_weight_or_colours_nothing_changes(void)
{
    bvx_mesh plain;

    make_ball();
    simplify_coloured(0, COLOUR_TARGET);
    plain = level[0];
    memset(level, 0, sizeof level);
    for (int way = 0; way < 2; way++) {
        bvx_mesh_view const view = maker_view(&mesh);
        uint64_t const target = COLOUR_TARGET;
        bvx_simplify_options o = {.struct_size = sizeof o};

        drop_levels();
        o.targets.triangles = &target;
        o.collapse.attribute_weight = way == 0 ? BVX_NONE : 0.5; /* of colours that are not there */
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, level));
        snprintf(where, sizeof where, "way %d", way);
        assert_same_corners(&plain, &level[0]);
    }
    bvx_mesh_free(ctx, &plain);
}

/* Triangles, their corners and vertices in any order, and any number of threads. */
static void test_order_and_threads_do_not_matter(void)
{
    bvx_mesh wanted;

    make_ball();
    simplify_coloured(1, COLOUR_TARGET);
    wanted = level[0];
    memset(level, 0, sizeof level);
    for (int way = 0; way < 3; way++) {
        maker_shuffle_triangles(&mesh, &seed);
        if (way != 0) maker_shuffle_vertices(&mesh, &seed);
        paint();
        simplify_coloured(1, COLOUR_TARGET);
        assert_same_bytes(&wanted, &level[0]);
    }
    for (int32_t threads = 2; threads <= 3; threads++) {
        bvx_mesh_view const view = coloured_view();
        uint64_t const target = COLOUR_TARGET;
        bvx_simplify_options o = {.struct_size = sizeof o};
        bvx_context_options c = {.struct_size = sizeof c};
        bvx_context *other;
        bvx_mesh made = {0};

        c.threads = threads;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
        o.targets.triangles = &target;
        o.collapse.attribute_weight = 1;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(other, &view, &o, 1, &made));
        assert_same_bytes(&wanted, &made);
        bvx_mesh_free(other, &made);
        bvx_context_destroy(other);
    }
    bvx_mesh_free(ctx, &wanted);
}

/* With four channels, beside the same mesh without any. */
static void test_memory_is_as_the_header_says(void)
{
    uint64_t const target = COLOUR_TARGET;
    double peak[2], most;

    make_ball();
    for (int i = 0; i < 2; i++) {
        bvx_mesh_view const view = i == 0 ? maker_view(&mesh) : coloured_view();
        uint64_t before;
        bvx_simplify_options o = {.struct_size = sizeof o};

        drop_levels();
        o.targets.triangles = &target;
        bvx_memory_reset_peak(ctx);
        before = bvx_memory_used(ctx);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, level));
        peak[i] = (double)(bvx_memory_peak(ctx) - before);
    }
    most = (200 + 32 * 4.0) * (double)mesh.vertices;
    snprintf(where, sizeof where, "%.3f of what is stated", (peak[1] - peak[0]) / most);
    TEST_ASSERT_TRUE_MESSAGE(peak[1] - peak[0] <= most && peak[1] - peak[0] > 0.7 * most, where);
}

/* ---- The quadric ---- */

/* The value of a channel where a plane through a triangle's corners has it,
 * by barycentric weights of the nearest point of the plane. */
static double value_at(const double p[3][3], const double value[3], const double x[3])
{
    double u[3], v[3], w[3], uu = 0, uv = 0, vv = 0, wu = 0, wv = 0, s, t;

    for (int a = 0; a < 3; a++) {
        u[a] = p[1][a] - p[0][a];
        v[a] = p[2][a] - p[0][a];
        w[a] = x[a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) {
        uu += u[a] * u[a];
        uv += u[a] * v[a];
        vv += v[a] * v[a];
        wu += w[a] * u[a];
        wv += w[a] * v[a];
    }
    s = (wu * vv - wv * uv) / (uu * vv - uv * uv);
    t = (wv * uu - wu * uv) / (uu * vv - uv * uv);
    return value[0] + s * (value[1] - value[0]) + t * (value[2] - value[0]);
}

static double twice_the_area(const double p[3][3])
{
    double n[3], sum = 0;

    bvxi_area_normal(p[0], p[1], p[2], n);
    for (int a = 0; a < 3; a++) sum += n[a] * n[a];
    return sqrt(sum);
}

/* The triangles of two vertices summed at a position, each counted for every one of the two that it has; the best
 * colour is the mean. */
static double summed_cost(const bvxi_collapse *c, const uint32_t ends[2], const double x[3])
{
    const bvxi_corners *const m = &c->mesh;
    double cost = 0;

    for (uint64_t channel = 0; channel < 4; channel++) {
        double area = 0, sum = 0, squares = 0;

        for (uint64_t t = 0; t < m->triangles; t++)
            for (int end = 0; end < 2; end++)
                for (int k = 0; k < 3; k++) {
                    double p[3][3], value[3], at, w;

                    if (m->triangle[t].vertex[k] != ends[end]) continue;
                    for (int i = 0; i < 3; i++) {
                        uint32_t const v = m->triangle[t].vertex[i];

                        value[i] = tint[4 * (uint64_t)m->source[v] + channel] / 255.0 *
                                   c->attributes.length[channel];
                        for (int a = 0; a < 3; a++) p[i][a] = m->at[v].p[a] * c->scale;
                    }
                    w = twice_the_area((const double(*)[3])p);
                    at = value_at((const double(*)[3])p, value, x);
                    area += w;
                    sum += w * at;
                    squares += w * at * at;
                }
        cost += squares - sum * sum / area;
    }
    return cost;
}

static void test_quadrics_equal_sums_over_the_triangles(void)
{
    bvxi_collapse_options o = collapse_options();
    bvx_mesh_view view;
    double found_cost = 0;

    make_ball();
    for (size_t i = 0; i < 4 * mesh.vertices; i++) tint[i] = (uint8_t)maker_below(&seed, 256);
    view = coloured_view();
    open_view(&view, &o);
    for (int round = 0; round < 60; round++) {
        const bvxi_corners *const m = &collapse->mesh;
        int32_t const edge = 4 * maker_below(&seed, (int32_t)m->triangles) + maker_below(&seed, 3);
        uint32_t const ends[2] = {bvxi_corner_vertex_of(m, bvxi_corner_next(edge)),
                                  bvxi_corner_vertex_of(m, bvxi_corner_previous(edge))};
        double offset[3], a[6] = {0}, b[3] = {0}, cost = 0;

        for (int k = 0; k < 3; k++) offset[k] = (m->at[ends[1]].p[k] - m->at[ends[0]].p[k]) * collapse->scale;
        bvxi_attributes_add(collapse, edge, offset, a, b, &cost);
        for (int place = 0; place < 3; place++) {
            double x[3], d[3], value, wanted;

            for (int k = 0; k < 3; k++) {
                d[k] = place == 0 ? 0 : maker_between(&seed, -0.1, 0.1, 1 << 20);
                x[k] = m->at[ends[0]].p[k] * collapse->scale + d[k];
            }
            value = cost + 2 * (b[0] * d[0] + b[1] * d[1] + b[2] * d[2]) + a[0] * d[0] * d[0] +
                    a[3] * d[1] * d[1] + a[5] * d[2] * d[2] +
                    2 * (a[1] * d[0] * d[1] + a[2] * d[0] * d[2] + a[4] * d[1] * d[2]);
            wanted = summed_cost(collapse, ends, x);
            found_cost += wanted;
            snprintf(where, sizeof where, "round %d: %.12g for %.12g", round, value, wanted);
            TEST_ASSERT_TRUE_MESSAGE(fabs(value - wanted) < 1e-6 * fabs(wanted) + 1e-12, where);
        }
    }
    TEST_ASSERT_TRUE(found_cost > 0);
    close_view();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_borders_of_colours_stay);
    RUN_TEST(test_open_meshes_keep_their_borders_too);
    RUN_TEST(test_parts_that_touch_keep_their_colours);
    RUN_TEST(test_without_a_weight_or_colours_nothing_changes);
    RUN_TEST(test_order_and_threads_do_not_matter);
    RUN_TEST(test_memory_is_as_the_header_says);
    RUN_TEST(test_quadrics_equal_sums_over_the_triangles);
    return UNITY_END();
}
