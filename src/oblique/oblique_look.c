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

static int look_star(const bvxi_oblique *o, bvxi_look *l, uint32_t vertex)
{
    memset(l->seen, 0xff, (size_t)l->most * 16);
    l->count = 0;
    if (!look_add_tetra(l, o->vertex[vertex].tetra)) return 0;
    for (uint32_t i = 0; i < l->count; i++) {
        const bvxi_tetra *const t = &o->tetra[l->tetra[i]];
        for (int k = 0; k < 4; k++)
            if (t->v[k] != vertex && t->n[k] != BVXI_NONE && !look_add_tetra(l, t->n[k])) return 0;
    }
    return 1;
}

static uint32_t look_vertex(const bvxi_look *l, uint32_t vertex)
{
    return l->place[look_slot(l, l->key, vertex)];
}

int bvxi_look_link(const bvxi_oblique *o, bvxi_look *l, uint32_t vertex)
{
    if (!look_star(o, l, vertex)) return 0;
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
            uint32_t const own = look_vertex(l, v[k]);
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

/* How often the sign changes round an edge: 0 where the tetrahedra do not go all the way round. */
static uint32_t changes_round(const bvxi_oblique *o, uint32_t start, uint32_t a, uint32_t b)
{
    uint32_t changes = 0, at = start, stay = BVXI_NONE, left = BVXI_NONE;

    for (int k = 0; k < 4; k++) {
        uint32_t const v = o->tetra[start].v[k];
        if (v == a || v == b) continue;
        if (left == BVXI_NONE) left = v;
        else stay = v;
    }
    do {
        /* Over the face opposite the vertex that is left; the one that stayed is left next. */
        uint32_t const next = o->tetra[at].n[bvxi_corner_of(&o->tetra[at], left)];
        changes += o->vertex[left].sign != o->vertex[stay].sign;
        /* A border: no plane's contour is settled there, as by the walk that changes things. */
        if (next == BVXI_NONE) return 0;
        left = stay;
        for (int k = 0; k < 4; k++) {
            uint32_t const v = o->tetra[next].v[k];
            if (v != a && v != b && v != left) stay = v;
        }
        at = next;
    } while (at != start);
    return changes;
}

int bvxi_look_edge(const bvxi_oblique *o, bvxi_look *l, uint32_t a, uint32_t b, uint32_t *changes)
{
    *changes = 0;
    if (!look_star(o, l, a)) return 0;
    for (uint32_t i = 0; i < l->count; i++)
        if (bvxi_corner_of(&o->tetra[l->tetra[i]], b) < 4) {
            *changes = changes_round(o, l->tetra[i], a, b);
            break;
        }
    return 1;
}
