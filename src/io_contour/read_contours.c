/* read_contours.c - contour stacks from the bytes of a file: bvx_read_sections. */
#include "io_contour/contour_text.h"
#include "io/formats.h"
#include "contours/section.h"

static const bvxi_option read_sections_rows[] = {
    BVXI_REAL(bvx_read_sections_options, close_gap, 0.0, BVXI_FINITE),
    BVXI_RESERVED(bvx_read_sections_options, reserved),
};

static bvx_status run_read_sections(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                                    const bvx_read_sections_options *options, bvx_sections *sections)
{
    static const char *const function = "bvx_read_sections";
    bvx_read_sections_options o;

    if (bytes == NULL && size != 0) return bvxi_fail_null(context, function, "bytes");
    BVXI_TRY(bvxi_sections_check_result(context, function, sections));
    BVXI_TRY(bvxi_take_options(context, function, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, function, &o, BVXI_OPTIONS(read_sections_rows)));
    if (format != BVX_FORMAT_CSL && format != BVX_FORMAT_CSV)
        return bvxi_fail_format(context, BVX_ERR_UNSUPPORTED, function, "contours that are read", format,
                                BVX_SECTIONS_READ);
    if (size > SIZE_MAX / 2)
        return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u bytes are more than this machine addresses", function, size);

    bvxi_contour_file f = {.ctx = context, .format = format == BVX_FORMAT_CSL ? "CSL" : "CSV"};
    f.begin = f.p = bytes != NULL ? (const char *)bytes : "";
    f.end = f.begin + (size_t)size;
    f.sections.owned = 1;
    bvx_status status = format == BVX_FORMAT_CSL
                            ? bvxi_read_csl(&f)
                            : BVXI_SCOPE(context, bvxi_read_contour_table(&f, o.close_gap));
    if (status == BVX_OK) status = bvxi_contour_finish(&f, sections);
    if (status == BVX_OK && o.flipped != NULL) *o.flipped = f.flipped;

    bvxi_free(context, f.sections.normals, f.sections.normals == NULL ? 0 : f.normal_room * 24);
    f.sections.normals = NULL;
    bvx_sections_free(context, &f.sections);
    return status;
}

bvx_status bvx_read_sections(bvx_context *context, const void *bytes, uint64_t size, int32_t format,
                             const bvx_read_sections_options *options, bvx_sections *sections)
{
    return BVXI_CALL(context, run_read_sections(context, bytes, size, format, options, sections));
}
