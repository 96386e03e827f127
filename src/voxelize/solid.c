/* solid.c - the voxels whose centres lie inside a mesh.
 *
 * Source: the scanline solid of "LOD by voxelization and downsampling" 2.3, its offsets replaced by an exact tie rule
 * (cover.h).
 *
 * Vertices are snapped once. In rounds, chunks of triangles find their crossings with rows (crossings.c, spans.c) and
 * tiles of rows toggle one bit for each; at the end prefix parity turns toggles into runs. Rows that do not balance are
 * redone from their crossing lists; the rule nonzero makes lists for all rows (solid_rows.c).
 * Guarantee: exact, and the same bits for any order of triangles, threads and windows. */
#include "voxelize/solid.h"

enum { CHUNK_GRAIN = 4096 };
#define CHUNK_BYTES (sizeof(bvxi_chunk) + BVXI_SOLID_BUFFER * sizeof(bvxi_crossing) + BVXI_SOLID_LARGE * sizeof(uint32_t))

static const char solid_name[] = "bvx_voxelize_solid";
static const bvx_voxelize_options voxelize_defaults = {0};

void bvx_voxelize_options_init(bvx_voxelize_options *options, size_t size)
{
    bvxi_give_options(options, size, &voxelize_defaults, sizeof voxelize_defaults);
}

/* ---- tiles ---- */

/* Pieces of n items in steps of 2^shift. */
static inline int32_t shifted_pieces(int32_t n, int32_t shift)
{
    return ((n - 1) >> shift) + 1;
}

static void choose_tiles(bvxi_solid_job *job)
{
    int32_t const ny = job->block.ny, nz = job->block.nz;
    job->y_shift = job->z_shift = 0;
    while (shifted_pieces(ny, job->y_shift) > 1) job->y_shift++;
    while (shifted_pieces(nz, job->z_shift) > BVXI_SOLID_TILES) job->z_shift++;
    job->tiles_z = shifted_pieces(nz, job->z_shift);
    while (job->y_shift > 0 && job->tiles_z * shifted_pieces(ny, job->y_shift - 1) <= BVXI_SOLID_TILES) job->y_shift--;
    job->tiles_y = shifted_pieces(ny, job->y_shift);
    job->tiles = job->tiles_y * job->tiles_z;
}

/* ---- rounds ---- */

static inline void take_crossing(bvxi_solid_job *job, uint32_t at, int32_t code, int mode)
{
    int32_t const j = (int32_t)(at & 0xffff), k = (int32_t)(at >> 16);
    uint64_t const row = bvxi_block_row(job, j, k);
    if (mode == BVXI_TOGGLE) {
        int32_t const x = bvxi_floor_shift(code, 1) - job->grid->low[0];
        if (x < job->grid->size[0]) {
            int32_t const bit = x < 0 ? 0 : x;
            bvxi_block_words(job, j, k)[bit >> 6] ^= UINT64_C(1) << (bit & 63);
        } else {
            job->beyond[row] ^= 1;
        }
    } else if (job->listed == NULL || job->listed[row]) {
        if (mode == BVXI_FILL_LIST) job->crossing[job->row_end[row]] = code;
        job->row_end[row]++;
    }
}

typedef struct tile_sink {
    bvxi_solid_job *job;
    int32_t tile;
} tile_sink;

static void take_large(void *user, uint32_t row, int32_t code)
{
    tile_sink *const sink = user;
    if (sink->job->mode == BVXI_TOGGLE) sink->job->crossings[sink->tile]++;
    take_crossing(sink->job, row, code, sink->job->mode);
}

static void take_tile(void *user, int32_t tile, int32_t worker)
{
    bvxi_solid_job *const job = user;
    bvxi_rows const rows = bvxi_tile_rows(job, tile);
    tile_sink sink = {job, tile};
    (void)worker;
    for (int32_t c = 0; c < job->chunks; c++) {
        const bvxi_chunk *const chunk = job->chunk + c;
        uint32_t const begin = chunk->tile_end[tile], end = chunk->tile_end[tile + 1];
        const bvxi_crossing *const x = chunk->sorted;
        if (job->mode == BVXI_TOGGLE) {
            for (uint32_t i = begin; i < end; i++) take_crossing(job, x[i].row, x[i].code, BVXI_TOGGLE);
            job->crossings[tile] += end - begin;
        } else {
            for (uint32_t i = begin; i < end; i++) take_crossing(job, x[i].row, x[i].code, job->mode);
        }
        for (uint32_t i = 0; i < chunk->large_count; i++) bvxi_cover_spans(job, rows, chunk->large[i], take_large, &sink);
    }
}

bvx_status bvxi_solid_rounds(bvx_context *ctx, bvxi_solid_job *job, int32_t mode, double from, double to)
{
    uint64_t const all = job->view->triangle_count;
    uint64_t left = all;
    job->mode = mode;
    for (int32_t c = 0; c < job->chunks; c++) {
        bvxi_piece(all, job->chunks, c, &job->chunk[c].next, &job->chunk[c].end);
        job->chunk[c].bad = UINT64_MAX;
        job->chunk[c].used = 0;
    }
    while (left > 0) {
        double const at = bvxi_solid_progress(job, from + (to - from) * (1.0 - (double)left / (double)all));
        BVXI_TRY(bvxi_parallel(ctx, "solid", at, at, job->chunks, bvxi_find_crossings, job));
        left = 0;
        for (int32_t c = 0; c < job->chunks; c++) {
            if (job->chunk[c].bad != UINT64_MAX) return bvxi_view_fail_index(ctx, solid_name, job->view, job->chunk[c].bad);
            left += job->chunk[c].end - job->chunk[c].next;
        }
        BVXI_TRY(bvxi_parallel(ctx, "solid", at, at, job->tiles, take_tile, job));
    }
    return BVX_OK;
}

/* ---- toggles to runs ---- */

/* Bit i becomes the parity of the toggles at 0..i. Returns the parity of them all. */
static uint32_t close_row(uint64_t *words, int32_t n)
{
    uint64_t carry = 0;
    for (int32_t k = 0; k < n; k++) {
        uint64_t const w = words[k];
        if (w == 0) {
            words[k] = carry;
            continue;
        }
        words[k] = bvxi_prefix_parity(w) ^ carry;
        carry = 0 - (words[k] >> 63);
    }
    return (uint32_t)(carry & 1);
}

static void clear_tile(void *user, int32_t tile, int32_t worker)
{
    bvxi_solid_job *const job = user;
    bvxi_rows const r = bvxi_tile_rows(job, tile);
    size_t const slice_bytes = (size_t)(r.j1 - r.j0) * (size_t)job->grid->words_per_row * 8;
    (void)worker;
    for (int32_t k = r.k0; k < r.k1; k++) memset(bvxi_block_words(job, r.j0, k), 0, slice_bytes);
}

static void close_tile(void *user, int32_t tile, int32_t worker)
{
    bvxi_solid_job *const job = user;
    const bvx_grid *const g = job->grid;
    bvxi_rows const r = bvxi_tile_rows(job, tile);
    uint64_t const tail = bvxi_tail_mask(g->size[0]);
    (void)worker;
    for (int32_t k = r.k0; k < r.k1; k++) {
        for (int32_t j = r.j0; j < r.j1; j++) {
            uint64_t *const words = bvxi_block_words(job, j, k);
            uint64_t const row = bvxi_block_row(job, j, k);
            uint32_t const odd = close_row(words, g->words_per_row) ^ job->beyond[row];
            words[g->words_per_row - 1] &= tail;
            job->beyond[row] = (uint8_t)odd; /* from here on: rows that do not balance */
            job->unbalanced[tile] += odd;
        }
    }
}

static bvx_status fill_parity_rows(bvx_context *ctx, bvxi_solid_job *job)
{
    uint64_t unbalanced = 0;
    BVXI_TRY(bvxi_parallel(ctx, "solid", bvxi_solid_progress(job, 0.1), bvxi_solid_progress(job, 0.15), job->tiles, clear_tile, job));
    BVXI_TRY(bvxi_solid_rounds(ctx, job, BVXI_TOGGLE, 0.15, 0.4));
    BVXI_TRY(bvxi_parallel(ctx, "solid", bvxi_solid_progress(job, 0.4), bvxi_solid_progress(job, 0.5), job->tiles, close_tile, job));
    for (int32_t t = 0; t < job->tiles; t++) unbalanced += job->unbalanced[t];
    if (unbalanced == 0) return BVX_OK;
    job->listed = job->beyond;
    return bvxi_solid_lists(ctx, job);
}

/* ---- a block, a grid ---- */

static bvx_status fill_block(bvx_context *ctx, bvxi_solid_job *job, bvx_solid_report *report)
{
    uint64_t const rows = (uint64_t)job->block.ny * (uint64_t)job->block.nz;
    bvx_status status;
    job->listed = NULL;
    memset(job->crossings, 0, sizeof job->crossings);
    memset(job->unbalanced, 0, sizeof job->unbalanced);
    memset(job->dropped, 0, sizeof job->dropped);
    choose_tiles(job);
    BVXI_TRY(bvxi_snap_cells(ctx, &job->grid->lattice, &job->block, bvxi_solid_progress(job, 0), &job->snapped));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, rows, "the rows' balance", &job->beyond));
    status = job->fill == BVX_FILL_PARITY ? fill_parity_rows(ctx, job) : bvxi_solid_lists(ctx, job);
    bvxi_free(ctx, job->beyond, rows);
    for (int32_t c = 0; c < job->chunks; c++) report->triangles_used += job->chunk[c].used;
    for (int32_t t = 0; t < job->tiles; t++) {
        report->crossings += job->crossings[t];
        report->unbalanced_rows += job->unbalanced[t];
        report->dropped += job->dropped[t];
    }
    return status;
}

/* Blocks of at most 65535 x 65535 rows: sides that fit the 16 bits of a cell. */
static bvx_status fill_blocks(bvx_context *ctx, bvxi_solid_job *job, bvx_solid_report *report)
{
    const bvx_grid *const g = job->grid;
    int32_t const blocks = ((g->size[1] - 1) / BVXI_MAX_CELL_SIDE + 1) * ((g->size[2] - 1) / BVXI_MAX_CELL_SIDE + 1);
    job->progress_share = 0.9 / blocks; /* snapping had the first tenth */
    job->progress_from = 0.1;
    for (int32_t z = 0; z < g->size[2]; z += BVXI_MAX_CELL_SIDE) {
        for (int32_t y = 0; y < g->size[1]; y += BVXI_MAX_CELL_SIDE, job->progress_from += job->progress_share) {
            job->block.y0 = g->low[1] + y;
            job->block.z0 = g->low[2] + z;
            job->block.ny = g->size[1] - y < BVXI_MAX_CELL_SIDE ? g->size[1] - y : BVXI_MAX_CELL_SIDE;
            job->block.nz = g->size[2] - z < BVXI_MAX_CELL_SIDE ? g->size[2] - z : BVXI_MAX_CELL_SIDE;
            BVXI_TRY(fill_block(ctx, job, report));
        }
    }
    return BVX_OK;
}

static bvx_status check_arguments(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                  const bvx_voxelize_options *given, bvx_voxelize_options *o, bvx_window *window)
{
    BVXI_TRY(bvxi_take_options(ctx, solid_name, given, o, sizeof *o));
    if (o->fill != BVX_FILL_PARITY && o->fill != BVX_FILL_NONZERO)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: fill rule %d is unknown", solid_name, (int64_t)o->fill);
    if (o->reserved != 0) return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: reserved is not 0", solid_name);
    BVXI_TRY(bvxi_view_check(ctx, solid_name, mesh));
    if (mesh->triangle_count == 0) return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", solid_name);
    BVXI_TRY(bvxi_lattice_check(ctx, solid_name, lattice));
    return bvxi_window_take(ctx, solid_name, lattice, &o->window, window);
}

/* The chunks and their buffers: one block of scratch. */
static bvx_status open_job(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                           const bvx_voxelize_options *o, const bvx_grid *grid, bvxi_solid_job *job)
{
    unsigned char *memory;
    memset(job, 0, sizeof *job);
    job->view = mesh;
    job->grid = grid;
    job->fraction_bits = lattice->fraction_bits;
    job->fill = o->fill;
    job->cpu = bvxi_cpu(ctx);
    job->chunks = bvxi_piece_count(mesh->triangle_count, CHUNK_GRAIN);
    if (job->chunks > BVXI_SOLID_CHUNKS) job->chunks = BVXI_SOLID_CHUNKS;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)bvxi_threads(ctx) * sizeof *job->batch, "the workers' batches", &job->batch));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (uint64_t)job->chunks * CHUNK_BYTES, "the crossing buffers", &memory));
    job->chunk = (bvxi_chunk *)(void *)memory;
    memory += (size_t)job->chunks * sizeof *job->chunk;
    for (int32_t c = 0; c < job->chunks; c++, memory += BVXI_SOLID_BUFFER * sizeof(bvxi_crossing))
        job->chunk[c].sorted = (bvxi_crossing *)(void *)memory;
    for (int32_t c = 0; c < job->chunks; c++, memory += BVXI_SOLID_LARGE * sizeof(uint32_t))
        job->chunk[c].large = (uint32_t *)(void *)memory;
    return BVX_OK;
}

static void close_job(bvx_context *ctx, bvxi_solid_job *job)
{
    bvxi_free(ctx, job->chunk, (uint64_t)job->chunks * CHUNK_BYTES);
    bvxi_free(ctx, job->batch, (uint64_t)bvxi_threads(ctx) * sizeof *job->batch);
}

bvx_status bvx_voxelize_solid(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                              const bvx_voxelize_options *options, bvx_grid *solid)
{
    bvx_voxelize_options o = voxelize_defaults;
    bvx_solid_report report = {0};
    bvx_window window;
    bvx_grid made;
    bvxi_solid_job job;
    bvx_status status;
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (solid == NULL) return bvxi_fail_null(context, solid_name, "solid");
    BVXI_TRY(check_arguments(context, mesh, lattice, options, &o, &window));
    made = *solid;
    BVXI_TRY(bvxi_grid_open(context, solid_name, lattice, &window, &made));
    status = open_job(context, mesh, lattice, &o, &made, &job);
    if (status == BVX_OK) status = bvxi_snap(context, solid_name, mesh, lattice, &job.snapped);
    if (status == BVX_OK) status = fill_blocks(context, &job, &report);
    bvxi_snap_free(context, &job.snapped);
    close_job(context, &job);
    if (status != BVX_OK) {
        if (solid->words == NULL) bvx_grid_free(context, &made);
        return status;
    }
    *solid = made;
    if (o.report != NULL) *o.report = report;
    return BVX_OK;
}
