/* hollow.c - a shell of a body, with a hole to let out what is in it.
 *
 * The hollow is the body eroded by a ball of the shell's thickness (morph_ball.c); it is taken away from the
 * body. The drain hole is a cylinder along an axis, from its side of the window to where its axis first meets
 * the hollow, counted in centres. */
#include "morphology/morph.h"

#include <math.h>

#define HOLLOW_SPARE (1.0 + 0x1p-39)

typedef struct drain_hole {
    int32_t axis, high; /* high: it comes from the axis's high side */
    int32_t across[2];  /* the other axes */
    double at[2];       /* of its axis along them [Units: world] */
    int32_t voxel[3];   /* of the hollow, where the axis meets it */
} drain_hole;

static double centre_along(const bvx_grid *grid, int32_t axis, int32_t i)
{
    return grid->lattice.origin[axis] +
           ((double)grid->low[axis] + (double)i + 0.5) * grid->lattice.spacing[axis];
}

/* The layer of the hollow nearest to the side: its number, voxels, and the sums of their indices. */
static int32_t nearest_layer(const bvx_grid *hollow, const drain_hole *hole, uint64_t *count, uint64_t sum[2])
{
    int32_t best = -1;
    int32_t v[3];

    *count = sum[0] = sum[1] = 0;

    /* All set voxels once; a layer nearer to the side begins the sums anew. */
    for (v[2] = 0; v[2] < hollow->size[2]; v[2]++)
        for (v[1] = 0; v[1] < hollow->size[1]; v[1]++) {
            const uint64_t *const row = bvxi_grid_row(hollow, v[1], v[2]);
            for (int32_t k = 0; k < hollow->words_per_row; k++)
                for (uint64_t w = row[k]; w != 0; w &= w - 1) {
                    v[0] = k * BVXI_WORD_BITS + bvxi_lowest(w);
                    int32_t const layer = v[hole->axis];
                    if (best < 0 || (hole->high ? layer > best : layer < best)) {
                        best = layer;
                        *count = sum[0] = sum[1] = 0;
                    }
                    if (layer != best) continue;
                    ++*count;
                    for (int i = 0; i < 2; i++) sum[i] += (uint64_t)v[hole->across[i]];
                }
        }
    return best;
}

/* The layer's voxel that is nearest to its middle, the first one of equal ones. */
static void place_hole(const bvx_grid *hollow, drain_hole *hole, int32_t layer, uint64_t count,
                       const uint64_t sum[2])
{
    const double *const s = hollow->lattice.spacing;
    double const middle[2] = {(double)sum[0] / (double)count, (double)sum[1] / (double)count};
    double best = (double)INFINITY;
    int32_t v[3];

    /* Only voxels of that layer: its middle may lie in none of them. */
    v[hole->axis] = layer;
    for (int32_t b = 0; b < hollow->size[hole->across[1]]; b++)
        for (int32_t a = 0; a < hollow->size[hole->across[0]]; a++) {
            double const da = ((double)a - middle[0]) * s[hole->across[0]];
            double const db = ((double)b - middle[1]) * s[hole->across[1]];
            v[hole->across[0]] = a;
            v[hole->across[1]] = b;
            if (da * da + db * db >= best || !bvx_grid_get(hollow, v[0], v[1], v[2])) continue;
            best = da * da + db * db;
            memcpy(hole->voxel, v, sizeof v);
        }
    for (int i = 0; i < 2; i++)
        hole->at[i] = centre_along(hollow, hole->across[i], hole->voxel[hole->across[i]]);
}

/* The first voxel of the hollow that a given axis meets. */
static bvx_status meet_hollow(bvx_context *ctx, const char *function, const bvx_grid *hollow,
                              drain_hole *hole)
{
    int32_t const n = hollow->size[hole->axis];
    int32_t v[3];

    for (int i = 0; i < 2; i++) {
        int32_t const a = hole->across[i];
        double const p = floor((hole->at[i] - hollow->lattice.origin[a]) / hollow->lattice.spacing[a]) -
                         (double)hollow->low[a];
        if (!(p >= 0.0 && p < (double)hollow->size[a]))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                                 "%s: the drain hole at %g, %g is outside the window", function, hole->at[0],
                                 hole->at[1]);
        v[a] = (int32_t)p;
    }
    for (int32_t i = 0; i < n; i++) {
        v[hole->axis] = hole->high ? n - 1 - i : i;
        if (!bvx_grid_get(hollow, v[0], v[1], v[2])) continue;
        memcpy(hole->voxel, v, sizeof v);
        return BVX_OK;
    }
    return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the axis of the drain hole at %g, %g meets no hollow",
                     function, hole->at[0], hole->at[1]);
}

/* Empty the set voxels of shell whose centres lie in the hole; returns how many. */
static uint64_t drill(const drain_hole *hole, double radius, bvx_grid *shell)
{
    int32_t const depth = hole->voxel[hole->axis], n = shell->size[hole->axis];
    int32_t const begin = hole->high ? depth + 1 : 0, end = hole->high ? n : depth;
    double const most = radius * radius * HOLLOW_SPARE;
    uint64_t drained = 0;
    int32_t v[3];

    for (int32_t b = 0; b < shell->size[hole->across[1]]; b++) {
        double const db = centre_along(shell, hole->across[1], b) - hole->at[1];
        /* A row farther from the axis than the radius needs no look at its voxels. */
        if (db * db > most) continue;
        for (int32_t a = 0; a < shell->size[hole->across[0]]; a++) {
            double const da = centre_along(shell, hole->across[0], a) - hole->at[0];
            if (da * da + db * db > most) continue;
            v[hole->across[0]] = a;
            v[hole->across[1]] = b;
            for (int32_t i = begin; i < end; i++) {
                v[hole->axis] = i;
                if (!bvx_grid_get(shell, v[0], v[1], v[2])) continue;
                bvx_grid_set(shell, v[0], v[1], v[2], 0);
                drained++;
            }
        }
    }
    return drained;
}

static bvx_status make_hole(bvx_context *ctx, const char *function, const bvx_hollow_options *o,
                            const bvx_grid *hollow, bvx_grid *shell, bvx_hollow_report *report)
{
    drain_hole hole = {0};
    uint64_t count, sum[2];
    int32_t side = 0, layer;

    /* The side is one bit of six, two for each axis: low and high. */
    while (o->drain_side >> side != 1) side++;
    hole.axis = side / 2;
    hole.high = side % 2;
    hole.across[0] = hole.axis == 0 ? 1 : 0;
    hole.across[1] = hole.axis == 2 ? 1 : 2;
    memcpy(hole.at, o->drain_at, sizeof hole.at);
    layer = nearest_layer(hollow, &hole, &count, sum);
    if (layer < 0) return BVX_OK;
    if (o->drain_placed) BVXI_TRY(meet_hollow(ctx, function, hollow, &hole));
    else place_hole(hollow, &hole, layer, count, sum);
    report->drained = drill(&hole, o->drain_radius, shell);
    for (int32_t a = 0; a < 3; a++) report->drain[a] = centre_along(hollow, a, hole.voxel[a]);
    return BVX_OK;
}

static const bvxi_option hollow_rows[] = {
    BVXI_ABOVE(bvx_hollow_options, thickness, 0.0, BVXI_FINITE),
    BVXI_REAL(bvx_hollow_options, drain_radius, 0.0, BVXI_FINITE),
    BVXI_OR(bvx_hollow_options, drain_side, CHOICE, BVX_OPEN_Z_LOW, BVX_OPEN_X_LOW, BVX_OPEN_Z_HIGH),
    BVXI_SWITCH(bvx_hollow_options, drain_placed),
    BVXI_SWITCH(bvx_hollow_options, beyond),
    BVXI_RESERVED(bvx_hollow_options, reserved),
};

/* *shell becomes the grid without its hollow and hole. */
static bvx_status make_shell(bvx_context *ctx, const char *function, const bvx_grid *grid,
                             const bvx_hollow_options *o, bvx_grid *shell, bvx_hollow_report *report)
{
    bvxi_morph morph = {"hollow", {BVXI_ERODE, BVXI_ERODE}, 1, 0, 0, 0, {0, 0, 0}, 0};
    uint64_t const words = bvxi_grid_words(grid);
    bvx_grid hollow = *shell;

    BVXI_TRY(BVXI_ARRAY(ctx, words, "the hollow", hollow.words));
    BVXI_TRY(bvxi_ball_set(ctx, function, &grid->lattice, o->thickness, &morph));
    morph.beyond = o->beyond;
    BVXI_TRY(bvxi_morph_run(ctx, &morph, grid, &hollow));
    /* The hollow lies in the body, so no voxel beyond is touched. */
    for (uint64_t i = 0; i < words; i++) {
        shell->words[i] = grid->words[i] & ~hollow.words[i];
        report->hollowed += bvxi_popcount(hollow.words[i]);
    }
    return o->drain_radius > 0.0 ? make_hole(ctx, function, o, &hollow, shell, report) : BVX_OK;
}

static bvx_status run_grid_hollow(bvx_context *context, const bvx_grid *grid,
                                  const bvx_hollow_options *options, bvx_grid *result)
{
    static const char *const function = "bvx_grid_hollow";
    bvx_hollow_options o;
    bvx_hollow_report report = {0};
    bvx_window window;

    BVXI_TRY(bvxi_grid_apart(context, function, grid, result));
    BVXI_TRY(bvxi_take_options(context, function, options, &o, sizeof o));

    BVXI_TRY(bvxi_check_options(context, function, &o, BVXI_OPTIONS(hollow_rows)));
    if ((o.drain_side & (o.drain_side - 1)) != 0)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: drain_side %d is more than one side", function, (int64_t)o.drain_side);

    /* All is checked before the result's memory is touched. */
    /* A face voxel's nearest empty centre is a spacing away: with less the shell would be open. A hair less is
     * taken, as a thickness computed from the spacing may be rounded. */
    for (int a = 0; a < 3; a++)
        if (o.thickness < grid->lattice.spacing[a] * (1.0 - 1.0 / 1099511627776.0))
            return bvxi_fail_for(
                context, BVX_ERR_RANGE, BVX_REASON_RANGE,
                "%s: thickness %g is less than a voxel, %g along %s: take a finer lattice or a thicker shell",
                function, o.thickness, grid->lattice.spacing[a],
                a == 0   ? "x"
                : a == 1 ? "y"
                         : "z");
    memcpy(window.low, grid->low, sizeof window.low);
    memcpy(window.size, grid->size, sizeof window.size);
    bvxi_grid_renew(context, &grid->lattice, &window, result);
    bvx_grid made = *result;
    BVXI_TRY(bvxi_grid_open(context, function, &grid->lattice, &window, &made));
    BVXI_TRY(bvxi_grid_put(context, make_shell(context, function, grid, &o, &made, &report), &made, result));
    if (o.report != NULL) *o.report = report;
    return BVX_OK;
}

bvx_status bvx_grid_hollow(bvx_context *context, const bvx_grid *grid, const bvx_hollow_options *options,
                           bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_hollow(context, grid, options, result));
}
