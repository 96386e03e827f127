/* section_mesh.c - the growing mesh of a body between sections. */
#include "section/section.h"

static bvx_status section_grow(bvxi_stack *s, void *block, uint64_t item, uint64_t *room, const char *what)
{
    uint64_t const larger = *room < 1024 ? 1024 : *room + *room / 2;
    BVXI_TRY(bvxi_resize(s->ctx, BVXI_SCRATCH, block, *room * item, larger * item, what));
    *room = larger;
    return BVX_OK;
}

bvx_status bvxi_section_add_vertex(bvxi_stack *s, const double position[3], uint32_t *number)
{
    bvxi_section_mesh *const m = &s->mesh;
    if (m->vertex_count == m->vertex_room) {
        if (m->vertex_count >= UINT32_MAX - 1)
            return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: the surface has more than 2^32 vertices", s->function);
        BVXI_TRY(section_grow(s, &m->position, 24, &m->vertex_room, "the vertices of a body"));
    }
    memcpy(m->position + 3 * m->vertex_count, position, 24);
    *number = (uint32_t)m->vertex_count++;
    return BVX_OK;
}

bvx_status bvxi_section_add_triangle(bvxi_stack *s, uint32_t a, uint32_t b, uint32_t c)
{
    bvxi_section_mesh *const m = &s->mesh;
    uint32_t *t;
    if (m->triangle_count == m->triangle_room) {
        if (m->triangle_count >= INT32_MAX)
            return bvxi_fail(s->ctx, BVX_ERR_RANGE, "%s: the surface has more than 2^31 triangles", s->function);
        BVXI_TRY(section_grow(s, &m->triangle, 12, &m->triangle_room, "the triangles of a body"));
    }
    t = m->triangle + 3 * m->triangle_count++;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return BVX_OK;
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
