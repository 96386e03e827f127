/* memory.c - every byte of the library: what is allocated counts against the context's limit and peak, and
 * scratch that a failure leaves behind is freed by a mark.
 *
 * Blocks come from the context's allocator, or from an arena that the caller gave, whose two ends serve
 * results and scratch. Guarantee: after a call that failed none of its scratch is held. */
#include "context.h"

/* ---- Every byte of the library: allocator, limit and peak, and scratch that is freed by what was taken
 * since ---- */

/* Source: mark and release as Pascal's runtimes had it (Jensen, Wirth. Pascal User Manual and Report. 1974),
 * here for blocks that may also go one by one, in any order.
 *
 * Each block of scratch has a serial number and remembers its size: in an arena in its header (memory.c),
 * else in a table of the context (memory.c). A mark is the serial number taken last, so what came after it
 * can be freed whatever has gone since. */

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
    if (p == NULL && ctx->arena.memory != NULL)
        return bvxi_fail(ctx, BVX_ERR_MEMORY,
                         "%s: no memory for %u bytes in the arena of %u bytes, %u are in use", what, want,
                         (uint64_t)ctx->arena.size, ctx->memory_used);
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

/* ---- Memory from one block that the caller gives ---- */

/* The arena takes results from its low end and scratch from its high end. Each block has a header with its
 * size and whether it is free; a free block at an end is popped, with all free blocks behind it, so any order
 * of freeing comes back to an empty arena. */

typedef struct block_header {
    uint64_t used, serial; /* of scratch: bytes that were requested, its number */
    size_t payload;        /* bytes of the block, rounded up to the alignment */
    size_t previous;       /* payload of the neighbour towards the arena's end that this block grew from */
    size_t is_free;
    unsigned char fill[BVXI_ALIGN - 2 * sizeof(uint64_t) - 3 * sizeof(size_t)];
} block_header;

static block_header *header_at(const bvxi_arena *a, size_t offset)
{
    return (block_header *)(void *)(a->memory + offset);
}

void *bvxi_arena_alloc(bvxi_arena *a, int kind, size_t size, uint64_t serial)
{
    size_t const gap = a->high - a->low;

    if (size > gap || gap - size < 2 * BVXI_ALIGN) return NULL;
    size_t const payload = (size + BVXI_ALIGN - 1) / BVXI_ALIGN * BVXI_ALIGN;
    size_t const total = payload + BVXI_ALIGN;
    size_t offset;
    if (total > gap) return NULL;
    if (kind == BVXI_RESULT) {
        offset = a->low; /* results: header below the payload, linked by the previous payload's size */
        header_at(a, offset)->payload = payload;
        header_at(a, offset)->is_free = 0;
        header_at(a, offset)->previous = a->low == 0 ? 0 : *(size_t *)(void *)(a->memory + a->size);
        *(size_t *)(void *)(a->memory + a->size) = total;
        a->low += total;
    } else {
        a->high -= total;
        offset = a->high;
        header_at(a, offset)->payload = payload;
        header_at(a, offset)->is_free = 0;
        header_at(a, offset)->previous = 0;
        header_at(a, offset)->used = size;
        header_at(a, offset)->serial = serial;
    }
    return a->memory + offset + BVXI_ALIGN;
}

static void pop_results(bvxi_arena *a)
{
    size_t *const last = (size_t *)(void *)(a->memory + a->size); /* total size of the uppermost result */
    while (a->low > 0 && header_at(a, a->low - *last)->is_free) {
        a->low -= *last;
        *last = header_at(a, a->low)->previous;
    }
}

static void pop_scratch(bvxi_arena *a)
{
    while (a->high < a->size && header_at(a, a->high)->is_free)
        a->high += header_at(a, a->high)->payload + BVXI_ALIGN;
}

static size_t offset_of(const bvxi_arena *a, const void *block)
{
    return (size_t)((const unsigned char *)block - a->memory) - BVXI_ALIGN;
}

void bvxi_arena_free(bvxi_arena *a, void *block)
{
    header_at(a, offset_of(a, block))->is_free = 1;
    pop_results(a);
    pop_scratch(a);
}

uint64_t bvxi_arena_size(const bvxi_arena *a, const void *block)
{
    return header_at(a, offset_of(a, block))->used;
}

void bvxi_arena_adopt(bvxi_arena *a, uint64_t mark)
{
    size_t at = a->high;

    for (; at < a->size; at += header_at(a, at)->payload + BVXI_ALIGN)
        if (header_at(a, at)->serial > mark) header_at(a, at)->serial = 0;
}

void *bvxi_arena_since(const bvxi_arena *a, uint64_t mark, uint64_t *size)
{
    /* What lives on has the number 0 and is stepped over. */
    for (size_t at = a->high; at < a->size; at += header_at(a, at)->payload + BVXI_ALIGN) {
        const block_header *const h = header_at(a, at);
        if (h->serial != 0 && h->serial <= mark) break;
        *size = h->used;
        if (h->serial != 0 && !h->is_free) return a->memory + at + BVXI_ALIGN;
    }
    return NULL;
}

/* ---- The scratch of a context that has no arena, in the order in which it was taken ---- */

/* Each block has a serial number and its size in a table, which begins behind the context and moves where it
 * grows. Cost: a block that goes is looked for from the table's end, where it nearly always is. */

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
