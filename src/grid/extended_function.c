/* extended_function.c - the voxel function of a grid between its centres, and where it changes along edges
 * of a coarser lattice; also the positions and weights of the samples.
 *
 * Everything is rational with one denominator an axis, so no rounding moves a sample. Source at its heading
 * below. */
#include "grid/downsample.h"

enum { EXTENDED_GRAIN = 16 /* least rows of samples a piece */ };

/* ---- The samples' places and weights along each axis ---- */

/* All rational, so that no rounding moves a sample: in units of 1/(2r) of a voxel sample i stands at (2i + 1)
 * n from the grid's corner, which is (2i + 1) n - r from the first centre. Placing each sample in the middle
 * of its own stretch makes the samples' boxes tile the grid, so the model neither shifts nor shrinks. */

static int32_t *take_table(int32_t **from, int32_t count)
{
    int32_t *const t = *from;
    *from += count;
    return t;
}

static void fill_axis(bvxi_sample_axis *a, int32_t **memory)
{
    int64_t const n = a->n, r = a->r;

    a->at = take_table(memory, a->count);
    a->high_weight = take_table(memory, a->count);
    a->begin = take_table(memory, a->count);
    a->end = take_table(memory, a->count);
    a->first = take_table(memory, a->count);
    a->last = take_table(memory, a->count);

    for (int32_t i = 0; i < a->count; i++) {
        int64_t const centre = (2 * (int64_t)i + 1) * n - r; /* >= 0, as n >= r */
        int64_t const low = i * n, up = (i + (int64_t)1) * n;
        /* The voxel whose centre lies at or below the sample, and how far above it, in units of 1/(2r). */
        a->at[i] = (int32_t)(centre / (2 * r));
        a->high_weight[i] = (int32_t)(centre % (2 * r));
        a->begin[i] = (int32_t)(low / r);
        a->end[i] = (int32_t)((up + r - 1) / r);
        a->first[i] = (int32_t)((a->begin[i] + (int64_t)1) * r - low);
        a->last[i] = (int32_t)(up - (a->end[i] - (int64_t)1) * r);
        if (a->end[i] - a->begin[i] == 1) a->first[i] = (int32_t)n; /* n = r: the voxel is the box */
    }
}

static bvx_status open_coarse(bvx_context *ctx, const char *function, bvxi_downsample *d)
{
    const bvx_grid *const fine = d->fine;
    double origin[3], spacing[3];
    int32_t dims[3];
    bvx_lattice lattice;
    bvx_window window = {{0, 0, 0}, {0, 0, 0}};
    uint64_t *memory = NULL, words;

    for (int32_t a = 0; a < 3; a++) {
        /* One sample stands for n/r voxels, so its spacing is that much larger. */
        window.size[a] = d->axis[a].count;
        origin[a] = fine->lattice.origin[a] + (double)fine->low[a] * fine->lattice.spacing[a];
        spacing[a] = fine->lattice.spacing[a] * d->axis[a].n / d->axis[a].r;
        dims[a] = d->axis[a].count;
    }
    BVXI_TRY(bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    words = bvx_grid_bound(&lattice, NULL); /* of at most 2^20 a side, so 64 bits hold it */
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, words * 8, "the level's samples", &memory));
    d->coarse.words = memory; /* scratch, so that an arena keeps results without gaps */
    d->coarse.word_capacity = words;
    return bvxi_grid_open(ctx, function, &lattice, &window, &d->coarse);
}

bvx_status bvxi_downsample_open(bvx_context *ctx, const char *function, const bvx_grid *fine,
                                const bvxi_downsample_by *by, bvxi_downsample *d)
{
    const int32_t *const n = by->n, *const r = by->r;
    uint64_t entries = 0;

    memset(d, 0, sizeof *d);
    d->fine = fine;

    /* In 16 bits: a threshold that is a whole number can be compared exactly. */
    d->threshold = (int32_t)(by->threshold * 65536.0 + 0.5);
    if (d->threshold < 1) d->threshold = 1;
    if (d->threshold > 65535) d->threshold = 65535;
    d->edge_samples = by->edge_samples;
    d->cpu = bvxi_cpu(ctx);
    for (int32_t a = 0; a < 3; a++) {
        bvxi_sample_axis *const axis = &d->axis[a];
        if (n[a] > BVXI_DOWNSAMPLE_SIDE)
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                "%s: levels are made of grids up to %d voxels along an axis, this one has %d", function,
                (int64_t)BVXI_DOWNSAMPLE_SIDE, (int64_t)n[a]);
        axis->n = n[a];
        axis->r = r[a];
        axis->voxels = fine->size[a];
        /* Rounded up: the last box may reach beyond the grid, where all is empty. */
        axis->count = (int32_t)(((int64_t)fine->size[a] * r[a] + n[a] - 1) / n[a]);
        entries += (uint64_t)axis->count * 6;
    }

    d->table_bytes = entries * sizeof *d->tables;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, d->table_bytes, "the samples' places", &d->tables));
    int32_t *memory = d->tables;
    for (int32_t a = 0; a < 3; a++) fill_axis(&d->axis[a], &memory);
    d->pieces = bvxi_piece_count((uint64_t)d->axis[1].count * (uint64_t)d->axis[2].count, EXTENDED_GRAIN);
    return open_coarse(ctx, function, d);
}

/* ---- The extended voxel function: trilinear between voxel centres, compared with a threshold ---- */

/* Source: Lian. LOD by voxelization and downsampling (docs/papers.md, 3), sections 2.4.2 and 2.4.4 (VoxExt,
 * EdgeRatio), with two corrections: an edge's vertex sits inside the step in which the state changes, where a
 * line between the step's ends meets the threshold (the middle of the step would lie an eighth of a voxel
 * inside at whole ratios, where steps end exactly at the threshold), and samples stand in the middle of their
 * stretches.
 * Guarantee: weights are integers, sums are exact, every comparison is; each edge is walked once, from its
 * low end. */

/* The four fine rows around a sample row, and their weights in 1/(2r_y 2r_z). */
typedef struct sample_rows {
    const uint64_t *row[4];
    int64_t weight[4];
} sample_rows;

static inline int64_t sum_at(const sample_rows *s, int32_t i, int32_t voxels)
{
    int64_t sum = 0;
    for (int32_t r = 0; r < 4 && i >= 0 && i < voxels; r++)
        if (s->row[r] != NULL) sum += (int64_t)(s->row[r][i >> 6] >> (i & 63) & 1) * s->weight[r];
    return sum;
}

/* Of the voxels of word w and their right neighbours: is any set in any row, all in all? */
static void see_pairs(const sample_rows *s, int32_t w, int32_t words, uint64_t *any_pair, uint64_t *all_pair)
{
    uint64_t any = 0, all = ~UINT64_C(0), next_any = 0, next_all = ~UINT64_C(0);

    /* Only rows that count are looked at: the others may be anything. */
    for (int32_t r = 0; r < 4; r++) {
        uint64_t const here = s->row[r] != NULL && w < words ? s->row[r][w] : 0;
        uint64_t const next = s->row[r] != NULL && w + 1 < words ? s->row[r][w + 1] : 0;
        if (s->weight[r] == 0) continue;
        any |= here;
        all &= here;
        next_any |= next;
        next_all &= next;
    }
    /* Each voxel with its right neighbour, the next word giving that of the last bit. */
    *any_pair = any | any >> 1 | next_any << 63;
    *all_pair = all & (all >> 1 | next_all << 63);
}

static void sample_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_downsample *const d = user;

    for (uint64_t row = begin; row < end; row++) {
        /* Most samples lie between voxels that are all empty or all set; only the others are weighed. */
        int32_t const j = (int32_t)(row % (uint64_t)d->axis[1].count);
        int32_t const k = (int32_t)(row / (uint64_t)d->axis[1].count);
        const bvxi_sample_axis *const x = &d->axis[0];
        uint64_t *const out = d->coarse.words + ((uint64_t)k * (uint64_t)d->axis[1].count + (uint64_t)j) *
                                                    (uint64_t)d->coarse.words_per_row;
        int64_t const voxel = 2 * (int64_t)x->r; /* one, in units of 1/(2r) */
        uint64_t any = 0, all = 0;
        int32_t word = -1; /* that any and all are of */
        sample_rows s;

        const bvxi_sample_axis *const y = &d->axis[1], *const z = &d->axis[2];
        int64_t const high_y = y->high_weight[j], low_y = 2 * (int64_t)y->r - high_y;
        int64_t const high_z = z->high_weight[k], low_z = 2 * (int64_t)z->r - high_z;
        /* A row of weight 0 is not read: it may lie beyond the grid. */
        for (int32_t i = 0; i < 4; i++) {
            s.weight[i] = ((i & 1) != 0 ? high_y : low_y) * ((i >> 1) != 0 ? high_z : low_z);
            s.row[i] = s.weight[i] != 0 ? bvxi_fine_row(d, y->at[j] + (i & 1), z->at[k] + (i >> 1)) : NULL;
        }

        /* Four rows beyond the grid leave the samples as they are, 0. */
        if (s.row[0] == NULL && s.row[1] == NULL && s.row[2] == NULL && s.row[3] == NULL) continue;
        for (int32_t i = 0; i < x->count; i++) {
            int32_t const at = x->at[i];
            /* The words change every few samples only, so both answers are found for 64 voxels at a time. */
            if (at >> 6 != word) {
                word = at >> 6;
                see_pairs(&s, word, d->fine->words_per_row, &any, &all);
            }

            /* Without a set voxel around it the sample is 0, with all of them set it is 1: no sum is needed. */
            if ((any >> (at & 63) & 1) == 0) continue;
            uint64_t inside = all >> (at & 63) & 1;
            if (!inside) {
                int64_t const low = sum_at(&s, at, x->voxels), high = sum_at(&s, at + 1, x->voxels);
                inside = (uint64_t)(low * (voxel - x->high_weight[i]) + high * x->high_weight[i] > d->limit);
            }
            out[i >> 6] |= inside << (i & 63);
        }
    }
}

static int32_t edge_steps(const bvxi_downsample *d, int32_t axis)
{
    int32_t const n = d->axis[axis].n, r = d->axis[axis].r;
    /* voxels a sample: between centres the function is a line along the edge */
    int64_t const ratio_up = ((int64_t)n + r - 1) / r;
    return d->edge_samples != 0 ? d->edge_samples : ratio_up < 65536 ? (int32_t)ratio_up : 65536;
}

bvx_status bvxi_extended_sample(bvx_context *ctx, bvxi_downsample *d)
{
    uint64_t total = 1, most = 1;
    int fits = 1;

    /* The largest sum is the product of all weights; with an edge's steps it must fit 63 bits. */
    for (int32_t a = 0; a < 3; a++) {
        uint64_t const steps = (uint64_t)edge_steps(d, a);
        total = bvxi_mul(total, 2 * (uint64_t)d->axis[a].r, &fits);
        if (steps > most) most = steps;
    }
    if (!fits || total > INT64_MAX / 2 / most)
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
            "bvx_build_lods: %d x %d x %d samples with %u steps an edge need more than 63 bits; take fewer "
            "steps or coverage",
            (int64_t)d->axis[0].r, (int64_t)d->axis[1].r, (int64_t)d->axis[2].r, most);
    d->total = (int64_t)total;
    d->limit = bvxi_weight_limit(d->total, d->threshold);
    return bvxi_for_ranges(ctx, "lod", 0.0, 0.5, d->pieces,
                           (uint64_t)d->axis[1].count * (uint64_t)d->axis[2].count, sample_piece, d);
}

/* The four lines of voxels along an edge: each voxel at place i of the axis, weights bilinear. */
typedef struct edge_lines {
    const uint64_t *word[4]; /* of place 0, NULL where the line counts for nothing */
    int32_t shift[4];
    int64_t weight[4];
    int64_t stride; /* words from place to place; 0: the places are bits along x */
    int32_t voxels;
} edge_lines;

static void gather_lines(const bvxi_downsample *d, int32_t axis, const int32_t at[3], const int64_t high[3],
                         edge_lines *e)
{
    int32_t const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2; /* the other two axes */
    const bvx_grid *const g = d->fine;

    /* Places along x are bits of a word, along the other axes whole words apart. */
    e->voxels = g->size[axis];
    e->stride = axis == 0 ? 0 : axis == 1 ? g->words_per_row : (int64_t)g->words_per_row * g->size[1];
    for (int32_t n = 0; n < 4; n++) {
        int64_t const wu = (n & 1) != 0 ? high[u] : 2 * (int64_t)d->axis[u].r - high[u];
        int64_t const wv = (n >> 1) != 0 ? high[v] : 2 * (int64_t)d->axis[v].r - high[v];
        int32_t p[3];
        p[axis] = 0;
        p[u] = at[u] + (n & 1);
        p[v] = at[v] + (n >> 1);
        e->weight[n] = wu * wv;
        /* A line beyond the grid counts for nothing, as all is empty there. */
        e->word[n] = wu * wv != 0 && p[0] < g->size[0] ? bvxi_fine_row(d, p[1], p[2]) : NULL;
        e->shift[n] = p[0] & 63;
        if (e->word[n] != NULL) e->word[n] += p[0] >> 6;
    }
}

/* Weighted bits across the edge at voxel i along its axis. */
static inline int64_t sum_across(const edge_lines *e, int32_t i)
{
    int64_t sum = 0, step;
    if (i < 0 || i >= e->voxels) return 0;
    step = e->stride != 0 ? e->stride * i : i >> 6;
    for (int32_t n = 0; n < 4; n++)
        if (e->word[n] != NULL)
            sum += (int64_t)(e->word[n][step] >> (e->stride != 0 ? e->shift[n] : i & 63) & 1) * e->weight[n];
    return sum;
}

double bvxi_extended_ratio(const void *downsample, int32_t axis, int32_t i, int32_t j, int32_t k)
{
    const bvxi_downsample *const d = downsample;
    const bvxi_sample_axis *const a = &d->axis[axis];
    int32_t const steps = edge_steps(d, axis), sample[3] = {i, j, k};
    int64_t const unit = 2 * (int64_t)a->r * steps; /* one voxel */
    int64_t const total = d->total * steps, limit = bvxi_weight_limit(total, d->threshold);
    int64_t high[3], place, low_sum, high_sum, sum;
    int32_t at[3], voxel;
    edge_lines e;

    /* The edge begins at sample (i, j, k), which lies somewhere between two voxels of its line. A sample may be -1
     * or count, just outside. */
    for (int32_t b = 0; b < 3; b++) {
        /* A voxel, in units of 1/(2r). */
        int64_t const step = 2 * (int64_t)d->axis[b].r,
                      centre = (2 * (int64_t)sample[b] + 1) * d->axis[b].n - d->axis[b].r;
        /* Rounded down also below 0: the place may be outside the grid. */
        int64_t const down = centre >= 0 ? centre / step : -((step - 1 - centre) / step);
        at[b] = (int32_t)down;
        high[b] = centre - down * step;
    }
    gather_lines(d, axis, at, high, &e);
    voxel = at[axis];
    place = high[axis] * steps; /* from that voxel's centre */
    low_sum = sum_across(&e, voxel);
    high_sum = sum_across(&e, voxel + 1);
    sum = low_sum * (unit - place) + high_sum * place;
    int const start = sum > limit;
    for (int32_t s = 1; s <= steps; s++) {
        int64_t const before = sum;
        /* One step further may cross several voxels: only the last two of them count. */
        for (place += 2 * (int64_t)a->n; place >= unit; place -= unit) {
            voxel++;
            low_sum = high_sum;
            high_sum = sum_across(&e, voxel + 1);
        }
        sum = low_sum * (unit - place) + high_sum * place;

        /* The state changes within this step: a line between both sums meets the threshold there. */
        if ((sum > limit) != start)
            return ((double)(s - 1) +
                    ((double)total * d->threshold / 65536.0 - (double)before) / (double)(sum - before)) /
                   steps;
    }
    return 0.5; /* not reached: the ends differ */
}
