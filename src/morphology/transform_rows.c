/* transform_rows.c - distances along a row of bits to the nearest target, 16 voxels at a time.
 *
 * A table says for each byte how far its bits are from its own set bits; what lies beyond the byte comes in
 * through the nearest target on either side. These are carried from 16 columns to the next, so that each word
 * of a row is looked at a few times, however far targets lie apart. Exact. */
#include "morphology/transform.h"

enum { ROW_NONE = 1 << 28 /* further than any target */, BYTE_NONE = 127 };

void bvxi_row_distances_start(bvxi_row_distances *table)
{
    for (int32_t b = 0; b < 256; b++)
        for (int32_t i = 0; i < 8; i++) {
            /* The farthest first, so that the nearest stays. */
            table->near[b][i] = BYTE_NONE;
            for (int32_t d = 7; d >= 0; d--)
                if ((i >= d && (b >> (i - d) & 1)) || (i + d < 8 && (b >> (i + d) & 1)))
                    table->near[b][i] = (uint8_t)d;
        }
}

static inline uint64_t target_word(const bvxi_target_row *row, int32_t k)
{
    uint64_t const w = row->words[k] ^ row->flip;
    return k + 1 == bvxi_row_words(row->size) ? w & bvxi_tail_mask(row->size) : w;
}

/* The first target at x or behind it, x a multiple of 16; -1: none. */
static int32_t first_target(const bvxi_target_row *row, int32_t x)
{
    int32_t const words = bvxi_row_words(row->size);
    int32_t k = x >> 6;

    if (k >= words) return -1;
    /* Targets before x are not looked at. */
    uint64_t w = target_word(row, k) & ~UINT64_C(0) << (x & 63);
    while (w == 0) {
        if (++k == words) return -1;
        w = target_word(row, k);
    }
    return k * BVXI_WORD_BITS + bvxi_lowest(w);
}

static inline uint32_t sixteen_targets(const bvxi_target_row *row, int32_t x)
{
    return (uint32_t)(target_word(row, x >> 6) >> (x & 63)) & 0xffffu;
}

void bvxi_row_carry_start(bvxi_row_carry *carry, const bvxi_target_row *row)
{
    carry->left = -1;
    carry->right = first_target(row, BVXI_LANES);
}

void bvxi_row_carry_next(bvxi_row_carry *carry, const bvxi_target_row *row, int32_t x)
{
    /* What was under the lanes before is on the left now. */
    uint32_t const before = sixteen_targets(row, x - BVXI_LANES);
    if (before != 0) carry->left = x - BVXI_LANES + bvxi_highest(before);
    if (carry->right >= 0 && carry->right < x + BVXI_LANES) carry->right = first_target(row, x + BVXI_LANES);
}

/* Eight voxels from x on: left and right are the nearest targets beyond them. */
BVXI_VECTOR_INLINE void byte_steps(const uint8_t *BVXI_RESTRICT near, int32_t left, int32_t right,
                                   int32_t *BVXI_RESTRICT steps)
{
    for (int32_t i = 0; i < 8; i++) {
        /* No target in the byte: farther than all. */
        int32_t const a = left + i, b = right - i, c = near[i] == BYTE_NONE ? ROW_NONE : near[i];
        int32_t const d = a < b ? a : b;
        steps[i] = c < d ? c : d;
    }
}

/* The nearest target of each voxel by its place, the left one of two. */
static void find_target_places(uint32_t bits, const bvxi_row_carry *carry, int32_t x, int32_t *places)
{
    int32_t last = carry->left, next = carry->right;

    /* From the left, then from the right; the left one stays where both are as far. */
    for (int32_t i = 0; i < BVXI_LANES; i++) {
        if (bits >> i & 1) last = x + i;
        places[i] = last;
    }
    for (int32_t i = BVXI_LANES - 1; i >= 0; i--) {
        if (bits >> i & 1) next = x + i;
        if (places[i] < 0 || (next >= 0 && next - (x + i) < x + i - places[i])) places[i] = next;
    }
}

int bvxi_row_steps(const bvxi_row_distances *table, const bvxi_row_carry *carry, const bvxi_target_row *row,
                   int32_t x, int32_t reach, int32_t steps[BVXI_LANES], int32_t *places)
{
    uint32_t const bits = sixteen_targets(row, x);
    uint32_t const low = bits & 255u, high = bits >> 8;
    int32_t const left = carry->left < 0 ? ROW_NONE : x - carry->left;
    int32_t const right = carry->right < 0 ? ROW_NONE : carry->right - x;

    /* Too far for all 16: the row is left out. */
    if (bits == 0 && left > reach && right - (BVXI_LANES - 1) > reach) return 0;
    /* Each byte sees the other one's nearest target, or the one beyond it. */
    byte_steps(table->near[low], left, high != 0 ? 8 + bvxi_lowest(high) : right, steps);
    byte_steps(table->near[high], low != 0 ? 8 - bvxi_highest(low) : left + 8, right - 8, steps + 8);
    if (places != NULL) find_target_places(bits, carry, x, places);
    return 1;
}
