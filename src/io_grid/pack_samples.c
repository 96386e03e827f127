/* pack_samples.c - numbers of a file to bits of a grid, and bits to bytes.
 *
 * A number is 0 when no bit of it is set but the sign of a float; that requires a mask of bytes in the file's
 * own order, so neither byte order needs turning. Eight bytes become eight bits by a multiplication, and
 * back. */
#include "volume/room.h"
#include "io_grid/grid_formats.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

enum {
    UNPACK_GRAIN = 1 << 16 /* voxels of the smallest task */
};

/* What counts as set: a number with any of these bits. */
typedef struct pack_rule {
    uint64_t mask; /* the bytes of a number that count */
    uint32_t size; /* bytes of a number */
} pack_rule;

/* ---- runs of numbers to words of bits ---- */

/* Bit i is byte i of p, which is not 0. */
BVXI_VECTOR_INLINE uint64_t pack_64_bytes(const uint8_t *p)
{
    uint64_t w = 0, low = UINT64_C(0x7f7f7f7f7f7f7f7f);
    for (int32_t i = 0; i < 8; i++) {
        /* Adding 0x7f to the low seven bits carries into the top one
         * unless they are 0; or-ing the byte adds its own top bit. */
        uint64_t const v = bvxi_load_u64(p + 8 * i, 0);
        w |= bvxi_gather_bits((((v & low) + low) | v) >> 7 & UINT64_C(0x0101010101010101)) << 8 * i;
    }
    return w;
}

/* 64 numbers in turn: 1 for each that is not 0, into bytes by a loop that vectorizes. */
#define PACK_64(name, type)                                                 \
    BVXI_VECTOR_INLINE uint64_t name(const uint8_t *p, uint64_t mask_bytes) \
    {                                                                       \
        type mask, v;                                                       \
        uint8_t flag[64];                                                   \
        memcpy(&mask, &mask_bytes, sizeof mask);                            \
        for (size_t i = 0; i < 64; i++) {                                   \
            memcpy(&v, p + i * sizeof v, sizeof v);                         \
            flag[i] = (v & mask) != 0;                                      \
        }                                                                   \
        return bvxi_flags_to_word(flag);                                    \
    }
PACK_64(pack_64_u16, uint16_t)
PACK_64(pack_64_u32, uint32_t)
PACK_64(pack_64_u64, uint64_t)

BVXI_VECTOR_INLINE void pack_run_of(const pack_rule *rule, const uint8_t *p, int64_t stride, int32_t n,
                                    uint64_t *words)
{
    uint32_t const size = rule->size;

    /* Whole words need numbers side by side; the rest, and any other stride, goes one number at a time. */
    int32_t const whole = stride == (int64_t)size ? n >> 6 : 0;

    for (int32_t k = 0; k < whole; k++) {
        const uint8_t *const q = p + (size_t)k * 64 * size;
        words[k] = size == 1   ? pack_64_bytes(q)
                   : size == 2 ? pack_64_u16(q, rule->mask)
                   : size == 4 ? pack_64_u32(q, rule->mask)
                               : pack_64_u64(q, rule->mask);
    }
    for (int32_t i = 64 * whole; i < n; i += 64) {
        uint64_t w = 0;
        for (int32_t k = i; k < n && k < i + 64; k++) {
            uint64_t v = 0;
            memcpy(&v, p + (ptrdiff_t)(k * stride), size);
            w |= (uint64_t)((v & rule->mask) != 0) << (k - i);
        }
        words[i >> 6] = w;
    }
}

static void pack_run_portable(const void *rule, void *tally, const uint8_t *p, int64_t stride, int32_t n,
                              uint64_t *words)
{
    (void)tally;
    pack_run_of(rule, p, stride, n, words);
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static void pack_run_avx2(const void *rule, void *tally, const uint8_t *p, int64_t stride,
                                    int32_t n, uint64_t *words)
{
    const pack_rule *const r = rule;
    int32_t const whole = r->size == 1 && stride == 1 ? n >> 6 : 0;
    __m256i const zero = _mm256_setzero_si256();

    (void)tally;
    for (int32_t k = 0; k < whole; k++) {
        const uint8_t *const q = p + (size_t)k * 64;
        __m256i const low = _mm256_loadu_si256((const __m256i *)(const void *)q);
        __m256i const high = _mm256_loadu_si256((const __m256i *)(const void *)(q + 32));
        /* Compared with zero, so a set bit is an empty voxel: both halves are inverted together. */
        uint64_t const low_zero = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(low, zero));
        uint64_t const high_zero = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(high, zero));
        words[k] = ~(high_zero << 32 | low_zero);
    }
    pack_run_of(r, p + (size_t)whole * 64, stride, n - 64 * whole, words + whole);
}
#endif

bvx_status bvxi_pack_samples(bvx_context *ctx, const bvxi_samples *samples, const bvx_window *part,
                             bvx_grid *grid)
{
    pack_rule rule;

    rule.size = bvxi_sample_size(samples->kind);

    /* The bytes of a number that count, in the order of the file: all but the sign of a float. */
    int const is_float = samples->kind == BVXI_SAMPLE_F16 || samples->kind == BVX_SAMPLE_F32 ||
                         samples->kind == BVX_SAMPLE_F64;
    uint8_t byte[8];
    uint64_t mask;
    /* A float of -0 is 0: its sign is in the last byte of the file's order, or in the first one. */
    memset(byte, 0xff, sizeof byte);
    if (is_float) byte[samples->big ? 0 : rule.size - 1] = 0x7f;
    memcpy(&mask, byte, sizeof mask);
    rule.mask = mask;

    bvxi_sample_walk walk = {.first = samples->first};
    for (int a = 0; a < 3; a++) {
        walk.first += (ptrdiff_t)(part->low[a] * samples->stride[a]);
        walk.stride[a] = samples->stride[a];
    }
    walk.run = pack_run_portable;
#if BVXI_HAVE_AVX2
    if (bvxi_cpu(ctx) == BVX_CPU_AVX2) walk.run = pack_run_avx2;
#endif
    walk.rule = &rule;
    walk.grid = grid;
    bvxi_sample_walk_plan(&walk);
    return bvxi_samples_to_bits(ctx, "read", 0, 1, &walk);
}

/* ---- numbers in a text ---- */

bvx_status bvxi_take_sample(const bvxi_source *source, const int32_t dims[3], uint64_t done, const char **p,
                            double *value)
{
    const char *const at = bvxi_skip_space(*p, source->end);
    size_t used = 1;

    /* A number with white space or the end after it; most are single digits. */
    if (source->end - at >= 2 && *at >= '0' && *at <= '9' && bvxi_is_space(at[1])) {
        *value = *at - '0';
    } else {
        used = bvxi_parse_double(at, source->end, value);
        if (at + used < source->end && !bvxi_is_space(at[used])) used = 0;
    }
    *p = at;
    if (*p == source->end)
        return BVXI_LINE_FAIL(source, *p, BVX_ERR_FORMAT, "the samples end after %u of %u x %u x %u", done,
                              (uint64_t)dims[0], (uint64_t)dims[1], (uint64_t)dims[2]);
    if (used == 0) return bvxi_fail_expected(source, *p, "a number");
    *p += used;
    return BVX_OK;
}

/* ---- bits to bytes ---- */

typedef struct unpack_job {
    const bvx_grid *grid;
    uint8_t *bytes;
    int32_t pieces;
} unpack_job;

static void unpack_piece(void *user, int32_t piece)
{
    const unpack_job *const job = user;
    const bvx_grid *const g = job->grid;
    int32_t const nx = g->size[0];
    uint64_t row, end;
    /* Rows belong to one piece each, so no two workers write the same byte. */
    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++) {
        const uint64_t *const words = g->words + row * (uint64_t)g->words_per_row;
        uint8_t *const bytes = job->bytes + row * (uint64_t)nx;
        int32_t x = 0;
        for (; x + 8 <= nx; x += 8) {
            /* Eight voxels, lowest bit first, copied into every byte, of which each keeps another one; adding the
             * constant lifts any set bit to the top of its byte. */
            uint64_t const each = (words[x >> 6] >> (x & 63) & 0xff) * UINT64_C(0x0101010101010101) &
                                  UINT64_C(0x8040201008040201);
            bvxi_store_u64(bytes + x,
                           (each + UINT64_C(0x00406070787c7e7f)) >> 7 & UINT64_C(0x0101010101010101));
        }
        for (; x < nx; x++) bytes[x] = (uint8_t)(words[x >> 6] >> (x & 63) & 1);
    }
}

bvx_status bvxi_unpack_grid(bvx_context *ctx, const bvx_grid *grid, uint8_t *bytes)
{
    unpack_job job = {.grid = grid, .bytes = bytes};
    /* A row is the least that a piece holds; grain voxels make a task worth starting. */
    job.pieces = bvxi_piece_count(bvxi_grid_rows(grid), 1 + UNPACK_GRAIN / (uint64_t)grid->size[0]);
    return bvxi_each(ctx, "write", 0, 1, job.pieces, unpack_piece, &job);
}
