/* sheet_near.c - the angle of the sheet on straight ways that are short, where it is not linear.
 *
 * Source: what an edge adds to the angle on a way is the solid angle of the parallelogram that it sweeps as
 * seen from the one who goes (Maxwell. A Treatise on Electricity and Magnetism. 1873, 417 ff.), less than
 * half of all directions as it is flat.
 *
 * Guarantee: answers are right or none is given; where the way passes an edge or a triangle's edge by less
 * than rounding can tell, or ends in its plane, there is none.
 *
 * The last three functions say what a look from the middle of a brick has for its centres; both ways of
 * cutting blocks use them. */
#include "winding/turns.h"

/* What the near edges sweep on the straight way from the place by h, added to *turns; 0: doubles cannot decide. Going by
 * h, an edge from a to b sweeps the parallelogram a, b, b - h, a - h. Both halves of it, a, b, c = b
 * - h and a, c, d = a - h, have the volume - h (a x b) with the origin; half their solid angles are those of
 * the complex numbers below, all edges' a product. */
static int sweep_edges(const bvxi_sheet_look *look, const double h[3], double *turns)
{
    double const hh = bvxi_vec_dot(h, h);
    double re = 1, im = 0;
    int32_t rounds = 0;

    for (int32_t i = 0; i < look->edges; i++) {
        const bvxi_near_edge *const e = &look->edge[i];
        double const la = e->a.length;
        double const lb = e->b.length;
        double const ah = bvxi_vec_dot(e->a.v, h);
        double const bh = bvxi_vec_dot(e->b.v, h);
        double const nh = bvxi_vec_dot(e->n, h);
        double const c2 = lb * lb - 2 * bh + hh, d2 = la * la - 2 * ah + hh;
        double const lc = c2 > 0 ? sqrt(c2) : 0, ld = d2 > 0 ? sqrt(d2) : 0;
        /* The two triangles of the parallelogram, each by the formula of the solid angle. */
        double const ac = e->ab - ah, size = la * la * lb * lc * lc * ld;
        double const first = la * lb * lc + e->ab * lc + (lb * lb - bh) * la + ac * lb;
        double const second = la * lc * ld + ac * ld + (ac - bh + hh) * la + (la * la - ah) * lc;
        /* Both triangles' product is the parallelogram's number; turned round, as the angle falls by it. */
        double const x = first * second - nh * nh, y = nh * (first + second);
        double const next_re = re * x - im * y;
        double const next_im = re * y + im * x;
        double const most = 1e-9 * size;
        double const small = 1e-6 * (la + lb);
        /* nearly half of all directions, or at a corner: which way round? */
        if (lc < small || ld < small || (x <= most && y <= most && y >= -most)) return 0;
        if (y > 0 && im >= 0 && next_im < 0) rounds++;
        if (y < 0 && im < 0 && next_im >= 0) rounds--;
        re = next_re;
        im = next_im;
        if (i % 4 == 3) { /* a factor is the sixth power of a distance */
            double const far = re < 0 ? -re : re, high = im < 0 ? -im : im, large = far > high ? far : high;
            re /= large;
            im /= large;
        }
    }
    *turns += (im < 0 ? -bvxi_angle(re, -im) : bvxi_angle(re, im)) / (2 * BVXI_PI) + rounds;
    return 1;
}

/* The sign of a determinant, or 0 where it is not sure; size: the product of its vectors' lengths. */
static int sure_sign(double v, double size)
{
    return v > 1e-10 * size ? 1 : v < -1e-10 * size ? -1 : 0;
}

/* Does the way h cross the triangle? 2: not sure, else what it adds. */
static int32_t enter_triangle(const bvxi_near_triangle *t, const double h[3])
{
    double const area = sqrt(bvxi_vec_dot(t->n, t->n)), far = t->p[0].length + bvxi_vec_length(h);
    /* The triangle's volume with the place has the sign of its side: once before the way, once after it. */
    int const from = sure_sign(t->det, area * far);
    int const to = sure_sign(t->det - bvxi_vec_dot(t->n, h), area * far);
    int turn[3], sum;

    if (from == to && from != 0) return 0;
    /* The way's line against each edge: all three signs alike mean that it goes through. */
    for (int i = 0; i < 3; i++) {
        const bvxi_seen_point *const a = &t->p[i], *const b = &t->p[(i + 1) % 3];
        double const det = bvxi_vec_volume6(h, a->v, b->v);
        turn[i] = sure_sign(det, (far - t->p[0].length) * a->length * b->length);
    }
    for (int i = 0; i < 3; i++)
        if (turn[i] * turn[(i + 1) % 3] < 0) return 0; /* the line passes it by */
    sum = turn[0] + turn[1] + turn[2];
    /* Some sign was not sure: no answer is better than a wrong one. */
    if (from == 0 || to == 0 || (sum != 3 && sum != -3)) return 2;
    return to > 0 ? 1 : -1;
}

/* ---- What a look from the middle of a brick says of its centres ---- */

int bvxi_turns_of_centre(const bvxi_turns_block *block, const bvxi_sheet_look *look, double reach2,
                         const double h[3], int32_t *whole, int *clear)
{
    /* The bend grows with the square of the way, so a centre near the middle has less of it. */
    double const part = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]) / reach2;
    const double *const g = look->gradient, *const e = look->edge_gradient;
    double turns = look->turns + g[0] * h[0] + g[1] * h[1] + g[2] * h[2], n;
    double const linear = turns + e[0] * h[0] + e[1] * h[1] + e[2] * h[2];
    int32_t entered = 0;

    /* First all near edges as linear; where that leaves a doubt, what they sweep exactly. */
    if (!is_certain(block, linear, look->rest + (look->bend + look->edge_bend) * part, &n, clear)) {
        if (look->edges == 0 || !sweep_edges(look, h, &turns)) return 0;
        if (!is_certain(block, turns, look->rest + look->bend * part, &n, clear)) return 0;
    }
    /* Too many near triangles were met to be listed. */
    if (look->triangles > BVXI_LOOK_TRIANGLES) return 0;
    /* How often that way enters the near triangles, more than leaves. */
    for (int32_t t = 0; t < look->triangles; t++) {
        int32_t const added = enter_triangle(&look->triangle[t], h);
        if (added == 2) return 0;
        entered += added;
    }
    *whole = (int32_t)n + entered;
    return 1;
}

int bvxi_turns_settled(const bvxi_turns_block *block, const turns_brick *b, const bvxi_sheet_look *look,
                       int32_t *whole, int *clear)
{
    double spread = look->rest + look->bend + look->edge_bend, n;
    /* The gradient's greatest change along each axis, from the middle to the last centre. */
    for (int32_t a = 0; a < 3; a++) {
        double const way = 0.5 * (b->size[a] - 1) * block->sheet->step[a] *
                           (look->gradient[a] + look->edge_gradient[a]);
        spread += way < 0 ? -way : way;
    }
    if (look->triangles > 0 || !is_certain(block, look->turns, spread, &n, clear)) return 0;
    *whole = (int32_t)n;
    return 1;
}

double bvxi_turns_middle(const bvxi_turns_block *block, const turns_brick *b, int64_t p[3])
{
    const bvxi_sheet *const s = block->sheet;
    int64_t const half = ((int64_t)1 << s->fraction_bits) / 2;
    double reach = 0;
    /* The middle of an even number of centres lies between two: halves of a step. */
    for (int32_t a = 0; a < 3; a++) {
        double const way = 0.5 * (b->size[a] - 1) * s->step[a];
        reach += way * way;
        p[a] = (2 * ((int64_t)block->low[a] + b->at[a]) + b->size[a]) * half;
    }
    return sqrt(reach) * (1 + 1e-9);
}
