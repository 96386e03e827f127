/* solid_rows.c - rows filled from their sorted crossings.
 *
 * Every row under the rule nonzero, and those rows under parity whose crossings do not balance.
 * Guarantee: a row's bits follow from its crossings over the whole line, in no order of triangles, and a
 * window sees the same row as the whole lattice does. */
#include "solid/solid.h"
#include "bits/sort.h"

/* Fill [from, to) of lattice indices, as far as the window goes. */
static void fill_span(const bvxi_solid_job *job, uint64_t *row, int32_t from, int32_t to)
{
    int32_t const low = job->grid->low[0], size = job->grid->size[0];
    int32_t const begin = from - low < 0 ? 0 : from - low;
    int32_t const end = to - low > size ? size : to - low;
    if (begin < end) bvxi_set_run(row, begin, end);
}

/* c >> 1 floors: the crossing's index; c & 1: it leaves. */
static inline int32_t crossing_at(int32_t c)
{
    return bvxi_floor_shift(c, 1);
}

/* An odd number of crossings: drop the one without which least is filled, the later of equals. */
static uint32_t drop_for_parity(const int32_t *c, uint32_t n)
{
    int64_t filled = 0, least;
    uint32_t drop = 0;

    /* All choices in one pass: moving the dropped one by two exchanges a filled span for the gap before
     * it. */
    for (uint32_t i = 1; i + 1 < n; i += 2) filled += (int64_t)crossing_at(c[i + 1]) - crossing_at(c[i]);
    least = filled; /* without the first crossing */
    for (uint32_t i = 2; i < n; i += 2) {
        filled += (int64_t)crossing_at(c[i - 1]) - crossing_at(c[i - 2]);
        filled -= (int64_t)crossing_at(c[i]) - crossing_at(c[i - 1]);
        if (filled <= least) {
            least = filled;
            drop = i;
        }
    }
    return drop;
}

/* Drop the unmatched crossings of a row whose signed sum is not zero: leaving
 * ones that no entering one precedes, from the left, or entering ones that no
 * leaving one follows, from the right; as many as the sum requires. */
static uint32_t drop_for_winding(int32_t *c, uint32_t n, int64_t sum)
{
    uint32_t kept = 0;
    int64_t depth = 0, drop = sum < 0 ? -sum : sum;

    /* Too many leave: from the left, those that leave when nothing has been entered. */
    if (sum < 0) {
        for (uint32_t i = 0; i < n; i++) {
            int const leaving = c[i] & 1;
            if (leaving && depth == 0 && drop > 0) drop--;
            else {
                depth += leaving ? (depth > 0 ? -1 : 0) : 1;
                c[kept++] = c[i];
            }
        }
        return kept;
    }

    /* Too many enter: the same seen from the right, kept ones gathered at the end and moved down after. */
    kept = n;
    for (uint32_t i = n; i-- > 0;) {
        int const leaving = c[i] & 1;
        if (!leaving && depth == 0 && drop > 0) drop--;
        else {
            depth += leaving ? 1 : (depth > 0 ? -1 : 0);
            c[--kept] = c[i];
        }
    }
    for (uint32_t i = kept; i < n; i++) c[i - kept] = c[i];
    return n - kept;
}

static uint64_t fill_nonzero(const bvxi_solid_job *job, uint64_t *row, int32_t *c, uint32_t n)
{
    int64_t sum = 0, winding = 0;
    uint32_t kept = n;

    for (uint32_t i = 0; i < n; i++) sum += (c[i] & 1) != 0 ? -1 : 1;
    if (sum != 0) kept = drop_for_winding(c, n, sum);

    /* A span goes on until as many have left as came in. */
    for (uint32_t i = 0, from = 0; i < kept; i++) {
        if (winding == 0) from = i;
        winding += (c[i] & 1) != 0 ? -1 : 1;
        if (winding == 0) fill_span(job, row, crossing_at(c[from]), crossing_at(c[i]));
    }
    return n - kept;
}

/* After filling, row_end[row] is the end of the row's list and the list begins where the previous row's
 * ends. */
static void solve_rows(void *user, int32_t tile)
{
    bvxi_solid_job *const job = user;
    bvxi_rows const r = bvxi_tiles_rows(&job->tiles, tile);
    size_t const row_bytes = (size_t)job->grid->words_per_row * 8;
    uint64_t unbalanced = 0, crossings = 0;

    for (int32_t k = r.k0; k < r.k1; k++) {
        for (int32_t j = r.j0; j < r.j1; j++) {
            uint64_t const row = bvxi_block_row(job, j, k);
            uint64_t const begin = row == 0 ? 0 : job->lists.row_end[row - 1];
            uint32_t const n = (uint32_t)(job->lists.row_end[row] - begin);
            uint64_t *const words = bvxi_block_words(job, j, k);
            /* Balanced rows have their bits already. */
            if (job->listed != NULL && !job->listed[row]) continue;
            memset(words, 0, row_bytes);
            if (n == 0) continue;

            bvxi_sort_i32(job->lists.crossing + begin, n);
            int32_t *const c = job->lists.crossing + begin;
            crossings += n;
            if (job->fill != BVX_FILL_PARITY) {
                unbalanced += fill_nonzero(job, words, c, n) != 0;
                continue;
            }
            /* Rows are listed under parity when their crossings are odd in number. */
            for (uint32_t i = drop_for_parity(c, n); i + 1 < n; i++) c[i] = c[i + 1];
            for (uint32_t i = 0; i + 1 < n; i += 2)
                fill_span(job, words, crossing_at(c[i]), crossing_at(c[i + 1]));
        }
    }
    if (job->fill == BVX_FILL_NONZERO) { /* parity has counted its rows and crossings before */
        job->unbalanced[tile] += unbalanced;
        job->crossings[tile] += crossings;
    }
}

void bvxi_row_lists_free(bvx_context *ctx, bvxi_row_lists *lists)
{
    bvxi_drop(ctx, lists->crossing);
    bvxi_drop(ctx, lists->row_end);
    memset(lists, 0, sizeof *lists);
}

bvx_status bvxi_solid_gather(bvx_context *ctx, bvxi_solid_job *job, double from, double to,
                             bvxi_row_lists *made)
{
    bvxi_row_lists *const lists = &job->lists;
    double const middle = 0.5 * (from + to);

    memset(lists, 0, sizeof *lists);
    lists->rows = (uint64_t)job->block.ny * (uint64_t)job->block.nz;

    /* Counted first, then filled: one array of the exact size, whatever rows the crossings fall on. */
    BVXI_TRY(BVXI_ZEROS(ctx, lists->rows, "the rows' crossing counts", lists->row_end));
    BVXI_TRY(bvxi_solid_rounds(ctx, job, BVXI_COUNT_LIST, from, middle));
    /* counts become begins; filling turns them into ends */
    for (uint64_t row = 0; row < lists->rows; row++) {
        uint64_t const n = lists->row_end[row];
        lists->row_end[row] = lists->total;
        lists->total += n;
    }
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, lists->total * 4, "the crossings", &lists->crossing));
    BVXI_TRY(bvxi_solid_again(ctx, job, BVXI_FILL_LIST, middle, to));
    *made = *lists;
    return BVX_OK;
}

bvx_status bvxi_solid_lists(bvx_context *ctx, bvxi_solid_job *job, double from)
{
    bvxi_row_lists lists;
    BVXI_TRY(bvxi_solid_gather(ctx, job, from, 0.95, &lists));
    bvx_status const status = bvxi_each(ctx, "solid", bvxi_solid_progress(job, 0.95),
                                        bvxi_solid_progress(job, 1.0), job->tiles.count, solve_rows, job);
    bvxi_row_lists_free(ctx, &lists);
    return status;
}
