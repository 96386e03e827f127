/* block_rows.c - a row of blocks counted as bit planes.
 *
 * Source: Harley, Seal, in Warren. Hacker's Delight, 5-1 (rows are added three by three); 7-4 (compress).
 *
 * First the voxels above each other: rows come one by one into a binary counter whose digits are words, a
 * pending word and a sum word each, so a row costs one full adder on average. Then neighbours along x: counts
 * of m columns become those of 2 m and 2 m + 1 by adding a row to itself shifted. Then the bits at which
 * blocks begin are brought together. No voxel is looked at only. */
#include "grid/blocks.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

enum { BLOCK_LANES = 4 /* words of a row that are counted together */ };

typedef struct block_counter {
    uint64_t sum[BVXI_BLOCK_PLANES][BLOCK_LANES], pending[BVXI_BLOCK_PLANES][BLOCK_LANES];
} block_counter;

/* ---- Above each other ---- */

/* Row number n, from 0, into the counter: after it word p counts where bit p of n + 1 is 1. */
BVXI_VECTOR_INLINE void count_row(block_counter *c, uint32_t n, const uint64_t word[BLOCK_LANES])
{
    uint64_t x[BLOCK_LANES];
    uint32_t p = 0;
    for (uint32_t l = 0; l < BLOCK_LANES; l++) x[l] = word[l];
    /* As in adding one to a binary number: a digit that had something pending is added up and carries on. */
    for (; (n >> p & 1) != 0; p++)
        for (uint32_t l = 0; l < BLOCK_LANES; l++) {
            uint64_t const s = c->sum[p][l], w = c->pending[p][l], either = s ^ w;
            c->sum[p][l] = either ^ x[l];
            x[l] = (s & w) | (either & x[l]);
        }
    for (uint32_t l = 0; l < BLOCK_LANES; l++) c->pending[p][l] = x[l];
}

BVXI_VECTOR_INLINE void end_count(block_counter *c, uint32_t n, int32_t planes)
{
    uint64_t carry[BLOCK_LANES] = {0};
    for (int32_t p = 0; p < planes; p++)
        for (uint32_t l = 0; l < BLOCK_LANES; l++) {
            /* A full adder for each digit: the sum, what is pending, and the carry of the digit below. */
            uint64_t const s = c->sum[p][l], w = (n >> p & 1) != 0 ? c->pending[p][l] : 0, either = s ^ w;
            c->sum[p][l] = either ^ carry[l];
            carry[l] = (s & w) | (either & carry[l]);
        }
}

BVXI_VECTOR_INLINE void load_lanes(const uint64_t *row, int32_t n, uint64_t word[BLOCK_LANES])
{
    if (n >= BLOCK_LANES) {
        for (uint32_t l = 0; l < BLOCK_LANES; l++) word[l] = row[l];
        return;
    }
    for (int32_t l = 0; l < BLOCK_LANES; l++) word[l] = l < n ? row[l] : 0;
}

typedef struct block_box {
    int32_t y[2], z[2]; /* voxels of the window */
} block_box;

static int32_t block_digits(uint64_t most)
{
    int32_t n = 0;
    for (; most != 0; most >>= 1) n++;
    return n;
}

/* Columns of words k .. k + 3: digits of how many of the box's rows have
 * each bit. Returns the OR of them all. */
BVXI_VECTOR_INLINE uint64_t count_columns(const bvxi_blocks *b, const block_box *box, int32_t k,
                                          int32_t planes, uint64_t *to)
{
    const bvx_grid *const g = b->grid;
    size_t const row = (size_t)g->words_per_row;
    int32_t const left = g->words_per_row - k;
    uint64_t seen = 0;
    uint32_t n = 0;
    block_counter c;

    memset(c.sum, 0, (size_t)planes * sizeof c.sum[0]);
    for (int32_t z = box->z[0]; z < box->z[1]; z++) {
        const uint64_t *from = g->words + ((size_t)z * (size_t)g->size[1] + (size_t)box->y[0]) * row +
                               (size_t)k;
        for (int32_t y = box->y[0]; y < box->y[1]; y++, from += row) {
            uint64_t word[BLOCK_LANES];
            load_lanes(from, left, word);
            count_row(&c, n++, word);
        }
    }

    end_count(&c, n, planes);
    for (int32_t p = 0; p < planes; p++)
        for (int32_t l = 0; l < BLOCK_LANES && l < left; l++) {
            to[(size_t)p * (size_t)b->words + (size_t)(k + l)] = c.sum[p][l];
            seen |= c.sum[p][l];
        }
    return seen;
}

BVXI_VECTOR_INLINE uint64_t join_columns(const bvxi_blocks *b, const block_box *box, uint64_t *to)
{
    const bvx_grid *const g = b->grid;
    int32_t const row = g->words_per_row;
    uint64_t const flip = b->what == BVXI_BLOCKS_NONE ? ~UINT64_C(0) : 0;
    uint64_t seen = 0;

    /* For empty voxels the rows are inverted first, so that the OR finds one that is missing. */
    for (int32_t k = 0; k < row; k++) to[k] = 0;
    for (int32_t z = box->z[0]; z < box->z[1]; z++) {
        const uint64_t *from = g->words + ((size_t)z * (size_t)g->size[1] + (size_t)box->y[0]) * (size_t)row;
        for (int32_t y = box->y[0]; y < box->y[1]; y++, from += row)
            for (int32_t k = 0; k < row; k++) to[k] |= from[k] ^ flip;
    }

    to[row - 1] &= bvxi_tail_mask(g->size[0]);
    for (int32_t k = 0; k < row; k++) seen |= to[k];
    return seen;
}

/* ---- Neighbours along x ---- */

BVXI_VECTOR_INLINE uint64_t bits_behind(const uint64_t *row, int32_t words, int32_t k, int32_t first,
                                        uint32_t shift)
{
    /* The word after the last is empty, so blocks may reach beyond the row. */
    uint64_t const low = k + first < words ? row[k + first] : 0;
    uint64_t const high = k + first + 1 < words ? row[k + first + 1] : 0;
    return shift == 0 ? low : low >> shift | high << (64 - shift);
}

/* sum[i] += other[i + m]; the sum then has `digits`. other may be sum: front words are done first. */
BVXI_VECTOR_INLINE void add_shifted(uint64_t *sum, int32_t sum_digits, const uint64_t *other,
                                    int32_t other_digits, int32_t words, int32_t m, int32_t digits)
{
    int32_t const first = m / 64;
    uint32_t const shift = (uint32_t)m % 64;

    /* From the front: a word's sum needs words after it only, which still hold their old digits. */
    for (int32_t k = 0; k < words; k++) {
        uint64_t carry = 0;
        for (int32_t p = 0; p < digits; p++) {
            uint64_t const a = p < sum_digits ? sum[(size_t)p * (size_t)words + (size_t)k] : 0;
            uint64_t const c = p < other_digits
                                   ? bits_behind(other + (size_t)p * (size_t)words, words, k, first, shift)
                                   : 0;
            sum[(size_t)p * (size_t)words + (size_t)k] = a ^ c ^ carry;
            carry = (a & c) | ((a ^ c) & carry);
        }
    }
}

BVXI_VECTOR_INLINE void join_shifted(uint64_t *sum, const uint64_t *other, int32_t words, int32_t m)
{
    for (int32_t k = 0; k < words; k++) sum[k] |= bits_behind(other, words, k, m / 64, (uint32_t)m % 64);
}

/* Bit i becomes that of the factor's columns from i on: binary digits of the factor, highest first. */
BVXI_VECTOR_INLINE int32_t join_neighbours(const bvxi_blocks *b, uint64_t *sum, uint64_t *single,
                                           int32_t single_digits, uint64_t most)
{
    int32_t const words = b->words, f = b->factor[0];
    int32_t length = 1, digits = single_digits, top = 0;

    /* Doubling for each binary digit of the factor, and one column more where it is 1. */
    while (f >> top > 1) top++;
    memcpy(single, sum, (size_t)single_digits * (size_t)words * 8);
    for (int32_t bit = top - 1; bit >= 0; bit--) {
        int const odd = (f >> bit & 1) != 0;
        /* Digits follow the largest count that there can be, so no carry is lost and none is kept in vain. */
        int32_t const doubled = b->what == BVXI_BLOCKS_COUNT ? block_digits((uint64_t)length * 2 * most) : 1;
        int32_t const more = b->what == BVXI_BLOCKS_COUNT ? block_digits(((uint64_t)length * 2 + 1) * most)
                                                          : 1;
        if (b->what != BVXI_BLOCKS_COUNT) {
            join_shifted(sum, sum, words, length);
            if (odd) join_shifted(sum, single, words, 2 * length);
        } else {
            add_shifted(sum, digits, sum, digits, words, length, doubled);
            if (odd) add_shifted(sum, doubled, single, single_digits, words, 2 * length, more);
        }
        digits = odd ? more : doubled;
        length = 2 * length + odd;
    }
    return digits;
}

/* ---- Where blocks begin ---- */

typedef struct gathered_bits {
    uint64_t *to, held;
    int32_t have;
} gathered_bits;

BVXI_VECTOR_INLINE void append_bits(gathered_bits *g, uint64_t bits, int32_t count)
{
    g->held |= bits << g->have;
    g->have += count;
    if (g->have < BVXI_WORD_BITS) return;
    *g->to++ = g->held;
    g->have -= BVXI_WORD_BITS;
    /* A shift by the whole word would be undefined: then nothing is held over. */
    g->held = g->have != 0 ? bits >> (count - g->have) : 0;
}

static void gather_row(const bvxi_blocks *b, const uint64_t *row, uint64_t *to)
{
    gathered_bits g = {to, 0, 0};
    for (int32_t k = 0; k < b->words; k++) {
        const bvxi_block_starts *const s = &b->starts[k];
        uint64_t w = row[k] & s->mask;

        if (s->count == 0) continue;
        /* Warren's compress: each step moves the bits whose distance has that power of two. */
        for (int32_t i = 0; i < 6; i++) {
            uint64_t const m = w & s->move[i];
            w = (w ^ m) | m >> (1 << i);
        }
        append_bits(&g, w, s->count);
    }
    if (g.have != 0) *g.to = g.held;
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static void gather_row_bmi2(const bvxi_blocks *b, const uint64_t *row, uint64_t *to)
{
    gathered_bits g = {to, 0, 0};
    for (int32_t k = 0; k < b->words; k++)
        if (b->starts[k].count != 0)
            append_bits(&g, (uint64_t)_pext_u64(row[k], b->starts[k].mask), b->starts[k].count);
    if (g.have != 0) *g.to = g.held;
}
#endif

BVXI_VECTOR_INLINE const uint64_t *make_block_row(const bvxi_blocks *b, int32_t worker, int32_t j, int32_t k,
                                                  int32_t *digits)
{
    size_t const words = (size_t)b->words, set = words * (size_t)b->plane_count;
    uint64_t *const sum = b->planes + (size_t)worker * (size_t)b->worker_words;
    uint64_t *const single = sum + set;
    uint64_t *const to = single + set;
    uint64_t seen = 0, most = 1;
    int32_t n = 1;
    block_box box;

    /* The box of rows that the blocks of this row cover, cut by the window. */
    bvxi_block_range(b, 1, j, &box.y[0], &box.y[1]);
    bvxi_block_range(b, 2, k, &box.z[0], &box.z[1]);
    if (b->what == BVXI_BLOCKS_COUNT) {
        most = (uint64_t)(box.y[1] - box.y[0]) * (uint64_t)(box.z[1] - box.z[0]);
        n = block_digits(most);
        for (int32_t w = 0; w < b->grid->words_per_row; w += BLOCK_LANES)
            seen |= count_columns(b, &box, w, n, sum);
    } else {
        seen = join_columns(b, &box, sum);
    }
    *digits = 0;
    if (seen == 0) return to;
    /* the row with the first block's missing voxels in front */
    for (int32_t p = 0; b->phase != 0 && p < n; p++) {
        uint64_t *const plane = sum + (size_t)p * words;
        bvxi_shift_row(plane, b->grid->words_per_row, -(int64_t)b->phase, single, b->words);
        memcpy(plane, single, words * 8);
    }
    *digits = join_neighbours(b, sum, single, n, most);
    for (int32_t p = 0; p < *digits; p++) {
#if BVXI_HAVE_AVX2
        if (b->cpu == BVX_CPU_AVX2) {
            gather_row_bmi2(b, sum + (size_t)p * words, to + (size_t)p * (size_t)b->count_words);
            continue;
        }
#endif
        gather_row(b, sum + (size_t)p * words, to + (size_t)p * (size_t)b->count_words);
    }
    return to;
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static const uint64_t *make_block_row_avx2(const bvxi_blocks *b, int32_t worker, int32_t j,
                                                     int32_t k, int32_t *digits)
{
    return make_block_row(b, worker, j, k, digits);
}
#endif

const uint64_t *bvxi_blocks_row(const bvxi_blocks *blocks, int32_t worker, int32_t j, int32_t k,
                                int32_t *digits)
{
#if BVXI_HAVE_AVX2
    if (blocks->cpu == BVX_CPU_AVX2) return make_block_row_avx2(blocks, worker, j, k, digits);
#endif
    return make_block_row(blocks, worker, j, k, digits);
}
