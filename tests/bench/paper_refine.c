/* paper_refine.c - refinement as the paper of boundary states describes it: the baseline for bvx_refine.
 *
 * Source: "Refinement of surface voxels by boundary states" 1.2 to 2.3: voxels of the base with lists of the
 * triangles that touch them, found by separating axes; a flood from outside; each voxel with triangles
 * becomes the root of an octree and is split in eight, children are tested against their parent's triangles
 * and inherit the faces of its boundary state that are theirs; a child without triangles is deleted when its
 * state is not 0, and passes its faces on to its neighbours, which are found by index and depth: up to the
 * root, over to the next tree, down again.
 *
 * Written to be quick within that plan: nodes and lists come from blocks that are handed out front to back,
 * eight children stand together, a triangle is made ready once for all eight. Where one traversal would
 * depend on its order, faces are passed on from a worklist, to large voxels and into split ones too: that is
 * what it takes to be right. Doubles throughout. */
#include "paper_refine.h"
#include "box_triangle_loop.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { BLOCK_BYTES = 4 << 20, MOST_BLOCKS = 400, FREE = 0, TOUCHED = 1, OUTSIDE = 2 };

typedef struct node {
    struct node *children; /* eight, or NULL */
    uint32_t *triangles;
    uint32_t triangle_count;
    uint8_t state; /* 00zyx-z-y-x: faces to the outside */
    uint8_t kind;
} node;

/* A node with its index among the voxels of its depth. */
typedef struct place {
    node *node;
    int32_t ijk[3];
    int32_t depth;
} place;

typedef struct place_list {
    place *at;
    uint64_t count, room;
} place_list;

struct paper_tree {
    bench_memory *memory;
    node *base;
    double *points; /* in voxels of the base */
    uint64_t point_count, base_count;
    const uint32_t *triangles;
    int32_t dims[3];
    struct {
        void *bytes;
        size_t size;
    } block[MOST_BLOCKS];
    int blocks;
    size_t block_used;
    uint64_t tests, bytes;
    place_list fresh;   /* touched voxels of the newest level */
    place_list passing; /* deleted voxels whose faces are still to be passed on */
};

/* ---- memory ---- */

static void *take_bytes(bench_memory *memory, size_t size)
{
    void *const p = bench_alloc(memory, size, 64);
    if (p == NULL) {
        fprintf(stderr, "bench: no memory for the paper's octree\n");
        exit(1);
    }
    return p;
}

static void add_block(paper_tree *t, size_t size)
{
    if (t->blocks == MOST_BLOCKS) {
        fprintf(stderr, "bench: the paper's octree takes too many blocks\n");
        exit(1);
    }
    t->block[t->blocks].bytes = take_bytes(t->memory, size);
    t->block[t->blocks++].size = size;
}

/* What is larger than a block gets one of its own, and then the next piece a new one. */
static void *from_block(paper_tree *t, size_t size)
{
    size = (size + 7) / 8 * 8;
    if (t->blocks == 0 || t->block_used + size > t->block[t->blocks - 1].size) {
        add_block(t, size > BLOCK_BYTES ? size : BLOCK_BYTES);
        t->block_used = 0;
    }
    void *const p = (char *)t->block[t->blocks - 1].bytes + t->block_used;
    t->block_used += size;
    t->bytes += size;
    return p;
}

static void add_place(place_list *list, node *n, const int32_t ijk[3], int32_t depth)
{
    if (list->count == list->room) {
        list->room = list->room ? 2 * list->room : 4096;
        list->at = realloc(list->at, (size_t)list->room * sizeof *list->at);
        if (list->at == NULL) exit(1);
    }
    place *const p = &list->at[list->count++];
    p->node = n;
    memcpy(p->ijk, ijk, sizeof p->ijk);
    p->depth = depth;
}

/* ---- boundary states ---- */

/* A voxel learns that its face towards direction d (0 to 5: -x, -y, -z, x, y, z) lies outside; a split one's
 * children on that side do. Without triangles it is deleted. */
static void receive_face(paper_tree *t, node *n, const int32_t ijk[3], int32_t depth, int d)
{
    if (n->children != NULL) {
        for (int p = 0; p < 8; p++) {
            int32_t const child[3] = {2 * ijk[0] + (p & 1), 2 * ijk[1] + (p >> 1 & 1), 2 * ijk[2] + (p >> 2)};
            if ((p >> d % 3 & 1) == d / 3) receive_face(t, &n->children[p], child, depth + 1, d);
        }
        return;
    }
    n->state = (uint8_t)(n->state | 1 << d);
    if (n->kind == FREE) {
        n->kind = OUTSIDE;
        add_place(&t->passing, n, ijk, depth);
    }
}

/* The paper's 2.2.2: up to the root's index, then down as far as the neighbour is split. */
static void pass_face(paper_tree *t, const place *from, int d)
{
    int32_t ijk[3], root[3], depth = 0;
    node *n;

    memcpy(ijk, from->ijk, sizeof ijk);
    ijk[d % 3] += d < 3 ? -1 : 1;
    for (int i = 0; i < 3; i++) {
        root[i] = ijk[i] >= 0 ? ijk[i] >> from->depth : -1;
        if (root[i] < 0 || root[i] >= t->dims[i]) return;
    }
    n = &t->base[((size_t)root[2] * (size_t)t->dims[1] + (size_t)root[1]) * (size_t)t->dims[0] +
                 (size_t)root[0]];
    while (depth < from->depth && n->children != NULL) {
        int const s = from->depth - ++depth;
        n = &n->children[(ijk[0] >> s & 1) | (ijk[1] >> s & 1) << 1 | (ijk[2] >> s & 1) << 2];
    }
    for (int i = 0; i < 3; i++) ijk[i] >>= from->depth - depth;
    receive_face(t, n, ijk, depth, d < 3 ? d + 3 : d - 3);
}

static void pass_all(paper_tree *t)
{
    while (t->passing.count > 0) {
        place const from = t->passing.at[--t->passing.count];
        for (int d = 0; d < 6; d++) pass_face(t, &from, d);
    }
}

/* ---- level 0 ---- */

static void prepare_triangle(const paper_tree *t, uint32_t number, box_triangle *b)
{
    const uint32_t *const c = t->triangles + (size_t)3 * number;
    box_triangle_prepare(b, t->points + (size_t)3 * c[0], t->points + (size_t)3 * c[1],
                         t->points + (size_t)3 * c[2]);
}

typedef struct pair {
    uint32_t voxel, triangle;
} pair;

static void base_range(const box_triangle *b, const paper_tree *t, int32_t first[3], int32_t last[3])
{
    for (int i = 0; i < 3; i++) {
        double const low = ceil(b->low[i]) - 1.0, high = floor(b->high[i]);
        first[i] = low > 0.0 ? (low < t->dims[i] ? (int32_t)low : t->dims[i]) : 0;
        last[i] = high < t->dims[i] - 1 ? (high >= 0.0 ? (int32_t)high : -1) : t->dims[i] - 1;
    }
}

/* The map from voxels to triangles: pairs first, then a list for each voxel. */
static void attach_triangles(paper_tree *t, uint64_t triangle_count)
{
    pair *pairs = NULL;
    uint64_t count = 0, room = 0;

    for (uint64_t n = 0; n < triangle_count; n++) {
        box_triangle b;
        int32_t first[3], last[3];
        prepare_triangle(t, (uint32_t)n, &b);
        base_range(&b, t, first, last);
        for (int32_t z = first[2]; z <= last[2]; z++)
            for (int32_t y = first[1]; y <= last[1]; y++)
                for (int32_t x = first[0]; x <= last[0]; x++) {
                    double const centre[3] = {x + 0.5, y + 0.5, z + 0.5};
                    t->tests++;
                    if (!box_triangle_meets(&b, centre, 0.5)) continue;
                    if (count == room) {
                        room = room ? 2 * room : 65536;
                        pairs = realloc(pairs, (size_t)room * sizeof *pairs);
                        if (pairs == NULL) exit(1);
                    }
                    pairs[count].voxel = (uint32_t)(((size_t)z * (size_t)t->dims[1] + (size_t)y) *
                                                        (size_t)t->dims[0] +
                                                    (size_t)x);
                    pairs[count++].triangle = (uint32_t)n;
                }
    }
    for (uint64_t i = 0; i < count; i++) t->base[pairs[i].voxel].triangle_count++;
    for (uint64_t v = 0; v < t->base_count; v++) {
        node *const n = &t->base[v];
        if (n->triangle_count == 0) continue;
        n->kind = TOUCHED;
        n->triangles = from_block(t, n->triangle_count * sizeof *n->triangles);
        n->triangle_count = 0;
    }
    for (uint64_t i = 0; i < count; i++) {
        node *const n = &t->base[pairs[i].voxel];
        n->triangles[n->triangle_count++] = pairs[i].triangle;
    }
    free(pairs);
}

/* Touched voxels of the base become the first to be split; the flood comes in through the lattice's sides. */
static void start_from_base(paper_tree *t, int states)
{
    node *n = t->base;

    for (int32_t z = 0; z < t->dims[2]; z++)
        for (int32_t y = 0; y < t->dims[1]; y++)
            for (int32_t x = 0; x < t->dims[0]; x++, n++) {
                int32_t const ijk[3] = {x, y, z};
                if (n->kind == TOUCHED) add_place(&t->fresh, n, ijk, 0);
                for (int d = 0; states && d < 6; d++)
                    if (ijk[d % 3] == (d < 3 ? 0 : t->dims[d % 3] - 1)) receive_face(t, n, ijk, 0, d);
            }
    pass_all(t);
}

/* ---- further levels ---- */

static uint8_t *touched_children(paper_tree *t, const place *p, uint8_t *masks, uint64_t *room,
                                 uint32_t counts[8])
{
    double const side = ldexp(1.0, -(p->depth + 1));
    double centre[8][3];
    const node *const n = p->node;

    memset(counts, 0, 8 * sizeof *counts);
    if (*room < n->triangle_count) {
        *room = (uint64_t)n->triangle_count * 2;
        masks = realloc(masks, (size_t)*room);
        if (masks == NULL) exit(1);
    }
    for (int c = 0; c < 8; c++)
        for (int i = 0; i < 3; i++) centre[c][i] = (2 * p->ijk[i] + (c >> i & 1) + 0.5) * side;
    for (uint32_t k = 0; k < n->triangle_count; k++) {
        box_triangle b;
        unsigned mask = 0;
        prepare_triangle(t, n->triangles[k], &b);
        for (int c = 0; c < 8; c++)
            if (box_triangle_meets(&b, centre[c], 0.5 * side)) {
                mask |= 1u << c;
                counts[c]++;
            }
        masks[k] = (uint8_t)mask;
    }
    t->tests += 8 * (uint64_t)n->triangle_count;
    return masks;
}

static void split_voxel(paper_tree *t, const place *p, const uint8_t *masks, const uint32_t counts[8],
                        place_list *next)
{
    node *const n = p->node;
    node *const children = from_block(t, 8 * sizeof *children);

    memset(children, 0, 8 * sizeof *children);
    for (int c = 0; c < 8; c++) {
        int32_t const ijk[3] = {2 * p->ijk[0] + (c & 1), 2 * p->ijk[1] + (c >> 1 & 1),
                                2 * p->ijk[2] + (c >> 2)};
        children[c].state = (uint8_t)(n->state & (c << 3 | (~c & 7)));
        if (counts[c] == 0) continue;
        children[c].kind = TOUCHED;
        children[c].triangles = from_block(t, counts[c] * sizeof *n->triangles);
        for (uint32_t k = 0; k < n->triangle_count; k++)
            if (masks[k] >> c & 1) children[c].triangles[children[c].triangle_count++] = n->triangles[k];
        add_place(next, &children[c], ijk, p->depth + 1);
    }
    n->children = children;
}

/* Deletes the children without triangles that have a face outside; fresh: the voxels that were just split. */
static void delete_exposed(paper_tree *t)
{
    for (uint64_t i = 0; i < t->fresh.count; i++) {
        const place *const p = &t->fresh.at[i];
        for (int c = 0; c < 8; c++) {
            node *const child = &p->node->children[c];
            int32_t const ijk[3] = {2 * p->ijk[0] + (c & 1), 2 * p->ijk[1] + (c >> 1 & 1),
                                    2 * p->ijk[2] + (c >> 2)};
            if (child->kind != FREE || child->state == 0) continue;
            child->kind = OUTSIDE;
            add_place(&t->passing, child, ijk, p->depth + 1);
        }
    }
    pass_all(t);
}

paper_tree *paper_refine(bench_memory *memory, const double *points, uint64_t point_count,
                         const uint32_t *triangles, uint64_t triangle_count, const bvx_lattice *base,
                         int32_t levels, int states)
{
    paper_tree *const t = calloc(1, sizeof *t);
    uint8_t *masks = NULL;
    uint64_t room = 0;

    if (t == NULL) exit(1);
    t->memory = memory;
    t->triangles = triangles;
    t->point_count = point_count;
    memcpy(t->dims, base->dims, sizeof t->dims);
    t->base_count = (uint64_t)t->dims[0] * (uint64_t)t->dims[1] * (uint64_t)t->dims[2];
    t->base = take_bytes(memory, (size_t)t->base_count * sizeof *t->base);
    memset(t->base, 0, (size_t)t->base_count * sizeof *t->base);
    t->bytes = t->base_count * sizeof *t->base;
    t->points = take_bytes(memory, (size_t)point_count * 3 * sizeof *t->points);
    for (uint64_t v = 0; v < 3 * point_count; v++)
        t->points[v] = (points[v] - base->origin[v % 3]) / base->spacing[v % 3];
    attach_triangles(t, triangle_count);
    start_from_base(t, states);
    for (int32_t level = 0; level < levels; level++) {
        place_list next = {0};
        for (uint64_t i = 0; i < t->fresh.count; i++) {
            uint32_t counts[8];
            masks = touched_children(t, &t->fresh.at[i], masks, &room, counts);
            split_voxel(t, &t->fresh.at[i], masks, counts, &next);
        }
        if (states) delete_exposed(t);
        free(t->fresh.at);
        t->fresh = next;
    }
    free(masks);
    return t;
}

/* ---- counts ---- */

static void count_leaves(const node *n, paper_counts *counts)
{
    if (n->children != NULL) {
        for (int c = 0; c < 8; c++) count_leaves(&n->children[c], counts);
    } else if (n->kind == TOUCHED) {
        counts->surface++;
    } else if (n->kind == OUTSIDE) {
        counts->outside++;
    } else {
        counts->inside++;
    }
}

void paper_tree_count(const paper_tree *t, paper_counts *counts)
{
    memset(counts, 0, sizeof *counts);
    for (uint64_t v = 0; v < t->base_count; v++) count_leaves(&t->base[v], counts);
    counts->tests = t->tests;
    counts->bytes = t->bytes;
}

void paper_tree_free(paper_tree *t)
{
    if (t == NULL) return;
    for (int i = 0; i < t->blocks; i++) bench_free(t->memory, t->block[i].bytes, t->block[i].size, 64);
    bench_free(t->memory, t->base, (size_t)t->base_count * sizeof *t->base, 64);
    bench_free(t->memory, t->points, (size_t)t->point_count * 3 * sizeof *t->points, 64);
    free(t->fresh.at);
    free(t->passing.at);
    free(t);
}
