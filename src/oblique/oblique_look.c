/* oblique_look.c - the surroundings of vertices and edges, read by several threads at once.
 *
 * tetrahedra.c walks with one set of scratch arrays. Here all arrays are the caller's, so that many vertices
 * can be judged side by side. */
#include "oblique/oblique.h"

/* The slot of an index, or a free one; tables are at most a quarter full. */
static uint32_t look_slot(const bvxi_look *l, const uint32_t *table, uint32_t number)
{
    uint32_t const mask = 4 * l->most - 1;
    uint32_t at = number * UINT32_C(0x9e3779b1) >> 7 & mask;
    while (table[at] != BVXI_NONE && table[at] != number) at = (at + 1) & mask;
    return at;
}

static int look_add_tetra(bvxi_look *l, uint32_t tetra)
{
    uint32_t const at = look_slot(l, l->seen, tetra);
    if (l->seen[at] == tetra) return 1;
    if (l->count == l->most) return 0;
    l->seen[at] = tetra;
    l->tetra[l->count++] = tetra;
    return 1;
}

int bvxi_look_link(const bvxi_oblique *o, bvxi_look *l, uint32_t vertex)
{
    memset(l->seen, 0xff, (size_t)l->most * 16);
    l->count = 0;
    if (!look_add_tetra(l, o->vertex[vertex].tetra)) return 0;
    for (uint32_t i = 0; i < l->count; i++) {
        const bvxi_tetra *const t = &o->tetra[l->tetra[i]];
        for (int k = 0; k < 4; k++)
            if (t->v[k] != vertex && t->n[k] != BVXI_NONE && !look_add_tetra(l, t->n[k])) return 0;
    }
    memset(l->key, 0xff, (size_t)l->most * 16);
    l->vertices = 0;
    for (uint32_t i = 0; i < l->count; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t const v = o->tetra[l->tetra[i]].v[k];
            uint32_t const at = look_slot(l, l->key, v);
            if (v == vertex || l->key[at] == v) continue;
            if (l->vertices == l->most) return 0;
            l->key[at] = v;
            l->place[at] = l->vertices;
            l->vertex[l->vertices] = v;
            l->sign[l->vertices] = o->vertex[v].sign;
            l->joined[l->vertices] = l->vertices;
            l->vertices++;
        }
    return 1;
}

void bvxi_look_stretches(const bvxi_oblique *o, bvxi_look *l, uint32_t vertex, int contours,
                         uint32_t stretches[2])
{
    stretches[0] = stretches[1] = 0;
    for (uint32_t i = 0; i < l->vertices; i++)
        if (contours || l->sign[i] != 0) stretches[l->sign[i] > 0]++;
    for (uint32_t i = 0; i < l->count; i++) {
        const uint32_t *const v = o->tetra[l->tetra[i]].v;
        uint32_t last[2] = {BVXI_NONE, BVXI_NONE};

        /* Of a tetrahedron's three other corners those on one side hang together. */
        for (int k = 0; k < 4; k++) {
            if (v[k] == vertex) continue;
            uint32_t const own = l->place[look_slot(l, l->key, v[k])];
            int const inside = l->sign[own] > 0;
            if (!contours && l->sign[own] == 0) continue;
            if (last[inside] != BVXI_NONE)
                stretches[inside] -= (uint32_t)bvxi_join(l->joined, own, last[inside]);
            last[inside] = own;
        }
    }
}

int bvxi_look_torn(const bvxi_oblique *o, bvxi_look *l, uint32_t vertex)
{
    uint32_t stretches[2];
    bvxi_look_stretches(o, l, vertex, 0, stretches);
    return stretches[0] > 1 || stretches[1] > 1;
}

int64_t bvxi_look_euler(const bvxi_oblique *o, const bvxi_look *l, uint32_t vertex, int *any, int *all)
{
    int64_t corners = 0, edges = 0, faces = 0;
    for (uint32_t i = 0; i < l->vertices; i++) corners += l->sign[i] > 0;
    for (uint32_t i = 0; i < l->count; i++) {
        const bvxi_tetra *const t = &o->tetra[l->tetra[i]];
        int n = 0;
        for (int k = 0; k < 4; k++) n += t->v[k] != vertex && o->vertex[t->v[k]].sign > 0;
        edges += n == 3 ? 3 : n == 2; /* each is in two of them */
        faces += n == 3;
    }
    *any = corners > 0;
    *all = corners == l->vertices;
    return corners - edges / 2 + faces;
}

int bvxi_look_whole(const bvxi_oblique *o, const bvxi_look *l, uint32_t vertex)
{
    for (uint32_t i = 0; i < l->count; i++) {
        const bvxi_tetra *const t = &o->tetra[l->tetra[i]];
        for (int k = 0; k < 4; k++)
            if (t->v[k] != vertex && t->n[k] == BVXI_NONE) return 0;
    }
    return 1;
}
