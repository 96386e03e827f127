/* nearest_eight.c - triangles that may be nearest to eight centres.
 *
 * Three sieves, each for eight at once. Leaves: those whose box is nearer to some centre than the nearest
 * that the centre knows of, to begin with a point of each leaf. Triangles of these leaves, by the same test.
 * As the centres are the corners of a box, six squares and twelve sums give the distances of all eight from a
 * box (nearest_sieve.c has the leaves' squares). Then the distances from all eight centres to one triangle
 * after the other. All triangles are chosen before the first is measured, so nothing waits for what was
 * measured before.
 * Guarantee: of every centre requested, the triangle that wins the evaluation in doubles is among the
 * winners, and so is every one that does as well. */
#include "nearest/nearest_brick.h"

#include <math.h>
#if BVXI_HAVE_AVX2
#include <immintrin.h>
enum { NEAR_AHEAD_OF = 8, NEAR_AHEAD_LEAVES = 3 };
#define NEAR_ONE(x) _mm256_broadcast_ss(&(x))
#endif

static inline float near_most(float x, float y)
{
    return x > y ? x : y;
}

static inline const bvxi_near_frame *near_frame(const bvxi_near_leaf *leaves, uint32_t place)
{
    return &leaves[place / BVXI_NEAR_WIDTH].frame[place % BVXI_NEAR_WIDTH];
}

/* ---- Leaves ---- */

void bvxi_near_eight_begin(int32_t group, const bvxi_near_places *places, uint32_t active, float limit2,
                           bvxi_near_eight *e)
{
    e->group = group;
    for (int a = 0; a < 3; a++) {
        for (int i = 0; i < 2; i++) e->ends[a][i] = places->at[a][(group >> a & 1) * 2 + i];
        for (int c = 0; c < 8; c++) e->at[a][c] = e->ends[a][c >> a & 1];
    }
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

static void bound_near_eight(const bvxi_near_block *b, int k, bvxi_near_eight *e)
{
    for (int c = 0; c < 8; c++) {
        float const x = e->at[0][c] - b->point[0][k];
        float const y = e->at[1][c] - b->point[1][k];
        float const z = e->at[2][c] - b->point[2][k];
        float const d = x * x + y * y + z * z;
        e->least2[c] = d < e->least2[c] ? d : e->least2[c];
    }
}

/* Bits of eight boxes that lie within drop2 of some centre, from the
 * squares of their distances along the axes. */
static uint32_t near_boxes(const float *const square[3][2], const float drop2[8])
{
    float left[BVXI_NEAR_WIDTH];
    uint32_t mask = 0;

    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) left[k] = -1.0f;
    for (int c = 0; c < 8; c++) { /* a loop that becomes vectors */
        const float *const x = square[0][c & 1];
        const float *const y = square[1][c >> 1 & 1];
        const float *const z = square[2][c >> 2];
        float const most = drop2[c];
        for (int k = 0; k < BVXI_NEAR_WIDTH; k++) {
            float const rest = most - (x[k] + y[k] + z[k]);
            left[k] = rest > left[k] ? rest : left[k];
        }
    }
    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) mask |= (uint32_t)(left[k] >= 0.0f) << k;
    return mask;
}

static void take_near_list(const bvxi_near_list *list, const bvxi_near_sieve *sieve, bvxi_near_eight *e)
{
    for (int32_t i = 0; i < list->count; i++)
        for (uint32_t leaves = sieve->reach[i][e->group]; leaves != 0; leaves &= leaves - 1)
            bound_near_eight(&list->block[i], bvxi_lowest(leaves), e);
    slacken_near_eight(e);
    for (int32_t i = 0; i < list->count; i++) {
        const float *square[3][2];
        uint32_t leaves = sieve->reach[i][e->group];
        if (leaves == 0) continue;
        for (int a = 0; a < 3; a++)
            for (int j = 0; j < 2; j++) square[a][j] = sieve->square[i][a][(e->group >> a & 1) * 2 + j];
        for (leaves &= near_boxes((const float *const(*)[2])square, e->drop2); leaves != 0;
             leaves &= leaves - 1)
            e->leaf[e->leaves++] = (uint16_t)(bvxi_lowest(leaves) + BVXI_NEAR_WIDTH * i);
    }
}

/* ---- Triangles ---- */

static uint32_t near_triangles(const bvxi_near_leaf *leaf, const bvxi_near_block *b, uint32_t slot,
                               const bvxi_near_eight *e)
{
    float s[3][2][BVXI_NEAR_WIDTH];
    const float *square[3][2];

    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 2; i++) {
            float const x = e->ends[a][i] - b->low[a][slot];
            for (int k = 0; k < BVXI_NEAR_WIDTH; k++) {
                float const out = near_most(near_most(leaf->low[a][k] - x, x - leaf->high[a][k]), 0.0f);
                s[a][i][k] = out * out;
            }
            square[a][i] = s[a][i];
        }
    return near_boxes((const float *const(*)[2])square, e->drop2);
}

/* Choose triangles, as many as there is room for. Returns the new count. */
static int32_t choose_near_triangles(const bvxi_nearest *n, const bvxi_near_list *list, bvxi_near_eight *e)
{
    int32_t count = e->count;

    for (; e->next < e->leaves && count <= BVXI_NEAR_MEASURED - BVXI_NEAR_WIDTH; e->next++) {
        const bvxi_near_block *const b = &list->block[e->leaf[e->next] / BVXI_NEAR_WIDTH];
        uint32_t const slot = e->leaf[e->next] % BVXI_NEAR_WIDTH, number = b->first + slot;
        for (uint32_t mask = near_triangles(&n->leaves[number], b, slot, e); mask != 0; mask &= mask - 1)
            e->place[count++] = number * BVXI_NEAR_WIDTH + (uint32_t)bvxi_lowest(mask);
    }
    return count;
}

/* A loop that becomes vectors. */
static void near_distances(const bvxi_near_frame *frame, const float origin[3], const float at[3][8],
                           float *BVXI_RESTRICT distance2)
{
    float f[BVXI_NEAR_NUMBERS];
    memcpy(f, frame->f, sizeof f);
    for (int a = 0; a < 3; a++) f[a] = origin[a] - f[a];
    for (int c = 0; c < 8; c++)
        distance2[c] = bvxi_near_distance2(f, at[0][c] + f[0], at[1][c] + f[1], at[2][c] + f[2]);
}

static void look_near(const bvxi_nearest *n, const bvxi_near_list *list, const float origin[3],
                      bvxi_near_eight *e)
{
    int32_t const count = choose_near_triangles(n, list, e);
    for (; e->count < count; e->count++) {
        float *const d = e->distance2[e->count];
        near_distances(near_frame(n->leaves, e->place[e->count]), origin, (const float(*)[8])e->at, d);
        for (int c = 0; c < 8; c++) e->least2[c] = d[c] < e->least2[c] ? d[c] : e->least2[c];
    }
}

/* ---- The end ---- */

static int32_t find_near_winners(const bvxi_near_leaf *leaves, const float most2[8], const bvxi_near_eight *e,
                                 bvxi_near_winner *winners)
{
    int32_t count = 0;

    for (int32_t i = 0; i < e->count; i++)
        for (int32_t c = 0; c < 8; c++)
            if (e->distance2[i][c] <= most2[c]) {
                winners[count].triangle = near_frame(leaves, e->place[i])->triangle;
                winners[count++].centre = c;
            }
    return count;
}

/* ---- The same in vectors ---- */

#if BVXI_HAVE_AVX2
/* Append the set bits of a byte, eight numbers at a time whether there are so many or not. */
BVXI_AVX2 static inline uint32_t near_append(uint32_t mask, uint32_t base, uint16_t *to)
{
    uint64_t const packed = _pext_u64(UINT64_C(0x0706050403020100),
                                      _pdep_u64(mask, UINT64_C(0x0101010101010101)) * 255);
    __m128i const numbers = _mm_cvtepu8_epi16(_mm_cvtsi64_si128((long long)packed));
    _mm_storeu_si128((__m128i *)(void *)to, _mm_add_epi16(numbers, _mm_set1_epi16((short)base)));
    return (uint32_t)_mm_popcnt_u32(mask);
}

/* Bits of eight boxes that lie within drop2 of some centre, from the
 * squares of their distances along the axes. */
BVXI_AVX2 static inline uint32_t near_boxes_avx2(__m256 x0, __m256 x1, __m256 y0, __m256 y1, __m256 z0,
                                                 __m256 z1, const float drop2[8])
{
    __m256 const a = x0 + y0, b = x1 + y0, c = x0 + y1, d = x1 + y1;
    __m256 const p = _mm256_or_ps(_mm256_cmp_ps(a + z0, NEAR_ONE(drop2[0]), _CMP_LE_OQ),
                                  _mm256_cmp_ps(b + z0, NEAR_ONE(drop2[1]), _CMP_LE_OQ));
    __m256 const q = _mm256_or_ps(_mm256_cmp_ps(c + z0, NEAR_ONE(drop2[2]), _CMP_LE_OQ),
                                  _mm256_cmp_ps(d + z0, NEAR_ONE(drop2[3]), _CMP_LE_OQ));
    __m256 const r = _mm256_or_ps(_mm256_cmp_ps(a + z1, NEAR_ONE(drop2[4]), _CMP_LE_OQ),
                                  _mm256_cmp_ps(b + z1, NEAR_ONE(drop2[5]), _CMP_LE_OQ));
    __m256 const s = _mm256_or_ps(_mm256_cmp_ps(c + z1, NEAR_ONE(drop2[6]), _CMP_LE_OQ),
                                  _mm256_cmp_ps(d + z1, NEAR_ONE(drop2[7]), _CMP_LE_OQ));
    return (uint32_t)_mm256_movemask_ps(_mm256_or_ps(_mm256_or_ps(p, q), _mm256_or_ps(r, s)));
}

BVXI_AVX2 static inline uint32_t near_leaves_avx2(const float square[3][BVXI_NEAR_SIDE][BVXI_NEAR_WIDTH],
                                                  const bvxi_near_eight *e)
{
    const float(*const x)[BVXI_NEAR_WIDTH] = square[0] + (e->group & 1) * 2,
                       (*const y)[BVXI_NEAR_WIDTH] = square[1] + (e->group & 2);
    const float(*const z)[BVXI_NEAR_WIDTH] = square[2] + (e->group >> 2) * 2;
    return near_boxes_avx2(_mm256_loadu_ps(x[0]), _mm256_loadu_ps(x[1]), _mm256_loadu_ps(y[0]),
                           _mm256_loadu_ps(y[1]), _mm256_loadu_ps(z[0]), _mm256_loadu_ps(z[1]), e->drop2);
}

BVXI_AVX2 static void take_near_list_avx2(const bvxi_near_list *list, const bvxi_near_sieve *sieve,
                                          bvxi_near_eight *e)
{
    __m256 const ax = _mm256_loadu_ps(e->at[0]);
    __m256 const ay = _mm256_loadu_ps(e->at[1]);
    __m256 const az = _mm256_loadu_ps(e->at[2]);
    __m256 least2 = _mm256_loadu_ps(e->least2);
    uint32_t count = 0;

    for (int32_t i = 0; i < list->count; i++)
        count += near_append(sieve->reach[i][e->group], (uint32_t)(i * BVXI_NEAR_WIDTH), e->leaf + count);
    for (uint32_t i = 0; i < count; i++) {
        const bvxi_near_block *const b = &list->block[e->leaf[i] / BVXI_NEAR_WIDTH];
        int const k = e->leaf[i] % BVXI_NEAR_WIDTH;
        __m256 const x = ax - NEAR_ONE(b->point[0][k]);
        __m256 const y = ay - NEAR_ONE(b->point[1][k]);
        __m256 const z = az - NEAR_ONE(b->point[2][k]);
        least2 = _mm256_min_ps(least2, x * x + y * y + z * z);
    }
    _mm256_storeu_ps(e->least2, least2);
    slacken_near_eight(e);
    count = 0;
    for (int32_t i = 0; i < list->count; i++)
        count += near_append(sieve->reach[i][e->group] & near_leaves_avx2(sieve->square[i], e),
                             (uint32_t)(i * BVXI_NEAR_WIDTH), e->leaf + count);
    e->leaves = (int32_t)count;
}

BVXI_AVX2 static inline __m256 near_outside(__m256 low, __m256 high, float end)
{
    __m256 const x = _mm256_set1_ps(end);
    __m256 const out = _mm256_max_ps(_mm256_max_ps(low - x, x - high), _mm256_setzero_ps());
    return out * out;
}

BVXI_AVX2 static inline uint32_t near_triangles_avx2(const bvxi_near_leaf *leaf, const bvxi_near_block *b,
                                                     uint32_t slot, const bvxi_near_eight *e)
{
    __m256 s[3][2];
    for (int a = 0; a < 3; a++) {
        __m256 const least = _mm256_loadu_ps(leaf->low[a]), most = _mm256_loadu_ps(leaf->high[a]);
        s[a][0] = near_outside(least, most, e->ends[a][0] - b->low[a][slot]);
        s[a][1] = near_outside(least, most, e->ends[a][1] - b->low[a][slot]);
    }
    return near_boxes_avx2(s[0][0], s[0][1], s[1][0], s[1][1], s[2][0], s[2][1], e->drop2);
}

BVXI_AVX2 static inline int32_t choose_near_triangles_avx2(const bvxi_nearest *n, const bvxi_near_list *list,
                                                           bvxi_near_eight *e)
{
    int32_t count = e->count, next = e->next;

    for (; next < e->leaves && count <= BVXI_NEAR_MEASURED - BVXI_NEAR_WIDTH; next++) {
        const bvxi_near_block *const b = &list->block[e->leaf[next] / BVXI_NEAR_WIDTH];
        uint32_t const slot = e->leaf[next] % BVXI_NEAR_WIDTH, number = b->first + slot;
        uint32_t const later =
            e->leaf[next + NEAR_AHEAD_LEAVES < e->leaves ? next + NEAR_AHEAD_LEAVES : next];
        const char *const soon =
            (const char *)&n->leaves[list->block[later / BVXI_NEAR_WIDTH].first + later % BVXI_NEAR_WIDTH];
        for (int i = 0; i < 3; i++) _mm_prefetch(soon + 64 * i, _MM_HINT_T0);
        uint32_t const mask = near_triangles_avx2(&n->leaves[number], b, slot, e);
        uint64_t const packed = _pext_u64(UINT64_C(0x0706050403020100),
                                          _pdep_u64(mask, UINT64_C(0x0101010101010101)) * 255);
        __m256i const k = _mm256_cvtepu8_epi32(_mm_cvtsi64_si128((long long)packed));
        _mm256_storeu_si256((__m256i *)(void *)(e->place + count),
                            _mm256_add_epi32(k, _mm256_set1_epi32((int)(number * BVXI_NEAR_WIDTH))));
        count += (int32_t)_mm_popcnt_u32(mask);
    }
    e->next = next;
    return count;
}

/* bvxi_near_distance2 of eight places to one triangle. */
BVXI_AVX2 static inline __m256 near_distances_avx2(const float f[BVXI_NEAR_NUMBERS], const float origin[3],
                                                   __m256 ax, __m256 ay, __m256 az)
{
    __m256 const zero = _mm256_setzero_ps(), sign = _mm256_set1_ps(-0.0f);
    __m256 const x = ax + _mm256_set1_ps(origin[0] - f[0]);
    __m256 const y = ay + _mm256_set1_ps(origin[1] - f[1]);
    __m256 const z = az + _mm256_set1_ps(origin[2] - f[2]);
    __m256 const u = x * NEAR_ONE(f[3]) + y * NEAR_ONE(f[4]) + z * NEAR_ONE(f[5]);
    __m256 const v = x * NEAR_ONE(f[6]) + y * NEAR_ONE(f[7]) + z * NEAR_ONE(f[8]);
    __m256 const w = x * NEAR_ONE(f[9]) + y * NEAR_ONE(f[10]) + z * NEAR_ONE(f[11]);
    __m256 const h = NEAR_ONE(f[BVXI_NEAR_H]);
    __m256 const r = _mm256_blendv_ps(NEAR_ONE(f[BVXI_NEAR_Q]), NEAR_ONE(f[BVXI_NEAR_P]), u);
    __m256 const before = r - _mm256_andnot_ps(sign, u);
    __m256 const beyond = _mm256_min_ps(before, zero), base2 = beyond * beyond + v * v;
    /* max gives its second operand for no number */
    __m256 const t = _mm256_div_ps(before * r + v * h, r * r + h * h);
    __m256 const s = _mm256_min_ps(_mm256_max_ps(t, zero), _mm256_set1_ps(1.0f));
    __m256 const dx = before - s * r, dy = v - s * h, edge2 = dx * dx + dy * dy;
    __m256 const side = before * h - v * r, least = _mm256_min_ps(base2, edge2);
    return _mm256_andnot_ps(_mm256_cmp_ps(_mm256_min_ps(v, side), zero, _CMP_GT_OQ), least) + w * w;
}

BVXI_AVX2 static void look_near_avx2(const bvxi_nearest *n, const bvxi_near_list *list, const float origin[3],
                                     bvxi_near_eight *e)
{
    __m256 const ax = _mm256_loadu_ps(e->at[0]);
    __m256 const ay = _mm256_loadu_ps(e->at[1]);
    __m256 const az = _mm256_loadu_ps(e->at[2]);
    __m256 least2 = _mm256_loadu_ps(e->least2);
    int32_t const count = choose_near_triangles_avx2(n, list, e);
    const bvxi_near_leaf *const leaves = n->leaves;

    for (int32_t i = e->count; i < count; i++) {
        uint32_t const later = e->place[i + NEAR_AHEAD_OF < count ? i + NEAR_AHEAD_OF : i];
        _mm_prefetch((const char *)near_frame(leaves, later), _MM_HINT_T0);
        __m256 const d = near_distances_avx2(near_frame(leaves, e->place[i])->f, origin, ax, ay, az);
        _mm256_storeu_ps(e->distance2[i], d);
        least2 = _mm256_min_ps(d, least2);
    }
    e->count = count;
    _mm256_storeu_ps(e->least2, least2);
}

BVXI_AVX2 static int32_t find_near_winners_avx2(const bvxi_near_leaf *leaves, const float most2[8],
                                                const bvxi_near_eight *e, bvxi_near_winner *winners)
{
    __m256 const most = _mm256_loadu_ps(most2);
    int32_t count = 0;

    for (int32_t i = 0; i < e->count; i++) {
        uint32_t mask = (uint32_t)_mm256_movemask_ps(
            _mm256_cmp_ps(_mm256_loadu_ps(e->distance2[i]), most, _CMP_LE_OQ));
        for (; mask != 0; mask &= mask - 1) {
            winners[count].triangle = near_frame(leaves, e->place[i])->triangle;
            winners[count++].centre = bvxi_lowest(mask);
        }
    }
    return count;
}
#define NEAR_PATH(fast, plain, vectors) ((fast) ? vectors : plain)
#else
#define NEAR_PATH(fast, plain, vectors) ((void)(fast), plain)
#endif

/* ---- Which path ---- */

void bvxi_near_eight_take(const bvxi_near_list *list, const bvxi_near_sieve *sieve, int32_t fast,
                          bvxi_near_eight *e)
{
    e->error = list->error > e->error ? list->error : e->error;
    e->leaves = e->next = 0;
    NEAR_PATH(fast, take_near_list(list, sieve, e), take_near_list_avx2(list, sieve, e));
}

int32_t bvxi_near_eight_look(const bvxi_nearest *n, const bvxi_near_list *list, const float origin[3],
                             int32_t fast, bvxi_near_eight *e)
{
    NEAR_PATH(fast, look_near(n, list, origin, e), look_near_avx2(n, list, origin, e));
    return e->next == e->leaves;
}

int32_t bvxi_near_eight_winners(const bvxi_nearest *n, int32_t fast, bvxi_near_eight *e, float most2[8],
                                bvxi_near_winner *winners)
{
    int32_t count;

    for (int c = 0; c < 8; c++) {
        float const d = (float)sqrt((double)(e->least2[c] > 0.0f ? e->least2[c] : 0.0f)) + 2.0f * e->error;
        most2[c] = e->least2[c] < 0.0f ? -1.0f : d * d * (1.0f + 0x1p-20f);
    }
    count = NEAR_PATH(fast, find_near_winners(n->leaves, most2, e, winners),
                      find_near_winners_avx2(n->leaves, most2, e, winners));
    e->count = 0;
    return count;
}
