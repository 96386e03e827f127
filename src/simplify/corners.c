/* corners.c - a corner table set up, and packed after collapses.
 *
 * Source: Chiba, Nishizeki. Arboricity and Subgraph Listing Algorithms. 1985: a walk over the neighbours of
 * each edge's end of fewer neighbours costs O(edges) in all on surfaces.
 *
 * Every edge waits at its end of fewer triangles for its second side. Guarantee: what bvxi_corners_connect
 * accepts is closed (by ghosts where it has borders), edge- and vertex-manifold and oriented. */
#include "simplify/corners.h"

/* ---- Connecting ---- */

enum {
    EDGE_CROWD = 48,     /* triangles around a vertex whose list would be too long */
    CORNER_GRAIN = 4096, /* triangles of a task */
};

/* A corner whose edge waits at one of its ends for its second side. */
typedef struct edge_wait {
    uint32_t other; /* end of the edge */
    int32_t corner, next;
} edge_wait;

typedef struct edge_lists {
    int32_t *first;   /* the last that began to wait at each vertex, or -1 [Size: vertices] */
    uint32_t *around; /* triangles of each vertex [Size: vertices] */
    edge_wait *wait;  /* of each corner [Size: triangles * 3] */
} edge_lists;

/* Edges whose end with the list is of some vertices are paired by a task; then corners are looked at by others. */
typedef struct edge_job {
    bvxi_corners *m;
    edge_lists *lists;
    int32_t borders;
    int32_t failed[BVXI_MOST_PIECES]; /* of each piece: the first corner that it refused, or that after all */
    uint64_t
        count[BVXI_MOST_PIECES]; /* of each piece: borders, or corners that the walks around vertices reach */
} edge_job;

/* Across the edge of the first corner that waited at an edge whose sides are all borders. */
#define CORNER_CUT (-2)

/* The corner across an edge, or what is negative. */
static int32_t across_edge(const bvxi_corners *m, int32_t c)
{
    int32_t const left = bvxi_corner_turn_left(m, bvxi_corner_previous(c));
    return left < 0 ? left : bvxi_corner_previous(left);
}

static bvx_status fail_edge(bvx_context *ctx, const char *function, const bvxi_corners *m, int32_t corner)
{
    const double *const p = m->at[bvxi_corner_vertex_of(m, bvxi_corner_next(corner))].p;
    const double *const q = m->at[bvxi_corner_vertex_of(m, bvxi_corner_previous(corner))].p;
    return bvxi_fail_for(
        ctx, BVX_ERR_ARGUMENT, BVX_REASON_TOPOLOGY,
        "%s: the mesh is not closed, manifold and oriented: the edge from (%g, %g, %g) to (%g, %g, "
        "%g) does not have two triangles that run along it in opposite directions; bvx_repair makes "
        "such a mesh",
        function, p[0], p[1], p[2], q[0], q[1], q[2]);
}

/* Make borders of both sides of an edge, or of the one that waits. */
static void cut_both_sides(bvxi_corners *m, int32_t waiting)
{
    int32_t const other = across_edge(m, waiting);
    if (other >= 0) bvxi_corner_put_left(m, bvxi_corner_previous(other), -1);
    bvxi_corner_put_left(m, bvxi_corner_previous(waiting), CORNER_CUT);
}

/* Join a corner, whose edge runs from u to v, with the one that waits across it, or let it wait, where its list is of
 * vertex begin or one of `count` from there on; 0 when the edge has too many sides, or two that run the same way. */
BVXI_VECTOR_INLINE int pair_corner(bvxi_corners *m, edge_lists *lists, int32_t c, uint32_t u, uint32_t v,
                                   int borders, uint64_t begin, uint64_t count)
{
    /* The lower end has the list, or that of fewer triangles where the lower one has very many. */
    uint32_t const low = u < v ? u : v, high = u < v ? v : u;
    int const crowded = BVXI_UNLIKELY(lists->around[low] > EDGE_CROWD) &&
                        lists->around[high] < lists->around[low];
    uint32_t const end = crowded ? high : low, other = crowded ? low : high;
    int32_t const own = c - (c >> 2);
    edge_wait *wait;

    if (end - begin >= count) return 1;
    for (int32_t i = lists->first[end]; i >= 0; i = wait->next) {
        int32_t e;

        wait = &lists->wait[i];
        if (wait->other != other) continue;

        /* Opposite directions, and nobody else has joined it: a pair. */
        e = wait->corner;
        if (bvxi_corner_vertex_of(m, bvxi_corner_next(e)) == v && across_edge(m, e) == -1) {
            bvxi_corners_join(m, c, e);
            return 1;
        }

        /* A third side, or two that run the same way. */
        if (borders != BVXI_BORDERS_CUT) return 0;
        cut_both_sides(m, e);
        return 1;
    }

    wait = &lists->wait[own];
    wait->other = other;
    wait->corner = c;
    wait->next = lists->first[end];
    lists->first[end] = own;
    return u != v;
}

/* Empty lists, and the triangles around each of some vertices. */
static void lists_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const edge_job *const job = user;
    edge_lists *const lists = job->lists;

    (void)piece;
    memset(lists->first + begin, 0xff, (size_t)(end - begin) * sizeof *lists->first); /* -1 */
    memset(lists->around + begin, 0, (size_t)(end - begin) * sizeof *lists->around);
    for (uint64_t t = 0; t < job->m->triangles; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t const v = job->m->triangle[t].vertex[k];

            if (v - begin < end - begin) lists->around[v]++;
        }
}

/* Corners of all triangles in their order: edges have one list each, so no two tasks write the same. */
static void edges_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    edge_job *const job = user;
    bvxi_corners *const m = job->m;
    int32_t const last = (int32_t)(4 * m->triangles);
    uint64_t const count = end - begin;
    for (int32_t c = 0; c < last; c += 4) {
        const bvxi_corner_triangle *const t = &m->triangle[c >> 2];
        uint32_t const u = t->vertex[0], v = t->vertex[1], w = t->vertex[2];
        int32_t *const failed = &job->failed[index];

        if (!((u - begin < count) | (v - begin < count) | (w - begin < count))) continue;
        *failed = c;
        if (!pair_corner(m, job->lists, c, v, w, job->borders, begin, count)) return;
        *failed = c + 1;
        if (!pair_corner(m, job->lists, c + 1, w, u, job->borders, begin, count)) return;
        *failed = c + 2;
        if (!pair_corner(m, job->lists, c + 2, u, v, job->borders, begin, count)) return;
    }
    job->failed[index] = last;
}

static int is_border(const bvxi_corners *m, int32_t c)
{
    int32_t const opposite = across_edge(m, c);
    return opposite < 0 || bvxi_corner_is_ghost(m, opposite);
}

/* The border edge that goes on where that of corner c ends: at the other end of the fan around the vertex
 * between. *triangles becomes how many that fan has. */
static int32_t next_border(const bvxi_corners *m, int32_t c, int32_t *triangles)
{
    int32_t at = bvxi_corner_previous(c);
    /* Turning around the vertex until an edge has no triangle beyond it. */
    for (*triangles = 1; !is_border(m, bvxi_corner_previous(at)); ++*triangles)
        at = bvxi_corner_next(bvxi_corner_turn_left(m, bvxi_corner_next(at)));
    return bvxi_corner_previous(at);
}

/* A cut as short as one edge leaves two edges between the same vertices: it goes on through the middle of the
 * triangles around one of them, which so becomes two. */
static void lengthen_cut(bvxi_corners *m, int32_t c)
{
    int32_t fan, back, at = bvxi_corner_previous(c);
    int32_t const next = next_border(m, c, &fan);

    if (bvxi_corner_vertex_of(m, bvxi_corner_previous(next)) !=
            bvxi_corner_vertex_of(m, bvxi_corner_next(c)) ||
        next_border(m, next, &back) != c)
        return;

    /* Half way around the fan, where the new border is as far from the old one as it can be. */
    for (int32_t i = 1; i < fan / 2; i++)
        at = bvxi_corner_next(bvxi_corner_turn_left(m, bvxi_corner_next(at)));
    cut_both_sides(m, bvxi_corner_previous(at));
}

static void open_triangles_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const edge_job *const job = user;
    (void)piece;
    for (uint64_t t = begin; t < end; t++)
        for (int k = 0; k < 3; k++) job->m->triangle[t].left[k] = -1;
}

/* What still waits is a border. */
static void borders_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    edge_job *const job = user;
    uint64_t count = 0;

    job->failed[piece] = (int32_t)(4 * job->m->triangles);
    for (int32_t c = (int32_t)(4 * end); c > (int32_t)(4 * begin);) {
        c -= (c & 3) == 0 ? 2 : 1;
        if (across_edge(job->m, c) >= 0) continue;
        job->failed[piece] = c;
        count++;
    }
    job->count[piece] = count;
}

/* The first corner that a piece refused. */
static int32_t first_failed(const edge_job *job, int32_t pieces)
{
    int32_t failed = job->failed[0];
    for (int32_t i = 1; i < pieces; i++) failed = job->failed[i] < failed ? job->failed[i] : failed;
    return failed;
}

/* Join all corners across their edges, and count borders as ghosts. A refusal names the two ends of the first
 * edge that has one side, three or more, or two that run the same way. */
static bvx_status pair_corners(bvx_context *ctx, const char *function, bvxi_corners *m, edge_lists *lists,
                               int borders)
{
    int32_t const end = (int32_t)(4 * m->triangles), looking = bvxi_looking_pieces(ctx);
    int32_t const pieces = bvxi_piece_count(m->triangles, CORNER_GRAIN);
    edge_job job = {.m = m, .lists = lists, .borders = borders};

    bvxi_ranges(ctx, looking, m->vertices, lists_piece, &job);
    bvxi_ranges(ctx, pieces, m->triangles, open_triangles_piece, &job);
    bvxi_ranges(ctx, looking, m->vertices, edges_piece, &job);
    int32_t const failed = first_failed(&job, looking);
    if (failed < end) return fail_edge(ctx, function, m, failed);

    /* Corners are numbered by fours: the fourth is left out. */
    for (int32_t c = 0; c < end && borders == BVXI_BORDERS_CUT; c += (c & 3) == 2 ? 2 : 1)
        if (is_border(m, c)) lengthen_cut(m, c);

    bvxi_ranges(ctx, pieces, m->triangles, borders_piece, &job);
    m->ghosts = bvxi_place_counts(job.count, (uint64_t)pieces);
    if (m->ghosts == 0 || borders != BVXI_BORDERS_REFUSED) return BVX_OK;
    return fail_edge(ctx, function, m, first_failed(&job, pieces));
}

static void walk_fans_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    edge_job *const job = user;
    int32_t *const any = job->lists->first;
    uint64_t reached = 0;

    bvxi_corners_any(job->m, begin, end, any);
    for (uint64_t v = begin; v < end; v++) {
        int32_t c = any[v];

        do {
            reached++;
            c = bvxi_corner_turn_left(job->m, c);
        } while (c != any[v]);
    }
    job->count[piece] = reached;
}

/* ---- Borders ---- */

/* Give every border edge its ghost triangle, whose corner 0 is the ghost. */
static void put_ghosts(bvxi_corners *m)
{
    int32_t const end = (int32_t)(4 * m->triangles);
    int32_t ghost = end;

    for (int32_t c = 0; c < end; c += (c & 3) == 2 ? 2 : 1) {
        uint32_t *const v = m->triangle[ghost >> 2].vertex;

        if (across_edge(m, c) >= 0) continue;

        /* Turned against the edge, as a neighbour is. */
        v[0] = BVXI_VERTEX_GHOST;
        v[1] = bvxi_corner_vertex_of(m, bvxi_corner_previous(c));
        v[2] = bvxi_corner_vertex_of(m, bvxi_corner_next(c));
        bvxi_corners_join(m, c, ghost);
        ghost += 4;
    }

    /* Join ghosts with the next ones of their borders: the next border edge is found around the vertex
     * between. */
    for (ghost = end; ghost < end + (int32_t)(4 * m->ghosts); ghost += 4) {
        int32_t fan;
        int32_t const next = next_border(m, bvxi_corner_opposite(m, ghost), &fan);
        bvxi_corners_join(m, ghost + 2, bvxi_corner_opposite(m, next) + 1);
    }
}

/* Walk every fan once. The first fan of a vertex keeps it, others get new
 * vertices from `fresh` on; with fresh 0 they are counted only. first,
 * seen: scratch of each vertex and of each corner. Returns fans that share. */
static uint64_t part_fans(bvxi_corners *m, int32_t *first, int32_t *seen, uint64_t fresh)
{
    int32_t const end = (int32_t)(4 * m->triangles);
    uint64_t shared = 0;

    memset(first, 0, (size_t)m->vertices * sizeof *first);
    memset(seen, 0, (size_t)end * sizeof *seen);
    for (int32_t start = 0; start < end; start += (start & 3) == 2 ? 2 : 1) {
        uint32_t v = bvxi_corner_vertex_of(m, start);
        int32_t c = start;

        if (seen[start]) continue;

        /* The first fan keeps the vertex, the others get copies of it. */
        if (first[v]++ > 0) {
            if (fresh != 0) {
                m->at[fresh + shared] = m->at[v];
                m->source[fresh + shared] = m->source[v];
                v = (uint32_t)(fresh + shared);
            }
            shared++;
        }

        /* Once around the fan; ghosts close those that end at borders. */
        do {
            if (!bvxi_corner_is_ghost(m, c)) seen[c] = 1;
            m->triangle[c >> 2].vertex[c & 3] = v;
            c = bvxi_corner_turn_left(m, c);
        } while (c != start);
    }
    return shared;
}

/* Parts that touch in a vertex touch no more: each has one of its own there. */
static bvx_status part_vertices(bvx_context *ctx, bvxi_corners *m)
{
    int32_t *first, *seen;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, m->vertices * 4, "the vertices' fans", &first));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, m->triangles * 16, "the corners' fans", &seen));
    uint64_t const shared = part_fans(m, first, seen, 0);
    for (uint64_t v = 0; v < m->vertices; v++) m->split += first[v] > 1;
    BVXI_TRY(bvxi_resize(ctx, BVXI_SCRATCH, &m->source, m->vertex_room * 4, (m->vertices + shared) * 4,
                         "the sources of parts that touch"));
    BVXI_TRY(bvxi_reserve(ctx, &m->at, m->vertices + shared, &m->vertex_room, sizeof *m->at,
                          "the vertices of parts that touch"));
    part_fans(m, first, seen, m->vertices);
    m->vertices += shared;
    bvxi_drop(ctx, seen);
    bvxi_drop(ctx, first);
    return BVX_OK;
}

bvx_status bvxi_corners_connect(bvx_context *ctx, const char *function, bvxi_corners *m, int borders)
{
    uint64_t const bytes = m->triangles * 3 * sizeof(edge_wait) + m->vertices * 8;
    edge_lists lists;

    m->left = m->triangles;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the edges", &lists.wait));
    lists.first = (int32_t *)(void *)(lists.wait + 3 * m->triangles);
    lists.around = (uint32_t *)(void *)(lists.first + m->vertices);

    BVXI_TRY(pair_corners(ctx, function, m, &lists, borders));
    if (m->ghosts != 0) {
        uint64_t const room = m->triangles + m->ghosts;
        /* Corners are numbers of 31 bits, four a triangle. */
        if (room > INT32_MAX / 4)
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                "%s: %u triangles with %u border edges are too many; %u together are possible", function,
                m->triangles, m->ghosts, (uint64_t)INT32_MAX / 4);
        BVXI_TRY(bvxi_reserve(ctx, &m->triangle, room, &m->triangle_room, sizeof *m->triangle,
                              "the triangles and their borders"));
        put_ghosts(m);
    }

    /* 1: the corners of every vertex are one fan, which is walked from any of them. */
    int32_t const pieces = bvxi_looking_pieces(ctx);
    edge_job job = {.m = m, .lists = &lists};

    bvxi_ranges(ctx, pieces, m->vertices, walk_fans_piece, &job);
    int const one = bvxi_place_counts(job.count, (uint64_t)pieces) == 3 * m->triangles + 2 * m->ghosts;

    bvxi_drop(ctx, lists.wait);
    if (one) return BVX_OK;
    if (borders == BVXI_BORDERS_REFUSED)
        return bvxi_fail_for(
            ctx, BVX_ERR_ARGUMENT, BVX_REASON_TOPOLOGY,
            "%s: the mesh is not manifold: a vertex joins several fans of triangles; bvx_repair parts them",
            function);
    return part_vertices(ctx, m);
}
