/* uncross.c - triangles of one cell that cross each other.
 *
 * Loops are filled one by one, each with the shortest inner edges that are allowed; where a contour winds
 * inside a cell, or several loops lie in it, triangles of one may reach through those of another, or of the
 * same loop. Such cells are found here, by holding all pairs of a cell's triangles against each other. The
 * test is one in doubles: a touch within rounding may be taken for none. */
#include "section/trace.h"

enum { UNCROSS_MOST = 64 };

/* Signed volume of four places. */
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
    double a, b, c;
    /* Both ends on one side. */
    if ((sp > 0.0) == (sq > 0.0)) return 0;
    a = uncross_volume(p, q, t[0], t[1]);
    b = uncross_volume(p, q, t[1], t[2]);
    c = uncross_volume(p, q, t[2], t[0]);
    return (a > 0.0 && b > 0.0 && c > 0.0) || (a < 0.0 && b < 0.0 && c < 0.0);
}

static void uncross_box(const bvxi_stack *s, const uint32_t *t, double box[6])
{
    for (int c = 0; c < 3; c++) {
        const double *const p = bvxi_section_vertex(s, t[c]);
        for (int k = 0; k < 3; k++) {
            if (c == 0 || p[k] < box[k]) box[k] = p[k];
            if (c == 0 || p[k] > box[k + 3]) box[k + 3] = p[k];
        }
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
