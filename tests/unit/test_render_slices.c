/* test_render_slices.c - sheets of slices: small ones to the byte, large grids against areas added up voxel
 * by voxel, which way is up, which slices are shown, and every refusal. */
#include "render_support.h"

static const double even[3] = {1, 1, 1};

static bvx_render_options sheet_options(int32_t width, int32_t height)
{
    bvx_render_options o = options_of(width, height, 0, 0, 1);

    o.colour[0] = 10;
    o.colour[1] = 20;
    o.colour[2] = 30;
    o.background[0] = 250;
    o.background[1] = 240;
    o.background[2] = 230;
    return o;
}

static bvx_image sheet_of(const bvx_grid *g, int32_t axis, int32_t count, const bvx_render_options *o)
{
    bvx_image image = {0};
    bvx_status const s = bvx_render_slices(ctx, g, axis, count, o, &image);
    TEST_ASSERT_EQUAL_STRING("", s == BVX_OK ? "" : bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(o->width, image.width);
    TEST_ASSERT_EQUAL_INT32(o->height, image.height);
    return image;
}

/* Pixels as letters: # colour, . background, | line (a quarter of both together), ? anything else. */
static void looks_like(const bvx_image *image, const char *const *rows)
{
    for (int32_t y = 0; y < image->height; y++) {
        char seen[200];
        for (int32_t x = 0; x < image->width; x++) {
            const uint8_t *const p = pixel(image, x, y);
            seen[x] = p[0] == 10 && p[1] == 20 && p[2] == 30      ? '#'
                      : p[0] == 250 && p[1] == 240 && p[2] == 230 ? '.'
                      : p[0] == 65 && p[1] == 65 && p[2] == 65    ? '|'
                                                                  : '?';
        }
        seen[image->width] = 0;
        TEST_ASSERT_EQUAL_STRING(rows[y], seen);
    }
}

/* One slice of 4 x 3 voxels, two pixels each; up is y. */
static void test_one_slice_to_the_byte(void)
{
    static const char *const rows[8] = {"..........", ".......##.", ".......##.", ".##.......",
                                        ".##.......", ".########.", ".########.", ".........."};
    bvx_grid g = grid_of(4, 3, 1, even);
    bvx_render_options const o = sheet_options(10, 8);
    bvx_image image;

    for (int32_t x = 0; x < 4; x++) bvx_grid_set(&g, x, 0, 0, 1);
    bvx_grid_set(&g, 0, 1, 0, 1);
    bvx_grid_set(&g, 3, 2, 0, 1);
    image = sheet_of(&g, 2, 1, &o);
    looks_like(&image, rows);
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &g);
}

/* Three slices in reading order with lines between, three pixels a voxel; a fourth cell remains. */
static void test_a_sheet_to_the_byte(void)
{
    static const char *const rows[14] = {
        "######.|###...", "######.|###...", "######.|###...", "...###.|......", "...###.|......",
        "...###.|......", ".......|......", "||||||||||||||", "######.|......", "######.|......",
        "######.|......", "######.|......", "######.|......", "######.|......"};
    bvx_grid g = grid_of(2, 2, 3, even);
    bvx_render_options const o = sheet_options(14, 14);
    bvx_image image;
    /* [z][y][x] */
    static const uint8_t set[3][2][2] = {{{0, 1}, {1, 1}}, {{0, 0}, {1, 0}}, {{1, 1}, {1, 1}}};

    for (int32_t z = 0; z < 3; z++)
        for (int32_t y = 0; y < 2; y++)
            for (int32_t x = 0; x < 2; x++) bvx_grid_set(&g, x, y, z, set[z][y][x]);
    image = sheet_of(&g, 2, 3, &o);
    looks_like(&image, rows);
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &g);
}

/* ---- against areas ---- */

typedef struct rectangle {
    int32_t left, top, width, height;
} rectangle;

/* Where the one slice of a sheet stands: seen from a grid that is set all over. */
static rectangle slice_place(const bvx_grid *like, int32_t axis, const bvx_render_options *o)
{
    bvx_grid full = {0};
    bvx_image image;
    rectangle r = {0, 0, 0, 0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &like->lattice, NULL, &full));
    for (int32_t z = 0; z < full.size[2]; z++)
        for (int32_t y = 0; y < full.size[1]; y++)
            for (int32_t x = 0; x < full.size[0]; x++) bvx_grid_set(&full, x, y, z, 1);
    image = sheet_of(&full, axis, 1, o);
    for (int32_t y = 0; y < o->height; y++)
        for (int32_t x = 0; x < o->width; x++) {
            if (pixel(&image, x, y)[0] != 10) continue;
            if (r.width == 0) {
                r.left = x;
                r.top = y;
            }
            r.width = x - r.left + 1;
            r.height = y - r.top + 1;
        }
    for (int32_t y = 0; y < r.height; y++)
        for (int32_t x = 0; x < r.width; x++)
            TEST_ASSERT_EQUAL_UINT8(10, pixel(&image, r.left + x, r.top + y)[0]);
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &full);
    return r;
}

/* Length of [a, b] within [c, d]. */
static int64_t common(int64_t a, int64_t b, int64_t c, int64_t d)
{
    int64_t const low = a > c ? a : c, high = b < d ? b : d;
    return high > low ? high - low : 0;
}

/* How much of pixel i of n shows voxel v of count, in parts of count; whole
 * voxels where they are no smaller than pixels. */
static int64_t share_of_voxel(int32_t i, int32_t n, int32_t v, int32_t count)
{
    if (n < count)
        return common((int64_t)i * count, (int64_t)(i + 1) * count, (int64_t)v * n, (int64_t)(v + 1) * n);
    return i >= (int64_t)v * n / count && i < (int64_t)(v + 1) * n / count ? count : 0;
}

static void test_slices_equal_areas_added_up(void)
{
    static const int32_t size[6][3] = {{5, 4, 3},     {70, 9, 6},   {130, 64, 3},
                                       {65, 129, 40}, {3, 200, 90}, {63, 2, 127}};
    static const double uneven[3] = {0.5, 1.5, 0.25};
    int mixed = 0, whole = 0;

    random_state = 6;
    for (int s = 0; s < 6; s++)
        for (int32_t axis = 0; axis < 3; axis++)
            for (int turn = 0; turn < 4; turn++) {
                int32_t const u_axis = axis == 0 ? 1 : 0, v_axis = axis == 2 ? 1 : 2;
                bvx_grid g = grid_of(size[s][0], size[s][1], size[s][2], turn & 1 ? uneven : even);
                int32_t const nu = g.size[u_axis], nv = g.size[v_axis], slice = g.size[axis] / 2;
                bvx_render_options const o = sheet_options(turn & 2 ? 47 : 230, turn & 2 ? 31 : 170);
                rectangle const r = slice_place(&g, axis, &o);
                double const shape = nu * g.lattice.spacing[u_axis] / (nv * g.lattice.spacing[v_axis]);
                bvx_image image;
                TEST_ASSERT_TRUE(r.width >= 1 && r.height >= 1);
                if (r.width > 1)
                    TEST_ASSERT_TRUE(r.width <= shape * (r.height + 1) + 1 &&
                                     r.width + 1 >= shape * (r.height - 1));
                scatter(&g, (uint32_t)(turn * 20 + 3));
                for (int a = 0; a < 3; a++) { /* the box of the set is the whole grid */
                    int32_t at[3] = {0, 0, 0};
                    bvx_grid_set(&g, 0, 0, 0, 1);
                    at[a] = g.size[a] - 1;
                    bvx_grid_set(&g, at[0], at[1], at[2], 1);
                }
                image = sheet_of(&g, axis, 1, &o);
                for (int32_t y = 0; y < r.height; y++)
                    for (int32_t x = 0; x < r.width; x++) {
                        int64_t const all = (int64_t)nu * nv;
                        int64_t sum = 0;
                        for (int32_t v = 0; v < nv; v++) {
                            int64_t const up = share_of_voxel(r.height - 1 - y, r.height, v, nv);
                            for (int32_t u = 0; u < nu && up != 0; u++) {
                                int32_t at[3];
                                at[axis] = slice;
                                at[u_axis] = u;
                                at[v_axis] = v;
                                if (bvx_grid_get(&g, at[0], at[1], at[2]))
                                    sum += up * share_of_voxel(x, r.width, u, nu);
                            }
                        }
                        if (sum > 0 && sum < all / 4) sum = all / 4;
                        mixed += sum > 0 && sum < all;
                        whole += sum == all;
                        for (int a = 0; a < 3; a++) {
                            double const change = (double)(o.colour[a] - o.background[a]);
                            double const exact = o.background[a] + change * (double)sum / (double)all;
                            TEST_ASSERT_EQUAL_UINT8((uint8_t)(exact + 0.5),
                                                    pixel(&image, r.left + x, r.top + y)[a]);
                        }
                    }
                bvx_image_free(ctx, &image);
                bvx_grid_free(ctx, &g);
            }
    TEST_ASSERT_TRUE(mixed > 10000 && whole > 10000);
}

/* ---- which slices, and where ---- */

/* Columns of pixels that show something in cell c of a sheet, by the lines between cells. */
static int32_t columns_in_cell(const bvx_image *image, int32_t cell, int32_t *cells)
{
    int32_t across[40], down[40], n = 1, m = 1, columns = 0;

    across[0] = down[0] = -1;
    for (int32_t x = 0; x < image->width; x++)
        if (pixel(image, x, 0)[0] == 65) across[n++] = x;
    for (int32_t y = 0; y < image->height; y++)
        if (pixel(image, 0, y)[0] == 65) down[m++] = y;
    across[n] = image->width;
    down[m] = image->height;
    *cells = n * m;
    for (int32_t x = across[cell % n] + 1; x < across[cell % n + 1]; x++) {
        int any = 0;
        for (int32_t y = down[cell / n] + 1; y < down[cell / n + 1]; y++) any |= pixel(image, x, y)[0] == 10;
        columns += any;
    }
    return columns;
}

/* Each slice is a bar as long as its number, so its number can be read off. A
 * sheet of n slices shows low + (2 i + 1) length / (2 n), left to right and
 * down; slices without voxels at the ends and outside the cut do not count. */
static void test_slices_are_evenly_spread(void)
{
    enum { FIRST = 3, LAST = 40 };
    for (int cut = 0; cut < 2; cut++)
        for (int32_t axis = 0; axis < 3; axis++)
            for (int32_t count = 1; count <= 30; count += count < 8 ? 1 : 11) {
                int32_t const low = cut ? 10 : FIRST, high = cut ? 29 : LAST, u_axis = axis == 0 ? 1 : 0;
                int32_t const bars = high - FIRST + 1;
                int32_t dims[3] = {1, 1, 1}, cells, more;
                bvx_render_options o = sheet_options(1000, 700);
                bvx_image image, full;
                bvx_grid g, all;
                dims[axis] = LAST + 10;
                dims[u_axis] = LAST + 10;
                g = grid_of(dims[0], dims[1], dims[2], even);
                all = grid_of(dims[0], dims[1], dims[2], even);
                for (int32_t s = FIRST; s <= LAST; s++)
                    for (int32_t u = 0; u < LAST - FIRST + 1; u++) {
                        int32_t at[3] = {0, 0, 0};
                        at[axis] = s;
                        at[u_axis] = u;
                        bvx_grid_set(&g, at[0], at[1], at[2], u <= s - FIRST);
                        bvx_grid_set(&all, at[0], at[1], at[2], u < bars);
                    }
                if (cut) {
                    o.cut.low[axis] = g.lattice.origin[axis] + 10;
                    o.cut.high[axis] = g.lattice.origin[axis] + 30.2;
                }
                image = sheet_of(&g, axis, count, &o);
                full = sheet_of(&all, axis, count, &o);
                for (int32_t i = 0; i < count; i++) {
                    int32_t const slice = low + (2 * i + 1) * (high - low + 1) / (2 * count);
                    int32_t const width = columns_in_cell(&full, i, &more);
                    TEST_ASSERT_TRUE(width >= bars);
                    TEST_ASSERT_EQUAL_INT32((slice - FIRST + 1) * width / bars,
                                            columns_in_cell(&image, i, &cells));
                    TEST_ASSERT_EQUAL_INT32(cells, more);
                }
                TEST_ASSERT_TRUE(cells >= count);
                for (int32_t i = count; i < cells; i++)
                    TEST_ASSERT_EQUAL_INT32(0, columns_in_cell(&image, i, &more));
                bvx_image_free(ctx, &image);
                bvx_image_free(ctx, &full);
                bvx_grid_free(ctx, &g);
                bvx_grid_free(ctx, &all);
            }
}

/* One voxel in a corner: right and up on the sheet are x y, x z, y z. The
 * other voxel at the far end keeps the box. */
static void test_slices_are_the_right_way_up(void)
{
    for (int32_t axis = 0; axis < 3; axis++) {
        int32_t const u_axis = axis == 0 ? 1 : 0, v_axis = axis == 2 ? 1 : 2;
        bvx_render_options const o = sheet_options(100, 100);
        for (int corner = 0; corner < 4; corner++) {
            bvx_grid g = grid_of(8, 8, 8, even);
            int32_t at[3] = {0, 0, 0}, other[3] = {0, 0, 0};
            bvx_image image;
            at[u_axis] = corner & 1 ? 7 : 0;
            at[v_axis] = corner & 2 ? 7 : 0;
            other[u_axis] = 7 - at[u_axis];
            other[v_axis] = 7 - at[v_axis];
            other[axis] = 7;
            bvx_grid_set(&g, at[0], at[1], at[2], 1);
            bvx_grid_set(&g, other[0], other[1], other[2], 1);
            at[axis] = 4; /* the slice that is shown */
            bvx_grid_set(&g, at[0], at[1], at[2], 1);
            image = sheet_of(&g, axis, 1, &o);
            TEST_ASSERT_EQUAL_UINT8(10, pixel(&image, corner & 1 ? 90 : 9, corner & 2 ? 9 : 90)[0]);
            TEST_ASSERT_EQUAL_UINT8(250, pixel(&image, corner & 1 ? 9 : 90, corner & 2 ? 90 : 9)[0]);
            bvx_image_free(ctx, &image);
            bvx_grid_free(ctx, &g);
        }
    }
}

/* Sheets of all sizes down to one pixel, more slices than voxels and than
 * pixels: drawn, without a write outside. */
static void test_sheets_of_odd_sizes_are_drawn(void)
{
    static const int32_t sides[5] = {1, 2, 5, 33, 400}, counts[5] = {1, 2, 7, 40, 1024};
    bvx_grid g = grid_of(70, 6, 30, even);

    random_state = 2;
    scatter(&g, 50);
    for (int w = 0; w < 5; w++)
        for (int h = 0; h < 5; h++)
            for (int c = 0; c < 5; c++) {
                bvx_render_options const o = sheet_options(sides[w], sides[h]);
                bvx_image image = sheet_of(&g, (w + h + c) % 3, counts[c], &o);
                int shown = 0;
                for (int32_t i = 0; i < o.width * o.height; i++)
                    shown += pixel(&image, i % o.width, i / o.width)[0] < 250;
                TEST_ASSERT_TRUE(shown > 0);
                bvx_image_free(ctx, &image);
            }
    bvx_grid_free(ctx, &g);
}

static void test_slices_are_the_same_for_all_threads(void)
{
    static const int32_t counts[3] = {1, 2, 8};
    bvx_grid g = grid_of(131, 90, 70, even);

    random_state = 3;
    scatter(&g, 10);
    for (int32_t axis = 0; axis < 3; axis++) {
        bvx_image first = {0}, image = {0};
        for (int turn = 0; turn < 3; turn++) {
            bvx_context *const c = suite_context(counts[turn], BVX_CPU_BEST);
            bvx_render_options const o = sheet_options(210, 177);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_slices(c, &g, axis, 7, &o, turn ? &image : &first));
            if (turn) same_pictures(&first, &image);
            bvx_image_free(c, &image);
            bvx_context_destroy(c);
        }
        bvx_image_free(ctx, &first);
    }
    bvx_grid_free(ctx, &g);
}

/* ---- refusals ---- */

static void refused_sheet(bvx_status expected, const bvx_grid *g, int32_t axis, int32_t count,
                          const bvx_render_options *o, const char *word)
{
    bvx_image image = {0};
    TEST_ASSERT_EQUAL_INT32(expected, bvx_render_slices(ctx, g, axis, count, o, &image));
    TEST_ASSERT_NULL(image.pixels);
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), word));
}

static void test_slices_refuse_bad_arguments(void)
{
    bvx_grid g = grid_of(66, 5, 4, even), empty = grid_of(66, 5, 4, even);
    bvx_render_options const good = sheet_options(50, 50);
    bvx_render_options o = good;
    bvx_image image = {0};
    uint8_t byte = 0;

    bvx_grid_set(&g, 65, 1, 1, 1);
    refused_sheet(BVX_ERR_ARGUMENT, &g, -1, 1, &o, "axis is -1");
    refused_sheet(BVX_ERR_ARGUMENT, &g, 3, 1, &o, "axis is 3");
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 0, &o, "0 slices");
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 1025, &o, "1025 slices");
    refused_sheet(BVX_ERR_ARGUMENT, NULL, 0, 1, &o, "grid");
    refused_sheet(BVX_ERR_EMPTY, &empty, 0, 1, &o, "no voxel is set");
    o.width = -1;
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 1, &o, "width is -1");
    o = good;
    o.smooth = 2;
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 1, &o, "smooth");
    o = good;
    o.samples = 5;
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 1, &o, "samples");
    o = good;
    o.cut.sides = 64;
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 1, &o, "sides is 64");
    o = good;
    o.cut.high[1] = (double)NAN;
    refused_sheet(BVX_ERR_ARGUMENT, &g, 0, 1, &o, "along y");
    o = good;
    o.cut.high[0] = g.lattice.origin[0] + 65.4; /* just before the only voxel's centre */
    refused_sheet(BVX_ERR_EMPTY, &g, 0, 1, &o, "no voxel");
    o.cut.high[0] = g.lattice.origin[0];
    refused_sheet(BVX_ERR_EMPTY, &g, 0, 1, &o, "cut");
    image.pixels = &byte;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_slices(ctx, &g, 0, 1, &good, &image));
    TEST_ASSERT_EQUAL_PTR(&byte, image.pixels);
    image.pixels = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_slices(ctx, &g, 0, 1, &good, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_slices(NULL, &g, 0, 1, &good, &image));
    o = good; /* what is not looked at may be anything in its range */
    o.camera.direction[2] = 0;
    o.camera.up[0] = (double)NAN;
    o.smooth = o.wireframe = 1;
    image = sheet_of(&g, 0, 1, &o);
    bvx_image_free(ctx, &image);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_slices(ctx, &g, 2, 3, NULL, &image));
    TEST_ASSERT_EQUAL_INT32(1024, image.width);
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &empty);
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_one_slice_to_the_byte);
    RUN_TEST(test_a_sheet_to_the_byte);
    RUN_TEST(test_slices_equal_areas_added_up);
    RUN_TEST(test_slices_are_evenly_spread);
    RUN_TEST(test_slices_are_the_right_way_up);
    RUN_TEST(test_sheets_of_odd_sizes_are_drawn);
    RUN_TEST(test_slices_are_the_same_for_all_threads);
    RUN_TEST(test_slices_refuse_bad_arguments);
    return UNITY_END();
}
