/* refine_start.c - where refinement starts: a grid of one level, the coarser ones above it, and the triangles
 * of its voxels.
 *
 * A voxel's closed box is that of its eight children together, so a voxel is touched exactly when one of its
 * children is: all levels above the start come from its grid by or. When the start is the last level no lists
 * are needed at all. The start level's voxels are larger than the lattice's by a power of two: the surface's
 * code takes them as voxels with more fraction bits. Up to 16 of those the surface's own batches are exact;
 * above, small triangles are tested as octants are, about the point that their voxels share. Guarantee:
 * exact; the same voxels and lists, but for a list's order, for any threads. */
#include "refine/cubes.h"
#include "refine/refine.h"
#include "touch/surface_voxels.h"

static const char refine_name[] = "bvx_refine";

/* ---- one triangle among large voxels ---- */

/* A run cut to the window and the tile. */
static inline void touch_cut_run(bvxi_surface_tile *tile, int32_t j, int32_t k, int32_t x0, int32_t x1,
                                 uint32_t t)
{
    int32_t const first = x0 > 0 ? x0 : 0, last = x1 < tile->job->size[0] ? x1 : tile->job->size[0] - 1;
    /* Beyond the tile another task sets the same run. */
    if (first > last || j < tile->rows.j0 || j >= tile->rows.j1 || k < tile->rows.k0 || k >= tile->rows.k1)
        return;
    bvxi_touch_run(tile->job, j, k, first, last, t);
}

/* Triangles of at most two voxels along each axis, about the low corner of their high voxel. */
typedef struct start_batch {
    bvxi_children_batch children;
    uint32_t count, triangle[BVXI_CHILDREN_BATCH];
    int32_t high[3][BVXI_CHILDREN_BATCH];
} start_batch;

static void end_start_batch(bvxi_surface_tile *tile, start_batch *b)
{
    bvxi_children_of_batch(&b->children, b->count, (int32_t)1 << tile->job->fraction_bits, tile->job->cpu);
    for (uint32_t i = 0; i < b->count; i++) {
        int32_t const x = b->high[0][i], y = b->high[1][i], z = b->high[2][i];
        /* Four rows of two voxels about the corner that the children were judged around. */
        for (int32_t r = 0; r < 4; r++) {
            uint32_t const pair = b->children.touched[i] >> 2 * r & 3;
            if (pair != 0)
                touch_cut_run(tile, y - 1 + (r & 1), z - 1 + (r >> 1), x - (int32_t)(pair & 1),
                              x - (pair == 1), b->triangle[i]);
        }
    }
    b->count = 0;
}

static void touch_large_voxels(bvxi_surface_tile *tile, const bvxi_refine_job *refine, uint32_t t,
                               start_batch *batch)
{
    int32_t const f = tile->job->fraction_bits;
    int32_t p[3][3], low[3], high[3], thick = 0, widest = 0;
    uint32_t corner[3];

    bvxi_view_triangle(tile->job->view, t, corner);
    for (int c = 0; c < 3; c++) memcpy(p[c], tile->job->snapped.xyz + 3 * (size_t)corner[c], sizeof p[c]);
    for (int a = 0; a < 3; a++) {
        /* A corner on a plane between voxels touches both: the low end goes one unit down. */
        low[a] = bvxi_floor_shift(bvxi_least_of_three(p[0][a], p[1][a], p[2][a]) - 1, f);
        high[a] = bvxi_floor_shift(bvxi_most_of_three(p[0][a], p[1][a], p[2][a]), f);
        thick += high[a] > low[a];
        if (high[a] - low[a] > widest) widest = high[a] - low[a];
    }

    /* Bits are needed everywhere, lists only where voxels will be split: of some levels on within the window. */
    int32_t const up = refine->tree->levels - refine->start;
    int const all = tile->job->task == BVXI_TOUCH_SET || !refine->windowed || refine->start < refine->outer;
    for (int a = 0; a < 3 && !all; a++)
        if (high[a] < refine->low[a] >> up || low[a] > refine->last[a] >> up) return;

    /* Long ones by rows; those of at most two voxels along each axis as octants of one cube. */
    if (thick > 1 && widest > 1) {
        bvxi_touch_rows(tile, (const int32_t(*)[3])p, t);
    } else if (thick > 1) {
        uint32_t const i = batch->count++;
        for (int k = 0; k < 9; k++)
            batch->children.p[k / 3][k % 3][i] = p[k / 3][k % 3] - high[k % 3] * ((int32_t)1 << f);
        for (int a = 0; a < 3; a++) batch->high[a][i] = high[a];
        batch->triangle[i] = t;
        if (batch->count == BVXI_CHILDREN_BATCH) end_start_batch(tile, batch);
    } else { /* along one axis at most: it touches all of its box */
        int32_t const j0 = low[1] > tile->rows.j0 ? low[1] : tile->rows.j0;
        int32_t const k0 = low[2] > tile->rows.k0 ? low[2] : tile->rows.k0;
        for (int32_t k = k0; k <= high[2] && k < tile->rows.k1; k++)
            for (int32_t j = j0; j <= high[1] && j < tile->rows.j1; j++)
                touch_cut_run(tile, j, k, low[0], high[0], t);
    }
}

/* ---- all triangles ---- */

typedef struct start_job {
    bvxi_surface_job surface;
    const bvxi_refine_job *refine;
} start_job;

static void touch_start_tile(void *user, int32_t number)
{
    start_job *const start = user;
    bvxi_surface_job *const job = &start->surface;
    uint64_t const begin = job->bins.end[number], count = job->bins.end[number + 1] - begin;
    const uint32_t *const id = job->bins.id != NULL ? job->bins.id + begin : NULL;
    bvxi_surface_tile tile = {0};

    tile.job = job;
    tile.rows = bvxi_tiles_rows(&job->tiles, number);
    tile.number = number;

    /* Up to 16 bits the surface's own code is exact. */
    if (job->fraction_bits <= BVXI_MAX_FRACTION) {
        bvxi_touch_conservative(&tile, id, count);
        return;
    }
    start_batch batch;
    batch.count = 0;
    for (uint64_t i = 0; i < count; i++)
        touch_large_voxels(&tile, start->refine, id != NULL ? id[i] : (uint32_t)i, &batch);
    end_start_batch(&tile, &batch);
}

static bvx_status touch_start(bvx_context *ctx, start_job *start, int32_t task, double from, double to)
{
    start->surface.task = task;
    return bvxi_each(ctx, "refine", from, to, start->surface.tiles.count, touch_start_tile, start);
}

static bvx_status make_start_lists(bvxi_refine_job *job, start_job *start)
{
    bvxi_surface_job *const surface = &start->surface;
    bvx_context *const ctx = job->ctx;
    uint64_t const words = bvxi_refine_grid_words(job->tree, job->start), bytes = bvxi_rank_bytes(words);
    uint32_t *prefix = NULL;
    uint64_t voxels = 0;

    for (uint64_t i = 0; i < words; i++) voxels += bvxi_popcount(job->grids.words[job->start][i]);

    /* Ranks are 32 bits. */
    if (voxels >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: triangles touch %u voxels of level %d; 2^32 - 2 are possible", refine_name,
                             voxels, (int64_t)job->start);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the start's ranks", &prefix));
    job->front.slots = bvxi_rank_build(&surface->rank, job->grids.words[job->start], words, prefix);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, voxels * 4, "the start's last triangles", &surface->last));
    BVXI_TRY(BVXI_ZEROS(ctx, job->front.slots + 1, "the start's list places", job->front.offset));
    surface->offset = job->front.offset;

    /* The last triangle of each voxel, so that one that comes by several rows counts once. */
    memset(surface->last, 0, (size_t)job->front.slots * 4);

    /* Counted, then filled: the lists lie one after the other in one array. */
    BVXI_TRY(touch_start(ctx, start, BVXI_TOUCH_COUNT, 0.6, 0.8));
    job->front.pairs = job->front.offset[job->front.slots] = bvxi_place_counts(job->front.offset,
                                                                               job->front.slots);
    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, job->front.pairs * 4, "the start's triangle lists", &job->front.list));
    surface->list = job->front.list;
    memset(surface->last, 0, (size_t)job->front.slots * 4);
    BVXI_TRY(touch_start(ctx, start, BVXI_TOUCH_LIST, 0.8, 0.95));
    /* filling has moved each to its end */
    for (uint64_t v = job->front.slots; v > 0; v--) job->front.offset[v] = job->front.offset[v - 1];
    job->front.offset[0] = 0;
    bvxi_drop(ctx, surface->last);
    return BVX_OK;
}

/* ---- coarser levels ---- */

/* Bit i of the result: bit 2 i or bit 2 i + 1 of w. */
static inline uint64_t pairs_of_bits(uint64_t w)
{
    w = (w | w >> 1) & UINT64_C(0x5555555555555555);
    w = (w | w >> 1) & UINT64_C(0x3333333333333333);
    w = (w | w >> 2) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    w = (w | w >> 4) & UINT64_C(0x00ff00ff00ff00ff);
    w = (w | w >> 8) & UINT64_C(0x0000ffff0000ffff);
    return (w | w >> 16) & UINT64_C(0x00000000ffffffff);
}

typedef struct coarsen_job {
    const bvx_octree *tree;
    const uint64_t *fine;
    uint64_t *coarse;
    int32_t level; /* of the coarse one */
} coarsen_job;

static void coarsen_rows(void *user, uint64_t begin, uint64_t end)
{
    const coarsen_job *const job = user;
    uint64_t const ny = (uint64_t)job->tree->base[1] << job->level;
    size_t const coarse = (size_t)bvxi_refine_row_words(job->tree, job->level);
    size_t const fine = (size_t)bvxi_refine_row_words(job->tree, job->level + 1);

    for (uint64_t row = begin; row < end; row++) {
        const uint64_t *const a = job->fine + (size_t)(4 * ny * (row / ny) + 2 * (row % ny)) * fine;
        const uint64_t *const b = a + fine;
        const uint64_t *const c = a + (size_t)(2 * ny) * fine, *const d = c + fine;
        uint64_t *const to = job->coarse + (size_t)row * coarse;
        for (size_t i = 0; i < coarse; i++) {
            /* Two words side by side become one; an odd last word has no partner. */
            uint64_t const low = a[2 * i] | b[2 * i] | c[2 * i] | d[2 * i];
            uint64_t const high = 2 * i + 1 < fine ? a[2 * i + 1] | b[2 * i + 1] | c[2 * i + 1] | d[2 * i + 1]
                                                   : 0;
            to[i] = pairs_of_bits(low) | pairs_of_bits(high) << 32;
        }
    }
}

enum { COARSEN_GRAIN = 512 };

/* ---- the root and the first front ---- */

/* Which of the root's touched voxels are split; r is their rank among these. */
static void split_root(bvxi_refine_job *job)
{
    bvx_octree *const tree = job->tree;
    uint64_t r = 0;

    for (uint64_t word = 0; word < tree->root.words; word++)
        for (uint64_t w = tree->root.touched[word]; w != 0; w &= w - 1, r++) {
            uint64_t const row = word / (uint64_t)tree->row_words, ny = (uint64_t)tree->base[1];
            int32_t const x = (int32_t)(word % (uint64_t)tree->row_words) * BVXI_WORD_BITS + bvxi_lowest(w);
            int32_t const v[3] = {x, (int32_t)(row % ny), (int32_t)(row / ny)};

            /* Lists are in the order of the touched voxels, so the rank is their number. */
            const uint64_t *const list = job->front.offset + r;
            if (!bvxi_refine_wants(job, 0, v)) continue;
            if (job->tolerance > 0 &&
                bvxi_refine_is_flat(job, job->front.list + list[0], NULL, 0, list[1] - list[0]))
                continue;
            tree->root.split[word] |= w & (0 - w);
        }
}

static bvx_status make_first_front(bvxi_refine_job *job)
{
    bvx_octree *const tree = job->tree;
    uint64_t const rows = (uint64_t)tree->base[1] * (uint64_t)tree->base[2];
    uint64_t n = 0;

    BVXI_TRY(bvxi_octets_open(job->ctx, rows, bvxi_refine_grid_words(tree, 0), bvxi_refine_split_kind(job, 0),
                              &tree->root));

    /* The base's grid is the root's mask as it stands: rows of bits both. */
    memcpy(tree->root.touched, job->grids.words[0], (size_t)tree->root.words * 8);
    if (bvxi_refine_split_kind(job, 0) == BVXI_SPLIT_SOME) split_root(job);
    job->front.count = bvxi_octets_count(&tree->root);

    if (tree->levels == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->front.count * 12, "the base's voxels", &job->front.ijk));
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->front.count * 4, "the base's voxels", &job->up[0]));
    for (uint64_t row = 0; row < rows; row++)
        for (int32_t i = 0; i < tree->row_words; i++)
            for (uint64_t w = tree->root.split[row * (uint64_t)tree->row_words + (uint64_t)i]; w != 0;
                 w &= w - 1, n++) {
                int32_t const x = BVXI_WORD_BITS * i + bvxi_lowest(w);
                job->front.ijk[3 * n] = x;
                job->front.ijk[3 * n + 1] = (int32_t)(row % (uint64_t)tree->base[1]);
                job->front.ijk[3 * n + 2] = (int32_t)(row / (uint64_t)tree->base[1]);
                job->up[0][n] = (uint32_t)(row * (uint64_t)tree->base[0] + (uint64_t)x);
            }
    return BVX_OK;
}

bvx_status bvxi_refine_start(bvxi_refine_job *job)
{
    uint64_t const words = bvxi_refine_grid_words(job->tree, job->start);
    /* On 32-bit machines a request would wrap around and succeed. */
    if (words > SIZE_MAX / 8)
        return bvxi_fail(job->ctx, BVX_ERR_BUDGET,
                         "%s: a grid of level %d is beyond this machine's addresses", refine_name,
                         (int64_t)job->start);
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, words * 8, "the start's grid",
                             &job->grids.words[job->start]));
    const bvx_octree *const tree = job->tree;
    start_job *start;

    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, sizeof *start, "the start's counts", &start));
    bvx_grid grid = {.words = job->grids.words[job->start],
                     .words_per_row = bvxi_refine_row_words(tree, job->start)};
    start->refine = job;
    for (int a = 0; a < 3; a++) start->surface.size[a] = tree->base[a] << job->start;
    start->surface.view = job->view;
    start->surface.solid = NULL;
    start->surface.grid = &grid;
    start->surface.snapped = job->snapped;
    start->surface.fraction_bits = tree->lattice.fraction_bits + tree->levels - job->start;
    start->surface.mode = BVX_SURFACE_CONSERVATIVE;
    start->surface.cpu = bvxi_cpu(job->ctx);
    /* One thread has no use for tiles, and each would look at its triangles anew. */
    bvxi_tiles_choose(&start->surface.tiles, start->surface.size[1], start->surface.size[2],
                      bvxi_threads(job->ctx) == 1 ? 1 : BVXI_SURFACE_TILES);

    BVXI_TRY(bvxi_bins_open(job->ctx, refine_name, &start->surface));
    BVXI_TRY(touch_start(job->ctx, start, BVXI_TOUCH_SET, 0.2, job->start < tree->levels ? 0.6 : 0.95));

    /* Where the start is the last level the bits are the answer, and no lists are needed. */
    if (job->start < tree->levels) BVXI_TRY(make_start_lists(job, start));
    bvxi_drop(job->ctx, start->surface.bins.id);
    for (int32_t l = job->start - 1; l >= 0; l--) {
        coarsen_job c = {job->tree, job->grids.words[l + 1], NULL, l};
        uint64_t const rows = (uint64_t)(job->tree->base[1] << l) * (uint64_t)(job->tree->base[2] << l);
        BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, bvxi_refine_grid_words(job->tree, l) * 8,
                            "a coarser grid", &job->grids.words[l]));
        c.coarse = job->grids.words[l];
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.95, 1.0,
                            bvxi_for(job->ctx, "refine", rows, COARSEN_GRAIN, coarsen_rows, &c)));
    }
    return make_first_front(job);
}

/* Ranks in the grid's order of the front's voxels. */
bvx_status bvxi_refine_lists(bvxi_refine_job *job)
{
    const bvx_octree *const tree = job->tree;
    uint64_t const words = bvxi_refine_grid_words(tree, job->start);
    bvxi_octets ranked = {0};
    uint64_t const row = (uint64_t)bvxi_refine_row_words(tree, job->start) * BVXI_WORD_BITS;
    uint64_t const ny = (uint64_t)tree->base[1] << job->start;

    /* the front is in the grid's order */
    if (job->start == 0 && tree->root.split == tree->root.touched) return BVX_OK;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, words * 4, "the start's ranks", &ranked.before));
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->front.count * 4, "the start's ranks", &job->front.slot));

    /* The ranks of an octree's level serve for a grid too: both are bits in words. */
    ranked.split = job->grids.words[job->start];
    ranked.words = words;
    bvxi_octets_count(&ranked);
    for (uint64_t n = 0; n < job->front.count; n++) {
        const int32_t *const v = job->front.ijk + 3 * n;
        job->front.slot[n] = bvxi_octets_rank(&ranked,
                                              ((uint64_t)v[2] * ny + (uint64_t)v[1]) * row + (uint64_t)v[0]);
    }
    bvxi_drop(job->ctx, ranked.before);
    return BVX_OK;
}

void bvxi_refine_free_grids(bvxi_refine_job *job)
{
    for (int32_t l = 0; l <= job->start; l++) {
        bvxi_drop(job->ctx, job->grids.words[l]);
        job->grids.words[l] = NULL;
    }
}
