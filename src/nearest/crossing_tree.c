/* crossing_tree.c - pairs of triangles that cross.
 *
 * Boxes in whole steps, eight to a node, lie over the triangles in their order, which is one of space. Each node of
 * eight triangles goes down that tree to those after it whose boxes meet its own. Along the diagonals of a cube most
 * of those are apart that lie aslant beside each other. Triangles with a common vertex are not looked at where the
 * triangles around that vertex lie side by side: then they meet in nothing else. All others are parted by the plane of
 * one of them, or judged exactly (mesh/cross.h).
 *
 * Source: Brinkhoff, Kriegel, Seeger. Efficient Processing of Spatial Joins Using R-trees. 1993. Kamel,
 * Faloutsos. On Packing R-trees. 1993. Klosowski, Held, Mitchell, Sowizral, Zikan. Efficient Collision Detection
 * Using Bounding Volume Hierarchies of k-DOPs. 1998.
 *
 * Each piece of the nodes writes its pairs to a part of its own and counts them; where they are too many for these
 * parts it looks for them again and writes them to where the counts say: no thread shows. */
#include "nearest/crossing_tree.h"
#include "bits/bits.h"
#include "core/simd_shorts.h"
#include "core/vec3.h"
#include "mesh/cross.h"
#include "mesh/mesh.h"

enum {
    WIDTH = CROSSING_WIDTH,
    BOUNDS = 2 * (3 + CROSSING_SLANTS),
    BOX_HIGHEST = 32767,
    CROSSING_GRAIN = 64,  /* nodes of a task, at least */
    CROSSING_AHEAD = 16,  /* triangles */
    CROSSING_KEYS = 16384 /* pairs that there is room for before they are counted */
};

typedef crossing_node box_node;

typedef struct crossing_job {
    const crossing_tree *tree;
    int32_t pieces;
    uint32_t
        *common; /* of each node of level 0: the vertex that all of its triangles have, or BVXI_VERTEX_NONE */
    uint8_t *fresh;   /* of each node of level 0: bit k where its triangle k has a fresh vertex */
    uint64_t *counts; /* of each piece */
    uint64_t *begins; /* of each piece's pairs in keys, one more than there are pieces */
    uint64_t *keys;   /* lower index << 32 | higher one */
    uint8_t *written; /* 1: all keys of the piece are */
} crossing_job;

/* ---- Boxes ---- */

#define BOX_FAR 1e12 /* steps */

/* As of a node, along the axes and the diagonals. */
typedef struct triangle_box {
    int16_t bound[BOUNDS];
} triangle_box;

/* What overlaps has no bound above these. */
typedef struct box_query {
    bvxi_shorts bound[BOUNDS];
} box_query;

static void put_query(const triangle_box *box, int count, box_query *q)
{
    for (int i = 0; i < count; i++) q->bound[i] = bvxi_shorts_all((int16_t)-box->bound[i ^ 1]);
}

/* Bit k: child k overlaps along some axes. */
BVXI_VECTOR_INLINE uint32_t overlaps_along(const int16_t *bound, const bvxi_shorts *most, int count)
{
    bvxi_shorts apart = bvxi_shorts_all(0);
    for (int i = 0; i < count; i++)
        apart = bvxi_shorts_or(apart, bvxi_shorts_more(bvxi_shorts_load(bound + i * WIDTH), most[i]));
    return ~bvxi_shorts_bits(apart) & 0xff;
}

BVXI_VECTOR_INLINE uint32_t overlaps(const box_node *node, const box_query *q)
{
    return overlaps_along(node->bound[0], q->bound, 6);
}

BVXI_VECTOR_INLINE uint32_t overlaps_leaf(const crossing_tree *tree, uint64_t node, const box_query *q)
{
    uint32_t const bits = overlaps(&tree->node[0][node], q);
    if (bits == 0 || !tree->slanted) return bits;
    return bits & overlaps_along(tree->slant[node].bound[0], q->bound + 6, 2 * CROSSING_SLANTS);
}

/* The box of all children, along the axes. */
static triangle_box box_of_all(const box_node *node)
{
    triangle_box box;
    for (int i = 0; i < 6; i++) {
        box.bound[i] = node->bound[i][0];
        for (int k = 1; k < WIDTH; k++)
            if (node->bound[i][k] < box.bound[i]) box.bound[i] = node->bound[i][k];
    }
    return box;
}

/* Rounding down keeps order: what overlaps, overlaps in steps too. */
static int16_t box_step(double at)
{
    double const above = at > 0 ? at : 0;
    return (int16_t)(int32_t)(above < BOX_HIGHEST ? above : BOX_HIGHEST);
}

static double least_of(double x, double y, double z)
{
    double const less = x < y ? x : y;
    return less < z ? less : z;
}

static double most_of(double x, double y, double z)
{
    double const more = x > y ? x : y;
    return more > z ? more : z;
}

/* The box of three corners: the least and the most of them stay so in steps. */
static void put_box_of(const crossing_tree *tree, const double *const p[3], triangle_box *box)
{
    double const steps = tree->scale * BOX_HIGHEST;
    int far = 0;

    for (int a = 0; a < 3; a++) {
        double const least = (least_of(p[0][a], p[1][a], p[2][a]) - tree->low[a]) * steps;
        double const most = (most_of(p[0][a], p[1][a], p[2][a]) - tree->low[a]) * steps;

        far |= (least < -BOX_FAR) | (most > BOX_FAR);
        box->bound[2 * a] = box_step(least);
        box->bound[2 * a + 1] = (int16_t)-box_step(most);
    }

    if (tree->slanted) {
        /* Along the diagonals. Sums are rounded, by less than half a step unless their terms are huge. */
        double const slack = far ? BOX_FAR : 0.5;
        double at[CROSSING_SLANTS][3];

        for (int k = 0; k < 3; k++) {
            double const x = (p[k][0] - tree->low[0]) * steps, y = (p[k][1] - tree->low[1]) * steps;
            double const z = (p[k][2] - tree->low[2]) * steps;

            at[0][k] = (x + y + z) * (1.0 / 3);
            at[1][k] = (x + y - z + BOX_HIGHEST) * (1.0 / 3);
            at[2][k] = (x - y + z + BOX_HIGHEST) * (1.0 / 3);
            at[3][k] = (y - x + z + BOX_HIGHEST) * (1.0 / 3);
        }
        for (int i = 0; i < CROSSING_SLANTS; i++) {
            box->bound[6 + 2 * i] = box_step(least_of(at[i][0], at[i][1], at[i][2]) - slack);
            box->bound[7 + 2 * i] = (int16_t)-box_step(most_of(at[i][0], at[i][1], at[i][2]) + slack);
        }
    }
}

/* What is not there overlaps nothing. */
static void empty_bounds(int16_t *bound, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) bound[i] = INT16_MAX;
}

static void put_box(box_node *node, uint64_t child, const triangle_box *box)
{
    for (int i = 0; i < 6; i++) node->bound[i][child % WIDTH] = box->bound[i];
}

static void put_leaf(const crossing_tree *tree, uint64_t t, const triangle_box *box)
{
    put_box(&tree->node[0][t / WIDTH], t, box);
    for (int i = 0; i < 2 * CROSSING_SLANTS && tree->slanted; i++)
        tree->slant[t / WIDTH].bound[i][t % WIDTH] = box->bound[6 + i];
}

/* The triangle at a place. */
static uint64_t triangle_at(const crossing_tree *tree, uint64_t t)
{
    return tree->live != NULL ? tree->live[t] : t;
}

static const uint32_t *vertices_in(const crossing_tree *tree, uint64_t t)
{
    return tree->vertex + triangle_at(tree, t) * tree->vertex_step;
}

static int is_alive(const crossing_tree *tree, uint64_t t)
{
    return t < tree->triangles && (tree->live != NULL || tree->vertex[t * tree->vertex_step + 1] >> 31 == 0);
}

static void corners_in(const crossing_tree *tree, const uint32_t *v, const double *p[3])
{
    for (int k = 0; k < 3; k++) p[k] = tree->at + v[k] * tree->at_step;
}

/* The boxes of some nodes to the level above them. */
static void put_above(const crossing_tree *tree, int32_t level, uint64_t begin, uint64_t end)
{
    for (uint64_t i = begin; i < end; i++) {
        triangle_box const box = box_of_all(&tree->node[level][i]);
        put_box(&tree->node[level + 1][i / WIDTH], i, &box);
    }
}

static void leaf_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const crossing_tree *const tree = user;

    (void)piece;
    empty_bounds(tree->node[0][begin].bound[0], (end - begin) * 6 * WIDTH);
    if (tree->slanted) empty_bounds(tree->slant[begin].bound[0], (end - begin) * 2 * CROSSING_SLANTS * WIDTH);
    for (uint64_t t = begin * WIDTH; t < end * WIDTH; t++) {
        triangle_box box;
        const double *p[3];

        /* Memory that a later one needs is requested before its turn. */
        if (is_alive(tree, t + CROSSING_AHEAD)) {
            corners_in(tree, vertices_in(tree, t + CROSSING_AHEAD), p);
            for (int k = 0; k < 3; k++) BVXI_PREFETCH(p[k]);
        }
        if (!is_alive(tree, t)) continue;
        corners_in(tree, vertices_in(tree, t), p);
        put_box_of(tree, p, &box);
        put_leaf(tree, t, &box);
    }
    if (tree->levels > 1) put_above(tree, 0, begin, end);
}

bvx_status bvxi_crossing_tree_open(bvx_context *ctx, crossing_tree *tree)
{
    uint64_t count = tree->triangles, sum = 0;
    box_node *block;

    tree->levels = 0;
    do {
        count = (count + WIDTH - 1) / WIDTH;
        tree->nodes[tree->levels++] = count;
        sum += count;
    } while (count > 1);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH,
                        sum * sizeof *block + (tree->slanted ? tree->nodes[0] * sizeof *tree->slant : 0),
                        "the triangles' boxes", &block));
    tree->slant = (crossing_slant *)(void *)(block + sum);
    for (int32_t l = 0; l < tree->levels; l++) {
        tree->node[l] = block;
        block += tree->nodes[l];
        if (l > 0) empty_bounds(tree->node[l][0].bound[0], tree->nodes[l] * 6 * WIDTH);
    }
    bvxi_ranges(ctx, bvxi_piece_count(tree->nodes[0], CROSSING_GRAIN), tree->nodes[0], leaf_piece, tree);
    for (int32_t l = 1; l + 1 < tree->levels; l++) put_above(tree, l, 0, tree->nodes[l]);
    return BVX_OK;
}

/* Grow the box of a child; 0 when it contained the other already. */
static int grow_box(box_node *node, uint64_t child, const triangle_box *box)
{
    int grown = 0;
    for (int i = 0; i < 6; i++) {
        int16_t *const bound = &node->bound[i][child % WIDTH];
        grown |= box->bound[i] < *bound;
        if (box->bound[i] < *bound) *bound = box->bound[i];
    }
    return grown;
}

void bvxi_crossing_tree_move(crossing_tree *tree, uint32_t t)
{
    const double *p[3];
    triangle_box box;
    uint64_t child = t / WIDTH;

    corners_in(tree, tree->vertex + t * tree->vertex_step, p);
    put_box_of(tree, p, &box);
    put_leaf(tree, t, &box);

    /* Up to the first node that contains it already; those above it do too. */
    for (int32_t l = 1; l < tree->levels && grow_box(&tree->node[l][child / WIDTH], child, &box); l++)
        child /= WIDTH;
}

/* ---- Pairs ---- */

/* A triangle that is held against many. */
typedef struct held_triangle {
    const uint32_t *vertex; /* NULL: it is not looked at */
    uint32_t fan[3];        /* vertices whose triangles lie side by side, or BVXI_VERTEX_NONE */
    int planed;             /* 1: the plane is set */
    bvxi_orient_plane plane;
    box_query query;
} held_triangle;

static int crosses(const crossing_tree *tree, const bvxi_orient_plane *plane, const double *const p[3],
                   const uint32_t *v)
{
    const double *q[3];
    int sides, joined = 0;

    corners_in(tree, v, q);
    sides = bvxi_cross_sides(plane, p, q);
    if (BVXI_LIKELY(sides == BVXI_CROSS_APART)) return 0;
    if (tree->touching) return bvxi_triangles_cross_beside(sides, plane, p, q);

    /* Equal positions are one pointer to the exact test. */
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            if (q[k] == p[i] || !bvxi_vec_is_same(q[k], p[i])) continue;
            q[k] = p[i];
            joined = 1;
        }
    if (joined) sides = bvxi_cross_sides(plane, p, q);
    return bvxi_triangles_cross_beside(sides, plane, p, q) && bvxi_has_area(p) && bvxi_has_area(q);
}

/* 1: both have a vertex whose triangles lie side by side, and so meet in nothing else. */
static int share_fan(const uint32_t *fan, const uint32_t *v)
{
    int shared = 0;
    for (int k = 0; k < 3; k++) shared |= (v[k] == fan[0]) | (v[k] == fan[1]) | (v[k] == fan[2]);
    return shared;
}

static int held_crosses(const crossing_tree *tree, held_triangle *held, const uint32_t *v)
{
    const double *p[3];
    corners_in(tree, held->vertex, p);
    if (!held->planed) bvxi_orient_plane_of(p, &held->plane);
    held->planed = 1;
    return crosses(tree, &held->plane, p, v);
}

/* Count pairs between two nodes, or within one, on from found, and write those that there is room for. */
static uint64_t pairs_of_nodes(const crossing_job *job, held_triangle *held, uint64_t first, uint64_t second,
                               uint64_t *keys, uint64_t room, uint64_t found)
{
    const crossing_tree *const tree = job->tree;
    uint32_t near = 0xff;

    /* The second node's box shows which triangles of the first one may meet any of it. */
    if (first != second) {
        const box_node *const above = &tree->node[1][second / WIDTH];
        triangle_box box;
        box_query query;

        for (int i = 0; i < 6; i++) box.bound[i] = above->bound[i][second % WIDTH];
        put_query(&box, 6, &query);
        near = overlaps(&tree->node[0][first], &query);
    }
    for (; near != 0; near &= near - 1) {
        uint64_t const i = (uint64_t)bvxi_lowest(near), s = first * WIDTH + i;
        uint32_t bits;

        if (held[i].vertex == NULL) continue;
        bits = overlaps_leaf(tree, second, &held[i].query);
        if ((job->fresh[first] >> i & 1) == 0) bits &= job->fresh[second];
        if (first == second) bits &= ~0u << (i + 1);
        for (; bits != 0; bits &= bits - 1) {
            uint64_t const t = second * WIDTH + (uint64_t)bvxi_lowest(bits);
            const uint32_t *const v = vertices_in(tree, t);

            if (share_fan(held[i].fan, v) || !held_crosses(tree, &held[i], v)) continue;
            if (found++ >= room) continue;
            /* Keys sort as the pairs do, whichever of both was found first. */
            uint64_t const a = triangle_at(tree, s), b = triangle_at(tree, t);
            keys[found - 1] = a < b ? a << 32 | b : b << 32 | a;
        }
    }
    return found;
}

/* 0: none of the node's triangles is looked at. */
static int hold_node(const crossing_job *job, uint64_t node, held_triangle held[WIDTH])
{
    const crossing_tree *const tree = job->tree;
    int const bounds = tree->slanted ? BOUNDS : 6;
    int any = 0;

    for (uint64_t i = 0; i < WIDTH; i++) {
        uint64_t const t = node * WIDTH + i;
        triangle_box box;

        held[i].vertex = is_alive(tree, t) ? vertices_in(tree, t) : NULL;
        if (held[i].vertex == NULL) continue;
        any = 1;
        for (int k = 0; k < 6; k++) box.bound[k] = tree->node[0][node].bound[k][i];
        for (int k = 6; k < bounds; k++) box.bound[k] = tree->slant[node].bound[k - 6][i];
        put_query(&box, bounds, &held[i].query);
        for (int k = 0; k < 3; k++) {
            uint32_t const v = held[i].vertex[k];

            held[i].fan[k] = tree->graph != NULL && tree->graph[v] != 0 ? v : BVXI_VERTEX_NONE;
        }
        held[i].planed = 0;
    }
    return any;
}

/* Of fans of very many triangles all nodes overlap. */
static void common_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const crossing_job *const job = user;
    const crossing_tree *const tree = job->tree;

    (void)piece;
    for (uint64_t i = begin; i < end; i++) {
        uint32_t common[3] = {BVXI_VERTEX_NONE, BVXI_VERTEX_NONE, BVXI_VERTEX_NONE};
        int any = 0;

        job->fresh[i] = tree->fresh == NULL ? 0xff : 0;
        for (uint64_t t = i * WIDTH; t < (i + 1) * WIDTH; t++) {
            const uint32_t *v;

            if (!is_alive(tree, t)) continue;
            v = vertices_in(tree, t);
            if (tree->fresh != NULL && (tree->fresh[v[0]] | tree->fresh[v[1]] | tree->fresh[v[2]]) != 0)
                job->fresh[i] |= (uint8_t)(1 << t % WIDTH);
            if (!any) memcpy(common, v, sizeof common);
            for (int k = 0; k < 3 && any; k++)
                if (common[k] != v[0] && common[k] != v[1] && common[k] != v[2]) common[k] = BVXI_VERTEX_NONE;
            any = 1;
        }
        job->common[i] = BVXI_VERTEX_NONE;
        for (int k = 0; k < 3; k++)
            if (common[k] != BVXI_VERTEX_NONE && tree->graph != NULL && tree->graph[common[k]] != 0)
                job->common[i] = common[k];
    }
}

static int share_a_fan(const crossing_job *job, uint64_t a, uint64_t b)
{
    return job->common[a] != BVXI_VERTEX_NONE && job->common[a] == job->common[b];
}

/* Pairs of a node's triangles with each other and with all after them, on from found. */
static uint64_t pairs_of_node(const crossing_job *job, uint64_t node, uint64_t *keys, uint64_t room,
                              uint64_t found)
{
    const crossing_tree *const tree = job->tree;
    held_triangle held[WIDTH];
    box_query whole;
    uint64_t stack[WIDTH * CROSSING_LEVELS]; /* level in the low bits */
    int32_t depth = 0;

    if (!hold_node(job, node, held)) return found;
    if (!share_a_fan(job, node, node)) found = pairs_of_nodes(job, held, node, node, keys, room, found);
    triangle_box box = box_of_all(&tree->node[0][node]);
    put_query(&box, 6, &whole);

    if (tree->levels > 1) stack[depth++] = (uint64_t)(tree->levels - 1);
    while (depth > 0) {
        uint64_t const top = stack[--depth], index = top >> 4;
        int32_t const level = (int32_t)(top & 15);

        for (uint32_t bits = overlaps(&tree->node[level][index], &whole); bits != 0; bits &= bits - 1) {
            uint64_t const child = index * WIDTH + (uint64_t)bvxi_lowest(bits);

            /* A child of this level holds 8^(level - 1) nodes. Those up to this node have had their turn. */
            if ((child + 1) << 3 * (level - 1) <= node + 1) continue;
            if (level > 1) stack[depth++] = child << 4 | (uint64_t)(level - 1);
            else if (!share_a_fan(job, node, child))
                found = pairs_of_nodes(job, held, node, child, keys, room, found);
        }
    }
    return found;
}

static void pairs_piece(void *user, int32_t index)
{
    const crossing_job *const job = user;
    uint64_t *const keys = job->keys + job->begins[index];
    uint64_t const room = job->begins[index + 1] - job->begins[index];
    uint64_t begin, end, found = 0;
    if (job->written[index]) return;
    bvxi_piece(job->tree->nodes[0], job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) found = pairs_of_node(job, i, keys, room, found);
    job->counts[index] = found;
    job->written[index] = found <= room;
}

static bvx_status write_pairs(bvx_context *ctx, crossing_job *job, uint64_t count, uint32_t **pairs)
{
    uint32_t *unused;

    /* The keys of all pieces, side by side; those of which there were too many are looked for again. */
    uint64_t *const parts = job->keys, sum = 0;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the crossings' keys", &job->keys));
    for (int32_t i = 0; i < job->pieces; i++) {
        if (job->written[i]) memcpy(job->keys + sum, parts + job->begins[i], (size_t)job->counts[i] * 8);
        job->begins[i] = sum;
        sum += job->counts[i];
    }
    job->begins[job->pieces] = sum;
    bvxi_drop(ctx, parts);
    bvxi_tasks(ctx, job->pieces, pairs_piece, job);

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 8, "the crossing pairs", pairs));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, count * 4, "the crossings' indices", &unused));
    BVXI_TRY(bvxi_radix_sort(ctx, job->keys, unused, count));
    for (uint64_t i = 0; i < count; i++) {
        (*pairs)[2 * i] = (uint32_t)(job->keys[i] >> 32);
        (*pairs)[2 * i + 1] = (uint32_t)job->keys[i];
    }
    bvxi_drop(ctx, unused);
    return BVX_OK;
}

bvx_status bvxi_crossings_find(bvx_context *ctx, const crossing_tree *tree, double from, double to,
                               uint64_t most, uint32_t **pairs, uint64_t *count)
{
    crossing_job job = {.tree = tree, .pieces = bvxi_piece_count(tree->nodes[0], CROSSING_GRAIN)};
    uint64_t const room = tree->triangles < CROSSING_KEYS ? tree->triangles : CROSSING_KEYS;

    *pairs = NULL;
    *count = 0;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, ((uint64_t)job.pieces + 1) * 17, "the crossings' counts",
                             &job.begins));
    job.counts = job.begins + job.pieces + 1;
    job.written = (uint8_t *)(job.counts + job.pieces + 1);
    BVXI_TRY(BVXI_ARRAY(ctx, room, "the crossings' keys", job.keys));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, tree->nodes[0] * 5, "the nodes' fans", &job.common));
    job.fresh = (uint8_t *)(job.common + tree->nodes[0]);
    for (int32_t i = 0; i <= job.pieces; i++) job.begins[i] = room * (uint64_t)i / (uint64_t)job.pieces;
    bvxi_ranges(ctx, job.pieces, tree->nodes[0], common_piece, &job);
    BVXI_TRY(bvxi_each(ctx, "crossings", from, to, job.pieces, pairs_piece, &job));
    for (int32_t i = 0; i < job.pieces; i++) *count += job.counts[i];
    if (*count != 0 && *count <= most) BVXI_TRY(write_pairs(ctx, &job, *count, pairs));
    bvxi_drop(ctx, job.common);
    bvxi_drop(ctx, job.keys);
    bvxi_drop(ctx, job.begins);
    return BVX_OK;
}

/* ---- One triangle ---- */

static int visit_node(const crossing_tree *tree, uint64_t node, const box_query *query,
                      const bvxi_orient_plane *plane, const double *const p[3], const uint32_t ends[2],
                      const uint8_t *skip, const uint32_t *still, crossing_visit *visit, void *user)
{
    for (uint32_t bits = overlaps_leaf(tree, node, query); bits != 0; bits &= bits - 1) {
        uint64_t const t = node * WIDTH + (uint64_t)bvxi_lowest(bits);
        const uint32_t *const v = tree->vertex + t * tree->vertex_step;
        const double *q[3];

        if (!is_alive(tree, t) || (skip != NULL && (skip[v[0]] | skip[v[1]] | skip[v[2]]) != 0)) continue;
        if (still != NULL && (still[v[0]] & still[v[1]] & still[v[2]]) == BVXI_VERTEX_NONE) continue;
        for (int k = 0; k < 2; k++)
            if ((v[0] == ends[k]) | (v[1] == ends[k]) | (v[2] == ends[k])) goto next;
        corners_in(tree, v, q);
        if (q[0] == p[0] && q[1] == p[1] && q[2] == p[2]) continue;
        if (crosses(tree, plane, p, v) && (visit == NULL || visit(user, (uint32_t)t))) return 1;
next:;
    }
    return 0;
}

int bvxi_crossing_tree_visit(const crossing_tree *tree, const double *const p[3], uint32_t u, uint32_t v,
                             const uint8_t *skip, const uint32_t *still, crossing_visit *visit, void *user)
{
    uint32_t const ends[2] = {u, v};
    uint64_t stack[WIDTH * CROSSING_LEVELS];
    triangle_box box;
    box_query query;
    int32_t depth = 0;
    bvxi_orient_plane plane;

    put_box_of(tree, p, &box);
    put_query(&box, tree->slanted ? BOUNDS : 6, &query);
    bvxi_orient_plane_of(p, &plane);
    stack[depth++] = (uint64_t)(tree->levels - 1);
    while (depth > 0) {
        uint64_t const top = stack[--depth], index = top >> 4;
        int32_t const level = (int32_t)(top & 15);

        if (level == 0) {
            if (visit_node(tree, index, &query, &plane, p, ends, skip, still, visit, user)) return 1;
            continue;
        }
        for (uint32_t bits = overlaps(&tree->node[level][index], &query); bits != 0; bits &= bits - 1)
            stack[depth++] = (index * WIDTH + (uint64_t)bvxi_lowest(bits)) << 4 | (uint64_t)(level - 1);
    }
    return 0;
}

int bvxi_crossing_pair(const crossing_tree *tree, uint32_t s, uint32_t t)
{
    const double *p[3];
    bvxi_orient_plane plane;
    corners_in(tree, tree->vertex + s * tree->vertex_step, p);
    bvxi_orient_plane_of(p, &plane);
    return crosses(tree, &plane, p, tree->vertex + t * tree->vertex_step);
}
