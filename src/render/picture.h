/* picture.h - what pictures of meshes and of grids share: options, sample buffers, shading. Not installed. */
#ifndef BVXI_PICTURE_H
#define BVXI_PICTURE_H

#include "render/camera.h"
#include "render/raster.h"

enum { BVXI_PICTURE_BAND = 16 /* rows of pixels drawn at once; times 4 samples it is BVXI_RASTER_BAND */ };

/* The normal of what sample (x, y) shows, in the camera's axes: length 1, towards the eye (n[2] >= 0).
 * Returns 1 when the side that the eye sees is an inside. */
typedef int bvxi_normal_fn(const void *user, uint32_t id, int32_t x, int32_t y, double n[3]);

/* Draw rows of the raster. */
typedef void bvxi_draw_fn(const void *user, const bvxi_raster *raster, bvxi_raster_rows rows);

typedef struct bvxi_picture {
    const char *function; /* for messages */
    bvx_render_options options;
    bvxi_camera camera;
    bvxi_raster raster;
    bvx_image image;
    bvxi_draw_fn *draw;
    bvxi_normal_fn *normal;
    const void *model;    /* first argument of draw and normal */
} bvxi_picture;

/* Check options and image, take them over. */
bvx_status bvxi_picture_open(bvx_context *ctx, const char *function, const bvx_render_options *options,
                             const bvx_image *image, bvxi_picture *picture);

/* Draw and shade; the picture's image is made. Draw, normal, model and camera are set. */
bvx_status bvxi_picture_make(bvx_context *ctx, bvxi_picture *picture);

/* shade.c: rows [begin, end) of pixels from drawn samples. */
typedef struct bvxi_shade bvxi_shade;
bvx_status bvxi_shade_open(bvx_context *ctx, const bvxi_picture *picture, bvxi_shade **shade);
void bvxi_shade_rows(const bvxi_shade *shade, int32_t begin, int32_t end);
void bvxi_shade_close(bvx_context *ctx, bvxi_shade *shade);

#endif
