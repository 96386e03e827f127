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

enum { NEAR_BLOCK = 2 };          /* least voxels along a block's edge */
enum { NEAR_BITS = 10 };          /* of a block's coordinate; the highest is 0 */
enum { NEAR_MANY_BLOCKS = 512 };  /* a triangle of more is taken without a look */
enum { NEAR_MANY_PLACES = 4096 }; /* of more, boxes are marked in place of balls */
enum { NEAR_TRIANGLES = 4096, NEAR_PIECES = 64 };

/* What is done to vertices or triangles piece by piece. */
typedef struct near_job {
    bvx_context *ctx;
    const bvx_mesh_view *mesh;
    const bvx_grid *grid; /* of the places */
    bvxi_near_cells *cells;
    int32_t with_area;  /* 1: triangles without area are left out */
    uint64_t *blocks;   /* 1: any part of them may be within reach of a place */
    size_t block_words; /* of a row */
    uint64_t *beside;   /* 1: cells that a marked block is in or beside, and the last one */
    uint32_t *corner;   /* of the triangles taken [Size: triangles * 3] */
    int32_t pieces;

    bvxi_walls *walls; /* from here on: their order */
    uint64_t *keys;    /* of the triangles nearby, by which they are sorted */
    uint32_t *numbers, *sorted;
    uint8_t *sides;
    uint64_t taken[NEAR_PIECES]; /* triangles of a piece that are near */
} near_job;

static bvx_status run_near(near_job *job, uint64_t count, bvxi_range_fn *body)
{
    bvx_context *const ctx = job->ctx;
    return BVXI_SHARE(ctx, 0.2, 0.2, bvxi_for(ctx, "thin", count, NEAR_TRIANGLES, body, job));
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

/* The block of each vertex, cut to the window; of those that no triangle uses too, whatever they are. */
static void place_piece_in_blocks(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const t = user;
    const bvx_lattice *const l = &t->grid->lattice;
    int const packed = bvxi_view_packed_f32(t->mesh);
    double low[3], scale[3], last[3];

    for (int a = 0; a < 3; a++) {
        last[a] = (double)(t->cells->size[a] - 1);
        low[a] = l->origin[a] + (double)t->grid->low[a] * l->spacing[a];
        scale[a] = 1.0 / (l->spacing[a] * (double)t->cells->block);
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
        t->cells->block_of[v] = (uint32_t)at[0] | (uint32_t)at[1] << NEAR_BITS |
                                (uint32_t)at[2] << 2 * NEAR_BITS;
    }
}

static inline int32_t wall_block_index(uint32_t block, int axis)
{
    return (int32_t)(block >> axis * NEAR_BITS & ((1u << NEAR_BITS) - 1));
}

/* A cell is two blocks along each axis; larger triangles go into one after the last. */
static inline uint32_t near_cell_index(const bvxi_near_cells *c, int32_t x, int32_t y, int32_t z)
{
    return (uint32_t)((z * (c->size[1] / 2 + 1) + y) * (c->size[0] / 2 + 1) + x);
}

static inline uint32_t last_near_cell(const bvxi_near_cells *c)
{
    return near_cell_index(c, 0, 0, c->size[2] / 2 + 1);
}

/* By their first corner's block. Nearly all triangles lie in one, or in that and blocks beside it. */
static void place_piece_in_cells(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const t = user;
    const uint32_t *const block_of = t->cells->block_of;
    int const packed = bvxi_view_packed_u32(t->mesh);

    for (uint64_t n = begin; n < end; n++) {
        uint32_t c[3];

        if (packed) memcpy(c, (const unsigned char *)t->mesh->indices + (size_t)n * 12, sizeof c);
        else bvxi_view_triangle(t->mesh, n, c);
        uint32_t const b = block_of[c[0]];
        /* The other blocks are b or beside it. The difference of each coordinate, and one more, is added to its
         * highest bit; of both at once. */
        uint64_t const both = UINT64_C(0x100000001),
                       ones = both * (1u | 1u << NEAR_BITS | 1u << 2 * NEAR_BITS);
        uint64_t const high = ones << (NEAR_BITS - 1);
        uint64_t const x = (both * b | high) - ((uint64_t)block_of[c[1]] << 32 | block_of[c[2]]) + ones;
        int const small = (x & ~(3 * ones)) == high && (x & x >> 1 & ones) == 0;
        t->cells->cell_of[n] = small ? near_cell_index(t->cells, wall_block_index(b, 0) / 2,
                                                       wall_block_index(b, 1) / 2, wall_block_index(b, 2) / 2)
                                     : last_near_cell(t->cells);
    }
}

bvx_status bvxi_near_cells_open(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_grid *window,
                                bvxi_near_cells *cells)
{
    near_job job = {.ctx = ctx, .mesh = mesh, .grid = window, .cells = cells};

    cells->block = NEAR_BLOCK;
    for (int a = 0; a < 3; a++)
        while (window->size[a] / cells->block >= 1 << (NEAR_BITS - 1)) cells->block *= 2;
    for (int a = 0; a < 3; a++) cells->size[a] = window->size[a] / cells->block + 1;
    BVXI_TRY(BVXI_ARRAY(ctx, mesh->vertex_count, "the vertices' blocks", cells->block_of));
    BVXI_TRY(BVXI_ARRAY(ctx, mesh->triangle_count, "the triangles' cells", cells->cell_of));
    BVXI_TRY(run_near(&job, mesh->vertex_count, place_piece_in_blocks));
    return run_near(&job, mesh->triangle_count, place_piece_in_cells);
}

void bvxi_near_cells_close(bvx_context *ctx, bvxi_near_cells *cells)
{
    bvxi_drop(ctx, cells->cell_of);
    bvxi_drop(ctx, cells->block_of);
}

static inline size_t block_word(const near_job *t, int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)t->cells->size[1] + (size_t)y) * t->block_words + (size_t)(x >> 6);
}

/* Block of a voxel's coordinate, cut to the window. */
static inline int32_t block_at(const near_job *t, int a, double at)
{
    double const b = at / t->cells->block, last = (double)t->cells->size[a] - 1;
    return b > 0 ? (int32_t)(b < last ? b : last) : 0;
}

/* From a coordinate to the nearest of a block, squared [Units: world]; sides of the window are open. */
static inline double way_to_block(const near_job *t, int a, double at, int32_t block)
{
    double const side = t->cells->block, low = block * side - at, high = at - (block + 1) * side;
    double const way = (low > 0 ? low : high > 0 ? high : 0) * t->grid->lattice.spacing[a];
    return way * way;
}

/* The blocks that a ball of this radius about a place meets, or its box where there are many places; and the cells that
 * these are in or beside. */
static void mark_around(near_job *t, uint64_t bit, double radius, int many)
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
            uint64_t *const row = t->blocks + block_word(t, 0, y, z);

            if (many) {
                bvxi_set_run(row, from[0], to[0] + 1);
                continue;
            }
            double const left = radius * radius - way_to_block(t, 1, at[1], y) - way_to_block(t, 2, at[2], z);
            if (left < 0) continue;
            double const far = sqrt(left) / spacing[0];
            bvxi_set_run(row, block_at(t, 0, at[0] - far), block_at(t, 0, at[0] + far) + 1);
        }

    for (int a = 0; a < 3; a++) {
        from[a] = from[a] > 0 ? (from[a] - 1) / 2 : 0;
        to[a] = (to[a] + 1 < t->cells->size[a] ? to[a] + 1 : to[a]) / 2;
    }
    for (int32_t z = from[2]; z <= to[2]; z++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            bvxi_set_run(t->beside, (int32_t)near_cell_index(t->cells, from[0], y, z),
                         (int32_t)near_cell_index(t->cells, to[0], y, z) + 1);
}

static inline int is_near_block(const near_job *t, int32_t x, int32_t y, int32_t z)
{
    return (int)(t->blocks[block_word(t, x, y, z)] >> (x & 63) & 1);
}

static int is_in_marked_block(const near_job *t, const uint32_t c[3])
{
    const uint32_t *const block_of = t->cells->block_of;
    uint32_t const corner[3] = {block_of[c[0]], block_of[c[1]], block_of[c[2]]};
    int32_t from[3], to[3];

    /* Most triangles lie in one block. */
    for (int k = 0; k < 3; k++)
        if (is_near_block(t, wall_block_index(corner[k], 0), wall_block_index(corner[k], 1),
                          wall_block_index(corner[k], 2)))
            return 1;
    if (corner[0] == corner[1] && corner[0] == corner[2]) return 0;
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
                if (is_near_block(t, x, y, z)) return 1;
    return 0;
}

/* Each piece writes where its own triangles would stand if all were taken. */
static void take_piece_nearby(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    near_job *const job = user;
    const near_job *const t = job;
    uint32_t *to = t->corner + 3 * begin;

    for (uint64_t first = begin; first < end; first += 64) {
        uint64_t const left = end - first;
        uint64_t hits = 0;

        for (uint64_t k = 0; k < (left < 64 ? left : 64); k++) {
            uint32_t const cell = t->cells->cell_of[first + k];
            hits |= (t->beside[cell / 64] >> (cell & 63) & 1) << k;
        }
        for (; hits != 0; hits &= hits - 1) {
            double p[3][3], normal[3];

            bvxi_view_triangle(t->mesh, first + (uint64_t)bvxi_lowest(hits), to);
            if (!is_in_marked_block(t, to)) continue;
            for (int k = 0; k < 3 && t->with_area; k++) bvxi_view_position(t->mesh, to[k], p[k]);
            to += t->with_area && !(bvxi_facet_normal((const double(*)[3])p, normal) > 0) ? 0 : 3;
        }
    }
    job->taken[piece] = (uint64_t)(to - t->corner) / 3 - begin;
}

bvx_status bvxi_triangles_near(bvx_context *ctx, const bvx_mesh_view *mesh, const bvxi_near_cells *known,
                               const bvx_grid *places, double reach, int32_t with_area, bvx_mesh_view *near,
                               uint32_t **corner)
{
    bvxi_near_cells cells;
    near_job job = {.ctx = ctx, .mesh = mesh, .grid = places, .cells = &cells, .with_area = with_area};
    uint64_t count = 0, taken = 0, words;

    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, mesh->triangle_count * 12, "the triangles at thin places", corner));
    job.corner = *corner;
    if (known != NULL) cells = *known;
    else BVXI_TRY(bvxi_near_cells_open(ctx, mesh, places, &cells));
    job.block_words = (size_t)cells.size[0] / 64 + 1;
    words = (uint64_t)job.block_words * (uint64_t)cells.size[1] * (uint64_t)cells.size[2];
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, (words + last_near_cell(&cells) / 64 + 1) * 8,
                             "the blocks of thin places", &job.blocks));
    job.beside = job.blocks + words;
    bvxi_set_run(job.beside, (int32_t)last_near_cell(&cells), (int32_t)last_near_cell(&cells) + 1);
    for (uint64_t i = 0; i < bvxi_grid_words(places); i++)
        for (uint64_t bits = places->words[i]; bits != 0; bits &= bits - 1) /* a little more for rounding */
            mark_around(&job, i * 64 + (uint64_t)bvxi_lowest(bits), 1.01 * reach, count++ > NEAR_MANY_PLACES);
    job.pieces = bvxi_piece_count(mesh->triangle_count, NEAR_TRIANGLES);
    if (job.pieces > NEAR_PIECES) job.pieces = NEAR_PIECES;
    BVXI_TRY(
        bvxi_for_pieces(ctx, "thin", 0.2, 0.2, job.pieces, mesh->triangle_count, take_piece_nearby, &job));
    bvxi_drop(ctx, job.blocks);
    if (known == NULL) bvxi_near_cells_close(ctx, &cells);

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

/* The hash of corners in their order, so that it does not depend on how they were given. */
static void key_piece_nearby(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const job = user;
    const bvxi_walls *const t = job->walls;
    double const size[3] = {t->unit, t->unit, t->unit}, scale = bvxi_unit_scale(size, size);

    for (uint64_t n = begin; n < end; n++) {
        double p[3][3];

        bvxi_view_corners(&t->near, n, p);

        /* Corners in the order of their places, in p too; turned: whether that turns the triangle round. */
        uint32_t *const c = t->corner + 3 * n;
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
        t->against[n] = turned;
        job->keys[n] = bvxi_corners_hash((const double(*)[3])p, scale);
        job->numbers[n] = (uint32_t)n;
    }
}

static void move_piece_nearby(void *user, uint64_t begin, uint64_t end)
{
    const near_job *const job = user;
    const uint32_t *const corner = job->walls->corner;
    for (uint64_t n = begin; n < end; n++) {
        memcpy(job->sorted + 3 * n, corner + 3 * (size_t)job->numbers[n], 12);
        job->sides[n] = job->walls->against[job->numbers[n]];
    }
}

/* ---- the search ---- */

bvx_status bvxi_walls_near(bvxi_walls *t, double reach)
{
    near_job job = {.ctx = t->ctx, .walls = t};
    double low[3], high[3];

    /* Without area a triangle has no side that it could face. */
    BVXI_TRY(
        bvxi_triangles_near(t->ctx, t->mesh, t->cells, &t->places, reach * t->unit, 1, &t->near, &t->corner));
    /* No triangle is near: nothing is searched. */
    if (t->near.triangle_count == 0) return BVX_OK;

    bvxi_view_used_bounds(&t->near, low, high);
    bvx_context *const ctx = t->ctx;
    uint64_t const count = t->near.triangle_count;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count, "the sides of thin places", &t->against));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count, "the sides of thin places in order", &job.sides));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 12, "the triangles at thin places in order", &job.sorted));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the order of triangles at thin places", &job.keys));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the numbers of triangles at thin places", job.numbers));
    /* Sorted by a hash of their corners' places, so the mesh's numbering does not show. */
    BVXI_TRY(run_near(&job, count, key_piece_nearby));
    BVXI_TRY(bvxi_radix_sort(ctx, job.keys, job.numbers, count));
    BVXI_TRY(run_near(&job, count, move_piece_nearby));
    bvxi_drop(ctx, job.numbers);
    bvxi_drop(ctx, job.keys);

    /* Room for all triangles is needed no more. */
    bvxi_drop(ctx, t->corner);
    bvxi_drop(ctx, t->against);
    t->corner = job.sorted;
    t->against = job.sides;
    view_triangles(t->mesh, t->corner, count, &t->near);
    return bvxi_closest_build(bvxi_call_of(t->ctx, NULL, "thin", 0.3, 0.4), &t->near, low, high,
                              bvxi_unit_scale(low, high), &t->closest.tree);
}
