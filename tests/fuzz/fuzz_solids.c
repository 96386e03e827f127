/* fuzz_solids.c - meshes to solids by every rule, and what is done with solids:
 * windows equal the whole, many threads and fast kernels equal one portable thread,
 * surfaces are certified, pieces merge to the whole's bytes, files come back equal. */
#include "fuzz_input.h"

static const bvx_mesh_view *fuzz_second_view(fuzz_input *in, fuzz_mesh *m)
{
    if (fuzz_range(in, 0, 1) == 0) return NULL;
    fuzz_take_mesh(in, m);
    return &m->view;
}

/* One rule on the whole, portable and only. */
static int fuzz_fill(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *m,
                     const bvx_lattice *lattice, bvx_grid *solid)
{
    static fuzz_mesh second;
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_solid_report report, again;
    bvx_grid twin = {0}, part = {0};

    o.fill = fuzz_range(in, BVX_FILL_PARITY, BVX_FILL_WINDING);
    o.report = &report;
    if (o.fill == BVX_FILL_FLOOD) o.close_gaps = fuzz_range(in, 0, 3);
    if (o.fill == BVX_FILL_BELOW) {
        o.up = fuzz_range(in, 0, 2);
        o.second = fuzz_second_view(in, &second);
    } else {
        o.add_shell = fuzz_range(in, 0, 1);
        o.check_thin = fuzz_range(in, BVX_CHECK_AUTO, BVX_CHECK_ALWAYS);
    }
    if (!fuzz_good(ctx, bvx_voxelize_solid(ctx, &m->view, lattice, &o, solid))) {
        fuzz_require(solid->words == NULL, "a grid behind an error");
        return 0;
    }
    o.report = &again;
    fuzz_must(other, bvx_voxelize_solid(other, &m->view, lattice, &o, &twin));
    fuzz_grids_equal(solid, &twin, "another solid with more threads");
    fuzz_require(memcmp(&report, &again, sizeof report) == 0, "another report with more threads");
    if (o.fill != BVX_FILL_FLOOD && o.fill != BVX_FILL_REGIONS) {
        o.window = fuzz_take_window(in, lattice);
        fuzz_must(ctx, bvx_voxelize_solid(ctx, &m->view, lattice, &o, &part));
        fuzz_part_equals_whole(&part, solid, "a window that differs from the whole");
    }
    if (m->closed && o.fill == BVX_FILL_VOTE && !o.add_shell) {
        bvx_grid parity = {0};
        o = (bvx_voxelize_options){.struct_size = sizeof o};
        fuzz_must(ctx, bvx_voxelize_solid(ctx, &m->view, lattice, &o, &parity));
        fuzz_grids_equal(&parity, solid, "vote differs from parity on a closed mesh");
        bvx_grid_free(ctx, &parity);
    }
    bvx_grid_free(ctx, &part);
    bvx_grid_free(other, &twin);
    return 1;
}

/* Two windows that share a layer of voxels give the whole's bytes. */
static void fuzz_merge(bvx_context *ctx, fuzz_input *in, const bvx_grid *solid,
                       const bvx_extract_options *options, const bvx_mesh *whole)
{
    int const axis = fuzz_range(in, 0, 2);
    bvx_extract_options o = *options;
    bvx_mesh parts[2] = {{0}, {0}}, merged = {0};
    int32_t cut;

    if (solid->size[axis] < 3) return;
    cut = fuzz_range(in, 1, solid->size[axis] - 2);
    for (int side = 0; side < 2; side++) {
        bvx_window w;
        bvx_grid piece = {0};
        memcpy(w.low, solid->low, sizeof w.low);
        memcpy(w.size, solid->size, sizeof w.size);
        w.low[axis] += side == 0 ? 0 : cut;
        w.size[axis] = side == 0 ? cut + 1 : solid->size[axis] - cut;
        fuzz_must(ctx, bvx_grid_create(ctx, &solid->lattice, &w, &piece));
        for (int32_t z = 0; z < w.size[2]; z++)
            for (int32_t y = 0; y < w.size[1]; y++)
                for (int32_t x = 0; x < w.size[0]; x++)
                    bvx_grid_set(&piece, x, y, z,
                                 bvx_grid_get(solid, x + w.low[0] - solid->low[0],
                                              y + w.low[1] - solid->low[1], z + w.low[2] - solid->low[2]));
        o.open_sides = (side == 0 ? BVX_OPEN_X_HIGH : BVX_OPEN_X_LOW) << 2 * axis;
        fuzz_must(ctx, bvx_extract_surface(ctx, &piece, &o, &parts[side]));
        bvx_grid_free(ctx, &piece);
    }
    fuzz_must(ctx, bvx_mesh_merge(ctx, parts, 2, &merged));
    fuzz_meshes_equal(ctx, &merged, whole, "merged pieces differ from the whole");
    bvx_mesh_free(ctx, &merged);
    bvx_mesh_free(ctx, &parts[0]);
    bvx_mesh_free(ctx, &parts[1]);
}

static void fuzz_surface(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_grid *solid)
{
    bvx_extract_options o = {.struct_size = sizeof o};
    bvx_faces_options f = {.struct_size = sizeof f};
    bvx_mesh whole = {0}, twin = {0}, faces = {0};
    uint64_t vertices = 0, triangles = 0;

    o.face_rule = fuzz_range(in, 0, 1);
    o.position_type = BVX_F64;
    o.keys = 1;
    fuzz_must(ctx, bvx_extract_surface(ctx, solid, &o, &whole));
    fuzz_certified(ctx, &whole, "a surface that is not certified");
    fuzz_must(other, bvx_extract_surface(other, solid, &o, &twin));
    fuzz_meshes_equal(ctx, &whole, &twin, "another surface with more threads");
    fuzz_must(ctx, bvx_extract_count(ctx, solid, &o, &vertices, &triangles));
    fuzz_require(vertices == whole.vertex_count && triangles == whole.triangle_count,
                 "another count than made");
    fuzz_merge(ctx, in, solid, &o, &whole);
    f.position_type = BVX_F64;
    f.merged = fuzz_range(in, 0, 1);
    fuzz_must(ctx, bvx_extract_faces(ctx, solid, &f, &faces));
    fuzz_require((faces.triangle_count == 0) == (whole.triangle_count == 0), "faces without a surface");
    bvx_mesh_free(ctx, &whole);
    bvx_mesh_free(other, &twin);
    bvx_mesh_free(ctx, &faces);
}

static void fuzz_levels(bvx_context *ctx, fuzz_input *in, const bvx_grid *solid)
{
    bvx_lod_options o = {.struct_size = sizeof o};
    bvx_mesh level[2] = {{0}, {0}};
    int32_t resolutions[2];
    uint64_t targets[2];
    int32_t longest = 1;

    for (int a = 0; a < 3; a++) longest = solid->size[a] > longest ? solid->size[a] : longest;
    o.sampling.method = fuzz_range(in, BVX_LOD_EDGE_RATIO, BVX_LOD_COVERAGE);
    if (o.sampling.method == BVX_LOD_EDGE_RATIO) o.sampling.edge_samples = fuzz_range(in, 0, 5);
    o.sampling.threshold = fuzz_range(in, 1, 15) / 16.0;
    o.position_type = BVX_F64;
    for (int i = 0; i < 2; i++) {
        resolutions[i] = fuzz_range(in, 1, longest);
        targets[i] = (uint64_t)fuzz_range(in, 4, 1000);
    }
    if (fuzz_range(in, 0, 1) == 0) {
        o.resolutions = resolutions;
    } else {
        o.target_triangles = targets;
        o.collapse = fuzz_range(in, 0, 2) * 2;
    }
    if (fuzz_good(ctx, bvx_build_lods(ctx, solid, &o, 2, level)))
        for (int i = 0; i < 2; i++) fuzz_certified(ctx, &level[i], "a level that is not certified");
    bvx_mesh_free(ctx, &level[0]);
    bvx_mesh_free(ctx, &level[1]);
}

/* Rays from anywhere; trilinear samples between 0 and 1; a grid is like itself. */
static void fuzz_ask(bvx_context *ctx, fuzz_input *in, const bvx_grid *solid)
{
    bvx_grid_difference d;
    bvx_ray_hit hit[2], again[2];
    bvx_rays *caster;
    double rays[12], values[4], gradients[12];

    for (int i = 0; i < 12; i++) rays[i] = fuzz_range(in, -64, 64) / 8.0;
    rays[3] += rays[3] == 0 && rays[4] == 0 && rays[5] == 0;
    rays[9] += rays[9] == 0 && rays[10] == 0 && rays[11] == 0;
    fuzz_must(ctx, bvx_grid_cast(ctx, solid, rays, 2, 1e9, hit));
    for (int i = 0; i < 2; i++)
        fuzz_require(!hit[i].hit || bvx_grid_get(solid, hit[i].voxel[0], hit[i].voxel[1], hit[i].voxel[2]),
                     "a hit on an empty voxel");
    fuzz_must(ctx, bvx_rays_create(ctx, solid, &caster));
    fuzz_must(ctx, bvx_rays_update(ctx, caster, solid, NULL));
    fuzz_must(ctx, bvx_rays_cast(ctx, caster, rays, 2, 1e9, again));
    fuzz_require(memcmp(hit, again, sizeof hit) == 0, "bricks that are kept change a hit");
    bvx_rays_free(ctx, caster);
    fuzz_must(ctx, bvx_grid_sample(ctx, solid, rays, 4, values, gradients));
    for (int i = 0; i < 4; i++) fuzz_require(values[i] >= 0 && values[i] <= 1, "a sample outside 0..1");
    fuzz_must(ctx, bvx_grid_compare(ctx, solid, solid, &d));
    fuzz_require(d.only_a == 0 && d.only_b == 0 && d.set_a == d.both, "a grid that differs from itself");
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_lattice lattice;
    bvx_grid solid = {0};

    fuzz_take_mesh(in, &m);
    if (m.triangles > 0 && fuzz_take_lattice(in, ctx, &m, 40, &lattice) &&
        fuzz_fill(ctx, other, in, &m, &lattice, &solid)) {
        fuzz_surface(ctx, other, in, &solid);
        fuzz_levels(ctx, in, &solid);
        fuzz_ask(ctx, in, &solid);
    }
    bvx_grid_free(ctx, &solid);
    fuzz_end(ctx);
    fuzz_end(other);
}
