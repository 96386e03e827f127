/* crossing_oracle.h - do triangles of a mesh cross or touch beyond what they share? All pairs, in whole
 * numbers.
 *
 * Coordinates are multiples of 1/scale, scale a power of two, below 2^57 in these units (2^52 serves doubles
 * in [1, 16)), so that volumes stay below 2^180 and exact.h holds them. A filter in doubles answers what is
 * far from zero. */
#ifndef CROSSING_ORACLE_H
#define CROSSING_ORACLE_H

#include "bitvox_io.h"
#include "tools/exact.h"
#include "tools/mesh_maker.h"

typedef struct crossing_mesh {
    int64_t *q; /* [Size: vertices * 3] */
    const uint32_t *t;
    uint64_t triangles;
    const char *wrong; /* NULL, or why it cannot be asked */
} crossing_mesh;

static inline crossing_mesh crossing_open(const bvx_mesh *m, double scale)
{
    crossing_mesh c = {NULL, m->triangles, m->triangle_count, NULL};

    c.q = maker_grow(NULL, (size_t)(m->vertex_count + 1) * 3 * sizeof *c.q);
    for (uint64_t i = 0; i < 3 * m->vertex_count; i++) {
        double const p = m->position_type == BVX_F32 ? (double)((const float *)m->positions)[i]
                                                     : ((const double *)m->positions)[i];
        c.q[i] = 0;
        if (!(p * scale < 144115188075855872.0 && p * scale > -144115188075855872.0))
            c.wrong = "a coordinate too large";
        else c.q[i] = (int64_t)(p * scale);
        if (c.wrong == NULL && (double)c.q[i] != p * scale) c.wrong = "a coordinate that is no multiple";
    }
    return c;
}

static inline exact_number crossing_sub(exact_number a, exact_number b)
{
    return exact_add(a, exact_mul(b, exact_of(-1)));
}

/* Sign of the volume (b-a) x (c-a) . (d-a). */
static inline int crossing_volume(const int64_t *a, const int64_t *b, const int64_t *c, const int64_t *d)
{
    int64_t u[3], v[3], w[3];
    double sum = 0, size = 0;
    exact_number total;

    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        v[k] = c[k] - a[k];
        w[k] = d[k] - a[k];
    }
    for (int k = 0; k < 3; k++) {
        int const l = (k + 1) % 3, m = (k + 2) % 3;
        double const x = (double)u[l] * (double)v[m] * (double)w[k];
        double const y = (double)u[m] * (double)v[l] * (double)w[k];
        sum += x - y;
        size += (x < 0 ? -x : x) + (y < 0 ? -y : y);
    }
    if (sum > size * 1e-14 || sum < -size * 1e-14) return (sum > 0) - (sum < 0);
    total = exact_of(0);
    for (int k = 0; k < 3; k++) {
        int const l = (k + 1) % 3, m = (k + 2) % 3;
        exact_number const minor = crossing_sub(exact_mul(exact_of(u[l]), exact_of(v[m])),
                                                exact_mul(exact_of(u[m]), exact_of(v[l])));
        total = exact_add(total, exact_mul(minor, exact_of(w[k])));
    }
    return exact_sign(total);
}

/* Sign of the area (b-a) x (c-a) seen along axis. */
static inline int crossing_area(const int64_t *a, const int64_t *b, const int64_t *c, int axis)
{
    int const l = (axis + 1) % 3, m = (axis + 2) % 3;
    return exact_sign_of_sum(b[l] - a[l], c[m] - a[m], -(b[m] - a[m]), c[l] - a[l], 0, 0);
}

/* An axis along which the triangle has area, or -1. */
static inline int crossing_axis(const int64_t *const t[3])
{
    for (int k = 0; k < 3; k++)
        if (crossing_area(t[0], t[1], t[2], k) != 0) return k;
    return -1;
}

static inline int crossing_in_triangle(const int64_t *p, const int64_t *const t[3], int axis)
{
    int const a = crossing_area(t[0], t[1], p, axis);
    int const b = crossing_area(t[1], t[2], p, axis);
    int const c = crossing_area(t[2], t[0], p, axis);
    return !((a > 0 || b > 0 || c > 0) && (a < 0 || b < 0 || c < 0));
}

/* p, on the line of a and b, lies between them? */
static inline int crossing_between(const int64_t *p, const int64_t *a, const int64_t *b, int axis)
{
    for (int k = 0; k < 3; k++)
        if (k != axis && ((p[k] < a[k] && p[k] < b[k]) || (p[k] > a[k] && p[k] > b[k]))) return 0;
    return 1;
}

static inline int crossing_segments(const int64_t *p, const int64_t *q, const int64_t *a, const int64_t *b,
                                    int axis)
{
    int const pa = crossing_area(p, q, a, axis), pb = crossing_area(p, q, b, axis);
    int const ap = crossing_area(a, b, p, axis), aq = crossing_area(a, b, q, axis);
    if (pa * pb < 0 && ap * aq < 0) return 1;
    return (pa == 0 && crossing_between(a, p, q, axis)) || (pb == 0 && crossing_between(b, p, q, axis)) ||
           (ap == 0 && crossing_between(p, a, b, axis)) || (aq == 0 && crossing_between(q, a, b, axis));
}

/* Do a closed segment and a closed triangle of area have a common point? */
static inline int crossing_segment(const int64_t *p, const int64_t *q, const int64_t *const t[3])
{
    int const sp = crossing_volume(t[0], t[1], t[2], p), sq = crossing_volume(t[0], t[1], t[2], q);
    int a, b, c, axis;

    if (sp * sq > 0) return 0;
    if (sp == 0 && sq == 0) {
        axis = crossing_axis(t);
        if (crossing_in_triangle(p, t, axis) || crossing_in_triangle(q, t, axis)) return 1;
        for (int k = 0; k < 3; k++)
            if (crossing_segments(p, q, t[k], t[(k + 1) % 3], axis)) return 1;
        return 0;
    }
    a = crossing_volume(p, q, t[0], t[1]);
    b = crossing_volume(p, q, t[1], t[2]);
    c = crossing_volume(p, q, t[2], t[0]);
    return !((a > 0 || b > 0 || c > 0) && (a < 0 || b < 0 || c < 0));
}

/* Does t lie off the plane of s, on one side of it? Then they do not meet. */
static inline int crossing_apart(const int64_t *const s[3], const int64_t *const t[3])
{
    int const first = crossing_volume(s[0], s[1], s[2], t[0]);
    return first != 0 && crossing_volume(s[0], s[1], s[2], t[1]) == first &&
           crossing_volume(s[0], s[1], s[2], t[2]) == first;
}

/* Do two triangles of area meet in more than the vertices that they share? */
static inline int crossing_pair(const int64_t *const s[3], const int64_t *const t[3])
{
    int shared = 0, one = -1, two = -1, free_one = 3, free_two = 3;

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (s[i] == t[k]) {
                shared++;
                one = i;
                two = k;
                free_one -= i;
                free_two -= k;
            }
    if (shared == 3) return 1;
    if (shared == 2) { /* they meet in more only when they lie in one plane, on one side of the shared side */
        const int64_t *const a = s[(free_one + 1) % 3], *const b = s[(free_one + 2) % 3];
        int const axis = crossing_axis(s);
        if (crossing_volume(s[0], s[1], s[2], t[free_two]) != 0) return 0;
        return crossing_area(a, b, s[free_one], axis) * crossing_area(a, b, t[free_two], axis) > 0;
    }
    if (shared == 1) /* what they share besides would reach a side that is opposite to the shared vertex */
        return crossing_segment(s[(one + 1) % 3], s[(one + 2) % 3], t) ||
               crossing_segment(t[(two + 1) % 3], t[(two + 2) % 3], s);
    if (crossing_apart(s, t) || crossing_apart(t, s)) return 0;
    for (int i = 0; i < 3; i++)
        if (crossing_segment(s[i], s[(i + 1) % 3], t) || crossing_segment(t[i], t[(i + 1) % 3], s)) return 1;
    return 0;
}

static inline void crossing_corners(const crossing_mesh *c, uint64_t n, const int64_t *t[3], int64_t low[3],
                                    int64_t high[3])
{
    for (int i = 0; i < 3; i++) {
        t[i] = c->q + 3 * (size_t)c->t[3 * n + (uint64_t)i];
        for (int a = 0; a < 3; a++) {
            if (i == 0 || t[i][a] < low[a]) low[a] = t[i][a];
            if (i == 0 || t[i][a] > high[a]) high[a] = t[i][a];
        }
    }
}

/* The number of pairs that cross, triangles without area counted too;
 * *wrong says why the mesh could not be asked. */
static inline uint64_t crossing_count(const bvx_mesh *m, double scale, const char **wrong)
{
    crossing_mesh c = crossing_open(m, scale);

    int64_t(*const boxes)[6] = maker_grow(NULL, (size_t)(c.triangles + 1) * sizeof *boxes);
    uint64_t found = 0;
    *wrong = c.wrong;
    for (uint64_t i = 0; c.wrong == NULL && i < c.triangles; i++) {
        const int64_t *s[3], *t[3];
        int64_t low[3], high[3];
        crossing_corners(&c, i, s, boxes[i], boxes[i] + 3);
        if (crossing_axis(s) < 0) found++;
        for (uint64_t k = 0; k < i; k++) {
            const int64_t *const a = boxes[i], *const b = boxes[k];
            if (a[0] > b[3] || b[0] > a[3] || a[1] > b[4] || b[1] > a[4] || a[2] > b[5] || b[2] > a[5])
                continue;
            crossing_corners(&c, k, t, low, high);
            found += (uint64_t)crossing_pair(s, t);
        }
    }
    free(c.q);
    free(boxes);
    return found;
}

#endif
