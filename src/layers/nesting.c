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

enum { NESTING_DEEPEST = 100, NESTING_ABOVE_BIT = 31 };

typedef struct nest_loop {
    int32_t box[4];
    uint32_t depth, parent; /* how many loops it lies in, and the innermost of these */
    int candidate, met;     /* of the depth that is being paired */
} nest_loop;

typedef struct nest_work {
    bvxi_stack *s;
    nest_loop *loop; /* of all planes */
    const bvxi_plane *plane[2];
    nest_loop *on[2];      /* the loops of these planes */
    bvxi_segment_box *box; /* segments of candidates: numbers, with the highest bit for those above */
} nest_work;

/* ---- what lies in what ---- */

static int nest_contains(const bvxi_plane *p, uint32_t number, const nest_loop *loop, const int32_t *at)
{
    const int32_t *const box = loop[number].box;
    return at[0] >= box[0] && at[0] <= box[2] && at[1] >= box[1] && at[1] <= box[3] &&
           bvxi_loop_contains(p, &p->contour[number], at);
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

static bvx_status nest_meet_segments(void *user, uint32_t one, uint32_t two)
{
    nest_work *const w = user;
    uint32_t const j = one >> NESTING_ABOVE_BIT, k = two >> NESTING_ABOVE_BIT;
    uint32_t const i = one & ~(UINT32_C(1) << NESTING_ABOVE_BIT),
                   n = two & ~(UINT32_C(1) << NESTING_ABOVE_BIT);
    const bvxi_plane *const p = w->plane[j], *const o = w->plane[k];
    if (j != k && bvxi_segments_meet(p->q[i], p->q[p->next[i]], o->q[n], o->q[o->next[n]]))
        nest_meet(&w->on[j][bvxi_contour_of(p, i)], &w->on[k][bvxi_contour_of(o, n)]);
    return BVX_OK;
}

static bvx_status nest_meet_by_segments(nest_work *w)
{
    uint32_t count = 0;
    for (uint32_t k = 0; k < 2; k++) {
        const bvxi_plane *const p = w->plane[k];
        for (uint32_t c = 0; c < p->contour_count; c++)
            for (uint32_t i = p->contour[c].first;
                 w->on[k][c].candidate && i < p->contour[c].first + p->contour[c].count; i++)
                w->box[count++] = bvxi_box_segment(p->q[i], p->q[p->next[i]], i | k << NESTING_ABOVE_BIT);
    }
    return bvxi_sweep(w->s->ctx, w->box, count, nest_meet_segments, w);
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
            l->candidate = l->depth == depth && level[k][l->parent] == depth - 1;
            count[k] += (uint32_t)l->candidate;
        }
    return count[0] < count[1] ? count[0] : count[1];
}

/* Levels of the loops of this depth; *found when some are of a level of their own. */
static bvx_status nest_pair_depth(nest_work *w, uint8_t *const level[2], uint32_t depth, int goes_on,
                                  int *found)
{
    int all_met = 1;

    *found = 0;
    if (goes_on && depth < NESTING_DEEPEST && nest_choose_candidates(w, level, depth) != 0) {
        /* Candidates of which one encloses the other's first point. */
        for (uint32_t i = 0; i < w->plane[0]->contour_count; i++)
            for (uint32_t j = 0; j < w->plane[1]->contour_count; j++) {
                nest_loop *const a = &w->on[0][i], *const b = &w->on[1][j];
                if (!a->candidate || !b->candidate || (a->met && b->met)) continue;
                /* A loop within another holds its first point; those that cross are found by their segments. */
                if (nest_contains(w->plane[0], i, w->on[0], w->plane[1]->q[w->plane[1]->contour[j].first]) ||
                    nest_contains(w->plane[1], j, w->on[1], w->plane[0]->q[w->plane[0]->contour[i].first]))
                    nest_meet(a, b);
            }

        for (int k = 0; k < 2; k++)
            for (uint32_t c = 0; c < w->plane[k]->contour_count; c++)
                all_met &= !w->on[k][c].candidate || w->on[k][c].met;
        if (!all_met) BVXI_TRY(nest_meet_by_segments(w));
    }

    for (int k = 0; k < 2; k++)
        for (uint32_t c = 0; c < w->plane[k]->contour_count; c++) {
            const nest_loop *const l = &w->on[k][c];
            if (l->depth != depth) continue;
            /* What does not go on stays on the level of the loop around it. */
            level[k][c] = goes_on && l->candidate && l->met ? (uint8_t)depth : level[k][l->parent];
            *found |= goes_on && l->candidate && l->met;
        }
    return BVX_OK;
}

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
        BVXI_TRY(nest_pair_depth(w, level, depth, found, &found));
        if (found) n->count[number] = (uint8_t)(depth + 1);
    }
    return BVX_OK;
}

bvx_status bvxi_nesting_find(bvxi_stack *s)
{
    nest_work w = {.s = s};
    uint32_t most = 0;

    if (s->nesting.count == NULL) return BVX_OK;
    for (uint32_t i = 0; i + 1 < s->plane_count; i++) {
        uint32_t const n = s->plane[i].point_count + s->plane[i + 1].point_count;
        if (n > most) most = n;
    }
    BVXI_TRY(BVXI_ARRAY(s->ctx, s->all.contour_room, "the nesting of loops", w.loop));
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the order of segments", w.box));
    for (uint32_t i = 0; i < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "nesting", 0.5 * i / s->plane_count));
        nest_find_parents(&s->plane[i], w.loop + (s->plane[i].contour - s->all.contour));
    }
    for (uint32_t i = 0; i + 1 < s->plane_count; i++) {
        BVXI_TRY(bvxi_progress(s->ctx, "nesting", 0.5 + 0.5 * i / s->plane_count));
        BVXI_TRY(nest_find_between(&w, i));
    }
    return BVX_OK;
}

/* Stacks without holes, and those of fields, have no levels. */
bvx_status bvxi_nesting_open(bvxi_stack *s)
{
    bvxi_nesting *const n = &s->nesting;
    if (s->report.holes == 0 || s->options.slabs.crossings != BVX_CROSSINGS_EXACT) return BVX_OK;
    BVXI_TRY(BVXI_ZEROS(s->ctx, s->plane_count, "the levels of loops", n->count));
    BVXI_TRY(BVXI_ZEROS(s->ctx, s->plane_count, "the levels of loops", n->joined));
    for (int k = 0; k < 2; k++)
        BVXI_TRY(BVXI_ZEROS(s->ctx, s->all.contour_room, "the levels of loops", n->level[k]));
    return BVX_OK;
}
