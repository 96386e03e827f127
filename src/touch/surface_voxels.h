/* surface_voxels.h - a mesh's surface as voxels: what the three definitions share (triangles by tiles of
 * rows, what is done with a touched voxel), and the exact runs of voxels of one triangle. Not installed. */
#ifndef BVXI_SURFACE_VOXELS_H
#define BVXI_SURFACE_VOXELS_H

#include "bits/bits.h"
#include "grid/grid.h"
#include "solid/covered_rows.h"
#include "solid/tiles.h"

/* ---- A mesh's surface as voxels: what the three definitions of it share ---- */

/* Triangles are sorted by tile of rows, ascending within each. A tile is one task: it alone writes its rows,
 * so nothing is atomic and lists of attached triangles come out ascending. */

enum { BVXI_SURFACE_TILES = 64 };

/* What is done with a voxel that a triangle touches. */
enum { BVXI_TOUCH_SET = 0, BVXI_TOUCH_COUNT = 1, BVXI_TOUCH_LIST = 2 };

/* Triangles by tile: tile t has id[end[t] .. end[t + 1]). A single tile has no ids: it has all triangles. */
typedef struct bvxi_bins {
    uint32_t *id;
    uint64_t total; /* ids of all tiles */
    uint64_t end[BVXI_SURFACE_TILES + 1];
} bvxi_bins;

typedef struct bvxi_surface_job {
    const bvx_mesh_view *view;
    const bvx_grid *grid;  /* words are written by BVXI_TOUCH_SET */
    const bvx_grid *solid; /* thin: crossings beside its voxels are left out; of grid's window, or NULL */
    bvxi_snapped snapped;
    bvxi_tiles tiles; /* of the window's rows */
    bvxi_bins bins;
    int32_t fraction_bits, mode, cpu, task;
    int32_t summed;          /* thin, with solid: beyond is wanted */
    int32_t pieces;          /* of the triangles, for a single tile */
    uint32_t first;          /* triangle of the present piece */
    int32_t size[3], low[3]; /* of the window [Units: voxels] */

    /* workers beside the first that have grids of their own, for a single tile: voxelize_surface.c */
    int32_t helper_count;
    struct bvxi_surface_helper *helpers;
    uint64_t *helper_words;

    /* attached triangles */
    bvxi_rank rank;
    uint64_t *offset; /* by voxel: count, then where the next triangle goes */
    uint32_t *list;
    uint32_t *last; /* by voxel: the triangle counted last, plus 1 */

    uint64_t used[BVXI_SURFACE_TILES], samples[BVXI_SURFACE_TILES], parts[BVXI_SURFACE_TILES]; /* by tile */
    /* with solid, by tile and axis: what the surface has more than its voxels [Units: 2^-16 voxels] */
    int64_t beyond[BVXI_SURFACE_TILES][3];
} bvxi_surface_job;

/* A task's view of its tile. */
typedef struct bvxi_surface_tile {
    bvxi_surface_job *job;
    bvxi_rows rows;
    int32_t number;
} bvxi_surface_tile;

/* tile_bins.c: sort the triangles by tile; checks their indices. */
bvx_status bvxi_bins_open(bvx_context *ctx, const char *function, bvxi_surface_job *job);

/* Triangles into the tile's rows, by the mode's definition: id[0 .. count),
 * or when id is NULL count ones from job->first on. */
void bvxi_touch_conservative(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count);
void bvxi_touch_thin(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count);
void bvxi_touch_sampled(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count);

static inline uint64_t *bvxi_surface_words(const bvxi_surface_job *job, const bvx_grid *grid, int32_t j,
                                           int32_t k)
{
    return grid->words + ((size_t)k * (size_t)job->size[1] + (size_t)j) * (size_t)grid->words_per_row;
}

static inline uint64_t *bvxi_surface_row(const bvxi_surface_job *job, int32_t j, int32_t k)
{
    return bvxi_surface_words(job, job->grid, j, k);
}

/* Count or list a triangle for voxels from bit `first` of the grid on; any
 * may come again from the same triangle. */
static inline void bvxi_attach_run(bvxi_surface_job *job, uint64_t first, uint32_t count, uint32_t triangle)
{
    uint32_t at = bvxi_rank_before(&job->rank, first);
    for (uint32_t n = 0; n < count; n++, at++) {
        if (job->last[at] == triangle + 1) continue;
        job->last[at] = triangle + 1;
        if (job->task == BVXI_TOUCH_LIST) job->list[job->offset[at]] = triangle;
        job->offset[at]++;
    }
}

/* Triangle touches voxels [x0, x1] of row (j, k), all inside the window.
 * Any voxel may come again from one triangle. */
static inline void bvxi_touch_run(bvxi_surface_job *job, int32_t j, int32_t k, int32_t x0, int32_t x1,
                                  uint32_t triangle)
{
    uint64_t *const row = bvxi_surface_row(job, j, k);
    if (BVXI_LIKELY(job->task == BVXI_TOUCH_SET)) {
        bvxi_set_run(row, x0, x1 + 1);
        return;
    }
    bvxi_attach_run(job, (uint64_t)(row - job->grid->words) * BVXI_WORD_BITS + (uint64_t)x0,
                    (uint32_t)(x1 - x0) + 1, triangle);
}

static inline void bvxi_touch_voxel(bvxi_surface_job *job, int32_t i, int32_t j, int32_t k, uint32_t triangle)
{
    uint64_t *const row = bvxi_surface_row(job, j, k);
    if (BVXI_LIKELY(job->task == BVXI_TOUCH_SET)) row[i >> 6] |= UINT64_C(1) << (i & 63);
    else bvxi_attach_run(job, (uint64_t)(row - job->grid->words) * BVXI_WORD_BITS + (uint64_t)i, 1, triangle);
}

/* ---- voxelize_surface.c ---- */

/* Set in lost, a grid of solid's window whose words may hold anything, the thin voxels of
 * crossings that solid does not show: a line of centres crosses the mesh between two neighbours, and neither
 * is in solid. So each is in no piece of solid, but for parts narrower than a voxel along the line and
 * sheets. Exact; any threads. Scratch: as bvx_voxelize_surface.
 * beyond: by axis, the voxels by which solid would grow if it ended where lines of centres leave the mesh,
 * not half way between two centres. Each crossing counts along the axis that its triangle faces most. What
 * solid does not show, and what it closes without a surface, is not in it. The same bits for any order of
 * triangles and corners. NULL: not wanted, and triangles whose crossings solid shows are left sooner. */
bvx_status bvxi_lost_surface(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_grid *solid, bvx_grid *lost, double beyond[3]);
/* The conservative surface of a mesh over the window of solid, in scratch words. */
bvx_status bvxi_shell_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *solid,
                           bvx_grid *shell);

/* ---- The exact runs of voxels that one triangle of any size touches ---- */

/* Hand the runs within the tile's rows and the window to bvxi_touch_run.
 * Corners are relative to the window's low corner. */
void bvxi_touch_rows(bvxi_surface_tile *tile, const int32_t (*corner)[3], uint32_t triangle);

#endif
