/* joint_cut.c - a kind for every tetrahedron of the cells where bodies meet each other or the outside.
 *
 * Each vertex has a kind: on a plane that of its region between the contours, elsewhere the one that its
 * number says; vertices on contours lie between the kinds on their sides. An edge whose ends have no kind in
 * common gets a vertex where both are as near, which lies between the kinds of both: first on the edge
 * between two kinds, then in the face where three meet, then where four do. After that the vertices of a
 * tetrahedron that have one kind have the same one, which is the tetrahedron's. So kinds fill the cells
 * without gaps, and the faces between two of them are the same for both, whatever the vertices' places are.
 *
 * A face on a plane always has a vertex that is not on a contour: the tetrahedra on both sides are of the
 * plane's kind there, and the bodies meet each plane in their contours and nowhere else. */
#include "bodies/joint.h"

#include "bits/bits.h"

/* ---- vertices ---- */

static void joint_kinds_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_oblique *const o = user;
    for (uint64_t i = begin; i < end; i++) {
        bvxi_tetra_vertex *const x = &o->vertex[i];
        if (x->sign == 0) continue;
        uint32_t const plane = bvxi_first_plane(o, (uint32_t)i);
        if (!x->lattice) x->value = (float)bvxi_joint_kind(o, plane, x->at, NULL, 0);
        x->sign = 1;
        if (!bvxi_joint_is_beyond(o, plane, x->at)) continue;
        x->sign = BVXI_JOINT_BEYOND;
        x->value = 0.0F;
    }
}

/* ---- edges between kinds ---- */

enum { JOINT_OUTSIDE = 1 }; /* the bit of kind 0 */

/* Where a lead at one end of an edge has become one at the other: so many bodies' bits against others. */
static void place_between(const bvxi_oblique *o, const uint32_t v[2], uint64_t bodies, uint64_t others,
                          double at[3])
{
    const double *const in = o->vertex[v[0]].at, *const out = o->vertex[v[1]].at;
    double lead[2];
    /* On a plane the numbers are exact distances, so that the place lies on it between its contours. */
    for (int k = 0; k < 2; k++)
        lead[k] = bvxi_joint_lead(o, bvxi_first_plane(o, v[k]), o->vertex[v[k]].at, bodies, others);
    lead[0] = lead[0] > 0.0 ? lead[0] : 0.0;
    lead[1] = lead[1] < 0.0 ? -lead[1] : 0.0;
    bvxi_oblique_cross_edge(in, lead[0], out, lead[1], at);
    if (!bvxi_share_plane(o, v, 2))
        bvxi_oblique_cross_again(in, lead[0], out, lead[1], bvxi_joint_lead(o, BVXI_NONE, at, bodies, others),
                                 at);
}

static bvx_status cut_edge(bvxi_oblique *o, bvxi_joint_cut *cut, uint32_t t, const uint32_t v[2],
                           uint64_t among, const double at[3])
{
    uint32_t m;
    BVXI_TRY(bvxi_tetra_split_edge(o, t, v[0], v[1], at, &m));
    BVXI_TRY(BVXI_RESERVE(o, cut->among, o->vertex_room, cut->among_room, "the kinds of vertices"));
    /* From here on the vertex counts as one of a contour: it has several kinds and no number. */
    o->vertex[m].sign = 0;
    o->vertex[m].value = 0.0F;
    cut->among[m] = among;
    return BVX_OK;
}

/* An edge from a body to the outside: the crossing is on the surface of all, and of the body whose number is
 * the largest there. That is not always the edge's: so the curve along which two bodies meet on the surface
 * runs through its triangles and not along the lattice's edges. */
static bvx_status cut_from_outside(bvxi_oblique *o, bvxi_joint_cut *cut, uint32_t t, uint32_t a, uint32_t b,
                                   int *made)
{
    uint32_t const v[2] = {(cut->among[a] & JOINT_OUTSIDE) != 0 ? b : a,
                           (cut->among[a] & JOINT_OUTSIDE) != 0 ? a : b};
    double at[3];

    /* Beyond the ends everything is outside already, and the caps are the planes' own faces. */
    *made = (cut->among[v[0]] & JOINT_OUTSIDE) == 0 && cut->among[v[1]] == JOINT_OUTSIDE &&
            o->vertex[v[1]].sign != BVXI_JOINT_BEYOND;
    if (!*made) return BVX_OK;
    place_between(o, v, cut->among[v[0]], JOINT_OUTSIDE, at);
    BVXI_TRY(cut_edge(o, cut, t, v, JOINT_OUTSIDE, at));
    uint32_t const m = (uint32_t)o->vertex_count - 1;

    /* The bodies that the surface of all may be of where it crosses an edge, whose tetrahedra are in the
     * ring: its own and those around it. Where others close around the edge, its own would be a hole in them
     * that leads to the outside, and only those are left. */
    uint64_t const own = cut->among[v[0]];
    uint64_t around = 0;
    int closed = 1;

    for (uint64_t i = 0; i < o->ring_count; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t const x = o->tetra[o->ring[i]].v[k];
            if (x == v[0] || x == v[1] || x == m) continue;
            around |= cut->among[x];
            /* The outside or the body itself goes on beside the edge: then it is no hole. */
            closed &= cut->among[x] != JOINT_OUTSIDE && (cut->among[x] & own) == 0;
        }
    around &= ~(uint64_t)JOINT_OUTSIDE;
    uint64_t bodies = closed && around != 0 ? around : own | around;

    if ((bodies & (bodies - 1)) != 0)
        bodies = UINT64_C(1) << bvxi_joint_kind_among(o, o->vertex[m].at, bodies);
    cut->among[m] |= bodies;
    return BVX_OK;
}

/* An edge between different bodies, in them or on the surface of all. */
static bvx_status cut_between_bodies(bvxi_oblique *o, bvxi_joint_cut *cut, uint32_t t, uint32_t a, uint32_t b,
                                     int *made)
{
    /* From the higher number, so that the place does not depend on the tetrahedron. */
    uint32_t const v[2] = {cut->among[a] >= cut->among[b] ? a : b, cut->among[a] >= cut->among[b] ? b : a};
    /* What both ends have of the outside does not part them, but stays with the new vertex. */
    uint64_t const first = cut->among[v[0]] & ~(uint64_t)JOINT_OUTSIDE,
                   second = cut->among[v[1]] & ~(uint64_t)JOINT_OUTSIDE;
    double at[3];
    *made = first != 0 && second != 0 && (first & second) == 0;
    if (!*made) return BVX_OK;
    place_between(o, v, first, second, at);
    return cut_edge(o, cut, t, v, first | second | (cut->among[a] & cut->among[b] & JOINT_OUTSIDE), at);
}

typedef bvx_status (*cut_fn)(bvxi_oblique *o, bvxi_joint_cut *cut, uint32_t t, uint32_t a, uint32_t b,
                             int *made);

/* All edges that are to be cut, those of what the cuts make too: each cut puts a vertex with more kinds in
 * place of a corner, so this ends. */
static bvx_status cut_edges(bvxi_oblique *o, bvxi_joint_cut *cut, cut_fn one)
{
    for (uint64_t t = 0; t < o->tetra_count; t++) {
        uint64_t common = ~(uint64_t)JOINT_OUTSIDE;
        int inside = 0, outside = 0, again;

        /* Most tetrahedra are of one kind: one body at all corners that are not only outside. */
        for (int k = 0; k < 4; k++) {
            uint64_t const among = cut->among[o->tetra[t].v[k]];
            inside |= (among & JOINT_OUTSIDE) == 0;
            outside |= among == JOINT_OUTSIDE;
            if (among != JOINT_OUTSIDE) common &= among;
        }
        again = common == 0 || (inside && outside);
        if (t % 65536 == 0) BVXI_TRY(bvxi_progress(o->ctx, "surface", (double)t / (double)o->tetra_count));
        while (again) {
            again = 0;
            for (int a = 0; a < 4; a++)
                for (int b = a + 1; b < 4; b++) {
                    int made;
                    BVXI_TRY(one(o, cut, (uint32_t)t, o->tetra[t].v[a], o->tetra[t].v[b], &made));
                    again |= made;
                }
        }
    }
    return BVX_OK;
}

/* ---- specks of bodies on the surface of all ---- */

enum { SURFACE_SPECK = 48 }; /* vertices: what is larger has its place on the surface, contour or not */

/* Parts that may be specks, of crossings or of tetrahedra, and the kinds around them; all but joined at roots. */
typedef struct speck_work {
    uint32_t *joined;
    uint32_t *count; /* of crossings; or whether a plane says so; UINT32_MAX: it stays */
    uint32_t *lead;  /* by how much a kind leads around it */
    uint8_t *beside; /* which */
} speck_work;

static bvx_status open_specks(bvx_context *ctx, uint64_t n, speck_work *w)
{
    static const char what[] = "the pieces of bodies";
    BVXI_TRY(BVXI_ARRAY(ctx, n, what, w->joined));
    BVXI_TRY(BVXI_ZEROS(ctx, n, what, w->count));
    BVXI_TRY(BVXI_ZEROS(ctx, n, what, w->lead));
    BVXI_TRY(BVXI_ZEROS(ctx, n, what, w->beside));
    for (uint64_t i = 0; i < n; i++) w->joined[i] = (uint32_t)i;
    return BVX_OK;
}

/* The kind that more than half of all are of, if any, is the last to lead (Boyer, Moore 1981). */
static void count_speck_beside(speck_work *w, uint32_t root, uint64_t kinds)
{
    if (w->lead[root] == 0) w->beside[root] = (uint8_t)bvxi_lowest(kinds);
    w->lead[root] += (kinds >> w->beside[root] & 1) != 0 ? 1 : UINT32_MAX;
}

static int crossings_of(const bvxi_tetra *t, uint64_t first)
{
    int n = 0;
    for (int k = 0; k < 4; k++) n += t->v[k] >= first;
    return n;
}

/* A body that comes to the surface in a few crossings that none of its contours is next to would be a handle
 * of itself, and a hole in those around it: these have the crossings. first: of the crossings' vertices. */
static bvx_status drop_surface_specks(bvxi_oblique *o, bvxi_joint_cut *cut, uint64_t first)
{
    uint64_t const n = o->vertex_count;
    speck_work w;

    BVXI_TRY(open_specks(o->ctx, n, &w));
    for (uint64_t t = 0; t < o->tetra_count; t++)
        for (int a = 0; a < 4 && crossings_of(&o->tetra[t], first) > 1; a++)
            for (int b = 0; b < a; b++) {
                uint32_t const v = o->tetra[t].v[a], x = o->tetra[t].v[b];
                if (v >= first && x >= first && cut->among[v] == cut->among[x]) bvxi_join(w.joined, v, x);
            }
    for (uint64_t v = first; v < o->vertex_count; v++) {
        uint32_t const root = bvxi_root(w.joined, (uint32_t)v);
        w.count[root]++;
    }
    for (uint64_t t = 0; t < o->tetra_count; t++)
        for (int a = 0; a < 4 && crossings_of(&o->tetra[t], first) > 0; a++)
            for (int b = 0; b < 4; b++) {
                uint32_t const v = o->tetra[t].v[a], other = o->tetra[t].v[b];
                uint64_t const beside = cut->among[other],
                               common = cut->among[v] & beside & ~(uint64_t)JOINT_OUTSIDE;

                if (v < first || (beside & JOINT_OUTSIDE) == 0 || beside == JOINT_OUTSIDE) continue;
                uint32_t const root = bvxi_root(w.joined, v);
                /* Contours of the body on the surface: its part there is wanted. */
                if (common != 0 && other < first) w.count[root] = UINT32_MAX;
                if (common == 0 && other >= first)
                    count_speck_beside(&w, root, beside & ~(uint64_t)JOINT_OUTSIDE);
            }

    for (uint64_t v = first; v < n; v++) {
        uint32_t const root = bvxi_root(w.joined, (uint32_t)v);
        if (w.count[root] > SURFACE_SPECK || w.lead[root] == 0) continue;
        cut->among[v] = JOINT_OUTSIDE | UINT64_C(1) << w.beside[root];
    }
    return BVX_OK;
}

typedef struct tetra_job {
    bvxi_oblique *o;
    const bvxi_joint_cut *cut;
} tetra_job;

static int kind_of_tetrahedron(const bvxi_oblique *o, const bvxi_joint_cut *cut, const bvxi_tetra *t)
{
    uint64_t all = UINT64_MAX, any = 0, bodies;
    double at[3];

    for (int k = 0; k < 4; k++) {
        uint64_t const among = cut->among[t->v[k]];
        if (among == JOINT_OUTSIDE) return 0;
        all &= among;
        any |= among;
    }
    /* What all corners have in common, or where that is the outside alone, what any has. */
    bodies = (all > JOINT_OUTSIDE ? all : any) & ~(uint64_t)JOINT_OUTSIDE;
    if (!(all & JOINT_OUTSIDE) && (bodies & (bodies - 1)) == 0) return bvxi_lowest(bodies);

    /* All corners lie on the surface of all, or between the same bodies: what its middle is, of those. */
    bvxi_oblique_middle(o, t->v, 4, at);
    return bvxi_joint_kind_among(o, at, bodies | (all & JOINT_OUTSIDE));
}

static void tetra_kinds_piece(void *user, uint64_t begin, uint64_t end)
{
    const tetra_job *const job = user;
    const bvxi_oblique *const o = job->o;
    for (uint64_t t = begin; t < end; t++)
        job->cut->kind[t] = (uint8_t)kind_of_tetrahedron(o, job->cut, &o->tetra[t]);
}

int bvxi_joint_border_kind(const bvxi_oblique *o, const bvxi_tetra *t, int corner)
{
    for (int k = 0; k < 4; k++)
        if (k != corner && o->vertex[t->v[k]].sign != 0) return (int)o->vertex[t->v[k]].value;
    return 0;
}

static bvx_status drop_specks(bvxi_oblique *o, bvxi_joint_cut *cut)
{
    uint64_t const n = o->tetra_count;
    speck_work w;

    BVXI_TRY(open_specks(o->ctx, n, &w));
    for (uint64_t t = 0; t < n; t++)
        for (int k = 0; k < 4; k++) {
            uint32_t const beside = o->tetra[t].n[k];
            /* Each face once, from the tetrahedron with the higher number. */
            if (beside != BVXI_NONE && beside <= t && cut->kind[beside] == cut->kind[t])
                bvxi_join(w.joined, (uint32_t)t, beside);
        }

    /* What no plane has anything of is of the kind that is around it. */
    for (uint64_t t = 0; t < o->tetra_count; t++) {
        uint32_t const root = bvxi_root(w.joined, (uint32_t)t);
        for (int k = 0; k < 4; k++) {
            uint32_t const v = o->tetra[t].v[k], beside = o->tetra[t].n[k];
            w.count[root] |= beside == BVXI_NONE || o->vertex[v].sign == BVXI_JOINT_BEYOND ||
                             (o->vertex[v].sign != 0 && bvxi_first_plane(o, v) != BVXI_NONE);
            if (beside == BVXI_NONE || cut->kind[beside] == cut->kind[t]) continue;
            count_speck_beside(&w, root, UINT64_C(1) << cut->kind[beside]);
        }
    }
    /* A piece whose neighbours are of several kinds may get one without a majority: any is right. */
    for (uint64_t t = 0; t < n; t++) {
        uint32_t const root = bvxi_root(w.joined, (uint32_t)t);
        if (w.count[root] == 0) cut->kind[t] = w.beside[root];
    }
    return BVX_OK;
}

bvx_status bvxi_joint_cut_all(bvxi_oblique *o, bvxi_joint_cut *cut)
{
    tetra_job job = {o, cut};
    uint32_t *torn = NULL;
    uint64_t torn_count = 0;

    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.1, bvxi_oblique_part_contours(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.1, 0.3,
                        bvxi_for(o->ctx, "surface", o->vertex_count, 256, joint_kinds_piece, o)));
    /* Where contours were moved to agree, a plane's kinds are told by its regions. What is torn there is told
     * by the check of each mesh. */
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.3, 0.4, bvxi_oblique_regions(o, &torn, &torn_count)));
    BVXI_TRY(BVXI_RESERVE(o, cut->among, o->vertex_room, cut->among_room, "the kinds of vertices"));
    for (uint64_t i = 0; i < o->vertex_count; i++)
        cut->among[i] = o->vertex[i].sign == 0 ? 0 : UINT64_C(1) << (int)o->vertex[i].value;

    for (uint64_t t = 0; t < o->tetra_count; t++) {
        if (bvxi_on_contours(o, &o->tetra[t]) == 0) continue;
        for (int a = 0; a < 4; a++)
            for (int b = 0; b < 4; b++) {
                uint32_t const v[2] = {o->tetra[t].v[a], o->tetra[t].v[b]};
                if (o->vertex[v[0]].sign == 0 && o->vertex[v[1]].sign != 0 && bvxi_share_plane(o, v, 2))
                    cut->among[v[0]] |= cut->among[v[1]];
            }
    }

    uint64_t const crossings = o->vertex_count;
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.4, 0.6, cut_edges(o, cut, cut_from_outside)));
    BVXI_TRY(BVXI_SCOPE(o->ctx, drop_surface_specks(o, cut, crossings)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.6, 0.8, cut_edges(o, cut, cut_between_bodies)));

    BVXI_TRY(BVXI_RESERVE(o, cut->kind, o->tetra_count, cut->kind_room, "the kinds of tetrahedra"));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.8, 0.9,
                        bvxi_for(o->ctx, "surface", o->tetra_count, 4096, tetra_kinds_piece, &job)));
    return BVXI_SHARE(o->ctx, 0.9, 1.0, BVXI_SCOPE(o->ctx, drop_specks(o, cut)));
}
