/* read_ply.c - PLY, ASCII and binary in both byte orders, to an indexed mesh.
 *
 * Source: Turk. The PLY Polygon File Format. 1994.
 * The header (ply_header.c) tells what each value of a row is for; ply_text.c and ply_binary.c take the rows,
 * and this file knows what the values mean. What nobody wants is stepped over.
 * Triangles are as many as faces in nearly every file, so that is the room made first. Larger faces and
 * strips are counted on, and when there were any, faces and strips are read once more into exact room. Larger
 * faces lie down as fans and are cut at the end, when all vertices are known. Texture coordinates at corners
 * (texcoord) stay when all faces have them; those of vertices come before them.
 * Memory: the mesh (in files with larger faces, first a smaller one), 8 bytes a larger face. Cost:
 * O(bytes). */
#include "io/ply_file.h"

/* ---- failures ---- */

static const char *ply_unit(const ply_file *f)
{
    return f->header->encoding == PLY_ASCII ? "line" : "byte";
}

static uint64_t ply_place(const ply_file *f, const char *at)
{
    return f->header->encoding == PLY_ASCII ? bvxi_source_line(f->source, at)
                                            : bvxi_source_byte(f->source, at);
}

static const char *ply_row_name(const ply_element *e)
{
    return e->kind == PLY_VERTEX   ? "vertex"
           : e->kind == PLY_FACE   ? "face"
           : e->kind == PLY_STRIPS ? "strip"
                                   : "row";
}

bvx_status bvxi_ply_fail_end(const ply_file *f, const ply_element *e, uint64_t row)
{
    return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT, "PLY: the file ends (%s %u) inside %s %u of %u",
                     ply_unit(f), ply_place(f, f->source->end), ply_row_name(e), row, e->count);
}

bvx_status bvxi_ply_fail_finite(const ply_file *f, const char *at, uint64_t row, int32_t role)
{
    static const char *const names[] = {"coordinate", "colour", "texture coordinate"};
    return bvxi_fail_for(f->source->ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                         "PLY: %s %u (%s %u) has a %s that is not finite",
                         role == PLY_ROLE_UVS ? "face" : "vertex", row, ply_unit(f), ply_place(f, at),
                         names[role <= PLY_ROLE_Z       ? 0
                               : role <= PLY_ROLE_ALPHA ? 1
                                                        : 2]);
}

bvx_status bvxi_ply_fail_corner(const ply_file *f, const char *name, const char *at, uint64_t row,
                                int64_t corner)
{
    return bvxi_fail(f->source->ctx, BVX_ERR_RANGE, "PLY: %s %u (%s %u) names vertex %d, but there are %u",
                     name, row, ply_unit(f), ply_place(f, at), corner, f->vertex_count);
}

bvx_status bvxi_ply_fail_length(const ply_file *f, const ply_element *e, uint64_t row, int64_t count)
{
    if (e->kind == PLY_FACE && count >= 0)
        return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT,
                         "PLY: face %i (%s %u) has %d corners; it needs three", row, ply_unit(f),
                         ply_place(f, f->p), count);
    return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT,
                     "PLY: row %u (%s %u) of the element in line %u: a list of %d", row, ply_unit(f),
                     ply_place(f, f->p), bvxi_source_line(f->source, e->name), count);
}

/* ---- what values mean ---- */

/* Floats are shares of 1, 16 bits are brought down to 8, and other integers are taken as bytes. */
static uint8_t ply_colour(int32_t type, double value)
{
    if (type == PLY_F32 || type == PLY_F64) return bvxi_colour_byte(value);
    return bvxi_colour_byte(value / (type == PLY_U16 ? 65535.0 : 255.0));
}

bvx_status bvxi_ply_put(ply_file *f, const ply_property *property, const char *at, uint64_t row, double value)
{
    bvx_mesh *const mesh = f->mesh;
    int32_t const role = property->role;
    float const narrow = (float)value;

    if (!(value - value == 0.0) && !(f->source->takes_any && role <= PLY_ROLE_Z))
        return bvxi_ply_fail_finite(f, at, row, role);
    if (role <= PLY_ROLE_Z) {
        size_t const i = (size_t)row * 3 + (size_t)role;
        if (mesh->position_type == BVX_F32) ((float *)mesh->positions)[i] = narrow;
        else ((double *)mesh->positions)[i] = value;
    } else if (role <= PLY_ROLE_ALPHA) {
        mesh->colours[(size_t)row * 4 + (size_t)(role - PLY_ROLE_RED)] = ply_colour(property->type, value);
    } else {
        if (!(narrow - narrow == 0.0f)) return bvxi_ply_fail_finite(f, at, row, role);
        if (role != PLY_ROLE_UVS) {
            mesh->uvs[(size_t)row * 2 + (size_t)(role - PLY_ROLE_U)] = narrow;
        } else {
            uint64_t const i = f->uv_count * 2 + f->uv_numbers++;
            if (f->uvs_at_corners && i < mesh->uv_count * 2) mesh->uvs[i] = narrow;
        }
    }
    return BVX_OK;
}

/* The texture coordinates of a face's corners stand one behind the other:
 * its triangles are the same fan of them. */
static bvx_status ply_end_uvs(ply_file *f, uint64_t row, uint64_t triangle)
{
    if (f->uv_numbers == 0) { /* not all faces have them, so none shall */
        bvxi_drop_uvs(f->source->ctx, f->mesh);
        f->uvs_at_corners = 0;
        return BVX_OK;
    }
    if (f->uv_numbers != 2 * f->corners)
        return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT,
                         "PLY: face %i (%s %u) has %u corners and %u numbers in texcoord", row, ply_unit(f),
                         ply_place(f, f->p), f->corners, f->uv_numbers);
    for (uint64_t k = 0; triangle < f->triangle_count && triangle < f->room; triangle++, k++) {
        uint32_t *const t = f->mesh->uv_triangles + (size_t)triangle * 3;
        t[0] = (uint32_t)f->uv_count;
        t[1] = (uint32_t)(f->uv_count + k + 1);
        t[2] = (uint32_t)(f->uv_count + k + 2);
    }
    f->uv_count += f->corners;
    return BVX_OK;
}

bvx_status bvxi_ply_end_row(ply_file *f, const ply_element *e, uint64_t row)
{
    if (e->kind != PLY_FACE) return BVX_OK;
    uint64_t const triangle = f->triangle_count - (f->corners - 2);
    if (f->corners > 3) {
        if (f->fans != NULL) {
            f->fans[f->polygon_count].triangle = (uint32_t)triangle;
            f->fans[f->polygon_count].corners = (uint32_t)f->corners;
        }
        f->polygon_count++;
    }
    return f->uvs_at_corners ? ply_end_uvs(f, row, triangle) : BVX_OK;
}

/* ---- passes over the rows ---- */

static bvx_status ply_take_element_rows(ply_file *f, ply_element *e)
{
    e->rows = f->p;
    return f->header->encoding == PLY_ASCII ? bvxi_ply_take_text(f, e) : bvxi_ply_take_binary(f, e);
}

/* Room for triangles, and for the texture coordinates of so many corners. */
static bvx_status ply_make_room(ply_file *f, uint64_t triangles, uint64_t corners)
{
    bvx_context *const ctx = f->source->ctx;
    bvx_mesh *const mesh = f->mesh;

    if (triangles > INT32_MAX || corners > UINT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "PLY: the file has %u triangles, the limit is below 2^31",
                         triangles);
    if (f->uvs_at_corners) bvxi_drop_uvs(ctx, mesh);
    bvxi_free(ctx, mesh->triangles, mesh->triangle_capacity * 12);
    mesh->triangles = NULL;
    mesh->triangle_count = mesh->triangle_capacity = 0;
    BVXI_TRY(bvxi_make_triangles(ctx, mesh, triangles));
    f->room = triangles;
    f->triangle_count = f->uv_count = f->polygon_count = 0;
    if (!f->uvs_at_corners) return BVX_OK;
    BVXI_TRY(bvxi_make_uvs(ctx, mesh, corners));
    return bvxi_make_uv_triangles(ctx, mesh);
}

static bvx_status ply_make_vertices(ply_file *f)
{
    bvx_context *const ctx = f->source->ctx;
    const ply_header *const h = f->header;
    BVXI_TRY(bvxi_make_positions(ctx, f->mesh, h->position_type, f->vertex_count));
    if (h->colours) BVXI_TRY(bvxi_make_colours(ctx, f->mesh));
    if (h->colours && !h->alpha) memset(f->mesh->colours, 255, (size_t)f->vertex_count * 4);
    return h->uvs == 1 ? bvxi_make_uvs(ctx, f->mesh, f->vertex_count) : BVX_OK;
}

/* Rows of all elements up to the last that is wanted. */
static bvx_status ply_take_all(ply_file *f)
{
    const ply_header *const h = f->header;
    const ply_element *last = h->vertex;
    if (h->face > last) last = h->face;
    if (h->strips > last) last = h->strips;
    for (ply_element *e = h->elements; e <= last; e++) BVXI_TRY(ply_take_element_rows(f, e));
    return BVX_OK;
}

/* Faces and strips once more, into room for all their triangles. */
static bvx_status ply_take_faces_again(ply_file *f)
{
    const ply_header *const h = f->header;
    ply_element *const first = h->strips == NULL || (h->face != NULL && h->face < h->strips) ? h->face
                                                                                             : h->strips;
    ply_element *const second = first == h->face ? h->strips : h->face;

    f->fan_room = f->polygon_count;
    BVXI_TRY(ply_make_room(f, f->triangle_count, f->uv_count));
    BVXI_TRY(bvxi_alloc(f->source->ctx, BVXI_SCRATCH, f->fan_room * sizeof *f->fans,
                        "the polygons of the file", &f->fans));
    bvxi_source_pass(f->source, 0, 1);
    f->p = first->rows;
    BVXI_TRY(ply_take_element_rows(f, first));
    if (second == NULL) return BVX_OK;
    f->p = second->rows;
    return ply_take_element_rows(f, second);
}

static bvx_status ply_take_data(ply_file *f)
{
    uint64_t const faces = f->header->face == NULL ? 0 : f->header->face->count;
    BVXI_TRY(ply_make_vertices(f));
    BVXI_TRY(ply_make_room(f, faces, f->uvs_at_corners ? faces * 3 : 0));
    BVXI_TRY(ply_take_all(f));
    if (f->triangle_count != f->room) BVXI_TRY(ply_take_faces_again(f));
    if (f->triangle_count == 0)
        return bvxi_fail(f->source->ctx, BVX_ERR_EMPTY, "PLY: the strips have no triangle");
    return bvxi_cut_fans(f->source, f->mesh, f->fans, f->polygon_count);
}

static bvx_status ply_take_points(ply_file *f)
{
    if (f->vertex_count == 0)
        return bvxi_fail(f->source->ctx, BVX_ERR_EMPTY, "PLY: the file has no vertices");
    BVXI_TRY(ply_make_vertices(f));
    return ply_take_all(f);
}

static bvx_status read_ply_file(bvxi_source *source, int32_t points, bvx_mesh *mesh)
{
    ply_header header = {0};
    ply_file f = {0};
    bvx_status status;

    header.points = points;
    status = bvxi_ply_header_read(source, &header);
    if (status == BVX_OK) {
        f.source = source;
        f.header = &header;
        f.mesh = mesh;
        f.p = header.data;
        f.big = header.encoding == PLY_BIG;
        f.vertex_count = header.vertex->count;
        f.uvs_at_corners = header.uvs == 2;
        status = points ? ply_take_points(&f) : ply_take_data(&f);
    }
    bvxi_free(source->ctx, f.fans, f.fan_room * sizeof *f.fans);
    bvxi_ply_header_free(source->ctx, &header);
    return status;
}

bvx_status bvxi_read_ply(bvxi_source *source, bvx_mesh *mesh)
{
    return read_ply_file(source, 0, mesh);
}

bvx_status bvxi_read_ply_points(bvxi_source *source, bvx_mesh *points)
{
    return read_ply_file(source, 1, points);
}
