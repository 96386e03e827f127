/* fans.c - whether a surface is closed, manifold and oriented where it could fail to be.
 *
 * Round a vertex of such a surface its triangles are one fan: each of its neighbours is followed by
 * exactly one other, and the way over all of them is one circle. Where that holds of every vertex the
 * surface is closed, oriented, edge- and vertex-manifold; of vertices that are not requested it is known
 * already. */
#include "oblique/oblique.h"

/* Neighbours (from, to) of the vertices requested, in the order of these. */
typedef struct fans_work {
    uint64_t *first; /* [vertices + 1] */
    uint32_t (*pair)[2];
} fans_work;

/* Few neighbours as a rule, so each is looked for among all. */
static int is_one_fan(uint32_t (*pair)[2], uint64_t count)
{
    uint64_t steps = 0;

    if (count < 3) return 0;
    uint32_t at = pair[0][1];
    for (; at != pair[0][0]; steps++) {
        uint64_t found = count, i;
        for (i = 1; i < count; i++)
            if (pair[i][0] == at) {
                /* two triangles leave the same edge: it has three or more, or they run against each other */
                if (found != count) return 0;
                found = i;
            }
        /* a neighbour that none follows, or the way begins to go in a circle without the first */
        if (found == count || steps == count) return 0;
        at = pair[found][1];
    }
    return steps + 1 == count;
}

bvx_status bvxi_fans_check(bvx_context *ctx, const uint32_t *triangle, uint64_t triangles, uint64_t vertices,
                           const uint8_t *asked, uint64_t *broken)
{
    fans_work w = {NULL, NULL};
    *broken = 0;
    static const char what[] = "the surface's fans";
    BVXI_TRY(BVXI_ZEROS(ctx, vertices + 2, what, w.first));
    for (uint64_t c = 0; c < 3 * triangles; c++) w.first[triangle[c] + 2] += asked[triangle[c]];
    for (uint64_t v = 0; v < vertices; v++) w.first[v + 2] += w.first[v + 1];
    BVXI_TRY(BVXI_ARRAY(ctx, w.first[vertices + 1] + 1, what, w.pair));
    /* first[v + 1] is where v's begin, and in the end where those of the next do */
    for (uint64_t t = 0; t < triangles; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *const c = triangle + 3 * t;
            uint32_t *pair;
            if (!asked[c[k]]) continue;
            pair = w.pair[w.first[c[k] + 1]++];
            pair[0] = c[(k + 1) % 3];
            pair[1] = c[(k + 2) % 3];
        }

    for (uint64_t v = 0; v < vertices; v++)
        if (w.first[v + 1] != w.first[v])
            *broken += !is_one_fan(w.pair + w.first[v], w.first[v + 1] - w.first[v]);
    return BVX_OK;
}
