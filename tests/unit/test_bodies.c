/* test_bodies.c - several bodies at once: a ball cut into two, three, four, an onion in halves, whose faces are
 * known; contours that overlap, that only look as if they touched, and wrong calls. */
#include "section_support.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

enum { MOST_BODIES = 8, CIRCLE = 96 };

static bvx_mesh body[MOST_BODIES];
static const int32_t numbers[MOST_BODIES] = {1, 2, 3, 4, 5, 6, 7, 8};
static double volume[MOST_BODIES];
static int64_t euler[MOST_BODIES];

static void free_bodies(void)
{
    for (int i = 0; i < MOST_BODIES; i++) bvx_mesh_free(ctx, &body[i]);
}

/* ---- contours ---- */

typedef struct half_space {
    double n[3], offset; /* n . x <= offset */
} half_space;

/* A polygon without what lies beyond a plane; a side is cut from its end with the lower coordinates, so that the
 * polygons on both sides of it get the same point. */
static int clip(double (*p)[3], int n, const half_space *h)
{
    double out[4 * CIRCLE][3];
    int made = 0;

    for (int i = 0; i < n; i++) {
        const double *a = p[i], *b = p[(i + 1) % n];
        double ha = h->n[0] * a[0] + h->n[1] * a[1] + h->n[2] * a[2] - h->offset;
        double hb = h->n[0] * b[0] + h->n[1] * b[1] + h->n[2] * b[2] - h->offset;
        if (ha <= 0.0) memcpy(out[made++], a, 24);
        if ((ha < 0.0 && hb > 0.0) || (ha > 0.0 && hb < 0.0)) {
            if (memcmp(a, b, 24) > 0) {
                const double *const swap = a;
                double const height = ha;
                a = b;
                b = swap;
                ha = hb;
                hb = height;
            }
            for (int k = 0; k < 3; k++) out[made][k] = a[k] + ha / (ha - hb) * (b[k] - a[k]);
            made++;
        }
    }
    memcpy(p, out, (size_t)made * 24);
    return made;
}

/* The ball's circle on a section within some half-spaces, as a loop of a label. */
static void add_piece(uint32_t section, int32_t label, double radius, const half_space *half, int halves,
                      int turned)
{
    double p[4 * CIRCLE][3];
    uint64_t const points = stack.s.point_count;
    int n = CIRCLE;

    if (!stack_ball_cut(&stack, section, 0, 0, 0, radius, CIRCLE)) return;
    memcpy(p, stack.point + 3 * points, sizeof p[0] * CIRCLE);
    for (int i = 0; i < halves; i++) n = clip(p, n, &half[i]);
    stack.s.point_count = points;
    if (n < 3) {
        stack.s.loop_count--;
        return;
    }
    for (int i = 0; i < n; i++)
        memcpy(stack.point + 3 * (points + (uint64_t)i), p[turned ? n - 1 - i : i], 24);
    stack.s.point_count += (uint64_t)n;
    stack.loop[stack.s.loop_count - 1].point_count = (uint32_t)n;
    stack.loop[stack.s.loop_count - 1].label = label;
}

/* Sectors around an axis near z, as many as there are bodies. */
static int sector(int bodies, int number, half_space half[2])
{
    for (int side = 0; side < 2; side++) {
        double const turn = 2.0 * pi * (number + side) / bodies + 0.3, sign = side == 0 ? -1.0 : 1.0;
        double const c = cos(turn), s = sin(turn);
        half[side].n[0] = -sign * s;
        half[side].n[1] = sign * c;
        half[side].n[2] = 0.07 * sign * (s + c);
        half[side].offset = sign * 0.03 * (c - s);
    }
    return bodies == 1 ? 0 : bodies == 2 ? 1 : 2;
}

static void begin_sections(uint64_t seed, int planes)
{
    stack_oblique(&stack);
    for (int i = 0; i < planes; i++) {
        if (seed == 0) stack_plane(&stack, 0, 0, 1, -0.9 + 1.8 * i / (planes - 1));
        else stack_any_plane(&stack, &seed, 0.85);
    }
}

/* A ball in sectors. */
static void make_sectors(uint64_t seed, int planes, int bodies)
{
    begin_sections(seed, planes);
    for (uint32_t k = 0; k < (uint32_t)planes; k++)
        for (int i = 0; i < bodies; i++) {
            half_space half[2];
            int const halves = sector(bodies, i, half);
            add_piece(k, i + 1, 1.0, half, halves, i & 1);
        }
}

/* ---- what is looked at ---- */

typedef struct placed_face {
    double p[3][3];
    int body, forward;
} placed_face;

static int compare_places(const void *a, const void *b)
{
    const double *const p = a, *const q = b;
    for (int k = 0; k < 3; k++)
        if (p[k] != q[k]) return p[k] < q[k] ? -1 : 1;
    return 0;
}

static int compare_faces(const void *a, const void *b)
{
    for (int k = 0; k < 3; k++) {
        int const c = compare_places(((const placed_face *)a)->p[k], ((const placed_face *)b)->p[k]);
        if (c != 0) return c;
    }
    return 0;
}

/* Corners in order, and whether it takes an even number of swaps to get there. */
static void sort_face(placed_face *f)
{
    f->forward = 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 2; k++) {
            double swap[3];
            if (compare_places(f->p[k], f->p[k + 1]) <= 0) continue;
            memcpy(swap, f->p[k], 24);
            memcpy(f->p[k], f->p[k + 1], 24);
            memcpy(f->p[k + 1], swap, 24);
            f->forward ^= 1;
        }
}

/* All faces of all bodies by their places. */
static placed_face *list_faces(int bodies, uint64_t *count)
{
    placed_face *list;
    uint64_t n = 0;

    for (int i = 0; i < bodies; i++) n += body[i].triangle_count;
    list = malloc((size_t)n * sizeof *list);
    TEST_ASSERT_NOT_NULL(list);
    *count = n;
    n = 0;
    for (int i = 0; i < bodies; i++)
        for (uint64_t t = 0; t < body[i].triangle_count; t++, n++) {
            for (int k = 0; k < 3; k++)
                memcpy(list[n].p[k],
                       (const double *)body[i].positions +
                           3 * (uint64_t)body[i].triangles[3 * t + (uint64_t)k],
                       24);
            list[n].body = i;
            sort_face(&list[n]);
        }
    qsort(list, (size_t)*count, sizeof *list, compare_faces);
    return list;
}

/* Faces of two bodies at one place are one the other way round; all others lie at the ball's surface, so no gap is
 * between two bodies. *shared: pairs. */
static void assert_faces_are_shared(int bodies, double off, uint64_t *shared)
{
    uint64_t count, wrong = 0, inner = 0;
    placed_face *const list = list_faces(bodies, &count);

    *shared = 0;
    for (uint64_t i = 0; i < count; i++) {
        if (i + 1 < count && compare_faces(&list[i], &list[i + 1]) == 0) {
            wrong += list[i].body == list[i + 1].body || list[i].forward == list[i + 1].forward;
            wrong += i + 2 < count && compare_faces(&list[i], &list[i + 2]) == 0;
            ++*shared;
            i++;
            continue;
        }
        for (int k = 0; k < 3; k++) {
            const double *const p = list[i].p[k];
            inner += sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) < 1.0 - off;
        }
    }
    free(list);
    TEST_ASSERT_EQUAL_UINT64(0, wrong);
    TEST_ASSERT_EQUAL_UINT64(0, inner);
}

static bvx_status build_bodies(int bodies)
{
    free_bodies();
    return bvx_build_bodies(ctx, &stack.s, &o, numbers, (uint32_t)bodies, body);
}

static double build_good_bodies(int bodies)
{
    double sum = 0.0;

    if (build_bodies(bodies) != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    for (int i = 0; i < bodies; i++) {
        bvx_mesh_view view;
        bvx_mesh_view_of(&body[i], &view);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &certificate));
        TEST_ASSERT_TRUE(certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                         certificate.oriented);
        TEST_ASSERT_EQUAL_UINT64(0, certificate.collapsed + certificate.unused_vertices);
        TEST_ASSERT_TRUE(certificate.volume > 0.0);
        volume[i] = certificate.volume;
        euler[i] = certificate.euler;
        sum += certificate.volume;
    }
    return sum;
}

/* Whether a place is in a sector, and how far it is from the sector's sides and the ball's surface. */
static int is_in_sector(int bodies, int number, const double at[3], double *off)
{
    half_space half[2];
    int const halves = sector(bodies, number, half);
    double const r = sqrt(at[0] * at[0] + at[1] * at[1] + at[2] * at[2]);
    int inside = r < 1.0;

    *off = fabs(r - 1.0);
    for (int i = 0; i < halves; i++) {
        double const h = half[i].n[0] * at[0] + half[i].n[1] * at[1] + half[i].n[2] * at[2] - half[i].offset;
        inside &= h < 0.0;
        *off = fabs(h) < *off ? fabs(h) : *off;
    }
    return inside;
}

/* Places on sections at random, but for the ends, are in the body whose contours they are in, and in no other; those
 * where contours were moved to agree are left out. */
static void assert_bodies_on_planes(int bodies, uint64_t seed, int places)
{
    for (int i = 0; i < places; i++) {
        uint64_t const k = 1 + (uint64_t)maker_below(&seed, (int)stack.s.section_count - 2);
        const double *const n = stack.normal + 3 * k;
        double const size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        double at[3], height, off;

        for (int x = 0; x < 3; x++) at[x] = maker_between(&seed, -1.1, 1.1, 1000);
        height = (n[0] * at[0] + n[1] * at[1] + n[2] * at[2]) / size - stack.position[k];
        for (int x = 0; x < 3; x++) at[x] -= height * n[x] / size;
        for (int b = 0; b < bodies; b++) {
            int const inside = is_in_sector(bodies, b, at, &off);
            if (off > 0.03) TEST_ASSERT_TRUE(fabs(inside - stack_winding(&body[b], at)) < 1e-6);
        }
    }
}

/* Each contour point is a vertex of its body, within 1e-12 of the extent: of points that two bodies or planes share but
 * for rounding the first one's coordinates are taken. */
static void assert_contour_points_are_vertices(int bodies)
{
    uint64_t exact = 0;

    TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points + report.unkept_edges);
    for (uint64_t l = 0; l < stack.s.loop_count; l++) {
        const bvx_section_loop *const loop = &stack.loop[l];
        const bvx_mesh *const m = &body[loop->label - 1];
        if (loop->label > bodies) continue;
        for (uint64_t i = loop->first_point; i < loop->first_point + loop->point_count; i++) {
            double least = 1e300;
            for (uint64_t v = 0; v < m->vertex_count && least > 0.0; v++) {
                double off = 0.0;
                for (uint64_t k = 0; k < 3; k++) {
                    double const by = fabs(((const double *)m->positions)[3 * v + k] -
                                           stack.point[3 * i + k]);
                    off = by > off ? by : off;
                }
                least = off < least ? off : least;
            }
            TEST_ASSERT_TRUE(least < 2e-12);
            exact += least == 0.0;
        }
    }
    TEST_ASSERT_TRUE(exact * 10 >= stack.s.point_count * 9);
}

/* ---- bodies ---- */

/* Together they are what one body with the ball's contours is, and each is its sector. */
static void test_sectors_of_a_ball(void)
{
    int const most = quick ? 3 : 4;

    o.cells = 24;
    for (uint64_t seed = 0; seed < (long_run ? 3 : 2); seed++) {
        double whole = 0.0;
        for (int bodies = 1; bodies <= most; bodies++) {
            uint64_t shared;
            double sum;

            make_sectors(seed, seed == 0 ? 9 : 12, bodies);
            sum = build_good_bodies(bodies);
            if (bodies == 1) whole = sum;
            TEST_ASSERT_TRUE(fabs(sum - whole) < 1e-3 * whole);
            for (int i = 0; i < bodies; i++)
                TEST_ASSERT_TRUE(fabs(volume[i] - whole / bodies) < 0.2 * whole / bodies);

            /* A sector is simple: no body comes to the surface in specks, as handles of itself. */
            for (int i = 0; i < bodies; i++) TEST_ASSERT_EQUAL_INT64(2, euler[i]);

            /* Flat ends of a stack lie inside of the ball. */
            assert_faces_are_shared(bodies, seed == 0 ? 1.0 : 0.15, &shared);
            TEST_ASSERT_TRUE(bodies == 1 ? shared == 0 : shared > 1000);
            if (bodies != 3) continue;
            assert_contour_points_are_vertices(bodies);
            assert_bodies_on_planes(bodies, seed + 5, 12);
        }
    }
}

/* ---- the curve on the surface along which bodies meet ---- */

typedef struct placed_edge {
    double p[2][3];
    int outer;
} placed_edge;

static int compare_edges(const void *a, const void *b)
{
    int const c = compare_places(((const placed_edge *)a)->p[0], ((const placed_edge *)b)->p[0]);
    return c != 0 ? c : compare_places(((const placed_edge *)a)->p[1], ((const placed_edge *)b)->p[1]);
}

/* The length of all edges between faces that two bodies have and faces that one of them has, each once. */
static double length_of_curves(int bodies)
{
    uint64_t count, edges = 0;
    placed_face *const list = list_faces(bodies, &count);
    placed_edge *const edge = malloc((size_t)count * 3 * sizeof *edge);
    double length = 0.0;

    TEST_ASSERT_NOT_NULL(edge);
    for (uint64_t i = 0; i < count; i++) {
        int const shared = (i > 0 && compare_faces(&list[i - 1], &list[i]) == 0) ||
                           (i + 1 < count && compare_faces(&list[i], &list[i + 1]) == 0);

        /* Corners are in order, so an edge has one direction. */
        for (int k = 0; k < 3; k++, edges++) {
            memcpy(edge[edges].p[0], list[i].p[k == 2 ? 0 : k], 24);
            memcpy(edge[edges].p[1], list[i].p[k == 2 ? 2 : k + 1], 24);
            edge[edges].outer = !shared;
        }
    }
    qsort(edge, (size_t)edges, sizeof *edge, compare_edges);
    for (uint64_t i = 0, end; i < edges; i = end) {
        int outer = 0, inner = 0;
        double square = 0.0;

        for (end = i; end < edges && compare_edges(&edge[i], &edge[end]) == 0; end++) {
            outer |= edge[end].outer;
            inner |= !edge[end].outer;
        }
        for (int k = 0; k < 3; k++) square += pow(edge[i].p[1][k] - edge[i].p[0][k], 2.0);
        if (outer && inner) length += sqrt(square);
    }
    free(edge);
    free(list);
    return length;
}

/* Sectors of a stack's ball meet on its surface in arcs, from the flat end below to the one above, and on both ends in
 * lines to the middle: as long as those, not a zigzag along the lattice's edges (1.4 times as long at 24 cells). */
static void test_the_curve_between_bodies_is_smooth(void)
{
    for (int bodies = 2; bodies <= 4; bodies++) {
        double const arc = 2.0 * asin(0.9) + 2.0 * sqrt(1.0 - 0.81);

        make_sectors(0, 9, bodies);
        o.cells = quick ? 24 : 40;
        (void)build_good_bodies(bodies);
        TEST_ASSERT_TRUE(fabs(length_of_curves(bodies) / (bodies * arc) - 1.0) < (quick ? 0.1 : 0.06));
    }
}

/* One body is what it is alone, to the blend. */
static void test_one_body_is_as_it_is_alone(void)
{
    double alone;

    make_sectors(2, 12, 1);
    o.cells = 24;
    build_good();
    alone = certificate.volume;
    TEST_ASSERT_TRUE(fabs(build_good_bodies(1) - alone) < 2e-3 * alone);
}

/* A stack of squares side by side: blocks of a known size, with one flat face between them. */
static void test_blocks_side_by_side(void)
{
    uint64_t shared, count, off = 0;
    placed_face *list;

    for (int way = 0; way < 2; way++) {
        stack_clear(&stack);
        for (int k = 0; k < 4; k++) {
            uint32_t const section = stack_section(&stack, k / 3.0);
            for (int i = 0; i < 2; i++) {
                stack_loop(&stack, section);
                stack.loop[stack.s.loop_count - 1].label = i + 1;
                for (int c = 0; c < 4; c++) {
                    double const x = (c == 1 || c == 2) ? 1.0 : 0.0;
                    stack_point(&stack, way == 0 ? x + i : c / 2, way == 0 ? c / 2 : x + i);
                }
            }
        }
        o.cells = 48;
        /* Upright corners are rounded between the sections, as the distances there are. */
        TEST_ASSERT_TRUE(fabs(build_good_bodies(2) - 2.0) < 0.04);
        TEST_ASSERT_TRUE(fabs(volume[0] - volume[1]) < 0.002);
        assert_faces_are_shared(2, 10.0, &shared);
        TEST_ASSERT_TRUE(shared > 100);
        TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points + report.unkept_edges);
    }

    /* All faces that both have lie where the squares touch. */
    list = list_faces(2, &count);
    for (uint64_t i = 0; i + 1 < count; i++)
        for (int k = 0; k < 3 && compare_faces(&list[i], &list[i + 1]) == 0; k++)
            off += fabs(list[i].p[k][1] - 1.0) > 0.02;
    free(list);
    TEST_ASSERT_EQUAL_UINT64(0, off);
}

/* A shell around a core of its own, whose faces are all the shell's too. */
static void test_an_onion(void)
{
    for (uint64_t seed = 0; seed < 2; seed++) {
        double const small = 0.5, core = 4.0 / 3.0 * pi * small * small * small;
        uint64_t shared;

        begin_sections(seed, seed == 0 ? 12 : 16);
        for (uint32_t k = 0; k < stack.s.section_count; k++) {
            add_piece(k, 1, 1.0, NULL, 0, 0);
            add_piece(k, 1, small, NULL, 0, 0);
            add_piece(k, 2, small, NULL, 0, (int)k & 1);
        }
        o.cells = 24;
        build_good_bodies(2);
        TEST_ASSERT_TRUE(fabs(volume[1] - core) < 0.05 * core);
        assert_faces_are_shared(2, seed == 0 ? 1.0 : 0.15, &shared);
        TEST_ASSERT_TRUE(shared == body[1].triangle_count);
        assert_contour_points_are_vertices(2);
    }
}

static void test_bodies_apart_share_nothing(void)
{
    uint64_t shared;

    stack_oblique(&stack);
    for (int i = 0; i < 8; i++) {
        uint64_t seed = 20 + (uint64_t)i;
        uint32_t const k = stack_any_plane(&stack, &seed, 0.3);
        for (int b = 0; b < 2; b++)
            if (stack_ball_cut(&stack, k, 2.0 * b - 1.0, 0, 0, 0.6, 40))
                stack.loop[stack.s.loop_count - 1].label = b + 1;
    }
    o.cells = 32;
    build_good_bodies(2);
    assert_faces_are_shared(2, 10.0, &shared);
    TEST_ASSERT_EQUAL_UINT64(0, shared);
}

static void test_tapered_bodies_end_beyond(void)
{
    double flat;

    make_sectors(0, 5, 2);
    o.cells = 24;
    flat = build_good_bodies(2);
    o.caps = BVX_CAPS_TAPER;
    TEST_ASSERT_TRUE(build_good_bodies(2) > 1.01 * flat);
}

static void test_threads_and_positions_change_no_body(void)
{
    uint64_t hash[3][3];

    make_sectors(1, 10, 3);
    o.cells = 20;
    for (int i = 0; i < 3; i++) {
        bvx_context *const other = suite_context(1 + 3 * i, BVX_CPU_BEST);
        bvx_mesh made[3] = {0};
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_bodies(other, &stack.s, &o, numbers, 3, made));
        for (int b = 0; b < 3; b++) {
            bvx_mesh_hash(other, &made[b], &hash[i][b]);
            bvx_mesh_free(other, &made[b]);
        }
        bvx_context_destroy(other);
    }
    for (int b = 0; b < 3; b++) {
        TEST_ASSERT_EQUAL_HEX64(hash[0][b], hash[1][b]);
        TEST_ASSERT_EQUAL_HEX64(hash[0][b], hash[2][b]);
    }
    o.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, build_bodies(3));
    TEST_ASSERT_EQUAL_INT32(BVX_F32, body[2].position_type);
}

/* Edges at which a body touches itself: sectors of two bodies in turn around one axis. */
static void test_bodies_that_touch_themselves(void)
{
    uint64_t shared;

    begin_sections(0, 6);
    for (uint32_t k = 0; k < stack.s.section_count; k++)
        for (int i = 0; i < 4; i++) {
            half_space half[2];
            int const halves = sector(4, i, half);
            add_piece(k, 1 + (i & 1), 1.0, half, halves, 0);
        }
    o.cells = 16;
    build_bodies(2);
    /* Loops of one label that touch are refused, as for one body. */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, bvx_last_error(ctx)->status);

    /* Apart on planes, and pressed against each other between them. */
    begin_sections(0, 5);
    for (uint32_t k = 0; k < stack.s.section_count; k++)
        for (int i = 0; i < 4; i++) {
            half_space half[2];
            int const halves = sector(4, (i + (int)k) % 4, half);
            if (i < 2) add_piece(k, 1 + i, 1.0, half, halves, 0);
        }
    build_good_bodies(2);
    assert_faces_are_shared(2, 10.0, &shared);
}

static void test_bodies_take_no_more_memory_than_said(void)
{
    for (uint64_t cells = 24; cells <= (quick ? 24 : 48); cells *= 2) {
        uint64_t const most = 10000000 + 20000 * cells * cells, held = bvx_memory_used(ctx);

        make_sectors(0, 9, 3);
        o.cells = (int32_t)cells;
        bvx_memory_reset_peak(ctx);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, build_bodies(3));
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - held <= most);
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - held >= most / 4); /* said is not far too much */
        free_bodies();
    }
}

/* The contours that both have, of many points in few cells, are found again in a time that grows with them: by
 * their neighbourhood half as many took 91 s. */
static void test_many_points_where_bodies_touch(void)
{
    enum { WAVE = 8000 };
    uint64_t shared;

    stack_clear(&stack);
    for (int k = 0; k < 3; k++) {
        uint32_t const section = stack_section(&stack, k);
        for (int i = 0; i < 2; i++) {
            stack_loop(&stack, section);
            stack.loop[stack.s.loop_count - 1].label = i + 1;
            for (int n = 0; n <= WAVE; n++) {
                double const y = (double)(i == 0 ? n : WAVE - n) / WAVE;
                stack_point(&stack, 1.0 + 0.1 * sin(300.0 * y), y);
            }
            stack_point(&stack, 2.0 * i, i == 0 ? 1.0 : 0.0);
            stack_point(&stack, 2.0 * i, i == 0 ? 0.0 : 1.0);
        }
    }
    o.cells = 32;
    (void)build_good_bodies(2);
    assert_faces_are_shared(2, 10.0, &shared);
    TEST_ASSERT_TRUE(shared > 10 * WAVE);
    TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points);
}

/* ---- refusals ---- */

static void refuse_bodies(bvx_status status, uint32_t count, const int32_t *labels, const char *words)
{
    free_bodies();
    TEST_ASSERT_EQUAL_INT32(status, bvx_build_bodies(ctx, &stack.s, &o, labels, count, body));
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    for (int i = 0; i < MOST_BODIES; i++) TEST_ASSERT_NULL(body[i].positions);
}

static void test_what_bodies_are_refused(void)
{
    static const int32_t twice[2] = {1, 1}, absent[2] = {1, 7}, only[2] = {1, BVX_LABEL_ZERO};
    half_space const half = {{1.0, 0.0, 0.0}, 0.0};

    make_sectors(0, 5, 2);
    refuse_bodies(BVX_ERR_ARGUMENT, 0, numbers, "1 to 63 bodies");
    refuse_bodies(BVX_ERR_ARGUMENT, 64, numbers, "1 to 63 bodies");
    refuse_bodies(BVX_ERR_ARGUMENT, 2, twice, "labels[0] and labels[1] are both 1");
    refuse_bodies(BVX_ERR_EMPTY, 2, absent, "no loop has the label 7");
    refuse_bodies(BVX_ERR_ARGUMENT, 1, only + 1, "labels[0] is BVX_LABEL_ZERO");
    refuse_bodies(BVX_ERR_ARGUMENT, 2, only, "labels[1] is BVX_LABEL_ZERO");
    refuse_bodies(BVX_ERR_ARGUMENT, 2, NULL, "labels");
    o.caps = BVX_CAPS_OPEN;
    refuse_bodies(BVX_ERR_ARGUMENT, 2, numbers, "caps are flat or tapered");
    o.caps = BVX_CAPS_FLAT;

    /* One whole, the other half of it; both the same; one deep in the other without a hole there. */
    for (int way = 0; way < 3; way++) {
        begin_sections(0, 4);
        for (uint32_t k = 0; k < 4; k++) {
            add_piece(k, 1, 1.0, NULL, 0, 0);
            add_piece(k, 2, way == 2 ? 0.5 : 1.0, &half, way == 0, 0);
        }
        refuse_bodies(BVX_ERR_FORMAT, 2, numbers, "labels 1 and 2 overlap");
    }

    /* All contours on one of the planes: flat caps leave nothing, tapered ones a lens. The only label there is
     * must be named all the same. */
    begin_sections(0, 3);
    add_piece(1, 1, 1.0, &half, 1, 0);
    refuse_bodies(BVX_ERR_EMPTY, 1, numbers, "only section 1 has contours");
    refuse_bodies(BVX_ERR_ARGUMENT, 1, only + 1, "labels[0] is BVX_LABEL_ZERO");
    o.caps = BVX_CAPS_TAPER;
    (void)build_good_bodies(1);
}

int main(void)
{
    UNITY_BEGIN();
    free_more = free_bodies;
    RUN_TEST(test_sectors_of_a_ball);
    RUN_TEST(test_the_curve_between_bodies_is_smooth);
    RUN_TEST(test_one_body_is_as_it_is_alone);
    RUN_TEST(test_blocks_side_by_side);
    RUN_TEST(test_an_onion);
    RUN_TEST(test_bodies_apart_share_nothing);
    RUN_TEST(test_tapered_bodies_end_beyond);
    RUN_TEST(test_threads_and_positions_change_no_body);
    RUN_TEST(test_bodies_that_touch_themselves);
    RUN_TEST(test_bodies_take_no_more_memory_than_said);
    RUN_TEST(test_many_points_where_bodies_touch);
    RUN_TEST(test_what_bodies_are_refused);
    return UNITY_END();
}
