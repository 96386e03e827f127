/* test_render.c - pictures: where something is seen and where nothing is,
 * what hides what, the same bytes from any threads and any kind of view, and
 * every refusal. No stored pictures: what must be seen is worked out here. */
#include "render_support.h"

/* ---- where something is seen ---- */

/* A box seen along z in a square of 100 pixels fills 94 of them: from 3 to 97 on both sides, to the pixel. */
static void test_render_mesh_shows_a_box_where_it_is(void)
{
    for (int32_t samples = 1; samples <= 4; samples++)
        for (int32_t sign = -1; sign <= 1; sign += 2) {
            bvx_render_options o = options_of(100, 100, 0, 0, sign);
            bvx_image image;
            o.samples = samples;
            no_mesh();
            add_box(5, -7, 2);
            image = picture_of(&o);
            for (int32_t y = 0; y < 100; y++)
                for (int32_t x = 0; x < 100; x++)
                    TEST_ASSERT_EQUAL_INT(x < 3 || x >= 97 || y < 3 || y >= 97, is_background(&image, x, y));
            bvx_image_free(ctx, &image);
        }
}

/* Seen along (3,0,4)/5 with y upwards, the right of the picture is (4,0,-3)/5: the box is 7/5 wide and 1
 * high. In 140 x 140 pixels it fills 131.6 x 94: from 4.2 to 135.8 and from 23 to 117. */
static void test_render_mesh_turns_by_whole_numbers(void)
{
    bvx_render_options o = options_of(140, 140, 3, 0, 4);
    bvx_image image;

    o.camera.up[1] = 1;
    o.camera.up[2] = 0;
    no_mesh();
    add_box(0, 0, 0);
    image = picture_of(&o);
    for (int32_t y = 0; y < 140; y++)
        for (int32_t x = 0; x < 140; x++)
            if (x != 4 && x != 135)
                TEST_ASSERT_EQUAL_INT(x < 4 || x > 135 || y < 23 || y >= 117, is_background(&image, x, y));

    /* the edge between the sides z high (4/5 wide, brighter: it faces the
     * eye more) and x high stands at 4.2 + 75.2 */
    TEST_ASSERT_TRUE(pixel(&image, 70, 70)[0] > pixel(&image, 100, 70)[0]);
    for (int32_t x = 10; x < 77; x++)
        TEST_ASSERT_UINT8_WITHIN(1, pixel(&image, 40, 70)[0], pixel(&image, x, 70)[0]);
    for (int32_t x = 82; x < 130; x++)
        TEST_ASSERT_UINT8_WITHIN(1, pixel(&image, 100, 70)[0], pixel(&image, x, 70)[0]);
    bvx_image_free(ctx, &image);
}

/* How far right of the line from a to b a point lies, times its length. */
static double side_of(const double a[2], const double b[2], double x, double y)
{
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0]);
}

/* Random triangles seen along z against a test of every sample's centre by
 * itself; samples within a hair of an edge may fall either way. */
static void test_render_mesh_covers_what_triangles_cover(void)
{
    enum { SIDE = 90 };
    for (int round = 0; round < 8; round++) {
        bvx_render_options o = options_of(SIDE, SIDE, 0, 0, 1);
        double low[2] = {9, 9}, high[2] = {-9, -9}, scale, place[60][2];
        bvx_image image;
        random_state = (uint64_t)round + 1;
        no_mesh();
        for (int t = 0; t < 20; t++) {
            double corner[3], p[3];
            uint32_t n[3];
            draw_point(corner, 1);
            for (int k = 0; k < 3; k++) {
                draw_point(p, t % 3 == 0 ? 0.9 : 0.1);
                n[k] = add_vertex(corner[0] + p[0], corner[1] + p[1], corner[2] + p[2]);
            }
            add_triangle(n[0], n[1], n[2]);
        }
        for (uint64_t v = 0; v < vertices; v++)
            for (int a = 0; a < 2; a++) {
                low[a] = xyz[v][a] < low[a] ? xyz[v][a] : low[a];
                high[a] = xyz[v][a] > high[a] ? xyz[v][a] : high[a];
            }
        scale = 0.94 * SIDE / (high[0] - low[0] > high[1] - low[1] ? high[0] - low[0] : high[1] - low[1]);
        for (uint64_t v = 0; v < vertices; v++) { /* up is z, the direction: y takes its place, x is right */
            place[v][0] = SIDE / 2.0 + (xyz[v][0] - (low[0] + high[0]) / 2) * scale;
            place[v][1] = SIDE / 2.0 - (xyz[v][1] - (low[1] + high[1]) / 2) * scale;
        }
        o.samples = 1;
        image = picture_of(&o);
        for (int32_t y = 0; y < SIDE; y++)
            for (int32_t x = 0; x < SIDE; x++) {
                int covered = 0, close = 0;
                for (uint64_t t = 0; t < triangles; t++) {
                    double least = 9e9, most = -9e9;
                    for (int k = 0; k < 3; k++) {
                        double const s = side_of(place[tri[t][k]], place[tri[t][(k + 1) % 3]], x + 0.5,
                                                 y + 0.5);
                        least = s < least ? s : least;
                        most = s > most ? s : most;
                    }
                    if (least > 1e-3 || most < -1e-3) covered = 1;
                    else if (least > -1e-3 || most < 1e-3) close = 1;
                }
                if (covered || !close) TEST_ASSERT_EQUAL_INT(!covered, is_background(&image, x, y));
            }
        bvx_image_free(ctx, &image);
    }
}

/* A torn sheet would show the background: 50 x 50 crooked squares, each two triangles, in a flat frame. */
static void test_render_mesh_leaves_no_gap_between_neighbours(void)
{
    enum { N = 50, SIDE = 200 };
    static const int32_t samples[2] = {1, 3};
    random_state = 77;
    no_mesh();
    for (int y = 0; y <= N; y++)
        for (int x = 0; x <= N; x++) {
            int const border = x == 0 || y == 0 || x == N || y == N;
            double p[3];
            draw_point(p, border ? 0 : 0.45);
            add_vertex(x + p[0], y + p[1], p[2]);
        }
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++) {
            uint32_t const a = y * (N + 1) + x;
            add_triangle(a, a + 1, a + N + 2);
            add_triangle(a, a + N + 2, a + N + 1);
        }
    for (int s = 0; s < 2; s++) {
        bvx_render_options o = options_of(SIDE, SIDE, 0, 0, 1);
        bvx_image image;
        o.samples = samples[s];
        o.background[0] = 255; /* yellow between greys stands out even at a ninth of a pixel */
        o.background[1] = 255;
        o.background[2] = 0;
        image = picture_of(&o);
        for (int32_t y = 7; y < SIDE - 7; y++)
            for (int32_t x = 7; x < SIDE - 7; x++) {
                const uint8_t *const p = pixel(&image, x, y);
                TEST_ASSERT_INT_WITHIN(20, p[0], p[2]); /* grey all over, or reddish: never yellow */
            }
        bvx_image_free(ctx, &image);
    }
}

/* ---- what hides what ---- */

static int is_reddish(const uint8_t *p)
{
    return p[0] > p[2] + 40;
}

/* A small square before a large one, which shows its back: the middle is
 * grey and the rim reddish, in either order. */
static void test_render_mesh_shows_the_nearer_and_tints_insides(void)
{
    static const double far_corner[3] = {0, 0, 0}, near_corner[3] = {3, 3, 5}, fx[3] = {10, 0, 0},
                        fy[3] = {0, 10, 0}, nx[3] = {4, 0, 0}, ny[3] = {0, 4, 0};
    bvx_render_options const o = options_of(100, 100, 0, 0, 1);

    for (int order = 0; order < 2; order++) {
        bvx_image image;
        no_mesh();
        if (order == 0) add_quad(near_corner, nx, ny);
        add_quad(far_corner, fy, fx); /* turned round: its outside looks away */
        if (order == 1) add_quad(near_corner, nx, ny);
        image = picture_of(&o);
        TEST_ASSERT_FALSE(is_reddish(pixel(&image, 50, 50)));
        TEST_ASSERT_FALSE(is_background(&image, 50, 50));
        TEST_ASSERT_TRUE(is_reddish(pixel(&image, 10, 10)));
        TEST_ASSERT_TRUE(is_reddish(pixel(&image, 80, 50)));
        bvx_image_free(ctx, &image);
    }
}

/* A flat sheet has one normal, so smooth changes nothing, from either side. */
static void test_render_mesh_smooth_leaves_a_flat_sheet_alone(void)
{
    static const double corner[3] = {0, 0, 0}, x[3] = {10, 0, 0}, y[3] = {0, 10, 0};

    for (int side = 0; side < 2; side++) {
        bvx_render_options o = options_of(80, 60, 1, 2, side ? 3 : -3);
        bvx_image flat, smooth;
        no_mesh();
        add_quad(corner, x, y);
        flat = picture_of(&o);
        o.smooth = 1;
        smooth = picture_of(&o);
        TEST_ASSERT_EQUAL_INT(!side, is_reddish(pixel(&flat, 40, 30)));
        for (size_t i = 0; i < bytes_of(&flat); i++)
            TEST_ASSERT_UINT8_WITHIN(1, flat.pixels[i], smooth.pixels[i]);
        bvx_image_free(ctx, &smooth);
        bvx_image_free(ctx, &flat);
    }
}

/* A floor in front of a wall is darker in the corner than out in the open. */
static void test_render_mesh_darkens_corners(void)
{
    static const double corner[3] = {0, 0, 0}, x[3] = {10, 0, 0}, y[3] = {0, 10, 0}, z[3] = {0, 0, 10};
    bvx_render_options o = options_of(200, 200, 0, -1, 1);
    bvx_image image;
    double back[3] = {0, 10, 0};

    no_mesh();
    add_quad(corner, x, y);
    add_quad(back, x, z);
    image = picture_of(&o); /* 10 sqrt(2) high: the corner stands in the middle */
    TEST_ASSERT_TRUE(pixel(&image, 100, 104)[0] + 15 < pixel(&image, 100, 170)[0]);
    TEST_ASSERT_TRUE(pixel(&image, 100, 95)[0] + 15 < pixel(&image, 100, 30)[0]);
    bvx_image_free(ctx, &image);
}

/* ---- grids ---- */

/* Grids of many shapes from all sides against the mesh of their faces: the same samples are covered, and
 * where voxels are large enough to be seen singly the shades are the same too. */
static void test_render_grid_equals_the_mesh_of_its_faces(void)
{
    static const int32_t size[4][3] = {{5, 4, 3}, {70, 3, 2}, {1, 1, 1}, {65, 9, 4}};
    static const double even[3] = {0.5, 0.5, 0.5}, uneven[3] = {0.5, 1.5, 0.25};

    random_state = 5;
    for (int s = 0; s < 4; s++)
        for (int side = 0; side < 12; side++) {
            bvx_grid g = grid_of(size[s][0], size[s][1], size[s][2], side % 2 ? uneven : even);
            bvx_render_options o = options_of(152, 132, side & 1 ? 3 : -3, side & 2 ? 2 : -2,
                                              side & 4 ? 1.1 : -1.1);
            bvx_image of_grid = {0}, of_mesh;
            if (side >= 8) o.camera.direction[(side - 8) % 3] = 0;
            o.samples = 1 + side % 2;
            scatter(&g, s == 2 ? 100 : 60);
            if (s == 0) bvx_grid_set(&g, 0, 0, 0, 1);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_grid(ctx, &g, &o, &of_grid));
            mesh_of_faces(&g);
            of_mesh = picture_of(&o);
            for (int32_t y = 0; y < o.height; y++)
                for (int32_t x = 0; x < o.width; x++)
                    TEST_ASSERT_EQUAL_INT(is_background(&of_mesh, x, y), is_background(&of_grid, x, y));
            if (s == 0)
                for (size_t i = 0; i < bytes_of(&of_mesh); i++)
                    TEST_ASSERT_UINT8_WITHIN(4, of_mesh.pixels[i], of_grid.pixels[i]);
            bvx_image_free(ctx, &of_mesh);
            bvx_image_free(ctx, &of_grid);
            bvx_grid_free(ctx, &g);
        }
}

static void fill_ball(bvx_grid *g)
{
    int32_t const n = g->size[0];
    for (int32_t z = 0; z < n; z++)
        for (int32_t y = 0; y < n; y++)
            for (int32_t x = 0; x < n; x++) {
                int32_t const a = 2 * x + 1 - n, b = 2 * y + 1 - n, c = 2 * z + 1 - n;
                if (a * a + b * b + c * c < n * n) bvx_grid_set(g, x, y, z, 1);
            }
}

/* A ball of voxels, smooth, is brightest where it faces the light and has
 * no steps: neighbouring pixels differ little. */
static void test_render_grid_smooth_shows_a_ball(void)
{
    static const double even[3] = {1, 1, 1};
    bvx_grid g = grid_of(100, 100, 100, even);
    bvx_render_options o = options_of(200, 200, 3, -4, 2);
    bvx_image image = {0};

    o.smooth = 1;
    fill_ball(&g);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_grid(ctx, &g, &o, &image));
    for (int32_t y = 0; y < 200; y++)
        for (int32_t x = 0; x < 199; x++) {
            int32_t const d2 = (2 * x + 1 - 200) * (2 * x + 1 - 200) + (2 * y + 1 - 200) * (2 * y + 1 - 200);
            if (d2 > 200 * 200) TEST_ASSERT_TRUE(is_background(&image, x, y));
            if (d2 < 130 * 130)
                TEST_ASSERT_UINT8_WITHIN(16, pixel(&image, x, y)[0], pixel(&image, x + 1, y)[0]);
        }
    TEST_ASSERT_TRUE(pixel(&image, 75, 70)[0] > pixel(&image, 150, 150)[0] + 40);
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &g);
}

static void test_render_grid_refuses_an_empty_set(void)
{
    static const double even[3] = {1, 1, 1};
    bvx_grid g = grid_of(65, 2, 2, even);
    bvx_image image = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_grid(ctx, &g, NULL, &image));
    TEST_ASSERT_NULL(image.pixels);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_grid(ctx, NULL, NULL, &image));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_grid(NULL, &g, NULL, &image));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_grid(ctx, &g, NULL, NULL));
    bvx_grid_free(ctx, &g);
}

/* ---- the same bytes ---- */

static void make_lumps(void)
{
    double p[3], q[3];

    random_state = 11;
    no_mesh();
    for (int i = 0; i < 300; i++) {
        draw_point(p, 12);
        add_box(p[0], p[1], p[2]);
    }
    for (int i = 0; i < 2000; i++) { /* long and narrow */
        draw_point(p, 12);
        draw_point(q, 1);
        uint32_t const a = add_vertex(p[0], p[1], p[2]);
        add_vertex(p[0] + q[0] * 0.1, p[1] + q[1], p[2]);
        add_vertex(p[0], p[1] + q[0] * 0.1, p[2] + q[2]);
        add_triangle(a, a + 1, a + 2);
    }
}

static void test_threads_do_not_show(void)
{
    static const double even[3] = {1, 1, 1};
    bvx_grid g = grid_of(66, 40, 30, even);

    make_lumps();
    scatter(&g, 30);
    static const int32_t counts[4] = {1, 2, 3, 8};
    for (int kind = 0; kind < 8; kind++) {
        bvx_image one = {0}, many = {0};
        for (int turn = 0; turn < 4; turn++) {
            int32_t const threads = counts[turn];
            bvx_context *const c = suite_context(threads, BVX_CPU_BEST);
            bvx_render_options o = options_of(121, 99, 3, -4, 2);
            bvx_image *const image = threads == 1 ? &one : &many;
            bvx_mesh_view const v = view_of_mesh();
            o.smooth = kind >> 1 & 1;
            o.samples = 1 + (kind >> 2 & 1);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, kind & 1 ? bvx_render_grid(c, &g, &o, image)
                                                     : bvx_render_mesh(c, &v, &o, image));
            if (threads > 1) same_pictures(&one, &many);
            if (threads > 1) bvx_image_free(c, &many);
            bvx_context_destroy(c);
        }
        bvx_image_free(ctx, &one);
    }
    bvx_grid_free(ctx, &g);
}

/* The same mesh without indices, in other types and strides, among vertices
 * that nothing uses, and larger by 2^70. */
static void test_kinds_of_view_do_not_show(void)
{
    static float packed[MOST_TRIANGLES][3][5];
    static uint64_t wide[MOST_TRIANGLES][4];
    bvx_render_options const o = options_of(120, 90, 1, 2, 3);
    bvx_mesh_view v;
    bvx_image wanted, got = {0};
    make_lumps();
    for (uint64_t i = 0; i < vertices; i++)
        for (int a = 0; a < 3; a++) xyz[i][a] = (double)(float)xyz[i][a];
    wanted = picture_of(&o);
    for (uint64_t t = 0; t < triangles; t++)
        for (int k = 0; k < 3; k++) {
            wide[t][k] = tri[t][k];
            for (int a = 0; a < 3; a++) packed[t][k][a] = (float)xyz[tri[t][k]][a];
        }
    v = view_of_mesh();
    v.positions = packed;
    v.position_type = BVX_F32;
    v.position_stride = sizeof packed[0][0];
    v.vertex_count = triangles * 3;
    v.indices = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_mesh(ctx, &v, &o, &got));
    same_pictures(&wanted, &got);
    bvx_image_free(ctx, &got);

    add_vertex(1e30, -1e300, 0);
    v = view_of_mesh();
    v.indices = wide;
    v.index_type = BVX_U64;
    v.index_stride = sizeof wide[0];
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_mesh(ctx, &v, &o, &got));
    same_pictures(&wanted, &got);
    bvx_image_free(ctx, &got);

    vertices--;
    for (uint64_t i = 0; i < vertices; i++)
        for (int a = 0; a < 3; a++) xyz[i][a] *= 1180591620717411303424.0;
    got = picture_of(&o);
    same_pictures(&wanted, &got);
    bvx_image_free(ctx, &got);
    bvx_image_free(ctx, &wanted);
}

/* Coordinates near the ends of what doubles hold. */
static void test_sizes_beyond_reason_are_drawn(void)
{
    static const double scale[3] = {1e308, 1e-300, 1e-307};
    bvx_render_options const o = options_of(50, 50, 0, 0, 1);

    for (int s = 0; s < 3; s++) {
        bvx_image image;
        no_mesh();
        add_box(-0.5, -0.5, -0.5);
        for (uint64_t i = 0; i < vertices; i++)
            for (int a = 0; a < 3; a++) xyz[i][a] = xyz[i][a] > 0 ? scale[s] : -scale[s];
        image = picture_of(&o);
        TEST_ASSERT_FALSE(is_background(&image, 25, 25));
        TEST_ASSERT_TRUE(is_background(&image, 0, 0));
        bvx_image_free(ctx, &image);
    }
}

/* A plane seen along its edge covers nothing; one seen from straight above needs another "up". */
static void test_odd_directions_are_drawn(void)
{
    static const double corner[3] = {0, 0, 0}, x[3] = {1, 0, 0}, y[3] = {0, 1, 0};
    bvx_render_options o = options_of(40, 40, 1, 0, 0);
    bvx_image image;

    no_mesh();
    add_quad(corner, x, y);
    image = picture_of(&o);
    for (int32_t i = 0; i < 40 * 40; i++) TEST_ASSERT_TRUE(is_background(&image, i % 40, i / 40));
    bvx_image_free(ctx, &image);
    o = options_of(40, 40, 0, 0, -1e-200);
    image = picture_of(&o);
    TEST_ASSERT_FALSE(is_background(&image, 20, 20));
    bvx_image_free(ctx, &image);
    o = options_of(40, 40, 0, 1e300, 0);
    o.camera.up[1] = 5;
    o.camera.up[2] = 0;
    image = picture_of(&o);
    bvx_image_free(ctx, &image);
}

/* ---- refusals ---- */

static void refused(bvx_status expected, const bvx_render_options *o, const char *word)
{
    bvx_mesh_view const v = view_of_mesh();
    bvx_image image = {0};
    TEST_ASSERT_EQUAL_INT32(expected, bvx_render_mesh(ctx, &v, o, &image));
    TEST_ASSERT_NULL(image.pixels);
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), word));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static void test_render_mesh_refuses_bad_meshes(void)
{
    bvx_render_options const o = options_of(50, 50, 1, 1, 1);

    no_mesh();
    refused(BVX_ERR_EMPTY, &o, "triangle");
    add_vertex(1, 2, 3);
    add_triangle(0, 0, 0);
    refused(BVX_ERR_EMPTY, &o, "one point");
    no_mesh();
    add_box(0, 0, 0);
    xyz[7][1] = (double)NAN;
    refused(BVX_ERR_RANGE, &o, "vertex 7");
    xyz[7][1] = (double)INFINITY;
    refused(BVX_ERR_RANGE, &o, "vertex 7");
    xyz[7][1] = 0;
    tri[3][2] = (uint32_t)vertices;
    refused(BVX_ERR_RANGE, &o, "triangle 3");
}

static void test_render_mesh_refuses_bad_options(void)
{
    bvx_render_options const good = options_of(50, 50, 1, 1, 1);
    bvx_render_options o;
    bvx_mesh_view v;
    bvx_image image = {0};
    uint8_t byte = 0;

    no_mesh();
    add_box(0, 0, 0);
#define REFUSE(change, word)                 \
    do {                                     \
        o = good;                            \
        change;                              \
        refused(BVX_ERR_ARGUMENT, &o, word); \
    } while (0)
    REFUSE(o.width = -1, "width is -1");
    REFUSE(o.width = 16385, "16385");
    REFUSE(o.height = -1, "height is -1");
    REFUSE(o.samples = -1, "samples");
    REFUSE(o.samples = 5, "samples");
    REFUSE(o.smooth = 2, "smooth");
    REFUSE(o.camera.direction[2] = (double)NAN, "direction");
    REFUSE(o.camera.up[0] = (double)INFINITY, "up");
    REFUSE(o.struct_size = 3, "size");
    REFUSE(o.wireframe = 2, "wireframe is 2");
    REFUSE(o.wireframe = -1, "wireframe is -1");
    REFUSE(o.camera.show[0] = -1, "show is -1");
    REFUSE(o.camera.show[1] = (double)INFINITY, "show is 0, inf");
    REFUSE(o.camera.show[0] = (double)NAN, "show is");
    REFUSE(o.cut.sides = 64, "cut.sides is 64");
    REFUSE(o.cut.low[0] = (double)NAN, "along x");
    REFUSE(o.cut.high[1] = (double)NAN, "along y");
    REFUSE((o.cut.low[2] = 0.5, o.cut.high[2] = 0.25), "from 0.5 to 0.25 along z");
    REFUSE((o.cut.low[1] = 1, o.cut.high[1] = -(double)INFINITY), "along y");
#undef REFUSE
    v = view_of_mesh();
    image.pixels = &byte;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_mesh(ctx, &v, &good, &image));
    TEST_ASSERT_EQUAL_PTR(&byte, image.pixels);
    image.pixels = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_mesh(ctx, &v, &good, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_mesh(ctx, NULL, &good, &image));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_render_mesh(NULL, &v, &good, &image));
}

/* ---- failures on the way ---- */

static bvx_status render_both(void *user, bvx_context *c)
{
    bvx_render_options o = options_of(64, 40, 3, -4, 2);
    bvx_mesh_view const v = view_of_mesh();
    bvx_image image = {0};
    bvx_status s;

    o.smooth = 1;
    o.samples = 1;
    s = bvx_render_mesh(c, &v, &o, &image);
    bvx_image_free(c, &image);
    if (s != BVX_OK) return s;
    s = bvx_render_grid(c, user, &o, &image);
    bvx_image_free(c, &image);
    return s;
}

/* Pixels of a row that are not background. */
static int32_t width_of_row(const bvx_image *image, int32_t y)
{
    int32_t n = 0;
    for (int32_t x = 0; x < image->width; x++) n += !is_background(image, x, y);
    return n;
}

/* A box of 10 x 10 x 10, shown in a frame that is to show 20 either way of
 * its middle: a quarter of the frame's side. */
static void test_show_makes_room(void)
{
    static const double even[3] = {1, 1, 1};
    bvx_grid g = grid_of(10, 10, 10, even);
    bvx_image image = {0};

    for (int32_t z = 0; z < 10; z++)
        for (int32_t y = 0; y < 10; y++)
            for (int32_t x = 0; x < 10; x++) bvx_grid_set(&g, x, y, z, 1);
    for (int i = 0; i < 3; i++) {
        bvx_render_options o = options_of(400, 400, 0, -1, 0);
        o.camera.show[0] = i == 1 ? 20 : 0;
        o.camera.show[1] = i == 2 ? 20 : 0;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_render_grid(ctx, &g, &o, &image));
        TEST_ASSERT_INT32_WITHIN(2, (int32_t)(400 * 0.94 * (i == 0 ? 1.0 : 0.25)), width_of_row(&image, 200));
        bvx_image_free(ctx, &image);
    }
    bvx_grid_free(ctx, &g);
}

static void test_every_failure_on_the_way_is_clean(void)
{
    static const double even[3] = {1, 1, 1};
    bvx_grid g = grid_of(20, 20, 20, even);
    uint64_t places = 0;
    const char *wrong;

    random_state = 3;
    scatter(&g, 40);
    no_mesh();
    for (int i = 0; i < 20; i++) {
        double p[3];
        draw_point(p, 5);
        add_box(p[0], p[1], p[2]);
    }
    wrong = fault_every_allocation(render_both, &g, NULL, &places);
    TEST_ASSERT_NULL_MESSAGE(wrong, wrong);
    TEST_ASSERT_TRUE(places >= 10);
    wrong = fault_every_cancel(render_both, &g, NULL, &places);
    TEST_ASSERT_NULL_MESSAGE(wrong, wrong);
    TEST_ASSERT_TRUE(places >= 6);
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_render_mesh_shows_a_box_where_it_is);
    RUN_TEST(test_render_mesh_turns_by_whole_numbers);
    RUN_TEST(test_show_makes_room);
    RUN_TEST(test_render_mesh_covers_what_triangles_cover);
    RUN_TEST(test_render_mesh_leaves_no_gap_between_neighbours);
    RUN_TEST(test_render_mesh_shows_the_nearer_and_tints_insides);
    RUN_TEST(test_render_mesh_smooth_leaves_a_flat_sheet_alone);
    RUN_TEST(test_render_mesh_darkens_corners);
    RUN_TEST(test_render_grid_equals_the_mesh_of_its_faces);
    RUN_TEST(test_render_grid_smooth_shows_a_ball);
    RUN_TEST(test_render_grid_refuses_an_empty_set);
    RUN_TEST(test_threads_do_not_show);
    RUN_TEST(test_kinds_of_view_do_not_show);
    RUN_TEST(test_sizes_beyond_reason_are_drawn);
    RUN_TEST(test_odd_directions_are_drawn);
    RUN_TEST(test_render_mesh_refuses_bad_meshes);
    RUN_TEST(test_render_mesh_refuses_bad_options);
    RUN_TEST(test_every_failure_on_the_way_is_clean);
    return UNITY_END();
}
