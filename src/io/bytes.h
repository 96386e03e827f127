/* bytes.h - numbers in files: either byte order on any machine at any address, and output that is counted
 * first.
 *
 * Compilers make single instructions of the shifts. Stores all write the order that our own files have:
 * little-endian, but for PNG's big-endian words. */
#ifndef BVXI_BYTES_H
#define BVXI_BYTES_H

#include "bitvox_io.h"
#include "core/core.h"

static inline uint16_t bvxi_load_u16(const uint8_t *p, int big)
{
    return (uint16_t)(big ? p[0] << 8 | p[1] : p[1] << 8 | p[0]);
}

static inline uint32_t bvxi_load_u32(const uint8_t *p, int big)
{
    return big ? (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | (uint32_t)p[3]
               : (uint32_t)p[3] << 24 | (uint32_t)p[2] << 16 | (uint32_t)p[1] << 8 | (uint32_t)p[0];
}

static inline uint64_t bvxi_load_u64(const uint8_t *p, int big)
{
    uint64_t const first = bvxi_load_u32(p, big), second = bvxi_load_u32(p + 4, big);
    return big ? first << 32 | second : second << 32 | first;
}

static inline float bvxi_load_f32(const uint8_t *p, int big)
{
    uint32_t const bits = bvxi_load_u32(p, big);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static inline double bvxi_load_f64(const uint8_t *p, int big)
{
    uint64_t const bits = bvxi_load_u64(p, big);
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static inline void bvxi_store_u16(uint8_t *p, uint16_t v)
{
    p[0] = (uint8_t)(v & 0xff);
    p[1] = (uint8_t)(v >> 8);
}

static inline void bvxi_store_u32(uint8_t *p, uint32_t v)
{
    p[0] = (uint8_t)(v & 0xff);
    p[1] = (uint8_t)(v >> 8 & 0xff);
    p[2] = (uint8_t)(v >> 16 & 0xff);
    p[3] = (uint8_t)(v >> 24);
}

static inline void bvxi_store_u64(uint8_t *p, uint64_t v)
{
    bvxi_store_u32(p, (uint32_t)(v & 0xffffffffu));
    bvxi_store_u32(p + 4, (uint32_t)(v >> 32));
}

static inline void bvxi_store_u32_big(uint8_t *p, uint32_t v)
{
    p[0] = (uint8_t)(v >> 24);
    p[1] = (uint8_t)(v >> 16 & 0xff);
    p[2] = (uint8_t)(v >> 8 & 0xff);
    p[3] = (uint8_t)(v & 0xff);
}

static inline void bvxi_store_f32(uint8_t *p, float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    bvxi_store_u32(p, bits);
}

static inline void bvxi_store_f64(uint8_t *p, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    bvxi_store_u64(p, bits);
}

/* ---- output: the same code runs twice, to count (bytes NULL) and to write ---- */

typedef struct bvxi_output {
    uint8_t *bytes;
    uint64_t size; /* counted or written so far */
} bvxi_output;

static inline void bvxi_output_add(bvxi_output *o, const void *bytes, size_t n)
{
    if (o->bytes != NULL) memcpy(o->bytes + o->size, bytes, n);
    o->size += n;
}

static inline void bvxi_output_u32(bvxi_output *o, uint64_t v)
{
    uint8_t b[4];
    bvxi_store_u32(b, (uint32_t)v);
    bvxi_output_add(o, b, 4);
}

/* Text with values: %s a text, %q one as a JSON string, %u a uint64_t, %d an int64_t, %g a double as the
 * shortest decimals that read back to it; %v three doubles and %w three int32_t that are not negative, each by its address and
 * the text between. */
void bvxi_output_print(bvxi_output *o, const char *format, ...);

#endif
