/* xml_scan.c - the tags of an XML text one after the other: what data files use of XML, and nothing else.
 *
 * Source: Extensible Markup Language 1.0, elements, attributes, comments and the five predefined entities. No
 * document types, no other entities, no CDATA; so nothing expands, nothing is fetched, and the work is linear
 * in the bytes. Within quotes '<' and a '&' that begins no entity stand for themselves: VTK writes the names
 * of arrays as they are.
 * Guarantee: tags are balanced and nested BVXI_XML_DEPTH deep at most; an element has XML_ATTRIBUTES
 * attributes at most, well formed and once each. */
#include "io/xml_scan.h"

enum { XML_ATTRIBUTES = 64 };

static const struct {
    const char *name;
    char means;
} xml_entities[5] = {{"&lt;", '<'}, {"&gt;", '>'}, {"&amp;", '&'}, {"&quot;", '"'}, {"&apos;", '\''}};

static int xml_starts(const char *p, const char *end, const char *word)
{
    size_t const n = bvxi_text_length(word);
    return (size_t)(end - p) >= n && memcmp(p, word, n) == 0;
}

static char xml_character(bvxi_xml_text *t)
{
    for (int i = 0; i < 5 && *t->p == '&'; i++)
        if (xml_starts(t->p, t->end, xml_entities[i].name)) {
            t->p += bvxi_text_length(xml_entities[i].name);
            return xml_entities[i].means;
        }
    return *t->p++;
}

static int xml_is_name(char c)
{
    return !bvxi_is_space(c) && c != '/' && c != '>' && c != '<' && c != '=' && c != '"' && c != '\'' &&
           c != '&' && c != 0;
}

static bvxi_xml_text xml_take_name(bvxi_xml *x)
{
    bvxi_xml_text name;
    name.p = x->p;
    while (x->p < x->source.end && xml_is_name(*x->p)) x->p++;
    name.end = x->p;
    return name;
}

static int xml_equal(bvxi_xml_text a, bvxi_xml_text b)
{
    return a.end - a.p == b.end - b.p && memcmp(a.p, b.p, (size_t)(a.end - a.p)) == 0;
}

static BVXI_COLD bvx_status xml_expected(const bvxi_xml *x, const char *what)
{
    return bvxi_fail_expected(&x->source, x->p, what);
}

/* ---- attributes ---- */

/* name = "value", at p; 0 after the last. Only for what xml_check_attribute has seen. */
static int xml_next_attribute(bvxi_xml_text *rest, bvxi_xml_text *name, bvxi_xml_text *value)
{
    const char *p = bvxi_skip_space(rest->p, rest->end);

    if (p == rest->end) return 0;
    name->p = p;
    while (xml_is_name(*p)) p++;
    name->end = p;
    p = bvxi_skip_space(p, rest->end) + 1; /* '=' */
    p = bvxi_skip_space(p, rest->end);
    value->p = p + 1;
    value->end = bvxi_find_byte(p + 1, rest->end, *p);
    rest->p = value->end + 1;
    return 1;
}

static bvx_status xml_check_attribute(bvxi_xml *x)
{
    const char *const end = x->source.end, *const start = x->p;
    bvxi_xml_text const name = xml_take_name(x);
    bvxi_xml_text before = {NULL, NULL}, other, unused, value;

    /* Names and values are checked here once, so that those who look them up later need not check an end. */
    if (name.p == name.end) return xml_expected(x, "an attribute, '/>' or '>'");
    before.p = x->attributes.p;
    before.end = start;
    /* Attributes are few (XML_ATTRIBUTES), so comparing with each before costs less than a table. */
    while (xml_next_attribute(&before, &other, &unused))
        if (xml_equal(other, name)) {
            x->p = start;
            return xml_expected(x, "each attribute once");
        }
    x->p = bvxi_skip_space(x->p, end);
    if (x->p == end || *x->p != '=') return xml_expected(x, "'=' after an attribute's name");
    x->p = bvxi_skip_space(x->p + 1, end);
    if (x->p == end || (*x->p != '"' && *x->p != '\'')) return xml_expected(x, "a value in quotes");
    value.p = x->p + 1;
    value.end = bvxi_find_byte(value.p, end, *x->p);
    if (value.end == end) return xml_expected(x, "a value that ends with its quote");
    x->p = value.end + 1;
    return BVX_OK;
}

int bvxi_xml_attribute(const bvxi_xml *x, const char *name, bvxi_xml_text *value)
{
    bvxi_xml_text rest = x->attributes, n;
    while (xml_next_attribute(&rest, &n, value))
        if (bvxi_xml_is(n, name)) return 1;
    return 0;
}

/* ---- tags ---- */

static bvx_status xml_take_open(bvxi_xml *x)
{
    const char *const end = x->source.end;
    int32_t count = 0;

    if (x->depth == BVXI_XML_DEPTH) return xml_expected(x, "elements nested less deeply");
    bvxi_xml_text const name = xml_take_name(x);
    if (name.p == name.end) return xml_expected(x, "an element's name");

    x->open[x->depth++] = name;
    x->attributes.p = x->attributes.end = x->p;
    for (;;) {
        const char *const behind = x->p;
        x->p = bvxi_skip_space(x->p, end);
        if (x->p < end && (*x->p == '>' || *x->p == '/')) break;

        /* a="1"b="2" is not well formed; where the text has ended, the next step has the better message. */
        if (x->p == behind && x->p < end) return xml_expected(x, "white space before an attribute");
        if (++count > XML_ATTRIBUTES) return xml_expected(x, "fewer attributes");
        BVXI_TRY(xml_check_attribute(x));
        x->attributes.end = x->p;
    }
    x->is_empty = *x->p == '/';
    if (x->is_empty) x->p++;
    if (x->p == end || *x->p != '>') return xml_expected(x, "'>'");
    x->p++;
    x->event = BVXI_XML_OPEN;
    return BVX_OK;
}

static bvx_status xml_skip_to(bvxi_xml *x, const char *mark)
{
    const char *p = x->p;
    size_t const n = bvxi_text_length(mark);
    while (p < x->source.end && !xml_starts(p, x->source.end, mark)) p++;
    if (p == x->source.end) return bvxi_fail_expected(&x->source, p, mark);
    x->p = p + n;
    return BVX_OK;
}

bvx_status bvxi_xml_next(bvxi_xml *x)
{
    const char *const end = x->source.end;

    if (x->is_empty) {
        /* <a/> opens and closes: its second event comes without a character read. */
        x->is_empty = 0;
        x->depth--;
        x->event = BVXI_XML_CLOSE;
        return BVX_OK;
    }
    for (;;) {
        /* Text between tags is passed over; comments and instructions may hold a '<' of their own. */
        x->p = bvxi_find_byte(x->p, end, '<');
        x->tag = x->p;
        if (x->p == end) {
            x->event = BVXI_XML_END;
            return x->depth == 0 ? BVX_OK : xml_expected(x, "the closing tag of an element");
        }
        if (xml_starts(x->p, end, "<!--")) BVXI_TRY(xml_skip_to(x, "-->"));
        else if (xml_starts(x->p, end, "<?")) BVXI_TRY(xml_skip_to(x, "?>"));
        else break;
    }
    if (xml_starts(x->p, end, "<!")) return xml_expected(x, "elements and comments only");
    if (!xml_starts(x->p, end, "</")) {
        x->p++;
        return xml_take_open(x);
    }
    x->p += 2;
    const char *const start = x->p;
    bvxi_xml_text const name = xml_take_name(x);

    if (x->depth == 0 || !xml_equal(name, x->open[x->depth - 1])) {
        x->p = start;
        return xml_expected(x, "the closing tag of the element that was opened last");
    }
    x->p = bvxi_skip_space(x->p, x->source.end);
    if (x->p == x->source.end || *x->p != '>') return xml_expected(x, "'>'");
    x->p++;
    x->depth--;
    x->event = BVXI_XML_CLOSE;
    return BVX_OK;
}

void bvxi_xml_start(bvxi_xml *x, bvx_context *ctx, const char *format, const uint8_t *begin,
                    const uint8_t *end)
{
    memset(x, 0, sizeof *x);
    x->source.ctx = ctx;
    x->source.format = format;
    x->source.begin = (const char *)begin;
    x->source.end = (const char *)end;
    x->p = bvxi_skip_mark(x->source.begin, x->source.end);
}

/* ---- comparing ---- */

int bvxi_xml_is(bvxi_xml_text value, const char *word)
{
    size_t const n = bvxi_text_length(word);
    return (size_t)(value.end - value.p) == n && memcmp(value.p, word, n) == 0;
}

int bvxi_xml_is_at(const bvxi_xml *x, const char *path)
{
    for (int32_t i = 0; i < x->depth; i++) {
        bvxi_xml_text part;
        part.p = path;
        while (*path != '/' && *path != 0) path++;
        part.end = path;
        if (!xml_equal(part, x->open[i])) return 0;
        if (*path == 0) return i + 1 == x->depth;
        path++;
    }
    return 0;
}

int bvxi_xml_same(bvxi_xml_text a, bvxi_xml_text b)
{
    while (a.p < a.end && b.p < b.end)
        if (xml_character(&a) != xml_character(&b)) return 0;
    return a.p == a.end && b.p == b.end;
}
