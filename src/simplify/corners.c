/* corners.c - a corner table set up, and packed after collapses.
 *
 * Corners that face each other across an edge are found by sorting the edges by their ends: neighbours in that order are
 * the two sides of one edge. Guarantee: what bvxi_corners_connect accepts is closed, edge- and vertex-manifold and oriented. */
#include "simplify/corners.h"
#include "mesh/radix.h"

/* ---- Connecting ---- */

static bvx_status fail_edge(bvx_context *ctx, const char *function, uint64_t key)
{
    return bvxi_fail(ctx, BVX_ERR_ARGUMENT,
                     "%s: the mesh is not closed, manifold and oriented: the edge between vertices %u and %u does not have "
                     "two triangles that run along it in opposite directions; bvx_repair makes such a mesh",
                     function, key >> 32, key & UINT32_MAX);
}

static bvx_status pair_corners(bvx_context *ctx, const char *function, bvxi_corners *m, uint64_t *keys, uint32_t *corner)
{
    uint64_t const n = 3 * m->triangles;

    for (uint64_t i = 0; i < n; i++) {
        int32_t const c = (int32_t)(4 * (i / 3) + i % 3);
        uint64_t const u = bvxi_corner_vertex_of(m, bvxi_corner_next(c)), v = bvxi_corner_vertex_of(m, bvxi_corner_previous(c));

        keys[i] = u < v ? u << 32 | v : v << 32 | u;
        corner[i] = (uint32_t)c;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, keys, corner, n));

    for (uint64_t i = 0; i < n; i += 2) {
        int32_t const a = (int32_t)corner[i];
        int32_t b;

        if (i + 1 == n || keys[i] != keys[i + 1] || (i + 2 < n && keys[i] == keys[i + 2]) || keys[i] >> 32 == (keys[i] & UINT32_MAX))
            return fail_edge(ctx, function, keys[i]);

        b = (int32_t)corner[i + 1];
        if (bvxi_corner_vertex_of(m, bvxi_corner_next(a)) == bvxi_corner_vertex_of(m, bvxi_corner_next(b)))
            return fail_edge(ctx, function, keys[i]);
        bvxi_corners_join(m, a, b);
    }
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
    return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the mesh is not manifold: a vertex joins several fans of triangles; bvx_repair parts them",
                     function);
}

bvx_status bvxi_corners_connect(bvx_context *ctx, const char *function, bvxi_corners *m)
{
    uint64_t const corners = 3 * m->triangles, bytes = corners * 12 > m->vertices * 4 ? corners * 12 : m->vertices * 4;
    unsigned char *sorting;
    bvx_status status;

    m->left = m->triangles;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the edges", &sorting));
    status = pair_corners(ctx, function, m, (uint64_t *)(void *)sorting, (uint32_t *)(void *)(sorting + corners * 8));
    if (status == BVX_OK) status = check_fans(ctx, function, m, (int32_t *)(void *)sorting);
    bvxi_free(ctx, sorting, bytes);
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

    /* Opposites point both ways: where a triangle moves to, its neighbours point at once. What lies ahead is found there
     * when its turn comes, what lies behind has its new place already. */
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
