/* caps.c - a section's region as flat triangles, for bodies that end on their first or last section.
 *
 * The region is cut by its contours' points only, whose loops are known to be simple in fixed point: each
 * outer loop is joined to the holes in it by bridges (the shortest segments between points that meet
 * nothing), and the polygon that comes of it is cut into triangles. The crossings that the surface has on a
 * contour's segment then divide the triangle behind it. */
#include "contours/section.h"

#include "mesh/polygon.h"

/* A hole in no loop, as lines in the paper's way can make when contour
 * points cross over: filled by itself, in its own direction. */
#define CAP_ALONE    (UINT32_MAX - 1)
#define CAP_STRAIGHT 1e-9 /* sine of the angle at a point that is no corner */

typedef struct cap_work {
    bvxi_stack *s;
    const bvxi_plane *plane;
    int32_t side;
    int fixed;        /* 1: all points are corners, in fixed point */
    uint32_t *after;  /* the next corner behind each point that is one, else none */
    uint32_t *corner; /* points around the region, those at bridges twice */
    uint32_t count;
    uint32_t (*bridge)[2];
    uint32_t bridge_count;
    double (*at)[3];
    uint32_t *cut; /* triangles of corners */
    bvxi_polygon polygon;
} cap_work;

/* ---- bridges ---- */

/* 1 when two closed segments meet anywhere but at an end that both share as a point. */
static int cap_meets(const cap_work *w, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    int32_t(*const q)[2] = w->plane->q;
    if (a == c || a == d || b == c || b == d) { /* a common end: the other one may not lie on the segment */
        uint32_t const common = a == c || a == d ? a : b, mine = common == a ? b : a,
                       other = common == c ? d : c;
        return mine == other || bvxi_folds_back(q[common], q[mine], q[other]);
    }
    return bvxi_segments_meet(q[a], q[b], q[c], q[d]);
}

/* The nearest corner that a hole's point sees; corners are tried by their distance. */
static bvx_status find_bridge(cap_work *w, uint32_t from, uint32_t *corner)
{
    uint64_t last = 0;
    uint32_t last_at = BVXI_NONE;

    for (;;) {
        uint64_t best = UINT64_MAX;
        uint32_t at = BVXI_NONE;
        for (uint32_t i = 0; i < w->count; i++) {
            const int32_t *const a = w->plane->q[from], *const b = w->plane->q[w->corner[i]];
            int64_t const x = (int64_t)a[0] - b[0], y = (int64_t)a[1] - b[1];
            uint64_t const d = (uint64_t)(x * x) + (uint64_t)(y * y);
            if (d < last || (d == last && last_at != BVXI_NONE && i <= last_at)) continue;
            if (d < best) {
                best = d;
                at = i;
            }
        }
        if (at == BVXI_NONE)
            return bvxi_fail(w->s->ctx, BVX_ERR_FORMAT,
                             "%s: a hole of section %i cannot be joined to its loop", w->s->function,
                             (uint64_t)w->plane->section);
        const bvxi_plane *const p = w->plane;
        const int32_t *const o = p->q[w->corner[at]], *const m = p->q[from];
        const int32_t *const a = p->q[w->corner[(at + w->count - 1) % w->count]];
        const int32_t *const b = p->q[w->corner[(at + 1) % w->count]];
        /* At a left turn the angle is what both edges have on their left; at a reflex corner, what either has. */
        int const left_of_a = bvxi_turn_sign(a, o, m) > 0, left_of_b = bvxi_turn_sign(o, b, m) > 0;
        int sees = bvxi_turn_sign(a, o, b) > 0 ? left_of_a && left_of_b : left_of_a || left_of_b;
        for (uint32_t i = 0; i < p->point_count && sees; i++)
            sees = !cap_meets(w, from, w->corner[at], i, p->next[i]);
        for (uint32_t i = 0; i < w->bridge_count && sees; i++)
            sees = !cap_meets(w, from, w->corner[at], w->bridge[i][0], w->bridge[i][1]);
        if (sees) {
            *corner = at;
            return BVX_OK;
        }
        last = best;
        last_at = at;
    }
}

/* ---- which holes ---- */

/* Twice the area of a loop in fixed point, about; less than 0 for a hole. */
static double cap_area(const bvxi_plane *p, const bvxi_contour *c)
{
    double sum = 0.0;
    for (uint32_t i = c->first; i < c->first + c->count; i++) {
        /* About the first point, so that large coordinates do not take the digits. */
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]], *const o = p->q[c->first];
        sum += ((double)a[0] - o[0]) * ((double)b[1] - o[1]) - ((double)a[1] - o[1]) * ((double)b[0] - o[0]);
    }
    return sum;
}

void bvxi_plane_owners(const bvxi_plane *p, uint32_t *owner)
{
    for (uint32_t h = 0; h < p->contour_count; h++) {
        double best = 0.0;
        owner[h] = BVXI_NONE;
        if (!p->contour[h].hole) continue;
        for (uint32_t o = 0; o < p->contour_count; o++) {
            if (p->contour[o].hole || !bvxi_loop_contains(p, &p->contour[o], p->q[p->contour[h].first]))
                continue;
            double const area = cap_area(p, &p->contour[o]);
            if (owner[h] != BVXI_NONE && area >= best) continue;
            owner[h] = o;
            best = area;
        }
    }
}

static void find_corners(cap_work *w)
{
    const bvxi_plane *const p = w->plane;

    for (uint32_t k = 0; k < p->contour_count; k++) {
        const bvxi_contour *const c = &p->contour[k];
        uint32_t const end = c->first + c->count;
        uint32_t first = BVXI_NONE, last = BVXI_NONE, n = 0;
        /* all are corners where fewer than three would be left */
        for (int pass = 0; pass < 2 && n < 3; pass++) {
            first = last = BVXI_NONE;
            n = 0;
            for (uint32_t i = c->first; i < end; i++) {
                w->after[i] = BVXI_NONE;
                int straight = 0;
                if (pass == 0 && !p->lines && !w->fixed) {
                    /* A point on the straight line from the one before it to the next is no corner, but a vertex
                     * on a side as crossings are. */
                    const double *const a = p->uv[i == c->first ? end - 1 : i - 1], *const o = p->uv[i],
                                        *const b = p->uv[p->next[i]];
                    double const x = o[0] - a[0], y = o[1] - a[1], u = b[0] - o[0], v = b[1] - o[1];
                    double const turn = x * v - y * u, along = x * u + y * v;
                    straight = along > 0.0 && bvxi_absolute(turn) <= CAP_STRAIGHT * along;
                }
                if (straight) continue;
                if (last == BVXI_NONE) first = i;
                else w->after[last] = i;
                last = i;
                n++;
            }
        }
        w->after[last] = first;
    }
}

/* Holes from the right to the left: each then sees the outer loop or a hole that is joined already. */
static bvx_status join_holes(cap_work *w, uint32_t *owner, uint32_t outer)
{
    const bvxi_plane *const p = w->plane;

    for (;;) {
        uint32_t next = BVXI_NONE, from = 0, corner = 0;
        for (uint32_t h = 0; h < p->contour_count; h++) {
            if (owner[h] != outer) continue;
            for (uint32_t r = p->contour[h].first; r < p->contour[h].first + p->contour[h].count; r++)
                if (w->after[r] != BVXI_NONE && (next == BVXI_NONE || p->q[r][0] > p->q[from][0])) {
                    next = h;
                    from = r;
                }
        }
        if (next == BVXI_NONE) return BVX_OK;
        owner[next] = BVXI_NONE;
        BVXI_TRY(find_bridge(w, from, &corner));

        /* Go around a hole from one of its points, entered and left over the bridge at a corner. */
        const bvxi_contour *const hole = &p->contour[next];
        uint32_t i = from, k = corner + 1, n = 2;

        /* Room after the corner for the hole's points, its first once more, and the corner once more. */
        for (uint32_t j = hole->first; j < hole->first + hole->count; j++) n += w->after[j] != BVXI_NONE;
        memmove(w->corner + corner + 1 + n, w->corner + corner + 1, (size_t)(w->count - corner - 1) * 4);
        do {
            w->corner[k++] = i;
            i = w->after[i];
        } while (i != from);
        w->corner[k++] = from;
        w->corner[k] = w->corner[corner];
        w->bridge[w->bridge_count][0] = from;
        w->bridge[w->bridge_count++][1] = w->corner[corner];
        w->count += n;
    }
}

/* ---- triangles ---- */

static bvx_status add_turned(const cap_work *w, uint32_t a, uint32_t b, uint32_t c)
{
    return w->side > 0 ? bvxi_section_add_triangle(w->s, a, b, c) : bvxi_section_add_triangle(w->s, a, c, b);
}

/* A side of a triangle: the vertices between its corners, which are a
 * stretch of the ring that may go over its loop's end. */
typedef struct cap_side {
    uint32_t start, count; /* places after the first corner */
    uint32_t low, end;     /* of the loop in the ring */
} cap_side;

static uint32_t side_vertex(const bvxi_plane *p, const cap_side *side, uint32_t i)
{
    uint32_t const at = side->start + i;
    return p->vertex + (at < side->end ? at : at - (side->end - side->low));
}

static void find_side(const cap_work *w, uint32_t a, uint32_t b, cap_side *side)
{
    const bvxi_plane *const p = w->plane;
    memset(side, 0, sizeof *side);
    /* Only corners that follow each other have a stretch of the ring between them; bridges have none. */
    if (p->lines || w->after[a] != b) return;
    bvxi_ring_stretch(p, bvxi_contour_of(p, a), &side->low, &side->end);
    side->start = p->ring[a] + 1;
    side->count = (p->ring[b] > p->ring[a] ? p->ring[b] : p->ring[b] + (side->end - side->low)) - p->ring[a] -
                  1;
}

/* Triangles from a vertex to the part of a side between two vertices, over places begin to end of it. */
static bvx_status fan_side(const cap_work *w, uint32_t apex, uint32_t from, const cap_side *side,
                           uint32_t begin, uint32_t end, uint32_t to)
{
    for (uint32_t i = begin; i < end; i++) {
        uint32_t const v = side_vertex(w->plane, side, i);
        BVXI_TRY(add_turned(w, apex, from, v));
        from = v;
    }
    return add_turned(w, apex, from, to);
}

/* A triangle with vertices on its sides: a side that has some is joined to the corner over it, and the two
 * outer ones of the triangles that this makes are divided at the other sides. */
static bvx_status divide_triangle(const cap_work *w, const uint32_t point[3])
{
    const bvxi_plane *const p = w->plane;
    uint32_t v[3], first, last;
    cap_side side[3];
    int turn = 0;

    for (int i = 0; i < 3; i++) find_side(w, point[i], point[(i + 1) % 3], &side[i]);
    while (turn < 2 && side[turn].count == 0) turn++;
    for (int i = 0; i < 3; i++) {
        v[i] = p->vertex + p->ring[point[(i + turn) % 3]];
        find_side(w, point[(i + turn) % 3], point[(i + turn + 1) % 3], &side[i]);
    }
    if (side[0].count == 0) return add_turned(w, v[0], v[1], v[2]);
    first = side_vertex(p, &side[0], 0);
    last = side_vertex(p, &side[0], side[0].count - 1);
    /* Three fans: over the third side, over the first from the corner opposite, over the second. */
    BVXI_TRY(fan_side(w, first, v[2], &side[2], 0, side[2].count, v[0]));
    if (first != last) BVXI_TRY(fan_side(w, v[2], first, &side[0], 1, side[0].count - 1, last));
    return fan_side(w, last, v[1], &side[1], 0, side[1].count, v[2]);
}

static bvx_status fill_regions(cap_work *w, uint32_t *owner)
{
    const bvxi_plane *const p = w->plane;

    bvxi_plane_owners(p, owner);
    find_corners(w);
    for (uint32_t h = 0; h < p->contour_count; h++)
        if (p->contour[h].hole && owner[h] == BVXI_NONE) owner[h] = CAP_ALONE;
    for (uint32_t o = 0; o < p->contour_count; o++) {
        const bvxi_contour *const c = &p->contour[o];
        if (c->hole && owner[o] != CAP_ALONE) continue;
        w->count = 0;
        for (uint32_t i = c->first; i < c->first + c->count; i++)
            if (w->after[i] != BVXI_NONE) w->corner[w->count++] = i;
        w->bridge_count = 0;
        BVXI_TRY(join_holes(w, owner, o));
        for (uint32_t i = 0; i < w->count; i++) {
            /* points in line as given are in line here, which fixed point would not keep */
            for (int k = 0; k < 2; k++)
                w->at[i][k] = w->plane->lines || w->fixed ? w->plane->q[w->corner[i]][k]
                                                          : w->plane->uv[w->corner[i]][k];
            w->at[i][2] = 0.0;
        }
        BVXI_TRY(bvxi_polygon_cut(&w->polygon, (const double(*)[3])w->at, w->count, w->cut));
        for (uint32_t i = 0; i + 2 < w->count; i++) {
            uint32_t point[3];
            for (int k = 0; k < 3; k++) point[k] = w->corner[w->cut[3 * i + (uint32_t)k]];
            BVXI_TRY(divide_triangle(w, point));
        }
    }
    return BVX_OK;
}

bvx_status bvxi_cap_fill(bvxi_stack *s, const bvxi_plane *plane, int32_t side)
{
    uint64_t const corners = (uint64_t)plane->point_count + 2 * (uint64_t)plane->contour_count;
    uint32_t *owner = NULL;
    cap_work w = {.s = s, .plane = plane, .side = side};
    w.polygon.ctx = s->ctx;
    /* Where points are moved apart in fixed point from others at their place, the region is simple there only. */
    for (uint32_t i = 0; i < plane->point_count && s->nudge != NULL && !plane->lines; i++) {
        const int16_t *const nudge = s->nudge[plane->given[i]];
        w.fixed |= nudge[0] != 0 || nudge[1] != 0;
    }
    BVXI_TRY(BVXI_ARRAY(s->ctx, plane->contour_count, "the holes of a cap", owner));
    BVXI_TRY(BVXI_ARRAY(s->ctx, corners, "the corners of a cap", w.after));
    BVXI_TRY(BVXI_ARRAY(s->ctx, corners, "the corners of a cap", w.corner));
    BVXI_TRY(BVXI_ARRAY(s->ctx, plane->contour_count, "the bridges of a cap", w.bridge));
    BVXI_TRY(BVXI_ARRAY(s->ctx, corners, "the corners of a cap", w.at));
    BVXI_TRY(BVXI_ARRAY(s->ctx, 3 * corners, "the triangles of a cap", w.cut));
    return fill_regions(&w, owner);
}

/* ---- caps of lines ---- */

/* In the field's way the lines of the first or last plane, which the cells beside it have left, are loops of a
 * section whose points are vertices and whose segments nothing crosses. */

bvx_status bvxi_cap_fill_edges(bvxi_stack *s, const uint32_t (*edge)[2], uint32_t count, int32_t side)
{
    uint64_t const vertices = s->mesh.vertex_count;
    uint32_t *behind = NULL;
    bvxi_plane p = {0};

    if (count == 0) return BVX_OK;
    p.lines = 1;
    BVXI_TRY(BVXI_ARRAY(s->ctx, vertices, "the lines of a cap", behind));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.q));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.next));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.ring));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.contour));
    memset(behind, 0xff, (size_t)vertices * 4);

    /* Follow the lines into loops: points in order, contours, directions of holes. behind has of each vertex
     * the next one, or none. */
    for (uint32_t i = 0; i < count; i++) behind[edge[i][0]] = edge[i][1];
    for (uint32_t i = 0; i < count; i++) {
        bvxi_contour *const c = &p.contour[p.contour_count];
        uint32_t v = edge[i][0];
        if (behind[v] == BVXI_NONE) continue;
        c->first = p.point_count;
        while (behind[v] != BVXI_NONE) {
            const double *const at = s->mesh.position + 3 * (uint64_t)v;
            uint32_t const n = p.point_count++, next = behind[v];
            for (int k = 0; k < 2; k++)
                p.q[n][k] = 2 * bvxi_snap_steps(s, k, bvxi_along_axis(s->axis[k], at)) + 1;
            p.ring[n] = v;
            p.next[n] = n + 1;
            behind[v] = BVXI_NONE;
            v = next;
        }
        if (v != edge[i][0])
            return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "%s: the lines of a flat cap do not close", s->function);
        c->count = p.point_count - c->first;
        p.next[p.point_count - 1] = c->first;
        c->hole = cap_area(&p, c) < 0.0;
        p.contour_count++;
    }
    return bvxi_cap_fill(s, &p, side);
}
