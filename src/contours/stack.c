/* stack.c - the planes of one body: its loops gathered by section, points snapped, loops directed.
 *
 * Sections between the first and the last that hold no loop of the body stay as empty planes; those before
 * and behind are left out. A loop inside an even number of others encloses the body and runs
 * counter-clockwise, one inside an odd number is a hole and runs clockwise: the inside is on the left of
 * all. */
#include "contours/section.h"

#include "mesh/mesh.h"

#include <math.h>

/* ---- what is refused; frames ---- */

static int is_number(double v)
{
    return v - v == 0.0;
}

static bvx_status check_loop(bvx_context *ctx, const char *function, const bvx_sections *given, uint64_t i)
{
    const bvx_section_loop *const l = &given->loops[i];

    if (l->section >= given->section_count)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX, "%s: loop %i is in section %u of %u",
                             function, i, (uint64_t)l->section, given->section_count);
    /* By subtraction: the sum might pass 2^64. */
    if (l->first_point > given->point_count || l->point_count > given->point_count - l->first_point)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX, "%s: loop %i has points %u to %u of %u",
                             function, i, l->first_point, l->first_point + l->point_count,
                             given->point_count);
    if (l->reserved != 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED, "%s: loop %i: reserved must be 0",
                             function, i);
    if (l->label == BVX_LABEL_ZERO)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: loop %i: the label stands for none", function, i);
    return BVX_OK;
}

bvx_status bvxi_sections_check_result(bvx_context *ctx, const char *function, const bvx_sections *result)
{
    if (result == NULL) return bvxi_fail_null(ctx, function, "sections");
    if (result->owned != 1 && (result->points != NULL || result->loops != NULL || result->positions != NULL))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: sections brings arrays, which are not used; zero it first", function);
    return BVX_OK;
}

bvx_status bvxi_sections_check(bvx_context *ctx, const char *function, const bvx_sections *given)
{
    if (given == NULL) return bvxi_fail_null(ctx, function, "sections");
    if (given->reserved != 0) return bvxi_fail_reserved(ctx, function, "sections.");
    for (uint64_t i = 0; i < 3; i++)
        if (given->reserved2[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED,
                                 "%s: sections.reserved2[%u] must be 0", function, i);
    if (given->point_count > INT32_MAX || given->loop_count > INT32_MAX || given->section_count > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u points, %u loops and %u sections; limits are 2^31", function,
                             given->point_count, given->loop_count, given->section_count);
    if ((given->points == NULL && given->point_count != 0) ||
        (given->loops == NULL && given->loop_count != 0) ||
        (given->positions == NULL && given->section_count != 0))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: an array of the sections is NULL although its count is not 0", function);
    if (given->loop_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the sections hold no loop", function);
    /* Values that are not finite would pass all comparisons later on. */
    for (uint64_t i = 0; i < given->section_count; i++)
        if (!is_number(given->positions[i]))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: the position of section %i is not finite", function, i);
    for (uint64_t i = 0; i < 3 * given->section_count && given->normals != NULL; i++)
        if (!is_number(given->normals[i]))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "%s: the normal of section %i is not finite", function, i / 3);
    for (uint64_t i = 0; i < given->loop_count; i++) BVXI_TRY(check_loop(ctx, function, given, i));
    for (uint64_t i = 0; i < 3 * given->point_count; i++)
        if (!is_number(given->points[i]))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE, "%s: point %i is not finite",
                                 function, i / 3);
    return BVX_OK;
}

bvx_status bvxi_section_frame(bvx_context *ctx, const char *function, const double normal[3],
                              double axis[3][3])
{
    double largest = 0.0, n[3], length, along;
    int main = 0, first;

    for (int i = 0; i < 3; i++) {
        double const m = normal[i] < 0.0 ? -normal[i] : normal[i];
        if (!is_number(m))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE, "%s: the normal is not finite",
                                 function);
        if (m > largest) {
            largest = m;
            main = i;
        }
    }
    if (largest == 0.0) return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the normal has no length", function);

    /* By its largest part first, so that squares of tiny or huge normals stay finite. */
    for (int i = 0; i < 3; i++) n[i] = normal[i] / largest;
    length = sqrt((n[0] * n[0] + n[1] * n[1]) + n[2] * n[2]);
    for (int i = 0; i < 3; i++) axis[2][i] = n[i] / length;

    /* u: the axis behind the normal's main one, made square to it; v completes the frame */
    first = (main + 1) % 3;
    along = axis[2][first];
    for (int i = 0; i < 3; i++) axis[0][i] = (i == first ? 1.0 : 0.0) - along * axis[2][i];
    length = sqrt((axis[0][0] * axis[0][0] + axis[0][1] * axis[0][1]) + axis[0][2] * axis[0][2]);
    for (int i = 0; i < 3; i++) axis[0][i] /= length;
    for (int i = 0; i < 3; i++) {
        int const j = (i + 1) % 3, k = (i + 2) % 3;
        axis[1][i] = axis[2][j] * axis[0][k] - axis[2][k] * axis[0][j];
    }
    return BVX_OK;
}

#define SECTIONS_PARALLEL 1e-4 /* rad */

int bvxi_section_parallel(const double a[3], const double b[3], int *against)
{
    /* Both made unit first, so that the sine does not depend on their lengths. */
    double const one = sqrt((a[0] * a[0] + a[1] * a[1]) + a[2] * a[2]);
    double const two = sqrt((b[0] * b[0] + b[1] * b[1]) + b[2] * b[2]);
    double square = 0.0, dot = 0.0;
    for (int i = 0; i < 3; i++) {
        int const j = (i + 1) % 3, k = (i + 2) % 3;
        double const cross = a[j] / one * (b[k] / two) - a[k] / one * (b[j] / two);
        square += cross * cross;
        dot += a[i] / one * (b[i] / two);
    }
    *against = dot < 0.0;
    return square <= SECTIONS_PARALLEL * SECTIONS_PARALLEL;
}

/* ---- the grid ---- */

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
static bvx_status lay_stack_grid(bvxi_stack *s)
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

/* ---- planes of a body ---- */

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

/* Sections in the order of their positions, first to last with a loop. counts: points of each section. */
static bvx_status order_planes(bvxi_stack *s, const uint64_t *loops, uint32_t *order, uint64_t *key)
{
    const bvx_sections *const g = s->given;
    uint32_t first, end, n = (uint32_t)g->section_count;

    for (uint32_t i = 0; i < n; i++) {
        order[i] = i;
        /* All bits of negative ones are turned, else the sign alone: then integers sort as doubles do. */
        double const v = g->positions[i] + 0.0;
        memcpy(&key[i], &v, 8);
        key[i] ^= (key[i] >> 63) != 0 ? UINT64_MAX : UINT64_C(0x8000000000000000);
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
        if (l->point_count > 1 && bvxi_vec_is_same(given->points + 3 * at, given->points + 3 * before)) {
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
    *s = (bvxi_stack){.ctx = ctx,
                      .function = function,
                      .given = given,
                      .options = *options,
                      .low = {1e300, 1e300},
                      .high = {-1e300, -1e300}};
    BVXI_TRY(bvxi_section_frame(ctx, function, given->normal, s->axis));
    BVXI_TRY(bvxi_choose_label(ctx, function, given, &s->options.label));
    BVXI_TRY(gather_planes(s));
    const bvxi_plane *p = s->plane;
    uint32_t const n = s->plane_count;
    /* Of few sections most are a first or last one, whose slope is a guess. The paper's way and marching cubes
     * are straight. */
    s->cubic = n >= LEAST_CUBIC && s->options.slabs.crossings == BVX_CROSSINGS_EXACT;
    /* Half a spacing beyond the ends; of a plane alone, half the thickness. */
    s->reach[0] = 0.5 * (n > 1 ? p[1].w - p[0].w : s->options.thickness);
    s->reach[1] = 0.5 * (n > 1 ? p[n - 1].w - p[n - 2].w : s->options.thickness);
    return lay_stack_grid(s);
}

bvx_status bvxi_stack_finish(bvxi_stack *s)
{
    BVXI_TRY(
        BVXI_ZEROS(s->ctx, s->plane_count * bvxi_stack_words(s), "the grid points inside", s->all.inside));
    for (uint32_t i = 0; i < s->plane_count; i++)
        s->plane[i].inside = s->all.inside + i * bvxi_stack_words(s);
    for (uint32_t i = 0; i < s->plane_count; i++)
        BVXI_TRY(bvxi_plane_open_tree(s->ctx, &s->plane[i], s->plane[i].point_count));
    return bvxi_planes_ready(s);
}

bvx_status bvxi_stack_open(bvx_context *ctx, const char *function, const bvx_sections *given,
                           const bvx_sections_options *options, bvxi_stack *s)
{
    BVXI_TRY(bvxi_stack_begin(ctx, function, given, options, s));
    return bvxi_stack_finish(s);
}
