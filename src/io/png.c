/* png.c - an image to PNG with stored blocks, so that its bytes depend on the pixels only.
 *
 * Sources: ISO/IEC 15948 (PNG), RFC 1950 (zlib, Adler-32), RFC 1951 (stored blocks).
 * One IDAT chunk holds one zlib stream: blocks of up to 65,535 bytes as they are, each row after a filter
 * byte 0. */
#include "io/formats.h"

enum {
    PNG_SIGNATURE = 8,
    PNG_CHUNK = 12 /* length, type and CRC around a chunk's data */,
    PNG_HEADER = 13,
    ZLIB_AROUND = 6,
    STORED_BLOCK = 65535,
    STORED_HEAD = 5,
    ADLER_MODULUS = 65521,
    ADLER_RUN = 5552 /* bytes that cannot overflow 32 bits before the modulus */
};

typedef struct png_crc {
    uint32_t table[256];
} png_crc;

static void png_crc_init(png_crc *crc)
{
    for (uint32_t i = 0; i < 256; i++) {
        uint32_t c = i;
        for (int bit = 0; bit < 8; bit++) c = (c & 1) != 0 ? 0xedb88320u ^ c >> 1 : c >> 1;
        crc->table[i] = c;
    }
}

static uint32_t png_crc_of(const png_crc *crc, const uint8_t *p, size_t n)
{
    uint32_t c = 0xffffffffu;
    for (size_t i = 0; i < n; i++) c = crc->table[(c ^ p[i]) & 0xff] ^ c >> 8;
    return c ^ 0xffffffffu;
}

uint32_t bvxi_crc32(const uint8_t *bytes, size_t size)
{
    png_crc crc;
    png_crc_init(&crc);
    return png_crc_of(&crc, bytes, size);
}

typedef struct png_adler {
    uint32_t a, b;
} png_adler;

static void png_adler_add(png_adler *s, const uint8_t *p, size_t n)
{
    while (n > 0) {
        size_t const run = n < ADLER_RUN ? n : ADLER_RUN;
        /* So many bytes leave the sums below 2^32 when they
         * start below the modulus; RFC 1950 gives the bound. */
        for (size_t i = 0; i < run; i++) {
            s->a += p[i];
            s->b += s->a;
        }
        s->a %= ADLER_MODULUS;
        s->b %= ADLER_MODULUS;
        p += run;
        n -= run;
    }
}

/* Begin a chunk of n bytes at p; returns where its data goes. */
static uint8_t *png_open(uint8_t *p, uint64_t n, const char *type)
{
    bvxi_store_u32_big(p, (uint32_t)n);
    memcpy(p + 4, type, 4);
    return p + 8;
}

/* Close the chunk that began at p with n bytes of data; returns where the next one goes. */
static uint8_t *png_close(const png_crc *crc, uint8_t *p, uint64_t n)
{
    bvxi_store_u32_big(p + 8 + n, png_crc_of(crc, p + 4, (size_t)n + 4)); /* the type counts too */
    return p + PNG_CHUNK + n;
}

/* Where raw byte number i stands in the stream, its blocks' heads written as they are met. */
typedef struct png_stored {
    uint8_t *p;
    uint64_t left; /* bytes still to come */
    size_t block;  /* of these, in the open block */
    png_adler adler;
} png_stored;

static void png_store(png_stored *s, const uint8_t *bytes, size_t n)
{
    png_adler_add(&s->adler, bytes, n);
    while (n > 0) {
        if (s->block == 0) {
            s->block = s->left < STORED_BLOCK ? (size_t)s->left : STORED_BLOCK;
            s->p[0] = s->block == s->left; /* the last block */
            bvxi_store_u16(s->p + 1, (uint16_t)s->block);
            bvxi_store_u16(s->p + 3, (uint16_t)(s->block ^ 0xffffu));
            s->p += STORED_HEAD;
        }

        size_t const part = n < s->block ? n : s->block;
        memcpy(s->p, bytes, part);
        s->p += part;
        s->block -= part;
        s->left -= part;
        bytes += part;
        n -= part;
    }
}

static void png_put_pixels(uint8_t *p, const bvx_image *image, uint64_t raw)
{
    static const uint8_t filter = 0;
    size_t const row = (size_t)image->width * 3;
    png_stored s = {NULL, 0, 0, {1, 0}};

    /* deflate with a window of 32 KiB; the check bits of the second byte make a multiple of 31 */
    p[0] = 0x78;
    p[1] = 0x01;
    s.p = p + 2;
    s.left = raw;
    /* A filter byte of 0 before each row: its bytes stand as they are. */
    for (int32_t y = 0; y < image->height; y++) {
        png_store(&s, &filter, 1);
        png_store(&s, image->pixels + (size_t)y * row, row);
    }
    bvxi_store_u32_big(s.p, s.adler.b << 16 | s.adler.a);
}

static bvx_status run_write_png(bvx_context *context, const bvx_image *image, bvx_buffer *file)
{
    static const char *const function = "bvx_write_png";
    static const uint8_t signature[PNG_SIGNATURE] = {0x89, 'P', 'N', 'G', 13, 10, 26, 10};
    bvx_buffer made = {0};
    png_crc crc;
    uint8_t *p, *data;
    if (image == NULL) return bvxi_fail_null(context, function, "image");
    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    if (image->pixels == NULL || image->width < 1 || image->height < 1)
        return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: the image of %d x %d pixels is empty", function,
                         (int64_t)image->width, (int64_t)image->height);

    /* The size follows from the image, as nothing is compressed: the buffer is made once, exactly. */
    uint64_t const raw = (uint64_t)image->height * (1 + 3 * (uint64_t)image->width); /* below 2^64 */
    uint64_t const stream = raw / STORED_BLOCK * (STORED_BLOCK + STORED_HEAD) + ZLIB_AROUND +
                            (raw % STORED_BLOCK != 0 ? STORED_HEAD + raw % STORED_BLOCK : 0);
    if (raw > INT32_MAX || stream > INT32_MAX) /* a chunk's limit */
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: %d x %d pixels are more than one PNG chunk holds",
                         function, (int64_t)image->width, (int64_t)image->height);
    BVXI_TRY(bvxi_make_buffer(context, PNG_SIGNATURE + 3 * PNG_CHUNK + PNG_HEADER + stream, "the PNG file",
                              &made));

    png_crc_init(&crc);
    memcpy(made.bytes, signature, PNG_SIGNATURE);
    p = made.bytes + PNG_SIGNATURE;
    data = png_open(p, PNG_HEADER, "IHDR");
    bvxi_store_u32_big(data, (uint32_t)image->width);
    bvxi_store_u32_big(data + 4, (uint32_t)image->height);
    /* 8 bits, red green blue, deflate, filters by row, not interlaced */
    memcpy(data + 8, "\x08\x02\0\0\0", 5);
    p = png_close(&crc, p, PNG_HEADER);
    png_put_pixels(png_open(p, stream, "IDAT"), image, raw);
    p = png_close(&crc, p, stream);
    png_open(p, 0, "IEND");
    png_close(&crc, p, 0);
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_png(bvx_context *context, const bvx_image *image, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_png(context, image, file));
}
