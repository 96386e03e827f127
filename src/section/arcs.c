/* arcs.c - the loops of a section cut at the grid's lines: crossings, the arcs between them by cell, the grid points inside.
 *
 * A loop is walked once; along a segment the next line to cross is found by the exact order of two crossings. Each crossing of a
 * line of one v turns the grid points beyond it on that line; the bits inside are the running parity of a row.
 *
 * The ring of a plane is what both sides of it share: the points and crossings of each loop one behind the other, crossings of
 * subdivided cells from above and below included, so an arc's vertices are a stretch of it whatever cells it was cut for. */
#include "section/section.h"

/* ---- crossings ---- */

bvx_status bvxi_plane_add_cut(bvxi_stack *s, bvxi_plane *p, uint32_t segment, int32_t axis, int32_t line, uint32_t *number)
{
    bvxi_line_cut *c;
    if (p->cut_count == p->cut_room) {
        uint64_t const room = p->cut_room < 256 ? 256 : (uint64_t)p->cut_room + p->cut_room / 2;
        if (room > INT32_MAX) return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: section %u crosses the grid more than 2^31 times", s->function,
                                               (uint64_t)p->section);
        BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, &p->cut, p->cut_room * sizeof *p->cut, room * sizeof *p->cut, "the crossings of a section"));
        p->cut_room = (uint32_t)room;
    }
    *number = p->cut_count++;
    c = &p->cut[*number];
    c->segment = segment;
    c->axis = axis;
    c->line = line;
    c->ring = BVXI_NONE;
    return BVX_OK;
}

/* ---- arcs ---- */

typedef struct arc_walk {
    bvxi_stack *s;
    bvxi_plane *p;
    uint32_t room;
    int32_t cell[2];
    uint32_t last;          /* the cut before, or none yet in this loop */
    uint32_t point, count;  /* points since */
    bvxi_arc head;          /* what lies before the loop's first cut */
} arc_walk;

static bvx_status add_arc(arc_walk *w, uint32_t from, uint32_t to, uint32_t point, uint32_t count)
{
    bvxi_plane *const p = w->p;
    bvxi_arc *a;
    if (p->arc_count == w->room) {
        uint64_t const room = w->room < 256 ? 256 : (uint64_t)w->room + w->room / 2;
        BVXI_TRY(bvxi_resize(w->s->ctx, BVXI_SCRATCH, &p->arc, w->room * sizeof *p->arc, room * sizeof *p->arc, "the arcs of a section"));
        w->room = (uint32_t)room;
    }
    a = &p->arc[p->arc_count++];
    a->from = from;
    a->to = to;
    a->point = point;
    a->count = count;
    return BVX_OK;
}

static void turn_beyond(arc_walk *w, int32_t row)
{
    int32_t const bit = w->cell[0] + 1;
    w->p->inside[(size_t)row * (size_t)w->s->words + (size_t)(bit >> 6)] ^= UINT64_C(1) << (bit & 63);
}

/* Over one line; cell is still the one before it. */
static bvx_status cross_grid_line(arc_walk *w, uint32_t segment, int axis, int up)
{
    int32_t const index = w->cell[axis] + up;
    uint32_t cut = 0;
    BVXI_TRY(bvxi_plane_add_cut(w->s, w->p, segment, axis, (int32_t)((uint32_t)index << w->s->fine), &cut));
    if (axis == 1) turn_beyond(w, index);
    if (w->last == BVXI_NONE) {
        w->head.to = cut;
        w->head.point = w->point;
        w->head.count = w->count;
    } else {
        BVXI_TRY(add_arc(w, w->last, cut, w->point, w->count));
    }
    w->last = cut;
    w->count = 0;
    w->cell[axis] += up ? 1 : -1;
    return BVX_OK;
}

static bvx_status walk_segment(arc_walk *w, uint32_t i)
{
    const int32_t *const a = w->p->q[i], *const b = w->p->q[w->p->next[i]];
    int const up[2] = {b[0] > a[0], b[1] > a[1]};
    int32_t left[2]; /* lines still to cross */
    for (int k = 0; k < 2; k++) {
        int32_t const d = (b[k] >> w->s->fine) - w->cell[k];
        left[k] = d < 0 ? -d : d;
    }
    while (left[0] != 0 || left[1] != 0) {
        int axis = left[0] == 0;
        if (left[0] != 0 && left[1] != 0)
            axis = !bvxi_x_first(a, b, (w->cell[0] + up[0]) << w->s->fine, (w->cell[1] + up[1]) << w->s->fine);
        BVXI_TRY(cross_grid_line(w, i, axis, up[axis]));
        left[axis]--;
    }
    return BVX_OK;
}

static bvx_status walk_loop(arc_walk *w, const bvxi_contour *c)
{
    const bvxi_plane *const p = w->p;
    w->last = BVXI_NONE;
    w->count = 0;
    w->cell[0] = p->q[c->first][0] >> w->s->fine;
    w->cell[1] = p->q[c->first][1] >> w->s->fine;
    for (uint32_t i = c->first; i < c->first + c->count; i++) {
        if (w->count++ == 0) w->point = i;
        BVXI_TRY(walk_segment(w, i));
    }
    if (w->last == BVXI_NONE) return add_arc(w, BVXI_NONE, BVXI_NONE, c->first, c->count);
    return add_arc(w, w->last, w->head.to, w->count != 0 ? w->point : w->head.point, w->count + w->head.count);
}

/* The cell of each arc, from a point or by what its cuts cross. */
static void place_arcs(const bvxi_stack *s, bvxi_plane *p)
{
    for (uint32_t i = 0; i < p->arc_count; i++) {
        const bvxi_arc *const a = &p->arc[i];
        int32_t cell[2];
        if (a->count != 0) {
            cell[0] = p->q[a->point][0] >> s->fine;
            cell[1] = p->q[a->point][1] >> s->fine;
        } else { /* straight from line to line */
            const bvxi_line_cut *const c = &p->cut[a->from];
            const int32_t *const q = p->q[c->segment], *const n = p->q[p->next[c->segment]];
            int const k = c->axis, o = 1 - k;
            int32_t low = 0, high = s->size[o] - 1;
            cell[k] = (c->line >> s->fine) - (n[k] < q[k]);
            while (low < high) { /* the last line that the crossing lies beyond */
                int32_t const middle = (low + high + 1) / 2;
                if (bvxi_cut_beyond(p, c, (int32_t)((uint32_t)middle << s->fine))) low = middle;
                else high = middle - 1;
            }
            cell[o] = low;
        }
        p->arc_cell[i] = (uint32_t)cell[1] * (uint32_t)s->size[0] + (uint32_t)cell[0];
    }
}

static void fill_rows(const bvxi_stack *s, uint64_t *inside)
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

bvx_status bvxi_plane_cut(bvxi_stack *s, bvxi_plane *p)
{
    arc_walk w;
    memset(&w, 0, sizeof w);
    w.s = s;
    w.p = p;
    bvx_status status = BVX_OK;
    for (uint32_t i = 0; i < p->contour_count && status == BVX_OK; i++) status = walk_loop(&w, &p->contour[i]);
    /* the array ends as long as its count says, whatever happened */
    if (w.room != p->arc_count) {
        uint32_t const count = p->arc_count;
        bvxi_arc *const kept = p->arc;
        bvx_status const shrunk = bvxi_resize(s->ctx, BVXI_SCRATCH, &p->arc, w.room * sizeof *p->arc, count * sizeof *p->arc, "the arcs of a section");
        if (shrunk != BVX_OK) {
            bvxi_free(s->ctx, kept, w.room * sizeof *p->arc);
            p->arc = NULL;
            p->arc_count = 0;
            return shrunk;
        }
    }
    BVXI_TRY(status);
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)p->arc_count * 4, "the cells of arcs", &p->arc_cell));
    place_arcs(s, p);
    fill_rows(s, p->inside);
    p->grid_cut_count = p->cut_count;
    s->report.crossings += p->cut_count;
    return BVX_OK;
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

/* ---- the ring ---- */

/* Order of two crossings on one segment: -1, 0 (they are one), 1. */
static int order_on_segment(const bvxi_plane *p, const bvxi_line_cut *c, const bvxi_line_cut *d)
{
    const int32_t *const a = p->q[c->segment], *const b = p->q[p->next[c->segment]];
    if (c->axis == d->axis) {
        if (c->line == d->line) return 0;
        return (c->line < d->line) == (b[c->axis] > a[c->axis]) ? -1 : 1;
    }
    if (c->axis == 0) return bvxi_x_first(a, b, c->line, d->line) ? -1 : 1;
    return bvxi_x_first(a, b, d->line, c->line) ? 1 : -1;
}

/* cuts by segment in start[], then in order along each; few lie on one. */
static void sort_cuts(const bvxi_plane *p, uint32_t *start, uint32_t *sorted)
{
    uint32_t sum = 0;
    for (uint32_t i = 0; i < p->cut_count; i++) start[p->cut[i].segment]++;
    for (uint32_t i = 0; i < p->point_count; i++) {
        uint32_t const n = start[i];
        start[i] = sum;
        sum += n;
    }
    for (uint32_t i = 0; i < p->cut_count; i++) sorted[start[p->cut[i].segment]++] = i;
    for (uint32_t i = p->point_count; i-- > 0;) start[i] = i == 0 ? 0 : start[i - 1];
    for (uint32_t k = 0; k < p->point_count; k++) {
        uint32_t const end = k + 1 < p->point_count ? start[k + 1] : p->cut_count;
        for (uint32_t i = start[k] + 1; i < end; i++) {
            uint32_t const x = sorted[i];
            uint32_t j = i;
            for (; j > start[k] && order_on_segment(p, &p->cut[x], &p->cut[sorted[j - 1]]) < 0; j--) sorted[j] = sorted[j - 1];
            sorted[j] = x;
        }
    }
}

static void number_ring(bvxi_plane *p, const uint32_t *start, const uint32_t *sorted)
{
    uint32_t n = 0;
    for (uint32_t k = 0; k < p->point_count; k++) {
        uint32_t const end = k + 1 < p->point_count ? start[k + 1] : p->cut_count;
        p->ring[k] = n++;
        for (uint32_t i = start[k]; i < end; i++) {
            bvxi_line_cut *const c = &p->cut[sorted[i]];
            if (i > start[k] && order_on_segment(p, c, &p->cut[sorted[i - 1]]) == 0) n--;
            c->ring = n++;
        }
    }
    p->ring_count = n;
}

bvx_status bvxi_plane_ring(bvxi_stack *s, bvxi_plane *p)
{
    uint64_t const starts = (uint64_t)p->point_count * 4, cuts = (uint64_t)p->cut_count * 4;
    uint32_t *start = NULL, *sorted = NULL;
    bvx_status status = bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, starts, "the crossings of segments", &start);
    if (status == BVX_OK) status = bvxi_alloc(s->ctx, BVXI_SCRATCH, cuts, "the crossings in order", &sorted);
    if (status == BVX_OK) {
        sort_cuts(p, start, sorted);
        number_ring(p, start, sorted);
    }
    bvxi_free(s->ctx, sorted, cuts);
    bvxi_free(s->ctx, start, starts);
    return status;
}

/* Where a crossing lies, on the segment as given. One through a meeting of two lines, which are two crossings at one place, is
 * moved a little along the segment, as the lines are thought to be. */
static void cut_place(const bvxi_stack *s, const bvxi_plane *p, const bvxi_line_cut *c, double at[3])
{
    const int32_t *const a = p->q[c->segment], *const b = p->q[p->next[c->segment]];
    const double *const from = s->given->points + 3 * (uint64_t)p->given[c->segment];
    const double *const to = s->given->points + 3 * (uint64_t)p->given[p->next[c->segment]];
    double const length = (double)((int64_t)b[c->axis] - a[c->axis]);
    double t = (double)((int64_t)c->line - a[c->axis]) / length;
    int const o = 1 - c->axis;
    if (c->axis == 0) { /* the line u + e_u */
        int64_t const d = (int64_t)b[o] - a[o], num = ((int64_t)c->line - a[0]) * d, den = (int64_t)b[0] - a[0];
        if (num % den == 0 && ((a[o] + num / den) & ((1 << (s->fine - BVXI_SECTION_DEEPEST)) - 1)) == 0) t += 0.25 / length;
    }
    for (int k = 0; k < 3; k++) at[k] = from[k] + t * (to[k] - from[k]);
}

bvx_status bvxi_plane_emit(bvxi_stack *s, bvxi_plane *p)
{
    bvxi_section_mesh *const m = &s->mesh;
    uint64_t const need = m->vertex_count + p->ring_count;
    if (need > UINT32_MAX - 1) return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: the surface has more than 2^32 vertices", s->function);
    if (need > m->vertex_room) {
        uint64_t const room = need + need / 2;
        BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, &m->position, m->vertex_room * 24, room * 24, "the vertices of a body"));
        m->vertex_room = room;
    }
    p->vertex = (uint32_t)m->vertex_count;
    for (uint32_t i = 0; i < p->point_count; i++)
        memcpy(m->position + 3 * ((uint64_t)p->vertex + p->ring[i]), s->given->points + 3 * (uint64_t)p->given[i], 24);
    for (uint32_t i = 0; i < p->cut_count; i++)
        cut_place(s, p, &p->cut[i], m->position + 3 * ((uint64_t)p->vertex + p->cut[i].ring));
    m->vertex_count = need;
    return BVX_OK;
}
