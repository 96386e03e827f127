/* count.c - the first pass of marching cubes: crossings and triangles of each row of cells. */
#include "surface/cells.h"

BVXI_VECTOR_INLINE void count_slot(const bvxi_march *m, uint64_t slot, int fast)
{
    bvxi_slot *const s = &m->slots[slot];
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];
    uint32_t n[3] = {0, 0, 0}, triangle_count = 0;
    bvxi_cell_words cells[BVXI_CELL_BLOCK];
    bvxi_cell_list active;
    bvxi_cell_walk walk;
    uint64_t has[4]; /* all ones where the slot owns what it counts */
    int32_t j, k;
    bvxi_slot_row(m, slot, &j, &k);
    for (int32_t a = 0; a < 4; a++) has[a] = bvxi_slot_has(m, a, j, k) ? ~UINT64_C(0) : 0;
    bvxi_walk_start(&walk, m, j, k);
    for (int32_t first = 0; first < m->edge_words; first += BVXI_CELL_BLOCK) {
        int32_t const block = m->edge_words - first < BVXI_CELL_BLOCK ? m->edge_words - first : BVXI_CELL_BLOCK;
        active.count = 0;
        for (int32_t w = 0; w < block; w++) {
            bvxi_cell_words *const c = &cells[w];
            uint64_t visited;
            if (!bvxi_walk_next(&walk, c)) continue;
            visited = bvxi_visited(m, first + w);
            n[0] += bvxi_count_bits((c->low[0] ^ c->high[0]) & visited & has[0], fast);
            n[1] += bvxi_count_bits((c->high[0] ^ c->high[1]) & has[1], fast);
            n[2] += bvxi_count_bits((c->high[0] ^ c->high[2]) & has[2], fast);
            bvxi_list_bits(&active, bvxi_active_cells(c) & visited & has[3], w, 4, fast);
        }
        for (uint32_t i = 0; i < active.count; i++)
            triangle_count += triangles[bvxi_cell_case(&cells[active.at[i] >> 6], active.at[i] & 63)];
    }
    for (int32_t a = 0; a < 3; a++) s->edge[a] = n[a];
    s->triangle = triangle_count;
}

BVXI_VECTOR_INLINE void count_piece(bvxi_march *m, int32_t piece, int fast)
{
    uint64_t begin, end, vertices = 0, triangles = 0;
    bvxi_piece(m->slot_count, m->pieces, piece, &begin, &end);
    for (uint64_t s = begin; s < end; s++) {
        count_slot(m, s, fast);
        vertices += (uint64_t)m->slots[s].edge[0] + m->slots[s].edge[1] + m->slots[s].edge[2];
        triangles += m->slots[s].triangle;
    }
    m->piece_counts[2 * piece] = vertices;
    m->piece_counts[2 * piece + 1] = triangles;
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static void count_piece_avx2(bvxi_march *m, int32_t piece)
{
    count_piece(m, piece, 1);
}
#endif

void bvxi_march_count_piece(void *march, int32_t piece, int32_t worker)
{
    bvxi_march *const m = march;
    (void)worker;
#if BVXI_HAVE_AVX2
    if (m->cpu == BVX_CPU_AVX2) {
        count_piece_avx2(m, piece);
        return;
    }
#endif
    count_piece(m, piece, 0);
}
