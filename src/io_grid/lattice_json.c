/* lattice_json.c - where a grid lies, as JSON beside a file whose format cannot say it.
 *
 * Source: RFC 8259. Numbers are printed to read back as they were. The reader takes keys in any order, passes
 * over those it does not know (values nested up to JSON_DEPTH deep, by a stack of bits), and refuses what is
 * missing, twice there or contradicts itself: center0 follows from origin, spacing and window.low, and who
 * changes one must change the other. */
#include "io/formats.h"
#include "io_grid/grid_formats.h"

enum { JSON_DEPTH = 64, JSON_KEYS = 9, JSON_WINDOW_KEYS = 2 };

/* ---- writing ---- */

static void json_put_doubles(bvxi_output *out, const char *key, const double v[3])
{
    char text[32];
    bvxi_output_text(out, key);
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, a == 0 ? "[" : ", ");
        bvxi_output_add(out, text, (size_t)bvxi_print_double(v[a], text));
    }
    bvxi_output_text(out, "]");
}

static void json_put_counts(bvxi_output *out, const char *key, const int32_t v[3])
{
    bvxi_output_text(out, key);
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, a == 0 ? "[" : ", ");
        bvxi_output_number(out, (uint64_t)v[a]);
    }
    bvxi_output_text(out, "]");
}

/* The centre of the window's first voxel. */
static void json_center0(const bvx_lattice *lattice, const int32_t low[3], double center[3])
{
    for (int a = 0; a < 3; a++) center[a] = lattice->origin[a] + ((double)low[a] + 0.5) * lattice->spacing[a];
}

static void json_put_lattice(const bvx_grid *grid, bvxi_output *out)
{
    double center[3];

    /* Derived from origin and spacing, for programs that want a centre; the reader checks that it agrees. */
    json_center0(&grid->lattice, grid->low, center);
    bvxi_output_text(out, "{\n  \"format\": \"bitvox lattice\",\n  \"version\": 1,\n");
    json_put_doubles(out, "  \"origin\": ", grid->lattice.origin);
    json_put_doubles(out, ",\n  \"spacing\": ", grid->lattice.spacing);
    json_put_counts(out, ",\n  \"dims\": ", grid->lattice.dims);
    bvxi_output_text(out, ",\n  \"fraction_bits\": ");
    bvxi_output_number(out, (uint64_t)grid->lattice.fraction_bits);
    json_put_counts(out, ",\n  \"window\": {\"low\": ", grid->low);
    json_put_counts(out, ", \"size\": ", grid->size);
    json_put_doubles(out, "},\n  \"center0\": ", center);
    bvxi_output_text(out, ",\n  \"axes\": \"xyz\"\n}\n");
}

static bvx_status run_write_lattice(bvx_context *context, const bvx_grid *grid, bvx_buffer *file)
{
    static const char *const function = "bvx_write_lattice";
    bvxi_output out = {0};
    bvx_buffer made = {0};

    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    BVXI_TRY(bvxi_check_written_corner(context, function, grid));

    /* Written twice: once without bytes, to learn how many there are. */
    json_put_lattice(grid, &out);
    BVXI_TRY(bvxi_make_buffer(context, out.size, "the lattice's file", &made));
    out.bytes = made.bytes;
    out.size = 0;
    json_put_lattice(grid, &out);
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_lattice(bvx_context *context, const bvx_grid *grid, bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_lattice(context, grid, file));
}

/* ---- words of JSON ---- */

typedef struct json_text {
    bvxi_source source; /* for messages */
    const char *p, *end;
} json_text;

static BVXI_COLD bvx_status json_expected(const json_text *t, const char *what)
{
    return bvxi_fail_expected(&t->source, t->p, what);
}

static void json_skip_space(json_text *t)
{
    while (t->p < t->end && (*t->p == ' ' || *t->p == '\n' || *t->p == '\r' || *t->p == '\t')) t->p++;
}

static int json_take(json_text *t, char c)
{
    json_skip_space(t);
    if (t->p == t->end || *t->p != c) return 0;
    t->p++;
    return 1;
}

/* What stands between quotes, escapes and all. */
static bvx_status json_take_string(json_text *t, const char **text, size_t *length)
{
    if (!json_take(t, '"')) return json_expected(t, "a string in quotes");
    *text = t->p;
    /* An escape takes two characters, so that an escaped quote does not end the string. */
    while (t->p < t->end && *t->p != '"' && (unsigned char)*t->p >= 32)
        t->p += *t->p == '\\' && t->end - t->p > 1 && (unsigned char)t->p[1] >= 32 ? 2 : 1;
    *length = (size_t)(t->p - *text);
    if (t->p == t->end || *t->p != '"') return json_expected(t, "the string's closing quote");
    t->p++;
    return BVX_OK;
}

static const char *json_digits(const char *p, const char *end)
{
    while (p < end && *p >= '0' && *p <= '9') p++;
    return p;
}

/* The end of a number by JSON's grammar; p itself when there is none. */
static const char *json_number_end(const char *p, const char *end)
{
    const char *const start = p, *q;

    if (p < end && *p == '-') p++;

    q = json_digits(p, end);
    if (q == p || (*p == '0' && q - p > 1)) return start;
    p = q;
    if (p < end && *p == '.') {
        q = json_digits(p + 1, end);
        if (q == p + 1) return start;
        p = q;
    }
    if (p < end && (*p == 'e' || *p == 'E')) {
        p++;
        if (p < end && (*p == '+' || *p == '-')) p++;
        q = json_digits(p, end);
        if (q == p) return start;
        p = q;
    }
    return p;
}

static bvx_status json_take_double(json_text *t, double *value)
{
    json_skip_space(t);
    const char *const stop = json_number_end(t->p, t->end);
    if (stop == t->p) return json_expected(t, "a number");
    bvxi_parse_double(t->p, stop, value);
    t->p = stop;
    return BVX_OK;
}

/* A whole number that an int32_t holds, written in any way. */
static bvx_status json_take_count(json_text *t, int32_t *value)
{
    double v = 0.0;

    json_skip_space(t);
    /* Read as a double, as 3.0 and 3e0 are whole numbers too; the range is checked before the cast. */
    const char *const start = t->p;
    BVXI_TRY(json_take_double(t, &v));
    if (v >= 0.0 && v <= 2147483647.0 && v == (double)(int32_t)v) {
        *value = (int32_t)v;
        return BVX_OK;
    }
    t->p = start;
    return json_expected(t, "a whole number from 0 to 2147483647");
}

/* Three of them between brackets, into doubles or counts. */
static bvx_status json_take_three(json_text *t, double *doubles, int32_t *counts)
{
    for (int a = 0; a < 3; a++) {
        if (!json_take(t, a == 0 ? '[' : ',')) return json_expected(t, "three numbers between brackets");
        BVXI_TRY(counts != NULL ? json_take_count(t, &counts[a]) : json_take_double(t, &doubles[a]));
    }
    return json_take(t, ']') ? BVX_OK : json_expected(t, "']' after three numbers");
}

static bvx_status json_take_exact(json_text *t, const char *wanted, const char *what)
{
    const char *text;
    size_t n;

    json_skip_space(t);
    const char *const start = t->p;
    BVXI_TRY(json_take_string(t, &text, &n));
    if (n == bvxi_text_length(wanted) && memcmp(text, wanted, n) == 0) return BVX_OK;
    t->p = start;
    return json_expected(t, what);
}

/* ---- values that are passed over ---- */

/* A string, number or word. */
static bvx_status json_skip_plain(json_text *t)
{
    static const char *const words[3] = {"true", "false", "null"};
    const char *text;
    size_t n;
    double v;

    if (t->p < t->end && *t->p == '"') return json_take_string(t, &text, &n);
    for (int i = 0; i < 3; i++) {
        n = bvxi_text_length(words[i]);
        if ((size_t)(t->end - t->p) < n || memcmp(t->p, words[i], n) != 0) continue;
        t->p += n;
        return BVX_OK;
    }
    return json_take_double(t, &v);
}

static bvx_status json_skip_key(json_text *t)
{
    const char *text;
    size_t n;
    BVXI_TRY(json_take_string(t, &text, &n));
    return json_take(t, ':') ? BVX_OK : json_expected(t, "':'");
}

static bvx_status json_skip_value(json_text *t)
{
    uint64_t objects = 0; /* bit d: what is open at depth d is an object, not an array */
    int depth = 0;

    /* One bit a depth replaces a recursion, so that a file cannot exhaust the stack. */
    do {
        json_skip_space(t);
        int const is_object = t->p < t->end && *t->p == '{';
        if (is_object || (t->p < t->end && *t->p == '[')) {
            if (depth == JSON_DEPTH) return json_expected(t, "values nested less deeply");
            t->p++;
            /* An empty object or array is a whole value; any other one opens a depth. */
            if (!json_take(t, is_object ? '}' : ']')) {
                objects = (objects & ~(UINT64_C(1) << depth)) | (uint64_t)is_object << depth;
                depth++;
                if (is_object) BVXI_TRY(json_skip_key(t));
                continue;
            }
        } else {
            BVXI_TRY(json_skip_plain(t));
        }
        while (depth > 0 && !json_take(t, ',')) { /* a value has ended, and what it closes */
            int const in_object = (int)(objects >> (depth - 1) & 1);
            if (!json_take(t, in_object ? '}' : ']'))
                return json_expected(t, in_object ? "',' or '}'" : "',' or ']'");
            depth--;
        }

        /* Inside an object, a comma is followed by the next key. */
        if (depth > 0 && (objects >> (depth - 1) & 1) != 0) BVXI_TRY(json_skip_key(t));
    } while (depth > 0);
    return BVX_OK;
}

/* ---- the side-car ---- */

typedef struct json_lattice {
    bvx_lattice lattice;
    bvx_window window;
    double center[3];
} json_lattice;

enum json_key {
    JSON_FORMAT = 0,
    JSON_VERSION,
    JSON_ORIGIN,
    JSON_SPACING,
    JSON_DIMS,
    JSON_FRACTION,
    JSON_WINDOW,
    JSON_CENTER,
    JSON_AXES
};

static const char *const json_key_names[JSON_KEYS] = {
    "format", "version", "origin", "spacing", "dims", "fraction_bits", "window", "center0", "axes"};
static const char *const json_window_names[JSON_WINDOW_KEYS] = {"low", "size"};

/* The next key of an object: its number among names, or count when it is another. A key comes once. */
static bvx_status json_take_key(json_text *t, const char *const *names, int count, int *seen, int *key)
{
    const char *text;
    size_t n;

    json_skip_space(t);

    /* A key's place stays in start, for the message about one that comes twice. */
    const char *const start = t->p;
    BVXI_TRY(json_take_string(t, &text, &n));
    *key = 0;
    while (*key < count && (n != bvxi_text_length(names[*key]) || memcmp(text, names[*key], n) != 0)) ++*key;
    if (*key < count && (*seen >> *key & 1) != 0) {
        t->p = start;
        return json_expected(t, "each key once");
    }
    if (*key < count) *seen |= 1 << *key;
    return json_take(t, ':') ? BVX_OK : json_expected(t, "':'");
}

/* Behind a value: 1 in *more when another key follows. */
static bvx_status json_take_next(json_text *t, int *more)
{
    *more = json_take(t, ',');
    return *more || json_take(t, '}') ? BVX_OK : json_expected(t, "',' or '}'");
}

static bvx_status json_check_keys(const json_text *t, const char *const *names, int count, int seen)
{
    for (int i = 0; i < count; i++)
        if ((seen >> i & 1) == 0)
            return bvxi_fail(t->source.ctx, BVX_ERR_FORMAT, "lattice: the key \"%s\" is missing", names[i]);
    return BVX_OK;
}

static bvx_status json_take_window(json_text *t, bvx_window *window)
{
    int seen = 0, key, more;

    if (!json_take(t, '{')) return json_expected(t, "an object of low and size");
    for (more = !json_take(t, '}'); more;) {
        BVXI_TRY(json_take_key(t, json_window_names, JSON_WINDOW_KEYS, &seen, &key));
        if (key == JSON_WINDOW_KEYS) BVXI_TRY(json_skip_value(t));
        else BVXI_TRY(json_take_three(t, NULL, key == 0 ? window->low : window->size));
        BVXI_TRY(json_take_next(t, &more));
    }
    return json_check_keys(t, json_window_names, JSON_WINDOW_KEYS, seen);
}

static bvx_status json_take_version(json_text *t)
{
    int32_t version = 0;
    BVXI_TRY(json_take_count(t, &version));
    if (version == 1) return BVX_OK;
    return bvxi_fail(t->source.ctx, BVX_ERR_FORMAT, "lattice: version %d; version 1 is read",
                     (int64_t)version);
}

static bvx_status json_take_value(json_text *t, int key, json_lattice *l)
{
    switch (key) {
    case JSON_FORMAT: return json_take_exact(t, "bitvox lattice", "\"bitvox lattice\"");
    case JSON_VERSION: return json_take_version(t);
    case JSON_ORIGIN: return json_take_three(t, l->lattice.origin, NULL);
    case JSON_SPACING: return json_take_three(t, l->lattice.spacing, NULL);
    case JSON_DIMS: return json_take_three(t, NULL, l->lattice.dims);
    case JSON_FRACTION: return json_take_count(t, &l->lattice.fraction_bits);
    case JSON_WINDOW: return json_take_window(t, &l->window);
    case JSON_CENTER: return json_take_three(t, l->center, NULL);
    case JSON_AXES: return json_take_exact(t, "xyz", "\"xyz\", the one order of axes");
    default: return json_skip_value(t);
    }
}

static bvx_status json_take_lattice(json_text *t, json_lattice *l)
{
    int seen = 0, key, more;

    if (!json_take(t, '{')) return json_expected(t, "'{'");
    for (more = !json_take(t, '}'); more;) {
        BVXI_TRY(json_take_key(t, json_key_names, JSON_KEYS, &seen, &key));
        BVXI_TRY(json_take_value(t, key, l));
        BVXI_TRY(json_take_next(t, &more));
    }

    /* Order does not matter, but all nine must be there; after the closing brace, nothing may be. */
    BVXI_TRY(json_check_keys(t, json_key_names, JSON_KEYS, seen));
    json_skip_space(t);
    return t->p == t->end ? BVX_OK : json_expected(t, "the end of the file");
}

/* A thousandth of a voxel, and what a few roundings of another program may add. */
static bvx_status json_check_center(bvx_context *ctx, const json_lattice *l)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    double center[3];

    /* Computed as the writer did, so that a file of ours agrees to the last bit. */
    json_center0(&l->lattice, l->window.low, center);
    for (int a = 0; a < 3; a++) {
        double const off = center[a] - l->center[a], size = center[a] < 0 ? -center[a] : center[a];
        double const most = 1e-3 * l->lattice.spacing[a] + 1e-15 * size;
        if (!(off <= most && -off <= most))
            return bvxi_fail(ctx, BVX_ERR_FORMAT,
                             "lattice: center0 is %g along %s, but origin, spacing and window give %g",
                             l->center[a], axis_name[a], center[a]);
    }
    return BVX_OK;
}

static bvx_status run_read_lattice(bvx_context *context, const void *bytes, uint64_t size, bvx_grid *grid)
{
    static const char *const function = "bvx_read_lattice";
    static const char axis_name[3][2] = {"x", "y", "z"};
    json_lattice l;
    json_text t;

    if (bytes == NULL) return bvxi_fail_null(context, function, "bytes");
    if (size > SIZE_MAX / 2)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                             "%s: size is %u, more than memory can hold", function, size);
    BVXI_TRY(bvxi_grid_check(context, function, grid));

    /* Values go to l first: the grid changes only when all of them fit each other. */
    memset(&l, 0, sizeof l);
    memset(&t, 0, sizeof t);
    t.source.ctx = context;
    t.source.format = "lattice";
    t.source.begin = bytes;
    t.end = t.source.end = t.source.begin + (size_t)size;
    t.p = bvxi_skip_mark(t.source.begin, t.end);
    BVXI_TRY(json_take_lattice(&t, &l));
    /* The argument at fault is the file, whatever the check of lattices calls it. */
    if (bvxi_lattice_check(context, "lattice", &l.lattice) != BVX_OK) return BVX_ERR_FORMAT;
    for (int a = 0; a < 3; a++)
        if (l.window.size[a] != grid->size[a])
            return bvxi_fail(context, BVX_ERR_LATTICE,
                             "lattice: the window is %d voxels along %s, the grid %d",
                             (int64_t)l.window.size[a], axis_name[a], (int64_t)grid->size[a]);
    if (bvx_grid_bound(&l.lattice, &l.window) == 0)
        return bvxi_fail(context, BVX_ERR_FORMAT, "lattice: the window is not inside the lattice");

    BVXI_TRY(json_check_center(context, &l));
    grid->lattice = l.lattice;
    memcpy(grid->low, l.window.low, sizeof grid->low);
    return BVX_OK;
}

bvx_status bvx_read_lattice(bvx_context *context, const void *bytes, uint64_t size, bvx_grid *grid)
{
    return BVXI_CALL(context, run_read_lattice(context, bytes, size, grid));
}
