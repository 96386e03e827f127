/* oblique_cells.c - which cells of the lattice become tetrahedra of their own, and what planes make of them.
 *
 * Source: Kuhn. Some combinatorial lemmas in topology. 1960 (a cube as six tetrahedra along its ways from one
 * corner to the opposite one: those of all cubes meet in whole faces).
 *
 * A cell that no plane touches needs no more than the signs of its corners. One that a plane touches is split
 * where a contour runs through it, its corners differ, or the plane says another thing than they do. A face
 * between a split cell and one that is not has one sign all over, or no plane in it: nothing of the surface
 * is lost there. */
#include "oblique/oblique.h"

#include "bits/bits.h"

enum {
    CELL_NODES = 125, /* vertices of a block and those behind it */
    CELL_GRAIN = 64,
    SPLIT_ROOM = 4 /* what planes and contours make of a tetrahedron, in the mean */
};

/* A block of cells as it is looked at: the planes in it, and which cells each touches. */
typedef struct oblique_block {
    int32_t first[3];
    uint32_t plane[BVXI_OBLIQUE_PLANES], planes;
    uint64_t touched[BVXI_OBLIQUE_PLANES];
} oblique_block;

/* The lattice's last vertices begin no cell. */
static uint64_t whole_cells(const bvxi_oblique *o, const int32_t first[3])
{
    static const uint64_t last[3] = {UINT64_C(0x8888888888888888), UINT64_C(0xf000f000f000f000),
                                     UINT64_C(0xffff000000000000)};
    uint64_t cells = UINT64_MAX;
    for (int k = 0; k < 3; k++)
        if (first[k] + BVXI_BLOCK_SIDE >= o->side[k]) cells &= ~last[k];
    return cells;
}

static void look_at_block(const bvxi_oblique *o, uint32_t known, oblique_block *b)
{
    double place[CELL_NODES][3];

    bvxi_oblique_block_place(o, o->known[known], b->first);
    b->planes = bvxi_oblique_near_planes(o, b->first, b->plane);
    if (b->planes == 0) return;

    /* Where the block's nodes are once they have moved onto planes: found once, for all of its planes. */
    for (int n = 0; n < CELL_NODES; n++) {
        int32_t const at[3] = {b->first[0] + n % 5, b->first[1] + n / 5 % 5, b->first[2] + n / 25};
        bvxi_oblique_place_among(o, at, b->plane, b->planes, place[n]);
    }
    for (uint32_t i = 0; i < b->planes; i++) {
        const bvxi_oblique_plane *const p = &o->plane[b->plane[i]];
        /* Which sides of the plane a node counts on: both when it lies on it. A cell is touched whose nodes
         * have both. */
        uint8_t node[CELL_NODES];
        for (int n = 0; n < CELL_NODES; n++) {
            double const h = bvxi_oblique_height(p, place[n]);
            node[n] = (uint8_t)((h >= -BVXI_OBLIQUE_NEAR) | (h <= BVXI_OBLIQUE_NEAR) << 1);
        }
        uint64_t cells = 0;
        for (int c = 0; c < BVXI_BLOCK_SIZE; c++) {
            const uint8_t *const n = node + (c & 3) + 5 * (c >> 2 & 3) + 25 * (c >> 4);
            int const sides = n[0] | n[1] | n[5] | n[6] | n[25] | n[26] | n[30] | n[31];
            cells |= (uint64_t)(sides == 3) << c;
        }
        b->touched[i] = cells & whole_cells(o, b->first);
    }
}

/* Cells of the block in which a plane says another thing than their corners, which agree. */
static uint64_t contradicted_cells(const bvxi_oblique *o, const oblique_block *b, uint64_t known,
                                   uint64_t cells)
{
    const float *const value = o->value + known * BVXI_BLOCK_SIZE;
    uint64_t found = 0;

    for (uint32_t i = 0; i < b->planes; i++)
        for (uint64_t left = b->touched[i] & cells & ~found; left != 0; left &= left - 1) {
            int const c = bvxi_lowest(left);
            int32_t at[3];
            double place[3];
            bvxi_oblique_in_block(b->first, c, at);
            /* Corners that agree may have a bit of the surface between them, on the plane only. */
            if (bvxi_oblique_in_cube(&o->plane[b->plane[i]], at, 1.0, place) &&
                bvxi_oblique_kind_on(o, b->plane[i], place) != bvxi_oblique_kind_of(o, value[c]))
                found |= UINT64_C(1) << c;
        }
    return found;
}

/* Which cells of known blocks are split, and how many planes touch those. */
static void judge_cells(void *user, uint64_t begin, uint64_t end)
{
    bvxi_oblique *const o = user;
    oblique_block b;

    for (uint64_t i = begin; i < end; i++) {
        uint64_t touched = 0;
        uint32_t touches = 0;

        look_at_block(o, (uint32_t)i, &b);
        uint64_t const mixed = bvxi_oblique_mixed(o, (uint32_t)i) & whole_cells(o, b.first);
        uint64_t wanted = mixed | o->contour_cells[o->known[i]];
        wanted |= contradicted_cells(o, &b, i, ~wanted);
        for (uint32_t p = 0; p < b.planes; p++) touched |= b.touched[p];
        /* Mixed cells without a plane are plain: one body's need no tetrahedra of their own. */
        o->split[i] = o->body_count != 0 ? wanted : wanted & touched;
        o->active[i] = mixed & ~touched;
        for (uint32_t p = 0; p < b.planes; p++) touches += bvxi_popcount(b.touched[p] & o->split[i]);
        o->split_first[i] = bvxi_popcount(o->split[i]);
        o->touch_first[i] = touches;
    }
}

/* The split cells with what touches them, in their order. */
static void list_cells(void *user, uint64_t begin, uint64_t end)
{
    bvxi_oblique *const o = user;
    oblique_block b;

    for (uint64_t i = begin; i < end; i++) {
        uint32_t cell = o->split_first[i], touch = o->touch_first[i];
        if (o->split[i] == 0) continue;
        /* Looked at twice rather than kept: what planes touch in all blocks would be much memory. */
        look_at_block(o, (uint32_t)i, &b);
        for (uint64_t left = o->split[i]; left != 0; left &= left - 1, cell++) {
            int const c = bvxi_lowest(left);
            o->cell[cell][0] = o->known[i];
            o->cell[cell][1] = (uint32_t)c;
            for (uint32_t p = 0; p < b.planes; p++) {
                if (!(b.touched[p] >> c & 1)) continue;
                o->touch[touch][0] = cell;
                o->touch[touch++][1] = b.plane[p];
            }
        }
    }
}

/* ---- tetrahedra ---- */

/* A vertex of the lattice among those of the tetrahedra; planes: those near its cell's block. */
static bvx_status lattice_vertex(bvxi_oblique *o, const int32_t vertex[3], const uint32_t *plane,
                                 uint32_t planes, uint32_t *number)
{
    int bit;
    uint64_t const block = bvxi_oblique_block(o, vertex, &bit);
    uint64_t slot = BVXI_NONE;
    uint32_t *found;
    double at[3];

    if (o->block_at[block] >= 0) {
        slot = (uint64_t)o->block_at[block] * BVXI_BLOCK_SIZE + (uint64_t)bit;
        found = &o->vertex_at[slot];
    } else BVXI_TRY(bvxi_edge_add(o, &o->lattice_vertex, (uint32_t)block + 64, (uint32_t)bit, &found));
    *number = *found;
    if (*found != BVXI_NONE) return BVX_OK;

    bvxi_oblique_place_among(o, vertex, plane, planes, at);
    BVXI_TRY(bvxi_tetra_add_vertex(o, at, number));
    *found = *number;

    /* The sign is the lattice's, also where rounding gives the value another one. */
    bvxi_tetra_vertex *const v = &o->vertex[*number];
    v->lattice = 1;
    v->parent[1] = (uint32_t)slot;
    if (o->body_count != 0) {
        v->sign = 1;
        v->value = (float)bvxi_oblique_kind(o, vertex);
        return BVX_OK;
    }
    v->sign = bvxi_oblique_kind(o, vertex) ? 1 : -1;
    float const value = slot != BVXI_NONE ? o->value[slot] : bvxi_oblique_vertex_value(o, vertex);
    v->value = (value > 0.0F) == (v->sign > 0) ? value : -value;
    return BVX_OK;
}

uint32_t bvxi_oblique_cell_at(const bvxi_oblique *o, const int32_t at[3])
{
    int bit;
    /* Beyond the lattice and in cells that are not split there is nothing to be beside. */
    for (int k = 0; k < 3; k++)
        if (at[k] < 0 || at[k] >= o->side[k] - 1) return BVXI_NONE;
    uint64_t const block = bvxi_oblique_block(o, at, &bit);
    int32_t const known = o->block_at[block];
    if (known < 0 || !(o->split[known] >> bit & 1)) return BVXI_NONE;
    return o->split_first[known] + bvxi_popcount(o->split[known] & ((UINT64_C(1) << bit) - 1));
}

static int kuhn_of(int b, int c)
{
    for (int k = 0; k < 6; k++)
        if ((bvxi_kuhn[k][1] == b && bvxi_kuhn[k][2] == c) || (bvxi_kuhn[k][1] == c && bvxi_kuhn[k][2] == b))
            return k;
    return 0;
}

/* The tetrahedron across each face: in the same cell, or on the other side of the cell's. */
static void kuhn_neighbours(const bvxi_oblique *o, uint32_t cell, const int32_t at[3], int k, uint32_t n[4])
{
    int one = bvxi_kuhn[k][1], two = bvxi_kuhn[k][2];
    int const swapped = (one & (one - 1)) != 0; /* the corner two steps away comes first */
    int const near = swapped ? two : one, far = swapped ? one : two;
    int32_t next[3], before[3];

    /* The way from corner 0 to corner 7 leaves the cell's corner 0 along one axis and comes to 7 along
     * another: those are the axes across which the outer faces have their neighbours. */
    for (int x = 0; x < 3; x++) {
        next[x] = at[x] + (near >> x & 1);
        before[x] = at[x] - ((7 ^ far) >> x & 1);
    }
    uint32_t const up = bvxi_oblique_cell_at(o, next);
    uint32_t const down = bvxi_oblique_cell_at(o, before);
    /* without corner 0: the next cell along the first axis of the way, where that axis comes last */
    n[0] = up == BVXI_NONE ? BVXI_NONE : 6 * up + (uint32_t)kuhn_of(far ^ near, 7 ^ near);
    n[3] = down == BVXI_NONE ? BVXI_NONE : 6 * down + (uint32_t)kuhn_of(7 ^ far, (7 ^ far) | near);
    /* without the near corner: the first two axes in the other order; without the far one the last two */
    n[swapped ? 2 : 1] = 6 * cell + (uint32_t)kuhn_of(far ^ near, far);
    n[swapped ? 1 : 2] = 6 * cell + (uint32_t)kuhn_of(near, near | (7 ^ far));
}

static bvx_status make_tetrahedra(bvxi_oblique *o)
{
    static const char what[] = "the tetrahedra";
    uint64_t const tetra = 6 * SPLIT_ROOM * o->cell_count, vertices = 9 * o->cell_count;

    BVXI_TRY(BVXI_RESERVE(o, o->tetra, tetra, o->tetra_room, what));
    BVXI_TRY(BVXI_RESERVE_BESIDE(o, o->on, vertices, o->vertex_room, (uint64_t)o->plane_words * 8, what));
    BVXI_TRY(BVXI_RESERVE(o, o->vertex, vertices, o->vertex_room, what));

    /* Block by block, as a block's cells have the same planes near them. */
    for (uint32_t i = 0; i < o->known_count; i++) {
        uint32_t plane[BVXI_OBLIQUE_PLANES], planes;
        int32_t first[3];
        if (o->split[i] == 0) continue;
        bvxi_oblique_block_place(o, o->known[i], first);
        planes = bvxi_oblique_near_planes(o, first, plane);
        for (uint64_t c = o->split_first[i]; c < o->split_first[i + 1]; c++) {
            int32_t at[3];
            uint32_t corner[8];

            bvxi_oblique_block_place(o, o->cell[c][0], at);
            bvxi_oblique_in_block(at, (int)o->cell[c][1], at);
            for (int k = 0; k < 8; k++) {
                int32_t const place[3] = {at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2)};
                BVXI_TRY(lattice_vertex(o, place, plane, planes, &corner[k]));
            }

            /* Six around the diagonal from corner 0 to 7 (Kuhn 1960); those of neighbours meet in whole faces. */
            for (int k = 0; k < 6; k++) {
                uint32_t v[4], n[4], number;
                for (int x = 0; x < 4; x++) v[x] = corner[bvxi_kuhn[k][x]];
                kuhn_neighbours(o, (uint32_t)c, at, k, n);
                BVXI_TRY(bvxi_tetra_add(o, v, n, k == 0 ? BVXI_NONE : (uint32_t)(6 * c), &number));
            }
        }
    }
    return BVX_OK;
}

static bvx_status order_touches(bvxi_oblique *o)
{
    uint64_t const n = o->plane_count + 1;
    BVXI_TRY(BVXI_ZEROS(o->ctx, n, "the cells that planes touch", o->plane_touch));
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->touch_count, "the cells that planes touch", o->touch_cell));
    for (uint64_t i = 0; i < o->touch_count; i++) o->plane_touch[o->touch[i][1]]++;
    bvxi_place_counts32(o->plane_touch, n);
    for (uint64_t i = 0; i < o->touch_count; i++)
        o->touch_cell[o->plane_touch[o->touch[i][1]]++] = o->touch[i][0];
    /* Each begin has moved to its end, which is the next one's begin. */
    for (uint32_t i = o->plane_count; i-- > 0;) o->plane_touch[i + 1] = o->plane_touch[i];
    o->plane_touch[0] = 0;
    return BVX_OK;
}

bvx_status bvxi_oblique_cells(bvxi_oblique *o)
{
    static const char what[] = "the cells of the surface";
    uint64_t const n = o->known_count;
    bvx_context *const ctx = o->ctx;

    BVXI_TRY(BVXI_ARRAY(ctx, bvxi_oblique_kind_bits(o) * n, what, o->inside));
    BVXI_TRY(BVXI_ARRAY(ctx, n, what, o->split));
    BVXI_TRY(BVXI_ARRAY(ctx, n, what, o->active));
    BVXI_TRY(BVXI_ARRAY(ctx, n + 1, what, o->split_first));
    BVXI_TRY(BVXI_ARRAY(ctx, n + 1, what, o->touch_first));
    BVXI_TRY(BVXI_ARRAY(ctx, n * BVXI_BLOCK_SIZE, what, o->vertex_at));
    memset(o->vertex_at, 0xff, (size_t)(n * BVXI_BLOCK_SIZE * 4));

    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.1, bvxi_oblique_take_signs(o)));
    BVXI_TRY(BVXI_SHARE(ctx, 0.1, 0.4, bvxi_for(ctx, "surface", n, CELL_GRAIN, judge_cells, o)));

    uint64_t cells = 0, touches = 0;

    for (uint32_t i = 0; i <= o->known_count; i++) {
        uint32_t const own = i == o->known_count ? 0 : o->split_first[i];
        uint32_t const of = i == o->known_count ? 0 : o->touch_first[i];
        o->split_first[i] = (uint32_t)cells;
        o->touch_first[i] = (uint32_t)touches;
        cells += own;
        touches += of;
        /* Six tetrahedra a cell to begin with; numbers have 32 bits. */
        if (cells > UINT32_MAX / 6 || touches > UINT32_MAX)
            return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: more than 2^32 of the tetrahedra; take fewer cells", o->function);
    }
    o->cell_count = cells;
    o->touch_count = touches;

    BVXI_TRY(BVXI_ARRAY(ctx, o->cell_count + 1, "the cells that are split", o->cell));
    BVXI_TRY(BVXI_ARRAY(ctx, o->touch_count + 1, "the cells that planes touch", o->touch));
    BVXI_TRY(BVXI_SHARE(ctx, 0.4, 0.5, bvxi_for(ctx, "surface", n, CELL_GRAIN, list_cells, o)));
    BVXI_TRY(order_touches(o));
    return make_tetrahedra(o);
}

/* ---- planes ---- */

static int straight_side(const bvxi_oblique *o, uint32_t v, uint32_t plane, double *height)
{
    *height = bvxi_oblique_height(&o->plane[plane], o->vertex[v].at);
    if (bvxi_is_on(o, v, plane)) return 0;
    return *height > BVXI_OBLIQUE_NEAR ? 1 : *height < -BVXI_OBLIQUE_NEAR ? -1 : 0;
}

/* A near vertex is taken onto a plane only where its edge crosses it: no tetrahedron lies in a plane. */
static int side_of_plane(bvxi_oblique *o, uint32_t v, uint32_t plane, double *height)
{
    const bvxi_tetra_vertex *const x = &o->vertex[v];
    int side = straight_side(o, v, plane, height), a, b;
    double other;
    if (side != 0 || bvxi_is_on(o, v, plane)) return side;
    /* A vertex in the middle of an edge that lies on one side of the plane is on that side, however near. */
    if (x->parent[0] != BVXI_NONE) {
        a = straight_side(o, x->parent[0], plane, &other);
        b = straight_side(o, x->parent[1], plane, &other);
        if (a * b >= 0 && a + b != 0) return a + b > 0 ? 1 : -1;
    }
    bvxi_set_on(o, v, plane);
    return 0;
}

static bvx_status split_by_plane(bvxi_oblique *o, uint32_t t, uint32_t plane)
{
    for (;;) {
        double height[4], at[3], share;
        int side[4], a = -1, b = -1;
        uint32_t m;

        for (int k = 0; k < 4; k++) {
            side[k] = side_of_plane(o, o->tetra[t].v[k], plane, &height[k]);
            if (side[k] > 0) a = k;
            if (side[k] < 0) b = k;
        }
        if (a < 0 || b < 0) return BVX_OK;
        share = height[a] - height[b] > 0.0 ? height[a] / (height[a] - height[b]) : 0.5;
        /* Rounding must not put the new vertex onto an old one. */
        if (!(share > 0.0 && share < 1.0)) share = 0.5;
        const double *const from = o->vertex[o->tetra[t].v[a]].at;
        const double *const to = o->vertex[o->tetra[t].v[b]].at;
        for (int k = 0; k < 3; k++) at[k] = from[k] + share * (to[k] - from[k]);
        BVXI_TRY(bvxi_tetra_split_edge(o, t, o->tetra[t].v[a], o->tetra[t].v[b], at, &m));
        bvxi_set_on(o, m, plane);
    }
}

bvx_status bvxi_oblique_split_planes(bvxi_oblique *o)
{
    for (uint32_t p = 0; p < o->plane_count; p++) {
        BVXI_TRY(bvxi_progress(o->ctx, "surface", (double)p / o->plane_count));
        for (uint32_t i = o->plane_touch[p]; i < o->plane_touch[p + 1]; i++)
            for (uint32_t t = 6 * o->touch_cell[i]; t != BVXI_NONE; t = o->tetra[t].chain)
                BVXI_TRY(split_by_plane(o, t, p));
    }
    return BVX_OK;
}
