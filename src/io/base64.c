/* base64.c - bytes written in base 64.
 *
 * Source: RFC 4648, section 4. White space is passed over. Padding ends a group, not the text: what writers
 * encode piece by piece (a length, then the data) reads as one. */
#include "io/xml_scan.h"

enum { BASE64_NONE = 64, BASE64_PADDING = 65, BASE64_SPACE = 66 };

void bvxi_base64_start(bvxi_base64 *b, const char *p, const char *end)
{
    static const char alphabet[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    memset(b, 0, sizeof *b);
    memset(b->digit, BASE64_NONE, sizeof b->digit);
    for (uint8_t i = 0; i < 64; i++) b->digit[(unsigned char)alphabet[i]] = i;
    b->digit['='] = BASE64_PADDING;
    b->digit[' '] = b->digit['\n'] = b->digit['\r'] = b->digit['\t'] = BASE64_SPACE;
    b->p = p;
    b->end = end;
}

/* Four characters that may have spaces between and padding at the end, into held. */
static int base64_group(bvxi_base64 *b)
{
    uint32_t bits = 0;
    int32_t digits = 0, padding = 0;

    for (; digits + padding < 4; b->p++) {
        if (b->p == b->end) return 0;
        uint8_t const d = b->digit[(unsigned char)*b->p];
        if (d == BASE64_SPACE) continue;
        /* Padding stands for the third or fourth digit, and only
         * padding follows it. A wrong character stays at p. */
        if (d == BASE64_NONE || (d == BASE64_PADDING ? digits < 2 : padding > 0)) return 0;
        if (d == BASE64_PADDING) padding++;
        else digits++;
        bits = bits << 6 | (d == BASE64_PADDING ? 0u : d);
    }
    /* Two, three or four digits carry one, two or three
     * whole bytes; the bits beyond them are not looked at. */
    b->held_count = digits - 1;
    b->held[0] = (uint8_t)(bits >> 16 & 0xff);
    b->held[1] = (uint8_t)(bits >> 8 & 0xff);
    b->held[2] = (uint8_t)(bits & 0xff);
    return 1;
}

static uint64_t base64_plain(bvxi_base64 *b, uint8_t *BVXI_RESTRICT bytes, uint64_t groups)
{
    const uint8_t *const digit = b->digit;
    const char *p = b->p;
    uint64_t const there = (uint64_t)(b->end - p) / 4, most = groups < there ? groups : there;
    uint64_t n = 0;

    for (; n < most; n++, p += 4, bytes += 3) {
        uint32_t const d0 = digit[(unsigned char)p[0]], d1 = digit[(unsigned char)p[1]];
        uint32_t const d2 = digit[(unsigned char)p[2]], d3 = digit[(unsigned char)p[3]];
        /* Digits are below 64 and everything else is 64 or has that bit: one test for four characters. */
        if ((d0 | d1 | d2 | d3) >= BASE64_NONE) break;
        bytes[0] = (uint8_t)(d0 << 2 | d1 >> 4);
        bytes[1] = (uint8_t)((d1 << 4 | d2 >> 2) & 0xff);
        bytes[2] = (uint8_t)((d2 << 6 | d3) & 0xff);
    }
    b->p = p;
    return n;
}

int bvxi_base64_take(bvxi_base64 *b, uint8_t *bytes, uint64_t count)
{
    /* Plain groups go straight to the caller. One with spaces or
     * padding, or whose bytes are not all wanted yet, is held. */
    while (count > 0) {
        uint64_t const plain = b->held_count == 0 ? base64_plain(b, bytes, count / 3) : 0;
        bytes += 3 * plain;
        count -= 3 * plain;
        if (count == 0) break;
        if (b->held_count == 0 && !base64_group(b)) return 0;
        while (count > 0 && b->held_count > 0) {
            *bytes++ = b->held[0];
            b->held[0] = b->held[1];
            b->held[1] = b->held[2];
            b->held_count--;
            count--;
        }
    }
    return 1;
}
