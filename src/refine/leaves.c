/* leaves.c - the leaves of an octree as a list: bvx_octree_leaves; those beside a leaf.
 *
 * Pieces of the base are walked twice: once to count, once, knowing where each piece's leaves go, to write
 * them.
 * Guarantee: base voxels in the order z, y, x; within one depth first, children 0 to 7 (x changes fastest).
 * Threads do not show. */
#include "refine/room.h"

typedef struct leaves_job {
    const bvx_octree *tree;
    bvx_octree_leaf *leaves; /* NULL: count */
    int32_t states, pieces;
    /* by piece: the first walk counts its leaves, then that is where they begin, the second reads
     * it */
    uint64_t place[BVXI_MOST_PIECES];
} leaves_job;

static inline void give_leaf(const leaves_job *job, uint64_t *place, const int32_t v[3], int32_t level,
                             int32_t state)
{
    if ((job->states & state) == 0) return;
    if (job->leaves != NULL) job->leaves[*place] = bvxi_octree_leaf_at(v, level, state);
    ++*place;
}

/* Depth first; an octet's split children are consecutive octets below. */
static void leaves_of_octet(const leaves_job *job, int32_t level, uint64_t octet, const int32_t v[3],
                            uint64_t *place)
{
    const bvxi_octets *const o = &job->tree->octets[level];
    uint64_t below = o->split != NULL ? bvxi_octets_rank(o, 8 * octet) : 0;
    for (uint64_t bit = 8 * octet; bit < 8 * octet + 8; bit++) {
        int32_t child[3];
        bvxi_child_voxel(v, (uint32_t)(bit & 7), child);
        if (bvxi_octets_is_split(o, bit)) leaves_of_octet(job, level + 1, below++, child, place);
        else give_leaf(job, place, child, level + 1, bvxi_octets_state(o, bit));
    }
}

static void leaves_of_piece(void *user, int32_t index)
{
    leaves_job *const job = user;
    const bvx_octree *const tree = job->tree;
    uint64_t const nx = (uint64_t)tree->base[0], ny = (uint64_t)tree->base[1];
    uint64_t begin, end, place = job->leaves != NULL ? job->place[index] : 0;

    bvxi_piece(nx * ny * (uint64_t)tree->base[2], job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        int32_t const v[3] = {(int32_t)(i % nx), (int32_t)(i / nx % ny), (int32_t)(i / nx / ny)};
        uint64_t const bit = bvxi_root_bit(tree, v[0], v[1], v[2]);
        if (bvxi_octets_is_split(&tree->root, bit))
            leaves_of_octet(job, 0, bvxi_octets_rank(&tree->root, bit), v, &place);
        else give_leaf(job, &place, v, 0, bvxi_octets_state(&tree->root, bit));
    }

    if (job->leaves == NULL) job->place[index] = place;
}

bvx_status bvxi_octree_leaves(bvxi_call step, const bvx_octree *tree, int32_t states, bvx_octree_leaf *leaves,
                              uint64_t capacity, uint64_t *count)
{
    double const middle = leaves != NULL ? step.from + (step.to - step.from) * 0.4 : step.to;
    bvx_context *const ctx = step.ctx;

    BVXI_TRY(bvxi_octree_check(ctx, step.function, tree));
    BVXI_TRY(bvxi_octree_check_states(ctx, step.function, states));
    leaves_job job = {.tree = tree, .states = states != 0 ? states : BVX_STATE_SURFACE | BVX_STATE_INSIDE};
    job.pieces = bvxi_piece_count((uint64_t)tree->base[0] * (uint64_t)tree->base[1] * (uint64_t)tree->base[2],
                                  1);
    BVXI_TRY(bvxi_each(ctx, step.stage, step.from, middle, job.pieces, leaves_of_piece, &job));
    uint64_t const total = bvxi_place_counts(job.place, (uint64_t)job.pieces);
    *count = total;

    /* Nothing is written where the array is too small: count and message have the number that is needed. */
    if (leaves != NULL) {
        if (capacity < total)
            return bvxi_fail(ctx, BVX_ERR_CAPACITY, "%s: the array holds %u leaves, there are %u",
                             step.function, capacity, total);
        job.leaves = leaves;
        BVXI_TRY(bvxi_each(ctx, step.stage, middle, step.to, job.pieces, leaves_of_piece, &job));
    }
    return BVX_OK;
}

bvx_status bvx_octree_leaves(bvx_context *context, const bvx_octree *tree, int32_t states,
                             bvx_octree_leaf *leaves, uint64_t capacity, uint64_t *count)
{
    return BVXI_CALL(context, count == NULL
                                  ? bvxi_fail_null(context, __func__, "count")
                                  : bvxi_octree_leaves(bvxi_call_of(context, __func__, "octree", 0.0, 1.0),
                                                       tree, states, leaves, capacity, count));
}

/* ---- the leaves beyond a face of a leaf: bvx_octree_neighbours ---- */

/* Down from the base towards the voxel of the same size beyond the face: a leaf on the way is the one
 * neighbour; when that voxel is split itself, its leaves on the side of the face are. */

typedef struct neighbour_list {
    bvx_octree_leaf *leaves;
    uint64_t capacity, count;
} neighbour_list;

/* The leaves of the voxel at a bit of a level's masks, or of the base's, that lie on its side d. */
static void leaves_on_side(const bvx_octree *tree, const bvxi_octets *o, uint64_t bit, const int32_t v[3],
                           int32_t level, int d, neighbour_list *list)
{
    if (!bvxi_octets_is_split(o, bit)) {
        if (list->count < list->capacity)
            list->leaves[list->count] = bvxi_octree_leaf_at(v, level, bvxi_octets_state(o, bit));
        list->count++;
        return;
    }
    uint64_t const octet = bvxi_octets_rank(o, bit);
    for (uint32_t left = bvxi_octet_side(d); left != 0; left &= left - 1) {
        uint32_t const p = (uint32_t)bvxi_lowest(left);
        int32_t child[3];
        bvxi_child_voxel(v, p, child);
        leaves_on_side(tree, &tree->octets[level], 8 * octet + p, child, level + 1, d, list);
    }
}

bvx_status bvx_octree_neighbours(bvx_context *context, const bvx_octree *tree, const bvx_octree_leaf *leaf,
                                 int32_t direction, bvx_octree_leaf *leaves, uint64_t capacity,
                                 uint64_t *count)
{
    static const char *const function = "bvx_octree_neighbours";
    int32_t v[3], at;
    uint64_t bit;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (leaf == NULL || count == NULL)
        return bvxi_fail_null(context, function, leaf == NULL ? "leaf" : "count");
    BVXI_TRY(bvxi_octree_check(context, function, tree));
    if (direction < 0 || direction >= BVXI_DIRECTIONS)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: direction is %d; 0 to 5 are possible", function, (int64_t)direction);
    if (leaf->level > tree->levels)
        return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_INDEX, "%s: level %d is beyond the tree's %d",
                             function, (int64_t)leaf->level, (int64_t)tree->levels);

    /* A leaf from another tree may name a voxel that this one does not have. */
    for (int a = 0; a < 3; a++)
        if (leaf->ijk[a] < 0 || leaf->ijk[a] >= tree->base[a] << leaf->level)
            return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                 "%s: voxel (%d, %d, %d) is beyond level %d", function, (int64_t)leaf->ijk[0],
                                 (int64_t)leaf->ijk[1], (int64_t)leaf->ijk[2], (int64_t)leaf->level);
    memcpy(v, leaf->ijk, sizeof v);

    v[direction % 3] += direction >= 3 ? 1 : -1;
    neighbour_list list = {.leaves = leaves, .capacity = leaves != NULL ? capacity : 0};

    if (v[direction % 3] >= 0 && v[direction % 3] < tree->base[direction % 3] << leaf->level) {
        const bvxi_octets *const o = bvxi_octree_holder(tree, leaf->level, v, &at, &bit);
        int32_t const held[3] = {v[0] >> (leaf->level - at), v[1] >> (leaf->level - at),
                                 v[2] >> (leaf->level - at)};
        leaves_on_side(tree, o, bit, held, at, (direction + 3) % BVXI_DIRECTIONS, &list);
    }

    /* The caller learns what would be enough. */
    *count = list.count;
    if (leaves != NULL && capacity < list.count)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the array holds %u leaves, there are %u", function,
                         capacity, list.count);
    return BVX_OK;
}
