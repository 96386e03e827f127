/* test_label_voxels.c - labels of voxels by materials and colours of a mesh, their files, and faces of one label. */
#include "mesh/mesh.h"
#include "suite.h"

#include <stdlib.h>

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

enum { SIDE = 12, VOXELS = 2 * SIDE * SIDE * SIDE };

/* Two cubes side by side, half a voxel apart, of materials 0 and 1; all voxels of the lattice are in one. */
static double corner[16][3];
static uint32_t triangle[24][3], material[24];
static uint8_t labels[VOXELS], palette[1024], colours[64];
static bvx_grid solid;
static bvx_mesh cubes;

static void make_cubes(void)
{
    static const uint32_t box[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {2 * SIDE, SIDE, SIDE};
    bvx_lattice lattice;
    bvx_mesh_view view;

    for (int v = 0; v < 16; v++)
        for (int a = 0; a < 3; a++)
            corner[v][a] = SIDE * ((v >> a & 1) + (a == 0 ? v / 8 : 0)) + (a != 0 || v % 8 % 2 == v / 8 ? 0
                                                                           : v < 8 ? -0.25
                                                                                   : 0.25);
    for (uint32_t t = 0; t < 24; t++) {
        material[t] = t / 12;
        for (int k = 0; k < 3; k++) triangle[t][k] = box[t % 12][k] + t / 12 * 8;
    }
    cubes = (bvx_mesh){.positions = corner,
                       .triangles = triangle[0],
                       .materials = material,
                       .vertex_count = 16,
                       .vertex_capacity = 16,
                       .triangle_count = 24,
                       .triangle_capacity = 24,
                       .position_type = BVX_F64};
    bvx_mesh_view_of(&cubes, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    solid = (bvx_grid){0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, NULL, &solid));
}

static void test_label_voxels_by_the_nearest_material(void)
{
    static const uint8_t base[8] = {255, 0, 0, 255, 0, 128, 255, 100};
    bvx_assets assets = {.material_count = 2, .base_colours = base};

    make_cubes();
    bvx_grid_set(&solid, 3, 4, 5, 0);
    cubes.assets = &assets;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_label_voxels(ctx, &cubes, &solid, labels, palette),
                                    bvx_last_message(ctx));
    for (int i = 0; i < VOXELS; i++) {
        int const x = i % (2 * SIDE), y = i / (2 * SIDE) % SIDE, z = i / (2 * SIDE) / SIDE;
        TEST_ASSERT_EQUAL_UINT8(x == 3 && y == 4 && z == 5 ? 0 : x < SIDE ? 1 : 2, labels[i]);
    }
    TEST_ASSERT_EQUAL_MEMORY("\0\0\0\0", palette, 4);
    TEST_ASSERT_EQUAL_MEMORY(base, palette + 4, 8);

    /* What textures show is lost, and said. */
    TEST_ASSERT_NULL(bvx_next_warning(ctx));
    assets.textured = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));
    const bvx_warning *const lost = bvx_next_warning(ctx);
    TEST_ASSERT_NOT_NULL(lost);
    TEST_ASSERT_EQUAL_INT32(BVX_WARN_LOST, lost->code);
    TEST_ASSERT_EQUAL_INT32(0, strncmp(lost->text, "textures of 1 material are not looked up", 40));

    /* A material that is not among them is one more, white. */
    for (int t = 12; t < 24; t++) material[t] = 7;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));
    TEST_ASSERT_EQUAL_UINT8(3, labels[VOXELS - 1]);
    TEST_ASSERT_EQUAL_MEMORY("\xff\xff\xff\xff", palette + 12, 4);
    cubes.materials = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));
    bvx_grid_free(ctx, &solid);
}

static void test_labels_are_of_the_closest_triangle(void)
{
    static double centre[VOXELS][3];
    static bvx_closest_point found[VOXELS];
    bvx_assets assets = {.material_count = 24};
    bvx_closest *closest = NULL;
    bvx_mesh_view view;

    make_cubes();
    cubes.assets = &assets;
    for (uint32_t t = 0; t < 24; t++) material[t] = t;
    for (int i = 0; i < VOXELS; i++) {
        centre[i][0] = i % (2 * SIDE) + 0.5;
        centre[i][1] = i / (2 * SIDE) % SIDE + 0.5;
        centre[i][2] = i / (2 * SIDE) / SIDE + 0.5;
    }
    bvx_mesh_view_of(&cubes, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &view, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, centre[0], VOXELS, found));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));

    /* On diagonals of the cubes faces are equally far: the lower number decides. */
    for (int i = 0; i < VOXELS; i++) TEST_ASSERT_EQUAL_UINT8(1 + found[i].triangle, labels[i]);
    bvx_closest_free(ctx, closest);
    memset(triangle, 0, sizeof triangle);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));
    bvx_grid_free(ctx, &solid);
}

static void test_label_voxels_by_colours_of_vertices(void)
{
    int seen[256] = {0}, used = 0;

    make_cubes();
    cubes.materials = NULL;
    cubes.colours = colours;
    for (int v = 0; v < 16; v++) memcpy(colours + 4 * v, v < 8 ? "\x11\x22\x33\xff" : "\x01\xf0\x03\xff", 4);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));
    /* In rising order, as red comes first. */
    for (int i = 0; i < VOXELS; i++) TEST_ASSERT_EQUAL_UINT8(i % (2 * SIDE) < SIDE ? 2 : 1, labels[i]);
    TEST_ASSERT_EQUAL_MEMORY("\x01\xf0\x03\xff\x11\x22\x33\xff", palette + 4, 8);

    /* A ramp of many colours: each voxel's is near to that of the closest point. */
    for (int v = 0; v < 16; v++)
        for (int a = 0; a < 3; a++)
            colours[4 * v + a] = (uint8_t)(corner[v][a] * 250.0 / (a == 0 ? 2 * SIDE : SIDE));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_label_voxels(ctx, &cubes, &solid, labels, palette));
    for (int i = 0; i < VOXELS; i++) seen[labels[i]]++;
    TEST_ASSERT_EQUAL_INT(0, seen[0]);
    for (int i = 1; i < 256; i++) used += seen[i] > 0;
    TEST_ASSERT_TRUE(used > 60);
    for (int y = 0; y < SIDE; y++) {
        /* On the face x = 0 the ramp is that of y and z; cells have at most a quarter of the range. */
        const uint8_t *const p = palette + 4 * labels[(3 * SIDE + y) * 2 * SIDE];
        TEST_ASSERT_INT_WITHIN(64, (int)((y + 0.5) * 250.0 / SIDE), p[1]);
    }
    bvx_grid_free(ctx, &solid);
}

static void test_labels_come_back_from_files(void)
{
    /* Models side by side, two of them in part. */
    static const int32_t dims[3] = {300, 5, 260};
    static const double origin[3] = {1, 2, 3}, spacing[3] = {0.5, 1, 2};
    size_t const voxels = 300 * 5 * 260;
    uint8_t *const many = calloc(voxels, 1), other[1024];
    bvx_lattice lattice;
    bvx_grid g = {0};
    bvx_buffer file = {0}, back = {0};
    bvx_volume volume = {0};

    TEST_ASSERT_NOT_NULL(many);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &g));
    for (int i = 0; i < 1024; i++) palette[i] = (uint8_t)(i < 4 ? 0 : i * 37);
    for (size_t i = 0; i < voxels; i++) {
        many[i] = i % 3 != 0 || i < 2 || i > voxels - 3 ? (uint8_t)(1 + i * 7 % 255) : 0;
        bvx_grid_set(&g, (int32_t)(i % 300), (int32_t)(i / 300 % 5), (int32_t)(i / 1500), many[i] != 0);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_labels(ctx, &g, many, palette, BVX_FORMAT_VOX, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_read_labels(ctx, file.bytes, file.size, BVX_FORMAT_VOX, &back, other));
    TEST_ASSERT_EQUAL_UINT64(voxels, back.size);
    TEST_ASSERT_EQUAL_MEMORY(many, back.bytes, voxels);
    TEST_ASSERT_EQUAL_MEMORY(palette, other, 1024);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_labels(ctx, &g, many, palette, BVX_FORMAT_NRRD, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_read_volume(ctx, file.bytes, file.size, BVX_FORMAT_NRRD, NULL, &volume));
    TEST_ASSERT_EQUAL_MEMORY(many, volume.view.samples, voxels);
    TEST_ASSERT_TRUE(memcmp(&lattice, &volume.view.lattice, sizeof lattice) == 0);
    bvx_volume_free(ctx, &volume);

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED,
                            bvx_write_labels(ctx, &g, many, palette, BVX_FORMAT_NPY, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED,
                            bvx_read_labels(ctx, "abc", 3, BVX_FORMAT_NPY, &back, other));
    many[0] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_write_labels(ctx, &g, many, palette, BVX_FORMAT_VOX, &file));

    /* All white where nothing is said, and the palette of files without one. */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_read_labels(ctx, file.bytes, file.size, BVX_FORMAT_VOX, &back, other));
    TEST_ASSERT_EQUAL_UINT8(1, back.bytes[0]);
    TEST_ASSERT_EQUAL_MEMORY("\0\0\0\0\xff\xff\xff\xff\xff\xff\xcc\xff\xff\xff\x99\xff", other, 16);
    TEST_ASSERT_EQUAL_MEMORY("\0\0\x33\xff\xee\0\0\xff\xdd\0\0\xff", other + 4 * 215, 12);
    TEST_ASSERT_EQUAL_MEMORY("\x22\x22\x22\xff\x11\x11\x11\xff", other + 4 * 254, 8);
    bvx_buffer_free(ctx, &file);
    bvx_buffer_free(ctx, &back);
    bvx_grid_free(ctx, &g);
    free(many);
}

/* Faces of the voxels of one label and those of the others are all faces. */
static void test_faces_of_some_voxels_are_a_part_of_all(void)
{
    bvx_grid of[2] = {{0}};

    make_cubes();
    for (int i = 0; i < 2; i++)
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &solid.lattice, NULL, &of[i]));
    for (int32_t z = 0; z < SIDE; z++)
        for (int32_t y = 0; y < SIDE; y++)
            for (int32_t x = 0; x < 2 * SIDE; x++) bvx_grid_set(&of[x < SIDE], x, y, z, 1);
    bvx_grid_set(&solid, 2 * SIDE - 1, 0, 0, 0); /* in of, not in the grid */
    for (int merged = 0; merged < 2; merged++) {
        bvx_faces_options o = {.struct_size = sizeof o, .merged = merged};
        bvx_mesh all = {0}, part[2] = {{0}};
        bvx_certificate r;
        double area = 0;

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_faces(ctx, &solid, &o, &all));
        for (int i = 0; i < 2; i++) {
            o.of = &of[i];
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_faces(ctx, &solid, &o, &part[i]));
            bvx_mesh_view view;
            bvx_mesh_view_of(&part[i], &view);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &r));
            area += r.area;
        }
        /* None lies between the cubes. */
        TEST_ASSERT_TRUE(area == SIDE * SIDE * 10.0);
        if (!merged) {
            TEST_ASSERT_EQUAL_UINT64(all.triangle_count, part[0].triangle_count + part[1].triangle_count);
            TEST_ASSERT_EQUAL_UINT64(2 * 5 * SIDE * SIDE, part[1].triangle_count);
        } else {
            TEST_ASSERT_EQUAL_UINT64(2 * 5, part[1].triangle_count);
        }
        bvx_mesh_free(ctx, &all);
        for (int i = 0; i < 2; i++) bvx_mesh_free(ctx, &part[i]);
    }
    of[0].size[2]--;
    bvx_faces_options const o = {.struct_size = sizeof o, .of = &of[0]};
    bvx_mesh none = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_LATTICE, bvx_extract_faces(ctx, &solid, &o, &none));
    of[0].size[2]++;
    for (int i = 0; i < 2; i++) bvx_grid_free(ctx, &of[i]);
    bvx_grid_free(ctx, &solid);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_label_voxels_by_the_nearest_material);
    RUN_TEST(test_labels_are_of_the_closest_triangle);
    RUN_TEST(test_label_voxels_by_colours_of_vertices);
    RUN_TEST(test_labels_come_back_from_files);
    RUN_TEST(test_faces_of_some_voxels_are_a_part_of_all);
    return UNITY_END();
}
