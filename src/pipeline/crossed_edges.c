/* crossed_edges.c - the centres that have a neighbour on the other side of a surface: only these need a
 * distance. 64 at a time, from a word and its six neighbours. */
#include "nearest/nearest.h"
#include "pipeline/steps.h"

enum { ENDS_GRAIN = 4096 /* least words a piece */ };

typedef struct ends_job {
    const bvx_grid *inside, *body; /* body: inside itself when there is none */
    bvx_grid *where;
} ends_job;

/* Bits of word i that differ from those of word n in both grids. */
static uint64_t differ(const ends_job *job, size_t i, size_t n)
{
    return (job->inside->words[i] ^ job->inside->words[n]) & (job->body->words[i] ^ job->body->words[n]);
}

static uint64_t differ_along_row(const uint64_t *row, int32_t words, int32_t k, int up)
{
    uint64_t const next = up ? row[k] >> 1 | (k + 1 < words ? row[k + 1] << 63 : 0)
                             : row[k] << 1 | (k > 0 ? row[k - 1] >> 63 : 0);
    return row[k] ^ next;
}

static void mark_ends_piece(void *user, uint64_t begin, uint64_t end)
{
    const ends_job *const job = user;
    const bvx_grid *const g = job->inside;
    size_t const words = (size_t)g->words_per_row, slice = words * (size_t)g->size[1];
    uint64_t const rows = (uint64_t)g->size[1];

    /* A piece takes rows: no two write one word. */
    for (uint64_t r = begin; r < end; r++) {
        int32_t const y = (int32_t)(r % rows), z = (int32_t)(r / rows);
        size_t const at = (size_t)r * words;
        for (int32_t k = 0; k < g->words_per_row; k++) {
            size_t const i = at + (size_t)k;
            uint64_t found = 0;
            for (int up = 0; up < 2; up++)
                found |= differ_along_row(g->words + at, g->words_per_row, k, up) &
                         differ_along_row(job->body->words + at, g->words_per_row, k, up);
            if (y > 0) found |= differ(job, i, i - words);
            if (y + 1 < g->size[1]) found |= differ(job, i, i + words);
            if (z > 0) found |= differ(job, i, i - slice);
            if (z + 1 < g->size[2]) found |= differ(job, i, i + slice);
            job->where->words[i] = found;
        }
        /* Bits past the row's end are no centres. */
        job->where->words[at + words - 1] &= bvxi_tail_mask(g->size[0]);
    }
}

bvx_status bvxi_ends_mark(bvx_context *ctx, const bvx_grid *inside, const bvx_grid *body, bvx_grid *where)
{
    ends_job job;
    job.inside = inside;
    job.body = body != NULL ? body : inside;
    job.where = where;
    return bvxi_for(ctx, "ends", bvxi_grid_rows(inside), 1 + ENDS_GRAIN / (uint64_t)inside->words_per_row,
                    mark_ends_piece, &job);
}

bvx_status bvxi_measure_ends(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, double off,
                             const bvxi_sparse *values)
{
    const bvx_lattice *const lattice = &values->where.lattice;
    /* As far as an edge is long; a little more for rounding. */
    double const guess = (off + bvxi_largest_spacing(lattice)) * (1 + 1e-6);
    bvxi_nearest *nearest = NULL;

    BVXI_TRY(bvxi_nearest_open(bvxi_call_of(ctx, function, "measure", 0.0, 0.4), mesh, lattice, &nearest));
    bvxi_nearest_prefer_planes(nearest);
    bvx_status const status = bvxi_nearest_fill(bvxi_call_of(ctx, NULL, "measure", 0.4, 1.0), nearest, guess,
                                                values);
    bvxi_nearest_close(ctx, nearest);
    return status;
}
