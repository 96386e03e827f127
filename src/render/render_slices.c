/* render_slices.c - a sheet of slices through a voxel set: bvx_render_slices.
 *
 * All slices show the same rectangle of voxels, the box of the set, and take the same whole number of pixels,
 * so they can be compared. Everything on the sheet is placed in integers. Along a direction that has a pixel
 * or more for each voxel a pixel shows one voxel; where voxels are smaller it shows the share of them that is
 * set, by exact areas, and at least a quarter of the colour where any is, so that thin walls do not
 * vanish. */
#include "render/scenes.h"

#include <math.h>

enum {
    SLICES_MOST = 1024,
    SLICES_GRAIN = 4096 /* rows a piece, at least */,
    SLICES_LEAST = 4 /* one part in it shows */
};

/* A direction on the sheet: voxels shown, and pixels for them. */
typedef struct sheet_side {
    int32_t axis; /* of the grid */
    int32_t begin, voxels;
    int32_t pixels;        /* of a slice */
    int32_t cells, length; /* on the sheet; pixels of the whole sheet */
} sheet_side;

typedef struct slice_sheet {
    const bvx_grid *grid;
    const char *function;
    bvx_render_options options;
    int32_t axis, count;
    int32_t begin[3], end[3]; /* voxels that the cut leaves; later the box of those that are set */
    int32_t (*box)[2][3];     /* of each piece of rows: least and greatest voxel */
    int32_t pieces;
    sheet_side right, up;
    bvx_image image;
    uint8_t line[3];
} slice_sheet;

/* ---- the box of the set ---- */

static void box_of_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const slice_sheet *const s = user;
    const bvx_grid *const g = s->grid;
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};

    for (uint64_t row = begin; row < end; row++) {
        int32_t first[3], last[3];
        bvxi_kept_row(s->begin, s->end, row, &first[1], &first[2]);
        size_t const at = ((size_t)first[2] * (size_t)g->size[1] + (size_t)first[1]) *
                          (size_t)g->words_per_row;
        if (!bvxi_row_span(g->words + at, g->words + at, s->begin, s->end, &first[0], &last[0])) continue;
        last[1] = first[1];
        last[2] = first[2];
        for (int a = 0; a < 3; a++) {
            low[a] = first[a] < low[a] ? first[a] : low[a];
            high[a] = last[a] > high[a] ? last[a] : high[a];
        }
    }
    memcpy(s->box[index][0], low, sizeof low);
    memcpy(s->box[index][1], high, sizeof high);
}

static bvx_status find_slice_box(bvx_context *ctx, slice_sheet *s)
{
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};

    /* The cut is what may be shown; the box of what is set in it is what will be. */
    bvxi_grid_cut(s->grid, s->options.cut.low, s->options.cut.high, s->begin, s->end);
    for (int a = 0; a < 3; a++)
        if (s->begin[a] == s->end[a])
            return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the cut leaves no voxel", s->function);
    s->pieces = bvxi_piece_count(bvxi_kept_rows(s->begin, s->end), SLICES_GRAIN);
    uint64_t const size = (uint64_t)s->pieces * sizeof *s->box;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size, "the sheet's boxes", &s->box));
    BVXI_TRY(bvxi_for_pieces(ctx, "render", 0.0, 0.3, s->pieces, bvxi_kept_rows(s->begin, s->end),
                             box_of_piece, s));
    for (int32_t i = 0; i < s->pieces; i++)
        for (int a = 0; a < 3; a++) {
            low[a] = s->box[i][0][a] < low[a] ? s->box[i][0][a] : low[a];
            high[a] = s->box[i][1][a] > high[a] ? s->box[i][1][a] : high[a];
        }
    bvxi_drop(ctx, s->box);
    if (high[0] < 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: no voxel is set in what is shown", s->function);

    /* All slices show this one rectangle, so they can be compared. */
    for (int a = 0; a < 3; a++) {
        s->begin[a] = low[a];
        s->end[a] = high[a] + 1;
    }
    return BVX_OK;
}

/* ---- the sheet ---- */

static int32_t cell_begin(const sheet_side *side, int32_t cell)
{
    return (int32_t)((int64_t)cell * side->length / side->cells);
}

/* Pixels of the smallest cell that a slice may take: less the line and a margin. */
static int32_t room_in_cell(int32_t length, int32_t cells)
{
    int32_t const cell = length / cells, margin = cell / 32 + (cell >= 8);
    return cell > 2 * margin + 1 ? cell - 2 * margin - (cells > 1) : 1;
}

static int32_t slice_pixels(double size, double scale, int32_t room)
{
    double const n = floor(size * scale + 0.5);
    return n < 1.0 ? 1 : n > room ? room : (int32_t)n;
}

/* The fewest columns that show slices largest. Sizes are divided by the larger one. */
static void lay_out_sheet(slice_sheet *s)
{
    const double *const spacing = s->grid->lattice.spacing;
    double const longest = bvxi_longest_spacing(spacing);
    double best = 0.0, w, h;

    s->right.axis = s->axis == 0 ? 1 : 0;
    s->up.axis = s->axis == 2 ? 1 : 2;
    for (int side = 0; side < 2; side++) {
        sheet_side *const a = side == 0 ? &s->right : &s->up;
        a->begin = s->begin[a->axis];
        a->voxels = s->end[a->axis] - a->begin;
        a->length = side == 0 ? s->options.width : s->options.height;
        a->cells = 1;
    }

    /* Divided by the longest spacing, so that no size overflows. */
    w = s->right.voxels * (spacing[s->right.axis] / longest);
    h = s->up.voxels * (spacing[s->up.axis] / longest);
    for (int32_t columns = 1; columns <= s->count; columns++) {
        /* Pixels a world unit that fit a slice of w x h into cells of a sheet of so many columns. */
        int32_t const rows = (s->count + columns - 1) / columns;
        double const across = room_in_cell(s->options.width, columns) / w;
        double const upwards = room_in_cell(s->options.height, rows) / h;
        double const scale = across < upwards ? across : upwards;

        if (scale <= best) continue;
        best = scale;
        s->right.cells = columns;
        s->up.cells = (s->count + columns - 1) / columns;
    }
    s->right.pixels = slice_pixels(w, best, room_in_cell(s->right.length, s->right.cells));
    s->up.pixels = slice_pixels(h, best, room_in_cell(s->up.length, s->up.cells));
    /* Half as bright as the mean of both colours, so a line shows on either. */
    for (int a = 0; a < 3; a++) s->line[a] = (uint8_t)((s->options.colour[a] + s->options.background[a]) / 4);
}

/* ---- pixels ---- */

/* Voxels [*begin, *end) that a pixel shows, and the shares of the first and the last one; whole is that of
 * those between.
 * In units where the slice is voxels * pixels long, a pixel is as long as there are voxels. */
typedef struct pixel_span {
    int32_t begin, end;
    int64_t first, last, whole;
} pixel_span;

static pixel_span span_of_pixel(const sheet_side *side, int32_t pixel)
{
    /* In these units both a pixel's and a voxel's borders are whole numbers, so shares are exact. */
    int64_t const low = (int64_t)pixel * side->voxels, high = low + side->voxels, voxel = side->pixels;
    pixel_span s = {(int32_t)(low / voxel), (int32_t)((high + voxel - 1) / voxel), side->voxels, 0, voxel};
    if (side->pixels >= side->voxels) s.begin = s.end - 1; /* the voxel in which its end lies */
    else {
        s.first = (s.begin + 1) * voxel - low;
        s.last = high - (s.end - 1) * voxel;
    }
    s.begin += side->begin;
    s.end += side->begin;
    return s;
}

static int64_t slice_bit(const uint64_t *row, int32_t x)
{
    return (int64_t)(row[x >> 6] >> (x & 63) & 1);
}

static int64_t count_slice_run(const uint64_t *row, int32_t begin, int32_t end)
{
    int64_t count = 0;
    for (int32_t x = begin; x < end;) {
        int32_t const next = (x & ~63) + 64 < end ? (x & ~63) + 64 : end;
        uint64_t const mask = (next & 63) != 0 ? bvxi_tail_mask(next) : ~UINT64_C(0);
        count += bvxi_popcount(row[x >> 6] & mask & ~UINT64_C(0) << (x & 63));
        x = next;
    }
    return count;
}

/* Share of a pixel's voxels that is set, along the row at v of a slice. */
static int64_t sum_along_right(const slice_sheet *s, const pixel_span *p, int32_t slice, int32_t v)
{
    const bvx_grid *const g = s->grid;
    int64_t sum = 0;

    if (s->axis == 0) { /* rows run into the sheet */
        for (int32_t u = p->begin; u < p->end; u++) {
            int64_t const share = u == p->begin ? p->first : u == p->end - 1 ? p->last : p->whole;
            sum += share * slice_bit(bvxi_grid_row(g, u, v), slice);
        }
        return sum;
    }

    const uint64_t *const row = s->axis == 1 ? bvxi_grid_row(g, slice, v) : bvxi_grid_row(g, v, slice);
    sum = p->first * slice_bit(row, p->begin);
    if (p->end - p->begin == 1) return sum;
    return sum + p->whole * count_slice_run(row, p->begin + 1, p->end - 1) +
           p->last * slice_bit(row, p->end - 1);
}

static void draw_slice_pixel(const slice_sheet *s, const pixel_span *right, const pixel_span *up,
                             int32_t slice, uint8_t *pixel)
{
    int64_t const all = (int64_t)s->right.voxels * s->up.voxels; /* below 2^50 */
    int64_t sum = 0;
    for (int32_t v = up->begin; v < up->end; v++) {
        int64_t const share = v == up->begin ? up->first : v == up->end - 1 ? up->last : up->whole;
        sum += share * sum_along_right(s, right, slice, v);
    }
    if (sum == 0) return;
    /* So little that it would not show is raised until it does. */
    if (sum < all / SLICES_LEAST) sum = all / SLICES_LEAST;
    for (int a = 0; a < 3; a++)
        pixel[a] = (uint8_t)((s->options.background[a] * (all - sum) + s->options.colour[a] * sum + all / 2) /
                             all);
}

static void draw_sheet_row(const slice_sheet *s, int32_t y, uint8_t *row)
{
    int32_t cell = 0, inside;

    /* The row of cells in which the pixel lies, and where it lies inside the slice; the slice is centred. */
    while (cell + 1 < s->up.cells && cell_begin(&s->up, cell + 1) <= y) cell++;
    inside = y - cell_begin(&s->up, cell);
    inside -= (cell_begin(&s->up, cell + 1) - cell_begin(&s->up, cell) + (cell > 0) - s->up.pixels) / 2;
    for (int32_t column = 0; column < s->right.cells; column++) {
        int64_t const number = (int64_t)cell * s->right.cells + column;
        int32_t const begin = cell_begin(&s->right, column), end = cell_begin(&s->right, column + 1);
        int32_t const left = begin + (end - begin + (column > 0) - s->right.pixels) / 2;
        int64_t const length = s->end[s->axis] - s->begin[s->axis];
        if (number >= s->count || inside < 0 || inside >= s->up.pixels) continue;
        int32_t const slice = s->begin[s->axis] +
                              (int32_t)((2 * number + 1) * length / (2 * (int64_t)s->count));
        /* Rows of pixels run down, voxels up. */
        pixel_span up = span_of_pixel(&s->up, s->up.pixels - 1 - inside);
        for (int32_t x = 0; x < s->right.pixels && left + x < s->right.length; x++) {
            pixel_span const right = span_of_pixel(&s->right, x);
            draw_slice_pixel(s, &right, &up, slice, row + (size_t)(left + x) * 3);
        }
    }
}

/* Lines stand on the first pixels of cells, but for the first cell; cells of a few pixels have none. */
static int is_sheet_line(const sheet_side *side, int32_t at)
{
    int64_t const cell = ((int64_t)at * side->cells + side->cells - 1) / side->length;
    return side->length / side->cells >= 4 && cell > 0 && cell < side->cells &&
           cell_begin(side, (int32_t)cell) == at;
}

static void draw_sheet_band(void *user, int32_t index)
{
    const slice_sheet *const s = user;
    int32_t const begin = index * BVXI_PICTURE_BAND, height = s->image.height;
    int32_t const end = begin + BVXI_PICTURE_BAND < height ? begin + BVXI_PICTURE_BAND : height;
    for (int32_t y = begin; y < end; y++) {
        uint8_t *const row = s->image.pixels + (size_t)y * (size_t)s->image.width * 3;
        int const across = is_sheet_line(&s->up, y);
        for (int32_t x = 0; x < s->image.width; x++)
            memcpy(row + (size_t)x * 3,
                   across || is_sheet_line(&s->right, x) ? s->line : s->options.background, 3);
        draw_sheet_row(s, y, row);
    }
}

static bvx_status make_sheet(bvx_context *ctx, slice_sheet *s)
{
    uint64_t const size = (uint64_t)s->options.width * (uint64_t)s->options.height * 3;
    int32_t const bands = (s->options.height + BVXI_PICTURE_BAND - 1) / BVXI_PICTURE_BAND;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, size, "the picture's pixels", &s->image.pixels));
    s->image.width = s->options.width;
    s->image.height = s->options.height;
    bvx_status const status = bvxi_each(ctx, "render", 0.3, 1.0, bands, draw_sheet_band, s);
    if (status != BVX_OK) bvx_image_free(ctx, &s->image);
    return status;
}

static bvx_status run_render_slices(bvx_context *context, const bvx_grid *grid, int32_t axis, int32_t count,
                                    const bvx_render_options *options, bvx_image *image)
{
    static const char *const function = "bvx_render_slices";
    slice_sheet s = {0};

    BVXI_TRY(bvxi_picture_options(context, function, options, image, 0, &s.options));
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    if (axis < 0 || axis > 2)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: axis is %d, not 0, 1 or 2",
                             function, (int64_t)axis);
    if (count < 1 || count > SLICES_MOST)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: %d slices are outside 1 to %d",
                             function, (int64_t)count, (int64_t)SLICES_MOST);
    s.grid = grid;
    s.function = function;
    s.axis = axis;
    s.count = count;
    BVXI_TRY(find_slice_box(context, &s));
    lay_out_sheet(&s);
    BVXI_TRY(make_sheet(context, &s));
    bvx_image_free(context, image);
    *image = s.image;
    return BVX_OK;
}

bvx_status bvx_render_slices(bvx_context *context, const bvx_grid *grid, int32_t axis, int32_t count,
                             const bvx_render_options *options, bvx_image *image)
{
    return BVXI_CALL(context, run_render_slices(context, grid, axis, count, options, image));
}
