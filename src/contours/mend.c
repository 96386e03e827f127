/* mend.c - a stack in which loops touch or cross themselves or each other, made one that can be built.
 *
 * One rule: inside is what an odd number of loops enclose, as it is for loops in loops. That stays as it was.
 * Loops that neither touch nor cross are copied as they are; the others are split where they meet
 * (mend_split.c) and joined anew (mend_trace.c). Points that lie on no border any more are left out: those of
 * slits, spikes and borders that two loops have in common. What is still not simple after that is refused by
 * the checks of every stack. */
#include "contours/mend.h"

/* ---- loops that are lines or points ---- */

static int mend_has_three_points(const bvx_sections *given, const bvx_section_loop *l)
{
    const double *const p = given->points + 3 * l->first_point;
    uint64_t different = 0;

    for (uint64_t i = 0; i < l->point_count; i++) {
        const double *const a = p + 3 * i, *const b = p + 3 * (i == 0 ? l->point_count - 1 : i - 1);
        different += a[0] != b[0] || a[1] != b[1] || a[2] != b[2];
    }
    return different > 2;
}

/* The stack without loops of fewer than three different points; it shares all arrays but the loops. */
static bvx_status mend_drop_lines(bvx_context *ctx, const char *function, const bvx_sections *given,
                                  bvx_sections *kept, uint64_t *dropped)
{
    /* Only the list of loops is new; points stay where they are. */
    *kept = *given;
    kept->loop_count = 0;
    kept->loops = NULL;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, given->loop_count * sizeof *kept->loops, "the loops to mend",
                        &kept->loops));
    for (uint64_t i = 0; i < given->loop_count; i++)
        if (mend_has_three_points(given, &given->loops[i])) kept->loops[kept->loop_count++] = given->loops[i];
    *dropped = given->loop_count - kept->loop_count;
    return kept->loop_count != 0
               ? BVX_OK
               : bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no loop has three different points", function);
}

/* ---- planes ---- */

static bvx_status mend_copy_loop(const bvxi_mend_work *w, uint32_t number, bvxi_mended *m)
{
    const bvx_sections *const given = w->s->given;
    const bvx_section_loop *const l = &given->loops[w->plane->contour[number].given];
    bvx_context *const ctx = w->s->ctx;

    BVXI_TRY(bvxi_mended_add_loop(ctx, m, l->section, l->label));
    for (uint64_t i = 0; i < l->point_count; i++)
        BVXI_TRY(bvxi_mended_add_point(ctx, m, given->points + 3 * (l->first_point + i), 0, 0));
    return BVX_OK;
}

/* Where splitting does not end, loops stay as they are and are refused later. */
static bvx_status mend_plane(bvxi_mend_work *w, bvxi_mended *m)
{
    uint64_t changed = 0;
    int done;

    BVXI_TRY(bvxi_mend_split_plane(w, &done));
    /* Loops that neither touch nor cross keep their points and their order. */
    for (uint32_t i = 0; i < w->plane->contour_count; i++) {
        if (w->changed[i] && done) changed++;
        else BVXI_TRY(mend_copy_loop(w, i, m));
    }
    m->loops += changed;
    return changed == 0 ? BVX_OK : bvxi_mend_trace(w, m);
}

static bvx_status mend_planes(bvxi_mend_work *w, bvxi_mended *m)
{
    bvxi_stack *const s = w->s;

    for (uint32_t i = 0; i < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "mend", (double)i / s->plane_count));
        bvxi_plane_snap(s, &s->plane[i]);
        w->plane = &s->plane[i];
        BVXI_TRY(mend_plane(w, m));
    }
    return BVX_OK;
}

static bvx_status mend_stack(bvxi_stack *s, bvxi_mended *m)
{
    bvxi_vertex_map map = {NULL, NULL, 0, 0};
    bvxi_mend_work w;
    uint64_t most = 1;

    memset(&w, 0, sizeof w);
    w.s = s;
    w.map = &map;
    /* One mark a loop, for the plane with the most; other arrays grow as needed. */
    for (uint32_t i = 0; i < s->plane_count; i++)
        if (s->plane[i].contour_count > most) most = s->plane[i].contour_count;
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, most, "the loops to mend", &w.changed));
    BVXI_TRY(mend_planes(&w, m));
    bvxi_drop(s->ctx, w.active);
    bvxi_drop(s->ctx, w.order);
    bvxi_drop(s->ctx, w.key);
    bvxi_drop(s->ctx, w.split);
    bvxi_drop(s->ctx, w.split_edge);
    bvxi_drop(s->ctx, w.edge);
    bvxi_drop(s->ctx, w.node);
    bvxi_drop(s->ctx, w.changed);
    bvxi_map_free(s, &map);
    return BVX_OK;
}

bvx_status bvxi_mend(bvx_context *ctx, const char *function, const bvx_sections *given,
                     const bvx_sections_options *options, bvxi_mended *m)
{
    bvx_sections kept;
    bvxi_stack s;

    memset(m, 0, sizeof *m);
    memset(&s, 0, sizeof s);
    memset(&kept, 0, sizeof kept);
    BVXI_TRY(mend_drop_lines(ctx, function, given, &kept, &m->loops));
    /* The result has the planes of the given stack, and loops of its own. */
    m->sections = *given;
    m->sections.points = NULL;
    m->sections.loops = NULL;
    m->sections.point_count = m->sections.loop_count = m->sections.point_capacity =
        m->sections.loop_capacity = 0;
    /* The mended stack is built on this grid, whose fixed point the steps count in. */
    BVXI_TRY(bvxi_stack_begin(ctx, function, &kept, options, &s));
    bvxi_stack_give_grid(&s, &m->grid);
    BVXI_TRY(mend_stack(&s, m));
    bvxi_stack_close(&s);
    bvxi_drop(ctx, kept.loops);
    return BVX_OK;
}
