/* tree_file.c - octrees to and from our own format, .bvx; tree_file.h has the layout.
 *
 * Guarantee: all checks are done on the file's bytes before a tree is allocated, so a damaged file costs
 * nothing and can make no tree that later calls stumble over. */
#include "io_grid/bvx_file.h"
#include "io_grid/tree_file.h"
#include "io/formats.h"

/* ---- Read ---- */

/* The least level that is wrong is the one reported, whatever the threads. */

static const char read_tree_name[] = "bvx_read_octree";

enum { TREE_LEVEL_GOOD = 0, TREE_LEVEL_CHECKSUM, TREE_LEVEL_BOTH, TREE_LEVEL_SPLIT, TREE_LEVEL_PADDING };

typedef struct tree_level {
    const uint8_t *begin; /* of its head in the file */
    uint64_t words, size; /* size: bytes with its head */
    uint64_t octets;      /* level 0: rows */
    uint64_t split;       /* voxels that are split */
    uint32_t kind;        /* BVXI_SPLIT_... */
    int32_t wrong;
} tree_level;

typedef struct tree_reading {
    bvxi_grid_source source;
    bvx_lattice lattice;
    int32_t base[3], levels, row_words;
    uint64_t frame;
    tree_level level[BVXI_OCTREE_LEVELS + 1];
    bvx_octree *tree;
} tree_reading;

/* ---- head ---- */

static bvx_status take_tree_head(tree_reading *job)
{
    const uint8_t *const head = job->source.begin;
    uint64_t voxels = 1;

    BVXI_TRY(bvxi_bvx_take_start(&job->source, BVXI_BVX_TREE, &job->lattice));

    /* The number of levels bounds the base: its finest lattice must stay within the longest side. */
    job->levels = bvxi_load_side(head + BVXI_TREE_AT_LEVELS);
    if (job->levels < 0 || job->levels > BVXI_OCTREE_LEVELS)
        return BVXI_FILE_FAIL(
            &job->source, BVX_ERR_FORMAT, "byte %u: level %u is the last; 0 to %u are possible",
            (uint64_t)BVXI_TREE_AT_LEVELS, (uint64_t)bvxi_load_u32(head + BVXI_TREE_AT_LEVELS, 0),
            (uint64_t)BVXI_OCTREE_LEVELS);
    for (int32_t a = 0; a < 3; a++) {
        int32_t const n = job->lattice.dims[a];
        if (n < 1 || n > BVXI_MAX_SIDE >> job->levels)
            return BVXI_FILE_FAIL(
                &job->source, BVX_ERR_FORMAT,
                "byte %u: a base of %u voxels along %s; 1 to %d are possible with %d levels",
                (uint64_t)BVXI_BVX_AT_DIMS + 4 * (uint64_t)a,
                (uint64_t)bvxi_load_u32(head + BVXI_BVX_AT_DIMS + 4 * a, 0), bvxi_axis_name[a],
                (int64_t)(BVXI_MAX_SIDE >> job->levels), (int64_t)job->levels);
        job->base[a] = n;
        job->lattice.dims[a] = n << job->levels;
        /* Stops growing above the limit, so that the product cannot overflow on the way. */
        voxels = voxels < (uint64_t)1 << 31 ? voxels * (uint64_t)n : voxels; /* at most 2^56 */
    }
    if (voxels >= (uint64_t)1 << 31)
        return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                              "a base of %d x %d x %d voxels; fewer than 2^31 are possible",
                              (int64_t)job->base[0], (int64_t)job->base[1], (int64_t)job->base[2]);
    bvx_status const status = bvxi_lattice_check(job->source.ctx, "BVX", &job->lattice);
    if (status != BVX_OK) return BVX_ERR_FORMAT; /* the argument at fault is the file */
    job->row_words = bvxi_row_words(job->base[0]);
    job->frame = bvxi_tree_frame(head);
    return BVX_OK;
}

/* ---- lengths ---- */

static bvx_status take_level_heads(tree_reading *job)
{
    const uint8_t *p = job->source.begin + BVXI_BVX_HEAD;
    uint64_t const rows = (uint64_t)job->base[1] * (uint64_t)job->base[2];

    for (int32_t l = 0; l <= job->levels; l++) {
        tree_level *const level = &job->level[l];
        uint64_t const at = (uint64_t)(p - job->source.begin), left = (uint64_t)(job->source.end - p);

        if (left < BVXI_TREE_LEVEL_HEAD)
            return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                                  "byte %u: the file ends in the head of level %d", at + left, (int64_t)l);
        if (bvxi_load_u32(p + 8, 0) != (uint32_t)l)
            return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT, "byte %u: level %u stands where %d belongs",
                                  at + 8, (uint64_t)bvxi_load_u32(p + 8, 0), (int64_t)l);
        level->kind = bvxi_load_u32(p + 12, 0);
        /* Only the last level has no split, and it must say so. */
        if (level->kind > BVXI_SPLIT_SOME || (level->kind == BVXI_SPLIT_NONE) != (l == job->levels))
            return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                                  "byte %u: level %d of %d cannot be split in way %u", at + 12, (int64_t)l,
                                  (int64_t)job->levels, (uint64_t)level->kind);
        level->begin = p;
        level->words = bvxi_load_u64(p + 16, 0);
        /* Divided rather than multiplied: the count is a claim, and a product might overflow. */
        if (level->words > (left - BVXI_TREE_LEVEL_HEAD) / 8 / bvxi_tree_arrays(level->kind))
            return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                                  "byte %u: level %d has %u words an array, the file ends before", at + 16,
                                  (int64_t)l, level->words);
        level->size = BVXI_TREE_LEVEL_HEAD + 8 * level->words * bvxi_tree_arrays(level->kind);
        p += job->level[l].size;
    }

    /* The levels must end where the file does, and level 0 must have the words of its base. */
    if (p != job->source.end)
        return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                              "byte %u: the file continues after its last level",
                              (uint64_t)(p - job->source.begin));
    job->level[0].octets = rows;
    if (job->level[0].words != rows * (uint64_t)job->row_words)
        return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT, "byte %u: level 0 has %u words, its base %u",
                              (uint64_t)BVXI_BVX_HEAD + 16, job->level[0].words,
                              rows * (uint64_t)job->row_words);
    return BVX_OK;
}

/* ---- what the levels hold ---- */

static int32_t look_into_level(const tree_reading *job, int32_t number, tree_level *level)
{
    /* The arrays follow each other: touched, outside, and split where it is not the same as touched. */
    const uint8_t *const touched = level->begin + BVXI_TREE_LEVEL_HEAD;
    const uint8_t *const outside = touched + 8 * level->words;
    const uint8_t *const split = level->kind == BVXI_SPLIT_SOME ? outside + 8 * level->words : touched;

    if (bvxi_load_u64(level->begin, 0) != bvx_hash(level->begin + 8, (size_t)level->size - 8, job->frame))
        return TREE_LEVEL_CHECKSUM;
    level->split = 0;
    for (uint64_t i = 0; i < level->words; i++) {
        uint64_t const t = bvxi_load_u64(touched + 8 * i, 0);
        uint64_t const o = bvxi_load_u64(outside + 8 * i, 0);
        uint64_t const s = bvxi_load_u64(split + 8 * i, 0);
        /* Three rules that later calls rely on: outside is not
         * touched, only touched ones are split, no bits past a row. */
        if ((t & o) != 0) return TREE_LEVEL_BOTH;
        if ((s & ~t) != 0) return TREE_LEVEL_SPLIT;
        if (number == 0 && ((t | o) & ~((i + 1) % (uint64_t)job->row_words == 0 ? bvxi_tail_mask(job->base[0])
                                                                                : ~UINT64_C(0))) != 0)
            return TREE_LEVEL_PADDING;
        level->split += bvxi_popcount(s);
    }
    /* The last level counted its touched voxels, since split names the same bytes there. */
    if (level->kind == BVXI_SPLIT_NONE) level->split = 0;
    return TREE_LEVEL_GOOD;
}

static void look_into_levels(void *user, int32_t number)
{
    tree_reading *const job = user;
    job->level[number].wrong = look_into_level(job, number, &job->level[number]);
}

static bvx_status fail_level(const tree_reading *job, int32_t number)
{
    static const char *const why[] = {"", "is damaged, its checksum differs",
                                      "has a voxel that is touched and outside",
                                      "splits a voxel that no triangle touches", "has bits past its voxels"};
    const tree_level *const level = &job->level[number];
    uint64_t const at = (uint64_t)(level->begin - job->source.begin);
    return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT, "bytes %u to %u: level %d %s", at,
                          at + level->size - 1, (int64_t)number, why[level->wrong]);
}

static bvx_status join_levels(tree_reading *job)
{
    /* From the base down, since the number of octets comes from the level above. */
    for (int32_t l = 0; l <= job->levels; l++) {
        tree_level *const level = &job->level[l];
        uint64_t const at = (uint64_t)(level->begin - job->source.begin);
        if (level->wrong != TREE_LEVEL_GOOD) return fail_level(job, l);
        if (l == 0) continue;
        level->octets = job->level[l - 1].split;
        /* Eight voxels an octet: their number must stay below 2^31. */
        if (level->octets >= (uint64_t)1 << 28)
            return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                                  "byte %u: level %d splits %u voxels; fewer than 2^28 are possible", at,
                                  (int64_t)l - 1, level->octets);
        if (level->words != bvxi_octet_words(level->octets))
            return BVXI_FILE_FAIL(&job->source, BVX_ERR_FORMAT,
                                  "byte %u: level %d has %u words an array; %u split voxels take %u", at + 16,
                                  (int64_t)l, level->words, level->octets, bvxi_octet_words(level->octets));
        /* Bits past the last octet would be voxels that no parent has. */
        for (uint64_t n = level->octets; n < 8 * level->words; n++) /* the bytes past the last octet */
            for (uint64_t array = 0; array < 2; array++)
                if (level->begin[BVXI_TREE_LEVEL_HEAD + 8 * level->words * array + n] != 0)
                    level->wrong = TREE_LEVEL_PADDING;
        if (level->wrong != TREE_LEVEL_GOOD) return fail_level(job, l);
    }
    return BVX_OK;
}

/* ---- the tree ---- */

static void load_tree_words(const uint8_t *p, uint64_t count, uint64_t *words)
{
    for (uint64_t i = 0; i < count; i++) words[i] = bvxi_load_u64(p + 8 * i, 0);
}

static void load_tree_level(void *user, int32_t number)
{
    const tree_reading *const job = user;
    const tree_level *const level = &job->level[number];
    const uint8_t *const p = level->begin + BVXI_TREE_LEVEL_HEAD;
    bvxi_octets *const o = number == 0 ? &job->tree->root : &job->tree->octets[number - 1];
    /* Words are turned to this machine's order one by one: the file is little-endian, at any address. */
    load_tree_words(p, level->words, o->touched);
    load_tree_words(p + 8 * level->words, level->words, o->outside);
    if (level->kind == BVXI_SPLIT_SOME) load_tree_words(p + 16 * level->words, level->words, o->split);
    bvxi_octets_count(o);
}

static bvx_status run_read_octree(bvx_context *context, const void *bytes, uint64_t size, bvx_octree **tree)
{
    tree_reading job = {0};

    if (tree == NULL) return bvxi_fail_null(context, read_tree_name, "tree");
    BVXI_TRY(bvxi_take_grid_file(context, read_tree_name, bytes, size, BVX_FORMAT_BVX, &job.source));
    if (size == 0) return bvxi_fail(context, BVX_ERR_FORMAT, "%s: the file has no bytes", read_tree_name);
    BVXI_TRY(take_tree_head(&job));
    BVXI_TRY(take_level_heads(&job));
    BVXI_TRY(bvxi_each(context, "read", 0.0, 0.6, job.levels + 1, look_into_levels, &job));
    BVXI_TRY(join_levels(&job));

    bvx_status status = BVX_OK;

    BVXI_TRY(bvxi_alloc_zero(job.source.ctx, BVXI_RESULT, sizeof *job.tree, "the octree", &job.tree));
    job.tree->lattice = job.lattice;
    memcpy(job.tree->base, job.base, sizeof job.tree->base);
    job.tree->levels = job.levels;
    job.tree->row_words = job.row_words;
    for (int32_t l = 0; l <= job.levels && status == BVX_OK; l++)
        status = bvxi_octets_open(job.source.ctx, job.level[l].octets, job.level[l].words,
                                  (int)job.level[l].kind,
                                  l == 0 ? &job.tree->root : &job.tree->octets[l - 1]);
    if (status == BVX_OK)
        status = bvxi_each(job.source.ctx, "read", 0.6, 1.0, job.levels + 1, load_tree_level, &job);
    if (status != BVX_OK) bvx_octree_free(job.source.ctx, job.tree);
    BVXI_TRY(status);

    /* The old tree is freed only when the new one is complete. */
    bvx_octree_free(context, *tree);
    *tree = job.tree;
    return BVX_OK;
}

bvx_status bvx_read_octree(bvx_context *context, const void *bytes, uint64_t size, bvx_octree **tree)
{
    return BVXI_CALL(context, run_read_octree(context, bytes, size, tree));
}

/* ---- Written ---- */

/* All lengths are known before, so the file is allocated once and every level writes its part by itself. */

typedef struct tree_writing {
    const bvx_octree *tree;
    uint8_t *bytes;
    /* place: where each level begins, and where the last one ends */
    uint64_t frame, place[BVXI_OCTREE_LEVELS + 2];
} tree_writing;

static uint8_t *put_tree_words(uint8_t *p, const uint64_t *words, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++, p += 8) bvxi_store_u64(p, words[i]);
    return p;
}

static const bvxi_octets *octets_of_level(const bvx_octree *tree, int32_t level)
{
    return level == 0 ? &tree->root : &tree->octets[level - 1];
}

static void put_tree_level(void *user, int32_t level)
{
    const tree_writing *const job = user;
    const bvxi_octets *const o = octets_of_level(job->tree, level);
    uint8_t *const begin = job->bytes + job->place[level];
    uint8_t *p = begin + BVXI_TREE_LEVEL_HEAD;
    bvxi_store_u32(begin + 8, (uint32_t)level);
    bvxi_store_u32(begin + 12, (uint32_t)bvxi_tree_split_kind(o));
    bvxi_store_u64(begin + 16, o->words);
    p = put_tree_words(p, o->touched, o->words);
    p = put_tree_words(p, o->outside, o->words);
    if (bvxi_tree_split_kind(o) == BVXI_SPLIT_SOME) p = put_tree_words(p, o->split, o->words);
    bvxi_store_u64(begin, bvx_hash(begin + 8, (size_t)(p - begin) - 8, job->frame));
}

bvx_status bvxi_write_tree(bvx_context *ctx, const bvx_octree *tree, bvx_buffer *file)
{
    tree_writing job = {.tree = tree};
    job.place[0] = BVXI_BVX_HEAD;

    /* Each level's place follows from the lengths of those above it, so levels are written in any order. */
    for (int32_t l = 0; l <= tree->levels; l++) {
        const bvxi_octets *const o = octets_of_level(tree, l);
        job.place[l + 1] = job.place[l] + BVXI_TREE_LEVEL_HEAD +
                           8 * o->words * bvxi_tree_arrays((uint32_t)bvxi_tree_split_kind(o));
    }
    BVXI_TRY(bvxi_make_buffer(ctx, job.place[tree->levels + 1], "the BVX file", file));
    job.bytes = file->bytes;
    /* The frame is part of every level's checksum: levels of two files cannot be mixed. */
    uint8_t *const head = job.bytes;
    bvxi_bvx_put_start(head, BVXI_BVX_TREE, &tree->lattice, tree->base);
    bvxi_store_u32(head + BVXI_TREE_AT_LEVELS, (uint32_t)tree->levels);
    bvxi_store_u64(head + BVXI_BVX_AT_CHECK, bvx_hash(head, BVXI_BVX_AT_CHECK, 0));

    job.frame = bvxi_tree_frame(job.bytes);
    bvx_status const status = bvxi_each(ctx, "write", 0.0, 1.0, tree->levels + 1, put_tree_level, &job);
    if (status != BVX_OK) bvx_buffer_free(ctx, file);
    return status;
}
