/* shift_discs.c - which parts of two sections become each other, and by how much they move on the way.
 *
 * A disc is what a loop encloses, holes filled: outlines, holes and islands are discs of depth 0, 1 and 2,
 * and discs of one depth never overlap. Discs of one depth that overlap a disc of the other section form a
 * group with it. Those that overlap none are paired by their centres, the nearest first; of equally near
 * ones that of the lowest number below, then above.
 *
 * A group of one disc on either plane moves from one centre to the other; where a part splits or joins, no
 * single shift is right and it stays where it is. A disc that is left alone ends half way. */
#include "layers/shift.h"

#include <math.h>

enum { SHIFT_MOST_STEPS = 64, SHIFT_STEPS_A_WIDTH = 8 };

/* ---- discs of a plane ---- */

static void disc_box(const bvxi_plane *p, const bvxi_contour *c, double box[4])
{
    for (int k = 0; k < 2; k++) box[k] = box[k + 2] = p->uv[c->first][k];
    for (uint32_t i = c->first; i < c->first + c->count; i++) bvxi_widen(box, box + 2, p->uv[i], 2);
}

/* Area, centre and width, from the loop's first point, so that far coordinates cost no digits. */
static void measure_disc(const bvxi_plane *p, const bvxi_contour *c, bvxi_disc *d)
{
    const double *const o = p->uv[c->first];
    double twice = 0.0, border = 0.0, sum[2] = {0.0, 0.0};

    for (uint32_t i = c->first; i < c->first + c->count; i++) {
        const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
        double const ax = a[0] - o[0], ay = a[1] - o[1], bx = b[0] - o[0], by = b[1] - o[1];
        double const cross = ax * by - ay * bx;
        twice += cross;
        sum[0] += cross * (ax + bx);
        sum[1] += cross * (ay + by);
        border += sqrt((bx - ax) * (bx - ax) + (by - ay) * (by - ay));
    }

    /* A loop whose area is lost in rounding has the middle of its box as centre. */
    d->area = 0.5 * (twice < 0.0 ? -twice : twice);
    d->width = 4.0 * d->area / border;
    for (int k = 0; k < 2; k++) {
        d->centre[k] = twice != 0.0 ? o[k] + sum[k] / (3.0 * twice) : 0.5 * (d->box[k] + d->box[k + 2]);
        if (!(d->centre[k] >= d->box[k] && d->centre[k] <= d->box[k + 2]))
            d->centre[k] = 0.5 * (d->box[k] + d->box[k + 2]);
    }
}

static int in_disc_box(const double box[4], const double *at)
{
    return at[0] >= box[0] && at[0] <= box[2] && at[1] >= box[1] && at[1] <= box[3];
}

bvx_status bvxi_discs_open(const bvxi_stack *s, const bvxi_plane *p, bvxi_discs *d)
{
    uint32_t *segment;

    memset(d, 0, sizeof *d);
    d->plane = p;
    d->count = p->contour_count;
    BVXI_TRY(BVXI_ZEROS(s->ctx, d->count, "the parts of a section", d->disc));
    BVXI_TRY(BVXI_ARRAY(s->ctx, p->point_count, "the parts of a section", segment));
    for (uint32_t i = 0; i < p->point_count; i++) segment[i] = i;
    for (uint32_t c = 0; c < d->count; c++) {
        bvxi_disc *const disc = &d->disc[c];

        /* A view of the plane with the segments of one loop, and a tree of its own. */
        disc->view.uv = p->uv;
        disc->view.q = p->q;
        disc->view.next = p->next;
        disc->view.segment = segment + p->contour[c].first;
        disc->view.segment_count = p->contour[c].count;
        BVXI_TRY(bvxi_plane_open_tree(s->ctx, &disc->view, disc->view.segment_count));
        bvxi_plane_tree(&disc->view);
        disc_box(p, &p->contour[c], disc->box);
        measure_disc(p, &p->contour[c], disc);
    }

    /* Loops do not touch, so one point of a loop says whether all of it lies in another. */
    for (uint32_t i = 0; i < d->count; i++) {
        uint32_t const at = p->contour[i].first;
        for (uint32_t j = 0; j < d->count; j++)
            if (j != i && in_disc_box(d->disc[j].box, p->uv[at]) &&
                bvxi_loop_contains(p, &p->contour[j], p->q[at]))
                d->disc[i].depth++;
    }
    return BVX_OK;
}

/* ---- which overlap ---- */

/* Discs of both planes in one row: those above follow those below. */
static bvxi_disc *disc_at(bvxi_discs on[2], uint32_t i)
{
    return i < on[0].count ? &on[0].disc[i] : &on[1].disc[i - on[0].count];
}

static int has_point_in(const bvxi_disc *a, const bvxi_disc *b)
{
    for (uint32_t i = 0; i < a->view.segment_count; i++) {
        const double *const at = a->view.uv[a->view.segment[i]];
        if (in_disc_box(b->box, at) && bvxi_plane_encloses(&b->view, at[0], at[1])) return 1;
    }
    return 0;
}

/* By their points. Two that cross like a plus have none in each other; their centres pair them. */
static int discs_overlap(const bvxi_disc *a, const bvxi_disc *b)
{
    for (int k = 0; k < 2; k++)
        if (a->box[k] > b->box[k + 2] || b->box[k] > a->box[k + 2]) return 0;
    return has_point_in(a, b) || has_point_in(b, a);
}

/* ---- the nearest of those that do not ---- */

typedef struct shift_near {
    uint32_t to; /* disc above, or BVXI_NONE */
    double square;
} shift_near;

static double centre_square(const bvxi_disc *a, const bvxi_disc *b)
{
    double const x = b->centre[0] - a->centre[0], y = b->centre[1] - a->centre[1];
    return x * x + y * y;
}

static shift_near find_near_disc(bvxi_discs on[2], const uint8_t *met, uint32_t i, double reach)
{
    shift_near near = {BVXI_NONE, reach * reach};
    for (uint32_t j = 0; j < on[1].count; j++) {
        if (met[on[0].count + j] || on[1].disc[j].depth != on[0].disc[i].depth) continue;
        double const square = centre_square(&on[0].disc[i], &on[1].disc[j]);
        /* Of equally near ones the first stays; one just at the reach is taken too. */
        if (square < near.square || (square == near.square && near.to == BVXI_NONE)) {
            near.to = j;
            near.square = square;
        }
    }
    return near;
}

/* The nearest pair is joined, until none is left. A disc's nearest is found anew when it was taken. */
static void join_nearest(bvxi_discs on[2], uint8_t *met, uint32_t *joined, shift_near *near, double reach)
{
    for (uint32_t i = 0; i < on[0].count; i++)
        if (!met[i]) near[i] = find_near_disc(on, met, i, reach);
    for (;;) {
        uint32_t best = BVXI_NONE;
        for (uint32_t i = 0; i < on[0].count; i++)
            if (!met[i] && near[i].to != BVXI_NONE &&
                (best == BVXI_NONE || near[i].square < near[best].square))
                best = i;
        if (best == BVXI_NONE) return;

        if (met[on[0].count + near[best].to]) {
            near[best] = find_near_disc(on, met, best, reach);
            continue;
        }
        met[best] = met[on[0].count + near[best].to] = 1;
        bvxi_join(joined, best, on[0].count + near[best].to);
    }
}

/* ---- groups ---- */

static void add_to_group(bvxi_disc_groups *g, bvxi_discs on[2], int k, uint32_t number)
{
    bvxi_disc *const d = &on[k].disc[number];
    bvxi_disc_group *const group = &g->group[d->group];
    for (int i = 0; i < 2; i++) {
        if (group->count[k] == 0 || d->box[i] < group->box[k][i]) group->box[k][i] = d->box[i];
        if (group->count[k] == 0 || d->box[i + 2] > group->box[k][i + 2])
            group->box[k][i + 2] = d->box[i + 2];
    }
    d->next = group->count[k]++ == 0 ? BVXI_NONE : group->first[k];
    group->first[k] = number;
    group->depth = d->depth;
    if (d->depth >= g->depths) g->depths = d->depth + 1;
}

static void number_groups(bvxi_disc_groups *g, bvxi_discs on[2], uint32_t *joined)
{
    uint32_t const n = on[0].count + on[1].count;
    /* A root is the lowest of its group, so it has its number before the others look it up. */
    for (uint32_t i = 0; i < n; i++) {
        uint32_t const root = bvxi_root(joined, i);
        disc_at(on, i)->group = root == i ? g->count++ : disc_at(on, root)->group;
    }
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < on[k].count; i++) add_to_group(g, on, k, i);
}

/* One disc on either plane: how far it moves, in how many steps so that neighbours overlap by most of it. */
static void set_shift(bvxi_disc_groups *g, bvxi_discs on[2], bvxi_disc_group *group, double reach)
{
    const bvxi_disc *const a = &on[0].disc[group->first[0]], *const b = &on[1].disc[group->first[1]];
    double const width = a->width < b->width ? a->width : b->width, far = sqrt(centre_square(a, b));
    double const share = width > 0.0 ? far * SHIFT_STEPS_A_WIDTH / width : 0.0;
    double const steps = floor(share) < share ? floor(share) + 1.0 : share;
    /* Discs that overlap may have centres farther apart than is to be shifted: they stay where they are. */
    if (far > reach) return;
    for (int k = 0; k < 2; k++) group->by[k] = b->centre[k] - a->centre[k];
    if (!(steps > 1.0)) return;
    if (g->shifted++ == 0 || width < g->width) g->width = width;
    if (steps > SHIFT_MOST_STEPS) g->steps = SHIFT_MOST_STEPS;
    else if (steps > g->steps) g->steps = (uint32_t)steps;
}

bvx_status bvxi_disc_groups_open(const bvxi_stack *s, bvxi_discs on[2], bvxi_disc_groups *g)
{
    uint64_t const n = (uint64_t)on[0].count + on[1].count;
    double const reach = s->options.slabs.join;
    shift_near *near = NULL;
    uint8_t *met = NULL;
    uint32_t *joined = NULL;

    memset(g, 0, sizeof *g);
    g->steps = 1;
    BVXI_TRY(BVXI_ZEROS(s->ctx, n, "the parts that join", g->group));
    BVXI_TRY(BVXI_ZEROS(s->ctx, n, "the parts that join", met));
    BVXI_TRY(BVXI_ARRAY(s->ctx, on[0].count, "the parts that join", near));
    BVXI_TRY(BVXI_ARRAY(s->ctx, n, "the parts that join", joined));
    for (uint32_t i = 0; i < n; i++) joined[i] = i;

    /* Overlaps first: only what has none is looked for further off. */
    for (uint32_t i = 0; i < on[0].count; i++)
        for (uint32_t j = 0; j < on[1].count; j++) {
            const bvxi_disc *const a = &on[0].disc[i], *const b = &on[1].disc[j];
            if (a->depth != b->depth || !discs_overlap(a, b)) continue;
            met[i] = met[on[0].count + j] = 1;
            bvxi_join(joined, i, on[0].count + j);
        }

    join_nearest(on, met, joined, near, reach);
    number_groups(g, on, joined);
    for (uint32_t i = 0; i < g->count; i++)
        if (g->group[i].count[0] == 1 && g->group[i].count[1] == 1) set_shift(g, on, &g->group[i], reach);
    return BVX_OK;
}

static double disc_box_distance(const double box[4], double u, double v)
{
    double const left = box[0] - u, right = u - box[2], low = box[1] - v, high = v - box[3];
    double x = left > right ? left : right, y = low > high ? low : high;
    if (!(x > 0.0)) x = 0.0;
    if (!(y > 0.0)) y = 0.0;
    return sqrt(x * x + y * y);
}

double bvxi_disc_group_distance(bvxi_discs on[2], const bvxi_disc_group *g, int k, double u, double v)
{
    double least = 1e300;
    int inside = 0;
    /* Discs of a group do not overlap: the place is inside at most one. */
    for (uint32_t i = g->count[k] == 0 ? BVXI_NONE : g->first[k]; i != BVXI_NONE; i = on[k].disc[i].next) {
        bvxi_disc *const d = &on[k].disc[i];
        double const at[2] = {u, v};
        if (disc_box_distance(d->box, u, v) > least) continue;
        double const distance = bvxi_plane_distance(&d->view, u, v, &d->hint);
        if (distance < least) least = distance;
        if (!inside && in_disc_box(d->box, at)) inside = bvxi_plane_encloses(&d->view, u, v);
    }
    return inside ? least : -least;
}
