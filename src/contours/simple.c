/* simple.c - segments of loops that cross or touch, decided exactly in fixed point.
 *
 * Most sections hold simple loops whose points are some way apart: a quick check finds these good without an
 * allocation, side by side. Whatever is not surely good goes to the full check, whose message names the points.
 *
 * Each segment, in the order of their lowest u, is compared with those that still reach that far. The quick check
 * sorts by buckets and insertion. Points of a loop that snap to one position count as one.
 * Cost: O(n log n) and the pairs whose ranges of u overlap. */
#include "contours/section.h"
#include "mesh/mesh.h"

/* ---- Two segments ---- */

static int is_between(int32_t a, int32_t b, int32_t x)
{
    return a < b ? a <= x && x <= b : b <= x && x <= a;
}

/* c on the closed segment a b, known to be on its line. */
static int is_on(const int32_t *a, const int32_t *b, const int32_t *c)
{
    return is_between(a[0], b[0], c[0]) && is_between(a[1], b[1], c[1]);
}

int bvxi_segments_meet(const int32_t *a, const int32_t *b, const int32_t *c, const int32_t *d)
{
    int const ca = bvxi_turn_sign(a, b, c);
    int const da = bvxi_turn_sign(a, b, d);
    int const ac = bvxi_turn_sign(c, d, a);
    int const bc = bvxi_turn_sign(c, d, b);
    /* Each has its ends on both sides of the other; otherwise they meet only where an end lies on one. */
    if (ca * da < 0 && ac * bc < 0) return 1;
    return (ca == 0 && is_on(a, b, c)) || (da == 0 && is_on(a, b, d)) || (ac == 0 && is_on(c, d, a)) ||
           (bc == 0 && is_on(c, d, b));
}

int bvxi_segment_holds(const int32_t *a, const int32_t *b, const int32_t *c)
{
    return is_on(a, b, c) && bvxi_turn_sign(a, b, c) == 0;
}

int bvxi_folds_back(const int32_t *shared, const int32_t *a, const int32_t *b)
{
    int64_t const dot = ((int64_t)a[0] - shared[0]) * ((int64_t)b[0] - shared[0]) +
                        ((int64_t)a[1] - shared[1]) * ((int64_t)b[1] - shared[1]);
    return bvxi_turn_sign(shared, a, b) == 0 && dot > 0;
}

/* place: of each point; NULL where no two are at one place. */
static int pair_meets(const bvxi_plane *p, const uint32_t *place, uint32_t i, uint32_t j)
{
    uint32_t const in = p->next[i], jn = p->next[j];
    int const after = place == NULL ? in == j : place[in] == place[j];
    int const before = place == NULL ? jn == i : place[jn] == place[i];
    if (after && before) return 1; /* there and back: two different segments between the same two points */
    if (after) return bvxi_folds_back(p->q[j], p->q[i], p->q[jn]);
    if (before) return bvxi_folds_back(p->q[i], p->q[in], p->q[j]);
    return bvxi_segments_meet(p->q[i], p->q[in], p->q[j], p->q[jn]);
}

/* ---- Pairs whose boxes meet ---- */

/* order: of the boxes by their left sides; NULL: they are in it. active: scratch, one a box. */
static bvx_status sweep_boxes(const bvxi_segment_box *box, const uint32_t *order, uint32_t count,
                              uint32_t *active, bvxi_pair_fn *pair, void *user)
{
    uint32_t reach = 0;

    for (uint32_t n = 0; n < count; n++) {
        uint32_t const i = order == NULL ? n : order[n];
        const bvxi_segment_box *const x = &box[i];
        uint32_t kept = 0;

        for (uint32_t a = 0; a < reach; a++) {
            const bvxi_segment_box *const y = &box[active[a]];
            /* It ends before this one begins, and so before all that follow. */
            if (y->right < x->left) continue;
            active[kept++] = active[a];
            if (y->high >= x->low && y->low <= x->high) BVXI_TRY(pair(user, x->segment, y->segment));
        }
        active[kept++] = i;
        reach = kept;
    }
    return BVX_OK;
}

/* No scope: what pairs take stays. */
bvx_status bvxi_sweep(bvx_context *ctx, const bvxi_segment_box *box, uint32_t count, bvxi_pair_fn *pair,
                      void *user)
{
    uint64_t *key;

    BVXI_TRY(BVXI_ARRAY(ctx, 2 * (uint64_t)count, "the order of segments", key));
    uint32_t *const order = (uint32_t *)(void *)(key + count), *const active = order + count;
    for (uint32_t i = 0; i < count; i++) {
        key[i] = (uint64_t)((int64_t)box[i].left - INT32_MIN);
        order[i] = i;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, key, order, count));
    bvx_status const status = sweep_boxes(box, order, count, active, pair, user);
    bvxi_drop(ctx, key);
    return status;
}

/* ---- The quick check ---- */

enum { QUICK_BUCKETS = 256, QUICK_MOST_MOVES = 16 };

/* 0 when the order is so uneven that insertion would take long. */
static int sort_boxes(const bvxi_segment_box *box, uint32_t n, bvxi_segment_box *sorted)
{
    uint32_t start[QUICK_BUCKETS], shift = 0;
    int32_t low = box[0].left, high = low;
    uint64_t moves = (uint64_t)n * QUICK_MOST_MOVES;

    for (uint32_t i = 1; i < n; i++) {
        if (box[i].left < low) low = box[i].left;
        if (box[i].left > high) high = box[i].left;
    }
    while (((uint32_t)(high - low) >> shift) >= QUICK_BUCKETS) shift++;
    memset(start, 0, sizeof start);
    for (uint32_t i = 0; i < n; i++) start[(uint32_t)(box[i].left - low) >> shift]++;
    bvxi_place_counts32(start, QUICK_BUCKETS);
    for (uint32_t i = 0; i < n; i++) sorted[start[(uint32_t)(box[i].left - low) >> shift]++] = box[i];

    /* Buckets are in order already; insertion orders each one, and counts what it costs. */
    for (uint32_t i = 1; i < n; i++) {
        bvxi_segment_box const x = sorted[i];
        uint32_t j = i;
        for (; j > 0 && sorted[j - 1].left > x.left; j--) sorted[j] = sorted[j - 1];
        sorted[j] = x;
        if (i - j > moves) return 0;
        moves -= i - j;
    }
    return 1;
}

static bvx_status quick_pair(void *user, uint32_t i, uint32_t j)
{
    return pair_meets(user, NULL, i, j) ? BVX_ERR_FORMAT : BVX_OK;
}

int bvxi_plane_is_simple(bvxi_plane *p, bvxi_segment_box *sorted, bvxi_segment_box *box)
{
    if (p->point_count == 0) return 1;
    for (uint32_t i = 0; i < p->point_count; i++) {
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        /* Points that snapped together are left to the full check. */
        if (a[0] == b[0] && a[1] == b[1]) return 0;
        box[i] = bvxi_box_segment(a, b, i);
    }
    /* The boxes' array is free once they are sorted. */
    return sort_boxes(box, p->point_count, sorted) &&
           sweep_boxes(sorted, NULL, p->point_count, (uint32_t *)(void *)box, quick_pair, p) == BVX_OK;
}

/* ---- The full check ---- */

typedef struct simple_work {
    bvxi_stack *s;
    const bvxi_plane *p;
    uint32_t *place; /* of each point: the first of those before it that snapped to its place */
} simple_work;

static int at_one_place(const int32_t *a, const int32_t *b)
{
    return a[0] == b[0] && a[1] == b[1];
}

static bvx_status check_pair(void *user, uint32_t i, uint32_t j)
{
    const simple_work *const w = user;
    const bvxi_stack *const s = w->s;
    const bvxi_plane *const p = w->p;

    if (!pair_meets(p, w->place, i, j)) return BVX_OK;
    uint64_t const a = p->contour[bvxi_contour_of(p, i)].given, b = p->contour[bvxi_contour_of(p, j)].given;
    const double *const near = s->given->points + 3 * (uint64_t)p->given[i];
    uint64_t const pa = p->given[i] - s->given->loops[a].first_point;
    uint64_t const pb = p->given[j] - s->given->loops[b].first_point;

    if (a == b)
        return bvxi_fail_for(
            s->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET,
            "%s: loop %i of section %u (position %g) crosses or touches itself, after its points %u and %u, near "
            "(%g, %g, %g)",
            s->function, a, (uint64_t)p->section, p->w, pa, pb, near[0], near[1], near[2]);
    return bvxi_fail_for(
        s->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET,
        "%s: loops %i and %u of section %u (position %g) cross or touch, after their points %u and %u, near "
        "(%g, %g, %g)",
        s->function, a, b, (uint64_t)p->section, p->w, pa, pb, near[0], near[1], near[2]);
}

static bvx_status check_pairs(simple_work *w)
{
    const bvxi_plane *const p = w->p;
    bvxi_segment_box *box;
    uint32_t count = 0;

    BVXI_TRY(BVXI_ARRAY(w->s->ctx, p->point_count, "the segments of a section", box));
    BVXI_TRY(BVXI_ARRAY(w->s->ctx, p->point_count, "the places of points", w->place));
    /* Runs may go over the loop's end, so each is followed back from its last point. */
    for (uint32_t k = 0; k < p->contour_count; k++) {
        const bvxi_contour *const c = &p->contour[k];
        uint32_t const last = c->first + c->count - 1;
        uint32_t start = c->first;
        while (start < last && at_one_place(p->q[start], p->q[last])) start++;
        for (uint32_t i = c->first; i <= last; i++)
            w->place[i] = i > c->first && at_one_place(p->q[i], p->q[i - 1]) ? w->place[i - 1] : i;
        for (uint32_t i = c->first; i < start; i++) w->place[i] = w->place[last];
    }
    for (uint32_t i = 0; i < p->point_count; i++)
        if (!at_one_place(p->q[i], p->q[p->next[i]]))
            box[count++] = bvxi_box_segment(p->q[i], p->q[p->next[i]], i);
    return bvxi_sweep(w->s->ctx, box, count, check_pair, w);
}

bvx_status bvxi_plane_check_simple(bvxi_stack *s, bvxi_plane *p)
{
    simple_work w = {s, p, NULL};
    return BVXI_SCOPE(s->ctx, check_pairs(&w));
}
