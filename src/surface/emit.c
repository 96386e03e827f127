/* emit.c - the second pass of marching cubes: positions and triangles of each row of cells.
 *
 * Cells without a crossing change no counter, so eight counters that step only at active cells number the
 * vertices as a walk along the row meets them: no popcount, no look-up of neighbours. The case gives for each
 * triangle corner its counter and whether it is the next crossing (tables.h). */
#include "volume/room.h"
#include "surface/cells.h"

/* ---- positions ---- */

/* One axis's vertices of a block, at middles of edges. Bits of x-edges lie between bit-1 and bit. */
BVXI_VECTOR_INLINE void emit_middles(const bvxi_march *m, int32_t axis, int32_t j, int32_t k,
                                     const bvxi_cell_list *list, int32_t first, uint64_t vertex)
{
    double const y = bvxi_place_along(m, 1, j, axis == 1 ? 0.5 : 0.0);
    double const z = bvxi_place_along(m, 2, k, axis == 2 ? 0.5 : 0.0);
    const double *const x = m->across[axis != 0] + (size_t)first * 64;

    /* The usual case by itself: y and z are rounded once for the block, and the loop has no branch. */
    if (m->options.position_type == BVX_F32) {
        float *p = (float *)m->mesh->positions + 3 * vertex;
        float const fy = (float)y, fz = (float)z;
        for (uint32_t i = 0; i < list->count; i++, p += 3) {
            p[0] = (float)x[list->at[i]];
            p[1] = fy;
            p[2] = fz;
        }
    } else {
        for (uint32_t i = 0; i < list->count; i++)
            bvxi_put_position(m->mesh, m->options.position_type, vertex + i, x[list->at[i]], y, z);
    }
}

/* The same with a ratio for each edge. */
static void emit_ratios(const bvxi_march *m, int32_t axis, int32_t j, int32_t k, const bvxi_cell_list *list,
                        int32_t first, uint64_t vertex)
{
    for (uint32_t n = 0; n < list->count; n++) {
        int32_t const i = first * 64 + list->at[n] - (axis == 0);
        bvxi_put_crossing(m, vertex + n, axis, i, j, k,
                          bvxi_keep_off_ends(m->ratio(m->ratio_user, axis, i, j, k)));
    }
}

/* Where the straight line from a to b meets the level; the middle where one of them is NaN or infinite.
 * Halves, so that no difference of finite doubles overflows; (a - a) + (b - b) is 0 for finite ones only. */
BVXI_VECTOR_INLINE double cut_of_level(double level, double a, double b)
{
    double const t = (0.5 * level - 0.5 * a) / (0.5 * b - 0.5 * a);
    return (a - a) + (b - b) == 0.0 && t >= 0.0 && t <= 1.0 ? bvxi_keep_off_ends(t) : 0.5;
}

/* The same where samples tell; the middle also where an end lies outside the window. */
BVXI_VECTOR_INLINE void emit_levels(const bvxi_march *m, int32_t axis, int32_t j, int32_t k,
                                    const bvxi_cell_list *list, int32_t first, uint64_t vertex)
{
    const bvxi_level_samples *const s = m->level;
    const int32_t *const size = m->grid->size;
    int64_t const step = s->stride[axis], row = (int64_t)j * s->stride[1] + (int64_t)k * s->stride[2];
    double const y = bvxi_place_along(m, 1, j, 0.0), z = bvxi_place_along(m, 2, k, 0.0);
    int const row_known = j >= 0 && k >= 0 && (axis != 1 || j + 1 < size[1]) &&
                          (axis != 2 || k + 1 < size[2]);
    int32_t const x_end = size[0] - (axis == 0); /* low ends from 0 to here have both ends in the window */

    /* Edges that leave the window have no second sample: their vertices stay in the middle, as a cap's. */
    for (uint32_t n = 0; n < list->count; n++) {
        int32_t const i = first * 64 + list->at[n] - (axis == 0);
        double t = 0.5;
        if (row_known && i >= 0 && i < x_end) {
            const uint8_t *const p = s->samples + (ptrdiff_t)(row + (int64_t)i * s->stride[0]);
            t = cut_of_level(s->level, bvxi_sample_value(p, s->type),
                             bvxi_sample_value(p + (ptrdiff_t)step, s->type));
        }
        bvxi_put_position(
            m->mesh, m->options.position_type, vertex + n, bvxi_place_along(m, 0, i, axis == 0 ? t : 0.0),
            axis == 1 ? bvxi_place_along(m, 1, j, t) : y, axis == 2 ? bvxi_place_along(m, 2, k, t) : z);
    }
}

/* ---- triangles ---- */

/* The active cells of a block. */
static uint32_t *emit_cells(const bvxi_march *m, const bvxi_case_list *cases, uint32_t from,
                            uint32_t counter[8], uint32_t *out)
{
    int32_t const rule = m->options.face_rule;

    for (uint32_t a = from; a < cases->count; a++) {
        uint32_t const n = cases->number[a];

        /* Each corner's vertex is its counter's next unused one, or one past it, by the tables. */
        const uint8_t *const corner = bvxi_cell_triangle[rule][n];
        const uint8_t *const step = bvxi_cell_lane_step[n];
        uint32_t const corners = 3u * bvxi_cell_triangle_count[rule][n];
        for (uint32_t i = 0; i < corners; i++) out[i] = counter[corner[i] & 7] + (corner[i] >> 3);
        out += corners;

        /* Eight steps, also those of 0, are one vector addition and no branch. */
        for (uint32_t l = 0; l < 8; l++) counter[l] += step[l];
    }
    return out;
}

#if BVXI_HAVE_AVX2
/* The same, sixteen corners at a time; writes up to sixteen numbers, so it stops before the piece's end. */
BVXI_AVX2 static uint32_t *emit_cells_avx2(const bvxi_march *m, const bvxi_case_list *cases,
                                           uint32_t counter[8], uint32_t *out, const uint32_t *end)
{
    int32_t const rule = m->options.face_rule;
    const uint8_t(*const corners)[BVXI_CELL_ROW] = bvxi_cell_triangle[rule];
    __m256i count = _mm256_loadu_si256((const __m256i *)(const void *)counter);
    uint32_t done = 0;

    for (; done < cases->count && end - out >= BVXI_CELL_ROW; done++) {
        uint32_t const n = cases->number[done];
        __m128i const step = _mm_loadl_epi64((const __m128i *)(const void *)bvxi_cell_lane_step[n]);

        /* A permutation by lanes is eight look-ups of counters in one instruction, which is why there are
         * eight counters. It leaves the bits above the lane aside. */
        for (int half = 0; half < 2; half++) {
            __m256i const corner = _mm256_cvtepu8_epi32(
                _mm_loadl_epi64((const __m128i *)(const void *)(corners[n] + 8 * half)));
            _mm256_storeu_si256(
                (__m256i *)(void *)(out + 8 * half),
                _mm256_add_epi32(_mm256_permutevar8x32_epi32(count, corner), _mm256_srli_epi32(corner, 3)));
        }
        count = _mm256_add_epi32(count, _mm256_cvtepu8_epi32(step));
        out += 3u * bvxi_cell_triangle_count[rule][n];
    }

    /* What is too near to the piece's end for stores of sixteen continues with the plain loop, from the same
     * counters. */
    _mm256_storeu_si256((__m256i *)(void *)counter, count);
    return emit_cells(m, cases, done, counter, out);
}
#endif

typedef struct emit_block {
    bvxi_cell_list edge[3];
    bvxi_case_list cases;
} emit_block;

BVXI_VECTOR_INLINE void load_block(const bvxi_march *m, const uint64_t *const row[4], const uint64_t has[4],
                                   int32_t first, emit_block *b, int fast)
{
    int32_t const left = m->edge_words - first, block = left < BVXI_CELL_BLOCK ? left : BVXI_CELL_BLOCK;
    int32_t const words = m->grid->words_per_row;

    b->cases.count = b->edge[0].count = b->edge[1].count = b->edge[2].count = 0;
    for (uint32_t busy = bvxi_busy_words(row, first, block, words); busy != 0; busy &= busy - 1) {
        int32_t const w = bvxi_lowest(busy);
        uint64_t const visited = bvxi_visited(m, first + w);
        bvxi_cell_words c;
        bvxi_load_cells(row, first + w, words, &c);

        /* Edges that another row of cells owns are masked out (has), so each vertex is written once. */
        bvxi_list_bits(&b->edge[0], (c.low[0] ^ c.high[0]) & visited & has[0], w, 3, fast);
        bvxi_list_bits(&b->edge[1], (c.high[0] ^ c.high[1]) & has[1], w, 3, fast);
        bvxi_list_bits(&b->edge[2], (c.high[0] ^ c.high[2]) & has[2], w, 3, fast);
        uint64_t const active = bvxi_active_cells(&c) & visited & has[3];
#if BVXI_HAVE_AVX2
        if (fast) {
            bvxi_list_cases_bmi2(&b->cases, &c, active);
            continue;
        }
#endif
        bvxi_list_cases(&b->cases, &c, active);
    }
}

BVXI_VECTOR_INLINE void emit_slot(const bvxi_march *m, uint64_t slot, const uint32_t *piece_end, int fast)
{
    const bvxi_slot *const s = &m->slots[slot];
    uint32_t *out = m->mesh->triangles + 3 * (size_t)s->triangle;
    uint64_t vertex[3] = {s->edge[0], s->edge[1], s->edge[2]}, has[4];
    const uint64_t *row[4];
    uint32_t counter[8];
    emit_block b;
    int32_t j, k;

    /* Most rows of a solid have no crossing. The first pass knows, so they are not read again. */
    if (s[1].edge[0] == s->edge[0] && s[1].triangle == s->triangle) return;
    bvxi_slot_row(m, slot, &j, &k);

    /* First numbers of the eight counters of a row of cells; rows outside the window have no x-edges. */
    uint64_t const rows = (uint64_t)m->grid->size[1] + 1;
    uint64_t const up = j + 1 < m->grid->size[1] ? 1 : 0, back = k + 1 < m->grid->size[2] ? rows : 0;
    counter[0] = s->edge[0];
    counter[1] = s[up].edge[0];
    counter[2] = s[back].edge[0];
    counter[3] = s[up + back].edge[0];
    counter[4] = s->edge[1];
    counter[5] = s[back].edge[1];
    counter[6] = s->edge[2];
    counter[7] = s[up].edge[2];
    bvxi_cell_rows(m, j, k, row);
    for (int32_t a = 0; a < 4; a++) has[a] = bvxi_slot_has(m, a, j, k) ? ~UINT64_C(0) : 0;
    for (int32_t first = 0; first < m->edge_words; first += BVXI_CELL_BLOCK) {
        load_block(m, row, has, first, &b, fast);
        for (int32_t axis = 0; axis < 3; axis++) {
            if (m->level != NULL) emit_levels(m, axis, j, k, &b.edge[axis], first, vertex[axis]);
            else if (m->ratio == NULL) emit_middles(m, axis, j, k, &b.edge[axis], first, vertex[axis]);
            else emit_ratios(m, axis, j, k, &b.edge[axis], first, vertex[axis]);
            vertex[axis] += b.edge[axis].count;
        }
#if BVXI_HAVE_AVX2
        if (fast) {
            out = emit_cells_avx2(m, &b.cases, counter, out, piece_end);
            continue;
        }
#endif
        out = emit_cells(m, &b.cases, 0, counter, out);
    }
    (void)piece_end;
}

BVXI_VECTOR_INLINE void emit_piece(const bvxi_march *m, int32_t piece, int fast)
{
    uint64_t begin, end;
    bvxi_piece(m->slot_count, m->pieces, piece, &begin, &end);
    const uint32_t *piece_end = m->mesh->triangles + 3 * (size_t)m->slots[end].triangle;
    for (uint64_t s = begin; s < end; s++) emit_slot(m, s, piece_end, fast);
}

BVXI_AVX2_COPY(emit_piece_avx2, (const bvxi_march *m, int32_t piece), emit_piece(m, piece, 1))

void bvxi_march_emit_piece(void *march, int32_t piece)
{
    const bvxi_march *const m = march;
    BVXI_PATH(m->cpu == BVX_CPU_AVX2, emit_piece(m, piece, 0), emit_piece_avx2(m, piece));
}
