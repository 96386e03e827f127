/* box_tree.h - boxes over triangles that change: eight to a node, level by level, no pointers. Not installed.
 *
 * Source: Kamel, Faloutsos. On Packing R-trees. 1993; boxes only grow between two settings, so a tree is set
 * anew after every halving. The order of the triangles must follow a curve through space. */
#ifndef BVXI_BOX_TREE_H
#define BVXI_BOX_TREE_H

#include "core/simd_shorts.h"
#include "simplify/corners.h"

/* A triangle's area normal faces what it seems to where its largest part is more than so much of the product
 * of two sides, and of a size that products of it do not vanish at. */
#define BVXI_FACING_SINE  1e-5
#define BVXI_FACING_LEAST 1e-140

enum {
    BVXI_BOX_WIDTH = 8,
    BVXI_BOX_LEVELS = 12,
    BVXI_BOX_STACK = BVXI_BOX_WIDTH * BVXI_BOX_LEVELS,
    BVXI_BOX_HIGHEST = 32767
};

/* Whole steps of 1 / 32767 of the mesh's size. Rounding down keeps order: what overlaps, overlaps in steps
 * too. */
typedef struct bvxi_box {
    int16_t low[3], high[3];
} bvxi_box;

/* What triangles face: their normals, made so long that the largest part is 127, lie between both within half
 * a step. */
typedef struct bvxi_box_facing {
    int8_t low[3], high[3];
} bvxi_box_facing;

typedef struct bvxi_box_node {
    int16_t low[3][BVXI_BOX_WIDTH], high[3][BVXI_BOX_WIDTH];
    int8_t facing_low[3][BVXI_BOX_WIDTH], facing_high[3][BVXI_BOX_WIDTH];
} bvxi_box_node;

typedef struct bvxi_box_tree {
    bvxi_box_node *node[BVXI_BOX_LEVELS]; /* node[0][i]: triangles 8i .. 8i + 7; node[l][i]: nodes 8i .. 8i +
                                             7 of level l - 1 */
    uint64_t count[BVXI_BOX_LEVELS];      /* nodes of each level; the last level has one */
    int32_t levels;
    int32_t faces;        /* 1: nodes say what triangles face; 0: nobody asks */
    double low[3], scale; /* steps = (position - low) * scale */
} bvxi_box_tree;

/* Bytes of the nodes of so many triangles. */
uint64_t bvxi_box_tree_bytes(uint64_t triangles);
/* Lay a tree for so many triangles into a block; its nodes are unspecified until bvxi_box_tree_set. */
void bvxi_box_tree_lay_out(bvxi_box_tree *tree, uint64_t triangles, unsigned char *block);
/* All boxes, of a mesh of which no triangle is gone, at most as many as were laid out. */
void bvxi_box_tree_set(bvxi_box_tree *tree, const bvxi_corners *mesh);

/* Positions may leave the mesh's first bounds. */
static inline int16_t bvxi_box_step(const bvxi_box_tree *tree, double position, int axis)
{
    double const x = (position - tree->low[axis]) * tree->scale;
    double const above = x > 0 ? x : 0;
    return (int16_t)(int32_t)(above < BVXI_BOX_HIGHEST ? above : BVXI_BOX_HIGHEST);
}

/* A position in whole steps, as a box that is one point. */
static inline bvxi_box bvxi_box_at(const bvxi_box_tree *tree, const double *p)
{
    bvxi_box box;

    for (int a = 0; a < 3; a++) box.low[a] = box.high[a] = bvxi_box_step(tree, p[a], a);
    return box;
}

/* The box of a triangle's three corners. */
static inline bvxi_box bvxi_box_of(const bvxi_box_tree *tree, const double *a, const double *b,
                                   const double *c)
{
    bvxi_box box;

    for (int i = 0; i < 3; i++) {
        double const low = a[i] < b[i] ? a[i] : b[i], high = a[i] > b[i] ? a[i] : b[i];

        box.low[i] = bvxi_box_step(tree, low < c[i] ? low : c[i], i);
        box.high[i] = bvxi_box_step(tree, high > c[i] ? high : c[i], i);
    }
    return box;
}

static inline void bvxi_box_join(bvxi_box *box, const bvxi_box *other)
{
    for (int i = 0; i < 3; i++) {
        if (other->low[i] < box->low[i]) box->low[i] = other->low[i];
        if (other->high[i] > box->high[i]) box->high[i] = other->high[i];
    }
}

static inline bvxi_box bvxi_box_child(const bvxi_box_node *node, int32_t k)
{
    bvxi_box box;

    for (int a = 0; a < 3; a++) {
        box.low[a] = node->low[a][k];
        box.high[a] = node->high[a][k];
    }
    return box;
}

/* A box to compare eight others with at once. */
typedef struct bvxi_box_query {
    bvxi_shorts low[3], high[3];
} bvxi_box_query;

static inline bvxi_box_query bvxi_box_ask(const bvxi_box *box)
{
    bvxi_box_query q;

    for (int a = 0; a < 3; a++) {
        q.low[a] = bvxi_shorts_all(box->low[a]);
        q.high[a] = bvxi_shorts_all(box->high[a]);
    }
    return q;
}

/* The same of child k of a node. */
static inline bvxi_box_query bvxi_box_ask_child(const bvxi_box_node *node, int32_t k)
{
    bvxi_box const box = bvxi_box_child(node, k);
    return bvxi_box_ask(&box);
}

/* Bit k: child k of the node overlaps the box. */
static inline uint32_t bvxi_box_overlaps(const bvxi_box_node *node, const bvxi_box_query *q)
{
    bvxi_shorts apart = bvxi_shorts_all(0);

    for (int a = 0; a < 3; a++) {
        apart = bvxi_shorts_or(apart, bvxi_shorts_more(bvxi_shorts_load(node->low[a]), q->high[a]));
        apart = bvxi_shorts_or(apart, bvxi_shorts_more(q->low[a], bvxi_shorts_load(node->high[a])));
    }
    return ~bvxi_shorts_bits(apart) & 0xff;
}

static inline void bvxi_box_put(bvxi_box_node *node, int32_t k, const bvxi_box *box)
{
    for (int a = 0; a < 3; a++) {
        node->low[a][k] = box->low[a];
        node->high[a][k] = box->high[a];
    }
}

/* What a triangle with area normal n faces, anything where rounding may
 * have turned it. reach: no less than the product of two of its sides. */
static inline bvxi_box_facing bvxi_box_facing_of(const double n[3], double reach)
{
    double const x = bvxi_absolute(n[0]), y = bvxi_absolute(n[1]), z = bvxi_absolute(n[2]);
    double const largest = x > y ? x > z ? x : z : y > z ? y : z;
    bvxi_box_facing f = {{INT8_MIN, INT8_MIN, INT8_MIN}, {INT8_MAX, INT8_MAX, INT8_MAX}};
    double scale;

    if (!(largest > BVXI_FACING_SINE * reach && largest > BVXI_FACING_LEAST)) return f;
    scale = 127 / largest;
    for (int a = 0; a < 3; a++) f.low[a] = f.high[a] = (int8_t)((int32_t)(n[a] * scale + 127.5) - 127);
    return f;
}

/* The same of three corners. */
static inline bvxi_box_facing bvxi_box_facing_at(const double *a, const double *b, const double *c)
{
    double n[3], u = 0, v = 0;

    for (int i = 0; i < 3; i++) {
        u += bvxi_absolute(b[i] - a[i]);
        v += bvxi_absolute(c[i] - a[i]);
    }
    bvxi_area_normal(a, b, c, n);
    return bvxi_box_facing_of(n, u * v);
}

/* A direction to compare eight facings with at once, in whole numbers whose products with them stay within 16
 * bits. */
typedef struct bvxi_box_direction {
    int16_t along[3];
    int16_t margin; /* more than the product changes by half a step along every axis and rounding */
} bvxi_box_direction;

/* Bit k: all that child k of the node faces has a positive product with the direction for certain. */
static inline uint32_t bvxi_box_faces(const bvxi_box_node *node, const bvxi_box_direction *d)
{
    bvxi_shorts sum = bvxi_shorts_all(0);

    for (int a = 0; a < 3; a++) {
        const int8_t *const least = d->along[a] < 0 ? node->facing_high[a] : node->facing_low[a];
        bvxi_shorts const along = bvxi_shorts_all(d->along[a]);

        sum = bvxi_shorts_add(sum, bvxi_shorts_mul(bvxi_shorts_load_bytes(least), along));
    }
    return bvxi_shorts_bits(bvxi_shorts_more(sum, bvxi_shorts_all(d->margin)));
}

static inline void bvxi_box_put_facing(bvxi_box_node *node, int32_t k, const bvxi_box_facing *facing)
{
    for (int a = 0; a < 3; a++) {
        node->facing_low[a][k] = facing->low[a];
        node->facing_high[a][k] = facing->high[a];
    }
}

/* What adds nothing to what others face. */
static inline bvxi_box_facing bvxi_box_faces_nothing(void)
{
    bvxi_box_facing const facing = {{INT8_MAX, INT8_MAX, INT8_MAX}, {INT8_MIN, INT8_MIN, INT8_MIN}};
    return facing;
}

/* A box that overlaps none. */
static inline bvxi_box bvxi_box_none(void)
{
    bvxi_box const box = {{INT16_MAX, INT16_MAX, INT16_MAX}, {INT16_MIN, INT16_MIN, INT16_MIN}};
    return box;
}

/* Triangle t has moved: its box and what it faces are replaced, those above
 * grow. Without tree->faces facing is not looked at. */
void bvxi_box_tree_move(bvxi_box_tree *tree, int32_t t, const bvxi_box *box, const bvxi_box_facing *facing);
/* Triangle t is gone: no box finds it any more. */
void bvxi_box_tree_remove(bvxi_box_tree *tree, int32_t t);

#endif
