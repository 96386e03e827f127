/* paper_refine.h - refinement as the paper of boundary states describes it: the baseline for bvx_refine. */
#ifndef PAPER_REFINE_H
#define PAPER_REFINE_H

#include "bench.h"

typedef struct paper_tree paper_tree;

typedef struct paper_counts {
    uint64_t surface, inside, outside; /* leaves */
    uint64_t tests;                    /* of a box against a triangle */
    uint64_t bytes;                    /* taken for nodes and lists */
} paper_counts;

/* base: the lattice of level 0. states 0: surface voxels only, as an octree voxelization makes them.
 * points: x, y, z of each vertex [Units: world]. Ends the program when memory runs out. */
paper_tree *paper_refine(bench_memory *memory, const double *points, uint64_t point_count,
                         const uint32_t *triangles, uint64_t triangle_count, const bvx_lattice *base,
                         int32_t levels, int states);
void paper_tree_count(const paper_tree *tree, paper_counts *counts);
void paper_tree_free(paper_tree *tree);

#endif
