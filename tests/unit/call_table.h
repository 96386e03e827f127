/* call_table.h - every public function that takes a context and returns a status, as a row of a table, and a
 * small world of inputs for all of them. Included by one file of a test program. */
#ifndef CALL_TABLE_H
#define CALL_TABLE_H

#include "bitvox_io.h"

#include <string.h>

/* What a call takes, and what can be wrong with it. */
enum {
    MESH = 1,
    POINTS = 2,
    LATTICE = 4,
    GRID = 8,
    OTHER = 16,
    TREE = 32,
    FIELD = 64,
    SECTIONS = 128,
    VOLUME = 256,
    OPTIONS = 512,
    BODY = 1024,
    BYTES = 2048,
    IMAGE = 4096,
    SECOND = 8192,
    SLOT = 16384,
    RESERVED = 32768,
    COMPLEX = 131072,
    INNER = 65536 /* a message may name the public function that the call makes in its turn */
};
/* Into what it writes. */
enum {
    PLAIN,
    TO_GRID,
    TO_MESH,
    TO_BUFFER,
    TO_TREE,
    TO_FIELD,
    TO_SECTIONS,
    TO_IMAGE,
    TO_VOLUME,
    TO_CLOSEST,
    TO_RAYS,
    TO_COMPLEX
};

typedef union result {
    bvx_grid grid;
    bvx_mesh mesh;
    bvx_buffer buffer;
    bvx_octree *tree;
    bvx_field field;
    bvx_sections sections;
    bvx_image image;
    bvx_volume volume;
    bvx_closest *closest;
    bvx_rays *caster;
    bvx_complex complex_;
    unsigned char plain[4096];
} result;

typedef struct world {
    bvx_context *ctx;
    const bvx_mesh_view *mesh, *points;
    const bvx_lattice *lattice;
    const bvx_grid *grid, *other;
    const bvx_octree *tree;
    const bvx_field *field;
    const bvx_sections *sections;
    const bvx_volume_view *volume;
    const bvx_complex *complex_;
    const bvx_mesh *body;
    const bvx_image *image;
    const bvx_buffer *file, *lattice_file; /* bytes and size of the format that a reader wants */
    int wrong_size, wrong_reserved;        /* of the options */
    size_t bad_at, bad_size;               /* a field of the options to spoil */
    const void *bad;
    result *out;
    void *second; /* of two outputs, or the place of a count */
} world;

/* Options of a call, with the damage of this run. */
#define TAKE_OPTIONS(kind, name)                              \
    bvx_##kind##_options name = {.struct_size = sizeof name}; \
    if (w->wrong_size) name.struct_size = 1
/* After what the call needs. */
#define SPOIL(name) \
    if (w->bad_size != 0) memcpy((char *)&name + w->bad_at, w->bad, w->bad_size)
#define TAKE_RESERVED(place) \
    if (w->wrong_reserved) (place) = 1

static const double unit_origin[3] = {0, 0, 0}, unit_spacing[3] = {1, 1, 1};
static const int32_t eight[3] = {8, 8, 8}, two[3] = {2, 2, 2}, zeros[3] = {0, 0, 0}, own_axes[3] = {0, 1, 2};
static const double a_ray[6] = {-1, 4, 4, 1, 0, 0}, a_point[3] = {4, 4, 4};

static bvx_status lattice_fit(const world *w)
{
    return bvx_lattice_fit(w->ctx, w->mesh, 8, (bvx_lattice *)w->out);
}
static bvx_status lattice_fit_with(const world *w)
{
    TAKE_OPTIONS(lattice, o);
    o.resolution = 8;
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_lattice_fit_with(w->ctx, w->mesh, &o, (bvx_lattice *)w->out);
}
static bvx_status lattice_make(const world *w)
{
    return bvx_lattice_make(w->ctx, unit_origin, unit_spacing, eight, (bvx_lattice *)w->out);
}
static bvx_status grid_create(const world *w)
{
    return bvx_grid_create(w->ctx, w->lattice, NULL, (bvx_grid *)w->out);
}
static bvx_status grid_count(const world *w)
{
    return bvx_grid_count(w->ctx, w->grid, (uint64_t *)w->out);
}
static bvx_status grid_hash(const world *w)
{
    return bvx_grid_hash(w->ctx, w->grid, (uint64_t *)w->out);
}
static bvx_status mesh_hash(const world *w)
{
    return bvx_mesh_hash(w->ctx, w->body, (uint64_t *)w->out);
}
static bvx_status mesh_check(const world *w)
{
    return bvx_mesh_check(w->ctx, w->mesh, 1, (bvx_certificate *)w->out);
}
static bvx_status mesh_normals(const world *w)
{
    return bvx_mesh_normals(w->ctx, w->mesh, 1, (float *)w->out, NULL);
}
static bvx_status mesh_smooth(const world *w)
{
    TAKE_OPTIONS(smooth, o);
    TAKE_RESERVED(o.reserved[1]);
    SPOIL(o);
    return bvx_mesh_smooth(w->ctx, w->mesh, &o, w->out);
}
static bvx_status mesh_distance(const world *w)
{
    return bvx_mesh_distance(w->ctx, w->mesh, w->mesh, 10, 1, (bvx_distance_report *)w->out);
}
static bvx_status measure(const world *w)
{
    TAKE_OPTIONS(measure, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_measure(w->ctx, w->mesh, &o, (bvx_measure_report *)w->out);
}
static bvx_status inspect(const world *w)
{
    TAKE_OPTIONS(inspect, o);
    o.fit.resolution = 8;
    TAKE_RESERVED(o.fit.reserved);
    SPOIL(o);
    return bvx_inspect(w->ctx, w->mesh, &o, (bvx_inspect_report *)w->out);
}
static bvx_status mesh_crossings(const world *w)
{
    return bvx_mesh_crossings(w->ctx, w->mesh, w->second, (uint32_t *)w->out, 8);
}
static bvx_mesh undropped; /* finite, so it stays as it is */
static bvx_status mesh_drop_nonfinite(const world *w)
{
    if (w->body != NULL) undropped = *w->body;
    return bvx_mesh_drop_nonfinite(w->ctx, w->body != NULL ? &undropped : NULL, (uint64_t *)w->out);
}
static bvx_status closest_create(const world *w)
{
    return bvx_closest_create(w->ctx, w->mesh, (bvx_closest **)w->out);
}
static bvx_mesh coloured; /* written into again and again */
static bvx_status mesh_carry(const world *w)
{
    return bvx_mesh_carry(w->ctx, w->body, w->second != NULL ? &coloured : NULL);
}
static bvx_status label_voxels(const world *w)
{
    static uint8_t colours[4 * 4096];
    bvx_mesh painted = {0};

    if (w->body != NULL) painted = *w->body;
    painted.colours = colours;
    return bvx_label_voxels(w->ctx, w->body != NULL ? &painted : NULL, w->grid, (uint8_t *)w->out,
                            (uint8_t *)w->second);
}
static bvx_status grid_cast(const world *w)
{
    return bvx_grid_cast(w->ctx, w->grid, a_ray, 1, 100, (bvx_ray_hit *)w->out);
}
static bvx_status rays_create(const world *w)
{
    return bvx_rays_create(w->ctx, w->grid, (bvx_rays **)w->out);
}
static bvx_status grid_sample(const world *w)
{
    return bvx_grid_sample(w->ctx, w->grid, a_point, 1, (double *)w->out, NULL);
}
static bvx_status grid_compare(const world *w)
{
    return bvx_grid_compare(w->ctx, w->grid, w->other, (bvx_grid_difference *)w->out);
}
static bvx_status voxelize_solid(const world *w)
{
    TAKE_OPTIONS(voxelize, o);
    SPOIL(o);
    return bvx_voxelize_solid(w->ctx, w->mesh, w->lattice, &o, (bvx_grid *)w->out);
}
static bvx_status find_seed(const world *w)
{
    return bvx_find_seed(w->ctx, w->grid, NULL, 0, (bvx_seed *)w->out);
}
static bvx_status find_pockets(const world *w)
{
    return bvx_find_pockets(w->ctx, w->grid, NULL, (int32_t *)w->out, 4, w->second);
}
static bvx_status grid_fill(const world *w)
{
    return bvx_grid_fill(w->ctx, w->grid, zeros, 1, 6, (bvx_grid *)w->out);
}
static bvx_status grid_combine(const world *w)
{
    return bvx_grid_combine(w->ctx, w->grid, w->other, BVX_BOOLEAN_UNION, (bvx_grid *)w->out);
}
static bvx_status grid_complement(const world *w)
{
    return bvx_grid_complement(w->ctx, w->grid, (bvx_grid *)w->out);
}
static bvx_status grid_resample(const world *w)
{
    return bvx_grid_resample(w->ctx, w->grid, w->lattice, NULL, (bvx_grid *)w->out);
}
static bvx_status grid_downsample(const world *w)
{
    return bvx_grid_downsample(w->ctx, w->grid, two, 0, (bvx_grid *)w->out);
}
static bvx_status grid_coverage(const world *w)
{
    return bvx_grid_coverage(w->ctx, w->grid, two, (uint32_t *)w->out, 64, w->second);
}
static bvx_status grid_crop(const world *w)
{
    return bvx_grid_crop(w->ctx, w->grid, NULL, (bvx_grid *)w->out);
}
static bvx_status grid_pad(const world *w)
{
    return bvx_grid_pad(w->ctx, w->grid, two, zeros, (bvx_grid *)w->out);
}
static bvx_status grid_permute(const world *w)
{
    return bvx_grid_permute(w->ctx, w->grid, own_axes, NULL, (bvx_grid *)w->out);
}
static bvx_status voxelize_surface(const world *w)
{
    TAKE_OPTIONS(surface, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_voxelize_surface(w->ctx, w->mesh, w->lattice, &o, (bvx_grid *)w->out);
}
static bvx_status grid_morph(const world *w)
{
    TAKE_OPTIONS(morph, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_grid_morph(w->ctx, w->grid, BVX_MORPH_DILATE, &o, (bvx_grid *)w->out);
}
static bvx_status grid_hollow(const world *w)
{
    TAKE_OPTIONS(hollow, o);
    o.thickness = 1;
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_grid_hollow(w->ctx, w->grid, &o, (bvx_grid *)w->out);
}
static bvx_status grid_distance(const world *w)
{
    TAKE_OPTIONS(distance, o);
    TAKE_RESERVED(o.reserved[0]);
    SPOIL(o);
    return bvx_grid_distance(w->ctx, w->grid, &o, BVX_F32, w->out, 512);
}
static bvx_status refine(const world *w)
{
    TAKE_OPTIONS(refine, o);
    o.levels = 1;
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_refine(w->ctx, w->mesh, w->lattice, &o, (bvx_octree **)w->out);
}
static bvx_status refine_choose(const world *w)
{
    TAKE_OPTIONS(refine, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_refine_choose(w->ctx, w->mesh, 16, &o, (bvx_lattice *)w->out);
}
static bvx_status octree_lattice(const world *w)
{
    return bvx_octree_lattice(w->ctx, w->tree, 0, (bvx_lattice *)w->out);
}
static bvx_status octree_count(const world *w)
{
    return bvx_octree_count(w->ctx, w->tree, (bvx_octree_level *)w->out, 2);
}
static bvx_status octree_at(const world *w)
{
    return bvx_octree_at(w->ctx, w->tree, zeros, 1, (bvx_octree_leaf *)w->out);
}
static bvx_status octree_find(const world *w)
{
    return bvx_octree_find(w->ctx, w->tree, a_point, 1, (bvx_octree_leaf *)w->out);
}
static bvx_status octree_cast(const world *w)
{
    return bvx_octree_cast(w->ctx, w->tree, 0, a_ray, 1, 100, (bvx_octree_hit *)w->out);
}
static bvx_status octree_expand(const world *w)
{
    return bvx_octree_expand(w->ctx, w->tree, 1, 0, NULL, (bvx_grid *)w->out);
}
static bvx_status octree_neighbours(const world *w)
{
    static const bvx_octree_leaf leaf; /* voxel 0, 0, 0 of level 0 */
    return bvx_octree_neighbours(w->ctx, w->tree, &leaf, 3, NULL, 0, w->second);
}
static bvx_status octree_leaves(const world *w)
{
    return bvx_octree_leaves(w->ctx, w->tree, 0, NULL, 0, w->second);
}
static bvx_status extract_octree(const world *w)
{
    TAKE_OPTIONS(extract, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_extract_octree(w->ctx, w->tree, 0, &o, (bvx_mesh *)w->out);
}
static bvx_status voxelize_points(const world *w)
{
    TAKE_OPTIONS(points, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_voxelize_points(w->ctx, w->points, w->lattice, &o, (bvx_grid *)w->out);
}
static bvx_status grid_components(const world *w)
{
    return bvx_grid_components(w->ctx, w->grid, 6, NULL, 0, w->second);
}
static bvx_status grid_label(const world *w)
{
    return bvx_grid_label(w->ctx, w->grid, 6, (uint32_t *)w->out, 512, w->second);
}
static bvx_status grid_keep(const world *w)
{
    TAKE_OPTIONS(keep, o);
    TAKE_RESERVED(o.reserved);
    o.at_least = 2;
    SPOIL(o);
    return bvx_grid_keep(w->ctx, w->grid, &o, (bvx_grid *)w->out);
}
static bvx_status grid_fill_cavities(const world *w)
{
    return bvx_grid_fill_cavities(w->ctx, w->grid, 6, 0, (bvx_grid *)w->out, w->second);
}
static bvx_status grid_topology(const world *w)
{
    return bvx_grid_topology(w->ctx, w->grid, 6, (bvx_topology *)w->out);
}
static bvx_status extract_count(const world *w)
{
    TAKE_OPTIONS(extract, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_extract_count(w->ctx, w->grid, &o, (uint64_t *)w->out, w->second);
}
static bvx_status extract_surface(const world *w)
{
    TAKE_OPTIONS(extract, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_extract_surface(w->ctx, w->grid, &o, (bvx_mesh *)w->out);
}
static bvx_status extract_faces(const world *w)
{
    TAKE_OPTIONS(faces, o);
    SPOIL(o);
    return bvx_extract_faces(w->ctx, w->grid, &o, (bvx_mesh *)w->out);
}
static bvx_status mesh_merge(const world *w)
{
    return bvx_mesh_merge(w->ctx, w->body, 1, (bvx_mesh *)w->out);
}
static bvx_status threshold(const world *w)
{
    return bvx_threshold(w->ctx, w->volume, 1, 200, NULL, (bvx_grid *)w->out);
}
static bvx_status threshold_whole(const world *w)
{
    return bvx_threshold_whole(w->ctx, w->volume, 1, 200, NULL, (bvx_grid *)w->out);
}
static bvx_status extract_scalar(const world *w)
{
    TAKE_OPTIONS(scalar, o);
    o.level = 0.5;
    TAKE_RESERVED(o.reserved[1]);
    SPOIL(o);
    return bvx_extract_scalar(w->ctx, w->volume, &o, (bvx_mesh *)w->out);
}
static bvx_status list_labels(const world *w)
{
    return bvx_list_labels(w->ctx, w->volume, NULL, 0, w->second);
}
static bvx_status label_surfaces(const world *w)
{
    TAKE_OPTIONS(labels, o);
    SPOIL(o);
    return bvx_label_surfaces(w->ctx, w->volume, &o, (bvx_complex *)w->out);
}
static bvx_status label_mesh(const world *w)
{
    return bvx_label_mesh(w->ctx, w->complex_, 0, (bvx_mesh *)w->out);
}
static bvx_status read_volume(const world *w)
{
    TAKE_OPTIONS(read_volume, o);
    TAKE_RESERVED(o.reserved[0]);
    SPOIL(o);
    return bvx_read_volume(w->ctx, w->file->bytes, w->file->size, BVX_FORMAT_NPY, &o, (bvx_volume *)w->out);
}
static bvx_status measure_field(const world *w)
{
    TAKE_OPTIONS(field, o);
    o.half_width = 2;
    TAKE_RESERVED(o.reserved[0]);
    SPOIL(o);
    return bvx_measure_field(w->ctx, w->mesh, w->lattice, &o, (bvx_field *)w->out);
}
static bvx_status field_dense(const world *w)
{
    return bvx_field_dense(w->ctx, w->field, 0, (float *)w->out);
}
static bvx_status extract_field_surface(const world *w)
{
    TAKE_OPTIONS(field_surface, o);
    TAKE_RESERVED(o.placing.reserved);
    SPOIL(o);
    return bvx_extract_field_surface(w->ctx, w->field, w->mesh, &o, (bvx_mesh *)w->out);
}
static bvx_status boolean(const world *w)
{
    TAKE_OPTIONS(boolean, o);
    o.fit.resolution = 8;
    TAKE_RESERVED(o.fit.reserved);
    SPOIL(o);
    return bvx_boolean(w->ctx, w->mesh, w->mesh, BVX_BOOLEAN_UNION, &o, (bvx_mesh *)w->out);
}
static bvx_status build_lods(const world *w)
{
    TAKE_OPTIONS(lod, o);
    o.resolutions = eight;
    SPOIL(o);
    return bvx_build_lods(w->ctx, w->grid, &o, 1, (bvx_mesh *)w->out);
}
static bvx_status plan_lods(const world *w)
{
    TAKE_OPTIONS(lod, o);
    o.resolutions = eight;
    SPOIL(o);
    return bvx_plan_lods(w->ctx, w->mesh, &o, 1, 0, (int32_t *)w->out, NULL);
}
static bvx_status build_sections(const world *w)
{
    TAKE_OPTIONS(sections, o);
    SPOIL(o);
    return bvx_build_sections(w->ctx, w->sections, &o, (bvx_mesh *)w->out);
}
static bvx_status build_bodies(const world *w)
{
    static const int32_t one = 1;
    TAKE_OPTIONS(sections, o);
    o.cells = 8;
    SPOIL(o);
    return bvx_build_bodies(w->ctx, w->sections, &o, &one, 1, (bvx_mesh *)w->out);
}
static bvx_status slice_mesh(const world *w)
{
    TAKE_OPTIONS(slice, o);
    TAKE_RESERVED(o.reserved);
    o.spacing = 1;
    SPOIL(o);
    return bvx_slice_mesh(w->ctx, w->mesh, &o, (bvx_sections *)w->out);
}
static bvx_status repair(const world *w)
{
    TAKE_OPTIONS(repair, o);
    o.fit.resolution = 8;
    TAKE_RESERVED(o.parts.reserved);
    SPOIL(o);
    return bvx_repair(w->ctx, w->mesh, &o, (bvx_mesh *)w->out);
}
static bvx_status hull(const world *w)
{
    TAKE_OPTIONS(hull, o);
    o.fit.resolution = 8;
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_hull(w->ctx, w->mesh, &o, 1, (bvx_mesh *)w->out);
}
static bvx_status mesh_simplify(const world *w)
{
    TAKE_OPTIONS(simplify, o);
    SPOIL(o);
    return bvx_mesh_simplify(w->ctx, w->mesh, &o, 1, (bvx_mesh *)w->out);
}
static bvx_status build_levels(const world *w)
{
    TAKE_OPTIONS(levels, o);
    TAKE_RESERVED(o.parts.reserved);
    SPOIL(o);
    return bvx_build_levels(w->ctx, w->mesh, &o, 1, (bvx_mesh *)w->out);
}
static bvx_status write_mesh(const world *w)
{
    TAKE_OPTIONS(write, o);
    o.normals = 1;
    SPOIL(o);
    return bvx_write_mesh(w->ctx, w->body, 1, &o, BVX_FORMAT_OBJ, (bvx_buffer *)w->out);
}
static bvx_status write_grid(const world *w)
{
    return bvx_write_grid(w->ctx, w->grid, BVX_FORMAT_BVX, (bvx_buffer *)w->out);
}
static uint8_t labels[512]; /* of the grid */
static bvx_buffer vox;
static bvx_status write_labels(const world *w)
{
    return bvx_write_labels(w->ctx, w->grid, labels, (const uint8_t *)w->second, BVX_FORMAT_VOX,
                            (bvx_buffer *)w->out);
}
static bvx_status read_labels(const world *w)
{
    /* Of what is wrong with the file that others read it has the same. */
    return bvx_read_labels(w->ctx, w->file->bytes != NULL ? vox.bytes : NULL,
                           w->file->size != 0 ? vox.size : 0, BVX_FORMAT_VOX, (bvx_buffer *)w->out,
                           (uint8_t *)w->second);
}
static bvx_status write_octree(const world *w)
{
    return bvx_write_octree(w->ctx, w->tree, 0, BVX_FORMAT_BVX, (bvx_buffer *)w->out);
}
static bvx_status write_field(const world *w)
{
    return bvx_write_field(w->ctx, w->field, 0, BVX_FORMAT_NRRD, (bvx_buffer *)w->out);
}
static bvx_status write_lattice(const world *w)
{
    return bvx_write_lattice(w->ctx, w->grid, (bvx_buffer *)w->out);
}
static bvx_status write_head(const world *w)
{
    return bvx_write_head(w->ctx, w->lattice, NULL, (bvx_buffer *)w->out);
}
static bvx_status write_slices(const world *w)
{
    return bvx_write_slices(w->ctx, w->grid, (bvx_buffer *)w->out);
}
static bvx_status write_sections(const world *w)
{
    return bvx_write_sections(w->ctx, w->sections, BVX_FORMAT_CSV, (bvx_buffer *)w->out);
}
static bvx_status write_png(const world *w)
{
    return bvx_write_png(w->ctx, w->image, (bvx_buffer *)w->out);
}
#define RENDER_OPTIONS       \
    TAKE_OPTIONS(render, o); \
    o.width = o.height = 8
static bvx_status render_mesh(const world *w)
{
    RENDER_OPTIONS;
    SPOIL(o);
    return bvx_render_mesh(w->ctx, w->mesh, &o, (bvx_image *)w->out);
}
static bvx_status render_grid(const world *w)
{
    RENDER_OPTIONS;
    SPOIL(o);
    return bvx_render_grid(w->ctx, w->grid, &o, (bvx_image *)w->out);
}
static bvx_status render_difference(const world *w)
{
    RENDER_OPTIONS;
    SPOIL(o);
    return bvx_render_difference(w->ctx, w->grid, w->other, &o, (bvx_image *)w->out);
}
static bvx_status read_grid(const world *w)
{
    return bvx_read_grid(w->ctx, w->file->bytes, w->file->size, BVX_FORMAT_NPY, NULL, (bvx_grid *)w->out);
}

static const char csv[] = "section,position,loop,x,y\n0,0,0,0,0\n0,0,0,1,0\n0,0,0,0,1\n";
static bvx_status read_sections(const world *w)
{
    TAKE_OPTIONS(read_sections, o);
    TAKE_RESERVED(o.reserved);
    SPOIL(o);
    return bvx_read_sections(w->ctx, csv, sizeof csv - 1, BVX_FORMAT_CSV, &o, (bvx_sections *)w->out);
}

static const char off[] = "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
static bvx_status read_mesh(const world *w)
{
    TAKE_OPTIONS(read, o);
    SPOIL(o);
    return bvx_read_mesh(w->ctx, off, sizeof off - 1, BVX_FORMAT_OFF, &o, (bvx_mesh *)w->out);
}

static bvx_status read_lattice(const world *w)
{
    bvx_grid placed = *w->grid; /* it gets the lattice of the file */
    return bvx_read_lattice(w->ctx, w->lattice_file->bytes, w->lattice_file->size,
                            w->second != NULL ? &placed : NULL);
}

typedef struct call {
    const char *name;
    bvx_status (*make)(const world *w);
    int takes, to;
} call;
#define CALL(name, takes, to)         \
    {                                 \
        "bvx_" #name, name, takes, to \
    }
static const call calls[] = {
    CALL(lattice_fit, MESH, PLAIN),
    CALL(lattice_fit_with, MESH | OPTIONS | RESERVED, PLAIN),
    CALL(lattice_make, 0, PLAIN),
    CALL(grid_create, LATTICE, TO_GRID),
    CALL(grid_count, GRID, PLAIN),
    CALL(grid_hash, GRID, PLAIN),
    CALL(mesh_hash, BODY, PLAIN),
    CALL(mesh_check, MESH, PLAIN),
    CALL(mesh_normals, MESH, PLAIN),
    CALL(mesh_smooth, MESH | OPTIONS | RESERVED, PLAIN),
    CALL(mesh_distance, MESH, PLAIN),
    CALL(measure, MESH | OPTIONS | RESERVED, PLAIN),
    CALL(inspect, MESH | OPTIONS | RESERVED, PLAIN),
    CALL(closest_create, MESH, TO_CLOSEST),
    CALL(mesh_crossings, MESH | SECOND | SLOT, PLAIN),
    CALL(mesh_drop_nonfinite, BODY, PLAIN),
    CALL(grid_cast, GRID, PLAIN),
    CALL(rays_create, GRID, TO_RAYS),
    CALL(grid_sample, GRID, PLAIN),
    CALL(grid_compare, GRID | OTHER, PLAIN),
    CALL(voxelize_solid, MESH | LATTICE | OPTIONS, TO_GRID),
    CALL(find_seed, GRID, PLAIN),
    CALL(find_pockets, GRID | SECOND | SLOT, PLAIN),
    CALL(grid_fill, GRID, TO_GRID),
    CALL(grid_combine, GRID | OTHER, TO_GRID),
    CALL(grid_complement, GRID, TO_GRID),
    CALL(grid_resample, GRID | LATTICE, TO_GRID),
    CALL(grid_downsample, GRID, TO_GRID),
    CALL(grid_coverage, GRID | SLOT | SECOND, PLAIN),
    CALL(grid_crop, GRID, TO_GRID),
    CALL(grid_pad, GRID, TO_GRID),
    CALL(grid_permute, GRID, TO_GRID),
    CALL(voxelize_surface, MESH | LATTICE | OPTIONS | RESERVED, TO_GRID),
    CALL(grid_morph, GRID | OPTIONS | RESERVED, TO_GRID),
    CALL(grid_hollow, GRID | OPTIONS | RESERVED, TO_GRID),
    CALL(grid_distance, GRID | OPTIONS | RESERVED, PLAIN),
    CALL(refine, MESH | LATTICE | OPTIONS | RESERVED, TO_TREE),
    CALL(refine_choose, MESH | OPTIONS | INNER, PLAIN),
    CALL(octree_lattice, TREE, PLAIN),
    CALL(octree_count, TREE, PLAIN),
    CALL(octree_at, TREE, PLAIN),
    CALL(octree_find, TREE, PLAIN),
    CALL(octree_cast, TREE, PLAIN),
    CALL(octree_expand, TREE, TO_GRID),
    CALL(octree_leaves, TREE | SECOND | SLOT, PLAIN),
    CALL(octree_neighbours, TREE | SECOND | SLOT, PLAIN),
    CALL(extract_octree, INNER | TREE | OPTIONS | RESERVED, TO_MESH),
    CALL(voxelize_points, POINTS | LATTICE | OPTIONS | RESERVED, TO_GRID),
    CALL(grid_components, GRID | SECOND | SLOT, PLAIN),
    CALL(grid_label, GRID | SLOT, PLAIN),
    CALL(grid_keep, GRID | OPTIONS | RESERVED, TO_GRID),
    CALL(grid_fill_cavities, GRID, TO_GRID),
    CALL(grid_topology, GRID, PLAIN),
    CALL(extract_count, GRID | OPTIONS | RESERVED | SECOND, PLAIN),
    CALL(extract_surface, GRID | OPTIONS | RESERVED, TO_MESH),
    CALL(extract_faces, GRID | OPTIONS, TO_MESH),
    CALL(mesh_merge, BODY, TO_MESH),
    CALL(threshold, VOLUME, TO_GRID),
    CALL(threshold_whole, VOLUME, TO_GRID),
    CALL(extract_scalar, VOLUME | OPTIONS | RESERVED, TO_MESH),
    CALL(list_labels, VOLUME | SECOND | SLOT, PLAIN),
    CALL(label_surfaces, VOLUME | OPTIONS, TO_COMPLEX),
    CALL(label_mesh, COMPLEX, TO_MESH),
    CALL(read_volume, BYTES | OPTIONS | RESERVED, TO_VOLUME),
    CALL(measure_field, INNER | MESH | LATTICE | OPTIONS | RESERVED, TO_FIELD),
    CALL(field_dense, FIELD, PLAIN),
    CALL(extract_field_surface, FIELD | OPTIONS | RESERVED, TO_MESH),
    CALL(boolean, MESH | OPTIONS | RESERVED, TO_MESH),
    CALL(build_lods, GRID | OPTIONS, TO_MESH),
    CALL(plan_lods, MESH | OPTIONS, PLAIN),
    CALL(build_sections, SECTIONS | OPTIONS, TO_MESH),
    CALL(build_bodies, SECTIONS | OPTIONS, TO_MESH),
    CALL(slice_mesh, MESH | OPTIONS | RESERVED, TO_SECTIONS),
    CALL(repair, MESH | OPTIONS | RESERVED, TO_MESH),
    CALL(hull, MESH | OPTIONS | RESERVED, TO_MESH),
    CALL(mesh_simplify, MESH | OPTIONS, TO_MESH),
    CALL(build_levels, MESH | OPTIONS | RESERVED, TO_MESH),
    CALL(write_mesh, BODY | OPTIONS, TO_BUFFER),
    CALL(write_grid, GRID, TO_BUFFER),
    CALL(write_octree, TREE, TO_BUFFER),
    CALL(write_labels, GRID | SECOND, TO_BUFFER),
    CALL(read_labels, BYTES | SECOND, TO_BUFFER),
    CALL(write_field, FIELD, TO_BUFFER),
    CALL(write_lattice, GRID, TO_BUFFER),
    CALL(write_head, LATTICE, TO_BUFFER),
    CALL(write_slices, GRID, TO_BUFFER),
    CALL(write_sections, SECTIONS, TO_BUFFER),
    CALL(write_png, IMAGE, TO_BUFFER),
    CALL(render_mesh, MESH | OPTIONS, TO_IMAGE),
    CALL(render_grid, GRID | OPTIONS, TO_IMAGE),
    CALL(render_difference, GRID | OTHER | OPTIONS, TO_IMAGE),
    CALL(read_grid, BYTES, TO_GRID),
    CALL(read_lattice, BYTES | SECOND | SLOT, PLAIN),
    CALL(read_mesh, OPTIONS, TO_MESH),
    CALL(read_sections, OPTIONS | RESERVED, TO_SECTIONS),
    CALL(mesh_carry, BODY | SECOND | SLOT, PLAIN),
    CALL(label_voxels, BODY | GRID | SECOND, PLAIN),
};
enum { CALLS = sizeof calls / sizeof calls[0] };

/* ---- The right world: a box of 8 x 8 x 8 voxels with a cube, and all that comes of it ---- */

static float corner[8][3];
static uint32_t cube[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                               {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
static uint8_t samples[512];
static bvx_mesh_view mesh, points;
static bvx_lattice lattice;
static bvx_grid solid;
static bvx_octree *tree;
static bvx_field field;
static bvx_sections sections;
static bvx_volume_view volume;
static bvx_complex complex_;
static bvx_mesh body;
static bvx_image image;
static bvx_buffer npy, json;
static uint64_t second[128];
static result out;

static world right_world(bvx_context *ctx)
{
    world w = {0};

    w.ctx = ctx;
    w.mesh = &mesh;
    w.points = &points;
    w.lattice = &lattice;
    w.grid = w.other = &solid;
    w.tree = tree;
    w.field = &field;
    w.sections = &sections;
    w.volume = &volume;
    w.complex_ = &complex_;
    w.body = &body;
    w.image = &image;
    w.file = &npy;
    w.lattice_file = &json;
    w.out = &out;
    w.second = second;
    return w;
}

#define MADE(call) TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, call, bvx_last_message(ctx))
static void make_world(bvx_context *ctx)
{
    bvx_refine_options r = {.struct_size = sizeof r};
    bvx_field_options f = {.struct_size = sizeof f};
    bvx_slice_options s = {.struct_size = sizeof s};
    bvx_render_options p = {.struct_size = sizeof p};
    bvx_extract_options e = {.struct_size = sizeof e};

    for (int v = 0; v < 8; v++)
        for (int a = 0; a < 3; a++) corner[v][a] = (v >> a & 1) != 0 ? 6.75f : 1.25f;
    mesh.positions = corner;
    mesh.indices = cube;
    mesh.vertex_count = 8;
    mesh.triangle_count = 12;
    mesh.position_type = BVX_F32;
    mesh.index_type = BVX_U32;
    points = mesh;
    points.indices = NULL;
    points.triangle_count = 0;
    MADE(bvx_lattice_make(ctx, unit_origin, unit_spacing, eight, &lattice));
    MADE(bvx_voxelize_solid(ctx, &mesh, &lattice, NULL, &solid));
    r.levels = 1;
    MADE(bvx_refine(ctx, &mesh, &lattice, &r, &tree));
    f.half_width = 2;
    MADE(bvx_measure_field(ctx, &mesh, &lattice, &f, &field));
    s.spacing = 1;
    MADE(bvx_slice_mesh(ctx, &mesh, &s, &sections));
    for (int i = 0; i < 512; i++) samples[i] = (uint8_t)(i % 8 > 2 && i % 8 < 6);
    volume.samples = samples;
    volume.sample_type = BVX_SAMPLE_U8;
    volume.lattice = lattice;
    for (int a = 0; a < 3; a++) volume.size[a] = 8;
    MADE(bvx_label_surfaces(ctx, &volume, NULL, &complex_));
    e.keys = 1; /* for merging */
    MADE(bvx_extract_surface(ctx, &solid, &e, &body));
    MADE(bvx_extract_surface(ctx, &solid, NULL, &coloured));
    p.width = p.height = 8;
    MADE(bvx_render_mesh(ctx, &mesh, &p, &image));
    MADE(bvx_write_grid(ctx, &solid, BVX_FORMAT_NPY, &npy));
    MADE(bvx_write_lattice(ctx, &solid, &json));
    for (int i = 0; i < 512; i++) labels[i] = (uint8_t)bvx_grid_get(&solid, i % 8, i / 8 % 8, i / 64);
    MADE(bvx_write_labels(ctx, &solid, labels, (const uint8_t *)second, BVX_FORMAT_VOX, &vox));
}

static void free_world(bvx_context *ctx)
{
    bvx_buffer_free(ctx, &npy);
    bvx_buffer_free(ctx, &vox);
    bvx_buffer_free(ctx, &json);
    bvx_image_free(ctx, &image);
    bvx_complex_free(ctx, &complex_);
    bvx_mesh_free(ctx, &body);
    bvx_mesh_free(ctx, &coloured);
    bvx_sections_free(ctx, &sections);
    bvx_field_free(ctx, &field);
    bvx_octree_free(ctx, tree);
    tree = NULL;
    bvx_grid_free(ctx, &solid);
}

static void free_result(bvx_context *ctx, int to)
{
    switch (to) {
    case TO_GRID: bvx_grid_free(ctx, &out.grid); break;
    case TO_MESH: bvx_mesh_free(ctx, &out.mesh); break;
    case TO_BUFFER: bvx_buffer_free(ctx, &out.buffer); break;
    case TO_TREE: bvx_octree_free(ctx, out.tree); break;
    case TO_FIELD: bvx_field_free(ctx, &out.field); break;
    case TO_SECTIONS: bvx_sections_free(ctx, &out.sections); break;
    case TO_IMAGE: bvx_image_free(ctx, &out.image); break;
    case TO_VOLUME: bvx_volume_free(ctx, &out.volume); break;
    case TO_COMPLEX: bvx_complex_free(ctx, &out.complex_); break;
    case TO_CLOSEST: bvx_closest_free(ctx, out.closest); break;
    case TO_RAYS: bvx_rays_free(ctx, out.caster); break;
    default: break;
    }
    memset(&out, 0, sizeof out);
}

#endif
