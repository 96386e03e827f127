/* section_mesh.c - the growing mesh of a body between sections. */
#include "section/section.h"

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
