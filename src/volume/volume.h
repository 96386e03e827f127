/* volume.h - views of scalar volumes, checked and read. Not installed. */
#ifndef BVXI_VOLUME_H
#define BVXI_VOLUME_H

#include "core/core.h"

/* Bytes of a sample; 0 for no type. */
static inline uint32_t bvxi_type_size(int32_t type)
{
    static const uint8_t size[11] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return type >= 1 && type <= 10 ? size[type] : 0;
}

/* Refuse a view that is none, naming the field; stride becomes its strides, packed ones written out. */
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

#endif
