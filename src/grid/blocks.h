/* blocks.h - blocks of voxels counted 64 at a time. Not installed.
 *
 * Blocks of factor[0] x factor[1] x factor[2] voxels, aligned to the lattice. A row of blocks is seen as bit
 * planes: bit n of plane p is binary digit p of the count of block n, so 64 counts grow, are compared and are
 * stored together. */
#ifndef BVXI_BLOCKS_H
#define BVXI_BLOCKS_H

#include "grid/grid.h"

enum { BVXI_BLOCK_PLANES = 33 /* more digits than a block's count has */ };

/* Which bits of a word begin a block, and how they are brought together (gather_starts). */
typedef struct bvxi_block_starts {
    uint64_t mask;
    uint64_t move[6];
    int32_t count;
    int32_t reserved;
} bvxi_block_starts;

enum {
    BVXI_BLOCKS_ANY = 0 /* one plane: is any voxel set */,
    BVXI_BLOCKS_NONE = 1 /* one plane: is none empty */,
    BVXI_BLOCKS_COUNT = 2
};

typedef struct bvxi_blocks {
    const bvx_grid *grid;
    int32_t factor[3];   /* at most dims */
    int32_t phase;       /* voxels along x that the first block has before the window */
    int32_t words;       /* of a row with these in front */
    int32_t count_words; /* of a row of blocks, one bit each */
    int32_t what;        /* BVXI_BLOCKS_... */
    int32_t cpu;
    bvx_lattice lattice; /* of the blocks */
    bvx_window window;
    bvxi_block_starts *starts; /* [Size: words] */
    uint64_t *planes;          /* for each worker: two sets of planes of a row and one of a row of blocks */
    uint64_t worker_words;
    int32_t plane_count, workers; /* digits of a whole block's count */
} bvxi_blocks;

/* The planes of row (j, k) of blocks, count_words words each, one after
 * the other; *digits is how many, 0 when all counts are 0. */
const uint64_t *bvxi_blocks_row(const bvxi_blocks *blocks, int32_t worker, int32_t j, int32_t k,
                                int32_t *digits);

/* The voxels in the window of block i along an axis. */
static inline void bvxi_block_range(const bvxi_blocks *b, int32_t axis, int32_t i, int32_t *begin,
                                    int32_t *end)
{
    int64_t const low = ((int64_t)b->window.low[axis] + i) * b->factor[axis] - b->grid->low[axis];
    int64_t const high = low + b->factor[axis];
    *begin = low < 0 ? 0 : (int32_t)low;
    *end = high > b->grid->size[axis] ? b->grid->size[axis] : (int32_t)high;
}

#endif
