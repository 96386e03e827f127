/* emit.c - the second pass of marching cubes: positions and triangles of each row of cells.
 *
 * Cells without a crossing change no counter, so eight counters that step only at active cells number the vertices as a
 * walk along the row meets them: no popcount, no look-up of neighbours. The case gives for each triangle corner its
 * counter and whether it is the next crossing (tables.h). */
#include "surface/cells.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

/* Vertices keep this far from an edge's ends, in edge lengths: two f32 steps at least (march.c), so no two meet. */
#define EDGE_MARGIN (1.0 / 128.0)

/* ---- positions ---- */

static inline void put_position(const bvxi_march *m, uint64_t vertex, double x, double y, double z)
{
    if (m->options.position_type == BVX_F32) {
        float *const p = (float *)m->mesh->positions + 3 * vertex;
        p[0] = (float)x;
        p[1] = (float)y;
        p[2] = (float)z;
    } else {
        double *const p = (double *)m->mesh->positions + 3 * vertex;
        p[0] = x;
        p[1] = y;
        p[2] = z;
    }
}

/* World coordinate along an axis of a place between centres: index counts centres of the window. */
static inline double place_along(const bvxi_march *m, int32_t axis, int32_t index, double ratio)
{
    return m->origin[axis] + ((double)(m->grid->low[axis] + index) + 0.5 + ratio) * m->spacing[axis];
}

/* One axis's vertices of a slot, at the middle of their edges. */
static uint64_t emit_middles(const bvxi_march *m, int32_t axis, int32_t j, int32_t k, uint64_t mask, int32_t word, uint64_t vertex)
{
    double const y = place_along(m, 1, j, axis == 1 ? 0.5 : 0.0), z = place_along(m, 2, k, axis == 2 ? 0.5 : 0.0);
    const double *const x = m->across[axis != 0] + (size_t)word * 64;
    if (m->options.position_type == BVX_F32) {
        float *p = (float *)m->mesh->positions + 3 * vertex;
        float const fy = (float)y, fz = (float)z;
        for (; mask != 0; mask &= mask - 1, p += 3, vertex++) {
            p[0] = (float)x[bvxi_lowest(mask)];
            p[1] = fy;
            p[2] = fz;
        }
    } else {
        for (; mask != 0; mask &= mask - 1) put_position(m, vertex++, x[bvxi_lowest(mask)], y, z);
    }
    return vertex;
}

/* The same with a ratio for each edge. */
static uint64_t emit_ratios(const bvxi_march *m, int32_t axis, int32_t j, int32_t k, uint64_t mask, int32_t word, uint64_t vertex)
{
    for (; mask != 0; mask &= mask - 1) {
        int32_t const i = word * 64 + bvxi_lowest(mask) - (axis == 0);
        double t = m->ratio(m->ratio_user, axis, i, j, k);
        t = t < EDGE_MARGIN ? EDGE_MARGIN : t > 1.0 - EDGE_MARGIN ? 1.0 - EDGE_MARGIN : t;
        put_position(m, vertex++, place_along(m, 0, i, axis == 0 ? t : 0.0), place_along(m, 1, j, axis == 1 ? t : 0.0),
                     place_along(m, 2, k, axis == 2 ? t : 0.0));
    }
    return vertex;
}

static void emit_vertices(const bvxi_march *m, const bvxi_slot *s, int32_t j, int32_t k)
{
    int32_t const words = m->grid->words_per_row;
    const uint64_t *const row = bvxi_march_row(m, j, k);
    for (int32_t axis = 0; axis < 3; axis++) {
        const uint64_t *const other = bvxi_march_row(m, j + (axis == 1), k + (axis == 2));
        uint64_t vertex = s->edge[axis];
        uint64_t const end = axis < 2 ? s->edge[axis + 1] : s[1].edge[0];
        for (int32_t w = 0; vertex < end; w++) {
            uint64_t const high = bvxi_high_word(row, w, words);
            uint64_t const mask = axis == 0 ? (bvxi_low_word(row, w, words) ^ high) & bvxi_visited(m, w)
                                            : high ^ bvxi_high_word(other, w, words);
            if (mask == 0) continue;
            vertex = m->ratio == NULL ? emit_middles(m, axis, j, k, mask, w, vertex)
                                      : emit_ratios(m, axis, j, k, mask, w, vertex);
        }
    }
}

/* ---- triangles ---- */

/* First numbers of the eight counters of a row of cells; rows outside the window have no x-edges, any number serves. */
static void start_counters(const bvxi_march *m, uint64_t slot, int32_t j, int32_t k, uint32_t counter[8])
{
    uint64_t const rows = (uint64_t)m->grid->size[1] + 1;
    uint64_t const up = j + 1 < m->grid->size[1] ? 1 : 0, back = k + 1 < m->grid->size[2] ? rows : 0;
    const bvxi_slot *const s = &m->slots[slot];
    counter[0] = s->edge[0];
    counter[1] = s[up].edge[0];
    counter[2] = s[back].edge[0];
    counter[3] = s[up + back].edge[0];
    counter[4] = s->edge[1];
    counter[5] = s[back].edge[1];
    counter[6] = s->edge[2];
    counter[7] = s[up].edge[2];
}

static uint32_t *emit_cells(const bvxi_march *m, const bvxi_cell_words *c, uint64_t active, uint32_t counter[8], uint32_t *out)
{
    int32_t const rule = m->options.face_rule;
    for (; active != 0; active &= active - 1) {
        uint32_t const n = bvxi_cell_case(c, bvxi_lowest(active));
        const uint8_t *const lane = bvxi_cell_triangle_lane[rule][n], *const offset = bvxi_cell_triangle_offset[rule][n];
        const uint8_t *const step = bvxi_cell_lane_step[n];
        uint32_t const corners = 3u * bvxi_cell_triangle_count[rule][n];
        for (uint32_t i = 0; i < corners; i++) out[i] = counter[lane[i]] + offset[i];
        out += corners;
        for (uint32_t l = 0; l < 8; l++) counter[l] += step[l];
    }
    return out;
}

#if BVXI_HAVE_AVX2
/* The same, sixteen corners at a time; writes up to sixteen numbers, so it stops before the piece's end comes near. */
BVXI_AVX2 static uint32_t *emit_cells_avx2(const bvxi_march *m, const bvxi_cell_words *c, uint64_t active, uint32_t counter[8],
                                           uint32_t *out, const uint32_t *end)
{
    int32_t const rule = m->options.face_rule;
    const uint8_t(*const lanes)[BVXI_CELL_ROW] = bvxi_cell_triangle_lane[rule], (*const offsets)[BVXI_CELL_ROW] = bvxi_cell_triangle_offset[rule];
    __m256i count = _mm256_loadu_si256((const __m256i *)(const void *)counter);
    for (; active != 0 && end - out >= BVXI_CELL_ROW; active &= active - 1) {
        uint32_t const n = bvxi_cell_case(c, bvxi_lowest(active));
        __m128i const lane = _mm_loadu_si128((const __m128i *)(const void *)lanes[n]);
        __m128i const offset = _mm_loadu_si128((const __m128i *)(const void *)offsets[n]);
        __m128i const step = _mm_loadl_epi64((const __m128i *)(const void *)bvxi_cell_lane_step[n]);
        __m256i const a = _mm256_permutevar8x32_epi32(count, _mm256_cvtepu8_epi32(lane));
        __m256i const b = _mm256_permutevar8x32_epi32(count, _mm256_cvtepu8_epi32(_mm_srli_si128(lane, 8)));
        _mm256_storeu_si256((__m256i *)(void *)out, _mm256_add_epi32(a, _mm256_cvtepu8_epi32(offset)));
        _mm256_storeu_si256((__m256i *)(void *)(out + 8),
                            _mm256_add_epi32(b, _mm256_cvtepu8_epi32(_mm_srli_si128(offset, 8))));
        count = _mm256_add_epi32(count, _mm256_cvtepu8_epi32(step));
        out += 3u * bvxi_cell_triangle_count[rule][n];
    }
    _mm256_storeu_si256((__m256i *)(void *)counter, count);
    return emit_cells(m, c, active, counter, out);
}
#endif

static void emit_triangles(const bvxi_march *m, uint64_t slot, int32_t j, int32_t k, const uint32_t *piece_end)
{
    int32_t const words = m->grid->words_per_row;
    uint32_t *out = m->mesh->triangles + 3 * (size_t)m->slots[slot].triangle;
    uint32_t *const slot_end = m->mesh->triangles + 3 * (size_t)m->slots[slot + 1].triangle;
    const uint64_t *row[4];
    uint32_t counter[8];
    start_counters(m, slot, j, k, counter);
    for (int32_t r = 0; r < 4; r++) row[r] = bvxi_march_row(m, j + (r & 1), k + (r >> 1));
    for (int32_t w = 0; out < slot_end; w++) {
        bvxi_cell_words c;
        uint64_t active;
        if (!bvxi_load_cells(row, w, words, &c)) continue;
        active = bvxi_active_cells(&c) & bvxi_visited(m, w);
#if BVXI_HAVE_AVX2
        if (m->cpu == BVX_CPU_AVX2) {
            out = emit_cells_avx2(m, &c, active, counter, out, piece_end);
            continue;
        }
#endif
        out = emit_cells(m, &c, active, counter, out);
    }
    (void)piece_end;
}

void bvxi_march_emit_piece(void *march, int32_t piece, int32_t worker)
{
    const bvxi_march *const m = march;
    uint64_t begin, end;
    const uint32_t *piece_end;
    (void)worker;
    bvxi_piece(m->slot_count, m->pieces, piece, &begin, &end);
    piece_end = m->mesh->triangles + 3 * (size_t)m->slots[end].triangle;
    for (uint64_t s = begin; s < end; s++) {
        int32_t j, k;
        bvxi_slot_row(m, s, &j, &k);
        emit_vertices(m, &m->slots[s], j, k);
        if (m->slots[s + 1].triangle != m->slots[s].triangle) emit_triangles(m, s, j, k, piece_end);
    }
}
