/* test_slice.c - contours of boxes on planes, whose areas are known; sheets
 * that share an edge; planes that meet nothing. */
#include "bitvox_io.h"
#include "suite.h"

#include <math.h>
#include <string.h>

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

static const uint32_t box_triangles[36] = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                                           2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};

static double positions[16][3];
static uint32_t triangles[72];

static void put_box(int number, double x, double y, double z, double sx, double sy, double sz)
{
    for (int v = 0; v < 8; v++) {
        double *const p = positions[8 * number + v];
        p[0] = (v & 1) != 0 ? x + sx : x;
        p[1] = (v & 2) != 0 ? y + sy : y;
        p[2] = (v & 4) != 0 ? z + sz : z;
    }
    for (int i = 0; i < 36; i++) triangles[36 * number + i] = box_triangles[i] + 8 * (uint32_t)number;
}

static bvx_mesh_view view_of(uint64_t vertices, uint64_t count)
{
    bvx_mesh_view v;

    memset(&v, 0, sizeof v);
    v.positions = positions;
    v.indices = triangles;
    v.vertex_count = vertices;
    v.triangle_count = count;
    v.position_type = BVX_F64;
    v.index_type = BVX_U32;
    return v;
}

/* The area inside the loops of one section, positive with the inside on
 * their left; every point must lie on the plane. */
static double area_of(const bvx_sections *s, uint32_t section)
{
    double area = 0;

    for (uint64_t i = 0; i < s->loop_count; i++) {
        const bvx_section_loop *const l = &s->loops[i];
        if (l->section != section) continue;
        for (uint64_t k = 0; k < l->point_count; k++) {
            const double *const p = s->points + 3 * (l->first_point + k);
            const double *const q = s->points + 3 * (l->first_point + (k + 1) % l->point_count);
            const double *const n = s->normal;
            TEST_ASSERT_TRUE(p[0] * n[0] + p[1] * n[1] + p[2] * n[2] == s->positions[section]);
            area += 0.5 * (n[0] * (p[1] * q[2] - p[2] * q[1]) + n[1] * (p[2] * q[0] - p[0] * q[2]) +
                           n[2] * (p[0] * q[1] - p[1] * q[0]));
        }
    }
    return area;
}

static void test_slices_of_a_box_along_each_axis_and_back(void)
{
    static const double across[3] = {15, 10, 6};
    bvx_mesh_view view;

    put_box(0, 1, -2, 0.5, 2, 3, 5);
    view = view_of(8, 12);
    for (int axis = 0; axis < 3; axis++)
        for (int back = 0; back < 2; back++) {
            bvx_sections s = {0};
            bvx_slice_options o = {.struct_size = sizeof o};
            memset(o.normal, 0, sizeof o.normal);
            o.normal[axis] = back ? -1 : 1;
            o.spacing = 0.25;
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_slice_mesh(ctx, &view, &o, &s),
                                            bvx_last_message(ctx));
            TEST_ASSERT_EQUAL_UINT64(axis == 0 ? 8 : axis == 1 ? 12 : 20, s.section_count);
            TEST_ASSERT_EQUAL_UINT64(s.section_count, s.loop_count);
            for (uint32_t i = 0; i < s.section_count; i++)
                TEST_ASSERT_EQUAL_DOUBLE(across[axis], area_of(&s, i));
            bvx_sections_free(ctx, &s);
        }
}

static void test_a_spacing_of_more_than_the_mesh_is_one_plane(void)
{
    bvx_sections s = {0};
    bvx_slice_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;

    put_box(0, 0, 0, 0, 2, 3, 4);
    view = view_of(8, 12);
    o.spacing = 7; /* the first plane lies half a spacing above the lowest point */
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_slice_mesh(ctx, &view, &o, &s), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(1, s.section_count);
    TEST_ASSERT_EQUAL_DOUBLE(3.5, s.positions[0]);
    TEST_ASSERT_EQUAL_DOUBLE(6, area_of(&s, 0));
    bvx_sections_free(ctx, &s);
}

/* Four triangles meet in the edge that two boxes share; whichever way
 * contours go there, they close around the same area. */
static void test_boxes_that_share_an_edge(void)
{
    bvx_mesh_view view;

    put_box(0, 0, 0, 0, 1, 1, 1);
    put_box(1, 1, 1, 0, 1, 1, 1);
    view = view_of(16, 24);
    for (int axis = 0; axis < 3; axis++) {
        double const at[3] = {axis == 2 ? 0.125 : 0.5, axis == 2 ? 0.5 : 1.0, axis == 2 ? 0.875 : 1.5};
        bvx_sections s = {0};
        bvx_slice_options o = {.struct_size = sizeof o};
        memset(o.normal, 0, sizeof o.normal);
        o.normal[axis] = 1;
        o.positions = at;
        o.position_count = 3;
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_slice_mesh(ctx, &view, &o, &s), bvx_last_message(ctx));
        for (uint32_t i = 0; i < 3; i++) TEST_ASSERT_EQUAL_DOUBLE(axis == 2 ? 2 : 1, area_of(&s, i));
        bvx_sections_free(ctx, &s);
    }
}

static void refused(bvx_status status, const double *at, uint64_t count, double spacing,
                    const bvx_mesh_view *view, const char *words)
{
    bvx_sections s = {0};
    bvx_slice_options o = {.struct_size = sizeof o};

    o.positions = at;
    o.position_count = count;
    o.spacing = spacing;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_slice_mesh(ctx, view, &o, &s), words);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), words), bvx_last_message(ctx));
    TEST_ASSERT_NULL(s.points);
}

static void test_planes_that_meet_nothing_and_refusals(void)
{
    double const above[1] = {9};
    double const low[1] = {0};
    double const tip[1] = {3};
    double const not_finite[2] = {1, (double)INFINITY};
    double const down[2] = {2, 1};
    bvx_mesh_view box, pyramid;

    put_box(0, 0, 0, 0, 2, 3, 4);
    box = view_of(8, 12);
    refused(BVX_ERR_EMPTY, above, 1, 0, &box, "no plane meets the mesh");
    refused(BVX_ERR_EMPTY, low, 1, 0, &box, "no plane meets the mesh"); /* vertices on it count as above */
    refused(BVX_ERR_EMPTY, NULL, 0, 64, &box, "no plane meets the mesh");
    refused(BVX_ERR_ARGUMENT, above, 0, 0, &box, "0 positions");
    refused(BVX_ERR_ARGUMENT, above, (1 << 20) + 1, 0, &box, "positions");
    refused(BVX_ERR_ARGUMENT, above, 1, 1, &box, "both given");
    refused(BVX_ERR_RANGE, not_finite, 2, 0, &box, "position 1 is not finite");
    refused(BVX_ERR_ARGUMENT, down, 2, 0, &box, "position 1 does not lie above");
    refused(BVX_ERR_ARGUMENT, NULL, 0, (double)INFINITY, &box, "spacing");
    refused(BVX_ERR_ARGUMENT, NULL, 0, -1, &box, "spacing");
    refused(BVX_ERR_RANGE, NULL, 0, 1e-12, &box, "planes");
    {
        static const uint32_t faces[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
        static const double corner[4][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 3}};
        memcpy(positions, corner, sizeof corner);
        memcpy(triangles, faces, sizeof faces);
        pyramid = view_of(4, 4);
        refused(BVX_ERR_EMPTY, tip, 1, 0, &pyramid, "points and lines"); /* all its edges go up to the tip */
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_slices_of_a_box_along_each_axis_and_back);
    RUN_TEST(test_a_spacing_of_more_than_the_mesh_is_one_plane);
    RUN_TEST(test_boxes_that_share_an_edge);
    RUN_TEST(test_planes_that_meet_nothing_and_refusals);
    return UNITY_END();
}
