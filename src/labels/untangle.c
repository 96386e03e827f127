/* untangle.c - move vertices of a smoothed complex back until no two of its triangles cross.
 *
 * Where junctions have become straight, narrow faces beside them may fold over, and sheets that share a cell may
 * meet. Crossings are found exactly (nearest/crossing_pairs.c), and the vertices of both triangles go half the way to
 * their cells' centres, the third time all of it. On the staircase nothing crosses, so it ends.
 *
 * Source: Ju, Udeshi. Intersection-free Contouring on an Octree Grid. 2006 (the envelope of a face).
 *
 * Nearly all faces are excluded first. A face with single vertices in its cells has an envelope: the four tetrahedra
 * of its lattice edge with each of its sides. Envelopes of different edges have no inner point in common, so of two
 * faces that cross one leaves its own. Faces lie in the box of their cells, so it has a corner in a cell in which the
 * other has one too. Later rounds look around what was moved.
 * In seams of windows vertices stay. They are in the seam's plane, which parts the faces of both windows, and near
 * enough to their cells' centres for faces to keep their envelopes when the other vertices are at theirs.
 * Guarantee: pairs are listed in the order of triangles, and each vertex moves once a round, so the result follows
 * from the labels alone. */
#include "labels/labels.h"
#include "nearest/closest.h"

enum {
    ROUNDS = 64,
    STRIKES = 3,
    CLOSE_GRAIN = 4096,
    IS_NEAR = 1,
    IS_MOVED = 2,
    STRIKE = 4,
    IS_FLAP = 128,
    FLAP_STRIKES = 10,
    FLAP_TURN = STRIKES + 1
};

typedef struct tangle {
    bvxi_net *net;
    double margin;  /* more than rounded positions change volumes of tetrahedra [Units: voxels^3] */
    uint8_t *state; /* of each vertex: IS_NEAR, IS_MOVED, and STRIKE as often as it was moved */
    int wanted;
    uint8_t *chosen;                /* of each face */
    uint32_t *index;                /* of each vertex in the look, or UINT32_MAX */
    uint32_t *vertices, *triangles; /* of the look: which they are; three indices each */
    void *positions;
    uint64_t vertex_count, triangle_count;
} tangle;

static double cross_flat(const double a[3], const double b[3])
{
    return a[0] * b[1] - a[1] * b[0];
}

/* Whether the face stays in its envelope: its diagonal does, where it passes the edge through the triangle of the
 * edge and the corner on that side. */
static int is_in_envelope(const tangle *t, uint32_t face)
{
    uint32_t const axis = bvxi_net_axis(t->net, face);
    double at[4][3];
    bvxi_face f;

    if (axis == BVXI_NET_FLAP) return 0;
    bvxi_read_face(t->net, face, axis, &f);
    for (int32_t n = 0; n < 4; n++)
        if ((t->state[f.vertex[n]] & IS_NEAR) != 0) return 0;

    /* From the edge's end. */
    for (int32_t n = 0; n < 4; n++)
        for (int32_t a = 0; a < 3; a++)
            at[n][a] = (double)bvxi_corner(&f, n, a) / BVXI_NET_UNITS + (a == 2 ? 0.5 : -0.5);

    /* Turn to the side of the diagonal on which the edge is. */
    double const way = cross_flat(at[0], at[2]), turn = cross_flat(at[0], at[1]);
    const double *const side = at[(way > 0.0) == (turn > 0.0) ? 1 : 3];
    double const to = bvxi_absolute(cross_flat(at[0], side)), from = bvxi_absolute(cross_flat(side, at[2])),
                 out = bvxi_absolute(way), height = from * at[0][2] + to * at[2][2] - out * side[2];
    return height >= t->margin && height <= to + from - out - t->margin;
}

static void choose_suspects(void *user, uint64_t begin, uint64_t end)
{
    const tangle *const t = user;
    for (uint64_t f = begin; f < end; f++) t->chosen[f] = !is_in_envelope(t, (uint32_t)f);
}

/* Faces of which a vertex has the wanted state. */
static void choose_by_state(void *user, uint64_t begin, uint64_t end)
{
    const tangle *const t = user;
    for (uint64_t f = begin; f < end; f++) {
        int any = 0;
        for (int32_t n = 0; n < 4; n++)
            any |= t->state[bvxi_face_vertex(t->net->complex, (uint32_t)f, n)] & t->wanted;
        t->chosen[f] = any != 0;
    }
}

/* The near faces as a mesh of their own. */
static bvx_status gather_near_faces(bvx_context *ctx, tangle *t)
{
    const bvx_complex *const c = t->net->complex;
    size_t const size = c->mesh.position_type == BVX_F64 ? 24 : 12;
    uint64_t faces = 0, at = 0;

    for (uint64_t f = 0; f < c->face_count; f++) faces += t->chosen[f];
    t->triangle_count = 2 * faces;
    t->vertex_count = 0;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, faces * 24, "the near triangles", &t->triangles));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, faces * 16, "the near vertices", &t->vertices));
    memset(t->index, 0xff, (size_t)c->mesh.vertex_count * 4);
    for (uint64_t f = 0; f < c->face_count; f++) {
        if (!t->chosen[f]) continue;
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
    int16_t *const offset = t->net->offset + 3 * (size_t)vertex;

    if ((*state & IS_MOVED) != 0 || (t->net->complex->junctions[vertex] & BVX_AT_SEAM) != 0) return;
    *state |= IS_MOVED;
    /* A flap's new vertex comes last, as triangles would lose their area. */
    int32_t const most = (*state & IS_FLAP) != 0 ? IS_FLAP + FLAP_STRIKES * STRIKE : STRIKES * STRIKE;
    if (*state < most) *state = (uint8_t)(*state + STRIKE);
    for (int a = 0; a < 3; a++) offset[a] = (int16_t)(*state < most ? offset[a] / 2 : 0);
    bvxi_net_put(t->net, vertex);
}

/* The vertices around are at their cells' centres by now, so halving alone changes no crossing: a flap's new vertex
 * that still has one turns towards the edges that it has for itself. */
static void turn_flaps(const tangle *t)
{
    bvx_complex *const c = t->net->complex;

    for (uint64_t f = t->net->flaps; f < c->face_count; f++) {
        uint32_t const v = bvxi_face_vertex(c, (uint32_t)f, 0);
        bvxi_face face;

        if ((t->state[v] | IS_NEAR) != IS_FLAP + FLAP_TURN * STRIKE + IS_MOVED + IS_NEAR) continue;
        bvxi_read_face(t->net, (uint32_t)f, BVXI_NET_FLAP, &face);
        int16_t *const o = t->net->offset + 3 * (size_t)v;
        o[face.axis[0]] = (int16_t)(face.sign[0] * BVXI_NET_UNITS / 16);
        o[face.axis[1]] = (int16_t)(face.sign[1] * BVXI_NET_UNITS / 16);
        o[face.axis[2]] = BVXI_NET_UNITS / 8;
        bvxi_net_put(t->net, v);
    }
}

/* One round; *count becomes the number of crossings that it has found. */
static bvx_status look_for_crossings(bvx_context *ctx, tangle *t, int first, uint64_t *count)
{
    const bvx_complex *const c = t->net->complex;
    uint32_t *pairs;
    bvx_mesh_view view;

    t->wanted = IS_MOVED;
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.2,
                        bvxi_for(ctx, "envelopes", c->face_count, CLOSE_GRAIN,
                                 first ? choose_suspects : choose_by_state, t)));

    /* Mark all vertices in the cells of the chosen faces. */
    uint64_t const vertices = c->mesh.vertex_count;

    for (uint64_t v = 0; v < vertices; v++) t->state[v] &= (uint8_t) ~(IS_NEAR | IS_MOVED);
    for (uint64_t f = 0; f < c->face_count; f++)
        for (int32_t n = 0; t->chosen[f] && n < 4; n++) {
            uint64_t const v = bvxi_face_vertex(c, (uint32_t)f, n);
            uint64_t other = v;
            while (other > 0 && c->cells[other - 1] == c->cells[v]) other--;
            for (; other < vertices && c->cells[other] == c->cells[v]; other++) t->state[other] |= IS_NEAR;
        }
    t->wanted = IS_NEAR;
    BVXI_TRY(
        BVXI_SHARE(ctx, 0.2, 0.3, bvxi_for(ctx, "near", c->face_count, CLOSE_GRAIN, choose_by_state, t)));
    BVXI_TRY(gather_near_faces(ctx, t));
    bvx_mesh_view_of(&c->mesh, &view);
    view.positions = t->positions;
    view.indices = t->triangles;
    view.vertex_count = t->vertex_count;
    view.triangle_count = t->triangle_count;

    BVXI_TRY(BVXI_SHARE(ctx, 0.3, 1.0, bvxi_crossing_pairs(ctx, &view, UINT64_MAX, &pairs, count)));
    if (*count == 0) return BVX_OK;
    for (uint64_t i = 0; i < 2 * *count; i++)
        for (uint64_t k = 0; k < 3; k++) move_back(t, t->vertices[t->triangles[3 * (size_t)pairs[i] + k]]);
    turn_flaps(t);
    return BVX_OK;
}

bvx_status bvxi_net_untangle(bvx_context *ctx, bvxi_net *net)
{
    const bvx_complex *const c = net->complex;
    uint64_t const vertices = c->mesh.vertex_count;
    tangle t = {.net = net};
    double most = 0.0;

    /* A product of three coordinates that are at most 1 and wrong by half a step each, and ten of them. */
    for (int32_t a = 0; a < 3; a++) {
        double const voxels = bvxi_absolute((double)c->low[a]) + (double)c->size[a] + 1.0;
        double const far = bvxi_absolute(net->origin[a]) / net->spacing[a] + voxels;
        if (far > most) most = far;
    }
    t.margin = most / (c->mesh.position_type == BVX_F32 ? 262144.0 : 70368744177664.0); /* 2^18, 2^46 */

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertices, "the vertices' states", &t.state));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, vertices * 4, "the vertices' indices", &t.index));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c->face_count, "the chosen faces", &t.chosen));
    for (uint64_t f = net->flaps; f < c->face_count; f++)
        t.state[bvxi_face_vertex(c, (uint32_t)f, 0)] = IS_FLAP;
    /* Until the first round has chosen faces: vertices that share a cell. */
    for (uint64_t v = 0; v < vertices; v++) t.state[v] |= bvxi_shares_cell(c, v) ? IS_NEAR : 0;
    for (int32_t round = 0; round < ROUNDS; round++) {
        /* However many rounds there are, progress goes on. */
        double const from = 1.0 - 1.0 / (1.0 + (double)round), to = 1.0 - 1.0 / (2.0 + (double)round);
        uint64_t count;
        BVXI_TRY(BVXI_SHARE(ctx, from, to, BVXI_SCOPE(ctx, look_for_crossings(ctx, &t, round == 0, &count))));
        if (count == 0) return BVX_OK;
    }

    /* Not seen yet; the staircase does not cross. */
    for (uint64_t v = 0; v < vertices; v++) {
        if ((c->junctions[v] & BVX_AT_SEAM) == 0) memset(net->offset + 3 * (size_t)v, 0, 6);
        bvxi_net_put(net, v);
    }
    return BVX_OK;
}
