/* touch_rows.c - a triangle of any size and the voxels whose closed boxes it meets, run by run.
 *
 * Source: as conservative.c. Each condition is linear in the voxel's indices, so it bounds a slice's rows, or
 * a row's run, by one division: the edges of the projection onto (y, z) bound rows, those onto (x, z) and (x,
 * y) and the plane's two sides bound runs. The edges of a projection without area run to and fro, so they
 * bound it on both sides. What bounds a row in every slice, or a slice in every row, is divided once. The
 * plane's bounds are estimated in doubles; where an integer lies too near to be sure, 128 bits decide.
 *
 * Bit budget (lattice.h). Corners relative to the cut box lie within 1.5 * 2^30, their differences below
 * 2^31, indices times 2^F below 2^29: an edge's value stays below 4.5 * 2^60 + 2 * 2^60 < 2^63. The plane:
 * components of the normal < 2^63, values < 2^96 in 128 bits.
 * Guarantee: exact. */
#include "touch/surface_voxels.h"

#define TOUCH_FAR ((int64_t)1 << 32) /* beyond every index */

enum { ROWS_KEPT = 256 }; /* rows whose bounds are kept from slice to slice */

/* a * (index along u) + b * (index along v) + c >= 0 */
typedef struct touch_line {
    int64_t a, b, c;
} touch_line;

typedef struct touch_lines {
    touch_line line[3];
    int32_t count;
} touch_lines;

/* Voxel i of row (j, k) meets the plane when low <= i <= high: low = from -
 * along_j j - along_k k, high = to - the same, each off by less than error in
 * doubles. Exactly: n . (i, j, k) step + most >= 0 >= n . (i, j, k) step + least. */
typedef struct touch_plane {
    int64_t n[3]; /* normal, n[0] >= 0 */
    bvxi_wide most, least;
    double from, to, along_j, along_k, error;
} touch_plane;

/* A triangle in the cut box: corners relative to the box's low corner. */
typedef struct touch_triangle {
    int64_t p[3][3];
    int32_t low[3], high[3]; /* voxels of the window, inclusive */
    int64_t step;            /* 2^F */
    touch_lines yz, xz, xy;  /* first letter: u */
    touch_plane plane;
} touch_triangle;

/* Bounds by the lines of (x, y) of the rows met last: row j at j % ROWS_KEPT. */
typedef struct touch_rows_kept {
    int32_t row[ROWS_KEPT], first[ROWS_KEPT], last[ROWS_KEPT];
} touch_rows_kept;

static int cut_to_tile(const bvxi_surface_tile *tile, const int32_t (*corner)[3], touch_triangle *t)
{
    const bvxi_surface_job *const job = tile->job;
    int32_t const f = job->fraction_bits;
    int32_t const low[3] = {0, tile->rows.j0, tile->rows.k0};
    int32_t const high[3] = {job->size[0] - 1, tile->rows.j1 - 1, tile->rows.k1 - 1};

    for (int a = 0; a < 3; a++) {
        int32_t const p = corner[0][a], q = corner[1][a], r = corner[2][a];
        int32_t const least = p < q ? (p < r ? p : r) : (q < r ? q : r);
        int32_t const most = p > q ? (p > r ? p : r) : (q > r ? q : r);
        /* Closed boxes: a corner on a border reaches the voxel below it as well. */
        t->low[a] = bvxi_floor_shift(least - 1, f);
        t->high[a] = bvxi_floor_shift(most, f);
        if (t->low[a] < low[a]) t->low[a] = low[a];
        if (t->high[a] > high[a]) t->high[a] = high[a];
        if (t->low[a] > t->high[a]) return 0;
    }
    t->step = (int64_t)1 << f;
    /* Relative to the cut box, so that the products stay within their bits. */
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++) t->p[c][a] = corner[c][a] - t->low[a] * t->step;
    return 1;
}

/* The lines of a projection; area is its double, signed. */
static void make_lines(const touch_triangle *t, int u, int v, int64_t area, touch_lines *lines)
{
    int64_t const turn = area < 0 ? -1 : 1;

    lines->count = 0;
    for (int i = 0; i < 3; i++) {
        const int64_t *const p = t->p[i], *const q = t->p[(i + 1) % 3];
        /* slopes of the edge function, positive inside */
        int64_t const du = (p[v] - q[v]) * turn, dv = (q[u] - p[u]) * turn;
        touch_line *const line = &lines->line[lines->count];

        if (du == 0 && dv == 0) continue;
        line->a = du * t->step;
        line->b = dv * t->step;
        /* at the best corner */
        line->c = (p[u] * q[v] - p[v] * q[u]) * turn + (du > 0 ? line->a : 0) + (dv > 0 ? line->b : 0);
        lines->count++;
    }
}

/* Narrow [*first, *last] to the indices along u that all lines allow at index v. An edge along u bounds the
 * triangle's box along v, or is all of the projection, and v lies in the box: it allows them all. */
static void narrow_by_lines(const touch_lines *lines, int64_t v, int64_t *first, int64_t *last)
{
    /* Each line gives the least or the greatest index, by the sign of its slope. */
    for (int32_t i = 0; i < lines->count; i++) {
        const touch_line *const l = &lines->line[i];
        int64_t const rest = l->b * v + l->c;
        if (l->a > 0) {
            int64_t const least = bvxi_ceil_div(-rest, l->a);
            if (least > *first) *first = least;
        } else if (l->a < 0) {
            int64_t const most = bvxi_floor_div(rest, -l->a);
            if (most < *last) *last = most;
        }
    }
}

static double absolute(double v)
{
    return v < 0 ? -v : v;
}

static bvxi_wide negated(bvxi_wide w)
{
#if defined(__SIZEOF_INT128__) && !defined(BVX_NO_INT128)
    return -w;
#else
    return bvxi_limbs_negate(w);
#endif
}

/* n: the normal. A plane along x bounds no run; its rows are bounded by the
 * lines of (y, z), which have no area then. */
static void make_plane(touch_triangle *t, const int64_t n[3])
{
    touch_plane *const p = &t->plane;
    int64_t const turn = n[0] < 0 ? -1 : 1;
    double const rows = (double)(t->high[1] - t->low[1]), slices = (double)(t->high[2] - t->low[2]);

    /* Turned so that the plane's value grows along x: then low and high are what their names say. */
    for (int a = 0; a < 3; a++) p->n[a] = n[a] * turn;
    if (p->n[0] == 0) return;
    p->most = bvxi_wide_mul(-p->n[0], t->p[0][0]);
    p->most = bvxi_wide_add(p->most, bvxi_wide_mul(-p->n[1], t->p[0][1]));
    p->most = bvxi_wide_add(p->most, bvxi_wide_mul(-p->n[2], t->p[0][2]));
    p->least = p->most;
    /* A voxel meets the plane where its value is not all above or all below: the best corner of each side. */
    for (int a = 0; a < 3; a++) {
        bvxi_wide const across = bvxi_wide_mul(p->n[a], t->step); /* from side to side of a voxel */
        if (p->n[a] > 0) p->most = bvxi_wide_add(p->most, across);
        else p->least = bvxi_wide_add(p->least, across);
    }

    /* The same bounds in doubles, one multiplication a row; the error says when they can be trusted. */
    double const inverse = 1.0 / ((double)p->n[0] * (double)t->step);
    p->from = -bvxi_wide_double(p->most) * inverse;
    p->to = -bvxi_wide_double(p->least) * inverse;
    p->along_j = (double)p->n[1] * (double)t->step * inverse;
    p->along_k = (double)p->n[2] * (double)t->step * inverse;

    /* no more than ten roundings of terms that sum up to this; floors are taken of numbers raised by 2 */
    p->error = (absolute(p->from) + absolute(p->to) + absolute(p->along_j) * rows +
                absolute(p->along_k) * slices) *
                   (1.0 / 562949953421312.0) +
               1.0 / 16777216.0; /* 2^-49, 2^-24 */
}

static void narrow_exactly(const touch_triangle *t, int64_t j, int64_t k, int64_t *first, int64_t *last)
{
    const touch_plane *const p = &t->plane;
    bvxi_wide const at = bvxi_wide_add(bvxi_wide_mul(p->n[1], t->step * j),
                                       bvxi_wide_mul(p->n[2], t->step * k));
    /* ceil(-v / b) is -floor(v / b) */
    int64_t const from = -bvxi_wide_floor_div_scaled(bvxi_wide_add(at, p->most), p->n[0], t->step, TOUCH_FAR);
    int64_t const to = bvxi_wide_floor_div_scaled(negated(bvxi_wide_add(at, p->least)), p->n[0], t->step,
                                                  TOUCH_FAR);
    if (from > *first) *first = from;
    if (to < *last) *last = to;
}

static inline void narrow_by_plane(const touch_triangle *t, int64_t j, int64_t k, int64_t *first,
                                   int64_t *last)
{
    const touch_plane *const p = &t->plane;
    double const error = p->error, shift = p->along_j * (double)j + p->along_k * (double)k;
    double const low = p->from - shift, high = p->to - shift;
    int sure = error < 0.25;

    /* Certainly past the run: nothing is left of it. */
    if (BVXI_LIKELY(sure) && (low > (double)*last + 0.5 || high < (double)*first - 0.5)) {
        *last = *first - 1;
        return;
    }
    if (sure && low > (double)*first - 1.5) { /* so it is above -2 */
        int64_t const whole = (int64_t)(low + 2.0) - 2;
        double const part = low - (double)whole;
        /* The floor is certain where the fraction is farther from 0 and 1 than the error. */
        sure = part > error && part < 1.0 - error;
        if (sure && whole + 1 > *first) *first = whole + 1;
    }
    if (sure && high < (double)*last + 1.5) { /* and above first - 1 */
        int64_t const whole = (int64_t)(high + 2.0) - 2;
        double const part = high - (double)whole;
        sure = part > error && part < 1.0 - error;
        if (sure && whole < *last) *last = whole;
    }
    /* One of the two ends was too near to a whole number. */
    if (BVXI_UNLIKELY(!sure)) narrow_exactly(t, j, k, first, last);
}

static int open_triangle(const bvxi_surface_tile *tile, const int32_t (*corner)[3], touch_triangle *t)
{
    int64_t u[3], v[3], n[3];

    if (!cut_to_tile(tile, corner, t)) return 0;
    for (int a = 0; a < 3; a++) {
        u[a] = t->p[1][a] - t->p[0][a];
        v[a] = t->p[2][a] - t->p[0][a];
    }

    /* Three projections and the plane are all that box and triangle can be parted by. */
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    make_lines(t, 1, 2, n[0], &t->yz);
    make_lines(t, 0, 2, -n[1], &t->xz);
    make_lines(t, 0, 1, n[2], &t->xy);
    make_plane(t, n);
    return 1;
}

/* The part of row j that the lines of (x, y) allow. */
static inline void bounds_of_row(const touch_triangle *t, touch_rows_kept *kept, int32_t j, int64_t *first,
                                 int64_t *last)
{
    int32_t const at = j % ROWS_KEPT;

    /* The bounds do not depend on the slice, so they are worked out once for each row. */
    if (BVXI_UNLIKELY(kept->row[at] != j)) {
        int64_t x0 = 0, x1 = t->high[0] - t->low[0];
        narrow_by_lines(&t->xy, j, &x0, &x1);
        kept->row[at] = j;
        /* An empty range is kept as 1, 0. */
        kept->first[at] = x0 <= x1 ? (int32_t)x0 : 1;
        kept->last[at] = x0 <= x1 ? (int32_t)x1 : 0;
    }
    if (kept->first[at] > *first) *first = kept->first[at];
    if (kept->last[at] < *last) *last = kept->last[at];
}

void bvxi_touch_rows(bvxi_surface_tile *tile, const int32_t (*corner)[3], uint32_t triangle)
{
    touch_triangle t;
    touch_rows_kept kept;
    int64_t least = 0, most, rows, slices;
    int across; /* 1: the plane bounds each row in its own place */

    if (!open_triangle(tile, corner, &t)) return;
    most = t.high[0] - t.low[0];
    rows = t.high[1] - t.low[1];
    slices = t.high[2] - t.low[2];
    for (int32_t j = 0; j < ROWS_KEPT && j <= rows; j++) kept.row[j] = -1;

    /* A plane square to x bounds all rows alike; one along x is bounded by the lines. */
    across = t.plane.n[0] != 0 && (t.plane.n[1] != 0 || t.plane.n[2] != 0);
    if (t.plane.n[0] != 0 && !across) narrow_exactly(&t, 0, 0, &least, &most);
    for (int64_t k = 0; k <= slices; k++) {
        int64_t j0 = 0, j1 = rows, x0 = least, x1 = most;
        /* Rows of the slice, and the part of each row that the slice allows. */
        narrow_by_lines(&t.yz, k, &j0, &j1);
        narrow_by_lines(&t.xz, k, &x0, &x1);
        if (x0 > x1) continue;
        for (int64_t j = j0; j <= j1; j++) {
            int64_t first = x0, last = x1;
            bounds_of_row(&t, &kept, (int32_t)j, &first, &last);
            if (first > last) continue;
            if (across) narrow_by_plane(&t, j, k, &first, &last);
            if (first <= last)
                bvxi_touch_run(tile->job, t.low[1] + (int32_t)j, t.low[2] + (int32_t)k,
                               t.low[0] + (int32_t)first, t.low[0] + (int32_t)last, triangle);
        }
    }
}
