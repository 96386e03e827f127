/* algebra_cases.h - golden cases of set algebra, blocks, other lattices and
 * booleans of meshes; read in by golden.c. */
#ifndef ALGEBRA_CASES_H
#define ALGEBRA_CASES_H

static void combined(golden *g, const char *key, bvx_status status, bvx_grid *grid)
{
    if (golden_good(g, status)) grid_value(g, key, grid);
}

static void block_values(golden *g, const bvx_grid *a)
{
    static const int32_t factor[3] = {3, 2, 5};
    static const char *const rule[3] = {"any", "all", "majority"};
    static uint32_t counts[20000];
    uint64_t count = 0, h = 0;
    bvx_grid made = {0};

    for (int32_t r = BVX_REDUCE_ANY; r <= BVX_REDUCE_MAJORITY; r++)
        combined(g, rule[r], bvx_grid_downsample(g->context, a, factor, r, &made), &made);
    if (golden_good(
            g, bvx_grid_coverage(g->context, a, factor, counts, sizeof counts / sizeof counts[0], &count))) {
        for (uint64_t i = 0; i < count; i++) h = mixed_word(h, counts[i]);
        golden_hex(g, "coverage", h);
    }
}

static void moved_values(golden *g, const bvx_grid *a)
{
    static const int32_t low[3] = {1, 70, 0}, high[3] = {0, 3, 64}, axes[3] = {2, 0, 1}, flips[3] = {1, 0, 1};
    bvx_window content;
    bvx_lattice other;
    bvx_grid made = {0};
    static const double origin[3] = {-2.5, -2, -1}, spacing[3] = {0.07, 0.05, 0.03};
    static const int32_t dims[3] = {70, 80, 66};

    bvxi_grid_content(a, &content);
    combined(g, "crop", bvx_grid_crop(g->context, a, &content, &made), &made);
    combined(g, "pad", bvx_grid_pad(g->context, a, low, high, &made), &made);
    combined(g, "permute", bvx_grid_permute(g->context, a, axes, flips, &made), &made);
    if (golden_good(g, bvx_lattice_make(g->context, origin, spacing, dims, &other)))
        combined(g, "resample", bvx_grid_resample(g->context, a, &other, NULL, &made), &made);
}

static void algebra_cases(golden *g)
{
    bvx_mesh_view view, ball_view;
    bvx_lattice lattice;
    bvx_grid a = {0}, b = {0}, made = {0};
    static shape ball;
    shape_torus(&golden_shape, 48, 20, 0.25, 7);
    shape_view(&golden_shape, &view);
    shape_ball(&ball, 12);
    for (uint32_t i = 0; i < ball.vertices; i++) ball.v[i][0] += 2;
    shape_view(&ball, &ball_view);
    golden_begin(g, "torus_and_ball");
    if (golden_good(g, bvx_lattice_fit(g->context, &view, 66, &lattice)) &&
        golden_good(g, bvx_voxelize_solid(g->context, &view, &lattice, NULL, &a)) &&
        golden_good(g, bvx_voxelize_solid(g->context, &ball_view, &lattice, NULL, &b))) {
        combined(g, "union", bvx_grid_combine(g->context, &a, &b, BVX_BOOLEAN_UNION, &made), &made);
        combined(g, "intersection", bvx_grid_combine(g->context, &a, &b, BVX_BOOLEAN_INTERSECTION, &made),
                 &made);
        combined(g, "difference", bvx_grid_combine(g->context, &a, &b, BVX_BOOLEAN_DIFFERENCE, &made), &made);
        combined(g, "xor", bvx_grid_combine(g->context, &a, &b, BVX_BOOLEAN_XOR, &made), &made);
        combined(g, "complement", bvx_grid_complement(g->context, &a, &made), &made);
        block_values(g, &a);
        moved_values(g, &a);
    }
    golden_end(g);
    bvx_grid_free(g->context, &a);
    bvx_grid_free(g->context, &b);
    golden_begin(g, "meshes");
    for (int32_t operation = BVX_BOOLEAN_UNION; operation <= BVX_BOOLEAN_XOR; operation++) {
        static const char *const name[4] = {"union", "intersection", "difference", "xor"};
        bvx_boolean_options o = {.struct_size = sizeof o};
        bvx_mesh mesh = {0};
        o.fit.resolution = 40;
        o.placing.sharp = BVX_SHARP_NEVER + (operation & 1);
        mesh_value(g, name[operation], bvx_boolean(g->context, &view, &ball_view, operation, &o, &mesh),
                   &mesh);
    }
    golden_end(g);

    /* A lens thinner than a voxel: a slot, and what hangs on it. */
    for (uint32_t i = 0; i < ball.vertices; i++) ball.v[i][0] = 2 + 0.01 * (ball.v[i][0] - 2);
    golden_begin(g, "thin_meshes");
    for (int32_t operation = BVX_BOOLEAN_UNION; operation <= BVX_BOOLEAN_DIFFERENCE; operation += 2) {
        bvx_boolean_options o = {.struct_size = sizeof o};
        bvx_mesh mesh = {0};
        o.fit.resolution = 40;
        mesh_value(g, operation == 0 ? "union" : "difference",
                   bvx_boolean(g->context, &view, &ball_view, operation, &o, &mesh), &mesh);
    }
    golden_end(g);
}

#endif
