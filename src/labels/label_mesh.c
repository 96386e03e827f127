/* label_mesh.c - the body of one label as a mesh: bvx_label_mesh.
 *
 * Source: Schaefer, Ju, Warren. Manifold Dual Contouring. 2007 (the case that makes a dual edge not manifold).
 *
 * Corners of the label's faces are sorted by vertex. Away from junctions the faces around a vertex are one fan. At
 * a junction they are joined by their edges, each of which has two faces of the body (split_cells.c).
 *
 * On the staircase an edge can have four, and all are joined side by side of the vertex's cell: two faces of the body
 * that meet in a side belong together; of four, those that share a voxel of the body do. Only a body that leads around
 * such a side on both of its sides would have two edges between the same two vertices there: then those that share the
 * other voxel belong together, which cuts both fans in two. A cell has one such side at most, since the way around it
 * takes three of the four voxels beyond. Each fan has a vertex of its own.
 * Guarantee: closed, edge- and vertex-manifold, oriented, for all 2^8 patterns of a cell and what lies beside. */
#include "labels/labels.h"
#include "mesh/mesh.h"

static const char label_mesh_name[] = "bvx_label_mesh";

typedef struct body_work {
    const bvx_complex *complex;
    uint64_t label, count; /* faces */
    uint64_t each;         /* corners of a face */
    const uint32_t *faces;
    uint64_t *vertex;       /* of each corner, sorted [Size: each * count] */
    uint32_t *corner;       /* 4 * face + place in it */
    uint32_t *parent, *fan; /* of the corners of one vertex: joined, and the result's vertices */
    uint64_t stride[3];
} body_work;

/* The vertex so many corners after a corner in its face. */
static uint32_t corner_beside(const body_work *w, uint32_t corner, int32_t n)
{
    return bvxi_face_vertex(w->complex, w->faces[corner / 4], (int32_t)(corner % 4) + n);
}

/* An edge with different ends in a cell, seen from the cell. */
typedef struct cell_node {
    int32_t axis, at[3]; /* at of the body's end; along the axis 1 where it is the high one */
    uint32_t corner;
} cell_node;

/* Whether they have the same voxel at the body's end, or with other at the other end. */
static int share_end(const cell_node *a, const cell_node *b, int other)
{
    int same = 1;
    for (int32_t d = 0; d < 3; d++) {
        int32_t const p = a->at[d] ^ (other && a->axis == d), q = b->at[d] ^ (other && b->axis == d);
        same &= p == q;
    }
    return same;
}

static int32_t list_nodes_in(const cell_node *nodes, uint32_t count, int32_t side, uint32_t in[4])
{
    int32_t n = 0;
    for (uint32_t i = 0; i < count; i++)
        if (nodes[i].axis != side >> 1 && nodes[i].at[side >> 1] == (side & 1)) in[n++ & 3] = i;
    return n;
}

/* Join the nodes of one vertex to fans; turned is the side whose four belong together by their other ends, or -1. */
static void join_fans(const cell_node *nodes, uint32_t count, int32_t turned, uint32_t *parent)
{
    for (uint32_t i = 0; i < count; i++) parent[i] = i;
    for (int32_t side = 0; side < 6; side++) {
        uint32_t in[4];
        int32_t const n = list_nodes_in(nodes, count, side, in);
        for (int32_t i = 0; i < n; i++)
            for (int32_t k = 0; k < i; k++)
                if (n == 2 || share_end(&nodes[in[i]], &nodes[in[k]], side == turned))
                    bvxi_join(parent, in[i], in[k]);
    }
}

/* The side through which one fan runs twice, or -1. */
static int32_t double_side(const cell_node *nodes, uint32_t count)
{
    uint32_t parent[12], in[4];

    join_fans(nodes, count, -1, parent);
    for (int32_t side = 0; side < 6; side++) {
        int same = list_nodes_in(nodes, count, side, in) == 4;
        for (int32_t i = 1; same && i < 4; i++) same = bvxi_root(parent, in[i]) == bvxi_root(parent, in[0]);
        if (same) return side;
    }
    return -1;
}

static uint32_t read_nodes(const body_work *w, uint64_t from, cell_node nodes[12])
{
    uint64_t const corners = 4 * w->count;
    uint32_t count = 0;
    for (uint64_t i = from; i < corners && w->vertex[i] == w->vertex[from] && count < 12; i++) {
        const bvx_complex *const c = w->complex;
        uint32_t const face = w->faces[w->corner[i] / 4];
        int32_t const first = bvxi_face_owner(c, face), place = ((int32_t)(w->corner[i] % 4) - first) & 3;
        cell_node node = {.corner = w->corner[i]};
        uint64_t const owner = c->cells[bvxi_face_vertex(c, face, first)];
        uint64_t const to[2] = {owner - c->cells[bvxi_face_vertex(c, face, first + 1)],
                                owner - c->cells[bvxi_face_vertex(c, face, first + 3)]};
        int32_t way[2] = {0, 0};

        for (int32_t n = 0; n < 2; n++)
            for (int32_t a = 0; a < 3; a++)
                if (to[n] == w->stride[a]) way[n] = a;
        node.axis = 3 - way[0] - way[1];
        node.at[way[0]] = place == 1 || place == 2;
        node.at[way[1]] = place >= 2;

        /* The back is at the low end where corners turn about the axis. */
        int const forward = way[0] == (node.axis + 1) % 3, is_back = c->sides[2 * (size_t)face] == w->label;
        node.at[node.axis] = forward != is_back;

        nodes[count++] = node;
    }
    return count;
}

/* Join corners that have an edge in common; 0 where four have. */
static int join_by_edges(const body_work *w, uint64_t from, uint32_t count, uint32_t *parent)
{
    for (uint32_t i = 0; i < count; i++) parent[i] = i;
    for (uint32_t i = 0; i < count; i++)
        for (int32_t n = 1, before = (int32_t)w->each - 1; n <= before; n += before - 1) {
            uint32_t const own = w->corner[from + i], vertex = corner_beside(w, own, n);
            uint32_t met = 0;
            for (uint32_t k = 0; k < count; k++)
                if (corner_beside(w, w->corner[from + k], 1) == vertex ||
                    corner_beside(w, w->corner[from + k], before) == vertex) {
                    met++;
                    bvxi_join(parent, i, k);
                }
            if (met > 2) return 0;
        }
    return 1;
}

/* Fans of the vertex whose corners begin at from, as roots of parent. */
static void find_label_fans(const body_work *w, uint64_t from, uint32_t corners)
{
    cell_node nodes[12], others[12];

    if (join_by_edges(w, from, corners, w->parent) || w->complex->single) return;

    /* Only on the staircase, where vertices have cells. */
    uint32_t const count = read_nodes(w, from, nodes);
    int32_t turned = double_side(nodes, count);

    if (turned >= 0) {
        uint32_t in[4];
        (void)list_nodes_in(nodes, count, turned, in);
        /* The first corner of the vertex beyond. */
        /* The vertex on the other side of a cell's side, along a face that has an edge through it. */
        const bvx_complex *const c = w->complex;
        uint32_t const face = w->faces[nodes[in[0]].corner / 4];
        int32_t const place = (int32_t)(nodes[in[0]].corner % 4);
        uint64_t const step = w->stride[turned >> 1];
        uint32_t const next = bvxi_face_vertex(c, face, place + 1),
                       last = bvxi_face_vertex(c, face, place + 3);
        uint64_t const own = c->cells[bvxi_face_vertex(c, face, place)];
        uint64_t const cell = (turned & 1) != 0 ? own + step : own - step;
        uint64_t const vertex = c->cells[next] == cell ? next : last;
        uint64_t beyond = 0, high = 4 * w->count;
        while (beyond < high) {
            uint64_t const middle = (beyond + high) / 2;
            if (w->vertex[middle] < vertex) beyond = middle + 1;
            else high = middle;
        }
        if (double_side(others, read_nodes(w, beyond, others)) != (turned ^ 1)) turned = -1;
    }
    join_fans(nodes, count, turned, w->parent);
}

static uint64_t end_of_vertex(const body_work *w, uint64_t from)
{
    uint64_t end = from;
    while (end < w->each * w->count && w->vertex[end] == w->vertex[from]) end++;
    return end;
}

static bvx_status sort_body_corners(bvx_context *ctx, body_work *w)
{
    uint64_t const corners = w->each * w->count;
    uint64_t most = 0;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, corners * 8, "the corners' vertices", &w->vertex));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, corners * 4, "the corners", &w->corner));
    for (uint64_t i = 0; i < corners; i++) {
        w->vertex[i] = bvxi_face_vertex(w->complex, w->faces[i / w->each], (int32_t)(i % w->each));
        w->corner[i] = (uint32_t)(i / w->each * 4 + i % w->each);
    }
    BVXI_TRY(bvxi_radix_sort(ctx, w->vertex, w->corner, corners));
    for (uint64_t i = 0, end; i < corners; i = end) {
        end = end_of_vertex(w, i);
        most = end - i > most ? end - i : most;
    }
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, most * 8, "the corners of a vertex", &w->parent));
    w->fan = w->parent + most;
    return BVX_OK;
}

static bvx_status make_body(bvx_context *ctx, body_work *w, bvx_mesh *mesh)
{
    const bvx_mesh *const from = &w->complex->mesh;
    uint64_t const corners = w->each * w->count, bytes = from->position_type == BVX_F64 ? 24 : 12;
    uint32_t *number, vertices = 0;
    int const mine = mesh->owned || mesh->positions == NULL;

    BVXI_TRY(sort_body_corners(ctx, w));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->count * 16, "the body's vertices", &number));
    for (uint64_t i = 0, end; i < corners; i = end) {
        end = end_of_vertex(w, i);
        int const single = w->complex->junctions[w->vertex[i]] == 0;
        if (!single) find_label_fans(w, i, (uint32_t)(end - i));
        for (uint32_t k = 0; k < end - i; k++) {
            uint32_t const root = single ? 0 : bvxi_root(w->parent, k);
            w->fan[k] = root == k ? vertices++ : w->fan[root];
        }
        for (uint64_t k = i; k < end; k++) number[w->corner[k]] = w->fan[k - i];
    }

    BVXI_TRY(bvxi_mesh_open(ctx, label_mesh_name, from->position_type, 0, vertices, (w->each - 2) * w->count,
                            mesh));
    memcpy(mesh->frame, from->frame, sizeof mesh->frame);
    for (uint64_t i = 0; i < corners; i++)
        memcpy((uint8_t *)mesh->positions + number[w->corner[i]] * bytes,
               (const uint8_t *)from->positions + w->vertex[i] * bytes, (size_t)bytes);
    for (uint64_t f = 0; f < w->count; f++) {
        const uint32_t *const n = number + 4 * f;
        uint32_t *const t = mesh->triangles + 3 * (w->each - 2) * f;
        /* Faces look away from their back. */
        int const outwards = w->complex->sides[2 * (size_t)w->faces[f]] == w->label;

        t[0] = n[0];
        t[1] = n[outwards ? 1 : 2];
        t[2] = n[outwards ? 2 : 1];
        if (w->each == 3) continue;
        t[3] = n[0];
        t[4] = n[outwards ? 2 : 3];
        t[5] = n[outwards ? 3 : 2];
    }
    return bvxi_mesh_made(ctx, bvxi_progress(ctx, "body", 1.0), mine, mesh);
}

static bvx_status run_label_mesh(bvx_context *ctx, const bvx_complex *complex, uint64_t label, bvx_mesh *mesh)
{
    body_work w = {.complex = complex, .label = label};

    if (complex == NULL) return bvxi_fail_null(ctx, label_mesh_name, "complex");
    if (mesh == NULL) return bvxi_fail_null(ctx, label_mesh_name, "mesh");
    BVXI_TRY(bvxi_mesh_check_reserved(ctx, label_mesh_name, mesh));
    if (label >= complex->label_count)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: label %i, the complex has %u", label_mesh_name, label,
                         complex->label_count);
    w.count = complex->first[label + 1] - complex->first[label];
    w.faces = complex->faces + complex->first[label];
    w.each = complex->single ? 3 : 4;
    w.stride[0] = 1;
    w.stride[1] = (uint64_t)complex->size[0] + 1;
    w.stride[2] = w.stride[1] * ((uint64_t)complex->size[1] + 1);
    return make_body(ctx, &w, mesh);
}

bvx_status bvx_label_mesh(bvx_context *context, const bvx_complex *complex, uint64_t label, bvx_mesh *mesh)
{
    return BVXI_CALL(context, run_label_mesh(context, complex, label, mesh));
}
