/* bare_case.h - the one golden case that machines without an operating system compute too: a dented torus at
 * 32 voxels, its solid and the solid's surface. Read in by golden.c and by tests/bare/main.c. */
#ifndef BARE_CASE_H
#define BARE_CASE_H

#include "bitvox_io.h"
#include "shapes.h"

typedef struct bare_result {
    uint64_t set, bits, triangles, mesh;
} bare_result;

static bvx_status bare_case(bvx_context *ctx, shape *s, bare_result *r)
{
    bvx_mesh_view view = {0};
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_mesh surface = {0};
    bvx_status status;

    shape_torus(s, 24, 12, 0.25, 5);
    view.positions = s->v;
    view.indices = s->t;
    view.vertex_count = s->vertices;
    view.triangle_count = s->triangles;
    view.position_type = BVX_F64;
    view.index_type = BVX_U32;
    status = bvx_lattice_fit(ctx, &view, 32, &lattice);
    if (status == BVX_OK) status = bvx_voxelize_solid(ctx, &view, &lattice, NULL, &solid);
    if (status == BVX_OK) status = bvx_grid_count(ctx, &solid, &r->set);
    if (status == BVX_OK) status = bvx_grid_hash(ctx, &solid, &r->bits);
    if (status == BVX_OK) status = bvx_extract_surface(ctx, &solid, NULL, &surface);
    if (status == BVX_OK) status = bvx_mesh_hash(ctx, &surface, &r->mesh);
    r->triangles = surface.triangle_count;
    bvx_mesh_free(ctx, &surface);
    bvx_grid_free(ctx, &solid);
    return status;
}

#endif
