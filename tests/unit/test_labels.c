/* test_labels.c - surfaces of labels: every pattern of labels in a cell and every pair of cells of two labels,
 * held against faces found voxel by voxel; bodies against the certificate; types, layouts, threads; smoothing's
 * bounds, volumes and crossings; fewer triangles against solids of all bodies in quarter voxels. */
#include "suite.h"

#include <math.h>
#include <stdlib.h>

static bvx_complex complex_, twin;
static bvx_mesh mesh;
static uint64_t state;

void setUp(void)
{
    suite_open(1);
    state = 77;
}

void tearDown(void)
{
    bvx_complex_free(ctx, &complex_);
    bvx_complex_free(ctx, &twin);
    bvx_mesh_free(ctx, &mesh);
    suite_close();
}

static uint32_t below(uint32_t n)
{
    state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(state >> 33) % n;
}

static bvx_volume_view view_of(const void *samples, int32_t type, int32_t nx, int32_t ny, int32_t nz)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const size[3] = {nx, ny, nz};
    bvx_volume_view v = {.samples = samples, .sample_type = type};

    memcpy(v.size, size, sizeof size);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, size, &v.lattice));
    return v;
}

static void make(const bvx_volume_view *v, int staircase, int64_t background)
{
    bvx_labels_options o = {.struct_size = sizeof o, .background = background};
    o.staircase = staircase;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_label_surfaces(ctx, v, &o, &complex_), bvx_last_message(ctx));
}

/* The body of a label, closed, manifold and outwards. */
static bvx_certificate body(uint64_t label)
{
    bvx_certificate c;
    bvx_mesh_view view;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_label_mesh(ctx, &complex_, label, &mesh),
                                    bvx_last_message(ctx));
    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
    TEST_ASSERT_EQUAL_UINT64(0, c.duplicates + c.collapsed + c.unused_vertices);
    TEST_ASSERT_EQUAL_UINT64((complex_.single ? 1 : 2) * (complex_.first[label + 1] - complex_.first[label]),
                             c.triangles);
    return c;
}

static uint64_t crossings(void)
{
    bvx_mesh_view view;
    uint64_t count;

    bvx_mesh_view_of(&complex_.mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
    return count;
}

static void check_bodies(int staircase)
{
    for (uint64_t i = 0; i < complex_.label_count; i++) {
        double const volume = body(i).volume, voxels = (double)complex_.labels[i].voxels;
        if (staircase) TEST_ASSERT_EQUAL_DOUBLE(voxels, volume);
    }
    TEST_ASSERT_EQUAL_UINT64(0, crossings());
}

/* ---- All patterns ---- */

/* Blocks of voxels with a layer of background between them. */
enum { BLOCKS = 18 };
static uint32_t field[BLOCKS * 4 * BLOCKS * 3 * BLOCKS * 3];

static uint32_t *block_voxel(int32_t block, int32_t wide, int32_t x, int32_t y, int32_t z)
{
    int32_t const side = BLOCKS * (wide + 1), rows = BLOCKS * 3;
    int32_t const bx = block % BLOCKS, by = block / BLOCKS % BLOCKS, bz = block / BLOCKS / BLOCKS;
    return &field[((bz * 3 + z) * rows + by * 3 + y) * side + bx * (wide + 1) + x];
}

/* Labels that are equal where those of a pattern are: each set partition of eight corners once. With zero, the
 * pattern's first label is background. */
static int32_t fill_partitions(int zero)
{
    int32_t part[8] = {0}, most[8] = {0}, block = 0, i = 7;

    memset(field, 0, sizeof field);
    for (;; block++) {
        for (int32_t n = 0; n < 8; n++)
            *block_voxel(block, 2, n & 1, n >> 1 & 1,
                         n >> 2) = zero && part[n] == 0 ? 0 : (uint32_t)(block * 8 + part[n] + 1);
        for (i = 7; i > 0 && part[i] > most[i - 1]; i--) part[i] = 0;
        if (i == 0) return block + 1;
        part[i]++;
        most[i] = part[i] > most[i - 1] ? part[i] : most[i - 1];
        for (int32_t n = i + 1; n < 8; n++) most[n] = most[i];
    }
}

static void test_labels_of_all_partitions_of_a_cell_are_bodies(void)
{
    for (int zero = 0; zero < 2; zero++) {
        bvx_volume_view const v = view_of(field, BVX_SAMPLE_U32, BLOCKS * 3, BLOCKS * 3, BLOCKS * 3);

        TEST_ASSERT_EQUAL_INT32(4140, fill_partitions(zero)); /* Bell's number of 8 */
        make(&v, 1, 0);
        check_bodies(1);
    }
}

/* Two cells that share a side: where a body leads around it in both, its faces must be parted. */
static void test_labels_of_all_pairs_of_cells_are_bodies(void)
{
    bvx_volume_view const v = view_of(field, BVX_SAMPLE_U32, BLOCKS * 4, BLOCKS * 3, BLOCKS * 3);

    memset(field, 0, sizeof field);
    for (int32_t block = 0; block < 4096; block++)
        for (int32_t n = 0; n < 12; n++)
            if ((block >> n & 1) != 0) *block_voxel(block, 3, n % 3, n / 3 % 2, n / 6) = (uint32_t)block;
    make(&v, 1, 0);
    TEST_ASSERT_EQUAL_UINT64(4095, complex_.label_count);
    check_bodies(1);
}

/* ---- Held against faces found voxel by voxel ---- */

static void check_faces(const uint8_t *samples, const int32_t n[3])
{
    uint64_t face = 0;

    for (int32_t z = -1; z < n[2]; z++)
        for (int32_t y = -1; y < n[1]; y++)
            for (int32_t x = -1; x < n[0]; x++)
                for (int axis = 0; axis < 3; axis++) {
                    int32_t const p[2][3] = {{x, y, z}, {x + (axis == 0), y + (axis == 1), z + (axis == 2)}};
                    uint32_t rank[2];
                    for (int e = 0; e < 2; e++) {
                        int in = 1;
                        for (int a = 0; a < 3; a++) in = in && p[e][a] >= 0 && p[e][a] < n[a];
                        int64_t const value = in ? samples[(p[e][2] * n[1] + p[e][1]) * n[0] + p[e][0]] : 0;
                        rank[e] = 0;
                        while (rank[e] < complex_.label_count && complex_.labels[rank[e]].value != value)
                            rank[e]++;
                    }
                    if (rank[0] == rank[1]) continue;
                    TEST_ASSERT_TRUE(face < complex_.face_count);
                    TEST_ASSERT_EQUAL_UINT32(rank[0] < rank[1] ? rank[0] : rank[1], complex_.sides[2 * face]);
                    TEST_ASSERT_EQUAL_UINT32(rank[0] < rank[1] ? rank[1] : rank[0],
                                             complex_.sides[2 * face + 1]);

                    /* Its corners are those of the square between the voxels, to the front counter-clockwise. */
                    const uint32_t *const t = complex_.mesh.triangles + 6 * face;
                    const float *const q = complex_.mesh.positions;
                    double mean[3] = {0}, way[2][3], normal[3];
                    for (int a = 0; a < 3; a++) {
                        mean[a] = 0.25 * ((double)q[3 * t[0] + (size_t)a] + (double)q[3 * t[1] + (size_t)a] +
                                          (double)q[3 * t[2] + (size_t)a] + (double)q[3 * t[5] + (size_t)a]);
                        way[0][a] = (double)(q[3 * t[2] + (size_t)a] - q[3 * t[0] + (size_t)a]);
                        way[1][a] = (double)(q[3 * t[5] + (size_t)a] - q[3 * t[1] + (size_t)a]);
                    }
                    for (int a = 0; a < 3; a++) {
                        int const b = (a + 1) % 3, c = (a + 2) % 3;
                        normal[a] = 0.5 * (way[0][b] * way[1][c] - way[0][c] * way[1][b]);
                        TEST_ASSERT_EQUAL_DOUBLE((double)p[1][a] + (a == axis ? 0.0 : 0.5), mean[a]);
                        TEST_ASSERT_EQUAL_DOUBLE(a != axis ? 0.0 : rank[0] < rank[1] ? 1.0 : -1.0, normal[a]);
                    }
                    face++;
                }
    TEST_ASSERT_EQUAL_UINT64(face, complex_.face_count);
}

static void test_labels_of_noise_are_the_faces_of_its_voxels(void)
{
    uint8_t samples[5 * 6 * 70];

    for (int trial = 0; trial < 12; trial++) {
        /* Rows around the ends of words too. */
        static const int32_t sizes[4][3] = {{5, 5, 5}, {62, 2, 3}, {63, 3, 2}, {70, 5, 6}};
        const int32_t *const n = sizes[trial % 4];
        int32_t const count = n[0] * n[1] * n[2];
        for (int32_t i = 0; i < count; i++) samples[i] = (uint8_t)below(trial % 3 == 0 ? 2 : 5);
        bvx_volume_view const v = view_of(samples, BVX_SAMPLE_U8, n[0], n[1], n[2]);

        make(&v, 1, 0);
        check_faces(samples, n);
        check_bodies(1);
        make(&v, 0, 0);
        check_bodies(0);
    }
}

/* ---- Values, layouts, threads ---- */

static void same_complex(const bvx_complex *a, const bvx_complex *b)
{
    TEST_ASSERT_EQUAL_UINT64(a->mesh.vertex_count, b->mesh.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(a->face_count, b->face_count);
    TEST_ASSERT_EQUAL_MEMORY(a->mesh.positions, b->mesh.positions, a->mesh.vertex_count * 12);
    TEST_ASSERT_EQUAL_MEMORY(a->mesh.triangles, b->mesh.triangles, a->face_count * 24);
    TEST_ASSERT_EQUAL_MEMORY(a->sides, b->sides, a->face_count * 8);
    TEST_ASSERT_EQUAL_MEMORY(a->cells, b->cells, a->mesh.vertex_count * 8);
    TEST_ASSERT_EQUAL_MEMORY(a->junctions, b->junctions, a->mesh.vertex_count);
    TEST_ASSERT_EQUAL_MEMORY(a->first, b->first, (a->label_count + 1) * 8);
    TEST_ASSERT_EQUAL_MEMORY(a->faces, b->faces, a->first[a->label_count] * 4);
}

/* A few cells of Voronoi's, and noise in a corner. */
enum { SIDE = 48 };
static uint8_t cells[SIDE * SIDE * SIDE];
static void fill_cells(void)
{
    int32_t seeds[12][3];

    for (int i = 0; i < 12; i++)
        for (int a = 0; a < 3; a++) seeds[i][a] = (int32_t)below(SIDE);
    for (int32_t n = 0; n < SIDE * SIDE * SIDE; n++) {
        int32_t const p[3] = {n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE};
        int32_t best = INT32_MAX;
        for (int i = 0; i < 12; i++) {
            int32_t far = 0;
            for (int a = 0; a < 3; a++) far += (p[a] - seeds[i][a]) * (p[a] - seeds[i][a]);
            if (far >= best) continue;
            best = far;
            cells[n] = (uint8_t)i;
        }
        if (p[0] + p[1] + p[2] < 24) cells[n] = (uint8_t)below(12);
    }
}

static void test_labels_are_the_same_for_all_threads(void)
{
    fill_cells();
    bvx_volume_view const v = view_of(cells, BVX_SAMPLE_U8, SIDE, SIDE, SIDE);

    make(&v, 0, 0);
    for (int32_t threads = 2; threads <= 4; threads += 2) {
        bvx_context *const other = suite_context(threads, BVX_CPU_BEST);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_surfaces(other, &v, NULL, &twin));
        same_complex(&complex_, &twin);
        bvx_complex_free(other, &twin);
        bvx_context_destroy(other);
    }
}

static void test_labels_of_any_type_order_and_sign(void)
{
    static int64_t wide[9 * 8 * 7];
    static int8_t narrow[9 * 8 * 7];

    for (int32_t i = 0; i < 9 * 8 * 7; i++) {
        narrow[i] = (int8_t)((int32_t)below(4) - 2);
        wide[(i % 9) * 56 + i / 9 % 8 * 7 + i / 72] = narrow[i] < 0 ? INT64_MIN + narrow[i] + 2 : narrow[i];
    }
    bvx_volume_view v = view_of(narrow, BVX_SAMPLE_I8, 9, 8, 7);
    make(&v, 0, -1);
    TEST_ASSERT_EQUAL_UINT64(3, complex_.label_count);
    TEST_ASSERT_EQUAL_INT64(-2, complex_.labels[0].value);

    bvx_labels_options const o = {.struct_size = sizeof o, .background = INT64_MIN + 1};
    v = view_of(wide, BVX_SAMPLE_I64, 9, 8, 7);
    v.strides[0] = 56 * 8;
    v.strides[1] = 7 * 8;
    v.strides[2] = 8;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_surfaces(ctx, &v, &o, &twin));
    TEST_ASSERT_EQUAL_INT64(INT64_MIN, twin.labels[0].value);
    same_complex(&complex_, &twin);
}

static void test_labels_of_a_window_lie_in_the_world(void)
{
    static const double origin[3] = {10, -20, 30}, spacing[3] = {0.5, 2, 1};
    static const int32_t dims[3] = {100, 100, 100}, low[3] = {7, 8, 9};
    uint8_t const one = 3;
    bvx_volume_view v = {.samples = &one, .sample_type = BVX_SAMPLE_U8};

    for (int a = 0; a < 3; a++) {
        v.size[a] = 1;
        v.low[a] = low[a];
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &v.lattice));
    make(&v, 1, 0);
    bvx_certificate c = body(0);
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_EQUAL_DOUBLE(origin[a] + low[a] * spacing[a], c.box.low[a]);
        TEST_ASSERT_EQUAL_DOUBLE(origin[a] + (low[a] + 1) * spacing[a], c.box.high[a]);
    }
    make(&v, 0, 0);
    TEST_ASSERT_DOUBLE_WITHIN(0.001, 1.0, body(0).volume);
    make(&v, 0, 3); /* all of it is background */
    TEST_ASSERT_EQUAL_UINT64(0, complex_.label_count + complex_.face_count + complex_.mesh.vertex_count);
}

/* ---- Smoothing ---- */

static void check_bounds(const bvx_volume_view *v)
{
    const float *const p = complex_.mesh.positions;

    for (uint64_t i = 0; i < complex_.mesh.vertex_count; i++) {
        uint64_t rest = complex_.cells[i];
        for (uint64_t a = 0; a < 3; a++) {
            uint64_t const n = (uint64_t)v->size[a] + 1;
            double const from = fabs((double)p[3 * i + a] - (double)(a < 2 ? rest % n : rest));
            TEST_ASSERT_TRUE(from < 0.4901);
            rest /= n;
        }
    }
}

static void test_labels_smoothed_stay_in_cells_and_keep_volumes(void)
{
    fill_cells();
    for (int32_t n = 0; n < SIDE * SIDE * SIDE; n++) /* without the noise */
        if (n % SIDE + n / SIDE % SIDE + n / SIDE / SIDE < 24) cells[n] = 0;
    bvx_volume_view const v = view_of(cells, BVX_SAMPLE_U8, SIDE, SIDE, SIDE);

    make(&v, 0, 0);
    check_bounds(&v);
    TEST_ASSERT_EQUAL_UINT64(0, crossings());
    for (uint64_t i = 0; i < complex_.label_count; i++) {
        double const voxels = (double)complex_.labels[i].voxels;
        TEST_ASSERT_DOUBLE_WITHIN(0.001 * voxels, voxels, body(i).volume);
    }
}

/* Manifold by positions too: what other programs see that join vertices at the same place. */
static bvx_certificate welded_body(uint64_t label)
{
    bvx_certificate c;
    bvx_mesh_view view;

    (void)body(label);
    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold);
    return c;
}

static void test_labels_smoothed_touch_themselves_in_no_edge(void)
{
    uint8_t samples[4 * 4 * 3];

    /* Voxels across an edge, in one layer or all of three, between two other labels or the same. */
    for (int32_t trial = 0; trial < 16; trial++) {
        int32_t const third = trial & 1 ? 3 : 2, first = trial & 2 ? 1 : 2, thick = trial & 4,
                      turned = trial >> 3;
        for (int32_t i = 0; i < 4 * 4 * 3; i++) {
            int32_t const x = i % 4, y = i / 4 % 4, z = i / 16, mid = thick || z == 1;
            int32_t const a = mid && (x < 2) == (y < 2), b = (x < 2) != turned;
            samples[i] = (uint8_t)(a ? first : b ? 3 - first : third == 3 ? 3 : 3 - first);
        }
        bvx_volume_view const v = view_of(samples, BVX_SAMPLE_U8, 4, 4, 3);
        make(&v, 0, 0);
        TEST_ASSERT_EQUAL_UINT64(0, crossings());
        for (uint64_t i = 0; i < complex_.label_count; i++) (void)welded_body(i);
    }
    fill_cells();
    for (int32_t n = 0; n < SIDE * SIDE * SIDE; n++)
        if (n % SIDE + n / SIDE % SIDE + n / SIDE / SIDE < 24) cells[n] = 0;
    bvx_volume_view const v = view_of(cells, BVX_SAMPLE_U8, SIDE, SIDE, SIDE);
    make(&v, 0, 0);
    for (uint64_t i = 0; i < complex_.label_count; i++) (void)welded_body(i);
}

/* What triangles that cross are moved back to has an area. */
static void test_labels_smoothed_collapse_no_triangle(void)
{
    for (int32_t n = 0; n < 24 * 22 * 20; n++) {
        int32_t const x = n % 24, y = n / 24 % 22, z = n / 24 / 22;
        int32_t const label = 3 * x + y < 40 ? 5 : y + z < 24 ? 7 : 9;
        cells[n] = (uint8_t)(x < 4 && y < 4 && z < 4 && (x + y + z) % 2 != 0 ? 1 : label);
    }
    bvx_volume_view const v = view_of(cells, BVX_SAMPLE_U8, 24, 22, 20);
    bvx_mesh_view view;
    bvx_certificate c;

    make(&v, 0, 0);
    check_bodies(0);
    bvx_mesh_view_of(&complex_.mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
    TEST_ASSERT_EQUAL_UINT64(0, c.collapsed);
}

/* Faces between two labels of which most are at junctions have few vertices that may move off them. */
static void test_labels_smoothed_stay_near_planes(void)
{
    enum { N = 48, SEEDS = 60 };
    static uint8_t voronoi[N * N * N];
    int32_t seeds[SEEDS][3];
    double worst = 0;

    for (int i = 0; i < SEEDS; i++)
        for (int a = 0; a < 3; a++) seeds[i][a] = (int32_t)below(2 * N);
    for (int32_t n = 0; n < N * N * N; n++) {
        int32_t const p[3] = {2 * (n % N) + 1, 2 * (n / N % N) + 1, 2 * (n / N / N) + 1};
        int32_t best = INT32_MAX;
        for (int i = 0; i < SEEDS; i++) {
            int32_t far = 0;
            for (int a = 0; a < 3; a++) far += (p[a] - seeds[i][a]) * (p[a] - seeds[i][a]);
            if (far >= best) continue;
            best = far;
            voronoi[n] = (uint8_t)(i + 1);
        }
    }
    bvx_volume_view const v = view_of(voronoi, BVX_SAMPLE_U8, N, N, N);
    make(&v, 0, 0);
    for (uint64_t f = 0; f < complex_.face_count; f++) {
        const uint32_t *const t = complex_.mesh.triangles + 6 * f, *const side = complex_.sides + 2 * f;
        if (side[1] == complex_.label_count) continue;
        const int32_t *const a = seeds[complex_.labels[side[0]].value - 1],
                             *const b = seeds[complex_.labels[side[1]].value - 1];
        for (int k = 0; k < 3; k++) {
            const float *const p = (const float *)complex_.mesh.positions + 3 * (size_t)t[k];
            double along = 0, length = 0;
            for (int d = 0; d < 3; d++) {
                double const way = 0.5 * (b[d] - a[d]);
                along += way * ((double)p[d] - 0.25 * (a[d] + b[d]));
                length += way * way;
            }
            if (fabs(along) / sqrt(length) > worst) worst = fabs(along) / sqrt(length);
        }
    }
    TEST_ASSERT_TRUE(worst < 0.9);
}

static void test_labels_smoothed_are_a_ball(void)
{
    enum { N = 72 };
    static uint8_t ball[N * N * N];
    double const pi = 3.14159265358979323846;

    for (int32_t n = 0; n < N * N * N; n++) {
        double const x = n % N + 0.5 - 36, y = n / N % N + 0.5 - 36, z = n / N / N + 0.5 - 36;
        ball[n] = x * x + y * y + z * z <= 35 * 35;
    }
    bvx_volume_view const v = view_of(ball, BVX_SAMPLE_U8, N, N, N);
    make(&v, 0, 0);
    bvx_certificate const c = body(0);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 4 * pi * 35 * 35, 4 * pi * 35 * 35, c.area);
    TEST_ASSERT_DOUBLE_WITHIN(1e-5 * c.volume, (double)complex_.labels[0].voxels, c.volume);
    TEST_ASSERT_EQUAL_INT64(2, c.euler);
}

/* ---- Fewer triangles ---- */

static void make_fewer(bvx_context *c, const bvx_volume_view *v, uint64_t triangles, double error,
                       bvx_complex *to)
{
    bvx_labels_options const o = {.struct_size = sizeof o, .triangles = triangles, .error = error};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_label_surfaces(c, v, &o, to), bvx_last_message(c));
    TEST_ASSERT_EQUAL_INT32(1, to->single);
    TEST_ASSERT_NULL(to->cells);
    TEST_ASSERT_EQUAL_UINT64(to->mesh.triangle_count, to->face_count);
}

/* Faces between two labels of blocks of noise meet at vertices in several fans. None of that ends the collapse. */
static void test_blocks_of_noise_become_fewer_triangles(void)
{
    enum { WIDE = 14 };
    static uint8_t blocks[WIDE * WIDE * WIDE];
    uint8_t label[WIDE / 2 * WIDE / 2 * WIDE / 2];

    for (int32_t round = 0; round < 6; round++) {
        for (int32_t n = 0; n < (int32_t)sizeof label; n++) label[n] = (uint8_t)below(3);
        for (int32_t n = 0; n < WIDE * WIDE * WIDE; n++)
            blocks[n] =
                label[n % WIDE / 2 + WIDE / 2 * (n / WIDE % WIDE / 2 + WIDE / 2 * (n / WIDE / WIDE / 2))];
        bvx_volume_view const v = view_of(blocks, BVX_SAMPLE_U8, WIDE, WIDE, WIDE);
        make(&v, 0, 0);
        uint64_t const before = complex_.mesh.triangle_count;
        make_fewer(ctx, &v, before / 20, 0, &complex_);
        check_bodies(0);
        TEST_ASSERT_TRUE(complex_.face_count < before / 4);
    }
}

/* Noise has junctions everywhere: hardly anything can go, and whatever does leaves bodies. */
static void test_labels_with_fewer_triangles_are_bodies(void)
{
    static uint8_t noise[16 * 16 * 16];
    uint64_t before;

    for (int32_t round = 0; round < 4; round++) {
        int32_t const side = 4 + 4 * round;
        for (int32_t n = 0; n < side * side * side; n++) noise[n] = (uint8_t)below(5);
        bvx_volume_view const v = view_of(noise, BVX_SAMPLE_U8, side, side, side);
        make_fewer(ctx, &v, 1, 0, &complex_);
        check_bodies(0);
    }
    fill_cells();
    bvx_volume_view const v = view_of(cells, BVX_SAMPLE_U8, SIDE, SIDE, SIDE);
    make(&v, 0, 0);
    before = complex_.mesh.triangle_count;
    bvx_complex const all = complex_;
    memset(&complex_, 0, sizeof complex_);
    make_fewer(ctx, &v, before / 3, 0, &complex_);
    TEST_ASSERT_TRUE(complex_.face_count <= before / 3);
    check_bodies(0);

    bvx_context *const other = suite_context(3, BVX_CPU_BEST);
    make_fewer(other, &v, before / 3, 0, &twin);
    TEST_ASSERT_EQUAL_UINT64(complex_.face_count, twin.face_count);
    TEST_ASSERT_EQUAL_MEMORY(complex_.mesh.positions, twin.mesh.positions, twin.mesh.vertex_count * 12);
    TEST_ASSERT_EQUAL_MEMORY(complex_.mesh.triangles, twin.mesh.triangles, twin.face_count * 12);
    TEST_ASSERT_EQUAL_MEMORY(complex_.sides, twin.sides, twin.face_count * 8);
    bvx_complex_free(other, &twin);
    bvx_context_destroy(other);

    /* By error, measured anew. */
    bvx_mesh_view from, to;
    bvx_distance_report d;
    make_fewer(ctx, &v, 0, 0.08, &complex_);
    TEST_ASSERT_TRUE(complex_.face_count < before / 2);
    check_bodies(0);
    bvx_mesh_view_of(&all.mesh, &from);
    bvx_mesh_view_of(&complex_.mesh, &to);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &from, &to, 20000, 3, &d));
    TEST_ASSERT_TRUE(d.mean < 0.085 && d.mean > 0.03);
    twin = all;
}

/* Solids of all bodies at the centres of quarter voxels: together they are that of what lies between them and the
 * background, and have as many. */
static void test_labels_with_a_tenth_of_the_triangles_leave_no_gap(void)
{
    enum { WIDE = 128, BODIES = 9 };
    static uint8_t map[WIDE * WIDE * WIDE];
    static double const origin[3] = {-0.5, -0.5, -0.5}, quarter[3] = {0.25, 0.25, 0.25};
    static int32_t const dims[3] = {4 * WIDE + 4, 4 * WIDE + 4, 4 * WIDE + 4};
    bvx_voxelize_options const parity = {.struct_size = sizeof parity, .fill = BVX_FILL_PARITY};
    int32_t seeds[BODIES][3];
    bvx_lattice fine;
    bvx_grid whole = {0}, one = {0}, outer = {0};
    bvx_mesh_view view;
    uint64_t sum = 0, count, hash[2], outside = 0;

    for (int i = 0; i < BODIES; i++)
        for (int a = 0; a < 3; a++) seeds[i][a] = (int32_t)below(WIDE);
    for (int32_t n = 0; n < WIDE * WIDE * WIDE; n++) {
        int32_t const p[3] = {n % WIDE, n / WIDE % WIDE, n / WIDE / WIDE};
        int32_t best = INT32_MAX;
        for (int i = 0; i < BODIES; i++) {
            int32_t far = 0;
            for (int a = 0; a < 3; a++) far += (p[a] - seeds[i][a]) * (p[a] - seeds[i][a]);
            if (far >= best) continue;
            best = far;
            map[n] = (uint8_t)(i + 1);
        }
    }
    bvx_volume_view const v = view_of(map, BVX_SAMPLE_U8, WIDE, WIDE, WIDE);
    make(&v, 0, 0);
    uint64_t const tenth = complex_.mesh.triangle_count / 10;
    make_fewer(ctx, &v, tenth, 0, &complex_);
    TEST_ASSERT_TRUE(complex_.face_count <= tenth && complex_.face_count > tenth - 64);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, quarter, dims, &fine));
    for (uint64_t i = 0; i < complex_.label_count; i++) {
        (void)body(i);
        bvx_mesh_view_of(&mesh, &view);
        bvx_grid *const to = i == 0 ? &whole : &one;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &fine, &parity, to));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, to, &count));
        sum += count;
        if (i != 0)
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_combine(ctx, &whole, &one, BVX_BOOLEAN_UNION, &whole));
    }
    for (uint64_t f = 0; f < complex_.face_count; f++)
        if (complex_.sides[2 * f + 1] == complex_.label_count)
            memmove(complex_.mesh.triangles + 3 * outside++, complex_.mesh.triangles + 3 * f, 12);
    bvx_mesh_view_of(&complex_.mesh, &view);
    view.triangle_count = outside;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &fine, &parity, &outer));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &whole, &count));
    TEST_ASSERT_EQUAL_UINT64(count, sum);
    TEST_ASSERT_TRUE(count > UINT64_C(512) * 512 * 500);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &whole, &hash[0]));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &outer, &hash[1]));
    TEST_ASSERT_EQUAL_HEX64(hash[1], hash[0]);
    bvx_grid_free(ctx, &whole);
    bvx_grid_free(ctx, &one);
    bvx_grid_free(ctx, &outer);
}

/* ---- Open windows ---- */

/* Up to eight windows of a volume, joined: faces as single triangles, labels as the whole has them; the seam's bytes
 * of each vertex. */
enum { JOIN_VERTICES = 1 << 18, JOIN_FACES = 1 << 19, JOIN_LABELS = 64, IN_CELL = 12 };
static bvx_complex joined;
static float join_position[3 * JOIN_VERTICES];
static uint8_t join_junction[JOIN_VERTICES], join_seam[JOIN_VERTICES];
static uint32_t join_triangle[3 * JOIN_FACES], join_side[2 * JOIN_FACES], join_list[2 * JOIN_FACES];
static uint64_t join_first[JOIN_LABELS + 2];
static uint32_t join_at[(SIDE + 1) * (SIDE + 1) * (SIDE + 1) * IN_CELL];

/* The vertex of the whole for one of a window: by its cell and place in it, when simplified by its position. */
static uint32_t join_vertex(const bvx_complex *c, const int32_t n[3], uint64_t v)
{
    const float *const p = (const float *)c->mesh.positions + 3 * v;
    uint32_t to = (uint32_t)joined.mesh.vertex_count, *known = &to;

    if (c->single) {
        for (uint32_t i = 0; i < to && (c->junctions[v] & BVX_ON_SEAM) != 0; i++)
            if (join_seam[i] == c->junctions[v] && memcmp(join_position + 3 * (size_t)i, p, 12) == 0)
                return i;
    } else {
        uint64_t const row = (uint64_t)c->size[0] + 1, slice = row * ((uint64_t)c->size[1] + 1),
                       cell = c->cells[v];
        uint64_t const x = cell % row + (uint64_t)c->low[0], y = cell % slice / row + (uint64_t)c->low[1],
                       z = cell / slice + (uint64_t)c->low[2];
        uint64_t place = 0;
        while (place < v && c->cells[v - place - 1] == cell) place++;
        TEST_ASSERT_TRUE(place < IN_CELL);
        known = &join_at[((z * (uint64_t)(n[1] + 1) + y) * (uint64_t)(n[0] + 1) + x) * IN_CELL + place];
    }
    if (*known < to) {
        /* Every window has the same bits. */
        TEST_ASSERT_TRUE((c->junctions[v] & join_seam[*known] & BVX_AT_SEAM) != 0);
        TEST_ASSERT_EQUAL_HEX8(join_seam[*known], c->junctions[v]);
        TEST_ASSERT_EQUAL_MEMORY(join_position + 3 * (size_t)*known, p, 12);
        return *known;
    }
    TEST_ASSERT_TRUE(to < JOIN_VERTICES);
    memcpy(join_position + 3 * (size_t)to, p, 12);
    join_junction[to] = 1;
    join_seam[to] = c->junctions[v];
    joined.mesh.vertex_count++;
    return *known = to;
}

static void join_window(const bvx_complex *c, const int32_t n[3])
{
    uint64_t const each = c->single ? 1 : 2;
    uint32_t rank[JOIN_LABELS + 1];

    for (uint32_t i = 0; i <= c->label_count; i++) {
        rank[i] = 0;
        while (rank[i] < joined.label_count &&
               (i == c->label_count || joined.labels[rank[i]].value != c->labels[i].value))
            rank[i]++;
    }
    uint32_t *const to = malloc(c->mesh.vertex_count * 4 + 4);
    for (uint64_t v = 0; v < c->mesh.vertex_count; v++) to[v] = join_vertex(c, n, v);
    for (uint64_t t = 0; t < c->mesh.triangle_count; t++) {
        uint64_t const f = joined.face_count++;
        TEST_ASSERT_TRUE(f < JOIN_FACES);
        for (uint64_t k = 0; k < 3; k++) join_triangle[3 * f + k] = to[c->mesh.triangles[3 * t + k]];
        for (uint64_t k = 0; k < 2; k++) join_side[2 * f + k] = rank[c->sides[t / each * 2 + k]];
    }
    free(to);
}

/* Bodies of the whole from windows that are parted at cut, 0: not along this axis; wanted: how well they keep their
 * volumes, 0: not looked at. */
static void check_joined(const uint8_t *samples, const int32_t n[3], const int32_t cut[3],
                         bvx_labels_options o, double wanted)
{
    bvx_volume_view v = view_of(samples, BVX_SAMPLE_U8, n[0], n[1], n[2]);
    uint64_t kept = 0;

    make(&v, o.staircase, 0);
    joined = (bvx_complex){.labels = complex_.labels, .label_count = complex_.label_count, .single = 1};
    memset(join_at, 0xff, sizeof join_at);
    o.open = 1;
    for (int32_t window = 0; window < 8; window++) {
        bvx_volume_view w = v;
        int32_t low[3], high[3], any = 1;
        for (int a = 0; a < 3; a++) {
            int const upper = window >> a & 1;
            if (upper && cut[a] == 0) any = 0;
            low[a] = upper ? cut[a] - 1 : 0;
            high[a] = upper || cut[a] == 0 ? n[a] : cut[a] + 1;
            w.low[a] = low[a];
            w.size[a] = high[a] - low[a];
        }
        if (!any) continue;
        w.strides[0] = 1;
        w.strides[1] = n[0];
        w.strides[2] = (int64_t)n[0] * n[1];
        w.samples = samples + low[2] * w.strides[2] + low[1] * w.strides[1] + low[0];
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_label_surfaces(ctx, &w, &o, &twin),
                                        bvx_last_message(ctx));
        join_window(&twin, n);
        for (uint64_t i = 0; i < twin.label_count; i++)
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_label_mesh(ctx, &twin, i, &mesh),
                                            bvx_last_message(ctx));
    }
    joined.mesh.positions = join_position;
    joined.mesh.triangles = join_triangle;
    joined.mesh.triangle_count = joined.face_count;
    joined.mesh.position_type = BVX_F32;
    joined.sides = join_side;
    joined.junctions = join_junction;
    joined.first = join_first;
    joined.faces = join_list;
    if (o.triangles == 0) TEST_ASSERT_EQUAL_UINT64(2 * complex_.face_count, joined.face_count);
    for (uint64_t i = 0; i < joined.label_count; i++) {
        join_first[i] = kept;
        for (uint64_t f = 0; f < joined.face_count; f++)
            if (join_side[2 * f] == i || join_side[2 * f + 1] == i) join_list[kept++] = (uint32_t)f;
    }
    join_first[joined.label_count] = kept;

    /* The joined complex stands in for the whole. */
    bvx_complex const whole = complex_;
    complex_ = joined;
    for (uint64_t i = 0; i < joined.label_count; i++) {
        bvx_certificate c;
        bvx_mesh_view view;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_mesh(ctx, &joined, i, &mesh));
        bvx_mesh_view_of(&mesh, &view);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
        TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
        double const voxels = (double)joined.labels[i].voxels;
        if (wanted > 0) TEST_ASSERT_DOUBLE_WITHIN(wanted * voxels, voxels, c.volume);
    }
    TEST_ASSERT_EQUAL_UINT64(0, crossings());
    complex_ = whole;
}

static void test_labels_of_open_windows_join(void)
{
    static int32_t const wide[3] = {SIDE, SIDE, SIDE}, small[3] = {12, 11, 10};
    static int32_t const cuts[4][3] = {{17, 0, 0}, {0, 0, 24}, {20, 31, 24}, {0, 2, 46}};
    bvx_labels_options o = {.struct_size = sizeof o};

    for (int trial = 0; trial < 12; trial++) {
        static int32_t const noise_cuts[4][3] = {{5, 0, 0}, {0, 6, 0}, {0, 0, 4}, {4, 7, 5}};
        for (int32_t i = 0; i < 12 * 11 * 10; i++) cells[i] = (uint8_t)below(trial % 3 == 0 ? 2 : 5);
        o.triangles = trial % 2 == 0 ? 0 : 1;
        check_joined(cells, small, noise_cuts[trial / 3], o, 0);
    }
    o.triangles = 0;
    fill_cells();
    for (int i = 0; i < 4; i++) check_joined(cells, wide, cuts[i], o, 0);
    for (int32_t n = 0; n < SIDE * SIDE * SIDE; n++)
        if (n % SIDE + n / SIDE % SIDE + n / SIDE / SIDE < 24) cells[n] = 0;
    for (uint64_t i = 0; i < 3; i++) {
        o.triangles = 0;
        check_joined(cells, wide, cuts[i], o, 0.001);
        o.triangles = 4000 + 1000 * i;
        check_joined(cells, wide, cuts[i], o, 0.01);
    }
}

/* ---- Refusals ---- */

static void test_labels_refuse(void)
{
    float const real = 1;
    uint8_t const whole = 1;
    bvx_volume_view v = view_of(&real, BVX_SAMPLE_F32, 1, 1, 1);
    bvx_labels_options o = {.struct_size = sizeof o};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_label_surfaces(ctx, &v, NULL, &complex_));
    v = view_of(&whole, BVX_SAMPLE_U8, 1, 1, 1);
    o.background = 256;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_surfaces(ctx, &v, &o, &complex_));
    o.background = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_surfaces(ctx, &v, &o, &complex_));
    o = (bvx_labels_options){.struct_size = sizeof o, .triangles = 9, .error = 1};
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_surfaces(ctx, &v, &o, &complex_));
    o.triangles = 0;
    o.staircase = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_surfaces(ctx, &v, &o, &complex_));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_surfaces(ctx, &v, NULL, NULL));
    make(&v, 1, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_label_mesh(ctx, &complex_, 1, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_mesh(ctx, NULL, 0, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_mesh(ctx, &complex_, 0, NULL));

    /* Arrays that the library did not make. */
    bvx_complex const brought = {.sides = complex_.sides};
    bvx_complex given = brought;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_surfaces(ctx, &v, NULL, &given));
    TEST_ASSERT_EQUAL_PTR(brought.sides, given.sides);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_labels_of_all_partitions_of_a_cell_are_bodies);
    RUN_TEST(test_labels_of_all_pairs_of_cells_are_bodies);
    RUN_TEST(test_labels_of_noise_are_the_faces_of_its_voxels);
    RUN_TEST(test_labels_are_the_same_for_all_threads);
    RUN_TEST(test_labels_of_any_type_order_and_sign);
    RUN_TEST(test_labels_of_a_window_lie_in_the_world);
    RUN_TEST(test_labels_smoothed_stay_in_cells_and_keep_volumes);
    RUN_TEST(test_labels_smoothed_touch_themselves_in_no_edge);
    RUN_TEST(test_labels_smoothed_collapse_no_triangle);
    RUN_TEST(test_labels_smoothed_stay_near_planes);
    RUN_TEST(test_labels_smoothed_are_a_ball);
    RUN_TEST(test_blocks_of_noise_become_fewer_triangles);
    RUN_TEST(test_labels_with_fewer_triangles_are_bodies);
    RUN_TEST(test_labels_with_a_tenth_of_the_triangles_leave_no_gap);
    RUN_TEST(test_labels_of_open_windows_join);
    RUN_TEST(test_labels_refuse);
    return UNITY_END();
}
