/* write_glb.c - a mesh to binary glTF 2.0.
 *
 * Source: Khronos. glTF 2.0 Specification (ISO/IEC 12113:2022).
 * Positions are floats relative to the centre of the bounds, which a node carries as doubles: so a mesh far from the origin
 * keeps its shape. World axes are kept; a node above turns z up into y up (glb_json.c). Normals are smooth, over seams of
 * the texture too. Colours become linear light with 16 bits; the texture's v runs down in glTF, so it is turned over.
 * Indices have 16 bits where they suffice: half the size, and all that older graphics interfaces draw. */
#include "io/file_parts.h"
#include "io/glb.h"
#include "io/glb_colours.h"
#include "mesh/normals.h"
#include "mesh/view.h"

#define GLB_PREPARED 0.5 /* share of the work before the first byte is written */

enum { GLB_HEAD = 20, GLB_CHUNK = 8 }; /* the file's head with that of its first chunk; the head of the second */

/* ---- what is written ---- */

static size_t glb_source(const bvxi_glb *glb, uint64_t vertex)
{
    return glb->seams.vertex != NULL ? glb->seams.vertex[vertex] : (size_t)vertex;
}

static void glb_position(const bvxi_glb *glb, uint64_t vertex, double p[3])
{
    bvxi_world_position(glb->mesh, glb_source(glb, vertex), p);
    for (int a = 0; a < 3; a++) p[a] -= glb->centre[a];
}

static uint8_t *glb_put_positions(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    double p[3];
    for (uint64_t v = begin; v < end; v++) {
        glb_position(user, v, p);
        for (int a = 0; a < 3; a++, at += 4) bvxi_store_f32(at, (float)p[a]);
    }
    return at;
}

static uint8_t *glb_put_normals(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    float n[3];
    for (uint64_t v = begin; v < end; v++) {
        bvxi_unit_normal(glb->normal + glb_source(glb, v) * 3, n);
        for (int a = 0; a < 3; a++, at += 4) bvxi_store_f32(at, n[a]);
    }
    return at;
}

static uint8_t *glb_put_colours(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    for (uint64_t v = begin; v < end; v++, at += 8) {
        const uint8_t *const colour = glb->mesh->colours + glb_source(glb, v) * 4;
        for (int c = 0; c < 3; c++) bvxi_store_u16(at + 2 * c, glb_linear_light[colour[c]]);
        bvxi_store_u16(at + 6, (uint16_t)(colour[3] * 257));
    }
    return at;
}

static uint8_t *glb_put_uvs(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    for (uint64_t v = begin; v < end; v++, at += 8) {
        size_t const i = glb->seams.uv != NULL ? glb->seams.uv[v] : (size_t)v;
        bvxi_store_f32(at, glb->mesh->uvs[2 * i]);
        bvxi_store_f32(at + 4, (float)(1.0 - (double)glb->mesh->uvs[2 * i + 1]));
    }
    return at;
}

static uint8_t *glb_put_indices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_glb *const glb = user;
    const uint32_t *const index = glb->seams.triangles != NULL ? glb->seams.triangles : glb->mesh->triangles;
    if (glb->size[BVXI_GLB_INDEX] == 2)
        for (size_t i = (size_t)begin; i < end; i++, at += 2) bvxi_store_u16(at, (uint16_t)index[i]);
    else
        for (size_t i = (size_t)begin; i < end; i++, at += 4) bvxi_store_u32(at, index[i]);
    return at;
}

static uint8_t *glb_put_padding(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    (void)user;
    memset(at, 0, (size_t)(end - begin));
    return at + (end - begin);
}

/* ---- the file ---- */

static uint64_t glb_padded(uint64_t size)
{
    return (size + 3) / 4 * 4;
}

static void glb_put_head(const bvxi_glb *glb, uint64_t json, bvx_buffer *file)
{
    uint8_t *const p = file->bytes;
    bvxi_output out = {0};
    uint64_t const padded = glb_padded(json);
    memcpy(p, "glTF", 4);
    bvxi_store_u32(p + 4, 2);
    bvxi_store_u32(p + 8, (uint32_t)file->size);
    bvxi_store_u32(p + 12, (uint32_t)padded);
    memcpy(p + 16, "JSON", 4);
    out.bytes = p + GLB_HEAD;
    bvxi_glb_put_json(glb, &out);
    memset(p + GLB_HEAD + json, ' ', (size_t)(padded - json));
    bvxi_store_u32(p + GLB_HEAD + padded, (uint32_t)glb_padded(glb->binary));
    memcpy(p + GLB_HEAD + padded + 4, "BIN", 4); /* with its zero */
}

static bvx_status glb_make_file(bvx_context *ctx, const bvxi_glb *glb, bvx_buffer *file)
{
    bvxi_file_part part[BVXI_GLB_ARRAYS + 1] = {{0, 0, glb_put_positions}, {0, 0, glb_put_normals}, {0, 0, glb_put_colours},
                                                {0, 0, glb_put_uvs}, {0, 0, glb_put_indices}, {0, 1, glb_put_padding}};
    bvxi_output json = {0};
    uint64_t head;
    bvxi_glb_put_json(glb, &json);
    head = GLB_HEAD + glb_padded(json.size) + GLB_CHUNK;
    BVXI_TRY(bvxi_glb_check_size(ctx, head + glb_padded(glb->binary)));
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        part[i].count = glb->count[i];
        part[i].most = glb->size[i];
    }
    part[BVXI_GLB_ARRAYS].count = glb_padded(glb->binary) - glb->binary;
    BVXI_TRY(bvxi_make_file(ctx, "the GLB file", GLB_PREPARED, head, part, BVXI_GLB_ARRAYS + 1, glb, file));
    glb_put_head(glb, json.size, file);
    return BVX_OK;
}

/* Bounds of the positions as they are written; all must be floats. */
static bvx_status glb_find_bounds(bvx_context *ctx, bvxi_glb *glb)
{
    double p[3];
    for (uint64_t v = 0; v < glb->vertices; v++) {
        glb_position(glb, v, p);
        for (int a = 0; a < 3; a++) {
            float const f = (float)p[a];
            if (!(p[a] < BVXI_FLOAT_LIMIT && p[a] > -BVXI_FLOAT_LIMIT))
                return bvxi_fail(ctx, BVX_ERR_RANGE, "GLB: vertex %u is %g from the middle of the mesh, too far for the "
                                 "format's 32-bit floats; take PLY or OBJ", (uint64_t)glb_source(glb, v), p[a]);
            if (v == 0 || f < glb->low[a]) glb->low[a] = f;
            if (v == 0 || f > glb->high[a]) glb->high[a] = f;
        }
    }
    return BVX_OK;
}

static bvx_status glb_write_with_normals(bvx_context *ctx, bvxi_glb *glb, const bvx_mesh_view *view, bvx_buffer *file)
{
    uint64_t const bytes = glb->mesh->vertex_count * 3 * sizeof(double);
    double *sum;
    bvx_status status;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the normals", &sum));
    bvxi_add_normals(view, 1.0, sum);
    glb->normal = sum;
    status = glb_make_file(ctx, glb, file);
    bvxi_free(ctx, sum, bytes);
    return status;
}

bvx_status bvxi_write_glb(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    bvxi_glb glb = {0};
    bvx_mesh_view view;
    double low[3], high[3];
    bvx_status status;
    glb.mesh = mesh;
    BVXI_TRY(bvxi_glb_check_size(ctx, mesh->triangle_count * 6)); /* also keeps the corners below 2^32 */
    BVXI_TRY(bvxi_progress(ctx, "write", 0.0));
    bvx_mesh_view_of(mesh, &view);
    BVXI_TRY(bvxi_view_bounds(ctx, "GLB", &view, low, high));
    for (int a = 0; a < 3; a++) glb.centre[a] = (low[a] + mesh->frame[a]) * 0.5 + (high[a] + mesh->frame[a]) * 0.5;
    if (mesh->uv_triangles != NULL) BVXI_TRY(bvxi_split_seams(ctx, mesh, &glb.seams));
    glb.vertices = mesh->uv_triangles != NULL ? glb.seams.count : mesh->vertex_count;
    bvxi_glb_layout(&glb);
    status = bvxi_glb_check_size(ctx, glb.binary);
    if (status == BVX_OK) status = bvxi_progress(ctx, "write", 0.6 * GLB_PREPARED);
    if (status == BVX_OK) status = glb_find_bounds(ctx, &glb);
    if (status == BVX_OK) status = glb_write_with_normals(ctx, &glb, &view, file);
    bvxi_free_seams(ctx, mesh, &glb.seams);
    return status;
}
