/* oblique_cells.c - which cells of the lattice become tetrahedra of their own, and what planes make of them.
 *
 * Source: Kuhn. Some combinatorial lemmas in topology. 1960 (a cube as six tetrahedra along its ways from one
 * corner to the opposite one: those of all cubes meet in whole faces).
 *
 * A cell that no plane touches needs no more than the signs of its corners. One that a plane touches is split
 * where a contour runs through it, its corners differ, or the plane says another thing than they do. A face
 * between a split cell and one that is not has one sign all over, or no plane in it: nothing of the surface
 * is lost there. */
#include "section/oblique.h"

/* Corners as bits x, y, z; positive. Entries 6 on: the axes in order of each way. */
const uint8_t bvxi_kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                 {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

enum { CELL_NODES = 125 };

/* A block of cells as it is looked at: its vertices and those behind it. */
typedef struct oblique_cell_work {
    double (*height)[CELL_NODES]; /* of each plane that is in the block */
    uint32_t *plane;
    uint32_t planes;
    uint8_t inside[CELL_NODES];
} oblique_cell_work;

static int node_of(int c, int corner)
{
    return (c & 3) + (corner & 1) + 5 * ((c >> 2 & 3) + (corner >> 1 & 1)) + 25 * ((c >> 4) + (corner >> 2));
}

static void look_at_block(const bvxi_oblique *o, const int32_t first[3], oblique_cell_work *w)
{
    double const centre[3] = {first[0] + 2.0, first[1] + 2.0, first[2] + 2.0};

    w->planes = 0;
    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_oblique_plane *const p = &o->plane[i];
        double const reach = 2.0 * (bvxi_absolute(p->normal[0]) + bvxi_absolute(p->normal[1]) +
                                    bvxi_absolute(p->normal[2]));
        if (bvxi_absolute(bvxi_oblique_height(p, centre)) <= reach + 0.5) w->plane[w->planes++] = i;
    }
    for (int n = 0; n < CELL_NODES; n++) {
        int32_t const at[3] = {first[0] + n % 5, first[1] + n / 5 % 5, first[2] + n / 25};
        double place[3];
        if (at[0] >= o->side[0] || at[1] >= o->side[1] || at[2] >= o->side[2]) {
            w->inside[n] = 0;
            for (uint32_t i = 0; i < w->planes; i++) w->height[i][n] = 1.0;
            continue;
        }
        w->inside[n] = (uint8_t)bvxi_oblique_inside(o, at);
        if (w->planes == 0) continue;
        bvxi_oblique_place_among(o, at, w->plane, w->planes, place);
        for (uint32_t i = 0; i < w->planes; i++)
            w->height[i][n] = bvxi_oblique_height(&o->plane[w->plane[i]], place);
    }
}

static int touches(const oblique_cell_work *w, uint32_t plane, int cell)
{
    int above = 0, below = 0;

    for (int c = 0; c < 8; c++) {
        double const h = w->height[plane][node_of(cell, c)];
        above |= h >= -BVXI_OBLIQUE_NEAR;
        below |= h <= BVXI_OBLIQUE_NEAR;
    }
    return above && below;
}

/* Put a cell among those that are split, with the planes in it, where there is a reason. */
static bvx_status judge_cell(bvxi_oblique *o, const oblique_cell_work *w, uint32_t known, int cell,
                             const int32_t at[3])
{
    uint64_t const first = o->touch_count;
    uint32_t const block = o->known[known];
    int const sign = w->inside[node_of(cell, 0)];
    int mixed = 0, wanted;

    for (int c = 1; c < 8; c++) mixed |= w->inside[node_of(cell, c)] != sign;
    wanted = mixed || (o->contour_cells[block] >> cell & 1);
    if (mixed) o->active[known] |= UINT64_C(1) << cell;
    for (uint32_t i = 0; i < w->planes; i++) {
        double place[3];
        if (!touches(w, i, cell)) continue;
        BVXI_TRY(bvxi_oblique_grow(o, &o->touch, o->touch_count, &o->touch_room, sizeof *o->touch,
                                   "the cells that planes touch"));
        o->touch[o->touch_count][0] = (uint32_t)o->cell_count;
        o->touch[o->touch_count++][1] = w->plane[i];
        if (!wanted && bvxi_oblique_in_cube(&o->plane[w->plane[i]], at, 1.0, place))
            wanted = (bvxi_oblique_side(o, w->plane[i], place) > 0) != sign;
    }
    if (!wanted) o->touch_count = first;
    if (o->touch_count == first) return BVX_OK;
    BVXI_TRY(bvxi_oblique_grow(o, &o->cell, o->cell_count, &o->cell_room, sizeof *o->cell,
                               "the cells that are split"));
    o->cell[o->cell_count][0] = block;
    o->cell[o->cell_count][1] = (uint32_t)cell;
    o->cell_at[(uint64_t)known * BVXI_BLOCK_SIZE + (uint64_t)cell] = (uint32_t)o->cell_count++;
    o->active[known] &= ~(UINT64_C(1) << cell);
    return BVX_OK;
}

static bvx_status judge_blocks(bvxi_oblique *o, oblique_cell_work *w)
{
    for (uint32_t i = 0; i < o->known_count; i++) {
        int32_t first[3];

        bvxi_oblique_block_place(o, o->known[i], first);
        look_at_block(o, first, w);
        for (int c = 0; c < BVXI_BLOCK_SIZE; c++) {
            int32_t const at[3] = {first[0] + (c & 3), first[1] + (c >> 2 & 3), first[2] + (c >> 4)};
            if (at[0] + 1 < o->side[0] && at[1] + 1 < o->side[1] && at[2] + 1 < o->side[2])
                BVXI_TRY(judge_cell(o, w, i, c, at));
        }
    }
    return BVX_OK;
}

/* ---- tetrahedra ---- */

bvx_status bvxi_oblique_lattice_vertex(bvxi_oblique *o, const int32_t vertex[3], uint32_t *number)
{
    int bit;
    uint64_t const block = bvxi_oblique_block(o, vertex, &bit);
    uint32_t *found;
    bvxi_tetra_vertex *v;
    double at[3];
    float value;

    BVXI_TRY(bvxi_edge_add(o, &o->lattice_vertex, (uint32_t)block + 64, (uint32_t)bit, &found));
    *number = *found;
    if (*found != BVXI_NONE) return BVX_OK;
    bvxi_oblique_place(o, vertex, at);
    BVXI_TRY(bvxi_tetra_add_vertex(o, at, number));
    *found = *number;
    v = &o->vertex[*number];
    v->lattice = 1;
    v->sign = bvxi_oblique_inside(o, vertex) ? 1 : -1;
    value = o->block_at[block] >= 0 ? o->value[(uint64_t)o->block_at[block] * BVXI_BLOCK_SIZE + (uint64_t)bit]
                                    : bvxi_oblique_vertex_value(o, vertex);
    v->value = (value > 0.0F) == (v->sign > 0) ? value : -value;
    return BVX_OK;
}

/* The cell at a place among those that are split. */
static uint32_t split_cell_at(const bvxi_oblique *o, const int32_t at[3])
{
    int bit;
    uint64_t block;

    for (int k = 0; k < 3; k++)
        if (at[k] < 0 || at[k] >= o->side[k] - 1) return BVXI_NONE;
    block = bvxi_oblique_block(o, at, &bit);
    if (o->block_at[block] < 0) return BVXI_NONE;
    return o->cell_at[(uint64_t)o->block_at[block] * BVXI_BLOCK_SIZE + (uint64_t)bit];
}

uint32_t bvxi_oblique_cell_at(const bvxi_oblique *o, const int32_t at[3])
{
    return split_cell_at(o, at);
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
    uint32_t up, down;

    for (int x = 0; x < 3; x++) {
        next[x] = at[x] + (near >> x & 1);
        before[x] = at[x] - ((7 ^ far) >> x & 1);
    }
    up = split_cell_at(o, next);
    down = split_cell_at(o, before);
    /* without corner 0: the next cell along the first axis of the way, where that axis comes last */
    n[0] = up == BVXI_NONE ? BVXI_NONE : 6 * up + (uint32_t)kuhn_of(far ^ near, 7 ^ near);
    n[3] = down == BVXI_NONE ? BVXI_NONE : 6 * down + (uint32_t)kuhn_of(7 ^ far, (7 ^ far) | near);
    /* without the near corner: the first two axes in the other order; without the far one the last two */
    n[swapped ? 2 : 1] = 6 * cell + (uint32_t)kuhn_of(far ^ near, far);
    n[swapped ? 1 : 2] = 6 * cell + (uint32_t)kuhn_of(near, near | (7 ^ far));
}

static bvx_status make_tetrahedra(bvxi_oblique *o)
{
    for (uint64_t i = 0; i < o->cell_count; i++) {
        int32_t at[3];
        int const c = (int)o->cell[i][1];
        uint32_t corner[8];

        bvxi_oblique_block_place(o, o->cell[i][0], at);
        at[0] += c & 3;
        at[1] += c >> 2 & 3;
        at[2] += c >> 4;
        for (int k = 0; k < 8; k++) {
            int32_t const place[3] = {at[0] + (k & 1), at[1] + (k >> 1 & 1), at[2] + (k >> 2)};
            BVXI_TRY(bvxi_oblique_lattice_vertex(o, place, &corner[k]));
        }
        for (int k = 0; k < 6; k++) {
            uint32_t v[4], n[4], number;
            for (int x = 0; x < 4; x++) v[x] = corner[bvxi_kuhn[k][x]];
            kuhn_neighbours(o, (uint32_t)i, at, k, n);
            BVXI_TRY(bvxi_tetra_add(o, v, n, k == 0 ? BVXI_NONE : (uint32_t)(6 * i), &number));
        }
    }
    return BVX_OK;
}

/* Cells in the order of the planes that touch them. */
static bvx_status order_touches(bvxi_oblique *o)
{
    uint64_t const n = o->plane_count + 1;

    BVXI_TRY(bvxi_alloc_zero(o->ctx, BVXI_SCRATCH, n * 4, "the cells that planes touch", &o->plane_touch));
    BVXI_TRY(
        bvxi_alloc(o->ctx, BVXI_SCRATCH, o->touch_count * 4, "the cells that planes touch", &o->touch_cell));
    for (uint64_t i = 0; i < o->touch_count; i++) o->plane_touch[o->touch[i][1]]++;
    for (uint32_t i = 0, sum = 0; i <= o->plane_count; i++) {
        uint32_t const count = o->plane_touch[i];
        o->plane_touch[i] = sum;
        sum += count;
    }
    for (uint64_t i = 0; i < o->touch_count; i++)
        o->touch_cell[o->plane_touch[o->touch[i][1]]++] = o->touch[i][0];
    for (uint32_t i = o->plane_count; i-- > 0;) o->plane_touch[i + 1] = o->plane_touch[i];
    o->plane_touch[0] = 0;
    return BVX_OK;
}

bvx_status bvxi_oblique_cells(bvxi_oblique *o)
{
    uint64_t const nodes = (uint64_t)o->plane_count * sizeof(double[CELL_NODES]);
    oblique_cell_work w;
    bvx_status status;

    o->cell_at_room = o->known_count;
    memset(&w, 0, sizeof w);
    BVXI_TRY(bvxi_alloc(o->ctx, BVXI_SCRATCH, o->cell_at_room * BVXI_BLOCK_SIZE * 4,
                        "the cells that are split", &o->cell_at));
    BVXI_TRY(
        bvxi_alloc_zero(o->ctx, BVXI_SCRATCH, o->cell_at_room * 8, "the cells of the surface", &o->active));
    memset(o->cell_at, 0xff, (size_t)(o->cell_at_room * BVXI_BLOCK_SIZE * 4));
    status = bvxi_alloc(o->ctx, BVXI_SCRATCH, nodes, "the heights over planes", &w.height);
    if (status == BVX_OK)
        status = bvxi_alloc(o->ctx, BVXI_SCRATCH, (uint64_t)o->plane_count * 4, "the planes of a block",
                            &w.plane);
    if (status == BVX_OK) status = judge_blocks(o, &w);
    bvxi_drop(o->ctx, w.plane);
    bvxi_drop(o->ctx, w.height);
    if (status != BVX_OK) return status;
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

/* A vertex is taken onto a plane by its nearness only where its edge crosses the plane: so no tetrahedron
 * ever lies in a plane with all its corners. */
static int side_of_plane(bvxi_oblique *o, uint32_t v, uint32_t plane, double *height)
{
    const bvxi_tetra_vertex *const x = &o->vertex[v];
    int side = straight_side(o, v, plane, height), a, b;
    double other;

    if (side != 0 || bvxi_is_on(o, v, plane)) return side;
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
        const double *from, *to;
        uint32_t m;

        for (int k = 0; k < 4; k++) {
            side[k] = side_of_plane(o, o->tetra[t].v[k], plane, &height[k]);
            if (side[k] > 0) a = k;
            if (side[k] < 0) b = k;
        }
        if (a < 0 || b < 0) return BVX_OK;
        share = height[a] - height[b] > 0.0 ? height[a] / (height[a] - height[b]) : 0.5;
        if (!(share > 0.0 && share < 1.0)) share = 0.5;
        from = o->vertex[o->tetra[t].v[a]].at;
        to = o->vertex[o->tetra[t].v[b]].at;
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
            for (uint32_t t = 6 * o->touch_cell[i]; t != BVXI_NONE; t = o->chain[t])
                BVXI_TRY(split_by_plane(o, t, p));
    }
    return BVX_OK;
}
