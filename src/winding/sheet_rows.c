/* sheet_rows.c - columns of blocks, each with the sheet's turns, handed to a rule; the sheet as a mesh.
 *
 * A task is a column of 32 x 32 rows, so that all of a row is filled by one worker, from low x to high.
 * Stretches without turns are handed over as one. */
#include "winding/turns.h"
#include "bits/sort.h"

typedef struct bvxi_turns_worker {
    bvxi_turns_block block;
    bvxi_row_codes mesh[BVXI_TURNS_ROWS];
} bvxi_turns_worker;

static bvxi_row_codes sorted_row(const bvxi_row_lists *lists, uint64_t row)
{
    uint64_t const begin = row == 0 ? 0 : lists->row_end[row - 1];
    bvxi_row_codes r;
    r.code = lists->crossing + begin;
    r.count = (uint32_t)(lists->row_end[row] - begin);
    if (r.count > 1) bvxi_sort_i32(lists->crossing + begin, r.count);
    return r;
}

/* The column's rows; y, z: of the block of rows that is filled. */
static uint64_t start_column(const bvxi_turns_job *job, bvxi_turns_worker *w, int32_t y, int32_t z)
{
    const bvxi_row_block *const rows = &job->solid->block;
    bvxi_turns_block *const b = &w->block;
    uint64_t odd = 0;

    b->sheet = job->sheet;
    b->ties = job->ties;
    b->want_clear = job->clear != NULL;
    b->all_open = job->known == NULL;
    b->low[1] = rows->y0 + y;
    b->low[2] = rows->z0 + z;
    b->size[1] = rows->ny - y < BVXI_TURNS_SIDE ? rows->ny - y : BVXI_TURNS_SIDE;
    b->size[2] = rows->nz - z < BVXI_TURNS_SIDE ? rows->nz - z : BVXI_TURNS_SIDE;
    for (int32_t k = 0; k < b->size[2]; k++)
        for (int32_t j = 0; j < b->size[1]; j++) {
            uint32_t const at = bvxi_turns_row(j, k);
            uint64_t const row = bvxi_block_row(job->solid, y + j, z + k);
            int64_t sum = 0;
            b->crossed[at] = sorted_row(job->crossed, row);
            /* The sum over a row is 0 where the mesh is closed there; others are counted. */
            if (job->mesh == NULL) continue;
            w->mesh[at] = sorted_row(job->mesh, row);
            for (uint32_t i = 0; i < w->mesh[at].count; i++) sum += (w->mesh[at].code[i] & 1) != 0 ? -1 : 1;
            odd += sum != 0;
        }
    return odd;
}

static void start_block(const bvxi_turns_job *job, bvxi_turns_block *b, int32_t x)
{
    const bvx_grid *const g = job->grid;

    b->low[0] = g->low[0] + x;
    b->size[0] = g->size[0] - x < BVXI_TURNS_SIDE ? g->size[0] - x : BVXI_TURNS_SIDE;
    /* Bits of the block that exist; what is known already need not be evaluated. */
    uint32_t const all = b->size[0] == 32 ? UINT32_MAX : ((uint32_t)1 << b->size[0]) - 1;
    for (int32_t k = 0; k < b->size[2]; k++)
        for (int32_t j = 0; j < b->size[1]; j++) {
            uint32_t const row = bvxi_turns_row(j, k);
            uint64_t const word = bvxi_turns_word(job, b, j, k) + (uint64_t)(x >> 6);
            b->open[row] = all &
                           (job->known != NULL ? (uint32_t)(~job->known[word] >> (x & 63)) : UINT32_MAX);
        }
    if (b->want_clear) memset(b->clear, 0, sizeof b->clear);
}

static void turns_column(void *user, int32_t column, int32_t worker)
{
    const bvxi_turns_job *const job = user;
    bvxi_turns_worker *const w = job->worker + worker;
    int32_t const nx = job->grid->size[0];
    uint64_t const odd = start_column(job, w, column % job->columns_y * BVXI_TURNS_SIDE,
                                      column / job->columns_y * BVXI_TURNS_SIDE);
    int32_t done = 0; /* up to here the rule has been asked */

    /* Along the row, block by block; stretches without turns wait until something comes. */
    if (job->mesh != NULL) job->odd_rows[column] = odd;
    for (int32_t x = 0; x < nx; x += BVXI_TURNS_SIDE) {
        start_block(job, &w->block, x);
        bvxi_sheet_block(&w->block);
        /* No turns and nothing known: the rule is called for it later, with its neighbours. */
        if (!w->block.dirty && job->known == NULL) continue;
        /* What was put off lies before this block, and has no turns. */
        if (done < x) {
            w->block.dirty = 0; /* in what lies before it */
            job->rule(job, &w->block, w->mesh, done, x);
            w->block.dirty = 1;
        }
        done = x + w->block.size[0];
        job->rule(job, &w->block, w->mesh, x, done);
        if (w->block.dirty) memset(w->block.turns, 0, sizeof w->block.turns);
        /* Two blocks share a word, so bits are or-ed in. */
        for (int32_t k = 0; k < w->block.size[2] && w->block.want_clear; k++)
            for (int32_t j = 0; j < w->block.size[1]; j++) {
                uint64_t const clear = w->block.clear[bvxi_turns_row(j, k)];
                if (clear != 0)
                    job->clear[bvxi_turns_word(job, &w->block, j, k) + (uint64_t)(x >> 6)] |= clear
                                                                                              << (x & 63);
            }
    }
    w->block.dirty = 0;
    if (done < nx) job->rule(job, &w->block, w->mesh, done, nx);
}

bvx_status bvxi_turns_run(bvx_context *ctx, bvxi_turns_job *job, double from, double to, uint64_t *odd)
{
    const bvxi_row_block *const rows = &job->solid->block;
    uint64_t const bytes = (uint64_t)bvxi_threads(ctx) * sizeof *job->worker;
    const bvxi_sheet_tree *const tree = job->sheet->tree;
    uint64_t const cells = tree == NULL ? 0 : tree->pendings * BVXI_TURNS_LEVELS;
    uint64_t const cell_bytes = (uint64_t)bvxi_threads(ctx) * cells * 4;
    uint32_t *pending = NULL;

    job->columns_y = (rows->ny - 1) / BVXI_TURNS_SIDE + 1;
    job->columns = job->columns_y * ((rows->nz - 1) / BVXI_TURNS_SIDE + 1);

    /* Memory for each worker, not for each column: a block is used again. */
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the workers' blocks of turns", &job->worker));
    BVXI_TRY(BVXI_ZEROS(ctx, job->columns, "the columns' counts", job->odd_rows));
    if (tree != NULL) BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, cell_bytes, "the workers' cells", &pending));
    /* Each worker has a part of one block of memory for its cells. */
    for (int32_t w = 0; w < bvxi_threads(ctx) && pending != NULL; w++)
        job->worker[w].block.pending = pending + (uint64_t)w * cells;
    BVXI_TRY(bvxi_parallel(ctx, "solid", from, to, job->columns, turns_column, job));
    for (int32_t c = 0; c < job->columns; c++) *odd += job->odd_rows[c];
    return BVX_OK;
}

bvx_status bvxi_sheet_mesh_open(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_holes *holes,
                                bvx_mesh_view *sheet)
{
    uint32_t *corner = NULL;

    memset(sheet, 0, sizeof *sheet);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, holes->points * 12, "the sheet's triangles", &corner));

    /* The sheet uses the mesh's own vertices, so it needs corners only. */
    sheet->positions = view->positions;
    sheet->vertex_count = view->vertex_count;
    sheet->position_type = view->position_type;
    sheet->position_stride = view->position_stride;
    sheet->transform = view->transform;
    sheet->index_type = BVX_U32;
    sheet->indices = corner;
    sheet->triangle_count = bvxi_sheet_triangles(holes, corner);
    for (uint64_t i = 0; i < 3 * sheet->triangle_count; i++) corner[i] = holes->vertex[corner[i]];
    return BVX_OK;
}
