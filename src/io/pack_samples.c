/* pack_samples.c - numbers of a file to bits of a grid, and bits to bytes.
 *
 * A number is 0 when no bit of it is set but the sign of a float; that asks for a mask of bytes in the file's own order,
 * so neither byte order needs turning. Eight bytes become eight bits by a multiplication, and back.
 *
 * Where x runs fastest, a row of samples is a row of bits. Where another axis does (C order), tiles of TILE_X by TILE_Z
 * voxels are packed along z, so that the file is read in runs, turned by transposing 64 by 64 bits (Warren. Hacker's
 * Delight. 2003, section 7-3), and written in rows. Guarantee: a task writes rows or tiles of its own; which thread runs it
 * shows nowhere. */
#include "io/formats.h"
#include "io/grid_formats.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

enum {
    TILE_X_WORDS = 8, TILE_Z_WORDS = 8, /* 512 by 512 voxels: 32 KiB of turned rows, 4 KiB of runs */
    PACK_GRAIN = 1 << 16,               /* samples of the smallest task */
    TEXT_ASK_BYTES = 1 << 20
};

/* n numbers, stride bytes apart, to (n + 63) / 64 words; bits behind the last are 0. mask: the bytes of a number that count. */
typedef void pack_run_fn(const uint8_t *p, uint64_t stride, uint32_t size, uint64_t mask, int32_t n, uint64_t *words);

typedef struct pack_job {
    const bvxi_samples *samples;
    bvx_grid *grid;
    const uint8_t *first;  /* sample of the grid's voxel (0,0,0) */
    pack_run_fn *run;
    uint64_t mask;
    uint32_t size;         /* bytes of a number */
    int32_t pieces;
    int32_t tiles_z;       /* tiles along z; 0: x runs fastest, no tiles */
} pack_job;

/* ---- runs of numbers to words of bits ---- */

/* Bit i is byte i of p, which is not 0. */
static inline uint64_t pack_eight(const uint8_t *p)
{
    uint64_t const v = bvxi_load_u64(p, 0), low = UINT64_C(0x7f7f7f7f7f7f7f7f);
    uint64_t const set = (((v & low) + low) | v) >> 7 & UINT64_C(0x0101010101010101);
    return set * UINT64_C(0x0102040810204080) >> 56;
}

BVXI_VECTOR_INLINE uint64_t pack_64_bytes(const uint8_t *p)
{
    uint64_t w = 0;
    for (int32_t i = 0; i < 8; i++) w |= pack_eight(p + 8 * i) << 8 * i;
    return w;
}

/* 64 numbers one behind the other: 1 for each that is not 0, into bytes by a loop that compilers make vectors of. */
#define PACK_64(name, type)                                                     \
    BVXI_VECTOR_INLINE uint64_t name(const uint8_t *p, uint64_t mask_bytes)     \
    {                                                                           \
        type mask, v;                                                           \
        uint8_t flag[64];                                                       \
        memcpy(&mask, &mask_bytes, sizeof mask);                                \
        for (size_t i = 0; i < 64; i++) {                                       \
            memcpy(&v, p + i * sizeof v, sizeof v);                             \
            flag[i] = (v & mask) != 0;                                          \
        }                                                                       \
        return pack_64_bytes(flag);                                             \
    }
PACK_64(pack_64_u16, uint16_t)
PACK_64(pack_64_u32, uint32_t)
PACK_64(pack_64_u64, uint64_t)

/* Up to 64 numbers anywhere. */
static uint64_t pack_few(const uint8_t *p, uint64_t stride, uint32_t size, uint64_t mask, int32_t n)
{
    uint64_t w = 0;
    for (int32_t i = 0; i < n; i++) {
        uint64_t v = 0;
        memcpy(&v, p + (uint64_t)i * stride, size);
        w |= (uint64_t)((v & mask) != 0) << i;
    }
    return w;
}

BVXI_VECTOR_INLINE void pack_run_of(const uint8_t *p, uint64_t stride, uint32_t size, uint64_t mask, int32_t n, uint64_t *words)
{
    int32_t const whole = stride == size ? n >> 6 : 0;
    for (int32_t k = 0; k < whole; k++) {
        const uint8_t *const q = p + (size_t)k * 64 * size;
        words[k] = size == 1 ? pack_64_bytes(q) : size == 2 ? pack_64_u16(q, mask)
                   : size == 4 ? pack_64_u32(q, mask) : pack_64_u64(q, mask);
    }
    for (int32_t i = 64 * whole; i < n; i += 64)
        words[i >> 6] = pack_few(p + (uint64_t)i * stride, stride, size, mask, n - i < 64 ? n - i : 64);
}

static void pack_run_portable(const uint8_t *p, uint64_t stride, uint32_t size, uint64_t mask, int32_t n, uint64_t *words)
{
    pack_run_of(p, stride, size, mask, n, words);
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static void pack_run_avx2(const uint8_t *p, uint64_t stride, uint32_t size, uint64_t mask, int32_t n, uint64_t *words)
{
    int32_t const whole = size == 1 && stride == 1 ? n >> 6 : 0;
    __m256i const zero = _mm256_setzero_si256();
    for (int32_t k = 0; k < whole; k++) {
        const uint8_t *const q = p + (size_t)k * 64;
        __m256i const low = _mm256_loadu_si256((const __m256i *)(const void *)q);
        __m256i const high = _mm256_loadu_si256((const __m256i *)(const void *)(q + 32));
        uint64_t const low_zero = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(low, zero));
        uint64_t const high_zero = (uint32_t)_mm256_movemask_epi8(_mm256_cmpeq_epi8(high, zero));
        words[k] = ~(high_zero << 32 | low_zero);
    }
    pack_run_of(p + (size_t)whole * 64 * size, stride, size, mask, n - 64 * whole, words + whole);
}
#endif

static pack_run_fn *pack_run_for(const bvx_context *ctx)
{
#if BVXI_HAVE_AVX2
    if (bvxi_cpu(ctx) == BVX_CPU_AVX2) return pack_run_avx2;
#else
    (void)ctx;
#endif
    return pack_run_portable;
}

/* ---- x fastest: rows ---- */

static void pack_rows(void *user, int32_t piece, int32_t worker)
{
    const pack_job *const job = user;
    const bvxi_samples *const s = job->samples;
    bvx_grid *const g = job->grid;
    uint64_t row, end;
    (void)worker;
    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++) {
        uint64_t const y = row % (uint64_t)g->size[1], z = row / (uint64_t)g->size[1];
        job->run(job->first + y * s->stride[1] + z * s->stride[2], s->stride[0], job->size, job->mask, g->size[0],
                 g->words + row * (uint64_t)g->words_per_row);
    }
}

/* ---- z fastest: tiles of x and z in a plane of y ---- */

/* Bit j of a[i] changes places with bit i of a[j]. */
static void pack_transpose(uint64_t a[64])
{
    uint64_t mask = UINT64_C(0x00000000ffffffff);
    for (int32_t j = 32; j != 0; j >>= 1, mask ^= mask << j)
        for (int32_t block = 0; block < 64; block += 2 * j)
            for (int32_t k = block; k < block + j; k++) {
                uint64_t const t = (a[k] >> j ^ a[k + j]) & mask;
                a[k] ^= t << j;
                a[k + j] ^= t;
            }
}

/* Up to 64 TILE_X_WORDS by 64 TILE_Z_WORDS voxels from (x0, y, z0) on. */
static void pack_tile(const pack_job *job, int32_t x0, int32_t y, int32_t z0)
{
    const bvxi_samples *const s = job->samples;
    bvx_grid *const g = job->grid;
    uint64_t run[64][TILE_Z_WORDS], square[64], turned[64 * TILE_Z_WORDS][TILE_X_WORDS];
    int32_t const nz = g->size[2] - z0 < 64 * TILE_Z_WORDS ? g->size[2] - z0 : 64 * TILE_Z_WORDS;
    int32_t const nx = g->size[0] - x0 < 64 * TILE_X_WORDS ? g->size[0] - x0 : 64 * TILE_X_WORDS;
    int32_t const words_x = bvxi_row_words(nx), words_z = bvxi_row_words(nz);
    const uint8_t *const corner =
        job->first + (uint64_t)x0 * s->stride[0] + (uint64_t)y * s->stride[1] + (uint64_t)z0 * s->stride[2];
    for (int32_t kx = 0; kx < words_x; kx++) {
        int32_t const n = nx - 64 * kx < 64 ? nx - 64 * kx : 64;
        for (int32_t i = 0; i < n; i++)
            job->run(corner + (uint64_t)(64 * kx + i) * s->stride[0], s->stride[2], job->size, job->mask, nz, run[i]);
        for (int32_t kz = 0; kz < words_z; kz++) {
            for (int32_t i = 0; i < 64; i++) square[i] = i < n ? run[i][kz] : 0;
            pack_transpose(square);
            for (int32_t i = 0; i < 64; i++) turned[64 * kz + i][kx] = square[i];
        }
    }
    for (int32_t z = 0; z < nz; z++)
        memcpy(g->words + ((uint64_t)(z0 + z) * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->words_per_row + (x0 >> 6),
               turned[z], (size_t)words_x * 8);
}

static void pack_tiles(void *user, int32_t piece, int32_t worker)
{
    const pack_job *const job = user;
    const bvx_grid *const g = job->grid;
    uint64_t tile, end;
    (void)worker;
    bvxi_piece((uint64_t)job->tiles_z * (uint64_t)g->size[1], job->pieces, piece, &tile, &end);
    for (; tile < end; tile++) {
        int32_t const y = (int32_t)(tile / (uint64_t)job->tiles_z);
        int32_t const z = (int32_t)(tile % (uint64_t)job->tiles_z) * 64 * TILE_Z_WORDS;
        for (int32_t x = 0; x < g->size[0]; x += 64 * TILE_X_WORDS) pack_tile(job, x, y, z);
    }
}

/* ---- tasks ---- */

/* The bytes of a number that count, in the order of the file: all but the sign of a float. */
static uint64_t pack_mask(const bvxi_samples *samples, uint32_t size)
{
    int const is_float = samples->kind == BVXI_SAMPLE_F16 || samples->kind == BVXI_SAMPLE_F32 || samples->kind == BVXI_SAMPLE_F64;
    uint8_t byte[8];
    uint64_t mask;
    memset(byte, 0xff, sizeof byte);
    if (is_float) byte[samples->big ? 0 : size - 1] = 0x7f;
    memcpy(&mask, byte, sizeof mask);
    return mask;
}

bvx_status bvxi_pack_samples(bvx_context *ctx, const bvxi_samples *samples, const bvx_window *part, bvx_grid *grid)
{
    pack_job job;
    int const x_fastest = samples->stride[0] <= samples->stride[2];
    uint64_t const row = (uint64_t)grid->size[x_fastest ? 0 : 2];
    uint64_t const rows = (uint64_t)grid->size[1] * (uint64_t)grid->size[x_fastest ? 2 : 0];
    job.samples = samples;
    job.grid = grid;
    job.first = samples->first;
    for (int a = 0; a < 3; a++) job.first += (uint64_t)part->low[a] * samples->stride[a];
    job.run = pack_run_for(ctx);
    job.size = bvxi_sample_size(samples->kind);
    job.mask = pack_mask(samples, job.size);
    job.tiles_z = x_fastest ? 0 : (grid->size[2] + 64 * TILE_Z_WORDS - 1) / (64 * TILE_Z_WORDS);
    job.pieces = bvxi_piece_count(rows, 1 + PACK_GRAIN / row);
    return bvxi_parallel(ctx, "read", 0, 1, job.pieces, x_fastest ? pack_rows : pack_tiles, &job);
}

/* ---- numbers in a text ---- */

/* A number at p with white space or the end behind it; returns its bytes, 0 for none. Most samples are single digits. */
static size_t pack_text_number(const char *p, const char *end, double *value)
{
    size_t used;
    if (end - p >= 2 && *p >= '0' && *p <= '9' && bvxi_is_space(p[1])) {
        *value = *p - '0';
        return 1;
    }
    used = bvxi_parse_double(p, end, value);
    return p + used < end && !bvxi_is_space(p[used]) ? 0 : used;
}

bvx_status bvxi_pack_text(bvx_context *ctx, const char *format, const char *file, const char *begin, const char *end,
                          const int32_t dims[3], const bvx_window *part, bvx_grid *grid, const char **stop)
{
    bvxi_source source = {0};
    const char *p = begin, *ask = begin;
    uint64_t done = 0;
    source.ctx = ctx;
    source.format = format;
    source.begin = file;
    source.end = end;
    for (int32_t z = 0; z < dims[2]; z++)
        for (int32_t y = 0; y < dims[1]; y++)
            for (int32_t x = 0; x < dims[0]; x++) {
                double v;
                p = bvxi_skip_space(p, end);
                if (p >= ask) {
                    BVXI_TRY(bvxi_progress(ctx, "read", begin == end ? 0.0 : (double)(p - begin) / (double)(end - begin)));
                    ask = end - p > TEXT_ASK_BYTES ? p + TEXT_ASK_BYTES : end;
                }
                size_t const used = pack_text_number(p, end, &v);
                if (p == end)
                    return bvxi_fail(ctx, BVX_ERR_FORMAT, "%s: line %u: the samples end behind %u of %u x %u x %u", format,
                                     bvxi_source_line(&source, p), done, (uint64_t)dims[0], (uint64_t)dims[1], (uint64_t)dims[2]);
                if (used == 0) return bvxi_fail_expected(&source, p, "a number");
                p += used;
                done++;
                if (v != 0.0) bvxi_set_file_run(grid, part, x, (int64_t)x + 1, y, z); /* NaN is not 0 */
            }
    *stop = p;
    return BVX_OK;
}

/* ---- bits to bytes ---- */

/* Eight voxels, the lowest bit first: the multiplication copies them into every byte, of which each keeps another one. */
static inline void unpack_eight(uint8_t *p, uint64_t bits)
{
    uint64_t const one_each = (bits & 0xff) * UINT64_C(0x0101010101010101) & UINT64_C(0x8040201008040201);
    uint64_t const bytes = (one_each + UINT64_C(0x00406070787c7e7f)) >> 7 & UINT64_C(0x0101010101010101);
    bvxi_store_u32(p, (uint32_t)(bytes & 0xffffffffu));
    bvxi_store_u32(p + 4, (uint32_t)(bytes >> 32));
}

void bvxi_unpack_row(const uint64_t *row, int32_t nx, uint8_t *bytes)
{
    int32_t x = 0;
    for (; x + 8 <= nx; x += 8) unpack_eight(bytes + x, row[x >> 6] >> (x & 63));
    for (; x < nx; x++) bytes[x] = (uint8_t)(row[x >> 6] >> (x & 63) & 1);
}

typedef struct unpack_job {
    const bvx_grid *grid;
    uint8_t *bytes;
    int32_t pieces;
} unpack_job;

static void unpack_piece(void *user, int32_t piece, int32_t worker)
{
    const unpack_job *const job = user;
    const bvx_grid *const g = job->grid;
    uint64_t row, end;
    (void)worker;
    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++)
        bvxi_unpack_row(g->words + row * (uint64_t)g->words_per_row, g->size[0], job->bytes + row * (uint64_t)g->size[0]);
}

bvx_status bvxi_unpack_grid(bvx_context *ctx, const bvx_grid *grid, uint8_t *bytes)
{
    unpack_job job;
    job.grid = grid;
    job.bytes = bytes;
    job.pieces = bvxi_piece_count(bvxi_grid_rows(grid), 1 + PACK_GRAIN / (uint64_t)grid->size[0]);
    return bvxi_parallel(ctx, "write", 0, 1, job.pieces, unpack_piece, &job);
}
