/* voxel_cases.h - golden cases of voxel surfaces, fills and octrees; read in by golden.c. */
#ifndef VOXEL_CASES_H
#define VOXEL_CASES_H

/* Voxels of a surface by each mode, with the triangles that touch them, and the voxels' faces. */
static void attached_value(golden *g, const char *key, const bvx_attached *a)
{
    uint64_t hash = bvx_hash(a->triangles, (size_t)a->triangle_count * 4, a->voxel_count);

    golden_u64(g, key, a->triangle_count);
#if defined(__BYTE_ORDER__) && __BYTE_ORDER__ == __ORDER_BIG_ENDIAN__
    hash = 0;
    for (uint64_t i = 0; i < a->triangle_count; i++) { /* hashes are over little-endian bytes */
        uint32_t const v = a->triangles[i];
        a->triangles[i] = v >> 24 | (v >> 8 & 0xff00u) | (v << 8 & 0xff0000u) | v << 24;
    }
    hash = bvx_hash(a->triangles, (size_t)a->triangle_count * 4, a->voxel_count);
#endif
    golden_hex(g, "ids", hash);
}

static void grid_value(golden *g, const char *key, bvx_grid *grid)
{
    uint64_t hash = 0;
    if (golden_good(g, bvx_grid_hash(g->context, grid, &hash))) golden_hex(g, key, hash);
    bvx_grid_free(g->context, grid);
}

static void faces_value(golden *g, const bvx_grid *grid, int32_t merged)
{
    bvx_faces_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};
    uint64_t hash = 0;

    o.merged = merged;
    if (golden_good(g, bvx_extract_faces(g->context, grid, &o, &mesh)) &&
        golden_good(g, bvx_mesh_hash(g->context, &mesh, &hash)))
        golden_hex(g, merged ? "merged" : "faces", hash);
    bvx_mesh_free(g->context, &mesh);
}

static void surface_modes(golden *g, const char *name, const bvx_mesh_view *view, int32_t resolution)
{
    static const char *const mode[3] = {"conservative", "thin", "sampled"};
    bvx_lattice lattice;

    golden_begin(g, name);
    if (golden_good(g, bvx_lattice_fit(g->context, view, resolution, &lattice)))
        for (int32_t m = BVX_SURFACE_CONSERVATIVE; m <= BVX_SURFACE_SAMPLED; m++) {
            bvx_surface_options o = {.struct_size = sizeof o};
            bvx_attached attached = {0};
            bvx_grid grid = {0};
            o.mode = m;
            o.attached = &attached;
            if (!golden_good(g, bvx_voxelize_surface(g->context, view, &lattice, &o, &grid))) break;
            attached_value(g, mode[m], &attached);
            if (m == BVX_SURFACE_THIN) faces_value(g, &grid, 0);
            if (m == BVX_SURFACE_THIN) faces_value(g, &grid, 1);
            grid_value(g, "bits", &grid);
            bvx_attached_free(g->context, &attached);
        }
    golden_end(g);
}

static void voxel_surface_cases(golden *g)
{
    bvx_mesh_view view;

    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    shape_view(&golden_shape, &view);
    if (!golden_skips(g, "torus_130")) surface_modes(g, "torus_130", &view, 130);
    surface_modes(g, "torus_17", &view, 17);
    shape_soup(&golden_shape, 300, 11);
    shape_view(&golden_shape, &view);
    surface_modes(g, "soup_65", &view, 65);
}

/* ---- Fills: all rules on one mesh; left-out triangles make holes ---- */

static void fill_rules(golden *g, const char *name, const bvx_mesh_view *view, int32_t resolution)
{
    static const char *const rule[] = {"parity", "nonzero", "vote", "flood", "regions", "below", "winding"};
    bvx_lattice lattice;

    if (golden_skips(g, name)) return;
    golden_begin(g, name);
    if (golden_good(g, bvx_lattice_fit(g->context, view, resolution, &lattice)))
        for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_WINDING; fill++) {
            bvx_voxelize_options o = {.struct_size = sizeof o};
            bvx_grid grid = {0};
            bvx_status status;
            o.fill = fill;
            o.close_gaps = fill == BVX_FILL_FLOOD;
            status = bvx_voxelize_solid(g->context, view, &lattice, &o, &grid);
            /* a flood that got in everywhere */
            if (status == BVX_ERR_EMPTY) golden_text(g, rule[fill - BVX_FILL_PARITY], "empty");
            else if (golden_good(g, status)) grid_value(g, rule[fill - BVX_FILL_PARITY], &grid);
        }
    golden_end(g);
}

static void fill_cases(golden *g)
{
    bvx_mesh_view view;

    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    shape_view(&golden_shape, &view);
    fill_rules(g, "torus_90", &view, 90);
    view.triangle_count -= 700;
    fill_rules(g, "torus_90_open", &view, 90);
    shape_ball(&golden_shape, 20);
    shape_view(&golden_shape, &view);
    view.triangle_count -= 3;
    fill_rules(g, "ball_40_open", &view, 40);
    shape_soup(&golden_shape, 300, 11);
    shape_view(&golden_shape, &view);
    fill_rules(g, "soup_40", &view, 40);
}

/* ---- Octrees ---- */

static void octree_values(golden *g, const char *name, const bvx_mesh_view *view, int32_t base_voxels,
                          int32_t levels, double tolerance, const bvx_window *window)
{
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL;
    bvx_buffer file = {0};
    bvx_mesh mesh = {0};
    uint64_t hash = 0;

    o.levels = levels != 0 ? levels : BVX_NONE;
    o.tolerance = tolerance;
    if (window != NULL) o.window = *window;
    if (golden_skips(g, name)) return;
    golden_begin(g, name);
    if (golden_good(g, bvx_lattice_fit(g->context, view, base_voxels, &base)) &&
        golden_good(g, bvx_refine(g->context, view, &base, &o, &tree)) &&
        golden_good(g, bvx_write_octree(g->context, tree, 0, BVX_FORMAT_BVX, &file))) {
        golden_u64(g, "bytes", file.size);
        golden_hex(g, "file", bvx_hash(file.bytes, (size_t)file.size, 0));
        bvx_buffer_free(g->context, &file);
        if (window == NULL && golden_good(g, bvx_extract_octree(g->context, tree, 0, NULL, &mesh)) &&
            golden_good(g, bvx_mesh_hash(g->context, &mesh, &hash)))
            golden_hex(g, "mesh", hash);
    }
    golden_end(g);
    bvx_mesh_free(g->context, &mesh);
    bvx_octree_free(g->context, tree);
}

static void octree_cases(golden *g)
{
    static const bvx_window window = {{100, 60, 20}, {64, 48, 32}};
    bvx_mesh_view view;

    shape_torus(&golden_shape, 96, 40, 0.25, 7);
    shape_view(&golden_shape, &view);
    octree_values(g, "torus_8_by_5", &view, 8, 5, 0, NULL);
    octree_values(g, "torus_5_by_4_flat", &view, 5, 4, 0.01, NULL);
    octree_values(g, "torus_16_by_4_window", &view, 16, 4, 0, &window);
    shape_soup(&golden_shape, 300, 11);
    shape_view(&golden_shape, &view);
    octree_values(g, "soup_3_by_4", &view, 3, 4, 0, NULL);
}

#endif
