/* room.h - voxels of several sizes: levels in flat arrays, child masks and rank, no pointers. Not
 * installed.
 *
 * Voxels of level 0 are those of the base lattice, those of level l + 1 are theirs in eight. Of the voxels
 * that triangles touch those above the last level are split (all, or those that a window or a tolerance asks
 * for); the eight children are an octet. Octet n of level l is the n-th split voxel of that level, in the
 * order of the base's bits (z, y, x), within a base voxel along a curve: child p = x + 2 y + 4 z of octet n
 * stands behind child p - 1. So children are bits 8 n + p of the masks of a level, and the number of the
 * octet that a child is split into is the number of split bits before its own. */
#ifndef BVXI_REFINE_ROOM_H
#define BVXI_REFINE_ROOM_H

#include "bits/bits.h"
#include "lattice/lattice.h"

/* Side 2^25 over base side 1. */
enum { BVXI_OCTREE_LEVELS = 25 };

/* Directions as the paper's boundary states have them: bit d of 00zyx-z-y-x. */
enum { BVXI_DIRECTIONS = 6 };

/* Voxels as bits: touched by a triangle; outside; what has neither is inside. */
typedef struct bvxi_octets {
    uint64_t *touched, *outside;
    /* of the touched ones; the same array as touched when that is all of them, NULL when it is none */
    uint64_t *split;
    uint32_t *before; /* split bits before each word; NULL when none is split */
    uint64_t count;   /* octets; of the base: rows */
    uint64_t words;
} bvxi_octets;

struct bvx_octree {
    bvx_lattice lattice; /* of the last level */
    int32_t base[3];     /* voxels of level 0 along each axis */
    int32_t levels;
    int32_t row_words; /* of the base */
    int32_t reserved;
    bvxi_octets root;                       /* voxels of level 0, rows as in a grid */
    bvxi_octets octets[BVXI_OCTREE_LEVELS]; /* [l]: split voxels of level l, voxels of level l + 1 */
};

/* Children on the side of an octet towards direction d. */
static inline uint32_t bvxi_octet_side(int d)
{
    static const uint8_t side[BVXI_DIRECTIONS] = {0x55, 0x33, 0x0f, 0xaa, 0xcc, 0xf0};
    return side[d];
}

static inline uint64_t bvxi_octet_words(uint64_t n)
{
    return (n + 7) / 8;
}

static inline uint32_t bvxi_octet_mask(const uint64_t *words, uint64_t n)
{
    return (uint32_t)(words[n >> 3] >> (8 * (n & 7)) & 255);
}

static inline void bvxi_octet_put(uint64_t *words, uint64_t n, uint32_t mask)
{
    unsigned const shift = 8 * (unsigned)(n & 7);
    words[n >> 3] = (words[n >> 3] & ~((uint64_t)255 << shift)) | (uint64_t)mask << shift;
}

/* Split bits before a bit: the number of the octet that it is split into. */
static inline uint32_t bvxi_octets_rank(const bvxi_octets *o, uint64_t bit)
{
    uint64_t const below = o->split[bit >> 6] & ((UINT64_C(1) << (bit & 63)) - 1);
    return o->before[bit >> 6] + bvxi_popcount(below);
}

static inline uint64_t bvxi_root_bit(const bvx_octree *tree, int32_t x, int32_t y, int32_t z)
{
    return ((uint64_t)z * (uint64_t)tree->base[1] + (uint64_t)y) * (uint64_t)tree->row_words *
               BVXI_WORD_BITS +
           (uint64_t)x;
}

static inline uint32_t bvxi_bit_of(const uint64_t *words, uint64_t bit)
{
    return (uint32_t)(words[bit >> 6] >> (bit & 63) & 1);
}

static inline uint32_t bvxi_octets_is_split(const bvxi_octets *o, uint64_t bit)
{
    return o->split != NULL ? bvxi_bit_of(o->split, bit) : 0;
}

static inline uint32_t bvxi_octet_split(const bvxi_octets *o, uint64_t n)
{
    return o->split != NULL ? bvxi_octet_mask(o->split, n) : 0;
}

/* State of the voxel at a bit of a level, touched ones as surface. */
static inline int32_t bvxi_octets_state(const bvxi_octets *o, uint64_t bit)
{
    return bvxi_bit_of(o->touched, bit)   ? BVX_STATE_SURFACE
           : bvxi_bit_of(o->outside, bit) ? BVX_STATE_OUTSIDE
                                          : BVX_STATE_INSIDE;
}

/* Children of an octet in a set of states. */
static inline uint32_t bvxi_octet_in_states(const bvxi_octets *o, uint64_t n, int32_t states)
{
    uint32_t const touched = bvxi_octet_mask(o->touched, n), outside = bvxi_octet_mask(o->outside, n);
    return ((states & BVX_STATE_SURFACE) != 0 ? touched : 0) |
           ((states & BVX_STATE_OUTSIDE) != 0 ? outside : 0) |
           ((states & BVX_STATE_INSIDE) != 0 ? ~(touched | outside) & 255 : 0);
}

/* Voxel v's child p, of the next level. */
static inline void bvxi_child_voxel(const int32_t v[3], uint32_t p, int32_t child[3])
{
    for (uint32_t a = 0; a < 3; a++) child[a] = 2 * v[a] + (int32_t)(p >> a & 1);
}

static inline bvx_octree_leaf bvxi_octree_leaf_at(const int32_t v[3], int32_t level, int32_t state)
{
    return (bvx_octree_leaf){.ijk = {v[0], v[1], v[2]}, .level = (uint8_t)level, .state = (uint8_t)state};
}

/* ---- octree.c ---- */

/* Which of the touched voxels of a level are split. */
enum { BVXI_SPLIT_NONE = 0, BVXI_SPLIT_ALL = 1, BVXI_SPLIT_SOME = 2 };

/* Masks and ranks of a level, or of the root, all zero. After a failure *octets holds what was made. */
bvx_status bvxi_octets_open(bvx_context *ctx, uint64_t count, uint64_t words, int split, bvxi_octets *octets);
void bvxi_octets_close(bvx_context *ctx, bvxi_octets *octets);
/* Fill `before`; returns the split bits, of which there must be fewer than 2^32. */
uint64_t bvxi_octets_count(bvxi_octets *octets);
bvx_status bvxi_octree_check(bvx_context *ctx, const char *function, const bvx_octree *tree);
/* Refuse what is no set of states. */
bvx_status bvxi_octree_check_states(bvx_context *ctx, const char *function, int32_t states);
bvx_status bvxi_octree_lattice(bvx_context *ctx, const bvx_octree *tree, int32_t level, bvx_lattice *lattice);
/* The masks and the bit of the voxel that holds voxel v of a level: a leaf of level *at, or v itself. */
const bvxi_octets *bvxi_octree_holder(const bvx_octree *tree, int32_t level, const int32_t v[3], int32_t *at,
                                      uint64_t *bit);

/* ---- leaves.c ---- */

/* bvx_octree_leaves for another function, as the part [from, to] of its work. */
bvx_status bvxi_octree_leaves(bvxi_call step, const bvx_octree *tree, int32_t states, bvx_octree_leaf *leaves,
                              uint64_t capacity, uint64_t *count);

#endif
