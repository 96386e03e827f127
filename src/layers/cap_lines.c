/* cap_lines.c - flat caps of bodies made in the field's way: the region within lines between vertices of the
 * mesh.
 *
 * The lines of the first or last plane, which the cells beside it have left, are followed into loops; from
 * there it is a section like others, whose points are vertices and whose segments nothing crosses. */
#include "contours/section.h"

/* Follow the lines into loops: points in order, contours, directions of
 * holes. behind: [vertices] the next one, or none. */
static bvx_status follow_lines(bvxi_stack *s, bvxi_plane *p, const uint32_t (*edge)[2], uint32_t count,
                               uint32_t *behind)
{
    for (uint32_t i = 0; i < count; i++) behind[edge[i][0]] = edge[i][1];
    for (uint32_t i = 0; i < count; i++) {
        bvxi_contour *const c = &p->contour[p->contour_count];
        uint32_t v = edge[i][0];
        if (behind[v] == BVXI_NONE) continue;
        c->first = p->point_count;
        while (behind[v] != BVXI_NONE) {
            const double *const at = s->mesh.position + 3 * (uint64_t)v;
            uint32_t const n = p->point_count++, next = behind[v];
            for (int k = 0; k < 2; k++)
                p->q[n][k] = 2 * bvxi_snap_steps(s, k, bvxi_along_axis(s->axis[k], at)) + 1;
            p->ring[n] = v;
            p->next[n] = n + 1;
            behind[v] = BVXI_NONE;
            v = next;
        }
        if (v != edge[i][0])
            return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "%s: the lines of a flat cap do not close", s->function);
        c->count = p->point_count - c->first;
        p->next[p->point_count - 1] = c->first;
        c->hole = bvxi_cap_area(p, c) < 0.0;
        p->contour_count++;
    }
    return BVX_OK;
}

bvx_status bvxi_cap_fill_edges(bvxi_stack *s, const uint32_t (*edge)[2], uint32_t count, int32_t side)
{
    uint64_t const vertices = s->mesh.vertex_count;
    uint32_t *behind = NULL;
    bvxi_plane p = {0};

    if (count == 0) return BVX_OK;
    p.lines = 1;
    BVXI_TRY(BVXI_ARRAY(s->ctx, vertices, "the lines of a cap", behind));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.q));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.next));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.ring));
    BVXI_TRY(BVXI_ARRAY(s->ctx, count, "the lines of a cap", p.contour));
    memset(behind, 0xff, (size_t)vertices * 4);
    BVXI_TRY(follow_lines(s, &p, edge, count, behind));
    return bvxi_cap_fill(s, &p, side);
}
