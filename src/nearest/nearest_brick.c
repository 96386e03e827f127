/* nearest_brick.c - the nearest triangles of a brick of 4 x 4 x 4 centres, and which of equally near ones is
 * taken.
 *
 * One search of the tree serves all 64 centres, since their nearest triangles are mostly the same few. What
 * floats cannot decide is evaluated in doubles. Guarantee: the choice depends on geometry only, on no
 * numbering. */
#include "nearest/nearest_brick.h"
#include "nearest/closest.h"
#include "mesh/facet.h"

#include <math.h>

/* ---- Which of equally near triangles is taken, by geometry only ---- */

/* Beside an edge or corner all of its triangles are equally near. The one whose plane is farthest from the
 * centre is the one that the centre sees most of: its plane bounds the body there, others run past behind it.
 * Where planes are equally far as well, the order of closest points decides, then that of corners; so no
 * numbering and no orientation shows. */

static void read_near_pair(const bvxi_near_pairs *p, int32_t i, double point[3], double t[3][3])
{
    for (int a = 0; a < 3; a++) point[a] = p->point[a][i];
    for (int v = 0; v < 9; v++) t[v / 3][v % 3] = p->corner[v][i];
}

/* Square of the distance from pair i's point to the plane of its triangle; 0 without area. */
static double near_height2(const bvxi_near_pairs *pairs, int32_t i)
{
    double point[3], t[3][3], n[3], along = 0.0, length;
    /* How far the point stands from the triangle's plane: of equally near ones the farthest faces it. */
    read_near_pair(pairs, i, point, t);
    length = bvxi_facet_normal((const double(*)[3])t, n);
    if (!(length > 0.0)) return 0.0;
    for (int a = 0; a < 3; a++) along += n[a] / length * (point[a] - t[0][a]);
    return along * along;
}

/* -1, 0 or 1: a comes before b, is the same, comes after. */
static int compare_near_places(const double a[3], const double b[3])
{
    return bvxi_corner_before(a, b) ? -1 : bvxi_corner_before(b, a);
}

/* One search of the tree lists the leaves for all 64; then each 2 x 2 x 2 of them looks through the list.
 * Where floats leave one candidate it is the answer; where they leave more (a shared edge or corner: all of
 * its triangles are equally far) the evaluation in doubles decides by (distance squared, triangle index).
 * Where a list or the candidates do not hold all, the search goes on in parts, and the evaluation keeps the
 * best so far.
 * Guarantee: the least (distance squared, triangle index) of the evaluation over all triangles of the
 * mesh. */

static double near_centre(const bvxi_nearest *n, int a, int32_t index)
{
    return (n->lattice.origin[a] + ((double)index + 0.5) * n->lattice.spacing[a]) * n->scale;
}

void bvxi_near_brick_begin(const bvxi_nearest *n, const int32_t first[3], bvxi_near_worker *w)
{
    /* Offsets from the brick's middle are small, so floats hold them well. */
    for (int a = 0; a < 3; a++) {
        for (int32_t i = 0; i < BVXI_NEAR_SIDE; i++) w->centre[a][i] = near_centre(n, a, first[a] + i);
        double const middle = (w->centre[a][0] + w->centre[a][BVXI_NEAR_SIDE - 1]) * 0.5;
        w->middle[a] = (middle - n->middle[a]) * n->box_scale;
        for (int i = 0; i < BVXI_NEAR_SIDE; i++)
            w->offset[a][i] = (float)((w->centre[a][i] - middle) * n->box_scale);
    }
}

/* ---- Pairs for the evaluation ---- */

/* Is the triangle of pair i taken instead of the best so far of its slot? */
static int is_better_pair(const bvxi_nearest *n, bvxi_near_worker *w, int32_t i)
{
    const bvxi_near_pairs *const p = &w->pairs;
    int32_t const s = p->slot[i];
    /* Nearer wins; equally near ones are ordered so that neither tree nor threads show. */
    if (p->distance2[i] != w->distance2[s]) return p->distance2[i] < w->distance2[s];
    if (!n->by_planes) return p->triangle[i] < w->triangle[s];
    double const height2 = near_height2(p, i);
    if (height2 != w->height2[s]) return height2 > w->height2[s];

    /* Two triangles are equally far from pair i's point, and so are their planes: is pair i's, not the
     * other, the one that is taken? */
    uint32_t const other = w->triangle[s];
    double point[3], t[3][3], u[3][3], q[3];
    double const closest[3] = {p->closest[0][i], p->closest[1][i], p->closest[2][i]};
    read_near_pair(p, i, point, t);
    bvxi_near_corners(n, other, u);
    bvxi_order_corners(u);
    /* By places alone, so that no numbering of the mesh shows; the index only where all places are equal. */
    bvxi_closest_on_triangle(point, (const double(*)[3])u, q);
    int order = compare_near_places(closest, q);
    for (int k = 0; k < 3 && order == 0; k++) order = compare_near_places(t[k], u[k]);
    return order != 0 ? order < 0 : p->triangle[i] < other;
}

static void settle_near_pairs(const bvxi_nearest *n, bvxi_near_worker *w)
{
    bvxi_near_pairs *const p = &w->pairs;

    bvxi_near_evaluate(n, w->fast, p);

    for (int32_t i = 0; i < p->count; i++) {
        int32_t const s = p->slot[i];
        uint64_t const bit = UINT64_C(1) << s;

        /* The first of a slot needs no comparison. */
        if ((w->evaluated & bit) != 0 && !is_better_pair(n, w, i)) continue;
        w->evaluated |= bit;
        w->distance2[s] = p->distance2[i];
        w->triangle[s] = p->triangle[i];
        if (n->by_planes) w->height2[s] = near_height2(p, i);
    }
    p->count = 0;
}

static void take_near_pair(const bvxi_nearest *n, bvxi_near_worker *w, uint32_t triangle, int32_t slot)
{
    double const point[3] = {w->centre[0][slot & 3], w->centre[1][slot >> 2 & 3], w->centre[2][slot >> 4]};
    /* A full room is emptied first; its results stay with their slots. */
    if (w->pairs.count == BVXI_NEAR_PAIRS) settle_near_pairs(n, w);
    bvxi_near_take_pair(n, &w->pairs, point, triangle, slot);
}

/* ---- Eight centres ---- */

static inline int32_t near_slot(int32_t g, int32_t c)
{
    return ((g & 1) * 2 + (c & 1)) + 4 * ((g & 2) + (c >> 1 & 1)) + 16 * ((g >> 2) * 2 + (c >> 2));
}

/* Look through the list, giving what may win to the evaluation when there is too much of it. */
static int32_t look_through_near_list(const bvxi_nearest *n, bvxi_near_worker *w)
{
    int32_t parts = 0;
    /* What was measured is settled to make room; the bounds that it gave stay. */
    bvxi_near_eight_take(&w->list, &w->sieve, w->fast, &w->eight);
    while (!bvxi_near_eight_look(n, &w->list, w->cell.origin, w->fast, &w->eight)) {
        float most2[8];
        int32_t const count = bvxi_near_eight_winners(n, w->fast, &w->eight, most2, w->winners);
        /* None is dropped here: whether it lies within the limit is asked at the end. */
        for (int32_t i = 0; i < count; i++)
            take_near_pair(n, w, w->winners[i].triangle, near_slot(w->eight.group, w->winners[i].centre));
        parts = 1;
    }
    return parts;
}

/* ---- Cells ---- */

/* A search that begins with the point that is known, or with any. */
static void begin_near_cell(const bvxi_nearest *n, const bvxi_near_start *start, bvxi_near_worker *w)
{
    bvxi_near_question *const q = &w->question;

    if (!w->known) {
        /* Any point of the mesh bounds the first search: that of the first leaf. */
        for (int a = 0; a < 3; a++)
            q->point[a] = (double)n->level[0][0].low[a][0] + (double)n->level[0][0].point[a][0];
        q->point_error = 0.0;
        for (int a = 0; a < 3; a++) { /* that of its leaf */
            double const low = (double)n->level[0][0].low[a][0], high = (double)n->level[0][0].high[a][0];
            q->point_error += (double)BVXI_NEAR_ERROR * (2.0 * (high - low) + (low < 0.0 ? -low : low));
        }
        w->known = 1;
    }
    bvxi_near_cell_begin(n, q, start, w->fast, &w->cell);
}

/* The box of the brick's centres begin .. end (along each axis). */
static void begin_near_box(const bvxi_nearest *n, const int32_t begin[3], const int32_t end[3], double limit,
                           bvxi_near_worker *w)
{
    for (int a = 0; a < 3; a++) {
        w->question.first[a] = w->middle[a] + (double)w->offset[a][begin[a]];
        w->question.last[a] = w->middle[a] + (double)w->offset[a][end[a]];
    }
    /* The box, its limit and the point that is known are all that a search goes by. */
    w->question.limit = limit;
    begin_near_cell(n, &w->start, w);
}

/* The nearest point seen begins the next search. */
static void keep_near_point(bvxi_near_worker *w)
{
    for (int a = 0; a < 3; a++) w->question.point[a] = (double)w->cell.origin[a] + (double)w->cell.point[a];
    w->question.point_error = (double)w->cell.point_error;
}

/* The cell's list, seen from the brick's centres. */
static void sieve_near_part(bvxi_near_worker *w)
{
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < BVXI_NEAR_SIDE; i++)
            w->places.at[a][i] = (float)((double)w->offset[a][i] +
                                         (w->middle[a] - (double)w->cell.origin[a]));
    bvxi_near_sieve_list(&w->list, &w->places, bvxi_near_cell_reach2(&w->cell), w->fast, &w->sieve);
}

/* The next part of the list. Returns 1 when it is the last. */
static int32_t list_near_part(const bvxi_nearest *n, bvxi_near_worker *w)
{
    int32_t const complete = bvxi_near_cell_list(n, &w->cell, w->fast, &w->list);
    sieve_near_part(w);
    return complete;
}

/* ---- Far from everything ---- */

enum { NEAR_FEW_BLOCKS = 4 };

/* Is the middle of the cell, whose list is complete and short, so far from all triangles that no centre of
 * the cell lies within the limit? Boxes of large triangles hold much that is far from them. */
static int32_t is_far_from_near_list(const bvxi_nearest *n, bvxi_near_worker *w)
{
    bvxi_near_places middle;
    double radius2 = 0.0;

    /* A long list means that something is near: no need to prove it. */
    if (w->list.count > NEAR_FEW_BLOCKS || !(w->question.limit < 0x1p50)) return 0;
    /* No centre of the cell is further from its middle than the radius. */
    for (int a = 0; a < 3; a++) {
        double const half = (w->question.last[a] - w->question.first[a]) * 0.5;
        radius2 += half * half;
        for (int i = 0; i < BVXI_NEAR_SIDE; i++)
            middle.at[a][i] = (float)(w->question.first[a] + half - (double)w->cell.origin[a]);
    }
    float const reach = (float)((w->question.limit + sqrt(radius2)) * (1.0 + 0x1p-10)) + 8.0f * w->list.error;
    float const reach2 = reach * reach;

    /* The list is sieved for the middle as it would be for centres. */
    bvxi_near_sieve_list(&w->list, &middle, reach2, w->fast, &w->sieve);

    bvxi_near_eight_begin(0, &middle, 1, reach2, &w->eight);
    bvxi_near_eight_take(&w->list, &w->sieve, w->fast, &w->eight);
    while (!bvxi_near_eight_look(n, &w->list, w->cell.origin, w->fast, &w->eight)) w->eight.count = 0;
    return w->eight.least2[0] >= reach2;
}

/* ---- Cubes ---- */

static void bound_near_cube(const bvxi_nearest *n, const int32_t first[3], double width, bvxi_near_worker *w)
{
    for (int a = 0; a < 3; a++) {
        w->question.first[a] = (near_centre(n, a, first[a]) - n->middle[a]) * n->box_scale;
        w->question.last[a] = (near_centre(n, a, first[a] + BVXI_NEAR_CUBE - 1) - n->middle[a]) *
                              n->box_scale;
    }
    w->question.limit = width * n->scale * n->box_scale;
    begin_near_cell(n, NULL, w);
}

void bvxi_near_cube_begin(const bvxi_nearest *n, const int32_t first[3], double width, bvxi_near_worker *w)
{
    bound_near_cube(n, first, width, w);
    bvxi_near_cell_start(n, &w->cell, w->fast, &w->start);
}

int32_t bvxi_near_cube_reaches(const bvxi_nearest *n, const int32_t first[3], double width,
                               bvxi_near_worker *w)
{
    bound_near_cube(n, first, width, w);
    /* A list that is cut short means that much is near. */
    if (!bvxi_near_cell_list(n, &w->cell, w->fast, &w->list)) return 1;
    keep_near_point(w);
    return w->list.count > 0 && !is_far_from_near_list(n, w);
}

/* ---- Bricks ---- */

/* Group g from the list, and from the rest of the cell's search where the list does not hold all. */
static void find_near_eight(const bvxi_nearest *n, int32_t g, uint32_t active, double limit, int32_t complete,
                            bvxi_near_worker *w)
{
    float const sure = (float)(limit * (1.0 - 0x1p-18)), sure2 = limit < 0x1p60 ? sure * sure : 0x1p127f;
    bvxi_near_eight_begin(g, &w->places, active, w->cell.limit2, &w->eight);
    /* Each part of a long list starts from what the parts before left as bound. */
    int32_t parts = look_through_near_list(n, w);
    while (!complete) {
        complete = list_near_part(n, w);
        parts |= look_through_near_list(n, w);
    }

    /* The end of a search: where one triangle alone may win within the limit, it is taken at once. */
    float most2[8];
    int32_t const count = bvxi_near_eight_winners(n, w->fast, &w->eight, most2, w->winners);
    uint32_t once = 0, more = parts ? 255u : 0;

    /* More than one candidate, or one that may lie beyond the limit, is for doubles to decide. */
    for (int c = 0; c < 8; c++) more |= (uint32_t) !(most2[c] < sure2) << c;

    /* A centre with two candidates is among more after the second. */
    for (int32_t i = 0; i < count; i++) {
        uint32_t const bit = 1u << w->winners[i].centre;
        more |= once & bit;
        once |= bit;
    }
    for (int32_t i = 0; i < count; i++) {
        int32_t const c = w->winners[i].centre, slot = near_slot(w->eight.group, c);
        if (more >> c & 1) take_near_pair(n, w, w->winners[i].triangle, slot);
        else w->triangle[slot] = w->winners[i].triangle;
    }
}

static void find_near_groups(const bvxi_nearest *n, uint64_t wanted, double limit, bvxi_near_worker *w)
{
    int32_t begin[3], end[3], complete;

    /* The 64 slots are bits x + 4 y + 16 z, so folding them by shifts gives the shadow along each axis. */
    uint64_t const y = wanted | wanted >> 16 | wanted >> 32 | wanted >> 48, x = y | y >> 4 | y >> 8 | y >> 12;

    for (int a = 0; a < 3; a++) {
        begin[a] = BVXI_NEAR_SIDE;
        end[a] = 0;
    }

    for (int32_t i = 0; i < BVXI_NEAR_SIDE; i++) {
        int const is[3] = {(x >> i & 1) != 0, (y >> 4 * i & 15) != 0, (wanted >> 16 * i & 0xffff) != 0};
        for (int a = 0; a < 3; a++) {
            if (is[a] && begin[a] == BVXI_NEAR_SIDE) begin[a] = i;
            if (is[a]) end[a] = i;
        }
    }

    begin_near_box(n, begin, end, limit, w);
    complete = bvxi_near_cell_list(n, &w->cell, w->fast, &w->list);
    keep_near_point(w);

    /* Most bricks of a band's edge are too far from anything: they end before any triangle is looked at. */
    if (complete && (w->list.count == 0 || (w->few_reached && is_far_from_near_list(n, w)))) return;
    sieve_near_part(w);

    /* Groups share the list and the squares of its boxes, which cost more than a group's own look. */
    for (int32_t g = 0; g < 8; g++) {
        /* Bits of the group's slots: two of a row, two rows of a layer, two layers. */
        uint32_t const slots = (uint32_t)(wanted >> near_slot(g, 0));
        uint32_t const active = (slots & 3) | (slots >> 2 & 0xc) | (slots >> 12 & 0x30) |
                                (slots >> 14 & 0xc0);
        if (active == 0) continue;
        if (!complete) { /* a list for these only */
            for (int a = 0; a < 3; a++) {
                begin[a] = (g >> a & 1) * 2;
                end[a] = begin[a] + 1;
            }
            begin_near_box(n, begin, end, limit, w);
            find_near_eight(n, g, active, limit, list_near_part(n, w), w);
        } else {
            find_near_eight(n, g, active, limit, 1, w);
        }
    }
}

uint64_t bvxi_near_brick_find(const bvxi_nearest *n, uint64_t wanted, double width, bvxi_near_worker *w)
{
    uint64_t found = 0;

    w->evaluated = 0;
    w->pairs.count = 0;
    memset(w->triangle, 0xff, sizeof w->triangle); /* BVXI_NEAR_NONE */
    find_near_groups(n, wanted, width * n->scale * n->box_scale, w);
    settle_near_pairs(n, w);

    /* Boxes promise less than triangles do: what lies beyond the width is dropped by its distance. */
    for (uint64_t m = width < HUGE_VAL ? w->evaluated : 0; m != 0; m &= m - 1) {
        int32_t const s = bvxi_lowest(m);
        if (!(sqrt(w->distance2[s]) / n->scale <= width)) w->triangle[s] = BVXI_NEAR_NONE;
    }
    for (uint64_t m = wanted; m != 0; m &= m - 1) {
        int32_t const s = bvxi_lowest(m);
        found |= (uint64_t)(w->triangle[s] != BVXI_NEAR_NONE) << s;
    }
    return found;
}
