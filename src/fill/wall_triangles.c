/* wall_triangles.c - the triangles near to places where walls may be thin, and a search among them.
 *
 * Places mark blocks of voxels around them; a triangle is near when the box of its corners' blocks holds a
 * mark. Those near are put in an order that no numbering of the mesh shows in, so that of two equally near
 * ones always the same is found.
 * Guarantee: the search has every triangle that matters to a place, and the same order for any order of the
 * mesh's triangles and any threads. */
#include "fill/thin_walls.h"

#include "mesh/facet.h"
#include "mesh/mesh.h"

#include <math.h>

/* From a place to the centres around it: the root of 3, rounded up [Units: largest spacings] */
#define WALL_BESIDE 1.8

/* Voxels along a block's edge at least; bits of a block's coordinates, of which the highest is 0. */
enum { NEAR_BLOCK = 2, NEAR_BITS = 10, NEAR_MANY_BLOCKS = 512, NEAR_TRIANGLES = 4096, NEAR_PIECES = 64 };

/* What is done to vertices or triangles piece by piece. */
typedef struct near_job {
    bvx_context *ctx;
    const bvx_mesh_view *mesh;
    const bvx_grid *grid; /* of the places */
    int32_t with_area;    /* 1: triangles without area are left out */
    uint64_t *blocks[2];  /* what they hold: BESIDE_MARK, MARK */
    size_t block_words;   /* of a row */
    int32_t block, block_size[3];
    uint32_t *block_of; /* of each vertex, cut to the window: x, y, z, what it holds [Size: vertices] */
    uint32_t *corner;   /* of the triangles taken [Size: triangles * 3] */
    int32_t pieces;

    bvxi_walls *walls; /* from here on: their order */
    uint64_t *keys;    /* of the triangles nearby, by which they are sorted */
    uint32_t *numbers, *sorted;
    uint64_t taken[NEAR_PIECES];                      /* triangles of a piece that are near */
    double low[NEAR_PIECES][3], high[NEAR_PIECES][3]; /* bounds of those of a piece */
} near_job;

static bvx_status run_near(near_job *job, uint64_t count, bvxi_range_fn *body)
{
    bvx_context *const ctx = job->ctx;
    return BVXI_SHARE(ctx, 0.2, 0.2, bvxi_for(ctx, "thin", count, NEAR_TRIANGLES, body, job));
}

static bvx_status run_near_pieces(near_job *job, uint64_t count, bvxi_piece_fn *body)
{
    job->pieces = bvxi_piece_count(count, NEAR_TRIANGLES);
    if (job->pieces > NEAR_PIECES) job->pieces = NEAR_PIECES;
    return bvxi_for_pieces(job->ctx, "thin", 0.2, 0.2, job->pieces, count, body, job);
}

/* ---- which are near ---- */

/* A view of triangles that are listed, over the mesh's vertices. */
static void view_triangles(const bvx_mesh_view *mesh, const uint32_t *corner, uint64_t count,
                           bvx_mesh_view *view)
{
    *view = *mesh;
    view->indices = corner;
    view->index_type = BVX_U32;
    view->index_stride = 0;
    view->triangle_count = count;
}

/* What blocks hold, by bits of a row: of any part of them within reach of a place, or in a block beside. */
enum { BESIDE_MARK = 0, MARK = 1 };

static inline size_t block_word(const near_job *t, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)t->block_size[1] + (size_t)y) * t->block_words + (size_t)(x >> 6);
}

/* Block of a voxel's coordinate, cut to the window. */
static inline int32_t block_at(const near_job *t, int a, double at)
{
    double const b = at / t->block, last = (double)t->block_size[a] - 1;
    return b > 0 ? (int32_t)(b < last ? b : last) : 0;
}

/* From a coordinate to the nearest of a block, squared [Units: world]; sides of the window are open. */
static inline double way_to_block(const near_job *t, int a, double at, int32_t block)
{
    double const low = (double)block * t->block - at, high = at - ((double)block + 1) * t->block;
    double const way = (low > 0 ? low : high > 0 ? high : 0) * t->grid->lattice.spacing[a];
    return way * way;
}

/* The blocks that a ball of this radius about a place meets, and those beside its box. */
static void mark_around(near_job *t, uint64_t bit, double radius)
{
    const double *const spacing = t->grid->lattice.spacing;
    int32_t place[3], from[3], to[3];
    double at[3];

    bvxi_bit_centre(t->grid, bit, place);
    for (int a = 0; a < 3; a++) {
        at[a] = (double)place[a] + 0.5;
        from[a] = block_at(t, a, at[a] - radius / spacing[a]);
        to[a] = block_at(t, a, at[a] + radius / spacing[a]);
    }
    for (int32_t z = from[2]; z <= to[2]; z++)
        for (int32_t y = from[1]; y <= to[1]; y++) {
            double const left = radius * radius - way_to_block(t, 1, at[1], y) - way_to_block(t, 2, at[2], z);
            if (left < 0) continue;
            double const far = sqrt(left) / spacing[0];
            bvxi_set_run(t->blocks[MARK] + block_word(t, 0, y, z), block_at(t, 0, at[0] - far),
                         block_at(t, 0, at[0] + far) + 1);
        }

    for (int a = 0; a < 3; a++) {
        from[a] -= from[a] > 0;
        to[a] += to[a] + 1 < t->block_size[a];
    }
    for (int32_t z = from[2]; z <= to[2]; z++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            bvxi_set_run(t->blocks[BESIDE_MARK] + block_word(t, 0, y, z), from[0], to[0] + 1);
}

/* The block of each vertex; of those that no triangle uses too, whatever they are. */
static void place_piece_in_blocks(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const t = user;
    const bvx_lattice *const l = &t->grid->lattice;
    const uint64_t *const beside = t->blocks[BESIDE_MARK], *const marked = t->blocks[MARK];
    size_t const row = t->block_words, slice = row * (size_t)t->block_size[1];
    int const packed = bvxi_view_packed_f32(t->mesh);
    double low[3], scale[3], last[3];

    for (int a = 0; a < 3; a++) {
        last[a] = (double)(t->block_size[a] - 1);
        low[a] = l->origin[a] + (double)t->grid->low[a] * l->spacing[a];
        scale[a] = 1.0 / (l->spacing[a] * (double)t->block);
    }
    for (uint64_t v = begin; v < end; v++) {
        double p[3];
        int32_t at[3];

        if (packed) {
            float f[3];
            memcpy(f, (const unsigned char *)t->mesh->positions + (size_t)v * 12, sizeof f);
            for (int a = 0; a < 3; a++) p[a] = (double)f[a];
        } else {
            bvxi_view_position(t->mesh, v, p);
        }
        /* Rounded otherwise than a division would be: marks reach further than that. */
        for (int a = 0; a < 3; a++) {
            double const b = (p[a] - low[a]) * scale[a], cut = b < last[a] ? b : last[a];
            at[a] = (int32_t)(cut > 0 ? cut : 0);
        }
        size_t const word = (size_t)at[2] * slice + (size_t)at[1] * row + (size_t)(at[0] >> 6);
        uint64_t const marks = (beside[word] >> (at[0] & 63) & 1) | (marked[word] >> (at[0] & 63) & 1) << 1;
        t->block_of[v] = (uint32_t)at[0] | (uint32_t)at[1] << NEAR_BITS | (uint32_t)at[2] << 2 * NEAR_BITS |
                         (uint32_t)marks << 3 * NEAR_BITS;
    }
}

static inline int32_t wall_block_index(uint32_t block, int axis)
{
    return (int32_t)(block >> axis * NEAR_BITS & ((1u << NEAR_BITS) - 1));
}

/* 1: blocks b and c are a or beside it. The difference of each coordinate, and one more, is added to its highest bit;
 * of both at once. */
static inline int are_blocks_beside(uint32_t a, uint32_t b, uint32_t c)
{
    uint64_t const both = UINT64_C(0x100000001), ones = both * (1u | 1u << NEAR_BITS | 1u << 2 * NEAR_BITS);
    uint64_t const all = both * ((1u << 3 * NEAR_BITS) - 1), high = ones << (NEAR_BITS - 1);
    uint64_t const x = ((both * a & all) | high) - (((uint64_t)b << 32 | c) & all) + ones;
    return (x & ~(3 * ones)) == high && (x & x >> 1 & ones) == 0;
}

static int is_in_marked_block(const near_job *t, const uint32_t c[3])
{
    uint32_t const corner[3] = {t->block_of[c[0]], t->block_of[c[1]], t->block_of[c[2]]};
    int32_t from[3], to[3];

    /* Most triangles lie in one block, or in that and blocks beside it, and no mark is near. */
    if (BVXI_LIKELY(((corner[0] | corner[1] | corner[2]) >> 3 * NEAR_BITS == 0) &
                    are_blocks_beside(corner[0], corner[1], corner[2])))
        return 0;
    if (corner[0] == corner[1] && corner[0] == corner[2]) return (int)(corner[0] >> (3 * NEAR_BITS + 1));
    for (int a = 0; a < 3; a++) {
        int32_t const p = wall_block_index(corner[0], a), q = wall_block_index(corner[1], a);
        int32_t const r = wall_block_index(corner[2], a);
        int32_t const low = p < q ? p : q, high = p < q ? q : p;
        from[a] = r < low ? r : low;
        to[a] = r > high ? r : high;
    }
    /* Very large triangles count without a look. */
    if ((int64_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1) * (to[2] - from[2] + 1) > NEAR_MANY_BLOCKS)
        return 1;
    for (int32_t z = from[2]; z <= to[2]; z++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            for (int32_t x = from[0]; x <= to[0]; x++)
                if ((t->blocks[MARK][block_word(t, x, y, z)] >> (x & 63) & 1) != 0) return 1;
    return 0;
}

/* Each piece writes where its own triangles would stand if all were taken. */
static void take_piece_nearby(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    near_job *const t = user;
    int const packed = bvxi_view_packed_u32(t->mesh);
    uint32_t *to = t->corner + 3 * begin;

    for (uint64_t n = begin; n < end; n++) {
        double p[3][3], normal[3];
        uint32_t c[3];

        if (packed) memcpy(c, (const unsigned char *)t->mesh->indices + (size_t)n * 12, sizeof c);
        else bvxi_view_triangle(t->mesh, n, c);
        if (!is_in_marked_block(t, c)) continue;
        for (int k = 0; k < 3 && t->with_area; k++) bvxi_view_position(t->mesh, c[k], p[k]);
        if (t->with_area && !(bvxi_facet_normal((const double(*)[3])p, normal) > 0)) continue;
        memcpy(to, c, sizeof c);
        to += 3;
    }
    t->taken[piece] = (uint64_t)(to - t->corner) / 3 - begin;
}

bvx_status bvxi_triangles_near(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *places,
                               double reach, int32_t with_area, bvx_mesh_view *near, uint32_t **corner)
{
    near_job job = {.ctx = ctx, .mesh = mesh, .grid = places, .with_area = with_area};
    uint64_t taken = 0;

    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, mesh->triangle_count * 12, "the triangles at thin places", corner));
    job.corner = *corner;

    /* Blocks, so that a triangle is judged by few bytes. */
    uint64_t words;

    job.block = NEAR_BLOCK;
    for (int a = 0; a < 3; a++)
        while (job.grid->size[a] / job.block >= 1 << (NEAR_BITS - 1)) job.block *= 2;
    for (int a = 0; a < 3; a++) job.block_size[a] = job.grid->size[a] / job.block + 1;
    job.block_words = (size_t)job.block_size[0] / 64 + 1;
    words = (uint64_t)job.block_words * (uint64_t)job.block_size[1] * (uint64_t)job.block_size[2];
    BVXI_TRY(
        bvxi_alloc_zero(job.ctx, BVXI_SCRATCH, 2 * words * 8, "the blocks of thin places", &job.blocks[0]));
    job.blocks[1] = job.blocks[0] + words;
    BVXI_TRY(BVXI_ARRAY(job.ctx, job.mesh->vertex_count, "the vertices' blocks", job.block_of));
    for (uint64_t i = 0; i < bvxi_grid_words(places); i++)
        for (uint64_t bits = places->words[i]; bits != 0; bits &= bits - 1) /* a little more for rounding */
            mark_around(&job, i * 64 + (uint64_t)bvxi_lowest(bits), 1.01 * reach);
    BVXI_TRY(run_near(&job, job.mesh->vertex_count, place_piece_in_blocks));
    BVXI_TRY(run_near_pieces(&job, job.mesh->triangle_count, take_piece_nearby));
    bvxi_drop(job.ctx, job.block_of);
    bvxi_drop(job.ctx, job.blocks[0]);

    for (int32_t i = 0; i < job.pieces; i++) {
        uint64_t begin, end;
        bvxi_piece(mesh->triangle_count, job.pieces, i, &begin, &end);
        memmove(job.corner + 3 * taken, job.corner + 3 * begin, (size_t)job.taken[i] * 12);
        taken += job.taken[i];
    }
    view_triangles(mesh, job.corner, taken, near);
    return BVX_OK;
}

/* ---- their order ---- */

/* Corners in the order of their places, in p too. Returns 1 when that turns the triangle round. */
static uint8_t order_corners(uint32_t c[3], double p[3][3])
{
    uint8_t turned = 0;

    for (int step = 0; step < 3; step++) {
        int const k = step & 1; /* corners 0 and 1, 1 and 2, 0 and 1 */
        uint32_t const first = c[k];

        if (!bvxi_corner_before(p[k + 1], p[k])) continue;
        c[k] = c[k + 1];
        c[k + 1] = first;
        for (int a = 0; a < 3; a++) {
            double const x = p[k][a];
            p[k][a] = p[k + 1][a];
            p[k + 1][a] = x;
        }
        turned ^= 1;
    }
    return turned;
}

/* Corners in their order, so that the hash does not depend on how they were given; and the bounds of the
 * piece, from these, as vertices that no triangle uses may be anything. */
static void order_piece_nearby(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    near_job *const job = user;
    const bvxi_walls *const t = job->walls;
    double *const low = job->low[piece], *const high = job->high[piece];
    double const size[3] = {t->unit, t->unit, t->unit}, scale = bvxi_unit_scale(size, size);

    for (int a = 0; a < 3; a++) low[a] = HUGE_VAL, high[a] = -HUGE_VAL;
    for (uint64_t n = begin; n < end; n++) {
        double p[3][3];

        bvxi_view_corners(&t->near, n, p);
        job->sorted[n] = order_corners(t->corner + 3 * n, p);
        job->keys[n] = bvxi_corners_hash((const double(*)[3])p, scale);
        job->numbers[n] = (uint32_t)n;
        for (int k = 0; k < 9; k++) {
            double const x = p[k / 3][k % 3] + 0.0; /* -0 is 0 */

            low[k % 3] = x < low[k % 3] ? x : low[k % 3];
            high[k % 3] = x > high[k % 3] ? x : high[k % 3];
        }
    }
}

/* Sides while sorted still has them. */
static void side_piece_nearby(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const job = user;
    const bvxi_walls *const t = job->walls;
    for (uint64_t n = begin; n < end; n++) t->against[n] = (uint8_t)job->sorted[job->numbers[n]];
}

static void move_piece_nearby(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const job = user;
    const uint32_t *const corner = job->walls->corner;
    for (uint64_t n = begin; n < end; n++)
        memcpy(job->sorted + 3 * n, corner + 3 * (size_t)job->numbers[n], 12);
}

static bvx_status order_triangles_nearby(near_job *job, double low[3], double high[3])
{
    bvxi_walls *const t = job->walls;
    bvx_context *const ctx = t->ctx;
    uint64_t const count = t->near.triangle_count;

    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, count * 12, "the triangles at thin places in order", &job->sorted));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the order of triangles at thin places", &job->keys));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the numbers of triangles at thin places", job->numbers));
    /* In an order that no numbering of the mesh shows in: that of a hash of their corners' places. Until they are
     * moved, sorted[n] says whether triangle n was turned round. */
    BVXI_TRY(run_near_pieces(job, count, order_piece_nearby));
    for (int a = 0; a < 3; a++) {
        low[a] = job->low[0][a];
        high[a] = job->high[0][a];
        for (int32_t i = 1; i < job->pieces; i++) {
            low[a] = job->low[i][a] < low[a] ? job->low[i][a] : low[a];
            high[a] = job->high[i][a] > high[a] ? job->high[i][a] : high[a];
        }
    }
    BVXI_TRY(bvxi_radix_sort(ctx, job->keys, job->numbers, count));
    BVXI_TRY(run_near(job, count, side_piece_nearby));
    BVXI_TRY(run_near(job, count, move_piece_nearby));
    bvxi_drop(ctx, job->numbers);
    bvxi_drop(ctx, job->keys);

    /* Room for all triangles is needed no more. */
    bvxi_drop(ctx, t->corner);
    t->corner = job->sorted;
    view_triangles(t->mesh, t->corner, count, &t->near);
    return BVX_OK;
}

/* ---- the search ---- */

bvx_status bvxi_walls_around(const bvxi_walls *t, const bvx_mesh_view *mesh, bvx_mesh_view *near,
                             uint32_t **corner)
{
    double const reach = (1.0 + 2 * BVXI_WALL_DEPTH + (t->beside || t->parts ? WALL_BESIDE : 0.0)) * t->unit;
    /* Without area a triangle has no side that it could face. Enough are those of the nearest point within one
     * spacing, then of the nearest to a point BVXI_WALL_DEPTH behind it, at most BVXI_WALL_DEPTH further. */
    return bvxi_triangles_near(t->ctx, mesh, &t->places, reach, 1, near, corner);
}

bvx_status bvxi_walls_near(bvxi_walls *t)
{
    near_job job = {.ctx = t->ctx, .walls = t};
    double low[3], high[3];

    BVXI_TRY(bvxi_walls_around(t, t->mesh, &t->near, &t->corner));
    /* No triangle is near: nothing is searched. */
    if (t->near.triangle_count == 0) return BVX_OK;

    BVXI_TRY(
        bvxi_alloc(t->ctx, BVXI_SCRATCH, t->near.triangle_count, "the sides of thin places", &t->against));
    BVXI_TRY(order_triangles_nearby(&job, low, high));
    return bvxi_closest_build(bvxi_call_of(t->ctx, NULL, "thin", 0.3, 0.4), &t->near, low, high,
                              bvxi_unit_scale(low, high), &t->closest.tree);
}
