/* rounding.h - what the numbers of a file leave of a mesh. Not installed. */
#ifndef BVXI_ROUNDING_H
#define BVXI_ROUNDING_H

#include "io_mesh/mesh_formats.h"

typedef struct bvxi_rounding {
    double largest_move; /* of a coordinate, by rounding [Units: world] */
    double mean_edge;    /* of triangles, before it [Units: world] */
    uint64_t spoilt;     /* triangles that had an area and have none or lie turned over */
    int finite;          /* 0: a coordinate is beyond the range of floats; the other members are not set */
} bvxi_rounding;

/* 1 when the format's numbers are not exactly those of the mesh. */
int bvxi_is_rounded(const bvx_mesh *mesh, int32_t format);

/* The middle of the bounds of all levels: GLB writes positions relative to it. */
bvx_status bvxi_common_centre(bvx_context *ctx, const bvx_mesh *levels, uint64_t level_count,
                              double centre[3]);

/* A position as readers of 32-bit floats relative to a centre get it. */
static inline void bvxi_round_position(const double centre[3], const double p[3], double rounded[3])
{
    for (int a = 0; a < 3; a++) rounded[a] = bvxi_nearest_float(p[a] - centre[a]) + centre[a];
}

/* The mesh is checked and not empty; centre is zero for STL. */
void bvxi_measure_rounding(const bvx_mesh *mesh, const double centre[3], bvxi_rounding *r);

/* 1 when the file is still the mesh: nothing moves far beside its edges, and few triangles are spoilt. */
int bvxi_rounding_fits(const bvxi_rounding *r, uint64_t triangles);

/* Measure, and refuse what does not fit. name: what messages begin with. */
bvx_status bvxi_refuse_rounding(bvx_context *ctx, const char *name, const bvx_mesh *mesh, int32_t format,
                                const double centre[3]);

#endif
