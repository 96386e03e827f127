/* memory.c - every byte of the library: allocator, limit and peak, and scratch that is freed by what was
 * taken since.
 *
 * Source: mark and release as Pascal's runtimes had it (Jensen, Wirth. Pascal User Manual and Report. 1974),
 * here for blocks that may also go one by one, in any order.
 *
 * Each block of scratch has a serial number and remembers its size: in an arena in its header (arena.c), else
 * in a table of the context (scratch.c). A mark is the serial number taken last, so what came after it can be
 * freed whatever has gone since. */
#include "context.h"

bvx_status bvxi_alloc(bvx_context *ctx, int kind, uint64_t size, const char *what, void *block)
{
    uint64_t const want = size == 0 ? 1 : size;
    void *p;

    /* The limit first: a refusal by it is another one than by the system. */
    if (want > SIZE_MAX - BVXI_ALIGN ||
        (ctx->memory_limit != 0 && (want > ctx->memory_limit || ctx->memory_used > ctx->memory_limit - want)))
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s would take %u bytes; %u are in use and the limit is %u",
                         what, want, ctx->memory_used,
                         ctx->memory_limit != 0 ? ctx->memory_limit : (uint64_t)SIZE_MAX);
    p = ctx->arena.memory != NULL ? bvxi_arena_alloc(&ctx->arena, kind, (size_t)want, ++ctx->serial)
                                  : ctx->alloc(ctx->alloc_user, (size_t)want, BVXI_ALIGN);
    /* Scratch that could not be remembered could not be taken back, so it is not taken at all. */
    if (p != NULL && ctx->arena.memory == NULL && kind == BVXI_SCRATCH &&
        bvxi_scratch_remember(ctx, p, want) != BVX_OK) {
        ctx->free(ctx->alloc_user, p, (size_t)want, BVXI_ALIGN);
        p = NULL;
    }
    if (p == NULL)
        return bvxi_fail(ctx, BVX_ERR_MEMORY, "%s: no memory for %u bytes, %u are in use", what, want,
                         ctx->memory_used);
    ctx->memory_used += want;
    if (ctx->memory_used > ctx->memory_peak) ctx->memory_peak = ctx->memory_used;
    memcpy(block, &p, sizeof p);
    return BVX_OK;
}

bvx_status bvxi_alloc_zero(bvx_context *ctx, int kind, uint64_t size, const char *what, void *block)
{
    void *p = NULL;
    BVXI_TRY(bvxi_alloc(ctx, kind, size, what, &p));
    memset(p, 0, (size_t)size);
    memcpy(block, &p, sizeof p);
    return BVX_OK;
}

void bvxi_free(bvx_context *ctx, void *block, uint64_t size)
{
    uint64_t const had = size == 0 ? 1 : size;
    if (block == NULL) return;
    /* another context's block may come back here */
    ctx->memory_used -= had < ctx->memory_used ? had : ctx->memory_used;
    if (ctx->arena.memory != NULL) {
        bvxi_arena_free(&ctx->arena, block);
        return;
    }
    bvxi_scratch_forget(ctx, block);
    ctx->free(ctx->alloc_user, block, (size_t)had, BVXI_ALIGN);
}

/* ---- marks ---- */

void bvxi_drop(bvx_context *ctx, void *block)
{
    if (block == NULL) return;
    bvxi_free(ctx, block,
              ctx->arena.memory != NULL ? bvxi_arena_size(&ctx->arena, block)
                                        : bvxi_scratch_size(ctx, block));
}

uint64_t bvxi_scratch_begin(const bvx_context *ctx)
{
    return ctx->serial;
}

/* The block of scratch that was taken last since a mark; NULL: there is none. */
static void *youngest(const bvx_context *ctx, uint64_t mark, uint64_t *size)
{
    return ctx->arena.memory != NULL ? bvxi_arena_since(&ctx->arena, mark, size)
                                     : bvxi_scratch_since(ctx, mark, size);
}

bvx_status bvxi_scratch_end(bvx_context *ctx, uint64_t mark, bvx_status status)
{
    uint64_t size;
    void *block;

    while ((block = youngest(ctx, mark, &size)) != NULL) bvxi_free(ctx, block, size);
    return status;
}

bvx_status bvxi_scratch_keep(bvx_context *ctx, uint64_t mark, bvx_status status)
{
    return status == BVX_OK ? status : bvxi_scratch_end(ctx, mark, status);
}

/* Whoever frees these blocks may do so by another context, which has its own table. */
void bvxi_scratch_adopt(bvx_context *ctx, uint64_t mark)
{
    uint64_t size;
    void *block;

    if (ctx->arena.memory != NULL) bvxi_arena_adopt(&ctx->arena, mark);
    else
        while ((block = bvxi_scratch_since(ctx, mark, &size)) != NULL) bvxi_scratch_forget(ctx, block);
}

/* ---- sizes ---- */

bvx_status bvxi_resize(bvx_context *ctx, int kind, void *block, uint64_t size, uint64_t new_size,
                       const char *what)
{
    void *old, *moved = NULL;

    if (size == new_size) return BVX_OK;
    memcpy(&old, block, sizeof old);
    /* Both at once for a moment, as allocators have no way to grow a block. */
    BVXI_TRY(bvxi_alloc(ctx, kind, new_size, what, &moved));
    if (old != NULL) memcpy(moved, old, (size_t)(size < new_size ? size : new_size));
    bvxi_free(ctx, old, size);
    memcpy(block, &moved, sizeof moved);
    return BVX_OK;
}

void bvx_buffer_free(bvx_context *context, bvx_buffer *buffer)
{
    if (context == NULL || buffer == NULL) return;
    bvxi_free(context, buffer->bytes, buffer->capacity);
    memset(buffer, 0, sizeof *buffer);
}

uint64_t bvxi_memory_limit(const bvx_context *ctx)
{
    return ctx->memory_limit;
}

uint64_t bvx_memory_used(const bvx_context *context)
{
    return context == NULL ? 0 : context->memory_used;
}

uint64_t bvx_memory_peak(const bvx_context *context)
{
    return context == NULL ? 0 : context->memory_peak;
}

void bvx_memory_reset_peak(bvx_context *context)
{
    if (context != NULL) context->memory_peak = context->memory_used;
}
