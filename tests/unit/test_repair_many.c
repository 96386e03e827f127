/* test_repair_many.c - many meshes of a dozen kinds with known volumes, sound and spoilt: what the repair
 * gives has the volume and the parts, and the solid that auto fills has the volume and the voxels of the mesh
 * before it was spoilt. BITVOX_LARGE=1: 300 meshes on 128 voxels. */
#include "solid_support.h"

#include <math.h>

/* What a mesh should become. */
typedef struct body {
    double volume, repaired; /* of the solid that auto fills, and of what the repair gives */
    uint64_t parts;          /* of that */
    int32_t fill;            /* the rule that is right for the mesh before it is spoilt */
    int thin;                /* walls below 1.5 voxels: a solid of voxels cannot hold them */
} body;

/* ---- Kinds of bodies ---- */

static double between(double low, double high)
{
    return maker_between(&seed, low, high, 1024);
}

static double volume_of_mesh(void)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_certificate c;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
    return c.volume;
}

static void add_box(double x, double y, double z, double dx, double dy, double dz)
{
    double const low[3] = {x, y, z}, high[3] = {x + dx, y + dy, z + dz};

    maker_box(&mesh, low, high);
}

static void add_star(double jitter, double size)
{
    double const centre[3] = {between(-1, 1), between(-1, 1), between(-1, 1)};
    double const radius[3] = {size, size * between(0.5, 1), size};

    maker_star(&mesh, &seed, centre, radius, jitter, 12 + maker_below(&seed, 12), 12 + maker_below(&seed, 24),
               65536);
}

/* Outline of three or more corners, counter-clockwise, from z = 0 to high. */
static void add_column(const double (*outline)[2], uint32_t n, double high)
{
    uint32_t const first = (uint32_t)mesh.vertices;

    for (uint32_t k = 0; k < 2; k++)
        for (uint32_t i = 0; i < n; i++) maker_vertex(&mesh, outline[i][0], outline[i][1], k == 0 ? 0 : high);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t const j = (i + 1) % n;

        maker_quad(&mesh, first + i, first + j, first + n + j, first + n + i, 0);
        if (i == 0 || j == 0) continue;
        maker_triangle(&mesh, first, first + j, first + i);
        maker_triangle(&mesh, first + n, first + n + i, first + n + j);
    }
}

/* An edge of 6 to 60 degrees. */
static void add_wedge(void)
{
    double const half = between(0.4, 4.5);
    double const outline[3][2] = {{0, 0}, {8, -half}, {8, half}};

    add_column(outline, 3, between(3, 8));
}

/* Two boxes that overlap by a box. */
static double add_crossed_boxes(void)
{
    double const a = between(3, 6), b = between(1, 2.5), deep = between(0.5, 2);

    add_box(0, 0, 0, a, a, a);
    add_box(a - deep, 0.25, 0.25, 4, b, b);
    return a * a * a + (4 - deep) * b * b;
}

/* A bar that ends in another, like the slats of a chair: four legs through a seat. */
static double add_stool(void)
{
    double const t = between(0.3, 0.6);

    add_box(0, 0, 4, 5, 5, t);
    for (int i = 0; i < 4; i++) add_box(0.5 + 3 * (i % 2), 0.5 + 3 * (i / 2), 0, t, t, 4.125);
    return 25 * t + 4 * 4 * t * t;
}

/* A ball with a cavity, which faces inwards or, as files often have it,
 * outwards: hollow by auto, whole once repaired. */
static void add_shell(body *b, double wall, int outwards)
{
    static const double centre[3] = {0, 0, 0};
    double const outer[3] = {4, 4, 4}, inner[3] = {4 - wall, 4 - wall, 4 - wall};
    double whole;
    size_t second;

    maker_star(&mesh, &seed, centre, outer, 0, 20, 30, 65536);
    whole = volume_of_mesh();
    second = mesh.triangles;
    maker_star(&mesh, &seed, centre, inner, 0, 20, 30, 65536);
    b->volume = 2 * whole - volume_of_mesh();
    if (!outwards) maker_flip(&mesh, second, mesh.triangles);
    b->repaired = outwards ? whole : b->volume;
    b->parts = outwards ? 1 : 2;
}

static body make_body(int kind)
{
    body b = {0, 0, 1, BVX_FILL_PARITY, 0};

    maker_clear(&mesh);
    switch (kind) {
    case 0: add_star(0, between(1, 3)); break;
    case 1: add_star(0.2, between(1, 3)); break;
    case 2: add_box(0, 0, 0, between(1, 8), between(2, 8), between(1, 8)); break;
    case 3:
        add_wedge();
        b.thin = 1;
        break;
    case 4:
        add_box(0, 0, 0, between(4, 8), between(4, 8), between(0.01, 0.2));
        b.thin = 1;
        break;
    case 5:
        b.volume = add_crossed_boxes();
        b.fill = BVX_FILL_NONZERO;
        break;
    case 6:
        b.volume = add_stool();
        b.fill = BVX_FILL_NONZERO;
        break;
    case 7: add_shell(&b, between(0.25, 2), 0); break;
    case 8: add_shell(&b, between(0.75, 2), 1); break;
    case 9:
        add_shell(&b, between(0.02, 0.15), 0);
        b.thin = 1;
        break;
    default: add_star(0.1, 2); break; /* 10 and 11 are spoilt */
    }
    if (b.volume == 0) b.volume = volume_of_mesh();
    if (b.repaired == 0) b.repaired = b.volume;
    maker_turn(&mesh);
    return b;
}

enum { BODIES = 12 };

static void spoil(int kind)
{
    for (size_t t = 0, n = mesh.triangles; t < n; t++) {
        if (kind == 10 && maker_below(&seed, 20) == 0) maker_flip(&mesh, t, t + 1);
        if (kind == 11 && maker_below(&seed, 5) == 0) maker_duplicate(&mesh, t);
    }
}

/* ---- What becomes of them ---- */

static void assert_volume(const char *what, int kind, int trial, double expected, double volume, double share)
{
    char text[160];

    snprintf(text, sizeof text, "%s, kind %d, trial %d: volume %g, wanted %g", what, kind, trial, volume,
             expected);
    TEST_ASSERT_TRUE_MESSAGE(fabs(volume - expected) <= share * expected, text);
}

static void assert_repaired(const body *b, int kind, int trial, int32_t resolution)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_repair_report report;
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_mesh out = {0};

    o.fit.resolution = resolution;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_repair(ctx, &view, &o, &out), bvx_last_message(ctx));
    bvx_mesh_free(ctx, &out);

    TEST_ASSERT_TRUE(report.after.closed && report.after.edge_manifold && report.after.vertex_manifold &&
                     report.after.oriented);
    TEST_ASSERT_TRUE(report.thin_voxels == 0 || report.thin_kept);
    TEST_ASSERT_EQUAL_UINT64(b->parts, report.after.components);
    assert_volume("repair", kind, trial, b->repaired, report.after.volume, b->thin ? 0.02 : 0.01);
}

static bvx_grid solid_by_fill(int32_t resolution, int32_t fill, bvx_lattice *l)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_grid g = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, resolution, l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_with(ctx, &view, l, NULL, fill, &g, NULL));
    return g;
}

/* Auto sets the voxels that the right rule sets for the mesh before it was spoilt. Thin slats are a few
 * voxels thick, whose centres may all lie to one side. */
static void assert_filled(const body *b, bvx_grid *good, int kind, int trial, int32_t resolution)
{
    bvx_lattice l;
    bvx_grid g = solid_by_fill(resolution, BVX_FILL_AUTO, &l);
    char text[64];

    snprintf(text, sizeof text, "auto, kind %d, trial %d", kind, trial);
    assert_same_bits(good, &g, text);
    assert_volume("solid", kind, trial, b->volume,
                  (double)set_voxels(&g) * l.spacing[0] * l.spacing[1] * l.spacing[2],
                  kind == 6 ? 0.03 : 0.01);
    bvx_grid_free(ctx, &g);
}

/* Whatever the voxels cannot hold is told: the volume is within 1 % of the body's, or the report has walls that
 * were lost or the resolution that is within it. Returns 1 where it was off and told. */
static int assert_told(const body *b, int kind, int trial, int32_t resolution)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_solid_report report;
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_lattice l;
    bvx_grid g = {0};
    double off;
    char text[160];

    o.fill = BVX_FILL_AUTO;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, resolution, &l));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_voxelize_solid(ctx, &view, &l, &o, &g),
                                    bvx_last_message(ctx));
    bvx_grid_free(ctx, &g);

    off = fabs(report.volume - b->volume) / b->volume;
    snprintf(text, sizeof text, "kind %d, trial %d: volume %g, wanted %g, and nothing told", kind, trial,
             report.volume, b->volume);
    TEST_ASSERT_TRUE_MESSAGE(off <= 0.01 || report.volume_resolution != 0 || report.thin_voxels != 0, text);
    return off > 0.01;
}

static void test_many_bodies(void)
{
    int const large = getenv("BITVOX_LARGE") != NULL;
    int const trials = large ? 300 / BODIES : quick ? 1 : 4;
    int32_t const resolution = large ? 128 : 96;
    int off = 0;

    for (int trial = 0; trial < trials; trial++)
        for (int kind = 0; kind < BODIES; kind++) {
            body const b = make_body(kind);
            bvx_lattice l;
            bvx_grid good = solid_by_fill(resolution, b.fill, &l);

            spoil(kind);
            assert_repaired(&b, kind, trial, resolution);
            off += assert_told(&b, kind, trial, resolution);
            if (!b.thin) assert_filled(&b, &good, kind, trial, resolution);
            bvx_grid_free(ctx, &good);
        }
    /* Thin bodies are among them, or the assertion would hold for anything. */
    TEST_ASSERT_GREATER_THAN_INT(0, off);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_many_bodies);
    return UNITY_END();
}
