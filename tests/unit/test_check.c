/* test_check.c - certificates against comparing everything with everything, and known shapes. */
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh mesh;
static uint64_t seed;

void setUp(void)
{
    suite_open(0);
    seed = 4;
    maker_clear(&mesh);
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static bvx_certificate check(int32_t weld)
{
    bvx_mesh_view const v = maker_view(&mesh);
    bvx_certificate c;
    memset(&c, 0xff, sizeof c);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_check(ctx, &v, weld, &c), bvx_last_message(ctx));
    return c;
}

/* ---- The oracle: every pair of everything is compared ---- */

enum { ORACLE_TRIANGLES = 160 };

static uint32_t kept[ORACLE_TRIANGLES][3];
static size_t kept_count;

static int has_vertex(size_t t, uint32_t v)
{
    return kept[t][0] == v || kept[t][1] == v || kept[t][2] == v;
}

static int has_edge(size_t t, uint32_t a, uint32_t b)
{
    return has_vertex(t, a) && has_vertex(t, b);
}

static int runs_along(size_t t, uint32_t a, uint32_t b)
{
    return (kept[t][0] == a && kept[t][1] == b) || (kept[t][1] == a && kept[t][2] == b) ||
           (kept[t][2] == a && kept[t][0] == b);
}

static uint64_t sides_of_edge(uint32_t a, uint32_t b)
{
    uint64_t n = 0;
    for (size_t t = 0; t < kept_count; t++) n += (uint64_t)has_edge(t, a, b);
    return n;
}

/* Do s and t share an edge (with v on it, unless v is no vertex)? */
static int share_edge(size_t s, size_t t, uint32_t v)
{
    for (int k = 0; k < 3; k++) {
        uint32_t const a = kept[s][k], b = kept[s][(k + 1) % 3];
        if (has_edge(t, a, b) && (v == UINT32_MAX || a == v || b == v)) return 1;
    }
    return 0;
}

/* Pieces of the triangles at v (all of them when v is no vertex), through shared edges (at v). */
static uint64_t count_pieces(uint32_t v)
{
    uint8_t reached[ORACLE_TRIANGLES] = {0};
    uint64_t pieces = 0;

    for (size_t s = 0; s < kept_count; s++) {
        int grown = 1;
        if (reached[s] || (v != UINT32_MAX && !has_vertex(s, v))) continue;
        pieces++;
        reached[s] = (uint8_t)pieces;
        while (grown) {
            grown = 0;
            for (size_t a = 0; a < kept_count; a++)
                for (size_t b = 0; b < kept_count && reached[a] == (uint8_t)pieces; b++)
                    if (!reached[b] && share_edge(a, b, v)) {
                        reached[b] = (uint8_t)pieces;
                        grown = 1;
                    }
            if (pieces > 250) TEST_FAIL_MESSAGE("the oracle is too small");
        }
        for (size_t a = 0; a < kept_count; a++)
            if (reached[a] == (uint8_t)pieces) reached[a] = 255;
    }
    return pieces;
}

static uint32_t least_equal(uint32_t v, int weld)
{
    if (weld)
        for (uint32_t u = 0; u < v; u++)
            if (mesh.p[3 * u] == mesh.p[3 * v] && mesh.p[3 * u + 1] == mesh.p[3 * v + 1] &&
                mesh.p[3 * u + 2] == mesh.p[3 * v + 2])
                return u;
    return v;
}

static void oracle_edges(bvx_certificate *c)
{
    for (size_t t = 0; t < kept_count; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t const a = kept[t][k], b = kept[t][(k + 1) % 3];
            uint64_t const n = sides_of_edge(a, b);
            uint64_t forward = 0, backward = 0;
            int first = 1;
            for (size_t s = 0; s < t; s++) first &= !has_edge(s, a, b);
            for (size_t s = 0; s < kept_count; s++) {
                forward += (uint64_t)runs_along(s, a, b);
                backward += (uint64_t)runs_along(s, b, a);
            }
            if (forward > 1 || backward > 1) c->oriented = 0;
            if (!first) continue;
            c->edges++;
            c->boundary_edges += n == 1;
            c->nonmanifold_edges += n > 2;
            c->flipped_edges += n == 2 && (forward == 2 || backward == 2);
        }
}

static void oracle_vertices(bvx_certificate *c, int weld)
{
    for (uint32_t v = 0; v < mesh.vertices; v++) {
        int used = 0, fan = 1;
        if (least_equal(v, weld) != v) continue;
        for (size_t t = 0; t < kept_count; t++) {
            if (!has_vertex(t, v)) continue;
            used = 1;
            for (int k = 0; k < 3; k++)
                if (kept[t][k] != v) fan &= sides_of_edge(v, kept[t][k]) <= 2;
        }
        c->vertices += (uint64_t)used;
        c->unused_vertices += (uint64_t)!used;
        c->nonmanifold_vertices += used && (!fan || count_pieces(v) != 1);
    }
}

static void oracle_measures(bvx_certificate *c)
{
    for (size_t t = 0; t < kept_count; t++) {
        const double *const p = &mesh.p[3 * kept[t][0]], *const q = &mesh.p[3 * kept[t][1]],
                            *const r = &mesh.p[3 * kept[t][2]];
        double const u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]};
        double const v[3] = {r[0] - p[0], r[1] - p[1], r[2] - p[2]};
        double const n[3] = {u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]};
        double const twice = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        c->degenerate += twice == 0.0;
        c->area += twice / 2;
        for (int a = 0; a < 3; a++)
            for (int k = 0; k < 3; k++) {
                double const x = mesh.p[3 * kept[t][k] + (uint32_t)a];
                if ((t == 0 && k == 0) || x < c->box.low[a]) c->box.low[a] = x;
                if ((t == 0 && k == 0) || x > c->box.high[a]) c->box.high[a] = x;
            }
    }
    for (size_t t = 0; t < kept_count; t++) { /* determinant about the centre */
        double p[3][3];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++)
                p[k][a] = mesh.p[3 * kept[t][k] + (uint32_t)a] - (c->box.low[a] + c->box.high[a]) / 2;
        c->volume += (p[0][0] * (p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                      p[0][1] * (p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                      p[0][2] * (p[1][0] * p[2][1] - p[1][1] * p[2][0])) /
                     6;
    }
}

static bvx_certificate oracle(int weld)
{
    bvx_certificate c;

    memset(&c, 0, sizeof c);
    kept_count = 0;
    TEST_ASSERT_TRUE(mesh.triangles <= ORACLE_TRIANGLES);
    for (size_t t = 0; t < mesh.triangles; t++) {
        uint32_t *const k = kept[kept_count];
        for (int i = 0; i < 3; i++) k[i] = least_equal(mesh.t[3 * t + (size_t)i], weld);
        if (k[0] == k[1] || k[1] == k[2] || k[2] == k[0]) c.collapsed++;
        else kept_count++;
    }
    c.triangles = kept_count;
    for (size_t t = 0; t < kept_count; t++) {
        int earlier = 0;
        for (size_t s = 0; s < t; s++)
            earlier |= has_edge(s, kept[t][0], kept[t][1]) && has_vertex(s, kept[t][2]);
        c.duplicates += (uint64_t)earlier;
    }
    c.oriented = kept_count != 0;
    oracle_edges(&c);
    oracle_vertices(&c, weld);
    oracle_measures(&c);
    c.components = count_pieces(UINT32_MAX);
    c.closed = kept_count != 0 && c.boundary_edges == 0;
    c.edge_manifold = kept_count != 0 && c.nonmanifold_edges == 0;
    c.vertex_manifold = kept_count != 0 && c.nonmanifold_vertices == 0;
    c.euler = (int64_t)c.vertices - (int64_t)c.edges + (int64_t)c.triangles;
    return c;
}

static void expect_oracle(int32_t weld)
{
    bvx_certificate const want = oracle(weld), got = check(weld);

    TEST_ASSERT_EQUAL_UINT64(want.triangles, got.triangles);
    TEST_ASSERT_EQUAL_UINT64(want.collapsed, got.collapsed);
    TEST_ASSERT_EQUAL_UINT64(want.degenerate, got.degenerate);
    TEST_ASSERT_EQUAL_UINT64(want.duplicates, got.duplicates);
    TEST_ASSERT_EQUAL_UINT64(want.vertices, got.vertices);
    TEST_ASSERT_EQUAL_UINT64(want.unused_vertices, got.unused_vertices);
    TEST_ASSERT_EQUAL_UINT64(want.edges, got.edges);
    TEST_ASSERT_EQUAL_UINT64(want.boundary_edges, got.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(want.nonmanifold_edges, got.nonmanifold_edges);
    TEST_ASSERT_EQUAL_UINT64(want.flipped_edges, got.flipped_edges);
    TEST_ASSERT_EQUAL_UINT64(want.nonmanifold_vertices, got.nonmanifold_vertices);
    TEST_ASSERT_EQUAL_UINT64(want.components, got.components);
    TEST_ASSERT_EQUAL_INT64(want.euler, got.euler);
    TEST_ASSERT_EQUAL_INT32(want.closed, got.closed);
    TEST_ASSERT_EQUAL_INT32(want.edge_manifold, got.edge_manifold);
    TEST_ASSERT_EQUAL_INT32(want.vertex_manifold, got.vertex_manifold);
    TEST_ASSERT_EQUAL_INT32(want.oriented, got.oriented);
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_TRUE(want.box.low[a] == got.box.low[a]);
        TEST_ASSERT_TRUE(want.box.high[a] == got.box.high[a]);
    }
    TEST_ASSERT_TRUE(fabs(want.area - got.area) <= 1e-12 * want.area);
    TEST_ASSERT_TRUE(fabs(want.volume - got.volume) <= 1e-12 * want.area * 10);
    for (int i = 0; i < 4; i++) TEST_ASSERT_EQUAL_UINT64(0, got.reserved[i]);
}

/* Few vertices and many triangles: every kind of bad edge and vertex turns up. */
static void test_random_soups_equal_the_oracle(void)
{
    for (int round = 0; round < 400; round++) {
        int32_t const vertices = 3 + maker_below(&seed, 12), triangles = 1 + maker_below(&seed, 30);
        int32_t const sides = 1 + maker_below(&seed, 4);
        maker_clear(&mesh);
        for (int32_t v = 0; v < vertices; v++) {
            double p[3];
            for (int a = 0; a < 3; a++) {
                p[a] = (double)(maker_below(&seed, 2 * sides + 1) - sides);
                if (p[a] == 0.0 && maker_below(&seed, 2)) p[a] = -0.0;
            }
            maker_vertex(&mesh, p[0], p[1], p[2]);
        }
        for (int32_t t = 0; t < triangles; t++) {
            uint32_t c[3];
            for (int k = 0; k < 3; k++) c[k] = (uint32_t)maker_below(&seed, vertices);
            maker_triangle(&mesh, c[0], c[1], c[2]);
        }
        expect_oracle(0);
        expect_oracle(1);
    }
}

/* Closed solids made of cubes, whole and spoiled: turned, doubled and missing triangles, unshared corners. */
static void test_spoiled_solids_equal_the_oracle(void)
{
    for (int round = 0; round < 40; round++) {
        int32_t const n[3] = {2, 2, 2};
        double const at[3] = {-1.0, 0.0, 5.0};
        uint8_t solid[8];
        for (int i = 0; i < 8; i++) solid[i] = (uint8_t)(maker_below(&seed, 3) != 0);
        maker_clear(&mesh);
        maker_cubes(&mesh, &seed, solid, n, at);
        if (mesh.triangles == 0) continue;
        maker_shuffle_vertices(&mesh, &seed);
        maker_shuffle_triangles(&mesh, &seed);
        expect_oracle(0);
        if (round % 2 == 0) maker_flip(&mesh, 0, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        for (int k = maker_below(&seed, 4); k > 0; k--)
            maker_duplicate(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        for (int k = maker_below(&seed, 3); k > 0; k--)
            maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        maker_vertex(&mesh, 9.0, 9.0, 9.0); /* used by nothing */
        expect_oracle(0);
        expect_oracle(1);
    }
}

/* ---- Known shapes ---- */

static void make_cube(double x, double side)
{
    double const low[3] = {x, x, x}, high[3] = {x + side, x + side, x + side};
    maker_box(&mesh, low, high);
}

static void expect_flags(const bvx_certificate *c, int closed, int edge_manifold, int vertex_manifold,
                         int oriented)
{
    TEST_ASSERT_EQUAL_INT32(closed, c->closed);
    TEST_ASSERT_EQUAL_INT32(edge_manifold, c->edge_manifold);
    TEST_ASSERT_EQUAL_INT32(vertex_manifold, c->vertex_manifold);
    TEST_ASSERT_EQUAL_INT32(oriented, c->oriented);
}

static void test_a_cube(void)
{
    bvx_certificate c;

    make_cube(3.0, 1.0);
    c = check(0);
    expect_flags(&c, 1, 1, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(8, c.vertices);
    TEST_ASSERT_EQUAL_UINT64(18, c.edges);
    TEST_ASSERT_EQUAL_UINT64(12, c.triangles);
    TEST_ASSERT_EQUAL_INT64(2, c.euler);
    TEST_ASSERT_EQUAL_UINT64(1, c.components);
    TEST_ASSERT_TRUE(c.volume == 1.0);
    TEST_ASSERT_TRUE(c.area == 6.0);
    maker_flip(&mesh, 0, 12);
    c = check(0);
    expect_flags(&c, 1, 1, 1, 1);
    TEST_ASSERT_TRUE(c.volume == -1.0);
}

/* The same cube as a file without indices gives it: every corner a vertex of its own. */
static void test_a_cube_without_indices_needs_welding(void)
{
    double p[36][3];
    bvx_mesh_view v;
    bvx_certificate c;

    make_cube(0.0, 2.0);
    for (int i = 0; i < 36; i++) memcpy(p[i], &mesh.p[3 * mesh.t[i]], sizeof p[i]);
    memset(&v, 0, sizeof v);
    v.positions = p;
    v.vertex_count = 36;
    v.triangle_count = 12;
    v.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 0, &c));
    TEST_ASSERT_EQUAL_UINT64(12, c.components);
    TEST_ASSERT_EQUAL_UINT64(36, c.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(36, c.vertices);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 1, &c));
    expect_flags(&c, 1, 1, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(8, c.vertices);
    TEST_ASSERT_EQUAL_UINT64(0, c.unused_vertices);
    TEST_ASSERT_TRUE(c.volume == 8.0);
}

/* A band of n by m quads; around: the far side joins the near one; twist: upside down. */
static void make_band(uint32_t n, uint32_t m, int around_m, int twist)
{
    uint32_t const row = around_m ? m : m + 1;

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < row; j++)
            maker_vertex(&mesh, (double)i, (double)j, (double)((i * 7 + j * 3) % 5));
    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < m; j++) {
            uint32_t const j2 = (j + 1) % row, far = (i + 1) % n;
            int const turned = twist && i + 1 == n;
            uint32_t const a = i * row + j, b = i * row + j2;
            uint32_t const c = far * row + (turned ? row - 1 - j2 : j2);
            uint32_t const d = far * row + (turned ? row - 1 - j : j);
            maker_triangle(&mesh, a, d, c);
            maker_triangle(&mesh, a, c, b);
        }
}

static void test_a_torus_has_euler_number_zero(void)
{
    bvx_certificate c;
    make_band(7, 5, 1, 0);
    maker_shuffle_triangles(&mesh, &seed);
    c = check(0);
    expect_flags(&c, 1, 1, 1, 1);
    TEST_ASSERT_EQUAL_INT64(0, c.euler);
    TEST_ASSERT_EQUAL_UINT64(35, c.vertices);
}

static void test_a_ring_and_a_moebius_strip(void)
{
    bvx_certificate c;

    make_band(8, 2, 0, 0);
    c = check(0);
    expect_flags(&c, 0, 1, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(16, c.boundary_edges);
    maker_clear(&mesh);
    make_band(8, 2, 0, 1);
    c = check(0);
    expect_flags(&c, 0, 1, 1, 0);
    TEST_ASSERT_EQUAL_UINT64(16, c.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(2, c.flipped_edges);
    TEST_ASSERT_EQUAL_INT64(0, c.euler);
    TEST_ASSERT_EQUAL_UINT64(1, c.components);
}

static void make_bow_tie(int shared) /* two tetrahedra that share 1, 2 or no vertices */
{
    uint32_t const a = maker_vertex(&mesh, 0, 0, 0), b = maker_vertex(&mesh, 0, 0, 1);
    uint32_t const c = maker_vertex(&mesh, 1, 0, 0), d = maker_vertex(&mesh, 1, 1, 0);
    uint32_t const e = maker_vertex(&mesh, -1, 0, 0), f = maker_vertex(&mesh, -1, -1, 0);

    maker_tetrahedron(&mesh, a, b, c, d);
    if (shared == 2) {
        maker_tetrahedron(&mesh, a, b, e, f);
    } else {
        uint32_t const g = maker_vertex(&mesh, -1, 0, -1);
        maker_tetrahedron(&mesh, shared == 1 ? a : maker_vertex(&mesh, -2, 0, 0), e, f, g);
    }
}

static void test_parts_that_touch_in_a_vertex_or_an_edge(void)
{
    bvx_certificate c;

    make_bow_tie(0);
    c = check(0);
    expect_flags(&c, 1, 1, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(2, c.components);
    TEST_ASSERT_EQUAL_INT64(4, c.euler);
    maker_clear(&mesh);
    make_bow_tie(1);
    c = check(0);
    expect_flags(&c, 1, 1, 0, 1);
    TEST_ASSERT_EQUAL_UINT64(2, c.components);
    TEST_ASSERT_EQUAL_UINT64(1, c.nonmanifold_vertices);
    maker_clear(&mesh);
    make_bow_tie(2);
    c = check(0);
    expect_flags(&c, 1, 0, 0, 0);
    TEST_ASSERT_EQUAL_UINT64(1, c.components);
    TEST_ASSERT_EQUAL_UINT64(1, c.nonmanifold_edges);
    TEST_ASSERT_EQUAL_UINT64(2, c.nonmanifold_vertices);
}

/* Buckets far above what insertion sort takes: n triangles round one vertex, and n on one edge. */
static void test_large_fans(void)
{
    enum { SPOKES = 5000 };
    bvx_certificate c;
    uint32_t const hub = maker_vertex(&mesh, 0, 0, 0);
    for (int i = 0; i < SPOKES; i++) maker_vertex(&mesh, i, 1, i % 3);
    for (uint32_t i = 0; i < SPOKES; i++) maker_triangle(&mesh, hub, 1 + i, 1 + (i + 1) % SPOKES);
    maker_shuffle_triangles(&mesh, &seed);
    c = check(0);
    expect_flags(&c, 0, 1, 1, 1);
    TEST_ASSERT_EQUAL_UINT64(SPOKES, c.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(2 * SPOKES, c.edges);
    TEST_ASSERT_EQUAL_INT64(1, c.euler);
    maker_clear(&mesh);
    maker_vertex(&mesh, 0, 0, 0);
    maker_vertex(&mesh, 0, 0, 1);
    for (int i = 0; i < SPOKES; i++) maker_vertex(&mesh, i, 1, 0);
    for (uint32_t i = 0; i < SPOKES; i++) maker_triangle(&mesh, 0, 1, 2 + i);
    for (uint32_t i = 0; i < SPOKES; i += 5) maker_triangle(&mesh, 1, 0, 2 + i);
    maker_shuffle_triangles(&mesh, &seed);
    c = check(0);
    expect_flags(&c, 0, 0, 0, 0);
    TEST_ASSERT_EQUAL_UINT64(1, c.nonmanifold_edges);
    TEST_ASSERT_EQUAL_UINT64(1, c.components);
    TEST_ASSERT_EQUAL_UINT64(SPOKES / 5, c.duplicates);
    TEST_ASSERT_EQUAL_UINT64(2 * (SPOKES - SPOKES / 5), c.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(2, c.nonmanifold_vertices);
}

/* Area and volume stay numbers where squares of coordinates would overflow or vanish. */
static void test_sizes_at_the_ends_of_doubles(void)
{
    static const int exponents[6] = {300, -300, 330, -330, 500, -357};

    for (int i = 0; i < 6; i++) {
        double const side = ldexp(1.0, exponents[i]);
        bvx_certificate c;
        maker_clear(&mesh);
        make_cube(0.0, side);
        c = check(1);
        expect_flags(&c, 1, 1, 1, 1);
        TEST_ASSERT_EQUAL_UINT64(0, c.degenerate);
        TEST_ASSERT_TRUE(c.area == 6.0 * side * side);
        TEST_ASSERT_TRUE(c.volume == side * side * side);
        TEST_ASSERT_TRUE(c.box.high[0] == side);
    }
}

static void test_bounds_and_volume_leave_out_what_is_collapsed(void)
{
    bvx_certificate c;
    uint32_t far;

    make_cube(1.0, 1.0);
    far = maker_vertex(&mesh, 1e6, -1e6, 0.1);
    maker_triangle(&mesh, far, far, 0);
    c = check(0);
    TEST_ASSERT_EQUAL_UINT64(1, c.collapsed);
    TEST_ASSERT_EQUAL_UINT64(1, c.unused_vertices);
    TEST_ASSERT_TRUE(c.box.high[0] == 2.0 && c.box.low[1] == 1.0);
    TEST_ASSERT_TRUE(c.volume == 1.0);
    expect_flags(&c, 1, 1, 1, 1);
}

/* ---- Views, refusals, failures ---- */

static void test_all_types_and_strides_give_one_certificate(void)
{
    unsigned char positions[2000], indices[5000];
    bvx_certificate want;
    double const centre[3] = {0, 0, 0}, radius[3] = {5, 6, 7};

    maker_star(&mesh, &seed, centre, radius, 0.5, 5, 6, 4);
    maker_remove(&mesh, 3);
    maker_flip(&mesh, 0, 2);
    want = check(1);
    for (uint32_t p = BVX_F32; p <= BVX_F64; p++)
        for (uint32_t t = BVX_U16; t <= BVX_U64; t++)
            for (uint32_t extra = 0; extra < 6; extra += 5) {
                size_t const ps = 12 * p + extra, own = (size_t)6 << (t - 1), is = own + extra;
                bvx_mesh_view v = maker_view(&mesh);
                bvx_certificate got;
                for (size_t i = 0; i < 3 * mesh.vertices; i++) {
                    float const f = (float)mesh.p[i];
                    memcpy(positions + extra + i / 3 * ps + i % 3 * 4 * p,
                           p == BVX_F32 ? (const void *)&f : (const void *)&mesh.p[i], 4 * p);
                }
                for (size_t i = 0; i < 3 * mesh.triangles; i++) {
                    uint16_t const s = (uint16_t)mesh.t[i];
                    uint64_t const w = mesh.t[i];
                    const void *const from = t == BVX_U16 ? (const void *)&s : (const void *)&w;
                    memcpy(indices + extra + i / 3 * is + i % 3 * (own / 3), t == BVX_U32 ? &mesh.t[i] : from,
                           own / 3);
                }
                v.positions = positions + extra;
                v.indices = indices + extra;
                v.position_type = p;
                v.index_type = t;
                v.position_stride = extra != 0 ? (uint32_t)ps : 0;
                v.index_stride = extra != 0 ? (uint32_t)is : 0;
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 1, &got));
                TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
            }
}

static void test_without_triangles_only_unused_vertices_are_counted(void)
{
    bvx_certificate c, zero;

    memset(&zero, 0, sizeof zero);
    c = check(0);
    TEST_ASSERT_EQUAL_MEMORY(&zero, &c, sizeof c);
    maker_vertex(&mesh, 1, 2, 3);
    c = check(1);
    zero.unused_vertices = 1;
    TEST_ASSERT_EQUAL_MEMORY(&zero, &c, sizeof c);
    maker_triangle(&mesh, 0, 0, 0);
    c = check(1);
    zero.collapsed = 1;
    TEST_ASSERT_EQUAL_MEMORY(&zero, &c, sizeof c);
}

static void refuse(const bvx_mesh_view *v, int32_t weld, bvx_status status, const char *word)
{
    bvx_certificate c, zero;
    memset(&zero, 0, sizeof zero);
    memset(&c, 0xff, sizeof c);
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_check(ctx, v, weld, &c));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), word));
    TEST_ASSERT_EQUAL_MEMORY(&zero, &c, sizeof c);
}

static void test_check_refuses(void)
{
    bvx_mesh_view v;
    bvx_certificate c;

    make_cube(0.0, 1.0);
    v = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_check(NULL, &v, 0, &c));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_check(ctx, &v, 0, NULL));
    refuse(NULL, 0, BVX_ERR_ARGUMENT, "mesh is NULL");
    refuse(&v, 2, BVX_ERR_ARGUMENT, "weld is 2");
    refuse(&v, -1, BVX_ERR_ARGUMENT, "weld is -1");
    v.index_type = 7;
    refuse(&v, 0, BVX_ERR_ARGUMENT, "index_type");
    v = maker_view(&mesh);
    v.triangle_count = UINT32_MAX / 3 + 1;
    refuse(&v, 0, BVX_ERR_RANGE, "triangle_count");
    v = maker_view(&mesh);
    v.vertex_count = 7;
    refuse(&v, 0, BVX_ERR_RANGE, "vertex index 7");
    v = maker_view(&mesh);
    mesh.p[3 * 5 + 1] = NAN;
    refuse(&v, 0, BVX_ERR_RANGE, "vertex 5 has y");
    refuse(&v, 1, BVX_ERR_RANGE, "vertex 5 has y");
}

static bvx_status check_some(void *user, bvx_context *context)
{
    bvx_mesh_view const v = maker_view(&mesh);
    bvx_certificate c;
    (void)user;
    return bvx_mesh_check(context, &v, 1, &c);
}

enum { MANY_WORKERS = 5 };

/* Tasks from the last to the first, each by another worker than the one before. */
static void in_turns(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    (void)user;
    for (int32_t i = count - 1; i >= 0; i--) task(task_user, i, i % MANY_WORKERS);
}

/* Two balls of more vertices than a task takes, in any numbering; then one vertex for two of them, a hole, a
 * flipped triangle, an edge of three: what is known of them, whoever does which task. */
static void test_large_meshes_by_many_workers(void)
{
    double const centre[2][3] = {{0, 0, 0}, {30, 0, 0}}, radius[3] = {9, 9, 9};
    bvx_context_options plain = suite_options(MANY_WORKERS, BVX_CPU_BEST), o;
    bvx_context *turns = NULL;

    plain.parallel.call = in_turns;
    o = fault_options(&plain, &suite_heap);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &turns));
    for (int trial = 0; trial < 6; trial++) {
        uint64_t vertices, half;
        uint32_t pinch = 0;
        bvx_certificate c, other;
        bvx_mesh_view v;

        maker_clear(&mesh);
        for (int i = 0; i < 2; i++) maker_star(&mesh, &seed, centre[i], radius, 0.2, 120, 130, 65536);
        vertices = mesh.vertices;
        half = vertices / 2;
        TEST_ASSERT_TRUE(vertices > 3 * 8192);
        if (trial == 2 || trial == 5) { /* a vertex of the second ball is one of the first */
            for (size_t i = 0; i < 3 * mesh.triangles; i++)
                if (mesh.t[i] == half + 1000) mesh.t[i] = 1000;
            pinch = 1;
        }
        if (trial == 3) maker_flip(&mesh, 5000, 5001);
        if (trial == 4) mesh.triangles--;
        if (trial == 5) maker_triangle(&mesh, mesh.t[0], mesh.t[1], (uint32_t)half + 5);
        if (trial != 0) {
            maker_shuffle_triangles(&mesh, &seed);
            maker_shuffle_vertices(&mesh, &seed);
        }
        c = check(0);
        v = maker_view(&mesh);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(turns, &v, 0, &other));
        TEST_ASSERT_EQUAL_MEMORY(&c, &other, sizeof c);

        TEST_ASSERT_EQUAL_UINT64(vertices - pinch, c.vertices);
        TEST_ASSERT_EQUAL_UINT64(pinch, c.unused_vertices);
        TEST_ASSERT_EQUAL_UINT64(2, c.components);
        TEST_ASSERT_EQUAL_UINT64(trial == 3 ? 3 : 0, c.flipped_edges);
        TEST_ASSERT_EQUAL_UINT64(trial == 4 ? 3 : trial == 5 ? 2 : 0, c.boundary_edges);
        TEST_ASSERT_EQUAL_UINT64(trial == 5, c.nonmanifold_edges);
        /* of the fin: both ends of its edge, and the vertex of the other ball that it ends at */
        TEST_ASSERT_EQUAL_UINT64(trial == 5 ? pinch + 3 : pinch, c.nonmanifold_vertices);
        TEST_ASSERT_EQUAL_INT32(trial < 3 || trial == 4, c.oriented);
    }
    bvx_context_destroy(turns);
}

/* The memory that the header gives, of meshes with half a vertex a triangle, three, and fourteen; also with an
 * edge of three triangles. */
static void test_memory_is_what_the_header_says(void)
{
    double const centre[3] = {0, 0, 0}, radius[3] = {9, 9, 9};

    for (int shape = 0; shape < 4; shape++) {
        maker_clear(&mesh);
        maker_star(&mesh, &seed, centre, radius, 0.2, 60, 60, 65536);
        for (size_t i = 0; i < 3 * mesh.triangles && shape > 0; i++) {
            const double *const p = mesh.p + 3 * (size_t)mesh.t[i];
            mesh.t[i] = maker_vertex(&mesh, p[0], p[1], p[2]); /* each its own */
        }
        for (size_t i = 0; i < 10 * mesh.triangles && shape == 2; i++) maker_vertex(&mesh, (double)i, 0, 0);
        if (shape == 3) maker_triangle(&mesh, mesh.t[0], mesh.t[1], mesh.t[9]);
        for (int32_t weld = 0; weld < 2; weld++) {
            uint64_t const formula = 53 * mesh.triangles + 10 * mesh.vertices + 8192;
            uint64_t const used = bvx_memory_used(ctx);

            bvx_memory_reset_peak(ctx);
            check(weld);
            TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - used <= formula);
        }
    }
}

static void test_every_allocation_may_fail(void)
{
    uint64_t allocations = 0;
    make_cube(0.0, 1.0);
    TEST_ASSERT_NULL(fault_every_allocation(check_some, NULL, NULL, &allocations));
    TEST_ASSERT_EQUAL_UINT64(9, allocations);
}

/* An arena holds the check, and is whole again behind it; a smaller one is reported so. */
static void test_check_runs_in_an_arena(void)
{
    enum { SIZE = 1 << 16 };
    static unsigned char memory[SIZE];
    bvx_context_options o;
    bvx_context *small;
    bvx_mesh_view v;
    bvx_certificate want, got;
    double const centre[3] = {0, 0, 0}, radius[3] = {5, 5, 5};
    maker_star(&mesh, &seed, centre, radius, 0.0, 10, 10, 64);
    v = maker_view(&mesh);
    want = check(1);
    for (uint64_t size = 1024; size <= SIZE; size += 1 + size / 7) {
        bvx_status status;
        o = (bvx_context_options){.struct_size = sizeof o};
        o.arena.memory = memory;
        o.arena.size = size;
        if (bvx_context_create(&o, &small) != BVX_OK) continue;
        status = bvx_mesh_check(small, &v, 1, &got);
        TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_MEMORY);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(small));
        if (status == BVX_OK) TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
        if (size > SIZE / 2) TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
        bvx_context_destroy(small);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_random_soups_equal_the_oracle);
    RUN_TEST(test_spoiled_solids_equal_the_oracle);
    RUN_TEST(test_a_cube);
    RUN_TEST(test_a_cube_without_indices_needs_welding);
    RUN_TEST(test_a_torus_has_euler_number_zero);
    RUN_TEST(test_a_ring_and_a_moebius_strip);
    RUN_TEST(test_parts_that_touch_in_a_vertex_or_an_edge);
    RUN_TEST(test_large_fans);
    RUN_TEST(test_sizes_at_the_ends_of_doubles);
    RUN_TEST(test_bounds_and_volume_leave_out_what_is_collapsed);
    RUN_TEST(test_all_types_and_strides_give_one_certificate);
    RUN_TEST(test_without_triangles_only_unused_vertices_are_counted);
    RUN_TEST(test_check_refuses);
    RUN_TEST(test_large_meshes_by_many_workers);
    RUN_TEST(test_memory_is_what_the_header_says);
    RUN_TEST(test_every_allocation_may_fail);
    RUN_TEST(test_check_runs_in_an_arena);
    return UNITY_END();
}
