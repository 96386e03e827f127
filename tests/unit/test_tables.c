/* test_tables.c - the marching-cubes tables, proven for all 256 cases and both face rules.
 *
 * Nothing here comes from the generator: the cell's geometry is written down again, the borders that the face
 * rules ask for are found by sign tests, and triangles are intersected in integers. */
#include <stdint.h>
#include <string.h>

#include "bitvox_io.h"
#include "tools/cell_tables.h"
#include "unity.h"

enum { SCALE = 4096 }; /* positions on an edge; products stay below 2^52 */

/* Corner at the low end of each edge; the axis is edge / 4, the other end is one step along it. */
static const int low_corner[12] = {0, 2, 4, 6, 0, 1, 4, 5, 0, 1, 2, 3};

typedef struct {
    int64_t v[3];
} point;
typedef struct {
    uint8_t v[3];
} triangle;
typedef struct {
    uint8_t count[12][12];
} edge_counts; /* directed edges of a case's triangles */

void setUp(void)
{
}
void tearDown(void)
{
}

/* ---- The cell ---- */

static int axis_of(int edge)
{
    return edge / 4;
}
static int high_corner(int edge)
{
    return low_corner[edge] + (1 << axis_of(edge));
}
static int is_set(int cell, int corner)
{
    return cell >> corner & 1;
}
static int is_crossed(int cell, int edge)
{
    return is_set(cell, low_corner[edge]) != is_set(cell, high_corner(edge));
}

/* Face 2 * axis + side. */
static int corner_on_face(int corner, int face)
{
    return (corner >> face / 2 & 1) == face % 2;
}
static int edge_on_face(int edge, int face)
{
    return corner_on_face(low_corner[edge], face) && corner_on_face(high_corner(edge), face);
}

static int common_face(int a, int b) /* -1: none */
{
    int face;
    for (face = 0; face < 6; face++)
        if (edge_on_face(a, face) && edge_on_face(b, face)) return face;
    return -1;
}

static int edge_at(int axis, int low)
{
    int edge = 4 * axis;
    while (low_corner[edge] != low) edge++;
    return edge;
}

static point corner_point(int corner, int64_t scale)
{
    point p;
    int axis;
    for (axis = 0; axis < 3; axis++) p.v[axis] = scale * (corner >> axis & 1);
    return p;
}

static point vertex_point(int edge, int64_t position, int64_t scale)
{
    point p = corner_point(low_corner[edge], scale);
    p.v[axis_of(edge)] = position;
    return p;
}

static point sub(point a, point b)
{
    point const r = {{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
    return r;
}

static point cross(point a, point b)
{
    point const r = {{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
                      a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
    return r;
}

static int64_t dot(point a, point b)
{
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2];
}
static int is_zero(point a)
{
    return a.v[0] == 0 && a.v[1] == 0 && a.v[2] == 0;
}

/* ---- The tables ---- */

static int triangle_count(int rule, int cell)
{
    return bvxi_cell_triangle_count[rule][cell];
}

static triangle triangle_of(int rule, int cell, int number)
{
    triangle t;
    memcpy(t.v, &bvxi_cell_triangle_vertex[rule][cell][3 * number], 3);
    return t;
}

static edge_counts count_edges(int rule, int cell)
{
    edge_counts edges = {{{0}}};
    int n, k;
    for (n = 0; n < triangle_count(rule, cell); n++) {
        triangle const t = triangle_of(rule, cell, n);
        for (k = 0; k < 3; k++) edges.count[t.v[k]][t.v[(k + 1) % 3]]++;
    }
    return edges;
}

static int is_border(const edge_counts *edges, int from, int to)
{
    return edges->count[from][to] && !edges->count[to][from];
}

static int crossings_on_face(int cell, int face)
{
    int edge, n = 0;
    for (edge = 0; edge < 12; edge++) n += edge_on_face(edge, face) && is_crossed(cell, edge);
    return n;
}

/* Positive if the corner lies to the left of from -> to, seen from outside the cell, vertices at
 * midpoints. */
static int64_t left_of(int from, int to, int corner, int face)
{
    point const a = vertex_point(from, 1, 2);
    point const turn = cross(sub(vertex_point(to, 1, 2), a), sub(corner_point(corner, 2), a));
    return face % 2 ? turn.v[face / 2] : -turn.v[face / 2];
}

/* Does the face rule ask for this border? Set corners have to lie to the
 * right, empty ones to the left: all corners of a plain face, on an ambiguous
 * one the corner that is cut off, a set one when set corners are kept apart. */
static int border_asked(int rule, int cell, int from, int to)
{
    int const face = common_face(from, to);
    int corner, cut_off = -1;

    if (face < 0 || from == to || !is_crossed(cell, from) || !is_crossed(cell, to)) return 0;
    if (crossings_on_face(cell, face) == 4) {
        for (corner = 0; corner < 8; corner++)
            if ((corner == low_corner[from] || corner == high_corner(from)) &&
                (corner == low_corner[to] || corner == high_corner(to)))
                cut_off = corner;
        if (cut_off < 0 || is_set(cell, cut_off) != (rule == BVX_FACE_SEPARATE)) return 0;
    }
    for (corner = 0; corner < 8; corner++) {
        if (!corner_on_face(corner, face) || (cut_off >= 0 && corner != cut_off)) continue;
        if (is_set(cell, corner) ? left_of(from, to, corner, face) >= 0
                                 : left_of(from, to, corner, face) <= 0)
            return 0;
    }
    return 1;
}

/* ---- Tests of the cases ---- */

#define FOR_ALL_CASES(rule, cell)    \
    for (rule = 0; rule < 2; rule++) \
        for (cell = 0; cell < 256; cell++)

static void test_tables_have_the_numbers_of_the_public_rules(void)
{
    int rule, cell, total[2] = {0, 0};

    TEST_ASSERT_EQUAL_INT(0, BVX_FACE_SEPARATE);
    TEST_ASSERT_EQUAL_INT(1, BVX_FACE_JOIN);
    FOR_ALL_CASES(rule, cell)
    {
        total[rule] += triangle_count(rule, cell);
        TEST_ASSERT_TRUE(3 * triangle_count(rule, cell) <= BVXI_CELL_ROW);
    }
    TEST_ASSERT_EQUAL_INT(820, total[BVX_FACE_SEPARATE]);
    TEST_ASSERT_EQUAL_INT(820, total[BVX_FACE_JOIN]);
}

static void test_tables_use_exactly_the_crossed_edges(void)
{
    int rule, cell, n, edge;

    FOR_ALL_CASES(rule, cell)
    {
        const uint8_t *const row = bvxi_cell_triangle_vertex[rule][cell];
        int used = 0, crossed = 0;
        for (n = 0; n < 3 * triangle_count(rule, cell); n++) used |= 1 << row[n];
        for (edge = 0; edge < 12; edge++) crossed |= is_crossed(cell, edge) << edge;
        TEST_ASSERT_EQUAL_HEX(crossed, used);
        for (n = 3 * triangle_count(rule, cell); n < BVXI_CELL_ROW; n++) {
            TEST_ASSERT_EQUAL_UINT8(0, row[n]);
            TEST_ASSERT_EQUAL_UINT8(0, bvxi_cell_triangle[rule][cell][n]);
        }
    }
}

static void test_tables_border_is_what_the_face_rule_asks(void)
{
    int rule, cell, a, b;

    FOR_ALL_CASES(rule, cell)
    {
        edge_counts const edges = count_edges(rule, cell);
        for (a = 0; a < 12; a++)
            for (b = 0; b < 12; b++) {
                TEST_ASSERT_TRUE(edges.count[a][b] <= 1);
                TEST_ASSERT_EQUAL_INT(border_asked(rule, cell, a, b), is_border(&edges, a, b));
            }
    }
}

static void test_tables_inner_edges_avoid_the_faces(void)
{
    int rule, cell, a, b;
    FOR_ALL_CASES(rule, cell)
    {
        edge_counts const edges = count_edges(rule, cell);
        for (a = 0; a < 12; a++)
            for (b = 0; b < 12; b++)
                if (edges.count[a][b] && edges.count[b][a]) TEST_ASSERT_EQUAL_INT(-1, common_face(a, b));
    }
}

/* Each vertex has one border edge in and one out, so the border is a set of loops; with as many pieces as
 * loops and two triangles less than corners in each, every piece is a disc. */
static void test_tables_are_one_disc_for_each_loop(void)
{
    int rule, cell, a, b, n;

    FOR_ALL_CASES(rule, cell)
    {
        edge_counts const edges = count_edges(rule, cell);
        int next[12], piece[12], corners = 0, loops = 0, pieces = 0, seen = 0;
        for (a = 0; a < 12; a++) {
            next[a] = -1;
            piece[a] = a;
            for (b = 0; b < 12; b++) {
                if (!is_border(&edges, a, b)) continue;
                TEST_ASSERT_EQUAL_INT(-1, next[a]);
                next[a] = b;
            }
            TEST_ASSERT_EQUAL_INT(is_crossed(cell, a), next[a] >= 0);
            corners += next[a] >= 0;
        }
        for (a = 0; a < 12; a++)
            if (next[a] >= 0 && !(seen >> a & 1)) {
                loops++;
                for (b = a; !(seen >> b & 1); b = next[b]) seen |= 1 << b;
                TEST_ASSERT_EQUAL_INT(a, b);
            }
        for (n = 0; n < 12; n++) /* the smallest vertex index spreads over each piece */
            for (a = 0; a < 12; a++)
                for (b = 0; b < 12; b++)
                    if (edges.count[a][b]) piece[a] = piece[b] = piece[a] < piece[b] ? piece[a] : piece[b];
        for (a = 0; a < 12; a++) pieces += next[a] >= 0 && piece[a] == a;
        TEST_ASSERT_EQUAL_INT(loops, bvxi_cell_loop_count[rule][cell]);
        TEST_ASSERT_EQUAL_INT(loops, pieces);
        TEST_ASSERT_EQUAL_INT(corners - 2 * loops, triangle_count(rule, cell));
        /* those of a loop stand together */
        for (n = 1, pieces = loops > 0; n < triangle_count(rule, cell); n++)
            pieces += piece[triangle_of(rule, cell, n).v[0]] != piece[triangle_of(rule, cell, n - 1).v[0]];
        TEST_ASSERT_EQUAL_INT(loops, pieces);
    }
}

/* At midpoints each triangle looks, along the lattice edge of each of its
 * corners, from the set to the empty end. */
static void test_tables_face_the_empty_side(void)
{
    int rule, cell, n, k;

    FOR_ALL_CASES(rule, cell) for (n = 0; n < triangle_count(rule, cell); n++)
    {
        triangle const t = triangle_of(rule, cell, n);
        point const a = vertex_point(t.v[0], 1, 2);
        point const normal = cross(sub(vertex_point(t.v[1], 1, 2), a), sub(vertex_point(t.v[2], 1, 2), a));
        for (k = 0; k < 3; k++) {
            int64_t const along = normal.v[axis_of(t.v[k])];
            TEST_ASSERT_TRUE(is_set(cell, low_corner[t.v[k]]) ? along > 0 : along < 0);
        }
    }
}

/* All pairs of cells that can stand side by side: 16 for each case, axis and rule. */
static void test_tables_neighbours_agree_on_their_face(void)
{
    int rule, cell, axis, other, a, b, corner, pairs = 0;

    FOR_ALL_CASES(rule, cell) for (axis = 0; axis < 3; axis++) for (other = 0; other < 256; other++)
    {
        int const step = 1 << axis;
        int agree = 1;
        edge_counts here, there;
        for (corner = 0; corner < 8; corner++)
            if (!(corner & step)) agree &= is_set(cell, corner + step) == is_set(other, corner);
        if (!agree) continue;
        pairs++;
        here = count_edges(rule, cell);
        there = count_edges(rule, other);
        for (a = 0; a < 12; a++)
            for (b = 0; b < 12; b++)
                if (edge_on_face(a, 2 * axis + 1) && edge_on_face(b, 2 * axis + 1))
                    TEST_ASSERT_EQUAL_INT(is_border(&here, a, b),
                                          is_border(&there, edge_at(axis_of(b), low_corner[b] - step),
                                                    edge_at(axis_of(a), low_corner[a] - step)));
    }
    TEST_ASSERT_EQUAL_INT(2 * 256 * 3 * 16, pairs);
}

static void test_tables_complement_turns_the_other_rule_round(void)
{
    int cell, n, m, k;

    for (cell = 0; cell < 256; cell++) {
        int const other = 255 - cell;
        TEST_ASSERT_EQUAL_INT(triangle_count(0, cell), triangle_count(1, other));
        TEST_ASSERT_EQUAL_INT(bvxi_cell_loop_count[0][cell], bvxi_cell_loop_count[1][other]);
        for (n = 0; n < triangle_count(0, cell); n++) {
            triangle const t = triangle_of(0, cell, n);
            int found = 0;
            for (m = 0; m < triangle_count(1, other); m++) {
                triangle const r = triangle_of(1, other, m);
                for (k = 0; k < 3; k++)
                    found += r.v[k] == t.v[2] && r.v[(k + 1) % 3] == t.v[1] && r.v[(k + 2) % 3] == t.v[0];
            }
            TEST_ASSERT_EQUAL_INT(1, found);
        }
    }
}

static void test_tables_rules_differ_only_on_ambiguous_faces(void)
{
    int cell, face;
    for (cell = 0; cell < 256; cell++) {
        int ambiguous = 0;
        for (face = 0; face < 6; face++) ambiguous += crossings_on_face(cell, face) == 4;
        TEST_ASSERT_EQUAL_INT(!ambiguous, triangle_count(0, cell) == triangle_count(1, cell) &&
                                              memcmp(bvxi_cell_triangle_vertex[0][cell],
                                                     bvxi_cell_triangle_vertex[1][cell], BVXI_CELL_ROW) == 0);
    }
}

/* ---- Crossing triangles ---- */

static int shared_vertices(triangle s, triangle t)
{
    int i, k, n = 0;
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) n += s.v[i] == t.v[k];
    return n;
}

/* Turned so that the shared vertices come first. Keeps the set of corners, not the orientation. */
static triangle shared_first(triangle s, triangle t)
{
    triangle r = s;
    int i, k, first = 0, last = 2;

    for (i = 0; i < 3; i++) {
        int found = 0;
        for (k = 0; k < 3; k++) found |= s.v[i] == t.v[k];
        if (found) r.v[first++] = s.v[i];
        else r.v[last--] = s.v[i];
    }
    if (first == 2 && r.v[0] > r.v[1]) {
        uint8_t const swap = r.v[0];
        r.v[0] = r.v[1];
        r.v[1] = swap;
    }
    return r;
}

/* Do the cones from a common apex over (a, b) and (c, d) share more than the apex? */
static int cones_meet(point a, point b, point c, point d)
{
    point const n = cross(a, b), m = cross(c, d);
    /* the planes' common line, in both cones' terms */
    int64_t const w[4] = {dot(m, a), -dot(m, b), -dot(n, c), dot(n, d)};
    /* one plane: a side of one lies within the other */
    if (w[0] == 0 && w[1] == 0 && w[2] == 0 && w[3] == 0) {
        return (dot(n, cross(a, c)) >= 0 && dot(n, cross(c, b)) >= 0) ||
               (dot(n, cross(a, d)) >= 0 && dot(n, cross(d, b)) >= 0) ||
               (dot(m, cross(c, a)) >= 0 && dot(m, cross(a, d)) >= 0) ||
               (dot(m, cross(c, b)) >= 0 && dot(m, cross(b, d)) >= 0);
    }
    return (w[0] >= 0 && w[1] >= 0 && w[2] >= 0 && w[3] >= 0) ||
           (w[0] <= 0 && w[1] <= 0 && w[2] <= 0 && w[3] <= 0);
}

static int axis_separates(point axis, const point *p, const point *q)
{
    int64_t a[3], b[3];
    int i, k, above = 1, below = 1;

    for (i = 0; i < 3; i++) {
        a[i] = dot(axis, p[i]);
        b[i] = dot(axis, q[i]);
    }
    for (i = 0; i < 3; i++)
        for (k = 0; k < 3; k++) {
            above &= a[i] > b[k];
            below &= a[i] < b[k];
        }
    return above || below;
}

/* Separating axes: normals, edge by edge, and for one plane each edge's normal in it. */
static int closed_triangles_meet(const point *p, const point *q)
{
    point const n = cross(sub(p[1], p[0]), sub(p[2], p[0])), m = cross(sub(q[1], q[0]), sub(q[2], q[0]));
    int i, k;

    if (axis_separates(n, p, q) || axis_separates(m, p, q)) return 0;
    for (i = 0; i < 3; i++) {
        point const e = sub(p[(i + 1) % 3], p[i]);
        if (axis_separates(cross(n, e), p, q) || axis_separates(cross(m, sub(q[(i + 1) % 3], q[i])), p, q))
            return 0;
        for (k = 0; k < 3; k++)
            if (axis_separates(cross(e, sub(q[(k + 1) % 3], q[k])), p, q)) return 0;
    }
    return 1;
}

/* Do two triangles share more than their common corners? position [12] along the edges, in 1/SCALE. */
static int triangles_cross(triangle s, triangle t, const int *position)
{
    int const shared = shared_vertices(s, t);
    triangle const a = shared_first(s, t), b = shared_first(t, s);
    point p[3], q[3];
    int k;

    for (k = 0; k < 3; k++) {
        p[k] = vertex_point(a.v[k], position[a.v[k]], SCALE);
        q[k] = vertex_point(b.v[k], position[b.v[k]], SCALE);
    }
    if (shared == 2) { /* folded flat onto each other */
        point const n = cross(sub(p[1], p[0]), sub(p[2], p[0])), m = cross(sub(q[1], q[0]), sub(q[2], q[0]));
        return is_zero(cross(n, m)) && dot(n, m) >= 0;
    }
    if (shared == 1) return cones_meet(sub(p[1], p[0]), sub(p[2], p[0]), sub(q[1], p[0]), sub(q[2], p[0]));
    return closed_triangles_meet(p, q);
}

/* Sign of the volume of four points for all positions strictly inside their edges, 0 if it changes. The
 * volume is affine in each position alone, so it is a mean with positive weights of the 16 values with each
 * position at an end. Points: 0..11 on that edge, 12..19 a corner. */
static int fixed_side(int a, int b, int c, int vertex)
{
    int const number[4] = {a, b, c, vertex};
    int ends, k, sign = 0;

    for (ends = 0; ends < 16; ends++) {
        point p[4];
        int64_t volume;
        for (k = 0; k < 4; k++)
            p[k] = number[k] < 12 ? vertex_point(number[k], ends >> k & 1, 1)
                                  : corner_point(number[k] - 12, 1);
        volume = dot(cross(sub(p[1], p[0]), sub(p[2], p[0])), sub(p[3], p[0]));
        if (volume == 0) continue;
        if (sign == (volume > 0 ? -1 : 1)) return 0;
        sign = volume > 0 ? 1 : -1;
    }
    return sign;
}

static int side_of_plane(const int *plane, triangle t)
{
    int k, sign = 0;

    for (k = 0; k < 3; k++) {
        int side;
        if (t.v[k] == plane[0] || t.v[k] == plane[1] || t.v[k] == plane[2]) continue;
        side = fixed_side(plane[0], plane[1], plane[2], t.v[k]);
        if (side == 0 || side == -sign) return 0;
        sign = side;
    }
    return sign;
}

/* Is there a plane through three points, all common corners among them, that keeps the two triangles apart
 * for all positions? They then meet in what lies in the plane only, which is what they share: three vertices
 * of a cell are never in line, since a line through three points of a cube's surface lies in a face and meets
 * two sides of it at most. */
static int proven_apart(triangle s, triangle t)
{
    int const shared = shared_vertices(s, t);
    triangle const first = shared_first(s, t);
    int pool[14], count = 0, i, j, k;

    for (i = 0; i < 3; i++) pool[count++] = first.v[i];
    for (i = shared; i < 3; i++) pool[count++] = shared_first(t, s).v[i];
    for (i = 12; i < 20; i++) pool[count++] = i;
    for (i = 0; i < count; i++)
        for (j = i + 1; j < count; j++)
            for (k = j + 1; k < count; k++) {
                int const plane[3] = {pool[i], pool[j], pool[k]};
                if ((shared > 0 && i != 0) || (shared > 1 && j != 1)) continue;
                if (side_of_plane(plane, s) * side_of_plane(plane, t) < 0) return 1;
            }
    return 0;
}

/* The checks below must be able to fail: one of the ways to cut the loop of case 0x3d crosses itself. */
static void test_crossing_checks_find_known_crossings(void)
{
    triangle const a = {{0, 5, 11}};
    triangle const b = {{0, 10, 9}};
    triangle const c = {{10, 6, 9}};
    triangle const d = {{8, 9, 11}};
    triangle const e = {{8, 9, 10}};
    triangle const f = {{8, 11, 10}};
    int position[12], edge;

    for (edge = 0; edge < 12; edge++) position[edge] = 41;
    TEST_ASSERT_FALSE(triangles_cross(a, b, position));
    TEST_ASSERT_FALSE(triangles_cross(a, c, position));
    position[11] = SCALE / 2;
    TEST_ASSERT_TRUE(triangles_cross(a, b, position));
    TEST_ASSERT_TRUE(triangles_cross(a, c, position));
    TEST_ASSERT_FALSE(proven_apart(a, b));
    TEST_ASSERT_FALSE(proven_apart(a, c));
    position[11] = 41; /* edges 8..11 now lie in one plane */
    TEST_ASSERT_TRUE(triangles_cross(d, e, position));
    TEST_ASSERT_FALSE(triangles_cross(d, f, position));
    TEST_ASSERT_FALSE(proven_apart(d, e));
    TEST_ASSERT_TRUE(proven_apart(d, f));
}

static void test_tables_triangles_are_proven_apart_for_all_positions(void)
{
    int rule, cell, n, m, pairs = 0;
    FOR_ALL_CASES(rule, cell) for (n = 0; n < triangle_count(rule, cell); n++) for (m = 0; m < n; m++)
    {
        TEST_ASSERT_TRUE(proven_apart(triangle_of(rule, cell, n), triangle_of(rule, cell, m)));
        pairs++;
    }
    TEST_ASSERT_EQUAL_INT(2 * 1066, pairs);
}

/* Every pair of triangles with every vertex near its low end, in the middle and near its high end. */
static void test_tables_triangles_do_not_cross_at_the_extremes(void)
{
    static const int spots[3] = {SCALE / 100, SCALE / 2, SCALE - SCALE / 100};
    int rule, cell, n, m, k, trial;

    FOR_ALL_CASES(rule, cell) for (n = 0; n < triangle_count(rule, cell); n++) for (m = 0; m < n; m++)
    {
        triangle const s = triangle_of(rule, cell, n), t = triangle_of(rule, cell, m);
        for (trial = 0; trial < 729; trial++) {
            int position[12], rest = trial;
            for (k = 0; k < 3; k++, rest /= 3) position[s.v[k]] = spots[rest % 3];
            for (k = 0; k < 3; k++, rest /= 3) position[t.v[k]] = spots[rest % 3];
            TEST_ASSERT_FALSE(triangles_cross(s, t, position));
        }
    }
}

static uint32_t random_bits(uint32_t *state) /* xorshift32 */
{
    *state ^= *state << 13;
    *state ^= *state >> 17;
    *state ^= *state << 5;
    return *state;
}

/* 1000 trials a case and rule; one position in four is the last before an end. */
static void test_tables_triangles_do_not_cross_at_random(void)
{
    uint32_t state = 2463534242u;
    int rule, cell, n, m, edge, trial;

    FOR_ALL_CASES(rule, cell) for (trial = 0; trial < 1000; trial++)
    {
        int position[12];
        for (edge = 0; edge < 12; edge++) {
            uint32_t const bits = random_bits(&state);
            position[edge] = bits >> 30 ? 1 + (int)(bits % (SCALE - 1)) : bits & 1 ? 1 : SCALE - 1;
        }
        for (n = 0; n < triangle_count(rule, cell); n++)
            for (m = 0; m < n; m++)
                TEST_ASSERT_FALSE(
                    triangles_cross(triangle_of(rule, cell, n), triangle_of(rule, cell, m), position));
    }
}

/* ---- Lanes ---- */

enum { ROW_CELLS = 8192 };

static uint8_t row_bits[4][ROW_CELLS + 1];              /* rows (y,z) = (0,0) (1,0) (0,1) (1,1) */
static int rank_before[BVXI_CELL_LANES][ROW_CELLS + 2]; /* crossed edges of a lane before position x */

static void fill_ranks(void)
{
    static const int rows[4][2] = {{0, 1}, {2, 3}, {0, 2}, {1, 3}}; /* lanes 4..7: rows that the edges join */
    int lane, x;

    for (lane = 0; lane < BVXI_CELL_LANES; lane++) {
        rank_before[lane][0] = 0;
        for (x = 0; x <= ROW_CELLS; x++) {
            int const crossed = lane >= 4 ? row_bits[rows[lane - 4][0]][x] != row_bits[rows[lane - 4][1]][x]
                                          : x < ROW_CELLS && row_bits[lane][x] != row_bits[lane][x + 1];
            rank_before[lane][x + 1] = rank_before[lane][x] + crossed;
        }
    }
}

/* What a corner's number has to be, from the place of its edge alone. */
static int expected_number(int edge, int x)
{
    int const corner = low_corner[edge], dx = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    if (axis_of(edge) == 0) return rank_before[y + 2 * z][x];
    return rank_before[axis_of(edge) == 1 ? 4 + z : 6 + y][x + dx];
}

static void test_tables_lanes_number_the_vertices_of_a_row(void)
{
    uint32_t state = 88172645u;
    int counter[BVXI_CELL_LANES] = {0}, seen[256] = {0};
    int rule, row, lane, x, n;

    for (row = 0; row < 4; row++)
        for (x = 0; x <= ROW_CELLS; x++) row_bits[row][x] = (uint8_t)(random_bits(&state) >> 31);
    fill_ranks();
    for (x = 0; x < ROW_CELLS; x++) {
        int cell = 0;
        for (row = 0; row < 4; row++) cell |= (row_bits[row][x] | row_bits[row][x + 1] << 1) << 2 * row;
        seen[cell] = 1;
        for (rule = 0; rule < 2; rule++)
            for (n = 0; n < 3 * triangle_count(rule, cell); n++)
                TEST_ASSERT_EQUAL_INT(expected_number(bvxi_cell_triangle_vertex[rule][cell][n], x),
                                      counter[bvxi_cell_triangle[rule][cell][n] & 7] +
                                          (bvxi_cell_triangle[rule][cell][n] >> 3));
        for (lane = 0; lane < BVXI_CELL_LANES; lane++) {
            counter[lane] += bvxi_cell_lane_step[cell][lane];
            TEST_ASSERT_EQUAL_INT(rank_before[lane][x + 1], counter[lane]);
        }
    }
    for (n = 0; n < 256; n++) TEST_ASSERT_EQUAL_INT(1, seen[n]);
}

/* A row's numbers could agree by chance between lanes, so each corner's
 * lane and offset are also held against its edge. */
static void test_tables_lanes_name_the_edge(void)
{
    int rule, cell, n;

    FOR_ALL_CASES(rule, cell) for (n = 0; n < 3 * triangle_count(rule, cell); n++)
    {
        int const edge = bvxi_cell_triangle_vertex[rule][cell][n], corner = low_corner[edge];
        int const lane = axis_of(edge) == 0   ? corner / 2
                         : axis_of(edge) == 1 ? 4 + corner / 4
                                              : 6 + corner / 2;
        int const follows = axis_of(edge) > 0 && corner & 1 &&
                            is_crossed(cell, edge_at(axis_of(edge), corner - 1));
        TEST_ASSERT_EQUAL_INT(lane, bvxi_cell_triangle[rule][cell][n] & 7);
        TEST_ASSERT_EQUAL_INT(follows, bvxi_cell_triangle[rule][cell][n] >> 3);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_tables_have_the_numbers_of_the_public_rules);
    RUN_TEST(test_tables_use_exactly_the_crossed_edges);
    RUN_TEST(test_tables_border_is_what_the_face_rule_asks);
    RUN_TEST(test_tables_inner_edges_avoid_the_faces);
    RUN_TEST(test_tables_are_one_disc_for_each_loop);
    RUN_TEST(test_tables_face_the_empty_side);
    RUN_TEST(test_tables_neighbours_agree_on_their_face);
    RUN_TEST(test_tables_complement_turns_the_other_rule_round);
    RUN_TEST(test_tables_rules_differ_only_on_ambiguous_faces);
    RUN_TEST(test_crossing_checks_find_known_crossings);
    RUN_TEST(test_tables_triangles_are_proven_apart_for_all_positions);
    RUN_TEST(test_tables_triangles_do_not_cross_at_the_extremes);
    RUN_TEST(test_tables_triangles_do_not_cross_at_random);
    RUN_TEST(test_tables_lanes_number_the_vertices_of_a_row);
    RUN_TEST(test_tables_lanes_name_the_edge);
    return UNITY_END();
}
