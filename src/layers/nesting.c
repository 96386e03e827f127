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
#include "nearest/closest.h"

#include <math.h>

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

/* Levels of the loops of this depth; *found when some are of a level of their own. */
static bvx_status nest_pair_depth(nest_work *w, uint8_t *const level[2], uint32_t depth, int goes_on,
                                  int *found)
{
    int all_met = 1;

    *found = 0;
    if (goes_on && depth < NESTING_DEEPEST && nest_choose_candidates(w, level, depth) != 0) {
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

/* ---- a level as a plane ---- */

/* It shares points, crossings and ring with its section. A level of holes is turned: what its loops enclose is
 * outside, so they run with the inside on their left and triangles face as the body's do. */

static uint32_t nest_contour_of_arc(const bvxi_plane *p, const bvxi_arc *arc)
{
    return bvxi_contour_of(p, arc->from == BVXI_NONE ? arc->point : p->cut[arc->from].segment);
}

static bvx_status nest_open_level(const bvxi_stack *s, bvxi_plane *p, const uint8_t *level, uint32_t number,
                                  uint32_t **segment)
{
    static const char what[] = "the levels of loops";
    uint32_t segments = 0, arcs = 0;

    for (uint32_t c = 0; c < p->contour_count; c++)
        if (level[c] == number) segments += p->whole->contour[c].count;
    for (uint32_t i = 0; i < p->arc_count; i++)
        arcs += level[nest_contour_of_arc(p->whole, &p->whole->arc[i])] == number;
    BVXI_TRY(bvxi_plane_open_tree(s->ctx, p, segments));
    BVXI_TRY(BVXI_ARRAY(s->ctx, p->contour_count, what, p->contour));
    BVXI_TRY(BVXI_ZEROS(s->ctx, bvxi_stack_words(s), what, p->inside));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arcs, what, p->arc));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arcs, what, p->ring_arc));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arcs, what, p->arc_cell));
    BVXI_TRY(BVXI_ARRAY(s->ctx, arcs, what, p->asking));
    BVXI_TRY(BVXI_ARRAY(s->ctx, segments, what, *segment));
    p->segment = *segment;
    return BVX_OK;
}

/* A part that ends before the next section does so here too, unless one of its holes goes on. */
static void nest_copy_loops(bvxi_plane *p, const uint8_t *level, uint32_t number, uint32_t *part)
{
    const bvxi_plane *const whole = p->whole;
    memcpy(p->contour, whole->contour, whole->contour_count * sizeof *p->contour);
    p->ends[0] = p->ends[1] = 0;
    if (!whole->ends[0] && !whole->ends[1]) return;
    bvxi_plane_parts(whole, part);
    for (uint32_t c = 0; c < p->contour_count; c++) {
        if (level[c] == level[part[c]]) continue;
        for (uint32_t i = 0; i < p->contour_count; i++)
            if (part[i] == part[c]) p->contour[i].end[0] = p->contour[i].end[1] = 0.0;
    }
    for (uint32_t c = 0; c < p->contour_count; c++)
        for (int k = 0; k < 2; k++) p->ends[k] |= level[c] == number && p->contour[c].end[k] > 0.0;
}

static void nest_fill_level(const bvxi_stack *s, bvxi_plane *p, const uint8_t *level, uint32_t number,
                            uint32_t *segment)
{
    const bvxi_plane *const whole = p->whole;

    p->segment_count = p->arc_count = p->asking_count = 0;
    for (uint32_t c = 0; c < p->contour_count; c++)
        for (uint32_t i = 0; i < p->contour[c].count && level[c] == number; i++)
            segment[p->segment_count++] = p->contour[c].first + i;

    for (uint32_t i = 0; i < whole->arc_count; i++) {
        if (level[nest_contour_of_arc(whole, &whole->arc[i])] != number) continue;
        p->arc[p->arc_count] = whole->arc[i];
        p->arc_cell[p->arc_count++] = whole->arc_cell[i];
    }

    bvxi_plane_look_at_cells(s, p);

    /* Each crossing of a line of one v turns the grid points beyond it, and is the end of one arc. */
    for (uint32_t i = 0; i < p->arc_count; i++) {
        const bvxi_line_cut *const c = &p->cut[p->arc[i].to];
        uint32_t const bit = (p->arc_cell[i] & 0xffff) + 1;
        /* Loops inside a cell and crossings of the other axis turn no row. */
        if (p->arc[i].from == BVXI_NONE || c->axis != 1) continue;
        p->inside[(size_t)(c->line >> s->fine) * (size_t)s->words + (bit >> 6)] ^= UINT64_C(1) << (bit & 63);
    }
    bvxi_plane_fill_rows(s, p->inside);
    for (uint64_t i = 0; i < bvxi_stack_words(s) && p->turned; i++) p->inside[i] = ~p->inside[i];

    bvxi_plane_tree(p);
}

bvx_status bvxi_nesting_make(bvxi_stack *s)
{
    bvxi_nesting *const n = &s->nesting;
    uint64_t most = 0, planes = 0;
    uint32_t *part = NULL;

    if (n->count == NULL) return BVX_OK;
    for (uint32_t i = 0; i < s->plane_count; i++) {
        if (i + 1 < s->plane_count && n->count[i] > 1) planes += 2 * (uint64_t)n->count[i];
        if (s->plane[i].contour_count > most) most = s->plane[i].contour_count;
    }
    if (planes == 0) return BVX_OK;

    BVXI_TRY(BVXI_ARRAY(s->ctx, planes, "the levels of loops", n->plane));
    BVXI_TRY(BVXI_ARRAY(s->ctx, most, "the parts of sections", part));
    for (uint32_t i = 0; i + 1 < s->plane_count; i++)
        for (uint32_t level = 0; level < n->count[i] && n->count[i] > 1; level++)
            /* Below the level, between its section and the one above, then above it. */
            for (uint32_t k = 0; k < 2; k++) {
                bvxi_plane *const whole = &s->plane[i + k], *const p = &n->plane[n->plane_count++];
                const uint8_t *const of = n->level[k] + (whole->contour - s->all.contour);
                uint32_t *segment;

                *p = *whole;
                p->whole = whole;
                p->turned = (int)(level & 1);
                BVXI_TRY(nest_open_level(s, p, of, level, &segment));
                nest_copy_loops(p, of, level, part);
                nest_fill_level(s, p, of, level, segment);
            }
    return BVX_OK;
}

void bvxi_nesting_refresh(bvxi_plane *p)
{
    const bvxi_plane *const whole = p->whole;
    if (whole == NULL) return;
    p->cut = whole->cut;
    p->cut_count = whole->cut_count;
    p->ring_count = whole->ring_count;
    p->vertex = whole->vertex;
}

/* ---- levels that cross ---- */

/* A wall much thinner than a cell may turn within it, and triangles of one level reach through another's. Only
 * cells with triangles of several levels are looked at; all pairs of these are tested exactly. */

#define NEST_SPARE 1e-6 /* of a cell: more than rounding moves a vertex */

typedef struct nest_mesh {
    bvxi_stack *s;
    const bvxi_slab *slab;
    uint32_t count;
    uint64_t *seen, *shared; /* cells with triangles of one level, of several; rows of words */
    double *position;        /* of the triangles that were kept, three each */
    uint32_t *owner;         /* their slabs */
    uint64_t triangles, room;
} nest_mesh;

static const double *nest_slab_vertex(const nest_mesh *m, const bvxi_slab *slab, uint32_t v)
{
    uint64_t const rings = m->s->mesh.vertex_count;
    return v < rings ? m->s->mesh.position + 3 * (uint64_t)v : slab->mesh.position + 3 * (v - rings);
}

/* The cells that a triangle lies in or touches: first and last of both axes. */
static void nest_cells_of_triangle(const nest_mesh *m, const bvxi_slab *slab, uint64_t triangle,
                                   int32_t first[2], int32_t last[2])
{
    const bvxi_stack *const s = m->s;

    for (int k = 0; k < 2; k++) {
        double low = 1e300, high = -1e300;
        for (int c = 0; c < 3; c++) {
            const double *const p = nest_slab_vertex(m, slab,
                                                     slab->mesh.triangle[3 * triangle + (uint64_t)c]);
            double const at = (bvxi_along_axis(s->axis[k], p) - s->origin[k]) / s->step[k];
            bvxi_widen(&low, &high, &at, 1);
        }
        /* A little wider, as vertices on a border belong to both cells. */
        low = floor(low - NEST_SPARE);
        high = floor(high + NEST_SPARE);
        first[k] = low > 0.0 ? (int32_t)low : 0;
        last[k] = high < s->size[k] - 1 ? (int32_t)high : s->size[k] - 1;
    }
}

/* A cell becomes one of several levels when an earlier level of its slab was there. */
static void nest_mark_cells(nest_mesh *m, const bvxi_slab *slab, uint64_t *own)
{
    uint64_t const words = (uint64_t)m->s->size[1] * (uint64_t)m->s->words;

    memset(own, 0, (size_t)words * 8);
    for (uint64_t t = 0; t < slab->mesh.triangle_count; t++) {
        int32_t first[2], last[2];
        nest_cells_of_triangle(m, slab, t, first, last);
        for (int32_t j = first[1]; j <= last[1]; j++)
            for (int32_t i = first[0]; i <= last[0]; i++)
                own[(size_t)j * (size_t)m->s->words + (size_t)(i >> 6)] |= UINT64_C(1) << (i & 63);
    }
    for (uint64_t i = 0; i < words; i++) {
        m->shared[i] |= m->seen[i] & own[i];
        m->seen[i] |= own[i];
    }
}

static int nest_is_shared(const nest_mesh *m, const bvxi_slab *slab, uint64_t triangle)
{
    int32_t first[2], last[2];
    nest_cells_of_triangle(m, slab, triangle, first, last);
    for (int32_t j = first[1]; j <= last[1]; j++)
        for (int32_t i = first[0]; i <= last[0]; i++)
            if ((m->shared[(size_t)j * (size_t)m->s->words + (size_t)(i >> 6)] >> (i & 63) & 1) != 0)
                return 1;
    return 0;
}

static bvx_status nest_keep_triangle(nest_mesh *m, uint32_t number, uint64_t triangle)
{
    const bvxi_slab *const slab = &m->slab[number];
    BVXI_TRY(BVXI_GROW_BESIDE(m->s, m->position, m->triangles, m->room, 72, "the surfaces of levels"));
    BVXI_TRY(BVXI_GROW(m->s, m->owner, m->triangles, m->room, "the surfaces of levels"));
    for (int c = 0; c < 3; c++)
        memcpy(m->position + 9 * m->triangles + 3 * c,
               nest_slab_vertex(m, slab, slab->mesh.triangle[3 * triangle + (uint64_t)c]), 24);
    m->owner[m->triangles++] = number;
    return BVX_OK;
}

/* Mark the slabs in which triangles of two levels cross; within one level they are the cells' matter. */
static void nest_mark_pairs(const nest_mesh *m, const uint32_t *pairs, uint64_t count, uint32_t *found)
{
    uint8_t *const joined = m->s->nesting.joined;

    for (uint64_t i = 0; i < count; i++) {
        const bvxi_slab *const a = &m->slab[m->owner[pairs[2 * i]]];
        const bvxi_slab *const b = &m->slab[m->owner[pairs[2 * i + 1]]];
        if (a->below != b->below || a->level == b->level || joined[a->below] >= BVXI_LEVELS_CROSSED) continue;
        joined[a->below] |= BVXI_LEVELS_CROSSED;
        ++*found;
    }

    /* A cubic blend gives way to the linear one first; levels that cross even then are joined. */
    for (uint32_t i = 0; i < m->s->plane_count; i++) {
        int const was_cubic = m->s->cubic && joined[i] == BVXI_LEVELS_CROSSED;
        if (joined[i] >= BVXI_LEVELS_CROSSED) joined[i] = was_cubic ? BVXI_LEVELS_LINEAR : BVXI_LEVELS_JOINED;
    }
}

bvx_status bvxi_nesting_crossed(bvxi_stack *s, const bvxi_slab *slabs, uint32_t count, uint32_t *found)
{
    uint64_t const cells = (uint64_t)s->size[1] * (uint64_t)s->words;
    nest_mesh m = {.s = s, .slab = slabs, .count = count};
    bvx_mesh_view view = {0}; /* corner by corner: vertices at one place are one there */
    uint32_t *pairs;
    uint64_t *own, crossings;

    *found = 0;
    if (s->nesting.plane_count == 0) return BVX_OK;
    BVXI_TRY(BVXI_ARRAY(s->ctx, cells, "the cells of levels", m.seen));
    BVXI_TRY(BVXI_ARRAY(s->ctx, cells, "the cells of levels", m.shared));
    BVXI_TRY(BVXI_ARRAY(s->ctx, cells, "the cells of levels", own));

    for (uint32_t i = 0, end; i < m.count; i = end) {
        end = i + 1;
        if (m.slab[i].plane[0]->whole == NULL) continue;
        while (end < m.count && m.slab[end].below == m.slab[i].below) end++;

        BVXI_TRY(bvxi_progress(m.s->ctx, "levels", 0.5 * (double)i / m.count));
        memset(m.seen, 0, (size_t)cells * 8);
        memset(m.shared, 0, (size_t)cells * 8);
        for (uint32_t k = i; k < end; k++) nest_mark_cells(&m, &m.slab[k], own);
        for (uint32_t k = i; k < end; k++)
            for (uint64_t t = 0; t < m.slab[k].mesh.triangle_count; t++)
                if (nest_is_shared(&m, &m.slab[k], t)) BVXI_TRY(nest_keep_triangle(&m, k, t));
    }

    if (m.triangles == 0) return BVX_OK;
    view.positions = m.position;
    view.vertex_count = 3 * m.triangles;
    view.triangle_count = m.triangles;
    view.position_type = BVX_F64;

    BVXI_TRY(
        BVXI_SHARE(s->ctx, 0.5, 1.0, bvxi_crossing_pairs(s->ctx, &view, UINT64_MAX, &pairs, &crossings)));
    nest_mark_pairs(&m, pairs, crossings, found);
    return BVX_OK;
}
