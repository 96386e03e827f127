/* touch_batch.h - triangles taken some hundred at a time: their corners and boxes as arrays. Not
 * installed. */
#ifndef BVXI_TOUCH_BATCH_H
#define BVXI_TOUCH_BATCH_H

#include "touch/surface_voxels.h"

enum { BVXI_TOUCH_BATCH = 128 };

typedef struct bvxi_touch_batch {
    uint32_t triangle[BVXI_TOUCH_BATCH];
    /* corner, axis: relative to the window's low corner */
    int32_t p[3][3][BVXI_TOUCH_BATCH];
    /* of the box, not cut to the window [Units: voxels] */
    int32_t low[3][BVXI_TOUCH_BATCH], high[3][BVXI_TOUCH_BATCH];
} bvxi_touch_batch;

/* Take triangles done .. done + n of those that a tile gets. */
BVXI_VECTOR_INLINE void bvxi_batch_gather(const bvxi_surface_job *job, const uint32_t *id, uint64_t done,
                                          uint32_t n, bvxi_touch_batch *b)
{
    const int32_t *const xyz = job->snapped.xyz;
    int32_t const shift = job->fraction_bits;
    int32_t const ox = job->low[0] * (1 << shift);
    int32_t const oy = job->low[1] * (1 << shift);
    int32_t const oz = job->low[2] * (1 << shift);
    int const packed = bvxi_view_packed_u32(job->view);

    /* Packed indices are copied; others go through the getter, which knows all types. */
    for (uint32_t i = 0; i < n; i++) {
        uint32_t corner[3];
        uint32_t const t = id != NULL ? id[done + i] : job->first + (uint32_t)(done + i);
        b->triangle[i] = t;
        if (packed) memcpy(corner, (const unsigned char *)job->view->indices + (size_t)t * 12, sizeof corner);
        else bvxi_view_triangle(job->view, t, corner);
        for (int c = 0; c < 3; c++) {
            const int32_t *const v = xyz + 3 * (size_t)corner[c];
            b->p[c][0][i] = v[0] - ox;
            b->p[c][1][i] = v[1] - oy;
            b->p[c][2][i] = v[2] - oz;
        }
    }
}

/* low = floor((least + below) / 2^F), high = floor((greatest + above) / 2^F), along each axis. */
BVXI_VECTOR_INLINE void bvxi_batch_boxes(bvxi_touch_batch *b, uint32_t n, int32_t f, int32_t below,
                                         int32_t above)
{
    for (int a = 0; a < 3; a++) {
        const int32_t *BVXI_RESTRICT const p = b->p[0][a], *BVXI_RESTRICT const q = b->p[1][a],
                                           *BVXI_RESTRICT const r = b->p[2][a];
        int32_t *BVXI_RESTRICT const low = b->low[a], *BVXI_RESTRICT const high = b->high[a];
        for (uint32_t i = 0; i < n; i++) {
            int32_t const pq = p[i] < q[i] ? p[i] : q[i], PQ = p[i] < q[i] ? q[i] : p[i];
            int32_t const least = (pq < r[i] ? pq : r[i]) + below, most = (PQ > r[i] ? PQ : r[i]) + above;
            /* The shift of a negative number is not defined in C; its complement is not negative. */
            low[i] = least < 0 ? ~(~least >> f) : least >> f;
            high[i] = most < 0 ? ~(~most >> f) : most >> f;
        }
    }
}

#endif
