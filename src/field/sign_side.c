/* sign_side.c - on which side of its closest feature a centre lies.
 *
 * The closest point of the triangle is computed once more, in doubles, whatever type the field's values have;
 * a centre is inside when the outwards direction there points away from it. Square to the direction, or
 * without one, it is outside. A centre on the surface counts as moved by (e_x, e_y, e_z), e_x >> e_y >> e_z >
 * 0: on faces that is what the solid's rules do; on edges and corners the moved centre would have another
 * feature, and the direction alone decides. */
#include "field/room.h"
#include "field/signs.h"
#include "nearest/closest.h"
#include "mesh/view.h"

enum { SIDE_GRAIN = 1 << 10 /* values of the smallest task, about */ };

typedef struct side_job {
    const bvx_mesh_view *mesh;
    const bvxi_sparse *band;
    bvxi_outwards_fn *outwards;
    const void *rule;
    bvx_grid *inside;
    double scale; /* power of two that brings mesh and window into [-1, 1] */
    int32_t pieces;
} side_job;

static int is_rounding(double v)
{
    return v < 0x1p-40 && v > -0x1p-40;
}

/* away: from the closest point to the centre, where mesh and window lie within [-1, 1]. */
static int is_behind(const double outwards[3], const double away[3])
{
    double const along = outwards[0] * away[0] + outwards[1] * away[1] + outwards[2] * away[2];
    /* On the surface, as far as doubles know: the side that the moved centre lies on decides. */
    if (along != 0.0 || !is_rounding(away[0]) || !is_rounding(away[1]) || !is_rounding(away[2]))
        return along < 0.0;
    if (outwards[0] != 0.0) return outwards[0] < 0.0;
    return outwards[1] != 0.0 ? outwards[1] < 0.0 : outwards[2] < 0.0;
}

static int side_of(const side_job *job, int32_t x, int32_t y, int32_t z, uint64_t value)
{
    const bvx_mesh_view *const mesh = job->mesh;
    uint32_t const triangle = job->band->triangles[value];
    double p[3], t[3][3], q[3], away[3], outwards[3] = {0.0, 0.0, 0.0};
    uint32_t c[3];

    bvxi_field_centre(&job->band->where, x, y, z, p);
    bvxi_view_triangle(mesh, triangle, c);
    for (int k = 0; k < 3; k++) {
        p[k] *= job->scale;
        bvxi_view_position(mesh, c[k], t[k]);
        for (int a = 0; a < 3; a++) t[k][a] *= job->scale;
    }
    bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
    /* From the closest point to the centre, in the scaled world. */
    for (int a = 0; a < 3; a++) away[a] = p[a] - q[a];
    job->outwards(job->rule, triangle, job->band->features[value], outwards);
    return is_behind(outwards, away);
}

static void decide_sides(void *user, int32_t piece, int32_t worker)
{
    const side_job *const job = user;
    const bvx_grid *const g = &job->band->where;
    uint64_t row, end;

    (void)worker;
    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++) {
        uint64_t const at = row * (uint64_t)g->words_per_row;
        int32_t const y = (int32_t)(row % (uint64_t)g->size[1]), z = (int32_t)(row / (uint64_t)g->size[1]);
        uint64_t value = job->band->first[row];
        for (int32_t k = 0; k < g->words_per_row; k++) {
            uint64_t set = 0;
            /* Values lie in the order of the bits. */
            for (uint64_t left = g->words[at + (uint64_t)k]; left != 0; left &= left - 1, value++) {
                int32_t const bit = bvxi_lowest(left);
                if (side_of(job, k * BVXI_WORD_BITS + bit, y, z, value)) set |= UINT64_C(1) << bit;
            }
            job->inside->words[at + (uint64_t)k] = set;
        }
    }
}

static bvx_status side_scale(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_grid *g, double *scale)
{
    double low[3], high[3], first[3], last[3];

    BVXI_TRY(bvxi_view_bounds(ctx, function, mesh, low, high));
    bvxi_field_centre(g, 0, 0, 0, first);
    bvxi_field_centre(g, g->size[0] - 1, g->size[1] - 1, g->size[2] - 1, last);

    /* Centres may lie outside the mesh's bounds. */
    for (int a = 0; a < 3; a++) {
        low[a] = first[a] < low[a] ? first[a] : low[a];
        high[a] = last[a] > high[a] ? last[a] : high[a];
    }
    *scale = bvxi_unit_scale(low, high);
    return BVX_OK;
}

bvx_status bvxi_sign_side(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                          bvxi_outwards_fn *outwards, const void *rule, bvx_grid *inside)
{
    uint64_t const rows = bvxi_grid_rows(&band->where), each = band->count / rows;
    side_job job;

    job.mesh = mesh;
    job.band = band;
    job.outwards = outwards;
    job.rule = rule;
    job.inside = inside;
    BVXI_TRY(side_scale(call.ctx, call.function, mesh, &band->where, &job.scale));
    job.pieces = bvxi_piece_count(rows, 1 + SIDE_GRAIN / (1 + each));
    return bvxi_parallel(call.ctx, call.stage, call.from, call.to, job.pieces, decide_sides, &job);
}
