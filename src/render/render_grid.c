/* render_grid.c - shaded pictures of voxel sets: bvx_render_grid, bvx_render_difference.
 *
 * The faces are drawn first (grid_faces.c); here is what each sample shows: the normal of the voxels around
 * it or of the face, the colour by whose voxel it is, the lines between voxels.
 * Two sets cost no memory beyond that of one: their words are joined as they are read. */
#include "render/scenes.h"

#include <math.h>

#define GRID_BALANCED 16.0 /* square of the sum of offsets in thin parts, where it tells no direction */
#define GRID_BARE     0.84 /* light on faces that a cut laid bare, so that a section reads as one */

static const uint8_t removed_colour[3] = {200, 60, 50}, added_colour[3] = {70, 160, 70};

/* The voxel whose face on an axis a sample shows, and where on it (0 to 1 along the other axes). */
static void voxel_of_sample(const bvxi_grid_scene *s, double depth, int axis, int32_t x, int32_t y,
                            int32_t voxel[3], double part[3])
{
    const bvxi_camera *const c = &s->picture.camera;
    /* From the frame back to the world: the sample's place and depth, about the grid's corner. */
    double const q[3] = {(x + 0.5 - c->half[0]) / c->scale + c->middle[0] - s->corner[0],
                         (c->half[1] - y - 0.5) / c->scale + c->middle[1] - s->corner[1],
                         depth / c->scale - s->corner[2]};

    for (int a = 0; a < 3; a++) {
        double const along = q[0] * c->axis[0][a] + q[1] * c->axis[1][a] + q[2] * c->axis[2][a];

        /* Half a voxel inside the face, so that rounding cannot take the voxel on the other side. */
        double const half_in = a != axis ? 0.0 : s->step_z[a] > 0.0 ? -0.5 : 0.5;
        double const place = along / (s->grid->lattice.spacing[a] * c->unit) + half_in, v = floor(place);
        double const first = (double)s->begin[a], last = (double)s->end[a] - 1.0;
        voxel[a] = (int32_t)(v > first ? v < last ? v : last : first);
        part[a] = place - v;
    }
}

/* The normal of the voxels around, in the camera's axes; the face's where they give none. */
static void normal_around(const bvxi_grid_scene *s, const int32_t voxel[3], const double face[3], double n[3])
{
    const double *const spacing = s->grid->lattice.spacing;
    double const longest = bvxi_longest_spacing(spacing);
    double const relative[3] = {spacing[0] / longest, spacing[1] / longest, spacing[2] / longest};
    double world[3], length2;
    bvxi_voxel_normal(s->grid, s->also, relative, voxel[0], voxel[1], voxel[2], world);
    for (int a = 0; a < 3; a++) n[a] = bvxi_vec_dot(s->picture.camera.axis[a], world);
    /* Normals that look away from the eye are laid flat: shading has no back side here. */
    if (n[2] < 0.0) n[2] = 0.0;
    length2 = bvxi_vec_dot(n, n);
    for (int a = 0; a < 3; a++) n[a] = length2 > GRID_BALANCED ? n[a] / sqrt(length2) : face[a];
}

static double light_of_lines(const bvxi_grid_scene *s, int axis, const double part[3])
{
    /* Lines have one width on the picture, whatever the distance: places are measured in samples. */
    double const side = s->picture.options.samples, scale = s->picture.camera.scale;
    double ink = 0.0;

    for (int u = 0; u < 3; u++) { /* lines square to axis u lie along the third axis */
        if (u == axis) continue;
        const double *const across = s->edge[u], *const along = s->edge[3 - u - axis];
        double const cross = across[0] * along[1] - across[1] * along[0];
        double const length = sqrt(along[0] * along[0] + along[1] * along[1]);
        if (length == 0.0) continue;
        double const spacing = (cross < 0.0 ? -cross : cross) / length * scale;
        double const near = bvxi_wire_lesser(part[u], 1.0 - part[u]);
        double const line = bvxi_wire_ink(near * spacing, bvxi_wire_lesser(spacing, length * scale), side);
        ink = line > ink ? line : ink;
    }
    return 1.0 - ink;
}

static void see_face(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y,
                     bvxi_seen *seen)
{
    const bvxi_grid_scene *const s = user;
    int const axis = bvxi_face_axis(id), bare = bvxi_face_bare(id), member = bvxi_face_member(id);
    double const depth = (double)raster->depth[(size_t)y * (size_t)raster->width + (size_t)x];
    const uint8_t *const colour = member == BVXI_FACE_FIRST    ? removed_colour
                                  : member == BVXI_FACE_SECOND ? added_colour
                                                               : s->picture.options.colour;
    double face[3], part[3];
    int32_t voxel[3];

    voxel_of_sample(s, depth, axis, x, y, voxel, part);
    seen->light = s->picture.options.wireframe ? light_of_lines(s, axis, part) : 1.0;
    if (bare) seen->light *= GRID_BARE;
    /* The face that was shaded last is the next one's too, in most cases: its normal and colour stay. */
    uint64_t const row = (uint64_t)voxel[2] * (uint64_t)s->grid->size[1] + (uint64_t)voxel[1];
    uint64_t const key = (row * (uint64_t)s->grid->size[0] + (uint64_t)voxel[0]) * 32 + id; /* of the face */
    if (seen->key == key) return;
    seen->key = key;
    seen->inside = 0;
    for (int a = 0; a < 3; a++) {
        face[a] = s->step_z[axis] > 0.0 ? s->picture.camera.axis[a][axis] : -s->picture.camera.axis[a][axis];
        seen->colour[a] = colour[a];
    }
    /* A face that the cut laid bare is flat: it is not part of the surface. */
    if (!bare) {
        double mix[3], length2;
        if (s->picture.roughness > 0.0) normal_around(s, voxel, face, seen->tangent);
        else memcpy(seen->tangent, face, 3 * sizeof *face);
        /* Large voxels show their faces, small ones the shape around them; in between both are mixed. */
        for (int a = 0; a < 3; a++) mix[a] = face[a] * s->blocky + seen->tangent[a] * (1.0 - s->blocky);
        length2 = bvxi_vec_dot(mix, mix);
        for (int a = 0; a < 3; a++) seen->normal[a] = length2 > 0.0 ? mix[a] / sqrt(length2) : face[a];
    }
    for (int a = 0; a < 3 && bare; a++) seen->normal[a] = seen->tangent[a] = face[a];
}

static bvx_status render_grid_scene(bvx_context *ctx, bvxi_grid_scene *s, bvx_image *image)
{
    BVXI_TRY(bvxi_grid_scene_fit(ctx, s));
    s->picture.draw = bvxi_grid_scene_draw;
    s->picture.see = see_face;
    s->picture.model = s;
    BVXI_TRY(bvxi_picture_make(ctx, &s->picture));
    /* The old picture is freed only now, with the new one complete. */
    bvx_image_free(ctx, image);
    *image = s->picture.image;
    return BVX_OK;
}

static bvx_status run_render_grid(bvx_context *context, const bvx_grid *grid,
                                  const bvx_render_options *options, bvx_image *image)
{
    static const char *const function = "bvx_render_grid";
    bvxi_grid_scene s = {0};
    BVXI_TRY(bvxi_picture_open(context, function, options, image, &s.picture));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    s.grid = grid;
    s.also = grid->words;
    return render_grid_scene(context, &s, image);
}

bvx_status bvx_render_grid(bvx_context *context, const bvx_grid *grid, const bvx_render_options *options,
                           bvx_image *image)
{
    return BVXI_CALL(context, run_render_grid(context, grid, options, image));
}

static bvx_status run_render_difference(bvx_context *context, const bvx_grid *before, const bvx_grid *after,
                                        const bvx_render_options *options, bvx_image *image)
{
    static const char *const function = "bvx_render_difference";
    bvxi_grid_scene s = {0};
    BVXI_TRY(bvxi_picture_open(context, function, options, image, &s.picture));
    if (before == NULL) return bvxi_fail_null(context, function, "before");
    if (after == NULL) return bvxi_fail_null(context, function, "after");
    BVXI_TRY(bvxi_grid_check(context, function, before));
    BVXI_TRY(bvxi_grid_check(context, function, after));

    if (!bvxi_lattice_equal(&before->lattice, &after->lattice))
        return bvxi_fail(context, BVX_ERR_LATTICE, "%s: before and after are on different lattices",
                         function);
    if (memcmp(before->low, after->low, sizeof before->low) != 0 ||
        memcmp(before->size, after->size, sizeof before->size) != 0)
        return bvxi_fail(context, BVX_ERR_LATTICE,
                         "%s: before and after cover different windows of their lattice", function);

    s.grid = before;
    s.also = after->words;
    return render_grid_scene(context, &s, image);
}

bvx_status bvx_render_difference(bvx_context *context, const bvx_grid *before, const bvx_grid *after,
                                 const bvx_render_options *options, bvx_image *image)
{
    return BVXI_CALL(context, run_render_difference(context, before, after, options, image));
}
