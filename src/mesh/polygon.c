/* polygon.c - polygons in space cut into triangles: exactly where they are planar and simple, as well as can
 * be, in bounded time, where they are not.
 *
 * On which side of a line a point lies is decided without rounding. Sources at the headings below.
 * Guarantee: the cut depends on the polygon and nothing else. */
#include "mesh/polygon.h"

/* ---- On which side of a line a point lies, without any rounding ---- */

/* Source: Dekker. A floating-point technique for extending the available precision. 1971 (products without
 * error).
 *         Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates. 1997.
 *
 * Where the differences of coordinates are exact, as on whole numbers, two products with their errors are
 * compared. Otherwise the determinant is written as six products of coordinates, and their twelve parts are
 * summed without error.
 * Guarantee: the right sign for coordinates below 2^500 that are multiples of 2^-500: sums and products stay
 * below 2^1023, and every error is a multiple of 2^-1000. Only + - * of doubles rounded to nearest; no
 * contraction. */

enum { SIDE_TERMS = 12 };

/* high + low = a + b, high the rounded sum. */
static void side_sum(double a, double b, double *high, double *low)
{
    /* What rounding took off the sum, exactly: Knuth's order of operations works for any two sizes. */
    double const sum = a + b, part = sum - a;
    *low = (a - (sum - part)) + (b - part);
    *high = sum;
}

/* a = high + low, 26 bits each at most. */
static void side_split(double a, double *high, double *low)
{
    double const c = 134217729.0 * a; /* 2^27 + 1 */
    *high = c - (c - a);
    *low = a - *high;
}

static void side_product(double a, double b, double *high, double *low)
{
    double a1, a0, b1, b0;
    double const product = a * b;
    side_split(a, &a1, &a0);
    side_split(b, &b1, &b0);
    /* The product's error as the sum of the halves' products, each of which is exact. */
    *low = a0 * b0 - (((product - a1 * b1) - a0 * b1) - a1 * b0);
    *high = product;
}

/* Add one number to an expansion: parts that do not overlap, from small to large. */
static void side_grow(double *parts, int count, double value)
{
    for (int i = 0; i < count; i++) side_sum(value, parts[i], &value, &parts[i]);
    parts[count] = value;
}

int32_t bvxi_side_exact(const double a[2], const double b[2], const double c[2])
{
    double ac[2], bc[2], rest[4], left, left_low, right, right_low;

    /* Exact differences need two products only; that is the case for whole numbers of usual size. */
    for (size_t k = 0; k < 2; k++) {
        side_sum(a[k], -c[k], &ac[k], &rest[k]);
        side_sum(b[k], -c[k], &bc[k], &rest[k + 2]);
    }
    if (rest[0] != 0.0 || rest[1] != 0.0 || rest[2] != 0.0 || rest[3] != 0.0) {
        /* The determinant written out in coordinates, which are exact where differences are not. */
        const double factors[6][2] = {{a[0], b[1]},  {-a[1], b[0]}, {b[0], c[1]},
                                      {-b[1], c[0]}, {c[0], a[1]},  {-c[1], a[0]}};
        double parts[SIDE_TERMS] = {0};
        int n = 0;

        for (size_t i = 0; i < 6; i++, n += 2) {
            double high, low;
            side_product(factors[i][0], factors[i][1], &high, &low);
            side_grow(parts, n, low);
            side_grow(parts, n + 1, high);
        }
        /* Parts do not overlap, so the largest one that is not 0 has the sign of the sum. */
        while (n > 0 && parts[n - 1] == 0.0) n--;
        return n == 0 ? 0 : parts[n - 1] > 0.0 ? 1 : -1;
    }
    /* rounding keeps order, so the errors decide only between equals */
    side_product(ac[0], bc[1], &left, &left_low);
    side_product(ac[1], bc[0], &right, &right_low);
    if (left != right) return left > right ? 1 : -1;
    return left_low > right_low ? 1 : left_low < right_low ? -1 : 0;
}

/* ---- A polygon in space cut into triangles ---- */

/* Source: Newell's sums for the normal (Sutherland, Sproull, Schumacker. A characterization of ten
 * hidden-surface algorithms. 1974).
 *
 * A polygon whose corners certainly all turn the same way, once round, is a fan. Any other is laid into the
 * plane of two axes, along the axis of its greatest normal component, which changes no coordinate; from then
 * on all turns are decided exactly. Corners at their predecessor's place become triangles without area and
 * are left out; what remains is a fan where it is convex, else it is swept (polygon_sweep.c), and what the
 * sweep finds not to be simple is cut ear by ear (polygon.c). The plane is turned round where that makes
 * the polygon counter-clockwise, so all have one sense.
 *
 * Coordinates are first multiplied by the power of two that brings the greatest to 2^499..2^500. What is then
 * below 2^-448 (less than 2^-947 of the greatest) is rounded to a multiple of 2^-499; all else is exact. So
 * the cut does not change when the polygon is multiplied by a power of two. A polygon that is not quite flat
 * is cut by its projection: when that is simple, no two triangles overlap in it. */

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

/* Axes by their components, the greatest first; z before y before x where they are equal. */
static void polygon_rank_axes(const double normal[3], size_t axes[3])
{
    double size[3];
    size_t next = 0;

    for (size_t a = 0; a < 3; a++) size[a] = bvxi_absolute(normal[a]);

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

    polygon_normal(corner, count, as_they_are, normal);
    polygon_rank_axes(normal, axes);
    double const size = bvxi_absolute(normal[axes[0]]);
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

    for (uint64_t i = 0; i < count; i++)
        for (size_t a = 0; a < 3; a++)
            if (bvxi_absolute(corner[i][a]) > greatest) greatest = bvxi_absolute(corner[i][a]);
    memcpy(&bits, &greatest, sizeof bits);
    int32_t exponent = 1023 - (int32_t)(bits >> 52); /* -1023..1023 */
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
    /* Far above the last digit nothing is rounded; below, adding the constant rounds to its last bit. */
    if (bvxi_absolute(scaled) >= 0x1p-448) return scaled;
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

    for (; n > 3 && bvxi_place_order(ring->xy[0], ring->xy[n - 1]) == 0; n--) /* the first follows the last */
        bvxi_ring_triangle(ring, n - 2, n - 1, 0);
    ring->triangles += (size_t)ring->made * 3;
    ring->made = 0;
    ring->count = n;
    return 1;
}

static void polygon_turn_round(bvxi_ring *ring)
{
    for (uint32_t i = 0; i < ring->count; i++) ring->xy[i][1] = -ring->xy[i][1];
}

/* ---- the ways to cut ---- */

/* Scratch: places and numbers of count corners, then more bytes. */
static bvx_status polygon_room(bvxi_polygon *work, bvxi_ring *ring, uint64_t count, uint64_t more,
                               void **behind)
{
    uint64_t const size = count * 20 + more;

    /* The block grows and is kept for the next polygon; its contents stay, so it is resized. */
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

/* Cut a ring that is no line. sense: its turn at the lowest corner; area: that of its area, if known. */
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
        if (!polygon_lay_flat(&ring, corner, (uint32_t)count, factors, axes[a])) continue;
        uint32_t bend = 0;
        while (bend + 2 < ring.count && bvxi_ring_side(&ring, bend, bend + 1, bend + 2) == 0) bend++;
        if (bend + 2 >= ring.count) continue;
        /* The lowest corner is on the hull, so its turn cannot be a reflex one in a simple ring. */
        uint32_t lowest = 0;
        for (uint32_t i = 1; i < ring.count; i++)
            if (bvxi_place_order(ring.xy[i], ring.xy[lowest]) < 0) lowest = i;
        int32_t const sense = bvxi_ring_side(&ring, bvxi_ring_previous(&ring, lowest), lowest,
                                             bvxi_ring_next(&ring, lowest));
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

/* ---- A polygon that is not simple cut into triangles as well as can be, in bounded time ---- */

/* Source: Meisters. Polygons have ears. 1975. ElGindy, Everett, Toussaint. Slicing an ear using
 * prune-and-search. 1993 (only reflex corners can lie in an ear).
 *
 * Corners are cut off one after the other, going round: an ear (left-turning, no reflex corner in its
 * triangle) or a corner whose two edges fold onto each other. Corners at the same place as one of the
 * triangle's do not count as inside, so a polygon that touches itself, such as one with holes joined to its
 * rim by bridges, comes out as if it were simple: all triangles left-turning. Where a whole round finds no
 * ear, the edges cross: then straight corners go, then left-turning ones, then any. The looks at reflex
 * corners are counted: 512 for each corner, 2^24 at most. When they are used up, what remains becomes a
 * fan. */

enum { EAR_LOOKS_EACH = 512, EAR_LOOKS_MOST = 1 << 24, EAR_ASK = 1 << 18 };
enum { EAR_OTHER = 0, EAR_REFLEX = 1, EAR_CUT = 2 };

typedef struct polygon_ears {
    bvxi_ring *ring;
    uint32_t *next, *previous;
    uint32_t *reflex; /* corners that were reflex when they were last looked at */
    uint8_t *state;
    uint32_t reflex_count;
    uint64_t looks, looks_left, ask;
} polygon_ears;

static void ear_set_state(polygon_ears *e, uint32_t v)
{
    if (e->state[v] == EAR_REFLEX && bvxi_ring_side(e->ring, e->previous[v], v, e->next[v]) > 0)
        e->state[v] = EAR_OTHER;
}

static int ear_holds(const polygon_ears *e, uint32_t p, uint32_t v, uint32_t q, uint32_t r)
{
    const double(*const xy)[2] = (const double(*)[2])e->ring->xy;

    /* The box of the triangle first, which is what refuses most corners. */
    for (size_t k = 0; k < 2; k++) {
        double const x = xy[r][k];
        if (x < xy[p][k] && x < xy[v][k] && x < xy[q][k]) return 0;
        if (x > xy[p][k] && x > xy[v][k] && x > xy[q][k]) return 0;
    }

    /* A corner at the same place as one of the triangle's does not count as inside. */
    if (bvxi_place_order(xy[r], xy[p]) == 0 || bvxi_place_order(xy[r], xy[v]) == 0 ||
        bvxi_place_order(xy[r], xy[q]) == 0)
        return 0;
    return bvxi_ring_side(e->ring, p, v, r) >= 0 && bvxi_ring_side(e->ring, v, q, r) >= 0 &&
           bvxi_ring_side(e->ring, q, p, r) >= 0;
}

/* v turns left, so it is none of the reflex corners. */
static int ear_is_free(polygon_ears *e, uint32_t p, uint32_t v, uint32_t q)
{
    for (uint32_t i = 0; i < e->reflex_count;) {
        uint32_t const r = e->reflex[i];
        /* Corners that are no longer reflex are taken out when they are met: none becomes reflex again. */
        if (e->state[r] != EAR_REFLEX) {
            e->reflex[i] = e->reflex[--e->reflex_count];
            continue;
        }
        i++;
        e->looks++;
        if (r != p && r != q && ear_holds(e, p, v, q, r)) return 0;
    }
    return 1;
}

/* round: how many times all corners were looked at in vain. */
static int ear_may_go(polygon_ears *e, uint32_t v, uint32_t round)
{
    uint32_t const p = e->previous[v], q = e->next[v];
    int32_t const turn = bvxi_ring_side(e->ring, p, v, q);
    /* Each round in vain allows more, so that the loop always goes on. */
    if (round >= 3 || (round == 2 && turn > 0) || (round == 1 && turn == 0)) return 1;
    if (round > 0) return 0;
    if (turn != 0) return turn > 0 && ear_is_free(e, p, v, q);
    /* A fold: the two edges at v lie on one line and on the same side of v. */
    const double(*const xy)[2] = (const double(*)[2])e->ring->xy;
    return bvxi_place_order(xy[p], xy[v]) * bvxi_place_order(xy[v], xy[q]) <= 0;
}

static void ears_prepare(polygon_ears *e, void *scratch)
{
    uint32_t const n = e->ring->count;

    e->next = scratch;
    e->previous = e->next + n;
    e->reflex = e->previous + n;
    e->state = (uint8_t *)(e->reflex + n);

    /* Bounded work: a ring made to have no ears would cost its corners squared, times the reflex ones. */
    e->looks_left = (uint64_t)n * EAR_LOOKS_EACH < EAR_LOOKS_MOST ? (uint64_t)n * EAR_LOOKS_EACH
                                                                  : EAR_LOOKS_MOST;
    for (uint32_t i = 0; i < n; i++) {
        e->next[i] = bvxi_ring_next(e->ring, i);
        e->previous[i] = bvxi_ring_previous(e->ring, i);
        e->state[i] = bvxi_ring_side(e->ring, e->previous[i], i, e->next[i]) > 0 ? EAR_OTHER : EAR_REFLEX;
        if (e->state[i] == EAR_REFLEX) e->reflex[e->reflex_count++] = i;
    }
}

uint64_t bvxi_polygon_ears_size(uint32_t count)
{
    return (uint64_t)count * 13;
}

bvx_status bvxi_polygon_ears(bvxi_ring *ring, void *scratch)
{
    uint32_t v = 0, left = ring->count, vain = 0, round = 0;

    polygon_ears e = {.ring = ring, .ask = EAR_ASK};
    ears_prepare(&e, scratch);
    while (left > 3 && e.looks < e.looks_left) {
        /* Called by looks, since a corner may take one or all reflex ones. */
        if (e.looks >= e.ask) {
            BVXI_TRY(
                bvxi_progress(ring->ctx, "cut polygon", 0.7 + 0.3 * (double)e.looks / (double)e.looks_left));
            e.ask += EAR_ASK;
        }
        e.looks++;
        if (ear_may_go(&e, v, round)) {
            uint32_t const p = e.previous[v], q = e.next[v];
            bvxi_ring_triangle(e.ring, p, v, q);
            e.next[p] = q;
            e.previous[q] = p;
            e.state[v] = EAR_CUT;
            ear_set_state(&e, p);
            ear_set_state(&e, q);

            left--;
            /* A cut changes what its neighbours are, so the stricter rules get another chance. */
            vain = round = 0;
        } else if (++vain == left) {
            vain = 0;
            round++;
        }
        v = e.next[v];
    }

    /* Three corners, or all that is left when the looks are used up. */
    for (uint32_t a = e.next[v], b = e.next[a]; b != v; a = b, b = e.next[b])
        bvxi_ring_triangle(e.ring, v, a, b);
    return BVX_OK;
}
