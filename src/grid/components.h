/* components.h - connected components of voxels that come as a stream of runs along x. Not installed.
 *
 *   bvxi_components_open(ctx, function, BVXI_CONNECT_6, size, run_count, &c);
 *   for each run, in the order of rows (z, y) and of x in a row: bvxi_components_add(&c, begin, end, y, z);
 *   bvxi_components_number(&c);
 *   c.label[i] is now the component of the i-th run; the runs are made again to colour or to measure them.
 *   bvxi_components_free(&c);
 */
#ifndef BVXI_COMPONENTS_H
#define BVXI_COMPONENTS_H

#include "bits/bits.h"

/* Voxels are neighbours across faces; across faces and edges; across faces, edges and corners. */
enum { BVXI_CONNECT_6 = 6, BVXI_CONNECT_18 = 18, BVXI_CONNECT_26 = 26 };

/* Voxels [begin, end) of a row. */
typedef struct bvxi_component_run {
    uint64_t row; /* z * ny + y */
    int32_t begin, end;
} bvxi_component_run;

/* A row before the present one in which neighbours lie. */
typedef struct bvxi_component_reach {
    int32_t dy, dz;
    int32_t reach;   /* 1: the run's diagonal neighbours along x count too */
    uint32_t cursor; /* number of the first run that may still touch what comes */
} bvxi_component_reach;

typedef struct bvxi_components {
    bvx_context *ctx;
    uint32_t *label;           /* a run of the same component, no later one; in the end the component [Size: run_count] */
    uint64_t run_count, added;
    uint64_t component_count;  /* after bvxi_components_number */
    bvxi_component_run *ring;  /* the last runs that were added, run i at i % ring_size */
    uint32_t ring_size;
    int32_t ny, reach_count;
    bvxi_component_reach reach[4];
} bvxi_components;

/* Ready for exactly run_count runs of a box of size voxels. Refuses 2^32 - 1 runs and more with BVX_ERR_RANGE.
 * Memory (scratch): 4 bytes a run, and until they are numbered 16 for each run of a slice and two rows. */
bvx_status bvxi_components_open(bvx_context *ctx, const char *function, int32_t connectivity, const int32_t size[3],
                                uint64_t run_count, bvxi_components *c);
/* The next run; touching runs of one row must come as one. Runs beyond run_count are not taken. */
void bvxi_components_add(bvxi_components *c, int32_t begin, int32_t end, int32_t y, int32_t z);
/* Number the components by their least linear index (z, y, x), from 0. */
void bvxi_components_number(bvxi_components *c);
void bvxi_components_free(bvxi_components *c);

/* ---- Runs of a word: bits where membership changes; *last is the bit before the word, then the word's last one. ----
 * Over a row from *last = 0 the changes are begin, end, begin, end, ...; a run that the row's end closes has no end. */
static inline uint64_t bvxi_run_changes(uint64_t w, uint64_t *last)
{
    uint64_t const changes = w ^ (w << 1 | *last);
    *last = w >> 63;
    return changes;
}

/* Index of the highest set bit; w is not 0. */
static inline int32_t bvxi_highest(uint64_t w)
{
#if defined(__GNUC__)
    return 63 - __builtin_clzll(w);
#else
    w |= w >> 1;
    w |= w >> 2;
    w |= w >> 4;
    w |= w >> 8;
    w |= w >> 16;
    w |= w >> 32;
    return (int32_t)bvxi_popcount(w) - 1;
#endif
}

#endif
