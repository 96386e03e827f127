/* polygon_ears.c - a polygon that is not simple cut into triangles as well as can be, in bounded time.
 *
 * Source: Meisters. Polygons have ears. 1975. ElGindy, Everett, Toussaint. Slicing an ear using
 * prune-and-search. 1993 (only reflex corners can lie in an ear).
 *
 * Corners are cut off one after the other, going round: an ear (left-turning, no reflex corner in its
 * triangle) or a corner whose two edges fold onto each other. Corners at the same place as one of the
 * triangle's do not count as inside, so a polygon that touches itself, such as one with holes joined to its
 * rim by bridges, comes out as if it were simple: all triangles left-turning. Where a whole round finds no
 * ear, the edges cross: then straight corners go, then left-turning ones, then any. The looks at reflex
 * corners are counted: 512 for each corner, 2^24 at most. When they are used up, what remains becomes a
 * fan. */
#include "mesh/polygon.h"

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

/* 1 when the two edges at v lie on one line and on the same side of v. */
static int ear_is_fold(const polygon_ears *e, uint32_t p, uint32_t v, uint32_t q)
{
    const double(*const xy)[2] = (const double(*)[2])e->ring->xy;
    return bvxi_place_order(xy[p], xy[v]) * bvxi_place_order(xy[v], xy[q]) <= 0;
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
    return turn == 0 ? ear_is_fold(e, p, v, q) : turn > 0 && ear_is_free(e, p, v, q);
}

static void ear_cut(polygon_ears *e, uint32_t v)
{
    uint32_t const p = e->previous[v], q = e->next[v];
    /* Only the two neighbours turn differently now. */
    bvxi_ring_triangle(e->ring, p, v, q);
    e->next[p] = q;
    e->previous[q] = p;
    e->state[v] = EAR_CUT;
    ear_set_state(e, p);
    ear_set_state(e, q);
}

static void ear_make_fan(polygon_ears *e, uint32_t v)
{
    for (uint32_t a = e->next[v], b = e->next[a]; b != v; a = b, b = e->next[b])
        bvxi_ring_triangle(e->ring, v, a, b);
}

static void ears_prepare(polygon_ears *e, void *scratch)
{
    uint32_t const n = e->ring->count;

    e->next = scratch;
    e->previous = e->next + n;
    e->reflex = e->previous + n;
    e->state = (uint8_t *)(e->reflex + n);

    /* Bounded work: a ring made to have no ears would cost
     * the square of its corners, times the reflex ones. */
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
    polygon_ears e = {0};

    e.ring = ring;
    e.ask = EAR_ASK;
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
            ear_cut(&e, v);
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
    ear_make_fan(&e, v);
    return BVX_OK;
}
