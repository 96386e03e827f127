/* repair_parts.c - small parts of a solid dropped, small cavities filled.
 *
 * Parts are connected through faces, cavities through faces too (with marching cubes' face rule SEPARATE a cavity's empty corners may
 * touch beyond; they stay cavities of their own). A space of empty voxels is a cavity when it does not touch the window's sides. */
#include "grid/spaces.h"
#include "pipeline/repair.h"

/* Sizes of the spaces of one kind, and what becomes of them. */
typedef struct part_sizes {
    const bvx_grid *grid;
    uint64_t *voxels; /* by space; outside: UINT64_MAX */
    uint64_t *out;    /* words that small spaces are toggled in, or NULL */
    uint64_t least;
    int32_t empty;
} part_sizes;

static void measure_part(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    part_sizes *const p = user;
    if (p->empty && bvxi_spaces_at_side(p->grid, begin, end, y, z)) p->voxels[space] = UINT64_MAX;
    if (p->voxels[space] != UINT64_MAX) p->voxels[space] += (uint64_t)(end - begin);
}

static void toggle_part(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const part_sizes *const p = user;
    uint64_t *const row = p->out + ((size_t)z * (size_t)p->grid->size[1] + (size_t)y) * (size_t)p->grid->words_per_row;
    if (p->voxels[space] >= p->least) return;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] ^= bvxi_run_mask(begin, end, k);
}

/* Toggle what is small in a copy, which becomes the grid's words. */
static bvx_status toggle_small(bvx_context *ctx, const bvxi_spaces *spaces, part_sizes *p, bvx_grid *grid)
{
    uint64_t const bytes = bvxi_grid_words(grid) * 8;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the solid without small parts", &p->out));
    memcpy(p->out, grid->words, (size_t)bytes);
    bvxi_spaces_each(spaces, toggle_part, p);
    memcpy(grid->words, p->out, (size_t)bytes);
    bvxi_free(ctx, p->out, bytes);
    return BVX_OK;
}

/* Spaces below least are toggled; *kept and *gone count parts or cavities. */
static bvx_status clean_spaces(bvxi_repair_job *job, int32_t empty, uint64_t least, uint64_t *kept, uint64_t *gone)
{
    bvxi_spaces spaces;
    part_sizes p = {0};
    bvx_status status;
    BVXI_TRY(bvxi_spaces_open(job->ctx, bvxi_repair_name, "repair", &job->inside, empty, BVXI_CONNECT_6, &spaces));
    p.grid = &job->inside;
    p.empty = empty;
    p.least = least;
    status = bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, spaces.count * 8, "the sizes of parts", &p.voxels);
    if (status == BVX_OK) {
        bvxi_spaces_each(&spaces, measure_part, &p);
        *kept = *gone = 0;
        for (uint64_t i = 0; i < spaces.count; i++) {
            if (p.voxels[i] == UINT64_MAX) continue;
            *(p.voxels[i] < least ? gone : kept) += 1;
        }
        if (*gone != 0) status = toggle_small(job->ctx, &spaces, &p, &job->inside);
        bvxi_free(job->ctx, p.voxels, spaces.count * 8);
    }
    bvxi_spaces_free(&spaces);
    return status;
}

bvx_status bvxi_repair_clean(bvxi_repair_job *job)
{
    const bvx_repair_options *const o = job->options;
    bvx_repair_report *const r = &job->report;
    if (o->least_part > 1 || o->report != NULL)
        BVXI_TRY(clean_spaces(job, 0, o->least_part, &r->parts_kept, &r->parts_dropped));
    if (o->least_cavity > 1 || o->report != NULL)
        BVXI_TRY(clean_spaces(job, 1, o->least_cavity, &r->cavities_kept, &r->cavities_dropped));
    return BVX_OK;
}
