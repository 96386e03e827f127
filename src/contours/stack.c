/* stack.c - the planes of one body: its loops gathered by section, points snapped, loops directed.
 *
 * Sections between the first and the last that hold no loop of the body stay as empty planes; those before
 * and behind are left out. A loop inside an even number of others encloses the body and runs
 * counter-clockwise, one inside an odd number is a hole and runs clockwise: the inside is on the left of
 * all. */
#include "contours/section.h"

#include "lattice/wide.h"
#include "mesh/mesh.h"

#include <math.h>

enum { LEAST_CUBIC = 5 }; /* sections */

/* ---- which loops ---- */

static bvx_status choose_label(bvxi_stack *s)
{
    const bvx_sections *const g = s->given;

    if (s->options.label != BVXI_LABEL_ONLY) {
        for (uint64_t i = 0; i < g->loop_count; i++)
            if (g->loops[i].label == s->options.label) return BVX_OK;
        return bvxi_fail(s->ctx, BVX_ERR_EMPTY, "%s: no loop has the label %d", s->function,
                         (int64_t)s->options.label);
    }
    s->options.label = g->loops[0].label;
    for (uint64_t i = 1; i < g->loop_count; i++)
        if (g->loops[i].label != s->options.label)
            return bvxi_fail_for(
                s->ctx, BVX_ERR_ARGUMENT, BVX_REASON_SEVERAL_BODIES,
                "%s: the sections hold several bodies (labels %d and %d); choose one by its label",
                s->function, (int64_t)s->options.label, (int64_t)g->loops[i].label);
    return BVX_OK;
}

/* Doubles as numbers that sort like them. */
static uint64_t sortable(double v)
{
    /* All bits of negative ones are turned, of others the
     * sign alone: then whole numbers sort as doubles do. */
    uint64_t k;
    v += 0.0;
    memcpy(&k, &v, 8);
    return (k >> 63) != 0 ? ~k : k | UINT64_C(0x8000000000000000);
}

/* Sections in the order of their positions, from the first to the last with
 * a loop. counts: points of each section. */
static bvx_status order_planes(bvxi_stack *s, const uint32_t *loops, uint32_t *order, uint64_t *key)
{
    const bvx_sections *const g = s->given;
    uint32_t first, end, n = (uint32_t)g->section_count;

    for (uint32_t i = 0; i < n; i++) {
        order[i] = i;
        key[i] = sortable(g->positions[i]);
    }
    BVXI_TRY(bvxi_radix_sort(s->ctx, key, order, n));
    /* Sections before the first loop and after the last one do not belong to the body. */
    for (first = 0; loops[order[first]] == 0; first++) {}
    for (end = n; loops[order[end - 1]] == 0; end--) {}

    for (uint32_t i = first + 1; i < end; i++)
        if (!(g->positions[order[i]] > g->positions[order[i - 1]]))
            return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "%s: sections %u and %u lie at one position, %g",
                             s->function, (uint64_t)order[i - 1], (uint64_t)order[i], g->positions[order[i]]);
    if (end - first < 2 && s->options.thickness == 0.0)
        return bvxi_fail(s->ctx, BVX_ERR_EMPTY,
                         "%s: the body has loops in only one section (index %u, at %g); it needs two, or a "
                         "thickness",
                         s->function, (uint64_t)order[first], g->positions[order[first]]);
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, (end - first) * sizeof *s->plane, "the planes of a body",
                             &s->plane));
    s->plane_count = end - first;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        s->plane[i].section = order[first + i];
        s->plane[i].w = g->positions[order[first + i]];
    }
    return BVX_OK;
}

/* Half a spacing beyond the ends; of a plane alone, half the thickness. */
static void find_reach(bvxi_stack *s)
{
    const bvxi_plane *const p = s->plane;
    uint32_t const n = s->plane_count;

    s->reach[0] = 0.5 * (n > 1 ? p[1].w - p[0].w : s->options.thickness);
    s->reach[1] = 0.5 * (n > 1 ? p[n - 1].w - p[n - 2].w : s->options.thickness);
}

/* ---- points of a plane ---- */

static int same_place(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

/* Take the points of a loop, but those equal to the one before. */
static bvx_status take_loop(bvxi_stack *s, bvxi_plane *p, uint32_t number)
{
    const bvx_section_loop *const l = &s->given->loops[number];
    bvxi_contour *const c = &p->contour[p->contour_count++];

    /* Of points at one place that follow each other one is enough: segments have a length. */
    c->first = p->point_count;
    c->given = number;
    c->end[0] = c->end[1] = 0.0;
    for (uint64_t i = 0; i < l->point_count; i++) {
        uint64_t const at = l->first_point + i;
        uint64_t const before = i == 0 ? l->first_point + l->point_count - 1 : at - 1;
        if (l->point_count > 1 && same_place(s->given->points + 3 * at, s->given->points + 3 * before)) {
            s->report.repeated_points++;
            continue;
        }
        p->given[p->point_count++] = (uint32_t)at;
    }
    c->count = p->point_count - c->first;
    s->report.loops++;
    s->report.points += l->point_count;
    if (c->count >= 3) return BVX_OK;
    if (c->count == 0) c->count = 1; /* all are equal to the one before */
    return bvxi_fail_for(s->ctx, BVX_ERR_EMPTY, BVX_REASON_LOOP_FLAT,
                         "%s: loop %i of section %u has %u different point%s; a loop needs three",
                         s->function, (uint64_t)number, (uint64_t)p->section, (uint64_t)c->count,
                         c->count == 1 ? "" : "s");
}

/* Arrays for the points and loops of all planes, of which each has a stretch. */
static bvx_status open_planes(bvxi_stack *s, const uint64_t *points, const uint32_t *loops)
{
    bvxi_plane *const all = &s->all;
    uint64_t point = 0, loop = 0;

    /* One array for all planes: a plane is a stretch of it, and no plane takes memory of its own. */
    for (uint32_t i = 0; i < s->plane_count; i++) {
        all->point_room += points[s->plane[i].section];
        all->contour_room += loops[s->plane[i].section];
    }
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, all->point_room * 4, "the points of sections", &all->given));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, all->point_room * 8, "the points of sections", &all->q));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, all->point_room * 16, "the points of sections", &all->uv));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, all->point_room * 4, "the points of sections", &all->next));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, all->point_room * 4, "the points of sections", &all->ring));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, all->contour_room * sizeof *all->contour,
                        "the loops of sections", &all->contour));
    for (uint32_t i = 0; i < s->plane_count; i++) {
        bvxi_plane *const p = &s->plane[i];
        p->given = all->given + point;
        p->q = all->q + point;
        p->uv = all->uv + point;
        p->next = all->next + point;
        p->ring = all->ring + point;
        p->contour = all->contour + loop;
        point += points[p->section];
        loop += loops[p->section];
    }
    return BVX_OK;
}

/* Contour points of all sections lie near their planes. */
static bvx_status check_flatness(bvxi_stack *s)
{
    double const u = s->high[0] - s->low[0], v = s->high[1] - s->low[1];
    double const most = 1e-3 * (u > v ? u : v);

    for (uint32_t k = 0; k < s->plane_count; k++) {
        const bvxi_plane *const p = &s->plane[k];
        /* A quarter of the way to a neighbour: so planes never change places. */
        double limit = most;
        if (k > 0 && 0.25 * (p->w - p[-1].w) < limit) limit = 0.25 * (p->w - p[-1].w);
        if (k + 1 < s->plane_count && 0.25 * (p[1].w - p->w) < limit) limit = 0.25 * (p[1].w - p->w);
        for (uint32_t i = 0; i < p->point_count; i++) {
            double const off = bvxi_along_axis(s->axis[2], s->given->points + 3 * (uint64_t)p->given[i]) -
                               p->w;
            if (off > limit || off < -limit)
                return bvxi_fail(
                    s->ctx, BVX_ERR_FORMAT,
                    "%s: point %i of section %u (position %g) lies %g off its plane; %g is allowed",
                    s->function, (uint64_t)p->given[i], (uint64_t)p->section, p->w, off, limit);
        }
    }
    return BVX_OK;
}

static bvx_status gather(bvxi_stack *s, uint32_t *loops, uint64_t *points, uint32_t *plane_of, uint64_t *key)
{
    const bvx_sections *const g = s->given;

    memset(loops, 0, (size_t)g->section_count * 4);
    memset(points, 0, (size_t)g->section_count * 8);

    for (uint64_t i = 0; i < g->loop_count; i++) {
        if (g->loops[i].label != s->options.label) continue;
        loops[g->loops[i].section]++;
        points[g->loops[i].section] += g->loops[i].point_count;
    }
    BVXI_TRY(order_planes(s, loops, plane_of, key));
    for (uint32_t i = 0; i < s->plane_count; i++) s->report.sections += loops[s->plane[i].section] != 0;
    BVXI_TRY(open_planes(s, points, loops));
    /* From here the array of the order serves as a look-up. */
    for (uint32_t i = 0; i < s->plane_count; i++) plane_of[s->plane[i].section] = i;
    for (uint64_t i = 0; i < g->loop_count; i++)
        if (g->loops[i].label == s->options.label)
            BVXI_TRY(take_loop(s, &s->plane[plane_of[g->loops[i].section]], (uint32_t)i));
    BVXI_TRY(BVXI_SCOPE(s->ctx, bvxi_planes_place(s)));
    return check_flatness(s);
}

static bvx_status gather_planes(bvxi_stack *s)
{
    uint64_t const n = s->given->section_count;
    uint32_t *loops = NULL, *plane_of = NULL;
    uint64_t *points = NULL, *key = NULL;
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 4, "the sections' loops", &loops));

    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 4, "the sections' order", &plane_of));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 8, "the sections' points", &points));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 8, "the sections' positions", &key));
    return gather(s, loops, points, plane_of, key);
}

/* ---- directions ---- */

static uint64_t inside_bytes(const bvxi_stack *s)
{
    return ((uint64_t)s->size[1] + 1) * (uint64_t)s->words * 8;
}

static void link_loops(bvxi_plane *p)
{
    for (uint32_t i = 0; i < p->contour_count; i++) {
        const bvxi_contour *const c = &p->contour[i];
        for (uint32_t j = 0; j < c->count; j++)
            p->next[c->first + j] = c->first + (j + 1 == c->count ? 0 : j + 1);
    }
}

/* Of few sections most are a first or last one, whose slope is a guess. The paper's way and marching cubes
 * are straight. A stack that is begun again with sections put in between keeps what was chosen. */
static void choose_blend(bvxi_stack *s)
{
    bvx_sections_options *const o = &s->options;
    int const many = s->plane_count >= LEAST_CUBIC;

    if (o->slabs.blend != BVX_BLEND_AUTO) return;
    o->slabs.blend = many && o->slabs.crossings == BVX_CROSSINGS_EXACT ? BVX_BLEND_CUBIC : BVX_BLEND_LINEAR;
}

bvx_status bvxi_stack_begin(bvx_context *ctx, const char *function, const bvx_sections *given,
                            const bvx_sections_options *options, bvxi_stack *s)
{
    memset(s, 0, sizeof *s);
    s->ctx = ctx;
    s->function = function;
    s->given = given;
    s->options = *options;
    s->low[0] = s->low[1] = 1e300;
    s->high[0] = s->high[1] = -1e300;
    BVXI_TRY(bvxi_section_frame(ctx, function, given->normal, s->axis));
    BVXI_TRY(choose_label(s));
    BVXI_TRY(gather_planes(s));
    choose_blend(s);
    find_reach(s);
    for (uint32_t i = 0; i < s->plane_count; i++) link_loops(&s->plane[i]);
    return bvxi_stack_grid(s);
}

bvx_status bvxi_stack_finish(bvxi_stack *s)
{
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, s->plane_count * inside_bytes(s), "the grid points inside",
                             &s->all.inside));
    for (uint32_t i = 0; i < s->plane_count; i++)
        s->plane[i].inside = s->all.inside + i * (inside_bytes(s) / 8);
    return bvxi_planes_ready(s);
}

bvx_status bvxi_stack_open(bvx_context *ctx, const char *function, const bvx_sections *given,
                           const bvx_sections_options *options, bvxi_stack *s)
{
    BVXI_TRY(bvxi_stack_begin(ctx, function, given, options, s));
    return bvxi_stack_finish(s);
}
