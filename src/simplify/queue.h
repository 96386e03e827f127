/* queue.h - edges by rising cost, and near each other where costs are alike. Not installed.
 *
 * Costs fall into buckets of a sixty-fourth of a power of two. What lies further on waits in coarse buckets
 * of half a power of two, in the order in which it was put, which is one of space; the lowest coarse bucket
 * is parted into fine ones a batch at a time, so that edges that are taken one after the other are near in
 * memory, or wholly where the order by cost matters more. Putting and taking cost the same for any number of
 * edges. Entries are not removed when an edge changes: whoever takes one compares its stamp with the edge's.
 */
#ifndef BVXI_QUEUE_H
#define BVXI_QUEUE_H

#include "core/core.h"

enum {
    BVXI_QUEUE_OCTAVE = 64, /* fine buckets that a doubled cost lies further on */
    BVXI_QUEUE_SPAN = 256,  /* fine buckets to a coarse one */
    BVXI_QUEUE_FINE = 256 * BVXI_QUEUE_OCTAVE,
    BVXI_QUEUE_COARSE = BVXI_QUEUE_FINE / BVXI_QUEUE_SPAN,
    BVXI_QUEUE_HEADS = BVXI_QUEUE_COARSE + BVXI_QUEUE_SPAN,
    BVXI_QUEUE_CHUNK = 10, /* entries of a chunk: 128 bytes */
    BVXI_QUEUE_NONE = -1
};

typedef struct bvxi_queue_entry {
    int32_t corner;
    uint32_t stamp;
    int32_t bucket; /* fine */
} bvxi_queue_entry;

typedef struct bvxi_queue_chunk {
    int32_t next, count; /* the chunk put before it in its bucket, or the next free one */
    bvxi_queue_entry entry[BVXI_QUEUE_CHUNK];
} bvxi_queue_chunk;

typedef struct bvxi_queue {
    int32_t *head; /* the last chunk of each coarse bucket, then of each fine one of the lowest [Size:
                      BVXI_QUEUE_HEADS] */
    bvxi_queue_chunk *chunk;
    int32_t chunks, used; /* chunks that there are; that were ever used */
    int32_t free;         /* a chain of chunks given back */
    int32_t coarse;       /* the bucket that is parted; no lower one holds anything */
    int32_t fine;         /* none of its fine buckets below this one holds anything */
    int32_t batch;        /* entries that are parted at once */
} bvxi_queue;

/* Costs rise with the bits of a float: exponent and six bits of the fraction number the buckets. */
static inline int32_t bvxi_queue_bucket(double cost)
{
    float const value = cost > 0 ? cost < 3e38 ? (float)cost : 3e38f : 0.0f;
    uint32_t bits;

    memcpy(&bits, &value, sizeof bits);
    return (int32_t)(bits >> 17);
}

static inline void bvxi_queue_clear(bvxi_queue *q)
{
    for (int32_t i = 0; i < BVXI_QUEUE_HEADS; i++) q->head[i] = BVXI_QUEUE_NONE;
    q->used = 0;
    q->free = BVXI_QUEUE_NONE;
    q->coarse = 0;
    q->fine = BVXI_QUEUE_SPAN;
}

/* Chunks that are there for entries to come. */
static inline int32_t bvxi_queue_room(const bvxi_queue *q)
{
    return q->chunks - q->used;
}

static inline void bvxi_queue_push(bvxi_queue *q, int32_t head, const bvxi_queue_entry *entry)
{
    int32_t at = q->head[head];

    if (at == BVXI_QUEUE_NONE || q->chunk[at].count == BVXI_QUEUE_CHUNK) {
        int32_t fresh = q->free;

        if (fresh != BVXI_QUEUE_NONE) q->free = q->chunk[fresh].next;
        else fresh = q->used++;
        q->chunk[fresh].next = at;
        q->chunk[fresh].count = 0;
        q->head[head] = at = fresh;
    }
    q->chunk[at].entry[q->chunk[at].count++] = *entry;
}

static inline bvxi_queue_entry bvxi_queue_pop(bvxi_queue *q, int32_t head)
{
    int32_t const at = q->head[head];
    bvxi_queue_entry const entry = q->chunk[at].entry[--q->chunk[at].count];

    if (q->chunk[at].count == 0) {
        q->head[head] = q->chunk[at].next;
        q->chunk[at].next = q->free;
        q->free = at;
    }
    return entry;
}

/* What is cheaper than the bucket that is parted goes to its first fine one. */
static inline void bvxi_queue_put(bvxi_queue *q, const bvxi_queue_entry *entry)
{
    int32_t const coarse = entry->bucket / BVXI_QUEUE_SPAN;
    int32_t const fine = coarse < q->coarse ? 0 : entry->bucket % BVXI_QUEUE_SPAN;

    if (coarse > q->coarse) {
        bvxi_queue_push(q, coarse, entry);
        return;
    }
    bvxi_queue_push(q, BVXI_QUEUE_COARSE + fine, entry);
    if (fine < q->fine) q->fine = fine;
}

/* The corner of an entry that comes soon, most likely; else -1. */
static inline int32_t bvxi_queue_soon(const bvxi_queue *q)
{
    int32_t const at = q->fine < BVXI_QUEUE_SPAN ? q->head[BVXI_QUEUE_COARSE + q->fine] : BVXI_QUEUE_NONE;
    return at != BVXI_QUEUE_NONE && q->chunk[at].count > 3 ? q->chunk[at].entry[q->chunk[at].count - 3].corner
                                                           : -1;
}

/* Take one of the cheapest entries; 0 when there is none. */
static inline int bvxi_queue_take(bvxi_queue *q, bvxi_queue_entry *entry)
{
    for (;;) {
        while (q->fine < BVXI_QUEUE_SPAN && q->head[BVXI_QUEUE_COARSE + q->fine] == BVXI_QUEUE_NONE)
            q->fine++;
        if (q->fine < BVXI_QUEUE_SPAN) break;

        while (q->coarse < BVXI_QUEUE_COARSE && q->head[q->coarse] == BVXI_QUEUE_NONE) q->coarse++;
        if (q->coarse == BVXI_QUEUE_COARSE) return 0;
        for (int32_t i = 0; i < q->batch && q->head[q->coarse] != BVXI_QUEUE_NONE; i++) {
            bvxi_queue_entry const next = bvxi_queue_pop(q, q->coarse);

            bvxi_queue_push(q, BVXI_QUEUE_COARSE + next.bucket % BVXI_QUEUE_SPAN, &next);
        }
        q->fine = 0;
    }
    *entry = bvxi_queue_pop(q, BVXI_QUEUE_COARSE + q->fine);
    return 1;
}

#endif
