/* patch_sides.c - whole patches of an open mesh that face inward beside others that face outward.
 *
 * Inside a patch, triangles agree by their common edges; two patches with a gap between them have none. What
 * a patch encloses with a cone over its border says which way it faces, and rays say whether that is right:
 * of a ray's crossings every other one enters, whichever way triangles face. Where the directions of all
 * crossings of a ray fit together, depth above 0 throughout and 0 in the end, they are right as they are;
 * else the crossings that parity contradicts speak for turning their patch, and the others for keeping
 * theirs.
 *
 * Source: after Takayama, Jacobson, Kavan, Sorkine-Hornung. A Simple Method for Correcting Facet Orientations
 * in Polygon Meshes Based on Ray Casting. 2014 (parity of rays from patches); rays of a lattice, and the
 * guards, are ours.
 * Guarantee: what is turned does not depend on the order of triangles but where sums in their order decide.
 * An edge of two triangles is crossed once, as its sides are told by its corners in one order. */
#include "mesh/facet.h"
#include "mesh/topology.h"
#include "mesh/view.h"

enum {
    SIDE_RAYS = 32, /* along each side of the mesh's box */
    RAYS = SIDE_RAYS * SIDE_RAYS,
    MOST_CROSSINGS = 32, /* of a ray that is judged; one through more says nothing */
    MOST_PATCHES = 4096, /* of a mesh that is judged: of a soup each triangle is a patch */
    LEAST_VOTES = 12,    /* crossings that a patch is turned by, at least */
    LEAST_BESIDE = 4     /* of them on rays that cross another patch, one that faces as it should */
};

/* Where rays lie between two of their steps: beside the middle, where meshes like to have edges. */
static double const ray_shift[2] = {0.41421356, 0.55278640};

/* A patch is no shell where its triangles face nearly one way: the share of its area that it has seen from
 * there. Such a sheet has two sides that are equal, and one above the other is no body. */
#define MOST_FLAT 0.9

typedef struct patch_side {
    double volume6, area2, face2[3]; /* of its triangles, about the centre */
    double border, middle[3];        /* length of its border, and sums of places on it by length */
    uint32_t turn, keep, beside; /* crossings that speak for it; of turn those beside a patch that is right */
    uint32_t inward;             /* 1: with a cone over its border it encloses a negative volume */
} patch_side;

typedef struct side_crossing {
    double at;
    uint32_t patch;
    int32_t step; /* 1: the ray enters, -1: it leaves */
} side_crossing;

typedef struct side_rays {
    const bvxi_patch_sides *in;
    patch_side *sides;
    double low[3], spacing[3]; /* of the mesh's box, and between rays */
    side_crossing *crossing;   /* of one axis, ray by ray */
    uint32_t *begin, *used;    /* of each ray: where its crossings begin, and how many are listed */
} side_rays;

/* ---- Which patches face inward ---- */

static void side_corners(const bvxi_patch_sides *in, uint64_t t, double p[3][3])
{
    for (int k = 0; k < 3; k++) bvxi_view_position(in->view, in->corner[3 * t + (uint64_t)k], p[k]);
}

/* Returns 1 where some face inward, and some outward. */
static int find_inward_sides(patch_side *sides, uint64_t count)
{
    uint64_t inward = 0, outward = 0;
    for (uint64_t n = 0; n < count; n++) {
        patch_side *const s = &sides[n];
        double volume = s->volume6;
        /* From the centre to the border's middle: the volume changes by what the patch shows there. */
        for (int a = 0; a < 3 && s->border > 0; a++) volume -= s->middle[a] / s->border * s->face2[a];
        int const flat = !(bvxi_vec_length(s->face2) < MOST_FLAT * s->area2);
        s->inward = volume < 0 && !flat;
        inward += s->inward;
        outward += volume > 0 && !flat;
    }
    return inward != 0 && outward != 0;
}

/* ---- Rays ---- */

/* Rays between two places along one of the two axes across them. */
static void rays_between(const side_rays *r, int axis, double shift, double from, double to, int32_t range[2])
{
    double const low = (from - r->low[axis]) / r->spacing[axis] - shift;
    double const high = (to - r->low[axis]) / r->spacing[axis] - shift;
    /* A box too large for a double has no places: what is no number compares with nothing, and meets no ray. */
    range[0] = !(low >= 0) ? 0 : low > SIDE_RAYS ? SIDE_RAYS : (int32_t)floor(low);
    range[1] = !(high >= 0) ? -1 : high > SIDE_RAYS - 1 ? SIDE_RAYS - 1 : (int32_t)floor(high);
}

/* Of the rays of a row at y, those that a triangle can reach: between its edges, and one beside for rounding.
 * Of a long thin one across the box that is few of them. */
static void rays_of_row(const side_rays *r, const double p[3][3], int u, int v, double y, int32_t range[2])
{
    double low = 0, high = 0;
    int32_t between[2];
    int found = 0;

    for (int k = 0; k < 3; k++) {
        const double *const a = p[k], *const b = p[(k + 1) % 3];
        double const share = (y - a[v]) / (b[v] - a[v]), x = a[u] + share * (b[u] - a[u]);
        if (!(share >= 0 && share <= 1)) continue;
        if (!found || x < low) low = x;
        if (!found || x > high) high = x;
        found = 1;
    }
    if (!found) return;
    rays_between(r, u, ray_shift[0], low, high, between);
    if (range[0] < between[0] - 1) range[0] = between[0] - 1;
    if (range[1] > between[1] + 1) range[1] = between[1] + 1;
}

/* Does a ray at (x, y) meet the triangle? *at: where. Returns 1 where it enters, -1 where it leaves, or 0. */
static int32_t meet_triangle(const uint32_t c[3], const double p[3][3], const int axis[3], double x, double y,
                             double *at)
{
    int const u = axis[1], v = axis[2];
    double weight[3], sum;
    int left[3];

    for (int k = 0; k < 3; k++) {
        int const m = (k + 1) % 3, swap = c[k] > c[m];
        /* From its lower corner, so that both triangles of an edge have the same number for it. */
        const double *const a = p[swap ? m : k], *const b = p[swap ? k : m];
        double const e = (b[u] - a[u]) * (y - a[v]) - (b[v] - a[v]) * (x - a[u]);
        left[k] = (e > 0) != swap;
        weight[(k + 2) % 3] = swap ? -e : e;
    }
    sum = weight[0] + weight[1] + weight[2];
    if (left[0] != left[1] || left[1] != left[2] || sum == 0) return 0;

    *at = 0;
    for (int k = 0; k < 3; k++) *at += weight[k] / sum * p[k][axis[0]];
    /* Counterclockwise seen from where the ray goes: it leaves. */
    return left[0] ? -1 : 1;
}

/* Count the crossings of one axis or list them, of a ray that says nothing only so many that it shows. */
static void cross_rays(side_rays *r, const int axis[3], int list)
{
    int const u = axis[1], v = axis[2];

    for (uint64_t t = 0; t < r->in->triangles; t++) {
        const uint32_t *const c = r->in->corner + 3 * t;
        double p[3][3], low[3], high[3];
        int32_t i[2], j[2];

        side_corners(r->in, t, p);
        memcpy(low, p[0], sizeof low);
        memcpy(high, p[0], sizeof high);
        for (int k = 1; k < 3; k++) bvxi_widen(low, high, p[k], 3);
        rays_between(r, u, ray_shift[0], low[u], high[u], i);
        rays_between(r, v, ray_shift[1], low[v], high[v], j);

        for (int32_t y = j[0]; y <= j[1]; y++) {
            double const py = r->low[v] + (y + ray_shift[1]) * r->spacing[v];
            int32_t row[2] = {i[0], i[1]};

            rays_of_row(r, (const double(*)[3])p, u, v, py, row);
            for (int32_t x = row[0]; x <= row[1]; x++) {
                uint64_t const ray = (uint64_t)y * SIDE_RAYS + (uint64_t)x;
                double const px = r->low[u] + (x + ray_shift[0]) * r->spacing[u];
                side_crossing s = {0, r->in->patch[t], 0};
                if (r->used[ray] > MOST_CROSSINGS) continue;
                s.step = meet_triangle(c, (const double(*)[3])p, axis, px, py, &s.at);
                if (s.step == 0) continue;
                if (r->in->turn[t]) s.step = -s.step;
                if (list) r->crossing[r->begin[ray] + r->used[ray]] = s;
                r->used[ray]++;
            }
        }
    }
}

static int crosses_before(const side_crossing *a, const side_crossing *b)
{
    /* Crossings at one position are ordered by what they are, not by when they came. */
    if (a->at != b->at) return a->at < b->at;
    if (a->step != b->step) return a->step < b->step;
    return a->patch < b->patch;
}

/* 1: the crossings fit together as they are (way: 1), or with each turned (-1). */
static int depths_fit(const side_crossing *c, uint64_t n, int32_t way)
{
    int32_t depth = 0;
    for (uint64_t i = 0; i < n; i++) {
        depth += way * c[i].step;
        if (depth < 0) return 0;
    }
    return depth == 0;
}

static int is_as_parity_has_it(const side_crossing *c, uint64_t i)
{
    return (c[i].step > 0) == (i % 2 == 0);
}

/* 1: the ray crosses another patch as parity has it. */
static int is_beside_a_right_one(const side_crossing *c, uint64_t n, uint64_t i)
{
    for (uint64_t k = 0; k < n; k++)
        if (c[k].patch != c[i].patch && is_as_parity_has_it(c, k)) return 1;
    return 0;
}

static void judge_ray(side_crossing *c, uint64_t n, int chance, patch_side *sides)
{
    /* An odd number of crossings: the ray went through a hole, or along a sheet. */
    if (n == 0 || n % 2 != 0 || n > MOST_CROSSINGS) return;
    for (uint64_t i = 1; i < n; i++) {
        side_crossing const one = c[i];
        uint64_t k = i;
        for (; k > 0 && crosses_before(&one, &c[k - 1]); k--) c[k] = c[k - 1];
        c[k] = one;
    }
    int const fit = !chance && depths_fit(c, n, 1);
    /* Patches that overlap and all face inward: none of them is right. */
    int const inward = !chance && depths_fit(c, n, -1);

    for (uint64_t i = 0; i < n; i++) {
        patch_side *const s = &sides[c[i].patch];
        if (fit || (!inward && is_as_parity_has_it(c, i))) {
            s->keep++;
            continue;
        }
        s->turn++;
        s->beside += (uint32_t)(!inward && is_beside_a_right_one(c, n, i));
    }
}

static bvx_status judge_axis(bvx_context *ctx, side_rays *r, int axis)
{
    int const axes[3] = {axis, (axis + 1) % 3, (axis + 2) % 3};
    uint32_t count = 0;

    /* Seen edge-on there are no rays. */
    if (!(r->spacing[axes[1]] > 0 && r->spacing[axes[2]] > 0)) return BVX_OK;
    memset(r->used, 0, RAYS * sizeof *r->used);
    cross_rays(r, axes, 0);
    for (uint32_t n = 0; n < RAYS; n++) {
        r->begin[n] = count;
        count += r->used[n];
    }

    BVXI_TRY(BVXI_ARRAY(ctx, count, "the patches' crossings", r->crossing));
    memset(r->used, 0, RAYS * sizeof *r->used);
    cross_rays(r, axes, 1);
    for (uint32_t n = 0; n < RAYS; n++)
        judge_ray(r->crossing + r->begin[n], r->used[n], r->in->chance, r->sides);
    return BVX_OK;
}

static bvx_status judge_rays(bvx_context *ctx, const bvxi_patch_sides *in, patch_side *sides)
{
    side_rays r = {.in = in, .sides = sides};
    double high[3] = {0, 0, 0}, p[3][3];

    for (uint64_t t = 0; t < in->triangles; t++) {
        side_corners(in, t, p);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) {
                if ((t == 0 && k == 0) || p[k][a] < r.low[a]) r.low[a] = p[k][a];
                if ((t == 0 && k == 0) || p[k][a] > high[a]) high[a] = p[k][a];
            }
    }
    for (int a = 0; a < 3; a++) r.spacing[a] = (high[a] - r.low[a]) / SIDE_RAYS;

    BVXI_TRY(BVXI_ARRAY(ctx, 2 * RAYS, "the patches' rays", r.begin));
    r.used = r.begin + RAYS;
    for (int axis = 0; axis < 3; axis++) BVXI_TRY(BVXI_SCOPE(ctx, judge_axis(ctx, &r, axis)));
    return BVX_OK;
}

/* ---- The whole ---- */

bvx_status bvxi_patch_sides_turn(bvx_context *ctx, const bvxi_patch_sides *in)
{
    patch_side *sides;
    if (in->patches < 2 || in->patches > MOST_PATCHES) return BVX_OK;
    BVXI_TRY(BVXI_ZEROS(ctx, in->patches, "the patches' sides", sides));
    for (uint64_t t = 0; t < in->triangles; t++) {
        patch_side *const s = &sides[in->patch[t]];
        double const sign = in->turn[t] ? -1 : 1;
        double p[3][3], n[3];

        side_corners(in, t, p);
        bvxi_facet_cross((const double(*)[3])p, n);
        for (int a = 0; a < 3; a++) p[0][a] -= in->centre[a];
        s->volume6 += sign * bvxi_vec_dot(p[0], n);
        s->area2 += bvxi_vec_length(n);
        for (int a = 0; a < 3; a++) s->face2[a] += sign * n[a];
    }

    for (uint64_t i = 0; i < in->border_count; i++) {
        uint64_t const half = in->border[i], t = half / 3, k = half % 3;
        patch_side *const s = &sides[in->patch[t]];
        double p[3][3], length;
        side_corners(in, t, p);
        length = sqrt(bvxi_vec_distance2(p[k], p[(k + 1) % 3]));
        s->border += length;
        for (int a = 0; a < 3; a++)
            s->middle[a] += length * (0.5 * p[k][a] + 0.5 * p[(k + 1) % 3][a] - in->centre[a]);
    }

    /* Of most meshes no patch faces inward, or all do, and no ray is needed. */
    if (!find_inward_sides(sides, in->patches) && !in->chance) return BVX_OK;
    BVXI_TRY(judge_rays(ctx, in, sides));
    for (uint64_t t = 0; t < in->triangles; t++) {
        const patch_side *const s = &sides[in->patch[t]];
        int const by_chance = 2 * s->turn >= 3 * s->keep && (s->inward || s->turn >= LEAST_VOTES);
        /* Faces inward, and three of five crossings say that this is wrong (of a body that overlaps another one half
         * of them cannot), some of them beside what is right: where all patches face inward they mean a room, whose
         * inside is filled as it is. A closed one is judged by its volume, where the rule for inside is chosen. */
        int const wrong = s->border > 0 && s->inward && s->turn >= LEAST_VOTES &&
                          2 * s->turn >= 3 * s->keep && s->beside >= LEAST_BESIDE &&
                          16 * s->beside >= s->turn;
        /* By chance any patch may face either way, and parity alone decides. */
        if (in->chance ? by_chance : wrong) in->turn[t] ^= 1;
    }
    return BVX_OK;
}
