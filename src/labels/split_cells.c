/* split_cells.c - the vertices of a cell by its pattern (labels.h).
 *
 * In a side of a cell none, two, three or four edges have different ends, never one. All that do are joined, but of
 * four each is joined with one where two voxels across have the same label: that label leads through the side, and
 * the other two lie apart. So no label touches itself in a side, one edge of the complex runs through it or two,
 * and neighbouring cells agree by the side's four labels. The staircase has one edge in any case.
 *
 * Two edges through a high side that would begin in the same vertex could end in the same one too. So the faces of
 * one of them get a vertex of their own there, and a flap closes the gap: a face from the new vertex by the one
 * beyond a side, the old vertex, and the one beyond another side back. Which one it is goes around the axes, so no
 * lattice edge has two new vertices in a cell. */
#include "labels/labels.h"

static int is_in_side(uint32_t pattern, int32_t e, int32_t side)
{
    return (pattern >> e & 1) != 0 && e >> 2 != side >> 1 && bvxi_edge_offset(e, side >> 1) == (side & 1);
}

uint32_t bvxi_four_sides(uint32_t pattern)
{
    uint32_t fours = 0;

    for (int32_t side = 0; side < 6; side++) {
        int32_t met = 0;
        for (int32_t e = 0; e < 12; e++) met += is_in_side(pattern, e, side);
        if (met == 1) return UINT32_MAX;
        if (met == 4) fours |= UINT32_C(1) << side;
    }
    return fours;
}

/* The other side of a cell in which its edge lies. */
static int32_t other_side(int32_t e, int32_t side)
{
    int32_t const axis = 3 - (e >> 2) - (side >> 1);
    return 2 * axis + bvxi_edge_offset(e, axis);
}

/* The edge of a side along an axis at an offset along the third. */
static int32_t edge_of_side(int32_t side, int32_t along, int32_t offset)
{
    int32_t e = 4 * along;
    while (bvxi_edge_offset(e, side >> 1) != (side & 1) ||
           bvxi_edge_offset(e, 3 - along - (side >> 1)) != offset)
        e++;
    return e;
}

static void add_flap(bvxi_cell_split *split, int32_t side, uint32_t across)
{
    int32_t const u = ((side >> 1) + 1) % 3, v = (u + 1) % 3;
    int32_t const mixed = across == BVXI_ACROSS_MIXED;
    int32_t const first = edge_of_side(side, u, 0), second = edge_of_side(side, v, mixed ? 0 : 1);
    bvxi_cell_flap *const flap = &split->flap[split->flaps];

    if (split->base[first] != split->base[edge_of_side(side, u, 1)]) return;
    split->flaps++;
    flap->vertex = split->count++;
    flap->edge = (uint8_t)first;
    split->of[first] = split->of[second] = flap->vertex;

    /* The flap turns against the face at the edge that they share; the face turns counter-clockwise about its lattice
     * edge, into this side of the cell. */
    int32_t const a = ((first >> 2) + 1) % 3, b = (a + 1) % 3;
    int32_t const at_a = bvxi_edge_offset(first, a), at_b = bvxi_edge_offset(first, b);
    int const to_side = (at_a == at_b ? 2 * a + at_a : 2 * b + at_b) == side;
    flap->side[!to_side] = (uint8_t)other_side(first, side);
    flap->side[to_side] = (uint8_t)other_side(second, side);
}

void bvxi_split_pattern(uint32_t pattern, const uint8_t across[6], bvxi_cell_split *split)
{
    uint32_t parent[12];
    int32_t edges[7] = {0}, sum[7][3] = {{0}};

    memset(split, 0, sizeof *split);
    for (uint32_t e = 0; e < 12; e++) parent[e] = e;
    for (int32_t side = 0; side < 6; side++) {
        int32_t in[4], met = 0;
        for (int32_t e = 0; e < 12; e++)
            if (is_in_side(pattern, e, side)) in[met++] = e;
        for (int32_t i = 0; i < met; i++)
            for (int32_t k = 0; k < i; k++) {
                int32_t const e = in[i], f = in[k];
                int const same = bvxi_edge_offset(e, f >> 2) == bvxi_edge_offset(f, e >> 2);
                if (across[side] == 0 || (e >> 2 != f >> 2 && same == (across[side] == BVXI_ACROSS_MIXED)))
                    bvxi_join(parent, (uint32_t)f, (uint32_t)e);
            }
    }

    /* Roots are the lowest edges, so vertices are in the order of theirs. */
    for (uint32_t e = 0; e < 12; e++) {
        if ((pattern >> e & 1) == 0) continue;
        uint32_t const root = bvxi_root(parent, e);
        split->base[e] = root == e ? split->count++ : split->base[root];
    }
    memcpy(split->of, split->base, sizeof split->of);
    for (int32_t side = 1; side < 6; side += 2)
        if (across[side] != 0) add_flap(split, side, across[side]);

    for (int32_t e = 0; e < 12; e++) {
        if ((pattern >> e & 1) == 0) continue;
        edges[split->of[e]]++;
        for (int32_t a = 0; a < 3; a++)
            if (a != e >> 2) sum[split->of[e]][a] += (2 * bvxi_edge_offset(e, a) - 1) * BVXI_NET_LIMIT;
    }
    for (int32_t v = 0; v < split->count; v++)
        for (int32_t a = 0; a < 3 && edges[v] != 0; a++) split->start[v][a] = (int16_t)(sum[v][a] / edges[v]);

    for (int32_t side = 0; side < 6; side++) {
        int32_t met = 0;
        for (int32_t e = 0; across[side] == 0 && e < 12; e++)
            if (is_in_side(pattern, e, side) && ++met == 3)
                split->junction[split->base[e]] |= (uint8_t)(1 << side);
    }
}
