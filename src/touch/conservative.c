/* conservative.c - every voxel whose closed box meets a triangle.
 *
 * Source: Schwarz, Seidel. Fast Parallel Surface and Solid Voxelization on GPUs. 2010: box and triangle meet
 * when their boxes meet, the plane meets the box, and the projections onto the three coordinate planes meet.
 * In integers, for all voxels of a triangle's box at once.
 *
 * Scanned triangles are about as large as a voxel. So triangles come in batches and are sorted by the shape
 * of their boxes:
 *   a box that is longer than one voxel along one axis at most: the triangle touches all of it;
 *   up to two voxels along each axis, or up to three: one bit for each voxel that an edge or the plane
 *   misses, by loops without branches (touch_cells.h); along two axes one projection decides, along three all
 *   and the plane;
 *   larger: runs by divisions (touch_rows.c).
 * Guarantee: exact, closed sets, for every triangle, also without area. */
#include "touch/touch_cells.h"

/* What is done with a triangle. TWO and THREE: up to so many voxels along
 * each axis; the letters: longer than one there. */
enum {
    TOUCH_TWO_BOX = 0,
    TOUCH_TWO_XY,
    TOUCH_TWO_XZ,
    TOUCH_TWO_YZ,
    TOUCH_TWO_XYZ,
    TOUCH_THREE_XY,
    TOUCH_THREE_XZ,
    TOUCH_THREE_YZ,
    TOUCH_THREE_XYZ,
    TOUCH_LONG_BOX,
    TOUCH_LARGE,
    TOUCH_SHAPES
};

/* By extent (up to two, up to three, more), then by the axes along which
 * the box is longer than one voxel: x + 2 y + 4 z. */
static const uint8_t touch_shape[3][8] = {{TOUCH_TWO_BOX, TOUCH_TWO_BOX, TOUCH_TWO_BOX, TOUCH_TWO_XY,
                                           TOUCH_TWO_BOX, TOUCH_TWO_XZ, TOUCH_TWO_YZ, TOUCH_TWO_XYZ},
                                          {TOUCH_LONG_BOX, TOUCH_LONG_BOX, TOUCH_LONG_BOX, TOUCH_THREE_XY,
                                           TOUCH_LONG_BOX, TOUCH_THREE_XZ, TOUCH_THREE_YZ, TOUCH_THREE_XYZ},
                                          {TOUCH_LONG_BOX, TOUCH_LONG_BOX, TOUCH_LONG_BOX, TOUCH_LARGE,
                                           TOUCH_LONG_BOX, TOUCH_LARGE, TOUCH_LARGE, TOUCH_LARGE}};

/* Octants and cells of a box by its voxels along each axis. */
static const uint8_t octants_along[3][2] = {{0x55, 0xff}, {0x33, 0xff}, {0x0f, 0xff}};
static const uint32_t cells_along[3][3] = {
    {0x1249249, 0x36db6db, 0x7ffffff}, {0x01c0e07, 0x0fc7e3f, 0x7ffffff}, {0x00001ff, 0x003ffff, 0x7ffffff}};

typedef struct touch_work {
    bvxi_touch_batch batch;
    uint16_t list[TOUCH_SHAPES][BVXI_TOUCH_BATCH];
    uint32_t count[TOUCH_SHAPES];
    uint8_t shape[BVXI_TOUCH_BATCH];
    uint32_t hit[BVXI_TOUCH_BATCH]; /* of the small ones: octants or cells that they touch */
    /* corner, axis: of the listed ones, about their octants' or cells' middle */
    double corner[3][3][BVXI_TOUCH_BATCH];
    int64_t missed[BVXI_TOUCH_BATCH];
} touch_work;

/* Where a tile's words lie. */
typedef struct touch_place {
    bvxi_surface_tile *tile;
    uint64_t *words; /* of the tile's first row */
    uint64_t row_words, slice_words;
    uint32_t nx, ny, nz; /* voxels of the tile */
    int32_t j0, k0;
} touch_place;

/* Corners of listed triangles about the point where their boxes' two voxels meet, or the middle of three. */
BVXI_VECTOR_INLINE void centre_corners(const bvxi_surface_job *job, touch_work *w, int shape, int thirds,
                                       int axes)
{
    const uint16_t *const list = w->list[shape];
    int32_t const f = job->fraction_bits, from_low = thirds ? (3 << f) >> 1 : 1 << f;

    /* The middle is a whole number at both kinds of boxes, as F is at least 1. */
    for (int a = 0; a < 3; a++) {
        if ((axes >> a & 1) == 0) continue;
        for (uint32_t i = 0; i < w->count[shape]; i++) {
            uint32_t const m = list[i];
            int32_t const middle = w->batch.low[a][m] * (1 << f) + from_low;
            for (int c = 0; c < 3; c++) w->corner[c][a][i] = (double)(w->batch.p[c][a][m] - middle);
        }
    }
}

BVXI_VECTOR_INLINE void judge_projection(touch_work *w, uint32_t n, int u, int v, int thirds, double side)
{
    for (uint32_t i = 0; i < n; i++) {
        double const a[3] = {w->corner[0][0][i], w->corner[0][1][i], w->corner[0][2][i]};
        double const b[3] = {w->corner[1][0][i], w->corner[1][1][i], w->corner[1][2][i]};
        double const c[3] = {w->corner[2][0][i], w->corner[2][1][i], w->corner[2][2][i]};
        w->missed[i] |= thirds ? bvxi_projection_cells(a, b, c, u, v, side)
                               : bvxi_projection_octants(a, b, c, u, v);
    }
}

BVXI_VECTOR_INLINE void judge_plane(touch_work *w, uint32_t n, int thirds, double side)
{
    for (uint32_t i = 0; i < n; i++) {
        double const a[3] = {w->corner[0][0][i], w->corner[0][1][i], w->corner[0][2][i]};
        double const b[3] = {w->corner[1][0][i], w->corner[1][1][i], w->corner[1][2][i]};
        double const c[3] = {w->corner[2][0][i], w->corner[2][1][i], w->corner[2][2][i]};
        w->missed[i] |= thirds ? bvxi_plane_cells(a, b, c, side) : bvxi_plane_octants(a, b, c);
    }
}

static void write_large(const touch_place *place, const touch_work *w, uint32_t m)
{
    int32_t p[3][3];
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++) p[c][a] = w->batch.p[c][a][m];
    bvxi_touch_rows(place->tile, (const int32_t(*)[3])p, w->batch.triangle[m]);
}

/* Voxels of a cube of side n by bits x + n y + n^2 z, cut to window and tile. */
static void write_cube_cut(const touch_place *place, const touch_work *w, uint32_t m, int32_t n)
{
    const bvxi_touch_batch *const b = &w->batch;
    bvxi_surface_job *const job = place->tile->job;
    int32_t const x = b->low[0][m], y = b->low[1][m], z = b->low[2][m];
    uint32_t hit = w->hit[m];

    /* The bits of the cube, a row of n at a time, upwards. */
    for (int32_t i = 0; hit != 0; i++, hit >>= n) {
        int32_t const j = y + i % n, k = z + i / n;
        uint32_t const row = hit & ((1u << n) - 1);
        if (row == 0 || (uint32_t)(j - place->j0) >= place->ny || (uint32_t)(k - place->k0) >= place->nz)
            continue;
        for (int32_t u = 0; u < n; u++)
            if ((row >> u & 1) != 0 && (uint32_t)(x + u) < place->nx)
                bvxi_touch_voxel(job, x + u, j, k, b->triangle[m]);
    }
}

/* The same, setting bits: a cube inside the tile whose rows lie in one word
 * each goes without looking at its voxels. */
BVXI_VECTOR_INLINE void write_cube(const touch_place *place, const touch_work *w, uint32_t m, int32_t n)
{
    const bvxi_touch_batch *const b = &w->batch;
    uint32_t const x = (uint32_t)b->low[0][m];
    uint32_t const y = (uint32_t)(b->low[1][m] - place->j0);
    uint32_t const z = (uint32_t)(b->low[2][m] - place->k0);
    uint32_t const last = (uint32_t)n - 1, bit = x & 63, hit = w->hit[m];

    /* All comparisons without a jump between them: nearly every cube lies inside. */
    if (BVXI_LIKELY((x < place->nx) & (x + last < place->nx) & (bit + last < 64) & (y < place->ny) &
                    (y + last < place->ny) & (z < place->nz) & (z + last < place->nz))) {
        uint64_t *const word = place->words +
                               ((size_t)z * place->slice_words + (size_t)y * place->row_words + (x >> 6));
        for (int32_t k = 0; k < n; k++)
            for (int32_t j = 0; j < n; j++)
                word[(size_t)k * place->slice_words + (size_t)j * place->row_words] |=
                    (uint64_t)(hit >> (n * (j + n * k)) & ((1u << n) - 1)) << bit;
        return;
    }
    write_cube_cut(place, w, m, n);
}

/* A box that is thick along one axis at most is touched in all its voxels. */
static void write_box(const touch_place *place, const touch_work *w, uint32_t m)
{
    const bvxi_touch_batch *const b = &w->batch;
    bvxi_surface_job *const job = place->tile->job;
    bvxi_rows const *const rows = &place->tile->rows;
    /* The box, cut to the window along x and to the tile along y and z. */
    int32_t const x0 = b->low[0][m] > 0 ? b->low[0][m] : 0;
    int32_t const x1 = b->high[0][m] < job->size[0] ? b->high[0][m] : job->size[0] - 1;
    int32_t const j0 = b->low[1][m] > rows->j0 ? b->low[1][m] : rows->j0;
    int32_t const j1 = b->high[1][m] < rows->j1 ? b->high[1][m] : rows->j1 - 1;
    int32_t const k0 = b->low[2][m] > rows->k0 ? b->low[2][m] : rows->k0;
    int32_t const k1 = b->high[2][m] < rows->k1 ? b->high[2][m] : rows->k1 - 1;

    if (x0 > x1) return;
    for (int32_t k = k0; k <= k1; k++)
        for (int32_t j = j0; j <= j1; j++) bvxi_touch_run(job, j, k, x0, x1, b->triangle[m]);
}

BVXI_VECTOR_INLINE void list_by_shape(touch_work *w, uint32_t n)
{
    const bvxi_touch_batch *const b = &w->batch;

    memset(w->count, 0, sizeof w->count);
    /* The shape decides which test is needed, so triangles of one shape are judged together by one loop. */
    for (uint32_t i = 0; i < n; i++) {
        int32_t const x = b->high[0][i] - b->low[0][i];
        int32_t const y = b->high[1][i] - b->low[1][i];
        int32_t const z = b->high[2][i] - b->low[2][i];
        int32_t const size = (x > 1) | (y > 1) | (z > 1), large = (x > 2) | (y > 2) | (z > 2);
        uint8_t const shape = touch_shape[size + large][(x > 0) + 2 * (y > 0) + 4 * (z > 0)];
        w->shape[i] = shape;
        w->list[shape][w->count[shape]++] = (uint16_t)i;
    }
}

/* Octants or cells of a small triangle's box. */
static inline uint32_t whole_box(const bvxi_touch_batch *b, uint32_t m, int thirds)
{
    int32_t const x = b->high[0][m] - b->low[0][m];
    int32_t const y = b->high[1][m] - b->low[1][m];
    int32_t const z = b->high[2][m] - b->low[2][m];
    return thirds ? cells_along[0][x] & cells_along[1][y] & cells_along[2][z]
                  : (uint32_t)octants_along[0][x] & octants_along[1][y] & octants_along[2][z];
}

/* Octants or cells that triangles touch whose boxes are thick along two axes or three. The axes are not
 * constants here: each test is long code, made once for boxes of two voxels and once for three. */
BVXI_VECTOR_INLINE void judge_thick_boxes(const bvxi_surface_job *job, touch_work *w, int first_shape,
                                          int thirds)
{
    static const int axes_of[4] = {3, 5, 6, 7};
    double const side = (double)(1 << job->fraction_bits);

    for (int s = 0; s < 4; s++) {
        int const shape = first_shape + s, axes = axes_of[s];
        uint32_t const n = w->count[shape];

        /* Only the axes that the tests of this shape look at are centred. */
        centre_corners(job, w, shape, thirds, axes);
        memset(w->missed, 0, n * sizeof *w->missed);
        if ((axes & 3) == 3) judge_projection(w, n, 0, 1, thirds, side);
        if ((axes & 5) == 5) judge_projection(w, n, 0, 2, thirds, side);
        if ((axes & 6) == 6) judge_projection(w, n, 1, 2, thirds, side);
        if (axes == 7) judge_plane(w, n, thirds, side);

        /* What no edge and no plane misses, within the triangle's own box. */
        for (uint32_t i = 0; i < n; i++) {
            uint32_t const m = w->list[shape][i];
            w->hit[m] = whole_box(&w->batch, m, thirds) & ~(uint32_t)w->missed[i];
        }
    }
}

/* Bits may be set in any order. */
BVXI_VECTOR_INLINE void write_by_shape(const touch_place *place, const touch_work *w)
{
    for (int shape = TOUCH_TWO_BOX; shape <= TOUCH_TWO_XYZ; shape++)
        for (uint32_t i = 0; i < w->count[shape]; i++) write_cube(place, w, w->list[shape][i], 2);
    for (int shape = TOUCH_THREE_XY; shape <= TOUCH_THREE_XYZ; shape++)
        for (uint32_t i = 0; i < w->count[shape]; i++) write_cube(place, w, w->list[shape][i], 3);
    for (uint32_t i = 0; i < w->count[TOUCH_LONG_BOX]; i++) write_box(place, w, w->list[TOUCH_LONG_BOX][i]);
    for (uint32_t i = 0; i < w->count[TOUCH_LARGE]; i++) write_large(place, w, w->list[TOUCH_LARGE][i]);
}

BVXI_VECTOR_INLINE void touch_all(const touch_place *place, const uint32_t *id, uint64_t count)
{
    const bvxi_surface_job *const job = place->tile->job;
    touch_work w;

    for (uint64_t done = 0; done < count; done += BVXI_TOUCH_BATCH) {
        /* A batch at a time: its arrays stay in the nearest cache from step to step. */
        uint32_t const n = (uint32_t)(count - done < BVXI_TOUCH_BATCH ? count - done : BVXI_TOUCH_BATCH);
        bvxi_batch_gather(job, id, done, n, &w.batch);
        bvxi_batch_boxes(&w.batch, n, job->fraction_bits, -1, 0);
        list_by_shape(&w, n);
        for (uint32_t i = 0; i < w.count[TOUCH_TWO_BOX]; i++) {
            uint32_t const m = w.list[TOUCH_TWO_BOX][i];
            w.hit[m] = whole_box(&w.batch, m, 0);
        }
        judge_thick_boxes(job, &w, TOUCH_TWO_XY, 0);
        judge_thick_boxes(job, &w, TOUCH_THREE_XY, 1);
        if (job->task == BVXI_TOUCH_SET) write_by_shape(place, &w);
        else {
            /* Attached triangles must come as they are numbered. */
            for (uint32_t m = 0; m < n; m++) {
                if (w.shape[m] == TOUCH_LARGE) write_large(place, &w, m);
                else if (w.shape[m] == TOUCH_LONG_BOX) write_box(place, &w, m);
                else write_cube_cut(place, &w, m, w.shape[m] <= TOUCH_TWO_XYZ ? 2 : 3);
            }
        }
    }
}

BVXI_AVX2_COPY(touch_all_avx2, (const touch_place *place, const uint32_t *id, uint64_t count),
               touch_all(place, id, count))

void bvxi_touch_conservative(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count)
{
    bvxi_surface_job *const job = tile->job;
    touch_place place;

    place.tile = tile;
    place.words = bvxi_surface_row(job, tile->rows.j0, tile->rows.k0);

    place.row_words = (uint64_t)job->grid->words_per_row;
    place.slice_words = place.row_words * (uint64_t)job->size[1];
    place.nx = (uint32_t)job->size[0];
    place.ny = (uint32_t)(tile->rows.j1 - tile->rows.j0);
    place.nz = (uint32_t)(tile->rows.k1 - tile->rows.k0);
    place.j0 = tile->rows.j0;
    place.k0 = tile->rows.k0;
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, touch_all(&place, id, count), touch_all_avx2(&place, id, count));
}
