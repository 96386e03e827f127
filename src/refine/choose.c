/* choose.c - the base and the levels with which refinement takes least time: bvx_refine_choose.
 *
 * Source: the observation of Liu, Jing, Zhang, Zhao. Refinement of surface voxels by boundary states
 * (docs/papers.md, 4) that for one finest resolution there is a best pair of base and levels. Time is
 * predicted for every pair, in nanoseconds of one thread:
 *   TRIANGLE t + FINEST s(n)                  what every pair costs: t triangles, s(n) touched voxels at
 *   resolution n
 *   WORD w(base)                              the base's rows of bits, w words of 64
 *   OCTET (s(base) + .. + s(n / 8))           split voxels above the last two levels
 *   CUBE s(n / 4), or LAST s(n / 2)           split voxels of the last two levels together, or of the only
 * one A plane touches as many voxels as its three projections have squares, so s(n) is the sum of the
 * triangles' projected areas, in squares of n (of at most 65536 triangles, evenly spread), and at most the
 * lattice. With a window all but the base is as large as the window:
 *   TRIANGLE t + WINDOW_BASE s(base) + NEARBY levels t share     share of the rows that lie in base voxels
 * about the window The factors come from all pairs of four meshes of 1,280 to 871,414 triangles at 64 to 1024
 * voxels, and one at 4096.
 * Guarantee: the same choice on every machine, for any threads; its time is an estimate. */
#include "refine/refine.h"

#include <math.h>

static const char choose_name[] = "bvx_refine_choose";

enum {
    TRIANGLE_COST = 16,
    FINEST_COST = 25,
    WORD_COST = 13,
    OCTET_COST = 300,
    CUBE_COST = 12,
    LAST_COST = 60,
    WINDOW_BASE_COST = 500,
    NEARBY_COST = 80
};

enum { CHOOSE_TRIANGLES = 65536, CHOOSE_GRAIN = 8192, TOLERANCE_BASE = 8 };

typedef struct choose_job {
    const bvx_mesh_view *view;
    double scale;    /* from the world to the longest of the mesh's extents */
    double sides[3]; /* extents, in the longest one */
    /* areas of all triangles in the three projections together, in squares of the longest extent */
    double projected;
    uint64_t looked_at; /* triangles that it is estimated from */
    int32_t pieces;
    double part[256]; /* by piece */
} choose_job;

/* ---- projected areas ---- */

static double projected_area(const choose_job *job, uint64_t t)
{
    double p[3][3], u[3], v[3], area = 0;

    bvxi_view_corners(job->view, t, p);
    for (int a = 0; a < 3; a++) {
        u[a] = (p[1][a] - p[0][a]) * job->scale;
        v[a] = (p[2][a] - p[0][a]) * job->scale;
    }
    for (int a = 0; a < 3; a++) {
        /* A component of the cross product is twice the area of the projection along its axis. */
        int const b = (a + 1) % 3, c = (a + 2) % 3;
        double const twice = u[b] * v[c] - u[c] * v[b];
        area += (twice < 0 ? -twice : twice) * 0.5;
    }
    return area;
}

static void project_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    choose_job *const job = user;
    uint64_t const step = job->view->triangle_count / job->looked_at;
    double sum = 0;
    /* Evenly spread over the mesh: neighbours in a file are often neighbours in space. */
    for (uint64_t i = begin; i < end; i++) sum += projected_area(job, i * step);
    job->part[index] = sum;
}

/* ---- the model ---- */

/* Voxels along an axis at resolution n, about. */
static double side_at(const choose_job *job, int a, double n)
{
    return job->sides[a] * n > 1 ? job->sides[a] * n : 1;
}

static double touched_voxels(const choose_job *job, double n)
{
    double const plane = job->projected * n * n;
    double const all = side_at(job, 0, n) * side_at(job, 1, n) * side_at(job, 2, n);
    /* A crumpled mesh has more projected squares than the lattice has voxels. */
    return plane < all ? plane : all;
}

static double base_words(const choose_job *job, double n)
{
    return floor((side_at(job, 0, n) + BVXI_WORD_BITS - 1) / BVXI_WORD_BITS) * side_at(job, 1, n) *
           side_at(job, 2, n);
}

static double predict_whole(const choose_job *job, double base, int32_t levels)
{
    double const t = (double)job->view->triangle_count;
    double n = base, time = TRIANGLE_COST * t + WORD_COST * base_words(job, base);
    /* Levels above the last two pay for each voxel that is split. */
    for (int32_t l = 0; l + 2 < levels; l++, n *= 2) time += OCTET_COST * touched_voxels(job, n);
    if (levels > 0) time += (levels == 1 ? LAST_COST : CUBE_COST) * touched_voxels(job, n);
    /* The last two levels are one word of 64 voxels, so they are paid for once. */
    for (int32_t l = levels > 2 ? levels - 2 : 0; l < levels; l++) n *= 2;
    return time + FINEST_COST * touched_voxels(job, n);
}

static double predict_window(const choose_job *job, double base, int32_t levels, const bvx_window *window)
{
    double const t = (double)job->view->triangle_count;
    double share = 1;
    /* Rows run along x, so only y and z say which of them come near the window. */
    for (int a = 1; a < 3; a++) {
        double const about = (double)window->size[a] / (double)((int32_t)1 << levels) + 1;
        double const all = side_at(job, a, base);
        share *= about < all ? about / all : 1;
    }
    return TRIANGLE_COST * t + WINDOW_BASE_COST * touched_voxels(job, base) +
           NEARBY_COST * levels * t * share;
}

/* Voxels of the base, so that the last level has at least `resolution`. */
static int32_t base_for(int32_t resolution, int32_t levels)
{
    return (int32_t)(((int64_t)resolution + ((int64_t)1 << levels) - 1) >> levels);
}

/* Is it a base that bvx_refine takes, and not finer than the grid that it
 * starts from where the last level's is too large? */
static int base_is_possible(const choose_job *job, int32_t base, int32_t levels)
{
    double const last = (double)((int64_t)base << levels);
    double const most = base_words(job, last) > (double)BVXI_REFINE_WHOLE_GRID / 8
                            ? (double)BVXI_REFINE_START_GRID / 8
                            : 2147483648.0 / BVXI_WORD_BITS;
    return last <= BVXI_MAX_SIDE && (levels == 0 || base_words(job, base) <= most);
}

/* A tolerance keeps flat voxels as large as the base allows, and its time
 * hardly depends on the pair: a coarse base. */
static int32_t levels_for_tolerance(int32_t resolution)
{
    int32_t levels = 0;
    while (base_for(resolution, levels + 1) >= TOLERANCE_BASE) levels++;
    return levels;
}

static int32_t levels_of_least_time(const choose_job *job, int32_t resolution, const bvx_window *window)
{
    int32_t best = 0;
    double least = -1;

    for (int32_t levels = 0; levels <= BVXI_OCTREE_LEVELS && (levels == 0 || resolution >> levels > 0);
         levels++) {
        int32_t const base = base_for(resolution, levels);
        if (!base_is_possible(job, base, levels)) continue;
        double const time = window->size[0] != 0 ? predict_window(job, base, levels, window)
                                                 : predict_whole(job, base, levels);

        /* Of equal times the coarser tree of fewer levels: it came first. */
        if (least >= 0 && time >= least) continue;
        least = time;
        best = levels;
    }
    return best;
}

/* ---- the function ---- */

static bvx_status check_choose_arguments(bvx_context *ctx, const bvx_refine_options *given,
                                         bvx_refine_options *o)
{
    if (given == NULL) return bvxi_fail_null(ctx, choose_name, "options");
    BVXI_TRY(bvxi_take_options(ctx, choose_name, given, o, sizeof *o));

    /* The answer is written into the caller's struct, which an older header may have made shorter. */
    if (given->struct_size < offsetof(bvx_refine_options, start_level))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OPTIONS, "%s: options have no room for levels",
                             choose_name);
    for (int a = 0; a < 3; a++)
        if (o->window.size[a] < 0 || (o->window.size[a] == 0) != (o->window.size[0] == 0))
            return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the window's sides are %d, %d, %d", choose_name,
                             (int64_t)o->window.size[0], (int64_t)o->window.size[1],
                             (int64_t)o->window.size[2]);
    if (!(o->tolerance >= 0) || !(o->tolerance - o->tolerance == 0))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: tolerance is %g; it must be 0 or more and finite", choose_name,
                             o->tolerance);
    return BVX_OK;
}

/* The lattice of the resolution gives the extents, to a voxel; fitting it checks the mesh. */
static bvx_status measure_choice(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t resolution,
                                 choose_job *job)
{
    bvx_lattice fit;
    if (mesh != NULL && mesh->triangle_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", choose_name);
    BVXI_TRY(bvx_lattice_fit(ctx, mesh, resolution, &fit));
    job->view = mesh;
    job->scale = 1.0 / (fit.spacing[0] * resolution);
    for (int a = 0; a < 3; a++) job->sides[a] = (double)fit.dims[a] / resolution;

    /* Pieces follow from the count only, and are summed in order. */
    uint64_t const all = job->view->triangle_count;
    job->looked_at = all < CHOOSE_TRIANGLES ? all : CHOOSE_TRIANGLES;
    job->pieces = bvxi_piece_count(job->looked_at, CHOOSE_GRAIN);
    BVXI_TRY(bvxi_for_pieces(ctx, "choose", 0.0, 1.0, job->pieces, job->looked_at, project_piece, job));
    for (int32_t i = 0; i < job->pieces; i++) job->projected += job->part[i];
    job->projected *= (double)all / (double)job->looked_at;
    return BVX_OK;
}

static bvx_status run_refine_choose(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                    bvx_refine_options *options, bvx_lattice *base)
{
    bvx_refine_options o;
    choose_job job = {0};
    bvx_lattice made;

    if (base == NULL) return bvxi_fail_null(context, choose_name, "base");
    BVXI_TRY(check_choose_arguments(context, options, &o));
    BVXI_TRY(measure_choice(context, mesh, resolution, &job));
    int32_t const levels = o.tolerance > 0 ? levels_for_tolerance(resolution)
                                           : levels_of_least_time(&job, resolution, &o.window);
    BVXI_TRY(bvx_lattice_fit(context, mesh, base_for(resolution, levels), &made));

    /* Both results at once, when nothing can fail any more. */
    *base = made;
    options->levels = levels != 0 ? levels : BVX_NONE;
    return BVX_OK;
}

bvx_status bvx_refine_choose(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                             bvx_refine_options *options, bvx_lattice *base)
{
    return BVXI_CALL(context, run_refine_choose(context, mesh, resolution, options, base));
}

bvx_status bvxi_refine_estimate(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t resolution,
                                double *touched)
{
    choose_job job = {0};
    BVXI_TRY(measure_choice(ctx, mesh, resolution, &job));
    *touched = touched_voxels(&job, resolution);
    return BVX_OK;
}
