/* nrrd_head.c - the lines of an NRRD head: the magic, comments, keys and fields, up to the blank line or the
 * list of data files.
 *
 * Source: Kindlmann. Definition of NRRD File Format (teem.sourceforge.net/nrrd/format.html), NRRD0001 to
 * NRRD0005. Guarantee: a head that was read has all fields that its samples need. */
#include "io_grid/nrrd_head.h"

/* Keys mean nothing to the format, so this one may be stale or damaged: then it is passed over. */
static void nrrd_take_corner(nrrd_head *h, const char *p, const char *end)
{
    static const char before[3] = {'(', ',', ','};
    for (int a = 0; a < 3; a++) {
        /* Exactly '(x,y,z)': any other text is somebody else's, and gives no corner. */
        size_t const n = p < end && *p == before[a] ? bvxi_parse_double(p + 1, end, &h->corner[a]) : 0;
        if (n == 0) return;
        p += 1 + n;
    }
    h->has |= NRRD_HAS_CORNER;
}

/* A line of the head: a comment, key:=value, or field: value. */
static bvx_status nrrd_take_line(nrrd_head *h, const char *line, const char *end)
{
    const char *const colon = bvxi_find_byte(line, end, ':');
    nrrd_value value;

    if (*line == '#') return BVX_OK;
    if (colon == end) return bvxi_fail_expected(&h->source, line, "a field and a colon");
    value.p = colon + 1;
    value.end = end;

    /* key:=value is free text of the writer's; one key of ours keeps the corner to the last bit. */
    if (value.p < end && *value.p == '=') {
        if (bvxi_nrrd_is(line, (size_t)(colon - line), BVXI_NRRD_CORNER_KEY))
            nrrd_take_corner(h, value.p + 1, end);
        return BVX_OK;
    }
    /* Trailing blanks belong to no field. */
    while (value.end > value.p && bvxi_is_blank(value.end[-1])) value.end--;
    bvxi_nrrd_skip_blank(&value);
    return bvxi_nrrd_take_field(h, line, (size_t)(colon - line), &value);
}

const char *bvxi_nrrd_line(const char *p, const char *file_end, const char **end)
{
    const char *const newline = bvxi_find_byte(p, file_end, '\n');
    *end = newline > p && newline[-1] == '\r' ? newline - 1 : newline;
    return newline == file_end ? NULL : newline + 1;
}

/* "LIST", or "LIST 2": names of files on the lines that follow. */
static int nrrd_is_list(const nrrd_head *h)
{
    size_t const n = (size_t)(h->files_end - h->files);
    return n >= 4 && memcmp(h->files, "LIST", 4) == 0 && (n == 4 || bvxi_is_blank(h->files[4]));
}

static bvx_status nrrd_take_lines(nrrd_head *h)
{
    const bvxi_source *const s = &h->source;
    const char *end, *next = bvxi_nrrd_line(s->begin, s->end, &end);

    /* The magic is one line; an unknown version may have other rules, so it is not guessed at. */
    if (end - s->begin != 8 || memcmp(s->begin, "NRRD000", 7) != 0)
        return bvxi_fail(s->ctx, BVX_ERR_FORMAT,
                         "NRRD: the file does not begin with a line NRRD0001 to NRRD0005");
    if (s->begin[7] < '1' || s->begin[7] > '5')
        return bvxi_fail(s->ctx, BVX_ERR_UNSUPPORTED,
                         "NRRD: line 1: a version other than NRRD0001 to NRRD0005");
    while (next != NULL) {
        const char *const line = next;
        next = bvxi_nrrd_line(line, s->end, &end);
        /* A blank line ends the head; without it the samples must stand in other files. */
        if (line == end && next != NULL) {
            h->data = next;
            return BVX_OK;
        }
        if (line != end) BVXI_TRY(nrrd_take_line(h, line, end));
        if (h->files == NULL || h->list != NULL || !nrrd_is_list(h)) continue;
        h->list = next != NULL ? next : s->end; /* the names end the file */
        h->list_end = s->end;
        return BVX_OK;
    }
    if (h->files != NULL) return BVX_OK;
    return bvxi_fail(s->ctx, BVX_ERR_FORMAT,
                     "NRRD: the file ends in its head: no blank line with samples after it");
}

static bvx_status nrrd_check_head(const nrrd_head *h)
{
    const char *const missing = !h->has_dimension          ? "dimension"
                                : h->kind == 0             ? "type"
                                : h->encoding == NRRD_NONE ? "encoding"
                                : !h->has_sizes            ? "sizes"
                                : h->encoding != NRRD_TEXT && bvxi_sample_size(h->kind) > 1 && !h->has_endian
                                    ? "endian"
                                    : NULL;

    /* The first that is missing is named; a byte order only matters for samples of several bytes. */
    if (missing != NULL)
        return bvxi_fail(h->source.ctx, BVX_ERR_FORMAT, "NRRD: the head has no field '%s'", missing);
    if (h->byte_skip < 0 && h->encoding != NRRD_RAW)
        return bvxi_fail(h->source.ctx, BVX_ERR_FORMAT, "NRRD: byte skip -1 requires encoding raw");
    return BVX_OK;
}

bvx_status bvxi_nrrd_head_read(nrrd_head *h)
{
    BVXI_TRY(nrrd_take_lines(h));
    return nrrd_check_head(h);
}
