/* test_simplify_parts.c - what simplifying is made of, against slow ways: the queue of edges against a list,
 * the boxes of triangles against all of them, corners against connecting anew, what a collapse changes and
 * whether it crosses against all pairs; and that what is known of a mesh changes nothing. */
#include "levels_support.h"
#include "mesh/cross.h"
#include "simplify/box_tree.h"
#include "simplify/corners.h"
#include "simplify/queue.h"
#include "simplify/star.h"

/* ---- The queue ---- */

enum { QUEUE_ENTRIES = 20000, QUEUE_CHUNKS = QUEUE_ENTRIES / BVXI_QUEUE_CHUNK + BVXI_QUEUE_HEADS + 2 };

static int32_t queue_head[BVXI_QUEUE_HEADS];
static bvxi_queue_chunk queue_chunk[QUEUE_CHUNKS];
/* the list that stands for it; buckets as they count: no lower than where it stands */
static bvxi_queue_entry waiting[QUEUE_ENTRIES];
static int32_t waiting_count;

static bvxi_queue open_queue(int32_t batch)
{
    bvxi_queue q;

    memset(&q, 0, sizeof q);
    q.head = queue_head;
    q.chunk = queue_chunk;
    q.chunks = QUEUE_CHUNKS;
    q.batch = batch;
    bvxi_queue_clear(&q);
    waiting_count = 0;
    return q;
}

static void put_waiting(bvxi_queue *q, double cost)
{
    static uint32_t stamp;
    bvxi_queue_entry const e = {(int32_t)(stamp % 1000), stamp, bvxi_queue_bucket(cost)};

    stamp++;
    TEST_ASSERT_TRUE(e.bucket >= 0 && e.bucket < BVXI_QUEUE_FINE);
    bvxi_queue_put(q, &e);
    waiting[waiting_count] = e;
    if (e.bucket / BVXI_QUEUE_SPAN < q->coarse) waiting[waiting_count].bucket = q->coarse * BVXI_QUEUE_SPAN;
    waiting_count++;
    TEST_ASSERT_TRUE(q->used <= q->chunks);
}

/* What is taken waits in the list, and nothing there is cheaper: to the
 * fine bucket, or where it is parted by batches to the coarse one. */
static int take_waiting(bvxi_queue *q, int32_t step)
{
    bvxi_queue_entry e = {0, 0, 0};
    int32_t at = -1, lowest = INT32_MAX;

    if (!bvxi_queue_take(q, &e)) return 0;
    for (int32_t i = 0; i < waiting_count; i++) {
        if (waiting[i].bucket / step < lowest) lowest = waiting[i].bucket / step;
        if (waiting[i].stamp == e.stamp && waiting[i].corner == e.corner) at = i;
    }
    TEST_ASSERT_TRUE_MESSAGE(at >= 0, "taken twice, or never put");
    TEST_ASSERT_EQUAL_INT32(lowest, waiting[at].bucket / step);
    waiting[at] = waiting[--waiting_count];
    return 1;
}

static double any_cost(void)
{
    return ldexp(1 + maker_below(&seed, 1000) / 1000.0, maker_below(&seed, 24) - 30);
}

static void check_queue(int32_t batch, int32_t step)
{
    bvxi_queue q = open_queue(batch);
    int32_t taken = 0, put = 0;

    for (int i = 0; i < 1500; i++, put++) put_waiting(&q, any_cost());
    /* new ones come while others go, some cheaper than all that wait */
    for (int round = 0; round < 3000; round++) {
        if (maker_below(&seed, 3) != 0) taken += take_waiting(&q, step);
        else {
            put_waiting(&q, maker_below(&seed, 10) == 0 ? 0 : any_cost());
            put++;
        }
    }
    while (take_waiting(&q, step)) taken++;
    TEST_ASSERT_EQUAL_INT32(put, taken);
    TEST_ASSERT_EQUAL_INT32(0, waiting_count);
    put_waiting(&q, 5); /* it goes on when it was empty */
    TEST_ASSERT_EQUAL_INT(1, take_waiting(&q, step));
    TEST_ASSERT_EQUAL_INT(0, take_waiting(&q, step));
}

static void test_queue_gives_the_cheapest(void)
{
    check_queue(INT32_MAX, 1);
    check_queue(1, BVXI_QUEUE_SPAN);
    check_queue(7, BVXI_QUEUE_SPAN);
    check_queue(100, BVXI_QUEUE_SPAN);
}

/* As many chunks as collapse.c makes are enough for its entries, whatever
 * their costs; those given back serve again. */
static void test_queue_needs_no_more_chunks_than_there_are(void)
{
    bvxi_queue q = open_queue(INT32_MAX);
    for (int i = 0; i < QUEUE_ENTRIES; i++)
        put_waiting(&q, ldexp(1, maker_below(&seed, 250) - 125) * (1 + maker_below(&seed, 64) / 64.0));
    TEST_ASSERT_TRUE(q.used <= QUEUE_CHUNKS);
    for (int i = 0; i < 300; i++) take_waiting(&q, 1);
    for (int i = 0; i < 300; i++) put_waiting(&q, any_cost());
    TEST_ASSERT_TRUE(q.used <= QUEUE_CHUNKS);
}

static void test_buckets_rise_with_cost(void)
{
    static const double ends[] = {0,    -1,   -0.0,  1e-300,           1e-45,      1e-38, 1,
                                  1e38, 3e38, 1e300, (double)INFINITY, (double)NAN};
    int32_t before = 0;

    for (size_t i = 0; i < sizeof ends / sizeof *ends; i++) {
        int32_t const bucket = bvxi_queue_bucket(ends[i]);
        TEST_ASSERT_TRUE(bucket >= 0 && bucket < BVXI_QUEUE_FINE);
    }
    TEST_ASSERT_EQUAL_INT32(0, bvxi_queue_bucket(0));
    for (double cost = 1e-37; cost < 1e37; cost *= 1.003) {
        int32_t const bucket = bvxi_queue_bucket(cost);
        TEST_ASSERT_TRUE(bucket >= before);
        /* what collapse.c counts with */
        TEST_ASSERT_EQUAL_INT32(bucket + BVXI_QUEUE_OCTAVE, bvxi_queue_bucket(2 * cost));
        before = bucket;
    }
}

/* ---- Corner tables of the test's own ---- */

static bvxi_corners table;
static uint64_t table_vertices, table_triangles; /* that there is room for */

static void open_table(void)
{
    table_vertices = table.vertices = mesh.vertices;
    table_triangles = table.triangles = table.left = mesh.triangles;
    table.at = maker_grow(NULL, mesh.vertices * sizeof *table.at);
    table.triangle = maker_grow(NULL, mesh.triangles * sizeof *table.triangle);
    table.facing = maker_grow(NULL, mesh.vertices * sizeof *table.facing);
    memset(table.at, 0, mesh.vertices * sizeof *table.at);
    memset(table.facing, 0, mesh.vertices * sizeof *table.facing);
    for (size_t v = 0; v < mesh.vertices; v++) memcpy(table.at[v].p, mesh.p + 3 * v, 24);
    for (size_t t = 0; t < mesh.triangles; t++) memcpy(table.triangle[t].vertex, mesh.t + 3 * t, 12);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvxi_corners_connect(ctx, "test", &table, BVXI_BORDERS_REFUSED),
                                    bvx_last_message(ctx));
}

static void close_table(void)
{
    free(table.at);
    free(table.triangle);
    free(table.facing);
    memset(&table, 0, sizeof table);
}

/* Connecting the vertices that the table has now gives the adjacency that it has. */
static void assert_connected(void)
{
    bvxi_corners fresh = table;

    fresh.triangle = maker_grow(NULL, (size_t)table.triangles * sizeof *fresh.triangle);
    for (uint64_t t = 0; t < table.triangles; t++)
        memcpy(fresh.triangle[t].vertex, table.triangle[t].vertex, 12);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvxi_corners_connect(ctx, "test", &fresh, BVXI_BORDERS_REFUSED),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(table.triangles, table.left);
    TEST_ASSERT_EQUAL_INT(
        0, memcmp(fresh.triangle, table.triangle, (size_t)table.triangles * sizeof *fresh.triangle));
    free(fresh.triangle);
}

static void test_corners_face_each_other(void)
{
    for (int i = 0; i < LEVEL_SHAPES; i++) {
        make_shape(&level_shapes[i]);
        open_table();
        for (int32_t t = 0; t < (int32_t)table.triangles; t++)
            for (int32_t c = 4 * t; c < 4 * t + 3; c++) {
                int32_t const o = bvxi_corner_opposite(&table, c);
                TEST_ASSERT_EQUAL_INT32(c, bvxi_corner_opposite(&table, o));
                TEST_ASSERT_EQUAL_UINT32(bvxi_corner_vertex_of(&table, bvxi_corner_next(c)),
                                         bvxi_corner_vertex_of(&table, bvxi_corner_previous(o)));
                TEST_ASSERT_EQUAL_UINT32(bvxi_corner_vertex_of(&table, c),
                                         bvxi_corner_vertex_of(&table, bvxi_corner_turn_left(&table, c)));
                TEST_ASSERT_EQUAL_INT32(c, bvxi_corner_next(bvxi_corner_previous(c)));
            }
        close_table();
    }
}

/* ---- Collapses ---- */

static bvxi_star star;
static bvxi_box_tree boxes;

static void open_boxes(void)
{
    double size = 0;

    for (size_t a = 0; a < 3; a++) {
        double low = mesh.p[a], high = mesh.p[a];
        for (size_t v = 0; v < mesh.vertices; v++) {
            if (mesh.p[3 * v + a] < low) low = mesh.p[3 * v + a];
            if (mesh.p[3 * v + a] > high) high = mesh.p[3 * v + a];
        }
        boxes.low[a] = low;
        if (high - low > size) size = high - low;
    }
    boxes.scale = BVXI_BOX_HIGHEST / size;
    boxes.faces = 1;
    bvxi_box_tree_lay_out(&boxes, mesh.triangles,
                          maker_grow(NULL, (size_t)bvxi_box_tree_bytes(mesh.triangles)));
    bvxi_box_tree_set(&boxes, &table);
}

static void close_boxes(void)
{
    free(boxes.node[0]);
    memset(&boxes, 0, sizeof boxes);
}

static int has(int32_t t, uint32_t v)
{
    const uint32_t *const c = table.triangle[t].vertex;
    return c[0] == v || c[1] == v || c[2] == v;
}

static int is_gone(int32_t t)
{
    return table.triangle[t].vertex[0] == BVXI_VERTEX_NONE;
}

/* How many vertices are joined by an edge to both. */
static int32_t common_neighbours(uint32_t u, uint32_t v)
{
    static uint8_t of[2][1 << 16];
    int32_t both = 0;

    TEST_ASSERT_TRUE(table_vertices <= sizeof of[0]);
    memset(of, 0, sizeof of);
    for (int32_t t = 0; t < (int32_t)table.triangles; t++)
        for (int k = 0; k < 3 && !is_gone(t); k++) {
            if (has(t, u)) of[0][table.triangle[t].vertex[k]] = 1;
            if (has(t, v)) of[1][table.triangle[t].vertex[k]] = 1;
        }
    for (uint64_t w = 0; w < table_vertices; w++) both += w != u && w != v && of[0][w] && of[1][w];
    return both;
}

/* What the star says against all triangles: each that has one of the ends but not both is there once. */
static void assert_star(int32_t edge)
{
    int32_t expected = 0;

    for (int32_t t = 0; t < (int32_t)table.triangles; t++)
        expected += !is_gone(t) && has(t, star.u) != has(t, star.v);
    TEST_ASSERT_EQUAL_INT32(edge, star.edge);
    TEST_ASSERT_EQUAL_INT32(expected, star.count);
    TEST_ASSERT_EQUAL_UINT32(star.link[0], star.link[star.count]);
    for (int32_t i = 0; i < star.count; i++) {
        int32_t const c = star.corner[i];
        uint32_t const of = bvxi_corner_vertex_of(&table, c);
        TEST_ASSERT_TRUE(of == star.u || of == star.v);
        TEST_ASSERT_EQUAL_UINT32(star.link[i], bvxi_corner_vertex_of(&table, bvxi_corner_next(c)));
        TEST_ASSERT_EQUAL_UINT32(star.link[i + 1], bvxi_corner_vertex_of(&table, bvxi_corner_previous(c)));
        for (int32_t j = 0; j < i; j++) TEST_ASSERT_TRUE(star.corner[j] >> 2 != c >> 2);
    }
}

static void drop_one(int32_t corner)
{
    bvxi_corners_join(&table, bvxi_corner_opposite(&table, bvxi_corner_next(corner)),
                      bvxi_corner_opposite(&table, bvxi_corner_previous(corner)));
    table.triangle[corner >> 2].vertex[0] = BVXI_VERTEX_NONE;
    table.left--;
    if (boxes.levels != 0) bvxi_box_tree_remove(&boxes, corner >> 2);
}

static void apply(void)
{
    int32_t const across = bvxi_corner_opposite(&table, star.edge);

    memcpy(table.at[star.u].p, star.p, sizeof star.p);
    drop_one(star.edge);
    drop_one(across);
    for (int32_t i = 0; i < star.count; i++) {
        table.triangle[star.corner[i] >> 2].vertex[star.corner[i] & 3] = star.u;
        if (boxes.levels == 0) continue;
        table.facing[star.link[i]] = star.facing[i];
        bvxi_box_tree_move(&boxes, star.corner[i] >> 2, &star.box[i], &star.faces[i]);
    }
    if (boxes.levels != 0) table.facing[star.u] = star.own_facing;
}

static int32_t any_edge(void)
{
    int32_t t;
    do t = maker_below(&seed, (int32_t)table.triangles);
    while (is_gone(t));
    return 4 * t + maker_below(&seed, 3);
}

/* Edges at random collapse, wherever that joins nothing; now and then the table is packed. */
static void test_packed_corners_are_as_if_connected_anew(void)
{
    static const char *const names[] = {"torus", "cylinder", "two plates", "frame"};

    for (size_t n = 0; n < sizeof names / sizeof *names; n++) {
        uint64_t collapsed = 0, refused = 0;
        uint32_t *moved;
        make_shape(shape_named(names[n]));
        open_table();
        moved = maker_grow(NULL, mesh.vertices * sizeof *moved);
        for (int round = 0; round < 1500 && table.left > 20; round++) {
            int32_t const edge = any_edge();
            int const good = bvxi_star_gather(&table, edge, &star);
            /* the link condition, where the ends' triangles are not all the mesh */
            if (round % 16 == 0 || !good) {
                int32_t const both = common_neighbours(
                    bvxi_corner_vertex_of(&table, bvxi_corner_next(edge)),
                    bvxi_corner_vertex_of(&table, bvxi_corner_previous(edge)));
                if (good || star.count >= 3) TEST_ASSERT_EQUAL_INT(both == 2, good);
            }
            refused += !good;
            if (!good) continue;
            assert_star(edge);
            memcpy(star.p, table.at[star.u].p, sizeof star.p);
            apply();
            collapsed++;
            if (maker_below(&seed, 40) != 0) continue;
            {
                uint64_t const vertices = table.vertices, left = table.left;
                bvxi_corner_vertex *const before = maker_grow(NULL, (size_t)vertices * sizeof *before);
                uint32_t last = 0;
                memcpy(before, table.at, (size_t)vertices * sizeof *before);
                bvxi_corners_pack(&table, moved);
                TEST_ASSERT_EQUAL_UINT64(left, table.triangles);
                for (uint64_t v = 0; v < vertices; v++) { /* in order, each with what it had */
                    if (moved[v] == BVXI_VERTEX_NONE) continue;
                    TEST_ASSERT_TRUE(moved[v] == last && moved[v] < table.vertices);
                    TEST_ASSERT_EQUAL_MEMORY(&before[v], &table.at[moved[v]], sizeof before[v]);
                    last++;
                }
                TEST_ASSERT_EQUAL_UINT64(table.vertices, last);
                assert_connected();
                free(before);
            }
        }
        TEST_ASSERT_TRUE(collapsed > 200 && refused > 0);
        free(moved);
        close_table();
    }
}

/* ---- Boxes ---- */

static bvxi_box any_box(int32_t most)
{
    bvxi_box b;
    for (int a = 0; a < 3; a++) {
        b.low[a] = (int16_t)maker_below(&seed, BVXI_BOX_HIGHEST + 1);
        b.high[a] = (int16_t)(b.low[a] + maker_below(&seed, most) > BVXI_BOX_HIGHEST
                                  ? BVXI_BOX_HIGHEST
                                  : b.low[a] + maker_below(&seed, most));
        if (b.high[a] < b.low[a]) b.high[a] = b.low[a];
    }
    return b;
}

static int overlap(const bvxi_box *a, const bvxi_box *b)
{
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->high[k] || b->low[k] > a->high[k]) return 0;
    return 1;
}

static bvxi_box_facing any_facing(void)
{
    bvxi_box_facing f;
    for (int a = 0; a < 3; a++) f.low[a] = f.high[a] = (int8_t)(maker_below(&seed, 255) - 127);
    return f;
}

/* Every node's child faces all that what is below it faces; of triangles that are gone nothing is known. */
static void assert_facings_grow(const bvxi_box_facing *facing, const uint8_t *gone)
{
    for (size_t t = 0; t < mesh.triangles; t++)
        for (uint64_t l = 0, i = t; l < (uint64_t)boxes.levels && !gone[t]; l++, i /= BVXI_BOX_WIDTH) {
            const bvxi_box_node *const node = &boxes.node[l][i / BVXI_BOX_WIDTH];
            for (int a = 0; a < 3; a++)
                TEST_ASSERT_TRUE(node->facing_low[a][i % BVXI_BOX_WIDTH] <= facing[t].low[a] &&
                                 node->facing_high[a][i % BVXI_BOX_WIDTH] >= facing[t].high[a]);
        }
}

/* What eight children face along a direction, against one by one. */
static void test_facings_of_eight_children_equal_one_by_one(void)
{
    for (int round = 0; round < 20000; round++) {
        bvxi_box_node node;
        bvxi_box_direction d;
        uint32_t expected = 0;
        for (int a = 0; a < 3; a++) d.along[a] = (int16_t)(maker_below(&seed, 127) - 63);
        d.margin = (int16_t)maker_below(&seed, 105);
        for (int32_t k = 0; k < BVXI_BOX_WIDTH; k++) {
            bvxi_box_facing f = any_facing();
            int least = 0;
            for (int a = 0; a < 3; a++) {
                if (round % 3 == 0) f.low[a] = INT8_MIN;
                else
                    f.low[a] = (int8_t)(f.low[a] - maker_below(&seed, 10) < INT8_MIN
                                            ? INT8_MIN
                                            : f.low[a] - maker_below(&seed, 10));
                if (f.low[a] > f.high[a]) f.low[a] = f.high[a];
                least += d.along[a] * (d.along[a] < 0 ? f.high[a] : f.low[a]);
            }
            bvxi_box_put_facing(&node, k, &f);
            expected |= (uint32_t)(least > d.margin) << k;
        }
        TEST_ASSERT_EQUAL_UINT32(expected, bvxi_box_faces(&node, &d));
    }
}

/* Every triangle that the tree finds, once. */
static void find_all(const bvxi_box *box, uint8_t *found)
{
    static uint64_t stack[BVXI_BOX_STACK];
    bvxi_box_query const q = bvxi_box_ask(box);
    int32_t depth = 0;

    stack[depth++] = (uint64_t)(boxes.levels - 1);
    while (depth > 0) {
        uint64_t const top = stack[--depth], index = top >> 4, level_of = top & 15;
        uint32_t const bits = bvxi_box_overlaps(&boxes.node[level_of][index], &q);
        for (int32_t k = 0; k < BVXI_BOX_WIDTH; k++) {
            uint64_t const child = index * BVXI_BOX_WIDTH + (uint64_t)k;
            if ((bits >> k & 1) == 0) continue;
            if (level_of == 0) {
                TEST_ASSERT_EQUAL_UINT8(0, found[child]);
                found[child] = 1;
            } else {
                TEST_ASSERT_TRUE(depth < BVXI_BOX_STACK && child < boxes.count[level_of - 1]);
                stack[depth++] = child << 4 | (level_of - 1);
            }
        }
    }
}

static void test_boxes_find_what_all_triangles_show(void)
{
    enum { MOST = 1 << 16 };
    static bvxi_box now[MOST];
    static bvxi_box_facing facing[MOST];
    static uint8_t gone[MOST], found[MOST + BVXI_BOX_WIDTH];
    for (int n = 0; n < LEVEL_SHAPES; n += 2) {
        make_shape(&level_shapes[n]);
        while (n == 4 && mesh.triangles > 7) maker_remove(&mesh, 0); /* one node */
        if (n != 4) open_table();
        else {
            memset(&table, 0, sizeof table);
            table.triangles = mesh.triangles;
            table.at = maker_grow(NULL, mesh.vertices * sizeof *table.at);
            table.triangle = maker_grow(NULL, mesh.triangles * sizeof *table.triangle);
            for (size_t v = 0; v < mesh.vertices; v++) memcpy(table.at[v].p, mesh.p + 3 * v, 24);
            for (size_t t = 0; t < mesh.triangles; t++) memcpy(table.triangle[t].vertex, mesh.t + 3 * t, 12);
        }
        open_boxes();
        TEST_ASSERT_EQUAL_UINT64(1, boxes.count[boxes.levels - 1]);
        memset(gone, 0, sizeof gone);
        for (size_t t = 0; t < mesh.triangles; t++)
            facing[t] = bvxi_box_facing_at(mesh.p + 3 * (size_t)mesh.t[3 * t],
                                           mesh.p + 3 * (size_t)mesh.t[3 * t + 1],
                                           mesh.p + 3 * (size_t)mesh.t[3 * t + 2]);
        assert_facings_grow(facing, gone);
        for (size_t t = 0; t < mesh.triangles; t++)
            now[t] = bvxi_box_of(&boxes, mesh.p + 3 * (size_t)mesh.t[3 * t],
                                 mesh.p + 3 * (size_t)mesh.t[3 * t + 1],
                                 mesh.p + 3 * (size_t)mesh.t[3 * t + 2]);
        for (int round = 0; round < 600; round++) {
            int32_t const t = maker_below(&seed, (int32_t)mesh.triangles);
            bvxi_box const query = any_box(round % 2 == 0 ? 2000 : 30000);
            if (!gone[t] && maker_below(&seed, 4) == 0) {
                bvxi_box_tree_remove(&boxes, t);
                gone[t] = 1;
            } else if (!gone[t]) {
                now[t] = any_box(5000);
                facing[t] = any_facing();
                bvxi_box_tree_move(&boxes, t, &now[t], &facing[t]);
            }
            memset(found, 0, sizeof found);
            find_all(&query, found);
            for (size_t i = 0; i < sizeof found; i++)
                TEST_ASSERT_EQUAL_INT(i < mesh.triangles && !gone[i] && overlap(&query, &now[i]), found[i]);
        }
        assert_facings_grow(facing, gone);
        close_boxes();
        close_table();
    }
}

/* Rounded down to steps, what overlaps still does, inside the first bounds and outside of them. */
static void test_steps_of_boxes_keep_overlaps(void)
{
    make_shape(shape_named("sphere"));
    open_table();
    open_boxes();
    for (int i = 0; i < 20000; i++) {
        double p[6][3];
        bvxi_box a, b;
        int apart = 0;
        for (int k = 0; k < 18; k++) p[k / 3][k % 3] = maker_between(&seed, 0, 16, i % 2 == 0 ? 4 : 1 << 20);
        a = bvxi_box_of(&boxes, p[0], p[1], p[2]);
        b = bvxi_box_of(&boxes, p[3], p[4], p[5]);
        for (int k = 0; k < 3; k++) {
            double const a_low = fmin(p[0][k], fmin(p[1][k], p[2][k]));
            double const a_high = fmax(p[0][k], fmax(p[1][k], p[2][k]));
            double const b_low = fmin(p[3][k], fmin(p[4][k], p[5][k]));
            double const b_high = fmax(p[3][k], fmax(p[4][k], p[5][k]));
            apart |= a_low > b_high || b_low > a_high;
        }
        if (!apart) TEST_ASSERT_TRUE(overlap(&a, &b));
    }
    close_boxes();
    close_table();
}

/* ---- Verdicts ---- */

/* All of one lies lower along an axis than all of the other. */
static int beside(const double *const p[3], const double *const q[3])
{
    for (int k = 0; k < 3; k++) {
        if (p[0][k] < q[0][k] && p[0][k] < q[1][k] && p[0][k] < q[2][k] && p[1][k] < q[0][k] &&
            p[1][k] < q[1][k] && p[1][k] < q[2][k] && p[2][k] < q[0][k] && p[2][k] < q[1][k] &&
            p[2][k] < q[2][k])
            return 1;
    }
    return 0;
}

/* Does one of the new triangles cross another new one, or one that stays? All pairs. */
static int new_ones_cross(void)
{
    for (int32_t i = 0; i < star.count; i++) {
        const double *const p[3] = {star.p, table.at[star.link[i]].p, table.at[star.link[i + 1]].p};
        for (int32_t j = 0; j < i; j++) {
            const double *const q[3] = {star.p, table.at[star.link[j]].p, table.at[star.link[j + 1]].p};
            if (bvxi_triangles_cross_exact(p, q)) return 1;
        }
        for (int32_t t = 0; t < (int32_t)table.triangles; t++) {
            const uint32_t *const c = table.triangle[t].vertex;
            const double *q[3];
            if (is_gone(t) || has(t, star.u) || has(t, star.v)) continue;
            for (int k = 0; k < 3; k++) q[k] = table.at[c[k]].p;
            if (!beside(p, q) && !beside(q, p) && bvxi_triangles_cross_exact(p, q)) return 1;
        }
    }
    return 0;
}

/* New vertices anywhere near their edges: what is judged safe crosses nothing, what is said to cross does.
 * The mesh gets worse and worse by it, so every kind of fan comes by. */
static void check_verdicts(const char *name, double spread, int32_t floats, uint64_t verdicts[5],
                           uint64_t sheets[2])
{
    uint32_t *pieces;
    int one;

    make_shape(shape_named(name));
    open_table();
    open_boxes();
    pieces = maker_grow(NULL, table_vertices * sizeof *pieces);
    one = bvxi_corners_pieces(&table, pieces) == 1;
    free(pieces);
    for (int round = 0; round < (quick ? 150 : 500) && table.left > 30; round++) {
        int32_t const edge = any_edge();
        double length = 0;
        int verdict;
        if (!bvxi_star_gather(&table, edge, &star)) continue;
        for (int k = 0; k < 3; k++) length += fabs(table.at[star.u].p[k] - table.at[star.v].p[k]);
        for (int k = 0; k < 3; k++) {
            double const middle = 0.5 * (table.at[star.u].p[k] + table.at[star.v].p[k]);
            star.p[k] = middle + spread * length * (maker_below(&seed, 2001) - 1000) / 1000;
            if (floats) star.p[k] = (double)(float)star.p[k];
        }
        if (round % 5 == 0) memcpy(star.p, table.at[star.u].p, sizeof star.p); /* an end, as for flat parts */
        boxes.faces = 0;
        verdict = bvxi_star_judge(&table, &boxes, &star);
        boxes.faces = 1;
        TEST_ASSERT_TRUE(verdict >= BVXI_STAR_SAFE && verdict <= BVXI_STAR_CROSSES);
        verdicts[verdict]++;
        snprintf(where, sizeof where, "%s, spread %g, round %d: verdict %d", name, spread, round, verdict);
        if (verdict == BVXI_STAR_CROSSES) TEST_ASSERT_TRUE_MESSAGE(new_ones_cross(), where);
        if (verdict == BVXI_STAR_SAFE || verdict == BVXI_STAR_CROSSES) {
            bvxi_box all = bvxi_box_at(&boxes, star.p);
            int sheet;
            for (int32_t i = 0; i < star.count; i++) {
                bvxi_box const at = bvxi_box_at(&boxes, table.at[star.link[i]].p);
                bvxi_box_join(&all, &at);
            }
            sheet = bvxi_star_is_one_sheet(&table, &boxes, &star, &all);
            sheets[sheet] += (uint64_t)one;
            if (sheet && one) TEST_ASSERT_EQUAL_INT_MESSAGE(BVXI_STAR_SAFE, verdict, where);
        }
        if (verdict != BVXI_STAR_SAFE) continue;
        TEST_ASSERT_FALSE_MESSAGE(new_ones_cross(), where);
        for (int32_t i = 0; i < star.count; i++) {
            double n[3], part = 0;
            bvxi_area_normal(star.p, table.at[star.link[i]].p, table.at[star.link[i + 1]].p, n);
            for (int k = 0; k < 3; k++) part += n[k] * n[k];
            TEST_ASSERT_TRUE_MESSAGE(part > 0, where);
        }
        apply();
    }
    close_boxes();
    close_table();
}

static void test_verdicts_equal_all_pairs(void)
{
    uint64_t verdicts[5] = {0, 0, 0, 0, 0}, sheets[2] = {0, 0};

    for (int i = 0; i < LEVEL_SHAPES; i++)
        for (int n = 0; n < 3; n++)
            check_verdicts(level_shapes[i].name, n == 0 ? 0.05 : n == 1 ? 0.3 : 1.5, n % 2, verdicts, sheets);
    for (int k = 0; k < 5; k++) {
        snprintf(where, sizeof where, "verdict %d: %lu times", k, (unsigned long)verdicts[k]);
        if (k != BVXI_STAR_LINK) TEST_ASSERT_TRUE_MESSAGE(verdicts[k] > 5, where);
    }
    snprintf(where, sizeof where, "one sheet: %lu times, not: %lu", (unsigned long)sheets[1],
             (unsigned long)sheets[0]);
    TEST_ASSERT_TRUE_MESSAGE(sheets[0] > 100 && sheets[1] > 100, where);
}

/* ---- A mesh that is known not to cross itself ---- */

static uint64_t collapse_known(int32_t simple, uint64_t target, bvx_mesh *result)
{
    bvxi_collapse_options const o = {.position_type = BVX_F64, .even = 1e-9, .simple = simple};
    bvx_mesh_view const view = maker_view(&mesh);
    bvxi_collapse *collapse;
    uint64_t crossed;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_open(ctx, "test", &view, &o, &collapse));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_to(collapse, target, target, 0, 1));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_give(collapse, result));
    crossed = bvxi_collapse_tried(collapse)->crossed;
    bvxi_collapse_close(collapse);
    return crossed;
}

/* The same bytes, whether it is known or not. Returns how often an edge
 * stayed since triangles would have crossed. */
static uint64_t assert_known_is_the_same(const char *name, uint64_t target)
{
    bvx_mesh known = {0}, tested = {0};
    bvx_mesh_view view;
    uint64_t crossings = 1, crossed;

    crossed = collapse_known(1, target, &known);
    snprintf(where, sizeof where, "%s to %lu", name, (unsigned long)target);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(crossed, collapse_known(0, target, &tested), where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(tested.vertex_count, known.vertex_count, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(tested.triangle_count, known.triangle_count, where);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(tested.positions, known.positions, (size_t)known.vertex_count * 24,
                                     where);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(tested.triangles, known.triangles, (size_t)known.triangle_count * 12,
                                     where);
    bvx_mesh_view_of(&known, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &crossings, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, crossings, where);
    bvx_mesh_free(ctx, &known);
    bvx_mesh_free(ctx, &tested);
    return crossed;
}

static void test_proofs_of_no_crossing_change_no_verdict(void)
{
    static const double centre[3] = {1, 2, 3}, outer[3] = {4, 3, 2}, inner[3] = {3.98, 2.98, 1.98};
    uint64_t crossed = 0;
    for (int i = 0; i < LEVEL_SHAPES; i++) {
        make_shape(&level_shapes[i]);
        for (uint64_t part = 2; part < 32; part *= 4)
            crossed += assert_known_is_the_same(level_shapes[i].name, mesh.triangles / part);
    }
    TEST_ASSERT_TRUE(crossed > 0);

    /* Two shells, one in the other, that face the same way: what is near faces one way and would cross. */
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, outer, 0, 40, 60, 1 << 20);
    maker_star(&mesh, &seed, centre, inner, 0, 40, 60, 1 << 20);
    TEST_ASSERT_TRUE(assert_known_is_the_same("two shells", 600) > 50);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_queue_gives_the_cheapest);
    RUN_TEST(test_queue_needs_no_more_chunks_than_there_are);
    RUN_TEST(test_buckets_rise_with_cost);
    RUN_TEST(test_corners_face_each_other);
    RUN_TEST(test_packed_corners_are_as_if_connected_anew);
    RUN_TEST(test_boxes_find_what_all_triangles_show);
    RUN_TEST(test_facings_of_eight_children_equal_one_by_one);
    RUN_TEST(test_steps_of_boxes_keep_overlaps);
    RUN_TEST(test_verdicts_equal_all_pairs);
    RUN_TEST(test_proofs_of_no_crossing_change_no_verdict);
    return UNITY_END();
}
