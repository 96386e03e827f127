/* tile_bins.c - triangles sorted by the tiles of rows that their boxes reach.
 *
 * A counting sort in two passes over pieces of the triangles; pieces and tiles are in order, so a tile's
 * triangles are ascending for any number of threads. A single tile takes the triangles as they come.
 * Guarantee: every triangle that touches a tile's rows (closed boxes) is in its bin. */
#include "touch/surface_voxels.h"

enum { BIN_PIECES = 64, BIN_GRAIN = 8192, OUTSIDE = 254 };

typedef struct bin_job {
    bvxi_surface_job *job;
    int32_t pieces;
    uint64_t bad[BIN_PIECES];
    uint64_t next[BIN_PIECES][BVXI_SURFACE_TILES]; /* counts, then places */
    int fill;
} bin_job;

static void cell_piece_of_bins(void *user, uint64_t begin, uint64_t end)
{
    bin_job *const b = user;

    /* The tiles of a vertex: each of its rows and slices that its closed boxes reach, cut to one beyond
     * the window's ends. As bytes: the least tile along y, least along z, and 255 less the greatest ones, so
     * that bytewise least is what a triangle needs. */
    const bvxi_surface_job *const job = b->job;
    const int32_t *const xyz = job->snapped.xyz;
    int32_t const f = job->fraction_bits;

    for (uint64_t v = begin; v < end; v++) {
        uint32_t byte[4];
        for (int a = 1; a < 3; a++) {
            int32_t const q = xyz[3 * v + (uint64_t)a];
            int32_t const shift = a == 1 ? job->tiles.y_shift : job->tiles.z_shift;
            int32_t low = bvxi_floor_shift(q - 1, f) - job->low[a];
            int32_t high = bvxi_floor_shift(q, f) - job->low[a];
            /* One beyond the window's ends stands for all that lies outside, so the tile fits in a byte. */
            low = low < -1 ? -1 : low > job->size[a] ? job->size[a] : low;
            high = high < -1 ? -1 : high > job->size[a] ? job->size[a] : high;
            byte[a - 1] = (uint32_t)(low < 0 ? 0 : low >= job->size[a] ? OUTSIDE : 1 + (low >> shift));
            byte[a + 1] = 255 - (uint32_t)(high < 0               ? 0
                                           : high >= job->size[a] ? OUTSIDE
                                                                  : 1 + (high >> shift));
        }
        b->job->snapped.cell[v] = byte[0] | byte[1] << 8 | byte[2] << 16 | byte[3] << 24;
    }
}

static inline uint32_t least_byte(uint32_t p, uint32_t q, uint32_t r, int shift)
{
    uint32_t const a = p >> shift & 255, b = q >> shift & 255, c = r >> shift & 255;
    uint32_t const m = a < b ? a : b;
    return m < c ? m : c;
}

static void bin_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    bin_job *const b = user;
    bvxi_surface_job *const job = b->job;
    const uint32_t *const cell = job->snapped.cell;
    uint64_t *const next = b->next[index];

    for (uint64_t t = begin; t < end; t++) {
        uint32_t corner[3];
        /* An index beyond the vertices: the piece ends, and the first one of all pieces is reported. */
        if (!bvxi_view_triangle(job->view, t, corner)) {
            b->bad[index] = t;
            return;
        }
        if (job->tiles.count == 1) continue;

        uint32_t const p = cell[corner[0]], q = cell[corner[1]], r = cell[corner[2]];
        int32_t const y0 = (int32_t)least_byte(p, q, r, 0), y1 = 255 - (int32_t)least_byte(p, q, r, 16);
        int32_t const z0 = (int32_t)least_byte(p, q, r, 8), z1 = 255 - (int32_t)least_byte(p, q, r, 24);
        /* Wholly before the window or after it, along y or z. */
        if (y1 == 0 || z1 == 0 || y0 == OUTSIDE || z0 == OUTSIDE) continue;
        int32_t const v0 = y0 > 0 ? y0 - 1 : 0, u0 = z0 > 0 ? z0 - 1 : 0;
        int32_t const v1 = y1 <= job->tiles.tiles_y ? y1 - 1 : job->tiles.tiles_y - 1;
        int32_t const u1 = z1 <= job->tiles.tiles_z ? z1 - 1 : job->tiles.tiles_z - 1;
        /* The same walk counts first and fills then, so both agree on every place. */
        for (int32_t u = u0; u <= u1; u++)
            for (int32_t v = v0; v <= v1; v++) {
                int32_t const tile = u * job->tiles.tiles_y + v;
                if (b->fill) job->bins.id[next[tile]] = (uint32_t)t;
                next[tile]++;
            }
    }
}

static bvx_status run_bins(bvx_context *ctx, const char *function, bin_job *b)
{
    BVXI_TRY(
        bvxi_for_pieces(ctx, "surface", 0.1, 0.2, b->pieces, b->job->view->triangle_count, bin_piece, b));
    /* The order of pieces is that of triangles: the message names the first that is wrong. */
    for (int32_t i = 0; i < b->pieces; i++)
        if (b->bad[i] != UINT64_MAX) return bvxi_view_fail_index(ctx, function, b->job->view, b->bad[i]);
    return BVX_OK;
}

bvx_status bvxi_bins_open(bvx_context *ctx, const char *function, bvxi_surface_job *job)
{
    bin_job *b;

    /* One tile takes triangles as they come, and needs no list; what has filled a solid has been checked. */
    job->bins.end[1] = job->view->triangle_count;
    if (job->tiles.count == 1 && job->solid != NULL) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *b, "the triangles' counts", &b));
    b->job = job;
    b->pieces = bvxi_piece_count(job->view->triangle_count, BIN_GRAIN);
    if (b->pieces > BIN_PIECES) b->pieces = BIN_PIECES;
    for (int32_t i = 0; i < BIN_PIECES; i++) b->bad[i] = UINT64_MAX;
    BVXI_TRY(job->tiles.count > 1 ? bvxi_for_ranges(ctx, "surface", 0.1, 0.1, b->pieces,
                                                    job->view->vertex_count, cell_piece_of_bins, b)
                                  : BVX_OK);
    BVXI_TRY(run_bins(ctx, function, b)); /* one tile: a check of the indices */
    if (job->tiles.count == 1) return BVX_OK;

    /* Counts become places, so the second walk knows where each triangle goes. Tiles outermost, so that a tile's
     * pieces stand side by side in their order. */
    uint64_t total = 0;
    for (int32_t tile = 0; tile < job->tiles.count; tile++) {
        for (int32_t i = 0; i < b->pieces; i++) {
            uint64_t const n = b->next[i][tile];
            b->next[i][tile] = total;
            total += n;
        }
        job->bins.end[tile + 1] = total;
    }
    job->bins.total = total;
    b->fill = 1;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job->bins.total * 4, "the triangles by tile", &job->bins.id));
    return run_bins(ctx, function, b);
}
