/* sparse.h - values on the set voxels of a grid: the index of a value is the rank of its bit. Not installed.
 *
 *   bvxi_sparse_open(ctx, like, &s);   set bits of s.where
 *   bvxi_sparse_rank(ctx, &s);         first and count follow from the bits
 *   bvxi_sparse_columns(ctx, &s, BVX_F64, BVXI_VECTORS | BVXI_DISTANCES);
 *   value first[row] + n belongs to set voxel n of the row
 *   bvxi_sparse_close(ctx, &s);
 */
#ifndef BVXI_SPARSE_H
#define BVXI_SPARSE_H

#include "grid/grid.h"

enum { BVXI_VECTORS = 1, BVXI_DISTANCES = 2, BVXI_TRIANGLES = 4 };

/* Columns that are not there are NULL. */
typedef struct bvxi_sparse {
    bvx_grid where;
    uint64_t *first; /* index of each row's first value [Size: rows + 1] */
    uint64_t count;
    int32_t value_type; /* of vectors and distances: BVX_F32 or BVX_F64 */
    void *vectors;      /* x y z [Size: 3 * count] */
    void *distances;    /* [Size: count] */
    uint32_t *triangles;
    uint8_t *features; /* as bvx_closest_point.feature */
} bvxi_sparse;

/* Words for the window of a grid, unspecified contents; no values yet. Scratch, as all below. */
bvx_status bvxi_sparse_open(bvx_context *ctx, const bvx_grid *like, bvxi_sparse *s);
bvx_status bvxi_sparse_rank(bvx_context *ctx, bvxi_sparse *s);
bvx_status bvxi_sparse_columns(bvx_context *ctx, bvxi_sparse *s, int32_t value_type, uint32_t columns);
void bvxi_sparse_close(bvx_context *ctx, bvxi_sparse *s);

/* first[row] becomes the number of set voxels before the row [Size: rows + 1]; returns how many there are. */
uint64_t bvxi_sparse_number(const bvx_grid *where, uint64_t *first);

/* The values of a caller's field, which stay the field's. */
bvxi_sparse bvxi_sparse_of_field(const bvx_field *field);

/* Refuse a field whose row_values and value_count are not those of its band's bits, by which no search checks them. */
bvx_status bvxi_sparse_check(bvx_context *ctx, const char *function, const bvx_field *field);

/* Index of the value at a voxel of the window that is set. */
static inline uint64_t bvxi_sparse_index(const bvxi_sparse *s, int32_t x, int32_t y, int32_t z)
{
    uint64_t const row = (uint64_t)z * (uint64_t)s->where.size[1] + (uint64_t)y;
    const uint64_t *const words = s->where.words + row * (uint64_t)s->where.words_per_row;
    uint64_t n = s->first[row] + bvxi_popcount(words[x >> 6] & ((UINT64_C(1) << (x & 63)) - 1));
    for (int32_t k = 0; k < x >> 6; k++) n += bvxi_popcount(words[k]);
    return n;
}

#endif
