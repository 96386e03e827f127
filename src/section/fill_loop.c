/* fill_loop.c - triangles inside a loop that runs over the faces of a cell.
 *
 * An inner edge whose ends lie on one face of the cell could be an edge of the neighbour's triangles too, and of two planes' at
 * once; so inner edges join different faces, and then no other cell can have them. Among the triangulations that this leaves the
 * one of least area is found by dynamic programming (short loops), or ears with the shortest inner edge are cut off one by one (long
 * ones, mostly a stretch of contour below and one above, which become a strip). Where neither ends well, a vertex inside the
 * cell is joined to the whole loop.
 *
 * Source: Klincsek. Minimal triangulations of polygonal domains. 1980 (the dynamic program). */
#include "section/section.h"

#include <math.h>

enum { FILL_EXACT = 14, FILL_MOST = 4096 };

#define FILL_NEVER 1e300

static double fill_area(const double *a, const double *b, const double *c)
{
    double const x1 = b[0] - a[0], y1 = b[1] - a[1], z1 = b[2] - a[2], x2 = c[0] - a[0], y2 = c[1] - a[1], z2 = c[2] - a[2];
    double const x = y1 * z2 - z1 * y2, y = z1 * x2 - x1 * z2, z = x1 * y2 - y1 * x2;
    return sqrt((x * x + y * y) + z * z);
}

/* ---- least area ---- */

typedef struct fill_table {
    double cost[FILL_EXACT][FILL_EXACT];
    uint8_t split[FILL_EXACT][FILL_EXACT];
} fill_table;

static bvx_status emit_table(bvxi_stack *s, const bvxi_loop_fill *l, const fill_table *t)
{
    uint8_t stack[2 * FILL_EXACT];
    uint32_t top = 0;
    stack[top++] = 0;
    stack[top++] = (uint8_t)(l->count - 1);
    while (top > 0) {
        uint8_t const j = stack[--top], i = stack[--top], k = j - i < 2 ? 0 : t->split[i][j];
        if (j - i < 2) continue;
        BVXI_TRY(bvxi_section_add_triangle(s, l->vertex[i], l->vertex[k], l->vertex[j]));
        stack[top++] = i;
        stack[top++] = k;
        stack[top++] = k;
        stack[top++] = j;
    }
    return BVX_OK;
}

static int fill_by_area(const bvxi_loop_fill *l, const double *const *at, fill_table *t)
{
    uint32_t const n = l->count;
    for (uint32_t i = 0; i + 1 < n; i++) t->cost[i][i + 1] = 0.0;
    for (uint32_t gap = 2; gap < n; gap++)
        for (uint32_t i = 0; i + gap < n; i++) {
            uint32_t const j = i + gap;
            double best = FILL_NEVER;
            if ((l->faces[i] & l->faces[j]) == 0 || gap == n - 1)
                for (uint32_t k = i + 1; k < j; k++) {
                    double const sides = t->cost[i][k] + t->cost[k][j];
                    double c;
                    if (!(sides < best)) continue;
                    c = sides + fill_area(at[i], at[k], at[j]);
                    if (c < best) {
                        best = c;
                        t->split[i][j] = (uint8_t)k;
                    }
                }
            t->cost[i][j] = best;
        }
    return t->cost[0][n - 1] < FILL_NEVER;
}

/* ---- ears ---- */

static double fill_length(const double *a, const double *b)
{
    double const x = b[0] - a[0], y = b[1] - a[1], z = b[2] - a[2];
    return (x * x + y * y) + z * z;
}

/* The corners between left, as a ring of numbers. Returns BVX_ERR_EMPTY when no ear may be cut off. */
static bvx_status fill_by_ears(bvxi_stack *s, const bvxi_loop_fill *l, const double *const *at, uint32_t *next, uint32_t *before)
{
    uint32_t const n = l->count;
    uint32_t left = n, from = 0;
    uint64_t const start = s->mesh.triangle_count;
    for (uint32_t i = 0; i < n; i++) {
        next[i] = i + 1 == n ? 0 : i + 1;
        before[i] = i == 0 ? n - 1 : i - 1;
    }
    for (; left > 3; left--) {
        double best = FILL_NEVER;
        uint32_t ear = BVXI_NONE, i = from;
        do {
            if ((l->faces[before[i]] & l->faces[next[i]]) == 0) {
                double const c = fill_length(at[before[i]], at[next[i]]);
                if (c < best) {
                    best = c;
                    ear = i;
                }
            }
            i = next[i];
        } while (i != from);
        if (ear == BVXI_NONE) {
            s->mesh.triangle_count = start;
            return BVX_ERR_EMPTY;
        }
        BVXI_TRY(bvxi_section_add_triangle(s, l->vertex[before[ear]], l->vertex[ear], l->vertex[next[ear]]));
        next[before[ear]] = next[ear];
        before[next[ear]] = before[ear];
        from = next[ear];
    }
    return bvxi_section_add_triangle(s, l->vertex[before[from]], l->vertex[from], l->vertex[next[from]]);
}

/* ---- round a vertex inside ---- */

static bvx_status fill_by_vertex(bvxi_stack *s, const bvxi_loop_fill *l, const double *const *at)
{
    double middle[3] = {0.0, 0.0, 0.0};
    uint32_t faces = 0xff, number;
    for (uint32_t i = 0; i < l->count; i++) {
        faces &= l->faces[i];
        for (int k = 0; k < 3; k++) middle[k] += at[i][k];
    }
    for (int k = 0; k < 3; k++) middle[k] /= l->count;
    if (faces != 0) { /* off that face, by less for smaller loops: the cone over a hole stays inside that of the loop round it */
        double reach = 0.0, share;
        for (uint32_t i = 0; i < l->count; i++) {
            double const d = fill_length(at[i], middle);
            if (d > reach) reach = d;
        }
        reach = sqrt(reach);
        share = 0.5 * reach / (reach + sqrt(fill_length(l->centre, middle)));
        for (int k = 0; k < 3; k++) middle[k] += share * (l->centre[k] - middle[k]);
    }
    s->report.inner_vertices++;
    BVXI_TRY(bvxi_section_add_vertex(s, middle, &number));
    for (uint32_t i = 0; i < l->count; i++)
        BVXI_TRY(bvxi_section_add_triangle(s, l->vertex[i], l->vertex[i + 1 == l->count ? 0 : i + 1], number));
    return BVX_OK;
}

bvx_status bvxi_fill_loop(bvxi_stack *s, const bvxi_loop_fill *l)
{
    bvx_status status = BVX_ERR_EMPTY;
    uint32_t common = 0xff;
    for (uint32_t i = 0; i < l->count; i++) common &= l->faces[i];
    if (l->count == 3 && common == 0) return bvxi_section_add_triangle(s, l->vertex[0], l->vertex[1], l->vertex[2]);
    for (uint32_t i = 0; i < l->count; i++) l->at[i] = s->mesh.position + 3 * (uint64_t)l->vertex[i];
    if (common != 0) return fill_by_vertex(s, l, l->at); /* flat on one face, where the neighbour has the same loop */
    if (l->count <= FILL_EXACT) {
        fill_table t;
        if (fill_by_area(l, l->at, &t)) return emit_table(s, l, &t);
    } else if (l->count <= FILL_MOST) {
        status = fill_by_ears(s, l, l->at, l->next, l->before);
    }
    return status == BVX_ERR_EMPTY ? fill_by_vertex(s, l, l->at) : status;
}
