/* mesh_components.c - the parts of a mesh that hang together through vertices.
 *
 * Source: Tarjan. Efficiency of a Good But Not Linear Set Union Algorithm. 1975; here the root of a part is
 * its least vertex, and paths are halved on every look. Guarantee: the answer follows from the mesh only. */
#include "mesh/topology.h"
#include "mesh/view.h"

static uint32_t root_of_piece(uint32_t *piece, uint32_t v)
{
    while (piece[v] != v) {
        piece[v] = piece[piece[v]];
        v = piece[v];
    }
    return v;
}

static void join_pieces(uint32_t *piece, uint32_t a, uint32_t b)
{
    a = root_of_piece(piece, a);
    b = root_of_piece(piece, b);
    if (a < b) piece[b] = a;
    else piece[a] = b;
}

void bvxi_pieces(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *piece)
{
    uint32_t c[3];

    for (uint64_t v = 0; v < view->vertex_count; v++) piece[v] = representative[v];
    /* The least vertex of a part is its root, so the answer does not depend on the order of triangles. */
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        bvxi_view_triangle(view, t, c);
        join_pieces(piece, c[0], c[1]);
        join_pieces(piece, c[0], c[2]);
    }
    for (uint64_t v = 0; v < view->vertex_count; v++) piece[v] = root_of_piece(piece, (uint32_t)v);
}
