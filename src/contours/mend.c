/* mend.c - a stack in which loops touch or cross themselves or each other, made one that can be built.
 *
 * One rule: inside is what an odd number of loops enclose, as it is for loops in loops. That stays as it was.
 * Loops that neither touch nor cross are copied as they are; the others are split where they meet
 * and joined anew (mend_trace.c). Points that lie on no border any more are left out: those of
 * slits, spikes and borders that two loops have in common. What is still not simple after that is refused by
 * the checks of every stack. */
#include "contours/mend.h"

#include "mesh/mesh.h"

#include <math.h>

/* ---- segments split where they meet ---- */

/* All pairs that meet are found exactly. An end on another segment splits that one there; two that cross are split at
 * the nearest point of a coarser grid, so that there is room to move loops apart. Splitting moves segments, so it is
 * done again until nothing meets: a few times as a rule.
 *
 * Source: Hobby. Practical segment intersection with finite precision output. 1999 (snap rounding). */

/* Rounds, and segments that one of the first round becomes in the mean, before it is given up. */
enum { MEND_ROUNDS = 40, MEND_MOST = 16 };
enum { MEND_PIXEL = 128 }; /* crossings lie so far from each other at least; 2^-22 of the extent */

static bvx_status mend_node_at(bvxi_mend_work *w, const int32_t q[2], const double at[3], uint32_t *number)
{
    uint32_t *found = NULL;
    BVXI_TRY(bvxi_stack_map_add(w->s, w->map, (uint64_t)(uint32_t)q[0] << 32 | (uint32_t)q[1], &found));
    *number = *found;
    if (*found != BVXI_NONE) return BVX_OK;
    *number = *found = w->node_count;
    BVXI_TRY(BVXI_SLAB_GROW(w->s, w->node, w->node_count, w->node_room, "the points of loops to mend"));
    bvxi_mend_node *const n = &w->node[w->node_count++];
    memcpy(n->q, q, sizeof n->q);
    memcpy(n->at, at, sizeof n->at);
    n->loop = BVXI_NONE;
    n->visits = 0;
    return BVX_OK;
}

static bvx_status mend_add_edge(bvxi_mend_work *w, bvxi_mend_edges *to, uint32_t a, uint32_t b, uint32_t loop)
{
    BVXI_TRY(BVXI_SLAB_GROW(w->s, to->at, to->count, to->room, "the segments of loops to mend"));
    bvxi_mend_edge *const e = &to->at[to->count++];
    e->node[0] = a;
    e->node[1] = b;
    e->loop = loop;
    return BVX_OK;
}

static void mend_visit(bvxi_mend_work *w, uint32_t node, uint32_t loop)
{
    bvxi_mend_node *const n = &w->node[node];
    if (n->visits++ == 0) n->loop = loop;
    else w->changed[n->loop] = w->changed[loop] = 1;
}

/* Points that snap to one place are one, as they are everywhere. */
static bvx_status mend_take_loop(bvxi_mend_work *w, uint32_t loop)
{
    const bvxi_plane *const p = w->plane;
    const bvxi_contour *const c = &p->contour[loop];
    uint32_t first, before, node;

    BVXI_TRY(mend_node_at(w, p->q[c->first], w->s->given->points + 3 * (uint64_t)p->given[c->first], &first));
    before = first;
    for (uint32_t i = c->first + 1; i < c->first + c->count; i++, before = node) {
        BVXI_TRY(mend_node_at(w, p->q[i], w->s->given->points + 3 * (uint64_t)p->given[i], &node));
        if (node == before) continue;
        BVXI_TRY(mend_add_edge(w, &w->edge, before, node, loop));
        mend_visit(w, node, loop);
    }
    if (before == first) return BVX_OK; /* the first point is visited at the end, or all snap to it */
    BVXI_TRY(mend_add_edge(w, &w->edge, before, first, loop));
    mend_visit(w, first, loop);
    return BVX_OK;
}

static bvx_status mend_split_at(bvxi_mend_work *w, uint32_t edge, uint32_t node)
{
    bvxi_mend_edge *const e = &w->edge.at[edge];
    if (node == e->node[0] || node == e->node[1]) return BVX_OK;
    BVXI_TRY(BVXI_SLAB_GROW(w->s, w->split, w->split_count, w->split_room, "the splits of segments"));
    w->split[w->split_count].edge = edge;
    w->split[w->split_count++].node = node;
    return BVX_OK;
}

/* The point of the coarser grid nearest to where two segments cross, about, and the crossing on the first. */
static bvx_status mend_cross(bvxi_mend_work *w, const bvxi_mend_edge *e, const bvxi_mend_edge *f,
                             uint32_t *number)
{
    const bvxi_mend_node *const a = &w->node[e->node[0]], *const b = &w->node[e->node[1]];
    const int32_t *const c = w->node[f->node[0]].q, *const d = w->node[f->node[1]].q;
    double const ux = (double)b->q[0] - a->q[0], uy = (double)b->q[1] - a->q[1];
    double const vx = (double)d[0] - c[0];
    double const vy = (double)d[1] - c[1];
    double const x = (double)c[0] - a->q[0];
    double const y = (double)c[1] - a->q[1];
    double const t = (x * vy - y * vx) / (ux * vy - uy * vx);
    double at[3];
    int32_t q[2];

    for (int k = 0; k < 2; k++) {
        double const to = (double)b->q[k] - a->q[k];
        q[k] = MEND_PIXEL * (int32_t)floor((a->q[k] + t * to) / MEND_PIXEL + 0.5) + 1;
    }
    for (int k = 0; k < 3; k++) at[k] = a->at[k] + t * (b->at[k] - a->at[k]);
    return mend_node_at(w, q, at, number);
}

static bvx_status mend_pair(void *user, uint32_t j, uint32_t i)
{
    bvxi_mend_work *const w = user;
    bvxi_mend_edge const e = w->edge.at[i], f = w->edge.at[j];
    const int32_t *const a = w->node[e.node[0]].q, *const b = w->node[e.node[1]].q;
    const int32_t *const c = w->node[f.node[0]].q, *const d = w->node[f.node[1]].q;
    uint32_t const before = w->split_count;
    uint32_t node;

    for (int k = 0; k < 2; k++) {
        if (bvxi_segment_holds(a, b, w->node[f.node[k]].q)) BVXI_TRY(mend_split_at(w, i, f.node[k]));
        if (bvxi_segment_holds(c, d, w->node[e.node[k]].q)) BVXI_TRY(mend_split_at(w, j, e.node[k]));
    }
    if (w->split_count == before) {
        if (bvxi_turn_sign(a, b, c) * bvxi_turn_sign(a, b, d) >= 0 ||
            bvxi_turn_sign(c, d, a) * bvxi_turn_sign(c, d, b) >= 0)
            return BVX_OK;
        w->crossings++;
        if (w->cross) {
            BVXI_TRY(mend_cross(w, &e, &f, &node));
            BVXI_TRY(mend_split_at(w, i, node));
            BVXI_TRY(mend_split_at(w, j, node));
            /* both end at that point, and cross all the same */
            if (w->split_count == before) {
                w->split_count = BVXI_NONE;
                return BVX_ERR_BUDGET;
            }
        }
    }
    w->changed[e.loop] = w->changed[f.loop] = 1;
    return BVX_OK;
}

static bvx_status mend_find_pairs(bvxi_mend_work *w)
{
    BVXI_TRY(BVXI_RESERVE(w->s, w->box, w->edge.count, w->box_room, "the segments of loops to mend"));
    for (uint32_t i = 0; i < w->edge.count; i++)
        w->box[i] = bvxi_box_segment(w->node[w->edge.at[i].node[0]].q, w->node[w->edge.at[i].node[1]].q, i);
    w->split_count = w->crossings = 0;
    bvx_status const status = bvxi_sweep(w->s->ctx, w->box, w->edge.count, mend_pair, w);
    return w->split_count == BVXI_NONE ? BVX_OK : status;
}

static bvx_status mend_find_passed(bvxi_mend_work *w)
{
    uint32_t count = 0;

    BVXI_TRY(BVXI_RESERVE_BESIDE(w->s, w->key, w->node_count, w->order_room, sizeof *w->key,
                                 "the order of segments"));
    BVXI_TRY(BVXI_RESERVE(w->s, w->order, w->node_count, w->order_room, "the order of segments"));
    for (uint32_t i = 0; i < w->node_count; i++) {
        /* Nodes of loops that stay as they are split nothing. */
        if (w->node[i].loop != BVXI_NONE && !w->changed[w->node[i].loop]) continue;
        w->key[count] = (uint64_t)(uint32_t)w->node[i].q[0];
        w->order[count++] = i;
    }
    BVXI_TRY(bvxi_radix_sort(w->s->ctx, w->key, w->order, count));
    for (uint32_t i = 0; i < w->edge.count; i++) {
        const int32_t *const a = w->node[w->edge.at[i].node[0]].q;
        const int32_t *const b = w->node[w->edge.at[i].node[1]].q;
        /* A pixel farther on both sides, as the squares about points reach that far. */
        int32_t left = (a[0] < b[0] ? a[0] : b[0]) - MEND_PIXEL;
        int32_t const right = (a[0] < b[0] ? b[0] : a[0]) + MEND_PIXEL;
        uint32_t begin = 0, end = count;

        if (!w->changed[w->edge.at[i].loop]) continue;
        if (left < 0) left = 0;
        while (begin < end) { /* the first node that lies as far */
            uint32_t const middle = begin + (end - begin) / 2;
            if (w->key[middle] < (uint64_t)(uint32_t)left) begin = middle + 1;
            else end = middle;
        }
        /* Does the segment pass through the square about a point, between its ends? Coordinates lie below 2^29. */
        int64_t const x = (int64_t)b[0] - a[0], y = (int64_t)b[1] - a[1];
        int64_t const reach = ((x < 0 ? -x : x) + (y < 0 ? -y : y)) * (MEND_PIXEL / 2);
        for (; begin < count && w->key[begin] <= (uint64_t)(uint32_t)right; begin++) {
            const int32_t *const c = w->node[w->order[begin]].q;
            int64_t const turn = x * ((int64_t)c[1] - a[1]) - y * ((int64_t)c[0] - a[0]);
            int64_t const along = x * ((int64_t)c[0] - a[0]) + y * ((int64_t)c[1] - a[1]);
            if (along > 0 && along < x * x + y * y && turn < reach && turn > -reach)
                BVXI_TRY(mend_split_at(w, i, w->order[begin]));
        }
    }
    return BVX_OK;
}

static int64_t mend_along(const bvxi_mend_work *w, const bvxi_mend_edge *e, uint32_t node)
{
    const int32_t *const a = w->node[e->node[0]].q;
    const int32_t *const b = w->node[e->node[1]].q;
    const int32_t *const c = w->node[node].q;
    return ((int64_t)b[0] - a[0]) * ((int64_t)c[0] - a[0]) + ((int64_t)b[1] - a[1]) * ((int64_t)c[1] - a[1]);
}

/* Splits of one edge from its first end to its last; few lie on one. */
static void mend_sort_splits(const bvxi_mend_work *w, uint32_t *order, uint32_t count)
{
    const bvxi_mend_edge *const e = &w->edge.at[w->split[order[0]].edge];
    for (uint32_t i = 1; i < count; i++) {
        uint32_t const x = order[i];
        int64_t const along = mend_along(w, e, w->split[x].node);
        uint32_t j = i;
        for (; j > 0 && mend_along(w, e, w->split[order[j - 1]].node) > along; j--) order[j] = order[j - 1];
        order[j] = x;
    }
}

static bvx_status mend_apply_splits(bvxi_mend_work *w)
{
    uint32_t const n = w->split_count;
    bvxi_mend_edges const edges = w->edge;
    uint32_t at = 0;

    BVXI_TRY(BVXI_RESERVE_BESIDE(w->s, w->key, n, w->order_room, sizeof *w->key, "the order of segments"));
    BVXI_TRY(BVXI_RESERVE(w->s, w->order, n, w->order_room, "the order of segments"));
    for (uint32_t i = 0; i < n; i++) {
        w->key[i] = w->split[i].edge;
        w->order[i] = i;
    }
    BVXI_TRY(bvxi_radix_sort(w->s->ctx, w->key, w->order, n));

    w->split_edge.count = 0;
    for (uint32_t e = 0; e < w->edge.count; e++) {
        uint32_t from = w->edge.at[e].node[0], end = at;
        while (end < n && w->split[w->order[end]].edge == e) end++;
        if (end > at) mend_sort_splits(w, w->order + at, end - at);
        for (; at <= end; at++) {
            uint32_t const to = at < end ? w->split[w->order[at]].node : w->edge.at[e].node[1];
            if (to != from) BVXI_TRY(mend_add_edge(w, &w->split_edge, from, to, w->edge.at[e].loop));
            from = to;
        }
        at = end;
    }

    /* The new edges take the place of the old ones, whose array serves the next round. */
    w->edge = w->split_edge;
    w->split_edge = edges;
    return BVX_OK;
}

/* Fill in nodes, edges and the loops that change. *done is 0 where splitting does not end. */
static bvx_status mend_split_plane(bvxi_mend_work *w, int *done)
{
    w->node_count = w->edge.count = 0;
    bvxi_map_clear(w->map);
    memset(w->changed, 0, w->plane->contour_count);
    for (uint32_t i = 0; i < w->plane->contour_count; i++) BVXI_TRY(mend_take_loop(w, i));

    uint64_t most = UINT32_MAX;
    *done = 0;
    /* Until nothing meets; bounded, since moved segments may meet new ones. */
    for (int round = 0; round < MEND_ROUNDS && !*done && w->edge.count <= most; round++) {
        /* Points that are there first: what crosses beside one of them comes to it. */
        w->cross = 0;
        BVXI_TRY(mend_find_pairs(w));
        if (w->split_count + w->crossings != 0) BVXI_TRY(mend_find_passed(w));
        /* Only when ends lie on nothing any more are crossings split. */
        if (w->split_count == 0 && w->crossings != 0) {
            w->cross = 1;
            BVXI_TRY(mend_find_pairs(w));
            if (w->split_count == BVXI_NONE) return BVX_OK;
            BVXI_TRY(mend_find_passed(w));
            if (most == UINT32_MAX) most = MEND_MOST * ((uint64_t)w->edge.count + w->split_count);
        }
        *done = w->split_count == 0;
        if (!*done) BVXI_TRY(mend_apply_splits(w));
    }
    return BVX_OK;
}

/* ---- stacks ---- */

enum { MEND_COARSEST = 4 }; /* bits of a cell in fixed point */

#define MEND_LEAST_STEP (1.0 / 4194304.0) /* of the contours' extent, on planes of any direction */

static int mend_has_three_points(const bvx_sections *given, const bvx_section_loop *l)
{
    const double *const p = given->points + 3 * l->first_point;
    uint64_t different = 0;
    for (uint64_t i = 0; i < l->point_count; i++) {
        const double *const a = p + 3 * i, *const b = p + 3 * (i == 0 ? l->point_count - 1 : i - 1);
        different += a[0] != b[0] || a[1] != b[1] || a[2] != b[2];
    }
    return different > 2;
}

static bvx_status mend_copy_loop(const bvx_sections *given, uint64_t number, bvxi_mended *m)
{
    const bvx_section_loop *const l = &given->loops[number];
    BVXI_TRY(bvxi_mended_add_loop(m, l->section, l->label));
    for (uint64_t i = 0; i < l->point_count; i++)
        BVXI_TRY(bvxi_mended_add_point(m, given->points + 3 * (l->first_point + i), 0, 0));
    return BVX_OK;
}

static void begin_mended(bvx_context *ctx, const char *function, const bvx_sections *given, bvxi_mended *m)
{
    *m = (bvxi_mended){.ctx = ctx, .function = function, .sections = *given};
    m->sections.points = NULL;
    m->sections.loops = NULL;
    m->sections.point_count = m->sections.loop_count = m->sections.point_capacity =
        m->sections.loop_capacity = 0;
}

static double step_length(double cell, int32_t fine)
{
    return cell / (double)(1 << (fine - 1));
}

bvx_status bvxi_mend(bvx_context *ctx, const char *function, const bvx_sections *given,
                     const bvx_sections_options *options, double least, bvxi_mended *m)
{
    bvx_sections kept;
    bvxi_stack s;
    begin_mended(ctx, function, given, m);
    /* Loops of fewer than three different points are left out; all other arrays are shared. */
    kept = *given;
    kept.loop_count = 0;
    kept.loops = NULL;
    BVXI_TRY(BVXI_ARRAY(ctx, given->loop_count, "the loops to mend", kept.loops));
    for (uint64_t i = 0; i < given->loop_count; i++)
        if (mend_has_three_points(given, &given->loops[i])) kept.loops[kept.loop_count++] = given->loops[i];
    m->loops = given->loop_count - kept.loop_count;
    if (kept.loop_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no loop has three different points", function);
    BVXI_TRY(bvxi_stack_begin(ctx, function, &kept, options, &s));
    while (s.fine > MEND_COARSEST && step_length(s.step[0], s.fine) < least) s.fine--;
    bvxi_stack_give_grid(&s, &m->grid);

    bvxi_map map = {0};
    bvxi_mend_work w = {.s = &s, .map = &map};
    uint64_t most = 1;

    /* One mark a loop, for the plane with the most; other arrays grow as needed. */
    for (uint32_t i = 0; i < s.plane_count; i++)
        if (s.plane[i].contour_count > most) most = s.plane[i].contour_count;
    BVXI_TRY(BVXI_ARRAY(s.ctx, most, "the loops to mend", w.changed));
    for (uint32_t i = 0; i < s.plane_count; i++) {
        BVXI_TRY(bvxi_progress(s.ctx, "mend", (double)i / s.plane_count));
        bvxi_plane_snap(&s, &s.plane[i]);
        w.plane = &s.plane[i];
        uint64_t changed = 0;
        int done;

        /* Where splitting does not end, loops stay as they are and are refused later. */
        BVXI_TRY(mend_split_plane(&w, &done));
        for (uint32_t k = 0; k < w.plane->contour_count; k++) {
            if (w.changed[k] && done) changed++;
            else BVXI_TRY(mend_copy_loop(&kept, w.plane->contour[k].given, m));
        }
        m->loops += changed;
        if (changed != 0) BVXI_TRY(bvxi_mend_trace(&w, m));
    }
    return BVX_OK;
}

/* The loops of one section, a stack of one plane, with their points where steps put them. */
static bvx_status mend_section(bvx_context *ctx, const char *function, const bvx_sections *one,
                               uint32_t section, const bvx_sections_options *o, double least, bvxi_mended *m)
{
    bvxi_mended mended;
    double axis[3][3];
    bvx_status const status = bvxi_mend(ctx, function, one, o, least, &mended);
    const bvx_section_loop *l = mended.sections.loops;

    /* Nothing of them encloses an area. */
    m->loops += status == BVX_ERR_EMPTY ? one->loop_count : mended.loops;
    if (status != BVX_OK) return status == BVX_ERR_EMPTY ? BVX_OK : status;
    BVXI_TRY(bvxi_section_frame(ctx, function, one->normal, axis));
    for (; l < mended.sections.loops + mended.sections.loop_count; l++) {
        BVXI_TRY(bvxi_mended_add_loop(m, section, l->label));
        for (uint64_t p = l->first_point; p < l->first_point + l->point_count; p++) {
            double at[3];
            memcpy(at, mended.sections.points + 3 * p, sizeof at);
            for (int a = 0; a < 2; a++)
                for (int k = 0; k < 3 && mended.nudge[p][a] != 0; k++)
                    at[k] += axis[a][k] *
                             (mended.nudge[p][a] * step_length(mended.grid.step[a], mended.grid.fine));
            BVXI_TRY(bvxi_mended_add_point(m, at, 0, 0));
        }
    }
    return BVX_OK;
}

bvx_status bvxi_mend_planes(bvx_context *ctx, const char *function, const bvx_sections *given,
                            const bvx_sections_options *options, bvxi_mended *m)
{
    bvx_sections_options o = *options;
    bvx_sections one = *given;
    double widest = 0.0;

    begin_mended(ctx, function, given, m);
    o.thickness = 1.0;
    if (o.label == BVXI_LABEL_ONLY) o.label = given->loops[0].label;
    for (uint64_t i = 0; i < 3 * given->point_count; i++) {
        double const width = bvxi_absolute(given->points[i] - given->points[i % 3]);
        if (width > widest) widest = width;
    }
    one.normals = NULL;
    one.section_count = 1;
    BVXI_TRY(BVXI_ARRAY(ctx, given->loop_count, "the loops to mend", one.loops));
    for (uint32_t k = 0; k < given->section_count; k++) {
        one.loop_count = 0;
        one.positions = given->positions + k;
        memcpy(one.normal, given->normals + 3 * (uint64_t)k, sizeof one.normal);
        for (uint64_t i = 0; i < given->loop_count; i++) {
            if (given->loops[i].section != k) continue;
            one.loops[one.loop_count] = given->loops[i];
            one.loops[one.loop_count].section = 0;
            if (given->loops[i].label == o.label) one.loop_count++;
            else BVXI_TRY(mend_copy_loop(given, i, m));
        }
        if (one.loop_count != 0)
            BVXI_TRY(mend_section(ctx, function, &one, k, &o, MEND_LEAST_STEP * widest, m));
    }
    return BVX_OK;
}
