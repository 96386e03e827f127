/* oblique_handles.c - handles of the surface that no contour needs are cut or filled.
 *
 * What of the surface lies between the same contours is a patch. A patch that is a disc with a handle, or a
 * tube with one, has it from the lattice: tetrahedra between planes that are close together may have all
 * corners on planes, whose signs are fixed, so that a bridge of the body runs along an edge from plane to
 * plane and nothing can be changed. Such edges get a vertex; then vertices on no plane that lie near each
 * other, and whose numbers are small, are put on one side at once, the fewest first, until the patch has a
 * handle less.
 *
 * Source: Bertrand, Malandain. A new characterization of three-dimensional simple points. 1994 (the numbers
 * of stretches on both sides around a point say what its change does to the Euler number).
 *
 * No vertex of a plane or contour changes; what would join, part or open anything, or tear a contour's
 * surface, is taken back. */
#include "section/oblique.h"

#define HANDLE_REACH  2.5    /* cells: what is looked at around a change */
#define HANDLE_MIDDLE 0.001F /* cells: the number of a vertex put into an edge between planes */

enum { HANDLE_TETRA = 20000, HANDLE_SIZES = 3, HANDLE_DEPTHS = 3 };

typedef struct handle_work {
    bvxi_oblique *o;
    /* the triangles of tetrahedra: patches of them, fans of their corners */
    uint32_t *vertex_of, *patch, *fan, *loop;
    uint8_t *side; /* of the edge from each corner: 0 a border of its patch, 1 and 2 both of an inner one */
    int32_t *euler, *loops;
    bvxi_edge_map pair;
    uint64_t triangles;
    /* what is looked at around a vertex */
    uint32_t *number, *tetra, *member, *joined, *flip, *seed;
    uint8_t *known; /* bits: 1 to be changed; 2, 4 a stretch that was counted */
    uint64_t tetra_room, member_room, joined_room, flip_room, seed_room, known_room;
    uint32_t tetras, members, flips, seeds;
    bvxi_look look;
} handle_work;

static uint32_t handle_next_corner(uint32_t c)
{
    return c % 3 == 2 ? c - 2 : c + 1;
}

/* ---- patches ---- */

static int is_contours_edge(const handle_work *w, uint32_t a, uint32_t b)
{
    uint32_t const x = w->vertex_of[a], y = w->vertex_of[b];

    return x != BVXI_NONE && y != BVXI_NONE && bvxi_edge_find(&w->o->contour_edge, x, y) != BVXI_NONE;
}

static bvx_status join_surface_patches(handle_work *w, const uint32_t *corner)
{
    for (uint32_t c = 0; c < 3 * w->triangles; c++) {
        uint32_t const a = corner[c], b = corner[handle_next_corner(c)];
        uint32_t *first;

        /* Patches end at contours, whatever the surface does beyond them. */
        if (is_contours_edge(w, a, b)) continue;
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
        bvxi_join(w->fan, *first, handle_next_corner(c));
        bvxi_join(w->fan, handle_next_corner(*first), c);
    }
    return BVX_OK;
}

/* Of each patch its Euler number and how many loops its border is, at its root. */
static void count_surface_patches(handle_work *w)
{
    for (uint32_t c = 0; c < 3 * w->triangles; c++) w->loop[c] = c;
    for (uint32_t c = 0; c < 3 * w->triangles; c++) {
        int32_t *const euler = &w->euler[bvxi_root(w->patch, c / 3)];
        /* Triangles and vertices count, edges count against them; an inner edge is counted at one of its
         * sides. */
        if (c % 3 == 0) ++*euler;
        if (bvxi_root(w->fan, c) == c) ++*euler;
        if (w->side[c] != 2) --*euler;
        /* Border edges that share a vertex of the patch are one loop. */
        if (w->side[c] == 0)
            bvxi_join(w->loop, bvxi_root(w->fan, c), bvxi_root(w->fan, handle_next_corner(c)));
    }
    /* Each loop once, at the fan that is its root, which a border edge begins at. */
    for (uint32_t c = 0; c < 3 * w->triangles; c++) {
        uint32_t const f = bvxi_root(w->fan, c);
        if (w->side[c] != 0 || w->loop[f] != f) continue;
        w->loops[bvxi_root(w->patch, c / 3)]++;
        w->loop[f] = BVXI_NONE;
    }
}

static bvx_status find_surface_patches(handle_work *w)
{
    static const char what[] = "the patches of the surface";
    bvxi_oblique *const o = w->o;
    bvx_context *const ctx = o->ctx;
    uint64_t const n = w->triangles;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, o->position_count * 4, what, &w->vertex_of));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 4, what, &w->patch));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 12, what, &w->fan));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 12, what, &w->loop));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, n * 3, what, &w->side));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, n * 4, what, &w->euler));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, n * 4, what, &w->loops));

    memset(w->vertex_of, 0xff, (size_t)o->position_count * 4);
    /* Back from vertices of the surface to those of the tetrahedra, which contours' edges are kept by. */
    for (uint64_t v = 0; v < o->output_room; v++)
        if (o->output[v] != BVXI_NONE) w->vertex_of[o->output[v]] = (uint32_t)v;
    for (uint32_t t = 0; t < n; t++) w->patch[t] = t;
    for (uint32_t c = 0; c < 3 * n; c++) w->fan[c] = c;
    BVXI_TRY(join_surface_patches(w, o->triangle + 3 * o->plain_triangles));
    count_surface_patches(w);
    return BVX_OK;
}

/* ---- vertices that may be on either side ---- */

static int is_either_side(const bvxi_oblique *o, uint32_t v)
{
    return o->vertex[v].sign != 0 && bvxi_first_plane(o, v) == BVXI_NONE;
}

static bvx_status add_handle_seed(handle_work *w, uint32_t v)
{
    BVXI_TRY(bvxi_oblique_grow(w->o, &w->seed, w->seeds, &w->seed_room, 4, "the vertices of a handle"));
    w->seed[w->seeds++] = v;
    return BVX_OK;
}

/* Edges from plane to plane with both ends on one side get a vertex, on that side as well. */
static bvx_status loosen_tetrahedron(handle_work *w, uint32_t t)
{
    bvxi_oblique *const o = w->o;

    for (int a = 0; a < 4; a++)
        for (int b = a + 1; b < 4; b++) {
            uint32_t const x = o->tetra[t].v[a], y = o->tetra[t].v[b];
            int const inside = o->vertex[x].sign > 0;
            uint64_t shared = 0;
            double at[3];
            uint32_t m;

            /* An edge within a plane must not be cut: what is on the plane is fixed. */
            for (uint32_t k = 0; k < o->plane_words; k++)
                shared |= bvxi_tetra_on(o, x)[k] & bvxi_tetra_on(o, y)[k];
            if (shared != 0 || inside != (o->vertex[y].sign > 0) || bvxi_first_plane(o, x) == BVXI_NONE ||
                bvxi_first_plane(o, y) == BVXI_NONE)
                continue;
            for (int k = 0; k < 3; k++) at[k] = 0.5 * (o->vertex[x].at[k] + o->vertex[y].at[k]);
            BVXI_TRY(bvxi_tetra_split_edge(o, t, x, y, at, &m));
            o->vertex[m].sign = inside ? 1 : -1;
            o->vertex[m].value = inside ? HANDLE_MIDDLE : -HANDLE_MIDDLE;
            BVXI_TRY(add_handle_seed(w, m));
        }
    return BVX_OK;
}

static bvx_status find_handle_seeds(handle_work *w, const uint32_t *owner, uint32_t patch)
{
    bvxi_oblique *const o = w->o;
    uint32_t last = BVXI_NONE, kept = 0;

    w->seeds = 0;
    for (uint32_t t = 0; t < w->triangles; t++) {
        /* Triangles of one tetrahedron follow each other: it is looked at once. */
        if (bvxi_root(w->patch, t) != patch || owner[t] == last) continue;
        last = owner[t];
        BVXI_TRY(loosen_tetrahedron(w, last));
        for (int k = 0; k < 4; k++)
            if (is_either_side(o, o->tetra[last].v[k])) BVXI_TRY(add_handle_seed(w, o->tetra[last].v[k]));
    }

    /* Splitting may have made more vertices than there were numbers for. */
    bvxi_drop(o->ctx, w->number);
    w->number = NULL;
    BVXI_TRY(bvxi_alloc(o->ctx, BVXI_SCRATCH, o->vertex_count * 4, "the vertices of a handle", &w->number));
    memset(w->number, 0xff, (size_t)o->vertex_count * 4);
    for (uint32_t i = 0; i < w->seeds; i++) {
        uint32_t const v = w->seed[i];
        if (w->number[v] != BVXI_NONE) continue;
        w->number[v] = 0;
        w->seed[kept++] = v;
    }
    /* The numbers served to find what was there twice; they begin anew for what is looked at. */
    for (uint32_t i = 0; i < kept; i++) w->number[w->seed[i]] = BVXI_NONE;
    w->seeds = kept;
    return BVX_OK;
}

/* ---- what lies around ---- */

static double square_apart(const bvxi_oblique *o, uint32_t a, uint32_t b)
{
    double square = 0.0;

    for (int k = 0; k < 3; k++) {
        double const d = o->vertex[a].at[k] - o->vertex[b].at[k];
        square += d * d;
    }
    return square;
}

/* The tetrahedra between the same planes as a vertex, as far as the reach; their vertices get numbers. */
static bvx_status look_around_handle(handle_work *w, uint32_t v)
{
    static const char what[] = "the tetrahedra of a handle";
    bvxi_oblique *const o = w->o;

    w->tetras = w->members = 0;
    /* The vertex's own tetrahedra first, then neighbours through faces. */
    BVXI_TRY(bvxi_tetra_star(o, v));
    for (uint64_t i = 0; i < o->star_count; i++) {
        BVXI_TRY(bvxi_oblique_grow(o, &w->tetra, w->tetras, &w->tetra_room, 4, what));
        w->tetra[w->tetras++] = o->star[i];
    }
    for (uint32_t i = 0; i < w->tetras && w->tetras < HANDLE_TETRA; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t const t = w->tetra[i], next = o->tetra[t].n[k];
            uint64_t on_plane = 0;
            int far = 0;

            if (next == BVXI_NONE || o->stamp[next] == o->stamps) continue;
            /* A face on a plane ends what belongs together: beyond it is another cell of the arrangement. */
            for (uint32_t word = 0; word < o->plane_words; word++) {
                uint64_t on = UINT64_MAX;
                for (int c = 0; c < 4; c++)
                    if (c != k) on &= bvxi_tetra_on(o, o->tetra[t].v[c])[word];
                on_plane |= on;
            }
            for (int c = 0; c < 4; c++)
                far |= square_apart(o, o->tetra[next].v[c], v) > HANDLE_REACH * HANDLE_REACH;
            if (far || on_plane != 0) continue;
            o->stamp[next] = o->stamps;
            BVXI_TRY(bvxi_oblique_grow(o, &w->tetra, w->tetras, &w->tetra_room, 4, what));
            w->tetra[w->tetras++] = next;
        }
    for (uint32_t i = 0; i < 4 * w->tetras; i++) {
        uint32_t const x = o->tetra[w->tetra[i / 4]].v[i % 4];
        if (w->number[x] != BVXI_NONE) continue;
        BVXI_TRY(bvxi_oblique_grow(o, &w->member, w->members, &w->member_room, 4, what));
        BVXI_TRY(bvxi_oblique_grow(o, &w->joined, w->members, &w->joined_room, 4, what));
        BVXI_TRY(bvxi_oblique_grow(o, &w->known, w->members, &w->known_room, 1, what));
        w->known[w->members] = 0;
        w->member[w->members] = x;
        w->number[x] = w->members++;
    }
    return BVX_OK;
}

/* Stretches of each side in what was looked at: all of them, and those that are more than what changes. */
static void count_handle_stretches(handle_work *w, int32_t all[2], int32_t lasting[2])
{
    const bvxi_oblique *const o = w->o;

    for (uint32_t i = 0; i < w->members; i++) {
        w->joined[i] = i;
        w->known[i] &= 1;
    }
    for (uint32_t i = 0; i < w->tetras; i++) {
        const uint32_t *const v = o->tetra[w->tetra[i]].v;
        /* Vertices of one side that share an edge are one stretch: in a tetrahedron the surface parts the
         * sides. */
        for (int a = 0; a < 4; a++)
            for (int b = a + 1; b < 4; b++)
                if ((o->vertex[v[a]].sign > 0) == (o->vertex[v[b]].sign > 0))
                    bvxi_join(w->joined, w->number[v[a]], w->number[v[b]]);
    }
    all[0] = all[1] = lasting[0] = lasting[1] = 0;
    for (uint32_t i = 0; i < w->members; i++) {
        int const inside = o->vertex[w->member[i]].sign > 0;
        uint8_t *const root = &w->known[bvxi_root(w->joined, i)];
        /* Each stretch once, at its root; it lasts if any vertex of it does not change. */
        if (!(*root & 2)) all[inside]++;
        if (!(*root & 4) && !(w->known[i] & 1)) lasting[inside]++;
        *root |= (uint8_t)(w->known[i] & 1 ? 2 : 6);
    }
}

/* ---- changes ---- */

static void take_changes_back(const handle_work *w)
{
    for (uint32_t i = 0; i < w->flips; i++) bvxi_flip_sign(w->o, w->flip[i]);
}

/* Whether the surface meets the contours around a vertex once, as before. */
static bvx_status contours_hold(handle_work *w, uint32_t v, int *hold)
{
    bvxi_oblique *const o = w->o;

    BVXI_TRY(bvxi_tetra_star(o, v));
    for (uint64_t i = 0; i < o->star_count && *hold; i++) {
        const uint32_t *const x = o->tetra[o->star[i]].v;
        for (int a = 0; a < 4 && *hold; a++) {
            if (o->vertex[x[a]].sign != 0) continue;
            /* A contour's point must lie on the surface once, and its edges too. */
            *hold = bvxi_look_link(o, &w->look, x[a]) && !bvxi_look_torn(o, &w->look, x[a]);
            for (int b = a + 1; b < 4 && *hold; b++) {
                uint32_t changes = 0;
                if (bvxi_edge_find(&o->contour_edge, x[a], x[b]) == BVXI_NONE) continue;
                *hold = bvxi_look_edge(o, &w->look, x[a], x[b], &changes) && changes <= 2;
            }
        }
    }
    return BVX_OK;
}

/* Vertices of the other side that may change, near a vertex, with numbers that are small. */
static bvx_status choose_changes(handle_work *w, uint32_t seed, double size, double depth, int inside)
{
    bvxi_oblique *const o = w->o;

    w->flips = 0;
    for (uint32_t i = 0; i < w->members; i++) {
        uint32_t const x = w->member[i];
        /* Only what no plane and no contour has fixed, and what can change without a tear. */
        w->known[i] = 0;
        if (!is_either_side(o, x) || (o->vertex[x].sign > 0) == inside ||
            bvxi_absolute(o->vertex[x].value) > depth || square_apart(o, x, seed) > size * size ||
            !bvxi_look_link(o, &w->look, x) || !bvxi_look_whole(o, &w->look, x))
            continue;
        w->known[i] = 1;
        BVXI_TRY(bvxi_oblique_grow(o, &w->flip, w->flips, &w->flip_room, 4, "the vertices of a handle"));
        w->flip[w->flips++] = x;
    }
    return BVX_OK;
}

/* All at once, if that leaves fewer handles and what hangs together as it was; *gain: how many fewer. */
static bvx_status try_changes(handle_work *w, int inside, int32_t *gain)
{
    int32_t before[2], after[2], lasting[2], stay[2];
    int hold;

    *gain = 0;
    count_handle_stretches(w, before, lasting);
    for (uint32_t i = 0; i < w->flips; i++) {
        uint32_t around[2] = {0, 0};
        if (bvxi_look_link(w->o, &w->look, w->flip[i]))
            bvxi_look_stretches(w->o, &w->look, w->flip[i], around);
        /* What the Euler number of the inside gains by this vertex alone, those before it being changed. */
        *gain += inside ? (int32_t)around[0] - (int32_t)around[1] : (int32_t)around[1] - (int32_t)around[0];
        bvxi_flip_sign(w->o, w->flip[i]);
    }
    if (*gain > 0) {
        /* Stretches that come or go change it as well, and are no handles. */
        count_handle_stretches(w, after, stay);
        *gain -= after[0] - before[0] + (after[1] - before[1]);
        hold = lasting[0] == stay[0] && lasting[1] == stay[1] && *gain > 0;
        for (uint32_t i = 0; i < w->flips && hold; i++) BVXI_TRY(contours_hold(w, w->flip[i], &hold));
        if (hold) return BVX_OK;
    }
    take_changes_back(w);
    *gain = 0;
    return BVX_OK;
}

/* Small places and small numbers first: as little as possible changes. */
static bvx_status settle_surface_patch(handle_work *w, int32_t handles, double done, uint64_t *settled)
{
    static const double size[HANDLE_SIZES] = {0.15, 0.4, 1.0}; /* cells */
    static const double depth[HANDLE_DEPTHS] = {0.01, 0.05, 0.5};

    for (int k = 0; k < HANDLE_SIZES * HANDLE_DEPTHS; k++)
        for (uint32_t i = 0; i < w->seeds; i++) {
            /* A patch may have thousands of seeds: the call can be stopped between them. */
            if (i % 16 == 0) BVXI_TRY(bvxi_progress(w->o->ctx, "surface", done));
            BVXI_TRY(look_around_handle(w, w->seed[i]));
            for (int inside = 1; inside >= 0 && handles > 0; inside--) {
                int32_t gain = 0;
                BVXI_TRY(
                    choose_changes(w, w->seed[i], size[k / HANDLE_DEPTHS], depth[k % HANDLE_DEPTHS], inside));
                if (w->flips > 0) BVXI_TRY(try_changes(w, inside, &gain));
                handles -= gain;
                *settled += (uint64_t)gain;
            }
            for (uint32_t m = 0; m < w->members; m++) w->number[w->member[m]] = BVXI_NONE;
            if (handles <= 0) return BVX_OK;
        }
    return BVX_OK;
}

static bvx_status settle_handles(handle_work *w, const uint32_t *owner, uint64_t *settled)
{
    BVXI_TRY(find_surface_patches(w));
    for (uint32_t t = 0; t < w->triangles; t++) {
        /* Of a patch with that many loops as its border: Euler's number is 2 less the loops and two for
         * each handle. */
        int32_t const handles = (2 - w->euler[t] - w->loops[t]) / 2;

        if (w->patch[t] != t || handles <= 0) continue;
        BVXI_TRY(find_handle_seeds(w, owner, t));
        BVXI_TRY(settle_surface_patch(w, handles, (double)t / (double)w->triangles, settled));
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_handles(bvxi_oblique *o, const uint32_t *owner, uint64_t *settled)
{
    handle_work w;
    bvx_status status;

    *settled = 0;
    memset(&w, 0, sizeof w);
    w.o = o;
    w.triangles = o->triangle_count - o->plain_triangles;
    status = settle_handles(&w, owner, settled);
    bvxi_edge_free(o, &w.pair);
    bvxi_drop(o->ctx, w.known);
    bvxi_drop(o->ctx, w.seed);
    bvxi_drop(o->ctx, w.flip);
    bvxi_drop(o->ctx, w.joined);
    bvxi_drop(o->ctx, w.member);
    bvxi_drop(o->ctx, w.tetra);
    bvxi_drop(o->ctx, w.number);
    bvxi_drop(o->ctx, w.loops);
    bvxi_drop(o->ctx, w.euler);
    bvxi_drop(o->ctx, w.side);
    bvxi_drop(o->ctx, w.loop);
    bvxi_drop(o->ctx, w.fan);
    bvxi_drop(o->ctx, w.patch);
    bvxi_drop(o->ctx, w.vertex_of);
    return status;
}
