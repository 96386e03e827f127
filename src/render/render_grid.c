/* render_grid.c - a shaded picture of a voxel set: bvx_render_grid.
 *
 * Idea: of a voxel's six faces the eye can see three. A row of such faces comes out of word operations (set here, empty
 * in the neighbour), neighbours along x in one word are drawn as one strip. All corners lie on one lattice of integers
 * in the frame (the three edges of a voxel are snapped once), so strips of different lengths meet without gaps.
 * A band of the picture visits only slices, rows and words that reach it. Smooth pictures take normals from the voxels
 * around. */
#include "grid/grid.h"
#include "render/picture.h"
#include "render/voxel_normal.h"

#include <math.h>

enum { GRID_GRAIN = 4096 /* rows a piece, at least */ };

#define GRID_EDGE_ON 1e-6 /* faces turned away further than this cosine are not drawn */
#define GRID_FINE 8.0     /* steps between smaller voxels are roughness more than shape [Units: samples] */
#define GRID_BALANCED 16.0 /* square of the sum of offsets in thin parts, where it tells no direction */

typedef struct grid_scene {
    const bvx_grid *grid;
    bvxi_picture picture;
    int32_t pieces;
    bvxi_camera_extent *extent; /* of each piece */
    double corner[3];           /* low corner of voxel (0,0,0) of the window, from the centre [Units: world * unit] */
    double edge[3][3];          /* the edges of a voxel in the camera's axes [Units: world * unit] */
    int64_t base[2], step[3][2]; /* corner and edges in the frame, right and down, fixed point */
    double base_z, step_z[3];   /* [Units: samples] */
    int32_t low[2], high[2];    /* least and greatest offset of a voxel's corners from its low corner, fixed point */
    bvxi_raster_plane plane[3]; /* slopes of the faces square to each axis */
    double blocky;              /* share of the face's normal beside the smooth one: small faces are not seen singly */
} grid_scene;

/* ---- where the set lies in the view ---- */

static void add_voxel_corners(const grid_scene *s, int32_t i, int32_t j, int32_t k, bvxi_camera_extent *e)
{
    double q[3];
    for (int32_t c = 0; c < 8; c++) {
        int64_t const n[3] = {(int64_t)i + (c & 1), (int64_t)j + (c >> 1 & 1), (int64_t)k + (c >> 2)};
        for (int a = 0; a < 3; a++)
            q[a] = s->corner[a] + (double)n[0] * s->edge[0][a] + (double)n[1] * s->edge[1][a] + (double)n[2] * s->edge[2][a];
        bvxi_camera_extent_add(e, q);
    }
}

/* The extremes of a row are at its first and last voxel. */
static void extent_of_rows(void *user, int32_t index, int32_t worker)
{
    const grid_scene *const s = user;
    const bvx_grid *const g = s->grid;
    bvxi_camera_extent e = bvxi_camera_nothing;
    uint64_t begin, end;
    (void)worker;
    bvxi_piece(bvxi_grid_rows(g), s->pieces, index, &begin, &end);
    for (uint64_t row = begin; row < end; row++) {
        const uint64_t *const w = g->words + row * (uint64_t)g->words_per_row;
        int32_t const j = (int32_t)(row % (uint64_t)g->size[1]), k = (int32_t)(row / (uint64_t)g->size[1]);
        int32_t first = 0, last = g->words_per_row - 1;
        while (first < g->words_per_row && w[first] == 0) first++;
        if (first == g->words_per_row) continue;
        while (w[last] == 0) last--;
        uint64_t top = w[last];
        int32_t bit = 0;
        while (top >>= 1) bit++;
        add_voxel_corners(s, first * BVXI_WORD_BITS + bvxi_lowest(w[first]), j, k, &e);
        add_voxel_corners(s, last * BVXI_WORD_BITS + bit, j, k, &e);
    }
    s->extent[index] = e;
}

static bvx_status fit_grid_scene(bvx_context *ctx, grid_scene *s)
{
    bvxi_camera_extent all = bvxi_camera_nothing;
    uint64_t size;
    bvx_status status;
    s->pieces = bvxi_piece_count(bvxi_grid_rows(s->grid), GRID_GRAIN);
    size = (uint64_t)s->pieces * sizeof *s->extent;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size, "the picture's extents", &s->extent));
    status = bvxi_parallel(ctx, "render", 0.0, 0.1, s->pieces, extent_of_rows, s);
    for (int32_t i = 0; i < s->pieces && status == BVX_OK; i++) bvxi_camera_extent_join(&all, &s->extent[i]);
    bvxi_free(ctx, s->extent, size);
    BVXI_TRY(status);
    if (all.low[0] > all.high[0]) return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no voxel is set", s->picture.function);
    bvxi_camera_fit(&s->picture.camera, &all, s->picture.raster.width, s->picture.raster.height);
    return BVX_OK;
}

/* ---- the lattice in the frame ---- */

static void look_at_grid(grid_scene *s)
{
    const bvx_lattice *const l = &s->grid->lattice;
    bvxi_camera *const c = &s->picture.camera;
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = l->origin[a] + s->grid->low[a] * l->spacing[a];
        high[a] = l->origin[a] + ((double)s->grid->low[a] + s->grid->size[a]) * l->spacing[a];
    }
    bvxi_camera_look(c, low, high, s->picture.options.direction, s->picture.options.up);
    bvxi_camera_turn(c, low, s->corner);
    for (int e = 0; e < 3; e++)
        for (int a = 0; a < 3; a++) s->edge[e][a] = c->axis[a][e] * (l->spacing[e] * c->unit);
}

static int64_t snap_to_fixed(double samples, int32_t bits)
{
    return (int64_t)floor(samples * (double)((int64_t)1 << bits) + 0.5);
}

static double greater_spacing(const double spacing[3])
{
    double const most = spacing[0] > spacing[1] ? spacing[0] : spacing[1];
    return most > spacing[2] ? most : spacing[2];
}

static void place_grid(grid_scene *s)
{
    double const voxel = greater_spacing(s->grid->lattice.spacing) * s->picture.camera.unit * s->picture.camera.scale;
    const bvxi_camera *const c = &s->picture.camera;
    int32_t const bits = s->picture.raster.fraction_bits;
    double at[3];
    bvxi_camera_place(c, s->corner, at);
    for (int a = 0; a < 2; a++) {
        s->base[a] = snap_to_fixed(at[a], bits);
        s->low[a] = s->high[a] = 0;
        for (int e = 0; e < 3; e++) {
            s->step[e][a] = snap_to_fixed((a == 0 ? s->edge[e][0] : -s->edge[e][1]) * c->scale, bits);
            if (s->step[e][a] < 0) s->low[a] += (int32_t)s->step[e][a];
            else s->high[a] += (int32_t)s->step[e][a];
        }
    }
    s->base_z = at[2];
    s->picture.roughness = s->picture.options.smooth || voxel < GRID_FINE ? voxel : 0.0;
    s->blocky = s->picture.options.smooth ? 0.0 : voxel / GRID_FINE * (voxel / GRID_FINE);
    for (int e = 0; e < 3; e++) {
        s->step_z[e] = s->edge[e][2] * c->scale;
        if (c->axis[2][e] == 0.0) continue; /* never drawn */
        s->plane[e].dx = -c->axis[0][e] / c->axis[2][e];
        s->plane[e].dy = c->axis[1][e] / c->axis[2][e];
    }
}

/* Which n in [0, count) put base + n * step into [low, high]: [*begin, *end). */
static void clip_grid_range(int64_t base, int64_t step, int64_t low, int64_t high, int32_t count, int32_t *begin, int32_t *end)
{
    int64_t first = 0, last = (int64_t)count - 1;
    if (step == 0) {
        if (base < low || base > high) last = -1;
    } else {
        int64_t const a = step > 0 ? low - base : base - high, b = step > 0 ? high - base : base - low;
        int64_t const d = step > 0 ? step : -step;
        if (a > 0) first = (a + d - 1) / d;
        if (b < 0) last = -1;
        else if (b / d < last) last = b / d;
    }
    *begin = (int32_t)(first < count ? first : count);
    *end = last < first ? *begin : (int32_t)last + 1;
}

/* ---- faces ---- */

typedef struct face_work {
    const grid_scene *scene;
    const bvxi_raster *raster;
    bvxi_raster_rows rows;
} face_work;

/* The faces of voxels [i, i + n) of a row that are square to an axis, on the side of the eye. */
static void draw_strip(const face_work *w, int axis, int32_t i, int32_t n, int32_t j, int32_t k)
{
    const grid_scene *const s = w->scene;
    int const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
    int64_t const length = u == 0 ? n : 1;
    int64_t at[3] = {i, j, k};
    int32_t corner[4][2];
    bvxi_raster_plane plane = s->plane[axis];
    at[axis] += s->step_z[axis] > 0.0;
    for (int a = 0; a < 2; a++) {
        int64_t const p = s->base[a] + at[0] * s->step[0][a] + at[1] * s->step[1][a] + at[2] * s->step[2][a];
        corner[0][a] = (int32_t)p;
        corner[1][a] = (int32_t)(p + length * s->step[u][a]);
        corner[2][a] = (int32_t)(p + length * s->step[u][a] + s->step[v][a]);
        corner[3][a] = (int32_t)(p + s->step[v][a]);
    }
    double const part = 1.0 / (double)((int64_t)1 << w->raster->fraction_bits);
    double const along = (double)length * s->step_z[u], across = s->step_z[v];
    plane.x = corner[0][0] * part;
    plane.y = corner[0][1] * part;
    plane.z = s->base_z + (double)at[0] * s->step_z[0] + (double)at[1] * s->step_z[1] + (double)at[2] * s->step_z[2];
    plane.low = plane.z + (along < 0.0 ? along : 0.0) + (across < 0.0 ? across : 0.0);
    plane.high = plane.z + (along > 0.0 ? along : 0.0) + (across > 0.0 ? across : 0.0);
    bvxi_raster_polygon(w->raster, w->rows, (const int32_t(*)[2])corner, 4, &plane, (uint32_t)axis + 1);
}

static void draw_faces_of_word(const face_work *w, int axis, uint64_t faces, int32_t first, int32_t j, int32_t k)
{
    while (faces != 0) {
        int32_t const begin = bvxi_lowest(faces);
        uint64_t const rest = ~(faces >> begin); /* its lowest set bit ends the run */
        int32_t const n = axis == 0 ? 1 : rest == 0 ? BVXI_WORD_BITS : bvxi_lowest(rest);
        draw_strip(w, axis, first + begin, n, j, k);
        faces = begin + n >= BVXI_WORD_BITS ? 0 : faces >> (begin + n) << (begin + n);
    }
}

/* Words [begin, end) of a row: a face shows where the neighbour towards the eye is empty or outside the window. */
static void draw_row(const face_work *w, int32_t j, int32_t k, int32_t begin, int32_t end)
{
    const grid_scene *const s = w->scene;
    const bvx_grid *const g = s->grid;
    int32_t const sign[3] = {s->step_z[0] > 0.0 ? 1 : -1, s->step_z[1] > 0.0 ? 1 : -1, s->step_z[2] > 0.0 ? 1 : -1};
    size_t const per_row = (size_t)g->words_per_row, row = ((size_t)k * (size_t)g->size[1] + (size_t)j) * per_row;
    const uint64_t *const here = g->words + row;
    const uint64_t *beside[3] = {here, NULL, NULL};
    if (j + sign[1] >= 0 && j + sign[1] < g->size[1]) beside[1] = sign[1] > 0 ? here + per_row : here - per_row;
    if (k + sign[2] >= 0 && k + sign[2] < g->size[2])
        beside[2] = sign[2] > 0 ? here + per_row * (size_t)g->size[1] : here - per_row * (size_t)g->size[1];
    for (int32_t i = begin; i < end; i++) {
        uint64_t const word = here[i];
        if (word == 0) continue;
        for (int axis = 0; axis < 3; axis++) {
            double const facing = s->picture.camera.axis[2][axis];
            uint64_t other;
            if (facing < GRID_EDGE_ON && facing > -GRID_EDGE_ON) continue;
            if (axis > 0) other = beside[axis] != NULL ? beside[axis][i] : 0;
            else if (sign[0] > 0) other = word >> 1 | (i + 1 < g->words_per_row ? here[i + 1] << 63 : 0);
            else other = word << 1 | (i > 0 ? here[i - 1] >> 63 : 0);
            draw_faces_of_word(w, axis, word & ~other, i * BVXI_WORD_BITS, j, k);
        }
    }
}

static int64_t lesser(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

static int64_t greater(int64_t a, int64_t b)
{
    return a > b ? a : b;
}

static void draw_grid_rows(const void *user, const bvxi_raster *raster, bvxi_raster_rows rows)
{
    const grid_scene *const s = user;
    const bvx_grid *const g = s->grid;
    face_work const w = {s, raster, rows};
    int64_t const top = (int64_t)rows.begin << raster->fraction_bits, bottom = (int64_t)rows.end << raster->fraction_bits;
    int64_t const along_x = (int64_t)(g->size[0] - 1) * s->step[0][1], along_y = (int64_t)(g->size[1] - 1) * s->step[1][1];
    int64_t const row_low = top - s->high[1], row_high = bottom - s->low[1]; /* for the low corner of a voxel */
    int64_t const y_low = row_low - greater(along_x, 0), y_high = row_high - lesser(along_x, 0);
    int64_t const z_low = y_low - greater(along_y, 0), z_high = y_high - lesser(along_y, 0);
    int32_t k, k_end, j, j_end, i, i_end;
    clip_grid_range(s->base[1], s->step[2][1], z_low, z_high, g->size[2], &k, &k_end);
    for (; k < k_end; k++) {
        int64_t const slice = s->base[1] + k * s->step[2][1];
        clip_grid_range(slice, s->step[1][1], y_low, y_high, g->size[1], &j, &j_end);
        for (; j < j_end; j++) {
            clip_grid_range(slice + j * s->step[1][1], s->step[0][1], row_low, row_high, g->size[0], &i, &i_end);
            if (i < i_end) draw_row(&w, j, k, i / BVXI_WORD_BITS, (i_end - 1) / BVXI_WORD_BITS + 1);
        }
    }
}

/* The voxel whose face on an axis a sample shows. */
static void voxel_of_sample(const grid_scene *s, double depth, int axis, int32_t x, int32_t y, int32_t voxel[3])
{
    const bvxi_camera *const c = &s->picture.camera;
    double const q[3] = {(x + 0.5 - c->half[0]) / c->scale + c->middle[0] - s->corner[0],
                         (c->half[1] - y - 0.5) / c->scale + c->middle[1] - s->corner[1], depth / c->scale - s->corner[2]};
    for (int a = 0; a < 3; a++) {
        double const along = q[0] * c->axis[0][a] + q[1] * c->axis[1][a] + q[2] * c->axis[2][a];
        double const half_in = a != axis ? 0.0 : s->step_z[a] > 0.0 ? -0.5 : 0.5;
        double const v = floor(along / (s->grid->lattice.spacing[a] * c->unit) + half_in);
        double const last = (double)s->grid->size[a] - 1.0;
        voxel[a] = (int32_t)(v > 0.0 ? v < last ? v : last : 0.0);
    }
}

/* The normal of the voxels around, in the camera's axes; the face's where they give none. */
static void normal_around(const grid_scene *s, const int32_t voxel[3], const double face[3], double n[3])
{
    const double *const spacing = s->grid->lattice.spacing;
    double const longest = greater_spacing(spacing);
    double const relative[3] = {spacing[0] / longest, spacing[1] / longest, spacing[2] / longest};
    double world[3], length2;
    bvxi_voxel_normal(s->grid, relative, voxel[0], voxel[1], voxel[2], world);
    for (int a = 0; a < 3; a++) n[a] = bvxi_camera_dot(s->picture.camera.axis[a], world);
    if (n[2] < 0.0) n[2] = 0.0;
    length2 = bvxi_camera_dot(n, n);
    for (int a = 0; a < 3; a++) n[a] = length2 > GRID_BALANCED ? n[a] / sqrt(length2) : face[a];
}

static void see_face(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y, bvxi_seen *seen)
{
    const grid_scene *const s = user;
    int const axis = (int)id - 1;
    double const depth = (double)raster->depth[(size_t)y * (size_t)raster->width + (size_t)x];
    double const sign = s->step_z[axis] > 0.0 ? 1.0 : -1.0;
    double face[3], mix[3], length2;
    int32_t voxel[3];
    for (int a = 0; a < 3; a++) face[a] = s->picture.camera.axis[a][axis] * sign;
    seen->inside = 0;
    if (s->picture.roughness > 0.0) {
        voxel_of_sample(s, depth, axis, x, y, voxel);
        uint64_t const row = (uint64_t)voxel[2] * (uint64_t)s->grid->size[1] + (uint64_t)voxel[1];
        uint64_t const key = (row * (uint64_t)s->grid->size[0] + (uint64_t)voxel[0]) * 3 + id;
        if (seen->key == key) return;
        seen->key = key;
        normal_around(s, voxel, face, seen->tangent);
    } else {
        memcpy(seen->tangent, face, sizeof face);
    }
    for (int a = 0; a < 3; a++) mix[a] = face[a] * s->blocky + seen->tangent[a] * (1.0 - s->blocky);
    length2 = bvxi_camera_dot(mix, mix);
    for (int a = 0; a < 3; a++) seen->normal[a] = length2 > 0.0 ? mix[a] / sqrt(length2) : face[a];
}

bvx_status bvx_render_grid(bvx_context *context, const bvx_grid *grid, const bvx_render_options *options, bvx_image *image)
{
    static const char *const function = "bvx_render_grid";
    grid_scene s;
    if (context == NULL) return BVX_ERR_ARGUMENT;
    memset(&s, 0, sizeof s);
    s.grid = grid;
    BVXI_TRY(bvxi_picture_open(context, function, options, image, &s.picture));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    look_at_grid(&s);
    BVXI_TRY(fit_grid_scene(context, &s));
    place_grid(&s);
    s.picture.draw = draw_grid_rows;
    s.picture.see = see_face;
    s.picture.model = &s;
    BVXI_TRY(bvxi_picture_make(context, &s.picture));
    *image = s.picture.image;
    return BVX_OK;
}
