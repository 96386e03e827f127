/* patches.c - triangles made to run the same way round, patch by patch.
 *
 * Half-edges are sorted by their ends, so those of an edge lie side by side. Where an edge has two triangles
 * they belong to one patch, and run the same way round when they run along it in opposite directions. A
 * union-find over triangles keeps, beside the way to the root, whether a triangle runs as its root does; two
 * answers for one pair make a patch that has one side only.
 *
 * Source: Tarjan. Efficiency of a Good But Not Linear Set Union Algorithm. 1975; links carry one more bit.
 * The minority is turned, as a reader of a mesh with a few flipped triangles would do. */
#include "mesh/topology.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

/* A link is a triangle << 1 | 1 when the two run differently; triangles < 2^31. A root links to itself. */
typedef struct patch_sums {
    uint32_t same;  /* triangles that run as the root does; later the patch's number */
    uint32_t other; /* and those that do not */
    double volume;  /* that the patch encloses when all run as the root does */
} patch_sums;

typedef struct patch_work {
    const bvx_mesh_view *view;
    const uint32_t *representative;
    const double *centre;
    bvxi_patches *out;
    uint32_t *corner; /* [Size: triangles * 3] */
    /* lower corner << 32 | higher one, of each half-edge; UINT64_MAX without area [Size: triangles * 3] */
    uint64_t *keys;
    uint32_t *numbers; /* their half-edges: 3 t + k runs from corner k to corner k + 1 */
    uint32_t *link;    /* [Size: triangles] */
    uint8_t *torn;     /* by root, 1: no turning helps */
    patch_sums *sums;  /* by root */
    uint32_t *border;  /* half-edges of edges that have not two triangles, where whole patches are judged */
    uint64_t border_count;
    int chance;
} patch_work;

/* ---- Patches and parts ---- */

uint32_t bvxi_link_root(uint32_t *link, uint32_t t, uint32_t *differs)
{
    *differs = 0;
    while (link[t] >> 1 != t) {
        /* Paths are halved on the way, and each link keeps whether its two ends differ. */
        uint32_t const up = link[t] >> 1, above = link[up] >> 1;
        link[t] = above << 1 | ((link[t] ^ link[up]) & 1);
        *differs ^= link[t] & 1;
        t = above;
    }
    return t;
}

/* ---- Edges ---- */

static void list_half_edges(patch_work *w)
{
    for (uint64_t t = 0; t < w->out->triangles; t++) {
        uint32_t *const c = w->corner + 3 * t;

        /* A triangle with two corners at one place has no sides: its half-edges come last. */
        bvxi_view_triangle(w->view, t, c);
        for (int k = 0; k < 3; k++) c[k] = w->representative[c[k]];
        int const flat = c[0] == c[1] || c[1] == c[2] || c[2] == c[0];

        for (uint64_t k = 0; k < 3; k++) {
            /* The lower corner first: both half-edges of an edge get the same key, whichever way they run. */
            uint64_t const a = c[k], b = c[k == 2 ? 0 : k + 1];
            w->keys[3 * t + k] = flat ? UINT64_MAX : a < b ? a << 32 | b : b << 32 | a;
            w->numbers[3 * t + k] = (uint32_t)(3 * t + k);
        }
    }
}

/* 1 where a half-edge runs from the edge's higher corner to the lower one. */
static uint32_t runs_down(const patch_work *w, uint64_t at)
{
    return w->corner[w->numbers[at]] != (uint32_t)(w->keys[at] >> 32);
}

static void link_edge(patch_work *w, uint64_t at, uint64_t n)
{
    /* Parts hang together over any edge, patches only over those of two triangles. */
    for (uint64_t i = 1; i < n; i++) bvxi_join(w->out->part, w->numbers[at] / 3, w->numbers[at + i] / 3);
    if (n == 2) {
        uint32_t const differ = runs_down(w, at) == runs_down(w, at + 1);
        uint32_t ds, dt;
        uint32_t const a = bvxi_link_root(w->link, w->numbers[at] / 3, &ds);
        uint32_t const b = bvxi_link_root(w->link, w->numbers[at + 1] / 3, &dt);
        /* The least triangle is the root, so the result does not depend on the order of edges. */
        uint32_t const least = a < b ? a : b, most = a < b ? b : a;
        if (a != b) {
            w->link[most] = least << 1 | (ds ^ dt ^ differ);
            w->torn[least] |= w->torn[most];
        } else if ((ds ^ dt) != differ) {
            w->torn[a] = 1; /* two ways to the same root that disagree: the patch has one side only */
        }
    }
    w->out->odd_edges += n % 2;
}

/* What stays open when triangles are turned. */
static void balance_edge(patch_work *w, uint64_t at, uint64_t n)
{
    uint64_t down = 0;
    /* Half of an edge's triangles running each way is balance; what is more stays open. */
    for (uint64_t i = 0; i < n; i++) down += runs_down(w, at + i) ^ w->out->turn[w->numbers[at + i] / 3];
    w->out->open_edges += 2 * down > n ? 2 * down - n : n - 2 * down;
    if (2 * down != n) w->out->open[w->out->part[w->numbers[at] / 3]] = 1;
    /* The first edge that a manifold would not have is kept for the message. */
    if (n == 1 || (n == 2 && down == 1)) return;
    if (w->out->refused_edges++ != 0) return;
    w->out->refused[0] = (uint32_t)(w->keys[at] >> 32);
    w->out->refused[1] = (uint32_t)w->keys[at];
}

static void each_edge(patch_work *w, void (*visit)(patch_work *, uint64_t, uint64_t))
{
    uint64_t const count = 3 * w->out->triangles;
    for (uint64_t at = 0, n; at < count && w->keys[at] != UINT64_MAX; at += n) {
        for (n = 1; at + n < count && w->keys[at + n] == w->keys[at];) n++;
        visit(w, at, n);
    }
}

/* ---- What is turned ---- */

double bvxi_patches_volume(const bvx_mesh_view *view, uint64_t t, const double centre[3])
{
    double p[3][3];
    bvxi_view_corners(view, t, p);
    /* About the centre, so that volumes of a mesh far away do not drown in rounding. */
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) p[k][a] -= centre[a];
    return bvxi_vec_volume6(p[0], p[1], p[2]);
}

/* 1: the triangles of a patch that run as its root does are turned, 0: the others. */
static uint32_t turns_root(const patch_sums *s)
{
    uint64_t const all = (uint64_t)s->same + s->other;
    /* A clear majority, five eighths, decides; else the sign of
     * the volume, which is above 0 when normals point outwards. */
    if (8 * (uint64_t)s->same >= 5 * all) return 0;
    if (8 * (uint64_t)s->other >= 5 * all) return 1;
    return s->volume < 0 || (s->volume == 0 && s->other > s->same);
}

/* ---- Whole patches ---- */

static void list_border(patch_work *w, uint64_t at, uint64_t n)
{
    if (n == 2) return;
    for (uint64_t i = 0; i < n && w->border != NULL; i++) w->border[w->border_count + i] = w->numbers[at + i];
    w->border_count += n;
}

/* Patches that face inward beside others: closed meshes have none, unless these are the first of two. */
static bvx_status turn_whole_patches(bvx_context *ctx, patch_work *w)
{
    bvxi_patch_sides in = {.view = w->view, .centre = w->centre, .corner = w->corner, .turn = w->out->turn};
    uint32_t *number;

    if ((w->out->odd_edges == 0 && !w->chance) || w->out->unorientable != 0) return BVX_OK;
    each_edge(w, list_border);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->border_count * 4, "the patches' borders", &w->border));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->out->triangles * 4, "the triangles' patches", &number));
    w->border_count = 0;
    each_edge(w, list_border);

    in.triangles = w->out->triangles;

    uint32_t count = 0, differs;
    /* A root is the least triangle of its patch, so it comes first. */
    for (uint64_t t = 0; t < w->out->triangles; t++) {
        uint32_t const root = bvxi_link_root(w->link, (uint32_t)t, &differs);
        if (root == t) w->sums[root].same = count++;
        number[t] = w->sums[root].same;
    }
    in.patches = count;

    in.patch = number;
    in.border = w->border;
    in.border_count = w->border_count;
    in.chance = w->chance;
    return bvxi_patch_sides_turn(ctx, &in);
}

/* ---- The whole ---- */

static bvx_status find_patches(bvx_context *ctx, patch_work *w)
{
    for (uint64_t t = 0; t < w->out->triangles; t++) {
        w->link[t] = (uint32_t)t << 1;
        w->out->part[t] = (uint32_t)t;
    }

    list_half_edges(w);
    BVXI_TRY(bvxi_radix_sort(ctx, w->keys, w->numbers, 3 * w->out->triangles));
    each_edge(w, link_edge);

    /* Sums need all links, and turning needs all sums. */
    for (uint64_t t = 0; t < w->out->triangles; t++) {
        uint32_t differs;
        patch_sums *const s = &w->sums[bvxi_link_root(w->link, (uint32_t)t, &differs)];
        double const volume = bvxi_patches_volume(w->view, t, w->centre);
        /* Counted by what the patch's root does: turning the root's side turns the sign of the volume. */
        *(differs ? &s->other : &s->same) += 1;
        s->volume += differs ? -volume : volume;
    }

    bvxi_patches *const out = w->out;
    for (uint64_t t = 0; t < out->triangles; t++) {
        uint32_t differs;
        uint32_t const root = bvxi_link_root(w->link, (uint32_t)t, &differs);
        out->part[t] = bvxi_root(out->part, (uint32_t)t);
        out->unorientable += root == t && w->torn[root];
        /* A torn patch is left as it is: no turning makes it run one way. */
        out->turn[t] = !w->torn[root] && (differs ^ turns_root(&w->sums[root])) != 0;
    }

    BVXI_TRY(BVXI_SCOPE(ctx, turn_whole_patches(ctx, w)));
    for (uint64_t t = 0; t < w->out->triangles; t++) w->out->turned += w->out->turn[t];
    /* What is torn has been decided: the marks are of open parts from here on. */
    memset(w->torn, 0, (size_t)w->out->triangles);
    each_edge(w, balance_edge);
    return BVX_OK;
}

bvx_status bvxi_patches_open(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                             const double centre[3], int chance, bvxi_patches *patches)
{
    patch_work w = {.view = view, .representative = representative, .centre = centre, .chance = chance};

    memset(patches, 0, sizeof *patches);
    /* Half-edges have three numbers a triangle, which 32 bits must hold. */
    if (view->triangle_count > UINT32_MAX / 3)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "the mesh has %u triangles; at most %u can be looked at edge by edge",
                             view->triangle_count, (uint64_t)(UINT32_MAX / 3));

    patches->triangles = view->triangle_count;
    w.out = patches;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, view->triangle_count * 4, "the triangles' parts", &patches->part));
    BVXI_TRY(
        bvxi_alloc_zero(ctx, BVXI_SCRATCH, view->triangle_count, "the turned triangles", &patches->turn));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, view->triangle_count, "the patches' marks", &patches->open));
    w.torn = patches->open;
    uint64_t const mark = bvxi_scratch_begin(ctx);
    uint64_t const n = w.out->triangles;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 12, "the patches' corners", &w.corner));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 24, "the patches' edges", &w.keys));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 12, "the patches' half-edges", &w.numbers));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 4, "the patches", &w.link));
    BVXI_TRY(BVXI_ZEROS(ctx, n, "the patches' sums", w.sums));
    return bvxi_scratch_end(ctx, mark, find_patches(ctx, &w));
}

void bvxi_patches_close(bvx_context *ctx, bvxi_patches *patches)
{
    bvxi_drop(ctx, patches->open);
    bvxi_drop(ctx, patches->turn);
    bvxi_drop(ctx, patches->part);
    memset(patches, 0, sizeof *patches);
}

void bvxi_patches_turn(const bvx_mesh_view *view, const bvxi_patches *patches, uint32_t *index,
                       bvx_mesh_view *turned)
{
    /* Two corners change places, which turns the triangle and keeps its first corner. */
    for (uint64_t t = 0; t < patches->triangles; t++) {
        uint32_t *const c = index + 3 * t;
        bvxi_view_triangle(view, t, c);
        if (!patches->turn[t]) continue;
        uint32_t const second = c[1];
        c[1] = c[2];
        c[2] = second;
    }

    *turned = *view;
    turned->indices = index;
    turned->index_type = BVX_U32;
    turned->index_stride = 0;
}
