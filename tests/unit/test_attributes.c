/* test_attributes.c - levels with texture coordinates, normals, colours and materials: seams and hard edges stay
 * where they are, values against those that the shape has by its formula; vertices that are kept or locked, tiles
 * that join, and vertices of very many triangles. */
#include "levels_support.h"

#define TURN 6.283185307179586

/* ---- Meshes whose attributes are known ---- */

enum { MOST = 60000 };

static float normal[3 * MOST], uv[2 * MOST], uv2[2 * MOST];
static uint8_t colour[4 * MOST];
static uint32_t uv_index[3 * MOST], material[MOST];
static size_t uvs;

static uint32_t put_vertex(double x, double y, double z, double u, double v)
{
    uint32_t const i = maker_vertex(&mesh, x, y, z);

    TEST_ASSERT_TRUE(i < MOST);
    uv[2 * i] = (float)u;
    uv[2 * i + 1] = (float)v;
    uvs = i + 1;
    return i;
}

static void put_normal(uint32_t i, double x, double y, double z)
{
    normal[3 * i] = (float)x;
    normal[3 * i + 1] = (float)y;
    normal[3 * i + 2] = (float)z;
}

/* A rectangle of vertices in rows: two triangles between four. */
static void put_rows(uint32_t first, uint32_t rows, uint32_t columns, uint32_t of)
{
    for (uint32_t r = 0; r + 1 < rows; r++)
        for (uint32_t c = 0; c + 1 < columns; c++) {
            uint32_t const a = first + r * columns + c;

            for (int i = 0; i < 2; i++) material[mesh.triangles + (size_t)i] = of;
            maker_triangle(&mesh, a, a + 1, a + columns + 1);
            maker_triangle(&mesh, a, a + columns + 1, a + columns);
        }
}

/* Radius 2, from z = 5 to 11; u runs around, with a seam, v up. Caps have normals and texture coordinates of their
 * own. Two materials, below z = 8 and above. */
enum { AROUND = 96, UP = 60, CAP_RINGS = 12 };

static void make_cylinder(void)
{
    maker_clear(&mesh);
    for (int r = 0; r <= UP; r++)
        for (int s = 0; s <= AROUND; s++) {
            double const a = TURN * (s % AROUND) / AROUND, z = 5 + 6.0 * r / UP;
            uint32_t const i = put_vertex(8 + 2 * cos(a), 8 + 2 * sin(a), z, (double)s / AROUND,
                                          (double)r / UP);

            put_normal(i, cos(a), sin(a), 0);
        }
    put_rows(0, UP / 2 + 1, AROUND + 1, 0);
    put_rows((UP / 2) * (AROUND + 1), UP / 2 + 1, AROUND + 1, 1);
    for (int cap = 0; cap < 2; cap++) {
        double const z = cap == 0 ? 5 : 11;
        uint32_t const middle = put_vertex(8, 8, z, 0.5, 0.5);
        uint32_t const first = middle + 1;

        put_normal(middle, 0, 0, cap == 0 ? -1 : 1);
        for (int r = 1; r <= CAP_RINGS; r++)
            for (int s = 0; s < AROUND; s++) {
                double const a = TURN * s / AROUND, d = (double)r / CAP_RINGS;
                uint32_t const i = put_vertex(8 + 2 * d * cos(a), 8 + 2 * d * sin(a), z,
                                              0.5 + 0.5 * d * cos(a), 0.5 + 0.5 * d * sin(a));

                /* The rim is where the sides have it, bit for bit. */
                if (r == CAP_RINGS)
                    memcpy(mesh.p + 3 * i, mesh.p + 3 * ((size_t)(cap * UP * (AROUND + 1)) + (size_t)s), 24);
                put_normal(i, 0, 0, cap == 0 ? -1 : 1);
            }
        for (uint32_t s = 0; s < AROUND; s++) {
            uint32_t const t = (s + 1) % AROUND;
            uint32_t const from = (uint32_t)mesh.triangles;

            maker_triangle(&mesh, middle, first + (cap == 0 ? t : s), first + (cap == 0 ? s : t));
            for (uint32_t r = 0; r + 1 < CAP_RINGS; r++) {
                uint32_t const a = first + r * AROUND + s, b = first + r * AROUND + t;

                if (cap == 0) maker_quad(&mesh, a, b, b + AROUND, a + AROUND, 0);
                else maker_quad(&mesh, a, a + AROUND, b + AROUND, b, 0);
            }
            for (size_t i = from; i < mesh.triangles; i++) material[i] = (uint32_t)cap;
        }
    }
    TEST_ASSERT_TRUE(mesh.vertices < MOST && mesh.triangles < MOST);
}

/* A tube of 1.25 around a circle of 4; both coordinates of the texture run around, with a seam each. */
enum { TORUS_AROUND = 96, TORUS_TUBE = 48 };

static void torus_at(int s, int r, double p[3])
{
    double const a = TURN * (s % TORUS_AROUND) / TORUS_AROUND, b = TURN * (r % TORUS_TUBE) / TORUS_TUBE;

    p[0] = 8 + (4 + 1.25 * cos(b)) * cos(a);
    p[1] = 8 + (4 + 1.25 * cos(b)) * sin(a);
    p[2] = 8 + 1.25 * sin(b);
}

/* own 1: texture coordinates by indices of their own, and each position once. */
static void make_torus(int own)
{
    int const columns = TORUS_AROUND + !own;

    maker_clear(&mesh);
    for (int r = 0; r < TORUS_TUBE + !own; r++)
        for (int s = 0; s < columns; s++) {
            double p[3];

            torus_at(s, r, p);
            put_vertex(p[0], p[1], p[2], (double)s / TORUS_AROUND, (double)r / TORUS_TUBE);
        }
    for (int r = 0; r < TORUS_TUBE; r++)
        for (int s = 0; s < TORUS_AROUND; s++) {
            uint32_t corner[4], texture[4];

            for (int k = 0; k < 4; k++) {
                int const i = s + (k == 1 || k == 2), j = r + (k >= 2);

                corner[k] = own ? (uint32_t)(j % TORUS_TUBE * columns + i % TORUS_AROUND)
                                : (uint32_t)(j * columns + i);
                texture[k] = (uint32_t)(j * (TORUS_AROUND + 1) + i);
            }
            for (int half = 0; half < 2; half++) {
                static const int of[2][3] = {{0, 1, 2}, {0, 2, 3}};

                for (size_t k = 0; k < 3; k++) uv_index[3 * mesh.triangles + k] = texture[of[half][k]];
                material[mesh.triangles] = s >= TORUS_AROUND / 2;
                maker_triangle(&mesh, corner[of[half][0]], corner[of[half][1]], corner[of[half][2]]);
            }
        }
    for (int r = 0; r <= TORUS_TUBE && own; r++)
        for (int s = 0; s <= TORUS_AROUND; s++) {
            size_t const i = (size_t)(r * (TORUS_AROUND + 1) + s);

            uv[2 * i] = (float)((double)s / TORUS_AROUND);
            uv[2 * i + 1] = (float)((double)r / TORUS_TUBE);
            uvs = i + 1;
        }
}

/* Views of what was made last. */
static bvx_mesh_view view_with(int own)
{
    bvx_mesh_view view = maker_view(&mesh);

    view.uvs = uv;
    view.materials = material;
    if (!own) return view;
    view.uv_indices = uv_index;
    view.uv_count = uvs;
    return view;
}

static bvx_simplify_options options_for(const uint64_t *target)
{
    bvx_simplify_options o = {.struct_size = sizeof o};

    o.targets.triangles = target;
    o.reports = report;
    return o;
}

static void simplify(const bvx_mesh_view *view, const bvx_simplify_options *o, uint64_t count)
{
    drop_levels();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, view, o, count, level),
                                    bvx_last_message(ctx));
}

/* ---- Corners of levels ---- */

static void position_at(const bvx_mesh *m, uint64_t corner, double p[3])
{
    for (uint64_t a = 0; a < 3; a++) p[a] = position_of(m, 3 * (uint64_t)m->triangles[corner] + a);
}

static const float *uv_at(const bvx_mesh *m, uint64_t corner)
{
    return m->uvs + 2 * (size_t)(m->uv_triangles != NULL ? m->uv_triangles[corner] : m->triangles[corner]);
}

static double edge_length(const double p[3], const double q[3])
{
    return sqrt((p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]) +
                (p[2] - q[2]) * (p[2] - q[2]));
}

static double mean_edge(const bvx_mesh *m)
{
    double sum = 0;

    for (uint64_t i = 0; i < 3 * m->triangle_count; i++) {
        double p[3], q[3];

        position_at(m, i, p);
        position_at(m, i % 3 == 2 ? i - 2 : i + 1, q);
        sum += edge_length(p, q);
    }
    return sum / (3 * (double)m->triangle_count);
}

static double area_normal(double p[3][3], double n[3])
{
    double square = 0;

    for (int a = 0; a < 3; a++) {
        int const b = (a + 1) % 3, c = (a + 2) % 3;

        n[a] = (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) - (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
        square += n[a] * n[a];
    }
    return sqrt(square);
}

/* By whole turns the least way from a to b. */
static double turn_off(double a, double b)
{
    double const way = fabs(a - b) - floor(fabs(a - b));

    return way < 0.5 ? way : 1 - way;
}

typedef void formula(const double p[3], double uv[2]);

static void cylinder_formula(const double p[3], double at[2])
{
    at[0] = atan2(p[1] - 8, p[0] - 8) / TURN;
    at[1] = (p[2] - 5) / 6;
}

static void torus_formula(const double p[3], double at[2])
{
    double const x = p[0] - 8, y = p[1] - 8;

    at[0] = atan2(y, x) / TURN;
    at[1] = atan2(p[2] - 8, sqrt(x * x + y * y) - 4) / TURN;
}

/* The mean of what texture coordinates are off, from samples all over each triangle of those that are wanted. A
 * triangle across a seam is counted. */
static double uv_error(const bvx_mesh *m, formula *wanted, int sides_only, int *across)
{
    double sum = 0, weight = 0;

    *across = 0;
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], n[3], area;

        for (uint64_t k = 0; k < 3; k++) position_at(m, 3 * t + k, p[k]);
        area = area_normal(p, n);
        if (sides_only && fabs(n[2]) > 0.7 * area) continue;
        for (uint64_t k = 0; k < 3; k++)
            for (int i = 0; i < 2; i++)
                if (fabs((double)(uv_at(m, 3 * t + k)[i] - uv_at(m, 3 * t + (k + 1) % 3)[i])) > 0.5) {
                    ++*across;
                    k = 3;
                    break;
                }
        for (int i = 0; i < 8; i++)
            for (int j = 0; i + j < 8; j++) {
                double const b[3] = {(i + 1.0 / 3) / 8, (j + 1.0 / 3) / 8, 1 - (i + j + 2.0 / 3) / 8};
                double x[3] = {0, 0, 0}, at[2] = {0, 0}, is[2];

                for (uint64_t k = 0; k < 3; k++) {
                    for (int a = 0; a < 3; a++) x[a] += b[k] * p[k][a];
                    for (int a = 0; a < 2; a++) at[a] += b[k] * (double)uv_at(m, 3 * t + k)[a];
                }
                wanted(x, is);
                sum += area * (turn_off(at[0], is[0]) + turn_off(at[1], is[1])) / 2;
                weight += area;
            }
    }
    return sum / weight;
}

/* ---- The cylinder ---- */

/* Normals of a side lie flat, those of a cap stand upright, and each triangle has those of its own kind. */
static void assert_hard_edges(const bvx_mesh *m)
{
    for (uint64_t t = 0; t < m->triangle_count; t++) {
        double p[3][3], n[3], area;
        int cap;

        for (uint64_t k = 0; k < 3; k++) position_at(m, 3 * t + k, p[k]);
        area = area_normal(p, n);
        cap = fabs(n[2]) > 0.7 * area;
        for (uint64_t k = 0; k < 3; k++) {
            const float *const is = m->normals + 3 * (size_t)m->triangles[3 * t + k];
            double const length = sqrt((double)is[0] * is[0] + (double)is[1] * is[1] + (double)is[2] * is[2]);
            double const along = (is[0] * n[0] + is[1] * n[1] + is[2] * n[2]) / area;

            TEST_ASSERT_TRUE_MESSAGE(fabs(length - 1) < 1e-5, where);
            TEST_ASSERT_TRUE_MESSAGE(cap ? fabs((double)is[2]) > 0.999 : fabs((double)is[2]) < 0.01,
                                     "averaged");
            TEST_ASSERT_TRUE_MESSAGE(along > 0.7, where);
        }
    }
}

/* Triangles of either material keep to their side. */
static void assert_materials(const bvx_mesh *m)
{
    double const most = 0.5 * mean_edge(m);
    uint64_t of[2] = {0, 0};

    for (uint64_t t = 0; t < m->triangle_count; t++) {
        TEST_ASSERT_TRUE_MESSAGE(m->materials[t] < 2, where);
        of[m->materials[t]]++;
        for (uint64_t k = 0; k < 3; k++) {
            double p[3];

            position_at(m, 3 * t + k, p);
            TEST_ASSERT_TRUE_MESSAGE(m->materials[t] == 0 ? p[2] < 8 + most : p[2] > 8 - most, where);
        }
    }
    TEST_ASSERT_TRUE_MESSAGE(of[0] > 20 && of[1] > 20, where);
}

static void test_a_cylinder_keeps_seams_normals_and_materials(void)
{
    static const uint64_t targets[3] = {6000, 800, 300};
    bvx_simplify_options o = options_for(targets);
    bvx_mesh_view view;

    make_cylinder();
    view = view_with(0);
    view.normals = normal;
    for (int type = BVX_F32; type <= BVX_F64; type++) {
        o.collapse.position_type = type;
        simplify(&view, &o, 3);
        for (int i = 0; i < 3; i++) {
            int across;
            double const off = uv_error(&level[i], cylinder_formula, 1, &across);

            snprintf(where, sizeof where, "type %d, %d triangles: off by %g, %d across", type,
                     (int)level[i].triangle_count, off, across);
            TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].crossings == 0, where);
            TEST_ASSERT_TRUE_MESSAGE(report[i].certificate.closed && report[i].certificate.vertex_manifold,
                                     where);
            TEST_ASSERT_EQUAL_INT_MESSAGE(0, across, where);
            TEST_ASSERT_TRUE_MESSAGE(off < 1 / 500.0, where);
            assert_hard_edges(&level[i]);
            assert_materials(&level[i]);
        }
    }
}

/* The same with texture coordinates by their own indices: a hard edge has two vertices, a seam one. */
static void test_own_indices_keep_hard_edges(void)
{
    static const uint64_t target = 800;
    bvx_simplify_options const o = options_for(&target);
    bvx_mesh_view view;
    int across;

    make_cylinder();
    memcpy(uv_index, mesh.t, 12 * mesh.triangles);
    for (size_t i = 0; i < 3 * mesh.triangles; i++)
        if (mesh.t[i] <= UP * (AROUND + 1) + AROUND && mesh.t[i] % (AROUND + 1) == AROUND)
            mesh.t[i] -= AROUND;
    view = view_with(1);
    view.normals = normal;
    simplify(&view, &o, 1);
    snprintf(where, sizeof where, "%d triangles", (int)level[0].triangle_count);
    TEST_ASSERT_TRUE_MESSAGE(uv_error(&level[0], cylinder_formula, 1, &across) < 1 / 500.0, where);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, across, where);
    assert_hard_edges(&level[0]);
    assert_materials(&level[0]);
    TEST_ASSERT_TRUE_MESSAGE(level[0].uv_count > level[0].vertex_count, where);
    for (uint64_t i = 0; i < 3 * level[0].triangle_count; i++)
        TEST_ASSERT_TRUE_MESSAGE(level[0].triangles[i] < level[0].vertex_count &&
                                     level[0].uv_triangles[i] < level[0].uv_count,
                                 where);
}

/* ---- The torus ---- */

static void test_a_torus_keeps_both_seams(void)
{
    static const uint64_t targets[2] = {2000, 800};
    bvx_simplify_options o = options_for(targets);

    for (int own = 0; own < 2; own++) {
        bvx_mesh_view view;

        make_torus(own);
        view = view_with(own);
        simplify(&view, &o, 2);
        for (int i = 0; i < 2; i++) {
            int across;
            double const off = uv_error(&level[i], torus_formula, 0, &across);

            snprintf(where, sizeof where, "own %d, %d triangles: off by %g, %d across", own,
                     (int)level[i].triangle_count, off, across);
            TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].certificate.closed, where);
            TEST_ASSERT_EQUAL_INT64_MESSAGE(0, report[i].certificate.euler, where);
            TEST_ASSERT_EQUAL_INT_MESSAGE(0, across, where);
            TEST_ASSERT_TRUE_MESSAGE(off < 1 / 500.0, where);
        }
    }
}

/* Each strip of quads around the tube is a chart of its own, so that all vertices lie on seams: without meeting across
 * strips 1494 triangles would remain. */
static void test_narrow_charts_meet_and_show_nothing_of_others(void)
{
    static const uint64_t targets[2] = {1500, 400};
    bvx_simplify_options o = options_for(targets);
    bvx_mesh_view view;

    make_torus(1);
    for (uint32_t t = 0; t < mesh.triangles; t++)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t const v = mesh.t[3 * t + k], strip = t / 2 % TORUS_AROUND,
                           side = v % TORUS_AROUND != strip;
            uint32_t const i = (2 * strip + side) * TORUS_TUBE + v / TORUS_AROUND;

            uv[2 * i] = (float)(2 * strip + side);
            uv[2 * i + 1] = (float)sin(TURN * (v / TORUS_AROUND) / TORUS_TUBE);
            uv_index[3 * t + k] = i;
        }
    uvs = (size_t)2 * TORUS_AROUND * TORUS_TUBE;
    view = view_with(1);
    view.materials = NULL;
    simplify(&view, &o, 2);
    for (int i = 0; i < 2; i++) {
        snprintf(where, sizeof where, "%d triangles around %g", (int)level[i].triangle_count,
                 report[i].certificate.volume);
        TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].certificate.closed, where);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(0, report[i].certificate.euler, where);
        TEST_ASSERT_TRUE_MESSAGE(report[i].certificate.volume > (i == 0 ? 0.94 : 0.86) * TURN * TURN * 3.125,
                                 where);
        for (uint64_t c = 0; c < 3 * level[i].triangle_count; c++) {
            double const u = (double)uv_at(&level[i], c)[0], first = (double)uv_at(&level[i], c / 3 * 3)[0];

            /* Of its strip: from 2 s to 2 s + 1. */
            TEST_ASSERT_TRUE_MESSAGE(fabs(u - floor(u + 0.5)) < 0.2, where);
            TEST_ASSERT_TRUE_MESSAGE(floor(u / 2 + 0.25) == floor(first / 2 + 0.25), where);
        }
    }
}

/* Texture coordinates of vertices, or of their own indices: one shape, with the same values at each corner. */
static void test_both_ways_to_store_texture_coordinates_are_one_shape(void)
{
    static const uint64_t target = 900;
    bvx_simplify_options const o = options_for(&target);
    bvx_mesh other;
    bvx_mesh_view view;

    make_torus(0);
    view = view_with(0);
    simplify(&view, &o, 1);
    other = level[0];
    memset(level, 0, sizeof level);
    make_torus(1);
    view = view_with(1);
    simplify(&view, &o, 1);
    TEST_ASSERT_EQUAL_UINT64(other.triangle_count, level[0].triangle_count);
    for (uint64_t i = 0; i < 3 * other.triangle_count; i++) {
        double p[3], q[3];

        position_at(&other, i, p);
        position_at(&level[0], i, q);
        TEST_ASSERT_EQUAL_MEMORY(p, q, sizeof p);
        TEST_ASSERT_EQUAL_MEMORY(uv_at(&other, i), uv_at(&level[0], i), 8);
    }
    TEST_ASSERT_EQUAL_MEMORY(other.materials, level[0].materials, (size_t)other.triangle_count * 4);
    bvx_mesh_free(ctx, &other);
}

/* Without a weight they cost nothing, and follow. */
static void test_a_weight_of_0_carries_attributes(void)
{
    static const uint64_t target = 800;
    bvx_simplify_options o = options_for(&target);
    bvx_mesh_view view;
    double off[2];

    make_torus(0);
    view = view_with(0);
    for (int i = 0; i < 2; i++) {
        int across;

        o.collapse.attribute_weight = i;
        simplify(&view, &o, 1);
        off[i] = uv_error(&level[0], torus_formula, 0, &across);
        snprintf(where, sizeof where, "weight %d: off by %g", i, off[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, across, where);
    }
    TEST_ASSERT_TRUE_MESSAGE(off[0] < 1 / 50.0 && off[1] <= 1.05 * off[0], where);
}

/* ---- Second coordinates and colours ---- */

static void test_second_texture_coordinates_follow(void)
{
    static const uint64_t target = 800;
    bvx_simplify_options const o = options_for(&target);
    double sum = 0;
    bvx_mesh_view view;

    make_torus(0);
    for (size_t v = 0; v < mesh.vertices; v++) {
        uv2[2 * v] = (float)(mesh.p[3 * v] / 16);
        uv2[2 * v + 1] = (float)(mesh.p[3 * v + 1] / 16 + mesh.p[3 * v + 2] / 8);
    }
    for (int both = 0; both < 2; both++) {
        view = maker_view(&mesh);
        if (both) view.uvs = uv;
        view.uvs2 = uv2;
        simplify(&view, &o, 1);
        TEST_ASSERT_TRUE((level[0].uvs != NULL) == both && level[0].uvs2 != NULL &&
                         level[0].materials == NULL);
        for (uint64_t v = 0; v < level[0].vertex_count; v++) {
            double const x = position_of(&level[0], 3 * v), y = position_of(&level[0], 3 * v + 1);
            double const z = position_of(&level[0], 3 * v + 2);

            sum += fabs((double)level[0].uvs2[2 * v] - x / 16) +
                   fabs((double)level[0].uvs2[2 * v + 1] - y / 16 - z / 8);
        }
        snprintf(where, sizeof where, "off by %g", sum / 2 / (double)level[0].vertex_count);
        TEST_ASSERT_TRUE_MESSAGE(sum / 2 < (double)level[0].vertex_count / 500.0, where);
    }
}

/* Two colours with a border between: no vertex has a mixed one, and the border stays. */
static void test_colours_keep_their_borders(void)
{
    static const uint64_t targets[2] = {2000, 800};
    static const uint8_t of[2][4] = {{220, 30, 40, 255}, {20, 120, 230, 128}};
    bvx_simplify_options const o = options_for(targets);
    bvx_mesh_view view;

    make_cylinder();
    for (size_t v = 0; v < mesh.vertices; v++) memcpy(colour + 4 * v, of[mesh.p[3 * v + 2] >= 8], 4);

    /* The middle ring is there once for each colour. */
    for (uint32_t s = 0; s <= AROUND; s++) {
        uint32_t const from = (UP / 2) * (AROUND + 1) + s;
        uint32_t const copy = put_vertex(mesh.p[3 * from], mesh.p[3 * from + 1], 8, 0, 0);

        memcpy(colour + 4 * copy, of[0], 4);
        for (size_t i = 0; i < 3 * mesh.triangles; i++)
            if (mesh.t[i] == from && material[i / 3] == 0) mesh.t[i] = copy;
    }
    view = maker_view(&mesh);
    view.colours = colour;
    simplify(&view, &o, 2);
    for (int i = 0; i < 2; i++) {
        double const most = 0.5 * mean_edge(&level[i]);

        snprintf(where, sizeof where, "%d triangles", (int)level[i].triangle_count);
        TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].certificate.closed, where);
        for (uint64_t v = 0; v < level[i].vertex_count; v++) {
            const uint8_t *const is = level[i].colours + 4 * v;
            double const z = position_of(&level[i], 3 * v + 2);
            int const second = memcmp(is, of[1], 4) == 0;

            TEST_ASSERT_TRUE_MESSAGE(second || memcmp(is, of[0], 4) == 0, "a mixed colour");
            TEST_ASSERT_TRUE_MESSAGE(second ? z > 8 - most : z < 8 + most, where);
        }
    }
}

/* ---- Threads and order ---- */

static void assert_same_attributes(const bvx_mesh *a, const bvx_mesh *b)
{
    assert_same_bytes(a, b);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a->uvs, b->uvs, (size_t)a->vertex_count * 8, where);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a->normals, b->normals, (size_t)a->vertex_count * 12, where);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a->materials, b->materials, (size_t)a->triangle_count * 4, where);
}

static void test_threads_and_order_do_not_matter(void)
{
    static const uint64_t targets[2] = {3000, 700};
    bvx_simplify_options o = options_for(targets);
    bvx_mesh_view view;
    bvx_mesh made[2] = {{0}};

    make_cylinder();
    view = view_with(0);
    view.normals = normal;
    simplify(&view, &o, 2);
    o.reports = NULL;
    for (int32_t threads = 2; threads <= 4; threads++) {
        bvx_context *const other = suite_context(threads, BVX_CPU_BEST);

        /* Triangles backwards, each with its material, begun at another corner. */
        for (size_t t = 0, s = mesh.triangles - 1; t < s && threads > 2; t++, s--)
            for (size_t k = 0; k < 3; k++) {
                uint32_t const swap = mesh.t[3 * t + k];

                mesh.t[3 * t + k] = mesh.t[3 * s + (k + 1) % 3];
                mesh.t[3 * s + (k + 1) % 3] = swap;
            }
        for (size_t t = 0, s = mesh.triangles - 1; t < s && threads > 2; t++, s--) {
            uint32_t const swap = material[t];

            material[t] = material[s];
            material[s] = swap;
        }
        snprintf(where, sizeof where, "%d threads", (int)threads);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(other, &view, &o, 2, made));
        for (int i = 0; i < 2; i++) {
            assert_same_attributes(&level[i], &made[i]);
            bvx_mesh_free(other, &made[i]);
        }
        bvx_context_destroy(other);
    }
}

/* ---- Vertices that are kept ---- */

static void test_kept_vertices_are_the_meshs_own(void)
{
    static const uint64_t targets[3] = {6000, 800, 200};
    bvx_simplify_options o = options_for(targets);

    o.collapse.vertices = BVX_VERTICES_KEPT;
    for (int kind = 0; kind < 4; kind++) {
        bvx_mesh_view view;

        if (kind < 2) make_cylinder();
        else make_torus(0);
        view = kind % 2 == 0 ? view_with(0) : maker_view(&mesh);
        if (kind == 0) view.normals = normal;
        simplify(&view, &o, 3);
        for (int i = 0; i < 3; i++) {
            bvx_mesh_view is;
            bvx_certificate c;

            snprintf(where, sizeof where, "kind %d, level %d: %d triangles", kind, i,
                     (int)level[i].triangle_count);
            TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].crossings == 0, where);
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(mesh.vertices, level[i].vertex_count, where);
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(mesh.p, level[i].positions, mesh.vertices * 24, where);
            for (uint64_t k = 0; k < 3 * level[i].triangle_count; k++)
                TEST_ASSERT_TRUE_MESSAGE(level[i].triangles[k] < mesh.vertices, where);
            bvx_mesh_view_of(&level[i], &is);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &is, 1, &c));
            TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented, where);
            TEST_ASSERT_EQUAL_INT64_MESSAGE(kind < 2 ? 2 : 0, c.euler, where);

            /* What is stored by vertex is right where triangles use it. */
            for (uint64_t k = 0; k < 3 * level[i].triangle_count && kind % 2 == 0; k++) {
                uint32_t const a = level[i].triangles[k], b = level[i].triangles[k % 3 == 2 ? k - 2 : k + 1];

                TEST_ASSERT_TRUE_MESSAGE(fabs((double)(uv[2 * a] - uv[2 * b])) <= 0.5 || kind == 0, where);
                if (kind == 0)
                    TEST_ASSERT_TRUE_MESSAGE((normal[3 * a + 2] == 0) == (normal[3 * b + 2] == 0), where);
            }
        }
    }
}

static void test_levels_of_kept_vertices_have_their_attributes(void)
{
    static const uint64_t target = 800;
    bvx_simplify_options o = options_for(&target);
    bvx_mesh_view view;

    make_cylinder();
    o.collapse.vertices = BVX_VERTICES_KEPT;
    for (size_t i = 0; i < 4 * mesh.vertices; i++) colour[i] = (uint8_t)maker_below(&seed, 256);
    memcpy(uv2, uv, mesh.vertices * 8);
    view = view_with(0);
    view.normals = normal;
    view.uvs2 = uv2;
    view.colours = colour;
    simplify(&view, &o, 1);
    TEST_ASSERT_EQUAL_MEMORY(normal, level[0].normals, mesh.vertices * 12);
    TEST_ASSERT_EQUAL_MEMORY(uv, level[0].uvs, mesh.vertices * 8);
    TEST_ASSERT_EQUAL_MEMORY(uv2, level[0].uvs2, mesh.vertices * 8);
    TEST_ASSERT_EQUAL_MEMORY(colour, level[0].colours, mesh.vertices * 4);
    TEST_ASSERT_NULL(level[0].uv_triangles);
    assert_materials(&level[0]);

    /* Texture coordinates by their own indices stay those of their corner. */
    make_torus(1);
    view = view_with(1);
    simplify(&view, &o, 1);
    TEST_ASSERT_EQUAL_UINT64(uvs, level[0].uv_count);
    TEST_ASSERT_EQUAL_MEMORY(uv, level[0].uvs, uvs * 8);
    for (uint64_t k = 0; k < 3 * level[0].triangle_count; k++) {
        double p[3], is[2];

        position_at(&level[0], k, p);
        torus_formula(p, is);
        for (int i = 0; i < 2; i++) TEST_ASSERT_TRUE(turn_off((double)uv_at(&level[0], k)[i], is[i]) < 1e-5);
    }
}

static void test_indices_beyond_the_uvs_are_refused(void)
{
    static const uint64_t target = 800;
    bvx_simplify_options const o = options_for(&target);
    bvx_levels_options l = {.struct_size = sizeof l};
    bvx_mesh_view view;

    make_torus(1);
    uv_index[31] = (uint32_t)uvs;
    view = view_with(1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_mesh_simplify(ctx, &view, &o, 1, level));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "triangle 10 has uv index"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_build_levels(ctx, &view, &l, 1, level));
}

/* ---- Vertices that are locked ---- */

/* 1: a position is one of the level's vertices, bit for bit. */
static int level_has(const bvx_mesh *m, const double *p)
{
    for (uint64_t v = 0; v < m->vertex_count; v++)
        if (memcmp((const double *)m->positions + 3 * v, p, 24) == 0) return 1;
    return 0;
}

static void test_locked_vertices_stay(void)
{
    static uint8_t locked[MOST];
    static const uint64_t target = 1500;
    bvx_simplify_options o = options_for(&target);

    for (int kind = 0; kind < 2; kind++) {
        bvx_mesh_view view;

        make_torus(0);
        for (size_t v = 0; v < mesh.vertices; v++) locked[v] = maker_below(&seed, 15) == 0;
        view = kind == 0 ? maker_view(&mesh) : view_with(0);
        o.collapse.locked = locked;
        simplify(&view, &o, 1);
        snprintf(where, sizeof where, "kind %d, %d triangles", kind, (int)level[0].triangle_count);
        TEST_ASSERT_TRUE_MESSAGE(report[0].met && report[0].certificate.closed, where);
        for (size_t v = 0; v < mesh.vertices; v++)
            if (locked[v]) TEST_ASSERT_TRUE_MESSAGE(level_has(&level[0], mesh.p + 3 * v), where);
    }
}

/* ---- Tiles ---- */

enum { TILE = 40 };

/* A part of a landscape between two columns. */
static void make_tile(int from, int to)
{
    maker_clear(&mesh);
    for (int y = 0; y <= TILE; y++)
        for (int x = from; x <= to; x++)
            put_vertex(2 + x * 0.125, 2 + y * 0.25, 8 + sin(0.3 * x) * cos(0.21 * y), x / 80.0, y / 40.0);
    put_rows(0, TILE + 1, (uint32_t)(to - from + 1), 0);
}

static void test_tiles_with_locked_borders_join(void)
{
    static const uint64_t target = 400;
    bvx_simplify_options o = options_for(&target);
    maker_mesh joined = {0};

    o.collapse.lock_border = 1;
    for (int kind = 0; kind < 2; kind++) {
        bvx_mesh_view view;
        bvx_certificate c;

        maker_clear(&joined);
        for (int tile = 0; tile < 2; tile++) {
            uint32_t const first = (uint32_t)joined.vertices;

            make_tile(40 * tile, 40 * tile + 40);
            view = maker_view(&mesh);
            if (kind == 1) view.uvs = uv;
            simplify(&view, &o, 1);
            snprintf(where, sizeof where, "kind %d, tile %d, %d triangles", kind, tile,
                     (int)level[0].triangle_count);
            TEST_ASSERT_TRUE_MESSAGE(report[0].met, where);
            for (size_t v = 0; v < mesh.vertices; v++) {
                size_t const x = v % 41, y = v / 41;

                if (x == 0 || x == 40 || y == 0 || y == TILE)
                    TEST_ASSERT_TRUE_MESSAGE(level_has(&level[0], mesh.p + 3 * v), where);
            }
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(160, report[0].certificate.boundary_edges, where);
            for (uint64_t v = 0; v < level[0].vertex_count; v++)
                maker_vertex(&joined, position_of(&level[0], 3 * v), position_of(&level[0], 3 * v + 1),
                             position_of(&level[0], 3 * v + 2));
            for (uint64_t t = 0; t < level[0].triangle_count; t++)
                maker_triangle(&joined, first + level[0].triangles[3 * t],
                               first + level[0].triangles[3 * t + 1], first + level[0].triangles[3 * t + 2]);
        }

        /* No crack: what is open is around both. */
        view = maker_view(&joined);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
        TEST_ASSERT_TRUE(c.edge_manifold && c.oriented && c.components == 1 && c.euler == 1);
        TEST_ASSERT_EQUAL_UINT64(240, c.boundary_edges);
    }
    maker_free(&joined);
}

/* ---- Vertices of very many triangles ---- */

static void make_fans(int32_t sides)
{
    uint32_t top, bottom;

    maker_clear(&mesh);
    for (int r = 0; r < 2; r++)
        for (int32_t s = 0; s < sides; s++)
            maker_vertex(&mesh, 8 + 3 * cos(TURN * s / sides), 8 + 3 * sin(TURN * s / sides), 6 + 4 * r);
    bottom = maker_vertex(&mesh, 8, 8, 6);
    top = maker_vertex(&mesh, 8, 8, 10);
    for (int32_t s = 0; s < sides; s++) {
        uint32_t const a = (uint32_t)s, b = (uint32_t)((s + 1) % sides), up = (uint32_t)sides;

        maker_quad(&mesh, a, b, b + up, a + up, 0);
        maker_triangle(&mesh, bottom, b, a);
        maker_triangle(&mesh, top, a + up, b + up);
    }
}

static void test_vertices_of_many_triangles_come_down(void)
{
    for (int kind = 0; kind < 4; kind++) {
        bvx_simplify_options o = options_for(NULL);
        uint64_t targets[2];
        bvx_mesh_view view;

        make_fans(kind % 2 == 0 ? 520 : 4000);
        targets[0] = mesh.triangles / 2;
        targets[1] = mesh.triangles / 10;
        o.targets.triangles = targets;
        o.collapse.vertices = kind < 2 ? BVX_VERTICES_PLACED : BVX_VERTICES_KEPT;
        view = maker_view(&mesh);
        simplify(&view, &o, 2);
        for (int i = 0; i < 2; i++) {
            const bvx_certificate *const c = &report[i].certificate;

            snprintf(where, sizeof where, "kind %d: %d of %d triangles", kind, (int)level[i].triangle_count,
                     (int)targets[i]);
            TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].crossings == 0, where);
            TEST_ASSERT_TRUE_MESSAGE(c->closed && c->edge_manifold && c->vertex_manifold && c->oriented,
                                     where);
            TEST_ASSERT_TRUE_MESSAGE(c->volume > 0.98 * 36 * TURN / 2, where);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_cylinder_keeps_seams_normals_and_materials);
    RUN_TEST(test_own_indices_keep_hard_edges);
    RUN_TEST(test_a_torus_keeps_both_seams);
    RUN_TEST(test_narrow_charts_meet_and_show_nothing_of_others);
    RUN_TEST(test_both_ways_to_store_texture_coordinates_are_one_shape);
    RUN_TEST(test_a_weight_of_0_carries_attributes);
    RUN_TEST(test_second_texture_coordinates_follow);
    RUN_TEST(test_colours_keep_their_borders);
    RUN_TEST(test_threads_and_order_do_not_matter);
    RUN_TEST(test_kept_vertices_are_the_meshs_own);
    RUN_TEST(test_levels_of_kept_vertices_have_their_attributes);
    RUN_TEST(test_indices_beyond_the_uvs_are_refused);
    RUN_TEST(test_locked_vertices_stay);
    RUN_TEST(test_tiles_with_locked_borders_join);
    RUN_TEST(test_vertices_of_many_triangles_come_down);
    return UNITY_END();
}
