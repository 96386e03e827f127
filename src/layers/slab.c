/* slab.c - what lies between neighbouring planes: cells subdivided for both, and where finer corners lie on
 * coarser sides.
 *
 * A cell is subdivided for both of its planes, and the crossings that this makes go to each plane's ring, so
 * the cells on the plane's other side get them as vertices too. */
#include "layers/slab.h"

#include "mesh/mesh.h"

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
    BVXI_TRY(BVXI_RESERVE(w->s, w->key, n, w->key_room, what));
    BVXI_TRY(BVXI_RESERVE(w->s, w->order, n, w->order_room, what));
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

/* Copy a part of the slab's block; all of them are of four byte numbers or less. */
static unsigned char *keep_part(unsigned char *to, const void *from, uint64_t bytes)
{
    if (bytes != 0) memcpy(to, from, (size_t)bytes);
    return to + bytes;
}

static bvx_status keep_slab(bvxi_split_work *w, bvxi_slab *slab)
{
    const bvxi_slab *const g = &w->grown;
    uint64_t const split = g->split_count * sizeof *g->split;
    uint64_t const leaf = g->leaf_count * sizeof *g->leaf;
    uint64_t const arc = g->arc_count * sizeof *g->arc;
    uint64_t const hanging = g->hanging_count * sizeof *g->hanging, by_u = (uint64_t)g->hanging_count * 4;
    unsigned char *at;

    if (g->split_count == 0) return BVX_OK;

    /* One block, since slabs are many and most are small. */
    BVXI_TRY(
        bvxi_alloc(w->s->ctx, BVXI_SCRATCH, split + leaf + arc + hanging + by_u, "the parts of cells", &at));
    slab->split_count = g->split_count;
    slab->leaf_count = g->leaf_count;
    slab->arc_count = g->arc_count;
    slab->hanging_count = g->hanging_count;
    slab->split = (bvxi_split *)(void *)at;
    at = keep_part(at, g->split, split);
    slab->leaf = (bvxi_leaf *)(void *)at;
    at = keep_part(at, g->leaf, leaf);
    slab->arc = (bvxi_arc *)(void *)at;
    at = keep_part(at, g->arc, arc);
    slab->hanging = (bvxi_hanging *)(void *)at;
    at = keep_part(at, w->sorted, hanging);
    slab->by_u = (uint32_t *)(void *)at;
    keep_part(at, w->order, by_u);
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
        BVXI_TRY(
            bvxi_split_grid_cell(w, (int32_t)((a < b ? a : b) & 0xffff), (int32_t)((a < b ? a : b) >> 16)));
    }
    BVXI_TRY(order_hanging(w, g));
    return keep_slab(w, slab);
}

static void set_slab(bvxi_slab *slab, bvxi_plane *below, bvxi_plane *above, double low, double high)
{
    slab->plane[0] = below;
    slab->plane[1] = above;
    slab->w[0] = low;
    slab->w[1] = high;
}

/* Each nesting level between two planes is a slab of its own. */
static uint32_t lay_levels(const bvxi_stack *s, bvxi_slab *slabs, uint32_t below, bvxi_plane *level)
{
    uint32_t const levels = s->nesting.count[below];
    for (uint32_t i = 0; i < levels; i++, level += 2) {
        set_slab(&slabs[i], &level[0], &level[1], s->plane[below].w, s->plane[below + 1].w);
        slabs[i].below = below;
        slabs[i].level = i;
    }
    return levels;
}

/* The plane beyond one side of a slab, which a cubic blend looks at; side: 0 below, 1 above. A nesting level
 * goes on in its own kind; the outermost one also in a whole section that has no holes. */
static const bvxi_plane *plane_beyond(const bvxi_stack *s, const bvxi_slab *slabs, uint32_t slab, int side)
{
    const bvxi_slab *const b = &slabs[slab];
    uint32_t const last = s->plane_count - 1,
                   levels = s->nesting.count == NULL ? 1 : s->nesting.count[b->below];
    const bvxi_plane *whole;

    /* The first and last section have nothing beyond; a plane without contours would have no distances. */
    if (side == 0 ? b->below == 0 : b->below + 1 == last) return NULL;
    whole = &s->plane[side == 0 ? b->below - 1 : b->below + 2];
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
            uint32_t const levels = lay_levels(s, slabs + count, i, level);
            level += 2 * (size_t)levels;
            count += levels;
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
    uint64_t const room = (uint64_t)s->plane_count + 2 + s->nesting.plane_room; /* the last stays free */
    bvxi_plane *const nothing = &s->nothing;
    bvxi_split_work w = {.s = s};

    BVXI_TRY(BVXI_ZEROS(s->ctx, room, "the slabs of a body", *slabs));

    /* An empty plane of the right size stands for what is not there: later steps need no case for ends. */
    nothing->section = BVXI_NONE;
    BVXI_TRY(BVXI_ZEROS(s->ctx, bvxi_stack_words(s), "an empty plane", nothing->inside));
    s->slab_count = lay_slabs(s, *slabs, nothing);
    for (uint32_t i = 0; i < s->slab_count && s->options.slabs.blend == BVX_BLEND_CUBIC; i++) {
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
