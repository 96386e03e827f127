/* components.c - connected components of a grid by union-find over runs of voxels, 64 voxels at a time; then
 * the runs one by one, each with the index of its component.
 *
 * A component's index follows from its first voxel only, so neither threads nor the order of unions show.
 * Components of set voxels and spaces of empty ones (room.h) are found alike. */
#include "components/room.h"

/* ---- Connected components of rows of voxels by union-find over runs, the pairs that touch found 64
 * voxels at a time ---- */

/* Source: Rosenfeld, Pfaltz. Sequential Operations in Digital Picture Processing. 1966, on runs; Rem's union
 * with splicing (Dijkstra. A Discipline of Programming. 1976; Patwary, Blair, Manne. Experiments on
 * Union-Find Algorithms. 2010); leaving out pairs that others imply: Wu, Otoo, Suzuki. Optimizing Two-pass
 * Connected-component Labeling Algorithms. 2009.
 *
 * Runs are numbered in the order of their voxels, so a component's first run holds its least voxel: the root
 * of each tree is its least run, and numbering the roots as they come is the canonical numbering. The number
 * of a voxel's run is a rank: the runs before its word, and those that begin in the word up to its bit.
 *
 * A row looks back at the rows that can hold neighbours: the one below in y (A) and the three below in z (B,
 * and C and D beside it). Of all pairs of touching voxels only those are joined that say something new: the
 * first of a stretch, and across an edge or corner only where no straight pair joins the same runs. A pair
 * with a voxel of A is left out where one of B touches both, a pair with C where one of A or B does, and with
 * D where one of B does: these rows came before and are joined already. Two slices of words and ranks are all
 * that is kept beside the forest. */

bvx_status bvxi_components_open(bvx_context *ctx, const char *function, int32_t connectivity,
                                const int32_t size[3], uint64_t run_count, bvxi_components *c)
{
    memset(c, 0, sizeof *c);
    c->ctx = ctx;
    /* Numbers of runs are 32 bits, with the last one kept free. */
    if (run_count >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the voxels lie in %u runs along x; fewer than 2^32 - 1 are possible",
                             function, run_count);
    c->connectivity = connectivity;
    c->row_words = bvxi_row_words(size[0]);

    /* A word of zeros before and after each row, and a row before and after each slice: so no tests. */
    c->stride = (uint64_t)c->row_words + 2;
    c->slice = c->stride * ((uint64_t)size[1] + 2); /* below 2^45 */
    BVXI_TRY(BVXI_ARRAY(ctx, run_count, "the components' labels", c->label));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, c->slice * 16, "the components' rows", &c->words));
    return bvxi_alloc_zero(ctx, BVXI_SCRATCH, c->slice * 8, "the ranks of the components' rows", &c->before);
}

static void free_component_rows(bvxi_components *c)
{
    bvxi_drop(c->ctx, c->words);
    bvxi_drop(c->ctx, c->before);
    c->words = NULL;
    c->before = NULL;
}

void bvxi_components_free(bvxi_components *c)
{
    if (c->ctx == NULL) return;
    free_component_rows(c);
    bvxi_drop(c->ctx, c->label);
    memset(c, 0, sizeof *c);
}

/* ---- The forest: a run's parent is no later run ---- */

static inline void unite_components(uint32_t *parent, uint32_t i, uint32_t j)
{
    uint32_t a = parent[i], b = parent[j];

    /* Both ways up are taken in steps, and each step hangs a run under an earlier parent: Rem's splicing. */
    while (a != b) {
        if (a > b) {
            parent[i] = b;
            if (i == a) return;
            i = a;
            a = parent[i];
        } else {
            parent[j] = a;
            if (j == b) return;
            j = b;
            b = parent[j];
        }
    }
}

/* A word of a row with what lies beside its bits: bit i of low is voxel i - 1, of high voxel i + 1. */
typedef struct component_word {
    uint64_t here, low, high;
} component_word;

static inline component_word component_word_at(const uint64_t *row, int32_t k)
{
    component_word w;
    w.here = row[k];
    w.low = row[k] << 1 | row[k - 1] >> 63;
    w.high = row[k] >> 1 | row[k + 1] << 63;
    return w;
}

static inline uint64_t component_word_reach(component_word w)
{
    return w.here | w.low | w.high;
}

/* A row to look back at, and the one that looks, at their word k. */
typedef struct component_row {
    const uint64_t *words;
    const uint32_t *before; /* runs that begin before each word */
} component_row;

/* Bits of the row's word to be joined with the voxel there or before it, and with the one after. */
typedef struct component_pairs {
    uint64_t back, ahead;
} component_pairs;

BVXI_VECTOR_INLINE void join_component_pairs(uint32_t *parent, component_pairs pairs, component_word r,
                                             uint32_t r_before, component_word n, uint32_t n_before, int fast)
{
    /* A bit's run is the runs before the word and those that begin up to the bit. */
    uint64_t const r_starts = r.here & ~r.low, n_starts = n.here & ~n.low;
    for (; pairs.back != 0; pairs.back &= pairs.back - 1) {
        uint64_t const up_to = pairs.back ^ (pairs.back - 1); /* the lowest bit and all below */
        unite_components(parent, r_before + bvxi_count_bits(r_starts & up_to, fast) - 1,
                         n_before + bvxi_count_bits(n_starts & up_to, fast) - 1);
    }
    for (; pairs.ahead != 0; pairs.ahead &= pairs.ahead - 1) { /* the voxel ahead begins a run */
        uint64_t const up_to = pairs.ahead ^ (pairs.ahead - 1);
        unite_components(parent, r_before + bvxi_count_bits(r_starts & up_to, fast) - 1,
                         n_before + bvxi_count_bits(n_starts & up_to, fast));
    }
}

/* Pairs across faces, and the diagonal ones beside them; straight, low, high: implied by another row. */
BVXI_VECTOR_INLINE component_pairs straight_component_pairs(component_word r, component_word n,
                                                            uint64_t straight)
{
    component_pairs p;
    p.back = r.here & n.here & ~(r.low & n.low) & ~straight;
    p.ahead = 0;
    return p;
}

BVXI_VECTOR_INLINE component_pairs all_component_pairs(component_word r, component_word n, uint64_t straight,
                                                       uint64_t low, uint64_t high)
{
    component_pairs p = straight_component_pairs(r, n, straight);
    p.back |= r.here & n.low & ~r.low & ~n.here & ~low;
    p.ahead = r.here & n.high & ~r.high & ~n.here & ~high;
    return p;
}

BVXI_VECTOR_INLINE void join_component_word(uint32_t *parent, component_row row,
                                            const component_row behind[4], int32_t k, int32_t connectivity,
                                            int fast)
{
    component_word const r = component_word_at(row.words, k);
    component_word const a = component_word_at(behind[0].words, k), b = component_word_at(behind[1].words, k);
    component_pairs of_a, of_b, of_c, of_d;

    if (connectivity == BVXI_CONNECT_6) {
        of_a = straight_component_pairs(r, a, 0);
        of_b = straight_component_pairs(r, b, 0);
        if ((of_a.back | of_b.back) == 0) return;
        join_component_pairs(parent, of_b, r, row.before[k], b, behind[1].before[k], fast);
        join_component_pairs(parent, of_a, r, row.before[k], a, behind[0].before[k], fast);
        return;
    }
    component_word const c = component_word_at(behind[2].words, k), d = component_word_at(behind[3].words, k);
    /* What B touches was joined with it already, so pairs with the others are left out there. */
    uint64_t const by_b = component_word_reach(b), by_ab = by_b | component_word_reach(a);
    of_b = all_component_pairs(r, b, 0, 0, 0);
    if (connectivity == BVXI_CONNECT_26) {
        uint64_t const low_b = b.here | b.low, high_b = b.here | b.high;
        of_a = all_component_pairs(r, a, by_b, low_b, high_b);
        of_c = all_component_pairs(r, c, by_ab, low_b | a.here | a.low, high_b | a.here | a.high);
        of_d = all_component_pairs(r, d, by_b, low_b, high_b);
    } else {
        of_a = all_component_pairs(r, a, b.here, b.low, b.high);
        of_c = straight_component_pairs(r, c, by_ab);
        of_d = straight_component_pairs(r, d, by_b);
    }
    join_component_pairs(parent, of_b, r, row.before[k], b, behind[1].before[k], fast);
    join_component_pairs(parent, of_a, r, row.before[k], a, behind[0].before[k], fast);
    join_component_pairs(parent, of_c, r, row.before[k], c, behind[2].before[k], fast);
    join_component_pairs(parent, of_d, r, row.before[k], d, behind[3].before[k], fast);
}

BVXI_VECTOR_INLINE uint64_t rank_component_row(bvxi_components *c, const uint64_t *words, uint32_t *before,
                                               int fast)
{
    uint64_t n = c->added, any = 0;
    /* Runs are numbered where they begin: a set bit after one that is not set. */
    for (int32_t k = 0; k < c->row_words; k++) {
        before[k] = (uint32_t)n;
        n += bvxi_count_bits(words[k] & ~(words[k] << 1 | words[k - 1] >> 63), fast);
        any |= words[k];
    }
    for (uint64_t i = c->added; i < n; i++) c->label[i] = (uint32_t)i;
    c->added = n;
    return any;
}

BVXI_VECTOR_INLINE void join_component_row(bvxi_components *c, int32_t y, int32_t z, int32_t connectivity,
                                           int fast)
{
    /* Two slices take turns: this one and the one before. */
    size_t const above = (size_t)c->stride;
    size_t const now = (z & 1) != 0 ? (size_t)c->slice : 0;
    size_t const earlier = (z & 1) != 0 ? 0 : (size_t)c->slice;
    size_t const at = ((size_t)y + 1) * above + 1;
    uint64_t *const words = c->words;
    uint32_t *const before = c->before;
    component_row const row = {words + now + at, before + now + at};
    component_row const behind[4] = {{row.words - above, row.before - above},
                                     {words + earlier + at, before + earlier + at},
                                     {words + earlier + at - above, before + earlier + at - above},
                                     {words + earlier + at + above, before + earlier + at + above}};

    if (rank_component_row(c, row.words, before + now + at, fast) == 0) return;
    for (int32_t k = 0; k < c->row_words; k++)
        if (row.words[k] != 0) join_component_word(c->label, row, behind, k, connectivity, fast);
}

BVXI_VECTOR_INLINE void join_component_row_by(bvxi_components *c, int32_t y, int32_t z, int fast)
{
    if (c->connectivity == BVXI_CONNECT_6) join_component_row(c, y, z, BVXI_CONNECT_6, fast);
    else if (c->connectivity == BVXI_CONNECT_18) join_component_row(c, y, z, BVXI_CONNECT_18, fast);
    else join_component_row(c, y, z, BVXI_CONNECT_26, fast);
}

BVXI_AVX2_COPY(join_component_row_avx2, (bvxi_components * c, int32_t y, int32_t z),
               join_component_row_by(c, y, z, 1))

uint64_t *bvxi_components_row(bvxi_components *c, int32_t y, int32_t z)
{
    return c->words + ((z & 1) != 0 ? (size_t)c->slice : 0) + ((size_t)y + 1) * (size_t)c->stride + 1;
}

void bvxi_components_add(bvxi_components *c, int32_t y, int32_t z)
{
    BVXI_PATH(bvxi_cpu(c->ctx) == BVX_CPU_AVX2, join_component_row_by(c, y, z, 0),
              join_component_row_avx2(c, y, z));
}

void bvxi_components_number(bvxi_components *c)
{
    uint32_t *const label = c->label;
    uint32_t next = 0;
    for (uint64_t i = 0; i < c->added; i++) { /* a parent is an earlier run, whose label is final by now */
        uint32_t const parent = label[i], of_parent = label[parent];
        label[i] = parent == i ? next : of_parent;
        next += parent == i;
    }
    c->component_count = next;
    free_component_rows(c);
}

/* ---- Runs of empty or set voxels joined to spaces (components.c), and handed out again with their
 * numbers ---- */

bvx_status bvxi_spaces_open(bvx_context *ctx, const char *function, const char *stage, const bvx_grid *grid,
                            int32_t empty, int32_t connectivity, bvxi_spaces *spaces)
{
    memset(spaces, 0, sizeof *spaces);
    /* The number of runs is known before, so the forest is made in its exact size. */
    uint64_t const rows = bvxi_grid_rows(grid);
    uint64_t n = 0;

    for (uint64_t r = 0; r < rows; r++) {
        const uint64_t *const row = grid->words + (size_t)r * (size_t)grid->words_per_row;
        uint64_t last = 0;
        /* Empty voxels are set ones of the inverted word, without what lies past the row. */
        for (int32_t k = 0; k < grid->words_per_row; k++) {
            uint64_t w = empty ? ~row[k] : row[k];
            if (k + 1 == grid->words_per_row) w &= bvxi_tail_mask(grid->size[0]);
            n += bvxi_popcount(bvxi_run_changes(w, &last) & w);
        }
    }
    BVXI_TRY(bvxi_components_open(ctx, function, connectivity, grid->size, n, &spaces->parts));
    spaces->grid = grid;
    spaces->stage = stage;
    spaces->empty = empty;

    const bvx_grid *const g = spaces->grid;
    int32_t const step = (g->size[2] + 7) / 8, words = g->words_per_row;
    uint64_t const flip = spaces->empty ? ~UINT64_C(0) : 0, tail = bvxi_tail_mask(g->size[0]);
    const uint64_t *from = g->words;

    for (int32_t z = 0; z < g->size[2]; z++) {
        /* Eight calls of progress over the grid, as a slice may be small. */
        if (z % step == 0) BVXI_TRY(bvxi_progress(ctx, spaces->stage, (double)z / (double)g->size[2]));
        for (int32_t y = 0; y < g->size[1]; y++, from += words) {
            uint64_t *const row = bvxi_components_row(&spaces->parts, y, z);
            /* The row is made where the components want it: no inverted grid is needed. */
            for (int32_t k = 0; k < words; k++) row[k] = from[k] ^ flip;
            row[words - 1] &= tail;
            bvxi_components_add(&spaces->parts, y, z);
        }
    }
    bvxi_components_number(&spaces->parts);
    spaces->count = spaces->parts.component_count;
    return BVX_OK;
}

void bvxi_spaces_each(const bvxi_spaces *spaces, bvxi_spaces_fn *take, void *user)
{
    const bvx_grid *const g = spaces->grid;
    const uint32_t *label = spaces->parts.label;
    /* The same runs in the same order as they were joined, so labels go along with them. */
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            size_t const row = (size_t)z * (size_t)g->size[1] + (size_t)y;
            bvxi_row_runs runs;
            int32_t begin, end;
            bvxi_row_runs_start(&runs, g->words + row * (size_t)g->words_per_row, g->size[0], spaces->empty);
            while (bvxi_row_runs_next(&runs, &begin, &end)) take(user, *label++, begin, end, y, z);
        }
}

void bvxi_spaces_free(bvxi_spaces *spaces)
{
    bvxi_components_free(&spaces->parts);
    memset(spaces, 0, sizeof *spaces);
}

typedef struct spaces_sizes {
    const bvx_grid *grid;
    uint64_t *voxels;
    uint8_t *at_side;
} spaces_sizes;

static void measure_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const spaces_sizes *const s = user;
    s->voxels[space] += (uint64_t)(end - begin);
    if (s->at_side != NULL && bvxi_spaces_at_side(s->grid, begin, end, y, z)) s->at_side[space] = 1;
}

void bvxi_spaces_measure(const bvxi_spaces *spaces, uint64_t *voxels, uint8_t *at_side)
{
    spaces_sizes s = {spaces->grid, voxels, at_side};
    bvxi_spaces_each(spaces, measure_space_run, &s);
}

typedef struct spaces_flip {
    const bvx_grid *grid;
    const uint8_t *marked;
    uint64_t *words;
} spaces_flip;

static void flip_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const spaces_flip *const f = user;
    uint64_t *const row = f->words +
                          ((size_t)z * (size_t)f->grid->size[1] + (size_t)y) * (size_t)f->grid->words_per_row;
    /* The run is cut into words; a flip turns empty voxels to set ones and back. */
    if (!f->marked[space]) return;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) row[k] ^= bvxi_run_mask(begin, end, k);
}

void bvxi_spaces_flip(const bvxi_spaces *spaces, const uint8_t *marked, uint64_t *words)
{
    spaces_flip f = {spaces->grid, marked, words};
    bvxi_spaces_each(spaces, flip_space_run, &f);
}

bvx_status bvxi_check_connectivity(bvx_context *ctx, const char *function, int32_t connectivity)
{
    if (connectivity == BVXI_CONNECT_6 || connectivity == BVXI_CONNECT_18 || connectivity == BVXI_CONNECT_26)
        return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: connectivity is %d, not 6, 18 or 26",
                         function, (int64_t)connectivity);
}
