/* oblique_signs.c - inside or outside for every vertex of the tetrahedra, such that the surface is a manifold
 * through the contours.
 *
 * A vertex on a plane has the sign of its region there, on the left or right of its contours; one on a
 * contour has none. The surface is to run through a contour's edges and nothing else of a plane, once, and
 * through a contour's vertex once. So: - an edge between two contour vertices that is no contour's, and a
 * face between three, gets a vertex; - a vertex on two planes whose contours contradict each other there, or
 * on none next to the surface, has the sign that makes no bridge and no hole of what lies round it, where
 * there is one; - round a contour's edge, inside and outside must each be one stretch: a vertex in between
 * that is not gets one of the other sign between itself and the edge; - round a contour's vertex inside and
 * outside must each hang together: what does not is parted from it in the same way. */
#include "oblique/oblique.h"

#define FREE_VALUE 0.1F /* cells: a vertex of the lattice no farther from the surface may be on either side */

/* What all vertices are judged for at once, by several threads. Those that are wrong are settled
 * after that one by one, in order, and so are those of which something has changed since then: the result
 * is that of going through all of them. */
typedef struct signs_job {
    bvxi_oblique *o;
    uint8_t *wrong; /* of each */
    uint8_t *again; /* [vertices] something round a vertex has changed */
    uint64_t vertices;
    /* For what is settled one by one: large, when it is needed, for stars that are no frame's size. */
    uint32_t block[BVXI_LOOK_WORDS * BVXI_LOOK_MOST];
    bvxi_look small, large;
} signs_job;

static void change_round(const signs_job *job, uint32_t v)
{
    if (v < job->vertices) job->again[v] = 1;
}

static void give_sign(const bvxi_oblique *o, bvxi_tetra_vertex *x, uint32_t plane)
{
    double const value = plane != BVXI_NONE ? bvxi_oblique_exact(o, plane, x->at)
                                            : bvxi_oblique_number(o, x->at);
    x->sign = value > 0.0 ? 1 : -1;
    x->value = (float)value;
}

static void signs_piece(void *user, uint64_t begin, uint64_t end)
{
    const signs_job *const job = user;
    bvxi_oblique *const o = job->o;
    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_vertex *const x = &o->vertex[i];
        /* Vertices of contours have no sign, and those of the lattice have theirs from it. */
        if (x->sign == 0) x->value = 0.0F;
        else if (!x->lattice) give_sign(o, x, bvxi_first_plane(o, (uint32_t)i));
    }
}

/* ---- edges and faces between contours ---- */

void bvxi_oblique_middle(const bvxi_oblique *o, const uint32_t *v, int n, double at[3])
{
    for (int k = 0; k < 3; k++) {
        at[k] = 0.0;
        for (int i = 0; i < n; i++) at[k] += o->vertex[v[i]].at[k];
        at[k] /= n;
    }
}

bvx_status bvxi_oblique_part_contours(bvxi_oblique *o)
{
    /* Of several bodies only what lies on planes is split: a region would be joined to its like beyond an edge by
     * that edge alone. Its new vertices get their kinds later. */
    int const signs = o->body_count == 0;

    /* Those that splitting adds come last, and their turn comes too. */
    for (uint32_t t = 0; t < o->tetra_count; t++) {
        if (bvxi_on_contours(o, &o->tetra[t]) < 2) continue;
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++) {
                uint32_t const v[2] = {o->tetra[t].v[a], o->tetra[t].v[b]};
                double at[3];
                uint32_t m;
                if (o->vertex[v[0]].sign != 0 || o->vertex[v[1]].sign != 0) continue;
                if (!signs && !bvxi_share_plane(o, v, 2)) continue;
                if (bvxi_edge_find(&o->contour_edge, v[0], v[1]) != BVXI_NONE) continue;
                bvxi_oblique_middle(o, v, 2, at);
                BVXI_TRY(bvxi_tetra_split_edge(o, t, v[0], v[1], at, &m));
                if (signs) give_sign(o, &o->vertex[m], bvxi_first_plane(o, m));
            }

        /* Then faces, as the edges that were split above may have left none between three. */
        for (int k = 0; k < 4; k++) {
            uint32_t v[3], m;
            double at[3];
            int n = 0;
            for (int j = 0; j < 4; j++)
                if (j != k && o->vertex[o->tetra[t].v[j]].sign == 0) v[n++] = o->tetra[t].v[j];
            if (n < 3 || (!signs && !bvxi_share_plane(o, v, 3))) continue;
            bvxi_oblique_middle(o, v, 3, at);
            BVXI_TRY(bvxi_tetra_split_face(o, t, k, at, &m));
            if (signs) give_sign(o, &o->vertex[m], bvxi_first_plane(o, m));
        }
    }
    return BVXI_RESERVE(o, o->mark, o->tetra_count, o->mark_room, "the marks of tetrahedra");
}

/* ---- signs that nothing else decides ---- */

/* The link of a vertex, however large it is. */
static bvx_status look_any(signs_job *w, uint32_t v, bvxi_look **look)
{
    *look = &w->small;
    while (!bvxi_look_link(w->o, *look, v)) {
        if (w->large.most == 0 || *look == &w->large) {
            uint32_t const most = 2 * (*look)->most;
            uint32_t *block = NULL;
            BVXI_TRY(BVXI_ARRAY(w->o->ctx, (uint64_t)most * BVXI_LOOK_WORDS, "the vertices round a vertex",
                                block));
            w->large = bvxi_look_in(block, most);
        }
        *look = &w->large;
    }
    return BVX_OK;
}

/* 1: only this sign makes a bridge or hole. The Euler number inside is 1 where its sign changes nothing. */
static int is_wrong_sign(const bvxi_oblique *o, const bvxi_look *look, uint32_t v)
{
    int any, all, inside;
    int64_t const euler = bvxi_look_euler(o, look, v, &any, &all);
    inside = all || (euler <= 0 && any);
    return euler != 1 && inside != (o->vertex[v].sign > 0) && bvxi_look_whole(o, look, v);
}

static bvx_status settle_sign(signs_job *job, uint32_t v)
{
    bvxi_look *look;
    BVXI_TRY(look_any(job, v, &look));
    if (!is_wrong_sign(job->o, look, v)) return BVX_OK;
    bvxi_flip_sign(job->o, v);
    for (uint32_t i = 0; i < look->vertices; i++) change_round(job, look->vertex[i]);
    return BVX_OK;
}

/* Vertices on no plane that the smooth number has next to no say of. */
static int is_loose_sign(const bvxi_oblique *o, uint32_t v)
{
    const bvxi_tetra_vertex *const x = &o->vertex[v];
    if (x->sign == 0 || bvxi_first_plane(o, v) != BVXI_NONE) return 0;
    return !x->lattice || (x->value < FREE_VALUE && x->value > -FREE_VALUE);
}

/* All vertices as they are; one with a star too large to be looked at here is judged when its turn comes. */
static void judge_loose_piece(void *user, uint64_t begin, uint64_t end)
{
    const signs_job *const job = user;
    uint32_t block[BVXI_LOOK_WORDS * BVXI_LOOK_MOST];
    bvxi_look look = bvxi_look_in(block, BVXI_LOOK_MOST);
    for (uint64_t i = begin; i < end; i++) {
        uint32_t const v = (uint32_t)i;
        job->wrong[i] = is_loose_sign(job->o, v) &&
                        (!bvxi_look_link(job->o, &look, v) || is_wrong_sign(job->o, &look, v));
    }
}

/* ---- contours' edges ---- */

/* A vertex of the other sign between a contour's edge, or vertex, and another vertex. */
static void set_opposite(bvxi_oblique *o, uint32_t m, uint32_t of)
{
    o->vertex[m].sign = (int8_t)-o->vertex[of].sign;
    o->vertex[m].value = -0.5F * o->vertex[of].value;
    if (o->vertex[m].value == 0.0F) o->vertex[m].value = 1e-12F * (float)o->vertex[m].sign;
}

static bvx_status part_from_edge(bvxi_oblique *o, uint32_t a, uint32_t b, uint32_t u)
{
    int closed;
    uint32_t t = BVXI_NONE, m;
    double at[3];

    /* Of the tetrahedra around the edge two have the vertex; one face between them is split for both. */
    BVXI_TRY(bvxi_tetra_with_edge(o, a, b, &t));
    if (t == BVXI_NONE) return BVX_OK;
    BVXI_TRY(bvxi_tetra_ring(o, t, a, b, &closed));
    for (uint64_t i = 0; i < o->ring_count; i++) {
        const bvxi_tetra *const x = &o->tetra[o->ring[i]];
        if (bvxi_corner_of(x, u) == 4) continue;
        /* Near the edge rather than in the middle: what lies beyond keeps most of its room. */
        for (int k = 0; k < 3; k++)
            at[k] = 0.4 * (o->vertex[a].at[k] + o->vertex[b].at[k]) + 0.2 * o->vertex[u].at[k];
        for (int k = 0; k < 4; k++)
            if (x->v[k] != a && x->v[k] != b && x->v[k] != u) {
                BVXI_TRY(bvxi_tetra_split_face(o, o->ring[i], k, at, &m));
                set_opposite(o, m, u);
                return BVX_OK;
            }
    }
    return BVX_OK;
}

/* Vertices around the edge, into o->star as scratch; their number, or 0 when the ring is open. */
static bvx_status ring_vertices(bvxi_oblique *o, uint32_t a, uint32_t b, uint64_t *count)
{
    uint32_t t;
    int closed;

    *count = 0;
    BVXI_TRY(bvxi_tetra_with_edge(o, a, b, &t));
    if (t == BVXI_NONE) return BVX_OK;
    BVXI_TRY(bvxi_tetra_ring(o, t, a, b, &closed));
    if (!closed) return BVX_OK;

    /* Of each two neighbours in the ring the vertex that both have: so each comes once, in turn. */
    o->star_count = 0;
    for (uint64_t i = 0; i < o->ring_count; i++) {
        const uint32_t *const v = o->tetra[o->ring[i]].v;
        const bvxi_tetra *const next = &o->tetra[o->ring[(i + 1) % o->ring_count]];
        BVXI_TRY(BVXI_GROW(o, o->star, o->star_count, o->star_room, "the vertices round an edge"));
        o->star[o->star_count] = BVXI_NONE;
        for (int k = 3; k >= 0; k--)
            if (v[k] != a && v[k] != b && bvxi_corner_of(next, v[k]) < 4) o->star[o->star_count] = v[k];
        o->star_count++;
    }
    *count = o->star_count;
    return BVX_OK;
}

/* Inside and outside as one stretch each: from the plane's vertex inside on, both ways, the first change is
 * the only one. The vertices that stand against that are parted from the edge. */
static bvx_status settle_edge(bvxi_oblique *o, uint32_t a, uint32_t b, uint32_t plane)
{
    uint64_t n, start, end, wrong;

    do {
        uint64_t changes = 0;
        BVXI_TRY(ring_vertices(o, a, b, &n));
        if (n < 3) return BVX_OK;
        start = end = n;
        for (uint64_t i = 0; i < n; i++) {
            uint32_t const v = o->star[i], w = o->star[(i + 1) % n];
            changes += o->vertex[v].sign != o->vertex[w].sign;
            if (!bvxi_is_on(o, v, plane)) continue;
            if (o->vertex[v].sign > 0 && start == n) start = i;
            if (o->vertex[v].sign < 0 && end == n) end = i;
        }
        if (changes <= 2) return BVX_OK;
        for (uint64_t i = 0; i < n; i++) { /* contours that contradict each other leave the plane no say */
            if (o->vertex[o->star[i]].sign > 0 && start == n) start = i;
            if (o->vertex[o->star[i]].sign < 0 && end == n) end = i;
        }
        wrong = n;
        for (int way = 0; way < 2 && wrong == n; way++) {
            int left = 0;
            for (uint64_t k = 1; k < n && wrong == n; k++) {
                uint64_t const i = way == 0 ? (start + k) % n : (start + n - k) % n;
                if (i == end) break;
                if (o->vertex[o->star[i]].sign < 0) left = 1;
                else if (left && o->vertex[o->star[i]].sign > 0) wrong = i;
            }
        }
        if (wrong == n) return BVX_OK;
        BVXI_TRY(part_from_edge(o, a, b, o->star[wrong]));
    } while (wrong < n);
    return BVX_OK;
}

/* ---- contours' vertices ---- */

/* A vertex not connected with the kept ones of its sign, or BVXI_NONE. Those inside come first. */
static uint32_t find_torn(const bvxi_oblique *o, bvxi_look *l, uint32_t v)
{
    uint32_t const plane = bvxi_first_plane(o, v);
    if (!bvxi_look_torn(o, l, v)) return BVXI_NONE;
    for (int sign = 1; sign >= -1; sign -= 2) {
        /* Kept is what hangs together with a vertex on the first plane, where the contour bounds it. */
        uint32_t keep = BVXI_NONE;
        for (uint32_t i = 0; i < l->vertices; i++) {
            if (l->sign[i] != sign) continue;
            int const on = plane != BVXI_NONE && bvxi_is_on(o, l->vertex[i], plane);
            if (keep == BVXI_NONE || on) keep = bvxi_root(l->joined, i);
            if (on) break;
        }
        for (uint32_t i = 0; i < l->vertices; i++)
            if (l->sign[i] == sign && bvxi_root(l->joined, i) != keep) return l->vertex[i];
    }
    return BVXI_NONE;
}

static bvx_status oblique_settle_vertex(signs_job *job, uint32_t v)
{
    bvxi_oblique *const o = job->o;

    for (;;) {
        bvxi_look *look;
        uint32_t wrong, t, m;
        double at[3];

        BVXI_TRY(look_any(job, v, &look));
        wrong = find_torn(o, look, v);
        if (wrong == BVXI_NONE) return BVX_OK;
        for (int k = 0; k < 3; k++) at[k] = 0.75 * o->vertex[v].at[k] + 0.25 * o->vertex[wrong].at[k];
        BVXI_TRY(bvxi_tetra_with_edge(o, v, wrong, &t));
        if (t == BVXI_NONE) return BVX_OK;
        /* The star of v is still there from the search; the ring that is split is in it. */
        for (uint64_t i = 0; i < o->star_count; i++)
            for (int k = 0; k < 4; k++) change_round(job, o->tetra[o->star[i]].v[k]);
        BVXI_TRY(bvxi_tetra_split_edge(o, t, v, wrong, at, &m));
        set_opposite(o, m, wrong);
    }
}

static void judge_vertex_piece(void *user, uint64_t begin, uint64_t end)
{
    const signs_job *const job = user;
    const bvxi_oblique *const o = job->o;
    uint32_t block[BVXI_LOOK_WORDS * BVXI_LOOK_MOST];
    bvxi_look look = bvxi_look_in(block, BVXI_LOOK_MOST);
    for (uint64_t i = begin; i < end; i++)
        job->wrong[i] = o->vertex[i].sign == 0 &&
                        (!bvxi_look_link(o, &look, (uint32_t)i) || bvxi_look_torn(o, &look, (uint32_t)i));
}

bvx_status bvxi_oblique_signs(bvxi_oblique *o)
{
    const bvxi_map *const m = &o->contour_edge;
    signs_job job = {.o = o};
    uint32_t *torn = NULL;
    uint64_t count = 0;

    BVXI_TRY(
        BVXI_SHARE(o->ctx, 0.0, 0.2, bvxi_for(o->ctx, "surface", o->vertex_count, 256, signs_piece, &job)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.2, 0.4, bvxi_oblique_part_contours(o)));

    job.vertices = o->vertex_count;
    job.small = bvxi_look_in(job.block, BVXI_LOOK_MOST);
    BVXI_TRY(BVXI_ARRAY(o->ctx, job.vertices, "the vertices to settle", job.wrong));
    BVXI_TRY(BVXI_ARRAY(o->ctx, job.vertices, "the vertices to settle", job.again));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.4, 0.5, bvxi_oblique_regions(o, &torn, &count)));
    /* Vertices that planes contradict each other of come first: others look at their signs. They get the sign that
     * leaves the body simple, whosever it is. */
    for (uint64_t i = 0; i < count; i++) BVXI_TRY(settle_sign(&job, torn[i]));
    /* So do those off all planes that lie between contours or next to the surface. */
    memset(job.again, 0, (size_t)job.vertices);
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.5, 0.64,
                        bvxi_for(o->ctx, "surface", job.vertices, 256, judge_loose_piece, &job)));
    for (uint32_t v = 0; v < job.vertices; v++)
        if (job.wrong[v] || (job.again[v] && is_loose_sign(o, v))) BVXI_TRY(settle_sign(&job, v));
    for (uint64_t i = 0; i < m->room; i++) {
        if (i % 4096 == 0)
            BVXI_TRY(bvxi_progress(o->ctx, "surface", 0.64 + 0.18 * (double)i / (double)m->room));
        if (m->key[i] == UINT64_MAX || m->value[i] == BVXI_NONE) continue;
        BVXI_TRY(settle_edge(o, (uint32_t)(m->key[i] >> 32), (uint32_t)m->key[i], m->value[i] / 2));
    }
    memset(job.again, 0, (size_t)job.vertices);
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.82, 1.0,
                        bvxi_for(o->ctx, "surface", job.vertices, 256, judge_vertex_piece, &job)));
    for (uint64_t v = 0; v < job.vertices; v++)
        if (o->vertex[v].sign == 0 && (job.wrong[v] || job.again[v]))
            BVXI_TRY(oblique_settle_vertex(&job, (uint32_t)v));
    return BVX_OK;
}
