/* loop_arcs.c - the loops of a section cut at the grid's lines: crossings, the arcs between them by cell, the
 * grid points inside.
 *
 * A loop is walked once; along a segment the next line to cross is found by the exact order of two
 * crossings. Each crossing of a line of one v turns the grid points beyond it on that line; the bits inside
 * are the running parity of a row. Arcs are put into the order of the cells, by counting columns, then rows:
 * cells that are gone through in that order find theirs one after the other. */
#include "contours/section.h"

/* Crossings of a nesting level are its section's: one ring holds them all. */
bvx_status bvxi_plane_add_cut(bvxi_stack *s, bvxi_plane *p, uint32_t segment, int32_t axis, int32_t line,
                              uint32_t *number)
{
    bvxi_plane *const of = p->whole == NULL ? p : p->whole;

    /* Half as much again, in an array of the plane's own: the shared one is cut to what was counted. */
    if (of->cut_count == of->cut_room) {
        uint64_t const room = of->cut_room < 256 ? 256 : (uint64_t)of->cut_room + of->cut_room / 2;
        bvxi_line_cut *larger;
        if (room > INT32_MAX)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: section %i crosses the grid more than 2^31 times", s->function,
                                 (uint64_t)p->section);
        BVXI_TRY(BVXI_ARRAY(s->ctx, room, "the crossings of a section", larger));
        if (of->cut_count != 0) memcpy(larger, of->cut, of->cut_count * sizeof *larger);
        if (of->cut != of->shared_cut) bvxi_drop(s->ctx, of->cut);
        of->cut = larger;
        of->cut_room = (uint32_t)room;
    }
    *number = of->cut_count++;
    of->cut[*number] = (bvxi_line_cut){segment, line, axis, BVXI_NONE};
    p->cut = of->cut;
    p->cut_count = of->cut_count;
    return BVX_OK;
}

static int32_t cells_between(const bvxi_stack *s, int32_t a, int32_t b)
{
    int32_t const d = (b >> s->fine) - (a >> s->fine);
    return d < 0 ? -d : d;
}

void bvxi_plane_count_cuts(const bvxi_stack *s, const bvxi_plane *p, uint64_t *cuts, uint64_t *arcs)
{
    *cuts = *arcs = 0;
    for (uint32_t k = 0; k < p->contour_count; k++) {
        const bvxi_contour *const c = &p->contour[k];
        uint64_t n = 0;
        for (uint32_t i = c->first; i < c->first + c->count; i++) {
            /* A segment crosses as many lines as lie between the cells of its ends. */
            const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
            n += (uint64_t)cells_between(s, a[0], b[0]) + (uint64_t)cells_between(s, a[1], b[1]);
        }
        *cuts += n;
        *arcs += n == 0 ? 1 : n;
    }
}

typedef struct arc_walk {
    bvxi_stack *s;
    bvxi_plane *p;
    const bvxi_arc_scratch *out;
    int32_t cell[2];
    uint32_t last;         /* the cut before, or none yet in this loop */
    uint32_t point, count; /* points since */
    bvxi_arc head;         /* what lies before the loop's first cut */
} arc_walk;

static void add_arc(arc_walk *w, uint32_t from, uint32_t to, uint32_t point, uint32_t count)
{
    uint32_t const n = w->p->arc_count++;
    bvxi_arc *const a = &w->out->arc[n];
    a->from = from;
    a->to = to;
    a->point = point;
    a->count = count;
    w->out->cell[n] = bvxi_cell_key(w->cell[0], w->cell[1]);
}

/* Over one line; cell is still the one before it. */
static void cross_grid_line(arc_walk *w, uint32_t segment, int axis, int up)
{
    int32_t const index = w->cell[axis] + up;
    uint32_t const cut = w->p->cut_count++;
    bvxi_line_cut *const c = &w->p->cut[cut];

    c->segment = segment;
    c->axis = axis;
    c->line = (int32_t)((uint32_t)index << w->s->fine);
    c->ring = BVXI_NONE;
    /* A crossing of a row's line turns all grid points beyond it in that row. */
    if (axis == 1) {
        int32_t const bit = w->cell[0] + 1;
        w->p->inside[(size_t)index * (size_t)w->s->words + (size_t)(bit >> 6)] ^= UINT64_C(1) << (bit & 63);
    }
    /* The first arc of a loop is closed at the end, when its beginning is known. */
    if (w->last == BVXI_NONE) {
        w->head.to = cut;
        w->head.point = w->point;
        w->head.count = w->count;
    } else {
        add_arc(w, w->last, cut, w->point, w->count);
    }
    w->last = cut;
    w->count = 0;
    w->cell[axis] += up ? 1 : -1;
}

static void walk_loop(arc_walk *w, const bvxi_contour *c)
{
    const bvxi_plane *const p = w->p;
    w->last = BVXI_NONE;
    w->count = 0;
    w->cell[0] = p->q[c->first][0] >> w->s->fine;
    w->cell[1] = p->q[c->first][1] >> w->s->fine;
    for (uint32_t i = c->first; i < c->first + c->count; i++) {
        if (w->count++ == 0) w->point = i;

        const int32_t *const a = w->p->q[i], *const b = w->p->q[w->p->next[i]];
        int const up[2] = {b[0] > a[0], b[1] > a[1]};
        int32_t left[2]; /* lines still to cross */

        /* How many lines of each axis lie between both ends; only which comes next is left to find. */
        for (int k = 0; k < 2; k++) {
            int32_t const d = (b[k] >> w->s->fine) - w->cell[k];
            left[k] = d < 0 ? -d : d;
        }
        while (left[0] != 0 || left[1] != 0) {
            int axis = left[0] == 0;
            if (left[0] != 0 && left[1] != 0)
                axis = !bvxi_x_first(a, b, (w->cell[0] + up[0]) << w->s->fine,
                                     (w->cell[1] + up[1]) << w->s->fine);
            cross_grid_line(w, i, axis, up[axis]);
            left[axis]--;
        }
    }
    /* A loop within one cell is an arc without ends; else the last arc joins the first one. */
    if (w->last == BVXI_NONE) add_arc(w, BVXI_NONE, BVXI_NONE, c->first, c->count);
    else add_arc(w, w->last, w->head.to, w->count != 0 ? w->point : w->head.point, w->count + w->head.count);
}

/* A stable sort of numbers by sixteen bits of their cell; from NULL stands for 0, 1, 2... */
static void count_by(const bvxi_plane *p, const bvxi_arc_scratch *x, int shift, int32_t size,
                     const uint32_t *from, uint32_t *to)
{
    memset(x->start, 0, (size_t)size * 4);
    for (uint32_t i = 0; i < p->arc_count; i++) x->start[x->cell[i] >> shift & 0xffff]++;
    bvxi_place_counts32(x->start, (uint64_t)size);
    for (uint32_t i = 0; i < p->arc_count; i++) {
        uint32_t const a = from == NULL ? i : from[i];
        to[x->start[x->cell[a] >> shift & 0xffff]++] = a;
    }
}

static int side_of_cell(const bvxi_stack *s, const bvxi_line_cut *c, uint32_t key)
{
    int32_t const low = (int32_t)((c->axis == 0 ? key & 0xffff : key >> 16) << s->fine);
    if (c->axis == 0) return c->line == low ? 3 : 1;
    return c->line == low ? 0 : 2;
}

void bvxi_plane_look_at_cells(const bvxi_stack *s, bvxi_plane *p)
{
    uint32_t sides = 0;
    int asks = 0;

    for (uint32_t i = 0; i < p->arc_count; i++) {
        const bvxi_arc *const a = &p->arc[i];
        bvxi_ring_arc *const r = &p->ring_arc[i];
        r->from = a->from;
        r->to = a->to;
        if (i == 0 || p->arc_cell[i] != p->arc_cell[i - 1]) sides = 0, asks = 0;
        /* A loop inside the cell, or a side crossed twice, requires that it is cut further. */
        if (a->from == BVXI_NONE) {
            asks = 1;
        } else {
            r->from_side = (uint8_t)side_of_cell(s, &p->cut[a->from], p->arc_cell[i]);
            r->to_side = (uint8_t)side_of_cell(s, &p->cut[a->to], p->arc_cell[i]);
            asks |= (sides >> r->from_side & 1) != 0;
            sides |= UINT32_C(1) << r->from_side;
            asks |= (sides >> r->to_side & 1) != 0;
            sides |= UINT32_C(1) << r->to_side;
        }
        if (asks && (p->asking_count == 0 || p->asking[p->asking_count - 1] != p->arc_cell[i]))
            p->asking[p->asking_count++] = p->arc_cell[i];
    }
}

uint32_t bvxi_plane_arcs_in(const bvxi_plane *p, uint32_t key, uint32_t *count)
{
    uint32_t low = 0, high = p->arc_count;
    while (low < high) {
        uint32_t const middle = low + (high - low) / 2;
        if (p->arc_cell[middle] < key) low = middle + 1;
        else high = middle;
    }
    for (*count = 0; low + *count < p->arc_count && p->arc_cell[low + *count] == key;) ++*count;
    return low;
}

void bvxi_plane_fill_rows(const bvxi_stack *s, uint64_t *inside)
{
    for (int32_t j = 0; j <= s->size[1]; j++) {
        uint64_t *const row = inside + (size_t)j * (size_t)s->words;
        uint64_t carry = 0;
        for (int32_t i = 0; i < s->words; i++) {
            uint64_t x = row[i];
            for (int k = 1; k < 64; k *= 2) x ^= x << k;
            row[i] = x ^ carry;
            carry = 0 - (row[i] >> 63);
        }
    }
}

void bvxi_plane_cut(bvxi_stack *s, bvxi_plane *p, const bvxi_arc_scratch *scratch)
{
    arc_walk w = {.s = s, .p = p, .out = scratch};
    for (uint32_t i = 0; i < p->contour_count; i++) walk_loop(&w, &p->contour[i]);
    p->grid_cut_count = p->cut_count;
    count_by(p, scratch, 0, s->size[0], NULL, scratch->order[0]);
    count_by(p, scratch, 16, s->size[1], scratch->order[0], scratch->order[1]);
    for (uint32_t i = 0; i < p->arc_count; i++) {
        p->arc[i] = scratch->arc[scratch->order[1][i]];
        p->arc_cell[i] = scratch->cell[scratch->order[1][i]];
    }
    bvxi_plane_look_at_cells(s, p);
    bvxi_plane_fill_rows(s, p->inside);
}

double bvxi_plane_area(const bvxi_stack *s, const bvxi_plane *p)
{
    double sum = 0.0;
    for (uint32_t i = 0; i < p->point_count; i++) {
        const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
        sum += (a[0] - s->low[0]) * (b[1] - s->low[1]) - (b[0] - s->low[0]) * (a[1] - s->low[1]);
    }
    return sum * 0.5;
}
