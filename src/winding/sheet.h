/* sheet.h - the solid angle of a sheet over the holes of a mesh: nodes that stand for far parts, the sums at
 * one place, and for very many holes polynomials of 1 / distance. Not installed. */
#ifndef BVXI_SHEET_H
#define BVXI_SHEET_H

#include "core/vec3.h"
#include "winding/holes.h"

#include <math.h>

/* ---- How much of all directions a sheet over the holes of a mesh covers ---- */

/* What the sheet over points i .. j of a loop is from far off; kept for the
 * point halfway. [Units: the largest spacing] */
typedef struct bvxi_sheet_node {
    double centre[3], radius; /* a ball that holds all points i .. j */
    double normal[3];         /* half the cross products: area times direction */
    double area;              /* of its triangles, each by itself */
} bvxi_sheet_node;

typedef struct bvxi_sheet_tree bvxi_sheet_tree;

typedef struct bvxi_sheet {
    const bvxi_holes *holes; /* what is summed: strips, or the mesh's own */
    bvxi_holes strips;       /* hole_strips.c; none: no loops */
    const int32_t *xyz;      /* snapped, in the order x y z */
    double *point;           /* x, y, z of each [Size: holes->points * 3] [Units: the largest spacing] */
    bvxi_sheet_node *node;   /* [Size: holes->points] */
    uint32_t *order;         /* loops, neighbours near each other [Size: holes->loops] */
    bvxi_sheet_node *group;  /* of the loops order[i] .. order[j - 1], at i + (j - i) / 2 */
    bvxi_sheet_tree *tree;   /* where there are very many loops, else NULL (turns.h) */
    double scale[3];         /* fixed point to these units */
    double step[3];          /* one voxel */
    int32_t fraction_bits;
    int32_t fast; /* 1: four places at once */
} bvxi_sheet;

static inline const double *bvxi_sheet_point(const bvxi_sheet *s, uint64_t i)
{
    return s->point + 3 * i;
}

static inline uint64_t bvxi_loop_begin(const bvxi_holes *holes, uint32_t loop)
{
    return loop == 0 ? 0 : holes->loop_end[loop - 1];
}

/* Half the cross product of b - a and c - a. */
static inline void bvxi_sheet_normal(const double a[3], const double b[3], const double c[3], double n[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    n[0] = 0.5 * (u[1] * v[2] - u[2] * v[1]);
    n[1] = 0.5 * (u[2] * v[0] - u[0] * v[2]);
    n[2] = 0.5 * (u[0] * v[1] - u[1] * v[0]);
}

static inline double bvxi_sheet_distance(const double a[3], const double b[3])
{
    return sqrt(bvxi_vec_distance2(a, b));
}

/* A ball about the middle of the box of points begin .. end - 1, or of those that corner names; its radius. */
static inline double bvxi_sheet_enclose(const bvxi_sheet *s, const uint32_t *corner, uint64_t begin,
                                        uint64_t end, double centre[3])
{
    double low[3], high[3], radius = 0;

    /* The box gives a centre; the farthest point gives the radius. */
    memcpy(low, bvxi_sheet_point(s, corner != NULL ? corner[begin] : begin), sizeof low);
    memcpy(high, low, sizeof high);
    for (uint64_t k = begin + 1; k < end; k++)
        bvxi_widen(low, high, bvxi_sheet_point(s, corner != NULL ? corner[k] : k), 3);
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * (low[a] + high[a]);
    for (uint64_t k = begin; k < end; k++) {
        double const d = bvxi_sheet_distance(centre, bvxi_sheet_point(s, corner != NULL ? corner[k] : k));
        if (d > radius) radius = d;
    }
    return radius * (1.0 + 1e-12); /* beyond what rounding takes */
}

/* The ball around two balls touches both at their far sides; one may hold the other. */
static inline double bvxi_sheet_join_balls(const double a[3], double radius_a, const double b[3],
                                           double radius_b, double centre[3])
{
    double const d = bvxi_sheet_distance(a, b), radius = 0.5 * (radius_a + radius_b + d);
    double const t = d > 0 ? (radius - radius_a) / d : 0; /* on the way from a to b */
    double most = radius > radius_a ? radius : radius_a;
    for (int i = 0; i < 3; i++) centre[i] = a[i] + (t < 0 ? 0 : t > 1 ? 1 : t) * (b[i] - a[i]);
    if (most < radius_b) most = radius_b;
    return most * (1.0 + 1e-12);
}

/* What loops order[i] .. order[j - 1] are from far off. */
static inline const bvxi_sheet_node *bvxi_sheet_group(const bvxi_sheet *s, uint64_t i, uint64_t j)
{
    if (j - i > 1) return &s->group[i + (j - i) / 2];
    uint64_t begin = bvxi_loop_begin(s->holes, s->order[i]);
    return &s->node[begin + (s->holes->loop_end[s->order[i]] - 1 - begin) / 2];
}

/* hole_strips.c: the loops parted anew into strips along cracks, scale as in a sheet; no loops where there are few
 * cracks. Scratch: 24 bytes a point, then 28. */
bvx_status bvxi_holes_strips(bvx_context *ctx, const bvxi_holes *holes, const bvxi_snapped *snapped,
                             const double scale[3], bvxi_holes *strips);

/* sheet_nodes.c. Scratch: 88 bytes a point, 76 a loop; with strips of these. The sheet must not be moved. */
bvx_status bvxi_sheet_open(bvx_context *ctx, const bvxi_holes *holes, const bvxi_snapped *snapped,
                           const bvx_lattice *lattice, bvxi_sheet *sheet);
void bvxi_sheet_close(bvx_context *ctx, bvxi_sheet *sheet);

/* touching_angle.c: half the solid angle of triangle q at the displaced centre p, as that of (re, im), where
 * doubles cannot decide: in its plane or nearly so. v: the corners as seen from p; det, re, im: what doubles
 * have, det also for im. Returns 1 where p lies on the side away from its normal, where the angle is
 * positive. */
int bvxi_touching_angle(const int32_t *const q[3], const int64_t p[3], const double v[3][3], double det,
                        double *re, double *im);

/* The sheet's solid angle at the place p of the lattice, as from there displaced, in turns (a closed sheet
 * has 1 inside).
 * [Units of p: lattice fixed point] Parts whose error is below near are taken as wholes; near < 0: none,
 * right to 1e-8. */
double bvxi_sheet_angle(const bvxi_sheet *sheet, const int64_t p[3], double near);

typedef struct bvxi_sheet_answer {
    int32_t whole; /* the nearest whole number */
    int32_t tie;   /* not 0: the angle is a half from whole to 1e-8; 1 above it, -1 below */
    int32_t clear; /* 1: it is nearer than a quarter; right only when requested */
} bvxi_sheet_answer;

bvxi_sheet_answer bvxi_sheet_turns(const bvxi_sheet *sheet, const int64_t p[3], int32_t want_clear);

#define BVXI_SHEET_ROUNDING 1e-8
#define BVXI_SHEET_NO_BOUND 1e30

/* The angle around a place: at p + h, |h| <= reach, it is turns + gradient h + what the near edges sweep on
 * the way, to rest + bend (|h| / reach)^2, and whole numbers where the way crosses the near triangles.
 * [Units: turns; lengths: the largest spacing] */
enum { BVXI_LOOK_EDGES = 16, BVXI_LOOK_TRIANGLES = 8 };

/* A point of a loop, as seen from a place. */
typedef struct bvxi_seen_point {
    double v[3], length;
} bvxi_seen_point;

typedef struct bvxi_near_edge {
    bvxi_seen_point a, b;
    double n[3], ab; /* a x b, a . b */
} bvxi_near_edge;

typedef struct bvxi_near_triangle {
    bvxi_seen_point p[3];
    double n[3], det; /* twice its area times direction; six times the volume that it has with the place */
} bvxi_near_triangle;

typedef struct bvxi_sheet_look {
    double turns, gradient[3], rest, bend;
    double edge_gradient[3], edge_bend; /* the near edges as linear too, where they allow it */
    int32_t edges;
    int32_t triangles; /* that may lie within reach; BVXI_LOOK_TRIANGLES + 1: too many to be told */
    bvxi_near_edge edge[BVXI_LOOK_EDGES];
    bvxi_near_triangle triangle[BVXI_LOOK_TRIANGLES];
} bvxi_sheet_look;

/* edge_rest: edges whose share of rest is larger are left to look->edge, as far as there is room. */
void bvxi_sheet_around(const bvxi_sheet *sheet, const int64_t p[3], double reach, double near,
                       double edge_rest, bvxi_sheet_look *look);

/* The same for four places, some of which may be one. Angles have the same digits, near >= 0;
 * around the places, with one reach, what is reported is as right in others. */
void bvxi_sheet_angles_four(const bvxi_sheet *sheet, const int64_t p[4][3], double near, double turns[4]);
void bvxi_sheet_around_four(const bvxi_sheet *sheet, const int64_t p[4][3], double reach, double near,
                            double edge_rest, bvxi_sheet_look look[4]);
void bvxi_sheet_turns_four(const bvxi_sheet *sheet, const int64_t p[4][3], int32_t want_clear,
                           bvxi_sheet_answer answer[4]);

/* ---- Polynomials in x ---- */

/* Source: Greengard, Rokhlin. A Fast Algorithm for Particle Simulations. 1987, with Taylor's series in place
 * of spherical harmonics as in Duan, Krasny. An Adaptive Treecode for Computing Nonbonded Potential Energy in
 * Classical Molecular Systems. 2001.
 *
 * A part of area vectors a at c + s has at p + h, R = c - p, the turns -1/(4 pi) sum a . grad 1/|R + s - h|.
 * With moments m[i] = sum a . grad s^i / i! and D[i] the i-th derivative of 1/|R| (i of three numbers, i!
 * their factorials' product) that is sum c[k] h^k / k!, c[k] = -(-1)^|k| / (4 pi) sum m[i] D[i + k]. What
 * lies beyond degree n of both together is below A / (4 pi d^2) q^n (n + 1 - n q) / (1 - q)^2 for area A
 * within r of c, |h| <= t, q = (r + t) / d < 1: the term of degree n is n! (v . grad)^n / |R| with |v| <= r +
 * t, at most |v|^n / d^(n + 1), and the same bound holds for each of its polar forms. */

/* terms to the order; to one less */
enum { BVXI_SERIES_ORDER = 5, BVXI_SERIES_TERMS = 56, BVXI_SERIES_LOCAL = 35 };

/* The terms' numbers: by degree, then as they come. */
typedef struct bvxi_series_table {
    uint8_t power[BVXI_SERIES_TERMS][3];
    uint8_t sum[BVXI_SERIES_TERMS][BVXI_SERIES_TERMS]; /* where the degrees' sum is at most the order */
    uint8_t axis[BVXI_SERIES_TERMS];                   /* the first that the term has */
    uint8_t less[BVXI_SERIES_TERMS][3];                /* the term with one less of each axis, if it has it */
    uint8_t end[BVXI_SERIES_ORDER + 1];                /* by degree: behind its last term */
    int32_t fast;                                      /* 1: vectors of the processor */
} bvxi_series_table;

void bvxi_series_open(int32_t fast, bvxi_series_table *t);

/* value[i] = v^i / i!, terms of them. */
void bvxi_series_powers(const bvxi_series_table *t, const double v[3], int32_t terms, double *value);

/* Moments about c of the part that has m about c + v are added to sum. */
void bvxi_series_move_moments(const bvxi_series_table *t, const double *m, const double v[3], double *sum);

/* The local series about p + v of what has c about p. */
void bvxi_series_move_local(const bvxi_series_table *t, const double *c, const double v[3], double *moved);

/* Up to four parts that are added together; way[a][i]: how far part i is along axis a. */
typedef struct bvxi_series_parts {
    int32_t count;
    const double *moment[4];
    double way[3][4];
} bvxi_series_parts;

/* Add to the first locals terms of series c what the parts do, one after the other, and take them all out. */
void bvxi_series_add(const bvxi_series_table *t, bvxi_series_parts *parts, int32_t locals, double *c);

/* One part more; the terms get those of before when four would be too many. */
static inline void bvxi_series_put(const bvxi_series_table *t, const double *moment, const double r[3],
                                   int32_t locals, bvxi_series_parts *parts, double *c)
{
    if (parts->count == 4) bvxi_series_add(t, parts, locals, c);
    for (int a = 0; a < 3; a++) parts->way[a][parts->count] = r[a];
    parts->moment[parts->count++] = moment;
}

/* The bound above but for the area, A = 1. */
static inline double bvxi_series_rest(double d2, double q)
{
    double power = 1;
    for (int i = 0; i < BVXI_SERIES_ORDER; i++) power *= q;
    return power * (BVXI_SERIES_ORDER + 1 - BVXI_SERIES_ORDER * q) /
           (12.566370614359172 * d2 * (1 - q) * (1 - q));
}

#endif
