/* mass.c - volume, centre of mass and inertia of the body that a mesh encloses: bvx_measure.
 *
 * BVX_FILL_AUTO decides what is inside, and shows how far triangles can be trusted. A closed shell that crosses
 * nothing and faces one way, as given or once flipped triangles have been turned, is summed over: each triangle
 * and the bounds' centre are a tetrahedron, whose moments are polynomials of its corners. Of all others voxels
 * are counted, and their places summed in integers; sums that these bear out are taken within their bounds.
 *
 * Guarantee: sums are compensated, in pieces of the mesh's shape only, and bounded by their rounding. A voxel
 * that no triangle touches, and whose neighbors are as it is, lies on one side as a whole, but for corners that a
 * lid over a hole cuts off: all others bound what is counted.
 * Source: Mirtich. Fast and Accurate Computation of Polyhedral Mass Properties. 1996 (what is integrated). */
#include "mesh/facet.h"
#include "fill/fills.h"
#include "touch/surface_voxels.h"

#include <math.h>

static const char mass_name[] = "bvx_measure";

enum { MASS_GRAIN = 4096 };

#define MEASURE_ROUNDING 0x1p-46 /* of all products, in sums that are compensated */

/* Of what is summed: 1; x, y, z; xx, yy, zz, xy, xz, yz. */
enum { MOMENTS = 10 };
static const int32_t moment_axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};

typedef struct triangle_sums {
    double sum[MOMENTS], lost[MOMENTS]; /* compensated, about the centre of the bounds */
    double area, spread;                /* areas; products of two sides */
} triangle_sums;

typedef struct measure_work {
    bvx_solid_report solid; /* first: what fills by name finds the rest by it */
    bvx_measure_options options;
    double low[3], high[3];
    double scale, centre[3], radius; /* to a size of about 1, and of the bounds there */
    const bvx_mesh_view *view;       /* what is summed over */
    triangle_sums *pieces;
    int certain;                   /* what is summed is the body, but for rounding */
    int summed;                    /* the rest is known, of shells that are closed or have been closed */
    double moment[MOMENTS], error; /* the error is that of the volume */
} measure_work;

/* ---- Triangles ---- */

/* Neumaier: what rounding takes from a sum is kept beside it. */
static void add_compensated(double *sum, double *lost, double term)
{
    double const s = *sum + term;
    *lost += bvxi_absolute(*sum) >= bvxi_absolute(term) ? (*sum - s) + term : (term - s) + *sum;
    *sum = s;
}

static void sum_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const measure_work *const w = user;
    triangle_sums s = {{0}, {0}, 0, 0};

    for (uint64_t t = begin; t < end; t++) {
        double p[3][3], n[3], sum[3], six;

        /* The tetrahedron of a triangle and the centre: its moments are six times its volume times these
         * polynomials. */
        bvxi_view_scaled(w->view, t, w->scale, p);
        s.spread += sqrt(bvxi_vec_distance2(p[0], p[1])) * sqrt(bvxi_vec_distance2(p[0], p[2]));
        s.area += bvxi_facet_normal((const double(*)[3])p, n) * 0.5;
        for (int a = 0; a < 3; a++) {
            for (int k = 0; k < 3; k++) p[k][a] -= w->centre[a];
            sum[a] = p[0][a] + p[1][a] + p[2][a];
        }
        six = bvxi_vec_dot(p[0], n);

        add_compensated(&s.sum[0], &s.lost[0], six / 6.0);
        for (int a = 0; a < 3; a++) add_compensated(&s.sum[1 + a], &s.lost[1 + a], six * sum[a] / 24.0);
        for (int i = 0; i < 6; i++) {
            int32_t const a = moment_axes[i][0], b = moment_axes[i][1];
            double const at = p[0][a] * p[0][b] + p[1][a] * p[1][b] + p[2][a] * p[2][b];
            add_compensated(&s.sum[4 + i], &s.lost[4 + i], six * (at + sum[a] * sum[b]) / 120.0);
        }
    }
    w->pieces[piece] = s;
}

static bvx_status sum_moments(bvx_context *ctx, measure_work *w, const bvx_mesh_view *view,
                              triangle_sums *all)
{
    int32_t const pieces = bvxi_piece_count(view->triangle_count, MASS_GRAIN);
    uint64_t const bytes = (uint64_t)pieces * sizeof *w->pieces;

    w->view = view;
    memset(all, 0, sizeof *all);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the sums of pieces", &w->pieces));
    BVXI_TRY(bvxi_for_pieces(ctx, "sums", 0.0, 0.5, pieces, view->triangle_count, sum_piece, w));
    /* In the order of pieces, so that sums do not depend on threads. */
    for (int32_t i = 0; i < pieces; i++) {
        const triangle_sums *const s = &w->pieces[i];

        for (int k = 0; k < MOMENTS; k++) {
            add_compensated(&all->sum[k], &all->lost[k], s->sum[k]);
            add_compensated(&all->sum[k], &all->lost[k], s->lost[k]);
        }
        all->area += s->area;
        all->spread += s->spread;
    }
    return BVX_OK;
}

/* The sheet that the rule has over holes, turned to what it closes; none without holes. */
static bvx_status sum_sheet(bvx_context *ctx, measure_work *w, const bvx_mesh_view *view,
                            const bvx_lattice *lattice, triangle_sums *all)
{
    bvx_mesh_view sheet = *view;
    bvxi_holes holes = {0};
    uint32_t *corner;

    BVXI_TRY(bvxi_holes_open_rule(ctx, mass_name, view, lattice, BVX_FILL_WINDING, &holes));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, holes.points * 12, "the sheet's corners", &corner));
    sheet.triangle_count = bvxi_sheet_triangles(&holes, corner);
    for (uint64_t i = 0; i < 3 * sheet.triangle_count; i++) corner[i] = holes.vertex[corner[i]];
    sheet.indices = corner;
    sheet.index_type = BVX_U32;
    sheet.index_stride = 0;
    return sheet.triangle_count != 0 ? sum_moments(ctx, w, &sheet, all) : BVX_OK;
}

/* Of shells that are closed, by the sheet of a lattice if it is given. */
static bvx_status sum_shells(bvx_context *ctx, measure_work *w, const bvx_mesh_view *view,
                             const bvx_lattice *lattice)
{
    triangle_sums s, sheet = {{0}, {0}, 0, 0};

    BVXI_TRY(BVXI_SCOPE(ctx, sum_moments(ctx, w, view, &s)));
    if (lattice != NULL) {
        BVXI_TRY(BVXI_SHARE(ctx, 0.5, 1.0, BVXI_SCOPE(ctx, sum_sheet(ctx, w, view, lattice, &sheet))));
    } else {
        /* A single surface that crosses itself nowhere has one side in and one out. Of several, one may lie in
         * another between two rows of centres. */
        uint64_t crossings = 0;
        bvx_certificate c;
        BVXI_TRY(BVXI_SHARE(ctx, 0.5, 0.65, bvx_mesh_check(ctx, view, 1, &c)));
        w->certain = c.closed && c.oriented && c.components <= 1;
        if (w->certain)
            BVXI_TRY(BVXI_SHARE(ctx, 0.65, 1.0, bvx_mesh_crossings(ctx, view, &crossings, NULL, 0)));
        w->certain &= crossings == 0;
    }
    w->summed = 1;
    w->error = MEASURE_ROUNDING * s.spread * w->radius;
    for (int k = 0; k < MOMENTS; k++) w->moment[k] = s.sum[k] + s.lost[k] - (sheet.sum[k] + sheet.lost[k]);

    /* What faces inwards is the same body. What encloses nothing has no moments. */
    for (int k = MOMENTS; k-- > 0;)
        w->moment[k] = bvxi_absolute(w->moment[0]) <= w->error ? 0.0
                       : w->moment[0] < 0.0                    ? -w->moment[k]
                                                               : w->moment[k];
    return BVX_OK;
}

/* ---- Voxels ---- */

/* As moments, of the voxels' low corners in the window. [Limit: 2^36 voxels, places below 2^12] */
typedef struct voxel_sums {
    uint64_t moment[MOMENTS];
} voxel_sums;

/* Bits whose place has 1, 2, 4 .. 32 in it: places are added up, and their squares, by counting. */
static void add_voxels(voxel_sums *s, uint64_t word, uint64_t x, uint64_t y, uint64_t z)
{
    static const uint64_t place[6] = {UINT64_C(0xaaaaaaaaaaaaaaaa), UINT64_C(0xcccccccccccccccc),
                                      UINT64_C(0xf0f0f0f0f0f0f0f0), UINT64_C(0xff00ff00ff00ff00),
                                      UINT64_C(0xffff0000ffff0000), UINT64_C(0xffffffff00000000)};
    uint64_t const n = bvxi_popcount(word);
    uint64_t first = 0, second = 0;

    if (word == 0) return;
    for (int i = 0; i < 6; i++) {
        first += (uint64_t)bvxi_popcount(word & place[i]) << i;
        for (int j = 0; j < 6; j++) second += (uint64_t)bvxi_popcount(word & place[i] & place[j]) << (i + j);
    }
    second += x * (x * n + 2 * first);
    first += x * n;

    uint64_t const add[MOMENTS] = {n,         first,     y * n,     z * n,     second,
                                   y * y * n, z * z * n, y * first, z * first, y * z * n};
    for (int k = 0; k < MOMENTS; k++) s->moment[k] += add[k];
}

/* Voxels of a word that have another one beside them than they are; beyond the window is empty. */
static uint64_t find_changes(const bvx_grid *g, int32_t k, int32_t y, int32_t z)
{
    size_t const n = (size_t)g->words_per_row;
    const uint64_t *const row = bvxi_grid_row(g, y, z);
    uint64_t const w = row[k], before = k > 0 ? row[k - 1] >> 63 : 0;
    uint64_t const after = k + 1 < g->words_per_row ? row[k + 1] << 63 : 0;
    size_t const slice = n * (size_t)g->size[1];
    return (w ^ (w << 1 | before)) | (w ^ (w >> 1 | after)) | (w ^ (y > 0 ? *(row + k - n) : 0)) |
           (w ^ (y + 1 < g->size[1] ? row[(size_t)k + n] : 0)) | (w ^ (z > 0 ? *(row + k - slice) : 0)) |
           (w ^ (z + 1 < g->size[2] ? row[(size_t)k + slice] : 0));
}

/* ---- The report ---- */

/* How far what a body is made of may be off: its volume, and with it all places and their squares about the
 * centre of mass. */
typedef struct measure_errors {
    double volume, first, second;
} measure_errors;

/* moment: about from, scaled. */
static void set_body(const measure_work *w, const double moment[MOMENTS], const double from[3],
                     double center[3], bvx_measure_report *r)
{
    double const back = 1.0 / w->scale, density = w->options.density;
    double inertia[6], c[3];

    for (int a = 0; a < 3; a++) {
        c[a] = moment[0] > 0.0 ? moment[1 + a] / moment[0] : w->centre[a] - from[a];
        center[a] = from[a] + c[a];
        r->center[a] = center[a] * back;
    }
    for (int i = 0; i < 6; i++) {
        int32_t const a = moment_axes[i][0], b = moment_axes[i][1];
        inertia[i] = moment[4 + i] - moment[0] * c[a] * c[b];
    }
    r->volume = moment[0] * back * back * back;
    r->mass = density * r->volume;
    for (int i = 0; i < 6; i++) {
        double const own = i < 3 ? inertia[(i + 1) % 3] + inertia[(i + 2) % 3] : -inertia[i];
        r->inertia[i] = density * own * back * back * back * back * back + 0.0;
    }
}

static void set_errors(const measure_work *w, double volume, const measure_errors *e, bvx_measure_report *r)
{
    double const back = 1.0 / w->scale, sure = volume - e->volume, most = 2.0 * w->radius;
    double center = sure > 0.0 ? e->first / sure : most;
    if (center > most) center = most;
    r->volume_error = e->volume * back * back * back;
    r->inertia_error = w->options.density * (e->second + (volume + e->volume) * center * center) * back *
                       back * back * back * back;
    for (int a = 0; a < 3; a++) center += 0x1p-50 * bvxi_absolute(r->center[a] * w->scale);
    r->center_error = center * back;
}

/* Of voxels with these spacings, about the lattice's corner. */
static void weigh_voxels(const voxel_sums *s, const double spacing[3], double moment[MOMENTS])
{
    double const one = spacing[0] * spacing[1] * spacing[2], n = (double)s->moment[0];

    moment[0] = n * one;
    for (int a = 0; a < 3; a++) moment[1 + a] = ((double)s->moment[1 + a] + 0.5 * n) * spacing[a] * one;
    for (int i = 0; i < 6; i++) {
        int32_t const a = moment_axes[i][0], b = moment_axes[i][1];
        double const halves = 0.5 * (double)(s->moment[1 + a] + s->moment[1 + b]);
        /* A voxel has the moment of its centre, and along an axis its own. */
        double const own = a == b ? n / 3.0 : n / 4.0;
        moment[4 + i] = ((double)s->moment[4 + i] + halves + own) * spacing[a] * spacing[b] * one;
    }
}

static void report_voxels(const measure_work *w, const bvx_lattice *lattice, const voxel_sums *body,
                          const voxel_sums *edge, uint64_t inside, bvx_measure_report *r)
{
    double spacing[3], origin[3], moment[MOMENTS], unsure[MOMENTS], center[3];
    double one = 1.0;
    measure_errors e = {0};

    for (int a = 0; a < 3; a++) {
        spacing[a] = lattice->spacing[a] * w->scale;
        origin[a] = lattice->origin[a] * w->scale;
        one *= spacing[a];
    }
    weigh_voxels(body, spacing, moment);
    weigh_voxels(edge, spacing, unsure);
    set_body(w, moment, origin, center, r);

    /* Voxels that are set can only lose, the others only gain: squares of distances from the centre of mass
     * over all of them, and distances by the inequality of Cauchy and Schwarz. */
    e.volume = one * (double)(2 * inside > edge->moment[0] ? inside : edge->moment[0] - inside);
    for (int a = 0; a < 3; a++) {
        double const c = center[a] - origin[a];
        e.second += unsure[4 + a] - 2.0 * c * unsure[1 + a] + c * c * unsure[0];
    }
    e.first = sqrt(e.second * unsure[0]);
    set_errors(w, moment[0], &e, r);
}

/* Triangles and the sheet over their holes say more than voxels, where these bear it out. */
static void report_closed(const measure_work *w, bvx_measure_report *r)
{
    bvx_measure_report by_sums = *r;
    double const volume = w->moment[0] / w->scale / w->scale / w->scale;
    double center[3], moved = 0.0, inertia = 0.0;

    set_body(w, w->moment, w->centre, center, &by_sums);
    for (int a = 0; a < 3; a++)
        moved += (by_sums.center[a] - r->center[a]) * (by_sums.center[a] - r->center[a]);
    moved = sqrt(moved);
    for (int i = 0; i < 6; i++) {
        double const off = bvxi_absolute(by_sums.inertia[i] - r->inertia[i]);
        inertia = off > inertia ? off : inertia;
    }
    by_sums.volume_error += bvxi_absolute(volume - r->volume);
    by_sums.center_error += moved;
    by_sums.inertia_error += inertia;
    if (by_sums.volume_error <= 2.0 * r->volume_error && moved <= r->center_error &&
        inertia <= r->inertia_error)
        *r = by_sums;
}

/* ---- What is inside ---- */

/* A bvxi_fill_by_name_fn: the triangles are at hand as they are to be filled. */
static bvx_status fill_and_sum(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t fill, bvx_grid *solid,
                               bvx_solid_report *report)
{
    measure_work *const w = (measure_work *)(void *)report;
    if (fill == BVX_FILL_PARITY || fill == BVX_FILL_WINDING)
        BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.5,
                            sum_shells(ctx, w, mesh, fill == BVX_FILL_PARITY ? NULL : &solid->lattice)));
    return BVXI_SHARE(ctx, 0.5, 1.0, bvxi_fill_known(ctx, mesh, fill, NULL, solid));
}

static bvx_status open_voxels(bvx_context *ctx, const bvx_mesh_view *mesh, measure_work *w, bvx_grid *solid)
{
    bvx_lattice_options fit = {.struct_size = sizeof fit, .padding = 1};
    bvx_window whole = {{0}, {0}};
    bvx_lattice l;
    for (int a = 0; a < 3; a++) fit.axis_resolution[a] = w->options.resolution;
    BVXI_TRY(bvx_lattice_fit_with(ctx, mesh, &fit, &l));
    solid->word_capacity = bvx_grid_bound(&l, NULL);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, solid->word_capacity * 8, "the measured voxels", &solid->words));
    memcpy(whole.size, l.dims, sizeof whole.size);
    return bvxi_grid_open(ctx, mass_name, &l, &whole, solid);
}

static bvx_status mass_of_body(bvx_context *ctx, const bvx_mesh_view *mesh, measure_work *w,
                               bvx_measure_report *r)
{
    bvx_grid solid = {0}, shell;
    voxel_sums body = {{0}}, edge = {{0}};
    triangle_sums surface;
    uint64_t inside = 0;

    BVXI_TRY(open_voxels(ctx, mesh, w, &solid));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.1, BVXI_SCOPE(ctx, sum_moments(ctx, w, mesh, &surface))));
    r->area = surface.area / w->scale / w->scale;
    BVXI_TRY(
        BVXI_SHARE(ctx, 0.1, 0.6, bvxi_fill_auto(ctx, mass_name, mesh, fill_and_sum, &solid, &w->solid)));
    r->fill = w->solid.fill;
    r->fill_reason = w->solid.fill_reason;
    r->turned = w->solid.turned;

    if (w->solid.fill_reason == BVX_FILL_REASON_SOUND && !w->summed)
        BVXI_TRY(BVXI_SHARE(ctx, 0.6, 0.8, sum_shells(ctx, w, mesh, NULL)));
    if (w->solid.fill_reason == BVX_FILL_REASON_SOUND && w->certain) {
        double const reach = 2.0 * w->radius; /* nothing is farther from the centre of mass */
        measure_errors const e = {w->error, w->error * reach, w->error * reach * reach};
        double center[3];
        set_body(w, w->moment, w->centre, center, r);
        set_errors(w, w->moment[0], &e, r);

        return BVX_OK;
    }
    BVXI_TRY(BVXI_SHARE(ctx, 0.8, 1.0, bvxi_shell_open(ctx, mesh, &solid, &shell)));
    /* inside: voxels that are set and may not be so as a whole. */
    size_t at = 0;
    for (int32_t z = 0; z < solid.size[2]; z++)
        for (int32_t y = 0; y < solid.size[1]; y++)
            for (int32_t k = 0; k < solid.words_per_row; k++, at++) {
                uint64_t const mask = k + 1 < solid.words_per_row ? ~UINT64_C(0)
                                                                  : bvxi_tail_mask(solid.size[0]);
                uint64_t const unsure = (shell.words[at] | find_changes(&solid, k, y, z)) & mask;
                add_voxels(&body, solid.words[at], (uint64_t)k * 64, (uint64_t)y, (uint64_t)z);
                add_voxels(&edge, unsure, (uint64_t)k * 64, (uint64_t)y, (uint64_t)z);
                inside += bvxi_popcount(unsure & solid.words[at]);
            }
    r->resolution = w->options.resolution;
    report_voxels(w, &solid.lattice, &body, &edge, inside, r);
    if (w->solid.fill_reason == BVX_FILL_REASON_SOUND || w->solid.fill_reason == BVX_FILL_REASON_OPEN)
        report_closed(w, r);
    return BVX_OK;
}

static const bvxi_option mass_rows[] = {
    BVXI_OR(bvx_measure_options, density, ABOVE, 1.0, 0.0, BVXI_FINITE),
    BVXI_OR(bvx_measure_options, resolution, WHOLE, 128, 1, 2048),
    BVXI_RESERVED(bvx_measure_options, reserved),
};

static bvx_status run_measure(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_measure_options *options,
                              bvx_measure_report *report)
{
    bvx_measure_report r = {0};
    measure_work w = {.scale = 1.0};

    if (report == NULL) return bvxi_fail_null(ctx, mass_name, "report");
    memset(report, 0, sizeof *report);
    BVXI_TRY(bvxi_take_options(ctx, mass_name, options, &w.options, sizeof w.options));
    BVXI_TRY(bvxi_check_options(ctx, mass_name, &w.options, BVXI_OPTIONS(mass_rows)));
    BVXI_TRY(bvxi_view_check(ctx, mass_name, mesh));
    BVXI_TRY(bvxi_view_bounds(ctx, mass_name, mesh, w.low, w.high));

    /* Scaled, products neither overflow nor vanish. A power of two: nothing is rounded. */
    w.scale = bvxi_unit_scale(w.low, w.high);
    for (int a = 0; a < 3; a++) {
        double const low = w.low[a] * w.scale, high = w.high[a] * w.scale;
        w.centre[a] = 0.5 * low + 0.5 * high;
        w.radius += (0.5 * high - 0.5 * low) * (0.5 * high - 0.5 * low);
    }
    w.radius = sqrt(w.radius);
    BVXI_TRY(BVXI_SCOPE(ctx, mass_of_body(ctx, mesh, &w, &r)));
    *report = r;
    return BVX_OK;
}

bvx_status bvx_measure(bvx_context *context, const bvx_mesh_view *mesh, const bvx_measure_options *options,
                       bvx_measure_report *report)
{
    return BVXI_CALL(context, run_measure(context, mesh, options, report));
}
