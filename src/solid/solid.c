/* solid.c - the rows of centres inside a mesh, along any axis.
 *
 * Source: the scanline solid of Lian. LOD by voxelization and downsampling (docs/papers.md, 3), section 2.3,
 * its offsets replaced by an exact tie rule (covered_rows.h).
 *
 * Vertices are snapped once. In rounds, chunks of triangles find their crossings with rows (crossings.c,
 * triangle_rows.c) and tiles of rows toggle one bit for each; at the end prefix parity turns toggles into
 * runs. Rows that do not balance are redone from their crossing lists; the rule nonzero makes lists for all
 * rows (solid_rows.c).
 * Guarantee: exact, and the same bits for any order of triangles, threads and windows. */
#include "solid/solid.h"

enum { CHUNK_GRAIN = 4096, CHUNK_GRID = 1 << 22 /* [Units: words] */ };

static bvx_status fill_parity_rows(bvx_context *ctx, bvxi_solid_job *job)
{
    uint64_t unbalanced = 0;

    BVXI_TRY(bvxi_solid_rounds(ctx, job, job->summed ? BVXI_TOGGLE_SUMMED : BVXI_TOGGLE, 0.05, 0.85));

    /* Lists of crossings are made for unbalanced rows only: sound meshes have none and never pay for
     * sorting. */
    for (int32_t t = 0; t < job->tiles.count; t++) unbalanced += job->unbalanced[t];
    if (unbalanced == 0 || job->keep_odd) return BVX_OK;
    job->listed = job->beyond;
    return bvxi_solid_lists(ctx, job, 0.85);
}

static bvx_status fill_block(bvx_context *ctx, bvxi_solid_job *job, bvx_solid_report *report)
{
    uint64_t const rows = (uint64_t)job->block.ny * (uint64_t)job->block.nz;
    bvx_status status;

    job->listed = NULL;
    memset(job->crossings, 0, sizeof job->crossings);
    memset(job->unbalanced, 0, sizeof job->unbalanced);
    memset(job->tile_sums, 0, sizeof job->tile_sums);
    /* Tiles by rows: no two workers write one row. */
    bvxi_tiles_choose(&job->tiles, job->block.ny, job->block.nz, BVXI_SOLID_TILES);
    BVXI_TRY(
        bvxi_snap_cells(ctx, &job->grid->lattice, &job->block, bvxi_solid_progress(job, 0), &job->snapped));
    /* A rule of its own takes the lists; else toggles are the quick way. */
    if (job->take_lists != NULL) {
        bvxi_row_lists lists;
        BVXI_TRY(bvxi_solid_gather(ctx, job, 0.1, 0.2, &lists));
        report->crossings += lists.total;
        status = job->take_lists(ctx, job, &lists, 0.2, 1.0);
        bvxi_row_lists_free(ctx, &lists);
    } else if (job->fill == BVX_FILL_BELOW) {
        status = bvxi_solid_rounds(ctx, job, BVXI_HIGHEST, 0.1, 1.0);
    } else {
        BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, rows, "the rows' balance", &job->beyond));
        status = job->fill == BVX_FILL_PARITY ? fill_parity_rows(ctx, job) : bvxi_solid_lists(ctx, job, 0.1);
        bvxi_drop(ctx, job->beyond);
    }

    for (int32_t t = 0; t < job->tiles.count; t++) {
        report->crossings += job->crossings[t];
        report->unbalanced_rows += job->unbalanced[t];
        job->signed_sum += job->tile_sums[t][0];
        job->parity_sum += job->tile_sums[t][1];
    }
    return status;
}

/* Blocks of at most 65535 x 65535 rows: sides that fit the 16 bits of a cell. */
bvx_status bvxi_solid_fill(bvxi_call step, bvxi_solid_job *job, const bvx_grid *g, int32_t axis, int32_t fill,
                           bvx_solid_report *report)
{
    int32_t const blocks = ((g->size[1] - 1) / BVXI_MAX_CELL_SIDE + 1) *
                           ((g->size[2] - 1) / BVXI_MAX_CELL_SIDE + 1);

    /* The engine always works along x. For another axis the snapped coordinates are permuted, which is
     * exact. */
    BVXI_TRY(bvxi_snap_turn(step.ctx, axis, step.from, &job->snapped));
    job->grid = g;
    job->fill = fill;
    job->progress_share = (step.to - step.from) / blocks;
    job->progress_from = step.from;
    for (int32_t z = 0; z < g->size[2]; z += BVXI_MAX_CELL_SIDE) {
        for (int32_t y = 0; y < g->size[1];
             y += BVXI_MAX_CELL_SIDE, job->progress_from += job->progress_share) {
            job->block.y0 = g->low[1] + y;
            job->block.z0 = g->low[2] + z;
            job->block.ny = g->size[1] - y < BVXI_MAX_CELL_SIDE ? g->size[1] - y : BVXI_MAX_CELL_SIDE;
            job->block.nz = g->size[2] - z < BVXI_MAX_CELL_SIDE ? g->size[2] - z : BVXI_MAX_CELL_SIDE;
            BVXI_TRY(fill_block(step.ctx, job, report));
        }
    }
    return BVX_OK;
}

bvx_status bvxi_solid_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                           const bvx_lattice *lattice, bvxi_solid_job *job)
{
    memset(job, 0, sizeof *job);
    job->function = function;
    job->view = mesh;
    job->fraction_bits = lattice->fraction_bits;
    job->cpu = bvxi_cpu(ctx);

    /* The buffers of chunks and workers: one block of scratch. */
    uint64_t const triangles = job->view->triangle_count;
    uint64_t const workers = (uint64_t)bvxi_threads(ctx);
    bvxi_crossing *found;
    uint32_t *large;

    /* Chunks are pieces of the mesh, whatever the threads are. */
    job->chunks = bvxi_piece_count(triangles, CHUNK_GRAIN);
    if (job->chunks > BVXI_SOLID_CHUNKS) job->chunks = BVXI_SOLID_CHUNKS;
    /* A small mesh takes a few rounds more, in a quarter of the memory; beside a large grid that is little, and each
     * round visits all of it. */
    job->buffer = triangles < CHUNK_GRAIN                      ? BVXI_SOLID_BUFFER / 4
                  : bvx_grid_bound(lattice, NULL) < CHUNK_GRID ? BVXI_SOLID_BUFFER
                                                               : 2 * BVXI_SOLID_BUFFER;
    job->at_once = triangles < CHUNK_GRAIN ? BVXI_CROSS_BATCH / 4 : BVXI_CROSS_BATCH - BVXI_CROSS_LEFT;

    uint64_t const chunks = (uint64_t)job->chunks, bytes = job->buffer * sizeof *found;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH,
                        workers * (sizeof *job->batch + bytes) +
                            chunks * (sizeof *job->chunk + bytes + BVXI_SOLID_LARGE * sizeof *large),
                        "the crossing buffers", &job->batch));
    job->chunk = (bvxi_chunk *)(void *)(job->batch + workers);
    found = (bvxi_crossing *)(void *)(job->chunk + chunks);
    large = (uint32_t *)(void *)(found + (workers + chunks) * job->buffer);

    for (uint64_t w = 0; w < workers; w++, found += job->buffer) job->batch[w].found = found;
    for (uint64_t c = 0; c < chunks; c++, found += job->buffer, large += BVXI_SOLID_LARGE) {
        job->chunk[c].sorted = found;
        job->chunk[c].large = large;
    }
    return bvxi_snap(ctx, function, mesh, lattice, &job->snapped);
}

void bvxi_solid_close(bvx_context *ctx, bvxi_solid_job *job)
{
    bvxi_snap_free(ctx, &job->snapped);
    bvxi_drop(ctx, job->batch);
    job->batch = NULL;
}
