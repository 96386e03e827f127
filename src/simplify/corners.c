/* corners.c - a corner table set up, and packed after collapses.
 *
 * Source: Chiba, Nishizeki. Arboricity and Subgraph Listing Algorithms. 1985: a walk over the neighbours of
 * each edge's end of fewer neighbours costs O(edges) in all on surfaces.
 *
 * Every edge waits at its end of fewer triangles for its second side. Guarantee: what bvxi_corners_connect
 * accepts is closed, edge- and vertex-manifold and oriented. */
#include "simplify/corners.h"

/* ---- Connecting ---- */

/* Edges that wait, by their end. */
typedef struct edge_lists {
    int32_t *first;   /* the corner opposite to the last edge that began to wait at each vertex, or -1 [Size:
                         vertices] */
    int32_t *next;    /* the one before, of each corner [Size: triangles * 4] */
    uint32_t *around; /* triangles of each vertex [Size: vertices] */
} edge_lists;

static bvx_status fail_edge(bvx_context *ctx, const char *function, uint32_t u, uint32_t v)
{
    return bvxi_fail(ctx, BVX_ERR_ARGUMENT,
                     "%s: the mesh is not closed, manifold and oriented: the edge between vertices %u and %u "
                     "does not have "
                     "two triangles that run along it in opposite directions; bvx_repair makes such a mesh",
                     function, (uint64_t)u, (uint64_t)v);
}

/* Join a corner with the one that waits across its edge, or let it wait; 0 when the edge has too many sides,
 * or two that run the same way. */
static int pair_corner(bvxi_corners *m, edge_lists *lists, int32_t c)
{
    uint32_t const u = bvxi_corner_vertex_of(m, bvxi_corner_next(c)),
                   v = bvxi_corner_vertex_of(m, bvxi_corner_previous(c));
    int const at_u = lists->around[u] < lists->around[v] || (lists->around[u] == lists->around[v] && u < v);
    uint32_t const end = at_u ? u : v;

    for (int32_t e = lists->first[end]; e >= 0; e = lists->next[e]) {
        uint32_t const a = bvxi_corner_vertex_of(m, bvxi_corner_next(e)),
                       b = bvxi_corner_vertex_of(m, bvxi_corner_previous(e));

        if (a == u && b == v) return 0;
        if (a != v || b != u) continue;
        if (bvxi_corner_opposite(m, e) >= 0) return 0;
        bvxi_corners_join(m, c, e);
        return 1;
    }

    m->triangle[c >> 2].opposite[c & 3] = -1;
    lists->next[c] = lists->first[end];
    lists->first[end] = c;
    return u != v;
}

/* Join all corners across their edges. A refusal names the two ends of the first edge that has one side, three
 * or more, or two that run the same way. */
static bvx_status pair_corners(bvx_context *ctx, const char *function, bvxi_corners *m, edge_lists *lists)
{
    int32_t const end = (int32_t)(4 * m->triangles);

    for (uint64_t v = 0; v < m->vertices; v++) {
        lists->first[v] = -1;
        lists->around[v] = 0;
    }
    for (uint64_t t = 0; t < m->triangles; t++)
        for (int k = 0; k < 3; k++) lists->around[m->triangle[t].vertex[k]]++;

    for (int32_t c = 0; c < end; c += (c & 3) == 2 ? 2 : 1)
        if (!pair_corner(m, lists, c))
            return fail_edge(ctx, function, bvxi_corner_vertex_of(m, bvxi_corner_next(c)),
                             bvxi_corner_vertex_of(m, bvxi_corner_previous(c)));

    for (int32_t c = 0; c < end; c += (c & 3) == 2 ? 2 : 1)
        if (bvxi_corner_opposite(m, c) < 0)
            return fail_edge(ctx, function, bvxi_corner_vertex_of(m, bvxi_corner_next(c)),
                             bvxi_corner_vertex_of(m, bvxi_corner_previous(c)));
    return BVX_OK;
}

/* A vertex whose fan is not all of its corners joins two fans. first: a corner of each vertex. */
static bvx_status check_fans(bvx_context *ctx, const char *function, const bvxi_corners *m, int32_t *first)
{
    uint64_t reached = 0;

    for (uint64_t v = 0; v < m->vertices; v++) first[v] = -1;
    for (uint64_t t = 0; t < m->triangles; t++)
        for (int k = 0; k < 3; k++) first[m->triangle[t].vertex[k]] = (int32_t)(4 * t) + k;

    for (uint64_t v = 0; v < m->vertices; v++) {
        int32_t c = first[v];

        if (c < 0) continue;
        do {
            reached++;
            c = bvxi_corner_turn_left(m, c);
        } while (c != first[v]);
    }
    if (reached == 3 * m->triangles) return BVX_OK;
    return bvxi_fail(
        ctx, BVX_ERR_ARGUMENT,
        "%s: the mesh is not manifold: a vertex joins several fans of triangles; bvx_repair parts them",
        function);
}

bvx_status bvxi_corners_connect(bvx_context *ctx, const char *function, bvxi_corners *m)
{
    uint64_t const bytes = m->triangles * 16 + m->vertices * 8;
    edge_lists lists;
    bvx_status status;

    m->left = m->triangles;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the edges", &lists.next));
    lists.first = lists.next + 4 * m->triangles;
    lists.around = (uint32_t *)(void *)(lists.first + m->vertices);

    status = pair_corners(ctx, function, m, &lists);
    if (status == BVX_OK) status = check_fans(ctx, function, m, lists.first);
    bvxi_free(ctx, lists.next, bytes);
    return status;
}

/* ---- Packing ---- */

/* Mark the vertices that triangles still use, then move these together. */
static void pack_vertices(bvxi_corners *m, uint32_t *moved)
{
    uint32_t kept = 0;

    for (uint64_t v = 0; v < m->vertices; v++) moved[v] = BVXI_VERTEX_NONE;
    for (uint64_t t = 0; t < m->triangles; t++)
        if (m->triangle[t].vertex[0] != BVXI_VERTEX_NONE)
            for (int k = 0; k < 3; k++) moved[m->triangle[t].vertex[k]] = 0;

    for (uint64_t v = 0; v < m->vertices; v++) {
        if (moved[v] == BVXI_VERTEX_NONE) continue;
        m->at[kept] = m->at[v];
        m->facing[kept] = m->facing[v];
        moved[v] = kept++;
    }
    m->vertices = kept;
}

void bvxi_corners_pack(bvxi_corners *m, uint32_t *moved)
{
    uint64_t kept = 0;

    pack_vertices(m, moved);

    /* Opposites point both ways: where a triangle moves to, its neighbours point at once. What lies ahead is
     * found there when its turn comes, what lies behind has its new place already. */
    for (uint64_t t = 0; t < m->triangles; t++) {
        bvxi_corner_triangle moving = m->triangle[t];

        if (moving.vertex[0] == BVXI_VERTEX_NONE) continue;
        for (int k = 0; k < 3; k++) {
            moving.vertex[k] = moved[moving.vertex[k]];
            m->triangle[moving.opposite[k] >> 2].opposite[moving.opposite[k] & 3] = (int32_t)(4 * kept) + k;
        }
        m->triangle[kept++] = moving;
    }
    m->triangles = m->left = kept;
}
