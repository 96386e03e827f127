/* extract_faces.c - the faces between set and empty voxels as a mesh: bvx_extract_faces.
 * Single faces and merged ones have files of their own (faces.h); here options are checked, and the mesh is
 * counted and made. */
#include "surface/faces.h"
#include "surface/march.h"

enum { FACE_GRAIN = 64 };

static const bvxi_option faces_rows[] = {
    BVXI_CHOICE(bvx_faces_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_SWITCH(bvx_faces_options, local_frame),
    BVXI_SWITCH(bvx_faces_options, merged),
    BVXI_RESERVED(bvx_faces_options, reserved),
};

static bvx_status run_faces(bvx_context *ctx, bvxi_faces *f, const bvx_grid *grid,
                            const bvx_faces_options *options, bvx_mesh *mesh)
{
    uint64_t *empty;

    bvx_faces_options *const o = &f->options;
    BVXI_TRY(bvxi_take_options(ctx, f->function, options, o, sizeof *o));
    BVXI_TRY(bvxi_grid_check(ctx, f->function, grid));
    BVXI_TRY(bvxi_grid_check_past(ctx, f->function, grid));
    BVXI_TRY(bvxi_check_options(ctx, f->function, o, BVXI_OPTIONS(faces_rows)));
    f->grid = grid;
    for (int32_t a = 0; a < 3; a++) {
        f->spacing[a] = grid->lattice.spacing[a];
        f->origin[a] = o->local_frame ? 0.0 : grid->lattice.origin[a];
    }
    BVXI_TRY(bvxi_choose_position_type(ctx, f->function, grid, f->origin, &f->options.position_type));

    /* A row of corners more than of voxels: the last voxels' high sides. */
    f->words = grid->size[0] / BVXI_WORD_BITS + 1;
    f->row_count = ((uint64_t)grid->size[1] + 1) * ((uint64_t)grid->size[2] + 1);
    f->pieces = bvxi_piece_count(f->row_count, FACE_GRAIN);
    uint64_t const empty_bytes = (uint64_t)grid->words_per_row * 8;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, empty_bytes, "an empty row", &empty));
    f->empty_row = empty;
    bvx_status status = f->options.merged ? bvxi_faces_merge(ctx, f, mesh) : bvxi_faces_single(ctx, f, mesh);
    bvxi_drop(ctx, empty);
    return status;
}

static bvx_status run_extract_faces(bvx_context *context, const bvx_grid *grid,
                                    const bvx_faces_options *options, bvx_mesh *mesh)
{
    bvxi_faces f;
    memset(&f, 0, sizeof f);
    f.function = "bvx_extract_faces";
    if (mesh == NULL) return bvxi_fail_null(context, f.function, "mesh");
    return run_faces(context, &f, grid, options, mesh);
}

bvx_status bvx_extract_faces(bvx_context *context, const bvx_grid *grid, const bvx_faces_options *options,
                             bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_extract_faces(context, grid, options, mesh));
}
