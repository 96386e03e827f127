/* thin_walls.c - walls of a closed body that are thinner than the lattice can hold: where they are, and how
 * thick.
 *
 * Source: Andres, Jacob. The Discrete Analytical Hyperplanes. 1997: an even wall of one and a half voxels
 * holds whatever moves from voxel to voxel across faces and edges, however it lies (the two largest parts of
 * its normal sum to 1.414 at most).
 *
 * A wall thinner than that may have no centre inside, here and there or everywhere. It shows where a lattice
 * line crosses the mesh between two outside centres, and where outside centres meet diagonally between inside
 * ones. There the nearest point of the mesh and the nearest one behind it are looked up: where they face away
 * from each other and lie no further apart than a voxel and a half, there is a thin wall.
 * Guarantee: what is found follows from the mesh and the lattice only. Cost: the surface, and closest points
 * at thin places. */
#include "fill/thin_walls.h"

#include "mesh/facet.h"
#include "mesh/mesh.h"
#include "touch/surface_voxels.h"

#include <math.h>

/* Cosine between one normal and the opposite of the other, 57 degrees: the faces of an edge sharper than that
 * are a wall too. */
#define WALL_FACING 0.55

/* The same where triangles may be flipped, 26 degrees, as no sign says then which face is seen from outside;
 * also between the way in from the centre and the one from front to back. */
#define WALL_STRAIGHT 0.9

/* Nearest points this near to each other are of one face: behind an even one both are the same point, the
 * rest is for curved ones [Units: largest spacings] */
#define WALL_SAME 0.25

/* How far out, step by step, the faces of a wall are looked for that stands on the nearest face; the cosine
 * from which on two faces do not stand on each other; and that between the sides of such a wall, 14 degrees
 * [Units: largest spacings] */
#define WALL_STEP     0.3
#define WALL_STANDING 0.7
#define WALL_EVEN     0.97
enum { WALL_STEPS_OUT = 3 };

enum { WALL_GRAIN = 256, WALL_PIECES = 1024, WALL_BINS = 64 };

/* ---- The list of places ---- */

void bvxi_walls_drop(bvxi_walls *t)
{
    bvxi_drop(t->ctx, t->point);
    bvxi_drop(t->ctx, t->at);
    t->point = NULL;
    t->at = NULL;
    t->count = 0;
}

/* The set centres of places, in the order of the grid, so that the list has one order. Nearly all words are 0. */
bvx_status bvxi_walls_list(bvxi_walls *t)
{
    uint64_t const words = t->bytes / 8;
    uint64_t count = 0, n = 0;

    bvxi_walls_drop(t);
    for (uint64_t i = 0; i < words; i++)
        if (t->places.words[i] != 0) count += bvxi_popcount(t->places.words[i]);
    if (count == 0) return BVX_OK;

    BVXI_TRY(bvxi_alloc(t->ctx, BVXI_SCRATCH, count * 8, "the thin places", &t->at));
    t->count = count;
    BVXI_TRY(BVXI_ARRAY(t->ctx, count, "the walls at thin places", t->point));
    for (uint64_t i = 0; i < words; i++)
        for (uint64_t bits = t->places.words[i]; bits != 0; bits &= bits - 1)
            t->at[n++] = i * 64 + (uint64_t)bvxi_lowest(bits);
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

/* The same of word i of a row and word j of one beside it, which differ: pairs along the row. last: the rows end. */
static void mark_row_diagonals(const uint64_t *in, uint64_t *out, size_t i, size_t j, int last)
{
    uint64_t const a = in[i], c = in[j];
    uint64_t const b = a >> 1 | (last ? 0 : in[i + 1] << 63), d = c >> 1 | (last ? 0 : in[j + 1] << 63);
    uint64_t const p = a & d & ~b & ~c, q = b & c & ~a & ~d;
    if ((p | q) == 0) return;
    out[i] |= q | p << 1;
    out[j] |= p | q << 1;
    if (last) return;
    out[i + 1] |= p >> 63;
    out[j + 1] |= q >> 63;
}

typedef struct diagonal_job {
    const bvx_grid *solid;
    uint64_t *out;
    int32_t first; /* slice */
} diagonal_job;

/* Of every other slice: it and the next one are marked, so no two tasks of a run meet. */
static void mark_slice_diagonals(void *user, int32_t index)
{
    const diagonal_job *const job = user;
    const bvx_grid *const g = job->solid;
    int32_t const z = job->first + 2 * index;
    size_t const row = (size_t)g->words_per_row, slice = row * (size_t)g->size[1];
    size_t const above = z + 1 < g->size[2] ? slice : 0; /* a row beside none has itself beside it */

    for (int32_t y = 0; y < g->size[1]; y++) {
        size_t const at = (size_t)z * slice + (size_t)y * row, beside = y + 1 < g->size[1] ? row : 0;
        /* Nearly all words are as those of the rows beside them. */
        for (size_t i = at; i < at + row; i++) {
            uint64_t const w = g->words[i];
            if (BVXI_LIKELY(((w ^ g->words[i + beside]) | (w ^ g->words[i + above])) == 0)) continue;
            int const last = i + 1 == at + row;
            if (w != g->words[i + beside]) mark_row_diagonals(g->words, job->out, i, i + beside, last);
            if (w != g->words[i + above]) mark_row_diagonals(g->words, job->out, i, i + above, last);
            if (beside != 0 && above != 0)
                mark_diagonals(g->words, job->out, i, i + row, i + slice, i + row + slice);
        }
    }
}

bvx_status bvxi_walls_mark(bvxi_walls *t)
{
    diagonal_job job = {t->solid, t->places.words, 0};
    BVXI_TRY(bvxi_lost_surface(t->ctx, t->function, t->mesh, t->solid, &t->places,
                               t->unsummed ? NULL : t->beyond));
    for (; job.first < 2; job.first++)
        BVXI_TRY(bvxi_each(t->ctx, "thin", 0.1, 0.1, (t->solid->size[2] + 1 - job.first) / 2,
                           mark_slice_diagonals, &job));
    return BVX_OK;
}

/* ---- What the mesh is like at a centre ---- */

static void unit_normal(const bvxi_walls *t, uint32_t triangle, double n[3])
{
    double p[3][3], length;

    bvxi_view_corners(&t->near, triangle, p);
    length = bvxi_facet_normal((const double(*)[3])p, n);

    /* t->near has corners sorted by place; against: that flipped the triangle, so flip its normal back. An
     * unoriented mesh keeps the side that places give, unless holes require its own. Divided, not multiplied
     * by an inverse, which would round once more. */
    if (t->against[triangle] && (!t->unoriented || t->open == BVXI_WALLS_HOLES)) length = -length;
    if (t->inverted) length = -length;
    for (int a = 0; a < 3; a++) n[a] /= length;
}

/* Nothing of the solid behind a face: half a voxel, three quarters and one deep. */
static int is_nothing_behind(const bvxi_walls *t, const double p[3], const double out[3])
{
    const bvx_grid *const g = t->solid;
    for (int step = 2; step <= 4; step++) {
        double at[3];
        for (int a = 0; a < 3; a++)
            at[a] = (p[a] - out[a] * (0.25 * step) * t->unit - g->lattice.origin[a]) / g->lattice.spacing[a] -
                    g->low[a];
        if (bvxi_grid_at(g, at)) return 0;
    }
    return 1;
}

/* The nearest point to p; unsure: another triangle, too far from the centre for this search, may be nearer. */
static void ask_near(const bvxi_walls *t, const double centre[3], const double p[3], uint32_t *hint,
                     bvx_closest_point *near, bvxi_wall *found)
{
    double const d[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]};

    bvxi_closest_ask(&t->closest, p, hint, near);
    found->unsure |= !(sqrt(bvxi_vec_dot(d, d)) + near->distance <= t->covered);
}

/* The wall behind the point of the mesh next to a centre, seen along out. */
static void look_behind(const bvxi_walls *t, const double centre[3], const bvx_closest_point *front,
                        const double out[3], const double front_normal[3], uint32_t *hint, bvxi_wall *found,
                        bvx_closest_point *back)
{
    double behind[3], back_normal[3], facing, through, apart, square = 0, deep = 0;
    int is_wall;

    for (int a = 0; a < 3; a++) behind[a] = front->position[a] - out[a] * BVXI_WALL_DEPTH * t->unit;
    *back = *front;
    /* a face seen from behind, through a hole */
    if (t->open == BVXI_WALLS_HOLES && bvxi_vec_dot(out, front_normal) < 0) return;

    /* What is nearest to a point BVXI_WALL_DEPTH deep, seen from the front. */
    ask_near(t, centre, behind, hint, back, found);
    unit_normal(t, back->triangle, back_normal);
    for (int a = 0; a < 3; a++) {
        double const d = front->position[a] - back->position[a];
        square += d * d;
        deep += d * out[a];
    }
    apart = sqrt(square) / t->unit;
    deep /= t->unit;
    facing = bvxi_vec_dot(front_normal, back_normal);
    /* at edges normals are of one of their faces */
    through = bvxi_vec_dot(out, front_normal) < 0 ? -bvxi_vec_dot(out, back_normal)
                                                  : bvxi_vec_dot(out, back_normal);
    if (!t->unoriented && through < facing) facing = through;

    /* Facing away from each other: a wall; at one place with nothing behind: a sheet. */
    if (t->unoriented)
        is_wall = bvxi_absolute(facing) > WALL_STRAIGHT && deep > WALL_SAME && deep > WALL_STRAIGHT * apart;
    else is_wall = facing < -WALL_FACING;
    if (is_wall) {
        if (apart <= BVXI_THIN_WALL) found->wall = (float)apart;
    } else if (t->open == BVXI_WALLS_CLOSED && apart <= WALL_SAME &&
               is_nothing_behind(t, front->position, out)) {
        found->wall = 0;
        found->sheet = 1;
    }
}

/* A wall that stands on another part: next to that its face is nearer than the wall's front or back, and
 * hides it. Further out along the face's normal the wall's own faces are the nearest ones; they go on down to
 * the body, so that the centre is as far from the wall as from the plane of its front. Returns 1 when there
 * is such a wall. */
static int look_beside(const bvxi_walls *t, const double centre[3], const double normal[3], uint32_t hint[2],
                       bvxi_wall *found)
{
    for (int step = 1; step <= WALL_STEPS_OUT && !found->unsure; step++) {
        bvxi_wall beside = *found;
        bvx_closest_point front, back;
        double from[3], way[3], n[3], off = 0;

        for (int a = 0; a < 3; a++) from[a] = centre[a] + normal[a] * (WALL_STEP * step) * t->unit;
        ask_near(t, centre, from, &hint[0], &front, found);
        unit_normal(t, front.triangle, n);
        /* The body's face again, or one that goes on from it; further out there may be another. */
        if (bvxi_absolute(bvxi_vec_dot(n, normal)) > WALL_STANDING) continue;

        for (int a = 0; a < 3; a++) {
            off += (centre[a] - front.position[a]) * n[a];
            way[a] = front.distance > 1e-6 * t->unit ? (from[a] - front.position[a]) / front.distance : n[a];
        }
        off = bvxi_absolute(off) / t->unit;
        look_behind(t, centre, &front, way, n, &hint[1], &beside, &back);
        found->unsure |= beside.unsure;
        if (beside.wall == BVXI_NO_WALL || beside.sheet || off >= t->limit) continue;
        /* Even ones: what is rough has places like these without a wall. */
        unit_normal(t, back.triangle, way);
        if (bvxi_absolute(bvxi_vec_dot(n, way)) < WALL_EVEN) continue;
        *found = beside;
        found->distance = (float)off;
        return 1;
    }
    return 0;
}

static void ask_thin_centre(const bvxi_walls *t, uint64_t bit, uint32_t hint[2], bvxi_wall *found)
{
    const bvx_grid *const g = &t->places;
    bvx_closest_point front, back;
    double centre[3], out[3], n[3], side = 0;
    int32_t at[3];

    bvxi_bit_centre(g, bit, at);
    for (int a = 0; a < 3; a++)
        centre[a] = g->lattice.origin[a] + ((double)(g->low[a] + at[a]) + 0.5) * g->lattice.spacing[a];
    found->wall = BVXI_NO_WALL;
    found->sheet = found->unsure = 0;
    ask_near(t, centre, centre, &hint[0], &front, found);
    found->distance = (float)(front.distance / t->unit);
    /* Too far from the mesh to be a place that it lost. */
    if (!(front.distance < t->limit * t->unit)) return;

    unit_normal(t, front.triangle, n);
    /* On the surface the way is that of the normal. */
    for (int a = 0; a < 3; a++)
        out[a] = front.distance > 1e-6 * t->unit ? (centre[a] - front.position[a]) / front.distance : n[a];
    look_behind(t, centre, &front, out, n, &hint[1], found, &back);

    /* Not of bodies with holes: through one the other side of the same face would be one that stands on it. */
    if (!t->parts || t->open != BVXI_WALLS_CLOSED || found->wall != BVXI_NO_WALL) return;
    if (look_beside(t, centre, out, hint, found)) return;
    unit_normal(t, back.triangle, n);
    for (int a = 0; a < 3; a++) side += (centre[a] - back.position[a]) * n[a];
    for (int a = 0; a < 3 && side < 0; a++) n[a] = -n[a];
    look_beside(t, centre, n, hint, found);
}

static void ask_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_walls *const t = user;
    uint32_t hint[2] = {0, 0};
    /* Hints go from place to place: neighbours have near triangles. */
    for (uint64_t n = begin; n < end; n++)
        if (t->point[n].unsure) ask_thin_centre(t, t->at[n], hint, &t->point[n]);
}

/* Those that are unsure, among the triangles of a search for covered about each. */
static bvx_status ask_unsure(bvxi_walls *t, double covered)
{
    uint64_t const pieces = t->count / WALL_GRAIN + 1;

    t->covered = covered;
    t->pieces = pieces < WALL_PIECES ? (int32_t)pieces : WALL_PIECES;
    return bvxi_for_ranges(t->ctx, "thin", 0.0, 1.0, t->pieces, t->count, ask_piece, t);
}

bvx_status bvxi_walls_ask(bvxi_walls *t, double limit)
{
    uint64_t unsure = t->count;

    t->limit = limit;
    for (uint64_t n = 0; n < t->count; n++)
        t->point[n] = (bvxi_wall){.wall = BVXI_NO_WALL, .distance = BVXI_NO_WALL, .unsure = 1};
    if (t->corner != NULL) return ask_unsure(t, HUGE_VAL);

    /* Few triangles are so close that nearly all are sure. Those that are not are the only places of a second look. */
    for (int step = 0; step < 2 && unsure != 0; step++) {
        int const all = step == 1 || !t->parts || t->open != BVXI_WALLS_CLOSED;
        double const reach = step == 0 ? BVXI_WALL_REACH : BVXI_WALL_REACH + BVXI_WALL_BESIDE;

        BVXI_TRY(BVXI_SHARE(t->ctx, 0.5 * step, 0.5 * step, bvxi_walls_near(t, reach)));
        if (t->near.triangle_count != 0)
            BVXI_TRY(BVXI_SHARE(t->ctx, 0.5 * step, 0.5 + 0.5 * step,
                                ask_unsure(t, all ? HUGE_VAL : reach * t->unit)));
        bvxi_walls_forget(t);
        for (uint64_t n = 0; n < t->count; n++) {
            uint64_t const bit = UINT64_C(1) << (t->at[n] & 63);
            if (t->point[n].unsure || (t->places.words[t->at[n] / 64] & bit) == 0) continue;
            t->places.words[t->at[n] / 64] &= ~bit;
            unsure--;
        }
    }
    for (uint64_t n = 0; n < t->count; n++) t->places.words[t->at[n] / 64] |= UINT64_C(1) << (t->at[n] & 63);
    return BVX_OK;
}

/* ---- What is found ---- */

/* The walls of one range of thickness. */
typedef struct wall_range {
    uint64_t count;
    double sum;
} wall_range;

int32_t bvxi_wall_resolution(int32_t longest, double wall)
{
    if (!(wall > 0)) return 0;
    double const needed = (double)longest * BVXI_THIN_WALL / wall;
    /* Finer than any lattice may be. */
    if (!(needed <= (double)(1 << 24))) return 0;
    int32_t const whole = (int32_t)needed;
    return whole < needed ? whole + 1 : whole;
}

void bvxi_walls_report(bvxi_walls *t, bvxi_wall_report *report)
{
    wall_range bins[WALL_BINS] = {{0, 0}};

    memset(report, 0, sizeof *report);
    for (uint64_t n = 0; n < t->count; n++) {
        const bvxi_wall *const p = &t->point[n];
        int32_t at[3];

        /* No wall here: the place is taken out of the grid too. */
        if (p->wall == BVXI_NO_WALL) {
            t->places.words[t->at[n] / 64] &= ~(UINT64_C(1) << (t->at[n] & 63));
            continue;
        }
        int bin = (int)((double)p->wall *
                        (WALL_BINS / BVXI_THIN_WALL)); /* walls are BVXI_THIN_WALL at most */
        bvxi_bit_centre(&t->places, t->at[n], at);

        for (int a = 0; a < 3; a++) {
            if (report->voxels == 0 || at[a] < report->low[a]) report->low[a] = at[a];
            if (report->voxels == 0 || at[a] > report->high[a]) report->high[a] = at[a];
        }

        report->voxels++;
        bins[bin < WALL_BINS ? bin : WALL_BINS - 1].count++;
        bins[bin < WALL_BINS ? bin : WALL_BINS - 1].sum += (double)p->wall;
    }
    /* The wall that a tenth of the places is thinner than: the mean of the range that holds it. */
    uint64_t below = 0;
    int common = 0;
    for (; common + 1 < WALL_BINS; common++) {
        below += bins[common].count;
        if (below * 10 > report->voxels) break;
    }
    report->wall = bins[common].count != 0 ? bins[common].sum / (double)bins[common].count : 0;
}

bvx_status bvxi_walls_open(bvxi_walls *t)
{
    /* Distances are counted in the largest spacing. */
    t->unit = bvxi_largest_spacing(&t->solid->lattice);
    t->places = *t->solid;
    t->places.words = NULL;
    t->bytes = bvxi_grid_words(t->solid) * 8;
    return bvxi_alloc(t->ctx, BVXI_SCRATCH, t->bytes, "the thin places", &t->places.words);
}

void bvxi_walls_forget(bvxi_walls *t)
{
    bvxi_closest_shut(t->ctx, &t->closest);
    bvxi_drop(t->ctx, t->against);
    bvxi_drop(t->ctx, t->corner);
    t->against = NULL;
    t->corner = NULL;
}

void bvxi_walls_close(bvxi_walls *t)
{
    bvxi_walls_forget(t);
    bvxi_walls_drop(t);
    bvxi_drop(t->ctx, t->places.words);
}

bvx_status bvxi_walls_gather(bvxi_walls *t)
{
    /* Places first; most bodies have none, and nothing is searched. */
    BVXI_TRY(bvxi_walls_mark(t));
    BVXI_TRY(bvxi_walls_list(t));
    if (t->count == 0) return BVX_OK;

    /* Only beside holes does it matter which way faces look. */
    if (t->open != BVXI_WALLS_HOLES) return BVX_OK;

    /* Inverted: the body encloses a negative volume about the middle of its triangles. */
    double low[3], high[3], centre[3], volume = 0;
    bvxi_view_used_bounds(t->mesh, low, high);
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * low[a] + 0.5 * high[a];
    for (uint64_t i = 0; i < t->mesh->triangle_count; i++) volume += bvxi_patches_volume(t->mesh, i, centre);
    t->inverted = volume < 0;
    return BVX_OK;
}
