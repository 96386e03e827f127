/* joint_fields.c - what decides which of several bodies a place is in.
 *
 * Each body has its own number, as it has when it is made alone: the thin plate through the planes' distances
 * to its contours. One more is that of all of them together, whose contours are those that have nothing on
 * their other side. A place is outside where that one is below 0; else it is in the body whose number is the
 * largest. So both sides of a face between two bodies follow from the same two numbers, and no gap is left
 * between bodies that touch. On a plane the contours decide. */
#include "oblique/oblique.h"

#include <math.h>

enum { SURROUNDING_PLACES = 16 }; /* on each plane: from where the next planes are looked for */

#define BESIDE_CONTOUR 1e-3 /* cells: where it is looked at what lies beside a contour */

/* ---- kinds ---- */

static double number_of(const bvxi_oblique *o, uint32_t plane, const double at[3], const uint32_t *heard,
                        uint32_t count)
{
    if (plane != BVXI_NONE) return bvxi_oblique_exact(o, plane, at);
    return bvxi_oblique_number_among(o, at, heard, heard == NULL ? o->plane_count : count);
}

int bvxi_joint_is_beyond(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    for (int e = 0; e < 2; e++)
        if (o->end[e] != BVXI_NONE && o->end[e] != plane &&
            o->beyond[e] * bvxi_oblique_height(&o->plane[o->end[e]], at) > 0.0)
            return 1;
    return 0;
}

int bvxi_joint_kind(const bvxi_oblique *o, uint32_t plane, const double at[3], const uint32_t *heard,
                    uint32_t count)
{
    double most = -1e300;
    int kind = 0, near = 0;

    if (bvxi_joint_is_beyond(o, plane, at)) return 0;
    /* Between planes the number of all bodies together decides about the outside, before any of one body. */
    if (plane == BVXI_NONE && !(number_of(o, plane, at, heard, count) > 0.0)) return 0;
    for (uint32_t i = 0; i < o->body_count; i++) {
        const bvxi_oblique *const b = &o->body[i];
        int const is_near = plane != BVXI_NONE || bvxi_oblique_is_near(b, at);
        double uv[2], number;

        /* On a plane only bodies that enclose the place; of two that overlap by a hair the deeper one. */
        if (plane != BVXI_NONE) {
            bvxi_oblique_uv(&b->plane[plane], at, uv);
            if (!bvxi_oblique_in_bounds(&b->plane[plane], uv, 0.0) || !bvxi_oblique_encloses(b, plane, uv))
                continue;
        }
        /* Bodies that are far do not count where one is near: each place is compared with few. */
        if (near && !is_near) continue;
        number = number_of(b, plane, at, heard, count);
        if (number <= most && near == is_near) continue;
        near = is_near;
        most = number;
        kind = (int)i + 1;
    }
    return kind;
}

/* The largest number among bodies; *kind: whose. */
static double largest_number(const bvxi_oblique *o, uint32_t plane, const double at[3], uint64_t bodies,
                             int *kind)
{
    double most = -1e300;
    *kind = 0;
    for (uint32_t i = 0; i < o->body_count; i++) {
        if (!(bodies >> (i + 1) & 1)) continue;
        double const number = number_of(&o->body[i], plane, at, NULL, 0);
        if (number <= most) continue;
        most = number;
        *kind = (int)i + 1;
    }
    return most;
}

int bvxi_joint_kind_among(const bvxi_oblique *o, const double at[3], uint64_t kinds)
{
    int kind;
    if ((kinds & 1) != 0 && !(number_of(o, BVXI_NONE, at, NULL, 0) > 0.0)) return 0;
    (void)largest_number(o, BVXI_NONE, at, kinds, &kind);
    return kind;
}

double bvxi_joint_lead(const bvxi_oblique *o, uint32_t plane, const double at[3], uint64_t bodies,
                       uint64_t others)
{
    double lead = (others & 1) != 0 ? number_of(o, plane, at, NULL, 0) : 1e300;
    int kind;
    if (others > 1) {
        double const by = largest_number(o, plane, at, bodies, &kind) -
                          largest_number(o, plane, at, others, &kind);
        lead = by < lead ? by : lead;
    }
    return lead;
}

/* ---- each body by itself ---- */

/* The farther of the next planes on both sides of a plane, from a place on it and along its normal. */
static double way_to_next_planes(const bvxi_oblique *b, uint32_t plane, const double at[3])
{
    const bvxi_oblique_plane *const p = &b->plane[plane];
    double way[2] = {1e300, 1e300}, most = 0.0;

    for (uint32_t i = 0; i < b->plane_count; i++) {
        const double *const n = b->plane[i].normal;
        double const along = (n[0] * p->normal[0] + n[1] * p->normal[1]) + n[2] * p->normal[2];
        double const height = bvxi_oblique_height(&b->plane[i], at);
        double *const side = &way[(height < 0.0) == (along < 0.0)];

        /* A plane along the normal is next to nothing. */
        if (i == plane || !(bvxi_absolute(along) > 1e-6)) continue;
        if (bvxi_absolute(height / along) < *side) *side = bvxi_absolute(height / along);
    }
    for (int k = 0; k < 2; k++)
        if (way[k] < 1e300 && way[k] > most) most = way[k];
    return most;
}

static bvx_status make_field(bvxi_oblique *o)
{
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.4, bvxi_oblique_raster(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.4, 0.8, bvxi_oblique_smooth(o)));
    return BVXI_SHARE(o->ctx, 0.8, 1.0, bvxi_oblique_rest(o));
}

static bvx_status open_joint_body(bvxi_oblique *o, uint32_t i, int32_t label)
{
    bvxi_oblique *const b = &o->body[i];

    b->ctx = o->ctx;
    b->function = o->function;
    b->given = o->given;
    b->options = o->options;
    b->options.label = label;
    b->of_all = 1;
    b->end[0] = b->end[1] = BVXI_NONE;
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.2, bvxi_oblique_take_planes(b)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.2, 0.3, bvxi_oblique_settle(b)));

    /* A body's number is made around its contours, as far as the next planes on which it may not be, or as
     * all bodies may bulge. */
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
    double margin = b->longest / 8.0;

    for (uint32_t m = 0; m < b->plane_count; m++) {
        const bvxi_plane *const p = &b->plane[m].plane;
        uint32_t const stride = p->point_count / SURROUNDING_PLACES + 1;
        for (uint32_t n = 0; n < p->point_count; n++) {
            double at[3], way;
            bvxi_oblique_in_cells(b, b->given->points + 3 * (uint64_t)p->given[n], at);
            bvxi_widen(low, high, at, 3);
            way = n % stride == 0 ? way_to_next_planes(b, m, at) : 0.0;
            margin = way > margin ? way : margin;
        }
    }
    for (int k = 0; k < 3; k++) {
        double const first = floor(low[k] - margin) - 3.0, last = floor(high[k] + margin) + 4.0;
        b->near_low[k] = first > 0.0 ? first : 0.0;
        b->near_high[k] = last < b->side[k] ? last : b->side[k];
    }
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.3, 1.0, make_field(b)));

    o->report.loops += b->report.loops;
    o->report.holes += b->report.holes;
    o->report.points += b->report.points;
    o->report.repeated_points += b->report.repeated_points;
    o->report.gaps += b->report.gaps;
    if (b->report.largest_gap > o->report.largest_gap) o->report.largest_gap = b->report.largest_gap;
    return BVX_OK;
}

/* ---- what lies beside a contour ---- */

static bvx_status refuse_overlap(const bvxi_oblique *o, uint32_t plane, uint32_t a, uint32_t b,
                                 const double uv[2])
{
    const bvxi_oblique_plane *const p = &o->plane[plane];
    double at[3];
    for (int k = 0; k < 3; k++)
        at[k] = o->origin[k] +
                o->step * (p->offset * p->normal[k] + (uv[0] * p->axis[0][k] + uv[1] * p->axis[1][k]));
    return bvxi_fail_for(o->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET,
                         "%s: on section %u the labels %d and %d overlap near (%g, %g, %g); bodies "
                         "that are made at once may only touch: give the outer one a hole there",
                         o->function, (uint64_t)plane, (int64_t)o->body[a < b ? a : b].options.label,
                         (int64_t)o->body[a < b ? b : a].options.label, at[0], at[1], at[2]);
}

/* Whether another body lies on the outer side of a body's segment; 2: it also lies on the inner one. */
static int beside_segment(const bvxi_oblique *o, uint32_t plane, uint32_t a, uint32_t b, uint32_t segment,
                          double middle[2])
{
    const bvxi_plane *const p = &o->body[a].plane[plane].plane;
    const bvxi_oblique *const other = &o->body[b];
    const double *const from = p->uv[segment], *const to = p->uv[p->next[segment]];
    double const du = to[0] - from[0], dv = to[1] - from[1], length = sqrt(du * du + dv * dv);
    double const off = BESIDE_CONTOUR / (length > 0.0 ? length : 1.0);
    double const half[2] = {0.5 * (from[0] + to[0]), 0.5 * (from[1] + to[1])};
    double const left[2] = {half[0] - off * dv, half[1] + off * du};
    double const right[2] = {half[0] + off * dv, half[1] - off * du};
    uint32_t hint = 0;

    memcpy(middle, half, sizeof half);
    /* A body whose contours on the plane are elsewhere touches nothing there. */
    if (!bvxi_oblique_in_bounds(&other->plane[plane], half, BESIDE_CONTOUR)) return 0;
    double const depth = bvxi_plane_distance(&other->plane[plane].plane, half[0], half[1], &hint);
    int const in = bvxi_oblique_encloses(other, plane, left);

    /* Deep in the other body, or along its own border on the same side: both cannot be. */
    if (in && (depth > o->agree || depth < 0.1 * BESIDE_CONTOUR)) return 2;
    return bvxi_oblique_encloses(other, plane, right);
}

/* The segments of a joint plane that have nothing on their outer side. */
static bvx_status find_outer_segments(bvxi_oblique *o, uint32_t plane, uint32_t *segment)
{
    bvxi_plane *const p = &o->plane[plane].plane;
    uint32_t number = 0;

    p->segment = segment;
    p->segment_count = 0;
    for (uint32_t a = 0; a < o->body_count; a++)
        for (uint32_t i = 0; i < o->body[a].plane[plane].plane.point_count; i++, number++) {
            int beside = 0;
            /* All others are asked, also after one was found: a later one may overlap. */
            for (uint32_t b = 0; b < o->body_count; b++) {
                double middle[2];
                int const found = b == a ? 0 : beside_segment(o, plane, a, b, i, middle);
                if (found == 2) return refuse_overlap(o, plane, a, b, middle);
                beside |= found;
            }
            if (!beside) segment[p->segment_count++] = number;
        }
    return BVX_OK;
}

/* ---- all bodies' contours on one set of planes ---- */

/* Body after body, so that numbers of points differ from a body's own by those of the bodies before it. */
static void join_plane(bvxi_oblique *o, uint32_t plane)
{
    bvxi_plane *const p = &o->plane[plane].plane;

    for (uint32_t b = 0; b < o->body_count; b++) {
        const bvxi_plane *const q = &o->body[b].plane[plane].plane;
        uint32_t const first = p->point_count;

        for (uint32_t i = 0; i < q->point_count; i++) {
            p->given[first + i] = q->given[i];
            p->next[first + i] = first + q->next[i];
            memcpy(p->uv[first + i], q->uv[i], sizeof *q->uv);
        }
        for (uint32_t c = 0; c < q->contour_count; c++) {
            p->contour[p->contour_count + c] = q->contour[c];
            p->contour[p->contour_count + c].first += first;
        }
        p->point_count += q->point_count;
        p->contour_count += q->contour_count;
    }
    o->point_count += p->point_count;
    o->report.sections += p->contour_count != 0;
}

static bvx_status join_contours(bvxi_oblique *o)
{
    uint64_t const n = o->plane_count;
    uint32_t *segment, *first;
    uint64_t *count, at = 0;

    BVXI_TRY(BVXI_ZEROS(o->ctx, 2 * n, "the points of planes", count));
    for (uint32_t b = 0; b < o->body_count; b++)
        for (uint64_t p = 0; p < n; p++) {
            count[p] += o->body[b].plane[p].plane.point_count;
            count[n + p] += o->body[b].plane[p].plane.contour_count;
        }
    BVXI_TRY(bvxi_planes_open(o->ctx, &o->all, &o->plane->plane, sizeof *o->plane, o->plane_count, count,
                              count + n));
    for (uint32_t p = 0; p < n; p++) join_plane(o, p);

    BVXI_TRY(BVXI_ARRAY(o->ctx, (uint64_t)o->point_count + 1, "the segments of contours", segment));
    for (uint32_t p = 0; p < n; p++) {
        BVXI_TRY(find_outer_segments(o, p, segment + at));
        at += o->plane[p].plane.point_count;
        if (o->plane[p].plane.contour_count == 0) continue;
        BVXI_TRY(bvxi_plane_open_tree(o->ctx, &o->plane[p].plane, o->plane[p].plane.segment_count));
        bvxi_plane_tree(&o->plane[p].plane);
    }
    BVXI_TRY(BVXI_ZEROS(o->ctx, n, "the points of planes", first));
    for (uint32_t b = 0; b < o->body_count; b++) {
        /* Crossings with other planes, as each body settled them; first: of its points on each plane. */
        const bvxi_oblique *const body = &o->body[b];
        uint64_t const before = o->knot_count;

        BVXI_TRY(BVXI_RESERVE(o, o->knot, before + body->knot_count, o->knot_room,
                              "the crossings of contours with planes"));
        for (uint64_t i = 0; i < body->knot_count; i++) {
            bvxi_knot *const k = &o->knot[before + i];
            *k = body->knot[i];
            k->segment += first[k->plane];
            k->joined += (uint32_t)before;
            k->next = o->plane[k->plane].knot;
            o->plane[k->plane].knot = (uint32_t)(before + i);
        }
        o->knot_count += body->knot_count;
        for (uint32_t p = 0; p < o->plane_count; p++) first[p] += body->plane[p].plane.point_count;
    }
    return BVX_OK;
}

/* ---- ends ---- */

/* Flat caps: parallel planes end all bodies on the first and the last of them. */
static bvx_status find_ends(bvxi_oblique *o)
{
    const double *const n = o->plane[0].normal;
    double least = 1e300, most = -1e300;
    int against;

    o->end[0] = o->end[1] = BVXI_NONE;
    if (o->options.caps != BVX_CAPS_FLAT) return BVX_OK;
    /* Planes that cross have no first and last one: their bodies end by their numbers. */
    for (uint32_t i = 0; i < o->plane_count; i++)
        if (!bvxi_section_parallel(n, o->plane[i].normal, &against)) return BVX_OK;
    for (uint32_t i = 0; i < o->plane_count; i++) {
        int const parallel = bvxi_section_parallel(n, o->plane[i].normal, &against);
        /* Normals may point either way; heights are along the first one. */
        double const way = parallel && against ? -1.0 : 1.0;
        double const height = way * o->plane[i].offset;
        if (o->plane[i].plane.contour_count == 0) continue;
        if (height < least) {
            least = height;
            o->end[0] = i;
            o->beyond[0] = -way;
        }
        if (height > most) {
            most = height;
            o->end[1] = i;
            o->beyond[1] = way;
        }
    }
    if (o->end[0] != o->end[1]) return BVX_OK;
    return bvxi_fail_for(
        o->ctx, BVX_ERR_EMPTY, BVX_REASON_EMPTY,
        "%s: only section %u has contours, and with flat caps all bodies would begin and end "
        "on it; take tapered caps",
        o->function, (uint64_t)o->end[0]);
}

bvx_status bvxi_joint_open(bvxi_oblique *o, const int32_t *labels, uint32_t count)
{
    bvxi_oblique *body;
    o->of_all = 1;
    BVXI_TRY(bvxi_oblique_lay_planes(o));
    BVXI_TRY(BVXI_ZEROS(o->ctx, count, "the bodies", body));
    o->body = body;
    for (uint32_t i = 0; i < count; i++)
        BVXI_TRY(
            BVXI_SHARE(o->ctx, 0.7 * i / count, 0.7 * (i + 1) / count, open_joint_body(o, i, labels[i])));
    o->body_count = count;
    BVXI_TRY(join_contours(o));
    BVXI_TRY(find_ends(o));
    return BVXI_SHARE(o->ctx, 0.7, 1.0, make_field(o));
}
