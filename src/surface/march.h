/* march.h - marching cubes over bit rows; the part shared by extraction and LOD. Not installed.
 *
 * A slot is a row of lattice edges and cells by its low (j, k), j and k from -1: rows before the window's
 * first are empty. It owns the x-edges of row (j, k), the y-edges from it to (j+1, k), the z-edges from it to
 * (j, k+1), and the cells between the four rows. Vertices are numbered slot by slot, x-, y-, z-edges, each by
 * rising x, which is the canonical order; so the number of a vertex is its slot's base plus the rank of its
 * bit in the crossing mask. */
#ifndef BVXI_MARCH_H
#define BVXI_MARCH_H

#include "bits/bits.h"
#include "grid/grid.h"
#include "mesh/mesh.h"

/* First numbers of a slot's vertices by axis and of its triangles (counts before the prefix sum). */
typedef struct bvxi_slot {
    uint32_t edge[3];
    uint32_t triangle;
} bvxi_slot;

/* Where a vertex sits on its edge: ratio in (0,1) from centre (i,j,k) of the window along axis; -1 is a
 * centre before the window. NULL: the middle. Called from workers. */
typedef double bvxi_ratio_fn(const void *user, int32_t axis, int32_t i, int32_t j, int32_t k);

/* Samples whose level the surface is: the grid holds which of them are inside. */
typedef struct bvxi_level_samples {
    const uint8_t *samples; /* of the window's voxel (0,0,0) */
    int64_t stride[3];      /* [Units: bytes] */
    int32_t type;           /* BVX_SAMPLE_... */
    double level;
} bvxi_level_samples;

typedef struct bvxi_march {
    const bvx_grid *grid;
    bvx_extract_options options;
    bvxi_ratio_fn *ratio;
    const void *ratio_user;
    const bvxi_level_samples *level; /* in place of ratio, or NULL */
    const char *function;            /* named in messages */
    int32_t cpu;
    int32_t cell_low[3], cell_high[3]; /* visited cells by low corner, inclusive */
    /* 1: a side too short between open sides: no cells, so no edges of theirs */
    int32_t no_cells;
    int32_t edge_words;             /* words of a row's x-edges: one bit more than voxels */
    uint64_t first_mask, last_mask; /* visited cells of the first and last edge word */
    uint64_t past_mask;             /* bits of a row's last word at or past size[0]: they must be 0 */
    bvxi_slot *slots;               /* [Size: slot_count + 1] */
    uint64_t slot_count;
    int32_t pieces;
    /* [Size: pieces * 3] vertices, triangles, bits at or past size[0] that are set */
    uint64_t *piece_counts;
    uint64_t vertex_count, triangle_count;
    double origin[3], spacing[3]; /* of positions: origin 0 in a local frame */
    const uint64_t *empty_row;    /* [Size: words_per_row] */
    double *across[2];            /* x of edges and of centres [Size: size[0] + 2] */
    bvx_mesh *mesh;
} bvxi_march;

/* 1 where steps of f32 at the grid's largest coordinate are at most 1/256 of a voxel. */
int bvxi_fits_f32(const bvx_grid *grid, const double origin[3]);
/* BVX_POSITION_AUTO becomes BVX_F32 where it fits, else BVX_F64; BVX_F32 is refused where it does not fit. */
bvx_status bvxi_choose_position_type(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                     const double origin[3], int32_t *position_type);
/* Doubles that could not distinguish neighbouring places. */
bvx_status bvxi_check_f64(bvx_context *ctx, const char *function, const bvx_grid *grid,
                          const double origin[3]);
/* Check, choose cells, count: after success the counts and slots stand. */
bvx_status bvxi_march_open(bvx_context *ctx, bvxi_march *m, const bvx_grid *grid,
                           const bvx_extract_options *options);
bvx_status bvxi_march_fill(bvx_context *ctx, bvxi_march *m, bvx_mesh *mesh);

/* emit.c: pieces of slots for bvxi_parallel. */
void bvxi_march_emit_piece(void *march, int32_t piece);

/* Vertices keep this far from an edge's ends, in edge lengths: two f32
 * steps at least (march.c), so no two meet. */
#define BVXI_EDGE_MARGIN (1.0 / 128.0)

/* World coordinate along an axis of a place between centres: index counts centres of the window. */
static inline double bvxi_place_along(const bvxi_march *m, int32_t axis, int32_t index, double ratio)
{
    return m->origin[axis] + ((double)(m->grid->low[axis] + index) + 0.5 + ratio) * m->spacing[axis];
}

static inline double bvxi_keep_off_ends(double ratio)
{
    return ratio < BVXI_EDGE_MARGIN         ? BVXI_EDGE_MARGIN
           : ratio > 1.0 - BVXI_EDGE_MARGIN ? 1.0 - BVXI_EDGE_MARGIN
                                            : ratio;
}

/* The vertex at a ratio of the edge from centre (i, j, k) along axis. */
static inline void bvxi_put_crossing(const bvxi_march *m, uint64_t vertex, int32_t axis, int32_t i, int32_t j,
                                     int32_t k, double t)
{
    bvxi_put_position(
        m->mesh, m->options.position_type, vertex, bvxi_place_along(m, 0, i, axis == 0 ? t : 0.0),
        bvxi_place_along(m, 1, j, axis == 1 ? t : 0.0), bvxi_place_along(m, 2, k, axis == 2 ? t : 0.0));
}

/* Slot number to the low row (j, k) of its cells. */
static inline void bvxi_slot_row(const bvxi_march *m, uint64_t slot, int32_t *j, int32_t *k)
{
    uint64_t const rows = (uint64_t)m->grid->size[1] + 1;
    *k = (int32_t)(slot / rows) - 1;
    *j = (int32_t)(slot % rows) - 1;
}

/* The words of row (j, k); an empty row outside the window. */
static inline const uint64_t *bvxi_march_row(const bvxi_march *m, int32_t j, int32_t k)
{
    const bvx_grid *const g = m->grid;
    if (j < 0 || k < 0 || j >= g->size[1] || k >= g->size[2]) return m->empty_row;
    return bvxi_grid_row(g, j, k);
}

/* Cells of edge word n that are visited. */
static inline uint64_t bvxi_visited(const bvxi_march *m, int32_t n)
{
    uint64_t mask = ~UINT64_C(0);
    if (n == 0) mask &= m->first_mask;
    if (n == m->edge_words - 1) mask &= m->last_mask;
    return mask;
}

/* 1 when the slot owns crossings of the axis (0, 1, 2), or visited cells (3). */
static inline int bvxi_slot_has(const bvxi_march *m, int32_t what, int32_t j, int32_t k)
{
    int const j_cell = j >= m->cell_low[1] && j <= m->cell_high[1];
    int const k_cell = k >= m->cell_low[2] && k <= m->cell_high[2];
    if (m->no_cells) return 0;
    switch (what) {
    case 0: return j >= 0 && k >= 0;
    case 1: return k >= 0 && j_cell;
    case 2: return j >= 0 && k_cell;
    default: return j_cell && k_cell;
    }
}

#endif
