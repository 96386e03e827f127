/* slab_fill.c - the surface between sections: every cell that it may cross, layer by layer, in the order of the grid. */
#include "section/trace.h"

typedef struct slab_fill_work {
    bvxi_stack *s;
    bvxi_field field;
    bvxi_trace trace;
    bvxi_cell_arcs lists[2];
    bvxi_vertex_map map[2];
    uint64_t *touched;   /* cells in rows of words: those that contours touch */
    uint64_t *split_bit; /* those that were subdivided */
    uint32_t split;      /* the next subdivided cell */
    uint32_t top;        /* the list of the plane above */
    uint32_t map_top;    /* the map of the level above */
} slab_fill_work;

static uint64_t row_word_up(const uint64_t *row, int32_t i, int32_t words)
{
    return row[i] >> 1 | (i + 1 < words ? row[i + 1] << 63 : 0);
}

/* Cells of a row that the surface may cross: corners whose line is crossed, corners unlike each other where the field decides,
 * contours. */
static uint64_t active_cells(const slab_fill_work *w, int32_t j, int32_t i)
{
    int32_t const words = w->s->words;
    size_t const low = (size_t)j * (size_t)words, high = low + (size_t)words;
    const uint64_t *const c = w->field.crossed;
    uint64_t bits = c[low + (size_t)i] | c[high + (size_t)i] | row_word_up(c + low, i, words) | row_word_up(c + high, i, words);
    int32_t const cells = w->s->size[0] - 64 * i;
    if (w->s->options.crossings == BVX_CROSSINGS_EXACT) bits |= w->touched[low + (size_t)i];
    else
        for (int k = 0; k < 2; k++) {
            const uint64_t *const p = w->field.slab->plane[k]->inside;
            uint64_t const a = p[low + (size_t)i], b = p[high + (size_t)i], x = row_word_up(p + low, i, words), y = row_word_up(p + high, i, words);
            bits |= (a | b | x | y) & ~(a & b & x & y);
        }
    return cells >= 64 ? bits : cells <= 0 ? 0 : bits & ((UINT64_C(1) << cells) - 1);
}

/* Gather a grid cell's arcs. */
static bvx_status gather_arcs(slab_fill_work *w, uint32_t number)
{
    bvxi_trace *const t = &w->trace;
    for (int k = 0; k < 2; k++) {
        const bvxi_cell_arcs *const lists = &w->lists[k == 0 ? 1 - w->top : w->top];
        uint32_t n = 0;
        if (t->level[k].kind == BVXI_PLANE_EXACT)
            for (uint32_t a = lists->head[number]; a != BVXI_NONE; a = lists->link[a]) {
                BVXI_TRY(bvxi_slab_grow(w->s, &t->gathered[k], n, &t->gathered_room[k], sizeof *t->gathered[k], "the arcs of a cell"));
                t->gathered[k][n++] = lists->plane->arc[a];
            }
        t->arc[k] = t->gathered[k];
        t->arc_count[k] = n;
    }
    return BVX_OK;
}

static int is_split(const slab_fill_work *w, int32_t i, int32_t j)
{
    if (i < 0 || j < 0 || i >= w->s->size[0] || j >= w->s->size[1]) return 0;
    return (int)(w->split_bit[(size_t)j * (size_t)w->s->words + (size_t)(i >> 6)] >> (i & 63) & 1);
}

static void mark_split(slab_fill_work *w, int set)
{
    const bvxi_slab *const slab = w->field.slab;
    uint32_t const nx = (uint32_t)w->s->size[0];
    for (uint32_t n = 0; n < slab->split_count; n++) {
        uint32_t const x = slab->split[n].cell % nx, y = slab->split[n].cell / nx;
        uint64_t *const word = &w->split_bit[(size_t)y * (size_t)w->s->words + (x >> 6)];
        if (set) *word |= UINT64_C(1) << (x & 63);
        else *word = 0;
    }
}

static bvx_status fill_slab_cell(slab_fill_work *w, int32_t i, int32_t j)
{
    bvxi_trace *const t = &w->trace;
    const bvxi_slab *const slab = w->field.slab;
    int32_t const fine = w->s->fine;
    t->number = (uint32_t)j * (uint32_t)w->s->size[0] + (uint32_t)i;
    if (w->split < slab->split_count && slab->split[w->split].cell == t->number) {
        const bvxi_split *const split = &slab->split[w->split++];
        t->beside_split = 1;
        for (uint32_t n = split->leaf; n < split->leaf + split->leaf_count; n++) {
            const bvxi_leaf *const leaf = &slab->leaf[n];
            t->low[0] = leaf->low[0];
            t->low[1] = leaf->low[1];
            t->size = leaf->size;
            for (int k = 0; k < 2; k++) {
                t->arc[k] = slab->arc + leaf->arc[k];
                t->arc_count[k] = t->level[k].kind == BVXI_PLANE_EXACT ? leaf->arc_count[k] : 0;
            }
            BVXI_TRY(bvxi_trace_slab_cell(t));
        }
        return BVX_OK;
    }
    t->low[0] = (int32_t)((uint32_t)i << fine);
    t->low[1] = (int32_t)((uint32_t)j << fine);
    t->size = 1 << fine;
    t->beside_split = slab->split_count != 0 &&
                      (is_split(w, i - 1, j) || is_split(w, i + 1, j) || is_split(w, i, j - 1) || is_split(w, i, j + 1));
    BVXI_TRY(gather_arcs(w, t->number));
    return bvxi_trace_slab_cell(t);
}

static bvx_status fill_layer(slab_fill_work *w)
{
    bvxi_stack *const s = w->s;
    w->split = 0;
    for (int32_t j = 0; j < s->size[1]; j++)
        for (int32_t k = 0; k < s->words; k++) {
            uint64_t bits = active_cells(w, j, k);
            for (int32_t i = 64 * k; bits != 0; i++, bits >>= 1) {
                while ((bits & 0xff) == 0) {
                    bits >>= 8;
                    i += 8;
                }
                if ((bits & 1) != 0) BVXI_TRY(fill_slab_cell(w, i, j));
            }
        }
    return BVX_OK;
}

/* ---- levels ---- */

static void set_level(slab_fill_work *w, bvxi_level *level, int32_t number)
{
    const bvxi_slab *const slab = w->field.slab;
    int const k = number == 0 ? 0 : number == w->field.layers ? 1 : -1;
    memset(level, 0, sizeof *level);
    level->t = (double)number / w->field.layers;
    level->w = k >= 0 ? slab->w[k] : slab->w[0] + level->t * (slab->w[1] - slab->w[0]);
    level->k = k;
    level->kind = BVXI_PLANE_FIELD;
    if (k < 0) return;
    level->plane = slab->plane[k];
    if (level->plane == &w->s->nothing) level->kind = BVXI_PLANE_EMPTY;
    else if (w->s->options.crossings == BVX_CROSSINGS_EXACT) level->kind = BVXI_PLANE_EXACT;
    else if (w->s->options.crossings == BVX_CROSSINGS_PAPER) level->arcs = &w->lists[k == 0 ? 1 - w->top : w->top];
}

static void touch_cells(slab_fill_work *w, const bvxi_plane *p, int set)
{
    uint32_t const nx = (uint32_t)w->s->size[0];
    for (uint32_t i = 0; i < p->arc_count; i++) {
        uint32_t const x = p->arc_cell[i] % nx, y = p->arc_cell[i] / nx;
        uint64_t *const word = &w->touched[(size_t)y * (size_t)w->s->words + (x >> 6)];
        if (set) *word |= UINT64_C(1) << (x & 63);
        else *word = 0;
    }
}

static bvx_status fill_slab(slab_fill_work *w, bvxi_slab *slab)
{
    bvxi_trace *const t = &w->trace;
    if (w->lists[w->top].plane != slab->plane[0]) {
        bvxi_map_clear(&w->map[w->map_top]);
        bvxi_cell_arcs_set(&w->lists[w->top], slab->plane[0]);
    }
    w->top = 1 - w->top;
    bvxi_cell_arcs_set(&w->lists[w->top], slab->plane[1]);
    for (int k = 0; k < 2; k++) touch_cells(w, slab->plane[k], 1);
    bvxi_map_clear(&t->folds);
    BVXI_TRY(bvxi_field_set(&w->field, slab));
    mark_split(w, 1);
    for (int32_t layer = 0; layer < w->field.layers; layer++) {
        w->map_top = 1 - w->map_top;
        bvxi_map_clear(&w->map[w->map_top]);
        set_level(w, &t->level[0], layer);
        set_level(w, &t->level[1], layer + 1);
        t->level[0].edges = &w->map[1 - w->map_top];
        t->level[1].edges = &w->map[w->map_top];
        t->low_w = t->level[0].w;
        t->high_w = t->level[1].w;
        t->layer = layer;
        BVXI_TRY(fill_layer(w));
    }
    for (int k = 0; k < 2; k++) touch_cells(w, slab->plane[k], 0);
    mark_split(w, 0);
    return BVX_OK;
}

bvx_status bvxi_slabs_fill(bvxi_stack *s, bvxi_slab *slabs, uint32_t count)
{
    uint64_t const bytes = ((uint64_t)s->size[1] + 1) * (uint64_t)s->words * 8;
    slab_fill_work w;
    bvx_status status;
    memset(&w, 0, sizeof w);
    w.s = s;
    w.trace.s = s;
    w.trace.field = &w.field;
    status = bvxi_field_open(s, &w.field);
    if (status == BVX_OK) status = bvxi_cell_arcs_open(s, &w.lists[0]);
    if (status == BVX_OK) status = bvxi_cell_arcs_open(s, &w.lists[1]);
    if (status == BVX_OK) status = bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, bytes, "the cells that contours touch", &w.touched);
    if (status == BVX_OK) status = bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, bytes, "the subdivided cells", &w.split_bit);
    for (uint32_t i = 0; i < count && status == BVX_OK; i++) {
        status = bvxi_progress(s->ctx, "surface", (double)i / count);
        if (status == BVX_OK) status = fill_slab(&w, &slabs[i]);
    }
    bvxi_free(s->ctx, w.split_bit, bytes);
    bvxi_free(s->ctx, w.touched, bytes);
    for (int k = 2; k-- > 0;) bvxi_map_free(s, &w.map[k]);
    bvxi_trace_free(&w.trace);
    bvxi_cell_arcs_close(s, &w.lists[1]);
    bvxi_cell_arcs_close(s, &w.lists[0]);
    bvxi_field_close(&w.field);
    return status;
}
