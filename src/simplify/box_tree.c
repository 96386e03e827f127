/* box_tree.c - an eight-wide hierarchy over triangles, of boxes and of what the triangles face, kept up to
 * date while edges collapse.
 *
 * A box that grows is handed upwards until one contains it already, which is soon: most collapses change two
 * nodes or three. */
#include "simplify/box_tree.h"

static uint64_t nodes_over(uint64_t count)
{
    return (count + BVXI_BOX_WIDTH - 1) / BVXI_BOX_WIDTH;
}

uint64_t bvxi_box_tree_bytes(uint64_t triangles)
{
    uint64_t nodes = 0, count = triangles;

    /* Level by level up to a single node. */
    do {
        count = nodes_over(count);
        nodes += count;
    } while (count > 1);
    return nodes * sizeof(bvxi_box_node);
}

void bvxi_box_tree_lay_out(bvxi_box_tree *tree, uint64_t triangles, unsigned char *block)
{
    uint64_t count = triangles;

    tree->levels = 0;
    do {
        count = nodes_over(count);
        tree->node[tree->levels] = (bvxi_box_node *)(void *)block;
        tree->count[tree->levels] = count;
        block += count * sizeof(bvxi_box_node);
        tree->levels++;
    } while (count > 1);
}

static bvxi_box whole_node(const bvxi_box_node *node)
{
    bvxi_box box = bvxi_box_none();

    /* Children that are not there are boxes of nothing, which change no box. */
    for (int k = 0; k < BVXI_BOX_WIDTH; k++) {
        bvxi_box const child = bvxi_box_child(node, k);
        bvxi_box_join(&box, &child);
    }
    return box;
}

/* None of a node's children was removed yet. */
static bvxi_box_facing whole_facing(const bvxi_box_node *node)
{
    bvxi_box_facing f = bvxi_box_faces_nothing();

    for (int a = 0; a < 3; a++)
        for (int k = 0; k < BVXI_BOX_WIDTH; k++) {
            if (node->facing_low[a][k] < f.low[a]) f.low[a] = node->facing_low[a][k];
            if (node->facing_high[a][k] > f.high[a]) f.high[a] = node->facing_high[a][k];
        }
    return f;
}

/* The places of a level's last node that nothing fills. */
static void clear_rest(bvxi_box_tree *tree, int32_t level, uint64_t used)
{
    bvxi_box const none = bvxi_box_none();
    bvxi_box_facing const nothing = bvxi_box_faces_nothing();

    for (uint64_t i = used; i < tree->count[level] * BVXI_BOX_WIDTH; i++) {
        bvxi_box_put(&tree->node[level][i / BVXI_BOX_WIDTH], (int32_t)(i % BVXI_BOX_WIDTH), &none);
        bvxi_box_put_facing(&tree->node[level][i / BVXI_BOX_WIDTH], (int32_t)(i % BVXI_BOX_WIDTH), &nothing);
    }
}

static void set_triangle(bvxi_box_tree *tree, const bvxi_corners *m, uint64_t t)
{
    bvxi_box_node *const node = &tree->node[0][t / BVXI_BOX_WIDTH];
    int32_t const k = (int32_t)(t % BVXI_BOX_WIDTH);
    const uint32_t *const v = m->triangle[t].vertex;
    const double *const a = bvxi_corner_position(m, v[0]), *const b = bvxi_corner_position(m, v[1]);
    const double *const c = bvxi_corner_position(m, v[2]);
    bvxi_box const box = bvxi_box_of(tree, a, b, c);

    bvxi_box_put(node, k, &box);

    /* What triangles face is only kept where the proof by facing may be used. */
    if (tree->faces) {
        bvxi_box_facing const facing = bvxi_box_facing_at(a, b, c);

        bvxi_box_put_facing(node, k, &facing);
    }
}

/* Child i of a level from the node below it. */
static void set_child(bvxi_box_tree *tree, int32_t level, uint64_t i)
{
    bvxi_box_node *const node = &tree->node[level][i / BVXI_BOX_WIDTH];
    int32_t const k = (int32_t)(i % BVXI_BOX_WIDTH);
    bvxi_box const box = whole_node(&tree->node[level - 1][i]);

    bvxi_box_put(node, k, &box);
    if (tree->faces) {
        bvxi_box_facing const facing = whole_facing(&tree->node[level - 1][i]);

        bvxi_box_put_facing(node, k, &facing);
    }
}

void bvxi_box_tree_set(bvxi_box_tree *tree, const bvxi_corners *m)
{
    bvxi_box_tree_lay_out(tree, m->triangles, (unsigned char *)(void *)tree->node[0]);

    /* From the leaves up: each level is made of the one below. */
    for (uint64_t t = 0; t < m->triangles; t++) set_triangle(tree, m, t);
    clear_rest(tree, 0, m->triangles);

    for (int32_t l = 1; l < tree->levels; l++) {
        for (uint64_t i = 0; i < tree->count[l - 1]; i++) set_child(tree, l, i);
        clear_rest(tree, l, tree->count[l - 1]);
    }
}

/* Grow the box of child k; 0 when it contained the other already. */
static int grow_child(bvxi_box_node *node, uint64_t k, const bvxi_box *box)
{
    int grown = 0;

    for (int a = 0; a < 3; a++) {
        if (box->low[a] < node->low[a][k]) {
            node->low[a][k] = box->low[a];
            grown = 1;
        }
        if (box->high[a] > node->high[a][k]) {
            node->high[a][k] = box->high[a];
            grown = 1;
        }
    }
    return grown;
}

static int grow_facing(bvxi_box_node *node, uint64_t k, const bvxi_box_facing *facing)
{
    int grown = 0;

    for (int a = 0; a < 3; a++) {
        if (facing->low[a] < node->facing_low[a][k]) {
            node->facing_low[a][k] = facing->low[a];
            grown = 1;
        }
        if (facing->high[a] > node->facing_high[a][k]) {
            node->facing_high[a][k] = facing->high[a];
            grown = 1;
        }
    }
    return grown;
}

void bvxi_box_tree_move(bvxi_box_tree *tree, int32_t t, const bvxi_box *box, const bvxi_box_facing *facing)
{
    uint64_t child = (uint64_t)t / BVXI_BOX_WIDTH;

    bvxi_box_put(&tree->node[0][child], t % BVXI_BOX_WIDTH, box);
    if (tree->faces) bvxi_box_put_facing(&tree->node[0][child], t % BVXI_BOX_WIDTH, facing);

    /* Up to the first node that contains it already; those above it do too. */
    for (int32_t l = 1; l < tree->levels; l++) {
        bvxi_box_node *const node = &tree->node[l][child / BVXI_BOX_WIDTH];
        int grown = grow_child(node, child % BVXI_BOX_WIDTH, box);

        if (tree->faces) grown |= grow_facing(node, child % BVXI_BOX_WIDTH, facing);
        if (!grown) return;
        child /= BVXI_BOX_WIDTH;
    }
}

void bvxi_box_tree_remove(bvxi_box_tree *tree, int32_t t)
{
    bvxi_box const none = bvxi_box_none();

    /* Boxes above stay as they are: too large is only slower, and the next packing makes them anew. */
    bvxi_box_put(&tree->node[0][t / BVXI_BOX_WIDTH], t % BVXI_BOX_WIDTH, &none);
}
