/* holes.c - the open edges of a snapped mesh, joined to loops.
 *
 * At every vertex an even number of open edges meet (a triangle brings two, or none, to each), so a walk
 * along unused ones ends where it began, and parts into loops.
 * Guarantee: corners are numbered by their places, edges by their corners, and the walk takes the least
 * number that the triangles' own direction allows: the loops follow from the geometry only. */
#include "winding/holes.h"
#include "bits/sort.h"

#define HOLE_NONE UINT32_MAX

/* ---- Corners numbered by their positions ---- */

/* The order of positions, z first. */
static int place_before(const void *of, uint32_t v, uint32_t w)
{
    const int32_t *const xyz = of, *const a = xyz + 3 * (uint64_t)v, *const b = xyz + 3 * (uint64_t)w;
    if (a[2] != b[2]) return a[2] < b[2];
    if (a[1] != b[1]) return a[1] < b[1];
    return a[0] < b[0];
}

/* ---- Loops ---- */

/* A walk along open edges, each taken once. */
typedef struct hole_walk {
    const uint64_t *edges; /* start corner in the high half, end corner in the low half, ascending */
    uint64_t count;
    /* by corner: the next edge to try that leaves it; the next place in incoming [Size: corners + 1] */
    uint64_t *out, *in;
    uint32_t *incoming; /* edges by their end, ascending */
    uint8_t *used;      /* by edge */
    uint32_t *trail;    /* corners walked [Size: corners] */
    uint32_t *met;      /* by corner: its place on the trail plus 1, or 0 */
} hole_walk;

/* The next unused edge at a corner, or HOLE_NONE: those that leave it first. */
static uint32_t next_open_edge(hole_walk *w, uint32_t corner)
{
    /* Both lists only move on: an edge that is used stays used. */
    for (; w->out[corner] < w->count && w->edges[w->out[corner]] >> 32 == corner; w->out[corner]++)
        if (!w->used[w->out[corner]]) return (uint32_t)w->out[corner];
    for (; w->in[corner] < w->count && (uint32_t)w->edges[w->incoming[w->in[corner]]] == corner;
         w->in[corner]++)
        if (!w->used[w->incoming[w->in[corner]]]) return w->incoming[w->in[corner]];
    return HOLE_NONE;
}

/* Walk until no edge is left; a corner met again closes a loop and takes it off: no corner twice. */
static void walk_loops(hole_walk *w, const uint32_t *place, bvxi_holes *holes)
{
    /* Loops begin with the least edge that is left, so that their order follows from the numbers. */
    for (uint64_t e = 0; e < w->count; e++) {
        uint32_t at = (uint32_t)(w->edges[e] >> 32), edge = (uint32_t)e;
        uint64_t length = 1;
        if (w->used[e]) continue;
        w->trail[0] = at;
        w->met[at] = 1;
        for (; edge != HOLE_NONE; edge = next_open_edge(w, at)) {
            /* The edge may be walked against its direction; the other end is where the walk goes. */
            uint32_t const from = (uint32_t)(w->edges[edge] >> 32);
            w->used[edge] = 1;
            at = at == from ? (uint32_t)w->edges[edge] : from;
            if (w->met[at] == 0) {
                w->trail[length++] = at;
                w->met[at] = (uint32_t)length;
                continue;
            }

            /* A corner met again: the part of the trail since then is a loop, and leaves the trail. */
            for (uint64_t i = w->met[at] - 1; i < length; i++)
                holes->vertex[holes->points++] = place[w->trail[i]];
            holes->loop_end[holes->loops++] = holes->points;
            for (; length > w->met[at]; length--) w->met[w->trail[length - 1]] = 0;
        }
        w->met[w->trail[0]] = 0;
    }
}

static bvx_status join_loops(bvx_context *ctx, const uint64_t *edges, uint64_t count, const uint32_t *place,
                             uint64_t corners, bvxi_holes *holes)
{
    uint64_t const bytes = (corners + 1) * 8;
    hole_walk w = {edges, count, NULL, NULL, NULL, NULL, NULL, NULL};
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the open edges that leave", &w.out));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the open edges that arrive", &w.in));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 4, "the open edges by end", &w.incoming));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count, "the open edges' marks", &w.used));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, corners * 4, "the trail along open edges", &w.trail));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, corners * 4, "the trail's marks", &w.met));

    /* All arrays were made: the walk itself cannot fail. */
    uint64_t sum = 0;

    memset(w.used, 0, (size_t)w.count);
    memset(w.out, 0, (size_t)(corners + 1) * 8);
    memset(w.in, 0, (size_t)(corners + 1) * 8);
    /* Counts go one place up, so that sums make them starts. */
    for (uint64_t e = 0; e < w.count; e++) {
        w.out[(w.edges[e] >> 32) + 1]++;
        w.in[(uint32_t)w.edges[e] + 1]++;
    }
    for (uint64_t c = 1; c <= corners; c++) w.out[c] += w.out[c - 1]; /* starts */
    for (uint64_t c = 0; c <= corners; c++) {
        sum += w.in[c];
        w.in[c] = sum;
    }
    for (uint64_t e = 0; e < w.count; e++) w.incoming[w.in[(uint32_t)w.edges[e]]++] = (uint32_t)e;
    /* filling moved each to the next one's start */
    for (uint64_t c = corners; c > 0; c--) w.in[c] = w.in[c - 1];
    w.in[0] = 0;

    walk_loops(&w, place, holes);
    return BVX_OK;
}

uint64_t bvxi_sheet_triangles(const bvxi_holes *holes, uint32_t *corner)
{
    uint64_t count = 0, begin = 0, i, j;

    for (uint64_t l = 0; l < holes->loops; begin = holes->loop_end[l++]) {
        bvxi_sheet_walk w;
        w.count = 0;
        bvxi_sheet_push(&w, begin, holes->loop_end[l] - 1);
        /* As fill_sheet walks it, so the triangles are those of the sums. */
        while (bvxi_sheet_take(&w, &i, &j)) {
            uint64_t const m = i + (j - i) / 2;
            if (j - i < 2) continue;
            corner[3 * count] = (uint32_t)i;
            corner[3 * count + 1] = (uint32_t)m;
            corner[3 * count++ + 2] = (uint32_t)j;
            bvxi_sheet_push(&w, i, m);
            bvxi_sheet_push(&w, m, j);
        }
    }
    return count;
}

void bvxi_holes_close(bvx_context *ctx, bvxi_holes *holes)
{
    bvxi_drop(ctx, holes->loop_end);
    bvxi_drop(ctx, holes->vertex);
    memset(holes, 0, sizeof *holes);
}

bvx_status bvxi_holes_append(bvx_context *ctx, const bvxi_snapped *s, uint64_t *edges, uint64_t count,
                             bvxi_holes *holes)
{
    uint64_t const bytes = s->vertex_count * 4;
    uint32_t *place = NULL, *number = NULL;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the open edges' corners", &place));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the corners' numbers", &number));

    /* place[n] becomes the vertex of the n-th corner by position; edges change to these numbers and are
     * sorted. number: scratch [Size: vertex_count]. Returns how many corners there are. */
    uint64_t n = 0;

    /* Each corner once, in the order of its first appearance; that order is sorted away next. */
    for (uint64_t v = 0; v < s->vertex_count; v++) number[v] = 0;
    for (uint64_t i = 0; i < 2 * count; i++) {
        uint32_t const v = (uint32_t)(edges[i / 2] >> (i % 2 != 0 ? 32 : 0));
        if (number[v]++ == 0) place[n++] = v;
    }

    bvxi_sort_items(place, n, place_before, s->xyz);
    /* Numbers by position: the same geometry gives the same numbers, whatever the vertices were called. */
    for (uint64_t i = 0; i < n; i++) number[place[i]] = (uint32_t)i;
    for (uint64_t i = 0; i < count; i++)
        edges[i] = (uint64_t)number[edges[i] >> 32] << 32 | number[(uint32_t)edges[i]];
    bvxi_sort_u64(edges, count);
    uint64_t const corners = n;

    return join_loops(ctx, edges, count, place, corners, holes);
}

bvx_status bvxi_holes_open(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_snapped *snapped,
                           int odd_once, bvxi_holes *holes)
{
    uint64_t *edges = NULL, count = 0;
    memset(holes, 0, sizeof *holes);
    /* The edges first; most meshes have none, and need nothing more. */
    BVXI_TRY(bvxi_open_edges(ctx, view, snapped, odd_once, &edges, &count));
    if (count >= HOLE_NONE)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "the mesh has %u open edges; fewer than 2^32 - 1 can be closed", count);
    if (count > 0) {
        /* A loop has as many points as edges, so these arrays hold all of them. */
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 4, "the loops' points", &holes->vertex));
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the loops' ends", &holes->loop_end));
        BVXI_TRY(BVXI_SCOPE(ctx, bvxi_holes_append(ctx, snapped, edges, count, holes)));
        /* Edges are sorted by their corners' numbers, and never there both ways (hole_edges.c). */
        for (uint64_t i = 1; i < count; i++) holes->repeated |= edges[i] == edges[i - 1];
    }
    bvxi_drop(ctx, edges);
    return BVX_OK;
}

bvx_status bvxi_holes_check_corners(bvx_context *ctx, const char *function, const bvx_mesh_view *view)
{
    uint32_t corner[3];
    for (uint64_t t = 0; t < view->triangle_count; t++)
        if (BVXI_UNLIKELY(!bvxi_view_triangle(view, t, corner)))
            return bvxi_view_fail_index(ctx, function, view, t);
    return BVX_OK;
}

bvx_status bvxi_holes_open_rule(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                const bvx_lattice *lattice, int32_t fill, bvxi_holes *holes)
{
    bvxi_snapped snapped;
    memset(holes, 0, sizeof *holes);
    /* Corners are checked here, as snapping trusts them. */
    BVXI_TRY(bvxi_holes_check_corners(ctx, function, view));
    BVXI_TRY(bvxi_snap(ctx, function, view, lattice, &snapped));
    bvx_status status = BVXI_SHARE(ctx, 0.1, 1.0,
                                   bvxi_holes_open(ctx, view, &snapped, fill != BVX_FILL_WINDING, holes));
    bvxi_snap_free(ctx, &snapped);
    return status;
}
