/* base64.h - bytes written in base 64. Not installed. */
#ifndef BVXI_BASE64_H
#define BVXI_BASE64_H

#include "core/core.h"

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
