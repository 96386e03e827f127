/* morph_steps.c - dilation and erosion by 6, 18 or 26 neighbours, 64 voxels at a time, many steps in one
 * sweep over the slices.
 *
 * Source: Serra. Image Analysis and Mathematical Morphology. 1982. Guarantee: exact, whatever the threads. */
#include "morphology/morph.h"

/* ---- Masks that keep the bits of one row of a slice out of the next ---- */

bvx_status bvxi_row_ends_open(bvx_context *ctx, const bvxi_bit_box *box, bvxi_row_ends *ends)
{
    size_t const words = (size_t)box->row_words, slice = words * (size_t)box->size[1];
    /* A word for each of the slice: one long loop without a test for row ends. */
    ends->bytes = (uint64_t)slice * 16; /* no more than two slices of a grid that is there */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, ends->bytes, "masks of a slice", &ends->before));
    ends->behind = ends->before + slice;
    for (size_t k = 0; k < slice; k++) {
        ends->before[k] = k % words == 0 ? 0 : 1;
        ends->behind[k] = k % words == words - 1 ? 0 : BVXI_TOP_BIT;
    }
    return BVX_OK;
}

/* ---- Dilation and erosion by 6, 18 or 26 neighbours, 64 voxels at a time, many steps in one sweep ---- */

/* A word's neighbours along x are itself shifted by one and a bit of the words beside it; those along y and z
 * are whole words of other rows. Rows lie one after the other, so a slice is one long loop; masks keep bits
 * from one row out of the next. Erosion is dilation of the complement, so words are kept complemented where
 * the next step erodes. What lies beyond the box is carried in bits past a row's end, comes in where the
 * masks hold, and stands in slices of its own.
 *
 * A sweep does up to SWEEP_STEPS steps while the slices are near: step s of slice z needs step s - 1 of
 * slices z - 1 .. z + 1, so three slices a step are kept in a ring, and one slice that is read lets each step
 * go one slice on. A piece of slices begins as many slices earlier as there are steps, and so needs nothing
 * of its neighbours. Any order of pieces gives the same bits. */

enum { SWEEP_STEPS = 16, SWEEP_RING_BYTES = 1 << 20, SWEEP_GRAIN = 1 << 12 /* words of the smallest task */ };

typedef struct sweep_job {
    bvxi_bit_box from, to;
    bvxi_row_ends ends;
    unsigned char *scratch;
    uint64_t *outside;     /* a slice of zeros, and one of ones */
    uint64_t scratch_size; /* of a worker [Units: bytes] */
    uint64_t tail;
    uint64_t flip[SWEEP_STEPS + 1];   /* what step s is xored with when it is kept (0: when it is read) */
    uint64_t around[SWEEP_STEPS + 1]; /* what lies beyond the box, as step s is kept */
    size_t slice;                     /* words */
    int32_t steps, neighbourhood, pieces, cpu;
} sweep_job;

/* Words of nine rows, or stretches of rows, around one. */
typedef struct step_rows {
    const uint64_t *row[3][3]; /* by z and y */
    uint64_t *joined;          /* room for them, with a word on each side */
    uint64_t around, flip;
} step_rows;

BVXI_VECTOR_INLINE void step_cross(const step_rows *r, const bvxi_row_ends *ends, uint64_t *BVXI_RESTRICT out,
                                   size_t words)
{
    const uint64_t *const c = r->row[1][1];
    const uint64_t *const a = r->row[1][0];
    const uint64_t *const b = r->row[1][2];
    const uint64_t *const d = r->row[0][1];
    const uint64_t *const e = r->row[2][1];
    uint64_t const around = r->around, flip = r->flip;
    for (size_t k = 0; k < words; k++)
        out[k] = (bvxi_with_sides(c + k, ends, k, around) | a[k] | b[k] | d[k] | e[k]) ^ flip;
}

BVXI_VECTOR_INLINE void step_wide(const step_rows *r, const bvxi_row_ends *ends, int corners,
                                  uint64_t *BVXI_RESTRICT out, size_t words)
{
    const uint64_t *const c = r->row[1][1];
    const uint64_t *const a = r->row[1][0];
    const uint64_t *const b = r->row[1][2];
    const uint64_t *const d = r->row[0][1];
    const uint64_t *const e = r->row[2][1];
    const uint64_t *const f = r->row[0][0];
    const uint64_t *const g = r->row[0][2];
    const uint64_t *const h = r->row[2][0];
    const uint64_t *const i = r->row[2][2];

    uint64_t *BVXI_RESTRICT const joined = r->joined;
    uint64_t const around = r->around, flip = r->flip;
    /* What differs in y and z is joined first, so that one shift along x serves it all. */
    for (size_t k = 0; k < words; k++) {
        uint64_t const cross = c[k] | a[k] | b[k] | d[k] | e[k];
        joined[k] = corners ? cross | f[k] | g[k] | h[k] | i[k] : cross;
    }
    /* With 18 neighbours corners are left out: what differs in y and z comes in unshifted. */
    for (size_t k = 0; k < words; k++) {
        uint64_t const w = bvxi_with_sides(joined + k, ends, k, around);
        out[k] = (corners ? w : w | f[k] | g[k] | h[k] | i[k]) ^ flip;
    }
}

BVXI_VECTOR_INLINE void step_stretch(const sweep_job *job, const step_rows *r, uint64_t *out, size_t words)
{
    if (job->neighbourhood == 6) step_cross(r, &job->ends, out, words);
    else if (job->neighbourhood == 18) step_wide(r, &job->ends, 0, out, words);
    else step_wide(r, &job->ends, 1, out, words);
}

BVXI_AVX2_COPY(step_stretch_avx2, (const sweep_job *job, const step_rows *r, uint64_t *out, size_t words),
               step_stretch(job, r, out, words))

/* What a slice of a step is made from: three slices of the step before, rows beyond, work space. */
typedef struct step_slice {
    const uint64_t *slice[3], *outside;
    uint64_t *room, around, flip;
} step_slice;

/* Rows y .. y + count - 1 of a slice. A first or last row has its middle copied, for words beside it. */
static void step_rows_from(const sweep_job *job, const step_slice *s, int32_t y, int32_t count, uint64_t *out)
{
    size_t const words = (size_t)job->from.row_words;
    int32_t const ny = job->from.size[1];
    step_rows r;

    /* Nine rows, of which those beyond the window are read from a slice made for it. */
    r.joined = s->room + 1;
    r.around = s->around;
    r.flip = s->flip;
    for (int32_t i = 0; i < 3; i++)
        for (int32_t j = 0; j < 3; j++) {
            int32_t const at = y + j - 1;
            r.row[i][j] = at >= 0 && at < ny ? s->slice[i] + (size_t)at * words : s->outside;
        }
    /* Words beside the middle row are looked at, which a window's first and last row do not have. */
    if (job->neighbourhood == 6 && (y == 0 || y + count == ny)) {
        memcpy(s->room + 1, r.row[1][1], words * 8);
        r.row[1][1] = s->room + 1;
    }
    uint64_t *const to = out + (size_t)y * words;
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, step_stretch(job, &r, to, (size_t)count * words),
              step_stretch_avx2(job, &r, to, (size_t)count * words));
}

static void set_row_tails(const sweep_job *job, uint64_t *slice, uint64_t around)
{
    size_t const words = (size_t)job->from.row_words;
    uint64_t const tail = job->tail, past = around & ~tail;
    /* Rows that fill their last word have no bits past their end. */
    if (tail == ~UINT64_C(0)) return;
    for (size_t k = words - 1; k < job->slice; k += words) slice[k] = (slice[k] & tail) | past;
}

static uint64_t *kept_slice(const sweep_job *job, uint64_t *ring, int32_t step, int32_t z)
{
    return ring + ((size_t)step * 3 + (size_t)(z % 3)) * job->slice;
}

/* What is read can be looked at where it is. */
static int reads_in_place(const sweep_job *job)
{
    return job->flip[0] == 0 && (job->around[0] == 0 || job->tail == ~UINT64_C(0));
}

static const uint64_t *slice_of_step(const sweep_job *job, uint64_t *ring, int32_t step, int32_t z)
{
    /* Beyond the window stand zeros or ones, turned as this step keeps them. */
    if (z < 0 || z >= job->from.size[2]) return job->outside + (job->around[step] != 0 ? job->slice : 0);
    if (step == 0 && reads_in_place(job)) return job->from.words + (size_t)z * job->slice;
    return kept_slice(job, ring, step, z);
}

static void read_slice(const sweep_job *job, uint64_t *ring, int32_t z)
{
    const uint64_t *const from = job->from.words + (size_t)z * job->slice;
    uint64_t *BVXI_RESTRICT const slice = kept_slice(job, ring, 0, z);
    uint64_t const flip = job->flip[0];
    if (reads_in_place(job)) return;
    for (size_t k = 0; k < job->slice; k++) slice[k] = from[k] ^ flip;
    set_row_tails(job, slice, job->around[0]);
}

static void sweep_piece(void *user, int32_t index, int32_t worker)
{
    const sweep_job *const job = user;
    uint64_t *const ring = (uint64_t *)(void *)(job->scratch + (size_t)worker * (size_t)job->scratch_size);
    int32_t const nz = job->from.size[2], steps = job->steps;
    uint64_t begin, end;

    bvxi_piece((uint64_t)nz, job->pieces, index, &begin, &end);

    /* One slice is read, then each step goes on by one, a slice behind the one before it. */
    for (int32_t t = (int32_t)begin - steps; t < (int32_t)end + steps; t++) {
        if (t >= 0 && t < nz) read_slice(job, ring, t);
        for (int32_t s = 1; s <= steps; s++) {
            int32_t const z = t - s, more = steps - s;
            /* Beyond the piece only as far as later steps of its own slices reach. */
            if (z >= 0 && z < nz && z >= (int32_t)begin - more && z < (int32_t)end + more) {
                /* Slice z of a step from three of the one before. */
                uint64_t const around = job->around[s - 1];
                step_slice from = {.outside = job->outside + (around != 0 ? job->slice : 0),
                                   .room = ring + (size_t)job->steps * 3 * job->slice,
                                   .around = around,
                                   .flip = job->flip[s]};

                /* The last step goes to the result; the others into the ring. */
                int32_t const ny = job->from.size[1];
                int const last = s == job->steps;
                uint64_t *const out = last ? job->to.words + (size_t)z * job->slice
                                           : kept_slice(job, ring, s, z);

                for (int32_t i = 0; i < 3; i++) from.slice[i] = slice_of_step(job, ring, s - 1, z + i - 1);
                step_rows_from(job, &from, 0, 1, out);
                if (ny > 2) step_rows_from(job, &from, 1, ny - 2, out);
                if (ny > 1) step_rows_from(job, &from, ny - 1, 1, out);
                set_row_tails(job, out, last ? 0 : job->around[s]);
            }
        }
    }
}

static int32_t all_steps(const bvxi_morph *morph)
{
    return morph->steps * morph->operations;
}

static int32_t sweep_steps(const bvxi_morph *morph, const bvxi_bit_box *box)
{
    uint64_t const slice = (uint64_t)box->row_words * (uint64_t)box->size[1] * 8;
    /* As many steps as keep the ring within a core's cache. */
    uint64_t const fit = SWEEP_RING_BYTES / (3 * slice);
    int32_t const steps = fit < 1 ? 1 : fit > SWEEP_STEPS ? SWEEP_STEPS : (int32_t)fit;
    return steps < all_steps(morph) ? steps : all_steps(morph);
}

int32_t bvxi_step_sweeps(const bvxi_morph *morph, const bvxi_bit_box *box)
{
    int32_t const steps = sweep_steps(morph, box);
    return (all_steps(morph) + steps - 1) / steps;
}

/* 1 where step number i of all erodes; none does after the last. */
static int erodes_at(const bvxi_morph *morph, int32_t i)
{
    return i < all_steps(morph) && morph->operation[i / morph->steps] == BVXI_ERODE;
}

static void plan_sweep(const bvxi_morph *morph, int32_t first, int32_t steps, sweep_job *job)
{
    uint64_t const beyond = morph->beyond ? ~UINT64_C(0) : 0;
    job->steps = steps;
    for (int32_t s = 0; s <= steps; s++) {
        /* Turned only where the kind of step changes: words stay complemented while steps erode. */
        int const was = s > 0 && erodes_at(morph, first + s - 1);
        int const next = s < steps && erodes_at(morph, first + s);
        job->flip[s] = was != next ? ~UINT64_C(0) : 0;
        job->around[s] = next ? ~beyond : beyond;
    }
}

bvx_status bvxi_morph_steps(bvx_context *ctx, const bvxi_morph *morph, const bvxi_bit_box *source,
                            const bvxi_bit_box *first, const bvxi_bit_box *second)
{
    sweep_job job = {0};
    int ok = 1;

    /* Three slices a step and one for the sides, for each worker. */
    job.slice = (size_t)source->row_words * (size_t)source->size[1];
    job.scratch_size = (bvxi_mul((uint64_t)job.slice, 24 * (uint64_t)sweep_steps(morph, source) + 8, &ok) +
                        16 + 63) /
                       64 * 64;
    uint64_t const bytes = bvxi_mul(job.scratch_size, (uint64_t)bvxi_threads(ctx), &ok);
    uint64_t const outside_bytes = bvxi_mul((uint64_t)job.slice, 16, &ok);
    if (!ok || bytes > SIZE_MAX)
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: slices for the steps are beyond this machine's addresses",
                         morph->stage);
    BVXI_TRY(bvxi_row_ends_open(ctx, source, &job.ends));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, outside_bytes, "slices beyond the window", &job.outside));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "slices for the steps", &job.scratch));

    /* Rows and slices beyond are the same for all sweeps. */
    int32_t const each = sweep_steps(morph, source), total = all_steps(morph);

    job.from = *source;
    job.neighbourhood = morph->neighbourhood;
    job.cpu = bvxi_cpu(ctx);
    job.tail = bvxi_tail_mask(source->size[0]);
    memset(job.outside, 0, job.slice * 8);
    memset(job.outside + job.slice, 0xff, job.slice * 8);
    for (int32_t done = 0, sweep = 0; done < total; done += each, sweep++) {
        job.to = sweep % 2 == 0 ? *first : *second;
        plan_sweep(morph, done, each < total - done ? each : total - done, &job);
        int32_t const most = source->size[2] / (4 * job.steps); /* what pieces do twice stays small */
        job.pieces = bvxi_piece_count(bvxi_box_words(source) * (uint64_t)job.steps, SWEEP_GRAIN);
        if (job.pieces > most) job.pieces = most < 1 ? 1 : most;
        BVXI_TRY(bvxi_parallel(ctx, morph->stage, (double)done / total, (double)(done + job.steps) / total,
                               job.pieces, sweep_piece, &job));
        job.from = job.to;
    }
    return BVX_OK;
}
