/* morph.h - growing and shrinking sets of voxels: the operation as numbers, boxes of bits to work on, a word
 * and its neighbours along x. Not installed. */
#ifndef BVXI_MORPH_H
#define BVXI_MORPH_H

#include "grid/grid.h"
#include "morphology/transform.h"

enum { BVXI_DILATE = 0, BVXI_ERODE = 1 };

/* How a set is changed: steps times by the first operation, then, unless
 * they are one, as often by the second. */
typedef struct bvxi_morph {
    const char *stage;     /* for progress */
    int32_t operation[2];  /* BVXI_... */
    int32_t operations;    /* 1 or 2 */
    int32_t neighbourhood; /* 6, 18, 26; 0: ball */
    int32_t steps;
    int32_t beyond;          /* what lies around the box: 0 empty, 1 set */
    double weight[3], limit; /* ball: of bvxi_transform, and the largest square in it */
} bvxi_morph;

static inline bvxi_bit_box bvxi_box_of_grid(const bvx_grid *grid)
{
    bvxi_bit_box box = {NULL, {0, 0, 0}, 0};
    box.words = grid->words;
    memcpy(box.size, grid->size, sizeof box.size);
    box.row_words = grid->words_per_row;
    return box;
}

static inline uint64_t bvxi_box_words(const bvxi_bit_box *box)
{
    return (uint64_t)box->row_words * (uint64_t)box->size[1] * (uint64_t)box->size[2];
}

/* Sweeps that this takes; each reads one box and writes another one. */
int32_t bvxi_step_sweeps(const bvxi_morph *morph, const bvxi_bit_box *box);
/* source -> first -> second -> first ... until all sweeps are done. The boxes are of one size; second is
 * looked at from two sweeps on and may be source. Memory (scratch): a few slices for each worker. */
bvx_status bvxi_morph_steps(bvx_context *ctx, const bvxi_morph *morph, const bvxi_bit_box *source,
                            const bvxi_bit_box *first, const bvxi_bit_box *second);

/* What the ball of a radius is in squares of the transform (weight and limit of morph). */
bvx_status bvxi_ball_set(bvx_context *ctx, const char *function, const bvx_lattice *lattice, double radius,
                         bvxi_morph *morph);
/* Voxels that the ball reaches along an axis, at most one more. */
int32_t bvxi_ball_reach(const bvxi_morph *morph, int axis);
/* One operation from box to box. */
bvx_status bvxi_morph_ball(bvx_context *ctx, const bvxi_morph *morph, int32_t operation, double from,
                           double to, const bvxi_bit_box *source, const bvxi_bit_box *target);

int bvxi_ball_is_small(const bvxi_morph *morph);
/* As bvxi_morph_ball, for those only. */
bvx_status bvxi_morph_runs(bvx_context *ctx, const bvxi_morph *morph, int32_t operation, double from,
                           double to, const bvxi_bit_box *source, const bvxi_bit_box *target);

/* Change a grid as morph says into words that may not be its own. */
bvx_status bvxi_morph_run(bvx_context *ctx, const bvxi_morph *morph, const bvx_grid *grid, bvx_grid *result);

#define BVXI_TOP_BIT (UINT64_C(1) << 63)

/* For each word of a slice: what may come in from the word before (its lowest bit, or none in a row's first
 * word) and from the one behind (the highest, or none in a row's last). */
typedef struct bvxi_row_ends {
    uint64_t *before, *behind;
    uint64_t bytes;
} bvxi_row_ends;

bvx_status bvxi_row_ends_open(bvx_context *ctx, const bvxi_bit_box *box, bvxi_row_ends *ends);

/* Word k of a slice joined with itself one voxel on and back; around comes
 * in at the ends of rows. w[-1] and w[1] are looked at. */
static inline uint64_t bvxi_with_sides(const uint64_t *w, const bvxi_row_ends *ends, size_t k,
                                       uint64_t around)
{
    uint64_t const before = (w[-1] >> 63 & ends->before[k]) | ((around & 1) & ~ends->before[k]);
    uint64_t const behind = (w[1] << 63 & ends->behind[k]) | ((around & BVXI_TOP_BIT) & ~ends->behind[k]);
    return w[0] | w[0] << 1 | w[0] >> 1 | before | behind;
}

#endif
