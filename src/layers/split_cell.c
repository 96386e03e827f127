/* split_cell.c - one cell of the grid, subdivided until a contour crosses each edge at most once and no loop
 * lies in one cell.
 *
 * The halves of a cell are tested again, down to the depth allowed. A side that is crossed twice requires the
 * same from the cells on both of its sides, so neighbours agree on every edge that matters; a coarser
 * neighbour has the corners of finer cells on its side as points between the ends. Whether a new corner is
 * inside follows from a known one by the crossings between them. */
#include "layers/slab.h"

enum { SPLIT_STACK = 4 * (BVXI_SECTION_DEEPEST + 1) };

/* Crossings of the cell's sides by arcs of one plane; returns loops inside. */
static uint32_t count_ends(const bvxi_plane *p, const bvxi_arc *arc, uint32_t count, const int32_t low[2],
                           uint32_t ends[4])
{
    uint32_t inner = 0;
    ends[0] = ends[1] = ends[2] = ends[3] = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (arc[i].from == BVXI_NONE) {
            inner++;
            continue;
        }
        ends[bvxi_side_of(&p->cut[arc[i].from], low)]++;
        ends[bvxi_side_of(&p->cut[arc[i].to], low)]++;
    }
    return inner;
}

static int asks_for_split(const bvxi_split_work *w, const bvxi_split_cell *c)
{
    for (int k = 0; k < 2; k++) {
        uint32_t ends[4];
        if (count_ends(w->slab->plane[k], w->pool + c->arc[k], c->arc_count[k], c->low, ends) != 0) return 1;
        if (ends[0] > 1 || ends[1] > 1 || ends[2] > 1 || ends[3] > 1) return 1;
    }
    return 0;
}

/* Counts are of planes, of which most have a slab on either side: the one
 * above counts, for the last plane the one below. */
/* What is still crossed more than once is counted once an edge: at its cell with higher coordinates. */
static void count_unkept(bvxi_split_work *w, const bvxi_split_cell *c)
{
    bvxi_stack *const s = w->s;

    for (int k = 0; k < 2; k++) {
        if (k != 0 && !w->is_last) continue;
        const bvxi_plane *const p = w->slab->plane[k];
        double const middle[2] = {bvxi_fixed_u(s, 0, c->low[0] + c->size / 2),
                                  bvxi_fixed_u(s, 1, c->low[1] + c->size / 2)};
        uint32_t ends[4];
        uint32_t const inner = count_ends(p, w->pool + c->arc[k], c->arc_count[k], c->low, ends);
        s->report.unkept_loops += inner;
        if (inner != 0) bvxi_section_locate(s, middle[0], middle[1], p->w);
        /* Its other two sides are the lower ones of the cells beyond, and counted there. */
        if (ends[0] > 1) {
            s->report.unkept_edges++;
            bvxi_section_locate(s, middle[0], bvxi_fixed_u(s, 1, c->low[1]), p->w);
        }
        if (ends[3] > 1) {
            s->report.unkept_edges++;
            bvxi_section_locate(s, bvxi_fixed_u(s, 0, c->low[0]), middle[1], p->w);
        }
    }
}

/* ---- splitting ---- */

static bvx_status add_to_pool(bvxi_split_work *w, const bvxi_arc *arc)
{
    BVXI_TRY(BVXI_SLAB_GROW(w->s, w->pool, w->pool_count, w->pool_room, "the arcs of cells"));
    w->pool[w->pool_count++] = *arc;
    return BVX_OK;
}

static bvx_status add_piece(bvxi_split_work *w, uint32_t quadrant, uint32_t from, uint32_t to, uint32_t point,
                            uint32_t count)
{
    BVXI_TRY(BVXI_SLAB_GROW(w->s, w->piece, w->piece_count, w->piece_room, "the pieces of arcs"));
    bvxi_split_piece *const p = &w->piece[w->piece_count++];
    p->quadrant = quadrant;
    p->arc.from = from;
    p->arc.to = to;
    p->arc.point = point;
    p->arc.count = count;
    return BVX_OK;
}

static uint32_t quadrant_of_point(const bvxi_split_work *w, const int32_t q[2])
{
    /* Points are odd and middles even, so no point lies on a middle line. */
    return (uint32_t)(q[0] > w->middle[0]) | (uint32_t)(q[1] > w->middle[1]) << 1;
}

static uint32_t quadrant_of_cut(const bvxi_split_work *w, const bvxi_plane *p, const bvxi_line_cut *c)
{
    uint32_t const own = c->line > w->middle[c->axis];
    uint32_t const other = (uint32_t)bvxi_cut_beyond(p, c, w->middle[1 - c->axis]);
    return c->axis == 0 ? own | other << 1 : other | own << 1;
}

typedef struct piece_walk {
    uint32_t quadrant, last, point, count;
    uint32_t head_to, head_point, head_count; /* of a loop, before its first cut */
} piece_walk;

static bvx_status cross_middle(bvxi_split_work *w, bvxi_plane *p, piece_walk *a, uint32_t segment, int axis)
{
    uint32_t cut = BVXI_NONE;

    /* Where it passes a middle line decides which of the new corners change sides. */
    BVXI_TRY(bvxi_plane_add_cut(w->s, p, segment, axis, w->middle[axis], &cut));
    if (axis == 0) w->odd_u[a->quadrant >> 1] ^= 1;
    else w->odd_v[a->quadrant & 1] ^= 1;
    /* A loop has no beginning yet: what was walked so far belongs to its last piece. */
    if (a->last == BVXI_NONE) {
        a->head_to = cut;
        a->head_point = a->point;
        a->head_count = a->count;
    } else {
        BVXI_TRY(add_piece(w, a->quadrant, a->last, cut, a->point, a->count));
    }
    a->last = cut;
    a->count = 0;
    a->quadrant ^= 1u << axis;
    return BVX_OK;
}

static bvx_status walk_part(bvxi_split_work *w, bvxi_plane *p, piece_walk *a, uint32_t segment, uint32_t end)
{
    uint32_t const change = a->quadrant ^ end;
    int first = (change & 1) != 0 ? 0 : 1;
    if (change == 0) return BVX_OK;
    if (change == 3) first = !bvxi_x_first(p->q[segment], p->q[p->next[segment]], w->middle[0], w->middle[1]);
    BVXI_TRY(cross_middle(w, p, a, segment, first));
    return change == 3 ? cross_middle(w, p, a, segment, 1 - first) : BVX_OK;
}

static bvx_status cut_open_arc(bvxi_split_work *w, bvxi_plane *p, const bvxi_arc *arc)
{
    uint32_t segment = p->cut[arc->from].segment, point = arc->point;
    piece_walk a = {.quadrant = quadrant_of_cut(w, p, &p->cut[arc->from]), .last = arc->from};
    for (uint32_t i = 0; i < arc->count; i++) {
        BVXI_TRY(walk_part(w, p, &a, segment, quadrant_of_point(w, p->q[point])));
        if (a.count++ == 0) a.point = point;
        segment = point;
        point = p->next[point];
    }
    BVXI_TRY(walk_part(w, p, &a, segment, quadrant_of_cut(w, p, &p->cut[arc->to])));
    return add_piece(w, a.quadrant, a.last, arc->to, a.point, a.count);
}

static bvx_status cut_inner_loop(bvxi_split_work *w, bvxi_plane *p, const bvxi_arc *arc)
{
    uint32_t point = arc->point;
    piece_walk a = {.quadrant = quadrant_of_point(w, p->q[point]), .last = BVXI_NONE};
    for (uint32_t i = 0; i < arc->count; i++) {
        if (a.count++ == 0) a.point = point;
        BVXI_TRY(walk_part(w, p, &a, point, quadrant_of_point(w, p->q[p->next[point]])));
        point = p->next[point];
    }
    if (a.last == BVXI_NONE) return add_piece(w, a.quadrant, BVXI_NONE, BVXI_NONE, arc->point, arc->count);
    /* The last piece goes on into what was walked before the first cut. */
    return add_piece(w, a.quadrant, a.last, a.head_to, a.count != 0 ? a.point : a.head_point,
                     a.count + a.head_count);
}

/* Which of the nine corners of the four quarters are inside, as bits from low to high u, row by row. */
static uint32_t corners_of_quarters(const bvxi_split_work *w, const bvxi_plane *p, const bvxi_split_cell *c,
                                    int k)
{
    uint32_t const in = c->inside[k];
    uint32_t odd[4] = {0, 0, 0, 0}; /* of the lower half of each side */

    /* A new corner in a side's middle is as the side's low end is, but for the crossings between. */
    for (uint32_t i = 0; i < c->arc_count[k]; i++) {
        const bvxi_arc *const a = &w->pool[c->arc[k] + i];
        if (a->from == BVXI_NONE) continue;
        for (int e = 0; e < 2; e++) {
            const bvxi_line_cut *const cut = &p->cut[e ? a->to : a->from];
            if (!bvxi_cut_beyond(p, cut, w->middle[1 - cut->axis])) odd[bvxi_side_of(cut, c->low)] ^= 1;
        }
    }
    /* Corners are known; the middle of the cell follows from the bottom's along the line to it. */
    uint32_t const bottom = (in & 1) ^ odd[0];
    uint32_t const right = (in >> 1 & 1) ^ odd[1];
    uint32_t const top = (in >> 2 & 1) ^ odd[2];
    uint32_t const left = (in & 1) ^ odd[3];
    uint32_t const centre = bottom ^ w->odd_u[0];
    return (in & 1) | bottom << 1 | (in >> 1 & 1) << 2 | left << 3 | centre << 4 | right << 5 |
           (in >> 2 & 1) << 6 | top << 7 | (in >> 3 & 1) << 8;
}

static bvx_status split_plane(bvxi_split_work *w, const bvxi_split_cell *c, int k, bvxi_split_cell quarter[4])
{
    bvxi_plane *const p = w->slab->plane[k];

    w->piece_count = 0;
    memset(w->odd_u, 0, sizeof w->odd_u);
    memset(w->odd_v, 0, sizeof w->odd_v);
    for (uint32_t i = 0; i < c->arc_count[k]; i++) {
        bvxi_arc const arc = w->pool[c->arc[k] + i];
        BVXI_TRY(arc.from == BVXI_NONE ? cut_inner_loop(w, p, &arc) : cut_open_arc(w, p, &arc));
    }

    uint32_t const corners = corners_of_quarters(w, p, c, k);
    for (uint32_t j = 0; j < 4; j++) {
        uint32_t const at = (j & 1) + 3 * (j >> 1);
        quarter[j].inside[k] = (uint8_t)((corners >> at & 3) | (corners >> (at + 3) & 3) << 2);
        quarter[j].arc[k] = w->pool_count;
        for (uint32_t i = 0; i < w->piece_count; i++)
            if (w->piece[i].quadrant == j) BVXI_TRY(add_to_pool(w, &w->piece[i].arc));
        quarter[j].arc_count[k] = w->pool_count - quarter[j].arc[k];
    }
    return BVX_OK;
}

static bvx_status add_hanging(bvxi_split_work *w, int32_t u, int32_t v, uint32_t below, uint32_t above)
{
    bvxi_slab *const slab = w->slab;
    int32_t const part = (1 << w->s->fine) - 1;

    if ((u & part) == 0 && (v & part) == 0) return BVX_OK; /* a grid point */
    BVXI_TRY(
        BVXI_SLAB_GROW(w->s, slab->hanging, slab->hanging_count, slab->hanging_room, "the corners of cells"));
    bvxi_hanging *const h = &slab->hanging[slab->hanging_count++];
    memset(h, 0, sizeof *h);
    h->at[0] = u;
    h->at[1] = v;
    h->inside[0] = (uint8_t)below;
    h->inside[1] = (uint8_t)above;
    h->vertex = BVXI_NONE;
    return BVX_OK;
}

static bvx_status add_leaf(bvxi_split_work *w, const bvxi_split_cell *c)
{
    bvxi_slab *const slab = w->slab;

    BVXI_TRY(BVXI_SLAB_GROW(w->s, slab->leaf, slab->leaf_count, slab->leaf_room, "the parts of cells"));
    bvxi_leaf *const leaf = &slab->leaf[slab->leaf_count++];
    memset(leaf, 0, sizeof *leaf);
    leaf->low[0] = c->low[0];
    leaf->low[1] = c->low[1];
    leaf->size = c->size;
    /* The arcs of both planes are copied, as the pool serves the next cell. */
    for (int k = 0; k < 2; k++) {
        leaf->inside[k] = c->inside[k];
        leaf->arc[k] = slab->arc_count;
        leaf->arc_count[k] = c->arc_count[k];
        for (uint32_t i = 0; i < c->arc_count[k]; i++) {
            BVXI_TRY(BVXI_SLAB_GROW(w->s, slab->arc, slab->arc_count, slab->arc_room, "the arcs of cells"));
            slab->arc[slab->arc_count++] = w->pool[c->arc[k] + i];
        }
    }

    /* All four corners, again and again where leaves meet; they are sorted and made one afterwards. */
    for (int j = 0; j < 4; j++)
        BVXI_TRY(add_hanging(w, c->low[0] + (j & 1) * c->size, c->low[1] + (j >> 1) * c->size,
                             c->inside[0] >> j & 1u, c->inside[1] >> j & 1u));
    return BVX_OK;
}

static bvx_status split_down(bvxi_split_work *w, const bvxi_split_cell *root)
{
    bvxi_split_cell stack[SPLIT_STACK];
    uint32_t top = 0;

    stack[top++] = *root;
    while (top > 0) {
        bvxi_split_cell const c = stack[--top];
        if (asks_for_split(w, &c)) {
            if (c.depth < w->s->options.slabs.depth) {
                bvxi_split_cell quarter[4];
                int32_t const half = c.size / 2;
                /* Sizes are powers of two, and lines stay even until the deepest: middles are whole numbers. */
                w->middle[0] = c.low[0] + half;
                w->middle[1] = c.low[1] + half;
                for (int j = 0; j < 4; j++) {
                    quarter[j].low[0] = c.low[0] + (j & 1) * half;
                    quarter[j].low[1] = c.low[1] + (j >> 1) * half;
                    quarter[j].size = half;
                    quarter[j].depth = c.depth + 1;
                }
                BVXI_TRY(split_plane(w, &c, 0, quarter));
                BVXI_TRY(split_plane(w, &c, 1, quarter));

                for (int j = 4; j-- > 0;) stack[top++] = quarter[j];
                continue;
            }
            /* No deeper: what is crossed more than once stays so, and is counted. */
            count_unkept(w, &c);
        }
        BVXI_TRY(add_leaf(w, &c));
    }
    return BVX_OK;
}

bvx_status bvxi_split_grid_cell(bvxi_split_work *w, int32_t i, int32_t j)
{
    bvxi_stack *const s = w->s;
    bvxi_slab *const slab = w->slab;
    bvxi_split_cell c = {0};

    w->pool_count = 0;
    c.low[0] = i << s->fine;
    c.low[1] = j << s->fine;
    c.size = 1 << s->fine;
    for (int k = 0; k < 2; k++) {
        const bvxi_plane *const p = slab->plane[k];
        c.inside[k] = (uint8_t)(bvxi_grid_bit(s, p, i, j) | bvxi_grid_bit(s, p, i + 1, j) << 1 |
                                bvxi_grid_bit(s, p, i, j + 1) << 2 | bvxi_grid_bit(s, p, i + 1, j + 1) << 3);
        c.arc[k] = w->pool_count;
        uint32_t const first = bvxi_plane_arcs_in(p, bvxi_cell_key(i, j), &c.arc_count[k]);
        for (uint32_t a = first; a < first + c.arc_count[k]; a++) BVXI_TRY(add_to_pool(w, &p->arc[a]));
    }
    if (s->options.slabs.depth == 0) {
        count_unkept(w, &c);
        return BVX_OK;
    }
    BVXI_TRY(BVXI_SLAB_GROW(s, slab->split, slab->split_count, slab->split_room, "the subdivided cells"));
    bvxi_split *const split = &slab->split[slab->split_count++];
    split->cell = bvxi_cell_key(i, j);
    split->leaf = slab->leaf_count;
    BVXI_TRY(split_down(w, &c));
    /* By its number: the array may have moved when cells were added. */
    slab->split[slab->split_count - 1].leaf_count = slab->leaf_count - split->leaf;
    return BVX_OK;
}
