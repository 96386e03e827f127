/* nearest_eight.c - triangles that may be nearest to eight centres.
 *
 * Three sieves, each for eight at once. Leaves: those whose box is nearer to some centre than the nearest
 * that the centre knows of, to begin with a point of each leaf. Triangles of these leaves, by the same test.
 * As the centres are the corners of a box, six squares and twelve sums give the distances of all eight from
 * a box. A brick's 64 centres have four places along each axis, so twelve squares a leaf serve its eight
 * groups, and the least over a group is the sum of the least terms. Then the distances from all eight centres
 * to one triangle after the other. All triangles are chosen before the first is measured, so nothing waits
 * for what was measured before.
 * Guarantee: of every centre requested, the triangle that wins the evaluation in doubles is among the
 * winners, and so is every one that does as well. */
#include "nearest/nearest_brick.h"
#include "core/simd.h"

#include <math.h>

/* So far ahead memory is on its way before it is needed. */
enum { NEAR_AHEAD_OF = 8, NEAR_AHEAD_LEAVES = 3 };

static inline const bvxi_near_frame *near_frame(const bvxi_near_leaf *leaves, uint32_t place)
{
    return &leaves[place / BVXI_NEAR_WIDTH].frame[place % BVXI_NEAR_WIDTH];
}

void bvxi_near_eight_begin(int32_t group, const bvxi_near_places *places, uint32_t active, float limit2,
                           bvxi_near_eight *e)
{
    e->group = group;
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < 2; i++) e->ends[a][i] = places->at[a][(group >> a & 1) * 2 + i];
        for (int c = 0; c < 8; c++) e->at[a][c] = e->ends[a][c >> a & 1];
    }
    /* A centre that nobody asks for is nearer to everything than anything, so nothing is looked at for it. */
    for (int c = 0; c < 8; c++) e->least2[c] = active >> c & 1 ? limit2 : -0x1p120f;
    e->error = 0.0f;
    e->count = 0;
}

/* Slack as in nearest_cell.c, for two distances' errors each way. */
static void slacken_near_eight(bvxi_near_eight *e)
{
    float const slack = 16.0f * e->error * e->error * (1.0f + 1.0f / BVXI_NEAR_SLACK);
    for (int c = 0; c < 8; c++) e->drop2[c] = e->least2[c] * (1.0f + BVXI_NEAR_SLACK) + slack;
}

/* ---- Numbers of set bits: a byte's, appended to an array that has room for eight more; their count ---- */

static inline uint32_t near_append_base(uint32_t mask, uint32_t base, uint16_t *to)
{
    uint32_t count = 0;
    for (; mask != 0; mask &= mask - 1) to[count++] = (uint16_t)(base + (uint32_t)bvxi_lowest(mask));
    return count;
}

static inline uint32_t near_append_wide_base(uint32_t mask, uint32_t base, uint32_t *to)
{
    uint32_t count = 0;
    for (; mask != 0; mask &= mask - 1) to[count++] = base + (uint32_t)bvxi_lowest(mask);
    return count;
}

#if BVXI_HAVE_AVX2
/* All eight are written whether there are so many or not: a branch for each bit would be guessed wrongly. */
BVXI_AVX2 static inline __m128i near_set_bits(uint32_t mask)
{
    return _mm_cvtsi64_si128((long long)_pext_u64(UINT64_C(0x0706050403020100),
                                                  _pdep_u64(mask, UINT64_C(0x0101010101010101)) * 255));
}

BVXI_AVX2 static inline uint32_t near_append_avx2(uint32_t mask, uint32_t base, uint16_t *to)
{
    __m128i const numbers = _mm_cvtepu8_epi16(near_set_bits(mask));
    _mm_storeu_si128((__m128i *)(void *)to, _mm_add_epi16(numbers, _mm_set1_epi16((short)base)));
    return (uint32_t)_mm_popcnt_u32(mask);
}

BVXI_AVX2 static inline uint32_t near_append_wide_avx2(uint32_t mask, uint32_t base, uint32_t *to)
{
    __m256i const numbers = _mm256_cvtepu8_epi32(near_set_bits(mask));
    _mm256_storeu_si256((__m256i *)(void *)to, _mm256_add_epi32(numbers, _mm256_set1_epi32((int)base)));
    return (uint32_t)_mm_popcnt_u32(mask);
}
#endif

/* ---- The sieves ---- */

#define BVXI_SIMD_LEVEL _base
#include "nearest/nearest_eight_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/nearest_eight_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_near_sieve_list(const bvxi_near_list *list, const bvxi_near_places *places, float limit2,
                          int32_t fast, bvxi_near_sieve *sieve)
{
    BVXI_PATH(fast, sieve_near_list_base(list, places, limit2, sieve),
              sieve_near_list_avx2(list, places, limit2, sieve));
}

void bvxi_near_eight_take(const bvxi_near_list *list, const bvxi_near_sieve *sieve, int32_t fast,
                          bvxi_near_eight *e)
{
    e->error = list->error > e->error ? list->error : e->error;
    e->leaves = e->next = 0;
    BVXI_PATH(fast, take_near_list_base(list, sieve, e), take_near_list_avx2(list, sieve, e));
}

int32_t bvxi_near_eight_look(const bvxi_nearest *n, const bvxi_near_list *list, const float origin[3],
                             int32_t fast, bvxi_near_eight *e)
{
    BVXI_PATH(fast, look_near_base(n, list, origin, e), look_near_avx2(n, list, origin, e));
    return e->next == e->leaves;
}

int32_t bvxi_near_eight_winners(const bvxi_nearest *n, int32_t fast, bvxi_near_eight *e, float most2[8],
                                bvxi_near_winner *winners)
{
    /* Floats have erred at most by the error for the least and for another that is as near in truth. */
    for (int c = 0; c < 8; c++) {
        float const d = (float)sqrt((double)(e->least2[c] > 0.0f ? e->least2[c] : 0.0f)) + 2.0f * e->error;
        most2[c] = e->least2[c] < 0.0f ? -1.0f : d * d * (1.0f + 0x1p-20f);
    }
    int32_t const count = BVXI_PATH(fast, find_near_winners_base(n->leaves, most2, e, winners),
                                    find_near_winners_avx2(n->leaves, most2, e, winners));
    e->count = 0;
    return count;
}
