/* voxelize_solid.c - the voxels whose centres lie inside a mesh: bvx_voxelize_solid and its rules.
 *
 * Everything is checked first. Then the rule fills the grid (solid.c for rows, winding.c, vote.c, flood.c,
 * regions.c, below.c), the shell is added, and a report says what was
 * lost. */
#include "fill/fills.h"
#include "fill/thin_walls.h"
#include "touch/surface_voxels.h"

#include <math.h>

static const char solid_name[] = "bvx_voxelize_solid";

/* ---- What is asked ---- */

static bvx_status refuse_for_rule(bvx_context *ctx, const char *option, const char *rule)
{
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION, "%s: %s requires the rule %s",
                         solid_name, option, rule);
}

static const bvxi_option voxelize_rows[] = {
    BVXI_CHOICE(bvx_voxelize_options, fill, 0, BVX_FILL_WINDING),
    BVXI_SWITCH(bvx_voxelize_options, has_base),
    BVXI_WHOLE(bvx_voxelize_options, close_gaps, 0, BVXI_MOST_GAP),
    BVXI_SWITCH(bvx_voxelize_options, add_shell),
    BVXI_CHOICE(bvx_voxelize_options, check_thin, BVX_CHECK_AUTO, BVX_CHECK_ALWAYS),
    BVXI_CHOICE(bvx_voxelize_options, up, BVX_UP_Z, BVX_UP_Y),
};

static bvx_status check_choices(bvx_context *ctx, bvx_voxelize_options *o)
{
    /* Options are held to the rule that they belong to, so that none is ignored without a word. */
    int const below = o->fill == BVX_FILL_BELOW;

    BVXI_TRY(bvxi_check_options(ctx, solid_name, o, BVXI_OPTIONS(voxelize_rows)));
    /* Not a number compares unequal to itself. */
    if (o->base != o->base)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_FINITE, "%s: base is not a number",
                             solid_name);
    if (o->close_gaps != 0 && o->fill != BVX_FILL_FLOOD) return refuse_for_rule(ctx, "close_gaps", "flood");
    if (o->up != BVX_UP_Z && !below) return refuse_for_rule(ctx, "up", "below");
    if (o->has_base && !below) return refuse_for_rule(ctx, "base", "below");
    if (o->second != NULL && !below) return refuse_for_rule(ctx, "second", "below");
    if (o->check_thin == BVX_CHECK_ALWAYS && below)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: check_thin is for bodies, not for the rule below", solid_name);
    if (o->add_shell && below)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: the rule below has no shell to add", solid_name);
    return BVX_OK;
}

static bvx_status check_arguments(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                  const bvx_voxelize_options *given, bvx_voxelize_options *o,
                                  bvx_window *window)
{
    BVXI_TRY(bvxi_take_options(ctx, solid_name, given, o, sizeof *o));
    BVXI_TRY(check_choices(ctx, o));
    BVXI_TRY(bvxi_view_check(ctx, solid_name, mesh));
    if (mesh->triangle_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", solid_name);
    if (o->second != NULL) {
        BVXI_TRY(bvxi_view_check(ctx, solid_name, o->second));
        if (o->second->triangle_count == 0)
            return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the second mesh has no triangles", solid_name);
    }
    BVXI_TRY(bvxi_lattice_check(ctx, solid_name, lattice));
    BVXI_TRY(bvxi_window_take(ctx, solid_name, lattice, &o->window, window));

    /* Other rules see only what lies in a row. */
    if (o->fill != BVX_FILL_FLOOD && o->fill != BVX_FILL_REGIONS) return BVX_OK;
    for (int32_t a = 0; a < 3; a++)
        if (window->size[a] != lattice->dims[a])
            return bvxi_fail_for(
                ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                "%s: the rule %s needs the whole lattice, as what lies in the window depends on what lies "
                "outside; "
                "the rule vote takes windows",
                solid_name, o->fill == BVX_FILL_FLOOD ? "flood" : "regions");
    return BVX_OK;
}

/* ---- The rules ---- */

static bvx_status fill_below(bvx_context *ctx, bvxi_solid_job *job, const bvx_voxelize_options *o,
                             bvx_grid *solid, bvx_solid_report *report)
{
    bvxi_solid_job second;

    if (o->second == NULL) return bvxi_below(ctx, job, NULL, o, solid, report);
    BVXI_TRY(bvxi_solid_open(ctx, solid_name, o->second, &solid->lattice, &second));
    return bvxi_below(ctx, job, &second, o, solid, report);
}

static bvx_status flood_or_fail(bvx_context *ctx, const bvxi_flood_walls *walls, bvx_grid *solid,
                                bvx_solid_report *report)
{
    int32_t leaked = 0;

    BVXI_TRY(bvxi_flood(ctx, solid_name, walls, solid, report, &leaked));
    if (!leaked) return BVX_OK;
    return bvxi_fail(
        ctx, BVX_ERR_EMPTY,
        "%s: the flood reached every centre off the surface, also %u that are surely inside: the surface has "
        "holes or "
        "leaves the lattice; close gaps of more than %d voxels, or use the rule regions or vote",
        solid_name, report->leaks, (int64_t)walls->close_gaps);
}

/* The fills that look at more than rows: a vote first. */
static bvx_status fill_by_vote(bvx_context *ctx, bvxi_solid_job *job, const bvx_voxelize_options *o,
                               bvx_grid *solid, bvx_solid_report *report)
{
    uint64_t const bytes = bvxi_grid_words(solid) * 8;
    int const more = o->fill != BVX_FILL_VOTE, flood = o->fill == BVX_FILL_FLOOD;
    double const voted = more ? 0.6 : 1.0; /* of the bar; snapping takes a tenth */
    uint64_t *sure = NULL;
    bvx_grid shell = {0};
    bvxi_flood_walls walls = {&shell, NULL, o->close_gaps};

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the grid of sure centres", &sure));
    walls.sure = sure;
    BVXI_TRY(BVXI_SHARE(
        ctx, 0.1, voted,
        BVXI_SCOPE(ctx, bvxi_vote(bvxi_solid_step(ctx, job, 0.0, 1.0), job, more, solid, sure, report))));
    if (!more) return BVX_OK;

    BVXI_TRY(BVXI_SHARE(ctx, 0.6, 0.85, bvxi_shell_open(ctx, job->view, solid, &shell)));
    return BVXI_SHARE(ctx, 0.85, 1.0,
                      flood ? flood_or_fail(ctx, &walls, solid, report)
                            : bvxi_regions(ctx, solid_name, &shell, sure, solid, report));
}

static bvx_status fill_by_rule(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_voxelize_options *o,
                               const bvxi_holes *holes, bvx_grid *solid, bvx_solid_report *report)
{
    bvxi_solid_job job;

    BVXI_TRY(bvxi_solid_open(ctx, solid_name, mesh, &solid->lattice, &job));
    job.holes = holes;
    if (o->fill == BVX_FILL_PARITY || o->fill == BVX_FILL_NONZERO)
        return bvxi_solid_fill(bvxi_solid_step(ctx, &job, 0.1, 1.0), &job, solid, 0, o->fill, report);
    if (o->fill == BVX_FILL_BELOW) return fill_below(ctx, &job, o, solid, report);
    if (o->fill == BVX_FILL_WINDING) return bvxi_wind(ctx, &job, solid, 0.1, 1.0, report);
    return fill_by_vote(ctx, &job, o, solid, report);
}

bvx_status bvxi_fill_known(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t fill, const bvxi_holes *holes,
                           bvx_grid *solid)
{
    bvx_voxelize_options const o = {.fill = fill};
    bvx_solid_report unused = {0};

    return BVXI_SCOPE(ctx, fill_by_rule(ctx, mesh, &o, holes, solid, &unused));
}

/* A bvxi_fill_by_name_fn. */
static bvx_status fill_chosen(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t fill, bvx_grid *solid,
                              bvx_solid_report *report)
{
    bvx_voxelize_options const o = {.fill = fill};

    return BVXI_SCOPE(ctx, fill_by_rule(ctx, mesh, &o, NULL, solid, report));
}

/* ---- What comes after ---- */

static bvx_status add_the_shell(bvx_context *ctx, const bvx_mesh_view *mesh, bvx_grid *solid)
{
    uint64_t const words = bvxi_grid_words(solid);
    bvx_grid shell;
    BVXI_TRY(bvxi_shell_open(ctx, mesh, solid, &shell));

    for (uint64_t i = 0; i < words; i++) solid->words[i] |= shell.words[i];
    return BVX_OK;
}

#define FINER_CLOSE 0.004 /* of a volume: nearer to what lines of centres see no look is worth it */
#define FINER_WORDS (UINT64_C(1) << 24)

/* The same of a lattice of half the spacing, on which the mesh is snapped as on this one. */
static bvx_status see_finer_volume(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                                   const bvx_lattice *lattice, int32_t fill, double *volume)
{
    bvx_voxelize_options const o = {.struct_size = sizeof o, .fill = fill, .check_thin = BVX_CHECK_NEVER};
    bvx_lattice half = *lattice;
    bvx_grid solid = {0};
    bvxi_walls walls = {.ctx = ctx, .function = function, .mesh = mesh, .solid = &solid};
    uint64_t voxels;

    for (int a = 0; a < 3; a++) {
        half.spacing[a] *= 0.5;
        half.dims[a] *= 2;
    }
    half.fraction_bits--;
    solid.word_capacity = bvx_grid_bound(&half, NULL);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, solid.word_capacity * 8, "a finer solid", &solid.words));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.5, bvx_voxelize_solid(ctx, mesh, &half, &o, &solid)));
    BVXI_TRY(bvx_grid_count(ctx, &solid, &voxels));
    BVXI_TRY(bvxi_walls_open(&walls));
    BVXI_TRY(BVXI_SHARE(ctx, 0.5, 1.0, bvxi_walls_mark(&walls)));
    *volume = bvxi_volume_by_crossings(&walls,
                                       (double)voxels * half.spacing[0] * half.spacing[1] * half.spacing[2]);
    return BVX_OK;
}

bvx_status bvxi_see_volume(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                           const bvx_lattice *lattice, int32_t fill, double made, double *volume)
{
    /* Edges and thin bars put the sums off by the square of the spacing. */
    for (int a = 0; a < 3; a++)
        if (lattice->dims[a] > BVXI_MAX_SIDE / 2) return BVX_OK;
    if (lattice->fraction_bits <= BVXI_MIN_FRACTION) return BVX_OK;
    if (!(*volume > 0.0) || bvxi_absolute(made - *volume) <= FINER_CLOSE * *volume ||
        bvx_grid_bound(lattice, NULL) > FINER_WORDS / 8)
        return BVX_OK;
    bvx_status status = BVXI_SCOPE(ctx, see_finer_volume(ctx, function, mesh, lattice, fill, volume));
    return status == BVX_ERR_BUDGET ? BVX_OK : status;
}

/* What was lost on the way, and the volume that the solid should have, seen nearer where it is in question. */
static bvx_status report_losses(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *solid,
                                const bvx_voxelize_options *o, bvx_solid_report *report)
{
    const bvx_lattice *const l = &solid->lattice;

    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.95, bvxi_solid_losses(ctx, solid_name, mesh, solid, o, report)));
    if (report->fill == BVX_FILL_BELOW) return BVX_OK;
    if (bvxi_grid_is_whole(solid) && report->mesh_volume == 0 && bvxi_solid_is_closed(report))
        BVXI_TRY(BVXI_SHARE(
            ctx, 0.95, 0.95,
            bvxi_see_volume(ctx, solid_name, mesh, l, o->fill, report->volume, &report->crossing_volume)));
    return BVXI_SHARE(ctx, 0.95, 1.0, bvxi_advise_for_volume(ctx, mesh, l, report));
}

static bvx_status run_voxelize_solid(bvx_context *context, const bvx_mesh_view *mesh,
                                     const bvx_lattice *lattice, const bvx_voxelize_options *options,
                                     bvx_grid *solid)
{
    bvx_voxelize_options o;
    bvx_solid_report report = {0};
    double filled; /* of the bar, when the rule has filled the grid */
    bvx_window window;

    if (solid == NULL) return bvxi_fail_null(context, solid_name, "solid");
    BVXI_TRY(check_arguments(context, mesh, lattice, options, &o, &window));
    bvxi_grid_renew(context, lattice, &window, solid);

    /* A copy is filled, so that the caller's grid is untouched until all has gone well. */
    bvx_grid made = *solid;
    BVXI_TRY(bvxi_grid_open(context, solid_name, lattice, &window, &made));
    report.fill = o.fill;

    filled = o.add_shell || o.report != NULL ? 0.3 : 1.0;
    bvx_status status = BVXI_SHARE(
        context, 0.0, filled,
        o.fill == BVX_FILL_AUTO ? bvxi_fill_auto(context, solid_name, mesh, fill_chosen, &made, &report)
                                : BVXI_SCOPE(context, fill_by_rule(context, mesh, &o, NULL, &made, &report)));
    if (status == BVX_OK && o.add_shell)
        status = BVXI_SHARE(context, 0.3, 0.45, BVXI_SCOPE(context, add_the_shell(context, mesh, &made)));
    if (status == BVX_OK && o.report != NULL)
        status = BVXI_SHARE(context, 0.45, 1.0, report_losses(context, mesh, &made, &o, &report));
    BVXI_TRY(bvxi_grid_put(context, status, &made, solid));
    if (o.report == NULL) return BVX_OK;
    bvxi_warn_of_solid(context, &made, &report);
    *o.report = report;
    return BVX_OK;
}

bvx_status bvx_voxelize_solid(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                              const bvx_voxelize_options *options, bvx_grid *solid)
{
    return BVXI_CALL(context, run_voxelize_solid(context, mesh, lattice, options, solid));
}
