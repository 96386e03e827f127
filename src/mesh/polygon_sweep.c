/* polygon_sweep.c - a simple polygon cut into triangles by one sweep over its corners.
 *
 * Source: Hertel, Mehlhorn. Fast triangulation of the plane with respect to simple polygons. 1985.
 *         Sleator, Tarjan. Self-adjusting binary search trees. 1985 (top-down splaying).
 *
 * A line sweeps over the corners in order of x, then y. Where it is inside the polygon it is cut into
 * intervals, each between a floor edge and a roof edge. What is not yet cut on an interval's left ends in a
 * chain of corners from the floor's start to the roof's start, and the chain bends to the right alone: no
 * three of its corners can be cut off. A new corner is added to the chain (at an end, or in its front where
 * the interval splits), and from there on triangles are cut off as long as the chain's next corner can be
 * seen. Each triangle takes one corner out of a chain, so all walks together are linear; intervals lie in a
 * splay tree, so no order of corners makes finding them dear.
 *
 * Guarantee: every triangle is left-turning by an exact test (the last ones of an interval may have no area),
 * the pieces of chain match, and there are count - 2: for a simple polygon that is a triangulation. A polygon
 * for which this does not come out is reported as not simple. Cost: O(count log count), also then. */
#include "mesh/polygon.h"

enum { SWEEP_NONE = 0, SWEEP_ASK = 1 << 14 };

typedef struct chain_link {
    uint32_t corner, below, above;
} chain_link;

/* Edge e runs from corner e of the ring to the next: floors to the right, roofs to the left. */
typedef struct sweep_interval {
    uint32_t left, right; /* the tree: lower intervals, higher intervals */
    uint32_t floor, roof;
    uint32_t bottom, top, front; /* links: the chain's ends, and its rightmost */
} sweep_interval;

typedef struct polygon_sweep {
    bvxi_ring *ring;
    uint32_t *rank;            /* of each corner in the order of the sweep */
    uint32_t *interval_of;     /* of each edge that bounds one */
    chain_link *links;         /* from 1 on */
    sweep_interval *intervals; /* from 1 on; number 0 is the tree's scratch */
    uint32_t link_count, interval_count, root;
    int good;
} polygon_sweep;

/* ---- the order ---- */

static int sweep_comes_first(const bvxi_ring *ring, uint32_t a, uint32_t b)
{
    int32_t const order = bvxi_place_order(ring->xy[a], ring->xy[b]);
    return order != 0 ? order < 0 : a < b;
}

bvx_status bvxi_polygon_order(const bvxi_ring *ring, uint32_t *order, uint32_t *other, int *touches)
{
    uint32_t const n = ring->count;
    uint32_t *from = order, *to = other;

    /* A merge sort from the bottom up: stable, without recursion, in the same time for any corners. */
    for (uint32_t i = 0; i < n; i++) order[i] = i;
    for (uint32_t width = 1; width < n; width *= 2) { /* merge runs of this width */
        BVXI_TRY(bvxi_ring_ask(ring, 0.4 * (double)width / (double)n));
        for (uint32_t low = 0; low < n; low += 2 * width) {
            uint32_t const middle = n - low < width ? n : low + width;
            uint32_t const high = n - low < 2 * width ? n : low + 2 * width;
            uint32_t a = low, b = middle;
            for (uint32_t i = low; i < high; i++)
                to[i] = a < middle && (b == high || sweep_comes_first(ring, from[a], from[b])) ? from[a++]
                                                                                               : from[b++];
        }
        uint32_t *const swap = from;
        from = to;
        to = swap;
    }
    if (from != order) memcpy(order, from, (size_t)n * sizeof *order);

    /* Neighbours in the order at one place: the polygon touches itself. */
    *touches = 0;
    for (uint32_t i = 1; i < n; i++)
        if (bvxi_place_order(ring->xy[order[i - 1]], ring->xy[order[i]]) == 0) *touches = 1;
    return BVX_OK;
}

/* ---- the tree of intervals, from low to high ---- */

/* 1 when the corner is on the interval's floor or above it. */
static int sweep_is_above(const polygon_sweep *s, uint32_t interval, uint32_t corner)
{
    uint32_t const floor = s->intervals[interval].floor;
    return bvxi_ring_side(s->ring, floor, bvxi_ring_next(s->ring, floor), corner) >= 0;
}

/* Splay the search for a corner to the root of a subtree that is not empty; highest 1: its last interval. */
static uint32_t sweep_splay(const polygon_sweep *s, uint32_t root, uint32_t corner, int highest)
{
    sweep_interval *const v = s->intervals;
    uint32_t low = SWEEP_NONE, high = SWEEP_NONE; /* where what remains and right of the path is hung */

    /* The two halves of the split are hung below number 0, the scratch, and put together at the end. */
    v[SWEEP_NONE].left = v[SWEEP_NONE].right = SWEEP_NONE;
    for (;;) {
        int const up = highest || sweep_is_above(s, root, corner);
        uint32_t const child = up ? v[root].right : v[root].left;
        if (child == SWEEP_NONE) break;
        /* twice the same way: turn the two round */
        if ((highest || sweep_is_above(s, child, corner)) == up) {
            if (up) {
                v[root].right = v[child].left;
                v[child].left = root;
            } else {
                v[root].left = v[child].right;
                v[child].right = root;
            }
            root = child;
            if ((up ? v[root].right : v[root].left) == SWEEP_NONE) break;
        }
        /* What lies beside the path goes to the half of the lower or of the higher intervals. */
        if (up) {
            v[low].right = root;
            low = root;
            root = v[root].right;
        } else {
            v[high].left = root;
            high = root;
            root = v[root].left;
        }
    }
    v[low].right = v[root].left;
    v[high].left = v[root].right;
    v[root].left = v[SWEEP_NONE].right;
    v[root].right = v[SWEEP_NONE].left;
    return root;
}

/* Bring the highest interval that starts on or below a corner to the root; SWEEP_NONE when there is none. */
static uint32_t sweep_find(polygon_sweep *s, uint32_t corner)
{
    sweep_interval *const v = s->intervals;
    if (s->root == SWEEP_NONE) return SWEEP_NONE;
    /* The root is a neighbour of the place searched for: it, or the highest of those below it. */
    s->root = sweep_splay(s, s->root, corner, 0);
    if (sweep_is_above(s, s->root, corner)) return s->root;
    if (v[s->root].left == SWEEP_NONE) return SWEEP_NONE;
    uint32_t const found = sweep_splay(s, v[s->root].left, corner, 1);
    v[s->root].left = SWEEP_NONE;
    v[found].right = s->root;
    s->root = found;
    return found;
}

/* Put a new interval right above the one that sweep_find has found. */
static void sweep_insert(polygon_sweep *s, uint32_t found, uint32_t interval)
{
    sweep_interval *const v = s->intervals;
    v[interval].left = found;
    v[interval].right = found == SWEEP_NONE ? s->root : v[found].right;
    if (found != SWEEP_NONE) v[found].right = SWEEP_NONE;
    s->root = interval;
}

/* Take out the interval whose floor ends in a corner. */
static void sweep_remove(polygon_sweep *s, uint32_t interval, uint32_t corner)
{
    sweep_interval *const v = s->intervals;

    if (sweep_find(s, corner) != interval) {
        s->good = 0;
        return;
    }

    /* The two subtrees are joined: the highest of the lower ones has no right subtree after splaying. */
    uint32_t const rest = v[interval].right;
    s->root = v[interval].left;
    if (s->root == SWEEP_NONE) {
        s->root = rest;
        return;
    }
    s->root = sweep_splay(s, s->root, corner, 1);
    v[s->root].right = rest;
}

/* ---- chains ---- */

static uint32_t sweep_link(polygon_sweep *s, uint32_t corner)
{
    uint32_t const k = ++s->link_count;
    s->links[k].corner = corner;
    s->links[k].below = s->links[k].above = SWEEP_NONE;
    return k;
}

/* The triangle of two neighbours in a chain and a corner right of it; 0 when its turn is less than wanted. */
static int sweep_cut(polygon_sweep *s, uint32_t below, uint32_t above, uint32_t corner, int32_t wanted)
{
    uint32_t const a = s->links[below].corner, b = s->links[above].corner;
    /* A corner that does not see the two: they stay in the chain. */
    if (bvxi_ring_side(s->ring, a, corner, b) < wanted) return 0;
    /* A simple polygon has count - 2 triangles; one more shows that this one is not. */
    if (s->ring->made == s->ring->count - 2) {
        s->good = 0;
        return 0;
    }
    bvxi_ring_triangle(s->ring, a, corner, b);
    return 1;
}

static uint32_t sweep_cut_up(polygon_sweep *s, uint32_t link, uint32_t corner)
{
    uint32_t next;
    while ((next = s->links[link].above) != SWEEP_NONE && sweep_cut(s, link, next, corner, 1)) link = next;
    return link;
}

static void sweep_join(polygon_sweep *s, uint32_t below, uint32_t above)
{
    s->links[below].above = above;
    s->links[above].below = below;
}

static void sweep_add_top(polygon_sweep *s, sweep_interval *v, uint32_t corner)
{
    /* Cut off what the corner sees downwards; stays: the last link that does. */
    uint32_t stays = v->top, next;
    while ((next = s->links[stays].below) != SWEEP_NONE && sweep_cut(s, next, stays, corner, 1)) stays = next;
    uint32_t const added = sweep_link(s, corner);
    sweep_join(s, stays, added);
    v->top = v->front = added;
}

static void sweep_add_bottom(polygon_sweep *s, sweep_interval *v, uint32_t corner)
{
    uint32_t const stays = sweep_cut_up(s, v->bottom, corner), added = sweep_link(s, corner);
    sweep_join(s, added, stays);
    v->bottom = v->front = added;
}

/* ---- the five kinds of corners ---- */

static void sweep_bound(polygon_sweep *s, uint32_t interval, uint32_t floor, uint32_t roof)
{
    s->intervals[interval].floor = floor;
    s->intervals[interval].roof = roof;
    s->interval_of[floor] = s->interval_of[roof] = interval;
}

/* The interval that an edge bounds as its floor, or as its roof; SWEEP_NONE if not simple. */
static uint32_t sweep_with(polygon_sweep *s, uint32_t edge, int roof)
{
    uint32_t const i = s->interval_of[edge];
    if (i == SWEEP_NONE || (roof ? s->intervals[i].roof : s->intervals[i].floor) != edge) s->good = 0;
    return s->good ? i : SWEEP_NONE;
}

/* Both edges go right, the interior around them: the interval below keeps the chain up to its front. */
static void sweep_part(polygon_sweep *s, uint32_t corner, uint32_t before)
{
    uint32_t const found = sweep_find(s, corner);

    /* A corner inside of nothing: edges have crossed. */
    if (found == SWEEP_NONE) {
        s->good = 0;
        return;
    }
    uint32_t const made = ++s->interval_count;
    sweep_interval *const lower = &s->intervals[found];
    sweep_interval *const upper = &s->intervals[made];

    /* Floors and roofs: the lower interval ends at the corner's own edge, the upper one begins there. */
    sweep_insert(s, found, made);
    uint32_t const roof = lower->roof;
    sweep_bound(s, made, corner, roof);
    sweep_bound(s, found, lower->floor, before);
    uint32_t const front = lower->front;
    /* The front belongs to both chains now, so it gets a second link. */
    uint32_t const copy = sweep_link(s, s->links[front].corner);
    upper->bottom = copy;
    upper->top = lower->top == front ? copy : lower->top;
    if (s->links[front].above != SWEEP_NONE) sweep_join(s, copy, s->links[front].above);
    s->links[front].above = SWEEP_NONE;
    lower->top = front;
    sweep_add_top(s, lower, corner);
    sweep_add_bottom(s, upper, corner);
}

/* Both edges come from the left, the interior between them. */
static void sweep_end(polygon_sweep *s, uint32_t corner, uint32_t before)
{
    uint32_t const i = sweep_with(s, before, 0);
    uint32_t next;

    if (i == SWEEP_NONE || sweep_with(s, corner, 1) != i) {
        s->good = 0;
        return;
    }
    /* With both edges ended, all that is left of the chain must be cut off from this corner. */
    for (uint32_t k = s->intervals[i].bottom; (next = s->links[k].above) != SWEEP_NONE; k = next) {
        if (sweep_cut(s, k, next, corner, 0)) continue;
        s->good = 0;
        return;
    }
    sweep_remove(s, i, corner);
}

/* Both edges come from the left, the interior around them: the interval below takes over the one above. */
static void sweep_merge(polygon_sweep *s, uint32_t corner, uint32_t before)
{
    uint32_t const low = sweep_with(s, corner, 1), high = sweep_with(s, before, 0);

    if (!s->good || low == high) {
        s->good = 0;
        return;
    }
    sweep_interval *const lower = &s->intervals[low];
    sweep_interval *const upper = &s->intervals[high];

    /* The corner closes the lower chain and opens the way to the upper one, which follows it. */
    sweep_add_top(s, lower, corner);
    sweep_join(s, lower->top, sweep_cut_up(s, upper->bottom, corner));
    lower->top = upper->top;
    /* The interval above is taken out before its roof is passed to the one below. */
    sweep_remove(s, high, corner);
    sweep_bound(s, low, lower->floor, upper->roof);
}

static void sweep_corner(polygon_sweep *s, uint32_t corner)
{
    const bvxi_ring *const ring = s->ring;
    uint32_t const before = bvxi_ring_previous(ring, corner), after = bvxi_ring_next(ring, corner);
    int const from_left = s->rank[before]<s->rank[corner], to_right = s->rank[after]> s->rank[corner];
    uint32_t i;

    /* One edge comes and one goes: the corner continues a floor or a roof. */
    if (from_left && to_right) {
        if ((i = sweep_with(s, before, 0)) == SWEEP_NONE) return;
        sweep_bound(s, i, corner, s->intervals[i].roof);
        sweep_add_bottom(s, &s->intervals[i], corner);
    } else if (!from_left && !to_right) {
        if ((i = sweep_with(s, corner, 1)) == SWEEP_NONE) return;
        sweep_bound(s, i, s->intervals[i].floor, before);
        sweep_add_top(s, &s->intervals[i], corner);
    } else {
        /* Both edges on one side: whether the interior lies between them is the sense of the turn. */
        int32_t const turn = bvxi_ring_side(ring, before, corner, after);
        if (turn == 0) s->good = 0; /* one edge lies on the other */
        else if (to_right && turn > 0) {
            /* Both edges go right, the interior between them. */
            uint32_t const made = ++s->interval_count;
            sweep_interval *const v = &s->intervals[made];
            /* It lies right above the interval below its corner, since edges do not cross. */
            sweep_insert(s, sweep_find(s, corner), made);
            sweep_bound(s, made, corner, before);
            v->bottom = v->top = v->front = sweep_link(s, corner);
        } else if (to_right) sweep_part(s, corner, before);
        else if (turn > 0) sweep_end(s, corner, before);
        else sweep_merge(s, corner, before);
    }
}

/* A corner adds one link, or three where an interval splits, and then a neighbour adds only one. */
uint64_t bvxi_polygon_sweep_size(uint32_t count)
{
    uint64_t const n = count;
    return n * 8 + (2 * n + 2) * sizeof(chain_link) + (n / 2 + 2) * sizeof(sweep_interval);
}

bvx_status bvxi_polygon_sweep(bvxi_ring *ring, const uint32_t *order, void *scratch, int *good)
{
    uint32_t const n = ring->count;
    polygon_sweep s = {.ring = ring, .rank = scratch};

    s.interval_of = s.rank + n;
    s.links = (chain_link *)(void *)(s.interval_of + n);
    s.intervals = (sweep_interval *)(void *)(s.links + (size_t)n * 2 + 2);
    s.good = 1;
    memset(s.interval_of, 0, (size_t)n * sizeof *s.interval_of);
    /* The rank makes every later comparison of corners one of whole numbers. */
    for (uint32_t i = 0; i < n; i++) s.rank[order[i]] = i;
    for (uint32_t i = 0; i < n && s.good; i++) {
        if (i % SWEEP_ASK == 0) BVXI_TRY(bvxi_ring_ask(ring, 0.4 + 0.3 * (double)i / (double)n));
        sweep_corner(&s, order[i]);
    }

    /* All three must hold for a triangulation; else another way is taken. */
    *good = s.good && ring->made == n - 2 && s.root == SWEEP_NONE;
    return BVX_OK;
}
