/* cast.c - the first set voxel on each of many rays.
 *
 * Source: Amanatides, Woo. A Fast Voxel Traversal Algorithm for Ray Tracing. 1987, over the rows of the grid
 * instead of its voxels: the walk steps along y and z only, and the part of a row that the ray is in between
 * two steps is looked at in words, empty ones in one glance. Where many rays are cast the same walk goes over
 * rows of bricks of 8 x 8 x 8 voxels, and over the rows of voxels only while it is beside bricks that hold
 * something.
 *
 * Guarantee. Along each axis the ray has u = (origin - lattice origin) / spacing and step = direction /
 * spacing, and crosses the lattice's plane i at t(i) = (i - u) * (1 / step), in doubles, never by adding up.
 * A voxel's closed box is met for t from the greatest t of its entering planes to the least of its leaving
 * ones; an axis that the ray does not move along is met always when u lies in the box, at both voxels when u
 * is the plane between them. The hit is the set voxel with the least (t, z, y, x) by these numbers, as if all
 * had been asked: a ray through an edge or a corner looks at every voxel there, and one that slides between
 * two layers looks at both. So bricks change nothing, and as planes are counted from the lattice's origin,
 * neither does a window. (Beyond 2^50 voxels of distance planes get equal t, and ties may be left out.) A
 * start so far away or a direction so long that u or step overflows meets nothing; a t above the largest
 * double is none. */
#include "grid/grid.h"

#include <math.h>

/* ---- Bricks ---- */

/* Which bricks of 8 x 8 x 8 voxels hold a set one, as a grid 512 times smaller that rays look at first.
 * Eight rows by eight are joined by OR, 64 voxels at a time; each byte of the result then becomes a bit. */

enum { BRICK_SHIFT = 3, BRICK_GRAIN = 64 /* least rows of bricks a piece */ };

/* Bit i of a row of bricks is that of voxels 8 i .. 8 i + 7 of the window; without words there are none. */
struct bvx_rays {
    bvx_grid grid; /* its words are the caller's */
    bvx_grid bricks;
};

/* Rows of bricks along y and z, and words of the grid along x, whose bricks are computed. */
typedef struct brick_box {
    bvx_rays *rays;
    int32_t low[3], size[3];
} brick_box;

static void make_brick_rows(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const brick_box *const box = user;
    const bvx_grid *const g = &box->rays->grid;
    (void)index;
    for (uint64_t r = begin; r < end; r++) {
        int32_t const y = box->low[1] + (int32_t)(r % (uint64_t)box->size[1]);
        int32_t const z = box->low[2] + (int32_t)(r / (uint64_t)box->size[1]);
        uint64_t *const row = bvxi_grid_row(&box->rays->bricks, y, z);
        /* A word of the grid is a byte of bricks. */
        for (int32_t k = box->low[0]; k < box->low[0] + box->size[0]; k++) {
            int const at = 8 * (k & 7);
            uint64_t w = 0, bits;

            for (int32_t j = 8 * z; j < 8 * z + 8 && j < g->size[2]; j++)
                for (int32_t i = 8 * y; i < 8 * y + 8 && i < g->size[1]; i++) w |= bvxi_grid_row(g, i, j)[k];
            /* The lowest bit of each byte becomes the OR of its eight, others get some of the byte above; the
             * multiplication brings the eight lowest bits together in the top byte. */
            w |= w >> 4;
            w |= w >> 2;
            w |= w >> 1;
            bits = (w & UINT64_C(0x0101010101010101)) * UINT64_C(0x0102040810204080) >> 56;
            row[k >> 3] = (row[k >> 3] & ~(UINT64_C(0xff) << at)) | bits << at;
        }
    }
}

/* The box of a window's part in the grid's own; 0: there is none. */
static int box_of_bricks(bvx_rays *rays, const bvx_window *part, brick_box *box)
{
    box->rays = rays;
    for (int a = 0; a < 3; a++) {
        int32_t const shift = a == 0 ? 6 : BRICK_SHIFT, before = rays->grid.low[a];
        int32_t const low = part->low[a] > before ? part->low[a] - before : 0;
        int32_t const end = part->low[a] - before + part->size[a];
        int32_t const high = (end < rays->grid.size[a] ? end : rays->grid.size[a]) - 1;
        if (high < low) return 0;
        box->low[a] = low >> shift;
        box->size[a] = (high >> shift) - box->low[a] + 1;
    }
    return 1;
}

/* The bricks of a checked grid. Memory (scratch): 1/512 of the grid's, rounded up to whole words a row. */
static bvx_status make_bricks(bvx_context *ctx, const bvx_grid *grid, bvx_rays *rays)
{
    bvx_window all = {.low = {0, 0, 0}};
    brick_box box;

    rays->grid = rays->bricks = *grid;
    memcpy(all.size, grid->lattice.dims, sizeof all.size);
    for (int a = 0; a < 3; a++) rays->bricks.size[a] = (grid->size[a] + 7) >> BRICK_SHIFT;
    rays->bricks.words_per_row = bvxi_row_words(rays->bricks.size[0]);
    BVXI_TRY(BVXI_ZEROS(ctx, bvxi_grid_words(&rays->bricks), "the grid's bricks", rays->bricks.words));
    /* A piece writes rows of its own, so its bits do not depend on the others. */
    (void)box_of_bricks(rays, &all, &box);
    uint64_t const rows = (uint64_t)box.size[1] * (uint64_t)box.size[2];
    return bvxi_for_pieces(ctx, "cast", 0.0, 1.0, bvxi_piece_count(rows, BRICK_GRAIN), rows, make_brick_rows,
                           &box);
}

/* ---- One ray ---- */

enum {
    CAST_GRAIN = 64,       /* least rays a piece */
    CAST_BRICK_RAYS = 256, /* bricks are made for so many rays, */
    /* when the grid has at most so many words for each: what making them costs, they save */
    CAST_BRICK_WORDS = 2048
};

typedef struct cast_axis {
    double u, step, per; /* start and direction in voxels of the lattice; 1 / step */
    double low;          /* of the window */
    double slack;        /* above all rounding of a place computed from t [Units: voxels] */
    int32_t way;         /* 1 or -1; 0: it does not move */
    int32_t first, last; /* voxels of the window in the ray's order; way 0: the one or two that it is in */
} cast_axis;

typedef struct cast_ray {
    const bvx_rays *in;
    cast_axis axis[3];
    double end;       /* no hit after this t */
    double t;         /* of the best hit so far; end while there is none */
    int32_t voxel[3]; /* of the best hit; x is -1 while there is none */
} cast_ray;

static inline double cast_plane(const cast_axis *a, int32_t i)
{
    return ((double)i + a->low - a->u) * a->per;
}

static inline double cast_enter(const cast_axis *a, int32_t i)
{
    return a->way == 0 ? -HUGE_VAL : cast_plane(a, i + (a->way < 0));
}

static inline double cast_leave(const cast_axis *a, int32_t i)
{
    return a->way == 0 ? HUGE_VAL : cast_plane(a, i + (a->way > 0));
}

/* Where the ray is along an axis [Units: voxels of the window]; only as good as its slack. */
static inline double cast_place(const cast_axis *a, double t)
{
    return a->u + t * a->step - a->low;
}

/* The voxels of a row that can be met between two places, and perhaps one more at each end. */
static inline int cast_reach(const cast_axis *a, int32_t n, double p, double q, int32_t *low, int32_t *high)
{
    /* The slack covers the rounding of both places: at most one voxel too many is tested. */
    double const least = (p < q ? p : q) - a->slack, most = (p < q ? q : p) + a->slack;
    if (a->way == 0) {
        *low = a->first;
        *high = a->last;
        return 1;
    }
    *low = !(least > 0.0) ? 0 : least < (double)n ? (int32_t)least : n;
    *high = !(most >= 0.0) ? -1 : most < (double)n ? (int32_t)most : n - 1;
    return *low <= *high;
}

/* Take voxel x of a row that is met during [from, to] when it is the best; 0: those after it are late. */
static int try_cast_voxel(cast_ray *r, int32_t x, int32_t y, int32_t z, double from, double to)
{
    double const enter = cast_enter(&r->axis[0], x), t = enter > from ? enter : from;
    int better = r->voxel[0] < 0;

    /* The box is entered after the row is left, or after the best hit: so are all after it. */
    if (enter > to || t > r->t) return 0;
    /* Left before the row was entered: the voxels after it may still be met. */
    if (cast_leave(&r->axis[0], x) < from) return 1;
    /* Of equal t the lowest voxel is taken, so the way of the ray does not decide. */
    if (!better && t == r->t) {
        better = z < r->voxel[2];
        if (z == r->voxel[2]) better = y < r->voxel[1] || (y == r->voxel[1] && x < r->voxel[0]);
    } else better = 1;
    if (better) {
        r->t = t;
        r->voxel[0] = x;
        r->voxel[1] = y;
        r->voxel[2] = z;
    }
    return 1;
}

/* Set voxels among low..high of a row, in the ray's order, as long as they can matter. */
static void cast_row(cast_ray *r, int32_t low, int32_t high, int32_t y, int32_t z, double from, double to)
{
    const uint64_t *const row = bvxi_grid_row(&r->in->grid, y, z);
    int32_t const k_low = low >> 6, k_high = high >> 6, back = r->axis[0].way < 0;

    for (int32_t n = 0; n <= k_high - k_low; n++) {
        int32_t const k = back ? k_high - n : k_low + n;
        uint64_t w = row[k];
        if (w == 0) continue;
        if (k == k_low) w &= ~UINT64_C(0) << (low & 63);
        if (k == k_high) w &= bvxi_tail_mask(high + 1);
        while (w != 0) {
            int32_t const bit = back ? bvxi_highest(w) : bvxi_lowest(w);
            if (!try_cast_voxel(r, k * BVXI_WORD_BITS + bit, y, z, from, to)) return;
            w ^= UINT64_C(1) << bit;
        }
    }
}

static int cast_bricks_hold(const bvx_grid *bricks, int32_t low, int32_t high, int32_t y, int32_t z)
{
    const uint64_t *const row = bvxi_grid_row(bricks, y, z);
    int32_t const first = low >> BRICK_SHIFT, last = high >> BRICK_SHIFT;
    int32_t const k_first = first >> 6, k_last = last >> 6;

    for (int32_t k = k_first; k <= k_last; k++) {
        uint64_t w = row[k];
        if (k == k_first) w &= ~UINT64_C(0) << (first & 63);
        if (k == k_last) w &= bvxi_tail_mask(last + 1);
        if (w != 0) return 1;
    }
    return 0;
}

/* The first cell of 2^shift voxels in the ray's order that is met at t; one is. */
static inline int32_t cast_start(const cast_axis *a, int32_t shift, int32_t n, double t)
{
    int32_t i = a->first;
    /* By rounding the place is right up to a voxel; the exact planes decide, in steps of one. */
    if (a->way == 0) return i >> shift;
    double const p = cast_place(a, t);
    i = !(p > 0.0) ? 0 : p < (double)n ? (int32_t)p : n - 1;
    while (i != a->first && cast_leave(a, i - a->way) >= t) i -= a->way;
    while (i != a->last && cast_leave(a, i) < t) i += a->way;
    return i >> shift;
}

/* When the ray leaves a cell of 2^shift voxels; after the grid's end for the last one. */
static inline double cast_leave_cell(const cast_axis *a, int32_t shift, int32_t i)
{
    return a->way == 0 ? HUGE_VAL : cast_plane(a, (int32_t)((uint32_t)(i + (a->way > 0)) << shift));
}

static void walk_cast_voxels(cast_ray *r, double from, double to);

/* A stretch of the ray: [from, to], along which x goes from place p to q. */
typedef struct cast_stretch {
    double from, to, p, q;
} cast_stretch;

/* The row, or rows when the ray slides between some, in which it is during a stretch. */
static inline void cast_rows(cast_ray *r, int32_t shift, int32_t y, int32_t z, cast_stretch s)
{
    const cast_axis *const a = r->axis;
    int32_t const y_end = a[1].way == 0 ? a[1].last >> shift : y;
    int32_t const z_end = a[2].way == 0 ? a[2].last >> shift : z;
    int32_t low, high;

    /* Where the ray lies exactly between two rows, all rows beside it are looked at. */
    if (!cast_reach(&a[0], r->in->grid.size[0], s.p, s.q, &low, &high)) return;
    for (int32_t k = z; k <= z_end; k++)
        for (int32_t j = y; j <= y_end; j++) {
            if (shift == 0) {
                cast_row(r, low, high, j, k, s.from, s.to);
            } else if (cast_bricks_hold(&r->in->bricks, low, high, j, k)) {
                walk_cast_voxels(r, s.from, s.to);
                return; /* it has looked beside all of these rows */
            }
        }
}

/* From t to end, until no row can hold a better hit. */
static inline void walk_cast_rows(cast_ray *r, int32_t shift, double t, double end)
{
    const cast_axis *const a = r->axis;
    int32_t const last_y = a[1].last >> shift, last_z = a[2].last >> shift;
    int32_t y = cast_start(&a[1], shift, r->in->grid.size[1], t);
    int32_t z = cast_start(&a[2], shift, r->in->grid.size[2], t);
    double leave_y = cast_leave_cell(&a[1], shift, y);
    double leave_z = cast_leave_cell(&a[2], shift, z);
    double p = cast_place(&a[0], t);

    /* Each turn is the part of the ray in one row of cells, up to the next plane of y or z. */
    for (;;) {
        double const next = leave_y < leave_z ? leave_y : leave_z, to = next < end ? next : end;
        double const q = cast_place(&a[0], to);
        int const over_y = leave_y == next;
        int const over_z = leave_z == next;
        int const more_y = y != last_y;
        int const more_z = z != last_z;
        cast_rows(r, shift, y, z, (cast_stretch){t, to, p, q});
        if (!(next <= r->t && next <= end)) return;
        if (over_y && over_z) { /* over an edge along x: the two rows beside it too */
            cast_stretch const here = {next, next, q, q};
            if (more_y) cast_rows(r, shift, y + a[1].way, z, here);
            if (more_z) cast_rows(r, shift, y, z + a[2].way, here);
        }

        if ((over_y && !more_y) || (over_z && !more_z)) return;
        if (over_y) leave_y = cast_leave_cell(&a[1], shift, y += a[1].way);
        if (over_z) leave_z = cast_leave_cell(&a[2], shift, z += a[2].way);
        t = next;
        p = q;
    }
}

static void walk_cast_voxels(cast_ray *r, double from, double to)
{
    walk_cast_rows(r, 0, from, to);
}

/* Set up an axis; 0 when the ray lies beside the box. */
static int plan_cast_axis(const bvx_grid *g, int32_t axis, double origin, double direction, cast_axis *a)
{
    int32_t const n = g->size[axis];

    a->low = (double)g->low[axis];
    a->u = (origin - g->lattice.origin[axis]) / g->lattice.spacing[axis];
    a->step = direction / g->lattice.spacing[axis];
    a->per = 1.0 / a->step;

    /* Overflow makes infinities or NaN, of which no plane can be computed. */
    if (a->u - a->u != 0.0 || a->step - a->step != 0.0) return 0;
    a->slack = ((a->u < 0.0 ? -a->u : a->u) + a->low + (double)n + 1.0) * 0x1p-48;
    /* A step so small that its inverse overflows counts as no step: the ray does not leave its voxel. */
    if (a->step != 0.0 && a->per - a->per == 0.0) {
        a->way = a->step > 0.0 ? 1 : -1;
        a->first = a->way > 0 ? 0 : n - 1;
        a->last = a->way > 0 ? n - 1 : 0;
        return 1;
    }

    /* Standing still it must be inside; on a plane between two voxels it is in both. */
    if (!(a->u >= a->low && a->u <= a->low + (double)n)) return 0;
    a->way = 0;
    a->last = (int32_t)(a->u - a->low); /* the difference is exact: u is not below low, a whole number */
    a->first = a->last > 0 && (double)a->last + a->low == a->u ? a->last - 1 : a->last;
    if (a->last == n) a->last = n - 1;
    return 1;
}

/* The part of the ray in the grid's box, [*begin, end]; 0 when there is none. */
static int clip_cast_ray(const double *ray, double t_max, cast_ray *r, double *begin)
{
    *begin = 0.0;

    /* A finite end keeps t finite, also where a plane lies at infinity. */
    r->end = t_max < 0x1.fffffffffffffp+1023 ? t_max : 0x1.fffffffffffffp+1023;
    for (int32_t i = 0; i < 3; i++) {
        if (!plan_cast_axis(&r->in->grid, i, ray[i], ray[3 + i], &r->axis[i])) return 0;
        double const enter = cast_enter(&r->axis[i], r->axis[i].first);
        double const leave = cast_leave(&r->axis[i], r->axis[i].last);
        *begin = enter > *begin ? enter : *begin;
        r->end = leave < r->end ? leave : r->end;
    }

    r->t = r->end;
    r->voxel[0] = -1;
    return *begin <= r->end;
}

/* ---- Many rays ---- */

typedef struct cast_work {
    const bvx_rays *in;
    const double *rays;
    bvx_ray_hit *hits;
    double t_max;
} cast_work;

static void cast_piece(void *user, uint64_t begin, uint64_t end)
{
    const cast_work *const w = user;

    for (uint64_t i = begin; i < end; i++) {
        const double *const ray = w->rays + 6 * i;
        cast_ray r;
        double start;
        memset(&w->hits[i], 0, sizeof w->hits[i]);
        r.in = w->in;
        if (!clip_cast_ray(ray, w->t_max, &r, &start)) continue;
        if (r.in->bricks.words != NULL) walk_cast_rows(&r, BRICK_SHIFT, start, r.end);
        else walk_cast_voxels(&r, start, r.end);
        if (r.voxel[0] < 0) continue;

        bvx_ray_hit *const hit = &w->hits[i];
        double latest = 0.0;
        hit->hit = 1;
        hit->t = r.t;
        hit->axis = -1;
        /* The side that was entered last is the one hit; -1 stays where the ray starts inside. */
        for (int32_t a = 0; a < 3; a++) {
            double const enter = cast_enter(&r.axis[a], r.voxel[a]);
            if (enter > latest) {
                latest = enter;
                hit->axis = a;
            }
            hit->voxel[a] = r.voxel[a];
            hit->position[a] = ray[a] + r.t * ray[3 + a];
        }
    }
}

static bvx_status run_grid_cast(bvx_context *context, const bvx_grid *grid, const double *rays,
                                uint64_t count, double t_max, bvx_ray_hit *hits)
{
    static const char *const function = "bvx_grid_cast";
    bvx_rays in = {.bricks.words = NULL};
    cast_work w = {&in, rays, hits, t_max};

    BVXI_TRY(bvxi_grid_check(context, function, grid));
    if (hits == NULL && count != 0) return bvxi_fail_null(context, function, "hits");
    BVXI_TRY(bvxi_check_rays(context, function, rays, count, t_max, sizeof *hits));
    in.grid = *grid;

    /* Bricks pay where there are many rays for the words that they are made of. */
    if (count >= CAST_BRICK_RAYS && bvxi_grid_words(grid) / count <= CAST_BRICK_WORDS)
        BVXI_TRY(BVXI_SHARE(context, 0.0, 0.05, make_bricks(context, grid, &in)));
    return BVXI_SHARE(context, 0.05, 1.0, bvxi_for(context, "cast", count, CAST_GRAIN, cast_piece, &w));
}

bvx_status bvx_grid_cast(bvx_context *context, const bvx_grid *grid, const double *rays, uint64_t count,
                         double t_max, bvx_ray_hit *hits)
{
    return BVXI_CALL(context, run_grid_cast(context, grid, rays, count, t_max, hits));
}

/* ---- Bricks kept ---- */

static bvx_status run_rays_create(bvx_context *context, const bvx_grid *grid, bvx_rays **caster)
{
    static const char *const function = "bvx_rays_create";
    bvx_rays *made = NULL;

    if (caster == NULL) return bvxi_fail_null(context, function, "caster");
    *caster = NULL;
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    /* What has been taken since the mark is given to the object when all went well. */
    uint64_t const mark = bvxi_scratch_begin(context);
    BVXI_TRY(bvxi_alloc(context, BVXI_SCRATCH, sizeof *made, "the bricks' head", &made));
    BVXI_TRY(make_bricks(context, grid, made));
    bvxi_scratch_adopt(context, mark);
    *caster = made;
    return BVX_OK;
}

bvx_status bvx_rays_create(bvx_context *context, const bvx_grid *grid, bvx_rays **caster)
{
    return BVXI_CALL(context, run_rays_create(context, grid, caster));
}

void bvx_rays_free(bvx_context *context, bvx_rays *caster)
{
    if (context == NULL || caster == NULL) return;
    bvxi_free(context, caster->bricks.words, bvxi_grid_words(&caster->bricks) * sizeof(uint64_t));
    bvxi_free(context, caster, sizeof *caster);
}

static bvx_status run_rays_update(bvx_context *context, bvx_rays *caster, const bvx_grid *grid,
                                  const bvx_window *changed)
{
    static const char *const function = "bvx_rays_update";
    bvx_window part;
    brick_box box;

    if (caster == NULL) return bvxi_fail_null(context, function, "caster");
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    BVXI_TRY(bvxi_grid_same(context, function, &caster->grid, grid));
    BVXI_TRY(bvxi_window_take(context, function, &grid->lattice, changed, &part));
    BVXI_TRY(bvxi_progress(context, "cast", 0.0));

    /* From here on nothing fails or stops: bricks of two grids would hide voxels of both. */
    caster->grid = *grid;
    if (!box_of_bricks(caster, &part, &box)) return BVX_OK;
    uint64_t const rows = (uint64_t)box.size[1] * (uint64_t)box.size[2];
    bvxi_ranges(context, bvxi_piece_count(rows, BRICK_GRAIN), rows, make_brick_rows, &box);
    return BVX_OK;
}

bvx_status bvx_rays_update(bvx_context *context, bvx_rays *caster, const bvx_grid *grid,
                           const bvx_window *changed)
{
    return BVXI_CALL(context, run_rays_update(context, caster, grid, changed));
}

static bvx_status run_rays_cast(bvx_context *context, const bvx_rays *caster, const double *rays,
                                uint64_t count, double t_max, bvx_ray_hit *hits)
{
    static const char *const function = "bvx_rays_cast";
    cast_work w = {caster, rays, hits, t_max};
    if (caster == NULL) return bvxi_fail_null(context, function, "caster");
    if (hits == NULL && count != 0) return bvxi_fail_null(context, function, "hits");
    BVXI_TRY(bvxi_check_rays(context, function, rays, count, t_max, sizeof *hits));
    return bvxi_for(context, "cast", count, CAST_GRAIN, cast_piece, &w);
}

bvx_status bvx_rays_cast(bvx_context *context, const bvx_rays *caster, const double *rays, uint64_t count,
                         double t_max, bvx_ray_hit *hits)
{
    return BVXI_CALL(context, run_rays_cast(context, caster, rays, count, t_max, hits));
}
