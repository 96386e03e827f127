/* trace_room.c - the arrays of one cell's trace: they grow on the calling
 * thread, never in a view of the stack that other threads have. */
#include "layers/trace.h"

enum { TRACE_FEW = 64 };

bvx_status bvxi_trace_add_point(bvxi_trace *t, uint32_t vertex, uint32_t faces, uint32_t *point)
{
    BVXI_TRY(BVXI_SLAB_GROW(t->s, t->point, t->point_count, t->point_room, "the crossings of a cell"));
    *point = t->point_count++;
    bvxi_trace_point *const p = &t->point[*point];
    p->vertex = vertex;
    p->next = BVXI_NONE;
    p->arc = BVXI_NONE;
    p->faces = (uint8_t)faces;
    p->link = BVXI_LINK_STRAIGHT;
    p->seen = 0;
    return BVX_OK;
}

bvx_status bvxi_trace_open_loop(bvxi_trace *t, uint64_t count)
{
    static const char what[] = "a loop of a cell";
    bvxi_stack *const s = t->s;
    uint64_t const room = count + count / 2 + 64, old = t->loop_room;

    if (count <= old) return BVX_OK;

    /* In views of the stack nothing may grow; the calling thread makes such a slab again afterwards. */
    if (s->fixed) return BVX_ERR_BUDGET;
    if (room > INT32_MAX)
        return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: a cell holds more than 2^31 contour points", s->function);

    /* what was is kept: a loop grows while it is followed */
    BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, &t->vertex, old * 4, room * 4, what));
    BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, &t->faces, old, room, what));
    bvxi_drop(s->ctx, t->before);
    bvxi_drop(s->ctx, t->next);
    bvxi_drop(s->ctx, (void *)t->at);
    t->before = t->next = NULL;
    t->at = NULL;
    BVXI_TRY(BVXI_ARRAY(s->ctx, room, what, t->at));
    BVXI_TRY(BVXI_ARRAY(s->ctx, room, what, t->next));
    BVXI_TRY(BVXI_ARRAY(s->ctx, room, what, t->before));
    t->loop_room = (uint32_t)room;
    return BVX_OK;
}

bvx_status bvxi_trace_add_to_loop(bvxi_trace *t, uint32_t *count, uint32_t vertex, uint32_t faces)
{
    if (*count >= t->loop_room) BVXI_TRY(bvxi_trace_open_loop(t, (uint64_t)*count + 1));
    t->vertex[*count] = vertex;
    t->faces[(*count)++] = (uint8_t)faces;
    return BVX_OK;
}

bvx_status bvxi_trace_open_rows(bvxi_trace *t)
{
    bvxi_stack *const s = t->s;
    uint32_t const need = t->end_count + 1, crossings = t->node_count + 1;

    for (int which = 0; which < 2; which++) {
        uint32_t *const room = which == 0 ? &t->row_room : &t->cross_room;
        uint64_t const wanted = which == 0 ? need : crossings, larger = wanted + wanted / 2 + 16;
        if (wanted <= *room) continue;
        if (s->fixed) return BVX_ERR_BUDGET;
        /* Both rows are made anew together, as one length stands for both. */
        for (int k = 0; k < 2; k++) {
            uint32_t **const rows = which == 0 ? &t->row[k] : &t->cross[k];
            uint32_t *made = NULL;
            BVXI_TRY(BVXI_ARRAY(s->ctx, larger, "the crossings of a side", made));
            bvxi_drop(s->ctx, *rows);
            *rows = made;
        }
        *room = (uint32_t)larger;
    }
    return BVX_OK;
}

bvx_status bvxi_trace_open(bvxi_trace *t, uint32_t loop)
{
    bvxi_stack *const s = t->s;
    BVXI_TRY(BVXI_SLAB_GROW(s, t->node, 0, t->node_room, "the corners of a cell"));
    BVXI_TRY(BVXI_SLAB_GROW(s, t->point, 0, t->point_room, "the crossings of a cell"));
    BVXI_TRY(BVXI_SLAB_GROW(s, t->end, 0, t->end_room, "the crossings of a cell"));
    t->end_count = t->node_count = TRACE_FEW;
    BVXI_TRY(bvxi_trace_open_rows(t));
    t->end_count = t->node_count = 0;
    BVXI_TRY(bvxi_map_reserve(s->ctx, &t->folds, 32));
    return bvxi_trace_open_loop(t, loop);
}
