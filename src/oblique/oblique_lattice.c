/* oblique_lattice.c - the lattice's values in all blocks that the surface may run through.
 *
 * A block of 4 x 4 x 4 vertices is known where a contour runs through it, where a plane in it says another
 * thing than its first vertex, and, from there on, where a vertex of a known block next to it has another
 * sign than it. So wherever the surface runs, both ends of every edge that it crosses are known; all other
 * blocks are on one side. What no contour leads to is not looked for. The set is the same in any order.
 *
 * Vertices next to a plane are moved onto it, and have its own distance and sign: no sliver of a cell is cut
 * off there. The lattice's outermost vertices are outside, so the surface is closed. */
#include "oblique/oblique.h"

#include <math.h>

enum { BLOCK_GRAIN = 8, BLOCK_CONTRADICTED = 0x80 /* a plane says another thing than its first vertex */ };

#define PLACE_SNAP \
    0.15 /* cells: what lies so near to a plane moves onto it; tetrahedra keep 0.4 of their height */

int bvxi_oblique_place_among(const bvxi_oblique *o, const int32_t vertex[3], const uint32_t *plane,
                             uint32_t count, double at[3])
{
    const bvxi_oblique_plane *nearest = NULL;
    double least = PLACE_SNAP, height = 0.0;
    for (int k = 0; k < 3; k++) at[k] = vertex[k];
    for (uint32_t n = 0; n < count; n++) {
        double const h = bvxi_oblique_height(&o->plane[plane[n]], at);
        if (bvxi_absolute(h) >= least) continue;
        least = bvxi_absolute(h);
        height = h;
        nearest = &o->plane[plane[n]];
    }
    for (int k = 0; k < 3 && nearest != NULL; k++) at[k] -= height * nearest->normal[k];
    return nearest != NULL;
}

/* What vertices move by, and half the way between the places of a segment that are marked. */
#define MARK_REACH 0.3

void bvxi_oblique_block_place(const bvxi_oblique *o, uint32_t block, int32_t first[3])
{
    int32_t const x = o->blocks[0], y = o->blocks[1];
    first[0] = (int32_t)(block % (uint32_t)x) * BVXI_BLOCK_SIDE;
    first[1] = (int32_t)(block / (uint32_t)x % (uint32_t)y) * BVXI_BLOCK_SIDE;
    first[2] = (int32_t)(block / (uint32_t)x / (uint32_t)y) * BVXI_BLOCK_SIDE;
}

/* 1: a plane passes through a cube of four cells and so far around it. */
static int plane_in_block(const bvxi_oblique_plane *p, const int32_t first[3], double margin)
{
    double const centre[3] = {first[0] + 2.0, first[1] + 2.0, first[2] + 2.0};
    double const reach = 2.0 * (bvxi_absolute(p->normal[0]) + bvxi_absolute(p->normal[1]) +
                                bvxi_absolute(p->normal[2]));
    return bvxi_absolute(bvxi_oblique_height(p, centre)) <= reach + margin;
}

uint32_t bvxi_oblique_near_planes(const bvxi_oblique *o, const int32_t first[3], uint32_t *plane)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < o->plane_count; i++)
        if (plane_in_block(&o->plane[i], first, 0.5)) plane[count++] = i;
    return count;
}

/* Planes that have a say somewhere in a cube of four cells, in their order. */
uint32_t bvxi_oblique_heard_planes(const bvxi_oblique *o, const int32_t first[3], uint32_t *plane)
{
    double const centre[3] = {first[0] + 2.0, first[1] + 2.0, first[2] + 2.0};
    double const reach = o->reach + 4.0; /* more than half the cube's diagonal, and what vertices move by */
    uint32_t count = 0;
    for (uint32_t i = 0; i < o->plane_count; i++)
        if (bvxi_absolute(bvxi_oblique_height(&o->plane[i], centre)) < reach) plane[count++] = i;
    return count;
}

/* The value of a vertex, never 0. near: planes that it may move onto; heard: those that have a say there. */
static float value_among(const bvxi_oblique *o, const int32_t vertex[3], const uint32_t *near,
                         uint32_t near_count, const uint32_t *heard, uint32_t heard_count)
{
    double at[3], value = 0.0;
    uint32_t on = BVXI_NONE;

    /* Outside along the lattice's border, so that the surface closes within it. */
    for (int k = 0; k < 3; k++)
        if (vertex[k] == 0 || vertex[k] == o->side[k] - 1) return o->body_count != 0 ? 0.0F : -1.0F;
    /* on no plane, unless it moves onto one: a plane within reach of nothing is one that it moves onto */
    if (bvxi_oblique_place_among(o, vertex, near, near_count, at))
        for (uint32_t i = 0; i < near_count && on == BVXI_NONE; i++)
            if (bvxi_absolute(bvxi_oblique_height(&o->plane[near[i]], at)) <= BVXI_OBLIQUE_NEAR) on = near[i];
    if (o->body_count != 0) return (float)bvxi_joint_kind(o, on, at, heard, heard_count);
    value = on != BVXI_NONE ? bvxi_oblique_exact(o, on, at)
                            : bvxi_oblique_number_among(o, at, heard, heard_count);

    /* Never 0, also not by rounding: each vertex is on one side. */
    float rounded = (float)value;
    if (rounded > -1e-12F && rounded < 1e-12F) rounded = value > 0.0 ? 1e-12F : -1e-12F;
    return rounded;
}

float bvxi_oblique_vertex_value(const bvxi_oblique *o, const int32_t vertex[3])
{
    uint32_t near[BVXI_OBLIQUE_PLANES], heard[BVXI_OBLIQUE_PLANES];
    uint32_t const count = bvxi_oblique_near_planes(o, vertex, near);
    return value_among(o, vertex, near, count, heard, bvxi_oblique_heard_planes(o, vertex, heard));
}

int bvxi_oblique_kind_on(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    const bvxi_oblique_plane *const p = &o->plane[plane];
    if (o->body_count != 0) return bvxi_joint_kind(o, plane, at, NULL, 0);
    /* Far from contours the raster is enough: a bilinear cell of distances is off by less than its diagonal. */
    double const near = p->raster == NULL ? 0.0 : bvxi_oblique_raster_at(p, p->raster, at);
    return (bvxi_absolute(near) > 1.5 * BVXI_RASTER_STEP ? near : bvxi_oblique_exact(o, plane, at)) > 0.0;
}

int bvxi_oblique_kind(const bvxi_oblique *o, const int32_t vertex[3])
{
    int bit;
    uint64_t const block = bvxi_oblique_block(o, vertex, &bit);
    if (o->block_at[block] < 0) return o->block_kind[block];
    return bvxi_oblique_kind_of(o, o->value[(uint64_t)o->block_at[block] * BVXI_BLOCK_SIZE + (uint64_t)bit]);
}

/* ---- blocks ---- */

static void first_vertex_piece(void *user, uint64_t begin, uint64_t end)
{
    bvxi_oblique *const o = user;
    /* One vertex a block; where neighbours agree, all between them is taken to be on that side. */
    for (uint64_t i = begin; i < end; i++) {
        int32_t first[3];
        bvxi_oblique_block_place(o, (uint32_t)i, first);
        o->block_kind[i] = (uint8_t)bvxi_oblique_kind_of(o, bvxi_oblique_vertex_value(o, first));
    }
}

static bvx_status know_block(bvxi_oblique *o, uint64_t block)
{
    if (o->block_at[block] >= 0) return BVX_OK;
    BVXI_TRY(BVXI_GROW(o, o->known, o->known_count, o->known_room, "the blocks of the lattice"));
    o->block_at[block] = (int32_t)o->known_count;
    o->known[o->known_count++] = (uint32_t)block;
    return BVX_OK;
}

typedef struct known_job {
    bvxi_oblique *o;
    uint32_t from;
} known_job;

static void known_piece(void *user, uint64_t begin, uint64_t end)
{
    const known_job *const job = user;
    bvxi_oblique *const o = job->o;

    for (uint64_t i = job->from + begin; i < job->from + end; i++) {
        int32_t first[3], at[3];
        float *const value = o->value + i * BVXI_BLOCK_SIZE;
        uint32_t near[BVXI_OBLIQUE_PLANES], heard[BVXI_OBLIQUE_PLANES], near_count, heard_count;
        bvxi_oblique_block_place(o, o->known[i], first);
        /* The planes that matter are found once a block, not once for each of its vertices. */
        near_count = bvxi_oblique_near_planes(o, first, near);
        heard_count = bvxi_oblique_heard_planes(o, first, heard);
        for (int n = 0; n < BVXI_BLOCK_SIZE; n++) {
            bvxi_oblique_in_block(first, n, at);
            value[n] = value_among(o, at, near, near_count, heard, heard_count);
        }
    }
}

/* 1 where a vertex of a known block that touches the one at (dx, dy, dz) is of another kind than that. */
static int disagrees(const bvxi_oblique *o, const float *value, const int d[3], int kind)
{
    for (int n = 0; n < BVXI_BLOCK_SIZE; n++) {
        int const c[3] = {n & 3, n >> 2 & 3, n >> 4};
        int touches = 1;
        for (int k = 0; k < 3; k++) touches &= d[k] == 0 || c[k] == (d[k] < 0 ? 0 : BVXI_BLOCK_SIDE - 1);
        if (touches && bvxi_oblique_kind_of(o, value[n]) != kind) return 1;
    }
    return 0;
}

static bvx_status know_round(bvxi_oblique *o, uint32_t i)
{
    int32_t first[3];

    bvxi_oblique_block_place(o, o->known[i], first);
    for (int n = 0; n < 27; n++) {
        int const d[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
        int32_t b[3];
        int out = n == 13;
        for (int k = 0; k < 3; k++) {
            b[k] = first[k] / BVXI_BLOCK_SIDE + d[k];
            out |= b[k] < 0 || b[k] >= o->blocks[k];
        }
        if (out) continue;
        uint64_t block = ((uint64_t)b[2] * (uint64_t)o->blocks[1] + (uint64_t)b[1]) * (uint64_t)o->blocks[0] +
                         (uint64_t)b[0];
        if (o->block_at[block] < 0 &&
            disagrees(o, o->value + (uint64_t)i * BVXI_BLOCK_SIZE, d, o->block_kind[block]))
            BVXI_TRY(know_block(o, block));
    }
    return BVX_OK;
}

/* ---- contours ---- */

static void mark_segment(bvxi_oblique *o, const double a[3], const double b[3])
{
    double square = 0.0;
    for (int k = 0; k < 3; k++) square += (b[k] - a[k]) * (b[k] - a[k]);
    /* A quarter of a cell from place to place: less than the reach, so that no cell between is missed. */
    int32_t const steps = (int32_t)(sqrt(square) * 4.0) + 1;
    for (int32_t i = 0; i <= steps; i++) {
        double const t = (double)i / steps;
        double const at[3] = {a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), a[2] + t * (b[2] - a[2])};

        /* Cells within reach of a place; vertices may have moved by PLACE_SNAP. */
        int32_t low[3], high[3], c[3];

        for (int k = 0; k < 3; k++) {
            low[k] = (int32_t)floor(at[k] - MARK_REACH);
            high[k] = (int32_t)floor(at[k] + MARK_REACH);
            if (low[k] < 0) low[k] = 0;
            if (high[k] > o->side[k] - 2) high[k] = o->side[k] - 2;
        }
        for (c[2] = low[2]; c[2] <= high[2]; c[2]++)
            for (c[1] = low[1]; c[1] <= high[1]; c[1]++)
                for (c[0] = low[0]; c[0] <= high[0]; c[0]++) {
                    int bit;
                    uint64_t const block = bvxi_oblique_block(o, c, &bit);
                    o->contour_cells[block] |= UINT64_C(1) << bit;
                }
    }
}

/* What a stretch of a contour sweeps from (a, b) to (c, d): there the plane says another thing afterwards. */
static void mark_sweep(bvxi_oblique *o, const double a[3], const double b[3], const double c[3],
                       const double d[3])
{
    double square[4] = {0.0, 0.0, 0.0, 0.0};

    for (int k = 0; k < 3; k++) {
        square[0] += (c[k] - a[k]) * (c[k] - a[k]);
        square[1] += (d[k] - b[k]) * (d[k] - b[k]);
        square[2] += (b[k] - a[k]) * (b[k] - a[k]);
        square[3] += (d[k] - c[k]) * (d[k] - c[k]);
    }

    /* What is moved by less than the reach sweeps nothing that is not marked by its ends. */
    mark_segment(o, c, d);
    if (square[0] < MARK_REACH * MARK_REACH && square[1] < MARK_REACH * MARK_REACH) return;

    int32_t const steps = (int32_t)(sqrt(square[2] > square[3] ? square[2] : square[3]) * 4.0) + 1;
    for (int32_t i = 0; i <= steps; i++) {
        double const t = (double)i / steps;
        double from[3], to[3];
        for (int k = 0; k < 3; k++) {
            from[k] = a[k] + t * (b[k] - a[k]);
            to[k] = c[k] + t * (d[k] - c[k]);
        }
        mark_segment(o, from, to);
    }
}

/* A segment and what it sweeps from knot to knot; after: the next one, whose first point may move. */
static void mark_moved_segment(bvxi_oblique *o, uint32_t plane, uint32_t segment, uint32_t after,
                               const double a[3], const double b[3])
{
    uint32_t k = bvxi_knot_after(o, plane, segment, -1.0), end = bvxi_knot_after(o, plane, after, -1.0);
    double at[3], moved[3], next_at[3], next_moved[3];

    mark_segment(o, a, b);

    /* A knot at the next segment's own begin is this one's end. */
    if (end != BVXI_NONE && o->knot[end].share > 0.0) end = BVXI_NONE;
    if (k == BVXI_NONE && end == BVXI_NONE) return;

    memcpy(at, a, sizeof at);
    memcpy(moved, a, sizeof moved);
    for (; k != BVXI_NONE; k = bvxi_knot_after(o, plane, segment, o->knot[k].share)) {
        for (int c = 0; c < 3; c++) next_at[c] = a[c] + o->knot[k].share * (b[c] - a[c]);
        bvxi_knot_place(o, k, next_moved);
        mark_sweep(o, at, next_at, moved, next_moved);
        memcpy(at, next_at, sizeof at);
        memcpy(moved, next_moved, sizeof moved);
    }
    memcpy(next_moved, b, sizeof next_moved);
    if (end != BVXI_NONE) bvxi_knot_place(o, end, next_moved);
    mark_sweep(o, at, b, moved, next_moved);
}

/* ---- planes in blocks without contours ---- */

/* A point that a plane has in a cube: the mean of its crossings with the edges. */
int bvxi_oblique_in_cube(const bvxi_oblique_plane *p, const int32_t first[3], double side, double at[3])
{
    double height[8], count = 0.0;

    at[0] = at[1] = at[2] = 0.0;
    for (int c = 0; c < 8; c++) {
        double const corner[3] = {first[0] + (c & 1 ? side : 0.0), first[1] + (c & 2 ? side : 0.0),
                                  first[2] + (c & 4 ? side : 0.0)};
        height[c] = bvxi_oblique_height(p, corner);
    }
    for (int c = 0; c < 8; c++)
        for (int k = 0; k < 3; k++) {
            int const e = c | 1 << k;
            if (e == c || (height[c] < 0.0) == (height[e] < 0.0)) continue;
            double t = height[c] / (height[c] - height[e]);
            for (int x = 0; x < 3; x++)
                at[x] += first[x] + (c >> x & 1 ? side : 0.0) + (x == k ? t * side : 0.0);
            count += 1.0;
        }
    if (count == 0.0) return 0;
    for (int k = 0; k < 3; k++) at[k] /= count;
    return 1;
}

static void plane_block_piece(void *user, uint64_t begin, uint64_t end)
{
    bvxi_oblique *const o = user;
    for (uint64_t i = begin; i < end; i++) {
        int32_t first[3];
        double at[3];
        if (o->contour_cells[i] != 0) continue;
        bvxi_oblique_block_place(o, (uint32_t)i, first);
        for (uint32_t k = 0; k < o->plane_count; k++)
            if (plane_in_block(&o->plane[k], first, 0.01) &&
                bvxi_oblique_in_cube(&o->plane[k], first, BVXI_BLOCK_SIDE, at) &&
                bvxi_oblique_kind_on(o, k, at) != (o->block_kind[i] & ~BLOCK_CONTRADICTED))
                o->block_kind[i] |= BLOCK_CONTRADICTED;
    }
}

static bvx_status begin_blocks(bvxi_oblique *o, uint64_t n)
{
    const int32_t *const b = o->blocks;

    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.2, bvxi_for(o->ctx, "field", n, 512, first_vertex_piece, o)));

    /* Before the planes are looked at, which leave out the blocks that contours mark. */
    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t k = 0; k < p->point_count; k++) {
            double from[3], to[3];
            bvxi_oblique_in_cells(o, o->given->points + 3 * (uint64_t)p->given[k], from);
            bvxi_oblique_in_cells(o, o->given->points + 3 * (uint64_t)p->given[p->next[k]], to);
            mark_moved_segment(o, i, k, p->next[k], from, to);
        }
    }
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.2, 0.3, bvxi_for(o->ctx, "field", n, 512, plane_block_piece, o)));
    for (uint64_t i = 0; i < n; i++) {
        int known = o->contour_cells[i] != 0 || (o->block_kind[i] & BLOCK_CONTRADICTED) != 0;
        int32_t first[3];
        bvxi_oblique_block_place(o, (uint32_t)i, first);
        for (int k = 0; k < 3; k++) {
            uint64_t const step = k == 0 ? 1 : k == 1 ? (uint64_t)b[0] : (uint64_t)b[0] * (uint64_t)b[1];
            if (first[k] / BVXI_BLOCK_SIDE + 1 < b[k])
                known |= ((o->block_kind[i] ^ o->block_kind[i + step]) & ~BLOCK_CONTRADICTED) != 0;
            if (first[k] > 0)
                known |= ((o->block_kind[i] ^ o->block_kind[i - step]) & ~BLOCK_CONTRADICTED) != 0;
        }
        if (known) BVXI_TRY(know_block(o, i));
    }

    for (uint64_t i = 0; i < n; i++) o->block_kind[i] &= (uint8_t)~BLOCK_CONTRADICTED;
    return BVX_OK;
}

bvx_status bvxi_oblique_lattice(bvxi_oblique *o)
{
    uint64_t const n = (uint64_t)o->blocks[0] * (uint64_t)o->blocks[1] * (uint64_t)o->blocks[2];
    BVXI_TRY(BVXI_ZEROS(o->ctx, n, "the blocks of the lattice", o->block_kind));
    BVXI_TRY(BVXI_ARRAY(o->ctx, n, "the blocks of the lattice", o->block_at));
    BVXI_TRY(BVXI_ZEROS(o->ctx, n, "the blocks of the lattice", o->contour_cells));
    memset(o->block_at, 0xff, (size_t)n * 4);
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.4, begin_blocks(o, n)));
    for (uint32_t from = 0; from < o->known_count;) {
        uint32_t const end = o->known_count;
        known_job job = {o, from};

        /* Values of the new blocks at once and in parallel; then, in order, the blocks that these lead to. */
        BVXI_TRY(bvxi_resize(o->ctx, BVXI_SCRATCH, &o->value, o->value_room * 4,
                             (uint64_t)end * BVXI_BLOCK_SIZE * 4, "the lattice's values"));
        o->value_room = (uint64_t)end * BVXI_BLOCK_SIZE;
        BVXI_TRY(BVXI_SHARE(o->ctx, 0.4, 1.0,
                            bvxi_for(o->ctx, "field", end - from, BLOCK_GRAIN, known_piece, &job)));
        for (; from < end; from++) BVXI_TRY(know_round(o, from));
    }
    return BVX_OK;
}
