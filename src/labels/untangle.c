/* untangle.c - move vertices of a smoothed complex back until no two of its triangles cross.
 *
 * Where junctions have become straight, narrow faces beside them may fold over, and sheets that share a cell may
 * meet. Crossings are found exactly
 * (nearest/crossing_pairs.c), and the vertices of both triangles go half the way to their cells' centres, the third
 * time all of it. On the staircase nothing crosses, so it ends. The first round looks at all triangles; what was
 * moved has crossings only near it, so later rounds look there alone.
 * Guarantee: pairs are listed in the order of triangles, and each vertex moves once a round, so the result follows
 * from the labels alone. */
#include "labels/labels.h"
#include "mesh/mesh.h"

enum { ROUNDS = 64, STRIKES = 3, BLOCK = 4, IS_NEAR = 1, IS_MOVED = 2, STRIKE = 4 };

typedef struct tangle {
    bvxi_net *net;
    uint8_t *state;  /* of each vertex: IS_NEAR, IS_MOVED, and STRIKE as often as it was moved */
    uint32_t *index; /* of each vertex in the look, or UINT32_MAX */
    uint8_t *blocks; /* of BLOCK^3 cells: near a vertex that was moved */
    uint64_t size[3], block_count;
    uint32_t *vertices, *triangles; /* of the look: which they are; three indices each */
    void *positions;
    uint64_t vertex_count, triangle_count;
} tangle;

static uint64_t block_at(const tangle *t, const uint64_t block[3])
{
    return (block[2] * t->size[1] + block[1]) * t->size[0] + block[0];
}

static void mark_near_blocks(const tangle *t, uint64_t vertex)
{
    uint64_t cell[3], low[3], high[3], b[3];

    /* Triangles that meet lie within two cells of each other. */
    bvxi_cell_of(t->net->complex, vertex, cell);
    for (int a = 0; a < 3; a++) {
        low[a] = (cell[a] < 3 ? 0 : cell[a] - 3) / BLOCK;
        high[a] = (cell[a] + 3) / BLOCK;
        if (high[a] >= t->size[a]) high[a] = t->size[a] - 1;
    }
    for (b[2] = low[2]; b[2] <= high[2]; b[2]++)
        for (b[1] = low[1]; b[1] <= high[1]; b[1]++)
            for (b[0] = low[0]; b[0] <= high[0]; b[0]++) t->blocks[block_at(t, b)] = 1;
}

/* Vertices near what was moved, whose faces are looked at. */
static void choose_near(tangle *t)
{
    const bvx_complex *const c = t->net->complex;

    for (uint64_t v = 0; v < c->mesh.vertex_count; v++) {
        uint64_t cell[3];
        bvxi_cell_of(c, v, cell);
        for (int a = 0; a < 3; a++) cell[a] /= BLOCK;
        t->state[v] = (uint8_t)((t->state[v] & ~(IS_NEAR | IS_MOVED)) |
                                (t->blocks[block_at(t, cell)] ? IS_NEAR : 0));
    }
}

static int is_near_face(const tangle *t, uint64_t face)
{
    int near = 0;
    for (int32_t n = 0; n < 4; n++)
        near |= t->state[bvxi_face_vertex(t->net->complex, (uint32_t)face, n)] & IS_NEAR;
    return near;
}

/* The near faces as a mesh of their own. */
static bvx_status gather_near_faces(bvx_context *ctx, tangle *t)
{
    const bvx_complex *const c = t->net->complex;
    size_t const size = c->mesh.position_type == BVX_F64 ? 24 : 12;
    uint64_t faces = 0, at = 0;

    for (uint64_t f = 0; f < c->face_count; f++) faces += is_near_face(t, f) != 0;
    t->triangle_count = 2 * faces;
    t->vertex_count = 0;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, faces * 24, "the near triangles", &t->triangles));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, faces * 16, "the near vertices", &t->vertices));
    memset(t->index, 0xff, (size_t)c->mesh.vertex_count * 4);
    for (uint64_t f = 0; f < c->face_count; f++) {
        if (!is_near_face(t, f)) continue;
        for (uint64_t k = 0; k < 6; k++) {
            uint32_t const v = c->mesh.triangles[6 * f + k];
            if (t->index[v] == UINT32_MAX) {
                t->index[v] = (uint32_t)t->vertex_count;
                t->vertices[t->vertex_count++] = v;
            }
            t->triangles[at++] = t->index[v];
        }
    }
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, t->vertex_count * size, "the near positions", &t->positions));
    for (uint64_t i = 0; i < t->vertex_count; i++)
        memcpy((uint8_t *)t->positions + i * size, (const uint8_t *)c->mesh.positions + t->vertices[i] * size,
               size);
    return BVX_OK;
}

static void move_back(tangle *t, uint32_t vertex)
{
    uint8_t *const state = &t->state[vertex];
    float *const offset = t->net->offset + 3 * (size_t)vertex;

    if ((*state & IS_MOVED) != 0) return;
    *state |= IS_MOVED;
    if (*state < STRIKES * STRIKE) *state = (uint8_t)(*state + STRIKE);
    for (int a = 0; a < 3; a++) offset[a] = *state < STRIKES * STRIKE ? 0.5F * offset[a] : 0.0F;
    bvxi_net_put(t->net, vertex);
    mark_near_blocks(t, vertex);
}

/* One round; *count becomes the number of crossings that it has found. */
static bvx_status look_for_crossings(bvx_context *ctx, tangle *t, int first, uint64_t *count)
{
    const bvx_complex *const c = t->net->complex;
    uint32_t *pairs;

    *count = 0;
    bvx_mesh_view view;
    bvx_mesh_view_of(&c->mesh, &view);
    const uint32_t *corners = c->mesh.triangles;
    if (!first) {
        choose_near(t);
        BVXI_TRY(gather_near_faces(ctx, t));
        view.positions = t->positions;
        view.indices = corners = t->triangles;
        view.vertex_count = t->vertex_count;
        view.triangle_count = t->triangle_count;
    }
    /* Far more than there are; else they are searched for again. */
    uint64_t const capacity = view.triangle_count;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, capacity * 8, "the crossings", &pairs));
    bvx_status const status = bvx_mesh_crossings(ctx, &view, count, pairs, capacity);
    if (status == BVX_ERR_CAPACITY) {
        bvxi_drop(ctx, pairs);
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, *count * 8, "the crossings", &pairs));
        BVXI_TRY(bvx_mesh_crossings(ctx, &view, count, pairs, *count));
    } else BVXI_TRY(status);
    memset(t->blocks, 0, (size_t)t->block_count);
    for (uint64_t i = 0; i < 2 * *count; i++)
        for (uint64_t k = 0; k < 3; k++) {
            uint32_t const v = corners[3 * (size_t)pairs[i] + k];
            move_back(t, first ? v : t->vertices[v]);
        }
    return BVX_OK;
}

bvx_status bvxi_net_untangle(bvx_context *ctx, bvxi_net *net)
{
    const bvx_complex *const c = net->complex;
    uint64_t const vertices = c->mesh.vertex_count;
    tangle t = {.net = net, .block_count = 1};

    for (int a = 0; a < 3; a++) {
        t.size[a] = (uint64_t)c->size[a] / BLOCK + 1;
        t.block_count *= t.size[a];
    }
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertices, "the vertices' states", &t.state));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertices * 4, "the vertices' indices", &t.index));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, t.block_count, "the moved blocks", &t.blocks));
    for (int32_t round = 0; round < ROUNDS; round++) {
        uint64_t count;
        BVXI_TRY(BVXI_SHARE(ctx, round == 0 ? 0.0 : 0.7, round == 0 ? 0.7 : 1.0,
                            BVXI_SCOPE(ctx, look_for_crossings(ctx, &t, round == 0, &count))));
        if (count == 0) return BVX_OK;
    }

    /* Not seen yet; the staircase does not cross. */
    memset(net->offset, 0, (size_t)vertices * 12);
    for (uint64_t v = 0; v < vertices; v++) bvxi_net_put(net, v);
    return BVX_OK;
}
