/* shell.c - the conservative surface as a helper of the fills. */
#include "voxelize/fills.h"

void bvxi_shell_close(bvx_context *ctx, bvx_grid *shell)
{
    bvxi_free(ctx, shell->words, shell->word_capacity * 8);
    memset(shell, 0, sizeof *shell);
}

bvx_status bvxi_shell_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *solid,
                           bvx_grid *shell, uint64_t *voxels)
{
    uint64_t const words = bvxi_grid_words(solid);
    bvx_surface_options o;
    bvx_status status;

    bvx_surface_options_init(&o, sizeof o);
    memcpy(o.window.low, solid->low, sizeof o.window.low);
    memcpy(o.window.size, solid->size, sizeof o.window.size);
    memset(shell, 0, sizeof *shell);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, words * 8, "the conservative surface", &shell->words));
    shell->word_capacity = words;
    status = bvx_voxelize_surface(ctx, mesh, &solid->lattice, &o, shell);
    if (status == BVX_OK) status = bvx_grid_count(ctx, shell, voxels);
    if (status != BVX_OK) bvxi_shell_close(ctx, shell);
    return status;
}
