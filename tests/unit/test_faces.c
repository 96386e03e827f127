/* test_faces.c - the mesh of exposed voxel faces against a list made face
 * by face, and merged ones against a greedy cut of single squares. */
#include "solid_support.h"

#include <math.h>

/* ---- Grids ---- */

static bvx_grid noise_grid(bvx_context *c, const bvx_lattice *l, const bvx_window *w, int32_t one_in)
{
    bvx_grid g = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(c, l, w, &g));
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.size[0]; x++)
                bvx_grid_set(&g, x, y, z, one_in > 0 && maker_below(&seed, one_in) == 0);
    return g;
}

/* Overlapping boxes: large flat faces. */
static bvx_grid boxes_grid(bvx_context *c, const bvx_lattice *l, int32_t count)
{
    bvx_grid g = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(c, l, NULL, &g));
    for (int32_t n = 0; n < count; n++) {
        int32_t low[3], high[3];
        int const value = n == 0 || maker_below(&seed, 3) != 0;
        for (int a = 0; a < 3; a++) {
            int32_t const p = maker_below(&seed, g.size[a] + 1), q = maker_below(&seed, g.size[a] + 1);
            low[a] = p < q ? p : q;
            high[a] = p < q ? q : p;
        }
        for (int32_t z = low[2]; z < high[2]; z++)
            for (int32_t y = low[1]; y < high[1]; y++)
                for (int32_t x = low[0]; x < high[0]; x++) bvx_grid_set(&g, x, y, z, value);
    }
    return g;
}

static int voxel_at(const bvx_grid *g, const int32_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] < 0 || at[a] >= g->size[a]) return 0;
    return bvx_grid_get(g, at[0], at[1], at[2]);
}

static int32_t open_sides; /* of all faces that are made and wanted */

/* 1: a voxel is at an open side, so that its faces are a neighbour's. */
static int is_neighbours(const bvx_grid *g, const int32_t at[3])
{
    int found = 0;

    for (int a = 0; a < 3; a++)
        found |= ((open_sides >> 2 * a & 1) != 0 && at[a] == 0) ||
                 ((open_sides >> (2 * a + 1) & 1) != 0 && at[a] == g->size[a] - 1);
    return found;
}

/* +1, -1: the side of the normal of the face across an axis whose low corner is `at`; 0: not exposed. */
static int side_of_face(const bvx_grid *g, const int32_t at[3], int axis)
{
    int32_t before[3] = {at[0], at[1], at[2]};
    before[axis]--;
    int const side = voxel_at(g, before) - voxel_at(g, at);
    return is_neighbours(g, side > 0 ? before : at) ? 0 : side;
}

/* ---- What is expected: rectangles of corners ---- */

typedef struct face_want {
    int32_t low[3]; /* the low corner */
    int32_t axis, side, size_u, size_v;
} face_want;

typedef struct face_list {
    face_want *face;
    size_t count;
} face_list;

static void want_face(face_list *list, const int32_t low[3], int axis, int side, int32_t size_u,
                      int32_t size_v)
{
    list->face = maker_grow(list->face, (list->count + 1) * sizeof *list->face);
    memcpy(list->face[list->count].low, low, sizeof list->face->low);
    list->face[list->count].axis = axis;
    list->face[list->count].side = side;
    list->face[list->count].size_u = size_u;
    list->face[list->count++].size_v = size_v;
}

static face_list single_list(const bvx_grid *g)
{
    face_list list = {NULL, 0};
    int32_t at[3];

    for (at[2] = 0; at[2] <= g->size[2]; at[2]++)
        for (at[1] = 0; at[1] <= g->size[1]; at[1]++)
            for (at[0] = 0; at[0] <= g->size[0]; at[0]++)
                for (int axis = 0; axis < 3; axis++)
                    if (side_of_face(g, at, axis) != 0)
                        want_face(&list, at, axis, side_of_face(g, at, axis), 1, 1);
    return list;
}

/* Squares of one plane and side, taken one by one. */
static void merge_plane(const bvx_grid *g, int axis, int32_t plane, int side, face_list *list)
{
    int const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    int32_t const nu = g->size[u], nv = g->size[v];
    uint8_t *const left = maker_grow(NULL, (size_t)nu * (size_t)nv);
    int32_t at[3];

    at[axis] = plane;
    for (int32_t b = 0; b < nv; b++)
        for (int32_t a = 0; a < nu; a++) {
            at[u] = a;
            at[v] = b;
            left[b * nu + a] = side_of_face(g, at, axis) == side;
        }
    for (int32_t b = 0; b < nv; b++)
        for (int32_t a = 0; a < nu; a++) {
            int32_t end = a, last = b;
            if (!left[b * nu + a]) continue;
            while (end < nu && left[b * nu + end]) end++;
            for (int whole = 1; whole && last < nv; last += whole)
                for (int32_t i = a; i < end; i++) whole = whole && left[last * nu + i];
            for (int32_t j = b; j < last; j++)
                for (int32_t i = a; i < end; i++) left[j * nu + i] = 0;
            at[u] = a;
            at[v] = b;
            want_face(list, at, axis, side, end - a, last - b);
        }
    free(left);
}

static face_list merged_list(const bvx_grid *g)
{
    face_list list = {NULL, 0};
    for (int axis = 0; axis < 3; axis++)
        for (int32_t plane = 0; plane <= g->size[axis]; plane++) {
            merge_plane(g, axis, plane, -1, &list);
            merge_plane(g, axis, plane, 1, &list);
        }
    return list;
}

/* ---- Comparison ---- */

static bvx_mesh faces_of(bvx_context *c, const bvx_grid *g, int32_t merged, int32_t type, int32_t local)
{
    bvx_faces_options o = {.struct_size = sizeof o};
    bvx_mesh m = {0};

    o.merged = merged;
    o.open_sides = open_sides;
    o.position_type = type;
    o.local_frame = local;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_faces(c, g, &o, &m), bvx_last_message(c));
    return m;
}

/* The lattice corner of a vertex: positions are where the lattice has them. */
static void corner_of(const bvx_grid *g, const bvx_mesh *m, uint64_t vertex, int32_t corner[3])
{
    for (int a = 0; a < 3; a++) {
        double const p = m->position_type == BVX_F32
                             ? (double)((const float *)m->positions)[3 * vertex + (uint64_t)a]
                             : ((const double *)m->positions)[3 * vertex + (uint64_t)a];
        double const world = p + m->frame[a], spacing = g->lattice.spacing[a];
        double const index = floor((world - g->lattice.origin[a]) / spacing - g->low[a] + 0.5);
        double const want = (m->frame[a] != 0 ? 0 : g->lattice.origin[a]) + (g->low[a] + index) * spacing;
        corner[a] = (int32_t)index;
        TEST_ASSERT_TRUE(p == (m->position_type == BVX_F32 ? (double)(float)want : want));
    }
}

/* Face n is the wanted rectangle, its two triangles turn about its normal and share a diagonal. */
static void assert_face(const bvx_grid *g, const bvx_mesh *m, uint64_t n, const face_want *want)
{
    int const u = want->axis == 0 ? 1 : 0, v = want->axis == 2 ? 1 : 2;
    const uint32_t *const t = m->triangles + 6 * n;
    int32_t c[6][3];
    uint32_t seen = 0;

    for (int i = 0; i < 6; i++) {
        int at_u, at_v;
        corner_of(g, m, t[i], c[i]);
        TEST_ASSERT_EQUAL_INT32(want->low[want->axis], c[i][want->axis]);
        at_u = c[i][u] == want->low[u] + want->size_u;
        at_v = c[i][v] == want->low[v] + want->size_v;
        TEST_ASSERT_TRUE(at_u || c[i][u] == want->low[u]);
        TEST_ASSERT_TRUE(at_v || c[i][v] == want->low[v]);
        seen |= 1u << (at_u + 2 * at_v + (i < 3 ? 0 : 4));
    }
    TEST_ASSERT_EQUAL_UINT32(0xf, (seen | seen >> 4) & 0xf); /* all four corners */
    for (int i = 0; i < 6; i += 3) { /* twice the area, with its sign about the axis */
        int const p = (want->axis + 1) % 3, q = (want->axis + 2) % 3;
        int32_t const area = (c[i + 1][p] - c[i][p]) * (c[i + 2][q] - c[i][q]) -
                             (c[i + 1][q] - c[i][q]) * (c[i + 2][p] - c[i][p]);
        TEST_ASSERT_EQUAL_INT32(want->side * want->size_u * want->size_v, area);
    }
    TEST_ASSERT_EQUAL_UINT32(t[0], t[3]); /* the diagonal */
    TEST_ASSERT_TRUE(t[2] == t[4] || t[1] == t[5]);
}

static void assert_faces(bvx_context *c, const bvx_grid *g, int32_t merged, int32_t type, int32_t local)
{
    face_list const list = merged ? merged_list(g) : single_list(g);
    bvx_mesh m = faces_of(c, g, merged, type, local);
    int32_t last[3] = {-1, -1, -1};
    uint8_t *const used = maker_grow(NULL, (size_t)m.vertex_count + 1);

    TEST_ASSERT_EQUAL_UINT64(2 * (uint64_t)list.count, m.triangle_count);
    memset(used, 0, (size_t)m.vertex_count + 1);
    for (uint64_t n = 0; n < list.count; n++) assert_face(g, &m, n, &list.face[n]);
    for (uint64_t i = 0; i < 3 * m.triangle_count; i++) {
        TEST_ASSERT_TRUE(m.triangles[i] < m.vertex_count);
        used[m.triangles[i]] = 1;
    }
    for (uint64_t i = 0; i < m.vertex_count; i++) { /* each used, each once, by (z, y, x) */
        int32_t at[3];
        TEST_ASSERT_TRUE(used[i]);
        corner_of(g, &m, i, at);
        TEST_ASSERT_TRUE(at[2] > last[2] ||
                         (at[2] == last[2] && (at[1] > last[1] || (at[1] == last[1] && at[0] > last[0]))));
        memcpy(last, at, sizeof last);
    }
    free(list.face);
    free(used);
    bvx_mesh_free(c, &m);
}

static const int32_t shapes[][3] = {{7, 6, 5},  {64, 3, 4},  {63, 4, 3}, {65, 5, 2}, {130, 2, 3},
                                    {3, 70, 4}, {4, 128, 2}, {2, 3, 66}, {1, 1, 1},  {1, 9, 1},
                                    {9, 1, 1},  {1, 1, 9},   {70, 65, 1}};
enum { SHAPES = sizeof shapes / sizeof *shapes };

static void check_faces_of(int32_t merged)
{
    static const int32_t threads[] = {1, 2, 3, 8};

    for (int32_t trial = 0; trial < (quick ? 13 : 156); trial++) {
        const int32_t *const s = shapes[trial % SHAPES];
        bvx_lattice const l = lattice_of(s[0], s[1], s[2]);
        bvx_context *const c = suite_context(threads[trial / SHAPES % 4],
                                             trial % 2 ? BVX_CPU_PORTABLE : BVX_CPU_BEST);
        int32_t const kind = trial / SHAPES % 5;
        bvx_grid g = kind == 0   ? noise_grid(c, &l, NULL, 2)
                     : kind == 1 ? noise_grid(c, &l, NULL, 1)
                     : kind == 2 ? noise_grid(c, &l, NULL, 0)
                                 : boxes_grid(c, &l, 4 + trial % 7);
        assert_faces(c, &g, merged, trial % 3 == 0 ? BVX_F64 : BVX_F32, 0);
        bvx_grid_free(c, &g);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(c));
        bvx_context_destroy(c);
    }
}

static void test_each_exposed_face_is_there_once(void)
{
    check_faces_of(0);
}

static void test_merged_faces_are_a_greedy_cut(void)
{
    check_faces_of(1);
}

/* A lattice somewhere in the world, stretched, a window of it; positions relative to its origin. */
static void test_faces_of_windows_lie_in_the_world(void)
{
    for (int32_t trial = 0; trial < 40; trial++) {
        double const origin[3] = {-17.25, 1000.5, 3}, spacing[3] = {0.1, 0.25, 3};
        int32_t const dims[3] = {90, 20, 15};
        bvx_window const w = {{5 + trial, 3, 2}, {1 + trial % 40, 9, 8}};
        bvx_lattice l;
        bvx_grid g;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
        g = noise_grid(ctx, &l, &w, 3);
        for (int32_t how = 0; how < 8; how++)
            assert_faces(ctx, &g, how & 1, (how & 2) != 0 ? BVX_F64 : BVX_F32, how >> 2);
        bvx_grid_free(ctx, &g);
    }
}

/* Closed, and as large as its voxels, whatever touches; merged ones enclose the same volume. */
static void test_certificates(void)
{
    for (int32_t trial = 0; trial < (quick ? 4 : 24); trial++) {
        bvx_lattice const l = lattice_of(40, 30, 20);
        bvx_grid g = trial % 2 == 0 ? boxes_grid(ctx, &l, 6) : noise_grid(ctx, &l, NULL, 2 + trial % 5);
        double const volume = (double)set_voxels(&g);
        for (int32_t merged = 0; merged < 2; merged++) {
            bvx_mesh m = faces_of(ctx, &g, merged, BVX_F32, 0);
            bvx_certificate c;
            bvx_mesh_view view;
            bvx_mesh_view_of(&m, &view);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
            if (volume > 0 && !merged) TEST_ASSERT_EQUAL_INT32(1, c.closed);
            if (volume > 0 && !merged)
                TEST_ASSERT_EQUAL_UINT64(0,
                                         c.boundary_edges + c.unused_vertices + c.duplicates + c.degenerate);
            TEST_ASSERT_TRUE(fabs(c.volume - volume) < 1e-6 * (volume + 1));
            bvx_mesh_free(ctx, &m);
        }
        bvx_grid_free(ctx, &g);
    }
}

/* By hand: two voxels side by side are a box of ten faces, six when merged;
 * along an edge they are not manifold. */
static void test_two_voxels(void)
{
    bvx_lattice const l = lattice_of(4, 4, 4);
    bvx_grid g = noise_grid(ctx, &l, NULL, 0);
    bvx_certificate c;
    bvx_mesh_view view;
    bvx_mesh m;

    bvx_grid_set(&g, 1, 1, 1, 1);
    bvx_grid_set(&g, 2, 1, 1, 1);
    m = faces_of(ctx, &g, 0, BVX_F32, 0);
    TEST_ASSERT_EQUAL_UINT64(12, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(20, m.triangle_count);
    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented && c.volume == 2.0);
    bvx_mesh_free(ctx, &m);
    m = faces_of(ctx, &g, 1, BVX_F32, 0);
    TEST_ASSERT_EQUAL_UINT64(8, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(12, m.triangle_count);
    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented && c.volume == 2.0);
    bvx_mesh_free(ctx, &m);
    bvx_grid_set(&g, 2, 1, 1, 0);
    bvx_grid_set(&g, 2, 2, 1, 1);
    m = faces_of(ctx, &g, 0, BVX_F32, 0);
    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_UINT64(14, m.vertex_count);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_EQUAL_UINT64(1, c.nonmanifold_edges);
    TEST_ASSERT_TRUE(c.closed && !c.edge_manifold);
    bvx_mesh_free(ctx, &m);
    bvx_grid_free(ctx, &g);
}

/* The bytes do not depend on threads. */
static void test_threads_change_nothing(void)
{
    bvx_lattice const l = lattice_of(150, 140, 130);
    bvx_grid g = boxes_grid(ctx, &l, 9);

    for (int32_t merged = 0; merged < 2; merged++) {
        uint64_t want = 0;
        for (int32_t threads = 1; threads <= 8; threads++) {
            bvx_context *const c = suite_context(threads, BVX_CPU_BEST);
            bvx_mesh m = faces_of(c, &g, merged, BVX_F32, 0);
            uint64_t hash;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(c, &m, &hash));
            if (threads == 1) want = hash;
            TEST_ASSERT_EQUAL_HEX64(want, hash);
            bvx_mesh_free(c, &m);
            bvx_context_destroy(c);
        }
    }
    bvx_grid_free(ctx, &g);
}

/* Arrays of the caller's are filled; one too few is refused. */
static void test_fills_the_callers_arrays(void)
{
    bvx_lattice const l = lattice_of(20, 9, 9);
    bvx_grid g = noise_grid(ctx, &l, NULL, 2);

    for (int32_t merged = 0; merged < 2; merged++) {
        bvx_mesh const own = faces_of(ctx, &g, merged, BVX_F32, 0);
        bvx_mesh m = {0}, mine = own;
        float *const p = maker_grow(NULL, (size_t)own.vertex_count * 12);
        uint32_t *const t = maker_grow(NULL, (size_t)own.triangle_count * 12);
        bvx_faces_options o = {.struct_size = sizeof o};
        o.merged = merged;
        m.positions = p;
        m.triangles = t;
        m.position_type = BVX_F32;
        m.vertex_capacity = own.vertex_count;
        m.triangle_capacity = own.triangle_count - 1;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_extract_faces(ctx, &g, &o, &m));
        m.triangle_capacity++;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_faces(ctx, &g, &o, &m));
        TEST_ASSERT_EQUAL_PTR(p, m.positions);
        TEST_ASSERT_EQUAL_INT(0, memcmp(p, own.positions, (size_t)own.vertex_count * 12));
        TEST_ASSERT_EQUAL_INT(0, memcmp(t, own.triangles, (size_t)own.triangle_count * 12));
        bvx_mesh_free(ctx, &mine);
        free(p);
        free(t);
    }
    bvx_grid_free(ctx, &g);
}

static void assert_faces_refused(const bvx_grid *g, const bvx_faces_options *o, bvx_status want,
                                 const char *word)
{
    bvx_mesh m = {0};
    TEST_ASSERT_EQUAL_INT32(want, bvx_extract_faces(ctx, g, o, &m));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_NULL(m.positions);
}

static void test_refusals(void)
{
    double const far[3] = {500000, 5000000, 0}, near[3] = {0, 0, 0}, fine[3] = {0.01, 0.01, 0.01};
    int32_t const dims[3] = {9, 9, 9};
    bvx_lattice l;
    bvx_faces_options o;
    bvx_grid g;
    bvx_mesh m = {0};

    for (int32_t merged = 0; merged < 2; merged++) {
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, far, fine, dims, &l));
        g = noise_grid(ctx, &l, NULL, 2);
        o = (bvx_faces_options){.struct_size = sizeof o};
        o.merged = merged;
        o.position_type = BVX_F32;
        assert_faces_refused(&g, &o, BVX_ERR_RANGE, "f32");
        o.position_type = BVX_F64;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_faces(ctx, &g, &o, &m));
        bvx_mesh_free(ctx, &m);
        o.position_type = BVX_F32;
        o.local_frame = 1;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_faces(ctx, &g, &o, &m));
        TEST_ASSERT_EQUAL_MEMORY(far, m.frame, sizeof far);
        bvx_mesh_free(ctx, &m);
        bvx_grid_free(ctx, &g);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, near, fine, dims, &l));
    g = noise_grid(ctx, &l, NULL, 2);
    for (int32_t field = 0; field < 4; field++) {
        static const char *const words[] = {"position_type", "merged", "local_frame", "open_sides"};
        o = (bvx_faces_options){.struct_size = sizeof o};
        *(field == 0   ? &o.position_type
          : field == 1 ? &o.merged
          : field == 2 ? &o.local_frame
                       : &o.open_sides) = field == 3 ? 64 : 3;
        assert_faces_refused(&g, &o, BVX_ERR_ARGUMENT, words[field]);
    }
    for (o.open_sides = 0, o.merged = 0; o.merged < 2; o.merged++) {
        g.words[g.words_per_row * 80] |= UINT64_C(1) << 9; /* the last row's first bit past the nine voxels */
        assert_faces_refused(&g, &o, BVX_ERR_ARGUMENT, "bits set past the 9 voxels");
        g.words[g.words_per_row * 80] ^= UINT64_C(1) << 9;
    }
    assert_faces_refused(NULL, NULL, BVX_ERR_ARGUMENT, "grid");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_faces(ctx, &g, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_faces(NULL, &g, NULL, &m));
    bvx_grid_free(ctx, &g);
}

/* Any sides open, of any grid; and chunks with a voxel of each neighbour have all faces of the whole, each once. */
static void test_faces_of_neighbours_are_left_to_them(void)
{
    enum { CHUNK = 24 };
    int32_t const dims[3] = {2 * CHUNK + 23, 2 * CHUNK, CHUNK + 5};
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    bvx_lattice l;
    uint64_t sum = 0;

    for (int round = 0; round < 24; round++) {
        int32_t const size[3] = {1 + maker_below(&seed, round < 8 ? 70 : 9), 1 + maker_below(&seed, 9),
                                 1 + maker_below(&seed, 9)};

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, size, &l));
        bvx_grid g = round % 2 == 0 ? noise_grid(ctx, &l, NULL, 2) : boxes_grid(ctx, &l, 3);
        open_sides = maker_below(&seed, 64);
        for (int32_t merged = 0; merged < 2; merged++) assert_faces(ctx, &g, merged, BVX_F64, 0);
        bvx_grid_free(ctx, &g);
    }

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    bvx_grid whole = noise_grid(ctx, &l, NULL, 3);
    open_sides = 0;
    bvx_mesh all = faces_of(ctx, &whole, 0, BVX_F64, 0);
    for (int32_t z = 0; z < dims[2]; z += CHUNK)
        for (int32_t y = 0; y < dims[1]; y += CHUNK)
            for (int32_t x = 0; x < dims[0]; x += CHUNK) {
                int32_t const begin[3] = {x, y, z};
                bvx_window w;
                bvx_grid chunk = {0};

                open_sides = 0;
                for (int a = 0; a < 3; a++) {
                    int const low = begin[a] > 0, high = begin[a] + CHUNK < dims[a];

                    open_sides |= low << 2 * a | high << (2 * a + 1);
                    w.low[a] = begin[a] - low;
                    w.size[a] = (high ? begin[a] + CHUNK + 1 : dims[a]) - w.low[a];
                }
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(ctx, &whole, &w, &chunk));
                bvx_mesh m = faces_of(ctx, &chunk, 0, BVX_F64, 0);
                sum += m.triangle_count;
                bvx_mesh_free(ctx, &m);
                bvx_grid_free(ctx, &chunk);
            }
    open_sides = 0;
    TEST_ASSERT_EQUAL_UINT64(all.triangle_count, sum);
    bvx_mesh_free(ctx, &all);
    bvx_grid_free(ctx, &whole);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_exposed_face_is_there_once);
    RUN_TEST(test_merged_faces_are_a_greedy_cut);
    RUN_TEST(test_faces_of_windows_lie_in_the_world);
    RUN_TEST(test_certificates);
    RUN_TEST(test_two_voxels);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_fills_the_callers_arrays);
    RUN_TEST(test_faces_of_neighbours_are_left_to_them);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
