/* split_cells.c - the vertices of a cell by its pattern (labels.h).
 *
 * In a side of a cell none, two, three or four edges have different ends, never one; all that do are joined. So at
 * most one edge of the complex runs through a side, whatever the labels are, and neighbouring cells agree without
 * asking for them. */
#include "labels/labels.h"

void bvxi_split_pattern(uint32_t pattern, bvxi_cell_split *split)
{
    uint32_t parent[12];
    int32_t edges[4] = {0};

    memset(split, 0, sizeof *split);
    for (uint32_t e = 0; e < 12; e++) parent[e] = e;

    /* Edges of one side are joined. */
    for (int32_t side = 0; side < 6; side++) {
        int32_t first = -1;
        for (int32_t e = 0; e < 12; e++) {
            if ((pattern >> e & 1) == 0 || e >> 2 == side >> 1 ||
                bvxi_edge_offset(e, side >> 1) != (side & 1))
                continue;
            if (first >= 0) bvxi_join(parent, (uint32_t)first, (uint32_t)e);
            first = e;
        }
    }

    /* Roots are the lowest edges, so vertices are in the order of theirs. */
    for (uint32_t e = 0; e < 12; e++) {
        if ((pattern >> e & 1) == 0) continue;
        uint32_t const root = bvxi_root(parent, e);
        if (root == e) split->of[e] = split->count++;
        else split->of[e] = split->of[root];
        int32_t const v = split->of[e];
        edges[v]++;
        for (int32_t a = 0; a < 3; a++)
            if (a != (int32_t)e >> 2) split->start[v][a] += (float)bvxi_edge_offset((int32_t)e, a) - 0.5F;
    }
    for (int32_t v = 0; v < split->count; v++)
        for (int32_t a = 0; a < 3; a++) split->start[v][a] /= (float)edges[v];

    for (int32_t side = 0; side < 6; side++) {
        int32_t met = 0, v = 0;
        for (int32_t e = 0; e < 12; e++) {
            if ((pattern >> e & 1) == 0 || e >> 2 == side >> 1 ||
                bvxi_edge_offset(e, side >> 1) != (side & 1))
                continue;
            met++;
            v = split->of[e];
        }
        if (met > 2) split->junction[v] |= (uint8_t)(1 << side);
    }
}
