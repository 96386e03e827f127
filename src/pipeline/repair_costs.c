/* repair_costs.c - what the steps of a repair cost, about, by what is known when they are planned.
 *
 * Before the mesh has been looked at only its triangles and the resolution are known; then its area says how
 * many centres will lie beside the surface, and its edges whether there are holes. What each step finds out
 * it plans by itself (bvxi_share_cost). */
#include "core/costs.h"
#include "pipeline/repair.h"

#include <math.h>

/* The mesh has been looked at. */
static int is_taken(const bvxi_repair_job *job)
{
    return job->report.before.triangles != 0;
}

static int has_open_edges(const bvxi_repair_job *job)
{
    return job->report.before.boundary_edges + job->report.before.nonmanifold_edges != 0;
}

/* The longest axis of the lattice that was given, or the resolution. */
static double planned_resolution(const bvxi_repair_job *job)
{
    const bvx_lattice *const l = job->options->lattice;
    int32_t longest = 0;

    if (l == NULL) return (double)job->options->resolution;
    for (int a = 0; a < 3; a++) longest = l->dims[a] > longest ? l->dims[a] : longest;
    return (double)longest;
}

bvxi_repair_size bvxi_repair_expect(const bvxi_repair_job *job, double resolution)
{
    const bvx_certificate *const c = &job->report.before;
    bvxi_repair_size size = {.triangles = (double)job->given->triangle_count};
    double side[3], longest = 0.0;

    /* A box that is not known is taken as half a cube's. */
    size.sides = 1.5 * resolution * resolution;
    size.ends = BVXI_ENDS_OF_SIDE * size.sides;
    if (!is_taken(job)) return size;

    for (int a = 0; a < 3; a++) {
        side[a] = c->high[a] - c->low[a];
        longest = side[a] > longest ? side[a] : longest;
    }
    if (!(longest > 0.0)) return size;
    for (int a = 0; a < 3; a++) side[a] *= resolution / longest;
    size.sides = side[0] * side[1] + side[1] * side[2] + side[2] * side[0];
    size.ends = BVXI_ENDS_OF_AREA * c->area * (resolution / longest) * (resolution / longest);
    return size;
}

double bvxi_repair_expected_resolution(const bvxi_repair_job *job)
{
    double const most = planned_resolution(job), target = (double)job->options->target_triangles;
    double const triangles = BVXI_TRIANGLES_OF_END * bvxi_repair_expect(job, most).ends;

    /* Triangles grow as the square of the resolution. */
    return target > 0.0 && triangles > target ? most * sqrt(target / triangles) : most;
}

double bvxi_repair_fill_cost(const bvxi_repair_job *job, const bvxi_repair_size *size)
{
    double const rows = BVXI_COST_ROWS * size->triangles + BVXI_COST_ROWS_SIDE * size->sides;
    double const look = BVXI_COST_HOLES * size->triangles;

    /* How large the holes are is seen when they are joined to loops. */
    if (is_taken(job) && job->fill == BVX_FILL_PARITY && !has_open_edges(job)) return rows;
    return has_open_edges(job) ? rows + look + BVXI_COST_HOLES_SIDE * size->sides : rows + look;
}

int bvxi_repair_looks_for_walls(const bvxi_repair_job *job)
{
    return job->options->thin == BVX_THIN_KEEP || job->options->report != NULL;
}

/* Walls that an earlier resolution was too coarse for are taken for those of this one. */
double bvxi_repair_inside_cost(const bvxi_repair_job *job, const bvxi_repair_size *size)
{
    double const known = bvxi_cost_of_widening((double)job->report.thin_voxels, size->triangles, size->sides);
    double const walls = BVXI_COST_WALLS * size->triangles + BVXI_COST_WALLS_SIDE * size->sides;

    return bvxi_repair_fill_cost(job, size) + BVXI_COST_PART * size->triangles +
           BVXI_COST_CLEAN * size->ends + (bvxi_repair_looks_for_walls(job) ? walls + known : 0.0);
}

double bvxi_repair_flatten_cost(const bvxi_repair_job *job, const bvxi_repair_size *size)
{
    double const centres = (double)job->thin.near.count;

    if (job->options->thin != BVX_THIN_KEEP) return 0.0;
    if (centres > 0.0)
        return (job->report.sharp ? 2.0 : 1.0) *
               (BVXI_COST_FLATTEN * centres + BVXI_COST_FLAT_MESH * size->triangles);
    return job->inside.words == NULL ? BVXI_COST_MAYBE_THIN * size->ends : 0.0;
}

double bvxi_repair_surface_cost(const bvxi_repair_job *job, const bvxi_repair_size *size)
{
    int const sharp = is_taken(job) ? job->report.sharp : job->options->sharp > 0;

    return BVXI_COST_MEASURE_MESH * size->triangles + BVXI_COST_MEASURE * size->ends +
           bvxi_cost_of_surface(size->ends, size->triangles, sharp);
}
