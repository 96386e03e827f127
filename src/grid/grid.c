/* grid.c - bit grids made, freed, counted and hashed, and the checks that every operation on grids begins
 * with.
 *
 * Guarantee: what bvxi_grid_check has passed can be read by words without further checks; words of two grids
 * are the same or apart. */
#include "grid/grid.h"
#include "core/hash.h"

/* ---- Bit grids made, freed, counted and hashed ---- */

uint64_t bvx_grid_bound(const bvx_lattice *lattice, const bvx_window *window)
{
    static const bvx_window none = {{0, 0, 0}, {0, 0, 0}};
    int ok = 1, whole;
    int32_t size[3];

    if (lattice == NULL) return 0;
    whole = window == NULL || memcmp(window, &none, sizeof none) == 0;
    for (int32_t a = 0; a < 3; a++) {
        size[a] = whole ? lattice->dims[a] : window->size[a];
        if (size[a] < 1 || size[a] > lattice->dims[a]) return 0;
        if (!whole && (window->low[a] < 0 || window->low[a] > lattice->dims[a] - size[a])) return 0;
    }

    /* 0 is the answer for what does not fit, as no grid has 0 words. */
    uint64_t rows = bvxi_mul((uint64_t)size[1], (uint64_t)size[2], &ok);
    rows = bvxi_mul(rows, (uint64_t)bvxi_row_words(size[0]), &ok);
    return ok && rows <= UINT64_MAX / 8 ? rows : 0;
}

void bvxi_grid_renew(bvx_context *ctx, const bvx_lattice *lattice, const bvx_window *window, bvx_grid *grid)
{
    if (grid->owned == 1 && grid->word_capacity < bvx_grid_bound(lattice, window)) bvx_grid_free(ctx, grid);
}

bvx_status bvxi_grid_open(bvx_context *ctx, const char *function, const bvx_lattice *lattice,
                          const bvx_window *window, bvx_grid *grid)
{
    uint64_t const words = bvx_grid_bound(lattice, window);
    bvx_grid g = *grid;

    /* The size is checked before the array: a message about words would name a number that wrapped around. */
    if (words == 0)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the grid's size does not fit 64 bits", function);
    if (g.words != NULL && g.word_capacity < words)
        return bvxi_fail(ctx, BVX_ERR_CAPACITY, "%s: the grid needs %u words, the array given holds %u",
                         function, words, g.word_capacity);
    /* Made only where the caller brought no words; then they are the library's to free. */
    if (g.words == NULL) {
        if (words > SIZE_MAX / 8)
            return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: a grid of %u words is beyond this machine's addresses",
                             function, words);
        BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, words * 8, "the grid", &g.words));
        g.word_capacity = words;
        g.owned = 1;
    }

    g.lattice = *lattice;
    memcpy(g.low, window->low, sizeof g.low);
    memcpy(g.size, window->size, sizeof g.size);
    g.words_per_row = bvxi_row_words(window->size[0]);
    memset(g.reserved, 0, sizeof g.reserved);
    *grid = g;
    return BVX_OK;
}

bvx_status bvx_grid_create(bvx_context *context, const bvx_lattice *lattice, const bvx_window *window,
                           bvx_grid *grid)
{
    bvx_window w;
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (grid == NULL) return bvxi_fail_null(context, "bvx_grid_create", "grid");
    BVXI_TRY(bvxi_lattice_check(context, "bvx_grid_create", lattice));
    BVXI_TRY(bvxi_window_take(context, "bvx_grid_create", lattice, window, &w));
    bvxi_grid_renew(context, lattice, &w, grid);
    bvx_status const status = bvxi_grid_open(context, "bvx_grid_create", lattice, &w, grid);
    if (status != BVX_OK) return bvxi_fail_in(context, "bvx_grid_create", status);
    memset(grid->words, 0, (size_t)bvxi_grid_words(grid) * 8);
    return BVX_OK;
}

void bvx_grid_free(bvx_context *context, bvx_grid *grid)
{
    if (context == NULL || grid == NULL) return;
    if (grid->owned) bvxi_free(context, grid->words, grid->word_capacity * 8);
    memset(grid, 0, sizeof *grid);
}

bvx_status bvxi_grid_check(bvx_context *ctx, const char *function, const bvx_grid *grid)
{
    bvx_window window, unused;

    if (grid == NULL) return bvxi_fail_null(ctx, function, "grid");
    if (grid->words == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL, "%s: the grid has no words", function);

    /* Fields of later versions must be 0, or this library would not do what the caller means. */
    for (uint64_t i = 0; i < 4; i++)
        if (grid->reserved[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED,
                                 "%s: grid.reserved[%u] must be 0", function, i);
    BVXI_TRY(bvxi_lattice_check(ctx, function, &grid->lattice));
    memcpy(window.low, grid->low, sizeof window.low);
    memcpy(window.size, grid->size, sizeof window.size);
    /* A size below 1 would make the window stand for the whole lattice. */
    if (grid->size[0] < 1)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the grid's size is %d along x", function,
                         (int64_t)grid->size[0]);
    BVXI_TRY(bvxi_window_take(ctx, function, &grid->lattice, &window, &unused));

    if (grid->words_per_row != bvxi_row_words(grid->size[0]))
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the grid has %d words per row, %d voxels need %d",
                         function, (int64_t)grid->words_per_row, (int64_t)grid->size[0],
                         (int64_t)bvxi_row_words(grid->size[0]));
    if (grid->word_capacity < bvx_grid_bound(&grid->lattice, &window))
        return bvxi_fail(ctx, BVX_ERR_CAPACITY, "%s: the grid's array holds %u words, its size needs %u",
                         function, grid->word_capacity, bvx_grid_bound(&grid->lattice, &window));
    return BVX_OK;
}

bvx_status bvxi_grid_fail_past(bvx_context *ctx, const char *function, const bvx_grid *grid)
{
    return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: the grid's words have bits set past the %d voxels of a row",
                     function, (int64_t)grid->size[0]);
}

bvx_status bvxi_grid_check_past(bvx_context *ctx, const char *function, const bvx_grid *grid)
{
    uint64_t const past = bvxi_grid_past(grid);
    uint64_t const words = bvxi_grid_words(grid);
    uint64_t const step = (uint64_t)grid->words_per_row;
    uint64_t set = 0;
    if (past == 0) return BVX_OK;
    /* One test at the end: the OR of all last words says whether any has such a bit. */
    for (uint64_t i = step - 1; i < words; i += step) set |= grid->words[i];
    return (set & past) == 0 ? BVX_OK : bvxi_grid_fail_past(ctx, function, grid);
}

BVXI_VECTOR_INLINE void count_words(const uint64_t *words, uint64_t count, uint64_t *set)
{
    uint64_t n = 0;
    for (uint64_t i = 0; i < count; i++) n += bvxi_popcount(words[i]);
    *set = n;
}

/* The processor's own count. */
BVXI_AVX2_COPY(count_words_avx2, (const uint64_t *words, uint64_t count, uint64_t *set),
               count_words(words, count, set))

static bvx_status run_grid_count(bvx_context *context, const bvx_grid *grid, uint64_t *count)
{
    uint64_t words;
    if (count == NULL) return bvxi_fail_null(context, "bvx_grid_count", "count");
    BVXI_TRY(bvxi_grid_check(context, "bvx_grid_count", grid));
    words = bvxi_grid_words(grid);
    BVXI_PATH(bvxi_cpu(context) == BVX_CPU_AVX2, count_words(grid->words, words, count),
              count_words_avx2(grid->words, words, count));
    return BVX_OK;
}

bvx_status bvx_grid_count(bvx_context *context, const bvx_grid *grid, uint64_t *count)
{
    return BVXI_CALL(context, run_grid_count(context, grid, count));
}

static bvx_status run_grid_hash(bvx_context *context, const bvx_grid *grid, uint64_t *hash)
{
    bvxi_hash h;

    if (hash == NULL) return bvxi_fail_null(context, "bvx_grid_hash", "hash");
    BVXI_TRY(bvxi_grid_check(context, "bvx_grid_hash", grid));

    /* The place is hashed first, then its hash is the seed of the words': two grids of equal bits differ. */
    bvxi_hash_start(&h, 0);
    bvxi_hash_i32(&h, grid->low, 3);
    bvxi_hash_i32(&h, grid->size, 3);
    bvxi_hash_i32(&h, grid->lattice.dims, 3);
    bvxi_hash_i32(&h, &grid->lattice.fraction_bits, 1);
    bvxi_hash_f64(&h, grid->lattice.origin, 3);
    bvxi_hash_f64(&h, grid->lattice.spacing, 3);
    bvxi_hash_start(&h, bvxi_hash_end(&h));
    bvxi_hash_u64(&h, grid->words, (size_t)bvxi_grid_words(grid));
    *hash = bvxi_hash_end(&h);
    return BVX_OK;
}

bvx_status bvx_grid_hash(bvx_context *context, const bvx_grid *grid, uint64_t *hash)
{
    return BVXI_CALL(context, run_grid_hash(context, grid, hash));
}

/* ---- What operations on grids ask before and after: of one lattice and window? another grid? filled to
 * the end? ---- */

static bvx_status fail_same(bvx_context *ctx, const char *function, const char *field, double a, double b)
{
    return bvxi_fail(ctx, BVX_ERR_LATTICE, "%s: the grids differ in %s, %g in a and %g in b", function, field,
                     a, b);
}

bvx_status bvxi_grid_same(bvx_context *ctx, const char *function, const bvx_grid *a, const bvx_grid *b)
{
    static const char *const names[5][3] = {
        {"the lattice's origin along x", "the lattice's origin along y", "the lattice's origin along z"},
        {"the lattice's spacing along x", "the lattice's spacing along y", "the lattice's spacing along z"},
        {"the lattice's dims along x", "the lattice's dims along y", "the lattice's dims along z"},
        {"the window's low along x", "the window's low along y", "the window's low along z"},
        {"the window's size along x", "the window's size along y", "the window's size along z"}};

    for (int32_t f = 0; f < 5; f++)
        for (int32_t i = 0; i < 3; i++) {
            double const of_a[5] = {a->lattice.origin[i], a->lattice.spacing[i], (double)a->lattice.dims[i],
                                    (double)a->low[i], (double)a->size[i]};
            double const of_b[5] = {b->lattice.origin[i], b->lattice.spacing[i], (double)b->lattice.dims[i],
                                    (double)b->low[i], (double)b->size[i]};
            if (of_a[f] != of_b[f]) return fail_same(ctx, function, names[f][i], of_a[f], of_b[f]);
        }
    if (a->lattice.fraction_bits != b->lattice.fraction_bits)
        return fail_same(ctx, function, "the lattice's fraction_bits", (double)a->lattice.fraction_bits,
                         (double)b->lattice.fraction_bits);
    return BVX_OK;
}

static uint64_t bytes_held(const bvx_grid *grid)
{
    return grid->word_capacity < UINT64_MAX / 8 ? grid->word_capacity * 8 : UINT64_MAX;
}

bvx_status bvxi_grid_apart(bvx_context *ctx, const char *function, const bvx_grid *grid,
                           const bvx_grid *result)
{
    /* Compared by memory, as two grids may share their words. */
    if (result == NULL) return bvxi_fail_null(ctx, function, "result");
    BVXI_TRY(bvxi_grid_check(ctx, function, grid));
    if (grid == result ||
        bvxi_overlap(grid->words, bvxi_grid_words(grid) * 8, result->words, bytes_held(result)))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                             "%s: the result's array holds words of the grid; it needs words of its own",
                             function);
    return BVX_OK;
}

bvx_status bvxi_grid_check_shift(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                 const bvx_grid *result)
{
    uint64_t const bytes = bvxi_grid_words(grid) * 8;
    uint64_t const held = bytes_held(result);
    /* A result too small for the grid is made anew, or refused: what lies after its words is not its own. */
    if (grid->words == result->words ||
        !bvxi_overlap(grid->words, bytes, result->words, held < bytes ? held : bytes))
        return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                         "%s: the result's words overlap the grid's without being the same", function);
}

bvx_status bvxi_grid_put(bvx_context *ctx, bvx_status status, bvx_grid *made, bvx_grid *result)
{
    if (status == BVX_OK) *result = *made;
    else if (result->words == NULL) bvx_grid_free(ctx, made);
    return status;
}

bvx_status bvxi_grid_made(bvx_context *ctx, bvx_status status, int mine, bvx_grid *result)
{
    if (status != BVX_OK && mine) bvx_grid_free(ctx, result);
    return status;
}
