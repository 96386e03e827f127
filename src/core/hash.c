/* hash.c - the 64-bit hash behind all golden values.
 *
 * Source: Fowler, Noll, Vo. FNV-1a, here over 64-bit words. A product alone never carries high bits down, so
 * h ^= h >> 32 follows each step; the byte count as last word tells "ab" from "ab" and a zero.
 * Guarantee: the same number on every machine. Not meant against people who want collisions. */
#include "core/hash.h"

static const uint64_t hash_basis = UINT64_C(0xcbf29ce484222325), hash_prime = UINT64_C(0x100000001b3);

static inline uint64_t hash_step(uint64_t h, uint64_t word)
{
    h = (h ^ word) * hash_prime;
    return h ^ h >> 32;
}

static inline uint64_t little_endian_word(const unsigned char *b)
{
    return (uint64_t)b[0] | (uint64_t)b[1] << 8 | (uint64_t)b[2] << 16 | (uint64_t)b[3] << 24 |
           (uint64_t)b[4] << 32 | (uint64_t)b[5] << 40 | (uint64_t)b[6] << 48 | (uint64_t)b[7] << 56;
}

/* Add the low n bytes of value, n <= 8; the bits above them are zero. */
static inline void hash_part(bvxi_hash *hash, uint64_t value, unsigned n)
{
    unsigned const have = (unsigned)(hash->size & 7);
    hash->pending |= value << 8 * have;
    hash->size += n;
    if (have + n >= 8) {
        hash->state = hash_step(hash->state, hash->pending);
        hash->pending = have == 0 ? 0 : value >> 8 * (8 - have);
    }
}

void bvxi_hash_start(bvxi_hash *hash, uint64_t seed)
{
    hash->state = seed ^ hash_basis;
    hash->size = 0;
    hash->pending = 0;
}

uint64_t bvxi_hash_end(const bvxi_hash *hash)
{
    uint64_t const h = (hash->size & 7) != 0 ? hash_step(hash->state, hash->pending) : hash->state;
    return hash_step(h, hash->size);
}

void bvxi_hash_bytes(bvxi_hash *hash, const void *bytes, size_t count)
{
    const unsigned char *b = bytes;

    while ((hash->size & 7) != 0 && count != 0) {
        hash_part(hash, *b++, 1);
        count--;
    }
    if ((hash->size & 7) == 0) {
        uint64_t h = hash->state;
        size_t const words = count / 8;
        for (size_t i = 0; i < words; i++) h = hash_step(h, little_endian_word(b + 8 * i));
        hash->state = h;
        hash->size += 8 * (uint64_t)words;
        b += 8 * words;
        count -= 8 * words;
    }
    while (count-- != 0) hash_part(hash, *b++, 1);
}

static void hash_fours(bvxi_hash *hash, const unsigned char *p, size_t count)
{
    uint32_t v[2];

    if ((hash->size & 7) == 0 && count >= 2) {
        uint64_t h = hash->state;
        size_t const words = count / 2;
        for (size_t i = 0; i < words; i++) {
            memcpy(v, p + 8 * i, 8);
            h = hash_step(h, (uint64_t)v[0] | (uint64_t)v[1] << 32);
        }
        hash->state = h;
        hash->size += 8 * (uint64_t)words;
        p += 8 * words;
        count -= 2 * words;
    }
    for (; count != 0; count--, p += 4) {
        memcpy(v, p, 4);
        hash_part(hash, v[0], 4);
    }
}

static void hash_eights(bvxi_hash *hash, const unsigned char *p, size_t count)
{
    uint64_t v;
    for (; count != 0; count--, p += 8) {
        memcpy(&v, p, 8);
        if ((hash->size & 7) != 0) {
            hash_part(hash, v, 8);
            continue;
        }
        hash->state = hash_step(hash->state, v);
        hash->size += 8;
    }
}

void bvxi_hash_u32(bvxi_hash *hash, const uint32_t *values, size_t count)
{
    hash_fours(hash, (const unsigned char *)values, count);
}

void bvxi_hash_i32(bvxi_hash *hash, const int32_t *values, size_t count)
{
    hash_fours(hash, (const unsigned char *)values, count);
}

void bvxi_hash_f32(bvxi_hash *hash, const void *values, size_t count)
{
    hash_fours(hash, values, count);
}

void bvxi_hash_u64(bvxi_hash *hash, const uint64_t *values, size_t count)
{
    hash_eights(hash, (const unsigned char *)values, count);
}

void bvxi_hash_f64(bvxi_hash *hash, const void *values, size_t count)
{
    hash_eights(hash, values, count);
}

uint64_t bvx_hash(const void *bytes, size_t size, uint64_t seed)
{
    bvxi_hash hash;
    bvxi_hash_start(&hash, seed);
    if (bytes != NULL && size != 0) bvxi_hash_bytes(&hash, bytes, size);
    return bvxi_hash_end(&hash);
}
