/* sharp_cells.c - the first pass over sharp edges: which loops are sharp, and where their apex lies, nearest
 * to the planes of their facets but inside the cell. Source and method: sharp.c. */
#include "surface/sharp.h"

/* Facets meet in a point when it lies this near to all their planes. [Units: largest spacings] */
#define SAME_PLACE (1.0 / 32.0)

static int is_sharp(const bvxi_sharp_work *w, const bvxi_cell_loop *l)
{
    /* Any two facets of the loop that differ by more than the angle. */
    for (int32_t i = 1; i < l->corners; i++)
        for (int32_t k = 0; k < i; k++) {
            double a[3], b[3];
            if (!bvxi_sharp_normal(w, l->vertex[i], a) || !bvxi_sharp_normal(w, l->vertex[k], b)) continue;
            if (bvxi_vec_dot(a, b) < w->least_cosine) return 1;
        }
    return 0;
}

/* 0 when all facets at the cell's vertices lie within half the angle of one of them: no two differ more. */
static int may_be_sharp(const bvxi_sharp_work *w, const bvxi_cell_walk *c)
{
    const bvxi_march *const m = w->march;
    const uint32_t *const corner = m->mesh->triangles + 3 * (size_t)c->triangle;
    uint32_t const corners = 3u * bvxi_cell_triangle_count[m->options.face_rule][c->cell_case];
    double const half = sqrt(0.5 + 0.5 * w->least_cosine) + 1e-6; /* normals are floats */
    double first[3], n[3];
    int known = 0;

    /* Against one normal, not all pairs: two within half the angle of it differ by less.. */
    for (uint32_t i = 0; i < corners; i++) {
        if (!bvxi_sharp_normal(w, corner[i], known ? n : first)) continue;
        if (known && bvxi_vec_dot(first, n) < half) return 1;
        known = 1;
    }
    return 0;
}

void bvxi_sharp_count_piece(void *work, uint64_t begin, uint64_t end)
{
    bvxi_sharp_work *const w = work;
    for (uint64_t s = begin; s < end; s++) {
        bvxi_cell_walk c;
        w->first[s] = 0;
        if (w->march->slots[s + 1].triangle == w->march->slots[s].triangle) continue;
        for (bvxi_start_cells(w->march, s, &c); bvxi_next_cell(&c);) {
            bvxi_cell_loops loops;
            if (!may_be_sharp(w, &c)) continue;
            bvxi_trace_walked(&c, &loops);
            for (int32_t l = 0; l < loops.count; l++) w->first[s] += (uint32_t)is_sharp(w, &loops.loop[l]);
        }
    }
}

/* ---- two triangles proven to have no common point ---- */

/* Any direction in which their shadows do not overlap proves it, however it was found, so only the shadows'
 * rounding counts: three products and two sums of doubles err by less than 2^-50 times the sum of the
 * products' sizes. Tried are the normals and the products of sides, which suffice where rounding is nothing
 * (separating axes). 0 may be wrong. */

static void cross_sides(const double a[3], const double b[3], const double c[3], const double d[3],
                        double n[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const v[3] = {d[0] - c[0], d[1] - c[1], d[2] - c[2]};
    bvxi_vec_cross(u, v, n);
}

/* The shadow of a triangle along n, widened by its rounding. */
static void cast_shadow(const double t[3][3], const double n[3], double *low, double *high)
{
    for (int k = 0; k < 3; k++) {
        double const x = n[0] * t[k][0], y = n[1] * t[k][1], z = n[2] * t[k][2], at = x + y + z;
        double const size = (x < 0 ? -x : x) + (y < 0 ? -y : y) + (z < 0 ? -z : z);
        /* the last for products below the normal range */
        double const wide = size * (1.0 / 1125899906842624.0) + 1e-290;
        if (k == 0 || at - wide < *low) *low = at - wide;
        if (k == 0 || at + wide > *high) *high = at + wide;
    }
}

static int are_apart_along(const double one[3][3], const double two[3][3], const double n[3])
{
    double low[2], high[2];
    cast_shadow(one, n, &low[0], &high[0]);
    cast_shadow(two, n, &low[1], &high[1]);
    return high[0] < low[1] || high[1] < low[0];
}

int bvxi_triangles_apart(const double one[3][3], const double two[3][3])
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double n[3];

    for (int a = 0; a < 3; a++)
        if (are_apart_along(one, two, axes[a])) return 1;

    /* Normals first, then products of sides: most triangles that are apart are so along an axis. */
    cross_sides(one[0], one[1], one[0], one[2], n);
    if (are_apart_along(one, two, n)) return 1;
    cross_sides(two[0], two[1], two[0], two[2], n);
    if (are_apart_along(one, two, n)) return 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            cross_sides(one[i], one[(i + 1) % 3], two[k], two[(k + 1) % 3], n);
            if (are_apart_along(one, two, n)) return 1;
        }
    return 0;
}

/* ---- apexes ---- */

/* The cell's faces as written, its middle, and half of the box that apexes are kept in. */
typedef struct sharp_box {
    double low[3], high[3], middle[3], half[3];
} sharp_box;

static double as_written(const bvxi_march *m, double x)
{
    return m->options.position_type == BVX_F32 ? bvxi_nearest_float(x) : x;
}

/* 1 when a point lies inside the box, and on all planes but for SAME_PLACE. */
static int lies_on_all(const sharp_box *box, const bvxi_apex_plane *planes, int32_t count, const double p[3])
{
    for (int a = 0; a < 3; a++)
        if (!(p[a] > -box->half[a] && p[a] < box->half[a])) return 0;
    for (int32_t i = 0; i < count; i++) {
        double const d = bvxi_vec_dot(planes[i].n, p) - planes[i].d;
        if (!(d < SAME_PLACE && d > -SAME_PLACE)) return 0;
    }
    return 1;
}

/* 0 where the apex does not come to lie strictly inside the cell, which numbers
 * that are none may do. The facets that do not reach the loop's vertices count
 * when all meet in a point of the cell: a corner that only its edges tell of. */
static int place_apex(const bvxi_sharp_work *w, const sharp_box *box, const bvxi_cell_loop *l, double apex[3])
{
    bvxi_apex_plane planes[2 * BVXI_LOOP_CORNERS + 1];
    double middle[3], p[3];
    int32_t count[2];

    /* Read the planes at a loop's vertices, from the cell's middle: the nearer ones, then the others. */
    count[0] = count[1] = 0;
    memset(middle, 0, 3 * sizeof *middle);

    /* Nearer planes first, so that they can be taken alone. */
    for (int32_t other = 0; other < 2; other++) {
        for (int32_t i = 0; i < l->corners; i++) {
            const bvxi_facet_plane *const from = &w->cuts->planes[2 * (size_t)l->vertex[i] + (size_t)other];
            bvxi_apex_plane *const to = &planes[count[1]];
            double q[3];
            bvxi_sharp_vertex(w->march, l->vertex[i], q);
            for (int a = 0; a < 3; a++) {
                q[a] = (q[a] - box->middle[a]) / w->cuts->unit;
                middle[a] += other ? 0.0 : q[a] / l->corners;
                to->n[a] = (double)from->n[a];
            }

            /* A vertex without a plane has a normal of 0 and is overwritten by the next one. */
            to->d = bvxi_vec_dot(to->n, q) + (double)from->offset;
            count[1] += to->n[0] != 0.0 || to->n[1] != 0.0 || to->n[2] != 0.0;
        }
        if (other == 0) count[0] = count[1];
    }

    /* With the far facets first; where they do not all meet in the cell they would pull the apex away, and
     * are left out. */
    bvxi_apex(planes, count[1], middle, box->half, p);
    if (count[1] == count[0] || !lies_on_all(box, planes, count[1], p))
        bvxi_apex(planes, count[0], middle, box->half, p);
    for (int a = 0; a < 3; a++) {
        apex[a] = as_written(w->march, box->middle[a] + p[a] * w->cuts->unit);
        if (!(apex[a] > box->low[a] && apex[a] < box->high[a])) return 0;
    }
    return 1;
}

/* Does n look away from all facets that are known at both vertices? */
static int looks_away(const bvxi_sharp_work *w, const uint32_t end[2], const double n[3])
{
    int known = 0;
    for (int i = 0; i < 4; i++) {
        const bvxi_facet_plane *const p = &w->cuts->planes[2 * (size_t)end[i >> 1] + (size_t)(i & 1)];
        double const facet[3] = {(double)p->n[0], (double)p->n[1], (double)p->n[2]};
        if (bvxi_vec_dot(n, facet) > 0.0) return 0;
        known |= facet[0] != 0.0 || facet[1] != 0.0 || facet[2] != 0.0;
    }
    return known;
}

/* 1 when a triangle of the fan is turned over, or has no area. */
static int turns_over(const bvxi_sharp_work *w, const bvxi_cell_loop *l, const double apex[3])
{
    for (int32_t i = 0; i < l->corners; i++) {
        uint32_t const end[2] = {l->vertex[i], l->vertex[i + 1 < l->corners ? i + 1 : 0]};
        double p[2][3], n[3];
        for (int k = 0; k < 2; k++) bvxi_sharp_vertex(w->march, end[k], p[k]);
        if (!bvxi_normal_of(p[0], p[1], apex, w->cuts->unit, n) || looks_away(w, end, n)) return 1;
    }
    return 0;
}

/* Triangle n of a loop: of its fan, or as it was. */
static void loop_triangle(const bvxi_march *m, const bvxi_cell_walk *c, const bvxi_cell_loop *l,
                          const double *apex, int32_t n, double t[3][3])
{
    if (apex != NULL) {
        bvxi_sharp_vertex(m, l->vertex[n], t[0]);
        bvxi_sharp_vertex(m, l->vertex[n + 1 < l->corners ? n + 1 : 0], t[1]);
        memcpy(t[2], apex, sizeof t[2]);
    } else {
        const uint32_t *const corner = m->mesh->triangles + 3 * ((size_t)c->triangle + l->first + (size_t)n);
        for (int k = 0; k < 3; k++) bvxi_sharp_vertex(m, corner[k], t[k]);
    }
}

/* 1 when all triangles of different loops of the cell are proven apart; apex[l] is NULL for loops without. */
static int loops_are_apart(const bvxi_march *m, const bvxi_cell_walk *c, const bvxi_cell_loops *loops,
                           const double *const apex[BVXI_CELL_LOOPS])
{
    for (int32_t a = 1; a < loops->count; a++)
        for (int32_t b = 0; b < a; b++) {
            const bvxi_cell_loop *const one = &loops->loop[a], *const two = &loops->loop[b];
            int32_t const n = apex[a] != NULL ? one->corners : (int32_t)one->triangles;
            int32_t const k = apex[b] != NULL ? two->corners : (int32_t)two->triangles;
            if (apex[a] == NULL && apex[b] == NULL) continue; /* the tables see to that */
            for (int32_t i = 0; i < n; i++)
                for (int32_t j = 0; j < k; j++) {
                    double t[3][3], u[3][3];
                    loop_triangle(m, c, one, apex[a], i, t);
                    loop_triangle(m, c, two, apex[b], j, u);
                    if (!bvxi_triangles_apart((const double(*)[3])t, (const double(*)[3])u)) return 0;
                }
        }
    return 1;
}

/* Fill the loops of one cell; returns how many. */
static uint32_t fill_cell(const bvxi_sharp_work *w, const bvxi_cell_walk *c, bvxi_sharp_loop *out)
{
    const double *apex[BVXI_CELL_LOOPS] = {NULL};
    bvxi_cell_loops loops;
    uint32_t count = 0;
    sharp_box box;

    if (!may_be_sharp(w, c)) return 0;
    bvxi_trace_walked(c, &loops);

    for (int32_t l = 0; l < loops.count; l++) {
        bvxi_sharp_loop *const s = &out[count];
        if (!is_sharp(w, &loops.loop[l])) continue;
        if (count++ == 0) {
            const bvxi_march *const m = w->march;
            int32_t const at[3] = {c->x, c->j, c->k};
            /* As the mesh holds them: an apex strictly between rounded faces touches no neighbouring cell. */
            for (int32_t a = 0; a < 3; a++) {
                box.low[a] = as_written(m, bvxi_place_along(m, a, at[a], 0.0));
                box.high[a] = as_written(m, bvxi_place_along(m, a, at[a] + 1, 0.0));
                box.middle[a] = bvxi_place_along(m, a, at[a], 0.5);
                box.half[a] = (0.5 - BVXI_EDGE_MARGIN) * m->spacing[a] / w->cuts->unit;
            }
        }
        memset(s, 0, sizeof *s);
        s->x = c->x;
        s->loop = (uint8_t)l;
        s->alone = loops.count == 1;
        s->kept = (uint8_t)(place_apex(w, &box, &loops.loop[l], s->apex) &&
                            !turns_over(w, &loops.loop[l], s->apex));
        if (s->kept) apex[l] = s->apex;
    }

    /* Loops of one cell were apart: when fans may cross, the cell goes back to the table's triangles. */
    if (count != 0 && loops.count > 1 && !loops_are_apart(w->march, c, &loops, apex))
        for (uint32_t n = 0; n < count; n++) out[n].kept = 0;
    return count;
}

void bvxi_sharp_fill_piece(void *work, uint64_t begin, uint64_t end)
{
    bvxi_sharp_work *const w = work;
    for (uint64_t s = begin; s < end; s++) {
        bvxi_sharp_loop *out = w->loops + w->first[s];
        bvxi_cell_walk c;
        if (w->first[s + 1] == w->first[s]) continue;
        for (bvxi_start_cells(w->march, s, &c); bvxi_next_cell(&c);) out += fill_cell(w, &c, out);
    }
}
