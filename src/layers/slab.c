/* slab.c - what lies between neighbouring planes: cells subdivided for both, and where finer corners lie on
 * coarser sides.
 *
 * A cell is subdivided for both of its planes, and the crossings that this makes go to each plane's ring, so
 * the cells on the plane's other side get them as vertices too. */
#include "layers/slab.h"

#include "mesh/mesh.h"

/* ---- one cell subdivided ---- */

/* Halved until a contour crosses each edge at most once and no loop lies in one cell, or down to the depth allowed.
 * A side that is crossed twice requires the same of the cells on both of its sides, so neighbours agree on every
 * edge that matters. Whether a new corner is inside follows from a known one by the crossings between them. */

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
        if (arc.from == BVXI_NONE) {
            BVXI_TRY(cut_inner_loop(w, p, &arc));
            continue;
        }
        uint32_t segment = p->cut[arc.from].segment, point = arc.point;
        piece_walk a = {.quadrant = quadrant_of_cut(w, p, &p->cut[arc.from]), .last = arc.from};
        for (uint32_t n = 0; n < arc.count; n++) {
            BVXI_TRY(walk_part(w, p, &a, segment, quadrant_of_point(w, p->q[point])));
            if (a.count++ == 0) a.point = point;
            segment = point;
            point = p->next[point];
        }
        BVXI_TRY(walk_part(w, p, &a, segment, quadrant_of_cut(w, p, &p->cut[arc.to])));
        BVXI_TRY(add_piece(w, a.quadrant, a.last, arc.to, a.point, a.count));
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
    for (int j = 0; j < 4; j++) {
        int32_t const u = c->low[0] + (j & 1) * c->size, v = c->low[1] + (j >> 1) * c->size;
        int32_t const part = (1 << w->s->fine) - 1;
        if ((u & part) == 0 && (v & part) == 0) continue; /* a grid point */
        BVXI_TRY(BVXI_SLAB_GROW(w->s, slab->hanging, slab->hanging_count, slab->hanging_room,
                                "the corners of cells"));
        slab->hanging[slab->hanging_count++] = (bvxi_hanging){
            .at = {u, v}, .inside = {c->inside[0] >> j & 1u, c->inside[1] >> j & 1u}, .vertex = BVXI_NONE};
    }
    return BVX_OK;
}

static bvx_status split_down(bvxi_split_work *w, const bvxi_split_cell *root)
{
    bvxi_split_cell stack[SPLIT_STACK];
    uint32_t top = 0;

    stack[top++] = *root;
    while (top > 0) {
        bvxi_split_cell const c = stack[--top];
        int split = 0;
        for (int k = 0; k < 2 && !split; k++) {
            uint32_t ends[4];
            split = count_ends(w->slab->plane[k], w->pool + c.arc[k], c.arc_count[k], c.low, ends) != 0 ||
                    ends[0] > 1 || ends[1] > 1 || ends[2] > 1 || ends[3] > 1;
        }
        if (split) {
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
            count_unkept(w, &c);
        }
        BVXI_TRY(add_leaf(w, &c));
    }
    return BVX_OK;
}

/* Subdivide a cell of the grid where its contours require it: leaves, arcs and corners go to the slab. */
static bvx_status split_grid_cell(bvxi_split_work *w, int32_t i, int32_t j)
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

/* ---- slabs ---- */

static uint64_t hanging_key(const bvxi_hanging *h, int first)
{
    return (uint64_t)(uint32_t)h->at[first] << 32 | (uint32_t)h->at[1 - first];
}

static bvx_status order_hanging(bvxi_split_work *w, bvxi_slab *slab)
{
    static const char what[] = "the order of corners";
    uint32_t const n = slab->hanging_count;
    uint32_t kept = 0;

    if (n == 0) return BVX_OK;
    BVXI_TRY(BVXI_RESERVE_BESIDE(w->s, w->key, n, w->sorted_room, sizeof *w->key, what));
    BVXI_TRY(BVXI_RESERVE_BESIDE(w->s, w->order, n, w->sorted_room, sizeof *w->order, what));
    BVXI_TRY(BVXI_RESERVE(w->s, w->sorted, n, w->sorted_room, what));

    /* By the second coordinate, then the first: equal points come together, as two cells report one. */
    for (uint32_t i = 0; i < n; i++) {
        w->key[i] = hanging_key(&slab->hanging[i], 1);
        w->order[i] = i;
    }
    BVXI_TRY(bvxi_radix_sort(w->s->ctx, w->key, w->order, n));
    for (uint32_t i = 0; i < n; i++)
        if (i == 0 || w->key[i] != w->key[i - 1]) w->sorted[kept++] = slab->hanging[w->order[i]];

    slab->hanging_count = kept;
    for (uint32_t i = 0; i < kept; i++) {
        w->key[i] = hanging_key(&w->sorted[i], 0);
        w->order[i] = i;
    }
    return bvxi_radix_sort(w->s->ctx, w->key, w->order, kept);
}

static bvx_status keep_part(bvx_context *ctx, void *to, const void *from, uint64_t bytes)
{
    void *kept;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the parts of cells", &kept));
    if (bytes != 0) memcpy(kept, from, (size_t)bytes);
    memcpy(to, &kept, sizeof kept);
    return BVX_OK;
}

/* ---- all slabs ---- */

static bvx_status split_slab(bvxi_split_work *w, bvxi_slab *slab)
{
    const bvxi_plane *const below = slab->plane[0], *const above = slab->plane[1];
    uint32_t i = 0, j = 0;
    bvxi_slab *const g = &w->grown;

    w->slab = g;
    /* levels of one section are split one after the other, and share its crossings */
    for (int k = 0; k < 2; k++) {
        bvxi_nesting_refresh(slab->plane[k]);
        g->plane[k] = slab->plane[k];
    }
    g->split_count = g->leaf_count = g->arc_count = g->hanging_count = 0;

    /* Both lists ascend, so merging them visits each cell once, in the order of the surface. */
    while (i < below->asking_count || j < above->asking_count) {
        uint32_t const a = i < below->asking_count ? below->asking[i] : UINT32_MAX;
        uint32_t const b = j < above->asking_count ? above->asking[j] : UINT32_MAX;
        i += a <= b;
        j += b <= a;
        BVXI_TRY(split_grid_cell(w, (int32_t)((a < b ? a : b) & 0xffff), (int32_t)((a < b ? a : b) >> 16)));
    }
    BVXI_TRY(order_hanging(w, g));
    bvx_context *const ctx = w->s->ctx;

    if (g->split_count == 0) return BVX_OK;
    slab->split_count = g->split_count;
    slab->leaf_count = g->leaf_count;
    slab->arc_count = g->arc_count;
    slab->hanging_count = g->hanging_count;
    BVXI_TRY(keep_part(ctx, &slab->split, g->split, g->split_count * sizeof *g->split));
    BVXI_TRY(keep_part(ctx, &slab->leaf, g->leaf, g->leaf_count * sizeof *g->leaf));
    BVXI_TRY(keep_part(ctx, &slab->arc, g->arc, g->arc_count * sizeof *g->arc));
    BVXI_TRY(keep_part(ctx, &slab->hanging, w->sorted, g->hanging_count * sizeof *g->hanging));
    return keep_part(ctx, &slab->by_u, w->order, g->hanging_count * sizeof *slab->by_u);
}

static void set_slab(bvxi_slab *slab, bvxi_plane *below, bvxi_plane *above, double low, double high)
{
    slab->plane[0] = below;
    slab->plane[1] = above;
    slab->w[0] = low;
    slab->w[1] = high;
}

/* The plane beyond one side of a slab, which a cubic blend looks at; side: 0 below, 1 above. A nesting level
 * goes on in its own kind; the outermost one also in a whole section that has no holes. */
static const bvxi_plane *plane_beyond(const bvxi_stack *s, const bvxi_slab *slabs, uint32_t slab, int side)
{
    const bvxi_slab *const b = &slabs[slab];
    uint32_t const last = s->plane_count - 1,
                   levels = s->nesting.count == NULL ? 1 : s->nesting.count[b->below];

    /* The first and last section have nothing beyond; a plane without contours would have no distances. */
    if (side == 0 ? b->below == 0 : b->below + 1 == last) return NULL;
    const bvxi_plane *whole = &s->plane[side == 0 ? b->below - 1 : b->below + 2];
    if (whole->contour_count == 0) return NULL;
    if (b->plane[0]->whole == NULL) return whole;
    if (s->nesting.joined[b->below] != BVXI_LEVELS_APART) return NULL;

    uint32_t const other = s->nesting.count[side == 0 ? b->below - 1 : b->below + 1];
    if (other > 1) {
        if (b->level >= other) return NULL;
        return side == 0 ? slabs[slab - other].plane[0] : slabs[slab + levels].plane[1];
    }
    for (uint32_t c = 0; c < whole->contour_count; c++)
        if (whole->contour[c].hole) return NULL;
    return b->level == 0 ? whole : NULL;
}

/* Between neighbours; to an empty plane half the way; beyond tapers half a spacing. nothing: no loops. */
static uint32_t lay_slabs(bvxi_stack *s, bvxi_slab *slabs, bvxi_plane *nothing)
{
    uint32_t const n = s->plane_count;
    bvxi_plane *const p = s->plane;
    uint32_t count = 0;
    bvxi_plane *level = s->nesting.plane;
    int const taper = s->options.caps == BVX_CAPS_TAPER;

    slabs[0].below = BVXI_NONE;
    if (taper) set_slab(&slabs[count++], nothing, &p[0], p[0].w - s->reach[0], p[0].w);
    for (uint32_t i = 0; i + 1 < n; i++) {
        int const here = p[i].contour_count != 0, there = p[i + 1].contour_count != 0;
        double const half = p[i].w + 0.5 * (p[i + 1].w - p[i].w);
        if (level != NULL && s->nesting.count[i] > 1) {
            /* Each nesting level between two planes is a slab of its own. */
            for (uint32_t k = 0; k < s->nesting.count[i]; k++, level += 2) {
                slabs[count].below = i;
                slabs[count].level = k;
                set_slab(&slabs[count++], &level[0], &level[1], p[i].w, p[i + 1].w);
            }
            continue;
        }
        slabs[count].below = i;

        if (here && there) set_slab(&slabs[count++], &p[i], &p[i + 1], p[i].w, p[i + 1].w);
        else if (here) set_slab(&slabs[count++], &p[i], nothing, p[i].w, half);
        else if (there) set_slab(&slabs[count++], nothing, &p[i + 1], half, p[i + 1].w);
    }
    slabs[count].below = n - 1;
    if (taper) set_slab(&slabs[count++], &p[n - 1], nothing, p[n - 1].w, p[n - 1].w + s->reach[1]);
    return count;
}

bvx_status bvxi_slabs_make(bvxi_stack *s, bvxi_slab **slabs)
{
    uint64_t const room = (uint64_t)s->plane_count + 2 + s->nesting.plane_count; /* the last stays free */
    bvxi_plane *const nothing = &s->nothing;
    bvxi_split_work w = {.s = s};

    BVXI_TRY(BVXI_ZEROS(s->ctx, room, "the slabs of a body", *slabs));

    /* An empty plane of the right size stands for what is not there: later steps need no case for ends. */
    nothing->section = BVXI_NONE;
    BVXI_TRY(BVXI_ZEROS(s->ctx, bvxi_stack_words(s), "an empty plane", nothing->inside));
    s->slab_count = lay_slabs(s, *slabs, nothing);
    for (uint32_t i = 0; i < s->slab_count && s->cubic; i++) {
        bvxi_slab *const b = &(*slabs)[i];
        if (bvxi_plane_is_nothing(b->plane[0]) || bvxi_plane_is_nothing(b->plane[1])) continue;
        for (int side = 0; side < 2; side++) b->far[side] = plane_beyond(s, *slabs, i, side);
    }

    /* Only exact contours cross an edge more than once; interpolated crossings have one an edge. */
    for (uint32_t i = 0; i < s->slab_count && s->options.slabs.crossings == BVX_CROSSINGS_EXACT; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "subdivide", (double)i / s->slab_count));
        w.is_last = (*slabs)[i].below == (*slabs)[s->slab_count - 1].below;
        BVXI_TRY(split_slab(&w, &(*slabs)[i]));
    }
    return BVX_OK;
}
