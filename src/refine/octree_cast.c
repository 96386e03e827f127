/* octree_cast.c - the first leaf on each of many rays: bvx_octree_cast.
 *
 * Along each axis a ray has u = (origin - lattice origin) / spacing and step = direction / spacing in voxels
 * of the last level, and crosses plane i at t(i) = (i - u) * (1 / step), in doubles, as in cast.c. A leaf's
 * closed box is met from the greatest t of its entering planes to the least of its leaving ones; an axis
 * without motion is met where u lies between the planes. Octets are entered where the ray meets their boxes,
 * nearer children first, so what lies behind the best hit is passed over; the hit is the leaf with the least
 * (t, z, y, x) by these numbers, as if all had been asked. */
#include "refine/room.h"

typedef struct octree_ray {
    const bvx_octree *tree;
    double u[3], per[3]; /* per: 1 / step */
    double end;          /* no hit behind this t; that of the best one so far */
    double t;
    int32_t way[3]; /* -1, 0, 1 */
    int32_t states, found, axis;
    int32_t low[3]; /* low corner of the best leaf [Units: voxels of the last level] */
    bvx_octree_leaf leaf;
} octree_ray;

/* Is the box of a voxel met, from when on, and through which axis? */
static int ray_meets_box(const octree_ray *r, const int32_t v[3], int32_t level, double *from, int32_t *axis)
{
    int32_t const up = r->tree->levels - level;
    double enter = 0.0, leave = r->end;

    *axis = -1;
    for (int32_t a = 0; a < 3; a++) {
        double const low = (double)(v[a] << up), high = (double)((v[a] + 1) << up);

        /* Without motion the planes are never crossed: between them, or not at all. */
        if (r->way[a] == 0) {
            if (r->u[a] < low || r->u[a] > high) return 0;
            continue;
        }

        double const first = ((r->way[a] > 0 ? low : high) - r->u[a]) * r->per[a];
        double const last = ((r->way[a] > 0 ? high : low) - r->u[a]) * r->per[a];
        if (first > enter) {
            enter = first;
            *axis = a;
        }
        if (last < leave) leave = last;
    }

    /* Closed boxes: a ray through an edge meets what lies around it. */
    *from = enter;
    return enter <= leave;
}

/* The voxel at a bit of a level's masks, or of the base's. */
static void cast_into_voxel(octree_ray *r, const bvxi_octets *o, uint64_t bit, const int32_t v[3],
                            int32_t level)
{
    uint32_t const turn = (uint32_t)(r->way[0] < 0) | (uint32_t)(r->way[1] < 0) << 1 |
                          (uint32_t)(r->way[2] < 0) << 2;
    int const split = bvxi_octets_is_split(o, bit) != 0;
    int32_t const state = bvxi_octets_state(o, bit);
    double t;
    int32_t axis;

    /* A leaf in a state that was not requested is passed over before its box is computed. */
    if ((!split && (state & r->states) == 0) || !ray_meets_box(r, v, level, &t, &axis)) return;
    if (!split) {
        int32_t const up = r->tree->levels - level;
        int32_t const low[3] = {v[0] << up, v[1] << up, v[2] << up};

        /* Of leaves met at one t the least (z, y, x), whatever the order of asking. */
        if (r->found && t == r->t &&
            (low[2] > r->low[2] ||
             (low[2] == r->low[2] && (low[1] > r->low[1] || (low[1] == r->low[1] && low[0] > r->low[0])))))
            return;
        r->found = 1;
        r->t = r->end = t;
        r->axis = axis;
        memcpy(r->low, low, sizeof r->low);
        r->leaf = bvxi_octree_leaf_at(v, level, state);
        return;
    }
    uint64_t const octet = bvxi_octets_rank(o, bit);
    for (uint32_t n = 0; n < 8; n++) {
        /* Numbers of children have a bit an axis, so the turned axes flip them into the ray's order. */
        uint32_t const p = n ^ turn; /* nearer ones first */
        int32_t child[3];
        bvxi_child_voxel(v, p, child);
        cast_into_voxel(r, &r->tree->octets[level], 8 * octet + p, child, level + 1);
    }
}

/* Base voxels from first to last of an axis, in the ray's order. */
static inline int32_t in_ray_order(const octree_ray *r, int a, int32_t n)
{
    return r->way[a] < 0 ? r->tree->base[a] - 1 - n : n;
}

static void cast_octree_ray(octree_ray *r)
{
    const bvx_octree *const tree = r->tree;

    for (int32_t k = 0; k < tree->base[2]; k++)
        for (int32_t j = 0; j < tree->base[1]; j++) {
            int32_t const y = in_ray_order(r, 1, j), z = in_ray_order(r, 2, k);

            /* The row's box: as if the ray stood still in x, in the middle of the row, so that x never excludes. */
            octree_ray flat = *r;
            double t;
            int32_t axis;
            flat.way[0] = 0;
            flat.u[0] = 0.0;
            if (!ray_meets_box(&flat, (const int32_t[3]){0, y, z}, 0, &t, &axis)) continue;
            for (int32_t i = 0; i < tree->base[0]; i++) {
                int32_t const v[3] = {in_ray_order(r, 0, i), y, z};
                cast_into_voxel(r, &tree->root, bvxi_root_bit(tree, v[0], y, z), v, 0);
            }
        }
}

typedef struct octree_cast {
    const bvx_octree *tree;
    const double *rays;
    bvx_octree_hit *hits;
    double t_max;
    int32_t states;
} octree_cast;

static void cast_octree_piece(void *user, uint64_t begin, uint64_t end)
{
    const octree_cast *const job = user;

    for (uint64_t i = begin; i < end; i++) {
        const double *const ray = job->rays + 6 * i;
        octree_ray r = {0};
        int usable = 1;
        r.tree = job->tree;

        r.end = job->t_max;
        r.states = job->states;
        for (int a = 0; a < 3; a++) {
            double const step = ray[3 + a] / job->tree->lattice.spacing[a];
            r.u[a] = (ray[a] - job->tree->lattice.origin[a]) / job->tree->lattice.spacing[a];
            r.way[a] = (step > 0) - (step < 0);
            r.per[a] = r.way[a] != 0 ? 1.0 / step : 0.0;

            /* A direction so small that 1 / step overflows crosses no plane that can be computed. */
            usable &= r.u[a] - r.u[a] == 0.0 && r.per[a] - r.per[a] == 0.0;
        }
        if (usable) cast_octree_ray(&r);

        memset(&job->hits[i], 0, sizeof job->hits[i]);
        if (!r.found) continue;
        job->hits[i].t = r.t;
        for (int a = 0; a < 3; a++) job->hits[i].position[a] = ray[a] + r.t * ray[3 + a];
        job->hits[i].leaf = r.leaf;
        job->hits[i].axis = r.axis;
        job->hits[i].hit = 1;
    }
}

static bvx_status run_octree_cast(bvx_context *context, const bvx_octree *tree, int32_t states,
                                  const double *rays, uint64_t count, double t_max, bvx_octree_hit *hits)
{
    static const char *const function = "bvx_octree_cast";
    octree_cast job = {.tree = tree, .rays = rays, .hits = hits, .t_max = t_max};
    BVXI_TRY(bvxi_octree_check(context, function, tree));
    BVXI_TRY(bvxi_octree_check_states(context, function, states));
    if (hits == NULL && count != 0) return bvxi_fail_null(context, function, "hits");
    BVXI_TRY(bvxi_check_rays(context, function, rays, count, t_max, sizeof *hits));
    job.states = states != 0 ? states : BVX_STATE_SURFACE | BVX_STATE_INSIDE;
    return bvxi_for(context, "octree", count, 64, cast_octree_piece, &job);
}

bvx_status bvx_octree_cast(bvx_context *context, const bvx_octree *tree, int32_t states, const double *rays,
                           uint64_t count, double t_max, bvx_octree_hit *hits)
{
    return BVXI_CALL(context, run_octree_cast(context, tree, states, rays, count, t_max, hits));
}
