/* write_sections.c - contour stacks to CSL, CSV and SVG.
 *
 * The writer runs twice, to count and to write. CSL and CSV numbers are the shortest decimals that read back
 * to the same ones. */
#include "io/formats.h"
#include "contours/section.h"

#include <math.h>

/* ---- CSL ---- */

typedef struct section_counts {
    uint64_t points, loops;
} section_counts;

static section_counts count_section(const bvx_sections *s, uint64_t section)
{
    section_counts c = {0, 0};
    for (uint64_t i = 0; i < s->loop_count; i++)
        if (s->loops[i].section == section) {
            c.points += s->loops[i].point_count;
            c.loops++;
        }
    return c;
}

static uint64_t count_labels(const bvx_sections *s)
{
    int32_t most = 1;
    for (uint64_t i = 0; i < s->loop_count; i++)
        if (s->loops[i].label > most) most = s->loops[i].label;
    return (uint64_t)most + 1;
}

/* Number, counts and plane of a section. A stack of one direction has its unit normal in the frame already. */
static void put_csl_head(const bvx_sections *s, uint64_t section, const double normal[3], bvxi_output *o)
{
    section_counts const c = count_section(s, section);
    double unit[3] = {normal[0], normal[1], normal[2]};

    if (s->normals != NULL) {
        const double *const n = s->normals + 3 * section;
        double const length = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
        for (int k = 0; k < 3; k++) unit[k] = n[k] / length;
    }
    /* CSL has the plane as a x + b y + c z + d = 0. */
    bvxi_output_print(o, "\n%u %u %u %v %g\n\n", section + 1, c.points, c.loops, unit, " ",
                      -s->positions[section]);
}

static void put_csl(const bvx_sections *s, const double normal[3], bvxi_output *o)
{
    bvxi_output_print(o, "CSLC\n%u %u\n", (uint64_t)s->section_count, count_labels(s));
    for (uint64_t k = 0; k < s->section_count; k++) {
        put_csl_head(s, k, normal, o);
        for (uint64_t i = 0; i < s->loop_count; i++) {
            if (s->loops[i].section != k) continue;
            for (uint64_t j = 0; j < s->loops[i].point_count; j++)
                bvxi_output_print(o, "%v\n", s->points + 3 * (s->loops[i].first_point + j), " ");
        }
        bvxi_output_print(o, "\n");

        /* Loops are walked in the order of their points, so indices are a count. */
        uint64_t from = 0;
        for (uint64_t i = 0; i < s->loop_count; i++) {
            if (s->loops[i].section != k) continue;
            bvxi_output_print(o, "%u %d", (uint64_t)s->loops[i].point_count, (int64_t)s->loops[i].label);
            for (uint64_t j = 0; j < s->loops[i].point_count; j++) bvxi_output_print(o, " %u", from++);
            bvxi_output_print(o, "\n");
        }
    }
}

/* ---- CSV ---- */

/* Sections before the next one with lines of its own, which hold no loop or have theirs later, have one without
 * a point: so none is lost, and all keep their order. */
static void state_sections(const bvx_sections *s, uint64_t from, uint64_t to, bvxi_output *o)
{
    for (uint64_t k = from; k < to; k++) {
        bvxi_output_print(o, "%u,%g,,,,", k, s->positions[k]);
        if (s->normals != NULL) bvxi_output_print(o, ",,%v", s->normals + 3 * k, ",");
        bvxi_output_print(o, "\n");
    }
}

/* Where planes have normals of their own, they are as they were given, whatever their length. */
static void put_table(const bvx_sections *s, bvxi_output *o)
{
    uint64_t stated = 0;

    bvxi_output_print(o, "section,position,loop,label,x,y%s", s->normals != NULL ? ",z,nx,ny,nz\n" : "\n");
    for (uint64_t i = 0; i < s->loop_count; i++) {
        const bvx_section_loop *const l = &s->loops[i];

        state_sections(s, stated, l->section, o);
        if (stated <= l->section) stated = (uint64_t)l->section + 1;
        for (uint64_t j = 0; j < l->point_count; j++) {
            const double *const p = s->points + 3 * (l->first_point + j);
            bvxi_output_print(o, "%u,%g,%u,%d,%g,%g", (uint64_t)l->section, s->positions[l->section], i,
                              (int64_t)l->label, p[0], p[1]);
            if (s->normals != NULL)
                bvxi_output_print(o, ",%g,%v", p[2], s->normals + 3 * (uint64_t)l->section, ",");
            bvxi_output_print(o, "\n");
        }
    }
    state_sections(s, stated, s->section_count, o);
}

/* ---- SVG ---- */

enum { DRAWING_COLUMNS = 6, DRAWING_CELL = 200, DRAWING_MARGIN = 10 };

static void uv_of_point(const double axis[3][3], const double *p, double uv[2])
{
    for (int k = 0; k < 2; k++) uv[k] = (axis[k][0] * p[0] + axis[k][1] * p[1]) + axis[k][2] * p[2];
}

/* A whole number of hundredths is enough for a drawing. */
static double rounded_place(double v)
{
    return (double)(int64_t)(v * 100.0 + 0.5) / 100.0;
}

/* The box of the drawing; without ends along an axis where a sum of coordinates overflows. */
static void bound_drawing(const bvx_sections *s, const double axis[3][3], double low[2], double high[2])
{
    low[0] = low[1] = HUGE_VAL;
    high[0] = high[1] = -HUGE_VAL;

    /* What is not finite takes its end of the axis with it, which the caller refuses. */
    for (uint64_t i = 0; i < s->point_count; i++) {
        double uv[2];
        uv_of_point(axis, s->points + 3 * i, uv);
        for (int k = 0; k < 2; k++) {
            int const finite = uv[k] - uv[k] == 0.0;
            if (!finite) low[k] = -HUGE_VAL;
            else if (uv[k] < low[k]) low[k] = uv[k];
            if (!finite) high[k] = HUGE_VAL;
            else if (uv[k] > high[k]) high[k] = uv[k];
        }
    }
}

static void put_drawing(const bvx_sections *s, const double axis[3][3], bvxi_output *o)
{
    double low[2], high[2], scale, extent;
    uint64_t const columns = s->section_count < DRAWING_COLUMNS ? s->section_count : DRAWING_COLUMNS;
    uint64_t const rows = (s->section_count + columns - 1) / columns;

    bound_drawing(s, axis, low, high);
    /* One scale for all sections, so that their sizes can be compared. */
    extent = high[0] - low[0] > high[1] - low[1] ? high[0] - low[0] : high[1] - low[1];
    /* An extent near 0 would make the scale infinite: a point is drawn as one. */
    scale = extent > 0x1p-1000 ? (DRAWING_CELL - 2 * DRAWING_MARGIN) / extent : 1.0;
    bvxi_output_print(o,
                      "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%u\" height=\"%u\" "
                      "font-family=\"sans-serif\" font-size=\"9\">\n",
                      columns * DRAWING_CELL, rows * DRAWING_CELL);
    for (uint64_t k = 0; k < s->section_count; k++) {
        uint64_t const column = k % columns, row = k / columns;
        double const x = (double)column * DRAWING_CELL + DRAWING_MARGIN;
        /* y runs down in SVG: the origin of a cell is its lower left corner, and v is subtracted from it. */
        double const y = (double)(row + 1) * DRAWING_CELL - DRAWING_MARGIN;
        bvxi_output_print(o,
                          "<text x=\"%g\" y=\"%g\">%g</text>\n<path fill=\"#c8a26a\" stroke=\"#503818\" "
                          "stroke-width=\"0.5\" fill-rule=\"evenodd\" d=\"",
                          rounded_place(x), rounded_place(y - DRAWING_CELL + 2 * DRAWING_MARGIN),
                          s->positions[k]);
        /* One path a section with the even-odd rule: holes are left open whatever way their loops run. */
        for (uint64_t i = 0; i < s->loop_count; i++) {
            if (s->loops[i].section != k) continue;
            for (uint64_t j = 0; j < s->loops[i].point_count; j++) {
                double uv[2];
                uv_of_point(axis, s->points + 3 * (s->loops[i].first_point + j), uv);
                bvxi_output_print(o, "%s%g %g", j == 0 ? "M" : "L",
                                  rounded_place(x + (uv[0] - low[0]) * scale),
                                  rounded_place(y - (uv[1] - low[1]) * scale));
            }
            bvxi_output_print(o, "Z");
        }
        bvxi_output_print(o, "\"/>\n");
    }
    bvxi_output_print(o, "</svg>\n");
}

static void put_sections(const bvx_sections *s, int32_t format, const double axis[3][3], bvxi_output *o)
{
    if (format == BVX_FORMAT_CSL) put_csl(s, axis[2], o);
    else if (format == BVX_FORMAT_CSV) put_table(s, o);
    else put_drawing(s, axis, o);
}

/* CSV of one normal keeps x and y, so planes have to be z = position; CSL's labels are not negative. */
static bvx_status check_section_format(bvx_context *ctx, const char *function, const bvx_sections *s,
                                       int32_t format, const double axis[3][3])
{
    /* A stack whose planes differ has its frames checked here, as there is no common one. */
    for (uint64_t i = 0; i < s->section_count && s->normals != NULL; i++) {
        double frame[3][3];
        if (format == BVX_FORMAT_SVG)
            return bvxi_fail_for(ctx, BVX_ERR_UNSUPPORTED, BVX_REASON_UNSUPPORTED,
                                 "%s: only CSL and CSV hold planes that each have a normal", function);
        BVXI_TRY(bvxi_section_frame(ctx, function, s->normals + 3 * i, frame));
    }

    /* Without normals CSV has no column for z, so it must be the position. */
    if (format == BVX_FORMAT_CSV) {
        if (s->normals != NULL) return BVX_OK;
        if (!(axis[2][2] == 1.0))
            return bvxi_fail_for(ctx, BVX_ERR_UNSUPPORTED, BVX_REASON_UNSUPPORTED,
                                 "%s: CSV holds planes z = position only; take CSL", function);
        for (uint64_t i = 0; i < s->loop_count; i++)
            for (uint64_t j = 0; j < s->loops[i].point_count; j++)
                if (s->points[3 * (s->loops[i].first_point + j) + 2] != s->positions[s->loops[i].section])
                    return bvxi_fail_for(
                        ctx, BVX_ERR_UNSUPPORTED, BVX_REASON_UNSUPPORTED,
                        "%s: loop %i has points off its plane, which CSV cannot hold; take CSL", function, i);
    } else if (format == BVX_FORMAT_CSL) {
        for (uint64_t i = 0; i < s->loop_count; i++)
            if (s->loops[i].label < 0)
                return bvxi_fail_for(ctx, BVX_ERR_UNSUPPORTED, BVX_REASON_UNSUPPORTED,
                                     "%s: CSL holds no negative labels (loop %i: %d)", function, i,
                                     (int64_t)s->loops[i].label);
    } else if (format == BVX_FORMAT_SVG) {
        /* The drawing scales by the extent, which must be a finite number for that. */
        double low[2], high[2];
        bound_drawing(s, axis, low, high);
        for (int k = 0; k < 2; k++)
            if (s->point_count > 0 && !(high[k] - low[k] < 0x1p1020))
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                     "%s: the points reach from %g to %g in their plane, too far to be drawn",
                                     function, low[k], high[k]);
    } else {
        return bvxi_fail_format(ctx, BVX_ERR_ARGUMENT, function, "contours", format, BVX_SECTIONS_WRITTEN);
    }
    return BVX_OK;
}

static bvx_status run_write_sections(bvx_context *context, const bvx_sections *sections, int32_t format,
                                     bvx_buffer *file)
{
    static const char *const function = "bvx_write_sections";
    double axis[3][3];
    bvxi_output out = {0};
    bvx_buffer made = {0};

    BVXI_TRY(bvxi_renew_buffer(context, function, file));
    BVXI_TRY(bvxi_sections_check(context, function, sections));
    BVXI_TRY(bvxi_section_frame(context, function,
                                sections->normals != NULL && sections->section_count != 0 ? sections->normals
                                                                                          : sections->normal,
                                axis));
    BVXI_TRY(check_section_format(context, function, sections, format, (const double(*)[3])axis));
    put_sections(sections, format, (const double(*)[3])axis, &out);
    BVXI_TRY(bvxi_alloc(context, BVXI_RESULT, out.size, "the contour file", &made.bytes));
    made.size = made.capacity = out.size;
    out.bytes = made.bytes;
    out.size = 0;
    put_sections(sections, format, (const double(*)[3])axis, &out);
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_sections(bvx_context *context, const bvx_sections *sections, int32_t format,
                              bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_sections(context, sections, format, file));
}
