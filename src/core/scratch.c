/* scratch.c - the scratch of a context that has no arena, in the order in which it was taken.
 *
 * Each block has a serial number and its size in a table, which begins behind the context and moves where it
 * grows. Cost: a block that goes is looked for from the table's end, where it nearly always is. */
#include "context.h"

/* The entry of a block; scratch_count where there is none. */
static uint32_t entry_of(const bvx_context *ctx, const void *block)
{
    /* From the end: the youngest goes first nearly always. */
    for (uint32_t i = ctx->scratch_count; i-- > 0;)
        if (ctx->scratch[i].block == block) return i;
    return ctx->scratch_count;
}

uint64_t bvxi_scratch_size(const bvx_context *ctx, const void *block)
{
    uint32_t const at = entry_of(ctx, block);
    return at < ctx->scratch_count ? ctx->scratch[at].size : 0;
}

void *bvxi_scratch_since(const bvx_context *ctx, uint64_t mark, uint64_t *size)
{
    const bvxi_scratch *const last = ctx->scratch + ctx->scratch_count - 1;

    /* Serial numbers rise: where the last is not younger than the mark, none is. */
    if (ctx->scratch_count == 0 || last->serial <= mark) return NULL;
    *size = last->size;
    return last->block;
}

static void close_table(bvx_context *ctx)
{
    /* The first table is part of the context and is never freed. */
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
    /* Empty again: the larger table goes too. */
    if (--ctx->scratch_count == 0) close_table(ctx);
}

bvx_status bvxi_scratch_remember(bvx_context *ctx, void *block, uint64_t size)
{
    bvxi_scratch *const last = ctx->scratch + ctx->scratch_count;

    /* Doubled, so that growing stays cheap. */
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
