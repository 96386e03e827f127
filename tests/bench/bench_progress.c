/* bench_progress.c - the share of the bar that each stage of a call has beside its share of the time.
 *
 *   bench_progress MESH_FOLDER [RESOLUTION [NAME]]   prints Markdown: rows that are off by more than three,
 *   then how many were measured;
 *                                                    with a NAME all rows of the jobs that begin so
 *
 * Processor time of one thread. A stage is what a call reports under one name; what passes from one report to
 * the next belongs to the former. Shares below a twentieth count as one. A call is off too where a quarter of
 * its bar takes more than three quarters of its time: there it seems to stand. Calls shorter than FEWEST_MS
 * are left out: nobody sees their bar.
 *
 * Short calls are made several times, for neighbours of the processor's caches only add to a time: of what
 * passes from one report to the next the shortest counts, and the call takes the sum of these. All calls
 * report the same fractions each time; one that did not would be counted as it was made last, and be named. */
#include "bench.h"

#include <stdlib.h>
#include <string.h>

#define FEWEST_MS   5.0
#define OFF_BY      3.0
#define SMALL_SHARE 0.05

/* A call is made again until it has been made so often, or has taken so long altogether. */
#define MOST_RUNS 5
#define ENOUGH_MS 300.0

enum { MOST_STAGES = 48, MOST_REPORTS = 1 << 16, QUARTERS = 4, VALUES_ROOM = 1 << 27 };

/* ---- what a call reports ---- */

typedef struct stage_share {
    char name[32];
    double bar, ms;
} stage_share;

/* A report, and what passed from it to the next one. */
typedef struct progress_report {
    double fraction, ms;
    int stage;
} progress_report;

static struct {
    stage_share stage[MOST_STAGES];
    int stages;
    progress_report report[MOST_REPORTS];
    int runs, reports, at; /* of this run the report that came last */
    int differ;            /* runs whose reports were not those of the first one */
    double ms;             /* when it came */
} seen;

static int stage_of(const char *name)
{
    for (int i = 0; i < seen.stages; i++)
        if (strncmp(seen.stage[i].name, name, sizeof seen.stage[i].name - 1) == 0) return i;
    if (seen.stages == MOST_STAGES) return MOST_STAGES - 1;
    snprintf(seen.stage[seen.stages].name, sizeof seen.stage[0].name, "%s", name);
    return seen.stages++;
}

/* What passed since the last report of this run. */
static void note_time(double now)
{
    progress_report *const last = &seen.report[seen.at];
    double const ms = now - seen.ms;

    if (seen.runs == 0 || ms < last->ms) last->ms = ms;
}

/* Of another fraction or stage than in the run before: what is known from here on is not of this call. */
static void note_next(int stage, double fraction)
{
    progress_report *const next = &seen.report[++seen.at];

    if (seen.runs != 0 && seen.at < seen.reports && next->stage == stage && next->fraction == fraction)
        return;
    seen.differ += seen.runs != 0;
    *next = (progress_report){.fraction = fraction, .ms = 1e300, .stage = stage};
    if (seen.at >= seen.reports) seen.reports = seen.at + 1;
}

static void begin_calls(void)
{
    memset(&seen, 0, sizeof seen);
    seen.report[0].stage = stage_of("(before)");
    seen.reports = 1;
}

static void begin_run(void)
{
    seen.at = 0;
    seen.ms = bench_clock(1);
}

static int32_t note_report(void *user, const char *stage, double fraction)
{
    (void)user;
    note_time(bench_clock(1));
    if (seen.at + 1 < MOST_REPORTS) note_next(stage_of(stage), fraction);
    seen.ms = bench_clock(1);
    return 0;
}

/* ---- jobs ---- */

static bvx_context *watched, *quiet;
static bvx_mesh input, moved, body, body_far;
static bvx_mesh_view view, moved_view, points, body_view;
static bvx_lattice lattice, base;
static bvx_grid solid, surface, other;
static bvx_octree *tree;
static bvx_field field;
static bvx_sections sections;
static bvx_volume_view volume;
static bvx_buffer ply, tree_file, grid_file, section_file, volume_file;
static bvx_image picture;
static uint32_t *values;
static int32_t resolution;

static bvx_grid grid_out;
static bvx_mesh mesh_out[3];
static bvx_buffer buffer_out;
static bvx_octree *tree_out;
static bvx_field field_out;
static bvx_sections sections_out;
static bvx_image image_out;
static bvx_volume volume_out;
static bvx_closest *closest_out;

static void free_outputs(void)
{
    bvx_grid_free(quiet, &grid_out);
    for (int i = 0; i < 3; i++) bvx_mesh_free(quiet, &mesh_out[i]);
    bvx_buffer_free(quiet, &buffer_out);
    bvx_octree_free(quiet, tree_out);
    tree_out = NULL;
    bvx_field_free(quiet, &field_out);
    bvx_sections_free(quiet, &sections_out);
    bvx_image_free(quiet, &image_out);
    bvx_volume_free(quiet, &volume_out);
    bvx_closest_free(quiet, closest_out);
    closest_out = NULL;
}

#define JOB(name) static bvx_status name(bvx_context *ctx)
#define OPTIONS(kind)       \
    bvx_##kind##_options o; \
    bvx_##kind##_options_init(&o, sizeof o)

JOB(job_check)
{
    bvx_certificate c;
    return bvx_mesh_check(ctx, &view, 1, &c);
}
JOB(job_crossings)
{
    uint64_t n;
    return bvx_mesh_crossings(ctx, &view, &n, NULL, 0);
}
JOB(job_normals)
{
    return bvx_mesh_normals(ctx, &view, 1, (float *)values, NULL);
}
JOB(job_distance)
{
    bvx_distance_report r;
    return bvx_mesh_distance(ctx, &view, &body_view, 20000, 1, &r);
}
JOB(job_closest)
{
    return bvx_closest_create(ctx, &view, &closest_out);
}
JOB(job_read_mesh)
{
    return bvx_read_mesh(ctx, ply.bytes, ply.size, BVX_FORMAT_PLY, mesh_out);
}
JOB(job_write_ply)
{
    return bvx_write_mesh(ctx, &input, BVX_FORMAT_PLY, &buffer_out);
}
JOB(job_write_obj)
{
    return bvx_write_mesh(ctx, &input, BVX_FORMAT_OBJ, &buffer_out);
}
JOB(job_write_glb)
{
    return bvx_write_mesh(ctx, &input, BVX_FORMAT_GLB, &buffer_out);
}
JOB(job_write_levels)
{
    return bvx_write_levels(ctx, &input, 1, NULL, BVX_FORMAT_GLB, &buffer_out);
}
JOB(job_check_written)
{
    bvx_write_report r;
    return bvx_check_written(ctx, &input, 1, NULL, BVX_FORMAT_STL, &r);
}

static bvx_status solid_by(bvx_context *ctx, int32_t fill, int32_t more)
{
    OPTIONS(voxelize);
    o.fill = fill;
    o.add_shell = o.check_edges = more;
    return bvx_voxelize_solid(ctx, &view, &lattice, &o, &grid_out);
}
JOB(job_solid_auto)
{
    return solid_by(ctx, BVX_FILL_AUTO, 0);
}
JOB(job_solid_all)
{
    return solid_by(ctx, BVX_FILL_AUTO, 1);
}
JOB(job_solid_parity)
{
    return solid_by(ctx, BVX_FILL_PARITY, 0);
}
JOB(job_solid_nonzero)
{
    return solid_by(ctx, BVX_FILL_NONZERO, 0);
}
JOB(job_solid_vote)
{
    return solid_by(ctx, BVX_FILL_VOTE, 0);
}
JOB(job_solid_flood)
{
    return solid_by(ctx, BVX_FILL_FLOOD, 0);
}
JOB(job_solid_regions)
{
    return solid_by(ctx, BVX_FILL_REGIONS, 0);
}
JOB(job_solid_winding)
{
    return solid_by(ctx, BVX_FILL_WINDING, 0);
}
JOB(job_compare_fills)
{
    bvx_fill_comparison c;
    return bvx_compare_fills(ctx, &view, &lattice, NULL, &c);
}

static bvx_status surface_by(bvx_context *ctx, int32_t mode)
{
    OPTIONS(surface);
    o.mode = mode;
    return bvx_voxelize_surface(ctx, &view, &lattice, &o, &grid_out);
}
JOB(job_conservative)
{
    return surface_by(ctx, BVX_SURFACE_CONSERVATIVE);
}
JOB(job_thin)
{
    return surface_by(ctx, BVX_SURFACE_THIN);
}
JOB(job_sampled)
{
    return surface_by(ctx, BVX_SURFACE_SAMPLED);
}
JOB(job_points)
{
    return bvx_voxelize_points(ctx, &points, &lattice, NULL, &grid_out);
}

JOB(job_find_seed)
{
    bvx_seed s;
    return bvx_find_seed(ctx, &surface, NULL, 0, &s);
}
JOB(job_find_pockets)
{
    uint64_t n;
    return bvx_find_pockets(ctx, &surface, NULL, NULL, 0, &n);
}
JOB(job_grid_fill)
{
    static const int32_t corner[3];
    return bvx_grid_fill(ctx, &surface, corner, 1, 6, &grid_out);
}
JOB(job_union)
{
    return bvx_grid_union(ctx, &solid, &other, &grid_out);
}
JOB(job_resample)
{
    return bvx_grid_resample(ctx, &other, &lattice, NULL, &grid_out);
}
JOB(job_permute)
{
    static const int32_t axes[3] = {2, 1, 0};
    return bvx_grid_permute(ctx, &solid, axes, NULL, &grid_out);
}
JOB(job_compare)
{
    bvx_grid_difference d;
    return bvx_grid_compare(ctx, &solid, &other, &d);
}

static bvx_status morph_by(bvx_context *ctx, double radius, int32_t steps,
                           bvx_status (*call)(bvx_context *, const bvx_grid *, const bvx_morph_options *,
                                              bvx_grid *))
{
    OPTIONS(morph);
    if (steps == 0) {
        o.neighbourhood = 0;
        o.radius = radius * lattice.spacing[0];
    } else {
        o.steps = steps;
    }
    return call(ctx, &solid, &o, &grid_out);
}
JOB(job_dilate_6)
{
    return morph_by(ctx, 0, 5, bvx_grid_dilate);
}
JOB(job_dilate_ball)
{
    return morph_by(ctx, 5, 0, bvx_grid_dilate);
}
JOB(job_close_6)
{
    return morph_by(ctx, 0, 5, bvx_grid_close);
}
JOB(job_close_ball)
{
    return morph_by(ctx, 5, 0, bvx_grid_close);
}
JOB(job_hollow)
{
    OPTIONS(hollow);
    o.thickness = 4 * lattice.spacing[0];
    return bvx_grid_hollow(ctx, &solid, &o, &grid_out);
}
JOB(job_grid_distance)
{
    return bvx_grid_distance(ctx, &solid, NULL, BVX_F32, values, VALUES_ROOM);
}

static bvx_status refine_to(bvx_context *ctx, int32_t levels, double tolerance)
{
    OPTIONS(refine);
    o.levels = levels;
    o.tolerance = tolerance;
    return bvx_refine(ctx, &view, &base, &o, &tree_out);
}
static int32_t halvings(void)
{
    int32_t n = 0;
    while (16 << (n + 1) <= resolution) n++;
    return n;
}
JOB(job_refine)
{
    return refine_to(ctx, halvings(), 0.0);
}
JOB(job_refine_adaptive)
{
    return refine_to(ctx, halvings(), 0.2 * lattice.spacing[0]);
}
JOB(job_octree_expand)
{
    return bvx_octree_expand(ctx, tree, bvx_octree_levels(tree), 0, NULL, &grid_out);
}
JOB(job_extract_octree)
{
    return bvx_extract_octree(ctx, tree, 0, NULL, mesh_out);
}
JOB(job_write_octree)
{
    return bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &buffer_out);
}
JOB(job_write_vtu)
{
    return bvx_write_octree(ctx, tree, 0, BVX_FORMAT_VTU, &buffer_out);
}
JOB(job_read_octree)
{
    return bvx_read_octree(ctx, tree_file.bytes, tree_file.size, &tree_out);
}

JOB(job_components)
{
    uint64_t n;
    return bvx_grid_components(ctx, &solid, 6, NULL, 0, &n);
}
JOB(job_label)
{
    uint64_t n;
    return bvx_grid_label(ctx, &solid, 26, values, VALUES_ROOM, &n);
}
JOB(job_keep)
{
    OPTIONS(keep);
    o.at_least = 2;
    return bvx_grid_keep(ctx, &solid, &o, &grid_out);
}
JOB(job_fill_cavities)
{
    uint64_t n;
    return bvx_grid_fill_cavities(ctx, &solid, 6, 0, &grid_out, &n);
}
JOB(job_topology)
{
    bvx_topology t;
    return bvx_grid_topology(ctx, &solid, 6, &t);
}

JOB(job_extract_surface)
{
    return bvx_extract_surface(ctx, &solid, NULL, mesh_out);
}
JOB(job_extract_faces)
{
    return bvx_extract_faces(ctx, &solid, NULL, mesh_out);
}
JOB(job_faces_merged)
{
    OPTIONS(faces);
    o.merged = 1;
    return bvx_extract_faces(ctx, &solid, &o, mesh_out);
}
JOB(job_threshold)
{
    return bvx_threshold(ctx, &volume, 0, 10, NULL, &grid_out);
}
JOB(job_scalar)
{
    OPTIONS(scalar);
    o.level = 0.5 * lattice.spacing[0];
    return bvx_extract_scalar(ctx, &volume, &o, mesh_out);
}
JOB(job_read_volume)
{
    return bvx_read_volume(ctx, volume_file.bytes, volume_file.size, BVX_FORMAT_NRRD, NULL, &volume_out);
}

JOB(job_field)
{
    return bvx_measure_field(ctx, &view, &lattice, NULL, &field_out);
}
static bvx_status field_by(bvx_context *ctx, int32_t sign)
{
    OPTIONS(field);
    o.sign = sign;
    return bvx_measure_field(ctx, &view, &lattice, &o, &field_out);
}
JOB(job_field_none)
{
    return field_by(ctx, BVX_SIGN_NONE);
}
JOB(job_field_pseudonormal)
{
    return field_by(ctx, BVX_SIGN_PSEUDONORMAL);
}
JOB(job_field_dense)
{
    return bvx_field_dense(ctx, &field, &view, BVX_FAR_CONSTANT, 0, (float *)values);
}
JOB(job_field_surface)
{
    return bvx_extract_field_surface(ctx, &field, &view, NULL, mesh_out);
}
JOB(job_field_surface_sharp)
{
    OPTIONS(field_surface);
    o.sharp = 1;
    return bvx_extract_field_surface(ctx, &field, &view, &o, mesh_out);
}
JOB(job_write_field)
{
    return bvx_write_field(ctx, &field, 0, BVX_FORMAT_NRRD, &buffer_out);
}

static bvx_status boolean_of(bvx_context *ctx, int32_t operation, int32_t sharp)
{
    OPTIONS(boolean);
    o.resolution = resolution;
    o.sharp = sharp;
    return bvx_boolean(ctx, &view, &moved_view, operation, &o, mesh_out);
}
JOB(job_boolean_union)
{
    return boolean_of(ctx, BVX_BOOLEAN_UNION, 0);
}
JOB(job_boolean_difference)
{
    return boolean_of(ctx, BVX_BOOLEAN_DIFFERENCE, 0);
}
JOB(job_boolean_sharp)
{
    return boolean_of(ctx, BVX_BOOLEAN_UNION, 1);
}

JOB(job_lods)
{
    static int32_t each[3];
    OPTIONS(lod);
    for (int i = 0; i < 3; i++) each[i] = resolution >> (i + 1);
    o.resolutions = each;
    return bvx_build_lods(ctx, &solid, &o, 3, mesh_out);
}
JOB(job_slice)
{
    OPTIONS(slice);
    o.spacing = 4 * lattice.spacing[0];
    return bvx_slice_mesh(ctx, &view, &o, &sections_out);
}
JOB(job_sections)
{
    return bvx_build_sections(ctx, &sections, NULL, mesh_out);
}
JOB(job_sections_mend)
{
    OPTIONS(sections);
    o.mend = 1;
    return bvx_build_sections(ctx, &sections, &o, mesh_out);
}
JOB(job_write_sections)
{
    return bvx_write_sections(ctx, &sections, BVX_FORMAT_CSL, &buffer_out);
}
JOB(job_read_sections)
{
    return bvx_read_sections(ctx, section_file.bytes, section_file.size, BVX_FORMAT_CSL, NULL, &sections_out);
}

static bvx_status repair_by(bvx_context *ctx, int32_t sharp, int32_t measure, uint64_t target,
                            int32_t if_needed)
{
    bvx_repair_report r;

    OPTIONS(repair);
    o.resolution = resolution;
    o.sharp = sharp;
    o.measure = measure;
    o.target_triangles = target;
    o.if_needed = if_needed;
    o.report = &r;
    return bvx_repair(ctx, &view, &o, mesh_out);
}
JOB(job_repair)
{
    return repair_by(ctx, -1, 0, 0, 0);
}
JOB(job_repair_sharp)
{
    return repair_by(ctx, 1, 0, 0, 0);
}
JOB(job_repair_measured)
{
    return repair_by(ctx, 0, 1, 0, 0);
}
JOB(job_repair_target)
{
    return repair_by(ctx, 0, 0, 5000, 0);
}
JOB(job_repair_if_needed)
{
    return repair_by(ctx, 0, 0, 0, 1);
}

JOB(job_simplify)
{
    OPTIONS(simplify);
    return bvx_mesh_simplify(ctx, &body_view, &o, 1, mesh_out);
}
JOB(job_simplify_chain)
{
    static uint64_t target[3];
    OPTIONS(simplify);
    for (int i = 0; i < 3; i++) target[i] = body_view.triangle_count >> (2 * i + 1);
    o.target_triangles = target;
    o.measure_samples = 20000;
    return bvx_mesh_simplify(ctx, &body_view, &o, 3, mesh_out);
}
JOB(job_simplify_error)
{
    static double error[1];
    OPTIONS(simplify);
    error[0] = 0.2 * lattice.spacing[0];
    o.target_errors = error;
    return bvx_mesh_simplify(ctx, &body_view, &o, 1, mesh_out);
}
JOB(job_levels)
{
    return bvx_build_levels(ctx, &view, NULL, 3, mesh_out);
}
JOB(job_levels_measured)
{
    OPTIONS(levels);
    o.solid = 1;
    o.resolution = resolution;
    return bvx_build_levels(ctx, &view, &o, 3, mesh_out);
}
JOB(job_write_grid)
{
    return bvx_write_grid(ctx, &solid, BVX_FORMAT_VTI, &buffer_out);
}
JOB(job_read_grid)
{
    return bvx_read_grid(ctx, grid_file.bytes, grid_file.size, BVX_FORMAT_NRRD, NULL, &grid_out);
}
JOB(job_merge)
{
    bvx_mesh const both[2] = {body, body_far};
    return bvx_mesh_merge(ctx, both, 2, mesh_out);
}
JOB(job_render_mesh)
{
    OPTIONS(render);
    o.width = o.height = 800;
    return bvx_render_mesh(ctx, &view, &o, &image_out);
}
JOB(job_render_grid)
{
    OPTIONS(render);
    o.width = o.height = 800;
    return bvx_render_grid(ctx, &solid, &o, &image_out);
}
JOB(job_render_slices)
{
    OPTIONS(render);
    o.width = o.height = 800;
    return bvx_render_slices(ctx, &solid, 2, 9, &o, &image_out);
}
JOB(job_write_png)
{
    return bvx_write_png(ctx, &picture, &buffer_out);
}

#define ROW(name)         \
    {                     \
#name, job_##name \
    }
static const struct {
    const char *name;
    bvx_status (*run)(bvx_context *ctx);
} jobs[] = {
    ROW(check),
    ROW(crossings),
    ROW(normals),
    ROW(distance),
    ROW(closest),
    ROW(read_mesh),
    ROW(write_ply),
    ROW(write_obj),
    ROW(write_glb),
    ROW(write_levels),
    ROW(check_written),
    ROW(solid_auto),
    ROW(solid_all),
    ROW(solid_parity),
    ROW(solid_nonzero),
    ROW(solid_vote),
    ROW(solid_flood),
    ROW(solid_regions),
    ROW(solid_winding),
    ROW(compare_fills),
    ROW(conservative),
    ROW(thin),
    ROW(sampled),
    ROW(points),
    ROW(find_seed),
    ROW(find_pockets),
    ROW(grid_fill),
    ROW(union),
    ROW(resample),
    ROW(permute),
    ROW(compare),
    ROW(dilate_6),
    ROW(dilate_ball),
    ROW(close_6),
    ROW(close_ball),
    ROW(hollow),
    ROW(grid_distance),
    ROW(refine),
    ROW(refine_adaptive),
    ROW(octree_expand),
    ROW(extract_octree),
    ROW(write_octree),
    ROW(write_vtu),
    ROW(read_octree),
    ROW(components),
    ROW(label),
    ROW(keep),
    ROW(fill_cavities),
    ROW(topology),
    ROW(extract_surface),
    ROW(extract_faces),
    ROW(faces_merged),
    ROW(threshold),
    ROW(scalar),
    ROW(read_volume),
    ROW(field),
    ROW(field_none),
    ROW(field_pseudonormal),
    ROW(field_dense),
    ROW(field_surface),
    ROW(field_surface_sharp),
    ROW(write_field),
    ROW(boolean_union),
    ROW(boolean_difference),
    ROW(boolean_sharp),
    ROW(lods),
    ROW(slice),
    ROW(sections),
    ROW(sections_mend),
    ROW(write_sections),
    ROW(read_sections),
    ROW(repair),
    ROW(repair_sharp),
    ROW(repair_measured),
    ROW(repair_target),
    ROW(repair_if_needed),
    ROW(simplify),
    ROW(simplify_chain),
    ROW(simplify_error),
    ROW(levels),
    ROW(levels_measured),
    ROW(write_grid),
    ROW(read_grid),
    ROW(merge),
    ROW(render_mesh),
    ROW(render_grid),
    ROW(render_slices),
    ROW(write_png),
};
enum { JOBS = sizeof jobs / sizeof jobs[0] };

/* ---- what they are made of ---- */

#define MADE(call) bench_try(quiet, call, #call)

static void move_input(void)
{
    MADE(bvx_read_mesh(quiet, ply.bytes, ply.size, BVX_FORMAT_PLY, &moved));
    for (uint64_t v = 0; v < moved.vertex_count * 3; v++) {
        double const by = v % 3 == 0 ? 5.3 * lattice.spacing[0] : 0.0;

        if (moved.position_type == BVX_F64) ((double *)moved.positions)[v] += by;
        else ((float *)moved.positions)[v] += (float)by;
    }
    bvx_mesh_view_of(&moved, &moved_view);
}

static void make_stage(void)
{
    bvx_surface_options s;
    bvx_refine_options r;
    bvx_slice_options l;
    bvx_render_options p;
    bvx_extract_options e;

    MADE(bvx_write_mesh(quiet, &input, BVX_FORMAT_PLY, &ply));
    bvx_mesh_view_of(&input, &view);
    points = view;
    points.indices = NULL;
    points.triangle_count = 0;
    MADE(bvx_lattice_fit(quiet, &view, resolution, &lattice));
    MADE(bvx_lattice_fit(quiet, &view, 16, &base));
    move_input();
    MADE(bvx_voxelize_solid(quiet, &view, &lattice, NULL, &solid));
    MADE(bvx_voxelize_solid(quiet, &moved_view, &lattice, NULL, &other));
    bvx_surface_options_init(&s, sizeof s);
    MADE(bvx_voxelize_surface(quiet, &view, &lattice, &s, &surface));
    bvx_refine_options_init(&r, sizeof r);
    r.levels = halvings();
    MADE(bvx_refine(quiet, &view, &base, &r, &tree));
    MADE(bvx_measure_field(quiet, &view, &lattice, NULL, &field));
    bvx_slice_options_init(&l, sizeof l);
    l.spacing = 8 * lattice.spacing[0];
    MADE(bvx_grid_distance(quiet, &solid, NULL, BVX_F32, values, VALUES_ROOM));
    memset(&volume, 0, sizeof volume);
    volume.samples = values;
    volume.sample_type = BVX_SAMPLE_F32;
    volume.lattice = solid.lattice;
    for (int a = 0; a < 3; a++) volume.size[a] = solid.size[a];
    MADE(bvx_write_field(quiet, &field, 0, BVX_FORMAT_NRRD, &volume_file));
    MADE(bvx_write_octree(quiet, tree, 0, BVX_FORMAT_BVX, &tree_file));
    MADE(bvx_write_grid(quiet, &solid, BVX_FORMAT_NRRD, &grid_file));
    bvx_render_options_init(&p, sizeof p);
    p.width = p.height = 800;
    MADE(bvx_render_mesh(quiet, &view, &p, &picture));
    bvx_extract_options_init(&e, sizeof e);
    e.keys = 1;
    e.position_type = BVX_POSITION_AUTO; /* the terrain lies far off */
    MADE(bvx_extract_surface(quiet, &solid, &e, &body));
    MADE(bvx_extract_surface(quiet, &solid, &e, &body_far));
    bvx_mesh_view_of(&body, &body_view);
    /* holes */
    if (bvx_slice_mesh(quiet, &view, &l, &sections) != BVX_OK)
        MADE(bvx_slice_mesh(quiet, &body_view, &l, &sections));
    MADE(bvx_write_sections(quiet, &sections, BVX_FORMAT_CSL, &section_file));
}

static void free_stage(void)
{
    bvx_buffer_free(quiet, &ply);
    bvx_buffer_free(quiet, &tree_file);
    bvx_buffer_free(quiet, &grid_file);
    bvx_buffer_free(quiet, &section_file);
    bvx_buffer_free(quiet, &volume_file);
    bvx_image_free(quiet, &picture);
    bvx_mesh_free(quiet, &input);
    bvx_mesh_free(quiet, &moved);
    bvx_mesh_free(quiet, &body);
    bvx_mesh_free(quiet, &body_far);
    bvx_grid_free(quiet, &solid);
    bvx_grid_free(quiet, &surface);
    bvx_grid_free(quiet, &other);
    bvx_octree_free(quiet, tree);
    tree = NULL;
    bvx_field_free(quiet, &field);
    bvx_sections_free(quiet, &sections);
}

/* ---- judging ---- */

static int measured, off;

static double ratio(double a, double b)
{
    if (a < SMALL_SHARE) a = SMALL_SHARE;
    if (b < SMALL_SHARE) b = SMALL_SHARE;
    return a > b ? a / b : b / a;
}

/* Sums the reports into stages and quarters; returns the time of the whole. */
static double sum_reports(double quarter[QUARTERS])
{
    double whole = 0.0;

    memset(quarter, 0, QUARTERS * sizeof *quarter);
    /* Nothing follows the last report, which ends the call. */
    for (int i = 0; i + 1 < seen.reports; i++) {
        const progress_report *const r = &seen.report[i];
        double const from = r->fraction, to = r[1].fraction;

        seen.stage[r->stage].bar += to - from;
        seen.stage[r->stage].ms += r->ms;
        whole += r->ms;
        /* Within one report the bar stands where the time cannot be told: it is taken as even. */
        for (int q = 0; q < QUARTERS; q++) {
            double const low = (double)q / QUARTERS, high = (q + 1.0) / QUARTERS;
            double const begin = from > low ? from : low, end = to < high ? to : high;

            if (to <= from) quarter[q] += from >= low && from < high ? r->ms : 0.0;
            else if (end > begin) quarter[q] += r->ms * ((end - begin) / (to - from));
        }
    }
    return whole;
}

static void judge(const char *file, const char *job, int all)
{
    double quarter[QUARTERS], worst = 1.0;
    double const whole = sum_reports(quarter);
    char quarters[80] = "";
    int is_off = 0;

    if (whole < FEWEST_MS) return;
    measured++;
    if (seen.differ != 0) printf("%s, %s: not the same reports each time\n", file, job);
    for (int q = 0; q < QUARTERS; q++) {
        double const share = quarter[q] / whole;

        snprintf(quarters + strlen(quarters), sizeof quarters - strlen(quarters), "%s%.2f", q ? " " : "",
                 share);
        is_off |= share > OFF_BY / QUARTERS;
    }
    for (int i = 0; i < seen.stages; i++) {
        double const r = ratio(seen.stage[i].bar, seen.stage[i].ms / whole);

        if (r > worst) worst = r;
    }
    is_off |= worst > OFF_BY;
    off += is_off;
    if (!is_off && !all) return;
    printf("| %s | %d | %s | %.0f | %s | %.1f |", file, (int)resolution, job, whole, quarters, worst);
    for (int i = 0; i < seen.stages; i++) {
        double const share = seen.stage[i].ms / whole;

        if (share < 0.01 && seen.stage[i].bar < 0.01) continue;
        printf(" %s %.2f/%.2f%s", seen.stage[i].name, seen.stage[i].bar, share,
               ratio(seen.stage[i].bar, share) > OFF_BY ? "!" : "");
    }
    printf(" |%s\n", is_off ? " off" : "");
    fflush(stdout);
}

/* Nothing but the first of several calls is special: outputs are freed after each. */
static bvx_status run_job(int j)
{
    bvx_status status = BVX_OK;
    double spent = 0.0;

    begin_calls();
    while (status == BVX_OK && seen.runs < MOST_RUNS && spent < ENOUGH_MS) {
        double const begin = bench_clock(1);

        begin_run();
        status = jobs[j].run(watched);
        spent += bench_clock(1) - begin;
        seen.runs++;
        free_outputs();
    }
    return status;
}

static void measure_file(const char *folder, const char *file, const char *only)
{
    char path[1200];

    snprintf(path, sizeof path, "%s/%s", folder, file);
    if (!bench_read_mesh(quiet, path, &input)) return;
    make_stage();
    for (int j = 0; j < JOBS; j++) {
        bvx_status status;

        if (only != NULL && strncmp(jobs[j].name, only, strlen(only)) != 0) continue;
        status = run_job(j);
        if (status == BVX_OK) judge(file, jobs[j].name, only != NULL);
        else if (status == BVX_ERR_CAPACITY)
            fprintf(stderr, "bench: %s: %s\n", jobs[j].name, bvx_last_message(watched));
    }
    free_stage();
}

int main(int argc, char **argv)
{
    static const char *const files[] = {"dragon_100k.obj.gz",
                                        "bunny_scan_69451.ply.gz",
                                        "fandisk.obj.gz",
                                        "cow.obj.gz",
                                        "chair_model.obj.gz",
                                        "dungeon.obj.gz",
                                        "elephant-with-holes.off.gz",
                                        "stratocaster.ply.gz",
                                        "gears.stl.gz",
                                        "rocker-arm.obj.gz",
                                        "unit_sphere.stl.gz",
                                        "blobby-shuffled.off.gz",
                                        "thingi_72214.stl.gz",
                                        "terrain_turbineSiting.stl.gz"};
    bvx_context_options o;

    if (argc < 2) return 2;
    bvx_context_options_init(&o, sizeof o);
    o.threads = 1;
    bench_try(NULL, bvx_context_create(&o, &quiet), "context");
    o.progress = note_report;
    bench_try(NULL, bvx_context_create(&o, &watched), "context");
    values = malloc(sizeof *values * VALUES_ROOM);
    if (values == NULL) return 1;

    puts(
        "| mesh | resolution | call | ms | time of each quarter of the bar | worst stage | stages: bar/time |\n|---|--:|---|--:|---|--:|---|");
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) {
        for (resolution = 48; resolution <= 192; resolution *= 2) {
            if (argc > 2 && atoi(argv[2]) != 0 && atoi(argv[2]) != resolution) continue;
            measure_file(argv[1], files[i], argc > 3 ? argv[3] : NULL);
        }
    }
    printf("\n%d calls measured, %d off by more than three\n", measured, off);
    free(values);
    bvx_context_destroy(watched);
    bvx_context_destroy(quiet);
    return 0;
}
