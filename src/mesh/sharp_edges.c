/* sharp_edges.c - has a mesh sharp edges, as machine parts have?
 *
 * Measured is length: of the edges between two triangles, of those whose facets meet at an angle, and of
 * those that are merely bent. A part of planes has much of the first and little of the second; a scan, a
 * coarse ball or terrain have bent edges of all angles. */
#include "mesh/topology.h"
#include "mesh/facet.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

enum { SHARP_MOST = 500000 }; /* meshes of more triangles are scans */

/* Edges whose facets meet at more than 40 degrees are sharp, at more than 15 bent: cosines. */
#define SHARP_COSINE 0.766
#define BENT_COSINE  0.966

/* Of the length of all edges: where few are bent, and anyhow (coarse cylinders). To one of bent ones. */
#define SHARP_SHARE        0.01
#define SHARP_SHARE_ANYHOW 0.1
#define SHARP_TO_BENT      2.0

/* Lengths of the edges between two triangles: of all, of those that are bent, of those that are sharp. */
typedef struct edge_lengths {
    double all, bent, sharp;
} edge_lengths;

static void welded_triangle(const bvx_mesh_view *mesh, const uint32_t *representative, uint64_t t,
                            uint32_t v[3])
{
    bvxi_view_triangle(mesh, t, v);
    for (int k = 0; k < 3; k++) v[k] = representative[v[k]];
}

/* Two sides (3 * triangle + k: from corner k to the next) of one edge. */
static void add_edge(const bvx_mesh_view *mesh, const uint32_t *representative, const double *facet,
                     uint32_t one, uint32_t other, edge_lengths *sum)
{
    const double *const n = facet + 4 * (size_t)(one / 3), *const m = facet + 4 * (size_t)(other / 3);
    double p[2][3], length = 0, cosine = bvxi_vec_dot(n, m);
    uint32_t v[3], w[3];

    if (!(n[3] > 0) || !(m[3] > 0)) return;
    welded_triangle(mesh, representative, one / 3, v);
    welded_triangle(mesh, representative, other / 3, w);
    for (uint32_t k = 0; k < 2; k++) bvxi_view_position(mesh, v[(one + k) % 3], p[k]);

    /* Sides that run the same way belong to triangles of opposite orientation. */
    if (v[one % 3] == w[other % 3]) cosine = -cosine;
    for (int a = 0; a < 3; a++) length += (p[1][a] - p[0][a]) * (p[1][a] - p[0][a]);
    length = sqrt(length);

    sum->all += length;
    if (cosine < SHARP_COSINE) sum->sharp += length;
    else if (cosine < BENT_COSINE) sum->bent += length;
}

static bvx_status judge_edges(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                              int32_t *sharp)
{
    uint64_t const bytes = view->triangle_count * 36;
    edge_lengths sum = {0, 0, 0};
    unsigned char *block;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the edges' lengths", &block));

    uint64_t *const keys = (uint64_t *)(void *)block;
    uint32_t *const side = (uint32_t *)(void *)(block + view->triangle_count * 24);
    uint64_t const n = 3 * view->triangle_count;
    double *facet;

    for (uint64_t i = 0; i < n; i++) {
        uint32_t v[3];
        welded_triangle(view, representative, i / 3, v);
        uint64_t const a = v[i % 3];
        uint64_t const b = v[(i + 1) % 3];
        keys[i] = a < b ? a << 32 | b : b << 32 | a;
        side[i] = (uint32_t)i;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, keys, side, n));
    /* Once each, in less room than sorting took. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, view->triangle_count * 32, "the facets' normals", &facet));
    /* By triangle: the normal of length 1, and twice the area, 0 without a normal. */
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        double *const own = facet + 4 * t, p[3][3];
        uint32_t v[3];
        welded_triangle(view, representative, t, v);
        for (int k = 0; k < 3; k++) bvxi_view_position(view, v[k], p[k]);
        own[3] = bvxi_facet_normal((const double(*)[3])p, own);
        for (int a = 0; a < 3 && own[3] > 0; a++) own[a] /= own[3];
    }

    for (uint64_t i = 0; i + 1 < n; i++) {
        if (keys[i] != keys[i + 1]) continue;
        add_edge(view, representative, facet, side[i], side[i + 1], &sum);
        i++;
    }
    double const share = sum.all > 0 ? sum.sharp / sum.all : 0;
    *sharp = share > SHARP_SHARE_ANYHOW || (share > SHARP_SHARE && sum.sharp > SHARP_TO_BENT * sum.bent);
    return BVX_OK;
}

bvx_status bvxi_sharp_edges(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                            int32_t *sharp)
{
    uint64_t const bytes = view->vertex_count * 4;
    uint32_t *found = NULL;
    uint64_t different;
    *sharp = 0;
    if (view->triangle_count > SHARP_MOST) return BVX_OK;
    if (representative != NULL) return judge_edges(ctx, view, representative, sharp);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' places", &found));
    BVXI_TRY(bvxi_weld(ctx, view, found, &different));
    return judge_edges(ctx, view, found, sharp);
}
