/* repair_inside.c - which centres lie inside the repaired body: the solid of the sign rule, joined with
 * shells around sheets, where it has nothing. */
#include "pipeline/repair.h"
#include "fill/fills.h"

static bvx_status open_scratch_grid(bvxi_repair_job *job, bvx_grid *grid)
{
    uint64_t *words;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->grid_bytes, "the solid", &words));
    grid->words = words;
    grid->word_capacity = job->grid_bytes / 8;
    return BVX_OK;
}

/* mesh: the job's, or its body, whose holes become the job's. */
static bvx_status fill_solid(bvxi_repair_job *job, const bvx_mesh_view *mesh)
{
    BVXI_TRY(bvx_grid_create(job->ctx, &job->lattice, NULL, &job->solid));
    bvxi_holes_close(job->ctx, &job->holes);
    if (mesh->triangle_count == 0) return BVX_OK;
    if (job->fill == BVX_FILL_PARITY &&
        job->report.before.boundary_edges + job->report.before.nonmanifold_edges == 0)
        return bvxi_fill_known(job->ctx, mesh, job->fill, NULL, &job->solid); /* nobody requires them */
    BVXI_TRY(bvxi_holes_open_rule(job->ctx, bvxi_repair_name, mesh, &job->lattice, job->fill, &job->holes));
    return bvxi_fill_known(job->ctx, mesh, job->fill, &job->holes, &job->solid);
}

bvx_status bvxi_repair_inside(bvxi_repair_job *job)
{
    job->grid_bytes = bvx_grid_bound(&job->lattice, NULL) * 8;
    BVXI_TRY(open_scratch_grid(job, &job->solid));
    BVXI_TRY(open_scratch_grid(job, &job->inside));

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.3, fill_solid(job, &job->mesh)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.3, 0.4, bvxi_repair_part(job)));
    if (job->sheets.triangle_count != 0)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.4, 0.5, fill_solid(job, &job->body)));
    /* The body's solid stays, as shells are joined to a copy of it. */
    BVXI_TRY(bvx_grid_create(job->ctx, &job->lattice, NULL, &job->inside));
    memcpy(job->inside.words, job->solid.words, (size_t)job->grid_bytes);
    if (job->sheets.triangle_count != 0)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.5, 0.6, BVXI_SCOPE(job->ctx, bvxi_repair_lay_shells(job))));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.6, 0.9, bvxi_repair_thicken(job)));
    return BVXI_SHARE(job->ctx, 0.9, 1.0, bvxi_repair_clean(job));
}
