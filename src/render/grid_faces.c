/* grid_faces.c - a voxel set in the frame: where it lies, what the cut leaves, and its faces drawn.
 *
 * Idea: of a voxel's six faces the eye can see three. A row of such faces comes out of word operations (set
 * here, empty in the neighbour), neighbours along x in one word are drawn as one strip. All corners lie on
 * one lattice of integers in the frame (the three edges of a voxel are snapped once), so strips of different
 * lengths meet without gaps. A band of the picture visits only slices, rows and words that reach it. Two
 * sets are drawn as the union of their words, and each strip belongs to both or to one of them. */
#include "render/scenes.h"

#include <math.h>

enum { GRID_GRAIN = 4096 /* rows a piece, at least */ };

#define GRID_EDGE_ON 1e-6 /* faces turned away further than this cosine are not drawn */
#define GRID_FINE    8.0  /* steps between smaller voxels are roughness more than shape [Units: samples] */

/* ---- what the cut leaves ---- */

/* The first voxel of an axis whose centre lies at or above a place (above: beyond it), by bisection. */
static int32_t first_voxel_from(const bvx_grid *g, int axis, double place, int above)
{
    /* By bisection on the same sum that places voxels, so that rounding cannot make two answers. */
    int32_t begin = 0, end = g->size[axis];
    while (begin < end) {
        int32_t const middle = begin + (end - begin) / 2;
        double const centre = g->lattice.origin[axis] +
                              ((double)g->low[axis] + (double)middle + 0.5) * g->lattice.spacing[axis];
        if (above ? centre > place : centre >= place) end = middle;
        else begin = middle + 1;
    }
    return begin;
}

void bvxi_grid_cut(const bvx_grid *grid, const double low[3], const double high[3], int32_t begin[3],
                   int32_t end[3])
{
    for (int a = 0; a < 3; a++) {
        begin[a] = first_voxel_from(grid, a, low[a], 0);
        end[a] = first_voxel_from(grid, a, high[a], 1);
        /* A cut between two centres leaves nothing, not less than nothing. */
        if (end[a] < begin[a]) end[a] = begin[a];
    }
}

/* ---- where the set lies in the view ---- */

static void add_voxel_corners(const bvxi_grid_scene *s, int32_t i, int32_t j, int32_t k,
                              bvxi_camera_extent *e)
{
    double q[3];
    for (int32_t c = 0; c < 8; c++) {
        int64_t const n[3] = {(int64_t)i + (c & 1), (int64_t)j + (c >> 1 & 1), (int64_t)k + (c >> 2)};
        for (int a = 0; a < 3; a++)
            q[a] = s->corner[a] + (double)n[0] * s->edge[0][a] + (double)n[1] * s->edge[1][a] +
                   (double)n[2] * s->edge[2][a];
        bvxi_camera_extent_add(e, q);
    }
}

/* The extremes of a row are at its first and last voxel. */
static void extent_of_rows(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const bvxi_grid_scene *const s = user;
    const bvx_grid *const g = s->grid;
    bvxi_camera_extent e = bvxi_camera_nothing;

    /* Each piece has an extent of its own; the largest of all does not depend on their order. */
    for (uint64_t row = begin; row < end; row++) {
        int32_t j, k, first, last;
        bvxi_kept_row(s->begin, s->end, row, &j, &k);
        size_t const at = ((size_t)k * (size_t)g->size[1] + (size_t)j) * (size_t)g->words_per_row;
        if (!bvxi_row_span(g->words + at, s->also + at, s->begin, s->end, &first, &last)) continue;
        add_voxel_corners(s, first, j, k, &e);
        add_voxel_corners(s, last, j, k, &e);
    }
    s->extent[index] = e;
}

/* ---- the lattice in the frame ---- */

static int64_t snap_to_fixed(double samples, int32_t bits)
{
    return (int64_t)floor(samples * (double)((int64_t)1 << bits) + 0.5);
}

double bvxi_longest_spacing(const double spacing[3])
{
    double const most = spacing[0] > spacing[1] ? spacing[0] : spacing[1];
    return most > spacing[2] ? most : spacing[2];
}

static void place_grid(bvxi_grid_scene *s)
{
    double const voxel = bvxi_longest_spacing(s->grid->lattice.spacing) * s->picture.camera.unit *
                         s->picture.camera.scale;
    const bvxi_camera *const c = &s->picture.camera;
    int32_t const bits = s->picture.raster.fraction_bits;
    double low[3], at[3];

    for (int a = 0; a < 3; a++)
        low[a] = s->corner[a] + s->begin[0] * s->edge[0][a] + s->begin[1] * s->edge[1][a] +
                 s->begin[2] * s->edge[2][a];
    bvxi_camera_place(c, low, at);
    for (int a = 0; a < 2; a++) {
        s->base[a] = snap_to_fixed(at[a], bits);
        s->low[a] = s->high[a] = 0;
        /* Every edge is snapped once; strips are whole multiples of it and meet without gaps. */
        for (int e = 0; e < 3; e++) {
            s->step[e][a] = snap_to_fixed((a == 0 ? s->edge[e][0] : -s->edge[e][1]) * c->scale, bits);
            if (s->step[e][a] < 0) s->low[a] += (int32_t)s->step[e][a];
            else s->high[a] += (int32_t)s->step[e][a];
        }
    }
    s->base_z = at[2];
    /* Steps of voxels too small to be seen are smoothed over; larger ones show as faces. */
    s->picture.roughness = s->picture.options.smooth || voxel < GRID_FINE ? voxel : 0.0;
    s->blocky = s->picture.options.smooth ? 0.0 : voxel / GRID_FINE * (voxel / GRID_FINE);
    for (int e = 0; e < 3; e++) {
        s->step_z[e] = s->edge[e][2] * c->scale;
        /* Square to the eye's plane a face covers no sample. */
        if (c->axis[2][e] == 0.0) continue; /* never drawn */
        s->plane[e].dx = -c->axis[0][e] / c->axis[2][e];
        s->plane[e].dy = c->axis[1][e] / c->axis[2][e];
    }
}

/* Which n in [0, count) put base + n * step into [low, high]: [*begin, *end). */
static void clip_grid_range(int64_t base, int64_t step, int64_t low, int64_t high, int32_t count,
                            int32_t *begin, int32_t *end)
{
    int64_t first = 0, last = (int64_t)count - 1;

    if (step == 0) {
        if (base < low || base > high) last = -1;
    } else {
        /* The inequality is turned so that the step is positive, and divided once. */
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
    const bvxi_grid_scene *scene;
    const bvxi_raster *raster;
    bvxi_raster_rows rows;
} face_work;

static void draw_faces_of_word(const face_work *w, int axis, uint32_t id, uint64_t faces, int32_t first,
                               int32_t j, int32_t k)
{
    /* A run of set bits is one strip; along x itself faces do not join. */
    while (faces != 0) {
        int32_t const begin = bvxi_lowest(faces);
        uint64_t const rest = ~(faces >> begin); /* its lowest set bit ends the run */
        int32_t const n = axis == 0 ? 1 : rest == 0 ? BVXI_WORD_BITS : bvxi_lowest(rest);

        /* The faces of voxels [i, i + n) of a row that are square to an axis, on the side of the eye. */
        const bvxi_grid_scene *const s = w->scene;
        int const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        int64_t const length = u == 0 ? n : 1;

        int64_t at[3] = {first + begin - s->begin[0], j - s->begin[1], k - s->begin[2]};
        int32_t corner[4][2];
        bvxi_raster_plane plane = s->plane[axis];

        at[axis] += s->step_z[axis] > 0.0;
        for (int a = 0; a < 2; a++) {
            int64_t const p = s->base[a] + at[0] * s->step[0][a] + at[1] * s->step[1][a] +
                              at[2] * s->step[2][a];
            corner[0][a] = (int32_t)p;
            corner[1][a] = (int32_t)(p + length * s->step[u][a]);
            corner[2][a] = (int32_t)(p + length * s->step[u][a] + s->step[v][a]);
            corner[3][a] = (int32_t)(p + s->step[v][a]);
        }

        /* The plane through the face, for depths; low and high keep rounding inside it. */
        double const part = 1.0 / (double)((int64_t)1 << w->raster->fraction_bits);
        double const along = (double)length * s->step_z[u], across = s->step_z[v];
        plane.x = corner[0][0] * part;
        plane.y = corner[0][1] * part;
        plane.z = s->base_z + (double)at[0] * s->step_z[0] + (double)at[1] * s->step_z[1] +
                  (double)at[2] * s->step_z[2];
        plane.low = plane.z + (along < 0.0 ? along : 0.0) + (across < 0.0 ? across : 0.0);
        plane.high = plane.z + (along > 0.0 ? along : 0.0) + (across > 0.0 ? across : 0.0);
        bvxi_raster_polygon(w->raster, w->rows, (const int32_t(*)[2])corner, 4, &plane, id);
        faces = begin + n >= BVXI_WORD_BITS ? 0 : faces >> (begin + n) << (begin + n);
    }
}

typedef struct voxel_row {
    const uint64_t *first, *second; /* of the two sets; NULL outside the window */
    int kept;                       /* 0: the cut takes the row away */
} voxel_row;

static uint64_t set_in_row(const voxel_row *r, int32_t i)
{
    return r->first != NULL ? r->first[i] | r->second[i] : 0;
}

static uint64_t kept_in_row(const bvxi_grid_scene *s, const voxel_row *r, int32_t i)
{
    return r->kept ? set_in_row(r, i) & bvxi_kept_mask(s->begin, s->end, i) : 0;
}

static voxel_row row_beside(const bvxi_grid_scene *s, int32_t j, int32_t k)
{
    const bvx_grid *const g = s->grid;
    voxel_row r = {NULL, NULL, 0};
    if (j < 0 || k < 0 || j >= g->size[1] || k >= g->size[2]) return r;
    size_t const at = ((size_t)k * (size_t)g->size[1] + (size_t)j) * (size_t)g->words_per_row;
    r.first = g->words + at;
    r.second = s->also + at;
    r.kept = j >= s->begin[1] && j < s->end[1] && k >= s->begin[2] && k < s->end[2];
    return r;
}

/* Words [begin, end) of a row: a face shows where the neighbour towards the
 * eye is empty, cut away or outside the window. */
static void draw_row(const face_work *w, int32_t j, int32_t k, int32_t begin, int32_t end)
{
    const bvxi_grid_scene *const s = w->scene;
    int32_t const sign[3] = {s->step_z[0] > 0.0 ? 1 : -1, s->step_z[1] > 0.0 ? 1 : -1,
                             s->step_z[2] > 0.0 ? 1 : -1};
    voxel_row const here = row_beside(s, j, k);
    voxel_row const beside[3] = {here, row_beside(s, j + sign[1], k), row_beside(s, j, k + sign[2])};

    for (int32_t i = begin; i < end; i++) {
        uint64_t const word = kept_in_row(s, &here, i);
        int32_t const at[3] = {i, j, k};
        if (word == 0) continue;
        for (int axis = 0; axis < 3; axis++) {
            double const facing = s->picture.camera.axis[2][axis];
            int32_t const next = i + sign[0];
            uint64_t set = set_in_row(&beside[axis], i), kept = kept_in_row(s, &beside[axis], i);
            /* Nearly edge-on, a face covers no sample but might show as a line of noise. */
            if (facing < GRID_EDGE_ON && facing > -GRID_EDGE_ON) continue;
            /* Along x the neighbours are bits of the same row: shifted, with a bit of the next word. */
            if (axis == 0) {
                int const in = next >= 0 && next < s->grid->words_per_row;
                uint64_t const next_set = in ? set_in_row(&here, next) : 0;
                uint64_t const next_kept = in ? kept_in_row(s, &here, next) : 0;
                set = sign[0] > 0 ? set >> 1 | next_set << 63 : set << 1 | next_set >> 63;
                kept = sign[0] > 0 ? kept >> 1 | next_kept << 63 : kept << 1 | next_kept >> 63;
            }
            /* Faces of word at[0] of row (at[1], at[2]) to draw: apart those laid bare by the cut, and of either set. */
            if ((word & ~kept) != 0) {
                uint64_t const faces = word & ~kept;
                uint64_t const bare = word & ~kept & set;
                uint64_t const first = here.first[at[0]], second = here.second[at[0]];
                uint64_t const member[3] = {first & second, first & ~second, second & ~first};
                int32_t const x = at[0] * BVXI_WORD_BITS;
                for (int m = 0; m < 3; m++) {
                    draw_faces_of_word(w, axis, bvxi_face_id(axis, 0, m), faces & ~bare & member[m], x, at[1],
                                       at[2]);
                    draw_faces_of_word(w, axis, bvxi_face_id(axis, 1, m), bare & member[m], x, at[1], at[2]);
                }
            }
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

/* Rows reach a band by ranges of indices, worked out from the slice down to the voxel. */
void bvxi_grid_scene_draw(const void *user, const bvxi_raster *raster, bvxi_raster_rows rows)
{
    const bvxi_grid_scene *const s = user;
    face_work const w = {s, raster, rows};
    int64_t const top = (int64_t)rows.begin << raster->fraction_bits;
    int64_t const bottom = (int64_t)rows.end << raster->fraction_bits;
    int32_t const size[3] = {s->end[0] - s->begin[0], s->end[1] - s->begin[1], s->end[2] - s->begin[2]};
    int64_t const along_x = (int64_t)(size[0] - 1) * s->step[0][1];

    /* Each range is widened by what the inner loops may add: slices are left out only if no row can show. */
    int64_t const along_y = (int64_t)(size[1] - 1) * s->step[1][1];
    /* for the low corner of a voxel */
    int64_t const row_low = top - s->high[1], row_high = bottom - s->low[1];
    int64_t const y_low = row_low - greater(along_x, 0), y_high = row_high - lesser(along_x, 0);
    int64_t const z_low = y_low - greater(along_y, 0), z_high = y_high - lesser(along_y, 0);
    int32_t k, k_end, j, j_end, i, i_end;

    clip_grid_range(s->base[1], s->step[2][1], z_low, z_high, size[2], &k, &k_end);
    for (; k < k_end; k++) {
        int64_t const slice = s->base[1] + k * s->step[2][1];
        clip_grid_range(slice, s->step[1][1], y_low, y_high, size[1], &j, &j_end);
        for (; j < j_end; j++) {
            clip_grid_range(slice + j * s->step[1][1], s->step[0][1], row_low, row_high, size[0], &i, &i_end);
            if (i < i_end)
                draw_row(&w, j + s->begin[1], k + s->begin[2], (i + s->begin[0]) / BVXI_WORD_BITS,
                         (i_end - 1 + s->begin[0]) / BVXI_WORD_BITS + 1);
        }
    }
}

bvx_status bvxi_grid_scene_fit(bvx_context *ctx, bvxi_grid_scene *scene)
{
    const bvx_render_options *const o = &scene->picture.options;
    bvxi_grid_cut(scene->grid, o->cut.low, o->cut.high, scene->begin, scene->end);
    const bvx_lattice *const l = &scene->grid->lattice;
    bvxi_camera *const c = &scene->picture.camera;
    double low[3], high[3];

    for (int a = 0; a < 3; a++) {
        low[a] = l->origin[a] + scene->grid->low[a] * l->spacing[a];
        high[a] = l->origin[a] + ((double)scene->grid->low[a] + scene->grid->size[a]) * l->spacing[a];
    }

    /* The camera looks at the whole lattice, so a cut does not turn the picture. */
    bvxi_camera_look(c, low, high, scene->picture.options.camera.direction, scene->picture.options.camera.up);
    bvxi_camera_turn(c, low, scene->corner);
    /* Edges of a voxel in the camera's axes: all corners are sums of whole multiples of them. */
    for (int e = 0; e < 3; e++)
        for (int a = 0; a < 3; a++) scene->edge[e][a] = c->axis[a][e] * (l->spacing[e] * c->unit);

    bvxi_camera_extent all = bvxi_camera_nothing;

    for (int a = 0; a < 3; a++)
        if (scene->begin[a] == scene->end[a])
            return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the cut leaves no voxel", scene->picture.function);
    scene->pieces = bvxi_piece_count(bvxi_kept_rows(scene->begin, scene->end), GRID_GRAIN);
    uint64_t const size = (uint64_t)scene->pieces * sizeof *scene->extent;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size, "the picture's extents", &scene->extent));
    BVXI_TRY(bvxi_for_pieces(ctx, "render", 0.0, 0.1, scene->pieces, bvxi_kept_rows(scene->begin, scene->end),
                             extent_of_rows, scene));
    for (int32_t i = 0; i < scene->pieces; i++) bvxi_camera_extent_join(&all, &scene->extent[i]);
    bvxi_drop(ctx, scene->extent);

    if (all.low[0] > all.high[0])
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no voxel is set%s", scene->picture.function,
                         bvxi_kept_rows(scene->begin, scene->end) < bvxi_grid_rows(scene->grid) ||
                                 scene->end[0] - scene->begin[0] < scene->grid->size[0]
                             ? " where the cut leaves any"
                             : "");
    bvxi_camera_show(&scene->picture.camera, scene->picture.options.camera.show, &all);
    bvxi_camera_fit(&scene->picture.camera, &all, scene->picture.raster.width, scene->picture.raster.height);

    place_grid(scene);
    return BVX_OK;
}
