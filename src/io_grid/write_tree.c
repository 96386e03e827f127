/* write_tree.c - an octree to our own format; the layout stands in tree_file.h.
 *
 * All lengths are known before, so the file is allocated once and every level writes its part by itself. */
#include "io/formats.h"
#include "io_grid/tree_file.h"

typedef struct tree_writing {
    const bvx_octree *tree;
    uint8_t *bytes;
    /* place: where each level begins, and where the last one ends */
    uint64_t frame, place[BVXI_OCTREE_LEVELS + 2];
} tree_writing;

static void put_tree_head(const bvx_octree *tree, uint8_t *head)
{
    memset(head, 0, BVXI_TREE_HEAD);
    memcpy(head, bvxi_tree_magic(), 8);
    bvxi_store_u32(head + BVXI_TREE_AT_VERSION, BVXI_TREE_VERSION);
    bvxi_store_u32(head + BVXI_TREE_AT_HEAD_SIZE, BVXI_TREE_HEAD);

    /* The fields stand where tree_file.h says; the checksum covers all before it. */
    for (int32_t a = 0; a < 3; a++) {
        bvxi_store_f64(head + BVXI_TREE_AT_ORIGIN + 8 * a, tree->lattice.origin[a]);
        bvxi_store_f64(head + BVXI_TREE_AT_SPACING + 8 * a, tree->lattice.spacing[a]);
        bvxi_store_u32(head + BVXI_TREE_AT_BASE + 4 * a, (uint32_t)tree->base[a]);
    }
    bvxi_store_u32(head + BVXI_TREE_AT_FRACTION, (uint32_t)tree->lattice.fraction_bits);
    bvxi_store_u32(head + BVXI_TREE_AT_LEVELS, (uint32_t)tree->levels);
    bvxi_tree_store(head + BVXI_TREE_AT_CHECK, bvx_hash(head, BVXI_TREE_AT_CHECK, 0));
}

static uint8_t *put_tree_words(uint8_t *p, const uint64_t *words, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++, p += 8) bvxi_tree_store(p, words[i]);
    return p;
}

static const bvxi_octets *octets_of_level(const bvx_octree *tree, int32_t level)
{
    return level == 0 ? &tree->root : &tree->octets[level - 1];
}

static void put_tree_level(void *user, int32_t level, int32_t worker)
{
    const tree_writing *const job = user;
    const bvxi_octets *const o = octets_of_level(job->tree, level);
    uint8_t *const begin = job->bytes + job->place[level];
    uint8_t *p = begin + BVXI_TREE_LEVEL_HEAD;

    (void)worker;
    bvxi_store_u32(begin + 8, (uint32_t)level);
    bvxi_store_u32(begin + 12, (uint32_t)bvxi_tree_split_kind(o));

    /* Split is written only where it is neither nothing nor the same as touched. */
    bvxi_tree_store(begin + 16, o->words);
    p = put_tree_words(p, o->touched, o->words);
    p = put_tree_words(p, o->outside, o->words);
    if (bvxi_tree_split_kind(o) == BVXI_SPLIT_SOME) p = put_tree_words(p, o->split, o->words);
    bvxi_tree_store(begin, bvx_hash(begin + 8, (size_t)(p - begin) - 8, job->frame));
}

bvx_status bvxi_write_tree(bvx_context *ctx, const bvx_octree *tree, bvx_buffer *file)
{
    tree_writing job = {0};
    bvx_status status;

    job.tree = tree;
    job.place[0] = BVXI_TREE_HEAD;

    /* Each level's place follows from the lengths of those above it, so levels are written in any order. */
    for (int32_t l = 0; l <= tree->levels; l++) {
        const bvxi_octets *const o = octets_of_level(tree, l);
        job.place[l + 1] = job.place[l] + BVXI_TREE_LEVEL_HEAD +
                           8 * o->words * bvxi_tree_arrays((uint32_t)bvxi_tree_split_kind(o));
    }
    BVXI_TRY(bvxi_make_buffer(ctx, job.place[tree->levels + 1], "the BVX file", file));
    job.bytes = file->bytes;
    /* The frame is part of every level's checksum: levels of two files cannot be mixed. */
    put_tree_head(tree, job.bytes);
    job.frame = bvxi_tree_frame(job.bytes);
    status = bvxi_parallel(ctx, "write", 0.0, 1.0, tree->levels + 1, put_tree_level, &job);
    if (status != BVX_OK) bvx_buffer_free(ctx, file);
    return status;
}
