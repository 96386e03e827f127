/* oblique_lines.c - where two planes cross, both sections say of a line what of it is inside: they are held
 * against each other.
 *
 * A contour crosses the line where two of its points lie on different sides of the other plane. Along the
 * line both sections' crossings are gone through in order. Where one says inside and the other outside, from
 * a crossing of the one to a crossing of the other, these two become one place if the way is short enough;
 * crossings of one section alone that are so near together stay, and are counted. Anything else is refused
 * with both sections, the place and the way. Crossings that are one place by several planes through one line
 * all move to their mean.
 *
 * Where three planes have a corner between contours that are to agree, all three must agree of the corner
 * too: it is on the side that two of them say, and the crossings move so that the third one's contour passes
 * it there. It then meets the two other planes in the other order, which its crossings are given. */
#include "oblique/oblique.h"

#include <math.h>

typedef struct line_event {
    double along;
    uint32_t knot;
    uint32_t which; /* of the two sections */
} line_event;

typedef struct oblique_line_work {
    line_event *event;
    uint64_t count, room;
    double direction[3];
} oblique_line_work;

uint32_t bvxi_knot_root(const bvxi_oblique *o, uint32_t knot)
{
    while (o->knot[knot].joined != knot) knot = o->knot[knot].joined;
    return knot;
}

void bvxi_knot_place(const bvxi_oblique *o, uint32_t knot, double at[3])
{
    const bvxi_knot *const root = &o->knot[bvxi_knot_root(o, knot)];
    for (int k = 0; k < 3; k++) at[k] = root->sum[k] / root->count;
}

uint32_t bvxi_knot_after(const bvxi_oblique *o, uint32_t plane, uint32_t segment, double share)
{
    double least = 1.0; /* the segment's end is the next one's point */
    uint32_t found = BVXI_NONE;
    for (uint32_t k = o->plane[plane].knot; k != BVXI_NONE; k = o->knot[k].next)
        if (o->knot[k].segment == segment && o->knot[k].share > share && o->knot[k].share < least) {
            least = o->knot[k].share;
            found = k;
        }
    return found;
}

/* The knot at a place of a segment, which another plane through the line may have made. */
static bvx_status find_knot(bvxi_oblique *o, uint32_t plane, uint32_t segment, double share, uint32_t other,
                            const double at[3], uint32_t *number)
{
    double const near = BVXI_OBLIQUE_NEAR * BVXI_OBLIQUE_NEAR;

    /* Three planes in one line meet a contour at one place: it gets one knot. */
    for (uint32_t i = o->plane[plane].knot; i != BVXI_NONE; i = o->knot[i].next)
        if (o->knot[i].segment == segment && bvxi_vec_distance2(o->knot[i].at, at) <= near) {
            *number = i;
            return BVX_OK;
        }
    BVXI_TRY(BVXI_GROW(o, o->knot, o->knot_count, o->knot_room, "the crossings of contours with planes"));
    *number = (uint32_t)o->knot_count++;
    bvxi_knot *const k = &o->knot[*number];
    memset(k, 0, sizeof *k);
    memcpy(k->at, at, 24);
    memcpy(k->sum, at, 24);
    k->count = 1.0;
    k->share = share;
    k->plane = plane;
    k->segment = segment;
    k->other = other;
    k->next = o->plane[plane].knot;
    k->joined = *number;
    k->vertex = BVXI_NONE;
    k->exact = share == 0.0;
    o->plane[plane].knot = *number;
    return BVX_OK;
}

/* share: of the way from a to b, where the one place is when neither is part of another or fixed. */
static void join_knots(bvxi_oblique *o, uint32_t a, uint32_t b, double share)
{
    uint32_t x = bvxi_knot_root(o, a), y = bvxi_knot_root(o, b);

    if (x == y) return;
    if (y < x) {
        uint32_t const swap = x;
        x = y;
        y = swap;
    }
    bvxi_knot *const keep = &o->knot[x];
    bvxi_knot *const gone = &o->knot[y];
    gone->joined = x;
    if (keep->exact) return;
    if (gone->exact) {
        memcpy(keep->sum, gone->sum, 24);
        keep->count = gone->count;
        keep->exact = 1;
        return;
    }

    /* Sums and counts: of many that are joined each weighs the same in the mean. */
    if (keep->count > 1.0 || gone->count > 1.0) share = 0.5;
    for (int k = 0; k < 3; k++) {
        keep->sum[k] += gone->sum[k];
        if (share != 0.5)
            keep->sum[k] = 2.0 * (o->knot[a].at[k] + share * (o->knot[b].at[k] - o->knot[a].at[k]));
    }
    keep->count += gone->count;
}

/* Points on the other plane count as above it. */
static bvx_status find_events(bvxi_oblique *o, oblique_line_work *w, uint32_t plane, uint32_t other,
                              uint32_t which)
{
    const bvxi_plane *const p = &o->plane[plane].plane;

    for (uint32_t i = 0; i < p->point_count; i++) {
        uint32_t const n = p->next[i];
        double a[3], b[3], at[3], ha, hb, share;
        uint32_t segment = i;

        bvxi_oblique_in_cells(o, o->given->points + 3 * (uint64_t)p->given[i], a);
        bvxi_oblique_in_cells(o, o->given->points + 3 * (uint64_t)p->given[n], b);
        ha = bvxi_oblique_height(&o->plane[other], a);
        hb = bvxi_oblique_height(&o->plane[other], b);
        /* A point on the other plane but for rounding is on it, for both its segments alike. */
        if (bvxi_absolute(ha) <= BVXI_OBLIQUE_NEAR) ha = 0.0;
        if (bvxi_absolute(hb) <= BVXI_OBLIQUE_NEAR) hb = 0.0;
        if ((ha < 0.0) == (hb < 0.0)) continue;
        share = ha / (ha - hb);
        for (int k = 0; k < 3; k++) at[k] = a[k] + share * (b[k] - a[k]);
        /* A crossing at a point is that point, which has the coordinates given. */
        if (bvxi_vec_distance2(at, a) <= BVXI_OBLIQUE_NEAR * BVXI_OBLIQUE_NEAR) share = 0.0;
        else if (bvxi_vec_distance2(at, b) <= BVXI_OBLIQUE_NEAR * BVXI_OBLIQUE_NEAR) {
            share = 0.0;
            segment = n;
        }
        if (share == 0.0) memcpy(at, segment == i ? a : b, 24);
        BVXI_TRY(BVXI_GROW(o, w->event, w->count, w->room, "the crossings of contours with planes"));
        line_event *const e = &w->event[w->count];
        e->which = which;
        e->along = (w->direction[0] * at[0] + w->direction[1] * at[1]) + w->direction[2] * at[2];
        BVXI_TRY(find_knot(o, plane, segment, share, other, at, &e->knot));
        w->count++;
    }
    return BVX_OK;
}

/* Few of them, nearly in order: by insertion with growing steps back (Shell 1959). */
static void sort_events(line_event *e, uint64_t n)
{
    for (uint64_t gap = n / 2; gap > 0; gap /= 2)
        for (uint64_t i = gap; i < n; i++) {
            line_event const x = e[i];
            uint64_t j = i;
            for (; j >= gap; j -= gap) {
                const line_event *const y = &e[j - gap];
                if (x.along != y->along   ? x.along > y->along
                    : x.which != y->which ? x.which > y->which
                                          : x.knot >= y->knot)
                    break;
                e[j] = *y;
            }
            e[j] = x;
        }
}

/* Where crossings of the contours of two planes become one place: the share of the way from a to b. A third
 * plane that crosses the way has a corner with both there, and its contours say whose side it is on; the place
 * lies beyond the corner for the one that is outvoted. */
static double share_of_way(const bvxi_oblique *o, uint32_t plane_a, const double a[3], uint32_t plane_b,
                           const double b[3])
{
    double least = 0.0, most = 1.0;
    for (uint32_t i = 0; i < o->plane_count; i++) {
        double const ha = bvxi_oblique_height(&o->plane[i], a), hb = bvxi_oblique_height(&o->plane[i], b);
        double at[3], share;
        if (i == plane_a || i == plane_b || (ha < 0.0) == (hb < 0.0)) continue;
        share = ha / (ha - hb);
        for (int k = 0; k < 3; k++) at[k] = a[k] + share * (b[k] - a[k]);
        if ((bvxi_oblique_exact(o, i, at) > 0.0) == (bvxi_oblique_exact(o, plane_a, at) > 0.0))
            most = share < most ? share : most;
        else least = share > least ? share : least;
    }
    return 0.5 * (least + most);
}

static bvx_status settle_pair(bvxi_oblique *o, oblique_line_work *w, uint32_t a, uint32_t b)
{
    int inside[2] = {0, 0};
    uint64_t since = 0;

    for (uint64_t i = 0; i < w->count; i++) {
        const line_event *const e = &w->event[i], *const before = &w->event[since];
        int const apart = inside[0] != inside[1];

        inside[e->which] ^= 1;
        if (!apart) {
            since = i;
            continue;
        }
        const double *const from = o->knot[before->knot].at, *const to = o->knot[e->knot].at;
        /* How far a contour would have to move at most: along the line, or across it where it just reaches it. */
        double gap = e->along - before->along, middle[3];
        for (int k = 0; k < 3; k++) middle[k] = 0.5 * (from[k] + to[k]);
        for (int k = 0; k < 2; k++) {
            double const across = 2.0 * bvxi_absolute(bvxi_oblique_exact(o, k == 0 ? a : b, middle));
            gap = gap < across ? gap : across;
        }
        if (gap > o->agree)
            return bvxi_fail_for(
                o->ctx, BVX_ERR_FORMAT, BVX_REASON_DAMAGED,
                "%s: sections %u and %u contradict each other where their planes cross, near (%g, %g, %g): "
                "over a way of %g only one of them is inside; %g is allowed, which agree sets",
                o->function, (uint64_t)a, (uint64_t)b, o->origin[0] + o->step * from[0],
                o->origin[1] + o->step * from[1], o->origin[2] + o->step * from[2], gap * o->step,
                o->agree * o->step);
        if (gap * o->step > o->report.largest_gap) o->report.largest_gap = gap * o->step;
        /* In and out again of the same plane, with nothing of the other: there is nothing to move it to. */
        if (e->which == before->which) {
            o->report.gaps++;
            continue;
        }
        join_knots(o, before->knot, e->knot,
                   share_of_way(o, before->which == 0 ? a : b, from, e->which == 0 ? a : b, to));
    }
    return BVX_OK;
}

/* ---- the order of crossings on a contour ---- */

/* Whether the way of a knot to where it was moved crosses a plane. */
static int moves_across(const bvxi_oblique *o, uint32_t knot, uint32_t plane)
{
    double at[3];
    bvxi_knot_place(o, knot, at);
    return (bvxi_oblique_height(&o->plane[plane], o->knot[knot].at) < 0.0) !=
           (bvxi_oblique_height(&o->plane[plane], at) < 0.0);
}

/* A segment that passes the corner of two planes on its other side comes to these in the other order. */
static void order_knots(const bvxi_oblique *o, line_event *e, uint64_t n)
{
    for (uint64_t i = 1; i < n; i++)
        for (uint64_t j = i; j > 0; j--) {
            line_event const first = e[j - 1], second = e[j];
            bvxi_knot *const x = &o->knot[first.knot], *const y = &o->knot[second.knot];
            double const share = x->share;

            /* A contour's own point stays between those before and after it. */
            if (first.which != second.which || x->share == 0.0 || x->other == y->other) break;
            /* Each two change places once: those that came in the other order before are past it. */
            if (!(first.along < second.along) || !moves_across(o, first.knot, y->other) ||
                !moves_across(o, second.knot, x->other))
                break;
            x->share = y->share;
            y->share = share;
            e[j - 1] = second;
            e[j] = first;
        }
}

bvx_status bvxi_oblique_settle(bvxi_oblique *o)
{
    oblique_line_work w = {0};
    for (uint32_t a = 0; a < o->plane_count; a++) {
        BVXI_TRY(bvxi_progress(o->ctx, "sections", (double)a / o->plane_count));
        for (uint32_t b = a + 1; b < o->plane_count; b++) {
            const double *const n = o->plane[a].normal, *const m = o->plane[b].normal, *const d = w.direction;

            for (int k = 0; k < 3; k++)
                w.direction[k] = n[(k + 1) % 3] * m[(k + 2) % 3] - n[(k + 2) % 3] * m[(k + 1) % 3];
            double const length = sqrt((d[0] * d[0] + d[1] * d[1]) + d[2] * d[2]);
            if (!(length > 1e-9)) continue; /* they cross nowhere near */
            /* Places along the line are lengths then, which agree is one of. */
            for (int k = 0; k < 3; k++) w.direction[k] /= length;
            w.count = 0;
            BVXI_TRY(find_events(o, &w, a, b, 0));
            BVXI_TRY(find_events(o, &w, b, a, 1));
            sort_events(w.event, w.count);
            BVXI_TRY(settle_pair(o, &w, a, b));
        }
    }
    /* Once all are moved: which side of a corner a contour passes depends on both of its crossings there. */
    for (uint32_t a = 0; a < o->plane_count; a++) {
        w.count = 0;
        for (uint32_t k = o->plane[a].knot; k != BVXI_NONE; k = o->knot[k].next) {
            BVXI_TRY(BVXI_GROW(o, w.event, w.count, w.room, "the crossings of contours with planes"));
            w.event[w.count].which = o->knot[k].segment;
            w.event[w.count].along = o->knot[k].segment + o->knot[k].share;
            w.event[w.count++].knot = k;
        }
        sort_events(w.event, w.count);
        order_knots(o, w.event, w.count);
    }
    return BVX_OK;
}
