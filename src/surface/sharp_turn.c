/* sharp_turn.c - the last pass over sharp edges: an edge between two fans is flipped where it runs better
 * from apex to apex, as a sharp edge does. Source and method: sharp.c. */
#include "surface/sharp.h"

/* A turned side must follow its facets better by this, or flat places would
 * turn by rounding. [Units: cosines] */
#define LEAST_GAIN (1.0 / 64.0)

/* The kept loop of the cell at x of a slot, where it is the cell's only one; else NULL. */
static bvxi_sharp_loop *sharp_loop_alone(const bvxi_sharp_work *w, uint64_t slot, int32_t x)
{
    /* Loops lie in the order of cells: by bisection. */
    uint32_t low = w->first[slot], high = w->first[slot + 1];

    while (low < high) {
        uint32_t const middle = low + (high - low) / 2;
        if (w->loops[middle].x < x) low = middle + 1;
        else high = middle;
    }
    if (low == w->first[slot + 1] || w->loops[low].x != x || !w->loops[low].alone || !w->loops[low].kept)
        return NULL;
    return &w->loops[low];
}

bvxi_sharp_loop *bvxi_sharp_beside(const bvxi_sharp_work *w, uint64_t slot, int32_t x, int32_t face)
{
    uint64_t const rows = (uint64_t)w->march->grid->size[1] + 1;
    uint64_t const step = face >> 1 == 0 ? 0 : face >> 1 == 1 ? 1 : rows;
    int32_t const up = face & 1;
    /* The neighbour across y and z lies in another row. */
    if (face >> 1 == 0) x += up ? 1 : -1;
    /* a cell with a cut face has a neighbour there */
    return sharp_loop_alone(w, up ? slot + step : slot - step, x);
}

/* How far the worse of two triangles follows facets at its vertices a and b; the apexes have none. */
static double follows(const double n[3], const double facet[3], double worst)
{
    double const cosine = bvxi_vec_dot(n, facet);
    return cosine < worst ? cosine : worst;
}

/* Would the fans' side from a to b, seen from the cell of apex p, better
 * run from apex p to the neighbour's q? */
static int better_turned(const bvxi_sharp_work *w, uint32_t a, uint32_t b, const double p[3],
                         const double q[3])
{
    double const unit = w->cuts->unit;
    double at[3], bt[3], na[3], nb[3], n[3], keep = 1.0, turn = 1.0;

    if (!bvxi_sharp_normal(w, a, na) || !bvxi_sharp_normal(w, b, nb)) return 0;
    bvxi_sharp_vertex(w->march, a, at);
    bvxi_sharp_vertex(w->march, b, bt);

    /* A triangle without area has no side: then nothing is turned. */
    if (!bvxi_normal_of(at, bt, p, unit, n)) return 0;
    keep = follows(n, nb, follows(n, na, keep));
    if (!bvxi_normal_of(bt, at, q, unit, n)) return 0;
    keep = follows(n, nb, follows(n, na, keep));
    if (!bvxi_normal_of(at, q, p, unit, n)) return 0;
    turn = follows(n, na, turn);
    if (!bvxi_normal_of(bt, p, q, unit, n)) return 0;
    turn = follows(n, nb, turn);
    return turn > 0.0 && turn > keep + LEAST_GAIN;
}

/* The sides of a loop on the faces towards +x, +y, +z. */
static uint64_t turn_sides(const bvxi_sharp_work *w, uint64_t slot, const bvxi_cell_walk *c,
                           bvxi_sharp_loop *s)
{
    bvxi_cell_loops loops;
    const bvxi_cell_loop *const l = &loops.loop[0];
    uint64_t count = 0;

    bvxi_trace_walked(c, &loops);
    for (int32_t i = 0; i < l->corners; i++) {
        int32_t const next = i + 1 < l->corners ? i + 1 : 0;
        int32_t const face = bvxi_face_of_edges(l->edge[i], l->edge[next]);
        const bvxi_sharp_loop *beside;
        /* Each face is decided once, by the cell on its negative side. */
        if ((face & 1) == 0 || bvxi_face_is_cut_twice(c->cell_case, face)) continue;
        beside = bvxi_sharp_beside(w, slot, c->x, face);
        if (beside == NULL || !better_turned(w, l->vertex[i], l->vertex[next], s->apex, beside->apex))
            continue;
        s->turned = (uint8_t)(s->turned | 1u << (face >> 1));
        count++;
    }
    return count;
}

void bvxi_sharp_turn_piece(void *work, int32_t piece, int32_t worker)
{
    bvxi_sharp_work *const w = work;
    uint64_t begin, end, count = 0;

    (void)worker;
    bvxi_piece(w->march->slot_count, w->march->pieces, piece, &begin, &end);
    for (uint64_t s = begin; s < end; s++) {
        bvxi_cell_walk c;
        /* No sharp cell in this row. */
        if (w->first[s + 1] == w->first[s]) continue;
        for (bvxi_start_cells(w->march, s, &c); bvxi_next_cell(&c);) {
            bvxi_sharp_loop *const here = sharp_loop_alone(w, s, c.x);
            if (here != NULL) count += turn_sides(w, s, &c, here);
        }
    }
    w->counts[piece] = count;
}
