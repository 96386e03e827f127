/* section_mesh.c - the growing mesh of a body between sections, and its vertices by a key. */
#include "contours/section.h"

bvx_status bvxi_section_add_vertex(bvxi_stack *s, const double position[3], uint32_t *number)
{
    bvxi_section_mesh *const m = &s->mesh;
    if (m->vertex_count == m->vertex_room) {
        if (m->vertex_count + s->ring_vertices >= UINT32_MAX - 1)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the surface has more than 2^32 vertices", s->function);
        if (s->fixed) return BVX_ERR_BUDGET;
        BVXI_TRY(bvxi_grow(s->ctx, s->function, &m->position, &m->vertex_room, 24, "the vertices of a body"));
    }
    memcpy(m->position + 3 * m->vertex_count, position, 24);
    *number = s->ring_vertices + (uint32_t)m->vertex_count++;
    return BVX_OK;
}

bvx_status bvxi_section_more_triangles(bvxi_stack *s)
{
    return s->fixed ? BVX_ERR_BUDGET
                    : bvxi_grow(s->ctx, s->function, &s->mesh.triangle, &s->mesh.triangle_room, 12,
                                "the triangles of a body");
}

void bvxi_section_place(const bvxi_stack *s, double u, double v, double w, double position[3])
{
    for (int i = 0; i < 3; i++) position[i] = (s->axis[0][i] * u + s->axis[1][i] * v) + s->axis[2][i] * w;
}

void bvxi_section_locate(bvxi_stack *s, double u, double v, double w)
{
    double at[3];
    bvxi_section_place(s, u, v, w, at);
    bvxi_report_place(&s->report, at);
}

bvx_status bvxi_section_check_mesh(bvx_context *ctx, bvx_mesh *mesh, int own, int *sound)
{
    bvx_certificate c;
    bvx_mesh_view view;
    bvx_mesh_view_of(mesh, &view);
    bvx_status const status = bvx_mesh_check(ctx, &view, 0, &c);
    *sound = status == BVX_OK && c.closed && c.edge_manifold && c.vertex_manifold && c.oriented;
    if (!*sound && own) bvx_mesh_free(ctx, mesh);
    return status;
}

/* ---- Numbers by a key ---- */

/* Open addressing over a table that is at most half full, so every search ends at a free slot. */
static uint64_t map_slot(const bvxi_map *m, uint64_t key)
{
    uint64_t const mixed = key * UINT64_C(0x9e3779b97f4a7c15) >> 24;
    uint64_t i = (m->near ? (key >> 32) * 4 + (mixed & 63) : mixed) & (m->room - 1);
    while (m->key[i] != UINT64_MAX && m->key[i] != key) i = (i + 1) & (m->room - 1);
    return i;
}

static bvx_status map_resize(bvx_context *ctx, bvxi_map *m, uint64_t room)
{
    bvxi_map larger = {NULL, NULL, room, m->count, m->near};

    BVXI_TRY(BVXI_ARRAY(ctx, room, "numbers by a key", larger.key));
    BVXI_TRY(BVXI_ARRAY(ctx, room, "numbers by a key", larger.value));
    memset(larger.key, 0xff, (size_t)(room * 8));
    for (uint64_t i = 0; i < m->room; i++)
        if (m->key[i] != UINT64_MAX) {
            uint64_t const at = map_slot(&larger, m->key[i]);
            larger.key[at] = m->key[i];
            larger.value[at] = m->value[i];
        }
    bvxi_drop(ctx, m->value);
    bvxi_drop(ctx, m->key);
    *m = larger;
    return BVX_OK;
}

bvx_status bvxi_map_reserve(bvx_context *ctx, bvxi_map *m, uint64_t count)
{
    uint64_t room = 64;
    while (room < 2 * count) room *= 2;
    return room > m->room ? map_resize(ctx, m, room) : BVX_OK;
}

bvx_status bvxi_map_add(bvx_context *ctx, bvxi_map *m, uint64_t key, uint32_t **value)
{
    if (2 * m->count >= m->room) BVXI_TRY(map_resize(ctx, m, m->room == 0 ? 1024 : 2 * m->room));
    uint64_t const at = map_slot(m, key);
    if (m->key[at] == UINT64_MAX) {
        m->key[at] = key;
        m->value[at] = BVXI_NONE;
        m->count++;
    }
    *value = &m->value[at];
    return BVX_OK;
}

bvx_status bvxi_stack_map_add(const bvxi_stack *s, bvxi_map *m, uint64_t key, uint32_t **value)
{
    return s->fixed && 2 * m->count >= m->room ? BVX_ERR_BUDGET : bvxi_map_add(s->ctx, m, key, value);
}

uint32_t bvxi_map_find(const bvxi_map *m, uint64_t key)
{
    if (m->room == 0) return BVXI_NONE;
    uint64_t const at = map_slot(m, key);
    return m->key[at] == UINT64_MAX ? BVXI_NONE : m->value[at];
}

void bvxi_map_clear(bvxi_map *m)
{
    if (m->count != 0) memset(m->key, 0xff, (size_t)(m->room * 8));
    m->count = 0;
}
