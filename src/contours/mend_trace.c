/* mend_trace.c - loops along the edges that are left of loops that touched or crossed, and the stack that
 * they make. */
#include "contours/mend.h"

#include "mesh/mesh.h"

#include <math.h>

/* A stop of a path: the node, and the ends of edges by which it came and went. */
typedef struct mend_stop {
    uint32_t node, in, out;
} mend_stop;

typedef struct mend_trace {
    bvxi_mend_work *w;
    bvxi_mended *mended;
    uint32_t *edge; /* kept ones; ends are numbered 2 * edge, 2 * edge + 1 */
    uint32_t edge_count;
    uint32_t *start; /* of each node: its first end in turn; one more */
    uint32_t *end;   /* ends of edges by node, counter-clockwise */
    uint32_t *rank;  /* of each end: where it stands in its node's turn */
    uint8_t *used;   /* edges */
    uint32_t *place; /* of each node: its stop on the path, or none */
    mend_stop *path; /* all stops of one path */
    mend_stop *stop; /* those of all loops, loop by loop */
    uint32_t *loop;  /* where each loop's stops begin */
    uint32_t stop_count, loop_count;
} mend_trace;

/* ---- loops moved apart at a node ---- */

/* At a node stops of loops lie in each other or beside each other like brackets, as no path crosses another. One
 * stays; each of the others moves into the angle on its far side, those that have others in that angle a quarter as
 * far as these. Nodes at which segments would meet move half as far, until none do. Exact; what cannot be moved
 * apart is found by the checks of every stack. */

enum {
    APART_STEPS = 48,
    APART_FARTHEST = 12288,
    APART_DOUBLINGS = 12,
    APART_ROUNDS = 28,
    APART_KEPT_LEVELS = 1
};
enum { APART_LESS = 1, APART_MORE = 2 };

/* A segment where it is to lie: from a stop to the next one, or of a loop that is as it was. */
typedef struct apart_segment {
    int32_t q[2][2];
    uint32_t stop[2]; /* or BVXI_NONE */
} apart_segment;

typedef struct apart_stop {
    double way[2];  /* along which it moves; 0: it stays */
    uint32_t level; /* stops that lie in its angle, one in the other */
    uint32_t next;  /* in its loop */
} apart_stop;

typedef struct apart_work {
    const mend_trace *trace;
    apart_stop *stop;
    uint32_t *first, *at_node; /* stops by node [Size: nodes + 1], [Size: stops] */
    double *steps;             /* of each node: how far what lies innermost moves */
    uint8_t *mark;             /* of each node: APART_... */
    apart_segment *segment;
    bvxi_segment_box *box;
    uint32_t segments;
} apart_work;

static void mend_direction(const mend_trace *t, uint32_t end, int64_t d[2])
{
    const uint32_t *const node = t->w->edge.at[t->edge[end >> 1]].node;
    for (int k = 0; k < 2; k++)
        d[k] = (int64_t)t->w->node[node[~end & 1]].q[k] - t->w->node[node[end & 1]].q[k];
}

/* The middle of the angle from one end counter-clockwise to another, of length 1 or 0; returns
 * the cosine of half of it. */
static double mend_middle(const mend_trace *p, uint32_t from, uint32_t to, double middle[2])
{
    double u[2], v[2], length;
    int64_t d[2], e[2];

    mend_direction(p, from, d);
    mend_direction(p, to, e);
    length = sqrt((double)d[0] * (double)d[0] + (double)d[1] * (double)d[1]);
    for (int k = 0; k < 2; k++) u[k] = (double)d[k] / length;
    length = sqrt((double)e[0] * (double)e[0] + (double)e[1] * (double)e[1]);
    for (int k = 0; k < 2; k++) v[k] = (double)e[k] / length;

    /* The middle of the angle lies across the difference of both directions. */
    middle[0] = v[1] - u[1];
    middle[1] = u[0] - v[0];
    length = sqrt(middle[0] * middle[0] + middle[1] * middle[1]);
    for (int k = 0; k < 2; k++) middle[k] = length > 0.0 ? middle[k] / length : 0.0;
    return middle[0] * u[0] + middle[1] * u[1];
}

/* ---- brackets at a node ---- */

static int stands_between(const mend_trace *p, uint32_t from, uint32_t end, uint32_t to)
{
    uint32_t const r = p->rank[end], a = p->rank[from], b = p->rank[to];
    return a < b ? a < r && r < b : r > a || r < b;
}

/* The ends of the angle that a stop moves into: counter-clockwise, without the stop that stays. */
static void far_angle(const mend_trace *p, uint32_t stop, uint32_t stays, uint32_t angle[2])
{
    const mend_stop *const s = &p->stop[stop];
    int const turned = stands_between(p, s->out, p->stop[stays].in, s->in);
    angle[0] = turned ? s->in : s->out;
    angle[1] = turned ? s->out : s->in;
}

/* Stops in a stop's angle come before it: by how many ends stand there. */
static uint32_t ends_within(const mend_trace *p, const uint32_t angle[2], uint32_t all)
{
    return (p->rank[angle[1]] + all - p->rank[angle[0]]) % all;
}

static void aim_stops(apart_work *w, uint32_t node, uint32_t stays)
{
    const mend_trace *const p = w->trace;
    uint32_t *const here = w->at_node + w->first[node];
    uint32_t const count = w->first[node + 1] - w->first[node], all = 2 * count;
    uint32_t deepest = 0;

    for (uint32_t i = 1; i < count; i++) { /* narrow ones first; few meet at a node */
        uint32_t const x = here[i];
        uint32_t a[2], b[2], j = i;
        far_angle(p, x, stays, a);
        for (; j > 0; j--) {
            far_angle(p, here[j - 1], stays, b);
            if (here[j - 1] != stays && (x == stays || ends_within(p, b, all) <= ends_within(p, a, all)))
                break;
            here[j] = here[j - 1];
        }
        here[j] = x;
    }

    for (uint32_t i = 0; i < count; i++) {
        apart_stop *const s = &w->stop[here[i]];
        uint32_t a[2];

        s->level = 0;
        s->way[0] = s->way[1] = 0.0;
        if (here[i] == stays) continue;
        far_angle(p, here[i], stays, a);
        (void)mend_middle(p, a[0], a[1], s->way);
        for (uint32_t k = 0; k < i; k++)
            if (here[k] != stays && stands_between(p, a[0], p->stop[here[k]].in, a[1]) &&
                w->stop[here[k]].level >= s->level)
                s->level = w->stop[here[k]].level + 1;
        if (s->level > deepest) deepest = s->level;
    }

    /* Each level moves a quarter as far as the one in it: of many, the innermost begins farther off. */
    w->steps[node] = APART_STEPS;
    for (; deepest > APART_KEPT_LEVELS && w->steps[node] < APART_FARTHEST; deepest--) w->steps[node] *= 4.0;
}

static void aim_nodes(apart_work *w, const uint32_t *stays)
{
    const mend_trace *const p = w->trace;
    uint32_t const nodes = p->w->node_count;

    memset(w->first, 0, ((size_t)nodes + 1) * 4);
    for (uint32_t i = 0; i < p->stop_count; i++) w->first[p->stop[i].node + 1]++;
    for (uint32_t n = 0; n < nodes; n++) w->first[n + 1] += w->first[n];
    for (uint32_t i = p->stop_count; i-- > 0;) /* starts move to the ends before them */
        w->at_node[--w->first[p->stop[i].node + 1]] = i;
    for (uint32_t n = 0; n < nodes; n++) w->first[n] = w->first[n + 1];
    w->first[nodes] = p->stop_count;

    for (uint32_t n = 0; n < nodes; n++) {
        w->steps[n] = 0.0;
        if (w->first[n + 1] - w->first[n] > 1) aim_stops(w, n, stays[n]);
        else if (w->first[n + 1] != w->first[n])
            memset(&w->stop[w->at_node[w->first[n]]], 0, sizeof *w->stop);
    }
    for (uint32_t l = 0; l < p->loop_count; l++) {
        uint32_t const begin = p->loop[l], end = l + 1 < p->loop_count ? p->loop[l + 1] : p->stop_count;
        for (uint32_t i = begin; i < end; i++) w->stop[i].next = i + 1 < end ? i + 1 : begin;
    }
}

static void stop_nudge(const mend_trace *p, const apart_work *w, uint32_t stop, int32_t nudge[2])
{
    const apart_stop *const s = &w->stop[stop];
    double steps = w->steps[p->stop[stop].node];
    for (uint32_t k = 0; k < s->level; k++) steps *= 0.25;
    for (int k = 0; k < 2; k++) nudge[k] = (int32_t)floor(steps * s->way[k] + 0.5);
}

static void put_segments(apart_work *w)
{
    const mend_trace *const p = w->trace;
    const bvxi_mend_work *const m = p->w;

    w->segments = 0;
    for (uint32_t i = 0; i < p->stop_count; i++) {
        apart_segment *const s = &w->segment[w->segments++];
        s->stop[0] = i;
        s->stop[1] = w->stop[i].next;
        for (int end = 0; end < 2; end++) {
            const int32_t *const at = m->node[p->stop[s->stop[end]].node].q;
            int32_t nudge[2];
            stop_nudge(p, w, s->stop[end], nudge);
            for (int k = 0; k < 2; k++) s->q[end][k] = at[k] + 2 * nudge[k];
        }
    }
    for (uint32_t i = 0; i < m->edge.count; i++) {
        apart_segment *const s = &w->segment[w->segments];
        if (m->changed[m->edge.at[i].loop]) continue;
        w->segments++;
        for (int end = 0; end < 2; end++) {
            s->stop[end] = BVXI_NONE;
            memcpy(s->q[end], m->node[m->edge.at[i].node[end]].q, sizeof s->q[end]);
        }
    }
}

static uint32_t node_of_end(const apart_work *w, const apart_segment *s, int end)
{
    return s->stop[end] == BVXI_NONE ? BVXI_NONE : w->trace->stop[s->stop[end]].node;
}

static bvx_status find_collision(void *user, uint32_t i, uint32_t j)
{
    apart_work *const w = user;
    const apart_segment *const s = &w->segment[i], *const t = &w->segment[j];
    int const after = s->stop[1] == t->stop[0], before = t->stop[1] == s->stop[0];
    int common = 0;

    if (s->stop[0] == BVXI_NONE && t->stop[0] == BVXI_NONE) return BVX_OK; /* they do not touch as they are */
    /* Neighbours on a loop share a point: only a fold back onto each other counts. */
    if (after && before) return BVX_OK;
    if (!(after    ? bvxi_folds_back(s->q[1], s->q[0], t->q[1])
          : before ? bvxi_folds_back(s->q[0], s->q[1], t->q[0])
                   : bvxi_segments_meet(s->q[0], s->q[1], t->q[0], t->q[1])))
        return BVX_OK;

    /* Segments that meet at a node of both are too near to each other there; at others they move too far. */
    for (int e = 0; e < 4; e++) {
        uint32_t const node = node_of_end(w, s, e & 1);
        if (node == BVXI_NONE || node != node_of_end(w, t, e >> 1)) continue;
        w->mark[node] |= APART_MORE;
        common = 1;
    }
    for (int end = 0; end < 2 && !common; end++) {
        if (s->stop[end] != BVXI_NONE) w->mark[node_of_end(w, s, end)] |= APART_LESS;
        if (t->stop[end] != BVXI_NONE) w->mark[node_of_end(w, t, end)] |= APART_LESS;
    }
    return BVX_OK;
}

/* By how many steps each stop moves. stays: of each node, the stop that does not. */
static bvx_status move_apart(apart_work *w, const uint32_t *stays, int16_t (*nudge)[2])
{
    const mend_trace *const p = w->trace;
    bvx_context *const ctx = p->w->s->ctx;
    uint64_t const stops = p->stop_count, nodes = p->w->node_count;

    BVXI_TRY(BVXI_ARRAY(ctx, stops, "stops at a node", w->stop));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes + 1, "the nodes' stops", w->first));
    BVXI_TRY(BVXI_ARRAY(ctx, stops, "the nodes' stops", w->at_node));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes, "the steps of nodes", w->steps));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes, "the marks of nodes", w->mark));
    BVXI_TRY(BVXI_ARRAY(ctx, stops + p->w->edge.count, "the segments apart", w->segment));
    BVXI_TRY(BVXI_ARRAY(ctx, stops + p->w->edge.count, "the segments apart", w->box));
    aim_nodes(w, stays);

    for (int round = 0, again = 1; again && round < APART_ROUNDS; round++) {
        /* All collisions of a round are found before a node changes, so their order does not matter. */
        again = 0;
        memset(w->mark, 0, (size_t)nodes);
        put_segments(w);
        for (uint32_t i = 0; i < w->segments; i++)
            w->box[i] = bvxi_box_segment(w->segment[i].q[0], w->segment[i].q[1], i);
        BVXI_TRY(bvxi_sweep(ctx, w->box, w->segments, find_collision, w));
        /* What was too near goes further off while that may help: later on all only comes nearer. */
        for (uint32_t n = 0; n < nodes; n++) {
            double *const steps = &w->steps[n];
            if (w->mark[n] == APART_MORE && round < APART_DOUBLINGS && *steps < APART_FARTHEST) *steps *= 2.0;
            else if (w->mark[n] != 0 && *steps > 1.0) *steps *= 0.5;
            else continue;
            again = 1;
        }
    }
    /* The farthest step still fits 16 bits. */
    for (uint32_t i = 0; i < stops; i++) {
        int32_t steps[2];
        stop_nudge(p, w, i, steps);
        for (int k = 0; k < 2; k++) nudge[i][k] = (int16_t)steps[k];
    }
    return BVX_OK;
}

/* ---- loops along the edges that are left ---- */

bvx_status bvxi_mended_add_loop(bvxi_mended *m, uint32_t section, int32_t label)
{
    bvx_sections *const s = &m->sections;
    BVXI_TRY(BVXI_GROW(m, s->loops, s->loop_count, s->loop_capacity, "mended loops"));
    s->loops[s->loop_count++] = (bvx_section_loop){
        .first_point = s->point_count, .section = section, .label = label};
    return BVX_OK;
}

bvx_status bvxi_mended_add_point(bvxi_mended *m, const double at[3], int32_t u, int32_t v)
{
    bvx_sections *const s = &m->sections;
    BVXI_TRY(BVXI_GROW_BY(m, s->points, s->point_count, s->point_capacity, 24, "the points of mended loops"));
    BVXI_TRY(BVXI_GROW(m, m->nudge, s->point_count, m->nudge_room, "the points of mended loops"));
    memcpy(s->points + 3 * s->point_count, at, 24);
    m->nudge[s->point_count][0] = (int16_t)u;
    m->nudge[s->point_count++][1] = (int16_t)v;
    s->loops[s->loop_count - 1].point_count++;
    return BVX_OK;
}

/* Loops along the edges that are left of loops that touched or crossed.
 *
 * Inside is what an odd number of loops enclose, so an edge that lies there twice divides nothing and goes:
 * slits, spikes, borders in common. Of the others an even number ends at each node. They are joined there in
 * pairs that lie beside each other, so that no path crosses another, and a path that comes back to a node is
 * cut off there as a loop: no loop comes to a node twice. Loops that share a node still touch; there each
 * one's point is moved in fixed point by some steps. What is written to the mesh is the point
 * itself; only the decisions about what lies where see that it was moved. */

static uint32_t mend_end_node(const mend_trace *t, uint32_t end)
{
    return t->w->edge.at[t->edge[end >> 1]].node[end & 1];
}

static bvx_status mend_keep_edges(mend_trace *t, uint64_t *key, uint32_t *order)
{
    const bvxi_mend_work *const w = t->w;
    uint32_t count = 0;

    for (uint32_t i = 0; i < w->edge.count; i++) {
        uint32_t const a = w->edge.at[i].node[0], b = w->edge.at[i].node[1];
        if (!w->changed[w->edge.at[i].loop]) continue;
        key[count] = bvxi_edge_key(a, b);
        order[count++] = i;
    }
    BVXI_TRY(bvxi_radix_sort(w->s->ctx, key, order, count));

    for (uint32_t i = 0, n; i < count; i += n) {
        for (n = 1; i + n < count && key[i + n] == key[i];) n++;
        if ((n & 1) != 0) t->edge[t->edge_count++] = order[i];
    }
    return BVX_OK;
}

/* 1 when the first end comes before the second, counter-clockwise from the u axis; exact. */
static int mend_turns_before(const mend_trace *t, uint32_t a, uint32_t b)
{
    int64_t d[2], e[2];
    mend_direction(t, a, d);
    mend_direction(t, b, e);
    /* Directions of the lower half-plane come after those of
     * the upper one; within one, the cross product decides. */
    int const low = d[1] < 0 || (d[1] == 0 && d[0] < 0);
    int const other = e[1] < 0 || (e[1] == 0 && e[0] < 0);
    if (low != other) return low < other;
    return d[0] * e[1] - d[1] * e[0] > 0;
}

static void mend_turn_ends(mend_trace *t)
{
    uint32_t const nodes = t->w->node_count, ends = 2 * t->edge_count;

    /* Ends by node, by counting; then in turn by insertion, as few meet at a node. */
    memset(t->start, 0, ((size_t)nodes + 1) * 4);
    for (uint32_t i = 0; i < ends; i++) t->start[mend_end_node(t, i) + 1]++;
    for (uint32_t i = 0; i < nodes; i++) t->start[i + 1] += t->start[i];
    for (uint32_t i = 0; i < nodes; i++) t->place[i] = t->start[i];

    for (uint32_t i = 0; i < ends; i++) {
        uint32_t const node = mend_end_node(t, i);
        uint32_t j = t->place[node]++;
        for (; j > t->start[node] && mend_turns_before(t, i, t->end[j - 1]); j--) t->end[j] = t->end[j - 1];
        t->end[j] = i;
    }
    for (uint32_t n = 0; n < nodes; n++) {
        for (uint32_t j = t->start[n]; j < t->start[n + 1]; j++) t->rank[t->end[j]] = j - t->start[n];
        t->place[n] = BVXI_NONE;
    }
}

static void mend_follow(mend_trace *t, uint32_t edge)
{
    uint32_t count = 0, out = 2 * edge;

    t->path[count].node = mend_end_node(t, out);
    t->path[count].in = BVXI_NONE;
    t->place[t->path[count].node] = count;
    count++;
    while (!t->used[out >> 1]) {
        uint32_t const in = out ^ 1, node = mend_end_node(t, in);
        t->used[out >> 1] = 1;
        t->path[count - 1].out = out;
        if (t->place[node] != BVXI_NONE) {
            /* Stops from there on are a loop that comes back to its node by an end. */
            uint32_t const from = t->place[node];
            t->loop[t->loop_count++] = t->stop_count;
            for (uint32_t i = from; i < count; i++) {
                mend_stop *const s = &t->stop[t->stop_count++];
                *s = t->path[i];
                if (i == from) s->in = in;
                else t->place[s->node] = BVXI_NONE;
            }
            count = from + 1;
        } else {
            t->place[node] = count;
            t->path[count].node = node;
            t->path[count].in = in;
            count++;
        }
        /* The end that is joined to this one lies beside it. */
        out = t->end[t->start[node] + (t->rank[in] ^ 1)];
    }
    for (uint32_t i = 0; i < count; i++) t->place[t->path[i].node] = BVXI_NONE;
}

/* At a node the stop in the narrowest angle stays, or one between others. narrowest: scratch, by node. */
static void mend_choose_stay(const mend_trace *t, double *narrowest, uint32_t *stays)
{
    for (uint32_t i = 0; i < t->w->node_count; i++) {
        narrowest[i] = -2.0;
        stays[i] = BVXI_NONE;
    }
    for (uint32_t i = 0; i < t->stop_count; i++) {
        const mend_stop *const s = &t->stop[i];
        /* How narrow the angle is between its ends that no other end lies in: the cosine of half of it, or 2
         * where both have some. */
        uint32_t const all = t->start[s->node + 1] - t->start[s->node], o = t->rank[s->out],
                       k = t->rank[s->in];
        double middle[2];
        double const narrow = (o + 1) % all == k   ? mend_middle(t, s->out, s->in, middle)
                              : (k + 1) % all == o ? mend_middle(t, s->in, s->out, middle)
                                                   : 2.0;
        if (narrow <= narrowest[s->node]) continue;
        narrowest[s->node] = narrow;
        stays[s->node] = i;
    }
}

static bvx_status mend_give_loops(mend_trace *t, const int16_t (*nudge)[2])
{
    const bvxi_mend_work *const w = t->w;

    for (uint32_t l = 0; l < t->loop_count; l++) {
        uint32_t const end = l + 1 < t->loop_count ? t->loop[l + 1] : t->stop_count;
        BVXI_TRY(bvxi_mended_add_loop(t->mended, w->plane->section, w->s->options.label));
        for (uint32_t i = t->loop[l]; i < end; i++) {
            const bvxi_mend_node *const n = &w->node[t->stop[i].node];
            int32_t steps[2];

            /* The node's place in steps of the fixed point, beside where its point will be snapped to. */
            for (int k = 0; k < 2; k++)
                steps[k] = nudge[i][k] + (n->q[k] - 1) / 2 -
                           bvxi_snap_steps(w->s, k, bvxi_along_axis(w->s->axis[k], n->at));
            BVXI_TRY(bvxi_mended_add_point(t->mended, n->at, steps[0], steps[1]));
        }
    }
    return BVX_OK;
}

bvx_status bvxi_mend_trace(bvxi_mend_work *w, bvxi_mended *mended)
{
    static const char what[] = "the paths of loops to mend";
    uint64_t const edges = w->edge.count, nodes = (uint64_t)w->node_count + 1;
    bvx_context *const ctx = w->s->ctx;
    mend_trace t = {.w = w, .mended = mended};
    int16_t(*nudge)[2];
    uint64_t *key;
    double *narrowest;
    uint32_t *order, *stays;

    BVXI_TRY(BVXI_ARRAY(ctx, edges, what, key));
    BVXI_TRY(BVXI_ARRAY(ctx, edges, what, order));
    BVXI_TRY(BVXI_ARRAY(ctx, edges, what, t.edge));
    BVXI_TRY(BVXI_ARRAY(ctx, 2 * edges, what, t.end));
    BVXI_TRY(BVXI_ARRAY(ctx, 2 * edges, what, t.rank));
    BVXI_TRY(BVXI_ARRAY(ctx, edges, what, t.loop));
    BVXI_TRY(BVXI_ARRAY(ctx, edges, what, t.stop));
    BVXI_TRY(BVXI_ZEROS(ctx, edges, what, t.used));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes + edges, what, t.path));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes, what, t.start));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes, what, t.place));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes, what, narrowest));
    BVXI_TRY(BVXI_ARRAY(ctx, nodes, what, stays));

    BVXI_TRY(mend_keep_edges(&t, key, order));
    mend_turn_ends(&t);
    for (uint32_t i = 0; i < t.edge_count; i++)
        if (!t.used[i]) mend_follow(&t, i);

    /* The stop that stays is chosen first, as all others move away from it. */
    mend_choose_stay(&t, narrowest, stays);
    BVXI_TRY(BVXI_ZEROS(w->s->ctx, t.stop_count, "the steps of points", nudge));
    apart_work apart = {.trace = &t};
    BVXI_TRY(BVXI_SCOPE(w->s->ctx, move_apart(&apart, stays, nudge)));
    return mend_give_loops(&t, (const int16_t(*)[2])nudge);
}
