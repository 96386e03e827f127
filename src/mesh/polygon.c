/* polygon.c - a polygon in space cut into triangles.
 *
 * Source: Newell's sums for the normal (Sutherland, Sproull, Schumacker. A characterization of ten
 * hidden-surface algorithms. 1974).
 *
 * A polygon whose corners certainly all turn the same way, once round, is a fan. Any other is laid into the
 * plane of two axes, along the axis of its greatest normal component, which changes no coordinate; from then
 * on all turns are decided exactly. Corners at their predecessor's place become triangles without area and
 * are left out; what remains is a fan where it is convex, else it is swept (polygon_sweep.c), and what the
 * sweep finds not to be simple is cut ear by ear (polygon_ears.c). The plane is turned round where that makes
 * the polygon counter-clockwise, so all have one sense.
 *
 * Coordinates are first multiplied by the power of two that brings the greatest to 2^499..2^500. What is then
 * below 2^-448 (less than 2^-947 of the greatest) is rounded to a multiple of 2^-499; all else is exact. So
 * the cut does not change when the polygon is multiplied by a power of two. A polygon that is not quite flat
 * is cut by its projection: when that is simple, no two triangles overlap in it. */
#include "mesh/polygon.h"

enum { POLYGON_MOST = 1 << 30, POLYGON_EXPONENT = 499 };

static void polygon_make_fan(uint32_t *triangles, uint64_t count)
{
    for (uint32_t i = 2; i < count; i++, triangles += 3) {
        triangles[0] = 0;
        triangles[1] = i - 1;
        triangles[2] = i;
    }
}

/* ---- normal and axes ---- */

/* Newell's sums about the first corner, of coordinates times both factors. */
static void polygon_normal(const double (*corner)[3], uint64_t count, const double factors[2],
                           double normal[3])
{
    double first[3], d[3] = {0}, e[3];

    for (size_t a = 0; a < 3; a++) {
        normal[a] = 0.0;
        first[a] = corner[0][a] * factors[0] * factors[1];
    }
    /* Edge by edge about the first corner, so that a polygon far from the origin loses nothing. */
    for (uint64_t i = 1; i < count; i++) {
        for (size_t a = 0; a < 3; a++) e[a] = corner[i][a] * factors[0] * factors[1] - first[a];
        normal[0] += d[1] * e[2] - d[2] * e[1];
        normal[1] += d[2] * e[0] - d[0] * e[2];
        normal[2] += d[0] * e[1] - d[1] * e[0];
        memcpy(d, e, sizeof d);
    }
}

static double polygon_size_of(double v)
{
    return v < 0.0 ? -v : v;
}

/* Axes by their components, the greatest first; z before y before x where they are equal. */
static void polygon_rank_axes(const double normal[3], size_t axes[3])
{
    double size[3];
    size_t next = 0;

    for (size_t a = 0; a < 3; a++) size[a] = polygon_size_of(normal[a]);

    /* The axis of the greatest component loses least of the area when it is left out. */
    axes[0] = size[1] > size[2] ? 1 : 2;
    if (size[0] > size[axes[0]]) axes[0] = 0;
    for (size_t a = 3; a-- > 0;)
        if (a != axes[0]) axes[++next] = a;
    if (size[axes[2]] > size[axes[1]]) {
        next = axes[1];
        axes[1] = axes[2];
        axes[2] = next;
    }
}

/* ---- convex polygons, the usual ones ---- */

/* 1 when every turn certainly has the sense of the normal, and the way round goes up once and down once. */
static int polygon_is_certainly_convex(const double (*corner)[3], uint64_t count)
{
    static const double as_they_are[2] = {1.0, 1.0};
    double normal[3];
    size_t axes[3];
    uint64_t turns = 0;

    /* Unscaled: coordinates of any usual size pass the test below. */
    polygon_normal(corner, count, as_they_are, normal);
    polygon_rank_axes(normal, axes);
    double const size = polygon_size_of(normal[axes[0]]);
    if (!(size > 0x1p-900 && size < 0x1p900)) return 0; /* sums that may have lost much, or are no numbers */
    size_t const x = (axes[0] + 1) % 3, y = (axes[0] + 2) % 3;
    double const *a = corner[count - 2], *b = corner[count - 1];

    /* A left turn everywhere is not enough: a star turns left too, but goes up and down more than once. */
    for (uint64_t i = 0; i < count; i++) {
        const double *const c = corner[i];
        double const side = bvxi_side_quick(a[x], a[y], b[x], b[y], c[x], c[y]);
        if (side == 0.0 || (side > 0.0) != (normal[axes[0]] > 0.0)) return 0;
        int const came_up = a[x] != b[x] ? a[x] < b[x] : a[y] < b[y];
        int const goes_up = b[x] != c[x] ? b[x] < c[x] : b[y] < c[y];
        turns += came_up != goes_up;
        a = b;
        b = c;
    }
    return turns == 2;
}

/* The same of a counter-clockwise ring, exactly; straight corners are allowed. */
static int polygon_ring_is_convex(const bvxi_ring *ring)
{
    const double(*const xy)[2] = (const double(*)[2])ring->xy;
    /* Where the order of places changes, the way round turns from up to down: twice in a convex ring. */
    uint32_t a = ring->count - 2, b = ring->count - 1, turns = 0;
    for (uint32_t c = 0; c < ring->count; a = b, b = c, c++) {
        if (bvxi_ring_side(ring, a, b, c) < 0) return 0;
        turns += bvxi_place_order(xy[a], xy[b]) != bvxi_place_order(xy[b], xy[c]);
    }
    return turns == 2;
}

/* ---- into the plane ---- */

static double polygon_power_of_two(int32_t exponent)
{
    uint64_t const bits = (uint64_t)(exponent + 1023) << 52;
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* Two factors whose product brings the greatest coordinate to 2^499..2^500, and two that bring it to 1..2. */
static void polygon_scale(const double (*corner)[3], uint64_t count, double factors[2],
                          double small_factors[2])
{
    double greatest = 0.0;
    uint64_t bits;
    int32_t exponent;

    /* The exponent of the greatest coordinate, read from its bits. */
    for (uint64_t i = 0; i < count; i++)
        for (size_t a = 0; a < 3; a++)
            if (polygon_size_of(corner[i][a]) > greatest) greatest = polygon_size_of(corner[i][a]);
    memcpy(&bits, &greatest, sizeof bits);
    exponent = 1023 - (int32_t)(bits >> 52); /* -1023..1023 */
    /* In two factors, since one alone might leave the range of doubles. */
    small_factors[0] = polygon_power_of_two(exponent / 2);
    small_factors[1] = polygon_power_of_two(exponent - exponent / 2);
    exponent += POLYGON_EXPONENT;
    factors[0] = polygon_power_of_two(exponent / 2);
    factors[1] = polygon_power_of_two(exponent - exponent / 2);
}

static double polygon_place(double v, const double factors[2])
{
    double const scaled = v * factors[0] * factors[1];
    double const round = 0x1.8p-447; /* its last bit is 2^-499 */

    /* Far above the last digit nothing is rounded; below, adding
     * and subtracting the constant rounds to its last bit. */
    if (polygon_size_of(scaled) >= 0x1p-448) return scaled;
    return (scaled + round) - round;
}

/* Corners as places along an axis. Those at their predecessor's place become triangles without area, and the
 * ring's triangles start behind these. 0 when there are no three places in a row. */
static int polygon_lay_flat(bvxi_ring *ring, const double (*corner)[3], uint32_t count,
                            const double factors[2], size_t axis)
{
    size_t const x = (axis + 1) % 3, y = (axis + 2) % 3;
    uint32_t n = 0;

    ring->made = 0;
    for (uint32_t i = 0; i < count; i++) {
        /* Each corner goes to the next free place, and stays only when it is not its predecessor's again. */
        double const at[2] = {polygon_place(corner[i][x], factors), polygon_place(corner[i][y], factors)};
        memcpy(ring->xy[n], at, sizeof at);
        ring->corner[n] = i;
        if (n == 0 || bvxi_place_order(ring->xy[n - 1], at) != 0) {
            n++;
            continue;
        }

        /* At least three places must remain for the ring. */
        if (ring->made == count - 3) return 0;
        uint32_t *const t = ring->triangles + (size_t)ring->made++ * 3;
        t[0] = ring->corner[n - 1];
        t[1] = i;
        t[2] = i + 1 == count ? 0 : i + 1;
    }

    /* The ring is closed, so the last corners may repeat the first. */
    for (; n > 3 && bvxi_place_order(ring->xy[0], ring->xy[n - 1]) == 0; n--) /* the first follows the last */
        bvxi_ring_triangle(ring, n - 2, n - 1, 0);
    ring->triangles += (size_t)ring->made * 3;
    ring->made = 0;
    ring->count = n;
    return 1;
}

/* The turn at the lowest corner, which is the sense of a simple ring. */
static int32_t polygon_sense(const bvxi_ring *ring)
{
    /* The lowest corner is on the hull, so its turn cannot be a reflex one in a simple ring. */
    uint32_t lowest = 0;
    for (uint32_t i = 1; i < ring->count; i++)
        if (bvxi_place_order(ring->xy[i], ring->xy[lowest]) < 0) lowest = i;
    return bvxi_ring_side(ring, bvxi_ring_previous(ring, lowest), lowest, bvxi_ring_next(ring, lowest));
}

static void polygon_turn_round(bvxi_ring *ring)
{
    for (uint32_t i = 0; i < ring->count; i++) ring->xy[i][1] = -ring->xy[i][1];
}

static int polygon_is_line(const bvxi_ring *ring)
{
    for (uint32_t i = 0; i + 2 < ring->count; i++)
        if (bvxi_ring_side(ring, i, i + 1, i + 2) != 0) return 0;
    return 1;
}

/* ---- the ways to cut ---- */

/* Scratch: places and numbers of count corners, then more bytes. */
static bvx_status polygon_room(bvxi_polygon *work, bvxi_ring *ring, uint64_t count, uint64_t more,
                               void **behind)
{
    uint64_t const size = count * 20 + more;

    /* The block grows and is kept for the next polygon; what
     * it held before is still needed, so it is resized. */
    if (work->block == NULL) {
        BVXI_TRY(bvxi_alloc(work->ctx, BVXI_SCRATCH, size, "the corners of a polygon", &work->block));
        work->block_size = size;
    } else if (work->block_size < size) {
        BVXI_TRY(bvxi_resize(work->ctx, BVXI_SCRATCH, &work->block, work->block_size, size,
                             "the corners of a polygon"));
        work->block_size = size;
    }

    /* Places before indices, as doubles need the wider alignment. */
    ring->xy = work->block;
    ring->corner = (uint32_t *)(void *)(ring->xy + (size_t)count);
    *behind = ring->corner + (size_t)count;
    return BVX_OK;
}

/* Cut a ring that is no line. sense: its turn at the lowest corner; area:
 * the sense of its area, where that is known. */
static bvx_status polygon_cut_ring(bvxi_polygon *work, bvxi_ring *ring, uint64_t count, int32_t sense,
                                   int32_t area)
{
    uint32_t const n = ring->count;
    void *scratch;
    int touches = 1, good = 0;

    /* A sense of 0 is a spike at the lowest corner: no simple ring, so no sweep. */
    if (sense != 0) {
        BVXI_TRY(polygon_room(work, ring, count, (uint64_t)n * 8, &scratch));
        BVXI_TRY(bvxi_polygon_order(ring, scratch, (uint32_t *)scratch + n, &touches));
    }
    if (!touches) {
        BVXI_TRY(polygon_room(work, ring, count, (uint64_t)n * 4 + bvxi_polygon_sweep_size(n), &scratch));
        BVXI_TRY(bvxi_polygon_sweep(ring, scratch, (uint32_t *)scratch + n, &good));
        if (good) return BVX_OK;
    }

    /* The ears need the sense of the area; the ring was turned by that of its lowest corner. */
    if (area != 0 && (area < 0) != (sense < 0)) polygon_turn_round(ring);
    ring->made = 0;
    BVXI_TRY(polygon_room(work, ring, count, bvxi_polygon_ears_size(n), &scratch));
    return bvxi_polygon_ears(ring, scratch);
}

/* The long way. An axis along which all corners lie on one line is passed over for the next. */
static bvx_status polygon_cut_flat(bvxi_polygon *work, const double (*corner)[3], uint64_t count,
                                   uint32_t *triangles)
{
    double factors[2], small_factors[2], normal[3];
    size_t axes[3];
    bvxi_ring ring = {0};
    void *behind;

    ring.ctx = work->ctx;
    BVXI_TRY(polygon_room(work, &ring, count, 0, &behind));

    /* Two scales: exact places need the digits far down, the normal needs room for products. */
    polygon_scale(corner, count, factors, small_factors);
    polygon_normal(corner, count, small_factors, normal);
    polygon_rank_axes(normal, axes);
    for (size_t a = 0; a < 3; a++) {
        double const component = normal[axes[a]];
        ring.triangles = triangles;
        /* Seen along this axis there may be nothing but a line; the next one shows more. */
        if (!polygon_lay_flat(&ring, corner, (uint32_t)count, factors, axes[a]) || polygon_is_line(&ring))
            continue;
        int32_t const sense = polygon_sense(&ring);
        if (sense < 0) polygon_turn_round(&ring);
        if (polygon_ring_is_convex(&ring)) break;
        return polygon_cut_ring(work, &ring, count, sense, component > 0.0 ? 1 : component < 0.0 ? -1 : 0);
    }
    polygon_make_fan(triangles, count);
    return BVX_OK;
}

bvx_status bvxi_polygon_cut(bvxi_polygon *work, const double (*corner)[3], uint64_t count,
                            uint32_t *triangles)
{
    /* Nearly all polygons of files are convex, and need no memory at all. */
    if (count > 3 && count <= POLYGON_MOST && !polygon_is_certainly_convex(corner, count))
        return polygon_cut_flat(work, corner, count, triangles);
    polygon_make_fan(triangles, count);
    return BVX_OK;
}

void bvxi_polygon_free(bvxi_polygon *work)
{
    bvxi_drop(work->ctx, work->block);
    work->block = NULL;
    work->block_size = 0;
}
