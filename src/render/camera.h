/* camera.h - the camera of a picture: parallel rays, a model fitted to the frame, positions in samples. Not
 * installed. */
#ifndef BVXI_CAMERA_H
#define BVXI_CAMERA_H

#include "bitvox_io.h"
#include "core/core.h"
#include "core/vec3.h"

typedef struct bvxi_camera {
    double axis[3][3]; /* right, up and towards the eye, at right angles, of length 1 */
    double unit;       /* a power of two: the model's size times it is about 1, so nothing overflows */
    double centre[3];  /* of the model [Units: world * unit] */
    double middle[2];  /* what stands in the middle of the frame, along right and up [Units: world * unit] */
    double scale;      /* samples a unit */
    double half[2];    /* the middle of the frame [Units: samples] */
} bvxi_camera;

/* Extremes of a model along right and up [Units: world * unit, from centre]. */
typedef struct bvxi_camera_extent {
    double low[2], high[2];
} bvxi_camera_extent;

/* Look at a box of the world (finite, low below high on some axis) from direction, with up upwards. When up
 * points at the eye, y takes its place, or else x. */
void bvxi_camera_look(bvxi_camera *camera, const double low[3], const double high[3],
                      const double direction[3], const double up[3]);

/* Turn about the middle of another box, inside the first: less is lost to
 * rounding where only that part is drawn. */
void bvxi_camera_move(bvxi_camera *camera, const double low[3], const double high[3]);

/* Make room for so much on either side of what the camera turns about, along right and up [Units: world]. */
void bvxi_camera_show(const bvxi_camera *camera, const double show[2], bvxi_camera_extent *extent);

/* Fit the extremes into a frame of so many samples, with a margin. */
void bvxi_camera_fit(bvxi_camera *camera, const bvxi_camera_extent *extent, int32_t width, int32_t height);

/* Along right, up and towards the eye [Units: world * unit, from centre], of a point [Units: world *
 * unit]. */
static inline void bvxi_camera_turn_scaled(const bvxi_camera *c, const double u[3], double q[3])
{
    double const d[3] = {u[0] - c->centre[0], u[1] - c->centre[1], u[2] - c->centre[2]};
    for (int a = 0; a < 3; a++) q[a] = bvxi_vec_dot(c->axis[a], d);
}

/* The same of a point of the world. */
static inline void bvxi_camera_turn(const bvxi_camera *c, const double p[3], double q[3])
{
    double const u[3] = {p[0] * c->unit, p[1] * c->unit, p[2] * c->unit};
    bvxi_camera_turn_scaled(c, u, q);
}

/* Right, down and towards the eye in the frame [Units: samples]. */
static inline void bvxi_camera_place(const bvxi_camera *c, const double q[3], double s[3])
{
    s[0] = c->half[0] + (q[0] - c->middle[0]) * c->scale;
    s[1] = c->half[1] - (q[1] - c->middle[1]) * c->scale;
    s[2] = q[2] * c->scale;
}

static inline void bvxi_camera_extent_add(bvxi_camera_extent *e, const double q[3])
{
    for (int a = 0; a < 2; a++) {
        e->low[a] = q[a] < e->low[a] ? q[a] : e->low[a];
        e->high[a] = q[a] > e->high[a] ? q[a] : e->high[a];
    }
}

static inline void bvxi_camera_extent_join(bvxi_camera_extent *e, const bvxi_camera_extent *other)
{
    for (int a = 0; a < 2; a++) {
        e->low[a] = other->low[a] < e->low[a] ? other->low[a] : e->low[a];
        e->high[a] = other->high[a] > e->high[a] ? other->high[a] : e->high[a];
    }
}

static const bvxi_camera_extent bvxi_camera_nothing = {{1e300, 1e300}, {-1e300, -1e300}};

#endif
