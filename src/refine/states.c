/* states.c - what is outside in an octree: a flood among the base's voxels, a row of bits at a time, and
 * boundary states passed from voxel to voxel through all sizes, until nothing changes.
 *
 * Source: Liu, Jing, Zhang, Zhao. Refinement of surface voxels by boundary states (docs/papers.md, 4), with
 * a worklist in place of one pass. Guarantee: the set that is outside does not depend on the order of
 * work. */
#include "refine/cubes.h"
#include "refine/refine.h"

enum { IN_LIST = 0x80 };

/* What is known of an octet. */
typedef struct octet_news {
    uint8_t touched, split, outside; /* children; outside: those that have passed it on */
    uint8_t fresh;                   /* outside too, not passed on yet */
    uint8_t state;                   /* boundary state of all of it, and IN_LIST */
} octet_news;

/* The same of a cube, its voxels in words. */
typedef struct cube_news {
    uint64_t touched, outside, fresh;
    uint8_t state;
} cube_news;

typedef struct states_job {
    bvx_octree *tree;
    uint32_t *const *up;
    int32_t bottom; /* the level of octets that are cubes; -1 when there are no octets */
    /* number of each level's first octet among all; cubes come last */
    uint64_t first[BVXI_OCTREE_LEVELS + 1];
    octet_news *news;
    cube_news *cubes;
    uint32_t *list; /* octets and cubes with news */
    uint64_t listed;
    uint64_t *passed; /* of the base: outside bits that have been passed on */
    uint32_t *row_list;
    uint8_t *row_in_list;
    uint64_t rows_listed;
    int32_t nx, ny, nz, row_words, pieces;
} states_job;

static inline octet_news *news_of(const states_job *job, int32_t level, uint64_t octet)
{
    return &job->news[job->first[level] + octet];
}

static inline void list_octet(states_job *job, int32_t level, uint64_t octet, uint8_t *state)
{
    if ((*state & IN_LIST) != 0) return;
    *state |= IN_LIST;
    job->list[job->listed++] = (uint32_t)(job->first[level] + octet);
}

static inline void list_base_row(states_job *job, uint64_t row)
{
    if (job->row_in_list[row]) return;
    job->row_in_list[row] = 1;
    job->row_list[job->rows_listed++] = (uint32_t)row;
}

/* All of an octet's face is exposed. */
static inline void expose_octet(states_job *job, int32_t level, uint64_t octet, uint32_t state)
{
    uint8_t *const known = level == job->bottom ? &job->cubes[octet].state
                                                : &news_of(job, level, octet)->state;
    if ((state & ~(uint32_t)*known) == 0) return;
    *known = (uint8_t)(*known | state);
    list_octet(job, level, octet, known);
}

/* ---- The flood among the base's voxels, a row of bits at a time ---- */

/* A row with news is filled along x, each run of empty voxels that holds an outside one at once; what is new
 * goes to the four rows beside it, and as exposed faces to the octets beside it. */

static inline uint64_t empty_of_row(const states_job *job, uint64_t word)
{
    uint64_t const all = (word + 1) % (uint64_t)job->row_words == 0 ? bvxi_tail_mask(job->nx) : ~UINT64_C(0);
    return ~job->tree->root.touched[word] & all;
}

/* Bits of p that can be reached from g along p upwards; downwards. */
static inline uint64_t reach_up(uint64_t g, uint64_t p)
{
    /* Doubling: after each step p holds the places from which a run of twice the length leads up. */
    g |= p & g << 1;
    p &= p << 1;
    g |= p & g << 2;
    p &= p << 2;
    g |= p & g << 4;
    p &= p << 4;
    g |= p & g << 8;
    p &= p << 8;
    g |= p & g << 16;
    p &= p << 16;
    return g | (p & g << 32);
}

static inline uint64_t reach_down(uint64_t g, uint64_t p)
{
    g |= p & g >> 1;
    p &= p >> 1;
    g |= p & g >> 2;
    p &= p >> 2;
    g |= p & g >> 4;
    p &= p >> 4;
    g |= p & g >> 8;
    p &= p >> 8;
    g |= p & g >> 16;
    p &= p >> 16;
    return g | (p & g >> 32);
}

/* Face d of base voxels that are split is exposed: bits of one word. */
static void expose_base_octets(states_job *job, uint64_t word, uint64_t bits, int d)
{
    if (job->tree->root.split == NULL) return;
    for (bits &= job->tree->root.split[word]; bits != 0; bits &= bits - 1)
        expose_octet(job, 0,
                     bvxi_octets_rank(&job->tree->root, word * BVXI_WORD_BITS + (uint64_t)bvxi_lowest(bits)),
                     1u << d);
}

/* Bits that are new in a word of the base, to the rows beside it. */
static void pass_to_row(states_job *job, uint64_t row, uint64_t column, uint64_t news, int d)
{
    uint64_t const word = row * (uint64_t)job->row_words + column;
    uint64_t const fresh = news & empty_of_row(job, word) & ~job->tree->root.outside[word];
    if (fresh != 0) {
        job->tree->root.outside[word] |= fresh;
        list_base_row(job, row);
    }
    /* A split voxel is not filled as a whole: its own octet learns through which face the outside is. */
    expose_base_octets(job, word, news, (d + 3) % 6);
}

/* Fill a row of base voxels with news, and pass it on. */
static void work_on_row(states_job *job, uint64_t row)
{
    uint64_t const first = row * (uint64_t)job->row_words, ny = (uint64_t)job->ny, y = row % ny, z = row / ny;

    /* Off the list first, so that it can be listed again by what it changes. */
    job->row_in_list[row] = 0;

    /* Fill a row's runs that hold outside bits. */
    uint64_t const begin = row * (uint64_t)job->row_words, end = begin + (uint64_t)job->row_words;
    uint64_t *const outside = job->tree->root.outside;
    uint64_t carry = 0;

    for (uint64_t i = begin; i < end; i++) {
        uint64_t const empty = empty_of_row(job, i);
        outside[i] = reach_up(outside[i] | (carry & empty), empty);
        carry = outside[i] >> 63;
    }

    /* And back, for what lies below an outside voxel of its run. */
    carry = 0;
    for (uint64_t i = end; i-- > begin;) {
        uint64_t const empty = empty_of_row(job, i);
        outside[i] = reach_down(outside[i] | (carry << 63 & empty), empty);
        carry = outside[i] & 1;
    }

    for (uint64_t i = 0; i < (uint64_t)job->row_words; i++) {
        uint64_t const news = job->tree->root.outside[first + i] & ~job->passed[first + i];
        if (news == 0) continue;

        job->passed[first + i] |= news;
        if (y > 0) pass_to_row(job, row - 1, i, news, 1);
        if (y + 1 < ny) pass_to_row(job, row + 1, i, news, 4);
        if (z > 0) pass_to_row(job, row - ny, i, news, 2);
        if (z + 1 < (uint64_t)job->nz) pass_to_row(job, row + ny, i, news, 5);
        expose_base_octets(job, first + i, news << 1, 0); /* beyond +x: their face towards -x */
        expose_base_octets(job, first + i, news >> 1, 3);
        if (i + 1 < (uint64_t)job->row_words) expose_base_octets(job, first + i + 1, news >> 63, 0);
        if (i > 0) expose_base_octets(job, first + i - 1, news << 63, 3);
    }
}

/* Beyond the lattice is outside: its sides are exposed. */
static void expose_sides(states_job *job)
{
    uint64_t const rows = (uint64_t)job->ny * (uint64_t)job->nz;

    for (uint64_t row = 0; row < rows; row++) {
        int32_t const y = (int32_t)(row % (uint64_t)job->ny), z = (int32_t)(row / (uint64_t)job->ny);
        for (int32_t i = 0; i < job->row_words; i++) {
            uint64_t const word = row * (uint64_t)job->row_words + (uint64_t)i, all = ~UINT64_C(0);

            /* Voxels of this word on the six sides of the lattice, beyond which all is outside. */
            uint64_t const side[BVXI_DIRECTIONS] = {
                i == 0 ? 1 : 0,
                y == 0 ? all : 0,
                z == 0 ? all : 0,
                i + 1 == job->row_words ? UINT64_C(1) << ((job->nx - 1) & 63) : 0,
                y + 1 == job->ny ? all : 0,
                z + 1 == job->nz ? all : 0};
            uint64_t sides = 0;
            for (int d = 0; d < BVXI_DIRECTIONS; d++) {
                sides |= side[d];
                expose_base_octets(job, word, side[d], d);
            }
            job->tree->root.outside[word] |= sides & empty_of_row(job, word);
            if ((sides & empty_of_row(job, word)) != 0) list_base_row(job, row);
        }
    }
}

/* ---- What is outside: boundary states handed from voxel to voxel until nothing changes ---- */

/* The paper's sections 2.1 and 2.2: six bits 00zyx-z-y-x say through which faces a voxel borders on the outside; a child
 * p = x + 2 y + 4 z takes those of its octet that are its own too: I(p) = (p << 3) | (~p & 7). The paper's
 * one traversal depends on its order; here a worklist holds every octet with news until none is left, and a
 * triangle-free voxel of any size that is exposed becomes outside. The last state is the least fixed point,
 * whatever the order.
 *
 * Octets are worked on as masks of eight children; those of the last but one level, together with the octets
 * of their children, as cubes of 64 voxels in a word (cubes.h). Between them:
 *   to a child that is split: its boundary state, as the whole face is outside;
 *   to the neighbour of the same size: its voxels on that side;
 *   to a larger one without triangles: the bit that it is in its own octet, or in the base.
 * Neighbours are found by going up to the first octet that holds both, or over the base, and down again on
 * the other side. The base is flooded by rows of bits (states.c). Guarantee: exact. */

/* An octet of the same level, or a leaf at least as large: child `bit` of an octet, or a bit of the base. */
typedef struct octree_neighbour {
    int32_t level; /* of the octet */
    int32_t kind;  /* NEIGHBOUR_... */
    uint64_t octet, bit;
} octree_neighbour;

enum { NEIGHBOUR_NONE = 0, NEIGHBOUR_OCTET = 1, NEIGHBOUR_CHILD = 2, NEIGHBOUR_BASE = 3 };

static inline void expose_children(states_job *job, int32_t level, uint64_t octet, uint32_t children)
{
    octet_news *const o = news_of(job, level, octet);
    uint32_t const fresh = children & ~(uint32_t)(o->touched | o->outside | o->fresh);
    if (fresh == 0) return;
    o->fresh = (uint8_t)(o->fresh | fresh);
    list_octet(job, level, octet, &o->state);
}

static inline uint64_t octet_below(const states_job *job, int32_t level, uint64_t octet, uint32_t p)
{
    return bvxi_octets_rank(&job->tree->octets[level], 8 * octet + p);
}

/* ---- neighbours ---- */

static octree_neighbour neighbour_of(const states_job *job, int32_t level, uint64_t octet, int d)
{
    uint32_t const across = 1u << d % 3, side = d >= 3 ? across : 0;
    uint8_t path[BVXI_OCTREE_LEVELS]; /* children on the way up */
    int32_t depth = 0;
    octree_neighbour at = {level, NEIGHBOUR_OCTET, octet, 0};

    /* Up, until an octet has the other side among its own children. */
    for (int over = 0; !over;) {
        uint32_t const up = job->up[at.level][at.octet];
        if (at.level == 0) {
            /* The base voxel beyond the face, if any, of the one with this linear index. */
            uint32_t const nx = (uint32_t)job->nx, ny = (uint32_t)job->ny;
            int32_t v[3] = {(int32_t)(up % nx), (int32_t)(up / nx % ny), (int32_t)(up / nx / ny)};
            v[d % 3] += d >= 3 ? 1 : -1;
            at.kind = v[d % 3] < 0 || v[d % 3] >= job->tree->base[d % 3] ? NEIGHBOUR_NONE : NEIGHBOUR_BASE;
            if (at.kind == NEIGHBOUR_NONE) return at;
            at.bit = bvxi_root_bit(job->tree, v[0], v[1], v[2]);
            if (!bvxi_octets_is_split(&job->tree->root, at.bit)) return at;
            at.octet = bvxi_octets_rank(&job->tree->root, at.bit);
            break;
        }
        path[depth++] = (uint8_t)(up & 7);
        at.octet = up >> 3;
        at.level--;
        over = ((up & across) ^ side) != 0; /* the octet holds both sides */
    }
    while (depth > 0) { /* down again on the other side */
        uint32_t const p = path[--depth] ^ across;
        at.kind = NEIGHBOUR_CHILD;
        at.bit = p;

        /* A leaf of any size ends the way: it is the neighbour. */
        if ((news_of(job, at.level, at.octet)->split >> p & 1) == 0) return at;
        at.octet = octet_below(job, at.level, at.octet, p);
        at.level++;
    }
    at.kind = NEIGHBOUR_OCTET;
    return at;
}

/* ---- octets ---- */

/* Children of the octet beyond face d, beside `children` of this one. */
static void pass_to_octet(states_job *job, int32_t level, uint64_t octet, int d, uint32_t children)
{
    unsigned const step = 1u << d % 3;
    uint32_t const beside = d >= 3 ? children >> step : children << step;
    /* Leaves become outside themselves; split ones pass it on to their own children on that face. */
    expose_children(job, level, octet, beside);
    for (uint32_t p = 0, split = beside & news_of(job, level, octet)->split; split != 0; p++, split >>= 1)
        if ((split & 1) != 0)
            expose_octet(job, level + 1, octet_below(job, level, octet, p), 1u << (d + 3) % 6);
}

static inline void pass_to_leaf(states_job *job, const octree_neighbour *beyond)
{
    if (beyond->kind == NEIGHBOUR_CHILD)
        expose_children(job, beyond->level, beyond->octet, 1u << beyond->bit);
    if (beyond->kind != NEIGHBOUR_BASE) return;
    uint64_t *const word = &job->tree->root.outside[beyond->bit >> 6];
    uint64_t const one = UINT64_C(1) << (beyond->bit & 63);
    if ((*word & one) != 0 || bvxi_bit_of(job->tree->root.touched, beyond->bit)) return;
    *word |= one;
    list_base_row(job, (beyond->bit >> 6) / (uint64_t)job->row_words);
}

static void work_on_octet(states_job *job, int32_t level, uint64_t octet)
{
    octet_news *const o = news_of(job, level, octet);
    uint32_t const open = 255 & ~(uint32_t)(o->touched | o->outside);
    uint32_t news = o->fresh;

    /* What came from outside through whole faces, and what a neighbour exposed by name. */
    for (int d = 0; d < BVXI_DIRECTIONS; d++)
        if ((o->state >> d & 1) != 0) news |= bvxi_octet_side(d);
    news &= open;

    /* At most seven rounds: the flood of eight voxels in one byte, from each to its neighbours in the octet. */
    for (uint32_t m = 0; m != news;) {
        m = news;
        news |= ((m & 0x55) << 1 | (m & 0xaa) >> 1 | (m & 0x33) << 2 | (m & 0xcc) >> 2 | (m & 0x0f) << 4 |
                 (m & 0xf0) >> 4) &
                open;
    }

    /* Off the list before anything is passed on: a neighbour may expose more of it and list it again. */
    o->state = (uint8_t)(o->state & ~IN_LIST);
    o->fresh = 0;
    o->outside = (uint8_t)(o->outside | news);
    if (o->split != 0) {
        /* To split children where those beside them, or all of the octet's face, became outside. */
        uint64_t below = octet_below(job, level, octet, 0);
        /* Split children are ranked in the order of their bits, so one running index finds each. */
        for (uint32_t p = 0; p < 8; p++) {
            uint32_t state = o->state & (p << 3 | (~p & 7)); /* what child p takes from its octet's */
            if ((o->split >> p & 1) == 0) continue;
            for (uint32_t a = 0; a < 3; a++)
                if ((news >> (p ^ 1u << a) & 1) != 0) state |= 1u << (p >> a & 1 ? a : a + 3);
            if (state != 0) expose_octet(job, level + 1, below, state);
            below++;
        }
    }
    for (int d = 0; d < BVXI_DIRECTIONS; d++) {
        uint32_t const children = news & bvxi_octet_side(d);
        if (children == 0) continue;
        octree_neighbour const beyond = neighbour_of(job, level, octet, d);
        if (beyond.kind == NEIGHBOUR_OCTET) pass_to_octet(job, level, beyond.octet, d, children);
        else pass_to_leaf(job, &beyond);
    }
}

static void work_on_cube(states_job *job, uint64_t octet)
{
    cube_news *const c = &job->cubes[octet];
    uint64_t const open = ~(c->touched | c->outside);
    uint64_t news = c->fresh;

    for (int d = 0; d < BVXI_DIRECTIONS; d++)
        if ((c->state >> d & 1) != 0) news |= bvxi_cube_side(d);

    news = bvxi_cube_flood(news & open, open);
    c->state = (uint8_t)(c->state & ~IN_LIST);
    c->fresh = 0;
    c->outside |= news;
    for (int d = 0; d < BVXI_DIRECTIONS; d++) {
        uint64_t const side = news & bvxi_cube_side(d);
        if (side == 0) continue;
        octree_neighbour const beyond = neighbour_of(job, job->bottom, octet, d);
        if (beyond.kind != NEIGHBOUR_OCTET) {
            pass_to_leaf(job, &beyond);
            continue;
        }
        cube_news *const next = &job->cubes[beyond.octet];
        uint64_t const fresh = bvxi_cube_beyond(side, d) & ~(next->touched | next->outside | next->fresh);
        if (fresh == 0) continue;
        next->fresh |= fresh;
        list_octet(job, job->bottom, beyond.octet, &next->state);
    }
}

/* ---- all of it ---- */

enum { OCTETS_BETWEEN_QUESTIONS = 1 << 17, STATES_GRAIN = 1024 };

static bvx_status work_until_done(bvx_context *ctx, states_job *job)
{
    uint32_t since = 0;
    while (job->rows_listed > 0 || job->listed > 0) {
        /* Rows of the base first: one fills 64 voxels at a time and leaves less to the octets. Any order
         * gives the same end. */
        if (job->rows_listed > 0) {
            work_on_row(job, job->row_list[--job->rows_listed]);
        } else {
            uint64_t const number = job->list[--job->listed];
            int32_t level = job->bottom;
            while (job->first[level] > number) level--;
            if (level == job->bottom) work_on_cube(job, number - job->first[level]);
            else work_on_octet(job, level, number - job->first[level]);
        }
        if (++since < OCTETS_BETWEEN_QUESTIONS) continue;
        since = 0;
        BVXI_TRY(bvxi_progress(ctx, "refine", 0.5));
    }
    return BVX_OK;
}

static void take_cubes(void *user, uint64_t begin, uint64_t end)
{
    const states_job *const job = user;
    for (uint64_t n = begin; n < end; n++) {
        const bvxi_octets *const o = &job->tree->octets[job->bottom];
        uint32_t const touched = bvxi_octet_mask(o->touched, n), split = bvxi_octet_split(o, n);
        uint64_t below = split != 0 ? bvxi_octets_rank(o, 8 * n) : 0, cube = 0;

        /* A child that is touched but not split is a wall as a whole; one that is split shows its own eight. */
        for (uint32_t p = 0; p < 8; p++) {
            uint64_t child = (touched >> p & 1) != 0 ? BVXI_CUBE_CHILD : 0;
            if ((split >> p & 1) != 0)
                child = bvxi_cube_spread(
                    bvxi_octet_mask(job->tree->octets[job->bottom + 1].touched, below++));
            cube |= child << bvxi_cube_shift(p);
        }
        memset(&job->cubes[n], 0, sizeof job->cubes[n]);
        job->cubes[n].touched = cube;
    }
}

/* Pieces are whole words of the masks. */
static void words_of_piece(const states_job *job, int32_t level, int32_t index, uint64_t *begin,
                           uint64_t *end)
{
    uint64_t const count = job->tree->octets[level].count;
    bvxi_piece(job->tree->octets[level].words, job->pieces, index, begin, end);
    *begin *= 8;
    *end = *end * 8 < count ? *end * 8 : count;
}

static void give_cubes(void *user, int32_t index)
{
    const states_job *const job = user;
    const bvxi_octets *const o = &job->tree->octets[job->bottom];
    uint64_t begin, end;

    words_of_piece(job, job->bottom, index, &begin, &end);
    for (uint64_t n = begin; n < end; n++) { /* a leaf has all or none of its voxels */
        uint32_t const leaves = 255 & ~bvxi_octet_mask(o->touched, n);
        uint32_t outside = 0;
        for (uint32_t p = 0; p < 8; p++)
            outside |= (uint32_t)(job->cubes[n].outside >> bvxi_cube_shift(p) & 1) << p;
        bvxi_octet_put(o->outside, n, outside & leaves);
    }

    if (o->split == NULL) return;
    words_of_piece(job, job->bottom + 1, index, &begin, &end);
    for (uint64_t n = begin; n < end; n++) {
        uint32_t const up = job->up[job->bottom + 1][n];
        uint64_t const child = job->cubes[up >> 3].outside >> bvxi_cube_shift(up & 7);
        bvxi_octet_put(job->tree->octets[job->bottom + 1].outside, n, bvxi_cube_gather(child));
    }
}

static int32_t bottom_of_levels(int32_t levels)
{
    return levels >= 2 ? levels - 2 : levels - 1;
}

static uint64_t octets_above(const bvx_octree *tree, int32_t bottom)
{
    uint64_t octets = 0;
    for (int32_t l = 0; l < bottom; l++) octets += tree->octets[l].count;
    return octets;
}

uint64_t bvxi_states_bytes(const bvx_octree *tree, int32_t levels)
{
    int32_t const bottom = bottom_of_levels(levels);
    uint64_t const octets = octets_above(tree, bottom), cubes = bottom >= 0 ? tree->octets[bottom].count : 0;
    /* The sum of what bvxi_octree_states lays into its one block. */
    return cubes * (sizeof(cube_news) + 4) + octets * (sizeof(octet_news) + 4) + tree->root.words * 8 +
           tree->root.count * 5;
}

static bvx_status find_states(bvx_context *ctx, states_job *job)
{
    /* A tree of one level has no octets: the base's rows are all there is. */
    if (job->bottom < 0) {
        expose_sides(job);
        return work_until_done(ctx, job);
    }
    job->pieces = bvxi_piece_count(job->tree->octets[job->bottom].count, STATES_GRAIN);
    for (int32_t l = 0; l < job->bottom; l++)
        for (uint64_t n = 0; n < job->tree->octets[l].count; n++) {
            octet_news const fresh = {(uint8_t)bvxi_octet_mask(job->tree->octets[l].touched, n),
                                      (uint8_t)bvxi_octet_split(&job->tree->octets[l], n), 0, 0, 0};
            *news_of(job, l, n) = fresh;
        }
    BVXI_TRY(BVXI_SHARE(
        ctx, 0.0, 0.2,
        bvxi_for(ctx, "refine", job->tree->octets[job->bottom].count, STATES_GRAIN, take_cubes, job)));
    expose_sides(job);
    BVXI_TRY(work_until_done(ctx, job));
    for (int32_t l = 0; l < job->bottom; l++)
        for (uint64_t n = 0; n < job->tree->octets[l].count; n++)
            bvxi_octet_put(job->tree->octets[l].outside, n, news_of(job, l, n)->outside);
    return bvxi_each(ctx, "refine", 0.8, 1.0, job->pieces, give_cubes, job);
}

bvx_status bvxi_octree_states(bvx_context *ctx, bvx_octree *tree, uint32_t *const *up)
{
    int32_t const bottom = bottom_of_levels(tree->levels);
    uint64_t const octets = octets_above(tree, bottom), cubes = bottom >= 0 ? tree->octets[bottom].count : 0;
    uint64_t const bytes = bvxi_states_bytes(tree, tree->levels);
    states_job job = {.tree = tree, .up = up};
    unsigned char *block;

    if (octets + cubes >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "bvx_refine: %u voxels are split; 2^32 - 2 are possible", octets + cubes);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the boundary states", &block));
    job.bottom = bottom;
    job.nx = tree->base[0];
    job.ny = tree->base[1];
    job.nz = tree->base[2];
    job.row_words = tree->row_words;
    for (int32_t l = 0; l < bottom; l++) job.first[l + 1] = job.first[l] + tree->octets[l].count;

    /* One block, the widest types first, so that each part is aligned without padding between them. */
    job.cubes = (cube_news *)(void *)block;
    job.passed = (uint64_t *)(void *)(job.cubes + cubes);
    job.list = (uint32_t *)(void *)(job.passed + tree->root.words);
    job.row_list = job.list + octets + cubes;
    job.news = (octet_news *)(void *)(job.row_list + tree->root.count);
    job.row_in_list = (uint8_t *)(job.news + octets);
    memset(job.passed, 0, (size_t)tree->root.words * 8);
    memset(job.row_in_list, 0, (size_t)tree->root.count);
    bvx_status const status = find_states(ctx, &job);
    bvxi_drop(ctx, block);
    return status;
}
