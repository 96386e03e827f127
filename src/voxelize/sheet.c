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
#include "mesh/radix.h"

#include <math.h>

/* Parts are opened until each is off by less; the last opens all. */
static const double sheet_near[3] = {1e-2, 1e-4, -1};
#define SHEET_ROUNDING 1e-8

/* ---- Nodes ---- */

static inline const double *sheet_point(const bvxi_sheet *s, uint64_t i)
{
    return s->point + 3 * i;
}

static double sheet_length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

/* Half the cross product of b - a and c - a. */
static void sheet_normal(const double a[3], const double b[3], const double c[3], double n[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    n[0] = 0.5 * (u[1] * v[2] - u[2] * v[1]);
    n[1] = 0.5 * (u[2] * v[0] - u[0] * v[2]);
    n[2] = 0.5 * (u[0] * v[1] - u[1] * v[0]);
}

static double sheet_distance(const double a[3], const double b[3])
{
    double const v[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    return sheet_length(v);
}

/* A ball around points i .. j: about the middle of their box. */
static void enclose_points(const bvxi_sheet *s, uint64_t i, uint64_t j, bvxi_sheet_node *node)
{
    double low[3], high[3];
    memcpy(low, sheet_point(s, i), sizeof low);
    memcpy(high, low, sizeof high);
    for (uint64_t k = i + 1; k <= j; k++) {
        const double *const p = sheet_point(s, k);
        for (int a = 0; a < 3; a++) {
            if (p[a] < low[a]) low[a] = p[a];
            if (p[a] > high[a]) high[a] = p[a];
        }
    }
    node->radius = 0;
    for (int a = 0; a < 3; a++) node->centre[a] = 0.5 * (low[a] + high[a]);
    for (uint64_t k = i; k <= j; k++) {
        double const d = sheet_distance(node->centre, sheet_point(s, k));
        if (d > node->radius) node->radius = d;
    }
    node->radius *= 1.0 + 1e-12; /* beyond what rounding takes */
}

/* Sums over all points of i .. j: each of them is in about log2 nodes. */
static void make_node(const bvxi_sheet *s, uint64_t i, uint64_t j, bvxi_sheet_node *node)
{
    bvxi_sheet_walk w;
    uint64_t from, to;
    memset(node, 0, sizeof *node);
    enclose_points(s, i, j, node);
    for (uint64_t k = i; k < j; k++) node->length += sheet_distance(sheet_point(s, k), sheet_point(s, k + 1));
    node->chord = sheet_distance(sheet_point(s, i), sheet_point(s, j));
    w.count = 0;
    bvxi_sheet_push(&w, i, j);
    while (bvxi_sheet_take(&w, &from, &to)) {
        uint64_t const m = from + (to - from) / 2;
        double n[3];
        if (to - from < 2) continue;
        sheet_normal(sheet_point(s, from), sheet_point(s, m), sheet_point(s, to), n);
        for (int a = 0; a < 3; a++) node->normal[a] += n[a];
        node->area += sheet_length(n);
        bvxi_sheet_push(&w, from, m);
        bvxi_sheet_push(&w, m, to);
    }
}

void bvxi_sheet_close(bvx_context *ctx, bvxi_sheet *sheet)
{
    bvxi_free(ctx, sheet->group, sheet->holes->loops * sizeof *sheet->group);
    bvxi_free(ctx, sheet->order, sheet->holes->loops * 4);
    bvxi_free(ctx, sheet->node, sheet->holes->points * sizeof *sheet->node);
    bvxi_free(ctx, sheet->point, sheet->holes->points * 24);
    memset(sheet, 0, sizeof *sheet);
}

static uint64_t loop_begin(const bvxi_holes *holes, uint32_t loop)
{
    return loop == 0 ? 0 : holes->loop_end[loop - 1];
}

/* The sum of two parts, and a ball around both. */
static void join_nodes(const bvxi_sheet_node *a, const bvxi_sheet_node *b, bvxi_sheet_node *both)
{
    double const d = sheet_distance(a->centre, b->centre), radius = 0.5 * (a->radius + b->radius + d);
    double const t = d > 0 ? (radius - a->radius) / d : 0; /* on the way from a to b */
    memset(both, 0, sizeof *both);
    for (int i = 0; i < 3; i++) {
        both->normal[i] = a->normal[i] + b->normal[i];
        both->centre[i] = a->centre[i] + (t < 0 ? 0 : t > 1 ? 1 : t) * (b->centre[i] - a->centre[i]);
    }
    both->area = a->area + b->area;
    both->radius = (radius > a->radius ? radius : a->radius);
    if (both->radius < b->radius) both->radius = b->radius;
    both->radius *= 1.0 + 1e-12;
}

/* Bits of a loop's first point in turn (Morton's order): what is near in it is near in space. */
static uint64_t loop_place(const bvxi_sheet *s, uint32_t loop)
{
    const int32_t *const q = s->xyz + 3 * (uint64_t)s->holes->vertex[loop_begin(s->holes, loop)];
    uint64_t key = 0;
    for (int bit = 20; bit >= 0; bit--)
        for (int a = 0; a < 3; a++) key = key << 1 | ((uint32_t)(q[a] + (1 << 30)) >> (bit + 10) & 1);
    return key;
}

static const bvxi_sheet_node *loop_node(const bvxi_sheet *s, uint32_t loop)
{
    uint64_t const begin = loop_begin(s->holes, loop), last = s->holes->loop_end[loop] - 1;
    return &s->node[begin + (last - begin) / 2];
}

/* What loops order[i] .. order[j - 1] are from far off. */
static const bvxi_sheet_node *sheet_group(const bvxi_sheet *s, uint64_t i, uint64_t j)
{
    return j - i < 2 ? loop_node(s, s->order[i]) : &s->group[i + (j - i) / 2];
}

/* Groups from small to large: a group's halves come after it on the walk, so a list of them is gone through backwards. */
static bvx_status group_loops(bvx_context *ctx, bvxi_sheet *s)
{
    uint64_t const loops = s->holes->loops;
    uint64_t *key = NULL, *range = NULL, count = 0, i, j;
    bvxi_sheet_walk w;
    bvx_status status = bvxi_alloc(ctx, BVXI_SCRATCH, loops * 8, "the holes' places", &key);
    if (status == BVX_OK) {
        for (uint32_t l = 0; l < loops; l++) {
            key[l] = loop_place(s, l);
            s->order[l] = l;
        }
        status = bvxi_radix_sort(ctx, key, s->order, loops);
    }
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, loops * 16, "the groups of holes", &range);
    if (status == BVX_OK) {
        w.count = 0;
        if (loops > 0) bvxi_sheet_push(&w, 0, loops);
        while (bvxi_sheet_take(&w, &i, &j)) {
            if (j - i < 2) continue;
            range[2 * count] = i;
            range[2 * count++ + 1] = j;
            bvxi_sheet_push(&w, i, i + (j - i) / 2);
            bvxi_sheet_push(&w, i + (j - i) / 2, j);
        }
        while (count-- > 0) {
            uint64_t const m = range[2 * count] + (range[2 * count + 1] - range[2 * count]) / 2;
            join_nodes(sheet_group(s, range[2 * count], m), sheet_group(s, m, range[2 * count + 1]), &s->group[m]);
        }
    }
    bvxi_free(ctx, range, loops * 16);
    bvxi_free(ctx, key, loops * 8);
    return status;
}

static void fill_sheet(bvxi_sheet *s)
{
    uint64_t begin = 0;
    for (uint64_t i = 0; i < 3 * s->holes->points; i++)
        s->point[i] = (double)s->xyz[3 * (uint64_t)s->holes->vertex[i / 3] + i % 3] * s->scale[i % 3];
    for (uint64_t l = 0; l < s->holes->loops; begin = s->holes->loop_end[l++]) {
        bvxi_sheet_walk w;
        uint64_t i, j;
        w.count = 0;
        bvxi_sheet_push(&w, begin, s->holes->loop_end[l] - 1);
        while (bvxi_sheet_take(&w, &i, &j)) {
            uint64_t const m = i + (j - i) / 2;
            if (j - i < 2) continue;
            make_node(s, i, j, &s->node[m]);
            bvxi_sheet_push(&w, i, m);
            bvxi_sheet_push(&w, m, j);
        }
    }
}

bvx_status bvxi_sheet_open(bvx_context *ctx, const bvxi_holes *holes, const bvxi_snapped *snapped, const bvx_lattice *lattice,
                           bvxi_sheet *sheet)
{
    double largest = lattice->spacing[0];
    bvx_status status;
    memset(sheet, 0, sizeof *sheet);
    sheet->holes = holes;
    sheet->xyz = snapped->xyz;
    sheet->fraction_bits = lattice->fraction_bits;
    for (int a = 1; a < 3; a++)
        if (lattice->spacing[a] > largest) largest = lattice->spacing[a];
    for (int a = 0; a < 3; a++) {
        sheet->step[a] = lattice->spacing[a] / largest;
        sheet->scale[a] = sheet->step[a] / (double)(1 << lattice->fraction_bits);
    }
    status = bvxi_alloc(ctx, BVXI_SCRATCH, holes->points * 24, "the holes' points", &sheet->point);
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, holes->points * sizeof *sheet->node, "the sheet over the holes", &sheet->node);
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, holes->loops * 4, "the holes' order", &sheet->order);
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, holes->loops * sizeof *sheet->group, "the groups of holes", &sheet->group);
    if (status == BVX_OK) {
        fill_sheet(sheet);
        status = group_loops(ctx, sheet);
    }
    if (status != BVX_OK) bvxi_sheet_close(ctx, sheet);
    return status;
}

/* ---- Angles ---- */

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

/* The side of triangle (a, b, c) on which the displaced centre p lies: +1 where its normal points. */
static int sheet_side(const int32_t *a, const int32_t *b, const int32_t *c, const int64_t p[3])
{
    int64_t u[3], v[3], n[3];
    bvxi_wide s;
    int32_t sign;
    for (int i = 0; i < 3; i++) {
        u[i] = (int64_t)b[i] - a[i];
        v[i] = (int64_t)c[i] - a[i];
    }
    for (int i = 0; i < 3; i++) n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
    s = bvxi_wide_add(bvxi_wide_mul(n[0], p[0] - a[0]), bvxi_wide_mul(n[1], p[1] - a[1]));
    sign = bvxi_wide_sign(bvxi_wide_add(s, bvxi_wide_mul(n[2], p[2] - a[2])));
    for (int i = 0; i < 3 && sign == 0; i++) sign = (n[i] > 0) - (n[i] < 0);
    return sign;
}

/* Add the angle of (re, im), which lies between -pi and pi. */
static inline void turn_by(sheet_sum *sum, double re, double im, int up)
{
    double const x = sum->re * re - sum->im * im, y = sum->re * im + sum->im * re;
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
        const double *const q = sheet_point(s, corner[i]);
        for (int a = 0; a < 3; a++) v[i][a] = q[a] - at[a];
        l[i] = sheet_length(v[i]);
    }
    det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) + v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
          v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
    den = l[0] * l[1] * l[2] + (v[0][0] * v[1][0] + v[0][1] * v[1][1] + v[0][2] * v[1][2]) * l[2] +
          (v[1][0] * v[2][0] + v[1][1] * v[2][1] + v[1][2] * v[2][2]) * l[0] +
          (v[2][0] * v[0][0] + v[2][1] * v[0][1] + v[2][2] * v[0][2]) * l[1];
    most = 1e-11 * l[0] * l[1] * l[2];
    up = det > 0;
    if (det <= most && det >= -most) {
        const int32_t *q[3];
        int side;
        for (int i = 0; i < 3; i++) q[i] = s->xyz + 3 * (uint64_t)s->holes->vertex[corner[i]];
        side = sheet_side(q[0], q[1], q[2], p);
        if (side == 0) return; /* no area */
        up = side < 0;
        det = up == (det > 0) ? det : -det;
        if (den <= most && den >= -most) { /* on its edge: half of what is seen from inside */
            den = 0;
            det = up ? 1 : -1;
        } else if (det == 0 && den < 0) { /* in its plane, inside: the sign must not get lost */
            det = up ? -1e-30 * den : 1e-30 * den;
        }
    }
    turn_by(sum, den, det, up);
}

/* The segment from point i to j is part of the edge of what was opened. */
static void add_edge_change(const bvxi_sheet *s, uint64_t i, uint64_t j, const double at[3], sheet_sum *sum)
{
    const double *const a = sheet_point(s, i), *const b = sheet_point(s, j);
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

/* 1 when a part was far enough to be taken as a whole, whole loops or points i .. j of one. Its change: that of its own edge, which leaves the
 * rest of the sheet without one there; or that of all of it, and the rest has an edge from i to j, unless there is no rest. */
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
        if (add_far_part(sheet_group(s, i, j), 1, at, sum)) continue;
        if (j - i < 2) {
            add_loop(s, loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, p, at, sum);
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

bvxi_sheet_answer bvxi_sheet_turns(const bvxi_sheet *s, int32_t x, int32_t y, int32_t z)
{
    int64_t const step = (int64_t)1 << s->fraction_bits, half = step / 2;
    int64_t const p[3] = {x * step + half, y * step + half, z * step + half};
    bvxi_sheet_answer answer;
    sheet_sum sum;
    double whole = 0, off = 0, margin = 0;
    for (int level = 0; level < 3 && margin <= 0; level++) {
        add_sheet(s, p, sheet_near[level], &sum);
        whole = floor(sum.turns + 0.5);
        off = sum.turns - whole; /* -1/2 .. 1/2 */
        off = (off < 0 ? -off : off) + sum.error;
        margin = 0.5 - off;
    }
    answer.odd = floor(0.5 * whole) * 2 != whole;
    answer.same = safe_voxels(s, &sum, margin);
    answer.clear = off < 0.25 ? 1 + safe_voxels(s, &sum, 0.25 - off) : 0;
    return answer;
}
