/* scalar.c - the surface of a level in a volume: bvx_extract_scalar.
 *
 * Source: Lorensen, Cline. Marching Cubes. 1987.
 *
 * The samples become bits, inside or not, in one pass; the surface between set and empty centres is that of
 * march.c, which requires the samples at the ends of crossing edges only. Guarantee: that of march.c, since
 * the tables' triangulations do not cross for any places inside the edges: closed, manifold, outwards,
 * whatever the samples hold. */
#include "surface/march.h"
#include "volume/room.h"

static const bvxi_option scalar_rows[] = {
    BVXI_SWITCH(bvx_scalar_options, below),
    BVXI_CHOICE(bvx_scalar_options, face_rule, BVX_FACE_SEPARATE, BVX_FACE_JOIN),
    BVXI_CHOICE(bvx_scalar_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_WHOLE(bvx_scalar_options, open_sides, 0, 63),
    BVXI_SWITCH(bvx_scalar_options, keys),
    BVXI_SWITCH(bvx_scalar_options, local_frame),
    BVXI_RESERVED(bvx_scalar_options, reserved),
};

/* Bits, then the surface between them; stride is the view's. */
static bvx_status extract_level(bvx_context *ctx, const char *function, const bvx_volume_view *volume,
                                const int64_t stride[3], const bvx_scalar_options *o, bvx_grid *inside,
                                bvx_mesh *mesh)
{
    double const end = 1.7976931348623157e308; /* no finite sample lies beyond */
    /* Choices that the march has too. */
    bvx_extract_options extract = {.face_rule = o->face_rule,
                                   .position_type = o->position_type,
                                   .open_sides = o->open_sides,
                                   .keys = o->keys,
                                   .local_frame = o->local_frame};
    bvxi_level_samples level;
    bvx_volume_report report;
    bvxi_range range;

    /* Samples above the level, or below it; both ends are finite. */
    bvxi_range_make(volume->sample_type, o->below ? -end : o->level, o->below ? o->level : end, &range);
    level.samples = volume->samples;
    memcpy(level.stride, stride, sizeof level.stride);
    level.type = volume->sample_type;
    level.level = o->level;
    bvxi_march m = {.function = function, .level = &level};
    /* Bits first; then samples are read only at the ends of crossed edges. */
    BVXI_TRY(bvxi_threshold(bvxi_call_of(ctx, NULL, "threshold", 0.0, 1.0), volume, stride, &range,
                            o->report != NULL ? &report : NULL, inside));
    BVXI_TRY(bvxi_march_open(ctx, &m, inside, &extract));
    /* Neighbouring positions must differ as doubles. */
    if (m.options.position_type == BVX_F64) BVXI_TRY(bvxi_check_f64(ctx, function, inside, m.origin));
    BVXI_TRY(bvxi_march_fill(ctx, &m, mesh));
    if (o->report != NULL) *o->report = report;
    return BVX_OK;
}

static bvx_status run_extract_scalar(bvx_context *context, const bvx_volume_view *volume,
                                     const bvx_scalar_options *options, bvx_mesh *mesh)
{
    static const char name[] = "bvx_extract_scalar";
    bvx_scalar_options o;
    bvx_grid inside;
    int64_t stride[3];

    /* Everything is checked before the bits' memory is taken. */
    if (mesh == NULL) return bvxi_fail_null(context, name, "mesh");
    BVXI_TRY(bvxi_take_options(context, name, options, &o, sizeof o));
    /* NaN compares with nothing: all samples would be outside. */
    if (o.level != o.level)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_FINITE, "%s: level is NaN", name);
    BVXI_TRY(bvxi_check_options(context, name, &o, BVXI_OPTIONS(scalar_rows)));
    BVXI_TRY(bvxi_volume_check(context, name, volume, stride));

    /* The struct of a grid over the volume's window, without words. */
    bvx_window window;
    memset(&inside, 0, sizeof inside);
    memcpy(window.low, volume->low, sizeof window.low);
    memcpy(window.size, volume->size, sizeof window.size);
    inside.lattice = volume->lattice;
    /* Words follow: the caller gives the room. */
    memcpy(inside.low, volume->low, sizeof inside.low);
    memcpy(inside.size, volume->size, sizeof inside.size);
    inside.words_per_row = bvxi_row_words(volume->size[0]);
    inside.word_capacity = bvx_grid_bound(&volume->lattice, &window);

    BVXI_TRY(BVXI_ARRAY(context, inside.word_capacity, "the samples' sides", inside.words));
    return extract_level(context, name, volume, stride, &o, &inside, mesh);
}

bvx_status bvx_extract_scalar(bvx_context *context, const bvx_volume_view *volume,
                              const bvx_scalar_options *options, bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_extract_scalar(context, volume, options, mesh));
}
