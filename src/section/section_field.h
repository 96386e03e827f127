/* section_field.h - the field over one slab: distances at grid points of both planes, the surface's crossings of the lines between them.
 *
 * Levels are the planes from cell to cell: level 0 is the plane below, level layers the one above, those between are blends. */
#ifndef BVXI_SECTION_FIELD_H
#define BVXI_SECTION_FIELD_H

#include "section/slab.h"

/* Vertices by a key; a lookup alone, so the order of keys does not matter. */
typedef struct bvxi_vertex_map {
    uint64_t *key;       /* UINT64_MAX: free */
    uint32_t *vertex;
    uint32_t room, count;
} bvxi_vertex_map;

/* Distances of one plane's grid points, computed when asked for. */
typedef struct bvxi_plane_field {
    const bvxi_plane *plane;
    double *distance;
    uint64_t *known;     /* a bit a grid point */
    uint32_t hint;
} bvxi_plane_field;

typedef struct bvxi_field {
    bvxi_stack *s;
    bvxi_slab *slab;
    int32_t layers;
    bvxi_plane_field plane[2];
    uint32_t *vertex;        /* over each grid point: where the surface crosses the line to the plane above */
    uint8_t *layer;          /* and between which levels; layers > 1 */
    uint64_t *crossed;       /* grid points whose line is crossed */
} bvxi_field;

bvx_status bvxi_field_open(bvxi_stack *s, bvxi_field *f);
void bvxi_field_close(bvxi_field *f);
/* Go to a slab: crossings of its lines become vertices. */
bvx_status bvxi_field_set(bvxi_field *f, bvxi_slab *slab);
/* The blended field at a place: t 0 is the plane below, 1 the one above. */
double bvxi_field_at(bvxi_field *f, double u, double v, double t);
/* Signed distances at a point of the grid or a corner of a cell on plane k, its side given. */
double bvxi_field_corner(bvxi_field *f, const int32_t at[2], int k, int inside);
double bvxi_fixed_u(const bvxi_stack *s, int axis, int32_t q);

bvx_status bvxi_map_find(bvxi_stack *s, bvxi_vertex_map *map, uint64_t key, uint32_t **vertex);
void bvxi_map_clear(bvxi_vertex_map *map);
void bvxi_map_free(bvxi_stack *s, bvxi_vertex_map *map);

#endif
