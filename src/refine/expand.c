/* expand.c - the voxels of one level of an octree as a grid: bvx_octree_expand.
 *
 * Each task takes the base voxels of some columns along x, so that it alone writes their rows. Leaves above
 * the level are boxes; the octets whose children are the level's voxels write two bits to each of four rows.
 * What misses the window is not entered. Guarantee: a window holds the bits of the whole there. */
#include "refine/room.h"
#include "grid/grid.h"

typedef struct expand_job {
    const bvx_octree *tree;
    const bvx_grid *grid;
    int32_t level, states;
    int32_t low[3], high[3];   /* the window, high exclusive */
    int32_t first[3], last[3]; /* base voxels that it meets, inclusive */
} expand_job;

static inline uint64_t *expand_row(const expand_job *job, int32_t y, int32_t z)
{
    return bvxi_grid_row(job->grid, y - job->low[1], z - job->low[2]);
}

/* Set a voxel of another level, cut to the window. */
static void set_expanded_box(const expand_job *job, const int32_t v[3], int32_t level)
{
    int32_t low[3], high[3];
    for (int a = 0; a < 3; a++) {
        int32_t const begin = v[a] << (job->level - level), end = begin + (1 << (job->level - level));
        low[a] = begin > job->low[a] ? begin : job->low[a];
        high[a] = end < job->high[a] ? end : job->high[a];
    }
    for (int32_t z = low[2]; z < high[2]; z++)
        for (int32_t y = low[1]; y < high[1]; y++)
            bvxi_set_run(expand_row(job, y, z), low[0] - job->low[0], high[0] - job->low[0]);
}

/* Set voxels of the level: children of voxel v of the level above. */
static void set_expanded_children(const expand_job *job, const int32_t v[3], uint32_t children)
{
    int32_t const x = 2 * v[0] - job->low[0];

    if (children == 0) return;

    /* Two bits in each of four rows; a window may cut any of them off. */
    for (int32_t r = 0; r < 4; r++) {
        int32_t const y = 2 * v[1] + (r & 1), z = 2 * v[2] + (r >> 1);
        uint64_t const pair = children >> 2 * r & 3;
        if (pair == 0 || y < job->low[1] || y >= job->high[1] || z < job->low[2] || z >= job->high[2])
            continue;
        uint64_t *const row = expand_row(job, y, z);
        for (int32_t i = 0; i < 2; i++)
            if ((pair >> i & 1) != 0 && x + i >= 0 && x + i < job->grid->size[0])
                row[(x + i) >> 6] |= UINT64_C(1) << ((x + i) & 63);
    }
}

/* Voxels of the level in an octet; what is split and meets the window is entered. */
static void expand_octet(const expand_job *job, int32_t level, uint64_t octet, const int32_t v[3])
{
    const bvxi_octets *const o = &job->tree->octets[level];
    uint32_t const in_states = bvxi_octet_in_states(o, octet, job->states);

    if (level + 1 == job->level) {
        set_expanded_children(job, v, in_states);
        return;
    }
    uint32_t const split = bvxi_octet_split(o, octet);
    uint64_t next = split != 0 ? bvxi_octets_rank(o, 8 * octet) : 0;
    for (uint32_t p = 0; p < 8; p++) {
        uint32_t const enter = split >> p & 1;
        uint64_t const below = next;
        int32_t child[3];
        next += enter;
        if (((in_states | split) >> p & 1) == 0) continue;
        bvxi_child_voxel(v, p, child);
        int32_t const up = job->level - level - 1;
        int meets = 1;
        /* At the voxel's own level: it meets the window when it lies between the window's end voxels there. */
        for (int a = 0; a < 3; a++)
            meets &= child[a] <= (job->high[a] - 1) >> up && child[a] >= job->low[a] >> up;
        if (!meets) continue;
        /* Leaves above the level are boxes of it. */
        if (enter) expand_octet(job, level + 1, below, child);
        else set_expanded_box(job, child, level + 1);
    }
}

static void expand_piece(void *user, uint64_t begin, uint64_t end)
{
    const expand_job *const job = user;
    uint64_t const ny = (uint64_t)(job->last[1] - job->first[1]) + 1;
    const bvx_octree *const tree = job->tree;

    for (uint64_t i = begin; i < end; i++)
        for (int32_t x = job->first[0]; x <= job->last[0]; x++) {
            int32_t const v[3] = {x, job->first[1] + (int32_t)(i % ny), job->first[2] + (int32_t)(i / ny)};
            uint64_t const bit = bvxi_root_bit(tree, v[0], v[1], v[2]);
            if (bvxi_octets_is_split(&tree->root, bit) && job->level > 0)
                expand_octet(job, 0, bvxi_octets_rank(&tree->root, bit), v);
            else if ((bvxi_octets_state(&tree->root, bit) & job->states) != 0) set_expanded_box(job, v, 0);
        }
}

static bvx_status run_octree_expand(bvx_context *context, const bvx_octree *tree, int32_t level,
                                    int32_t states, const bvx_window *window, bvx_grid *grid)
{
    static const char *const function = "bvx_octree_expand";
    expand_job job = {.tree = tree, .level = level};
    bvx_lattice lattice;
    bvx_window w;

    if (grid == NULL) return bvxi_fail_null(context, function, "grid");
    BVXI_TRY(bvxi_octree_check(context, function, tree));
    if (level < 0 || level > tree->levels)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                             "%s: level %d is not one of the tree's 0 to %d", function, (int64_t)level,
                             (int64_t)tree->levels);
    BVXI_TRY(bvxi_octree_check_states(context, function, states));
    BVXI_TRY(bvxi_octree_lattice(context, tree, level, &lattice));
    BVXI_TRY(bvxi_window_take(context, function, &lattice, window, &w));

    /* A grid of the library's that is passed again is used again where it is large enough. */
    bvxi_grid_renew(context, &lattice, &w, grid);
    bvx_grid made = *grid;
    BVXI_TRY(bvxi_grid_open(context, function, &lattice, &w, &made));
    memset(made.words, 0, (size_t)bvxi_grid_words(&made) * 8);
    job.grid = &made;
    job.states = states != 0 ? states : BVX_STATE_SURFACE | BVX_STATE_INSIDE;

    for (int a = 0; a < 3; a++) {
        job.low[a] = w.low[a];
        job.high[a] = w.low[a] + w.size[a];
        job.first[a] = w.low[a] >> level;
        job.last[a] = (job.high[a] - 1) >> level;
    }
    uint64_t rows = (uint64_t)(job.last[1] - job.first[1] + 1) * (uint64_t)(job.last[2] - job.first[2] + 1);
    return bvxi_grid_put(context, bvxi_for(context, "octree", rows, 1, expand_piece, &job), &made, grid);
}

bvx_status bvx_octree_expand(bvx_context *context, const bvx_octree *tree, int32_t level, int32_t states,
                             const bvx_window *window, bvx_grid *grid)
{
    return BVXI_CALL(context, run_octree_expand(context, tree, level, states, window, grid));
}
