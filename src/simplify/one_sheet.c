/* one_sheet.c - a collapse that cannot cross anything, since all that is near faces one way.
 *
 * Source: Volino, Magnenat-Thalmann. Efficient Self-Collision Detection on Smoothly Discretized Surface
 * Animations Using Geometrical Shape Regularity. 1994, who look at one patch; here closedness stands in for
 * the patch's outline.
 *
 * Let a surface be closed, of one piece and without crossings: then it parts space in two, and a line crosses
 * it from inside and from outside in turns. Let C be a convex region, here the box of the old star and the
 * new one, and d a direction that every triangle that meets C has a positive normal along. Two crossings of a
 * line along d that follow each other in C would both lead to the same side: so there is one at most, and
 * seen along d nothing in C hides anything else in it.
 *
 * So the old star is seen as the inside of a polygon, the link, which does not cross itself; and so is the
 * new one, whose triangles all face d, too: a map that turns nothing and takes the border to a simple polygon
 * covers its inside once. What else meets C is seen outside of that polygon, before the collapse and after.
 * So the new triangles meet nothing else but in the link, where the old ones met it in what they shared, nor
 * each other.
 *
 * What a node's triangles face is known in whole steps, which widen it by rounding; normals of needles, which
 * rounding may turn, count as facing anything. Guarantee: sufficient, not necessary: what is refused here is
 * tested pair by pair. */
#include "bits/bits.h"
#include "simplify/star.h"

enum {
    DIRECTION_MOST = 63 /* products with facings stay within 16 bits */
};

/* No less than the distance between two positions. */
static double length_bound(const double *a, const double *b)
{
    return bvxi_absolute(b[0] - a[0]) + bvxi_absolute(b[1] - a[1]) + bvxi_absolute(b[2] - a[2]);
}

/* What each new triangle faces, and the sum; 0 when one may face anything. */
static int gather_faces(const bvxi_corners *m, bvxi_star *star, int32_t sum[3])
{
    double from = length_bound(star->p, bvxi_corner_position(m, star->link[0]));
    int known = 1;

    sum[0] = sum[1] = sum[2] = 0;
    for (int32_t i = 0; i < star->count; i++) {
        double const to = length_bound(star->p, bvxi_corner_position(m, star->link[i + 1]));
        bvxi_box_facing const f = bvxi_box_facing_of(star->normal[i], from * to);

        /* The facing of a needle is a range: it may face anything, and nothing is known of the sum. */
        known &= f.low[0] == f.high[0];
        for (int k = 0; k < 3; k++) sum[k] += f.low[k];
        star->faces[i] = f;
        from = to;
    }
    return known;
}

static int32_t size_of_step(int32_t x)
{
    return x < 0 ? -x : x;
}

/* A direction that all new triangles face for certain; 0: none was found. */
static int face_together(const bvxi_corners *m, bvxi_star *star, bvxi_box_direction *d)
{
    int32_t sum[3], largest = 0, size = 0;
    int together = gather_faces(m, star, sum);

    for (int k = 0; k < 3; k++)
        if (size_of_step(sum[k]) > largest) largest = size_of_step(sum[k]);
    if (!together || largest == 0) return 0;

    /* The sum is what most of them face. Scaled so that products with facings stay within 16 bits. */
    for (int k = 0; k < 3; k++) {
        d->along[k] = (int16_t)(sum[k] * DIRECTION_MOST / largest);
        size += size_of_step(d->along[k]);
    }

    /* Facings are known to half a step along each axis; a product must be beyond what that may add. */
    d->margin = (int16_t)(size * 17 / 32 + 1);
    for (int32_t i = 0; i < star->count; i++) {
        const int8_t *const n = star->faces[i].low;

        together &= n[0] * d->along[0] + n[1] * d->along[1] + n[2] * d->along[2] > d->margin;
    }
    return together;
}

/* 1 when every triangle whose box meets the region faces the direction. */
static int region_faces(const bvxi_box_tree *tree, const bvxi_box *region, const bvxi_box_direction *d)
{
    bvxi_box_query const query = bvxi_box_ask(region);
    uint64_t stack[BVXI_BOX_STACK]; /* level in the low bits */
    int32_t depth = 0;

    stack[depth++] = (uint64_t)(tree->levels - 1);
    while (depth > 0) {
        uint64_t const top = stack[--depth], index = top >> 4;
        int32_t const level = (int32_t)(top & 15);
        const bvxi_box_node *const node = &tree->node[level][index];
        uint32_t bits = bvxi_box_overlaps(node, &query) & ~bvxi_box_faces(node, d);

        /* Only children that meet the region and may face elsewhere are left; of triangles one is enough. */
        if (bits != 0 && level == 0) return 0;
        for (; bits != 0; bits &= bits - 1) {
            uint64_t const child = index * BVXI_BOX_WIDTH + (uint64_t)bvxi_lowest(bits);

            BVXI_PREFETCH(&tree->node[level - 1][child]);
            BVXI_PREFETCH(&tree->node[level - 1][child].high[0]);
            stack[depth++] = child << 4 | (uint64_t)(level - 1);
        }
    }
    return 1;
}

int bvxi_star_is_one_sheet(const bvxi_corners *m, const bvxi_box_tree *tree, bvxi_star *star,
                           const bvxi_box *box)
{
    bvxi_box const u = bvxi_box_at(tree, bvxi_corner_position(m, star->u));
    bvxi_box const v = bvxi_box_at(tree, bvxi_corner_position(m, star->v));
    bvxi_box region = *box;
    bvxi_box_direction d;

    if (!face_together(m, star, &d)) return 0;
    bvxi_box_join(&region, &u);
    bvxi_box_join(&region, &v);
    if (!region_faces(tree, &region, &d)) return 0;

    /* All triangles around the new vertex and around those of the link are side by side along d. */
    for (int k = 0; k < 3; k++) star->own_facing.along[k] = (float)d.along[k];
    for (int32_t i = 0; i < star->count; i++) star->facing[i] = star->own_facing;
    return 1;
}
