/* edge_balance.c - is a snapped mesh closed and its triangles of one mind? Told without looking for a single
 * edge.
 *
 * Every position has a number of 32 bits, well mixed from its coordinates. An edge from a to b adds a b (b -
 * a), modulo 2^64; the three of a triangle together are (b - a) (c - a) (c - b), after Vandermonde. What two
 * triangles add along an edge in opposite directions cancels, so the sum of all is 0 when triangles run along
 * each edge as often one way as the other. When not, the sum is a polynomial of mixed numbers that is not
 * zero, and 0 by chance alone (about 2^-30): such a mesh would be taken for closed.
 *
 * Source: Schwartz. Fast Probabilistic Algorithms for Verification of Polynomial Identities. 1980.
 * Guarantee: the answer follows from the snapped triangles only, on every machine. */
#include "solid/solid.h"

enum { BALANCE_GRAIN = 8192, BALANCE_PIECES = 64 };

typedef struct balance_work {
    const bvx_mesh_view *view;
    const int32_t *xyz;
    uint32_t *mixed; /* by vertex */
    /* bad: the first triangle with an index beyond the vertices, or UINT64_MAX */
    uint64_t sum[BALANCE_PIECES], bad[BALANCE_PIECES];
    int32_t pieces;
} balance_work;

static inline uint64_t mix_once(uint64_t h)
{
    h *= UINT64_C(0x9e3779b97f4a7c15);
    return h ^ h >> 32;
}

static void mix_vertices(void *user, uint64_t begin, uint64_t end)
{
    const balance_work *const w = user;

    for (uint64_t v = begin; v < end; v++) {
        const int32_t *const p = w->xyz + 3 * v;
        uint64_t const xy = (uint64_t)(uint32_t)p[0] << 32 | (uint32_t)p[1];

        /* Two rounds, so that neighbouring places have numbers far apart. */
        w->mixed[v] =
            (uint32_t)(mix_once(mix_once(xy + 1) ^ (uint64_t)(uint32_t)p[2] << 16 ^ (uint32_t)p[2]) >> 16);
    }
}

/* Returns where it stopped: end, or at a triangle with an index beyond the vertices, so that the view need not be gone
 * over before. packed: three uint32_t a triangle, a constant. */
BVXI_VECTOR_INLINE uint64_t sum_until(const balance_work *w, uint64_t t, uint64_t end, int packed,
                                      uint64_t *sum)
{
    const unsigned char *const indices = packed ? bvxi_view_index_at(w->view, 0) : NULL;
    uint64_t const vertices = w->view->vertex_count;
    uint64_t s = 0;

    for (; t < end; t++) {
        uint32_t c[3];

        if (packed) memcpy(c, indices + 12 * t, sizeof c);
        if (BVXI_UNLIKELY(packed ? (c[0] >= vertices) | (c[1] >= vertices) | (c[2] >= vertices)
                                 : !bvxi_view_triangle(w->view, t, c)))
            break;
        uint64_t const a = w->mixed[c[0]];
        uint64_t const b = w->mixed[c[1]];
        uint64_t const d = w->mixed[c[2]];
        s += (b - a) * (d - a) * (d - b);
    }
    *sum = s;
    return t;
}

static void sum_triangles(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    balance_work *const w = user;
    uint64_t const stop = bvxi_view_packed_u32(w->view) ? sum_until(w, begin, end, 1, &w->sum[piece])
                                                        : sum_until(w, begin, end, 0, &w->sum[piece]);
    w->bad[piece] = stop < end ? stop : UINT64_MAX;
}

bvx_status bvxi_edges_balance(bvx_context *ctx, const bvxi_solid_job *job, double at, int32_t *balanced)
{
    uint64_t const bytes = job->view->vertex_count * 4;
    uint64_t sum = 0, bad = UINT64_MAX;
    balance_work w;

    w.view = job->view;
    w.xyz = job->snapped.xyz;
    w.pieces = bvxi_piece_count(job->view->triangle_count, BALANCE_GRAIN);
    if (w.pieces > BALANCE_PIECES) w.pieces = BALANCE_PIECES;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' numbers", &w.mixed));
    BVXI_TRY(BVXI_SHARE(ctx, at, at,
                        bvxi_for(ctx, "solid", job->view->vertex_count, BALANCE_GRAIN, mix_vertices, &w)));
    BVXI_TRY(bvxi_for_pieces(ctx, "solid", at, at, w.pieces, w.view->triangle_count, sum_triangles, &w));
    bvxi_drop(ctx, w.mixed);

    /* Sums modulo 2^64: in any order the same. */
    for (int32_t i = 0; i < w.pieces; i++) {
        sum += w.sum[i];
        bad = w.bad[i] < bad ? w.bad[i] : bad;
    }
    if (bad != UINT64_MAX) return bvxi_view_fail_index(ctx, job->function, job->view, bad);
    /* Only zero says that all edges balance. */
    *balanced = sum == 0;
    return BVX_OK;
}
