/* fill_loop.c - triangles inside a loop that runs over the faces of a cell.
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

static double fill_length(const double *a, const double *b)
{
    double const x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return (x * x + y * y) + z * z;
}

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
            /* A chord within one face might be an edge of the neighbour's; the last side is none. */
            if ((l->faces[i] & l->faces[j]) == 0 || gap == n - 1) {
                for (uint32_t k = i + 1; k < j; k++) {
                    double const c = t->cost[i][k] + t->cost[k][j];
                    if (!(c < best)) continue;
                    best = c;
                    t->split[i][j] = (uint8_t)k;
                }
                if (best < FILL_NEVER && gap < n - 1) best += fill_length(l->at[i], l->at[j]);
            }
            t->cost[i][j] = best;
        }
    return t->cost[0][n - 1] < FILL_NEVER;
}

static int fill_four(const bvxi_trace *l, uint32_t *first)
{
    int const even = (l->faces[0] & l->faces[2]) == 0, odd = (l->faces[1] & l->faces[3]) == 0;
    if (!even && !odd) return 0;
    *first = even && (!odd || fill_length(l->at[0], l->at[2]) <= fill_length(l->at[1], l->at[3])) ? 0 : 1;
    return 1;
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
        uint32_t const shorter = (uint32_t)(fill_length(l->at[on], l->at[b]) <=
                                            fill_length(l->at[a], l->at[beside]));
        /* no branch: which one comes next is a toss */
        uint32_t const up = ((uint32_t)(j + 1 == end) | shorter) & (uint32_t)(i + 1 < m);
        BVXI_TRY(bvxi_section_add_triangle(l->s, l->vertex[a], l->vertex[beside + (up * (on - beside))],
                                           l->vertex[b]));
        i += up;
        j += 1 - up;
        /* An inner edge within one face: the strip is taken off again, and another way is tried. */
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
                double const c = fill_length(l->at[l->before[i]], l->at[l->next[i]]);
                if (c < best) {
                    best = c;
                    ear = i;
                }
            }
            i = l->next[i];
        } while (i != from);
        /* No ear is left that may be cut: what was made is taken off again. */
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
            double const d = fill_length(l->at[i], middle);
            if (d > reach) reach = d;
        }
        reach = sqrt(reach);
        share = 0.5 * reach / (reach + sqrt(fill_length(centre, middle)));
        for (int k = 0; k < 3; k++) middle[k] += share * (centre[k] - middle[k]);
    }
    BVXI_TRY(bvxi_section_add_vertex(l->s, middle, &number));
    for (uint32_t i = 0; i < l->count; i++)
        BVXI_TRY(
            bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[i + 1 == l->count ? 0 : i + 1], number));
    return BVX_OK;
}

bvx_status bvxi_fill_loop(bvxi_trace *l)
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
        uint32_t i;
        if (fill_four(l, &i)) {
            BVXI_TRY(bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[i + 1], l->vertex[i + 2]));
            return bvxi_section_add_triangle(l->s, l->vertex[i], l->vertex[i + 2], l->vertex[(i + 3) & 3]);
        }
        return fill_by_vertex(l);
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
