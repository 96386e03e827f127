/* mend.c - a stack in which loops touch or cross themselves or each other, made one that can be built.
 *
 * One rule: inside is what an odd number of loops enclose, as it is for loops in loops. That stays as it was.
 * Loops that neither touch nor cross are copied as they are; the others are split where they meet
 * (mend_split.c) and joined anew (mend_trace.c). Points that lie on no border any more are left out: those of
 * slits, spikes and borders that two loops have in common. What is still not simple after that is refused by
 * the checks of every stack. */
#include "contours/mend.h"

enum { MEND_COARSEST = 4 }; /* bits of a cell in fixed point */

#define MEND_LEAST_STEP (1.0 / 4194304.0) /* of the contours' extent, on planes of any direction */

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
    *kept = *given;
    kept->loop_count = 0;
    kept->loops = NULL;
    BVXI_TRY(BVXI_ARRAY(ctx, given->loop_count, "the loops to mend", kept->loops));
    for (uint64_t i = 0; i < given->loop_count; i++)
        if (mend_has_three_points(given, &given->loops[i])) kept->loops[kept->loop_count++] = given->loops[i];
    *dropped = given->loop_count - kept->loop_count;
    return kept->loop_count != 0
               ? BVX_OK
               : bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no loop has three different points", function);
}

static bvx_status mend_copy_loop(const bvx_sections *given, uint64_t number, bvxi_mended *m)
{
    const bvx_section_loop *const l = &given->loops[number];
    BVXI_TRY(bvxi_mended_add_loop(m, l->section, l->label));
    for (uint64_t i = 0; i < l->point_count; i++)
        BVXI_TRY(bvxi_mended_add_point(m, given->points + 3 * (l->first_point + i), 0, 0));
    return BVX_OK;
}

/* Where splitting does not end, loops stay as they are and are refused later. */
static bvx_status mend_plane(bvxi_mend_work *w, bvxi_mended *m)
{
    uint64_t changed = 0;
    int done;
    BVXI_TRY(bvxi_mend_split_plane(w, &done));
    for (uint32_t i = 0; i < w->plane->contour_count; i++) {
        if (w->changed[i] && done) changed++;
        else BVXI_TRY(mend_copy_loop(w->s->given, w->plane->contour[i].given, m));
    }
    m->loops += changed;
    return changed == 0 ? BVX_OK : bvxi_mend_trace(w, m);
}

static bvx_status mend_stack(bvxi_stack *s, bvxi_mended *m)
{
    bvxi_map map = {0};
    bvxi_mend_work w = {.s = s, .map = &map};
    uint64_t most = 1;

    /* One mark a loop, for the plane with the most; other arrays grow as needed. */
    for (uint32_t i = 0; i < s->plane_count; i++)
        if (s->plane[i].contour_count > most) most = s->plane[i].contour_count;
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the loops to mend", w.changed));
    for (uint32_t i = 0; i < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "mend", (double)i / s->plane_count));
        bvxi_plane_snap(s, &s->plane[i]);
        w.plane = &s->plane[i];
        BVXI_TRY(mend_plane(&w, m));
    }
    return BVX_OK;
}

static void begin_mended(bvx_context *ctx, const char *function, const bvx_sections *given, bvxi_mended *m)
{
    *m = (bvxi_mended){.ctx = ctx, .function = function, .sections = *given};
    m->sections.points = NULL;
    m->sections.loops = NULL;
    m->sections.point_count = m->sections.loop_count = m->sections.point_capacity =
        m->sections.loop_capacity = 0;
}

static double step_length(double cell, int32_t fine)
{
    return cell / (double)(1 << (fine - 1));
}

bvx_status bvxi_mend(bvx_context *ctx, const char *function, const bvx_sections *given,
                     const bvx_sections_options *options, double least, bvxi_mended *m)
{
    bvx_sections kept;
    bvxi_stack s;
    begin_mended(ctx, function, given, m);
    BVXI_TRY(mend_drop_lines(ctx, function, given, &kept, &m->loops));
    BVXI_TRY(bvxi_stack_begin(ctx, function, &kept, options, &s));
    while (s.fine > MEND_COARSEST && step_length(s.step[0], s.fine) < least) s.fine--;
    /* The mended stack is built on this grid, whose fixed point the steps count in. */
    bvxi_stack_give_grid(&s, &m->grid);
    return mend_stack(&s, m);
}

/* The loops of one section, a stack of one plane, with their points where steps put them. */
static bvx_status mend_section(bvx_context *ctx, const char *function, const bvx_sections *one,
                               uint32_t section, const bvx_sections_options *o, double least, bvxi_mended *m)
{
    bvxi_mended mended;
    double axis[3][3];
    bvx_status const status = bvxi_mend(ctx, function, one, o, least, &mended);
    const bvx_section_loop *l = mended.sections.loops;

    /* Nothing of them encloses an area. */
    m->loops += status == BVX_ERR_EMPTY ? one->loop_count : mended.loops;
    if (status != BVX_OK) return status == BVX_ERR_EMPTY ? BVX_OK : status;
    BVXI_TRY(bvxi_section_frame(ctx, function, one->normal, axis));
    for (; l < mended.sections.loops + mended.sections.loop_count; l++) {
        BVXI_TRY(bvxi_mended_add_loop(m, section, l->label));
        for (uint64_t p = l->first_point; p < l->first_point + l->point_count; p++) {
            double at[3];
            memcpy(at, mended.sections.points + 3 * p, sizeof at);
            for (int a = 0; a < 2; a++)
                for (int k = 0; k < 3 && mended.nudge[p][a] != 0; k++)
                    at[k] += axis[a][k] *
                             (mended.nudge[p][a] * step_length(mended.grid.step[a], mended.grid.fine));
            BVXI_TRY(bvxi_mended_add_point(m, at, 0, 0));
        }
    }
    return BVX_OK;
}

bvx_status bvxi_mend_planes(bvx_context *ctx, const char *function, const bvx_sections *given,
                            const bvx_sections_options *options, bvxi_mended *m)
{
    bvx_sections_options o = *options;
    bvx_sections one = *given;
    double widest = 0.0;

    begin_mended(ctx, function, given, m);
    /* A stack of one plane has no other to take its height from. */
    o.thickness = 1.0;
    if (o.label == BVXI_LABEL_ONLY) o.label = given->loops[0].label;
    for (uint64_t i = 0; i < 3 * given->point_count; i++) {
        double const width = bvxi_absolute(given->points[i] - given->points[i % 3]);
        if (width > widest) widest = width;
    }
    one.normals = NULL;
    one.section_count = 1;
    BVXI_TRY(BVXI_ARRAY(ctx, given->loop_count, "the loops to mend", one.loops));
    for (uint32_t k = 0; k < given->section_count; k++) {
        one.loop_count = 0;
        one.positions = given->positions + k;
        memcpy(one.normal, given->normals + 3 * (uint64_t)k, sizeof one.normal);
        for (uint64_t i = 0; i < given->loop_count; i++) {
            if (given->loops[i].section != k) continue;
            one.loops[one.loop_count] = given->loops[i];
            one.loops[one.loop_count].section = 0;
            if (given->loops[i].label == o.label) one.loop_count++;
            else BVXI_TRY(mend_copy_loop(given, i, m));
        }
        if (one.loop_count != 0)
            BVXI_TRY(mend_section(ctx, function, &one, k, &o, MEND_LEAST_STEP * widest, m));
    }
    return BVX_OK;
}
