/* section_cases.h - golden cases of contours of meshes and of bodies from sections; read in by golden.c. */
#ifndef SECTION_CASES_H
#define SECTION_CASES_H

#include "tools/section_maker.h"

static section_maker golden_stack; /* large, so not on the stack */

static void body_values(golden *g, const bvx_sections *sections, int32_t cells)
{
    static const char *const key[] = {"exact", "paper", "classic"};
    bvx_sections_report report;

    for (int32_t crossings = BVX_CROSSINGS_EXACT; crossings <= BVX_CROSSINGS_CLASSIC; crossings++)
        for (int32_t caps = BVX_CAPS_FLAT; caps <= BVX_CAPS_OPEN; caps++) {
            bvx_sections_options o = {.struct_size = sizeof o};
            bvx_mesh mesh = {0};
            o.slabs.crossings = crossings;
            o.caps = caps;
            o.slabs.grid[0] = o.slabs.grid[1] = cells;
            o.report = &report;
            mesh_value(g, key[crossings], bvx_build_sections(g->context, sections, &o, &mesh), &mesh);
            if (crossings != BVX_CROSSINGS_EXACT || caps != BVX_CAPS_TAPER) continue;
            golden_u64(g, "unkept", report.unkept_edges + report.unkept_loops);
        }
}

/* Contours as a file, and what is read from it again. */
static void contour_file_values(golden *g, const char *key, const bvx_sections *sections, int32_t format)
{
    bvx_buffer file = {0};
    bvx_sections read;

    memset(&read, 0, sizeof read);
    if (golden_good(g, bvx_write_sections(g->context, sections, format, &file))) {
        golden_hex(g, key, bvx_hash(file.bytes, (size_t)file.size, 0));
        if (golden_good(g, bvx_read_sections(g->context, file.bytes, file.size, format, NULL, &read)))
            golden_hex(g, "read", mixed_doubles(0, read.points, 3 * read.point_count));
    }
    bvx_sections_free(g->context, &read);
    bvx_buffer_free(g->context, &file);
}

/* Of vertices, of facets, and of facets by their vertices. */
static void normal_values(golden *g, const char *name, const bvx_mesh_view *view)
{
    static float vertex[3 * SHAPE_MAX], facet[3 * SHAPE_MAX];

    golden_begin(g, name);
    for (int averaged = 0; averaged < 2; averaged++)
        if (golden_good(g, bvx_mesh_normals(g->context, view, averaged, vertex, facet))) {
            if (averaged == 0) golden_hex(g, "vertices", mixed_floats(0, vertex, 3 * view->vertex_count));
            golden_hex(g, averaged ? "averaged" : "facets", mixed_floats(0, facet, 3 * view->triangle_count));
        }
    golden_end(g);
}

/* By both filters, and with the pairs that cross undone. */
static void smooth_values(golden *g, const char *name, const bvx_mesh_view *view)
{
    static double positions[3 * SHAPE_MAX];

    golden_begin(g, name);
    for (int32_t i = 0; i < 3; i++) {
        static const char *const what[3] = {"sinc", "taubin", "apart"};
        bvx_smooth_options const o = {.struct_size = sizeof o,
                                      .method = i == 1,
                                      .sharp_angle = i == 2 ? 20.0 : 0.0,
                                      .no_crossings = i == 2};
        if (golden_good(g, bvx_mesh_smooth(g->context, view, &o, positions)))
            golden_hex(g, what[i], mixed_doubles(0, positions, 3 * view->vertex_count));
    }
    golden_end(g);
}

/* Contours of a mesh across an axis and askew: their file, and the bodies made of them. */
static void slice_values(golden *g, const char *name, const bvx_mesh_view *view, double x, double y, double z)
{
    bvx_slice_options o = {.struct_size = sizeof o};
    bvx_sections sections;

    memset(&sections, 0, sizeof sections);
    o.normal[0] = x;
    o.normal[1] = y;
    o.normal[2] = z;
    o.spacing = 0.21875;
    golden_begin(g, name);
    if (golden_good(g, bvx_slice_mesh(g->context, view, &o, &sections))) {
        golden_u64(g, "loops", sections.loop_count);
        golden_u64(g, "points", sections.point_count);
        contour_file_values(g, "csl", &sections, BVX_FORMAT_CSL);
        if (z == 1.0) contour_file_values(g, "csv", &sections, BVX_FORMAT_CSV);
        body_values(g, &sections, 24);
    }
    golden_end(g);
    bvx_sections_free(g->context, &sections);
}

/* Walls that lean by more than their thickness, each level blended for
 * itself; a wall too thin for its cells at the top. */
static void wall_values(golden *g)
{
    if (golden_skips(g, "walls")) return;
    stack_clear(&golden_stack);
    for (int k = 0; k < 6; k++) {
        uint32_t const s = stack_section(&golden_stack, 0.75 * k);
        double const thin = k < 4 ? 0.25 : 0.01;
        stack_round(&golden_stack, s, 0.5 * k, 0.125 * k * k, 3, 2.5, 48, 0, 0, k & 1);
        stack_round(&golden_stack, s, 0.5 * k, 0.125 * k * k, 3 - thin, 2.5 - thin, 48, 0, 0, 0);
        if (k < 3) stack_round(&golden_stack, s, 0.5 * k, 0.125 * k * k, 1, 1, 20, 0.2, 0.25 * k, 0);
    }
    golden_begin(g, "walls");
    body_values(g, &golden_stack.s, 21);
    golden_end(g);
}

/* A keyhole, a bow tie, loops that share a border and loops that cross, mended. */
static void mended_values(golden *g)
{
    static const double keyhole[] = {0, 0, 4, 0, 4, 4, 0, 4, 0, 2, 1, 2, 1, 3, 3, 3, 3, 1, 1, 1, 1, 2, 0, 2};
    static const double bow[] = {5, 0, 8, 3, 8, 0.5, 5, 4};
    static const double side[] = {4, 1, 4.5, 1, 4.5, 3, 4, 3};
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};

    stack_clear(&golden_stack);
    for (int k = 0; k < 3; k++) {
        uint32_t const s = stack_section(&golden_stack, k);
        stack_loop(&golden_stack, s);
        for (size_t i = 0; i < sizeof keyhole / sizeof *keyhole; i += 2)
            stack_point(&golden_stack, keyhole[i], keyhole[i + 1]);
        stack_loop(&golden_stack, s);
        for (size_t i = 0; i < 8; i += 2) stack_point(&golden_stack, bow[i], bow[i + 1]);
        stack_loop(&golden_stack, s);
        for (size_t i = 0; i < 8; i += 2) stack_point(&golden_stack, side[i], side[i + 1]);
        stack_round(&golden_stack, s, 1, 8 + 0.25 * k, 2, 1.5, 24, 0.1, 0.25, 0);
        stack_round(&golden_stack, s, 3, 8, 2, 1.5, 28, 0.1, 0.5, 1);
    }
    o.mend = 1;
    golden_begin(g, "mended");
    mesh_value(g, "exact", bvx_build_sections(g->context, &golden_stack.s, &o, &mesh), &mesh);
    golden_end(g);
}

/* A shell through planes of any direction, then planes along the axes, one of them without a loop. */
static void oblique_values(golden *g)
{
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};
    uint64_t seed = 23;

    o.cells = 24;
    if (golden_skips(g, "oblique")) return;
    golden_begin(g, "oblique");
    stack_oblique(&golden_stack);
    for (int i = 0; i < 9; i++) {
        uint32_t const k = stack_any_plane(&golden_stack, &seed, 0.8);
        stack_ball_cut(&golden_stack, k, 0.1, 0, 0, 1.0, 60);
        stack_ball_cut(&golden_stack, k, 0.1, 0, 0, 0.5, 40);
    }
    mesh_value(g, "shell", bvx_build_sections(g->context, &golden_stack.s, &o, &mesh), &mesh);
    stack_oblique(&golden_stack);
    for (int i = 0; i < 9; i++)
        stack_ball_cut(&golden_stack,
                       stack_plane(&golden_stack, i % 3 == 0, i % 3 == 1, i % 3 == 2, 0.6 * (i / 3)), 0, 0, 0,
                       1.0, 48);
    mesh_value(g, "axes", bvx_build_sections(g->context, &golden_stack.s, &o, &mesh), &mesh);
    golden_end(g);
}

/* One section alone: a slab, a lens, a wall. */
static void lone_values(golden *g)
{
    static const char *const key[] = {"slab", "lens", "wall"};

    stack_clear(&golden_stack);
    stack_round(&golden_stack, stack_section(&golden_stack, 2.0), 0, 0, 3, 2, 60, 0.2, 0, 0);
    stack_round(&golden_stack, 0, 0.5, 0, 1, 1, 30, 0, 0, 1);
    golden_begin(g, "lone");
    for (int32_t caps = BVX_CAPS_FLAT; caps <= BVX_CAPS_OPEN; caps++) {
        bvx_sections_options o = {.struct_size = sizeof o};
        bvx_mesh mesh = {0};
        o.caps = caps;
        o.thickness = 0.75;
        mesh_value(g, key[caps], bvx_build_sections(g->context, &golden_stack.s, &o, &mesh), &mesh);
    }
    golden_end(g);
}

/* Half discs that touch on parallel planes, then a core in its shell on planes of any direction: made at once. */
static void bodies_values(golden *g)
{
    static const char *const key[] = {"first", "second"};
    static const int32_t labels[] = {1, 2};
    uint64_t seed = 23;

    if (golden_skips(g, "bodies")) return;
    golden_begin(g, "bodies");
    for (int way = 0; way < 2; way++) {
        bvx_sections_options o = {.struct_size = sizeof o};
        bvx_mesh made[2] = {0};
        bvx_status status;

        o.cells = 20;
        if (way == 0) stack_clear(&golden_stack);
        else stack_oblique(&golden_stack);
        for (int i = 0; i < 6; i++) {
            uint32_t const k = way == 0 ? stack_section(&golden_stack, 0.25 * i)
                                        : stack_any_plane(&golden_stack, &seed, 0.8);
            for (int label = 1; label <= 2; label++) {
                for (int part = 0; way == 1 && part < 3 - label; part++)
                    if (stack_ball_cut(&golden_stack, k, 0.1, 0, 0, label + part == 1 ? 1.0 : 0.5, 40))
                        golden_stack.loop[golden_stack.s.loop_count - 1].label = label;
                if (way == 1) continue;
                stack_loop(&golden_stack, k);
                golden_stack.loop[golden_stack.s.loop_count - 1].label = label;
                for (int p = 0; p <= 16; p++) {
                    double x, y;
                    stack_circle(0.5 * (label - 1) + p / 32.0, &x, &y);
                    stack_point(&golden_stack, (1.0 + 0.1 * i) * x + 0.2 * i, y);
                }
            }
        }
        status = bvx_build_bodies(g->context, &golden_stack.s, &o, labels, 2, made);
        for (int b = 0; b < 2; b++) mesh_value(g, key[b], status, &made[b]);
    }
    golden_end(g);
}

static void section_cases(golden *g)
{
    static const char *const name[] = {"random_1", "random_2", "random_3",
                                       "random_4", "random_5", "random_6"};
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;
    uint64_t seed = 99;

    for (int i = 0; i < 6; i++) {
        bvx_status status;
        do {
            bvx_mesh mesh = {0};
            stack_random(&golden_stack, &seed);
            status = bvx_build_sections(g->context, &golden_stack.s, &o, &mesh);
            bvx_mesh_free(g->context, &mesh);
        } while (status == BVX_ERR_FORMAT); /* loops that cross */
        golden_begin(g, name[i]);
        body_values(g, &golden_stack.s, 9 + 4 * i);
        golden_end(g);
    }
    wall_values(g);
    mended_values(g);
    oblique_values(g);
    lone_values(g);
    bodies_values(g);
    shape_torus(&golden_shape, 96, 40, 0.05, 7);
    shape_view(&golden_shape, &view);
    normal_values(g, "torus_normals", &view);
    smooth_values(g, "torus_smooth", &view);
    slice_values(g, "torus_z", &view, 0, 0, 1);
    if (!golden_skips(g, "torus_x")) slice_values(g, "torus_x", &view, 1, 0, 0);
    slice_values(g, "torus_askew", &view, 0.6, -0.36, 0.72);
}

#endif
