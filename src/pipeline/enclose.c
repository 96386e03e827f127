/* enclose.c - a closed surface around a mesh that touches none of its triangles: a step of bvx_hull.
 *
 * Centres within an offset of the mesh are the body, and what is closed off inside them. Marching cubes puts the surface
 * between centres of which one is nearer than the offset and one is further. No point of a cell is further from any of
 * its corners than its diagonal: so the surface is as far from the mesh as the offset but for one diagonal, whatever the
 * mesh is, and an offset of more than a diagonal touches nothing.
 *
 * Source: Portaneri, Rouxel-Labbe, Hemmer, Cohen-Steiner, Alliez. Alpha Wrapping with an Offset. 2022 (the task). */
#include "field/room.h"
#include "grid/sparse.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "pipeline/enclose.h"
#include "surface/field_surface.h"

#include <math.h>

/* Spacings to the farthest that is allowed: the surface itself takes 1.8 + 1.8 of them, edges that collapse the rest. */
#define ENCLOSE_SPACINGS 5.0
/* Of a cell's diagonal: what floats and steps of vertices round is in the rest. */
#define ENCLOSE_OFFSET 1.03
#define ENCLOSE_MOST   4096.0 /* voxels along an axis */

static bvx_status surface_around(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                                 const bvx_lattice *lattice, bvx_field *field, bvx_mesh *surface)
{
    double const offset = ENCLOSE_OFFSET * sqrt(3.0) * lattice->spacing[0];
    bvx_field_options const o = {.struct_size = sizeof o,
                                 .half_width = offset / lattice->spacing[0] + 1.01,
                                 .sign = BVX_FILL_NONE,
                                 .no_vectors = 1};
    bvx_field_surface_options const s = {
        .placing = {.interpolation = BVX_EDGE_SCALAR, .sharp = BVX_SHARP_NEVER}};
    bvx_grid body = {.words = NULL};
    bvxi_cut_rule rule = {.offset = 0};

    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.6, bvx_measure_field(ctx, mesh, lattice, &o, field)));

    /* What is within the offset, or closed off by it; distances become those to the offset's surface. */
    uint64_t const words = bvxi_grid_words(&field->band);
    float *const distance = field->distances;
    uint64_t next = 0;

    BVXI_TRY(BVXI_ARRAY(ctx, words, "what is enclosed", body.words));
    body.word_capacity = words;
    BVXI_TRY(bvx_grid_create(ctx, &field->band.lattice, NULL, &body));
    for (uint64_t i = 0; i < words; i++) {
        uint64_t near = 0;

        for (uint64_t bits = field->band.words[i]; bits != 0; bits &= bits - 1) {
            distance[next] -= (float)offset;
            near |= (bits & ~(bits - 1)) * (uint64_t)(distance[next] <= 0);
            next++;
        }
        body.words[i] = near;
    }
    BVXI_TRY(bvx_grid_fill_cavities(ctx, &body, 6, 0, &body, NULL));
    bvxi_sparse const values = bvxi_sparse_of_field(field);
    rule.values = &values;
    return BVXI_SHARE(ctx, 0.6, 1.0, bvxi_field_surface(ctx, function, &body, &rule, &s, surface));
}

bvx_status bvxi_enclose(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, double farthest,
                        bvx_lattice *lattice, bvx_mesh *surface)
{
    double const spacing = farthest / ENCLOSE_SPACINGS;
    bvx_lattice_options const o = {
        .struct_size = sizeof o, .spacing = {spacing, spacing, spacing}, .padding = 4};
    bvx_field field = {.value_count = 0};
    double low[3], high[3];

    BVXI_TRY(bvxi_view_bounds(ctx, function, mesh, low, high));
    for (int a = 0; a < 3; a++)
        if (!(high[a] - low[a] <= ENCLOSE_MOST * spacing))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: enclose of %g is too small for a mesh that spans %g; %g is possible",
                                 function, farthest, high[a] - low[a],
                                 (high[a] - low[a]) * (ENCLOSE_SPACINGS / ENCLOSE_MOST));
    BVXI_TRY(bvx_lattice_fit_with(ctx, mesh, &o, lattice));
    bvx_status const status = surface_around(ctx, function, mesh, lattice, &field, surface);
    bvx_field_free(ctx, &field);
    return status;
}
