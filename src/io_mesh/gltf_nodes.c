/* gltf_nodes.c - the nodes of a glTF file: which are drawn, and where in the world each one lies.
 *
 * Source: Khronos Group. glTF 2.0 Specification, 3.5. Nodes are taken in an order in which parents come first,
 * by a list and without recursion. Guarantee: each node has at most one parent and leads to a root, or the file
 * is refused; products are computed in doubles, a matrix of zeros and ones stays exact. */
#include "io_mesh/gltf.h"

enum { GLTF_DEEPEST = 1000 }; /* nodes above a node */

typedef struct gltf_nodes {
    const bvxi_gltf *f;
    uint32_t count;
    uint32_t *parent; /* BVXI_JSON_NONE of roots */
    uint32_t *order;  /* parents first */
    uint16_t *depth;
} gltf_nodes;

/* ---- matrices ---- */

/* The numbers of an array of exactly so many; 0 where the member is missing. */
static bvx_status gltf_take_numbers(const bvxi_gltf *f, uint64_t node, uint32_t object, const char *name,
                                    uint32_t count, double *number, int *found)
{
    uint32_t const array = bvxi_json_member(&f->json, object, name);
    uint32_t value = array + 1;

    *found = array != BVXI_JSON_NONE;
    if (!*found) return BVX_OK;
    if (bvxi_json_kind(&f->json, array) != BVXI_JSON_ARRAY || bvxi_json_count(&f->json, array) != count)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "node %u: %s is not %d numbers", node, name,
                              (int64_t)count);
    for (uint32_t i = 0; i < count; i++, value = f->json.value[value].next) {
        number[i] = bvxi_json_number(&f->json, value);
        if (bvxi_json_kind(&f->json, value) != BVXI_JSON_NUMBER || !(number[i] - number[i] == 0.0))
            return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "node %u: %s holds what is no finite number",
                                  node, name);
    }
    return BVX_OK;
}

static bvx_status gltf_local(const bvxi_gltf *f, uint32_t node, bvxi_gltf_world *local)
{
    uint32_t const value = f->list[BVXI_GLTF_NODE][node];
    double m[16], t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    int found;

    BVXI_TRY(gltf_take_numbers(f, node, value, "matrix", 16, m, &found));
    if (found) {
        /* Column by column in the file; the last row says nothing of an affine map. */
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++) local->m[r][c] = m[4 * c + r];
        return BVX_OK;
    }
    BVXI_TRY(gltf_take_numbers(f, node, value, "translation", 3, t, &found));
    BVXI_TRY(gltf_take_numbers(f, node, value, "rotation", 4, q, &found));
    BVXI_TRY(gltf_take_numbers(f, node, value, "scale", 3, s, &found));

    /* Translation, rotation (a quaternion x, y, z, w of any length but 0) and scale as a matrix. */
    double const n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3], k = n > 0.0 ? 2.0 / n : 0.0;
    double const x = q[0], y = q[1], z = q[2], v = q[3];
    double const r[3][3] = {
        {1.0 - k * (y * y + z * z), k * (x * y - z * v), k * (x * z + y * v)},
        {k * (x * y + z * v), 1.0 - k * (x * x + z * z), k * (y * z - x * v)},
        {k * (x * z - y * v), k * (y * z + x * v), 1.0 - k * (x * x + y * y)},
    };

    for (int a = 0; a < 3; a++) {
        for (int c = 0; c < 3; c++) local->m[a][c] = r[a][c] * s[c];
        local->m[a][3] = t[a];
    }
    return BVX_OK;
}

/* ---- the tree ---- */

static bvx_status gltf_node_named(const bvxi_gltf *f, int list, uint64_t i, uint32_t value, uint32_t *node)
{
    double const v = bvxi_json_number(&f->json, value);
    *node = 0;
    if (bvxi_json_kind(&f->json, value) != BVXI_JSON_NUMBER || !(v >= 0.0) ||
        !(v < (double)f->list_count[BVXI_GLTF_NODE]) || v != (double)(uint32_t)v)
        return bvxi_gltf_fail(f, list, i, "it names a node that there is not");
    *node = (uint32_t)v;
    return BVX_OK;
}

/* How many children a node has; value: the first. */
static uint32_t gltf_children(const bvxi_gltf *f, uint32_t node, uint32_t *value)
{
    uint32_t const array = bvxi_json_member(&f->json, f->list[BVXI_GLTF_NODE][node], "children");
    *value = array + 1;
    return bvxi_json_kind(&f->json, array) == BVXI_JSON_ARRAY ? bvxi_json_count(&f->json, array) : 0;
}

static bvx_status gltf_take_parents(const gltf_nodes *n)
{
    const bvxi_gltf *const f = n->f;

    for (uint32_t i = 0; i < n->count; i++) n->parent[i] = BVXI_JSON_NONE;
    for (uint32_t i = 0; i < n->count; i++) {
        uint32_t value, child;
        uint32_t const count = gltf_children(f, i, &value);

        for (uint32_t k = 0; k < count; k++, value = f->json.value[value].next) {
            BVXI_TRY(gltf_node_named(f, BVXI_GLTF_NODE, i, value, &child));
            if (n->parent[child] != BVXI_JSON_NONE)
                return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT,
                                      "node %u is a child of node %u and of node %u; a node has one parent",
                                      (uint64_t)child, (uint64_t)n->parent[child], (uint64_t)i);
            n->parent[child] = i;
        }
    }
    return BVX_OK;
}

/* Roots first, then the children of each node in the list; what is not reached lies in a cycle. */
static bvx_status gltf_order(const gltf_nodes *n)
{
    const bvxi_gltf *const f = n->f;
    uint32_t found = 0;

    memset(n->depth, 0xff, (size_t)n->count * sizeof *n->depth);
    for (uint32_t i = 0; i < n->count; i++)
        if (n->parent[i] == BVXI_JSON_NONE) {
            n->order[found++] = i;
            n->depth[i] = 0;
        }
    for (uint32_t i = 0; i < found; i++) {
        uint32_t value;
        uint32_t const node = n->order[i], count = gltf_children(f, node, &value);

        if (count > 0 && n->depth[node] == GLTF_DEEPEST)
            return BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                                  "node %u lies below %d others, which is the most", (uint64_t)node,
                                  (int64_t)GLTF_DEEPEST);
        for (uint32_t k = 0; k < count; k++, value = f->json.value[value].next) {
            uint32_t const child = (uint32_t)bvxi_json_number(&f->json, value);
            n->depth[child] = (uint16_t)(n->depth[node] + 1);
            n->order[found++] = child;
        }
    }
    for (uint32_t i = 0; found < n->count && i < n->count; i++)
        if (n->depth[i] == UINT16_MAX)
            return bvxi_gltf_fail(f, BVXI_GLTF_NODE, i, "it lies in a cycle of nodes");
    return BVX_OK;
}

/* ---- the scene ---- */

/* Mark the roots that are drawn: those of the default scene, else of the first one, else all. */
static bvx_status gltf_mark_roots(const gltf_nodes *n, uint8_t *drawn)
{
    const bvxi_gltf *const f = n->f;
    uint32_t const member = bvxi_json_member(&f->json, 0, "scene");
    double const wanted = bvxi_json_number(&f->json, member);
    uint32_t scene, list, count, value, node;

    for (uint32_t i = 0; i < n->count; i++) drawn[i] = 0;
    if (f->list_count[BVXI_GLTF_SCENE] == 0 && member == BVXI_JSON_NONE) {
        for (uint32_t i = 0; i < n->count; i++) drawn[i] = n->parent[i] == BVXI_JSON_NONE;
        return BVX_OK;
    }
    if (!(wanted >= 0.0 && wanted < 4294967295.0) || wanted != (double)(uint32_t)wanted)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "scene is not an index");
    BVXI_TRY(bvxi_gltf_item(f, BVXI_GLTF_SCENE, (uint32_t)wanted, "scene", &scene));

    list = bvxi_json_member(&f->json, scene, "nodes");
    count = bvxi_json_kind(&f->json, list) == BVXI_JSON_ARRAY ? bvxi_json_count(&f->json, list) : 0;
    value = list + 1;
    for (uint32_t k = 0; k < count; k++, value = f->json.value[value].next) {
        BVXI_TRY(gltf_node_named(f, BVXI_GLTF_SCENE, (uint32_t)wanted, value, &node));
        if (n->parent[node] != BVXI_JSON_NONE)
            return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT,
                                  "scene %u lists node %u, which is a child of node %u", (uint64_t)wanted,
                                  (uint64_t)node, (uint64_t)n->parent[node]);
        drawn[node] = 1;
    }
    return BVX_OK;
}

bvx_status bvxi_gltf_scene_of(const bvxi_gltf *f, bvxi_gltf_scene *scene)
{
    gltf_nodes n = {.f = f, .count = f->list_count[BVXI_GLTF_NODE]};

    bvx_context *const ctx = n.f->source->ctx;
    uint64_t const count = n.count;

    BVXI_TRY(BVXI_ARRAY(ctx, count, "the matrices of nodes", scene->world));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count, "the nodes of the scene", &scene->drawn));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 4, "the parents of nodes", &n.parent));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 4, "the order of nodes", &n.order));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, count * 2, "the depths of nodes", &n.depth));

    BVXI_TRY(gltf_take_parents(&n));
    BVXI_TRY(gltf_order(&n));
    BVXI_TRY(gltf_mark_roots(&n, scene->drawn));

    /* A parent's matrix and mark are there before those of its children. */
    for (uint32_t i = 0; i < n.count; i++) {
        uint32_t const node = n.order[i], parent = n.parent[node];
        bvxi_gltf_world local;

        BVXI_TRY(gltf_local(f, node, &local));
        if (parent == BVXI_JSON_NONE) {
            scene->world[node] = local;
            continue;
        }
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 4; c++) {
                scene->world[node].m[r][c] = scene->world[parent].m[r][0] * local.m[0][c] +
                                             scene->world[parent].m[r][1] * local.m[1][c] +
                                             scene->world[parent].m[r][2] * local.m[2][c];
                if (c == 3) scene->world[node].m[r][c] += scene->world[parent].m[r][3];
            }
        scene->drawn[node] = scene->drawn[parent];
    }
    return BVX_OK;
}
