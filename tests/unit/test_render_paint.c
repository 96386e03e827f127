/* test_render_paint.c - what is painted on a picture: colours of vertices,
 * lines along edges, and the colours of a difference of two grids. */
#include "render_support.h"

static void paint_vertex(uint64_t vertex, uint8_t red, uint8_t green, uint8_t blue, uint8_t alpha)
{
    uint8_t const colour[4] = {red, green, blue, alpha};
    memcpy(paint[vertex], colour, 4);
}

static const double corner[3] = {0, 0, 0}, along_x[3] = {10, 0, 0}, along_y[3] = {0, 10, 0};

/* ---- colours ---- */

/* One colour at all vertices is that colour in the options; alpha is not looked at. */
static void test_one_colour_everywhere_is_the_options_colour(void)
{
    bvx_render_options o = options_of(160, 120, 3, -4, 2);
    bvx_image wanted, got, other;
    double p[3];

    random_state = 8;
    no_mesh();
    for (int i = 0; i < 60; i++) {
        draw_point(p, 4);
        add_box(p[0], p[1], p[2]);
    }
    for (uint64_t t = 0; t < triangles / 3; t++) { /* some are seen from behind */
        uint32_t const c = tri[t][0];
        tri[t][0] = tri[t][1];
        tri[t][1] = c;
    }
    o.colour[0] = 90;
    o.colour[1] = 180;
    o.colour[2] = 33;
    wanted = picture_of(&o);
    painted = 1;
    for (uint64_t i = 0; i < vertices; i++) paint_vertex(i, 90, 180, 33, (uint8_t)i);
    got = picture_of(&o);
    for (size_t i = 0; i < bytes_of(&got); i++) TEST_ASSERT_UINT8_WITHIN(1, wanted.pixels[i], got.pixels[i]);
    for (uint64_t i = 0; i < vertices; i++) paint_vertex(i, 90, 180, 33, 0);
    o.colour[0] = o.colour[1] = o.colour[2] = 0; /* not looked at either */
    other = picture_of(&o);
    same_pictures(&got, &other);
    bvx_image_free(ctx, &other);
    bvx_image_free(ctx, &got);
    bvx_image_free(ctx, &wanted);
}

/* A square seen straight: the light is the same all over its middle, so a pixel's share of a white one's is
 * its colour. Colours are linear in x and y, and triangles blend linearly. */
static void test_colours_are_blended_linearly(void)
{
    for (int32_t samples = 1; samples <= 2; samples++)
        for (int smooth = 0; smooth < 2; smooth++) {
            bvx_render_options o = options_of(200, 200, 0, 0, 1);
            bvx_image white, image;
            o.samples = samples;
            o.smooth = smooth;
            no_mesh();
            add_quad(corner, along_x, along_y); /* (0,0), (10,0), (10,10), (0,10) */
            painted = 1;
            for (uint64_t i = 0; i < 4; i++) paint_vertex(i, 255, 255, 255, 255);
            white = picture_of(&o);
            paint_vertex(0, 0, 20, 200, 7);
            paint_vertex(1, 250, 20, 100, 7);
            paint_vertex(2, 250, 220, 100, 7);
            paint_vertex(3, 0, 220, 200, 7);
            image = picture_of(&o);
            for (int32_t y = 10; y < 190; y++)
                for (int32_t x = 10; x < 190; x++) {
                    double const right = (x + 0.5 - 6) / 188, up = (194 - y - 0.5) / 188;
                    double const expected[3] = {250 * right, 20 + 200 * up, 200 - 100 * right};
                    for (int a = 0; a < 3; a++) {
                        double const light = pixel(&white, x, y)[a] / 255.0;
                        TEST_ASSERT_INT_WITHIN(1, (int)(expected[a] * light + 0.5), pixel(&image, x, y)[a]);
                    }
                }
            bvx_image_free(ctx, &image);
            bvx_image_free(ctx, &white);
        }
}

/* ---- lines ---- */

/* Share of light that lines take from a pixel. */
static double ink_of(const bvx_image *lines, const bvx_image *plain, int32_t x, int32_t y)
{
    return 1.0 - pixel(lines, x, y)[1] / (double)pixel(plain, x, y)[1];
}

/* Two squares side by side: the line between them and the diagonals are one
 * pixel wide, nothing else is darker. */
static void test_wireframe_draws_lines_of_a_pixel(void)
{
    static const double next[3] = {10, 0, 0};

    for (int32_t samples = 1; samples <= 4; samples++) {
        bvx_render_options o = options_of(400, 240, 0, 0, 1);
        bvx_image plain, lines;
        o.samples = samples;
        no_mesh();
        add_quad(corner, along_x, along_y);
        add_quad(next, along_x, along_y);
        plain = picture_of(&o);
        o.wireframe = 1;
        lines = picture_of(&o);
        for (int32_t y = 40; y < 200; y += 7) { /* 18.8 pixels a unit: x from 12 to 388, y from 26 to 214 */
            double sum = 0, diagonal = 0;
            int32_t const at = (int32_t)(12 + (214 - y - 0.5)); /* of the first diagonal */
            for (int32_t x = 196; x < 204; x++) sum += ink_of(&lines, &plain, x, y);
            if (at < 190) {
                for (int32_t x = at - 4; x <= at + 4; x++) diagonal += ink_of(&lines, &plain, x, y);
                TEST_ASSERT_TRUE(diagonal > 0.78 * 1.414 * 0.85 && diagonal < 0.78 * 1.414 * 1.15);
            }
            TEST_ASSERT_TRUE(sum > 0.78 * 0.9 && sum < 0.78 * 1.1);
            TEST_ASSERT_TRUE(ink_of(&lines, &plain, 199, y) > 0.2 || ink_of(&lines, &plain, 200, y) > 0.2);
            for (int32_t x = 16; x < 190; x++)
                if (x < at - 3 || x > at + 3)
                    TEST_ASSERT_EQUAL_UINT8(pixel(&plain, x, y)[1], pixel(&lines, x, y)[1]);
        }
        bvx_image_free(ctx, &lines);
        bvx_image_free(ctx, &plain);
    }
}

/* Before a mesh with many lines stands a square: none of them shows through, and its own do. */
static void test_wireframe_hides_lines(void)
{
    static const double front[3] = {2, 2, 5}, fx[3] = {6, 0, 0}, fy[3] = {0, 6, 0};
    bvx_render_options o = options_of(300, 300, 0, 0, 1);
    bvx_image plain, lines;
    int dark = 0;

    no_mesh();
    for (int i = 0; i < 10; i++)
        for (int j = 0; j < 10; j++) {
            double const at[3] = {i, j, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
            add_quad(at, x, y);
        }
    add_quad(front, fx, fy);
    plain = picture_of(&o);
    o.wireframe = 1;
    lines = picture_of(&o);
    for (int32_t y = 72; y < 228; y++) /* 28.2 pixels a unit: the square from 65.4 to 234.6 */
        for (int32_t x = 72; x < 228; x++)
            if (x + y < 295 || x + y > 305)
                TEST_ASSERT_EQUAL_UINT8(pixel(&plain, x, y)[0], pixel(&lines, x, y)[0]);
    for (int32_t x = 12; x < 288; x++) dark += ink_of(&lines, &plain, x, 20) > 0.3;
    TEST_ASSERT_TRUE(dark >= 14 && dark <= 40); /* ten lines and ten diagonals */
    TEST_ASSERT_TRUE(ink_of(&lines, &plain, 149, 150) > 0.2 || ink_of(&lines, &plain, 150, 150) > 0.2);
    bvx_image_free(ctx, &lines);
    bvx_image_free(ctx, &plain);
}

/* Squares of 8, 5 and 2 pixels: the finer, the less of each line is left, and in the end nothing. */
static void test_wireframe_fades_where_the_mesh_is_dense(void)
{
    double last = 1;
    static const int count[3] = {23, 38, 94};

    for (int k = 0; k < 3; k++) {
        bvx_render_options o = options_of(200, 200, 0, 0, 1);
        bvx_image plain, lines;
        double sum = 0, most = 0;
        no_mesh();
        for (int i = 0; i < count[k]; i++)
            for (int j = 0; j < count[k]; j++) {
                double const at[3] = {i, j, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
                add_quad(at, x, y);
            }
        plain = picture_of(&o);
        o.wireframe = 1;
        lines = picture_of(&o);
        for (int32_t y = 20; y < 180; y++)
            for (int32_t x = 20; x < 180; x++) {
                double const ink = ink_of(&lines, &plain, x, y);
                sum += ink / (160 * 160);
                most = ink > most ? ink : most;
            }
        if (k == 0) TEST_ASSERT_TRUE(most > 0.5);
        if (k == 2) TEST_ASSERT_TRUE(sum == 0);
        TEST_ASSERT_TRUE(sum < 0.4 && most < last + 1e-9);
        last = most;
        bvx_image_free(ctx, &lines);
        bvx_image_free(ctx, &plain);
    }
}

/* Three voxels in a row, seen straight: two lines between them; those of 2 pixels have none. */
static void test_wireframe_of_grids_runs_between_voxels(void)
{
    static const double even[3] = {1, 1, 1};
    bvx_render_options o = options_of(300, 120, 0, 0, 1);
    bvx_grid g = grid_of(3, 1, 1, even);
    bvx_image plain, lines;
    for (int32_t x = 0; x < 3; x++) bvx_grid_set(&g, x, 0, 0, 1);
    plain = picture_of_grid(&g, &o);
    o.wireframe = 1;
    lines = picture_of_grid(&g, &o);
    for (int32_t y = 30; y < 90; y++) /* 94 pixels a voxel, from 9 on */
        for (int32_t x = 14; x < 286; x++) {
            double const ink = ink_of(&lines, &plain, x, y);
            int const line = x == 102 || x == 103 || x == 196 || x == 197;
            if (line) TEST_ASSERT_DOUBLE_WITHIN(0.04, 0.39, ink);
            else if (x < 101 || (x > 104 && x < 195) || x > 198)
                TEST_ASSERT_EQUAL_UINT8(pixel(&plain, x, y)[0], pixel(&lines, x, y)[0]);
        }
    bvx_image_free(ctx, &lines);
    bvx_image_free(ctx, &plain);
    bvx_grid_free(ctx, &g);

    g = grid_of(100, 40, 2, even);
    scatter(&g, 80);
    o.wireframe = 0;
    plain = picture_of_grid(&g, &o);
    o.wireframe = 1;
    lines = picture_of_grid(&g, &o);
    o.width = 2000;
    o.height = 900;
    bvx_image const large = picture_of_grid(&g, &o);
    o.wireframe = 0;
    bvx_image const large_plain = picture_of_grid(&g, &o);
    TEST_ASSERT_TRUE(memcmp(large.pixels, large_plain.pixels, bytes_of(&large)) != 0);
    for (size_t i = 0; i < bytes_of(&lines); i++) /* nearly 3 pixels a voxel: all but gone */
        TEST_ASSERT_TRUE(lines.pixels[i] <= plain.pixels[i] && lines.pixels[i] * 100 >= plain.pixels[i] * 85);
    bvx_image a = large, b = large_plain;
    bvx_image_free(ctx, &a);
    bvx_image_free(ctx, &b);
    bvx_image_free(ctx, &lines);
    bvx_image_free(ctx, &plain);
    bvx_grid_free(ctx, &g);
}

/* ---- differences ---- */

static bvx_image difference_of(const bvx_grid *before, const bvx_grid *after, const bvx_render_options *o)
{
    bvx_image image = {0};
    bvx_status const s = bvx_render_difference(ctx, before, after, o, &image);
    TEST_ASSERT_EQUAL_STRING("", s == BVX_OK ? "" : bvx_last_message(ctx));
    return image;
}

/* Against the mesh of the union's faces with colours at its vertices, from all sides. */
static void test_difference_equals_a_coloured_mesh(void)
{
    static const double even[3] = {1, 1, 1}, uneven[3] = {0.5, 1.5, 0.25};

    /* of voxels set in none, before, after, both */
    static const uint8_t colours[4][3] = {{0, 0, 0}, {200, 60, 50}, {70, 160, 70}, {200, 196, 188}};

    random_state = 31;
    for (int side = 0; side < 8; side++) {
        int32_t const n = side % 2 ? 67 : 6;
        const double *const spacing = side & 2 ? uneven : even;
        bvx_grid before = grid_of(n, 4, 3, spacing);
        bvx_grid after = grid_of(n, 4, 3, spacing);
        bvx_grid either = grid_of(n, 4, 3, spacing);
        bvx_render_options o = options_of(n == 67 ? 1400 : 152, n == 67 ? 400 : 132, side & 1 ? 0.4 : -3,
                                          side & 2 ? 2 : -2, side & 4 ? 1.1 : -1.1);
        bvx_image got, want;
        uint64_t face = 0;
        scatter(&before, 45);
        scatter(&after, 45);
        for (int32_t z = 0; z < 3; z++)
            for (int32_t y = 0; y < 4; y++)
                for (int32_t x = 0; x < n; x++)
                    bvx_grid_set(&either, x, y, z,
                                 bvx_grid_get(&before, x, y, z) | bvx_grid_get(&after, x, y, z));
        mesh_of_faces(&either);
        painted = 1;
        for (int32_t z = 0; z < 3; z++) /* in the order of mesh_of_faces: four vertices a face */
            for (int32_t y = 0; y < 4; y++)
                for (int32_t x = 0; x < n; x++) {
                    const uint8_t *const c =
                        colours[bvx_grid_get(&before, x, y, z) + 2 * bvx_grid_get(&after, x, y, z)];
                    if (!bvx_grid_get(&either, x, y, z)) continue;
                    for (int k = 0; k < 6; k++) {
                        int32_t at[3] = {x, y, z};
                        at[k / 2] += k % 2 ? 1 : -1;
                        int const outside = at[k / 2] < 0 || at[k / 2] >= either.size[k / 2];
                        if (!outside && bvx_grid_get(&either, at[0], at[1], at[2])) continue;
                        for (uint64_t v = 0; v < 4; v++) paint_vertex(4 * face + v, c[0], c[1], c[2], 9);
                        face++;
                    }
                }
        TEST_ASSERT_EQUAL_UINT64(vertices, 4 * face);
        o.samples = 1 + side / 4;
        got = difference_of(&before, &after, &o);
        want = picture_of(&o);
        if (n == 6)
            for (size_t i = 0; i < bytes_of(&got); i++)
                TEST_ASSERT_UINT8_WITHIN(4, want.pixels[i], got.pixels[i]);
        else { /* a few samples fall to the other side of an edge */ size_t astray = 0;
            for (size_t i = 0; i < bytes_of(&got); i++)
                astray += got.pixels[i] > want.pixels[i] + 4 || want.pixels[i] > got.pixels[i] + 4;
            TEST_ASSERT_TRUE(astray * 500 < bytes_of(&got));
        }
        bvx_image_free(ctx, &want);
        bvx_image_free(ctx, &got);
        bvx_grid_free(ctx, &either);
        bvx_grid_free(ctx, &after);
        bvx_grid_free(ctx, &before);
    }
}

/* A grid and itself: the grid's own picture; a grid and nothing: that
 * picture in one colour. No more memory than one. */
static void test_difference_with_itself_and_with_nothing(void)
{
    static const double even[3] = {1, 1, 1};
    static const uint8_t red[3] = {200, 60, 50}, green[3] = {70, 160, 70};
    bvx_grid g = grid_of(70, 40, 30, even), empty = grid_of(70, 40, 30, even);

    random_state = 4;
    scatter(&g, 35);
    for (int kind = 0; kind < 8; kind++) {
        bvx_render_options o = options_of(150, 110, 3, -4, 2), coloured;
        bvx_image alone, image;
        uint64_t peak;
        o.smooth = kind & 1;
        o.wireframe = kind >> 1 & 1;
        if (kind & 4) o.cut.high[1] = 120;
        bvx_memory_reset_peak(ctx);
        alone = picture_of_grid(&g, &o);
        peak = bvx_memory_peak(ctx);
        bvx_image_free(ctx, &alone);
        bvx_memory_reset_peak(ctx);
        image = difference_of(&g, &g, &o);
        TEST_ASSERT_EQUAL_UINT64(peak, bvx_memory_peak(ctx));
        alone = picture_of_grid(&g, &o);
        same_pictures(&alone, &image);
        bvx_image_free(ctx, &image);
        bvx_image_free(ctx, &alone);
        for (int after = 0; after < 2; after++) {
            coloured = o;
            memcpy(coloured.colour, after ? green : red, 3);
            alone = picture_of_grid(&g, &coloured);
            image = after ? difference_of(&empty, &g, &o) : difference_of(&g, &empty, &o);
            same_pictures(&alone, &image);
            bvx_image_free(ctx, &image);
            bvx_image_free(ctx, &alone);
        }
    }
    bvx_grid_free(ctx, &empty);
    bvx_grid_free(ctx, &g);
}

static void test_difference_is_the_same_for_all_threads(void)
{
    static const double even[3] = {1, 1, 1};
    static const int32_t counts[3] = {1, 2, 8};
    bvx_grid a = grid_of(130, 40, 30, even), b = grid_of(130, 40, 30, even);
    bvx_image first = {0}, image = {0};

    scatter(&a, 20);
    scatter(&b, 20);
    for (int turn = 0; turn < 3; turn++) {
        bvx_context *const c = suite_context(counts[turn], BVX_CPU_BEST);
        bvx_render_options o = options_of(141, 99, 3, -4, 2);
        o.wireframe = 1;
        o.cut.low[0] = 20.3;
        o.cut.high[2] = 30;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_difference(c, &a, &b, &o, turn ? &image : &first));
        if (turn) same_pictures(&first, &image);
        bvx_image_free(c, &image);
        bvx_context_destroy(c);
    }
    bvx_image_free(ctx, &first);
    bvx_grid_free(ctx, &b);
    bvx_grid_free(ctx, &a);
}

static void test_difference_refuses_what_cannot_be_compared(void)
{
    static const double even[3] = {1, 1, 1}, uneven[3] = {1, 1, 2};
    bvx_grid a = grid_of(5, 4, 3, even), b = grid_of(5, 4, 3, uneven), part = {0};
    bvx_window const w = {{1, 0, 0}, {4, 4, 3}};
    bvx_image image = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &a.lattice, &w, &part));
    bvx_grid_set(&a, 1, 1, 1, 1);
    bvx_grid_set(&b, 1, 1, 1, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_LATTICE, bvx_render_difference(ctx, &a, &b, NULL, &image));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "different lattices"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_LATTICE, bvx_render_difference(ctx, &a, &part, NULL, &image));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "windows"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_difference(ctx, &part, &part, NULL, &image));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_difference(ctx, NULL, &a, NULL, &image));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "before"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_difference(ctx, &a, NULL, NULL, &image));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "after"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_difference(ctx, &a, &a, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_difference(NULL, &a, &a, NULL, &image));
    TEST_ASSERT_NULL(image.pixels);
    bvx_grid_free(ctx, &part);
    bvx_grid_free(ctx, &b);
    bvx_grid_free(ctx, &a);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_one_colour_everywhere_is_the_options_colour);
    RUN_TEST(test_colours_are_blended_linearly);
    RUN_TEST(test_wireframe_draws_lines_of_a_pixel);
    RUN_TEST(test_wireframe_hides_lines);
    RUN_TEST(test_wireframe_fades_where_the_mesh_is_dense);
    RUN_TEST(test_wireframe_of_grids_runs_between_voxels);
    RUN_TEST(test_difference_equals_a_coloured_mesh);
    RUN_TEST(test_difference_with_itself_and_with_nothing);
    RUN_TEST(test_difference_is_the_same_for_all_threads);
    RUN_TEST(test_difference_refuses_what_cannot_be_compared);
    return UNITY_END();
}
