/* plain_cell.c - the surface in a plain cell: each of its edges is crossed at most once, no corner of a finer
 * cell lies on its sides.
 *
 * These are nearly all cells, and what trace.c finds for them fits twelve places: the sides below, the sides
 * above, the heights over the corners. A side with two crossings joins them by a table of which of its four
 * corners are inside; one with four is left to trace.c, as all that is not plain is, and cells whose
 * triangles cross. Contours join crossings below and above. */
#include "layers/trace.h"

enum { PLAIN_ABOVE = 4, PLAIN_OVER = 8, PLAIN_PLACES = 12, PLAIN_NONE = 0xff, PLAIN_OPEN = 0xfe };

/* From crossing (low four bits) to crossing: 0 below, 1 right, 2 above, 3 left. Index: corners inside. */
static const uint8_t plain_strip[16] = {PLAIN_NONE, 0x03, 0x10, 0x13, 0x32, 0x02, PLAIN_OPEN, 0x12, 0x21,
                                        PLAIN_OPEN, 0x20, 0x23, 0x31, 0x01, 0x30, PLAIN_NONE};

static const uint8_t plain_faces[PLAIN_PLACES] = {
    BVXI_FACE_BELOW | BVXI_FACE_SIDE,          BVXI_FACE_BELOW | BVXI_FACE_SIDE << 1,
    BVXI_FACE_BELOW | BVXI_FACE_SIDE << 2,     BVXI_FACE_BELOW | BVXI_FACE_SIDE << 3,
    BVXI_FACE_ABOVE | BVXI_FACE_SIDE,          BVXI_FACE_ABOVE | BVXI_FACE_SIDE << 1,
    BVXI_FACE_ABOVE | BVXI_FACE_SIDE << 2,     BVXI_FACE_ABOVE | BVXI_FACE_SIDE << 3,
    BVXI_FACE_SIDE | BVXI_FACE_SIDE << 3,      BVXI_FACE_SIDE | BVXI_FACE_SIDE << 1,
    BVXI_FACE_SIDE << 1 | BVXI_FACE_SIDE << 2, BVXI_FACE_SIDE << 2 | BVXI_FACE_SIDE << 3};

typedef struct plain_cell {
    uint32_t vertex[PLAIN_PLACES];
    uint8_t next[PLAIN_PLACES];
    uint8_t order[PLAIN_PLACES];
    uint32_t count;
    uint32_t present, from, to; /* bits of places: crossed, left, reached */
    uint32_t along;             /* left along a contour */
    /* the ring between: places first to end - 1, below forwards, above backwards */
    uint32_t first[PLAIN_ABOVE * 2];
    uint32_t end[PLAIN_ABOVE * 2];
} plain_cell;

static void plain_link(plain_cell *c, uint32_t from, uint32_t to)
{
    c->next[from] = (uint8_t)to;
    c->from |= UINT32_C(1) << from;
    c->to |= UINT32_C(1) << to;
}

static void plain_add(plain_cell *c, uint32_t place, uint32_t vertex)
{
    c->vertex[place] = vertex;
    c->order[c->count++] = (uint8_t)place;
    c->present |= UINT32_C(1) << place;
}

/* 0 where a contour crosses an edge again, or lies in the cell whole, or goes over its ring's end. */
static int plain_arcs(const bvxi_slab_work *w, const uint32_t arcs[2], plain_cell *c, uint32_t *inner)
{
    for (uint32_t k = 0; k < 2; k++) {
        const bvxi_plane *const p = w->field.slab->plane[k];
        for (uint32_t i = 0; i < arcs[k]; i++) {
            const bvxi_ring_arc *const a = &p->ring_arc[w->arc[k] + i];
            uint32_t const from = PLAIN_ABOVE * k + a->from_side, to = PLAIN_ABOVE * k + a->to_side;
            if (a->from == BVXI_NONE || a->to <= a->from) return 0;
            if (from == to || (c->present & (UINT32_C(1) << from | UINT32_C(1) << to)) != 0) return 0;
            plain_add(c, from, p->vertex + a->from);
            plain_add(c, to, p->vertex + a->to);
            if (k == 0) plain_link(c, from, to);
            else plain_link(c, to, from);
            if (a->to - a->from == 1) continue;
            *inner += a->to - a->from - 1;
            c->along |= UINT32_C(1) << (k == 0 ? from : to);
            c->first[k == 0 ? from : to] = p->vertex + a->from + 1;
            c->end[k == 0 ? from : to] = p->vertex + a->to;
        }
    }
    return 1;
}

/* 0 where the field has to decide. */
static int plain_sides(plain_cell *c, const uint32_t inside[2])
{
    /* bits of corners run counter-clockwise; the fifth is the first again */
    uint32_t const below = inside[0] | inside[0] << 4, above = inside[1] | inside[1] << 4;

    for (uint32_t side = 0; side < 4; side++) {
        uint8_t const link = plain_strip[(below >> side & 3) | (above >> side & 3) << 2];
        uint8_t place[4];
        if (link == PLAIN_NONE) continue;
        if (link == PLAIN_OPEN) return 0;
        place[0] = (uint8_t)side;
        place[1] = (uint8_t)(PLAIN_OVER + ((side + 1) & 3));
        place[2] = (uint8_t)(PLAIN_ABOVE + side);
        place[3] = (uint8_t)(PLAIN_OVER + side);
        plain_link(c, place[link & 3], place[link >> 4]);
    }
    return 1;
}

static bvx_status plain_loop(bvxi_slab_work *w, const plain_cell *c, uint32_t start, uint32_t *seen)
{
    bvxi_trace *const t = &w->trace;
    uint32_t count = 0, i = start;

    do {
        *seen |= UINT32_C(1) << i;
        t->vertex[count] = c->vertex[i];
        t->faces[count++] = plain_faces[i];
        if ((c->along >> i & 1) != 0) {
            uint32_t const n = c->end[i] - c->first[i];
            for (uint32_t j = 0; j < n; j++) {
                t->vertex[count] = i < PLAIN_ABOVE ? c->first[i] + j : c->end[i] - 1 - j;
                t->faces[count++] = i < PLAIN_ABOVE ? BVXI_FACE_BELOW : BVXI_FACE_ABOVE;
            }
        }
        i = c->next[i];
    } while (i != start);
    return bvxi_trace_fill(t, count);
}

bvx_status bvxi_slab_plain_cell(bvxi_slab_work *w, const uint32_t arcs[2], const uint32_t inside[2],
                                const uint32_t line[4], int *done)
{
    uint32_t seen = 0, inner = 0;
    bvxi_trace_made made;
    plain_cell c;

    c.count = c.present = c.from = c.to = c.along = 0;
    *done = 0;
    if (!plain_arcs(w, arcs, &c, &inner)) return BVX_OK;
    for (uint32_t i = 0; i < 4; i++)
        if (line[i] != BVXI_NONE) plain_add(&c, PLAIN_OVER + i, line[i]);
    if (!plain_sides(&c, inside) || c.from != c.present || c.to != c.present) return BVX_OK;
    if (PLAIN_PLACES + inner > w->trace.loop_room) return BVX_OK;
    bvxi_trace_begin_fill(&w->trace, 0, &made);
    for (uint32_t i = 0; i < c.count; i++)
        if ((seen >> c.order[i] & 1) == 0) BVXI_TRY(plain_loop(w, &c, c.order[i], &seen));
    *done = !bvxi_trace_crosses(&w->trace, &made);
    if (!*done) bvxi_trace_undo_fill(&w->trace, &made); /* trace.c fills them in other ways */
    return BVX_OK;
}
