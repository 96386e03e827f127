/* boolean_lattice.c - where an operation on two bodies needs voxels, and how many it needs.
 *
 * A half-space that cuts a part is a box a hundred times as large; a lattice around both would leave a few
 * voxels to the part. What is left of a difference lies within a, of an intersection within both boxes: only
 * there the lattice has to be. */
#include "pipeline/steps.h"
#include "lattice/lattice.h"

#include <math.h>

static bvxi_body_box joined_boxes(const bvxi_body_box box[2])
{
    bvxi_body_box r = box[0];

    for (int a = 0; a < 3; a++) {
        r.low[a] = box[1].low[a] < r.low[a] ? box[1].low[a] : r.low[a];
        r.high[a] = box[1].high[a] > r.high[a] ? box[1].high[a] : r.high[a];
    }
    return r;
}

/* Boxes that have no space in common leave nothing; the first one is then as good as any. */
static bvxi_body_box common_box(const bvxi_body_box box[2])
{
    bvxi_body_box r = box[0];

    for (int a = 0; a < 3; a++) {
        r.low[a] = box[1].low[a] > r.low[a] ? box[1].low[a] : r.low[a];
        r.high[a] = box[1].high[a] < r.high[a] ? box[1].high[a] : r.high[a];
        /* Without common space: nothing is left, and any lattice shows that. */
        if (!(r.low[a] < r.high[a])) return box[0];
    }
    return r;
}

/* Farther vertices need fewer fraction bits for their places to fit 2^30. */
static void give_way(const bvxi_body_box box[2], bvx_lattice *l)
{
    double farthest = 0.0;

    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) {
            /* How far the farther ends of both boxes lie, in voxels. */
            double const below = (l->origin[a] - box[i].low[a]) / l->spacing[a];
            double const above = (box[i].high[a] - l->origin[a]) / l->spacing[a];
            farthest = below > farthest ? below : farthest;
            farthest = above > farthest ? above : farthest;
        }
    while (l->fraction_bits > BVXI_MIN_FRACTION &&
           farthest * (double)((int64_t)1 << l->fraction_bits) > 0.5 * BVXI_FIXED_LIMIT)
        l->fraction_bits--;
}

bvx_status bvxi_boolean_lattice(bvx_context *ctx, int32_t operation, int32_t resolution,
                                const bvxi_body_box box[2], bvx_lattice *lattice)
{
    bvxi_body_box const fit = operation == BVX_BOOLEAN_DIFFERENCE     ? box[0]
                              : operation == BVX_BOOLEAN_INTERSECTION ? common_box(box)
                                                                      : joined_boxes(box);
    bvx_lattice_options o;

    bvx_lattice_options_init(&o, sizeof o);
    o.resolution = resolution;
    /* A layer around, so that the surface closes within the lattice. */
    o.padding = 1;
    BVXI_TRY(bvx_lattice_fit_box(ctx, fit.low, fit.high, &o, lattice));
    give_way(box, lattice);
    return BVX_OK;
}

bvxi_box_sides bvxi_sides_on_lattice(const bvxi_body_box *box, const bvx_lattice *lattice)
{
    static bvxi_box_sides const none = {0.0, 0.0, 0};
    bvxi_box_sides r = {0.0, 1e300, 1};

    for (int a = 0; a < 3; a++) {
        double const h = lattice->spacing[a], far_end = lattice->origin[a] + lattice->dims[a] * h;
        double const low = box->low[a] > lattice->origin[a] ? box->low[a] : lattice->origin[a];
        double const high = box->high[a] < far_end ? box->high[a] : far_end, n = (high - low) / h;

        /* Beside the lattice: nothing of the body is there. */
        if (n < 0.0) return none;
        r.whole &= low == box->low[a] && high == box->high[a];
        r.longest = n > r.longest ? n : r.longest;
        r.shortest = n < r.shortest ? n : r.shortest;
    }
    return r;
}

int32_t bvxi_advised_resolution(const bvx_lattice *lattice, double voxels, double wanted)
{
    int32_t longest = 1;
    double n;

    /* The padding's voxels hold nothing. */
    for (int a = 0; a < 3; a++) longest = lattice->dims[a] - 2 > longest ? lattice->dims[a] - 2 : longest;
    n = voxels > 0.0 ? longest * (wanted / voxels) : 1e300;
    return n < (double)(1 << 24) ? (int32_t)-floor(-n) : 1 << 24;
}
