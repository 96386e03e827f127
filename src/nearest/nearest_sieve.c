/* nearest_sieve.c - a list of leaves seen from all centres of a brick at once.
 *
 * The squared distance from a centre to a box is a sum of one term an axis, and a brick's 64 centres have
 * four places along each: twelve terms a box give the distances from all of them. The least over a group of
 * eight is the sum of the least terms. */
#include "nearest/nearest_brick.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

static inline float sieve_larger(float x, float y)
{
    return x > y ? x : y;
}

static inline float sieve_smaller(float x, float y)
{
    return x < y ? x : y;
}

static void sieve_near_block(const bvxi_near_block *b, const bvxi_near_places *places, float limit2,
                             float square[3][BVXI_NEAR_SIDE][BVXI_NEAR_WIDTH], uint8_t reach[8])
{
    memset(reach, 0, 8);
    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) {
        float least[3][2];
        for (int a = 0; a < 3; a++) {
            for (int i = 0; i < BVXI_NEAR_SIDE; i++) {
                float const out = sieve_larger(
                    sieve_larger(b->low[a][k] - places->at[a][i], places->at[a][i] - b->high[a][k]), 0.0f);
                square[a][i][k] = out * out;
            }
            for (int i = 0; i < 2; i++)
                least[a][i] = sieve_smaller(square[a][2 * i][k], square[a][2 * i + 1][k]);
        }
        for (int g = 0; g < 8; g++)
            reach[g] |=
                (uint8_t)((uint32_t)(least[0][g & 1] + least[1][g >> 1 & 1] + least[2][g >> 2] <= limit2)
                              << k &
                          b->listed);
    }
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static inline void sieve_near_block_avx2(const bvxi_near_block *b, const bvxi_near_places *places,
                                                   __m256 limit2,
                                                   float square[3][BVXI_NEAR_SIDE][BVXI_NEAR_WIDTH],
                                                   uint8_t reach[8])
{
    __m256 least[3][2];

    for (int a = 0; a < 3; a++) {
        __m256 const low = _mm256_loadu_ps(b->low[a]), high = _mm256_loadu_ps(b->high[a]);
        for (int i = 0; i < 2; i++) {
            __m256 const p = _mm256_broadcast_ss(&places->at[a][2 * i]);
            __m256 const q = _mm256_broadcast_ss(&places->at[a][2 * i + 1]);
            __m256 const x = _mm256_max_ps(_mm256_max_ps(low - p, p - high), _mm256_setzero_ps());
            __m256 const y = _mm256_max_ps(_mm256_max_ps(low - q, q - high), _mm256_setzero_ps());
            __m256 const x2 = x * x, y2 = y * y;
            _mm256_storeu_ps(square[a][2 * i], x2);
            _mm256_storeu_ps(square[a][2 * i + 1], y2);
            least[a][i] = _mm256_min_ps(x2, y2);
        }
    }
    for (int g = 0; g < 8; g++)
        reach[g] = (uint8_t)((uint32_t)_mm256_movemask_ps(
                                 _mm256_cmp_ps(least[0][g & 1] + least[1][g >> 1 & 1] + least[2][g >> 2],
                                               limit2, _CMP_LE_OQ)) &
                             b->listed);
}

BVXI_AVX2 static void sieve_near_list_avx2(const bvxi_near_list *list, const bvxi_near_places *places,
                                           float limit2, bvxi_near_sieve *sieve)
{
    for (int32_t i = 0; i < list->count; i++)
        sieve_near_block_avx2(&list->block[i], places, _mm256_set1_ps(limit2), sieve->square[i],
                              sieve->reach[i]);
}
#endif

void bvxi_near_sieve_list(const bvxi_near_list *list, const bvxi_near_places *places, float limit2,
                          int32_t fast, bvxi_near_sieve *sieve)
{
#if BVXI_HAVE_AVX2
    if (fast) {
        sieve_near_list_avx2(list, places, limit2, sieve);
        return;
    }
#endif
    (void)fast;
    for (int32_t i = 0; i < list->count; i++)
        sieve_near_block(&list->block[i], places, limit2, sieve->square[i], sieve->reach[i]);
}
