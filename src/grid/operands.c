/* operands.c - what operations on grids ask before and after: of one lattice
 * and window? another grid? filled to the end? */
#include "grid/grid.h"

static bvx_status fail_same(bvx_context *ctx, const char *function, const char *field, double a, double b)
{
    return bvxi_fail(ctx, BVX_ERR_LATTICE, "%s: the grids differ in %s, %g in a and %g in b", function, field,
                     a, b);
}

bvx_status bvxi_grid_same(bvx_context *ctx, const char *function, const bvx_grid *a, const bvx_grid *b)
{
    static const char *const names[5][3] = {
        {"the lattice's origin along x", "the lattice's origin along y", "the lattice's origin along z"},
        {"the lattice's spacing along x", "the lattice's spacing along y", "the lattice's spacing along z"},
        {"the lattice's dims along x", "the lattice's dims along y", "the lattice's dims along z"},
        {"the window's low along x", "the window's low along y", "the window's low along z"},
        {"the window's size along x", "the window's size along y", "the window's size along z"}};

    /* The first field that differs is named; doubles hold each of them exactly. */
    for (int32_t f = 0; f < 5; f++)
        for (int32_t i = 0; i < 3; i++) {
            double const of_a[5] = {a->lattice.origin[i], a->lattice.spacing[i], (double)a->lattice.dims[i],
                                    (double)a->low[i], (double)a->size[i]};
            double const of_b[5] = {b->lattice.origin[i], b->lattice.spacing[i], (double)b->lattice.dims[i],
                                    (double)b->low[i], (double)b->size[i]};
            if (of_a[f] != of_b[f]) return fail_same(ctx, function, names[f][i], of_a[f], of_b[f]);
        }
    if (a->lattice.fraction_bits != b->lattice.fraction_bits)
        return fail_same(ctx, function, "the lattice's fraction_bits", (double)a->lattice.fraction_bits,
                         (double)b->lattice.fraction_bits);
    return BVX_OK;
}

static uint64_t bytes_held(const bvx_grid *grid)
{
    return grid->word_capacity < UINT64_MAX / 8 ? grid->word_capacity * 8 : UINT64_MAX;
}

bvx_status bvxi_grid_apart(bvx_context *ctx, const char *function, const bvx_grid *grid,
                           const bvx_grid *result)
{
    /* Compared by memory, as two grids may share their words. */
    if (result == NULL) return bvxi_fail_null(ctx, function, "result");
    BVXI_TRY(bvxi_grid_check(ctx, function, grid));
    if (grid == result ||
        bvxi_overlap(grid->words, bvxi_grid_words(grid) * 8, result->words, bytes_held(result)))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                             "%s: the result's array holds words of the grid; it needs words of its own",
                             function);
    return BVX_OK;
}

bvx_status bvxi_grid_check_shift(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                 const bvx_grid *result)
{
    uint64_t const bytes = bvxi_grid_words(grid) * 8;
    uint64_t const held = bytes_held(result);

    /* A result too small for the grid is made anew, or refused: what lies after its words is not its own. */
    if (grid->words == result->words ||
        !bvxi_overlap(grid->words, bytes, result->words, held < bytes ? held : bytes))
        return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                         "%s: the result's words overlap the grid's without being the same", function);
}

bvx_status bvxi_grid_fill_by(bvx_context *ctx, const char *stage, int32_t pieces, bvx_task_fn *task,
                             void *user, int mine, bvx_grid *result)
{
    bvx_status const status = bvxi_parallel(ctx, stage, 0.0, 1.0, pieces, task, user);
    if (status != BVX_OK && mine) bvx_grid_free(ctx, result);
    return status;
}
