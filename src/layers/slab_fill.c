/* slab_fill.c - the surface between two sections: every cell that it may cross, in the order of the grid.
 *
 * Arcs of both planes and crossings of lines lie in the order of the cells, so a row of cells takes them one
 * after the other. */
#include "layers/trace.h"

static uint64_t row_word_up(const uint64_t *row, int32_t i, int32_t words)
{
    return row[i] >> 1 | (i + 1 < words ? row[i + 1] << 63 : 0);
}

/* Cells of a row that the surface may cross: crossed lines, contours, unlike corners. */
static void find_active(bvxi_slab_work *w, int32_t j)
{
    bvxi_stack *const s = w->s;
    int32_t const words = s->words, last = s->size[0] >> 6;
    size_t const low = (size_t)j * (size_t)words, high = low + (size_t)words;
    const uint64_t *const c = w->field.crossed;

    /* A word for 64 cells: active when any of four corner lines is, two of them the neighbour's bits. */
    for (int32_t i = 0; i < words; i++)
        w->row[i] = c[low + (size_t)i] | c[high + (size_t)i] | row_word_up(c + low, i, words) |
                    row_word_up(c + high, i, words);
    for (int k = 0; k < 2; k++) {
        const bvxi_plane *const p = w->field.slab->plane[k];
        if (s->options.slabs.crossings == BVX_CROSSINGS_EXACT) {
            for (uint32_t a = w->arc[k]; a < p->arc_count && p->arc_cell[a] >> 16 == (uint32_t)j; a++)
                w->row[(p->arc_cell[a] & 0xffff) >> 6] |= UINT64_C(1) << (p->arc_cell[a] & 63);
            continue;
        }
        for (int32_t i = 0; i < words; i++) {
            uint64_t const a = p->inside[low + (size_t)i], b = p->inside[high + (size_t)i];
            uint64_t const x = row_word_up(p->inside + low, i, words);
            uint64_t const y = row_word_up(p->inside + high, i, words);
            w->row[i] |= (a | b | x | y) & ~(a & b & x & y);
        }
    }

    w->row[last] &= (UINT64_C(1) << (s->size[0] & 63)) - 1;
}

static int is_split(const bvxi_slab_work *w, int32_t i, int32_t j)
{
    if (i < 0 || j < 0 || i >= w->s->size[0] || j >= w->s->size[1]) return 0;
    return (int)(w->split_bit[(size_t)j * (size_t)w->s->words + (size_t)(i >> 6)] >> (i & 63) & 1);
}

static void mark_split(bvxi_slab_work *w, int set)
{
    const bvxi_slab *const slab = w->field.slab;
    /* Cleared by whole words: nothing else is set in them. */
    for (uint32_t n = 0; n < slab->split_count; n++) {
        uint32_t const x = slab->split[n].cell & 0xffff, y = slab->split[n].cell >> 16;
        uint64_t *const word = &w->split_bit[(size_t)y * (size_t)w->s->words + (x >> 6)];
        if (set) *word |= UINT64_C(1) << (x & 63);
        else *word = 0;
    }
}

/* Numbers of the crossings of the lines over a cell's corners, counter-clockwise. A crossing over its left
 * corners was met at the right ones of the cell before, which it makes one to look at too. */
static void next_lines(bvxi_slab_work *w, int32_t i, const uint32_t inside[2], uint32_t line[4])
{
    static const uint8_t left[2] = {0, 3}, right[2] = {1, 2};
    uint32_t const crossed = inside[0] ^ inside[1];
    /* Lines are numbered by rows of corners, so two running counts per row of cells replace a look-up. */
    for (int k = 0; k < 2; k++) {
        line[left[k]] = line[right[k]] = BVXI_NONE;
        if ((crossed >> left[k] & 1) != 0)
            line[left[k]] = w->field.first + (i == 0 ? w->line[k]++ : w->line[k] - 1);
        if ((crossed >> right[k] & 1) != 0) line[right[k]] = w->field.first + w->line[k]++;
    }
}

static uint32_t inside_corners(const bvxi_stack *s, const bvxi_plane *p, int32_t i, int32_t j)
{
    return (uint32_t)(bvxi_grid_bit(s, p, i, j) | bvxi_grid_bit(s, p, i + 1, j) << 1 |
                      bvxi_grid_bit(s, p, i + 1, j + 1) << 2 | bvxi_grid_bit(s, p, i, j + 1) << 3);
}

static bvx_status fill_leaves(bvxi_slab_work *w, const bvxi_split *split)
{
    bvxi_trace *const t = &w->trace;
    const bvxi_slab *const slab = w->field.slab;

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

static int is_beside_split(const bvxi_slab_work *w, int32_t i, int32_t j)
{
    return w->field.slab->split_count != 0 &&
           (is_split(w, i, j) || is_split(w, i - 1, j) || is_split(w, i + 1, j) || is_split(w, i, j - 1) ||
            is_split(w, i, j + 1));
}

static bvx_status fill_grid_cell(bvxi_slab_work *w, int32_t i, int32_t j)
{
    bvxi_trace *const t = &w->trace;
    uint32_t arcs[2] = {0, 0};
    int done = 0;

    t->key = bvxi_cell_key(i, j);
    t->low[0] = (int32_t)((uint32_t)i << w->s->fine);
    t->low[1] = (int32_t)((uint32_t)j << w->s->fine);
    t->size = 1 << w->s->fine;
    for (int k = 0; k < 2 && w->s->options.slabs.crossings == BVX_CROSSINGS_EXACT; k++) {
        const bvxi_plane *const p = w->field.slab->plane[k];
        while (w->arc[k] + arcs[k] < p->arc_count && p->arc_cell[w->arc[k] + arcs[k]] == t->key) arcs[k]++;
    }

    /* The usual cell has one arc or one crossed line and a table of its own; the rest is traced in full. */
    if (w->plain) {
        uint32_t line[4];
        uint32_t const inside[2] = {inside_corners(w->s, w->field.slab->plane[0], i, j),
                                    inside_corners(w->s, w->field.slab->plane[1], i, j)};
        next_lines(w, i, inside, line);

        /* Beside a subdivided cell there may be points on the common side, which only the trace looks for. */
        if (!is_beside_split(w, i, j)) BVXI_TRY(bvxi_slab_plain_cell(w, arcs, inside, line, &done));
    }
    const bvxi_slab *const slab = w->field.slab;
    if (!done && w->split < slab->split_count && slab->split[w->split].cell == t->key) {
        BVXI_TRY(fill_leaves(w, &slab->split[w->split++]));
    } else if (!done) {
        t->beside_split = is_beside_split(w, i, j);
        for (int k = 0; k < 2; k++) {
            t->arc[k] = arcs[k] == 0 ? NULL : slab->plane[k]->arc + w->arc[k];
            t->arc_count[k] = t->level[k].kind == BVXI_PLANE_EXACT ? arcs[k] : 0;
        }
        BVXI_TRY(bvxi_trace_slab_cell(t));
    }
    for (int k = 0; k < 2; k++) w->arc[k] += arcs[k];
    return BVX_OK;
}

static bvx_status fill_cells(bvxi_slab_work *w)
{
    bvxi_stack *const s = w->s;
    bvxi_level *const level = w->trace.level;

    /* The top of a slab is the bottom of the next one: its vertices are kept, and the older map is used again. */
    w->map_top = 1 - w->map_top;
    bvxi_map_clear(&w->map[w->map_top]);
    for (int k = 0; k < 2; k++) {
        bvxi_plane *const p = w->field.slab->plane[k];
        level[k] = (bvxi_level){.kind = BVXI_PLANE_FIELD, .plane = p, .w = w->field.slab->w[k]};
        level[k].edges = &w->map[k == 1 ? w->map_top : 1 - w->map_top];
        if (bvxi_plane_is_nothing(p)) level[k].kind = BVXI_PLANE_EMPTY;
        else if (s->options.slabs.crossings == BVX_CROSSINGS_EXACT) level[k].kind = BVXI_PLANE_EXACT;
        else if (s->options.slabs.crossings == BVX_CROSSINGS_PAPER) level[k].inserts = 1;
    }
    w->trace.low_w = level[0].w;
    w->trace.high_w = level[1].w;
    w->split = w->arc[0] = w->arc[1] = 0;
    for (int32_t j = 0; j < s->size[1]; j++) {
        find_active(w, j);
        for (int k = 0; k < 2; k++) w->line[k] = w->field.before[(size_t)(j + k) * (size_t)s->words];
        for (int32_t k = 0; k < s->words; k++)
            for (uint64_t bits = w->row[k]; bits != 0; bits &= bits - 1)
                BVXI_TRY(fill_grid_cell(w, 64 * k + bvxi_lowest(bits), j));
    }
    return BVX_OK;
}

/* The field's crossings on a plane are kept for the slab above it: in the field's way slabs come in order. */
bvx_status bvxi_slab_fill(bvxi_slab_work *w, bvxi_slab *slab)
{
    if (w->field.plane[1].plane != slab->plane[0]) bvxi_map_clear(&w->map[w->map_top]);
    bvxi_map_clear(&w->trace.folds);
    BVXI_TRY(bvxi_field_set(&w->field, slab));
    w->plain = !w->only_traced && w->s->options.slabs.crossings == BVX_CROSSINGS_EXACT;
    /* Bits set for this slab and cleared after it cost less than clearing the plane. */
    mark_split(w, 1);
    bvx_status const status = fill_cells(w);
    mark_split(w, 0);
    return status;
}

bvx_status bvxi_slab_work_open(bvxi_slab_work *w, bvxi_stack *s, uint32_t lines, uint32_t loop)
{
    memset(w, 0, sizeof *w);
    w->s = s;
    w->trace.s = s;
    w->trace.field = &w->field;
    BVXI_TRY(bvxi_field_open(s, &w->field, lines));
    BVXI_TRY(BVXI_ARRAY(s->ctx, s->words, "the cells of a row", w->row));
    BVXI_TRY(BVXI_ZEROS(s->ctx, bvxi_stack_words(s), "the subdivided cells", w->split_bit));
    return bvxi_trace_open(&w->trace, loop);
}
