/* oblique_plain.c - the surface in cells that no plane splits, 64 cells at a time.
 *
 * Source: Doi, Koide. An efficient method of triangulating equi-valued surfaces by using tetrahedral cells.
 * 1991, over the six tetrahedra of Kuhn that oblique_cells.c has too.
 *
 * All edges of those tetrahedra run from a vertex of the lattice along one to three axes at once: seven
 * ways. So the crossed edges of a block are seven words of bits, found by comparing the block's signs with
 * themselves moved by one, and the number of an edge's vertex is a rank among those bits. */
#include "oblique/oblique.h"

#include "bits/bits.h"

enum {
    PLAIN_GRAIN = 64,     /* blocks of a piece */
    PLAIN_NODES = 125,    /* of a block with those behind it */
    PLAIN_TRIANGLES = 12, /* of a cell: two of each tetrahedron */
    PLAIN_EDGES = 19      /* of a cell */
};

/* Corners as bits x, y, z; positive. Entries 6 on: the axes in order of each way. */
const uint8_t bvxi_kuhn[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                 {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};

/* ---- tetrahedra by the signs of their corners ---- */

/* Edges (inside, outside) around a surface in a positive tetrahedron, seen counter-clockwise from outside. */
int bvxi_oblique_case(int inside, uint8_t edge[4][2])
{
    /* the other three corners, in the order in which they are seen from a corner outwards */
    static const uint8_t others[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    /* pairs of corners whose order with the other two behind them is an even permutation */
    static const uint8_t even[4][4] = {{0, 1, 0, 1}, {0, 0, 1, 0}, {0, 0, 0, 1}, {0, 0, 0, 0}};
    uint8_t in[4], out[4];
    int ins = 0, outs = 0;

    for (uint8_t k = 0; k < 4; k++) {
        if (inside >> k & 1) in[ins++] = k;
        else out[outs++] = k;
    }
    if (ins == 0 || outs == 0) return 0;
    if (ins == 2) {
        int const positive = even[in[0]][in[1]];
        for (int k = 0; k < 4; k++) {
            int const n = positive ? k : (4 - k) & 3;
            edge[n][0] = in[k >= 2];
            edge[n][1] = out[k == 1 || k == 2];
        }
        return 4;
    }
    for (int k = 0; k < 3; k++) {
        /* From a corner inside outwards, or towards one outside: that is the other way round. */
        int const n = ins == 1 ? k : (3 - k) % 3;
        edge[n][0] = ins == 1 ? in[0] : others[out[0]][k];
        edge[n][1] = ins == 1 ? others[in[0]][k] : out[0];
    }
    return 3;
}

/* What a cell has by the signs of its eight corners: an edge is its lower corner and 8 times its way. */
typedef struct plain_case {
    uint8_t edge[PLAIN_EDGES], edges;
    uint8_t triangle[PLAIN_TRIANGLES][3], triangles; /* of places in edge */
} plain_case;

static void make_plain_case(plain_case *c, int signs)
{
    memset(c, 0, sizeof *c);
    for (int k = 0; k < 6; k++) {
        const uint8_t *const corner = bvxi_kuhn[k];
        uint8_t edge[4][2], number[4];
        int inside = 0, n;

        for (int x = 0; x < 4; x++) inside |= (signs >> corner[x] & 1) << x;
        n = bvxi_oblique_case(inside, edge);
        for (int i = 0; i < n; i++) {
            uint8_t const a = corner[edge[i][0]], b = corner[edge[i][1]];
            uint8_t const code = (uint8_t)((a < b ? a : b) | (a ^ b) << 3);
            for (number[i] = 0; number[i] < c->edges && c->edge[number[i]] != code;) number[i]++;
            if (number[i] == c->edges) c->edge[c->edges++] = code;
        }
        for (int i = 2; i < n; i++) {
            uint8_t *const t = c->triangle[c->triangles++];
            t[0] = number[0];
            t[1] = number[i - 1];
            t[2] = number[i];
        }
    }
}

/* ---- words of a block ---- */

#define LAST_X  UINT64_C(0x8888888888888888)
#define LAST_Y  UINT64_C(0xf000f000f000f000)
#define FIRST_X UINT64_C(0x1111111111111111)
#define FIRST_Y UINT64_C(0x000f000f000f000f)

/* Bits of the vertex, or cell, one on along an axis; more: the word of the next block there. */
static uint64_t one_on(uint64_t word, uint64_t more, int axis)
{
    if (axis == 0) return (word >> 1 & ~LAST_X) | (more << 3 & LAST_X);
    if (axis == 1) return (word >> 4 & ~LAST_Y) | (more << 12 & LAST_Y);
    return word >> 16 | more << 48;
}

static uint64_t one_back(uint64_t word, uint64_t less, int axis)
{
    if (axis == 0) return (word << 1 & ~FIRST_X) | (less >> 3 & FIRST_X);
    if (axis == 1) return (word << 4 & ~FIRST_Y) | (less >> 12 & FIRST_Y);
    return word << 16 | less >> 48;
}

/* The known block so many on, or BVXI_NONE; *block is its number, or UINT64_MAX beyond the lattice. */
static uint32_t block_beside(const bvxi_oblique *o, uint32_t known, int corner, int way, uint64_t *block)
{
    uint64_t const of = o->known[known];
    int64_t step = 1, at = (int64_t)of;
    uint64_t left = of;

    for (int k = 0; k < 3; k++) {
        int64_t const place = (int64_t)(left % (uint64_t)o->blocks[k]) + (corner >> k & 1) * way;
        left /= (uint64_t)o->blocks[k];
        *block = UINT64_MAX;
        if (place < 0 || place >= o->blocks[k]) return BVXI_NONE;
        at += (corner >> k & 1) * way * step;
        step *= o->blocks[k];
    }
    *block = (uint64_t)at;
    return o->block_at[at] < 0 ? BVXI_NONE : (uint32_t)o->block_at[at];
}

/* A bit of the block's vertices' kinds, moved to a cell's corners: [0] is the block's own. */
static void bits_around(const bvxi_oblique *o, uint32_t known, uint32_t bit, uint64_t moved[8])
{
    const uint64_t *const inside = o->inside + (uint64_t)bit * o->known_count;

    /* Where nothing is known of a block all its vertices are of one kind; beyond the lattice is outside. */
    for (int c = 0; c < 8; c++) {
        uint64_t block;
        uint32_t const n = block_beside(o, known, c, 1, &block);
        moved[c] = n != BVXI_NONE                                             ? inside[n]
                   : block != UINT64_MAX && (o->block_kind[block] >> bit & 1) ? UINT64_MAX
                                                                              : 0;
    }
    /* Axis after axis: a corner's word follows from the one without that axis and from what lies behind. */
    for (int axis = 0; axis < 3; axis++)
        for (int c = 7; c >= 0; c--)
            if (c >> axis & 1) moved[c] = one_on(moved[c ^ 1 << axis], moved[c], axis);
}

uint64_t bvxi_oblique_mixed(const bvxi_oblique *o, uint32_t known)
{
    uint64_t mixed = 0;
    for (uint32_t bit = 0; bit < bvxi_oblique_kind_bits(o); bit++) {
        uint64_t moved[8], any = 0, all = UINT64_MAX;
        bits_around(o, known, bit, moved);
        for (int c = 0; c < 8; c++) {
            any |= moved[c];
            all &= moved[c];
        }
        mixed |= any & ~all;
    }
    return mixed;
}

static void signs_of_known(void *user, uint64_t begin, uint64_t end)
{
    bvxi_oblique *const o = user;
    for (uint64_t i = begin; i < end; i++)
        for (uint32_t bit = 0; bit < bvxi_oblique_kind_bits(o); bit++) {
            uint64_t word = 0;
            for (int n = 0; n < BVXI_BLOCK_SIZE; n++) {
                int const kind = bvxi_oblique_kind_of(o, o->value[i * BVXI_BLOCK_SIZE + (uint64_t)n]);
                word |= (uint64_t)(kind >> bit & 1) << n;
            }
            o->inside[(uint64_t)bit * o->known_count + i] = word;
        }
}

bvx_status bvxi_oblique_take_signs(bvxi_oblique *o)
{
    return bvxi_for(o->ctx, "surface", o->known_count, PLAIN_GRAIN, signs_of_known, o);
}

/* ---- crossed edges ---- */

typedef struct plain_job {
    bvxi_oblique *o;
    uint32_t *triangles; /* [known + 1] of each block, then before it */
    plain_case cases[256];
} plain_job;

static int signs_of_cell(const uint64_t moved[8], int cell)
{
    int signs = 0;
    for (int c = 0; c < 8; c++) signs |= (int)(moved[c] >> cell & 1) << c;
    return signs;
}

static void plain_crossed_piece(void *user, uint64_t begin, uint64_t end)
{
    const plain_job *const job = user;
    const bvxi_oblique *const o = job->o;
    for (uint64_t i = begin; i < end; i++) {
        uint64_t moved[8], has[8];
        uint32_t triangles = 0;

        bits_around(o, (uint32_t)i, 0, moved);
        for (int c = 0; c < 8; c++) {
            uint64_t block;
            uint32_t const n = block_beside(o, (uint32_t)i, c, -1, &block);
            has[c] = n == BVXI_NONE ? 0 : o->active[n];
        }
        /* Then has[c] says of each vertex whether the cell that lies back from it by c is plain. */
        for (int axis = 0; axis < 3; axis++)
            for (int c = 7; c >= 0; c--)
                if (c >> axis & 1) has[c] = one_back(has[c ^ 1 << axis], has[c], axis);
        for (int way = 1; way < 8; way++) {
            uint64_t used = 0;
            /* An edge counts where a cell with it is plain; those of split cells alone are looked for there. Its
             * cells lie back from its lower vertex along the axes that it does not run along. */
            for (int c = 0; c < 8; c++)
                if ((c & way) == 0) used |= has[c];
            o->crossed[i].edges[way - 1] = (moved[0] ^ moved[way]) & used;
        }
        for (uint64_t cells = o->active[i]; cells != 0; cells &= cells - 1)
            triangles += job->cases[signs_of_cell(moved, bvxi_lowest(cells))].triangles;
        job->triangles[i] = triangles;
    }
}

uint32_t bvxi_oblique_plain_vertex(const bvxi_oblique *o, uint32_t known, int bit, int way)
{
    const bvxi_oblique_crossed *const x = &o->crossed[known];
    uint64_t const edges = x->edges[way - 1], below = (UINT64_C(1) << bit) - 1;
    if (!(edges >> bit & 1)) return BVXI_NONE;
    return x->first[way - 1] + bvxi_popcount(edges & below);
}

/* ---- vertices and triangles ---- */

static double place_at_share(const double in[3], const double out[3], double share, double at[3])
{
    if (share < BVXI_CROSSING_LEAST) share = BVXI_CROSSING_LEAST;
    if (share > 1.0 - BVXI_CROSSING_LEAST) share = 1.0 - BVXI_CROSSING_LEAST;
    for (int k = 0; k < 3; k++) at[k] = in[k] + share * (out[k] - in[k]);
    return share;
}

void bvxi_oblique_cross_edge(const double in[3], double rise, const double out[3], double fall, double at[3])
{
    (void)place_at_share(in, out, rise + fall > 0.0 ? rise / (rise + fall) : 0.5, at);
}

void bvxi_oblique_cross_again(const double in[3], double rise, const double out[3], double fall,
                              double middle, double at[3])
{
    double share = place_at_share(in, out, rise + fall > 0.0 ? rise / (rise + fall) : 0.5, at);
    /* Distances bend along an edge, and the first straight line errs by the square of a cell, always to the
     * hollow side. A second one from where it ended errs by far less. The ends keep their sides, whatever the
     * number between says. */
    if (middle > 0.0) share += (1.0 - share) * middle / (middle + fall);
    else if (middle < 0.0) share *= rise / (rise - middle);
    (void)place_at_share(in, out, share, at);
}

static void blocks_beside(const bvxi_oblique *o, uint32_t known, uint32_t beside[8])
{
    uint64_t block;
    for (int c = 0; c < 8; c++) beside[c] = block_beside(o, known, c, 1, &block);
}

/* The vertex that is on from one by a way: its number in its block; *beyond: in which of those beside. */
static int vertex_on(int bit, int way, int *beyond)
{
    int n = 0;
    *beyond = 0;
    for (int k = 0; k < 3; k++) {
        int const place = (bit >> 2 * k & 3) + (way >> k & 1);
        *beyond |= place >> 2 << k;
        n |= (place & 3) << 2 * k;
    }
    return n;
}

static void plain_triangles(const plain_job *job, uint32_t known)
{
    const bvxi_oblique *const o = job->o;
    uint32_t *t = o->mesh.triangle + 3 * (uint64_t)job->triangles[known];
    uint64_t moved[8];
    uint32_t beside[8];

    bits_around(o, known, 0, moved);
    blocks_beside(o, known, beside);
    for (uint64_t cells = o->active[known]; cells != 0; cells &= cells - 1) {
        int const cell = bvxi_lowest(cells);
        const plain_case *const c = &job->cases[signs_of_cell(moved, cell)];
        uint32_t number[PLAIN_EDGES];
        for (int e = 0; e < c->edges; e++) {
            int beyond, n = vertex_on(cell, c->edge[e] & 7, &beyond);
            number[e] = bvxi_oblique_plain_vertex(o, beside[beyond], n, c->edge[e] >> 3);
        }
        for (int i = 0; i < c->triangles; i++, t += 3)
            for (int k = 0; k < 3; k++) t[k] = number[c->triangle[i][k]];
    }
}

static void plain_surface_piece(void *user, uint64_t begin, uint64_t end)
{
    const plain_job *const job = user;
    const bvxi_oblique *const o = job->o;
    for (uint64_t i = begin; i < end; i++) {
        const bvxi_oblique_crossed *const crossed = &o->crossed[i];
        uint32_t plane[BVXI_OBLIQUE_PLANES], heard[BVXI_OBLIQUE_PLANES], planes, heard_count, beside[8];
        int32_t first[3];

        bvxi_oblique_block_place(o, o->known[i], first);
        planes = bvxi_oblique_near_planes(o, first, plane);
        heard_count = bvxi_oblique_heard_planes(o, first, heard);
        blocks_beside(o, (uint32_t)i, beside);
        for (int way = 1; way < 8; way++) {
            double *position = o->mesh.position + 3 * (uint64_t)crossed->first[way - 1];
            for (uint64_t left = crossed->edges[way - 1]; left != 0; left &= left - 1, position += 3) {
                double ends[2][3], value[2], at[3];

                for (int e = 0; e < 2; e++) {
                    int32_t place[3];
                    int beyond, n = vertex_on(bvxi_lowest(left), e == 1 ? way : 0, &beyond);
                    bvxi_oblique_in_block(first, n, place);
                    for (int k = 0; k < 3; k++) place[k] += BVXI_BLOCK_SIDE * (beyond >> k & 1);
                    bvxi_oblique_place_among(o, place, plane, planes, ends[e]);
                    value[e] = o->value[(uint64_t)beside[beyond] * BVXI_BLOCK_SIZE + (uint64_t)n];
                }
                /* From inside outwards, as tetrahedra do: the place must not depend on who computes it. */
                int const in = value[0] > 0.0 ? 0 : 1;
                double const rise = bvxi_absolute(value[in]), fall = bvxi_absolute(value[!in]);
                bvxi_oblique_cross_edge(ends[in], rise, ends[!in], fall, at);
                bvxi_oblique_cross_again(ends[in], rise, ends[!in], fall,
                                         bvxi_oblique_number_among(o, at, heard, heard_count), at);
                for (int k = 0; k < 3; k++) position[k] = o->origin[k] + o->step * at[k];
            }
        }
        if (o->active[i] != 0) plain_triangles(job, (uint32_t)i);
    }
}

bvx_status bvxi_oblique_plain(bvxi_oblique *o, uint64_t more)
{
    static const char what[] = "the surface";
    bvx_context *const ctx = o->ctx;
    uint64_t const n = o->known_count;
    plain_job *job;

    if (o->crossed == NULL) BVXI_TRY(BVXI_ARRAY(ctx, n, "the crossed edges", o->crossed));
    BVXI_TRY(BVXI_ARRAY(ctx, 1, "the crossed edges", job));
    BVXI_TRY(BVXI_ARRAY(ctx, n + 1, "the crossed edges", job->triangles));
    job->o = o;
    for (int signs = 0; signs < 256; signs++) make_plain_case(&job->cases[signs], signs);
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.1, bvxi_oblique_take_signs(o)));
    BVXI_TRY(BVXI_SHARE(ctx, 0.1, 0.3, bvxi_for(ctx, "surface", n, PLAIN_GRAIN, plain_crossed_piece, job)));

    uint64_t vertices = 0, triangles = 0;

    for (uint32_t i = 0; i < o->known_count; i++) {
        uint32_t const count = job->triangles[i];
        for (int way = 0; way < 7; way++) {
            o->crossed[i].first[way] = (uint32_t)vertices;
            vertices += bvxi_popcount(o->crossed[i].edges[way]);
        }
        job->triangles[i] = (uint32_t)triangles;
        triangles += count;
        if (vertices > INT32_MAX || triangles > INT32_MAX)
            return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the surface has more than 2^31 triangles", o->function);
    }
    job->triangles[o->known_count] = (uint32_t)triangles;
    o->mesh.vertex_count = vertices;
    o->mesh.triangle_count = o->plain_triangles = triangles;

    /* A closed surface has half as many vertices as triangles; those of split cells follow these. */
    uint64_t const positions = o->mesh.vertex_count + more / 2 + 1024;
    BVXI_TRY(bvxi_reserve(ctx, &o->mesh.position, positions, &o->mesh.vertex_room, 24, what));
    BVXI_TRY(bvxi_reserve(ctx, &o->mesh.triangle, o->mesh.triangle_count + more + 1, &o->mesh.triangle_room,
                          12, what));
    return BVXI_SHARE(ctx, 0.3, 1.0, bvxi_for(ctx, "surface", n, PLAIN_GRAIN, plain_surface_piece, job));
}
