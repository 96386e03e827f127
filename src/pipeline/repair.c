/* repair.c - any mesh in, a closed manifold oriented mesh out: bvx_repair.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013: the mesh is measured
 * from the centres of voxels, and marching cubes put the surface back between inside and outside centres,
 * where the vectors to the closest points say. Here the sides come from the solid's exact rules with a smooth
 * lid over holes, so no hole is too wide, and only the centres next to the surface are measured. What
 * encloses nothing becomes a shell.
 * Guarantee: that of marching cubes on bits (march.c), whatever the input. */
#include "pipeline/repair.h"

static const bvxi_option repair_rows[] = {
    BVXI_AMONG(bvx_repair_options, sign, BVX_FILLS_OF_REPAIR),
    BVXI_RESERVED(bvx_repair_options, fit.reserved),
    BVXI_PLACING(bvx_repair_options),
    BVXI_PARTS(bvx_repair_options),
    BVXI_COUNT(bvx_repair_options, samples, 0, INT32_MAX),
    BVXI_RESERVED(bvx_repair_options, reserved0),
    BVXI_RESERVED(bvx_repair_options, reserved),
    BVXI_OR(bvx_repair_options, shell, ZERO_OR, 2.0, 1.5, 1e6),
    BVXI_SWITCH(bvx_repair_options, if_needed),
    BVXI_CHOICE(bvx_repair_options, thin, BVX_THIN_KEEP, BVX_THIN_SHELL),
};

static bvx_status make_repaired(bvxi_repair_job *job, bvx_mesh *repaired)
{
    uint64_t voxels;

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.1, bvxi_repair_take(job)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.1, 0.2, bvxi_repair_needs(job)));

    /* A mesh that is sound is copied before anything is measured: nothing of it may move. */
    if (job->options->if_needed && job->report.needs == BVX_NEEDS_NOTHING)
        return BVXI_SHARE(job->ctx, 0.2, 1.0, bvxi_repair_copy(job, repaired));

    BVXI_TRY(bvxi_repair_lattice(job, job->options->fit.resolution));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.2, 0.55, bvxi_repair_inside(job)));

    /* An empty result would look like success. */
    BVXI_TRY(bvx_grid_count(job->ctx, &job->inside, &voxels));
    if (voxels == 0)
        return bvxi_fail(job->ctx, BVX_ERR_EMPTY, "%s: nothing remains at %d x %d x %d voxels: %s",
                         bvxi_repair_name, (int64_t)job->lattice.dims[0], (int64_t)job->lattice.dims[1],
                         (int64_t)job->lattice.dims[2],
                         job->report.parts_dropped != 0
                             ? "every part is below least_part"
                             : "the mesh encloses no centre; take a higher resolution, or allow shells");

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.55, 0.75, BVXI_SCOPE(job->ctx, bvxi_repair_surface(job, repaired))));
    bvxi_flat_body const body = {&job->thin, NULL};

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.75, 0.875, bvxi_flatten(job->ctx, bvxi_repair_name, &body, 1, repaired)));
    return BVXI_SHARE(job->ctx, 0.875, 1.0,
                      BVXI_SCOPE(job->ctx, bvxi_round_bars(job->ctx, bvxi_repair_name, &job->inside,
                                                           &job->body, repaired)));
}

static bvx_status repair_steps(bvxi_repair_job *job, bvx_mesh *repaired)
{
    const bvx_repair_options *const o = job->options;
    double const made = o->report == NULL ? 1.0 : o->samples != 0 ? 0.5 : 0.9;
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, made, make_repaired(job, repaired)));
    /* A copy is measured where it is made. */
    if (o->report == NULL || job->report.copied) return BVX_OK;
    return BVXI_SHARE(job->ctx, made, 1.0, bvxi_repair_measure(job, repaired));
}

static bvx_status repair_and_warn(bvx_context *ctx, const bvx_mesh_view *mesh,
                                  const bvx_repair_options *options, bvx_mesh *repaired)
{
    bvxi_repair_facts facts;
    bvx_repair_options o;
    BVXI_TRY(bvxi_repair_known(ctx, mesh, NULL, options, &facts, repaired));
    BVXI_TRY(bvxi_take_options(ctx, bvxi_repair_name, options, &o, sizeof o));
    if (o.report != NULL)
        bvxi_repair_warn(ctx, o.report, &facts, o.fit.lattice == NULL ? o.fit.resolution : 0, 0);
    return BVX_OK;
}

bvx_status bvx_repair(bvx_context *context, const bvx_mesh_view *mesh, const bvx_repair_options *options,
                      bvx_mesh *repaired)
{
    return BVXI_CALL(context, repair_and_warn(context, mesh, options, repaired));
}

bvx_status bvxi_repair_known(bvx_context *context, const bvx_mesh_view *mesh, const bvx_certificate *known,
                             const bvx_repair_options *options, bvxi_repair_facts *facts, bvx_mesh *repaired)
{
    bvx_repair_options o;
    bvxi_repair_job job = {0};

    if (repaired == NULL) return bvxi_fail_null(context, bvxi_repair_name, "repaired");
    BVXI_TRY(bvxi_take_options(context, bvxi_repair_name, options, &o, sizeof o));
    /* The result is not the mesh that it is made of. */
    BVXI_TRY(bvxi_view_check(context, bvxi_repair_name, mesh));
    BVXI_TRY(bvxi_view_apart(context, bvxi_repair_name, mesh, repaired));
    BVXI_TRY(bvxi_check_options(context, bvxi_repair_name, &o, BVXI_OPTIONS(repair_rows)));
    BVXI_TRY(bvxi_check_fit(context, bvxi_repair_name, &o.fit));

    job.ctx = context;
    job.options = &o;
    job.given = mesh;
    job.known = known;
    job.facts.handles = -1;
    int mine = repaired->positions == NULL;
    bvx_status status = repair_steps(&job, repaired);
    if (status == BVX_OK && o.report != NULL) {
        *o.report = job.report;
        *facts = job.facts;
    }
    if (status != BVX_OK && mine) bvx_mesh_free(context, repaired);
    return status;
}
