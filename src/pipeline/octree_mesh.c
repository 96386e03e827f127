/* octree_mesh.c - the closed surface of an octree's last level without expanding all of it:
 * bvx_extract_octree.
 *
 * The lattice is cut into blocks that share a layer of voxels. Between voxels of different states lies the
 * surface, so only blocks that hold some of it (on the lattice's sides: any voxel wanted) are expanded, one
 * at a time; their surfaces, with open sides and keys, merge into the whole's bytes.
 * Guarantee: the bytes of bvx_extract_surface on all of it. */
#include "mesh/mesh.h"
#include "surface/march.h"
#include "refine/room.h"

static const char octree_mesh_name[] = "bvx_extract_octree";

enum { BLOCK_SHIFT = 8 }; /* a block is 2^8 cells a side: 257 voxels */

typedef struct octree_mesh_job {
    bvx_context *ctx;
    const bvx_octree *tree;
    bvx_extract_options options;
    int32_t states, keys;
    int32_t blocks[3];
    bvx_mesh *part;
    uint64_t part_count, room;
} octree_mesh_job;

static void block_window(const octree_mesh_job *job, const int32_t b[3], bvx_window *w)
{
    for (int a = 0; a < 3; a++) {
        /* Blocks share a layer of voxels, so their surfaces have vertices in common. */
        int32_t const rest = job->tree->lattice.dims[a] - (b[a] << BLOCK_SHIFT);
        int32_t const most = (1 << BLOCK_SHIFT) + 1;
        w->low[a] = b[a] << BLOCK_SHIFT;
        w->size[a] = rest < most ? rest : most;
    }
}

/* Sides of a block that others go on from. */
static int32_t open_sides_of_block(const octree_mesh_job *job, const int32_t b[3])
{
    int32_t sides = 0;
    for (int a = 0; a < 3; a++)
        sides |= (b[a] > 0 ? 1 << 2 * a : 0) | (b[a] + 1 < job->blocks[a] ? 2 << 2 * a : 0);
    return sides;
}

/* Can a block hold triangles? Looked up among voxels that are about as large. */
static bvx_status block_may_hold(const octree_mesh_job *job, const int32_t b[3], int *holds)
{
    int32_t const levels = job->tree->levels;
    int32_t const level = levels > BLOCK_SHIFT ? levels - BLOCK_SHIFT : 0;
    int32_t const down = levels - level;
    int32_t const inner = open_sides_of_block(job, b) == 63;
    bvx_grid grid = {0};
    bvx_window w;
    uint64_t count = 0;

    block_window(job, b, &w);
    for (int a = 0; a < 3; a++) {
        int32_t const last = (w.low[a] + w.size[a] - 1) >> down;
        w.low[a] >>= down;
        w.size[a] = last - w.low[a] + 1;
    }
    BVXI_TRY(bvx_octree_expand(job->ctx, job->tree, level,
                               inner ? BVX_STATE_SURFACE : job->states | BVX_STATE_SURFACE, &w, &grid));
    bvx_status const status = bvx_grid_count(job->ctx, &grid, &count);
    bvx_grid_free(job->ctx, &grid);
    *holds = count != 0;
    return status;
}

static bvx_status extract_block(octree_mesh_job *job, const int32_t b[3])
{
    bvx_grid grid = {0};
    bvx_window w;

    block_window(job, b, &w);
    /* The block at the finest level; its open sides are left to others. */
    BVXI_TRY(bvx_octree_expand(job->ctx, job->tree, job->tree->levels, job->states, &w, &grid));
    job->options.open_sides = open_sides_of_block(job, b);
    bvx_status const status = bvx_extract_surface(job->ctx, &grid, &job->options,
                                                  &job->part[job->part_count]);
    bvx_grid_free(job->ctx, &grid);
    BVXI_TRY(status);
    job->part_count++;
    return BVX_OK;
}

/* Count the blocks (part NULL), or extract them. */
static bvx_status visit_block(octree_mesh_job *job, const int32_t b[3])
{
    int holds = 0;
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, job->part == NULL ? 1.0 : 0.1, block_may_hold(job, b, &holds)));
    if (!holds) return BVX_OK;
    if (job->part != NULL) return BVXI_SHARE(job->ctx, 0.1, 1.0, extract_block(job, b));
    job->room++;
    if (job->options.position_type != BVX_POSITION_AUTO) return BVX_OK;

    /* Positions are doubles in all blocks when one of them needs it. */
    static const double local_origin[3] = {0, 0, 0};
    bvx_grid grid = {.lattice = job->tree->lattice};
    bvx_window w;

    block_window(job, b, &w);
    memcpy(grid.low, w.low, sizeof grid.low);
    memcpy(grid.size, w.size, sizeof grid.size);
    if (!bvxi_fits_f32(&grid, job->options.local_frame ? local_origin : grid.lattice.origin))
        job->options.position_type = BVX_F64;
    return BVX_OK;
}

static bvx_status visit_blocks(octree_mesh_job *job)
{
    double const all = (double)job->blocks[0] * job->blocks[1] * job->blocks[2];
    double n = 0;

    for (int32_t z = 0; z < job->blocks[2]; z++)
        for (int32_t y = 0; y < job->blocks[1]; y++)
            for (int32_t x = 0; x < job->blocks[0]; x++) {
                int32_t const b[3] = {x, y, z};
                BVXI_TRY(BVXI_SHARE(job->ctx, n / all, (n + 1) / all, visit_block(job, b)));
                n++;
            }
    return BVX_OK;
}

static bvx_status merge_blocks(octree_mesh_job *job, bvx_mesh *mesh)
{
    bvx_mesh made = {0};

    if (job->room > 0) {
        if (job->options.position_type == BVX_POSITION_AUTO) job->options.position_type = BVX_F32;
        BVXI_TRY(BVXI_ZEROS(job->ctx, job->room, "the blocks' surfaces", job->part));
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.05, 0.4, visit_blocks(job)));
    } else { /* the surface of nothing, as the options make it */
        int32_t const first[3] = {0, 0, 0};
        job->room = 1;
        BVXI_TRY(BVXI_ZEROS(job->ctx, job->room, "the blocks' surfaces", job->part));
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.4, 1.0, extract_block(job, first)));
    }
    /* Keys bring common vertices together, in the order of the whole. */
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.4, 1.0, bvx_mesh_merge(job->ctx, job->part, job->part_count, &made)));
    if (!job->keys) bvxi_mesh_release(job->ctx, &made, BVXI_MESH_KEYS);
    bvx_mesh_free(job->ctx, mesh);
    *mesh = made;
    return BVX_OK;
}

static bvx_status run_extract_octree(bvx_context *context, const bvx_octree *tree, int32_t states,
                                     const bvx_extract_options *options, bvx_mesh *mesh)
{
    octree_mesh_job job = {0};

    if (mesh == NULL) return bvxi_fail_null(context, octree_mesh_name, "mesh");
    if (mesh->owned != 1 && (mesh->positions != NULL || mesh->triangles != NULL))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: mesh must be empty or the library's own", octree_mesh_name);
    BVXI_TRY(bvxi_octree_check(context, octree_mesh_name, tree));
    BVXI_TRY(bvxi_octree_check_states(context, octree_mesh_name, states));
    BVXI_TRY(bvxi_take_options(context, octree_mesh_name, options, &job.options, sizeof job.options));
    if (job.options.open_sides != 0)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: open_sides is %d; all sides are closed", octree_mesh_name,
                             (int64_t)job.options.open_sides);

    /* Keys are needed for merging, even where the caller has none of them. */
    job.options.struct_size = sizeof job.options;
    job.ctx = context;
    job.tree = tree;
    job.states = states != 0 ? states : BVX_STATE_SURFACE | BVX_STATE_INSIDE;
    job.keys = job.options.keys;
    job.options.keys = 1;
    for (int a = 0; a < 3; a++) {
        job.blocks[a] = (tree->lattice.dims[a] - 1 + (1 << BLOCK_SHIFT) - 1) >> BLOCK_SHIFT;
        if (job.blocks[a] < 1) job.blocks[a] = 1;
    }
    /* Counted first, so that positions of all blocks have one type. */
    BVXI_TRY(BVXI_SHARE(job.ctx, 0.0, 0.05, visit_blocks(&job)));
    bvx_status const status = merge_blocks(&job, mesh);
    for (uint64_t i = job.part_count; i-- > 0;) bvx_mesh_free(job.ctx, &job.part[i]);
    return status;
}

bvx_status bvx_extract_octree(bvx_context *context, const bvx_octree *tree, int32_t states,
                              const bvx_extract_options *options, bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_extract_octree(context, tree, states, options, mesh));
}
