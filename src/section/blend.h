/* blend.h - what a signed distance is between two sections, from it on these and on the ones beyond. Not
 * installed. */
#ifndef BVXI_SECTION_BLEND_H
#define BVXI_SECTION_BLEND_H

/* Sections that a blend looks at: the two it lies between, and those beyond them. */
enum { BVXI_BLEND_BELOW, BVXI_BLEND_ABOVE, BVXI_BLEND_FAR_BELOW, BVXI_BLEND_FAR_ABOVE, BVXI_BLEND_SECTIONS };

/* Ways from section to section; 0: there is none beyond. */
typedef struct bvxi_blend {
    double height, below, above;
} bvxi_blend;

/* Between the sections: t 0 is the one below, 1 the one above. */
double bvxi_blend_value(const bvxi_blend *blend, const double value[BVXI_BLEND_SECTIONS], double t);
/* Where it is 0, when the values on the two sections are of different signs. */
double bvxi_blend_zero(const bvxi_blend *blend, const double value[BVXI_BLEND_SECTIONS]);

#endif
