/* topology.h - how a mesh hangs together: vertices at one position, edges and fans, parts, triangles that
 * are there twice, the sense of neighbours, sharp edges. One call each; all of them take indices that were
 * checked. Not installed. */
#ifndef BVXI_TOPOLOGY_H
#define BVXI_TOPOLOGY_H

#include "core/core.h"

/* ---- Vertices at equal positions ---- */

/* representative[v] becomes the least number of a vertex at the position of v; -0 equals 0. *different counts
 * the positions. Progress is reported every so many vertices. The view is checked and its coordinates are
 * finite. representative [Size: vertex_count]. Scratch: 6 bytes a vertex, 8 where hashes collide on
 * purpose. */
bvx_status bvxi_weld(bvx_context *ctx, const bvx_mesh_view *view, uint32_t *representative,
                     uint64_t *different);

/* A checked mesh of which this is known. */
typedef struct bvxi_welded {
    const bvx_mesh_view *view;
    double low[3], high[3]; /* bounds of its triangles */
    const uint32_t *representative;
    uint64_t different;
} bvxi_welded;

/* ---- Edges, fans and pieces of indexed triangles ---- */

/* Fill the counts and flags of a certificate that do not require positions, zero before: all but triangles,
 * collapsed, degenerate, area, volume and bounds, which stay as they are.
 * corners [Size: triangle_count * 3], numbers below vertex_count, three different ones a triangle,
 * triangle_count below 2^32 / 3. edges_alone: 1: vertices, pieces and what follows from them are left out.
 * Progress is reported from 0.4 of "check" on.
 * Scratch: 40.4 bytes a triangle and 8.3 a vertex. */
bvx_status bvxi_topology(bvx_context *ctx, const uint32_t *corners, uint64_t triangle_count,
                         uint64_t vertex_count, int edges_alone, bvx_certificate *certificate);

/* check.c: what bvx_mesh_check tells of a welded mesh; edges_alone as above. */
bvx_status bvxi_check_welded(bvx_context *ctx, const char *function, const bvxi_welded *mesh, int edges_alone,
                             bvx_certificate *certificate);

/* ---- Has a mesh sharp edges, as machine parts have? ---- */

/* *sharp becomes 1 where many edges are sharp, or some are and few are merely bent. Large meshes are scans: 0
 * without a look. representative: vertices at one place (topology.h), NULL: they are found first. The view is
 * checked, its indices too. Scratch: 36 bytes a triangle and 4 a vertex. */
bvx_status bvxi_sharp_edges(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                            int32_t *sharp);

/* ---- The parts of a mesh that hang together, and triangles that are there twice ---- */

/* Join vertices by triangles: piece[v] becomes the least vertex that v
 * hangs together with. representative: vertices at one place (topology.h). The
 * view is checked, its indices too. piece [Size: vertex_count]. No memory. */
void bvxi_pieces(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *piece);

/* List the corners of all triangles but those with two corners at one
 * place; returns how many. corner [Size: triangle_count * 3]. */
uint64_t bvxi_drop_collapsed(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *corner);

/* List the corners of all triangles but those whose three places an earlier one has, in any order, and those
 * with two corners at one place. corner [Size: triangle_count * 3]; *kept is how many. Scratch: 6 bytes a
 * triangle, 8 where hashes collide on purpose. */
bvx_status bvxi_drop_duplicates(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                                uint32_t *corner, uint64_t *kept);

/* ---- Which triangles of a mesh run the other way round than those beside them ---- */

/* A patch hangs together through edges of two triangles, a part through edges of any number. Triangles with
 * two corners at one position belong to none, and are patches and parts of their own here. */
typedef struct bvxi_patches {
    uint32_t *part; /* of each triangle: the least one of its part [Size: triangles] */
    uint8_t *turn;  /* by triangle, 1: it is turned round [Size: triangles] */
    uint8_t *
        open; /* by a part's least triangle, 1: after turning an edge of the part is open [Size: triangles] */
    uint64_t triangles;
    uint64_t turned;       /* triangles that are */
    uint64_t unorientable; /* patches whose triangles no turning makes run the same way round */
    uint64_t odd_edges;    /* edges with an odd number of triangles */
    /* after turning: by how many more triangles run along edges one way than the other */
    uint64_t open_edges;
    /* after turning: those of three triangles or more, or of two that run along them the same way */
    uint64_t refused_edges;
    uint32_t refused[2]; /* the first one's corners */
} bvxi_patches;

/* The root of a triangle in link, where each has a triangle << 1 | 1 when the two run differently, and a root itself;
 * *differs: whether it runs differently from its root. Paths are halved. */
uint32_t bvxi_link_root(uint32_t *link, uint32_t t, uint32_t *differs);

/* Find what to turn so that the triangles of each patch run the same way round, as most of them do. Where no
 * side has five eighths of them, the volume that they enclose about centre becomes positive. Of an open mesh,
 * open patches that face inward where others face outward are turned whole (patch_sides.c); chance: the triangles
 * are those of two that face either way, so that parity alone says which patches are right. representative:
 * topology.h. The view's indices have been checked. Scratch: beside the result 105 bytes a triangle, while
 * it works; of an open mesh of several patches up to 1 MB more.
 * Cost: O(triangles). Guarantee: what is turned follows from the triangles; for a patch of halves that
 * encloses nothing from sums in their order. */
bvx_status bvxi_patches_open(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                             const double centre[3], int chance, bvxi_patches *patches);
void bvxi_patches_close(bvx_context *ctx, bvxi_patches *patches);

/* The triangles, those of patches->turn turned round. index [Size: triangles * 3] */
void bvxi_patches_turn(const bvx_mesh_view *view, const bvxi_patches *patches, uint32_t *index,
                       bvx_mesh_view *turned);

/* patch_sides.c: what patches know of themselves when whole ones are judged. */
typedef struct bvxi_patch_sides {
    const bvx_mesh_view *view;
    const double *centre;
    const uint32_t *corner, *patch; /* of each triangle: its corners' representatives, its patch's number */
    uint64_t triangles, patches;
    const uint32_t *border; /* half-edges that are no edge of two triangles: 3 t + k, from corner k on */
    uint64_t border_count;
    int chance;    /* 1: which way a patch faces says nothing of what it should */
    uint8_t *turn; /* in: triangles that are turned; out: those of turned patches changed */
} bvxi_patch_sides;

bvx_status bvxi_patch_sides_turn(bvx_context *ctx, const bvxi_patch_sides *in);

/* Six times the volume of triangle t about centre, positive where it is
 * seen from outside, as it stands in the view. */
double bvxi_patches_volume(const bvx_mesh_view *view, uint64_t t, const double centre[3]);

#endif
