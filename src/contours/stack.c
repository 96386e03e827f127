/* stack.c - the planes of one body: its loops gathered by section, points snapped, loops directed.
 *
 * Sections between the first and the last that hold no loop of the body stay as empty planes; those before
 * and behind are left out. A loop inside an even number of others encloses the body and runs
 * counter-clockwise, one inside an odd number is a hole and runs clockwise: the inside is on the left of
 * all. */
#include "contours/section.h"

#include "mesh/mesh.h"

enum { LEAST_CUBIC = 5 }; /* sections */

bvx_status bvxi_choose_label(bvx_context *ctx, const char *function, const bvx_sections *g, int32_t *label)
{
    if (*label != BVXI_LABEL_ONLY) {
        for (uint64_t i = 0; i < g->loop_count; i++)
            if (g->loops[i].label == *label) return BVX_OK;
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no loop has the label %d", function, (int64_t)*label);
    }
    /* Without a label all loops must be of one body: which of several is meant cannot be guessed. */
    *label = g->loops[0].label;
    for (uint64_t i = 1; i < g->loop_count; i++)
        if (g->loops[i].label != *label)
            return bvxi_fail_for(
                ctx, BVX_ERR_ARGUMENT, BVX_REASON_SEVERAL_BODIES,
                "%s: the sections hold several bodies (labels %d and %d); choose one by its label", function,
                (int64_t)*label, (int64_t)g->loops[i].label);
    return BVX_OK;
}

static uint64_t sortable(double v)
{
    /* All bits of negative ones are turned, else the sign alone: then integers sort as doubles do. */
    uint64_t k;
    v += 0.0;
    memcpy(&k, &v, 8);
    return (k >> 63) != 0 ? ~k : k | UINT64_C(0x8000000000000000);
}

/* Sections in the order of their positions, first to last with a loop. counts: points of each section. */
static bvx_status order_planes(bvxi_stack *s, const uint64_t *loops, uint32_t *order, uint64_t *key)
{
    const bvx_sections *const g = s->given;
    uint32_t first, end, n = (uint32_t)g->section_count;

    for (uint32_t i = 0; i < n; i++) {
        order[i] = i;
        key[i] = sortable(g->positions[i]);
    }
    BVXI_TRY(bvxi_radix_sort(s->ctx, key, order, n));
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
    BVXI_TRY(BVXI_ZEROS(s->ctx, end - first, "the planes of a body", s->plane));
    s->plane_count = end - first;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        s->plane[i].section = order[first + i];
        s->plane[i].w = g->positions[order[first + i]];
    }
    return BVX_OK;
}

static int same_place(const double *a, const double *b)
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

bvx_status bvxi_plane_take_loop(bvx_context *ctx, const char *function, const bvx_sections *given,
                                bvx_sections_report *report, bvxi_plane *p, uint64_t number)
{
    const bvx_section_loop *const l = &given->loops[number];
    bvxi_contour *const c = &p->contour[p->contour_count++];

    /* Of points at one place that follow each other one is enough: segments have a length. */
    memset(c, 0, sizeof *c);
    c->first = p->point_count;
    c->given = (uint32_t)number;
    for (uint64_t i = 0; i < l->point_count; i++) {
        uint64_t const at = l->first_point + i;
        uint64_t const before = i == 0 ? l->first_point + l->point_count - 1 : at - 1;
        if (l->point_count > 1 && same_place(given->points + 3 * at, given->points + 3 * before)) {
            report->repeated_points++;
            continue;
        }
        p->given[p->point_count++] = (uint32_t)at;
    }
    c->count = p->point_count - c->first;
    report->loops++;
    report->points += l->point_count;
    for (uint32_t j = 0; j < c->count; j++)
        p->next[c->first + j] = c->first + (j + 1 == c->count ? 0 : j + 1);
    if (c->count >= 3) return BVX_OK;
    /* A loop of equal points kept none of them, yet has one place: the message counts that. */
    return bvxi_fail_for(ctx, BVX_ERR_EMPTY, BVX_REASON_LOOP_FLAT,
                         "%s: loop %i of section %u has %u different point%s; a loop needs three", function,
                         number, (uint64_t)p->section, (uint64_t)(c->count == 0 ? 1 : c->count),
                         c->count <= 1 ? "" : "s");
}

/* The next of planes that are fields of items of so many bytes. */
static bvxi_plane *plane_after(bvxi_plane *plane, uint64_t stride)
{
    return (bvxi_plane *)(void *)((unsigned char *)plane + stride);
}

bvx_status bvxi_planes_open(bvx_context *ctx, bvxi_plane *all, bvxi_plane *plane, uint64_t stride,
                            uint32_t count, const uint64_t *points, const uint64_t *loops)
{
    static const char what[] = "the points of sections";
    bvxi_plane *p = plane;
    uint64_t point = 0, loop = 0;

    for (uint32_t i = 0; i < count; i++, p = plane_after(p, stride)) {
        all->point_room += points[p->section];
        all->contour_room += loops[p->section];
    }
    BVXI_TRY(BVXI_ARRAY(ctx, all->point_room, what, all->given));
    BVXI_TRY(BVXI_ARRAY(ctx, all->point_room, what, all->q));
    BVXI_TRY(BVXI_ARRAY(ctx, all->point_room, what, all->uv));
    BVXI_TRY(BVXI_ARRAY(ctx, all->point_room, what, all->next));
    BVXI_TRY(BVXI_ARRAY(ctx, all->contour_room, "the loops of sections", all->contour));
    p = plane;
    for (uint32_t i = 0; i < count; i++, p = plane_after(p, stride)) {
        p->given = all->given + point;
        p->q = all->q + point;
        p->uv = all->uv + point;
        p->next = all->next + point;
        p->contour = all->contour + loop;
        point += points[p->section];
        loop += loops[p->section];
    }
    return BVX_OK;
}

bvx_status bvxi_planes_open_trees(bvx_context *ctx, bvxi_plane *all, bvxi_plane *plane, uint64_t stride,
                                  uint32_t count)
{
    bvxi_plane *p = plane;
    uint64_t group = 0, box = 0, groups, boxes;

    for (uint32_t i = 0; i < count; i++, p = plane_after(p, stride)) {
        bvxi_plane_tree_size(p->point_count, &groups, &boxes);
        group += groups;
        box += boxes;
    }
    BVXI_TRY(BVXI_ARRAY(ctx, group, "the segments of contours", all->group));
    BVXI_TRY(BVXI_ARRAY(ctx, box, "the boxes of contours", all->box));
    p = plane;
    group = box = 0;
    for (uint32_t i = 0; i < count; i++, p = plane_after(p, stride)) {
        p->group = all->group + group;
        p->box = all->box + box;
        bvxi_plane_tree_size(p->point_count, &groups, &boxes);
        group += groups;
        box += boxes;
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

static bvx_status gather_planes(bvxi_stack *s)
{
    const bvx_sections *const g = s->given;
    uint64_t *loops, *points, *key;
    uint32_t *plane_of;

    BVXI_TRY(BVXI_ZEROS(s->ctx, g->section_count, "the sections' loops", loops));
    BVXI_TRY(BVXI_ZEROS(s->ctx, g->section_count, "the sections' points", points));
    BVXI_TRY(BVXI_ARRAY(s->ctx, g->section_count, "the sections' order", plane_of));
    BVXI_TRY(BVXI_ARRAY(s->ctx, g->section_count, "the sections' positions", key));
    for (uint64_t i = 0; i < g->loop_count; i++) {
        if (g->loops[i].label != s->options.label) continue;
        loops[g->loops[i].section]++;
        points[g->loops[i].section] += g->loops[i].point_count;
    }
    BVXI_TRY(order_planes(s, loops, plane_of, key));
    BVXI_TRY(bvxi_planes_open(s->ctx, &s->all, s->plane, sizeof *s->plane, s->plane_count, points, loops));
    BVXI_TRY(BVXI_ARRAY(s->ctx, s->all.point_room, "the points of sections", s->all.ring));
    /* From here the array of the order serves as a look-up. */
    for (uint32_t i = 0; i < s->plane_count; i++) {
        bvxi_plane *const p = &s->plane[i];
        p->ring = s->all.ring + (p->given - s->all.given);
        s->report.sections += loops[p->section] != 0;
        plane_of[p->section] = i;
    }
    for (uint64_t i = 0; i < g->loop_count; i++)
        if (g->loops[i].label == s->options.label)
            BVXI_TRY(bvxi_plane_take_loop(s->ctx, s->function, g, &s->report,
                                          &s->plane[plane_of[g->loops[i].section]], i));
    BVXI_TRY(BVXI_SCOPE(s->ctx, bvxi_planes_place(s)));
    return check_flatness(s);
}

bvx_status bvxi_stack_begin(bvx_context *ctx, const char *function, const bvx_sections *given,
                            const bvx_sections_options *options, bvxi_stack *s)
{
    const bvxi_plane *p;

    *s = (bvxi_stack){.ctx = ctx,
                      .function = function,
                      .given = given,
                      .options = *options,
                      .low = {1e300, 1e300},
                      .high = {-1e300, -1e300}};
    BVXI_TRY(bvxi_section_frame(ctx, function, given->normal, s->axis));
    BVXI_TRY(bvxi_choose_label(ctx, function, given, &s->options.label));
    BVXI_TRY(gather_planes(s));
    p = s->plane;
    uint32_t const n = s->plane_count;
    /* Of few sections most are a first or last one, whose slope is a guess. The paper's way and marching cubes
     * are straight. A stack that is begun again with sections put in between keeps what was chosen. */
    if (s->options.slabs.blend == BVX_BLEND_AUTO)
        s->options.slabs.blend = n >= LEAST_CUBIC && s->options.slabs.crossings == BVX_CROSSINGS_EXACT
                                     ? BVX_BLEND_CUBIC
                                     : BVX_BLEND_LINEAR;
    /* Half a spacing beyond the ends; of a plane alone, half the thickness. */
    s->reach[0] = 0.5 * (n > 1 ? p[1].w - p[0].w : s->options.thickness);
    s->reach[1] = 0.5 * (n > 1 ? p[n - 1].w - p[n - 2].w : s->options.thickness);
    return bvxi_stack_grid(s);
}

bvx_status bvxi_stack_finish(bvxi_stack *s)
{
    BVXI_TRY(
        BVXI_ZEROS(s->ctx, s->plane_count * bvxi_stack_words(s), "the grid points inside", s->all.inside));
    for (uint32_t i = 0; i < s->plane_count; i++)
        s->plane[i].inside = s->all.inside + i * bvxi_stack_words(s);
    BVXI_TRY(bvxi_planes_open_trees(s->ctx, &s->all, s->plane, sizeof *s->plane, s->plane_count));
    return bvxi_planes_ready(s);
}

bvx_status bvxi_stack_open(bvx_context *ctx, const char *function, const bvx_sections *given,
                           const bvx_sections_options *options, bvxi_stack *s)
{
    BVXI_TRY(bvxi_stack_begin(ctx, function, given, options, s));
    return bvxi_stack_finish(s);
}
