/* morph_runs.c - dilation and erosion by a ball of some voxels, a word at a time: the ball is a bundle of
 * runs along x.
 *
 * Source: van Droogenbroeck, Talbot. Fast computation of morphological operations with arbitrary structuring
 * elements. 1996 (a structuring element as a union of runs).
 *
 * A slice is grown along x by 0, 1, 2 ... voxels. For each dz its rows, each grown as far as the ball is wide
 * at (dy, dz), are joined over dy, and the result is joined to the slices dz below and above. Erosion is this
 * on the complement. Each piece of slices writes its own slices only. Exact: which offsets belong to the
 * ball is decided by the numbers that distances have (transform.h). */
#include "morphology/morph.h"

enum {
    RUNS_GRAIN = 1 << 10 /* words of the smallest task */,
    RUNS_CHUNK = 1024 /* words joined while they are near */,
    RUNS_MOST = 4000
};

/* Reports go by these, results do not [Units: nanoseconds] */
#define RUNS_WORD_TIME 0.1 /* to join a word to one of a ball's rows, as measured on one processor */
#define RUNS_STEP_TIME 4e7 /* of a piece between two reports */

typedef struct runs_job {
    bvxi_bit_box from, to;
    bvxi_row_ends ends;
    unsigned char *scratch;
    uint64_t scratch_size; /* of a worker [Units: bytes] */
    int32_t *half;         /* of the run at (dy, dz) as [dz][dy]; -1: none */
    uint64_t half_bytes, tail, around, flip;
    size_t slice, room; /* words of a slice, and of one with rows beyond it */
    int32_t reach[3], pieces, cpu;
    int32_t steps, step; /* a piece's slices are spread in so many steps, between which the caller is asked */
} runs_job;

/* k voxels along x from (dy, dz) are in the ball. */
static int in_ball(const bvxi_morph *m, int32_t k, int32_t dy, int32_t dz)
{
    /* The order of distances of transform.h: both ways must agree in every bit. */
    double const x = (double)k, y = (double)dy, z = (double)dz;
    return (m->weight[0] * (x * x) + m->weight[1] * (y * y)) + m->weight[2] * (z * z) <= m->limit;
}

/* The furthest voxel along an axis, below 2 * RUNS_MOST. */
static int32_t ball_extent(const bvxi_morph *m, int axis)
{
    int32_t k = 0;
    while (k < 2 * RUNS_MOST &&
           in_ball(m, axis == 0 ? k + 1 : 0, axis == 1 ? k + 1 : 0, axis == 2 ? k + 1 : 0))
        k++;
    return k;
}

int bvxi_ball_is_small(const bvxi_morph *morph)
{
    /* What a word costs: joining rows over dy and dz, growing along x; beyond it the transform is sooner. */
    return (2 * (int64_t)ball_extent(morph, 1) + 1) * (2 * (int64_t)ball_extent(morph, 2) + 1) +
               8 * (int64_t)ball_extent(morph, 0) <=
           RUNS_MOST;
}

BVXI_VECTOR_INLINE void grow_slice_loop(const uint64_t *BVXI_RESTRICT from, const bvxi_row_ends *ends,
                                        uint64_t around, uint64_t *BVXI_RESTRICT out, size_t words)
{
    for (size_t k = 0; k < words; k++) out[k] = bvxi_with_sides(from + k, ends, k, around);
}

BVXI_VECTOR_INLINE void join_words_loop(uint64_t *BVXI_RESTRICT out, const uint64_t *BVXI_RESTRICT a,
                                        const uint64_t *BVXI_RESTRICT b, size_t words)
{
    for (size_t k = 0; k < words; k++) out[k] |= a[k] | b[k];
}

BVXI_AVX2_COPY(grow_slice_avx2,
               (const uint64_t *from, const bvxi_row_ends *ends, uint64_t around, uint64_t *out,
                size_t words),
               grow_slice_loop(from, ends, around, out, words))
BVXI_AVX2_COPY(join_words_avx2, (uint64_t * out, const uint64_t *a, const uint64_t *b, size_t words),
               join_words_loop(out, a, b, words))

static void join_two(const runs_job *job, uint64_t *out, const uint64_t *a, const uint64_t *b, size_t words)
{
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, join_words_loop(out, a, b, words), join_words_avx2(out, a, b, words));
}

/* The slice grown by w voxels, row 0; there are rows before and behind it. */
static uint64_t *grown_slice(const runs_job *job, uint64_t *scratch, int32_t w)
{
    return scratch + RUNS_CHUNK + (size_t)w * job->room +
           (size_t)job->reach[1] * (size_t)job->from.row_words + 1;
}

/* Slice z joined to those from begin on before end that the ball reaches. */
static void spread_slice(const runs_job *job, uint64_t *scratch, int32_t z, int32_t begin, int32_t end)
{
    size_t const words = (size_t)job->from.row_words;
    uint64_t *const joined = scratch;

    /* Each width from the one before it, by one voxel; all runs of the ball then lie ready. */
    const uint64_t *const read = job->from.words + (size_t)z * job->slice;
    uint64_t *const slice = grown_slice(job, scratch, 0);
    /* Erosion is dilation of the complement: bits are turned once, when they are read. */
    for (size_t k = 0; k < job->slice; k++) slice[k] = read[k] ^ job->flip;
    /* What lies beyond a row's end comes in with the bits there. */
    for (size_t k = words - 1; k < job->slice; k += words)
        slice[k] = (slice[k] & job->tail) | (job->around & ~job->tail);
    for (int32_t w = 1; w <= job->reach[0]; w++) {
        const uint64_t *const from = grown_slice(job, scratch, w - 1);
        uint64_t *const out = grown_slice(job, scratch, w);
        BVXI_PATH(job->cpu == BVX_CPU_AVX2, grow_slice_loop(from, &job->ends, job->around, out, job->slice),
                  grow_slice_avx2(from, &job->ends, job->around, out, job->slice));
    }
    for (int32_t dz = 0; dz <= job->reach[2]; dz++) {
        const int32_t *const half = job->half + dz * (job->reach[1] + 1);
        uint64_t *const low = z - dz >= begin && z - dz < end ? job->to.words + (size_t)(z - dz) * job->slice
                                                              : NULL;
        uint64_t *const high = dz > 0 && z + dz >= begin && z + dz < end
                                   ? job->to.words + (size_t)(z + dz) * job->slice
                                   : NULL;
        if ((low == NULL && high == NULL) || half[0] < 0) continue;
        /* By chunks, so that what is joined stays near between one row and the next. */
        for (size_t at = 0; at < job->slice; at += RUNS_CHUNK) {
            size_t const n = job->slice - at < RUNS_CHUNK ? job->slice - at : RUNS_CHUNK;
            memcpy(joined, grown_slice(job, scratch, half[0]) + at, n * 8);
            for (int32_t dy = 1; dy <= job->reach[1] && half[dy] >= 0; dy++) {
                const uint64_t *const rows = grown_slice(job, scratch, half[dy]) + at;
                join_two(job, joined, rows - (size_t)dy * words, rows + (size_t)dy * words, n);
            }
            if (low != NULL) join_two(job, low + at, joined, joined, n);
            if (high != NULL) join_two(job, high + at, joined, joined, n);
        }
    }
}

static void run_runs_piece(void *user, int32_t index, int32_t worker)
{
    const runs_job *const job = user;
    uint64_t *const scratch = (uint64_t *)(void *)(job->scratch + (size_t)worker * (size_t)job->scratch_size);
    int32_t const nz = job->from.size[2], rz = job->reach[2];
    size_t const words = (size_t)job->from.row_words;
    uint64_t first, last;

    /* Slices beyond this piece are read for those in it, and written by their own piece. */
    bvxi_piece((uint64_t)nz, job->pieces, index, &first, &last);
    int32_t const begin = (int32_t)first, end = (int32_t)last;
    /* Slices are joined as they come: how many steps they come in shows in no bit. */
    bvxi_piece((uint64_t)(end - begin) + 2 * (uint64_t)rz, job->steps, job->step, &first, &last);
    /* Rows before the first and after the last one count as what lies beyond. */
    memset(scratch + RUNS_CHUNK, job->around != 0 ? 0xff : 0, ((size_t)job->reach[0] + 1) * job->room * 8);
    /* Slices beyond the box reach those near its sides. */
    for (int32_t z = begin; z < end && job->step == 0; z++)
        memset(job->to.words + (size_t)z * job->slice,
               job->around != 0 && (z < rz || nz - z <= rz) ? 0xff : 0, job->slice * 8);
    for (int32_t z = begin - rz + (int32_t)first; z < begin - rz + (int32_t)last; z++)
        if (z >= 0 && z < nz) spread_slice(job, scratch, z, begin, end);
    if (job->step + 1 < job->steps) return;
    /* Turned back, and cut to the row's end. */
    for (int32_t z = begin; z < end; z++) {
        uint64_t *const out = job->to.words + (size_t)z * job->slice;
        for (size_t k = 0; k < job->slice; k++) out[k] ^= job->flip;
        for (size_t k = words - 1; k < job->slice; k += words) out[k] &= job->tail;
    }
}

/* All pieces, step by step: large balls have few pieces, each of which may take long. */
static bvx_status run_steps(bvx_context *ctx, const char *stage, double from, double to, runs_job *job)
{
    double const joins = 3.2 * (double)(job->reach[1] + 1) * (double)(job->reach[2] + 1) + job->reach[0];
    double const slices = (double)job->from.size[2] / (double)job->pieces + 2.0 * (double)job->reach[2];
    double const piece = RUNS_WORD_TIME * joins * (double)job->slice * slices;
    /* A step is what is done between two reports. */
    job->steps = 1 + (int32_t)(piece / RUNS_STEP_TIME < slices ? piece / RUNS_STEP_TIME : slices);
    for (job->step = 0; job->step < job->steps; job->step++) {
        double const low = from + (to - from) * ((double)job->step / (double)job->steps);
        double const high = from + (to - from) * ((double)(job->step + 1) / (double)job->steps);
        BVXI_TRY(bvxi_parallel_long(ctx, stage, low, high, job->pieces, piece / (double)job->steps,
                                    run_runs_piece, job));
    }
    return BVX_OK;
}

bvx_status bvxi_morph_runs(bvx_context *ctx, const bvxi_morph *morph, int32_t operation, double from,
                           double to, const bvxi_bit_box *source, const bvxi_bit_box *target)
{
    int ok = 1;

    runs_job job = {.from = *source,
                    .to = *target,
                    .cpu = bvxi_cpu(ctx),
                    .tail = bvxi_tail_mask(source->size[0]),
                    .flip = operation == BVXI_ERODE ? ~UINT64_C(0) : 0,
                    .around = (morph->beyond != 0) != (operation == BVXI_ERODE) ? ~UINT64_C(0) : 0};

    /* How far the ball reaches decides how much each worker holds. */
    for (int a = 0; a < 3; a++) job.reach[a] = ball_extent(morph, a);
    job.slice = (size_t)source->row_words * (size_t)source->size[1];
    job.room = job.slice + 2 * (size_t)job.reach[1] * (size_t)source->row_words + 2;
    job.scratch_size = (bvxi_mul(bvxi_mul((uint64_t)job.room, (uint64_t)job.reach[0] + 1, &ok), 8, &ok) +
                        RUNS_CHUNK * 8 + 63) /
                       64 * 64;
    uint64_t const bytes = bvxi_mul(job.scratch_size, (uint64_t)bvxi_threads(ctx), &ok);
    /* Sizes by the ball and the window may pass what addresses can name. */
    if (!ok || bytes > SIZE_MAX)
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: grown slices are beyond this machine's addresses",
                         morph->stage);
    job.half_bytes = ((uint64_t)job.reach[1] + 1) * ((uint64_t)job.reach[2] + 1) * sizeof *job.half;
    job.pieces = bvxi_piece_count(bvxi_box_words(source), RUNS_GRAIN);
    int32_t const most = source->size[2] / (4 * job.reach[2] + 1); /* what pieces do twice stays small */
    if (job.pieces > most) job.pieces = most < 1 ? 1 : most;
    BVXI_TRY(bvxi_row_ends_open(ctx, source, &job.ends));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.half_bytes, "the ball's runs", &job.half));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "grown slices", &job.scratch));
    for (int32_t dz = 0; dz <= job.reach[2]; dz++) {
        /* The ball narrows with dy, so each run begins from the one before. */
        int32_t k = job.reach[0];
        for (int32_t dy = 0; dy <= job.reach[1]; dy++) {
            while (k >= 0 && !in_ball(morph, k, dy, dz)) k--;
            job.half[dz * (job.reach[1] + 1) + dy] = k;
        }
    }
    return run_steps(ctx, morph->stage, from, to, &job);
}
