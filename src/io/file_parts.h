/* file_parts.h - files made of long runs of equal things, such as vertices and then triangles, whose text is
 * written by several threads and joined. Not installed.
 *
 * Guarantee: the bytes do not depend on the threads. */
#ifndef BVXI_FILE_PARTS_H
#define BVXI_FILE_PARTS_H

#include "io/bytes.h"

/* One run: vertices, triangles. put writes those from begin to end at a place and returns where it ended. */
typedef struct bvxi_file_part {
    uint64_t count; /* below 2^33 */
    uint64_t most;  /* bytes that one of them takes at most, below 2^20 */
    uint8_t *(*put)(const void *user, uint64_t begin, uint64_t end, uint8_t *at);
    const void *user;
} bvxi_file_part;

/* Make a file of head bytes, which the caller fills when this has succeeded, and of parts one after the
 * other. The file's capacity is what it would take at most. Its share of the progress is from .. 1.
 * BVX_ERR_MEMORY, BVX_ERR_BUDGET, BVX_CANCELLED: nothing is left then. */
bvx_status bvxi_make_file(bvx_context *ctx, const char *what, double from, uint64_t head,
                          const bvxi_file_part *part, int32_t parts, bvx_buffer *file);

/* ---- text ---- */

/* -100000000000000000000 and -0.0000012345678901234567 */
enum { BVXI_FLOAT_MOST = 22, BVXI_DOUBLE_MOST = 25 };

static inline uint64_t bvxi_digits(uint64_t v)
{
    uint64_t n = 1;
    for (; v > 9; v /= 10) n++;
    return n;
}

static inline uint8_t *bvxi_put_char(uint8_t *at, char c)
{
    *at = (uint8_t)c;
    return at + 1;
}

static inline uint8_t *bvxi_put_number(uint8_t *at, uint64_t v)
{
    uint64_t const n = bvxi_digits(v);
    for (uint64_t i = n; i-- > 0; v /= 10) at[i] = (uint8_t)('0' + v % 10);
    return at + n;
}

/* The shortest decimal that reads back to the same float or double; one byte after it is written too. */
static inline uint8_t *bvxi_put_float(uint8_t *at, float v)
{
    return at + bvxi_print_float(v, (char *)at);
}

static inline uint8_t *bvxi_put_double(uint8_t *at, double v)
{
    return at + bvxi_print_double(v, (char *)at);
}

#endif
