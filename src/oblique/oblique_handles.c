/* oblique_handles.c - handles of the surface that no contour needs are cut or filled.
 *
 * What of the surface lies between the same contours is a patch. A patch that is a disc with a handle, or a
 * tube with one, has it from the lattice: tetrahedra between planes that are close together may have all
 * corners on planes, whose signs are fixed, so that a bridge of the body runs along an edge from plane to
 * plane and nothing can be changed. Such edges get a vertex. Then one side of the patch, the body or what is
 * outside, is thinned: vertices on no plane whose numbers are small change to the other side one by one, as
 * long as nothing opens, joins or parts. A handle is a thread then; it is cut at the vertex with the smallest
 * number that leaves the side in as many stretches as before. Last all that was thinned comes back, but for
 * what would close the cut: little more than the cut has changed.
 *
 * Source: Bertrand, Malandain. A new characterization of three-dimensional simple points. 1994 (the numbers
 * of stretches on both sides around a point say what its change does to the Euler number).
 *
 * No vertex of a plane or contour changes; a cut that would tear a contour's surface is taken back. A handle
 * that is half a cell thick at its thinnest on both sides stays: it is the body's rather than the lattice's. */
#include "oblique/oblique.h"
#include "bits/sort.h"
#include "mesh/view.h"

#define HANDLE_MIDDLE 0.001F /* cells: the number of a vertex put into an edge between planes */

enum { HANDLE_TETRA = 20000, HANDLE_DEPTHS = 3, HANDLE_TRIES = 64 };

/* Between two reports: so many corners of triangles, or looks around a vertex. */
enum { PATCH_REPORT = 131072, LOOK_REPORT = 256 };

typedef struct handle_work {
    bvxi_oblique *o;
    uint32_t *vertex_of, *patch, *fan, *loop;
    uint8_t *side; /* of the edge from each corner: 0 a border of its patch, 1 and 2 both of an inner one */
    int32_t *euler, *loops;
    bvxi_map pair;
    uint64_t triangles;
    uint64_t settled; /* handles filled or cut */
    uint32_t *number, *tetra, *member, *joined, *flip;
    uint64_t *loose; /* vertices that may change, by the size of their numbers */
    uint8_t *back;   /* of each in flip: it came back */
    uint64_t tetra_room, member_room, flip_room, loose_room, loose_count;
    uint32_t tetras, members, flips;
    int strict; /* contours hold at every step, else at the end */
    uint32_t block[BVXI_LOOK_WORDS * BVXI_LOOK_MOST];
    bvxi_look look; /* in the block */
    uint32_t looks; /* around vertices, so far */
    double done;    /* of the patches */
} handle_work;

static bvx_status report_patches(const handle_work *w, double from, uint32_t corner)
{
    if (corner % PATCH_REPORT != 0) return BVX_OK;
    return bvxi_progress(w->o->ctx, "surface", from + 0.2 * corner / (3.0 * (double)w->triangles));
}

/* A patch may have a million vertices, each of which is looked at many times. */
static bvx_status report_look(handle_work *w)
{
    if (++w->looks % LOOK_REPORT != 0) return BVX_OK;
    return bvxi_progress(w->o->ctx, "surface", w->done);
}

/* ---- patches ---- */

static bvx_status join_surface_patches(handle_work *w, const uint32_t *corner)
{
    for (uint32_t c = 0; c < 3 * w->triangles; c++) {
        uint32_t const a = corner[c], b = corner[bvxi_corner_after(c)], x = w->vertex_of[a],
                       y = w->vertex_of[b];
        uint32_t *first;

        BVXI_TRY(report_patches(w, 0.0, c));
        /* Patches end at contours, whatever the surface does beyond them. */
        if (x != BVXI_NONE && y != BVXI_NONE && bvxi_edge_find(&w->o->contour_edge, x, y) != BVXI_NONE)
            continue;
        BVXI_TRY(bvxi_edge_add(w->o, &w->pair, a, b, &first));
        if (*first == BVXI_NONE) {
            *first = c;
            continue;
        }
        /* Seen from the other triangle the edge runs the other way; anything else is a tear, found later. */
        if (w->side[*first] != 0 || corner[*first] != b) continue;
        w->side[*first] = 1;
        w->side[c] = 2;
        bvxi_join(w->patch, *first / 3, c / 3);
        bvxi_join(w->fan, *first, bvxi_corner_after(c));
        bvxi_join(w->fan, bvxi_corner_after(*first), c);
    }
    return BVX_OK;
}

static bvx_status find_surface_patches(handle_work *w)
{
    static const char what[] = "the patches of the surface";
    bvxi_oblique *const o = w->o;
    bvx_context *const ctx = o->ctx;
    uint64_t const n = w->triangles;

    BVXI_TRY(BVXI_ARRAY(ctx, o->mesh.vertex_count, what, w->vertex_of));
    BVXI_TRY(BVXI_ARRAY(ctx, n, what, w->patch));
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * n, what, w->fan));
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * n, what, w->loop));
    BVXI_TRY(BVXI_ZEROS(ctx, 3 * n, what, w->side));
    BVXI_TRY(BVXI_ZEROS(ctx, n, what, w->euler));
    BVXI_TRY(BVXI_ZEROS(ctx, n, what, w->loops));

    memset(w->vertex_of, 0xff, (size_t)o->mesh.vertex_count * 4);
    /* Back from vertices of the surface to those of the tetrahedra, which contours' edges are kept by. */
    for (uint64_t v = 0; v < o->output_room; v++)
        if (o->output[v] != BVXI_NONE) w->vertex_of[o->output[v]] = (uint32_t)v;
    for (uint32_t t = 0; t < n; t++) w->patch[t] = t;
    for (uint32_t c = 0; c < 3 * n; c++) w->fan[c] = c;
    BVXI_TRY(join_surface_patches(w, o->mesh.triangle));

    /* Of each patch its Euler number and how many loops its border is, at its root. */
    for (uint32_t c = 0; c < 3 * w->triangles; c++) w->loop[c] = c;
    for (uint32_t c = 0; c < 3 * w->triangles; c++) {
        int32_t *const euler = &w->euler[bvxi_root(w->patch, c / 3)];
        BVXI_TRY(report_patches(w, 0.2, c));
        /* Triangles and vertices count for, edges against; an inner edge at one of its sides. */
        if (c % 3 == 0) ++*euler;
        if (bvxi_root(w->fan, c) == c) ++*euler;
        if (w->side[c] != 2) --*euler;
        if (w->side[c] == 0)
            bvxi_join(w->loop, bvxi_root(w->fan, c), bvxi_root(w->fan, bvxi_corner_after(c)));
    }
    /* Each loop once, at the fan that is its root, which a border edge begins at. */
    for (uint32_t c = 0; c < 3 * w->triangles; c++) {
        uint32_t const f = bvxi_root(w->fan, c);
        BVXI_TRY(report_patches(w, 0.4, c));
        if (w->side[c] != 0 || w->loop[f] != f) continue;
        w->loops[bvxi_root(w->patch, c / 3)]++;
        w->loop[f] = BVXI_NONE;
    }
    return BVX_OK;
}

/* ---- what lies around ---- */

static bvx_status add_handle_tetra(handle_work *w, uint32_t t)
{
    bvxi_oblique *const o = w->o;
    if (o->tetra[t].stamp == o->stamps) return BVX_OK;
    BVXI_TRY(BVXI_GROW(o, w->tetra, w->tetras, w->tetra_room, "the tetrahedra of a handle"));
    o->tetra[t].stamp = o->stamps;
    w->tetra[w->tetras++] = t;
    return BVX_OK;
}

/* The tetrahedra that a patch runs through, and others between the same planes, the nearest first. */
static bvx_status gather_patch(handle_work *w, const uint32_t *owner, uint32_t patch)
{
    bvxi_oblique *const o = w->o;

    w->tetras = 0;
    bvxi_tetra_new_stamp(o);
    for (uint64_t t = o->plain_triangles; t < w->triangles; t++)
        if (bvxi_root(w->patch, (uint32_t)t) == patch)
            BVXI_TRY(add_handle_tetra(w, owner[t - o->plain_triangles]));
    uint32_t const most = w->tetras + HANDLE_TETRA;
    for (uint32_t i = 0; i < w->tetras && w->tetras < most; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t const t = w->tetra[i], next = o->tetra[t].n[k];
            uint32_t face[3];
            if (next == BVXI_NONE) continue;
            /* A face on a plane ends what belongs together: beyond it is another cell of the arrangement. */
            bvxi_tetra_face(&o->tetra[t], k, face);
            if (!bvxi_share_plane(o, face, 3)) BVXI_TRY(add_handle_tetra(w, next));
        }
    return BVX_OK;
}

/* The same, with a vertex in all edges from plane to plane; their vertices get numbers. */
static bvx_status look_around_patch(handle_work *w, const uint32_t *owner, uint32_t patch)
{
    static const char what[] = "the vertices of a handle";
    bvxi_oblique *const o = w->o;
    uint64_t const before = o->vertex_count;

    BVXI_TRY(gather_patch(w, owner, patch));
    for (uint32_t i = 0; i < w->tetras; i++) {
        /* Edges from plane to plane with both ends on one side get a vertex, on that side as well. */
        uint32_t const t = w->tetra[i];
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++) {
                uint32_t const x = o->tetra[t].v[a], y = o->tetra[t].v[b];
                int const inside = o->vertex[x].sign > 0 || o->vertex[y].sign > 0;
                uint32_t const ends[2] = {x, y};
                double at[3];
                uint32_t m;

                /* An edge within a plane must not be cut: what is on the plane is fixed. */
                if (bvxi_share_plane(o, ends, 2) || o->vertex[x].sign * o->vertex[y].sign < 0 ||
                    bvxi_first_plane(o, x) == BVXI_NONE || bvxi_first_plane(o, y) == BVXI_NONE)
                    continue;
                bvxi_oblique_middle(o, ends, 2, at);
                BVXI_TRY(bvxi_tetra_split_edge(o, t, x, y, at, &m));
                o->vertex[m].sign = inside ? 1 : -1;
                o->vertex[m].value = inside ? HANDLE_MIDDLE : -HANDLE_MIDDLE;
            }
    }
    /* Halves of tetrahedra that were split are no part of what was gathered. */
    if (o->vertex_count > before) BVXI_TRY(gather_patch(w, owner, patch));
    bvxi_drop(o->ctx, w->number);
    w->number = NULL;
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->vertex_count, what, w->number));
    memset(w->number, 0xff, (size_t)o->vertex_count * 4);
    w->members = 0;
    for (uint32_t i = 0; i < 4 * w->tetras; i++) {
        uint32_t const x = o->tetra[w->tetra[i / 4]].v[i % 4];
        if (w->number[x] != BVXI_NONE) continue;
        BVXI_TRY(BVXI_GROW_BESIDE(o, w->joined, w->members, w->member_room, sizeof *w->joined, what));
        BVXI_TRY(BVXI_GROW(o, w->member, w->members, w->member_room, what));
        w->member[w->members] = x;
        w->number[x] = w->members++;
    }
    return BVX_OK;
}

static uint32_t count_handle_stretches(handle_work *w, int inside)
{
    const bvxi_oblique *const o = w->o;
    uint32_t stretches = 0;

    for (uint32_t i = 0; i < w->members; i++) w->joined[i] = i;
    for (uint32_t i = 0; i < w->tetras; i++) {
        const uint32_t *const v = o->tetra[w->tetra[i]].v;
        uint32_t last = BVXI_NONE;
        /* Vertices of one side that share an edge are one stretch: the surface parts the two sides. */
        for (int k = 0; k < 4; k++) {
            if ((o->vertex[v[k]].sign > 0) != inside) continue;
            if (last != BVXI_NONE) bvxi_join(w->joined, w->number[last], w->number[v[k]]);
            last = v[k];
        }
    }
    for (uint32_t i = 0; i < w->members; i++)
        stretches += w->joined[i] == i && (o->vertex[w->member[i]].sign > 0) == inside;
    return stretches;
}

/* ---- changes ---- */

/* Whether the surface meets the contours around a vertex once, as before. */
static bvx_status contours_hold(handle_work *w, uint32_t v, int *hold)
{
    bvxi_oblique *const o = w->o;

    BVXI_TRY(report_look(w));
    BVXI_TRY(bvxi_tetra_star(o, v));
    for (uint64_t i = 0; i < o->star_count && *hold; i++) {
        const uint32_t *const x = o->tetra[o->star[i]].v;
        for (int a = 0; a < 4 && *hold; a++) {
            if (o->vertex[x[a]].sign != 0) continue;
            *hold = bvxi_look_link(o, &w->look, x[a]) && !bvxi_look_torn(o, &w->look, x[a]);
            for (int b = a + 1; b < 4 && *hold; b++) {
                uint32_t changes = 0;
                int closed;
                if (bvxi_edge_find(&o->contour_edge, x[a], x[b]) == BVXI_NONE) continue;
                /* How often the sign changes round an edge that tetrahedra go all the way round. */
                BVXI_TRY(bvxi_tetra_ring(o, o->star[i], x[a], x[b], &closed));
                for (uint64_t r = 0; r < o->ring_count && closed; r++) {
                    const uint32_t *const y = o->tetra[o->ring[r]].v;
                    int sign[2], n = 0;
                    for (int k = 0; k < 4; k++)
                        if (y[k] != x[a] && y[k] != x[b]) sign[n++ & 1] = o->vertex[y[k]].sign;
                    changes += sign[0] != sign[1];
                }
                *hold = changes <= 2;
            }
        }
    }
    return BVX_OK;
}

/* Changes the side of a vertex that has so many stretches of its own side around it, two being more, and one
 * of the other: with one nothing is opened, joined or parted. *around: how many; 0: nothing changes, as it is
 * not so or, where they are to hold at every step, contours would not. */
static bvx_status change_side(handle_work *w, uint32_t v, uint32_t wanted, uint32_t *around)
{
    bvxi_oblique *const o = w->o;
    int const inside = o->vertex[v].sign > 0;
    uint32_t stretches[2];
    int hold = 1;

    *around = 0;
    BVXI_TRY(report_look(w));
    if (!bvxi_look_link(o, &w->look, v)) return BVX_OK;
    bvxi_look_stretches(o, &w->look, v, 1, stretches);
    if (stretches[!inside] != 1 || (wanted == 1 ? stretches[inside] != 1 : stretches[inside] < 2))
        return BVX_OK;
    bvxi_flip_sign(o, v);
    if (w->strict) BVXI_TRY(contours_hold(w, v, &hold));
    if (hold) *around = stretches[inside];
    else bvxi_flip_sign(o, v);
    return BVX_OK;
}

/* Vertices of a side that may change and have small numbers, the smallest first. */
static bvx_status list_loose(handle_work *w, double depth, int inside)
{
    bvxi_oblique *const o = w->o;
    uint64_t n = 0;

    for (uint32_t i = 0; i < w->members; i++) {
        uint32_t const x = w->member[i];
        float const size = (float)bvxi_absolute(o->vertex[x].value);
        uint32_t bits;

        if (o->vertex[x].sign == 0 || (o->vertex[x].sign > 0) != inside || size > depth ||
            bvxi_first_plane(o, x) != BVXI_NONE)
            continue;
        BVXI_TRY(report_look(w));
        if (!bvxi_look_link(o, &w->look, x) || !bvxi_look_whole(o, &w->look, x)) continue;
        BVXI_TRY(BVXI_GROW(o, w->loose, n, w->loose_room, "the vertices of a handle"));
        /* Floats from 0 on have the order of their bits. */
        memcpy(&bits, &size, 4);
        w->loose[n++] = (uint64_t)bits << 32 | x;
    }
    w->loose_count = n;
    bvxi_sort_u64(w->loose, n);
    return BVX_OK;
}

/* What was taken away comes back, the last first, but for what would close a cut again. */
static bvx_status thicken_side(handle_work *w)
{
    memset(w->back, 0, w->flips);
    for (int again = 1; again;) {
        again = 0;
        for (uint32_t i = w->flips; i-- > 0;) {
            uint32_t around = 0;
            if (!w->back[i]) BVXI_TRY(change_side(w, w->flip[i], 1, &around));
            if (around == 0) continue;
            w->back[i] = 1;
            again = 1;
        }
    }
    return BVX_OK;
}

/* A thread whose cut leaves as many stretches as there were was a handle. It is cut where that moves the
 * surface least, and thickened again; one that the contours would not bear is left. */
static bvx_status cut_thread(handle_work *w, int inside, int32_t *gain)
{
    bvxi_oblique *const o = w->o;
    uint32_t const stretches = count_handle_stretches(w, inside);
    int tries = 0;

    for (uint64_t i = 0; i < w->loose_count && tries < HANDLE_TRIES; i++) {
        uint32_t const v = (uint32_t)w->loose[i];
        uint32_t around;

        if ((o->vertex[v].sign > 0) != inside) continue;
        BVXI_TRY(change_side(w, v, 2, &around));
        if (around == 0) continue;
        tries++;
        BVXI_TRY(bvxi_progress(o->ctx, "surface", w->done));
        if (count_handle_stretches(w, inside) == stretches) {
            BVXI_TRY(thicken_side(w));
            int hold = 1;
            BVXI_TRY(contours_hold(w, v, &hold));
            for (uint32_t k = 0; k < w->flips && hold; k++)
                if (!w->back[k]) BVXI_TRY(contours_hold(w, w->flip[k], &hold));
            if (hold) {
                *gain = (int32_t)around - 1;
                return BVX_OK;
            }
            for (uint32_t k = 0; k < w->flips; k++)
                if (w->back[k]) bvxi_flip_sign(o, w->flip[k]);
        }
        bvxi_flip_sign(o, v);
    }
    for (uint32_t k = 0; k < w->flips; k++) bvxi_flip_sign(o, w->flip[k]);
    *gain = 0;
    return BVX_OK;
}

static bvx_status settle_surface_patch(handle_work *w, int32_t handles)
{
    static const double depth[HANDLE_DEPTHS] = {0.01, 0.05, 0.5}; /* cells */
    for (int k = 0; k < 4 * HANDLE_DEPTHS && handles > 0;) {
        int const inside = (k & 1) == 0;
        int32_t gain;
        w->strict = (k & 2) == 0;
        BVXI_TRY(list_loose(w, depth[k / 4], inside));

        /* Takes the side's vertices away one by one while that changes nothing but where the surface is:
         * what stays of a bridge is a thread of vertices. */
        bvxi_oblique *const o = w->o;
        uint32_t before;

        w->flips = 0;
        do {
            before = w->flips;
            for (uint64_t i = 0; i < w->loose_count; i++) {
                uint32_t const v = (uint32_t)w->loose[i];
                uint32_t around = 0;
                if ((o->vertex[v].sign > 0) == inside) BVXI_TRY(change_side(w, v, 1, &around));
                if (around == 0) continue;
                BVXI_TRY(BVXI_GROW_BESIDE(o, w->back, w->flips, w->flip_room, sizeof *w->back,
                                          "the vertices of a handle"));
                BVXI_TRY(BVXI_GROW(o, w->flip, w->flips, w->flip_room, "the vertices of a handle"));
                w->flip[w->flips++] = v;
            }
        } while (w->flips > before);

        BVXI_TRY(cut_thread(w, inside, &gain));
        handles -= gain;
        w->settled += (uint64_t)gain;
        if (gain == 0) k++;
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_handles(bvxi_oblique *o, const uint32_t *owner, uint64_t *settled)
{
    handle_work w = {.o = o, .triangles = o->mesh.triangle_count};
    uint64_t found = 0;

    w.look = bvxi_look_in(w.block, BVXI_LOOK_MOST);
    BVXI_TRY(find_surface_patches(&w));
    for (uint32_t t = 0; t < w.triangles; t++) {
        /* Of a patch with that many loops as its border: Euler's number is 2 - loops - 2 * handles. */
        int32_t const handles = (2 - w.euler[t] - w.loops[t]) / 2;
        uint64_t const vertices = o->vertex_count;

        if (w.patch[t] != t || handles <= 0 || w.loops[t] == 0) continue;
        found += (uint64_t)handles;
        BVXI_TRY(look_around_patch(&w, owner, t));
        w.done = 0.6 + 0.4 * t / (double)w.triangles;
        BVXI_TRY(settle_surface_patch(&w, handles));

        /* Vertices put into edges that stayed on their side get the number between their ends': with the
         * small one, which let them change first, the surface would reach out to them. */
        for (uint64_t v = vertices; v < o->vertex_count; v++) {
            bvxi_tetra_vertex *const x = &o->vertex[v];
            float const middle = 0.5F * (o->vertex[x->parent[0]].value + o->vertex[x->parent[1]].value);
            if ((x->sign > 0 && middle > 0.0F) || (x->sign < 0 && middle < 0.0F)) x->value = middle;
        }
    }
    *settled = w.settled;
    o->handles_left = found > *settled ? found - *settled : 0;
    return BVX_OK;
}
