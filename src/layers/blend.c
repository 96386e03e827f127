/* blend.c - the monotone cubic between two sections.
 *
 * Source: Fritsch, Carlson. Monotone piecewise cubic interpolation. 1980; slopes by Fritsch, Butland. A
 * method for constructing local monotone piecewise cubic interpolants. 1984, for sections at uneven
 * distances: the weighted harmonic mean of the slopes on both sides where these have one sign, else 0; at the
 * last section the slope of the parabola through three, no steeper than three times the last step and never
 * against it.
 *
 * Guarantee: on a section it is the section's value. Between two it rises or falls all the way, so it is 0
 * once where their signs differ and nowhere where they agree, as the straight line is. So cells are traced
 * as by the linear blend. Slopes of both sides agree on a section: no kink. Where values lie on a line, as
 * over plane walls, it is that line. */
#include "layers/section_field.h"

enum { BLEND_STEPS = 40 };

#define BLEND_CLOSE 1e-12 /* of the way from section to section */

/* On a section between two others: step, width before and after it. */
static double slope_between(double before, double before_width, double after, double after_width)
{
    double const a = 2.0 * after_width + before_width, b = after_width + 2.0 * before_width;
    /* At an extremum the cubic must be level, or it would overshoot the section's value. NaN gives 0 too. */
    if (!(before * after > 0.0)) return 0.0;
    return (a + b) / (a / before + b / after);
}

/* On the last section: the step next to it, and the one beyond that. */
static double slope_at_end(double next, double next_width, double beyond, double beyond_width)
{
    double const slope = ((2.0 * next_width + beyond_width) * next - next_width * beyond) /
                         (next_width + beyond_width);
    if (!(slope * next > 0.0)) return 0.0;
    /* Three times the step is as steep as a cubic may begin without turning back within the interval. */
    if (next * beyond < 0.0 && slope * slope > 9.0 * next * next) return 3.0 * next;
    return slope;
}

/* Coefficients of t, t^2 and t^3. */
static void blend_cubic(const bvxi_blend *b, const double f[BVXI_BLEND_SECTIONS], double c[3])
{
    double const step = f[BVXI_BLEND_ABOVE] - f[BVXI_BLEND_BELOW], middle = step / b->height;
    double const low = b->below > 0.0 ? (f[BVXI_BLEND_BELOW] - f[BVXI_BLEND_FAR_BELOW]) / b->below : middle;
    double const high = b->above > 0.0 ? (f[BVXI_BLEND_FAR_ABOVE] - f[BVXI_BLEND_ABOVE]) / b->above : middle;
    double from = middle, to = middle;

    /* A side without a further section takes the one-sided slope; with none on either side all slopes are the
     * step, and the cubic is the straight line. */
    if (b->below > 0.0) from = slope_between(low, b->below, middle, b->height);
    else if (b->above > 0.0) from = slope_at_end(middle, b->height, high, b->above);
    if (b->above > 0.0) to = slope_between(middle, b->height, high, b->above);
    else if (b->below > 0.0) to = slope_at_end(middle, b->height, low, b->below);

    from *= b->height;
    to *= b->height;
    c[0] = from;
    c[1] = 3.0 * step - 2.0 * from - to;
    c[2] = from + to - 2.0 * step;
}

double bvxi_blend_value(const bvxi_blend *b, const double f[BVXI_BLEND_SECTIONS], double t)
{
    double c[3];
    /* Exactly the section's own value there, not what the polynomial rounds to. */
    if (t <= 0.0) return f[BVXI_BLEND_BELOW];
    if (t >= 1.0) return f[BVXI_BLEND_ABOVE];
    blend_cubic(b, f, c);
    return f[BVXI_BLEND_BELOW] + t * (c[0] + t * (c[1] + t * c[2]));
}

/* Newton's steps, within an interval that each of them narrows; one that would leave it is halved instead. */
double bvxi_blend_zero(const bvxi_blend *b, const double f[BVXI_BLEND_SECTIONS])
{
    double const first = f[BVXI_BLEND_BELOW], difference = first - f[BVXI_BLEND_ABOVE];
    double low = 0.0, high = 1.0, c[3], t = difference != 0.0 ? first / difference : 0.5;

    blend_cubic(b, f, c);
    for (int i = 0; i < BLEND_STEPS; i++) {
        double const value = first + t * (c[0] + t * (c[1] + t * c[2]));
        double const slope = c[0] + t * (2.0 * c[1] + t * 3.0 * c[2]);
        if (value == 0.0) return t;

        /* The zero stays between low and high, whatever Newton does: the cubic has one sign at each. */
        if ((value > 0.0) == (first > 0.0)) low = t;
        else high = t;
        double next = slope != 0.0 ? t - value / slope : low;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (next - t < BLEND_CLOSE && t - next < BLEND_CLOSE) return next;
        t = next;
    }
    return t;
}
