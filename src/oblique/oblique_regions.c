/* oblique_regions.c - on each plane, which of its regions between contours are inside.
 *
 * Where contours were moved to agree, the side that a place has of them is no longer that of the ones
 * given: it is told by the tetrahedra. Vertices of a plane that hang together without a contour between
 * them are a region; the contours' edges around it run so that inside is on their left, and each votes by
 * the area of its triangle. */
#include "oblique/oblique.h"

#include "bits/bits.h"

enum { REGION_GRAIN = 4096 }; /* tetrahedra of a piece */

typedef struct oblique_region_work {
    uint32_t *joined; /* [vertex] */
    double *vote;     /* [vertex] area on the contours' left less that on their right; of several bodies what
                         the leading kind has more than the others */
    float *kind;      /* [vertex] of several bodies: which leads */
    uint64_t *first;  /* [plane + 2] of each plane's faces */
    uint64_t *face;   /* 4 times a tetrahedron and the corner opposite */
    uint32_t *torn;   /* vertices of which two planes say different things; once a plane but the first */
    uint64_t torn_count, torn_room;
} oblique_region_work;

/* A triangle of the plane: x y z, z's side of the edge x y where that is a contour's. */
static void vote_for(const bvxi_oblique *o, oblique_region_work *w, uint32_t plane, uint32_t x, uint32_t y,
                     uint32_t z)
{
    uint32_t const edge = bvxi_edge_find(&o->contour_edge, x, y);
    double a[2], b[2], c[2], area;
    if (edge == BVXI_NONE || edge / 2 != plane) return;
    bvxi_oblique_uv(&o->plane[plane], o->vertex[x].at, a);
    bvxi_oblique_uv(&o->plane[plane], o->vertex[y].at, b);
    bvxi_oblique_uv(&o->plane[plane], o->vertex[z].at, c);
    area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    w->vote[z] += (x > y) == (edge & 1) ? area : -area;
}

/* Arrays over all vertices, made ready for this plane's; then joins and votes. */
static void vote_on_plane(const bvxi_oblique *o, oblique_region_work *w, uint32_t plane)
{
    uint64_t const begin = w->first[plane], end = w->first[plane + 1];
    uint32_t v[3];

    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_face(&o->tetra[w->face[i] / 4], (int)(w->face[i] % 4), v);
        for (int k = 0; k < 3; k++) {
            w->joined[v[k]] = v[k];
            w->vote[v[k]] = 0.0;
            if (o->body_count != 0) w->kind[v[k]] = 0.0F;
        }
    }
    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_face(&o->tetra[w->face[i] / 4], (int)(w->face[i] % 4), v);
        for (int k = 0; k < 3; k++) {
            uint32_t const x = v[k], y = v[(k + 1) % 3], z = v[(k + 2) % 3];
            if (o->body_count == 0 && o->vertex[x].sign == 0 && o->vertex[y].sign == 0 &&
                o->vertex[z].sign != 0)
                vote_for(o, w, plane, x, y, z);
            if (o->vertex[x].sign != 0 && o->vertex[y].sign != 0) bvxi_join(w->joined, x, y);
        }
    }
}

static bvx_status settle_region(bvxi_oblique *o, oblique_region_work *w, uint32_t plane)
{
    uint64_t const begin = w->first[plane], end = w->first[plane + 1];
    uint32_t v[3];

    vote_on_plane(o, w, plane);
    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_face(&o->tetra[w->face[i] / 4], (int)(w->face[i] % 4), v);
        for (int k = 0; k < 3; k++) {
            uint32_t const x = v[k];
            if (o->vertex[x].sign == 0 || w->vote[x] == 0.0 || bvxi_root(w->joined, x) == x) continue;
            w->vote[bvxi_root(w->joined, x)] += w->vote[x];
            w->vote[x] = 0.0;
        }
    }
    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_face(&o->tetra[w->face[i] / 4], (int)(w->face[i] % 4), v);
        for (int k = 0; k < 3; k++) {
            uint32_t const x = v[k];
            double const vote = o->vertex[x].sign == 0 ? 0.0 : w->vote[bvxi_root(w->joined, x)];
            if (vote == 0.0 || (vote > 0.0) == (o->vertex[x].sign > 0)) continue;
            /* One that lies on several planes has the first one's sign; a difference is recorded. */
            if (bvxi_first_plane(o, x) == plane) {
                bvxi_flip_sign(o, x);
                continue;
            }
            BVXI_TRY(BVXI_GROW(o, w->torn, w->torn_count, w->torn_room,
                               "the vertices that planes contradict each other of"));
            w->torn[w->torn_count++] = x;
        }
    }
    return BVX_OK;
}

/* Of several bodies the kind that most of a region's area has is that of all of it. */
static void settle_kinds(bvxi_oblique *o, oblique_region_work *w, uint32_t plane)
{
    uint64_t const begin = w->first[plane], end = w->first[plane + 1];
    uint32_t v[3];

    vote_on_plane(o, w, plane);

    /* The one with more than half of the area, if any, is the last to lead (Boyer, Moore 1981). */
    for (uint32_t v_at = 0; v_at < 3; v_at++)
        for (uint64_t i = begin; i < end; i++) {
            double at[3][2], area;
            bvxi_tetra_face(&o->tetra[w->face[i] / 4], (int)(w->face[i] % 4), v);
            if (o->vertex[v[v_at]].sign == 0) continue;
            for (int k = 0; k < 3; k++) bvxi_oblique_uv(&o->plane[plane], o->vertex[v[k]].at, at[k]);
            area = bvxi_absolute((at[1][0] - at[0][0]) * (at[2][1] - at[0][1]) -
                                 (at[1][1] - at[0][1]) * (at[2][0] - at[0][0]));
            uint32_t root = bvxi_root(w->joined, v[v_at]);
            if (w->vote[root] == 0.0) w->kind[root] = o->vertex[v[v_at]].value;
            w->vote[root] += w->kind[root] == o->vertex[v[v_at]].value ? area : -area;
            if (w->vote[root] >= 0.0) continue;
            w->kind[root] = o->vertex[v[v_at]].value;
            w->vote[root] = -w->vote[root];
        }
    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_face(&o->tetra[w->face[i] / 4], (int)(w->face[i] % 4), v);
        for (int k = 0; k < 3; k++) {
            bvxi_tetra_vertex *const x = &o->vertex[v[k]];
            if (x->sign != 0 && bvxi_first_plane(o, v[k]) == plane)
                x->value = w->kind[bvxi_root(w->joined, v[k])];
        }
    }
}

/* Which faces lie on planes, each marked at one of the two tetrahedra beside it. */
static void mark_faces_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_oblique *const o = user;
    for (uint64_t t = begin; t < end; t++) {
        o->mark[t] = 0;
        for (int k = 0; k < 4; k++) {
            uint32_t v[3];
            /* The border's BVXI_NONE is larger than all: such faces are marked at their only one. */
            if (o->tetra[t].n[k] < t) continue;
            bvxi_tetra_face(&o->tetra[t], k, v);
            if (bvxi_share_plane(o, v, 3)) o->mark[t] |= (uint8_t)(1 << k);
        }
    }
}

/* All faces on planes, those of one plane together. */
static bvx_status list_plane_faces(bvxi_oblique *o, oblique_region_work *w)
{
    static const char what[] = "the faces on planes";
    uint64_t const n = (uint64_t)o->plane_count + 2;

    BVXI_TRY(BVXI_ZEROS(o->ctx, n, what, w->first));
    uint64_t *const next = w->first + 1;
    for (int fill = 0; fill < 2; fill++) {
        for (uint64_t t = 0; t < o->tetra_count; t++)
            for (int k = 0; k < 4 && o->mark[t] != 0; k++) {
                uint32_t v[3];
                if (!(o->mark[t] >> k & 1)) continue;
                bvxi_tetra_face(&o->tetra[t], k, v);
                for (uint32_t word = 0; word < o->plane_words; word++)
                    for (uint64_t on = bvxi_tetra_on(o, v[0])[word] & bvxi_tetra_on(o, v[1])[word] &
                                       bvxi_tetra_on(o, v[2])[word];
                         on != 0; on &= on - 1) {
                        uint32_t const plane = 64 * word + (uint32_t)bvxi_lowest(on);
                        if (fill) w->face[next[plane]++] = 4 * t + (uint64_t)k;
                        else next[plane + 1]++;
                    }
            }
        if (fill) break;
        /* next[p] is where the faces of plane p begin, and where those of the next begin once they are in */
        for (uint32_t p = 0; p < o->plane_count; p++) next[p + 1] += next[p];
        BVXI_TRY(BVXI_ARRAY(o->ctx, next[o->plane_count] + 1, what, w->face));
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_regions(bvxi_oblique *o, uint32_t **torn, uint64_t *torn_count)
{
    static const char what[] = "the regions of planes";
    oblique_region_work w = {0};

    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.3,
                        bvxi_for(o->ctx, "surface", o->tetra_count, REGION_GRAIN, mark_faces_piece, o)));
    BVXI_TRY(list_plane_faces(o, &w));
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->vertex_count, what, w.joined));
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->vertex_count, what, w.vote));
    if (o->body_count != 0) BVXI_TRY(BVXI_ARRAY(o->ctx, o->vertex_count, what, w.kind));
    /* A vertex on two planes belongs to a region of each, so planes go one after another. */
    for (uint32_t p = 0; p < o->plane_count; p++) {
        if (o->body_count != 0) settle_kinds(o, &w, p);
        else BVXI_TRY(settle_region(o, &w, p));
    }
    *torn = w.torn;
    *torn_count = w.torn_count;
    return BVX_OK;
}
