/* pack_level.c - the gaps that collapses left are closed, so that what remains lies together in memory.
 *
 * Vertices and triangles keep their order. A level that has been judged is the new beginning: what was collapsed
 * before can no more be undone. */
#include "simplify/collapse_state.h"

bvx_status bvxi_collapse_number(bvxi_collapse *c, uint32_t **index)
{
    uint32_t next = 0;
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->mesh.vertices * 4, "the vertices' indices", index));
    for (uint64_t v = 0; v < c->mesh.vertices; v++) {
        (*index)[v] = next;
        next += !bvxi_collapse_is_gone(c, (uint32_t)v);
    }
    return BVX_OK;
}

/* Neighbours point both ways: where a triangle moves to, its neighbours point at once. What lies ahead is found there
 * when its turn comes, what lies behind has its new place already. */
static void pack_triangles(bvxi_collapse *c, const uint32_t *moved)
{
    bvxi_corners *const m = &c->mesh;
    bvxi_attributes *const s = &c->attributes;
    uint64_t const end = m->triangles + m->ghosts;
    uint64_t kept = 0, ghosts = 0;

    for (uint64_t t = 0; t < end; t++) {
        bvxi_corner_triangle moving = m->triangle[t];

        if (bvxi_corner_gone(m, (int32_t)(4 * t))) continue;
        ghosts += t >= m->triangles;
        for (int k = 0; k < 3; k++) {
            if (moving.vertex[k] != BVXI_VERTEX_GHOST) moving.vertex[k] = moved[moving.vertex[k]];
            bvxi_corner_put_left(m, bvxi_corner_next(moving.left[k]), (int32_t)(4 * kept) + (k + 2) % 3);
        }
        if (s->row != NULL) memmove(s->row + 4 * kept, s->row + 4 * t, 16);
        if (s->material != NULL && t < m->triangles) s->material[kept] = s->material[t];
        m->triangle[kept++] = moving;
    }
    m->triangles = m->left = kept - ghosts;
    m->ghosts = ghosts;
}

bvx_status bvxi_collapse_pack(bvxi_collapse *c)
{
    uint32_t *moved;

    if (3 * c->mesh.left > 2 * c->mesh.triangles) return BVX_OK;
    BVXI_TRY(bvxi_collapse_number(c, &moved));

    /* Where each vertex of the mesh is after packing. */
    uint32_t *now = c->now;

    if (now == NULL)
        BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, c->first_vertices * 4, "vertices that went", &now));
    for (uint64_t v = 0; v < c->first_vertices; v++) now[v] = moved[bvxi_collapse_now(c, (uint32_t)v)];
    c->now = now;

    pack_triangles(c, moved);

    bvxi_corners *const m = &c->mesh;
    uint64_t kept = 0;

    for (uint64_t v = 0; v < m->vertices; v++) {
        if (bvxi_collapse_is_gone(c, (uint32_t)v)) continue;
        kept = moved[v];
        m->at[kept] = m->at[v];
        m->source[kept] = m->source[v];
        c->kind[kept] = c->kind[v];
        c->stale[kept] = c->stale[v];
        if (c->came != NULL) c->came[kept] = c->came[v];
    }
    m->vertices = c->alive;
    memset(c->last, 0xff, (size_t)m->vertices * sizeof *c->last);

    bvxi_drop(c->ctx, moved);
    c->order = 0;
    bvxi_collapse_index(c);
    bvxi_collapse_find_least(c);
    return BVX_OK;
}
