/* sheet_turns.c - the whole number nearest to the sheet's angle, at all centres of a block.
 *
 * Source: the hierarchy is that of Barill, Dickson, Schmidt, Levin, Jacobson. Fast Winding Numbers for Soups and Clouds. 2018, on
 * the side of the questions.
 *
 * A brick is asked at its middle, where the angle comes with its gradient and with a bound on how far it may be from linear within
 * the brick (sheet.c). Where that leaves no doubt for any centre, and no sheet is near, all have one whole number. Else the brick
 * is cut into eight. A small one tells what its centres have: the linear angle, what near edges sweep on the way from the middle, and
 * which near triangles that way crosses (sheet_near.c). Centres nearer than the bound to a half are asked by themselves.
 * Guarantee: what each centre would say by itself, so where bricks lie does not matter. */
#include "voxelize/sheet_tree.h"
#include "voxelize/turns_brick.h"

enum { TURNS_STACK = 64, TURNS_SMALL = 4, TURNS_PLAIN = 8 };

static const double turns_near[2] = {1e-2, 1e-3}; /* parts of the sheet are opened until each is off by less; in small bricks */
static const double turns_edge = 1e-2;  /* in small bricks edges are near when they alone are off by more */
static const double turns_doubt = 0.2;  /* small bricks are cut further when their bound is above */

/* What the brick's middle says about the centre that lies h from it; 0 when that is not enough. */
static int tell_centre(const bvxi_turns_block *block, const bvxi_sheet_look *look, double reach2, const double h[3], int32_t *whole,
                       int *clear)
{
    double const part = (h[0] * h[0] + h[1] * h[1] + h[2] * h[2]) / reach2;
    const double *const g = look->gradient, *const e = look->edge_gradient;
    double turns = look->turns + g[0] * h[0] + g[1] * h[1] + g[2] * h[2], n;
    double const linear = turns + e[0] * h[0] + e[1] * h[1] + e[2] * h[2];
    int32_t entered = 0;
    if (!is_certain(block, linear, look->rest + (look->bend + look->edge_bend) * part, &n, clear)) {
        if (look->edges == 0 || !bvxi_sheet_swept(look, h, &turns)) return 0;
        if (!is_certain(block, turns, look->rest + look->bend * part, &n, clear)) return 0;
    }
    if (look->triangles > BVXI_LOOK_TRIANGLES) return 0;
    if (look->triangles > 0 && !bvxi_sheet_entered(look, h, &entered)) return 0;
    *whole = (int32_t)n + entered;
    return 1;
}

static void tell_brick(bvxi_turns_block *block, const turns_brick *b, const bvxi_sheet_look *look, double reach2)
{
    const double *const step = block->sheet->step;
    double middle[3], h[3];
    int32_t whole;
    int clear;
    for (int32_t a = 0; a < 3; a++) middle[a] = b->at[a] + 0.5 * (b->size[a] - 1);
    for (int32_t z = b->at[2]; z < b->at[2] + b->size[2]; z++)
        for (int32_t y = b->at[1]; y < b->at[1] + b->size[1]; y++) {
            uint32_t const row = bvxi_turns_row(y, z);
            h[1] = (y - middle[1]) * step[1];
            h[2] = (z - middle[2]) * step[2];
            for (int32_t x = b->at[0]; x < b->at[0] + b->size[0]; x++) {
                if ((block->open[row] >> x & 1) == 0) continue;
                h[0] = (x - middle[0]) * step[0];
                if (tell_centre(block, look, reach2, h, &whole, &clear)) set_turns(block, row, x, whole, block->want_clear && clear);
                else ask_centre(block, x, y, z);
            }
        }
}

/* 1 when all of the brick's centres have one whole number, and are clear or not, as its middle. */
static int is_settled(const bvxi_turns_block *block, const turns_brick *b, const bvxi_sheet_look *look, int32_t *whole, int *clear)
{
    double spread = look->rest + look->bend + look->edge_bend, n;
    for (int32_t a = 0; a < 3; a++) {
        double const way = 0.5 * (b->size[a] - 1) * block->sheet->step[a] * (look->gradient[a] + look->edge_gradient[a]);
        spread += way < 0 ? -way : way;
    }
    if (look->triangles > 0 || !is_certain(block, look->turns, spread, &n, clear)) return 0;
    *whole = (int32_t)n;
    return 1;
}

/* 1 when the brick is done with. */
static int look_at_brick(bvxi_turns_block *block, const turns_brick *b)
{
    const bvxi_sheet *const s = block->sheet;
    int64_t const half = ((int64_t)1 << s->fraction_bits) / 2;
    int const small = b->side <= TURNS_SMALL;
    bvxi_sheet_look look;
    int64_t p[3];
    double reach = 0;
    int32_t whole;
    int clear;
    if (b->size[0] == 1 && b->size[1] == 1 && b->size[2] == 1) {
        ask_centre(block, b->at[0], b->at[1], b->at[2]);
        return 1;
    }
    for (int32_t a = 0; a < 3; a++) {
        double const way = 0.5 * (b->size[a] - 1) * s->step[a];
        reach += way * way;
        p[a] = (2 * ((int64_t)block->low[a] + b->at[a]) + b->size[a]) * half;
    }
    reach = sqrt(reach) * (1 + 1e-9);
    bvxi_sheet_around(s, p, reach, turns_near[small], small ? turns_edge : 1e60, &look);
    if (is_settled(block, b, &look, &whole, &clear)) {
        settle_brick(block, b, whole, block->want_clear && clear);
        return 1;
    }
    if (b->side > TURNS_PLAIN || (b->side > 2 && (look.rest + look.bend > turns_doubt || look.triangles > BVXI_LOOK_TRIANGLES))) return 0;
    tell_brick(block, b, &look, reach * reach);
    return 1;
}

void bvxi_sheet_block(bvxi_turns_block *block)
{
    turns_brick stack[TURNS_STACK]; /* seven more at each of four cuts */
    int32_t count = 1;
    if (block->pending != NULL) {
        bvxi_sheet_tree_block(block);
        return;
    }
    block->dirty = 0;
    memset(stack[0].at, 0, sizeof stack[0].at);
    memcpy(stack[0].size, block->size, sizeof stack[0].size);
    stack[0].side = BVXI_TURNS_SIDE;
    while (count > 0) {
        turns_brick const b = stack[--count];
        if ((block->all_open || brick_is_open(block, &b)) && !look_at_brick(block, &b)) cut_brick(&b, stack, &count);
    }
}
