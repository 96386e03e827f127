/* bodies_apart.c - how many bodies the pieces of a closed mesh make: those that cross, touch or lie in one another
 * are one. A result with fewer parts has lost some, or has closed a gap between them.
 *
 * Guarantee: exact for pieces without boundary, up to a ray through an edge; of more than MOST_PIECES none is
 * counted. */
#include "mesh/cross.h"
#include "mesh/view.h"
#include "nearest/closest.h"
#include "pipeline/steps.h"

enum {
    MOST_PIECES = 1024, /* pairs of boxes beyond these would take long */
    MOST_RAYS = 1 << 24 /* times triangles; boxes alone decide beyond */
};

typedef struct apart_piece {
    double low[3], high[3];
    uint32_t vertex; /* one of it */
} apart_piece;

typedef struct apart_job {
    const bvx_mesh_view *mesh;
    uint32_t *group;  /* of each vertex, to be joined */
    uint32_t *number; /* of each vertex: its piece's, from 1 on */
    uint32_t count;
    uint64_t bodies;
    apart_piece piece[MOST_PIECES];
    uint8_t odd[MOST_PIECES]; /* 1: a ray crosses the piece an odd number of times */
} apart_job;

static int holds_box(const apart_piece *a, const apart_piece *b)
{
    for (int k = 0; k < 3; k++)
        if (a->low[k] > b->low[k] || a->high[k] < b->high[k]) return 0;
    return a != b;
}

/* 0: there are too many pieces. */
static int list_pieces(apart_job *job)
{
    for (uint64_t t = 0; t < job->mesh->triangle_count; t++) {
        uint32_t c[3], *n;

        bvxi_view_triangle(job->mesh, t, c);
        n = &job->number[job->group[c[0]]];
        if (*n == 0) {
            if (job->count == MOST_PIECES) return 0;
            job->piece[job->count] = (apart_piece){{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}, c[0]};
            *n = ++job->count;
        }
        for (int k = 0; k < 3; k++) {
            apart_piece *const b = &job->piece[*n - 1];
            double p[3];

            bvxi_view_position(job->mesh, c[k], p);
            for (int a = 0; a < 3; a++) {
                b->low[a] = p[a] < b->low[a] ? p[a] : b->low[a];
                b->high[a] = p[a] > b->high[a] ? p[a] : b->high[a];
            }
        }
    }
    for (uint64_t v = 0; v < job->mesh->vertex_count; v++) job->number[v] = job->number[job->group[v]];
    return 1;
}

/* Which pieces a ray from a vertex of one crosses an odd number of times, of those whose boxes hold it. */
static void cast_from(apart_job *job, const apart_piece *from, const double beyond[3])
{
    double p[3], q[3][3];
    const double *const ray[3] = {p, beyond, beyond}, *const triangle[3] = {q[0], q[1], q[2]};

    memset(job->odd, 0, sizeof job->odd);
    bvxi_view_position(job->mesh, from->vertex, p);
    for (uint64_t t = 0; t < job->mesh->triangle_count; t++) {
        uint32_t c[3], n;

        bvxi_view_triangle(job->mesh, t, c);
        n = job->number[c[0]] - 1;
        if (!holds_box(&job->piece[n], from)) continue;
        for (int k = 0; k < 3; k++) bvxi_view_position(job->mesh, c[k], q[k]);
        job->odd[n] ^= (uint8_t)bvxi_triangles_cross(triangle, ray);
    }
}

static void join_enclosed(apart_job *job, const double low[3], const double high[3])
{
    static const double aslant[3] = {0.3719, 0.6131, 0.2357}; /* along no face that is modelled */
    uint64_t rays = 0;
    double beyond[3];
    int by_rays;

    for (int a = 0; a < 3; a++) beyond[a] = high[a] + aslant[a] * (high[a] - low[a]);
    for (uint32_t i = 0; i < job->count; i++)
        for (uint32_t k = 0, held = 0; k < job->count && !held; k++)
            rays += held = (uint32_t)holds_box(&job->piece[k], &job->piece[i]);
    by_rays = rays * job->mesh->triangle_count <= MOST_RAYS;
    for (uint32_t i = 0; i < job->count; i++)
        for (uint32_t k = 0, cast = 0; k < job->count; k++) {
            if (!holds_box(&job->piece[k], &job->piece[i])) continue;
            if (by_rays && !cast) cast_from(job, &job->piece[i], beyond), cast = 1;
            if (!by_rays || job->odd[k])
                job->bodies -= (uint64_t)bvxi_join(job->group, job->piece[i].vertex, job->piece[k].vertex);
        }
}

static bvx_status join_crossing(bvx_context *ctx, const char *function, apart_job *job,
                                const bvxi_welded *welded)
{
    uint64_t pairs = 0;
    uint32_t *pair, a[3], b[3];

    BVXI_TRY(bvxi_mesh_crossings(ctx, function, welded, &pairs, NULL, 0));
    if (pairs == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, pairs * 8, "the crossing triangles", &pair));
    BVXI_TRY(bvxi_mesh_crossings(ctx, function, welded, &pairs, pair, pairs));
    for (uint64_t i = 0; i < pairs; i++) {
        bvxi_view_triangle(welded->view, pair[2 * i], a);
        bvxi_view_triangle(welded->view, pair[2 * i + 1], b);
        job->bodies -= (uint64_t)bvxi_join(job->group, a[0], b[0]);
    }
    return BVX_OK;
}

bvx_status bvxi_bodies_apart(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             uint64_t *bodies)
{
    uint64_t const bytes = mesh->vertex_count * 4;
    bvxi_welded welded = {.view = mesh};
    uint32_t *representative;
    apart_job *job;

    *bodies = 0;
    bvxi_view_used_bounds(mesh, welded.low, welded.high);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *job, "the boxes of the pieces", &job));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' places", &representative));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' pieces", &job->group));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the pieces' numbers", &job->number));
    BVXI_TRY(bvxi_weld(ctx, mesh, representative, &welded.different));
    welded.representative = representative;
    bvxi_pieces(mesh, representative, job->group);
    job->mesh = mesh;
    if (!list_pieces(job)) return BVX_OK;
    job->bodies = job->count;
    join_enclosed(job, welded.low, welded.high);
    BVXI_TRY(join_crossing(ctx, function, job, &welded));
    *bodies = job->bodies;
    return BVX_OK;
}
