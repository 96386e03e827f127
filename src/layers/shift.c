/* shift.c - slanted parts: sections put in between two whose parts would share too little to join.
 *
 * A blend of two sections' distances joins what overlaps. A vessel that runs aslant may share no area with
 * the next section at all, and falls apart into ridges. Here each part moves from one section to the next
 * (shift_discs.c, shift_between.c) and sections are put in on the way, as many as make neighbours overlap
 * by most of their width. The given sections stay as they are, and what is built of all of them passes
 * through their contours exactly as without. Where no part moves by more than an eighth of its width
 * nothing is put in. */
#include "layers/shift.h"

static bvx_status copy_plane(const bvxi_stack *s, const bvxi_plane *p, uint32_t number, bvxi_mended *to)
{
    for (uint32_t c = 0; c < p->contour_count; c++) {
        BVXI_TRY(bvxi_mended_add_loop(to, number, s->options.label));
        for (uint32_t i = p->contour[c].first; i < p->contour[c].first + p->contour[c].count; i++) {
            uint64_t const at = p->given[i];
            BVXI_TRY(bvxi_mended_add_point(to, s->given->points + 3 * at,
                                           s->nudge == NULL ? 0 : s->nudge[at][0],
                                           s->nudge == NULL ? 0 : s->nudge[at][1]));
        }
    }
    return BVX_OK;
}

/* Points may lie off their plane by a quarter of the way to the next one, also those put in. */
static void keep_points_near(const bvxi_stack *s, const bvxi_plane *pair, bvxi_disc_groups *g)
{
    double const gap = pair[1].w - pair[0].w;
    double most = 0.0;
    for (int k = 0; k < 2; k++)
        for (uint32_t i = 0; i < pair[k].point_count; i++) {
            double const off = bvxi_along_axis(s->axis[2],
                                               s->given->points + 3 * (uint64_t)pair[k].given[i]) -
                               pair[k].w;
            if (off > most) most = off;
            if (-off > most) most = -off;
        }
    /* A little less than the quarter that is checked, for rounding. */
    while (g->steps > 1 && 0.2 * gap / g->steps < most) g->steps--;
}

static bvx_status add_shift_position(bvxi_shifted *to, double w)
{
    bvx_sections *const body = &to->body.sections;
    BVXI_TRY(BVXI_GROW(&to->body, to->positions, body->section_count, to->position_room,
                       "the positions of sections"));
    to->positions[body->section_count++] = w;
    return BVX_OK;
}

static bvx_status shift_pair(const bvxi_stack *s, const bvxi_plane *pair, bvxi_shifted *to)
{
    uint32_t const number = (uint32_t)to->body.sections.section_count;
    bvxi_disc_groups g;
    bvxi_discs on[2];

    for (int k = 0; k < 2; k++) BVXI_TRY(bvxi_discs_open(s, &pair[k], &on[k]));
    /* Positions first, as the loops are numbered by them. */
    BVXI_TRY(bvxi_disc_groups_open(s, on, &g));
    keep_points_near(s, pair, &g);
    for (uint32_t n = 1; n < g.steps; n++)
        BVXI_TRY(add_shift_position(to, pair[0].w + (double)n / g.steps * (pair[1].w - pair[0].w)));
    if (g.steps == 1) return BVX_OK;
    to->sections += g.steps - 1;
    to->parts += g.shifted;
    return bvxi_shift_between(s, on, &g, number, &to->body);
}

bvx_status bvxi_shift_stack(const bvxi_stack *s, bvxi_shifted *to)
{
    *to = (bvxi_shifted){.body = {.ctx = s->ctx, .function = s->function}};
    memcpy(to->body.sections.normal, s->given->normal, sizeof s->given->normal);
    bvxi_stack_give_grid(s, &to->body.grid);

    for (uint32_t i = 0; i < s->plane_count; i++) {
        double const done = (double)i / s->plane_count;
        BVXI_TRY(add_shift_position(to, s->plane[i].w));
        BVXI_TRY(copy_plane(s, &s->plane[i], (uint32_t)to->body.sections.section_count - 1, &to->body));
        /* Towards a section without loops the body ends, whatever is beyond. */
        if (i + 1 < s->plane_count && s->plane[i].contour_count != 0 && s->plane[i + 1].contour_count != 0)
            BVXI_TRY(BVXI_SHARE(s->ctx, done, (i + 1.0) / s->plane_count, shift_pair(s, &s->plane[i], to)));
    }
    to->body.sections.positions = to->positions;
    return BVX_OK;
}
