/* formats.h - what readers and writers of all formats share: the source that a reader walks (with progress
 * and failures that name the byte or line), its words, and the buffer that a writer fills. Not installed. */
#ifndef BVXI_FORMATS_H
#define BVXI_FORMATS_H

#include "core/core.h"
#include "io/bytes.h"

/* The bytes of a file, and where reading reports progress next. */
typedef struct bvxi_source {
    bvx_context *ctx;
    const char *format; /* "STL", for messages */
    const char *begin, *end;
    const char *ask;   /* progress is reported when reading comes here */
    double from, to;   /* share of this pass over the bytes */
    double reached;    /* the greatest fraction reported: it never falls when bytes are read again */
    int32_t takes_any; /* 1: coordinates that are not finite are taken, to be dropped later */
} bvxi_source;

/* Start a pass over the bytes that is the part [from, to] of the work. */
void bvxi_source_pass(bvxi_source *source, double from, double to);
bvx_status bvxi_source_ask(bvxi_source *source, const char *at);

/* Report progress once a megabyte; BVX_CANCELLED when the caller wants to stop. */
static inline bvx_status bvxi_source_at(bvxi_source *source, const char *at)
{
    return BVXI_LIKELY(at < source->ask) ? BVX_OK : bvxi_source_ask(source, at);
}

/* Keep a message and return the status, a BVX_ERR_... before the format. Pieces of a file may be read at the
 * same time. Each has a source of its own without context: there a failure is a status only, and the piece
 * that failed first is read again with the context, for its message. */
#define BVXI_FILE_FAIL(source, status, ...) BVXI_FILE_FAIL_FOR(source, status, BVX_REASON_NONE, __VA_ARGS__)
#define BVXI_LINE_FAIL(source, at, status, ...) \
    BVXI_LINE_FAIL_FOR(source, at, status, BVX_REASON_NONE, __VA_ARGS__)
#define BVXI_BYTE_FAIL(source, at, status, ...)                                                           \
    bvxi_fail_at((source)->ctx, (source)->format, "byte",                                                 \
                 (uint64_t)((const char *)(at) - (const char *)(source)->begin), status, BVX_REASON_NONE, \
                 __VA_ARGS__)
#define BVXI_FILE_FAIL_FOR(source, ...) bvxi_fail_at((source)->ctx, (source)->format, NULL, 0, __VA_ARGS__)
#define BVXI_LINE_FAIL_FOR(source, at, ...) \
    bvxi_fail_at((source)->ctx, (source)->format, "line", bvxi_source_line(source, at), __VA_ARGS__)

/* Run count tasks, each for about BVXI_PIECE_BYTES of the file, as the part [from, to] of the work. */
enum { BVXI_PIECE_BYTES = 1 << 19 };
bvx_status bvxi_source_pieces(bvxi_source *source, double from, double to, int32_t count, bvxi_item_fn *task,
                              void *user);

/* "STL: line 7: expected ..., found '...'": what stands at a place of a text file. */
BVXI_COLD bvx_status bvxi_fail_expected(const bvxi_source *source, const char *at, const char *expected);
/* Lines are counted from 1; 0 without a context, as a piece knows no line. */
BVXI_COLD uint64_t bvxi_source_line(const bvxi_source *source, const char *at);
static inline uint64_t bvxi_source_byte(const bvxi_source *source, const void *at)
{
    return (uint64_t)((const char *)at - source->begin);
}

/* ---- text ---- */

/* Space between words of one line; a carriage return is one, so that both kinds of line ends are read. */
static inline int bvxi_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

extern const char bvxi_axis_name[3][2];

/* Which of some names parted by '|', in lower case, the n characters are, in either case of letters: from 1 on;
 * 0: none. */
int32_t bvxi_word_is(const char *text, size_t n, const char *names);

static inline int bvxi_is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static inline const char *bvxi_skip_space(const char *p, const char *end)
{
    while (p < end && bvxi_is_space(*p)) p++;
    return p;
}

static inline const char *bvxi_skip_word(const char *p, const char *end)
{
    while (p < end && !bvxi_is_space(*p)) p++;
    return p;
}

/* A whole number at *p with an optional sign; very large ones stay very large. 0 when there is none. */
static inline int bvxi_take_integer(const char **p, const char *end, int64_t *value)
{
    const char *t = *p;
    int const negative = t < end && *t == '-';
    int64_t v = 0;
    unsigned d;

    t += negative || (t < end && *t == '+');
    const char *const digits = t, *const safe = end - t > 18 ? t + 18 : end; /* 18 digits always fit */
    for (; t < safe && (d = (unsigned)(unsigned char)*t - '0') <= 9; t++) v = v * 10 + (int64_t)d;
    if (t == digits) return 0;
    if (BVXI_UNLIKELY(t == safe))
        for (; t < end && (d = (unsigned)(unsigned char)*t - '0') <= 9; t++)
            if (v < INT64_C(100000000000000000)) v = v * 10 + (int64_t)d;
    *value = negative ? -v : v;
    *p = t;
    return 1;
}

/* A byte order mark is no part of the text. */
static inline const char *bvxi_skip_mark(const char *p, const char *end)
{
    return end - p >= 3 && memcmp(p, "\xef\xbb\xbf", 3) == 0 ? p + 3 : p;
}

/* Refuse arguments that are no bytes of a file. */
bvx_status bvxi_check_bytes(bvx_context *ctx, const char *function, const void *bytes, uint64_t size);
/* A file to be made: bytes that the library made for another one go; those of others are refused. */
bvx_status bvxi_renew_buffer(bvx_context *ctx, const char *function, bvx_buffer *file);
/* png.c: the check sum of PNG and zip. */
uint32_t bvxi_crc32(const uint8_t *bytes, size_t size);
/* A buffer of exactly size bytes. */
bvx_status bvxi_make_buffer(bvx_context *ctx, uint64_t size, const char *what, bvx_buffer *file);

/* format.c: refuse a format that is not one of a set of the header's
 * (BVX_MESHES_READ ...), with the endings of those. */
BVXI_COLD bvx_status bvxi_fail_format(bvx_context *ctx, bvx_status status, const char *function,
                                      const char *what, int32_t format, int32_t set);

#endif
