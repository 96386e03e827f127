/* thin_walls.h - walls of a closed body that are thinner than a lattice can hold: the search for them, for
 * rooms that report or keep them. Not installed. */
#ifndef BVXI_THIN_WALLS_H
#define BVXI_THIN_WALLS_H

#include "grid/grid.h"
#include "nearest/closest.h"

#define BVXI_THIN_WALL 1.5 /* what holds on any lattice [Units: largest spacings] */
#define BVXI_NO_WALL   1e30f

/* How deep behind the front the back is looked for: half of BVXI_THIN_WALL, as from there the back of a thin
 * wall is at least as near as its front [Units: largest spacings] */
#define BVXI_WALL_DEPTH 0.75

/* How far from a place the search for walls needs triangles: those of the nearest point within one spacing, then of the
 * nearest to a point BVXI_WALL_DEPTH behind it, at most BVXI_WALL_DEPTH further. More for walls that stand on other
 * parts, and for centres around the places: the root of 3, rounded up [Units: largest spacings] */
#define BVXI_WALL_REACH  (1.0 + 2 * BVXI_WALL_DEPTH)
#define BVXI_WALL_BESIDE 1.8

/* Whether the body has holes. HOLES: faces may be seen from behind through them, and sheets are no walls;
 * NO_SHEETS: only the latter. */
enum { BVXI_WALLS_CLOSED = 0, BVXI_WALLS_HOLES = 1, BVXI_WALLS_NO_SHEETS = 2 };

/* What the mesh is like at a centre outside. */
typedef struct bvxi_wall {
    /* BVXI_NO_WALL, or how thick the nearest wall is; 0: a sheet [Units: largest spacings] */
    float wall;
    float distance; /* to it */
    int32_t sheet;
    int32_t unsure; /* 1: not asked yet, or the search had too few triangles */
} bvxi_wall;

/* A mesh's triangles by cells of a window, for many looks at what is near. */
typedef struct bvxi_near_cells {
    int32_t block, size[3]; /* voxels along a block's edge, blocks along each axis */
    uint32_t *block_of;     /* of each vertex, cut to the window: x, y, z [Size: vertices] */
    uint32_t *cell_of;      /* of each triangle [Size: triangles] */
} bvxi_near_cells;

/* A search for them. The first ten are the caller's, the rest 0 before the first call. */
typedef struct bvxi_walls {
    bvx_context *ctx;
    const char *function;
    const bvx_mesh_view *mesh;    /* of the body */
    const bvx_grid *solid;        /* what it fills; may change between calls */
    int32_t unoriented;           /* 1: normals may look to either side */
    int32_t open;                 /* BVXI_WALLS_... */
    int32_t parts;                /* 1: walls may stand on faces of other parts, which go on in them */
    int32_t unsummed;             /* 1: beyond is not wanted */
    const bvxi_near_cells *cells; /* the mesh's, or NULL */

    double unit;      /* the largest spacing */
    double beyond[3]; /* of bvxi_lost_surface [Units: voxels] */

    /* walls further from the centre than this are not looked at [Units: largest spacings] */
    double limit;
    double covered;   /* about each place, by the triangles of the search [Units: world] */
    bvx_grid places;  /* scratch words: centres in question */
    uint64_t bytes;   /* of these */
    uint64_t *at;     /* their bits [Size: count] */
    bvxi_wall *point; /* what is there [Size: count] */
    uint64_t count;
    uint32_t *corner; /* of the triangles nearby, each from its first corner to its last, by place */
    uint8_t *against; /* of those triangles, 1: the mesh has them the other way round */
    bvx_mesh_view near;
    bvx_closest closest;
    int32_t pieces;
    int32_t inverted; /* 1: a body with holes whose triangles face inward */
} bvxi_walls;

/* How many, how thin and where. */
typedef struct bvxi_wall_report {
    uint64_t voxels;
    double wall;             /* nine tenths are this thick or thicker [Units: largest spacings] */
    int32_t low[3], high[3]; /* box, both ends in it [Units: voxels of the window] */
} bvxi_wall_report;

/* Make the grid of places. bvxi_walls_close frees everything. */
bvx_status bvxi_walls_open(bvxi_walls *t);
void bvxi_walls_close(bvxi_walls *t);

/* Put the triangles of a checked mesh into cells, scratch. */
bvx_status bvxi_near_cells_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *window,
                                bvxi_near_cells *cells);
void bvxi_near_cells_close(bvx_context *ctx, bvxi_near_cells *cells);

/* The triangles of a mesh that may lie within reach of the set centres of places, in their order: all that do, and
 * some more. cells: the mesh's, of that window, or NULL. with_area: 1 leaves out those without. near is a view of *corner,
 * scratch of the caller's to drop [Size: triangles * 3]. reach: [Units: world] */
bvx_status bvxi_triangles_near(bvx_context *ctx, const bvx_mesh_view *mesh, const bvxi_near_cells *cells,
                               const bvx_grid *places, double reach, int32_t with_area, bvx_mesh_view *near,
                               uint32_t **corner);

/* Mark the places where the lattice may lose the surface; list them; take the triangles that lie within reach of them
 * [Units: largest spacings] and make a search of these (near has none where there are none); look at all that are
 * listed, by that search, or where there is none by one of its own. bvxi_walls_gather is the first two (count is 0
 * where there is nothing to ask). */
bvx_status bvxi_walls_mark(bvxi_walls *t);
bvx_status bvxi_walls_list(bvxi_walls *t);
bvx_status bvxi_walls_near(bvxi_walls *t, double reach);
bvx_status bvxi_walls_ask(bvxi_walls *t, double limit);
bvx_status bvxi_walls_gather(bvxi_walls *t);
/* Forget the list; the triangles around the places. */
void bvxi_walls_drop(bvxi_walls *t);
void bvxi_walls_forget(bvxi_walls *t);

/* What was found. Places without a thin wall are places no more. */
void bvxi_walls_report(bvxi_walls *t, bvxi_wall_report *report);
/* solid_losses.c: a search for the walls that a solid with this report has
 * lost; what was found goes to the report. */
void bvxi_walls_of_solid(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                         const bvx_grid *solid, const bvx_solid_report *report, bvxi_walls *walls);
void bvxi_tell_walls(bvxi_walls *walls, bvx_solid_report *report);
/* The volume of a solid that was searched, so many times as long along each axis as crossings say: a box
 * comes out exact. 0: it has none. */
double bvxi_volume_by_crossings(const bvxi_walls *walls, double volume);

/* voxelize_solid.c: replace that volume of a closed mesh, which fill makes a solid, by what lines twice as dense see, where a result
 * of volume made leaves it by more than a little. A lattice that is large, or beyond the memory limit, keeps it.
 * Scratch: two grids of eight times the lattice's size, and what bvx_voxelize_solid needs. */
bvx_status bvxi_see_volume(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                           const bvx_lattice *lattice, int32_t fill, double made, double *volume);

/* Of a solid's report: the volume that it should have, 0 where nothing says; 1: a rule that goes by triangles alone
 * made it, without lids. */
double bvxi_known_volume(const bvx_solid_report *report);
int bvxi_solid_is_closed(const bvx_solid_report *report);

/* Voxels along the longest axis, now longest, with which a wall is as thick
 * as holds anywhere; 0 where there is no such number. */
int32_t bvxi_wall_resolution(int32_t longest, double wall);

/* Centres as bits of a grid's words. */
static inline void bvxi_bit_centre(const bvx_grid *g, uint64_t bit, int32_t at[3])
{
    uint64_t const row = bit / 64 / (uint64_t)g->words_per_row;
    at[0] = (int32_t)(bit - row * (uint64_t)g->words_per_row * 64);
    at[1] = (int32_t)(row % (uint64_t)g->size[1]);
    at[2] = (int32_t)(row / (uint64_t)g->size[1]);
}

static inline uint64_t bvxi_centre_bit(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    return ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->words_per_row * 64 + (uint64_t)x;
}

#endif
