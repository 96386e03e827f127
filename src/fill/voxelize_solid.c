/* voxelize_solid.c - the voxels whose centres lie inside a mesh: bvx_voxelize_solid and its rules.
 *
 * Everything is checked first. Then the rule fills the grid (solid.c for rows, winding.c, vote.c, flood.c,
 * below.c; regions here), the shell is added, and a report says what was lost. */
#include "components/room.h"
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
    if ((o->fill != BVX_FILL_FLOOD && o->fill != BVX_FILL_REGIONS) ||
        memcmp(window->size, lattice->dims, sizeof window->size) == 0)
        return BVX_OK;
    return bvxi_fail_for(
        ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
        "%s: the rule %s needs the whole lattice, as what lies in the window depends on what "
        "lies outside; the rule vote takes windows",
        solid_name, o->fill == BVX_FILL_FLOOD ? "flood" : "regions");
}

/* ---- The rules ---- */

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

/* Every region that the conservative surface leaves is inside or outside as a whole.
 *
 * Source: the interior fill of Chen, Qiu, Fu, Ma. Fast voxelization based on triangulated irregular network
 * model. 2010, section 3, with a seed for every region in place of one, and each seed's side decided by the
 * exact rule.
 *
 * A conservative surface lets no path between face neighbours through, so on a mesh without holes all
 * centres of a region lie on one side, and those on which the three axes agree say on which. A single wrong
 * row is outvoted by its region. Where a hole joins inside and outside the region has both; then each
 * centre keeps its own vote.
 * Guarantee: exact, global. */

enum { REGION_SURE_IN = 1, REGION_SURE_OUT = 2 };

typedef struct region_work {
    const uint64_t *sure;
    bvx_grid *solid;
    uint8_t *sides; /* by region: sides on which it has sure centres */
    bvx_solid_report *report;
} region_work;

/* For bvxi_spaces_each, one run after another: both sides of a region are known after its last run only. */
static void look_at_run(void *user, uint32_t region, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    region_work *const w = user;
    const uint64_t *const in = bvxi_grid_row(w->solid, y, z), *const sure = w->sure + (in - w->solid->words);
    uint8_t *const sides = w->sides + region;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6 && *sides != (REGION_SURE_IN | REGION_SURE_OUT); k++) {
        uint64_t const known = sure[k] & bvxi_run_mask(begin, end, k);
        if ((known & in[k]) != 0) *sides |= REGION_SURE_IN;
        if ((known & ~in[k]) != 0) *sides |= REGION_SURE_OUT;
    }
}

static void settle_run(void *user, uint32_t region, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    region_work *const w = user;
    uint64_t *const row = bvxi_grid_row(w->solid, y, z);

    if (w->sides[region] == REGION_SURE_IN) {
        bvxi_set_run(row, begin, end);
    } else if (w->sides[region] == REGION_SURE_OUT) {
        for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] &= ~bvxi_run_mask(begin, end, k);
    } else {
        /* Both sides, or neither: centres keep their own votes. */
        w->report->mixed_voxels += (uint64_t)(end - begin);
    }
}

static bvx_status settle_regions(bvx_context *ctx, const bvx_grid *surface, const uint64_t *sure,
                                 bvx_grid *solid, bvx_solid_report *report)
{
    region_work work = {sure, solid, NULL, report};
    bvxi_spaces spaces;

    BVXI_TRY(bvxi_spaces_open(ctx, solid_name, "regions", surface, 1, BVXI_CONNECT_6, &spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, spaces.count, "the regions' sides", &work.sides));
    bvxi_spaces_each(&spaces, look_at_run, &work);
    bvxi_spaces_each(&spaces, settle_run, &work);
    report->regions = spaces.count;
    for (uint64_t r = 0; r < spaces.count; r++)
        report->mixed_regions += work.sides[r] != REGION_SURE_IN && work.sides[r] != REGION_SURE_OUT;
    return BVX_OK;
}

static bvx_status fill_by_rule(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_voxelize_options *o,
                               const bvxi_holes *holes, bvx_grid *solid, bvx_solid_report *report)
{
    bvxi_solid_job job;

    BVXI_TRY(bvxi_solid_open(ctx, solid_name, mesh, &solid->lattice, &job));
    job.holes = holes;
    if (o->fill == BVX_FILL_PARITY || o->fill == BVX_FILL_NONZERO)
        return bvxi_solid_fill(bvxi_solid_step(ctx, &job, 0.1, 1.0), &job, solid, 0, o->fill, report);
    if (o->fill == BVX_FILL_BELOW) {
        bvxi_solid_job second;
        if (o->second != NULL)
            BVXI_TRY(bvxi_solid_open(ctx, solid_name, o->second, &solid->lattice, &second));
        return bvxi_below(ctx, &job, o->second != NULL ? &second : NULL, o, solid, report);
    }
    if (o->fill == BVX_FILL_WINDING) return bvxi_wind(ctx, &job, solid, 0.1, 1.0, report);

    /* The fills that look at more than rows: a vote first. */
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
        BVXI_SCOPE(ctx, bvxi_vote(bvxi_solid_step(ctx, &job, 0.0, 1.0), &job, more, solid, sure, report))));
    if (!more) return BVX_OK;

    BVXI_TRY(BVXI_SHARE(ctx, 0.6, 0.85, bvxi_shell_open(ctx, job.view, solid, &shell)));
    return BVXI_SHARE(ctx, 0.85, 1.0,
                      flood ? flood_or_fail(ctx, &walls, solid, report)
                            : settle_regions(ctx, &shell, sure, solid, report));
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
