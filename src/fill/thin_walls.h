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

/* Whether the body has holes. HOLES: faces may be seen from behind through them, and sheets are no walls;
 * NO_SHEETS: only the latter. */
enum { BVXI_WALLS_CLOSED = 0, BVXI_WALLS_HOLES = 1, BVXI_WALLS_NO_SHEETS = 2 };

/* What the mesh is like at a centre outside. */
typedef struct bvxi_wall {
    /* BVXI_NO_WALL, or how thick the nearest wall is; 0: a sheet [Units: largest spacings] */
    float wall;
    float distance;    /* to it */
    uint32_t triangle; /* of those nearby */
    int32_t sheet;
} bvxi_wall;

/* A search for them. The first ten are the caller's, the rest 0 before the first call. */
typedef struct bvxi_walls {
    bvx_context *ctx;
    const char *function;
    const bvx_mesh_view *mesh; /* of the body */
    const bvx_grid *solid;     /* what it fills; may change between calls */
    int32_t unoriented;        /* 1: normals may look to either side */
    int32_t open;              /* BVXI_WALLS_... */
    int32_t beside;            /* 1: centres around the places are looked at too */
    int32_t parts;             /* 1: walls may stand on faces of other parts, which go on in them */
    int32_t unsummed;          /* 1: beyond is not wanted */

    double unit;      /* the largest spacing */
    double beyond[3]; /* of bvxi_lost_surface [Units: voxels] */

    /* walls further from the centre than this are not looked at [Units: largest spacings] */
    double limit;
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

/* The triangles of a mesh that may lie within reach of the set centres of places, in their order: all that do, and
 * some more. with_area: 1 leaves out those without. near is a view of *corner, scratch of the caller's to drop
 * [Size: triangles * 3]. reach: [Units: world] */
bvx_status bvxi_triangles_near(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *places,
                               double reach, int32_t with_area, bvx_mesh_view *near, uint32_t **corner);

/* The triangles of a mesh that a search among those around the places needs, as bvxi_triangles_near gives them. */
bvx_status bvxi_walls_around(const bvxi_walls *t, const bvx_mesh_view *mesh, bvx_mesh_view *near,
                             uint32_t **corner);

/* Mark the places where the lattice may lose the surface; list them; take the
 * triangles around them and make a search of these (near has none where there
 * are none); look at all that are listed. bvxi_walls_gather is all but the last (count is 0
 * where there is nothing to ask). */
bvx_status bvxi_walls_mark(bvxi_walls *t);
bvx_status bvxi_walls_list(bvxi_walls *t);
bvx_status bvxi_walls_near(bvxi_walls *t);
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
