/* nrrd_head.c - the header of an NRRD file: its lines up to the blank line or the list of data files, what
 * its fields mean, and the names of detached data files.
 *
 * Source: Kindlmann. Definition of NRRD File Format (teem.sourceforge.net/nrrd/format.html). Guarantee: a header that was read has all fields that
 * its samples need. */
#include "io_grid/nrrd_head.h"

/* ---- The fields of an NRRD head and what stands after their colons ---- */

/* NRRD0001 to NRRD0005. Names and words in either case of letters, as the reference library takes them. Guarantee: fields
 * that are not the format's, and fields that come twice, are refused, since one misspelt would move the grid;
 * what a grid cannot be is refused by name. */

typedef bvx_status nrrd_field_fn(nrrd_head *h, nrrd_value *v);

static void nrrd_skip_blank(nrrd_value *v)
{
    while (v->p < v->end && bvxi_is_blank(*v->p)) v->p++;
}

static BVXI_COLD bvx_status nrrd_expected(const nrrd_head *h, const nrrd_value *v, const char *what)
{
    return bvxi_fail_expected(&h->source, v->p, what);
}

bvx_status bvxi_nrrd_unsupported(const nrrd_head *h, int32_t reason, const char *at, const char *why)
{
    return BVXI_LINE_FAIL_FOR(&h->source, at, BVX_ERR_UNSUPPORTED, reason, "%s", why);
}

static BVXI_COLD bvx_status nrrd_unsupported(const nrrd_head *h, const nrrd_value *v, const char *why)
{
    return bvxi_nrrd_unsupported(h, BVX_REASON_UNSUPPORTED, v->p, why);
}

static bvx_status nrrd_take_end(const nrrd_head *h, nrrd_value *v)
{
    nrrd_skip_blank(v);
    return v->p == v->end ? BVX_OK : nrrd_expected(h, v, "the end of the line");
}

static bvx_status nrrd_take_double(const nrrd_head *h, nrrd_value *v, double *value)
{
    nrrd_skip_blank(v);
    size_t const n = bvxi_parse_double(v->p, v->end, value);
    if (n == 0 || (v->p + n < v->end && !bvxi_is_blank(v->p[n]) && v->p[n] != ',' && v->p[n] != ')'))
        return nrrd_expected(h, v, "a number");
    v->p += n;
    return BVX_OK;
}

static bvx_status nrrd_take_whole(const nrrd_head *h, nrrd_value *v, int64_t *value)
{
    int64_t n = 0;

    nrrd_skip_blank(v);
    const char *const start = v->p;
    int const negative = v->p < v->end && *v->p == '-';
    const char *p = v->p + negative;
    const char *const digits = p;
    /* Digits are taken by hand: a point or an exponent would make no whole number. */
    for (; p < v->end && *p >= '0' && *p <= '9'; p++)
        if (n < INT64_MAX / 16) n = n * 10 + (*p - '0'); /* too many digits stay too large */
    if (p == digits || (p < v->end && !bvxi_is_blank(*p))) {
        v->p = start;
        return nrrd_expected(h, v, "a whole number");
    }
    v->p = p;
    *value = negative ? -n : n;
    return BVX_OK;
}

static bvx_status nrrd_take_three(const nrrd_head *h, nrrd_value *v, double values[3])
{
    for (int a = 0; a < 3; a++) BVXI_TRY(nrrd_take_double(h, v, &values[a]));
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_take_vector(const nrrd_head *h, nrrd_value *v, double vector[3])
{
    for (int a = 0; a < 3; a++) {
        nrrd_skip_blank(v);
        if (v->p == v->end || *v->p != (a == 0 ? '(' : ','))
            return nrrd_expected(h, v, "a vector of three: (x,y,z)");
        v->p++;
        BVXI_TRY(nrrd_take_double(h, v, &vector[a]));
    }
    nrrd_skip_blank(v);
    if (v->p == v->end || *v->p != ')') return nrrd_expected(h, v, "')' after three numbers");
    v->p++;
    return BVX_OK;
}

static bvx_status nrrd_field_ignored(nrrd_head *h, nrrd_value *v)
{
    (void)h;
    v->p = v->end;
    return BVX_OK;
}

static bvx_status nrrd_field_dimension(nrrd_head *h, nrrd_value *v)
{
    nrrd_value const start = *v;
    int64_t n;
    BVXI_TRY(nrrd_take_whole(h, v, &n));
    if (n != 3) return nrrd_unsupported(h, &start, "the dimension is not 3; a grid has three axes [x,y,z]");
    h->has_dimension = 1;
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_field_space_dimension(nrrd_head *h, nrrd_value *v)
{
    nrrd_value const start = *v;
    int64_t n;
    BVXI_TRY(nrrd_take_whole(h, v, &n));
    if (n != 3) return nrrd_unsupported(h, &start, "the space dimension is not 3");
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_field_type(nrrd_head *h, nrrd_value *v)
{
    static const struct {
        int32_t kind;
        const char *names;
    } known[] = {{BVX_SAMPLE_I8, "signed char|int8|int8_t"},
                 {BVX_SAMPLE_U8, "uchar|unsigned char|uint8|uint8_t"},
                 {BVX_SAMPLE_I16, "short|short int|signed short|signed short int|int16|int16_t"},
                 {BVX_SAMPLE_U16, "ushort|unsigned short|unsigned short int|uint16|uint16_t"},
                 {BVX_SAMPLE_I32, "int|signed int|int32|int32_t"},
                 {BVX_SAMPLE_U32, "uint|unsigned int|uint32|uint32_t"},
                 {BVX_SAMPLE_I64,
                  "longlong|long long|long long int|signed long long|signed long long int|int64|int64_t"},
                 {BVX_SAMPLE_U64, "ulonglong|unsigned long long|unsigned long long int|uint64|uint64_t"},
                 {BVX_SAMPLE_F32, "float"},
                 {BVX_SAMPLE_F64, "double"}};
    size_t const n = (size_t)(v->end - v->p);

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (bvxi_word_is(v->p, n, known[i].names)) h->kind = known[i].kind;
    if (bvxi_word_is(v->p, n, "block")) return nrrd_unsupported(h, v, "samples of type block");
    return h->kind != 0 ? BVX_OK : nrrd_expected(h, v, "a type of samples (uint8, int16, float, ...)");
}

static bvx_status nrrd_field_encoding(nrrd_head *h, nrrd_value *v)
{
    size_t const n = (size_t)(v->end - v->p);
    h->encoding = bvxi_word_is(v->p, n, "raw")              ? NRRD_RAW
                  : bvxi_word_is(v->p, n, "txt|text|ascii") ? NRRD_TEXT
                  : bvxi_word_is(v->p, n, "gzip|gz")        ? NRRD_GZIP
                                                            : NRRD_NONE;
    h->encoding_at = v->p;
    if (h->encoding != NRRD_NONE) return BVX_OK;
    if (bvxi_word_is(v->p, n, "bzip2|bz2|zrl|hex"))
        return nrrd_unsupported(
            h, v, "compressed or hex samples; save them with encoding raw (unu save -f nrrd -e raw)");
    return nrrd_expected(h, v, "an encoding (raw, ascii)");
}

static bvx_status nrrd_field_endian(nrrd_head *h, nrrd_value *v)
{
    size_t const n = (size_t)(v->end - v->p);
    h->big = bvxi_word_is(v->p, n, "big");
    h->has_endian = 1;
    return h->big || bvxi_word_is(v->p, n, "little") ? BVX_OK : nrrd_expected(h, v, "little or big");
}

static bvx_status nrrd_field_sizes(nrrd_head *h, nrrd_value *v)
{
    for (int a = 0; a < 3; a++) {
        int64_t n;
        nrrd_skip_blank(v);
        nrrd_value const start = *v;
        BVXI_TRY(nrrd_take_whole(h, v, &n));
        if (n < 1) return nrrd_expected(h, &start, "a size of 1 or more");
        h->sizes[a] = (uint64_t)n;
    }
    h->has_sizes = 1;
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_field_spacings(nrrd_head *h, nrrd_value *v)
{
    h->has |= NRRD_HAS_SPACING;
    return nrrd_take_three(h, v, h->spacing);
}

static bvx_status nrrd_field_mins(nrrd_head *h, nrrd_value *v)
{
    h->has |= NRRD_HAS_MIN;
    return nrrd_take_three(h, v, h->min);
}

static bvx_status nrrd_field_maxs(nrrd_head *h, nrrd_value *v)
{
    h->has |= NRRD_HAS_MAX;
    return nrrd_take_three(h, v, h->max);
}

static bvx_status nrrd_field_origin(nrrd_head *h, nrrd_value *v)
{
    h->has |= NRRD_HAS_ORIGIN;
    BVXI_TRY(nrrd_take_vector(h, v, h->origin));
    return nrrd_take_end(h, v);
}

/* Axis-aligned up to 1e-9 of a voxel a voxel (what turning there and back
 * leaves): 1/30 over the longest possible row. */
static bvx_status nrrd_field_directions(nrrd_head *h, nrrd_value *v)
{
    h->has |= NRRD_HAS_DIRECTION;
    for (int a = 0; a < 3; a++) {
        double d[3];
        nrrd_skip_blank(v);
        nrrd_value const start = *v;
        /* 'none' marks an axis of colours or vectors. */
        if (v->p < v->end && (*v->p == 'n' || *v->p == 'N'))
            return nrrd_unsupported(h, &start,
                                    "an axis has no space direction; a grid's three axes lie in space");
        BVXI_TRY(nrrd_take_vector(h, v, d));
        h->direction[a] = d[a];
        /* Only its own component may differ from 0, and it must be above 0: no turn, no mirror. */
        for (int b = 0; b < 3; b++)
            if (b != a && !(d[b] <= 1e-9 * d[a] && -d[b] <= 1e-9 * d[a]))
                return nrrd_unsupported(
                    h, &start,
                    "space directions that are turned or mirrored; a grid's axes are x, y and z "
                    "upwards (resample, or flip and permute the axes)");
    }
    return nrrd_take_end(h, v);
}

static const char *nrrd_take_word(nrrd_value *v, size_t *n)
{
    nrrd_skip_blank(v);
    const char *const word = v->p;
    while (v->p < v->end && !bvxi_is_blank(*v->p)) v->p++;
    *n = (size_t)(v->p - word);
    return word;
}

static bvx_status nrrd_field_centers(nrrd_head *h, nrrd_value *v)
{
    for (int a = 0; a < 3; a++) {
        size_t n;
        const char *const word = nrrd_take_word(v, &n);
        /* Words are taken for all three axes: a short list is an error. */
        h->node[a] = (int8_t)bvxi_word_is(word, n, "node");
        if (h->node[a] || bvxi_word_is(word, n, "cell|none|???")) continue;
        v->p = word;
        return nrrd_expected(h, v, "cell, node, none or ???");
    }
    return nrrd_take_end(h, v);
}

/* An axis of colours, vectors or matrices is no axis of a grid. */
static bvx_status nrrd_field_kinds(nrrd_head *h, nrrd_value *v)
{
    for (int a = 0; a < 3; a++) {
        size_t n;
        const char *const word = nrrd_take_word(v, &n);
        if (bvxi_word_is(word, n, "domain|space|none|???|time")) continue;
        v->p = word;
        if (n == 0) return nrrd_expected(h, v, "a kind for each axis");
        return nrrd_unsupported(
            h, v,
            "an axis of a kind that is not a position in space; a grid has three axes [x,y,z] of single "
            "numbers");
    }
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_field_line_skip(nrrd_head *h, nrrd_value *v)
{
    nrrd_value const start = *v;
    BVXI_TRY(nrrd_take_whole(h, v, &h->line_skip));
    if (h->line_skip < 0) return nrrd_expected(h, &start, "0 lines or more");
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_field_byte_skip(nrrd_head *h, nrrd_value *v)
{
    nrrd_value const start = *v;
    BVXI_TRY(nrrd_take_whole(h, v, &h->byte_skip));
    if (h->byte_skip < -1) return nrrd_expected(h, &start, "0 bytes or more, or -1");
    return nrrd_take_end(h, v);
}

static bvx_status nrrd_field_data_file(nrrd_head *h, nrrd_value *v)
{
    if (v->p == v->end) return nrrd_expected(h, v, "the name of a file");
    h->files = v->p;
    h->files_end = v->end;
    return BVX_OK;
}

static const struct {
    nrrd_field_fn *take;
    const char *names;
} nrrd_fields[] = {
    {nrrd_field_dimension, "dimension"},
    {nrrd_field_type, "type"},
    {nrrd_field_encoding, "encoding"},
    {nrrd_field_endian, "endian"},
    {nrrd_field_sizes, "sizes"},
    {nrrd_field_spacings, "spacings"},
    {nrrd_field_mins, "axis mins|axismins"},
    {nrrd_field_maxs, "axis maxs|axismaxs"},
    {nrrd_field_origin, "space origin"},
    {nrrd_field_directions, "space directions"},
    {nrrd_field_space_dimension, "space dimension"},
    {nrrd_field_centers, "centers|centerings"},
    {nrrd_field_line_skip, "line skip|lineskip"},
    {nrrd_field_byte_skip, "byte skip|byteskip"},
    {nrrd_field_data_file, "data file|datafile"},
    {nrrd_field_kinds, "kinds"},
    {nrrd_field_ignored,
     "space|labels|units|space units|thicknesses|content|min|max|old min|oldmin|old max|oldmax|"
     "number|block size|blocksize|sample units|sampleunits|measurement frame"}};

/* ---- The lines of an NRRD head: the magic, comments, keys and fields, up to the blank line or the list
 * of data files ---- */

/* A line of the head: a comment, key:=value, or field: value. */
static bvx_status nrrd_take_line(nrrd_head *h, const char *line, const char *end)
{
    const char *const colon = bvxi_find_byte(line, end, ':');

    if (*line == '#') return BVX_OK;
    if (colon == end) return bvxi_fail_expected(&h->source, line, "a field and a colon");
    nrrd_value value = {.p = colon + 1, .end = end};

    /* key:=value is free text of the writer's; one key of ours keeps the corner to the last bit. */
    if (value.p < end && *value.p == '=') {
        int axes = bvxi_word_is(line, (size_t)(colon - line), BVXI_NRRD_CORNER_KEY) ? 0 : 4;
        for (const char *p = value.p + 1; axes < 3; axes++) {
            /* Exactly '(x,y,z)': any other text is somebody else's, stale or damaged, and gives no corner. */
            size_t const n = p < end && *p == "(,,"[axes] ? bvxi_parse_double(p + 1, end, &h->corner[axes])
                                                          : 0;
            if (n == 0) break;
            p += 1 + n;
        }
        if (axes == 3) h->has |= NRRD_HAS_CORNER;
        return BVX_OK;
    }
    while (value.end > value.p && bvxi_is_blank(value.end[-1])) value.end--;
    nrrd_skip_blank(&value);

    /* The field of this name takes its value. */
    size_t const length = (size_t)(colon - line);
    for (size_t i = 0; i < sizeof nrrd_fields / sizeof nrrd_fields[0]; i++) {
        int32_t const which = bvxi_word_is(line, length, nrrd_fields[i].names);
        /* A bit for each field, so that doubles are refused; those left out, have one for each name. */
        size_t const bit = nrrd_fields[i].take == nrrd_field_ignored ? i + (size_t)which : i;
        if (which == 0) continue;
        if ((h->seen >> bit & 1) != 0) return bvxi_fail_expected(&h->source, line, "each field once");
        h->seen |= UINT64_C(1) << bit;
        return nrrd_fields[i].take(h, &value);
    }
    return bvxi_fail_expected(&h->source, line, "a field of the NRRD format");
}

const char *bvxi_nrrd_line(const char *p, const char *file_end, const char **end)
{
    const char *const newline = bvxi_find_byte(p, file_end, '\n');
    *end = newline > p && newline[-1] == '\r' ? newline - 1 : newline;
    return newline == file_end ? NULL : newline + 1;
}

static bvx_status nrrd_take_lines(nrrd_head *h)
{
    const bvxi_source *const s = &h->source;
    const char *end, *next = bvxi_nrrd_line(s->begin, s->end, &end);

    /* The magic is one line; an unknown version may have other rules, so it is not guessed at. */
    if (end - s->begin != 8 || memcmp(s->begin, "NRRD000", 7) != 0)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the file does not begin with a line NRRD0001 to NRRD0005");
    if (s->begin[7] < '1' || s->begin[7] > '5')
        return BVXI_FILE_FAIL(s, BVX_ERR_UNSUPPORTED, "line 1: a version other than NRRD0001 to NRRD0005");
    while (next != NULL) {
        const char *const line = next;
        next = bvxi_nrrd_line(line, s->end, &end);
        /* A blank line ends the head; without it the samples must stand in other files. */
        if (line == end && next != NULL) {
            h->data = next;
            return BVX_OK;
        }
        if (line != end) BVXI_TRY(nrrd_take_line(h, line, end));
        /* "LIST", or "LIST 2": names of files on the lines that follow. */
        size_t const n = h->files != NULL ? (size_t)(h->files_end - h->files) : 0;
        if (h->list != NULL || n < 4 || memcmp(h->files, "LIST", 4) != 0) continue;
        if (n > 4 && !bvxi_is_blank(h->files[4])) continue;
        h->list = next != NULL ? next : s->end; /* the names end the file */
        h->list_end = s->end;
        return BVX_OK;
    }
    if (h->files != NULL) return BVX_OK;
    return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT,
                          "the file ends in its head: no blank line with samples after it");
}

bvx_status bvxi_nrrd_head_read(nrrd_head *h)
{
    BVXI_TRY(nrrd_take_lines(h));
    const char *const missing = !h->has_dimension          ? "dimension"
                                : h->kind == 0             ? "type"
                                : h->encoding == NRRD_NONE ? "encoding"
                                : !h->has_sizes            ? "sizes"
                                : h->encoding != NRRD_TEXT && bvxi_sample_size(h->kind) > 1 && !h->has_endian
                                    ? "endian"
                                    : NULL;

    /* The first that is missing is named; a byte order only matters for samples of several bytes. */
    if (missing != NULL)
        return BVXI_FILE_FAIL(&h->source, BVX_ERR_FORMAT, "the head has no field '%s'", missing);
    if (h->byte_skip < 0 && h->encoding != NRRD_RAW)
        return BVXI_FILE_FAIL(&h->source, BVX_ERR_FORMAT, "byte skip -1 requires encoding raw");
    return BVX_OK;
}

/* ---- The data files that a detached NRRD head names ---- */

/* Source: Kindlmann. Definition of NRRD File Format, "data file": one name; a pattern with one number (%d,
 * %03d), the least, the greatest and the step of it, for files that each hold a slice; or LIST with a name a
 * line.
 * Each name is requested by its number, which reads the head once more: heads for which that is too much are
 * refused. */

enum { NRRD_MOST_DIGITS = 20 };

#define NRRD_NAME_WORK (UINT64_C(1) << 31) /* bytes: most that asking for one name after the other may read */

/* A whole number with blanks before it, at *p; 0 where none stands. */
static int take_file_number(const char **p, const char *end, int64_t *value)
{
    const char *q = *p;
    while (q < end && bvxi_is_blank(*q)) q++;
    if (q == *p || !bvxi_take_integer(&q, end, value)) return 0;
    if (q < end && !bvxi_is_blank(*q)) return 0;
    *p = q;
    return 1;
}

/* "name.%03d.raw 1 93 1" with an optional fourth number, a file's axes. 1: it is such a pattern. */
static int take_pattern(const nrrd_head *h, nrrd_file_name *f, int64_t range[3], int64_t *axes)
{
    const char *const begin = h->files, *const end = h->files_end;
    const char *p = begin, *word = begin;

    /* The pattern is the first word; its percent sign stands for the number. */
    while (word < end && !bvxi_is_blank(*word)) word++;
    while (p < word && *p != '%') p++;
    if (p == word) return 0;
    f->name = begin;
    f->length = (size_t)(word - begin);
    f->place = (size_t)(p - begin);
    p++;
    f->zeros = p < word && *p == '0';
    /* The width stops growing beyond the limit, which is checked below. */
    for (; p < word && *p >= '0' && *p <= '9'; p++)
        if (f->digits <= NRRD_MOST_DIGITS) f->digits = 10 * f->digits + (*p - '0');
    if (p == word || *p != 'd' || f->digits > NRRD_MOST_DIGITS) return 0;
    f->rest = (size_t)(p + 1 - begin);
    p = word;

    /* First, last and step; where one is missing, the field is the name of a file after all. */
    for (int i = 0; i < 3; i++)
        if (!take_file_number(&p, end, &range[i])) return 0;
    *axes = 0;
    if (p < end && !take_file_number(&p, end, axes)) return 0;
    f->pattern = 1;
    return p == end;
}

static bvx_status find_in_pattern(const nrrd_head *h, const int64_t range[3], int64_t axes, uint64_t index,
                                  nrrd_file_name *f, uint64_t *count)
{
    int64_t const step = range[2];

    /* Numbers of 31 bits keep every sum and difference below inside 64 bits. */
    for (int i = 0; i < 3; i++)
        if (range[i] > INT32_MAX || range[i] < -INT32_MAX)
            return bvxi_nrrd_unsupported(h, BVX_REASON_UNSUPPORTED, h->files,
                                         "the numbers of the data files are beyond 2^31");
    if (step == 0 || (step > 0 ? range[1] < range[0] : range[1] > range[0]))
        return bvxi_fail_expected(&h->source, h->files,
                                  "a pattern whose numbers go from the first to the last");
    /* As many as fit from the first to the last, by the step; rounding down leaves out a last half step. */
    *count = (uint64_t)((range[1] - range[0]) / step) + 1;
    if (axes != 0 && axes != 2)
        return bvxi_nrrd_unsupported(h, BVX_REASON_UNSUPPORTED, h->files,
                                     "data files that hold anything but slices of z");
    /* A number beyond the count is refused by the caller, who knows it only now. */
    f->number = range[0] + (int64_t)(index < *count ? index : 0) * step;
    return BVX_OK;
}

bvx_status bvxi_nrrd_data_file(const nrrd_head *h, uint64_t index, nrrd_file_name *file, uint64_t *count)
{
    int64_t range[3], axes;

    memset(file, 0, sizeof *file);
    if (h->list != NULL) {
        const char *next = h->list, *line_end;
        for (*count = 0; next != NULL && next < h->list_end;) {
            const char *const line = next;
            next = bvxi_nrrd_line(line, h->list_end, &line_end);
            if (line_end == line || (*count)++ != index) continue;
            file->name = line;
            file->length = (size_t)(line_end - line);
        }
        if (*count == 0) return bvxi_fail_expected(&h->source, h->list, "the name of a file on each line");
    } else if (take_pattern(h, file, range, &axes))
        BVXI_TRY(find_in_pattern(h, range, axes, index, file, count));
    else {
        memset(file, 0, sizeof *file);
        file->name = h->files;
        file->length = (size_t)(h->files_end - h->files);
        *count = 1;
    }

    /* Skips and packing belong to one file; which of several they mean is not said. */
    if (*count > 1 && (h->encoding == NRRD_GZIP || h->line_skip != 0 || h->byte_skip != 0))
        return bvxi_nrrd_unsupported(
            h, BVX_REASON_UNSUPPORTED, h->files,
            "several data files that are packed, or whose beginning is to be skipped");
    /* Names times bytes of the head bound the work of a caller who requests each name in turn. */
    const char *const end = h->list != NULL ? h->list_end : h->data != NULL ? h->data : h->source.end;
    if (*count > NRRD_NAME_WORK / (uint64_t)(end - h->source.begin))
        return bvxi_nrrd_unsupported(h, BVX_REASON_UNSUPPORTED, h->files,
                                     "data files times bytes of the head are more than 2^31");
    return BVX_OK;
}
