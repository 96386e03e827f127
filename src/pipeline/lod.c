/* lod.c - a chain of meshes from one solid: bvx_build_lods.
 *
 * Source: Lian. LOD by voxelization and downsampling (docs/papers.md, 3). The solid is sampled at each
 * level's resolution (extended_function.c or coverage.c), marching cubes runs over the samples' bits
 * (march.c), and each crossed edge asks its ratio once. A level by triangle count searches the resolution: it
 * counts without making positions, guesses from triangles ~ resolution^2, and ends at neighbours of which one
 * keeps the target and the next does not. With collapse the search aims higher and edges go until the target
 * is kept (collapse.c). */
#include "grid/downsample.h"
#include "simplify/room.h"
#include "surface/march.h"

#include <math.h>

static const char lod_name[] = "bvx_build_lods";

typedef struct lod_job {
    const bvx_grid *solid;
    const bvx_lod_options *options;
    uint64_t level;
    uint64_t searched;
    int32_t position_type; /* of the level: BVX_F64 once one of the resolutions tried needed it */
} lod_job;

/* What messages call the level. */
static uint64_t level_number(const lod_job *job)
{
    return job->level + (uint64_t)job->options->first_level;
}

/* ---- what is requested ---- */

static int32_t longest_side(const bvx_grid *g)
{
    int32_t n = g->size[0];
    if (g->size[1] > n) n = g->size[1];
    if (g->size[2] > n) n = g->size[2];
    return n;
}

static const bvxi_option lod_rows[] = {
    BVXI_CHOICE(bvx_lod_options, sampling.method, BVX_LOD_EDGE_RATIO, BVX_LOD_COVERAGE),
    BVXI_WHOLE(bvx_lod_options, sampling.edge_samples, 0, 65536),
    BVXI_CHOICE(bvx_lod_options, face_rule, BVX_FACE_SEPARATE, BVX_FACE_JOIN),
    BVXI_CHOICE(bvx_lod_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_SWITCH(bvx_lod_options, local_frame),
    BVXI_WHOLE(bvx_lod_options, first_level, 0, INT32_MAX),
    BVXI_ZERO_OR(bvx_lod_options, collapse, 1.0, 64.0),
};

static bvx_status check_lod_options(bvx_context *ctx, const bvx_grid *solid, bvx_lod_options *o,
                                    uint64_t level_count)
{
    BVXI_TRY(bvxi_check_options(ctx, lod_name, o, BVXI_OPTIONS(lod_rows)));
    /* Strictly between: at either end all or nothing would be inside. */
    if (o->sampling.threshold == 0.0) o->sampling.threshold = 0.5;
    if (!(o->sampling.threshold > 0 && o->sampling.threshold < 1))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: threshold %g is not between 0 and 1", lod_name, o->sampling.threshold);
    if (o->sampling.edge_samples != 0 && o->sampling.method != BVX_LOD_EDGE_RATIO)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: edge_samples requires BVX_LOD_EDGE_RATIO", lod_name);
    /* Each way of saying how large levels are excludes the others. */
    if ((o->resolutions != NULL) + (o->axis_resolutions != NULL) + (o->target_triangles != NULL) != 1)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: give exactly one of resolutions, axis_resolutions and target_triangles",
                             lod_name);
    if (o->collapse != 0 && o->target_triangles == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: collapse requires target_triangles", lod_name);
    if (level_count == 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: no level is requested", lod_name);
    for (uint64_t l = 0; l < level_count && o->target_triangles == NULL; l++)
        /* The longest side counts for one ratio, each axis for three. */
        for (int32_t a = 0; a < 3; a++) {
            int32_t const n = o->resolutions != NULL ? longest_side(solid) : solid->size[a];
            int32_t const r = o->resolutions != NULL ? o->resolutions[l]
                                                     : o->axis_resolutions[3 * l + (uint64_t)a];
            if (r < 1 || r > n)
                return bvxi_fail_for(
                    ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                    "%s: level %i asks for a resolution of %d; 1 to %d, the grid's own, are possible",
                    lod_name, l + (uint64_t)o->first_level, (int64_t)r, (int64_t)n);
        }
    return BVX_OK;
}

/* ---- one level ---- */

typedef struct level_work {
    bvxi_downsample samples;
    bvxi_march march;
} level_work;

/* Sample and count. */
static bvx_status open_level(bvx_context *ctx, lod_job *job, int32_t resolution, int count_only,
                             level_work *w)
{
    const bvx_lod_options *const o = job->options;
    bvx_extract_options extract = {
        .face_rule = o->face_rule, .position_type = job->position_type, .local_frame = o->local_frame};
    bvxi_downsample_by by = {.threshold = o->sampling.threshold, .edge_samples = o->sampling.edge_samples};

    memset(w, 0, sizeof *w);
    w->march.function = lod_name;

    /* Samples first; the march over their bits asks for ratios at crossed edges only: n/r of each axis, one for
     * all from the longest side, or each axis its own. */
    for (int32_t a = 0; a < 3; a++) {
        by.n[a] = o->axis_resolutions != NULL ? job->solid->size[a] : longest_side(job->solid);
        by.r[a] = o->axis_resolutions != NULL ? o->axis_resolutions[3 * job->level + (uint64_t)a]
                                              : resolution;
    }
    BVXI_TRY(bvxi_downsample_open(ctx, lod_name, job->solid, &by, &w->samples));
    if (o->sampling.method == BVX_LOD_EDGE_RATIO) BVXI_TRY(bvxi_extended_sample(ctx, &w->samples));
    else BVXI_TRY(bvxi_coverage_sample(ctx, &w->samples, !count_only));
    w->march.ratio = o->sampling.method == BVX_LOD_EDGE_RATIO ? bvxi_extended_ratio : bvxi_coverage_ratio;
    w->march.ratio_user = &w->samples;
    BVXI_TRY(bvxi_march_open(ctx, &w->march, &w->samples.coarse, &extract));
    /* One try with doubles: all that follow are compared with it. */
    if (w->march.options.position_type == BVX_F64) job->position_type = BVX_F64;
    return BVX_OK;
}

static bvx_status count_level(bvx_context *ctx, lod_job *job, int32_t resolution, uint64_t *triangles)
{
    level_work w;
    bvx_status const status = BVXI_SCOPE(ctx, open_level(ctx, job, resolution, 1, &w));
    *triangles = w.march.triangle_count;
    job->searched++;
    return status;
}

/* Extract into scratch, with the positions that the level will have; collapse to the target. */
static bvx_status fill_collapsed(bvx_context *ctx, const lod_job *job, bvxi_march *march, bvx_mesh *mesh)
{
    uint64_t const vertex_bytes = march->options.position_type == BVX_F64 ? 24 : 12;
    bvx_mesh fine = {.position_type = march->options.position_type,
                     .vertex_capacity = march->vertex_count,
                     .triangle_capacity = march->triangle_count};

    /* Scratch: the caller gets the collapsed mesh only. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, fine.vertex_capacity * vertex_bytes,
                        "the positions before collapse", &fine.positions));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, fine.triangle_capacity * 12, "the triangles before collapse",
                        &fine.triangles));
    BVXI_TRY(bvxi_march_fill(ctx, march, &fine));

    /* Collapse the edges of a level that was made with more triangles than it may have. */
    uint64_t const target = job->options->target_triangles[job->level];
    bvx_mesh_view view;
    bvxi_level_chain chain = {
        .function = lod_name,
        .original = &view,
        .targets.triangles = &target,
        .halve_from = fine.triangle_count,
        .collapse = {.given.position_type = fine.position_type, .even = BVXI_EVEN, .simple = 1},
        .count = 1,
        .levels = mesh};

    bvx_mesh_view_of(&fine, &view);
    BVXI_TRY(bvxi_levels_make(ctx, &chain, &view, NULL));
    if (mesh->triangle_count > target)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TARGET,
                             "%s: level %i asks for at most %u triangles; collapsing its %u ends at %u",
                             lod_name, level_number(job), target, fine.triangle_count, mesh->triangle_count);
    memcpy(mesh->frame, fine.frame, sizeof mesh->frame);
    return BVX_OK;
}

/* ---- the resolution for a triangle count ---- */

/* Where triangles ~ resolution^2 puts the target between two resolutions;
 * the middle when that has stopped helping. */
static int32_t guess_between(int32_t low, uint64_t low_count, int32_t high, uint64_t high_count,
                             uint64_t target, uint64_t tries)
{
    double const a = sqrt((double)low_count), b = sqrt((double)high_count), t = sqrt((double)target);
    /* Six tries by the square law, then by bisection, which always ends. */
    int32_t guess = low + (high - low) / 2;
    if (tries < 6 && b > a) guess = low + (int32_t)((double)(high - low) * ((t - a) / (b - a)));
    return guess <= low ? low + 1 : guess >= high ? high - 1 : guess;
}

/* Where bisection ends at nothing, as with a sheet that only some resolutions meet: the largest below that
 * keeps something within the target, or 0. */
static bvx_status search_downwards(bvx_context *ctx, lod_job *job, uint64_t target, int32_t from,
                                   int32_t *resolution, uint64_t *seen)
{
    /* One by one: counts do not fall evenly there. */
    for (int32_t r = from - 1; r > 0; r--) {
        uint64_t count;
        BVXI_TRY(count_level(ctx, job, r, &count));
        *resolution = r;
        if (count != 0 && count <= target) return BVX_OK;
        *seen += count;
    }
    *resolution = 0;
    return BVX_OK;
}

static bvx_status search_resolution(bvx_context *ctx, lod_job *job, int32_t *resolution)
{
    uint64_t const asked = job->options->target_triangles[job->level];
    double const collapse = job->options->collapse, more = (double)asked * collapse;
    /* More than asked where edges collapse afterwards. */
    uint64_t const target = collapse == 0 ? asked : more < 4e9 ? (uint64_t)more : UINT32_MAX;
    /* low keeps the target, high does not (or is no resolution) */
    int32_t low = 0, high = longest_side(job->solid) + 1;
    uint64_t low_count = 0, high_count = 0, tries = 0;
    int32_t guess = high - 1 < 32 ? high - 1 : 32;

    job->searched = 0;
    while (high - low > 1) {
        uint64_t count;
        BVXI_TRY(count_level(ctx, job, guess, &count));
        /* Within the target: from here upwards. */
        if (count <= target) {
            low = guess;
            low_count = count;
        } else {
            high = guess;
            high_count = count;
        }
        if (high_count != 0 || low == 0) {
            guess = guess_between(low, low_count, high, high_count, target, tries++);
        } else { /* nothing above yet: from here outwards, a little beyond the guess to find the other side */
            double const scale = sqrt((double)target / (double)(low_count != 0 ? low_count : 1)) * 1.03;
            double const next = (double)low * (scale < 2 ? scale : 2) + 1;
            guess = next < (double)high ? (int32_t)next : high - 1;
            if (guess <= low) guess = low + 1;
        }
    }
    /* Nothing below, something above: single resolutions may still do. */
    if (low_count == 0 && high_count != 0)
        BVXI_TRY(search_downwards(ctx, job, target, high, &low, &high_count));
    if (low == 0 && high_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: level %i keeps nothing of the solid at any resolution",
                         lod_name, level_number(job));
    if (low == 0)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TARGET,
            "%s: level %i asks for at most %u triangles; none of the resolutions tried keeps anything in so "
            "few",
            lod_name, level_number(job), asked);
    *resolution = low;
    return BVX_OK;
}

static bvx_status make_lod(bvx_context *ctx, lod_job *job, bvx_mesh *mesh)
{
    const bvx_lod_options *const o = job->options;
    int32_t resolution = o->resolutions != NULL ? o->resolutions[job->level] : 0;
    level_work w;

    job->position_type = o->position_type;
    if (o->target_triangles != NULL) BVXI_TRY(search_resolution(ctx, job, &resolution));
    BVXI_TRY(open_level(ctx, job, resolution, 0, &w));

    /* Nothing at all would look like success. */
    if (w.march.triangle_count == 0)
        return bvxi_fail(
            ctx, BVX_ERR_EMPTY,
            "%s: level %i, %d x %d x %d samples, keeps nothing of the solid; take more samples for it, or a "
            "lower threshold",
            lod_name, level_number(job), (int64_t)w.samples.axis[0].count, (int64_t)w.samples.axis[1].count,
            (int64_t)w.samples.axis[2].count);
    BVXI_TRY(job->options->collapse != 0 ? fill_collapsed(ctx, job, &w.march, mesh)
                                         : bvxi_march_fill(ctx, &w.march, mesh));
    if (o->reports == NULL) return BVX_OK;

    bvx_lod_report *const report = &o->reports[job->level];
    memset(report, 0, sizeof *report);
    for (int32_t a = 0; a < 3; a++) {
        report->resolution[a] = w.samples.axis[a].count;
        report->ratio[a] = (double)w.samples.axis[a].n / w.samples.axis[a].r;
    }
    report->vertices = mesh->vertex_count;
    report->triangles = mesh->triangle_count;
    report->searched = job->searched;
    return BVX_OK;
}

static bvx_status run_build_lods(bvx_context *context, const bvx_grid *solid, const bvx_lod_options *options,
                                 uint64_t level_count, bvx_mesh *levels)
{
    bvx_lod_options o;
    bvx_status status = BVX_OK;

    if (levels == NULL) return bvxi_fail_null(context, lod_name, "levels");
    BVXI_TRY(bvxi_take_options(context, lod_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_grid_check(context, lod_name, solid));
    BVXI_TRY(check_lod_options(context, solid, &o, level_count));
    lod_job job = {.solid = solid, .options = &o};
    for (job.level = 0; job.level < level_count && status == BVX_OK; job.level++)
        status = BVXI_SCOPE(context, make_lod(context, &job, &levels[job.level]));
    if (status == BVX_OK) return BVX_OK;
    /* what the library made goes; arrays of the caller's stay his */
    for (uint64_t l = 0; l < level_count; l++) {
        if (levels[l].owned) bvx_mesh_free(context, &levels[l]);
        else levels[l].vertex_count = levels[l].triangle_count = 0;
    }
    return status;
}

bvx_status bvx_build_lods(bvx_context *context, const bvx_grid *solid, const bvx_lod_options *options,
                          uint64_t level_count, bvx_mesh *levels)
{
    return BVXI_CALL(context, run_build_lods(context, solid, options, level_count, levels));
}
