/* trace_loops.c - the loops of a cell: filled, and their triangles held against each other. */
#include "layers/trace.h"

/* ---- Triangles that cross ---- */

/* Triangles of one cell that cross each other.
 *
 * Loops are filled one by one, each with the shortest inner edges that are allowed; where a contour winds
 * inside a cell, or several loops lie in it, triangles of one may reach through those of another, or of the
 * same loop. Such cells are found here, by holding all pairs of a cell's triangles against each other. The
 * test is one in doubles: a touch within rounding may be taken for none. */

enum { UNCROSS_MOST = 64 };

static double uncross_volume(const double *a, const double *b, const double *c, const double *d)
{
    double const ux = b[0] - a[0];
    double const uy = b[1] - a[1];
    double const uz = b[2] - a[2];
    double const vx = c[0] - a[0];
    double const vy = c[1] - a[1];
    double const vz = c[2] - a[2];
    double const wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
    return (uy * vz - uz * vy) * wx + (uz * vx - ux * vz) * wy + (ux * vy - uy * vx) * wz;
}

/* Does the segment p q pass through the triangle? Neither end is one of its corners. */
static int uncross_pierces(const double *p, const double *q, const double *const t[3])
{
    double const sp = uncross_volume(t[0], t[1], t[2], p), sq = uncross_volume(t[0], t[1], t[2], q);
    if ((sp > 0.0) == (sq > 0.0)) return 0;
    double const a = uncross_volume(p, q, t[0], t[1]);
    double const b = uncross_volume(p, q, t[1], t[2]);
    double const c = uncross_volume(p, q, t[2], t[0]);
    return (a > 0.0 && b > 0.0 && c > 0.0) || (a < 0.0 && b < 0.0 && c < 0.0);
}

static void uncross_box(const bvxi_stack *s, const uint32_t *t, double box[6])
{
    for (int c = 0; c < 3; c++) {
        const double *const p = bvxi_section_vertex(s, t[c]);
        for (int k = 0; k < 3 && c == 0; k++) box[k] = box[k + 3] = p[k];
        bvxi_widen(box, box + 3, p, 3);
    }
}

/* Of two triangles that share corners only the sides without them can pass through. */
static int uncross_pair(const bvxi_stack *s, const uint32_t *a, const uint32_t *b)
{
    const uint32_t *const corner[2] = {a, b};
    for (int i = 0; i < 2; i++) {
        const uint32_t *const o = corner[1 - i];
        const double *const at[3] = {bvxi_section_vertex(s, o[0]), bvxi_section_vertex(s, o[1]),
                                     bvxi_section_vertex(s, o[2])};
        for (int k = 0; k < 3; k++) {
            uint32_t const p = corner[i][k], q = corner[i][(k + 1) % 3];
            if (p == o[0] || p == o[1] || p == o[2] || q == o[0] || q == o[1] || q == o[2]) continue;
            if (uncross_pierces(bvxi_section_vertex(s, p), bvxi_section_vertex(s, q), at)) return 1;
        }
    }
    return 0;
}

int bvxi_cell_crosses(const bvxi_stack *s, uint64_t from)
{
    uint64_t const n = s->mesh.triangle_count - from;
    double box[UNCROSS_MOST][6];

    /* very many contour points in one cell: it would take too long */
    if (n == 0 || n > UNCROSS_MOST) return 0;
    const uint32_t *const t = s->mesh.triangle + 3 * from;
    for (uint64_t i = 0; i < n; i++) {
        uncross_box(s, t + 3 * i, box[i]);
        for (uint64_t k = 0; k < i; k++) {
            const double *const a = box[i], *const b = box[k];
            /* Boxes that only touch do not count: neighbours share corners. */
            if (a[0] >= b[3] || b[0] >= a[3] || a[1] >= b[4] || b[1] >= a[4] || a[2] >= b[5] || b[2] >= a[5])
                continue;
            if (uncross_pair(s, t + 3 * i, t + 3 * k)) return 1;
        }
    }
    return 0;
}

/* ---- Loops ---- */

/* The loops of one cell, followed from point to point and filled with triangles.
 *
 * Where triangles of a cell cross, its loops are filled again, some of them around a vertex inside the cell:
 * every choice for the first loops is tried, and the first one without crossings is kept. In the paper's way
 * vertices are made while loops are followed, and its triangles stay as they are. */

/* loops whose filling is chosen; triangles of one loop that as good as never cross */
enum { TRACE_CHOICES = 4, TRACE_SURE = 4 };

static bvx_status follow_ring(bvxi_trace *t, int k, const bvxi_arc *a, int back, uint32_t *count)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t const face = k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE;
    uint32_t first, end, i = p->cut[back ? a->to : a->from].ring, stop = p->cut[back ? a->from : a->to].ring;
    bvxi_ring_stretch(p, bvxi_contour_of(p, p->cut[a->from].segment), &first, &end);
    for (;;) {
        if (back) i = i == first ? end - 1 : i - 1;
        else i = i + 1 == end ? first : i + 1;
        if (i == stop) return BVX_OK;
        BVXI_TRY(bvxi_trace_add_to_loop(t, count, p->vertex + i, face));
    }
}

bvx_status bvxi_trace_fill(bvxi_trace *t, uint32_t count)
{
    uint32_t digits = t->choice; /* to the base of three */
    for (uint32_t i = 0; i < t->loop_count && i < TRACE_CHOICES; i++) digits /= 3;
    t->cone = t->loop_count < TRACE_CHOICES ? (int)(digits % 3) : 0;
    t->count = count;
    t->loop_count++;
    BVXI_TRY(bvxi_fill_loop(t));
    t->strips += (uint32_t)t->strip;
    return BVX_OK;
}

/* The lines of a body's first and last plane are what a flat cap ends at.
 * from: the loop's place after the first vertex. */
static bvx_status keep_cap_lines(bvxi_trace *t, int k, uint32_t from, uint32_t count, uint32_t last)
{
    bvxi_stack *const s = t->s;
    const bvxi_plane *const p = t->level[k].plane;

    if (s->options.caps != BVX_CAPS_FLAT || p == NULL || p != &s->plane[k == 0 ? 0 : s->plane_count - 1])
        return BVX_OK;
    for (uint32_t i = from - 1; i < count; i++) {
        uint32_t const a = t->vertex[i], b = i + 1 < count ? t->vertex[i + 1] : last;
        BVXI_TRY(BVXI_SLAB_GROW(s, s->cap_edge[k], s->cap_edge_count[k], s->cap_edge_room[k],
                                "the lines of a cap"));
        uint32_t *const e = s->cap_edge[k][s->cap_edge_count[k]++];
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
        /* Each point has one successor and is passed once; otherwise the cell does not close. */
        if (p->seen || p->next == BVXI_NONE)
            return t->s->fixed
                       ? BVX_ERR_FORMAT
                       : bvxi_fail(t->s->ctx, BVX_ERR_FORMAT,
                                   "%s: the surface does not close in the grid cell (%u, %u)", t->s->function,
                                   (uint64_t)(t->key & 0xffff), (uint64_t)(t->key >> 16));
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
    return bvxi_trace_fill(t, count);
}

/* A loop of a section that lies in the cell whole: closed by a cone. */
static bvx_status fill_inner_loop(bvxi_trace *t, int k, const bvxi_arc *a)
{
    const bvxi_plane *const p = t->level[k].plane;
    uint32_t first, end, count = 0;
    bvxi_ring_stretch(p, bvxi_contour_of(p, a->point), &first, &end);
    /* From above the loop runs the other way round. */
    for (uint32_t i = first; i < end; i++)
        BVXI_TRY(bvxi_trace_add_to_loop(t, &count, p->vertex + (k == 0 ? i : end - 1 - (i - first)),
                                        k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE));
    return bvxi_trace_fill(t, count);
}

/* ---- all of a cell ---- */

void bvxi_trace_begin_fill(bvxi_trace *t, uint32_t choice, bvxi_trace_made *made)
{
    const bvxi_stack *const s = t->s;
    t->choice = choice;
    t->loop_count = t->strips = 0;
    made->triangles = s->mesh.triangle_count;
    made->vertices = s->mesh.vertex_count;
    for (int k = 0; k < 2; k++) made->cap_edges[k] = s->cap_edge_count[k];
}

void bvxi_trace_undo_fill(bvxi_trace *t, const bvxi_trace_made *made)
{
    bvxi_stack *const s = t->s;
    s->mesh.triangle_count = made->triangles;
    s->mesh.vertex_count = made->vertices;
    for (int k = 0; k < 2; k++) s->cap_edge_count[k] = made->cap_edges[k];
}

int bvxi_trace_crosses(const bvxi_trace *t, const bvxi_trace_made *made)
{
    const bvxi_stack *const s = t->s;
    /* A single loop that is a strip, or of few triangles, is not looked at. */
    if (t->choice == 0 && t->loop_count == 1 &&
        (t->strips == 1 || s->mesh.triangle_count - made->triangles <= TRACE_SURE))
        return 0;
    return bvxi_cell_crosses(s, made->triangles);
}

static bvx_status fill_cell_loops(bvxi_trace *t, uint32_t choice, bvxi_trace_made *made)
{
    bvxi_trace_begin_fill(t, choice, made);
    for (uint32_t i = 0; i < t->point_count; i++) t->point[i].seen = 0;
    /* Loops by their lowest point, so that the order does not depend on what came before. */
    for (uint32_t i = 0; i < t->point_count; i++)
        if (!t->point[i].seen) BVXI_TRY(follow_loop(t, i));
    for (int k = 0; k < 2; k++) {
        if (t->level[k].kind != BVXI_PLANE_EXACT) continue;
        for (uint32_t i = 0; i < t->arc_count[k]; i++)
            if (t->arc[k][i].from == BVXI_NONE) BVXI_TRY(fill_inner_loop(t, k, &t->arc[k][i]));
    }
    return BVX_OK;
}

bvx_status bvxi_trace_loops(bvxi_trace *t)
{
    bvxi_trace_made made;
    uint32_t choices = 1;

    BVXI_TRY(fill_cell_loops(t, 0, &made));
    if (!bvxi_trace_crosses(t, &made)) return BVX_OK;
    if (t->s->options.slabs.crossings != BVX_CROSSINGS_PAPER)
        for (uint32_t i = 0; i < t->loop_count && i < TRACE_CHOICES; i++) choices *= 3;
    for (uint32_t i = 1; i < choices; i++) {
        bvxi_trace_undo_fill(t, &made);
        BVXI_TRY(fill_cell_loops(t, i, &made));
        if (!bvxi_trace_crosses(t, &made)) return BVX_OK;
    }
    /* None is free of crossings: the usual one stays. */
    if (choices == 1) return BVX_OK;
    bvxi_trace_undo_fill(t, &made);
    return fill_cell_loops(t, 0, &made);
}
