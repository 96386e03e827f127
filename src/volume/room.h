/* room.h - volumes of samples, for other rooms: views checked and read, and samples to rows of bits by any
 * rule, whichever axis runs fastest. Not installed. */
#ifndef BVXI_VOLUME_ROOM_H
#define BVXI_VOLUME_ROOM_H

#include "grid/grid.h"

/* Bytes of a sample; 0 for no type. */
static inline uint32_t bvxi_type_size(int32_t type)
{
    static const uint8_t size[11] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return type >= 1 && type <= 10 ? size[type] : 0;
}

/* Refuse an invalid view, naming the field; stride becomes its strides, packed ones written out. */
bvx_status bvxi_volume_check(bvx_context *ctx, const char *function, const bvx_volume_view *volume,
                             int64_t stride[3]);

/* A sample as a double; 64-bit whole numbers are rounded. */
static inline double bvxi_sample_value(const uint8_t *p, int32_t type)
{
#define BVXI_VALUE_CASE(name, c_type) \
    case name: {                      \
        c_type v;                     \
        memcpy(&v, p, sizeof v);      \
        return (double)v;             \
    }
    switch (type) {
        BVXI_VALUE_CASE(BVX_SAMPLE_F32, float)
        BVXI_VALUE_CASE(BVX_SAMPLE_U8, uint8_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_I8, int8_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_U16, uint16_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_I16, int16_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_U32, uint32_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_I32, int32_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_U64, uint64_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_I64, int64_t)
        BVXI_VALUE_CASE(BVX_SAMPLE_F64, double)
    default: return 0.0;
    }
#undef BVXI_VALUE_CASE
}

/* The bits of a sample that is a whole number, as 64. */
static inline uint64_t bvxi_whole_sample(const uint8_t *p, int32_t type)
{
    uint16_t v16;
    uint32_t v32;
    uint64_t v64;

    switch (type) {
    case BVX_SAMPLE_U8: return *p;
    case BVX_SAMPLE_I8: return (uint64_t)(int64_t)(*p < 128 ? *p : *p - 256);
    case BVX_SAMPLE_U16:
    /* Copied byte by byte: samples need not be aligned. */
    case BVX_SAMPLE_I16:
        memcpy(&v16, p, sizeof v16);
        return type == BVX_SAMPLE_U16 || v16 < 32768 ? v16 : v16 | ~UINT64_C(0xffff);
    case BVX_SAMPLE_U32:
    case BVX_SAMPLE_I32:
        memcpy(&v32, p, sizeof v32);
        return type == BVX_SAMPLE_U32 || v32 < UINT32_C(0x80000000) ? v32 : v32 | ~UINT64_C(0xffffffff);
    default: memcpy(&v64, p, sizeof v64); return v64;
    }
}

/* n numbers, stride bytes apart, to (n + 63) / 64 words; bits after the
 * last are 0. tally is the piece's own. */
typedef void bvxi_bits_fn(const void *rule, void *tally, const uint8_t *p, int64_t stride, int32_t n,
                          uint64_t *words);

/* n numbers beside one another of each of up to 64 columns, stride bytes apart: bit c of rows[i] is number i
 * of column c. The numbers `ahead` bytes further are those that the next call reads. */
typedef void bvxi_columns_fn(const void *rule, const uint8_t *p, int64_t stride, int32_t columns, int32_t n,
                             int64_t ahead, uint64_t *rows);

typedef struct bvxi_sample_walk {
    const uint8_t *first; /* sample of the grid's voxel (0,0,0) */
    int64_t stride[3];    /* [Units: bytes] */
    bvxi_bits_fn *run;
    bvxi_columns_fn
        *columns; /* run, then turned, where numbers are side by side and nothing is counted; or NULL */
    const void *rule;
    void *tallies;        /* one for each piece, or NULL */
    size_t tally_size;    /* [Units: bytes] */
    bvx_grid *grid;       /* opened; all its words are written */
    int32_t axis, pieces; /* that runs fastest; set by bvxi_sample_walk_plan */
} bvxi_sample_walk;

/* Choose axis and pieces from strides and grid; then tallies may be made. */
void bvxi_sample_walk_plan(bvxi_sample_walk *walk);
/* Every number of the grid's window goes through the rule once. */
bvx_status bvxi_samples_to_bits(bvx_context *ctx, const char *stage, double from, double to,
                                bvxi_sample_walk *walk);

/* Bit i of the result is byte i of eight, each 0 or 1; the lowest byte is the first. */
static inline uint64_t bvxi_gather_bits(uint64_t bytes)
{
    return bytes * UINT64_C(0x0102040810204080) >> 56;
}

/* Bit i is byte i of p, each 0 or 1. */
static inline uint64_t bvxi_flags_to_word(const uint8_t p[64])
{
    uint64_t w = 0;
    for (int32_t i = 0; i < 8; i++) {
        const uint8_t *const q = p + 8 * i;
        uint64_t const v = (uint64_t)q[0] | (uint64_t)q[1] << 8 | (uint64_t)q[2] << 16 |
                           (uint64_t)q[3] << 24 | (uint64_t)q[4] << 32 | (uint64_t)q[5] << 40 |
                           (uint64_t)q[6] << 48 | (uint64_t)q[7] << 56;
        w |= bvxi_gather_bits(v) << 8 * i;
    }
    return w;
}

/* The least and the greatest sample of a type that lie in a range: doubles
 * are no sample's type but one, so the ends are moved inwards to numbers
 * that the type has. Exact: v is in the range just when low <= v <= high. */
typedef struct bvxi_range {
    int32_t type, empty;
    union {
        uint64_t u;
        int64_t i;
        float f;
        double d;
    } low, high;
} bvxi_range;

void bvxi_range_make(int32_t type, double low, double high, bvxi_range *range);

/* Counts of one piece of samples; least and greatest start at the greatest double and its negative. */
typedef struct bvxi_range_tally {
    uint64_t nan, infinite, inside;
    double least, greatest;
} bvxi_range_tally;

/* Threshold a checked view into an open grid; report may be NULL. */
bvx_status bvxi_threshold(bvxi_call call, const bvx_volume_view *volume, const int64_t stride[3],
                          const bvxi_range *range, bvx_volume_report *report, bvx_grid *grid);

/* labels.c: bvx_list_labels of a checked view, less another value than 0; labels is a result, freed by callers. */
bvx_status bvxi_make_label_list(bvx_context *ctx, const bvx_volume_view *volume, const int64_t stride[3],
                                uint64_t skip, bvx_label **labels, uint64_t *count);

#endif
