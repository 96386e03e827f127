/* sheet.c - the solid angle of the sheet over a mesh's holes.
 *
 * Sources: Van Oosterom, Strackee. The Solid Angle of a Plane Triangle. 1983; Barill, Dickson, Schmidt,
 * Levin, Jacobson. Fast Winding Numbers for Soups and Clouds. 2018 (far parts as dipoles); Jacobson, Kavan,
 * Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding Numbers. 2013 (what lies
 * behind a hole follows from its edge only).
 *
 * A part of the sheet that is far off counts as a dipole at the middle of its ball. With area A, radius r,
 * distance d the error is below A r / (2 pi (d - r)^3) turns; parts are opened until the sum of that leaves
 * no doubt, at last all of them. Moving along, the angle changes, but for whole turns where the sheet is
 * crossed, as the field of a current along its edge (Biot and Savart): its gradient is a sum over the edges
 * of what was opened and over the dipoles. Within a reach t of the place it stays linear but for t^2 length /
 * (4 pi (d - t)^3) for each edge, and for each dipole 3 t^2 A / (4 pi (d - r - t)^4) and its error. On which
 * side of a triangle a centre lies is decided in integers, ties as everywhere (covered_rows.h), as crossings
 * are. */
#include "winding/turns.h"
#include "core/vec3.h"

#include <math.h>

const double bvxi_sheet_near[BVXI_SHEET_LEVELS] = {1e-3, 5e-5, -1};

/* What one question gathers. Near angles are a product of complex numbers and its turns, far ones a sum. */
typedef struct sheet_sum {
    double at[3];
    double re, im; /* of the angle of half a turn a turn */
    int32_t rounds, factors;
    double turns, error;
    double near;  /* parts are opened until their error is below */
    double reach; /* 0: the place only, nothing below is gathered */
    double gradient[3], rest, bend, edge_rest;
    bvxi_sheet_look *look; /* gets near edges and triangles */
} sheet_sum;

/* Add the angle of (re, im), which lies between -pi and pi; up: it counts as positive, also where im is 0. */
static inline void turn_by(sheet_sum *sum, double re, double im, int up)
{
    /* The product of two complex numbers adds their angles. */
    double const x = sum->re * re - sum->im * im;
    double y = sum->re * im + sum->im * re;

    if (im == 0 && re < 0) { /* half a turn: a hair less, so that the sign does not get lost */
        double const hair = 1e-30 * re * sum->re;
        y += up ? -hair : hair;
    }
    /* The sign of the imaginary part changes where the sum passes half a turn. */
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

static inline void see_point(const bvxi_sheet *s, uint64_t i, const sheet_sum *sum, bvxi_seen_point *p)
{
    const double *const q = bvxi_sheet_point(s, i);
    for (int a = 0; a < 3; a++) p->v[a] = q[a] - sum->at[a];
    p->length = bvxi_vec_length(p->v);
}

/* The triangle of node n goes to the look unless it lies further off than reach. */
static void keep_near_triangle(const bvxi_sheet_node *n, const bvxi_seen_point *const p[3], double det,
                               const sheet_sum *sum)
{
    bvxi_sheet_look *const look = sum->look;
    double const limit = n->radius + sum->reach;
    double r2 = 0, u[3], w[3], normal[3];

    for (int a = 0; a < 3; a++) {
        double const r = n->centre[a] - sum->at[a];
        r2 += r * r;
        u[a] = p[1]->v[a] - p[0]->v[a];
        w[a] = p[2]->v[a] - p[0]->v[a];
    }
    if (r2 > limit * limit) return;
    bvxi_vec_cross(u, w, normal);
    if (det * det > sum->reach * sum->reach * bvxi_vec_dot(normal, normal) * (1 + 1e-6) + 1e-20) return;
    if (look->triangles < BVXI_LOOK_TRIANGLES) {
        bvxi_near_triangle *const t = &look->triangle[look->triangles];
        for (int i = 0; i < 3; i++) t->p[i] = *p[i];
        memcpy(t->n, normal, sizeof normal);
        t->det = det;
    }
    if (look->triangles <= BVXI_LOOK_TRIANGLES) look->triangles++;
}

/* Add triangle i, m, j: half its solid angle, positive on the side away from its normal. */
static void add_triangle(const bvxi_sheet *s, const uint64_t corner[3], const bvxi_seen_point *const q[3],
                         const int64_t p[3], sheet_sum *sum)
{
    const double *const a = q[0]->v, *const b = q[1]->v, *const c = q[2]->v;
    /* Van Oosterom and Strackee: tan of half the angle is det / den. */
    double const la = q[0]->length, lb = q[1]->length, lc = q[2]->length, most = 1e-10 * la * lb * lc;
    double det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                 a[2] * (b[0] * c[1] - b[1] * c[0]);
    double den = la * lb * lc + bvxi_vec_dot(a, b) * lc + bvxi_vec_dot(b, c) * la + bvxi_vec_dot(c, a) * lb;
    int up = det > 0;

    if (sum->reach > 0) keep_near_triangle(&s->node[corner[1]], q, det, sum);
    /* Near the triangle's plane, between its edges, rounding may choose the wrong side: integers decide. */
    if (BVXI_UNLIKELY(det <= most && det >= -most && den <= most)) {
        const int32_t *fixed[3];
        double v[3][3];
        for (int k = 0; k < 3; k++) {
            fixed[k] = s->xyz + 3 * (uint64_t)s->holes->vertex[corner[k]];
            memcpy(v[k], q[k]->v, sizeof v[k]);
        }
        up = bvxi_touching_angle(fixed, p, (const double(*)[3])v, det, &den, &det);
    }
    turn_by(sum, den, det, up);
}

/* The segment from a to b is part of the edge of what was opened. */
static void add_sheet_edge(const bvxi_seen_point *pa, const bvxi_seen_point *pb, sheet_sum *sum)
{
    const double *const a = pa->v, *const b = pb->v;
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, la = pa->length, lb = pb->length;
    double const ab = bvxi_vec_dot(a, b), uu = bvxi_vec_dot(u, u), length = sqrt(uu);
    /* A bound below the true distance, without a root of the cross product. */
    double c[3], cc, d = 0.5 * (la + lb - length) - sum->reach, rest, factor, *gradient = sum->gradient;

    if (uu == 0) return;
    bvxi_vec_cross(a, b, c);
    cc = bvxi_vec_dot(c, c);
    /* exactly */
    if (d < 2 * sum->reach)
        d = (bvxi_vec_dot(a, u) >= 0 ? la : bvxi_vec_dot(b, u) <= 0 ? lb : sqrt(cc) / length) - sum->reach;
    rest = d <= 1e-3 * sum->reach ? BVXI_SHEET_NO_BOUND
                                  : sum->reach * sum->reach * length / (4 * BVXI_PI * d * d * d);
    /* Edges that bend the angle most are kept, to be followed exactly; the others count into the bound. */
    if (rest > sum->edge_rest && sum->look->edges < BVXI_LOOK_EDGES) {
        bvxi_near_edge *const e = &sum->look->edge[sum->look->edges++];
        e->a = *pa;
        e->b = *pb;
        memcpy(e->n, c, sizeof c);
        e->ab = ab;
        sum->look->edge_bend += rest;
        gradient = sum->look->edge_gradient;
    } else {
        sum->bend += rest;
    }
    if (rest >= BVXI_SHEET_NO_BOUND) return;

    /* (a x b) (|a| + |b|) / (|a| |b| (|a| |b| + a b)), without cancelling for opposite a and b */
    factor = ab >= 0 ? (la + lb) / (4 * BVXI_PI * la * lb * (la * lb + ab))
                     : (la + lb) * (la * lb - ab) / (4 * BVXI_PI * la * lb * cc);
    for (int k = 0; k < 3; k++) gradient[k] += factor * c[k];
}

/* 1 when a part was far enough to be taken as a whole. */
static int add_far_part(const bvxi_sheet_node *n, sheet_sum *sum)
{
    double const r[3] = {n->centre[0] - sum->at[0], n->centre[1] - sum->at[1], n->centre[2] - sum->at[2]};
    double const d2 = bvxi_vec_dot(r, r);
    /* At least twice the radius away, and far from all places within reach. */
    double const least = n->radius > 2 * sum->reach ? 2 * n->radius : n->radius + 2 * sum->reach;
    double error, rest = 0, bend = 0, factor, d, gap, flux;

    if (d2 <= least * least) return 0;
    d = sqrt(d2);
    gap = d - n->radius;
    if (n->area * n->radius > sum->near * (2 * BVXI_PI) * (gap * gap * gap)) return 0;
    error = n->area * n->radius / (2 * BVXI_PI * gap * gap * gap);
    if (sum->reach > 0) { /* its error there, and what the dipole bends */
        double const left = gap - sum->reach;
        rest = n->area * n->radius / (2 * BVXI_PI * left * left * left);
        bend = 3 * sum->reach * sum->reach * n->area / (4 * BVXI_PI * left * left * left * left);
        if (rest + bend > sum->near) return 0;
    }

    /* As a dipole: its flux is that of the summed normals at the ball's centre. */
    factor = 1 / (4 * BVXI_PI * d2 * d);
    flux = bvxi_vec_dot(r, n->normal);
    sum->error += error;
    sum->turns += flux * factor;
    if (sum->reach > 0) {
        sum->rest += rest;
        sum->bend += bend;
        for (int k = 0; k < 3; k++) sum->gradient[k] += (3 * flux / d2 * r[k] - n->normal[k]) * factor;
    }
    return 1;
}

/* From left to right: the part in hand begins at point i, seen as a, and ends at the stack's top. */
static void add_loop(const bvxi_sheet *s, uint64_t begin, uint64_t last, const int64_t p[3], sheet_sum *sum)
{
    int const edges = sum->reach > 0;
    uint64_t i = begin, end[40]; /* halved each time */
    bvxi_seen_point a, seen[40];
    int32_t count = 1;

    /* The stack holds ends only: what lies to the left of the part in hand is done. */
    end[0] = last;
    see_point(s, begin, sum, &a);
    see_point(s, last, sum, &seen[0]);
    if (edges) add_sheet_edge(&seen[0], &a, sum);
    while (count > 0) {
        uint64_t const j = end[count - 1], m = i + (j - i) / 2, corner[3] = {i, m, j};
        /* A part is taken whole where it is one edge, or far; else it is a triangle and two parts. */
        const bvxi_seen_point *const b = &seen[count - 1];
        const bvxi_seen_point *const three[3] = {&a, &seen[count], b};
        if (j - i < 2 || (j - i > 2 && (i != begin || j != last) && add_far_part(&s->node[m], sum))) {
            /* of a far part this is the way of the rest's edge, its own is in its dipole */
            if (edges) add_sheet_edge(&a, b, sum);
            a = *b;
            i = j;
            count--;
            continue;
        }
        end[count] = m;
        see_point(s, m, sum, &seen[count]);
        add_triangle(s, corner, three, p, sum);
        count++;
    }
}

static void start_sheet_sum(const bvxi_sheet *s, const int64_t p[3], sheet_sum *sum)
{
    for (int a = 0; a < 3; a++) sum->at[a] = (double)p[a] * s->scale[a];
    sum->re = 1;
    sum->im = sum->turns = 0;
    sum->rounds = sum->factors = 0;
}

/* The product's angle is half the solid angle: 2 pi of it is a turn of 4 pi. */
static double turns_of_product(const sheet_sum *sum)
{
    return (sum->im < 0 ? -bvxi_angle(sum->re, -sum->im) : bvxi_angle(sum->re, sum->im)) / (2 * BVXI_PI) +
           sum->rounds;
}

static void add_sheet(const bvxi_sheet *s, const int64_t p[3], double near, sheet_sum *sum)
{
    bvxi_sheet_walk w;
    uint64_t i, j;

    start_sheet_sum(s, p, sum);
    sum->error = BVXI_SHEET_ROUNDING;
    sum->near = near;
    w.count = 0;

    /* Groups of loops from the whole down; a far group is one dipole. */
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        if (add_far_part(bvxi_sheet_group(s, i, j), sum)) continue;
        if (j - i < 2) {
            add_loop(s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, p, sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    sum->turns += turns_of_product(sum);
}

double bvxi_sheet_angle(const bvxi_sheet *s, const int64_t p[3], double near)
{
    sheet_sum sum;
    sum.reach = 0;
    add_sheet(s, p, near, &sum);
    return sum.turns;
}

/* What is gathered around the place begins at 0, and the look has no near parts yet. */
static void start_look(double reach, double edge_rest, bvxi_sheet_look *look, sheet_sum *sum)
{
    memset(look, 0, sizeof *look);
    sum->gradient[0] = sum->gradient[1] = sum->gradient[2] = sum->rest = sum->bend = 0;
    sum->look = look;
    sum->reach = reach;
    sum->edge_rest = edge_rest;
}

static void end_look(const sheet_sum *sum)
{
    bvxi_sheet_look *const look = sum->look;
    look->turns = sum->turns;
    look->rest = BVXI_SHEET_ROUNDING + sum->rest;
    look->bend = sum->bend;
    for (int a = 0; a < 3; a++) look->gradient[a] = sum->gradient[a];
}

void bvxi_sheet_around(const bvxi_sheet *s, const int64_t p[3], double reach, double near, double edge_rest,
                       bvxi_sheet_look *look)
{
    sheet_sum sum;
    start_look(reach, edge_rest, look, &sum);
    add_sheet(s, p, near, &sum);
    end_look(&sum);
}

int bvxi_sheet_conclude(double turns, double error, int32_t want_clear, bvxi_sheet_answer *answer)
{
    double const whole = floor(turns + 0.5), signed_off = turns - whole; /* -1/2 .. 1/2 */
    double const off = signed_off < 0 ? -signed_off : signed_off;
    double const from_quarter = off < 0.25 ? 0.25 - off : off - 0.25;
    answer->tie = off + error < 0.5 ? 0 : signed_off < 0 ? -1 : 1;
    answer->whole = (int32_t)whole;
    answer->clear = off < 0.25;
    return !answer->tie && (!want_clear || from_quarter > error);
}

bvxi_sheet_answer bvxi_sheet_turns(const bvxi_sheet *s, const int64_t p[3], int32_t want_clear)
{
    bvxi_sheet_answer answer = {0, 0, 0};
    /* Each level opens more parts; the first that leaves no doubt answers. */
    for (int level = 0; level < BVXI_SHEET_LEVELS; level++) {
        sheet_sum sum;
        sum.reach = 0;
        add_sheet(s, p, bvxi_sheet_near[level], &sum);
        if (bvxi_sheet_conclude(sum.turns, sum.error, want_clear, &answer)) break;
    }
    return answer;
}

/* All triangles of these cells, one by one: nothing of them is far. */
static void add_cells(const bvxi_sheet *s, const int64_t p[3], const uint32_t *cells, uint64_t count,
                      sheet_sum *sum)
{
    const uint32_t *const all = s->tree->corner;

    start_sheet_sum(s, p, sum);
    for (uint64_t i = 0; i < count; i++) {
        int const single = cells[i] >= s->tree->cells;
        const bvxi_sheet_cell *const c = &s->tree->cell[single ? 0 : cells[i]];
        uint64_t const first = single ? cells[i] - s->tree->cells : c->first;
        for (uint64_t t = first; t < (single ? first + 1 : c->end); t++) {
            uint64_t const corner[3] = {all[3 * t], all[3 * t + 1], all[3 * t + 2]};
            bvxi_seen_point seen[3];
            const bvxi_seen_point *const three[3] = {&seen[0], &seen[1], &seen[2]};
            for (int k = 0; k < 3; k++) see_point(s, corner[k], sum, &seen[k]);
            for (int k = 0; k < 3 && sum->reach > 0; k++) add_sheet_edge(&seen[k], &seen[(k + 1) % 3], sum);
            add_triangle(s, corner, three, p, sum);
        }
    }
    sum->turns = turns_of_product(sum);
}

double bvxi_sheet_cells_angle(const bvxi_sheet *s, const int64_t p[3], const uint32_t *cells, uint64_t count)
{
    sheet_sum sum;
    sum.reach = 0;
    add_cells(s, p, cells, count, &sum);
    return sum.turns;
}

void bvxi_sheet_cells_around(const bvxi_sheet *s, const int64_t p[3], const uint32_t *cells, uint64_t count,
                             double reach, double edge_rest, bvxi_sheet_look *look)
{
    sheet_sum sum;
    start_look(reach, edge_rest, look, &sum);
    add_cells(s, p, cells, count, &sum);
    end_look(&sum);
}
