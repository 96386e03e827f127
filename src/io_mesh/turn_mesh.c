/* turn_mesh.c - attributes as files want them: axes turned where another one is up, normals of length 1.
 *
 * Guarantee: a turn moves numbers to other axes and changes a sign, so nothing is rounded and equal
 * positions stay equal. */
#include "io_mesh/mesh_formats.h"
#include "mesh/facet.h"

#define UNIT_TOLERANCE 0.01 /* of a squared length: normals of other programs have few digits */

void bvxi_written_normal(const bvx_mesh *mesh, const double *sum, uint64_t vertex, float normal[3])
{
    size_t const first = (size_t)vertex * 3;
    double n[3], length = 0.0;

    if (mesh->normals == NULL) {
        bvxi_unit_normal(sum + first, normal);
        return;
    }
    for (size_t a = 0; a < 3; a++) {
        normal[a] = mesh->normals[first + a];
        /* One that is not finite counts as none. */
        n[a] = normal[a] - normal[a] == 0.0f ? (double)normal[a] : 0.0;
        length += n[a] * n[a];
    }
    /* A unit vector keeps its bits; the others are scaled. */
    if (length < 1.0 - UNIT_TOLERANCE || length > 1.0 + UNIT_TOLERANCE) bvxi_unit_normal(n, normal);
}

/* ---- turned axes ---- */

/* *to = *negated, *negated = -*to. From 0, so that no zero gets a sign. */
static void turn_pair(double *to, double *negated)
{
    double const kept = *to;
    *to = *negated;
    *negated = 0.0 - kept;
}

/* Z_TO_Y: x, z, -y; Y_TO_Z: x, -z, y. */
static void turn_doubles(double *p, uint64_t count, int32_t turn)
{
    for (uint64_t i = 0; i < count; i++, p += 3) {
        if (turn == BVX_TURN_Z_TO_Y) turn_pair(p + 1, p + 2);
        else turn_pair(p + 2, p + 1);
    }
}

/* The same numbers in doubles, where a sign costs nothing. */
static void turn_floats(float *p, uint64_t count, int32_t turn)
{
    for (uint64_t i = 0; i < count; i++, p += 3) {
        double d[3] = {0.0, (double)p[1], (double)p[2]};
        turn_doubles(d, 1, turn);
        p[1] = (float)d[1];
        p[2] = (float)d[2];
    }
}

bvx_status bvxi_turn_meshes(bvx_context *ctx, const bvx_mesh *meshes, uint64_t count, int32_t turn,
                            bvx_mesh **turned)
{
    *turned = NULL;
    if (turn == BVX_TURN_NONE) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * sizeof **turned, "the list of turned meshes", turned));
    for (uint64_t i = 0; i < count; i++) {
        const bvx_mesh *const mesh = &meshes[i];
        bvx_mesh *const to = &(*turned)[i];
        uint64_t const vertices = mesh->vertex_count;
        uint64_t const bytes = vertices * (mesh->position_type == BVX_F64 ? 24 : 12);

        *to = *mesh;
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the turned positions", &to->positions));
        memcpy(to->positions, mesh->positions, (size_t)bytes);
        if (mesh->position_type == BVX_F64) turn_doubles(to->positions, vertices, turn);
        else turn_floats(to->positions, vertices, turn);
        turn_doubles(to->frame, 1, turn);

        if (mesh->normals == NULL) continue;
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertices * 12, "the turned normals", &to->normals));
        memcpy(to->normals, mesh->normals, (size_t)vertices * 12);
        turn_floats(to->normals, vertices, turn);
    }
    return BVX_OK;
}
