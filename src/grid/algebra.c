/* algebra.c - union, intersection, difference, xor and complement of grids, a word at a time.
 *
 * Every word of the result follows from the same word of the operands, so the result may be one of them.
 * Eight words are loaded before one is stored: compilers then use vectors without asking whether the arrays
 * overlap. Memory is what it costs. */
#include "grid/grid.h"

enum { ALGEBRA_COMPLEMENT = BVX_BOOLEAN_XOR + 1 };
enum { ALGEBRA_GRAIN = 8192 /* least words a piece */, ALGEBRA_BLOCK = 8 };

typedef struct algebra_job {
    const bvx_grid *a, *b; /* complement: b is a */
    bvx_grid *result;
    int32_t operation, cpu;
} algebra_job;

BVXI_VECTOR_INLINE uint64_t combine_word(uint64_t a, uint64_t b, int32_t operation)
{
    switch (operation) {
    case BVX_BOOLEAN_UNION: return a | b;
    case BVX_BOOLEAN_INTERSECTION: return a & b;
    case BVX_BOOLEAN_DIFFERENCE: return a & ~b;
    case BVX_BOOLEAN_XOR: return a ^ b;
    default: return ~a;
    }
}

BVXI_VECTOR_INLINE void combine_words(const uint64_t *a, const uint64_t *b, uint64_t *to, size_t n,
                                      int32_t operation)
{
    size_t i = 0;
    /* Eight loads before the first store: whether the arrays overlap does not matter to the compiler. */
    for (; i + ALGEBRA_BLOCK <= n; i += ALGEBRA_BLOCK) {
        uint64_t w[ALGEBRA_BLOCK];
        for (int32_t k = 0; k < ALGEBRA_BLOCK; k++)
            w[k] = combine_word(a[i + (size_t)k], b[i + (size_t)k], operation);
        memcpy(to + i, w, sizeof w);
    }
    for (; i < n; i++) to[i] = combine_word(a[i], b[i], operation);
}

/* One loop an operation, so that none asks which it is. */
BVXI_VECTOR_INLINE void combine_rows(const algebra_job *job, size_t from, size_t n)
{
    const uint64_t *const a = job->a->words + from, *const b = job->b->words + from;
    uint64_t *const to = job->result->words + from;
    switch (job->operation) {
    case BVX_BOOLEAN_UNION: combine_words(a, b, to, n, BVX_BOOLEAN_UNION); break;
    case BVX_BOOLEAN_INTERSECTION: combine_words(a, b, to, n, BVX_BOOLEAN_INTERSECTION); break;
    case BVX_BOOLEAN_DIFFERENCE: combine_words(a, b, to, n, BVX_BOOLEAN_DIFFERENCE); break;
    case BVX_BOOLEAN_XOR: combine_words(a, b, to, n, BVX_BOOLEAN_XOR); break;
    default: combine_words(a, a, to, n, ALGEBRA_COMPLEMENT); break;
    }
}

BVXI_AVX2_COPY(combine_rows_avx2, (const algebra_job *job, size_t from, size_t n), combine_rows(job, from, n))

static void combine_piece(void *user, uint64_t begin, uint64_t end)
{
    const algebra_job *const job = user;
    size_t const row = (size_t)job->a->words_per_row, from = (size_t)begin * row;
    size_t const words = (size_t)(end - begin) * row;
    uint64_t const tail = bvxi_tail_mask(job->a->size[0]);
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, combine_rows(job, from, words), combine_rows_avx2(job, from, words));
    /* Only the complement sets bits past the end of a row. */
    if (job->operation != ALGEBRA_COMPLEMENT || tail == ~UINT64_C(0)) return;
    for (uint64_t r = begin; r < end; r++) job->result->words[((size_t)r + 1) * row - 1] &= tail;
}

static bvx_status combine_grids(bvx_context *ctx, const char *function, const bvx_grid *a, const bvx_grid *b,
                                int32_t operation, bvx_grid *result)
{
    bvx_window window;

    if (result == NULL) return bvxi_fail_null(ctx, function, "result");
    BVXI_TRY(bvxi_grid_check(ctx, function, a));
    BVXI_TRY(bvxi_grid_check(ctx, function, b));

    /* An operand may be the result itself, word for word; only a shifted overlap is refused. */
    BVXI_TRY(bvxi_grid_same(ctx, function, a, b));
    BVXI_TRY(bvxi_grid_check_shift(ctx, function, a, result));
    BVXI_TRY(bvxi_grid_check_shift(ctx, function, b, result));

    /* A result that brought words keeps them after a failure; one that was made here is freed. */
    memcpy(window.low, a->low, sizeof window.low);
    memcpy(window.size, a->size, sizeof window.size);
    bvxi_grid_renew(ctx, &a->lattice, &window, result);
    int const made_here = result->words == NULL;
    BVXI_TRY(bvxi_grid_open(ctx, function, &a->lattice, &window, result));

    algebra_job job = {.a = a, .b = b, .result = result, .operation = operation, .cpu = bvxi_cpu(ctx)};

    /* A piece is whole rows, so that the end of each is cleared by who wrote it. */
    return bvxi_grid_made(ctx,
                          bvxi_for(ctx, "combine", bvxi_grid_rows(a),
                                   1 + ALGEBRA_GRAIN / (uint64_t)a->words_per_row, combine_piece, &job),
                          made_here, result);
}

static bvx_status run_grid_combine(bvx_context *context, const bvx_grid *a, const bvx_grid *b,
                                   int32_t operation, bvx_grid *result)
{
    static const char *const function = "bvx_grid_combine";
    if (operation < BVX_BOOLEAN_UNION || operation > BVX_BOOLEAN_XOR)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: operation %d is unknown",
                             function, (int64_t)operation);
    return combine_grids(context, function, a, b, operation, result);
}

bvx_status bvx_grid_combine(bvx_context *context, const bvx_grid *a, const bvx_grid *b, int32_t operation,
                            bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_combine(context, a, b, operation, result));
}

bvx_status bvx_grid_complement(bvx_context *context, const bvx_grid *grid, bvx_grid *result)
{
    return BVXI_CALL(context,
                     combine_grids(context, "bvx_grid_complement", grid, grid, ALGEBRA_COMPLEMENT, result));
}
