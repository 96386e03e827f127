/* keys.c - canonical keys, by which the surfaces of windows merge into the whole's.
 *
 * Vertices: (z, y, axis, x) of their edge's low end, triangles: (z, y, x) of their cell's low corner, lattice indices
 * plus one, 20 bits each: their order is the order of the whole's arrays. */
#include "surface/cells.h"

static uint64_t make_key(const bvxi_march *m, int32_t i, int32_t j, int32_t k, int32_t axis)
{
    const int32_t *const low = m->grid->low;
    return (uint64_t)(low[2] + k + 1) << 42 | (uint64_t)(low[1] + j + 1) << 22 | (uint64_t)axis << 20 | (uint64_t)(low[0] + i + 1);
}

static void key_vertices(const bvxi_march *m, const bvxi_slot *s, int32_t j, int32_t k)
{
    int32_t const words = m->grid->words_per_row;
    const uint64_t *const row = bvxi_march_row(m, j, k);
    for (int32_t axis = 0; axis < 3; axis++) {
        const uint64_t *const other = bvxi_march_row(m, j + (axis == 1), k + (axis == 2));
        uint64_t *out = m->mesh->vertex_keys + s->edge[axis];
        uint64_t *const end = m->mesh->vertex_keys + (axis < 2 ? s->edge[axis + 1] : s[1].edge[0]);
        for (int32_t w = 0; out < end; w++) {
            uint64_t const high = bvxi_high_word(row, w, words);
            uint64_t mask = axis == 0 ? (bvxi_low_word(row, w, words) ^ high) & bvxi_visited(m, w)
                                      : high ^ bvxi_high_word(other, w, words);
            for (; mask != 0; mask &= mask - 1) *out++ = make_key(m, w * 64 + bvxi_lowest(mask) - (axis == 0), j, k, axis);
        }
    }
}

static void key_triangles(const bvxi_march *m, uint64_t slot, int32_t j, int32_t k)
{
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];
    uint64_t *out = m->mesh->triangle_keys + m->slots[slot].triangle;
    uint64_t *const end = m->mesh->triangle_keys + m->slots[slot + 1].triangle;
    const uint64_t *row[4];
    for (int32_t r = 0; r < 4; r++) row[r] = bvxi_march_row(m, j + (r & 1), k + (r >> 1));
    for (int32_t w = 0; out < end; w++) {
        bvxi_cell_words c;
        uint64_t active;
        if (!bvxi_load_cells(row, w, m->grid->words_per_row, &c)) continue;
        active = bvxi_active_cells(&c) & bvxi_visited(m, w);
        for (; active != 0; active &= active - 1) {
            int32_t const i = bvxi_lowest(active);
            for (uint8_t n = triangles[bvxi_cell_case(&c, i)]; n > 0; n--) *out++ = make_key(m, w * 64 + i - 1, j, k, 0);
        }
    }
}

void bvxi_march_key_piece(void *march, int32_t piece, int32_t worker)
{
    const bvxi_march *const m = march;
    uint64_t begin, end;
    (void)worker;
    bvxi_piece(m->slot_count, m->pieces, piece, &begin, &end);
    for (uint64_t s = begin; s < end; s++) {
        int32_t j, k;
        bvxi_slot_row(m, s, &j, &k);
        key_vertices(m, &m->slots[s], j, k);
        key_triangles(m, s, j, k);
    }
}
