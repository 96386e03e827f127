/* slab.c - what lies between neighbouring planes: cells subdivided for both, and where finer corners lie on coarser sides.
 *
 * A cell is subdivided for both of its planes, and the crossings that this makes go to each plane's ring, so the cells on the
 * plane's other side get them as vertices too. */
#include "section/split.h"

#include "mesh/radix.h"

bvx_status bvxi_slab_enlarge(bvxi_stack *s, void *block, uint32_t *room, uint64_t item, const char *what)
{
    uint64_t const larger = *room < 64 ? 64 : (uint64_t)*room + *room / 2;
    if (larger > INT32_MAX) return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: more than 2^31 of %s", s->function, what);
    BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, block, *room * item, larger * item, what));
    *room = (uint32_t)larger;
    return BVX_OK;
}

/* ---- arcs by cell ---- */

bvx_status bvxi_cell_arcs_open(bvxi_stack *s, bvxi_cell_arcs *lists)
{
    uint64_t const cells = (uint64_t)s->size[0] * (uint64_t)s->size[1];
    memset(lists, 0, sizeof *lists);
    for (uint32_t i = 0; i < s->plane_count; i++)
        if (s->plane[i].arc_count > lists->link_room) lists->link_room = s->plane[i].arc_count;
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, cells * 4, "the arcs of cells", &lists->head));
    memset(lists->head, 0xff, (size_t)cells * 4);
    return bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)lists->link_room * 4, "the arcs of cells", &lists->link);
}

void bvxi_cell_arcs_set(bvxi_cell_arcs *lists, const bvxi_plane *plane)
{
    if (lists->plane != NULL)
        for (uint32_t i = 0; i < lists->plane->arc_count; i++) lists->head[lists->plane->arc_cell[i]] = BVXI_NONE;
    lists->plane = plane;
    if (plane == NULL) return;
    for (uint32_t i = plane->arc_count; i-- > 0;) {
        lists->link[i] = lists->head[plane->arc_cell[i]];
        lists->head[plane->arc_cell[i]] = i;
    }
}

void bvxi_cell_arcs_close(bvxi_stack *s, bvxi_cell_arcs *lists)
{
    bvxi_free(s->ctx, lists->link, (uint64_t)lists->link_room * 4);
    bvxi_free(s->ctx, lists->head, (uint64_t)s->size[0] * (uint64_t)s->size[1] * 4);
    memset(lists, 0, sizeof *lists);
}

/* ---- points on sides ---- */

static uint64_t hanging_key(const bvxi_hanging *h, int first)
{
    return (uint64_t)(uint32_t)h->at[first] << 32 | (uint32_t)h->at[1 - first];
}

static bvx_status sort_hanging(bvxi_stack *s, bvxi_slab *slab, uint64_t *key, uint32_t *order, bvxi_hanging *sorted)
{
    uint32_t const n = slab->hanging_count;
    uint32_t kept = 0;
    for (uint32_t i = 0; i < n; i++) {
        key[i] = hanging_key(&slab->hanging[i], 1);
        order[i] = i;
    }
    BVXI_TRY(bvxi_radix_sort(s->ctx, key, order, n));
    for (uint32_t i = 0; i < n; i++)
        if (i == 0 || key[i] != key[i - 1]) sorted[kept++] = slab->hanging[order[i]];
    memcpy(slab->hanging, sorted, kept * sizeof *sorted);
    slab->hanging_count = kept;
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)slab->hanging_room * 4, "the corners of cells", &slab->by_u));
    for (uint32_t i = 0; i < kept; i++) {
        key[i] = hanging_key(&slab->hanging[i], 0);
        slab->by_u[i] = i;
    }
    return bvxi_radix_sort(s->ctx, key, slab->by_u, kept);
}

static bvx_status order_hanging(bvxi_stack *s, bvxi_slab *slab)
{
    uint64_t const n = slab->hanging_count;
    uint64_t *key = NULL;
    uint32_t *order = NULL;
    bvxi_hanging *sorted = NULL;
    bvx_status status;
    if (n == 0) return BVX_OK;
    status = bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 8, "the order of corners", &key);
    if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 4, "the order of corners", &order);
    if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, n * sizeof *sorted, "the order of corners", &sorted);
    if (status == BVX_OK) status = sort_hanging(s, slab, key, order, sorted);
    bvxi_free(s->ctx, sorted, n * sizeof *sorted);
    bvxi_free(s->ctx, order, n * 4);
    bvxi_free(s->ctx, key, n * 8);
    return status;
}

/* ---- all slabs ---- */

/* Cells in the order of their numbers: those of arcs below, then those that only arcs above are in, sorted afterwards. */
static bvx_status split_slab(bvxi_split_work *w, bvxi_slab *slab, uint64_t *touched)
{
    bvxi_stack *const s = w->s;
    w->slab = slab;
    for (int k = 0; k < 2; k++) {
        const bvxi_plane *const p = slab->plane[k];
        bvxi_cell_arcs_set(&w->lists[k], p);
        for (uint32_t i = 0; i < p->arc_count; i++) touched[p->arc_cell[i] >> 6] |= UINT64_C(1) << (p->arc_cell[i] & 63);
    }
    for (uint64_t i = 0; i < ((uint64_t)s->size[0] * (uint64_t)s->size[1] + 63) / 64; i++) {
        uint64_t bits = touched[i];
        touched[i] = 0;
        for (uint32_t number = (uint32_t)(i * 64); bits != 0; number++, bits >>= 1) {
            while ((bits & 0xff) == 0) {
                bits >>= 8;
                number += 8;
            }
            if ((bits & 1) != 0) BVXI_TRY(bvxi_split_grid_cell(w, number));
        }
    }
    return order_hanging(s, slab);
}

static bvx_status split_slabs(bvxi_stack *s, bvxi_slab *slabs, uint32_t count)
{
    uint64_t const bytes = ((uint64_t)s->size[0] * (uint64_t)s->size[1] + 63) / 64 * 8;
    uint64_t *touched = NULL;
    bvxi_split_work w;
    bvx_status status;
    memset(&w, 0, sizeof w);
    w.s = s;
    w.last = slabs + count - 1;
    status = bvxi_cell_arcs_open(s, &w.lists[0]);
    if (status == BVX_OK) status = bvxi_cell_arcs_open(s, &w.lists[1]);
    if (status == BVX_OK) status = bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, bytes, "the cells that contours touch", &touched);
    for (uint32_t i = 0; i < count && status == BVX_OK; i++) {
        status = bvxi_progress(s->ctx, "subdivide", (double)i / count);
        if (status == BVX_OK) status = split_slab(&w, &slabs[i], touched);
    }
    bvxi_free(s->ctx, w.piece, (uint64_t)w.piece_room * sizeof *w.piece);
    bvxi_free(s->ctx, w.pool, (uint64_t)w.pool_room * sizeof *w.pool);
    bvxi_free(s->ctx, touched, bytes);
    bvxi_cell_arcs_close(s, &w.lists[1]);
    bvxi_cell_arcs_close(s, &w.lists[0]);
    return status;
}

static void set_slab(bvxi_slab *slab, bvxi_plane *below, bvxi_plane *above, double low, double high)
{
    slab->plane[0] = below;
    slab->plane[1] = above;
    slab->w[0] = low;
    slab->w[1] = high;
}

/* Between neighbours; towards an empty plane half the way; beyond the ends half a spacing when they taper. nothing: a plane without
 * loops. */
static uint32_t lay_slabs(bvxi_stack *s, bvxi_slab *slabs, bvxi_plane *nothing)
{
    uint32_t const n = s->plane_count;
    bvxi_plane *const p = s->plane;
    uint32_t count = 0;
    int const taper = s->options.caps == BVX_CAPS_TAPER;
    if (taper) set_slab(&slabs[count++], nothing, &p[0], p[0].w - 0.5 * (p[1].w - p[0].w), p[0].w);
    for (uint32_t i = 0; i + 1 < n; i++) {
        int const here = p[i].contour_count != 0, there = p[i + 1].contour_count != 0;
        double const half = p[i].w + 0.5 * (p[i + 1].w - p[i].w);
        if (here && there) set_slab(&slabs[count++], &p[i], &p[i + 1], p[i].w, p[i + 1].w);
        else if (here) set_slab(&slabs[count++], &p[i], nothing, p[i].w, half);
        else if (there) set_slab(&slabs[count++], nothing, &p[i + 1], half, p[i + 1].w);
    }
    if (taper) set_slab(&slabs[count++], &p[n - 1], nothing, p[n - 1].w, p[n - 1].w + 0.5 * (p[n - 1].w - p[n - 2].w));
    return count;
}

bvx_status bvxi_slabs_make(bvxi_stack *s, bvxi_slab **slabs, uint32_t *count)
{
    uint64_t const room = (uint64_t)s->plane_count + 1;
    bvxi_plane *const nothing = &s->nothing;
    *count = (uint32_t)room;
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, room * sizeof **slabs, "the slabs of a body", slabs));
    nothing->section = BVXI_NONE;
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, ((uint64_t)s->size[1] + 1) * (uint64_t)s->words * 8, "an empty plane", &nothing->inside));
    s->slab_count = lay_slabs(s, *slabs, nothing);
    if (s->options.crossings != BVX_CROSSINGS_EXACT) return BVX_OK;
    return split_slabs(s, *slabs, s->slab_count);
}

void bvxi_slabs_free(bvxi_stack *s, bvxi_slab *slabs, uint32_t count)
{
    if (slabs == NULL) return;
    for (uint32_t i = count; i-- > 0;) {
        bvxi_slab *const b = &slabs[i];
        bvxi_free(s->ctx, b->by_u, b->by_u == NULL ? 0 : (uint64_t)b->hanging_room * 4);
        bvxi_free(s->ctx, b->hanging, (uint64_t)b->hanging_room * sizeof *b->hanging);
        bvxi_free(s->ctx, b->arc, (uint64_t)b->arc_room * sizeof *b->arc);
        bvxi_free(s->ctx, b->leaf, (uint64_t)b->leaf_room * sizeof *b->leaf);
        bvxi_free(s->ctx, b->split, (uint64_t)b->split_room * sizeof *b->split);
    }
    bvxi_free(s->ctx, s->nothing.inside, s->nothing.inside == NULL ? 0 : ((uint64_t)s->size[1] + 1) * (uint64_t)s->words * 8);
    s->nothing.inside = NULL;
    bvxi_free(s->ctx, slabs, (uint64_t)count * sizeof *slabs);
}
