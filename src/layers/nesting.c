/* nesting.c - which loops are blended apart from those around them.
 *
 * A blend of two sections' distances loses walls: where a wall is shifted by more than its thickness from one
 * section to the next, no place between them is inside both, and the surface gets windows there. So loops
 * that lie in others form levels: level 0 is what the outer loops enclose, with no holes in it; level 1 is
 * what the holes enclose, cut out of level 0; level 2 the islands in these holes, and so on. Each level of
 * one section is blended with the same level of the next one. In both sections a level's region lies in that
 * of the level below it, so its signed distance is smaller everywhere, and so is its blend: levels never
 * cross, as far as the surface follows the field.
 *
 * That is right only for a hole that goes on: one that overlaps a hole of the next section. Others end or
 * open between the two sections, and what they do depends on the outline that they may open into. They stay
 * in the level of the loop around them, with all that lies in them, and are blended as they always were. */
#include "layers/slab.h"

#include "mesh/mesh.h"

enum { NESTING_DEEPEST = 100, NESTING_ABOVE_BIT = 31 };

/* A loop as the pairing sees it. */
typedef struct nest_loop {
    int32_t box[4];
    uint32_t depth, parent; /* how many loops it lies in, and the innermost of these */
    int candidate, met;     /* of the depth that is being paired */
} nest_loop;

typedef struct nest_work {
    bvxi_stack *s;
    nest_loop *loop; /* of all planes */
    const bvxi_plane *plane[2];
    nest_loop *on[2]; /* the loops of these planes */
    uint64_t *key;
    uint32_t *order; /* segments of candidates: numbers, with the highest bit for those above */
    uint32_t *active[2];
} nest_work;

/* ---- what lies in what ---- */

static int nest_is_in_box(const int32_t box[4], const int32_t *at)
{
    return at[0] >= box[0] && at[0] <= box[2] && at[1] >= box[1] && at[1] <= box[3];
}

static int nest_contains(const bvxi_plane *p, uint32_t number, const nest_loop *loop, const int32_t *at)
{
    return nest_is_in_box(loop[number].box, at) && bvxi_loop_contains(p, &p->contour[number], at);
}

/* Loops around a loop all lie in each other, so the innermost is the one that lies in the most. */
static void nest_find_parents(const bvxi_plane *p, nest_loop *loop)
{
    uint32_t const n = p->contour_count;

    for (uint32_t i = 0; i < n; i++) {
        bvxi_loop_box(p, &p->contour[i], loop[i].box);
        loop[i].depth = 0;
        loop[i].parent = BVXI_NONE;
    }

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++)
            if (j != i && nest_contains(p, j, loop, p->q[p->contour[i].first])) loop[i].depth++;

    for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n && loop[i].depth != 0; j++)
            if (j != i && loop[j].depth + 1 == loop[i].depth &&
                nest_contains(p, j, loop, p->q[p->contour[i].first]))
                loop[i].parent = j;
}

/* ---- which of them overlap ---- */

static void nest_meet(nest_loop *a, nest_loop *b)
{
    a->met = b->met = 1;
}

/* Candidates of which one encloses the other's first point. */
static void nest_meet_by_points(nest_work *w)
{
    for (uint32_t i = 0; i < w->plane[0]->contour_count; i++)
        for (uint32_t j = 0; j < w->plane[1]->contour_count; j++) {
            nest_loop *const a = &w->on[0][i], *const b = &w->on[1][j];

            /* Pairs that have met already need no further test. */
            if (!a->candidate || !b->candidate || (a->met && b->met)) continue;
            /* A loop within another holds its first point; those that cross are found by their segments. */
            if (nest_contains(w->plane[0], i, w->on[0], w->plane[1]->q[w->plane[1]->contour[j].first]) ||
                nest_contains(w->plane[1], j, w->on[1], w->plane[0]->q[w->plane[0]->contour[i].first]))
                nest_meet(a, b);
        }
}

static int32_t nest_lesser(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

static int32_t nest_greater(int32_t a, int32_t b)
{
    return a > b ? a : b;
}

static int32_t nest_segment_left(const bvxi_plane *p, uint32_t i)
{
    return nest_lesser(p->q[i][0], p->q[p->next[i]][0]);
}

/* Segments of candidates by their least u. */
static bvx_status nest_order_segments(nest_work *w, uint32_t *count)
{
    *count = 0;
    for (uint32_t k = 0; k < 2; k++) {
        const bvxi_plane *const p = w->plane[k];
        for (uint32_t c = 0; c < p->contour_count; c++)
            for (uint32_t i = p->contour[c].first;
                 w->on[k][c].candidate && i < p->contour[c].first + p->contour[c].count; i++) {
                w->key[*count] = (uint64_t)(uint32_t)nest_segment_left(p, i);
                w->order[(*count)++] = i | k << NESTING_ABOVE_BIT;
            }
    }
    return bvxi_radix_sort(w->s->ctx, w->key, w->order, *count);
}

/* Hold a segment against those of the other plane that still reach so far. */
static void nest_hold_segment(nest_work *w, uint32_t k, uint32_t i, uint32_t *reach)
{
    const bvxi_plane *const p = w->plane[k], *const o = w->plane[1 - k];
    const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
    int32_t const left = nest_segment_left(p, i);
    int32_t const low = nest_lesser(a[1], b[1]);
    int32_t const high = nest_greater(a[1], b[1]);
    nest_loop *const own = &w->on[k][bvxi_contour_of(p, i)];
    uint32_t *const active = w->active[1 - k];
    uint32_t kept = 0;

    for (uint32_t n = 0; n < *reach; n++) {
        uint32_t const j = active[n];
        const int32_t *const c = o->q[j], *const d = o->q[o->next[j]];
        nest_loop *other;

        if (nest_greater(c[0], d[0]) < left) continue;
        active[kept++] = j;
        if (nest_greater(c[1], d[1]) < low || nest_lesser(c[1], d[1]) > high) continue;
        other = &w->on[1 - k][bvxi_contour_of(o, j)];
        if (!(own->met && other->met) && bvxi_segments_meet(a, b, c, d)) nest_meet(own, other);
    }
    *reach = kept;
}

/* Candidates whose contours cross. */
static bvx_status nest_meet_by_segments(nest_work *w)
{
    uint32_t reach[2] = {0, 0}, count;

    BVXI_TRY(nest_order_segments(w, &count));
    for (uint32_t n = 0; n < count; n++) {
        uint32_t const k = w->order[n] >> NESTING_ABOVE_BIT;
        uint32_t const i = w->order[n] & ~(UINT32_C(1) << NESTING_ABOVE_BIT);
        nest_hold_segment(w, k, i, &reach[1 - k]);
        w->active[k][reach[k]++] = i;
    }
    return BVX_OK;
}

/* ---- levels ---- */

/* Loops of a depth whose parents go on, each of them on the level just below. */
static uint32_t nest_choose_candidates(nest_work *w, uint8_t *const level[2], uint32_t depth)
{
    uint32_t count[2] = {0, 0};

    for (int k = 0; k < 2; k++)
        for (uint32_t c = 0; c < w->plane[k]->contour_count; c++) {
            nest_loop *const l = &w->on[k][c];
            l->met = 0;
            /* Only where the loop around it went on as well. */
            l->candidate = l->depth == depth && level[k][l->parent] == depth - 1;
            count[k] += (uint32_t)l->candidate;
        }
    return count[0] < count[1] ? count[0] : count[1];
}

static int nest_are_all_met(const nest_work *w)
{
    for (int k = 0; k < 2; k++)
        for (uint32_t c = 0; c < w->plane[k]->contour_count; c++)
            if (w->on[k][c].candidate && !w->on[k][c].met) return 0;
    return 1;
}

/* Levels of the loops of this depth; *found when some are of a level of their own. */
static bvx_status nest_pair_depth(nest_work *w, uint8_t *const level[2], uint32_t depth, int *found)
{
    *found = 0;
    if (depth < NESTING_DEEPEST && nest_choose_candidates(w, level, depth) != 0) {
        /* Points first: they settle most pairs without a segment. */
        nest_meet_by_points(w);
        if (!nest_are_all_met(w)) BVXI_TRY(nest_meet_by_segments(w));
    }

    for (int k = 0; k < 2; k++)
        for (uint32_t c = 0; c < w->plane[k]->contour_count; c++) {
            const nest_loop *const l = &w->on[k][c];
            if (l->depth != depth) continue;
            /* What does not go on stays on the level of the loop around it. */
            level[k][c] = l->candidate && l->met ? (uint8_t)depth : level[k][l->parent];
            *found |= l->candidate && l->met;
        }
    return BVX_OK;
}

static void nest_follow_parents(const nest_work *w, uint8_t *const level[2], uint32_t depth)
{
    for (int k = 0; k < 2; k++)
        for (uint32_t c = 0; c < w->plane[k]->contour_count; c++)
            if (w->on[k][c].depth == depth) level[k][c] = level[k][w->on[k][c].parent];
}

/* Between a plane and the next one. */
static bvx_status nest_find_between(nest_work *w, uint32_t number)
{
    bvxi_stack *const s = w->s;
    bvxi_nesting *const n = &s->nesting;
    uint8_t *level[2];
    uint32_t deepest = 0;
    int found = 1;

    n->count[number] = 1;
    for (uint32_t k = 0; k < 2; k++) {
        uint64_t const first = (uint64_t)(s->plane[number + k].contour - s->all.contour);
        w->plane[k] = &s->plane[number + k];
        w->on[k] = w->loop + first;
        level[k] = n->level[k] + first;
        for (uint32_t c = 0; c < w->plane[k]->contour_count; c++) {
            level[k][c] = 0;
            w->on[k][c].candidate = w->on[k][c].met = 0;
            if (w->on[k][c].depth > deepest) deepest = w->on[k][c].depth;
        }
    }
    if (n->joined[number] == BVXI_LEVELS_JOINED) return BVX_OK;

    /* A depth at which nothing goes on ends the search: what lies deeper stays on the levels found. */
    for (uint32_t depth = 1; depth <= deepest; depth++) {
        if (found) BVXI_TRY(nest_pair_depth(w, level, depth, &found));
        else nest_follow_parents(w, level, depth);
        if (found) n->count[number] = (uint8_t)(depth + 1);
    }
    return BVX_OK;
}

static bvx_status nest_find_all(nest_work *w)
{
    bvxi_stack *const s = w->s;

    for (uint32_t i = 0; i < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "nesting", 0.5 * i / s->plane_count));
        nest_find_parents(&s->plane[i], w->loop + (s->plane[i].contour - s->all.contour));
    }
    for (uint32_t i = 0; i + 1 < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "nesting", 0.5 + 0.5 * i / s->plane_count));
        BVXI_TRY(nest_find_between(w, i));
    }
    return BVX_OK;
}

/* ---- memory ---- */

static uint32_t nest_most_segments(const bvxi_stack *s)
{
    uint32_t most = 0;

    for (uint32_t i = 0; i + 1 < s->plane_count; i++) {
        uint32_t const n = s->plane[i].point_count + s->plane[i + 1].point_count;
        if (n > most) most = n;
    }
    return most;
}

bvx_status bvxi_nesting_find(bvxi_stack *s)
{
    uint64_t const loops = s->all.contour_room * sizeof(nest_loop), n = nest_most_segments(s);
    nest_work w;

    if (s->nesting.count == NULL) return BVX_OK;
    memset(&w, 0, sizeof w);
    w.s = s;
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, loops, "the nesting of loops", &w.loop));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 8, "the order of segments", &w.key));
    BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 4, "the order of segments", &w.order));
    for (int k = 0; k < 2; k++)
        BVXI_TRY(bvxi_alloc(s->ctx, BVXI_SCRATCH, n * 4, "the segments that reach on", &w.active[k]));
    return nest_find_all(&w);
}

/* Stacks without holes, and those of fields, have no levels. */
bvx_status bvxi_nesting_open(bvxi_stack *s)
{
    bvxi_nesting *const n = &s->nesting;

    if (s->report.holes == 0 || s->options.slabs.crossings != BVX_CROSSINGS_EXACT) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, s->plane_count, "the levels of loops", &n->count));
    BVXI_TRY(bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, s->plane_count, "the levels of loops", &n->joined));
    for (int k = 0; k < 2; k++)
        BVXI_TRY(
            bvxi_alloc_zero(s->ctx, BVXI_SCRATCH, s->all.contour_room, "the levels of loops", &n->level[k]));
    return BVX_OK;
}
