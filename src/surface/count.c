/* count.c - the first pass of marching cubes: crossings and triangles of each row of cells. */
#include "surface/cells.h"

/* Popcount by the instruction where the path has it. */
BVXI_VECTOR_INLINE uint32_t count_bits(uint64_t w, int fast)
{
#if BVXI_HAVE_AVX2
    if (fast) return (uint32_t)__builtin_popcountll(w);
#endif
    (void)fast;
    return bvxi_popcount(w);
}

BVXI_VECTOR_INLINE void count_slot(const bvxi_march *m, uint64_t slot, int fast)
{
    bvxi_slot *const s = &m->slots[slot];
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];
    int32_t const words = m->grid->words_per_row;
    uint32_t n[3] = {0, 0, 0}, triangle_count = 0;
    const uint64_t *row[4];
    int32_t j, k;
    int has[4];
    bvxi_slot_row(m, slot, &j, &k);
    for (int32_t a = 0; a < 4; a++) has[a] = bvxi_slot_has(m, a, j, k);
    for (int32_t r = 0; r < 4; r++) row[r] = bvxi_march_row(m, j + (r & 1), k + (r >> 1));
    for (int32_t w = 0; w < m->edge_words; w++) {
        bvxi_cell_words c;
        uint64_t active;
        if (!bvxi_load_cells(row, w, words, &c)) continue;
        active = bvxi_active_cells(&c) & bvxi_visited(m, w);
        if (has[0]) n[0] += count_bits((c.low[0] ^ c.high[0]) & bvxi_visited(m, w), fast);
        if (has[1]) n[1] += count_bits(c.high[0] ^ c.high[1], fast);
        if (has[2]) n[2] += count_bits(c.high[0] ^ c.high[2], fast);
        if (!has[3]) continue;
        for (; active != 0; active &= active - 1) triangle_count += triangles[bvxi_cell_case(&c, bvxi_lowest(active))];
    }
    if (m->cell_high[0] < m->cell_low[0]) n[1] = n[2] = 0; /* no cells along x, so no edges of theirs */
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
