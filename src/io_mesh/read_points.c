/* read_points.c - clouds of points from the bytes of a file: XYZ text here, PLY by its reader:
 * bvx_read_points.
 *
 * A text is gone through twice: lines with points are counted, then read into exact room. */
#include "io_mesh/mesh_formats.h"

static const char read_points_name[] = "bvx_read_points";

static inline int xyz_is_gap(char c)
{
    return c == ' ' || c == '\t' || c == ',' || c == ';' || c == '\v' || c == '\f';
}

/* The first word of the next line that is no comment, or the end. */
static const char *xyz_next_line(const char *p, const char *end)
{
    for (;;) {
        while (p < end && (xyz_is_gap(*p) || *p == '\n' || *p == '\r')) p++;
        if (p == end) return end;
        if (*p != '#' && *p != '%' && !(*p == '/' && end - p > 1 && p[1] == '/')) return p;
        p = bvxi_line_end(p, end);
    }
}

/* A number that a gap or the line's end follows; 0 when there is none. */
static int xyz_take_number(const char **p, const char *end, double *value)
{
    size_t const n = bvxi_parse_double(*p, end, value);
    const char *const behind = *p + n;
    if (n == 0 || !(bvxi_line_ends(behind, end) || xyz_is_gap(*behind))) return 0;
    for (*p = behind; *p < end && xyz_is_gap(**p);) ++*p;
    return 1;
}

static bvx_status read_points_as(bvxi_source *source, int32_t format, bvx_mesh *points)
{
    source->format = format == BVX_FORMAT_XYZ ? "XYZ" : "PLY";
    if (source->begin == source->end) return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the file has no bytes");
    bvxi_source_pass(source, 0, format == BVX_FORMAT_XYZ ? 0.3 : 1);
    if (format != BVX_FORMAT_XYZ) return bvxi_read_ply_points(source, points);

    const char *first = xyz_next_line(bvxi_skip_mark(source->begin, source->end), source->end), *at = first;
    uint64_t count = 0, i = 0;
    double unused;

    /* A line with a name first, or with one number alone (a count), is a head. */
    if (!xyz_take_number(&at, source->end, &unused) || bvxi_line_ends(at, source->end))
        first = xyz_next_line(bvxi_line_end(first, source->end), source->end);
    for (const char *p = first; p < source->end;
         p = xyz_next_line(bvxi_line_end(p, source->end), source->end)) {
        BVXI_TRY(bvxi_source_at(source, p));
        count++;
    }
    if (count == 0) return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the file holds no points");
    if (count > UINT32_MAX)
        return BVXI_FILE_FAIL_FOR(source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "%u points, the limit is below 2^32", count);
    BVXI_TRY(bvxi_make_positions(source->ctx, points, BVX_F64, count));

    bvxi_source_pass(source, 0.3, 1);
    for (const char *p = first; p < source->end;
         p = xyz_next_line(bvxi_line_end(p, source->end), source->end), i++) {
        BVXI_TRY(bvxi_source_at(source, p));
        double *const to = (double *)points->positions + 3 * (size_t)i;
        at = p;
        for (int32_t a = 0; a < 3; a++) {
            if (!xyz_take_number(&at, source->end, &to[a]))
                return bvxi_fail_expected(source, at, "a coordinate");
            if (!(to[a] - to[a] == 0.0))
                return BVXI_LINE_FAIL_FOR(source, p, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                          "point %i has a coordinate that is not finite", i);
        }
    }
    return BVX_OK;
}

static bvx_status run_read_points(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                  bvx_mesh *points)
{
    bvx_mesh made = {0};

    if (points == NULL) return bvxi_fail_null(context, read_points_name, "points");
    BVXI_TRY(bvxi_check_bytes(context, read_points_name, bytes, size));
    if (format != BVX_FORMAT_XYZ && format != BVX_FORMAT_PLY)
        return bvxi_fail_format(context, BVX_ERR_ARGUMENT, read_points_name, "points that are read", format,
                                BVX_POINTS_READ);
    if (points->owned != 1 && !bvxi_mesh_is_empty(points))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: points brings arrays, which are not used; zero it first", read_points_name);

    /* Read apart from the caller's mesh, which stays as it was after a failure. */
    bvxi_source source = {.ctx = context, .begin = bytes};
    source.end = source.begin + (size_t)size;
    bvx_status const status = BVXI_SCOPE(context, read_points_as(&source, format, &made));
    if (status != BVX_OK) {
        bvx_mesh_free(context, &made);
        return status;
    }
    bvx_mesh_free(context, points);
    *points = made;
    return BVX_OK;
}

bvx_status bvx_read_points(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                           bvx_mesh *points)
{
    return BVXI_CALL(context, run_read_points(context, bytes, size, format, points));
}
