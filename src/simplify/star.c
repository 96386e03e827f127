/* star.c - may an edge collapse to a point? The link, the sides of triangles, needles, crossings.
 *
 * Ghost triangles, which close borders, count for the link only.
 * No new triangle may meet another one in more than what they share. Three kinds of pairs:
 * - Triangles around one vertex cannot meet elsewhere when all of them face one way and go around it once:
 *   seen along the sum of their normals they lie side by side. This is tested for the new vertex and each
 *   vertex of the link. A fan for which it does not hold, as at a sharp corner, has its pairs tested one by
 *   one. The fan of a vertex on a border goes around it less than once.
 * - Triangles without a common vertex are found by their boxes, and separated by a plane: along a facet's
 *   normal, through an edge, or along two edges. A pair that no plane separates by more than rounding can
 *   move is decided exactly.
 * In one closed surface all of that is spared where the star and what is near face one way: one_sheet.c.
 * Guarantee: a mesh without crossing triangles has none after a collapse that is judged safe. */
#include "simplify/star.h"
#include "bits/bits.h"
#include "core/vec3.h"
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

static void subtract(const double *a, const double *b, double c[3])
{
    c[0] = a[0] - b[0];
    c[1] = a[1] - b[1];
    c[2] = a[2] - b[2];
}

static double magnitude(double x)
{
    return bvxi_absolute(x);
}

/* The sum of the sizes of all three. */
static double size_of(const double a[3])
{
    return magnitude(a[0]) + magnitude(a[1]) + magnitude(a[2]);
}

/* ---- The link ---- */

/* Triangles around the vertex of `start` from the one after that of `start` on, until one has vertex `other`.
 */
static int gather_side(const bvxi_corners *m, int32_t start, uint32_t other, bvxi_star *star)
{
    for (int32_t c = bvxi_corner_turn_left(m, start);; c = bvxi_corner_turn_left(m, c)) {
        uint32_t const from = bvxi_corner_vertex_of(m, bvxi_corner_next(c));

        /* The triangles of the edge itself go with it, so the walk ends at the second of them. */
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
    star->ghost = -1;

    /* Counter-clockwise around u from the apex of the edge's triangle to that across, then around v back
     * again. */
    if (!gather_side(m, bvxi_corner_next(edge), star->v, star) ||
        !gather_side(m, bvxi_corner_next(across), star->u, star))
        return 0;

    /* Fewer would leave two triangles back to back on the same three vertices. */
    if (star->count < 3) return 0;
    star->link[star->count] = star->link[0];

    /* A vertex that is there twice is a neighbour of both ends beside the two that they may share; the ghost
     * is when both ends are on borders and the edge is not. */
    for (int32_t i = 0; i < star->count && m->ghosts != 0; i++)
        if (star->link[i] == BVXI_VERTEX_GHOST) star->ghost = i;
    for (int32_t i = 1; i < star->count; i++)
        for (int32_t j = 0; j < i; j++)
            if (star->link[i] == star->link[j]) return 0;
    return 1;
}

/* 1 when new triangle i is a ghost. */
static int is_ghost(const bvxi_star *star, int32_t i)
{
    return star->ghost >= 0 && (i == star->ghost || (i + 1) % star->count == star->ghost);
}

/* ---- Sides and needles ---- */

/* Twice the area over the sum of squared sides, both squared. */
static double shape_of(const double normal[3], const double *a, const double *b, const double *c)
{
    double ab[3], bc[3], ca[3], sides;

    subtract(b, a, ab);
    subtract(c, b, bc);
    subtract(a, c, ca);
    sides = bvxi_vec_dot(ab, ab) + bvxi_vec_dot(bc, bc) + bvxi_vec_dot(ca, ca);
    return bvxi_vec_dot(normal, normal) / (sides * sides);
}

static int judge_shapes(const bvxi_corners *m, bvxi_star *star)
{
    for (int32_t i = 0; i < star->count; i++) {
        const double *a, *b, *apex;
        double *const n = star->normal[i];
        double before[3], cosine, shape;

        if (is_ghost(star, i)) continue;
        a = bvxi_corner_position(m, star->link[i]);
        b = bvxi_corner_position(m, star->link[i + 1]);
        apex = bvxi_corner_position(m, bvxi_corner_vertex_of(m, star->corner[i]));
        bvxi_area_normal(star->p, a, b, n);
        bvxi_area_normal(apex, a, b, before);

        /* No area, or NaN: nothing below could judge its side. */
        if (!(bvxi_vec_dot(n, n) > 0)) return BVXI_STAR_NEEDLE;

        /* What had no area has no side to keep. */
        cosine = bvxi_vec_dot(n, before);
        if (!(cosine > 0 && cosine * cosine > SIDE_COSINE * SIDE_COSINE * bvxi_vec_dot(n, n) *
                                                  bvxi_vec_dot(before, before)) &&
            bvxi_vec_dot(before, before) > 0)
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

/* Which triangles of a gathered fan: count of them from the first on, and
 * after the last one of the cycle from its first. */
typedef struct fan_range {
    int32_t first, count, cycle;
} fan_range;

static int32_t fan_index(const fan_range *r, int32_t i)
{
    int32_t const at = r->first + i;

    return at < r->cycle ? at : at - r->cycle;
}

/* All face one way, and go around the apex once, or less where they begin and end at a border: then no two of
 * them meet beside their common edges. facing becomes that way, or 0. */
static int fan_is_graph(const bvxi_fan *f, const fan_range *r, const double *apex, bvxi_facing *facing)
{
    double sum[3] = {0, 0, 0}, first[3], left[3], sum_square, left_square;
    int changes = 0, side_before = 1;

    for (int32_t i = 0; i < r->count; i++)
        for (int k = 0; k < 3; k++) sum[k] += f->normal[fan_index(r, i)][k];

    /* From here on with the rounded direction that is stored: a later collapse asks about this fan with
     * exactly it. */
    face_along(sum, facing);
    for (int k = 0; k < 3; k++) sum[k] = (double)facing->along[k];
    sum_square = bvxi_vec_dot(sum, sum);
    for (int32_t i = 0; i < r->count; i++) {
        const double *const normal = f->normal[fan_index(r, i)];
        double const along = bvxi_vec_dot(normal, sum);
        if (!(along > 0 &&
              along * along > FAN_COSINE * FAN_COSINE * sum_square * bvxi_vec_dot(normal, normal)))
            return no_facing(facing);
    }

    /* Seen along the sum each triangle turns left by less than half a turn. A fan that goes around once is
     * first to the left of its first edge, then to the right: one change. What lies on that line within
     * rounding tells nothing. One that ends at a border may end anywhere before it comes to its first
     * edge. */
    subtract(f->around[fan_index(r, 0)], apex, first);
    bvxi_vec_cross(sum, first, left);
    left_square = bvxi_vec_dot(left, left);
    for (int32_t i = 1; i < r->count + f->open; i++) {
        double way[3], side;

        subtract(f->around[fan_index(r, i)], apex, way);
        side = bvxi_vec_dot(way, left);
        if (side * side < FAN_SINE * FAN_SINE * bvxi_vec_dot(way, way) * left_square) {
            if (f->open && bvxi_vec_dot(way, first) > 0) return no_facing(facing);
            continue;
        }
        changes += (side > 0) != side_before;
        side_before = side > 0;
    }
    if (f->open) return changes <= 1 ? 1 : no_facing(facing);
    return changes == 1 && !side_before ? 1 : no_facing(facing);
}

static int has_vertex(const bvxi_corners *m, int32_t t, uint32_t v)
{
    const uint32_t *const c = m->triangle[t].vertex;

    /* Without branches: three comparisons are cheaper than one that is guessed wrongly. */
    return (c[0] == v) | (c[1] == v) | (c[2] == v);
}

/* Where a vertex is, NULL for the ghost. */
static const double *position_or_ghost(const bvxi_corners *m, uint32_t vertex)
{
    return vertex == BVXI_VERTEX_GHOST ? NULL : bvxi_corner_position(m, vertex);
}

/* The fan of link[i] after the collapse: the new triangles i and i - 1, then those that stay. 0: none stays,
 * or too many. */
static int gather_link_fan(const bvxi_corners *m, const bvxi_star *star, int32_t i, bvxi_fan *f)
{
    const double *const apex = bvxi_corner_position(m, star->link[i]);
    int32_t const before = i == 0 ? star->count - 1 : i - 1;
    int32_t c = bvxi_corner_previous(star->corner[before]); /* of link[i] */

    /* The two new triangles come first, so that the loop over those that stay begins at index 2 in every
     * fan. */
    memcpy(f->normal[0], star->normal[i], sizeof f->normal[0]);
    memcpy(f->normal[1], star->normal[before], sizeof f->normal[1]);
    f->around[0] = position_or_ghost(m, star->link[i + 1]);
    f->around[1] = star->p;
    f->around[2] = position_or_ghost(m, star->link[before]);
    f->count = 2;
    f->open = f->around[0] == NULL || f->around[2] == NULL;

    for (c = bvxi_corner_turn_left(m, c); !has_vertex(m, c >> 2, star->u) && !has_vertex(m, c >> 2, star->v);
         c = bvxi_corner_turn_left(m, c)) {
        const double *const from = f->around[f->count], *const to = position_or_ghost(
                                                            m, bvxi_corner_vertex_of(
                                                                   m, bvxi_corner_previous(c)));

        /* A vertex of so many triangles is rare, and its edges may stay. */
        if (f->count == BVXI_STAR_MOST + 2) return 0;
        f->around[f->count + 1] = to;
        if (from != NULL && to != NULL) bvxi_area_normal(apex, from, to, f->normal[f->count]);
        else f->open = 1;
        f->triangle[f->count++] = c >> 2;
    }
    return f->count > 2;
}

static int link_fan_is_graph(const bvxi_corners *m, bvxi_star *star, int32_t i)
{
    const bvxi_fan *const f = &star->fan;
    fan_range r = {0, f->count, f->count};

    /* Around a border from the triangle after the ghosts to the one before them. */
    if (f->open) {
        while (f->around[r.first] != NULL) r.first++;
        r.first++;
        r.count -= 2;
    }
    return fan_is_graph(f, &r, bvxi_corner_position(m, star->link[i]), &star->facing[i]);
}

static int old_triangle_crosses(const bvxi_corners *m, int32_t corner, const double *const q[3])
{
    const uint32_t *const v = m->triangle[corner >> 2].vertex;
    const double *p[3];

    if (bvxi_corner_is_ghost(m, corner)) return 0;
    for (int k = 0; k < 3; k++) p[k] = bvxi_corner_position(m, v[k]);
    return bvxi_triangles_cross(p, q);
}

/* 1 when a triangle that stays crosses the star as it was already, which is allowed in a mesh that was given
 * with crossings: they become no more. */
static int crosses_anyway(const bvxi_corners *m, const bvxi_star *star, const double *const q[3])
{
    int32_t const across = bvxi_corner_opposite(m, star->edge);

    /* Where the mesh given is free of crossings none is allowed. */
    if (!star->lenient) return 0;
    for (int32_t i = 0; i < star->count; i++)
        if (old_triangle_crosses(m, star->corner[i], q)) return 1;
    return old_triangle_crosses(m, star->edge, q) || old_triangle_crosses(m, across, q);
}

/* Triangle i of the new star against one that stays and has a vertex of it: exact. */
static int new_triangle_crosses(const bvxi_corners *m, const bvxi_star *star, int32_t i, int32_t triangle)
{
    const uint32_t *const c = m->triangle[triangle].vertex;
    const double *p[3] = {star->p, NULL, NULL}, *q[3];

    if (is_ghost(star, i) || bvxi_corner_is_ghost(m, 4 * triangle)) return 0;
    for (int k = 0; k < 2; k++) p[k + 1] = bvxi_corner_position(m, star->link[i + k]);
    for (int k = 0; k < 3; k++) q[k] = bvxi_corner_position(m, c[k]);
    return bvxi_triangles_cross(p, q) && !crosses_anyway(m, star, q);
}

/* Seen along what all triangles around a vertex face, the two new ones must too: then they fill the gap that
 * the collapse leaves between those that stay, whatever lies between. */
static int faces_with_link(const bvxi_star *star, int32_t i, int32_t before, const bvxi_facing *facing)
{
    double const along[3] = {(double)facing->along[0], (double)facing->along[1], (double)facing->along[2]};
    double const one = bvxi_vec_dot(star->normal[i], along);
    double const other = bvxi_vec_dot(star->normal[before], along);
    double const least = FAN_COSINE * FAN_COSINE * bvxi_vec_dot(along, along);

    /* Compared as squares, so that no root is taken. */
    return one > 0 && other > 0 && one * one > least * bvxi_vec_dot(star->normal[i], star->normal[i]) &&
           other * other > least * bvxi_vec_dot(star->normal[before], star->normal[before]);
}

static int judge_link_fans(const bvxi_corners *m, bvxi_star *star)
{
    bvxi_fan *const f = &star->fan;

    for (int32_t i = 0; i < star->count; i++) {
        int32_t const before = i == 0 ? star->count - 1 : i - 1;

        if (i == star->ghost) continue;
        star->facing[i] = m->facing[star->link[i]];
        if (!is_ghost(star, i) && !is_ghost(star, before) &&
            faces_with_link(star, i, before, &star->facing[i]))
            continue;

        /* Beside the ghost a new triangle fills no gap, but ends a fan. */
        if (!gather_link_fan(m, star, i, f)) return BVXI_STAR_LINK;
        if (link_fan_is_graph(m, star, i)) continue;

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
    int32_t const start = star->ghost + 1; /* 0 where there is no ghost */
    fan_range r = {0, 0, INT32_MAX};

    /* A ghost is two triangles of the star that are not there: the fan begins after them and is not a
     * cycle. */
    f->open = star->ghost >= 0;
    r.count = f->count = star->count - 2 * f->open;
    for (int32_t i = 0; i <= f->count; i++) {
        int32_t const from = start + i < star->count ? start + i : start + i - star->count;

        /* One direction more than triangles: the last closes the fan, or ends it. */
        if (i < f->count) memcpy(f->normal[i], star->normal[from], sizeof f->normal[i]);
        f->around[i] = bvxi_corner_position(m, star->link[from]);
    }
    if (fan_is_graph(f, &r, star->p, &star->own_facing)) return BVXI_STAR_SAFE;

    /* A pointed tip, whose triangles face no one way: all of its pairs, exactly. Such fans are few and
     * short. */
    for (int32_t i = 1; i < f->count; i++)
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
    double const t0 = bvxi_vec_dot(axis, t[0]), t1 = bvxi_vec_dot(axis, t[1]), t2 = bvxi_vec_dot(axis, t[2]);
    double const s0 = bvxi_vec_dot(axis, s[0]), s1 = bvxi_vec_dot(axis, s[1]), s2 = bvxi_vec_dot(axis, s[2]);
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

    /* Each dot product has a handful of roundings of terms no larger than size times the axis. What is apart
     * by less is left to the exact test. */
    double const margin = APART_MARGIN * size *
                          (magnitude(axis[0]) + magnitude(axis[1]) + magnitude(axis[2]));

    /* Strictly, with the margin: touching is not apart. */
    return t_low > s_high + margin || s_low > t_high + margin;
}

/* Planes along a triangle's normal and, upright on it, along its edges; first along the edge opposite to its
 * first corner, beyond which most neighbours of a star lie. */
static int facet_parts(const double own[3][3], const double t[3][3], const double s[3][3], double size)
{
    double edge[3], other[3], normal[3], upright[3];

    subtract(own[1], own[0], edge);
    subtract(own[2], own[1], other);
    bvxi_vec_cross(edge, other, normal);
    bvxi_vec_cross(other, normal, upright);

    /* The planes that part most pairs come first. */
    if (axis_parts(upright, t, s, size) || axis_parts(normal, t, s, size)) return 1;
    bvxi_vec_cross(edge, normal, upright);
    if (axis_parts(upright, t, s, size)) return 1;
    subtract(own[0], own[2], edge);
    bvxi_vec_cross(edge, normal, upright);
    return axis_parts(upright, t, s, size);
}

static int edges_part(const double t[3][3], const double s[3][3], double size)
{
    double a[3], b[3], axis[3];

    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            subtract(t[(i + 1) % 3], t[i], a);
            subtract(s[(j + 1) % 3], s[j], b);
            bvxi_vec_cross(a, b, axis);
            if (axis_parts(axis, t, s, size)) return 1;
        }
    return 0;
}

/* Every axis that can part two triangles is tried, so only those that meet, or nearly do, are not parted. */
static int triangles_are_apart(const double *const p[3], const double *const q[3])
{
    double t[3][3], s[3][3], size = 0;

    /* From one corner, so that coordinates are as small as the triangles are, and so are the roundings. */
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

/* The new triangles' boxes; returns the box of all. Rounding keeps order,
 * so corners are rounded once for all of their triangles. */
static bvxi_box gather_boxes(const bvxi_corners *m, const bvxi_box_tree *tree, bvxi_star *star)
{
    bvxi_box const apex = bvxi_box_at(tree, star->p);
    bvxi_box const none = bvxi_box_none();
    bvxi_box all = apex, from = none;

    if (star->link[0] != BVXI_VERTEX_GHOST) from = bvxi_box_at(tree, bvxi_corner_position(m, star->link[0]));
    for (int32_t i = 0; i < star->count; i++) {
        bvxi_box to = none;

        if (star->link[i + 1] != BVXI_VERTEX_GHOST)
            to = bvxi_box_at(tree, bvxi_corner_position(m, star->link[i + 1]));
        star->box[i] = none;

        /* A ghost has no place in space. */
        if (!is_ghost(star, i)) {
            star->box[i] = apex;
            bvxi_box_join(&star->box[i], &from);
            bvxi_box_join(&star->box[i], &to);
        }
        bvxi_box_join(&all, &to);
        from = to;
    }
    return all;
}

/* The boxes again, eight to a node. */
static void gather_nodes(bvxi_star *star)
{
    bvxi_box const none = bvxi_box_none();

    /* In the tree's own form, one comparison then tests eight new triangles against a box. The last node is
     * filled up with boxes that meet nothing. */
    for (int32_t i = 0; i < star->count || i % BVXI_BOX_WIDTH != 0; i++)
        bvxi_box_put(&star->node[i / BVXI_BOX_WIDTH], i % BVXI_BOX_WIDTH,
                     i < star->count ? &star->box[i] : &none);
}

/* Bit k: link vertex first + k is one of a triangle's three; first is a multiple of four. */
static uint32_t common_vertices(const bvxi_star *star, int32_t first, const uint32_t *c)
{
#if defined(__SSE2__) && defined(__GNUC__)
    uint32_t bits = 0;

    for (int k = 0; k <= BVXI_BOX_WIDTH; k += 4) {
        __m128i const link = _mm_loadu_si128((const __m128i *)(const void *)&star->link[first + k]);
        __m128i const same = _mm_or_si128(_mm_or_si128(_mm_cmpeq_epi32(link, _mm_set1_epi32((int)c[0])),
                                                       _mm_cmpeq_epi32(link, _mm_set1_epi32((int)c[1]))),
                                          _mm_cmpeq_epi32(link, _mm_set1_epi32((int)c[2])));
        bits |= (uint32_t)_mm_movemask_ps(_mm_castsi128_ps(same)) << k;
    }
    return bits;
#else
    uint32_t bits = 0;

    for (int k = 0; k <= BVXI_BOX_WIDTH; k++) {
        uint32_t const v = star->link[first + k];
        bits |= (uint32_t)((c[0] == v) | (c[1] == v) | (c[2] == v)) << k;
    }
    return bits;
#endif
}

static int new_triangle_meets(const bvxi_corners *m, const bvxi_star *star, int32_t i,
                              const double *const q[3])
{
    const double *const p[3] = {star->p, bvxi_corner_position(m, star->link[i]),
                                bvxi_corner_position(m, star->link[i + 1])};

    /* The planes decide nearly all; exact arithmetic is for what they leave. */
    return !triangles_are_apart(p, q) && bvxi_triangles_cross(p, q) && !crosses_anyway(m, star, q);
}

/* The planes that part most of what is near. */
static void gather_star_planes(const bvxi_corners *m, bvxi_star *star)
{
    star->reach = 0;
    for (int32_t i = 0; i < star->count; i++) {
        bvxi_star_planes *const planes = &star->planes[i];
        double a[3], edge[3], size, limit;

        if (i == star->ghost) continue;
        subtract(bvxi_corner_position(m, star->link[i]), star->p, a);
        size = size_of(a);
        if (size > star->reach) star->reach = size;
        if (is_ghost(star, i)) continue;
        subtract(bvxi_corner_position(m, star->link[i + 1]), bvxi_corner_position(m, star->link[i]), edge);

        memcpy(planes->normal, star->normal[i], sizeof planes->normal);
        bvxi_vec_cross(edge, planes->normal, planes->out);
        planes->normal_size = size_of(planes->normal);
        planes->out_size = size_of(planes->out);

        /* The apex is at 0 along every plane, and the outer edge at its limit: beyond both is beyond the
         * triangle. */
        limit = bvxi_vec_dot(planes->out, a);
        planes->limit = limit > 0 ? limit : 0;
    }
}

/* 1 when the corners of a triangle, seen from the new vertex and no further from it than reach, are all
 * beyond the outer edge of new triangle i, or all on one side of its plane, for certain: so it is with most
 * that are near a star. The new triangle's corners may be beyond these planes by rounding: a dozen roundings
 * of the star's size, and the margin is hundreds of the larger size. */
static int is_beyond(const bvxi_star *star, int32_t i, double q[3][3], double reach)
{
    const bvxi_star_planes *const planes = &star->planes[i];
    double const away = planes->limit + APART_MARGIN * planes->out_size * reach;
    double const off = APART_MARGIN * planes->normal_size * reach;
    double side[3];

    if ((int)(bvxi_vec_dot(planes->out, q[0]) > away) & (int)(bvxi_vec_dot(planes->out, q[1]) > away) &
        (int)(bvxi_vec_dot(planes->out, q[2]) > away))
        return 1;
    for (int k = 0; k < 3; k++) side[k] = bvxi_vec_dot(planes->normal, q[k]);
    return ((side[0] > off) & (side[1] > off) & (side[2] > off)) |
           ((side[0] < -off) & (side[1] < -off) & (side[2] < -off));
}

/* The corners of a triangle as seen from the new vertex; returns a size that neither they nor the star
 * exceed. */
static double see_corners(const bvxi_star *star, const double *const p[3], double q[3][3])
{
    double reach = star->reach;

    for (int k = 0; k < 3; k++) {
        double size;

        subtract(p[k], star->p, q[k]);
        size = size_of(q[k]);
        if (size > reach) reach = size;
    }
    return reach;
}

/* A triangle that stays against some of the new ones first .. first + 7, a bit each. */
static int meets_eight(const bvxi_corners *m, const bvxi_star *star, int32_t first, uint32_t bits,
                       const uint32_t *c)
{
    const double *const p[3] = {bvxi_corner_position(m, c[0]), bvxi_corner_position(m, c[1]),
                                bvxi_corner_position(m, c[2])};
    double q[3][3];
    double const reach = see_corners(star, p, q);

    for (; bits != 0; bits &= bits - 1) {
        int32_t const i = first + bvxi_lowest(bits);

        if (!is_beyond(star, i, q, reach) && new_triangle_meets(m, star, i, p)) return 1;
    }
    return 0;
}

/* A triangle that stays, found by the star's box, against the new ones that it shares no vertex with and
 * whose boxes overlap its own. Most are found since they share one. */
static int meets_new_triangles(const bvxi_corners *m, const bvxi_star *star, const bvxi_box_tree *tree,
                               int32_t triangle)
{
    const uint32_t *const c = m->triangle[triangle].vertex;
    bvxi_box_query const query = bvxi_box_ask_child(&tree->node[0][(uint32_t)triangle / BVXI_BOX_WIDTH],
                                                    triangle & (BVXI_BOX_WIDTH - 1));

    for (int32_t first = 0; first < star->count; first += BVXI_BOX_WIDTH) {
        /* New triangle i has link vertices i and i + 1, hence the shift. Pairs with a common vertex were
         * judged as fans. */
        uint32_t const common = common_vertices(star, first, c);
        uint32_t const bits = bvxi_box_overlaps(&star->node[first / BVXI_BOX_WIDTH], &query) &
                              ~(common | common >> 1);

        if (bits != 0 && meets_eight(m, star, first, bits, c)) return 1;
    }
    return 0;
}

/* Triangles that were found and wait for their memory. */
typedef struct found_triangles {
    int32_t count;
    int32_t triangle[BVXI_STAR_MOST];
} found_triangles;

static int meets_found(const bvxi_corners *m, const bvxi_star *star, const bvxi_box_tree *tree,
                       found_triangles *found)
{
    for (int32_t i = 0; i < found->count; i++) {
        int32_t const t = found->triangle[i];

        /* Triangles of the edge's ends are those that the collapse replaces. */
        if (has_vertex(m, t, star->u) | has_vertex(m, t, star->v)) continue;
        if (meets_new_triangles(m, star, tree, t)) return 1;
    }
    found->count = 0;
    return 0;
}

static int judge_neighbours(const bvxi_corners *m, const bvxi_box_tree *tree, bvxi_star *star,
                            const bvxi_box *all)
{
    bvxi_box_query const query = bvxi_box_ask(all);
    uint64_t stack[BVXI_BOX_STACK]; /* level in the low bits */
    found_triangles found;
    int32_t depth = 0;

    gather_nodes(star);
    gather_star_planes(m, star);

    /* What is looked at next is asked of memory before it is needed: waiting for it is most of the time. */
    found.count = 0;
    stack[depth++] = (uint64_t)(tree->levels - 1);
    while (depth > 0) {
        uint64_t const top = stack[--depth], index = top >> 4;
        int32_t const level = (int32_t)(top & 15);
        const bvxi_box_node *const node = &tree->node[level][index];

        /* In batches, so that the list has a fixed size and lines that were fetched early have come by
         * now. */
        if (found.count > BVXI_STAR_MOST - BVXI_BOX_WIDTH && meets_found(m, star, tree, &found))
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
                found.triangle[found.count++] = (int32_t)child;
            }
        }
    }
    return meets_found(m, star, tree, &found) ? BVXI_STAR_CROSSES : BVXI_STAR_SAFE;
}

int bvxi_star_judge(const bvxi_corners *m, const bvxi_box_tree *boxes, bvxi_star *star)
{
    int verdict = judge_shapes(m, star);
    bvxi_box all;

    if (verdict != BVXI_STAR_SAFE) return verdict;
    all = gather_boxes(m, boxes, star);

    /* From the cheapest test to the dearest. Most stars of a smooth surface end here. */
    if (boxes->faces && bvxi_star_is_one_sheet(m, boxes, star, &all)) return BVXI_STAR_SAFE;

    verdict = judge_new_fan(m, star);
    if (verdict == BVXI_STAR_SAFE) verdict = judge_link_fans(m, star);
    if (verdict == BVXI_STAR_SAFE) verdict = judge_neighbours(m, boxes, star, &all);
    return verdict;
}
