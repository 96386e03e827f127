/* trace.c - the surface in one cell: its loops over the cell's faces, each filled with triangles.
 *
 * Round the cell's sides, counter-clockwise, stand its corners and those of finer cells; between two of them
 * is a strip. Crossings of both levels' edges and of the corners' heights are points; each strip links its
 * points, and each level links crossings along its contours. Loops run with the inside on their right, seen
 * from outside of the cell: along contours below, against those above. Every point gets one successor, so
 * loops close, and what the neighbours see of a face is the same with the other direction. */
#include "layers/trace.h"

#include "lattice/wide.h"

static bvx_status gather_ends(bvxi_trace *t)
{
    t->end_count = 0;
    for (int k = 0; k < 2; k++) {
        const bvxi_plane *const p = t->level[k].plane;
        if (t->level[k].kind != BVXI_PLANE_EXACT) continue;
        for (uint32_t i = 0; i < t->arc_count[k]; i++) {
            const bvxi_arc *const a = &t->arc[k][i];
            if (a->from == BVXI_NONE) continue;
            for (int to = 0; to < 2; to++) {
                const bvxi_line_cut *const c = &p->cut[to ? a->to : a->from];
                BVXI_TRY(BVXI_SLAB_GROW(t->s, t->end, t->end_count, t->end_room, "the crossings of a cell"));
                bvxi_trace_end *const e = &t->end[t->end_count++];
                e->arc = i;
                e->cut = to ? a->to : a->from;
                e->is_to = (uint8_t)to;
                e->k = (uint8_t)k;
                e->side = (uint8_t)bvxi_side_of(c, t->low);
                BVXI_TRY(bvxi_trace_add_point(t, p->vertex + c->ring,
                                              (k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE) |
                                                  (uint32_t)BVXI_FACE_SIDE << e->side,
                                              &e->point));
            }
        }
    }
    return BVX_OK;
}

/* 1 when crossing c comes before d on one line, towards higher coordinates; exact. */
static int cut_before(const bvxi_plane *p, const bvxi_line_cut *c, const bvxi_line_cut *d)
{
    int const k = c->axis, o = 1 - k;
    const int32_t *const ca = p->q[c->segment], *const cb = p->q[p->next[c->segment]];
    const int32_t *const da = p->q[d->segment], *const db = p->q[p->next[d->segment]];
    int64_t const origin = ca[o];
    int64_t cn = ((int64_t)c->line - ca[k]) * ((int64_t)cb[o] - ca[o]), cd = (int64_t)cb[k] - ca[k];
    int64_t dn = ((int64_t)da[o] - origin) * ((int64_t)db[k] - da[k]) +
                 ((int64_t)d->line - da[k]) * ((int64_t)db[o] - da[o]);
    int64_t dd = (int64_t)db[k] - da[k];

    /* Denominators above 0, so that the products compare as the quotients do. */
    if (cd < 0) {
        cd = -cd;
        cn = -cn;
    }
    if (dd < 0) {
        dd = -dd;
        dn = -dn;
    }
    /* Products of three differences, which 64 bits do not hold. */
    return bvxi_wide_sign(bvxi_wide_add(bvxi_wide_mul(cn, dd), bvxi_wide_mul(-dn, cd))) < 0;
}

/* The ends on one side, of one level, counter-clockwise. */
static uint32_t sort_side(const bvxi_trace *t, int side, int k)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t *const row = t->row[k];
    uint32_t n = 0;

    for (uint32_t i = 0; i < t->end_count; i++) {
        uint32_t j;
        if (t->end[i].side != side || t->end[i].k != k) continue;
        for (j = n++; j > 0; j--) {
            int const before = cut_before(p, &p->cut[t->end[i].cut], &p->cut[t->end[row[j - 1]].cut]);
            /* Sides 2 and 3 run towards lower coordinates. */
            if (before == (side >= 2)) break;
            row[j] = row[j - 1];
        }
        row[j] = i;
    }
    return n;
}

/* A side of the cell on the way along its strips: ends in the rows below and above, those that are done. */
typedef struct side_walk {
    int side;
    uint32_t count[2], done[2];
} side_walk;

static bvx_status link_strip(bvxi_trace *t, side_walk *w, uint32_t a, uint32_t b, const uint32_t points[],
                             int last)
{
    bvxi_trace_node *const left = &t->node[a], *const right = &t->node[b];
    bvxi_strip strip = {
        .left = left, .right = right, .left_point = points[a], .right_point = points[b], .side = w->side};
    uint32_t crossing[2];

    for (int k = 0; k < 2; k++) {
        uint32_t *const row = t->row[k] + w->done[k];

        strip.row[k] = row;
        if (t->level[k].kind == BVXI_PLANE_EXACT) {
            const bvxi_plane *const p = t->level[k].plane;
            int32_t const m = right->at[w->side & 1]; /* sides 0 and 2 run along u */
            uint32_t n = 0;
            while (w->done[k] + n < w->count[k] &&
                   (last || bvxi_cut_beyond(p, &p->cut[t->end[row[n]].cut], m) == (w->side >= 2)))
                n++;
            /* the row holds points from here */
            for (uint32_t i = 0; i < n; i++) row[i] = t->end[row[i]].point;
            strip.count[k] = n;
            w->done[k] += n;
        } else if (t->level[k].kind == BVXI_PLANE_FIELD && left->inside[k] != right->inside[k]) {
            uint32_t vertex;
            BVXI_TRY(bvxi_trace_edge(t, k, left, right, &vertex));
            BVXI_TRY(bvxi_trace_add_point(
                t, vertex, (k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE) | (uint32_t)BVXI_FACE_SIDE << w->side,
                &crossing[k]));
            t->cross[k][t->cross_count[k]++] = crossing[k];
            strip.row[k] = &crossing[k];
            strip.count[k] = 1;
        }
    }
    return bvxi_trace_strip(t, &strip);
}

/* node: counter-clockwise, corner[i] the place of the i-th corner in it. */
static bvx_status link_sides(bvxi_trace *t, const uint32_t corner[5], uint32_t *points)
{
    for (uint32_t i = 0; i < t->node_count; i++) {
        const bvxi_trace_node *const n = &t->node[i];
        points[i] = BVXI_NONE;
        if (n->vertex != BVXI_NONE) BVXI_TRY(bvxi_trace_add_point(t, n->vertex, n->faces, &points[i]));
    }
    t->cross_count[0] = t->cross_count[1] = 0;

    for (int side = 0; side < 4; side++) {
        side_walk walk = {.side = side};
        for (int k = 0; k < 2; k++)
            if (t->level[k].kind == BVXI_PLANE_EXACT) walk.count[k] = sort_side(t, side, k);
        for (uint32_t i = corner[side]; i < corner[side + 1]; i++)
            BVXI_TRY(link_strip(t, &walk, i, i + 1 == t->node_count ? 0 : i + 1, points,
                                i + 1 == corner[side + 1]));
    }
    return BVX_OK;
}

bvx_status bvxi_trace_slab_cell(bvxi_trace *t)
{
    uint32_t corner[5];
    t->point_count = 0;
    BVXI_TRY(bvxi_trace_nodes(t, corner));
    BVXI_TRY(gather_ends(t));
    BVXI_TRY(bvxi_trace_open_rows(t));
    BVXI_TRY(bvxi_trace_open_loop(t, (uint64_t)t->node_count + 16));
    /* the loop's scratch holds the nodes' points until loops are followed */
    BVXI_TRY(link_sides(t, corner, t->next));

    /* Each end's point goes on along its arc: contours below run forwards, above backwards. */
    for (uint32_t i = 0; i + 1 < t->end_count; i += 2) { /* from, to */
        const bvxi_trace_end *const from = &t->end[i], *const to = &t->end[i + 1];
        const bvxi_trace_end *const a = from->k == 0 ? from : to, *const b = from->k == 0 ? to : from;
        bvxi_trace_point *const p = &t->point[a->point];
        p->next = b->point;
        p->arc = from->arc;
        p->link = from->k == 0 ? BVXI_LINK_ARC : BVXI_LINK_ARC_BACK;
    }

    for (int k = 0; k < 2; k++)
        if (t->level[k].kind == BVXI_PLANE_FIELD) bvxi_trace_face(t, k);
    return bvxi_trace_loops(t);
}
