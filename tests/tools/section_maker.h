/* section_maker.h - stacks of contours for tests, by + - * / and sqrt
 * only, so that they are the same everywhere. */
#ifndef SECTION_MAKER_H
#define SECTION_MAKER_H

#include "bitvox_io.h"
#include "tools/mesh_maker.h"

#include <math.h>
#include <string.h>

enum { STACK_POINTS = 60000, STACK_LOOPS = 2000, STACK_SECTIONS = 1000 };

typedef struct section_maker {
    double point[3 * STACK_POINTS], position[STACK_SECTIONS], normal[3 * STACK_SECTIONS];
    bvx_section_loop loop[STACK_LOOPS];
    bvx_sections s;
} section_maker;

static inline void stack_clear(section_maker *m)
{
    memset(&m->s, 0, sizeof m->s);
    m->s.points = m->point;
    m->s.loops = m->loop;
    m->s.positions = m->position;
    m->s.normal[2] = 1.0;
}

static inline uint32_t stack_section(section_maker *m, double position)
{
    m->position[m->s.section_count] = position;
    return (uint32_t)m->s.section_count++;
}

static inline void stack_loop(section_maker *m, uint32_t section)
{
    bvx_section_loop *const l = &m->loop[m->s.loop_count++];
    memset(l, 0, sizeof *l);
    l->first_point = m->s.point_count;
    l->section = section;
    l->label = 1;
}

/* To the last loop, on its plane. */
static inline void stack_point(section_maker *m, double x, double y)
{
    bvx_section_loop *const l = &m->loop[m->s.loop_count - 1];
    double *const p = m->point + 3 * m->s.point_count++;
    p[0] = x;
    p[1] = y;
    p[2] = m->position[l->section];
    l->point_count++;
}

/* The unit circle at a turn from 0 to 1: quarters by the rational parametrization. */
static inline void stack_circle(double turn, double *x, double *y)
{
    int const quarter = (int)(turn * 4.0) & 3;
    double const t = turn * 4.0 - (int)(turn * 4.0);
    /* nearly even steps of the angle */
    double const s = t / (t + (1.0 - t) * (1.0 + 0.4142135623730951 * t));
    double const c = (1.0 - s * s) / (1.0 + s * s), d = 2.0 * s / (1.0 + s * s);
    *x = quarter == 0 ? c : quarter == 1 ? -d : quarter == 2 ? -c : d;
    *y = quarter == 0 ? d : quarter == 1 ? c : quarter == 2 ? -d : -c;
}

/* A loop of n points around a centre, counter-clockwise or not; wave is the
 * share of the radius by which it goes in and out. */
static inline void stack_round(section_maker *m, uint32_t section, double cx, double cy, double rx, double ry,
                               int n, double wave, double phase, int clockwise)
{
    stack_loop(m, section);
    for (int i = 0; i < n; i++) {
        double const turn = clockwise ? 1.0 - (i + 1.0) / n : (double)i / n;
        double const r = 1.0 + wave * (0.5 * maker_wave(3.0 * turn + phase) +
                                       0.3 * maker_wave(7.0 * turn + 2.0 * phase));
        double x, y;
        stack_circle(turn, &x, &y);
        stack_point(m, cx + rx * r * x, cy + ry * r * y);
    }
}

/* ---- planes that are not parallel ---- */

static inline void stack_oblique(section_maker *m)
{
    stack_clear(m);
    m->s.normals = m->normal;
}

/* A plane n . x = position |n|. */
static inline uint32_t stack_plane(section_maker *m, double nx, double ny, double nz, double position)
{
    double *const n = m->normal + 3 * m->s.section_count;
    n[0] = nx;
    n[1] = ny;
    n[2] = nz;
    return stack_section(m, position);
}

/* One of any direction: the normal comes from a cube, as far out as is asked for. */
static inline uint32_t stack_any_plane(section_maker *m, uint64_t *seed, double most)
{
    double n[3], position;
    do {
        for (int k = 0; k < 3; k++) n[k] = maker_between(seed, -1.0, 1.0, 1000);
    } while (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] < 0.1);
    position = maker_between(seed, -most, most, 1000);
    return stack_plane(m, n[0], n[1], n[2], position);
}

/* The circle that a ball has on a plane, as n points; 0: it has none. */
static inline int stack_ball_cut(section_maker *m, uint32_t section, double cx, double cy, double cz,
                                 double r, int n)
{
    const double *const given = m->normal + 3 * (uint64_t)section;
    double const length = sqrt(given[0] * given[0] + given[1] * given[1] + given[2] * given[2]);
    double const w[3] = {given[0] / length, given[1] / length, given[2] / length};
    double const far = m->position[section] - (w[0] * cx + w[1] * cy + w[2] * cz);
    double const square = r * r - far * far;
    double const c[3] = {cx + far * w[0], cy + far * w[1], cz + far * w[2]};
    double u[3] = {w[0] * w[0] < 0.5, w[0] * w[0] >= 0.5, 0.0}, v[3], dot, size;

    if (square <= 1e-6 * r * r) return 0;
    dot = u[0] * w[0] + u[1] * w[1];
    for (int k = 0; k < 3; k++) u[k] -= dot * w[k];
    size = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int k = 0; k < 3; k++) u[k] /= size;
    for (int k = 0; k < 3; k++) v[k] = w[(k + 1) % 3] * u[(k + 2) % 3] - w[(k + 2) % 3] * u[(k + 1) % 3];
    stack_loop(m, section);
    for (int i = 0; i < n; i++) {
        double *const p = m->point + 3 * m->s.point_count++;
        double x, y;
        stack_circle((double)i / n, &x, &y);
        for (int k = 0; k < 3; k++) p[k] = c[k] + sqrt(square) * (x * u[k] + y * v[k]);
        m->loop[m->s.loop_count - 1].point_count++;
    }
    return 1;
}

/* Two to five sections of up to four bodies with holes and islands in them, some touching only in part. */
static inline void stack_random(section_maker *m, uint64_t *seed)
{
    int const sections = 2 + maker_below(seed, 4);
    double position = -1.0;

    stack_clear(m);
    for (int k = 0; k < sections; k++) {
        uint32_t const section = stack_section(m, position);
        int const bodies = k > 0 && k + 1 < sections && maker_below(seed, 20) == 0 ? 0
                                                                                   : 1 + maker_below(seed, 4);
        position += maker_between(seed, 0.2, 1.4, 1000);
        for (int j = 0; j < bodies; j++) {
            /* one draw a statement: the order in which arguments are evaluated is the compiler's */
            double const shift_x = maker_between(seed, 0.0, 0.4, 1000), x = 2.6 * (j & 1) + shift_x;
            double const shift_y = maker_between(seed, 0.0, 0.4, 1000), y = 2.6 * (j >> 1) + shift_y;
            double const r = maker_between(seed, 0.2, 1.05, 1000);
            double const wave = maker_between(seed, 0.0, 0.3, 1000);
            double const phase = maker_between(seed, 0.0, 1.0, 1000);
            int const n = 4 * (1 + maker_below(seed, 12));
            int const hole = 4 * (1 + maker_below(seed, 5));
            int const island = 4 + maker_below(seed, 5);
            int const depth = maker_below(seed, 10); /* 0 to 5: no hole; 6, 7: a hole; 8, 9: and an island */
            int const turns = maker_below(seed, 8);
            stack_round(m, section, x, y, r, r, n, wave, phase, turns & 1);
            if (depth > 5) stack_round(m, section, x, y, 0.35 * r, 0.3 * r, hole, 0.2, 0.3, turns >> 1 & 1);
            if (depth > 7) stack_round(m, section, x, y, 0.12 * r, 0.1 * r, island, 0.0, 0.0, turns >> 2);
        }
    }
}

/* The winding number of a body round a place: the plain sum of solid angles. */
static inline double stack_winding(const bvx_mesh *m, const double at[3])
{
    const double *const p = m->positions;
    double sum = 0.0;

    for (uint64_t t = 0; t < m->triangle_count; t++) {
        double v[3][3], l[3], det, dots;
        for (int k = 0; k < 3; k++) {
            for (int x = 0; x < 3; x++)
                v[k][x] = p[3 * (uint64_t)m->triangles[3 * t + (uint64_t)k] + (uint64_t)x] - at[x];
            l[k] = sqrt(v[k][0] * v[k][0] + v[k][1] * v[k][1] + v[k][2] * v[k][2]);
        }
        det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
              v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
              v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        dots = l[0] * l[1] * l[2];
        for (int k = 0; k < 3; k++) {
            const double *const a = v[(k + 1) % 3], *const b = v[(k + 2) % 3];
            dots += (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) * l[k];
        }
        sum += atan2(det, dots);
    }
    return sum / (2.0 * acos(-1.0));
}

#endif
