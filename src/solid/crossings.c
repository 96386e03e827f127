/* crossings.c - from a chunk of triangles to its crossings with rows of centres.
 *
 * Source: scanline conversion with exact edge functions, after Pineda. A Parallel Algorithm for Polygon
 * Rasterization. 1988.
 *
 * Triangles go in batches that stay in the nearest cache, through steps without unpredictable branches: keep
 * those whose box holds a centre; part boxes of one centre from boxes of several; judge all (triangle,
 * centre) pairs at once; divide for those inside. Boxes of more than a few centres are left to
 * triangle_rows.c.
 *
 * Exactness: corners are taken relative to the centre. With |y|, |z| < 2^23 edge functions are below 2^48,
 * their sum below 2^50: integers, exact in doubles. The crossing x_a + (dx_b E_ca + dx_c E_ab) / (E_bc + E_ca
 * + E_ab) has weights of one sign, so its error stays below 4 * 2^-53 * 2^32 + 2^-22 < 2^-18 fixed-point
 * steps; nearer than that to a centre, and for larger triangles, 128-bit integers decide (covered_rows.h).
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
        b->cell[0][count] = (int32_t)ca;
        b->cell[1][count] = (int32_t)cb;
        b->cell[2][count] = (int32_t)cc;
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
        int32_t const ya = b->cell[0][i] & 0xffff, yb = b->cell[1][i] & 0xffff, yc = b->cell[2][i] & 0xffff;
        int32_t const za = (int32_t)((uint32_t)b->cell[0][i] >> 16);
        int32_t const zb = (int32_t)((uint32_t)b->cell[1][i] >> 16);
        int32_t const zc = (int32_t)((uint32_t)b->cell[2][i] >> 16);
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

/* Edge functions at the centre, and the least and greatest of their signs. Edge (u, v) at 0 is u_y v_z - v_y
 * u_z; a zero has the sign that the displacement gives it: + when dz < 0, or dz = 0 and dy > 0, which is when
 * 2^32 dz - dy < 0. Inside is where the three signs agree; a projection without area has signs that differ,
 * or cells that agree. */
BVXI_VECTOR_INLINE void judge_pairs(bvxi_cross_batch *b)
{
    uint32_t const n = (b->count + 7u) & ~7u;

    for (uint32_t i = 0; i < n; i++) {
        double const ay = (double)b->y[0][i], by = (double)b->y[1][i], cy = (double)b->y[2][i];
        double const az = (double)b->z[0][i], bz = (double)b->z[1][i], cz = (double)b->z[2][i];

        /* Each edge function from both of its ends: triangles that share an edge compute it from the same
         * numbers, so they agree on its sign. */
        double const bc = by * cz - cy * bz, ca = cy * az - ay * cz, ab = ay * bz - by * az;
        double const sbc = bc + ((cz - bz) * 4294967296.0 - (cy - by) < 0 ? 0.5 : -0.5);
        double const sca = ca + ((az - cz) * 4294967296.0 - (ay - cy) < 0 ? 0.5 : -0.5);
        double const sab = ab + ((bz - az) * 4294967296.0 - (by - ay) < 0 ? 0.5 : -0.5);
        double const low = sbc < sca ? sbc : sca, high = sbc < sca ? sca : sbc;

        /* Half a unit stands for the displacement: it decides where the function is 0, and cannot reach the
         * next integer. */
        b->e[0][i] = bc;
        b->e[1][i] = ca;
        b->e[2][i] = ab;
        b->least[i] = low < sab ? low : sab;
        b->most[i] = high > sab ? high : sab;
    }
    for (uint32_t i = 0; i < n; i++) {
        int32_t const ay = b->y[0][i];
        int32_t const by = b->y[1][i];
        int32_t const cy = b->y[2][i];
        int32_t const az = b->z[0][i];
        int32_t const bz = b->z[1][i];
        int32_t const cz = b->z[2][i];
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

/* Judge the pairs and write the crossings of those inside; the buffer has room for all. */
BVXI_VECTOR_INLINE void flush_pairs(const bvxi_solid_job *job, bvxi_cross_batch *b)
{
    const int32_t *const xyz = job->snapped.xyz;
    int32_t const f = job->fraction_bits, half = 1 << (f - 1);
    double const scale = 1.0 / (double)(1 << f), near_centre = scale / 262144.0;
    bvxi_crossing *out = b->found + b->found_count;
    uint32_t hits = 0;

    judge_pairs(b);

    /* Again without a branch: the hits are listed first, so that only they pay for a division. */
    for (uint32_t i = 0; i < b->count; i++) {
        b->hit[hits] = (uint16_t)i;
        hits += (uint32_t)(b->least[i] > 0) | (uint32_t)(b->most[i] < 0) |
                (uint32_t)(b->spread[i] >= CROSS_SMALL);
    }
    for (uint32_t n = 0; n < hits; n++) {
        uint32_t const i = b->hit[n];
        const uint32_t *const corner = b->corner + 3 * (size_t)b->triangle[i];
        int32_t const ax = xyz[3 * (size_t)corner[0]];
        double const bx = (double)(xyz[3 * (size_t)corner[1]] - ax);
        double const cx = (double)(xyz[3 * (size_t)corner[2]] - ax);
        double const area = b->e[0][i] + b->e[1][i] + b->e[2][i];
        double const q = (bx * b->e[1][i] + cx * b->e[2][i]) / area;
        double const v = (q + (double)(ax - half)) * scale;
        int32_t down, code;
        double part;
        out->row = b->row[i];
        if (BVXI_LIKELY(b->spread[i] < CROSS_SMALL)) {
            /* Floor without a call. Only a fraction close to a centre could be rounded to its other side, and
             * those go the exact way. */
            down = (int32_t)v - (v < (double)(int32_t)v);
            part = v - (double)down;
            if (BVXI_LIKELY(part > near_centre) && BVXI_LIKELY(part < 1.0 - near_centre)) {
                out->code = (int32_t)((uint32_t)(down + 1) << 1 | (uint32_t)(b->least[i] > 0));
                out++;
                continue;
            }
        }
        if (cross_exactly(job, corner, b->row[i], &code)) {
            out->code = code;
            out++;
        }
    }
    b->found_count = (uint32_t)(out - b->found);
    b->count = 0;
}

/* One pair of the batch: triangle m at row (j, k). */
BVXI_VECTOR_INLINE void push_pair(const bvxi_solid_job *job, bvxi_cross_batch *b, uint32_t m, int32_t j,
                                  int32_t k)
{
    const int32_t *const xyz = job->snapped.xyz;
    const uint32_t *const c = b->corner + 3 * (size_t)m;
    const int32_t *const pa = xyz + 3 * (size_t)c[0];
    const int32_t *const pb = xyz + 3 * (size_t)c[1];
    const int32_t *const pc = xyz + 3 * (size_t)c[2];
    int32_t const f = job->fraction_bits, half = 1 << (f - 1);
    int32_t const y = (job->block.y0 + j) * (1 << f) + half, z = (job->block.z0 + k) * (1 << f) + half;
    uint32_t const n = b->count++;

    /* Relative to the centre, so that products of a voxel-sized triangle stay small enough to be exact in
     * doubles. */
    b->y[0][n] = pa[1] - y;
    b->z[0][n] = pa[2] - z;
    b->y[1][n] = pb[1] - y;
    b->z[1][n] = pb[2] - z;
    b->y[2][n] = pc[1] - y;
    b->z[2][n] = pc[2] - z;
    b->row[n] = (uint32_t)k << 16 | (uint32_t)j;
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
     * round. */
    if (pairs <= BVXI_CROSS_MANY &&
        b->found_count + (uint32_t)pairs + BVXI_CROSS_BATCH * BVXI_CROSS_FEW <= BVXI_SOLID_BUFFER)
        bvxi_cover_spans(job, all, triangle, take_found, b);
    else chunk->large[chunk->large_count++] = triangle;
}

BVXI_VECTOR_INLINE void cross_triangles(const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b,
                                        uint64_t first, uint32_t n)
{
    uint32_t const kept = keep_covering(job->snapped.cell, b, n);
    uint32_t singles = 0, severals = 0;

    measure_boxes(b, kept);
    for (uint32_t i = 0; i < kept; i++) { /* part the boxes of one centre from the others */
        int const single = (b->tall[i] | b->deep[i]) == 1;
        b->single[singles] = (uint16_t)i;
        b->several[severals] = (uint16_t)i;
        singles += (uint32_t)single;
        severals += (uint32_t)!single;
    }

    /* Most triangles of a scan have one centre in their box; by themselves they need no loop and no test for
     * room. */
    for (uint32_t i = 0; i < singles; i++) {
        uint32_t const m = b->single[i];
        push_pair(job, b, b->kept[m], b->j0[m], b->k0[m]);
    }
    for (uint32_t i = 0; i < severals; i++) {
        uint32_t const m = b->several[i];
        int64_t const pairs = (int64_t)b->tall[m] * b->deep[m];
        if (pairs > BVXI_CROSS_FEW) {
            cross_many(job, chunk, b, (uint32_t)(first + b->kept[m]), pairs);
            continue;
        }
        if (b->count + (uint32_t)pairs > BVXI_CROSS_BATCH) flush_pairs(job, b);
        for (int32_t k = 0; k < b->deep[m]; k++)
            for (int32_t j = 0; j < b->tall[m]; j++)
                push_pair(job, b, b->kept[m], b->j0[m] + j, b->k0[m] + k);
    }
    flush_pairs(job, b);
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
    while (chunk->next < chunk->end) {
        uint32_t const n = (uint32_t)(chunk->end - chunk->next < BVXI_CROSS_BATCH ? chunk->end - chunk->next
                                                                                  : BVXI_CROSS_BATCH);
        /* at worst every triangle has BVXI_CROSS_FEW crossings, or is large */
        if (b->found_count + n * BVXI_CROSS_FEW > BVXI_SOLID_BUFFER ||
            chunk->large_count + n > BVXI_SOLID_LARGE)
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

#if BVXI_HAVE_AVX2
BVXI_AVX2 static void find_crossings_avx2(const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b)
{
    find_crossings(job, chunk, b);
}
#endif

static void find_crossings_portable(const bvxi_solid_job *job, bvxi_chunk *chunk, bvxi_cross_batch *b)
{
    find_crossings(job, chunk, b);
}

void bvxi_find_crossings(void *user, int32_t chunk, int32_t worker)
{
    const bvxi_solid_job *const job = user;
    bvxi_cross_batch *const batch = job->batch + worker;

#if BVXI_HAVE_AVX2
    if (job->cpu == BVX_CPU_AVX2) {
        find_crossings_avx2(job, job->chunk + chunk, batch);
        return;
    }
#endif
    find_crossings_portable(job, job->chunk + chunk, batch);
}
