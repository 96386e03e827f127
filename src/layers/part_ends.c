/* part_ends.c - parts of a section that end before the next one: they narrow to a ridge half a spacing
 * beyond.
 *
 * A part is a loop with the holes in it. All parts end towards a section without loops and, where ends taper,
 * beyond the first and the last section. Where ends taper, a part also ends towards a section that it has
 * nothing in common with: no point of the grid lies inside both, none of its contours' points inside the
 * section, none of the section's inside it. The blend of both sections' distances would end it there too, but
 * sooner the farther off that section's other parts are. */
#include "layers/slab.h"

#include <math.h>

typedef struct ends_work {
    bvxi_stack *s;
    bvxi_plane *plane; /* whose parts are looked at */
    const bvxi_plane *other;
    uint32_t *owner; /* of each loop: the outer loop of its part */
    uint8_t *met;    /* of outer loops */
    uint32_t left;   /* outer loops that are not met yet */
    uint32_t hint;   /* segment last found nearest, see bvxi_plane_distance */
} ends_work;

double bvxi_contour_distance(const bvxi_plane *p, double u, double v, uint32_t *hint, uint32_t *contour)
{
    uint32_t segment;
    *contour = 0;
    if (p->contour_count == 1) return bvxi_plane_distance(p, u, v, hint); /* which segment does not matter */
    double const d = bvxi_plane_nearest(p, u, v, &segment);
    *contour = bvxi_contour_of(p, segment);
    return d;
}

/* The part that a place inside the plane lies in: the one whose contour is nearest. */
static uint32_t part_of_place(ends_work *w, double u, double v, double *distance)
{
    uint32_t contour;
    *distance = bvxi_contour_distance(w->plane, u, v, &w->hint, &contour);
    return w->owner[contour];
}

static void meet_part(ends_work *w, uint32_t part)
{
    if (w->met[part]) return;
    w->met[part] = 1;
    w->left--;
}

static int is_met_by_points(ends_work *w, uint32_t part)
{
    const bvxi_plane *const p = w->plane, *const other = w->other;
    const bvxi_contour *const outer = &p->contour[part];
    double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300}, d;

    for (uint32_t i = outer->first; i < outer->first + outer->count; i++) bvxi_widen(low, high, p->uv[i], 2);
    for (uint32_t i = 0; i < other->point_count; i++) {
        const double *const at = other->uv[i];
        if (at[0] < low[0] || at[0] > high[0] || at[1] < low[1] || at[1] > high[1]) continue;
        if (bvxi_plane_inside(w->s, p, at[0], at[1]) && part_of_place(w, at[0], at[1], &d) == part) return 1;
    }
    for (uint32_t c = 0; c < p->contour_count; c++) {
        if (w->owner[c] != part) continue;
        for (uint32_t i = p->contour[c].first; i < p->contour[c].first + p->contour[c].count; i++)
            if (bvxi_plane_inside(w->s, other, p->uv[i][0], p->uv[i][1])) return 1;
    }
    return 0;
}

static void depth_by_grid(ends_work *w, double *depth)
{
    const bvxi_stack *const s = w->s;
    int32_t low[2], high[2];
    const bvxi_plane *const p = w->plane;
    low[0] = low[1] = INT32_MAX;
    high[0] = high[1] = 0;
    for (uint32_t c = 0; c < p->contour_count; c++) {
        if (w->met[w->owner[c]]) continue;
        for (uint32_t i = p->contour[c].first; i < p->contour[c].first + p->contour[c].count; i++)
            for (int k = 0; k < 2; k++) {
                int32_t const line = p->q[i][k] >> w->s->fine;
                if (line < low[k]) low[k] = line;
                if (line > high[k]) high[k] = line;
            }
    }

    for (int32_t j = low[1]; j <= high[1]; j++)
        for (int32_t i = low[0]; i <= high[0]; i++) {
            double d;
            if (!bvxi_grid_bit(s, w->plane, i, j)) continue;
            uint32_t part = part_of_place(w, s->origin[0] + i * s->step[0], s->origin[1] + j * s->step[1],
                                          &d);
            if (!w->met[part] && d > depth[part]) depth[part] = d;
        }
}

/* Parts that hold no grid point: by the area and border of their outer loops. */
static void depth_by_area(const ends_work *w, double *depth)
{
    const bvxi_plane *const p = w->plane;

    for (uint32_t c = 0; c < p->contour_count; c++) {
        const bvxi_contour *const l = &p->contour[c];
        const double *const first = p->uv[l->first];
        double twice_area = 0.0, border = 0.0;
        if (w->owner[c] != c || w->met[c] || depth[c] > 0.0) continue;
        for (uint32_t i = l->first; i < l->first + l->count; i++) {
            const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
            twice_area += (a[0] - first[0]) * (b[1] - first[1]) - (a[1] - first[1]) * (b[0] - first[0]);
            border += sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        }
        depth[c] = twice_area / border; /* 2 * area / border: the radius where the part is a disc. */
    }
}

void bvxi_plane_parts(const bvxi_plane *p, uint32_t *part)
{
    bvxi_plane_owners(p, part);
    for (uint32_t c = 0; c < p->contour_count; c++)
        if (!p->contour[c].hole || part[c] == BVXI_NONE) part[c] = c;
}

/* Sets end[side] of every contour whose part meets nothing of other: the section on that side, or NULL. */
static void mark_part_ends(ends_work *w, int side, const bvxi_plane *other, double *depth)
{
    bvxi_plane *const p = w->plane;

    bvxi_plane_parts(p, w->owner);
    w->other = other;
    w->left = w->hint = 0;
    for (uint32_t c = 0; c < p->contour_count; c++) {
        w->met[c] = 0;
        depth[c] = 0.0;
        w->left += w->owner[c] == c;
    }
    /* The grid meets most parts; only the others are looked at point by point. */
    if (other != NULL) {
        const bvxi_stack *const s = w->s;

        for (int32_t j = 0; j <= s->size[1] && w->left != 0; j++) {
            int was_inside = 0;
            for (int32_t i = 0; i <= s->size[0] + 1; i++) {
                int const inside = i <= s->size[0] && bvxi_grid_bit(s, w->plane, i, j) &&
                                   bvxi_grid_bit(s, w->other, i, j);
                double d;
                if (inside != was_inside)
                    meet_part(w, part_of_place(w, s->origin[0] + (inside ? i : i - 1) * s->step[0],
                                               s->origin[1] + j * s->step[1], &d));
                was_inside = inside;
            }
        }

        for (uint32_t c = 0; c < p->contour_count && w->left != 0; c++)
            if (w->owner[c] == c && !w->met[c] && is_met_by_points(w, c)) meet_part(w, c);
    }
    if (w->left == 0) return;
    depth_by_grid(w, depth);
    depth_by_area(w, depth);
    for (uint32_t c = 0; c < p->contour_count; c++)
        if (!w->met[w->owner[c]]) p->contour[c].end[side] = depth[w->owner[c]];
    p->ends[side] = 1;
}

bvx_status bvxi_stack_ends(bvxi_stack *s)
{
    int const taper = s->options.caps == BVX_CAPS_TAPER;
    ends_work w = {.s = s};
    uint64_t most = 0;
    double *depth;

    for (uint32_t i = 0; i < s->plane_count; i++)
        if (s->plane[i].contour_count > most) most = s->plane[i].contour_count;
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the parts of sections", w.owner));
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the parts of sections", w.met));
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the parts of sections", depth));
    for (uint32_t i = 0; i < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "ends", (double)i / s->plane_count));
        w.plane = &s->plane[i];
        for (int side = 0; side < 2 && w.plane->contour_count != 0; side++) {
            const bvxi_plane *const other = i == (side ? s->plane_count - 1 : 0)
                                                ? NULL
                                                : &s->plane[side ? i + 1 : i - 1];
            if (other != NULL && other->contour_count == 0) mark_part_ends(&w, side, NULL, depth);
            else if (taper) mark_part_ends(&w, side, other, depth);
        }
    }
    return BVX_OK;
}
