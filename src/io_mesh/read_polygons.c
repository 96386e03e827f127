/* read_polygons.c - polygons of a mesh that is read, cut into triangles.
 *
 * A file may name vertices before it says where they stand, so readers lay each polygon down as a fan, in
 * the room that its triangles take anyway, and keep a list of them. The cut (mesh/polygon.h) comes when the
 * vertices are all there.
 * Memory: some 50 bytes a corner of the largest polygon. */
#include "io_mesh/mesh_formats.h"
#include "mesh/polygon.h"
#include "mesh/view.h"

enum { FANS_BETWEEN_ASKS = 4096 };

/* Scratch for one polygon, as large as the largest. */
typedef struct fan_work {
    uint64_t room; /* corners */
    double (*corner)[3];
    uint32_t *cut;    /* three numbers below corners a triangle */
    uint32_t *number; /* of a vertex or texture coordinate, for each corner */
    bvxi_polygon polygon;
} fan_work;

/* The numbers at a fan's corners. */
static void fan_take_numbers(const uint32_t *t, uint64_t corners, uint32_t *number)
{
    number[0] = t[0];
    number[1] = t[1];
    for (uint64_t k = 2; k < corners; k++) number[k] = t[(k - 2) * 3 + 2];
}

static void fan_put_numbers(const fan_work *w, uint64_t corners, uint32_t *t)
{
    fan_take_numbers(t, corners, w->number);
    for (uint64_t i = 0; i < (corners - 2) * 3; i++) t[i] = w->number[w->cut[i]];
}

static bvx_status fan_cut(fan_work *w, bvx_mesh *mesh, const bvxi_polygon_fan *fan)
{
    uint32_t *const t = mesh->triangles + (size_t)fan->triangle * 3;

    fan_take_numbers(t, fan->corners, w->number);

    for (uint32_t k = 0; k < fan->corners; k++) {
        for (size_t a = 0; a < 3; a++) {
            size_t const i = (size_t)w->number[k] * 3 + a;
            w->corner[k][a] = mesh->position_type == BVX_F64 ? ((const double *)mesh->positions)[i]
                                                             : (double)((const float *)mesh->positions)[i];
        }
        if (bvxi_view_finite(w->corner[k])) continue;
        /* A polygon with a corner that is not finite has no plane: all of its triangles get that corner,
         * and are dropped with it. */
        for (uint64_t i = 0; i < fan->corners - 2; i++) t[i * 3] = w->number[k];
        return BVX_OK;
    }

    /* The cut gives places in the polygon; both lists of indices follow it, so seams stay where they were. */
    BVXI_TRY(bvxi_polygon_cut(&w->polygon, (const double(*)[3])w->corner, fan->corners, w->cut));
    fan_put_numbers(w, fan->corners, t);
    if (mesh->uv_triangles != NULL)
        fan_put_numbers(w, fan->corners, mesh->uv_triangles + (size_t)fan->triangle * 3);
    return BVX_OK;
}

bvx_status bvxi_cut_fans(bvxi_source *source, bvx_mesh *mesh, const bvxi_polygon_fan *fans, uint64_t count)
{
    bvx_context *const ctx = source->ctx;
    uint64_t const mark = bvxi_scratch_begin(ctx);
    fan_work w = {0};

    if (count == 0) return BVX_OK;

    for (uint64_t i = 0; i < count; i++)
        if (fans[i].corners > w.room) w.room = fans[i].corners;
    w.polygon.ctx = ctx;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w.room * sizeof *w.corner, "the corners of a polygon", &w.corner));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w.room * 12, "the triangles of a polygon", &w.cut));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w.room * 4, "the numbers of a polygon", &w.number));

    /* A progress call for each fan would cost more than cutting a small one. */
    for (uint64_t i = 0; i < count; i++) {
        if (i % FANS_BETWEEN_ASKS == 0) BVXI_TRY(bvxi_progress(ctx, "read", source->reached));
        BVXI_TRY(fan_cut(&w, mesh, &fans[i]));
    }
    return bvxi_scratch_end(ctx, mark, BVX_OK);
}
