/* section_field.c - signed distances where the surface requires them, and its crossings of the lines between
 * two planes.
 *
 * A line over a grid point (or a corner of a subdivided cell) is crossed where the point is inside on one
 * plane and outside on the other: at the share of both distances, kept a little off the planes. Over a part
 * that ends (part_ends.c) the other plane counts as so deep outside as the part's widest place is inside: the
 * body narrows to a ridge there.
 *
 * A cubic blend takes the distances on the planes beyond the slab too. Those need signs alone of
 * which no connectivity follows: it has one zero where the linear one has, and none where that has none. */
#include "layers/section_field.h"

/* ---- the blend of two sections ---- */

/* Source: Fritsch, Carlson. Monotone piecewise cubic interpolation. 1980; slopes by Fritsch, Butland. A method for
 * constructing local monotone piecewise cubic interpolants. 1984, for sections at uneven distances.
 * Guarantee: on a section it is the section's value, with equal slopes on both sides. Between two it rises or falls
 * all the way, so it is 0 once where their signs differ and nowhere where they agree, as the straight line is. */

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

#define FIELD_MARGIN (1.0 / 1024.0)

/* ---- distances ---- */

static double grid_distance(bvxi_field *f, bvxi_plane_field *p, int32_t i, int32_t j)
{
    size_t const n = (size_t)j * (size_t)(f->s->size[0] + 1) + (size_t)i;
    if (p->distance == NULL)
        return bvxi_plane_distance(p->plane, f->s->origin[0] + i * f->s->step[0],
                                   f->s->origin[1] + j * f->s->step[1], &p->hint);
    /* A bit for each grid point: an array of distances need not be cleared for a new plane. */
    if ((p->known[n >> 6] >> (n & 63) & 1) == 0) {
        p->known[n >> 6] |= UINT64_C(1) << (n & 63);
        p->distance[n] = bvxi_plane_distance(p->plane, f->s->origin[0] + i * f->s->step[0],
                                             f->s->origin[1] + j * f->s->step[1], &p->hint);
    }
    return p->distance[n];
}

/* Unsigned, on a plane with loops. */
static double corner_distance(bvxi_field *f, const int32_t at[2], int k)
{
    bvxi_plane_field *const p = &f->plane[k];
    int32_t const fine = f->s->fine, part = (1 << fine) - 1;
    if ((at[0] & part) == 0 && (at[1] & part) == 0) return grid_distance(f, p, at[0] >> fine, at[1] >> fine);
    return bvxi_plane_distance(p->plane, bvxi_fixed_u(f->s, 0, at[0]), bvxi_fixed_u(f->s, 1, at[1]),
                               &p->hint);
}

static int is_nothing(const bvxi_field *f, int k)
{
    return bvxi_plane_is_nothing(f->slab->plane[k]);
}

/* Depth of the part of plane k nearest to a place, if it ends before the other plane, and distance; or 0. */
static double ending_part(bvxi_field *f, int k, double u, double v, double *distance)
{
    const bvxi_plane *const p = f->slab->plane[k];
    uint32_t contour;
    if (!p->ends[1 - k]) return 0.0;
    *distance = bvxi_contour_distance(p, u, v, &f->plane[k].hint, &contour);
    return p->contour[contour].end[1 - k];
}

/* How deep outside on plane k the inside of a part is that ends, so that its deepest places end half way
 * between two sections: a plane without loops lies there already. */
static double ending_depth(const bvxi_field *f, int k, double off, double depth)
{
    return (is_nothing(f, k) ? depth : 2.0 * depth) - (off < depth ? off : depth);
}

/* The value on plane k at a place outside, which lies d from its contours, if it has some. */
static double outside_value(bvxi_field *f, int k, double u, double v, double d)
{
    double off, mine, depth = ending_part(f, 1 - k, u, v, &off);
    if (!(depth > 0.0)) return -d;
    if (bvxi_plane_inside(f->s, f->slab->plane[1 - k], u, v)) return -ending_depth(f, k, off, depth);
    /* a part that ends the other way is nearer */
    if (!is_nothing(f, k) && d < off && ending_part(f, k, u, v, &mine) > 0.0) return -d;
    return -off - (is_nothing(f, k) ? depth : 2.0 * depth);
}

double bvxi_field_corner(bvxi_field *f, const int32_t at[2], int k, int inside)
{
    double const d = is_nothing(f, k) ? 0.0 : corner_distance(f, at, k);
    return inside ? d : outside_value(f, k, bvxi_fixed_u(f->s, 0, at[0]), bvxi_fixed_u(f->s, 1, at[1]), d);
}

static double plane_at(bvxi_field *f, int k, double u, double v)
{
    if (is_nothing(f, k)) return outside_value(f, k, u, v, 0.0);
    double const d = bvxi_plane_distance(f->slab->plane[k], u, v, &f->plane[k].hint);
    return bvxi_plane_inside(f->s, f->slab->plane[k], u, v) ? d : outside_value(f, k, u, v, d);
}

/* On a plane beyond the slab; 0 where there is none. */
static double far_at(bvxi_field *f, int k, double u, double v)
{
    const bvxi_plane *const p = f->slab->far[k - BVXI_BLEND_FAR_BELOW];
    if (p == NULL) return 0.0;
    double const d = bvxi_plane_distance(p, u, v, &f->plane[k].hint);
    return bvxi_plane_encloses(p, u, v) ? d : -d;
}

double bvxi_field_at(bvxi_field *f, double u, double v, double t)
{
    if (f->cubic && t > 0.0 && t < 1.0) {
        double value[BVXI_BLEND_SECTIONS];
        for (int k = 0; k < 2; k++) value[k] = plane_at(f, k, u, v);
        for (int k = BVXI_BLEND_FAR_BELOW; k < BVXI_BLEND_SECTIONS; k++) value[k] = far_at(f, k, u, v);
        return bvxi_blend_value(&f->blend, value, t);
    }
    double const below = t < 1.0 ? plane_at(f, 0, u, v) : 0.0, above = t > 0.0 ? plane_at(f, 1, u, v) : 0.0;
    return (1.0 - t) * below + t * above;
}

/* ---- crossings of lines ---- */

/* Both distances on the line over a place in a part that ends before the
 * other plane, which it is inside on; 0 for other places. */
static int ending_line(bvxi_field *f, int from, double u, double v, double d[2])
{
    double off, depth = ending_part(f, from, u, v, &off);
    if (!(depth > 0.0)) return 0;
    d[from] = off;
    d[1 - from] = ending_depth(f, 1 - from, off, depth);
    return 1;
}

static bvx_status cross_over(bvxi_field *f, double u, double v, int from, const double d[BVXI_BLEND_SECTIONS],
                             uint32_t *vertex)
{
    const double *const w = f->slab->w;
    double value[BVXI_BLEND_SECTIONS], place[3];

    /* Where the blend is 0, as a share of the way. Beyond distances have signs. from: the plane inside. */
    memcpy(value, d, sizeof value);
    value[1 - from] = -value[1 - from];
    double t = f->cubic ? bvxi_blend_zero(&f->blend, value) : d[0] + d[1] > 0.0 ? d[0] / (d[0] + d[1]) : 0.5;
    if (!(t > FIELD_MARGIN)) t = FIELD_MARGIN;
    if (t > 1.0 - FIELD_MARGIN) t = 1.0 - FIELD_MARGIN;
    bvxi_section_place(f->s, u, v, w[0] + t * (w[1] - w[0]), place);
    return bvxi_section_add_vertex(f->s, place, vertex);
}

/* Distances on the lines over parts that end; those of other lines are left less than 0, to be measured. */
static void measure_ends(bvxi_field *f)
{
    bvxi_stack *const s = f->s;
    uint32_t n = 0;

    for (int32_t j = 0; j <= s->size[1]; j++)
        for (int32_t word = 0; word < s->words; word++)
            for (uint64_t bits = f->crossed[(size_t)j * (size_t)s->words + (size_t)word]; bits != 0;
                 bits &= bits - 1, n++) {
                int32_t const i = 64 * word + bvxi_lowest(bits);
                double d[2] = {-1.0, -1.0};
                for (int k = 0; k < 2; k++)
                    if (is_nothing(f, k)) d[k] = 0.0;
                (void)ending_line(f, !bvxi_grid_bit(s, f->slab->plane[0], i, j),
                                  s->origin[0] + i * s->step[0], s->origin[1] + j * s->step[1], d);
                f->line[0][n] = d[0];
                f->line[1][n] = d[1];
            }
}

/* Distances of all crossed lines on one plane. The search begins at what was nearest to the place just
 * before, or above, so it seldom goes far. ends: some are known. */
static void measure_lines(bvxi_field *f, int k, int ends)
{
    bvxi_stack *const s = f->s;
    bvxi_plane_field *const p = &f->plane[k];
    double *const d = f->line[k];
    uint32_t n = 0;

    for (int32_t i = 0; i <= s->size[0] + 2; i++) p->column[i].row = -1;
    for (int32_t j = 0; j <= s->size[1]; j++) {
        int32_t last = INT32_MIN / 2;
        for (int32_t word = 0; word < s->words; word++)
            for (uint64_t bits = f->crossed[(size_t)j * (size_t)s->words + (size_t)word]; bits != 0;
                 bits &= bits - 1, n++) {
                int32_t const i = 64 * word + bvxi_lowest(bits);
                if (ends && d[n] >= 0.0) continue;
                /* Beside the last place its hint is still near; after a gap the latest of three columns is better,
                 * which are numbered from 1. */
                if (i - last > 1) {
                    const bvxi_column_hint *best = &p->column[i + 1];
                    if (p->column[i].row > best->row) best = &p->column[i];
                    if (p->column[i + 2].row > best->row) best = &p->column[i + 2];
                    if (best->row >= 0) p->hint = best->segment;
                }
                d[n] = grid_distance(f, p, i, j);
                if (k >= BVXI_BLEND_FAR_BELOW && !bvxi_grid_bit(s, p->plane, i, j)) d[n] = -d[n];
                p->column[i + 1].segment = p->hint;
                p->column[i + 1].row = j;
                last = i;
            }
    }
}

static bvx_status cross_hanging_lines(bvxi_field *f)
{
    bvxi_slab *const slab = f->slab;

    for (uint32_t i = 0; i < slab->hanging_count; i++) {
        bvxi_hanging *const h = &slab->hanging[i];
        double const u = bvxi_fixed_u(f->s, 0, h->at[0]), v = bvxi_fixed_u(f->s, 1, h->at[1]);
        double d[BVXI_BLEND_SECTIONS] = {0.0, 0.0, 0.0, 0.0};
        if (h->inside[0] == h->inside[1]) continue;
        if (!ending_line(f, !h->inside[0], u, v, d))
            for (int k = 0; k < 2; k++)
                if (!is_nothing(f, k)) d[k] = corner_distance(f, h->at, k);
        for (int k = BVXI_BLEND_FAR_BELOW; k < BVXI_BLEND_SECTIONS && f->cubic; k++)
            d[k] = far_at(f, k, u, v);
        BVXI_TRY(cross_over(f, u, v, !h->inside[0], d, &h->vertex));
    }
    return BVX_OK;
}

static bvx_status cross_lines(bvxi_field *f)
{
    const bvxi_slab *const slab = f->slab;
    size_t const words = (size_t)(f->s->size[1] + 1) * (size_t)f->s->words;
    int const ends = slab->plane[0]->ends[1] || slab->plane[1]->ends[0];

    f->lines = 0;
    for (size_t i = 0; i < words; i++) {
        f->crossed[i] = slab->plane[0]->inside[i] ^ slab->plane[1]->inside[i];
        f->before[i] = f->lines;
        f->lines += bvxi_popcount(f->crossed[i]);
    }
    if (ends) measure_ends(f);
    for (int k = 0; k < 2; k++)
        if (!is_nothing(f, k)) measure_lines(f, k, ends);
    for (int k = BVXI_BLEND_FAR_BELOW; k < BVXI_BLEND_SECTIONS && f->cubic; k++)
        if (f->plane[k].plane != NULL) measure_lines(f, k, 0);

    bvxi_stack *const s = f->s;
    uint32_t n = 0;

    /* Numbers follow from the order of the lines, so a vertex is found by counting. */
    f->first = s->ring_vertices + (uint32_t)s->mesh.vertex_count;
    for (int32_t j = 0; j <= s->size[1]; j++)
        for (int32_t word = 0; word < s->words; word++)
            for (uint64_t bits = f->crossed[(size_t)j * (size_t)s->words + (size_t)word]; bits != 0;
                 bits &= bits - 1, n++) {
                int32_t const i = 64 * word + bvxi_lowest(bits);
                int const from = !bvxi_grid_bit(s, f->slab->plane[0], i, j);
                double d[BVXI_BLEND_SECTIONS] = {f->line[0][n], f->line[1][n], 0.0, 0.0};
                uint32_t vertex;
                for (int k = BVXI_BLEND_FAR_BELOW; k < BVXI_BLEND_SECTIONS && f->cubic; k++)
                    if (f->plane[k].plane != NULL) d[k] = f->line[k][n];
                BVXI_TRY(cross_over(f, s->origin[0] + i * s->step[0], s->origin[1] + j * s->step[1], from, d,
                                    &vertex));
            }
    return cross_hanging_lines(f);
}

/* ---- slabs ---- */

static uint64_t known_words(const bvxi_stack *s)
{
    return (((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1) + 63) / 64;
}

static void set_plane(bvxi_field *f, bvxi_plane_field *p, const bvxi_plane *plane)
{
    p->plane = plane;
    p->hint = 0;
    if (p->known != NULL) memset(p->known, 0, (size_t)known_words(f->s) * 8);
}

bvx_status bvxi_field_set(bvxi_field *f, bvxi_slab *slab)
{
    f->slab = slab;
    /* What was above is below now: its distances and hints stay valid, so both are swapped. */
    if (f->s->options.slabs.crossings != BVX_CROSSINGS_EXACT && f->plane[1].plane == slab->plane[0]) {
        bvxi_plane_field const up = f->plane[1];
        f->plane[1] = f->plane[0];
        f->plane[0] = up;
    } else {
        set_plane(f, &f->plane[0], slab->plane[0]);
    }
    set_plane(f, &f->plane[1], slab->plane[1]);
    /* Over parts that end between two sections the blend stays linear, as their ridges are. */
    f->cubic = (slab->far[0] != NULL || slab->far[1] != NULL) && !is_nothing(f, 0) && !is_nothing(f, 1) &&
               !slab->plane[0]->ends[1] && !slab->plane[1]->ends[0];
    if (f->cubic) {
        f->blend.height = slab->plane[1]->w - slab->plane[0]->w;
        f->blend.below = slab->far[0] == NULL ? 0.0 : slab->plane[0]->w - slab->far[0]->w;
        f->blend.above = slab->far[1] == NULL ? 0.0 : slab->far[1]->w - slab->plane[1]->w;
        for (int k = 0; k < 2; k++) set_plane(f, &f->plane[BVXI_BLEND_FAR_BELOW + k], slab->far[k]);
    }
    for (int k = 0; k < 2 && slab->hanging_count != 0; k++) {
        uint32_t *const start = k == 0 ? f->hanging_column : f->hanging_row;
        uint32_t n = 0;
        for (int32_t i = 0; i < f->s->size[k] + 2; i++) {
            while (n < slab->hanging_count &&
                   slab->hanging[k == 0 ? slab->by_u[n] : n].at[k] >> f->s->fine < i)
                n++;
            start[i] = n;
        }
    }
    return cross_lines(f);
}

bvx_status bvxi_field_open(bvxi_stack *s, bvxi_field *f, uint32_t lines)
{
    uint64_t const points = ((uint64_t)s->size[0] + 1) * ((uint64_t)s->size[1] + 1);
    uint64_t const words = bvxi_stack_words(s);

    memset(f, 0, sizeof *f);
    f->s = s;
    for (int k = 0; k < (s->cubic ? BVXI_BLEND_SECTIONS : 2); k++) {
        BVXI_TRY(BVXI_ARRAY(s->ctx, s->size[0] + 3, "the distances of a section", f->plane[k].column));
        BVXI_TRY(BVXI_ZEROS(s->ctx, lines, "the distances of a section", f->line[k]));
        /* Each line is measured once then; keeping distances would only cost memory. */
        if (s->options.slabs.crossings == BVX_CROSSINGS_EXACT) continue;
        BVXI_TRY(BVXI_ARRAY(s->ctx, points, "the distances of a section", f->plane[k].distance));
        BVXI_TRY(BVXI_ZEROS(s->ctx, known_words(s), "the distances of a section", f->plane[k].known));
    }
    BVXI_TRY(BVXI_ARRAY(s->ctx, (uint64_t)s->size[0] + 2, "the corners of cells", f->hanging_column));
    BVXI_TRY(BVXI_ARRAY(s->ctx, (uint64_t)s->size[1] + 2, "the corners of cells", f->hanging_row));
    BVXI_TRY(BVXI_ARRAY(s->ctx, words, "the crossed lines", f->before));
    return BVXI_ARRAY(s->ctx, words, "the crossed lines", f->crossed);
}
