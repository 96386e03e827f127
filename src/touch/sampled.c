/* sampled.c - voxels that hold a point of the triangle's subdivision.
 *
 * Source: Chen, Qiu, Fu, Ma. Fast voxelization based on triangulated irregular network model. 2010,
 * Algorithm 1. The paper cuts the longest edge l into ceil(l / w) parts, w a voxel's side, which leaves
 * edges as long as a voxel; here it is k = floor(l / w) + 1, so that the parts are shorter, as its text
 * asks. The points (a k + (b - a) i + (c - a) j) / k, i + j <= k, are rational: whole voxels and a rest in
 * parts of k 2^F. A step is shorter than a voxel, so walking takes no division; only triangles that stick
 * out of the tile are divided, once a row. So neither the order of the corners nor rounding shows. Lengths
 * are counted in voxels: stretched voxels are cubes here.
 * Bit budget: k <= 2^28 and k 2^F < 2^32, so coordinates times k stay below 2^60.
 * Guarantee: exact; 26-connected on connected meshes, not 6-separating. Cost: (k + 1)(k + 2) / 2 points a
 * triangle, less those outside the window, but at least k. */
#include "touch/touch_cells.h"

#include <math.h>

/* A triangle: its first corner, ways to the two others, and the tile's voxels. */
typedef struct sample_triangle {
    int64_t p[3], to_b[3], to_c[3];
    int64_t low[3], high[3];
    int64_t k, divisor; /* parts, k 2^F */
    uint32_t number;
} sample_triangle;

/* A point's coordinate, or a step: whole voxels, and a rest in [0, divisor) in parts of one. */
typedef struct sample_walk {
    int64_t voxel, rest;
} sample_walk;

static uint64_t square_of(const int64_t v[3])
{
    uint64_t sum = 0;
    for (int a = 0; a < 3; a++) sum += (uint64_t)(v[a] * v[a]); /* below 2^62 each */
    return sum;
}

/* A step is shorter than a voxel. */
static inline sample_walk step_of(int64_t way, int64_t divisor)
{
    sample_walk s;
    s.voxel = way < 0 ? -1 : 0;
    s.rest = way < 0 ? way + divisor : way;
    return s;
}

static inline void walk_on(sample_walk *w, const sample_walk *step, int64_t divisor)
{
    /* Rest and step are both below the divisor, so at most one voxel is carried. */
    int64_t const rest = w->rest + step->rest;
    int const over = rest >= divisor;
    w->voxel += step->voxel + over;
    w->rest = over ? rest - divisor : rest;
}

/* Points from w on along the way to the third corner. */
static inline void touch_points(bvxi_surface_tile *tile, const sample_triangle *s, const sample_walk start[3],
                                int64_t points)
{
    sample_walk x = start[0], y = start[1], z = start[2];
    sample_walk const dx = step_of(s->to_c[0], s->divisor), dy = step_of(s->to_c[1], s->divisor);
    sample_walk const dz = step_of(s->to_c[2], s->divisor);
    for (int64_t n = 0; n < points; n++) {
        bvxi_touch_voxel(tile->job, (int32_t)x.voxel, (int32_t)y.voxel, (int32_t)z.voxel, s->number);
        walk_on(&x, &dx, s->divisor);
        walk_on(&y, &dy, s->divisor);
        walk_on(&z, &dz, s->divisor);
    }
}

/* All points; the triangle lies in the tile. */
static void sample_inside(bvxi_surface_tile *tile, const sample_triangle *s, int32_t f)
{
    sample_walk start[3], step[3];

    for (int a = 0; a < 3; a++) {
        step[a] = step_of(s->to_b[a], s->divisor);
        start[a].voxel = s->p[a] >> f; /* not negative */
        start[a].rest = (s->p[a] - (start[a].voxel << f)) * s->k;
    }
    /* From the edge a b, which has k + 1 points, a row towards c; each row is one point shorter. */
    for (int64_t i = 0; i <= s->k; i++) {
        touch_points(tile, s, start, s->k - i + 1);
        for (int a = 0; a < 3; a++) walk_on(&start[a], &step[a], s->divisor);
    }
}

/* Narrow [*first, *last] to the points j whose voxels from + way j, in
 * parts of the divisor, lie in [low, high]. */
static void narrow_points(int64_t from, int64_t way, int64_t low, int64_t high, int64_t *first, int64_t *last)
{
    /* The inequality is divided by the way, whose sign says which end is which. */
    int64_t const below = low - from, above = high - from; /* in parts */

    if (way == 0) {
        if (below > 0 || above < 0) *last = *first - 1;
        return;
    }
    int64_t const least = way > 0 ? bvxi_ceil_div(below, way) : bvxi_ceil_div(-above, -way);
    int64_t const most = way > 0 ? bvxi_floor_div(above, way) : bvxi_floor_div(-below, -way);
    if (least > *first) *first = least;
    if (most < *last) *last = most;
}

/* The points in the tile. */
static void sample_cut(bvxi_surface_tile *tile, const sample_triangle *s)
{
    /* Row by row, the points of the row in the tile are a range that three divisions give. */
    for (int64_t i = 0; i <= s->k; i++) {
        int64_t from[3], first = 0, last = s->k - i;
        sample_walk w[3];
        for (int a = 0; a < 3; a++) {
            from[a] = s->p[a] * s->k + s->to_b[a] * i;
            narrow_points(from[a], s->to_c[a], s->low[a] * s->divisor, (s->high[a] + 1) * s->divisor - 1,
                          &first, &last);
        }
        if (first > last) continue;
        for (int a = 0; a < 3; a++) {
            int64_t const at = from[a] + s->to_c[a] * first;
            w[a].voxel = at / s->divisor; /* not negative */
            w[a].rest = at % s->divisor;
        }
        touch_points(tile, s, w, last - first + 1);
    }
}

static void sample_triangle_of(bvxi_surface_tile *tile, const bvxi_touch_batch *b, uint32_t n)
{
    bvxi_surface_job *const job = tile->job;
    bvxi_rows const *const rows = &tile->rows;
    int32_t const low[3] = {0, rows->j0, rows->k0}, high[3] = {job->size[0] - 1, rows->j1 - 1, rows->k1 - 1};
    int inside = 1, first_inside = 1;
    sample_triangle s;

    s.number = b->triangle[n];
    for (int a = 0; a < 3; a++) {
        /* The triangle's numbers relative to its first corner, and whether box and corner lie in the tile. */
        int64_t const voxel = bvxi_floor_shift(b->p[0][a][n], job->fraction_bits);
        s.low[a] = low[a];
        s.high[a] = high[a];
        s.p[a] = b->p[0][a][n];
        s.to_b[a] = (int64_t)b->p[1][a][n] - s.p[a];
        s.to_c[a] = (int64_t)b->p[2][a][n] - s.p[a];
        if (b->high[a][n] < low[a] || b->low[a][n] > high[a]) return;
        if (b->low[a][n] < low[a] || b->high[a][n] > high[a]) inside = 0;
        if (voxel < low[a] || voxel > high[a]) first_inside = 0;
    }

    /* Parts of the longest edge: the least k with k * 2^F above its length. */
    int64_t const across[3] = {s.to_c[0] - s.to_b[0], s.to_c[1] - s.to_b[1], s.to_c[2] - s.to_b[2]};
    uint64_t const ab = square_of(s.to_b), ac = square_of(s.to_c), bc = square_of(across);
    uint64_t const longest = (ab > ac ? (ab > bc ? ab : bc) : (ac > bc ? ac : bc)) >> 2 * job->fraction_bits;
    /* A root in doubles, put right by whole numbers: it may be off by one where the square is large. */
    uint64_t k = (uint64_t)sqrt((double)longest);
    while (k * k > longest) k--;
    while ((k + 1) * (k + 1) <= longest) k++;
    s.k = (int64_t)k + 1;
    s.divisor = s.k << job->fraction_bits;
    /* Most triangles lie inside, and need no division a row. */
    if (inside) sample_inside(tile, &s, job->fraction_bits);
    else sample_cut(tile, &s);
    if (first_inside) { /* a triangle counts once, in the tile of its first corner */
        job->samples[tile->number] += (uint64_t)((s.k + 1) * (s.k + 2) / 2);
        job->parts[tile->number] += (uint64_t)s.k;
        job->used[tile->number]++;
    }
}

void bvxi_touch_sampled(bvxi_surface_tile *tile, const uint32_t *id, uint64_t count)
{
    bvxi_touch_batch b;
    for (uint64_t done = 0; done < count; done += BVXI_TOUCH_BATCH) {
        uint32_t const n = (uint32_t)(count - done < BVXI_TOUCH_BATCH ? count - done : BVXI_TOUCH_BATCH);
        bvxi_batch_gather(tile->job, id, done, n, &b);
        /* Boxes of half-open voxels: the points of a corner on a border belong to the upper voxel. */
        bvxi_batch_boxes(&b, n, tile->job->fraction_bits, 0, 0);
        for (uint32_t i = 0; i < n; i++) sample_triangle_of(tile, &b, i);
    }
}
