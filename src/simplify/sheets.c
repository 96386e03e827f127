/* sheets.c - triangles as files have them made ready to be simplified as sheets: each once, turned one way.
 *
 * Triangles that share an edge with each other alone hang together; a union of sets with parity (Tarjan.
 * Efficiency of a Good But Not Linear Set Union Algorithm. 1975) finds which of them are turned against the
 * first one, and the fewer of each patch are turned. What is oriented already is left alone. */
#include "mesh/pieces.h"
#include "mesh/radix.h"
#include "mesh/view.h"
#include "simplify/levels.h"

/* ---- Patches ---- */

/* Of each triangle: another one of its patch of lower index, or itself, and 1 where it is turned against that. */
typedef struct sheet_sets {
    uint32_t *parent;
    uint8_t *turned;
} sheet_sets;

/* The first triangle of a patch; *turned becomes 1 when t is turned against it. Paths are halved on the way. */
static uint32_t first_of_sheet(const sheet_sets *p, uint32_t t, uint8_t *turned)
{
    uint8_t sum = 0;

    while (p->parent[t] != t) {
        uint32_t const above = p->parent[t];

        p->turned[t] ^= p->turned[above];
        p->parent[t] = p->parent[above];
        sum ^= p->turned[t];
        t = p->parent[t];
    }
    *turned = sum;
    return t;
}

/* Two triangles of one edge; against: they run along it in the same direction. */
static void join_sheets(const sheet_sets *p, uint32_t s, uint32_t t, uint8_t against)
{
    uint8_t s_turned, t_turned;
    uint32_t const a = first_of_sheet(p, s, &s_turned), b = first_of_sheet(p, t, &t_turned);
    uint32_t const low = a < b ? a : b, high = a < b ? b : a;

    if (a == b) return;
    p->parent[high] = low;
    p->turned[high] = s_turned ^ t_turned ^ against;
}

/* 1 when half edge i (3 * triangle + k: from corner k to the next) runs from the lower vertex to the higher. */
static int runs_up(const uint32_t *corner, uint32_t i)
{
    return corner[i] < corner[i / 3 * 3 + (i + 1) % 3];
}

/* Half edges sorted by their edges. keys and halves [Size: triangles * 3]. */
static bvx_status sort_halves(bvx_context *ctx, const uint32_t *corner, uint64_t triangles, uint64_t *keys,
                              uint32_t *halves)
{
    uint64_t const n = 3 * triangles;

    for (uint32_t i = 0; i < n; i++) {
        uint64_t const a = corner[i], b = corner[i / 3 * 3 + (i + 1) % 3];

        keys[i] = a < b ? a << 32 | b : b << 32 | a;
        halves[i] = i;
    }
    return bvxi_radix_sort(ctx, keys, halves, n);
}

/* The end of the half edges of one edge, which begin at i. */
static uint64_t end_of_edge(const uint64_t *keys, uint64_t n, uint64_t i)
{
    uint64_t next = i + 1;

    while (next < n && keys[next] == keys[i]) next++;
    return next;
}

static void find_sheets(const uint32_t *corner, const uint64_t *keys, const uint32_t *halves, uint64_t n,
                         const sheet_sets *p)
{
    uint64_t next;

    for (uint64_t i = 0; i < n; i = next) {
        next = end_of_edge(keys, n, i);
        if (next - i == 2)
            join_sheets(p, halves[i] / 3, halves[i + 1] / 3,
                         runs_up(corner, halves[i]) == runs_up(corner, halves[i + 1]));
    }
}

/* Count edges that are no part of a sheet nor its border: of three triangles, or where a band with one side has
 * to end. The half edges are sorted; two that run the same way did so before triangles were turned, or do now. */
static void find_refused(const uint64_t *keys, const uint32_t *halves, uint64_t n, const uint32_t *corner,
                         const sheet_sets *p, bvxi_sheets_report *report)
{
    uint64_t next;

    for (uint64_t i = 0; i < n; i = next) {
        uint8_t one = 0, other = 0;

        next = end_of_edge(keys, n, i);
        if (next - i == 1) continue;
        if (next - i == 2) {
            first_of_sheet(p, halves[i] / 3, &one);
            first_of_sheet(p, halves[i + 1] / 3, &other);
            if ((runs_up(corner, halves[i]) == runs_up(corner, halves[i + 1])) == (one != other)) continue;
        }
        if (report->refused++ != 0) continue;
        report->edge[0] = (uint32_t)(keys[i] >> 32);
        report->edge[1] = (uint32_t)keys[i];
    }
}

/* Turn the fewer triangles of each patch; count [Size: triangles * 2] is scratch. Returns how many. */
static uint64_t turn_fewer_triangles(const sheet_sets *p, uint32_t *corner, uint64_t triangles, uint32_t *count)
{
    uint64_t turned_triangles = 0;
    uint8_t turned;

    memset(count, 0, (size_t)triangles * 2 * sizeof *count);
    for (uint32_t t = 0; t < triangles; t++) {
        uint32_t const first = first_of_sheet(p, t, &turned);
        count[2 * (uint64_t)first + turned]++;
    }
    for (uint32_t t = 0; t < triangles; t++) {
        uint64_t const first = first_of_sheet(p, t, &turned);
        uint32_t const swap = corner[3 * (uint64_t)t + 1];

        if (turned == (count[2 * first + 1] > count[2 * first])) continue;
        corner[3 * (uint64_t)t + 1] = corner[3 * (uint64_t)t + 2];
        corner[3 * (uint64_t)t + 2] = swap;
        turned_triangles++;
    }
    return turned_triangles;
}

static bvx_status orient_sheets(bvx_context *ctx, uint32_t *corner, uint64_t triangles,
                                 bvxi_sheets_report *report)
{
    uint64_t const bytes = triangles * 41;
    unsigned char *block;
    bvx_status status;
    uint64_t *keys;
    uint32_t *halves;
    sheet_sets p;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the sheet_sets of the mesh", &block));
    keys = (uint64_t *)(void *)block;
    halves = (uint32_t *)(void *)(keys + 3 * triangles);
    p.parent = halves + 3 * triangles;
    p.turned = (uint8_t *)(p.parent + triangles);
    for (uint32_t t = 0; t < triangles; t++) p.parent[t] = t;

    status = sort_halves(ctx, corner, triangles, keys, halves);
    if (status == BVX_OK) {
        find_sheets(corner, keys, halves, 3 * triangles, &p);
        find_refused(keys, halves, 3 * triangles, corner, &p, report);
        report->turned = turn_fewer_triangles(&p, corner, triangles, halves);
    }
    bvxi_free(ctx, block, bytes);
    return status;
}

/* ---- Doubles ---- */

/* Triangles that are there twice, as sheets with two sides have them, count once. */
static bvx_status drop_doubles(bvx_context *ctx, bvx_mesh_view *welded, uint32_t *corner)
{
    uint64_t const triangle_bytes = welded->triangle_count * 12, vertex_bytes = welded->vertex_count * 4;
    uint32_t *kept, *same = NULL;
    uint64_t count = 0;
    bvx_status status;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, triangle_bytes, "the triangles without doubles", &kept));
    status = bvxi_alloc(ctx, BVXI_SCRATCH, vertex_bytes, "the vertices of triangles without doubles", &same);
    if (status == BVX_OK) {
        for (uint64_t v = 0; v < welded->vertex_count; v++) same[v] = (uint32_t)v;
        status = bvxi_drop_duplicates(ctx, welded, same, kept, &count);
    }
    if (status == BVX_OK) {
        memcpy(corner, kept, (size_t)count * 12);
        welded->triangle_count = count;
    }
    bvxi_free(ctx, same, vertex_bytes);
    bvxi_free(ctx, kept, triangle_bytes);
    return status;
}

bvx_status bvxi_sheets_prepare(bvx_context *ctx, bvx_mesh_view *welded, uint32_t *corner,
                               bvxi_sheets_report *report)
{
    uint64_t const triangles = welded->triangle_count;

    memset(report, 0, sizeof *report);
    BVXI_TRY(drop_doubles(ctx, welded, corner));
    report->doubles = triangles - welded->triangle_count;
    return orient_sheets(ctx, corner, welded->triangle_count, report);
}
