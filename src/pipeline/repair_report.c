/* repair_report.c - what a repair found, how near it stayed, and what is warned of. */
#include "mesh/view.h"
#include "pipeline/repair.h"
#include "pipeline/steps.h"
#include "winding/holes.h"

#include <math.h>

void bvxi_longest_rim(const bvx_mesh_view *mesh, const bvxi_holes *holes, bvxi_rim *longest)
{
    uint64_t begin = 0;

    for (uint64_t l = 0; l < holes->loops; begin = holes->loop_end[l++]) {
        bvxi_rim rim = {0.0, {1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
        for (uint64_t i = begin; i < holes->loop_end[l]; i++) {
            uint64_t const next = i + 1 == holes->loop_end[l] ? begin : i + 1;
            double p[3], q[3];
            bvxi_view_position(mesh, holes->vertex[i], p);
            bvxi_view_position(mesh, holes->vertex[next], q);
            bvxi_widen(rim.low, rim.high, p, 3);
            rim.length += sqrt(bvxi_vec_distance2(q, p));
        }
        if (rim.length > longest->length) *longest = rim;
    }
}

static void measure_loops(bvxi_repair_job *job, const bvxi_holes *holes)
{
    job->report.holes = holes->loops;
    bvxi_longest_rim(&job->mesh, holes, &job->facts.longest_rim);
}

static bvx_status find_holes(bvxi_repair_job *job)
{
    bvxi_holes holes;

    /* The holes of the fill are those of the mesh, where it has no sheets and no edge twice. */
    if (job->sheets.triangle_count == 0 && !job->holes.repeated) {
        measure_loops(job, &job->holes);
        return BVX_OK;
    }
    BVXI_TRY(
        bvxi_holes_open_rule(job->ctx, bvxi_repair_name, &job->mesh, &job->lattice, BVX_FILL_VOTE, &holes));
    measure_loops(job, &holes);
    bvxi_holes_close(job->ctx, &holes);
    return BVX_OK;
}

/* Voxels where the winding number is nearest to an even number but 0: what WINDING has and VOTE has not. */
static bvx_status count_overlaps(bvxi_repair_job *job)
{
    static const int32_t rule[2] = {BVX_FILL_VOTE, BVX_FILL_WINDING};
    uint64_t *words[2];
    BVXI_TRY(bvxi_fill_twice(job->ctx, &job->mesh, &job->lattice, rule, words));
    for (uint64_t i = 0; i < job->grid_bytes / 8; i++)
        job->facts.overlaps += bvxi_popcount(words[1][i] & ~words[0][i]);
    return BVX_OK;
}

#define REPAIR_OFF     0.02 /* of the mesh's own volume, from which on it is warned of */
#define REPAIR_CHANGED 0.05 /* of an area, or a volume that lines of centres see, the same */
#define REPAIR_LIDS    0.05 /* of the result's area, the same */

/* Volume or area of a closed mesh have changed: overlaps may be why. */
static int has_other_size(const bvx_repair_report *r)
{
    double const volume = bvxi_absolute(r->before.volume);
    if (!r->before.closed || !r->before.oriented) return 0;
    return bvxi_absolute(r->after.volume - volume) > REPAIR_OFF * volume ||
           bvxi_absolute(r->after.area - r->before.area) > REPAIR_CHANGED * r->before.area;
}

/* Of a certificate, with lids in so many holes. */
static int64_t lidded_handles(const bvx_certificate *c, uint64_t holes)
{
    return (int64_t)c->components - (c->euler + (int64_t)holes) / 2;
}

/* The handles of the mesh as it was taken. Where the result has more, parts that cross may be why. */
static bvx_status compare_handles(bvxi_repair_job *job)
{
    bvx_repair_report *const r = &job->report;
    bvx_certificate c = r->before;
    if (r->turned + c.duplicates != 0) BVXI_TRY(bvx_mesh_check(job->ctx, &job->mesh, 1, &c));
    if (!c.edge_manifold || !c.vertex_manifold || !c.oriented) return BVX_OK;
    int64_t const handles = lidded_handles(&c, r->holes);
    job->facts.handles = handles < INT32_MAX ? (int32_t)handles : INT32_MAX;
    if (lidded_handles(&r->after, 0) <= handles || r->crossings != 0) return BVX_OK;
    return bvx_mesh_crossings(job->ctx, &job->mesh, &r->crossings, NULL, 0);
}

int bvxi_has_own_size(const bvx_repair_report *r, const bvxi_repair_facts *f)
{
    return r->before.closed && r->before.oriented && f->overlaps == 0 && r->turned == 0 &&
           r->before.duplicates == 0 && r->before.volume != 0.0;
}

/* A surface crosses three lattice edges for two faces of a voxel's area, on average over all directions. */
static double share_of_lids(const bvx_repair_report *r, const bvxi_repair_facts *f)
{
    const double *const h = r->lattice.spacing;
    double const edges = 3.0 / (h[0] * h[1]) + 3.0 / (h[1] * h[2]) + 3.0 / (h[2] * h[0]);
    return (double)f->sheet_edges * 6.0 / (edges * r->after.area);
}

/* 1: no shells are in its body, and lids that lines of centres hardly see. */
static int is_nearly_closed(const bvx_repair_report *r, const bvxi_repair_facts *f)
{
    return r->shelled_triangles == 0 &&
           ((r->holes == 0 && r->before.boundary_edges == 0) || share_of_lids(r, f) <= REPAIR_LIDS);
}

bvx_status bvxi_repair_measure(bvxi_repair_job *job, const bvx_mesh *repaired)
{
    const bvx_repair_report *const r = &job->report;
    bvx_mesh_view result;

    bvx_mesh_view_of(repaired, &result);
    job->report.lattice = job->lattice;
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.2, bvx_mesh_check(job->ctx, &result, 0, &job->report.after)));
    if (job->report.before.boundary_edges + job->report.before.nonmanifold_edges != 0)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.2, 0.22, find_holes(job)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.22, 0.24, compare_handles(job)));
    /* Parts that cross become one; one that crosses none, or a gap, may be lost. */
    if (r->before.closed && r->needs != BVX_NEEDS_NOTHING && r->after.components < r->before.components &&
        r->shelled_triangles == 0)
        BVXI_TRY(
            BVXI_SHARE(job->ctx, 0.24, 0.25,
                       BVXI_SCOPE(job->ctx, bvxi_bodies_apart(job->ctx, &job->mesh, &job->facts.bodies))));
    if (has_other_size(&job->report))
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.25, 0.4, BVXI_SCOPE(job->ctx, count_overlaps(job))));
    if (is_nearly_closed(&job->report, &job->facts) && !bvxi_has_own_size(&job->report, &job->facts))
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.4, 0.4,
                            bvxi_see_volume(job->ctx, bvxi_repair_name, &job->body, &job->lattice, job->fill,
                                            job->report.after.volume, &job->report.crossing_volume)));
    if (job->options->samples == 0) return BVX_OK;

    /* In the world, as the frame is not part of a view. */
    double *world, p[3];

    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, result.vertex_count * 24, "the result's places", &world));
    for (uint64_t v = 0; v < result.vertex_count; v++) {
        bvxi_view_position(&result, v, p);
        for (uint64_t a = 0; a < 3; a++) world[3 * v + a] = p[a] + repaired->frame[a];
    }
    result.positions = world;
    result.position_type = BVX_F64;
    result.position_stride = 0;
    return BVXI_SHARE(
        job->ctx, 0.4, 1.0,
        bvx_mesh_distance(job->ctx, &job->mesh, &result, job->options->samples, 1, &job->report.distance));
}

/* ---- Warnings ---- */

#define REPAIR_SHELLED 0.03 /* of the mesh's area, the same */
#define REPAIR_INWARD  0.5  /* of a volume, the other one, the same; of an area, what became shells */

/* 1: parts were dropped or cavities filled as options ask, beside crumbs: sizes changed as they were to. */
static int changed_as_asked(const bvx_repair_report *r)
{
    return r->parts_dropped + r->cavities_dropped > r->crumbs;
}

static int has_lost_walls(const bvx_repair_report *r)
{
    return r->thin_voxels != 0 && !r->thin_kept;
}

void bvxi_warn_of_lids(bvx_context *ctx, double share, uint64_t holes, const bvxi_rim *longest)
{
    if (holes == 0 || share <= REPAIR_LIDS) return;
    bvx_warning *const w = BVXI_WARN(ctx, BVX_WARN_LIDS, (double)holes, (double)(int)(100.0 * share + 0.5),
                                     longest->length);
    w->placed = 1;
    memcpy(w->low, longest->low, sizeof w->low);
    memcpy(w->high, longest->high, sizeof w->high);
}

/* How the volume has changed, once: beyond that of all parts, from the mesh's own, or from what lines of centres
 * see of it. Where walls were put back there is more than these see. */
static void warn_of_size(bvx_context *ctx, const bvx_repair_report *r, const bvxi_repair_facts *f,
                         double finer, double collapsed)
{
    double const volume = r->after.volume, all = f->parts_volume, seen = r->crossing_volume;
    int const own = bvxi_has_own_size(r, f);
    double const from = own ? bvxi_absolute(r->before.volume) : seen;
    double const off = from > 0.0 ? volume / from - 1.0 : 0.0;
    double const area = r->before.area, wider = area > 0.0 ? r->after.area / area - 1.0 : 0.0;

    if (all == 0.0 && f->thin_shelled != 0)
        BVXI_WARN(ctx, BVX_WARN_SHELLED_BODIES, (double)f->thin_shelled, finer);
    if (all > 0.0 && volume > (1.0 + REPAIR_CHANGED) * all && !(changed_as_asked(r) && r->cavities_dropped))
        BVXI_WARN(ctx, BVX_WARN_THICKER, volume, all, volume / all - 1.0, finer, collapsed);
    else if (changed_as_asked(r) || (r->shelled_triangles != 0 && !own)) return;
    else if (bvxi_absolute(off) > (own || is_nearly_closed(r, f) ? REPAIR_OFF : REPAIR_CHANGED) &&
             (own || off < 0.0 || r->thin_voxels == 0))
        BVXI_WARN(ctx, BVX_WARN_VOLUME, volume, from, off, finer, collapsed);
    else if (own && bvxi_absolute(wider) > REPAIR_CHANGED && !has_lost_walls(r))
        BVXI_WARN(ctx, BVX_WARN_AREA, r->after.area, area, wider, finer, collapsed);
}

void bvxi_repair_warn(bvx_context *ctx, bvx_repair_report *r, const bvxi_repair_facts *f, int32_t resolution,
                      uint64_t collapsed)
{
    double longest = resolution;

    if (r->copied) return;
    for (int a = 0; a < 3 && resolution == 0; a++)
        longest = r->lattice.dims[a] > longest ? r->lattice.dims[a] : longest;
    if (has_lost_walls(r)) {
        bvx_warning *const w = BVXI_WARN(ctx, BVX_WARN_THIN_LOST, (double)r->thin_voxels,
                                         bvxi_advised(r->thin_resolution));

        bvxi_warn_box(w, &r->lattice, f->thin_low, f->thin_high);
    }
    /* Handles, where walls, or gaps, thinner than voxels have met. Parts that cross may close one at each curve where
     * they do, and a curve takes a pair of triangles at least; the shell of an open sheet has its holes. */
    double const finer = bvxi_advised(2.0 * longest);
    double const after = (double)r->after.components, before = (double)r->before.components;
    double const apart = r->needs == BVX_NEEDS_NOTHING ? before : (double)f->bodies;
    int64_t const has = lidded_handles(&r->after, 0);

    if (after > before) BVXI_WARN(ctx, BVX_WARN_PARTS, after, before, finer);
    if (after < apart && !changed_as_asked(r) && !has_lost_walls(r))
        BVXI_WARN(ctx, BVX_WARN_JOINED, after, apart, finer);
    if (f->handles >= 0 && (r->shelled_triangles == 0 || r->before.closed) &&
        has > f->handles + (int64_t)r->crossings)
        BVXI_WARN(ctx, BVX_WARN_HANDLES, (double)has, (double)f->handles, finer);
    if (r->shelled_triangles != 0 && f->shelled_area > REPAIR_SHELLED * r->before.area)
        BVXI_WARN(ctx, BVX_WARN_SHELLS, (double)r->shelled_triangles, f->shelled_area, r->before.area);
    bvxi_warn_of_lids(ctx, share_of_lids(r, f), r->holes, &f->longest_rim);
    /* An open mesh may be the inside of a room: faces that look inward enclose about as much as the result,
     * which is no shell of them. */
    double const inward = -r->before.volume, volume = r->after.volume;
    if (r->before.boundary_edges != 0 && f->shelled_area < REPAIR_INWARD * r->before.area &&
        inward > REPAIR_INWARD * volume && volume >= REPAIR_INWARD * inward)
        BVXI_WARN(ctx, BVX_WARN_TURNED, 0.0, -r->before.volume);
    warn_of_size(ctx, r, f, bvxi_advised(2.0 * longest), (double)collapsed);
    r->warnings = bvxi_warned(ctx);
}
