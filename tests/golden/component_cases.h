/* component_cases.h - golden cases of parts of grids and of clouds of points; read in by golden.c. */
#ifndef COMPONENT_CASES_H
#define COMPONENT_CASES_H

enum { PART_LIST = 4096, PART_LABELS = 130 * 20 * 18 };

static void part_values(golden *g, const bvx_grid *grid)
{
    static const int32_t kinds[3] = {6, 18, 26};
    static bvx_component parts[PART_LIST];
    static uint32_t labels[PART_LABELS];
    uint64_t const voxels = (uint64_t)grid->size[0] * (uint64_t)grid->size[1] * (uint64_t)grid->size[2];

    for (int k = 0; k < 3; k++) {
        uint64_t count = 0, h = 0;
        bvx_keep_options o = {.struct_size = sizeof o};
        bvx_grid kept = {0};
        if (golden_good(g, bvx_grid_components(g->context, grid, kinds[k], parts, PART_LIST, &count))) {
            for (uint64_t i = 0; i < count; i++) {
                h = mixed_word(mixed_word(h, parts[i].first), parts[i].voxels);
                h = mixed_integers(mixed_integers(h, parts[i].low, 3), parts[i].size, 3);
            }
            golden_u64(g, "parts", count);
            golden_hex(g, "list", h);
        }
        h = 0;
        if (golden_good(g, bvx_grid_label(g->context, grid, kinds[k], labels, PART_LABELS, &count))) {
            for (uint64_t i = 0; i < voxels; i++) h = mixed_word(h, labels[i]);
            golden_hex(g, "labels", h);
        }
        o.connectivity = kinds[k];
        o.at_least = 2;
        o.largest = 5;
        if (golden_good(g, bvx_grid_keep(g->context, grid, &o, &kept))) grid_value(g, "kept", &kept);
        if (golden_good(g, bvx_grid_fill_cavities(g->context, grid, kinds[k], 0, &kept, NULL)))
            grid_value(g, "filled", &kept);
    }
    for (int k = 0; k < 3; k += 2) {
        bvx_topology t;
        if (!golden_good(g, bvx_grid_topology(g->context, grid, kinds[k], &t))) continue;
        golden_u64(g, "cavities", t.cavities);
        golden_u64(g, "tunnels", (uint64_t)t.tunnels);
        golden_hex(g, "euler", (uint64_t)t.euler);
    }
}

static void noise_case(golden *g, const char *name, int32_t percent)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {130, 20, 18};
    uint64_t state = 7;
    bvx_lattice lattice;
    bvx_grid grid = {0};

    golden_begin(g, name);
    if (golden_good(g, bvx_lattice_make(g->context, origin, spacing, dims, &lattice)) &&
        golden_good(g, bvx_grid_create(g->context, &lattice, NULL, &grid))) {
        for (int32_t z = 0; z < dims[2]; z++)
            for (int32_t y = 0; y < dims[1]; y++)
                for (int32_t x = 0; x < dims[0]; x++)
                    bvx_grid_set(&grid, x, y, z, (int32_t)((shape_random(&state) >> 33) % 100) < percent);
        part_values(g, &grid);
    }
    golden_end(g);
    bvx_grid_free(g->context, &grid);
}

static void component_cases(golden *g)
{
    noise_case(g, "noise_4", 4);
    noise_case(g, "noise_31", 31);
    noise_case(g, "noise_92", 92);
}

/* A lattice by the hash of a voxel of it. */
static void lattice_value(golden *g, const char *key, const bvx_lattice *lattice)
{
    bvx_window const first = {{0, 0, 0}, {1, 1, 1}};
    bvx_grid voxel = {0};
    uint64_t hash;

    if (golden_good(g, bvx_grid_create(g->context, lattice, &first, &voxel)) &&
        golden_good(g, bvx_grid_hash(g->context, &voxel, &hash)))
        golden_hex(g, key, hash);
    bvx_grid_free(g->context, &voxel);
}

static void box_case(golden *g)
{
    static const double corners[2][3] = {{-1.25, 0.1, 3000.0}, {2.5, 0.1, 3001.7}};
    bvx_mesh_view const box = {.positions = corners, .vertex_count = 2, .position_type = BVX_F64};
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice lattice;

    golden_begin(g, "box_lattice");
    fit.resolution = 100;
    if (golden_good(g, bvx_lattice_fit_with(g->context, &box, &fit, &lattice)))
        lattice_value(g, "cubic", &lattice);
    fit.padding = 3;
    if (golden_good(g, bvx_lattice_fit_with(g->context, &box, &fit, &lattice)))
        lattice_value(g, "padded", &lattice);
    fit.resolution = 0;
    fit.spacing[0] = fit.spacing[1] = fit.spacing[2] = 0.03;
    if (golden_good(g, bvx_lattice_fit_with(g->context, &box, &fit, &lattice)))
        lattice_value(g, "spacing", &lattice);
    golden_end(g);
}

static void cloud_cases(golden *g)
{
    static const char text[] = "# five\nx y z\n0.1 -2 3e2\n1,2,3,4\n\n5;6;7 // more\n0.5 0.25 0.125\n9 9 9";
    bvx_mesh_view view;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice lattice;
    bvx_points_options o = {.struct_size = sizeof o};
    bvx_points_report r;
    bvx_grid grid = {0};
    bvx_mesh points = {0};
    uint64_t hash = 0;

    box_case(g);
    shape_ball(&golden_shape, 40);
    shape_view(&golden_shape, &view);
    fit.resolution = 48;
    o.report = &r;
    golden_begin(g, "ball_cloud");
    if (golden_good(g, bvx_lattice_fit_with(g->context, &view, &fit, &lattice))) {
        for (o.minimum = 1; o.minimum <= 3; o.minimum++)
            if (golden_good(g, bvx_voxelize_points(g->context, &view, &lattice, &o, &grid)))
                grid_value(g, "voxels", &grid);
        o.minimum = 1;
        o.body = 1;
        o.close_gaps = 5;
        if (golden_good(g, bvx_voxelize_points(g->context, &view, &lattice, &o, &grid)))
            grid_value(g, "body", &grid);
        golden_u64(g, "filled", r.filled);
        golden_u64(g, "pockets", r.pockets);
    }
    if (golden_good(g, bvx_read_points(g->context, text, sizeof text - 1, BVX_FORMAT_XYZ, &points)) &&
        golden_good(g, bvx_mesh_hash(g->context, &points, &hash)))
        golden_hex(g, "xyz", hash);
    golden_end(g);
    bvx_mesh_free(g->context, &points);
    bvx_grid_free(g->context, &grid);
}

#endif
