/* sections.c - the closed surface of a body through its section contours.
 *
 * Source: Wang. Three-dimensional surface modelling in section data fields (docs/papers.md, 5; distances on
 * sections, marching cubes over cells from section to section, contour points as vertices, faces with four
 * crossings decided at the meeting of the lines joining opposite ones).
 *
 * What is different: on a section's plane nothing is interpolated. A plane's contours are cut at the grid's
 * lines, and at those of subdivided cells on either side, into one ring of vertices; the cells above and
 * below all take their stretches from that ring. So the surface above a plane ends where the surface below it
 * begins, whatever the cells on both sides are. Strips of cell sides between the planes depend on what lies
 * in the strip only. Each cell's loops are then closed by construction, and triangles inside a cell share no
 * inner edge with any other's: the surface is closed and manifold without any matching afterwards.
 *
 * A body in one section only: where the caps taper, the section itself is enough and the ends reach half a
 * thickness beyond it: a lens. Else it is copied half a thickness to either side: a slab. The section stays
 * in the middle, so that its points are vertices as they were given. Loops are looked at before they are
 * copied, so that what is refused is named by the numbers of those given. */
#include "contours/mend.h"
#include "layers/slab.h"
#include "oblique/oblique.h"

#include "mesh/mesh.h"

#include <math.h>

enum { MOST_TIMES = 4 }; /* that levels may cross before all are given up */

static const char sections_name[] = "bvx_build_sections";

static const bvxi_option sections_rows[] = {
    BVXI_CHOICE(bvx_sections_options, caps, BVX_CAPS_FLAT, BVX_CAPS_OPEN),
    BVXI_CHOICE(bvx_sections_options, slabs.crossings, BVX_CROSSINGS_EXACT, BVX_CROSSINGS_CLASSIC),
    BVXI_OR(bvx_sections_options, slabs.depth, WHOLE, 5, 0, BVXI_SECTION_DEEPEST),
    BVXI_SWITCH(bvx_sections_options, mend),
    BVXI_REAL(bvx_sections_options, agree, 0.0, BVXI_FINITE),
    BVXI_CHOICE(bvx_sections_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_REAL(bvx_sections_options, spacing, 0.0, BVXI_FINITE),
    BVXI_RESERVED(bvx_sections_options, reserved),
    BVXI_REAL(bvx_sections_options, thickness, 0.0, BVXI_FINITE),
};

bvx_status bvxi_section_options_check(bvx_context *ctx, const char *function, bvx_sections_options *o)
{
    BVXI_TRY(bvxi_check_options(ctx, function, o, BVXI_OPTIONS(sections_rows)));
    if (o->position_type == BVX_POSITION_AUTO) o->position_type = BVX_F64;
    o->label = bvxi_label_taken(o->label, BVXI_LABEL_ONLY);
    /* Only the more general conditions stand in the table; what depends on two options stands here. */
    if (o->cells != 0 && (o->cells < 8 || o->cells > 1024))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: cells is %d; 0 or 8 to 1024 are possible", function, (int64_t)o->cells);
    if (o->cells != 0 && o->spacing != 0.0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: cells and spacing are both given", function);
    if (o->slabs.grid[0] == 0 && o->slabs.grid[1] == 0) return BVX_OK;

    for (int32_t a = 0; a < 2; a++)
        if (o->slabs.grid[a] < 2 || o->slabs.grid[a] > 8192)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: grid[%d] is %d; 2 to 8192 are possible", function, (int64_t)a,
                                 (int64_t)o->slabs.grid[a]);
    if (o->spacing != 0.0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: grid and spacing are both given", function);
    return BVX_OK;
}

/* The surface between the sections; *crossed slabs have levels that cross. */
static bvx_status make_surface(bvxi_stack *s, bvxi_slab **slabs, uint32_t *crossed)
{
    BVXI_TRY(BVXI_SHARE(s->ctx, 0.0, 0.02, bvxi_nesting_find(s)));
    BVXI_TRY(BVXI_SHARE(s->ctx, 0.02, 0.04, bvxi_nesting_make(s)));
    BVXI_TRY(BVXI_SHARE(s->ctx, 0.04, 0.1, bvxi_slabs_make(s, slabs)));
    int const exact = s->options.slabs.crossings == BVX_CROSSINGS_EXACT;
    if (exact) BVXI_TRY(BVXI_SHARE(s->ctx, 0.1, 0.12, bvxi_rings_make(s)));
    /* In the field's way the planes have no vertices until they are needed. */
    for (uint32_t i = 0; i < s->plane_count && !exact; i++) {
        bvxi_plane *const p = &s->plane[i];
        memset(p->ring, 0xff, (size_t)p->point_count * 4);
        s->report.unkept_points += p->point_count;
    }
    BVXI_TRY(BVXI_SHARE(s->ctx, 0.12, 0.8, bvxi_slabs_fill(s, *slabs, s->slab_count)));
    return BVXI_SHARE(s->ctx, 0.8, 1.0,
                      BVXI_SCOPE(s->ctx, bvxi_nesting_crossed(s, *slabs, s->slab_count, crossed)));
}

/* Where levels of a slab cross, the surface is made again without levels there. What is subdivided changes
 * with that, for the slabs beside it too, so the new surface is looked at again; that ends, since each time
 * at least one slab less has levels, and after some times none. The bar waits meanwhile. */
static bvx_status build_body(bvxi_stack *s, bvx_mesh *mesh)
{
    bvxi_slab *slabs = NULL;
    uint32_t crossed = 0;

    BVXI_TRY(BVXI_SHARE(s->ctx, 0.0, 0.02, BVXI_SCOPE(s->ctx, bvxi_stack_ends(s))));
    BVXI_TRY(bvxi_nesting_open(s));
    bvx_sections_report const before = s->report;
    for (int times = 0;; times++) {
        uint64_t const mark = bvxi_scratch_begin(s->ctx);

        /* Given up: all slabs that still have levels are joined. */
        for (uint32_t i = 0; i < s->plane_count && times == MOST_TIMES; i++)
            if (s->nesting.count[i] > 1) s->nesting.joined[i] = BVXI_LEVELS_JOINED;
        BVXI_TRY(BVXI_SHARE(s->ctx, 0.02, 0.95, make_surface(s, &slabs, &crossed)));
        if (crossed == 0) break;

        (void)bvxi_scratch_end(s->ctx, mark, BVX_OK);
        memset(&s->slab_mesh, 0, sizeof s->slab_mesh);
        memset(&s->mesh, 0, sizeof s->mesh);
        s->nesting.plane = NULL;
        s->nesting.plane_count = 0;
        /* Cuts of subdivided cells are freed with the cells; those of the grid stay. */
        for (uint32_t i = 0; i < s->plane_count; i++) {
            bvxi_plane *const p = &s->plane[i];
            p->cut = p->shared_cut;
            p->cut_room = p->shared_room;
            p->cut_count = p->grid_cut_count;
        }

        s->report = before;
    }
    for (uint32_t i = 0; i + 1 < s->plane_count && s->nesting.count != NULL; i++)
        s->report.joined_slabs += s->nesting.joined[i] == BVXI_LEVELS_JOINED;
    for (int k = 0; k < 2 && s->options.caps == BVX_CAPS_FLAT; k++) {
        int32_t const side = k == 0 ? -1 : 1;
        /* Without rings the cap's border is made of the lines that cells left there. */
        if (s->options.slabs.crossings != BVX_CROSSINGS_EXACT)
            BVXI_TRY(
                bvxi_cap_fill_edges(s, (const uint32_t(*)[2])s->cap_edge[k], s->cap_edge_count[k], side));
        else BVXI_TRY(bvxi_cap_fill(s, &s->plane[k == 0 ? 0 : s->plane_count - 1], side));
    }
    return BVXI_SHARE(s->ctx, 0.95, 1.0, bvxi_slabs_join(s, slabs, s->slab_count, mesh));
}

/* What is to be built, and where it goes. left: the only section that mending left with loops, or BVXI_NONE. */
typedef struct body_job {
    bvx_context *ctx;
    const bvx_sections_options *o;
    bvx_sections_report *report;
    bvx_mesh *mesh;
    int own; /* the mesh takes its arrays from the context */
    uint32_t left;
} body_job;

/* On the grid of the loops given: on another one they would snap elsewhere. */
static bvx_status open_mended(const body_job *job, const bvx_sections *sections, bvxi_mended *mended,
                              bvxi_stack *s)
{
    bvx_context *const ctx = job->ctx;
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.5, bvxi_mend(ctx, sections_name, sections, job->o, 0.0, mended)));
    if (mended->sections.loop_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: nothing remains of the loops once they are mended",
                         sections_name);
    BVXI_TRY(BVXI_SHARE(ctx, 0.5, 0.6, bvxi_stack_begin(ctx, sections_name, &mended->sections, job->o, s)));
    bvxi_stack_take_grid(s, &mended->grid);
    s->nudge = (const int16_t(*)[2])mended->nudge;
    s->report.mended_loops = mended->loops;
    return BVXI_SHARE(ctx, 0.6, 1.0, bvxi_stack_finish(s));
}

/* What cannot be mended is refused by its own loops' numbers, with the given ones. */
static bvx_status open_sections(const body_job *job, const bvx_sections *sections, bvxi_mended *mended,
                                bvxi_stack *s)
{
    uint64_t const mark = bvxi_scratch_begin(job->ctx);
    bvx_status status = BVX_ERR_FORMAT;
    memset(mended, 0, sizeof *mended);
    if (job->o->mend) status = BVXI_SHARE(job->ctx, 0.0, 0.7, open_mended(job, sections, mended, s));
    if (bvxi_scratch_keep(job->ctx, mark, status) != BVX_ERR_FORMAT) return status;
    return BVXI_SHARE(job->ctx, job->o->mend ? 0.7 : 0.0, 1.0,
                      bvxi_stack_open(job->ctx, sections_name, sections, job->o, s));
}

/* Mended loops may be left in one section only: job->left is its number and no body is made. */
static bvx_status build_stack(body_job *job, const bvx_sections *sections)
{
    bvxi_mended mended;
    bvxi_stack s;

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.15, open_sections(job, sections, &mended, &s)));
    if (s.plane_count == 1 && job->o->caps != BVX_CAPS_TAPER) {
        job->left = s.plane[0].section;
    } else {
        /* Frustums between neighbours, cones where the body ends between sections. */
        double sum = 0.0;
        uint32_t const n = s.plane_count;
        const bvxi_plane *const p = s.plane;

        for (uint32_t i = 0; i + 1 < n; i++) {
            double const a = p[i].area, b = p[i + 1].area, h = p[i + 1].w - p[i].w;
            /* A body that ends between two sections ends half way. */
            double const height = p[i].contour_count == 0 || p[i + 1].contour_count == 0 ? 0.5 * h : h;
            sum += height / 3.0 * ((a + b) + sqrt(a * b));
        }
        /* Tapered ends reach half a slab beyond the first and the last section. */
        if (s.options.caps == BVX_CAPS_TAPER) {
            sum += p[0].area * s.reach[0] / 3.0;
            sum += p[n - 1].area * s.reach[1] / 3.0;
        }
        s.report.prismoid_volume = sum;

        BVXI_TRY(BVXI_SHARE(job->ctx, 0.15, 0.95, BVXI_SCOPE(job->ctx, build_body(&s, job->mesh))));
        /* Loops moved apart by a hair may leave a cap that is cut wrongly: such a mesh is refused. */
        int sound = 1;
        if (mended.loops != 0)
            BVXI_TRY(BVXI_SHARE(job->ctx, 0.95, 1.0,
                                bvxi_section_check_mesh(job->ctx, job->mesh, job->own, &sound)));
        if (!sound)
            return bvxi_fail_for(
                job->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET,
                "%s: the mended loops run too near to each other for a closed, manifold mesh; take fewer points, or mend "
                "the contours before",
                sections_name);
    }
    *job->report = s.report;
    return BVX_OK;
}

/* ---- planes that each have a normal ---- */

static bvx_status build_mended(const body_job *job, const bvx_sections *sections, bvxi_mended *mended)
{
    BVXI_TRY(
        BVXI_SHARE(job->ctx, 0.0, 0.1, bvxi_mend_planes(job->ctx, sections_name, sections, job->o, mended)));
    return BVXI_SHARE(
        job->ctx, 0.1, 0.9,
        bvxi_oblique_body(job->ctx, sections_name, &mended->sections, job->o, job->report, job->mesh));
}

/* Planes that are parallel after all are a stack. */
static bvx_status build_several(body_job *job, const bvx_sections *sections)
{
    bvx_sections stack = *sections;
    int parallel = 1;

    if (sections->normals == NULL) return build_stack(job, sections);
    BVXI_TRY(BVXI_ARRAY(job->ctx, sections->section_count, "the sections' positions", stack.positions));
    for (uint64_t i = 0; i < sections->section_count && parallel; i++) {
        int against;
        /* Where the normal points the other way, so does the position along it. */
        parallel = bvxi_section_parallel(sections->normals, sections->normals + 3 * i, &against);
        stack.positions[i] = against ? -sections->positions[i] : sections->positions[i];
    }
    memcpy(stack.normal, sections->normals, sizeof stack.normal);
    stack.normals = NULL;
    if (parallel) return build_stack(job, &stack);

    /* What cannot be mended is refused by its own loops' numbers, as of parallel planes. */
    bvxi_mended mended = {0};
    bvx_status status = job->o->mend ? build_mended(job, sections, &mended) : BVX_ERR_FORMAT;
    if (status == BVX_ERR_FORMAT) {
        mended.loops = 0;
        status = bvxi_oblique_body(job->ctx, sections_name, sections, job->o, job->report, job->mesh);
    }
    BVXI_TRY(status);
    job->report->mended_loops = mended.loops;
    return BVX_OK;
}

/* ---- one section only ---- */

typedef struct bvxi_lone {
    int times;             /* that the section stands in sections; 0: the body has several of its own */
    bvx_sections sections; /* what the body is made of */
    bvx_sections copies;   /* the arrays of a slab */
} bvxi_lone;

enum { COPIES = 3 };

typedef struct lone_count {
    uint64_t loops, points;
    uint32_t section;
} lone_count;

/* What the body has; 0 where it is not in one section alone, or not one body. */
static int count_lone(const bvx_sections *given, uint32_t section, int32_t label, lone_count *n)
{
    n->loops = n->points = 0;
    for (uint64_t i = 0; i < given->loop_count; i++) {
        const bvx_section_loop *const l = &given->loops[i];
        if (label != BVXI_LABEL_ONLY && l->label != label) continue;
        if (section != BVXI_NONE && l->section != section) continue;
        if (n->loops != 0 && l->section != n->section) return 0;
        if (label == BVXI_LABEL_ONLY && l->label != given->loops[0].label) return 0;
        n->section = l->section;
        n->loops++;
        n->points += l->point_count;
    }
    return n->loops != 0;
}

static void add_section_copy(const bvx_sections *given, const bvx_sections_options *o, const lone_count *n,
                             const double axis[3], double by, bvx_sections *to)
{
    uint32_t const section = (uint32_t)to->section_count++;

    to->positions[section] = given->positions[n->section] + by;
    for (uint64_t i = 0; i < given->loop_count; i++) {
        bvx_section_loop l = given->loops[i];
        const double *const from = given->points + 3 * l.first_point;
        double *const at = to->points + 3 * to->point_count;
        if (o->label != BVXI_LABEL_ONLY && l.label != o->label) continue;
        if (l.section != n->section) continue;
        /* The middle copy has the coordinates given, to the bit. */
        for (uint64_t k = 0; k < 3 * (uint64_t)l.point_count; k++)
            at[k] = by == 0.0 ? from[k] : from[k] + by * axis[k % 3];
        l.first_point = to->point_count;
        l.section = section;
        to->loops[to->loop_count++] = l;
        to->point_count += l.point_count;
    }
}

/* section: the only one that has loops of the body, or BVXI_NONE: look for it. */
static bvx_status bvxi_lone_open(bvx_context *ctx, const char *function, const bvx_sections *given,
                                 uint32_t section, const bvx_sections_options *o, bvxi_lone *lone)
{
    bvxi_stack stack;
    lone_count n = {0};

    memset(lone, 0, sizeof *lone);
    if (o->thickness == 0.0 || !count_lone(given, section, o->label, &n)) return BVX_OK;
    /* The planes beside it are of no use to the body, and theirs may be other normals. */
    bvx_sections one = *given;
    if (given->normals != NULL)
        memcpy(one.normal, given->normals + 3 * (uint64_t)n.section, sizeof one.normal);
    one.normals = NULL;
    lone->times = 1;
    lone->sections = one;

    /* A lens needs no copies: its ends reach half the thickness beyond the one plane. */
    if (o->caps == BVX_CAPS_TAPER) return BVX_OK;

    /* A stack of one plane, made and dropped: it refuses what a slab of copies would. */
    if (!o->mend) BVXI_TRY(BVXI_SCOPE(ctx, bvxi_stack_open(ctx, function, &one, o, &stack)));

    bvx_sections *const to = &lone->copies;
    double axis[3][3];

    /* Before anything is taken: a stack within the limits may be beyond them three times over. */
    if (COPIES * n.points > INT32_MAX || COPIES * n.loops > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u points of one section; a slab of it takes them three times, and the "
                             "limit is 2^31",
                             function, n.points);
    BVXI_TRY(bvxi_section_frame(ctx, function, one.normal, axis));
    memcpy(to->normal, one.normal, sizeof to->normal);
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * (COPIES * n.points), "the points of a slab", to->points));
    BVXI_TRY(BVXI_ARRAY(ctx, COPIES * n.loops, "the loops of a slab", to->loops));
    BVXI_TRY(BVXI_ARRAY(ctx, COPIES, "the positions of a slab", to->positions));
    for (int k = 0; k < COPIES; k++) add_section_copy(&one, o, &n, axis[2], 0.5 * (k - 1) * o->thickness, to);

    lone->times = COPIES;
    lone->sections = lone->copies;
    return BVX_OK;
}

/* ---- the body ---- */

/* A body of one section is a slab or a lens; mending may leave several sections one with loops. */
static bvx_status build_any(body_job *job, const bvx_sections *sections)
{
    bvxi_lone lone;
    BVXI_TRY(bvxi_lone_open(job->ctx, sections_name, sections, BVXI_NONE, job->o, &lone));
    if (lone.times == 0) {
        BVXI_TRY(BVXI_SCOPE(job->ctx, build_several(job, sections)));
        if (job->left == BVXI_NONE) return BVX_OK;
        BVXI_TRY(bvxi_lone_open(job->ctx, sections_name, sections, job->left, job->o, &lone));
        if (lone.times == 0) return BVX_OK;
    }
    BVXI_TRY(BVXI_SHARE(job->ctx, job->left == BVXI_NONE ? 0.0 : 0.15, 1.0,
                        BVXI_SCOPE(job->ctx, build_stack(job, &lone.sections))));

    /* What was counted once for each copy, as it was given. */
    job->report->sections /= (uint64_t)lone.times;
    job->report->loops /= (uint64_t)lone.times;
    job->report->holes /= (uint64_t)lone.times;
    job->report->points /= (uint64_t)lone.times;
    job->report->repeated_points /= (uint64_t)lone.times;
    job->report->mended_loops /= (uint64_t)lone.times;

    return BVX_OK;
}

/* Volumes by prismoids are roots of two areas' product: that must not overflow. */
#define SECTIONS_FARTHEST 1e75

/* Products of areas below 1e-308 are 0, as volumes would be. Loops may be much smaller than the widest. */
#define SECTIONS_NARROWEST 1e-70

bvx_status bvxi_sections_check_extent(bvx_context *ctx, const char *function, const bvx_sections *given)
{
    double widest = 0.0;

    for (uint64_t i = 0; i < given->section_count; i++)
        if (bvxi_absolute(given->positions[i]) > SECTIONS_FARTHEST)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: the position of section %u is %g; the limit is %g", function, i,
                                 given->positions[i], SECTIONS_FARTHEST);
    for (uint64_t i = 0; i < 3 * given->point_count; i++)
        if (bvxi_absolute(given->points[i]) > SECTIONS_FARTHEST)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: point %u has a coordinate of %g; the limit is %g", function, i / 3,
                                 given->points[i], SECTIONS_FARTHEST);
    for (uint64_t i = 0; i < given->loop_count; i++) {
        const bvx_section_loop *const loop = &given->loops[i];
        const double *const first = given->points + 3 * loop->first_point;
        for (uint64_t k = 3; k < 3 * (uint64_t)loop->point_count; k++) {
            double const width = bvxi_absolute(first[k] - first[k % 3]);
            if (width > widest) widest = width;
        }
    }
    /* All points of all loops at one place: each loop is refused by itself. */
    if (widest == 0.0 || widest >= SECTIONS_NARROWEST) return BVX_OK;
    return bvxi_fail_for(
        ctx, BVX_ERR_RANGE, BVX_REASON_RANGE,
        "%s: the widest loop spans %g; below %g areas and volumes round to 0: scale the contours", function,
        widest, SECTIONS_NARROWEST);
}

void bvxi_sections_warn(bvx_context *ctx, bvx_sections_report *r, int32_t depth)
{
    uint64_t const contradicted = r->unkept_points + r->unkept_edges + r->gaps;
    if (r->planes != 0 && contradicted != 0)
        BVXI_WARN(ctx, BVX_WARN_CONTOURS, (double)r->unkept_points, (double)r->unkept_edges, (double)r->gaps);
    /* A finer grid cuts contours in more places; halving cells where two of them run close together helps. */
    if (r->planes == 0 && r->unkept_edges + r->unkept_loops != 0)
        BVXI_WARN(ctx, BVX_WARN_CELLS, (double)r->unkept_edges, (double)r->unkept_loops,
                  depth < BVXI_SECTION_DEEPEST ? BVXI_SECTION_DEEPEST : 0.0);
    if (r->planes == 0 && r->joined_slabs != 0) BVXI_WARN(ctx, BVX_WARN_WINDOWS, (double)r->joined_slabs);
    if (r->repeated_points != 0) BVXI_WARN(ctx, BVX_WARN_REPEATED, (double)r->repeated_points);
    r->warnings = bvxi_warned(ctx);
}

static bvx_status run_build_sections(bvx_context *context, const bvx_sections *sections,
                                     const bvx_sections_options *options, bvx_mesh *mesh)
{
    bvx_sections_options o;
    bvx_sections_report report = {0};

    if (mesh == NULL) return bvxi_fail_null(context, sections_name, "mesh");
    BVXI_TRY(bvxi_take_options(context, sections_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_section_options_check(context, sections_name, &o));
    BVXI_TRY(bvxi_sections_check(context, sections_name, sections));
    BVXI_TRY(bvxi_sections_check_extent(context, sections_name, sections));
    BVXI_TRY(bvxi_mesh_check_reserved(context, sections_name, mesh));
    body_job job = {context, &o, &report, mesh, mesh->positions == NULL, BVXI_NONE};
    BVXI_TRY(build_any(&job, sections));
    if (o.report == NULL) return BVX_OK;
    bvxi_sections_warn(context, &report, o.slabs.depth);
    *o.report = report;
    return BVX_OK;
}

bvx_status bvx_build_sections(bvx_context *context, const bvx_sections *sections,
                              const bvx_sections_options *options, bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_build_sections(context, sections, options, mesh));
}
