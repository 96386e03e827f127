/* sheet.c - the solid angle of the sheet over a mesh's holes.
 *
 * Sources: Van Oosterom, Strackee. The Solid Angle of a Plane Triangle. 1983; Barill, Dickson, Schmidt, Levin, Jacobson. Fast
 * Winding Numbers for Soups and Clouds. 2018 (far parts as dipoles); Jacobson, Kavan, Sorkine-Hornung. Robust Inside-Outside
 * Segmentation using Generalized Winding Numbers. 2013 (what lies behind a hole follows from its edge alone).
 *
 * A part of the sheet that is far off counts as a dipole at the middle of its ball. With area A, radius r, distance d the error
 * is below A r / (2 pi (d - r)^3) turns; parts are opened until the sum of that leaves no doubt, at last all of them.
 * Moving along by t the angle changes, but for whole turns where the sheet is crossed, by no more than t times the sum of
 * length / (4 pi (d - t)^2) over the edge of its near part and of A / (2 pi (d - r - t)^3) over its far parts: so far a row can be
 * passed without asking again.
 * On which side of a triangle a centre lies is decided in integers, ties as everywhere (cover.h), as crossings are. */
#include "voxelize/sheet.h"
#include "core/angle.h"

#include <math.h>

/* Parts are opened until each is off by less; the last opens all. */
static const double sheet_near[3] = {1e-2, 1e-4, -1};
#define SHEET_ROUNDING 1e-8

/* What one question gathers. Angles of near triangles are summed as a product of complex numbers and the times that it went
 * round, those of far parts as they are. */
typedef struct sheet_sum {
    double re, im; /* of the angle of half a turn a turn */
    int32_t rounds, factors;
    double turns, error;
    double change; /* turns a unit of way, at the place itself */
    double least2; /* square of the least d */
    double near;   /* parts are opened until their error is below */
} sheet_sum;

/* Add the angle of (re, im), which lies between -pi and pi; up: it counts as positive, also where im is 0. */
static inline void turn_by(sheet_sum *sum, double re, double im, int up)
{
    double const x = sum->re * re - sum->im * im;
    double y = sum->re * im + sum->im * re;
    if (im == 0 && re < 0) { /* half a turn: a hair less, so that the sign does not get lost */
        double const hair = 1e-30 * re * sum->re;
        y += up ? -hair : hair;
    }
    if (up && sum->im >= 0 && y < 0) sum->rounds++;
    if (!up && sum->im < 0 && y >= 0) sum->rounds--;
    sum->re = x;
    sum->im = y;
    if (++sum->factors == 8) { /* a factor is the cube of a distance */
        double const far = x < 0 ? -x : x, high = y < 0 ? -y : y, most = far > high ? far : high;
        sum->factors = 0;
        if (most > 0) {
            sum->re = x / most;
            sum->im = y / most;
        }
    }
}

/* Add one triangle: half its solid angle, positive on the side away from its normal, as it is for the faces of a closed body
 * from inside. */
static void add_triangle(const bvxi_sheet *s, const uint64_t corner[3], const int64_t p[3], const double at[3], sheet_sum *sum)
{
    double v[3][3], l[3], det, den, most;
    int up;
    for (int i = 0; i < 3; i++) {
        const double *const q = bvxi_sheet_point(s, corner[i]);
        for (int a = 0; a < 3; a++) v[i][a] = q[a] - at[a];
        l[i] = bvxi_sheet_length(v[i]);
    }
    det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) + v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
          v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    den = l[0] * l[1] * l[2] + (v[0][0] * v[1][0] + v[0][1] * v[1][1] + v[0][2] * v[1][2]) * l[2] +
          (v[1][0] * v[2][0] + v[1][1] * v[2][1] + v[1][2] * v[2][2]) * l[0] +
          (v[2][0] * v[0][0] + v[2][1] * v[0][1] + v[2][2] * v[0][2]) * l[1];
    most = 1e-10 * l[0] * l[1] * l[2];
    up = det > 0;
    if (BVXI_UNLIKELY(det <= most && det >= -most && den <= most)) {
        const int32_t *q[3];
        for (int i = 0; i < 3; i++) q[i] = s->xyz + 3 * (uint64_t)s->holes->vertex[corner[i]];
        up = bvxi_touching_angle(q, p, (const double(*)[3])v, det, &den, &det);
    }
    turn_by(sum, den, det, up);
}

/* The segment from point i to j is part of the edge of what was opened. */
static void add_edge_change(const bvxi_sheet *s, uint64_t i, uint64_t j, const double at[3], sheet_sum *sum)
{
    const double *const a = bvxi_sheet_point(s, i), *const b = bvxi_sheet_point(s, j);
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double w[3] = {at[0] - a[0], at[1] - a[1], at[2] - a[2]};
    double const uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    double t = u[0] * w[0] + u[1] * w[1] + u[2] * w[2], d2;
    t = t <= 0 || uu == 0 ? 0 : t >= uu ? 1 : t / uu;
    for (int k = 0; k < 3; k++) w[k] -= t * u[k];
    d2 = w[0] * w[0] + w[1] * w[1] + w[2] * w[2];
    if (d2 < sum->least2) sum->least2 = d2;
    if (d2 > 0) sum->change += sqrt(uu) / (4 * BVXI_PI * d2);
}

/* 1 when a part was far enough to be taken as a whole, whole loops or points i .. j of one. Its change: that of its own edge,
 * which leaves the rest of the sheet without one there; or that of all of it, and the rest has an edge from i to j, unless there
 * is no rest. */
static int add_far_part(const bvxi_sheet_node *n, int whole, const double at[3], sheet_sum *sum)
{
    double const r[3] = {n->centre[0] - at[0], n->centre[1] - at[1], n->centre[2] - at[2]};
    double const d2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2], d = sqrt(d2), gap = d - n->radius;
    double error, by_edge, by_area;
    if (gap <= n->radius) return 0;
    error = n->area * n->radius / (2 * BVXI_PI * gap * gap * gap);
    if (error > sum->near) return 0;
    sum->error += error;
    sum->turns += (r[0] * n->normal[0] + r[1] * n->normal[1] + r[2] * n->normal[2]) / (4 * BVXI_PI * d2 * d);
    by_edge = n->length / (4 * BVXI_PI * gap * gap);
    by_area = n->area / (2 * BVXI_PI * gap * gap * gap);
    if (!whole) by_area += n->chord / (4 * BVXI_PI * gap * gap);
    sum->change += !whole && by_edge < by_area ? by_edge : by_area;
    if (gap * gap < sum->least2) sum->least2 = gap * gap;
    return 1;
}

static void add_loop(const bvxi_sheet *s, uint64_t begin, uint64_t last, const int64_t p[3], const double at[3], sheet_sum *sum)
{
    bvxi_sheet_walk w;
    uint64_t i, j;
    add_edge_change(s, last, begin, at, sum);
    w.count = 0;
    bvxi_sheet_push(&w, begin, last);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        uint64_t const corner[3] = {i, m, j};
        if (j - i < 2) {
            add_edge_change(s, i, j, at, sum);
            continue;
        }
        if (j - i > 2 && (i != begin || j != last) && add_far_part(&s->node[m], 0, at, sum)) continue;
        add_triangle(s, corner, p, at, sum);
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
}

static void add_sheet(const bvxi_sheet *s, const int64_t p[3], double near, sheet_sum *sum)
{
    bvxi_sheet_walk w;
    double at[3];
    uint64_t i, j;
    for (int a = 0; a < 3; a++) at[a] = (double)p[a] * s->scale[a];
    sum->turns = sum->change = sum->im = 0;
    sum->re = 1;
    sum->rounds = sum->factors = 0;
    sum->error = SHEET_ROUNDING;
    sum->least2 = 1e60;
    sum->near = near;
    w.count = 0;
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        if (add_far_part(bvxi_sheet_group(s, i, j), 1, at, sum)) continue;
        if (j - i < 2) {
            add_loop(s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, p, at, sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    /* the product's angle is half the solid angle: 2 pi of it is a turn of 4 pi */
    sum->turns += (sum->im < 0 ? -bvxi_angle(sum->re, -sum->im) : bvxi_angle(sum->re, sum->im)) / (2 * BVXI_PI) + sum->rounds;
}

/* A way t with t * change / (1 - t / least)^3 <= margin: the root of the same with (1 - 1.5 t / least)^2, which is less. */
static double safe_way(const sheet_sum *sum, double margin)
{
    double const reach = sqrt(sum->least2) / 1.5, b = 1 + 0.5 * reach * sum->change / margin, c = b * b - 1;
    return reach / (b + sqrt(c > 0 ? c : 0));
}

/* Whole voxels along x in which the angle cannot change by margin. */
static int32_t safe_voxels(const bvxi_sheet *s, const sheet_sum *sum, double margin)
{
    double way;
    if (margin <= 0 || sum->least2 <= 0) return 0;
    way = safe_way(sum, margin) * (1 - 1e-9) / s->step[0];
    return way < 1073741824.0 ? (int32_t)way : 1073741824;
}

bvxi_sheet_answer bvxi_sheet_turns(const bvxi_sheet *s, int32_t x, int32_t y, int32_t z, int32_t want_clear)
{
    int64_t const step = (int64_t)1 << s->fraction_bits, half = step / 2;
    int64_t const p[3] = {x * step + half, y * step + half, z * step + half};
    bvxi_sheet_answer answer;
    sheet_sum sum;
    double whole = 0, off = 0, margin = 0;
    for (int level = 0; level < 3 && margin <= 0; level++) {
        double from_quarter;
        add_sheet(s, p, sheet_near[level], &sum);
        whole = floor(sum.turns + 0.5);
        off = sum.turns - whole; /* -1/2 .. 1/2 */
        off = off < 0 ? -off : off;
        from_quarter = off < 0.25 ? 0.25 - off : off - 0.25;
        margin = 0.5 - off;
        if (want_clear && from_quarter < margin) margin = from_quarter;
        margin -= sum.error;
    }
    answer.odd = floor(0.5 * whole) * 2 != whole;
    answer.clear = want_clear && off < 0.25;
    answer.same = safe_voxels(s, &sum, margin);
    return answer;
}
