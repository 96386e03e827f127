/* morph_steps.c - dilation and erosion by 6, 18 or 26 neighbours, 64 voxels at a time, many steps in one sweep.
 *
 * Source: Serra. Image Analysis and Mathematical Morphology. 1982.
 *
 * A word's neighbours along x are itself shifted by one and a bit of the words beside it; those along y and z are whole words of
 * other rows. Erosion is dilation of the complement, so words are kept complemented where the next step erodes. What lies beyond
 * the box is carried in bits past a row's end, in a word on each side of a row and in a row that stands for all rows outside.
 *
 * A sweep does up to SWEEP_STEPS steps while the slices are near: step s of slice z needs step s - 1 of slices z - 1 .. z + 1, so
 * three slices a step are kept in a ring, and one slice that is read lets each step go one slice on. A piece of slices begins as many
 * slices earlier as there are steps, and so needs nothing of its neighbours. Any order of pieces gives the same bits. */
#include "grid/morph.h"

enum { SWEEP_STEPS = 16, SWEEP_RING_BYTES = 1 << 20, SWEEP_GRAIN = 1 << 12 /* words of the smallest task */ };

typedef struct sweep_job {
    bvxi_bit_box from, to;
    unsigned char *scratch;
    uint64_t scratch_size;          /* of a worker [Units: bytes] */
    uint64_t tail;
    uint64_t flip[SWEEP_STEPS + 1]; /* what step s is xored with when it is kept (0: when it is read) */
    uint64_t around[SWEEP_STEPS + 1]; /* what lies beyond the box, as step s is kept */
    size_t row_room, slice_room;    /* words of a kept row, with one on each side, and of a slice */
    int32_t steps, neighbourhood, pieces, cpu;
} sweep_job;

/* ---- one row ---- */

/* Words of the nine rows around one; each has a word before its first and one behind its last. */
typedef struct step_rows {
    const uint64_t *row[3][3]; /* by z and y */
} step_rows;

BVXI_VECTOR_INLINE uint64_t with_sides(const uint64_t *w)
{
    return w[0] | w[0] << 1 | w[0] >> 1 | w[-1] >> 63 | w[1] << 63;
}

BVXI_VECTOR_INLINE void step_row_6(const step_rows *r, uint64_t *BVXI_RESTRICT out, ptrdiff_t words, uint64_t flip)
{
    const uint64_t *const c = r->row[1][1], *const a = r->row[1][0], *const b = r->row[1][2], *const d = r->row[0][1], *const e = r->row[2][1];
    for (ptrdiff_t k = 0; k < words; k++) out[k] = (with_sides(c + k) | a[k] | b[k] | d[k] | e[k]) ^ flip;
}

/* The middle rows of a cross, as a row of their own. */
BVXI_VECTOR_INLINE void join_cross(const step_rows *r, uint64_t *BVXI_RESTRICT joined, ptrdiff_t words)
{
    const uint64_t *const c = r->row[1][1], *const a = r->row[1][0], *const b = r->row[1][2], *const d = r->row[0][1], *const e = r->row[2][1];
    for (ptrdiff_t k = -1; k <= words; k++) joined[k] = c[k] | a[k] | b[k] | d[k] | e[k];
}

BVXI_VECTOR_INLINE void step_row_18(const step_rows *r, uint64_t *BVXI_RESTRICT joined, uint64_t *BVXI_RESTRICT out, ptrdiff_t words, uint64_t flip)
{
    const uint64_t *const a = r->row[0][0], *const b = r->row[0][2], *const d = r->row[2][0], *const e = r->row[2][2];
    join_cross(r, joined, words);
    for (ptrdiff_t k = 0; k < words; k++) out[k] = (with_sides(joined + k) | a[k] | b[k] | d[k] | e[k]) ^ flip;
}

BVXI_VECTOR_INLINE void step_row_26(const step_rows *r, uint64_t *BVXI_RESTRICT joined, uint64_t *BVXI_RESTRICT out, ptrdiff_t words, uint64_t flip)
{
    const uint64_t *const a = r->row[0][0], *const b = r->row[0][2], *const d = r->row[2][0], *const e = r->row[2][2];
    join_cross(r, joined, words);
    for (ptrdiff_t k = -1; k <= words; k++) joined[k] |= a[k] | b[k] | d[k] | e[k];
    for (ptrdiff_t k = 0; k < words; k++) out[k] = with_sides(joined + k) ^ flip;
}

/* ---- one slice ---- */

typedef struct step_slice {
    const uint64_t *slice[3]; /* word 0 of row 0 below, here and above; NULL: beyond the box */
    const uint64_t *outside;  /* a row that stands for all beyond the box */
    uint64_t *joined;         /* room for a row */
    uint64_t *out;
    size_t out_stride;
    uint64_t flip;
} step_slice;

BVXI_VECTOR_INLINE void step_whole_slice(const sweep_job *job, const step_slice *s)
{
    ptrdiff_t const words = job->from.row_words;
    for (int32_t y = 0; y < job->from.size[1]; y++) {
        uint64_t *const out = s->out + (size_t)y * s->out_stride;
        step_rows r;
        for (int32_t i = 0; i < 3; i++)
            for (int32_t j = 0; j < 3; j++) {
                int32_t const at = y + j - 1;
                r.row[i][j] = s->slice[i] != NULL && at >= 0 && at < job->from.size[1] ? s->slice[i] + (size_t)at * job->row_room : s->outside;
            }
        if (job->neighbourhood == 6) step_row_6(&r, out, words, s->flip);
        else if (job->neighbourhood == 18) step_row_18(&r, s->joined, out, words, s->flip);
        else step_row_26(&r, s->joined, out, words, s->flip);
    }
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static void step_whole_slice_avx2(const sweep_job *job, const step_slice *s)
{
    step_whole_slice(job, s);
}
#endif

static void take_step(const sweep_job *job, const step_slice *s)
{
#if BVXI_HAVE_AVX2
    if (job->cpu == BVX_CPU_AVX2) {
        step_whole_slice_avx2(job, s);
        return;
    }
#endif
    step_whole_slice(job, s);
}

/* What lies around a row that is kept. */
static inline void surround_row(const sweep_job *job, uint64_t *row, uint64_t around)
{
    int32_t const words = job->from.row_words;
    row[-1] = row[words] = around;
    row[words - 1] = (row[words - 1] & job->tail) | (around & ~job->tail);
}

/* ---- a piece of slices ---- */

static uint64_t *kept_slice(const sweep_job *job, uint64_t *ring, int32_t step, int32_t z)
{
    return ring + ((size_t)step * 3 + (size_t)(z % 3)) * job->slice_room + 1;
}

static void read_slice(const sweep_job *job, uint64_t *ring, int32_t z)
{
    size_t const words = (size_t)job->from.row_words;
    uint64_t *const slice = kept_slice(job, ring, 0, z);
    for (int32_t y = 0; y < job->from.size[1]; y++) {
        const uint64_t *const from = job->from.words + ((size_t)z * (size_t)job->from.size[1] + (size_t)y) * words;
        uint64_t *const row = slice + (size_t)y * job->row_room;
        for (size_t k = 0; k < words; k++) row[k] = from[k] ^ job->flip[0];
        surround_row(job, row, job->around[0]);
    }
}

/* Slice z of a step from three of the one before. */
static void make_slice(const sweep_job *job, uint64_t *ring, int32_t step, int32_t z)
{
    uint64_t *const rows = ring + (size_t)job->steps * 3 * job->slice_room; /* all zeros, all ones, room */
    int const last = step == job->steps;
    step_slice s;
    for (int32_t i = 0; i < 3; i++) {
        int32_t const at = z + i - 1;
        s.slice[i] = at >= 0 && at < job->from.size[2] ? kept_slice(job, ring, step - 1, at) : NULL;
    }
    s.outside = rows + 1 + (job->around[step - 1] != 0 ? job->row_room : 0);
    s.joined = rows + 2 * job->row_room + 1;
    s.flip = job->flip[step];
    s.out = last ? job->to.words + (size_t)z * (size_t)job->to.size[1] * (size_t)job->to.row_words : kept_slice(job, ring, step, z);
    s.out_stride = last ? (size_t)job->to.row_words : job->row_room;
    take_step(job, &s);
    for (int32_t y = 0; y < job->from.size[1]; y++) {
        uint64_t *const row = s.out + (size_t)y * s.out_stride;
        if (last) row[job->to.row_words - 1] &= job->tail;
        else surround_row(job, row, job->around[step]);
    }
}

static void sweep_piece(void *user, int32_t index, int32_t worker)
{
    const sweep_job *const job = user;
    uint64_t *const ring = (uint64_t *)(void *)(job->scratch + (size_t)worker * (size_t)job->scratch_size);
    uint64_t *const rows = ring + (size_t)job->steps * 3 * job->slice_room;
    int32_t const nz = job->from.size[2], steps = job->steps;
    uint64_t begin, end;
    bvxi_piece((uint64_t)nz, job->pieces, index, &begin, &end);
    memset(rows, 0, job->row_room * 8);
    memset(rows + job->row_room, 0xff, job->row_room * 8);
    for (int32_t t = (int32_t)begin - steps; t < (int32_t)end + steps; t++) {
        if (t >= 0 && t < nz) read_slice(job, ring, t);
        for (int32_t s = 1; s <= steps; s++) {
            int32_t const z = t - s, more = steps - s;
            if (z >= 0 && z < nz && z >= (int32_t)begin - more && z < (int32_t)end + more) make_slice(job, ring, s, z);
        }
    }
}

/* ---- sweeps ---- */

static int32_t all_steps(const bvxi_morph *morph)
{
    return morph->steps * morph->operations;
}

static int32_t sweep_steps(const bvxi_morph *morph, const bvxi_bit_box *box)
{
    uint64_t const slice = ((uint64_t)box->row_words + 2) * (uint64_t)box->size[1] * 8, fit = SWEEP_RING_BYTES / (3 * slice);
    int32_t const steps = fit < 1 ? 1 : fit > SWEEP_STEPS ? SWEEP_STEPS : (int32_t)fit;
    return steps < all_steps(morph) ? steps : all_steps(morph);
}

int32_t bvxi_step_sweeps(const bvxi_morph *morph, const bvxi_bit_box *box)
{
    int32_t const steps = sweep_steps(morph, box);
    return (all_steps(morph) + steps - 1) / steps;
}

/* 1 where step number i of all erodes; none does behind the last. */
static int erodes_at(const bvxi_morph *morph, int32_t i)
{
    return i < all_steps(morph) && morph->operation[i / morph->steps] == BVXI_ERODE;
}

static void plan_sweep(const bvxi_morph *morph, int32_t first, int32_t steps, sweep_job *job)
{
    uint64_t const beyond = morph->beyond ? ~UINT64_C(0) : 0;
    job->steps = steps;
    for (int32_t s = 0; s <= steps; s++) {
        int const was = s > 0 && erodes_at(morph, first + s - 1), next = s < steps && erodes_at(morph, first + s);
        job->flip[s] = was != next ? ~UINT64_C(0) : 0;
        job->around[s] = next ? ~beyond : beyond;
    }
}

static void count_pieces(const bvxi_bit_box *box, sweep_job *job)
{
    int32_t const most = box->size[2] / (4 * job->steps); /* what pieces do twice stays small */
    job->pieces = bvxi_piece_count(bvxi_box_words(box) * (uint64_t)job->steps, SWEEP_GRAIN);
    if (job->pieces > most) job->pieces = most < 1 ? 1 : most;
}

bvx_status bvxi_morph_steps(bvx_context *ctx, const bvxi_morph *morph, const bvxi_bit_box *source, const bvxi_bit_box *first,
                            const bvxi_bit_box *second)
{
    int32_t const each = sweep_steps(morph, source), total = all_steps(morph);
    bvx_status status = BVX_OK;
    sweep_job job = {0};
    uint64_t bytes;
    int ok = 1;
    job.from = *source;
    job.neighbourhood = morph->neighbourhood;
    job.cpu = bvxi_cpu(ctx);
    job.tail = bvxi_tail_mask(source->size[0]);
    job.row_room = (size_t)source->row_words + 2;
    job.slice_room = job.row_room * (size_t)source->size[1];
    job.scratch_size = (bvxi_mul(bvxi_mul((uint64_t)job.slice_room, 24, &ok), (uint64_t)each, &ok) + (uint64_t)job.row_room * 24 + 63) / 64 * 64;
    bytes = bvxi_mul(job.scratch_size, (uint64_t)bvxi_threads(ctx), &ok);
    if (!ok || bytes > SIZE_MAX)
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: slices for the steps are beyond this machine's addresses", morph->stage);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "slices for the steps", &job.scratch));
    for (int32_t done = 0, sweep = 0; done < total && status == BVX_OK; done += each, sweep++) {
        job.to = sweep % 2 == 0 ? *first : *second;
        plan_sweep(morph, done, each < total - done ? each : total - done, &job);
        count_pieces(source, &job);
        status = bvxi_parallel(ctx, morph->stage, (double)done / total, (double)(done + job.steps) / total, job.pieces, sweep_piece, &job);
        job.from = job.to;
    }
    bvxi_free(ctx, job.scratch, bytes);
    return status;
}
