/* fuzz_voxels.c - meshes to surface voxels and octrees: thin and sampled lie in
 * conservative, windows equal the whole, threads equal one, attached triangles are
 * ordered, an octree expanded is the uniform surface and its flood, seeds are inside. */
#include "fuzz_input.h"

static void fuzz_attached(const bvx_attached *attached, uint64_t set, uint32_t triangles)
{
    fuzz_require(attached->voxel_count == set && attached->offsets[0] == 0,
                 "attached voxels that are not the grid's");
    for (uint64_t v = 0; v < set; v++) {
        fuzz_require(attached->offsets[v] < attached->offsets[v + 1], "a surface voxel without a triangle");
        for (uint64_t i = attached->offsets[v]; i < attached->offsets[v + 1]; i++)
            fuzz_require(
                attached->triangles[i] < triangles &&
                    (i == attached->offsets[v] || attached->triangles[i - 1] < attached->triangles[i]),
                "attached triangles out of order");
    }
}

static int fuzz_surface_voxels(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *m,
                               const bvx_lattice *lattice, bvx_grid *conservative)
{
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_attached attached = {0};
    bvx_grid grid = {0}, twin = {0}, part = {0};
    uint64_t set = 0;

    if (!fuzz_good(ctx, bvx_voxelize_surface(ctx, &m->view, lattice, &o, conservative))) return 0;
    o.mode = fuzz_range(in, BVX_SURFACE_CONSERVATIVE, BVX_SURFACE_SAMPLED);
    o.attached = fuzz_range(in, 0, 1) != 0 ? &attached : NULL;
    fuzz_must(ctx, bvx_voxelize_surface(ctx, &m->view, lattice, &o, &grid));
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                fuzz_require(!bvx_grid_get(&grid, x, y, z) || bvx_grid_get(conservative, x, y, z),
                             "a surface voxel outside the conservative surface");
    fuzz_must(ctx, bvx_grid_count(ctx, &grid, &set));
    if (o.attached != NULL) fuzz_attached(&attached, set, m->triangles);
    o.attached = NULL;
    fuzz_must(other, bvx_voxelize_surface(other, &m->view, lattice, &o, &twin));
    fuzz_grids_equal(&grid, &twin, "another surface with more threads");
    o.window = fuzz_take_window(in, lattice);
    fuzz_must(ctx, bvx_voxelize_surface(ctx, &m->view, lattice, &o, &part));
    fuzz_part_equals_whole(&part, &grid, "a window that differs from the whole");
    bvx_attached_free(ctx, &attached);
    bvx_grid_free(ctx, &grid);
    bvx_grid_free(other, &twin);
    bvx_grid_free(ctx, &part);
    return 1;
}

static void fuzz_seeds(bvx_context *ctx, fuzz_input *in, const fuzz_mesh *m, const bvx_grid *surface)
{
    bvx_seed seed;
    int32_t seeds[3 * 64];
    uint64_t count = 0, set = 0;
    const bvx_mesh_view *const view = fuzz_range(in, 0, 1) != 0 ? &m->view : NULL;
    bvx_grid filled = {0};

    if (!fuzz_good(ctx, bvx_find_seed(ctx, surface, view, (uint64_t)fuzz_range(in, 0, 20), &seed))) return;
    fuzz_require(!seed.found || !bvx_grid_get(surface, seed.voxel[0], seed.voxel[1], seed.voxel[2]),
                 "a seed on the surface");
    fuzz_must(ctx, bvx_find_pockets(ctx, surface, view, NULL, 0, &count));
    if (count == 0 || count > 64) return;
    fuzz_must(ctx, bvx_find_pockets(ctx, surface, view, seeds, 64, &count));
    fuzz_must(ctx, bvx_grid_fill(ctx, surface, seeds, count, fuzz_range(in, 0, 1) != 0 ? 6 : 26, &filled));
    fuzz_must(ctx, bvx_grid_count(ctx, &filled, &set));
    fuzz_require(set >= count, "pockets of no voxel");
    for (uint64_t i = 0; i < count; i++)
        fuzz_require(bvx_grid_get(&filled, seeds[3 * i], seeds[3 * i + 1], seeds[3 * i + 2]),
                     "a seed that was not filled");
    bvx_grid_free(ctx, &filled);
}

/* Outside by a flood from beyond the lattice through faces; what remains and no surface is inside. */
static void fuzz_flood(const bvx_grid *surface, uint8_t *outside, int32_t *stack)
{
    int32_t const nx = surface->size[0], ny = surface->size[1], nz = surface->size[2];
    int32_t top = 0;

    for (int32_t z = 0; z < nz; z++)
        for (int32_t y = 0; y < ny; y++)
            for (int32_t x = 0; x < nx; x++) {
                int32_t const at = (z * ny + y) * nx + x;
                int const side = x == 0 || y == 0 || z == 0 || x == nx - 1 || y == ny - 1 || z == nz - 1;
                outside[at] = side && !bvx_grid_get(surface, x, y, z);
                if (outside[at]) stack[top++] = at;
            }
    while (top > 0) {
        int32_t const at = stack[--top], x = at % nx, y = at / nx % ny, z = at / nx / ny;
        for (int d = 0; d < 6; d++) {
            int32_t const u = x + (d == 0) - (d == 1);
            int32_t const v = y + (d == 2) - (d == 3);
            int32_t const w = z + (d == 4) - (d == 5);
            if (u < 0 || v < 0 || w < 0 || u >= nx || v >= ny || w >= nz) continue;
            if (outside[(w * ny + v) * nx + u] || bvx_grid_get(surface, u, v, w)) continue;
            outside[(w * ny + v) * nx + u] = 1;
            stack[top++] = (w * ny + v) * nx + u;
        }
    }
}

static void fuzz_tree(bvx_context *ctx, fuzz_input *in, const fuzz_mesh *m)
{
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base, finest;
    bvx_octree *tree = NULL;
    bvx_grid surface = {0}, expanded = {0}, inside = {0};
    bvx_mesh mesh = {0};
    bvx_surface_options s = {.struct_size = sizeof s};

    int32_t const levels = fuzz_range(in, 0, 3), start = fuzz_range(in, -1, levels);
    o.levels = levels != 0 ? levels : BVX_NONE;
    o.start_level = start < 0 ? 0 : start != 0 ? start : BVX_NONE;
    if (!fuzz_good(ctx, bvx_lattice_fit(ctx, &m->view, fuzz_range(in, 1, 5), &base)) ||
        !fuzz_good(ctx, bvx_refine(ctx, &m->view, &base, &o, &tree)))
        return;
    fuzz_must(ctx, bvx_octree_lattice(ctx, tree, levels, &finest));
    fuzz_must(ctx, bvx_voxelize_surface(ctx, &m->view, &finest, &s, &surface));
    fuzz_must(ctx, bvx_octree_expand(ctx, tree, levels, BVX_STATE_SURFACE, NULL, &expanded));
    fuzz_grids_equal(&surface, &expanded, "a tree whose surface is not the uniform one");
    fuzz_must(ctx, bvx_octree_expand(ctx, tree, levels, BVX_STATE_INSIDE, NULL, &inside));
    {
        size_t const voxels = (size_t)surface.size[0] * (size_t)surface.size[1] * (size_t)surface.size[2];
        uint8_t *const outside = malloc(voxels);
        int32_t *const stack = malloc(voxels * sizeof *stack);
        fuzz_require(outside != NULL && stack != NULL, "no memory");
        fuzz_flood(&surface, outside, stack);
        for (size_t i = 0; i < voxels; i++) {
            int32_t const x = (int32_t)(i % (size_t)surface.size[0]);
            int32_t const y = (int32_t)(i / (size_t)surface.size[0] % (size_t)surface.size[1]);
            int32_t const z = (int32_t)(i / (size_t)surface.size[0] / (size_t)surface.size[1]);
            fuzz_require(bvx_grid_get(&inside, x, y, z) == (!outside[i] && !bvx_grid_get(&surface, x, y, z)),
                         "a tree whose inside is not what a flood leaves");
        }
        free(outside);
        free(stack);
    }
    if (fuzz_good(ctx, bvx_extract_octree(ctx, tree, 0, NULL, &mesh)))
        fuzz_certified(ctx, &mesh, "an octree's surface that is not certified");
    bvx_mesh_free(ctx, &mesh);
    bvx_grid_free(ctx, &surface);
    bvx_grid_free(ctx, &expanded);
    bvx_grid_free(ctx, &inside);
    bvx_octree_free(ctx, tree);
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_lattice lattice;
    bvx_grid surface = {0};

    fuzz_take_mesh(in, &m);
    if (m.triangles > 0) {
        if (fuzz_take_lattice(in, ctx, &m, 24, &lattice) &&
            fuzz_surface_voxels(ctx, other, in, &m, &lattice, &surface))
            fuzz_seeds(ctx, in, &m, &surface);
        fuzz_tree(ctx, in, &m);
    }
    bvx_grid_free(ctx, &surface);
    fuzz_end(ctx);
    fuzz_end(other);
}
