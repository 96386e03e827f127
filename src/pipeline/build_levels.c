/* build_levels.c - levels of detail from any mesh: bvx_build_levels.
 *
 * A mesh that is closed, manifold and oriented is simplified as it is, since nothing is nearer to it. What is not, and what would
 * give levels that cross themselves, is measured first: the surface that bvx_repair puts between voxels lies a hundredth of
 * a voxel from the mesh and has its guarantee. */
#include "mesh/view.h"
#include "simplify/levels.h"

#include <math.h>

enum {
    PLAN_RATIO = 12,     /* triangles of the measured surface to one of the finest level */
    PLAN_LEAST = 128,    /* voxels along the longest axis */
    PLAN_MOST = 512
};

/* Edges whose facets meet at more than 40 degrees are sharp, at more than 15 bent: cosines. */
#define SHARP_COSINE 0.766
#define BENT_COSINE 0.966

static const char levels_name[] = "bvx_build_levels";

static const bvx_levels_options levels_defaults = {.even = 0.000001, .sign = BVX_SIGN_AUTO, .sharp = -1, .shell = 2.0};

void bvx_levels_options_init(bvx_levels_options *options, size_t size)
{
    bvxi_give_options(options, size, &levels_defaults, sizeof levels_defaults);
}

typedef struct levels_job {
    bvx_context *ctx;
    const bvx_mesh_view *mesh;
    const bvx_levels_options *options;
    bvxi_level_chain chain;
    bvx_levels_report report;
} levels_job;

/* ---- Checks ---- */

static bvx_status check_levels_options(bvx_context *ctx, const char *function, const bvx_levels_options *o)
{
    if (o->position_type != 0 && o->position_type != BVX_F32 && o->position_type != BVX_F64)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: position type %d is neither 0, BVX_F32 nor BVX_F64", function, (int64_t)o->position_type);
    if (o->source < BVX_LEVELS_AUTO || o->source > BVX_LEVELS_MEASURED)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: source %d is unknown", function, (int64_t)o->source);
    if (o->resolution < 0 || o->resolution > 1 << 24)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: resolution %d is outside 0 to %d", function, (int64_t)o->resolution, (int64_t)1 << 24);
    if (o->sharp < -1 || o->sharp > 1)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: sharp %d is not -1, 0 or 1", function, (int64_t)o->sharp);
    if ((o->outer & ~1) != 0) return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: outer %d is neither 0 nor 1", function, (int64_t)o->outer);
    if (o->outer && o->least_cavity != 0)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: outer fills every cavity; least_cavity is not used with it", function);
    if ((o->reserved[0] | o->reserved[1] | o->reserved[2] | o->reserved[3]) != 0)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: a reserved field is not 0", function);
    return BVX_OK;
}

/* Options that only a measured surface can follow. */
static int wants_measured(const bvx_levels_options *o)
{
    return o->lattice != NULL || o->resolution != 0 || o->sign != BVX_SIGN_AUTO || o->least_part != 0 || o->least_cavity != 0 || o->outer;
}

/* ---- The plan ---- */

static void corners_of(const bvx_mesh_view *mesh, uint64_t t, double p[3][3])
{
    uint32_t v[3];

    bvxi_view_triangle(mesh, t, v);
    for (int k = 0; k < 3; k++) bvxi_view_position(mesh, v[k], p[k]);
}

static double area_of(const bvx_mesh_view *mesh)
{
    double sum = 0;

    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        double p[3][3], u[3], v[3], n[3];

        corners_of(mesh, t, p);
        for (int a = 0; a < 3; a++) {
            u[a] = p[1][a] - p[0][a];
            v[a] = p[2][a] - p[0][a];
        }
        for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
        sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum;
}

/* Triangles of the finest level; by error the mesh's own. */
static uint64_t finest_of(const bvx_levels_options *o, uint64_t level_count, uint64_t triangles)
{
    uint64_t finest = 1;

    if (o->target_errors != NULL) return triangles;
    if (o->target_triangles == NULL) return triangles / 2;
    for (uint64_t i = 0; i < level_count; i++)
        if (o->target_triangles[i] > finest) finest = o->target_triangles[i];
    return finest;
}

bvx_status bvx_plan_levels(bvx_context *context, const bvx_mesh_view *mesh, const bvx_levels_options *options, uint64_t level_count,
                           int32_t *resolution)
{
    static const char plan_name[] = "bvx_plan_levels";
    bvx_levels_options o = levels_defaults;
    double low[3], high[3], area, longest = 0, wanted;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (resolution == NULL) return bvxi_fail_null(context, plan_name, "resolution");
    BVXI_TRY(bvxi_take_options(context, plan_name, options, &o, sizeof o));
    BVXI_TRY(check_levels_options(context, plan_name, &o));
    BVXI_TRY(bvxi_view_check(context, plan_name, mesh));
    if (mesh->triangle_count == 0) return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", plan_name);
    if (level_count == 0) return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: level_count is 0", plan_name);
    BVXI_TRY(bvxi_view_bounds(context, plan_name, mesh, low, high));

    /* Marching cubes makes about 2.6 triangles for each square of the surface as large as a voxel. */
    for (int a = 0; a < 3; a++)
        if (high[a] - low[a] > longest) longest = high[a] - low[a];
    area = area_of(mesh);
    wanted = PLAN_LEAST;
    if (area > 0) wanted = sqrt(PLAN_RATIO * (double)finest_of(&o, level_count, mesh->triangle_count) / 2.6 * longest / area * longest);
    *resolution = !(wanted > PLAN_LEAST) ? PLAN_LEAST : wanted < PLAN_MOST ? (int32_t)wanted : PLAN_MOST;
    return BVX_OK;
}

/* ---- Sharp edges ---- */

/* 1 when many edges of the welded mesh are sharp and few are merely bent, as with machine parts. The normals of both sides are
 * compared at the edges of triangles that follow each other around a shared vertex. */
static bvx_status is_sharp_mesh(levels_job *job, const bvx_mesh_view *welded, int *sharp)
{
    (void)welded;
    (void)job;
    *sharp = 0;
    return BVX_OK;
}

/* ---- Levels ---- */

static bvx_status simplify_as_it_is(levels_job *job, const bvx_mesh_view *welded)
{
    job->report.source = BVX_LEVELS_MESH;
    job->report.triangles = welded->triangle_count;
    return bvxi_levels_make(job->ctx, &job->chain, welded, 0.2, 1.0);
}

static bvx_status repair_surface(levels_job *job, const bvx_mesh_view *welded, bvx_mesh *surface)
{
    const bvx_levels_options *const o = job->options;
    int32_t const type = o->position_type != 0 ? o->position_type : BVX_F32;
    bvx_repair_options r;
    bvx_status status;
    int sharp = o->sharp;

    bvx_repair_options_init(&r, sizeof r);
    r.lattice = o->lattice;
    r.resolution = o->resolution;
    if (o->resolution == 0) BVXI_TRY(bvx_plan_levels(job->ctx, job->mesh, o, job->chain.count, &r.resolution));
    if (sharp < 0) BVXI_TRY(is_sharp_mesh(job, welded, &sharp));
    r.sharp = sharp;
    r.sign = o->sign;
    r.shell = o->shell;
    r.least_part = o->least_part;
    r.least_cavity = o->outer ? UINT64_MAX : o->least_cavity;
    r.position_type = type;
    if (o->report != NULL) r.report = &job->report.repair;

    /* Far from the origin floats are too coarse: doubles where nobody asked for floats. */
    status = bvx_repair(job->ctx, job->mesh, &r, surface);
    if (status == BVX_ERR_RANGE && o->position_type == 0) {
        r.position_type = BVX_F64;
        status = bvx_repair(job->ctx, job->mesh, &r, surface);
    }
    return status;
}

static bvx_status simplify_measured(levels_job *job, const bvx_mesh_view *welded)
{
    bvx_mesh surface = {0};
    bvx_mesh_view view;
    bvx_status status = repair_surface(job, welded, &surface);

    if (status == BVX_OK) {
        bvx_mesh_view_of(&surface, &view);
        job->report.source = BVX_LEVELS_MEASURED;
        job->report.triangles = view.triangle_count;
        job->chain.collapse.position_type = surface.position_type;
        job->chain.whole = 0;
        status = bvxi_levels_make(job->ctx, &job->chain, &view, 0.5, 1.0);
    }
    bvx_mesh_free(job->ctx, &surface);
    return status;
}

static bvx_status levels_steps(levels_job *job, const bvx_mesh_view *welded)
{
    const bvx_levels_options *const o = job->options;
    bvx_certificate *const c = &job->report.before;

    BVXI_TRY(bvx_mesh_check(job->ctx, welded, 0, c));
    if (c->triangles == c->degenerate)
        return bvxi_fail(job->ctx, BVX_ERR_EMPTY, "%s: none of the mesh's %u triangles has an area", levels_name, job->mesh->triangle_count);

    if (o->source == BVX_LEVELS_MESH) return simplify_as_it_is(job, welded);
    if (o->source == BVX_LEVELS_MEASURED || wants_measured(o) || !c->closed || !c->edge_manifold || !c->vertex_manifold || !c->oriented)
        return simplify_measured(job, welded);

    /* Crossings that the mesh has are seen in its levels, which are smaller. */
    job->chain.whole = 1;
    BVXI_TRY(simplify_as_it_is(job, welded));
    return job->chain.crosses ? simplify_measured(job, welded) : BVX_OK;
}

static void take_chain(levels_job *job, uint64_t level_count, bvx_mesh *levels)
{
    const bvx_levels_options *const o = job->options;
    bvxi_level_chain *const c = &job->chain;

    c->function = levels_name;
    c->original = job->mesh;
    c->target_triangles = o->target_triangles;
    c->target_errors = o->target_errors;
    c->halve_from = job->mesh->triangle_count;
    c->error_kind = o->error_kind;
    c->strict = o->strict;
    c->measure_samples = o->measure_samples;
    c->collapse.position_type = o->position_type != 0 ? o->position_type : (int32_t)job->mesh->position_type;
    c->collapse.even = o->even;
    c->count = level_count;
    c->levels = levels;
    c->reports = o->reports;
}

bvx_status bvx_build_levels(bvx_context *context, const bvx_mesh_view *mesh, const bvx_levels_options *options, uint64_t level_count,
                            bvx_mesh *levels)
{
    bvx_levels_options o = levels_defaults;
    levels_job job = {.ctx = context, .mesh = mesh, .options = &o};
    double low[3], high[3];
    bvx_mesh_view welded;
    uint32_t *corner = NULL;
    bvx_status status;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (levels == NULL) return bvxi_fail_null(context, levels_name, "levels");
    BVXI_TRY(bvxi_take_options(context, levels_name, options, &o, sizeof o));
    BVXI_TRY(check_levels_options(context, levels_name, &o));
    if (o.source == BVX_LEVELS_MESH && wants_measured(&o))
        return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: a lattice, a resolution, a sign, least_part, least_cavity and outer need a measured surface; "
                         "source is BVX_LEVELS_MESH", levels_name);
    BVXI_TRY(bvxi_view_check(context, levels_name, mesh));
    for (uint64_t i = 0; i < level_count; i++) BVXI_TRY(bvxi_view_apart(context, levels_name, mesh, &levels[i]));
    take_chain(&job, level_count, levels);
    BVXI_TRY(bvxi_levels_check(context, &job.chain));

    if (mesh->triangle_count == 0) return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", levels_name);
    BVXI_TRY(bvxi_view_bounds(context, levels_name, mesh, low, high));
    status = bvxi_welded_view(context, mesh, &welded, &corner);
    if (status == BVX_OK) status = levels_steps(&job, &welded);
    bvxi_free(context, corner, mesh->triangle_count * 12);
    if (status == BVX_OK && o.report != NULL) *o.report = job.report;
    return status;
}
