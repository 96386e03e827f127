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

typedef struct neighbour_step {
    uint64_t octet;
    uint32_t left; /* children still to be looked at */
    int32_t v[3];
} neighbour_step;

/* The leaves of an octet and all below it on side d. */
static void leaves_on_side(const bvx_octree *tree, int32_t top, uint64_t octet, const int32_t v[3], int d,
                           neighbour_list *list)
{
    neighbour_step stack[BVXI_OCTREE_LEVELS];
    int32_t level = top;

    stack[level].octet = octet;
    stack[level].left = bvxi_octet_side(d);
    memcpy(stack[level].v, v, sizeof stack[level].v);
    while (level >= top) {
        neighbour_step *const s = &stack[level];
        const bvxi_octets *const o = &tree->octets[level];

        if (s->left == 0) {
            level--;
            continue;
        }
        uint32_t const p = (uint32_t)bvxi_lowest(s->left);
        uint64_t const bit = 8 * s->octet + p;
        int32_t child[3];

        bvxi_child_voxel(s->v, p, child);

        /* Off the list before going down, as the walk comes back to this step. */
        s->left &= s->left - 1;
        if (!bvxi_octets_is_split(o, bit)) {
            give_neighbour(list, child, level + 1, bvxi_octets_state(o, bit));
            continue;
        }
        neighbour_step *const next = &stack[++level];
        next->octet = bvxi_octets_rank(o, bit);
        next->left = bvxi_octet_side(d);
        memcpy(next->v, child, sizeof next->v);
    }
}

/* The leaf or octet that holds voxel v of a level; *at becomes the leaf's
 * level. Returns 1 when v itself is split into *octet. */
static int hold_voxel(const bvx_octree *tree, int32_t level, const int32_t v[3], int32_t *at, int32_t *state,
                      uint64_t *octet)
{
    const bvxi_octets *o = &tree->root;
    uint64_t bit = bvxi_root_bit(tree, v[0] >> level, v[1] >> level, v[2] >> level);
    for (*at = 0; bvxi_octets_is_split(o, bit); ++*at) {
        int32_t const down = level - *at - 1;
        *octet = bvxi_octets_rank(o, bit);
        if (*at == level) return 1;
        o = &tree->octets[*at];
        bit = 8 * *octet + (uint64_t)((v[0] >> down & 1) + 2 * (v[1] >> down & 1) + 4 * (v[2] >> down & 1));
    }
    *state = bvxi_octets_state(o, bit);
    return 0;
}

bvx_status bvx_octree_neighbours(bvx_context *context, const bvx_octree *tree, const bvx_octree_leaf *leaf,
                                 int32_t direction, bvx_octree_leaf *leaves, uint64_t capacity,
                                 uint64_t *count)
{
    static const char *const function = "bvx_octree_neighbours";
    neighbour_list list = {0};
    int32_t v[3], at, state = 0;
    uint64_t octet = 0;

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
        if (hold_voxel(tree, leaf->level, v, &at, &state, &octet)) {
            leaves_on_side(tree, leaf->level, octet, v, (direction + 3) % BVXI_DIRECTIONS, &list);
        } else {
            int32_t const held[3] = {v[0] >> (leaf->level - at), v[1] >> (leaf->level - at),
                                     v[2] >> (leaf->level - at)};
            give_neighbour(&list, held, at, state);
        }
    }

    /* The count is told also where the array was too small. */
    *count = list.count;
    if (leaves != NULL && capacity < list.count)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the array holds %u leaves, there are %u", function,
                         capacity, list.count);
    return BVX_OK;
}
