/* sections_free.c - contour stacks that the library made. */
#include "section/section.h"

void bvx_sections_free(bvx_context *context, bvx_sections *sections)
{
    if (context == NULL || sections == NULL) return;
    /* What the caller brought is the caller's to free. */
    if (sections->owned) {
        bvxi_free(context, sections->normals,
                  sections->normals == NULL ? 0 : sections->section_capacity * 24);
        bvxi_free(context, sections->positions, sections->section_capacity * 8);
        bvxi_free(context, sections->loops, sections->loop_capacity * sizeof *sections->loops);
        bvxi_free(context, sections->points, sections->point_capacity * 24);
    }
    memset(sections, 0, sizeof *sections);
}
