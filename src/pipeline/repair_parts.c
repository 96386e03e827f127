/* repair_parts.c - small parts of a solid dropped, small cavities filled.
 *
 * Parts are connected through faces, cavities through faces too (with marching cubes' face rule SEPARATE a
 * cavity's empty corners may touch beyond; they stay cavities of their own). A space of empty voxels is a
 * cavity when it does not touch the window's sides. */
#include "components/room.h"
#include "pipeline/steps.h"
#include "pipeline/repair.h"

/* Mark the spaces below least; *kept and *gone count parts or cavities. */
static void judge_parts(const uint64_t *voxels, uint8_t *marks, uint64_t count, uint64_t least,
                        uint64_t *kept, uint64_t *gone)
{
    *kept = *gone = 0;

    /* What touches the window's side is the outside. */
    for (uint64_t i = 0; i < count; i++) {
        int const outside = marks[i] != 0;
        marks[i] = !outside && voxels[i] < least;
        if (!outside) *(marks[i] ? gone : kept) += 1;
    }
}

/* Spaces below least change: parts (empty 0) are dropped, cavities (1) filled. */
static bvx_status clean_spaces(bvxi_repair_job *job, int32_t empty, uint64_t least, uint64_t *kept,
                               uint64_t *gone)
{
    bvxi_spaces spaces;
    uint64_t *voxels = NULL;
    uint8_t *marks = NULL; /* at a side of the window at first: that is no cavity */
    bvx_status status;

    BVXI_TRY(
        bvxi_spaces_open(job->ctx, bvxi_repair_name, "repair", &job->inside, empty, BVXI_CONNECT_6, &spaces));
    uint64_t const count = spaces.count;
    status = bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, count * 8, "the sizes of parts", &voxels);
    if (status == BVX_OK)
        status = bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, count, "the marks of parts", &marks);
    if (status == BVX_OK) {
        /* Parts need no look at the sides: they are cut off by none. */
        bvxi_spaces_measure(&spaces, voxels, empty ? marks : NULL);
        judge_parts(voxels, marks, count, least, kept, gone);
        if (*gone != 0) bvxi_spaces_flip(&spaces, marks, job->inside.words);
    }
    bvxi_drop(job->ctx, marks);
    bvxi_drop(job->ctx, voxels);
    bvxi_spaces_free(&spaces);
    return status;
}

bvx_status bvxi_repair_clean(bvxi_repair_job *job)
{
    const bvx_repair_options *const o = job->options;
    bvx_repair_report *const r = &job->report;
    bvxi_crumb_source const source = {&job->mesh, job->piece};
    uint64_t crumbs[2] = {0, 0};

    for (int32_t empty = 0; empty < 2 && !o->keep_crumbs; empty++)
        BVXI_TRY(
            bvxi_drop_crumbs(job->ctx, bvxi_repair_name, &job->inside, empty, &source, 1, &crumbs[empty]));
    r->crumbs = crumbs[0] + crumbs[1];

    if (o->least_part > 1 || o->report != NULL)
        BVXI_TRY(clean_spaces(job, 0, o->least_part, &r->parts_kept, &r->parts_dropped));
    if (o->least_cavity > 1 || o->report != NULL)
        BVXI_TRY(clean_spaces(job, 1, o->least_cavity, &r->cavities_kept, &r->cavities_dropped));
    r->parts_dropped += crumbs[0];
    r->cavities_dropped += crumbs[1];
    return BVX_OK;
}
