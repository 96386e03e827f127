/* star.c - may an edge collapse to a point? The link, the sides of triangles, needles, crossings.
 *
 * No new triangle may meet another one in more than what they share. Three kinds of pairs:
 * - Triangles around one vertex cannot meet elsewhere when all of them face one way and go around it once:
 * seen along the sum of their normals they lie side by side. This is asked of the new vertex and of every
 * vertex of the link. A fan of which it does not hold, as at a sharp corner, has its pairs tested one by one.
 * - Triangles without a common vertex are found by their boxes, and parted by a plane: along a facet's
 * normal, through an edge, or along two edges. A pair that no plane parts by more than rounding can move is
 * decided exactly. Guarantee: a mesh without crossing triangles has none after a collapse that is judged
 * safe. */
#include "simplify/star.h"
#include "bits/bits.h"
#include "mesh/cross.h"

/* A new triangle keeps its side when its normal turns by less than about 78 degrees. */
#define SIDE_COSINE 0.2
/* Twice the area over the sum of squared sides, of a triangle that is no needle (equal sides: 0.577). */
#define NEEDLE_SHAPE 0.002
/* A cosine that is positive for certain, whatever doubles round. */
#define FAN_COSINE 1e-6
/* Sines below it may have either sign. */
#define FAN_SINE 1e-11
/* Planes part triangles by more than this share of the lengths that were multiplied: some hundred roundings.
 */
#define APART_MARGIN 1e-13

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static void subtract(const double *a, const double *b, double c[3])
{
    c[0] = a[0] - b[0];
    c[1] = a[1] - b[1];
    c[2] = a[2] - b[2];
}

static double magnitude(double x)
{
    return x < 0 ? -x : x;
}

/* ---- The link ---- */

/* Triangles around the vertex of `start` from the one after that of `start` on, until one has vertex `other`.
 */
static int gather_side(const bvxi_corners *m, int32_t start, uint32_t other, bvxi_star *star)
{
    for (int32_t c = bvxi_corner_turn_left(m, start);; c = bvxi_corner_turn_left(m, c)) {
        uint32_t const from = bvxi_corner_vertex_of(m, bvxi_corner_next(c));

        if (from == other || bvxi_corner_vertex_of(m, bvxi_corner_previous(c)) == other) return 1;
        if (star->count == BVXI_STAR_MOST) return 0;
        star->link[star->count] = from;
        star->corner[star->count++] = c;
    }
}

int bvxi_star_gather(const bvxi_corners *m, int32_t edge, bvxi_star *star)
{
    int32_t const across = bvxi_corner_opposite(m, edge);

    star->edge = edge;
    star->u = bvxi_corner_vertex_of(m, bvxi_corner_next(edge));
    star->v = bvxi_corner_vertex_of(m, bvxi_corner_previous(edge));
    star->count = 0;

    /* Counter-clockwise around u from the apex of the edge's triangle to that across, then around v back
     * again. */
    if (!gather_side(m, bvxi_corner_next(edge), star->v, star) ||
        !gather_side(m, bvxi_corner_next(across), star->u, star))
        return 0;
    if (star->count < 3) return 0;
    star->link[star->count] = star->link[0];

    /* A vertex that is there twice is a neighbour of both ends beside the two that they may share. */
    for (int32_t i = 1; i < star->count; i++)
        for (int32_t j = 0; j < i; j++)
            if (star->link[i] == star->link[j]) return 0;
    return 1;
}

/* ---- Sides and needles ---- */

/* Twice the area over the sum of squared sides, both squared. */
static double shape_of(const double normal[3], const double *a, const double *b, const double *c)
{
    double ab[3], bc[3], ca[3], sides;

    subtract(b, a, ab);
    subtract(c, b, bc);
    subtract(a, c, ca);
    sides = dot(ab, ab) + dot(bc, bc) + dot(ca, ca);
    return dot(normal, normal) / (sides * sides);
}

static int judge_shapes(const bvxi_corners *m, bvxi_star *star)
{
    for (int32_t i = 0; i < star->count; i++) {
        const double *const a = bvxi_corner_position(m, star->link[i]), *const b = bvxi_corner_position(
                                                                            m, star->link[i + 1]);
        const double *const apex = bvxi_corner_position(m, bvxi_corner_vertex_of(m, star->corner[i]));
        double *const n = star->normal[i];
        double before[3], cosine, shape;

        bvxi_area_normal(star->p, a, b, n);
        bvxi_area_normal(apex, a, b, before);
        if (!(dot(n, n) > 0)) return BVXI_STAR_NEEDLE;

        /* What had no area has no side to keep. */
        cosine = dot(n, before);
        if (!(cosine > 0 && cosine * cosine > SIDE_COSINE * SIDE_COSINE * dot(n, n) * dot(before, before)) &&
            dot(before, before) > 0)
            return BVXI_STAR_TURNS;

        /* A needle may stay one where the collapse makes it no thinner. */
        if (star->needles) continue;
        shape = shape_of(n, star->p, a, b);
        if (shape < NEEDLE_SHAPE * NEEDLE_SHAPE && !(shape > shape_of(before, apex, a, b)))
            return BVXI_STAR_NEEDLE;
    }
    return BVXI_STAR_SAFE;
}

/* ---- Fans ---- */

/* The direction in floats, its largest part 1. */
static void face_along(const double sum[3], bvxi_facing *facing)
{
    double const x = magnitude(sum[0]), y = magnitude(sum[1]), z = magnitude(sum[2]);
    double const largest = x > y ? x > z ? x : z : y > z ? y : z;

    for (int k = 0; k < 3; k++) facing->along[k] = largest > 0 ? (float)(sum[k] / largest) : 0;
}

static int no_facing(bvxi_facing *facing)
{
    memset(facing, 0, sizeof *facing);
    return 0;
}

/* All face one way, and go around the apex once: then no two of them meet beside their common edges. facing
 * becomes that way, or 0. */
static int fan_is_graph(const bvxi_fan *f, const double *apex, bvxi_facing *facing)
{
    double sum[3] = {0, 0, 0}, first[3], left[3], sum_square, left_square;
    int changes = 0, side_before = 1;

    for (int32_t i = 0; i < f->count; i++)
        for (int k = 0; k < 3; k++) sum[k] += f->normal[i][k];
    face_along(sum, facing);
    for (int k = 0; k < 3; k++) sum[k] = (double)facing->along[k];
    sum_square = dot(sum, sum);
    for (int32_t i = 0; i < f->count; i++) {
        double const along = dot(f->normal[i], sum);
        if (!(along > 0 &&
              along * along > FAN_COSINE * FAN_COSINE * sum_square * dot(f->normal[i], f->normal[i])))
            return no_facing(facing);
    }

    /* Seen along the sum each triangle turns left by less than half a turn. A fan that goes around once is
     * first to the left of its first edge, then to the right: one change. What lies on that line within
     * rounding tells nothing. */
    subtract(f->around[0], apex, first);
    cross(sum, first, left);
    left_square = dot(left, left);
    for (int32_t i = 1; i < f->count; i++) {
        double way[3], side;

        subtract(f->around[i], apex, way);
        side = dot(way, left);
        if (side * side < FAN_SINE * FAN_SINE * dot(way, way) * left_square) continue;
        changes += (side > 0) != side_before;
        side_before = side > 0;
    }
    return changes == 1 && !side_before ? 1 : no_facing(facing);
}

static int has_vertex(const bvxi_corners *m, int32_t t, uint32_t v)
{
    const uint32_t *const c = m->triangle[t].vertex;
    return (c[0] == v) | (c[1] == v) | (c[2] == v);
}

/* The fan of link[i] after the collapse: the new triangles i and i - 1, then those that stay. 0: none stays,
 * or too many. */
static int gather_link_fan(const bvxi_corners *m, const bvxi_star *star, int32_t i, bvxi_fan *f)
{
    const double *const apex = bvxi_corner_position(m, star->link[i]);
    int32_t const before = i == 0 ? star->count - 1 : i - 1;
    int32_t c = bvxi_corner_previous(star->corner[before]); /* of link[i] */

    memcpy(f->normal[0], star->normal[i], sizeof f->normal[0]);
    memcpy(f->normal[1], star->normal[before], sizeof f->normal[1]);
    f->around[0] = bvxi_corner_position(m, star->link[i + 1]);
    f->around[1] = star->p;
    f->around[2] = bvxi_corner_position(m, star->link[before]);
    f->count = 2;

    for (c = bvxi_corner_turn_left(m, c); !has_vertex(m, c >> 2, star->u) && !has_vertex(m, c >> 2, star->v);
         c = bvxi_corner_turn_left(m, c)) {
        if (f->count == BVXI_STAR_MOST + 2) return 0;
        f->around[f->count + 1] = bvxi_corner_position(m, bvxi_corner_vertex_of(m, bvxi_corner_previous(c)));
        bvxi_area_normal(apex, f->around[f->count], f->around[f->count + 1], f->normal[f->count]);
        f->triangle[f->count++] = c >> 2;
    }
    return f->count > 2;
}

static int old_triangle_crosses(const bvxi_corners *m, const uint32_t *corners, const double *const q[3])
{
    const double *const p[3] = {bvxi_corner_position(m, corners[0]), bvxi_corner_position(m, corners[1]),
                                bvxi_corner_position(m, corners[2])};
    return bvxi_triangles_cross(p, q);
}

/* 1 when a triangle that stays crosses the star as it was already, and that is suffered: in a mesh that
 * crosses itself the triangles that do become no more. */
static int crosses_anyway(const bvxi_corners *m, const bvxi_star *star, const double *const q[3])
{
    int32_t const across = bvxi_corner_opposite(m, star->edge);

    if (!star->lenient) return 0;
    for (int32_t i = 0; i < star->count; i++)
        if (old_triangle_crosses(m, m->triangle[star->corner[i] >> 2].vertex, q)) return 1;
    return old_triangle_crosses(m, m->triangle[star->edge >> 2].vertex, q) ||
           old_triangle_crosses(m, m->triangle[across >> 2].vertex, q);
}

/* Triangle i of the new star against one that stays and has a vertex of it: exact. */
static int new_triangle_crosses(const bvxi_corners *m, const bvxi_star *star, int32_t i, int32_t triangle)
{
    const uint32_t *const c = m->triangle[triangle].vertex;
    const double *const p[3] = {star->p, bvxi_corner_position(m, star->link[i]),
                                bvxi_corner_position(m, star->link[i + 1])};
    const double *const q[3] = {bvxi_corner_position(m, c[0]), bvxi_corner_position(m, c[1]),
                                bvxi_corner_position(m, c[2])};

    return bvxi_triangles_cross(p, q) && !crosses_anyway(m, star, q);
}

/* Seen along what all triangles around a vertex face, the two new ones must too: then they fill the gap that
 * the collapse leaves between those that stay, whatever lies between. */
static int faces_with_link(const bvxi_star *star, int32_t i, int32_t before, const bvxi_facing *facing)
{
    double const along[3] = {(double)facing->along[0], (double)facing->along[1], (double)facing->along[2]};
    double const one = dot(star->normal[i], along), other = dot(star->normal[before], along);
    double const least = FAN_COSINE * FAN_COSINE * dot(along, along);

    return one > 0 && other > 0 && one * one > least * dot(star->normal[i], star->normal[i]) &&
           other * other > least * dot(star->normal[before], star->normal[before]);
}

static int judge_link_fans(const bvxi_corners *m, bvxi_star *star)
{
    bvxi_fan *const f = &star->fan;

    for (int32_t i = 0; i < star->count; i++) {
        int32_t const before = i == 0 ? star->count - 1 : i - 1;

        star->facing[i] = m->facing[star->link[i]];
        if (faces_with_link(star, i, before, &star->facing[i])) continue;

        if (!gather_link_fan(m, star, i, f)) return BVXI_STAR_LINK;
        if (fan_is_graph(f, bvxi_corner_position(m, star->link[i]), &star->facing[i])) continue;

        for (int32_t k = 2; k < f->count; k++)
            if (new_triangle_crosses(m, star, i, f->triangle[k]) ||
                new_triangle_crosses(m, star, before, f->triangle[k]))
                return BVXI_STAR_CROSSES;
    }
    return BVXI_STAR_SAFE;
}

/* The fan of the new vertex itself. */
static int judge_new_fan(const bvxi_corners *m, bvxi_star *star)
{
    bvxi_fan *const f = &star->fan;

    f->count = star->count;
    memcpy(f->normal, star->normal, (size_t)star->count * sizeof f->normal[0]);
    for (int32_t i = 0; i <= star->count; i++) f->around[i] = bvxi_corner_position(m, star->link[i]);
    if (fan_is_graph(f, star->p, &star->own_facing)) return BVXI_STAR_SAFE;

    for (int32_t i = 1; i < star->count; i++)
        for (int32_t j = 0; j < i; j++) {
            const double *const a[3] = {star->p, f->around[i], f->around[i + 1]};
            const double *const b[3] = {star->p, f->around[j], f->around[j + 1]};

            if (bvxi_triangles_cross(a, b)) return BVXI_STAR_CROSSES;
        }
    return BVXI_STAR_SAFE;
}

/* ---- Triangles without a common vertex ---- */

/* 1 when a plane across the axis has one triangle on each side for certain. Coordinates are differences, each
 * below size. */
static int axis_parts(const double axis[3], const double t[3][3], const double s[3][3], double size)
{
    double const t0 = dot(axis, t[0]), t1 = dot(axis, t[1]), t2 = dot(axis, t[2]);
    double const s0 = dot(axis, s[0]), s1 = dot(axis, s[1]), s2 = dot(axis, s[2]);
    double const t_low = t0 < t1   ? t0 < t2 ? t0 : t2
                         : t1 < t2 ? t1
                                   : t2,
                 t_high = t0 > t1   ? t0 > t2 ? t0 : t2
                          : t1 > t2 ? t1
                                    : t2;
    double const s_low = s0 < s1   ? s0 < s2 ? s0 : s2
                         : s1 < s2 ? s1
                                   : s2,
                 s_high = s0 > s1   ? s0 > s2 ? s0 : s2
                          : s1 > s2 ? s1
                                    : s2;
    double const margin =
        APART_MARGIN * size * (magnitude(axis[0]) + magnitude(axis[1]) + magnitude(axis[2]));

    return t_low > s_high + margin || s_low > t_high + margin;
}

/* Planes along a triangle's normal and, upright on it, along its edges; first along the edge opposite to its
 * first corner, beyond which most neighbours of a star lie. */
static int facet_parts(const double own[3][3], const double t[3][3], const double s[3][3], double size)
{
    double edge[3], other[3], normal[3], upright[3];

    subtract(own[1], own[0], edge);
    subtract(own[2], own[1], other);
    cross(edge, other, normal);
    cross(other, normal, upright);
    if (axis_parts(upright, t, s, size) || axis_parts(normal, t, s, size)) return 1;
    cross(edge, normal, upright);
    if (axis_parts(upright, t, s, size)) return 1;
    subtract(own[0], own[2], edge);
    cross(edge, normal, upright);
    return axis_parts(upright, t, s, size);
}

static int edges_part(const double t[3][3], const double s[3][3], double size)
{
    double a[3], b[3], axis[3];

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            subtract(t[(i + 1) % 3], t[i], a);
            subtract(s[(j + 1) % 3], s[j], b);
            cross(a, b, axis);
            if (axis_parts(axis, t, s, size)) return 1;
        }
    return 0;
}

/* Every axis that can part two triangles is tried, so only those that meet, or nearly do, are not parted. */
static int triangles_are_apart(const double *const p[3], const double *const q[3])
{
    double t[3][3], s[3][3], size = 0;

    for (int i = 0; i < 3; i++) {
        subtract(p[i], p[0], t[i]);
        subtract(q[i], p[0], s[i]);
        for (int k = 0; k < 3; k++) {
            if (magnitude(t[i][k]) > size) size = magnitude(t[i][k]);
            if (magnitude(s[i][k]) > size) size = magnitude(s[i][k]);
        }
    }
    return facet_parts((const double(*)[3])t, (const double(*)[3])t, (const double(*)[3])s, size) ||
           facet_parts((const double(*)[3])s, (const double(*)[3])t, (const double(*)[3])s, size) ||
           edges_part((const double(*)[3])t, (const double(*)[3])s, size);
}

/* The new triangles' boxes, eight to a node; returns the box of all. */
static bvxi_box gather_boxes(const bvxi_corners *m, const bvxi_box_tree *tree, bvxi_star *star)
{
    bvxi_box all = bvxi_box_none();
    bvxi_box const none = all;

    for (int32_t i = 0; i < star->count; i++) {
        star->box[i] = bvxi_box_of(tree, star->p, bvxi_corner_position(m, star->link[i]),
                                   bvxi_corner_position(m, star->link[i + 1]));
        bvxi_box_put(&star->node[i / BVXI_BOX_WIDTH], i % BVXI_BOX_WIDTH, &star->box[i]);
        bvxi_box_join(&all, &star->box[i]);
    }
    for (int32_t i = star->count; i % BVXI_BOX_WIDTH != 0; i++)
        bvxi_box_put(&star->node[i / BVXI_BOX_WIDTH], i % BVXI_BOX_WIDTH, &none);
    return all;
}

static int new_triangle_meets(const bvxi_corners *m, const bvxi_star *star, int32_t i,
                              const double *const q[3])
{
    const double *const p[3] = {star->p, bvxi_corner_position(m, star->link[i]),
                                bvxi_corner_position(m, star->link[i + 1])};

    return !triangles_are_apart(p, q) && bvxi_triangles_cross(p, q) && !crosses_anyway(m, star, q);
}

/* 1 when a triangle's corners are all beyond the outer edge of new triangle i, or all on one side of its
 * plane, for certain: so it is with most that are near a star. */
static int is_beyond(const bvxi_corners *m, const bvxi_star *star, int32_t i, const double *const q[3])
{
    const double *const a = bvxi_corner_position(m, star->link[i]), *const b = bvxi_corner_position(
                                                                        m, star->link[i + 1]);
    const double *const n = star->normal[i];
    double const n_size = magnitude(n[0]) + magnitude(n[1]) + magnitude(n[2]);
    double edge[3], out[3], out_size;
    int beyond = 1, above = 1, below = 1;

    subtract(b, a, edge);
    cross(edge, n, out);
    out_size = magnitude(out[0]) + magnitude(out[1]) + magnitude(out[2]);
    for (int k = 0; k < 3; k++) {
        double way[3], size, side;

        subtract(q[k], a, way);
        size = APART_MARGIN * (magnitude(way[0]) + magnitude(way[1]) + magnitude(way[2]));
        /* The edge's other end, and the new vertex, may lie beyond the line by rounding alone: much less than
         * the margin. */
        beyond &=
            dot(out, way) >
            out_size * (size + APART_MARGIN * (magnitude(edge[0]) + magnitude(edge[1]) + magnitude(edge[2])));
        side = dot(n, way);
        above &= side > n_size * size;
        below &= side < -n_size * size;
    }
    return beyond | above | below;
}

/* A triangle that stays, found by the star's box, against the new ones that it shares no vertex with. */
static int meets_new_triangles(const bvxi_corners *m, const bvxi_star *star, int32_t triangle,
                               const bvxi_box *box)
{
    const uint32_t *const c = m->triangle[triangle].vertex;
    const double *const q[3] = {bvxi_corner_position(m, c[0]), bvxi_corner_position(m, c[1]),
                                bvxi_corner_position(m, c[2])};
    bvxi_box_query const query = bvxi_box_ask(box);

    for (int32_t first = 0; first < star->count; first += BVXI_BOX_WIDTH)
        for (uint32_t bits = bvxi_box_overlaps(&star->node[first / BVXI_BOX_WIDTH], &query); bits != 0;
             bits &= bits - 1) {
            int32_t const i = first + bvxi_lowest(bits);

            if (has_vertex(m, triangle, star->link[i]) | has_vertex(m, triangle, star->link[i + 1])) continue;
            if (!is_beyond(m, star, i, q) && new_triangle_meets(m, star, i, q)) return 1;
        }
    return 0;
}

/* Triangles that were found and wait for their memory. */
typedef struct found_triangles {
    int32_t count;
    int32_t triangle[BVXI_STAR_MOST];
    bvxi_box box[BVXI_STAR_MOST];
} found_triangles;

static int meets_found(const bvxi_corners *m, const bvxi_star *star, found_triangles *found)
{
    for (int32_t i = 0; i < found->count; i++) {
        int32_t const t = found->triangle[i];

        if (has_vertex(m, t, star->u) | has_vertex(m, t, star->v)) continue;
        if (meets_new_triangles(m, star, t, &found->box[i])) return 1;
    }
    found->count = 0;
    return 0;
}

static int judge_neighbours(const bvxi_corners *m, const bvxi_box_tree *tree, bvxi_star *star)
{
    bvxi_box const all = gather_boxes(m, tree, star);
    bvxi_box_query const query = bvxi_box_ask(&all);
    uint64_t stack[BVXI_BOX_STACK]; /* level in the low bits */
    found_triangles found;
    int32_t depth = 0;

    /* What is looked at next is asked of memory before it is needed: waiting for it is most of the time. */
    found.count = 0;
    stack[depth++] = (uint64_t)(tree->levels - 1);
    while (depth > 0) {
        uint64_t const top = stack[--depth], index = top >> 4;
        int32_t const level = (int32_t)(top & 15);
        const bvxi_box_node *const node = &tree->node[level][index];

        if (found.count > BVXI_STAR_MOST - BVXI_BOX_WIDTH && meets_found(m, star, &found))
            return BVXI_STAR_CROSSES;
        for (uint32_t bits = bvxi_box_overlaps(node, &query); bits != 0; bits &= bits - 1) {
            int32_t const k = bvxi_lowest(bits);
            uint64_t const child = index * BVXI_BOX_WIDTH + (uint64_t)k;

            if (level > 0) {
                BVXI_PREFETCH(&tree->node[level - 1][child]);
                BVXI_PREFETCH(&tree->node[level - 1][child].high[0]);
                stack[depth++] = child << 4 | (uint64_t)(level - 1);
            } else {
                BVXI_PREFETCH(&m->triangle[child]);
                found.triangle[found.count] = (int32_t)child;
                found.box[found.count++] = bvxi_box_child(node, k);
            }
        }
    }
    return meets_found(m, star, &found) ? BVXI_STAR_CROSSES : BVXI_STAR_SAFE;
}

int bvxi_star_judge(const bvxi_corners *m, const bvxi_box_tree *boxes, bvxi_star *star)
{
    int verdict = judge_shapes(m, star);

    if (verdict == BVXI_STAR_SAFE) verdict = judge_new_fan(m, star);
    if (verdict == BVXI_STAR_SAFE) verdict = judge_link_fans(m, star);
    if (verdict == BVXI_STAR_SAFE) verdict = judge_neighbours(m, boxes, star);
    return verdict;
}
