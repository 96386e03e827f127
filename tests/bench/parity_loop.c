/* parity_loop.c - the baseline that the library is measured against: a solid by double-precision scanline
 * parity.
 *
 * What a good programmer writes in an afternoon: for each triangle the rows of its bounds in y and z; on each
 * row of z the stretch of y between the two edges that cross it, half-open, so that triangles which share an
 * edge share no row; where the plane is met along x one bit is toggled; at the end each bit becomes the
 * parity of those up to it. Edges are followed from their lower end in z, so that both triangles of an edge
 * compute the same number. No snapping, so no proof: rounding decides ties. */
#include "parity_loop.h"

#include <string.h>

typedef struct corner {
    double x, y, z;
} corner;

/* y where the edge meets height z; 0 when it does not. Half-open: one end counts, the other does not. */
static int edge_meets(const corner *a, const corner *b, double z, double *y)
{
    if ((a->z <= z) == (b->z <= z)) return 0;
    if (a->z > b->z) {
        const corner *const t = a;
        a = b;
        b = t;
    }
    *y = a->y + (b->y - a->y) * ((z - a->z) / (b->z - a->z));
    return 1;
}

static double least(double a, double b, double c)
{
    double const m = a < b ? a : b;
    return m < c ? m : c;
}

static double greatest(double a, double b, double c)
{
    double const m = a > b ? a : b;
    return m > c ? m : c;
}

/* The first of size rows whose centre is not below p; size when there is none. */
static int32_t row_from(double p, int32_t size)
{
    if (!(p > 0.5)) return 0;
    if (p > size) return size;
    int32_t const i = (int32_t)(p - 0.5); /* quicker than ceil, which is a call on plain x86-64 */
    return i + (i + 0.5 < p);
}

static void toggle(bvx_grid *grid, double x, int32_t j, int32_t k)
{
    uint64_t *const row = grid->words +
                          ((size_t)k * (size_t)grid->size[1] + (size_t)j) * (size_t)grid->words_per_row;
    int32_t const i = row_from(x, grid->size[0]);
    if (i < grid->size[0]) row[i >> 6] ^= UINT64_C(1) << (i & 63);
}

static void take_triangle(bvx_grid *grid, const corner *a, const corner *b, const corner *c)
{
    int32_t j0, j1, k0, k1;
    j0 = row_from(least(a->y, b->y, c->y), grid->size[1]);
    j1 = row_from(greatest(a->y, b->y, c->y), grid->size[1]);
    if (j0 >= j1) return;
    k0 = row_from(least(a->z, b->z, c->z), grid->size[2]);
    k1 = row_from(greatest(a->z, b->z, c->z), grid->size[2]);
    if (k0 >= k1) return;

    /* the plane as x over (y, z) */
    double const uy = b->y - a->y, uz = b->z - a->z, vy = c->y - a->y, vz = c->z - a->z;
    double const det = uy * vz - uz * vy;
    if (det == 0.0) return;
    double const x_per_y = ((b->x - a->x) * vz - (c->x - a->x) * uz) / det;
    double const x_per_z = ((c->x - a->x) * uy - (b->x - a->x) * vy) / det;

    for (int32_t k = k0; k < k1; k++) {
        double const z = k + 0.5;
        double y[3];
        int n = 0;
        n += edge_meets(a, b, z, &y[n]);
        n += edge_meets(b, c, z, &y[n]);
        n += edge_meets(c, a, z, &y[n]);
        if (n != 2) continue;
        j0 = row_from(y[0] < y[1] ? y[0] : y[1], grid->size[1]);
        j1 = row_from(y[0] < y[1] ? y[1] : y[0], grid->size[1]);
        for (int32_t j = j0; j < j1; j++)
            toggle(grid, a->x + x_per_y * (j + 0.5 - a->y) + x_per_z * (z - a->z), j, k);
    }
}

/* Bit i becomes the parity of bits 0..i of the row. */
static void toggles_to_runs(bvx_grid *grid)
{
    size_t const rows = (size_t)grid->size[1] * (size_t)grid->size[2], n = (size_t)grid->words_per_row;
    uint64_t const tail = ~UINT64_C(0) >> (n * 64 - (size_t)grid->size[0]);

    for (size_t r = 0; r < rows; r++) {
        uint64_t *const row = grid->words + r * n;
        uint64_t carry = 0;
        for (size_t i = 0; i < n; i++) {
            uint64_t w = row[i];
            w ^= w << 1;
            w ^= w << 2;
            w ^= w << 4;
            w ^= w << 8;
            w ^= w << 16;
            w ^= w << 32;
            row[i] = w ^ carry;
            carry = 0 - (row[i] >> 63);
        }
        row[n - 1] &= tail;
    }
}

void parity_loop(const float *positions, const uint32_t *triangles, uint64_t triangle_count, bvx_grid *grid)
{
    const bvx_lattice *const l = &grid->lattice;
    double const scale[3] = {1.0 / l->spacing[0], 1.0 / l->spacing[1], 1.0 / l->spacing[2]};
    size_t const rows = (size_t)grid->size[1] * (size_t)grid->size[2];

    memset(grid->words, 0, rows * (size_t)grid->words_per_row * sizeof *grid->words);
    for (uint64_t t = 0; t < triangle_count; t++) {
        corner c[3];
        for (int i = 0; i < 3; i++) {
            const float *const p = positions + (size_t)3 * triangles[3 * t + (uint64_t)i];
            c[i].x = (p[0] - l->origin[0]) * scale[0];
            c[i].y = (p[1] - l->origin[1]) * scale[1];
            c[i].z = (p[2] - l->origin[2]) * scale[2];
        }
        take_triangle(grid, &c[0], &c[1], &c[2]);
    }
    toggles_to_runs(grid);
}
