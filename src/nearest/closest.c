/* closest.c - the search for the closest point of a mesh.
 *
 * Depth first from the root, two levels of boxes at a time, nearer boxes first, with a stack of fixed size. A
 * box is dropped only when it lies further than the best distance so far by a margin above all rounding of
 * boxes and triangles. Triangles wait until there are four, which are looked at together.
 * Guarantee: the answer is exactly the least (distance2, triangle index) of bvxi_closest_on_triangle over
 * all triangles, whatever the tree, the hint and the vectors of the machine. */
#include "nearest/closest.h"
#include "bits/bits.h"
#include "nearest/point_triangle_four.h"

#include <math.h>

enum {
    CLOSEST_SIXTEEN = BVXI_CLOSEST_WIDTH * BVXI_CLOSEST_WIDTH, /* boxes that are looked at together */
    CLOSEST_SORTED = 64, /* boxes up to which all that wait are in order */
    CLOSEST_STACK = CLOSEST_SORTED + (BVXI_CLOSEST_LEVELS / 2 + 1) * CLOSEST_SIXTEEN
};

typedef struct closest_search {
    const bvxi_closest_tree *tree;
    const double *point;
    double at[3];  /* the point in box units */
    float at_f[3]; /* the same, when is_near */
    int is_near;   /* floats are good enough to distinguish boxes */
    double margin; /* above all rounding [Units: box] */
    double limit;  /* boxes beyond this squared distance cannot matter [Units: box^2] */
    bvxi_closest *best;
    int32_t waiting; /* triangles, by their places on the curve */
    uint32_t wait[4];
} closest_search;

typedef struct closest_visit {
    double distance2;
    int32_t level;
    uint32_t node; /* in its level */
} closest_visit;

/* The triangle at a place of the curve lies so far off. */
static inline void take_closest(closest_search *s, uint32_t place, double distance2)
{
    if (distance2 > s->best->distance2) return;
    uint32_t const number = s->tree->order[place];
    /* Equal distances are the rule, at edges and vertices: the lowest index decides for any tree. */
    if (distance2 == s->best->distance2 && number >= s->best->triangle) return;
    s->best->distance2 = distance2;
    s->best->triangle = number;
    s->best->place = place;

    /* Limits are of boxes, whose units and rounding are not those of triangles. */
    double const d = sqrt(s->best->distance2) * s->tree->box_scale + s->margin;
    s->limit = d * d;
}

static void try_closest_triangle(closest_search *s, uint32_t place)
{
    double t[3][3], q[3];
    bvxi_closest_corners(s->tree, place, t);
    take_closest(s, place, bvxi_closest_on_triangle(s->point, (const double(*)[3])t, q));
}

/* In doubles, where the point is far off. */
static uint32_t far_distances_of_sixteen(const bvxi_closest_node *node, int children, const double at[3],
                                         double limit, double d[CLOSEST_SIXTEEN])
{
    uint32_t bits = 0;

    /* Sixteen boxes a call, as the quick way takes them, so that both walk the tree alike. */
    for (int k = 0; k < BVXI_CLOSEST_WIDTH * children; k++) {
        d[k] = 0.0;
        for (int a = 0; a < 3; a++) {
            double const low = (double)node[k / BVXI_CLOSEST_WIDTH].low[a][k % BVXI_CLOSEST_WIDTH];
            double const high = (double)node[k / BVXI_CLOSEST_WIDTH].high[a][k % BVXI_CLOSEST_WIDTH];
            double const out = at[a] < low ? low - at[a] : at[a] > high ? at[a] - high : 0.0;
            d[k] += out * out;
        }
        bits |= (uint32_t)(d[k] <= limit) << k;
    }
    return bits;
}

#define BVXI_SIMD_LEVEL _base
#include "nearest/closest_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/closest_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_closest_find(const bvxi_closest_tree *tree, const double point[3], uint32_t hint,
                       bvxi_closest *found)
{
    closest_search s = {.tree = tree, .point = point, .best = found};
    double t[3][3];

    /* Where the search begins. In floats, rounding of the point and of the boxes' distances is below 16
     * units of 2^-24 of 1 + the point's distance from the centre; in doubles all rounding, also that of
     * triangles, is below 2^-46 of it. The margins are twice that. */
    double reach = 0.0;
    /* The farthest axis bounds what rounding can do to any of the three. */
    for (int a = 0; a < 3; a++) {
        double const x = (point[a] - tree->centre[a]) * tree->box_scale;
        reach = x > reach ? x : -x > reach ? -x : reach;
        s.at[a] = x;
    }
    /* Floats halve the memory of boxes and double the width of vectors; far off they round too much. */
    s.is_near = reach <= 64.0;
    for (int a = 0; a < 3; a++) s.at_f[a] = s.is_near ? (float)s.at[a] : 0.0f;
    s.margin = (1.0 + reach) * (s.is_near ? 0x1p-19 : 0x1p-45);

    found->distance2 = HUGE_VAL;
    found->triangle = UINT32_MAX;
    /* A good first guess drops most of the tree at once. It changes the time and nothing else. */
    try_closest_triangle(&s, hint < tree->triangle_count ? hint : 0);
    BVXI_PATH(tree->fast, search_closest_base(&s), search_closest_avx2(&s));
    /* The point itself from one evaluation, to the sign of its zeros. */
    bvxi_closest_corners(tree, found->place, t);
    bvxi_closest_on_triangle(point, (const double(*)[3])t, found->point);
}
