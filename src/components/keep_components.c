/* keep_components.c - some of a grid's parts kept, its cavities filled: bvx_grid_keep,
 * bvx_grid_fill_cavities.
 *
 * Set (or empty) voxels are joined to spaces (components.c), each is measured and judged, and those that
 * go are changed in the result. The n largest are found without sorting: the greatest size that n of them
 * reach, by halving; of those that have just this size the first are taken.
 * Guarantee: exact. */
#include "components/room.h"

static const char keep_name[] = "bvx_grid_keep";
static const char cavities_name[] = "bvx_grid_fill_cavities";

/* The result, in *made: a copy of the grid, unless it is the grid. */
static bvx_status open_keep_result(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                   bvx_grid *result, bvx_grid *made)
{
    bvx_window window;
    memcpy(window.low, grid->low, sizeof window.low);
    memcpy(window.size, grid->size, sizeof window.size);
    BVXI_TRY(bvxi_grid_check_shift(ctx, function, grid, result));
    bvxi_grid_renew(ctx, &grid->lattice, &window, result);
    *made = *result;
    return bvxi_grid_open(ctx, function, &grid->lattice, &window, made);
}

/* What is judged: spaces with their sizes; marks: 1 for what goes. */
typedef struct keep_work {
    bvx_context *ctx;
    bvxi_spaces spaces;
    uint64_t *voxels;
    uint8_t *marks, *at_side;
} keep_work;

static bvx_status open_keep_work(bvx_context *ctx, const char *function, const bvx_grid *grid, int32_t empty,
                                 int32_t connectivity, keep_work *w)
{
    memset(w, 0, sizeof *w);
    w->ctx = ctx;
    BVXI_TRY(
        bvxi_spaces_open(ctx, function, empty ? "cavities" : "keep", grid, empty, connectivity, &w->spaces));
    /* Spaces are counted by now, so the lists have their exact size. */
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, w->spaces.count * 8, "the sizes of parts", &w->voxels));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, w->spaces.count, "the marks of parts", &w->marks));
    if (empty)
        BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, w->spaces.count, "the sides of parts", &w->at_side));
    bvxi_spaces_measure(&w->spaces, w->voxels, w->at_side);
    return BVX_OK;
}

typedef struct keep_seeds {
    const bvx_grid *seeds; /* a grid of the seeds' voxels */
    uint8_t *marks;
} keep_seeds;

static void keep_seeded_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const keep_seeds *const s = user;
    const uint64_t *const row = s->seeds->words + ((size_t)z * (size_t)s->seeds->size[1] + (size_t)y) *
                                                      (size_t)s->seeds->words_per_row;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++)
        if ((row[k] & bvxi_run_mask(begin, end, k)) != 0) s->marks[space] = 0;
}

static uint64_t count_parts_of(const keep_work *w, uint64_t at_least)
{
    uint64_t n = 0;
    for (uint64_t i = 0; i < w->spaces.count; i++) n += !w->marks[i] && w->voxels[i] >= at_least;
    return n;
}

static void drop_all_but_largest(keep_work *w, uint64_t largest)
{
    uint64_t low = 0, high = 0, equal;

    if (count_parts_of(w, 0) <= largest) return;

    /* By halving the size: no list of parts is sorted, whatever their number. */
    for (uint64_t i = 0; i < w->spaces.count; i++) high = w->voxels[i] > high ? w->voxels[i] : high;
    while (low < high) { /* at least `largest` parts reach low; fewer reach high + 1 */
        uint64_t const middle = low + (high - low + 1) / 2;
        if (count_parts_of(w, middle) >= largest) low = middle;
        else high = middle - 1;
    }
    /* Parts of just this size may be more than are wanted: the first ones stay. */
    equal = largest - count_parts_of(w, low + 1); /* of this size as many as there is room for */
    for (uint64_t i = 0; i < w->spaces.count; i++) {
        if (w->marks[i] || w->voxels[i] > low) continue;
        if (w->voxels[i] == low && equal > 0) equal--;
        else w->marks[i] = 1;
    }
}

static const bvxi_option keep_rows[] = {
    BVXI_OR(bvx_keep_options, connectivity, AMONG, 6, 1 << 6 | 1 << 18 | 1 << 26, 0),
    BVXI_RESERVED(bvx_keep_options, reserved),
};

static bvx_status keep_parts(bvx_context *ctx, const bvx_grid *grid, const bvx_keep_options *o,
                             bvx_grid *made)
{
    uint64_t const bytes = bvxi_grid_words(grid) * 8;
    bvx_grid seeds = *grid;
    keep_work w;

    seeds.words = NULL;
    BVXI_TRY(open_keep_work(ctx, keep_name, grid, 0, o->connectivity, &w));
    if (o->seed_count != 0) BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the seeds' voxels", &seeds.words));

    /* Seeds are marked in a grid of their own: one walk over runs finds those of any number of seeds. */
    if (o->seed_count != 0) {
        keep_seeds s = {&seeds, w.marks};
        memset(seeds.words, 0, (size_t)bytes);
        for (uint64_t i = 0; i < o->seed_count; i++)
            bvx_grid_set(&seeds, o->seeds[3 * i], o->seeds[3 * i + 1], o->seeds[3 * i + 2], 1);
        memset(w.marks, 1, (size_t)w.spaces.count);
        bvxi_spaces_each(&w.spaces, keep_seeded_run, &s);
    }
    uint64_t const at_least = o->at_least;
    for (uint64_t i = 0; i < w.spaces.count; i++) w.marks[i] |= w.voxels[i] < at_least;
    if (o->largest != 0) drop_all_but_largest(&w, o->largest);
    if (o->report != NULL) memset(o->report, 0, sizeof *o->report);
    for (uint64_t i = 0; i < w.spaces.count && o->report != NULL; i++) {
        *(w.marks[i] ? &o->report->dropped : &o->report->kept) += 1;
        *(w.marks[i] ? &o->report->voxels_dropped : &o->report->voxels_kept) += w.voxels[i];
    }
    /* The result may be the grid itself; then only what goes is changed. */
    if (made->words != grid->words) memcpy(made->words, grid->words, (size_t)bytes);
    bvxi_spaces_flip(&w.spaces, w.marks, made->words);
    return BVX_OK;
}

static bvx_status run_grid_keep(bvx_context *context, const bvx_grid *grid, const bvx_keep_options *options,
                                bvx_grid *result)
{
    bvx_keep_options o;
    bvx_grid made;
    if (result == NULL) return bvxi_fail_null(context, keep_name, "result");
    BVXI_TRY(bvxi_take_options(context, keep_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_grid_check(context, keep_name, grid));

    BVXI_TRY(bvxi_check_options(context, keep_name, &o, BVXI_OPTIONS(keep_rows)));
    if (o.seeds == NULL && o.seed_count != 0) return bvxi_fail_null(context, keep_name, "seeds");
    for (uint64_t i = 0; i < o.seed_count; i++)
        BVXI_TRY(bvxi_seed_check(context, keep_name, grid, o.seeds + 3 * i, i));

    BVXI_TRY(open_keep_result(context, keep_name, grid, result, &made));
    return bvxi_grid_put(context, keep_parts(context, grid, &o, &made), &made, result);
}

bvx_status bvx_grid_keep(bvx_context *context, const bvx_grid *grid, const bvx_keep_options *options,
                         bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_keep(context, grid, options, result));
}

bvx_status bvxi_fill_pockets(bvx_context *ctx, const char *function, const bvx_grid *grid,
                             int32_t connectivity, uint64_t at_most, uint64_t *words, bvxi_pockets *filled)
{
    bvxi_pockets set = {0, 0};
    keep_work w;

    BVXI_TRY(open_keep_work(ctx, function, grid, 1, connectivity, &w));

    /* What touches a side of the window is no cavity; others only if small, on request. */
    for (uint64_t i = 0; i < w.spaces.count; i++) {
        w.marks[i] = !w.at_side[i] && (at_most == 0 || w.voxels[i] <= at_most);
        set.voxels += w.marks[i] ? w.voxels[i] : 0;
        set.count += w.marks[i];
    }
    if (words != grid->words) memcpy(words, grid->words, (size_t)bvxi_grid_words(grid) * 8);
    bvxi_spaces_flip(&w.spaces, w.marks, words);
    *filled = set;
    return BVX_OK;
}

static bvx_status run_grid_fill_cavities(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                         uint64_t at_most, bvx_grid *result, uint64_t *filled)
{
    bvxi_pockets set = {0, 0};
    bvx_grid made;
    if (result == NULL) return bvxi_fail_null(context, cavities_name, "result");
    BVXI_TRY(bvxi_grid_check(context, cavities_name, grid));
    BVXI_TRY(bvxi_check_connectivity(context, cavities_name, connectivity));
    /* After all checks: an array of the caller's must not be touched by a call that is refused. */
    BVXI_TRY(open_keep_result(context, cavities_name, grid, result, &made));
    bvx_status status = bvxi_fill_pockets(context, cavities_name, grid, connectivity, at_most, made.words,
                                          &set);
    if (status == BVX_OK && filled != NULL) *filled = set.voxels;
    return bvxi_grid_put(context, status, &made, result);
}

bvx_status bvx_grid_fill_cavities(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                  uint64_t at_most, bvx_grid *result, uint64_t *filled)
{
    return BVXI_CALL(context, run_grid_fill_cavities(context, grid, connectivity, at_most, result, filled));
}
