/* nrrd_files.c - the data files that a detached NRRD head names.
 *
 * Source: Kindlmann. Definition of NRRD File Format, "data file": one name; a pattern with one number (%d,
 * %03d), the least, the greatest and the step of it, for files that each hold a slice; or LIST with a name a
 * line.
 * Each name is requested by its number, which reads the head once more: heads for which that is too much are
 * refused. */
#include "io_grid/nrrd_head.h"

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

/* "name.%03d.raw 1 93 1" with an optional fourth number, the axes of a
 * file. 1 when the field is such a pattern. */
static int take_pattern(const nrrd_head *h, nrrd_file_name *f, int64_t range[3], int64_t *axes)
{
    const char *const begin = h->files, *const end = h->files_end;
    const char *p = begin, *word = begin;

    /* The pattern is the first word; its percent sign divides
     * it into what stands before and after the number. */
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

static bvx_status find_in_list(const nrrd_head *h, uint64_t index, nrrd_file_name *f, uint64_t *count)
{
    const char *next = h->list, *end;
    uint64_t n = 0;

    while (next != NULL && next < h->list_end) {
        const char *const line = next;
        next = bvxi_nrrd_line(line, h->list_end, &end);
        /* Empty lines name nothing and are not counted. */
        if (end == line) continue;
        if (n++ != index) continue;
        f->name = line;
        f->length = (size_t)(end - line);
    }
    *count = n;
    return n != 0 ? BVX_OK : bvxi_fail_expected(&h->source, h->list, "the name of a file on each line");
}

/* With its list; at least the line with the version. */
static uint64_t nrrd_head_size(const nrrd_head *h)
{
    const char *const end = h->list != NULL ? h->list_end : h->data != NULL ? h->data : h->source.end;
    return (uint64_t)(end - h->source.begin);
}

bvx_status bvxi_nrrd_data_file(const nrrd_head *h, uint64_t index, nrrd_file_name *file, uint64_t *count)
{
    int64_t range[3], axes;

    memset(file, 0, sizeof *file);
    /* A list, a pattern, or else the field itself is the name. */
    if (h->list != NULL) BVXI_TRY(find_in_list(h, index, file, count));
    else if (take_pattern(h, file, range, &axes))
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
    if (*count > NRRD_NAME_WORK / nrrd_head_size(h))
        return bvxi_nrrd_unsupported(h, BVX_REASON_UNSUPPORTED, h->files,
                                     "data files times bytes of the head are more than 2^31");
    return BVX_OK;
}
