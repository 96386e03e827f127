/* fuzz_levels.c - levels of detail of any mesh: every level is certified, of a solid it crosses nothing, else no border is
 * new, the same for
 * many threads; the plan stays within its bounds; what the report says of the input is so. */
#include "fuzz_input.h"

static void fuzz_take_options(fuzz_input *in, bvx_levels_options *o, uint64_t *targets, double *errors)
{
    *o = (bvx_levels_options){.struct_size = sizeof *o};
    for (int i = 0; i < 2; i++) {
        targets[i] = (uint64_t)fuzz_range(in, 1, 2000);
        errors[i] = fuzz_range(in, 1, 64) / 16.0;
    }
    if (fuzz_range(in, 0, 3) != 0) o->targets.triangles = targets;
    else if (fuzz_range(in, 0, 1) != 0) o->targets.errors = errors;
    o->targets.error_kind = fuzz_range(in, 0, 1);
    o->targets.samples = o->targets.errors != NULL ? 50 : 0;
    o->collapse.position_type = fuzz_range(in, 0, BVX_F64);
    if (fuzz_range(in, 0, 7) == 0) return;
    o->solid = 1;
    o->sharp = fuzz_range(in, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS);
    o->fit.resolution = fuzz_range(in, 2, 24);
    o->parts.least_cavity = fuzz_range(in, 0, 3) == 0 ? UINT64_MAX : 0;
    o->shell = fuzz_range(in, 0, 3) == 0 ? 0 : fuzz_range(in, 6, 16) / 4.0;
    if (o->parts.least_cavity == 0) o->parts.least_cavity = (uint64_t)fuzz_range(in, 0, 9);
    o->parts.least_part = (uint64_t)fuzz_range(in, 0, 9);
    o->parts.keep_largest = (uint64_t)fuzz_range(in, 0, 2);
}

static void fuzz_level(bvx_context *ctx, const bvx_mesh *level, const bvx_level_report *r, int whole)
{
    bvx_mesh_view view;
    bvx_certificate c;
    uint64_t crossings = 0;

    bvx_mesh_view_of(level, &view);
    fuzz_must(ctx, bvx_mesh_check(ctx, &view, 0, &c));
    fuzz_require(c.edge_manifold && c.oriented && c.unused_vertices == 0, "a level that is not certified");
    fuzz_require(memcmp(&c, &r->certificate, sizeof c) == 0, "a report of another level");
    fuzz_must(ctx, bvx_mesh_crossings(ctx, &view, &crossings, NULL, 0));
    fuzz_require(crossings == r->crossings, "other crossings than reported");
    if (!whole) return;
    fuzz_require(c.closed && c.vertex_manifold && c.degenerate + c.duplicates + c.collapsed == 0,
                 "a level that is not certified");
    fuzz_require(crossings == 0, "a level that crosses itself");
}

/* A plan by triangles: the finest level's samples at least, and no more than levels are made from. */
static void fuzz_plan(bvx_context *ctx, fuzz_input *in, const bvx_mesh_view *view)
{
    uint64_t const target = (uint64_t)fuzz_range(in, 1, 100000);
    int32_t planned = 0, limited = -1;
    bvx_lod_options o = {.struct_size = sizeof o};

    o.target_triangles = &target;
    o.collapse = fuzz_range(in, 0, 2) * 2;
    if (!fuzz_good(ctx, bvx_plan_lods(ctx, view, &o, 1, fuzz_range(in, 0, 4), &planned, &limited))) return;
    fuzz_require(planned >= 1 && planned <= 1 << 20 && (limited & ~1) == 0, "a plan out of its bounds");
}

static void fuzz_build(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_mesh_view *view)
{
    uint64_t targets[2];
    double errors[2];
    bvx_levels_options o;
    bvx_levels_report report, again;
    bvx_level_report reports[2];
    bvx_mesh level[2] = {{0}}, twin[2] = {{0}};
    bvx_status status;

    fuzz_take_options(in, &o, targets, errors);
    o.report = &report;
    o.reports = reports;
    status = bvx_build_levels(ctx, view, &o, 2, level);
    if (status != BVX_OK)
        fuzz_require(level[0].positions == NULL && level[1].positions == NULL, "a level behind an error");
    fuzz_require(status != BVX_ERR_ARGUMENT, bvx_last_message(ctx));
    if (!fuzz_good(ctx, status)) return;
    fuzz_require(report.solid == o.solid, "another source");
    for (int i = 0; i < 2; i++) {
        fuzz_level(ctx, &level[i], &reports[i], report.solid);
        fuzz_require(report.solid || level[i].triangle_count <= view->triangle_count,
                     "a level of more triangles than the mesh");
        /* What is closed by exact copies alone is open without them. */
        fuzz_require(report.solid || report.cut != 0 || report.doubles != 0 || !report.before.closed ||
                         reports[i].certificate.closed,
                     "a border where there was none");
    }
    o.report = &again;
    o.reports = NULL;
    fuzz_must(other, bvx_build_levels(other, view, &o, 2, twin));
    again.warnings = report.warnings; /* some are of levels' reports, which this call has not */
    fuzz_require(memcmp(&report, &again, sizeof report) == 0, "another report with more threads");
    for (int i = 0; i < 2; i++) {
        fuzz_meshes_equal(ctx, &level[i], &twin[i], "another level with more threads");
        bvx_mesh_free(other, &twin[i]);
        bvx_mesh_free(ctx, &level[i]);
    }
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);

    fuzz_take_mesh(in, &m);
    if (m.triangles > 0) {
        fuzz_build(ctx, other, in, &m.view);
        fuzz_plan(ctx, in, &m.view);
    }
    fuzz_end(ctx);
    fuzz_end(other);
}
