/* carry_signs.c - inside and outside beyond the band.
 *
 * The centres that the band leaves fall into spaces, connected through faces. A space whose neighbours in the
 * band all lie on one side lies there as a whole. Where a hole lets both sides into one space, fronts move
 * into it from the band, through faces, one voxel a step; a centre takes the side of the front that comes
 * first, and outside when both come at once. The band must be a voxel wide on either side (width >= the
 * largest spacing): then the surface never passes between a centre in the band and one beyond it.
 *
 * A step looks at the state before it only, so neither order nor threads show. Rows are visited only where
 * something changed beside them in the step before. */
#include "field/signs.h"
#include "components/room.h"

enum {
    CARRY_INSIDE = 1,
    CARRY_OUTSIDE = 2,
    CARRY_WORDS = 1 << 12 /* least words a task */
};

typedef struct carry_spaces {
    const bvx_grid *band;
    const uint64_t *inside; /* of the band */
    uint64_t *to;           /* receives the spaces that are inside as a whole */
    uint64_t *open;         /* receives those that have both sides */
    uint8_t *sides;         /* of each space: CARRY_INSIDE, CARRY_OUTSIDE */
    uint64_t mixed;
} carry_spaces;

/* The sides of band centres that lie beside [begin, end) in a row. */
static unsigned sides_in_row(const carry_spaces *s, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    const bvx_grid *const g = s->band;
    uint64_t const row = ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->words_per_row;
    uint64_t in = 0, out = 0;
    for (int32_t k = begin >> 6; k <= (end - 1) >> 6; k++) {
        uint64_t const band = g->words[row + (uint64_t)k] & bvxi_run_mask(begin, end, k);
        /* Centres in the band are all known: inside or outside. */
        uint64_t const inside = s->inside[row + (uint64_t)k];
        in |= band & inside;
        out |= band & ~inside;
    }
    return (in != 0 ? CARRY_INSIDE : 0u) | (out != 0 ? CARRY_OUTSIDE : 0u);
}

static void look_around_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y,
                                  int32_t z)
{
    carry_spaces *const s = user;
    const int32_t *const size = s->band->size;
    unsigned sides = s->sides[space];
    if (sides == (CARRY_INSIDE | CARRY_OUTSIDE)) return;
    if (begin > 0) sides |= sides_in_row(s, begin - 1, begin, y, z);
    if (end < size[0]) sides |= sides_in_row(s, end, end + 1, y, z);
    if (y > 0) sides |= sides_in_row(s, begin, end, y - 1, z);
    if (y + 1 < size[1]) sides |= sides_in_row(s, begin, end, y + 1, z);
    if (z > 0) sides |= sides_in_row(s, begin, end, y, z - 1);
    if (z + 1 < size[2]) sides |= sides_in_row(s, begin, end, y, z + 1);
    s->sides[space] = (uint8_t)sides;
}

static void settle_space_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    carry_spaces *const s = user;
    const bvx_grid *const g = s->band;
    uint64_t const row = ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->words_per_row;
    if (s->sides[space] == CARRY_INSIDE) bvxi_set_run(s->to + row, begin, end);
    if (s->sides[space] != (CARRY_INSIDE | CARRY_OUTSIDE)) return;
    bvxi_set_run(s->open + row, begin, end);
    s->mixed++;
}

/* inside: spaces of one side are settled. open: the others. s->sides is
 * told while inside is still that of the band only. */
static bvx_status settle_spaces(bvx_context *ctx, const char *function, const bvx_grid *band,
                                uint64_t *inside, uint64_t *open, uint64_t *mixed)
{
    carry_spaces s = {0};
    bvxi_spaces spaces;
    s.band = band;
    s.inside = s.to = inside;
    s.open = open;
    /* Spaces of what the band leaves, through faces. */
    BVXI_TRY(bvxi_spaces_open(ctx, function, "signs", band, 1, BVXI_CONNECT_6, &spaces));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, spaces.count, "the sides of spaces", &s.sides));
    bvxi_spaces_each(&spaces, look_around_space_run, &s);
    bvxi_spaces_each(&spaces, settle_space_run, &s);
    *mixed = s.mixed;
    return BVX_OK;
}

typedef struct carry_front {
    const bvx_grid *shape;
    uint64_t *inside;
    uint64_t *open;            /* centres that no front has reached */
    uint64_t *come, *come_in;  /* those that one reaches in this step, and those of them that are inside */
    uint8_t *changed, *change; /* by row: in the step before, in this one */
    uint64_t reached[BVXI_MOST_PIECES];
    int32_t pieces;
} carry_front;

/* What reaches word k of a row from the words w around it: known and on the side that flip tells. */
static inline uint64_t carry_known(const carry_front *f, uint64_t word, uint64_t flip)
{
    return ~f->open[word] & (f->inside[word] ^ flip);
}

/* Centres of word k beside centres of one side: flip 0 inside, all ones outside. Bits past the row's end are
 * not looked at: they are known outside ones, so the last word's are masked. */
static uint64_t carry_reach(const carry_front *f, uint64_t row, int32_t k, uint64_t flip)
{
    const bvx_grid *const g = f->shape;
    uint64_t const words = (uint64_t)g->words_per_row;
    uint64_t const slice = words * (uint64_t)g->size[1];
    uint64_t const at = row * words + (uint64_t)k;
    uint64_t const y = row % (uint64_t)g->size[1];
    uint64_t const z = row / (uint64_t)g->size[1];
    uint64_t const tail = bvxi_tail_mask(g->size[0]);
    uint64_t own = carry_known(f, at, flip), near;

    if (k + 1 == g->words_per_row) own &= tail;
    near = own << 1 | own >> 1;
    if (k > 0) near |= carry_known(f, at - 1, flip) >> 63;
    if (k + 1 < g->words_per_row) {
        uint64_t next = carry_known(f, at + 1, flip);
        if (k + 2 == g->words_per_row) next &= tail;
        near |= next << 63;
    }
    if (y > 0) near |= carry_known(f, at - words, flip);
    if (y + 1 < (uint64_t)g->size[1]) near |= carry_known(f, at + words, flip);
    if (z > 0) near |= carry_known(f, at - slice, flip);
    if (z + 1 < (uint64_t)g->size[2]) near |= carry_known(f, at + slice, flip);
    return near;
}

static void look_for_fronts(void *user, int32_t piece, uint64_t row, uint64_t end)
{
    carry_front *const f = user;
    uint64_t const words = (uint64_t)f->shape->words_per_row;
    uint64_t const ny = (uint64_t)f->shape->size[1], nz = (uint64_t)f->shape->size[2];
    uint64_t reached = 0;

    for (; row < end; row++) {
        uint64_t const y = row % ny, z = row / ny;
        f->change[row] = 0;
        /* Nothing changed beside it: nothing new can reach it. */
        if (!(f->changed[row] || (y > 0 && f->changed[row - 1]) || (y + 1 < ny && f->changed[row + 1]) ||
              (z > 0 && f->changed[row - ny]) || (z + 1 < nz && f->changed[row + ny])))
            continue;
        for (int32_t k = 0; k < f->shape->words_per_row; k++) {
            uint64_t const at = row * words + (uint64_t)k, open = f->open[at];

            /* Cleared even where nothing is open, as both are joined later. */
            f->come[at] = f->come_in[at] = 0;
            if (open == 0) continue;
            uint64_t const in = carry_reach(f, row, k, 0) & open;
            uint64_t const out = carry_reach(f, row, k, ~UINT64_C(0)) & open;
            f->come[at] = in | out;
            f->come_in[at] = in & ~out;
            if ((in | out) != 0) f->change[row] = 1;
        }
        reached += f->change[row];
    }
    f->reached[piece] = reached;
}

static void move_fronts(void *user, uint64_t row, uint64_t end)
{
    carry_front *const f = user;
    uint64_t const words = (uint64_t)f->shape->words_per_row;
    for (; row < end; row++) {
        if (!f->change[row]) continue;
        for (uint64_t at = row * words; at < (row + 1) * words; at++) {
            f->open[at] &= ~f->come[at];
            f->inside[at] |= f->come_in[at];
        }
    }
}

static bvx_status meet_in_spaces(bvx_context *ctx, const char *stage, double at, const bvx_grid *band,
                                 uint64_t *open, uint64_t *inside)
{
    uint64_t const bytes = bvxi_grid_words(band) * 8, rows = bvxi_grid_rows(band);
    carry_front f = {.shape = band, .inside = inside, .open = open};
    uint64_t *come = NULL;
    uint8_t *changed = NULL;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, 2 * bytes, "the fronts of signs", &come));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, 2 * rows, "the fronts' rows", &changed));
    f.come = come;
    f.come_in = come + bvxi_grid_words(band);
    f.changed = changed;
    f.change = changed + rows;
    f.pieces = bvxi_piece_count(rows, 1 + CARRY_WORDS / (uint64_t)band->words_per_row);
    /* At first any row may have something beside it. */
    memset(f.changed, 1, (size_t)rows);
    for (uint64_t reached = 1; reached != 0;) {
        uint8_t *const was = f.changed;
        /* All looks before all moves: a step sees the state before it only. */
        BVXI_TRY(bvxi_for_pieces(ctx, stage, at, at, f.pieces, rows, look_for_fronts, &f));
        BVXI_TRY(bvxi_for_ranges(ctx, stage, at, at, f.pieces, rows, move_fronts, &f));
        f.changed = f.change;
        f.change = was;
        reached = 0;
        for (int32_t i = 0; i < f.pieces; i++) reached += f.reached[i];
    }
    return BVX_OK;
}

bvx_status bvxi_carry_signs(bvxi_call call, const bvx_grid *band, bvx_grid *inside)
{
    uint64_t const bytes = bvxi_grid_words(band) * 8;
    uint64_t *open = NULL, mixed = 0;
    BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, bytes, "the spaces of both sides", &open));
    BVXI_TRY(BVXI_SCOPE(call.ctx, settle_spaces(call.ctx, call.function, band, inside->words, open, &mixed)));
    /* Nearly always all spaces are of one side, and no front is needed. */
    if (mixed != 0)
        BVXI_TRY(
            BVXI_SCOPE(call.ctx, meet_in_spaces(call.ctx, call.stage, call.from, band, open, inside->words)));
    bvxi_drop(call.ctx, open);
    return BVX_OK;
}
