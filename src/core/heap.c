/* heap.c - the C library's heap as default allocator, the only malloc of the library.
 * Freestanding builds (BVX_FREESTANDING) leave it out and bring an allocator or an arena. */
#include "context.h"

#if defined(BVX_FREESTANDING)

void *bvxi_heap_alloc(void *user, size_t size, size_t align)
{
    (void)user, (void)size, (void)align;
    return NULL;
}

void bvxi_heap_free(void *user, void *block, size_t size, size_t align)
{
    (void)user, (void)block, (void)size, (void)align;
}

#else
#include <stdlib.h>

void *bvxi_heap_alloc(void *user, size_t size, size_t align)
{
    unsigned char *raw, *block;

    (void)user;

    /* The block that malloc gives is kept before the aligned one. */
    if (size > SIZE_MAX - align - sizeof raw) return NULL;
    raw = malloc(size + align + sizeof raw);
    if (raw == NULL) return NULL;
    block = raw + sizeof raw;
    block += (align - (uintptr_t)block % align) % align;
    memcpy(block - sizeof raw, &raw, sizeof raw); /* where malloc's own block begins */
    return block;
}

void bvxi_heap_free(void *user, void *block, size_t size, size_t align)
{
    unsigned char *raw;
    (void)user, (void)size, (void)align;
    if (block == NULL) return;
    memcpy(&raw, (unsigned char *)block - sizeof raw, sizeof raw);
    free(raw);
}

#endif
