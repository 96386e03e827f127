/* text.c - text that grows, and the pieces that JSON is made of.
 *
 * Independent of stdio's streams, so that any thread may use it whatever another one is printing. */
#include "cli_shell/shell.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

static int make_room(cli_text *t, size_t more)
{
    size_t room = t->room != 0 ? t->room : 256;

    /* One byte more than the text, for its end; doubling keeps the copies few. */
    while (room - t->size <= more) {
        if (room > SIZE_MAX / 2) return 0;
        room *= 2;
    }
    if (room == t->room) return 1;
    char *const bytes = realloc(t->bytes, room);
    if (bytes == NULL) return 0;
    t->bytes = bytes;
    t->room = room;
    return 1;
}

void cli_text_add(cli_text *t, const char *format, ...)
{
    va_list args;

    va_start(args, format);
    /* Counted first: what does not fit is left out whole, not cut. */
    int length = vsnprintf(NULL, 0, format, args);
    va_end(args);
    if (length < 0 || t->failed || !make_room(t, (size_t)length)) {
        t->failed = 1;
        return;
    }
    va_start(args, format);
    vsnprintf(t->bytes + t->size, (size_t)length + 1, format, args);
    va_end(args);
    t->size += (size_t)length;
}

void cli_text_free(cli_text *t)
{
    free(t->bytes);
    t->bytes = NULL;
    t->size = t->room = 0;
}

int cli_utf8_length(const char *text)
{
    const unsigned char *const p = (const unsigned char *)text;
    int const n = p[0] < 0x80                   ? 1
                  : p[0] >= 0xc2 && p[0] < 0xe0 ? 2
                  : p[0] >= 0xe0 && p[0] < 0xf0 ? 3
                  : p[0] >= 0xf0 && p[0] < 0xf5 ? 4
                                                : 0;
    for (int i = 1; i < n; i++)
        if ((p[i] & 0xc0) != 0x80) return 0;
    /* Sequences that spell what a shorter one does, or no character, are not UTF-8. */
    if ((p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xed && p[1] > 0x9f)) return 0; /* overlong, surrogates */
    /* overlong, beyond Unicode */
    if ((p[0] == 0xf0 && p[1] < 0x90) || (p[0] == 0xf4 && p[1] > 0x8f)) return 0;
    return n;
}

void cli_json_string(cli_text *t, const char *string)
{
    const unsigned char *p = (const unsigned char *)string;

    cli_text_add(t, "\"");
    while (*p != 0) {
        int const n = cli_utf8_length((const char *)p);
        if (n == 0) cli_text_add(t, "\\ufffd"); /* file names may be any bytes */
        else if (*p == '"' || *p == '\\') cli_text_add(t, "\\%c", *p);
        else if (*p < 32 || *p == 127) cli_text_add(t, "\\u%04x", *p);
        else cli_text_add(t, "%.*s", n, (const char *)p);
        p += n == 0 ? 1 : n;
    }
    cli_text_add(t, "\"");
}

/* The shortest of three that reads back. */
void cli_json_number(cli_text *t, double v)
{
    char text[40];

    /* JSON has neither infinity nor NaN. */
    if (v - v != 0.0) {
        cli_text_add(t, "null");
        return;
    }
    /* 17 digits always read back; most numbers need fewer. */
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, v);
        if (strtod(text, NULL) == v) break;
    }
    cli_text_add(t, "%s", text);
}

void cli_json_key(cli_text *t, const char *key, int first)
{
    cli_text_add(t, "%s\"%s\": ", first ? "" : ", ", key);
}

void cli_json_count(cli_text *t, const char *key, uint64_t v)
{
    cli_json_key(t, key, 0);
    cli_text_add(t, "%" PRIu64, v);
}

void cli_json_value(cli_text *t, const char *key, double v)
{
    cli_json_key(t, key, 0);
    cli_json_number(t, v);
}

void cli_json_truth(cli_text *t, const char *key, int v)
{
    cli_json_key(t, key, 0);
    cli_text_add(t, "%s", v ? "true" : "false");
}

void cli_json_triple(cli_text *t, const char *key, const double v[3])
{
    cli_json_key(t, key, 0);
    for (int a = 0; a < 3; a++) {
        cli_text_add(t, a == 0 ? "[" : ", ");
        cli_json_number(t, v[a]);
    }
    cli_text_add(t, "]");
}

void cli_json_ints(cli_text *t, const char *key, const int32_t v[3])
{
    cli_json_key(t, key, 0);
    cli_text_add(t, "[%" PRId32 ", %" PRId32 ", %" PRId32 "]", v[0], v[1], v[2]);
}

void cli_json_box(cli_text *t, const char *key, const double low[3], const double high[3])
{
    cli_json_key(t, key, 0);
    cli_text_add(t, "[[%.9g, %.9g, %.9g], [%.9g, %.9g, %.9g]]", low[0], low[1], low[2], high[0], high[1],
                 high[2]);
}
