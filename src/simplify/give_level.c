/* give_level.c - a level as a mesh: its vertices in their order, with the attributes that the mesh has.
 *
 * Where attributes have a seam, each side has a vertex of its own; texture coordinates that have indices of their own
 * need none. With BVX_VERTICES_KEPT triangles index the vertices that were given, which the level has as they are. */
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

enum { PLACES_COMPARED = 16 }; /* of a vertex that has very many rows */

static void put_position(const bvxi_collapse *c, bvx_mesh *level, uint64_t at, const double p[3])
{
    for (uint64_t k = 0; k < 3; k++) {
        if (c->options.given.position_type == BVX_F64) ((double *)level->positions)[3 * at + k] = p[k];
        else ((float *)level->positions)[3 * at + k] = (float)p[k];
    }
}

/* The triangles that are left, by the indices of their corners' vertices or rows. */
static void give_triangles(const bvxi_collapse *c, const uint32_t *index, int rows, uint32_t *to)
{
    const bvxi_corners *const m = &c->mesh;
    for (uint64_t t = 0; t < m->triangles; t++) {
        if (bvxi_corner_gone(m, (int32_t)(4 * t))) continue;
        for (uint64_t k = 0; k < 3; k++)
            *to++ = index[rows ? c->attributes.row[4 * t + k] : m->triangle[t].vertex[k]];
    }
}

bvx_status bvxi_collapse_give_plain(bvxi_collapse *c, bvx_mesh *level)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t *index;

    BVXI_TRY(bvxi_collapse_number(c, &index));
    BVXI_TRY(
        bvxi_mesh_open(c->ctx, c->function, c->options.given.position_type, 0, c->alive, m->left, level));
    give_triangles(c, index, 0, level->triangles);
    for (uint64_t v = 0; v < m->vertices; v++)
        if (!bvxi_collapse_is_gone(c, (uint32_t)v)) put_position(c, level, index[v], m->at[v].p);
    bvxi_drop(c->ctx, index);
    return BVX_OK;
}

/* ---- Vertices as they were given ---- */

/* Arrays for what the mesh has. */
static bvx_status open_attributes(bvxi_collapse *c, bvx_mesh *level, uint64_t uvs)
{
    const bvx_mesh_view *const given = c->given;
    uint64_t const n = level->vertex_capacity;

    if (given->normals != NULL)
        BVXI_TRY(bvxi_alloc(c->ctx, BVXI_RESULT, n * 12, "the normals", &level->normals));
    if (given->uvs2 != NULL)
        BVXI_TRY(bvxi_alloc(c->ctx, BVXI_RESULT, n * 8, "the second texture coordinates", &level->uvs2));
    if (given->colours != NULL)
        BVXI_TRY(bvxi_alloc(c->ctx, BVXI_RESULT, n * 4, "the colours", &level->colours));
    if (given->uvs == NULL) return BVX_OK;
    level->uv_count = given->uv_indices != NULL ? uvs : n;
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_RESULT, level->uv_count * 8, "the texture coordinates", &level->uvs));
    if (given->uv_indices == NULL) return BVX_OK;
    return bvxi_alloc(c->ctx, BVXI_RESULT, level->triangle_capacity * 12,
                      "the triangles' texture coordinates", &level->uv_triangles);
}

static void copy_floats(const float *from, uint64_t count, float *to)
{
    if (to != NULL) memcpy(to, from, (size_t)count * sizeof *to);
}

static bvx_status give_kept(bvxi_collapse *c, int owned, bvx_mesh *level)
{
    const bvx_mesh_view *const given = c->given;
    uint64_t const n = given->vertex_count;

    BVXI_TRY(bvxi_mesh_open(c->ctx, c->function, c->options.given.position_type, 0, n, c->mesh.left, level));
    give_triangles(c, c->attributes.vertex, 1, level->triangles);
    for (uint64_t v = 0; v < n; v++) {
        double p[3];

        bvxi_view_position(given, v, p);
        put_position(c, level, v, p);
    }
    if (!owned) return BVX_OK;

    BVXI_TRY(open_attributes(c, level, given->uv_count));
    copy_floats(given->normals, 3 * n, level->normals);
    copy_floats(given->uvs2, 2 * n, level->uvs2);
    copy_floats(given->uvs, 2 * (given->uv_indices != NULL ? given->uv_count : n), level->uvs);
    if (level->colours != NULL) memcpy(level->colours, given->colours, (size_t)n * 4);
    if (level->uv_triangles != NULL) give_triangles(c, c->attributes.uv, 1, level->uv_triangles);
    return BVX_OK;
}

/* ---- Vertices with attributes ---- */

/* 1: the vertex is not where the one was that a row was given with. A row that came along into a junction keeps its
 * values: that stretches a texture, and shows nothing from beyond its edge. */
static int has_moved(const bvxi_collapse *c, uint32_t row, uint32_t v)
{
    double p[3];
    if (c->kind[v] > VERTEX_LINE) return 0;
    bvxi_view_position(c->given, c->attributes.vertex[row], p);
    for (int k = 0; k < 3; k++)
        if (bvxi_collapse_rounded(c, p[k]) != c->mesh.at[v].p[k]) return 1;
    return 0;
}

/* Number the rows that are used, in the order of triangles; at[row] becomes the vertex. Returns how many. */
static uint64_t number_rows(const bvxi_collapse *c, uint32_t *index, uint32_t *at)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t count = 0;

    memset(index, 0xff, (size_t)c->attributes.rows * 4);
    for (uint64_t t = 0; t < m->triangles; t++) {
        if (bvxi_corner_gone(m, (int32_t)(4 * t))) continue;
        for (uint64_t k = 0; k < 3; k++) {
            uint32_t const row = c->attributes.row[4 * t + k];

            if (index[row] == UINT32_MAX) index[row] = count++;
            at[row] = m->triangle[t].vertex[k];
        }
    }
    return count;
}

/* Number the vertices of rows that are used: those of one vertex that differ in texture coordinates alone share it.
 * Rows lie in the order of vertices. Returns how many. */
static uint64_t number_shared_rows(const bvxi_collapse *c, const uint32_t *index, const uint32_t *at,
                                   uint32_t *place)
{
    uint32_t count = 0;

    for (uint64_t r = 0; r < c->attributes.rows; r++) {
        if (index[r] == UINT32_MAX) continue;
        place[r] = UINT32_MAX;
        for (uint64_t k = r; k-- > 0 && r - k < PLACES_COMPARED && place[r] == UINT32_MAX;) {
            if (index[k] == UINT32_MAX) continue;
            if (at[k] != at[r]) break;
            if (bvxi_attributes_share(c, (uint32_t)k, (uint32_t)r)) place[r] = place[k];
        }
        if (place[r] == UINT32_MAX) place[r] = count++;
    }
    return count;
}

static bvx_status give_rows(bvxi_collapse *c, bvx_mesh *level)
{
    int const apart = c->given->uv_indices != NULL;
    uint64_t const rows = c->attributes.rows;
    uint32_t *index, *at, *place;

    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, rows * (apart ? 12 : 8), "the level's attributes", &index));
    at = index + rows;
    place = apart ? at + rows : index;
    uint64_t const count = number_rows(c, index, at);
    BVXI_TRY(bvxi_mesh_open(c->ctx, c->function, c->options.given.position_type, 0,
                            apart ? number_shared_rows(c, index, at, place) : count, c->mesh.left, level));
    BVXI_TRY(open_attributes(c, level, count));

    /* Of rows that share a vertex the first one remains. */
    for (uint64_t r = rows; r-- > 0;)
        if (index[r] != UINT32_MAX) {
            uint32_t const row = (uint32_t)r;
            float uv[2], uv2[2], normal[3];
            uint8_t colour[4];

            bvxi_attributes_give(c, row, has_moved(c, row, at[r]), uv, uv2, normal, colour);
            put_position(c, level, place[r], c->mesh.at[at[r]].p);
            if (level->uvs != NULL) memcpy(level->uvs + 2 * index[r], uv, sizeof uv);
            if (level->uvs2 != NULL) memcpy(level->uvs2 + 2 * place[r], uv2, sizeof uv2);
            if (level->normals != NULL) memcpy(level->normals + 3 * place[r], normal, sizeof normal);
            if (level->colours != NULL) memcpy(level->colours + 4 * place[r], colour, sizeof colour);
        }
    give_triangles(c, place, 1, level->triangles);
    if (level->uv_triangles != NULL) give_triangles(c, index, 1, level->uv_triangles);
    return BVX_OK;
}

/* ---- Levels ---- */

bvx_status bvxi_collapse_give(bvxi_collapse *c, bvx_mesh *level)
{
    bvx_status status;

    /* Arrays of an earlier level do not suit, and those of the caller's hold no attributes. */
    if (level->owned == 1 && bvxi_mesh_has_attributes(level)) bvx_mesh_free(c->ctx, level);
    int const owned = level->owned == 1 || level->positions == NULL;
    if (c->options.given.vertices == BVX_VERTICES_KEPT) status = give_kept(c, owned, level);
    else if (c->attributes.row != NULL && owned) status = BVXI_SCOPE(c->ctx, give_rows(c, level));
    else status = bvxi_collapse_give_plain(c, level);
    if (status != BVX_OK || c->attributes.material == NULL || level->owned != 1) return status;

    BVXI_TRY(
        bvxi_alloc(c->ctx, BVXI_RESULT, level->triangle_capacity * 4, "the materials", &level->materials));
    uint32_t *to = level->materials;
    for (uint64_t t = 0; t < c->mesh.triangles; t++)
        if (!bvxi_corner_gone(&c->mesh, (int32_t)(4 * t))) *to++ = c->attributes.material[t];
    return BVX_OK;
}
