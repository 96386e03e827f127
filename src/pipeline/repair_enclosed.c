/* repair_enclosed.c - which triangles lie on the border of a body that the whole mesh makes: faces of a part
 * that do not touch, triangles torn apart.
 *
 * Source: Jacobson, Kavan, Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding
 * Numbers. 2013.
 *
 * Across a triangle the winding number steps by 1. On a body's border it steps from about 0 to about 1, on a
 * lone sheet from a half below 0 to a half above. So the fraction of it tells, which is the same on either
 * side and that of the sheet over the holes.
 * Guarantee: each answer follows from the snapped triangles only. */
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

/* Is the winding number nearly whole at a point of the triangle's normal through its middle? */
static int is_whole_off(const bvxi_repair_job *job, const double middle[3], const double normal[3],
                        double off)
{
    const bvx_lattice *const l = &job->lattice;
    double const one = (double)((int64_t)1 << l->fraction_bits);
    int64_t place[3];
    /* The place in fixed point, as winding numbers take it. */
    for (int a = 0; a < 3; a++)
        place[a] = (int64_t)floor((middle[a] + normal[a] * off - l->origin[a]) / l->spacing[a] * one + 0.5);
    return bvxi_winding_off(job->winding, place) < ENCLOSED_OFF;
}

/* Half a voxel off on both sides: nearer, the gaps between torn triangles would show. */
static int is_enclosed(const bvxi_repair_job *job, uint64_t t)
{
    double const off = 0.5 * bvxi_largest_spacing(&job->lattice);
    double p[3][3], middle[3], n[3], length = 0;
    uint32_t c[3];

    bvxi_view_triangle(&job->mesh, t, c);
    for (int k = 0; k < 3; k++) bvxi_view_position(&job->mesh, c[k], p[k]);

    /* The middle and the normal; half a voxel off on both sides. */
    for (int a = 0; a < 3; a++) {
        int const i = (a + 1) % 3, j = (a + 2) % 3;
        middle[a] = (p[0][a] + p[1][a] + p[2][a]) / 3.0;
        n[a] = (p[1][i] - p[0][i]) * (p[2][j] - p[0][j]) - (p[1][j] - p[0][j]) * (p[2][i] - p[0][i]);
        length += n[a] * n[a];
    }
    length = sqrt(length);
    if (!(length > 0)) return 0;
    for (int a = 0; a < 3; a++) n[a] /= length;
    return is_whole_off(job, middle, n, -off) && is_whole_off(job, middle, n, off);
}

static void ask_triangles(void *user, int32_t piece, int32_t worker)
{
    const enclosed_job *const e = user;
    uint64_t begin, end;
    (void)worker;
    bvxi_piece(e->job->mesh.triangle_count, e->pieces, piece, &begin, &end);
    /* Only triangles that are asked about. */
    for (uint64_t t = begin; t < end; t++)
        if (e->answer[t] == BVXI_TRIANGLE_ASKED && is_enclosed(e->job, t))
            e->answer[t] = BVXI_TRIANGLE_ENCLOSED;
}

bvx_status bvxi_repair_enclosed(bvxi_repair_job *job, uint8_t *answer)
{
    const bvx_mesh_view *const by = &job->body;
    int const parted = job->sheets.triangle_count != 0;
    uint64_t const pieces = by->triangle_count / ENCLOSED_GRAIN + 1;
    bvxi_holes of_body;
    enclosed_job e;
    bvx_status status;

    /* Sheets are left out of the body, so its holes are others. */
    if (parted)
        BVXI_TRY(bvxi_holes_open_rule(job->ctx, bvxi_repair_name, by, &job->lattice, job->fill, &of_body));
    status = bvxi_winding_open(job->ctx, bvxi_repair_name, by, &job->lattice, job->fill,
                               parted ? &of_body : &job->holes, &job->winding);
    e.job = job;
    e.answer = answer;
    e.pieces = pieces < ENCLOSED_PIECES ? (int32_t)pieces : ENCLOSED_PIECES;
    /* No winding number where there is no body. */
    if (status == BVX_OK && job->winding != NULL)
        status = bvxi_parallel(job->ctx, "sheets", 0.0, 1.0, e.pieces, ask_triangles, &e);
    bvxi_winding_close(job->ctx, job->winding);
    job->winding = NULL;
    if (parted) bvxi_holes_close(job->ctx, &of_body);
    return status;
}
