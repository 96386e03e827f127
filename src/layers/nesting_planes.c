/* nesting_planes.c - a nesting level of a section as a plane of its own.
 *
 * It shares points, crossings and ring with its section, so that whatever is made of it ends where the
 * surface on the section's other side begins. Its own are what depends on which loops there are: arcs by
 * cell, grid points inside, the tree for distances. A level of holes is turned: what its loops enclose is
 * outside. Then its loops run with the inside on their left as they do in the section, and the triangles
 * between two such levels face the way that the body's surface does. */
#include "layers/slab.h"

typedef struct nest_sizes {
    uint32_t segments;
    uint32_t arcs;
    uint64_t groups, boxes, inside, bytes;
} nest_sizes;

static uint32_t nest_contour_of_arc(const bvxi_plane *p, const bvxi_arc *arc)
{
    return bvxi_contour_of(p, arc->from == BVXI_NONE ? arc->point : p->cut[arc->from].segment);
}

static void nest_measure_level(const bvxi_stack *s, const bvxi_plane *whole, const uint8_t *level,
                               uint32_t number, nest_sizes *size)
{
    memset(size, 0, sizeof *size);
    for (uint32_t c = 0; c < whole->contour_count; c++)
        if (level[c] == number) size->segments += whole->contour[c].count;
    for (uint32_t i = 0; i < whole->arc_count; i++)
        size->arcs += level[nest_contour_of_arc(whole, &whole->arc[i])] == number;
    bvxi_plane_tree_size(size->segments, &size->groups, &size->boxes);
    size->inside = bvxi_stack_words(s);
    size->bytes = whole->contour_count * sizeof *whole->contour + size->groups * sizeof *whole->group +
                  size->boxes * sizeof *whole->box + size->inside * sizeof *whole->inside +
                  size->arcs * (sizeof *whole->arc + sizeof *whole->ring_arc + sizeof *whole->arc_cell +
                                sizeof *whole->asking) +
                  (uint64_t)size->segments * sizeof *whole->segment;
}

/* One block for all of them, eight bytes wide items first; it begins with the contours. */
static void nest_place_level(bvxi_plane *p, unsigned char *at, const nest_sizes *size, uint32_t **segment)
{
    p->contour = (bvxi_contour *)(void *)at;
    at += p->contour_count * sizeof *p->contour;
    p->group = (bvxi_segment_group *)(void *)at;
    at += size->groups * sizeof *p->group;
    p->box = (double(*)[4])(void *)at;
    at += size->boxes * sizeof *p->box;
    p->inside = (uint64_t *)(void *)at;
    at += size->inside * sizeof *p->inside;
    p->arc = (bvxi_arc *)(void *)at;
    at += size->arcs * sizeof *p->arc;
    p->ring_arc = (bvxi_ring_arc *)(void *)at;
    at += size->arcs * sizeof *p->ring_arc;
    p->arc_cell = (uint32_t *)(void *)at;
    at += size->arcs * sizeof *p->arc_cell;
    p->asking = (uint32_t *)(void *)at;
    at += size->arcs * sizeof *p->asking;
    *segment = (uint32_t *)(void *)at;
    p->segment = *segment;
}

/* A part that ends before the next section does so here too, unless one of its holes goes on. */
static void nest_copy_loops(bvxi_plane *p, const uint8_t *level, uint32_t number, uint32_t *part)
{
    const bvxi_plane *const whole = p->whole;
    memcpy(p->contour, whole->contour, whole->contour_count * sizeof *p->contour);
    p->ends[0] = p->ends[1] = 0;
    if (!whole->ends[0] && !whole->ends[1]) return;
    bvxi_plane_parts(whole, part);
    for (uint32_t c = 0; c < p->contour_count; c++) {
        if (level[c] == level[part[c]]) continue;
        for (uint32_t i = 0; i < p->contour_count; i++)
            if (part[i] == part[c]) p->contour[i].end[0] = p->contour[i].end[1] = 0.0;
    }
    for (uint32_t c = 0; c < p->contour_count; c++)
        for (int k = 0; k < 2; k++) p->ends[k] |= level[c] == number && p->contour[c].end[k] > 0.0;
}

static void nest_fill_level(const bvxi_stack *s, bvxi_plane *p, const uint8_t *level, uint32_t number,
                            uint32_t *segment)
{
    const bvxi_plane *const whole = p->whole;

    p->segment_count = p->arc_count = p->asking_count = 0;
    for (uint32_t c = 0; c < p->contour_count; c++)
        for (uint32_t i = 0; i < p->contour[c].count && level[c] == number; i++)
            segment[p->segment_count++] = p->contour[c].first + i;

    for (uint32_t i = 0; i < whole->arc_count; i++) {
        if (level[nest_contour_of_arc(whole, &whole->arc[i])] != number) continue;
        p->arc[p->arc_count] = whole->arc[i];
        p->arc_cell[p->arc_count++] = whole->arc_cell[i];
    }

    bvxi_plane_look_at_cells(s, p);

    /* Each crossing of a line of one v turns the grid points beyond it, and is the end of one arc. */
    memset(p->inside, 0, (size_t)bvxi_stack_words(s) * 8);
    for (uint32_t i = 0; i < p->arc_count; i++) {
        const bvxi_line_cut *const c = &p->cut[p->arc[i].to];
        uint32_t const bit = (p->arc_cell[i] & 0xffff) + 1;
        /* Loops inside a cell and crossings of the other axis turn no row. */
        if (p->arc[i].from == BVXI_NONE || c->axis != 1) continue;
        p->inside[(size_t)(c->line >> s->fine) * (size_t)s->words + (bit >> 6)] ^= UINT64_C(1) << (bit & 63);
    }
    bvxi_plane_fill_rows(s, p->inside);
    for (uint64_t i = 0; i < bvxi_stack_words(s) && p->turned; i++) p->inside[i] = ~p->inside[i];

    bvxi_plane_tree(p);
}

/* side: 0 for a level between its section and the one above, 1 below. part: scratch, one a loop. */
static bvx_status nest_make_level(bvxi_stack *s, bvxi_plane *whole, int side, uint32_t number, uint32_t *part)
{
    const uint8_t *const level = s->nesting.level[side] + (whole->contour - s->all.contour);
    bvxi_plane *const p = &s->nesting.plane[s->nesting.plane_count];
    unsigned char *block;
    uint32_t *segment;
    nest_sizes size;

    nest_measure_level(s, whole, level, number, &size);
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, size.bytes, "the levels of loops", &block));
    s->nesting.plane_count++;

    *p = *whole;
    p->whole = whole;
    p->turned = (int)(number & 1);
    nest_place_level(p, block, &size, &segment);
    nest_copy_loops(p, level, number, part);
    nest_fill_level(s, p, level, number, segment);
    return BVX_OK;
}

bvx_status bvxi_nesting_make(bvxi_stack *s)
{
    bvxi_nesting *const n = &s->nesting;
    uint64_t most = 0;
    uint32_t *part = NULL;

    if (n->count == NULL) return BVX_OK;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        if (i + 1 < s->plane_count && n->count[i] > 1) n->plane_room += 2 * (uint32_t)n->count[i];
        if (s->plane[i].contour_count > most) most = s->plane[i].contour_count;
    }
    if (n->plane_room == 0) return BVX_OK;

    BVXI_TRY(BVXI_ARRAY(s->ctx, n->plane_room, "the levels of loops", n->plane));
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the parts of sections", part));
    for (uint32_t i = 0; i + 1 < s->plane_count; i++)
        for (uint32_t level = 0; level < n->count[i] && n->count[i] > 1; level++)
            for (int k = 0; k < 2; k++)
                BVXI_TRY(nest_make_level(s, &s->plane[i + (uint32_t)k], k, level, part));
    return BVX_OK;
}

void bvxi_nesting_refresh(bvxi_plane *p)
{
    const bvxi_plane *const whole = p->whole;
    if (whole == NULL) return;
    p->cut = whole->cut;
    p->cut_count = whole->cut_count;
    p->ring_count = whole->ring_count;
    p->vertex = whole->vertex;
}
