/* json.h - a JSON text as a flat array of values, in the order of the text. Not installed. */
#ifndef BVXI_JSON_H
#define BVXI_JSON_H

#include "io/formats.h"

enum {
    BVXI_JSON_NULL,
    BVXI_JSON_FALSE,
    BVXI_JSON_TRUE,
    BVXI_JSON_NUMBER,
    BVXI_JSON_TEXT,
    BVXI_JSON_ARRAY,
    BVXI_JSON_OBJECT
};

enum { BVXI_JSON_DEPTH = 64 };           /* arrays and objects in each other */
#define BVXI_JSON_NONE  UINT32_MAX       /* no value */
#define BVXI_JSON_LIMIT (UINT32_MAX / 8) /* bytes of a text, so that counts fit beside the kind */

/* A value; an object's members are their names and values in turn. What a value holds follows it. */
typedef struct bvxi_json_value {
    uint32_t at, size; /* in the text, with quotes or brackets */
    uint32_t next;     /* the value after it and all that it holds */
    uint32_t shape;    /* items or members * 8 + BVXI_JSON_... */
} bvxi_json_value;

typedef struct bvxi_json {
    const bvxi_source *source; /* for messages */
    const char *text;
    bvxi_json_value *value; /* scratch; the first is the text's own [Size: count] */
    uint32_t count;
} bvxi_json;

/* Read a text that lies within the source. Scratch: 16 bytes a value, at most 8 times the text. */
bvx_status bvxi_json_read(bvxi_source *source, const char *text, uint64_t size, bvxi_json *json);

/* All of these take BVXI_JSON_NONE for a value that is not there. */
static inline int bvxi_json_kind(const bvxi_json *json, uint32_t value)
{
    return value == BVXI_JSON_NONE ? BVXI_JSON_NULL : (int)(json->value[value].shape & 7);
}

/* Items of an array or members of an object; 0 of anything else. */
static inline uint32_t bvxi_json_count(const bvxi_json *json, uint32_t value)
{
    return value == BVXI_JSON_NONE ? 0 : json->value[value].shape >> 3;
}

/* The first byte of a text inside its quotes, and how many there are; escapes are not replaced. */
static inline const char *bvxi_json_text(const bvxi_json *json, uint32_t value, uint32_t *size)
{
    *size = json->value[value].size - 2;
    return json->text + json->value[value].at + 1;
}

/* The member of an object, among its first 256; BVXI_JSON_NONE where it has none, or the value is no object. */
uint32_t bvxi_json_member(const bvxi_json *json, uint32_t object, const char *name);
/* 1 when a value is this text. */
int bvxi_json_is(const bvxi_json *json, uint32_t value, const char *text);
/* A number's value; 0 of anything else. */
double bvxi_json_number(const bvxi_json *json, uint32_t value);
/* A text with its escapes replaced, as UTF-8, and a zero byte after it; to has its size + 1 bytes. Returns the
 * bytes before the zero. */
uint32_t bvxi_json_plain(const bvxi_json *json, uint32_t value, char *to);

#endif
