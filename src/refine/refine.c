/* refine.c - voxels of several sizes from a mesh: bvx_refine.
 *
 * Source: Liu, Jing, Zhang, Zhao. Refinement of surface voxels by boundary states (docs/papers.md, 4).
 * Vertices are snapped once, to the last level's lattice. A grid of some level gives that and all coarser
 * ones (refine_start.c); from there the touched voxels of each level are split and their children tested
 * against their triangles (refine_level.c); at the end boundary states find what is outside (states.c).
 * Guarantee: the same tree for any threads and any start level; at the last level the uniform surface and its
 * flood. */
#include "refine/refine.h"

enum { BY_SIZE = -1 }; /* start_level, when the options are taken */

static const char bvx_refine_name[] = "bvx_refine";

/* ---- arguments ---- */

/* Levels that a base's sides leave room for; -1: not even itself. */
static int32_t levels_that_fit(const int32_t base[3])
{
    int32_t longest = 1, levels = 0;
    for (int a = 0; a < 3; a++)
        if (base[a] > longest) longest = base[a];
    /* Multiplied in two steps, so that three sides of 2^25 do not overflow 64 bits. */
    uint64_t const face = (uint64_t)base[0] * (uint64_t)base[1];
    if (face >= (uint64_t)1 << 31 || face * (uint64_t)base[2] >= (uint64_t)1 << 31) return -1;
    /* One more level doubles the longest side, which a lattice limits. */
    while (levels < BVXI_OCTREE_LEVELS && longest <= BVXI_MAX_SIDE >> (levels + 1)) levels++;
    return levels;
}

static const bvxi_option refine_rows[] = {
    BVXI_OR(bvx_refine_options, levels, WHOLE, 6, 0, 25),
    BVXI_WHOLE(bvx_refine_options, start_level, BVX_NONE, 25),
    BVXI_RESERVED(bvx_refine_options, reserved),
    BVXI_WHOLE(bvx_refine_options, outer_levels, 0, 25),
    BVXI_REAL(bvx_refine_options, tolerance, 0.0, BVXI_FINITE),
};

static bvx_status check_refine_arguments(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *base,
                                         const bvx_refine_options *given, bvx_refine_options *o)
{
    BVXI_TRY(bvxi_take_options(ctx, bvx_refine_name, given, o, sizeof *o));
    BVXI_TRY(bvxi_view_check(ctx, bvx_refine_name, mesh));
    if (mesh->triangle_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", bvx_refine_name);
    BVXI_TRY(bvxi_lattice_check(ctx, bvx_refine_name, base));

    /* Before the ranges of the options, since how many levels are possible depends on the base. */
    int32_t const most = levels_that_fit(base->dims);
    if (most < 0)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: a base of %d x %d x %d voxels; fewer than 2^31 are possible",
                             bvx_refine_name, (int64_t)base->dims[0], (int64_t)base->dims[1],
                             (int64_t)base->dims[2]);
    BVXI_TRY(bvxi_check_options(ctx, bvx_refine_name, o, BVXI_OPTIONS(refine_rows)));
    o->start_level = o->start_level == 0 ? BY_SIZE : o->start_level == BVX_NONE ? 0 : o->start_level;
    if (o->levels > most)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "%s: %d levels over a base of %d x %d x %d voxels are beyond a lattice's 2^25; %d levels fit",
            bvx_refine_name, (int64_t)o->levels, (int64_t)base->dims[0], (int64_t)base->dims[1],
            (int64_t)base->dims[2], (int64_t)most);
    if (o->start_level > o->levels)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: start_level is %d; 0 to levels (%d) are possible", bvx_refine_name,
                             (int64_t)o->start_level, (int64_t)o->levels);
    if (o->outer_levels > o->levels)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: outer_levels is %d; 0 to levels (%d) are possible", bvx_refine_name,
                             (int64_t)o->outer_levels, (int64_t)o->levels);

    /* A tolerance looks at the triangles of each voxel from the base on, so no grid replaces levels. */
    if (o->tolerance > 0 && o->start_level > 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: a tolerance starts at level 0, not %d", bvx_refine_name,
                             (int64_t)o->start_level);
    return BVX_OK;
}

static bvx_status take_refine_window(bvxi_refine_job *job, bvx_refine_options *o)
{
    static const bvx_window none = {{0, 0, 0}, {0, 0, 0}};
    job->tolerance = o->tolerance;
    for (int a = 0; a < 3; a++)
        job->step[a] = job->tree->lattice.spacing[a] /
                       (double)((int32_t)1 << job->tree->lattice.fraction_bits);

    /* All zero stands for the whole lattice. */
    if (memcmp(&o->window, &none, sizeof none) == 0) return BVX_OK;
    BVXI_TRY(bvxi_window_take(job->ctx, bvx_refine_name, &job->tree->lattice, &o->window, &o->window));

    /* Levels up to outer are split everywhere, the others in the window alone. */
    job->windowed = 1;
    job->outer = o->outer_levels;
    for (int a = 0; a < 3; a++) {
        job->low[a] = o->window.low[a];
        job->last[a] = o->window.low[a] + o->window.size[a] - 1;
    }
    return BVX_OK;
}

/* A tolerance looks at lists, so it has them from the base on; a small window needs no grid. */
static int32_t choose_start(const bvxi_refine_job *job)
{
    const bvx_octree *const tree = job->tree;
    int32_t start;
    double share = 1;

    for (int a = 0; a < 3; a++)
        share *= (double)(job->last[a] - job->low[a] + 1) / (double)tree->lattice.dims[a];
    start = job->windowed && share < 0.125 ? job->outer : tree->levels;
    if (job->tolerance > 0) return 0;
    /* One grid of the last level is the fastest way while it is small: rows of bits, no lists. */
    if (bvxi_refine_grid_words(tree, start) <= BVXI_REFINE_WHOLE_GRID / 8) return start;
    while (start > 0 && bvxi_refine_grid_words(tree, start) > BVXI_REFINE_START_GRID / 8) start--;
    return start;
}

/* ---- the work ---- */

static void drop_octets(bvxi_refine_job *job, int32_t from)
{
    for (int32_t l = BVXI_OCTREE_LEVELS - 1; l >= from; l--) {
        bvxi_octets_close(job->ctx, &job->tree->octets[l]);
        bvxi_drop(job->ctx, job->up[l]);
        job->up[l] = NULL;
    }
}

/* Levels that memory allowed, with their boundary states; leftovers of the failed step do not count. */
static bvx_status fail_at_level(bvxi_refine_job *job, int32_t made, uint64_t mark)
{
    bvx_context *const ctx = job->ctx;
    int32_t const levels = job->tree->levels;

    bvxi_refine_free_front(job, &job->front);
    bvxi_refine_free_grids(job);
    drop_octets(job, made < 0 ? 0 : made);
    (void)bvxi_scratch_end(ctx, mark, BVX_ERR_BUDGET);

    /* From the deepest level on, one is given up at a time until the boundary states would fit too: then the
     * message names a number that works, instead of leaving the caller to search. */
    for (; made >= 0; made--) {
        uint64_t const bytes = bvxi_states_bytes(job->tree, made);
        void *block;
        drop_octets(job, made);

        /* Trying is the only way to know: the allocator's limit may be the machine's. */
        if (bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the boundary states", &block) != BVX_OK) continue;
        bvxi_drop(ctx, block);
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: %d levels are beyond the memory limit; levels = %d fits",
                         bvx_refine_name, (int64_t)levels, (int64_t)made);
    }
    if (job->start > 0)
        return bvxi_fail(
            ctx, BVX_ERR_BUDGET,
            "%s: starting at a grid of level %d is beyond the memory limit; BVX_NONE for start_level takes less",
            bvx_refine_name, (int64_t)job->start);
    return bvxi_fail(ctx, BVX_ERR_BUDGET,
                     "%s: not even the base of %d x %d x %d voxels fits the memory limit", bvx_refine_name,
                     (int64_t)job->tree->base[0], (int64_t)job->tree->base[1], (int64_t)job->tree->base[2]);
}

static bvx_status run_refinement(bvxi_refine_job *job)
{
    bvx_octree *const tree = job->tree;
    int32_t made = -1;
    double const begun = job->start == tree->levels ? 0.75 : 0.25;
    double const split = job->start == tree->levels ? 0.85 : 0.8;

    uint64_t mark = bvxi_scratch_begin(job->ctx);

    /* Where the start is the last level, touching it is most of the work. */
    bvx_status status = BVXI_SHARE(job->ctx, 0.0, begun, bvxi_refine_start(job));

    while (status == BVX_OK && ++made < tree->levels) {
        mark = bvxi_scratch_begin(job->ctx);
        status = BVXI_SHARE(job->ctx, begun, split, bvxi_refine_split(job, made));
        /* its order was the last that they were requested */
        if (made == job->start) bvxi_refine_free_grids(job);
    }

    /* The lists of triangles go before the states come, so that both never need memory at the same time. */
    if (status == BVX_OK) {
        bvxi_refine_free_front(job, &job->front);
        bvxi_refine_free_grids(job);
        mark = bvxi_scratch_begin(job->ctx);
        status = BVXI_SHARE(job->ctx, split, 1.0,
                            job->windowed ? bvxi_octree_row_states(job)
                                          : bvxi_octree_states(job->ctx, tree, job->up));
    }

    /* A window has no smaller number of levels to advise: the levels about it are what was requested. */
    if (status == BVX_ERR_BUDGET && job->windowed)
        return bvxi_fail(job->ctx, BVX_ERR_BUDGET, "%s: the window at level %d is beyond the memory limit",
                         bvx_refine_name, (int64_t)tree->levels);
    return status == BVX_ERR_BUDGET ? fail_at_level(job, made < tree->levels ? made : tree->levels - 1, mark)
                                    : status;
}

static bvx_status refine_mesh(bvxi_refine_job *job, const bvx_lattice *base, bvx_refine_options *o)
{
    bvx_lattice *const last = &job->tree->lattice;
    double spacing[3];
    int32_t dims[3];
    /* Halving is exact in doubles. */
    for (int a = 0; a < 3; a++) {
        spacing[a] = base->spacing[a] / (double)((int32_t)1 << o->levels);
        dims[a] = base->dims[a] << o->levels;
    }
    BVXI_TRY(bvx_lattice_make(job->ctx, base->origin, spacing, dims, last));

    BVXI_TRY(bvxi_snap(job->ctx, bvx_refine_name, job->view, &job->tree->lattice, &job->snapped));
    BVXI_TRY(take_refine_window(job, o));

    /* A start level that was chosen, not requested, gives way to the base when memory does not allow it. */
    uint64_t const mark = bvxi_scratch_begin(job->ctx);

    job->start = o->start_level >= 0 ? o->start_level : choose_start(job);
    bvx_status status = run_refinement(job);

    /* From the base on less memory is needed: lists in place of one large grid. */
    if (status == BVX_ERR_BUDGET && o->start_level < 0 && job->start > 0) {
        drop_octets(job, 0);
        bvxi_octets_close(job->ctx, &job->tree->root);
        (void)bvxi_scratch_end(job->ctx, mark, status);
        memset(&job->front, 0, sizeof job->front);
        memset(&job->grids, 0, sizeof job->grids);
        job->start = 0;
        status = run_refinement(job);
    }
    return status;
}

static bvx_status run_refine(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *base,
                             const bvx_refine_options *options, bvx_octree **tree)
{
    bvx_refine_options o;
    bvxi_refine_job job = {.ctx = context, .view = mesh};

    if (tree == NULL) return bvxi_fail_null(context, bvx_refine_name, "tree");
    BVXI_TRY(check_refine_arguments(context, mesh, base, options, &o));

    BVXI_TRY(bvxi_alloc_zero(context, BVXI_RESULT, sizeof *job.tree, "the octree", &job.tree));
    memcpy(job.tree->base, base->dims, sizeof job.tree->base);
    job.tree->levels = o.levels;
    job.tree->row_words = bvxi_row_words(base->dims[0]);
    bvx_status const status = refine_mesh(&job, base, &o);
    if (status != BVX_OK) {
        bvx_octree_free(context, job.tree);
        return status;
    }

    /* The old tree only goes when the new one is whole: after a failure the caller still has it. */
    bvx_octree_free(context, *tree);
    *tree = job.tree;
    return BVX_OK;
}

bvx_status bvx_refine(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *base,
                      const bvx_refine_options *options, bvx_octree **tree)
{
    return BVXI_CALL(context, run_refine(context, mesh, base, options, tree));
}
