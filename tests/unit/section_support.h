/* section_support.h - what the tests of bodies from section contours share:
 * the stack, a sound body made of it, contour points in it. */
#ifndef SECTION_SUPPORT_H
#define SECTION_SUPPORT_H

#include "tools/section_maker.h"
#include "suite.h"

#include <stdlib.h>

#ifndef SECTION_MEND
#define SECTION_MEND 0 /* what tests begin with */
#endif

static section_maker stack;
static bvx_sections_options o;
static bvx_sections_report report;
static bvx_mesh mesh;
static bvx_certificate certificate;
static void (*free_more)(void); /* what else a suite's tests made */

void setUp(void)
{
    suite_open(0);
    o = (bvx_sections_options){.struct_size = sizeof o};
    o.report = &report;
    o.mend = SECTION_MEND;
    stack_clear(&stack);
}

void tearDown(void)
{
    bvx_mesh_free(ctx, &mesh);
    if (free_more != NULL) free_more();
    suite_close();
}

static inline bvx_status build(void)
{
    bvx_mesh_free(ctx, &mesh);
    return bvx_build_sections(ctx, &stack.s, &o, &mesh);
}

static inline void certify(int weld)
{
    bvx_mesh_view view;

    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, weld, &certificate));
}

static inline void assert_good(void)
{
    certify(0);
    TEST_ASSERT_TRUE(certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                     certificate.oriented);
    TEST_ASSERT_EQUAL_UINT64(0, certificate.duplicates + certificate.collapsed + certificate.unused_vertices);
    TEST_ASSERT_TRUE(certificate.volume > 0.0);
}

static inline void build_good(void)
{
    if (build() != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    assert_good();
}

static inline int compare_points(const void *a, const void *b)
{
    return memcmp(a, b, 24);
}

/* All contour points, bit by bit, among the vertices. */
static inline void assert_points_kept(void)
{
    double *const sorted = malloc((size_t)mesh.vertex_count * 24);
    uint64_t lost = 0;

    TEST_ASSERT_NOT_NULL(sorted);
    memcpy(sorted, mesh.positions, (size_t)mesh.vertex_count * 24);
    qsort(sorted, (size_t)mesh.vertex_count, 24, compare_points);
    for (uint64_t i = 0; i < stack.s.point_count; i++)
        lost += bsearch(stack.point + 3 * i, sorted, (size_t)mesh.vertex_count, 24, compare_points) == NULL;
    free(sorted);
    TEST_ASSERT_EQUAL_UINT64(0, lost);
}

#endif
