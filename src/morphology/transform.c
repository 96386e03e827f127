/* transform.c - the distance transform of a box of bits: along x from the bits, along y slice by slice, along
 * z row by row.
 *
 * Source: Saito, Toriwaki. New Algorithms for Euclidean Distance Transformation of an n-Dimensional Digitized
 * Picture. 1994 (one axis after the other); the columns are those of transform_lines.c.
 *
 * Of the whole box only the bits are held. A tile is 16 columns, or a few times 16, over all y and z: for
 * each of its slices the steps along x are made from bits, then its columns along y; these squares are kept
 * for the tile, and columns along z take them from there to the sink. Rows and slices without a target are
 * left out, for all columns of a group alike. */
#include "morphology/transform.h"

#include <math.h>

enum { TRANSFORM_GRAIN = 1 << 15 /* voxels of the smallest task */ };

/* What a worker needs. */
typedef struct transform_scratch {
    void *in, *out; /* columns: one group; all groups */
    int32_t *from, *x_places, *places, *site;
    uint64_t *nearest; /* all groups */
    double *height, *start;
} transform_scratch;

typedef struct transform_job {
    const bvxi_transform *t;
    bvxi_row_distances table;
    bvxi_row_carry *carry;  /* of each row */
    void *tile;             /* squares [group][z][y][16], each slice of slice_rows rows */
    uint64_t *tile_nearest; /* x + nx * y of their targets */
    uint8_t *has;           /* [group][z]: the slice has a target */
    double *inverse;
    unsigned char *scratch;
    uint64_t scratch_size, tile_bytes, has_bytes, inverse_bytes, carry_bytes, tile_nearest_bytes, all_scratch;
    size_t cell, slice_rows;
    int32_t longest, x, groups, pieces, reach, workers;
} transform_job;

int bvxi_transform_fits_whole(const int32_t size[3])
{
    double sum = 0.0;
    /* Sums of three squares must stay below what stands for no target. */
    for (int a = 0; a < 3; a++) sum += (double)(size[a] - 1) * (double)(size[a] - 1);
    return sum < 4294900000.0;
}

/* The parts of a worker's block: doubles and long ones first. */
static transform_scratch scratch_of(const transform_job *job, int32_t worker)
{
    size_t const n = (size_t)job->longest, lanes = n * BVXI_LANES, groups = (size_t)job->t->groups;
    unsigned char *p = job->scratch + (size_t)worker * (size_t)job->scratch_size;
    transform_scratch s = {NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL, NULL};

    /* In the order of alignment; numbers of 32 bits come last. */
    s.in = p;
    p += lanes * job->cell;
    s.out = p;
    p += lanes * job->cell * groups;
    s.height = (double *)(void *)p;
    s.start = s.height + n;
    p += n * 16;
    if (job->t->nearest) {
        s.nearest = (uint64_t *)(void *)p;
        p += lanes * 8 * groups;
        s.from = (int32_t *)(void *)p;
        s.x_places = s.from + lanes;
        p += lanes * 8;
    }
    s.places = (int32_t *)(void *)p;
    s.site = s.places + n;
    return s;
}

static bvxi_columns columns_of(const transform_job *job, const transform_scratch *s, int axis)
{
    bvxi_columns c = {NULL, NULL, NULL, NULL, 0, 0, 0, 0.0, NULL, NULL, NULL, NULL};
    c.from = s->from;
    c.places = s->places;
    c.n = job->t->box.size[axis];
    c.cpu = bvxi_cpu(job->t->ctx);
    c.weight = job->t->weight[axis];
    c.inverse = job->inverse;
    c.height = s->height;
    c.start = s->start;
    c.site = s->site;
    return c;
}

static void run_columns(const transform_job *job, const bvxi_columns *c)
{
    if (job->t->whole) bvxi_whole_columns(c);
    else bvxi_real_columns(c);
}

/* Squares along x of the 16 columns from x on, into s->in; which rows have
 * any goes to s->places. Returns how many. */
static int32_t make_rows(const transform_job *job, const transform_scratch *s, int32_t x, int32_t z)
{
    const bvxi_bit_box *const box = &job->t->box;
    uint64_t const flip = job->t->flip ? ~UINT64_C(0) : 0;
    int32_t count = 0;

    /* The carry of a row goes from tile to tile, so each of its words is looked at few times. */
    for (int32_t y = 0; y < box->size[1]; y++) {
        size_t const number = (size_t)z * (size_t)box->size[1] + (size_t)y;
        bvxi_target_row const row = {box->words + number * (size_t)box->row_words, box->size[0], flip};
        bvxi_row_carry *const carry = &job->carry[number];
        int32_t steps[BVXI_LANES];
        if (x == 0) bvxi_row_carry_start(carry, &row);
        else bvxi_row_carry_next(carry, &row, x);
        if (!bvxi_row_steps(&job->table, carry, &row, x, job->reach, steps,
                            s->x_places != NULL ? s->x_places + (size_t)y * BVXI_LANES : NULL))
            continue;
        void *const line = (unsigned char *)s->in + (size_t)y * BVXI_LANES * job->cell;
        if (job->t->whole) {
            uint32_t *const out = line;
            /* Steps up to 2^16 by the check above: squares fit 32 bits. */
            for (int i = 0; i < BVXI_LANES; i++) out[i] = (uint32_t)steps[i] * (uint32_t)steps[i];
        } else {
            double *const out = line;
            double const w = job->t->weight[0];
            for (int i = 0; i < BVXI_LANES; i++) out[i] = w * ((double)steps[i] * (double)steps[i]);
        }

        s->places[count++] = y;
    }
    return count;
}

static void run_slice(const transform_job *job, const transform_scratch *s, int32_t group, int32_t z)
{
    const int32_t *const size = job->t->box.size;
    size_t const slice = (size_t)group * (size_t)size[2] + (size_t)z;
    size_t const first = slice * job->slice_rows * BVXI_LANES;
    bvxi_columns c = columns_of(job, s, 1);

    /* Along x first, into the worker's lines; then along y, into the tile. */
    c.place_count = make_rows(job, s, job->x + group * BVXI_LANES, z);
    job->has[slice] = c.place_count != 0;
    /* A slice without a target is left out along z too. */
    if (c.place_count == 0) return;
    c.in = s->in;
    c.out = (unsigned char *)job->tile + first * job->cell;
    run_columns(job, &c);
    /* A target's place along x comes from the row that its place along y names. */
    for (int32_t y = 0; y < size[1] && job->t->nearest; y++)
        for (int32_t i = 0; i < BVXI_LANES; i++) {
            size_t const at = (size_t)y * BVXI_LANES + (size_t)i;
            int32_t const from = s->from[at];
            job->tile_nearest[first + at] = (uint64_t)from * (uint64_t)size[0] +
                                            (uint64_t)s->x_places[(size_t)from * BVXI_LANES + (size_t)i];
        }
}

static void run_slices(void *user, int32_t index, int32_t worker)
{
    const transform_job *const job = user;
    transform_scratch const s = scratch_of(job, worker);
    uint64_t begin, end;
    bvxi_piece((uint64_t)job->t->box.size[2], job->pieces, index, &begin, &end);
    for (uint64_t z = begin; z < end; z++)
        for (int32_t g = 0; g < job->groups; g++) run_slice(job, &s, g, (int32_t)z);
}

/* The nearest place beyond the box lies straight along an axis. */
static int32_t steps_out(int32_t i, int32_t n)
{
    return i + 1 < n - i ? i + 1 : n - i;
}

static void lessen_by_beyond(const transform_job *job, int32_t x, int32_t y, int32_t z, void *squares,
                             uint64_t *nearest)
{
    const bvxi_transform *const t = job->t;
    double const ky = (double)steps_out(y, t->box.size[1]), kz = (double)steps_out(z, t->box.size[2]);
    double const cy = t->weight[1] * (ky * ky), cz = t->weight[2] * (kz * kz), most = cy < cz ? cy : cz;
    uint32_t *const whole = squares;
    double *const real = squares;

    /* What lies beyond counts as a target, nearest straight out of the window along one axis. */
    for (int32_t i = 0; i < BVXI_LANES && x + i < t->box.size[0]; i++) {
        double const kx = (double)steps_out(x + i, t->box.size[0]);
        double const cx = t->weight[0] * (kx * kx);
        double const cap = cx < most ? cx : most;
        int const less = t->whole ? cap < (double)whole[i] : cap < real[i];
        if (!less) continue;
        if (t->whole) whole[i] = (uint32_t)cap;
        else real[i] = cap;
        if (nearest != NULL) nearest[i] = UINT64_MAX;
    }
}

static void run_group_of_row(const transform_job *job, const transform_scratch *s, int32_t group, int32_t y)
{
    size_t const nz = (size_t)job->t->box.size[2];
    size_t const line = BVXI_LANES * job->cell;
    size_t const room = (size_t)job->longest * BVXI_LANES;
    unsigned char *const out = (unsigned char *)s->out + (size_t)group * room * job->cell;
    uint64_t *const nearest = s->nearest != NULL ? s->nearest + (size_t)group * room : NULL;
    bvxi_columns c = columns_of(job, s, 2);

    /* Columns along z lie apart in the tile; they are gathered line by line. */
    for (size_t z = 0; z < nz; z++) {
        size_t const slice = (size_t)group * nz + z;
        if (!job->has[slice]) continue;
        memcpy((unsigned char *)s->in + z * line,
               (unsigned char *)job->tile + (slice * job->slice_rows + (size_t)y) * line, line);
        s->places[c.place_count++] = (int32_t)z;
    }
    if (c.place_count == 0) {
        size_t const count = (size_t)job->t->box.size[2] * BVXI_LANES;
        for (size_t i = 0; i < count; i++) {
            if (job->t->whole) ((uint32_t *)out)[i] = BVXI_FAR;
            else ((double *)out)[i] = (double)INFINITY;
        }
        for (size_t i = 0; i < count && nearest != NULL; i++) nearest[i] = UINT64_MAX;
        return;
    }
    c.in = s->in;
    c.out = out;
    run_columns(job, &c);
    /* Targets of all columns as linear indices. */
    const int32_t *const size = job->t->box.size;
    for (size_t i = 0; i < nz * BVXI_LANES && nearest != NULL; i++) {
        size_t const from = (size_t)s->from[i];
        /* Its slice along z, then what that slice's columns kept. */
        size_t const kept = ((size_t)group * nz + from) * job->slice_rows + (size_t)y;
        nearest[i] = job->tile_nearest[kept * BVXI_LANES + i % BVXI_LANES] +
                     from * (uint64_t)size[0] * (uint64_t)size[1];
    }
}

static void run_rows(void *user, int32_t index, int32_t worker)
{
    const transform_job *const job = user;
    transform_scratch const s = scratch_of(job, worker);
    uint64_t begin, end;
    bvxi_piece((uint64_t)job->t->box.size[1], job->pieces, index, &begin, &end);
    const bvxi_transform *const t = job->t;
    for (int32_t y = (int32_t)begin; y < (int32_t)end; y++) {
        for (int32_t g = 0; g < job->groups; g++) run_group_of_row(job, &s, g, y);
        for (int32_t z = 0; z < t->box.size[2]; z++)
            for (int32_t g = 0; g < job->groups; g++) {
                size_t const at = ((size_t)g * (size_t)job->longest + (size_t)z) * BVXI_LANES;
                int32_t const x = job->x + g * BVXI_LANES, left = t->box.size[0] - x;
                void *const squares = (unsigned char *)s.out + at * job->cell;
                uint64_t *const nearest = s.nearest != NULL ? s.nearest + at : NULL;
                if (t->beyond) lessen_by_beyond(job, x, y, z, squares, nearest);
                t->sink(t->user, x, y, z, left < BVXI_LANES ? left : BVXI_LANES, squares, nearest);
            }
    }
}

static bvx_status run_tiles(transform_job *job)
{
    const bvxi_transform *const t = job->t;
    double const share = (t->to - t->from) / (double)t->box.size[0];
    double const reach = sqrt(t->limit / t->weight[0]);
    uint64_t const slice = (uint64_t)t->box.size[1] * (uint64_t)t->box.size[2];
    int32_t const width = BVXI_LANES * t->groups;

    /* Within whole numbers: more than any window is wide. */
    job->reach = reach < 134217728.0 ? (int32_t)reach + 1 : 134217728;
    bvxi_row_distances_start(&job->table);
    /* Half of an inverse: quotients of the envelope are taken by products. */
    for (int32_t i = 1; i < job->longest; i++) job->inverse[i] = 0.5 / (double)i;
    job->inverse[0] = 0.0;
    /* Tiles in their order, since the rows' carries go from one to the next. */
    for (int32_t x = 0; x < t->box.size[0]; x += width) {
        int32_t const left = t->box.size[0] - x, groups = (left + BVXI_LANES - 1) / BVXI_LANES;
        job->x = x;
        job->groups = groups < t->groups ? groups : t->groups;
        double const from = t->from + share * (double)x;
        double const to = t->from + share * (double)(left < width ? t->box.size[0] : x + width);
        int32_t const pieces = bvxi_piece_count(slice * BVXI_LANES * (uint64_t)job->groups, TRANSFORM_GRAIN);
        /* Along x and y slices are shared, along z rows: each step waits for the one before. */
        job->pieces = pieces < t->box.size[2] ? pieces : t->box.size[2];
        BVXI_TRY(bvxi_parallel(t->ctx, t->stage, from, (from + to) * 0.5, job->pieces, run_slices, job));
        job->pieces = pieces < t->box.size[1] ? pieces : t->box.size[1];
        BVXI_TRY(bvxi_parallel(t->ctx, t->stage, (from + to) * 0.5, to, job->pieces, run_rows, job));
    }
    return BVX_OK;
}

bvx_status bvxi_transform_run(const bvxi_transform *t)
{
    uint64_t const mark = bvxi_scratch_begin(t->ctx);
    transform_job job = {0};
    job.t = t;
    bvx_context *const ctx = t->ctx;
    uint64_t const ny = (uint64_t)t->box.size[1], nz = (uint64_t)t->box.size[2];

    /* Sizes of the whole job; each product is watched, as windows may be large. */
    int ok = 1;

    job.cell = t->whole ? sizeof(uint32_t) : sizeof(double);
    job.longest = t->box.size[1] > t->box.size[2] ? t->box.size[1] : t->box.size[2];
    job.slice_rows = (size_t)ny | 1; /* slices an odd number of lines apart do not share cache sets */
    uint64_t const lines = bvxi_mul(bvxi_mul((uint64_t)job.slice_rows, nz, &ok),
                                    (uint64_t)t->groups * BVXI_LANES, &ok);
    job.tile_bytes = bvxi_mul(lines, job.cell, &ok);
    job.tile_nearest_bytes = t->nearest ? bvxi_mul(lines, 8, &ok) : 0;
    job.carry_bytes = bvxi_mul(ny * nz, sizeof(bvxi_row_carry), &ok);
    job.has_bytes = (uint64_t)t->groups * nz;
    job.inverse_bytes = (uint64_t)job.longest * sizeof(double);
    uint64_t const lanes = (uint64_t)job.longest * BVXI_LANES, groups = (uint64_t)t->groups;
    /* Columns in and out for all groups, then what the envelope needs. */
    uint64_t bytes = lanes * job.cell * (1 + groups) + (uint64_t)job.longest * 24;
    if (t->nearest) bytes += lanes * 8 * groups + lanes * 8;
    job.scratch_size = (bytes + 63) / 64 * 64 + 64;
    job.workers = bvxi_threads(ctx);
    job.all_scratch = bvxi_mul(job.scratch_size, (uint64_t)job.workers, &ok);
    /* Nothing was taken yet: a tile that no memory could hold is reported as that. */
    if (!ok || job.tile_bytes > SIZE_MAX || job.tile_nearest_bytes > SIZE_MAX || job.all_scratch > SIZE_MAX)
        return bvxi_fail(ctx, BVX_ERR_BUDGET,
                         "%s: a tile of the distances is beyond this machine's addresses", t->stage);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.tile_bytes, "a tile of distances", &job.tile));
    if (t->nearest)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.tile_nearest_bytes, "a tile of nearest voxels",
                            &job.tile_nearest));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.carry_bytes, "the rows' nearest voxels", &job.carry));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.has_bytes, "the slices' marks", &job.has));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.inverse_bytes, "a table of inverses", &job.inverse));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job.all_scratch, "the workers' columns", &job.scratch));
    return bvxi_scratch_end(ctx, mark, run_tiles(&job));
}
