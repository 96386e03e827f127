/* refine.h - what the steps of bvx_refine share: the job, the grids that it starts from, the touched voxels
 * of a level, and one call for each step. Not installed. */
#ifndef BVXI_REFINE_H
#define BVXI_REFINE_H

#include "refine/room.h"
#include "solid/snap.h"

/* Grids up to this many bytes are made at the last level; else the start is
 * the last level below the second number. */
#define BVXI_REFINE_WHOLE_GRID ((uint64_t)1 << 27)
#define BVXI_REFINE_START_GRID ((uint64_t)1 << 21)

/* Bits of the touched voxels of levels 0 .. start, rows as in a grid. */
typedef struct bvxi_refine_grids {
    uint64_t *words[BVXI_OCTREE_LEVELS + 1];
} bvxi_refine_grids;

/* The touched voxels of one level, in the order of the tree: octets to be. */
typedef struct bvxi_refine_front {
    uint64_t count;
    int32_t *ijk; /* [Size: count * 3] */
    /* lists from the start level on: voxel n has list[offset[s]] .. list[offset[s + 1]], s = slot[n], or n */
    uint64_t *offset;
    uint32_t *list;
    uint32_t *slot; /* at the start level: the voxel's rank in the grid; else NULL */
    uint64_t slots, pairs;
} bvxi_refine_front;

typedef struct bvxi_refine_job {
    bvx_context *ctx;
    const bvx_mesh_view *view;
    bvx_octree *tree;
    bvxi_snapped snapped;
    int32_t start; /* the last level that comes from a grid */
    /* 1: voxels of level outer and finer ones are split where they meet the window only */
    int32_t windowed, outer;
    int32_t low[3], last[3]; /* the window, both ends inclusive [Units: voxels of the last level] */
    /* flat voxels stay whole: 0 none do, else the tolerance, and a fixed-point step [Units: world] */
    double tolerance, step[3];
    bvxi_refine_grids grids;
    bvxi_refine_front front;
    /* by level and octet: 8 * octet above + child, or the linear index of the base voxel */
    uint32_t *up[BVXI_OCTREE_LEVELS];
} bvxi_refine_job;

/* ---- refine_start.c ---- */

/* The grids of levels 0 .. start, the root's bits, the first front; lists when the start level is split. */
bvx_status bvxi_refine_start(bvxi_refine_job *job);
/* The lists of the start level's front, when it is reached. */
bvx_status bvxi_refine_lists(bvxi_refine_job *job);
void bvxi_refine_free_grids(bvxi_refine_job *job);

/* ---- refine_level.c ---- */

/* Split the front of a level: its octets, and the next front unless that is the last level's. */
bvx_status bvxi_refine_split(bvxi_refine_job *job, int32_t level);
void bvxi_refine_free_front(bvxi_refine_job *job, bvxi_refine_front *front);

/* ---- flat.c ---- */

/* 1 when the triangles of a list (those with this bit in hits, unless that
 * is NULL) lie within the tolerance of a plane. */
int bvxi_refine_is_flat(const bvxi_refine_job *job, const uint32_t *list, const uint8_t *hits, uint32_t bit,
                        uint64_t count);

/* ---- row_states.c ---- */

/* Find what is outside by the rows of solids: for a tree with a window. */
bvx_status bvxi_octree_row_states(bvxi_refine_job *job);

/* ---- states.c ---- */

/* Bytes of scratch for a tree of these levels. */
uint64_t bvxi_states_bytes(const bvx_octree *tree, int32_t levels);
/* Find what is outside. */
bvx_status bvxi_octree_states(bvx_context *ctx, bvx_octree *tree, uint32_t *const *up);

/* Is a touched voxel of a level split, as far as levels and window say? */
static inline int bvxi_refine_wants(const bvxi_refine_job *job, int32_t level, const int32_t v[3])
{
    if (level == job->tree->levels) return 0;
    if (!job->windowed || level < job->outer) return 1;
    for (int a = 0; a < 3; a++)
        if (v[a] < job->low[a] >> (job->tree->levels - level) ||
            v[a] > job->last[a] >> (job->tree->levels - level))
            return 0;
    return 1;
}

/* How the touched voxels of a level are split. */
static inline int bvxi_refine_split_kind(const bvxi_refine_job *job, int32_t level)
{
    if (level == job->tree->levels) return BVXI_SPLIT_NONE;
    return (job->windowed && level >= job->outer) || job->tolerance > 0 ? BVXI_SPLIT_SOME : BVXI_SPLIT_ALL;
}

/* ---- sizes ---- */

static inline int32_t bvxi_refine_row_words(const bvx_octree *tree, int32_t level)
{
    return bvxi_row_words(tree->base[0] << level);
}

/* Words of the grid of a level; UINT64_MAX when there are too many. */
static inline uint64_t bvxi_refine_grid_words(const bvx_octree *tree, int32_t level)
{
    int ok = 1;
    uint64_t const rows = (uint64_t)(tree->base[1] << level) * (uint64_t)(tree->base[2] << level);
    uint64_t const words = bvxi_mul(rows, (uint64_t)bvxi_refine_row_words(tree, level), &ok);
    return ok ? words : UINT64_MAX;
}

#endif
