/* hole_lines.c - open edges that cancel along a line though they do not end at the same vertices.
 *
 * Where a vertex of one triangle lies on the middle of another's side (a T-junction, as rectangles of merged
 * voxel faces have them) no edge has a partner, and yet nothing is open: the long edge is covered by short
 * ones that run the other way. So edges of one line are swept from its one end to the other, and what remains
 * is where more of them run one way than the other. A line on which nothing cancels keeps its edges.
 *
 * Lines are distinguished exactly: by their direction, divided by the greatest common divisor of its
 * components, and its cross product with a point of theirs, which is the same for all. Coordinates lie below
 * 2^30, so directions below 2^31, products below 2^61 and their differences below 2^62.
 *
 * Source: Plücker. On a New Geometry of Space. 1865 (a line by direction and moment).
 * Guarantee: exact; never more edges than before, which follow from the given ones' places only. */
#include "mesh/mesh.h"
#include "winding/holes.h"
#include "bits/sort.h"

enum { HOLE_LINE_FEW = 32 };

typedef struct hole_line {
    int64_t moment[3];
    int32_t direction[3]; /* its first component other than 0 is positive */
    int32_t along;        /* 1: the edge runs that way, -1: the other */
} hole_line;

typedef struct line_work {
    const bvxi_snapped *snapped;
    const uint64_t *edges; /* from << 32 | to */
    /* 1: at most one edge a stretch, where it is odd (all rules but WINDING); 0: as the sum says */
    int odd_once;
    hole_line *line;   /* of each edge */
    uint64_t *key;     /* hashes of lines [Size: count] */
    uint32_t *order;   /* edges, those of a line side by side [Size: count] */
    uint64_t *place;   /* of the ends on one line, ascending [Size: count * 2] */
    uint32_t *end;     /* edge << 1, plus 1 for its higher end [Size: count * 2] */
    uint32_t *open_at; /* stack of the vertices where still open edges begin [Size: count] */
    uint64_t *kept;    /* edges [Size: count] */
    uint64_t kept_count;
} line_work;

/* ---- lines ---- */

static void find_line(const bvxi_snapped *s, uint64_t edge, hole_line *l)
{
    const int32_t *const from = s->xyz + 3 * (edge >> 32);
    const int32_t *const to = s->xyz + 3 * (uint64_t)(uint32_t)edge;
    int64_t d[3];
    uint32_t divisor = 0;

    l->along = 0;
    for (int a = 0; a < 3; a++) {
        /* Divided by what its components share, all edges of a line have one direction. */
        d[a] = (int64_t)to[a] - from[a];
        for (uint32_t b = (uint32_t)(d[a] < 0 ? -d[a] : d[a]); b != 0;) {
            uint32_t const rest = divisor % b;
            divisor = b;
            b = rest;
        }
        if (l->along == 0) l->along = (d[a] > 0) - (d[a] < 0);
    }
    /* Turned so that the first component that is not 0 is positive; along keeps which way the edge runs. */
    for (int a = 0; a < 3; a++) d[a] /= (int64_t)divisor * l->along;
    for (int a = 0; a < 3; a++) {
        int const b = (a + 1) % 3, c = (a + 2) % 3;
        /* The moment is the same for every point of the line. */
        l->direction[a] = (int32_t)d[a];
        l->moment[a] = from[b] * d[c] - from[c] * d[b];
    }
}

/* Two components of the moment: the third follows from them but on level lines, see part_lines. */
static uint64_t hash_line(const hole_line *l)
{
    uint64_t h = 0;
    for (int a = 0; a < 3; a++) {
        h = (h ^ (uint64_t)(a < 2 ? l->moment[a] : 0)) * UINT64_C(0x9e3779b97f4a7c15);
        h = (h ^ h >> 29 ^ (uint32_t)l->direction[a]) * UINT64_C(0xbf58476d1ce4e5b9);
        h ^= h >> 32;
    }
    return h;
}

static int compare_lines(const hole_line *l, const hole_line *m)
{
    for (int a = 0; a < 3; a++) {
        /* Equal lines only: whether one is less than another does not matter, as long as it always is. */
        if (l->moment[a] != m->moment[a]) return l->moment[a] < m->moment[a] ? -1 : 1;
        if (l->direction[a] != m->direction[a]) return l->direction[a] < m->direction[a] ? -1 : 1;
    }
    return 0;
}

static int line_before(const void *lines, uint32_t a, uint32_t b)
{
    const hole_line *const line = lines;
    return compare_lines(&line[a], &line[b]) < 0;
}

/* ---- one line ---- */

/* The lower or higher vertex of an edge on its line. */
static uint32_t line_vertex(const line_work *w, uint32_t edge, uint32_t higher)
{
    int const is_to = (w->line[edge].along > 0) == (higher != 0);
    return (uint32_t)(is_to ? w->edges[edge] : w->edges[edge] >> 32);
}

static bvx_status order_ends(bvx_context *ctx, line_work *w, const uint32_t *edges, uint64_t n)
{
    const int32_t *const d = w->line[edges[0]].direction;
    int const axis = d[0] != 0 ? 0 : d[1] != 0 ? 1 : 2;

    for (uint64_t i = 0; i < 2 * n; i++) {
        /* Both ends of each edge, by their coordinate along an axis on which the line moves. */
        uint32_t const end = edges[i / 2] << 1 | (uint32_t)(i & 1);
        uint64_t const vertex = line_vertex(w, end >> 1, end & 1);
        /* sign bit flipped: unsigned order is that of the coordinates */
        uint64_t const place = (uint32_t)w->snapped->xyz[3 * vertex + (uint64_t)axis] ^ 0x80000000u;
        uint64_t j = i;

        /* Few ends are inserted in order as they come; many are sorted below. */
        for (; n <= HOLE_LINE_FEW && j > 0 && w->place[j - 1] > place; j--) {
            w->place[j] = w->place[j - 1];
            w->end[j] = w->end[j - 1];
        }
        w->place[j] = place;
        w->end[j] = end;
    }
    return n <= HOLE_LINE_FEW ? BVX_OK : bvxi_radix_sort(ctx, w->place, w->end, 2 * n);
}

/* Does anything lie on something that it cancels? */
static int line_cancels(const line_work *w, uint64_t ends)
{
    int64_t up = 0, down = 0;
    for (uint64_t i = 0, next; i < ends; i = next) {
        for (next = i; next < ends && w->place[next] == w->place[i]; next++) {
            /* Lower ends begin an edge and higher ones end it; edges up and down are counted apart. */
            int64_t const more = (w->end[next] & 1) != 0 ? -1 : 1;
            if (w->line[w->end[next] >> 1].along > 0) up += more;
            else down += more;
        }
        if ((up != 0 && down != 0) || (w->odd_once && up + down > 1)) return 1;
    }
    return 0;
}

/* From the lowest end to the highest: each step of the sum begins or ends as many edges. */
static void sweep_line(line_work *w, uint64_t ends)
{
    /* Open ones lie on a stack: their order on a line does not matter, as they all run to the same end. */
    uint64_t open = 0;
    int64_t sum = 0, wanted, have = 0; /* have: edges that are open, negative ones run down */

    for (uint64_t i = 0, next; i < ends; i = next) {
        uint64_t const here = line_vertex(w, w->end[i] >> 1, w->end[i] & 1);
        for (next = i; next < ends && w->place[next] == w->place[i]; next++)
            sum += (w->end[next] & 1) != 0 ? -w->line[w->end[next] >> 1].along
                                           : w->line[w->end[next] >> 1].along;

        /* How many edges should be open from here on; the difference begins or ends some. */
        wanted = sum;
        /* Odd: the open one is kept so that it is not cut in two; else there is one, along the sum. */
        if (w->odd_once) wanted = (sum & 1) == 0 ? 0 : have != 0 ? have : sum > 0 ? 1 : -1;
        /* First those that are too many end here, then those that are missing begin. */
        for (; have > wanted && have > 0; have--)
            w->kept[w->kept_count++] = (uint64_t)w->open_at[--open] << 32 | here;
        for (; have < wanted && have < 0; have++) w->kept[w->kept_count++] = here << 32 | w->open_at[--open];
        for (; have != wanted; have += have < wanted ? 1 : -1) w->open_at[open++] = (uint32_t)here;
    }
}

/* The edges that are left replace the given ones: never more, so they fit where those were. */
static bvx_status cancel_lines(bvx_context *ctx, line_work *w, uint64_t count, uint64_t *left)
{
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the open edges' lines", w->line));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the open edges' hashes", w->key));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the open edges by line", w->order));
    BVXI_TRY(BVXI_ARRAY(ctx, 2 * count, "the ends on a line", w->place));
    BVXI_TRY(BVXI_ARRAY(ctx, 2 * count, "the ends in order", w->end));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the open edges on a line", w->open_at));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "the edges kept", w->kept));
    for (uint64_t i = 0; i < count; i++) {
        find_line(w->snapped, w->edges[i], &w->line[i]);
        w->key[i] = hash_line(&w->line[i]);
        w->order[i] = (uint32_t)i;
    }
    /* Sorted by hash, edges of a line come together, save that several lines may share a hash. */
    BVXI_TRY(bvxi_radix_sort(ctx, w->key, w->order, count));
    for (uint64_t i = 0, n; i < count; i += n) {
        uint64_t same = 1;
        for (n = 1; i + n < count && w->key[i + n] == w->key[i];) n++;
        /* Nearly always one hash is one line; those of several are sorted by line. */
        while (same < n && compare_lines(&w->line[w->order[i]], &w->line[w->order[i + same]]) == 0) same++;
        if (same < n) bvxi_sort_items(w->order + i, n, line_before, w->line);
    }

    for (uint64_t i = 0, n; i < count; i += n) {
        const uint32_t *const edges = w->order + i;
        int cancels = 0;

        /* A line with one edge has nothing to cancel. */
        for (n = 1; i + n < count && compare_lines(&w->line[edges[0]], &w->line[edges[n]]) == 0;) n++;
        if (n > 1) {
            BVXI_TRY(order_ends(ctx, w, edges, n));
            cancels = line_cancels(w, 2 * n);
        }
        if (cancels) sweep_line(w, 2 * n);
        for (uint64_t k = 0; k < n && !cancels; k++) w->kept[w->kept_count++] = w->edges[edges[k]];
    }
    memcpy(left, w->kept, (size_t)w->kept_count * 8);
    return BVX_OK;
}

/* ---- all ---- */

bvx_status bvxi_cancel_lines(bvx_context *ctx, const bvxi_snapped *s, int odd_once, uint64_t **edges,
                             uint64_t *count)
{
    uint64_t const n = *count;
    line_work w = {.snapped = s, .edges = *edges, .odd_once = odd_once};

    /* ends have numbers of 32 bits; more edges than those only stay as they are */
    if (n < 2 || n > UINT32_MAX / 2) return BVX_OK;

    BVXI_TRY(BVXI_SCOPE(ctx, cancel_lines(ctx, &w, n, *edges)));
    *count = w.kept_count;
    return bvxi_resize(ctx, BVXI_SCRATCH, edges, n * 8, *count * 8, "the open edges");
}
