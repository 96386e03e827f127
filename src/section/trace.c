/* trace.c - the surface in one cell: its loops over the cell's faces, each filled with triangles.
 *
 * Round the cell's sides, counter-clockwise, stand its corners and those of finer cells; between two of them is a strip. Crossings
 * of both levels' edges and of the corners' heights are points; each strip links its points, and each level links crossings along
 * its contours. Loops run with the inside on their right, seen from outside of the cell: along contours below, against those
 * above. Every point gets one successor, so loops close, and what the neighbours see of a face is the same with the other
 * direction. */
#include "section/trace.h"

#include "lattice/wide.h"

enum { TRACE_CHOICES = 4, TRACE_FEW = 4 }; /* loops whose filling is chosen; triangles of one loop that are not looked at */

/* ---- arrays ---- */

bvx_status bvxi_trace_add_point(bvxi_trace *t, uint32_t vertex, uint32_t faces, uint32_t *point)
{
    bvxi_trace_point *p;
    BVXI_TRY(bvxi_slab_grow(t->s, &t->point, t->point_count, &t->point_room, sizeof *t->point, "the crossings of a cell"));
    *point = t->point_count++;
    p = &t->point[*point];
    p->vertex = vertex;
    p->next = BVXI_NONE;
    p->arc = BVXI_NONE;
    p->faces = (uint8_t)faces;
    p->link = BVXI_LINK_STRAIGHT;
    p->seen = 0;
    return BVX_OK;
}

/* Room for a loop of count vertices. */
static bvx_status open_loop(bvxi_trace *t, uint64_t count)
{
    bvxi_stack *const s = t->s;
    uint64_t const room = count + count / 2 + 64, old = t->loop_room;
    if (count <= old) return BVX_OK;
    if (room > INT32_MAX) return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: a cell holds more than 2^31 contour points", s->function);
    /* what was is kept: a loop grows while it is followed */
    {
        uint32_t *vertex = NULL, *next = NULL, *before = NULL;
        uint8_t *faces = NULL;
        const double **at = NULL;
        bvx_status status = bvxi_alloc(s->ctx, BVXI_SCRATCH, room * 4, "a loop of a cell", &vertex);
        if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, room, "a loop of a cell", &faces);
        if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, room * sizeof *at, "a loop of a cell", &at);
        if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, room * 4, "a loop of a cell", &next);
        if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, room * 4, "a loop of a cell", &before);
        if (status != BVX_OK) {
            bvxi_free(s->ctx, next, next == NULL ? 0 : room * 4);
            bvxi_free(s->ctx, (void *)at, at == NULL ? 0 : room * sizeof *at);
            bvxi_free(s->ctx, faces, faces == NULL ? 0 : room);
            bvxi_free(s->ctx, vertex, vertex == NULL ? 0 : room * 4);
            return status;
        }
        if (old != 0) {
            memcpy(vertex, t->vertex, (size_t)old * 4);
            memcpy(faces, t->faces, (size_t)old);
        }
        bvxi_free(s->ctx, t->before, old * 4);
        bvxi_free(s->ctx, t->next, old * 4);
        bvxi_free(s->ctx, (void *)t->at, old * sizeof *at);
        bvxi_free(s->ctx, t->faces, old);
        bvxi_free(s->ctx, t->vertex, old * 4);
        t->vertex = vertex;
        t->faces = faces;
        t->at = at;
        t->next = next;
        t->before = before;
        t->loop_room = (uint32_t)room;
    }
    return BVX_OK;
}

bvx_status bvxi_trace_add_to_loop(bvxi_trace *t, uint32_t *count, uint32_t vertex, uint32_t faces)
{
    if (*count >= t->loop_room) BVXI_TRY(open_loop(t, (uint64_t)*count + 1));
    t->vertex[*count] = vertex;
    t->faces[(*count)++] = (uint8_t)faces;
    return BVX_OK;
}

void bvxi_trace_free(bvxi_trace *t)
{
    bvxi_stack *const s = t->s;
    uint64_t const loop = t->loop_room;
    bvxi_free(s->ctx, t->before, loop * 4);
    bvxi_free(s->ctx, t->next, loop * 4);
    bvxi_free(s->ctx, (void *)t->at, loop * sizeof *t->at);
    bvxi_free(s->ctx, t->faces, loop);
    bvxi_free(s->ctx, t->vertex, loop * 4);
    bvxi_free(s->ctx, t->insert, (uint64_t)t->insert_room * sizeof *t->insert);
    for (int k = 2; k-- > 0;) {
        bvxi_free(s->ctx, t->cross[k], (uint64_t)t->cross_room * 4);
        bvxi_free(s->ctx, t->row[k], (uint64_t)t->row_room * 4);
        bvxi_free(s->ctx, t->gathered[k], (uint64_t)t->gathered_room[k] * sizeof *t->gathered[k]);
    }
    bvxi_free(s->ctx, t->end, (uint64_t)t->end_room * sizeof *t->end);
    bvxi_free(s->ctx, t->point, (uint64_t)t->point_room * sizeof *t->point);
    bvxi_free(s->ctx, t->node, (uint64_t)t->node_room * sizeof *t->node);
    bvxi_map_free(s, &t->folds);
}

/* ---- crossings of contours ---- */

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
                bvxi_trace_end *e;
                const bvxi_line_cut *const c = &p->cut[to ? a->to : a->from];
                BVXI_TRY(bvxi_slab_grow(t->s, &t->end, t->end_count, &t->end_room, sizeof *t->end, "the crossings of a cell"));
                e = &t->end[t->end_count++];
                e->arc = i;
                e->cut = to ? a->to : a->from;
                e->is_to = (uint8_t)to;
                e->k = (uint8_t)k;
                e->side = (uint8_t)bvxi_side_of(c, t->low);
                BVXI_TRY(bvxi_trace_add_point(t, p->vertex + c->ring, (k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE) | (uint32_t)BVXI_FACE_SIDE << e->side,
                                              &e->point));
            }
        }
    }
    return BVX_OK;
}

/* Each end's point goes on along its arc: contours below run forwards, above backwards. */
static void link_arcs(bvxi_trace *t)
{
    for (uint32_t i = 0; i + 1 < t->end_count; i += 2) { /* from, to */
        const bvxi_trace_end *const from = &t->end[i], *const to = &t->end[i + 1];
        const bvxi_trace_end *const a = from->k == 0 ? from : to, *const b = from->k == 0 ? to : from;
        bvxi_trace_point *const p = &t->point[a->point];
        p->next = b->point;
        p->arc = from->arc;
        p->link = from->k == 0 ? BVXI_LINK_ARC : BVXI_LINK_ARC_BACK;
    }
}

/* 1 when crossing c comes before d on one line, towards higher coordinates; exact. */
static int cut_before(const bvxi_plane *p, const bvxi_line_cut *c, const bvxi_line_cut *d)
{
    int const k = c->axis, o = 1 - k;
    const int32_t *const ca = p->q[c->segment], *const cb = p->q[p->next[c->segment]];
    const int32_t *const da = p->q[d->segment], *const db = p->q[p->next[d->segment]];
    int64_t const origin = ca[o];
    int64_t cn = ((int64_t)c->line - ca[k]) * ((int64_t)cb[o] - ca[o]), cd = (int64_t)cb[k] - ca[k];
    int64_t dn = ((int64_t)da[o] - origin) * ((int64_t)db[k] - da[k]) + ((int64_t)d->line - da[k]) * ((int64_t)db[o] - da[o]);
    int64_t dd = (int64_t)db[k] - da[k];
    if (cd < 0) {
        cd = -cd;
        cn = -cn;
    }
    if (dd < 0) {
        dd = -dd;
        dn = -dn;
    }
    return bvxi_wide_sign(bvxi_wide_add(bvxi_wide_mul(cn, dd), bvxi_wide_mul(-dn, cd))) < 0;
}

/* The ends on one side, of one level, counter-clockwise. */
static bvx_status sort_side(bvxi_trace *t, int side, int k, uint32_t *count)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t *const row = t->row[k];
    uint32_t n = 0;
    for (uint32_t i = 0; i < t->end_count; i++) {
        uint32_t j;
        if (t->end[i].side != side || t->end[i].k != k) continue;
        for (j = n++; j > 0; j--) {
            int const before = cut_before(p, &p->cut[t->end[i].cut], &p->cut[t->end[row[j - 1]].cut]);
            if (before == (side >= 2)) break;
            row[j] = row[j - 1];
        }
        row[j] = i;
    }
    *count = n;
    return BVX_OK;
}

/* ---- round the cell ---- */

static bvx_status open_rows(bvxi_trace *t)
{
    bvxi_stack *const s = t->s;
    uint32_t const need = t->end_count + 1, crossings = t->node_count + 1;
    for (int which = 0; which < 2; which++) {
        uint32_t *const room = which == 0 ? &t->row_room : &t->cross_room;
        uint64_t const wanted = which == 0 ? need : crossings, larger = wanted + wanted / 2 + 16;
        if (wanted <= *room) continue;
        for (int k = 0; k < 2; k++) {
            uint32_t **const rows = which == 0 ? &t->row[k] : &t->cross[k];
            uint32_t *made;
            bvx_status const status = bvxi_alloc(s->ctx, BVXI_SCRATCH, larger * 4, "the crossings of a side", &made);
            if (status != BVX_OK) { /* both rows keep one length */
                if (k == 1) {
                    uint32_t **const done = which == 0 ? &t->row[0] : &t->cross[0];
                    bvxi_free(s->ctx, *done, larger * 4);
                    *done = NULL;
                    bvxi_free(s->ctx, *rows, (uint64_t)*room * 4);
                    *rows = NULL;
                    *room = 0;
                }
                return status;
            }
            bvxi_free(s->ctx, *rows, (uint64_t)*room * 4);
            *rows = made;
        }
        *room = (uint32_t)larger;
    }
    return BVX_OK;
}

/* How many of a row's crossings lie before a node. */
static uint32_t count_before(const bvxi_trace *t, const bvxi_plane *p, const uint32_t *row, uint32_t from, uint32_t count, int side, const int32_t at[2])
{
    int32_t const m = at[side & 1]; /* sides 0 and 2 run along u */
    uint32_t i = from;
    while (i < count && bvxi_cut_beyond(p, &p->cut[t->end[row[i]].cut], m) == (side >= 2)) i++;
    return i - from;
}

static bvx_status link_strip(bvxi_trace *t, uint32_t a, uint32_t b, const uint32_t points[], uint32_t done[2], const uint32_t count[2], int side,
                             int last)
{
    bvxi_trace_node *const left = &t->node[a], *const right = &t->node[b];
    uint32_t n[2] = {0, 0}, crossing[2];
    uint32_t *row[2];
    for (int k = 0; k < 2; k++) {
        row[k] = t->row[k] + done[k];
        if (t->level[k].kind == BVXI_PLANE_EXACT) {
            n[k] = last ? count[k] - done[k] : count_before(t, t->level[k].plane, t->row[k], done[k], count[k], side, right->at);
            for (uint32_t i = 0; i < n[k]; i++) row[k][i] = t->end[row[k][i]].point; /* the row holds points from here */
            done[k] += n[k];
        } else if (t->level[k].kind == BVXI_PLANE_FIELD && left->inside[k] != right->inside[k]) {
            uint32_t vertex;
            BVXI_TRY(bvxi_trace_edge(t, k, left, right, &vertex));
            BVXI_TRY(bvxi_trace_add_point(t, vertex, (k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE) | (uint32_t)BVXI_FACE_SIDE << side, &crossing[k]));
            t->cross[k][t->cross_count[k]++] = crossing[k];
            row[k] = &crossing[k];
            n[k] = 1;
        }
    }
    return bvxi_trace_strip(t, left, right, row[0], n[0], row[1], n[1], points[a], points[b], side);
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
        uint32_t count[2] = {0, 0}, done[2] = {0, 0};
        for (int k = 0; k < 2; k++)
            if (t->level[k].kind == BVXI_PLANE_EXACT) BVXI_TRY(sort_side(t, side, k, &count[k]));
        for (uint32_t i = corner[side]; i < corner[side + 1]; i++)
            BVXI_TRY(link_strip(t, i, i + 1 == t->node_count ? 0 : i + 1, points, done, count, side, i + 1 == corner[side + 1]));
    }
    return BVX_OK;
}

/* ---- loops ---- */

/* Where a contour's stretch of the ring ends, given one place in it. */
static void ring_of(const bvxi_plane *p, uint32_t point, uint32_t *first, uint32_t *end)
{
    uint32_t low = 0, high = p->contour_count;
    while (high - low > 1) {
        uint32_t const middle = low + (high - low) / 2;
        if (p->contour[middle].first <= point) low = middle;
        else high = middle;
    }
    *first = p->ring[p->contour[low].first];
    *end = low + 1 < p->contour_count ? p->ring[p->contour[low + 1].first] : p->ring_count;
}

/* The ring's vertices between two cuts, forwards or backwards. */
static bvx_status follow_ring(bvxi_trace *t, int k, const bvxi_arc *a, int back, uint32_t *count)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t const face = k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE;
    uint32_t first, end, i = p->cut[back ? a->to : a->from].ring, stop = p->cut[back ? a->from : a->to].ring;
    ring_of(p, p->cut[a->from].segment, &first, &end);
    for (;;) {
        if (back) i = i == first ? end - 1 : i - 1;
        else i = i + 1 == end ? first : i + 1;
        if (i == stop) return BVX_OK;
        BVXI_TRY(bvxi_trace_add_to_loop(t, count, p->vertex + i, face));
    }
}

static bvx_status fill_traced(bvxi_trace *t, uint32_t count)
{
    bvxi_loop_fill l;
    l.count = count;
    l.vertex = t->vertex;
    l.faces = t->faces;
    l.at = t->at;
    l.next = t->next;
    l.before = t->before;
    l.low = t->low;
    l.size = t->size;
    l.low_w = t->low_w;
    l.high_w = t->high_w;
    l.cone = 0;
    if (t->loop_count < TRACE_CHOICES) { /* digits to the base of three */
        uint32_t digits = t->choice;
        for (uint32_t i = 0; i < t->loop_count; i++) digits /= 3;
        l.cone = (int)(digits % 3);
    }
    t->loop_count++;
    BVXI_TRY(bvxi_fill_loop(t->s, &l));
    t->strips += (uint32_t)l.strip;
    return BVX_OK;
}

/* The lines of a body's first and last plane are what a flat cap ends at. from: the loop's place behind the first vertex. */
static bvx_status keep_cap_lines(bvxi_trace *t, int k, uint32_t from, uint32_t count, uint32_t last)
{
    bvxi_stack *const s = t->s;
    const bvxi_plane *const p = t->level[k].plane;
    if (s->options.caps != BVX_CAPS_FLAT || p == NULL || p != &s->plane[k == 0 ? 0 : s->plane_count - 1]) return BVX_OK;
    for (uint32_t i = from - 1; i < count; i++) {
        uint32_t const a = t->vertex[i], b = i + 1 < count ? t->vertex[i + 1] : last;
        uint32_t *e;
        BVXI_TRY(bvxi_slab_grow(s, &s->cap_edge[k], s->cap_edge_count[k], &s->cap_edge_room[k], sizeof *s->cap_edge[k], "the lines of a cap"));
        e = s->cap_edge[k][s->cap_edge_count[k]++];
        e[0] = k == 0 ? a : b;
        e[1] = k == 0 ? b : a;
    }
    return BVX_OK;
}

static bvx_status follow_loop(bvxi_trace *t, uint32_t start)
{
    uint32_t count = 0, i = start;
    do {
        bvxi_trace_point *const p = &t->point[i];
        if (p->seen || p->next == BVXI_NONE)
            return bvxi_fail(t->s->ctx, BVX_ERR_FORMAT, "%s: the surface does not close in the grid cell (%u, %u)", t->s->function,
                             (uint64_t)(t->number % (uint32_t)t->s->size[0]), (uint64_t)(t->number / (uint32_t)t->s->size[0]));
        p->seen = 1;
        BVXI_TRY(bvxi_trace_add_to_loop(t, &count, p->vertex, p->faces));
        if (p->link == BVXI_LINK_ARC || p->link == BVXI_LINK_ARC_BACK) {
            int const k = p->link == BVXI_LINK_ARC_BACK;
            BVXI_TRY(follow_ring(t, k, &t->arc[k][p->arc], k, &count));
        } else if (p->link == BVXI_LINK_FIELD || p->link == BVXI_LINK_FIELD_BACK) {
            int const k = p->link == BVXI_LINK_FIELD_BACK;
            uint32_t const start_count = count;
            BVXI_TRY(bvxi_trace_insert(t, k, i, p->next, k, &count));
            BVXI_TRY(keep_cap_lines(t, k, start_count, count, t->point[p->next].vertex));
        }
        i = t->point[i].next;
    } while (i != start);
    return fill_traced(t, count);
}

/* A loop of a section that lies in the cell whole: closed by a cone. */
static bvx_status fill_inner_loop(bvxi_trace *t, int k, const bvxi_arc *a)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t first, end, count = 0;
    ring_of(p, a->point, &first, &end);
    for (uint32_t i = first; i < end; i++)
        BVXI_TRY(bvxi_trace_add_to_loop(t, &count, p->vertex + (k == 0 ? i : end - 1 - (i - first)), k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE));
    return fill_traced(t, count);
}

/* ---- the cell ---- */

static bvx_status fill_cell_loops(bvxi_trace *t)
{
    t->loop_count = t->strips = 0;
    for (uint32_t i = 0; i < t->point_count; i++) t->point[i].seen = 0;
    for (uint32_t i = 0; i < t->point_count; i++)
        if (!t->point[i].seen) BVXI_TRY(follow_loop(t, i));
    for (int k = 0; k < 2; k++) {
        if (t->level[k].kind != BVXI_PLANE_EXACT) continue;
        for (uint32_t i = 0; i < t->arc_count[k]; i++)
            if (t->arc[k][i].from == BVXI_NONE) BVXI_TRY(fill_inner_loop(t, k, &t->arc[k][i]));
    }
    return BVX_OK;
}

/* Fill the loops; where triangles cross, fill them again, some of them round a vertex inside the cell: every choice for the first loops
 * is tried. In the paper's way vertices are made while loops are followed, and its triangles stay as they are. */
static bvx_status fill_uncrossed(bvxi_trace *t)
{
    bvxi_stack *const s = t->s;
    uint64_t const triangles = s->mesh.triangle_count, vertices = s->mesh.vertex_count, inner = s->report.inner_vertices;
    uint32_t choices = 1;
    t->choice = 0;
    BVXI_TRY(fill_cell_loops(t));
    if (t->loop_count == 1 && (t->strips == 1 || s->mesh.triangle_count - triangles <= TRACE_FEW)) return BVX_OK; /* as good as never */
    if (!bvxi_cell_crosses(s, triangles)) return BVX_OK;
    if (s->options.crossings != BVX_CROSSINGS_PAPER)
        for (uint32_t i = 0; i < t->loop_count && i < TRACE_CHOICES; i++) choices *= 3;
    for (uint32_t i = 1; i < choices; i++) {
        s->mesh.triangle_count = triangles;
        s->mesh.vertex_count = vertices;
        s->report.inner_vertices = inner;
        t->choice = i;
        BVXI_TRY(fill_cell_loops(t));
        if (!bvxi_cell_crosses(s, triangles)) return BVX_OK;
    }
    s->report.crossed_cells++;
    if (choices == 1) return BVX_OK;
    s->mesh.triangle_count = triangles;
    s->mesh.vertex_count = vertices;
    s->report.inner_vertices = inner;
    t->choice = 0;
    return fill_cell_loops(t);
}

bvx_status bvxi_trace_slab_cell(bvxi_trace *t)
{
    uint32_t corner[5];
    t->point_count = 0;
    BVXI_TRY(bvxi_trace_nodes(t, corner));
    BVXI_TRY(gather_ends(t));
    BVXI_TRY(open_rows(t));
    BVXI_TRY(open_loop(t, (uint64_t)t->node_count + 16));
    BVXI_TRY(link_sides(t, corner, t->next)); /* the loop's scratch holds the nodes' points until loops are followed */
    link_arcs(t);
    for (int k = 0; k < 2; k++)
        if (t->level[k].kind == BVXI_PLANE_FIELD) BVXI_TRY(bvxi_trace_face(t, k));
    return fill_uncrossed(t);
}
