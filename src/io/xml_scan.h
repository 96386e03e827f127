/* xml_scan.h - the tags of an XML text one after the other, without a tree and without a heap, as VTK's
 * files need it; and bytes written in base 64. Not installed. */
#ifndef BVXI_XML_SCAN_H
#define BVXI_XML_SCAN_H

#include "io/formats.h"

/* ---- The tags of an XML text one after the other ---- */

enum { BVXI_XML_DEPTH = 16 };
enum { BVXI_XML_OPEN = 1, BVXI_XML_CLOSE, BVXI_XML_END };

typedef struct bvxi_xml_text {
    const char *p, *end;
} bvxi_xml_text;

typedef struct bvxi_xml {
    bvxi_source source;                 /* for messages, and where the text ends */
    const char *p;                      /* after the last tag */
    const char *tag;                    /* the last tag's '<' */
    bvxi_xml_text open[BVXI_XML_DEPTH]; /* names of the elements around p, the root first */
    bvxi_xml_text attributes;           /* of the last opening tag */
    int32_t depth;
    int32_t event; /* of the last tag: BVXI_XML_... */
    /* the last tag opened and closes (<a/>): its closing is reported next */
    int32_t is_empty;
} bvxi_xml;

void bvxi_xml_start(bvxi_xml *x, bvx_context *ctx, const char *format, const uint8_t *begin,
                    const uint8_t *end);
/* The next tag goes to x->event; text, comments and processing instructions are passed over. An element that
 * opens is the last of x->open; one that closes is not there any more. */
bvx_status bvxi_xml_next(bvxi_xml *x);
/* 1 when the open elements are those of path: "VTKFile/ImageData". */
int bvxi_xml_is_at(const bvxi_xml *x, const char *path);
/* The value of an attribute of the last opening tag, as it stands between its quotes; 0 when there is
 * none. */
int bvxi_xml_attribute(const bvxi_xml *x, const char *name, bvxi_xml_text *value);
/* 1 when two values mean the same, entities replaced. */
int bvxi_xml_same(bvxi_xml_text a, bvxi_xml_text b);
/* 1 when a value, entities not looked at, is this word. */
int bvxi_xml_is(bvxi_xml_text value, const char *word);

/* ---- Bytes written in base 64 ---- */

typedef struct bvxi_base64 {
    const char *p, *end;
    uint8_t digit[256]; /* what a character stands for; 64: nothing, 65: padding, 66: space */
    uint8_t held[3];    /* bytes of the last group that nobody took */
    int32_t held_count;
} bvxi_base64;

void bvxi_base64_start(bvxi_base64 *b, const char *p, const char *end);
/* Take the next count bytes; 0 when there are fewer or a character is none of base 64: it stands at b->p. */
int bvxi_base64_take(bvxi_base64 *b, uint8_t *bytes, uint64_t count);

#endif
