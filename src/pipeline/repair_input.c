/* repair_input.c - what repair starts from: the lattice, and the mesh with each triangle once, its pieces
 * known and flipped triangles turned.
 *
 * A triangle that is there twice would count as two turns of the surface. Where a patch cannot be turned one
 * way the rule for inside becomes VOTE. */
#include "pipeline/repair.h"

/* ---- The lattice ---- */

/* The lattice that a mesh is repaired on: fitted to it with space for shells, or the caller's. */
bvx_status bvxi_repair_lattice(bvxi_repair_job *job, int32_t resolution)
{
    bvx_lattice_options const o = {.struct_size = sizeof o,
                                   .resolution = resolution,
                                   .padding = 2 + (int32_t)(job->options->shell * 0.5 + 0.5)};
    job->resolution = resolution;
    if (job->options->fit.lattice != NULL) {
        job->lattice = *job->options->fit.lattice;
        return BVX_OK;
    }
    return bvx_lattice_fit_with(job->ctx, &job->mesh, &o, &job->lattice);
}

/* ---- The mesh ---- */

const char bvxi_repair_name[] = "bvx_repair";

/* The minority of each patch is turned round, so that winding numbers are right; *sign becomes VOTE where
 * that is not to be had: a patch with one side only, or closed patches that stay against each other. */
static bvx_status turn_flipped(bvxi_repair_job *job, const double low[3], const double high[3],
                               const uint32_t *representative, int32_t *sign)
{
    bvxi_patches *const patches = &job->patches;
    double centre[3];

    /* Around the middle, so that volumes keep their digits. */
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * low[a] + 0.5 * high[a];
    BVXI_TRY(bvxi_patches_open(job->ctx, &job->mesh, representative, centre,
                               job->report.before.duplicates != 0, patches));
    if (patches->unorientable != 0 || (patches->odd_edges == 0 && patches->open_edges != 0)) {
        /* What only shows once triangles are there once each does not count. */
        if (job->report.before.flipped_edges != 0) *sign = BVX_FILL_VOTE;
        bvxi_patches_close(job->ctx, patches);
    } else if (patches->turned != 0) {
        /* Scratch may be there from leaving out copies. */
        if (job->corner == NULL)
            BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->given->triangle_count * 12,
                                "the turned triangles", &job->corner));
        bvxi_patches_turn(&job->mesh, patches, job->corner, &job->mesh);
        job->report.turned = patches->turned;
    }
    return BVX_OK;
}

void bvxi_repair_view(const bvxi_repair_job *job, const uint32_t *corner, uint64_t count, bvx_mesh_view *view)
{
    *view = *job->given;
    view->indices = corner;
    view->index_type = BVX_U32;
    view->index_stride = 0;
    view->triangle_count = count;
}

static bvx_status drop_duplicates(bvxi_repair_job *job, const uint32_t *representative)
{
    uint64_t kept;
    if (job->report.before.duplicates + job->report.before.collapsed == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->given->triangle_count * 12, "the triangles once each",
                        &job->corner));
    if (job->report.before.duplicates == 0)
        kept = bvxi_drop_collapsed(job->given, representative, job->corner);
    else BVXI_TRY(bvxi_drop_duplicates(job->ctx, job->given, representative, job->corner, &kept));
    bvxi_repair_view(job, job->corner, kept, &job->mesh);
    return BVX_OK;
}

/* What the mesh is; vertices and pieces are counted for the report only. */
static bvx_status check_given(bvxi_repair_job *job, const double low[3], const double high[3],
                              uint32_t *representative)
{
    bvx_certificate *const r = &job->report.before;
    /* Where bodies touch at vertices, pieces that are inside out are distinguished by edges. */
    int const edges_alone = job->options->report == NULL && !job->options->if_needed &&
                            job->options->sign != BVX_FILL_AUTO;
    bvxi_welded welded = {.view = job->given, .representative = representative};

    memcpy(welded.low, low, sizeof welded.low);
    memcpy(welded.high, high, sizeof welded.high);
    BVXI_TRY(bvxi_weld(job->ctx, job->given, representative, &welded.different));
    if (job->known != NULL) {
        *r = *job->known;
        r->collapsed = job->given->triangle_count - r->triangles;
        r->unused_vertices = welded.different - r->vertices;
    } else {
        BVXI_TRY(bvxi_check_welded(job->ctx, bvxi_repair_name, &welded, edges_alone, r));
    }
    if (r->triangles == r->degenerate)
        return bvxi_fail(job->ctx, BVX_ERR_EMPTY, "%s: none of the mesh's %u triangles has an area",
                         bvxi_repair_name, job->given->triangle_count);
    return BVX_OK;
}

/* Pieces that cross others are bodies, whatever box they lie in, and face outward: no cavity crosses any. */
static bvx_status mark_crossing(bvxi_repair_job *job, const uint32_t *representative,
                                const bvxi_piece_marks *by, bvxi_mesh_piece *pieces, uint64_t count)
{
    bvx_context *const ctx = job->ctx;
    uint64_t const marks = by->part != NULL ? job->mesh.triangle_count : job->given->vertex_count;
    bvxi_welded welded = {.view = &job->mesh, .representative = representative};
    uint64_t in_question = 0, pairs;
    uint32_t *pair;
    uint8_t *crosses;

    /* Most meshes have none, and no pair is looked for. */
    for (uint64_t n = 0; n < count; n++)
        in_question += pieces[n].volume6 < 0 ? !pieces[n].turned : pieces[n].turned;
    if (in_question == 0) return BVX_OK;
    memcpy(welded.low, job->report.before.box.low, sizeof welded.low);
    memcpy(welded.high, job->report.before.box.high, sizeof welded.high);
    BVXI_TRY(BVXI_SHARE(ctx, 0.9, 1.0, bvxi_mesh_crossings(ctx, &welded, UINT64_MAX, &pair, &pairs)));
    if (pairs == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, marks, "the pieces that cross", &crosses));
    for (uint64_t i = 0; i < pairs; i++) {
        uint32_t const a = bvxi_piece_mark(&job->mesh, by, pair[2 * i]);
        uint32_t const b = bvxi_piece_mark(&job->mesh, by, pair[2 * i + 1]);

        if (a != b) crosses[a] = crosses[b] = 1;
    }
    for (uint64_t n = 0; n < count; n++)
        if (crosses[pieces[n].mark]) pieces[n].turned = pieces[n].volume6 < 0;
    return BVX_OK;
}

/* Turn the pieces that face inward and are nobody's cavities, with all that lies in them. */
static bvx_status turn_inside_out(bvxi_repair_job *job, const uint32_t *representative,
                                  const bvxi_piece_marks *by, bvxi_mesh_piece *pieces, uint64_t count)
{
    uint64_t const triangles = job->mesh.triangle_count;
    bvx_mesh_view const mesh = job->mesh;
    uint64_t const marks = by->part != NULL ? triangles : job->given->vertex_count;
    uint8_t *turn; /* by a piece's mark: 1 where it is turned */

    uint64_t found = 0;

    bvxi_mark_inside_out(pieces, count);
    BVXI_TRY(BVXI_SCOPE(job->ctx, mark_crossing(job, representative, by, pieces, count)));
    for (uint64_t n = 0; n < count; n++) found += pieces[n].turned;
    /* Where every piece is inside out the solid is the same as where none is: nothing to turn. */
    if (found == 0 || found == count) return BVX_OK;

    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, marks, "the turned pieces", &turn));
    for (uint64_t n = 0; n < count; n++) turn[pieces[n].mark] = (uint8_t)pieces[n].turned;
    /* Triangles may be listed there already: each is read before it is written. */
    if (job->corner == NULL)
        BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->given->triangle_count * 12, "the turned triangles",
                            &job->corner));

    for (uint64_t t = 0; t < triangles; t++) {
        uint32_t v[3];

        bvxi_view_triangle(&mesh, t, v);
        int turned = turn[bvxi_piece_mark(&mesh, by, t)];
        job->corner[3 * t] = v[0];
        job->corner[3 * t + 1] = v[turned ? 2 : 1];
        job->corner[3 * t + 2] = v[turned ? 1 : 2];
        job->report.turned += (uint64_t)turned;
    }
    bvxi_repair_view(job, job->corner, triangles, &job->mesh);
    bvxi_drop(job->ctx, turn);
    return BVX_OK;
}

/* The pieces of the mesh; closed ones that are inside out are turned, and where all are closed, what they
 * would have together if none overlapped is known. */
static bvx_status take_pieces(bvxi_repair_job *job, const uint32_t *representative)
{
    const bvx_certificate *const c = &job->report.before;
    double centre[3];

    BVXI_TRY(BVXI_ARRAY(job->ctx, job->given->vertex_count, "the vertices' pieces", job->piece));
    bvxi_pieces(&job->mesh, representative, job->piece);
    if (job->patches.part == NULL && (!c->closed || c->duplicates != 0)) return BVX_OK;

    /* Bodies that touch at vertices are one piece by them, whose volume says nothing of either. */
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * c->box.low[a] + 0.5 * c->box.high[a];
    if (job->patches.part == NULL && c->nonmanifold_vertices != 0 && c->components > 1)
        BVXI_TRY(bvxi_patches_open(job->ctx, &job->mesh, representative, centre, 0, &job->patches));
    bvxi_piece_marks by = {.piece = job->piece, .part = job->patches.part};

    if (job->report.sign != BVX_FILL_VOTE) {
        /* Volumes of pieces by the marks given; closed ones that are inside out are turned. */
        const bvxi_patches *const known = &job->patches;
        bvxi_mesh_piece *pieces = NULL;
        uint64_t count;

        BVXI_TRY(bvxi_mesh_pieces_open(job->ctx, &job->mesh, &by, &job->report.before, &pieces, &count));
        /* What an open piece encloses is not known. */
        for (uint64_t n = 0; n < count && by.part != NULL; n++)
            if (known->open[pieces[n].mark]) pieces[n].volume6 = 0;
        if (known->open_edges == 0) job->facts.parts_volume = bvxi_mesh_pieces_volume(pieces, count);
        if (job->options->sign == BVX_FILL_AUTO && count > 1)
            BVXI_TRY(turn_inside_out(job, representative, &by, pieces, count));
        bvxi_drop(job->ctx, pieces);
    }

    bvxi_patches_close(job->ctx, &job->patches);
    return BVX_OK;
}

bvx_status bvxi_repair_take(bvxi_repair_job *job)
{
    bvx_context *const ctx = job->ctx;
    uint64_t const bytes = job->given->vertex_count * 4;
    double low[3], high[3];
    uint32_t *representative;

    if (job->given->triangle_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", bvxi_repair_name);
    BVXI_TRY(bvxi_view_bounds(ctx, bvxi_repair_name, job->given, low, high));
    job->mesh = *job->given;
    /* First of all, as what follows goes by welded vertices. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' places", &representative));
    BVXI_TRY(check_given(job, low, high, representative));
    BVXI_TRY(drop_duplicates(job, representative));

    /* Which of two opposite triangles is first is chance, so patches of an open mesh are turned to face
     * outward; one that has one side only does not count then. */
    int32_t sign = job->options->sign;

    /* Winding numbers need triangles of one mind; where none were flipped only whole patches are turned. */
    if (sign == BVX_FILL_AUTO) {
        const bvx_certificate *const c = &job->report.before;

        sign = BVX_FILL_WINDING;
        if (c->flipped_edges != 0 || c->duplicates != 0 || (c->boundary_edges != 0 && c->components > 1))
            BVXI_TRY(turn_flipped(job, low, high, representative, &sign));
    }
    job->report.sign = job->fill = sign;

    /* Sharp edges: as requested, or as the mesh has them. */
    int32_t const asked = job->options->placing.sharp;

    job->report.sharp = asked == BVX_SHARP_ALWAYS;
    BVXI_TRY(
        asked == BVX_SHARP_AUTO
            ? BVXI_SCOPE(job->ctx, bvxi_sharp_edges(job->ctx, &job->mesh, representative, &job->report.sharp))
            : BVX_OK);
    BVXI_TRY(take_pieces(job, representative));
    bvxi_drop(ctx, representative);
    return BVX_OK;
}
