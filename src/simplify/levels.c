/* levels.c - a chain of levels by triangle count, by error or by halving, each continued from the one before.
 *
 * A level by error is found by going on in steps and measuring each: the last one that keeps the error is the
 * level, and the chain goes on from the first one that does not. */
#include "core/vec3.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

#include <math.h>

enum { LEVEL_ERROR_SAMPLES = 20000, LEVEL_SEED = 1 };

/* ---- Checks ---- */

bvx_status bvxi_levels_check(bvx_context *ctx, const bvxi_level_chain *c)
{
    if (c->count == 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: level_count is 0", c->function);
    if (c->targets.triangles != NULL && c->targets.errors != NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: targets.triangles and targets.errors exclude each other; set one of them",
                             c->function);

    for (uint64_t i = 0; i < c->count; i++) {
        if (c->targets.triangles != NULL && c->targets.triangles[i] == 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: targets.triangles[%i] is 0",
                                 c->function, i);
        if (c->targets.errors != NULL &&
            !(c->targets.errors[i] > 0 && c->targets.errors[i] - c->targets.errors[i] == 0))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: targets.errors[%i] is %g; it must be above 0 and finite", c->function,
                                 i, c->targets.errors[i]);
    }
    return BVX_OK;
}

void bvxi_levels_drop(bvx_context *ctx, bvx_mesh *levels, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        if (levels[i].owned) bvx_mesh_free(ctx, &levels[i]);
        else levels[i].vertex_count = levels[i].triangle_count = 0;
    }
}

/* Triangles that are wanted of level i; 0 where an error decides. After 64 halvings nothing is left to halve. */
static uint64_t target_of(const bvxi_level_chain *c, uint64_t i)
{
    if (c->targets.errors != NULL) return 0;
    if (c->targets.triangles != NULL) return c->targets.triangles[i];
    return i < 63 ? c->halve_from >> (i + 1) : 0;
}

/* ---- Measures ---- */

static bvx_status measure_level(bvx_context *ctx, bvxi_level_chain *c, const bvx_mesh *level,
                                uint64_t samples, bvx_distance_report *d)
{
    bvx_mesh_view view;
    bvx_mesh_view_of(level, &view);
    return bvxi_mesh_distance(ctx, c->original, &c->kept, &view, samples, LEVEL_SEED, d);
}

/* The smallest angle of all triangles, from the dot and the cross product of the two sides at each corner. */
static double smallest_angle(const bvx_mesh *level)
{
    bvx_mesh_view view;
    double least = BVXI_PI, least_x = 0, least_y = 0;

    bvx_mesh_view_of(level, &view);
    for (uint64_t t = 0; t < level->triangle_count; t++) {
        double p[3][3];

        for (int k = 0; k < 3; k++) bvxi_view_position(&view, level->triangles[3 * t + (uint64_t)k], p[k]);
        for (int k = 0; k < 3; k++) {
            double u[3], v[3], n[3], x, y, angle;

            for (int a = 0; a < 3; a++) {
                u[a] = p[(k + 1) % 3][a] - p[k][a];
                v[a] = p[(k + 2) % 3][a] - p[k][a];
            }
            bvxi_vec_cross(u, v, n);
            x = bvxi_vec_dot(u, v);
            y = bvxi_vec_length(n);

            /* Most are wider, by more than rounding. Not atan2, which C libraries round differently. */
            if (least_x > 0 && x * least_y < 0.999999 * least_x * y) continue;
            angle = bvxi_angle(x, y);
            if (!(angle < least)) continue;
            least = angle;
            least_x = x;
            least_y = y;
        }
    }
    return least * (180 / BVXI_PI);
}

/* The certificate and crossings of a level, by its own indices, or without seams. By error the collapse has gone
 * beyond it. */
static bvx_status certify_level(bvx_context *ctx, const bvxi_level_chain *c, bvxi_collapse *collapse,
                                const bvx_mesh *level, bvx_level_report *r)
{
    int const beyond = c->targets.errors != NULL, seams = collapse->attributes.row != NULL;
    bvx_mesh plain = {0};
    bvx_mesh_view view;

    bvx_mesh_view_of(level, &view);
    if (beyond) BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.8, bvx_mesh_crossings(ctx, &view, &r->crossings, NULL, 0)));
    else BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.8, bvxi_collapse_crossings(collapse, &r->crossings)));
    if (!beyond && seams) {
        BVXI_TRY(bvxi_collapse_give_plain(collapse, &plain));
        bvx_mesh_view_of(&plain, &view);
    }
    bvx_status const status = BVXI_SHARE(ctx, 0.8, 1.0,
                                         bvx_mesh_check(ctx, &view, beyond && seams, &r->certificate));
    bvx_mesh_free(ctx, &plain);
    return status;
}

static bvx_status report_level(bvx_context *ctx, bvxi_level_chain *c, uint64_t i, bvxi_collapse *collapse,
                               int met)
{
    if (c->reports == NULL) return BVX_OK;

    bvx_level_report *r = &c->reports[i];
    memset(r, 0, sizeof *r);
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.3, certify_level(ctx, c, collapse, &c->levels[i], r)));
    r->vertices = c->levels[i].vertex_count;
    r->triangles = c->levels[i].triangle_count;
    r->target = target_of(c, i);
    r->target_error = c->targets.errors != NULL ? c->targets.errors[i] : 0;
    r->met = met;
    r->least_angle = smallest_angle(&c->levels[i]);
    r->handles_cut = c->closed.handles;
    r->holes_filled = c->closed.holes;
    r->longest_closed = c->closed.longest;
    r->refused = collapse->counts.refused;

    /* By error the level has been measured while it was looked for. */
    r->measured = c->targets.errors != NULL || c->targets.samples != 0;
    r->distance = c->last;
    /* All bits set are no number; the samples and the seed are none. */
    if (!r->measured) memset(&r->distance, 0xff, sizeof r->distance);
    if (!r->measured) r->distance.samples = r->distance.seed = 0;
    if (c->targets.errors != NULL || c->targets.samples == 0) return BVX_OK;
    /* Measuring takes longer than all checks, so it has most of the progress. */
    return BVXI_SHARE(ctx, 0.3, 1.0, measure_level(ctx, c, &c->levels[i], c->targets.samples, &r->distance));
}

/* ---- Levels ---- */

/* The share of the error of level i that a distance takes up: 1 or less keeps it. */
static double error_share(const bvxi_level_chain *c, uint64_t i, const bvx_distance_report *d)
{
    return (c->targets.error_kind == BVX_ERROR_MEAN ? d->mean : d->max) / c->targets.errors[i];
}

/* Measure the mesh as it is now. */
static bvx_status measure_now(bvx_context *ctx, bvxi_level_chain *c, bvxi_collapse *collapse,
                              bvx_distance_report *d)
{
    uint64_t const samples = c->targets.samples != 0 ? c->targets.samples : LEVEL_ERROR_SAMPLES;
    bvx_mesh now = {0};
    bvx_status status = bvxi_collapse_give(collapse, &now);
    if (status == BVX_OK) status = measure_level(ctx, c, &now, samples, d);
    bvx_mesh_free(ctx, &now);
    return status;
}

uint64_t bvxi_collapse_next_try(uint64_t triangles, double part)
{
    double const half_way = part < 0.25 ? 0.5 : sqrt(part);
    return (uint64_t)((double)triangles * (half_way < 0.95 ? half_way : 0.95));
}

static bvx_status copy_array(bvx_context *ctx, const void *from, uint64_t bytes, void *to)
{
    void *copy;
    if (from == NULL) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, bytes, "the level's attributes", &copy));
    memcpy(copy, from, (size_t)bytes);
    memcpy(to, &copy, sizeof copy);
    return BVX_OK;
}

/* Copy a mesh into a level: into the arrays that the caller brought, or into new ones with its attributes. */
static bvx_status copy_into(bvx_context *ctx, const bvxi_level_chain *c, const bvx_mesh *mesh,
                            bvx_mesh *level)
{
    size_t const vertex_bytes = mesh->position_type == BVX_F64 ? 24 : 12;

    BVXI_TRY(bvxi_mesh_open(ctx, c->function, mesh->position_type, 0, mesh->vertex_count,
                            mesh->triangle_count, level));
    memcpy(level->positions, mesh->positions, (size_t)mesh->vertex_count * vertex_bytes);
    memcpy(level->triangles, mesh->triangles, (size_t)mesh->triangle_count * 12);
    if (level->owned != 1) return BVX_OK;
    level->uv_count = mesh->uv_count;
    BVXI_TRY(copy_array(ctx, mesh->colours, level->vertex_capacity * 4, &level->colours));
    BVXI_TRY(copy_array(ctx, mesh->normals, level->vertex_capacity * 12, &level->normals));
    BVXI_TRY(copy_array(ctx, mesh->uvs2, level->vertex_capacity * 8, &level->uvs2));
    BVXI_TRY(copy_array(ctx, mesh->uvs, mesh->uv_count * 8, &level->uvs));
    BVXI_TRY(copy_array(ctx, mesh->uv_triangles, level->triangle_capacity * 12, &level->uv_triangles));
    return copy_array(ctx, mesh->materials, level->triangle_capacity * 4, &level->materials);
}

/* The last mesh on the way down that keeps the error of level i. Where none does: the level before, which a
 * step too far has left behind, or of the first level the mesh as it is. Errors grow about as triangles become
 * fewer, so the level is far while its share of the triangles is small. */
static bvx_status find_by_error(bvx_context *ctx, bvxi_level_chain *c, uint64_t i, bvxi_collapse *collapse,
                                bvx_mesh *found, int *met)
{
    uint64_t before;
    bvx_distance_report d;
    double part, at = 0.0;

    *met = 0;
    /* A measured surface may have more triangles than the mesh. */
    if (collapse->mesh.left > c->halve_from) BVXI_TRY(bvxi_collapse_to(collapse, c->halve_from, 0.0, 0.0));
    do {
        /* Half of what is left of the bar a try: how many there will be is not known. */
        double const measured = at + 0.4 * (1.0 - at), collapsed = at + 0.5 * (1.0 - at);
        bvx_mesh made = {0};
        bvx_status status;

        BVXI_TRY(BVXI_SHARE(ctx, at, measured, measure_now(ctx, c, collapse, &d)));
        part = error_share(c, i, &d);
        /* The mesh before kept the error and this one does not. */
        if (part > 1 && *met) break;
        if (part > 1 && i != 0) {
            *met = error_share(c, i, &c->last) <= 1;
            return copy_into(ctx, c, &c->levels[i - 1], found);
        }

        /* A collapse cannot be undone, so what may be the level is copied before the next step. */
        status = bvxi_collapse_give(collapse, &made);
        if (status != BVX_OK) {
            bvx_mesh_free(ctx, &made);
            return status;
        }
        bvx_mesh_free(ctx, found);
        *found = made;
        *met = part <= 1;
        c->last = d;
        c->closed = collapse->closed;
        if (!*met) break;

        before = collapse->mesh.left;
        BVXI_TRY(BVXI_SHARE(ctx, measured, collapsed,
                            bvxi_collapse_to(collapse, bvxi_collapse_next_try(before, part), 0.0, 1.0)));
        at = collapsed;
    } while (collapse->mesh.left < before);
    return BVX_OK;
}

/* Hand the mesh that was found over to a level: as it is, or into arrays of the caller's. */
static bvx_status hand_over(bvx_context *ctx, bvxi_level_chain *c, uint64_t i, bvxi_collapse *collapse,
                            bvx_mesh *made, int *met)
{
    bvx_mesh *const level = &c->levels[i];

    BVXI_TRY(find_by_error(ctx, c, i, collapse, made, met));
    if (level->owned == 1) bvx_mesh_free(ctx, level);
    if (level->positions != NULL || level->triangles != NULL) return copy_into(ctx, c, made, level);
    *level = *made;
    memset(made, 0, sizeof *made);
    return BVX_OK;
}

static bvx_status make_by_error(bvx_context *ctx, bvxi_level_chain *c, uint64_t i, bvxi_collapse *collapse,
                                int *met)
{
    bvx_mesh found = {0};
    bvx_status const status = hand_over(ctx, c, i, collapse, &found, met);
    bvx_mesh_free(ctx, &found);
    return status;
}

static bvx_status make_level(bvx_context *ctx, bvxi_level_chain *c, uint64_t i, bvxi_collapse *collapse)
{
    /* The level's share of the progress: what a report costs beside it. */
    double const made = c->reports == NULL ? 1.0 : c->targets.samples == 0 ? 0.9 : 0.7;
    int met = 0;

    if (c->targets.errors != NULL) {
        BVXI_TRY(BVXI_SHARE(ctx, 0.0, made, make_by_error(ctx, c, i, collapse, &met)));
    } else {
        uint64_t const wanted = target_of(c, i), target = wanted < c->halve_from ? wanted : c->halve_from;
        BVXI_TRY(BVXI_SHARE(ctx, 0.0, made, bvxi_collapse_to(collapse, target, 0.0, 1.0)));
        met = collapse->mesh.left <= wanted;
        c->closed = collapse->closed;
        BVXI_TRY(bvxi_collapse_give(collapse, &c->levels[i]));
    }
    /* By count the collapse went as far as it could; by error it had nothing to take back. */
    if (c->targets.strict && !met) {
        if (c->targets.errors != NULL)
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TARGET,
                "%s: level %i cannot keep its target: what it is made from is off by more than %g already",
                c->function, i, c->targets.errors[i]);
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TARGET,
            "%s: level %i cannot keep its target: %u triangles are the fewest that keep the guarantee",
            c->function, i, c->levels[i].triangle_count);
    }
    return BVXI_SHARE(ctx, made, 1.0, report_level(ctx, c, i, collapse, met));
}

/* The mesh as it is where it is manifold by its positions, else with its edges parted. */
static bvx_status open_collapse(bvx_context *ctx, bvxi_level_chain *c, const bvx_mesh_view *mesh,
                                bvxi_sheets *made, bvxi_sheets_report *sheets, bvxi_collapse **collapse)
{
    c->collapse.counted = c->reports != NULL;
    c->collapse.borders = BVXI_BORDERS_REFUSED;
    if (c->collapse.simple) return bvxi_collapse_open(ctx, c->function, mesh, made, &c->collapse, collapse);
    c->collapse.borders = BVXI_BORDERS_KEPT;
    uint64_t const mark = bvxi_scratch_begin(ctx);
    bvx_status const status = bvxi_scratch_keep(
        ctx, mark, bvxi_collapse_open(ctx, c->function, mesh, made, &c->collapse, collapse));
    if (status == BVX_OK) sheets->split = (*collapse)->counts.split;
    if (status != BVX_ERR_ARGUMENT) return status;

    BVXI_TRY(bvxi_sheets_part(ctx, made, sheets));
    c->collapse.borders = BVXI_BORDERS_CUT;
    return bvxi_collapse_open(ctx, c->function, mesh, made, &c->collapse, collapse);
}

static bvx_status make_chain(bvx_context *ctx, bvxi_level_chain *c, const bvx_mesh_view *mesh,
                             bvxi_sheets_report *sheets)
{
    bvxi_sheets made = {.view = *mesh};
    bvxi_collapse *collapse;
    bvx_status status = BVX_OK;
    double from = 0.1;

    /* What has too many triangles is refused when it is opened. */
    if (!c->collapse.simple && mesh->triangle_count <= INT32_MAX / 4)
        BVXI_TRY(bvxi_sheets_open(ctx, mesh, bvxi_collapse_needs_sources(mesh, &c->collapse), &made, sheets));
    BVXI_TRY(open_collapse(ctx, c, mesh, &made, sheets, &collapse));
    for (uint64_t i = 0; i < c->count && status == BVX_OK; i++) {
        /* Each level is made of the one before, so the first takes longest. */
        double const to = i + 1 == c->count ? 1.0 : 0.5 * from + 0.5;

        status = BVXI_SHARE(ctx, from, to, make_level(ctx, c, i, collapse));
        from = to;
    }
    bvxi_distance_forget(ctx, &c->kept);
    return status;
}

bvx_status bvxi_levels_make(bvx_context *ctx, bvxi_level_chain *c, const bvx_mesh_view *mesh,
                            bvxi_sheets_report *sheets)
{
    bvxi_sheets_report unused;
    if (sheets == NULL) sheets = &unused;
    memset(sheets, 0, sizeof *sheets);
    sheets->triangles = mesh->triangle_count;
    bvx_status const status = BVXI_SCOPE(ctx, make_chain(ctx, c, mesh, sheets));
    if (status != BVX_OK) bvxi_levels_drop(ctx, c->levels, c->count);
    return status;
}

/* ---- Warnings ---- */

#define LEVEL_CHANGED 0.02 /* of the volume, from which on it is warned of */
#define LEVEL_HOLLOW  1e-9 /* of a cube of that area: bodies that face opposite ways may cancel each other */

/* Levels of which a fact holds. */
typedef struct level_fact {
    uint64_t first, count;
} level_fact;

static void note_fact(level_fact *f, int holds, uint64_t level)
{
    if (holds && f->count++ == 0) f->first = level;
}

/* The share by which a level's volume differs, whichever way both are turned; 0: what it was made from has none. */
static double level_volume_change(const bvx_certificate *level, const bvx_certificate *from)
{
    double const volume = bvxi_absolute(from->volume);
    if (!from->closed || !from->oriented || volume <= LEVEL_HOLLOW * from->area * sqrt(from->area))
        return 0.0;
    return bvxi_absolute(level->volume) / volume - 1.0;
}

static void warn_of_sheets(bvx_context *ctx, const bvxi_sheets_report *s)
{
    if (s->doubles != 0) BVXI_WARN(ctx, BVX_WARN_DOUBLES, (double)s->doubles);
    if (s->turned != 0) BVXI_WARN(ctx, BVX_WARN_TURNED, (double)s->turned);
    if (s->cut != 0) {
        bvx_warning *const w = BVXI_WARN(ctx, BVX_WARN_CUT, (double)s->cut);

        w->placed = 1;
        for (int a = 0; a < 3; a++) {
            int const low = s->cut_edge[1][a] < s->cut_edge[0][a];

            w->low[a] = s->cut_edge[low][a];
            w->high[a] = s->cut_edge[!low][a];
        }
    }
}

void bvxi_levels_warn(bvx_context *ctx, const bvxi_level_chain *c, const bvx_certificate *from,
                      const bvxi_sheets_report *sheets)
{
    /* Else fans and sheets that met are apart in the levels, so that they have more pieces. */
    int const sound = from->edge_manifold && from->vertex_manifold && from->oriented;
    level_fact parts = {0, 0}, volume = {0, 0}, missed = {0, 0};

    if (sheets != NULL) warn_of_sheets(ctx, sheets);
    for (uint64_t i = 0; i < c->count && c->reports != NULL; i++) {
        const bvx_certificate *const level = &c->reports[i].certificate;

        note_fact(&parts, sound && level->components != from->components, i);
        note_fact(&volume, bvxi_absolute(level_volume_change(level, from)) > LEVEL_CHANGED, i);
        note_fact(&missed, !c->reports[i].met, i);
    }
    const bvx_level_report *r = &c->reports[parts.first];
    if (parts.count != 0)
        BVXI_WARN(ctx, BVX_WARN_LEVEL_PARTS, (double)parts.first, (double)r->certificate.components,
                  (double)from->components, (double)parts.count - 1.0);
    r = &c->reports[volume.first];
    if (volume.count != 0)
        BVXI_WARN(ctx, BVX_WARN_LEVEL_VOLUME, (double)volume.first, bvxi_absolute(r->certificate.volume),
                  bvxi_absolute(from->volume), level_volume_change(&r->certificate, from),
                  (double)volume.count - 1.0);
    r = &c->reports[missed.first];
    if (missed.count == 0) return;
    if (c->targets.errors != NULL)
        BVXI_WARN(ctx, BVX_WARN_ERROR, (double)missed.first, r->target_error, (double)missed.count - 1.0);
    else
        BVXI_WARN(ctx, BVX_WARN_TARGET, (double)missed.first, (double)r->target, (double)r->triangles,
                  r->certificate.closed
                      ? (double)r->certificate.components - 0.5 * (double)r->certificate.euler
                      : 0.0,
                  (double)missed.count - 1.0);
}
