/* count.c - the first pass of marching cubes: crossings and triangles of each row of cells, 64 cells at a
 * time. Their prefix sums tell each row of the second pass where to write. See march.c for the source. */
#include "surface/cells.h"

/* The bits at or past size[0] set in the slot's first row: every row is the first of one slot. */
BVXI_VECTOR_INLINE uint64_t count_slot(const bvxi_march *m, uint64_t slot, int fast)
{
    bvxi_slot *const s = &m->slots[slot];
    const uint8_t *const triangles = bvxi_cell_triangle_count[m->options.face_rule];
    int32_t const words = m->grid->words_per_row;
    uint32_t n[3] = {0, 0, 0}, triangle_count = 0;
    const uint64_t *row[4];
    bvxi_case_list cases;
    uint64_t has[4]; /* all ones where the slot owns what it counts */
    int32_t j, k;

    bvxi_slot_row(m, slot, &j, &k);
    bvxi_cell_rows(m, j, k, row);
    for (int32_t a = 0; a < 4; a++) has[a] = bvxi_slot_has(m, a, j, k) ? ~UINT64_C(0) : 0;

    /* By blocks of words, so that the cases of active cells are listed and then counted in one loop. */
    for (int32_t first = 0; first < m->edge_words; first += BVXI_CELL_BLOCK) {
        int32_t const block = m->edge_words - first < BVXI_CELL_BLOCK ? m->edge_words - first
                                                                      : BVXI_CELL_BLOCK;
        cases.count = 0;
        for (uint32_t busy = bvxi_busy_words(row, first, block, words); busy != 0; busy &= busy - 1) {
            int32_t const w = first + bvxi_lowest(busy);
            uint64_t const visited = bvxi_visited(m, w);
            bvxi_cell_words c;
            bvxi_load_cells(row, w, words, &c);
            /* Edges are owned by the slot at their low end, so none is counted twice. */
            n[0] += bvxi_count_bits((c.low[0] ^ c.high[0]) & visited & has[0], fast);
            n[1] += bvxi_count_bits((c.high[0] ^ c.high[1]) & has[1], fast);
            n[2] += bvxi_count_bits((c.high[0] ^ c.high[2]) & has[2], fast);
            uint64_t const active = bvxi_active_cells(&c) & visited & has[3];
#if BVXI_HAVE_AVX2
            if (fast) {
                bvxi_list_cases_bmi2(&cases, &c, active);
                continue;
            }
#endif
            bvxi_list_cases(&cases, &c, active);
        }
        for (uint32_t i = 0; i < cases.count; i++) triangle_count += triangles[cases.number[i]];
    }
    for (int32_t a = 0; a < 3; a++) s->edge[a] = n[a];
    s->triangle = triangle_count;
    return row[0][words - 1] & m->past_mask;
}

BVXI_VECTOR_INLINE void count_piece(bvxi_march *m, int32_t piece, int fast)
{
    uint64_t begin, end, vertices = 0, triangles = 0, past = 0;
    bvxi_piece(m->slot_count, m->pieces, piece, &begin, &end);
    for (uint64_t s = begin; s < end; s++) {
        past |= count_slot(m, s, fast);
        vertices += (uint64_t)m->slots[s].edge[0] + m->slots[s].edge[1] + m->slots[s].edge[2];
        triangles += m->slots[s].triangle;
    }
    m->piece_counts[3 * piece] = vertices;
    m->piece_counts[3 * piece + 1] = triangles;
    m->piece_counts[3 * piece + 2] = past;
}

BVXI_AVX2_COPY(count_piece_avx2, (bvxi_march * m, int32_t piece), count_piece(m, piece, 1))

void bvxi_march_count_piece(void *march, int32_t piece)
{
    bvxi_march *const m = march;
    BVXI_PATH(m->cpu == BVX_CPU_AVX2, count_piece(m, piece, 0), count_piece_avx2(m, piece));
}
