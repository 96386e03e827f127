/* shift.c - slanted parts: sections put in between two whose parts share too little to join (shift_discs.c).
 *
 * At a share t of the way a group of discs is where (1 - t) a(x - t by) + t b(x + (1 - t) by) is positive:
 * the blend of its signed distances on both planes, each moved to where the group is by then. Outlines are
 * joined, holes cut out of them, islands put in again, and the border is traced on a lattice by marching
 * squares.
 *
 * What the borders enclose stays within the blend of the boxes on both planes: a signed distance is at most
 * that to any line beyond its disc, and these blend to a line between both. So the added contours lie in the
 * box of the given ones. Distances have a slope of at most 1, and so has their blend: from a place that is d
 * off the border nothing within d needs a look.
 *
 * Source: Herman, Zheng, Bucholtz. Shape-based Interpolation. 1992; the blend, here of moved parts. */
#include "layers/shift.h"

#include <math.h>

enum { SHIFT_FINEST = 8, SHIFT_MOST_SIDE = 4096, SHIFT_WIDTH_CELLS = 8, SHIFT_MARGIN = 2 };

/* Shares of an edge that its crossing keeps off the lattice points, so that no two points of loops meet. */
#define SHIFT_OFF 0.02

typedef struct shift_lattice {
    const bvxi_stack *s;
    bvxi_discs *on;
    bvxi_disc_groups *g;
    bvxi_mended *to;
    double origin[2], step[2];
    int32_t size[2]; /* points */
    double *value;   /* of the body: positive inside */
    double *level;   /* of the discs of one depth */
    uint64_t *seen;  /* edges along u whose crossing is in a loop */
    double w;        /* of the section that is made */
    uint32_t section;
} shift_lattice;

static double *shift_value(double *value, const shift_lattice *l, int32_t i, int32_t j)
{
    return value + (size_t)j * (size_t)l->size[0] + (size_t)i;
}

/* ---- the field ---- */

/* A group at a share of the way. What ends is gone half way: its deepest place is as deep as it sank. */
static double group_value(shift_lattice *l, const bvxi_disc_group *g, double t, double u, double v)
{
    double value[2];
    for (int k = 0; k < 2; k++) {
        /* The place as seen from the plane: moved back by the part of the shift that the group has gone. */
        double const back = k == 0 ? -t : 1.0 - t;
        value[k] = g->count[k] == 0
                       ? -g->deep
                       : bvxi_disc_group_distance(l->on, g, k, u + back * g->by[0], v + back * g->by[1]);
    }
    return (1.0 - t) * value[0] + t * value[1];
}

static void lattice_range(const shift_lattice *l, const bvxi_disc_group *g, double t, int32_t range[2][2])
{
    for (int k = 0; k < 2; k++) {
        /* Of a group that ends both boxes are the one that it has. */
        const double *const a = g->box[g->count[0] == 0], *const b = g->box[g->count[1] != 0];
        double const low = (1.0 - t) * a[k] + t * b[k], high = (1.0 - t) * a[k + 2] + t * b[k + 2];
        double const first = floor((low - l->origin[k]) / l->step[k]) - 1.0;
        double const last = floor((high - l->origin[k]) / l->step[k]) + 2.0;
        range[k][0] = first > 0.0 ? (int32_t)first : 0;
        range[k][1] = last < l->size[k] - 1 ? (int32_t)last : l->size[k] - 1;
    }
}

static void fill_group_values(shift_lattice *l, const bvxi_disc_group *g, double t)
{
    double const edge = l->step[0] > l->step[1] ? l->step[0] : l->step[1];
    int32_t range[2][2];

    lattice_range(l, g, t, range);
    for (int32_t j = range[1][0]; j <= range[1][1]; j++)
        for (int32_t i = range[0][0]; i <= range[0][1]; i++) {
            double const d = group_value(l, g, t, l->origin[0] + i * l->step[0],
                                         l->origin[1] + j * l->step[1]);
            double const far = ((d < 0.0 ? -d : d) - edge) / l->step[0];
            int32_t const most = range[0][1] - i, reach = far > most ? most : far > 0.0 ? (int32_t)far : 0;
            /* Values that were passed over are bounds, so that the greatest of groups has the right sign. */
            for (int32_t n = 0; n <= reach; n++) {
                double *const value = shift_value(l->level, l, i + n, j);
                double const bound = d < 0.0 ? d + n * l->step[0] : d - n * l->step[0];
                if (bound > *value) *value = bound;
            }
            i += reach;
        }
}

/* Outlines, less holes, with islands, and so on. */
static void fill_values(shift_lattice *l, double t)
{
    size_t const n = (size_t)l->size[0] * (size_t)l->size[1];
    for (size_t i = 0; i < n; i++) l->value[i] = -1e300;
    for (uint32_t depth = 0; depth < l->g->depths; depth++) {
        for (size_t i = 0; i < n; i++) l->level[i] = -1e300;
        for (uint32_t i = 0; i < l->g->count; i++)
            if (l->g->group[i].depth == depth) fill_group_values(l, &l->g->group[i], t);
        for (size_t i = 0; i < n; i++) {
            double const level = l->level[i];
            if (depth % 2 == 0 && level > l->value[i]) l->value[i] = level;
            else if (depth % 2 == 1 && -level < l->value[i]) l->value[i] = -level;
        }
    }
}

/* How deep inside a group that ends is at most, on the lattice; half the width of one that holds no point
 * of it. */
static void find_deep(shift_lattice *l, bvxi_disc_group *g)
{
    int const k = g->count[0] == 0;
    int32_t range[2][2];
    lattice_range(l, g, k, range);
    for (int32_t j = range[1][0]; j <= range[1][1]; j++)
        for (int32_t i = range[0][0]; i <= range[0][1]; i++) {
            double const d = bvxi_disc_group_distance(l->on, g, k, l->origin[0] + i * l->step[0],
                                                      l->origin[1] + j * l->step[1]);
            if (d > g->deep) g->deep = d;
        }
    if (g->deep == 0.0) g->deep = 0.5 * l->on[k].disc[g->first[k]].width;
}

/* ---- its border ---- */

static int value_inside(shift_lattice *l, int32_t i, int32_t j)
{
    return *shift_value(l->value, l, i, j) > 0.0;
}

static bvx_status add_crossing(shift_lattice *l, int32_t i, int32_t j, int axis)
{
    double const a = *shift_value(l->value, l, i, j),
                 b = *shift_value(l->value, l, i + (axis == 0), j + axis);
    double share = a / (a - b), at[2], place[3];
    /* Also where the values are bounds, of which one may be infinitely large. */
    if (!(share > SHIFT_OFF)) share = SHIFT_OFF;
    if (share > 1.0 - SHIFT_OFF) share = 1.0 - SHIFT_OFF;
    at[0] = l->origin[0] + (i + (axis == 0 ? share : 0.0)) * l->step[0];
    at[1] = l->origin[1] + (j + (axis == 1 ? share : 0.0)) * l->step[1];
    bvxi_section_place(l->s, at[0], at[1], l->w, place);
    return bvxi_mended_add_point(l->to, place, 0, 0);
}

/* Sides of a cell are 0 low v, 1 high u, 2 high v, 3 low u, its corners 0 to 3 counter-clockwise from the
 * low one; side n runs from corner n to the next one. */
/* The side by which a border leaves that came in by one, inside on its left. Where all four sides are
 * crossed it turns right around the corner outside when the middle is inside, else left. */
static int leaving_side(shift_lattice *l, int32_t i, int32_t j, int from)
{
    int const inside[4] = {value_inside(l, i, j), value_inside(l, i + 1, j), value_inside(l, i + 1, j + 1),
                           value_inside(l, i, j + 1)};
    if (inside[0] != inside[1] && inside[1] != inside[2] && inside[2] != inside[3]) {
        double const middle = (*shift_value(l->value, l, i, j) + *shift_value(l->value, l, i + 1, j)) +
                              (*shift_value(l->value, l, i, j + 1) + *shift_value(l->value, l, i + 1, j + 1));
        return middle > 0.0 ? (from + 1) & 3 : (from + 3) & 3;
    }
    for (int n = 1; n < 3; n++)
        if (inside[(from + n) & 3] != inside[(from + n + 1) & 3]) return (from + n) & 3;
    return (from + 3) & 3;
}

/* 1: the crossing of an edge along u was not seen before. */
static int see_edge(shift_lattice *l, int32_t i, int32_t j)
{
    size_t const n = (size_t)j * (size_t)l->size[0] + (size_t)i;
    uint64_t const bit = UINT64_C(1) << (n & 63);
    int const is_new = (l->seen[n >> 6] & bit) == 0;
    l->seen[n >> 6] |= bit;
    return is_new;
}

/* From the crossing of an edge along u around to it again: up where its low end is inside, else down. */
static bvx_status trace_loop(shift_lattice *l, int32_t i, int32_t j)
{
    int const up = value_inside(l, i, j);
    int32_t const start[2] = {i, j};
    int from = up ? 0 : 2;

    BVXI_TRY(bvxi_mended_add_loop(l->to, l->section, l->s->options.label));

    /* Inside is on the left of the way, so that it comes into the cell below from its upper side. */
    if (!up) j--;
    for (;;) {
        int32_t const x = i + (from == 1), y = j + (from == 2);
        if (from % 2 == 0) (void)see_edge(l, x, y);
        BVXI_TRY(add_crossing(l, x, y, from % 2));

        int const side = leaving_side(l, i, j, from);
        if (side == 0) j--;
        else if (side == 1) i++;
        else if (side == 2) j++;
        else i--;
        from = (side + 2) & 3;
        /* Back at the first edge; cells on both sides of it may be where it is entered from. */
        if (from % 2 == 0 && i == start[0] && j + (from == 2) == start[1]) return BVX_OK;
    }
}

/* ---- sections ---- */

/* Cells halved until the thinnest moving part is some of them wide; half a cell aside, off its lines. */
static void lay_shift_lattice(shift_lattice *l)
{
    const bvxi_stack *const s = l->s;
    double const larger = s->step[0] > s->step[1] ? s->step[0] : s->step[1];
    int32_t const most = s->size[0] > s->size[1] ? s->size[0] : s->size[1];
    int32_t fold = 1;
    while (fold < SHIFT_FINEST && larger / fold > l->g->width / SHIFT_WIDTH_CELLS &&
           2 * fold * most <= SHIFT_MOST_SIDE)
        fold *= 2;
    for (int k = 0; k < 2; k++) {
        l->step[k] = s->step[k] / fold;
        l->size[k] = s->size[k] * fold + 2 * SHIFT_MARGIN;
        l->origin[k] = s->origin[k] + (0.5 - SHIFT_MARGIN) * l->step[k];
    }
}

static bvx_status add_sections(shift_lattice *l, uint32_t number)
{
    double const below = l->on[0].plane->w, above = l->on[1].plane->w;
    for (uint32_t i = 0; i < l->g->count; i++)
        if (l->g->group[i].count[0] == 0 || l->g->group[i].count[1] == 0) find_deep(l, &l->g->group[i]);
    for (uint32_t n = 1; n < l->g->steps; n++) {
        double const t = (double)n / l->g->steps;
        BVXI_TRY(bvxi_progress(l->s->ctx, "join", t));
        l->w = below + t * (above - below);
        l->section = number + n - 1;
        fill_values(l, t);

        /* Each loop crosses an edge along u: at the end of a run of points inside. */
        size_t const words = ((size_t)l->size[0] * (size_t)l->size[1] + 63) / 64;
        memset(l->seen, 0, words * 8);
        for (int32_t j = 0; j < l->size[1]; j++)
            for (int32_t i = 0; i + 1 < l->size[0]; i++)
                if (value_inside(l, i, j) != value_inside(l, i + 1, j) && see_edge(l, i, j))
                    BVXI_TRY(trace_loop(l, i, j));
    }
    return BVX_OK;
}

/* ---- all pairs ---- */

/* Sections are put in where a part moves by more than an eighth of its width, as many as make neighbours overlap by
 * most of it. The given ones stay, so the surface passes through their contours as without. */

static bvx_status copy_plane(const bvxi_stack *s, const bvxi_plane *p, uint32_t number, bvxi_mended *to)
{
    for (uint32_t c = 0; c < p->contour_count; c++) {
        BVXI_TRY(bvxi_mended_add_loop(to, number, s->options.label));
        for (uint32_t i = p->contour[c].first; i < p->contour[c].first + p->contour[c].count; i++) {
            uint64_t const at = p->given[i];
            BVXI_TRY(bvxi_mended_add_point(to, s->given->points + 3 * at,
                                           s->nudge == NULL ? 0 : s->nudge[at][0],
                                           s->nudge == NULL ? 0 : s->nudge[at][1]));
        }
    }
    return BVX_OK;
}

/* Points may lie off their plane by a quarter of the way to the next one, also those put in. */
static void keep_points_near(const bvxi_stack *s, const bvxi_plane *pair, bvxi_disc_groups *g)
{
    double const gap = pair[1].w - pair[0].w;
    double most = 0.0;
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < pair[k].point_count; i++) {
            double const off = bvxi_along_axis(s->axis[2],
                                               s->given->points + 3 * (uint64_t)pair[k].given[i]) -
                               pair[k].w;
            if (off > most) most = off;
            if (-off > most) most = -off;
        }
    /* A little less than the quarter that is checked, for rounding. */
    while (g->steps > 1 && 0.2 * gap / g->steps < most) g->steps--;
}

static bvx_status add_shift_position(bvxi_shifted *to, double w)
{
    bvx_sections *const body = &to->body.sections;
    BVXI_TRY(BVXI_GROW(&to->body, to->positions, body->section_count, to->position_room,
                       "the positions of sections"));
    to->positions[body->section_count++] = w;
    return BVX_OK;
}

static bvx_status shift_pair(const bvxi_stack *s, const bvxi_plane *pair, bvxi_shifted *to)
{
    uint32_t const number = (uint32_t)to->body.sections.section_count;
    bvxi_disc_groups g;
    bvxi_discs on[2];

    for (int k = 0; k < 2; k++) BVXI_TRY(bvxi_discs_open(s, &pair[k], &on[k]));
    /* Positions first, as the loops are numbered by them. */
    BVXI_TRY(bvxi_disc_groups_open(s, on, &g));
    keep_points_near(s, pair, &g);
    for (uint32_t n = 1; n < g.steps; n++)
        BVXI_TRY(add_shift_position(to, pair[0].w + (double)n / g.steps * (pair[1].w - pair[0].w)));
    if (g.steps == 1) return BVX_OK;
    to->sections += g.steps - 1;
    to->parts += g.shifted;

    /* The loops of the sections between, which count on from number. */
    shift_lattice l = {.s = s, .on = on, .g = &g, .to = &to->body};
    lay_shift_lattice(&l);
    uint64_t const points = (uint64_t)l.size[0] * (uint64_t)l.size[1];
    BVXI_TRY(BVXI_ARRAY(s->ctx, points, "a section between two", l.value));
    BVXI_TRY(BVXI_ARRAY(s->ctx, points, "a section between two", l.level));
    BVXI_TRY(BVXI_ARRAY(s->ctx, (points + 63) / 64, "a section between two", l.seen));
    BVXI_TRY(add_sections(&l, number));
    bvxi_drop(s->ctx, l.seen);
    bvxi_drop(s->ctx, l.level);
    bvxi_drop(s->ctx, l.value);
    return BVX_OK;
}

bvx_status bvxi_shift_stack(const bvxi_stack *s, bvxi_shifted *to)
{
    *to = (bvxi_shifted){.body = {.ctx = s->ctx, .function = s->function}};
    memcpy(to->body.sections.normal, s->given->normal, sizeof s->given->normal);
    bvxi_stack_give_grid(s, &to->body.grid);

    for (uint32_t i = 0; i < s->plane_count; i++) {
        double const done = (double)i / s->plane_count;
        BVXI_TRY(add_shift_position(to, s->plane[i].w));
        BVXI_TRY(copy_plane(s, &s->plane[i], (uint32_t)to->body.sections.section_count - 1, &to->body));
        /* Towards a section without loops the body ends, whatever is beyond. */
        if (i + 1 < s->plane_count && s->plane[i].contour_count != 0 && s->plane[i + 1].contour_count != 0)
            BVXI_TRY(BVXI_SHARE(s->ctx, done, (i + 1.0) / s->plane_count, shift_pair(s, &s->plane[i], to)));
    }
    to->body.sections.positions = to->positions;
    return BVX_OK;
}
