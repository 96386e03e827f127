/* oblique_planes.c - planes of any position with their contours, in cells of the lattice over all of them.
 *
 * Each plane has a frame of its own. What section.h says of fixed point holds on each: loops that cross or
 * touch, or enclose nothing, are refused, and run with the inside on their left. A section without loops is a
 * plane on which there is no body. */
#include "oblique/oblique.h"

enum { OBLIQUE_CELLS = 64, OBLIQUE_MOST_CELLS = 1024, OBLIQUE_FINE = 29 };

#define OBLIQUE_OFF 1e-3 /* of the longest side: how far a point may lie off its plane */

/* ---- which loops, and where ---- */

/* The lattice covers the contours' box and an eighth of its longest side around it. */
static bvx_status lay_lattice(bvxi_oblique *o, const double low[3], const double high[3])
{
    static const double shift[3] = {0.3137, 0.1429, 0.2253}; /* round coordinates on no lattice plane */
    double longest = 0.0, cells, largest = 0.0;

    for (int k = 0; k < 3; k++) {
        double const side = high[k] - low[k];
        longest = side > longest ? side : longest;
        largest = bvxi_absolute(low[k]) > largest ? bvxi_absolute(low[k]) : largest;
        largest = bvxi_absolute(high[k]) > largest ? bvxi_absolute(high[k]) : largest;
    }

    /* Written so that a NaN fails too. */
    if (!(longest > 0.0))
        return bvxi_fail_for(o->ctx, BVX_ERR_EMPTY, BVX_REASON_EMPTY, "%s: all points are one", o->function);

    /* Contours far from the origin have few digits left for their extent; beyond this, cells are noise. */
    if (!(longest > 1e-9 * largest) || !(longest < 1e300))
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the contours' extent %g is too small beside their coordinates", o->function,
                             longest);

    cells = o->options.cells != 0 ? (double)o->options.cells : OBLIQUE_CELLS;
    if (o->options.spacing > 0.0) cells = longest / o->options.spacing;
    if (!(cells >= 1.0 && cells <= OBLIQUE_MOST_CELLS))
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: a spacing of %g makes %g cells along an extent of %g; 1 to %d are possible",
                             o->function, o->options.spacing, cells, longest, (int64_t)OBLIQUE_MOST_CELLS);
    o->step = o->options.spacing > 0.0 ? o->options.spacing : longest / cells;
    o->longest = cells;

    /* The body may bulge beyond its contours by an eighth; three cells more keep the border outside. */
    int32_t const pad = (int32_t)(cells / 8.0) + 3;
    for (int k = 0; k < 3; k++) {
        /* Whole blocks, so that no block needs a look at where the lattice ends. */
        int32_t const least = (int32_t)((high[k] - low[k]) / o->step) + 2 + 2 * pad;
        o->blocks[k] = (least + BVXI_BLOCK_SIDE - 1) / BVXI_BLOCK_SIDE;
        o->side[k] = o->blocks[k] * BVXI_BLOCK_SIDE;
        o->origin[k] = low[k] - (pad + shift[k]) * o->step;
        o->low[k] = (low[k] - o->origin[k]) / o->step;
        o->high[k] = (high[k] - o->origin[k]) / o->step;
        o->near_low[k] = 0.0;
        o->near_high[k] = o->side[k];
    }

    o->report.cell[0] = o->report.cell[1] = o->step;
    o->report.grid[0] = o->side[0] - 1;
    o->report.grid[1] = o->side[1] - 1;
    return BVX_OK;
}

/* ---- planes ---- */

static bvx_status place_points(bvxi_oblique *o, bvxi_oblique_plane *f)
{
    bvxi_plane *const p = &f->plane;

    for (int k = 0; k < 2; k++) {
        f->low[k] = 1e300;
        f->high[k] = -1e300;
    }
    for (uint32_t i = 0; i < p->point_count; i++) {
        double at[3], off;

        bvxi_oblique_in_cells(o, o->given->points + 3 * (uint64_t)p->given[i], at);
        bvxi_oblique_uv(f, at, p->uv[i]);
        /* A point beside its plane counts as its foot on it, but keeps its coordinates as a vertex. */
        off = bvxi_absolute(bvxi_oblique_height(f, at));
        if (off > OBLIQUE_OFF * o->longest)
            return bvxi_fail_for(
                o->ctx, BVX_ERR_FORMAT, BVX_REASON_DAMAGED,
                "%s: point %i of section %u (position %g) lies %g off its plane; %g is allowed", o->function,
                (uint64_t)p->given[i], (uint64_t)p->section, p->w, off * o->step,
                OBLIQUE_OFF * o->longest * o->step);
        bvxi_widen(f->low, f->high, p->uv[i], 2);
    }
    return BVX_OK;
}

/* Fixed point over the plane's own contours, in one cell of it. */
static bvx_status ready_plane(bvxi_oblique *o, bvxi_oblique_plane *f)
{
    bvxi_stack *const s = &f->frame;
    double const wide = f->high[0] - f->low[0], tall = f->high[1] - f->low[1];
    double const side = wide > tall ? wide : tall;
    int32_t(*box)[4] = NULL;
    uint64_t const boxes = (uint64_t)f->plane.contour_count * sizeof *box;

    if (f->plane.contour_count == 0) return BVX_OK;

    /* A stack of one plane and one cell: all that is known of loops in fixed point holds as it stands. */
    s->ctx = o->ctx;
    s->function = o->function;
    s->given = o->given;
    s->fine = OBLIQUE_FINE;
    for (int k = 0; k < 2; k++) {
        /* A margin, so that no contour point lies on the cell's border. */
        s->origin[k] = f->low[k] - 1e-3 * side;
        s->step[k] = 1.01 * side;
        s->size[k] = 1;
    }
    if (!(side > 0.0))
        return bvxi_fail_for(o->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOP_FLAT,
                             "%s: loop %i of section %u encloses no area", o->function,
                             (uint64_t)f->plane.contour[0].given, (uint64_t)f->plane.section);

    /* What crosses or touches is refused before directions are given, which only simple loops have. */
    bvxi_plane_snap(s, &f->plane);
    BVXI_TRY(bvxi_plane_check_simple(s, &f->plane));
    BVXI_TRY(bvxi_alloc(o->ctx, BVXI_SCRATCH, boxes, "the boxes of loops", &box));
    BVXI_TRY(bvxi_plane_direct(s, &f->plane, box));

    for (uint32_t i = 0; i < f->plane.contour_count; i++)
        o->report.holes += (uint64_t)f->plane.contour[i].hole;
    BVXI_TRY(bvxi_plane_open_tree(o->ctx, &f->plane, f->plane.point_count));
    bvxi_plane_tree(&f->plane);
    return BVX_OK;
}

/* Two sections on one plane would have to agree everywhere. */
static bvx_status refuse_one_plane(bvxi_oblique *o)
{
    for (uint32_t i = 0; i < o->plane_count; i++)
        for (uint32_t j = 0; j < i; j++) {
            const double *const a = o->plane[i].normal, *const b = o->plane[j].normal;
            double most = 0.0;

            /* the longest way between them inside the lattice, from one of its corners */
            for (int corner = 0; corner < 8; corner++) {
                double const at[3] = {corner & 1 ? o->side[0] : 0.0, corner & 2 ? o->side[1] : 0.0,
                                      corner & 4 ? o->side[2] : 0.0};
                double const dot = (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
                double const one = bvxi_oblique_height(&o->plane[i], at);
                double const two = bvxi_oblique_height(&o->plane[j], at);
                double const apart = bvxi_absolute(dot < 0.0 ? one + two : one - two);
                most = apart > most ? apart : most;
            }
            if (most < 1e-3)
                return bvxi_fail_for(o->ctx, BVX_ERR_FORMAT, BVX_REASON_DAMAGED,
                                     "%s: sections %u and %u lie on one plane, position %g", o->function,
                                     (uint64_t)j, (uint64_t)i, o->given->positions[j]);
        }
    return BVX_OK;
}

bvx_status bvxi_oblique_lay_planes(bvxi_oblique *o)
{
    const bvx_sections *const g = o->given;
    uint64_t const n = g->section_count;
    double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};

    if (n > BVXI_OBLIQUE_PLANES)
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u planes that are not parallel; %u is the limit", o->function, n,
                             (uint64_t)BVXI_OBLIQUE_PLANES);

    for (uint64_t i = 0; i < g->loop_count; i++) {
        /* Other bodies neither widen the lattice nor make its cells coarser. */
        if (g->loops[i].label != o->options.label && !o->of_all) continue;
        for (uint64_t k = 0; k < g->loops[i].point_count; k++)
            bvxi_widen(low, high, g->points + 3 * (g->loops[i].first_point + k), 3);
    }
    BVXI_TRY(lay_lattice(o, low, high));
    BVXI_TRY(BVXI_ZEROS(o->ctx, n, "the planes of a body", o->plane));
    o->plane_count = (uint32_t)n;
    o->plane_words = (o->plane_count + 63) / 64;
    o->report.planes = n;

    o->agree = o->options.agree > 0.0 ? o->options.agree / o->step : 0.01 * o->longest;
    for (uint32_t i = 0; i < o->plane_count; i++) {
        bvxi_oblique_plane *const p = &o->plane[i];
        double axis[3][3], world;

        BVXI_TRY(bvxi_section_frame(o->ctx, o->function, g->normals + 3 * (uint64_t)i, axis));
        memcpy(p->axis, axis, sizeof p->axis);
        memcpy(p->normal, axis[2], sizeof p->normal);

        /* The plane in cells: its offset is counted from the lattice's origin. */
        world = (p->normal[0] * o->origin[0] + p->normal[1] * o->origin[1]) + p->normal[2] * o->origin[2];
        p->offset = (g->positions[i] - world) / o->step;

        p->knot = BVXI_NONE;
        p->plane.section = i;
        p->plane.w = g->positions[i];
    }
    return refuse_one_plane(o);
}

bvx_status bvxi_oblique_take_planes(bvxi_oblique *o)
{
    const bvx_sections *const g = o->given;
    uint64_t *points, *loops;

    BVXI_TRY(bvxi_choose_label(o->ctx, o->function, g, &o->options.label));
    BVXI_TRY(bvxi_oblique_lay_planes(o));
    BVXI_TRY(BVXI_ZEROS(o->ctx, g->section_count, "the points of planes", points));
    BVXI_TRY(BVXI_ZEROS(o->ctx, g->section_count, "the points of planes", loops));
    for (uint64_t i = 0; i < g->loop_count; i++)
        if (g->loops[i].label == o->options.label) {
            loops[g->loops[i].section]++;
            points[g->loops[i].section] += g->loops[i].point_count;
        }
    BVXI_TRY(
        bvxi_planes_open(o->ctx, &o->all, &o->plane->plane, sizeof *o->plane, o->plane_count, points, loops));
    for (uint64_t i = 0; i < g->loop_count; i++)
        if (g->loops[i].label == o->options.label)
            BVXI_TRY(bvxi_plane_take_loop(o->ctx, o->function, g, &o->report,
                                          &o->plane[g->loops[i].section].plane, i));

    /* In the order of the sections, so that of several wrong ones the first is named. */
    for (uint32_t i = 0; i < o->plane_count; i++) {
        BVXI_TRY(place_points(o, &o->plane[i]));
        BVXI_TRY(ready_plane(o, &o->plane[i]));
        o->point_count += o->plane[i].plane.point_count;
        o->report.sections += loops[i] != 0;
    }
    return BVX_OK;
}

double bvxi_oblique_exact(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    const bvxi_oblique_plane *const p = &o->plane[plane];
    uint32_t hint = 0;
    double uv[2], d;
    if (p->plane.contour_count == 0) return -0.25 * o->longest;
    bvxi_oblique_uv(p, at, uv);
    d = bvxi_plane_distance(&p->plane, uv[0], uv[1], &hint);
    return bvxi_oblique_encloses(o, plane, uv) ? d : -d;
}

int bvxi_oblique_encloses(const bvxi_oblique *o, uint32_t plane, const double uv[2])
{
    /* Of several bodies what any of them encloses: where two overlap by a hair they do not cancel out. */
    for (uint32_t i = 0; i < o->body_count; i++)
        if (bvxi_oblique_in_bounds(&o->body[i].plane[plane], uv, 0.0) &&
            bvxi_oblique_encloses(&o->body[i], plane, uv))
            return 1;
    return o->body_count == 0 && bvxi_plane_encloses(&o->plane[plane].plane, uv[0], uv[1]);
}
