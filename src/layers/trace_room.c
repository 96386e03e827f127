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

/* In views of the stack nothing grows; the calling thread makes such a slab again afterwards. */
static bvx_status trace_reserve(const bvxi_trace *t, void *array, uint64_t count, uint64_t *room,
                                uint64_t item)
{
    if (BVXI_LIKELY(count <= *room)) return BVX_OK;
    if (t->s->fixed) return BVX_ERR_BUDGET;
    return bvxi_reserve(t->s->ctx, array, count + count / 2 + 64, room, item, "the loops of a cell");
}

bvx_status bvxi_trace_open_loop(bvxi_trace *t, uint64_t count)
{
    BVXI_TRY(trace_reserve(t, &t->faces, count, &t->loop_room[1], sizeof *t->faces));
    BVXI_TRY(trace_reserve(t, (void *)&t->at, count, &t->loop_room[2], sizeof *t->at));
    BVXI_TRY(trace_reserve(t, &t->next, count, &t->loop_room[3], sizeof *t->next));
    BVXI_TRY(trace_reserve(t, &t->before, count, &t->loop_room[4], sizeof *t->before));
    return trace_reserve(t, &t->vertex, count, &t->loop_room[0], sizeof *t->vertex);
}

bvx_status bvxi_trace_add_to_loop(bvxi_trace *t, uint32_t *count, uint32_t vertex, uint32_t faces)
{
    if (*count >= t->loop_room[0]) BVXI_TRY(bvxi_trace_open_loop(t, (uint64_t)*count + 1));
    t->vertex[*count] = vertex;
    t->faces[(*count)++] = (uint8_t)faces;
    return BVX_OK;
}

bvx_status bvxi_trace_open_rows(bvxi_trace *t, uint64_t ends, uint64_t nodes)
{
    for (int k = 0; k < 2; k++) {
        BVXI_TRY(trace_reserve(t, &t->row[k], ends + 1, &t->row_room[k], sizeof *t->row[k]));
        BVXI_TRY(trace_reserve(t, &t->cross[k], nodes + 1, &t->cross_room[k], sizeof *t->cross[k]));
    }
    return BVX_OK;
}

bvx_status bvxi_trace_open(bvxi_trace *t, uint32_t loop)
{
    bvxi_stack *const s = t->s;
    BVXI_TRY(BVXI_SLAB_GROW(s, t->node, 0, t->node_room, "the corners of a cell"));
    BVXI_TRY(BVXI_SLAB_GROW(s, t->point, 0, t->point_room, "the crossings of a cell"));
    BVXI_TRY(BVXI_SLAB_GROW(s, t->end, 0, t->end_room, "the crossings of a cell"));
    BVXI_TRY(bvxi_trace_open_rows(t, TRACE_FEW, TRACE_FEW));
    BVXI_TRY(bvxi_map_reserve(s->ctx, &t->folds, 32));
    return bvxi_trace_open_loop(t, loop);
}
