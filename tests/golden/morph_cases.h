/* morph_cases.h - golden cases of morphology and distances between voxels,
 * cubic and stretched; read in by golden.c. */
#ifndef MORPH_CASES_H
#define MORPH_CASES_H

enum { MORPH_VOXELS = 200000 };

/* ---- Grids ---- */

/* A torus with specks outside and pores inside. */
static int pitted_torus(golden *g, int32_t stretched, bvx_grid *grid)
{
    static const int32_t sides[3] = {70, 43, 21};
    bvx_mesh_view view;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice lattice;
    uint64_t state = 3;

    shape_torus(&golden_shape, 48, 20, 0.25, 7);
    shape_view(&golden_shape, &view);
    fit.padding = 2;
    if (stretched) memcpy(fit.axis_resolution, sides, sizeof sides);
    else fit.resolution = 66;
    if (!golden_good(g, bvx_lattice_fit_with(g->context, &view, &fit, &lattice)) ||
        !golden_good(g, bvx_voxelize_solid(g->context, &view, &lattice, NULL, grid)))
        return 0;
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++)
                if ((shape_random(&state) >> 40) % 40 == 0)
                    bvx_grid_set(grid, x, y, z, !bvx_grid_get(grid, x, y, z));
    return 1;
}

/* A few voxels in a wide window that begins within a word of its lattice. */
static int few_specks(golden *g, int32_t stretched, bvx_grid *grid)
{
    static const double origin[3] = {-3, 0.7, 11}, spacing[2][3] = {{0.3, 0.3, 0.3}, {0.3, 0.47, 0.21}};
    static const int32_t dims[3] = {340, 30, 25};
    static const bvx_window window = {{3, 0, 2}, {301, 27, 21}};
    uint64_t state = 17;
    bvx_lattice lattice;

    if (!golden_good(g, bvx_lattice_make(g->context, origin, spacing[stretched], dims, &lattice)) ||
        !golden_good(g, bvx_grid_create(g->context, &lattice, &window, grid)))
        return 0;
    for (int i = 0; i < 4; i++) {
        int32_t at[3];
        for (int a = 0; a < 3; a++)
            at[a] = (int32_t)((shape_random(&state) >> 40) % (uint64_t)window.size[a]);
        bvx_grid_set(grid, at[0], at[1], at[2], 1);
    }
    return 1;
}

/* ---- Morphology ---- */

static const char *const morph_names[4] = {"dilate", "erode", "open", "close"};

/* One neighbourhood, or a ball of radius times the least spacing, by all
 * four; what shrinks takes the second grid. */
static void morphed(golden *g, const bvx_grid *grid, const bvx_grid *second, int32_t neighbourhood,
                    int32_t steps, double radius)
{
    const double *const s = grid->lattice.spacing;
    double const least = s[0] < s[1] ? (s[0] < s[2] ? s[0] : s[2]) : (s[1] < s[2] ? s[1] : s[2]);

    for (int32_t i = 0; i < 4; i++) {
        char key[24];
        bvx_morph_options o = {.struct_size = sizeof o};
        bvx_grid made = {0};
        o.neighbourhood = neighbourhood != 0 ? neighbourhood : BVX_BALL;
        o.steps = steps;
        o.radius = radius * least;
        o.beyond = second == grid ? (i + steps) & 1 : i == 1 || i == 2;
        snprintf(key, sizeof key, "%s%d", morph_names[i],
                 neighbourhood != 0 ? (int)neighbourhood : (int)radius);
        combined(g, key, bvx_grid_morph(g->context, i == 1 || i == 2 ? second : grid, i, &o, &made), &made);
    }
}

static void hollowed(golden *g, const bvx_grid *grid)
{
    for (int32_t drain = 0; drain < 3; drain++) {
        static const char *const key[3] = {"hollow", "drained_z", "drained_x"};
        bvx_hollow_options o = {.struct_size = sizeof o};
        bvx_hollow_report report;
        bvx_grid made = {0};
        o.thickness = 1.1 * grid->lattice.spacing[1];
        o.drain_radius = drain != 0 ? 2 * grid->lattice.spacing[0] : 0;
        o.drain_side = drain == 2 ? BVX_OPEN_X_HIGH : BVX_OPEN_Z_LOW;
        o.report = &report;
        combined(g, key[drain], bvx_grid_hollow(g->context, grid, &o, &made), &made);
        golden_hex(
            g, "report",
            mixed_doubles(mixed_word(mixed_word(0, report.hollowed), report.drained), report.drain, 3));
    }
}

/* ---- Distances ---- */

static void distances_of(golden *g, const bvx_grid *grid)
{
    static const char *const side_name[3] = {"outside", "inside", "signed"};
    static double values[MORPH_VOXELS];
    static uint64_t nearest[MORPH_VOXELS];
    float *const floats = (float *)malloc(MORPH_VOXELS * sizeof *floats);
    uint64_t const voxels = (uint64_t)grid->size[0] * (uint64_t)grid->size[1] * (uint64_t)grid->size[2];

    if (floats == NULL) exit(2);
    for (int32_t side = BVX_DISTANCE_OUTSIDE; side <= BVX_DISTANCE_SIGNED; side++) {
        bvx_distance_options o = {.struct_size = sizeof o};
        uint64_t h = 0;
        o.side = side;
        o.beyond = side; /* each of three */
        o.nearest = nearest;
        if (golden_good(g, bvx_grid_distance(g->context, grid, &o, BVX_F64, values, MORPH_VOXELS)) &&
            golden_good(g, bvx_grid_distance(g->context, grid, &o, BVX_F32, floats, MORPH_VOXELS))) {
            for (uint64_t i = 0; i < voxels; i++) h = mixed_word(h, nearest[i]);
            golden_hex(g, side_name[side], mixed_doubles(0, values, voxels));
            golden_hex(g, "f32", mixed_floats(0, floats, voxels));
            golden_hex(g, "nearest", h);
        }
    }
    free(floats);
}

static void squares_of(golden *g, const bvx_grid *grid)
{
    static uint32_t squares[MORPH_VOXELS];
    uint64_t const voxels = (uint64_t)grid->size[0] * (uint64_t)grid->size[1] * (uint64_t)grid->size[2];
    uint64_t h = 0;
    if (!golden_good(g, bvx_grid_distance(g->context, grid, NULL, BVX_SQUARES, squares, MORPH_VOXELS)))
        return;
    for (uint64_t i = 0; i < voxels; i++) h = mixed_word(h, squares[i]);
    golden_hex(g, "squares", h);
}

static void morph_cases(golden *g)
{
    static const char *const name[2][2] = {{"torus_cubic", "torus_stretched"},
                                           {"specks_cubic", "specks_stretched"}};

    for (int32_t stretched = 0; stretched < 2; stretched++) {
        bvx_grid grid = {0}, specks = {0}, rest = {0};
        if (!golden_skips(g, name[0][stretched])) {
            golden_begin(g, name[0][stretched]);
            if (pitted_torus(g, stretched, &grid)) {
                morphed(g, &grid, &grid, 6, 1, 0);
                morphed(g, &grid, &grid, 18, 3, 0);
                morphed(g, &grid, &grid, 26, 2, 0);
                morphed(g, &grid, &grid, 0, 1, 2.3);
                hollowed(g, &grid);
                distances_of(g, &grid);
                if (!stretched) squares_of(g, &grid);
            }
            golden_end(g);
        }
        if (!golden_skips(g, name[1][stretched])) {
            golden_begin(g, name[1][stretched]);
            if (few_specks(g, stretched, &specks) &&
                golden_good(g, bvx_grid_complement(g->context, &specks, &rest))) {
                morphed(g, &specks, &rest, 6, 30, 0);
                morphed(g, &specks, &rest, 0, 1, 15);
                morphed(g, &specks, &rest, 0, 1, 37);
                distances_of(g, &specks);
                if (!stretched) squares_of(g, &specks);
            }
            golden_end(g);
        }
        bvx_grid_free(g->context, &grid);
        bvx_grid_free(g->context, &specks);
        bvx_grid_free(g->context, &rest);
    }
}

#endif
