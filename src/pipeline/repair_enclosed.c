/* repair_enclosed.c - which triangles lie on the border of a body that the whole mesh makes: faces of a part that do not touch,
 * triangles torn apart.
 *
 * Source: Jacobson, Kavan, Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding Numbers. 2013.
 *
 * Across a triangle the winding number steps by 1. On a body's border it steps from about 0 to about 1, on a lone sheet from a half
 * below 0 to a half above. So the fraction of it tells, which is the same on either side and that of the sheet over the holes.
 * Guarantee: each answer follows from the snapped triangles alone. */
#include "mesh/view.h"
#include "pipeline/repair.h"

#include <math.h>

#define ENCLOSED_OFF 0.25 /* turns from a whole number */

enum { ENCLOSED_GRAIN = 256, ENCLOSED_PIECES = 1024 };

typedef struct enclosed_job {
    const bvxi_repair_job *job;
    uint8_t *answer;
    int32_t pieces;
} enclosed_job;

/* The lattice's place nearest to the point of a triangle with the given share of corner k, the others sharing the rest. */
static void place_in_triangle(const bvx_lattice *l, const double p[3][3], int k, double share, int64_t place[3])
{
    double const rest = 0.5 * (1.0 - share), one = (double)((int64_t)1 << l->fraction_bits);
    for (int a = 0; a < 3; a++) {
        double const at = p[k][a] * share + (p[(k + 1) % 3][a] + p[(k + 2) % 3][a]) * rest;
        place[a] = (int64_t)floor((at - l->origin[a]) / l->spacing[a] * one + 0.5);
    }
}

static int is_enclosed_at(const bvxi_repair_job *job, const double p[3][3], int k, double share)
{
    int64_t place[3];
    place_in_triangle(&job->lattice, p, k, share, place);
    return bvxi_winding_off(job->winding, place) < ENCLOSED_OFF;
}

/* In the middle, and at one of three places between it and the corners. */
static int is_enclosed(const bvxi_repair_job *job, uint64_t t)
{
    double p[3][3];
    uint32_t c[3];
    int found = 0;
    bvxi_view_triangle(&job->mesh, t, c);
    for (int k = 0; k < 3; k++) bvxi_view_position(&job->mesh, c[k], p[k]);
    if (!is_enclosed_at(job, (const double(*)[3])p, 0, 1.0 / 3)) return 0;
    for (int k = 0; k < 3 && found < 1; k++) found += is_enclosed_at(job, (const double(*)[3])p, k, 2.0 / 3);
    return found != 0;
}

static void ask_triangles(void *user, int32_t piece, int32_t worker)
{
    const enclosed_job *const e = user;
    uint64_t begin, end;
    (void)worker;
    bvxi_piece(e->job->mesh.triangle_count, e->pieces, piece, &begin, &end);
    for (uint64_t t = begin; t < end; t++)
        if (e->answer[t] == BVXI_TRIANGLE_ASKED && is_enclosed(e->job, t)) e->answer[t] = BVXI_TRIANGLE_ENCLOSED;
}

bvx_status bvxi_repair_enclosed(bvxi_repair_job *job, const bvx_mesh_view *by, uint8_t *answer)
{
    uint64_t const pieces = by->triangle_count / ENCLOSED_GRAIN + 1;
    enclosed_job e;
    bvx_status status = bvxi_winding_open(job->ctx, bvxi_repair_name, by, &job->lattice, job->fill, &job->winding);
    e.job = job;
    e.answer = answer;
    e.pieces = pieces < ENCLOSED_PIECES ? (int32_t)pieces : ENCLOSED_PIECES;
    if (status == BVX_OK && job->winding != NULL) status = bvxi_parallel(job->ctx, "sheets", 0.0, 1.0, e.pieces, ask_triangles, &e);
    bvxi_winding_close(job->ctx, job->winding);
    job->winding = NULL;
    return status;
}
