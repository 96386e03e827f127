/* mend_trace.c - loops along the edges that are left of loops that touched or crossed, and the stack that
 * they make. */
#include "contours/mend.h"
#include "mesh/mesh.h"

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
 * one's point is moved in fixed point by some steps (mend_apart.c). What is written to the mesh is the point
 * itself; only the decisions about what lies where see that it was moved. */

typedef struct mend_trace {
    bvxi_mend_work *w;
    bvxi_mended *mended;
    uint32_t *edge; /* kept ones; ends are numbered 2 * edge, 2 * edge + 1 */
    uint32_t edge_count;
    uint32_t *start;      /* of each node: its first end in turn; one more */
    uint32_t *end;        /* ends of edges by node, counter-clockwise */
    uint32_t *rank;       /* of each end: where it stands in its node's turn */
    uint8_t *used;        /* edges */
    uint32_t *place;      /* of each node: its stop on the path, or none */
    bvxi_mend_stop *path; /* all stops of one path */
    bvxi_mend_stop *stop; /* those of all loops, loop by loop */
    uint32_t *loop;       /* where each loop's stops begin */
    uint32_t stop_count, loop_count;
} mend_trace;

static uint32_t mend_end_node(const mend_trace *t, uint32_t end)
{
    return t->w->edge[t->edge[end >> 1]].node[end & 1];
}

static bvx_status mend_keep_edges(mend_trace *t, uint64_t *key, uint32_t *order)
{
    const bvxi_mend_work *const w = t->w;
    uint32_t count = 0;

    for (uint32_t i = 0; i < w->edge_count; i++) {
        uint32_t const a = w->edge[i].node[0], b = w->edge[i].node[1];
        if (!w->changed[w->edge[i].loop]) continue;
        key[count] = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
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
    bvxi_mend_direction(t->w, t->edge, a, d);
    bvxi_mend_direction(t->w, t->edge, b, e);
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

/* Stops from one on are a loop that comes back to its node by an end. */
static void mend_cut_loop(mend_trace *t, uint32_t from, uint32_t *count, uint32_t back)
{
    t->loop[t->loop_count++] = t->stop_count;
    for (uint32_t i = from; i < *count; i++) {
        bvxi_mend_stop *const s = &t->stop[t->stop_count++];
        *s = t->path[i];
        if (i == from) s->in = back;
        else t->place[s->node] = BVXI_NONE;
    }
    *count = from + 1;
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
            mend_cut_loop(t, t->place[node], &count, in);
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

/* How narrow the angle is between a stop's ends that no other end lies in: the cosine of half of it, or 2
 * where both have some. */
static double mend_narrowness(const mend_trace *t, const bvxi_mend_paths *p, const bvxi_mend_stop *s)
{
    uint32_t const all = t->start[s->node + 1] - t->start[s->node], i = t->rank[s->out], j = t->rank[s->in];
    double middle[2];
    if ((i + 1) % all == j) return bvxi_mend_middle(p, s->out, s->in, middle);
    return (j + 1) % all == i ? bvxi_mend_middle(p, s->in, s->out, middle) : 2.0;
}

/* At a node the stop in the narrowest angle stays, or one between others. narrowest: scratch, by node. */
static void mend_choose_stay(const mend_trace *t, const bvxi_mend_paths *p, double *narrowest,
                             uint32_t *stays)
{
    for (uint32_t i = 0; i < t->w->node_count; i++) {
        narrowest[i] = -2.0;
        stays[i] = BVXI_NONE;
    }
    for (uint32_t i = 0; i < t->stop_count; i++) {
        const bvxi_mend_stop *const s = &t->stop[i];
        double const narrow = mend_narrowness(t, p, s);
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

static uint32_t *mend_part(unsigned char **at, uint64_t bytes)
{
    uint32_t *const part = (uint32_t *)(void *)*at;
    *at += bytes;
    return part;
}

bvx_status bvxi_mend_trace(bvxi_mend_work *w, bvxi_mended *mended)
{
    uint64_t const edges = w->edge_count, nodes = w->node_count, stops = sizeof(bvxi_mend_stop);
    uint64_t const size = edges * (8 + 4 + 4 + 8 + 8 + 4 + 2 * stops + 1) +
                          (nodes + 1) * (8 + 4 + 4 + 4 + stops);
    unsigned char *block, *at;
    mend_trace t = {.w = w, .mended = mended};
    int16_t(*nudge)[2];

    BVXI_TRY(bvxi_alloc(w->s->ctx, BVXI_SCRATCH, size, "the paths of loops to mend", &block));
    /* Wide items first, so that each part is aligned. */
    at = block;
    uint64_t *const key = (uint64_t *)(void *)mend_part(&at, edges * 8);
    double *const narrowest = (double *)(void *)mend_part(&at, (nodes + 1) * 8);
    uint32_t *const order = mend_part(&at, edges * 4);
    t.edge = mend_part(&at, edges * 4);
    t.end = mend_part(&at, edges * 8);
    t.rank = mend_part(&at, edges * 8);
    t.loop = mend_part(&at, edges * 4);
    t.start = mend_part(&at, (nodes + 1) * 4);
    t.place = mend_part(&at, (nodes + 1) * 4);
    uint32_t *const stays = mend_part(&at, (nodes + 1) * 4);
    t.path = (bvxi_mend_stop *)(void *)mend_part(&at, (nodes + 1 + edges) * stops);
    t.stop = (bvxi_mend_stop *)(void *)mend_part(&at, edges * stops);
    t.used = (uint8_t *)at;

    BVXI_TRY(mend_keep_edges(&t, key, order));
    mend_turn_ends(&t);
    memset(t.used, 0, t.edge_count);
    for (uint32_t i = 0; i < t.edge_count; i++)
        if (!t.used[i]) mend_follow(&t, i);

    /* The stop that stays is chosen first, as all others move away from it. */
    bvxi_mend_paths paths = {w, t.edge, t.rank, t.stop, t.loop, t.stop_count, t.loop_count};
    mend_choose_stay(&t, &paths, narrowest, stays);
    BVXI_TRY(BVXI_ZEROS(w->s->ctx, t.stop_count, "the steps of points", nudge));
    BVXI_TRY(bvxi_mend_apart(&paths, stays, nudge));
    return mend_give_loops(&t, (const int16_t(*)[2])nudge);
}
