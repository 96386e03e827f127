/* collapse.c - edges that collapse by rising cost, all over the mesh at once.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997. Luebke. A Developer's
 * Survey of Polygonal Simplification Algorithms. 2001.
 *
 * Costs lie beside the edges and are brought up to date by each collapse, so that nothing waits in a queue. A
 * sweep takes the cheapest share of all vertices' edges, in the order of space, and of two edges with a common
 * end the cheaper one: the order of a queue, nearly, in the order of memory.
 *
 * Vertices are cut into ranges, whose number follows from the mesh. Each range collapses on its own, in
 * parallel, what lies in it with all of its neighbours; what reaches into others comes after, one by one. So
 * any number of threads gives the same bits.
 *
 * Guarantee: a mesh that is closed, manifold and oriented stays so, and keeps its handles and borders. Whether
 * triangles cross is judged afterwards (judge.c), which undoes what made them. */
#include "simplify/edge_costs.h"
#include "bits/bits.h"
#include "core/vec3.h"

/* Of all vertices, those whose edges a sweep takes. */
#define SWEEP_SHARE 0.5
/* Times the cost that edges had so far. */
#define DEARER 64.0

enum {
    RANGE_VERTICES = 4096,  /* of a range, at least */
    RANGE_MOST = 20,        /* ranges: more have more edges that reach into others */
    RANGE_COLLAPSES = 4096, /* fewer are not worth ranges */
    BLOCK_VERTICES = 512,   /* at least */
    COST_GRAIN = 8192,      /* vertices whose costs are counted in one piece, at least */
    COST_PIECES = 4,
    SWEEP_AHEAD = 8, /* vertices */
    THRESHOLD_WANTED = 16384,
    THRESHOLD_VERTICES = 8192, /* more are wanted: about so many are looked at, else four times as many */
    THRESHOLD_FEW = 64,        /* the share of those wanted that are the cheapest */
};

/* ---- The star of an edge ---- */

int bvxi_star_gather_side(const bvxi_corners *m, int32_t start, uint32_t other, int32_t most,
                          collapse_star *star)
{
    int32_t c = bvxi_corner_turn_left(m, start);

    star->link[star->count] = bvxi_corner_vertex_of(m, bvxi_corner_next(c));
    for (;;) {
        int32_t const left = bvxi_corner_turn_left(m, c);
        uint32_t const previous = bvxi_corner_vertex_of(m, bvxi_corner_next(left)); /* of both triangles */

        if (previous == other) return 1;
        if (star->count == most) return 0;
        /* Shapes and costs are looked at next, then the triangles beyond the link. */
        if (previous != BVXI_VERTEX_GHOST) {
            BVXI_PREFETCH(&m->at[previous]);
            BVXI_PREFETCH(&m->at[previous].q.b);
        }
        BVXI_PREFETCH(&m->triangle[(uint32_t)bvxi_corner_turn_left(m, bvxi_corner_previous(c)) >> 2]);
        star->corner[star->count++] = c;
        star->link[star->count] = previous;
        c = left;
    }
}

int bvxi_star_close(collapse_star *star)
{
    uint64_t seen = 0;

    /* Fewer would leave two triangles back to back on the same three vertices. */
    if (star->count < 3) return 0;
    star->link[star->count] = star->link[0];

    /* A vertex that is there twice is a neighbour of both ends beside the two that they may share; the ghost
     * is when both ends are on borders and the edge is not. Most differ in their last bits. */
    for (int32_t i = 0; i < star->count; i++) {
        uint64_t const bit = UINT64_C(1) << (star->link[i] & 63);

        for (int32_t j = 0; j < i && (seen & bit) != 0; j++)
            if (star->link[i] == star->link[j]) return 0;
        seen |= bit;
    }
    return 1;
}

/* 0: the collapse would change the topology, or the star is too large. */
static int gather_star(const bvxi_corners *m, const bvxi_edge_planned *plan, collapse_star *star)
{
    int32_t const most = COLLAPSE_STAR, across = bvxi_corner_opposite(m, plan->edge);
    star->count = 0;
    if (!bvxi_star_gather_side(m, bvxi_corner_next(across), plan->u, most, star)) return 0;
    star->of_v = star->count;
    if (!bvxi_star_gather_side(m, bvxi_corner_next(plan->edge), plan->v, star->count + most, star)) return 0;
    return bvxi_star_close(star);
}

/* ---- Collapsing ---- */

/* What one range has done. */
typedef struct collapse_range {
    collapse_star star;
    uint32_t order;
    uint64_t collapsed, triangles; /* that went */
    uint64_t refused;
    uint64_t waiting; /* vertices whose edges reach into other ranges */
} collapse_range;

typedef struct collapse_sweep {
    bvxi_collapse *c;
    collapse_range *range;
    float threshold;
    uint32_t *waiting;   /* vertices, those of each range from its first on */
    uint8_t *cheap;      /* of blocks in place of ranges, 1: a vertex has an edge that cheap */
    uint64_t size;       /* vertices of a range, or of a block */
    uint64_t target;     /* triangles */
    uint64_t left;       /* triangles as the sweep begins */
    uint64_t candidates; /* vertices with an edge that cheap */
    uint64_t needed;     /* collapses */
} collapse_sweep;

int bvxi_collapse_drop_triangle(bvxi_corners *m, int32_t corner)
{
    int32_t const left = bvxi_corner_turn_left(m, corner);
    int32_t const beyond = bvxi_corner_turn_left(m, bvxi_corner_next(corner));
    bvxi_corner_put_left(m, bvxi_corner_next(left), beyond);
    bvxi_corner_put_left(m, bvxi_corner_next(beyond), left);
    m->triangle[corner >> 2].vertex[1] = ~m->triangle[corner >> 2].vertex[1];
    return !bvxi_corner_is_ghost(m, corner);
}

/* The edges of a vertex whose quadric or position is new, and the cheapest of each neighbour. */
static void renew_edges(bvxi_collapse *c, uint32_t u, const collapse_star *star)
{
    bvxi_corners *const m = &c->mesh;
    float least = COLLAPSE_NEVER;
    int32_t best = -1;

    bvxi_edges_evaluate(c, u, star->link, star->corner, star->count);
    for (int32_t i = 0; i < star->count; i++) {
        int32_t const edge = star->corner[i];
        float const cost = bvxi_edge_cost(m, edge);

        if (cost < least) {
            least = cost;
            best = edge;
        }
    }
    c->least[u] = least;
    c->edge[u] = best;

    /* Of the neighbours those whose cheapest edge is another one keep it; at the ends of the link two became one. */
    for (int32_t i = 0; i < star->count; i++) {
        uint32_t const w = star->link[i];
        int32_t const edge = star->corner[i];
        float const cost = bvxi_edge_cost(m, edge);
        int32_t old;

        if (w == BVXI_VERTEX_GHOST) continue;
        old = c->edge[w];
        if (cost < c->least[w]) {
            c->least[w] = cost;
            c->edge[w] = edge;
        } else if (old == edge || old == bvxi_corner_turn_left(m, bvxi_corner_next(edge)) ||
                   ((i == 0 || i == star->of_v) && old >= 0 && bvxi_corner_gone(m, old))) {
            bvxi_edge_find_least(c, w);
        }
    }
}

static void apply(bvxi_collapse *c, const bvxi_edge_planned *plan, const double *p, collapse_range *r)
{
    bvxi_corners *const m = &c->mesh;
    const collapse_star *const star = &r->star;
    uint32_t const u = plan->u, v = plan->v;
    int32_t const across = bvxi_corner_opposite(m, plan->edge);
    collapse_undo *const undo = &c->undo[v];

    memcpy(undo->p, m->at[u].p, sizeof undo->p);
    undo->edge = plan->edge;
    undo->stayed = u;
    undo->before = c->last[u];
    undo->order = r->order++;
    c->last[u] = v;
    c->fresh[u] = 1;

    if (c->attributes.row != NULL) {
        double d[3];

        for (int k = 0; k < 3; k++) d[k] = (p[k] - m->at[u].p[k]) * c->scale;
        bvxi_attributes_merge(c, plan->edge, plan->offset, d, star->corner, star->of_v);
    }
    if (plan->pinches) {
        c->kind[u] = VERTEX_JUNCTION;
        c->kind[v] |= VERTEX_PINCHED;
    }
    bvxi_edge_settle(c, plan, p);
    r->triangles += (uint64_t)bvxi_collapse_drop_triangle(m, plan->edge);
    r->triangles += (uint64_t)bvxi_collapse_drop_triangle(m, across);
    for (int32_t i = 0; i < star->of_v; i++)
        m->triangle[star->corner[i] >> 2].vertex[star->corner[i] & 3] = u;

    /* The apexes of the triangles that went are the ends of both parts of the link. */
    c->any[u] = star->corner[0];
    for (int32_t i = 0; i <= star->of_v; i += star->of_v > 0 ? star->of_v : 1)
        if (star->link[i] != BVXI_VERTEX_GHOST) c->any[star->link[i]] = bvxi_corner_next(star->corner[i]);
    c->least[v] = COLLAPSE_NEVER;
    c->edge[v] = COLLAPSE_GONE;
    r->collapsed++;
    if (c->came != NULL) c->came[u] |= c->came[v];
    for (int32_t i = 0; i < star->count && c->tree.node[0] != NULL; i++)
        if (!bvxi_corner_is_ghost(m, star->corner[i]))
            bvxi_crossing_tree_move(&c->tree, (uint32_t)star->corner[i] >> 2);
    renew_edges(c, u, star);
}

/* 1 when the new vertex would be further from its planes than triangles of the mesh can show as it is now. */
static int is_crumpled(const collapse_sweep *s, const bvxi_edge_planned *plan, const double d[3])
{
    return bvxi_quadric_is_far(s->c, &plan->q, d, s->left, s->c->crumpled);
}

/* May the edge collapse to an offset from u? p becomes the position, rounded as the caller gets it. */
static int judge_at(const collapse_sweep *s, const bvxi_edge_planned *plan, const collapse_star *star,
                    const double d[3], int needles, double p[3])
{
    const bvxi_collapse *const c = s->c;
    const double *const from = c->mesh.at[plan->u].p, *const box = c->options.box;
    for (int k = 0; k < 3; k++) p[k] = bvxi_collapse_rounded(c, from[k] + d[k] / c->scale);
    if (d[0] == 0 && d[1] == 0 && d[2] == 0) memcpy(p, from, 3 * sizeof *p);
    for (int k = 0; box != NULL && k < 3; k++)
        if (p[k] < box[2 * k] || p[k] > box[2 * k + 1]) return 0;
    return bvxi_edge_judge_shapes(c, plan, star, p, needles) &&
           (c->tree.node[0] == NULL ||
            !bvxi_collapse_crosses(c, plan->u, plan->v, star->link, star->count, p));
}

/* Where the best position turns triangles over, the ends and the middle may not, at no more than twice the cost
 * that the edge has, which rises when it is refused. */
static int judge_elsewhere(const collapse_sweep *s, bvxi_edge_planned *plan, const collapse_star *star,
                           double cost, int needles, double p[3])
{
    const double *const offset = plan->offset;

    if (plan->still || s->c->options.given.vertices == BVX_VERTICES_KEPT) return 0;
    for (int i = 0; i < 3; i++) {
        double const d[3] = {0.5 * i * offset[0], 0.5 * i * offset[1], 0.5 * i * offset[2]};

        if (bvxi_quadric_at(&plan->all, d) > 2 * cost) continue;
        memcpy(plan->d, d, sizeof plan->d);
        if (judge_at(s, plan, star, d, needles, p)) return !is_crumpled(s, plan, d);
    }
    return 0;
}

static int in_range(const collapse_sweep *s, uint64_t range, uint32_t v)
{
    return v == BVXI_VERTEX_GHOST || v - range * s->size < s->size;
}

enum { RANGE_ALL = -1 };

/* 1: the vertex of a corner has an edge to another fan of a vertex of the view. */
static int has_edge_to(const bvxi_corners *m, int32_t corner, uint32_t source)
{
    int32_t at = corner;
    do {
        uint32_t const x = bvxi_corner_vertex_of(m, bvxi_corner_next(at));
        if (x != BVXI_VERTEX_GHOST && m->source[x] == source) return 1;
        at = bvxi_corner_turn_left(m, at);
    } while (at != corner);
    return 0;
}

/* 1: vertices of a sheet's border would get an edge or a triangle that another sheet may have too; or a vertex edges to
 * two of these that are one beyond the sheet. */
static int meets_sheets(const bvxi_collapse *c, const bvxi_edge_planned *plan, const collapse_star *star)
{
    const uint32_t *const source = c->mesh.source;
    int const locked = c->kind[plan->u] == VERTEX_LOCKED;

    for (int32_t i = 0; i < star->count && c->options.sheets; i++) {
        uint32_t const x = star->link[i];

        if (x == BVXI_VERTEX_GHOST) continue;
        if (locked && c->mesh.split != 0 && i > 0 && i < star->of_v &&
            has_edge_to(&c->mesh, bvxi_corner_next(star->corner[i]), source[plan->u]))
            return 1;
        if (c->kind[x] != VERTEX_LOCKED) continue;
        if (locked && i > 0 && i < star->of_v) return 1;
        if (locked && i == 0 && star->of_v == 1 && c->kind[star->link[1]] == VERTEX_LOCKED) return 1;
        if (source[x] == source[plan->u]) return 1;
        for (int32_t k = 0; k < i; k++)
            if (star->link[k] != BVXI_VERTEX_GHOST && source[star->link[k]] == source[x]) return 1;
    }
    return 0;
}

/* Collapse the cheapest edge of a vertex where that is safe, and it is its other end's cheapest too. */
static void try_vertex(const collapse_sweep *s, collapse_range *r, int64_t range, uint32_t v)
{
    bvxi_collapse *const c = s->c;
    bvxi_corners *const m = &c->mesh;
    int32_t const edge = c->edge[v];
    uint32_t const x = bvxi_corner_vertex_of(m, edge);
    uint32_t const y = bvxi_corner_vertex_of(m, bvxi_corner_next(edge));
    bvxi_edge_planned plan;
    double p[3];

    if (range != RANGE_ALL && (!in_range(s, (uint64_t)range, x) || !in_range(s, (uint64_t)range, y))) {
        s->waiting[(uint64_t)range * s->size + r->waiting++] = v;
        return;
    }
    if (c->least[x] < c->least[v] || c->least[y] < c->least[v]) return;
    if (bvxi_edge_plan(c, bvxi_corner_previous(edge), &plan) && !is_crumpled(s, &plan, plan.d) &&
        gather_star(m, &plan, &r->star) && !meets_sheets(c, &plan, &r->star)) {
        /* What was refused once may leave needles: thin plates cannot do without. */
        double const cost = (double)c->least[v];
        int const needles = plan.cost * 2 < cost;
        int within = 1;

        /* Does all that the collapse touches lie in the range? */
        for (int32_t i = 0; i < r->star.count && range != RANGE_ALL; i++)
            within &= in_range(s, (uint64_t)range, r->star.link[i]);
        if (!within) {
            s->waiting[(uint64_t)range * s->size + r->waiting++] = v;
            return;
        }
        if (judge_at(s, &plan, &r->star, plan.d, needles, p) ||
            judge_elsewhere(s, &plan, &r->star, cost, needles, p)) {
            apply(c, &plan, p, r);
            return;
        }
    }
    r->refused++;
    /* A refused edge may be safe after its neighbours have gone: it costs four times as much as those that were tried. */
    float const more = 4 * (c->least[v] > c->reached ? c->least[v] : c->reached) + 1e-37f;
    bvxi_edge_put_cost(m, edge, more < COLLAPSE_NEVER ? more : COLLAPSE_NEVER);
    bvxi_edge_find_least(c, x);
    bvxi_edge_find_least(c, y);
    c->stale[x] = c->stale[y] = 1;
}

/* ---- Sweeps ---- */

static uint32_t cost_bits(float cost)
{
    uint32_t bits;
    memcpy(&bits, &cost, sizeof bits);
    return bits;
}

/* Vertices by the bits of their costs: the upper twelve, or the next twelve of those that begin with high. */
typedef struct cost_counts {
    const bvxi_collapse *c;
    uint64_t step; /* vertices to one that is looked at */
    uint32_t high; /* COST_BUCKETS: none */
} cost_counts;

uint64_t bvxi_collapse_cost_pieces(const bvxi_collapse *c)
{
    int32_t const pieces = bvxi_piece_count(c->mesh.vertices, COST_GRAIN), threads = bvxi_threads(c->ctx);
    int32_t const most = threads < COST_PIECES ? threads : COST_PIECES;
    return (uint64_t)(pieces < most ? pieces : most);
}

static void costs_of_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const cost_counts *const k = user;
    const float *const least = k->c->least;
    uint32_t *const count = k->c->costs + (uint64_t)piece * COST_BUCKETS;

    memset(count, 0, COST_BUCKETS * sizeof *count);
    for (uint64_t i = begin; i < end; i++) {
        uint32_t const bits = cost_bits(least[i * k->step]);

        if (k->high == COST_BUCKETS) count[bits >> 20]++;
        else if (bits >> 20 == k->high && least[i * k->step] < COLLAPSE_NEVER)
            count[bits >> 8 & (COST_BUCKETS - 1)]++;
    }
}

/* The counts of all pieces go to those of the first. */
static void count_costs(cost_counts *k)
{
    uint64_t const looked = (k->c->mesh.vertices + k->step - 1) / k->step;
    uint64_t const pieces = looked < COST_GRAIN ? 1 : bvxi_collapse_cost_pieces(k->c);
    bvxi_ranges(k->c->ctx, (int32_t)pieces, looked, costs_of_piece, k);
    for (uint64_t i = COST_BUCKETS; i < pieces * COST_BUCKETS; i++)
        k->c->costs[i & (COST_BUCKETS - 1)] += k->c->costs[i];
}

/* Set the cost that about so many vertices have no cheaper edge than; bits of positive floats are in the order
 * of their values. candidates: how many have. Of many vertices some are looked at, but after sweeps in vain. */
static void choose_threshold(collapse_sweep *s, uint64_t wanted, int idle)
{
    const bvxi_collapse *const c = s->c;
    uint64_t const looked = wanted > THRESHOLD_WANTED ? THRESHOLD_VERTICES : 4 * THRESHOLD_VERTICES;
    uint64_t const step = idle == 0 || wanted > THRESHOLD_WANTED ? 1 + c->mesh.vertices / looked : 1;
    cost_counts counts = {.c = c, .step = step, .high = COST_BUCKETS};
    const uint32_t *const count = c->costs;
    uint32_t high = COST_BUCKETS - 1, low = COST_BUCKETS, bits;
    uint64_t const enough = (wanted + step - 1) / step, few = enough / THRESHOLD_FEW + 1;
    uint64_t before = 0;
    double dearer = DEARER;
    float most;

    /* The upper twelve bits first, then the next twelve of those that are in the same bucket. */
    count_costs(&counts);
    for (uint32_t i = 0; i < COST_BUCKETS; i++) {
        if (before + count[i] >= few && low == COST_BUCKETS) low = i;
        if (before + count[i] >= enough) {
            high = i;
            break;
        }
        before += count[i];
    }

    /* Nothing that costs far more than the cheapest ones goes before all of these have been tried. */
    bits = (low + 1) << 20;
    memcpy(&most, &bits, sizeof bits);
    for (; idle > 1; idle--) dearer *= DEARER;
    dearer *= (double)(most > COST_NOTHING ? most : COST_NOTHING);
    most = dearer < COLLAPSE_NEVER ? (float)dearer : COLLAPSE_NEVER;
    if (low < COST_BUCKETS && most < COLLAPSE_NEVER && high > cost_bits(most) >> 20) {
        high = cost_bits(most) >> 20;
        before = 0;
        for (uint32_t i = 0; i < high; i++) before += count[i];
    }
    counts.high = high;
    count_costs(&counts);
    bits = high << 20 | 0xfffff;
    for (uint32_t i = 0; i < COST_BUCKETS; i++) {
        before += count[i];
        if (before < enough) continue;
        bits = high << 20 | i << 8 | 0xff;
        break;
    }
    memcpy(&s->threshold, &bits, sizeof bits);
    if (!(s->threshold < COLLAPSE_NEVER)) s->threshold = 0.5f * COLLAPSE_NEVER;
    s->candidates = before * step;
}

/* Memory that a vertex needs is requested before its turn. */
static void request_vertex(const bvxi_collapse *c, uint32_t v)
{
    BVXI_PREFETCH(&c->mesh.at[v]);
    BVXI_PREFETCH(&c->mesh.triangle[(uint32_t)c->edge[v] >> 2]);
}

static void range_piece(void *user, int32_t index)
{
    const collapse_sweep *const s = user;
    collapse_range *const r = &s->range[index];
    const bvxi_collapse *const c = s->c;
    uint64_t const begin = (uint64_t)index * s->size;
    uint64_t const end = begin + s->size < c->mesh.vertices ? begin + s->size : c->mesh.vertices;
    uint64_t candidates = 0, quota;

    /* Each range has its part of what is needed, so that all of them together take no more. */
    for (uint64_t v = begin; v < end; v++) candidates += c->least[v] <= s->threshold;
    quota = (uint64_t)((double)s->needed * (double)candidates / (double)s->candidates);
    for (uint64_t v = begin; v < end; v++) {
        if (v + SWEEP_AHEAD < end && c->least[v + SWEEP_AHEAD] <= s->threshold)
            request_vertex(c, (uint32_t)v + SWEEP_AHEAD);
        if (!(c->least[v] <= s->threshold)) continue;
        if (r->collapsed >= quota) break;
        try_vertex(s, r, index, (uint32_t)v);
    }
}

static void take_range(bvxi_collapse *c, const collapse_range *r)
{
    c->mesh.left -= r->triangles;
    c->alive -= r->collapsed;
    c->counts.collapsed += r->collapsed;
    c->counts.refused += r->refused;
}

/* What reaches over the ranges' borders, one by one. */
static void sweep_waiting(const collapse_sweep *s, uint64_t ranges, collapse_range *r)
{
    const bvxi_collapse *const c = s->c;

    for (uint64_t i = 0; i < ranges; i++) {
        const uint32_t *const waiting = s->waiting + i * s->size;

        for (uint64_t k = 0, n = s->range[i].waiting; k < n; k++) {
            if (k + SWEEP_AHEAD < n) request_vertex(c, waiting[k + SWEEP_AHEAD]);
            if (!(c->least[waiting[k]] <= s->threshold)) continue;
            if (c->mesh.left <= s->target + r->triangles) return;
            try_vertex(s, r, RANGE_ALL, waiting[k]);
        }
    }
}

static bvx_status sweep_ranges(collapse_sweep *s)
{
    bvxi_collapse *const c = s->c;
    collapse_range r = {.triangles = 0};

    s->size = (c->mesh.vertices + RANGE_MOST - 1) / RANGE_MOST;
    if (s->size < RANGE_VERTICES) s->size = RANGE_VERTICES;
    uint64_t const ranges = (c->mesh.vertices + s->size - 1) / s->size;
    BVXI_TRY(BVXI_ZEROS(c->ctx, ranges, "the ranges of collapses", s->range));
    BVXI_TRY(BVXI_ARRAY(c->ctx, c->mesh.vertices, "vertices that wait", s->waiting));

    for (uint64_t i = 0; i < ranges; i++) s->range[i].order = c->order;
    bvxi_tasks(c->ctx, (int32_t)ranges, range_piece, s);
    r.order = c->order;
    for (uint64_t i = 0; i < ranges; i++) {
        take_range(c, &s->range[i]);
        r.order += (uint32_t)s->range[i].collapsed;
    }
    sweep_waiting(s, ranges, &r);
    c->order = r.order;
    take_range(c, &r);
    return BVX_OK;
}

/* 1: one of the next eight vertices may be tried. */
static int any_of_eight(const float *least, float threshold)
{
    int cheap = 0;
    for (int k = 0; k < 8; k++) cheap |= least[k] <= threshold;
    return cheap;
}

static void block_piece(void *user, int32_t block)
{
    const collapse_sweep *const s = user;
    uint64_t const begin = (uint64_t)block * s->size;
    uint64_t const end = begin + s->size < s->c->mesh.vertices ? begin + s->size : s->c->mesh.vertices;
    uint64_t v = begin;
    while (v + 8 <= end && !any_of_eight(s->c->least + v, s->threshold)) v += 8;
    while (v < end && !(s->c->least[v] <= s->threshold)) v++;
    s->cheap[block] = v < end;
}

/* The vertices of one block, in their order; a collapse may make edges of others cheap. */
static void sweep_block(const collapse_sweep *s, uint64_t block, collapse_range *r)
{
    bvxi_collapse *const c = s->c;
    uint64_t const begin = block * s->size;
    uint64_t const end = begin + s->size < c->mesh.vertices ? begin + s->size : c->mesh.vertices;

    for (uint64_t v = begin; v < end; v++) {
        uint64_t const collapsed = r->collapsed;

        /* Few are that cheap: eight are looked at at once. */
        if (v + 8 <= end && !any_of_eight(c->least + v, s->threshold)) {
            v += 7;
            continue;
        }
        if (!(c->least[v] <= s->threshold)) continue;
        if (c->mesh.left <= s->target + r->triangles) return;
        try_vertex(s, r, RANGE_ALL, (uint32_t)v);
        if (r->collapsed == collapsed) continue;
        s->cheap[bvxi_corner_vertex_of(&c->mesh, r->star.corner[0]) / s->size] = 1;
        for (int32_t i = 0; i < r->star.count; i++)
            if (r->star.link[i] != BVXI_VERTEX_GHOST) s->cheap[r->star.link[i] / s->size] = 1;
    }
}

bvx_status bvxi_collapse_sweep(bvxi_collapse *c, uint64_t target, int idle, uint64_t *done)
{
    uint64_t const begun = c->counts.collapsed;
    uint64_t const share = idle > 1 ? c->alive : (uint64_t)((double)c->alive * SWEEP_SHARE) + 1;
    collapse_sweep s = {
        .c = c, .target = target, .left = c->mesh.left, .needed = (c->mesh.left - target + 1) / 2};
    uint64_t const wanted = (2 * s.needed) << idle;

    /* After sweeps in vain more edges are tried, in the end all, since the cheapest ones are refused. */
    choose_threshold(&s, wanted < share ? wanted : share, idle);

    /* Before edges that cost far more those that were refused are looked at anew. */
    if ((double)s.threshold > DEARER * (double)c->reached && bvxi_any_marked(c->stale, c->mesh.vertices)) {
        BVXI_TRY(bvxi_collapse_evaluate(c));
        choose_threshold(&s, wanted < share ? wanted : share, idle);
    }
    if (s.threshold > c->reached) c->reached = s.threshold;
    *done = 0;
    if (s.candidates == 0) return BVX_OK;
    if (c->tree.node[0] == NULL && s.needed >= RANGE_COLLAPSES && c->mesh.vertices >= 2 * RANGE_VERTICES)
        BVXI_TRY(BVXI_SCOPE(c->ctx, sweep_ranges(&s)));
    else {
        /* All vertices one by one, but for blocks without a cheap edge. */
        uint8_t cheap[BVXI_MOST_PIECES];
        collapse_range r = {.order = c->order};

        s.cheap = cheap;
        s.size = c->mesh.vertices / BVXI_MOST_PIECES + 1;
        if (s.size < BLOCK_VERTICES) s.size = BLOCK_VERTICES;
        uint64_t const blocks = (c->mesh.vertices + s.size - 1) / s.size;
        bvxi_tasks(c->ctx, (int32_t)blocks, block_piece, &s);
        for (uint64_t i = 0; i < blocks; i++)
            if (cheap[i]) sweep_block(&s, i, &r);
        c->order = r.order;
        take_range(c, &r);
    }
    *done = c->counts.collapsed - begun;
    return BVX_OK;
}
