/* test_reuse.c - results passed again: every function that makes one gives into a
 * used result, small after large and large after small, what it gives into an empty
 * one; when memory fails meanwhile, nothing leaks and the result can be used on.
 * Arrays of the caller's are filled in place, refused with BVX_ERR_CAPACITY where
 * they are too small, or with BVX_ERR_ARGUMENT where a result takes none. */
#include "suite.h"

#include "bitvox_io.h"

#include <stdlib.h>
#include <string.h>

/* One model of a few voxels and one of many, as all kinds of input. */
typedef struct model {
    bvx_lattice lattice;
    bvx_grid solid;
    bvx_mesh mesh;
    bvx_mesh parts[2];
    bvx_mesh_view view;
    bvx_field field;
    bvx_octree *tree;
    bvx_sections sections;
    bvx_volume_view volume;
    bvx_complex complex_;
    bvx_image image;
    bvx_buffer ply, npy, bvx, octree, csv, json, vox;
    uint8_t *labels, palette[1024]; /* of solid */
    uint8_t *colours;               /* of mesh */
    float *samples;
    int32_t size;
} model;

typedef struct results {
    bvx_grid grid;
    bvx_mesh mesh[2];
    bvx_attached attached;
    bvx_field field;
    bvx_octree *tree;
    bvx_sections sections;
    bvx_buffer file;
    bvx_image image;
    bvx_volume volume;
    bvx_complex complex_;
    uint8_t palette[1024];
} results;

static model models[2];

/* ---- the functions ---- */

#define ROW(name, call)                                                \
    static bvx_status name(bvx_context *c, const model *m, results *r) \
    {                                                                  \
        return call;                                                   \
    }
ROW(create, bvx_grid_create(c, &m->lattice, NULL, &r->grid))
ROW(solid, bvx_voxelize_solid(c, &m->view, &m->lattice, NULL, &r->grid))
ROW(points, bvx_voxelize_points(c, &m->view, &m->lattice, NULL, &r->grid))
ROW(combine, bvx_grid_combine(c, &m->solid, &m->field.band, BVX_BOOLEAN_UNION, &r->grid))
ROW(complement, bvx_grid_complement(c, &m->solid, &r->grid))
ROW(resample, bvx_grid_resample(c, &m->solid, &m->lattice, NULL, &r->grid))
ROW(dilate, bvx_grid_morph(c, &m->solid, BVX_MORPH_DILATE, NULL, &r->grid))
ROW(keep, bvx_grid_keep(c, &m->solid, NULL, &r->grid))
ROW(cavities, bvx_grid_fill_cavities(c, &m->solid, 6, 0, &r->grid, NULL))
ROW(threshold, bvx_threshold(c, &m->volume, 0, 1e9, NULL, &r->grid))
/* The bits of floats above 0 are integers above 0. */
static bvx_status threshold_whole(bvx_context *c, const model *m, results *r)
{
    bvx_volume_view view = m->volume;
    view.sample_type = BVX_SAMPLE_I32;
    return bvx_threshold_whole(c, &view, 1, INT32_MAX, NULL, &r->grid);
}
ROW(expand, bvx_octree_expand(c, m->tree, 0, 0, NULL, &r->grid))
ROW(read_npy, bvx_read_grid(c, m->npy.bytes, m->npy.size, BVX_FORMAT_NPY, NULL, &r->grid))
ROW(read_bvx, bvx_read_grid(c, m->bvx.bytes, m->bvx.size, BVX_FORMAT_BVX, NULL, &r->grid))
ROW(surface, bvx_extract_surface(c, &m->solid, NULL, &r->mesh[0]))
ROW(faces, bvx_extract_faces(c, &m->solid, NULL, &r->mesh[0]))
ROW(scalar, bvx_extract_scalar(c, &m->volume, NULL, &r->mesh[0]))
static bvx_status label_surfaces(bvx_context *c, const model *m, results *r)
{
    bvx_labels_options const o = {.struct_size = sizeof o, .staircase = 1};
    bvx_volume_view view = m->volume;
    view.sample_type = BVX_SAMPLE_I32; /* the bits of floats */
    return bvx_label_surfaces(c, &view, &o, &r->complex_);
}
ROW(label_mesh, bvx_label_mesh(c, &m->complex_, 0, &r->mesh[0]))
ROW(field_surface, bvx_extract_field_surface(c, &m->field, NULL, NULL, &r->mesh[0]))
ROW(octree_surface, bvx_extract_octree(c, m->tree, 0, NULL, &r->mesh[0]))
ROW(merge, bvx_mesh_merge(c, m->parts, 1, &r->mesh[0]))
ROW(simplify, bvx_mesh_simplify(c, &m->view, NULL, 2, r->mesh))
ROW(levels, bvx_build_levels(c, &m->view, NULL, 2, r->mesh))
ROW(read_ply, bvx_read_mesh(c, m->ply.bytes, m->ply.size, BVX_FORMAT_PLY, NULL, &r->mesh[0]))
ROW(read_cloud, bvx_read_points(c, m->ply.bytes, m->ply.size, BVX_FORMAT_PLY, &r->mesh[0]))
ROW(join_sections, bvx_build_sections(c, &m->sections, NULL, &r->mesh[0]))
ROW(join_bodies, bvx_build_bodies(c, &m->sections, NULL, (const int32_t[]){1}, 1, r->mesh))
ROW(measure, bvx_measure_field(c, &m->view, &m->lattice, NULL, &r->field))
ROW(read_octree, bvx_read_octree(c, m->octree.bytes, m->octree.size, &r->tree))
ROW(read_csv, bvx_read_sections(c, m->csv.bytes, m->csv.size, BVX_FORMAT_CSV, NULL, &r->sections))
ROW(write_mesh, bvx_write_mesh(c, &m->mesh, 1, NULL, BVX_FORMAT_OBJ, &r->file))
ROW(write_ply, bvx_write_mesh(c, &m->mesh, 1, NULL, BVX_FORMAT_PLY, &r->file))
ROW(write_levels, bvx_write_mesh(c, &m->mesh, 1, NULL, BVX_FORMAT_GLB, &r->file))
ROW(write_binvox, bvx_write_grid(c, &m->solid, BVX_FORMAT_BINVOX, &r->file))
ROW(write_labels, bvx_write_labels(c, &m->solid, m->labels, m->palette, BVX_FORMAT_VOX, &r->file))
ROW(read_labels, bvx_read_labels(c, m->vox.bytes, m->vox.size, BVX_FORMAT_VOX, &r->file, r->palette))
ROW(write_octree, bvx_write_octree(c, m->tree, 0, BVX_FORMAT_BVX, &r->file))
ROW(write_field, bvx_write_field(c, &m->field, 0, BVX_FORMAT_NPY, &r->file))
ROW(write_lattice, bvx_write_lattice(c, &m->solid, &r->file))
ROW(write_head, bvx_write_head(c, &m->lattice, NULL, &r->file))
ROW(write_slices, bvx_write_slices(c, &m->solid, &r->file))
ROW(write_csv, bvx_write_sections(c, &m->sections, BVX_FORMAT_CSV, &r->file))
ROW(write_png, bvx_write_png(c, &m->image, &r->file))
ROW(read_volume, bvx_read_volume(c, m->npy.bytes, m->npy.size, BVX_FORMAT_NPY, NULL, &r->volume))

static bvx_status slice(bvx_context *c, const model *m, results *r)
{
    bvx_slice_options o = {.struct_size = sizeof o};

    o.spacing = 1;
    return bvx_slice_mesh(c, &m->view, &o, &r->sections);
}

static bvx_status hollow(bvx_context *c, const model *m, results *r)
{
    bvx_hollow_options o = {.struct_size = sizeof o};

    o.thickness = 1;
    return bvx_grid_hollow(c, &m->solid, &o, &r->grid);
}

static bvx_status downsample(bvx_context *c, const model *m, results *r)
{
    static const int32_t factor[3] = {2, 2, 2};

    return bvx_grid_downsample(c, &m->solid, factor, BVX_REDUCE_ANY, &r->grid);
}

static bvx_status crop(bvx_context *c, const model *m, results *r)
{
    bvx_window const w = {{0, 0, 0}, {m->size, m->size - 1, m->size - 1}};

    return bvx_grid_crop(c, &m->solid, &w, &r->grid);
}

static bvx_status read_finite(bvx_context *c, const model *m, results *r)
{
    bvx_read_options options = {.struct_size = sizeof options};

    options.drop_nonfinite = 1;
    return bvx_read_mesh(c, m->ply.bytes, m->ply.size, BVX_FORMAT_PLY, &options, &r->mesh[0]);
}

static bvx_status drop_nonfinite(bvx_context *c, const model *m, results *r)
{
    bvx_status const status = bvx_read_mesh(c, m->ply.bytes, m->ply.size, BVX_FORMAT_PLY, NULL, &r->mesh[0]);
    uint64_t dropped;

    return status == BVX_OK ? bvx_mesh_drop_nonfinite(c, &r->mesh[0], &dropped) : status;
}

/* Colours of the time before go with the surface that had them, and come again. */
static bvx_status carry(bvx_context *c, const model *m, results *r)
{
    bvx_status const status = bvx_extract_surface(c, &m->solid, NULL, &r->mesh[0]);
    bvx_mesh source = m->mesh;

    source.colours = m->colours;
    return status == BVX_OK ? bvx_mesh_carry(c, &source, &r->mesh[0]) : status;
}

static bvx_status read_lattice(bvx_context *c, const model *m, results *r)
{
    bvx_status const status = bvx_read_grid(c, m->npy.bytes, m->npy.size, BVX_FORMAT_NPY, NULL, &r->grid);

    return status == BVX_OK ? bvx_read_lattice(c, m->json.bytes, m->json.size, &r->grid) : status;
}

static bvx_status pad(bvx_context *c, const model *m, results *r)
{
    static const int32_t low[3] = {1, 0, 2}, high[3] = {0, 3, 1};

    return bvx_grid_pad(c, &m->solid, low, high, &r->grid);
}

static bvx_status permute(bvx_context *c, const model *m, results *r)
{
    static const int32_t axes[3] = {2, 0, 1};

    return bvx_grid_permute(c, &m->solid, axes, NULL, &r->grid);
}

static bvx_status fill(bvx_context *c, const model *m, results *r)
{
    static const int32_t seed[3] = {0, 0, 0};

    return bvx_grid_fill(c, &m->solid, seed, 1, 6, &r->grid);
}

static bvx_status touch(bvx_context *c, const model *m, results *r)
{
    bvx_surface_options o = {.struct_size = sizeof o};

    o.attached = &r->attached;
    return bvx_voxelize_surface(c, &m->view, &m->lattice, &o, &r->grid);
}

static bvx_status repair(bvx_context *c, const model *m, results *r)
{
    bvx_repair_options o = {.struct_size = sizeof o};

    o.fit.lattice = &m->lattice;
    return bvx_repair(c, &m->view, &o, &r->mesh[0]);
}

static bvx_status hull(bvx_context *c, const model *m, results *r)
{
    bvx_hull_options o = {.struct_size = sizeof o};

    o.fit.lattice = &m->lattice;
    return bvx_hull(c, &m->view, &o, 1, &r->mesh[0]);
}

static bvx_status boolean(bvx_context *c, const model *m, results *r)
{
    bvx_boolean_options o = {.struct_size = sizeof o};

    o.fit.lattice = &m->lattice;
    return bvx_boolean(c, &m->view, &m->view, BVX_BOOLEAN_UNION, &o, &r->mesh[0]);
}

static bvx_status lods(bvx_context *c, const model *m, results *r)
{
    int32_t const resolutions[2] = {m->size, m->size / 2};
    bvx_lod_options o = {.struct_size = sizeof o};

    o.resolutions = resolutions;
    return bvx_build_lods(c, &m->solid, &o, 2, r->mesh);
}

static bvx_status refine(bvx_context *c, const model *m, results *r)
{
    bvx_refine_options o = {.struct_size = sizeof o};

    o.levels = 1;
    return bvx_refine(c, &m->view, &m->lattice, &o, &r->tree);
}

static void picture_options(const model *m, bvx_render_options *o)
{
    *o = (bvx_render_options){.struct_size = sizeof *o};
    o->width = o->height = 4 * m->size;
}

static bvx_status render_mesh(bvx_context *c, const model *m, results *r)
{
    bvx_render_options o;

    picture_options(m, &o);
    return bvx_render_mesh(c, &m->view, &o, &r->image);
}

static bvx_status render_grid(bvx_context *c, const model *m, results *r)
{
    bvx_render_options o;

    picture_options(m, &o);
    return bvx_render_grid(c, &m->solid, &o, &r->image);
}

static bvx_status render_difference(bvx_context *c, const model *m, results *r)
{
    bvx_render_options o;

    picture_options(m, &o);
    return bvx_render_difference(c, &m->solid, &m->field.band, &o, &r->image);
}

static const struct row {
    const char *name;
    bvx_status (*run)(bvx_context *c, const model *m, results *r);
} rows[] = {
    {"bvx_grid_create", create},
    {"bvx_voxelize_solid", solid},
    {"bvx_voxelize_surface", touch},
    {"bvx_voxelize_points", points},
    {"bvx_grid_combine", combine},
    {"bvx_grid_complement", complement},
    {"bvx_grid_resample", resample},
    {"bvx_grid_downsample", downsample},
    {"bvx_grid_pad", pad},
    {"bvx_read_mesh, finite", read_finite},
    {"bvx_mesh_drop_nonfinite", drop_nonfinite},
    {"bvx_mesh_carry", carry},
    {"bvx_read_lattice", read_lattice},
    {"bvx_write_mesh, .ply", write_ply},
    {"bvx_render_difference", render_difference},
    {"bvx_grid_crop", crop},
    {"bvx_grid_permute", permute},
    {"bvx_grid_fill", fill},
    {"bvx_grid_hollow", hollow},
    {"bvx_grid_morph", dilate},
    {"bvx_grid_keep", keep},
    {"bvx_grid_fill_cavities", cavities},
    {"bvx_threshold", threshold},
    {"bvx_threshold_whole", threshold_whole},
    {"bvx_octree_expand", expand},
    {"bvx_read_grid, .npy", read_npy},
    {"bvx_read_grid, .bvx", read_bvx},
    {"bvx_extract_surface", surface},
    {"bvx_extract_faces", faces},
    {"bvx_extract_scalar", scalar},
    {"bvx_label_surfaces", label_surfaces},
    {"bvx_label_mesh", label_mesh},
    {"bvx_extract_octree", octree_surface},
    {"bvx_extract_field_surface", field_surface},
    {"bvx_mesh_merge", merge},
    {"bvx_mesh_simplify", simplify},
    {"bvx_build_levels", levels},
    {"bvx_build_lods", lods},
    {"bvx_repair", repair},
    {"bvx_hull", hull},
    {"bvx_boolean", boolean},
    {"bvx_read_mesh", read_ply},
    {"bvx_read_points", read_cloud},
    {"bvx_build_sections", join_sections},
    {"bvx_build_bodies", join_bodies},
    {"bvx_measure_field", measure},
    {"bvx_refine", refine},
    {"bvx_read_octree", read_octree},
    {"bvx_slice_mesh", slice},
    {"bvx_read_sections", read_csv},
    {"bvx_write_mesh", write_mesh},
    {"bvx_write_mesh, .glb", write_levels},
    {"bvx_write_grid", write_binvox},
    {"bvx_write_octree", write_octree},
    {"bvx_write_labels", write_labels},
    {"bvx_read_labels", read_labels},
    {"bvx_write_field", write_field},
    {"bvx_write_lattice", write_lattice},
    {"bvx_write_head", write_head},
    {"bvx_write_slices", write_slices},
    {"bvx_write_sections", write_csv},
    {"bvx_write_png", write_png},
    {"bvx_render_mesh", render_mesh},
    {"bvx_render_grid", render_grid},
    {"bvx_read_volume", read_volume},
};

enum { ROWS = sizeof rows / sizeof rows[0] };

/* ---- results ---- */

static uint64_t signature(bvx_context *c, const results *r)
{
    uint64_t h = 1, part = 0;

    if (r->grid.words != NULL && bvx_grid_hash(c, &r->grid, &part) == BVX_OK)
        h = bvx_hash(&part, sizeof part, h);
    for (int i = 0; i < 2; i++)
        if (r->mesh[i].positions != NULL && bvx_mesh_hash(c, &r->mesh[i], &part) == BVX_OK)
            h = bvx_hash(&part, sizeof part, h);
    if (r->mesh[0].colours != NULL) h = bvx_hash(r->mesh[0].colours, (size_t)r->mesh[0].vertex_count * 4, h);
    h = bvx_hash(r->attached.triangles, (size_t)r->attached.triangle_count * 4, h);
    h = bvx_hash(r->field.distances, (size_t)r->field.value_count * 4, h);
    if (r->tree != NULL && bvx_octree_leaves(c, r->tree, BVX_STATE_SURFACE, NULL, 0, &part) == BVX_OK)
        h = bvx_hash(&part, sizeof part, h);
    h = bvx_hash(r->sections.points, (size_t)r->sections.point_count * 24, h);
    h = bvx_hash(r->file.bytes, (size_t)r->file.size, h);
    h = bvx_hash(r->image.pixels, (size_t)r->image.width * (size_t)r->image.height * 3, h);
    h = bvx_hash(r->volume.view.size, sizeof r->volume.view.size, h);
    h = bvx_hash(r->complex_.mesh.triangles, (size_t)r->complex_.face_count * 24, h);
    return bvx_hash(r->complex_.sides, (size_t)r->complex_.face_count * 8, h);
}

static void free_results(bvx_context *c, results *r)
{
    bvx_complex_free(c, &r->complex_);
    bvx_volume_free(c, &r->volume);
    bvx_image_free(c, &r->image);
    bvx_buffer_free(c, &r->file);
    bvx_sections_free(c, &r->sections);
    bvx_octree_free(c, r->tree);
    bvx_field_free(c, &r->field);
    bvx_attached_free(c, &r->attached);
    bvx_mesh_free(c, &r->mesh[1]);
    bvx_mesh_free(c, &r->mesh[0]);
    bvx_grid_free(c, &r->grid);
    memset(r, 0, sizeof *r);
}

static uint64_t fresh_signature(const struct row *row, const model *m)
{
    results r = {0};
    uint64_t h;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, row->run(ctx, m, &r), bvx_last_message(ctx));
    h = signature(ctx, &r);
    free_results(ctx, &r);
    return h;
}

static void test_results_are_passed_again(void)
{
    static const int turns[] = {0, 1, 0, 1, 1};

    for (int i = 0; i < ROWS; i++) {
        uint64_t const expected[2] = {fresh_signature(&rows[i], &models[0]),
                                      fresh_signature(&rows[i], &models[1])};
        uint64_t const before = bvx_memory_used(ctx);
        results r = {0};

        TEST_ASSERT_TRUE_MESSAGE(expected[0] != expected[1], rows[i].name);
        for (size_t k = 0; k < sizeof turns / sizeof turns[0]; k++) {
            bvx_status const status = rows[i].run(ctx, &models[turns[k]], &r);

            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
            TEST_ASSERT_EQUAL_HEX64_MESSAGE(expected[turns[k]], signature(ctx, &r), rows[i].name);
        }
        free_results(ctx, &r);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(before, bvx_memory_used(ctx), rows[i].name);
    }
}

/* ---- memory that fails ---- */

typedef struct failing {
    int64_t left, held;
} failing;

static void *fail_alloc(void *user, size_t size, size_t align)
{
    failing *const f = user;
    unsigned char *raw, *block;

    if (f->left-- <= 0) return NULL;
    raw = malloc(size + align + sizeof raw);
    if (raw == NULL) return NULL;
    block = raw + sizeof raw;
    block += (align - (uintptr_t)block % align) % align;
    memcpy(block - sizeof raw, &raw, sizeof raw);
    f->held++;
    return block;
}

static void fail_free(void *user, void *block, size_t size, size_t align)
{
    unsigned char *raw;

    (void)size, (void)align;
    memcpy(&raw, (unsigned char *)block - sizeof raw, sizeof raw);
    ((failing *)user)->held--;
    free(raw);
}

/* Large after small with every request failing once, some of them where there are many; then small again. */
static void test_failures_leave_results_that_can_be_used(void)
{
    for (int i = 0; i < ROWS; i++) {
        uint64_t const expected = fresh_signature(&rows[i], &models[0]);
        failing f = {INT64_MAX, 0};
        bvx_context_options o = {.struct_size = sizeof o};
        bvx_context *c = NULL;
        results r = {0};
        bvx_status status = BVX_ERR_MEMORY;

        o.allocator.alloc = fail_alloc;
        o.allocator.free = fail_free;
        o.allocator.user = &f;
        o.threads = 1;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &c));
        for (int64_t n = 0; status != BVX_OK; n += 1 + n / (long_run ? 8 : 2)) {
            f.left = INT64_MAX;
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, rows[i].run(c, &models[0], &r), bvx_last_message(c));
            TEST_ASSERT_EQUAL_HEX64_MESSAGE(expected, signature(c, &r), rows[i].name);
            f.left = n;
            status = rows[i].run(c, &models[1], &r);
            if (status != BVX_OK)
                TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_MEMORY, status, bvx_last_message(c));
        }
        f.left = INT64_MAX;
        free_results(c, &r);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, bvx_memory_used(c), rows[i].name);
        bvx_context_destroy(c);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(0, f.held, rows[i].name);
    }
}

/* ---- arrays of the caller's ---- */

/* Calls that refuse them, as the header says of each, or that make one result out of another. */
static const char *const takes_none[] = {"bvx_read_mesh",           "bvx_read_mesh, finite",
                                         "bvx_mesh_drop_nonfinite", "bvx_read_points",
                                         "bvx_mesh_carry",          "bvx_extract_octree"};

static int refuses_arrays(const char *name)
{
    for (size_t i = 0; i < sizeof takes_none / sizeof takes_none[0]; i++)
        if (strcmp(name, takes_none[i]) == 0) return 1;
    return 0;
}

/* A result of exactly the size of made, whose arrays are the caller's: reads and writes beyond them are seen by
 * sanitizers. */
static void bring_grid(const bvx_grid *made, bvx_grid *own)
{
    memset(own, 0, sizeof *own);
    own->word_capacity = (uint64_t)made->words_per_row * (uint64_t)made->size[1] * (uint64_t)made->size[2];
    own->words = malloc((size_t)own->word_capacity * sizeof *own->words);
}

static void bring_mesh(const bvx_mesh *made, bvx_mesh *own)
{
    size_t const scalar = made->position_type == BVX_F64 ? sizeof(double) : sizeof(float);

    memset(own, 0, sizeof *own);
    own->position_type = made->position_type;
    own->vertex_capacity = made->vertex_count;
    own->triangle_capacity = made->triangle_count;
    own->positions = malloc((size_t)made->vertex_count * 3 * scalar);
    own->triangles = malloc((size_t)made->triangle_count * 3 * sizeof *own->triangles);
    if (made->vertex_keys == NULL) return;
    own->vertex_keys = malloc((size_t)made->vertex_count * sizeof *own->vertex_keys);
    own->triangle_keys = malloc((size_t)made->triangle_count * sizeof *own->triangle_keys);
}

static void bring(const results *made, results *own)
{
    memset(own, 0, sizeof *own);
    if (made->grid.words != NULL) bring_grid(&made->grid, &own->grid);
    for (int i = 0; i < 2; i++)
        if (made->mesh[i].positions != NULL) bring_mesh(&made->mesh[i], &own->mesh[i]);
}

static void drop_brought(results *own)
{
    free(own->grid.words);
    own->grid.words = NULL;
    for (int i = 0; i < 2; i++) {
        free(own->mesh[i].positions);
        free(own->mesh[i].triangles);
        free(own->mesh[i].vertex_keys);
        free(own->mesh[i].triangle_keys);
        memset(&own->mesh[i], 0, sizeof own->mesh[i]);
    }
    /* What the library made beside them. */
    memset(&own->grid, 0, sizeof own->grid);
    free_results(ctx, own);
}

/* Whole, then one word, vertex or triangle too small. */
static void check_brought(const struct row *row, const results *made)
{
    for (int way = 0; way < 3; way++) {
        int const grid = made->grid.words != NULL;
        results own, before;
        bvx_status status;

        bring(made, &own);
        if (way == 1 && grid) own.grid.word_capacity--;
        if (way == 1 && !grid) own.mesh[0].vertex_capacity--;
        if (way == 2 && grid) own.grid.word_capacity = 1;
        if (way == 2 && !grid) own.mesh[0].triangle_capacity--;
        before = own;
        status = row->run(ctx, &models[1], &own);

        if (refuses_arrays(row->name)) {
            /* Too small is found by the call that makes what is carried to. */
            if (way == 0 || status != BVX_ERR_CAPACITY)
                TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_ARGUMENT, status, row->name);
        } else if (way != 0) {
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_CAPACITY, status, row->name);
        } else {
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
            TEST_ASSERT_EQUAL_HEX64_MESSAGE(signature(ctx, made), signature(ctx, &own), row->name);
        }
        /* The caller's they are before and after, whatever became of the call. */
        TEST_ASSERT_EQUAL_PTR_MESSAGE(before.grid.words, own.grid.words, row->name);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(0, own.grid.owned, row->name);
        for (int i = 0; i < 2; i++) {
            TEST_ASSERT_EQUAL_PTR_MESSAGE(before.mesh[i].positions, own.mesh[i].positions, row->name);
            TEST_ASSERT_EQUAL_PTR_MESSAGE(before.mesh[i].triangles, own.mesh[i].triangles, row->name);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(0, own.mesh[i].owned, row->name);
        }
        drop_brought(&own);
    }
}

static void test_arrays_of_the_callers_are_filled_or_too_small(void)
{
    for (int i = 0; i < ROWS; i++) {
        uint64_t const held = bvx_memory_used(ctx);
        results made = {0};

        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, rows[i].run(ctx, &models[1], &made), bvx_last_message(ctx));
        if (made.grid.words != NULL || made.mesh[0].positions != NULL) check_brought(&rows[i], &made);
        free_results(ctx, &made);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(held, bvx_memory_used(ctx), rows[i].name);
    }
}

/* ---- models ---- */

static void make_model(model *m, int32_t size)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {size, size, size};
    double const middle = size / 2.0, radius = size / 2.0 - 1.5;
    bvx_refine_options refining = {.struct_size = sizeof refining};
    bvx_render_options picture = {.struct_size = sizeof picture};
    bvx_slice_options slicing = {.struct_size = sizeof slicing};
    uint64_t at = 0;

    m->size = size;
    m->samples = malloc((size_t)size * (size_t)size * (size_t)size * sizeof *m->samples);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &m->lattice));
    for (int32_t z = 0; z < size; z++)
        for (int32_t y = 0; y < size; y++)
            for (int32_t x = 0; x < size; x++) {
                double const p[3] = {x + 0.5 - middle, y + 0.5 - middle, z + 0.5 - middle};

                m->samples[at++] = (float)(radius * radius - p[0] * p[0] - p[1] * p[1] - p[2] * p[2]);
            }
    m->volume.samples = m->samples;
    m->volume.sample_type = BVX_SAMPLE_F32;
    m->volume.size[0] = m->volume.size[1] = m->volume.size[2] = size;
    m->volume.lattice = m->lattice;

#define MADE(call) TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, call, bvx_last_message(ctx))
    {
        bvx_volume_view view = m->volume;

        view.sample_type = BVX_SAMPLE_I32; /* the bits of floats */
        MADE(bvx_label_surfaces(ctx, &view, NULL, &m->complex_));
    }
    MADE(bvx_threshold(ctx, &m->volume, 0, 1e9, NULL, &m->solid));
    MADE(bvx_extract_scalar(ctx, &m->volume, NULL, &m->mesh));
    {
        bvx_extract_options o = {.struct_size = sizeof o};

        o.keys = 1;
        MADE(bvx_extract_surface(ctx, &m->solid, &o, &m->parts[0]));
    }
    m->colours = malloc((size_t)m->mesh.vertex_count * 4);
    for (uint64_t i = 0; i < m->mesh.vertex_count * 4; i++) m->colours[i] = (uint8_t)(i % 251);
    bvx_mesh_view_of(&m->mesh, &m->view);
    MADE(bvx_measure_field(ctx, &m->view, &m->lattice, NULL, &m->field));
    refining.levels = 1;
    MADE(bvx_refine(ctx, &m->view, &m->lattice, &refining, &m->tree));
    slicing.spacing = 1;
    MADE(bvx_slice_mesh(ctx, &m->view, &slicing, &m->sections));
    picture.width = picture.height = size;
    MADE(bvx_render_mesh(ctx, &m->view, &picture, &m->image));
    MADE(bvx_write_mesh(ctx, &m->mesh, 1, NULL, BVX_FORMAT_PLY, &m->ply));
    MADE(bvx_write_grid(ctx, &m->solid, BVX_FORMAT_NPY, &m->npy));
    MADE(bvx_write_grid(ctx, &m->solid, BVX_FORMAT_BVX, &m->bvx));
    MADE(bvx_write_lattice(ctx, &m->solid, &m->json));
    MADE(bvx_write_octree(ctx, m->tree, 0, BVX_FORMAT_BVX, &m->octree));
    m->labels = calloc((size_t)(size * size * size), 1);
    for (int i = 0; i < size * size * size; i++)
        m->labels[i] = bvx_grid_get(&m->solid, i % size, i / size % size, i / size / size)
                           ? (uint8_t)(1 + i % 9)
                           : 0;
    MADE(bvx_write_labels(ctx, &m->solid, m->labels, m->palette, BVX_FORMAT_VOX, &m->vox));
    MADE(bvx_write_sections(ctx, &m->sections, BVX_FORMAT_CSV, &m->csv));
#undef MADE
}

static void free_model(model *m)
{
    bvx_complex_free(ctx, &m->complex_);
    bvx_buffer *const files[] = {&m->ply, &m->npy, &m->bvx, &m->octree, &m->csv, &m->json, &m->vox};

    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) bvx_buffer_free(ctx, files[i]);
    bvx_image_free(ctx, &m->image);
    bvx_sections_free(ctx, &m->sections);
    bvx_octree_free(ctx, m->tree);
    bvx_field_free(ctx, &m->field);
    bvx_mesh_free(ctx, &m->parts[0]);
    bvx_mesh_free(ctx, &m->mesh);
    bvx_grid_free(ctx, &m->solid);
    free(m->colours);
    free(m->labels);
    free(m->samples);
    memset(m, 0, sizeof *m);
}

void setUp(void)
{
    suite_open(0);
    make_model(&models[0], 10);
    make_model(&models[1], 23);
}

void tearDown(void)
{
    free_model(&models[0]);
    free_model(&models[1]);
    suite_close();
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_results_are_passed_again);
    RUN_TEST(test_failures_leave_results_that_can_be_used);
    RUN_TEST(test_arrays_of_the_callers_are_filled_or_too_small);
    return UNITY_END();
}
