/* compare_fills.c - where the rules for solids differ on one mesh, and where walls got lost:
 * bvx_compare_fills.
 *
 * Each rule fills in turn; of all of them only the union and the intersection are kept. Off the conservative
 * surface a voxel in one but not in the other is disputed. A voxel of the surface with no solid voxel beside
 * it, not even at a corner, belongs to a wall that no centre lies in. */
#include "fill/fills.h"
#include "components/room.h"

enum { FILL_RULES = 5, FILL_GRIDS = 7 };

static const char fills_name[] = "bvx_compare_fills";

/* Scratch grids of the whole lattice, in one block. */
typedef struct fills_work {
    bvxi_solid_job job;
    bvx_grid vote, sure, surface, filled, any, all, closed;
    uint64_t *memory;
    uint64_t words; /* of one */
    int32_t close_gaps;
    bvx_solid_report report; /* of the vote */
    bvx_fill_comparison result;
} fills_work;

static bvx_status open_fills(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             fills_work *w)
{
    bvx_window whole;
    bvx_grid *const grid[FILL_GRIDS] = {&w->vote, &w->sure, &w->surface, &w->filled,
                                        &w->any,  &w->all,  &w->closed};
    int ok = 1;

    BVXI_TRY(bvxi_window_take(ctx, fills_name, lattice, NULL, &whole));
    w->words = bvx_grid_bound(lattice, NULL);
    /* Before any memory is taken, since seven grids may pass addresses. */
    if (w->words == 0 || bvxi_mul(w->words, FILL_GRIDS * 8, &ok) > SIZE_MAX || !ok)
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: grids of %u words are beyond this machine's addresses",
                         fills_name, w->words);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->words * FILL_GRIDS * 8, "the rules' grids", &w->memory));
    for (uint64_t i = 0; i < FILL_GRIDS; i++) {
        grid[i]->words = w->memory + w->words * i;
        grid[i]->word_capacity = w->words;
        BVXI_TRY(bvxi_grid_open(ctx, fills_name, lattice, &whole, grid[i]));
    }
    return bvxi_solid_open(ctx, fills_name, mesh, lattice, &w->job);
}

static void close_fills(bvx_context *ctx, fills_work *w)
{
    bvxi_solid_close(ctx, &w->job);
    bvxi_drop(ctx, w->memory);
}

/* ---- The rules ---- */

static void copy_fill(const fills_work *w, const bvx_grid *from, const bvx_grid *to)
{
    memcpy(to->words, from->words, (size_t)w->words * 8);
}

/* The grid of a rule in w->filled. */
static bvx_status fill_one(bvx_context *ctx, fills_work *w, int32_t rule)
{
    /* The vote is made once; rules that build on it begin from a copy. */
    bvxi_flood_walls const walls = {&w->closed, w->sure.words, w->close_gaps};
    bvx_solid_report unused = {.surface_voxels = w->result.surface_voxels,
                               .unbalanced_rows = w->report.unbalanced_rows};

    if (rule == BVX_FILL_PARITY || rule == BVX_FILL_NONZERO)
        return bvxi_solid_fill(bvxi_solid_step(ctx, &w->job, 0.0, 1.0), &w->job, &w->filled, 0, rule,
                               &unused);
    /* The other three begin with the vote. */
    copy_fill(w, &w->vote, &w->filled);
    if (rule == BVX_FILL_REGIONS)
        return bvxi_regions(ctx, fills_name, &w->surface, w->sure.words, &w->filled, &unused);
    /* The vote itself is done. */
    if (rule != BVX_FILL_FLOOD) return BVX_OK;
    copy_fill(w, &w->surface, &w->closed);
    return bvxi_flood(ctx, fills_name, &walls, &w->filled, &unused, &w->result.flood_leaked);
}

static bvx_status fill_all(bvx_context *ctx, fills_work *w)
{
    /* The union begins empty, the intersection full. */
    memset(w->any.words, 0, (size_t)w->words * 8);
    memset(w->all.words, 255, (size_t)w->words * 8);
    for (int32_t i = 0; i < FILL_RULES; i++) {
        int32_t const rule = BVX_FILL_PARITY + i;

        BVXI_TRY(BVXI_SHARE(ctx, 0.5 + 0.08 * i, 0.58 + 0.08 * i, fill_one(ctx, w, rule)));
        BVXI_TRY(bvx_grid_count(ctx, &w->filled, &w->result.set[i]));
        /* A flood that leaked filled nothing: its grid would call everything disputed. */
        if (rule == BVX_FILL_FLOOD && w->result.flood_leaked) continue;
        for (uint64_t k = 0; k < w->words; k++) {
            w->any.words[k] |= w->filled.words[k];
            w->all.words[k] &= w->filled.words[k];
        }
    }
    /* Off the surface only: there rules may differ by a voxel without meaning anything. */
    for (uint64_t i = 0; i < w->words; i++) w->any.words[i] &= ~w->all.words[i] & ~w->surface.words[i];
    return bvx_grid_count(ctx, &w->any, &w->result.disagreeing);
}

/* ---- Lost walls ---- */

/* Row (y, z) of the vote grown by one voxel along x, joined to a row; rows beyond the lattice are empty. */
static void join_grown_row(const bvx_grid *g, int32_t y, int32_t z, uint64_t *row)
{
    int32_t const words = g->words_per_row;
    const uint64_t *from;

    if (y < 0 || z < 0 || y >= g->size[1] || z >= g->size[2]) return;
    from = g->words + ((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)words;
    /* Neighbours along x, over the borders of words. */
    for (int32_t k = 0; k < words; k++) {
        row[k] |= from[k] | from[k] << 1 | from[k] >> 1;
        if (k > 0) row[k] |= from[k - 1] >> 63;
        if (k + 1 < words) row[k] |= from[k + 1] << 63;
    }
}

/* w->all becomes the surface's voxels with no voxel of the vote near. */
static void find_lost(fills_work *w)
{
    const bvx_grid *const g = &w->vote;

    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            size_t const at = ((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->words_per_row;
            uint64_t *const row = w->all.words + at;
            /* Nine rows around it, each grown along x: all 26 neighbours. */
            memset(row, 0, (size_t)g->words_per_row * 8);
            for (int32_t n = 0; n < 9; n++) join_grown_row(g, y + n % 3 - 1, z + n / 3 - 1, row);
            for (int32_t k = 0; k < g->words_per_row; k++)
                row[k] = w->surface.words[at + (size_t)k] & ~row[k];
        }
}

static bvx_status count_lost(bvx_context *ctx, fills_work *w)
{
    /* On the vote: it fills what is inside whatever holes there are. */
    bvxi_spaces places;
    find_lost(w);
    BVXI_TRY(bvx_grid_count(ctx, &w->all, &w->result.lost_voxels));
    BVXI_TRY(bvxi_spaces_open(ctx, fills_name, "lost walls", &w->all, 0, BVXI_CONNECT_6, &places));
    w->result.lost_places = places.count;
    bvxi_spaces_free(&places);
    return BVX_OK;
}

/* ---- The call ---- */

static bvx_status run_fills(bvx_context *ctx, const bvx_mesh_view *mesh, fills_work *w)
{
    bvx_surface_options const o = {.struct_size = sizeof o};

    /* Votes and surface are needed by more than one rule. */
    BVXI_TRY(BVXI_SHARE(
        ctx, 0.1, 0.4,
        bvxi_vote(bvxi_solid_step(ctx, &w->job, 0.0, 1.0), &w->job, 1, &w->vote, w->sure.words, &w->report)));
    BVXI_TRY(BVXI_SHARE(ctx, 0.4, 0.5, bvx_voxelize_surface(ctx, mesh, &w->vote.lattice, &o, &w->surface)));
    BVXI_TRY(bvx_grid_count(ctx, &w->surface, &w->result.surface_voxels));
    w->report.surface_voxels = w->result.surface_voxels;
    BVXI_TRY(fill_all(ctx, w));
    return BVXI_SHARE(ctx, 0.9, 1.0, count_lost(ctx, w));
}

/* A grid for the caller, where he wants one; on failure what was made for the other goes too. */
static bvx_status give_fill(bvx_context *ctx, const fills_work *w, const bvx_grid *from, bvx_grid *wanted,
                            bvx_grid *made)
{
    bvx_window window;

    if (wanted == NULL) return BVX_OK;
    /* Only on success is anything of the caller's replaced. */
    memcpy(window.low, from->low, sizeof window.low);
    memcpy(window.size, from->size, sizeof window.size);
    bvxi_grid_renew(ctx, &from->lattice, &window, wanted);
    *made = *wanted;
    BVXI_TRY(bvxi_grid_open(ctx, fills_name, &from->lattice, &window, made));
    copy_fill(w, from, made);
    return BVX_OK;
}

static bvx_status give_fills(bvx_context *ctx, const fills_work *w, const bvx_compare_fills_options *o)
{
    bvx_grid disagreeing = {0}, lost = {0};
    bvx_status status;

    BVXI_TRY(give_fill(ctx, w, &w->any, o->disagreeing, &disagreeing));
    status = give_fill(ctx, w, &w->all, o->lost, &lost);
    if (status != BVX_OK) {
        /* The first one was made already, and is not handed out alone. */
        if (o->disagreeing != NULL && o->disagreeing->words == NULL) bvx_grid_free(ctx, &disagreeing);
        return status;
    }
    if (o->disagreeing != NULL) *o->disagreeing = disagreeing;
    if (o->lost != NULL) *o->lost = lost;
    return BVX_OK;
}

static const bvxi_option compare_fills_rows[] = {
    BVXI_RESERVED(bvx_compare_fills_options, reserved),
    BVXI_WHOLE(bvx_compare_fills_options, close_gaps, 0, BVXI_MOST_GAP),
};

static bvx_status check_fills(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                              const bvx_compare_fills_options *given, bvx_compare_fills_options *o)
{
    BVXI_TRY(bvxi_take_options(ctx, fills_name, given, o, sizeof *o));
    BVXI_TRY(bvxi_check_options(ctx, fills_name, o, BVXI_OPTIONS(compare_fills_rows)));
    if (o->disagreeing != NULL && o->disagreeing == o->lost)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                             "%s: disagreeing and lost are one grid", fills_name);
    BVXI_TRY(bvxi_view_check(ctx, fills_name, mesh));
    if (mesh->triangle_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", fills_name);
    return bvxi_lattice_check(ctx, fills_name, lattice);
}

static bvx_status run_compare_fills(bvx_context *context, const bvx_mesh_view *mesh,
                                    const bvx_lattice *lattice, const bvx_compare_fills_options *options,
                                    bvx_fill_comparison *comparison)
{
    bvx_compare_fills_options o;
    fills_work work;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (comparison == NULL) return bvxi_fail_null(context, fills_name, "comparison");
    BVXI_TRY(check_fills(context, mesh, lattice, options, &o));
    memset(&work, 0, sizeof work);
    work.close_gaps = o.close_gaps;
    BVXI_TRY(open_fills(context, mesh, lattice, &work));
    BVXI_TRY(run_fills(context, mesh, &work));
    BVXI_TRY(give_fills(context, &work, &o));
    close_fills(context, &work);
    *comparison = work.result;
    return BVX_OK;
}

bvx_status bvx_compare_fills(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             const bvx_compare_fills_options *options, bvx_fill_comparison *comparison)
{
    return BVXI_CALL(context, run_compare_fills(context, mesh, lattice, options, comparison));
}
