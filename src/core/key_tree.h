/* key_tree.h - which number has a key first, whatever the keys are. Not installed.
 *
 * What tables of hashes go over to when they search too long, as they do where a file was made against the
 * hash. The answers are the same: numbers by their first appearance. */
#ifndef BVXI_KEY_TREE_H
#define BVXI_KEY_TREE_H

#include "core/core.h"

enum { BVXI_KEY_WORDS = 6 };

/* Fill the key of a number; words that are left alone are 0. */
typedef void bvxi_key_fn(const void *user, uint64_t number, uint32_t key[BVXI_KEY_WORDS]);

typedef struct bvxi_key_tree {
    bvxi_key_fn *key;
    const void *user;
    /* of each number that is in: number + 1 of those below it by the next bit, or 0 [Size: 2 * room] */
    uint32_t *child;
    uint64_t room, steps; /* steps: nodes looked at so far */
    uint32_t root;        /* number + 1, or 0 */
} bvxi_key_tree;

/* An empty tree for numbers below room, at most 2^32 - 1. user stays as
 * long as the tree. Scratch: 8 bytes a number. */
bvx_status bvxi_key_tree_open(bvx_context *ctx, bvxi_key_tree *tree, bvxi_key_fn *key, const void *user,
                              uint64_t room);
bvx_status bvxi_key_tree_grow(bvx_context *ctx, bvxi_key_tree *tree, uint64_t room);
/* Zeroed, or closed already, is fine too. */
void bvxi_key_tree_close(bvx_context *ctx, bvxi_key_tree *tree);

/* The number in the tree whose key is that of number; number itself, now in the tree, where there is none. */
uint64_t bvxi_key_tree_find(bvxi_key_tree *tree, uint64_t number);

/* Steps from slot to slot that a table may take for so many searches:
 * several times what well mixed hashes need. */
static inline uint64_t bvxi_probe_limit(uint64_t searches)
{
    return 8 * searches + 4096;
}

#endif
