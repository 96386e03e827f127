/* scenes.h - one voxel set, or two drawn as one, set up for a picture. Not installed. */
#ifndef BVXI_SCENES_H
#define BVXI_SCENES_H

#include "grid/grid.h"
#include "mesh/view.h"
#include "render/picture.h"
#include "render/raster.h"

/* Whose voxel a face belongs to. */
enum { BVXI_FACE_FIRST = 1, BVXI_FACE_SECOND = 2 };

typedef struct bvxi_grid_scene {
    const bvx_grid *grid;
    const uint64_t *also; /* words of the second set; of the first where there is one only */
    bvxi_picture picture;
    int32_t begin[3], end[3]; /* voxels that the cut leaves */
    int32_t pieces;
    bvxi_camera_extent *extent; /* of each piece */
    /* low corner of voxel (0,0,0) of the window, from the centre [Units: world * unit] */
    double corner[3];
    double edge[3][3]; /* the edges of a voxel in the camera's axes [Units: world * unit] */
    /* low corner of voxel begin, and edges, in the frame, right and down, fixed point */
    int64_t base[2], step[3][2];
    double base_z, step_z[3]; /* [Units: samples] */
    /* least and greatest offset of a voxel's corners from its low corner, fixed point */
    int32_t low[2], high[2];
    bvxi_raster_plane plane[3]; /* slopes of the faces square to each axis */
    /* share of the face's normal beside the smooth one: small faces are not seen singly */
    double blocky;
} bvxi_grid_scene;

/* What a sample's number says: the axis that the face is square to, whether
 * the cut laid it bare, and whose it is. */
static inline uint32_t bvxi_face_id(int axis, int bare, int member)
{
    return (uint32_t)(1 + axis + 3 * bare + 6 * member);
}

static inline int bvxi_face_axis(uint32_t id)
{
    return (int)((id - 1) % 3);
}

static inline int bvxi_face_bare(uint32_t id)
{
    return (int)((id - 1) / 3 % 2);
}

static inline int bvxi_face_member(uint32_t id)
{
    return (int)((id - 1) / 6);
}

/* Voxels of a word of a row that the cut leaves. */
static inline uint64_t bvxi_kept_mask(const int32_t begin[3], const int32_t end[3], int32_t word)
{
    uint64_t mask = ~UINT64_C(0);
    if (word == begin[0] / BVXI_WORD_BITS) mask <<= begin[0] % BVXI_WORD_BITS;
    if (word == (end[0] - 1) / BVXI_WORD_BITS) mask &= bvxi_tail_mask(end[0]);
    return word < begin[0] / BVXI_WORD_BITS || word > (end[0] - 1) / BVXI_WORD_BITS ? 0 : mask;
}

/* First and last voxel of a row that is set in one of two sets and that the cut leaves; 0 when there is
 * none. */
static inline int bvxi_row_span(const uint64_t *row, const uint64_t *also, const int32_t begin[3],
                                const int32_t end[3], int32_t *first, int32_t *last)
{
    int32_t i = begin[0] / BVXI_WORD_BITS, n = (end[0] - 1) / BVXI_WORD_BITS;
    while (i <= n && ((row[i] | also[i]) & bvxi_kept_mask(begin, end, i)) == 0) i++;
    if (i > n) return 0;
    while (((row[n] | also[n]) & bvxi_kept_mask(begin, end, n)) == 0) n--;
    *first = i * BVXI_WORD_BITS + bvxi_lowest((row[i] | also[i]) & bvxi_kept_mask(begin, end, i));
    *last = n * BVXI_WORD_BITS + bvxi_highest((row[n] | also[n]) & bvxi_kept_mask(begin, end, n));
    return 1;
}

/* Row index of a set's kept rows, counted slice by slice: its y and z in the window. */
static inline void bvxi_kept_row(const int32_t begin[3], const int32_t end[3], uint64_t index, int32_t *j,
                                 int32_t *k)
{
    uint64_t const rows = (uint64_t)(end[1] - begin[1]);
    *j = begin[1] + (int32_t)(index % rows);
    *k = begin[2] + (int32_t)(index / rows);
}

static inline uint64_t bvxi_kept_rows(const int32_t begin[3], const int32_t end[3])
{
    return (uint64_t)(end[1] - begin[1]) * (uint64_t)(end[2] - begin[2]);
}

/* Indices [begin, end) of the voxels of a window whose centres lie in a box of the world; begin = end
 * along an axis where none does. */
void bvxi_grid_cut(const bvx_grid *grid, const double low[3], const double high[3], int32_t begin[3],
                   int32_t end[3]);

double bvxi_longest_spacing(const double spacing[3]);

/* Take camera and frame from the options: what is left of the set fills it. */
bvx_status bvxi_grid_scene_fit(bvx_context *ctx, bvxi_grid_scene *scene);

/* Draw the faces that the eye can see; user is the scene. */
void bvxi_grid_scene_draw(const void *user, const bvxi_raster *raster, bvxi_raster_rows rows);

#endif
