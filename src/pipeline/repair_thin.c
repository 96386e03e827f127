/* repair_thin.c - walls of a repaired body that are thinner than the lattice can hold: found
 * (fill/thin_walls.h), reported, and kept by thicken.c unless the options drop them. */
#include "pipeline/repair.h"

typedef struct repair_walls {
    bvxi_repair_job *job;
    bvxi_walls walls;
} repair_walls;

/* ---- What is found ---- */

static bvx_status thicken(repair_walls *t)
{
    bvxi_repair_job *const job = t->job;
    bvx_repair_report *const r = &job->report;
    const double *const h = job->lattice.spacing;
    int32_t longest = job->resolution;
    uint64_t voxels = 0;
    bvxi_wall_report found;

    BVXI_TRY(bvxi_walls_open(&t->walls));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.4, bvxi_walls_gather(&t->walls)));
    if (!t->walls.unsummed) BVXI_TRY(bvx_grid_count(job->ctx, &job->inside, &voxels));
    r->crossing_volume = bvxi_volume_by_crossings(&t->walls, (double)voxels * h[0] * h[1] * h[2]);
    if (t->walls.count == 0) return BVX_OK;
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.4, 0.6, bvxi_walls_ask(&t->walls, 1.0)));
    bvxi_walls_report(&t->walls, &found);
    r->thin_voxels = found.voxels;
    if (found.voxels == 0) return BVX_OK;

    /* Voxels along the longest axis: as requested, or of the lattice that was given. */
    for (int a = 0; a < 3 && job->options->fit.lattice != NULL; a++)
        if (a == 0 || job->lattice.dims[a] > longest) longest = job->lattice.dims[a];
    memcpy(job->facts.thin_low, found.low, sizeof found.low);
    memcpy(job->facts.thin_high, found.high, sizeof found.high);
    r->thin_resolution = bvxi_wall_resolution(longest, found.wall);
    r->thin_kept = job->options->thin == BVX_THIN_KEEP;
    if (!r->thin_kept) return BVX_OK;
    return BVXI_SHARE(job->ctx, 0.6, 1.0, bvxi_thicken(&t->walls, &job->inside, &job->thin));
}

bvx_status bvxi_repair_thicken(bvxi_repair_job *job)
{
    repair_walls t = {0};

    if (job->body.triangle_count == 0) return BVX_OK;
    /* nobody asks what is lost */
    if (job->options->thin != BVX_THIN_KEEP && job->options->report == NULL) return BVX_OK;
    t.job = job;
    t.walls.ctx = job->ctx;
    t.walls.function = bvxi_repair_name;
    t.walls.mesh = &job->body;
    t.walls.solid = &job->inside;
    t.walls.parts = job->options->thin == BVX_THIN_KEEP && job->report.before.components > 1;
    t.walls.unsummed = job->options->report == NULL;
    t.walls.unoriented = job->fill == BVX_FILL_VOTE;
    t.walls.open = job->holes.loops != 0 ? BVXI_WALLS_HOLES : BVXI_WALLS_CLOSED;

    bvx_status const status = thicken(&t);
    bvxi_walls_close(&t.walls);
    return status;
}
