/* build_levels.c - levels of detail from any mesh: bvx_build_levels.
 *
 * The mesh is simplified as it is, since nothing is nearer to it. On request its surface is measured first: what
 * bvx_repair puts between voxels lies a hundredth of a voxel from the mesh and has its guarantee. */
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/view.h"
#include "pipeline/repair.h"
#include "simplify/room.h"

#include <math.h>

enum {
    PLAN_RATIO = 16,  /* triangles of the measured surface to one of the finest level */
    PLAN_LEAST = 256, /* voxels along the longest axis */
    PLAN_MOST = 320,
    PLAN_LOWEST = 32 /* that a memory limit leaves */
};

/* Walls are few whose keeping changes the area by at most this part. */
#define FEW_WALLS 0.01

static const char levels_name[] = "bvx_build_levels";

typedef struct levels_job {
    bvx_context *ctx;
    const bvx_mesh_view *mesh;
    const bvx_levels_options *options;
    bvxi_level_chain chain;
    bvx_levels_report report;
    bvxi_repair_facts facts; /* beside report.repair */
} levels_job;

/* ---- Checks ---- */

#define LEVELS_SHELL 2.0

static const bvxi_option levels_rows[] = {
    BVXI_TARGETS(bvx_levels_options),
    BVXI_WHOLE(bvx_levels_options, fit.resolution, 0, 1 << 24),
    BVXI_RESERVED(bvx_levels_options, fit.reserved),
    BVXI_PARTS(bvx_levels_options),
    BVXI_COLLAPSE(bvx_levels_options),
    BVXI_SWITCH(bvx_levels_options, solid),
    BVXI_AMONG(bvx_levels_options, sign, BVX_FILLS_OF_REPAIR),
    BVXI_CHOICE(bvx_levels_options, sharp, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS),
    BVXI_OR(bvx_levels_options, shell, ZERO_OR, LEVELS_SHELL, 1.5, 1e6),
};

/* Requested, or implied by an option that only a measured surface can follow. */
static int wants_solid(const bvx_levels_options *o)
{
    return o->solid || o->fit.lattice != NULL || o->fit.resolution != 0 || o->sign != BVX_FILL_AUTO ||
           o->sharp != BVX_SHARP_AUTO || o->shell != LEVELS_SHELL || o->parts.least_part != 0 ||
           o->parts.keep_largest != 0 || o->parts.least_cavity != 0 || o->parts.keep_crumbs;
}

static bvx_status check_levels_options(bvx_context *ctx, bvx_levels_options *o)
{
    const bvx_collapse *const c = &o->collapse;

    BVXI_TRY(bvxi_check_options(ctx, levels_name, o, BVXI_OPTIONS(levels_rows)));
    if (wants_solid(o) && (c->lock_border || c->locked != NULL || c->vertices != BVX_VERTICES_PLACED))
        return bvxi_fail_for(
            ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
            "%s: lock_border, locked and BVX_VERTICES_KEPT keep vertices of the mesh; solid, and "
            "the options that imply it, measure a new surface",
            levels_name);
    if (wants_solid(o) && c->attribute_weight != BVXI_WEIGHT)
        return bvxi_fail_for(
            ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
            "%s: attribute_weight is %g, and the surface that solid, and the options that imply it, "
            "measure has no attributes",
            levels_name, c->attribute_weight);
    return BVX_OK;
}

/* ---- The plan ---- */

/* Triangles of the finest level; by error the mesh's own. */
static uint64_t finest_of(const bvx_levels_options *o, uint64_t level_count, uint64_t triangles)
{
    uint64_t finest = 1;
    /* By error any triangle may be needed; without targets each level has half of the one before. */
    if (o->targets.errors != NULL) return triangles;
    if (o->targets.triangles == NULL) return triangles / 2;
    for (uint64_t i = 0; i < level_count; i++)
        if (o->targets.triangles[i] > finest) finest = o->targets.triangles[i];
    return finest;
}

/* ---- Levels ---- */

static bvx_status repair_surface(levels_job *job, int32_t resolution, int32_t thin, bvx_mesh *surface)
{
    const bvx_levels_options *const o = job->options;
    /* Positions of the surface are those of the levels. */
    bvx_repair_options r = {.struct_size = sizeof r,
                            .fit = {.lattice = o->fit.lattice, .resolution = resolution},
                            .placing = {.sharp = o->sharp, .position_type = o->collapse.position_type},
                            .sign = o->sign,
                            .shell = o->shell > 0.0 ? o->shell : BVX_NONE,
                            .parts = o->parts,
                            .thin = thin,
                            .report = &job->report.repair};

    r.parts.keep_crumbs |= o->parts.least_part != 0;
    return BVXI_SCOPE(job->ctx,
                      bvxi_repair_known(job->ctx, job->mesh, &job->report.before, &r, &job->facts, surface));
}

static int64_t twice_the_handles(const bvx_certificate *c)
{
    return 2 * (int64_t)c->components - c->euler;
}

/* The surface with its thin walls. They may have grown together with what is beside them, and a handle costs
 * a small level more than such walls are worth: without them it is measured once more where that may be
 * so. */
static bvx_status measure_surface(levels_job *job, int32_t resolution, bvx_mesh *surface)
{
    bvx_repair_report *const report = &job->report.repair;
    bvx_mesh without = {0};

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.7, repair_surface(job, resolution, BVX_THIN_KEEP, surface)));
    /* Thin walls were kept: does the surface have handles that the mesh has not? */
    const bvx_certificate *const c = &job->report.before;
    if (!(job->report.repair.thin_kept && c->closed && c->edge_manifold && c->oriented &&
          twice_the_handles(&job->report.repair.after) > twice_the_handles(c)))
        return BVX_OK;

    /* The report is written anew; the better surface's one stays. */
    bvx_repair_report with = *report;
    bvxi_repair_facts const facts = job->facts;
    uint64_t const mark = bvxi_scratch_begin(job->ctx);
    bvx_status const status = bvxi_scratch_keep(
        job->ctx, mark,
        BVXI_SHARE(job->ctx, 0.7, 1.0, repair_surface(job, resolution, BVX_THIN_SHELL, &without)));
    if (status != BVX_OK && status != BVX_ERR_EMPTY) return status;
    /* The walls are hardly any of the surface, and made handles and nothing else. */
    const bvx_certificate *const a = &with.after, *const b = &report->after;
    if (status == BVX_OK && b->components == a->components && twice_the_handles(b) < twice_the_handles(a) &&
        bvxi_absolute(a->area - b->area) <= FEW_WALLS * a->area) {
        bvx_mesh const kept = *surface;

        *surface = without;
        without = kept;
    } else {
        *report = with;
        job->facts = facts;
    }
    bvx_mesh_free(job->ctx, &without);
    return BVX_OK;
}

static bvx_status simplify_measured_at(levels_job *job, int32_t resolution)
{
    bvx_mesh surface = {0};
    bvx_mesh_view view;
    bvx_status status = BVXI_SHARE(job->ctx, 0.0, 0.7, measure_surface(job, resolution, &surface));

    if (status == BVX_OK) {
        job->report.crumbs = job->report.repair.crumbs;
        bvx_mesh_view_of(&surface, &view);
        job->report.triangles = view.triangle_count;

        job->chain.collapse.given.position_type = surface.position_type;
        job->chain.collapse.simple = 1;
        status = BVXI_SHARE(job->ctx, 0.7, 1.0, bvxi_levels_make(job->ctx, &job->chain, &view, NULL));
    }
    bvx_mesh_free(job->ctx, &surface);
    return status;
}

/* Where a memory limit refuses the lattice that was planned, a coarser one may fit: what fits is found out by
 * trying, since what the mesh itself takes is the same for all. */
static bvx_status simplify_measured(levels_job *job)
{
    const bvx_levels_options *const o = job->options;
    int32_t resolution = o->fit.resolution;
    int const is_given = o->fit.lattice != NULL || o->fit.resolution != 0;
    bvx_status status;

    /* From 256 to 320: so fine that the surface has about 16 times the triangles of the finest level. Marching cubes
     * makes about 2.6 triangles for each square of the surface as large as a voxel. */
    if (!is_given) {
        const bvx_mesh_view *const mesh = job->mesh;
        double const area = bvxi_view_area(mesh);
        double low[3], high[3], longest = 0, wanted = PLAN_LEAST;

        BVXI_TRY(bvxi_view_bounds(job->ctx, levels_name, mesh, low, high));
        for (int a = 0; a < 3; a++)
            if (high[a] - low[a] > longest) longest = high[a] - low[a];
        if (area > 0)
            wanted = sqrt(PLAN_RATIO *
                          (double)finest_of(job->options, job->chain.count, mesh->triangle_count) / 2.6 *
                          longest / area * longest);
        resolution = !(wanted > PLAN_LEAST) ? PLAN_LEAST : wanted < PLAN_MOST ? (int32_t)wanted : PLAN_MOST;
    }
    job->report.planned_resolution = resolution;
    uint64_t const mark = bvxi_scratch_begin(job->ctx);

    while ((status = bvxi_scratch_keep(job->ctx, mark, simplify_measured_at(job, resolution))) ==
               BVX_ERR_BUDGET &&
           !is_given && resolution > PLAN_LOWEST)
        resolution = resolution * 4 / 5 > PLAN_LOWEST ? resolution * 4 / 5 : PLAN_LOWEST;
    job->report.resolution = resolution;
    return status;
}

/* ---- As it is ---- */

static bvx_status levels_steps(levels_job *job)
{
    bvx_certificate *const c = &job->report.before;
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.05, bvx_mesh_check(job->ctx, job->mesh, 1, c)));
    if (c->triangles == c->degenerate)
        return bvxi_fail(job->ctx, BVX_ERR_EMPTY, "%s: none of the mesh's %u triangles has an area",
                         levels_name, job->mesh->triangle_count);
    if (job->report.solid) return BVXI_SHARE(job->ctx, 0.05, 1.0, simplify_measured(job));

    bvx_levels_report *const r = &job->report;
    bvxi_sheets_report sheets;

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.05, 1.0, bvxi_levels_make(job->ctx, &job->chain, job->mesh, &sheets)));
    r->triangles = sheets.triangles;
    r->collapsed = sheets.collapsed;
    r->doubles = sheets.doubles;
    r->turned = sheets.turned;
    r->split = sheets.split;
    r->parted = sheets.parted;
    r->cut = sheets.cut;
    memcpy(r->cut_edge, sheets.cut_edge, sizeof r->cut_edge);
    bvxi_levels_warn(job->ctx, &job->chain, &r->before, &sheets);
    return BVX_OK;
}

/* ---- What is needed ---- */

/* Say what limit the call would need, where the mesh itself is too large for the one it has. */
static bvx_status explain_budget(const levels_job *job, uint64_t used)
{
    /* What levels of the mesh itself take at most, as the header states it: by triangles and vertices. */
    uint64_t const n = job->mesh->triangle_count, finest = finest_of(job->options, job->chain.count, n);
    uint64_t bytes = (180 + 60) * n + 36 * job->report.before.boundary_edges + 400000;
    if ((job->options->targets.samples != 0 && job->options->reports != NULL) ||
        job->options->targets.errors != NULL) /* bvx_mesh_distance */
        bytes += 116 * (n + (finest < n ? finest : n));
    uint64_t const needed = used + bytes, limit = bvxi_memory_limit(job->ctx);
    /* Something else was in the way: its message stays. */
    if (job->report.solid || limit >= needed) return BVX_ERR_BUDGET;
    return bvxi_fail_for(job->ctx, BVX_ERR_BUDGET, BVX_REASON_BUDGET,
                         "%s: the memory limit of %u bytes is too small for %u triangles; %u suffice",
                         levels_name, limit, job->mesh->triangle_count, needed);
}

static void warn_of_surface(levels_job *job)
{
    bvx_levels_report *const r = &job->report;
    bvx_certificate from = r->repair.after;
    uint64_t const known = UINT64_C(1) << BVX_WARN_VOLUME | UINT64_C(1) << BVX_WARN_THICKER;

    if (r->resolution < r->planned_resolution)
        BVXI_WARN(job->ctx, BVX_WARN_LOWERED, r->planned_resolution, r->resolution);
    if (r->crumbs != 0)
        BVXI_WARN(job->ctx, BVX_WARN_CRUMBS, (double)r->crumbs, bvxi_advised(2.0 * r->resolution));
    bvxi_repair_warn(job->ctx, &r->repair, &job->facts, r->resolution,
                     job->chain.count != 0 ? job->chain.levels[0].triangle_count : 0);
    /* What the surface and edges that collapsed have lost together, where the surface alone is as it should be. */
    if (bvxi_has_own_size(&r->repair, &job->facts) &&
        r->repair.parts_dropped + r->repair.cavities_dropped == 0 && (bvxi_warned(job->ctx) & known) == 0)
        from.volume = r->repair.before.volume;
    bvxi_levels_warn(job->ctx, &job->chain, &from, NULL);
}

static bvx_status run_build_levels(bvx_context *context, const bvx_mesh_view *mesh,
                                   const bvx_levels_options *options, uint64_t level_count, bvx_mesh *levels)
{
    bvx_levels_options o;
    levels_job job = {.ctx = context, .mesh = mesh, .options = &o};
    double low[3], high[3];

    if (levels == NULL) return bvxi_fail_null(context, levels_name, "levels");
    uint64_t const used = bvx_memory_used(context);
    BVXI_TRY(bvxi_take_options(context, levels_name, options, &o, sizeof o));
    BVXI_TRY(check_levels_options(context, &o));
    BVXI_TRY(bvxi_view_check(context, levels_name, mesh));
    BVXI_TRY(bvxi_view_check_uvs(context, levels_name, mesh));
    /* No level may be the mesh itself. */
    for (uint64_t i = 0; i < level_count; i++)
        BVXI_TRY(bvxi_view_apart(context, levels_name, mesh, &levels[i]));
    bvxi_chain_take(&job.chain, mesh, &o.targets, &o.collapse);
    job.chain.function = levels_name;
    job.chain.count = level_count;
    job.chain.levels = levels;
    job.chain.reports = o.reports;
    BVXI_TRY(bvxi_levels_check(context, &job.chain));

    if (mesh->triangle_count == 0)
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", levels_name);
    BVXI_TRY(bvxi_view_bounds(context, levels_name, mesh, low, high));
    job.report.solid = wants_solid(&o);
    bvx_status status = levels_steps(&job);
    if (status != BVX_OK) bvxi_levels_drop(context, levels, level_count);
    if (status == BVX_ERR_BUDGET) status = explain_budget(&job, used);
    if (status != BVX_OK || o.report == NULL) return status;
    if (job.report.solid) warn_of_surface(&job);
    job.report.warnings = bvxi_warned(context);
    *o.report = job.report;
    return BVX_OK;
}

bvx_status bvx_build_levels(bvx_context *context, const bvx_mesh_view *mesh,
                            const bvx_levels_options *options, uint64_t level_count, bvx_mesh *levels)
{
    return BVXI_CALL(context, run_build_levels(context, mesh, options, level_count, levels));
}
