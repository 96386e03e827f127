/* states.h - boundary states on their way: what is known of an octet and of a cube, and the lists of those
 * with news. Only states.c includes this. Not installed. */
#ifndef BVXI_STATES_H
#define BVXI_STATES_H

#include "refine/refine.h"

enum { BVXI_IN_LIST = 0x80 };

/* What is known of an octet. */
typedef struct bvxi_octet_news {
    uint8_t touched, split, outside; /* children; outside: those that have passed it on */
    uint8_t fresh;                   /* outside too, not passed on yet */
    uint8_t state;                   /* boundary state of all of it, and BVXI_IN_LIST */
} bvxi_octet_news;

/* The same of a cube, its voxels in words. */
typedef struct bvxi_cube_news {
    uint64_t touched, outside, fresh;
    uint8_t state;
} bvxi_cube_news;

typedef struct bvxi_states_job {
    bvx_octree *tree;
    uint32_t *const *up;
    int32_t bottom; /* the level of octets that are cubes; -1 when there are no octets */
    /* number of each level's first octet among all; cubes come last */
    uint64_t first[BVXI_OCTREE_LEVELS + 1];
    bvxi_octet_news *news;
    bvxi_cube_news *cubes;
    uint32_t *list; /* octets and cubes with news */
    uint64_t listed;
    uint64_t *passed; /* of the base: outside bits that have been passed on */
    uint32_t *row_list;
    uint8_t *row_in_list;
    uint64_t rows_listed;
    int32_t nx, ny, nz, row_words, pieces;
} bvxi_states_job;

static inline bvxi_octet_news *bvxi_news_of(const bvxi_states_job *job, int32_t level, uint64_t octet)
{
    return &job->news[job->first[level] + octet];
}

static inline void bvxi_list_numbered(bvxi_states_job *job, int32_t level, uint64_t octet, uint8_t *state)
{
    if ((*state & BVXI_IN_LIST) != 0) return;
    *state |= BVXI_IN_LIST;
    job->list[job->listed++] = (uint32_t)(job->first[level] + octet);
}

static inline void bvxi_list_row(bvxi_states_job *job, uint64_t row)
{
    if (job->row_in_list[row]) return;
    job->row_in_list[row] = 1;
    job->row_list[job->rows_listed++] = (uint32_t)row;
}

/* All of an octet's face is exposed. */
static inline void bvxi_expose_octet(bvxi_states_job *job, int32_t level, uint64_t octet, uint32_t state)
{
    uint8_t *const known = level == job->bottom ? &job->cubes[octet].state
                                                : &bvxi_news_of(job, level, octet)->state;
    if ((state & ~(uint32_t)*known) == 0) return;
    *known = (uint8_t)(*known | state);
    bvxi_list_numbered(job, level, octet, known);
}

#endif
