/* picture.h - what pictures of meshes and of grids share: options, samples, and what a drawn sample shows,
 * which shade.c makes pixels of. Not installed. */
#ifndef BVXI_PICTURE_H
#define BVXI_PICTURE_H

#include "render/camera.h"
#include "render/raster.h"

enum { BVXI_PICTURE_BAND = 16 /* rows of pixels drawn at once; times 4 samples it is BVXI_RASTER_BAND */ };

/* What sample (x, y) shows, in the camera's axes: normals have length 1 and point towards the eye (z >=
 * 0). */
typedef struct bvxi_seen {
    double normal[3];  /* for the light */
    double tangent[3]; /* square to the plane above which neighbours take ambient light away */
    double colour[3];  /* 0 to 255 */
    double light;      /* what the light is multiplied by: below 1 on lines and on cut faces */
    int inside;        /* 1: the eye sees a triangle from behind */
    uint64_t key;      /* what see was given last, so that neighbours cost less; 0: nothing yet */
} bvxi_seen;

typedef void bvxi_see_fn(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y,
                         bvxi_seen *seen);

/* Draw rows of the raster. */
typedef void bvxi_draw_fn(const void *user, const bvxi_raster *raster, bvxi_raster_rows rows);

typedef struct bvxi_picture {
    const char *function; /* for messages */
    bvx_render_options options;
    bvxi_camera camera;
    bvxi_raster raster;
    bvx_image image;
    bvxi_draw_fn *draw;
    bvxi_see_fn *see;
    const void *model; /* first argument of draw and see */
    double roughness;  /* neighbours that rise less than this take no light [Units: samples] */
} bvxi_picture;

/* Check options and image, and take the options over: what is not given has its default. */
bvx_status bvxi_picture_open(bvx_context *ctx, const char *function, const bvx_render_options *options,
                             const bvx_image *image, bvxi_picture *picture);

/* Draw and shade; the picture's image is made. What draw and see need is set. */
bvx_status bvxi_picture_make(bvx_context *ctx, bvxi_picture *picture);

/* shade.c: rows [begin, end) of pixels from drawn samples. */
typedef struct bvxi_shade bvxi_shade;
bvx_status bvxi_shade_open(bvx_context *ctx, const bvxi_picture *picture, bvxi_shade **shade);
void bvxi_shade_rows(const bvxi_shade *shade, int32_t begin, int32_t end);

#endif
