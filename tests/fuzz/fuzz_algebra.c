/* fuzz_algebra.c - two random solids combined, reduced, moved and made meshes of:
 * identities of sets hold, coverage adds up, in place equals anew, threads equal
 * one, booleans of meshes are certified and their solids those of the grids. */
#include "fuzz_input.h"
#include "grid/grid.h"

static uint64_t fuzz_count(bvx_context *ctx, const bvx_grid *grid)
{
    uint64_t set = 0;
    fuzz_must(ctx, bvx_grid_count(ctx, grid, &set));
    return set;
}

static void fuzz_sets(bvx_context *ctx, bvx_context *other, const bvx_grid *a, const bvx_grid *b)
{
    bvx_grid both = {0}, any = {0}, left = {0}, one = {0}, none = {0}, again = {0};

    fuzz_must(ctx, bvx_grid_combine(ctx, a, b, BVX_BOOLEAN_INTERSECTION, &both));
    fuzz_must(ctx, bvx_grid_combine(ctx, a, b, BVX_BOOLEAN_UNION, &any));
    fuzz_must(ctx, bvx_grid_combine(ctx, a, b, BVX_BOOLEAN_DIFFERENCE, &left));
    fuzz_must(ctx, bvx_grid_combine(ctx, a, b, BVX_BOOLEAN_XOR, &one));
    fuzz_require(fuzz_count(ctx, &any) + fuzz_count(ctx, &both) == fuzz_count(ctx, a) + fuzz_count(ctx, b),
                 "a union of another size");
    fuzz_must(ctx, bvx_grid_combine(ctx, &left, &both, BVX_BOOLEAN_UNION, &left));
    fuzz_grids_equal(&left, a, "what is left of a and what both have is not a");
    fuzz_must(other, bvx_grid_combine(other, &any, &both, BVX_BOOLEAN_DIFFERENCE, &again));
    fuzz_grids_equal(&again, &one, "a union less what both have is not one of both");
    fuzz_must(ctx, bvx_grid_complement(ctx, &any, &none));
    fuzz_must(ctx, bvx_grid_complement(ctx, &none, &none));
    fuzz_grids_equal(&none, &any, "a complement's complement is another set");
    bvx_grid_free(ctx, &both);
    bvx_grid_free(ctx, &any);
    bvx_grid_free(ctx, &left);
    bvx_grid_free(ctx, &one);
    bvx_grid_free(ctx, &none);
    bvx_grid_free(other, &again);
}

static void fuzz_blocks(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_grid *a)
{
    int32_t factor[3];
    bvx_grid rule[3] = {{0}, {0}, {0}}, twin = {0};
    uint64_t count = 0, sum = 0;
    uint32_t *counts;

    for (int i = 0; i < 3; i++) factor[i] = fuzz_range(in, 1, 9);
    for (int32_t r = BVX_REDUCE_ANY; r <= BVX_REDUCE_MAJORITY; r++)
        fuzz_must(ctx, bvx_grid_downsample(ctx, a, factor, r, &rule[r]));
    fuzz_must(other, bvx_grid_downsample(other, a, factor, BVX_REDUCE_MAJORITY, &twin));
    fuzz_grids_equal(&rule[2], &twin, "another majority with more threads");
    fuzz_must(ctx, bvx_grid_coverage(ctx, a, factor, NULL, 0, &count));
    counts = malloc((size_t)count * sizeof *counts);
    fuzz_require(counts != NULL, "no memory");
    fuzz_must(ctx, bvx_grid_coverage(ctx, a, factor, counts, count, &count));
    for (uint64_t i = 0; i < count; i++) {
        int32_t const x = (int32_t)(i % (uint64_t)rule[0].size[0]);
        int32_t const y = (int32_t)(i / (uint64_t)rule[0].size[0] % (uint64_t)rule[0].size[1]);
        int32_t const z = (int32_t)(i / (uint64_t)rule[0].size[0] / (uint64_t)rule[0].size[1]);
        sum += counts[i];
        fuzz_require(bvx_grid_get(&rule[0], x, y, z) == (counts[i] != 0), "any differs from the count");
        fuzz_require(bvx_grid_get(&rule[1], x, y, z) <= bvx_grid_get(&rule[2], x, y, z),
                     "all without a majority");
    }
    fuzz_require(sum == fuzz_count(ctx, a), "counts that do not add up");
    free(counts);
    for (int r = 0; r < 3; r++) bvx_grid_free(ctx, &rule[r]);
    bvx_grid_free(other, &twin);
}

static void fuzz_moves(bvx_context *ctx, fuzz_input *in, const bvx_grid *a)
{
    static const int32_t orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int32_t *const axes = orders[fuzz_range(in, 0, 5)];
    int32_t back[3], flips[3], low[3], high[3], back_flips[3];
    bvx_grid turned = {0}, home = {0}, padded = {0}, cropped = {0}, sampled = {0};
    bvx_window content;

    for (int i = 0; i < 3; i++) {
        flips[i] = fuzz_range(in, 0, 1);
        low[i] = fuzz_range(in, 0, 70);
        high[i] = fuzz_range(in, 0, 5);
        back[axes[i]] = i;
        back_flips[axes[i]] = flips[i];
    }
    fuzz_must(ctx, bvx_grid_permute(ctx, a, axes, flips, &turned));
    fuzz_must(ctx, bvx_grid_permute(ctx, &turned, back, back_flips, &home));
    fuzz_grids_equal(&home, a, "axes changed and changed back");
    fuzz_must(ctx, bvx_grid_pad(ctx, a, low, high, &padded));
    fuzz_require(fuzz_count(ctx, &padded) == fuzz_count(ctx, a), "padding that changed the set");
    bvxi_grid_content(a, &content);
    if (content.size[0] != 0) {
        fuzz_must(ctx, bvx_grid_crop(ctx, a, &content, &cropped));
        fuzz_require(fuzz_count(ctx, &cropped) == fuzz_count(ctx, a),
                     "a crop to the content that lost some of it");
    }
    fuzz_must(ctx, bvx_grid_resample(ctx, a, &a->lattice, NULL, &sampled));
    fuzz_grids_equal(&sampled, a, "the same lattice resampled");
    bvx_grid_free(ctx, &turned);
    bvx_grid_free(ctx, &home);
    bvx_grid_free(ctx, &padded);
    bvx_grid_free(ctx, &cropped);
    bvx_grid_free(ctx, &sampled);
}

static void fuzz_bodies(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *a,
                        const fuzz_mesh *b)
{
    bvx_boolean_options o = {.struct_size = sizeof o};
    bvx_boolean_report report;
    bvx_mesh mesh = {0}, twin = {0};
    int32_t const operation = fuzz_range(in, BVX_BOOLEAN_UNION, BVX_BOOLEAN_XOR);

    o.fit.resolution = fuzz_range(in, 1, 20);
    o.placing.sharp = fuzz_range(in, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS);
    o.placing.interpolation = fuzz_range(in, BVX_EDGE_TANGENT, BVX_EDGE_PAPER);
    o.placing.position_type = BVX_F64;
    o.thin = fuzz_range(in, BVX_THIN_KEEP, BVX_THIN_DROP);
    o.parts.keep_largest = (uint64_t)fuzz_range(in, 0, 2);
    o.report = &report;
    if (!fuzz_good(ctx, bvx_boolean(ctx, &a->view, &b->view, operation, &o, &mesh))) return;
    fuzz_certified(ctx, &mesh, "a boolean that is not certified");
    fuzz_require((mesh.triangle_count > 0) == (report.voxels > 0),
                 "a mesh without voxels, or voxels without a mesh");
    o.report = NULL; /* which asks for finer looks too, and they change no mesh */
    fuzz_must(other, bvx_boolean(other, &a->view, &b->view, operation, &o, &twin));
    fuzz_meshes_equal(ctx, &mesh, &twin, "another boolean with more threads and no report");
    bvx_mesh_free(ctx, &mesh);
    bvx_mesh_free(other, &twin);
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m, n;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_lattice lattice;
    bvx_grid a = {0}, b = {0};

    fuzz_take_mesh(in, &m);
    fuzz_take_mesh(in, &n);
    if (m.triangles > 0 && n.triangles > 0) {
        if (fuzz_take_lattice(in, ctx, &m, 40, &lattice) &&
            fuzz_good(ctx, bvx_voxelize_solid(ctx, &m.view, &lattice, NULL, &a)) &&
            fuzz_good(ctx, bvx_voxelize_solid(ctx, &n.view, &lattice, NULL, &b))) {
            fuzz_sets(ctx, other, &a, &b);
            fuzz_blocks(ctx, other, in, &a);
            fuzz_moves(ctx, in, &a);
        }
        fuzz_bodies(ctx, other, in, &m, &n);
    }
    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
    fuzz_end(ctx);
    fuzz_end(other);
}
