/* oblique_smooth.c - a smooth number through the planes' signed distances, as a thin plate has it.
 *
 * Source: Duchon. Splines minimizing rotation-invariant semi-norms in Sobolev spaces. 1977 (the thin plate);
 * Hestenes, Stiefel. Methods of conjugate gradients for solving linear systems. 1952; Keys. Cubic convolution
 * interpolation for digital image processing. 1981 (between the nodes).
 *
 * A coarse grid of nodes covers the lattice, or the surroundings of one of several bodies. Where one of its
 * lines crosses a plane, the cubic through four nodes of the line is tied to the plane's distance there;
 * between planes the sum of all squared second differences is a minimum. Ties weaken where a plane says that its contours are far: what a distance is
 * there depends on the plane, and only the surface matters. The system is solved on grids of a quarter and of
 * half the nodes along each side first, each the start of the next.
 *
 * Distances of planes that cross need not agree with each other, so ties are springs; what they leave on
 * each plane is spread by weights (oblique_field.c). Slices are computed apart from each other and sums
 * are added in one order: the same bits for any number of threads. */
#include "oblique/oblique.h"

enum {
    SMOOTH_NODES = 32, /* along the contours' longest side */
    SMOOTH_ROW = 64,   /* more than a row of nodes has: 1.25 times those, and 15 */
    SMOOTH_ROUNDS = 60,
    SMOOTH_SMALL = 1 << 14, /* nodes */
    TIE_REPORT = 8,         /* planes between two reports */
    SMOOTH_BANDS = 10       /* of the ties' matrix: the diagonal, and along each axis one to three nodes on */
};

#define SMOOTH_TIE    30.0 /* a tie's strength on the contour; a node's own in the plate's matrix is 42 */
#define SMOOTH_ENOUGH 1e-9 /* of the first residual, squared */

typedef struct smooth_work {
    bvxi_oblique *o;
    bvxi_smooth grid;
    int64_t step[3]; /* from a node to the next along each axis */
    uint64_t nodes, padding;
    double *residual, *image, *scale; /* [nodes]; scale: 1 / diagonal */
    double *way;                      /* [padding + nodes + padding], 0 beyond the nodes */
    float *band;                      /* [SMOOTH_BANDS][padding + nodes] */
    double plate[3][SMOOTH_ROW][5];   /* a row of the matrix of second differences along an axis */
    double slope[3][SMOOTH_ROW][3];   /* and of that of first ones */
} smooth_work;

/* ---- between the nodes ---- */

static void keys_shares(double t, double share[4])
{
    double const s = 1.0 - t;
    /* Shares sum to 1 and are symmetric in t and s, so that the number goes smoothly from cell to cell. */
    share[0] = -0.5 * t * s * s;
    share[1] = s * (1.0 + t - 1.5 * t * t);
    share[2] = t * (1.0 + s - 1.5 * s * s);
    share[3] = -0.5 * s * t * t;
}

double bvxi_smooth_at(const bvxi_smooth *g, const double at[3])
{
    double share[3][4], sum = 0.0;
    int64_t const row = g->size[0], slice = row * g->size[1];
    const double *node = g->node;

    for (int k = 0; k < 3; k++) {
        /* Node 1 stands at the box's corner: one node lies before it, for the cubic's four. */
        double const x = (at[k] - g->low[k]) * g->scale + 1.0;
        int32_t i = x > 1.0 ? (int32_t)x : 1;

        /* Places on the border take the last cell that has a node beyond it. */
        if (i > g->size[k] - 3) i = g->size[k] - 3;
        keys_shares(x - i, share[k]);
        node += (i - 1) * (k == 0 ? 1 : k == 1 ? row : slice);
    }

    /* Sums by rows, then by slices, always in this order: the same bits everywhere. */
    for (int z = 0; z < 4; z++, node += slice) {
        double flat = 0.0;
        for (int y = 0; y < 4; y++) {
            const double *const n = node + y * row;
            flat += share[1][y] *
                    ((share[0][0] * n[0] + share[0][1] * n[1]) + (share[0][2] * n[2] + share[0][3] * n[3]));
        }
        sum += share[2][z] * flat;
    }
    return sum;
}

/* ---- ties ---- */

/* A spring on the line through a place of the grid, to a value. */
static void add_tie(const smooth_work *w, const double at[3], int axis, double value, double strength)
{
    uint64_t const room = w->padding + w->nodes;
    int64_t const step = w->step[axis];
    int64_t first = -step;
    double share[4];

    /* On a line of the grid only the four nodes along it have a share. */
    keys_shares(at[axis] - (int32_t)at[axis], share);
    for (int k = 0; k < 3; k++) first += (int32_t)at[k] * w->step[k];
    /* The spring's square adds to each pair of these nodes; of symmetric pairs one half is kept. */
    for (int a = 0; a < 4; a++) {
        int64_t const node = first + a * step;
        w->residual[node] += strength * share[a] * value;
        for (int b = a; b < 4; b++) {
            uint64_t const band = b == a ? 0 : (uint64_t)(3 * axis + b - a);
            w->band[band * room + w->padding + (uint64_t)node] += (float)(strength * share[a] * share[b]);
        }
    }
}

/* Where a plane crosses the grid's lines along an axis. */
static void tie_plane(const smooth_work *w, uint32_t plane, int axis)
{
    const bvxi_smooth *const g = &w->grid;
    const bvxi_oblique_plane *const p = &w->o->plane[plane];
    int const b = (axis + 1) % 3, c = (axis + 2) % 3;

    /* A plane along the axis crosses its lines nowhere, or too far off; the other axes tie it. */
    if (bvxi_absolute(p->normal[axis]) < 1e-6) return;
    for (int32_t j = 1; j < g->size[c] - 1; j++)
        for (int32_t i = 1; i < g->size[b] - 1; i++) {
            double node[3], at[3], uv[2], value, off;
            uint32_t hint = 0;

            at[b] = (i - 1) / g->scale + g->low[b];
            at[c] = (j - 1) / g->scale + g->low[c];
            at[axis] = (p->offset - (p->normal[b] * at[b] + p->normal[c] * at[c])) / p->normal[axis];
            node[axis] = (at[axis] - g->low[axis]) * g->scale + 1.0;
            /* Beyond the nodes that have two neighbours on either side the cubic is not defined. */
            if (!(node[axis] >= 1.0 && node[axis] < g->size[axis] - 2)) continue;
            node[b] = i;
            node[c] = j;
            /* Measured, not taken from the raster, whose straight lines over two cells would pull a round body
             * inwards. Near a contour it is what the body is; far from it, only a hint: the fourth power lets
             * it fade. */
            bvxi_oblique_uv(p, at, uv);
            value = p->raster == NULL ? -0.25 * w->o->longest : bvxi_oblique_curved(w->o, plane, uv, &hint);
            off = value * g->scale;
            off *= off;
            add_tie(w, node, axis, value, SMOOTH_TIE / (1.0 + off * off));
        }
}

/* out += factor * x, whole rows; rows beyond the grid have the factor 0. */
static void add_row(double *out, const double *x, double factor, int32_t n)
{
    if (factor == 0.0) return;
    for (int32_t i = 0; i < n; i++) out[i] += factor * x[i];
}

/* The plate's matrix: second differences along each axis, and twice the mixed ones of each two. Two of them
 * act along rows, on the row itself and on what first differences across leave. */
static void bend_row(const smooth_work *w, int32_t j, int32_t k, const double *x, double *out)
{
    double own[SMOOTH_ROW + 4], across[SMOOTH_ROW + 2];
    int32_t const n = w->grid.size[0];
    const double *const plate_y = w->plate[1][j], *const plate_z = w->plate[2][k];
    const double *const slope_y = w->slope[1][j], *const slope_z = w->slope[2][k];

    memset(own, 0, sizeof own);
    memset(across, 0, sizeof across);
    memset(out, 0, (size_t)n * 8);
    memcpy(own + 2, x, (size_t)n * 8);

    /* Across the rows each difference is a multiple of a whole row, which the compiler turns into vectors. */
    for (int d = -2; d <= 2; d++) {
        add_row(out, x + d * w->step[1], plate_y[d + 2], n);
        add_row(out, x + d * w->step[2], plate_z[d + 2], n);
    }

    for (int d = -1; d <= 1; d++) {
        add_row(across + 1, x + d * w->step[1], slope_y[d + 1], n);
        add_row(across + 1, x + d * w->step[2], slope_z[d + 1], n);
        for (int e = -1; e <= 1; e++)
            add_row(out, x + d * w->step[1] + e * w->step[2], 2.0 * slope_y[d + 1] * slope_z[e + 1], n);
    }

    /* Brackets fix the order of the sums, which compilers must not choose. */
    for (int32_t i = 0; i < n; i++) {
        const double *const a = w->plate[0][i], *const b = w->slope[0][i];
        double const bent = ((a[0] * own[i] + a[1] * own[i + 1]) + (a[3] * own[i + 3] + a[4] * own[i + 4])) +
                            a[2] * own[i + 2];
        double const mixed = (b[0] * across[i] + b[2] * across[i + 2]) + b[1] * across[i + 1];
        out[i] += bent + 2.0 * mixed;
    }
}

static void image_slice(void *user, int32_t index)
{
    const smooth_work *const w = user;
    for (int32_t j = 0; j < w->grid.size[1]; j++) {
        int64_t const first = j * w->step[1] + index * w->step[2];
        const double *const x = w->way + w->padding + first;
        bend_row(w, j, index, x, w->image + first);

        /* The ties' matrix; its bands are 0 wherever they would lead out of the grid. */
        double *const out = w->image + first;
        uint64_t const room = w->padding + w->nodes;
        const float *band = w->band + w->padding + first;
        int32_t const n = w->grid.size[0];
        for (int32_t i = 0; i < n; i++) out[i] += (double)band[i] * x[i];
        for (int axis = 0; axis < 3; axis++)
            /* A band pairs a node with the one d on; the pair with the one d before stands there. */
            for (int d = 1; d <= 3; d++) {
                int64_t const s = d * w->step[axis];
                band += room;
                for (int32_t i = 0; i < n; i++)
                    out[i] += (double)band[i] * x[i + s] + (double)band[i - s] * x[i - s];
            }
    }
}

/* image = matrix * way. What takes less than a helper needs to wake is done here, with one report. */
static bvx_status make_image(smooth_work *w)
{
    if (w->nodes <= SMOOTH_SMALL) {
        for (int32_t k = 0; k < w->grid.size[2]; k++) image_slice(w, k);
        return bvxi_progress(w->o->ctx, "field", 1.0);
    }
    return bvxi_each(w->o->ctx, "field", 0.0, 1.0, w->grid.size[2], image_slice, w);
}

/* ---- conjugate gradients ---- */

/* residual -= share * image; what is left of it, squared by the scale */
static double lessen_residual(const smooth_work *w, double share)
{
    double sum = 0.0;
    for (uint64_t i = 0; i < w->nodes; i++) {
        double const r = w->residual[i] - share * w->image[i];
        w->residual[i] = r;
        sum += r * r * w->scale[i];
    }
    return sum;
}

/* From the nodes as they are; the residual has the ties' values. */
static bvx_status solve_plate(smooth_work *w)
{
    double *const way = w->way + w->padding;
    double left, first;

    /* The nodes may come from a coarser level, so the first residual is not just that of the ties. */
    const float *const diagonal = w->band + w->padding;
    for (int32_t k = 0, n = 0; k < w->grid.size[2]; k++)
        for (int32_t j = 0; j < w->grid.size[1]; j++)
            for (int32_t i = 0; i < w->grid.size[0]; i++, n++) {
                double const a = w->slope[0][i][1], b = w->slope[1][j][1], c = w->slope[2][k][1];
                double const plate = (w->plate[0][i][2] + w->plate[1][j][2]) + w->plate[2][k][2];
                w->scale[n] = 1.0 / ((plate + 2.0 * ((a * b + a * c) + b * c)) + (double)diagonal[n]);
            }

    memcpy(way, w->grid.node, (size_t)w->nodes * 8);
    BVXI_TRY(BVXI_SHARE(w->o->ctx, 0.0, 0.01, make_image(w)));
    first = left = lessen_residual(w, 1.0);
    for (uint64_t i = 0; i < w->nodes; i++) way[i] = w->residual[i] * w->scale[i];
    for (int round = 0; round < SMOOTH_ROUNDS && left > SMOOTH_ENOUGH * first; round++) {
        double const done = (double)round / SMOOTH_ROUNDS;
        double curvature = 0.0, share, turn, before = left;

        BVXI_TRY(BVXI_SHARE(w->o->ctx, done, done + 1.0 / SMOOTH_ROUNDS, make_image(w)));
        for (uint64_t i = 0; i < w->nodes; i++) curvature += way[i] * w->image[i];
        /* Only where rounding is all that is left: the matrix is positive. */
        if (!(curvature > 0.0)) break;
        share = left / curvature;
        left = lessen_residual(w, share);
        /* The new way is conjugate to all before it, by the recurrence of conjugate gradients. */
        turn = left / before;
        for (uint64_t i = 0; i < w->nodes; i++) {
            w->grid.node[i] += share * way[i];
            way[i] = w->residual[i] * w->scale[i] + turn * way[i];
        }
    }
    return BVX_OK;
}

/* ---- levels ---- */

static bvx_status solve_smooth_level(smooth_work *w, const bvxi_smooth *coarser)
{
    static const char what[] = "the nodes of the smooth number";
    uint64_t const bands = SMOOTH_BANDS * (w->nodes + w->padding);
    bvx_context *const ctx = w->o->ctx;

    /* The bands are floats: they are most of the memory, and ties need no more digits than that. */
    BVXI_TRY(BVXI_ZEROS(ctx, w->nodes, what, w->residual));
    BVXI_TRY(BVXI_ARRAY(ctx, w->nodes, what, w->image));
    BVXI_TRY(BVXI_ARRAY(ctx, w->nodes, what, w->scale));
    BVXI_TRY(BVXI_ZEROS(ctx, w->nodes + 2 * w->padding, what, w->way));
    BVXI_TRY(BVXI_ZEROS(ctx, bands, what, w->band));

    if (coarser->node != NULL) {
        uint64_t n = 0;
        for (int32_t k = 0; k < w->grid.size[2]; k++)
            for (int32_t j = 0; j < w->grid.size[1]; j++)
                for (int32_t i = 0; i < w->grid.size[0]; i++) {
                    double const at[3] = {(i - 1) / w->grid.scale + w->grid.low[0],
                                          (j - 1) / w->grid.scale + w->grid.low[1],
                                          (k - 1) / w->grid.scale + w->grid.low[2]};
                    w->grid.node[n++] = bvxi_smooth_at(coarser, at);
                }
    }
    for (int axis = 0; axis < 3; axis++) {
        /* Rows of the transposed differences times the differences, along an axis with `size` nodes. */
        int const size = w->grid.size[axis];
        memset(w->plate[axis], 0, sizeof w->plate[axis]);
        memset(w->slope[axis], 0, sizeof w->slope[axis]);
        /* A difference is taken where all of its nodes exist: the plate's border is free, bent by nothing. */
        for (int c = 1; c + 1 < size; c++)
            for (int a = -1; a <= 1; a++)
                for (int b = -1; b <= 1; b++)
                    w->plate[axis][c + a][2 + b - a] += (a == 0 ? -2.0 : 1.0) * (b == 0 ? -2.0 : 1.0);
        for (int c = 0; c + 1 < size; c++)
            for (int a = 0; a <= 1; a++)
                for (int b = 0; b <= 1; b++) w->slope[axis][c + a][1 + b - a] += a == b ? 1.0 : -1.0;
        for (uint32_t p = 0; p < w->o->plane_count; p++) {
            /* Each plane is measured a thousand times, and there may be as many planes. */
            if (p % TIE_REPORT == 0) BVXI_TRY(bvxi_progress(ctx, "field", 0.0));
            tie_plane(w, p, axis);
        }
    }
    return solve_plate(w);
}

/* The level's nodes stay; what it was solved with goes. */
static bvx_status make_smooth_level(bvxi_oblique *o, double spacing)
{
    bvxi_smooth coarser = o->smooth;
    smooth_work w = {.o = o};
    w.grid.scale = 1.0 / spacing;
    w.nodes = 1;
    for (int k = 0; k < 3; k++) {
        w.grid.low[k] = w.o->near_low[k];
        w.grid.size[k] = (int32_t)((w.o->near_high[k] - w.o->near_low[k] - 1.0) / spacing) + 4;
        w.step[k] = (int64_t)w.nodes;
        w.nodes *= (uint64_t)w.grid.size[k];
    }
    /* Ties reach three nodes on: rows and slices beyond the ends read zeros. */
    w.padding = 3 * (uint64_t)w.step[2];

    BVXI_TRY(BVXI_ZEROS(o->ctx, w.nodes, "the nodes of the smooth number", w.grid.node));
    o->smooth = w.grid;
    return BVXI_SCOPE(o->ctx, solve_smooth_level(&w, &coarser));
}

bvx_status bvxi_oblique_smooth(bvxi_oblique *o)
{
    double const spacing = o->longest > SMOOTH_NODES ? o->longest / SMOOTH_NODES : 1.0;
    /* Each level has eight times the nodes of the one before it; the shares of progress follow that. */
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.05, make_smooth_level(o, 4.0 * spacing)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.05, 0.2, make_smooth_level(o, 2.0 * spacing)));
    return BVXI_SHARE(o->ctx, 0.2, 1.0, make_smooth_level(o, spacing));
}
