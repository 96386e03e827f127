/* planes.c - what every plane needs before cells are looked at, side by side: places on the plane; then
 * points in fixed point, loops that are surely simple, their directions, areas and distances' boxes; then,
 * once it is known how much there is, crossings.
 *
 * A piece of work neither takes memory nor leaves a message. Planes on which anything is wrong, or not surely
 * right, are gone over once more in order on the calling thread, which says what it is. */
#include "contours/section.h"

enum { PLANES_SPARE_CUTS = 32 /* for subdivided cells */, PLANES_GRAIN = 1024 /* points */ };

typedef struct planes_scratch {
    bvxi_segment_box *sorted, *active;
    int32_t (*box)[4];
    bvxi_arc_scratch arcs;
} planes_scratch;

typedef struct planes_job {
    bvxi_stack *s;
    bvxi_stack view; /* fixed: for pieces */
    int32_t pieces, workers;
    planes_scratch *scratch; /* one a worker */
    double (*bounds)[4];     /* of each plane */
    uint8_t *unsure;         /* a plane each */
    uint64_t *count;         /* crossings and arcs of each plane */
    uint64_t most_points, most_loops, most_arcs;
    int32_t rows; /* the larger of columns and rows of cells, and one more */
} planes_job;

static void plane_place_piece(void *user, uint64_t begin, uint64_t end)
{
    planes_job *const job = user;
    for (uint64_t i = begin; i < end; i++) {
        double *const b = job->bounds[i];
        b[0] = b[1] = 1e300;
        b[2] = b[3] = -1e300;
        job->unsure[i] = bvxi_plane_place(&job->view, &job->s->plane[i], b, b + 2) != BVX_OK;
    }
}

static planes_job planes_job_of(bvxi_stack *s)
{
    planes_job job = {
        .s = s, .view = *s, .pieces = bvxi_section_pieces(s->plane_count, s->all.point_room, PLANES_GRAIN)};
    job.view.fixed = 1;
    return job;
}

bvx_status bvxi_planes_place(bvxi_stack *s)
{
    planes_job job = planes_job_of(s);

    BVXI_TRY(BVXI_ARRAY(s->ctx, s->plane_count, "the bounds of sections", job.bounds));
    BVXI_TRY(BVXI_ARRAY(s->ctx, s->plane_count, "the bounds of sections", job.unsure));
    BVXI_TRY(
        bvxi_for_ranges(s->ctx, "sections", 0.0, 0.25, job.pieces, s->plane_count, plane_place_piece, &job));
    for (uint32_t i = 0; i < s->plane_count; i++) {
        const double *const b = job.bounds[i];
        /* Gone over again with a stack that has messages: it fails here, and says where. */
        if (job.unsure[i]) BVXI_TRY(bvxi_plane_place(s, &s->plane[i], s->low, s->high));
        for (int k = 0; k < 2; k++) {
            if (b[k] < s->low[k]) s->low[k] = b[k];
            if (b[k + 2] > s->high[k]) s->high[k] = b[k + 2];
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

static void plane_snap_piece(void *user, int32_t index, int32_t worker)
{
    planes_job *const job = user;
    const planes_scratch *const x = &job->scratch[worker];
    uint64_t begin, end;
    bvxi_piece(job->s->plane_count, job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        bvxi_plane *const p = &job->s->plane[i];
        /* The quick test may say that it is not sure; such planes are left to the calling thread. */
        bvxi_plane_snap(&job->view, p);
        job->unsure[i] = !bvxi_plane_is_simple(p, x->sorted, x->active) ||
                         bvxi_plane_direct(&job->view, p, x->box) != BVX_OK;
        if (!job->unsure[i]) measure_plane(job, i);
    }
}

static bvx_status settle_planes(planes_job *job)
{
    bvxi_stack *const s = job->s;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        bvxi_plane *const p = &s->plane[i];
        /* In order, so that what is refused is the first plane that is wrong, whatever the threads did. */
        if (job->unsure[i]) {
            BVXI_TRY(bvxi_plane_check_simple(s, p));
            BVXI_TRY(bvxi_plane_direct(s, p, job->scratch[0].box));
            measure_plane(job, i);
        }
        for (uint32_t k = 0; k < p->contour_count; k++) s->report.holes += (uint64_t)p->contour[k].hole;
    }
    return BVX_OK;
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
    for (uint64_t i = begin; i < end; i++)
        bvxi_plane_cut(&job->view, &job->s->plane[i], &job->scratch[worker].arcs);
}

/* Scratch of all workers in one block. */
static bvx_status open_snap_scratch(planes_job *job)
{
    uint64_t const boxes = job->most_points * sizeof(bvxi_segment_box);
    uint64_t const loops = job->most_loops * sizeof *job->scratch->box;
    unsigned char *at;
    BVXI_TRY(bvxi_alloc(job->s->ctx, BVXI_SCRATCH, (uint64_t)job->workers * (2 * boxes + loops),
                        "the order of segments", &at));
    for (int32_t i = 0; i < job->workers; i++, at += 2 * boxes + loops) {
        job->scratch[i].sorted = (bvxi_segment_box *)(void *)at;
        job->scratch[i].active = (bvxi_segment_box *)(void *)(at + boxes);
        job->scratch[i].box = (int32_t(*)[4])(void *)(at + 2 * boxes);
    }
    return BVX_OK;
}

static bvx_status open_cut_scratch(planes_job *job)
{
    uint64_t const n = job->most_arcs, each = n * sizeof(bvxi_arc) + (3 * n + (uint64_t)job->rows) * 4;
    unsigned char *at;
    BVXI_TRY(bvxi_alloc(job->s->ctx, BVXI_SCRATCH, (uint64_t)job->workers * each, "the order of arcs", &at));
    for (int32_t i = 0; i < job->workers; i++, at += each) {
        bvxi_arc_scratch *const x = &job->scratch[i].arcs;
        x->arc = (bvxi_arc *)(void *)at;
        x->cell = (uint32_t *)(void *)(at + n * sizeof(bvxi_arc));
        x->order[0] = x->cell + n;
        x->order[1] = x->order[0] + n;
        x->start = x->order[1] + n;
    }
    return BVX_OK;
}

bvx_status bvxi_planes_ready(bvxi_stack *s)
{
    uint64_t const n = s->plane_count;
    planes_job job = planes_job_of(s);

    job.workers = bvxi_threads(s->ctx) < job.pieces ? bvxi_threads(s->ctx) : job.pieces;
    job.rows = (s->size[0] > s->size[1] ? s->size[0] : s->size[1]) + 1;

    for (uint32_t i = 0; i < n; i++) {
        if (s->plane[i].point_count > job.most_points) job.most_points = s->plane[i].point_count;
        if (s->plane[i].contour_count > job.most_loops) job.most_loops = s->plane[i].contour_count;
    }
    BVXI_TRY(BVXI_ZEROS(s->ctx, job.workers, "the sections' scratch", job.scratch));
    BVXI_TRY(BVXI_ARRAY(s->ctx, n, "the sections' scratch", job.unsure));
    BVXI_TRY(BVXI_ARRAY(s->ctx, 2 * n, "the sections' scratch", job.count));
    BVXI_TRY(open_snap_scratch(&job));
    BVXI_TRY(bvxi_parallel(s->ctx, "sections", 0.25, 0.75, job.pieces, plane_snap_piece, &job));
    BVXI_TRY(settle_planes(&job));
    bvxi_drop(s->ctx, job.scratch[0].sorted); /* the block of all */
    BVXI_TRY(open_cuts(&job));
    BVXI_TRY(open_cut_scratch(&job));
    return bvxi_parallel(s->ctx, "sections", 0.75, 1.0, job.pieces, plane_cut_piece, &job);
}
