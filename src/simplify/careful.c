/* careful.c - collapses that are looked at one by one, once a level has been judged: none may make triangles cross that
 * did not in the mesh. */
#include "mesh/cross.h"
#include "simplify/collapse_state.h"

int bvxi_collapse_has_come(const bvxi_collapse *c, uint32_t triangle)
{
    const uint32_t *const v = c->mesh.triangle[triangle].vertex;

    return c->came != NULL && (c->came[v[0]] | c->came[v[1]] | c->came[v[2]]) != 0;
}

int bvxi_collapse_crosses(const bvxi_collapse *c, uint32_t u, uint32_t v, const uint32_t *link, int32_t count,
                          const double *p)
{
    const bvxi_corner_vertex *const at = c->mesh.at;
    int came = 0;

    for (int32_t i = 0; i < count && c->came != NULL; i++)
        came |= link[i] != BVXI_VERTEX_GHOST && c->came[link[i]] != 0;
    if (c->came != NULL) came |= (c->came[u] | c->came[v]) != 0;

    for (int32_t i = 0; i < count; i++) {
        const double *a[3] = {p, NULL, NULL};

        if (link[i] == BVXI_VERTEX_GHOST || link[i + 1] == BVXI_VERTEX_GHOST) continue;
        a[1] = at[link[i]].p;
        a[2] = at[link[i + 1]].p;
        /* Where triangles crossed in the mesh they may go on. */
        if (bvxi_crossing_tree_visit(&c->tree, a, u, v, came ? c->came : NULL, NULL, NULL)) return 1;

        for (int32_t j = 0; j < i && !came; j++) {
            const double *b[3] = {p, NULL, NULL};

            if (link[j] == BVXI_VERTEX_GHOST || link[j + 1] == BVXI_VERTEX_GHOST) continue;
            b[1] = at[link[j]].p;
            b[2] = at[link[j + 1]].p;
            if (bvxi_triangles_cross(a, b)) return 1;
        }
    }
    return 0;
}
