/* voxel_normal.c - a normal from the voxels around.
 *
 * Idea: the set voxels within a ball have their middle away from the surface, so it lies against the normal
 * (Thürmer, Wüthrich. Normal computation for discrete surfaces in 3D space. 1997). Seven bits of a row are
 * looked up at once. */
#include "render/raster.h"

enum { BALL = 3, BALL_BITS = 2 * BALL + 1 };

/* Seven bits of a row from x on, bit shift of a word; bits outside the row are 0. */
static unsigned ball_bits(const uint64_t *row, const uint64_t *also, int32_t words, int32_t word,
                          int32_t shift)
{
    if (word >= 0 && shift <= 64 - BALL_BITS)
        return (unsigned)((row[word] | also[word]) >> shift) & ((1u << BALL_BITS) - 1);
    uint64_t const low = word >= 0 && word < words ? row[word] | also[word] : 0;
    uint64_t const high = word + 1 < words ? row[word + 1] | also[word + 1] : 0;
    return (unsigned)((low >> shift | (shift > 0 ? high << (64 - shift) : 0)) & ((1u << BALL_BITS) - 1));
}

void bvxi_voxel_normal(const bvx_grid *grid, const uint64_t *also, const double spacing[3], int32_t i,
                       int32_t j, int32_t k, double n[3])
{
    /* bits of a row that lie in the ball (a^2 + b^2 + c^2 <= 13), by the row's b^2 + c^2 */
    static const uint8_t in_ball[2 * BALL * BALL + 1] = {
        0x7f, 0x7f, 0x7f, 0x7f, 0x7f, 0x3e, 0x3e, 0x3e, 0x3e, 0x3e, 0x1c, 0x1c, 0x1c, 0x08, 0, 0, 0, 0, 0};

    /* of three bits: how many, and the sum of their places left (-3, -2,
     * -1) and right (1, 2, 3) of the middle */
    static const int8_t count[8] = {0, 1, 1, 2, 1, 2, 2, 3};
    static const int8_t left[8] = {0, -3, -2, -5, -1, -4, -3, -6}, right[8] = {0, 1, 2, 3, 3, 4, 5, 6};
    int32_t const word = i < BALL ? -1 : (i - BALL) >> 6, shift = i - BALL - word * 64;
    int32_t sum[3] = {0, 0, 0};

    for (int32_t c = -BALL; c <= BALL; c++) {
        if (k + c < 0 || k + c >= grid->size[2]) continue;
        for (int32_t b = -BALL; b <= BALL; b++) {
            if (j + b < 0 || j + b >= grid->size[1]) continue;
            size_t const row = ((size_t)(k + c) * (size_t)grid->size[1] + (size_t)(j + b)) *
                               (size_t)grid->words_per_row;
            unsigned const bits = ball_bits(grid->words + row, also + row, grid->words_per_row, word, shift) &
                                  in_ball[b * b + c * c];
            int32_t const set = count[bits & 7] + (int32_t)(bits >> 3 & 1) + count[bits >> 4];
            sum[0] += left[bits & 7] + right[bits >> 4];
            sum[1] += set * b;
            sum[2] += set * c;
        }
    }
    for (int a = 0; a < 3; a++) n[a] = -(double)sum[a] * spacing[a];
}
