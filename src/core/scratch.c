/* scratch.c - scratch that is freed by what was taken since, not block by block with its size.
 *
 * Source: mark and release as Wirth's Pascal runtimes had it (Jensen, Wirth. Pascal User Manual and Report. 1974),
 * here for blocks that may also go one by one, in any order.
 *
 * Each scratch block has a serial number and remembers its size: in an arena in its header, else in a table of the
 * context. A mark is the serial number taken last, so what came after it can be freed whatever has gone since.
 * Cost: a block that goes is looked for from the table's end, where it nearly always is. */
#include "context.h"

uint64_t bvxi_scratch_begin(const bvx_context *ctx)
{
    return ctx->serial;
}

bvx_status bvxi_scratch_end(bvx_context *ctx, uint64_t mark, bvx_status status)
{
    if (ctx->arena.memory != NULL) {
        bvxi_arena_release(ctx, mark);
        return status;
    }
    while (ctx->scratch_count > 0 && ctx->scratch[ctx->scratch_count - 1].serial > mark)
        bvxi_free(ctx, ctx->scratch[ctx->scratch_count - 1].block, ctx->scratch[ctx->scratch_count - 1].size);
    return status;
}

bvx_status bvxi_scratch_keep(bvx_context *ctx, uint64_t mark, bvx_status status)
{
    return status == BVX_OK ? status : bvxi_scratch_end(ctx, mark, status);
}

/* The entry of a block; scratch_count where there is none. */
static uint32_t entry_of(const bvx_context *ctx, const void *block)
{
    for (uint32_t i = ctx->scratch_count; i-- > 0;)
        if (ctx->scratch[i].block == block) return i;
    return ctx->scratch_count;
}

void bvxi_drop(bvx_context *ctx, void *block)
{
    uint32_t at;

    if (block == NULL) return;
    if (ctx->arena.memory != NULL) {
        bvxi_free(ctx, block, bvxi_arena_size(&ctx->arena, block));
        return;
    }
    at = entry_of(ctx, block);
    if (at < ctx->scratch_count) bvxi_free(ctx, block, ctx->scratch[at].size);
}

static void close_table(bvx_context *ctx)
{
    if (ctx->scratch != ctx->scratch_first)
        ctx->free(ctx->alloc_user, ctx->scratch, ctx->scratch_room * sizeof *ctx->scratch, BVXI_ALIGN);
    ctx->scratch = ctx->scratch_first;
    ctx->scratch_room = BVXI_SCRATCH_ROOM;
}

/* Whatever was taken by the caller's count is in order, so what stands behind a gap moves up. */
void bvxi_scratch_forget(bvx_context *ctx, const void *block)
{
    uint32_t const at = entry_of(ctx, block);

    if (at == ctx->scratch_count) return;
    memmove(ctx->scratch + at, ctx->scratch + at + 1,
            (size_t)(ctx->scratch_count - at - 1) * sizeof *ctx->scratch);
    if (--ctx->scratch_count == 0) close_table(ctx);
}

bvx_status bvxi_scratch_remember(bvx_context *ctx, void *block, uint64_t size)
{
    bvxi_scratch *const last = ctx->scratch + ctx->scratch_count;

    if (ctx->scratch_count == ctx->scratch_room) {
        uint32_t const room = 2 * ctx->scratch_room;
        bvxi_scratch *const larger = ctx->alloc(ctx->alloc_user, room * sizeof *larger, BVXI_ALIGN);
        uint32_t const count = ctx->scratch_count;

        if (larger == NULL) return BVX_ERR_MEMORY;
        memcpy(larger, ctx->scratch, count * sizeof *larger);
        close_table(ctx);
        ctx->scratch = larger;
        ctx->scratch_room = room;
        return bvxi_scratch_remember(ctx, block, size);
    }
    last->block = block;
    last->size = size;
    last->serial = ++ctx->serial;
    ctx->scratch_count++;
    return BVX_OK;
}

/* Whoever frees these blocks may do so by another context, which has its own table. */
void bvxi_scratch_adopt(bvx_context *ctx, uint64_t mark)
{
    if (ctx->arena.memory != NULL) {
        bvxi_arena_adopt(&ctx->arena, mark);
        return;
    }
    while (ctx->scratch_count > 0 && ctx->scratch[ctx->scratch_count - 1].serial > mark)
        bvxi_scratch_forget(ctx, ctx->scratch[ctx->scratch_count - 1].block);
}
