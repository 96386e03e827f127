/* repair_lattice.c - the lattice that a mesh is repaired on: fitted to it
 * with room for shells, or the caller's. */
#include "pipeline/repair.h"

bvx_status bvxi_repair_lattice(bvxi_repair_job *job, int32_t resolution)
{
    bvx_lattice_options o;

    job->resolution = resolution;
    if (job->options->lattice != NULL) {
        job->lattice = *job->options->lattice;
        return BVX_OK;
    }
    bvx_lattice_options_init(&o, sizeof o);
    o.resolution = resolution;
    o.padding = 2 + (int32_t)(job->options->shell * 0.5 + 0.5);
    return bvx_lattice_fit_with(job->ctx, &job->mesh, &o, &job->lattice);
}
