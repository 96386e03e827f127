/* npy.c - NumPy's .npy: where the samples of an array of three axes [x,y,z] stand.
 *
 * Source: numpy.lib.format, versions 1.0, 2.0 and 3.0. The head is a Python dictionary of exactly three keys,
 * read by a parser of that and nothing else: no code, no nesting. C order (z fastest) and Fortran order (x
 * fastest) are both read.
 * Guarantee: the bytes after the head are held against the shape before anything is made. */
#include "io_grid/grid_formats.h"

typedef struct npy_head {
    uint64_t shape[3];
    int32_t kind; /* BVX_SAMPLE_..., BVXI_SAMPLE_F16 */
    int32_t big, fortran;
    const uint8_t *data;
} npy_head;

/* The dictionary, and where reading stands in it. */
typedef struct npy_text {
    const bvxi_grid_source *source;
    const char *p, *end;
} npy_text;

static BVXI_COLD bvx_status npy_expected(const npy_text *t, const char *what)
{
    char found[2] = {0, 0};
    if (t->p == t->end)
        return BVXI_FILE_FAIL(t->source, BVX_ERR_FORMAT, "the head ends where %s was expected", what);
    found[0] = *t->p == 0 ? '?' : *t->p;
    return BVXI_FILE_FAIL(t->source, BVX_ERR_FORMAT, "byte %u: expected %s, found '%s'",
                          bvxi_grid_byte(t->source, t->p), what, found);
}

/* 1 when c comes next, after any space; it is taken. */
static int npy_take(npy_text *t, char c)
{
    t->p = bvxi_skip_space(t->p, t->end);
    if (t->p == t->end || *t->p != c) return 0;
    t->p++;
    return 1;
}

static int npy_take_word(npy_text *t, const char *word)
{
    size_t const n = bvxi_text_length(word);
    t->p = bvxi_skip_space(t->p, t->end);
    if ((size_t)(t->end - t->p) < n || memcmp(t->p, word, n) != 0) return 0;
    t->p += n;
    return 1;
}

static bvx_status npy_take_string(npy_text *t, const char *what, const char **text, size_t *length)
{
    char quote;
    if (npy_take(t, '\'')) quote = '\'';
    else if (npy_take(t, '"')) quote = '"';
    else return npy_expected(t, what);
    /* A backslash would need Python's rules of escapes; names and types have none. */
    *text = t->p;
    while (t->p < t->end && *t->p != quote && *t->p != '\\' && *t->p != '\n') t->p++;
    *length = (size_t)(t->p - *text);
    return npy_take(t, quote) ? BVX_OK : npy_expected(t, "the string's end");
}

/* '<f4' and the like. Where the byte order is left open ('|', '='), little-endian is as good as any: it
 * matters for the sign of a zero only, and NumPy writes neither for numbers of several bytes. */
static bvx_status npy_take_type(npy_text *t, npy_head *h)
{
    static const struct {
        char name[3];
        uint8_t kind;
    } known[] = {{"b1", BVX_SAMPLE_U8},   {"u1", BVX_SAMPLE_U8},  {"i1", BVX_SAMPLE_I8},
                 {"u2", BVX_SAMPLE_U16},  {"i2", BVX_SAMPLE_I16}, {"u4", BVX_SAMPLE_U32},
                 {"i4", BVX_SAMPLE_I32},  {"u8", BVX_SAMPLE_U64}, {"i8", BVX_SAMPLE_I64},
                 {"f2", BVXI_SAMPLE_F16}, {"f4", BVX_SAMPLE_F32}, {"f8", BVX_SAMPLE_F64}};
    const char *text;
    char shown[16];
    size_t n;
    t->p = bvxi_skip_space(t->p, t->end);
    if (t->p < t->end && *t->p == '[')
        return BVXI_FILE_FAIL(t->source, BVX_ERR_UNSUPPORTED,
                              "the array's elements are records; save one field of them");
    BVXI_TRY(npy_take_string(t, "the type of the array's elements", &text, &n));
    if (n == 3 && (*text == '<' || *text == '>' || *text == '|' || *text == '='))
        for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
            if (memcmp(text + 1, known[i].name, 2) == 0) {
                h->kind = known[i].kind;
                h->big = *text == '>';
                return BVX_OK;
            }

    /* Types are short, but this one is unknown: the message holds what fits. */
    if (n > sizeof shown - 1) n = sizeof shown - 1;
    memcpy(shown, text, n);
    shown[n] = 0;
    return BVXI_FILE_FAIL(
        t->source, BVX_ERR_UNSUPPORTED,
        "elements of type '%s'; bool, whole numbers and floats of 2, 4 and 8 bytes are read", shown);
}

static bvx_status npy_take_shape(npy_text *t, npy_head *h)
{
    uint64_t axes = 0;

    if (!npy_take(t, '(')) return npy_expected(t, "'(' and the array's shape");
    while (!npy_take(t, ')')) {
        const char *const start = bvxi_skip_space(t->p, t->end);
        uint64_t n = 0;
        for (t->p = start; t->p < t->end && *t->p >= '0' && *t->p <= '9'; t->p++)
            if (n < UINT64_MAX / 16)
                n = n * 10 + (uint64_t)(*t->p - '0'); /* too many digits stay too large */
        if (t->p == start) return npy_expected(t, "a whole number");
        if (t->p < t->end && *t->p == 'L') t->p++; /* long integers of Python 2 */
        if (axes < 3) h->shape[axes] = n;
        axes++;
        if (npy_take(t, ',')) continue;
        if (!npy_take(t, ')')) return npy_expected(t, "',' or ')'");
        break;
    }
    if (axes != 3)
        return BVXI_FILE_FAIL(t->source, BVX_ERR_UNSUPPORTED,
                              "an array of %u axes; a grid has three: [x,y,z]", axes);
    return BVX_OK;
}

static bvx_status npy_take_entry(npy_text *t, npy_head *h, int *seen)
{
    static const char *const keys[3] = {"descr", "fortran_order", "shape"};
    const char *text, *const at = t->p;
    size_t n;
    int key = 0;

    BVXI_TRY(npy_take_string(t, "'descr', 'fortran_order' or 'shape'", &text, &n));
    /* Exactly three keys, as the format requires of writers. */
    while (key < 3 && (n != bvxi_text_length(keys[key]) || memcmp(text, keys[key], n) != 0)) key++;
    if (key == 3 || (*seen >> key & 1) != 0) {
        t->p = at;
        return npy_expected(t, "'descr', 'fortran_order' and 'shape', once each");
    }
    *seen |= 1 << key;
    if (!npy_take(t, ':')) return npy_expected(t, "':'");
    if (key == 0) return npy_take_type(t, h);
    if (key == 2) return npy_take_shape(t, h);

    h->fortran = npy_take_word(t, "True");
    return h->fortran || npy_take_word(t, "False") ? BVX_OK : npy_expected(t, "True or False");
}

static bvx_status npy_read_head(const bvxi_grid_source *source, npy_head *h)
{
    static const uint8_t magic[6] = {0x93, 'N', 'U', 'M', 'P', 'Y'};
    const uint8_t *const b = source->begin;
    uint64_t const size = (uint64_t)(source->end - b);

    if (size < 10 || memcmp(b, magic, sizeof magic) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "the file does not begin with \\x93NUMPY and a version");
    if (b[6] < 1 || b[6] > 3 || b[7] != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_UNSUPPORTED, "version %u.%u; 1.0, 2.0 and 3.0 are read",
                              (uint64_t)b[6], (uint64_t)b[7]);

    /* The head's length has two bytes in version 1 and four after it. */
    uint64_t const prefix = b[6] == 1 ? 10 : 12;
    uint64_t const length = b[6] == 1   ? bvxi_load_u16(b + 8, 0)
                            : size < 12 ? UINT32_MAX
                                        : bvxi_load_u32(b + 8, 0);
    if (size < prefix || length > size - prefix)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "a head of %u bytes in a file of %u", length, size);
    npy_text t = {.source = source, .p = (const char *)b + prefix};
    t.end = t.p + length;
    h->data = b + prefix + length;
    int seen = 0;
    if (!npy_take(&t, '{')) return npy_expected(&t, "'{'");
    while (!npy_take(&t, '}')) {
        BVXI_TRY(npy_take_entry(&t, h, &seen));
        if (npy_take(&t, ',')) continue;
        if (!npy_take(&t, '}')) return npy_expected(&t, "',' or '}'");
        break;
    }
    if (seen != 7)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "the head lacks one of descr, fortran_order and shape");
    t.p = bvxi_skip_space(t.p, t.end);
    return t.p == t.end ? BVX_OK : npy_expected(&t, "the end of the head");
}

bvx_status bvxi_find_npy(const bvxi_grid_source *source, bvxi_dense *dense)
{
    static const double zero[3] = {0, 0, 0}, one[3] = {1, 1, 1};
    npy_head h = {{0, 0, 0}, 0, 0, 0, NULL};
    int fits = 1;

    BVXI_TRY(npy_read_head(source, &h));
    BVXI_TRY(bvxi_file_box(source, zero, one, h.shape, &dense->box));

    /* The bytes must be exactly those that the shape requires. */
    uint64_t const have = (uint64_t)(source->end - h.data);
    int64_t const size = (int64_t)bvxi_sample_size(h.kind);
    uint64_t bytes = (uint64_t)size;
    for (int a = 0; a < 3; a++) bytes = bvxi_mul(bytes, h.shape[a], &fits);
    if (!fits || bytes != have)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "%u x %u x %u elements of %u bytes, but %u bytes follow the head", h.shape[0],
                              h.shape[1], h.shape[2], (uint64_t)size, have);

    /* The size is checked by now, so none of these products can overflow. */
    int64_t const nx = (int64_t)h.shape[0];
    int64_t const ny = (int64_t)h.shape[1];
    int64_t const nz = (int64_t)h.shape[2];
    dense->size = have;
    dense->samples.first = h.data;
    dense->samples.kind = h.kind;
    dense->samples.big = h.big;
    /* Fortran order has x fastest; C order has z fastest. */
    dense->samples.stride[0] = h.fortran ? size : size * ny * nz;
    dense->samples.stride[1] = h.fortran ? size * nx : size * nz;
    dense->samples.stride[2] = h.fortran ? size * nx * ny : size;
    return BVX_OK;
}
