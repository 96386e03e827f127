/* arena.c - memory from one block that the caller gives.
 *
 * The arena takes results from its low end and scratch from its high end. Each block has a header with its
 * size and whether it is free; a free block at an end is popped, with all free blocks behind it, so any order
 * of freeing comes back to an empty arena. */
#include "context.h"

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
