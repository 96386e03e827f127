/* nearest_eight.h - triangles that may be nearest to eight centres. Not installed. */
#ifndef BVXI_NEAREST_EIGHT_H
#define BVXI_NEAREST_EIGHT_H

#include "nearest/nearest_cell.h"

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

#endif
