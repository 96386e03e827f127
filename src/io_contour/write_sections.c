/* write_sections.c - contour stacks to CSL and CSV.
 *
 * The writer runs twice, to count and to write. CSL and CSV numbers are the shortest decimals that read back
 * to the same ones. */
#include "io/formats.h"
#include "contours/section.h"

#include <math.h>

/* ---- CSL ---- */

static void put_csl(const bvx_sections *s, const double normal[3], bvxi_output *o)
{
    int32_t most = 1;
    for (uint64_t i = 0; i < s->loop_count; i++)
        if (s->loops[i].label > most) most = s->loops[i].label;
    bvxi_output_print(o, "CSLC\n%u %u\n", (uint64_t)s->section_count, (uint64_t)most + 1);
    for (uint64_t k = 0; k < s->section_count; k++) {
        /* Number, counts and plane of a section. A stack of one direction has its unit normal in the frame
         * already. */
        uint64_t points = 0, loops = 0;
        for (uint64_t i = 0; i < s->loop_count; i++)
            if (s->loops[i].section == k) {
                points += s->loops[i].point_count;
                loops++;
            }
        double unit[3] = {normal[0], normal[1], normal[2]};

        if (s->normals != NULL) {
            const double *const n = s->normals + 3 * k;
            double const length = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
            for (int a = 0; a < 3; a++) unit[a] = n[a] / length;
        }
        /* CSL has the plane as a x + b y + c z + d = 0. */
        bvxi_output_print(o, "\n%u %u %u %v %g\n\n", k + 1, points, loops, unit, " ", -s->positions[k]);
        for (uint64_t i = 0; i < s->loop_count; i++) {
            if (s->loops[i].section != k) continue;
            for (uint64_t j = 0; j < s->loops[i].point_count; j++)
                bvxi_output_print(o, "%v\n", s->points + 3 * (s->loops[i].first_point + j), " ");
        }
        bvxi_output_print(o, "\n");

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

static void put_sections(const bvx_sections *s, int32_t format, const double normal[3], bvxi_output *o)
{
    if (format == BVX_FORMAT_CSL) put_csl(s, normal, o);
    else put_table(s, o);
}

/* CSV of one normal keeps x and y, so planes have to be z = position; CSL's labels are not negative. */
static bvx_status check_section_format(bvx_context *ctx, const char *function, const bvx_sections *s,
                                       int32_t format, const double normal[3])
{
    /* A stack whose planes differ has its frames checked here, as there is no common one. */
    for (uint64_t i = 0; i < s->section_count && s->normals != NULL; i++) {
        double frame[3][3];
        BVXI_TRY(bvxi_section_frame(ctx, function, s->normals + 3 * i, frame));
    }

    /* Without normals CSV has no column for z, so it must be the position. */
    if (format == BVX_FORMAT_CSV) {
        if (s->normals != NULL) return BVX_OK;
        if (!(normal[2] == 1.0))
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
    BVXI_TRY(check_section_format(context, function, sections, format, axis[2]));
    put_sections(sections, format, axis[2], &out);
    BVXI_TRY(bvxi_alloc(context, BVXI_RESULT, out.size, "the contour file", &made.bytes));
    made.size = made.capacity = out.size;
    out.bytes = made.bytes;
    out.size = 0;
    put_sections(sections, format, axis[2], &out);
    *file = made;
    return BVX_OK;
}

bvx_status bvx_write_sections(bvx_context *context, const bvx_sections *sections, int32_t format,
                              bvx_buffer *file)
{
    return BVXI_CALL(context, run_write_sections(context, sections, format, file));
}
