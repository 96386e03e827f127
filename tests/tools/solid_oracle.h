/* solid_oracle.h - which voxel centres lie inside a mesh, slowly and from the rules only, for tests.
 *
 * The centre of a row is moved by (e_x, e_y, e_z), e_x >> e_y >> e_z > 0, by writing every test as a
 * polynomial in the three and taking the sign of its first coefficient that is not zero. All numbers are
 * whole (exact.h). Crossings are collected on the whole line, so a window's bits follow from the definition
 * of the whole. */
#ifndef SOLID_ORACLE_H
#define SOLID_ORACLE_H

#include "bitvox_io.h"
#include "tools/exact.h"
#include "tools/mesh_maker.h"

#include <math.h>

typedef struct oracle_crossing {
    struct oracle_crossing *next; /* of the same row */
    int64_t index;                /* the first voxel of the line whose moved centre is beyond the plane */
    int leaving;                  /* outwards is towards +x */
} oracle_crossing;

typedef struct oracle_solid {
    uint8_t *voxel; /* of the window, x fastest */
    bvx_window window;
    uint64_t crossings, unbalanced_rows, dropped;
    uint64_t covering; /* triangles that cover a row of the window */
    uint64_t boxes;    /* triangles whose box, seen along x, holds the moved centre of a row of the window */
} oracle_solid;

/* q = floor((p - origin) * (2^F / spacing) + 1/2) */
static inline int64_t oracle_snap(double p, double origin, double spacing, int32_t fraction_bits)
{
    double const scale = (double)(1 << fraction_bits) / spacing;
    return (int64_t)floor((p - origin) * scale + 0.5);
}

static inline int64_t oracle_centre(int64_t index, int32_t fraction_bits)
{
    return index * (INT64_C(1) << fraction_bits) + (INT64_C(1) << (fraction_bits - 1));
}

static inline int oracle_first_sign(const int *sign, int count)
{
    for (int i = 0; i < count; i++)
        if (sign[i] != 0) return sign[i];
    return 0;
}

/* Which side of the directed line u -> v the moved centre (y + e_y, z + e_z) is on: the sign of
 * dy (z + e_z - u_z) - dz (y + e_y - u_y), in the order 1, e_y, e_z. */
static inline int oracle_side(const int64_t u[3], const int64_t v[3], int64_t y, int64_t z)
{
    int64_t const dy = v[1] - u[1], dz = v[2] - u[2];
    int sign[3];
    sign[0] = exact_sign_of_sum(dy, z - u[2], -dz, y - u[1], 0, 0);
    sign[1] = (dz < 0) - (dz > 0);
    sign[2] = (dy > 0) - (dy < 0);
    return oracle_first_sign(sign, 3);
}

/* 1: covered by a counter-clockwise triangle (in y, z), -1: by a clockwise one, 0: not covered. */
static inline int oracle_covers(const int64_t *const p[3], int64_t y, int64_t z)
{
    int const a = oracle_side(p[0], p[1], y, z);
    int const b = oracle_side(p[1], p[2], y, z);
    int const c = oracle_side(p[2], p[0], y, z);
    return a == b && b == c ? a : 0;
}

/* The first index whose moved centre lies beyond the plane. The sign of n . (centre + e - a), n_x made
 * positive, in the order 1, e_x; it grows with the index. */
static inline int64_t oracle_index(const int64_t *const p[3], int64_t y, int64_t z, int32_t fraction_bits)
{
    int64_t u[3], v[3], n[3], low = p[0][0], high = p[0][0];

    for (int i = 1; i < 3; i++) {
        low = p[i][0] < low ? p[i][0] : low;
        high = p[i][0] > high ? p[i][0] : high;
    }
    /* the plane is met between the corners */
    low = (int64_t)floor((double)low / (double)(1 << fraction_bits)) - 2;
    high = (int64_t)floor((double)high / (double)(1 << fraction_bits)) + 2;
    for (int a = 0; a < 3; a++) {
        u[a] = p[1][a] - p[0][a];
        v[a] = p[2][a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    if (n[0] < 0)
        for (int a = 0; a < 3; a++) n[a] = -n[a];
    while (low < high) {
        int64_t const middle = (low + high) >> 1;
        int64_t const x = oracle_centre(middle, fraction_bits);
        int sign[2];
        sign[0] = exact_sign_of_sum(x - p[0][0], n[0], y - p[0][1], n[1], z - p[0][2], n[2]);
        sign[1] = 1;
        if (oracle_first_sign(sign, 2) > 0) high = middle;
        else low = middle + 1;
    }
    return low;
}

/* ---- Rules for one row: its crossings in order of index, entering ones first where two share an index -- */

static inline int oracle_before(const oracle_crossing *a, const oracle_crossing *b)
{
    return a->index < b->index || (a->index == b->index && a->leaving < b->leaving);
}

static inline void oracle_sort(oracle_crossing *c, size_t n)
{
    for (size_t i = 0; i < n; i++)
        for (size_t k = i; k > 0 && oracle_before(&c[k], &c[k - 1]); k--) {
            oracle_crossing const swap = c[k];
            c[k] = c[k - 1];
            c[k - 1] = swap;
        }
}

static inline void oracle_drop(oracle_crossing *c, size_t *n, size_t which)
{
    memmove(c + which, c + which + 1, (*n - which - 1) * sizeof *c);
    --*n;
}

static inline int64_t oracle_filled_without(const oracle_crossing *c, size_t n, size_t without)
{
    int64_t filled = 0, sign = -1;
    for (size_t i = 0; i < n; i++) {
        if (i == without) continue;
        filled += sign * c[i].index;
        sign = -sign;
    }
    return filled;
}

/* Odd: the crossing goes without which least is filled, the later of equals. */
static inline void oracle_balance_parity(oracle_crossing *c, size_t *n)
{
    size_t best = 0;
    if (*n % 2 == 0) return;
    for (size_t i = 0; i < *n; i++)
        if (oracle_filled_without(c, *n, i) <= oracle_filled_without(c, *n, best)) best = i;
    oracle_drop(c, n, best);
}

/* While leaving crossings are in excess, the first goes that has nothing before it to leave; while entering
 * ones are, the last goes that has nothing behind it. */
static inline void oracle_balance_winding(oracle_crossing *c, size_t *n)
{
    for (;;) {
        int64_t sum = 0, depth = 0;
        size_t i;
        for (i = 0; i < *n; i++) sum += c[i].leaving ? -1 : 1;
        if (sum == 0) return;
        if (sum < 0) {
            for (i = 0; depth >= 0; i++) depth += c[i].leaving ? -1 : 1;
            oracle_drop(c, n, i - 1);
        } else {
            for (i = *n; depth >= 0; i--) depth += c[i - 1].leaving ? 1 : -1;
            oracle_drop(c, n, i);
        }
    }
}

static inline int oracle_inside(const oracle_crossing *c, size_t n, int32_t fill, int64_t index)
{
    int64_t count = 0, winding = 0;
    for (size_t i = 0; i < n; i++) {
        if (c[i].index > index) continue;
        count++;
        winding += c[i].leaving ? -1 : 1;
    }
    return fill == BVX_FILL_PARITY ? count % 2 != 0 : winding != 0;
}

static inline void oracle_row(oracle_solid *s, oracle_crossing *list, int32_t fill, uint8_t *row)
{
    size_t n = 0, kept;
    oracle_crossing *c;

    for (const oracle_crossing *i = list; i != NULL; i = i->next) n++;
    if (n == 0) return;
    c = maker_grow(NULL, n * sizeof *c);
    n = 0;
    for (const oracle_crossing *i = list; i != NULL; i = i->next) c[n++] = *i;
    oracle_sort(c, n);
    kept = n;
    if (fill == BVX_FILL_PARITY) oracle_balance_parity(c, &kept);
    else oracle_balance_winding(c, &kept);
    s->crossings += n;
    s->dropped += n - kept;
    s->unbalanced_rows += kept != n;
    for (int32_t i = 0; i < s->window.size[0]; i++)
        row[i] = (uint8_t)oracle_inside(c, kept, fill, s->window.low[0] + i);
    free(c);
}

/* ---- The solid ---- */

/* Rows worth testing along an axis: those whose centre is within a voxel of [low, high]. */
static inline void oracle_range(int64_t low, int64_t high, int32_t f, int32_t window_low, int32_t window_size,
                                int64_t *first, int64_t *last)
{
    *first = (int64_t)floor((double)low / (double)(1 << f)) - 1;
    *last = (int64_t)floor((double)high / (double)(1 << f)) + 1;
    if (*first < window_low) *first = window_low;
    if (*last > (int64_t)window_low + window_size - 1) *last = (int64_t)window_low + window_size - 1;
}

/* q: snapped vertices. NULL window: the whole lattice. */
static inline oracle_solid oracle_make(const bvx_lattice *lattice, const bvx_window *window, const int64_t *q,
                                       const uint32_t *triangles, size_t count, int32_t fill)
{
    int32_t const f = lattice->fraction_bits;
    oracle_solid s;
    oracle_crossing **rows;
    size_t row_count;

    memset(&s, 0, sizeof s);
    for (int a = 0; a < 3; a++) {
        s.window.low[a] = window != NULL ? window->low[a] : 0;
        s.window.size[a] = window != NULL ? window->size[a] : lattice->dims[a];
    }
    row_count = (size_t)s.window.size[1] * (size_t)s.window.size[2];
    rows = maker_grow(NULL, row_count * sizeof *rows);
    for (size_t i = 0; i < row_count; i++) rows[i] = NULL;
    s.voxel = maker_grow(NULL, row_count * (size_t)s.window.size[0]);
    memset(s.voxel, 0, row_count * (size_t)s.window.size[0]);
    for (size_t t = 0; t < count; t++) {
        const int64_t *p[3];
        int64_t low[3], high[3], j0, j1, k0, k1;
        int covering = 0, box = 0;
        for (int i = 0; i < 3; i++) p[i] = q + 3 * (size_t)triangles[3 * t + (size_t)i];
        for (int a = 0; a < 3; a++) {
            low[a] = p[0][a] < p[1][a] ? p[0][a] : p[1][a];
            low[a] = low[a] < p[2][a] ? low[a] : p[2][a];
            high[a] = p[0][a] > p[1][a] ? p[0][a] : p[1][a];
            high[a] = high[a] > p[2][a] ? high[a] : p[2][a];
        }
        oracle_range(low[1], high[1], f, s.window.low[1], s.window.size[1], &j0, &j1);
        oracle_range(low[2], high[2], f, s.window.low[2], s.window.size[2], &k0, &k1);
        for (int64_t k = k0; k <= k1; k++)
            for (int64_t j = j0; j <= j1; j++) {
                int64_t const y = oracle_centre(j, f), z = oracle_centre(k, f);
                int const side = oracle_covers(p, y, z);
                oracle_crossing *c, **row;
                box |= y >= low[1] && y < high[1] && z >= low[2] && z < high[2];
                if (side == 0) continue;
                covering = 1;
                c = maker_grow(NULL, sizeof *c);
                row = &rows[(size_t)(k - s.window.low[2]) * (size_t)s.window.size[1] +
                            (size_t)(j - s.window.low[1])];
                c->index = oracle_index(p, y, z, f);
                c->leaving = side > 0;
                c->next = *row;
                *row = c;
            }
        s.covering += (uint64_t)covering;
        s.boxes += (uint64_t)box;
    }
    for (size_t r = 0; r < row_count; r++) {
        oracle_row(&s, rows[r], fill, s.voxel + r * (size_t)s.window.size[0]);
        while (rows[r] != NULL) {
            oracle_crossing *const c = rows[r];
            rows[r] = c->next;
            free(c);
        }
    }
    free(rows);
    return s;
}

static inline void oracle_free(oracle_solid *s)
{
    free(s->voxel);
    memset(s, 0, sizeof *s);
}

#endif
