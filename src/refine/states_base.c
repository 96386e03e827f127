/* states_base.c - the flood among the base's voxels, a row of bits at a time.
 *
 * A row with news is filled along x, each run of empty voxels that holds an outside one at once; what is new
 * goes to the four rows beside it, and as exposed faces to the octets beside it. */
#include "refine/states.h"

static inline uint64_t empty_of_row(const bvxi_states_job *job, uint64_t word)
{
    uint64_t const all = (word + 1) % (uint64_t)job->row_words == 0 ? bvxi_tail_mask(job->nx) : ~UINT64_C(0);
    return ~job->tree->root.touched[word] & all;
}

/* Bits of p that can be reached from g along p upwards; downwards. */
static inline uint64_t reach_up(uint64_t g, uint64_t p)
{
    g |= p & g << 1;
    p &= p << 1;
    g |= p & g << 2;
    p &= p << 2;
    g |= p & g << 4;
    p &= p << 4;
    g |= p & g << 8;
    p &= p << 8;
    g |= p & g << 16;
    p &= p << 16;
    return g | (p & g << 32);
}

static inline uint64_t reach_down(uint64_t g, uint64_t p)
{
    g |= p & g >> 1;
    p &= p >> 1;
    g |= p & g >> 2;
    p &= p >> 2;
    g |= p & g >> 4;
    p &= p >> 4;
    g |= p & g >> 8;
    p &= p >> 8;
    g |= p & g >> 16;
    p &= p >> 16;
    return g | (p & g >> 32);
}

/* Fill a row's runs that hold outside bits. */
static void fill_base_row(const bvxi_states_job *job, uint64_t row)
{
    uint64_t const begin = row * (uint64_t)job->row_words, end = begin + (uint64_t)job->row_words;
    uint64_t *const outside = job->tree->root.outside;
    uint64_t carry = 0;

    for (uint64_t i = begin; i < end; i++) {
        uint64_t const empty = empty_of_row(job, i);
        outside[i] = reach_up(outside[i] | (carry & empty), empty);
        carry = outside[i] >> 63;
    }
    carry = 0;
    for (uint64_t i = end; i-- > begin;) {
        uint64_t const empty = empty_of_row(job, i);
        outside[i] = reach_down(outside[i] | (carry << 63 & empty), empty);
        carry = outside[i] & 1;
    }
}

/* Face d of base voxels that are split is exposed: bits of one word. */
static void expose_base_octets(bvxi_states_job *job, uint64_t word, uint64_t bits, int d)
{
    if (job->tree->root.split == NULL) return;
    for (bits &= job->tree->root.split[word]; bits != 0; bits &= bits - 1)
        bvxi_expose_octet(
            job, 0, bvxi_octets_rank(&job->tree->root, word * BVXI_WORD_BITS + (uint64_t)bvxi_lowest(bits)),
            1u << d);
}

/* Bits that are new in a word of the base, to the rows beside it. */
static void pass_to_row(bvxi_states_job *job, uint64_t row, uint64_t column, uint64_t news, int d)
{
    uint64_t const word = row * (uint64_t)job->row_words + column;
    uint64_t const fresh = news & empty_of_row(job, word) & ~job->tree->root.outside[word];
    if (fresh != 0) {
        job->tree->root.outside[word] |= fresh;
        bvxi_list_row(job, row);
    }
    expose_base_octets(job, word, news, (d + 3) % 6);
}

void bvxi_work_on_row(bvxi_states_job *job, uint64_t row)
{
    uint64_t const first = row * (uint64_t)job->row_words, ny = (uint64_t)job->ny, y = row % ny, z = row / ny;

    job->row_in_list[row] = 0;
    fill_base_row(job, row);
    for (uint64_t i = 0; i < (uint64_t)job->row_words; i++) {
        uint64_t const news = job->tree->root.outside[first + i] & ~job->passed[first + i];
        if (news == 0) continue;
        job->passed[first + i] |= news;
        if (y > 0) pass_to_row(job, row - 1, i, news, 1);
        if (y + 1 < ny) pass_to_row(job, row + 1, i, news, 4);
        if (z > 0) pass_to_row(job, row - ny, i, news, 2);
        if (z + 1 < (uint64_t)job->nz) pass_to_row(job, row + ny, i, news, 5);
        expose_base_octets(job, first + i, news << 1, 0); /* beyond +x: their face towards -x */
        expose_base_octets(job, first + i, news >> 1, 3);
        if (i + 1 < (uint64_t)job->row_words) expose_base_octets(job, first + i + 1, news >> 63, 0);
        if (i > 0) expose_base_octets(job, first + i - 1, news << 63, 3);
    }
}

void bvxi_expose_sides(bvxi_states_job *job)
{
    uint64_t const rows = (uint64_t)job->ny * (uint64_t)job->nz;

    for (uint64_t row = 0; row < rows; row++) {
        int32_t const y = (int32_t)(row % (uint64_t)job->ny), z = (int32_t)(row / (uint64_t)job->ny);
        for (int32_t i = 0; i < job->row_words; i++) {
            uint64_t const word = row * (uint64_t)job->row_words + (uint64_t)i, all = ~UINT64_C(0);
            uint64_t const side[BVXI_DIRECTIONS] = {
                i == 0 ? 1 : 0,
                y == 0 ? all : 0,
                z == 0 ? all : 0,
                i + 1 == job->row_words ? UINT64_C(1) << ((job->nx - 1) & 63) : 0,
                y + 1 == job->ny ? all : 0,
                z + 1 == job->nz ? all : 0};
            uint64_t sides = 0;
            for (int d = 0; d < BVXI_DIRECTIONS; d++) {
                sides |= side[d];
                expose_base_octets(job, word, side[d], d);
            }
            job->tree->root.outside[word] |= sides & empty_of_row(job, word);
            if ((sides & empty_of_row(job, word)) != 0) bvxi_list_row(job, row);
        }
    }
}
