/* see_mesh.c - what a sample of a drawn mesh shows: the normal there, the colour, the lines along edges.
 *
 * Normals and colours of the corners are blended by areas in the frame, which is exact as rays are
 * parallel. */
#include "mesh/facet.h"
#include "render/scenes.h"
#include "render/raster.h"

#define SCENE_SHARP \
    0.9 /* cosine between a facet and the mean at its corner below which the edge is meant to be one */

/* ---- normals ---- */

static double scene_unit(double n[3])
{
    double const length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 0.0)
        for (int a = 0; a < 3; a++) n[a] /= length;
    return length;
}

/* The mean of the facets around, each counting by its area; in the order of triangles, so on one thread. */
bvx_status bvxi_mesh_scene_normals(bvx_context *ctx, bvxi_mesh_scene *s)
{
    double p[3][3], n[3];
    uint32_t c[3];
    BVXI_TRY(
        bvxi_alloc_zero(ctx, BVXI_SCRATCH, s->view->vertex_count * 12, "the picture's normals", &s->normal));
    /* As long as twice the area, so larger facets count for more. */
    for (uint64_t t = 0; t < s->view->triangle_count; t++) {
        bvxi_mesh_scene_corners(s, (uint32_t)t, c, p);
        bvxi_facet_normal((const double(*)[3])p, n);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) s->normal[(size_t)c[k] * 3 + (size_t)a] += (float)n[a];
    }
    return BVX_OK;
}

/* Twice the area of a sample with the edge across from corner k; its sign is the whole's inside. */
static double area_across(const double p[3][3], int k, double x, double y)
{
    const double *const a = p[(k + 1) % 3], *const b = p[(k + 2) % 3];
    return (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y);
}

/* Blend the corners' normals by the areas across from them into n. flat is the facet's own, which stands in
 * where a corner's mean is far from it, so sharp edges stay sharp. */
static void blend_vertex_normals(const bvxi_mesh_scene *s, const uint32_t c[3], const double p[3][3],
                                 double x, double y, const double flat[3], double n[3])
{
    double blend[3] = {0.0, 0.0, 0.0}, whole = 0.0;

    for (int k = 0; k < 3; k++) {
        double const area = area_across(p, k, x, y);
        double m[3];
        for (int i = 0; i < 3; i++) m[i] = (double)s->normal[(size_t)c[k] * 3 + (size_t)i];
        /* A corner whose mean is far from the facet is a sharp edge's: its own normal keeps it sharp. */
        int const sharp = scene_unit(m) == 0.0 || bvxi_vec_dot(m, flat) < SCENE_SHARP;
        for (int i = 0; i < 3; i++) blend[i] += area * (sharp ? flat[i] : m[i]);
        whole += area; /* negative where the facet is seen from behind: so are all three */
    }
    if (whole < 0.0)
        for (int i = 0; i < 3; i++) blend[i] = -blend[i];
    if (scene_unit(blend) > 0.0) memcpy(n, blend, sizeof blend);
}

/* Blend the corners' colours like their normals. Samples on the border may lie outside by the snapping. */
static void blend_vertex_colours(const bvxi_mesh_scene *s, const uint32_t c[3], const double p[3][3],
                                 double x, double y, double colour[3])
{
    double share[3], whole = 0.0, sum = 0.0;

    for (int k = 0; k < 3; k++) {
        share[k] = area_across(p, k, x, y);
        whole += share[k];
    }
    /* Shares below 0 come from snapping at the border; without them the rest sums up to less than 1. */
    for (int k = 0; k < 3; k++) {
        share[k] = whole == 0.0 ? 1.0 : share[k] / whole > 0.0 ? share[k] / whole : 0.0;
        sum += share[k];
    }
    for (int a = 0; a < 3; a++) {
        colour[a] = 0.0;
        for (int k = 0; k < 3; k++)
            colour[a] += s->view->colours[(size_t)c[k] * 4 + (size_t)a] * (share[k] / sum);
    }
}

/* Light that the lines along a triangle's edges leave to a sample inside it. */
static double light_of_wires(const bvxi_mesh_scene *s, const double p[3][3], double x, double y)
{
    double const side = s->picture.options.samples;
    double whole = 0.0, area[3], ink = 0.0;

    for (int k = 0; k < 3; k++) {
        area[k] = area_across(p, k, x, y);
        whole += area[k];
    }
    /* A share of the area is a share of the height over that edge, which is the distance from it. */
    for (int k = 0; k < 3; k++) {
        const double *const a = p[(k + 1) % 3], *const b = p[(k + 2) % 3];
        double const length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        if (length == 0.0 || whole == 0.0) continue;
        double const height = (whole < 0.0 ? -whole : whole) / length;
        double const edge = bvxi_wire_ink(area[k] / whole * height, bvxi_wire_lesser(height, length), side);
        ink = edge > ink ? edge : ink;
    }
    return 1.0 - ink;
}

void bvxi_mesh_scene_see(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y,
                         bvxi_seen *seen)
{
    const bvxi_mesh_scene *const s = user;
    uint32_t c[3];
    double p[3][3], n[3];

    (void)raster;

    /* One colour and one normal for the whole facet: what the last sample saw holds here too. */
    if (s->normal == NULL && s->view->colours == NULL && !s->picture.options.wireframe && seen->key == id)
        return;
    seen->key = id;
    bvxi_mesh_scene_corners(s, id - 1, c, p);
    bvxi_facet_normal((const double(*)[3])p, n);
    scene_unit(n);
    memcpy(seen->normal, n, sizeof n);
    if (s->normal != NULL)
        blend_vertex_normals(s, c, (const double(*)[3])p, x + 0.5, -(y + 0.5), n, seen->normal);
    for (int a = 0; a < 3; a++) seen->colour[a] = s->picture.options.colour[a];
    if (s->view->colours != NULL)
        blend_vertex_colours(s, c, (const double(*)[3])p, x + 0.5, -(y + 0.5), seen->colour);
    seen->light = s->picture.options.wireframe ? light_of_wires(s, (const double(*)[3])p, x + 0.5, -(y + 0.5))
                                               : 1.0;

    /* Seen from behind, all normals are turned to the eye. */
    seen->inside = n[2] < 0.0;
    for (int a = 0; a < 3; a++) {
        seen->tangent[a] = seen->inside ? -n[a] : n[a];
        seen->normal[a] = seen->inside ? -seen->normal[a] : seen->normal[a];
    }
    if (seen->normal[2] < 0.0) { /* turned away from the eye though the facet is not */
        seen->normal[2] = 0.0;
        scene_unit(seen->normal);
    }
}

/* Corners in the camera's axes: right, up and towards the eye [Units: samples]. */
void bvxi_mesh_scene_corners(const bvxi_mesh_scene *s, uint32_t t, uint32_t c[3], double p[3][3])
{
    double const part = 1.0 / (double)((int64_t)1 << s->picture.raster.fraction_bits);

    bvxi_view_triangle(s->view, t, c);
    for (int k = 0; k < 3 && s->cut.on; k++) { /* corners that are cut off have no place in the frame */
        double at[3], q[3];
        bvxi_view_position(s->view, c[k], at);
        bvxi_camera_turn(&s->picture.camera, at, q);
        bvxi_camera_place(&s->picture.camera, q, p[k]);
        p[k][1] = -p[k][1];
    }
    for (int k = 0; k < 3 && !s->cut.on; k++) {
        const bvxi_scene_vertex *const v = &s->vertex[c[k]];
        p[k][0] = (double)v->x * part;
        p[k][1] = (double)v->y * -part;
        p[k][2] = (double)v->z;
    }
}
