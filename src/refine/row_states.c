/* row_states.c - what is outside in a tree with a window: by the exact rule of rows.
 *
 * No triangle touches a leaf that is not of the surface, so all of it lies on one side, and any centre in it tells which. Leaves
 * up to level `outer` ask the solid of that level's lattice, finer ones, which all lie in the window, that of the last level.
 * (Snapped to a coarser lattice a vertex moves by 2^-16 of a voxel; the centre of a voxel that no triangle touches is half a
 * voxel away.) Guarantee: the same for any threads. */
#include "refine/refine.h"

typedef struct row_states_job {
    bvx_octree *tree;
    bvx_grid outer, inner;
    int32_t outer_level;
} row_states_job;

typedef struct row_state_step {
    uint64_t octet, below;
    uint32_t p;
    int32_t v[3];
} row_state_step;

static int centre_is_inside(const row_states_job *job, const int32_t v[3], int32_t level)
{
    const bvx_grid *const g = level <= job->outer_level ? &job->outer : &job->inner;
    int32_t const down = (level <= job->outer_level ? job->outer_level : job->tree->levels) - level;
    return bvx_grid_get(g, (v[0] << down) - g->low[0], (v[1] << down) - g->low[1], (v[2] << down) - g->low[2]);
}

/* The octets of the last level but one, all eight children at once; windows begin at even voxels there. */
static void decide_last(const row_states_job *job, uint64_t octet, const int32_t v[3])
{
    const bvxi_octets *const o = &job->tree->octets[job->tree->levels - 1];
    const bvx_grid *const g = &job->inner;
    uint64_t const row = (uint64_t)g->words_per_row, slice = row * (uint64_t)g->size[1];
    int32_t const x = 2 * v[0] - g->low[0], y = 2 * v[1] - g->low[1], z = 2 * v[2] - g->low[2];
    const uint64_t *const at = g->words + (uint64_t)z * slice + (uint64_t)y * row + (uint64_t)(x >> 6);
    unsigned const shift = (unsigned)x & 63;
    uint32_t const inside = (uint32_t)((at[0] >> shift & 3) | (at[row] >> shift & 3) << 2 | (at[slice] >> shift & 3) << 4 |
                                       (at[slice + row] >> shift & 3) << 6);
    bvxi_octet_put(o->outside, octet, 255 & ~(inside | bvxi_octet_mask(o->touched, octet)));
}

static void decide_tree(const row_states_job *job, uint64_t octet, const int32_t v[3])
{
    row_state_step step[BVXI_OCTREE_LEVELS];
    int32_t level = 0;
    memset(&step[0], 0, sizeof step[0]);
    step[0].octet = octet;
    memcpy(step[0].v, v, sizeof step[0].v);
    if (job->tree->octets[0].split != NULL) step[0].below = bvxi_octets_rank(&job->tree->octets[0], 8 * octet);
    while (level >= 0) {
        row_state_step *const s = &step[level];
        const bvxi_octets *const o = &job->tree->octets[level];
        if (s->p == 8) {
            level--;
            continue;
        }
        uint32_t const p = s->p++;
        uint64_t const bit = 8 * s->octet + p;
        int32_t const child[3] = {2 * s->v[0] + (int32_t)(p & 1), 2 * s->v[1] + (int32_t)(p >> 1 & 1), 2 * s->v[2] + (int32_t)(p >> 2)};
        if (bvxi_octets_is_split(o, bit) && level + 2 == job->tree->levels && level + 1 >= job->outer_level) {
            decide_last(job, s->below++, child);
        } else if (bvxi_octets_is_split(o, bit)) {
            row_state_step *const next = &step[++level];
            next->octet = s->below++;
            next->below = job->tree->octets[level].split != NULL ? bvxi_octets_rank(&job->tree->octets[level], 8 * next->octet) : 0;
            next->p = 0;
            memcpy(next->v, child, sizeof next->v);
        } else if (!bvxi_bit_of(o->touched, bit) && !centre_is_inside(job, child, level + 1)) {
            o->outside[bit >> 6] |= UINT64_C(1) << (bit & 63);
        }
    }
}

static void decide_base(const row_states_job *job)
{
    const bvx_octree *const tree = job->tree;
    for (int32_t z = 0; z < tree->base[2]; z++)
        for (int32_t y = 0; y < tree->base[1]; y++)
            for (int32_t x = 0; x < tree->base[0]; x++) {
                int32_t const v[3] = {x, y, z};
                uint64_t const bit = bvxi_root_bit(tree, x, y, z);
                if (bvxi_octets_is_split(&tree->root, bit)) decide_tree(job, bvxi_octets_rank(&tree->root, bit), v);
                else if (!bvxi_bit_of(tree->root.touched, bit) && !centre_is_inside(job, v, 0))
                    tree->root.outside[bit >> 6] |= UINT64_C(1) << (bit & 63);
            }
}

bvx_status bvxi_octree_row_states(bvxi_refine_job *job, const bvx_window *window)
{
    bvx_context *const ctx = job->ctx;
    row_states_job rows = {0};
    bvx_voxelize_options o;
    bvx_lattice lattice;
    bvx_status status;
    bvx_voxelize_options_init(&o, sizeof o);
    rows.tree = job->tree;
    rows.outer_level = job->outer;
    BVXI_TRY(bvxi_octree_lattice(ctx, job->tree, job->outer, &lattice));
    status = bvx_voxelize_solid(ctx, job->view, &lattice, &o, &rows.outer);
    o.window = *window;
    if (status == BVX_OK) status = bvx_voxelize_solid(ctx, job->view, &job->tree->lattice, &o, &rows.inner);
    if (status == BVX_OK) decide_base(&rows);
    bvx_grid_free(ctx, &rows.inner);
    bvx_grid_free(ctx, &rows.outer);
    return status;
}
