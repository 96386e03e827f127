/* octree.c - octrees made, freed, counted and looked into: bvx_octree_count, bvx_octree_at, bvx_octree_find
 * and their like.
 *
 * A level keeps bits and ranks: no pointers, and no index of the voxels. */
#include "refine/room.h"

#include <math.h>

/* ---- levels ---- */

bvx_status bvxi_octets_open(bvx_context *ctx, uint64_t count, uint64_t words, int split, bvxi_octets *octets)
{
    *octets = (bvxi_octets){.count = count, .words = words};
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_RESULT, words * 8, "the octree's touched voxels", &octets->touched));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_RESULT, words * 8, "the octree's outside voxels", &octets->outside));
    /* Without a window or a tolerance all touched voxels are split: one mask serves both. */
    if (split == BVXI_SPLIT_ALL) octets->split = octets->touched;
    if (split == BVXI_SPLIT_SOME)
        BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_RESULT, words * 8, "the octree's split voxels", &octets->split));
    if (split == BVXI_SPLIT_NONE) return BVX_OK;
    return bvxi_alloc_zero(ctx, BVXI_RESULT, words * 4, "the octree's ranks", &octets->before);
}

void bvxi_octets_close(bvx_context *ctx, bvxi_octets *octets)
{
    bvxi_free(ctx, octets->before, octets->words * 4);
    if (octets->split != octets->touched) bvxi_free(ctx, octets->split, octets->words * 8);
    bvxi_free(ctx, octets->outside, octets->words * 8);
    bvxi_free(ctx, octets->touched, octets->words * 8);
    memset(octets, 0, sizeof *octets);
}

uint64_t bvxi_octets_count(bvxi_octets *octets)
{
    uint64_t total = 0;
    if (octets->split == NULL) return 0;
    /* Counts before each word make a rank a look-up and one count of bits. */
    for (uint64_t i = 0; i < octets->words; i++) {
        octets->before[i] = (uint32_t)total;
        total += bvxi_popcount(octets->split[i]);
    }
    return total;
}

void bvx_octree_free(bvx_context *context, bvx_octree *tree)
{
    if (context == NULL || tree == NULL) return;
    for (int32_t l = BVXI_OCTREE_LEVELS - 1; l >= 0; l--) bvxi_octets_close(context, &tree->octets[l]);
    bvxi_octets_close(context, &tree->root);
    bvxi_free(context, tree, sizeof *tree);
}

bvx_status bvxi_octree_check(bvx_context *ctx, const char *function, const bvx_octree *tree)
{
    return tree == NULL ? bvxi_fail_null(ctx, function, "tree") : BVX_OK;
}

bvx_status bvxi_octree_check_states(bvx_context *ctx, const char *function, int32_t states)
{
    int32_t const all = BVX_STATE_OUTSIDE | BVX_STATE_INSIDE | BVX_STATE_SURFACE;
    if ((states & ~all) == 0) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: states %d is not a set of states",
                         function, (int64_t)states);
}

int32_t bvx_octree_levels(const bvx_octree *tree)
{
    return tree == NULL ? -1 : tree->levels;
}

/* ---- lattices ---- */

bvx_status bvxi_octree_lattice(bvx_context *ctx, const bvx_octree *tree, int32_t level, bvx_lattice *lattice)
{
    int32_t const up = tree->levels - level;
    double spacing[3];
    int32_t dims[3];

    if (up == 0) {
        *lattice = tree->lattice;
        return BVX_OK;
    }

    /* Powers of two: the spacing is exact. */
    for (int a = 0; a < 3; a++) {
        spacing[a] = tree->lattice.spacing[a] * (double)((int32_t)1 << up);
        dims[a] = tree->base[a] << level;
    }
    return bvx_lattice_make(ctx, tree->lattice.origin, spacing, dims, lattice);
}

bvx_status bvx_octree_lattice(bvx_context *context, const bvx_octree *tree, int32_t level,
                              bvx_lattice *lattice)
{
    static const char *const function = "bvx_octree_lattice";
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (lattice == NULL) return bvxi_fail_null(context, function, "lattice");
    BVXI_TRY(bvxi_octree_check(context, function, tree));
    if (level < 0 || level > tree->levels)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                             "%s: level %d is not one of the tree's 0 to %d", function, (int64_t)level,
                             (int64_t)tree->levels);
    return bvxi_octree_lattice(context, tree, level, lattice);
}

/* ---- counts ---- */

static uint64_t count_mask_bits(const uint64_t *words, uint64_t count)
{
    uint64_t n = 0;
    for (uint64_t i = 0; i < count; i++) n += bvxi_popcount(words[i]);
    return n;
}

static bvx_status run_octree_count(bvx_context *context, const bvx_octree *tree, bvx_octree_level *counts,
                                   int32_t capacity)
{
    static const char *const function = "bvx_octree_count";
    if (counts == NULL) return bvxi_fail_null(context, function, "counts");
    BVXI_TRY(bvxi_octree_check(context, function, tree));
    if (capacity < tree->levels + 1)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the array holds %d levels, the tree has %d",
                         function, (int64_t)capacity, (int64_t)tree->levels + 1);
    for (int32_t l = 0; l <= tree->levels; l++) {
        const bvxi_octets *const o = l == 0 ? &tree->root : &tree->octets[l - 1];
        uint64_t const touched = count_mask_bits(o->touched, o->words);
        bvx_octree_level *const c = &counts[l];
        memset(c, 0, sizeof *c);
        c->voxels = l == 0 ? (uint64_t)tree->base[0] * (uint64_t)tree->base[1] * (uint64_t)tree->base[2]
                           : 8 * o->count;
        c->outside = count_mask_bits(o->outside, o->words);
        c->inside = c->voxels - touched - c->outside;
        c->split = o->split != NULL ? count_mask_bits(o->split, o->words) : 0;
        c->surface = touched - c->split;
        c->bytes = o->words * (16u + (o->before != NULL ? 4u : 0u) +
                               (o->split != NULL && o->split != o->touched ? 8u : 0u));
    }
    return BVX_OK;
}

bvx_status bvx_octree_count(bvx_context *context, const bvx_octree *tree, bvx_octree_level *counts,
                            int32_t capacity)
{
    return BVXI_CALL(context, run_octree_count(context, tree, counts, capacity));
}

/* ---- the leaf at a place ---- */

const bvxi_octets *bvxi_octree_holder(const bvx_octree *tree, int32_t level, const int32_t v[3], int32_t *at,
                                      uint64_t *bit)
{
    const bvxi_octets *o = &tree->root;
    *bit = bvxi_root_bit(tree, v[0] >> level, v[1] >> level, v[2] >> level);
    for (*at = 0; *at < level && bvxi_octets_is_split(o, *bit);) {
        uint64_t const octet = bvxi_octets_rank(o, *bit);
        int32_t const down = level - *at - 1;
        o = &tree->octets[(*at)++];
        *bit = 8 * octet + (uint64_t)((v[0] >> down & 1) + 2 * (v[1] >> down & 1) + 4 * (v[2] >> down & 1));
    }
    return o;
}

typedef struct octree_places {
    const bvx_octree *tree;
    const int32_t *voxels;
    const double *points;
    bvx_octree_leaf *leaves;
    uint64_t count;
    int32_t pieces;
    uint64_t bad[256]; /* by piece: the first place that is none, or count */
} octree_places;

static void find_octree_range(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    octree_places *const job = user;

    job->bad[index] = job->count;
    for (uint64_t i = begin; i < end; i++) {
        const int32_t *voxel = job->voxels + 3 * i;
        int32_t v[3];
        int found;

        if (job->points != NULL) {
            const bvx_lattice *const l = &job->tree->lattice;
            const double *const p = job->points + 3 * i;

            /* Found: 0 when no voxel holds the point, -1 when it is not finite. */
            found = 1;
            for (int a = 0; a < 3; a++) {
                double const at = floor((p[a] - l->origin[a]) / l->spacing[a]);
                if (!(p[a] - p[a] == 0.0)) found = -1;
                /* Compared as doubles: a cast of what is out of range is undefined. */
                else if (at >= 0 && at < (double)l->dims[a]) v[a] = (int32_t)at;
                else if (found > 0) found = 0;
            }
            voxel = v;
        } else {
            const int32_t *const d = job->tree->lattice.dims;
            found = voxel[0] >= 0 && voxel[0] < d[0] && voxel[1] >= 0 && voxel[1] < d[1] && voxel[2] >= 0 &&
                            voxel[2] < d[2]
                        ? 1
                        : -1;
        }
        /* A piece ends at its first bad place: the least number of all pieces is reported. */
        if (found < 0) {
            job->bad[index] = i;
            return;
        }
        /* Outside of the lattice is outside of the body; level 255 says that no leaf holds the point. */
        job->leaves[i] = (bvx_octree_leaf){.level = 255, .state = BVX_STATE_OUTSIDE};
        if (!found) continue;
        int32_t up[3], level;
        uint64_t bit;
        const bvxi_octets *const o = bvxi_octree_holder(job->tree, job->tree->levels, voxel, &level, &bit);
        for (int a = 0; a < 3; a++) up[a] = voxel[a] >> (job->tree->levels - level);
        job->leaves[i] = bvxi_octree_leaf_at(up, level, bvxi_octets_state(o, bit));
    }
}

enum { PLACE_GRAIN = 4096 };

/* given: the job's voxels or points, under this name. *bad: the first of them that is none, or their count. */
static bvx_status find_octree_places(bvx_context *ctx, const char *function, const void *given,
                                     const char *name, octree_places *job, uint64_t *bad)
{
    *bad = job->count;
    BVXI_TRY(bvxi_octree_check(ctx, function, job->tree));
    if (job->count == 0) return BVX_OK;
    if (given == NULL) return bvxi_fail_null(ctx, function, name);
    if (job->leaves == NULL) return bvxi_fail_null(ctx, function, "leaves");
    job->pieces = bvxi_piece_count(job->count, PLACE_GRAIN);
    BVXI_TRY(bvxi_for_pieces(ctx, "octree", 0.0, 1.0, job->pieces, job->count, find_octree_range, job));
    /* From the last piece down, so that the first bad place stays. */
    for (int32_t i = job->pieces; i-- > 0;)
        if (job->bad[i] != job->count) *bad = job->bad[i];
    return BVX_OK;
}

static bvx_status run_octree_at(bvx_context *context, const bvx_octree *tree, const int32_t *voxels,
                                uint64_t count, bvx_octree_leaf *leaves)
{
    static const char *const function = "bvx_octree_at";
    octree_places job = {.tree = tree, .voxels = voxels, .leaves = leaves, .count = count};
    uint64_t bad;
    BVXI_TRY(find_octree_places(context, function, voxels, "voxels", &job, &bad));
    if (bad == count) return BVX_OK;
    return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_INDEX,
                         "%s: voxel %u (%d, %d, %d) is beyond the lattice's %d x %d x %d", function, bad,
                         (int64_t)voxels[3 * bad], (int64_t)voxels[3 * bad + 1], (int64_t)voxels[3 * bad + 2],
                         (int64_t)tree->lattice.dims[0], (int64_t)tree->lattice.dims[1],
                         (int64_t)tree->lattice.dims[2]);
}

bvx_status bvx_octree_at(bvx_context *context, const bvx_octree *tree, const int32_t *voxels, uint64_t count,
                         bvx_octree_leaf *leaves)
{
    return BVXI_CALL(context, run_octree_at(context, tree, voxels, count, leaves));
}

static bvx_status run_octree_find(bvx_context *context, const bvx_octree *tree, const double *points,
                                  uint64_t count, bvx_octree_leaf *leaves)
{
    static const char *const function = "bvx_octree_find";
    octree_places job = {.tree = tree, .points = points, .leaves = leaves, .count = count};
    uint64_t bad;
    BVXI_TRY(find_octree_places(context, function, points, "points", &job, &bad));
    if (bad == count) return BVX_OK;
    return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE, "%s: point %i is not finite",
                         function, bad);
}

bvx_status bvx_octree_find(bvx_context *context, const bvx_octree *tree, const double *points, uint64_t count,
                           bvx_octree_leaf *leaves)
{
    return BVXI_CALL(context, run_octree_find(context, tree, points, count, leaves));
}
