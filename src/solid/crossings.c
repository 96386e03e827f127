/* crossings.c - from a chunk of triangles to its crossings with rows of centres.
 *
 * Source: scanline conversion with exact edge functions, after Pineda. A Parallel Algorithm for Polygon
 * Rasterization. 1988.
 *
 * Triangles go in batches that stay in the nearest cache, through steps without unpredictable branches: keep
 * those whose box holds a centre; cut boxes into blocks of two by two centres; judge all (triangle, block)
 * pairs at once; divide for the centres inside. Boxes of more than a few centres are left to
 * triangle_rows.c.
 *
 * Exactness: corners are taken relative to the block's first centre. With |y|, |z| < 2^23 there and 2^16 from
 * centre to centre edge functions are below 2^50, their sum below 2^52: integers, exact in doubles. The
 * crossing x_a + (dx_b E_ca + dx_c E_ab) / (E_bc + E_ca + E_ab) has weights of one sign, so its error stays
 * below 4 * 2^-53 * 2^32 + 2^-22 < 2^-18 fixed-point steps; nearer than that to a centre, and for larger
 * triangles, 128-bit integers decide (covered_rows.h).
 * Guarantee: the exact crossings; the vector code is the same code, compiled for wider registers. */
#include "solid/solid.h"

enum { CROSS_SMALL = 1 << 23 };

/* Corners of n triangles, whatever the index type; returns the greatest index. */
BVXI_VECTOR_INLINE uint64_t read_corners(const bvx_mesh_view *view, uint64_t begin, uint32_t n,
                                         uint32_t *corner)
{
    uint64_t greatest = 0;

    if (bvxi_view_packed_u32(view)) {
        uint32_t most = 0;
        memcpy(corner, bvxi_view_index_at(view, begin), (size_t)n * 12);
        for (uint32_t i = 0; i < 3 * n; i++) most = corner[i] > most ? corner[i] : most;
        return most;
    }

    /* Only the greatest index is returned: one comparison of it stands for a check of every corner. */
    for (uint32_t i = 0; i < n; i++) {
        uint64_t raw[3];
        bvxi_view_raw_triangle(view, begin + i, raw);
        for (uint32_t c = 0; c < 3; c++) {
            corner[3 * i + c] = (uint32_t)raw[c];
            if (raw[c] > greatest) greatest = raw[c];
        }
    }
    return greatest;
}

/* Keep the triangles whose cells differ in y and in z: their box holds a centre. */
BVXI_VECTOR_INLINE uint32_t keep_covering(const uint32_t *BVXI_RESTRICT cell,
                                          bvxi_cross_batch *BVXI_RESTRICT b, uint32_t n)
{
    uint32_t count = 0;

    for (uint32_t i = 0; i < n; i++) {
        uint32_t const ca = cell[b->corner[3 * i]];
        uint32_t const cb = cell[b->corner[3 * i + 1]];
        uint32_t const cc = cell[b->corner[3 * i + 2]];
        uint32_t const differ = (ca ^ cb) | (ca ^ cc);

        /* Written in any case and counted only where it covers a row: a branch here would be guessed wrongly
         * half of the time. */
        b->kept[count] = (uint16_t)i;
        b->x[0][count] = (int32_t)ca;
        b->x[1][count] = (int32_t)cb;
        b->x[2][count] = (int32_t)cc;
        count += (uint32_t)((differ & 0xffff) != 0) & (uint32_t)(differ > 0xffff);
    }
    return count;
}

/* The kept triangles' boxes. */
BVXI_VECTOR_INLINE void measure_boxes(bvxi_cross_batch *b, uint32_t kept)
{
    /* Whole vectors; what is past the end is computed and never read. */
    uint32_t const n = (kept + 7u) & ~7u;

    for (uint32_t i = 0; i < n; i++) {
        int32_t const ya = b->x[0][i] & 0xffff, yb = b->x[1][i] & 0xffff, yc = b->x[2][i] & 0xffff;
        int32_t const za = (int32_t)((uint32_t)b->x[0][i] >> 16);
        int32_t const zb = (int32_t)((uint32_t)b->x[1][i] >> 16);
        int32_t const zc = (int32_t)((uint32_t)b->x[2][i] >> 16);
        int32_t const y_low = ya < yb ? ya : yb;
        int32_t const y_high = ya < yb ? yb : ya;
        int32_t const z_low = za < zb ? za : zb;
        int32_t const z_high = za < zb ? zb : za;
        int32_t const j0 = y_low < yc ? y_low : yc, j1 = y_high > yc ? y_high : yc;
        int32_t const k0 = z_low < zc ? z_low : zc, k1 = z_high > zc ? z_high : zc;
        b->j0[i] = j0;
        b->k0[i] = k0;
        b->tall[i] = j1 - j0;
        b->deep[i] = k1 - k0;
    }
}

/* Which of each block's centres lie inside; a projection without area has signs that differ, or cells that agree. All
 * where doubles cannot decide. */
BVXI_VECTOR_INLINE void judge_blocks(bvxi_cross_batch *b, uint32_t from, double step)
{
    uint32_t const n = from + ((b->count - from + 7u) & ~7u);

    for (uint32_t i = from; i < n; i++)
        b->inside[i] = bvxi_judge_block((double)b->y[0][i], (double)b->z[0][i], (double)b->y[1][i],
                                        (double)b->z[1][i], (double)b->y[2][i], (double)b->z[2][i], step,
                                        &b->area[i]);
    for (uint32_t i = from; i < n; i++) {
        int32_t const ay = b->y[0][i], by = b->y[1][i], cy = b->y[2][i];
        int32_t const az = b->z[0][i], bz = b->z[1][i], cz = b->z[2][i];
        b->spread[i] = (ay < 0 ? ~ay : ay) | (by < 0 ? ~by : by) | (cy < 0 ? ~cy : cy) | (az < 0 ? ~az : az) |
                       (bz < 0 ? ~bz : bz) | (cz < 0 ? ~cz : cz);
    }
}

/* The exact answer for a pair that doubles cannot decide: 0 outside, 1 inside with its code. */
BVXI_COLD static int cross_exactly(const bvxi_solid_job *job, const uint32_t *corner, uint32_t row,
                                   int32_t *code)
{
    int32_t const f = job->fraction_bits, half = 1 << (f - 1);
    int32_t const j = job->block.y0 + (int32_t)(row & 0xffff);
    int32_t const k = job->block.z0 + (int32_t)(row >> 16);
    int64_t const y = ((int64_t)j << f) + half, z = ((int64_t)k << f) + half;
    const int32_t *const xyz = job->snapped.xyz;
    bvxi_triangle t;

    if (!bvxi_triangle_setup(xyz + 3 * (size_t)corner[0], xyz + 3 * (size_t)corner[1],
                             xyz + 3 * (size_t)corner[2], &t))
        return 0;
    bvxi_triangle_walk(&t, job->snapped.axis);
    for (int32_t i = 0; i < 3; i++) {
        const int32_t *const u = t.p[i], *const v = t.p[i == 2 ? 0 : i + 1];
        int64_t const dy = (int64_t)v[1] - u[1], dz = (int64_t)v[2] - u[2];
        int64_t const e = dy * (z - u[2]) - dz * (y - u[1]);
        /* dz = 0: the lower edge, since no centre of the box is as high as the upper */
        if (e < 0 || (e == 0 && dz > 0)) return 0;
    }
    *code = (int32_t)((uint32_t)bvxi_cross_exact(&t, f, j, k) << 1 | (uint32_t)t.leaving);
    return 1;
}

/* Judge the blocks from one on and write the crossings of centres inside; the buffer has room for all. */
BVXI_VECTOR_INLINE void flush_blocks(const bvxi_solid_job *job, bvxi_cross_batch *b, uint32_t from)
{
    int32_t const f = job->fraction_bits, step = 1 << f, half = step >> 1;
    double const scale = 1.0 / (double)step, near_centre = scale / 262144.0;
    bvxi_crossing *out = b->found + b->found_count;
    uint32_t hits = 0;

    judge_blocks(b, from, (double)step);

    /* Again without a branch: the hits are listed first, so that only they pay for a division. */
    for (uint32_t i = from; i < b->count; i++) {
        uint32_t const inside = (b->spread[i] < CROSS_SMALL ? (uint32_t)b->inside[i] : 15u) & b->centres[i];
        for (uint32_t c = 0; c < 4; c++)
            b->hit[hits + c] = (uint16_t)(4 * i + bvxi_inside_centres[inside][c]);
        hits += bvxi_inside_count[inside];
    }
    for (uint32_t n = 0; n < hits; n++) {
        uint32_t const i = b->hit[n] >> 2, j = b->hit[n] & 1, k = b->hit[n] >> 1 & 1;
        uint32_t const row = b->row[i] + (k << 16 | j), m = b->triangle[i];
        int32_t const ax = b->x[0][m], y = j != 0 ? step : 0, z = k != 0 ? step : 0;
        double const ay = (double)(b->y[0][i] - y), az = (double)(b->z[0][i] - z);
        double const by = (double)(b->y[1][i] - y), bz = (double)(b->z[1][i] - z);
        double const cy = (double)(b->y[2][i] - y), cz = (double)(b->z[2][i] - z);
        double const bx = (double)(b->x[1][m] - ax), cx = (double)(b->x[2][m] - ax);
        double const q = (bx * (cy * az - ay * cz) + cx * (ay * bz - by * az)) / b->area[i];
        double const v = (q + (double)(ax - half)) * scale;
        int32_t down, code;
        out->row = row;
        if (BVXI_LIKELY(b->spread[i] < CROSS_SMALL)) {
            /* Floor without a call. Only a fraction close to a centre could be rounded to its other side, and
             * those go the exact way. */
            down = (int32_t)v - (v < (double)(int32_t)v);
            double const part = v - (double)down;
            if (BVXI_LIKELY(part > near_centre) && BVXI_LIKELY(part < 1.0 - near_centre)) {
                out->code = (int32_t)((uint32_t)(down + 1) << 1 | (uint32_t)(b->area[i] > 0));
                out++;
                continue;
            }
        }
        if (cross_exactly(job, b->corner + 3 * (size_t)b->kept[m], row, &code)) {
            out->code = code;
            out++;
        }
    }
    b->found_count = (uint32_t)(out - b->found);
}

/* The first two by two centres of each kept triangle's box, none where there are many. Corners relative to the centre, so that products of a
 * voxel-sized triangle stay small enough to be exact in doubles. */
BVXI_VECTOR_INLINE void place_blocks(const bvxi_solid_job *job, bvxi_cross_batch *b, uint32_t kept)
{
    const int32_t *const xyz = job->snapped.xyz;
    int32_t const f = job->fraction_bits, half = 1 << (f - 1), y0 = job->block.y0, z0 = job->block.z0;

    for (uint32_t m = 0; m < kept; m++)
        for (int c = 0; c < 3; c++) {
            const int32_t *const p = xyz + 3 * (size_t)b->corner[3 * (size_t)b->kept[m] + (size_t)c];
            b->x[c][m] = p[0];
            b->y[c][m] = p[1];
            b->z[c][m] = p[2];
        }
    for (int c = 0; c < 3; c++)
        for (uint32_t m = 0; m < kept; m++) {
            b->y[c][m] -= (y0 + b->j0[m]) * (1 << f) + half;
            b->z[c][m] -= (z0 + b->k0[m]) * (1 << f) + half;
        }
    for (uint32_t m = 0; m < kept; m++) {
        b->row[m] = (uint32_t)b->k0[m] << 16 | (uint32_t)b->j0[m];
        uint32_t const all = (uint32_t)b->tall[m] * (uint32_t)b->deep[m]; /* below 2^32 */
        b->centres[m] = (uint8_t)((b->tall[m] > 1 ? 3 : 1) * (b->deep[m] > 1 ? 5 : 1) *
                                  (all <= BVXI_CROSS_FEW));
        b->triangle[m] = (uint16_t)m;
    }
    b->count = kept;
}

/* Further centres of kept triangle m's box, (j, k) rows from its first on. */
BVXI_VECTOR_INLINE void push_block(bvxi_cross_batch *b, uint32_t m, int32_t j, int32_t k, int32_t step)
{
    uint32_t const n = b->count++;

    for (int c = 0; c < 3; c++) {
        b->y[c][n] = b->y[c][m] - j * step;
        b->z[c][n] = b->z[c][m] - k * step;
    }
    b->row[n] = b->row[m] + ((uint32_t)k << 16 | (uint32_t)j);
    b->centres[n] = (uint8_t)((b->tall[m] - j > 1 ? 3 : 1) * (b->deep[m] - k > 1 ? 5 : 1));
    b->triangle[n] = (uint16_t)m;
}

static void take_found(void *sink, uint32_t row, int32_t code)
{
    bvxi_cross_batch *const b = sink;
    b->found[b->found_count].row = row;
    b->found[b->found_count++].code = code;
}

/* A triangle of many rows: at once while the buffer has room beside what a
 * batch may need, else left to the tiles. */
static void cross_many(const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b, uint32_t triangle,
                       int64_t pairs)
{
    bvxi_rows const all = {0, job->block.ny, 0, job->block.nz};
    /* Large triangles are left to the tiles, which cut them by rows: one worker would otherwise hold up the
     * round. Others come there too where the buffer is full, which ends the round. */
    b->full |= pairs <= BVXI_CROSS_MANY &&
               b->found_count + (uint32_t)pairs + job->at_once * BVXI_CROSS_FEW > job->buffer;
    if (pairs <= BVXI_CROSS_MANY && !b->full) bvxi_cover_spans(job, all, triangle, take_found, b);
    else chunk->large[chunk->large_count++] = triangle;
}

BVXI_VECTOR_INLINE void cross_triangles(const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b,
                                        uint64_t first, uint32_t n)
{
    uint32_t const kept = keep_covering(job->snapped.cell, b, n);
    uint32_t from = 0;

    measure_boxes(b, kept);
    place_blocks(job, b, kept);
    for (uint32_t m = 0; m < kept; m++) {
        if (BVXI_LIKELY(b->tall[m] <= 2) && BVXI_LIKELY(b->deep[m] <= 2)) continue;
        int64_t const centres = (int64_t)b->tall[m] * b->deep[m];
        if (BVXI_UNLIKELY(centres > BVXI_CROSS_FEW)) {
            cross_many(job, chunk, b, (uint32_t)(first + b->kept[m]), centres);
            continue;
        }
        /* Most triangles of a scan have one block; a needle of few centres has at most one for each two. */
        if (b->count + BVXI_CROSS_FEW / 2 > BVXI_CROSS_BATCH - 8) {
            flush_blocks(job, b, from);
            b->count = from = kept;
        }
        for (int32_t k = 0; k < b->deep[m]; k += 2)
            for (int32_t j = k == 0 ? 2 : 0; j < b->tall[m]; j += 2)
                push_block(b, m, j, k, 1 << job->fraction_bits);
    }
    flush_blocks(job, b, from);
}

/* The tile of a row. */
BVXI_VECTOR_INLINE uint32_t tile_of_row(const bvxi_solid_job *job, uint32_t row)
{
    return (row >> 16 >> job->tiles.z_shift) * (uint32_t)job->tiles.tiles_y +
           ((row & 0xffff) >> job->tiles.y_shift);
}

/* Counting sort by tile. */
BVXI_VECTOR_INLINE void sort_by_tile(const bvxi_solid_job *job, bvxi_chunk *chunk, const bvxi_cross_batch *b)
{
    uint32_t place[BVXI_SOLID_TILES], total = 0;

    memset(place, 0, sizeof place);
    for (uint32_t i = 0; i < b->found_count; i++) place[tile_of_row(job, b->found[i].row)]++;

    /* Each tile then finds its crossings in one stretch of every chunk, and no two workers write one row. */
    for (int32_t t = 0; t < job->tiles.count; t++) {
        uint32_t const n = place[t];
        chunk->tile_end[t] = place[t] = total;
        total += n;
    }
    chunk->tile_end[job->tiles.count] = total;
    for (uint32_t i = 0; i < b->found_count; i++)
        chunk->sorted[place[tile_of_row(job, b->found[i].row)]++] = b->found[i];
}

BVXI_VECTOR_INLINE void find_crossings(const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b)
{
    b->count = b->found_count = chunk->large_count = 0;
    b->full = 0;
    while (chunk->next < chunk->end && !b->full) {
        uint64_t const left = chunk->end - chunk->next;
        uint32_t const n = left < job->at_once ? (uint32_t)left : job->at_once;
        /* at worst every triangle has BVXI_CROSS_FEW crossings, or is large */
        if (b->found_count + n * BVXI_CROSS_FEW > job->buffer || chunk->large_count + n > BVXI_SOLID_LARGE)
            break;

        /* An index beyond the vertices: only now is it worth finding out which triangle has it. */
        if (read_corners(job->view, chunk->next, n, b->corner) >= job->view->vertex_count) {
            uint32_t unused[3];
            while (bvxi_view_triangle(job->view, chunk->next, unused)) chunk->next++;
            chunk->bad = chunk->next;
            break;
        }
        cross_triangles(job, chunk, b, chunk->next, n);
        chunk->next += n;
    }
    sort_by_tile(job, chunk, b);
}

BVXI_AVX2_COPY(find_crossings_avx2, (const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b),
               find_crossings(job, chunk, b))

void bvxi_find_crossings(void *user, int32_t chunk, int32_t worker)
{
    const bvxi_solid_job *const job = user;
    bvxi_cross_batch *const batch = job->batch + worker;

    BVXI_PATH(job->cpu == BVX_CPU_AVX2, find_crossings(job, job->chunk + chunk, batch),
              find_crossings_avx2(job, job->chunk + chunk, batch));
}
