/* read_csl.c - CSLC files: planes with their equation, points and loops.
 *
 *     CSLC
 *     PLANES LABELS
 *     NUMBER POINTS LOOPS A B C D      (A x + B y + C z + D = 0)
 *     x y z                            (POINTS times)
 *     COUNT LABEL i i i ...            (LOOPS times; COUNT may be 25h3: 25 points, a hole in loop 3)
 *
 * All space is equal. A loop's label is its body's. A hole's label is that of what fills it: the hole bounds
 * the body of the loop that it lies in, whatever its own label, and where that is another one and not 0 the
 * same loop bounds the body inside too. A plane's position is the mean of its points along its normal, near
 * that of its equation; planes without points have that of their equation. Planes that are parallel to the
 * first one share its normal; where one is not, each keeps its own. */
#include "io_contour/contour_text.h"
#include "io/formats.h"

#include <math.h>

enum { CSL_LEAST_POINT = 6, CSL_LEAST_INDEX = 2 };

#define CSL_PARALLEL  1e-4 /* rad */
#define CSL_PLANE_OFF 1e-3 /* of the largest coordinate: how far a plane's points may lie from its equation */

static int csl_space(char c)
{
    return bvxi_contour_blank(c) || c == '\n';
}

static void csl_skip(bvxi_contour_file *f)
{
    while (f->p < f->end && csl_space(*f->p)) f->p++;
}

static bvx_status csl_whole(bvxi_contour_file *f, const char *what, uint64_t most, uint64_t *value)
{
    uint64_t v = 0;

    csl_skip(f);
    const char *const start = f->p;
    /* Beyond 17 digits the value stays above every limit, and the sum cannot leave 64 bits. */
    for (; f->p < f->end && *f->p >= '0' && *f->p <= '9'; f->p++)
        if (v < UINT64_C(100000000000000000)) v = v * 10 + (uint64_t)(*f->p - '0');
    if (f->p == start || (f->p < f->end && !csl_space(*f->p) && *f->p != 'h')) {
        f->p = start;
        return bvxi_contour_fail(f, start, BVX_ERR_FORMAT, what);
    }
    /* Limits come from the bytes that are left, so a number alone cannot make the reader allocate. */
    if (v > most) return bvxi_contour_fail_number(f, start, "the number ", v, " is more than can be there");
    *value = v;
    return BVX_OK;
}

static bvx_status csl_real(bvxi_contour_file *f, const char *what, double *value)
{
    csl_skip(f);
    size_t const used = bvxi_parse_double(f->p, f->end, value);
    if (used == 0 || (f->p + used < f->end && !csl_space(f->p[used])))
        return bvxi_contour_fail(f, f->p, BVX_ERR_FORMAT, what);
    if (!(*value - *value == 0.0)) return bvxi_contour_fail(f, f->p, BVX_ERR_RANGE, "a number is not finite");
    f->p += used;
    return BVX_OK;
}

/* The unit normal of a plane, turned like a parallel first one's, and its distance from the origin. */
static bvx_status csl_plane_normal(bvxi_contour_file *f, const char *at, const double equation[4],
                                   double unit[3], double *position)
{
    double const length = sqrt((equation[0] * equation[0] + equation[1] * equation[1]) +
                               equation[2] * equation[2]);
    int const first = f->sections.section_count == 0;
    double dot = 0.0, sine = 0.0, n[3];
    if (!(length > 0.0) || !(length < 1e300))
        return bvxi_contour_fail(f, at, BVX_ERR_FORMAT, "the plane's normal has no length");
    for (int i = 0; i < 3; i++) unit[i] = equation[i] / length;
    memcpy(n, first ? unit : f->sections.normal, sizeof n);
    memcpy(f->sections.normal, n, sizeof n);
    *position = -equation[3] / length;
    /* Dot and cross product of two unit vectors: the sine is accurate near 0, where the dot is flat. */
    for (int i = 0; i < 3; i++) {
        int const j = (i + 1) % 3, k = (i + 2) % 3;
        double const cross = unit[j] * n[k] - unit[k] * n[j];
        dot += unit[i] * n[i];
        sine += cross * cross;
    }
    if (sqrt(sine) > CSL_PARALLEL) {
        f->oblique = 1;
        return BVX_OK;
    }
    /* The same plane seen from its other side: normal and position change their sign together. */
    if (dot >= 0.0) return BVX_OK;
    *position = -*position;
    for (int i = 0; i < 3; i++) unit[i] = -unit[i];
    return BVX_OK;
}

static double csl_height(const double n[3], const double p[3])
{
    return (p[0] * n[0] + p[1] * n[1]) + p[2] * n[2];
}

/* A plane's points, some of which must be near its equation. */
static bvx_status csl_points(bvxi_contour_file *f, const char *start, const double n[3], double *points,
                             uint64_t count, double equation)
{
    double largest = 0.0, low = HUGE_VAL, high = -HUGE_VAL;

    for (uint64_t i = 0; i < count; i++) {
        double *const p = points + 3 * i;
        for (int k = 0; k < 3; k++) BVXI_TRY(csl_real(f, "expected a point's coordinate", &p[k]));
        double const height = csl_height(n, p);
        low = height < low ? height : low;
        high = height > high ? height : high;
        for (int k = 0; k < 3; k++) largest = bvxi_absolute(p[k]) > largest ? bvxi_absolute(p[k]) : largest;
    }
    if (count == 0) return BVX_OK;

    /* Between the points is near enough: single points off their plane are
     * the body's matter, and their mean is what is written. */
    largest *= CSL_PLANE_OFF;
    int const lies = equation >= low - largest && equation <= high + largest;
    int const mirrored = -equation >= low - largest && -equation <= high + largest;
    f->upright += lies && !mirrored;
    f->flipped += mirrored && !lies;
    /* Some writers have A x + B y + C z = D: then all planes do. */
    if ((!lies && !mirrored) || (f->upright != 0 && f->flipped != 0))
        return bvxi_contour_fail(f, start, BVX_ERR_FORMAT,
                                 "the plane's points do not lie where its equation says; check its D, "
                                 "which is less than 0 for a plane on the normal's side of the origin");
    return BVX_OK;
}

/* around: of each loop of the plane so far, 0 or 1 and the number of the
 * loop that it is a hole in; loops: of the plane. */
static bvx_status csl_loop(bvxi_contour_file *f, const double *points, uint64_t count, uint32_t section,
                           uint64_t loops, uint32_t *around)
{
    uint64_t corners, label, index;
    const char *const start = f->p;

    *around = 0;
    BVXI_TRY(csl_whole(f, "expected a loop's number of points", (uint64_t)(f->end - f->p) / CSL_LEAST_INDEX,
                       &corners));
    if (f->p < f->end && *f->p == 'h') { /* a hole's mark, and the loop that it lies in */
        f->p++;
        BVXI_TRY(csl_whole(f, "expected the index of the loop around a hole", UINT32_MAX, &index));
        if (index >= loops)
            return bvxi_contour_fail_number(f, start, "a hole lies in loop ", index,
                                            ", which this plane does not have");
        *around = (uint32_t)index + 1;
    }
    BVXI_TRY(csl_whole(f, "expected a loop's label", INT32_MAX, &label));
    if (corners == 0) return bvxi_contour_fail(f, start, BVX_ERR_FORMAT, "a loop without points");
    BVXI_TRY(bvxi_contour_add_loop(f, section, (int32_t)label));
    for (uint64_t i = 0; i < corners; i++) {
        csl_skip(f);
        BVXI_TRY(csl_whole(f, "expected the index of a point", UINT32_MAX, &index));
        if (index >= count)
            return bvxi_contour_fail_number(f, f->p, "there is no point ", index, " on this plane");
        BVXI_TRY(bvxi_contour_add_point(f, points + 3 * index));
    }
    return BVX_OK;
}

/* Holes bound the body around them; what fills them gets the same points as
 * its own loop. first: the plane's first loop. */
static bvx_status csl_settle_holes(bvxi_contour_file *f, uint64_t first, uint64_t loops,
                                   const uint32_t *around)
{
    bvx_sections *const s = &f->sections;

    /* New loops are added after all of the plane, so the numbers in around stay valid. */
    for (uint64_t i = 0; i < loops; i++) {
        bvx_section_loop const hole = s->loops[first + i];
        if (around[i] == 0 || hole.label == 0 || hole.label == s->loops[first + around[i] - 1].label)
            continue;
        BVXI_TRY(bvxi_contour_add_loop(f, hole.section, hole.label));
        s->loops[s->loop_count - 1].first_point = hole.first_point;
        s->loops[s->loop_count - 1].point_count = hole.point_count;
    }

    /* By the labels as they stand: a hole in a hole bounds what fills that one. */
    for (uint64_t i = 0; i < loops; i++)
        if (around[i] != 0) s->loops[first + i].reserved = s->loops[first + around[i] - 1].label;
    for (uint64_t i = 0; i < loops; i++) {
        if (around[i] != 0) s->loops[first + i].label = s->loops[first + i].reserved;
        s->loops[first + i].reserved = 0;
    }
    return BVX_OK;
}

/* Loops stand in the order of their planes, and so do their points; a loop of what fills a hole has points of
 * a loop before it. */
static void csl_settle_planes(bvxi_contour_file *f)
{
    bvx_sections *const s = &f->sections;
    uint64_t loop = 0, point = 0;

    for (uint64_t i = 0; i < s->section_count; i++) {
        uint64_t const first = point;
        if (f->flipped != 0) s->positions[i] = -s->positions[i];
        for (; loop < s->loop_count && s->loops[loop].section == i; loop++) {
            uint64_t const end = s->loops[loop].first_point + s->loops[loop].point_count;
            point = end > point ? end : point;
        }

        /* The position becomes that of the points that loops have, from the first point on: so equal heights have
         * themselves as their mean. */
        const double *const n = f->oblique ? s->normals + 3 * i : s->normal;
        if (first == point) continue;
        double const base = csl_height(n, s->points + 3 * first);
        double sum = 0.0;
        for (uint64_t k = first; k < point; k++) sum += csl_height(n, s->points + 3 * k) - base;
        s->positions[i] = base + sum / (double)(point - first);
    }

    /* Parallel planes share one normal: the list says nothing more, and its absence says that they do. */
    if (f->oblique) return;
    bvxi_free(f->ctx, s->normals, f->normal_room * 24);
    s->normals = NULL;
    f->normal_room = 0;
}

bvx_status bvxi_read_csl(bvxi_contour_file *f)
{
    uint64_t planes, labels;

    f->p = bvxi_skip_mark(f->p, f->end);
    csl_skip(f);
    if (f->end - f->p < 4 || memcmp(f->p, "CSLC", 4) != 0)
        return bvxi_contour_fail(f, f->p, BVX_ERR_FORMAT, "the file does not begin with CSLC");
    f->p += 4;
    BVXI_TRY(csl_whole(f, "expected the number of planes", (uint64_t)(f->end - f->p), &planes));
    BVXI_TRY(csl_whole(f, "expected the number of labels", UINT32_MAX, &labels));
    for (uint64_t i = 0; i < planes; i++) {
        BVXI_TRY(bvxi_progress(f->ctx, "read", (double)(f->p - f->begin) / (double)(f->end - f->begin)));
        uint64_t number, points, loops;
        double equation[4], normal[3], position = 0.0, *at = NULL;

        csl_skip(f);
        const char *const start = f->p;
        BVXI_TRY(csl_whole(f, "expected a plane's number", UINT32_MAX, &number));
        BVXI_TRY(csl_whole(f, "expected a plane's number of points",
                           (uint64_t)(f->end - f->p) / CSL_LEAST_POINT, &points));
        BVXI_TRY(csl_whole(f, "expected a plane's number of loops", (uint64_t)(f->end - f->p), &loops));
        for (int j = 0; j < 4; j++) BVXI_TRY(csl_real(f, "expected the plane's equation", &equation[j]));

        BVXI_TRY(csl_plane_normal(f, start, equation, normal, &position));
        BVXI_TRY(bvxi_alloc(f->ctx, BVXI_SCRATCH, points * 24, "the points of a plane", &at));
        BVXI_TRY(csl_points(f, start, normal, at, points, position));
        BVXI_TRY(bvxi_contour_add_plane(f, position, normal));

        uint64_t const first = f->sections.loop_count;
        uint32_t *around;
        BVXI_TRY(bvxi_alloc(f->ctx, BVXI_SCRATCH, loops * 4, "the holes of a plane", &around));
        for (uint64_t j = 0; j < loops; j++)
            BVXI_TRY(csl_loop(f, at, points, (uint32_t)i, loops, &around[j]));
        BVXI_TRY(csl_settle_holes(f, first, loops, around));
        bvxi_drop(f->ctx, around);
        bvxi_drop(f->ctx, at);
    }

    /* More after the last plane means that a count was wrong, and with it everything that was read. */
    csl_skip(f);
    if (f->p < f->end)
        return bvxi_contour_fail(f, f->p, BVX_ERR_FORMAT, "there is more after the last plane");
    csl_settle_planes(f);
    return BVX_OK;
}
