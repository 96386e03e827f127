/* voxelize_surface.c - the voxels that a mesh's surface touches: bvx_voxelize_surface.
 *
 * Vertices are snapped. Then each tile of rows takes the triangles that reach it (tile_bins.c) and writes its
 * own rows, or each worker takes pieces of the triangles and writes a grid of its own, by the definition
 * requested (conservative.c, thin.c, sampled.c). Attached triangles take two more runs over the tiles: the
 * first counts by rank, the second fills in.
 * Guarantee: exact; the same bits for any order of triangles, threads and windows. */
#include "touch/surface_voxels.h"

enum {
    SURFACE_GRAIN = 65536, /* triangles between looks at progress */
    APART_GRAIN = 4096,    /* triangles that a worker takes at a time */
    APART_BYTES = 8,       /* of what workers beside the first have, for each triangle, at most */
    LARGE_GRID = 1 << 23   /* [Units: words] */
};

/* Rough costs, by which progress is cut: a byte of rows that is emptied, a triangle of some voxels. */
#define NANOSECONDS_A_BYTE     1.5
#define NANOSECONDS_A_TRIANGLE 1000.0

static const char surface_name[] = "bvx_voxelize_surface";

void bvx_attached_free(bvx_context *context, bvx_attached *attached)
{
    if (context == NULL || attached == NULL) return;
    if (attached->offsets != NULL) {
        bvxi_free(context, attached->triangles, attached->triangle_count * 4);
        bvxi_free(context, attached->offsets, (attached->voxel_count + 1) * 8);
    }
    memset(attached, 0, sizeof *attached);
}

static void count_nothing(bvxi_surface_job *job, int32_t tile)
{
    job->used[tile] = job->samples[tile] = job->parts[tile] = 0;
    memset(job->beyond[tile], 0, sizeof job->beyond[tile]);
}

/* The first triangles that rows get find them empty. */
static void empty_rows(const bvxi_surface_job *job, const bvxi_rows *rows)
{
    for (int32_t k = rows->k0; job->task == BVXI_TOUCH_SET && k < rows->k1; k++)
        memset(bvxi_surface_row(job, rows->j0, k), 0,
               (size_t)(rows->j1 - rows->j0) * (size_t)job->grid->words_per_row * 8);
}

static void touch_by_mode(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count)
{
    switch (tile->job->mode) {
    case BVX_SURFACE_CONSERVATIVE: bvxi_touch_conservative(tile, id, count); break;
    case BVX_SURFACE_THIN: bvxi_touch_thin(tile, id, count); break;
    default: bvxi_touch_sampled(tile, id, count); break;
    }
}

static void touch_tile(void *user, int32_t number)
{
    bvxi_surface_job *const job = user;
    bvxi_surface_tile tile = {job, bvxi_tiles_rows(&job->tiles, number), number};
    count_nothing(job, number);
    /* Rows are emptied by the task that fills them, while they are about to be needed. */
    empty_rows(job, &tile.rows);
    touch_by_mode(&tile, job->bins.id + job->bins.end[number],
                  job->bins.end[number + 1] - job->bins.end[number]);
}

/* A worker beside the first, with a grid and counts of its own until all are joined. */
struct bvxi_surface_helper {
    bvxi_surface_job job;
    bvx_grid grid;
    int32_t begun;
};

/* A piece of the triangles into the only tile. */
static void touch_only_tile(void *user, int32_t piece, int32_t worker)
{
    bvxi_surface_job *job = user;

    if (worker != 0) {
        struct bvxi_surface_helper *const helper = &job->helpers[worker - 1];
        /* By the worker itself, while its words are about to be needed; who never comes costs nothing. */
        if (!helper->begun) memset(helper->grid.words, 0, (size_t)bvxi_grid_words(&helper->grid) * 8);
        helper->begun = 1;
        job = &helper->job;
    }
    bvxi_surface_tile tile = {job, bvxi_tiles_rows(&job->tiles, 0), 0};
    uint64_t begin, end;
    bvxi_piece(job->view->triangle_count, job->pieces, piece, &begin, &end);
    job->first = (uint32_t)begin;
    touch_by_mode(&tile, NULL, end - begin);
}

/* A slice of the only tile; any piece of the triangles may need any of them, so they are emptied before. */
static void empty_slice(void *user, int32_t index)
{
    const bvxi_surface_job *const job = user;
    bvxi_rows const slice = {0, job->size[1], index, index + 1};
    empty_rows(job, &slice);
}

/* A slice of the helpers' grids into the one of all. */
static void join_slice(void *user, int32_t index)
{
    const bvxi_surface_job *const job = user;
    size_t const words = (size_t)job->size[1] * (size_t)job->grid->words_per_row, at = (size_t)index * words;
    uint64_t *BVXI_RESTRICT const all = job->grid->words + at;
    for (int32_t h = 0; h < job->helper_count; h++) {
        const uint64_t *BVXI_RESTRICT const own = job->helpers[h].grid.words + at;
        for (size_t i = 0; job->helpers[h].begun && i < words; i++) all[i] |= own[i];
    }
}

static bvx_status open_helpers(bvx_context *ctx, bvxi_surface_job *job)
{
    uint64_t const count = (uint64_t)job->helper_count, words = bvxi_grid_words(job->grid);

    if (count == 0) return BVX_OK;
    BVXI_TRY(BVXI_ZEROS(ctx, count, "the workers' surfaces", job->helpers));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * words * 8, "the workers' grids", &job->helper_words));
    /* All copies are made before anybody works on the first. */
    for (uint64_t h = 0; h < count; h++) {
        struct bvxi_surface_helper *const helper = &job->helpers[h];
        helper->grid = *job->grid;
        helper->grid.words = job->helper_words + h * words;
        helper->job = *job;
        helper->job.grid = &helper->grid;
    }
    return BVX_OK;
}

static bvx_status touch_tiles(bvx_context *ctx, bvxi_surface_job *job, int32_t task, double from, double to)
{
    double const bytes = (double)bvxi_grid_words(job->grid) * 8.0 * NANOSECONDS_A_BYTE;
    double const triangles = (double)job->view->triangle_count * NANOSECONDS_A_TRIANGLE;
    double middle = from;

    job->task = task;
    if (job->bins.id != NULL)
        return bvxi_each_long(ctx, "surface", from, to, job->tiles.count,
                              (bytes + triangles) / (double)job->tiles.count, touch_tile, job);

    if (task == BVXI_TOUCH_SET) {
        middle = from + (to - from) * bytes / (bytes + triangles);
        BVXI_TRY(bvxi_each_long(ctx, "surface", from, middle, job->size[2], bytes / (double)job->size[2],
                                empty_slice, job));
    }
    count_nothing(job, 0);
    BVXI_TRY(open_helpers(ctx, job));
    BVXI_TRY(bvxi_parallel_long(ctx, "surface", middle, to, job->pieces, triangles / (double)job->pieces,
                                touch_only_tile, job));

    /* Sums of whole numbers and sets of bits: in any order the same. */
    if (job->helper_count == 0) return BVX_OK;
    for (int32_t h = 0; h < job->helper_count; h++) {
        const bvxi_surface_job *const own = &job->helpers[h].job;
        job->used[0] += own->used[0];
        job->samples[0] += own->samples[0];
        job->parts[0] += own->parts[0];
        for (int a = 0; a < 3; a++) job->beyond[0][a] += own->beyond[0][a];
    }
    BVXI_TRY(bvxi_each(ctx, "surface", to, to, job->size[2], join_slice, job));
    bvxi_drop(ctx, job->helper_words);
    bvxi_drop(ctx, job->helpers);
    return BVX_OK;
}

static bvx_status fill_lists(bvx_context *ctx, bvxi_surface_job *job, uint64_t voxels, bvx_attached *made)
{
    BVXI_TRY(
        bvxi_alloc_zero(ctx, BVXI_RESULT, (voxels + 1) * 8, "the voxels' triangle counts", &made->offsets));
    made->voxel_count = voxels;
    job->offset = made->offsets;

    /* The list of a voxel holds each triangle once: last remembers which came last. */
    memset(job->last, 0, (size_t)voxels * 4);
    BVXI_TRY(touch_tiles(ctx, job, BVXI_TOUCH_COUNT, 0.4, 0.7));
    uint64_t const total = made->offsets[voxels] = bvxi_place_counts(made->offsets, voxels);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, total * 4, "the voxels' triangles", &made->triangles));
    made->triangle_count = total;
    job->list = made->triangles;
    /* The second run must see the same as the first, so it begins with the same marks. */
    memset(job->last, 0, (size_t)voxels * 4);
    BVXI_TRY(touch_tiles(ctx, job, BVXI_TOUCH_LIST, 0.7, 1.0));

    /* Filling has moved each place to its voxel's end, which is where the next one begins. */
    for (uint64_t v = voxels; v > 0; v--) made->offsets[v] = made->offsets[v - 1];
    made->offsets[0] = 0;

    return BVX_OK;
}

static bvx_status attach_triangles(bvx_context *ctx, bvxi_surface_job *job, bvx_attached *attached)
{
    uint64_t const words = bvxi_grid_words(job->grid), bytes = bvxi_rank_bytes(words);
    bvx_attached made = {0};
    uint32_t *prefix = NULL;
    uint64_t voxels = 0;

    BVXI_TRY(bvx_grid_count(ctx, job->grid, &voxels));

    /* Ranks are 32 bits wide. */
    if (voxels >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has %u voxels; triangles can be attached to 2^32 - 2",
                             surface_name, voxels);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the voxels' ranks", &prefix));
    bvxi_rank_build(&job->rank, job->grid->words, words, prefix);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, voxels * 4, "the voxels' last triangles", &job->last));
    bvx_status const status = fill_lists(ctx, job, voxels, &made);

    /* Filled in apart from the caller's lists, which stay until these are complete. */
    if (status != BVX_OK) {
        bvx_attached_free(ctx, &made);
        return status;
    }
    bvx_attached_free(ctx, attached);
    *attached = made;
    return BVX_OK;
}

static const bvxi_option surface_option_rows[] = {
    BVXI_CHOICE(bvx_surface_options, mode, BVX_SURFACE_CONSERVATIVE, BVX_SURFACE_SAMPLED),
    BVXI_RESERVED(bvx_surface_options, reserved),
};

static bvx_status run_surface(bvx_context *ctx, const char *function, const bvx_surface_options *o,
                              bvxi_surface_job *job)
{
    BVXI_TRY(bvxi_snap(ctx, function, job->view, &job->grid->lattice, &job->snapped));
    BVXI_TRY(bvxi_bins_open(ctx, function, job));
    BVXI_TRY(touch_tiles(ctx, job, BVXI_TOUCH_SET, 0.2, o->attached != NULL ? 0.4 : 1.0));
    return o->attached != NULL ? attach_triangles(ctx, job, o->attached) : BVX_OK;
}

/* A job for a grid that is open; the mesh and the lattice have been checked. */
static void begin_surface(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t mode, int attach,
                          const bvx_grid *grid, bvxi_surface_job *job)
{
    memset(job, 0, sizeof *job);
    job->view = mesh;
    job->grid = grid;
    job->fraction_bits = grid->lattice.fraction_bits;
    job->mode = mode;
    job->cpu = bvxi_cpu(ctx);
    memcpy(job->size, grid->size, sizeof job->size);
    memcpy(job->low, grid->low, sizeof job->low);

    /* One thread takes all triangles as they come. So do several with a grid each where these are small
     * beside the mesh: the work of one thread, shared. Lists of attached triangles have to be in order; they,
     * and large grids, get some tiles a thread, so that none waits long for the last one. Large tiles are cut
     * further, so that they are not long without a report. */
    uint64_t const triangles = job->view->triangle_count, words = bvxi_grid_words(job->grid);
    int32_t const threads = bvxi_threads(ctx);
    int32_t tiles = 8 * threads;
    /* Of hundreds of workers the counts take more than the grids. */
    uint64_t const apart = words * 8 + sizeof *job->helpers;

    job->pieces = 1;
    if (threads == 1) {
        tiles = 1;
        job->pieces = bvxi_piece_count(triangles, SURFACE_GRAIN);
    } else if (!attach && apart <= triangles * APART_BYTES / (uint64_t)(threads - 1)) {
        tiles = 1;
        job->pieces = bvxi_piece_count(triangles, APART_GRAIN);
        job->helper_count = threads - 1;
    } else if (threads >= BVXI_SURFACE_TILES / 8 || words > LARGE_GRID) {
        tiles = BVXI_SURFACE_TILES;
    }
    bvxi_tiles_choose(&job->tiles, job->size[1], job->size[2], tiles);
}

bvx_status bvxi_lost_surface(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_grid *solid, bvx_grid *lost, double beyond[3])
{
    bvx_surface_options const o = {0};
    bvxi_surface_job job;

    /* A thin surface of what the solid does not show; the grid is the caller's and already open. */
    begin_surface(ctx, mesh, BVX_SURFACE_THIN, 0, lost, &job);
    job.solid = solid;
    job.summed = beyond != NULL;
    BVXI_TRY(BVXI_SCOPE(ctx, run_surface(ctx, function, &o, &job)));
    for (int a = 0; beyond != NULL && a < 3; a++) {
        int64_t sum = 0;
        for (int32_t t = 0; t < job.tiles.count; t++) sum += job.beyond[t][a];
        beyond[a] = (double)sum / 65536.0;
    }
    return BVX_OK;
}

static bvx_status run_voxelize_surface(bvx_context *context, const bvx_mesh_view *mesh,
                                       const bvx_lattice *lattice, const bvx_surface_options *options,
                                       bvx_grid *surface)
{
    bvx_surface_options o;
    bvx_window window;
    bvxi_surface_job job;

    if (surface == NULL) return bvxi_fail_null(context, surface_name, "surface");

    BVXI_TRY(bvxi_take_options(context, surface_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, surface_name, &o, BVXI_OPTIONS(surface_option_rows)));
    if (o.attached != NULL && o.attached->offsets == NULL && o.attached->triangles != NULL)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: attached brings triangles, which are not used; zero it first",
                             surface_name);
    BVXI_TRY(bvxi_view_check(context, surface_name, mesh));
    if (mesh->triangle_count == 0)
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", surface_name);
    BVXI_TRY(bvxi_lattice_check(context, surface_name, lattice));
    BVXI_TRY(bvxi_window_take(context, surface_name, lattice, &o.window, &window));

    bvxi_grid_renew(context, lattice, &window, surface);

    bvx_grid made = *surface;
    BVXI_TRY(bvxi_grid_open(context, surface_name, lattice, &window, &made));
    begin_surface(context, mesh, o.mode, o.attached != NULL, &made, &job);
    bvx_status const status = run_surface(context, surface_name, &o, &job);
    BVXI_TRY(bvxi_grid_put(context, status, &made, surface));
    if (o.report == NULL) return BVX_OK;
    *o.report = (bvx_surface_report){0};
    for (int32_t t = 0; t < job.tiles.count; t++) {
        o.report->triangles += job.used[t];
        o.report->samples += job.samples[t];
        o.report->parts += job.parts[t];
    }
    return BVX_OK;
}

bvx_status bvx_voxelize_surface(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                const bvx_surface_options *options, bvx_grid *surface)
{
    return BVXI_CALL(context, run_voxelize_surface(context, mesh, lattice, options, surface));
}

bvx_status bvxi_shell_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *solid,
                           bvx_grid *shell)
{
    uint64_t const words = bvxi_grid_words(solid);
    bvx_surface_options o = {.struct_size = sizeof o};

    memcpy(o.window.low, solid->low, sizeof o.window.low);
    memcpy(o.window.size, solid->size, sizeof o.window.size);
    memset(shell, 0, sizeof *shell);

    /* Scratch of the caller's size: the shell lives no longer than the step that needs it. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, words * 8, "the conservative surface", &shell->words));
    shell->word_capacity = words;
    return bvx_voxelize_surface(ctx, mesh, &solid->lattice, &o, shell);
}
