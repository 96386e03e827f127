/* fuzz_morph.c - random sets of voxels grown, shrunk, hollowed and measured: open lies in the set and the set
 * in close, growing is shrinking the rest, a window with its halo holds the whole's bits, distances and
 * nearest voxels are those of all pairs, balls and shells follow from them, threads equal one. */
#include "fuzz_input.h"

#include <math.h>

enum { FUZZ_MORPH_MOST = 900 }; /* voxels of a grid whose pairs are all measured */

static uint64_t fuzz_set(bvx_context *ctx, const bvx_grid *grid)
{
    uint64_t set = 0;
    fuzz_must(ctx, bvx_grid_count(ctx, grid, &set));
    return set;
}

static void fuzz_within(const bvx_grid *part, const bvx_grid *whole, const char *what)
{
    uint64_t const words = (uint64_t)part->words_per_row * (uint64_t)part->size[1] * (uint64_t)part->size[2];
    for (uint64_t i = 0; i < words; i++) fuzz_require((part->words[i] & ~whole->words[i]) == 0, what);
}

/* ---- Grids: spacings and radii in eighths, so that the squares of distances are whole and ties are common  */

static void fuzz_take_grid(fuzz_input *in, bvx_context *ctx, int32_t most, bvx_grid *grid)
{
    static const double origin[3] = {-1.0, 0.5, 3.0};
    double spacing[3];
    int32_t dims[3];
    bvx_lattice lattice;
    bvx_window window;
    int const cubic = fuzz_range(in, 0, 1), kind = fuzz_range(in, 0, 3);
    uint64_t state = fuzz_byte(in) * 2 + 1;

    for (int a = 0; a < 3; a++) {
        spacing[a] = a > 0 && cubic ? spacing[0] : fuzz_range(in, 1, 12) / 8.0;
        dims[a] = fuzz_range(in, 1, a == 0 ? 8 * most : most);
    }
    fuzz_must(ctx, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    window = fuzz_take_window(in, &lattice);
    fuzz_must(ctx, bvx_grid_create(ctx, &lattice, &window, grid));
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++) {
                state ^= state << 13, state ^= state >> 7, state ^= state << 17;
                /* few, half, nearly all; or few that turn whole rows' parts */
                bvx_grid_set(grid, x, y, z,
                             kind == 0   ? (state >> 30 & 31) == 0
                             : kind == 1 ? (int)(state >> 30 & 1)
                             : kind == 2 ? (state >> 30 & 31) != 0
                                         : 0);
            }
    for (int n = fuzz_range(in, 0, 4); n > 0; n--) {
        int32_t low[3], high[3];
        int const value = fuzz_range(in, 0, 3) != 0;
        for (int a = 0; a < 3; a++) {
            low[a] = fuzz_range(in, 0, grid->size[a] - 1);
            high[a] = fuzz_range(in, low[a] + 1, grid->size[a]);
        }
        for (int32_t z = low[2]; z < high[2]; z++)
            for (int32_t y = low[1]; y < high[1]; y++)
                for (int32_t x = low[0]; x < high[0]; x++) bvx_grid_set(grid, x, y, z, value);
    }
}

static void fuzz_take_morph(fuzz_input *in, bvx_morph_options *o)
{
    static const int32_t neighbourhood[4] = {BVX_BALL, 6, 18, 26};
    *o = (bvx_morph_options){.struct_size = sizeof *o};
    o->neighbourhood = neighbourhood[fuzz_range(in, 0, 3)];
    o->beyond = fuzz_range(in, 0, 1);
    if (o->neighbourhood == BVX_BALL) o->radius = fuzz_range(in, 0, 40) / 8.0;
    else o->steps = fuzz_range(in, 1, 6);
}

/* ---- Morphology ---- */

static void fuzz_identities(bvx_context *ctx, bvx_context *other, const bvx_grid *grid,
                            const bvx_morph_options *o)
{
    bvx_grid made[4] = {{0}, {0}, {0}, {0}}, twin = {0}, rest = {0}, grown = {0}, again = {0};
    bvx_morph_options across = *o;

    for (int i = 0; i < 4; i++) {
        fuzz_must(ctx, bvx_grid_morph(ctx, grid, i, o, &made[i]));
        fuzz_must(other, bvx_grid_morph(other, grid, i, o, &twin));
        fuzz_grids_equal(&made[i], &twin, "other voxels with more threads");
        bvx_grid_free(other, &twin);
    }
    fuzz_good_calls += 4;
    fuzz_within(&made[1], &made[2], "eroded voxels that open took");
    fuzz_within(&made[2], grid, "open gave voxels");
    fuzz_within(grid, &made[3], "close took voxels");
    fuzz_within(&made[3], &made[0], "closed voxels that dilate did not give");
    across.beyond = !o->beyond;
    fuzz_must(ctx, bvx_grid_complement(ctx, grid, &rest));
    for (int i = 0; i < 4; i += 2) { /* erode and close of the set are dilate and open of the rest */
        fuzz_must(ctx, bvx_grid_morph(ctx, &rest, i, &across, &grown));
        fuzz_must(ctx, bvx_grid_complement(ctx, &grown, &grown));
        fuzz_grids_equal(&grown, &made[i == 0 ? 1 : 3], "shrinking is not growing the rest");
        bvx_grid_free(ctx, &grown);
    }
    for (int i = 2; i < 4; i++) {
        fuzz_must(ctx, bvx_grid_morph(ctx, &made[i], i, o, &again));
        fuzz_grids_equal(&again, &made[i], "opened or closed twice is not once");
        bvx_grid_free(ctx, &again);
    }
    for (int i = 0; i < 4; i++) bvx_grid_free(ctx, &made[i]);
    bvx_grid_free(ctx, &rest);
}

static int32_t fuzz_lower(int32_t a, int32_t b)
{
    return a < b ? a : b;
}

/* A window of the grid's own, with a halo of what the call reaches. */
static void fuzz_morph_window(bvx_context *ctx, fuzz_input *in, const bvx_grid *grid,
                              const bvx_morph_options *o)
{
    int const call = fuzz_range(in, 0, 3);
    bvx_window inner, outer;
    bvx_grid whole = {0}, part = {0}, made = {0}, cut = {0};

    for (int a = 0; a < 3; a++) {
        int32_t const once = o->neighbourhood != BVX_BALL
                                 ? o->steps
                                 : (int32_t)ceil(o->radius / grid->lattice.spacing[a]);
        int32_t const halo = call < 2 ? once : 2 * once;
        int32_t const at = fuzz_range(in, 0, grid->size[a] - 1);
        int32_t const size = fuzz_range(in, 1, grid->size[a] - at);
        int32_t const low = at - fuzz_lower(at, halo), high = fuzz_lower(grid->size[a], at + size + halo);
        inner.low[a] = grid->low[a] + at;
        inner.size[a] = size;
        outer.low[a] = grid->low[a] + low;
        outer.size[a] = high - low;
    }
    fuzz_must(ctx, bvx_grid_morph(ctx, grid, call, o, &whole));
    fuzz_must(ctx, bvx_grid_crop(ctx, grid, &outer, &part));
    fuzz_must(ctx, bvx_grid_morph(ctx, &part, call, o, &made));
    fuzz_must(ctx, bvx_grid_crop(ctx, &made, &inner, &cut));
    fuzz_part_equals_whole(&cut, &whole, "a window with its halo that differs from the whole");
    bvx_grid_free(ctx, &whole);
    bvx_grid_free(ctx, &part);
    bvx_grid_free(ctx, &made);
    bvx_grid_free(ctx, &cut);
}

/* ---- Distances of a small grid by all pairs ---- */

/* The least square of a distance from voxel at to one of value wanted (0,
 * 1) and where that is; HUGE_VAL where there is none. */
static double fuzz_pairs(const bvx_grid *grid, const int32_t at[3], int wanted, int32_t beyond,
                         uint64_t *nearest)
{
    const double *const s = grid->lattice.spacing;
    double least = HUGE_VAL;
    uint64_t index = 0;

    *nearest = UINT64_MAX;
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++, index++) {
                double const dx = (x - at[0]) * s[0];
                double const dy = (y - at[1]) * s[1];
                double const dz = (z - at[2]) * s[2];
                double const d = dx * dx + dy * dy + dz * dz;
                if (d >= least || bvx_grid_get(grid, x, y, z) != wanted) continue;
                least = d;
                *nearest = index;
            }
    if (beyond != (wanted ? BVX_BEYOND_SET : BVX_BEYOND_EMPTY)) return least;
    for (int a = 0; a < 3; a++) {
        double const low = (at[a] + 1) * s[a];
        double const high = (grid->size[a] - at[a]) * s[a];
        double const side = low < high ? low : high;
        if (side * side >= least) continue;
        least = side * side;
        *nearest = UINT64_MAX;
    }
    return least;
}

/* Voxels beyond the window that are as near as the nearest one inside leave open which is reported. */
static int fuzz_beyond_as_near(const bvx_grid *grid, const int32_t at[3], int wanted, int32_t beyond,
                               double square)
{
    if (beyond != (wanted ? BVX_BEYOND_SET : BVX_BEYOND_EMPTY)) return 0;
    for (int a = 0; a < 3; a++) {
        double const low = (at[a] + 1) * grid->lattice.spacing[a];
        double const high = (grid->size[a] - at[a]) * grid->lattice.spacing[a];
        if (low * low == square || high * high == square) return 1;
    }
    return 0;
}

static void fuzz_distances(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_grid *grid)
{
    static double values[FUZZ_MORPH_MOST], twins[FUZZ_MORPH_MOST];
    static float floats[FUZZ_MORPH_MOST];
    static uint64_t nearest[FUZZ_MORPH_MOST];
    static uint32_t squares[FUZZ_MORPH_MOST];
    const double *const s = grid->lattice.spacing;
    int const cubic = s[0] == s[1] && s[0] == s[2];
    size_t const voxels = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];
    bvx_distance_options o = {.struct_size = sizeof o};

    o.side = fuzz_range(in, BVX_DISTANCE_OUTSIDE, BVX_DISTANCE_SIGNED);
    o.beyond = fuzz_range(in, BVX_BEYOND_NOTHING, BVX_BEYOND_SET);
    fuzz_must(other, bvx_grid_distance(other, grid, &o, BVX_F64, twins, voxels));
    o.nearest = nearest;
    fuzz_must(ctx, bvx_grid_distance(ctx, grid, &o, BVX_F32, floats, voxels));
    fuzz_must(ctx, bvx_grid_distance(ctx, grid, &o, BVX_F64, values, voxels));
    fuzz_require(memcmp(values, twins, voxels * sizeof *values) == 0, "other distances with more threads");
    if (cubic && o.side != BVX_DISTANCE_SIGNED)
        fuzz_must(ctx, bvx_grid_distance(ctx, grid, &o, BVX_SQUARES, squares, voxels));
    fuzz_good_calls += 2;
    for (size_t i = 0; i < voxels; i++) {
        int32_t const at[3] = {(int32_t)(i % (size_t)grid->size[0]),
                               (int32_t)(i / (size_t)grid->size[0] % (size_t)grid->size[1]),
                               (int32_t)(i / (size_t)grid->size[0] / (size_t)grid->size[1])};
        int const set = bvx_grid_get(grid, at[0], at[1], at[2]);
        int const wanted = o.side == BVX_DISTANCE_SIGNED ? !set : o.side == BVX_DISTANCE_OUTSIDE;
        uint64_t which;
        double const square = fuzz_pairs(grid, at, wanted, o.beyond, &which);
        double const distance = cubic ? s[0] * sqrt(square / (s[0] * s[0])) : sqrt(square);
        fuzz_require(values[i] == (o.side == BVX_DISTANCE_SIGNED && set ? -distance : distance),
                     "a distance that no pair has");
        fuzz_require(floats[i] == (float)values[i], "a float that is not the double rounded");
        fuzz_require(nearest[i] == which || fuzz_beyond_as_near(grid, at, wanted, o.beyond, square),
                     "a nearest voxel that is not the first of the nearest");
        if (cubic && o.side != BVX_DISTANCE_SIGNED)
            fuzz_require(square < HUGE_VAL ? (double)squares[i] == square / (s[0] * s[0])
                                           : squares[i] == UINT32_MAX,
                         "a square that no pair has");
    }
}

/* A ball holds the centres within its radius: those whose nearest set voxel is no farther. */
static void fuzz_ball(bvx_context *ctx, fuzz_input *in, const bvx_grid *grid)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    bvx_grid grown = {0};
    uint64_t which;

    o.neighbourhood = BVX_BALL;
    o.radius = fuzz_range(in, 0, 60) / 8.0;
    o.beyond = fuzz_range(in, 0, 1);
    fuzz_must(ctx, bvx_grid_morph(ctx, grid, BVX_MORPH_DILATE, &o, &grown));
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++) {
                int32_t const at[3] = {x, y, z};
                double const square = fuzz_pairs(grid, at, 1, o.beyond ? BVX_BEYOND_SET : BVX_BEYOND_EMPTY,
                                                 &which);
                fuzz_require(bvx_grid_get(&grown, x, y, z) == (square <= o.radius * o.radius),
                             "a ball that is not round");
            }
    bvx_grid_free(ctx, &grown);
}

/* The shell has the set voxels near an empty one; a hole takes more of it, and of the hollow nothing. */
static void fuzz_shell(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_grid *grid)
{
    bvx_hollow_options o = {.struct_size = sizeof o};
    bvx_hollow_report report;
    bvx_grid shell = {0}, drained = {0}, twin = {0};
    uint64_t which, hollowed;

    o.thickness = fuzz_range(in, 1, 24) / 8.0;
    o.beyond = fuzz_range(in, 0, 1);
    o.report = &report;
    for (int a = 0; a < 3; a++)
        if (o.thickness < grid->lattice.spacing[a]) { /* would leave no shell */
            fuzz_require(bvx_grid_hollow(ctx, grid, &o, &shell) == BVX_ERR_RANGE && shell.words == NULL,
                         "a hollow thinner than a voxel");
            return;
        }
    fuzz_must(ctx, bvx_grid_hollow(ctx, grid, &o, &shell));
    fuzz_good_calls++;
    hollowed = fuzz_set(ctx, grid) - fuzz_set(ctx, &shell);
    fuzz_require(report.hollowed == hollowed && report.drained == 0, "hollowed voxels that are not counted");
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++) {
                int32_t const at[3] = {x, y, z};
                double const square = fuzz_pairs(grid, at, 0, o.beyond ? BVX_BEYOND_SET : BVX_BEYOND_EMPTY,
                                                 &which);
                int const stays = bvx_grid_get(grid, x, y, z) && square <= o.thickness * o.thickness;
                fuzz_require(bvx_grid_get(&shell, x, y, z) == stays, "a shell of another thickness");
            }
    o.drain_radius = fuzz_range(in, 1, 16) / 8.0;
    o.drain_side = 1 << fuzz_range(in, 0, 5);
    fuzz_must(ctx, bvx_grid_hollow(ctx, grid, &o, &drained));
    fuzz_within(&drained, &shell, "a hole that gave voxels");
    fuzz_require(report.hollowed == hollowed &&
                     report.drained == fuzz_set(ctx, &shell) - fuzz_set(ctx, &drained),
                 "drained voxels that are not counted");
    fuzz_must(other, bvx_grid_hollow(other, grid, &o, &twin));
    fuzz_grids_equal(&drained, &twin, "another shell with more threads");
    bvx_grid_free(ctx, &shell);
    bvx_grid_free(ctx, &drained);
    bvx_grid_free(other, &twin);
}

static void fuzz_one(fuzz_input *in)
{
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_morph_options o;
    bvx_grid grid = {0};
    int const large = fuzz_range(in, 0, 1);

    fuzz_take_grid(in, ctx, large ? 20 : 9, &grid);
    fuzz_take_morph(in, &o);
    fuzz_identities(ctx, other, &grid, &o);
    fuzz_morph_window(ctx, in, &grid, &o);
    if ((int64_t)grid.size[0] * grid.size[1] * grid.size[2] <= FUZZ_MORPH_MOST) {
        fuzz_distances(ctx, other, in, &grid);
        fuzz_ball(ctx, in, &grid);
        fuzz_shell(ctx, other, in, &grid);
    }
    bvx_grid_free(ctx, &grid);
    fuzz_end(ctx);
    fuzz_end(other);
}
