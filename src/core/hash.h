/* hash.h - the hash of bvx_hash, fed piece by piece. Not installed.
 *
 * Arrays of numbers are taken as numbers and stand for their little-endian bytes, so the machine's own byte
 * order never shows. start, any number of pieces, end; one start and end make one bvx_hash of all the bytes
 * between. */
#ifndef BVXI_HASH_H
#define BVXI_HASH_H

#include "core/core.h"

typedef struct bvxi_hash {
    uint64_t state;
    uint64_t size;    /* bytes so far */
    uint64_t pending; /* size % 8 bytes that do not fill a word yet */
} bvxi_hash;

void bvxi_hash_start(bvxi_hash *hash, uint64_t seed);
uint64_t bvxi_hash_end(const bvxi_hash *hash);

void bvxi_hash_bytes(bvxi_hash *hash, const void *bytes, size_t count);
void bvxi_hash_u32(bvxi_hash *hash, const uint32_t *values, size_t count);
void bvxi_hash_i32(bvxi_hash *hash, const int32_t *values, size_t count);
void bvxi_hash_u64(bvxi_hash *hash, const uint64_t *values, size_t count);
/* Floats and doubles as their IEEE bits: -0 differs from 0. values may be of any alignment. */
void bvxi_hash_f32(bvxi_hash *hash, const void *values, size_t count);
void bvxi_hash_f64(bvxi_hash *hash, const void *values, size_t count);

#endif
