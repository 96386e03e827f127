/* field_cuts.c - vertices put where a field of closest points cuts their edges.
 *
 * Rows of vertices are walked as marching cubes numbered them, and the values of the two or three rows of
 * centres beside them are numbered on the way: a popcount a word, no search for any edge. What a vertex gets
 * depends on the values at the ends of its own edge only. Where the surface is that of two bodies together,
 * each has values of its own, and an edge is cut by the one whose side changes on it. Where it is that of one
 * body changed, edges on which the body's side does not change are cut at a distance from it, or in the
 * middle. */
#include "surface/cells.h"
#include "surface/field_surface.h"

#include <math.h>

#define NO_VALUE UINT64_MAX

/* A row of centres: which have values, and the first value's number at or beyond the walk's word. */
typedef struct value_row {
    const uint64_t *words; /* NULL outside the window */
    uint64_t next;
} value_row;

typedef struct cut_walk {
    const bvxi_cuts *cuts;
    value_row row[2][3]; /* of each body: (j, k), (j+1, k), (j, k+1) */
    int32_t bodies;
    int32_t j, k, w;
    uint64_t count[BVXI_CUT_KINDS];
    uint64_t own;                                 /* cuts that are not the body's */
    bvxi_missing_edge missing[BVXI_MISSING_MOST]; /* asked together */
    uint64_t missing_vertex[BVXI_MISSING_MOST];
    int32_t missing_count;
} cut_walk;

static value_row start_value_row(const bvxi_cuts *c, const bvxi_cut_rule *v, int32_t j, int32_t k)
{
    const bvx_grid *const g = &v->values->where;
    value_row r = {NULL, 0};
    /* Where no value is needed the row has no words, and every look-up in it answers that there is none. */
    if ((c->interpolation != BVX_EDGE_MIDDLE || c->planes != NULL) && j >= 0 && k >= 0 && j < g->size[1] &&
        k < g->size[2]) {
        uint64_t const n = (uint64_t)k * (uint64_t)g->size[1] + (uint64_t)j;
        r.words = g->words + n * (uint64_t)g->words_per_row;
        r.next = v->values->first[n];
    }
    return r;
}

/* Number of the value at a bit of word w, or NO_VALUE. */
static uint64_t value_at(const value_row *r, int32_t words, int32_t w, int32_t bit)
{
    if (r->words == NULL || w >= words || (r->words[w] >> bit & 1) == 0) return NO_VALUE;
    return r->next + bvxi_popcount(r->words[w] & ((UINT64_C(1) << bit) - 1));
}

/* The same one centre before. */
static uint64_t value_before(const value_row *r, int32_t words, int32_t w, int32_t bit)
{
    if (bit > 0) return value_at(r, words, w, bit - 1);
    if (r->words == NULL || w == 0 || r->words[w - 1] >> 63 == 0) return NO_VALUE;
    /* The last bit of the word before: the walk's count at a word's begin is one past its value. */
    return r->next - 1;
}

static double read_value(const bvxi_sparse *s, const void *values, uint64_t n)
{
    return s->value_type == BVX_F32 ? (double)((const float *)values)[(size_t)n]
                                    : ((const double *)values)[(size_t)n];
}

static double read_end(const bvxi_sparse *v, uint64_t n, double vector[3])
{
    for (uint64_t a = 0; a < 3; a++)
        vector[a] = v->vectors != NULL ? read_value(v, v->vectors, 3 * n + a) : 0.0;
    if (v->distances == NULL)
        return sqrt(vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]);
    double const d = read_value(v, v->distances, n);
    return d < 0 ? -d : d;
}

static int is_inside(const bvxi_march *m, int32_t i, int32_t j, int32_t k)
{
    if (i < 0 || i >= m->grid->size[0]) return 0;
    return (int)(bvxi_march_row(m, j, k)[i >> 6] >> (i & 63) & 1);
}

/* 1 when a centre is inside a body; beyond the window is outside. */
static int is_in_body(const bvx_grid *inside, int32_t i, int32_t j, int32_t k)
{
    if (i < 0 || j < 0 || k < 0 || i >= inside->size[0] || j >= inside->size[1] || k >= inside->size[2])
        return 0;
    return bvx_grid_get(inside, i, j, k);
}

/* Whether the ends of the edge from centre (i, j, k) along axis differ in a body. */
static int changes_side(const bvx_grid *inside, int32_t axis, int32_t i, int32_t j, int32_t k)
{
    return is_in_body(inside, i, j, k) !=
           is_in_body(inside, i + (axis == 0), j + (axis == 1), k + (axis == 2));
}

/* The edge from centre (i, j, k) along axis, whose ends have the values low and high. */
static inline bvxi_cut_edge read_edge(const cut_walk *k, const bvxi_cut_rule *v, int32_t axis, int32_t i,
                                      uint64_t low, uint64_t high)
{
    const bvxi_march *const m = k->cuts->march;
    bvxi_cut_edge edge;
    edge.axis = axis;
    edge.length = m->spacing[axis];
    edge.high_inside = !is_inside(m, i, k->j, k->k);
    edge.value[0] = low;
    edge.value[1] = high;
    edge.low_distance = read_end(v->values, low, edge.low);
    edge.high_distance = read_end(v->values, high, edge.high);
    return edge;
}

static double ratio_on_edge(double t)
{
    return bvxi_keep_off_ends(t >= 0.0 && t <= 1.0 ? t : 0.5);
}

/* ---- Edges that no value tells of ---- */

static void place_missing_cuts(cut_walk *k)
{
    const bvxi_cut_rule *const v = k->cuts->values;
    double t[BVXI_MISSING_MOST];
    if (k->missing_count == 0) return;
    v->missing(v->missing_user, k->missing_count, k->missing, t);
    for (int32_t n = 0; n < k->missing_count; n++) {
        const bvxi_missing_edge *const e = &k->missing[n];
        bvxi_put_crossing(k->cuts->march, k->missing_vertex[n], e->axis, e->at[0], e->at[1], e->at[2],
                          ratio_on_edge(t[n]));
    }
    k->missing_count = 0;
}

typedef struct placed_cut {
    double t;
    int32_t by;                 /* BVXI_CUT_...; LID: t is not known yet */
    bvxi_facet_plane planes[2]; /* where they are requested */
} placed_cut;

/* The cut of the edge from centre (i, j, k) along axis by a body that has
 * the values low and high at its ends. */
static void find_body_cut(const cut_walk *k, const bvxi_cut_rule *v, int32_t axis, int32_t i, uint64_t low,
                          uint64_t high, placed_cut *cut)
{
    const bvxi_cuts *const c = k->cuts;
    int const known = low != NO_VALUE && high != NO_VALUE;
    bvxi_cut_edge edge;

    cut->by = BVXI_CUT_MIDDLE;
    cut->t = 0.5;
    if (known) {
        edge = read_edge(k, v, axis, i, low, high);
        cut->by = bvxi_find_cut(&edge, c->interpolation, &cut->t);
    }
    if (c->planes != NULL) memset(cut->planes, 0, sizeof cut->planes);

    /* A surface that crosses an edge is no further from both ends together than the edge is long. Where none is so
     * near, what crosses it is a lid over a hole. Its position follows from the winding number, which is dear and
     * therefore requested many edges together. */
    if (v->missing != NULL && c->interpolation != BVX_EDGE_MIDDLE &&
        (!known || edge.low_distance + edge.high_distance > edge.length * (1.0 + 1e-6))) {
        bvxi_missing_edge const alone = {axis, {i, k->j, k->k}};
        cut->by = BVXI_CUT_LID;
        if (k->bodies == 1) return;
        /* Of two bodies the cuts are compared at once. */
        v->missing(v->missing_user, 1, &alone, &cut->t);
        cut->t = ratio_on_edge(cut->t);
        return;
    }

    /* Strictly inside the edge, whatever the values say: the tables' guarantee needs it. */
    cut->t = ratio_on_edge(cut->t);
    if (c->planes != NULL && known) {
        const bvx_grid *const g = c->march->grid;
        int32_t const at[3] = {i, k->j, k->k};
        double centre[3];
        for (int32_t a = 0; a < 3; a++)
            centre[a] = g->lattice.origin[a] + ((double)(g->low[a] + at[a]) + 0.5) * g->lattice.spacing[a];
        cut->t = bvxi_facet_cut(c, v, &edge, centre, cut->t, cut->planes);
    }
}

/* An end on one side of the body by the surface at a depth under it, or above it, in place of the body's. */
static void move_end(double depth, double vector[3], double *distance)
{
    double const share = (*distance - depth) / *distance;
    for (int32_t a = 0; a < 3; a++) vector[a] *= share;
    *distance = *distance < depth ? depth - *distance : *distance - depth;
}

/* The cut of an edge off the body with values low and high at its ends: by the offset, if between. */
static void find_own_cut(const cut_walk *k, const bvxi_cut_rule *v, int32_t axis, int32_t i, uint64_t low,
                         uint64_t high, placed_cut *cut)
{
    double const depth = v->offset < 0.0 ? -v->offset : v->offset;

    cut->t = 0.5;
    cut->by = BVXI_CUT_MIDDLE;
    memset(cut->planes, 0, sizeof cut->planes);
    if (depth == 0.0 || low == NO_VALUE || high == NO_VALUE) return;

    /* Both ends are on the offset's side of the body: they are so together, as the edge is not the body's. */
    if (is_in_body(v->inside, i, k->j, k->k) != (v->offset < 0.0)) return;
    bvxi_cut_edge edge = read_edge(k, v, axis, i, low, high);
    if ((edge.low_distance < depth) == (edge.high_distance < depth)) return;

    /* A centre on the body itself has no direction to move in. */
    if (edge.low_distance == 0.0 || edge.high_distance == 0.0) {
        cut->t = (depth - edge.low_distance) / (edge.high_distance - edge.low_distance);
        cut->by = BVXI_CUT_SCALAR;
    } else {
        move_end(depth, edge.low, &edge.low_distance);
        move_end(depth, edge.high, &edge.high_distance);
        cut->by = bvxi_find_cut(&edge, k->cuts->interpolation, &cut->t);
    }
    cut->t = ratio_on_edge(cut->t);
}

/* The vertex on the edge from centre (i, j, k) along axis, whose ends have
 * the values low and high of each body. */
static void place_cut(cut_walk *k, uint64_t vertex, int32_t axis, int32_t i, const uint64_t low[2],
                      const uint64_t high[2])
{
    const bvxi_cuts *const c = k->cuts;
    const bvxi_cut_rule *const v = c->values;
    int const first = v->inside == NULL || changes_side(v->inside, axis, i, k->j, k->k);
    placed_cut cut;

    if (first) find_body_cut(k, v, axis, i, low[0], high[0], &cut);
    else if (k->bodies == 1) {
        find_own_cut(k, v, axis, i, low[0], high[0], &cut);
        k->own++;
    }
    if (k->bodies == 2 && changes_side(v->second->inside, axis, i, k->j, k->k)) {
        /* Coming from inside, a union is left where the last of its bodies is left, an intersection where the
         * first is; coming from outside it is the other way. */
        int const later = is_inside(c->march, i, k->j, k->k) == (v->outer != 0);
        placed_cut other;
        find_body_cut(k, v->second, axis, i, low[1], high[1], &other);
        if (!first || (later ? other.t > cut.t : other.t < cut.t)) cut = other;
    }
    k->count[cut.by]++;
    if (c->planes != NULL) memcpy(&c->planes[2 * vertex], cut.planes, sizeof cut.planes);
    if (cut.by == BVXI_CUT_LID && k->bodies == 1) {
        bvxi_missing_edge *const e = &k->missing[k->missing_count];
        e->axis = axis;
        e->at[0] = i;
        e->at[1] = k->j;
        e->at[2] = k->k;
        k->missing_vertex[k->missing_count++] = vertex;
        if (k->missing_count == BVXI_MISSING_MOST) place_missing_cuts(k);
    } else bvxi_put_crossing(c->march, vertex, axis, i, k->j, k->k, cut.t);
}

static void place_slot(cut_walk *k, uint64_t slot)
{
    const bvxi_cuts *const c = k->cuts;
    const bvxi_march *const m = c->march;
    const bvxi_slot *const s = &m->slots[slot];
    uint64_t vertex[3] = {s->edge[0], s->edge[1], s->edge[2]};
    int32_t const words = m->grid->words_per_row;
    const uint64_t *row[4];

    if (s[1].edge[0] == s->edge[0]) return;
    bvxi_slot_row(m, slot, &k->j, &k->k);
    bvxi_cell_rows(m, k->j, k->k, row);
    for (int32_t b = 0; b < k->bodies; b++)
        for (int32_t r = 0; r < 3; r++)
            k->row[b][r] = start_value_row(c, b == 0 ? c->values : c->values->second, k->j + (r == 1),
                                           k->k + (r == 2));

    /* Masks in the same order as when vertices were numbered, so that vertex[axis] counts along. */
    for (int32_t w = 0; w < m->edge_words; w++) {
        uint64_t mask[3];
        bvxi_cell_words cells;
        bvxi_load_cells(row, w, words, &cells);
        mask[0] = bvxi_slot_has(m, 0, k->j, k->k) ? (cells.low[0] ^ cells.high[0]) & bvxi_visited(m, w) : 0;
        mask[1] = bvxi_slot_has(m, 1, k->j, k->k) ? cells.high[0] ^ cells.high[1] : 0;
        mask[2] = bvxi_slot_has(m, 2, k->j, k->k) ? cells.high[0] ^ cells.high[2] : 0;
        for (int32_t axis = 0; axis < 3; axis++)
            for (uint64_t bits = mask[axis]; bits != 0; bits &= bits - 1) {
                int32_t const bit = bvxi_lowest(bits);
                uint64_t low[2], high[2];
                for (int32_t b = 0; b < k->bodies; b++) {
                    const value_row *const rows = k->row[b];
                    low[b] = axis == 0 ? value_before(&rows[0], words, w, bit)
                                       : value_at(&rows[0], words, w, bit);
                    high[b] = value_at(&rows[axis], words, w, bit);
                }
                place_cut(k, vertex[axis]++, axis, w * 64 + bit - (axis == 0), low, high);
            }

        /* Only now: value_before reads the count of the word that ends here. Most have none. */
        for (int32_t b = 0; b < k->bodies && w < words; b++)
            for (int32_t r = 0; r < 3; r++)
                if (k->row[b][r].words != NULL && k->row[b][r].words[w] != 0)
                    k->row[b][r].next += bvxi_popcount(k->row[b][r].words[w]);
    }
}

void bvxi_cuts_piece(void *cuts, int32_t piece, uint64_t begin, uint64_t end)
{
    const bvxi_cuts *const c = cuts;
    cut_walk k = {0};
    k.cuts = c;
    k.bodies = c->values->second != NULL ? 2 : 1;
    for (uint64_t s = begin; s < end; s++) place_slot(&k, s);
    /* What is still waiting, before the worker's list goes. */
    place_missing_cuts(&k);
    memcpy(c->piece_counts + (BVXI_CUT_KINDS + 1) * (size_t)piece, k.count, sizeof k.count);
    c->piece_counts[(BVXI_CUT_KINDS + 1) * (size_t)piece + BVXI_CUT_KINDS] = k.own;
}
