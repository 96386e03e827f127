/* inspect.c - whether a body can be made: sound, walls, gaps, cavities, islands of its layers: bvx_inspect.
 *
 * Thickness is measured along rays, from points of each triangle straight inwards to the first triangle ahead; gaps
 * along the same rays outwards. Rays, not the largest balls that fit: a ball beside a convex edge has no size, so a
 * cube would be thin along its edges. A triangle ahead counts where it faces the ray to 60 degrees, so edges of more
 * than that are no thin walls. Cavities and islands are parts of voxels, which places of thin walls are joined by, too.
 * Guarantee: a measured way is one between two points of the mesh. Points of a triangle lie at most a voxel apart,
 * so that a wall which is thin over more than that is met.
 * Source: Shapira, Shamir, Cohen-Or. Consistent Mesh Partitioning and Skeletonisation Using the Shape Diameter
 * Function. 2008 (rays inwards, and which of them count). */
#include "components/room.h"
#include "fill/fills.h"
#include "grid/sparse.h"
#include "mesh/facet.h"
#include "mesh/view.h"
#include "pipeline/repair.h"

#include <math.h>

static const char inspect_name[] = "bvx_inspect";

enum { INSPECT_BATCH = 1 << 15, INSPECT_BINS = 1 << 18, INSPECT_DIGITS = 45 };

#define INSPECT_FACING 0.5     /* cosine between the ray and the normal of what it meets */
#define INSPECT_STEP   0x1p-13 /* rays start so far apart or more [Units: the longest side] */
#define INSPECT_OFF    0x1p-40 /* rays start so far ahead of their triangle [Units: the largest coordinate] */

/* A point of a thin wall, or a narrow gap: the voxel in its middle. */
typedef struct inspect_mark {
    double length;
    int32_t voxel[3], reserved;
} inspect_mark;

/* Samples that wait for their rays. */
typedef struct inspect_batch {
    double *ray, *area;
    bvx_mesh_hit *hit;
    uint32_t *triangle;
    uint8_t *corners; /* bits of the corners whose nearest sample this is */
    uint64_t count, done, all;
} inspect_batch;

typedef struct inspect_job {
    bvx_context *ctx;
    const char *function;
    const bvx_mesh_view *mesh;
    bvx_inspect_options options;
    bvx_inspect_report report;
    bvx_closest *closest;
    bvx_grid solid;
    double scale, longest, step, off;
    inspect_batch batch;
    double *binned; /* areas of surface by the leading bits of their thickness [Size: INSPECT_BINS] */
    inspect_mark *mark[2];
    uint64_t marks[2], capacity[2];
} inspect_job;

/* ---- Rays ---- */

static void note_thickness(inspect_job *job, uint64_t i, double length)
{
    const inspect_batch *const b = &job->batch;
    uint64_t bits;
    uint32_t v[3];

    /* Leading digits of a positive double are in its order: bins of less than 1 %. */
    memcpy(&bits, &length, sizeof bits);
    job->binned[bits >> INSPECT_DIGITS] += b->area[i];
    if (job->options.thickness == NULL) return;
    bvxi_view_triangle(job->mesh, b->triangle[i], v);
    for (int k = 0; k < 3; k++)
        if ((b->corners[i] >> k & 1) != 0 && length < job->options.thickness[v[k]])
            job->options.thickness[v[k]] = length;
}

static bvx_status take_way(inspect_job *job, int kind, uint64_t i)
{
    const bvx_mesh_hit *const hit = &job->batch.hit[i];
    const double *const ray = job->batch.ray + 6 * i;
    double const length = hit->t + job->off, area = job->batch.area[i];
    double *const least = kind == BVX_FINDING_WALL ? &job->report.least_thickness : &job->report.least_gap;
    double ends[2][3], p[3][3], n[3];

    /* The first triangle ahead, where it faces the ray: walls end at its back, gaps at its front. */
    if (hit->side != (kind == BVX_FINDING_WALL ? -1 : 1)) return BVX_OK;
    bvxi_view_scaled(job->mesh, hit->triangle, job->scale, p);
    double const twice = bvxi_facet_normal((const double(*)[3])p, n);
    if (!(bvxi_absolute(bvxi_vec_dot(n, ray + 3)) >= INSPECT_FACING * twice)) return BVX_OK;

    memcpy(ends[0], ray, sizeof ends[0]);
    memcpy(ends[1], hit->position, sizeof ends[1]);
    if (kind == BVX_FINDING_WALL) note_thickness(job, i, length);
    if (length < *least) {
        *least = length;
        memcpy(kind == BVX_FINDING_WALL ? job->report.thin_ends : job->report.gap_ends, ends, sizeof ends);
    }
    if (length >= (kind == BVX_FINDING_WALL ? job->options.walls : job->options.gaps)) return BVX_OK;
    if (kind == BVX_FINDING_WALL) job->report.thin_area += area;

    const bvx_lattice *const l = &job->report.lattice;
    inspect_mark m = {.length = length};

    for (int a = 0; a < 3; a++) {
        double const at = floor((0.5 * (ends[0][a] + ends[1][a]) - l->origin[a]) / l->spacing[a]);
        /* Of a lattice that does not hold all of the mesh the nearest voxel stands for what lies beyond. */
        m.voxel[a] = at < 0.0 ? 0 : at >= (double)l->dims[a] ? l->dims[a] - 1 : (int32_t)at;
    }
    BVXI_TRY(
        BVXI_GROW(job, job->mark[kind], job->marks[kind], job->capacity[kind], "the places of thin walls"));
    job->mark[kind][job->marks[kind]++] = m;
    return BVX_OK;
}

/* Cast the rays that wait, inwards and then outwards. */
static bvx_status cast_batch(inspect_job *job)
{
    inspect_batch *const b = &job->batch;
    double const all = (double)b->all, from = (double)b->done / all;

    b->done += b->count;
    for (int kind = BVX_FINDING_WALL; kind <= BVX_FINDING_GAP; kind++) {
        double const part = ((double)b->done / all - from) * 0.5;

        for (uint64_t i = 0; i < b->count; i++) {
            double *const ray = b->ray + 6 * i;
            /* Outwards the way is turned, and starts on the other side of the triangle. */
            for (int a = 0; a < 3; a++) {
                ray[3 + a] = kind == BVX_FINDING_WALL ? ray[3 + a] : -ray[3 + a];
                ray[a] += (kind == BVX_FINDING_WALL ? 1.0 : 2.0) * job->off * ray[3 + a];
            }
        }
        BVXI_TRY(BVXI_SHARE(job->ctx, from + kind * part, from + (kind + 1) * part,
                            bvx_closest_cast(job->ctx, job->closest, b->ray, b->count, HUGE_VAL, b->hit)));
        for (uint64_t i = 0; i < b->count; i++) BVXI_TRY(take_way(job, kind, i));
    }
    b->count = 0;
    return BVX_OK;
}

/* How a triangle is sampled: rows of points from its longest edge to the corner before it. */
typedef struct inspect_rows {
    double p[3][3]; /* ends of that edge, the corner; scaled */
    double inwards[3], area;
    int corner[3];
    uint64_t rows, points, all;
} inspect_rows;

/* Rows are shorter towards the corner. */
static uint64_t count_inspected_points(const inspect_rows *r, uint64_t row)
{
    return (uint64_t)((double)r->points * (1.0 - ((double)row + 0.5) / (double)r->rows)) + 1;
}

static int open_inspect_rows(const inspect_job *job, uint64_t t, inspect_rows *r)
{
    double p[3][3], n[3], longest = -1.0, step = job->step;
    double const area2 = (bvxi_view_scaled(job->mesh, t, job->scale, p),
                          bvxi_facet_normal((const double(*)[3])p, n));

    if (!(area2 > 0.0)) return 0;
    for (int k = 0; k < 3; k++) {
        double const length = sqrt(bvxi_vec_distance2(p[k], p[(k + 1) % 3]));
        if (length <= longest) continue;
        longest = length;
        for (int c = 0; c < 3; c++) r->corner[c] = (k + c) % 3;
    }
    for (int c = 0; c < 3; c++) memcpy(r->p[c], p[r->corner[c]], sizeof r->p[c]);
    for (int a = 0; a < 3; a++) r->inwards[a] = -n[a] / area2;
    r->points = (uint64_t)(longest / step) + 1;
    r->rows = (uint64_t)(area2 / longest / step) + 1;
    r->area = 0.5 * area2 / job->scale / job->scale;
    r->all = 0;
    for (uint64_t row = 0; row < r->rows; row++) r->all += count_inspected_points(r, row);
    return 1;
}

static bvx_status cast_triangle(inspect_job *job, uint64_t t, const inspect_rows *r)
{
    inspect_batch *const b = &job->batch;

    for (uint64_t j = 0; j < r->rows; j++) {
        uint64_t const points = count_inspected_points(r, j);
        double const v = ((double)j + 0.5) / (double)r->rows;
        /* A row is a strip of the triangle; all strips are its area. */
        double const area = r->area * 2.0 * (1.0 - v) / (double)r->rows / (double)points;

        for (uint64_t i = 0; i < points; i++) {
            uint64_t const n = b->count;
            double const u = ((double)i + 0.5) / (double)points;
            double *const ray = b->ray + 6 * n;

            for (int a = 0; a < 3; a++) {
                double const on = r->p[0][a] + u * (r->p[1][a] - r->p[0][a]);
                ray[a] = (on + v * (r->p[2][a] - on)) / job->scale;
                ray[3 + a] = r->inwards[a];
            }
            b->area[n] = area;
            b->triangle[n] = (uint32_t)t;
            b->corners[n] = (uint8_t)((j == 0 && i == 0) << r->corner[0] |
                                      (j == 0 && i + 1 == points) << r->corner[1] |
                                      (j + 1 == r->rows) << r->corner[2]);
            if (++b->count == INSPECT_BATCH) BVXI_TRY(cast_batch(job));
        }
    }
    return BVX_OK;
}

static bvx_status cast_all(inspect_job *job)
{
    inspect_batch *const b = &job->batch;
    inspect_rows r;

    BVXI_TRY(BVXI_ARRAY(job->ctx, 6 * INSPECT_BATCH, "rays through walls", b->ray));
    BVXI_TRY(BVXI_ARRAY(job->ctx, INSPECT_BATCH, "the surface that they stand for", b->area));
    BVXI_TRY(BVXI_ARRAY(job->ctx, INSPECT_BATCH, "where rays meet the mesh", b->hit));
    BVXI_TRY(BVXI_ARRAY(job->ctx, INSPECT_BATCH, "where rays start", b->triangle));
    BVXI_TRY(BVXI_ARRAY(job->ctx, INSPECT_BATCH, "corners near rays", b->corners));
    for (uint64_t t = 0; t < job->mesh->triangle_count; t++)
        if (open_inspect_rows(job, t, &r)) b->all += r.all;
    for (uint64_t t = 0; t < job->mesh->triangle_count; t++)
        if (open_inspect_rows(job, t, &r)) BVXI_TRY(cast_triangle(job, t, &r));
    return b->count != 0 ? cast_batch(job) : BVX_OK;
}

static bvx_status measure_walls(inspect_job *job)
{
    BVXI_TRY(BVXI_ZEROS(job->ctx, INSPECT_BINS, "the surface by thickness", job->binned));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.2, bvx_closest_create(job->ctx, job->mesh, &job->closest)));
    bvx_status const status = BVXI_SHARE(job->ctx, 0.2, 1.0, cast_all(job));
    bvx_closest_free(job->ctx, job->closest);
    BVXI_TRY(status);

    static const double share[4] = {0.01, 0.05, 0.5, 0.95};
    double all = 0.0, sum = 0.0;
    int next = 0;

    for (uint64_t i = 0; i < INSPECT_BINS; i++) all += job->binned[i];
    for (int k = 0; k < 4; k++) job->report.thickness[k] = HUGE_VAL;
    for (uint64_t i = 0; i < INSPECT_BINS && next < 4; i++) {
        uint64_t const bits = i << INSPECT_DIGITS;
        double length;

        sum += job->binned[i];
        memcpy(&length, &bits, sizeof length);
        if (length < job->report.least_thickness) length = job->report.least_thickness;
        while (next < 4 && sum > 0.0 && sum >= share[next] * all) job->report.thickness[next++] = length;
    }
    return BVX_OK;
}

/* ---- Parts of voxels ---- */

typedef struct inspect_part {
    double least;
    uint64_t voxels;
    int32_t low[3], high[3], at[3], longest, left_out;
} inspect_part;

typedef struct inspect_parts {
    int kind, axis[3];         /* of the world, of each axis of the grid */
    const bvx_grid *grid;      /* or a layer of it, z up */
    const uint64_t *below;     /* of islands: the layer below */
    const bvxi_sparse *values; /* of walls and gaps */
    int32_t z;
    inspect_part *part;
} inspect_parts;

static void see_part_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const inspect_parts *const p = user;
    inspect_part *const s = &p->part[space];
    int32_t const low[3] = {begin, y, z}, high[3] = {end, y + 1, z + 1};

    for (int a = 0; a < 3; a++) {
        if (s->voxels == 0 || low[a] < s->low[a]) s->low[a] = low[a];
        if (high[a] > s->high[a]) s->high[a] = high[a];
    }
    if (s->voxels == 0) s->least = HUGE_VAL;
    s->voxels += (uint64_t)(end - begin);
    if (p->kind == BVX_FINDING_CAVITY) s->left_out |= bvxi_spaces_at_side(p->grid, begin, end, y, z);

    /* An island's run lies on what is below it or beside that: layers may lean by a voxel. */
    int32_t const first = begin > 0 ? begin - 1 : 0, last = end < p->grid->size[0] ? end : end - 1;
    int32_t const rows = p->kind == BVX_FINDING_ISLAND ? p->grid->size[1] : 0;
    for (int32_t row = y > 0 ? y - 1 : 0; row <= y + 1 && row < rows && !s->left_out; row++)
        for (int32_t k = first >> 6; k <= last >> 6; k++)
            if ((p->below[row * p->grid->words_per_row + k] & bvxi_run_mask(first, last + 1, k)) != 0)
                s->left_out = 1;
    if (p->values == NULL && end - begin > s->longest) {
        int32_t const at[3] = {begin + (end - begin) / 2, y, z};
        s->longest = end - begin;
        memcpy(s->at, at, sizeof at);
    }
    for (int32_t x = begin; x < end && p->values != NULL; x++) {
        double const length = ((const double *)p->values->distances)[bvxi_sparse_index(p->values, x, y, z)];
        int32_t const at[3] = {x, y, z};
        if (length >= s->least) continue;
        s->least = length;
        memcpy(s->at, at, sizeof at);
    }
}

/* Put a part to the findings of its kind, which are in order. */
static void list_part(inspect_job *job, const inspect_parts *p, const inspect_part *s)
{
    const bvx_lattice *const l = &p->grid->lattice;
    uint64_t const most = (uint64_t)job->options.most;
    bvx_finding *const list = job->options.findings == NULL
                                  ? NULL
                                  : job->options.findings + (uint64_t)p->kind * most;
    bvx_finding f = {.size = s->least, .voxels = s->voxels};
    int const larger = p->kind >= BVX_FINDING_CAVITY; /* is worse */
    uint64_t i = job->report.found[p->kind]++;

    if (larger) f.size = (double)s->voxels * l->spacing[0] * l->spacing[1];
    if (p->kind == BVX_FINDING_CAVITY) f.size *= l->spacing[2];
    if (p->kind == BVX_FINDING_CAVITY) job->report.cavity_volume += f.size;
    if (list == NULL) return;
    for (int a = 0; a < 3; a++) {
        double const base = a == 2 ? (double)p->z : 0.0;
        f.position[p->axis[a]] = l->origin[a] + (base + (double)s->at[a] + 0.5) * l->spacing[a];
        f.low[p->axis[a]] = l->origin[a] + (base + (double)s->low[a]) * l->spacing[a];
        f.high[p->axis[a]] = l->origin[a] + (base + (double)s->high[a]) * l->spacing[a];
    }
    if (i > most) i = most;
    for (; i > 0 && (larger ? list[i - 1].size < f.size : list[i - 1].size > f.size); i--)
        if (i < most) list[i] = list[i - 1];
    if (i < most) list[i] = f;
}

static bvx_status list_parts(inspect_job *job, inspect_parts *p, int32_t connectivity)
{
    bvxi_spaces spaces;
    BVXI_TRY(bvxi_spaces_open(job->ctx, inspect_name, "parts", p->grid, p->kind == BVX_FINDING_CAVITY,
                              connectivity, &spaces));
    BVXI_TRY(BVXI_ZEROS(job->ctx, spaces.count, "the parts of voxels", p->part));
    bvxi_spaces_each(&spaces, see_part_run, p);
    for (uint64_t i = 0; i < spaces.count; i++)
        if (!p->part[i].left_out) list_part(job, p, &p->part[i]);
    return BVX_OK;
}

/* Points of walls or gaps in neighbouring voxels are one finding. */
static bvx_status list_marks(inspect_job *job, int kind)
{
    bvxi_sparse s;
    inspect_parts p = {.kind = kind, .axis = {0, 1, 2}, .grid = &s.where, .values = &s};

    if (job->marks[kind] == 0) return BVX_OK;
    BVXI_TRY(bvxi_sparse_open(job->ctx, &job->solid, &s));
    memset(s.where.words, 0, (size_t)bvxi_grid_words(&s.where) * 8);
    for (uint64_t i = 0; i < job->marks[kind]; i++) {
        const int32_t *const v = job->mark[kind][i].voxel;
        bvx_grid_set(&s.where, v[0], v[1], v[2], 1);
    }
    BVXI_TRY(bvxi_sparse_rank(job->ctx, &s));
    BVXI_TRY(bvxi_sparse_columns(job->ctx, &s, BVX_F64, BVXI_DISTANCES));
    double *const least = s.distances;
    for (uint64_t i = 0; i < s.count; i++) least[i] = HUGE_VAL;
    for (uint64_t i = 0; i < job->marks[kind]; i++) {
        const inspect_mark *const m = &job->mark[kind][i];
        uint64_t const n = bvxi_sparse_index(&s, m->voxel[0], m->voxel[1], m->voxel[2]);
        if (m->length < least[n]) least[n] = m->length;
    }
    return list_parts(job, &p, BVXI_CONNECT_26);
}

/* Layer by layer: the first that has voxels lies on the plate. */
static bvx_status list_islands(inspect_job *job, const bvx_grid *turned, int up)
{
    uint64_t const words = (uint64_t)turned->size[1] * (uint64_t)turned->words_per_row;
    bvx_grid layer = *turned;
    inspect_parts p = {.kind = BVX_FINDING_ISLAND, .axis = {(up + 1) % 3, (up + 2) % 3, up}, .grid = &layer};
    uint64_t any = 0;

    layer.size[2] = 1;
    for (int32_t z = 0; z < turned->size[2]; z++) {
        p.z = z;
        layer.words = turned->words + (uint64_t)z * words;
        p.below = z == 0 ? NULL : layer.words - words;
        if (any != 0)
            BVXI_TRY(BVXI_SHARE(job->ctx, (double)z / turned->size[2], (z + 1.0) / turned->size[2],
                                BVXI_SCOPE(job->ctx, list_parts(job, &p, BVXI_CONNECT_26))));
        for (uint64_t i = 0; i < words && any == 0; i++) any |= layer.words[i];
    }
    return BVX_OK;
}

static bvx_status turn_and_list(inspect_job *job)
{
    int const up = job->options.up == BVX_UP_Z ? 2 : job->options.up - BVX_UP_X;
    int32_t const axes[3] = {(up + 1) % 3, (up + 2) % 3, up};
    bvx_grid turned = {0};
    if (up == 2) return list_islands(job, &job->solid, up);
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.2, bvx_grid_permute(job->ctx, &job->solid, axes, NULL, &turned)));
    bvx_status const status = BVXI_SHARE(job->ctx, 0.2, 1.0, list_islands(job, &turned, up));
    bvx_grid_free(job->ctx, &turned);
    return status;
}

/* ---- The call ---- */

/* What repair would say of the mesh, without repairing it. */
static bvx_status judge_mesh(inspect_job *job)
{
    bvx_repair_report unused;
    bvx_repair_options const o = {.struct_size = sizeof o, .fit = job->options.fit, .report = &unused};
    bvxi_repair_job repair = {.ctx = job->ctx, .options = &o, .given = job->mesh};

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.3, bvxi_repair_take(&repair)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.3, 0.7, bvxi_repair_needs(&repair)));
    job->report.certificate = repair.report.before;
    job->report.needs = repair.report.needs;
    job->report.crossings = repair.report.crossings;
    if (repair.report.needs == BVX_NEEDS_NOTHING || repair.report.crossings != 0) return BVX_OK;
    return BVXI_SHARE(job->ctx, 0.7, 1.0,
                      bvx_mesh_crossings(job->ctx, job->mesh, &job->report.crossings, NULL, 0));
}

/* Crumbs of acute edges and narrow grooves are no cavities, nor islands. */
static bvx_status drop_inspected_crumbs(inspect_job *job)
{
    bvxi_crumb_source source = {.mesh = job->mesh};
    uint64_t dropped;
    for (int32_t empty = 0; empty < 2; empty++)
        BVXI_TRY(bvxi_drop_crumbs(job->ctx, inspect_name, &job->solid, empty, &source, 1, &dropped));
    return BVX_OK;
}

static bvx_status fill_and_weigh(inspect_job *job)
{
    bvx_lattice_options const fit = {
        .struct_size = sizeof fit, .resolution = job->options.fit.resolution, .padding = 1};
    bvx_measure_options const o = {.struct_size = sizeof o, .density = job->options.density};
    bvx_solid_report filled;
    bvx_voxelize_options const v = {
        .struct_size = sizeof v, .report = &filled, .check_thin = BVX_CHECK_NEVER};
    bvx_measure_report m;

    if (job->options.fit.lattice != NULL) job->report.lattice = *job->options.fit.lattice;
    else BVXI_TRY(bvx_lattice_fit_with(job->ctx, job->mesh, &fit, &job->report.lattice));
    job->solid.word_capacity = bvx_grid_bound(&job->report.lattice, NULL);
    BVXI_TRY(BVXI_ARRAY(job->ctx, job->solid.word_capacity, "the voxels of the body", job->solid.words));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.5,
                        bvx_voxelize_solid(job->ctx, job->mesh, &job->report.lattice, &v, &job->solid)));
    BVXI_TRY(BVXI_SCOPE(job->ctx, drop_inspected_crumbs(job)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.5, 1.0, bvx_measure(job->ctx, job->mesh, &o, &m)));
    job->report.fill = filled.fill;
    job->report.volume = m.volume;
    job->report.volume_error = m.volume_error;
    job->report.mass = m.mass;
    return BVX_OK;
}

static const bvxi_option inspect_rows_of[] = {
    BVXI_RESERVED(bvx_inspect_options, fit.reserved),
    BVXI_OR(bvx_inspect_options, density, ABOVE, 1.0, 0.0, BVXI_FINITE),
    BVXI_REAL(bvx_inspect_options, walls, 0.0, HUGE_VAL),
    BVXI_REAL(bvx_inspect_options, gaps, 0.0, HUGE_VAL),
    BVXI_CHOICE(bvx_inspect_options, up, BVX_UP_Z, BVX_UP_Y),
    BVXI_OR(bvx_inspect_options, most, WHOLE, 8, 1, 1 << 20),
};

static bvx_status run_inspect(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_inspect_options *options,
                              bvx_inspect_report *report)
{
    inspect_job job = {.ctx = ctx, .function = inspect_name, .mesh = mesh};
    bvx_inspect_options *const o = &job.options;
    double low[3], high[3];

    if (report == NULL) return bvxi_fail_null(ctx, inspect_name, "report");
    memset(report, 0, sizeof *report);
    BVXI_TRY(bvxi_take_options(ctx, inspect_name, options, o, sizeof *o));
    BVXI_TRY(bvxi_check_options(ctx, inspect_name, o, BVXI_OPTIONS(inspect_rows_of)));
    BVXI_TRY(bvxi_check_fit(ctx, inspect_name, &o->fit));
    BVXI_TRY(bvxi_view_check(ctx, inspect_name, mesh));
    BVXI_TRY(bvxi_view_bounds(ctx, inspect_name, mesh, low, high));
    if (!(bvxi_view_area(mesh) > 0.0))
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: none of the mesh's %u triangles has an area", inspect_name,
                         mesh->triangle_count);

    job.scale = bvxi_unit_scale(low, high);
    job.off = INSPECT_OFF / job.scale;
    for (int a = 0; a < 3; a++)
        if ((high[a] - low[a]) * job.scale > job.longest) job.longest = (high[a] - low[a]) * job.scale;
    job.report.least_thickness = job.report.least_gap = HUGE_VAL;
    for (uint64_t v = 0; v < mesh->vertex_count && o->thickness != NULL; v++) o->thickness[v] = HUGE_VAL;

    double const *const spacing = job.report.lattice.spacing;

    BVXI_TRY(BVXI_SHARE(job.ctx, 0.0, 0.3, BVXI_SCOPE(job.ctx, judge_mesh(&job))));
    BVXI_TRY(BVXI_SHARE(job.ctx, 0.3, 0.5, fill_and_weigh(&job)));
    job.step = job.scale * (spacing[0] < spacing[1] ? spacing[0] : spacing[1]);
    if (job.scale * spacing[2] < job.step) job.step = job.scale * spacing[2];
    if (job.step < job.longest * INSPECT_STEP) job.step = job.longest * INSPECT_STEP;
    BVXI_TRY(BVXI_SHARE(job.ctx, 0.5, 0.9, measure_walls(&job)));
    for (int kind = BVX_FINDING_WALL; kind <= BVX_FINDING_GAP; kind++)
        BVXI_TRY(BVXI_SHARE(job.ctx, 0.9 + 0.02 * kind, 0.92 + 0.02 * kind,
                            BVXI_SCOPE(job.ctx, list_marks(&job, kind))));
    inspect_parts cavities = {.kind = BVX_FINDING_CAVITY, .axis = {0, 1, 2}, .grid = &job.solid};
    BVXI_TRY(
        BVXI_SHARE(job.ctx, 0.94, 0.96, BVXI_SCOPE(job.ctx, list_parts(&job, &cavities, BVXI_CONNECT_6))));
    BVXI_TRY(BVXI_SHARE(job.ctx, 0.96, 1.0, turn_and_list(&job)));

    *report = job.report;
    return BVX_OK;
}

bvx_status bvx_inspect(bvx_context *context, const bvx_mesh_view *mesh, const bvx_inspect_options *options,
                       bvx_inspect_report *report)
{
    return BVXI_CALL(context, run_inspect(context, mesh, options, report));
}
