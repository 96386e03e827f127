/* touch_cells.h - which of 2 x 2 x 2 voxels about a lattice point, or of 3 x 3 x 3, a triangle misses: for
 * small triangles, some hundred at a time. Loops without branches, in doubles that hold every number
 * exactly. Not installed. */
#ifndef BVXI_TOUCH_CELLS_H
#define BVXI_TOUCH_CELLS_H

#include "core/core.h"
#include "touch/surface_voxels.h"

/* ---- Which of the two by two by two voxels about a lattice point ---- */

/* Voxels are bits: octants s_x + 2 s_y + 4 s_z, cells x + 3 y + 9 z. The triangle's box reaches all of them
 * along the axes that are looked at, so the projections and the plane alone decide. The edges of a projection
 * without area run to and fro, so they bound it on both sides.
 *
 * Octants. Corners are relative to the point, within 2^16. The triangle lies within the eight voxels, so an
 * octant may be taken as endless: an edge misses it when it has the point outside and no way into the octant
 * leads inside. Cells. Corners are relative to the middle of the middle cell, within 1.5 * 2^16, the cube's
 * side being S = 3 * 2^16. Components of the normal are below S^2, products with corners below S^3 / 2, a sum
 * of two at most S^3 < 2^53, and the sum of three is a determinant of numbers up to S / 2: below S^3 / 2.
 * What is added from cell to cell is a multiple of 2^F below S^3 and exact; the last sum may be rounded,
 * which leaves its sign. */

/* Voxels in the halves and thirds along x, y, z. */
static const int64_t bvxi_octant_half[3][2] = {{0x55, 0xaa}, {0x33, 0xcc}, {0x0f, 0xf0}};
static const int64_t bvxi_cell_third[3][3] = {
    {0x1249249, 0x2492492, 0x4924924}, {0x01c0e07, 0x0e07038, 0x70381c0}, {0x00001ff, 0x003fe00, 0x7fc0000}};

/* Octants that an edge (au, av) -> (bu, bv) of a projection leaves outside;
 * turn is +1 or -1, the sign of the area. */
BVXI_VECTOR_INLINE int64_t bvxi_edge_octants(double au, double av, double bu, double bv, double turn,
                                             const int64_t half_u[2], const int64_t half_v[2])
{
    /* The edge's value at the point, and its slopes; turn makes the inside positive. */
    double const at = (au * bv - av * bu) * turn, du = (av - bv) * turn, dv = (bu - au) * turn;
    int64_t const u = (du > 0 ? 0 : half_u[1]) | (du < 0 ? 0 : half_u[0]);
    int64_t const v = (dv > 0 ? 0 : half_v[1]) | (dv < 0 ? 0 : half_v[0]);
    return at < 0 ? u & v : 0;
}

/* Octants that the projection of a triangle onto axes u, v misses. */
BVXI_VECTOR_INLINE int64_t bvxi_projection_octants(const double a[3], const double b[3], const double c[3],
                                                   int u, int v)
{
    /* The two ways round of a projection differ in the sign of all edges. */
    double const area = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    double const turn = area < 0 ? -1.0 : 1.0;
    const int64_t *const half_u = bvxi_octant_half[u], *const half_v = bvxi_octant_half[v];
    return bvxi_edge_octants(a[u], a[v], b[u], b[v], turn, half_u, half_v) |
           bvxi_edge_octants(b[u], b[v], c[u], c[v], turn, half_u, half_v) |
           bvxi_edge_octants(c[u], c[v], a[u], a[v], turn, half_u, half_v);
}

/* Octants that the plane misses: on its positive side those along which all
 * slopes grow, else the opposite ones. */
BVXI_VECTOR_INLINE int64_t bvxi_plane_octants(const double a[3], const double b[3], const double c[3])
{
    double const nx = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
    double const ny = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
    double const nz = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);

    /* The plane's value at the point: an octant into which
     * the value only grows is missed on the positive side. */
    double const at = -(nx * a[0] + ny * a[1] + nz * a[2]);
    int64_t const up = ((nx > 0 ? 0 : 0x55) | (nx < 0 ? 0 : 0xaa)) &
                       ((ny > 0 ? 0 : 0x33) | (ny < 0 ? 0 : 0xcc)) &
                       ((nz > 0 ? 0 : 0x0f) | (nz < 0 ? 0 : 0xf0));
    int64_t const down = ((nx < 0 ? 0 : 0x55) | (nx > 0 ? 0 : 0xaa)) &
                         ((ny < 0 ? 0 : 0x33) | (ny > 0 ? 0 : 0xcc)) &
                         ((nz < 0 ? 0 : 0x0f) | (nz > 0 ? 0 : 0xf0));
    return (at > 0 ? up : 0) | (at < 0 ? down : 0);
}

/* An edge's value at the best corner of each cell of the middle column, and from column to column. */
typedef struct bvxi_cell_edge {
    double row[3], step;
} bvxi_cell_edge;

BVXI_VECTOR_INLINE bvxi_cell_edge bvxi_cell_edge_of(double au, double av, double bu, double bv, double turn,
                                                    double side)
{
    double const du = (av - bv) * turn * side, dv = (bu - au) * turn * side;
    bvxi_cell_edge e;
    /* The value in the middle of the middle cell, raised by the way to its best corner. */
    e.row[1] = (au * bv - av * bu) * turn + 0.5 * ((du < 0 ? -du : du) + (dv < 0 ? -dv : dv));
    e.row[0] = e.row[1] - dv;
    e.row[2] = e.row[1] + dv;
    e.step = du;
    return e;
}

/* Cells that the projection of a triangle onto axes u, v misses; side is 2^F. */
BVXI_VECTOR_INLINE int64_t bvxi_projection_cells(const double a[3], const double b[3], const double c[3],
                                                 int u, int v, double side)
{
    double const area = (b[u] - a[u]) * (c[v] - a[v]) - (b[v] - a[v]) * (c[u] - a[u]);
    double const turn = area < 0 ? -1.0 : 1.0;
    bvxi_cell_edge const ab = bvxi_cell_edge_of(a[u], a[v], b[u], b[v], turn, side);
    bvxi_cell_edge const bc = bvxi_cell_edge_of(b[u], b[v], c[u], c[v], turn, side);
    bvxi_cell_edge const ca = bvxi_cell_edge_of(c[u], c[v], a[u], a[v], turn, side);
    int64_t missed = 0;

    /* Three edges at once: the least value decides, and a cell that any edge has outside is missed. */
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) {
            double const n = i - 1;
            double const x = ab.row[j] + n * ab.step;
            double const y = bc.row[j] + n * bc.step;
            double const z = ca.row[j] + n * ca.step;
            double const xy = x < y ? x : y, least = xy < z ? xy : z;
            missed |= least < 0 ? bvxi_cell_third[u][i] & bvxi_cell_third[v][j] : 0;
        }
    return missed;
}

/* Cells of a layer z that the plane misses: its value in the cell's middle is larger than what it changes
 * from there to a corner. across: how far the value has changed from layer to layer. */
BVXI_VECTOR_INLINE int64_t bvxi_plane_layer(double at, double sx, double sy, double across, double reach,
                                            int k)
{
    int64_t missed = 0;
    /* The reach is what the value changes from a cell's
     * middle to its corner: beyond it, the plane is missed. */
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) {
            double const value = at + ((double)(i - 1) * sx + (double)(j - 1) * sy + across);
            missed |= (value < 0 ? -value : value) > reach ? (int64_t)1 << (i + 3 * j + 9 * k) : 0;
        }
    return missed;
}

BVXI_VECTOR_INLINE int64_t bvxi_plane_cells(const double a[3], const double b[3], const double c[3],
                                            double side)
{
    double const nx = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]);
    double const ny = (b[2] - a[2]) * (c[0] - a[0]) - (b[0] - a[0]) * (c[2] - a[2]);
    double const nz = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    /* The value at the middle, what it changes from cell to cell, and half of all three changes. */
    double const at = -(nx * a[0] + ny * a[1] + nz * a[2]), sx = nx * side, sy = ny * side, sz = nz * side;
    double const reach = 0.5 * ((sx < 0 ? -sx : sx) + (sy < 0 ? -sy : sy) + (sz < 0 ? -sz : sz));
    return bvxi_plane_layer(at, sx, sy, -sz, reach, 0) | bvxi_plane_layer(at, sx, sy, 0.0, reach, 1) |
           bvxi_plane_layer(at, sx, sy, sz, reach, 2);
}

/* ---- Triangles taken some hundred at a time: their corners and boxes as arrays ---- */

enum { BVXI_TOUCH_BATCH = 128 };

typedef struct bvxi_touch_batch {
    uint32_t triangle[BVXI_TOUCH_BATCH];
    /* corner, axis: relative to the window's low corner */
    int32_t p[3][3][BVXI_TOUCH_BATCH];
    /* of the box, not cut to the window [Units: voxels] */
    int32_t low[3][BVXI_TOUCH_BATCH], high[3][BVXI_TOUCH_BATCH];
} bvxi_touch_batch;

/* Take triangles done .. done + n of those that a tile gets. */
BVXI_VECTOR_INLINE void bvxi_batch_gather(const bvxi_surface_job *job, const uint32_t *id, uint64_t done,
                                          uint32_t n, bvxi_touch_batch *b)
{
    const int32_t *const xyz = job->snapped.xyz;
    int32_t const shift = job->fraction_bits;
    int32_t const ox = job->low[0] * (1 << shift);
    int32_t const oy = job->low[1] * (1 << shift);
    int32_t const oz = job->low[2] * (1 << shift);
    int const packed = bvxi_view_packed_u32(job->view);

    /* Packed indices are copied; others go through the getter, which knows all types. */
    for (uint32_t i = 0; i < n; i++) {
        uint32_t corner[3];
        uint32_t const t = id != NULL ? id[done + i] : job->first + (uint32_t)(done + i);
        b->triangle[i] = t;
        if (packed) memcpy(corner, (const unsigned char *)job->view->indices + (size_t)t * 12, sizeof corner);
        else bvxi_view_triangle(job->view, t, corner);
        for (int c = 0; c < 3; c++) {
            const int32_t *const v = xyz + 3 * (size_t)corner[c];
            b->p[c][0][i] = v[0] - ox;
            b->p[c][1][i] = v[1] - oy;
            b->p[c][2][i] = v[2] - oz;
        }
    }
}

/* low = floor((least + below) / 2^F), high = floor((greatest + above) / 2^F), along each axis. */
BVXI_VECTOR_INLINE void bvxi_batch_boxes(bvxi_touch_batch *b, uint32_t n, int32_t f, int32_t below,
                                         int32_t above)
{
    for (int a = 0; a < 3; a++) {
        const int32_t *BVXI_RESTRICT const p = b->p[0][a], *BVXI_RESTRICT const q = b->p[1][a],
                                           *BVXI_RESTRICT const r = b->p[2][a];
        int32_t *BVXI_RESTRICT const low = b->low[a], *BVXI_RESTRICT const high = b->high[a];
        for (uint32_t i = 0; i < n; i++) {
            int32_t const pq = p[i] < q[i] ? p[i] : q[i], PQ = p[i] < q[i] ? q[i] : p[i];
            int32_t const least = (pq < r[i] ? pq : r[i]) + below, most = (PQ > r[i] ? PQ : r[i]) + above;
            /* The shift of a negative number is not defined in C; its complement is not negative. */
            low[i] = least < 0 ? ~(~least >> f) : least >> f;
            high[i] = most < 0 ? ~(~most >> f) : most >> f;
        }
    }
}

#endif
