/* components.h - connected components of voxels that come row by row. Not installed.
 *
 *   bvxi_components_open(ctx, function, BVXI_CONNECT_6, size, run_count, &c);
 *   for each row of the box, in the order of z and y: fill bvxi_components_row(&c, y, z);
 *   bvxi_components_add(&c, y, z);
 *   bvxi_components_number(&c);
 *   c.label[i] is now the component of the i-th run along x; the runs are made again to colour or to measure
 *   them.
 *   bvxi_components_free(&c);
 */
#ifndef BVXI_COMPONENTS_H
#define BVXI_COMPONENTS_H

#include "bits/bits.h"

/* Voxels are neighbours across faces; across faces and edges; across faces, edges and corners. */
enum { BVXI_CONNECT_6 = 6, BVXI_CONNECT_18 = 18, BVXI_CONNECT_26 = 26 };

typedef struct bvxi_components {
    bvx_context *ctx;
    /* a run of the same component, no later one; in the end the component [Size: run_count] */
    uint32_t *label;
    uint64_t run_count, added;
    uint64_t component_count; /* after bvxi_components_number */
    /* two slices with empty rows and words around them: slice z at (z & 1) * slice */
    uint64_t *words;
    uint32_t *before;       /* runs that begin before each of these words */
    uint64_t stride, slice; /* words from row to row, and of a slice */
    int32_t row_words, connectivity;
} bvxi_components;

/* Ready for exactly run_count runs of a box of size voxels. Refuses 2^32 - 1 runs and more with
 * BVX_ERR_RANGE.
 * Memory (scratch): 4 bytes a run, and until they are numbered 24 for each word of a slice. */
bvx_status bvxi_components_open(bvx_context *ctx, const char *function, int32_t connectivity,
                                const int32_t size[3], uint64_t run_count, bvxi_components *c);
/* Where the words of the next row go, all of them; bits past the row's end must be 0. */
uint64_t *bvxi_components_row(bvxi_components *c, int32_t y, int32_t z);
/* Take that row. No row of the box may be left out. */
void bvxi_components_add(bvxi_components *c, int32_t y, int32_t z);
/* Number the components by their least linear index (z, y, x), from 0. */
void bvxi_components_number(bvxi_components *c);
void bvxi_components_free(bvxi_components *c);

#endif
