/* repair_thin.c - walls of a closed body that are thinner than the lattice can hold: found, and widened until it does.
 *
 * Source: Andres, Jacob. The Discrete Analytical Hyperplanes. 1997: an even wall of one and a half voxels holds whatever moves
 * from voxel to voxel across faces and edges, however it lies (the two largest parts of its normal sum to 1.414 at most).
 *
 * A wall thinner than that may have no centre inside, here and there or everywhere. It shows where a lattice line crosses the mesh
 * between two outside centres, and where outside centres meet diagonally between inside ones. There the nearest point of
 * the mesh and the nearest one behind it are asked for: where they face away from each other and lie no further apart than
 * a voxel and a half, there is a thin wall. Centres beside it go inside up to half of what it lacks.
 * Guarantee: what is found follows from the mesh and the lattice alone. Cost: the surface, and closest points at thin places. */
#include "core/hash.h"
#include "mesh/closest_query.h"
#include "mesh/facet.h"
#include "mesh/radix.h"
#include "mesh/view.h"
#include "pipeline/ends.h"
#include "pipeline/repair.h"
#include "voxelize/fills.h"

#include <math.h>

#define THIN_WALL 1.5  /* what holds on any lattice [Units: largest spacings] */
#define THIN_DEPTH 0.75 /* where the other side is looked for */
#define THIN_BEYOND 0.05f /* a surface lies beyond the centres that it has inside */
#define THIN_FACING 0.55/* cosine between a face and the opposite of the other */
#define THIN_STRAIGHT 0.9 /* where triangles are flipped: cosine between both faces, and between them and the way through */
#define THIN_SAME 0.25  /* nearest points this near to each other are of one face */

enum { THIN_GRAIN = 256, THIN_PIECES = 1024, THIN_BLOCK = 8, THIN_REACH = 4, THIN_MANY_BLOCKS = 512, THIN_BINS = 64, THIN_CRUMB = 8, THIN_MENDS = 4 };

/* What the mesh is like at a centre outside. */
typedef struct thin_point {
    float wall;        /* THIN_NO_WALL, or how thick the nearest wall is; 0: a sheet [Units: largest spacings] */
    float distance;    /* to it */
    uint32_t triangle; /* of those nearby */
    int32_t sheet;
} thin_point;

#define THIN_NO_WALL 1e30f

typedef struct thin_job {
    bvxi_repair_job *job;
    double unit;              /* the largest spacing */
    double limit;             /* walls further from the centre than this are not looked at [Units: largest spacings] */
    bvx_grid places;          /* scratch words: centres in question */
    uint64_t *at;             /* their bits [Size: count] */
    thin_point *point;        /* what is there [Size: count] */
    uint64_t count;
    uint32_t *corner;         /* of the triangles nearby, each from its first corner to its last, by place */
    uint64_t corner_bytes;
    uint8_t *against;         /* of those triangles, 1: the mesh has them the other way round */
    uint8_t *blocks;          /* 1: triangles there are wanted */
    int32_t block_size[3];
    bvx_mesh_view near;
    bvx_closest closest;
    int32_t pieces;
} thin_job;

/* ---- Centres as bits ---- */

static void centre_of_bit(const bvx_grid *g, uint64_t bit, int32_t at[3])
{
    uint64_t const row = bit / 64 / (uint64_t)g->words_per_row;

    at[0] = (int32_t)(bit - row * (uint64_t)g->words_per_row * 64);
    at[1] = (int32_t)(row % (uint64_t)g->size[1]);
    at[2] = (int32_t)(row / (uint64_t)g->size[1]);
}

static uint64_t bit_of_centre(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    return ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->words_per_row * 64 + (uint64_t)x;
}

static void close_list(thin_job *t)
{
    bvxi_free(t->job->ctx, t->point, t->count * sizeof *t->point);
    bvxi_free(t->job->ctx, t->at, t->count * 8);
    t->point = NULL;
    t->at = NULL;
    t->count = 0;
}

/* The set centres of places, in order. */
static bvx_status list_places(thin_job *t)
{
    uint64_t const words = t->job->grid_bytes / 8;
    uint64_t count = 0, n = 0;

    close_list(t);
    for (uint64_t i = 0; i < words; i++) count += bvxi_popcount(t->places.words[i]);
    if (count == 0) return BVX_OK;

    BVXI_TRY(bvxi_alloc(t->job->ctx, BVXI_SCRATCH, count * 8, "the thin places", &t->at));
    t->count = count;
    BVXI_TRY(bvxi_alloc(t->job->ctx, BVXI_SCRATCH, count * sizeof *t->point, "the walls at thin places", &t->point));
    for (uint64_t i = 0; i < words; i++)
        for (uint64_t bits = t->places.words[i]; bits != 0; bits &= bits - 1) t->at[n++] = i * 64 + (uint64_t)bvxi_lowest(bits);
    return BVX_OK;
}

/* ---- Where the lattice loses the surface ---- */

/* Of four neighbours around a lattice edge, those outside where they meet diagonally. */
static void mark_diagonals(const uint64_t *in, uint64_t *out, size_t a, size_t b, size_t c, size_t d)
{
    uint64_t const p = in[a] & in[d] & ~in[b] & ~in[c], q = in[b] & in[c] & ~in[a] & ~in[d];

    out[b] |= p;
    out[c] |= p;
    out[a] |= q;
    out[d] |= q;
}

/* The same of a row and one beside it: pairs along the row. */
static void mark_row_diagonals(const uint64_t *in, uint64_t *out, size_t row, size_t beside, int32_t words)
{
    for (int32_t k = 0; k < words; k++) {
        size_t const i = row + (size_t)k, j = beside + (size_t)k;
        uint64_t const a = in[i], c = in[j];
        uint64_t const b = a >> 1 | (k + 1 < words ? in[i + 1] << 63 : 0), d = c >> 1 | (k + 1 < words ? in[j + 1] << 63 : 0);
        uint64_t const p = a & d & ~b & ~c, q = b & c & ~a & ~d;

        if ((p | q) == 0) continue;
        out[i] |= q | p << 1;
        out[j] |= p | q << 1;
        if (k + 1 < words) {
            out[i + 1] |= p >> 63;
            out[j + 1] |= q >> 63;
        }
    }
}

static void mark_all_diagonals(const bvx_grid *g, uint64_t *out)
{
    int32_t const words = g->words_per_row;
    size_t const row = (size_t)words, slice = row * (size_t)g->size[1];

    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            size_t const at = (size_t)z * slice + (size_t)y * row;
            int const up = y + 1 < g->size[1], on = z + 1 < g->size[2];

            if (up) mark_row_diagonals(g->words, out, at, at + row, words);
            if (on) mark_row_diagonals(g->words, out, at, at + slice, words);
            for (size_t i = at; up && on && i < at + row; i++)
                mark_diagonals(g->words, out, i, i + row, i + slice, i + row + slice);
        }
}

static bvx_status find_thin_places(thin_job *t)
{
    bvxi_repair_job *const job = t->job;

    BVXI_TRY(bvxi_lost_surface(job->ctx, bvxi_repair_name, &job->body, &job->inside, &t->places));
    mark_all_diagonals(&job->inside, t->places.words);
    return BVX_OK;
}

/* ---- The triangles nearby ---- */

/* Blocks of voxels that hold [low, high], cut to the window. */
static void block_range(const thin_job *t, const double low[3], const double high[3], int32_t from[3], int32_t to[3])
{
    for (int a = 0; a < 3; a++) {
        double const last = (double)t->block_size[a] - 1;
        double const l = low[a] / THIN_BLOCK, h = high[a] / THIN_BLOCK;

        from[a] = l > 0 ? (l < last ? (int32_t)l : (int32_t)last) : 0;
        to[a] = h > 0 ? (h < last ? (int32_t)h : (int32_t)last) : 0;
    }
}

static uint8_t *block_row(const thin_job *t, int32_t y, int32_t z)
{
    return t->blocks + ((size_t)z * (size_t)t->block_size[1] + (size_t)y) * (size_t)t->block_size[0];
}

static void mark_blocks(thin_job *t)
{
    const bvx_grid *const g = &t->places;

    for (uint64_t n = 0; n < t->count; n++) {
        double low[3], high[3];
        int32_t at[3], from[3], to[3];

        centre_of_bit(g, t->at[n], at);
        for (int a = 0; a < 3; a++) {
            double const reach = THIN_REACH * t->unit / g->lattice.spacing[a] + 1;

            low[a] = (double)at[a] - reach;
            high[a] = (double)at[a] + reach;
        }
        block_range(t, low, high, from, to);
        for (int32_t z = from[2]; z <= to[2]; z++)
            for (int32_t y = from[1]; y <= to[1]; y++) memset(block_row(t, y, z) + from[0], 1, (size_t)(to[0] - from[0]) + 1);
    }
}

static int is_in_marked_block(const thin_job *t, const double p[3][3])
{
    const bvx_lattice *const l = &t->places.lattice;
    double low[3], high[3];
    int32_t from[3], to[3];

    for (int a = 0; a < 3; a++) {
        double least = p[0][a], most = p[0][a];

        for (int k = 1; k < 3; k++) {
            if (p[k][a] < least) least = p[k][a];
            if (p[k][a] > most) most = p[k][a];
        }
        low[a] = (least - l->origin[a]) / l->spacing[a] - t->places.low[a];
        high[a] = (most - l->origin[a]) / l->spacing[a] - t->places.low[a];
    }
    block_range(t, low, high, from, to);
    if ((int64_t)(to[0] - from[0] + 1) * (to[1] - from[1] + 1) * (to[2] - from[2] + 1) > THIN_MANY_BLOCKS) return 1;
    for (int32_t z = from[2]; z <= to[2]; z++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            for (int32_t x = from[0]; x <= to[0]; x++)
                if (block_row(t, y, z)[x]) return 1;
    return 0;
}

static void take_triangles_nearby(thin_job *t)
{
    const bvx_mesh_view *const body = &t->job->body;
    uint64_t count = 0;

    for (uint64_t n = 0; n < body->triangle_count; n++) {
        double p[3][3], normal[3];
        uint32_t c[3];

        bvxi_view_triangle(body, n, c);
        for (int k = 0; k < 3; k++) bvxi_view_position(body, c[k], p[k]);
        if (!is_in_marked_block(t, (const double(*)[3])p)) continue;
        if (!(bvxi_facet_normal((const double(*)[3])p, normal) > 0)) continue;
        memcpy(t->corner + 3 * count++, c, sizeof c);
    }
    bvxi_repair_view(t->job, t->corner, count, &t->near);
}

/* Corners in the order of their places. Returns 1 when that turns the triangle round. */
static uint8_t order_corners(const bvx_mesh_view *mesh, uint32_t c[3])
{
    uint8_t turned = 0;

    for (int step = 0; step < 3; step++) {
        int const k = step & 1; /* corners 0 and 1, 1 and 2, 0 and 1 */
        double p[2][3];
        uint32_t const first = c[k];

        for (int i = 0; i < 2; i++) bvxi_view_position(mesh, c[k + i], p[i]);
        if (!bvxi_corner_before(p[1], p[0])) continue;
        c[k] = c[k + 1];
        c[k + 1] = first;
        turned ^= 1;
    }
    return turned;
}

static uint64_t place_hash(const bvx_mesh_view *mesh, const uint32_t c[3])
{
    bvxi_hash hash;
    double p[3];

    bvxi_hash_start(&hash, 0);
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(mesh, c[k], p);
        for (int a = 0; a < 3; a++) p[a] += 0.0; /* -0 is 0 */
        bvxi_hash_f64(&hash, p, 3);
    }
    return bvxi_hash_end(&hash);
}

/* Give the triangles nearby in an order that no numbering of the mesh shows in: that of a hash of their corners' places.
 * keys, numbers [Size: count]: scratch. sorted [Size: count * 3] */
static bvx_status sort_triangles_nearby(thin_job *t, uint64_t *keys, uint32_t *numbers, uint32_t *sorted)
{
    uint64_t const count = t->near.triangle_count;

    for (uint64_t n = 0; n < count; n++) {
        uint32_t *const c = t->corner + 3 * n;

        sorted[n] = order_corners(&t->near, c);
        keys[n] = place_hash(&t->near, c);
        numbers[n] = (uint32_t)n;
    }
    BVXI_TRY(bvxi_radix_sort(t->job->ctx, keys, numbers, count));
    for (uint64_t n = 0; n < count; n++) t->against[n] = (uint8_t)sorted[numbers[n]];
    for (uint64_t n = 0; n < count; n++) memcpy(sorted + 3 * n, t->corner + 3 * (uint64_t)numbers[n], 12);
    return BVX_OK;
}

static bvx_status order_triangles_nearby(thin_job *t)
{
    bvx_context *const ctx = t->job->ctx;
    uint64_t const count = t->near.triangle_count;
    uint32_t *sorted, *numbers = NULL;
    uint64_t *keys = NULL;
    bvx_status status;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 12, "the triangles at thin places in order", &sorted));
    status = bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the order of triangles at thin places", &keys);
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, count * 4, "the numbers of triangles at thin places", &numbers);
    if (status == BVX_OK) status = sort_triangles_nearby(t, keys, numbers, sorted);
    bvxi_free(ctx, numbers, count * 4);
    bvxi_free(ctx, keys, count * 8);

    /* Room for all triangles is needed no more. */
    bvxi_free(ctx, t->corner, t->corner_bytes);
    t->corner = sorted;
    t->corner_bytes = count * 12;
    bvxi_repair_view(t->job, sorted, count, &t->near);
    return status;
}

/* Triangles within THIN_REACH of the list's centres, and a search among them. */
static bvx_status open_nearby(thin_job *t)
{
    bvx_context *const ctx = t->job->ctx;
    uint64_t bytes = 1;
    bvx_status status;

    for (int a = 0; a < 3; a++) {
        t->block_size[a] = t->places.size[a] / THIN_BLOCK + 1;
        bytes *= (uint64_t)t->block_size[a];
    }
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the blocks of thin places", &t->blocks));
    t->corner_bytes = t->job->body.triangle_count * 12;
    status = bvxi_alloc(ctx, BVXI_SCRATCH, t->corner_bytes, "the triangles at thin places", &t->corner);
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, t->job->body.triangle_count, "the sides of thin places", &t->against);
    if (status == BVX_OK) {
        mark_blocks(t);
        take_triangles_nearby(t);
    }
    bvxi_free(ctx, t->blocks, bytes);
    t->blocks = NULL;
    if (status != BVX_OK || t->near.triangle_count == 0) return status;
    BVXI_TRY(order_triangles_nearby(t));
    return bvxi_closest_open(ctx, bvxi_repair_name, "thin", 0.3, 0.4, &t->near, &t->closest);
}

/* ---- What the mesh is like at a centre ---- */

static double thin_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void unit_normal(const thin_job *t, uint32_t triangle, double n[3])
{
    double p[3][3], length;
    uint32_t c[3];

    bvxi_view_triangle(&t->near, triangle, c);
    for (int k = 0; k < 3; k++) bvxi_view_position(&t->near, c[k], p[k]);
    length = bvxi_facet_normal((const double(*)[3])p, n);
    if (t->against[triangle]) length = -length;
    for (int a = 0; a < 3; a++) n[a] /= length;
}

static int is_inside_at(const bvx_grid *g, const double place[3])
{
    int32_t at[3];

    for (int a = 0; a < 3; a++) {
        double const v = (place[a] - g->lattice.origin[a]) / g->lattice.spacing[a] - g->low[a];

        if (!(v >= 0 && v < (double)g->size[a])) return 0;
        at[a] = (int32_t)v;
    }
    return bvx_grid_get(g, at[0], at[1], at[2]);
}

/* Nothing of the solid behind a face: half a voxel, three quarters and one deep. */
static int is_nothing_behind(const thin_job *t, const double p[3], const double out[3])
{
    for (int step = 2; step <= 4; step++) {
        double at[3];

        for (int a = 0; a < 3; a++) at[a] = p[a] - out[a] * (0.25 * step) * t->unit;
        if (is_inside_at(&t->job->inside, at)) return 0;
    }
    return 1;
}

/* The wall behind the point of the mesh next to a centre, seen along out; n: the normal there. */
static void ask_wall(const thin_job *t, const bvx_closest_point *front, const double out[3], const double n[3], uint32_t *hint,
                     thin_point *found)
{
    int const turned = t->job->fill == BVX_FILL_VOTE; /* normals may look to either side */
    bvx_closest_point back;
    double behind[3], m[3], facing, through, apart = 0, deep = 0;

    for (int a = 0; a < 3; a++) behind[a] = front->position[a] - out[a] * THIN_DEPTH * t->unit;
    if (t->job->holes.loops && thin_dot(out, n) < 0) return; /* a face seen from behind, through a hole */
    bvxi_closest_ask(&t->closest, behind, hint, &back);
    unit_normal(t, back.triangle, m);
    for (int a = 0; a < 3; a++) {
        double const d = front->position[a] - back.position[a];

        apart += d * d;
        deep += d * out[a];
    }
    apart = sqrt(apart) / t->unit;
    deep /= t->unit;
    facing = thin_dot(n, m);
    through = thin_dot(out, n) < 0 ? -thin_dot(out, m) : thin_dot(out, m); /* at edges normals are of one of their faces */
    if (!turned && through < facing) facing = through;

    if (turned ? bvxi_absolute(facing) > THIN_STRAIGHT && deep > THIN_SAME && deep > THIN_STRAIGHT * apart : facing < -THIN_FACING) {
        if (apart <= THIN_WALL) found->wall = (float)apart;
    } else if (!t->job->holes.loops && apart <= THIN_SAME && is_nothing_behind(t, front->position, out)) {
        found->wall = 0;
        found->sheet = 1;
    }
}

static void ask_thin_centre(const thin_job *t, uint64_t bit, uint32_t hint[2], thin_point *found)
{
    const bvx_grid *const g = &t->places;
    bvx_closest_point front;
    double centre[3], out[3], n[3];
    int32_t at[3];

    centre_of_bit(g, bit, at);
    for (int a = 0; a < 3; a++) centre[a] = g->lattice.origin[a] + ((double)(g->low[a] + at[a]) + 0.5) * g->lattice.spacing[a];
    bvxi_closest_ask(&t->closest, centre, &hint[0], &front);
    found->wall = THIN_NO_WALL;
    found->sheet = 0;
    found->triangle = front.triangle;
    found->distance = (float)(front.distance / t->unit);
    if (!(front.distance < t->limit * t->unit)) return;

    unit_normal(t, front.triangle, n);
    for (int a = 0; a < 3; a++) out[a] = front.distance > 1e-6 * t->unit ? (centre[a] - front.position[a]) / front.distance : n[a];
    ask_wall(t, &front, out, n, &hint[1], found);
}

static void ask_piece(void *user, int32_t piece, int32_t worker)
{
    const thin_job *const t = user;
    uint32_t hint[2] = {0, 0};
    uint64_t begin, end;
    (void)worker;

    bvxi_piece(t->count, t->pieces, piece, &begin, &end);
    for (uint64_t n = begin; n < end; n++) ask_thin_centre(t, t->at[n], hint, &t->point[n]);
}

static bvx_status ask_list(thin_job *t, double limit)
{
    uint64_t const pieces = t->count / THIN_GRAIN + 1;

    t->limit = limit;
    t->pieces = pieces < THIN_PIECES ? (int32_t)pieces : THIN_PIECES;
    return bvxi_parallel(t->job->ctx, "thin", 0.4, 1.0, t->pieces, ask_piece, t);
}

/* ---- What is found ---- */

static void take_into_box(bvx_repair_report *r, const int32_t at[3])
{
    for (int a = 0; a < 3; a++) {
        if (r->thin_voxels == 0 || at[a] < r->thin_low[a]) r->thin_low[a] = at[a];
        if (r->thin_voxels == 0 || at[a] > r->thin_high[a]) r->thin_high[a] = at[a];
    }
}

/* The walls of one range of thickness. */
typedef struct thin_range {
    uint64_t count;
    double sum;
} thin_range;

/* The wall that a tenth of the places is thinner than: the mean of the range that holds it. */
static double common_wall(const thin_range bins[THIN_BINS], uint64_t all)
{
    uint64_t below = 0;
    int bin = 0;

    while (bin + 1 < THIN_BINS && (below += bins[bin].count) * 10 <= all) bin++;
    return bins[bin].count != 0 ? bins[bin].sum / (double)bins[bin].count : 0;
}

/* Voxels along the longest axis with which a wall is as thick as holds anywhere; 0 where there is no such number. */
static int32_t resolution_for(const bvxi_repair_job *job, double wall)
{
    int32_t longest = job->resolution;
    double needed;
    int32_t whole;

    for (int a = 0; a < 3 && job->options->lattice != NULL; a++)
        if (a == 0 || job->lattice.dims[a] > longest) longest = job->lattice.dims[a];
    if (!(wall > 0)) return 0;
    needed = (double)longest * THIN_WALL / wall;
    if (!(needed <= (double)(1 << 24))) return 0;
    whole = (int32_t)needed;
    return whole < needed ? whole + 1 : whole;
}

/* How many, how thin and where. own: a byte a vertex, set for the pieces that have such walls. */
static void report_walls(thin_job *t, uint8_t *own)
{
    bvxi_repair_job *const job = t->job;
    bvx_repair_report *const r = &job->report;
    thin_range bins[THIN_BINS] = {{0, 0}};
    double wall;

    for (uint64_t n = 0; n < t->count; n++) {
        const thin_point *const p = &t->point[n];
        int32_t at[3];
        int bin;

        if (p->wall == THIN_NO_WALL) continue;
        bin = (int)((double)p->wall * (THIN_BINS / THIN_WALL)); /* walls are THIN_WALL at most */
        centre_of_bit(&t->places, t->at[n], at);
        take_into_box(r, at);
        r->thin_voxels++;
        bins[bin < THIN_BINS ? bin : THIN_BINS - 1].count++;
        bins[bin < THIN_BINS ? bin : THIN_BINS - 1].sum += (double)p->wall;
        own[job->piece[t->corner[3 * (size_t)p->triangle]]] = 1;
    }
    wall = r->thin_voxels != 0 ? common_wall(bins, r->thin_voxels) : 0;
    r->thin_wall = wall * t->unit;
    r->thin_resolution = r->thin_voxels != 0 ? resolution_for(job, wall) : 0;
    r->thin_kept = r->thin_voxels != 0 && job->options->thin == BVX_THIN_KEEP;
}

/* Places without a thin wall are places no more. */
static bvx_status tell_walls(thin_job *t)
{
    bvxi_repair_job *const job = t->job;
    uint64_t const vertices = job->given->vertex_count;
    uint8_t *own;

    for (uint64_t n = 0; n < t->count; n++)
        if (t->point[n].wall == THIN_NO_WALL) t->places.words[t->at[n] / 64] &= ~(UINT64_C(1) << (t->at[n] & 63));
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, vertices, "the pieces with thin walls", &own));
    report_walls(t, own);
    for (uint64_t v = 0; v < vertices; v++) job->report.thin_components += own[v];
    bvxi_free(job->ctx, own, vertices);
    return BVX_OK;
}

/* ---- Walls made thicker ---- */

/* Outside centres around the set ones. */
static void widen_places(thin_job *t)
{
    const bvx_grid *const g = &t->places;

    for (uint64_t n = 0; n < t->count; n++) {
        int32_t at[3], low[3], high[3];

        if (t->point[n].wall == THIN_NO_WALL) continue;
        centre_of_bit(g, t->at[n], at);
        for (int a = 0; a < 3; a++) {
            low[a] = at[a] > 0 ? at[a] - 1 : 0;
            high[a] = at[a] + 1 < g->size[a] ? at[a] + 1 : at[a];
        }
        for (int32_t z = low[2]; z <= high[2]; z++)
            for (int32_t y = low[1]; y <= high[1]; y++)
                for (int32_t x = low[0]; x <= high[0]; x++) {
                    uint64_t const bit = bit_of_centre(g, x, y, z);

                    g->words[bit / 64] |= UINT64_C(1) << (bit & 63);
                }
    }
    for (uint64_t i = 0; i < t->job->grid_bytes / 8; i++) g->words[i] &= ~t->job->inside.words[i];
}

static float thin_reach_of(const thin_point *p)
{
    return p->wall == THIN_NO_WALL ? 0.0f : (float)((THIN_WALL - (double)p->wall) * 0.5);
}

/* Set centres that hang together across faces, from one on, until there are THIN_CRUMB or one of them is not of the list of
 * places: then it is no crumb. Returns how many, or 0. */
static int gather_crumb(const thin_job *t, uint64_t from, uint64_t found[THIN_CRUMB])
{
    const bvx_grid *const g = &t->job->inside;
    int count = 1;

    found[0] = from;
    for (int n = 0; n < count; n++) {
        int32_t at[3];

        if ((t->places.words[found[n] / 64] >> (found[n] & 63) & 1) == 0) return 0;
        centre_of_bit(g, found[n], at);
        for (int side = 0; side < 6; side++) {
            int32_t to[3] = {at[0], at[1], at[2]};
            uint64_t bit;
            int known = 0;

            to[side / 2] += side % 2 * 2 - 1;
            if (to[side / 2] < 0 || to[side / 2] >= g->size[side / 2] || !bvx_grid_get(g, to[0], to[1], to[2])) continue;
            bit = bit_of_centre(g, to[0], to[1], to[2]);
            for (int k = 0; k < count; k++) known |= found[k] == bit;
            if (known) continue;
            if (count == THIN_CRUMB) return 0;
            found[count++] = bit;
        }
    }
    return count;
}

/* A few centres that reach neither the solid nor a wall of any size are no wall. */
static void drop_thin_crumbs(thin_job *t)
{
    uint64_t found[THIN_CRUMB];

    for (uint64_t n = 0; n < t->count; n++) {
        int count;

        if ((t->job->inside.words[t->at[n] / 64] >> (t->at[n] & 63) & 1) == 0) continue;
        count = gather_crumb(t, t->at[n], found);
        for (int k = 0; k < count; k++) t->job->inside.words[found[k] / 64] &= ~(UINT64_C(1) << (found[k] & 63));
    }
}

/* Centres within reach of a wall go inside. */
static void widen_walls(thin_job *t)
{
    for (uint64_t n = 0; n < t->count; n++)
        if (t->point[n].distance < thin_reach_of(&t->point[n])) t->job->inside.words[t->at[n] / 64] |= UINT64_C(1) << (t->at[n] & 63);
}

/* What is lost still, at the ends and corners of walls, goes inside itself and joins the centres of near. *more: 1 when there was any. */
static bvx_status mend_walls(thin_job *t, uint64_t *near, int *more)
{
    bvxi_repair_job *const job = t->job;

    *more = 0;
    BVXI_TRY(find_thin_places(t));
    for (uint64_t n = 0; n < job->grid_bytes / 8; n++) t->places.words[n] &= near[n];
    BVXI_TRY(list_places(t));
    if (t->count == 0) return BVX_OK;
    BVXI_TRY(ask_list(t, 1.0));
    for (uint64_t n = 0; n < t->count; n++) {
        uint64_t const bit = UINT64_C(1) << (t->at[n] & 63);

        if (t->point[n].wall == THIN_NO_WALL) continue;
        job->inside.words[t->at[n] / 64] |= bit;
        *more = 1;
    }
    return BVX_OK;
}

/* What the surface of the centres beside the walls is to be measured with. */
static bvx_status keep_reach(thin_job *t)
{
    bvxi_thin *const thin = &t->job->thin;
    uint64_t const rows = bvxi_grid_rows(&t->places);

    BVXI_TRY(bvxi_alloc(t->job->ctx, BVXI_SCRATCH, (rows + 1) * 8, "the rows beside thin walls", &thin->first));
    thin->rows = rows;
    BVXI_TRY(bvxi_alloc(t->job->ctx, BVXI_SCRATCH, t->count * 4, "the reach of thin walls", &thin->reach));
    thin->values = t->count;
    bvxi_ends_number(&t->places, thin->first);
    for (uint64_t n = 0; n < t->count; n++) {
        const thin_point *const p = &t->point[n];
        int const inside = (int)(t->job->inside.words[t->at[n] / 64] >> (t->at[n] & 63) & 1);
        float reach = thin_reach_of(p);

        if (inside && reach <= p->distance) reach = p->distance + THIN_BEYOND;
        thin->reach[n] = p->sheet ? -reach : reach;
    }
    return BVX_OK;
}

/* Mend until nothing is lost; *mended: 1 when centres went inside that may lie beyond the reach of their wall. */
static bvx_status mend_all(thin_job *t, uint64_t *near, int *mended)
{
    int more = 1;

    *mended = 0;
    for (int round = 0; more && round < THIN_MENDS; round++) {
        BVXI_TRY(mend_walls(t, near, &more));
        *mended |= more;
    }
    memcpy(t->places.words, near, (size_t)t->job->grid_bytes);
    return BVX_OK;
}

/* The walls of the list of seeds. */
static bvx_status widen(thin_job *t)
{
    bvxi_repair_job *const job = t->job;
    thin_job asked;
    uint64_t *near;
    bvx_status status;
    int mended = 0;

    widen_places(t);
    BVXI_TRY(list_places(t));
    BVXI_TRY(ask_list(t, THIN_DEPTH));
    widen_walls(t);

    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->grid_bytes, "the centres beside thin walls", &near));
    memcpy(near, t->places.words, (size_t)job->grid_bytes);
    asked = *t;
    t->at = NULL;
    t->point = NULL;
    t->count = 0;
    status = mend_all(t, near, &mended);
    bvxi_free(job->ctx, near, job->grid_bytes);

    /* Without that, the first answers are still those of all centres. */
    close_list(mended ? &asked : t);
    if (!mended) {
        t->at = asked.at;
        t->point = asked.point;
        t->count = asked.count;
    }
    if (status != BVX_OK) return status;
    if (mended) BVXI_TRY(list_places(t));
    if (mended) BVXI_TRY(ask_list(t, 1.0));
    drop_thin_crumbs(t);
    return keep_reach(t);
}

/* The triangles and the centres that were asked go on to the surface. */
static void hand_on(thin_job *t)
{
    bvxi_thin *const thin = &t->job->thin;

    thin->near = t->places;
    thin->corner = t->corner;
    thin->corner_bytes = t->corner_bytes;
    thin->mesh = t->near;
    t->places.words = NULL;
    t->corner = NULL;
}

void bvxi_thin_close(bvxi_repair_job *job)
{
    bvxi_thin *const thin = &job->thin;

    bvxi_free(job->ctx, thin->corner, thin->corner_bytes);
    bvxi_free(job->ctx, thin->reach, thin->values * 4);
    bvxi_free(job->ctx, thin->first, (thin->rows + 1) * 8);
    bvxi_free(job->ctx, thin->near.words, job->grid_bytes);
    memset(thin, 0, sizeof *thin);
}

/* ---- */

static bvx_status find_walls(thin_job *t)
{
    bvxi_repair_job *const job = t->job;

    BVXI_TRY(find_thin_places(t));
    BVXI_TRY(list_places(t));
    if (t->count == 0) return BVX_OK;

    BVXI_TRY(open_nearby(t));
    if (t->near.triangle_count == 0) return BVX_OK;
    BVXI_TRY(ask_list(t, 1.0));
    BVXI_TRY(tell_walls(t));
    if (!job->report.thin_kept) return BVX_OK;

    BVXI_TRY(widen(t));
    hand_on(t);
    return BVX_OK;
}

bvx_status bvxi_repair_thicken(bvxi_repair_job *job)
{
    thin_job t;
    bvx_status status;

    bvxi_thin_close(job);
    job->report.thin_voxels = job->report.thin_components = 0;
    job->report.thin_wall = 0;
    job->report.thin_resolution = job->report.thin_kept = 0;
    if (job->body.triangle_count == 0) return BVX_OK;
    if (job->options->thin != BVX_THIN_KEEP && job->options->report == NULL) return BVX_OK; /* nobody asks what is lost */
    memset(&t, 0, sizeof t);
    t.job = job;
    t.unit = bvxi_largest_spacing(&job->lattice);
    t.places = job->inside;
    t.places.words = NULL;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->grid_bytes, "the thin places", &t.places.words));
    status = find_walls(&t);

    bvxi_closest_shut(job->ctx, &t.closest);
    bvxi_free(job->ctx, t.against, job->body.triangle_count);
    bvxi_free(job->ctx, t.corner, t.corner_bytes);
    close_list(&t);
    bvxi_free(job->ctx, t.places.words, job->grid_bytes);
    return status;
}
