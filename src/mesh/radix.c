/* radix.c - least significant digit first, eight bits a digit.
 *
 * Digits begin at a bit that differs between keys, so that none is the same everywhere. Each pass counts one and
 * moves elements between two pairs of arrays without changing the order of equal digits. Many elements are
 * moved by several threads: pieces of them, whose elements of one digit go side by side, in the order of the
 * pieces.
 * Cost: O(count) for each digit.
 * Guarantee: the order is that of one thread. */
#include "bits/bits.h"
#include "mesh/mesh.h"

enum { RADIX_VALUES = 256, RADIX_GRAIN = 1 << 16, RADIX_PIECES = 16 };

/* Both pairs of arrays; elements lie in from. */
typedef struct radix_arrays {
    uint64_t *key_from, *key_to;
    uint32_t *number_from, *number_to;
    uint64_t count;
} radix_arrays;

typedef struct radix_pass {
    radix_arrays all;
    int32_t pieces, shift; /* of the digit in a key */
    uint32_t place[RADIX_PIECES][RADIX_VALUES];
} radix_pass;

static void count_radix_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    radix_pass *const p = user;
    const uint64_t *const keys = p->all.key_from;
    uint32_t *BVXI_RESTRICT const count = p->place[index];
    int32_t const shift = p->shift;
    memset(count, 0, sizeof p->place[index]);
    for (uint64_t i = begin; i < end; i++) count[keys[i] >> shift & 255]++;
}

static void move_radix_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    radix_pass *const p = user;

    /* Elements from begin to end, each to the next place of its digit. */
    const radix_arrays *const a = &p->all;
    const uint64_t *const key_from = a->key_from;
    const uint32_t *const number_from = a->number_from;
    uint64_t *const key_to = a->key_to;
    uint32_t *const number_to = a->number_to;
    for (uint64_t i = begin; i < end; i++) {
        uint64_t const key = key_from[i];
        uint32_t const to = p->place[index][key >> p->shift & 255]++;
        key_to[to] = key;
        number_to[to] = number_from[i];
    }
}

static void sort_radix(bvx_context *ctx, radix_arrays *a)
{
    int32_t const pieces = bvxi_piece_count(a->count, RADIX_GRAIN);
    uint64_t bits = 0; /* that are not the same in all keys */
    radix_pass p;

    for (uint64_t i = 1; i < a->count; i++) bits |= a->key_from[i] ^ a->key_from[0];
    p.all = *a;
    p.pieces = pieces < RADIX_PIECES ? pieces : RADIX_PIECES;
    for (; bits != 0; bits &= ~(UINT64_C(255) << p.shift)) {
        p.shift = bvxi_lowest(bits);
        /* Counted anew for each digit: what a piece holds changes from pass to pass. */
        bvxi_ranges(ctx, p.pieces, a->count, count_radix_piece, &p);

        /* Counts of each piece become places: values one after the other, in each the pieces in order. */
        uint32_t sum = 0;
        for (int v = 0; v < RADIX_VALUES; v++)
            for (int32_t i = 0; i < p.pieces; i++) {
                uint32_t const n = p.place[i][v];
                p.place[i][v] = sum;
                sum += n;
            }

        bvxi_ranges(ctx, p.pieces, a->count, move_radix_piece, &p);

        uint64_t *const keys = p.all.key_from;
        uint32_t *const numbers = p.all.number_from;
        p.all.key_from = p.all.key_to;
        p.all.key_to = keys;
        p.all.number_from = p.all.number_to;
        p.all.number_to = numbers;
    }
    *a = p.all;
}

bvx_status bvxi_radix_sort(bvx_context *ctx, uint64_t *keys, uint32_t *numbers, uint64_t count)
{
    radix_arrays a = {.key_from = keys, .number_from = numbers, .count = count};
    void *spare;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 12, "the sort's keys and numbers", &spare));
    a.key_to = spare;
    a.number_to = (uint32_t *)(void *)(a.key_to + count);
    sort_radix(ctx, &a);

    /* After an odd number of passes the result lies in the spare arrays. */
    if (a.key_from != keys) {
        memcpy(keys, a.key_from, (size_t)count * sizeof *keys);
        memcpy(numbers, a.number_from, (size_t)count * sizeof *numbers);
    }
    bvxi_drop(ctx, spare);
    return BVX_OK;
}
