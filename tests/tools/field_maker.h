/* field_maker.h - distance fields for tests: of meshes by asking every
 * centre, and of noise. The memory is the caller's. */
#ifndef FIELD_MAKER_H
#define FIELD_MAKER_H

#include "nearest/closest.h"
#include "tools/mesh_maker.h"

#include <math.h>

/* Room for as many values as the band has. */
static inline void field_maker_open(bvx_field *f, int32_t value_type)
{
    uint64_t const rows = (uint64_t)f->band.size[1] * (uint64_t)f->band.size[2];
    size_t const bytes = value_type == BVX_F32 ? 4 : 8;
    uint64_t n = 0;

    f->row_values = maker_grow(NULL, (size_t)(rows + 1) * sizeof *f->row_values);
    for (uint64_t r = 0; r < rows; r++) {
        f->row_values[r] = n;
        for (int32_t x = 0; x < f->band.size[0]; x++)
            n += (uint64_t)bvx_grid_get(&f->band, x, (int32_t)(r % (uint64_t)f->band.size[1]),
                                        (int32_t)(r / (uint64_t)f->band.size[1]));
    }
    f->row_values[rows] = f->value_count = n;
    f->value_type = value_type;
    f->vectors = maker_grow(NULL, (size_t)(n + 1) * 3 * bytes);
    f->distances = maker_grow(NULL, (size_t)(n + 1) * bytes);
    f->triangles = maker_grow(NULL, (size_t)(n + 1) * sizeof *f->triangles);
}

static inline void field_maker_put(bvx_field *f, uint64_t n, const double vector[3], double distance,
                                   uint32_t triangle)
{
    for (uint64_t a = 0; a < 3; a++) {
        if (f->value_type == BVX_F32) ((float *)f->vectors)[3 * n + a] = (float)vector[a];
        else ((double *)f->vectors)[3 * n + a] = vector[a];
    }
    if (f->value_type == BVX_F32) ((float *)f->distances)[n] = (float)distance;
    else ((double *)f->distances)[n] = distance;
    f->triangles[n] = triangle;
}

static inline void field_maker_centre(const bvx_grid *g, int32_t x, int32_t y, int32_t z, double p[3])
{
    int32_t const at[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        p[a] = g->lattice.origin[a] + ((double)(g->low[a] + at[a]) + 0.5) * g->lattice.spacing[a];
}

/* The closest point of a mesh: the least distance, then the lowest triangle. */
static inline double field_maker_closest(const maker_mesh *m, const double p[3], double q[3],
                                         uint32_t *triangle)
{
    double best = INFINITY;

    *triangle = 0;
    for (size_t i = 0; i < m->triangles; i++) {
        double t[3][3], on[3], d2;
        for (int c = 0; c < 3; c++) memcpy(t[c], m->p + 3 * (size_t)m->t[3 * i + (size_t)c], sizeof t[c]);
        d2 = bvxi_closest_on_triangle(p, (const double(*)[3])t, on);
        if (!(d2 < best)) continue;
        best = d2;
        memcpy(q, on, sizeof on);
        *triangle = (uint32_t)i;
    }
    return sqrt(best);
}

/* The field of a closed mesh on all centres of a lattice no further than half_width [Units: world]. */
static inline void field_maker_measure(bvx_context *ctx, const maker_mesh *m, const bvx_lattice *lattice,
                                       double half_width, int32_t value_type, bvx_field *f)
{
    bvx_mesh_view const view = maker_view(m);
    double *const near = maker_grow(NULL, (size_t)lattice->dims[0] * (size_t)lattice->dims[1] *
                                              (size_t)lattice->dims[2] * 5 * sizeof *near);
    double *at = near;
    uint64_t n = 0;

    memset(f, 0, sizeof *f);
    f->half_width = half_width;
    f->sign = BVX_FILL_PARITY;
    if (bvx_voxelize_solid(ctx, &view, lattice, NULL, &f->inside) != BVX_OK ||
        bvx_grid_create(ctx, lattice, NULL, &f->band) != BVX_OK) {
        fprintf(stderr, "field_maker: %s\n", bvx_last_message(ctx));
        exit(1);
    }
    for (int32_t z = 0; z < lattice->dims[2]; z++)
        for (int32_t y = 0; y < lattice->dims[1]; y++)
            for (int32_t x = 0; x < lattice->dims[0]; x++) {
                double p[3], q[3] = {0, 0, 0}, d;
                uint32_t triangle;
                field_maker_centre(&f->band, x, y, z, p);
                d = field_maker_closest(m, p, q, &triangle);
                if (!(d <= half_width)) continue;
                bvx_grid_set(&f->band, x, y, z, 1);
                for (int a = 0; a < 3; a++) *at++ = q[a] - p[a];
                *at++ = bvx_grid_get(&f->inside, x, y, z) ? -d : d;
                *at++ = triangle;
            }
    field_maker_open(f, value_type);
    for (at = near; n < f->value_count; n++, at += 5) field_maker_put(f, n, at, at[3], (uint32_t)at[4]);
    free(near);
}

/* Noise: full of 16 centres inside, known of 16 with values, vectors of up to 2^spread spacings in any
 * direction, triangles below triangle_count. */
static inline void field_maker_noise(bvx_context *ctx, uint64_t *seed, const bvx_lattice *lattice,
                                     int32_t full, int32_t known, int32_t spread, uint32_t triangle_count,
                                     int32_t value_type, bvx_field *f)
{
    memset(f, 0, sizeof *f);
    f->sign = BVX_FILL_PARITY;
    f->half_width = INFINITY;
    if (bvx_grid_create(ctx, lattice, NULL, &f->inside) != BVX_OK ||
        bvx_grid_create(ctx, lattice, NULL, &f->band) != BVX_OK) {
        fprintf(stderr, "field_maker: %s\n", bvx_last_message(ctx));
        exit(1);
    }
    for (int32_t z = 0; z < lattice->dims[2]; z++)
        for (int32_t y = 0; y < lattice->dims[1]; y++)
            for (int32_t x = 0; x < lattice->dims[0]; x++) {
                bvx_grid_set(&f->inside, x, y, z, maker_below(seed, 16) < full);
                bvx_grid_set(&f->band, x, y, z, maker_below(seed, 16) < known);
            }
    field_maker_open(f, value_type);
    for (uint64_t n = 0; n < f->value_count; n++) {
        double const size = ldexp(1.0, maker_below(seed, spread + 8) - 7);
        double v[3];
        for (int a = 0; a < 3; a++) {
            v[a] = maker_between(seed, -size, size, 1 << 20) * lattice->spacing[a];
            if (maker_below(seed, 8) == 0) v[a] = 0.0;
        }
        field_maker_put(f, n, v, sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]),
                        triangle_count == 0 ? 0 : (uint32_t)maker_below(seed, (int32_t)triangle_count));
    }
}

static inline void field_maker_free(bvx_context *ctx, bvx_field *f)
{
    bvx_grid_free(ctx, &f->band);
    bvx_grid_free(ctx, &f->inside);
    free(f->row_values);
    free(f->vectors);
    free(f->distances);
    free(f->triangles);
    memset(f, 0, sizeof *f);
}

#endif
