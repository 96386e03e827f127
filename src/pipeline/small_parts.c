/* small_parts.c - small parts of a solid and small cavities: dropped and filled below a size, all but so many
 * of the largest parts, or as crumbs that no mesh has a part for.
 *
 * Acute edges and narrow grooves leave crumbs, where centres lie inside here and there. Guarantee: a part
 * that a piece of a mesh has for itself stays. */
#include "pipeline/steps.h"
#include "components/room.h"
#include "mesh/facet.h"
#include "pipeline/repair.h"

#include <math.h>

/* ---- By size ---- */

/* Parts are connected through faces, cavities through faces too (with marching cubes' face rule SEPARATE a
 * cavity's empty corners may touch beyond; they stay cavities of their own). A space of empty voxels is a
 * cavity when it does not touch the window's sides. */

bvx_status bvxi_keep_large_parts(bvx_context *ctx, const bvx_parts *parts, bvx_grid *inside,
                                 uint64_t *dropped)
{
    bvx_keep_report report;
    bvx_keep_options const keep = {.struct_size = sizeof keep,
                                   .at_least = parts->least_part,
                                   .largest = parts->keep_largest,
                                   .report = &report};
    if (parts->least_part <= 1 && parts->keep_largest == 0) return BVX_OK;
    BVXI_TRY(bvx_grid_keep(ctx, inside, &keep, inside));
    *dropped += report.dropped;
    return BVX_OK;
}

static bvx_status fill_small_cavities(bvxi_repair_job *job)
{
    bvxi_spaces spaces;
    uint64_t gone = 0, *voxels = NULL;
    uint8_t *marks = NULL; /* at a side of the window at first: that is no cavity */

    BVXI_TRY(
        bvxi_spaces_open(job->ctx, bvxi_repair_name, "repair", &job->inside, 1, BVXI_CONNECT_6, &spaces));
    uint64_t const count = spaces.count;
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, count * 8, "the sizes of cavities", &voxels));
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, count, "the marks of cavities", &marks));
    bvxi_spaces_measure(&spaces, voxels, marks);
    for (uint64_t i = 0; i < count; i++) {
        marks[i] = marks[i] == 0 && voxels[i] < job->options->parts.least_cavity;
        gone += marks[i];
    }
    if (gone != 0) bvxi_spaces_flip(&spaces, marks, job->inside.words);
    job->report.cavities_dropped += gone;
    return BVX_OK;
}

bvx_status bvxi_repair_clean(bvxi_repair_job *job)
{
    const bvx_repair_options *const o = job->options;
    bvx_repair_report *const r = &job->report;
    bvxi_crumb_source source = {.mesh = &job->mesh, .piece = job->piece, .known = 1};
    uint64_t crumbs[2] = {0, 0};

    for (int32_t empty = 0; empty < 2 && !o->parts.keep_crumbs; empty++)
        BVXI_TRY(BVXI_SCOPE(job->ctx, bvxi_drop_crumbs(job->ctx, bvxi_repair_name, &job->inside, empty,
                                                       &source, 1, &crumbs[empty])));
    r->crumbs = crumbs[0] + crumbs[1];
    r->parts_dropped = crumbs[0];
    r->cavities_dropped = crumbs[1];

    /* Parts before cavities: one that goes may have had cavities of its own. */
    BVXI_TRY(bvxi_keep_large_parts(job->ctx, &o->parts, &job->inside, &r->parts_dropped));
    return o->parts.least_cavity > 1 ? BVXI_SCOPE(job->ctx, fill_small_cavities(job)) : BVX_OK;
}

/* ---- Crumbs ---- */

/* Where a body runs out in an acute edge, thinner than a voxel, centres lie inside here and there: parts of a
 * few voxels float beside the body. In a narrow groove pockets are left in the same way. Such a part is
 * small, and it has no core, no voxel with six neighbours of its own. A small part of the mesh looks the
 * same, so the mesh is asked: the piece that is nearest to the part belongs to something larger where behind
 * most of its triangles there are voxels that are not of small parts; else the largest of its small parts is
 * the piece itself, and stays.
 * Guarantee: the answer follows from geometry, whatever the order of triangles, but where parts of one piece
 * have equally many voxels. */

/* What a crumb has at most: so many voxels, or this share of all. */
enum { CRUMB_VOXELS = 64 };
#define CRUMB_SHARE  1e-3
#define CRUMB_AROUND 20.0 /* of a mesh is looked at first [Units: largest spacings] */

/* What is known of a piece, by its least vertex. */
typedef struct crumb_piece {
    uint32_t asked;        /* 1: a part is nearest to it */
    uint32_t large, small; /* triangles before voxels of large parts, as far as counted, and of small ones */
    uint32_t best;         /* 1 + the small part of most voxels among those that are nearest to the piece */
} crumb_piece;

typedef struct crumb_part {
    uint64_t voxels;
    int32_t at[3];   /* its first voxel */
    uint32_t source; /* the nearest mesh and its piece; small parts only */
    uint32_t piece;
    uint8_t outside, core, small, dropped;
} crumb_part;

typedef struct crumb_job {
    bvx_context *ctx;
    const char *function;
    bvx_grid *inside;
    int32_t empty, sources;
    bvxi_crumb_source *source;
    bvxi_spaces spaces;
    crumb_part *part; /* [Size: spaces.count] */
    uint64_t small_parts;
    bvx_grid small; /* voxels of small parts */
    uint64_t grid_bytes;
    crumb_piece *piece[BVXI_CRUMB_SOURCES];   /* [Size: the mesh's vertices] */
    bvx_mesh_view around[BVXI_CRUMB_SOURCES]; /* the triangles whose pieces are known: near ones, or all */
    uint64_t before[BVXI_CRUMB_SOURCES];      /* triangles before small parts */
} crumb_job;

/* ---- Parts ---- */

static uint64_t crumb_word(const crumb_job *job, int32_t k, int32_t y, int32_t z)
{
    const bvx_grid *const g = job->inside;
    if (k < 0 || y < 0 || z < 0 || k >= g->words_per_row || y >= g->size[1] || z >= g->size[2]) return 0;
    uint64_t const w = bvxi_grid_row(g, y, z)[k];
    return job->empty ? ~w : w;
}

static void measure_crumb_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    crumb_job *const job = user;
    crumb_part *const p = &job->part[space];

    if (p->voxels == 0) {
        p->at[0] = begin;
        p->at[1] = y;
        p->at[2] = z;
    }
    p->voxels += (uint64_t)(end - begin);
    /* What touches the window's side is no pocket. */
    if (job->empty && bvxi_spaces_at_side(job->inside, begin, end, y, z)) p->outside = 1;

    for (int32_t k = begin >> 6; k <= (end - 1) >> 6 && !p->core; k++) {
        /* Voxels of a word with all six neighbours. */
        uint64_t const w = crumb_word(job, k, y, z);
        uint64_t const left = w << 1 | crumb_word(job, k - 1, y, z) >> 63;
        uint64_t const right = w >> 1 | crumb_word(job, k + 1, y, z) << 63;

        p->core = ((w & left & right & crumb_word(job, k, y - 1, z) & crumb_word(job, k, y + 1, z) &
                    crumb_word(job, k, y, z - 1) & crumb_word(job, k, y, z + 1)) &
                   bvxi_run_mask(begin, end, k)) != 0;
    }
}

static void mark_small_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    crumb_job *const job = user;
    uint64_t *const row = bvxi_grid_row(&job->small, y, z);
    if (!job->part[space].small) return;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] |= bvxi_run_mask(begin, end, k);
}

/* ---- What the meshes have there ---- */

/* The voxel on either side of a triangle's middle that is of a part. 0: none, 1: of a large part, 2: of a small one. */
static int crumb_beside(const crumb_job *job, const double p[3][3])
{
    static const double depth[4] = {-0.5, 0.5, -1.0, 1.0};
    const bvx_lattice *const l = &job->inside->lattice;
    double const h = bvxi_largest_spacing(l);
    double n[3], length = bvxi_facet_normal(p, n);

    if (!(length > 0)) return 0;
    for (int d = 0; d < 4; d++) {
        double at[3];
        for (int a = 0; a < 3; a++)
            at[a] = ((p[0][a] + p[1][a] + p[2][a]) / 3.0 + n[a] / length * depth[d] * h - l->origin[a]) /
                        l->spacing[a] -
                    (double)job->inside->low[a];
        if (bvxi_grid_at(job->inside, at) != (job->empty != 0)) return bvxi_grid_at(&job->small, at) ? 2 : 1;
    }
    return 0;
}

bvx_status bvxi_know_pieces(bvx_context *ctx, bvxi_crumb_source *source)
{
    /* A vertex of each place stands for all that are there. */
    uint32_t *representative;
    uint64_t different;

    if (source->known) return BVX_OK;
    if (source->piece == NULL)
        BVXI_TRY(BVXI_ARRAY(ctx, source->mesh->vertex_count, "a mesh's pieces", source->piece));
    BVXI_TRY(BVXI_ARRAY(ctx, source->mesh->vertex_count, "the vertices' places", representative));
    BVXI_TRY(bvxi_weld(ctx, source->mesh, representative, &different));
    bvxi_pieces(source->mesh, representative, source->piece);
    bvxi_drop(ctx, representative);
    source->known = 1;
    return BVX_OK;
}

/* Count the triangles before voxels of large parts, of each piece that parts are nearest to, until they are more than
 * those before small ones. Returns how many pieces are not decided. */
static uint64_t count_large(crumb_job *job, int32_t s, int around)
{
    const bvx_mesh_view *const mesh = &job->around[s];
    /* Triangles before small parts of all other pieces, which may be one with these beyond what is known. */
    uint64_t other = around ? job->before[s] : 0;
    uint64_t open = 0; /* pieces that are not decided */

    for (uint64_t n = 0; n < job->spaces.count; n++) {
        const crumb_part *const p = &job->part[n];
        if (!p->small || p->source != (uint32_t)s || job->piece[s][p->piece].asked) continue;
        job->piece[s][p->piece].asked = 1;
        if (around) other -= job->piece[s][p->piece].small;
        open++;
    }
    for (uint64_t t = 0; t < mesh->triangle_count && open != 0; t++) {
        double p[3][3];
        uint32_t v[3];

        bvxi_view_triangle(mesh, t, v);
        /* By the piece of the first corner, as all three are of one. */
        crumb_piece *const piece = &job->piece[s][job->source[s].piece[v[0]]];
        if (!piece->asked || piece->large > piece->small + other) continue;
        for (int k = 0; k < 3; k++) bvxi_view_position(mesh, v[k], p[k]);
        piece->large += crumb_beside(job, (const double(*)[3])p) == 1;
        open -= piece->large > piece->small + other;
    }
    return open;
}

/* Of the small parts whose distance is not known yet to be within reach: the piece of some of a mesh's triangles that
 * is nearest to the first voxel. distance has that of what is known already. */
static bvx_status find_nearest_pieces(crumb_job *job, int32_t s, const bvx_mesh_view *triangles, double reach,
                                      double *distance)
{
    double low[3], high[3];
    bvx_closest closest;
    uint32_t hint = 0;

    if (triangles->triangle_count == 0) return BVX_OK;
    bvxi_view_used_bounds(triangles, low, high);
    BVXI_TRY(bvxi_closest_build(bvxi_call_of(job->ctx, job->function, "crumbs", 0.0, 1.0), triangles, low,
                                high, bvxi_unit_scale(low, high), &closest.tree));
    /* Parts in their order: the hint of one serves the next. */
    for (uint64_t n = 0; n < job->spaces.count; n++) {
        const bvx_lattice *const l = &job->inside->lattice;
        crumb_part *const p = &job->part[n];
        bvx_closest_point found;
        double centre[3];
        uint32_t v[3];

        if (!p->small || distance[n] <= reach) continue;
        for (int a = 0; a < 3; a++)
            centre[a] = l->origin[a] + ((double)(job->inside->low[a] + p->at[a]) + 0.5) * l->spacing[a];
        bvxi_closest_ask(&closest, centre, &hint, &found);
        /* Of two meshes the nearer one decides. */
        if (!(found.distance < distance[n])) continue;
        distance[n] = found.distance;
        bvxi_view_triangle(triangles, found.triangle, v);
        p->source = (uint32_t)s;
        p->piece = job->source[s].piece[v[0]];
    }
    bvxi_closest_shut(job->ctx, &closest);
    return BVX_OK;
}

/* *far: how many parts are not within reach of what is around them; with pieces of that only they are not asked. */
static bvx_status ask_meshes(crumb_job *job, int around, uint64_t *far)
{
    double const reach = 2.0 * bvxi_largest_spacing(&job->inside->lattice);
    double *distance;

    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->spaces.count * 8, "the parts' distances", &distance));
    for (uint64_t n = 0; n < job->spaces.count; n++) distance[n] = HUGE_VAL;

    /* Among the triangles beside small parts: nearly every part has its piece there, and what lies within
     * reach is nearer than all that is not there. What crumb_beside looks at is within reach, too, so all
     * before small parts are counted. */
    for (int32_t s = 0; s < job->sources; s++) {
        bvx_mesh_view near;
        uint32_t *corner;

        BVXI_TRY(bvxi_triangles_near(job->ctx, job->source[s].mesh, job->source[s].cells, &job->small, reach,
                                     0, &near, &corner));
        BVXI_TRY(find_nearest_pieces(job, s, &near, -1.0, distance));
        for (uint64_t t = 0; t < near.triangle_count; t++) {
            double p[3][3];

            for (int k = 0; k < 3; k++) bvxi_view_position(&near, corner[3 * t + (uint64_t)k], p[k]);
            crumb_piece *const piece = &job->piece[s][job->source[s].piece[corner[3 * t]]];
            uint32_t const small = crumb_beside(job, (const double(*)[3])p) == 2;
            piece->small += small;
            job->before[s] += small;
        }
        bvxi_drop(job->ctx, corner);
    }

    for (uint64_t n = 0; n < job->spaces.count; n++) {
        int const is_far = job->part[n].small && !(distance[n] <= reach);
        if (is_far) distance[n] = HUGE_VAL;
        *far += (uint64_t)is_far;
    }
    for (int32_t s = 0; s < job->sources && *far != 0 && !around; s++)
        BVXI_TRY(find_nearest_pieces(job, s, job->source[s].mesh, reach, distance));
    bvxi_drop(job->ctx, distance);
    return BVX_OK;
}

/* ---- The answer ---- */

static void flip_crumb_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    crumb_job *const job = user;
    uint64_t *const row = bvxi_grid_row(job->inside, y, z);
    if (!job->part[space].dropped) return;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] ^= bvxi_run_mask(begin, end, k);
}

/* By what is around small parts, or by whole pieces. *open: how many parts or pieces are not decided. */
static bvx_status look_at_pieces(crumb_job *job, int around, uint64_t *open)
{
    uint64_t far = 0;

    for (int32_t s = 0; s < job->sources; s++) {
        job->around[s] = *job->source[s].mesh;
        job->before[s] = 0;

        if (around) {
            /* Pieces of the triangles around small parts alone: each is of one piece of the mesh, which may have
             * more. */
            double const reach = CRUMB_AROUND * bvxi_largest_spacing(&job->inside->lattice);
            bvxi_crumb_source *const source = &job->source[s];
            uint32_t *const piece = source->piece, *corner;

            BVXI_TRY(bvxi_triangles_near(job->ctx, source->mesh, source->cells, &job->small, reach, 0,
                                         &job->around[s], &corner));
            uint64_t const count = 3 * job->around[s].triangle_count;
            for (uint64_t i = 0; i < count; i++) piece[corner[i]] = corner[i];
            for (uint64_t i = 1; i < count; i++)
                if (i % 3 != 0) bvxi_join(piece, corner[i - 1], corner[i]);
            for (uint64_t i = 0; i < count; i++) piece[corner[i]] = bvxi_root(piece, corner[i]);
        } else BVXI_TRY(bvxi_know_pieces(job->ctx, &job->source[s]));
        memset(job->piece[s], 0, (size_t)job->source[s].mesh->vertex_count * sizeof *job->piece[s]);
    }
    BVXI_TRY(ask_meshes(job, around, &far));
    *open = around ? far : 0;
    for (int32_t s = 0; s < job->sources && (!around || far == 0); s++) *open += count_large(job, s, around);
    return BVX_OK;
}

static bvx_status judge_small_parts(crumb_job *job, uint64_t *dropped)
{
    uint64_t open = 1;

    /* A grid of the small parts alone, by which triangles are judged. */
    job->small = *job->inside;
    job->small.words = NULL;
    job->grid_bytes = (uint64_t)bvxi_grid_rows(job->inside) * (uint64_t)job->inside->words_per_row * 8;
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, job->grid_bytes, "the small parts", &job->small.words));
    for (int32_t s = 0; s < job->sources; s++)
        BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->source[s].mesh->vertex_count * sizeof *job->piece[s],
                            "the meshes' pieces", &job->piece[s]));
    bvxi_spaces_each(&job->spaces, mark_small_run, job);
    /* Nearly all small parts are beside something larger, which shows at once: all are crumbs then. */
    if (!job->source[0].known && job->source[0].cells != NULL)
        BVXI_TRY(BVXI_SCOPE(job->ctx, look_at_pieces(job, 1, &open)));
    if (open != 0) BVXI_TRY(look_at_pieces(job, 0, &open));
    for (uint64_t n = 0; n < job->spaces.count; n++) {
        const crumb_part *const p = &job->part[n];
        if (!p->small) continue;
        crumb_piece *const piece = &job->piece[p->source][p->piece];
        if (piece->best == 0 || p->voxels > job->part[piece->best - 1].voxels) piece->best = (uint32_t)n + 1;
    }
    for (uint64_t n = 0; n < job->spaces.count; n++) {
        crumb_part *const p = &job->part[n];
        if (!p->small) continue;
        const crumb_piece *const piece = &job->piece[p->source][p->piece];
        /* A piece of something larger, or not its largest part: a crumb. */
        p->dropped = piece->large > piece->small || piece->best != (uint32_t)n + 1;
        *dropped += p->dropped;
    }
    /* Only now bits change: all was judged by the solid as it was. */
    if (*dropped != 0) bvxi_spaces_each(&job->spaces, flip_crumb_run, job);
    return BVX_OK;
}

bvx_status bvxi_drop_crumbs(bvx_context *ctx, const char *function, bvx_grid *inside, int32_t empty,
                            bvxi_crumb_source *source, int32_t sources, uint64_t *dropped)
{
    crumb_job job = {.ctx = ctx,
                     .function = function,
                     .inside = inside,
                     .empty = empty,
                     .sources = sources,
                     .source = source};

    *dropped = 0;
    BVXI_TRY(bvxi_spaces_open(ctx, function, "crumbs", inside, empty, BVXI_CONNECT_6, &job.spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, job.spaces.count * sizeof *job.part, "the parts", &job.part));
    if (job.spaces.count > 1) {
        uint64_t total = 0, most;

        bvxi_spaces_each(&job.spaces, measure_crumb_run, &job);
        for (uint64_t n = 0; n < job.spaces.count; n++)
            if (!job.part[n].outside) total += job.part[n].voxels;

        /* Small is a share of all, but a few voxels at least. */
        most = (uint64_t)(CRUMB_SHARE * (double)total);
        if (most < CRUMB_VOXELS) most = CRUMB_VOXELS;

        for (uint64_t n = 0; n < job.spaces.count; n++) {
            crumb_part *const p = &job.part[n];
            p->small = !p->outside && !p->core && p->voxels <= most;
            job.small_parts += p->small;
        }
    }
    return job.small_parts != 0 ? judge_small_parts(&job, dropped) : BVX_OK;
}
