/* cell_loops.c - the closed loops in which the surface leaves a cell, read off the cell's triangles.
 *
 * An edge of a triangle that no other triangle of the cell has lies on a face of the cell; these edges make
 * the loops. Guarantee: each cut edge of a cell belongs to one loop, and loops come in the order of their
 * first triangles. */
#include "surface/sharp.h"

/* The cell's edge that a triangle corner of tables.h stands on. Lanes 0 to 3 are the x-edges themselves;
 * lanes 4 and 5 count crossed y-edges, 6 and 7 crossed z-edges, of which a cell has one at its low-x side and
 * one at its high-x side. */
static uint8_t edge_of_corner(uint32_t cell_case, uint8_t corner)
{
    uint8_t const lane = corner & 7, offset = corner >> 3;
    int const along_y = lane < 6, second_row = lane & 1;
    if (lane < 4) return lane;
    /* The two ends of the lane's edge at the low-x side, as corners x + 2y + 4z. */
    uint32_t const low = !second_row ? 0 : along_y ? 4 : 2;
    uint32_t const high = low + (along_y ? 2 : 4);
    uint8_t const first = (uint8_t)(along_y ? 4 + 2 * (lane - 4) : 8 + 2 * (lane - 6));
    /* A lane's counter stands at its next crossing: that at high x when the first edge is not cut. */
    int const first_is_cut = (cell_case >> low & 1) != (cell_case >> high & 1);
    return offset != 0 || !first_is_cut ? (uint8_t)(first + 1) : first;
}

void bvxi_trace_cell(int32_t face_rule, uint32_t cell_case, const uint32_t *triangles, bvxi_cell_loops *loops)
{
    uint32_t const count = bvxi_cell_triangle_count[face_rule][cell_case];
    const uint8_t *const corner = bvxi_cell_triangle[face_rule][cell_case];
    uint8_t edge[BVXI_CELL_ROW], next[BVXI_CELL_EDGES] = {0}, seen[BVXI_CELL_EDGES] = {0};
    uint32_t vertex[BVXI_CELL_EDGES] = {0};
    uint16_t out[BVXI_CELL_EDGES] = {0}; /* bit v of out[u]: a triangle has an edge from u to v */

    for (uint32_t i = 0; i < 3 * count; i++) {
        edge[i] = edge_of_corner(cell_case, corner[i]);
        vertex[edge[i]] = triangles[i];
    }
    for (uint32_t i = 0; i < 3 * count; i++)
        out[edge[i]] = (uint16_t)(out[edge[i]] | 1u << edge[i % 3 == 2 ? i - 2 : i + 1]);

    /* What runs one way only lies on the loop; edges inside are there both ways. */
    for (int u = 0; u < BVXI_CELL_EDGES; u++)
        for (int v = 0; v < BVXI_CELL_EDGES; v++)
            if ((out[u] >> v & 1) != 0 && (out[v] >> u & 1) == 0) next[u] = (uint8_t)v;

    /* Triangles of one loop stand together in the tables: one that is not of the last loop begins another. */
    loops->count = 0;
    for (uint32_t t = 0; t < count; t++) {
        uint8_t u = edge[3 * t];

        if (seen[u]) {
            loops->loop[loops->count - 1].triangles++;
            continue;
        }
        bvxi_cell_loop *const l = &loops->loop[loops->count++];
        l->first = t;
        l->triangles = 1;
        l->corners = 0;

        for (; !seen[u]; u = next[u]) {
            seen[u] = 1;
            l->edge[l->corners] = u;
            l->vertex[l->corners++] = vertex[u];
        }
    }
}

/* Bit 2 axis + side for the two faces at an edge. */
static uint32_t faces_of_edge(uint8_t edge)
{
    uint32_t const first = edge & 1, second = edge >> 1 & 1;
    switch (edge >> 2) {
    case 0: return 4u << first | 16u << second;
    case 1: return 1u << first | 16u << second;
    default: return 1u << first | 4u << second;
    }
}

int32_t bvxi_face_of_edges(uint8_t one, uint8_t two)
{
    return bvxi_lowest((uint64_t)(faces_of_edge(one) & faces_of_edge(two)));
}

int bvxi_face_is_cut_twice(uint32_t cell_case, int32_t face)
{
    uint32_t const axis = (uint32_t)face >> 1, u = 1u << (axis + 1) % 3, v = 1u << (axis + 2) % 3;
    /* Its four corners; where both diagonals agree and differ from each other, all sides are cut. */
    uint32_t const base = ((uint32_t)face & 1) << axis;
    uint32_t const a = cell_case >> base & 1, b = cell_case >> (base + u) & 1;
    uint32_t const c = cell_case >> (base + v) & 1, d = cell_case >> (base + u + v) & 1;
    return a == d && b == c && a != b;
}
