/* planes.c - what every plane needs before cells are looked at, side by side: places on the plane; then
 * points in fixed point, loops that are surely simple, their directions, areas and distances' boxes; then,
 * once it is known how much there is, crossings.
 *
 * A piece of work neither takes memory nor leaves a message. Planes on which anything is wrong, or not surely
 * right, are gone over once more in order on the calling thread, which says what it is. */
#include "contours/section.h"

#include "lattice/wide.h"

#include <math.h>

/* ---- one plane ---- */

int32_t bvxi_snap_steps(const bvxi_stack *s, int k, double along)
{
    return (int32_t)floor((along - s->origin[k]) / s->step[k] * (double)(1 << (s->fine - 1)));
}

void bvxi_plane_snap(const bvxi_stack *s, bvxi_plane *p)
{
    for (uint32_t i = 0; i < p->point_count; i++)
        for (int k = 0; k < 2; k++) {
            /* Points are odd: between the grid's lines, which are even, so that none lies on a line. */
            int32_t const top = (s->size[k] << s->fine) - 1;
            int32_t const steps = s->nudge == NULL ? 0 : s->nudge[p->given[i]][k];
            int32_t const q = 2 * (bvxi_snap_steps(s, k, p->uv[i][k]) + steps) + 1;
            p->q[i][k] = q < 1 ? 1 : q > top ? top : q;
        }
}

int bvxi_loop_contains(const bvxi_plane *p, const bvxi_contour *c, const int32_t *at)
{
    int odd = 0;
    for (uint32_t i = c->first; i < c->first + c->count; i++) {
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        /* Half open, so that a place level with a point counts it once. */
        if ((a[1] <= at[1]) == (b[1] <= at[1])) continue;
        int64_t const s = ((int64_t)b[0] - a[0]) * ((int64_t)at[1] - a[1]) -
                          ((int64_t)at[0] - a[0]) * ((int64_t)b[1] - a[1]);
        odd ^= (s > 0) == (b[1] > a[1]);
    }
    return odd;
}

void bvxi_loop_box(const bvxi_plane *p, const bvxi_contour *c, int32_t box[4])
{
    for (int k = 0; k < 2; k++) box[k] = box[k + 2] = p->q[c->first][k];
    for (uint32_t i = c->first; i < c->first + c->count; i++)
        for (int k = 0; k < 2; k++) {
            if (p->q[i][k] < box[k]) box[k] = p->q[i][k];
            if (p->q[i][k] > box[k + 2]) box[k + 2] = p->q[i][k];
        }
}

/* The boxes of loops keep most pairs from being looked at. */
bvx_status bvxi_plane_direct(bvxi_stack *s, bvxi_plane *p, int32_t (*box)[4])
{
    for (uint32_t i = 0; i < p->contour_count; i++) bvxi_loop_box(p, &p->contour[i], box[i]);
    for (uint32_t i = 0; i < p->contour_count; i++) {
        bvxi_contour *const c = &p->contour[i];
        const int32_t *const at = p->q[c->first];
        bvxi_wide sum = bvxi_wide_mul(0, 0);

        /* Twice the area, exactly. */
        for (uint32_t k = c->first + 1; k + 1 < c->first + c->count; k++) {
            int64_t const ax = (int64_t)p->q[k][0] - at[0], ay = (int64_t)p->q[k][1] - at[1];
            int64_t const bx = (int64_t)p->q[k + 1][0] - at[0], by = (int64_t)p->q[k + 1][1] - at[1];
            sum = bvxi_wide_add(sum, bvxi_wide_add(bvxi_wide_mul(ax, by), bvxi_wide_mul(-ay, bx)));
        }
        int const turn = bvxi_wide_sign(sum);

        /* A hole lies in an odd number of others; since no two meet, one point of it decides. */
        c->hole = 0;
        for (uint32_t j = 0; j < p->contour_count; j++)
            if (j != i && at[0] >= box[j][0] && at[0] <= box[j][2] && at[1] >= box[j][1] &&
                at[1] <= box[j][3])
                c->hole ^= bvxi_loop_contains(p, &p->contour[j], at);
        if (turn == 0)
            return s->fixed ? BVX_ERR_FORMAT
                            : bvxi_fail_for(s->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOP_FLAT,
                                            "%s: loop %i of section %u encloses no area", s->function,
                                            (uint64_t)c->given, (uint64_t)p->section);
        if ((turn > 0) == (c->hole != 0)) {
            for (uint32_t m = c->first, j = c->first + c->count - 1; m < j; m++, j--) {
                uint32_t const given = p->given[m];
                int32_t q[2];
                double uv[2];
                memcpy(q, p->q[m], sizeof q);
                memcpy(uv, p->uv[m], sizeof uv);
                p->given[m] = p->given[j];
                memcpy(p->q[m], p->q[j], sizeof q);
                memcpy(p->uv[m], p->uv[j], sizeof uv);
                p->given[j] = given;
                memcpy(p->q[j], q, sizeof q);
                memcpy(p->uv[j], uv, sizeof uv);
            }
        }
    }
    return BVX_OK;
}

/* ---- planes side by side ---- */

enum { PLANES_SPARE_CUTS = 32 /* for subdivided cells */, PLANES_GRAIN = 1024 /* points */ };

typedef struct planes_job {
    bvxi_stack *s;
    bvxi_stack view; /* fixed: for pieces */
    int32_t pieces, workers;
    bvxi_segment_box *box;  /* [2 * most_points] of each worker */
    bvxi_arc_scratch *arcs; /* of each worker */
    uint8_t *unsure;        /* a plane each */
    uint64_t *count;        /* crossings and arcs of each plane */
    uint64_t most_points, most_arcs;
} planes_job;

bvx_status bvxi_planes_place(bvxi_stack *s)
{
    for (uint32_t i = 0; i < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "sections", 0.25 * i / s->plane_count));
        for (uint32_t n = 0; n < s->plane[i].point_count; n++) {
            uint32_t const given = s->plane[i].given[n];
            double *const uv = s->plane[i].uv[n];
            for (int k = 0; k < 2; k++)
                uv[k] = bvxi_along_axis(s->axis[k], s->given->points + 3 * (uint64_t)given);
            /* Infinite or undefined: such a place is on no grid. */
            if (uv[0] - uv[0] != 0.0 || uv[1] - uv[1] != 0.0)
                return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR, "%s: point %i is too far out",
                                     s->function, (uint64_t)given);
            bvxi_widen(s->low, s->high, uv, 2);
        }
    }
    return BVX_OK;
}

/* ---- fixed point ---- */

static void measure_plane(const planes_job *job, uint64_t i)
{
    bvxi_plane *const p = &job->s->plane[i];
    p->area = bvxi_plane_area(job->s, p);
    bvxi_plane_tree(p);
    bvxi_plane_count_cuts(job->s, p, &job->count[2 * i], &job->count[2 * i + 1]);
}

/* A loop has three segments or more: boxes of loops fit where those of segments were. */
static int32_t (*loop_boxes(bvxi_segment_box *box))[4]
{
    return (int32_t(*)[4])(void *)box;
}

static void plane_snap_piece(void *user, int32_t index, int32_t worker)
{
    planes_job *const job = user;
    bvxi_segment_box *const box = job->box + 2 * (uint64_t)worker * job->most_points;
    uint64_t begin, end;
    bvxi_piece(job->s->plane_count, job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        bvxi_plane *const p = &job->s->plane[i];
        /* The quick test may say that it is not sure; such planes are left to the calling thread. */
        bvxi_plane_snap(&job->view, p);
        job->unsure[i] = !bvxi_plane_is_simple(p, box, box + job->most_points) ||
                         bvxi_plane_direct(&job->view, p, loop_boxes(box)) != BVX_OK;
        if (!job->unsure[i]) measure_plane(job, i);
    }
}

/* ---- crossings ---- */

static bvx_status open_cuts(planes_job *job)
{
    bvxi_stack *const s = job->s;
    bvxi_plane *const all = &s->all;
    uint64_t cut = 0, arc = 0;

    for (uint32_t i = 0; i < s->plane_count; i++) {
        uint64_t const cuts = job->count[2 * (size_t)i], arcs = job->count[2 * (size_t)i + 1];
        if (cuts > INT32_MAX)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: section %i crosses the grid more than 2^31 times", s->function,
                                 (uint64_t)s->plane[i].section);
        /* Spare ones for subdivided cells: their number is not known before slabs are made. */
        cut += cuts + PLANES_SPARE_CUTS;
        arc += arcs;
        if (arcs > job->most_arcs) job->most_arcs = arcs;
    }
    BVXI_TRY(BVXI_ARRAY(s->ctx, cut, "the crossings of sections", all->cut));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arc, "the arcs of sections", all->arc));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arc, "the arcs of sections", all->ring_arc));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arc, "the arcs of sections", all->arc_cell));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arc, "the arcs of sections", all->asking));
    cut = arc = 0;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        bvxi_plane *const p = &s->plane[i];
        p->cut = p->shared_cut = all->cut + cut;
        p->cut_room = p->shared_room = (uint32_t)job->count[2 * (size_t)i] + PLANES_SPARE_CUTS;
        p->arc = all->arc + arc;
        p->ring_arc = all->ring_arc + arc;
        p->arc_cell = all->arc_cell + arc;
        p->asking = all->asking + arc;
        cut += p->cut_room;
        arc += job->count[2 * (size_t)i + 1];
    }
    return BVX_OK;
}

static void plane_cut_piece(void *user, int32_t index, int32_t worker)
{
    planes_job *const job = user;
    uint64_t begin, end;
    bvxi_piece(job->s->plane_count, job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) bvxi_plane_cut(&job->view, &job->s->plane[i], &job->arcs[worker]);
}

bvx_status bvxi_planes_ready(bvxi_stack *s)
{
    uint64_t const n = s->plane_count;
    planes_job job = {.s = s, .view = *s, .pieces = bvxi_section_pieces(n, s->all.point_room, PLANES_GRAIN)};

    job.view.fixed = 1;
    job.workers = bvxi_threads(s->ctx) < job.pieces ? bvxi_threads(s->ctx) : job.pieces;
    for (uint32_t i = 0; i < n; i++)
        if (s->plane[i].point_count > job.most_points) job.most_points = s->plane[i].point_count;
    BVXI_TRY(BVXI_ARRAY(s->ctx, n, "the sections' scratch", job.unsure));
    BVXI_TRY(BVXI_ARRAY(s->ctx, 2 * n, "the sections' scratch", job.count));
    BVXI_TRY(
        BVXI_ARRAY(s->ctx, 2 * (uint64_t)job.workers * job.most_points, "the order of segments", job.box));
    BVXI_TRY(bvxi_parallel(s->ctx, "sections", 0.25, 0.75, job.pieces, plane_snap_piece, &job));
    for (uint32_t i = 0; i < n; i++) {
        bvxi_plane *const p = &s->plane[i];
        if (job.unsure[i]) {
            BVXI_TRY(bvxi_plane_check_simple(s, p));
            BVXI_TRY(bvxi_plane_direct(s, p, loop_boxes(job.box)));
            measure_plane(&job, i);
        }
        for (uint32_t k = 0; k < p->contour_count; k++) s->report.holes += (uint64_t)p->contour[k].hole;
    }
    bvxi_drop(s->ctx, job.box);
    BVXI_TRY(open_cuts(&job));

    static const char what[] = "the order of arcs";
    int32_t const rows = (s->size[0] > s->size[1] ? s->size[0] : s->size[1]) + 1;

    BVXI_TRY(BVXI_ZEROS(s->ctx, job.workers, what, job.arcs));
    for (bvxi_arc_scratch *x = job.arcs; x < job.arcs + job.workers; x++) {
        BVXI_TRY(BVXI_ARRAY(s->ctx, job.most_arcs, what, x->arc));
        BVXI_TRY(BVXI_ARRAY(s->ctx, job.most_arcs, what, x->cell));
        BVXI_TRY(BVXI_ARRAY(s->ctx, job.most_arcs, what, x->order[0]));
        BVXI_TRY(BVXI_ARRAY(s->ctx, job.most_arcs, what, x->order[1]));
        BVXI_TRY(BVXI_ARRAY(s->ctx, rows, what, x->start));
    }
    return bvxi_parallel(s->ctx, "sections", 0.75, 1.0, job.pieces, plane_cut_piece, &job);
}
