/* refine_level.c - one level of refinement: the touched voxels of a level become octets.
 *
 * Source: Liu, Jing, Zhang, Zhao. Refinement of surface voxels by boundary states (docs/papers.md, 4),
 * section 1.4.1. Down to the start level the children's bits are read from a grid; below it every triangle
 * of a voxel's list is tested against its eight children at once (children.c). The first pass over the
 * voxels, in pieces, makes the masks and counts what each piece passes on; the second one, knowing each
 * piece's places, writes the next level's voxels and lists. Guarantee: exact; the same for any threads. */
#include "refine/cubes.h"
#include "refine/refine.h"

enum { OCTETS_OF_PIECE = 64 };

typedef struct level_job {
    bvxi_refine_job *refine;
    bvxi_octets *octets;
    const bvxi_refine_front *front;
    bvxi_refine_front next;
    uint8_t *hits; /* children that each triangle of the front's lists touches */
    uint32_t *up;
    /* last: 1 when the children are the last level's; half: a child's side */
    int32_t level, pieces, last, half;
    uint64_t children[BVXI_MOST_PIECES], pairs[BVXI_MOST_PIECES]; /* counts, then places */
} level_job;

/* Octets of a piece: whole words of eight, so that no two pieces share one. */
static void octets_of_piece(const level_job *job, int32_t index, uint64_t *begin, uint64_t *end)
{
    bvxi_piece(bvxi_octet_words(job->front->count), job->pieces, index, begin, end);
    *begin *= 8;
    *end = *end * 8 < job->front->count ? *end * 8 : job->front->count;
}

/* The children of voxel v in the grid of the next level. */
static inline uint32_t children_in_grid(const level_job *job, const int32_t *v)
{
    const bvx_octree *const tree = job->refine->tree;
    const uint64_t *const grid = job->refine->grids.words[job->level + 1];
    uint64_t const row = (uint64_t)bvxi_refine_row_words(tree, job->level + 1);
    uint64_t const ny = (uint64_t)tree->base[1] << (job->level + 1);
    /* The word with the two lowest children: two rows of two slices hold all eight, side by side in x. */
    uint64_t const at = (2 * (uint64_t)v[2] * ny + 2 * (uint64_t)v[1]) * row + (uint64_t)(v[0] >> 5);
    unsigned const shift = 2 * ((unsigned)v[0] & 31);
    uint64_t const slice = ny * row;
    return (uint32_t)((grid[at] >> shift & 3) | (grid[at + row] >> shift & 3) << 2 |
                      (grid[at + slice] >> shift & 3) << 4 | (grid[at + slice + row] >> shift & 3) << 6);
}

static inline void list_of_voxel(const bvxi_refine_front *front, uint64_t n, uint64_t *begin, uint64_t *end)
{
    uint64_t const slot = front->slot != NULL ? front->slot[n] : n;
    *begin = front->offset[slot];
    *end = front->offset[slot + 1];
}

/* Triangles of some octets on their way through a batch. */
typedef struct level_batch {
    bvxi_children_batch children;
    uint32_t count;
    uint64_t octet[BVXI_CHILDREN_BATCH], pair[BVXI_CHILDREN_BATCH]; /* pair: place in the front's lists */
} level_batch;

static void end_level_batch(const level_job *job, level_batch *batch)
{
    bvxi_children_of_batch(&batch->children, batch->count, job->half, bvxi_cpu(job->refine->ctx));
    for (uint32_t i = 0; i < batch->count; i++) {
        uint64_t const n = batch->octet[i];
        job->octets->touched[n >> 3] |= (uint64_t)batch->children.touched[i] << (8 * (n & 7));
        if (!job->last) job->hits[batch->pair[i]] = batch->children.touched[i];
    }
    batch->count = 0;
}

static void children_by_list(const level_job *job, uint64_t n, level_batch *batch)
{
    const bvxi_refine_job *const refine = job->refine;
    const int32_t *const v = job->front->ijk + 3 * n, *const xyz = refine->snapped.xyz;
    int32_t centre[3];
    uint64_t begin, end;

    /* About the centre coordinates are small, which the exact tests need. */
    for (int a = 0; a < 3; a++) centre[a] = (2 * v[a] + 1) * job->half;
    list_of_voxel(job->front, n, &begin, &end);
    for (uint64_t pair = begin; pair < end; pair++) {
        uint32_t const i = batch->count++;
        uint32_t corner[3];
        bvxi_view_triangle(refine->view, job->front->list[pair], corner);
        for (int c = 0; c < 3; c++)
            for (int a = 0; a < 3; a++)
                batch->children.p[c][a][i] = xyz[3 * (size_t)corner[c] + (size_t)a] - centre[a];
        batch->octet[i] = n;
        batch->pair[i] = pair;
        if (batch->count < BVXI_CHILDREN_BATCH) continue;
        end_level_batch(job, batch);

        /* Nothing more can be found out about a voxel whose children are all touched. */
        if (job->last && bvxi_octet_mask(job->octets->touched, n) == 255) return;
    }
}

/* Those of an octet's touched children that are split. */
static uint32_t children_to_split(const level_job *job, uint64_t n, uint32_t touched)
{
    const bvxi_refine_job *const refine = job->refine;
    const int32_t *const v = job->front->ijk + 3 * n;
    uint32_t split = 0;

    /* Without window and tolerance all touched children are split, or none on the last level. */
    if (job->octets->split == NULL || job->octets->split == job->octets->touched)
        return job->last ? 0 : touched;
    for (uint32_t p = 0; p < 8; p++) {
        int32_t child[3];

        bvxi_child_voxel(v, p, child);

        /* Outside of the window a touched child stays a leaf. */
        if ((touched >> p & 1) == 0 || !bvxi_refine_wants(refine, job->level + 1, child)) continue;

        /* And so does one whose triangles are flat. */
        if (refine->tolerance > 0) {
            uint64_t begin, end;
            list_of_voxel(job->front, n, &begin, &end);
            if (bvxi_refine_is_flat(refine, job->front->list + begin, job->hits + begin, p, end - begin))
                continue;
        }
        split |= 1u << p;
    }
    bvxi_octet_put(job->octets->split, n, split);
    return split;
}

static void mark_octets(void *user, int32_t index)
{
    level_job *const job = user;
    int const from_grid = job->level < job->refine->start;
    uint64_t begin, end, children = 0, pairs = 0;

    octets_of_piece(job, index, &begin, &end);

    /* From lists all octets of the piece go through batches first; from a grid each is read by itself. */
    if (!from_grid) {
        level_batch batch;
        batch.count = 0;
        /* Batches run over several octets, as most lists are shorter than one. */
        for (uint64_t n = begin; n < end; n++) children_by_list(job, n, &batch);
        end_level_batch(job, &batch);
    }
    for (uint64_t n = begin; n < end; n++) {
        if (from_grid)
            bvxi_octet_put(job->octets->touched, n, children_in_grid(job, job->front->ijk + 3 * n));
        uint32_t const split = children_to_split(job, n, bvxi_octet_mask(job->octets->touched, n));
        children += bvxi_popcount(split);
        /* Triangles that the split children take on. */
        if (from_grid || job->last) continue;
        uint64_t from, to;
        list_of_voxel(job->front, n, &from, &to);
        for (uint64_t i = from; i < to; i++) pairs += bvxi_popcount(job->hits[i] & split);
    }
    job->children[index] = children;
    job->pairs[index] = pairs;
}

static void place_children(void *user, int32_t index)
{
    level_job *const job = user;
    int const lists = job->level >= job->refine->start;
    uint64_t begin, end, child = job->children[index], place = job->pairs[index];

    octets_of_piece(job, index, &begin, &end);
    for (uint64_t n = begin; n < end; n++) {
        const int32_t *const v = job->front->ijk + 3 * n;
        uint32_t const split = bvxi_octet_split(job->octets, n);
        uint64_t from = 0, to = 0;
        if (lists) list_of_voxel(job->front, n, &from, &to);
        for (uint32_t p = 0; p < 8; p++) {
            if ((split >> p & 1) == 0) continue;
            /* The list is read once for each split child: it is short, and in the cache after the first. */
            if (lists) job->next.offset[child] = place;
            for (uint64_t i = from; i < to; i++)
                if ((job->hits[i] >> p & 1) != 0) job->next.list[place++] = job->front->list[i];
            for (uint32_t a = 0; a < 3; a++) job->next.ijk[3 * child + a] = 2 * v[a] + (int32_t)(p >> a & 1);
            job->up[child++] = (uint32_t)(8 * n + p);
        }
    }
}

void bvxi_refine_free_front(bvxi_refine_job *job, bvxi_refine_front *front)
{
    bvxi_drop(job->ctx, front->slot);
    bvxi_drop(job->ctx, front->list);
    bvxi_drop(job->ctx, front->offset);
    bvxi_drop(job->ctx, front->ijk);
    memset(front, 0, sizeof *front);
}

static bvx_status split_front(level_job *job, double from, double to)
{
    bvxi_refine_job *const refine = job->refine;
    bvx_context *const ctx = refine->ctx;
    BVXI_TRY(bvxi_octets_open(ctx, refine->front.count, bvxi_octet_words(refine->front.count),
                              bvxi_refine_split_kind(refine, job->level + 1), job->octets));
    BVXI_TRY(bvxi_each(ctx, "refine", from, (from + to) / 2, job->pieces, mark_octets, job));
    bvxi_octets_count(job->octets);
    if (job->last) return BVX_OK;

    bvxi_refine_front *const next = &job->next;

    next->count = bvxi_place_counts(job->children, (uint64_t)job->pieces);

    /* Numbers of octets and eight times them are kept in 32 bits. */
    if (next->count >= (uint64_t)1 << 28)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "bvx_refine: %u voxels of level %d are to be split, 2^28 - 1 can be; %d levels are possible",
            next->count, (int64_t)job->level + 1, (int64_t)job->level + 1);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, next->count * 12, "a level's voxels", &next->ijk));
    if (job->level >= job->refine->start) {
        next->slots = next->count;
        next->pairs = bvxi_place_counts(job->pairs, (uint64_t)job->pieces);
        BVXI_TRY(BVXI_ARRAY(ctx, next->slots + 1, "a level's list places", next->offset));
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, next->pairs * 4, "a level's triangle lists", &next->list));

        next->offset[next->slots] = next->pairs;
    }
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, next->count * 4, "a level's parents",
                        &job->refine->up[job->level + 1]));

    job->up = refine->up[job->level + 1];
    return bvxi_each(ctx, "refine", (from + to) / 2, to, job->pieces, place_children, job);
}

bvx_status bvxi_refine_split(bvxi_refine_job *job, int32_t level)
{
    const bvx_octree *const tree = job->tree;
    int const lists = level >= job->start;
    double const from = (double)level / (double)tree->levels, to = (double)(level + 1) / (double)tree->levels;
    level_job *split;

    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, sizeof *split, "a level's counts", &split));
    split->refine = job;
    split->octets = &job->tree->octets[level];
    split->front = &job->front;
    split->level = level;
    split->last = level + 1 == tree->levels;
    split->half = (int32_t)1 << (tree->lattice.fraction_bits + tree->levels - level - 1);
    split->pieces = bvxi_piece_count(job->front.count, OCTETS_OF_PIECE);

    /* Lists were made with the start's grid; here each voxel learns which is its own. */
    if (level == job->start) BVXI_TRY(bvxi_refine_lists(job));
    if (lists && !split->last)
        BVXI_TRY(
            bvxi_alloc(job->ctx, BVXI_SCRATCH, job->front.pairs, "a level's touched children", &split->hits));
    BVXI_TRY(split_front(split, from, to));
    bvxi_drop(job->ctx, split->hits);

    /* Above the start nobody reads the lists: they pass through to the level that does. */
    if (!lists) {
        /* The start's lists wait in the fronts above it. */
        split->next.offset = job->front.offset;
        split->next.list = job->front.list;
        split->next.slots = job->front.slots;
        split->next.pairs = job->front.pairs;
        job->front.offset = NULL;
        job->front.list = NULL;
    }
    bvxi_refine_free_front(job, &job->front);

    job->front = split->next;
    bvxi_drop(job->ctx, split);
    return BVX_OK;
}
