/* fill_auto.c - BVX_FILL_AUTO: the rule that suits a mesh.
 *
 * Most meshes are sound, and that is seen for little: their triangles run along each edge as often one way as
 * the other (edge_balance.c), and their rows are one deep at most, which the parity fill tells by a sum of
 * its crossings. All rules agree on such a mesh. Others are looked at edge by edge: the minority of each
 * patch is turned; what then is open is filled by winding number, what crosses itself or others by nonzero,
 * what lies in another without crossing it stays a cavity (parity), and what cannot be oriented is left to
 * the vote, which requires no orientation.
 *
 * Guarantee: the choice follows from mesh and lattice, whatever the window; a sound closed mesh has parity's
 * bits. */
#include "nearest/closest.h"
#include "fill/fills.h"

typedef struct auto_work {
    bvxi_solid_job job; /* of the mesh; later of the turned one */
    bvxi_patches patches;
    uint32_t *representative;          /* vertices welded [Size: vertex_count] */
    double low[3], high[3], centre[3]; /* of the triangles */
    int cracked;                       /* closed, but for sides that several shorter ones cover */
    bvxi_auto choice;
} auto_work;

static bvx_status choose_auto(auto_work *w, int32_t fill, int32_t reason)
{
    w->choice.fill = fill;
    w->choice.reason = reason;
    return BVX_OK;
}

/* Parity, which is every rule's answer where the crossings' steps and the
 * bits' are the same, or opposite: inside out. */
static bvx_status try_parity(bvx_context *ctx, auto_work *w, const bvx_grid *solid, bvx_solid_report *report,
                             int32_t *filled)
{
    bvx_solid_report const before = *report;

    w->job.summed = 1;
    BVXI_TRY(
        bvxi_solid_fill(bvxi_solid_step(ctx, &w->job, 0.1, 1.0), &w->job, solid, 0, BVX_FILL_PARITY, report));
    w->job.summed = 0;

    /* Nothing inside is looked into: triangles that are there twice, once either way, hide what lies
     * between. */
    *filled = w->job.parity_sum != 0 &&
              (w->job.signed_sum == w->job.parity_sum || w->job.signed_sum == 0 - w->job.parity_sum);
    if (!*filled) *report = before;
    return BVX_OK;
}

/* ---- Edge by edge ---- */

/* The triangles as patches->turn has them. */
static bvx_status turn_triangles(bvx_context *ctx, auto_work *w)
{
    const bvx_mesh_view given = w->choice.view;
    if (w->choice.index == NULL)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, given.triangle_count * 12, "the turned triangles' corners",
                            &w->choice.index));
    bvxi_patches_turn(&given, &w->patches, w->choice.index, &w->choice.view);
    w->job.view = &w->choice.view;
    return BVX_OK;
}

/* Weld, and turn patches. copies: leave out those of triangles, which may be there. */
static bvx_status look_at_edges(bvx_context *ctx, auto_work *w, int copies)
{
    bvx_mesh_view *const view = &w->choice.view;
    uint64_t different, kept = 0;

    bvxi_view_used_bounds(&w->choice.view, w->low, w->high);
    for (int a = 0; a < 3; a++) w->centre[a] = 0.5 * w->low[a] + 0.5 * w->high[a];
    BVXI_TRY(BVXI_ARRAY(ctx, view->vertex_count, "the vertices' places", w->representative));
    BVXI_TRY(bvxi_weld(ctx, view, w->representative, &different));
    /* Triangles that are there twice count once: each copy would be inside of all others. */
    if (copies) {
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, view->triangle_count * 12, "the triangles once each",
                            &w->choice.index));
        BVXI_TRY(bvxi_drop_duplicates(ctx, view, w->representative, w->choice.index, &kept));
    }
    if (kept != 0) { /* else none has area: they stay, and enclose nothing */
        w->choice.doubles = view->triangle_count - kept;
        view->indices = w->choice.index;
        view->index_type = BVX_U32;
        view->index_stride = 0;
        view->triangle_count = kept;
        w->job.view = view;
    }

    BVXI_TRY(bvxi_patches_open(ctx, view, w->representative, w->centre, w->choice.doubles != 0, &w->patches));
    w->choice.turned = w->patches.turned;
    return w->patches.turned != 0 ? turn_triangles(ctx, w) : BVX_OK;
}

/* ---- Closed meshes whose rows are deeper ---- */

/* The mesh as it stands, turned or not. */
static bvxi_welded welded_choice(const auto_work *w)
{
    bvxi_welded welded = {.view = &w->choice.view, .representative = w->representative};
    memcpy(welded.low, w->low, sizeof welded.low);
    memcpy(welded.high, w->high, sizeof welded.high);
    return welded;
}

#define AUTO_DEPTHS 0.3 /* of the choice: rows have been looked at */
#define AUTO_EDGES  0.4 /* and edges */

/* Turn the parts that are inside out and cross others: two that overlap would cancel out. One that crosses
 * none is a cavity, or inside by any rule. */
static bvx_status turn_inverted(bvx_context *ctx, auto_work *w, const double *volume)
{
    bvxi_welded const welded = welded_choice(w);
    uint64_t pair_count;
    uint32_t *pairs;
    uint8_t *crosses;

    BVXI_TRY(
        BVXI_SHARE(ctx, AUTO_EDGES, 1.0, bvxi_mesh_crossings(ctx, &welded, UINT64_MAX, &pairs, &pair_count)));
    if (pair_count == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, w->patches.triangles, "the parts that cross", &crosses));

    /* A part that crosses itself only is one surface: turning it would not change what nonzero makes of
     * it. */
    for (uint64_t i = 0; i < pair_count; i++) {
        uint32_t const a = w->patches.part[pairs[2 * i]], b = w->patches.part[pairs[2 * i + 1]];
        if (a != b) crosses[a] = crosses[b] = 1;
    }
    for (uint64_t t = 0; t < w->patches.triangles; t++) {
        uint32_t const part = w->patches.part[t];
        w->patches.turn[t] = crosses[part] && volume[part] < 0;
        w->choice.turned += w->patches.turn[t];
    }
    bvxi_drop(ctx, crosses);
    bvxi_drop(ctx, pairs);
    return turn_triangles(ctx, w);
}

static bvx_status turn_closed_parts(bvx_context *ctx, auto_work *w)
{
    uint64_t const bytes = w->patches.triangles * sizeof(double);
    uint64_t inverted = 0;
    double *volume;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the parts' volumes", &volume));
    /* By part, at its least triangle: the volume that it encloses, 0 where it is open. From the centre, so that
     * large coordinates do not take the digits. */
    for (uint64_t t = 0; t < w->patches.triangles; t++)
        if (!w->patches.open[w->patches.part[t]])
            volume[w->patches.part[t]] += bvxi_patches_volume(&w->choice.view, t, w->centre);
    for (uint64_t t = 0; t < w->patches.triangles; t++) inverted += w->patches.part[t] == t && volume[t] < 0;
    if (inverted != 0) BVXI_TRY(turn_inverted(ctx, w, volume));
    bvxi_drop(ctx, volume);
    return BVX_OK;
}

/* Rows that are looked at before a choice [Memory: 8 bytes each]. A lattice with
 * more of them is looked at with longer voxels, so that a small window of a huge
 * lattice costs little; whole or by windows, so that both have the same bits. */
enum { ROWS_TO_LOOK_AT = 1 << 22 };

static int has_more_rows(const bvx_lattice *lattice)
{
    return (int64_t)lattice->dims[1] * lattice->dims[2] > ROWS_TO_LOOK_AT;
}

/* How many voxels stick out of the lattice's low and high side along an axis; 0 or less: none. */
static void measure_beyond(const bvx_lattice *l, int a, const double low[3], const double high[3],
                           double beyond[2])
{
    double const first = l->origin[a] / l->spacing[a];

    beyond[0] = first - low[a] / l->spacing[a];
    beyond[1] = high[a] / l->spacing[a] - first - l->dims[a];
}

/* Voxels of l put around it, so that no triangle lies beyond. Returns 1 where there are some. */
static int reach_around(const auto_work *w, bvx_lattice *l)
{
    double low[3], high[3], out[2];
    uint32_t at[6];
    int beyond = 0;

    /* Where no vertex lies beyond, none of a triangle does. */
    int within = bvxi_view_outer_bounds(&w->choice.view, low, high, at);

    for (int a = 0; a < 3 && within; a++) {
        measure_beyond(l, a, low, high, out);
        within = out[0] <= 0.0 && out[1] <= 0.0;
    }
    if (within) return 0;
    bvxi_view_used_bounds(&w->choice.view, low, high);
    for (int a = 0; a < 3; a++) {
        measure_beyond(l, a, low, high, out);
        double const before = out[0], after = out[1];
        /* Where that many would not do, nothing is put around; nor at the ends of doubles. */
        if (!(before <= BVXI_MAX_SIDE && after <= BVXI_MAX_SIDE)) continue;
        int32_t const added = before > 0.0 ? (int32_t)before + (before > (double)(int32_t)before) : 0;
        double const from = l->origin[a] - added * l->spacing[a];
        if (!(from >= -BVXI_FINITE && high[a] - from <= BVXI_FINITE)) continue;
        l->origin[a] = from;
        l->dims[a] += added + (after > 0.0 ? (int32_t)after + 1 : 0);
        beyond |= before > 0.0 || after > 0.0;
    }
    return beyond;
}

/* In the lattice, and around it where the mesh lies beyond: what is inside out there looks like a cavity here. */
static bvx_status look_for_depths(bvx_context *ctx, auto_work *w, const bvx_lattice *lattice, int32_t *depths)
{
    bvx_lattice coarse = *lattice;
    bvxi_solid_job job = {0};
    int32_t around = 0;

    *depths = 0;
    if (!has_more_rows(lattice)) {
        BVXI_TRY(bvxi_row_depths(ctx, &w->job, lattice, 0.0, AUTO_DEPTHS, depths));
        if (!reach_around(w, &coarse)) return BVX_OK;
    }
    for (;;) {
        int more = has_more_rows(&coarse);
        /* The far end has no place in fixed point. */
        for (int a = 0; a < 3; a++) more |= coarse.dims[a] > 1 << (29 - coarse.fraction_bits);
        if (!more) break;
        for (int a = 0; a < 3; a++) {
            coarse.spacing[a] *= 2;
            coarse.dims[a] = coarse.dims[a] / 2 + (coarse.dims[a] & 1);
        }
        /* One bit more, where there is one, keeps the snapped positions. */
        if (coarse.fraction_bits < 16) coarse.fraction_bits++;
    }
    BVXI_TRY(bvxi_solid_open(ctx, w->job.function, &w->choice.view, &coarse, &job));
    BVXI_TRY(bvxi_row_depths(ctx, &job, &coarse, 0.0, AUTO_DEPTHS, &around));
    bvxi_solid_close(ctx, &job);
    *depths |= around;
    return BVX_OK;
}

/* Rows of the mesh as it stands now, which is closed and oriented. */
static bvx_status choose_by_depths(bvx_context *ctx, auto_work *w, int32_t depths)
{
    if (depths == 0 || depths == BVXI_DEPTH_UP || depths == BVXI_DEPTH_DOWN)
        return choose_auto(w, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND);

    /* Sides of T-junctions split one surface into patches, which are not turned one by one. */
    if (w->cracked) return choose_auto(w, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP);
    if (w->representative == NULL) BVXI_TRY(look_at_edges(ctx, w, 0));

    /* A closed surface of one part that crosses itself nowhere is one deep: nothing need be searched. */
    uint64_t parts = 0; /* each is named after its least triangle */
    for (uint64_t t = 0; t < w->patches.triangles; t++) parts += w->patches.part[t] == t;
    if (parts == 1) return choose_auto(w, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP);

    bvxi_welded const welded = welded_choice(w);
    uint64_t pair_count;
    uint32_t *unlisted;

    /* Not listed: most meshes have none. */
    BVXI_TRY(BVXI_SHARE(ctx, AUTO_EDGES, 1.0, bvxi_mesh_crossings(ctx, &welded, 0, &unlisted, &pair_count)));
    if (pair_count == 0)
        return choose_auto(w, BVX_FILL_PARITY,
                           (depths & BVXI_DEPTH_DEEP) != 0 ? BVX_FILL_REASON_NESTED : BVX_FILL_REASON_SOUND);
    BVXI_TRY(choose_auto(w, BVX_FILL_NONZERO, BVX_FILL_REASON_OVERLAP));
    return turn_closed_parts(ctx, w);
}

/* By the edges of triangles that are there once each. */
static bvx_status choose_by_patches(bvx_context *ctx, auto_work *w, const bvx_lattice *lattice)
{
    int32_t depths;

    /* Before holes: a winding number means nothing where a patch has no sides. */
    if (w->patches.unorientable != 0 || (w->patches.odd_edges == 0 && w->patches.open_edges != 0))
        return choose_auto(w, BVX_FILL_VOTE, BVX_FILL_REASON_UNORIENTABLE);
    if (w->patches.open_edges != 0) {
        BVXI_TRY(choose_auto(w, BVX_FILL_WINDING, BVX_FILL_REASON_OPEN));
        return turn_closed_parts(ctx, w);
    }
    BVXI_TRY(look_for_depths(ctx, w, lattice, &depths));
    return choose_by_depths(ctx, w, depths);
}

/* Edges balance. Where no row is ever inside, each triangle may be there
 * twice, facing either way, as in models for games: once each they can
 * enclose something. Sheets that are open then enclose nothing, as before. */
static bvx_status choose_balanced(bvx_context *ctx, auto_work *w, const bvx_lattice *lattice)
{
    const bvx_mesh_view given = w->choice.view;
    int32_t depths;

    BVXI_TRY(look_for_depths(ctx, w, lattice, &depths));
    if (depths != 0) return choose_by_depths(ctx, w, depths);

    BVXI_TRY(look_at_edges(ctx, w, 1));
    if (w->choice.doubles != 0 && w->patches.odd_edges == 0)
        return BVXI_SHARE(ctx, AUTO_EDGES, 1.0, choose_by_patches(ctx, w, lattice));

    w->choice.view = given;
    w->choice.turned = w->choice.doubles = 0;
    return choose_auto(w, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND);
}

#define AUTO_CHOSEN 0.6 /* of the bar, when the rule is known */

static bvx_status choose_or_fill(bvx_context *ctx, auto_work *w, bvx_grid *solid, bvx_solid_report *report,
                                 int32_t *filled)
{
    bvx_lattice around = solid->lattice;
    int32_t balanced;

    BVXI_TRY(bvxi_edges_balance(ctx, &w->job, 0.1, &balanced));
    if (!balanced) {
        uint64_t *edges = NULL, count = 0;
        /* Edges that do not balance may all the same cover each other: sides of T-junctions are longer on one
         * triangle than on its neighbours, and still close. */
        BVXI_TRY(
            BVXI_SHARE(ctx, 0.1, 0.2, bvxi_open_edges(ctx, w->job.view, &w->job.snapped, 0, &edges, &count)));
        bvxi_drop(ctx, edges);
        balanced = w->cracked = count == 0;
    }
    if (!balanced) {
        BVXI_TRY(BVXI_SHARE(ctx, 0.2, 0.2 + (AUTO_CHOSEN - 0.2) * AUTO_EDGES, look_at_edges(ctx, w, 1)));
        return BVXI_SHARE(ctx, 0.2 + (AUTO_CHOSEN - 0.2) * AUTO_EDGES, AUTO_CHOSEN,
                          choose_by_patches(ctx, w, &solid->lattice));
    }

    /* Filling by parity also says how deep rows are, so a sound mesh is done when it has been examined. */
    BVXI_TRY(choose_auto(w, BVX_FILL_PARITY, BVX_FILL_REASON_SOUND));
    if (bvxi_grid_is_whole(solid) && !has_more_rows(&solid->lattice) && !reach_around(w, &around))
        BVXI_TRY(BVXI_SHARE(ctx, 0.2, 0.4, try_parity(ctx, w, solid, report, filled)));
    return *filled ? BVX_OK : BVXI_SHARE(ctx, 0.4, AUTO_CHOSEN, choose_balanced(ctx, w, &solid->lattice));
}

bvx_status bvxi_fill_auto(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                          bvxi_fill_by_name_fn *by_name, bvx_grid *solid, bvx_solid_report *report)
{
    int32_t filled = 0;
    auto_work w = {0};

    w.choice.view = *mesh;
    BVXI_TRY(bvxi_solid_open(ctx, function, mesh, &solid->lattice, &w.job));
    BVXI_TRY(choose_or_fill(ctx, &w, solid, report, &filled));

    /* All that the choice needed goes before the fill begins, whose memory is then that of the rule only. */
    bvxi_patches_close(ctx, &w.patches);
    bvxi_drop(ctx, w.representative);
    bvxi_solid_close(ctx, &w.job);

    if (!filled)
        BVXI_TRY(
            BVXI_SHARE(ctx, AUTO_CHOSEN, 1.0, by_name(ctx, &w.choice.view, w.choice.fill, solid, report)));
    bvxi_drop(ctx, w.choice.index);
    report->fill = w.choice.fill;
    report->fill_reason = w.choice.reason;
    report->turned = w.choice.turned;
    /* Each copy would count again. */
    if (w.choice.doubles != 0) report->mesh_volume = BVX_NONE;
    return BVX_OK;
}
