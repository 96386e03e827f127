/* trace_nodes.c - the corners around a cell: its own, and those of finer
 * cells on its sides, with what they are on its levels. */
#include "layers/trace.h"

/* The corner of finer cells at a place or, in the order of rows or of columns, first beyond it. */
static uint32_t hanging_from(const bvxi_field *f, int by_column, const int32_t place[2])
{
    int const across = by_column ? 0 : 1, along = 1 - across;
    const uint32_t *const start = (by_column ? f->hanging_column : f->hanging_row) +
                                  (place[across] >> f->s->fine);
    uint32_t low = start[0], high = start[1];
    while (low < high) {
        uint32_t const middle = low + (high - low) / 2;
        const int32_t *const at = f->slab->hanging[by_column ? f->slab->by_u[middle] : middle].at;
        if (at[across] < place[across] || (at[across] == place[across] && at[along] < place[along]))
            low = middle + 1;
        else high = middle;
    }
    return low;
}

/* Corners of finer cells between two corners of this one, counter-clockwise. */
static bvx_status add_hanging_nodes(bvxi_trace *t, int side)
{
    const bvxi_slab *const slab = t->field->slab;
    int const along = side & 1, across = 1 - along; /* sides 0 and 2 run along u */
    int32_t const line = t->low[across] + (side == 1 || side == 2 ? t->size : 0);
    int32_t const to = t->low[along] + t->size;
    int32_t const after[2] = {along == 0 ? t->low[0] + 1 : line, along == 0 ? line : t->low[1] + 1};
    uint32_t low, n;

    if (slab->hanging_count == 0) return BVX_OK;
    low = hanging_from(t->field, along, after);
    for (n = 0; low + n < slab->hanging_count; n++) {
        const int32_t *const at = slab->hanging[along == 0 ? low + n : slab->by_u[low + n]].at;
        if (at[across] != line || at[along] >= to) break;
    }
    for (uint32_t i = 0; i < n; i++) {
        /* Sides 2 and 3 run towards lower coordinates. */
        uint32_t const number = side >= 2 ? low + n - 1 - i : low + i;
        const bvxi_hanging *const h = &slab->hanging[along == 0 ? number : slab->by_u[number]];
        BVXI_TRY(BVXI_SLAB_GROW(t->s, t->node, t->node_count, t->node_room, "the corners of a cell"));
        bvxi_trace_node *const node = &t->node[t->node_count++];
        memcpy(node->at, h->at, sizeof node->at);
        node->faces = (uint8_t)(BVXI_FACE_SIDE << side);
        node->on[0] = h->inside[0];
        node->on[1] = h->inside[1];
        node->vertex = h->vertex;
        node->inside[0] = h->layer;
        node->inside[1] = 1; /* finished by level_nodes */
    }
    return BVX_OK;
}

/* What a corner is on the cell's own levels, from the planes and the layer of its crossing (in inside[0]). */
static void level_node(bvxi_trace_node *n, int32_t layer)
{
    int32_t const crossed = n->inside[0];
    if (n->on[0] == n->on[1]) {
        n->inside[0] = n->inside[1] = n->on[0];
        n->vertex = BVXI_NONE;
        return;
    }
    n->inside[0] = layer <= crossed ? n->on[0] : n->on[1];
    n->inside[1] = layer + 1 <= crossed ? n->on[0] : n->on[1];
    if (layer != crossed) n->vertex = BVXI_NONE; /* The crossing belongs to one layer's cells. */
}

static bvx_status add_corner(bvxi_trace *t, int i)
{
    static const uint8_t faces[4] = {
        BVXI_FACE_SIDE | BVXI_FACE_SIDE << 3, BVXI_FACE_SIDE | BVXI_FACE_SIDE << 1,
        BVXI_FACE_SIDE << 1 | BVXI_FACE_SIDE << 2, BVXI_FACE_SIDE << 2 | BVXI_FACE_SIDE << 3};
    const bvxi_slab *const slab = t->field->slab;
    int32_t const fine = t->s->fine, part = (1 << fine) - 1;

    BVXI_TRY(BVXI_SLAB_GROW(t->s, t->node, t->node_count, t->node_room, "the corners of a cell"));
    bvxi_trace_node *const n = &t->node[t->node_count++];
    n->at[0] = t->low[0] + (i == 1 || i == 2 ? t->size : 0);
    n->at[1] = t->low[1] + (i >= 2 ? t->size : 0);
    n->faces = faces[i];
    n->inside[1] = 1;
    if ((n->at[0] & part) == 0 && (n->at[1] & part) == 0) {
        int32_t const x = n->at[0] >> fine, y = n->at[1] >> fine;
        uint32_t const number = bvxi_line_number(t->field, x, y);
        for (int k = 0; k < 2; k++) n->on[k] = (uint8_t)bvxi_grid_bit(t->s, slab->plane[k], x, y);
        n->vertex = n->on[0] != n->on[1] ? t->field->first + number : BVXI_NONE;
        n->inside[0] = t->field->layers > 1 && n->on[0] != n->on[1] ? t->field->layer[number] : 0;
    } else {
        uint32_t const low = hanging_from(t->field, 0, n->at);
        n->on[0] = slab->hanging[low].inside[0];
        n->on[1] = slab->hanging[low].inside[1];
        n->vertex = slab->hanging[low].vertex;
        n->inside[0] = slab->hanging[low].layer;
    }
    return BVX_OK;
}

bvx_status bvxi_trace_nodes(bvxi_trace *t, uint32_t corner[5])
{
    t->node_count = 0;
    for (int i = 0; i < 4; i++) {
        corner[i] = t->node_count;
        BVXI_TRY(add_corner(t, i));
        if (t->beside_split) BVXI_TRY(add_hanging_nodes(t, i));
    }
    corner[4] = t->node_count;
    for (uint32_t i = 0; i < t->node_count; i++) level_node(&t->node[i], t->layer);
    return BVX_OK;
}
