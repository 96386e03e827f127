/* memory.c - every byte of the library: what is allocated counts against the context's limit and peak, and
 * scratch that a failure leaves behind is freed by a mark.
 *
 * Source: mark and release as Pascal's runtimes had it (Jensen, Wirth. Pascal User Manual and Report. 1974),
 * here for blocks that may also go one by one, in any order.
 *
 * Blocks come from the context's allocator, or from an arena that the caller gave, whose two ends serve
 * results and scratch. Each block of scratch has a serial number and remembers its size: in an arena in
 * its header, else in a table of the context. A mark is the serial number taken last, so what came after
 * it can be freed whatever has gone since. Guarantee: after a call that failed none of its scratch is
 * held. */
#include "context.h"

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

static void *arena_alloc(bvxi_arena *a, int kind, size_t size, uint64_t serial)
{
    size_t const gap = a->high - a->low;

    if (size > gap) return NULL;
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
    if (a->high - a->low < a->least) a->least = a->high - a->low;
    return a->memory + offset + BVXI_ALIGN;
}

static size_t offset_of(const bvxi_arena *a, const void *block)
{
    return (size_t)((const unsigned char *)block - a->memory) - BVXI_ALIGN;
}

/* The scratch taken last since a mark; NULL: none. */
static void *arena_since(const bvxi_arena *a, uint64_t mark)
{
    /* What lives on has the number 0 and is stepped over. */
    for (size_t at = a->high; at < a->size; at += header_at(a, at)->payload + BVXI_ALIGN) {
        const block_header *const h = header_at(a, at);
        if (h->serial != 0 && h->serial <= mark) break;
        if (h->serial != 0 && !h->is_free) return a->memory + at + BVXI_ALIGN;
    }
    return NULL;
}

/* ---- The scratch of a context that has no arena, in the order in which it was taken ---- */

/* Each block has a serial number and its size in a table, which begins behind the context and moves where it
 * grows. Small calls spend a good part of their time here, so what nearly always happens - there is room, and
 * the youngest block goes first - takes a few instructions. */

/* The entry of a block; scratch_count where there is none. */
static inline uint32_t entry_of(const bvx_context *ctx, const void *block)
{
    for (uint32_t i = ctx->scratch_count; i-- > 0;)
        if (ctx->scratch[i].block == block) return i;
    return ctx->scratch_count;
}

static void close_table(bvx_context *ctx)
{
    ctx->free(ctx->alloc_user, ctx->scratch, ctx->scratch_room * sizeof *ctx->scratch, BVXI_ALIGN);
    ctx->scratch = ctx->scratch_first;
    ctx->scratch_room = BVXI_SCRATCH_ROOM;
}

/* Doubled, so that growing stays cheap; 0 without memory. */
BVXI_COLD static int grow_table(bvx_context *ctx)
{
    uint32_t const room = 2 * ctx->scratch_room;
    bvxi_scratch *const larger = ctx->alloc(ctx->alloc_user, room * sizeof *larger, BVXI_ALIGN);
    if (larger == NULL) return 0;
    memcpy(larger, ctx->scratch, ctx->scratch_count * sizeof *larger);
    /* The first table is part of the context and is never freed. */
    if (ctx->scratch != ctx->scratch_first) close_table(ctx);
    ctx->scratch = larger;
    ctx->scratch_room = room;
    return 1;
}

static inline void forget_scratch(bvx_context *ctx, uint32_t at)
{
    uint32_t const after = --ctx->scratch_count - at;
    /* Serial numbers rise along the table, so what stands behind a gap moves up. */
    if (after != 0) memmove(ctx->scratch + at, ctx->scratch + at + 1, (size_t)after * sizeof *ctx->scratch);
    if (ctx->scratch != ctx->scratch_first && ctx->scratch_count == 0) close_table(ctx);
}

/* The block taken last since a mark; NULL: none. */
static inline void *block_since(const bvx_context *ctx, uint64_t mark)
{
    uint32_t const count = ctx->scratch_count;
    /* Where the last is not younger than the mark, none is. */
    return count != 0 && ctx->scratch[count - 1].serial > mark ? ctx->scratch[count - 1].block : NULL;
}

/* ---- Blocks of either ---- */

static bvx_status fail_memory(bvx_context *ctx, uint64_t want, const char *what)
{
    if (ctx->arena.memory != NULL)
        return bvxi_fail(ctx, BVX_ERR_MEMORY,
                         "%s: no memory for %u bytes in the arena of %u bytes, %u are in use", what, want,
                         (uint64_t)ctx->arena.size, ctx->memory_used);
    return bvxi_fail(ctx, BVX_ERR_MEMORY, "%s: no memory for %u bytes, %u are in use", what, want,
                     ctx->memory_used);
}

static inline void count_block(bvx_context *ctx, uint64_t size, void *p, void *block)
{
    ctx->memory_used += size;
    if (ctx->memory_used > ctx->memory_peak) ctx->memory_peak = ctx->memory_used;
    memcpy(block, &p, sizeof p);
}

/* Another context's block may come back here, so no more goes than is in use. */
static inline void lower_used(bvx_context *ctx, uint64_t size)
{
    ctx->memory_used -= size < ctx->memory_used ? size : ctx->memory_used;
}

BVXI_COLD static bvx_status alloc_in_arena(bvx_context *ctx, int kind, uint64_t want, const char *what,
                                           void *block)
{
    void *const p = arena_alloc(&ctx->arena, kind, (size_t)want, ++ctx->serial);
    if (p == NULL) return fail_memory(ctx, want, what);
    count_block(ctx, want, p, block);
    return BVX_OK;
}

bvx_status bvxi_alloc(bvx_context *ctx, int kind, uint64_t size, const char *what, void *block)
{
    uint64_t const want = size == 0 ? 1 : size;

    /* The limit first: a refusal by it is another one than by the system. */
    if (want > SIZE_MAX - BVXI_ALIGN ||
        (ctx->memory_limit != 0 && (want > ctx->memory_limit || ctx->memory_used > ctx->memory_limit - want)))
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s would take %u bytes; %u are in use and the limit is %u",
                         what, want, ctx->memory_used,
                         ctx->memory_limit != 0 ? ctx->memory_limit : (uint64_t)SIZE_MAX);
    if (ctx->arena.memory != NULL) return alloc_in_arena(ctx, kind, want, what, block);

    /* Scratch that could not be remembered could not be taken back, so there is room for it before. */
    if (kind == BVXI_SCRATCH && ctx->scratch_count == ctx->scratch_room && !grow_table(ctx))
        return fail_memory(ctx, want, what);
    void *const p = ctx->alloc(ctx->alloc_user, (size_t)want, BVXI_ALIGN);
    if (p == NULL) return fail_memory(ctx, want, what);
    if (kind == BVXI_SCRATCH) ctx->scratch[ctx->scratch_count++] = (bvxi_scratch){p, want, ++ctx->serial};
    count_block(ctx, want, p, block);
    return BVX_OK;
}

bvx_status bvxi_alloc_zero(bvx_context *ctx, int kind, uint64_t size, const char *what, void *block)
{
    void *p;
    BVXI_TRY(bvxi_alloc(ctx, kind, size, what, block));
    memcpy(&p, block, sizeof p);
    memset(p, 0, (size_t)size);
    return BVX_OK;
}

void bvxi_free(bvx_context *ctx, void *block, uint64_t size)
{
    uint64_t const had = size == 0 ? 1 : size;

    if (block == NULL) return;
    lower_used(ctx, had);
    if (ctx->arena.memory != NULL) {
        bvxi_arena *const a = &ctx->arena;
        header_at(a, offset_of(a, block))->is_free = 1;

        size_t *const last = (size_t *)(void *)(a->memory + a->size); /* total size of the uppermost result */
        while (a->low > 0 && header_at(a, a->low - *last)->is_free) {
            a->low -= *last;
            *last = header_at(a, a->low)->previous;
        }

        while (a->high < a->size && header_at(a, a->high)->is_free)
            a->high += header_at(a, a->high)->payload + BVXI_ALIGN;
        return;
    }
    /* A result is in no table; scratch that went by its size must not go twice. */
    uint32_t const at = entry_of(ctx, block);
    if (at < ctx->scratch_count) forget_scratch(ctx, at);
    ctx->free(ctx->alloc_user, block, (size_t)had, BVXI_ALIGN);
}

/* A block in an arena, or one that is not the youngest. */
BVXI_COLD static void drop_any(bvx_context *ctx, void *block)
{
    uint64_t size = 1;
    if (ctx->arena.memory != NULL) {
        size = header_at(&ctx->arena, offset_of(&ctx->arena, block))->used;
    } else {
        uint32_t const at = entry_of(ctx, block);
        if (at < ctx->scratch_count) size = ctx->scratch[at].size;
    }
    bvxi_free(ctx, block, size);
}

void bvxi_drop(bvx_context *ctx, void *block)
{
    uint32_t const count = ctx->scratch_count;

    if (block == NULL) return;
    if (count == 0 || ctx->scratch[count - 1].block != block || ctx->scratch != ctx->scratch_first) {
        drop_any(ctx, block);
        return;
    }
    uint64_t const size = ctx->scratch[count - 1].size;
    ctx->scratch_count = count - 1;
    lower_used(ctx, size);
    ctx->free(ctx->alloc_user, block, (size_t)size, BVXI_ALIGN);
}

/* ---- marks ---- */

uint64_t bvxi_scratch_begin(const bvx_context *ctx)
{
    return ctx->serial;
}

bvx_status bvxi_scratch_end(bvx_context *ctx, uint64_t mark, bvx_status status)
{
    /* The youngest first. */
    for (void *block; (block = ctx->arena.memory != NULL ? arena_since(&ctx->arena, mark)
                                                         : block_since(ctx, mark)) != NULL;)
        bvxi_drop(ctx, block);
    return status;
}

/* Scopes deeper than the stack end with the last one that it holds. */
void bvxi_scope_begin(bvx_context *ctx)
{
    if (ctx->scopes < BVXI_SCOPES) ctx->scope[ctx->scopes] = ctx->serial;
    ctx->scopes++;
}

bvx_status bvxi_scope_end(bvx_context *ctx, bvx_status status)
{
    if (--ctx->scopes >= BVXI_SCOPES) return status;
    return bvxi_scratch_end(ctx, ctx->scope[ctx->scopes], status);
}

bvx_status bvxi_scratch_keep(bvx_context *ctx, uint64_t mark, bvx_status status)
{
    return status == BVX_OK ? status : bvxi_scratch_end(ctx, mark, status);
}

/* Whoever frees these blocks may do so by another context, which has its own table. */
void bvxi_scratch_adopt(bvx_context *ctx, uint64_t mark)
{
    const bvxi_arena *const a = &ctx->arena;
    for (size_t at = a->high; at < a->size; at += header_at(a, at)->payload + BVXI_ALIGN)
        if (header_at(a, at)->serial > mark) header_at(a, at)->serial = 0;
    while (a->memory == NULL && block_since(ctx, mark) != NULL) forget_scratch(ctx, ctx->scratch_count - 1);
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

bvx_status bvxi_grow(bvx_context *ctx, const char *function, void *block, uint64_t *room, uint64_t item,
                     const char *what)
{
    uint64_t const larger = *room < 64 ? 64 : *room + *room / 2;
    if (larger >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%s: more than 2^32 of %s", function,
                             what);
    return bvxi_reserve(ctx, block, larger, room, item, what);
}

bvx_status bvxi_reserve(bvx_context *ctx, void *block, uint64_t count, uint64_t *room, uint64_t item,
                        const char *what)
{
    if (count <= *room) return BVX_OK;
    BVXI_TRY(bvxi_resize(ctx, BVXI_SCRATCH, block, *room * item, count * item, what));
    *room = count;
    return BVX_OK;
}

uint64_t bvxi_memory_limit(const bvx_context *ctx)
{
    return ctx->memory_limit;
}

uint64_t bvx_memory_used(const bvx_context *context)
{
    return context == NULL ? 0 : context->memory_used;
}

/* In an arena also the context, the chain's last word and what aligning takes at most: so much is enough. */
uint64_t bvx_memory_peak(const bvx_context *context)
{
    if (context == NULL) return 0;
    if (context->arena.memory == NULL) return context->memory_peak;
    return (uint64_t)context->size + context->arena.size - context->arena.least + 2 * BVXI_ALIGN - 1;
}

void bvx_memory_reset_peak(bvx_context *context)
{
    if (context == NULL) return;
    context->memory_peak = context->memory_used;
    context->arena.least = context->arena.high - context->arena.low;
}
