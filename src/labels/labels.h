/* labels.h - cells of a label map split into vertices, and what the steps of bvx_label_surfaces share. Not
 * installed.
 *
 * A cell lies between eight centres. Bit e of its pattern is set where lattice edge e has different labels at its
 * ends: edges 0..3 run along x, 4..7 along y, 8..11 along z, each four by the offsets of the two other axes, in
 * the order x, y, z, the first one fastest. Sides are -x, +x, -y, +y, -z, +z. */
#ifndef BVXI_LABELS_H
#define BVXI_LABELS_H

#include "core/core.h"

enum { BVXI_PATTERNS = 4096, BVXI_SPLITS = 5506 };

/* Offsets of vertices are in parts of a voxel; the limit is 0.49 voxels, within a seam 0.24. */
enum { BVXI_NET_UNITS = 65536, BVXI_NET_LIMIT = 32112, BVXI_SEAM_LIMIT = 15728, BVXI_NET_FLAP = 3 };

/* What leads through a side whose four edges have different ends: none of its labels, that of the voxels with
 * offsets 0, 0 and 1, 1, or that of the other two. */
enum { BVXI_ACROSS_NONE, BVXI_ACROSS_SAME, BVXI_ACROSS_MIXED };

/* A vertex that two edges of a cell have for themselves, one of the two, and the sides beyond which the flap's second
 * and fourth corner are where the edge's low end has the lower label. */
typedef struct bvxi_cell_flap {
    uint8_t vertex, edge, side[2];
} bvxi_cell_flap;

/* The vertices of a pattern: edges that are joined in a side of the cell share one. */
typedef struct bvxi_cell_split {
    uint8_t count, of[12]; /* vertex of each edge */
    uint8_t base[12];      /* the same as if there were no flaps */
    uint8_t flaps;
    bvxi_cell_flap flap[3];
    uint8_t junction[7]; /* as in bvx_complex */
    int16_t
        start[7]
             [3]; /* mean of the edges' middles, from the cell's centre [Units: BVXI_NET_UNITS of a voxel] */
} bvxi_cell_split;

void bvxi_split_pattern(uint32_t pattern, const uint8_t across[6], bvxi_cell_split *split);
/* The sides with four edges as bits, or UINT32_MAX where no labels have the pattern. */
uint32_t bvxi_four_sides(uint32_t pattern);

/* The offset of edge e along an axis that is not its own. */
static inline int32_t bvxi_edge_offset(int32_t e, int32_t axis)
{
    int32_t const own = e >> 2, first = own == 0 ? 1 : 0;
    return axis == first ? e & 1 : e >> 1 & 1;
}

/* The corners of a face in their order, of which the first and the third of four are on its diagonal. */
static inline uint32_t bvxi_face_vertex(const bvx_complex *complex, uint32_t face, int32_t place)
{
    static const uint8_t at[4] = {0, 1, 2, 5};
    if (complex->single) return complex->mesh.triangles[3 * (size_t)face + (size_t)place % 3];
    return complex->mesh.triangles[6 * (size_t)face + at[place & 3]];
}

/* The place of the corner in the highest of the four cells: the next corner and the last lie one cell before it. */
static inline int32_t bvxi_face_owner(const bvx_complex *complex, uint32_t face)
{
    const uint64_t *const cells = complex->cells;
    return cells[bvxi_face_vertex(complex, face, 0)] > cells[bvxi_face_vertex(complex, face, 3)] ? 0 : 3;
}

/* The cell that holds a vertex. */
static inline void bvxi_cell_of(const bvx_complex *complex, uint64_t vertex, uint64_t cell[3])
{
    uint64_t const row = (uint64_t)complex->size[0] + 1, rows = (uint64_t)complex->size[1] + 1;
    cell[0] = complex->cells[vertex] % row;
    cell[1] = complex->cells[vertex] / row % rows;
    cell[2] = complex->cells[vertex] / row / rows;
}

/* What smoothing needs of vertices. A link is the vertex beyond a side of the cell, or UINT32_MAX; along x,
 * where that comes next, the distance to it, or 0. */
typedef struct bvxi_net {
    bvx_complex *complex;
    int16_t *offset; /* from the cell's centre [Size: vertices * 3] [Units: BVXI_NET_UNITS of a voxel] */
    uint64_t flaps;  /* index of the first one; they are the last faces */
    uint8_t *beside; /* [Size: vertices * 2] */
    uint32_t *links; /* of sides -y, +y, -z [Size: vertices * 3] */
    uint32_t *above; /* of side +z [Size: vertices] */
    double origin[3], spacing[3]; /* of positions: origin 0 in a local frame */
    uint64_t first[3], last[3];   /* cells with vertices */
    int32_t seam[6];              /* 1: those of this side are the neighbouring window's too */
} bvxi_net;

/* Axes, as bits, of the seams that a cell is in. */
static inline uint32_t bvxi_net_seams(const bvxi_net *net, const uint64_t cell[3])
{
    uint32_t seams = 0;
    for (uint32_t a = 0; a < 3; a++)
        if ((net->seam[2 * a] && cell[a] == net->first[a]) ||
            (net->seam[2 * a + 1] && cell[a] == net->last[a]))
            seams |= UINT32_C(1) << a;
    return seams;
}

/* Whether others are in the vertex's cell. */
static inline int bvxi_shares_cell(const bvx_complex *c, uint64_t vertex)
{
    return (vertex > 0 && c->cells[vertex - 1] == c->cells[vertex]) ||
           (vertex + 1 < c->mesh.vertex_count && c->cells[vertex + 1] == c->cells[vertex]);
}

static inline uint32_t bvxi_net_link(const bvxi_net *net, uint64_t vertex, int32_t side)
{
    if (side == 5) return net->above[vertex];
    if (side >= 2) return net->links[3 * vertex + (uint64_t)side - 2];
    uint64_t const way = net->beside[2 * vertex + (uint64_t)side];
    return way == 0 ? UINT32_MAX : (uint32_t)(side == 0 ? vertex - way : vertex + way);
}

static inline void bvxi_net_set_link(const bvxi_net *net, uint32_t vertex, int32_t side, uint32_t to)
{
    if (side == 5) net->above[vertex] = to;
    else if (side >= 2) net->links[3 * (size_t)vertex + (size_t)side - 2] = to;
    else net->beside[2 * (size_t)vertex + (size_t)side] = (uint8_t)(side == 0 ? vertex - to : to - vertex);
}

/* The axis of the lattice edge that a face lies around, BVXI_NET_FLAP of a flap: the cells of two corners across from
 * each other differ by a step along either other axis. */
static inline uint32_t bvxi_net_axis(const bvxi_net *net, uint32_t face)
{
    const uint64_t *const cells = net->complex->cells;
    const uint32_t *const t = net->complex->mesh.triangles + 6 * (size_t)face;
    int const first = t[0] > t[5];
    uint64_t const high = cells[t[first ? 0 : 5]], low = cells[t[first ? 2 : 1]];
    uint64_t const row = (uint64_t)net->complex->size[0] + 1,
                   slice = row * ((uint64_t)net->complex->size[1] + 1);

    if (face >= net->flaps) return BVXI_NET_FLAP;
    return high - low == row + 1 ? 2 : high - low == slice + 1 ? 1 : 0;
}

/* A face in axes of its own: on the staircase its corners are at 0, (1, 0), (1, 1) and (0, 1), those of a flap at 0,
 * (1, 0), 0 and (0, 1). The third is along its lattice edge, so that they are right-handed. */
typedef struct bvxi_face {
    uint32_t vertex[4], axis[3]; /* which they are */
    int32_t sign[3], square;     /* 0: a flap */
    int32_t moved[4][3];         /* from the staircase [Units: BVXI_NET_UNITS of a voxel] */
} bvxi_face;

static inline void bvxi_read_face(const bvxi_net *net, uint32_t face, uint32_t axis, bvxi_face *f)
{
    const bvx_complex *const c = net->complex;
    const uint32_t *const t = c->mesh.triangles + 6 * (size_t)face;

    for (int32_t n = 0; n < 4; n++) f->vertex[n] = t[n == 3 ? 5 : n];
    f->square = axis != BVXI_NET_FLAP;
    if (f->square) {
        /* Vertices are in the order of their cells, so the neighbour along the lower axis comes later. */
        uint32_t const low = axis == 0, first = t[0] > t[5];
        uint32_t const forward = (first ? t[1] : t[0]) > (first ? t[5] : t[2]);
        f->axis[0] = first == forward ? low : 3 - axis - low;
        f->axis[1] = 3 - axis - f->axis[0];
        f->sign[0] = -1;
        f->sign[1] = first ? -1 : 1;
    } else
        for (int32_t n = 0; n < 2; n++) {
            uint64_t const own = c->cells[t[0]], other = c->cells[f->vertex[1 + 2 * n]];
            uint64_t const to = own > other ? own - other : other - own;
            f->axis[n] = to == 1 ? 0 : to == (uint64_t)c->size[0] + 1 ? 1 : 2;
            f->sign[n] = own > other ? -1 : 1;
        }
    f->axis[2] = 3 - f->axis[0] - f->axis[1];
    f->sign[2] = (f->axis[0] + 1 == f->axis[1] || f->axis[0] == f->axis[1] + 2) ? f->sign[0] * f->sign[1]
                                                                                : -f->sign[0] * f->sign[1];
    for (int32_t n = 0; n < 4; n++)
        for (int32_t a = 0; a < 3; a++)
            f->moved[n][a] = f->sign[a] * net->offset[3 * (size_t)f->vertex[n] + f->axis[a]];
}

/* Where a corner is from the first of the staircase. */
static inline int32_t bvxi_corner(const bvxi_face *f, int32_t n, int32_t a)
{
    int32_t const at = a == 2 ? 0 : n == 2 ? f->square : n == 1 + 2 * a;
    return f->moved[n][a] + at * BVXI_NET_UNITS;
}

/* smooth.c: write the position of a vertex; without offsets it is at its cell's centre. */
void bvxi_net_put(const bvxi_net *net, uint64_t vertex);
/* Move the offsets; the links are freed. Memory: 6 bytes a vertex; 8 a face, label and pair. */
bvx_status bvxi_net_smooth(bvx_context *ctx, bvxi_net *net);
/* untangle.c: move offsets back until no two triangles cross, and write their positions; the others are written.
 * Memory: 5 bytes a vertex, 1 a face, and what bvx_mesh_crossings takes of those near a face that leaves its
 * envelope. */
bvx_status bvxi_net_untangle(bvx_context *ctx, bvxi_net *net);

#endif
