/* stack_check.c - contour stacks as given: arrays that contradict each
 * other are refused, and the frame of their planes. */
#include "contours/section.h"

#include <math.h>

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
