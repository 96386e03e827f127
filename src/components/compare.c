/* compare.c - two grids voxel by voxel: how many each has, where they differ, in how many pieces.
 *
 * One pass over the words counts, bounds and counts runs; its pieces are rows, as many as the shape requires,
 * and their sums are whole numbers, so threads never show. Then the runs of what only one grid has go through
 * union-find (components.c), and once more for the sizes of the pieces found. Where nothing differs the first
 * pass is all. */
#include "components/room.h"

enum { COMPARE_GRAIN = 2048 /* least words a piece */ };

typedef struct compare_sums {
    uint64_t set_a, set_b, both;
    uint64_t runs[2];        /* of what only a has, of what only b has */
    int32_t low[3], high[3]; /* voxels that differ; low above high when there is none */
} compare_sums;

typedef struct compare_work {
    const bvx_grid *grid[2];
    compare_sums *sums; /* [Size: pieces] */
    int32_t pieces;
} compare_work;

static void clear_compare_sums(const int32_t size[3], compare_sums *s)
{
    memset(s, 0, sizeof *s);
    /* Low at the size and high at -1 widen to the first voxel that comes. */
    for (int32_t i = 0; i < 3; i++) {
        s->low[i] = size[i];
        s->high[i] = -1;
    }
}

static void widen_compare_box(compare_sums *s, const int32_t low[3], const int32_t high[3])
{
    for (int32_t i = 0; i < 3; i++) {
        s->low[i] = low[i] < s->low[i] ? low[i] : s->low[i];
        s->high[i] = high[i] > s->high[i] ? high[i] : s->high[i];
    }
}

/* set_a and set_b hold what only one has until both is added in the end. */
static void compare_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const compare_work *const w = user;
    const bvx_grid *const a = w->grid[0], *const b = w->grid[1];
    uint64_t const ny = (uint64_t)a->size[1];
    compare_sums s;
    clear_compare_sums(a->size, &s);
    /* A row belongs to one piece, so the sums of pieces add up to those of the grids. */
    for (uint64_t r = begin; r < end; r++) {
        size_t const at = (size_t)(r * (uint64_t)a->words_per_row);
        int32_t low[3] = {-1, (int32_t)(r % ny), (int32_t)(r / ny)}, high[3] = {-1, low[1], low[2]};
        uint64_t last_a = 0, last_b = 0;

        for (int32_t k = 0; k < a->words_per_row; k++) {
            uint64_t const one = a->words[at + (size_t)k], other = b->words[at + (size_t)k];
            uint64_t const differ = one ^ other, only_a = one & differ, only_b = other & differ;
            s.both += bvxi_popcount(one & other);
            if (differ == 0) {
                last_a = last_b = 0;
                continue;
            }
            s.set_a += bvxi_popcount(only_a);
            s.set_b += bvxi_popcount(only_b);
            /* A run begins where membership changes and the voxel is set. */
            s.runs[0] += bvxi_popcount(bvxi_run_changes(only_a, &last_a) & only_a);
            s.runs[1] += bvxi_popcount(bvxi_run_changes(only_b, &last_b) & only_b);
            if (low[0] < 0) low[0] = k * BVXI_WORD_BITS + bvxi_lowest(differ);
            high[0] = k * BVXI_WORD_BITS + bvxi_highest(differ);
        }
        if (low[0] >= 0) widen_compare_box(&s, low, high);
    }
    w->sums[index] = s;
}

static bvx_status compare_words(bvx_context *ctx, compare_work *w, compare_sums *all)
{
    const bvx_grid *const a = w->grid[0];
    uint64_t const rows = bvxi_grid_rows(a), words = bvxi_grid_words(a);
    int32_t const pieces = bvxi_piece_count(words, COMPARE_GRAIN);
    w->pieces = (uint64_t)pieces > rows ? (int32_t)rows : pieces;
    uint64_t const bytes = (uint64_t)w->pieces * sizeof *w->sums;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the comparison's sums", &w->sums));
    BVXI_TRY(
        bvxi_for_pieces(ctx, "compare", 0.0, 0.5, w->pieces, bvxi_grid_rows(w->grid[0]), compare_piece, w));
    clear_compare_sums(w->grid[0]->size, all);
    for (int32_t i = 0; i < w->pieces; i++) {
        const compare_sums *const s = &w->sums[i];
        all->set_a += s->set_a;
        all->set_b += s->set_b;
        all->both += s->both;
        all->runs[0] += s->runs[0];
        all->runs[1] += s->runs[1];
        widen_compare_box(all, s->low, s->high);
    }
    return BVX_OK;
}

typedef void compare_run_fn(void *user, int32_t begin, int32_t end, int32_t y, int32_t z);

/* What one grid has and the other does not: within the box of the difference. */
typedef struct compare_side {
    const bvx_grid *one, *other;
    const compare_sums *all;
    double from, to;
} compare_side;

/* Row (y, z) begins at this word of both grids. */
static size_t compare_row_at(const compare_side *s, int32_t y, int32_t z)
{
    size_t const row = (size_t)z * (size_t)s->one->size[1] + (size_t)y;
    return row * (size_t)s->one->words_per_row;
}

static bvx_status compare_progress(bvx_context *ctx, const compare_side *s, int32_t z)
{
    int32_t const low = s->all->low[2], slices = s->all->high[2] - low + 1, step = (slices + 7) / 8;
    if ((z - low) % step != 0) return BVX_OK;
    return bvxi_progress(ctx, "compare", s->from + (s->to - s->from) * ((double)(z - low) / (double)slices));
}

static void visit_row_difference(const compare_side *s, int32_t y, int32_t z, compare_run_fn *take,
                                 void *user)
{
    const uint64_t *const one = s->one->words + compare_row_at(s, y, z);
    const uint64_t *const other = s->other->words + compare_row_at(s, y, z);
    uint64_t last = 0;
    int32_t begin = -1;

    for (int32_t k = 0; k < s->one->words_per_row; k++) {
        uint64_t changes = bvxi_run_changes(one[k] & ~other[k], &last);
        for (; changes != 0; changes &= changes - 1) {
            int32_t const x = k * BVXI_WORD_BITS + bvxi_lowest(changes);
            if (begin >= 0) take(user, begin, x, y, z);
            begin = begin >= 0 ? -1 : x;
        }
    }
    if (begin >= 0) take(user, begin, s->one->size[0], y, z);
}

typedef struct compare_sizes {
    const uint32_t *label; /* of the next run */
    uint64_t *size;        /* voxels of each component */
} compare_sizes;

static void measure_compare_run(void *user, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    compare_sizes *const s = user;
    (void)y, (void)z;
    s->size[*s->label++] += (uint64_t)(end - begin);
}

static bvx_status count_components(bvx_context *ctx, const char *function, const compare_work *w,
                                   const compare_sums *all, int32_t side, uint64_t *count, uint64_t *largest)
{
    const bvx_grid *const one = w->grid[side], *const other = w->grid[1 - side];
    double const from = side == 0 ? 0.5 : 0.75, middle = from + 0.15, to = from + 0.25;
    int32_t const box[3] = {one->size[0], all->high[1] - all->low[1] + 1, all->high[2] - all->low[2] + 1};
    compare_side const joined = {.one = one, .other = other, .all = all, .from = from, .to = middle};
    compare_side const measured = {.one = one, .other = other, .all = all, .from = middle, .to = to};
    bvxi_components c;

    if (all->runs[side] == 0) return BVX_OK;
    BVXI_TRY(bvxi_components_open(ctx, function, BVXI_CONNECT_6, box, all->runs[side], &c));

    for (int32_t z = all->low[2]; z <= all->high[2]; z++) {
        BVXI_TRY(compare_progress(ctx, &joined, z));
        for (int32_t y = all->low[1]; y <= all->high[1]; y++) {
            size_t const at = compare_row_at(&joined, y, z);
            uint64_t *const words = bvxi_components_row(&c, y - all->low[1], z - all->low[2]);
            for (int32_t k = 0; k < one->words_per_row; k++)
                words[k] = one->words[at + (size_t)k] & ~other->words[at + (size_t)k];
            bvxi_components_add(&c, y - all->low[1], z - all->low[2]);
        }
    }
    bvxi_components_number(&c);

    uint64_t const bytes = c.component_count * sizeof(uint64_t);
    compare_sizes s = {c.label, NULL};
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the components' sizes", &s.size));

    for (int32_t z = all->low[2]; z <= all->high[2]; z++) {
        BVXI_TRY(compare_progress(ctx, &measured, z));
        /* Only the box of the difference: what differs is small, as a rule. */
        for (int32_t y = all->low[1]; y <= all->high[1]; y++)
            visit_row_difference(&measured, y, z, measure_compare_run, &s);
    }

    for (uint64_t i = 0; i < c.component_count; i++) *largest = s.size[i] > *largest ? s.size[i] : *largest;
    *count = c.component_count;
    return BVX_OK;
}

static bvx_status run_grid_compare(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                   bvx_grid_difference *difference)
{
    static const char *const function = "bvx_grid_compare";
    compare_work w = {{a, b}, NULL, 0};
    bvx_grid_difference d = {0};
    compare_sums all;

    if (difference == NULL) return bvxi_fail_null(context, function, "difference");
    memset(difference, 0, sizeof *difference);
    /* The messages name which of the two grids is wrong. */
    BVXI_TRY(bvxi_grid_check(context, "bvx_grid_compare, grid a", a));
    BVXI_TRY(bvxi_grid_check(context, "bvx_grid_compare, grid b", b));
    BVXI_TRY(bvxi_grid_same(context, function, a, b));
    BVXI_TRY(BVXI_SCOPE(context, compare_words(context, &w, &all)));
    BVXI_TRY(BVXI_SCOPE(
        context, count_components(context, function, &w, &all, 0, &d.components_only_a, &d.largest_only_a)));
    BVXI_TRY(BVXI_SCOPE(
        context, count_components(context, function, &w, &all, 1, &d.components_only_b, &d.largest_only_b)));
    /* The pass has counted what only one has; with both it is the whole of each. */
    d.only_a = all.set_a;
    d.only_b = all.set_b;
    d.both = all.both;
    d.set_a = all.set_a + all.both;
    d.set_b = all.set_b + all.both;
    for (int32_t i = 0; i < 3 && all.high[0] >= 0; i++) {
        d.low[i] = all.low[i];
        d.size[i] = all.high[i] - all.low[i] + 1;
    }

    *difference = d;
    return BVX_OK;
}

bvx_status bvx_grid_compare(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                            bvx_grid_difference *difference)
{
    return BVXI_CALL(context, run_grid_compare(context, a, b, difference));
}
