/* tetrahedra.c - tetrahedra that fill cells, changed by two operations: a new vertex in an edge, a new vertex
 * in a face.
 *
 * Every tetrahedron knows the ones across its faces. A vertex put into an edge halves all tetrahedra round
 * it, one put into a face parts the two beside it into three each; nothing else changes, so tetrahedra that
 * meet in whole faces before do so after, whatever the places of the vertices are. */
#include "oblique/oblique.h"

/* ---- vertices and tetrahedra ---- */

bvx_status bvxi_tetra_add_vertex(bvxi_oblique *o, const double at[3], uint32_t *number)
{
    static const bvxi_tetra_vertex none = {
        {0.0, 0.0, 0.0}, {BVXI_NONE, BVXI_NONE}, BVXI_NONE, 0.0F, BVXI_SIGN_UNKNOWN, 0};
    BVXI_TRY(BVXI_GROW_BESIDE(o, o->on, o->vertex_count, o->vertex_room, (uint64_t)o->plane_words * 8,
                              "the planes of vertices"));
    BVXI_TRY(BVXI_GROW(o, o->vertex, o->vertex_count, o->vertex_room, "the vertices of tetrahedra"));
    *number = (uint32_t)o->vertex_count++;
    o->vertex[*number] = none;
    memcpy(o->vertex[*number].at, at, 24);
    memset(bvxi_tetra_on(o, *number), 0, (size_t)o->plane_words * 8);
    return BVX_OK;
}

/* Copies v and n. chain_of: the tetrahedron after which it joins its cell's chain. May move o->tetra. */
bvx_status bvxi_tetra_add(bvxi_oblique *o, const uint32_t v[4], const uint32_t n[4], uint32_t chain_of,
                          uint32_t *number)
{
    uint64_t const at = o->tetra_count;

    BVXI_TRY(BVXI_GROW(o, o->tetra, at, o->tetra_room, "the tetrahedra"));
    bvxi_tetra *const t = &o->tetra[at];
    memcpy(t->v, v, 16);
    memcpy(t->n, n, 16);
    t->stamp = 0;
    t->chain = BVXI_NONE;
    if (chain_of != BVXI_NONE) {
        t->chain = o->tetra[chain_of].chain;
        o->tetra[chain_of].chain = (uint32_t)at;
    }
    for (int k = 0; k < 4; k++) o->vertex[v[k]].tetra = (uint32_t)at;
    *number = (uint32_t)at;
    o->tetra_count++;
    return BVX_OK;
}

static bvx_status add_to_ring(bvxi_oblique *o, uint32_t tetra)
{
    BVXI_TRY(BVXI_GROW(o, o->ring, o->ring_count, o->ring_room, "the tetrahedra round an edge"));
    o->ring[o->ring_count++] = tetra;
    return BVX_OK;
}

/* Collect the tetrahedra around edge a b, over the face opposite corner `leave`, until a border or start. */
static bvx_status ring_on(bvxi_oblique *o, uint32_t start, uint32_t a, uint32_t b, int leave, int *closed)
{
    uint32_t at = start;

    for (;;) {
        uint32_t const next = o->tetra[at].n[leave];
        uint32_t stay = BVXI_NONE;
        *closed = next == start;
        if (next == BVXI_NONE || next == start) return BVX_OK;
        for (int k = 0; k < 4; k++) {
            uint32_t const v = o->tetra[at].v[k];
            if (k != leave && v != a && v != b) stay = v;
        }
        BVXI_TRY(add_to_ring(o, next));
        leave = bvxi_corner_of(&o->tetra[next], stay);
        at = next;
    }
}

bvx_status bvxi_tetra_ring(bvxi_oblique *o, uint32_t tetra, uint32_t a, uint32_t b, int *closed)
{
    int leave[2], n = 0;

    o->ring_count = 0;
    /* The two corners off the edge; & 1 shows that leave is never overrun, whatever a and b are. */
    for (int k = 0; k < 4; k++)
        if (o->tetra[tetra].v[k] != a && o->tetra[tetra].v[k] != b) leave[n++ & 1] = k;
    BVXI_TRY(add_to_ring(o, tetra));
    BVXI_TRY(ring_on(o, tetra, a, b, leave[0], closed));
    /* A border: what lies on the other side of the first one is looked for too. */
    if (!*closed) {
        int back;
        BVXI_TRY(ring_on(o, tetra, a, b, leave[1], &back));
    }
    return BVX_OK;
}

void bvxi_tetra_new_stamp(bvxi_oblique *o)
{
    if (++o->stamps != 0) return;
    for (uint64_t t = 0; t < o->tetra_count; t++) o->tetra[t].stamp = 0;
    o->stamps = 1;
}

static bvx_status add_to_star(bvxi_oblique *o, uint32_t tetra)
{
    BVXI_TRY(BVXI_GROW(o, o->star, o->star_count, o->star_room, "the tetrahedra round a vertex"));
    o->star[o->star_count++] = tetra;
    o->tetra[tetra].stamp = o->stamps;
    return BVX_OK;
}

bvx_status bvxi_tetra_star(bvxi_oblique *o, uint32_t vertex)
{
    o->star_count = 0;
    bvxi_tetra_new_stamp(o);
    BVXI_TRY(add_to_star(o, o->vertex[vertex].tetra));
    /* Neighbours over all faces that hold the vertex, each once by its stamp. */
    for (uint64_t i = 0; i < o->star_count; i++) {
        const bvxi_tetra t = o->tetra[o->star[i]];
        for (int k = 0; k < 4; k++)
            if (t.v[k] != vertex && t.n[k] != BVXI_NONE && o->tetra[t.n[k]].stamp != o->stamps)
                BVXI_TRY(add_to_star(o, t.n[k]));
    }
    return BVX_OK;
}

bvx_status bvxi_tetra_with_edge(bvxi_oblique *o, uint32_t a, uint32_t b, uint32_t *tetra)
{
    *tetra = BVXI_NONE;
    BVXI_TRY(bvxi_tetra_star(o, a));
    for (uint64_t i = 0; i < o->star_count; i++)
        if (bvxi_corner_of(&o->tetra[o->star[i]], b) < 4) {
            *tetra = o->star[i];
            return BVX_OK;
        }
    return BVX_OK;
}

static void relink_neighbour(bvxi_oblique *o, uint32_t of, uint32_t from, uint32_t to)
{
    if (of == BVXI_NONE) return;
    for (int k = 0; k < 4; k++)
        if (o->tetra[of].n[k] == from) {
            o->tetra[of].n[k] = to;
            return;
        }
}

/* Halves of a contour's edge are edges of that contour. value = 2 * plane + 1 when it runs from the higher
 * end; the old edge gets BVXI_NONE, as it is no longer whole. */
static bvx_status keep_contour_edge(bvxi_oblique *o, uint32_t a, uint32_t b, uint32_t m)
{
    uint32_t const edge = bvxi_edge_find(&o->contour_edge, a, b);
    uint32_t *value;

    if (edge == BVXI_NONE) return BVX_OK;
    BVXI_TRY(bvxi_edge_add(o, &o->contour_edge, a, b, &value));
    *value = BVXI_NONE;
    if ((a > b) != (edge & 1)) { /* it runs from b to a */
        uint32_t const swap = a;
        a = b;
        b = swap;
    }
    BVXI_TRY(bvxi_edge_add(o, &o->contour_edge, a, m, &value));
    *value = (edge & ~1u) + (a > m);
    BVXI_TRY(bvxi_edge_add(o, &o->contour_edge, m, b, &value));
    *value = (edge & ~1u) + (m > b);
    o->vertex[m].sign = 0;
    return BVX_OK;
}

bvx_status bvxi_tetra_split_edge(bvxi_oblique *o, uint32_t tetra, uint32_t a, uint32_t b, const double at[3],
                                 uint32_t *m)
{
    int closed;

    BVXI_TRY(bvxi_tetra_add_vertex(o, at, m));
    o->vertex[*m].parent[0] = a;
    o->vertex[*m].parent[1] = b;
    uint64_t *const on = bvxi_tetra_on(o, *m);
    uint64_t *const on_a = bvxi_tetra_on(o, a);
    uint64_t *const on_b = bvxi_tetra_on(o, b);
    /* A vertex put into an edge lies on the planes that both ends lie on. */
    for (uint32_t w = 0; w < o->plane_words; w++) on[w] = on_a[w] & on_b[w];
    BVXI_TRY(keep_contour_edge(o, a, b, *m));
    BVXI_TRY(bvxi_tetra_ring(o, tetra, a, b, &closed));

    for (uint64_t i = 0; i < o->ring_count; i++) {
        uint32_t const t = o->ring[i];
        bvxi_tetra const old = o->tetra[t]; /* a copy: bvxi_tetra_add may move the array */
        uint32_t twin;
        BVXI_TRY(bvxi_tetra_add(o, old.v, old.n, t, &twin));
        o->tetra[t].twin = twin;
    }
    for (uint64_t i = 0; i < o->ring_count; i++) {
        uint32_t const kept = o->ring[i], twin = o->tetra[kept].twin;
        bvxi_tetra *const half_a = &o->tetra[kept], *const half_b = &o->tetra[twin];
        int const corner_a = bvxi_corner_of(half_a, a), corner_b = bvxi_corner_of(half_a, b);

        /* What lay beyond the face opposite a is the twin's neighbour now. */
        relink_neighbour(o, half_a->n[corner_a], kept, twin);
        half_a->v[corner_b] = half_b->v[corner_a] = *m;
        half_b->n[corner_b] = kept;
        half_a->n[corner_a] = twin;
        for (int k = 0; k < 4; k++)
            if (k != corner_a && k != corner_b && half_b->n[k] != BVXI_NONE)
                half_b->n[k] = o->tetra[half_b->n[k]].twin;
        for (int k = 0; k < 4; k++) {
            o->vertex[half_a->v[k]].tetra = kept;
            if (half_b->v[k] == b) o->vertex[b].tetra = twin;
        }
    }
    return BVX_OK;
}

/* One side of a face: three tetrahedra, part[k] without corner face[k] of the old one, which is part[0]. */
static bvx_status split_side(bvxi_oblique *o, uint32_t t, const uint32_t face[3], uint32_t m,
                             uint32_t part[3])
{
    bvxi_tetra const old = o->tetra[t]; /* a copy: bvxi_tetra_add may move the array */
    int corner[3];

    for (int k = 0; k < 3; k++) corner[k] = bvxi_corner_of(&old, face[k]);
    part[0] = t;
    for (int k = 1; k < 3; k++) BVXI_TRY(bvxi_tetra_add(o, old.v, old.n, t, &part[k]));
    for (int k = 0; k < 3; k++) {
        bvxi_tetra *const p = &o->tetra[part[k]];
        p->v[corner[k]] = m;
        p->n[corner[k]] = old.n[corner[k]];
        for (int j = 0; j < 3; j++)
            if (j != k) p->n[corner[j]] = part[j];
        relink_neighbour(o, old.n[corner[k]], t, part[k]);
    }
    for (int k = 0; k < 3; k++)
        for (int j = 0; j < 4; j++) o->vertex[o->tetra[part[k]].v[j]].tetra = part[k];
    return BVX_OK;
}

bvx_status bvxi_tetra_split_face(bvxi_oblique *o, uint32_t tetra, int corner, const double at[3], uint32_t *m)
{
    uint32_t const beside = o->tetra[tetra].n[corner];
    uint32_t face[3], part[2][3];
    int across[2];

    bvxi_tetra_face(&o->tetra[tetra], corner, face);
    BVXI_TRY(bvxi_tetra_add_vertex(o, at, m));
    uint64_t *const on = bvxi_tetra_on(o, *m);

    for (int k = 0; k < 3; k++)
        for (uint32_t w = 0; w < o->plane_words; w++) {
            uint64_t const set = bvxi_tetra_on(o, face[k])[w];
            on[w] = k == 0 ? set : on[w] & set;
        }
    across[0] = corner;
    across[1] = 0;
    for (int k = 0; k < 4 && beside != BVXI_NONE; k++)
        if (o->tetra[beside].n[k] == tetra) across[1] = k;
    BVXI_TRY(split_side(o, tetra, face, *m, part[0]));
    if (beside == BVXI_NONE) return BVX_OK;
    BVXI_TRY(split_side(o, beside, face, *m, part[1]));
    /* Both sides' parts go in the order of the face's corners, so they meet pairwise. */
    for (int k = 0; k < 3; k++) {
        o->tetra[part[0][k]].n[across[0]] = part[1][k];
        o->tetra[part[1][k]].n[across[1]] = part[0][k];
    }
    return BVX_OK;
}
