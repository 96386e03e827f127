/* morph_ball.c - dilation and erosion by a Euclidean ball: which centres lie within a radius of a set or an
 * empty one.
 *
 * Source: Cuisenaire, Macq. Fast Euclidean Morphological Operators Using Local Distance Transformation by
 * Propagation. 1999 (a ball's dilation is a distance transform with a threshold); here by transform.c, whose
 * squares become bits as they come, so no field of numbers is held beside one tile of 16 columns. Rows
 * further than the radius from all targets along x are left out. This takes as long for any radius; balls of
 * less than about 35 voxels are done sooner as runs of bits (morph_runs.c), and both make the same bits. */
#include "morphology/morph.h"

#include <math.h>

#define BALL_SPARE (1.0 + 0x1p-39) /* of the square: 2^-40 of the radius */

typedef struct ball_job {
    bvxi_bit_box to;
    uint32_t whole_limit;
    double limit;
    int32_t whole, erode;
} ball_job;

bvx_status bvxi_ball_set(bvx_context *ctx, const char *function, const bvx_lattice *lattice, double radius,
                         bvxi_morph *morph)
{
    const double *const s = lattice->spacing;
    int const cubic = s[0] == s[1] && s[0] == s[2];
    /* Cubic voxels count in steps, so that whole numbers decide. */
    double const r = cubic ? radius / s[0] : radius;

    for (int32_t a = 0; a < 3; a++)
        if (s[a] < 0x1p-400 || s[a] > 0x1p400)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: squares of a spacing of %g are beyond what doubles hold well", function,
                                 s[a]);
    morph->neighbourhood = 0;
    morph->steps = 1;
    /* A little more than the square, so that what lies at the radius is within it in spite of rounding. */
    morph->limit = r * r * BALL_SPARE;
    for (int a = 0; a < 3; a++) morph->weight[a] = cubic ? 1.0 : s[a] * s[a];
    return BVX_OK;
}

int32_t bvxi_ball_reach(const bvxi_morph *morph, int axis)
{
    double const reach = sqrt(morph->limit / morph->weight[axis]);
    return reach < 1e9 ? (int32_t)reach + 1 : 1000000000; /* More than any grid is wide. */
}

static void take_ball_squares(void *user, int32_t x, int32_t y, int32_t z, int32_t count, const void *squares,
                              const uint64_t *nearest)
{
    const ball_job *const job = user;
    size_t const row = (size_t)z * (size_t)job->to.size[1] + (size_t)y;
    const uint32_t *const whole = squares;
    const double *const real = squares;
    uint32_t bits = 0;

    /* Squares become 16 bits at once; only those of the row's end are fewer. */
    (void)nearest;
    if (job->whole)
        for (int32_t i = 0; i < BVXI_LANES; i++) bits |= (uint32_t)(whole[i] <= job->whole_limit) << i;
    else
        for (int32_t i = 0; i < BVXI_LANES; i++) bits |= (uint32_t)(real[i] <= job->limit) << i;
    if (job->erode) bits = ~bits;
    bits &= 0xffffu >> (BVXI_LANES - count);
    job->to.words[row * (size_t)job->to.row_words + (size_t)(x >> 6)] |= (uint64_t)bits << (x & 63);
}

bvx_status bvxi_morph_ball(bvx_context *ctx, const bvxi_morph *morph, int32_t operation, double from,
                           double to, const bvxi_bit_box *source, const bvxi_bit_box *target)
{
    int const erode = operation == BVXI_ERODE;
    bvxi_transform t = {.ctx = ctx, .from = from, .to = to, .groups = 1};
    ball_job job;

    if (bvxi_ball_is_small(morph))
        return BVXI_SCOPE(ctx, bvxi_morph_runs(ctx, morph, operation, from, to, source, target));

    job.to = *target;
    job.limit = morph->limit < 1e300 ? morph->limit : 1e300; /* no target is infinite */
    job.whole_limit = morph->limit < 4294967294.0 ? (uint32_t)morph->limit : UINT32_MAX - 1;
    job.erode = erode;
    job.whole = morph->weight[0] == 1.0 && morph->weight[1] == 1.0 && morph->weight[2] == 1.0 &&
                bvxi_transform_fits_whole(source->size);
    t.stage = morph->stage;
    t.box = *source;
    /* Erosion measures from empty voxels, and what lies beyond is turned with them. */
    t.flip = erode;
    t.beyond = erode ? !morph->beyond : morph->beyond;
    t.whole = job.whole;
    memcpy(t.weight, morph->weight, sizeof t.weight);
    t.limit = morph->limit;
    t.sink = take_ball_squares;
    t.user = &job;
    /* Rows and tiles are written bit by bit, from zero. */
    memset(target->words, 0, (size_t)bvxi_box_words(target) * 8);
    return bvxi_transform_run(&t);
}
