/* sheets.c - a mesh as files have it made ready for a collapse: what is given is kept, by vertices of its own for
 * each fan of triangles.
 *
 * Half-edges are sorted by their ends, so those of an edge lie side by side. Over edges of two triangles these
 * form patches, in which the triangles of less area are turned. Around an edge of three triangles and more lie
 * spaces inside and outside in turns: the triangles on both sides of an inside belong together, first those of
 * one patch. So bodies that touch along an edge stay two, with their volumes. Triangles that remain without a pair
 * get borders. Corners that hang together through pairs share a vertex.
 *
 * Guarantee: an oriented manifold mesh is left as it is, in its order. */
#include "simplify/sheets.h"
#include "mesh/facet.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/view.h"

/* Bits of an angle that rounding may change: equal angles are equal without them. */
enum { ANGLE_ROUNDING = 20, FEW_PAIRS = 16, SHEET_GRAIN = 4096 };

enum { COPY_NONE, COPY_TURNED, COPY_DROPPED };

/* Of what remains around an edge, whatever its patch. */
#define NO_PATCH UINT32_MAX

typedef struct patch_area {
    double same, other; /* of the triangles that run as the root does, and of those that do not */
    uint64_t torn;      /* edges where its triangles cannot agree: it has one side only */
} patch_area;

typedef struct sheet_work {
    bvx_context *ctx;
    bvx_mesh_view *view;
    uint32_t *corner;
    uint32_t *source; /* or NULL: of each corner, that of the mesh [Size: triangles * 3] */
    bvxi_sheets_report *report;
    uint64_t triangles;
    uint64_t *keys;   /* lower vertex << 32 | higher one of each half-edge, ascending [Size: triangles * 3] */
    uint32_t *half;   /* the half-edges: 3 t + k runs from corner k to the next [Size: triangles * 3] */
    uint64_t crowded; /* half-edges at edges of three triangles and more */
    uint64_t disputed; /* edges of two triangles that run along it the same way */
    uint32_t *link;   /* triangle << 1 | 1 when it runs otherwise; a root links to itself [Size: triangles] */
    uint32_t *parent; /* of corners that share a vertex [Size: triangles * 3] */

    /* Crowded half-edges, by edge, then by what is paired with each other, then around the edge. */
    uint64_t *order;
    uint32_t *crowd, *edge, *patch,
        *stack;       /* index into what follows [Size: crowded]; the rest by that index */
    uint32_t *at;     /* half-edges */
    uint8_t *outside; /* by edge, 1: triangles on both sides of an outside are paired */
} sheet_work;

static uint32_t next_of(uint32_t half)
{
    return half % 3 == 2 ? half - 2 : half + 1;
}

/* 1: the half-edge runs from the lower vertex to the higher one. */
static int runs_up(const sheet_work *w, uint32_t half)
{
    return w->corner[half] < w->corner[next_of(half)];
}

/* ---- Welded triangles ---- */

static int has_equal_corners(const uint32_t *v)
{
    return (v[0] == v[1]) | (v[1] == v[2]) | (v[2] == v[0]);
}

/* Close the gaps of copies that are dropped, or with copy NULL of triangles with equal corners; returns what is left. */
static uint64_t drop_where(const sheet_work *w, uint64_t triangles, const uint8_t *copy)
{
    uint64_t kept = 0;
    for (uint64_t t = 0; t < triangles; t++) {
        if (copy != NULL ? copy[t] == COPY_DROPPED : has_equal_corners(w->corner + 3 * t)) continue;
        memmove(w->corner + 3 * kept, w->corner + 3 * t, 12);
        if (w->source != NULL) memmove(w->source + 3 * kept, w->source + 3 * t, 12);
        kept++;
    }
    return kept;
}

/* Triangles of the mesh by welded vertices. */
typedef struct sheet_weld {
    const bvx_mesh_view *mesh;
    uint32_t *representative, *corner, *source;
    uint8_t dropped[BVXI_MOST_PIECES]; /* 1: some have equal corners */
} sheet_weld;

static void weld_triangles(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    sheet_weld *const s = user;
    int dropped = 0;

    for (uint64_t t = begin; t < end; t++) {
        uint32_t *const to = s->corner + 3 * t;

        bvxi_view_triangle(s->mesh, t, to);
        for (int k = 0; k < 3; k++) to[k] = s->representative[to[k]];
        for (uint64_t k = 3 * t; k < 3 * t + 3 && s->source != NULL; k++) s->source[k] = (uint32_t)k;
        dropped |= has_equal_corners(to);
    }
    s->dropped[piece] = (uint8_t)dropped;
}

/* ---- Edges ---- */

/* Half-edges from begin on that belong to one edge. */
static uint64_t edge_halves(const sheet_work *w, uint64_t begin)
{
    uint64_t end = begin + 1;
    while (end < 3 * w->triangles && w->keys[end] == w->keys[begin]) end++;
    return end - begin;
}

static bvx_status list_edges(sheet_work *w)
{
    uint64_t const count = 3 * w->triangles;

    for (uint32_t h = 0; h < count; h++) {
        uint64_t const a = w->corner[h], b = w->corner[next_of(h)];

        w->keys[h] = a < b ? a << 32 | b : b << 32 | a;
        w->half[h] = h;
    }
    BVXI_TRY(bvxi_radix_sort(w->ctx, w->keys, w->half, count));

    w->crowded = w->disputed = 0;
    for (uint64_t i = 0, n; i < count; i += n) {
        n = edge_halves(w, i);
        if (n > 2) w->crowded += n;
        else if (n == 2) w->disputed += runs_up(w, w->half[i]) == runs_up(w, w->half[i + 1]);
    }
    return BVX_OK;
}

static void report_cut(sheet_work *w, uint64_t i)
{
    if (w->report->cut++ != 0) return;
    bvxi_view_position(w->view, (uint32_t)(w->keys[i] >> 32), w->report->cut_edge[0]);
    bvxi_view_position(w->view, (uint32_t)w->keys[i], w->report->cut_edge[1]);
}

/* ---- Copies ---- */

/* The corners of a triangle in their order; returns 1 where that order runs the other way. */
static int order_by_index(const uint32_t *corner, uint32_t *sorted)
{
    int const least = corner[0] < corner[1] ? (corner[0] < corner[2] ? 0 : 2) : corner[1] < corner[2] ? 1 : 2;
    uint32_t const a = corner[(least + 1) % 3], b = corner[(least + 2) % 3];
    sorted[0] = corner[least];
    sorted[1] = a < b ? a : b;
    sorted[2] = a < b ? b : a;
    return a > b;
}

/* Mark triangles that an earlier one copies: exactly, or turned. */
static bvx_status mark_copies(const sheet_work *w, uint8_t *copy)
{
    uint32_t sorted[3], before[3] = {0, 0, 0}, *order;
    int known[2] = {0, 0};
    uint64_t *keys;

    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_SCRATCH, w->triangles * 12, "the triangles' corners", &keys));
    order = (uint32_t *)(void *)(keys + w->triangles);

    /* By the highest corner, then by the others: equal triangles end up side by side, in their order. */
    for (uint32_t t = 0; t < w->triangles; t++) {
        order_by_index(w->corner + 3 * (uint64_t)t, sorted);
        keys[t] = sorted[2];
        order[t] = t;
    }
    BVXI_TRY(bvxi_radix_sort(w->ctx, keys, order, w->triangles));
    for (uint64_t i = 0; i < w->triangles; i++) {
        order_by_index(w->corner + 3 * (uint64_t)order[i], sorted);
        keys[i] = (uint64_t)sorted[0] << 32 | sorted[1];
    }
    BVXI_TRY(bvxi_radix_sort(w->ctx, keys, order, w->triangles));

    for (uint64_t i = 0; i < w->triangles; i++) {
        int const turned = order_by_index(w->corner + 3 * (uint64_t)order[i], sorted);

        if (i == 0 || memcmp(sorted, before, sizeof sorted) != 0) known[0] = known[1] = 0;
        memcpy(before, sorted, sizeof before);
        copy[order[i]] = known[turned] ? COPY_DROPPED : known[!turned] ? COPY_TURNED : COPY_NONE;
        known[turned] = 1;
    }
    bvxi_drop(w->ctx, keys);
    return BVX_OK;
}

/* A turned copy is the other side of a sheet where its edges have as many triangles either way; else it is one too
 * many. */
static bvx_status drop_sheet_copies(sheet_work *w)
{
    uint64_t const before = w->triangles;
    uint8_t *copy;

    BVXI_TRY(bvxi_alloc_zero(w->ctx, BVXI_SCRATCH, w->triangles, "the triangles' copies", &copy));
    BVXI_TRY(mark_copies(w, copy));
    for (uint64_t i = 0, n; i < 3 * w->triangles; i += n) {
        uint64_t up = 0, all = 0;

        n = edge_halves(w, i);
        for (uint64_t j = i; j < i + n; j++) {
            if (copy[w->half[j] / 3] == COPY_DROPPED) continue;
            up += (uint64_t)runs_up(w, w->half[j]);
            all++;
        }
        for (uint64_t j = i; j < i + n && 2 * up != all; j++)
            if (copy[w->half[j] / 3] == COPY_TURNED) copy[w->half[j] / 3] = COPY_DROPPED;
    }
    w->triangles = drop_where(w, before, copy);
    w->report->doubles += before - w->triangles;
    bvxi_drop(w->ctx, copy);
    return w->triangles != before ? list_edges(w) : BVX_OK;
}

/* ---- Patches ---- */

/* Join two triangles across an edge; 0 where they disagree already. */
static int join_sheets(uint32_t *link, uint32_t s, uint32_t t, uint32_t differ)
{
    uint32_t ds, dt;
    uint32_t const a = bvxi_link_root(link, s, &ds), b = bvxi_link_root(link, t, &dt);
    if (a == b) return (ds ^ dt) == differ;
    /* The least triangle is the root, so the result does not depend on the order of edges. */
    link[a < b ? b : a] = (a < b ? a : b) << 1 | (ds ^ dt ^ differ);
    return 1;
}

/* The vertex opposite to a half-edge. */
static uint32_t apex_of(const sheet_work *w, uint32_t half)
{
    return w->corner[next_of(next_of(half))];
}

/* Turn the triangles of less area in each patch, but of one that has one side only. */
static bvx_status turn_patches(sheet_work *w)
{
    patch_area *area;

    BVXI_TRY(bvxi_alloc_zero(w->ctx, BVXI_SCRATCH, w->triangles * sizeof *area, "the patches' areas", &area));

    /* Join triangles over edges of two; torn: where they disagree, by their root then. Where a sheet of two
     * sides ends its last triangle is no patch with its own copy: it would leave the sheet. */
    for (uint64_t i = 0, n; i < 3 * w->triangles; i += n) {
        uint32_t differs;
        n = edge_halves(w, i);
        if (n != 2 || apex_of(w, w->half[i]) == apex_of(w, w->half[i + 1])) continue;
        if (!join_sheets(w->link, w->half[i] / 3, w->half[i + 1] / 3,
                         runs_up(w, w->half[i]) == runs_up(w, w->half[i + 1])))
            area[bvxi_link_root(w->link, w->half[i] / 3, &differs)].torn++;
    }
    for (uint64_t t = 0; t < w->triangles && w->disputed != 0; t++) {
        uint32_t differs;
        patch_area *const a = &area[bvxi_link_root(w->link, (uint32_t)t, &differs)];
        double p[3][3], n[3];

        for (int k = 0; k < 3; k++) bvxi_view_position(w->view, w->corner[3 * t + (uint64_t)k], p[k]);
        bvxi_order_corners(p);
        *(differs ? &a->other : &a->same) += bvxi_facet_normal((const double(*)[3])p, n);
        /* What was found of a patch before it was joined to another one holds for both. */
        if (a != &area[t]) a->torn += area[t].torn;
    }
    for (uint64_t t = 0; t < w->triangles && w->disputed != 0; t++) {
        uint32_t *const c = w->corner + 3 * t;
        uint32_t differs, second = c[1];
        const patch_area *const a = &area[bvxi_link_root(w->link, (uint32_t)t, &differs)];

        if (a->torn != 0 || !(differs ? a->other <= a->same : a->other > a->same)) continue;
        c[1] = c[2];
        c[2] = second;
        if (w->source != NULL) {
            second = w->source[3 * t + 1];
            w->source[3 * t + 1] = w->source[3 * t + 2];
            w->source[3 * t + 2] = second;
        }
        w->report->turned++;
    }
    bvxi_drop(w->ctx, area);
    return w->report->turned != 0 ? list_edges(w) : BVX_OK;
}

/* ---- Edges of three triangles and more ---- */

/* Where a triangle lies around its edge, seen along it: 1 to 5 for a full turn from the first axis that the edge
 * does not run along. */
static double angle_of(const sheet_work *w, uint32_t half)
{
    uint32_t const a = w->corner[half], b = w->corner[next_of(half)], c = apex_of(w, half);
    double low[3], high[3], apex[3], e[3], f[3], u[3] = {0, 0, 0}, v[3], x = 0, y = 0, sum;
    int least = 0;

    bvxi_view_position(w->view, a < b ? a : b, low);
    bvxi_view_position(w->view, a < b ? b : a, high);
    bvxi_view_position(w->view, c, apex);
    for (int k = 0; k < 3; k++) {
        e[k] = high[k] - low[k];
        f[k] = apex[k] - low[k];
        if (bvxi_absolute(e[k]) < bvxi_absolute(e[least])) least = k;
    }

    /* u and v are square to the edge: v is e x axis, u is v x e, as long as the edge more. */
    v[least] = 0;
    v[(least + 1) % 3] = e[(least + 2) % 3];
    v[(least + 2) % 3] = -e[(least + 1) % 3];
    for (int k = 0; k < 3; k++) u[k] = v[(k + 1) % 3] * e[(k + 2) % 3] - v[(k + 2) % 3] * e[(k + 1) % 3];
    for (int k = 0; k < 3; k++) {
        x += f[k] * u[k];
        y += f[k] * v[k];
    }
    y *= sqrt(e[0] * e[0] + e[1] * e[1] + e[2] * e[2]);
    sum = bvxi_absolute(x) + bvxi_absolute(y);
    if (!(sum > 0)) return 1;
    return 1 + (x >= 0 ? (y >= 0 ? y / sum : 4 + y / sum) : 2 - y / sum);
}

static bvx_status open_crowd(sheet_work *w)
{
    uint64_t const m = w->crowded;
    uint64_t n = 0;

    BVXI_TRY(bvxi_alloc_zero(w->ctx, BVXI_SCRATCH, m * 29, "edges of many triangles", &w->order));
    w->crowd = (uint32_t *)(void *)(w->order + m);
    w->edge = w->crowd + m;
    w->patch = w->edge + m;
    w->stack = w->patch + m;
    w->at = w->stack + m;
    w->outside = (uint8_t *)(w->at + m);

    for (uint64_t i = 0, length; i < 3 * w->triangles; i += length) {
        length = edge_halves(w, i);
        if (length < 3) continue;
        for (uint64_t j = i; j < i + length; j++) {
            uint32_t differs;

            w->at[n] = w->half[j];
            w->edge[n] = (uint32_t)i;
            w->patch[n++] = bvxi_link_root(w->link, w->half[j] / 3, &differs);
        }
    }
    return BVX_OK;
}

static bvx_status sort_crowd(sheet_work *w)
{
    for (uint64_t m = 0; m < w->crowded; m++)
        w->order[m] = (uint64_t)w->edge[w->crowd[m]] << 32 | w->patch[w->crowd[m]];
    return bvxi_radix_sort(w->ctx, w->order, w->crowd, w->crowded);
}

/* Half-edges from m on that are paired with each other; *up: those of them that run up. */
static uint64_t run_length(const sheet_work *w, uint64_t m, uint64_t *up)
{
    uint64_t end = m;
    for (*up = 0; end < w->crowded && w->order[end] == w->order[m]; end++)
        *up += (uint64_t)runs_up(w, w->at[w->crowd[end]]);
    return end - m;
}

/* ---- Pairs ---- */

/* Two half-edges that run along an edge in opposite directions: their corners share vertices. */
static void join_halves(sheet_work *w, uint32_t a, uint32_t b)
{
    bvxi_join(w->parent, a, next_of(b));
    bvxi_join(w->parent, next_of(a), b);
}

static void pair_edges(sheet_work *w)
{
    for (uint32_t h = 0; h < 3 * w->triangles; h++) w->parent[h] = h;
    for (uint64_t i = 0, n; i < 3 * w->triangles; i += n) {
        n = edge_halves(w, i);
        if (n == 2 && runs_up(w, w->half[i]) != runs_up(w, w->half[i + 1]))
            join_halves(w, w->half[i], w->half[i + 1]);
    }

    for (uint64_t m = 0, n, up; m < w->crowded; m += n) {
        n = run_length(w, m, &up);
        /* As many up as down are paired like brackets; the stack receives each pair's first and second. */
        if (2 * up == n) {
            int const outside = w->outside[w->crowd[m]];
            uint64_t first = 0, held = 0;
            int64_t depth = 0, least = 0;
            uint32_t *const stack = w->stack + m;

            /* What runs down opens an inside. The brackets begin where the least of them are open. */
            for (uint64_t i = 0; i < n; i++) {
                depth += runs_up(w, w->at[w->crowd[m + i]]) == outside ? 1 : -1;
                if (depth >= least) continue;
                least = depth;
                first = i + 1;
            }
            for (uint64_t i = 0; i < n; i++) {
                uint32_t const half = w->at[w->crowd[m + (first + i) % n]];

                if (runs_up(w, half) == outside) stack[held++] = half;
                else join_halves(w, stack[--held], half);
            }
        }
    }
}

/* 1: two pairs of a run have the same vertices at both ends, which no mesh of indices can tell apart. */
static int is_run_double(sheet_work *w, uint64_t m, uint64_t n)
{
    uint64_t seen = 0;
    uint32_t end[FEW_PAIRS][2];

    if (n > FEW_PAIRS) return 0;
    for (uint64_t i = m; i < m + n; i++) {
        uint32_t const half = w->at[w->crowd[i]];

        if (!runs_up(w, half)) continue;
        end[seen][0] = bvxi_root(w->parent, half);
        end[seen][1] = bvxi_root(w->parent, next_of(half));
        for (uint64_t j = 0; j < seen; j++)
            if (memcmp(end[j], end[seen], sizeof end[j]) == 0) return 1;
        seen++;
    }
    return 0;
}

/* An edge is parted where all of its triangles are paired, and no pairs are doubles. */
static void report_crowd(sheet_work *w)
{
    for (uint64_t m = 0, n, up; m < w->crowded;) {
        uint32_t const edge = w->edge[w->crowd[m]];
        int is_cut = 0;

        for (; m < w->crowded && w->edge[w->crowd[m]] == edge; m += n) {
            n = run_length(w, m, &up);
            is_cut |= 2 * up != n || is_run_double(w, m, n);
        }
        if (is_cut) report_cut(w, edge);
        else w->report->parted++;
    }
}

/* ---- Vertices ---- */

/* Count the vertices beyond the first of each position; then give them to the corners. */
static uint64_t name_corners(sheet_work *w, uint8_t *seen, void *positions, size_t bytes)
{
    uint64_t const vertices = w->view->vertex_count;
    uint64_t more = 0;

    memset(seen, 0, (size_t)vertices);
    for (uint32_t h = 0; h < 3 * w->triangles; h++) {
        uint32_t const root = bvxi_root(w->parent, h), v = w->corner[h];

        /* Roots are the least of their set: what they are named is known before the others need it. */
        if (root != h && positions != NULL) w->corner[h] = w->corner[root];
        if (root != h) continue;
        if (seen[v] == 0) {
            seen[v] = 1;
            continue;
        }
        w->report->split += seen[v] == 1 && positions == NULL;
        seen[v] = 2;
        if (positions != NULL) {
            memcpy((uint8_t *)positions + (vertices + more) * bytes, (uint8_t *)positions + v * bytes, bytes);
            w->corner[h] = (uint32_t)(vertices + more);
        }
        more++;
    }
    return more;
}

static bvx_status split_vertices(sheet_work *w, bvxi_sheets *sheets)
{
    uint64_t const vertices = w->view->vertex_count;
    uint32_t const type = bvxi_view_type(w->view);
    size_t const bytes = type == BVX_F64 ? 24 : 12;
    uint8_t *seen;

    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_SCRATCH, vertices, "the vertices of fans", &seen));
    uint64_t const more = name_corners(w, seen, NULL, bytes);
    if (more != 0) {
        BVXI_TRY(bvxi_alloc(w->ctx, BVXI_SCRATCH, (vertices + more) * bytes, "the positions of fans",
                            &sheets->positions));
        for (uint64_t v = 0; v < vertices; v++)
            if (type == BVX_F64) bvxi_view_position(w->view, v, (double *)sheets->positions + 3 * v);
            else memcpy((uint8_t *)sheets->positions + v * bytes, bvxi_view_position_at(w->view, v), bytes);
        name_corners(w, seen, sheets->positions, bytes);
        w->view->positions = sheets->positions;
        w->view->position_type = type;
        w->view->position_stride = 0;
        w->view->transform = NULL;
        w->view->vertex_count = vertices + more;
        w->view->colours = NULL;
    }
    bvxi_drop(w->ctx, seen);
    return BVX_OK;
}

/* ---- All ---- */

static bvx_status pair_and_split(sheet_work *w, bvxi_sheets *sheets)
{
    if (w->crowded != 0) {
        BVXI_TRY(open_crowd(w));

        /* Those of a patch belong together where as many run up as down; of what remains, all. */
        for (uint64_t m = 0; m < w->crowded; m++) w->crowd[m] = (uint32_t)m;
        BVXI_TRY(sort_crowd(w));
        for (uint64_t m = 0, n, up; m < w->crowded; m += n) {
            n = run_length(w, m, &up);
            for (uint64_t i = m; i < m + n && 2 * up != n; i++) w->patch[w->crowd[i]] = NO_PATCH;
        }

        /* Around the edge; at one angle what closes an inside comes before what opens the next one. */
        for (uint64_t m = 0; m < w->crowded; m++) {
            double const angle = angle_of(w, w->at[m]);
            uint64_t bits;

            memcpy(&bits, &angle, sizeof bits);
            w->order[m] = bits >> ANGLE_ROUNDING << 1 | (uint64_t)!runs_up(w, w->at[m]);
            w->crowd[m] = (uint32_t)m;
        }
        BVXI_TRY(bvxi_radix_sort(w->ctx, w->order, w->crowd, w->crowded));
        BVXI_TRY(sort_crowd(w));
    }
    bvxi_drop(w->ctx, w->link);
    BVXI_TRY(bvxi_alloc(w->ctx, BVXI_SCRATCH, w->triangles * 12, "the corners' vertices", &w->parent));
    pair_edges(w);

    /* Edges whose inside pairs are doubles are paired by their outside. */
    uint64_t doubles = 0;
    for (uint64_t m = 0, n, up; m < w->crowded; m += n) {
        n = run_length(w, m, &up);
        if (2 * up != n || !is_run_double(w, m, n)) continue;
        w->outside[w->crowd[m]] = 1;
        doubles++;
    }
    if (doubles != 0) pair_edges(w);
    report_crowd(w);
    for (uint64_t i = 0, n; i < 3 * w->triangles && w->disputed != 0; i += n) {
        n = edge_halves(w, i);
        if (n == 2 && runs_up(w, w->half[i]) == runs_up(w, w->half[i + 1])) report_cut(w, i);
    }
    if (w->crowded != 0) bvxi_drop(w->ctx, w->order);
    BVXI_TRY(split_vertices(w, sheets));
    bvxi_drop(w->ctx, w->parent);
    return BVX_OK;
}

bvx_status bvxi_sheets_open(bvx_context *ctx, const bvx_mesh_view *mesh, int sources, bvxi_sheets *sheets,
                            bvxi_sheets_report *report)
{
    sheet_work w = {.ctx = ctx, .view = &sheets->view, .report = report};
    sheets->view = *mesh;
    uint64_t const bytes = mesh->triangle_count * (sources ? 24 : 12);
    int32_t const pieces = bvxi_piece_count(mesh->triangle_count, SHEET_GRAIN);
    sheet_weld s = {.mesh = mesh};
    uint64_t different, kept = mesh->triangle_count;
    int dropped = 0;

    BVXI_TRY(bvxi_alloc(w.ctx, BVXI_SCRATCH, bytes, "the welded triangles", &w.corner));
    if (sources) w.source = w.corner + 3 * mesh->triangle_count;
    BVXI_TRY(BVXI_ARRAY(w.ctx, mesh->vertex_count, "the vertices' positions", s.representative));
    BVXI_TRY(bvxi_weld(w.ctx, mesh, s.representative, &different));
    s.corner = w.corner;
    s.source = w.source;
    bvxi_ranges(w.ctx, pieces, mesh->triangle_count, weld_triangles, &s);
    bvxi_drop(w.ctx, s.representative);
    for (int32_t i = 0; i < pieces; i++) dropped |= s.dropped[i];
    if (dropped) kept = drop_where(&w, mesh->triangle_count, NULL);
    w.report->collapsed = mesh->triangle_count - kept;
    w.triangles = kept;

    /* The view keeps the mesh's own positions, by other indices. */
    w.view->indices = w.corner;
    w.view->index_type = BVX_U32;
    w.view->index_stride = 0;

    /* Attributes are those of the mesh's vertices, corners and triangles, which have other numbers here. */
    w.view->normals = NULL;
    w.view->uvs = w.view->uvs2 = NULL;
    w.view->uv_indices = NULL;
    w.view->materials = NULL;
    sheets->corner = w.corner;
    sheets->source = w.source;
    sheets->view.triangle_count = report->triangles = w.triangles;
    return bvxi_progress(ctx, "collapse", 0.01);
}

bvx_status bvxi_sheets_part(bvx_context *ctx, bvxi_sheets *sheets, bvxi_sheets_report *report)
{
    sheet_work w = {.ctx = ctx,
                    .view = &sheets->view,
                    .report = report,
                    .corner = sheets->corner,
                    .source = sheets->source,
                    .triangles = sheets->view.triangle_count};

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w.triangles * 36, "the edges of the mesh", &w.keys));
    w.half = (uint32_t *)(void *)(w.keys + 3 * w.triangles);
    BVXI_TRY(list_edges(&w));
    if (w.crowded + w.disputed != 0) BVXI_TRY(drop_sheet_copies(&w));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w.triangles * 4, "the triangles' patches", &w.link));
    for (uint32_t t = 0; t < w.triangles; t++) w.link[t] = t << 1;
    if (w.crowded + w.disputed != 0) BVXI_TRY(turn_patches(&w));
    BVXI_TRY(pair_and_split(&w, sheets));
    bvxi_drop(ctx, w.keys);

    sheets->view.triangle_count = report->triangles = w.triangles;
    return BVX_OK;
}
