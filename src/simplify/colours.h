/* colours.h - quadrics of colours, for levels that keep the borders of colours. Not installed. */
#ifndef BVXI_COLOURS_H
#define BVXI_COLOURS_H

#include "simplify/corners.h"

/* Of a vertex, about its position: sums over its triangles, by area w, of a
 * channel's value g x + d squared (a, b, c), and of gradients and values
 * themselves, by which the best colour of the vertex is taken out again. */
typedef struct bvxi_colour_quadric {
    double a[6], b[3], c;
    double g[3][3], d[3]; /* of each channel */
    double w;
} bvxi_colour_quadric;

/* Sums for all vertices, which are zeroed. colours: four bytes a vertex;
 * weight: length that a difference of 255 stands for, in units of 1 / scale. */
void bvxi_colours_start(const bvxi_corners *mesh, const uint8_t *colours, double weight, double scale,
                        bvxi_colour_quadric *at);
/* Both vertices' sums about u; offset leads from u to v. */
void bvxi_colours_join(const bvxi_colour_quadric *u, const bvxi_colour_quadric *v, const double offset[3],
                       bvxi_colour_quadric *both);
/* About a position that lies at an offset. */
void bvxi_colours_move(bvxi_colour_quadric *q, const double offset[3]);
/* Add what a vertex costs that has its best colour: a quadric of its position only. */
void bvxi_colours_add(const bvxi_colour_quadric *q, double a[6], double b[3], double *c);
/* Move the sums as bvxi_corners_pack moved vertices. */
void bvxi_colours_pack(bvxi_colour_quadric *at, uint64_t vertices, const uint32_t *moved);

#endif
