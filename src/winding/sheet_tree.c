/* sheet_tree.c - cells within cells of a sheet's triangles, with their moments; the angle of all from one
 * place.
 *
 * Sources: Barill, Dickson, Schmidt, Levin, Jacobson. Fast Winding Numbers for Soups and Clouds. 2018
 * (moments of triangles' areas); Lauterbach, Garland, Sengupta, Luebke, Manocha. Fast BVH Construction on
 * GPUs. 2009 (cells are cut where the places' Morton numbers differ first); Radon. Zur mechanischen Kubatur.
 * 1948 (seven points for the moments of a triangle).
 *
 * Where all triangles of a mesh hang loose each is a hole of its own, and the sheet is these triangles once
 * more: its loops have nothing to tell then, and groups of them are many. */
#include "bits/sort.h"
#include "mesh/mesh.h"
#include "winding/turns.h"

#include <math.h>

enum { TREE_LEAF = 8, TREE_EXACT = 256, TREE_STACK = 128, TREE_NEAR = 256 };
/* a tree from so many loops on, of so few points on average */
enum { TREE_LOOPS = 256, TREE_LOOP_POINTS = 16 };

/* ---- Triangles in order ---- */

static void shape_triangle(const bvxi_sheet *s, const uint32_t *corner, bvxi_sheet_shape *shape)
{
    double longest = -1, n[3];
    for (uint32_t k = 0; k < 3; k++) {
        double const length = bvxi_sheet_distance(bvxi_sheet_point(s, corner[k]),
                                                  bvxi_sheet_point(s, corner[(k + 1) % 3]));
        if (length <= longest) continue;
        longest = length;
        shape->side = k;
    }
    bvxi_sheet_normal(bvxi_sheet_point(s, corner[0]), bvxi_sheet_point(s, corner[1]),
                      bvxi_sheet_point(s, corner[2]), n);
    shape->area = bvxi_vec_length(n);
    shape->width = longest > 0 ? 2 * shape->area / longest * (1 + 1e-9) : 0;
}

/* keys: sorted. */
static bvx_status order_sheet(bvx_context *ctx, const bvxi_sheet *s, bvxi_sheet_tree *tree, uint64_t *keys)
{
    uint64_t const count = tree->triangles;
    uint32_t *number = NULL, *listed = NULL;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 4, "the sheet's order", &number));

    /* The triangles' own order is by loops; by place, near ones become neighbours. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 12, "the sheet's triangles as they come", &listed));
    bvxi_sheet_triangles(s->holes, listed);
    for (uint64_t t = 0; t < count; t++) {
        /* The place of a triangle's middle on a curve. */
        const uint32_t *const corner = listed + 3 * t;
        uint64_t key = 0;
        for (int a = 0; a < 3; a++) {
            /* Corners are within 2^30 of 0; the sum is moved up so that it is not negative. */
            int64_t sum = (int64_t)3 << 30;
            for (int k = 0; k < 3; k++)
                sum += s->xyz[3 * (uint64_t)s->holes->vertex[corner[k]] + (uint64_t)a];
            key |= bvxi_curve_spread((uint64_t)(sum / 3) >> 10) << (2 - a);
        }
        keys[t] = key;

        number[t] = (uint32_t)t;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, keys, number, count));
    for (uint64_t t = 0; t < count; t++) {
        memcpy(tree->corner + 3 * t, listed + 3 * (uint64_t)number[t], 12);
        shape_triangle(s, tree->corner + 3 * t, tree->shape + t);
    }
    return BVX_OK;
}

/* ---- Cells ---- */

/* Where the first bit that not all keys share becomes 1; halfway where they share all. */
static uint32_t cut_keys(const uint64_t *keys, uint32_t first, uint32_t end)
{
    uint64_t differ = keys[first] ^ keys[end - 1];
    uint32_t low = first, high = end - 1; /* 0 at low, 1 at high */
    if (differ == 0) return first + (end - first) / 2;
    /* Only the highest bit that differs is kept; keys are sorted, so it is 0 first and then 1. */
    while ((differ & (differ - 1)) != 0) differ &= differ - 1;
    while (high - low > 1) {
        uint32_t const middle = low + (high - low) / 2;
        if ((keys[middle] & differ) != 0) high = middle;
        else low = middle;
    }
    return high;
}

/* Cells are numbered as they are met from the whole down, earlier halves first; kept where there is room. */
static void cut_sheet_cells(const uint64_t *keys, bvxi_sheet_tree *tree)
{
    uint32_t first[TREE_STACK], end[TREE_STACK], parent[TREE_STACK];
    int32_t count = 1;

    first[0] = 0;
    end[0] = (uint32_t)tree->triangles;
    parent[0] = 0;
    tree->cells = tree->pendings = 0;
    while (count-- > 0) {
        uint32_t const from = first[count];
        uint32_t const to = end[count];
        uint32_t const up = parent[count];
        uint32_t const number = (uint32_t)tree->cells++;
        int const leaf = to - from <= TREE_LEAF;
        /* The first walk only counts, as there is no memory for cells yet. */
        if (tree->cell != NULL) {
            tree->cell[number].first = from;
            tree->cell[number].end = to;
            tree->cell[number].second = 0;
            if (up != 0) tree->cell[up - 1].second = number;
        }
        tree->pendings += (uint64_t)leaf;
        if (leaf) continue;

        /* Two halves: the second's number is known only when it is met, so its parent gets it then. */
        first[count] = first[count + 1] = from;
        end[count] = end[count + 1] = to;
        first[count] = end[count + 1] = cut_keys(keys, from, to);
        parent[count] = number + 1;
        parent[count + 1] = 0;
        count += 2;
    }
}

static const double *sheet_tree_point(const bvxi_sheet *s, const bvxi_sheet_tree *tree, uint64_t i)
{
    return bvxi_sheet_point(s, tree->corner[i]);
}

/* Radon's seven points of triangle t have its moments up to degree 5. */
static void add_triangle_moments(const bvxi_sheet *s, const bvxi_sheet_tree *tree, uint64_t t,
                                 bvxi_sheet_cell *c)
{
    double const root = sqrt(15.0);
    double const weight[3] = {9.0 / 40, (155 - root) / 1200, (155 + root) / 1200};
    double const side[3] = {1.0 / 3, (6 - root) / 21, (6 + root) / 21};
    const double *const p[3] = {sheet_tree_point(s, tree, 3 * t), sheet_tree_point(s, tree, 3 * t + 1),
                                sheet_tree_point(s, tree, 3 * t + 2)};
    double n[3];

    /* The normal, as long as the area, is what the moments are made of. */
    bvxi_sheet_normal(p[0], p[1], p[2], n);
    c->area += bvxi_vec_length(n);
    /* One point in the middle, three near the corners, three near the sides. */
    for (int i = 0; i < 7; i++) {
        int const kind = i == 0 ? 0 : 1 + (i - 1) / 3, apex = (i + 2) % 3;
        double const w = weight[kind], b = side[kind];
        double at[3], power[BVXI_SERIES_LOCAL];
        for (int a = 0; a < 3; a++)
            at[a] = b * (p[0][a] + p[1][a] + p[2][a]) + (1 - 3 * b) * p[apex][a] - c->centre[a];
        bvxi_series_powers(&tree->table, at, BVXI_SERIES_LOCAL, power);
        for (int a = 0; a < 3; a++) {
            const uint8_t *const sum = tree->table.sum[1 + a];
            for (int k = 0; k < BVXI_SERIES_LOCAL; k++) c->moment[sum[k]] += w * n[a] * power[k];
        }
    }
}

static void fill_sheet_cell(const bvxi_sheet *s, const bvxi_sheet_tree *tree, bvxi_sheet_cell *c)
{
    const bvxi_sheet_cell *half[2];

    c->area = 0;
    memset(c->moment, 0, sizeof c->moment);
    half[0] = c + 1;
    half[1] = tree->cell + c->second;
    /* The smaller ball is dear, so only small cells have it. */
    if (c->end - c->first <= TREE_EXACT)
        c->radius = bvxi_sheet_enclose(s, tree->corner, 3 * (uint64_t)c->first, 3 * (uint64_t)c->end,
                                       c->centre);
    else
        c->radius = bvxi_sheet_join_balls(half[0]->centre, half[0]->radius, half[1]->centre, half[1]->radius,
                                          c->centre);
    if (c->second == 0) {
        for (uint64_t t = c->first; t < c->end; t++) add_triangle_moments(s, tree, t, c);
        return;
    }

    for (int i = 0; i < 2; i++) {
        double v[3];
        for (int a = 0; a < 3; a++) v[a] = half[i]->centre[a] - c->centre[a];
        c->area += half[i]->area;
        bvxi_series_move_moments(&tree->table, half[i]->moment, v, c->moment);
    }
}

void bvxi_sheet_tree_close(bvx_context *ctx, bvxi_sheet_tree *tree)
{
    if (tree == NULL) return;
    bvxi_drop(ctx, tree->cell);
    bvxi_drop(ctx, tree->shape);
    bvxi_drop(ctx, tree->corner);
    bvxi_drop(ctx, tree);
}

bvx_status bvxi_sheet_tree_open(bvx_context *ctx, const bvxi_sheet *sheet, bvxi_sheet_tree **tree)
{
    const bvxi_holes *const holes = sheet->holes;
    bvxi_sheet_tree *t;

    *tree = NULL;
    /* Few or large holes are served better by their own groups. */
    if (holes->loops < TREE_LOOPS || holes->points / holes->loops >= TREE_LOOP_POINTS) return BVX_OK;
    if (holes->points == 2 * holes->loops) return BVX_OK; /* no triangle */
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *t, "the sheet's tree", &t));
    bvxi_series_open(sheet->fast, &t->table);
    t->triangles = holes->points - 2 * holes->loops;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, t->triangles * 12, "the sheet's triangles", &t->corner));
    BVXI_TRY(BVXI_ARRAY(ctx, t->triangles, "the triangles' shapes", t->shape));

    uint64_t const bytes = t->triangles * 8;
    uint64_t *keys = NULL;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the triangles' places", &keys));

    /* Counted first, so that cells are made in their exact number; then the same walk fills them. */
    BVXI_TRY(BVXI_SCOPE(ctx, order_sheet(ctx, sheet, t, keys)));
    cut_sheet_cells(keys, t);
    BVXI_TRY(BVXI_ARRAY(ctx, t->cells, "the sheet's cells", t->cell));
    cut_sheet_cells(keys, t);
    /* Backwards, as halves stand after what they are halves of. */
    for (uint64_t c = t->cells; c-- > 0;) fill_sheet_cell(sheet, t, &t->cell[c]);
    if (sheet->strips.loops > 0) t->pendings = t->triangles;
    bvxi_drop(ctx, keys);

    *tree = t;
    return BVX_OK;
}

/* ---- From one place ---- */

double bvxi_sheet_tree_angle(const bvxi_sheet *s, const int64_t p[3], double q, double *error)
{
    const bvxi_sheet_tree *const tree = s->tree;
    uint32_t stack[TREE_STACK], near[TREE_NEAR];
    int32_t count = 1, nears = 0;
    bvxi_series_parts far = {0};
    double turns = 0, at[3];

    for (int a = 0; a < 3; a++) at[a] = (double)p[a] * s->scale[a];
    *error = 0;
    stack[0] = 0;
    while (count-- > 0) {
        uint32_t const number = stack[count];
        const bvxi_sheet_cell *const c = &tree->cell[number];

        /* Far enough: the moments answer, with the bound on what they leave out. */
        double const r[3] = {c->centre[0] - at[0], c->centre[1] - at[1], c->centre[2] - at[2]};
        double const d2 = r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
        if (c->radius * c->radius < q * q * d2) {
            bvxi_series_put(&tree->table, c->moment, r, 1, &far, &turns);
            *error += c->area * bvxi_series_rest(d2, c->radius / sqrt(d2));
        } else if (c->second != 0) {
            stack[count++] = c->second;
            stack[count++] = number + 1;
        } else {
            /* Cells that are near are gathered, so that their triangles are summed together. */
            near[nears++] = number;
            if (nears < TREE_NEAR) continue;
            bvxi_series_add(&tree->table, &far, 1, &turns);
            turns += bvxi_sheet_cells_angle(s, p, near, TREE_NEAR);
            nears = 0;
        }
    }
    bvxi_series_add(&tree->table, &far, 1, &turns);
    return turns + bvxi_sheet_cells_angle(s, p, near, (uint64_t)nears);
}
