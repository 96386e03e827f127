/* sheet.h - how much of all directions a sheet over the holes of a mesh covers. Not installed. */
#ifndef BVXI_SHEET_H
#define BVXI_SHEET_H

#include "voxelize/holes.h"

#include <math.h>

/* What the sheet over points i .. j of a loop is from far off; kept for the point halfway. [Units: the largest spacing] */
typedef struct bvxi_sheet_node {
    double centre[3], radius; /* a ball that holds all points i .. j */
    double normal[3];         /* half the cross products: area times direction */
    double area;              /* of its triangles, each by itself */
    double length;            /* of the edges from i to j */
    double chord;             /* from i to j */
} bvxi_sheet_node;

typedef struct bvxi_sheet {
    const bvxi_holes *holes;
    const int32_t *xyz;    /* snapped, in the order x y z */
    double *point;         /* x, y, z of each [Size: holes->points * 3] [Units: the largest spacing] */
    bvxi_sheet_node *node; /* [Size: holes->points] */
    uint32_t *order;       /* loops, neighbours near each other [Size: holes->loops] */
    bvxi_sheet_node *group; /* of the loops order[i] .. order[j - 1], at i + (j - i) / 2; length and chord stay 0 */
    double scale[3];       /* fixed point to these units */
    double step[3];        /* one voxel */
    int32_t fraction_bits;
} bvxi_sheet;

static inline const double *bvxi_sheet_point(const bvxi_sheet *s, uint64_t i)
{
    return s->point + 3 * i;
}

static inline double bvxi_sheet_length(const double v[3])
{
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static inline uint64_t bvxi_loop_begin(const bvxi_holes *holes, uint32_t loop)
{
    return loop == 0 ? 0 : holes->loop_end[loop - 1];
}

/* What loops order[i] .. order[j - 1] are from far off. */
static inline const bvxi_sheet_node *bvxi_sheet_group(const bvxi_sheet *s, uint64_t i, uint64_t j)
{
    uint64_t begin;
    if (j - i > 1) return &s->group[i + (j - i) / 2];
    begin = bvxi_loop_begin(s->holes, s->order[i]);
    return &s->node[begin + (s->holes->loop_end[s->order[i]] - 1 - begin) / 2];
}

/* sheet_nodes.c. Scratch: 104 bytes a point, 92 a loop. */
bvx_status bvxi_sheet_open(bvx_context *ctx, const bvxi_holes *holes, const bvxi_snapped *snapped, const bvx_lattice *lattice,
                           bvxi_sheet *sheet);
void bvxi_sheet_close(bvx_context *ctx, bvxi_sheet *sheet);

/* touching_angle.c: half the solid angle of triangle q at the displaced centre p, as that of (re, im), where doubles cannot tell:
 * in its plane or nearly so. v: the corners as seen from p; det, re, im: what doubles have, det also for im. Returns 1 where p
 * lies on the side away from its normal, where the angle is positive. */
int bvxi_touching_angle(const int32_t *const q[3], const int64_t p[3], const double v[3][3], double det, double *re, double *im);

/* The sheet's solid angle at the displaced centre of a voxel of the lattice, in turns (a closed sheet has 1 inside). */
typedef struct bvxi_sheet_answer {
    int32_t odd;   /* 1: the nearest whole number is odd */
    int32_t clear; /* 1: it is nearer than a quarter; only when asked for */
    int32_t same;  /* so many voxels to either side along x have the same, odd but for crossings of the sheet on the way */
} bvxi_sheet_answer;

bvxi_sheet_answer bvxi_sheet_turns(const bvxi_sheet *sheet, int32_t x, int32_t y, int32_t z, int32_t want_clear);

#endif
