/* key_tree.c - a digital search tree.
 *
 * Source: Knuth. The Art of Computer Programming 3, 6.3: digital tree search. Each node holds a whole key;
 * below it the next bit of the sought key gives the side. Two keys on one way down share the bits above, so
 * no way is longer than a key has bits.
 * Guarantee: at most 193 nodes for a search, for any keys. */
#include "core/key_tree.h"

bvx_status bvxi_key_tree_open(bvx_context *ctx, bvxi_key_tree *tree, bvxi_key_fn *key, const void *user,
                              uint64_t room)
{
    memset(tree, 0, sizeof *tree);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, room * 8, "the tree of keys", &tree->child));
    tree->key = key;
    tree->user = user;
    tree->room = room;
    return BVX_OK;
}

bvx_status bvxi_key_tree_grow(bvx_context *ctx, bvxi_key_tree *tree, uint64_t room)
{
    BVXI_TRY(bvxi_resize(ctx, BVXI_SCRATCH, &tree->child, tree->room * 8, room * 8, "the tree of keys"));
    tree->room = room;
    return BVX_OK;
}

void bvxi_key_tree_close(bvx_context *ctx, bvxi_key_tree *tree)
{
    bvxi_drop(ctx, tree->child);
    memset(tree, 0, sizeof *tree);
}

uint64_t bvxi_key_tree_find(bvxi_key_tree *tree, uint64_t number)
{
    uint32_t key[BVXI_KEY_WORDS] = {0}, other[BVXI_KEY_WORDS], *link = &tree->root;

    tree->key(tree->user, number, key);
    for (uint32_t bit = 0; *link != 0; bit++) {
        uint64_t const node = *link - 1;
        memset(other, 0, sizeof other);
        tree->key(tree->user, node, other);
        tree->steps++;
        if (memcmp(key, other, sizeof key) == 0) return node;
        /* keys differ, so a bit is left */
        link = &tree->child[2 * (size_t)node + (key[bit / 32] >> bit % 32 & 1)];
    }
    *link = (uint32_t)number + 1;
    tree->child[2 * (size_t)number] = tree->child[2 * (size_t)number + 1] = 0;
    return number;
}
