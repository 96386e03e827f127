/* test_render_cut.c - pictures of meshes and grids that are cut open: against a look at every sample by
 * itself, against grids that were cut by hand, and where a cut changes nothing or leaves nothing. */
#include "render_support.h"

/* ---- triangles ---- */

/* A unit square seen along z, cut to 0.4: 94 x 37.6 pixels, from 31.2 to 68.8. */
static void test_mesh_cut_fits_what_is_left(void)
{
    for (int side = 0; side < 2; side++) {
        bvx_render_options o = options_of(100, 100, 0, 0, 1);
        bvx_image image;
        o.samples = 1;
        if (side) o.cut.high[0] = 5.4;
        else o.cut.low[0] = 5.6;
        no_mesh();
        add_box(5, -7, 2);
        image = picture_of(&o);
        for (int32_t y = 0; y < 100; y++)
            for (int32_t x = 0; x < 100; x++)
                TEST_ASSERT_EQUAL_INT(x < 31 || x >= 69 || y < 3 || y >= 97, is_background(&image, x, y));
        bvx_image_free(ctx, &image);
    }
}

static void cross_of(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot_of(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static int in_box(const double p[3], const double low[3], const double high[3], double slack)
{
    for (int a = 0; a < 3; a++)
        if (p[a] < low[a] - slack || p[a] > high[a] + slack) return 0;
    return 1;
}

static void stretch(double extent[2][2], const double p[3])
{
    for (int a = 0; a < 2; a++) {
        extent[0][a] = p[a] < extent[0][a] ? p[a] : extent[0][a];
        extent[1][a] = p[a] > extent[1][a] ? p[a] : extent[1][a];
    }
}

/* The corners of a triangle in a box are its own corners in the box, its edges on the box's faces and the
 * box's edges on the triangle: all of them are tried. */
static void stretch_by_cut_triangle(double extent[2][2], const double t[3][3], const double low[3],
                                    const double high[3])
{
    double u[3], v[3], n[3];

    for (int k = 0; k < 3; k++) {
        const double *const p = t[k], *const q = t[(k + 1) % 3];
        if (in_box(p, low, high, 0)) stretch(extent, p);
        for (int a = 0; a < 3; a++)
            for (int side = 0; side < 2; side++) {
                double const plane = side ? high[a] : low[a], share = (plane - p[a]) / (q[a] - p[a]);
                double at[3];
                if (!(share > 0 && share < 1)) continue;
                for (int b = 0; b < 3; b++) at[b] = p[b] + share * (q[b] - p[b]);
                if (in_box(at, low, high, 1e-12)) stretch(extent, at);
            }
    }
    for (int a = 0; a < 3; a++) {
        u[a] = t[1][a] - t[0][a];
        v[a] = t[2][a] - t[0][a];
    }
    cross_of(u, v, n);
    for (int a = 0; a < 3; a++)
        for (int c = 0; c < 4; c++) {
            int const b = (a + 1) % 3, d = (a + 2) % 3;
            double at[3], inside = 0;
            int signs = 0;
            at[b] = c & 1 ? high[b] : low[b];
            at[d] = c & 2 ? high[d] : low[d];
            at[a] = t[0][a] - (n[b] * (at[b] - t[0][b]) + n[d] * (at[d] - t[0][d])) / n[a];
            if (!(at[a] >= low[a] && at[a] <= high[a])) continue;
            for (int k = 0; k < 3; k++) {
                double side[3], to[3], m[3];
                for (int e = 0; e < 3; e++) {
                    side[e] = t[(k + 1) % 3][e] - t[k][e];
                    to[e] = at[e] - t[k][e];
                }
                cross_of(side, to, m);
                inside = dot_of(m, n);
                signs += inside >= 0;
            }
            if (signs == 3) stretch(extent, at);
        }
}

/* How a triangle meets the line of sight (along z) at (x, y): 1 covered at
 * *z, 0 not, -1 too close to an edge to say. */
static int meet_triangle(const double t[3][3], double x, double y, double margin, double *z)
{
    double share[3], whole = 0, least = 9e9, most = -9e9;

    for (int k = 0; k < 3; k++) {
        const double *const a = t[(k + 1) % 3], *const b = t[(k + 2) % 3];
        double const length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        share[k] = (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y);
        whole += share[k];
        least = share[k] / length < least ? share[k] / length : least;
        most = share[k] / length > most ? share[k] / length : most;
    }
    if (least < margin && most > -margin) return least > -margin || most < margin ? -1 : 0;
    *z = 0;
    for (int k = 0; k < 3; k++) *z += share[k] / whole * t[k][2];
    return 1;
}

/* Random triangles seen along z and cut by random boxes: every sample by itself. Grey or reddish says which
 * side of which triangle is seen. Samples within a hair of an edge or of a plane may fall either way. */
static void test_mesh_cut_shows_what_the_box_leaves(void)
{
    enum { SIDE = 80, TRIANGLES = 12 };
    int seen = 0, insides = 0, sure = 0, pictures = 0;
    for (int round = 0; round < 40; round++) {
        bvx_render_options o = options_of(SIDE, SIDE, 0, 0, 1);
        double extent[2][2] = {{9, 9}, {-9, -9}}, low[3], high[3], scale, margin;
        bvx_image image;
        random_state = (uint64_t)round + 100;
        no_mesh();
        for (uint32_t i = 0; i < TRIANGLES; i++) {
            double p[3];
            for (int k = 0; k < 3; k++) {
                draw_point(p, 1);
                add_vertex(p[0], p[1], p[2]);
            }
            add_triangle(3 * i, 3 * i + 1, 3 * i + 2);
        }
        for (int a = 0; a < 3; a++) {
            low[a] = draw_unit() * 0.4;
            high[a] = low[a] + 0.2 + draw_unit() * 0.4;
            if (round % 4 == 1 && a != round / 4 % 3) low[a] = -1; /* fewer planes, too */
            if (round % 4 == 2 && a == round / 4 % 3) high[a] = 2;
            o.cut.low[a] = low[a];
            o.cut.high[a] = high[a];
        }
        for (uint64_t i = 0; i < triangles; i++)
            stretch_by_cut_triangle(extent, (const double(*)[3])xyz[3 * i], low, high);
        if (!(extent[0][0] < extent[1][0])) { /* nothing is left */
            bvx_mesh_view const v = view_of_mesh();
            bvx_image none = {0};
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_mesh(ctx, &v, &o, &none));
            continue;
        }
        scale = extent[1][0] - extent[0][0];
        if (extent[1][1] - extent[0][1] > scale) scale = extent[1][1] - extent[0][1];
        scale = 0.94 * SIDE / scale;
        margin = 1e-3 / scale;
        o.samples = 1;
        image = picture_of(&o);
        pictures++;
        for (int32_t y = 0; y < SIDE; y++)
            for (int32_t x = 0; x < SIDE; x++) {
                double const px = (extent[0][0] + extent[1][0]) / 2 + (x + 0.5 - SIDE / 2.0) / scale;
                double const py = (extent[0][1] + extent[1][1]) / 2 - (y + 0.5 - SIDE / 2.0) / scale;
                double best = -9, second = -9;
                int open = 0, inside = 0;
                for (uint64_t i = 0; i < triangles; i++) {
                    const double(*const t)[3] = (const double(*)[3])xyz[3 * i];
                    double p[3] = {px, py, 0};
                    int const met = meet_triangle(t, px, py, margin, &p[2]);
                    if (met == 0) continue;
                    if (met < 0 || in_box(p, low, high, 1e-4) != in_box(p, low, high, -1e-4)) open = 1;
                    else if (in_box(p, low, high, 0)) {
                        double const area = (t[1][0] - t[0][0]) * (t[2][1] - t[0][1]) -
                                            (t[1][1] - t[0][1]) * (t[2][0] - t[0][0]);
                        if (p[2] > best) inside = area < 0;
                        second = p[2] > best ? best : p[2] > second ? p[2] : second;
                        best = p[2] > best ? p[2] : best;
                    }
                }
                if (open) continue;
                sure++;
                TEST_ASSERT_EQUAL_INT(best == -9, is_background(&image, x, y));
                if (best == -9 || best - second < 1e-4) continue;
                seen++;
                insides += inside;
                if (pixel(&image, x, y)[0] < 60) continue; /* too dark for a colour */
                TEST_ASSERT_EQUAL_INT(inside, pixel(&image, x, y)[0] * 4 > pixel(&image, x, y)[2] * 5);
            }
        bvx_image_free(ctx, &image);
    }
    /* something is said about most samples */
    TEST_ASSERT_TRUE(pictures > 30 && sure > pictures * SIDE * SIDE * 8 / 10);
    TEST_ASSERT_TRUE(seen > 20000 && insides > 5000);
}

/* Torn between neighbours it would show its yellow background. */
static void test_mesh_cut_leaves_no_gap_between_neighbours(void)
{
    enum { N = 40, SIDE = 300 };
    bvx_render_options o = options_of(SIDE, SIDE, 0, 0, 1);
    bvx_image image;
    random_state = 7;
    no_mesh();
    for (int y = 0; y <= N; y++)
        for (int x = 0; x <= N; x++) {
            double p[3];
            draw_point(p, 0.45);
            add_vertex(x + p[0], y + p[1], p[2]);
        }
    for (uint32_t y = 0; y < N; y++)
        for (uint32_t x = 0; x < N; x++) {
            uint32_t const a = y * (N + 1) + x;
            add_triangle(a, a + 1, a + N + 2);
            add_triangle(a, a + N + 2, a + N + 1);
        }
    o.background[0] = o.background[1] = 255;
    o.cut.low[0] = 7.3;
    o.cut.high[0] = 17.3;
    o.cut.low[1] = 20.1;
    o.cut.high[1] = 30.1;
    image = picture_of(&o);
    for (int32_t y = 0; y < SIDE; y++)
        for (int32_t x = 0; x < SIDE; x++) {
            int const in = x >= 9 && x < SIDE - 9 && y >= 9 && y < SIDE - 9;
            if (in) TEST_ASSERT_INT_WITHIN(20, pixel(&image, x, y)[0], pixel(&image, x, y)[2]);
            else
                TEST_ASSERT_EQUAL_INT(
                    0, pixel(&image, x, y)[2]); /* the planes stand at 9 and 291 to the pixel */
        }
    bvx_image_free(ctx, &image);
}

/* A box around everything, also one that just touches, is no cut. */
static void test_mesh_cut_around_everything_does_not_show(void)
{
    bvx_render_options o = options_of(90, 70, 3, -4, 2);
    bvx_image whole, cut;
    double p[3];

    random_state = 12;
    no_mesh();
    for (int i = 0; i < 30; i++) {
        draw_point(p, 4);
        add_box(p[0], p[1], p[2]);
    }
    add_box(-1, -1, -1);
    add_box(6, 6, 6);
    whole = picture_of(&o);
    for (int a = 0; a < 3; a++) {
        o.cut.low[a] = -1;
        o.cut.high[a] = 7;
    }
    cut = picture_of(&o);
    same_pictures(&whole, &cut);
    bvx_image_free(ctx, &cut);
    o.cut.high[1] = 6.999;
    cut = picture_of(&o);
    TEST_ASSERT_TRUE(memcmp(whole.pixels, cut.pixels, bytes_of(&whole)) != 0);
    bvx_image_free(ctx, &cut);
    bvx_image_free(ctx, &whole);
}

/* The wall of a box in the plane stays; a tip or an edge that touches it from outside is nothing. */
static void test_mesh_cut_at_the_surface_itself(void)
{
    bvx_render_options o = options_of(50, 50, 1, 0, 0);
    bvx_mesh_view v;
    bvx_image image = {0};
    no_mesh();
    add_box(0, 0, 0);
    o.cut.low[0] = 1;
    image = picture_of(&o);
    TEST_ASSERT_FALSE(is_background(&image, 25, 25));
    bvx_image_free(ctx, &image);
    o.cut.high[0] = 1; /* a box without thickness */
    image = picture_of(&o);
    TEST_ASSERT_FALSE(is_background(&image, 25, 25));
    bvx_image_free(ctx, &image);
    o.cut.low[0] = o.cut.high[0] = 0.5; /* crosses walls, holds none */
    v = view_of_mesh();
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_mesh(ctx, &v, &o, &image));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "the cut leaves nothing"));
    o.cut.low[0] = 1.5;
    o.cut.high[0] = 9;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_mesh(ctx, &v, &o, &image));
    TEST_ASSERT_NULL(image.pixels);

    no_mesh();
    add_vertex(0, 0, 0);
    add_vertex(0, 1, 0);
    add_vertex(1, 0.5, 0.5);
    add_triangle(0, 1, 2);
    v = view_of_mesh();
    o.cut.low[0] = 1; /* the tip */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_mesh(ctx, &v, &o, &image));
    o.cut.low[0] = -1;
    o.cut.high[0] = 0; /* the edge */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_mesh(ctx, &v, &o, &image));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

/* Smooth, with colours and lines, cut and seen from aside: the same for any threads, and in a huge world. */
static void test_mesh_cut_in_all_ways_is_the_same_for_all_threads(void)
{
    static const int32_t counts[3] = {1, 2, 8};
    bvx_image first = {0}, image = {0};
    double p[3];

    random_state = 21;
    no_mesh();
    for (int i = 0; i < 400; i++) {
        draw_point(p, 6);
        add_box(p[0], p[1], p[2]);
    }
    for (uint64_t i = 0; i < vertices; i++)
        for (int a = 0; a < 4; a++) paint[i][a] = (uint8_t)draw_number(256);
    painted = 1;
    for (int large = 0; large < 2; large++) {
        double const scale = large ? 1267650600228229401496703205376.0 : 1.0; /* 2^100 */
        for (uint64_t i = 0; i < vertices && large; i++)
            for (int a = 0; a < 3; a++) xyz[i][a] *= scale;
        for (int turn = 0; turn < 3; turn++) {
            bvx_context *const c = suite_context(counts[turn], BVX_CPU_BEST);
            bvx_render_options o = options_of(123, 97, 3, -4, 2);
            bvx_mesh_view const v = view_of_mesh();
            o.smooth = o.wireframe = 1;
            for (int a = 0; a < 3; a++) {
                o.cut.low[a] = (1.1 + a * 0.1) * scale;
                o.cut.high[a] = (4.9 - a * 0.3) * scale;
            }
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvx_render_mesh(c, &v, &o, first.pixels == NULL ? &first : &image));
            if (image.pixels != NULL) same_pictures(&first, &image);
            bvx_image_free(c, &image);
            bvx_context_destroy(c);
        }
    }
    bvx_image_free(ctx, &first);
}

/* A box at the end of a plate a million times as long: cut free it looks as if it stood alone. */
static void test_mesh_cut_of_a_small_part_is_sharp(void)
{
    static const double from[3] = {-1e6, -1e6, -1e6}, x[3] = {1e6, 1e6, 0}, y[3] = {0, 1e6, 1e6};
    bvx_render_options o = options_of(150, 120, 3, -4, 2);
    bvx_image alone, cut;

    no_mesh();
    add_box(0.5, 0.25, 0.125);
    add_box(1.25, 0.5, 0.5);
    alone = picture_of(&o);
    add_quad(from, x, y);
    for (int a = 0; a < 3; a++) o.cut.low[a] = a == 0 ? 0.4 : 0.0;
    for (int a = 0; a < 3; a++) o.cut.high[a] = 9;
    cut = picture_of(&o);
    for (size_t i = 0; i < bytes_of(&cut); i++) TEST_ASSERT_UINT8_WITHIN(3, alone.pixels[i], cut.pixels[i]);
    bvx_image_free(ctx, &cut);
    bvx_image_free(ctx, &alone);
}

/* ---- grids ---- */

static const double even[3] = {1, 1, 1}, uneven[3] = {0.5, 1.5, 0.25};

/* A copy of a grid without the voxels whose centres lie outside a box. */
static bvx_grid cleared_copy(const bvx_grid *g, const double low[3], const double high[3])
{
    bvx_grid c = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &g->lattice, NULL, &c));
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++) {
                double const at[3] = {g->lattice.origin[0] + (x + 0.5) * g->lattice.spacing[0],
                                      g->lattice.origin[1] + (y + 0.5) * g->lattice.spacing[1],
                                      g->lattice.origin[2] + (z + 0.5) * g->lattice.spacing[2]};
                if (in_box(at, low, high, 0)) bvx_grid_set(&c, x, y, z, bvx_grid_get(g, x, y, z));
            }
    return c;
}

/* Voxels large enough to be seen singly, seen from above the low corner or below: the picture is that of the
 * grid cut by hand, but for faces that the cut laid bare, which are darker by one factor. */
static void test_grid_cut_is_a_grid_without_those_voxels(void)
{
    static const int32_t size[3][3] = {{9, 8, 7}, {70, 3, 2}, {131, 2, 3}};
    int bare = 0, same = 0, astray = 0;

    random_state = 15;
    for (int round = 0; round < 60; round++) {
        const int32_t *const n = size[round % 3];
        const double *const spacing = round % 2 ? uneven : even;
        bvx_grid g = grid_of(n[0], n[1], n[2], spacing), cleared;
        bvx_render_options o = options_of(round % 3 ? 1300 : 152, round % 3 ? 700 : 132, round % 3 ? 0.3 : 3,
                                          round & 8 ? 2 : -2, round & 16 ? 1.1 : -1.1);
        double low[3], high[3];
        bvx_image cut, want;
        o.samples = 1;
        if (round & 4) o.camera.direction[0] = -o.camera.direction[0];
        scatter(&g, 60);
        bvx_grid_set(&g, n[0] / 2, n[1] / 2, n[2] / 2, 1);
        for (int a = 0; a < 3; a++) { /* around the middle; centres lie on the bounds every fourth time */
            double const middle = g.lattice.origin[a] + (n[a] / 2 + 0.5) * spacing[a];
            int32_t const below = (int32_t)draw_number((uint32_t)n[a]);
            int32_t const above = (int32_t)draw_number((uint32_t)n[a]);
            low[a] = round % 4 == 0 ? middle - below * spacing[a] : middle - draw_unit() * n[a] * spacing[a];
            high[a] = round % 4 == 0 ? middle + above * spacing[a] : middle + draw_unit() * n[a] * spacing[a];
        }
        cleared = cleared_copy(&g, low, high);
        want = picture_of_grid(&cleared, &o);
        for (int a = 0; a < 3; a++) {
            o.cut.low[a] = low[a];
            o.cut.high[a] = high[a];
        }
        cut = picture_of_grid(&g, &o);
        for (int32_t y = 0; y < o.height; y++)
            for (int32_t x = 0; x < o.width; x++) {
                const uint8_t *const p = pixel(&cut, x, y), *const q = pixel(&want, x, y);
                int as_is = 1, darker = 1;
                if (is_background(&cut, x, y) && is_background(&want, x, y)) continue;
                for (int a = 0; a < 3; a++) {
                    as_is &= p[a] <= q[a] + 3 && p[a] + 3 >= q[a];
                    darker &= p[a] <= q[a] * 0.84 + 3 && p[a] + 3 >= q[a] * 0.84;
                }
                same += as_is;
                bare += !as_is && darker;
                astray += !as_is && !darker;
            }
        bvx_image_free(ctx, &cut);
        bvx_image_free(ctx, &want);
        bvx_grid_free(ctx, &cleared);
        bvx_grid_free(ctx, &g);
    }
    TEST_ASSERT_TRUE(bare > 10000 && same > 10000);
    TEST_ASSERT_TRUE(astray * 1000 < bare + same);
}

/* A block of voxels, its lower half wider: seen from above and cut between the two, all of it is the section;
 * cut above the block nothing is. Voxels that end at the plane by themselves are no section either. */
static void test_grid_cut_darkens_the_section_alone(void)
{
    for (int32_t n = 8; n <= 80; n += 72) { /* voxels seen singly, and as a smooth surface */
        bvx_grid g = grid_of(n, n, n, even);
        bvx_render_options o = options_of(94, 94, 0, 0, 1);
        bvx_image image;
        int32_t section, wall;
        o.samples = 1;
        for (int32_t z = 0; z < n; z++)
            for (int32_t y = 0; y < n; y++)
                for (int32_t x = 0; x < n / 2 || (z < n / 2 && x < n); x++) bvx_grid_set(&g, x, y, z, 1);
        o.cut.high[2] = g.lattice.origin[2] + n / 2;
        image = picture_of_grid(&g, &o);
        section = pixel(&image, 15, 47)[0];
        wall = pixel(&image, 75, 47)[0];
        TEST_ASSERT_INT_WITHIN(2, (int)(wall * 0.84 + 0.5), section);
        bvx_image_free(ctx, &image);
        o.cut.high[2] = 1000;
        o.cut.low[2] = g.lattice.origin[2] + n / 2; /* what is cut away below shows nothing from above */
        image = picture_of_grid(&g, &o);
        TEST_ASSERT_INT_WITHIN(2, wall, pixel(&image, 47, 47)[0]);
        bvx_image_free(ctx, &image);
        bvx_grid_free(ctx, &g);
    }
}

/* The section through a ball is flat up to its rim, smooth as the ball may be. */
static void test_grid_cut_is_flat_up_to_the_rim(void)
{
    enum { N = 60 };
    bvx_grid g = grid_of(N, N, N, even);
    bvx_render_options o = options_of(200, 200, 0, 0, 1);
    bvx_image image;
    for (int32_t z = 0; z < N; z++)
        for (int32_t y = 0; y < N; y++)
            for (int32_t x = 0; x < N; x++) {
                int32_t const a = 2 * x + 1 - N, b = 2 * y + 1 - N, c = 2 * z + 1 - N;
                if (a * a + b * b + c * c < N * N) bvx_grid_set(&g, x, y, z, 1);
            }
    o.smooth = o.samples = 1;
    /* radius 30 at the middle, sqrt(30^2 - 10^2) = 28.3 here */
    o.cut.high[2] = g.lattice.origin[2] + N / 2 + 10;
    image = picture_of_grid(&g, &o);
    for (int32_t y = 0; y < 200; y++)
        for (int32_t x = 0; x < 200; x++) {
            double const r = sqrt((x - 99.5) * (x - 99.5) + (y - 99.5) * (y - 99.5)) / (188.0 / N);
            if (r < 27) TEST_ASSERT_EQUAL_UINT8(pixel(&image, 100, 100)[0], pixel(&image, x, y)[0]);
        }
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &g);
}

/* A row of voxels far along a large lattice: 4 x 1 of them fill the width, on the pixel. */
static void test_grid_cut_far_along_an_axis(void)
{
    int32_t const n = 3000000;
    bvx_grid g = grid_of(n, 1, 1, even);
    bvx_render_options o = options_of(100, 50, 0, 0, 1);
    bvx_image image;

    o.samples = 1;
    o.wireframe = 0;
    for (int32_t x = 0; x < n; x++) bvx_grid_set(&g, x, 0, 0, x != n - 4);
    /* 4 1/2 voxels before the last centre: n - 5 is the first */
    o.cut.low[0] = g.lattice.origin[0] + n - 5;
    o.cut.high[0] = g.lattice.origin[0] + n - 1;
    image = picture_of_grid(&g, &o);
    for (int32_t y = 0; y < 50; y++)
        for (int32_t x = 0; x < 100; x++) {
            double const along = (x + 0.5 - 3) / 23.5; /* voxels from n - 5 on, 23.5 pixels each */
            int const out = along < 0 || along > 4 || (along > 1 && along < 2) || y < 13 || y >= 37;
            double const edge = along - floor(along);
            if (edge > 0.03 && edge < 0.97 && y != 13 && y != 36)
                TEST_ASSERT_EQUAL_INT(out, is_background(&image, x, y));
        }
    bvx_image_free(ctx, &image);
    bvx_grid_free(ctx, &g);
}

static void test_grid_cut_leaves_nothing(void)
{
    bvx_grid g = grid_of(66, 3, 3, even);
    bvx_render_options o = options_of(50, 50, 1, 1, 1);
    bvx_image image = {0};

    bvx_grid_set(&g, 5, 1, 1, 1);
    o.cut.low[0] = g.lattice.origin[0] + 5.51; /* just beyond the centre */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_grid(ctx, &g, &o, &image));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "cut"));
    o.cut.low[0] = 1e6;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_render_grid(ctx, &g, &o, &image));
    o.cut.low[0] = o.cut.high[0] = g.lattice.origin[0] + 5.5;
    image = picture_of_grid(&g, &o);
    TEST_ASSERT_FALSE(is_background(&image, 25, 25));
    bvx_image_free(ctx, &image);
    TEST_ASSERT_NULL(image.pixels);
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_mesh_cut_fits_what_is_left);
    RUN_TEST(test_mesh_cut_shows_what_the_box_leaves);
    RUN_TEST(test_mesh_cut_leaves_no_gap_between_neighbours);
    RUN_TEST(test_mesh_cut_around_everything_does_not_show);
    RUN_TEST(test_mesh_cut_at_the_surface_itself);
    RUN_TEST(test_mesh_cut_in_all_ways_is_the_same_for_all_threads);
    RUN_TEST(test_mesh_cut_of_a_small_part_is_sharp);
    RUN_TEST(test_grid_cut_is_a_grid_without_those_voxels);
    RUN_TEST(test_grid_cut_darkens_the_section_alone);
    RUN_TEST(test_grid_cut_is_flat_up_to_the_rim);
    RUN_TEST(test_grid_cut_far_along_an_axis);
    RUN_TEST(test_grid_cut_leaves_nothing);
    return UNITY_END();
}
