/* test_calls.c - what every public function owes to a caller who calls it wrongly: a status that is not
 * BVX_OK, a message that names the function, results left as they were, nothing kept. Each call is made
 * rightly first, so that it is the damage which is refused; then with each damage that one of its arguments
 * can have. Then: choices out of range, sizes beyond memory, meshes into arrays of the caller's, and sections
 * that contradict themselves. */
#include "unity.h"

#include "call_table.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

void setUp(void)
{
}
void tearDown(void)
{
}

/* ---- Damages ---- */

static bvx_mesh_view bad_mesh;
static bvx_lattice bad_lattice;
static bvx_grid bad_grid;
static bvx_field bad_field;
static bvx_sections bad_sections;
static bvx_volume_view bad_volume;
static bvx_mesh bad_body;
static bvx_image bad_image;
static bvx_buffer bad_file;
static float bad_corner[8][3];
static uint32_t bad_cube[12][3];

enum {
    NO_CONTEXT,
    NO_OUT,
    USED_OUT,
    NO_SECOND,
    OPTIONS_SIZE,
    OPTIONS_RESERVED,
    NO_MESH,
    MESH_TYPE,
    MESH_STRIDE,
    MESH_ARRAY,
    MESH_RESERVED,
    MESH_NUMBER,
    MESH_NAN,
    NO_POINTS,
    POINTS_TYPE,
    POINTS_NAN,
    NO_LATTICE,
    LATTICE_DIMS,
    LATTICE_SPACING,
    LATTICE_NAN,
    NO_GRID,
    GRID_WORDS,
    GRID_SIZE,
    GRID_ROW,
    GRID_LATTICE,
    NO_OTHER,
    OTHER_WORDS,
    OTHER_ROW,
    NO_TREE,
    NO_FIELD,
    FIELD_TYPE,
    FIELD_ROWS,
    NO_SECTIONS,
    SECTIONS_RESERVED,
    SECTIONS_NORMAL,
    SECTIONS_POINTS,
    SECTIONS_COUNT,
    NO_VOLUME,
    VOLUME_TYPE,
    VOLUME_SAMPLES,
    VOLUME_RESERVED,
    NO_COMPLEX,
    NO_BODY,
    BODY_TYPE,
    BODY_ARRAY,
    BODY_RESERVED,
    NO_IMAGE,
    IMAGE_SIZE,
    IMAGE_PIXELS,
    NO_BYTES,
    NO_SIZE,
    DAMAGES
};
static const char *const damage_name[DAMAGES] = {"no context",
                                                 "no result",
                                                 "a result in use",
                                                 "no second result",
                                                 "options of size 1",
                                                 "options with something reserved",
                                                 "no mesh",
                                                 "a mesh of no type",
                                                 "a mesh with a short stride",
                                                 "a mesh without positions",
                                                 "a mesh with something reserved",
                                                 "a vertex index too high",
                                                 "a position that is no number",
                                                 "no points",
                                                 "points of no type",
                                                 "a point that is no number",
                                                 "no lattice",
                                                 "a lattice without voxels",
                                                 "a lattice of negative voxels",
                                                 "a lattice nowhere",
                                                 "no grid",
                                                 "a grid without words",
                                                 "a grid without voxels",
                                                 "a grid with wrong rows",
                                                 "a grid outside its lattice",
                                                 "no other grid",
                                                 "another grid without words",
                                                 "another grid with wrong rows",
                                                 "no tree",
                                                 "no field",
                                                 "a field of no type",
                                                 "a field without rows",
                                                 "no sections",
                                                 "sections with something reserved",
                                                 "sections without a normal",
                                                 "sections without points",
                                                 "too many sections",
                                                 "no volume",
                                                 "a volume of no type",
                                                 "a volume without samples",
                                                 "a volume with something reserved",
                                                 "no complex",
                                                 "no body",
                                                 "a body of no type",
                                                 "a body without triangles",
                                                 "a body with something reserved",
                                                 "no image",
                                                 "an image without pixels",
                                                 "an image without memory",
                                                 "no bytes",
                                                 "a file of no bytes"};

/* 0 when the call has nothing that this damage could be done to. */
static int do_damage(const call *c, int damage, world *w)
{
    int const takes = c->takes;

    switch (damage) {
    case NO_CONTEXT: w->ctx = NULL; return 1;
    case NO_OUT: w->out = NULL; return (takes & SLOT) == 0;
    case NO_SECOND: w->second = NULL; return (takes & SECOND) != 0;
    case USED_OUT:
        memset(out.plain, 0x40, sizeof out);
        /* not zeroed and not the library's: owned is neither 0 nor 1 */
        return c->to == TO_FIELD || c->to == TO_SECTIONS || c->to == TO_COMPLEX;
    case OPTIONS_SIZE: w->wrong_size = 1; return (takes & OPTIONS) != 0;
    case OPTIONS_RESERVED: w->wrong_reserved = 1; return (takes & RESERVED) != 0;
    case NO_MESH: w->mesh = NULL; return (takes & MESH) != 0;
    case NO_POINTS: w->points = NULL; return (takes & POINTS) != 0;
    case NO_LATTICE: w->lattice = NULL; return (takes & LATTICE) != 0;
    case NO_GRID: w->grid = NULL; return (takes & GRID) != 0;
    case NO_OTHER: w->other = NULL; return (takes & OTHER) != 0;
    case NO_TREE: w->tree = NULL; return (takes & TREE) != 0;
    case NO_FIELD: w->field = NULL; return (takes & FIELD) != 0;
    case NO_SECTIONS: w->sections = NULL; return (takes & SECTIONS) != 0;
    case NO_VOLUME: w->volume = NULL; return (takes & VOLUME) != 0;
    case NO_COMPLEX: w->complex_ = NULL; return (takes & COMPLEX) != 0;
    case NO_BODY: w->body = NULL; return (takes & BODY) != 0;
    case NO_IMAGE: w->image = NULL; return (takes & IMAGE) != 0;
    case NO_BYTES:
        bad_file = npy;
        bad_file.bytes = NULL;
        w->file = w->lattice_file = &bad_file;
        return (takes & BYTES) != 0;
    /* a fault of its text */
    case NO_SIZE:
        bad_file = npy;
        bad_file.size = 0;
        w->file = &bad_file;
        return (takes & BYTES) != 0 && c->make != read_lattice;
    default: break;
    }
    if (damage >= MESH_TYPE && damage <= MESH_NAN) {
        bad_mesh = mesh;
        memcpy(bad_corner, corner, sizeof corner);
        memcpy(bad_cube, cube, sizeof cube);
        bad_mesh.positions = bad_corner;
        bad_mesh.indices = bad_cube;
        w->mesh = &bad_mesh;
        switch (damage) {
        case MESH_TYPE: bad_mesh.position_type = 9; break;
        case MESH_STRIDE: bad_mesh.position_stride = 8; break;
        case MESH_ARRAY: bad_mesh.positions = NULL; break;
        case MESH_RESERVED: bad_mesh.reserved = 1; break;
        case MESH_NUMBER: bad_cube[7][1] = 8; break;
        default: bad_corner[5][1] = NAN; break;
        }
        return (takes & MESH) != 0;
    }
    if (damage == POINTS_TYPE || damage == POINTS_NAN) {
        bad_mesh = points;
        memcpy(bad_corner, corner, sizeof corner);
        bad_mesh.positions = bad_corner;
        if (damage == POINTS_TYPE) bad_mesh.position_type = 9;
        else bad_corner[5][1] = NAN;
        w->points = &bad_mesh;
        return (takes & POINTS) != 0;
    }
    if (damage >= LATTICE_DIMS && damage <= LATTICE_NAN) {
        bad_lattice = lattice;
        if (damage == LATTICE_DIMS) bad_lattice.dims[1] = 0;
        else if (damage == LATTICE_SPACING) bad_lattice.spacing[2] = -1;
        else bad_lattice.origin[0] = (double)NAN;
        w->lattice = &bad_lattice;
        return (takes & LATTICE) != 0;
    }
    if ((damage >= GRID_WORDS && damage <= GRID_LATTICE) || damage == OTHER_WORDS || damage == OTHER_ROW) {
        bad_grid = solid;
        switch (damage) {
        case GRID_WORDS:
        case OTHER_WORDS: bad_grid.words = NULL; break;
        case GRID_SIZE: bad_grid.size[0] = 0; break;
        case GRID_LATTICE: bad_grid.low[2] = 1; break;
        default: bad_grid.words_per_row = 2; break;
        }
        if (damage <= GRID_LATTICE) w->grid = &bad_grid;
        else w->other = &bad_grid;
        return (takes & (damage <= GRID_LATTICE ? GRID : OTHER)) != 0;
    }
    if (damage == FIELD_TYPE || damage == FIELD_ROWS) {
        bad_field = field;
        if (damage == FIELD_TYPE) bad_field.value_type = 9;
        else bad_field.row_values = NULL;
        w->field = &bad_field;
        return (takes & FIELD) != 0;
    }
    if (damage >= SECTIONS_RESERVED && damage <= SECTIONS_COUNT) {
        bad_sections = sections;
        if (damage == SECTIONS_RESERVED) bad_sections.reserved = 1;
        else if (damage == SECTIONS_NORMAL) memset(bad_sections.normal, 0, sizeof bad_sections.normal);
        else if (damage == SECTIONS_POINTS) bad_sections.points = NULL;
        else bad_sections.section_count = (uint64_t)1 << 40;
        w->sections = &bad_sections;
        return (takes & SECTIONS) != 0;
    }
    if (damage >= VOLUME_TYPE && damage <= VOLUME_RESERVED) {
        bad_volume = volume;
        if (damage == VOLUME_TYPE) bad_volume.sample_type = 99;
        else if (damage == VOLUME_SAMPLES) bad_volume.samples = NULL;
        else bad_volume.reserved[2] = 1;
        w->volume = &bad_volume;
        return (takes & VOLUME) != 0;
    }
    if (damage >= BODY_TYPE && damage <= BODY_RESERVED) {
        bad_body = body;
        if (damage == BODY_TYPE) bad_body.position_type = 9;
        else if (damage == BODY_ARRAY) bad_body.triangles = NULL;
        else bad_body.reserved[1] = 1;
        w->body = &bad_body;
        return (takes & BODY) != 0;
    }
    bad_image = image;
    if (damage == IMAGE_SIZE) bad_image.height = 0;
    else bad_image.pixels = NULL;
    w->image = &bad_image;
    return (takes & IMAGE) != 0;
}

/* What a damage is called wherever a call finds it; BVX_REASON_NONE where calls differ. */
static int32_t reason_of_damage(int damage)
{
    switch (damage) {
    case NO_OUT:
    case NO_MESH:
    case NO_POINTS:
    case NO_LATTICE:
    case NO_GRID:
    case NO_OTHER:
    case NO_TREE:
    case NO_FIELD:
    case NO_SECTIONS:
    case NO_VOLUME:
    case NO_COMPLEX:
    case NO_BODY: return BVX_REASON_NULL;
    case OPTIONS_SIZE: return BVX_REASON_OPTIONS;
    case OPTIONS_RESERVED:
    case MESH_RESERVED:
    case SECTIONS_RESERVED:
    case VOLUME_RESERVED:
    case BODY_RESERVED: return BVX_REASON_RESERVED;
    case MESH_NUMBER: return BVX_REASON_INDEX;
    case MESH_NAN:
    case POINTS_NAN: return BVX_REASON_NOT_FINITE;
    default: return BVX_REASON_NONE;
    }
}

/* NULL, or what bvx_last_error has wrong. */
static const char *wrong_error(const call *c, const bvx_context *ctx, int damage, bvx_status status)
{
    const bvx_error *const e = bvx_last_error(ctx);
    int32_t const expected = reason_of_damage(damage);

    if (e->status != status) return "gives another status in bvx_last_error";
    if (e->reason <= BVX_REASON_UNSPECIFIED || e->reason >= BVX_REASON_COUNT) return "gives no reason";
    if (expected != BVX_REASON_NONE && e->reason != expected) return "gives another reason";
    if (strcmp(e->function, c->name) != 0) return e->function;
    if (damage == MESH_NUMBER && e->index != 7) return "names another triangle";
    if (damage == MESH_NAN && e->index != 5) return "names another vertex";
    if (strcmp(e->message, bvx_last_message(ctx)) != 0 || strstr(e->message, e->text) == NULL ||
        e->text[0] == 0)
        return "gives no text";
    return NULL;
}

/* NULL, or what was wrong with the refusal. */
static const char *wrong_refusal(const call *c, const world *w, bvx_context *ctx, uint64_t held, int damage,
                                 bvx_status status)
{
    static result before;

    memset(&before, out.plain[0], sizeof before);
    if (status == BVX_OK) return "was not refused";
    if (status != BVX_ERR_ARGUMENT && w->ctx == NULL) return "gives another status";
    if (memcmp(&before, &out, sizeof out) != 0) return "wrote something";
    if (bvx_memory_used(ctx) != held) return "kept memory";
    if (w->ctx != NULL && strstr(bvx_last_message(ctx), (c->takes & INNER) != 0 ? "bvx_" : c->name) == NULL)
        return "gives a message that does not name the function";
    return w->ctx != NULL ? wrong_error(c, ctx, damage, status) : NULL;
}

static void test_every_call_refuses_every_damage(void)
{
    bvx_context *ctx = NULL;
    int wrong = 0, refusals = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    make_world(ctx);
    for (int i = 0; i < CALLS; i++) {
        world w = right_world(ctx);
        uint64_t held;
        bvx_status status;
        memset(&out, 0, sizeof out);
        memset(second, 0, sizeof second);
        status = calls[i].make(&w);
        if (status != BVX_OK) {
            printf("%s: %s\n", calls[i].name, bvx_last_message(ctx));
            wrong++;
        }
        free_result(ctx, calls[i].to);
        held = bvx_memory_used(ctx);
        for (int damage = 0; damage < DAMAGES; damage++) {
            const char *what;
            w = right_world(ctx);
            memset(&out, 0, sizeof out);
            if (!do_damage(&calls[i], damage, &w)) continue;
            status = calls[i].make(&w);
            what = wrong_refusal(&calls[i], &w, ctx, held, damage, status);
            if (what != NULL) {
                printf("%s with %s %s: %s\n", calls[i].name, damage_name[damage], what,
                       bvx_last_message(ctx));
                wrong++;
                if (status == BVX_OK) free_result(ctx, calls[i].to);
            }
            refusals++;
        }
    }
    free_world(ctx);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    bvx_context_destroy(ctx);
    TEST_ASSERT_EQUAL_INT(0, wrong);
    TEST_ASSERT_GREATER_THAN_INT(600, refusals);
}

typedef struct choice {
    const char *name; /* of the call, and of the field in the message below */
    bvx_status (*make)(const world *w);
    size_t at, size;
    double value; /* becomes the field's type */
} choice;
#define BAD(call, kind, field, value)                                                           \
    {                                                                                           \
        "bvx_" #call " with " #field " = " #value, call, offsetof(bvx_##kind##_options, field), \
            sizeof((bvx_##kind##_options *)0)->field, value                                     \
    }
#define BAD_SWITCH(call, kind, field) BAD(call, kind, field, 2), BAD(call, kind, field, -1)
#define BAD_SURFACE(call, kind, in)                                                  \
    BAD(call, kind, in face_rule, 9), BAD(call, kind, in face_rule, -1),             \
        BAD(call, kind, in position_type, 9), BAD(call, kind, in position_type, -1), \
        BAD_SWITCH(call, kind, in local_frame)

/* Options outside of what the header allows; fields of 4 bytes are whole numbers, those of 8 are doubles. */
static void test_choices_out_of_range(void)
{
    static const choice bad[] = {
        BAD(lattice_fit_with, lattice, padding, -1),
        BAD(voxelize_solid, voxelize, fill, 99),
        BAD(voxelize_solid, voxelize, fill, -1),
        BAD(voxelize_solid, voxelize, close_gaps, -1),
        BAD_SWITCH(voxelize_solid, voxelize, add_shell),
        BAD(voxelize_solid, voxelize, check_thin, 3),
        BAD(voxelize_solid, voxelize, check_thin, -1),
        BAD(voxelize_solid, voxelize, up, 3),
        BAD_SWITCH(voxelize_solid, voxelize, has_base),
        BAD(voxelize_surface, surface, mode, 99),
        BAD(voxelize_surface, surface, mode, -1),
        BAD(grid_morph, morph, neighbourhood, 5),
        BAD(grid_morph, morph, steps, -1),
        BAD(grid_morph, morph, beyond, 2),
        BAD(grid_morph, morph, radius, -1),
        BAD(grid_hollow, hollow, drain_side, 7),
        BAD(grid_hollow, hollow, drain_side, -1),
        BAD_SWITCH(grid_hollow, hollow, drain_placed),
        BAD_SWITCH(grid_hollow, hollow, beyond),
        BAD(grid_hollow, hollow, drain_radius, -1),
        BAD(grid_distance, distance, side, 9),
        BAD(grid_distance, distance, beyond, 9),
        BAD(grid_distance, distance, side, -1),
        BAD(refine, refine, start_level, 7),
        BAD(refine, refine, start_level, -2),
        BAD(refine, refine, outer_levels, 5),
        BAD(refine, refine, outer_levels, -1),
        BAD(refine, refine, tolerance, -1),
        BAD(refine, refine, tolerance, (double)INFINITY),
        BAD(refine, refine, tolerance, (double)NAN),
        BAD(voxelize_points, points, minimum, -1),
        BAD(voxelize_points, points, body, 9),
        BAD(voxelize_points, points, close_gaps, -1),
        BAD(grid_keep, keep, connectivity, 7),
        BAD_SURFACE(extract_surface, extract, ),
        BAD(extract_surface, extract, open_sides, 64),
        BAD_SWITCH(extract_surface, extract, keys),
        BAD(extract_octree, extract, face_rule, 9),
        BAD(extract_count, extract, position_type, 9),
        BAD(extract_faces, faces, position_type, 9),
        BAD_SWITCH(extract_faces, faces, local_frame),
        BAD_SWITCH(extract_faces, faces, merged),
        BAD_SURFACE(extract_scalar, scalar, ),
        BAD_SWITCH(extract_scalar, scalar, below),
        BAD(extract_scalar, scalar, open_sides, 64),
        BAD(extract_scalar, scalar, open_sides, -1),
        BAD_SWITCH(extract_scalar, scalar, keys),
        BAD(label_surfaces, labels, position_type, 9),
        BAD_SWITCH(label_surfaces, labels, local_frame),
        BAD_SWITCH(label_surfaces, labels, staircase),
        BAD_SWITCH(label_surfaces, labels, open),
        BAD(label_surfaces, labels, error, -1),
        BAD(label_surfaces, labels, error, (double)NAN),
        BAD(inspect, inspect, walls, -1),
        BAD(inspect, inspect, gaps, (double)NAN),
        BAD(inspect, inspect, density, -1),
        BAD(inspect, inspect, up, 3),
        BAD(inspect, inspect, most, -1),
        BAD(measure_field, field, sign, 99),
        BAD(measure_field, field, sign, -1),
        BAD(measure_field, field, value_type, 9),
        BAD_SWITCH(measure_field, field, no_vectors),
        BAD_SWITCH(measure_field, field, features),
        BAD_SURFACE(extract_field_surface, field_surface, placing.),
        BAD(extract_field_surface, field_surface, placing.interpolation, 99),
        BAD(extract_field_surface, field_surface, placing.interpolation, -1),
        BAD(extract_field_surface, field_surface, placing.sharp, 3),
        BAD(extract_field_surface, field_surface, placing.sharp, -1),
        BAD(extract_field_surface, field_surface, offset, 1),
        BAD(extract_field_surface, field_surface, offset, (double)NAN),
        BAD_SURFACE(boolean, boolean, placing.),
        BAD(boolean, boolean, fill, 99),
        BAD(boolean, boolean, placing.interpolation, 99),
        BAD_SWITCH(boolean, boolean, parts.keep_crumbs),
        BAD(boolean, boolean, placing.sharp, 3),
        BAD(boolean, boolean, placing.sharp, -1),
        BAD(build_lods, lod, sampling.method, 9),
        BAD(build_lods, lod, sampling.method, -1),
        BAD(build_lods, lod, sampling.edge_samples, -1),
        BAD(build_lods, lod, first_level, -1),
        BAD(build_lods, lod, sampling.threshold, (double)NAN),
        BAD_SURFACE(build_lods, lod, ),
        BAD(build_lods, lod, collapse, -1),
        BAD(build_sections, sections, caps, 9),
        BAD(build_sections, sections, slabs.crossings, 9),
        BAD(build_sections, sections, slabs.depth, -2),
        BAD(build_sections, sections, slabs.depth, 99),
        BAD(build_sections, sections, position_type, 9),
        BAD(build_sections, sections, spacing, -1),
        BAD_SURFACE(repair, repair, placing.),
        BAD(repair, repair, sign, 99),
        BAD(repair, repair, sign, -1),
        BAD(repair, repair, sign, BVX_FILL_NORMAL),
        BAD(repair, repair, placing.interpolation, 99),
        BAD(repair, repair, placing.sharp, 3),
        BAD(repair, repair, placing.sharp, -1),
        BAD_SWITCH(repair, repair, parts.keep_crumbs),
        BAD_SWITCH(repair, repair, if_needed),
        BAD(repair, repair, shell, 0.5),
        BAD(repair, repair, shell, (double)NAN),
        BAD(repair, repair, shell, 1e7),
        BAD(mesh_simplify, simplify, targets.error_kind, 2),
        BAD(mesh_simplify, simplify, targets.error_kind, -1),
        BAD(mesh_simplify, simplify, collapse.position_type, 9),
        BAD(mesh_simplify, simplify, targets.even, -2),
        BAD(mesh_simplify, simplify, targets.even, 1.5),
        BAD(mesh_simplify, simplify, targets.even, (double)NAN),
        BAD_SWITCH(mesh_simplify, simplify, targets.strict),
        BAD_SWITCH(mesh_simplify, simplify, collapse.lock_border),
        BAD_SWITCH(mesh_simplify, simplify, collapse.vertices),
        BAD_SWITCH(mesh_simplify, simplify, collapse.topology),
        BAD(mesh_simplify, simplify, collapse.attribute_weight, -2),
        BAD(mesh_simplify, simplify, collapse.attribute_weight, 1001),
        BAD_SWITCH(build_levels, levels, collapse.lock_border),
        BAD_SWITCH(build_levels, levels, collapse.vertices),
        BAD_SWITCH(build_levels, levels, collapse.topology),
        BAD(build_levels, levels, fit.reserved, 1),
        BAD(build_levels, levels, collapse.attribute_weight, 1001),
        BAD(build_levels, levels, solid, 9),
        BAD(build_levels, levels, fit.resolution, -1),
        BAD(build_levels, levels, targets.error_kind, 2),
        BAD(build_levels, levels, collapse.position_type, 9),
        BAD(build_levels, levels, targets.even, -2),
        BAD(build_levels, levels, targets.even, (double)NAN),
        BAD_SWITCH(build_levels, levels, targets.strict),
        BAD_SWITCH(build_levels, levels, solid),
        BAD(build_levels, levels, fit.resolution, -1),
        BAD(build_levels, levels, fit.resolution, (1 << 24) + 1),
        BAD(build_levels, levels, sharp, 3),
        BAD(build_levels, levels, sharp, -1),
        BAD(build_levels, levels, sign, 99),
        BAD(build_levels, levels, sign, -1),
        BAD(build_levels, levels, sign, BVX_FILL_NORMAL),
        BAD(read_sections, read_sections, close_gap, -1),
        BAD(read_sections, read_sections, close_gap, (double)NAN),
        BAD(render_mesh, render, samples, -1),
        BAD(render_mesh, render, samples, 99),
        BAD_SWITCH(render_mesh, render, smooth),
        BAD_SWITCH(render_mesh, render, wireframe),
        BAD(render_grid, render, samples, 99),
    };
    bvx_context *ctx = NULL;
    int wrong = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    make_world(ctx);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        int32_t const whole = bad[i].value - bad[i].value == 0.0 && bad[i].value < 2147483648.0 &&
                                      bad[i].value >= -2147483648.0
                                  ? (int32_t)bad[i].value
                                  : 0;
        uint64_t const held = bvx_memory_used(ctx);
        world w = right_world(ctx);
        bvx_status status;
        memset(&out, 0, sizeof out);
        w.bad_at = bad[i].at;
        w.bad_size = bad[i].size;
        w.bad = bad[i].size == 4 ? (const void *)&whole : (const void *)&bad[i].value;
        status = bad[i].make(&w);
        if ((status != BVX_ERR_ARGUMENT && status != BVX_ERR_RANGE) || bvx_memory_used(ctx) != held ||
            bvx_last_error(ctx)->reason <= BVX_REASON_UNSPECIFIED) {
            printf("%s: status %d, %s\n", bad[i].name, (int)status, bvx_last_message(ctx));
            wrong++;
        }
    }
    free_world(ctx);
    bvx_context_destroy(ctx);
    TEST_ASSERT_EQUAL_INT(0, wrong);
}

/* What is not there, or empty, needs no memory back; without a context
 * nothing can go back and nothing is touched. */
static void test_nothing_is_freed(void)
{
    bvx_context *ctx = NULL;
    bvx_attached attached;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    for (int given = 0; given < 2; given++) {
        bvx_context *const c = given ? ctx : NULL;
        bvx_grid_free(c, NULL);
        bvx_mesh_free(c, NULL);
        bvx_buffer_free(c, NULL);
        bvx_octree_free(c, NULL);
        bvx_field_free(c, NULL);
        bvx_sections_free(c, NULL);
        bvx_image_free(c, NULL);
        bvx_volume_free(c, NULL);
        bvx_closest_free(c, NULL);
        bvx_rays_free(c, NULL);
        bvx_attached_free(c, NULL);
        memset(&out, 0, sizeof out);
        memset(&attached, 0, sizeof attached);
        bvx_grid_free(c, &out.grid);
        bvx_mesh_free(c, &out.mesh);
        bvx_buffer_free(c, &out.buffer);
        bvx_field_free(c, &out.field);
        bvx_sections_free(c, &out.sections);
        bvx_image_free(c, &out.image);
        bvx_volume_free(c, &out.volume);
        bvx_attached_free(c, &attached);
    }
    make_world(ctx);
    {
        uint64_t const held = bvx_memory_used(ctx);
        bvx_grid const grid_before = solid;
        bvx_mesh const body_before = body;
        bvx_buffer const npy_before = npy;
        bvx_grid_free(NULL, &solid);
        bvx_mesh_free(NULL, &body);
        bvx_buffer_free(NULL, &npy);
        TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_used(ctx));
        TEST_ASSERT_EQUAL_MEMORY(&grid_before, &solid, sizeof solid);
        TEST_ASSERT_EQUAL_MEMORY(&body_before, &body, sizeof body);
        TEST_ASSERT_EQUAL_MEMORY(&npy_before, &npy, sizeof npy);
    }
    bvx_mesh_view_of(NULL, &bad_mesh);
    TEST_ASSERT_NULL(bad_mesh.positions);
    TEST_ASSERT_EQUAL_UINT64(0, bad_mesh.triangle_count);
    bvx_mesh_view_of(&body, NULL);
    free_world(ctx);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    bvx_context_destroy(ctx);
    bvx_context_destroy(NULL);
}

static void expect_refused(bvx_context *ctx, bvx_status status, const char *name)
{
    TEST_ASSERT_TRUE_MESSAGE(status == BVX_ERR_ARGUMENT || status == BVX_ERR_RANGE, name);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), name), bvx_last_message(ctx));
}

/* No memory holds so many bytes or numbers, so they are refused before one
 * is read; and of none there is nothing to do. */
static void test_sizes_beyond_memory_and_none(void)
{
    static const uint64_t sizes[] = {UINT64_MAX, UINT64_MAX - 63, (uint64_t)SIZE_MAX / 2 + 1};
    static const char text[] = "x";
    bvx_context *ctx = NULL;
    bvx_closest *closest = NULL;
    bvx_rays *caster = NULL;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    make_world(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &mesh, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_create(ctx, &solid, &caster));
    memset(&out, 0, sizeof out);
    for (int i = 0; i < 3; i++) {
        uint64_t const n = sizes[i];
        bvx_read_volume_options o = {.struct_size = sizeof o};
        expect_refused(ctx, bvx_read_mesh(ctx, text, n, BVX_FORMAT_PLY, NULL, &out.mesh), "bvx_read_mesh");
        expect_refused(ctx, bvx_read_points(ctx, text, n, BVX_FORMAT_XYZ, &out.mesh), "bvx_read_points");
        expect_refused(ctx, bvx_read_grid(ctx, text, n, BVX_FORMAT_NPY, NULL, &out.grid), "bvx_read_grid");
        expect_refused(ctx, bvx_read_octree(ctx, text, n, &out.tree), "bvx_read_octree");
        expect_refused(ctx, bvx_read_sections(ctx, text, n, BVX_FORMAT_CSV, NULL, &out.sections),
                       "bvx_read_sections");
        expect_refused(ctx, bvx_read_sections(ctx, text, n, BVX_FORMAT_CSL, NULL, &out.sections),
                       "bvx_read_sections");
        expect_refused(ctx, bvx_read_volume(ctx, text, n, BVX_FORMAT_NRRD, NULL, &out.volume),
                       "bvx_read_volume");
        expect_refused(ctx, bvx_volume_data_name(ctx, text, n, 0, NULL, 0, second), "bvx_volume_data_name");
        o.data = text;
        o.data_size = n;
        expect_refused(ctx, bvx_read_volume(ctx, text, 1, BVX_FORMAT_NRRD, &o, &out.volume),
                       "bvx_read_volume");
        expect_refused(ctx, bvx_grid_cast(ctx, &solid, a_ray, n, 1, (bvx_ray_hit *)&out), "bvx_grid_cast");
        expect_refused(ctx, bvx_octree_cast(ctx, tree, 0, a_ray, n, 1, (bvx_octree_hit *)&out),
                       "bvx_octree_cast");
        expect_refused(ctx, bvx_closest_winding(ctx, closest, a_point, n, (int64_t *)&out),
                       "bvx_closest_winding");
        expect_refused(ctx, bvx_rays_cast(ctx, caster, a_ray, n, 1, (bvx_ray_hit *)&out), "bvx_rays_cast");
        expect_refused(ctx, bvx_grid_sample(ctx, &solid, a_point, n, (double *)&out, NULL),
                       "bvx_grid_sample");
        expect_refused(ctx, bvx_closest_find(ctx, closest, a_point, n, (bvx_closest_point *)&out),
                       "bvx_closest_find");
        expect_refused(ctx, bvx_closest_cast(ctx, closest, a_ray, n, 1, (bvx_mesh_hit *)&out),
                       "bvx_closest_cast");
        expect_refused(ctx, bvx_closest_crossings(ctx, closest, a_ray, n, 1, (uint64_t *)&out, NULL, 0),
                       "bvx_closest_crossings");
    }
    expect_refused(ctx, bvx_closest_winding(ctx, closest, NULL, 1, (int64_t *)&out), "bvx_closest_winding");
    expect_refused(ctx, bvx_closest_links(ctx, closest, &solid, 6, NULL), "bvx_closest_links");
    expect_refused(ctx, bvx_closest_links(ctx, NULL, &solid, 6, (float *)&out), "bvx_closest_links");
    for (int32_t n = -1; n < 30; n++)
        if (n != 6 && n != 18 && n != 26)
            expect_refused(ctx, bvx_closest_links(ctx, closest, &solid, n, (float *)&out),
                           "bvx_closest_links");
    expect_refused(ctx, bvx_rays_update(ctx, caster, NULL, NULL), "bvx_rays_update");
    expect_refused(ctx, bvx_rays_update(ctx, NULL, &solid, NULL), "bvx_rays_update");
    for (int i = 0; i < 2; i++) {
        bvx_window const beyond = {{1, 0, 0}, {i * INT32_MAX, 1, 1}};
        expect_refused(ctx, bvx_rays_update(ctx, caster, &solid, &beyond), "bvx_rays_update");
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_at(ctx, tree, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_find(ctx, tree, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_cast(ctx, tree, 0, NULL, 0, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_cast(ctx, &solid, NULL, 0, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_rays_cast(ctx, caster, NULL, 0, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &solid, NULL, 0, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_cast(ctx, closest, NULL, 0, 1, NULL));
    expect_refused(ctx, bvx_octree_at(ctx, tree, NULL, 1, (bvx_octree_leaf *)&out), "bvx_octree_at");
    expect_refused(ctx, bvx_octree_find(ctx, tree, NULL, 1, (bvx_octree_leaf *)&out), "bvx_octree_find");
    expect_refused(ctx, bvx_octree_cast(ctx, tree, 0, NULL, 1, 1, (bvx_octree_hit *)&out), "bvx_octree_cast");
    expect_refused(ctx, bvx_octree_lattice(ctx, tree, 2, &bad_lattice), "bvx_octree_lattice");
    expect_refused(ctx, bvx_octree_lattice(ctx, tree, -1, &bad_lattice), "bvx_octree_lattice");
    for (int a = 0; a < 3; a++)
        for (int over = 0; over < 2; over++) {
            int32_t voxel[3] = {15, 15, 15};
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_at(ctx, tree, voxel, 1, (bvx_octree_leaf *)&out));
            voxel[a] = over ? 16 : -1;
            expect_refused(ctx, bvx_octree_at(ctx, tree, voxel, 1, (bvx_octree_leaf *)&out), "bvx_octree_at");
        }
    {
        /* 2^69 words, 2^63 words */
        int32_t const sides[2][3] = {{1 << 25, 1 << 25, 1 << 25}, {1 << 25, 1 << 25, 1 << 19}};
        int32_t const blocks[2][3] = {{65536, 65536, 1}, {65536, 65535, 2}};
        bvx_window const voxel = {{0, 0, 0}, {1, 1, 1}};
        for (int i = 0; i < 2; i++) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvx_lattice_make(ctx, unit_origin, unit_spacing, sides[i], &bad_lattice));
            TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&bad_lattice, NULL));
            memset(&out, 0, sizeof out);
            expect_refused(ctx, bvx_grid_create(ctx, &bad_lattice, NULL, &out.grid), "bvx_grid_create");
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &bad_lattice, &voxel, &out.grid));
            expect_refused(ctx, bvx_grid_coverage(ctx, &out.grid, blocks[i], NULL, 0, second),
                           "bvx_grid_coverage");
            bvx_grid_free(ctx, &out.grid);
        }
    }
    for (int a = 0; a < 3; a++)
        for (int over = 0; over < 2; over++) {
            int32_t v[3] = {0, 0, 0};
            v[a] = over ? 8 : -1;
            TEST_ASSERT_EQUAL_HEX64(UINT64_MAX, bvx_field_value(&field, v[0], v[1], v[2]));
        }
    TEST_ASSERT_EQUAL_HEX64(UINT64_MAX, bvx_field_value(NULL, 0, 0, 0));
    bvx_closest_free(ctx, closest);
    bvx_rays_free(ctx, caster);
    free_world(ctx);
    bvx_context_destroy(ctx);
}

/* Arrays of the caller's that lack something, are too small, or hold what the result would contradict. */
static void test_a_mesh_in_the_callers_arrays(void)
{
    static double room[3 * 2000];
    static uint32_t corners[3 * 4000], spare_corners[3];
    static uint64_t keys[4000];
    static uint8_t colours[4];
    static float uvs[2];

    enum {
        RIGHT,
        NO_TRIANGLES,
        NO_POSITIONS,
        OTHER_TYPE,
        FEW_VERTICES,
        FEW_TRIANGLES,
        VERTEX_KEYS,
        TRIANGLE_KEYS,
        COLOURS,
        UVS,
        UV_TRIANGLES,
        WAYS
    };
    bvx_context *ctx = NULL;
    uint64_t wanted = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    make_world(ctx);
    for (int with_keys = 0; with_keys < 2; with_keys++)
        for (int way = 0; way < WAYS; way++) {
            bvx_extract_options o = {.struct_size = sizeof o};
            bvx_mesh given, before;
            bvx_status status;
            o.position_type = BVX_F64;
            o.keys = with_keys;
            memset(&given, 0, sizeof given);
            given.positions = room;
            given.triangles = corners;
            given.vertex_capacity = 2000;
            given.triangle_capacity = 4000;
            given.position_type = BVX_F64;
            if (with_keys != (way == VERTEX_KEYS)) given.vertex_keys = keys;
            if (with_keys != (way == TRIANGLE_KEYS)) given.triangle_keys = keys;
            if (way == NO_TRIANGLES) given.triangles = NULL;
            if (way == NO_POSITIONS) given.positions = NULL;
            if (way == OTHER_TYPE) given.position_type = BVX_F32;
            if (way == FEW_VERTICES) given.vertex_capacity = 7;
            if (way == FEW_TRIANGLES) given.triangle_capacity = 11;
            if (way == COLOURS) given.colours = colours;
            if (way == UVS) given.uvs = uvs;
            if (way == UV_TRIANGLES) given.uv_triangles = spare_corners;
            before = given;
            status = bvx_extract_surface(ctx, &solid, &o, &given);
            if (way == RIGHT) {
                uint64_t hash;
                TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &given, &hash));
                if (wanted == 0) wanted = hash;
                TEST_ASSERT_EQUAL_HEX64(wanted, hash);
            } else {
                int32_t const want = way == FEW_VERTICES || way == FEW_TRIANGLES ? BVX_ERR_CAPACITY
                                                                                 : BVX_ERR_ARGUMENT;
                TEST_ASSERT_EQUAL_INT32_MESSAGE(want, status, bvx_last_message(ctx));
                TEST_ASSERT_EQUAL_MEMORY(&before, &given, sizeof given);
                TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_extract_surface"));
            }
        }
    free_world(ctx);
    bvx_context_destroy(ctx);
}

/* Arrays and counts of sections that contradict each other. */
static void test_sections_that_contradict_themselves(void)
{
    bvx_context *ctx = NULL;
    bvx_section_loop *loops;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    make_world(ctx);
    loops = sections.loops;
    for (int way = 0; way < 14; way++) {
        bvx_section_loop const loop = loops[1];
        double const position = sections.positions[1], x = sections.points[0];
        bvx_buffer file = {0};
        bad_sections = sections;
        switch (way) {
        case 0: bad_sections.points = NULL; break;
        case 1: bad_sections.loops = NULL; break;
        case 2: bad_sections.positions = NULL; break;
        case 3: bad_sections.point_count = (uint64_t)1 << 31; break;
        case 4: bad_sections.loop_count = (uint64_t)1 << 31; break;
        case 5: bad_sections.section_count = (uint64_t)1 << 31; break;
        case 6: bad_sections.reserved2[2] = 1; break;
        case 7: loops[1].reserved = 1; break;
        case 8: loops[1].label = BVX_LABEL_ZERO; break;
        case 9: loops[1].section = (uint32_t)sections.section_count; break;
        case 10: loops[1].first_point = sections.point_count + 1; break;
        case 11: loops[1].point_count = (uint32_t)sections.point_count; break;
        case 12: sections.positions[1] = (double)INFINITY; break;
        default: sections.points[0] = (double)NAN; break;
        }
        TEST_ASSERT_TRUE(bvx_write_sections(ctx, &bad_sections, BVX_FORMAT_CSL, &file) != BVX_OK);
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_write_sections"));
        TEST_ASSERT_NULL(file.bytes);
        loops[1] = loop;
        sections.positions[1] = position;
        sections.points[0] = x;
    }
    free_world(ctx);
    bvx_context_destroy(ctx);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_every_call_refuses_every_damage);
    RUN_TEST(test_nothing_is_freed);
    RUN_TEST(test_choices_out_of_range);
    RUN_TEST(test_sizes_beyond_memory_and_none);
    RUN_TEST(test_a_mesh_in_the_callers_arrays);
    RUN_TEST(test_sections_that_contradict_themselves);
    return UNITY_END();
}
