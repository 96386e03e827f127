/* lone_section.h - a body whose loops all lie in one section. Not installed. */
#ifndef BVXI_LONE_SECTION_H
#define BVXI_LONE_SECTION_H

#include "contours/section.h"

typedef struct bvxi_lone {
    int times;             /* that the section stands in sections; 0: the body has several of its own */
    bvx_sections sections; /* what the body is made of */
    bvx_sections copies;   /* the arrays of a slab */
} bvxi_lone;

/* section: the only one that has loops of the body, or BVXI_NONE: look for it. Close it also after a
 * failure. */
bvx_status bvxi_lone_open(bvx_context *ctx, const char *function, const bvx_sections *given, uint32_t section,
                          const bvx_sections_options *options, bvxi_lone *lone);
/* What was counted once for each copy, as it was given. */
void bvxi_lone_report(const bvxi_lone *lone, bvx_sections_report *report);

#endif
