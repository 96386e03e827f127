/* render_support.h - what the tests of pictures share: contexts, small meshes and grids, and looking at
 * pixels. Each test program has its own copy of the state. */
#ifndef RENDER_SUPPORT_H
#define RENDER_SUPPORT_H

#include "bitvox_io.h"

#include "suite.h"

#include <math.h>

void setUp(void)
{
    suite_open(1);
}
void tearDown(void)
{
    suite_close();
}

static uint64_t random_state;

static inline uint32_t draw_number(uint32_t below)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)((random_state >> 33) % below);
}

static inline double draw_unit(void)
{
    return draw_number(1u << 20) / (double)(1u << 20);
}

/* Drawn one after the other: C leaves the order of arguments open. */
static inline void draw_point(double p[3], double size)
{
    for (int a = 0; a < 3; a++) p[a] = draw_unit() * size;
}

/* ---- meshes ---- */

enum { MOST_VERTICES = 60000, MOST_TRIANGLES = 60000 };

static double xyz[MOST_VERTICES][3];
static uint32_t tri[MOST_TRIANGLES][3];
static uint8_t paint[MOST_VERTICES][4];
static int painted; /* view_of_mesh shows paint */
static uint64_t vertices, triangles;

static inline uint32_t add_vertex(double x, double y, double z)
{
    TEST_ASSERT_TRUE(vertices < MOST_VERTICES);
    xyz[vertices][0] = x;
    xyz[vertices][1] = y;
    xyz[vertices][2] = z;
    return (uint32_t)vertices++;
}

static inline void add_triangle(uint32_t a, uint32_t b, uint32_t c)
{
    TEST_ASSERT_TRUE(triangles < MOST_TRIANGLES);
    tri[triangles][0] = a;
    tri[triangles][1] = b;
    tri[triangles][2] = c;
    triangles++;
}

static inline void add_quad(const double a[3], const double u[3], const double v[3])
{
    uint32_t const n = (uint32_t)vertices;
    add_vertex(a[0], a[1], a[2]);
    add_vertex(a[0] + u[0], a[1] + u[1], a[2] + u[2]);
    add_vertex(a[0] + u[0] + v[0], a[1] + u[1] + v[1], a[2] + u[2] + v[2]);
    add_vertex(a[0] + v[0], a[1] + v[1], a[2] + v[2]);
    add_triangle(n, n + 1, n + 2);
    add_triangle(n, n + 2, n + 3);
}

/* The face of the unit box at (x,y,z) that is square to an axis, on its high or low side, seen from
 * outside. */
static inline void add_face(double x, double y, double z, int axis, int high)
{
    double const low[3] = {x, y, z};
    double a[3], u[3] = {0, 0, 0}, v[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++) a[k] = low[k];
    a[axis] += high;
    u[(axis + (high ? 1 : 2)) % 3] = 1;
    v[(axis + (high ? 2 : 1)) % 3] = 1;
    add_quad(a, u, v);
}

static inline void add_box(double x, double y, double z)
{
    for (int axis = 0; axis < 3; axis++)
        for (int high = 0; high < 2; high++) add_face(x, y, z, axis, high);
}

static inline void no_mesh(void)
{
    vertices = triangles = 0;
    painted = 0;
}

static inline bvx_mesh_view view_of_mesh(void)
{
    bvx_mesh_view v;

    memset(&v, 0, sizeof v);
    v.positions = xyz;
    v.indices = tri;
    v.vertex_count = vertices;
    v.triangle_count = triangles;
    v.position_type = BVX_F64;
    v.index_type = BVX_U32;
    if (painted) v.colours = paint[0];
    return v;
}

/* ---- pictures ---- */

static inline bvx_render_options options_of(int32_t width, int32_t height, double x, double y, double z)
{
    bvx_render_options o = {.struct_size = sizeof o};

    o.width = width;
    o.height = height;
    o.camera.direction[0] = x;
    o.camera.direction[1] = y;
    o.camera.direction[2] = z;
    /* Cuts are open until a test moves one. */
    o.cut.sides = 63;
    for (int a = 0; a < 3; a++) {
        o.cut.low[a] = -(double)INFINITY;
        o.cut.high[a] = (double)INFINITY;
    }
    return o;
}

static inline bvx_image picture_of(const bvx_render_options *o)
{
    bvx_mesh_view const v = view_of_mesh();
    bvx_image image = {0};
    bvx_status const s = bvx_render_mesh(ctx, &v, o, &image);

    TEST_ASSERT_EQUAL_STRING("", s == BVX_OK ? "" : bvx_last_message(ctx));
    TEST_ASSERT_NOT_NULL(image.pixels);
    TEST_ASSERT_EQUAL_INT32(o->width, image.width);
    TEST_ASSERT_EQUAL_INT32(o->height, image.height);
    return image;
}

static inline const uint8_t *pixel(const bvx_image *image, int32_t x, int32_t y)
{
    return image->pixels + ((size_t)y * (size_t)image->width + (size_t)x) * 3;
}

static inline int is_background(const bvx_image *image, int32_t x, int32_t y)
{
    const uint8_t *const p = pixel(image, x, y);
    return p[0] == 255 && p[1] == 255 && p[2] == 255;
}

static inline size_t bytes_of(const bvx_image *image)
{
    return (size_t)image->width * (size_t)image->height * 3;
}

static inline void same_pictures(const bvx_image *a, const bvx_image *b)
{
    TEST_ASSERT_EQUAL_INT32(a->width, b->width);
    TEST_ASSERT_EQUAL_INT32(a->height, b->height);
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->pixels, b->pixels, bytes_of(a)));
}

/* ---- grids ---- */

static inline bvx_grid grid_of(int32_t nx, int32_t ny, int32_t nz, const double spacing[3])
{
    static const double origin[3] = {-3.5, 100, 7};
    int32_t const dims[3] = {nx, ny, nz};
    bvx_lattice lattice;
    bvx_grid g = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &g));
    return g;
}

static inline void scatter(bvx_grid *g, uint32_t share)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                if (draw_number(100) < share) bvx_grid_set(g, x, y, z, 1);
}

static inline bvx_image picture_of_grid(const bvx_grid *g, const bvx_render_options *o)
{
    bvx_image image = {0};
    bvx_status const s = bvx_render_grid(ctx, g, o, &image);
    TEST_ASSERT_EQUAL_STRING("", s == BVX_OK ? "" : bvx_last_message(ctx));
    return image;
}

/* The mesh of all exposed faces of a grid, in the world. */
static inline void mesh_of_faces(const bvx_grid *g)
{
    no_mesh();
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++) {
                int32_t const at[3] = {x, y, z};
                if (!bvx_grid_get(g, x, y, z)) continue;
                for (int axis = 0; axis < 3; axis++)
                    for (int high = 0; high < 2; high++) {
                        int32_t n[3] = {x, y, z};
                        n[axis] += high ? 1 : -1;
                        int const outside = n[axis] < 0 || n[axis] >= g->size[axis];
                        if (outside || !bvx_grid_get(g, n[0], n[1], n[2]))
                            add_face(at[0], at[1], at[2], axis, high);
                    }
            }
    for (uint64_t v = 0; v < vertices; v++)
        for (int a = 0; a < 3; a++) xyz[v][a] = g->lattice.origin[a] + xyz[v][a] * g->lattice.spacing[a];
}

#endif
