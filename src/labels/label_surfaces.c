/* label_surfaces.c - the faces between the labels of a volume as one complex: bvx_label_surfaces.
 *
 * Source: Gibson. Constrained Elastic Surface Nets. 1998 (a vertex in each cell, a face across each edge).
 *
 * Idea: whether neighbouring voxels differ is a bit an edge, so cells without a face are passed by 64 at a time.
 * A slice's bits are made from rows of samples when the cells beneath need them, and kept for two slices. A first
 * pass counts vertices and faces of each row of cells, prefix sums give every row its place, a second pass writes;
 * a face looks for the vertices of its other three cells in what the last two slices have numbered.
 * A layer of background lies around the window, so voxel (i,j,k) here is (i-1,j-1,k-1) of the window.
 * Guarantee: canonical order, whatever the threads. The order of labels shows in which vertices are joined only where
 * two of them alternate around a side. */
#include "bits/bits.h"
#include "labels/labels.h"
#include "mesh/mesh.h"
#include "simplify/room.h"
#include "surface/march.h"
#include "volume/room.h"

static const char surfaces_name[] = "bvx_label_surfaces";

enum { SLICE_GRAIN = 16, POSITION_GRAIN = 4096, RANKS_BY_TABLE = 1 << 20 };

static const bvxi_option labels_rows[] = {
    BVXI_SWITCH(bvx_labels_options, staircase),
    BVXI_CHOICE(bvx_labels_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_SWITCH(bvx_labels_options, local_frame),
    BVXI_SWITCH(bvx_labels_options, open),
    BVXI_REAL(bvx_labels_options, error, 0.0, BVXI_FINITE),
};

typedef struct cell_row {
    uint32_t vertex, face, flap; /* counts, then first indices */
} cell_row;

typedef struct cell_pattern {
    uint16_t first; /* of its splits, whose index counts in threes by the sides with four edges */
    uint8_t fours;
} cell_pattern;

typedef struct label_work {
    bvx_context *ctx;
    const bvx_volume_view *volume;
    int64_t stride[3];
    bvx_labels_options options;
    uint64_t background;
    uint32_t sample;        /* bytes */
    int32_t n[3];           /* cells */
    int32_t words;          /* of a row of edges */
    const uint8_t *outside; /* a row of background */
    cell_pattern *patterns;
    bvxi_cell_split *splits; /* of a pattern by what leads through each of its sides with four edges */
    uint32_t *rank_table;    /* of a value less the lowest, or NULL */
    uint64_t rank_low, rank_size;
    cell_row *rows; /* [Size: n[1] * n[2] + 1] */
    uint64_t row_count;
    uint8_t *scratch; /* of each worker */
    uint64_t scratch_bytes;
    int32_t pieces, emit;
    bvx_complex *made;
    bvxi_net net;
} label_work;

/* One worker's slices of edges: of voxels k & 1, and between the two. */
typedef struct label_scan {
    const label_work *w;
    uint8_t *line[3];      /* rows of samples */
    uint64_t *x[2], *y[2]; /* [Size: (n[1] + 1) * words] each */
    uint64_t *z;
    uint32_t *first[2]; /* of cells with vertices, the first one */
    uint16_t *split[2]; /* index of each */
} label_scan;

/* ---- Rows of samples, and where they differ ---- */

#define DEFINE_DIFFER(type)                                                                    \
    static void differ_##type(const void *first, const void *second, int32_t n, uint64_t *out) \
    {                                                                                          \
        const type *const a = first, *const b = second;                                        \
        for (int32_t i = 0; i < n; i += 64) {                                                  \
            int32_t const m = n - i < 64 ? n - i : 64;                                         \
            uint8_t flags[64] = {0};                                                           \
            /* Mostly nothing differs, which comparing bytes finds at once. */                 \
            if (memcmp(a + i, b + i, (size_t)m * sizeof *a) == 0) {                            \
                out[i / 64] = 0;                                                               \
                continue;                                                                      \
            }                                                                                  \
            for (int32_t t = 0; t < m; t++) flags[t] = a[i + t] != b[i + t];                   \
            out[i / 64] = bvxi_flags_to_word(flags);                                           \
        }                                                                                      \
    }
DEFINE_DIFFER(uint8_t)
DEFINE_DIFFER(uint16_t)
DEFINE_DIFFER(uint32_t)
DEFINE_DIFFER(uint64_t)

static void differ_rows(const label_work *w, const uint8_t *a, const uint8_t *b, int32_t n, uint64_t *out)
{
    switch (w->sample) {
    case 1: differ_uint8_t(a, b, n, out); break;
    case 2: differ_uint16_t(a, b, n, out); break;
    case 4: differ_uint32_t(a, b, n, out); break;
    default: differ_uint64_t(a, b, n, out); break;
    }
}

static const uint8_t *label_sample(const label_work *w, int32_t i, int32_t j, int32_t k)
{
    return (const uint8_t *)w->volume->samples +
           (ptrdiff_t)((i - 1) * w->stride[0] + (j - 1) * w->stride[1] + (k - 1) * w->stride[2]);
}

static int is_outside(const label_work *w, int32_t j, int32_t k)
{
    return j < 1 || k < 1 || j >= w->n[1] || k >= w->n[2];
}

/* A row with a voxel of background at either end; line has them already. */
static const uint8_t *load_line(const label_work *w, int32_t j, int32_t k, uint8_t *line)
{
    size_t const size = w->sample;
    size_t const count = (size_t)w->volume->size[0];

    if (is_outside(w, j, k)) return w->outside;
    const uint8_t *p = label_sample(w, 1, j, k);
    if (w->stride[0] == (int64_t)size) memcpy(line + size, p, count * size);
    else
        for (size_t i = 1; i <= count; i++, p += (ptrdiff_t)w->stride[0]) memcpy(line + i * size, p, size);
    return line;
}

/* The edges of slice k of voxels, and with between those from slice k - 1 to it. */
static void scan_slice(label_scan *s, int32_t k, int between)
{
    const label_work *const w = s->w;
    size_t const words = (size_t)w->words;
    const uint8_t *last = w->outside;

    for (int32_t j = 0; j <= w->n[1]; j++) {
        const uint8_t *const row = load_line(w, j, k, s->line[j & 1]);
        uint64_t *const x = s->x[k & 1] + (size_t)j * words;

        /* Bits from the last cell on belong to no edge along x. */
        x[words - 1] = 0;
        differ_rows(w, row, row + w->sample, w->n[0], x);
        if (j > 0) differ_rows(w, last, row, w->n[0] + 1, s->y[k & 1] + (size_t)(j - 1) * words);
        if (between)
            differ_rows(w, load_line(w, j, k - 1, s->line[2]), row, w->n[0] + 1, s->z + (size_t)j * words);
        last = row;
    }
}

/* ---- Labels by rank ---- */

static uint64_t ordered(const label_work *w, uint64_t value)
{
    return w->volume->sample_type % 2 == 0 ? value ^ UINT64_C(1) << 63 : value;
}

static uint64_t listed_label(const label_work *w, uint64_t index)
{
    return ordered(w, (uint64_t)w->made->labels[index].value);
}

static uint32_t rank_at(const label_work *w, int32_t i, int32_t j, int32_t k)
{
    uint64_t value, low = 0, high = w->made->label_count;

    if (is_outside(w, j, k) || i < 1 || i >= w->n[0]) return (uint32_t)high;
    value = bvxi_whole_sample(label_sample(w, i, j, k), w->volume->sample_type);
    if (value == w->background) return (uint32_t)high;
    value = ordered(w, value);
    if (w->rank_table != NULL) return w->rank_table[value - w->rank_low];
    while (high - low > 1) {
        uint64_t const middle = (low + high) / 2;
        if (listed_label(w, middle) <= value) low = middle;
        else high = middle;
    }
    return (uint32_t)low;
}

/* Values that lie close together have a table. */
static bvx_status make_ranks(label_work *w)
{
    uint64_t const count = w->made->label_count;

    if (count == 0) return BVX_OK;
    w->rank_low = listed_label(w, 0);
    w->rank_size = listed_label(w, count - 1) - w->rank_low;
    if (w->rank_size >= RANKS_BY_TABLE) return BVX_OK;
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_SCRATCH, (w->rank_size + 1) * 4, "the labels' ranks", &w->rank_table));
    for (uint64_t i = 0; i < count; i++) w->rank_table[listed_label(w, i) - w->rank_low] = (uint32_t)i;
    return BVX_OK;
}

/* ---- Cells ---- */

/* Whether the window has vertices in cell i along an axis, or faces across edges from voxel i. */
static int is_own(const label_work *w, int32_t axis, int32_t i, int faces)
{
    uint64_t const first = w->net.first[axis] << faces;
    return (uint64_t)i >= first && (uint64_t)i <= w->net.last[axis];
}

/* Bits of a word for which that holds along x, none of a row for which it does not. */
static uint64_t own_word(const label_work *w, int32_t j, int32_t k, int32_t word, int faces)
{
    int64_t const low = (int64_t)(w->net.first[0] << faces) - 64 * (int64_t)word;
    int64_t const high = (int64_t)w->net.last[0] - 64 * (int64_t)word;

    if (!w->options.open) return UINT64_MAX;
    if (!is_own(w, 1, j, faces) || !is_own(w, 2, k, faces) || high < 0 || low > 63) return 0;
    uint64_t const bits = high > 62 ? UINT64_MAX : (UINT64_C(2) << high) - 1;
    return low > 0 ? bits & UINT64_MAX << low : bits;
}

/* A flap is of the window that has both vertices beyond, or of the higher one where both windows do. */
static int is_own_flap(const label_work *w, const int32_t c[3], const bvxi_cell_flap *flap)
{
    int32_t const axis = 3 - (flap->side[0] >> 1) - (flap->side[1] >> 1);
    int own = (uint64_t)c[axis] < w->net.last[axis];

    for (int n = 0; n < 2; n++) {
        int32_t const a = flap->side[n] >> 1;
        own &= (uint64_t)c[a] != ((flap->side[n] & 1) != 0 ? w->net.last[a] : w->net.first[a]);
    }
    return own || !w->options.open;
}

/* A word of a row of cells: its edges as in a pattern; which cells have vertices. */
static uint64_t cell_word(const label_scan *s, int32_t j, int32_t k, int32_t word, uint64_t edge[12])
{
    size_t const words = (size_t)s->w->words, at = (size_t)j * words + (size_t)word;
    int const more = word + 1 < s->w->words;
    uint64_t any = 0;

    for (int32_t n = 0; n < 2; n++) {
        const uint64_t *const x = s->x[(k + n) & 1] + at, *const y = s->y[(k + n) & 1] + at;
        const uint64_t *const z = s->z + at + (size_t)n * words;

        edge[2 * n] = x[0];
        edge[2 * n + 1] = x[words];
        edge[4 + 2 * n] = y[0];
        edge[5 + 2 * n] = y[0] >> 1 | (more ? y[1] << 63 : 0);
        edge[8 + 2 * n] = z[0];
        edge[9 + 2 * n] = z[0] >> 1 | (more ? z[1] << 63 : 0);
        any |= edge[2 * n] | edge[2 * n + 1] | edge[4 + 2 * n] | edge[5 + 2 * n] | edge[8 + 2 * n] |
               edge[9 + 2 * n];
    }
    return any & own_word(s->w, j, k, word, 0);
}

static uint32_t pattern_at(const uint64_t edge[12], int32_t bit)
{
    uint32_t pattern = 0;
    for (int32_t e = 0; e < 12; e++) pattern |= (uint32_t)(edge[e] >> bit & 1) << e;
    return pattern;
}

static uint32_t split_at(const label_work *w, const uint64_t edge[12], const int32_t c[3])
{
    const cell_pattern *const pattern = &w->patterns[pattern_at(edge, c[0] & 63)];
    uint32_t index = 0;

    if (pattern->fours == 0 || w->options.staircase) return pattern->first;
    for (int32_t side = 5; side >= 0; side--) {
        int32_t const a = side >> 1, u = a == 0, v = a == 2 ? 1 : 2;
        uint32_t rank[4];

        if ((pattern->fours >> side & 1) == 0) continue;
        for (int32_t n = 0; n < 4; n++) {
            int32_t p[3] = {c[0], c[1], c[2]};
            p[a] += side & 1;
            p[u] += n & 1;
            p[v] += n >> 1;
            rank[n] = rank_at(w, p[0], p[1], p[2]);
        }
        /* What leads through a side of a cell; a label that is higher where two could. */
        int const same = rank[0] == rank[3] && (rank[1] != rank[2] || rank[0] > rank[1]);
        index = 3 * index + (uint32_t)(same                 ? BVXI_ACROSS_SAME
                                       : rank[1] == rank[2] ? BVXI_ACROSS_MIXED
                                                            : BVXI_ACROSS_NONE);
    }
    return pattern->first + index;
}

static bvx_status make_splits(label_work *w)
{
    uint32_t next = 0;

    BVXI_TRY(BVXI_ARRAY(w->ctx, BVXI_PATTERNS, "the patterns", w->patterns));
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_SCRATCH, BVXI_SPLITS * sizeof *w->splits, "the splits", &w->splits));
    for (uint32_t p = 0; p < BVXI_PATTERNS; p++) {
        uint32_t const fours = bvxi_four_sides(p);
        uint32_t count = fours != UINT32_MAX;

        w->patterns[p].first = (uint16_t)next;
        w->patterns[p].fours = (uint8_t)fours;
        for (int32_t side = 0; count != 0 && side < 6; side++)
            if ((fours >> side & 1) != 0) count *= 3;
        for (uint32_t i = 0; i < count; i++) {
            uint8_t across[6] = {0};
            uint32_t rest = i;
            for (int32_t side = 0; side < 6; side++)
                if ((fours >> side & 1) != 0) {
                    across[side] = (uint8_t)(rest % 3);
                    rest /= 3;
                }
            bvxi_split_pattern(p, across, &w->splits[next++]);
        }
    }
    return BVX_OK;
}

static void count_cell_row(const label_scan *s, int32_t j, int32_t k, cell_row *row)
{
    uint64_t edge[12];

    row->vertex = row->face = row->flap = 0;
    for (int32_t word = 0; word < s->w->words; word++) {
        uint64_t any = cell_word(s, j, k, word, edge);
        uint64_t const faces = own_word(s->w, j, k, word, 1);
        /* A face belongs to the cell of its edge's low end. */
        for (int a = 0; a < 3; a++) row->face += bvxi_popcount(edge[4 * a] & faces);
        for (; any != 0; any &= any - 1) {
            int32_t const c[3] = {64 * word + bvxi_lowest(any), j, k};
            const bvxi_cell_split *const split = &s->w->splits[split_at(s->w, edge, c)];
            row->vertex += split->count;
            for (int f = 0; f < split->flaps; f++)
                row->flap += (uint32_t)is_own_flap(s->w, c, &split->flap[f]);
        }
    }
}

/* ---- Vertices and faces ---- */

static size_t cell_index(const label_work *w, int32_t i, int32_t j)
{
    return (size_t)j * (size_t)w->n[0] + (size_t)i;
}

/* Low sides of a new cell: whoever has an edge through it is linked with the cell beyond. */
static void link_cell(label_scan *s, const int32_t c[3], uint32_t pattern, uint32_t first,
                      const bvxi_cell_split *split)
{
    static const uint32_t low_side[3] = {0x550, 0x305, 0x033}; /* edges in it */
    const label_work *const w = s->w;

    for (int32_t a = 0; a < 3; a++) {
        size_t const at = cell_index(w, c[0] - (a == 0), c[1] - (a == 1));
        int const slice = (c[2] - (a == 2)) & 1;

        if ((uint64_t)c[a] == w->net.first[a]) continue;
        for (uint32_t low = pattern & low_side[a]; low != 0; low &= low - 1) {
            int32_t const edge = bvxi_lowest(low);

            /* The same edge is on the high side of the cell before, its offset along the axis 1. */
            int32_t const other_edge = edge + ((edge >> 2 == 0 ? 1 : 0) == a ? 1 : 2);
            const bvxi_cell_split *const other = &w->splits[s->split[slice][at]];
            uint32_t const first_other = s->first[slice][at];
            uint32_t const own = first + split->base[edge], beyond = first_other + other->base[other_edge];
            uint32_t const own_new = first + split->of[edge], other_new = first_other + other->of[other_edge];

            /* Flaps take the new vertex beyond a low side, the old one beyond a high side, so that they agree. */
            bvxi_net_set_link(&w->net, own_new, 2 * a, other_new);
            bvxi_net_set_link(&w->net, other_new, 2 * a + 1, own);
            bvxi_net_set_link(&w->net, own, 2 * a, beyond);
            bvxi_net_set_link(&w->net, beyond, 2 * a + 1, own);
            /* Fewer edges than four are all joined. */
            if ((pattern & low_side[a]) != low_side[a] && split->flaps + other->flaps == 0) break;
        }
    }
}

/* The labels at the ends of an edge from voxel c, the lower first: 1 where that is at the low end. */
static int put_sides(const label_work *w, const int32_t c[3], int32_t axis, uint64_t face)
{
    uint32_t *const sides = w->made->sides + 2 * (size_t)face;
    uint32_t const low = rank_at(w, c[0], c[1], c[2]);
    uint32_t const high = rank_at(w, c[0] + (axis == 0), c[1] + (axis == 1), c[2] + (axis == 2));
    int const forward = low < high;

    sides[0] = forward ? low : high;
    sides[1] = forward ? high : low;
    return forward;
}

/* A flap without the vertices beyond sides, which stand in their place. */
static void open_flap(const label_work *w, const int32_t c[3], uint32_t first, const bvxi_cell_split *split,
                      const bvxi_cell_flap *flap, uint64_t face)
{
    uint32_t *const t = w->made->mesh.triangles + 6 * (size_t)face;
    int32_t const axis = flap->edge >> 2;
    int32_t low[3];

    for (int32_t a = 0; a < 3; a++) low[a] = c[a] + (a != axis && bvxi_edge_offset(flap->edge, a));
    int const forward = put_sides(w, low, axis, face);
    t[0] = t[3] = first + flap->vertex;
    t[2] = t[4] = first + split->base[flap->edge];
    t[1] = flap->side[!forward];
    t[5] = flap->side[forward];
}

/* Vertices in seams: in the planes of these, with others in the middle. Only those inside faces in the plane have all
 * their faces in one window. */
static void put_seams(const label_work *w, const int32_t c[3], uint32_t pattern, uint32_t first,
                      const bvxi_cell_split *split)
{
    static const uint16_t flat[8] = {0, 0x00f, 0x0f0, 0, 0xf00, 0, 0, 0};
    uint64_t const cell[3] = {(uint64_t)c[0], (uint64_t)c[1], (uint64_t)c[2]};
    uint32_t const seams = bvxi_net_seams(&w->net, cell);

    for (uint32_t v = 0; seams != 0 && v < split->count; v++) {
        w->made->junctions[first + v] |= pattern == flat[seams] ? BVX_AT_SEAM : BVX_AT_SEAM | BVX_ON_SEAM;
        for (uint32_t a = 0; w->net.offset != NULL && a < 3; a++) {
            int16_t *const o = &w->net.offset[3 * (size_t)(first + v) + a];
            int32_t const most = split->count > 1 || (seams >> a & 1) != 0 ? 0 : BVXI_SEAM_LIMIT;
            *o = (int16_t)(*o > most ? most : *o < -most ? -most : *o);
        }
    }
}

/* A flap beside them may be another window's. */
static void close_seams(const label_work *w)
{
    bvx_complex *const c = w->made;
    for (uint64_t v = 0; w->options.open && v < c->mesh.vertex_count; v++)
        for (int32_t side = 0; side < 6 && c->junctions[v] == BVX_AT_SEAM; side++) {
            uint32_t const link = bvxi_net_link(&w->net, v, side);
            if (link != UINT32_MAX && bvxi_shares_cell(c, link)) c->junctions[v] |= BVX_ON_SEAM;
        }
}

/* Vertices of cells of one row, numbered; written where they are the piece's own. */
static void put_vertices(label_scan *s, int32_t j, int32_t k, int own)
{
    const label_work *const w = s->w;
    cell_row const row = w->rows[(size_t)k * (size_t)w->n[1] + (size_t)j];
    uint32_t next = row.vertex, flap = row.flap;
    uint64_t edge[12];

    for (int32_t word = 0; word < w->words; word++) {
        uint64_t any = cell_word(s, j, k, word, edge);
        for (; any != 0; any &= any - 1) {
            int32_t const bit = bvxi_lowest(any), c[3] = {64 * word + bit, j, k};
            uint32_t const index = split_at(w, edge, c);
            const bvxi_cell_split *const split = &w->splits[index];
            size_t const at = cell_index(w, c[0], j);

            s->first[k & 1][at] = next;
            s->split[k & 1][at] = (uint16_t)index;
            for (uint32_t v = 0; own && v < split->count; v++) {
                w->made->cells[next + v] = (uint64_t)k * (uint64_t)w->n[0] * (uint64_t)w->n[1] + at;
                w->made->junctions[next + v] = split->junction[v];
                if (w->net.offset != NULL)
                    memcpy(w->net.offset + 3 * (size_t)(next + v), split->start[v], sizeof split->start[v]);
            }
            if (own && w->options.open) put_seams(w, c, pattern_at(edge, bit), next, split);
            for (uint32_t f = 0; own && f < split->flaps; f++)
                if (is_own_flap(w, c, &split->flap[f]))
                    open_flap(w, c, next, split, &split->flap[f], w->net.flaps + flap++);
            if (own && w->net.offset != NULL) link_cell(s, c, pattern_at(edge, bit), next, split);
            next += split->count;
        }
    }
}

/* The face across the edge from voxel c along an axis. */
static void put_face(const label_scan *s, const int32_t c[3], int32_t axis, uint32_t face)
{
    const label_work *const w = s->w;
    int32_t const u = (axis + 1) % 3, v = (axis + 2) % 3;
    uint32_t corner[4];

    /* Counter-clockwise about the axis. */
    for (int32_t n = 0; n < 4; n++) {
        int32_t const du = n == 1 || n == 2, dv = n >> 1;
        int32_t p[3] = {c[0], c[1], c[2]};
        p[u] -= du;
        p[v] -= dv;
        int32_t const first = u < v ? du : dv, second = u < v ? dv : du;
        size_t const at = cell_index(w, p[0], p[1]);
        const bvxi_cell_split *const split = &w->splits[s->split[p[2] & 1][at]];
        corner[n] = s->first[p[2] & 1][at] + split->of[4 * axis + first + 2 * second];
    }

    uint32_t *const t = w->made->mesh.triangles + 6 * (size_t)face;
    int const forward = put_sides(w, c, axis, face);
    t[0] = t[3] = corner[0];
    t[1] = forward ? corner[1] : corner[3];
    t[2] = t[4] = corner[2];
    t[5] = forward ? corner[3] : corner[1];
}

static void put_faces(const label_scan *s, int32_t j, int32_t k)
{
    const label_work *const w = s->w;
    uint32_t face = w->rows[(size_t)k * (size_t)w->n[1] + (size_t)j].face;
    uint64_t edge[12];

    for (int32_t word = 0; word < w->words; word++) {
        (void)cell_word(s, j, k, word, edge);
        uint64_t any = (edge[0] | edge[4] | edge[8]) & own_word(w, j, k, word, 1);
        for (; any != 0; any &= any - 1) {
            int32_t const bit = bvxi_lowest(any), c[3] = {64 * word + bit, j, k};
            for (int32_t a = 0; a < 3; a++)
                if ((edge[4 * a] >> bit & 1) != 0) put_face(s, c, a, face++);
        }
    }
}

/* ---- The passes ---- */

static uint64_t round_up(uint64_t bytes)
{
    return (bytes + 63) / 64 * 64;
}

/* A worker's arrays in one block, or its size where the block is NULL. */
static uint64_t lay_out(const label_work *w, uint8_t *block, label_scan *s)
{
    uint64_t const line = round_up(((uint64_t)w->n[0] + 1) * w->sample);
    uint64_t const bits = round_up(((uint64_t)w->n[1] + 1) * (uint64_t)w->words * 8);
    uint64_t const cells = (uint64_t)w->n[0] * (uint64_t)w->n[1];
    uint64_t at = 0;

#define TAKE(type, bytes)                                \
    (type *)(void *)(block == NULL ? NULL : block + at); \
    at += (bytes)
    for (int n = 0; n < 3; n++) { s->line[n] = TAKE(uint8_t, line); }
    for (int n = 0; n < 2; n++) {
        s->x[n] = TAKE(uint64_t, bits);
        s->y[n] = TAKE(uint64_t, bits);
    }
    s->z = TAKE(uint64_t, bits);
    for (int n = 0; n < 2; n++) {
        s->first[n] = TAKE(uint32_t, round_up(cells * 4));
        s->split[n] = TAKE(uint16_t, round_up(cells * 2));
    }
#undef TAKE
    s->w = w;
    return at;
}

static void work_piece(void *user, int32_t piece, int32_t worker)
{
    label_work *const w = user;
    uint64_t begin, end;
    label_scan s;

    bvxi_piece((uint64_t)w->n[2], w->pieces, piece, &begin, &end);
    (void)lay_out(w, w->scratch + (size_t)worker * w->scratch_bytes, &s);
    /* Ends of lines are background, which loading leaves alone. */
    for (int n = 0; n < 3; n++) memcpy(s.line[n], w->outside, ((size_t)w->n[0] + 1) * w->sample);

    /* Faces reach the slice of cells before theirs. */
    int32_t const from = (int32_t)begin - (w->emit && begin > 0);
    scan_slice(&s, from, 0);
    for (int32_t k = from; k < (int32_t)end; k++) {
        scan_slice(&s, k + 1, 1);
        for (int32_t j = 0; j < w->n[1]; j++) {
            if (!w->emit) {
                count_cell_row(&s, j, k, &w->rows[(size_t)k * (size_t)w->n[1] + (size_t)j]);
                continue;
            }
            put_vertices(&s, j, k, k >= (int32_t)begin);
            if (k >= (int32_t)begin) put_faces(&s, j, k);
        }
    }
}

static bvx_status place_rows(label_work *w, uint64_t *vertices, uint64_t *faces)
{
    uint64_t flaps = 0;

    *vertices = *faces = 0;
    for (uint64_t i = 0; i < w->row_count; i++) {
        cell_row const own = w->rows[i];
        w->rows[i].vertex = (uint32_t)*vertices;
        w->rows[i].face = (uint32_t)*faces;
        w->rows[i].flap = (uint32_t)flaps;
        *vertices += own.vertex;
        *faces += own.face;
        flaps += own.flap;
    }
    w->net.flaps = *faces;
    *faces += flaps;
    if (*vertices < UINT32_MAX && *faces < UINT32_C(1) << 30) return BVX_OK;
    return bvxi_fail_for(
        w->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
        "%s: the complex has %u vertices and %u faces; 2^32 - 2 and 2^30 - 1 are possible, take "
        "windows",
        surfaces_name, *vertices, *faces);
}

static void put_positions(void *user, uint64_t begin, uint64_t end)
{
    for (uint64_t v = begin; v < end; v++) bvxi_net_put(user, v);
}

static bvx_status open_complex(label_work *w, uint64_t vertices, uint64_t faces)
{
    bvx_complex *const c = w->made;
    bvx_context *const ctx = w->ctx;

    c->face_count = faces;
    BVXI_TRY(bvxi_mesh_open(ctx, surfaces_name, w->options.position_type, 0, vertices, 2 * faces, &c->mesh));
    if (w->options.local_frame) memcpy(c->mesh.frame, w->volume->lattice.origin, sizeof c->mesh.frame);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, faces * 8, "the faces' labels", &c->sides));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, vertices * 8, "the vertices' cells", &c->cells));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, vertices, "the junctions", &c->junctions));
    if (w->options.staircase) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertices * 6, "the vertices' offsets", &w->net.offset));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertices * 6, "the vertices' links", &w->net.above));
    w->net.beside = (uint8_t *)(w->net.above + vertices);
    /* Positions are written last. */
    w->net.links = c->mesh.positions;
    memset(w->net.beside, 0, (size_t)vertices * 2);
    memset(w->net.links, 0xff, (size_t)vertices * 12);
    memset(w->net.above, 0xff, (size_t)vertices * 4);
    return BVX_OK;
}

static bvx_status make_complex(label_work *w)
{
    bvx_context *const ctx = w->ctx;
    bvx_complex *const c = w->made;
    uint64_t vertices, faces, line = ((uint64_t)w->n[0] + 1) * w->sample;
    uint8_t *outside;
    label_scan unused;

    BVXI_TRY(BVXI_SHARE(
        ctx, 0.0, 0.2,
        bvxi_make_label_list(ctx, w->volume, w->stride, w->background, &c->labels, &c->label_count)));
    BVXI_TRY(make_ranks(w));

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, line, "a row of background", &outside));
    /* The low bytes, wherever the machine has them. */
    const uint8_t *const value = (const uint8_t *)&w->background +
                                 (bvxi_machine_is_big() ? 8 - w->sample : 0);
    for (uint64_t i = 0; i < line; i += w->sample) memcpy(outside + i, value, w->sample);
    w->outside = outside;
    BVXI_TRY(make_splits(w));
    w->row_count = (uint64_t)w->n[1] * (uint64_t)w->n[2];
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->row_count * sizeof *w->rows, "the rows of cells", &w->rows));
    w->scratch_bytes = lay_out(w, NULL, &unused);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->scratch_bytes * (uint64_t)bvxi_threads(ctx),
                        "slices of each thread", &w->scratch));
    w->pieces = bvxi_piece_count((uint64_t)w->n[2], SLICE_GRAIN);

    BVXI_TRY(bvxi_parallel(ctx, "count", 0.2, 0.4, w->pieces, work_piece, w));
    BVXI_TRY(place_rows(w, &vertices, &faces));
    BVXI_TRY(open_complex(w, vertices, faces));
    w->emit = 1;
    BVXI_TRY(bvxi_parallel(ctx, "faces", 0.4, 0.6, w->pieces, work_piece, w));
    bvxi_drop(ctx, w->scratch);
    for (uint64_t f = w->net.flaps; f < w->made->face_count; f++) {
        uint32_t *const t = w->made->mesh.triangles + 6 * (size_t)f;
        t[1] = bvxi_net_link(&w->net, t[0], (int32_t)t[1]);
        t[5] = bvxi_net_link(&w->net, t[0], (int32_t)t[5]);
    }
    w->net.complex = c;
    if (!w->options.staircase) {
        close_seams(w);
        BVXI_TRY(BVXI_SHARE(ctx, 0.6, 0.8, BVXI_SCOPE(ctx, bvxi_net_smooth(ctx, &w->net))));
    }
    BVXI_TRY(bvxi_for(ctx, "positions", vertices, POSITION_GRAIN, put_positions, &w->net));
    return w->options.staircase ? BVX_OK : BVXI_SHARE(ctx, 0.8, 1.0, bvxi_net_untangle(ctx, &w->net));
}

/* The complex, of fewer triangles where that is requested, and faces of each label, by counting. */
static bvx_status make_listed_complex(label_work *w)
{
    int const fewer = w->options.triangles != 0 || w->options.error > 0;
    bvx_complex *const c = w->made;
    double box[6];

    /* Between its seams a window keeps its vertices, so that triangles of no two windows cross. */
    for (uint32_t a = 0; a < 3; a++)
        for (uint32_t n = 0; n < 2; n++) {
            double const cell = (double)(n == 0 ? w->net.first[a] : w->net.last[a]);
            double const p = w->net.origin[a] + ((double)c->low[a] + cell) * w->net.spacing[a];
            box[2 * a + n] = !w->net.seam[2 * a + n]               ? (n == 0 ? -BVXI_FINITE : BVXI_FINITE)
                             : w->options.position_type == BVX_F32 ? (double)(float)p
                                                                   : p;
        }
    BVXI_TRY(BVXI_SHARE(w->ctx, 0.0, fewer ? 0.3 : 1.0, BVXI_SCOPE(w->ctx, make_complex(w))));
    if (fewer)
        BVXI_TRY(BVXI_SHARE(w->ctx, 0.3, 1.0,
                            bvxi_complex_simplify(w->ctx, surfaces_name, c, w->options.triangles,
                                                  w->options.error, w->options.open ? box : NULL)));

    uint64_t const labels = c->label_count;
    BVXI_TRY(bvxi_alloc_zero(w->ctx, BVXI_RESULT, (labels + 1) * 8, "the labels' faces", &c->first));
    for (uint64_t i = 0; i < 2 * c->face_count; i++)
        if (c->sides[i] < labels) c->first[c->sides[i]]++;
    uint64_t const count = bvxi_place_counts(c->first, labels + 1);
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_RESULT, count * 4, "the labels' faces", &c->faces));
    for (uint64_t i = 0; i < 2 * c->face_count; i++)
        if (c->sides[i] < labels) c->faces[c->first[c->sides[i]]++] = (uint32_t)(i / 2);
    /* Each begins where the one before has ended. */
    for (uint64_t i = labels; i > 0; i--) c->first[i] = c->first[i - 1];
    c->first[0] = 0;
    return BVX_OK;
}

static bvx_status check_label_options(label_work *w)
{
    bvx_context *const ctx = w->ctx;
    bvx_labels_options *const o = &w->options;
    bvx_grid shape = {.lattice = w->volume->lattice};

    BVXI_TRY(bvxi_check_options(ctx, surfaces_name, o, BVXI_OPTIONS(labels_rows)));
    if ((o->triangles != 0) + (o->error > 0) + (o->staircase != 0) > 1)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: staircase, triangles and error exclude each other; set one of them",
                             surfaces_name);
    if (w->volume->sample_type >= BVX_SAMPLE_F32)
        return bvxi_fail(ctx, BVX_ERR_UNSUPPORTED, "%s: the samples are floats; labels are whole numbers",
                         surfaces_name);
    w->sample = bvxi_type_size(w->volume->sample_type);
    w->background = (uint64_t)o->background;
    if (w->sample < 8) {
        int64_t const span = INT64_C(1) << (8 * w->sample);
        int64_t const low = w->volume->sample_type % 2 == 0 ? -span / 2 : 0;
        if (o->background < low || o->background >= low + span)
            return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: background is %d, samples are %d to %d",
                             surfaces_name, o->background, low, low + span - 1);
    }
    for (int a = 0; a < 3; a++) {
        w->made->low[a] = shape.low[a] = w->volume->low[a];
        w->made->size[a] = shape.size[a] = w->volume->size[a];
        w->n[a] = w->volume->size[a] + 1;
        w->net.seam[2 * a] = o->open && shape.low[a] > 0;
        w->net.seam[2 * a + 1] = o->open && shape.low[a] + shape.size[a] < w->volume->lattice.dims[a];
        w->net.first[a] = (uint64_t)w->net.seam[2 * a];
        w->net.last[a] = (uint64_t)(w->n[a] - 1 - w->net.seam[2 * a + 1]);
        w->net.spacing[a] = w->volume->lattice.spacing[a];
        w->net.origin[a] = o->local_frame ? 0.0 : w->volume->lattice.origin[a];
    }
    w->words = w->n[0] / 64 + 1;
    BVXI_TRY(bvxi_choose_position_type(ctx, surfaces_name, &shape, w->net.origin, &o->position_type));
    return o->position_type == BVX_F64 ? bvxi_check_f64(ctx, surfaces_name, &shape, w->net.origin) : BVX_OK;
}

static bvx_status run_label_surfaces(bvx_context *ctx, const bvx_volume_view *volume,
                                     const bvx_labels_options *options, bvx_complex *complex)
{
    bvx_complex made = {.owned = 1};
    label_work w = {.ctx = ctx, .volume = volume, .made = &made};

    if (complex == NULL) return bvxi_fail_null(ctx, surfaces_name, "complex");
    if (complex->owned != 1 && (complex->mesh.positions != NULL || complex->sides != NULL))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY, "%s: the complex brings arrays",
                             surfaces_name);
    BVXI_TRY(bvxi_take_options(ctx, surfaces_name, options, &w.options, sizeof w.options));
    BVXI_TRY(bvxi_volume_check(ctx, surfaces_name, volume, w.stride));
    BVXI_TRY(check_label_options(&w));
    bvx_status const status = make_listed_complex(&w);
    bvx_complex_free(ctx, status == BVX_OK ? complex : &made);
    if (status != BVX_OK) return status;
    *complex = made;
    return BVX_OK;
}

bvx_status bvx_label_surfaces(bvx_context *context, const bvx_volume_view *volume,
                              const bvx_labels_options *options, bvx_complex *complex)
{
    return BVXI_CALL(context, run_label_surfaces(context, volume, options, complex));
}

void bvx_complex_free(bvx_context *context, bvx_complex *complex)
{
    if (context == NULL || complex == NULL) return;
    /* What the caller brought is the caller's to free. */
    if (complex->owned == 1) {
        uint64_t const vertices = complex->mesh.vertex_count, labels = complex->label_count;
        bvxi_free(context, complex->faces, complex->faces == NULL ? 0 : complex->first[labels] * 4);
        bvxi_free(context, complex->first, (labels + 1) * 8);
        bvxi_free(context, complex->junctions, vertices);
        bvxi_free(context, complex->cells, vertices * 8);
        bvxi_free(context, complex->sides, complex->face_count * 8);
        bvxi_free(context, complex->labels, labels * sizeof *complex->labels);
        bvx_mesh_free(context, &complex->mesh);
    }
    memset(complex, 0, sizeof *complex);
}
