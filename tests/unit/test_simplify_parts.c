/* test_simplify_parts.c - what simplifying is made of, against slow ways: corners against their neighbours, every
 * invariant of a collapse after sweeps, judging and undoing, all of it undone against the mesh as it was opened, and
 * crossings against all pairs. */
#include "collapse_support.h"

/* ---- Meshes with everything ---- */

enum { MOST_UVS = 60000 };

static float uv[2 * MOST_UVS];
static uint32_t uv_index[3 * MOST_UVS], material[MOST_UVS];

/* Charts and materials by boxes of space, and slits: corners whose texture coordinates are their own. */
static bvx_mesh_view parted_view(int slits, int materials)
{
    bvx_mesh_view view = maker_view(&mesh);
    uint32_t const own = (uint32_t)mesh.vertices * 4;

    TEST_ASSERT_TRUE(own + 200 < MOST_UVS && mesh.triangles < MOST_UVS);
    for (uint32_t i = 0; i < own + 200; i++) {
        uint32_t const v = i < own ? i % (uint32_t)mesh.vertices : 0;

        uv[2 * i] = (float)(mesh.p[3 * v] + i / (double)mesh.vertices);
        uv[2 * i + 1] = (float)(mesh.p[3 * v + 1] + mesh.p[3 * v + 2]);
    }
    for (size_t t = 0; t < mesh.triangles; t++) {
        const double *const p = mesh.p + 3 * (size_t)mesh.t[3 * t];
        uint32_t const chart = (uint32_t)(p[0] * 0.7 + 2 * floor(p[1] * 0.4)) % 4;

        material[t] = (uint32_t)(p[2] * 0.5) % 3;
        for (size_t k = 0; k < 3; k++)
            uv_index[3 * t + k] = chart * (uint32_t)mesh.vertices + mesh.t[3 * t + k];
    }

    /* A slit along an edge: its corners on one side. A vertex alone, or one whose neighbours have none, is an end. */
    for (uint32_t i = 0; i < 200 && slits; i++) {
        uint32_t const t = (uint32_t)maker_below(&seed, (int32_t)mesh.triangles);

        uv_index[3 * t + i % 3] = own + i;
    }
    view.uvs = uv;
    view.uv_count = own + 200;
    view.uv_indices = uv_index;
    if (materials) view.materials = material;
    return view;
}

/* Two walls much nearer to each other than a level's triangles are long. */
static void make_thin(double jitter)
{
    static const double centre[3] = {8, 8, 8}, outer[3] = {4, 3, 2}, inner[3] = {3.98, 2.98, 1.98};
    size_t first;

    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, outer, jitter, 40, 60, 1 << 20);
    first = mesh.triangles;
    maker_star(&mesh, &seed, centre, inner, jitter, 40, 60, 1 << 20);
    maker_flip(&mesh, first, mesh.triangles);
}

/* Without some of its triangles; vertices where fans meet are parted when it is opened. */
static void make_holes(void)
{
    for (int i = 0; i < 60; i++) maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

static void make_kind(int kind)
{
    static const char *const names[] = {"torus", "cylinder", "two plates", "spikes", "bent plates"};

    if (kind < 5) make_shape(shape_named(names[kind]));
    else make_thin(kind == 6 ? 0.003 : 0);
    if (kind % 2 == 1) make_holes();
}

enum { KINDS = 7, WAYS = 6 };

/* The mesh in one of many ways: plain, with lines, kept vertices, locked ones. */
static void open_way(int kind, int way, bvxi_collapse_options *o)
{
    static uint8_t locked[MOST_UVS];
    bvx_mesh_view view;

    make_kind(kind);
    *o = collapse_options();
    view = way == 0 || way == 4 ? maker_view(&mesh) : parted_view(way >= 2, way == 3 || way == 5);
    if (way == 4) o->given.vertices = BVX_VERTICES_KEPT;
    if (way == 5) {
        o->given.lock_border = 1;
        for (size_t v = 0; v < mesh.vertices; v++) locked[v] = maker_below(&seed, 20) == 0;
        o->given.locked = locked;
    }
    snprintf(where, sizeof where, "kind %d, way %d", kind, way);
    open_view(&view, o);
}

/* ---- Corners ---- */

static void test_corners_face_each_other(void)
{
    for (int i = 0; i < LEVEL_SHAPES; i++) {
        bvxi_collapse_options o = collapse_options();
        bvx_mesh_view view;

        make_shape(&level_shapes[i]);
        o.borders = BVXI_BORDERS_REFUSED;
        view = maker_view(&mesh);
        snprintf(where, sizeof where, "%s", level_shapes[i].name);
        open_view(&view, &o);
        check_neighbours(&collapse->mesh);
        check_fans(collapse);
        TEST_ASSERT_EQUAL_UINT64(0, collapse->mesh.ghosts);
        for (int32_t c = 0; c < (int32_t)(4 * collapse->mesh.triangles); c += (c & 3) == 2 ? 2 : 1) {
            TEST_ASSERT_EQUAL_UINT32(
                bvxi_corner_vertex_of(&collapse->mesh, c),
                bvxi_corner_vertex_of(&collapse->mesh, bvxi_corner_turn_left(&collapse->mesh, c)));
            TEST_ASSERT_EQUAL_INT32(c, bvxi_corner_next(bvxi_corner_previous(c)));
        }
        close_view();
    }
}

/* ---- Sweeps ---- */

static void test_sweeps_keep_every_invariant(void)
{
    for (int kind = 0; kind < KINDS; kind++)
        for (int way = kind % 3; way < WAYS; way += 3) { /* each kind and each way has some */
            bvxi_collapse_options o;
            uint64_t target, all = 0;

            open_way(kind, way, &o);
            check_collapse(collapse);
            target = collapse->mesh.left / 12;
            for (int idle = 0; idle < 8 && collapse->mesh.left > target;) {
                uint64_t done = 0, before = collapse->mesh.left;

                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_sweep(collapse, target, idle, &done));
                snprintf(where, sizeof where, "kind %d, way %d, %d triangles", kind, way,
                         (int)collapse->mesh.left);
                check_collapse(collapse);
                idle = done == 0 ? idle + 1 : 0;
                all += done;
                TEST_ASSERT_TRUE_MESSAGE(collapse->mesh.left <= before && collapse->mesh.left + 2 > target,
                                         where);
            }
            /* Locked vertices and slits everywhere leave little. */
            TEST_ASSERT_TRUE_MESSAGE(all > (way == 5 ? 0 : 50), where);
            close_view();
        }
}

/* ---- Undoing ---- */

/* What undoing must bring back. */
typedef struct opened_state {
    bvxi_corner_triangle *triangle;
    bvxi_corner_vertex *at;
    uint32_t *row;
} opened_state;

static opened_state remember(const bvxi_collapse *c)
{
    uint64_t const triangles = c->mesh.triangles + c->mesh.ghosts;
    opened_state s = {NULL, NULL, NULL};

    s.triangle = maker_grow(NULL, (size_t)triangles * sizeof *s.triangle);
    s.at = maker_grow(NULL, (size_t)c->mesh.vertices * sizeof *s.at);
    memcpy(s.triangle, c->mesh.triangle, (size_t)triangles * sizeof *s.triangle);
    memcpy(s.at, c->mesh.at, (size_t)c->mesh.vertices * sizeof *s.at);
    if (c->attributes.row != NULL) {
        s.row = maker_grow(NULL, (size_t)triangles * 16);
        memcpy(s.row, c->attributes.row, (size_t)triangles * 16);
    }
    return s;
}

static void assert_as_opened(const bvxi_collapse *c, const opened_state *s)
{
    for (uint64_t t = 0; t < c->mesh.triangles + c->mesh.ghosts; t++) {
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(s->triangle[t].vertex, c->mesh.triangle[t].vertex, 12, where);
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(s->triangle[t].left, c->mesh.triangle[t].left, 12, where);
        if (s->row != NULL)
            TEST_ASSERT_EQUAL_MEMORY_MESSAGE(s->row + 4 * t, c->attributes.row + 4 * t, 12, where);
    }
    for (uint64_t v = 0; v < c->mesh.vertices; v++)
        TEST_ASSERT_EQUAL_MEMORY_MESSAGE(s->at[v].p, c->mesh.at[v].p, 24, where);
}

static void forget(opened_state *s)
{
    free(s->triangle);
    free(s->at);
    free(s->row);
}

/* A vertex at random into which one went; or BVXI_VERTEX_NONE. */
static uint32_t any_collapsed(const bvxi_collapse *c)
{
    uint32_t const n = (uint32_t)c->mesh.vertices, begin = (uint32_t)maker_below(&seed, (int32_t)n);

    for (uint32_t i = 0; i < n; i++) {
        uint32_t const v = (begin + i) % n;

        if (!bvxi_collapse_is_gone(c, v) && c->last[v] != BVXI_VERTEX_NONE) return c->last[v];
    }
    return BVXI_VERTEX_NONE;
}

/* Collapses at random are undone, more follow, and in the end all are undone. */
static void test_undoing_brings_the_mesh_back(void)
{
    for (int kind = 0; kind < KINDS; kind++)
        for (int way = kind % 3; way < WAYS; way += 3) { /* each kind and each way has some */
            bvxi_collapse_options o;
            opened_state opened;
            uint32_t went;

            open_way(kind, way, &o);
            opened = remember(collapse);
            for (int round = 0; round < 6; round++) {
                uint64_t done, target = collapse->mesh.left / 2;

                for (int i = 0; i < 6; i++)
                    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_sweep(collapse, target, i, &done));
                for (int i = 0; i < 60 && (went = any_collapsed(collapse)) != BVXI_VERTEX_NONE; i++) {
                    uint64_t const alive = collapse->alive;
                    uint32_t const back = bvxi_collapse_undo(collapse, went);

                    TEST_ASSERT_TRUE_MESSAGE(!bvxi_collapse_is_gone(collapse, back), where);
                    TEST_ASSERT_EQUAL_UINT64_MESSAGE(alive + 1, collapse->alive, where);
                }
                snprintf(where, sizeof where, "kind %d, way %d, round %d, %d triangles", kind, way, round,
                         (int)collapse->mesh.left);
                check_collapse(collapse);
            }
            while ((went = any_collapsed(collapse)) != BVXI_VERTEX_NONE) bvxi_collapse_undo(collapse, went);
            snprintf(where, sizeof where, "kind %d, way %d, all undone", kind, way);
            check_collapse(collapse);
            assert_as_opened(collapse, &opened);
            forget(&opened);
            close_view();
        }
}

/* ---- Judging ---- */

/* After a level was judged it crosses nothing where the mesh did not, and is whole. */
static void test_judging_leaves_no_crossings(void)
{
    uint64_t all = 0;

    for (int kind = 2; kind < KINDS; kind += 1)
        for (int way = kind % 2 == 0 ? 0 : kind; way < WAYS; way += WAYS) { /* without and with attributes */
            bvxi_collapse_options o;
            uint64_t undone, done, before;
            uint32_t *pairs;

            open_way(kind, way, &o);
            before = plain_pairs(&collapse->mesh, &pairs);
            free(pairs);
            for (int round = 0; round < 3; round++) {
                uint64_t const target = collapse->mesh.left / 3;

                for (int i = 0; i < 12; i++)
                    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_sweep(collapse, target, i / 2, &done));
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_judge(collapse, 0.0, 1.0, &undone));
                all += undone;
                snprintf(where, sizeof where, "kind %d, way %d, round %d, %d undone", kind, way, round,
                         (int)undone);
                check_collapse(collapse);

                /* Those that follow are looked at one by one. */
                for (int i = 0; i < 8; i++)
                    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_sweep(collapse, target, i, &done));
                snprintf(where, sizeof where, "kind %d, way %d, round %d, %d undone, one by one", kind, way,
                         round, (int)undone);
                check_collapse(collapse);
                bvxi_collapse_end_careful(collapse);
                if (before == 0)
                    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, plain_pairs(&collapse->mesh, &pairs), where);
                free(before == 0 ? pairs : NULL);
            }
            close_view();
        }
    TEST_ASSERT_TRUE(all > 100);
}

/* ---- Crossings ---- */

static crossing_tree tree_of(const bvxi_collapse *c)
{
    crossing_tree tree;

    memset(&tree, 0, sizeof tree);
    tree.at = c->mesh.at[0].p;
    tree.vertex = c->mesh.triangle[0].vertex;
    tree.at_step = sizeof *c->mesh.at / sizeof *tree.at;
    tree.vertex_step = sizeof *c->mesh.triangle / sizeof *tree.vertex;
    tree.triangles = c->mesh.triangles;
    tree.scale = c->scale;
    memcpy(tree.low, c->low, sizeof tree.low);
    return tree;
}

static void assert_pairs(const uint32_t *wanted, uint64_t wanted_count, const uint32_t *pairs, uint64_t count)
{
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(wanted_count, count, where);
    if (count != 0) TEST_ASSERT_EQUAL_MEMORY_MESSAGE(wanted, pairs, (size_t)count * 8, where);
}

/* Of pairs, those with a vertex that is marked, in place; returns how many. */
static uint64_t keep_fresh(const bvxi_corners *m, const uint8_t *fresh, uint32_t *pairs, uint64_t count)
{
    uint64_t kept = 0;

    for (uint64_t i = 0; i < count; i++) {
        int any = 0;

        for (int k = 0; k < 6; k++) any |= fresh[m->triangle[pairs[2 * i + (k > 2)]].vertex[k % 3]];
        if (any) memmove(pairs + 2 * kept++, pairs + 2 * i, 8);
    }
    return kept;
}

/* All of a tree's pairs, those with a fresh vertex, and those of one triangle, with either kind of boxes. */
static uint64_t check_crossings(const bvxi_collapse *c)
{
    crossing_tree tree = tree_of(c);
    uint32_t *wanted, *pairs;
    uint64_t const wanted_count = plain_pairs(&c->mesh, &wanted);
    uint8_t *const fresh = maker_grow(NULL, (size_t)c->mesh.vertices);
    uint64_t count;

    for (tree.slanted = 0; tree.slanted < 2; tree.slanted++) {
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_crossing_tree_open(ctx, &tree));
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvxi_crossings_find(ctx, &tree, 0.0, 1.0, UINT64_MAX, &pairs, &count));
        assert_pairs(wanted, wanted_count, pairs, count);
        bvxi_drop(ctx, pairs);
        for (uint64_t i = 0; i < wanted_count && tree.slanted; i++)
            TEST_ASSERT_TRUE(bvxi_crossing_pair(&tree, wanted[2 * i], wanted[2 * i + 1]) &&
                             bvxi_crossing_pair(&tree, wanted[2 * i + 1], wanted[2 * i]));
        bvxi_drop(ctx, tree.node[0]);
    }
    for (uint64_t v = 0; v < c->mesh.vertices; v++) fresh[v] = maker_below(&seed, 8) == 0;
    tree.slanted = 1;
    tree.fresh = fresh;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_crossing_tree_open(ctx, &tree));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_crossings_find(ctx, &tree, 0.0, 1.0, UINT64_MAX, &pairs, &count));
    assert_pairs(wanted, keep_fresh(&c->mesh, fresh, wanted, wanted_count), pairs, count);
    bvxi_drop(ctx, pairs);
    bvxi_drop(ctx, tree.node[0]);
    free(fresh);
    free(wanted);
    return wanted_count;
}

/* Triangles of random vertices; the corner table is of triangles alone. */
static void test_crossings_of_random_triangles_equal_all_pairs(void)
{
    uint64_t found = 0;

    for (int round = 0; round < (long_run ? 60 : 15); round++) {
        static bvxi_corner_vertex at[500];
        static bvxi_corner_triangle triangle[700];
        bvxi_collapse c;
        uint32_t const vertices = (uint32_t)maker_below(&seed, 490) + 4;
        int32_t const steps = round % 3 == 0 ? 6 : 1 << 16;

        memset(&c, 0, sizeof c);
        c.mesh.at = at;
        c.mesh.triangle = triangle;
        c.mesh.vertices = vertices;
        c.mesh.triangles = (uint64_t)maker_below(&seed, 690) + 1;
        c.scale = 1 / 15.0;
        for (uint32_t v = 0; v < vertices; v++)
            for (int k = 0; k < 3; k++) at[v].p[k] = maker_between(&seed, 0, 15, steps);
        for (uint64_t t = 0; t < c.mesh.triangles; t++) {
            uint32_t const first = (uint32_t)maker_below(&seed, (int32_t)vertices);

            for (uint32_t k = 0; k < 3; k++) {
                triangle[t].vertex[k] = (first + k * (1 + (uint32_t)maker_below(&seed, 3))) % vertices;
                triangle[t].cost[k] = maker_below(&seed, 10) == 0 && k == 0 ? -1.0f : 0.0f;
            }
        }
        snprintf(where, sizeof where, "round %d", round);
        found += check_crossings(&c);
    }
    TEST_ASSERT_TRUE(found > 1000);
}

/* Meshes and what becomes of them without judging; vertices whose fans are flat are left out, others are not. */
static void test_crossings_of_levels_equal_all_pairs(void)
{
    uint64_t found = 0;

    for (int kind = 0; kind < KINDS; kind++) {
        bvxi_collapse_options o;

        open_way(kind, 0, &o);
        for (int round = 0; round < 3; round++) {
            uint64_t done, count, wanted_count;
            uint32_t *wanted;
            bvx_mesh made = {0};
            bvx_mesh_view view;

            for (int i = 0; i < 12; i++)
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_sweep(collapse, collapse->mesh.left / 2,
                                                                    round == 0 ? 0 : i / 2, &done));
            snprintf(where, sizeof where, "kind %d, round %d", kind, round);
            found += check_crossings(collapse);
            wanted_count = plain_pairs(&collapse->mesh, &wanted);
            free(wanted);

            /* With what is known of fans. */
            collapse->judged = 0;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_crossings(collapse, &count));
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(wanted_count, count, where);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_give_plain(collapse, &made));
            bvx_mesh_view_of(&made, &view);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(wanted_count, count, where);
            bvx_mesh_free(ctx, &made);
        }
        close_view();
    }
    TEST_ASSERT_TRUE(found > 100);
}

/* ---- Boxes that follow ---- */

typedef struct visited {
    uint8_t *seen;
    uint64_t count;
} visited;

static int visit_one(void *user, uint32_t t)
{
    visited *const v = user;

    TEST_ASSERT_EQUAL_UINT8_MESSAGE(0, v->seen[t], "a triangle twice");
    v->seen[t] = 1;
    v->count++;
    return 0;
}

/* Vertices move; each triangle is requested what it crosses, against all of them. */
static void test_boxes_follow_what_moves(void)
{
    crossing_tree tree;
    bvxi_collapse_options o;
    uint8_t *seen;
    uint64_t found = 0;

    open_way(0, 0, &o);
    tree = tree_of(collapse);
    tree.slanted = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_crossing_tree_open(ctx, &tree));
    seen = maker_grow(NULL, (size_t)collapse->mesh.triangles);
    for (int round = 0; round < 400; round++) {
        uint32_t const v = (uint32_t)maker_below(&seed, (int32_t)collapse->mesh.vertices);
        uint32_t const t = (uint32_t)collapse->any[v] >> 2;
        const uint32_t *const w = collapse->mesh.triangle[t].vertex;
        const double *const p[3] = {collapse->mesh.at[w[0]].p, collapse->mesh.at[w[1]].p,
                                    collapse->mesh.at[w[2]].p};
        visited found_here = {seen, 0};
        uint64_t wanted = 0;
        int32_t at = collapse->any[v];

        for (int k = 0; k < 3; k++) collapse->mesh.at[v].p[k] += maker_between(&seed, -1, 1, 1 << 16);
        do {
            bvxi_crossing_tree_move(&tree, (uint32_t)at >> 2);
            at = bvxi_corner_turn_left(&collapse->mesh, at);
        } while (at != collapse->any[v]);

        memset(seen, 0, (size_t)collapse->mesh.triangles);
        bvxi_crossing_tree_visit(&tree, p, BVXI_VERTEX_NONE, BVXI_VERTEX_NONE, NULL, NULL, visit_one,
                                 &found_here);
        snprintf(where, sizeof where, "round %d", round);
        for (uint64_t s = 0; s < collapse->mesh.triangles; s++) {
            if (s == t) continue; /* a triangle crosses itself */
            TEST_ASSERT_EQUAL_INT_MESSAGE(plain_cross(&collapse->mesh, s, t), seen[s], where);
            wanted += seen[s];
        }
        found += wanted;
    }
    snprintf(where, sizeof where, "%d found", (int)found);
    TEST_ASSERT_TRUE_MESSAGE(found > 100, where);
    free(seen);
    bvxi_drop(ctx, tree.node[0]);
    close_view();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_corners_face_each_other);
    RUN_TEST(test_sweeps_keep_every_invariant);
    RUN_TEST(test_undoing_brings_the_mesh_back);
    RUN_TEST(test_judging_leaves_no_crossings);
    RUN_TEST(test_crossings_of_random_triangles_equal_all_pairs);
    RUN_TEST(test_crossings_of_levels_equal_all_pairs);
    RUN_TEST(test_boxes_follow_what_moves);
    return UNITY_END();
}
