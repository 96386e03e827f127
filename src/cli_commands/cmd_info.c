/* cmd_info.c - bitvox info: what a mesh, a grid or an octree is. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

typedef struct info_options {
    int32_t count_crossings; /* of meshes */
    int32_t measure;         /* likewise */
    bvx_measure_options mass;
} info_options;

#define OWN(name) CLI_OWN(info_options, name)

static const cli_argument info_rows[] = {
    {.also = cli_takes_raw},
    FLAG("--crossings", OWN(count_crossings),
         "also count the pairs of triangles that cross or touch beyond what they\n"
         "share; of meshes"),
    FLAG("--measure", OWN(measure),
         "also measure the body: volume, mass, center of mass and inertia\n"
         "with bounds of their errors, and the lines for MJCF and URDF; of\n"
         "meshes, also open, torn and flipped ones"),
    FROM_TO("--density", "D", OWN(mass.density), 1e-300, 1e300,
            "with --measure: mass of a unit of volume [1]"),
    WHOLE("--resolution", "N", OWN(mass.resolution), 1, 2048,
          "with --measure: voxels along each axis, of bodies that cannot be\n"
          "summed up exactly [128]"),
    {.also = cli_takes_all},
    {0}};

/* The option that only meshes have, or NULL. */
static const char *of_meshes(const info_options *own)
{
    return own->count_crossings ? "--crossings" : own->measure ? "--measure" : NULL;
}

typedef struct info_job {
    cli_input in;
    bvx_certificate certificate, welded;
} info_job;

static const char *yes_or_no(int v)
{
    return v ? "yes" : "no";
}

static void tell_certificate(cli_made *made, const bvx_certificate *c)
{
    cli_tell(made, "  triangles   %" PRIu64 " of %" PRIu64 " vertices and %" PRIu64 " edges\n", c->triangles,
             c->vertices, c->edges);
    if (c->unused_vertices != 0) cli_tell(made, "  unused      %" PRIu64 " vertices\n", c->unused_vertices);
    if (c->collapsed + c->degenerate + c->duplicates != 0)
        cli_tell(made,
                 "  beside      %" PRIu64 " collapsed, %" PRIu64 " without area, %" PRIu64
                 " duplicate triangles\n",
                 c->collapsed, c->degenerate, c->duplicates);
    cli_tell_box(made, c->box.low, c->box.high);
    cli_tell(made, "  closed      %s", yes_or_no(c->closed));
    if (c->boundary_edges != 0) cli_tell(made, ", %" PRIu64 " boundary edges", c->boundary_edges);
    cli_tell(made, "\n  manifold    %s", yes_or_no(c->edge_manifold && c->vertex_manifold));
    if (c->nonmanifold_edges + c->nonmanifold_vertices != 0)
        cli_tell(made, ", %" PRIu64 " edges and %" PRIu64 " vertices are not", c->nonmanifold_edges,
                 c->nonmanifold_vertices);
    cli_tell(made, "\n  oriented    %s", yes_or_no(c->oriented));
    if (c->flipped_edges != 0)
        cli_tell(made, ", %" PRIu64 " edges between triangles of opposite sense", c->flipped_edges);
    if (c->closed && c->oriented && c->volume < 0) cli_tell(made, ", inside out");
    cli_tell(made, "\n  components  %" PRIu64 ", Euler number %" PRId64 "\n", c->components, c->euler);
    cli_tell(made, "  volume      %.9g%s\n  area        %.9g\n", c->volume,
             c->closed ? "" : " (of an open mesh: depends on its position)", c->area);
}

static int check(cli_run *run, const bvx_mesh *mesh, int weld, bvx_certificate *c)
{
    bvx_mesh_view const view = cli_view(mesh);
    cli_stage_begin(run, weld ? "check welded" : "check");
    return cli_stage_check(run, bvx_mesh_check(run->context, &view, weld, c), cli_first_name(run));
}

static int count_crossings(cli_run *run, const bvx_mesh *mesh, cli_mesh_entry *entry)
{
    const info_options *const own = run->own;
    /* It takes longer than all the rest together, so it is done on request only. */
    if (!own->count_crossings) return CLI_DONE;
    bvx_mesh_view const view = cli_view(mesh);
    CLI_TRY(CLI_STAGE(run, "crossings", bvx_mesh_crossings(run->context, &view, &entry->crossings, NULL, 0),
                      cli_first_name(run)));
    entry->has_crossings = 1;
    return CLI_DONE;
}

static void report_measure(const bvx_measure_report *r, const char *mjcf, const char *urdf, cli_text *t)
{
    cli_text_add(t, ", \"mass\": {\"fill\": \"%s\"", cli_fill_names[r->fill]);
    cli_json_value(t, "volume", r->volume);
    cli_json_value(t, "volume_error", r->volume_error);
    cli_json_value(t, "area", r->area);
    cli_json_value(t, "mass", r->mass);
    cli_json_triple(t, "center", r->center);
    cli_json_value(t, "center_error", r->center_error);
    cli_json_key(t, "inertia", 0);
    for (int k = 0; k < 6; k++) {
        cli_text_add(t, k == 0 ? "[" : ", ");
        cli_json_number(t, r->inertia[k]);
    }
    cli_text_add(t, "]");
    cli_json_value(t, "inertia_error", r->inertia_error);
    cli_json_count(t, "resolution", (uint64_t)r->resolution);
    cli_json_count(t, "turned", r->turned);
    cli_json_key(t, "mjcf", 0);
    cli_json_string(t, mjcf);
    cli_json_key(t, "urdf", 0);
    cli_json_string(t, urdf);
    cli_text_add(t, "}");
}

static int measure(cli_run *run, const bvx_mesh *mesh, cli_made *made)
{
    info_options *const own = run->own;
    bvx_measure_report r;
    if (!own->measure) return CLI_DONE;
    own->mass.struct_size = sizeof own->mass;
    bvx_mesh_view const view = cli_view(mesh);
    CLI_TRY(CLI_STAGE(run, "measure", bvx_measure(run->context, &view, &own->mass, &r), cli_first_name(run)));
    const double *const c = r.center, *const i = r.inertia;
    cli_text mjcf = {0}, urdf = {0};

    /* The element of MuJoCo's models, then that of robots in ROS. */
    static const char *const names[6] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    cli_text_add(&mjcf,
                 "<inertial pos=\"%.10g %.10g %.10g\" mass=\"%.10g\" "
                 "fullinertia=\"%.10g %.10g %.10g %.10g %.10g %.10g\"/>",
                 c[0], c[1], c[2], r.mass, i[0], i[1], i[2], i[3], i[4], i[5]);
    cli_text_add(&urdf, "<inertial><origin xyz=\"%.10g %.10g %.10g\"/><mass value=\"%.10g\"/><inertia", c[0],
                 c[1], c[2], r.mass);
    for (int k = 0; k < 6; k++) cli_text_add(&urdf, " %s=\"%.10g\"", names[k], i[k]);
    cli_text_add(&urdf, "/></inertial>");

    if (r.resolution == 0) cli_tell(made, "  body        summed up over its triangles");
    else
        cli_tell(made, "  body        filled by the rule %s, %" PRId32 " voxels along each axis",
                 cli_fill_names[r.fill], r.resolution);
    if (r.turned != 0) cli_tell(made, ", %" PRIu64 " triangles turned", r.turned);
    cli_tell(made, "\n  encloses    %.10g, at most %.3g off\n  mass        %.10g\n", r.volume, r.volume_error,
             r.mass);
    cli_tell(made, "  center      %.10g, %.10g, %.10g, at most %.3g off\n", c[0], c[1], c[2], r.center_error);
    cli_tell(made, "  inertia     xx %.10g, yy %.10g, zz %.10g,\n", i[0], i[1], i[2]);
    cli_tell(made, "              xy %.10g, xz %.10g, yz %.10g, at most %.3g off\n", i[3], i[4], i[5],
             r.inertia_error);
    cli_tell(made, "  MJCF        %s\n  URDF        %s\n", mjcf.bytes, urdf.bytes);
    report_measure(&r, mjcf.bytes, urdf.bytes, &made->members);
    cli_text_free(&mjcf);
    cli_text_free(&urdf);
    return CLI_DONE;
}

static int info_of_mesh(cli_run *run, info_job *job, cli_made *made)
{
    const bvx_mesh *const mesh = &job->in.mesh;
    cli_mesh_entry *const entry = &run->report.mesh[0];
    int const stl = cli_input_format(run, run->options->input[0]) == BVX_FORMAT_STL;

    /* STL has no indices. Many other files repeat a vertex where colours or normals change: then the surface is
     * closed although the indices are not. */
    CLI_TRY(check(run, mesh, stl, &job->certificate));
    int const again = !stl && !job->certificate.closed;
    if (again) CLI_TRY(check(run, mesh, 1, &job->welded));
    int const differs = again && job->welded.vertices != job->certificate.vertices;
    CLI_TRY(count_crossings(run, mesh, entry));
    entry->path = run->options->input[0];
    entry->certificate = job->certificate;
    entry->welded = differs ? &job->welded : NULL;
    entry->colours = mesh->colours != NULL;
    entry->uvs = mesh->uvs != NULL;
    run->report.meshes = 1;
    /* Of the file and not of the certificate, which knows only what is left. */
    if (run->report.nonfinite != 0)
        cli_tell(made, "  left out    %" PRIu64 " triangle%s with a corner that is not finite\n",
                 run->report.nonfinite, run->report.nonfinite == 1 ? "" : "s");
    tell_certificate(made, &job->certificate);
    if (mesh->colours != NULL) cli_tell(made, "  colours     of vertices\n");
    if (mesh->normals != NULL) cli_tell(made, "  normals     of vertices\n");
    if (mesh->uvs != NULL)
        cli_tell(made, "  texture     coordinates of %s\n",
                 mesh->uv_triangles != NULL ? "triangles' corners"
                 : mesh->uvs2 != NULL       ? "vertices, two of each"
                                            : "vertices");
    if (mesh->materials != NULL) {
        /* Indices of triangles stand for materials of the file; those beyond them for none. */
        uint32_t most = 0;
        for (uint64_t t = 0; t < mesh->triangle_count; t++)
            if (mesh->materials[t] > most) most = mesh->materials[t];
        cli_tell(made, "  materials   of triangles, indices up to %" PRIu32 "\n", most);
    }

    if (differs) {
        cli_tell(made, "the same with vertices at equal positions joined\n");
        tell_certificate(made, &job->welded);
    }
    if (entry->has_crossings)
        cli_tell(made, "  crossings   %" PRIu64 " pairs of triangles\n", entry->crossings);
    return measure(run, mesh, made);
}

/* ---- grids ---- */

typedef struct grid_facts {
    int32_t low[3], size[3]; /* box of the set voxels; size 0 when none is set */
    double volume;
    uint64_t hash;
} grid_facts;

static bvx_status find_facts(cli_run *run, const bvx_grid *g, uint64_t *set, grid_facts *f)
{
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};
    const uint64_t *row = g->words;

    CLI_TRY(bvx_grid_count(run->context, g, set));
    CLI_TRY(bvx_grid_hash(run->context, g, &f->hash));
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++, row += g->words_per_row) {
            int32_t first = 0, last = g->words_per_row - 1;
            while (first <= last && row[first] == 0) first++;
            if (first > last) continue;
            while (row[last] == 0) last--;
            int32_t begin[3] = {first * 64, y, z}, end[3] = {last * 64 + 63, y, z};
            while (!bvx_grid_get(g, begin[0], y, z)) begin[0]++;
            while (!bvx_grid_get(g, end[0], y, z)) end[0]--;
            for (int a = 0; a < 3; a++) {
                low[a] = begin[a] < low[a] ? begin[a] : low[a];
                high[a] = end[a] > high[a] ? end[a] : high[a];
            }
        }
    for (int a = 0; a < 3; a++) {
        /* An empty grid has a box of size 0 at its corner. */
        f->low[a] = high[a] < 0 ? 0 : low[a];
        f->size[a] = high[a] < 0 ? 0 : high[a] - low[a] + 1;
    }
    f->volume = (double)*set * g->lattice.spacing[0] * g->lattice.spacing[1] * g->lattice.spacing[2];
    return BVX_OK;
}

static int info_of_grid(cli_run *run, const cli_input *in, cli_made *made)
{
    const bvx_grid *const g = &in->grid;
    grid_facts f;

    cli_stage_begin(run, "check");
    CLI_TRY(cli_stage_check(run, find_facts(run, g, &made->set, &f), cli_input_name(in->path)));
    made->shown = g;
    made->placed = in->placed;
    cli_text *const t = &made->members;
    double corner[3], centre[3];

    cli_grid_corner(g, 0.0, corner);
    cli_grid_corner(g, 0.5, centre);
    cli_text_add(t, ", \"grid\": {\"path\": ");
    cli_json_string(t, in->path);
    cli_text_add(t, ", \"format\": \"%s\"", cli_format_name(cli_input_format(run, in->path)));
    /* An assumed lattice has numbers too, so it must be said that it is one. */
    cli_json_truth(t, "lattice_known", in->placed);
    cli_json_ints(t, "low", g->low);
    cli_json_ints(t, "size", g->size);
    cli_json_triple(t, "corner", corner);
    cli_json_triple(t, "center0", centre);
    cli_json_value(t, "share", (double)made->set / ((double)g->size[0] * g->size[1] * g->size[2]));
    cli_text_add(t, ", \"box\": {\"low\": [%" PRId32 ", %" PRId32 ", %" PRId32 "]", f.low[0], f.low[1],
                 f.low[2]);
    cli_json_ints(t, "size", f.size);
    cli_text_add(t, "}");
    cli_json_value(t, "volume", f.volume);
    cli_text_add(t, ", \"hash\": \"%016" PRIx64 "\"}", f.hash);
    cli_text_add(&made->head, "  format      %s\n", cli_format_name(cli_input_format(run, in->path)));
    cli_tell(made, "  center0     %.9g, %.9g, %.9g\n", centre[0], centre[1], centre[2]);
    if (made->set == 0) cli_tell(made, "  box         empty\n");
    else
        cli_tell(made,
                 "  box         %" PRId32 " x %" PRId32 " x %" PRId32 " voxels from %" PRId32 ",%" PRId32
                 ",%" PRId32 "\n",
                 f.size[0], f.size[1], f.size[2], f.low[0], f.low[1], f.low[2]);
    cli_tell(made, "  volume      %.9g\n  hash        %016" PRIx64 "\n", f.volume, f.hash);
    return CLI_DONE;
}

/* ---- octrees ---- */

static int info_of_tree(cli_run *run, cli_input *in, cli_made *made)
{
    const bvx_lattice *const l = &run->report.lattice;
    cli_tree t = {0};

    int const status = cli_take_tree(run, in->tree, &t);
    /* Taken over, also by a failure: it must not go twice. */
    in->tree = NULL;
    if (status == CLI_DONE) {
        cli_tell(made, "  format      octree, %" PRId32 " levels above the last\n", t.levels);
        cli_tell(made, "  dims        %" PRId32 " x %" PRId32 " x %" PRId32 " at the last level\n",
                 l->dims[0], l->dims[1], l->dims[2]);
        cli_tell(made, "  spacing     %.9g, %.9g, %.9g\n", l->spacing[0], l->spacing[1], l->spacing[2]);
        cli_tell(made, "  origin      %.9g, %.9g, %.9g\n\n", l->origin[0], l->origin[1], l->origin[2]);
        cli_tell_levels(run, &t, made);
    }
    cli_free_tree(run, &t);
    return status;
}

static int read_for_info(cli_run *run, cli_input *in, int *cloud, cli_made *made)
{
    const info_options *const own = run->own;
    const char *const path = run->options->input[0];
    int const points = cli_input_format(run, path) == BVX_FORMAT_XYZ;
    int kind = CLI_MESH, status = points ? CLI_DONE : cli_input_kind(run, path, &kind);

    memset(in, 0, sizeof *in);
    in->path = path;
    in->kind = kind;
    *cloud = 0;
    if (status != CLI_DONE) return status;
    if (of_meshes(own) != NULL && kind != CLI_MESH)
        return cli_usage(run, "%s is used with meshes; %s is not a mesh", of_meshes(own),
                         cli_input_name(path));
    /* The same file is read as samples first, then as voxels; standard input cannot be read twice. */
    int32_t const format = cli_input_format(run, path);

    if ((format == BVX_FORMAT_NRRD || format == BVX_FORMAT_NPY || format == BVX_FORMAT_VTI) &&
        strcmp(path, "-") != 0)
        CLI_TRY(cli_tell_samples(run, path, made));
    return kind == CLI_GRID ? cli_read_grid_or_tree(run, path, NULL, in)
                            : cli_read_mesh_or_cloud(run, path, &in->mesh, cloud);
}

static int make_info(cli_run *run, void *work, cli_made *made)
{
    info_job *const job = work;
    cli_input *const in = &job->in;
    int cloud;
    made->untitled = 1; /* samples come before the name */
    CLI_TRY(read_for_info(run, in, &cloud, made));
    cli_text_add(&made->head, "%s\n", cli_input_name(in->path));
    if (!cloud && in->kind == CLI_MESH) return info_of_mesh(run, job, made);
    if (!cloud) return in->kind == CLI_TREE ? info_of_tree(run, in, made) : info_of_grid(run, in, made);

    const bvx_mesh *const points = &in->mesh;
    cli_text *const t = &made->members;
    cli_box box;
    cli_box_of_points(points->positions, points->position_type, points->vertex_count, &box);
    cli_text_add(t, ", \"cloud\": {\"path\": ");
    cli_json_string(t, in->path);
    cli_json_count(t, "points", points->vertex_count);
    cli_json_triple(t, "low", box.low);
    cli_json_triple(t, "high", box.high);
    cli_text_add(t, "}");
    cli_tell(made, "  points      %" PRIu64 ", no triangles\n", points->vertex_count);
    cli_tell_box(made, box.low, box.high);
    return CLI_DONE;
}

static const cli_owned info_owns[] = {CLI_OWNS(INPUT, info_job, in), {0}};

static const cli_job info_files = {.size = sizeof(info_job), .make = make_info, .owns = info_owns};

/* ---- contours and bare samples ---- */

static int info_of_one(cli_run *run, void *work, cli_made *made)
{
    const char *const path = run->options->input[0];
    (void)work;
    made->untitled = 1;
    cli_text_add(&made->head, "%s\n", cli_input_name(path));
    return cli_is_contours(run, path) ? cli_tell_sections(run, path, made)
                                      : cli_tell_samples(run, path, made);
}

static const cli_job info_one = {.make = info_of_one};

/* By its name an input is contours, samples that nothing describes, or a file that is read as what it holds. */
static int choose_info(cli_run *run, const cli_job **job)
{
    const info_options *const own = run->own;
    const char *const path = run->options->input[0];
    int const raw = cli_input_format(run, path) == BVX_FORMAT_RAW;
    *job = cli_is_contours(run, path) || raw ? &info_one : &info_files;
    if (of_meshes(own) != NULL && *job != &info_files)
        return cli_usage(run, "%s is used with meshes; %s is not a mesh", of_meshes(own),
                         cli_input_name(path));
    if ((own->mass.density != 0.0 || own->mass.resolution != 0) && !own->measure)
        return cli_usage(run, "%s is used with --measure",
                         own->mass.density != 0.0 ? "--density" : "--resolution");
    return CLI_DONE;
}

const cli_command cli_info = {
    .name = "info",
    .bit = CLI_INFO,
    .least_inputs = 1,
    .most_inputs = CLI_MAX_FILES,
    .usage = "IN... [options]",
    .does = "what a mesh, a grid or an octree is: counts, bounds, closed, manifold, volume; voxels, lattice",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz) and says whether it is closed, manifold and\n"
        "oriented, how many components it has, its volume and its area; or a grid (.npy .binvox .vox .nrrd\n"
        ".vti .bvx) and reports its voxels, its lattice and the hash of both, and of a volume (.nrrd .nhdr "
        ".npy\n"
        ".vti) the type, the range and a histogram of its samples; or an octree (.bvx) and says what each "
        "of\n"
        "its levels holds; or a cloud of points (.xyz, .ply) and says how many, and where they lie; or "
        "contours\n"
        "(" CLI_CONTOURS_READ ") and reports their sections, loops, labels and planes; or bare samples\n"
        "(.raw, with --shape and --sample-type). Several files are reported one after the other; --json "
        "lists them.",
    .example = "bitvox info fixtures/knot.ply\n"
               "bitvox info fixtures/knot.ply --measure --density 2700",
    .most = "--crossings --measure --density --resolution --shape --sample-type --voxel-size --memory-limit "
            "--threads --json --progress --quiet",
    .rows = info_rows,
    .own = sizeof(info_options),
    .choose = choose_info};
