/* sheet_nodes.c - what parts of a sheet over holes are from far off: a ball around each and its area, for
 * parts of loops, loops, and groups of neighbouring loops. sheet.c opens these from the largest on. */
#include "bits/sort.h"
#include "mesh/mesh.h"
#include "winding/turns.h"

/* Sums over all points of i .. j: each of them is in about log2 nodes. */
static void make_node(const bvxi_sheet *s, uint64_t i, uint64_t j, bvxi_sheet_node *node)
{
    bvxi_sheet_walk w;
    uint64_t from, to;

    memset(node, 0, sizeof *node);
    node->radius = bvxi_sheet_enclose(s, NULL, i, j + 1, node->centre);
    w.count = 0;
    /* The same walk as the sums', so that a node is made of the triangles that it stands for. */
    bvxi_sheet_push(&w, i, j);
    while (bvxi_sheet_take(&w, &from, &to)) {
        uint64_t const m = from + (to - from) / 2;
        double n[3];
        if (to - from < 2) continue;
        bvxi_sheet_normal(bvxi_sheet_point(s, from), bvxi_sheet_point(s, m), bvxi_sheet_point(s, to), n);
        for (int a = 0; a < 3; a++) node->normal[a] += n[a];
        node->area += bvxi_vec_length(n);
        bvxi_sheet_push(&w, from, m);
        bvxi_sheet_push(&w, m, to);
    }
}

void bvxi_sheet_close(bvx_context *ctx, bvxi_sheet *sheet)
{
    bvxi_sheet_tree_close(ctx, sheet->tree);
    bvxi_drop(ctx, sheet->group);
    bvxi_drop(ctx, sheet->order);
    bvxi_drop(ctx, sheet->node);
    bvxi_drop(ctx, sheet->point);
    bvxi_holes_close(ctx, &sheet->strips);
    memset(sheet, 0, sizeof *sheet);
}

/* Groups from small to large: a group's halves come after it on the walk, so their list is read backwards. */
static bvx_status group_loops(bvx_context *ctx, bvxi_sheet *s)
{
    uint64_t const loops = s->holes->loops;
    uint64_t *key = NULL, *range = NULL, count = 0, i, j;
    bvxi_sheet_walk w;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, loops * 8, "the holes' places", &key));

    /* Loops that lie near each other become neighbours, so that groups of them are small in space. */
    for (uint32_t l = 0; l < loops; l++) {
        const int32_t *const q = s->xyz + 3 * (uint64_t)s->holes->vertex[bvxi_loop_begin(s->holes, l)];

        /* The place of its first point on a curve: what is near on it is near in space. */
        key[l] = 0;
        for (int a = 0; a < 3; a++)
            key[l] |= bvxi_curve_spread((uint32_t)(q[a] + (1 << 30)) >> 10) << (2 - a);
        s->order[l] = l;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, key, s->order, loops));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, loops * 16, "the groups of holes", &range));
    w.count = 0;
    if (loops > 0) bvxi_sheet_push(&w, 0, loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        if (j - i < 2) continue;
        range[2 * count] = i;
        range[2 * count++ + 1] = j;
        bvxi_sheet_push(&w, i, i + (j - i) / 2);
        bvxi_sheet_push(&w, i + (j - i) / 2, j);
    }
    /* Backwards: both halves of a group stand after it, so they are done. */
    while (count-- > 0) {
        uint64_t const m = range[2 * count] + (range[2 * count + 1] - range[2 * count]) / 2;
        const bvxi_sheet_node *const a = bvxi_sheet_group(s, range[2 * count], m);
        const bvxi_sheet_node *const b = bvxi_sheet_group(s, m, range[2 * count + 1]);
        bvxi_sheet_node *const both = &s->group[m];

        memset(both, 0, sizeof *both);
        for (int k = 0; k < 3; k++) both->normal[k] = a->normal[k] + b->normal[k];
        both->area = a->area + b->area;
        both->radius = bvxi_sheet_join_balls(a->centre, a->radius, b->centre, b->radius, both->centre);
    }
    return BVX_OK;
}

static void fill_sheet(bvxi_sheet *s)
{
    uint64_t begin = 0;

    /* Points as doubles once: every sum reads them again and again. */
    for (uint64_t i = 0; i < 3 * s->holes->points; i++)
        s->point[i] = (double)s->xyz[3 * (uint64_t)s->holes->vertex[i / 3] + i % 3] * s->scale[i % 3];
    for (uint64_t l = 0; l < s->holes->loops; begin = s->holes->loop_end[l++]) {
        bvxi_sheet_walk w;
        uint64_t i, j;
        w.count = 0;
        bvxi_sheet_push(&w, begin, s->holes->loop_end[l] - 1);
        while (bvxi_sheet_take(&w, &i, &j)) {
            uint64_t const m = i + (j - i) / 2;
            /* A node for each part of three points and more, at its middle point. */
            if (j - i < 2) continue;
            make_node(s, i, j, &s->node[m]);
            bvxi_sheet_push(&w, i, m);
            bvxi_sheet_push(&w, m, j);
        }
    }
}

bvx_status bvxi_sheet_open(bvx_context *ctx, const bvxi_holes *holes, const bvxi_snapped *snapped,
                           const bvx_lattice *lattice, bvxi_sheet *sheet)
{
    double const largest = bvxi_largest_spacing(lattice);

    memset(sheet, 0, sizeof *sheet);
    sheet->xyz = snapped->xyz;
    sheet->fraction_bits = lattice->fraction_bits;
    sheet->fast = bvxi_cpu(ctx) == BVX_CPU_AVX2;

    /* In units of the largest spacing, so that distances are true and numbers near 1. */
    for (int a = 0; a < 3; a++) {
        sheet->step[a] = lattice->spacing[a] / largest;
        sheet->scale[a] = sheet->step[a] / (double)(1 << lattice->fraction_bits);
    }
    BVXI_TRY(bvxi_holes_strips(ctx, holes, snapped, sheet->scale, &sheet->strips));
    if (sheet->strips.loops > 0) holes = &sheet->strips;
    sheet->holes = holes;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, holes->points * 24, "the holes' points", &sheet->point));
    BVXI_TRY(BVXI_ARRAY(ctx, holes->points, "the sheet over the holes", sheet->node));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, holes->loops * 4, "the holes' order", &sheet->order));
    BVXI_TRY(BVXI_ARRAY(ctx, holes->loops, "the groups of holes", sheet->group));
    fill_sheet(sheet);
    BVXI_TRY(BVXI_SCOPE(ctx, group_loops(ctx, sheet)));
    return bvxi_sheet_tree_open(ctx, sheet, &sheet->tree);
}
