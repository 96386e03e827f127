/* closest.c - the search for the closest point of a mesh.
 *
 * Depth first from the root, nearer boxes first, with a stack of fixed size. A box is dropped only when it lies further
 * than the best distance so far by a margin above all rounding of boxes and triangles. So the answer is exactly the
 * least (distance2, triangle number) of bvxi_closest_on_triangle over all triangles, whatever the tree and the hint. */
#include "mesh/closest.h"

#include <math.h>

typedef struct closest_search {
    const bvxi_closest_tree *tree;
    const double *point;
    double at[3];   /* the point in box units */
    float at_f[3];  /* the same, when is_near */
    int is_near;    /* floats are good enough to tell boxes apart */
    double margin;  /* above all rounding [Units: box] */
    double limit;   /* boxes beyond this squared distance cannot matter [Units: box^2] */
    bvxi_closest *best;
} closest_search;

typedef struct closest_visit {
    double distance2;
    int32_t level;
    uint64_t node; /* in its level */
} closest_visit;

static void set_closest_limit(closest_search *s)
{
    double const d = sqrt(s->best->distance2) * s->tree->box_scale + s->margin;
    s->limit = d * d;
}

static void try_closest_triangle(closest_search *s, uint64_t place)
{
    uint32_t const number = s->tree->order[place];
    double t[3][3], q[3], d;
    bvxi_closest_corners(s->tree, place, t);
    d = bvxi_closest_on_triangle(s->point, (const double(*)[3])t, q);
    if (d > s->best->distance2 || (d == s->best->distance2 && number >= s->best->triangle)) return;
    s->best->distance2 = d;
    s->best->triangle = number;
    s->best->place = (uint32_t)place;
    memcpy(s->best->point, q, sizeof q);
    set_closest_limit(s);
}

static inline float nearest_in_interval(float x, float low, float high)
{
    float const y = low > x ? low : x;
    return y < high ? y : high;
}

/* Squared distances to four boxes in floats, written so that compilers turn it into vectors. */
static void closest_box_distances_near(const bvxi_closest_node *node, const float at[3], double d[BVXI_CLOSEST_WIDTH])
{
    float sum[BVXI_CLOSEST_WIDTH];
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++) {
        float const x = at[0] - nearest_in_interval(at[0], node->low[0][k], node->high[0][k]);
        float const y = at[1] - nearest_in_interval(at[1], node->low[1][k], node->high[1][k]);
        float const z = at[2] - nearest_in_interval(at[2], node->low[2][k], node->high[2][k]);
        sum[k] = x * x + y * y + z * z;
    }
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++) d[k] = (double)sum[k];
}

static void closest_box_distances(const bvxi_closest_node *node, const double at[3], double d[BVXI_CLOSEST_WIDTH])
{
    for (int k = 0; k < BVXI_CLOSEST_WIDTH; k++) {
        d[k] = 0.0;
        for (int a = 0; a < 3; a++) {
            double const low = (double)node->low[a][k], high = (double)node->high[a][k];
            double const out = at[a] < low ? low - at[a] : at[a] > high ? at[a] - high : 0.0;
            d[k] += out * out;
        }
    }
}

/* Where the search begins. In floats, rounding of the point and of the boxes' distances is below 16 units of 2^-24 of
 * 1 + the point's distance from the centre; in doubles all rounding, also that of triangles, is below 2^-46 of it.
 * The margins are twice that. */
static void begin_closest_search(const bvxi_closest_tree *tree, const double point[3], closest_search *s)
{
    double reach = 0.0;
    for (int a = 0; a < 3; a++) {
        double const x = (point[a] - tree->centre[a]) * tree->box_scale;
        reach = x > reach ? x : -x > reach ? -x : reach;
        s->at[a] = x;
    }
    s->is_near = reach <= 8.0;
    for (int a = 0; a < 3; a++) s->at_f[a] = s->is_near ? (float)s->at[a] : 0.0f;
    s->margin = (1.0 + reach) * (s->is_near ? 0x1p-19 : 0x1p-45);
}

void bvxi_closest_find(const bvxi_closest_tree *tree, const double point[3], uint32_t hint, bvxi_closest *found)
{
    closest_search s = {tree, point, {0.0, 0.0, 0.0}, {0.0f, 0.0f, 0.0f}, 0, 0.0, 0.0, found};
    closest_visit stack[BVXI_CLOSEST_LEVELS * BVXI_CLOSEST_WIDTH];
    double d[BVXI_CLOSEST_WIDTH];
    int used = 1;
    begin_closest_search(tree, point, &s);
    found->distance2 = HUGE_VAL;
    found->triangle = UINT32_MAX;
    try_closest_triangle(&s, hint < tree->triangle_count ? hint : 0);
    stack[0].distance2 = 0.0;
    stack[0].level = tree->level_count - 1;
    stack[0].node = 0;
    while (used > 0) {
        closest_visit const v = stack[--used];
        if (v.distance2 > s.limit) continue;
        const bvxi_closest_node *const node = &tree->nodes[tree->level_first[v.level] + v.node];
        if (s.is_near) closest_box_distances_near(node, s.at_f, d);
        else closest_box_distances(node, s.at, d);
        uint64_t const first = v.node * BVXI_CLOSEST_WIDTH;
        if (v.level == 0) {
            int const n = bvxi_closest_children(tree->triangle_count, first);
            for (int k = 0; k < n; k++)
                if (d[k] <= s.limit) try_closest_triangle(&s, first + (uint64_t)k);
            continue;
        }
        int const n = bvxi_closest_children(tree->level_nodes[v.level - 1], first), bottom = used;
        for (int k = 0; k < n; k++) { /* the nearest on top */
            int i = used;
            if (d[k] > s.limit) continue;
            for (; i > bottom && stack[i - 1].distance2 < d[k]; i--) stack[i] = stack[i - 1];
            stack[i].distance2 = d[k];
            stack[i].level = v.level - 1;
            stack[i].node = first + (uint64_t)k;
            used++;
        }
    }
}
