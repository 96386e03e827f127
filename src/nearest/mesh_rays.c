/* mesh_rays.c - where rays meet a mesh, and how often a mesh goes around points.
 *
 * A ray is the line through two points of doubles: its origin, and one as far off as the mesh along its direction.
 * On which side of the line an edge passes is the sign of one determinant, exact (mesh/orient.h). Where it is 0 both
 * points are thought of as moved by (e_x, e_y, e_z), e_x >> e_y >> e_z > 0: the tie rule of all stages. So of the
 * triangles around an edge or a corner that lie side by side a ray meets exactly one, and between them it passes
 * nowhere. What lies on the line as a whole is not met.
 *
 * Guarantee: which triangles are met follows from mesh and ray alone. The winding number is exact: along x the second
 * point is a multiple of a unit vector, and no direction is rounded. The t of a hit is one evaluation in doubles, kept
 * within the triangle's own corners. */
#include "bits/bits.h"
#include "core/simd.h"
#include "core/vec3.h"
#include "grid/grid.h"
#include "grid/sparse.h"
#include "mesh/orient.h"
#include "mesh/view.h"
#include "nearest/closest.h"

#include <math.h>

enum {
    RAY_GRAIN = 16, /* least rays a piece */
    RAY_STACK = 3 * BVXI_CLOSEST_LEVELS + BVXI_CLOSEST_WIDTH
};
/* Further away an origin has no digits left for the mesh [Units: the mesh's size]. */
#define RAY_FARTHEST 0x1p200

typedef struct mesh_ray {
    const bvxi_closest_tree *tree;
    double o[3], q[3];     /* two points of the line [Units: world times scale] */
    double d[3], d2;       /* q - o, and its square */
    double unit;           /* t of the caller at q */
    double at[3], over[3]; /* the origin, and 1 over the way, in box units; 0: the way has no such part */
    double margin;         /* above all rounding [Units: box] */
} mesh_ray;

/* What a walk over the tree is for. */
typedef struct ray_visit {
    mesh_ray line;
    double limit;       /* boxes that begin beyond it do not matter [Units: q - o] */
    double t_max;       /* [Units: as the caller has it] */
    bvx_mesh_hit *hits; /* the nearest one, or all in order; NULL: only counted */
    uint64_t count;     /* of hits */
    int nearest;        /* 1: of all hits the nearest one is kept */
    int64_t turns;
} ray_visit;

/* ---- Rays ---- */

static double largest_part(const double v[3])
{
    double most = 0.0;
    for (int a = 0; a < 3; a++) most = bvxi_absolute(v[a]) > most ? bvxi_absolute(v[a]) : most;
    return most;
}

/* 0: the origin is too far off. */
static int open_ray(const bvxi_closest_tree *tree, const double *ray, mesh_ray *r)
{
    const double *const direction = ray + 3;
    double const own = bvxi_unit_scale(direction, direction);
    double reach, away = 1.0;

    r->tree = tree;
    for (int a = 0; a < 3; a++) r->o[a] = ray[a] * tree->scale;
    if (!(largest_part(r->o) <= RAY_FARTHEST)) return 0;
    while (away < largest_part(r->o)) away *= 2.0;

    /* A power of two, so that no digit of the direction changes. */
    away *= 2.0;
    for (int a = 0; a < 3; a++) r->q[a] = r->o[a] + direction[a] * own * away;
    r->unit = own * away / tree->scale;
    for (int a = 0; a < 3; a++) {
        r->d[a] = r->q[a] - r->o[a];
        r->at[a] = (r->o[a] - tree->centre[a]) * tree->box_scale;
        r->over[a] = r->d[a] != 0.0 ? 1.0 / (r->d[a] * tree->box_scale) : 0.0;
    }
    r->d2 = bvxi_vec_dot(r->d, r->d);
    reach = largest_part(r->at);
    r->margin = (1.0 + reach) * 0x1p-40;
    return 1;
}

/* ---- One triangle ---- */

/* On which side of the line the edge from a to b passes: 1, -1, or 0 where both ends lie on it or beyond. */
static int edge_side(const mesh_ray *r, const double a[3], const double b[3])
{
    int const side = bvxi_orient(r->q, a, b, r->o);
    if (BVXI_LIKELY(side != 0)) return side;
    for (int axis = 0; axis < 3; axis++) {
        int const at_a = bvxi_orient_flat(r->o, r->q, a, axis), at_b = bvxi_orient_flat(r->o, r->q, b, axis);
        if (at_a != at_b) return at_b > at_a ? 1 : -1;
        if (at_a != 0) return 0;
    }
    return 0;
}

static void way_between(const double from[3], const double to[3], double way[3])
{
    for (int a = 0; a < 3; a++) way[a] = to[a] - from[a];
}

/* Where the line meets a triangle that it does meet, between its corners whatever rounding did. */
static double ray_meets_at(const mesh_ray *r, const double t[3][3])
{
    double n[3], o[3], at, low = HUGE_VAL, high = -HUGE_VAL;

    for (int k = 0; k < 3; k++) {
        double along = 0.0;
        for (int a = 0; a < 3; a++) along += (t[k][a] - r->o[a]) * r->d[a];
        along /= r->d2;
        low = along < low ? along : low;
        high = along > high ? along : high;
    }
    way_between(r->o, t[0], o);
    bvxi_area_normal(t[0], t[1], t[2], n);
    at = bvxi_vec_dot(n, o) / bvxi_vec_dot(n, r->d);
    return at >= low ? (at <= high ? at : high) : low;
}

static int hit_before(const bvx_mesh_hit *a, const bvx_mesh_hit *b)
{
    return a->t < b->t || (a->t == b->t && a->triangle < b->triangle);
}

static void take_hit(ray_visit *w, const bvx_mesh_hit *hit)
{
    uint64_t i = w->count;
    if (!w->nearest) {
        w->count++;
        if (w->hits == NULL) return;
        for (; i > 0 && hit_before(hit, &w->hits[i - 1]); i--) w->hits[i] = w->hits[i - 1];
        w->hits[i] = *hit;
    } else if (i == 0 || hit_before(hit, w->hits)) {
        w->count = 1;
        *w->hits = *hit;
        if (hit->t / w->line.unit < HUGE_VAL) w->limit = hit->t / w->line.unit * (1.0 + 0x1p-40);
    }
}

static void ray_meets_triangle(ray_visit *w, uint64_t place, int winding)
{
    const mesh_ray *const r = &w->line;
    double t[3][3];
    double at = 0.0;
    bvx_mesh_hit hit;

    bvxi_closest_corners(r->tree, place, t);
    int const side = edge_side(r, t[0], t[1]);
    if (side == 0 || edge_side(r, t[1], t[2]) != side || edge_side(r, t[2], t[0]) != side) return;

    /* What lies ahead of a ray that leaves has the origin behind it. */
    int origin = bvxi_orient(t[0], t[1], t[2], r->o);
    for (int axis = 0; axis < 3 && origin == 0 && winding; axis++)
        origin = -bvxi_orient_flat(t[0], t[1], t[2], axis);
    if (origin == -side) return;
    if (winding) {
        w->turns += side;
        return;
    }
    memset(&hit, 0, sizeof hit);
    if (origin != 0) at = ray_meets_at(r, (const double(*)[3])t);
    if (at > 0.0) hit.t = at * r->unit;
    else at = 0.0;
    if (hit.t > w->t_max) return;
    hit.side = -side;
    hit.triangle = r->tree->order[place];

    /* Shares of the corners: the areas that the line cuts off. */
    double from[3][3], n[3], sum = 0.0;
    for (int k = 0; k < 3; k++) way_between(r->o, t[k], from[k]);
    for (int k = 0; k < 3; k++) {
        bvxi_vec_cross(from[(k + 1) % 3], from[(k + 2) % 3], n);
        hit.weight[k] = bvxi_absolute(bvxi_vec_dot(n, r->d));
        sum += hit.weight[k];
    }
    for (int k = 0; k < 3; k++) hit.weight[k] = sum > 0.0 ? hit.weight[k] / sum : 1.0 / 3.0;
    for (int a = 0; a < 3; a++) hit.position[a] = (r->o[a] + at * r->d[a]) / r->tree->scale;
    take_hit(w, &hit);
}

/* ---- The tree ---- */

#define BVXI_SIMD_LEVEL _base
#include "nearest/ray_boxes_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/ray_boxes_body.h"
#undef BVXI_SIMD_LEVEL
#endif

typedef struct ray_step {
    double enter;
    int32_t level; /* of the node */
    uint32_t node;
} ray_step;

/* Depth first, boxes that are entered earlier first. */
static void walk_ray(ray_visit *w, int winding)
{
    const bvxi_closest_tree *const tree = w->line.tree;
    ray_step stack[RAY_STACK];
    int used = 1;

    stack[0].enter = 0.0;
    stack[0].level = tree->level_count - 1;
    stack[0].node = 0;
    while (used > 0) {
        ray_step const s = stack[--used];
        uint64_t const first = (uint64_t)s.node * BVXI_CLOSEST_WIDTH;
        uint64_t const total = s.level == 0 ? tree->triangle_count : tree->level_nodes[s.level - 1];
        int const children = bvxi_closest_children(total, first), bottom = used;
        const bvxi_closest_node *const node = &tree->nodes[tree->level_first[s.level] + s.node];
        double enter[BVXI_CLOSEST_WIDTH];
        uint32_t bits;

        if (s.enter > w->limit) continue;
        bits = BVXI_PATH(tree->fast, meet_boxes_base(w, node, enter), meet_boxes_avx2(w, node, enter));
        for (bits &= (1u << children) - 1; bits != 0; bits &= bits - 1) {
            int const k = bvxi_lowest(bits);
            int i = used;
            if (s.level == 0) {
                ray_meets_triangle(w, first + (uint64_t)k, winding);
                continue;
            }
            for (used++; i > bottom && stack[i - 1].enter < enter[k]; i--) stack[i] = stack[i - 1];
            stack[i].enter = enter[k];
            stack[i].level = s.level - 1;
            stack[i].node = (uint32_t)first + (uint32_t)k;
        }
    }
}

/* ---- Many rays ---- */

typedef struct ray_work {
    const bvx_closest *closest;
    const double *rays; /* or points */
    double t_max;
    bvx_mesh_hit *hits;
    uint64_t *offsets; /* NULL: the nearest hit of each */
    int64_t *turns;
} ray_work;

static void cast_mesh_ray(const bvxi_closest_tree *tree, const double *ray, ray_visit *w)
{
    (void)open_ray(tree, ray, &w->line);
    w->limit = w->t_max / w->line.unit < HUGE_VAL ? w->t_max / w->line.unit * (1.0 + 0x1p-40) : HUGE_VAL;
    walk_ray(w, 0);
}

static void cast_mesh_rays(void *user, uint64_t begin, uint64_t end)
{
    const ray_work *const work = user;
    for (uint64_t i = begin; i < end; i++) {
        ray_visit w = {.t_max = work->t_max, .nearest = work->offsets == NULL};
        if (w.nearest) memset(&work->hits[i], 0, sizeof work->hits[i]);
        if (work->hits != NULL) w.hits = work->hits + (w.nearest ? i : work->offsets[i]);
        cast_mesh_ray(&work->closest->tree, work->rays + 6 * i, &w);
        if (work->offsets != NULL && work->hits == NULL) work->offsets[i + 1] = w.count;
    }
}

static void wind_points(void *user, uint64_t begin, uint64_t end)
{
    const ray_work *const work = user;
    for (uint64_t i = begin; i < end; i++) {
        const double *const p = work->rays + 3 * i;
        double const ray[6] = {p[0], p[1], p[2], 1.0, 0.0, 0.0};
        ray_visit w = {.limit = HUGE_VAL};
        /* What is beyond that is beyond the mesh. */
        if (open_ray(&work->closest->tree, ray, &w.line)) walk_ray(&w, 1);
        work->turns[i] = w.turns;
    }
}

static bvx_status check_mesh_rays(bvx_context *ctx, const char *function, const bvx_closest *closest,
                                  const double *rays, uint64_t count, double t_max)
{
    mesh_ray r;
    if (closest == NULL) return bvxi_fail_null(ctx, function, "closest");
    BVXI_TRY(bvxi_check_rays(ctx, function, rays, count, t_max, sizeof(bvx_mesh_hit)));
    for (uint64_t i = 0; i < count; i++)
        if (!open_ray(&closest->tree, rays + 6 * i, &r))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_RANGE,
                                 "%s: ray %i starts 2^200 times the mesh's size away from the origin",
                                 function, i);
    return BVX_OK;
}

static bvx_status run_closest_cast(bvx_context *context, const bvx_closest *closest, const double *rays,
                                   uint64_t count, double t_max, bvx_mesh_hit *hits)
{
    static const char *const function = "bvx_closest_cast";
    ray_work w = {.closest = closest, .rays = rays, .t_max = t_max, .hits = hits};
    BVXI_TRY(check_mesh_rays(context, function, closest, rays, count, t_max));
    if (hits == NULL && count != 0) return bvxi_fail_null(context, function, "hits");
    return bvxi_for(context, "rays", count, RAY_GRAIN, cast_mesh_rays, &w);
}

bvx_status bvx_closest_cast(bvx_context *context, const bvx_closest *closest, const double *rays,
                            uint64_t count, double t_max, bvx_mesh_hit *hits)
{
    return BVXI_CALL(context, run_closest_cast(context, closest, rays, count, t_max, hits));
}

static bvx_status run_closest_crossings(bvx_context *context, const bvx_closest *closest, const double *rays,
                                        uint64_t count, double t_max, uint64_t *offsets, bvx_mesh_hit *hits,
                                        uint64_t capacity)
{
    static const char *const function = "bvx_closest_crossings";
    ray_work w = {.closest = closest, .rays = rays, .t_max = t_max, .offsets = offsets};

    BVXI_TRY(check_mesh_rays(context, function, closest, rays, count, t_max));
    if (offsets == NULL) return bvxi_fail_null(context, function, "offsets");
    offsets[0] = 0;
    BVXI_TRY(BVXI_SHARE(context, 0.0, hits == NULL ? 1.0 : 0.5,
                        bvxi_for(context, "rays", count, RAY_GRAIN, cast_mesh_rays, &w)));
    for (uint64_t i = 0; i < count; i++) offsets[i + 1] += offsets[i];
    if (hits == NULL) return BVX_OK;
    if (offsets[count] > capacity)
        return bvxi_fail_for(context, BVX_ERR_CAPACITY, BVX_REASON_TOO_MANY, "%s: %u hits, and room for %u",
                             function, offsets[count], capacity);
    w.hits = hits;
    return BVXI_SHARE(context, 0.5, 1.0, bvxi_for(context, "rays", count, RAY_GRAIN, cast_mesh_rays, &w));
}

bvx_status bvx_closest_crossings(bvx_context *context, const bvx_closest *closest, const double *rays,
                                 uint64_t count, double t_max, uint64_t *offsets, bvx_mesh_hit *hits,
                                 uint64_t capacity)
{
    return BVXI_CALL(context,
                     run_closest_crossings(context, closest, rays, count, t_max, offsets, hits, capacity));
}

static bvx_status run_closest_winding(bvx_context *context, const bvx_closest *closest, const double *points,
                                      uint64_t count, int64_t *turns)
{
    static const char *const function = "bvx_closest_winding";
    ray_work w = {.closest = closest, .rays = points, .turns = turns};
    if (closest == NULL) return bvxi_fail_null(context, function, "closest");
    if (turns == NULL && count != 0) return bvxi_fail_null(context, function, "turns");
    BVXI_TRY(bvxi_check_points(context, function, points, count, 3 * sizeof *points));
    return bvxi_for(context, "winding numbers", count, RAY_GRAIN, wind_points, &w);
}

bvx_status bvx_closest_winding(bvx_context *context, const bvx_closest *closest, const double *points,
                               uint64_t count, int64_t *turns)
{
    return BVXI_CALL(context, run_closest_winding(context, closest, points, count, turns));
}

/* ---- From voxels to their neighbours ---- */

typedef struct mesh_links {
    const bvx_closest *closest;
    const bvx_grid *grid;
    uint64_t *first; /* number of each row's first set voxel [Size: rows + 1] */
    int32_t links;
    float *values;
} mesh_links;

static void link_start(const bvx_grid *g, uint64_t row, int32_t x, double at[3])
{
    int32_t const voxel[3] = {x, (int32_t)(row % (uint64_t)g->size[1]),
                              (int32_t)(row / (uint64_t)g->size[1])};
    for (int a = 0; a < 3; a++)
        at[a] = g->lattice.origin[a] + ((double)(g->low[a] + voxel[a]) + 0.5) * g->lattice.spacing[a];
}

static void cast_link_rows(void *user, uint64_t begin, uint64_t end)
{
    const mesh_links *const work = user;
    const bvx_grid *const g = work->grid;
    /* Squares of the ways' lengths: to faces 1, edges 2, corners 3. */
    int const farthest = work->links == 6 ? 1 : work->links == 18 ? 2 : 3;

    for (uint64_t row = begin; row < end; row++) {
        float *to = work->values + work->first[row] * (uint64_t)work->links;
        for (int32_t x = 0; x < g->size[0] && work->first[row] < work->first[row + 1]; x++) {
            const uint64_t *const words = g->words + row * (uint64_t)g->words_per_row;
            if ((words[x >> 6] >> (x & 63) & 1) == 0) continue;
            double ray[6];
            link_start(g, row, x, ray);
            for (int n = 0; n < 27; n++) {
                int const way[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
                int const length = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
                bvx_mesh_hit hit = {.t = -1.0};
                ray_visit w = {.t_max = 1.0, .hits = &hit, .nearest = 1};
                if (length == 0 || length > farthest) continue;
                for (int a = 0; a < 3; a++) ray[3 + a] = way[a] * g->lattice.spacing[a];
                cast_mesh_ray(&work->closest->tree, ray, &w);
                *to++ = (float)hit.t;
            }
        }
    }
}

static bvx_status run_closest_links(bvx_context *context, const bvx_closest *closest, const bvx_grid *grid,
                                    int32_t links, float *values)
{
    static const char *const function = "bvx_closest_links";
    mesh_links w = {.closest = closest, .grid = grid, .links = links, .values = values};
    mesh_ray r;
    double ray[6] = {0.0, 0.0, 0.0, 1.0, 0.0, 0.0};

    if (closest == NULL) return bvxi_fail_null(context, function, "closest");
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    BVXI_TRY(bvxi_grid_check_past(context, function, grid));
    if (links != 6 && links != 18 && links != 26)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: a voxel has 6, 18 or 26 links, not %d", function, (int64_t)links);
    uint64_t const rows = bvxi_grid_rows(grid);
    for (int end = 0; end < 2 && rows != 0; end++) {
        link_start(grid, end == 0 ? 0 : rows - 1, end == 0 ? 0 : grid->size[0] - 1, ray);
        if (!open_ray(&closest->tree, ray, &r))
            return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_RANGE,
                                 "%s: the grid lies 2^200 times the mesh's size away from the origin",
                                 function);
    }
    BVXI_TRY(BVXI_ARRAY(context, rows + 1, "the rows' numbers", w.first));
    if (bvxi_sparse_number(grid, w.first) != 0 && values == NULL)
        return bvxi_fail_null(context, function, "values");
    return bvxi_for(context, "links", rows, 1, cast_link_rows, &w);
}

bvx_status bvx_closest_links(bvx_context *context, const bvx_closest *closest, const bvx_grid *grid,
                             int32_t links, float *values)
{
    return BVXI_CALL(context, run_closest_links(context, closest, grid, links, values));
}
