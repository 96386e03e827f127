/* test_position_type.c - BVX_POSITION_AUTO: every function that makes positions gives near the origin the
 * bytes of BVX_F32, and far from it, where BVX_F32 is refused, those of BVX_F64. */
#include "suite.h"

#include "bitvox_io.h"

#include <string.h>

/* One octahedron with 0.01 voxels, beside the origin or where a map has it; as all kinds of input. */
typedef struct world {
    double corner[18];
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid solid;
    bvx_field field;
    bvx_octree *tree;
    float samples[24 * 24 * 24];
    bvx_volume_view volume;
} world;

static world worlds[2];

typedef bvx_status make_fn(const world *w, int32_t type, int32_t local, bvx_mesh *mesh);

static bvx_status surface(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_extract_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    return bvx_extract_surface(ctx, &w->solid, &o, mesh);
}

static bvx_status faces(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_faces_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    return bvx_extract_faces(ctx, &w->solid, &o, mesh);
}

static bvx_status merged_faces(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_faces_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    o.merged = 1;
    return bvx_extract_faces(ctx, &w->solid, &o, mesh);
}

static bvx_status scalar(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_scalar_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    return bvx_extract_scalar(ctx, &w->volume, &o, mesh);
}

static bvx_status field_surface(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_field_surface_options o = {.struct_size = sizeof o};

    o.placing.position_type = type;
    o.placing.local_frame = local;
    return bvx_extract_field_surface(ctx, &w->field, &w->view, &o, mesh);
}

static bvx_status sharp_surface(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_field_surface_options o = {.struct_size = sizeof o};

    o.placing.position_type = type;
    o.placing.local_frame = local;
    o.placing.sharp = BVX_SHARP_ALWAYS;
    return bvx_extract_field_surface(ctx, &w->field, &w->view, &o, mesh);
}

static bvx_status octree(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_extract_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    return bvx_extract_octree(ctx, w->tree, 0, &o, mesh);
}

static bvx_status lods(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    int32_t const resolution = w->solid.size[0];
    bvx_lod_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    o.resolutions = &resolution;
    return bvx_build_lods(ctx, &w->solid, &o, 1, mesh);
}

static bvx_status collapsed_lods(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    uint64_t const target = 100;
    bvx_lod_options o = {.struct_size = sizeof o};

    o.position_type = type;
    o.local_frame = local;
    o.target_triangles = &target;
    o.collapse = 4.0;
    return bvx_build_lods(ctx, &w->solid, &o, 1, mesh);
}

static bvx_status repair(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_repair_options o = {.struct_size = sizeof o};

    o.placing.position_type = type;
    o.placing.local_frame = local;
    o.fit.lattice = &w->lattice;
    return bvx_repair(ctx, &w->view, &o, mesh);
}

static bvx_status hull(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_hull_options o = {.struct_size = sizeof o};

    o.placing.position_type = type;
    o.placing.local_frame = local;
    o.fit.lattice = &w->lattice;
    return bvx_hull(ctx, &w->view, &o, 1, mesh);
}

static bvx_status boolean(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    bvx_boolean_options o = {.struct_size = sizeof o};

    o.placing.position_type = type;
    o.placing.local_frame = local;
    o.fit.lattice = &w->lattice;
    return bvx_boolean(ctx, &w->view, &w->view, BVX_BOOLEAN_UNION, &o, mesh);
}

static bvx_status levels(const world *w, int32_t type, int32_t local, bvx_mesh *mesh)
{
    uint64_t const target = 200;
    bvx_levels_options o = {.struct_size = sizeof o};

    (void)local;
    o.collapse.position_type = type;
    o.solid = 1;
    o.targets.triangles = &target;
    o.fit.lattice = &w->lattice;
    return bvx_build_levels(ctx, &w->view, &o, 1, mesh);
}

static const struct maker {
    const char *name;
    make_fn *make;
    int frames; /* it has local_frame */
} makers[] = {
    {"bvx_extract_surface", surface, 1},
    {"bvx_extract_faces", faces, 1},
    {"bvx_extract_faces, merged", merged_faces, 1},
    {"bvx_extract_scalar", scalar, 1},
    {"bvx_extract_field_surface", field_surface, 1},
    {"bvx_extract_field_surface, sharp", sharp_surface, 1},
    {"bvx_extract_octree", octree, 1},
    {"bvx_build_lods", lods, 1},
    {"bvx_build_lods, collapsed", collapsed_lods, 1},
    {"bvx_repair", repair, 1},
    {"bvx_hull", hull, 1},
    {"bvx_boolean", boolean, 1},
    {"bvx_build_levels, measured", levels, 0},
};

static uint64_t made_hash(const struct maker *m, const world *w, int32_t type, int32_t local,
                          int32_t *made_type)
{
    bvx_mesh mesh = {0};
    uint64_t hash = 0;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, m->make(w, type, local, &mesh), bvx_last_message(ctx));
    TEST_ASSERT_TRUE_MESSAGE(mesh.triangle_count != 0, m->name);
    /* positions, their type, triangles, frame */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &hash));
    *made_type = mesh.position_type;
    bvx_mesh_free(ctx, &mesh);
    return hash;
}

static void test_near_the_origin_positions_are_floats(void)
{
    for (size_t i = 0; i < sizeof makers / sizeof makers[0]; i++) {
        int32_t automatic, given;
        uint64_t const expected = made_hash(&makers[i], &worlds[0], BVX_F32, 0, &given);

        TEST_ASSERT_EQUAL_HEX64_MESSAGE(
            expected, made_hash(&makers[i], &worlds[0], BVX_POSITION_AUTO, 0, &automatic), makers[i].name);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_F32, automatic, makers[i].name);
    }
}

static void test_far_from_the_origin_positions_are_doubles(void)
{
    for (size_t i = 0; i < sizeof makers / sizeof makers[0]; i++) {
        int32_t automatic, given;
        bvx_mesh refused = {0};
        uint64_t expected;

        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_RANGE, makers[i].make(&worlds[1], BVX_F32, 0, &refused),
                                        makers[i].name);
        expected = made_hash(&makers[i], &worlds[1], BVX_F64, 0, &given);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(
            expected, made_hash(&makers[i], &worlds[1], BVX_POSITION_AUTO, 0, &automatic), makers[i].name);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_F64, automatic, makers[i].name);
    }
}

static void test_a_local_frame_needs_no_doubles(void)
{
    for (size_t i = 0; i < sizeof makers / sizeof makers[0]; i++) {
        int32_t type;

        if (!makers[i].frames) continue;
        made_hash(&makers[i], &worlds[1], BVX_POSITION_AUTO, 1, &type);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_F32, type, makers[i].name);
    }
}

static void test_counts_are_given_wherever_the_grid_lies(void)
{
    for (int i = 0; i < 2; i++) {
        bvx_extract_options e = {.struct_size = sizeof e};
        uint64_t vertices, triangles;
        bvx_mesh mesh = {0};

        e.position_type = BVX_POSITION_AUTO;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_count(ctx, &worlds[i].solid, &e, &vertices, &triangles));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &worlds[i].solid, &e, &mesh));
        TEST_ASSERT_EQUAL_UINT64(mesh.vertex_count, vertices);
        TEST_ASSERT_EQUAL_UINT64(mesh.triangle_count, triangles);
        bvx_mesh_free(ctx, &mesh);
    }
}

/* Each level has its own type: here only the finest voxels are too small for floats. */
static void test_each_level_has_its_own_type(void)
{
    static const double origin[3] = {0, 4096, 0}, spacing[3] = {0.0625, 0.0625, 0.0625};
    static const int32_t dims[3] = {32, 32, 32}, resolution[2] = {32, 4};
    bvx_lattice lattice;
    bvx_lod_options o = {.struct_size = sizeof o};
    bvx_grid solid = {0};
    bvx_mesh level[2] = {{0}};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &solid));
    for (int32_t z = 4; z < 28; z++)
        for (int32_t y = 4; y < 28; y++)
            for (int32_t x = 4; x < 28; x++) bvx_grid_set(&solid, x, y, z, 1);
    o.resolutions = resolution;
    o.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_build_lods(ctx, &solid, &o, 2, level));
    o.position_type = BVX_POSITION_AUTO;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_lods(ctx, &solid, &o, 2, level));
    TEST_ASSERT_EQUAL_INT32(BVX_F64, level[0].position_type);
    TEST_ASSERT_EQUAL_INT32(BVX_F32, level[1].position_type);
    for (int i = 0; i < 2; i++) bvx_mesh_free(ctx, &level[i]);
    bvx_grid_free(ctx, &solid);
}

/* Contours are doubles, and so is what is built of them; a mesh that is simplified keeps its type. */
static void test_without_voxels_the_input_decides(void)
{
    bvx_sections_options so = {.struct_size = sizeof so};
    bvx_slice_options cut = {.struct_size = sizeof cut};
    bvx_simplify_options si = {.struct_size = sizeof si};
    bvx_sections sections = {0};
    bvx_mesh mesh = {0};

    cut.spacing = 0.04;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_slice_mesh(ctx, &worlds[0].view, &cut, &sections),
                                    bvx_last_message(ctx));
    so.position_type = BVX_POSITION_AUTO;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_build_sections(ctx, &sections, &so, &mesh),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_F64, mesh.position_type);
    bvx_mesh_free(ctx, &mesh);
    bvx_sections_free(ctx, &sections);

    TEST_ASSERT_EQUAL_INT32(BVX_POSITION_AUTO, si.collapse.position_type);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &worlds[0].view, &si, 1, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_F64, mesh.position_type);
    bvx_mesh_free(ctx, &mesh);
}

/* ---- the worlds ---- */

static void make_world(world *w, const double origin[3])
{
    static const uint32_t triangles[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                           2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    static const double spacing[3] = {0.01, 0.01, 0.01};
    static const int32_t dims[3] = {24, 24, 24};
    bvx_refine_options refining = {.struct_size = sizeof refining};
    bvx_field_options measuring = {.struct_size = sizeof measuring};

    for (int v = 0; v < 6; v++)
        for (int a = 0; a < 3; a++)
            w->corner[3 * v + a] = origin[a] + 0.12 + (a == v / 2 ? (v % 2 == 0 ? 0.1 : -0.1) : 0.0);
    w->view.positions = w->corner;
    w->view.indices = triangles;
    w->view.vertex_count = 6;
    w->view.triangle_count = 8;
    w->view.position_type = BVX_F64;
    w->view.index_type = BVX_U32;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &w->lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &w->view, &w->lattice, NULL, &w->solid));
    measuring.features = 1;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK, bvx_measure_field(ctx, &w->view, &w->lattice, &measuring, &w->field), bvx_last_message(ctx));
    refining.levels = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine(ctx, &w->view, &w->lattice, &refining, &w->tree));
    for (int i = 0; i < 24 * 24 * 24; i++) {
        double const x = i % 24 - 11.5, y = i / 24 % 24 - 11.5, z = i / 576 - 11.5;

        w->samples[i] = (float)(64.0 - x * x - y * y - z * z);
    }
    w->volume.samples = w->samples;
    w->volume.sample_type = BVX_SAMPLE_F32;
    memcpy(w->volume.size, dims, sizeof dims);
    w->volume.lattice = w->lattice;
}

void setUp(void)
{
    suite_open(0);
    static const double near[3] = {0, 0, 0}, far[3] = {500000, 5600000, 0};
    make_world(&worlds[0], near);
    make_world(&worlds[1], far);
}

void tearDown(void)
{
    for (int i = 0; i < 2; i++) {
        bvx_octree_free(ctx, worlds[i].tree);
        bvx_field_free(ctx, &worlds[i].field);
        bvx_grid_free(ctx, &worlds[i].solid);
    }
    memset(worlds, 0, sizeof worlds);
    suite_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_near_the_origin_positions_are_floats);
    RUN_TEST(test_far_from_the_origin_positions_are_doubles);
    RUN_TEST(test_a_local_frame_needs_no_doubles);
    RUN_TEST(test_counts_are_given_wherever_the_grid_lies);
    RUN_TEST(test_each_level_has_its_own_type);
    RUN_TEST(test_without_voxels_the_input_decides);
    return UNITY_END();
}
