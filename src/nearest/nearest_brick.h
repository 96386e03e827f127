/* nearest_brick.h - the steps of a search for a brick of 4 x 4 x 4 centres: leaves listed for a cell,
 * triangles for eight centres, pairs evaluated together. Not installed. */
#ifndef BVXI_NEAREST_BRICK_H
#define BVXI_NEAREST_BRICK_H

#include "nearest/nearest_tree.h"

/* ---- Pairs of a centre and a triangle, evaluated together ---- */

enum { BVXI_NEAR_PAIRS = 256 };

/* Coordinates in the units of the evaluation, one array each. */
typedef struct bvxi_near_pairs {
    double point[3][BVXI_NEAR_PAIRS], corner[9][BVXI_NEAR_PAIRS];
    double closest[3][BVXI_NEAR_PAIRS], distance2[BVXI_NEAR_PAIRS]; /* filled by bvxi_near_evaluate */
    uint32_t triangle[BVXI_NEAR_PAIRS];
    int32_t slot[BVXI_NEAR_PAIRS]; /* the caller's */
    int32_t count;
} bvxi_near_pairs;

/* Take one more pair; there must be room. Its corners' numbers are requested, as the evaluation comes
 * later. */
static inline void bvxi_near_take_pair(const bvxi_nearest *n, bvxi_near_pairs *p, const double point[3],
                                       uint32_t triangle, int32_t slot)
{
    int32_t const i = p->count++;
    if (n->view.indices != NULL) BVXI_PREFETCH(bvxi_view_index_at(&n->view, triangle));
    p->triangle[i] = triangle;
    p->slot[i] = slot;
    for (int a = 0; a < 3; a++) p->point[a][i] = point[a];
}

/* Closest points and squared distances of all pairs, to the bit those of
 * bvxi_closest_on_triangle (zeros may differ in sign). */
void bvxi_near_evaluate(const bvxi_nearest *n, int32_t fast, bvxi_near_pairs *pairs);

/* ---- What may hold the nearest point of some centre of a cell; triangles that may be nearest to eight
 * centres; the nearest triangles of bricks of 4 x 4 x 4 centres ---- */

/* ---- What may hold the nearest point of some centre of a cell ---- */

enum {
    BVXI_NEAR_BLOCKS = 64,
    BVXI_NEAR_STARTS = 24,
    BVXI_NEAR_STACK = (BVXI_NEAR_LEVELS + BVXI_NEAR_STARTS) * BVXI_NEAR_WIDTH
};

/* The leaves of one node, relative to the cell's origin [Units: box]. */
typedef struct bvxi_near_block {
    /* the leaf's box; its numbers are relative to low */
    float low[3][BVXI_NEAR_WIDTH], high[3][BVXI_NEAR_WIDTH];
    float point[3][BVXI_NEAR_WIDTH]; /* a point of its first triangle */
    uint32_t first;                  /* number of the first leaf */
    uint32_t listed;   /* bit k: leaf first + k may hold the nearest point of some centre of the cell */
    uint32_t spare[6]; /* for alignment */
} bvxi_near_block;

typedef struct bvxi_near_list {
    bvxi_near_block block[BVXI_NEAR_BLOCKS];
    int32_t count;     /* blocks */
    float error;       /* above the error of distances to the listed triangles from centres of the cell */
    int32_t spare[14]; /* so that what follows is aligned as the list is */
} bvxi_near_list;

typedef struct bvxi_near_visit {
    float distance2;
    int32_t level;
    uint32_t node; /* in its level */
} bvxi_near_visit;

/* A box of centres and a search for leaves around it. All is relative to origin, which floats hold
 * exactly. */
typedef struct bvxi_near_cell {
    float origin[3];         /* [Units: box] */
    float first[3], last[3]; /* the outermost centres */
    float limit2;            /* leaves beyond its root are left out */
    float rounding;          /* of the evaluation */
    float point[3];          /* the nearest known point of the mesh */
    float point_error;       /* its triangle is evaluated no further away than point by more than this */
    float point_distance2;   /* from the middle of the cell */
    /* squares of the ends' distances to point along each axis, with slack */
    float first_bound[3], last_bound[3];
    int32_t open; /* visits on the stack */
    bvxi_near_visit stack[BVXI_NEAR_STACK];
} bvxi_near_cell;

/* The centres of a cell and what is known of the mesh, in box units. */
typedef struct bvxi_near_question {
    double first[3], last[3]; /* the outermost centres */
    double limit;             /* leaves beyond it are left out, or infinity */
    double point[3];          /* a point of the mesh */
    double point_error;       /* its triangle is evaluated no further away by more than this */
} bvxi_near_question;

/* Nodes of the lowest level that may matter to cells within a larger one, where their searches begin. */
typedef struct bvxi_near_start {
    /* eight nodes' boxes each; those that there are not lie far off */
    bvxi_near_node box[BVXI_NEAR_STARTS];
    uint32_t node[BVXI_NEAR_STARTS * BVXI_NEAR_WIDTH];
    int32_t count; /* nodes; -1: too many, begin at the root */
} bvxi_near_start;

/* List the nodes for a cell. It is used up, but for the point that it knows. */
void bvxi_near_cell_start(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_start *start);

/* Begin at the root, or with what was listed for a larger cell. */
void bvxi_near_cell_begin(const bvxi_nearest *n, const bvxi_near_question *q, const bvxi_near_start *start,
                          int32_t fast, bvxi_near_cell *cell);

/* What is further from a centre of the cell than the root of this cannot
 * win: the limit, and the known point of the mesh. */
float bvxi_near_cell_reach2(const bvxi_near_cell *cell);

/* Fill the list with leaves that may be nearest to a centre of the cell.
 * Returns 0 when it is full: more come with the next call. */
int32_t bvxi_near_cell_list(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_list *list);

/* ---- Triangles that may be nearest to eight centres ---- */

enum { BVXI_NEAR_SIDE = 4, BVXI_NEAR_MEASURED = 256 };

/* A list seen from the 4 x 4 x 4 centres of a brick, which are eight groups
 * of 2 x 2 x 2: group x + 2 y + 4 z. */
typedef struct bvxi_near_sieve {
    /* of a box's distance from each place along each axis */
    float square[BVXI_NEAR_BLOCKS][3][BVXI_NEAR_SIDE][BVXI_NEAR_WIDTH];
    /* bit k: the block's leaf k is within the limit of a centre of the group */
    uint8_t reach[BVXI_NEAR_BLOCKS][8];
} bvxi_near_sieve;

/* Places of a brick's centres along each axis, relative to the origin of a list's cell [Units: box]. */
typedef struct bvxi_near_places {
    float at[3][BVXI_NEAR_SIDE];
} bvxi_near_places;

void bvxi_near_sieve_list(const bvxi_near_list *list, const bvxi_near_places *places, float limit2,
                          int32_t fast, bvxi_near_sieve *sieve);

/* A group: centre number x + 2 y + 4 z. */
typedef struct bvxi_near_eight {
    /* from the centres to the triangles that were measured, by floats [Size: count] */
    float distance2[BVXI_NEAR_MEASURED][8];
    uint32_t place[BVXI_NEAR_MEASURED + 8]; /* of each: 8 times its leaf's number, and its slot */
    float at[3][8];  /* the eight centres, relative to the origin of the list's cell [Units: box] */
    float least2[8]; /* of each centre, the least squared distance known; below 0: not asked */
    float drop2[8];  /* with slack: what is further away cannot win */
    /* of the list: those to look at, number k + 8 i of block i */
    uint16_t leaf[BVXI_NEAR_BLOCKS * BVXI_NEAR_WIDTH + 8];
    float ends[3][2];                   /* the two places along each axis */
    float error;                        /* above that of the distances */
    int32_t group, count, leaves, next; /* next: the first leaf that is not done */
} bvxi_near_eight;

/* Squared distance from a place, relative to the frame's origin, to a triangle. In
 * the frame: (u, v) and height w; the part to the left of the altitude is turned
 * over to the right, where before is what lies between u and the end of the base. */
static inline float bvxi_near_distance2(const float f[BVXI_NEAR_NUMBERS], float x, float y, float z)
{
    float const u = x * f[3] + y * f[4] + z * f[5];
    float const v = x * f[6] + y * f[7] + z * f[8];
    float const w = x * f[9] + y * f[10] + z * f[11];
    float const r = u < 0.0f ? f[BVXI_NEAR_P] : f[BVXI_NEAR_Q];
    float const h = f[BVXI_NEAR_H];
    float const before = r - (u < 0.0f ? -u : u);
    float const beyond = before < 0.0f ? before : 0.0f, base2 = beyond * beyond + v * v;
    /* 0 / 0: 0 */
    float const t = (before * r + v * h) / (r * r + h * h), above = t > 0.0f ? t : 0.0f,
                s = above < 1.0f ? above : 1.0f;
    float const dx = before - s * r, dy = v - s * h, edge2 = dx * dx + dy * dy;
    float const side = before * h - v * r, least = base2 < edge2 ? base2 : edge2, inner = v < side ? v : side;
    return (inner > 0.0f ? 0.0f : least) + w * w;
}

/* A triangle that may win at a centre. */
typedef struct bvxi_near_winner {
    uint32_t triangle;
    int32_t centre;
} bvxi_near_winner;

/* Ask for the centres in active (bit n: centre n), and for nothing beyond the limit whose square is given. */
void bvxi_near_eight_begin(int32_t group, const bvxi_near_places *places, uint32_t active, float limit2,
                           bvxi_near_eight *e);

/* Begin with a list. */
void bvxi_near_eight_take(const bvxi_near_list *list, const bvxi_near_sieve *sieve, int32_t fast,
                          bvxi_near_eight *e);

/* Measure triangles of the list, whose cell has this origin. Returns 0 when
 * there was no room for all: require the winners, and call it again. */
int32_t bvxi_near_eight_look(const bvxi_nearest *n, const bvxi_near_list *list, const float origin[3],
                             int32_t fast, bvxi_near_eight *e);

/* What may win of all that was measured; most2 becomes the square below which a winner's distance lies. There
 * is room for BVXI_NEAR_MEASURED * 8 winners. Returns their number. */
int32_t bvxi_near_eight_winners(const bvxi_nearest *n, int32_t fast, bvxi_near_eight *e, float most2[8],
                                bvxi_near_winner *winners);

/* ---- The nearest triangles of bricks of 4 x 4 x 4 centres ---- */

enum { BVXI_NEAR_SLOTS = 64, BVXI_NEAR_CUBE = 16 }; /* slot x + 4 y + 16 z of a brick */
#define BVXI_NEAR_NONE UINT32_MAX

/* What one task works with. */
typedef struct bvxi_near_worker {
    bvxi_near_sieve sieve; /* what vectors walk through stands first, aligned */
    bvxi_near_list list;
    bvxi_near_eight eight;
    bvxi_near_pairs pairs;
    bvxi_near_winner winners[BVXI_NEAR_MEASURED * 8];
    bvxi_near_cell cell;
    int32_t fast;
    int32_t known;        /* the question's point is one of the mesh */
    int32_t started;      /* the caller's: start is that of the cube */
    int32_t few_reached;  /* the caller's: bricks without a centre within the width are expected */
    double started_width; /* the caller's: within this */
    bvxi_near_question question;
    bvxi_near_start start; /* where the searches of the cube's bricks begin */
    /* the brick */
    double centre[3][BVXI_NEAR_SIDE]; /* coordinates of its centres [Units: evaluation] */
    double middle[3];                 /* [Units: box] */
    float offset[3][BVXI_NEAR_SIDE];  /* of the centres from middle [Units: box] */
    bvxi_near_places places;          /* of the centres, for the list */
    uint64_t evaluated;               /* slots whose best is from the evaluation in doubles */
    uint32_t triangle[BVXI_NEAR_SLOTS];
    double distance2[BVXI_NEAR_SLOTS];
    double height2[BVXI_NEAR_SLOTS]; /* by_planes, of the evaluated: to the triangle's plane */
} bvxi_near_worker;

/* 0 when no centre of a cube of 16 x 16 x 16 lies within the width; its
 * first centre has these lattice indices. */
int32_t bvxi_near_cube_reaches(const bvxi_nearest *n, const int32_t first[3], double width,
                               bvxi_near_worker *w);

/* Begin a cube of 16 x 16 x 16 centres, whose first one has these lattice indices: bricks in it follow. */
void bvxi_near_cube_begin(const bvxi_nearest *n, const int32_t first[3], double width, bvxi_near_worker *w);

/* Centres of the brick whose first one has these lattice indices. */
void bvxi_near_brick_begin(const bvxi_nearest *n, const int32_t first[3], bvxi_near_worker *w);

/* Find the nearest triangle for each slot in wanted that is no further than width [Units: world, or
 * infinity]; BVXI_NEAR_NONE for others. Returns the slots that have one. */
uint64_t bvxi_near_brick_find(const bvxi_nearest *n, uint64_t wanted, double width, bvxi_near_worker *w);

#endif
