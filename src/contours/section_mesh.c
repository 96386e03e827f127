/* section_mesh.c - the growing mesh of a body between sections, and its vertices by a key. */
#include "contours/section.h"

/* ---- The mesh ---- */

bvx_status bvxi_slab_enlarge(bvxi_stack *s, void *block, uint32_t *room, uint64_t item, const char *what)
{
    uint64_t const larger = *room < 64 ? 64 : (uint64_t)*room + *room / 2;
    if (larger > INT32_MAX)
        return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%s: more than 2^31 of %s",
                             s->function, what);

    /* Rooms that were laid out beforehand cannot grow: the caller tries again with larger ones. */
    if (s->fixed) return BVX_ERR_BUDGET;
    BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, block, *room * item, larger * item, what));
    *room = (uint32_t)larger;
    return BVX_OK;
}

static bvx_status section_grow(bvxi_stack *s, void *block, uint64_t item, uint64_t *room, const char *what)
{
    uint64_t const larger = *room < 1024 ? 1024 : *room + *room / 2;
    if (s->fixed) return BVX_ERR_BUDGET;
    BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, block, *room * item, larger * item, what));
    *room = larger;
    return BVX_OK;
}

bvx_status bvxi_section_add_vertex(bvxi_stack *s, const double position[3], uint32_t *number)
{
    bvxi_section_mesh *const m = &s->mesh;

    if (m->vertex_count == m->vertex_room) {
        if (m->vertex_count + s->ring_vertices >= UINT32_MAX - 1)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the surface has more than 2^32 vertices", s->function);
        BVXI_TRY(section_grow(s, &m->position, 24, &m->vertex_room, "the vertices of a body"));
    }
    memcpy(m->position + 3 * m->vertex_count, position, 24);
    *number = s->ring_vertices + (uint32_t)m->vertex_count++;
    return BVX_OK;
}

bvx_status bvxi_section_more_triangles(bvxi_stack *s)
{
    bvxi_section_mesh *const m = &s->mesh;
    if (!s->fixed && m->triangle_count >= INT32_MAX)
        return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has more than 2^31 triangles", s->function);
    return section_grow(s, &m->triangle, 12, &m->triangle_room, "the triangles of a body");
}

void bvxi_section_place(const bvxi_stack *s, double u, double v, double w, double position[3])
{
    for (int i = 0; i < 3; i++) position[i] = (s->axis[0][i] * u + s->axis[1][i] * v) + s->axis[2][i] * w;
}

void bvxi_section_locate(bvxi_stack *s, double u, double v, double w)
{
    if (s->report.located >= BVX_SECTIONS_LOCATED) return;
    bvxi_section_place(s, u, v, w, s->report.unkept[s->report.located++]);
}

/* ---- Vertices by a key ---- */

/* Open addressing over a table that is at most half full, so every search ends at a free slot. */
static uint32_t map_slot(const bvxi_vertex_map *m, uint64_t key)
{
    uint64_t h = key * UINT64_C(0x9e3779b97f4a7c15);
    uint32_t i = (uint32_t)(h >> 32) & (m->room - 1);
    while (m->key[i] != UINT64_MAX && m->key[i] != key) i = (i + 1) & (m->room - 1);
    return i;
}

static bvx_status map_resize(bvxi_stack *s, bvxi_vertex_map *m, uint32_t room)
{
    bvxi_vertex_map larger = {NULL, NULL, 0, 0};

    if (s->fixed) return BVX_ERR_BUDGET;
    larger.room = room;
    larger.count = m->count;
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)room * 8, "the crossings of edges", &larger.key));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, (uint64_t)room * 4, "the crossings of edges", &larger.vertex));

    memset(larger.key, 0xff, (size_t)room * 8);
    for (uint32_t i = 0; i < m->room; i++)
        if (m->key[i] != UINT64_MAX) {
            uint32_t const at = map_slot(&larger, m->key[i]);
            larger.key[at] = m->key[i];
            larger.vertex[at] = m->vertex[i];
        }
    bvxi_drop(s->ctx, m->vertex);
    bvxi_drop(s->ctx, m->key);
    *m = larger;
    return BVX_OK;
}

bvx_status bvxi_map_find(bvxi_stack *s, bvxi_vertex_map *m, uint64_t key, uint32_t **vertex)
{
    uint32_t at;

    if (2 * (uint64_t)m->count >= m->room) {
        if (m->room >= UINT32_C(1) << 30)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: more than 2^29 crossings of edges", s->function);
        BVXI_TRY(map_resize(s, m, m->room == 0 ? 64 : 2 * m->room));
    }
    at = map_slot(m, key);
    if (m->key[at] == UINT64_MAX) {
        m->key[at] = key;
        m->vertex[at] = BVXI_NONE;
        m->count++;
    }
    *vertex = &m->vertex[at];
    return BVX_OK;
}

bvx_status bvxi_map_open(bvxi_stack *s, bvxi_vertex_map *m)
{
    return m->room != 0 ? BVX_OK : map_resize(s, m, 64);
}

void bvxi_map_clear(bvxi_vertex_map *m)
{
    if (m->count != 0) memset(m->key, 0xff, (size_t)m->room * 8);
    m->count = 0;
}
