/* keys.c - canonical keys, by which the surfaces of windows merge into the whole's.
 *
 * Vertices: (z, y, axis, x) of their edge's low end, triangles: (z, y, x) of their cell's low corner, lattice
 * indices plus one, 20 bits each: their order is the order of the whole's arrays. */
#include "surface/cells.h"

static uint64_t make_key(const bvxi_march *m, int32_t i, int32_t j, int32_t k, int32_t axis)
{
    const int32_t *const low = m->grid->low;
    return (uint64_t)(low[2] + k + 1) << 42 | (uint64_t)(low[1] + j + 1) << 22 | (uint64_t)axis << 20 |
           (uint64_t)(low[0] + i + 1);
}

static uint64_t *key_bits(const bvxi_march *m, uint64_t mask, int32_t w, int32_t j, int32_t k, int32_t axis,
                          uint64_t *out)
{
    for (; mask != 0; mask &= mask - 1)
        *out++ = make_key(m, w * 64 + bvxi_lowest(mask) - (axis == 0), j, k, axis);
    return out;
}

static void key_slot(const bvxi_march *m, uint64_t slot)
{
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];
    const bvxi_slot *const s = &m->slots[slot];
    uint64_t *out[3], *triangle = m->mesh->triangle_keys + s->triangle;
    const uint64_t *row[4];
    int32_t j, k;

    bvxi_slot_row(m, slot, &j, &k);
    bvxi_cell_rows(m, j, k, row);
    for (int32_t a = 0; a < 3; a++) out[a] = m->mesh->vertex_keys + s->edge[a];

    for (int32_t w = 0; w < m->edge_words; w++) {
        uint64_t const visited = bvxi_visited(m, w);
        bvxi_cell_words c;
        bvxi_load_cells(row, w, m->grid->words_per_row, &c);
        if (bvxi_slot_has(m, 0, j, k))
            out[0] = key_bits(m, (c.low[0] ^ c.high[0]) & visited, w, j, k, 0, out[0]);
        if (bvxi_slot_has(m, 1, j, k)) out[1] = key_bits(m, c.high[0] ^ c.high[1], w, j, k, 1, out[1]);
        if (bvxi_slot_has(m, 2, j, k)) out[2] = key_bits(m, c.high[0] ^ c.high[2], w, j, k, 2, out[2]);
        if (!bvxi_slot_has(m, 3, j, k)) continue;
        for (uint64_t active = bvxi_active_cells(&c) & visited; active != 0; active &= active - 1) {
            int32_t const i = bvxi_lowest(active);
            /* A cell's triangles have one key: a stable sort keeps their order. */
            for (uint8_t n = triangles[bvxi_cell_case(&c, i)]; n > 0; n--)
                *triangle++ = make_key(m, w * 64 + i - 1, j, k, 0);
        }
    }
}

void bvxi_march_key_piece(void *march, uint64_t begin, uint64_t end)
{
    const bvxi_march *const m = march;
    for (uint64_t s = begin; s < end; s++) key_slot(m, s);
}
