/* camera.c - where a picture is taken from: three axes of length 1, and the scale at which the model fills
 * the frame. A model is first scaled by a power of two, so nothing overflows. */
#include "render/camera.h"

#include "mesh/view.h"

#define CAMERA_FILLS 0.94 /* of the frame's side; the rest is margin */
#define CAMERA_FAR   1e6  /* most that is shown; the model's size is about 1 */
#define CAMERA_THIN  1e-9 /* least extent that the scale is taken from; the model's size is about 1 */

/* Length 1; by the greatest part first, so that squares neither overflow nor vanish. */
static void camera_normalize(const double v[3], double n[3])
{
    double most = 0.0, length;
    for (int a = 0; a < 3; a++) {
        most = v[a] > most ? v[a] : most;
        most = -v[a] > most ? -v[a] : most;
    }
    for (int a = 0; a < 3; a++) n[a] = v[a] / most;
    length = bvxi_vec_length(n);
    for (int a = 0; a < 3; a++) n[a] /= length;
}

void bvxi_camera_move(bvxi_camera *camera, const double low[3], const double high[3])
{
    for (int a = 0; a < 3; a++) camera->centre[a] = (low[a] * 0.5 + high[a] * 0.5) * camera->unit;
}

void bvxi_camera_look(bvxi_camera *camera, const double low[3], const double high[3],
                      const double direction[3], const double up[3])
{
    static const double instead[2][3] = {{0.0, 1.0, 0.0}, {1.0, 0.0, 0.0}};
    double upwards[3], right[3], half[3], other_half[3];

    /* Halves are subtracted, as the difference of two large coordinates might overflow. */
    memset(camera, 0, sizeof *camera);
    for (int a = 0; a < 3; a++) {
        half[a] = high[a] * 0.5 - low[a] * 0.5;
        other_half[a] = -half[a];
    }
    /* from the model's size: it may be small and far away */
    camera->unit = bvxi_unit_scale(other_half, half);
    bvxi_camera_move(camera, low, high);
    camera_normalize(direction, camera->axis[2]);
    camera_normalize(up, upwards);

    /* Looking along `up`, another direction has to say where up is. */
    bvxi_vec_cross(upwards, camera->axis[2], right);
    for (int k = 0; k < 2 && bvxi_vec_length(right) < 1e-6; k++)
        bvxi_vec_cross(instead[k], camera->axis[2], right);
    camera_normalize(right, camera->axis[0]);
    bvxi_vec_cross(camera->axis[2], camera->axis[0], camera->axis[1]);
}

void bvxi_camera_show(const bvxi_camera *camera, const double show[2], bvxi_camera_extent *extent)
{
    for (int a = 0; a < 2 && (show[0] > 0.0 || show[1] > 0.0); a++) {
        double const wanted = show[a] * camera->unit, half = wanted < CAMERA_FAR ? wanted : CAMERA_FAR;
        extent->low[a] = -half < extent->low[a] ? -half : extent->low[a];
        extent->high[a] = half > extent->high[a] ? half : extent->high[a];
    }
}

void bvxi_camera_fit(bvxi_camera *camera, const bvxi_camera_extent *extent, int32_t width, int32_t height)
{
    double const side[2] = {(double)width, (double)height};
    for (int a = 0; a < 2; a++) {
        double const size = extent->high[a] - extent->low[a];
        double const scale = side[a] * CAMERA_FILLS / (size > CAMERA_THIN ? size : CAMERA_THIN);
        if (a == 0 || scale < camera->scale) camera->scale = scale;
        camera->middle[a] = extent->low[a] * 0.5 + extent->high[a] * 0.5;
        camera->half[a] = side[a] * 0.5;
    }
}
