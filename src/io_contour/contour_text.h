/* contour_text.h - contour files: words and lines of text, and the stack that grows from them. Not
 * installed. */
#ifndef BVXI_CONTOUR_TEXT_H
#define BVXI_CONTOUR_TEXT_H

#include "io/formats.h"

typedef struct bvxi_contour_file {
    bvx_context *ctx;
    const char *format; /* "CSL" */
    const char *begin, *p, *end;
    bvx_sections sections; /* owned; freed by the caller after a failure */
    uint64_t normal_room;  /* of its normals */
    int oblique;           /* some planes are not parallel to the first one */
    uint64_t upright;      /* planes whose points lie where their equation says, and not on its other side */
    uint64_t flipped;      /* the other way round */
} bvxi_contour_file;

/* "FORMAT: line N: what". */
BVXI_COLD bvx_status bvxi_contour_fail(const bvxi_contour_file *f, const char *at, bvx_status status,
                                       const char *what);
BVXI_COLD bvx_status bvxi_contour_fail_number(const bvxi_contour_file *f, const char *at, const char *what,
                                              uint64_t number, const char *rest);

bvx_status bvxi_contour_add_section(bvxi_contour_file *f, double position);
/* One with a normal of its own. */
bvx_status bvxi_contour_add_plane(bvxi_contour_file *f, double position, const double normal[3]);
bvx_status bvxi_contour_add_loop(bvxi_contour_file *f, uint32_t section, int32_t label);
/* To the last loop. */
bvx_status bvxi_contour_add_point(bvxi_contour_file *f, const double p[3]);
/* Arrays of exact size. */
bvx_status bvxi_contour_finish(bvxi_contour_file *f, bvx_sections *sections);

bvx_status bvxi_read_csl(bvxi_contour_file *f);
bvx_status bvxi_read_contour_table(bvxi_contour_file *f, double close_gap);

static inline int bvxi_contour_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r';
}

#endif
