/* stack_grid.c - the grid over a stack of sections: its cells, where it begins, how fine its fixed point
 * is. */
#include "contours/section.h"

#include <math.h>

enum { STACK_LEAST_AUTO = 16, STACK_MOST_AUTO = 512, STACK_MOST_CELLS = 8192 };

static double automatic_spacing(const bvxi_stack *s)
{
    double const longer = s->high[0] - s->low[0] > s->high[1] - s->low[1] ? s->high[0] - s->low[0]
                                                                          : s->high[1] - s->low[1];
    double sum = 0.0, count = 0.0, h;

    for (uint32_t k = 0; k < s->plane_count; k++) {
        const bvxi_plane *const p = &s->plane[k];
        for (uint32_t i = 0; i < p->point_count; i++) {
            double const x = p->uv[p->next[i]][0] - p->uv[i][0], y = p->uv[p->next[i]][1] - p->uv[i][1];
            sum += sqrt(x * x + y * y);
        }
        count += p->point_count;
    }
    h = 2.0 * sum / count;
    if (h > longer / STACK_LEAST_AUTO) h = longer / STACK_LEAST_AUTO;
    if (h < longer / STACK_MOST_AUTO) h = longer / STACK_MOST_AUTO;
    return h;
}

static void report_grid(bvxi_stack *s)
{
    for (int k = 0; k < 2; k++) {
        s->report.grid[k] = s->size[k];
        s->report.cell[k] = s->step[k];
    }
    s->words = s->size[0] / 64 + 1;
}

/* Round coordinates should not lie on the grid's lines: bounds are padded by uneven shares of a cell, other
 * ones along u and v, so that the diagonal is no line through grid points either. */
bvx_status bvxi_stack_grid(bvxi_stack *s)
{
    static const double before[2] = {0.381966, 0.290569}, both = 0.75;
    double spacing = s->options.spacing;
    int32_t most = 0;

    if (s->options.slabs.grid[0] == 0 && spacing == 0.0) spacing = automatic_spacing(s);
    for (int k = 0; k < 2; k++) {
        double const extent = s->high[k] - s->low[k];
        if (!(extent > 0.0))
            return bvxi_fail(s->ctx, BVX_ERR_EMPTY, "%s: all points of the body lie on one line",
                             s->function);
        if (s->options.slabs.grid[0] != 0) {
            s->size[k] = s->options.slabs.grid[k];
            /* The margins are three quarters of a cell together. */
            s->step[k] = extent / (s->size[k] - both);
        } else {
            double const cells = floor(extent / spacing + both) + 1.0;
            if (!(cells <= STACK_MOST_CELLS))
                return bvxi_fail_for(
                    s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                    "%s: a spacing of %g makes %g cells along an extent of %g; %d is the limit", s->function,
                    spacing, cells, extent, (int64_t)STACK_MOST_CELLS);
            s->size[k] = cells < 2.0 ? 2 : (int32_t)cells;
            s->step[k] = spacing;
        }
        s->origin[k] = s->low[k] - before[k] * s->step[k];
        /* Where coordinates are so large that a cell is lost in their rounding, no grid can be laid. */
        if (!(s->step[k] > 0.0) || s->origin[k] + s->step[k] * s->size[k] <= s->high[k] ||
            s->origin[k] >= s->low[k])
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: the contours' extent %g is too small for the size of their coordinates",
                                 s->function, extent);
        if (s->size[k] > most) most = s->size[k];
    }

    /* As fine as the extent allows, so that products of two differences fit 64 bits. */
    s->fine = BVXI_SECTION_EXTENT_BITS;
    while (((int64_t)most << s->fine) > (INT64_C(1) << BVXI_SECTION_EXTENT_BITS)) s->fine--;
    report_grid(s);
    return BVX_OK;
}

void bvxi_stack_give_grid(const bvxi_stack *s, bvxi_section_grid *grid)
{
    memcpy(grid->origin, s->origin, sizeof grid->origin);
    memcpy(grid->step, s->step, sizeof grid->step);
    memcpy(grid->size, s->size, sizeof grid->size);
    grid->fine = s->fine;
}

void bvxi_stack_take_grid(bvxi_stack *s, const bvxi_section_grid *grid)
{
    memcpy(s->origin, grid->origin, sizeof s->origin);
    memcpy(s->step, grid->step, sizeof s->step);
    memcpy(s->size, grid->size, sizeof s->size);
    s->fine = grid->fine;
    report_grid(s);
}
