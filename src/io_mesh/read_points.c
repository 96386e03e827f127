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

static inline const char *xyz_skip_gap(const char *p, const char *end)
{
    while (p < end && xyz_is_gap(*p)) p++;
    return p;
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
    *p = xyz_skip_gap(behind, end);
    return 1;
}

static const char *xyz_skip_head(const char *p, const char *end)
{
    const char *at = p;
    double unused;
    /* A line with a name first, or with one number alone (a count), is a head. */
    if (!xyz_take_number(&at, end, &unused) || bvxi_line_ends(at, end))
        return xyz_next_line(bvxi_line_end(p, end), end);
    return p;
}

static bvx_status xyz_take_point(const bvxi_source *s, const char *p, uint64_t i, double to[3])
{
    const char *const line = p;
    for (int32_t a = 0; a < 3; a++) {
        if (!xyz_take_number(&p, s->end, &to[a])) return bvxi_fail_expected(s, p, "a coordinate");
        if (!(to[a] - to[a] == 0.0))
            return BVXI_LINE_FAIL_FOR(s, line, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                      "point %i has a coordinate that is not finite", i);
    }
    return BVX_OK;
}

static bvx_status read_xyz(bvxi_source *s, bvx_mesh *points)
{
    const char *const first = xyz_skip_head(xyz_next_line(bvxi_skip_mark(s->begin, s->end), s->end), s->end);
    uint64_t count = 0, i = 0;

    for (const char *p = first; p < s->end; p = xyz_next_line(bvxi_line_end(p, s->end), s->end)) {
        BVXI_TRY(bvxi_source_at(s, p));
        count++;
    }
    if (count == 0) return BVXI_FILE_FAIL(s, BVX_ERR_EMPTY, "the file holds no points");
    if (count > UINT32_MAX)
        return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%u points, the limit is below 2^32",
                                  count);
    BVXI_TRY(bvxi_make_positions(s->ctx, points, BVX_F64, count));

    bvxi_source_pass(s, 0.3, 1);
    for (const char *p = first; p < s->end; p = xyz_next_line(bvxi_line_end(p, s->end), s->end), i++) {
        BVXI_TRY(bvxi_source_at(s, p));
        BVXI_TRY(xyz_take_point(s, p, i, (double *)points->positions + 3 * (size_t)i));
    }
    return BVX_OK;
}

static bvx_status read_points_as(bvxi_source *source, int32_t format, bvx_mesh *points)
{
    source->format = format == BVX_FORMAT_XYZ ? "XYZ" : "PLY";
    if (source->begin == source->end) return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the file has no bytes");
    bvxi_source_pass(source, 0, format == BVX_FORMAT_XYZ ? 0.3 : 1);
    return format == BVX_FORMAT_XYZ ? read_xyz(source, points) : bvxi_read_ply_points(source, points);
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
