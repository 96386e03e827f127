/* sheet_turns.c - the whole number nearest to the sheet's angle, at all centres of a block.
 *
 * Source: the hierarchy is that of Barill, Dickson, Schmidt, Levin, Jacobson. Fast Winding Numbers for Soups
 * and Clouds. 2018, on the side of the questions.
 *
 * A brick is evaluated at its middle, where the angle comes with its gradient and with a bound on how far it
 * may be from linear within the brick (sheet.c). Where that leaves no doubt for any centre, and no sheet is
 * near, all have one whole number. Else the brick is cut into eight. A small one says what its centres have:
 * the linear angle, what near edges sweep on the way from the middle, and which near triangles that way
 * crosses (sheet_near.c). Centres nearer than the bound to a half are evaluated by themselves.
 * Guarantee: what each centre would say by itself, so where bricks lie does not matter. */
#include "winding/turns.h"

enum { TURNS_STACK = 160, TURNS_SMALL = 4, TURNS_PLAIN = 8, TURNS_LANES = 4 };

/* parts of the sheet are opened until each is off by less; in small bricks */
static const double turns_near[2] = {1e-2, 1e-3};
static const double turns_edge = 1e-2; /* in small bricks edges are near when they alone are off by more */
static const double turns_doubt = 0.2; /* small bricks are cut further when their bound is above */

/* Centres that are to be asked by themselves. */
typedef struct turns_asked {
    int32_t at[TURNS_LANES][3];
    int32_t count;
} turns_asked;

static void ask_centres(bvxi_turns_block *block, turns_asked *asked)
{
    int64_t const step = (int64_t)1 << block->sheet->fraction_bits;
    bvxi_sheet_answer answer[TURNS_LANES];
    int64_t p[TURNS_LANES][3];

    if (asked->count == 0) return;
    /* Lanes that are not needed repeat the first centre: four cost what one does. */
    for (int32_t i = 0; i < TURNS_LANES; i++)
        for (int32_t a = 0; a < 3; a++)
            p[i][a] = (block->low[a] + asked->at[i < asked->count ? i : 0][a]) * step + step / 2;
    if (asked->count == 1) answer[0] = bvxi_sheet_turns(block->sheet, p[0], block->want_clear);
    else bvxi_sheet_turns_four(block->sheet, (const int64_t(*)[3])p, block->want_clear, answer);
    for (int32_t i = 0; i < asked->count; i++)
        put_answer(block, &answer[i], asked->at[i][0], asked->at[i][1], asked->at[i][2]);
    asked->count = 0;
}

static void ask_later(bvxi_turns_block *block, int32_t x, int32_t y, int32_t z, turns_asked *asked)
{
    int32_t *const at = asked->at[asked->count++];
    at[0] = x;
    at[1] = y;
    at[2] = z;
    if (asked->count == TURNS_LANES) ask_centres(block, asked);
}

static void tell_brick(bvxi_turns_block *block, const turns_brick *b, const bvxi_sheet_look *look,
                       double reach2, turns_asked *asked)
{
    const double *const step = block->sheet->step;
    double middle[3], h[3];
    int32_t whole;
    int clear;

    /* Places within the brick, from its middle, in units of the sheet. */
    for (int32_t a = 0; a < 3; a++) middle[a] = b->at[a] + 0.5 * (b->size[a] - 1);
    for (int32_t z = b->at[2]; z < b->at[2] + b->size[2]; z++)
        for (int32_t y = b->at[1]; y < b->at[1] + b->size[1]; y++) {
            uint32_t const row = bvxi_turns_row(y, z);
            h[1] = (y - middle[1]) * step[1];
            h[2] = (z - middle[2]) * step[2];
            for (int32_t x = b->at[0]; x < b->at[0] + b->size[0]; x++) {
                if ((block->open[row] >> x & 1) == 0) continue;
                h[0] = (x - middle[0]) * step[0];
                if (bvxi_turns_of_centre(block, look, reach2, h, &whole, &clear))
                    set_turns(block, row, x, whole, block->want_clear && clear);
                else ask_later(block, x, y, z, asked);
            }
        }
}

/* 1 when the brick is done with. */
static int take_look(bvxi_turns_block *block, const turns_brick *b, const bvxi_sheet_look *look, double reach,
                     turns_asked *asked)
{
    int32_t whole;
    int clear;

    /* No doubt for any of them: the whole brick at once. */
    if (bvxi_turns_settled(block, b, look, &whole, &clear)) {
        settle_brick(block, b, whole, block->want_clear && clear);
        return 1;
    }
    /* A large brick is cut; a small one says what its centres have, unless its own bound is too wide. */
    if (b->side > TURNS_PLAIN ||
        (b->side > 2 && (look->rest + look->bend > turns_doubt || look->triangles > BVXI_LOOK_TRIANGLES)))
        return 0;
    tell_brick(block, b, look, reach * reach, asked);
    return 1;
}

/* Bricks of one side; those that are not done with are cut. */
static void look_at_bricks(bvxi_turns_block *block, const turns_brick *b, int32_t bricks, turns_brick *stack,
                           int32_t *count, turns_asked *asked)
{
    int const small = b->side <= TURNS_SMALL;
    double const edge = small ? turns_edge : 1e60;
    bvxi_sheet_look look[TURNS_LANES];
    int64_t p[TURNS_LANES][3];
    double reach = 0;

    /* The largest reach serves all four, as they are of one side. */
    for (int32_t i = 0; i < TURNS_LANES; i++) {
        double const own = bvxi_turns_middle(block, &b[i < bricks ? i : 0], p[i]);
        reach = own > reach ? own : reach;
    }
    /* Four bricks cost little more than one. */
    if (bricks == 1) bvxi_sheet_around(block->sheet, p[0], reach, turns_near[small], edge, look);
    else bvxi_sheet_around_four(block->sheet, (const int64_t(*)[3])p, reach, turns_near[small], edge, look);
    for (int32_t i = 0; i < bricks; i++)
        if (!take_look(block, &b[i], &look[i], reach, asked)) cut_brick(&b[i], stack, count);
}

void bvxi_sheet_block(bvxi_turns_block *block)
{
    turns_brick stack[TURNS_STACK]; /* four times seven more, and one, at each of four cuts */
    turns_asked asked;
    int32_t count = 1;

    asked.count = 0;

    /* Very many small holes have a tree, and a way of their own. */
    if (block->pending != NULL) {
        bvxi_sheet_tree_block(block);
        return;
    }
    block->dirty = 0;
    memset(stack[0].at, 0, sizeof stack[0].at);
    memcpy(stack[0].size, block->size, sizeof stack[0].size);
    stack[0].side = BVXI_TURNS_SIDE;
    while (count > 0) {
        /* Bricks of one side are gathered from the stack, four at a time. */
        int32_t const side = stack[count - 1].side;
        turns_brick b[TURNS_LANES];
        int32_t bricks = 0;
        while (count > 0 && bricks < TURNS_LANES && stack[count - 1].side == side) {
            b[bricks] = stack[--count];
            if (!block->all_open && !brick_is_open(block, &b[bricks])) continue;
            if (b[bricks].size[0] == 1 && b[bricks].size[1] == 1 && b[bricks].size[2] == 1)
                ask_later(block, b[bricks].at[0], b[bricks].at[1], b[bricks].at[2], &asked);
            else bricks++;
        }
        if (bricks > 0) look_at_bricks(block, b, bricks, stack, &count, &asked);
    }
    ask_centres(block, &asked);
}
