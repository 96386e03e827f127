/* mended_stack.c - the stack that mending makes, loop by loop and point by point. */
#include "section/mend.h"

static bvx_status mended_room(bvx_context *ctx, void *block, uint64_t count, uint64_t *room, uint64_t item)
{
    uint64_t const larger = *room < 64 ? 64 : *room + *room / 2;

    if (count < *room) return BVX_OK;
    if (larger > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "mended loops have more than 2^31 points");
    BVXI_TRY(bvxi_resize(ctx, BVXI_SCRATCH, block, *room * item, larger * item, "the mended loops"));
    *room = larger;
    return BVX_OK;
}

bvx_status bvxi_mended_add_loop(bvx_context *ctx, bvxi_mended *m, uint32_t section, int32_t label)
{
    bvx_sections *const s = &m->sections;
    bvx_section_loop *l;

    BVXI_TRY(mended_room(ctx, &s->loops, s->loop_count, &s->loop_capacity, sizeof *s->loops));
    l = &s->loops[s->loop_count++];
    memset(l, 0, sizeof *l);
    l->first_point = s->point_count;
    l->section = section;
    l->label = label;
    return BVX_OK;
}

bvx_status bvxi_mended_add_point(bvx_context *ctx, bvxi_mended *m, const double at[3], int32_t u, int32_t v)
{
    bvx_sections *const s = &m->sections;

    BVXI_TRY(mended_room(ctx, &s->points, s->point_count, &s->point_capacity, 24));
    BVXI_TRY(mended_room(ctx, &m->nudge, s->point_count, &m->nudge_room, sizeof *m->nudge));
    /* Point and steps go side by side; both belong to the loop that was begun last. */
    memcpy(s->points + 3 * s->point_count, at, 24);
    m->nudge[s->point_count][0] = (int16_t)u;
    m->nudge[s->point_count++][1] = (int16_t)v;
    s->loops[s->loop_count - 1].point_count++;
    return BVX_OK;
}

void bvxi_mended_close(bvx_context *ctx, bvxi_mended *m)
{
    bvxi_drop(ctx, m->nudge);
    bvxi_drop(ctx, m->sections.loops);
    bvxi_drop(ctx, m->sections.points);
    memset(m, 0, sizeof *m);
}
