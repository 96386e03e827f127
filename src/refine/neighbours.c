/* neighbours.c - the leaves beyond a face of a leaf: bvx_octree_neighbours.
 *
 * Down from the base towards the voxel of the same size beyond the face: a leaf on the way is the one
 * neighbour; when that voxel is split itself, its leaves on the side of the face are. */
#include "refine/room.h"

typedef struct neighbour_list {
    bvx_octree_leaf *leaves;
    uint64_t capacity, count;
} neighbour_list;

static void give_neighbour(neighbour_list *list, const int32_t v[3], int32_t level, int32_t state)
{
    if (list->count < list->capacity) list->leaves[list->count] = bvxi_octree_leaf_at(v, level, state);
    list->count++;
}

/* The leaves of the voxel at a bit of a level's masks, or of the base's, that lie on its side d. */
static void leaves_on_side(const bvx_octree *tree, const bvxi_octets *o, uint64_t bit, const int32_t v[3],
                           int32_t level, int d, neighbour_list *list)
{
    if (!bvxi_octets_is_split(o, bit)) {
        give_neighbour(list, v, level, bvxi_octets_state(o, bit));
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
    neighbour_list list = {0};
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
    list.leaves = leaves;
    list.capacity = leaves != NULL ? capacity : 0;

    if (v[direction % 3] >= 0 && v[direction % 3] < tree->base[direction % 3] << leaf->level) {
        const bvxi_octets *const o = bvxi_octree_holder(tree, leaf->level, v, &at, &bit);
        int32_t const held[3] = {v[0] >> (leaf->level - at), v[1] >> (leaf->level - at),
                                 v[2] >> (leaf->level - at)};
        leaves_on_side(tree, o, bit, held, at, (direction + 3) % BVXI_DIRECTIONS, &list);
    }

    /* The count is told also where the array was too small. */
    *count = list.count;
    if (leaves != NULL && capacity < list.count)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the array holds %u leaves, there are %u", function,
                         capacity, list.count);
    return BVX_OK;
}
