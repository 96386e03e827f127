/* cmd_sections.c - bitvox sections: section contours to a closed body and its block model. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- its options ---- */

typedef struct sections_options {
    bvx_sections_options body;
    cli_list grid;           /* --grid; not given: none */
    int32_t touching;        /* of all labels: TOUCHING_... */
    const char *block_model; /* a file's name, or NULL */
    cli_triple block;
} sections_options;

static void start_sections(void *options)
{
    sections_options *const o = options;
    o->body = (bvx_sections_options){.struct_size = sizeof o->body, .slabs = {.depth = 5}};
}

enum { TOUCHING_APART, TOUCHING_SHARED }; /* --touching */

#define OWN(name) CLI_OWN(sections_options, name)

static const char *const caps_names[] = {BVX_CAPS_LIST(CLI_NAME_OF) NULL};
static const char *const crossings_names[] = {BVX_CROSSINGS_LIST(CLI_NAME_OF) NULL};
static const char *const label_names[] = {"all", NULL};
static const char *const touching_names[] = {"apart", "shared", NULL};

static const cli_argument sections_rows[] = {
    {.also = cli_takes_output},
    SIZE("--grid", "NxM", OWN(grid), 8192,
         "cells over the sections [auto: sides of twice the mean length of the\n"
         "contours' segments]"),
    BETWEEN("--spacing", "S", OWN(body.spacing), 0, 1e300,
            "side of a cell in the contours' unit, in place of --grid"),
    WHOLE("--cells", "N", OWN(body.cells), 8, 1024,
          "planes that are not parallel: cells along the longest side of the\n"
          "contours' box [auto: 64]"),
    FROM_TO("--agree", "D", OWN(body.agree), 0, 1e300,
            "planes that are not parallel: contours at most so far apart where two\n"
            "planes cross are moved to agree; with --touching shared bodies overlap\n"
            "by no more [a hundredth of that longest side]"),
    FROM_TO("--close-gap", "G", SHARED(close_gap), 0, 1e300,
            "of .csv: loops whose ends lie further apart than G are refused as open\n"
            "polylines; 0 closes all of them by a straight side [0]"),
    CHOICE("--caps", "HOW", OWN(body.caps), caps_names, BVX_CAPS_FLAT,
           "the ends: flat on the first and last section; taper: each part to a\n"
           "ridge half a spacing beyond, also those that end in between; open [flat]"),
    BETWEEN("--thickness", "T", OWN(body.thickness), 0, 1e300,
            "a body of one section alone, refused without: half of T to either side,\n"
            "a slab with flat caps, a lens with --caps taper"),
    FLAG("--mend", OWN(body.mend),
         "split loops where they touch or cross, in place of refusing them; inside\n"
         "stays what an odd number of loops enclose"),
    CHOICE("--crossings", "HOW", OWN(body.slabs.crossings), crossings_names, BVX_CROSSINGS_EXACT,
           "on the sections' planes: exact, by the contours themselves; paper, by\n"
           "interpolated distances with the contours' points put in; classic,\n"
           "marching cubes [exact]"),
    WHOLE("--subdivide", "N", OWN(body.slabs.depth), 0, 8,
          "halve cells that a contour crosses twice on a side, N times at most [5]"),
    WHOLE_OR("--label", "L", OWN(body.label), -2147483647.0, 2147483647.0, label_names, BVX_LABEL_ZERO,
             "the body, where the file holds several; all: each in a file of its own,\n"
             "whose name has its label for %d"),
    CHOICE("--touching", "HOW", OWN(touching), touching_names, TOUCHING_APART,
           "with --label all: shared makes all bodies at once, with the same faces\n"
           "where two touch; --cells counts, also on parallel planes [apart]"),
    FILE_NAME("--block-model", "CSV", OWN(block_model),
              "also write blocks: centre, sides and the share that is inside"),
    TRIPLE("--block", "X,Y,Z", OWN(block), "sides of a block, with --block-model"),
    {.also = cli_takes_reduction},
    {.also = cli_takes_file_of_a_mesh},
    CHOICE("--format", "NAME", SHARED(format), cli_format_names + BVX_FORMAT_CSL, BVX_FORMAT_CSL,
           "format of standard input, with - as input: csl or csv"),
    {.also = cli_takes_common},
    {0}};

enum { BLOCK_PARTS = 8 }; /* fine voxels a block along each axis */

#define LEAST_VOLUME \
    0.9 /* of the prismoids' volume: less means that parts of neighbouring sections do not join */

typedef struct sections_job {
    bvx_sections sections;
    bvx_sections_report report;
    bvx_mesh mesh;
    double seconds, block_volume;
    uint64_t blocks;
    /* Of the body as it is made. */
    double volume;
    uint64_t parts;
    int64_t genus;
    int n;         /* its number among those that are written */
    bvx_mesh *all; /* [bodies] those that are made at once and not written yet, or NULL */
    int bodies;
    cli_reduction reduction;
    cli_text text; /* of the block model */
} sections_job;

enum {
    READS_CONTOURS = 1 << CLI_FIRST_FACT,
    READS_CSV = 2 << CLI_FIRST_FACT,
    STAYS_OPEN = 4 << CLI_FIRST_FACT,     /* --caps open */
    MODEL_IS_CSV = 8 << CLI_FIRST_FACT,   /* --block-model */
    HAS_BLOCKS = 16 << CLI_FIRST_FACT,    /* --block with sides above 0 */
    ALL_LABELS = 32 << CLI_FIRST_FACT,    /* --label all */
    HAS_NUMBER = 64 << CLI_FIRST_FACT,    /* %d in the output's name */
    HAS_NUMBERS = 128 << CLI_FIRST_FACT,  /* two */
    SHARED_FACES = 256 << CLI_FIRST_FACT, /* --touching shared */
    ANY_DIRECTION = 512 << CLI_FIRST_FACT /* the file's planes are not parallel */
};

static int wants_all_labels(const cli_run *run)
{
    const sections_options *const own = run->own;
    return cli_given(run, "--label") && own->body.label == BVX_LABEL_ZERO;
}

/* The word is the block model's name. */
static const cli_rule sections_rules[] = {
    {.unless = READS_CONTOURS,
     .message = "%i: the name does not end in a contour format that can be read (" CLI_CONTOURS_READ
                ", also with .gz)"},
    {.also = cli_to_mesh_rules},
    {.unless = READS_CSV,
     .given = "--close-gap",
     .message = "%o is for .csv; loops of .csl are closed by their format"},
    {.also = cli_reduction_rules},
    {.when = STAYS_OPEN,
     .given = "--triangles --error --error-kind",
     .message = "%o needs a closed body, not --caps open"},
    {.when = ALL_LABELS,
     .given = "--block-model --block",
     .message = "%o is for one body; choose it by its label, not by --label all"},
    {.when = ALL_LABELS,
     .unless = HAS_NUMBER,
     .message = "--label all writes a mesh for each label: %f needs %d in its name"},
    {.unless = ALL_LABELS, .given = "--touching", .message = "%o is for --label all"},
    {.when = SHARED_FACES,
     .given = "--grid --crossings --subdivide --mend --thickness",
     .message = "%o is not used with --touching shared, which makes bodies by --cells"},
    {.when = SHARED_FACES,
     .given = "--triangles --error --error-kind",
     .message = "%o would change faces that --touching shared makes the same"},
    {.when = SHARED_FACES | STAYS_OPEN, .message = "--touching shared makes closed bodies, not --caps open"},
    {.when = HAS_NUMBERS, .message = "%f: the name has two %d"},
    {.when = HAS_NUMBER, .unless = ALL_LABELS, .message = "%f: %d is for --label all"},
    {.given = "--grid", .beside = "--spacing", .message = "%o and %b contradict each other"},
    {.given = "--cells", .beside = "--spacing", .message = "%o and %b contradict each other"},
    {.given = "--block-model", .lacking = "--block", .message = "%o requires --block"},
    {.given = "--block", .lacking = "--block-model", .message = "%o requires --block-model"},
    {.unless = MODEL_IS_CSV, .given = "--block-model", .message = "%w: a block model's name ends in .csv"},
    {.when = STAYS_OPEN, .given = "--block-model", .message = "%o needs a closed body, not --caps open"},
    {.unless = HAS_BLOCKS, .given = "--block", .message = "%o: sides must be above 0"},
    {0}};

/* What only the file says: how its planes lie. */
static const cli_rule planes_rules[] = {
    {.when = ANY_DIRECTION,
     .given = "--grid --crossings --subdivide",
     .message = "%o is for parallel planes; those of %i are not, and --cells makes them finer"},
    {.unless = ANY_DIRECTION | SHARED_FACES,
     .given = "--cells",
     .message = "%o is for planes that are not parallel; those of %i are, and --grid makes them finer"},
    {.unless = ANY_DIRECTION | SHARED_FACES, /* bodies that touch may overlap by it */
     .given = "--agree",
     .message = "%o is for planes that are not parallel; those of %i do not cross"},
    {0}};

static int read_stack(cli_run *run, sections_job *job)
{
    const sections_options *const own = run->own;
    CLI_TRY(cli_read_sections(run, run->options->input[0], &job->sections));
    return cli_check_rules(run, planes_rules,
                           (job->sections.normals != NULL ? ANY_DIRECTION : 0u) |
                               (own->touching == TOUCHING_SHARED ? SHARED_FACES : 0u),
                           NULL);
}

static int check_body(cli_run *run, sections_job *job, const char *path)
{
    int const result = cli_check_mesh(run, &job->mesh, job->n, path, "check");
    job->volume = run->report.mesh[job->n].certificate.volume;
    job->parts = run->report.mesh[job->n].certificate.components;
    job->genus = cli_count_handles(&run->report.mesh[job->n].certificate);
    return result;
}

static int build_body(cli_run *run, sections_job *job, int32_t label, const char *path)
{
    const sections_options *const own = run->own;
    bvx_sections_options s = own->body;

    if (own->grid.count != 0)
        for (int k = 0; k < 2; k++) s.slabs.grid[k] = (int32_t)own->grid.value[k];
    s.label = label != 0 || !cli_given(run, "--label") ? label : BVX_LABEL_ZERO;
    if (s.slabs.depth == 0) s.slabs.depth = BVX_NONE;
    s.report = &job->report;
    cli_stage_begin(run, "sections");
    bvx_status const status = bvx_build_sections(run->context, &job->sections, &s, &job->mesh);
    job->seconds = cli_stage_end(run);
    int32_t const reason = status == BVX_OK ? BVX_REASON_NONE : bvx_last_error(run->context)->reason;
    if (reason == BVX_REASON_SEVERAL_BODIES)
        return cli_fail(run, "%s: the sections hold several bodies; choose one by --label, or --label all",
                        cli_first_name(run));
    if ((reason == BVX_REASON_LOOPS_MEET || reason == BVX_REASON_LOOP_FLAT) && !own->body.mend)
        return cli_fail_advised(run, status, cli_first_name(run),
                                reason == BVX_REASON_LOOPS_MEET ? "; --mend splits loops there"
                                                                : "; --mend leaves such loops out");
    CLI_TRY(cli_check_call(run, status, cli_first_name(run)));
    return check_body(run, job, path);
}

/* Edges of the body collapse after its blocks are counted, which are those of the contours. */
static int reduce_body(cli_run *run, sections_job *job)
{
    int const result = cli_reduce(run, &job->mesh, &job->reduction);
    if (result == CLI_DONE && job->reduction.done)
        run->report.mesh[job->n].certificate = job->reduction.level.certificate;
    return result;
}

/* ---- blocks ---- */

/* Layer k of blocks; a layer at a time, as the fine voxels of the whole model may not fit into memory. */
static bvx_status add_blocks(cli_run *run, sections_job *job, const bvx_lattice *lattice, int32_t k)
{
    const double *const low = lattice->origin, *const side =
                                                   ((const sections_options *)run->own)->block.value;
    bvx_voxelize_options v = {.struct_size = sizeof v};
    bvx_mesh_view const view = cli_view(&job->mesh);
    bvx_grid grid = {0}, *const g = &grid;

    v.window.low[2] = k * BLOCK_PARTS;
    v.window.size[0] = lattice->dims[0];
    v.window.size[1] = lattice->dims[1];
    v.window.size[2] = BLOCK_PARTS;
    CLI_TRY(bvx_voxelize_solid(run->context, &view, lattice, &v, &grid));
    for (int32_t j = 0; j < g->size[1] / BLOCK_PARTS; j++)
        for (int32_t i = 0; i < g->size[0] / BLOCK_PARTS; i++) {
            /* Fine bits of block column (i, j) in a grid that is one block high. */
            uint32_t n = 0;
            for (int32_t z = 0; z < BLOCK_PARTS; z++)
                for (int32_t y = 0; y < BLOCK_PARTS; y++) {
                    size_t const row = (size_t)z * (size_t)g->size[1] + (size_t)(j * BLOCK_PARTS + y);
                    /* eight blocks a word */
                    uint64_t bits = g->words[row * (size_t)g->words_per_row + (size_t)(i / 8)] >>
                                        (i % 8 * 8) &
                                    0xff;
                    for (; bits != 0; bits &= bits - 1) n++;
                }
            double const share = (double)n / (BLOCK_PARTS * BLOCK_PARTS * BLOCK_PARTS);
            if (n == 0) continue;
            /* twelve digits: centres that are decimals in the user's eyes stay so */
            cli_text_add(&job->text, "%.12g,%.12g,%.12g,%.12g,%.12g,%.12g,%.9g\n",
                         low[0] + (i + 0.5) * side[0], low[1] + (j + 0.5) * side[1],
                         low[2] + (k + 0.5) * side[2], side[0], side[1], side[2], share);
            job->blocks++;
            job->block_volume += share * side[0] * side[1] * side[2];
        }
    bvx_grid_free(run->context, &grid);
    return BVX_OK;
}

/* Corners of blocks at whole multiples of their sides, as in block models. */
static int make_blocks(cli_run *run, sections_job *job)
{
    const sections_options *const own = run->own;
    cli_text *const text = &job->text;
    const double *const side = own->block.value;
    const bvx_certificate *const c = &run->report.mesh[0].certificate;
    double origin[3], spacing[3];
    int32_t dims[3];
    bvx_lattice lattice;

    for (int k = 0; k < 3; k++) {
        /* Whole multiples of the sides, the last one beyond the body's end. */
        double const first = floor(c->box.low[k] / side[k]), end = floor(c->box.high[k] / side[k]) + 1.0;
        if (!((end - first) * BLOCK_PARTS <= 33554432.0))
            return cli_fail(run, "--block: %g blocks along an axis are too many", end - first);
        origin[k] = first * side[k];
        spacing[k] = side[k] / BLOCK_PARTS;
        dims[k] = (int32_t)(end - first) * BLOCK_PARTS;
    }
    cli_stage_begin(run, "blocks");
    bvx_status status = bvx_lattice_make(run->context, origin, spacing, dims, &lattice);
    cli_text_add(text, "x,y,z,dx,dy,dz,fraction\n");
    for (int32_t k = 0; k < dims[2] / BLOCK_PARTS && status == BVX_OK; k++)
        status = add_blocks(run, job, &lattice, k);
    cli_stage_end(run);
    CLI_TRY(cli_check_call(run, status, own->block_model));
    return text->failed ? cli_fail(run, "no memory for the block model") : CLI_DONE;
}

/* ---- out ---- */

static int write_body(cli_run *run, void *work)
{
    const sections_options *const own = run->own;
    const sections_job *const job = work;
    int result = cli_write_mesh_as(run, &job->mesh, 0, run->options->output);
    bvx_buffer text = {.bytes = (uint8_t *)job->text.bytes, .size = job->text.size};
    if (result == CLI_DONE && own->block_model != NULL) result = cli_write_output(run, 1, &text);
    return result == CLI_DONE ? cli_keep_outputs(run) : result;
}

static void tell_body(const cli_run *run, const sections_job *job, cli_made *made)
{
    const sections_options *const own = run->own;
    const bvx_sections_report *const r = &job->report;
    const bvx_certificate *const c = &run->report.mesh[job->n].certificate;
    int const flat = r->planes == 0;

    cli_tell(made, "  sections    %" PRIu64 " with %" PRIu64 " loops (%" PRIu64 " holes), %" PRIu64 " points",
             r->sections, r->loops, r->holes, r->points);
    if (r->mended_loops != 0) cli_tell(made, "; %" PRIu64 " loops mended", r->mended_loops);
    if (flat) {
        cli_tell(made, "\n  grid        %" PRId32 " x %" PRId32 " cells of %g x %g\n", r->grid[0], r->grid[1],
                 r->cell[0], r->cell[1]);
        cli_tell(made, "  not kept    %" PRIu64 " edges, %" PRIu64 " loops, %" PRIu64 " points\n",
                 r->unkept_edges, r->unkept_loops, r->unkept_points);
    } else {
        /* Planes that cross may contradict each other, which parallel ones cannot. */
        cli_tell(made, "\n  planes      %" PRIu64 " of any direction; cells of %g\n", r->planes, r->cell[0]);
        cli_tell(made,
                 "  agreement   %" PRIu64 " gaps left where planes cross, contours %g apart there at most\n",
                 r->gaps, r->largest_gap);
        cli_tell(made, "  not kept    %" PRIu64 " edges, %" PRIu64 " points\n", r->unkept_edges,
                 r->unkept_points);
    }
    for (uint64_t i = 0; i < r->located && i < 4; i++)
        cli_tell(made, "              at %g, %g, %g\n", r->unkept[i][0], r->unkept[i][1], r->unkept[i][2]);
    cli_tell_reduction(&job->reduction, made);
    cli_tell(made, "  surface     %" PRIu64 " triangles, %" PRIu64 " vertices, %" PRIu64 " shell%s: %s\n",
             c->triangles, c->vertices, c->components, c->components == 1 ? "" : "s",
             cli_is_sound(c)                                         ? "closed, manifold, oriented"
             : c->edge_manifold && c->vertex_manifold && c->oriented ? "manifold, oriented, open"
                                                                     : "not manifold");
    cli_tell(made, "  volume      %g by the mesh", c->volume);
    if (flat) cli_tell(made, ", %g by prismoids", r->prismoid_volume);
    if (flat && own->block_model != NULL)
        cli_tell(made, ", %g by %" PRIu64 " blocks", job->block_volume, job->blocks);
    cli_tell(made, "\n  time        %.1f ms\n", job->seconds * 1e3);
}

static void report_body(const cli_run *run, const sections_job *job, cli_made *made)
{
    const sections_options *const own = run->own;
    const bvx_sections_report *const r = &job->report;
    cli_text *const t = &made->members;

    cli_text_add(t, ", \"sections\": {\"grid\": [%" PRId32 ", %" PRId32 "], \"cell\": [", r->grid[0],
                 r->grid[1]);
    cli_json_number(t, r->cell[0]);
    cli_text_add(t, ", ");
    cli_json_number(t, r->cell[1]);
    cli_text_add(t, "]");
    cli_json_count(t, "sections", r->sections);
    cli_json_count(t, "loops", r->loops);
    cli_json_count(t, "holes", r->holes);
    cli_json_count(t, "points", r->points);
    cli_json_count(t, "repeated_points", r->repeated_points);
    cli_json_count(t, "mended_loops", r->mended_loops);
    cli_json_count(t, "unkept_edges", r->unkept_edges);
    cli_json_count(t, "unkept_loops", r->unkept_loops);
    cli_json_count(t, "unkept_points", r->unkept_points);
    cli_json_count(t, "joined_slabs", r->joined_slabs);
    cli_json_count(t, "planes", r->planes);
    cli_json_count(t, "gaps", r->gaps);
    cli_json_value(t, "largest_gap", r->largest_gap);
    cli_text_add(t, ", \"unkept\": [");
    for (uint64_t i = 0; i < r->located; i++) {
        cli_text_add(t, i == 0 ? "[" : ", [");
        for (int k = 0; k < 3; k++) {
            if (k > 0) cli_text_add(t, ", ");
            cli_json_number(t, r->unkept[i][k]);
        }
        cli_text_add(t, "]");
    }
    cli_text_add(t, "]");
    cli_json_value(t, "prismoid_volume", r->prismoid_volume);
    if (own->block_model != NULL) {
        cli_json_count(t, "blocks", job->blocks);
        cli_json_value(t, "block_volume", job->block_volume);
    }
    cli_json_value(t, "milliseconds", job->seconds * 1e3);
}

static void warn_of_body(const cli_run *run, const sections_job *job, cli_made *made)
{
    const sections_options *const own = run->own;
    const bvx_sections_report *const r = &job->report;

    /* An option that did nothing is told of, since its result looks like one that it made. */
    if (own->body.thickness > 0.0 && r->sections > 1 && !wants_all_labels(run))
        cli_advise(made, BVX_WARN_UNMET, "--thickness is for one section alone; the body has %" PRIu64,
                   r->sections);
    if (r->planes == 0 && own->body.caps != BVX_CAPS_OPEN && job->volume < LEAST_VOLUME * r->prismoid_volume)
        cli_advise(
            made, BVX_WARN_UNJOINED,
            "the body has %.2g of the volume between its sections' areas (%.6g of %.6g): parts that share no "
            "area with one of the next section do not join it; sections that lie closer together may help",
            job->volume / r->prismoid_volume, job->volume, r->prismoid_volume);
}

static void tell_topology(const cli_run *run, const sections_job *job, cli_made *made)
{
    const sections_options *const own = run->own;
    cli_text *const t = &made->members;
    if (own->body.caps == BVX_CAPS_OPEN) return;
    cli_tell(made, "  topology    %" PRIu64 " part%s, %" PRId64 " handle%s\n", job->parts,
             job->parts == 1 ? "" : "s", job->genus, job->genus == 1 ? "" : "s");
    cli_json_count(t, "parts", job->parts);
    cli_text_add(t, ", \"genus\": %" PRId64, job->genus);
}

/* ---- every body ---- */

/* All bodies by one call, which takes what is the same faces from the same numbers. */
static int build_all(cli_run *run, sections_job *job, const int32_t *label, int count)
{
    const sections_options *const own = run->own;
    bvx_sections_options s = own->body;
    job->all = calloc((size_t)count, sizeof *job->all);
    if (job->all == NULL) return cli_fail(run, "no memory for %d bodies", count);
    job->bodies = count;
    s.label = 0;
    s.report = &job->report;
    cli_stage_begin(run, "sections");
    bvx_status status = bvx_build_bodies(run->context, &job->sections, &s, label, (uint32_t)count, job->all);
    job->seconds = cli_stage_end(run);
    return cli_check_call(run, status, cli_first_name(run));
}

static int make_labelled(cli_run *run, sections_job *job, int32_t label, cli_made *made)
{
    char *const path = cli_numbered_path(run->options->output, label); /* the report keeps it */
    if (path == NULL) return cli_fail(run, "no memory for a file's name");
    /* One body after the other by the same job: nothing of the one before may stay, but for a report of all. */
    if (job->all == NULL) memset(&job->report, 0, sizeof job->report);
    memset(&job->reduction, 0, sizeof job->reduction);
    /* One output after the other: their names are known only from the file. */
    CLI_TRY(cli_open_output(run, path));
    if (job->all != NULL) {
        bvx_mesh_free(run->context, &job->mesh);
        job->mesh = job->all[job->n];
        memset(&job->all[job->n], 0, sizeof job->mesh);
        CLI_TRY(check_body(run, job, path));
    } else CLI_TRY(build_body(run, job, label, path));
    CLI_TRY(reduce_body(run, job));
    CLI_TRY(cli_write_mesh_as(run, &job->mesh, job->n, path));

    cli_tell(made, "label %" PRId32 ": %s\n", label, run->report.mesh[job->n].path);
    warn_of_body(run, job, made);
    tell_body(run, job, made);
    cli_text_add(&made->members, "%s{\"label\": %" PRId32, job->n == 0 ? "" : ", ", label);
    report_body(run, job, made);
    tell_topology(run, job, made);
    cli_text_add(&made->members, "}}");
    return CLI_DONE;
}

static int keep_bodies(cli_run *run, void *work)
{
    (void)work;
    return cli_keep_outputs(run);
}

static int make_all_labels(cli_run *run, void *work, cli_made *made)
{
    const sections_options *const own = run->own;
    sections_job *const job = work;
    int count, result = CLI_DONE;

    made->write = keep_bodies;
    made->untitled = 1;
    CLI_TRY(read_stack(run, job));

    /* Labels ascending, each once; NULL without memory. */
    int32_t *const label = calloc((size_t)job->sections.loop_count + 1, sizeof *label);
    count = 0;
    for (uint64_t i = 0; label != NULL && i < job->sections.loop_count && count <= CLI_MAX_OUTPUTS; i++) {
        int at = count;
        while (at > 0 && label[at - 1] > job->sections.loops[i].label) at--;
        if (at > 0 && label[at - 1] == job->sections.loops[i].label) continue;
        memmove(label + at + 1, label + at, (size_t)(count - at) * sizeof *label);
        label[at] = job->sections.loops[i].label;
        ++count;
    }
    if (label == NULL) return cli_fail(run, "no memory for labels");
    if (count == 0) result = cli_fail(run, "%s: there are no loops", cli_first_name(run));
    if (count > CLI_MAX_OUTPUTS)
        result = cli_fail(run, "%s: more labels than the %d files of one run; take --label L",
                          cli_first_name(run), CLI_MAX_OUTPUTS);
    if (result == CLI_DONE && own->touching == TOUCHING_SHARED) result = build_all(run, job, label, count);
    cli_text_add(&made->members, ", \"bodies\": [");
    for (int i = 0; i < count && result == CLI_DONE; i++) {
        job->n = i;
        result = make_labelled(run, job, label[i], made);
    }
    cli_text_add(&made->members, "]");
    free(label);
    return result;
}

/* ---- one body ---- */

static int make_body(cli_run *run, void *work, cli_made *made)
{
    const sections_options *const own = run->own;
    sections_job *const job = work;
    const char *const model = own->block_model;
    made->write = write_body;
    CLI_TRY(cli_open_output(run, run->options->output));
    if (model != NULL) CLI_TRY(cli_open_output(run, model));
    CLI_TRY(read_stack(run, job));
    CLI_TRY(build_body(run, job, own->body.label, run->options->output));
    if (model != NULL) CLI_TRY(make_blocks(run, job));
    return reduce_body(run, job);
}

static void tell_one_body(const cli_run *run, const void *work, cli_made *made)
{
    const sections_job *const job = work;
    warn_of_body(run, job, made);
    tell_body(run, job, made);
    report_body(run, job, made);
    tell_topology(run, job, made);
    cli_text_add(&made->members, "}");
}

static void free_sections(cli_run *run, void *work)
{
    sections_job *const job = work;
    cli_text_free(&job->text);
    for (int i = 0; i < job->bodies; i++) bvx_mesh_free(run->context, &job->all[i]);
    free(job->all);
    bvx_mesh_free(run->context, &job->mesh);
    bvx_sections_free(run->context, &job->sections);
}

static const cli_job one_body = {
    .size = sizeof(sections_job), .make = make_body, .tell = tell_one_body, .free = free_sections};
static const cli_job every_body = {
    .size = sizeof(sections_job), .make = make_all_labels, .free = free_sections};

static int choose_sections(cli_run *run, const cli_job **job)
{
    const sections_options *const own = run->own;
    *job = wants_all_labels(run) ? &every_body : &one_body;
    const cli_options *const o = run->options;
    uint32_t facts = HAS_BLOCKS;

    if (cli_is_contours(run, o->input[0])) facts |= READS_CONTOURS;
    if (cli_input_format(run, o->input[0]) == BVX_FORMAT_CSV) facts |= READS_CSV;
    if (own->body.caps == BVX_CAPS_OPEN) facts |= STAYS_OPEN;
    if (wants_all_labels(run)) facts |= ALL_LABELS;
    if (own->touching == TOUCHING_SHARED) facts |= SHARED_FACES;
    if (cli_has_number(o->output)) facts |= HAS_NUMBER;
    if (cli_has_two_numbers(o->output)) facts |= HAS_NUMBERS;
    if (own->block_model != NULL && bvx_format_of_name(own->block_model) == BVX_FORMAT_CSV)
        facts |= MODEL_IS_CSV;
    for (int k = 0; k < 3; k++)
        if (!(own->block.value[k] > 0.0 && own->block.value[k] < 1e300)) facts &= ~(uint32_t)HAS_BLOCKS;
    return cli_check_rules(run, sections_rules, facts, own->block_model);
}

const cli_command cli_sections = {
    .name = "sections",
    .bit = CLI_SECTIONS,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "a closed body from the contours of its sections",
    .details =
        "Reads closed contours on planes (.csl, of any direction; .csv with the columns section, position,\n"
        "loop, x, y and perhaps label, for planes of any direction also z, nx, ny, nz; also with .gz) and\n"
        "writes the surface of the body through all of them: each contour point is a vertex. Loops in loops\n"
        "are holes. Reports volumes and what of the contours was too fine for the grid. Loops that cross or\n"
        "touch, points off their plane, a second section at one position and, without --thickness, a single\n"
        "section are refused; sections, loops and points are counted from 0. --block-model writes blocks with\n"
        "the share inside. With --triangles or --error the body's edges collapse in the end, and points of\n"
        "contours are no longer vertices.",
    .example =
        "bitvox slice fixtures/knot.ply -o knot.csv --spacing 0.1\n"
        "bitvox sections knot.csv -o body.ply --caps taper --block-model blocks.csv --block 0.2,0.2,0.1",
    .most = "--grid --spacing --caps --close-gap --mend --crossings --triangles --threads --json",
    .rows = sections_rows,
    .start = start_sections,
    .own = sizeof(sections_options),
    .choose = choose_sections};
