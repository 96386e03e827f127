/* json.c - a JSON text to a flat array of its values.
 *
 * Source: Bray. The JavaScript Object Notation (JSON) Data Interchange Format. RFC 8259. 2017.
 *
 * One loop walks over the text and keeps the open arrays and objects in a list of fixed length, so no text can
 * exhaust the stack. It runs twice: the first walk checks all and counts, the second one fills an array of
 * exactly that size. Guarantee: what is not JSON is refused, with its byte; of members of one name the first
 * counts. Cost: O(bytes). */
#include "io/json.h"

enum { JSON_MEMBERS = 256 }; /* of an object that are looked at: else a search in many could take days */

typedef struct json_walk {
    bvxi_source *source;
    bvxi_json *json; /* value NULL: count only */
    const char *p, *end;
    uint32_t open[BVXI_JSON_DEPTH];  /* the arrays and objects around p */
    uint32_t items[BVXI_JSON_DEPTH]; /* found in each so far */
    char close[BVXI_JSON_DEPTH];     /* what ends each */
    int32_t depth;
} json_walk;

BVXI_COLD static bvx_status json_fail(const json_walk *w, const char *at, const char *what)
{
    uint64_t const byte = bvxi_source_byte(w->source, at);
    if (at == w->end)
        return BVXI_FILE_FAIL(w->source, BVX_ERR_FORMAT, "the JSON ends at byte %u, where %s was expected",
                              byte, what);
    return BVXI_FILE_FAIL(w->source, BVX_ERR_FORMAT, "JSON, byte %u: expected %s", byte, what);
}

static void json_skip(json_walk *w)
{
    while (w->p < w->end && (*w->p == ' ' || *w->p == '\n' || *w->p == '\r' || *w->p == '\t')) w->p++;
}

/* ---- scalars: each starts at p and leaves p after it ---- */

static int json_digit(char c)
{
    return c >= '0' && c <= '9';
}

/* The value of four hexadecimal digits; -1 when they are not. */
static int32_t json_hex(const char *p, const char *end)
{
    int32_t v = 0;

    if (end - p < 4) return -1;
    for (int i = 0; i < 4; i++) {
        char const c = p[i];
        int32_t const d = json_digit(c)          ? c - '0'
                          : c >= 'a' && c <= 'f' ? c - 'a' + 10
                          : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                                 : -1;
        if (d < 0) return -1;
        v = v * 16 + d;
    }
    return v;
}

/* Bytes of the UTF-8 sequence at p; 0 when it is none: too long, a surrogate, or beyond U+10FFFF. */
static int json_sequence(const char *p, const char *end)
{
    const unsigned char *const b = (const unsigned char *)p;
    int const n = b[0] < 0x80 ? 1 : b[0] < 0xc2 ? 0 : b[0] < 0xe0 ? 2 : b[0] < 0xf0 ? 3 : b[0] < 0xf5 ? 4 : 0;
    if (end - p < n) return 0;
    for (int i = 1; i < n; i++)
        if ((b[i] & 0xc0) != 0x80) return 0;
    if (n == 3 && ((b[0] == 0xe0 && b[1] < 0xa0) || (b[0] == 0xed && b[1] >= 0xa0))) return 0;
    if (n == 4 && ((b[0] == 0xf0 && b[1] < 0x90) || (b[0] == 0xf4 && b[1] >= 0x90))) return 0;
    return n;
}

/* Bytes of the escape at p; 0 when it is none. */
static int json_escape(const char *p, const char *end)
{
    static const char letters[] = "\"\\/bfnrt";
    const char *const stop = letters + sizeof letters - 1;
    if (end - p < 2) return 0;
    if (p[1] == 'u') return json_hex(p + 2, end) >= 0 ? 6 : 0;
    return bvxi_find_byte(letters, stop, p[1]) != stop ? 2 : 0;
}

static bvx_status json_take_text(json_walk *w)
{
    const char *p = w->p + 1;

    while (p < w->end && *p != '"') {
        unsigned char const c = (unsigned char)*p;
        int n = 1;
        if (c == '\\') n = json_escape(p, w->end);
        else if (c < ' ' || c >= 0x80) n = c < ' ' ? 0 : json_sequence(p, w->end);
        if (n == 0) return json_fail(w, p, "a character of a text in UTF-8, or an escape");
        p += n;
    }
    if (p == w->end) return json_fail(w, p, "the closing '\"' of a text");
    w->p = p + 1;
    return BVX_OK;
}

static bvx_status json_take_digits(json_walk *w)
{
    if (w->p == w->end || !json_digit(*w->p)) return json_fail(w, w->p, "a digit");
    while (w->p < w->end && json_digit(*w->p)) w->p++;
    return BVX_OK;
}

static bvx_status json_take_scalar(json_walk *w, uint32_t *kind)
{
    static const struct {
        const char *text;
        uint32_t size, kind;
    } word[] = {{"null", 4, BVXI_JSON_NULL}, {"false", 5, BVXI_JSON_FALSE}, {"true", 4, BVXI_JSON_TRUE}};

    if (w->p < w->end && *w->p == '"') {
        *kind = BVXI_JSON_TEXT;
        return json_take_text(w);
    }
    if (w->p < w->end && (*w->p == '-' || json_digit(*w->p))) {
        *kind = BVXI_JSON_NUMBER;

        if (*w->p == '-') w->p++;
        if (w->p < w->end && *w->p == '0') w->p++; /* alone: 01 is no number */
        else BVXI_TRY(json_take_digits(w));
        if (w->p < w->end && *w->p == '.') {
            w->p++;
            BVXI_TRY(json_take_digits(w));
        }
        if (w->p < w->end && (*w->p == 'e' || *w->p == 'E')) {
            w->p++;
            if (w->p < w->end && (*w->p == '+' || *w->p == '-')) w->p++;
            BVXI_TRY(json_take_digits(w));
        }
        return BVX_OK;
    }
    for (size_t i = 0; i < sizeof word / sizeof word[0]; i++)
        if ((size_t)(w->end - w->p) >= word[i].size && memcmp(w->p, word[i].text, word[i].size) == 0) {
            w->p += word[i].size;
            *kind = word[i].kind;
            return BVX_OK;
        }
    return json_fail(w, w->p, "a value");
}

/* ---- the walk ---- */

/* A value begins at p. Returns its index. */
static uint32_t json_begin(json_walk *w)
{
    uint32_t const i = w->json->count++;
    if (w->json->value != NULL) w->json->value[i].at = (uint32_t)(w->p - w->json->text);
    return i;
}

static void json_end(json_walk *w, uint32_t i, uint32_t kind, uint32_t items)
{
    bvxi_json_value *const v = w->json->value;
    if (v == NULL) return;
    v[i].size = (uint32_t)(w->p - w->json->text) - v[i].at;
    v[i].next = w->json->count;
    v[i].shape = items << 3 | kind;
}

/* The name of a member and the colon after it, where p stands in an object. */
static bvx_status json_take_name(json_walk *w)
{
    json_skip(w);
    if (w->close[w->depth - 1] != '}') return BVX_OK;
    if (w->p == w->end || *w->p != '"') return json_fail(w, w->p, "the name of a member");
    uint32_t const i = json_begin(w);
    BVXI_TRY(json_take_text(w));
    json_end(w, i, BVXI_JSON_TEXT, 0);
    json_skip(w);
    if (w->p == w->end || *w->p != ':') return json_fail(w, w->p, "':'");
    w->p++;
    json_skip(w);
    return BVX_OK;
}

/* After a value: the arrays and objects that end here, then a comma, or the end of the text. */
static bvx_status json_after(json_walk *w)
{
    while (w->depth > 0) {
        int32_t const d = w->depth - 1;

        json_skip(w);
        if (w->p < w->end && *w->p == ',') {
            w->p++;
            return json_take_name(w);
        }
        if (w->p == w->end || *w->p != w->close[d])
            return json_fail(w, w->p, w->close[d] == '}' ? "',' or '}'" : "',' or ']'");
        w->p++;
        json_end(w, w->open[d], w->close[d] == '}' ? BVXI_JSON_OBJECT : BVXI_JSON_ARRAY, w->items[d]);
        w->depth = d;
        if (d > 0) w->items[d - 1]++;
    }
    json_skip(w);
    return w->p == w->end ? BVX_OK : json_fail(w, w->p, "nothing after the value");
}

static bvx_status json_run(json_walk *w)
{
    w->p = w->json->text;
    w->depth = 0;
    w->json->count = 0;
    json_skip(w);

    do {
        uint32_t i, kind;

        BVXI_TRY(bvxi_source_at(w->source, w->p));
        if (w->p < w->end && (*w->p == '{' || *w->p == '[')) {
            if (w->depth == BVXI_JSON_DEPTH)
                return BVXI_FILE_FAIL(w->source, BVX_ERR_FORMAT,
                                      "JSON, byte %u: more than %d arrays and objects in each other",
                                      bvxi_source_byte(w->source, w->p), (int64_t)BVXI_JSON_DEPTH);
            w->open[w->depth] = json_begin(w);
            w->items[w->depth] = 0;
            w->close[w->depth++] = *w->p++ == '{' ? '}' : ']';
            json_skip(w);
            if (w->p == w->end || *w->p != w->close[w->depth - 1]) {
                BVXI_TRY(json_take_name(w));
                continue;
            }
        } else {
            i = json_begin(w);
            BVXI_TRY(json_take_scalar(w, &kind));
            json_end(w, i, kind, 0);
            if (w->depth > 0) w->items[w->depth - 1]++;
        }
        BVXI_TRY(json_after(w));
    } while (w->depth > 0);
    return BVX_OK;
}

bvx_status bvxi_json_read(bvxi_source *source, const char *text, uint64_t size, bvxi_json *json)
{
    json_walk w = {.source = source, .json = json};

    if (size > BVXI_JSON_LIMIT)
        return BVXI_FILE_FAIL_FOR(source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "%u bytes of JSON, the limit is %u; keep buffers in files of their own",
                                  size, (uint64_t)BVXI_JSON_LIMIT);
    json->source = source;
    json->text = text;
    json->value = NULL;
    w.end = text + (size_t)size;

    bvxi_source_pass(source, 0.0, 0.1);
    BVXI_TRY(json_run(&w));
    BVXI_TRY(BVXI_ARRAY(source->ctx, json->count, "the values of the JSON", json->value));
    bvxi_source_pass(source, 0.1, 0.2);
    return json_run(&w);
}

/* ---- questions ---- */

uint32_t bvxi_json_plain(const bvxi_json *json, uint32_t value, char *to)
{
    static const char letters[] = "bfnrt", meant[] = "\b\f\n\r\t";
    uint32_t size, n = 0;
    const char *p = bvxi_json_text(json, value, &size);
    const char *const end = p + size;

    while (p < end) {
        if (*p != '\\') {
            to[n++] = *p++;
            continue;
        }
        if (p[1] != 'u') {
            const char *const letter = bvxi_find_byte(letters, letters + 5, p[1]);
            to[n++] = letter != letters + 5 ? meant[letter - letters] : p[1];
            p += 2;
            continue;
        }
        int32_t c = json_hex(p + 2, end);
        p += 6;
        /* Two halves are one character; one half alone is none. */
        if (c >= 0xd800 && c < 0xdc00 && end - p >= 6 && p[0] == '\\' && p[1] == 'u') {
            int32_t const low = json_hex(p + 2, end);
            if (low >= 0xdc00 && low < 0xe000) {
                c = 0x10000 + (c - 0xd800) * 0x400 + (low - 0xdc00);
                p += 6;
            }
        }
        if (c >= 0xd800 && c < 0xe000) c = 0xfffd;
        if (c < 0x80) {
            to[n++] = (char)c;
        } else {
            int const more = c < 0x800 ? 1 : c < 0x10000 ? 2 : 3;
            static const int32_t first[4] = {0, 0xc0, 0xe0, 0xf0};
            to[n++] = (char)(unsigned char)(first[more] | c >> (6 * more));
            for (int i = more - 1; i >= 0; i--) to[n++] = (char)(unsigned char)(0x80 | (c >> (6 * i) & 0x3f));
        }
    }
    to[n] = 0;
    return n;
}

int bvxi_json_is(const bvxi_json *json, uint32_t value, const char *text)
{
    enum { LONGEST = 64 }; /* of the names that are looked for, with six bytes for each character */
    size_t const n = bvxi_text_length(text);
    char plain[6 * LONGEST + 1];
    uint32_t size;

    if (bvxi_json_kind(json, value) != BVXI_JSON_TEXT) return 0;
    const char *const at = bvxi_json_text(json, value, &size);
    if (size == n && memcmp(at, text, n) == 0) return 1;
    /* A text with escapes is longer than what it means. */
    if (size <= n || size > 6 * LONGEST || bvxi_find_byte(at, at + size, '\\') == at + size) return 0;
    return bvxi_json_plain(json, value, plain) == n && memcmp(plain, text, n) == 0;
}

uint32_t bvxi_json_member(const bvxi_json *json, uint32_t object, const char *name)
{
    uint32_t i = object + 1, left = bvxi_json_count(json, object);
    if (bvxi_json_kind(json, object) != BVXI_JSON_OBJECT) return BVXI_JSON_NONE;
    for (left = left < JSON_MEMBERS ? left : JSON_MEMBERS; left > 0; left--, i = json->value[i + 1].next)
        if (bvxi_json_is(json, i, name)) return i + 1;
    return BVXI_JSON_NONE;
}

double bvxi_json_number(const bvxi_json *json, uint32_t value)
{
    double v = 0.0;
    if (bvxi_json_kind(json, value) == BVXI_JSON_NUMBER) {
        const char *const at = json->text + json->value[value].at;
        (void)bvxi_parse_double(at, at + json->value[value].size, &v);
    }
    return v;
}
