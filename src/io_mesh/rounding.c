/* rounding.c - what the numbers of a file leave of a mesh.
 *
 * STL and GLB hold 32-bit floats, a quantized GLB whole steps. Coordinates of a map projection are some
 * millions, and the floats there lie half a unit apart: a mesh of finer triangles becomes a heap of points that
 * are equal, with no word of it in the file. So what rounding does is measured before such a file is written:
 * how far it moves a coordinate, beside the mean length of edges, and how many triangles lose their area or are
 * turned over. */
#include "io_mesh/mesh_formats.h"
#include "mesh/facet.h"
#include "mesh/view.h"

#define ROUNDING_SHARE 16.0 /* of a mean edge that a coordinate may move by: triangles turn by some degrees */

enum { ROUNDING_SPOILT = 20 }; /* one triangle in so many may be spoilt: slivers are so in any mesh */

int bvxi_is_rounded(const bvx_mesh *mesh, int32_t format, const bvxi_file_frame *frame)
{
    if (format != BVX_FORMAT_STL && format != BVX_FORMAT_GLB) return 0;
    for (int a = 0; a < 3; a++)
        if (frame->origin[a] != 0.0) return 1;
    return frame->step > 0.0 || !bvxi_writes_f32(mesh);
}

bvx_status bvxi_find_frame(bvx_context *ctx, const bvx_mesh *levels, uint64_t level_count, int32_t format,
                           int32_t quantize, bvxi_file_frame *frame)
{
    double low[3] = {0.0, 0.0, 0.0}, high[3] = {0.0, 0.0, 0.0};
    int floats = 1;

    memset(frame, 0, sizeof *frame);
    for (uint64_t l = 0; l < level_count; l++) floats &= bvxi_writes_f32(&levels[l]);
    if (format != BVX_FORMAT_GLB || (floats && !quantize)) return BVX_OK;

    /* The bounds of all levels: each has a frame of its own, so they are compared in the world. */
    for (uint64_t l = 0; l < level_count; l++) {
        double from[3], to[3];
        bvx_mesh_view view;

        bvx_mesh_view_of(&levels[l], &view);
        BVXI_TRY(bvxi_view_bounds(ctx, "GLB", &view, from, to));
        for (int a = 0; a < 3; a++) {
            double const begin = from[a] + levels[l].frame[a], end = to[a] + levels[l].frame[a];
            if (l == 0 || begin < low[a]) low[a] = begin;
            if (l == 0 || end > high[a]) high[a] = end;
        }
    }

    /* One step for all axes: a scale that differs would bend normals. */
    for (int a = 0; a < 3 && quantize; a++) {
        double const step = high[a] / BVXI_STEPS - low[a] / BVXI_STEPS;
        if (step > frame->step) frame->step = step;
    }
    if (quantize && frame->step == 0.0) frame->step = 1.0;
    /* Halved before they are added: the sum of two large bounds might overflow. */
    for (int a = 0; a < 3; a++) frame->origin[a] = quantize ? low[a] : low[a] * 0.5 + high[a] * 0.5;
    return BVX_OK;
}

/* ---- measure ---- */

void bvxi_measure_rounding(const bvx_mesh *mesh, const bvxi_file_frame *frame, bvxi_rounding *r)
{
    double exact[3][3], rounded[3][3], edges = 0.0;

    memset(r, 0, sizeof *r);
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            bvxi_world_position(mesh, mesh->triangles[(size_t)t * 3 + (size_t)k], exact[k]);
            bvxi_round_position(frame, exact[k], rounded[k]);
            /* A difference that is infinite or NaN ends the
             * measure: finite stays 0, which callers check first. */
            for (int a = 0; a < 3; a++) {
                double const move = rounded[k][a] > exact[k][a] ? rounded[k][a] - exact[k][a]
                                                                : exact[k][a] - rounded[k][a];
                if (!(move - move == 0.0)) return;
                if (move > r->largest_move) r->largest_move = move;
            }
        }
        double sum = 0.0, before[3], after[3];
        for (int k = 0; k < 3; k++) sum += sqrt(bvxi_vec_distance2(exact[k], exact[(k + 1) % 3]));
        edges += sum;
        /* Spoilt: a triangle with an area has none after rounding, or looks the other way. */
        bvxi_facet_cross((const double(*)[3])exact, before);
        bvxi_facet_cross((const double(*)[3])rounded, after);
        r->spoilt += !bvxi_vec_is_zero(before) && !(bvxi_vec_dot(before, after) > 0.0);
    }

    /* An edge counts once for each of its triangles: a mean needs no table of edges. */
    r->mean_edge = edges / ((double)mesh->triangle_count * 3.0);
    r->finite = 1;
}

int bvxi_rounding_fits(const bvxi_rounding *r, uint64_t triangles)
{
    return r->largest_move * ROUNDING_SHARE <= r->mean_edge && r->spoilt <= triangles / ROUNDING_SPOILT;
}

bvx_status bvxi_refuse_rounding(bvx_context *ctx, const char *name, const bvx_mesh *mesh, int32_t format,
                                const bvxi_file_frame *frame)
{
    bvxi_rounding r;

    if (!bvxi_is_rounded(mesh, format, frame)) return BVX_OK;
    bvxi_measure_rounding(mesh, frame, &r);
    /* its writer says which vertex is too far */
    if (!r.finite || bvxi_rounding_fits(&r, mesh->triangle_count)) return BVX_OK;
    return bvxi_fail_for(
        ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
        "%s: the format's %s move vertices by up to %g, edges have a mean length of %g, and %u of %u "
        "triangles would lose their area or be turned over; take %s",
        name, frame->step > 0.0 ? "quantized positions" : "32-bit floats", r.largest_move, r.mean_edge,
        r.spoilt, mesh->triangle_count,
        frame->step > 0.0          ? "it without quantize"
        : format == BVX_FORMAT_STL ? "PLY, OBJ, OFF or GLB, or bring the mesh near the origin by mesh.frame"
                                   : "PLY, OBJ or OFF, or bring the mesh near the origin by mesh.frame");
}
