/* snap.c - vertices to fixed point: q = floor((p - origin) * (2^F / spacing) + 1/2) in doubles, |q| < 2^30.
 *
 * Guarantee: depends on the vertex and the lattice only, so that shared edges stay shared and windows
 * agree. */
#include "solid/snap.h"

enum { SNAP_GRAIN = 8192, SNAP_BAD = INT32_MIN, SNAP_RUN = 64 };

typedef struct snap_job {
    const bvx_mesh_view *view;
    double origin[3], scale[3];
    bvxi_snapped *out;
    bvxi_row_block block;
    int32_t fraction_bits, pieces, cpu;
    int32_t swap;                  /* the coordinate that changes places with the first */
    uint8_t bad[BVXI_MOST_PIECES]; /* by piece */
} snap_job;

/* Packed floats, SNAP_RUN vertices at a time as one row of numbers: the same arithmetic, in vectors. 0 where
 * one does not fit; nothing is written then. */
BVXI_VECTOR_INLINE int snap_run(const unsigned char *BVXI_RESTRICT from, const double *BVXI_RESTRICT origin,
                                const double *BVXI_RESTRICT scale, int32_t *BVXI_RESTRICT q)
{
    double v[3 * SNAP_RUN];
    int64_t outside = 0;

    /* No branch in these loops, and no choice beside a cast: compilers make vectors of them so only. */
    for (int32_t i = 0; i < 3 * SNAP_RUN; i++) {
        float p;
        memcpy(&p, from + sizeof p * (size_t)i, sizeof p);
        v[i] = ((double)p - origin[i]) * scale[i];
        outside |= (v[i] < 0 ? -v[i] : v[i]) < BVXI_FIXED_LIMIT - 0.5 ? 0 : 1;
    }
    if (BVXI_UNLIKELY(outside != 0)) return 0;
    for (int32_t i = 0; i < 3 * SNAP_RUN; i++) {
        double const u = v[i] + 0.5, t = (double)(int32_t)u;
        /* The cast goes towards 0; below 0 that is one too high, but for whole numbers. */
        q[i] = (int32_t)(t - (u < t ? 1.0 : 0.0));
    }
    return 1;
}

BVXI_VECTOR_INLINE void snap_range(snap_job *job, int32_t index, uint64_t begin, uint64_t end)
{
    const bvx_mesh_view *const view = job->view;
    int fits = 1;
    uint64_t v = begin;

    if (bvxi_view_packed_f32(view)) {
        double origin[3 * SNAP_RUN], scale[3 * SNAP_RUN];
        for (int32_t i = 0; i < 3 * SNAP_RUN; i++) {
            origin[i] = job->origin[i % 3];
            scale[i] = job->scale[i % 3];
        }
        for (; end - v >= SNAP_RUN; v += SNAP_RUN) {
            /* the slow loop finds which */
            if (BVXI_UNLIKELY(
                    !snap_run(bvxi_view_position_at(view, v), origin, scale, job->out->xyz + 3 * v)))
                break;
        }
    }
    for (; v < end; v++) {
        int32_t *const q = job->out->xyz + 3 * v;
        double p[3];
        bvxi_view_position(view, v, p);
        /* Marked, not refused: no triangle may use it. */
        if (BVXI_UNLIKELY(!bvxi_snap_vertex(p, job->origin, job->scale, q))) {
            q[0] = SNAP_BAD;
            fits = 0;
        }
    }
    job->bad[index] = !fits;
}

BVXI_AVX2_COPY(snap_range_avx2, (snap_job * job, int32_t index, uint64_t begin, uint64_t end),
               snap_range(job, index, begin, end))

static void snap_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    snap_job *const job = user;
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, snap_range(job, index, begin, end),
              snap_range_avx2(job, index, begin, end));
}

/* Vertices that no triangle uses may be anything; the first used one that does not fit is named. */
static bvx_status snap_judge(bvx_context *ctx, const char *function, const snap_job *job,
                             const bvx_lattice *lattice)
{
    const bvx_mesh_view *const view = job->view;

    for (uint64_t t = 0; t < view->triangle_count; t++) {
        uint32_t corner[3];
        if (!bvxi_view_triangle(view, t, corner)) continue;
        for (int32_t i = 0; i < 3; i++) {
            double p[3];
            if (job->out->xyz[3 * (uint64_t)corner[i]] != SNAP_BAD) continue;
            bvxi_view_position(view, corner[i], p);
            /* Not finite is another fault than too far away. */
            for (int32_t a = 0; a < 3; a++)
                if (!(p[a] - p[a] == 0.0))
                    return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                         "%s: vertex %i (of triangle %u) has a coordinate that is not finite",
                                         function, (uint64_t)corner[i], t);
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                "%s: vertex %i at (%g, %g, %g) is more than 2^30 fixed-point steps from the lattice's "
                "origin; "
                "with %d fraction bits coordinates up to %g voxels away fit",
                function, (uint64_t)corner[i], p[0], p[1], p[2], (int64_t)lattice->fraction_bits,
                BVXI_FIXED_LIMIT / (double)(1 << lattice->fraction_bits));
        }
    }

    /* Unused ones become any place, so that later loops need no test. */
    for (uint64_t v = 0; v < view->vertex_count; v++)
        if (job->out->xyz[3 * v] == SNAP_BAD) job->out->xyz[3 * v] = 0;
    return BVX_OK;
}

void bvxi_snap_free(bvx_context *ctx, bvxi_snapped *s)
{
    bvxi_drop(ctx, s->cell);
    bvxi_drop(ctx, s->xyz);
    memset(s, 0, sizeof *s);
}

bvx_status bvxi_snap_scale(bvx_context *ctx, const char *function, const bvx_lattice *lattice,
                           double scale[3])
{
    for (int32_t a = 0; a < 3; a++) {
        scale[a] = (double)(1 << lattice->fraction_bits) / lattice->spacing[a];
        /* Less spacing than doubles can divide by. */
        if (!(scale[a] - scale[a] == 0.0))
            return bvxi_fail(ctx, BVX_ERR_RANGE,
                             "%s: the lattice's spacing of %g is too small to divide by; scale the "
                             "coordinates up",
                             function, lattice->spacing[a]);
    }
    return BVX_OK;
}

bvx_status bvxi_snap(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                     const bvx_lattice *lattice, bvxi_snapped *out)
{
    int any_bad = 0;

    memset(out, 0, sizeof *out);
    out->vertex_count = view->vertex_count;
    snap_job job = {.view = view,
                    .cpu = bvxi_cpu(ctx),
                    .out = out,
                    .pieces = bvxi_piece_count(view->vertex_count, SNAP_GRAIN)};
    memcpy(job.origin, lattice->origin, sizeof job.origin);
    BVXI_TRY(bvxi_snap_scale(ctx, function, lattice, job.scale));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, view->vertex_count * 12 + 4, "the snapped vertices", &out->xyz));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, view->vertex_count * 4, "the vertices' rows", &out->cell));
    BVXI_TRY(bvxi_for_pieces(ctx, "solid", 0.0, 0.1, job.pieces, job.view->vertex_count, snap_piece, &job));
    for (int32_t i = 0; i < job.pieces; i++) any_bad |= job.bad[i];
    /* Gone over once more only where something did not fit. */
    return any_bad ? snap_judge(ctx, function, &job, lattice) : BVX_OK;
}

static inline uint32_t clamp_side(int32_t v, int32_t side)
{
    return (uint32_t)(v < 0 ? 0 : v > side ? side : v);
}

BVXI_VECTOR_INLINE void cell_range(const snap_job *job, uint64_t begin, uint64_t end)
{
    bvxi_row_block const block = job->block;
    int32_t const f = job->fraction_bits;
    const int32_t *const xyz = job->out->xyz;
    uint32_t *const cell = job->out->cell;

    for (uint64_t v = begin; v < end; v++) {
        /* Cut to the block's rows, so that both fit 16 bits. */
        uint32_t const y = clamp_side(bvxi_centres_below(xyz[3 * v + 1], f) - block.y0, block.ny);
        uint32_t const z = clamp_side(bvxi_centres_below(xyz[3 * v + 2], f) - block.z0, block.nz);
        cell[v] = z << 16 | y;
    }
}

BVXI_AVX2_COPY(cell_range_avx2, (const snap_job *job, uint64_t begin, uint64_t end),
               cell_range(job, begin, end))

static void cell_piece(void *user, uint64_t begin, uint64_t end)
{
    const snap_job *const job = user;
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, cell_range(job, begin, end), cell_range_avx2(job, begin, end));
}

bvx_status bvxi_snap_cells(bvx_context *ctx, const bvx_lattice *lattice, const bvxi_row_block *block,
                           double progress, bvxi_snapped *s)
{
    snap_job job = {.cpu = bvxi_cpu(ctx), .out = s, .block = *block, .fraction_bits = lattice->fraction_bits};
    return BVXI_SHARE(ctx, progress, progress,
                      bvxi_for(ctx, "solid", s->vertex_count, SNAP_GRAIN, cell_piece, &job));
}

static void swap_piece(void *user, uint64_t begin, uint64_t end)
{
    const snap_job *const job = user;

    for (uint64_t v = begin; v < end; v++) {
        int32_t *const q = job->out->xyz + 3 * v;
        /* Two coordinates change places: exact, and back in the same way. */
        int32_t const first = q[0];
        q[0] = q[job->swap];
        q[job->swap] = first;
    }
}

/* x y z and y x z differ in the first two, y x z and z x y in the first and third. */
bvx_status bvxi_snap_turn(bvx_context *ctx, int32_t axis, double progress, bvxi_snapped *s)
{
    snap_job job = {0};

    job.out = s;

    /* One exchange for each step from axis to axis. */
    while (s->axis != axis) {
        job.swap = s->axis < axis ? s->axis + 1 : s->axis;
        BVXI_TRY(BVXI_SHARE(ctx, progress, progress,
                            bvxi_for(ctx, "solid", s->vertex_count, SNAP_GRAIN, swap_piece, &job)));
        s->axis += s->axis < axis ? 1 : -1;
    }
    return BVX_OK;
}
