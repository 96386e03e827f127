/* sheet_tree_turns.c - the whole number nearest to the angle of a sheet over very many holes, at all centres
 * of a block.
 *
 * Source: Greengard, Rokhlin. A Fast Algorithm for Particle Simulations. 1987: what is far from a brick
 * becomes a polynomial about its middle, which its eighths take over; they look only at what was too near
 * (sheet.h).
 *
 * A brick whose polynomial, with its bound and with all that is near, leaves no doubt has one whole number.
 * Few near triangles, which may be larger than bricks, are looked at from its middle as in sheet_turns.c.
 * Else small bricks sum the near triangles for each centre. Where the bound is too wide for that a centre
 * asks the tree, and at last all triangles.
 *
 * In the names below a brick is a box of centres, a cell a part of the sheet's tree, a brick's view its
 * polynomial, and pending are the cells that are too near to be in it.
 * Guarantee: as sheet_turns.c, what each centre would say by itself. */
#include "winding/turns.h"

#include <math.h>

enum { TREE_BRICKS = 64, TREE_SMALL = 2, TREE_PLAIN = 8, TREE_BRICK_STACK = 128, TREE_LOOKED = 256 };

/* cells that look smaller from a brick are in its polynomial */
static const double tree_near = 0.45;
/* the same for a single centre, one after the other */
static const double tree_ask[3] = {0.25, 0.0625, 0.02};
#define TREE_ROUNDING 1e-8
/* Of strips little parts, by what they cover at most, are only bounds, up to such a sum more in each eighth: the
 * angle is near a half in few places then. */
static const double tree_little = 2e-3, tree_spend = 0.08;
static const double tree_doubt = 0.2; /* looks of a wider bound answer for few of a brick's centres */
static const double tree_edge = 1e-2; /* in small bricks edges are near when they alone are off by more */

/* A brick's polynomial. */
typedef struct tree_view {
    double middle[3], half[3], reach; /* [Units: the largest spacing] */
    double local[BVXI_SERIES_LOCAL], error;
    bvxi_series_parts far;        /* that the polynomial is yet to get */
    double near;                  /* no less than what is near can be; 1 or more: anything */
    uint64_t pendings, triangles; /* of the cells that are pending */
    double spend;                 /* the error up to which little parts are bounds only */
    int looked;                   /* 1: few triangles are pending, and look has them and the polynomial */
    bvxi_sheet_look look;
} tree_view;

static void start_view(const bvxi_turns_block *block, const turns_brick *b, const tree_view *from,
                       tree_view *v)
{
    const bvxi_sheet *const s = block->sheet;
    double way[3];

    v->reach = 0;
    for (int a = 0; a < 3; a++) {
        v->half[a] = 0.5 * (b->size[a] - 1) * s->step[a];
        v->middle[a] = (block->low[a] + b->at[a] + 0.5 * b->size[a]) * s->step[a];
        v->reach += v->half[a] * v->half[a];
        way[a] = from == NULL ? 0 : v->middle[a] - from->middle[a];
    }
    v->reach = sqrt(v->reach) * (1 + 1e-9);

    /* An eighth takes over the polynomial of the brick above, moved to its own middle. */
    v->error = from == NULL ? TREE_ROUNDING : from->error;
    v->spend = s->strips.loops == 0 ? 0 : tree_spend + (from == NULL ? 0 : from->spend);
    v->near = 0;
    v->pendings = v->triangles = 0;
    v->looked = v->far.count = 0;
    if (from == NULL) memset(v->local, 0, sizeof v->local);
    else bvxi_series_move_local(&s->tree->table, from->local, way, v->local);
}

/* No less than the turns that triangle t covers from any of the brick's centres: by its longest side. */
static double most_of_triangle(const bvxi_sheet *s, uint64_t t, const tree_view *v)
{
    const bvxi_sheet_tree *const tree = s->tree;
    const bvxi_sheet_shape *const shape = &tree->shape[t];
    const double *const a = bvxi_sheet_point(s, tree->corner[3 * t + shape->side]);
    const double *const b = bvxi_sheet_point(s, tree->corner[3 * t + (shape->side + 1) % 3]);
    double u[3], w[3], along, uu, gap;

    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        w[k] = v->middle[k] - a[k];
    }
    along = bvxi_vec_dot(u, w);
    uu = bvxi_vec_dot(u, u);
    along = along <= 0 || uu == 0 ? 0 : along >= uu ? 1 : along / uu;
    for (int k = 0; k < 3; k++) w[k] -= along * u[k];
    gap = bvxi_vec_length(w) * (1 - 1e-9) - shape->width - v->reach;
    return gap <= 0 ? 1 : shape->area / (4 * BVXI_PI * gap * gap);
}

/* Cells that are near stay pending; larger ones than the brick in their halves, at last triangle by triangle. */
static void view_sheet_cell(const bvxi_sheet *s, uint32_t number, uint32_t *pending, tree_view *v)
{
    const bvxi_sheet_tree *const tree = s->tree;
    uint32_t stack[TREE_BRICK_STACK];
    int32_t count = 1;

    stack[0] = number;
    while (count-- > 0) {
        uint32_t const at = stack[count];
        int const single = at >= tree->cells;
        const bvxi_sheet_cell *const c = &tree->cell[single ? 0 : at];
        double most, r[3], d2 = 0, reach = 0;

        if (single) {
            most = most_of_triangle(s, at - tree->cells, v);
        } else {
            for (int a = 0; a < 3; a++) r[a] = c->centre[a] - v->middle[a];
            d2 = bvxi_vec_dot(r, r);
            reach = c->radius + v->reach;
            double const gap = sqrt(d2) * (1 - 1e-9) - reach;
            most = gap <= 0 ? 1 : c->area / (4 * BVXI_PI * gap * gap);
        }

        /* Next to nothing is a bound; far from all of the brick's centres: into the polynomial. */
        if (most < tree_little && v->error + most < v->spend) {
            v->error += most;
        } else if (!single && reach * reach < tree_near * tree_near * d2) {
            bvxi_series_put(&tree->table, c->moment, r, BVXI_SERIES_LOCAL, &v->far, v->local);
            v->error += c->area * bvxi_series_rest(d2, reach / sqrt(d2));
        } else if (!single && c->second != 0 && 1.5 * c->radius > v->reach) {
            stack[count++] = c->second;
            stack[count++] = at + 1;
        } else if (!single && v->spend > 0 && c->second == 0 && 1.5 * c->radius > v->reach) {
            for (uint64_t t = c->first; t < c->end; t++) stack[count++] = (uint32_t)(tree->cells + t);
        } else {
            /* What is near stays on the list, and its greatest share counts as a bound. */
            v->near += most;
            v->triangles += single ? 1 : c->end - c->first;
            pending[v->pendings++] = at;
        }
    }
}

/* 1 when all centres of the brick have one whole number. */
static int is_one_number(const bvxi_turns_block *block, const tree_view *v, int32_t *whole, int *clear)
{
    double power[BVXI_SERIES_LOCAL], spread = v->error + v->near, n;
    /* What is near may be half a turn by itself: no polynomial can be certain. */
    if (v->near >= 0.5) return 0;
    bvxi_series_powers(&block->sheet->tree->table, v->half, BVXI_SERIES_LOCAL, power);
    /* The greatest change within the brick: every term at its largest. */
    for (int i = 1; i < BVXI_SERIES_LOCAL; i++)
        spread += power[i] * (v->local[i] < 0 ? -v->local[i] : v->local[i]);
    if (!is_certain(block, v->local[0], spread, &n, clear)) return 0;
    *whole = (int32_t)n;
    return 1;
}

/* Few triangles that are near, larger than voxels perhaps: their angle at the brick's middle, how it changes
 * from there on, and the polynomial's, whose higher terms bend it. */
static void look_at_pending(const bvxi_turns_block *block, const turns_brick *b, const uint32_t *pending,
                            tree_view *v)
{
    bvxi_sheet_look *const look = &v->look;
    double power[BVXI_SERIES_LOCAL], reach;
    int64_t p[3];

    reach = bvxi_turns_middle(block, b, p);
    /* Strips are narrower than any brick: what they do is not near linear. */
    if (!(reach > 0) || v->triangles > TREE_LOOKED || block->sheet->strips.loops > 0) return;
    bvxi_sheet_cells_around(block->sheet, p, pending, v->pendings, reach,
                            b->side <= TREE_PLAIN ? tree_edge : 1e60, look);
    bvxi_series_powers(&block->sheet->tree->table, v->half, BVXI_SERIES_LOCAL, power);
    look->turns += v->local[0];
    for (int a = 0; a < 3; a++) look->gradient[a] += v->local[1 + a];
    look->rest += v->error;
    for (int i = 4; i < BVXI_SERIES_LOCAL; i++)
        look->rest += power[i] * (v->local[i] < 0 ? -v->local[i] : v->local[i]);
    v->looked = 1;
}

/* Up to four centres of a brick that its look left open. */
typedef struct tree_centres {
    int32_t count, at[4][3];
    int64_t place[4][3]; /* in whole numbers for exact questions */
    double turns[4];     /* of the polynomial */
} tree_centres;

/* By the brick's view and the cells that are pending. */
static void settle_centres(bvxi_turns_block *block, const uint32_t *pending, const tree_view *v,
                           tree_centres *c)
{
    const bvxi_sheet *const s = block->sheet;
    double near[4] = {0, 0, 0, 0}, n;
    int clear;

    if (c->count == 0) return;
    /* Lanes without a centre ask what the first does. */
    for (int32_t i = c->count; i < 4; i++) memcpy(c->place[i], c->place[0], sizeof c->place[i]);
    if (v->pendings > 0)
        bvxi_sheet_cells_angles_four(s, (const int64_t(*)[3])c->place, pending, v->pendings, near);
    for (int32_t i = 0; i < c->count; i++) {
        const int32_t *const at = c->at[i];
        /* Near cells are summed exactly, so only the polynomial's error is left. */
        double turns = c->turns[i] + near[i];
        int certain = is_certain(block, turns, v->error, &n, &clear);
        /* Else the tree, opened further and further. */
        for (int k = 0; k < 3 && !certain; k++) {
            double error;
            turns = bvxi_sheet_tree_angle(s, c->place[i], tree_ask[k], &error);
            certain = is_certain(block, turns, error + TREE_ROUNDING, &n, &clear);
        }
        if (!certain) ask_centre(block, at[0], at[1], at[2]);
        else set_turns(block, bvxi_turns_row(at[1], at[2]), at[0], (int32_t)n, block->want_clear && clear);
    }
    c->count = 0;
}

/* The look answers for a centre, or it is put to the others. */
static void view_centre(bvxi_turns_block *block, const int32_t at[3], const uint32_t *pending,
                        const tree_view *v, tree_centres *c)
{
    const bvxi_sheet *const s = block->sheet;
    int64_t const step = (int64_t)1 << s->fraction_bits;
    double power[BVXI_SERIES_LOCAL], h[3], turns = 0; /* the way from the middle, for the polynomial */
    int32_t whole;
    int clear;

    for (int a = 0; a < 3; a++) h[a] = (block->low[a] + at[a] + 0.5) * s->step[a] - v->middle[a];
    if (v->looked && bvxi_turns_of_centre(block, &v->look, v->reach * v->reach, h, &whole, &clear)) {
        set_turns(block, bvxi_turns_row(at[1], at[2]), at[0], whole, block->want_clear && clear);
        return;
    }

    bvxi_series_powers(&s->tree->table, h, BVXI_SERIES_LOCAL, power);
    for (int i = 0; i < BVXI_SERIES_LOCAL; i++) turns += power[i] * v->local[i];
    for (int a = 0; a < 3; a++) c->place[c->count][a] = (block->low[a] + at[a]) * step + step / 2;
    memcpy(c->at[c->count], at, sizeof c->at[0]);
    c->turns[c->count++] = turns;
    if (c->count == 4) settle_centres(block, pending, v, c);
}

/* 1 when the brick is done with. above: what the brick that it is an eighth of has left, or NULL. */
static int view_brick(bvxi_turns_block *block, const turns_brick *b, const tree_view *above,
                      const uint32_t *left, uint32_t *pending, tree_view *v)
{
    int32_t whole;
    int clear;

    /* The first brick begins with the whole tree, the others with what was left above. */
    start_view(block, b, above, v);
    if (above == NULL) view_sheet_cell(block->sheet, 0, pending, v);
    else
        for (uint64_t i = 0; i < above->pendings; i++) view_sheet_cell(block->sheet, left[i], pending, v);
    bvxi_series_add(&block->sheet->tree->table, &v->far, BVXI_SERIES_LOCAL, v->local);

    /* One number for all, or eighths, or small enough to go centre by centre. */
    if (is_one_number(block, v, &whole, &clear)) settle_brick(block, b, whole, block->want_clear && clear);
    else if ((look_at_pending(block, b, pending, v), v->looked) &&
             bvxi_turns_settled(block, b, &v->look, &whole, &clear))
        settle_brick(block, b, whole, block->want_clear && clear);
    /* A larger brick where the look answers for most of its centres. */
    else if (b->side > (v->looked && v->look.rest + v->look.bend < tree_doubt &&
                                v->look.triangles <= BVXI_LOOK_TRIANGLES
                            ? TREE_PLAIN
                            : TREE_SMALL))
        return 0;
    else {
        tree_centres centres = {0};
        int32_t at[3];
        for (at[2] = b->at[2]; at[2] < b->at[2] + b->size[2]; at[2]++)
            for (at[1] = b->at[1]; at[1] < b->at[1] + b->size[1]; at[1]++)
                for (at[0] = b->at[0]; at[0] < b->at[0] + b->size[0]; at[0]++)
                    if ((block->open[bvxi_turns_row(at[1], at[2])] >> at[0] & 1) != 0)
                        view_centre(block, at, pending, v, &centres);
        settle_centres(block, pending, v, &centres);
    }
    return 1;
}

void bvxi_sheet_tree_block(bvxi_turns_block *block)
{
    uint64_t const most = block->sheet->tree->pendings;
    turns_brick stack[TREE_BRICKS];
    tree_view view[BVXI_TURNS_LEVELS];
    int32_t count = 1;

    block->dirty = 0;
    memset(stack[0].at, 0, sizeof stack[0].at);
    memcpy(stack[0].size, block->size, sizeof stack[0].size);
    stack[0].side = BVXI_TURNS_SIDE;

    while (count > 0) {
        turns_brick const b = stack[--count];
        int level = 0;

        /* Each level has its own list, since eighths read the one above. */
        while (BVXI_TURNS_SIDE >> level > b.side) level++;
        if (!block->all_open && !brick_is_open(block, &b)) continue;
        if (!view_brick(block, &b, level == 0 ? NULL : &view[level - 1],
                        level == 0 ? NULL : block->pending + (uint64_t)(level - 1) * most,
                        block->pending + (uint64_t)level * most, &view[level]))
            cut_brick(&b, stack, &count);
    }
}
