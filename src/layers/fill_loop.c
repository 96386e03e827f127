/* fill_loop.c - the loops of a cell over its faces, followed and filled with triangles.
 *
 * An inner edge whose ends lie on one face of the cell could be an edge of the neighbour's triangles too, and
 * of two planes' at once; so inner edges join different faces, and then no other cell can have them. Among
 * the triangulations that this leaves the one with the least sum of squared inner edges is found by dynamic
 * programming (short loops); a long loop of one stretch of contour below and one above becomes a strip; of
 * other long ones the ears with the shortest inner edge are cut off one by one. Where none of this ends well,
 * a vertex inside the cell is joined to the whole loop.
 *
 * Source: Klincsek. Minimal triangulations of polygonal domains. 1980 (the dynamic program). */
#include "layers/trace.h"

#include <math.h>

enum { FILL_FEW = 6, FILL_EXACT = 14, FILL_MOST = 4096, FILL_BELOW = 1, FILL_ABOVE = 2 };

#define FILL_NEVER 1e300

/* ---- shortest inner edges ---- */

typedef struct fill_table {
    double cost[FILL_EXACT][FILL_EXACT];
    uint8_t split[FILL_EXACT][FILL_EXACT];
} fill_table;

static bvx_status emit_table(const bvxi_trace *l, const fill_table *t)
{
    uint8_t stack[2 * FILL_EXACT];
    uint32_t top = 0;

    stack[top++] = 0;
    stack[top++] = (uint8_t)(l->count - 1);
    while (top > 0) {
        uint8_t const j = stack[--top], i = stack[--top], k = j - i < 2 ? 0 : t->split[i][j];
        if (j - i < 2) continue;
        BVXI_TRY(bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[k], l->vertex[j]));
        stack[top++] = i;
        stack[top++] = k;
        stack[top++] = k;
        stack[top++] = j;
    }
    return BVX_OK;
}

/* cost: of the inner edges between i and j, and of the edge i j itself. */
static int fill_by_table(const bvxi_trace *l, fill_table *t)
{
    uint32_t const n = l->count;

    for (uint32_t i = 0; i + 1 < n; i++) t->cost[i][i + 1] = 0.0;
    /* From short chords to long ones: each needs only shorter ones. */
    for (uint32_t gap = 2; gap < n; gap++)
        for (uint32_t i = 0; i + gap < n; i++) {
            uint32_t const j = i + gap;
            double best = FILL_NEVER;
            if ((l->faces[i] & l->faces[j]) == 0 || gap == n - 1) {
                for (uint32_t k = i + 1; k < j; k++) {
                    double const c = t->cost[i][k] + t->cost[k][j];
                    if (!(c < best)) continue;
                    best = c;
                    t->split[i][j] = (uint8_t)k;
                }
                if (best < FILL_NEVER && gap < n - 1) best += bvxi_vec_distance2(l->at[i], l->at[j]);
            }
            t->cost[i][j] = best;
        }
    return t->cost[0][n - 1] < FILL_NEVER;
}

/* ---- a strip ---- */

/* A loop of one stretch below and one above: their corners. Returns how many lie below, or 0. */
static uint32_t find_stretches(const bvxi_trace *l, uint32_t *below, uint32_t *above)
{
    uint32_t const n = l->count;
    uint32_t start = 0, m = 0;
    while (start < n && !((l->faces[start] & FILL_BELOW) != 0 &&
                          (l->faces[start == 0 ? n - 1 : start - 1] & FILL_ABOVE) != 0))
        start++;
    if (start == n) return 0;
    for (uint32_t k = 0, at_k = start; k < n; k++, at_k = at_k + 1 == n ? 0 : at_k + 1) {
        if ((l->faces[at_k] & FILL_BELOW) != 0 && k == m) below[m++] = at_k;
        else if ((l->faces[at_k] & FILL_ABOVE) != 0) above[n - 1 - k] = at_k; /* backwards: beside below */
        else return 0;
    }
    return m;
}

/* A strip between two stretches, always over the shorter next edge. Returns BVX_ERR_EMPTY, and makes nothing,
 * for another loop and where an edge would lie on a face. */
static bvx_status fill_as_strip(const bvxi_trace *l)
{
    uint32_t const m = find_stretches(l, l->next, l->before), end = l->count - m;
    uint64_t const start = l->s->mesh.triangle_count;

    if (m == 0) return BVX_ERR_EMPTY;
    for (uint32_t i = 0, j = 0; i + 1 < m || j + 1 < end;) {
        uint32_t const a = l->next[i], b = l->before[j];
        uint32_t const on = l->next[i + 1 < m ? i + 1 : i], beside = l->before[j + 1 < end ? j + 1 : j];
        uint32_t const shorter = (uint32_t)(bvxi_vec_distance2(l->at[on], l->at[b]) <=
                                            bvxi_vec_distance2(l->at[a], l->at[beside]));
        /* no branch: which one comes next is a toss */
        uint32_t const up = ((uint32_t)(j + 1 == end) | shorter) & (uint32_t)(i + 1 < m);
        BVXI_TRY(bvxi_section_add_triangle(l->s, l->vertex[a], l->vertex[beside + (up * (on - beside))],
                                           l->vertex[b]));
        i += up;
        j += 1 - up;
        if ((i + 1 < m || j + 1 < end) && (l->faces[l->next[i]] & l->faces[l->before[j]]) != 0) {
            l->s->mesh.triangle_count = start;
            return BVX_ERR_EMPTY;
        }
    }
    return BVX_OK;
}

/* ---- ears ---- */

/* The corners between left, as a ring of numbers. Returns BVX_ERR_EMPTY when no ear may be cut off. */
static bvx_status fill_by_ears(const bvxi_trace *l)
{
    uint32_t const n = l->count;
    uint32_t left = n, from = 0;
    uint64_t const start = l->s->mesh.triangle_count;

    for (uint32_t i = 0; i < n; i++) {
        l->next[i] = i + 1 == n ? 0 : i + 1;
        l->before[i] = i == 0 ? n - 1 : i - 1;
    }
    for (; left > 3; left--) {
        double best = FILL_NEVER;
        uint32_t ear = BVXI_NONE, i = from;
        do {
            if ((l->faces[l->before[i]] & l->faces[l->next[i]]) == 0) {
                double const c = bvxi_vec_distance2(l->at[l->before[i]], l->at[l->next[i]]);
                if (c < best) {
                    best = c;
                    ear = i;
                }
            }
            i = l->next[i];
        } while (i != from);
        if (ear == BVXI_NONE) {
            l->s->mesh.triangle_count = start;
            return BVX_ERR_EMPTY;
        }
        BVXI_TRY(bvxi_section_add_triangle(l->s, l->vertex[l->before[ear]], l->vertex[ear],
                                           l->vertex[l->next[ear]]));
        l->next[l->before[ear]] = l->next[ear];
        l->before[l->next[ear]] = l->before[ear];
        from = l->next[ear];
    }
    return bvxi_section_add_triangle(l->s, l->vertex[l->before[from]], l->vertex[from],
                                     l->vertex[l->next[from]]);
}

static bvx_status fill_by_vertex(const bvxi_trace *l)
{
    double middle[3] = {0.0, 0.0, 0.0}, centre[3], uv[2];
    uint32_t faces = 0xff, number;

    for (uint32_t i = 0; i < l->count; i++) {
        faces &= l->faces[i];
        for (int k = 0; k < 3; k++) middle[k] += l->at[i][k];
    }
    for (int k = 0; k < 3; k++) middle[k] /= l->count;
    /* The cell's middle, towards which the vertex moves where the mean lies on a face. */
    for (int k = 0; k < 2; k++)
        uv[k] = l->s->origin[k] + (l->low[k] + 0.5 * l->size) / (double)(1 << l->s->fine) * l->s->step[k];
    bvxi_section_place(l->s, uv[0], uv[1], 0.5 * (l->low_w + l->high_w), centre);
    if (l->cone == 2) {
        for (int k = 0; k < 3; k++) middle[k] += 0.5 * (centre[k] - middle[k]);
    } else if (
        faces !=
        0) { /* off that face, by less for smaller loops: the cone over a hole stays inside that of the loop round it */
        double reach = 0.0, share;
        for (uint32_t i = 0; i < l->count; i++) {
            double const d = bvxi_vec_distance2(l->at[i], middle);
            if (d > reach) reach = d;
        }
        reach = sqrt(reach);
        share = 0.5 * reach / (reach + sqrt(bvxi_vec_distance2(centre, middle)));
        for (int k = 0; k < 3; k++) middle[k] += share * (centre[k] - middle[k]);
    }
    BVXI_TRY(bvxi_section_add_vertex(l->s, middle, &number));
    for (uint32_t i = 0; i < l->count; i++)
        BVXI_TRY(
            bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[i + 1 == l->count ? 0 : i + 1], number));
    return BVX_OK;
}

/* Triangles inside the loop that vertex and faces hold, whose inner edges lie on no cell face; where there
 * are none, around a vertex inside the cell. */
static bvx_status fill_cell_loop(bvxi_trace *l)
{
    bvx_status status = BVX_ERR_EMPTY;
    uint32_t common = 0xff;

    l->strip = 0;
    for (uint32_t i = 0; i < l->count; i++) common &= l->faces[i];
    if (l->count == 3 && common == 0 && !l->cone)
        return bvxi_section_add_triangle(l->s, l->vertex[0], l->vertex[1], l->vertex[2]);
    for (uint32_t i = 0; i < l->count; i++) l->at[i] = bvxi_section_vertex(l->s, l->vertex[i]);
    /* common: flat on one face, where the neighbour has the same loop */
    if (common != 0 || l->cone) return fill_by_vertex(l);
    /* Loops of four are frequent, and have two ways only. */
    if (l->count == 4) {
        int const even = (l->faces[0] & l->faces[2]) == 0, odd = (l->faces[1] & l->faces[3]) == 0;
        int const i = !even || (odd && bvxi_vec_distance2(l->at[0], l->at[2]) >
                                           bvxi_vec_distance2(l->at[1], l->at[3]));
        if (!even && !odd) return fill_by_vertex(l);
        BVXI_TRY(bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[i + 1], l->vertex[i + 2]));
        return bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[i + 2], l->vertex[(i + 3) & 3]);
    }
    if (l->count > FILL_FEW) {
        status = fill_as_strip(l);
        l->strip = status == BVX_OK;
        if (status != BVX_ERR_EMPTY) return status;
    }
    if (l->count <= FILL_EXACT) {
        fill_table t;
        if (fill_by_table(l, &t)) return emit_table(l, &t);
    } else if (l->count <= FILL_MOST) {
        status = fill_by_ears(l);
    }
    return status == BVX_ERR_EMPTY ? fill_by_vertex(l) : status;
}

/* ---- triangles that cross ---- */

/* Loops are filled one by one, each with the shortest inner edges that are allowed; where a contour winds
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

/* ---- loops ---- */

/* Where triangles of a cell cross, its loops are filled again, some of them around a vertex inside the cell:
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
    BVXI_TRY(fill_cell_loop(t));
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
    uint64_t const n = s->mesh.triangle_count - made->triangles;
    const uint32_t *const corner = s->mesh.triangle + 3 * made->triangles;
    double box[UNCROSS_MOST][6];

    /* very many contour points in one cell: it would take too long */
    for (uint64_t i = 0; i < n && n <= UNCROSS_MOST; i++) {
        for (int c = 0; c < 3; c++) {
            const double *const p = bvxi_section_vertex(s, corner[3 * i + (uint64_t)c]);
            for (int k = 0; k < 3 && c == 0; k++) box[i][k] = box[i][k + 3] = p[k];
            bvxi_widen(box[i], box[i] + 3, p, 3);
        }
        for (uint64_t k = 0; k < i; k++) {
            const double *const a = box[i], *const b = box[k];
            /* Boxes that only touch do not count: neighbours share corners. */
            if (a[0] >= b[3] || b[0] >= a[3] || a[1] >= b[4] || b[1] >= a[4] || a[2] >= b[5] || b[2] >= a[5])
                continue;
            if (uncross_pair(s, corner + 3 * i, corner + 3 * k)) return 1;
        }
    }
    return 0;
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
        for (uint32_t a = 0; a < t->arc_count[k]; a++) {
            const bvxi_plane *const p = t->level[k].plane;
            uint32_t first, end, count = 0;

            /* A loop of a section that lies in the cell whole is closed by a cone. */
            if (t->arc[k][a].from != BVXI_NONE) continue;
            bvxi_ring_stretch(p, bvxi_contour_of(p, t->arc[k][a].point), &first, &end);
            for (uint32_t i = first; i < end; i++)
                BVXI_TRY(bvxi_trace_add_to_loop(t, &count, p->vertex + (k == 0 ? i : end - 1 - (i - first)),
                                                k == 0 ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE));
            BVXI_TRY(bvxi_trace_fill(t, count));
        }
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
