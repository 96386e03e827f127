/* picture.c - options of a picture, its buffers, and its two passes: draw, then shade.
 *
 * Both passes are cut into bands of pixel rows whose number follows from the picture's height. A band writes
 * its own rows only, so neither threads nor their order show. */
#include "render/picture.h"

#include <math.h>

enum { PICTURE_SIDE = 16384 };

static bvx_status check_picture_direction(bvx_context *ctx, const char *function, const char *name,
                                          const double v[3])
{
    /* A difference from itself is 0 only for finite numbers. */
    for (int a = 0; a < 3; a++)
        if (v[a] - v[a] != 0.0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_FINITE,
                                 "%s: %s has the part %g, which is not finite", function, name, v[a]);
    return BVX_OK;
}

static const bvxi_option picture_rows[] = {
    BVXI_OR(bvx_render_options, width, WHOLE, 1024, 1, PICTURE_SIDE),
    BVXI_OR(bvx_render_options, height, WHOLE, 768, 1, PICTURE_SIDE),
    BVXI_SWITCH(bvx_render_options, smooth),
    BVXI_OR(bvx_render_options, samples, WHOLE, 2, 1, 4),
    BVXI_SWITCH(bvx_render_options, wireframe),
    BVXI_WHOLE(bvx_render_options, cut.sides, 0, 63),
    BVXI_RESERVED(bvx_render_options, cut.reserved),
    BVXI_RESERVED(bvx_render_options, reserved),
};

static bvx_status take_picture_options(bvx_context *ctx, const char *function,
                                       const bvx_render_options *given, const bvx_image *image,
                                       bvx_render_options *options)
{
    if (image == NULL) return bvxi_fail_null(ctx, function, "image");
    /* Pixels of another allocator cannot be freed here. */
    if (image->pixels != NULL && (image->width < 1 || image->height < 1))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: image brings pixels, which are not used; zero it first", function);
    BVXI_TRY(bvxi_take_options(ctx, function, given, options, sizeof *options));
    BVXI_TRY(bvxi_check_options(ctx, function, options, BVXI_OPTIONS(picture_rows)));
    static const double direction[3] = {3.0, -4.0, 2.0}, up[3] = {0.0, 0.0, 1.0};
    static const uint8_t colour[4] = {200, 196, 188, 255}, background[4] = {255, 255, 255, 255},
                         none[4] = {0};
    if (memcmp(options->colour, none, sizeof none) == 0) memcpy(options->colour, colour, sizeof colour);
    if (memcmp(options->background, none, sizeof none) == 0)
        memcpy(options->background, background, sizeof background);
    if (bvxi_vec_is_zero(options->camera.direction))
        memcpy(options->camera.direction, direction, sizeof direction);
    if (bvxi_vec_is_zero(options->camera.up)) memcpy(options->camera.up, up, sizeof up);
    for (int a = 0; a < 3; a++) {
        if ((options->cut.sides & BVX_OPEN_X_LOW << 2 * a) == 0) options->cut.low[a] = -(double)INFINITY;
        if ((options->cut.sides & BVX_OPEN_X_HIGH << 2 * a) == 0) options->cut.high[a] = (double)INFINITY;
    }

    static const char *const axis[3] = {"x", "y", "z"};
    for (int a = 0; a < 3; a++)
        if (!(options->cut.low[a] <= options->cut.high[a]))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                                 "%s: the cut from %g to %g along %s is not a range", function,
                                 options->cut.low[a], options->cut.high[a], axis[a]);

    BVXI_TRY(check_picture_direction(ctx, function, "direction", options->camera.direction));
    BVXI_TRY(check_picture_direction(ctx, function, "up", options->camera.up));
    for (int a = 0; a < 2; a++)
        if (!(options->camera.show[a] >= 0.0) || options->camera.show[a] - options->camera.show[a] != 0.0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: show is %g, %g; both must be 0 or more, and finite", function,
                                 options->camera.show[0], options->camera.show[1]);
    return BVX_OK;
}

bvx_status bvxi_picture_open(bvx_context *ctx, const char *function, const bvx_render_options *options,
                             const bvx_image *image, bvxi_picture *picture)
{
    memset(picture, 0, sizeof *picture);
    picture->function = function;
    BVXI_TRY(take_picture_options(ctx, function, options, image, &picture->options));
    /* Several samples a pixel are a larger frame, which is averaged when it is shaded. */
    picture->raster.width = picture->options.width * picture->options.samples;
    picture->raster.height = picture->options.height * picture->options.samples;
    picture->raster.fraction_bits = bvxi_raster_fraction_bits(
        picture->raster.width > picture->raster.height ? picture->raster.width : picture->raster.height);
    return BVX_OK;
}

/* Rough costs of a sample, by which progress is cut. */
#define NANOSECONDS_TO_DRAW  50.0
#define NANOSECONDS_TO_SHADE 150.0

typedef struct picture_work {
    const bvxi_picture *picture;
    const bvxi_shade *shade;
} picture_work;

static void picture_band(const bvxi_picture *p, int32_t index, int32_t *begin, int32_t *end)
{
    *begin = index * BVXI_PICTURE_BAND;
    *end = *begin + BVXI_PICTURE_BAND < p->options.height ? *begin + BVXI_PICTURE_BAND : p->options.height;
}

static void draw_picture_band(void *user, int32_t index)
{
    const bvxi_picture *const p = ((const picture_work *)user)->picture;
    bvxi_raster_rows rows;
    picture_band(p, index, &rows.begin, &rows.end);
    rows.begin *= p->options.samples;
    rows.end *= p->options.samples;
    bvxi_raster_clear(&p->raster, rows);
    p->draw(p->model, &p->raster, rows);
}

static void shade_picture_band(void *user, int32_t index)
{
    const picture_work *const w = user;
    int32_t begin, end;
    picture_band(w->picture, index, &begin, &end);
    bvxi_shade_rows(w->shade, begin, end);
}

static bvx_status draw_and_shade(bvx_context *ctx, bvxi_picture *p, uint64_t samples)
{
    int32_t const bands = (p->options.height + BVXI_PICTURE_BAND - 1) / BVXI_PICTURE_BAND;
    picture_work work = {p, NULL};
    bvxi_shade *shade = NULL;

    /* Shading needs all depths of the frame, as light comes from around: so it is a second pass. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, samples * 4, "the picture's depths", &p->raster.depth));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, samples * 4, "the picture's samples", &p->raster.id));
    BVXI_TRY(bvxi_each_long(ctx, "render", 0.2, 0.5, bands, (double)samples / bands * NANOSECONDS_TO_DRAW,
                            draw_picture_band, &work));
    BVXI_TRY(bvxi_shade_open(ctx, p, &shade));
    work.shade = shade;
    return bvxi_each_long(ctx, "render", 0.5, 1.0, bands, (double)samples / bands * NANOSECONDS_TO_SHADE,
                          shade_picture_band, &work);
}

bvx_status bvxi_picture_make(bvx_context *ctx, bvxi_picture *p)
{
    uint64_t const pixels = (uint64_t)p->options.width * (uint64_t)p->options.height;
    uint64_t const samples = (uint64_t)p->raster.width * (uint64_t)p->raster.height;
    bvx_image image = {NULL, p->options.width, p->options.height};
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, pixels * 3, "the picture's pixels", &image.pixels));
    p->image = image;
    bvx_status const status = BVXI_SCOPE(ctx, draw_and_shade(ctx, p, samples));
    if (status != BVX_OK) {
        bvx_image_free(ctx, &image);
        memset(&p->image, 0, sizeof p->image);
    }
    return status;
}

void bvx_image_free(bvx_context *context, bvx_image *image)
{
    if (context == NULL || image == NULL) return;
    bvxi_free(context, image->pixels, (uint64_t)image->width * (uint64_t)image->height * 3);
    memset(image, 0, sizeof *image);
}
