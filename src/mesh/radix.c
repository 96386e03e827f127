/* radix.c - least significant digit first, eight bits a digit.
 *
 * One pass counts all eight digits of all keys; a digit that is the same everywhere is skipped. Each further
 * pass moves elements between two pairs of arrays without changing the order of equal digits.
 * Cost: O(count) for each digit that differs. */
#include "mesh/mesh.h"

enum { RADIX_DIGITS = 8, RADIX_VALUES = 256 };

static void count_radix_digits(const uint64_t *keys, uint64_t count,
                               uint32_t table[RADIX_DIGITS][RADIX_VALUES])
{
    /* All digits are counted in one walk over the keys, as their counts do not depend on the order. */
    memset(table, 0, sizeof table[0] * RADIX_DIGITS);
    for (uint64_t i = 0; i < count; i++)
        for (int d = 0; d < RADIX_DIGITS; d++) table[d][keys[i] >> 8 * d & 255]++;
}

/* Counts become places of the first element of each value; 0 when one value has all elements. */
static int radix_counts_to_places(uint32_t table[RADIX_VALUES], uint64_t count)
{
    uint32_t sum = 0;

    for (int v = 0; v < RADIX_VALUES; v++) {
        uint32_t const n = table[v];
        /* A digit that is the same everywhere does not change the order: its pass is left out. */
        if (n == count) return 0;
        table[v] = sum;
        sum += n;
    }
    return 1;
}

bvx_status bvxi_radix_sort(bvx_context *ctx, uint64_t *keys, uint32_t *numbers, uint64_t count)
{
    uint32_t table[RADIX_DIGITS][RADIX_VALUES];
    uint64_t *spare_keys, *key_from = keys, *key_to, *key_swap;
    uint32_t *spare_numbers, *number_from = numbers, *number_to, *number_swap;
    bvx_status status;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * sizeof *keys, "the sort's keys", &spare_keys));
    status = bvxi_alloc(ctx, BVXI_SCRATCH, count * sizeof *numbers, "the sort's numbers", &spare_numbers);
    if (status != BVX_OK) {
        bvxi_drop(ctx, spare_keys);
        return status;
    }
    key_to = spare_keys;
    number_to = spare_numbers;
    count_radix_digits(keys, count, table);
    for (int d = 0; d < RADIX_DIGITS; d++) {
        /* Lowest digit first; each pass keeps the order of the one before among equal digits. */
        if (!radix_counts_to_places(table[d], count)) continue;
        for (uint64_t i = 0; i < count; i++) {
            uint32_t const place = table[d][key_from[i] >> 8 * d & 255]++;
            key_to[place] = key_from[i];
            number_to[place] = number_from[i];
        }
        key_swap = key_from;
        key_from = key_to;
        key_to = key_swap;
        number_swap = number_from;
        number_from = number_to;
        number_to = number_swap;
    }

    /* After an odd number of passes the result lies in the spare arrays. */
    if (key_from != keys) {
        memcpy(keys, key_from, (size_t)count * sizeof *keys);
        memcpy(numbers, number_from, (size_t)count * sizeof *numbers);
    }
    bvxi_drop(ctx, spare_numbers);
    bvxi_drop(ctx, spare_keys);
    return BVX_OK;
}
