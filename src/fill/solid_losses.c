/* solid_losses.c - what a solid has lost of its mesh: thin walls, and how the volumes compare.
 *
 * thin_walls.c finds where a line of centres crosses the mesh between two centres outside, and requires
 * closest points there: two to three times the fill of a scan. Parts of lattices, as work in tiles has them,
 * are looked at only where requested.
 * Guarantee: sums are taken in pieces of the mesh's shape only, so threads do not show. */
#include "mesh/facet.h"
#include "fill/fills.h"
#include "fill/thin_walls.h"

#include <math.h>

enum { LOSS_GRAIN = 4096, LOSS_LANES = 8 };

#define LOSS_SHEET   1e-6  /* of the volume of a cube of that surface: folded sheets enclose less */
#define LOSS_FLAT    256.0 /* a face that rises less than this once lies along the lattice */
#define LOSS_MOST    0.01  /* of a volume that is as it should be */
#define LOSS_LARGEST 1e6   /* times that no resolution is known for */

/* Sums over some triangles: six times the volume, twice the shadows along each axis, and of these those of
 * faces along the lattice. */
typedef struct loss_sums {
    double volume, shadow[3], flat[3];
} loss_sums;

typedef struct loss_job {
    const bvx_mesh_view *mesh;
    double from[3]; /* a vertex: volumes are taken from there */
    int flat;       /* 1: flat only, 0: the others */
    int fast;
    int32_t pieces;
    loss_sums sums[256]; /* by piece */
} loss_job;

/* Triangles of three numbers each and vertices of three floats, as meshes that the library made: some at once, each
 * lane with sums of its own. Triangles after the last have no area. */
BVXI_VECTOR_INLINE void sum_packed_losses(const loss_job *job, uint64_t begin, uint64_t end, loss_sums *s)
{
    const unsigned char *const corners = job->mesh->indices, *const places = job->mesh->positions;
    double const x = job->from[0], y = job->from[1], z = job->from[2];
    double sum[4][LOSS_LANES] = {{0}};
    float f[3][3][LOSS_LANES];

    for (uint64_t t = begin; t < end; t += LOSS_LANES) {
        if (end - t < LOSS_LANES) memset(f, 0, sizeof f);
        for (uint64_t i = 0; i < LOSS_LANES && t + i < end; i++)
            for (int k = 0; k < 3; k++) {
                uint32_t c;
                memcpy(&c, corners + (size_t)(t + i) * 12 + 4 * k, sizeof c);
                for (int a = 0; a < 3; a++) memcpy(&f[k][a][i], places + (size_t)c * 12 + 4 * a, 4);
            }
        for (int i = 0; i < LOSS_LANES; i++) {
            double const ax = (double)f[0][0][i], ay = (double)f[0][1][i], az = (double)f[0][2][i];
            double const ux = (double)f[1][0][i] - ax, uy = (double)f[1][1][i] - ay,
                         uz = (double)f[1][2][i] - az;
            double const vx = (double)f[2][0][i] - ax, vy = (double)f[2][1][i] - ay,
                         vz = (double)f[2][2][i] - az;
            double const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
            sum[0][i] += (ax - x) * nx + (ay - y) * ny + (az - z) * nz;
            sum[1][i] += nx < 0 ? -nx : nx;
            sum[2][i] += ny < 0 ? -ny : ny;
            sum[3][i] += nz < 0 ? -nz : nz;
        }
    }
    for (int i = 0; i < LOSS_LANES; i++) {
        s->volume += sum[0][i];
        for (int a = 0; a < 3; a++) s->shadow[a] += sum[a + 1][i];
    }
}

BVXI_AVX2_COPY(sum_packed_losses_avx2, (const loss_job *job, uint64_t begin, uint64_t end, loss_sums *s),
               sum_packed_losses(job, begin, end, s))

static void sum_losses_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    loss_job *const job = user;
    const bvx_mesh_view *const m = job->mesh;
    loss_sums s = {0, {0, 0, 0}, {0, 0, 0}};

    if (!job->flat && bvxi_view_packed_u32(m) && bvxi_view_packed_f32(m)) {
        BVXI_PATH(job->fast, sum_packed_losses(job, begin, end, &s),
                  sum_packed_losses_avx2(job, begin, end, &s));
        begin = end;
    }
    for (uint64_t t = begin; t < end; t++) {
        double p[3][3], n[3];

        /* Twice the triangle's area as a vector: its parts are shadows along the axes. */
        bvxi_view_corners(m, t, p);
        bvxi_facet_cross((const double(*)[3])p, n);
        for (int a = 0; a < 3; a++) {
            double const shadow = bvxi_absolute(n[a]), most = shadow / LOSS_FLAT;

            /* Of flat ones only that of a face along the lattice. */
            if (!job->flat) {
                s.volume += (p[0][a] - job->from[a]) * n[a];
                s.shadow[a] += shadow;
            } else if (bvxi_absolute(n[(a + 1) % 3]) <= most && bvxi_absolute(n[(a + 2) % 3]) <= most) {
                s.flat[a] += shadow;
            }
        }
    }
    job->sums[piece] = s;
}

static bvx_status sum_mesh(bvx_context *ctx, const bvx_mesh_view *mesh, int flat, loss_sums *all)
{
    loss_job job;
    uint32_t c[3];

    job.mesh = mesh;
    job.flat = flat;
    job.fast = bvxi_cpu(ctx) == BVX_CPU_AVX2;
    job.pieces = bvxi_piece_count(mesh->triangle_count, LOSS_GRAIN);
    bvxi_view_triangle(mesh, 0, c);
    bvxi_view_position(mesh, c[0], job.from);
    BVXI_TRY(
        bvxi_for_pieces(ctx, "sums", 0.0, 0.1, job.pieces, job.mesh->triangle_count, sum_losses_piece, &job));
    /* In the order of pieces, so that sums do not depend on threads. */
    memset(all, 0, sizeof *all);
    for (int32_t i = 0; i < job.pieces; i++) {
        all->volume += job.sums[i].volume;
        for (int a = 0; a < 3; a++) all->shadow[a] += job.sums[i].shadow[a];
        for (int a = 0; a < 3; a++) all->flat[a] += job.sums[i].flat[a];
    }
    return BVX_OK;
}

static int is_in_window(const bvx_mesh_view *mesh, const bvx_grid *g)
{
    double low[3], high[3];
    uint32_t at[6];
    int in = bvxi_view_outer_bounds(mesh, low, high, at);

    /* A hair beyond, as vertices may lie on the window's sides. */
    for (int a = 0; a < 3 && in; a++) {
        double const spacing = g->lattice.spacing[a],
                     from = g->lattice.origin[a] + (double)g->low[a] * spacing;
        in = low[a] >= from - 1e-6 * spacing && high[a] <= from + ((double)g->size[a] + 1e-6) * spacing;
    }
    return in;
}

/* What the mesh encloses; 0 where the solid does not hold all of it, or next to nothing is enclosed. */
static double comparable_volume(const loss_sums *sums, const bvx_mesh_view *mesh, const bvx_grid *solid)
{
    double const volume = bvxi_absolute(sums->volume) / 6.0;
    double const area = sums->shadow[0] + sums->shadow[1] + sums->shadow[2];
    /* A sheet: what it encloses is next to nothing of what its area could. */
    if (!(volume > LOSS_SHEET * area * sqrt(area)) || !(volume < 1e38)) return 0;
    /* sums' last bits follow the order of triangles */
    return is_in_window(mesh, solid) ? bvxi_nearest_float(volume) : 0;
}

/* ---- Of the solid ---- */

void bvxi_walls_of_solid(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                         const bvx_grid *solid, const bvx_solid_report *report, bvxi_walls *walls)
{
    memset(walls, 0, sizeof *walls);
    walls->ctx = ctx;
    walls->function = function;
    walls->mesh = mesh;
    walls->solid = solid;
    /* Is it known that the triangles run the same way round? Rules that do not require it say nothing of it when
     * requested by name. */
    walls->unoriented = report->turned != 0 ||
                        (report->fill != BVX_FILL_NONZERO && report->fill != BVX_FILL_WINDING &&
                         (report->fill != BVX_FILL_PARITY || report->fill_reason == BVX_FILL_REASON_ASKED));
    /* Faces may be seen from behind through holes. */
    if (report->fill_reason == BVX_FILL_REASON_OPEN || report->unbalanced_rows != 0)
        walls->open = walls->unoriented ? BVXI_WALLS_NO_SHEETS : BVXI_WALLS_HOLES;
}

static double voxel_size(const bvx_lattice *l)
{
    return l->spacing[0] * l->spacing[1] * l->spacing[2];
}

double bvxi_volume_by_crossings(const bvxi_walls *walls, double volume)
{
    double made = volume;
    if (!(volume > 0)) return 0;
    for (int a = 0; a < 3; a++) made *= 1.0 + walls->beyond[a] * voxel_size(&walls->solid->lattice) / volume;
    return made > 0 && made < 1e38 ? bvxi_nearest_float(made) : 0;
}

void bvxi_tell_walls(bvxi_walls *walls, bvx_solid_report *report)
{
    const bvx_grid *const solid = walls->solid;
    int32_t longest = 0;
    bvxi_wall_report found;

    bvxi_walls_report(walls, &found);
    report->thin_checked = 1;
    report->thin_voxels = found.voxels;
    report->crossing_volume = bvxi_volume_by_crossings(walls, report->volume);
    if (found.voxels == 0) return;
    /* Places are counted in the window; the report is in the lattice. */
    for (int a = 0; a < 3; a++) {
        report->thin_box[0][a] = found.low[a] + solid->low[a];
        report->thin_box[1][a] = found.high[a] + solid->low[a];
        if (solid->lattice.dims[a] > longest) longest = solid->lattice.dims[a];
    }
    report->thin_resolution = bvxi_wall_resolution(longest, found.wall);
}

int bvxi_solid_is_closed(const bvx_solid_report *r)
{
    return r->fill_reason != BVX_FILL_REASON_OPEN && r->unbalanced_rows == 0 &&
           (r->fill == BVX_FILL_PARITY || r->fill == BVX_FILL_NONZERO || r->fill == BVX_FILL_WINDING ||
            r->fill == BVX_FILL_VOTE);
}

static bvx_status look_for_walls(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                                 const bvx_grid *solid, bvx_solid_report *report)
{
    bvxi_walls walls;
    bvxi_walls_of_solid(ctx, function, mesh, solid, report, &walls);
    BVXI_TRY(bvxi_walls_open(&walls));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.4, bvxi_walls_gather(&walls)));
    if (walls.count != 0) BVXI_TRY(BVXI_SHARE(ctx, 0.4, 1.0, bvxi_walls_ask(&walls, 1.0)));
    bvxi_tell_walls(&walls, report);
    return BVX_OK;
}

/* From which resolution on the volume is right. What is off shrinks with the voxels; but faces along the
 * lattice may lie half a voxel off at any, where here they are lucky. */
bvx_status bvxi_advise_for_volume(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *l,
                                  bvx_solid_report *report)
{
    double const wanted = report->mesh_volume > 0 ? report->mesh_volume : report->crossing_volume;
    double off = wanted > 0 ? bvxi_absolute(report->volume - wanted) / wanted : 0, flat = 0;
    int32_t longest = 0;
    loss_sums sums;

    if (off <= LOSS_MOST || off > LOSS_LARGEST) return BVX_OK;
    BVXI_TRY(sum_mesh(ctx, mesh, 1, &sums));
    for (int a = 0; a < 3; a++) {
        flat += 0.25 * sums.flat[a] * l->spacing[a] / wanted;
        if (l->dims[a] > longest) longest = l->dims[a];
    }
    if (flat > off) off = flat < LOSS_LARGEST ? flat : LOSS_LARGEST;

    /* As walls: so much larger are voxels than they should be. Sums' last bits follow the order of
     * triangles. */
    report->volume_resolution = bvxi_wall_resolution(longest,
                                                     BVXI_THIN_WALL * LOSS_MOST / bvxi_nearest_float(off));
    return BVX_OK;
}

bvx_status bvxi_solid_losses(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_grid *solid, const bvx_voxelize_options *o, bvx_solid_report *report)
{
    const bvx_lattice *const l = &solid->lattice;
    int const look = o->check_thin == BVX_CHECK_ALWAYS ||
                     (o->check_thin == BVX_CHECK_AUTO && bvxi_grid_is_whole(solid) && !o->add_shell);
    loss_sums sums;
    uint64_t voxels;

    BVXI_TRY(bvx_grid_count(ctx, solid, &voxels));
    report->volume = (double)voxels * voxel_size(l);
    /* A terrain has no walls and no volume of its own. */
    if (report->fill == BVX_FILL_BELOW) return BVX_OK;

    /* Only of a sound mesh is the volume that of the body. */
    if (report->fill_reason == BVX_FILL_REASON_SOUND && !o->add_shell && report->turned == 0 &&
        report->mesh_volume == 0) {
        BVXI_TRY(sum_mesh(ctx, mesh, 0, &sums));
        report->mesh_volume = comparable_volume(&sums, mesh, solid);
    }
    if (report->mesh_volume < 0) report->mesh_volume = 0;

    /* A solid that the memory limit allows is not refused for a look that nobody requested. */
    bvx_status status = look ? BVXI_SHARE(ctx, 0.1, 0.95,
                                          BVXI_SCOPE(ctx, look_for_walls(ctx, function, mesh, solid, report)))
                             : BVX_OK;
    if (status == BVX_ERR_BUDGET && o->check_thin == BVX_CHECK_AUTO) status = BVX_OK;
    if (o->add_shell) report->crossing_volume = 0;
    return status;
}

/* ---- Warnings ---- */

#define LOSS_LARGE 0.05 /* of a volume: also a surface made of the voxels is off */

/* What sides say counts while lines of centres see no more of it: shells that face the wrong way take from it. */
double bvxi_known_volume(const bvx_solid_report *r)
{
    int const by_sides = r->mesh_volume > 0.0 && r->crossing_volume * (1.0 - LOSS_LARGE) <= r->mesh_volume;
    return by_sides ? r->mesh_volume : r->crossing_volume;
}

void bvxi_warn_of_walls(bvx_context *ctx, const bvx_lattice *lattice, const bvx_solid_report *r,
                        int32_t input)
{
    if (r->thin_voxels == 0) return;
    bvx_warning *w = BVXI_WARN(ctx, BVX_WARN_THIN_LOST, (double)r->thin_voxels,
                               bvxi_advised(r->thin_resolution));
    w->input = input;
    bvxi_warn_box(w, lattice, r->thin_box[0], r->thin_box[1]);
}

void bvxi_warn_of_fill(bvx_context *ctx, const bvx_solid_report *r, int32_t input)
{
    if (r->unbalanced_rows != 0) BVXI_WARN(ctx, BVX_WARN_ROWS, (double)r->unbalanced_rows)->input = input;
    if (r->fill_reason == BVX_FILL_REASON_NESTED) bvxi_warn(ctx, BVX_WARN_NESTED, 0, NULL)->input = input;
}

void bvxi_warn_of_solid(bvx_context *ctx, const bvx_grid *solid, bvx_solid_report *r)
{
    bvxi_warn_of_fill(ctx, r, -1);
    if (r->leaks != 0) BVXI_WARN(ctx, BVX_WARN_LEAKS, (double)r->leaks);
    if (r->mixed_regions != 0)
        BVXI_WARN(ctx, BVX_WARN_MIXED, (double)r->mixed_regions, (double)r->regions, (double)r->mixed_voxels);
    bvxi_warn_of_walls(ctx, &solid->lattice, r, -1);

    /* Half a voxel of surface is always off a little; what a mesh with rows that do not balance encloses is
     * not known. */
    double const wanted = bvxi_known_volume(r);
    double const off = wanted > 0.0 && r->volume > 0.0 ? r->volume / wanted - 1.0 : 0.0;
    int const large = bvxi_absolute(off) > LOSS_LARGE;

    if (bvxi_absolute(off) > LOSS_MOST && (r->fill_reason != BVX_FILL_REASON_OPEN || r->unbalanced_rows == 0))
        BVXI_WARN(ctx, large ? BVX_WARN_VOLUME : BVX_WARN_VOXELS, r->volume, wanted, off,
                  bvxi_advised(r->volume_resolution));

    r->warnings = bvxi_warned(ctx);
}
