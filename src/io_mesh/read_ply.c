/* read_ply.c - PLY, ASCII and binary in both byte orders, to an indexed mesh.
 *
 * Source: Turk. The PLY Polygon File Format. 1994.
 * The header (ply_header.c) says what each value of a row is for; ply_rows.c and ply_rows.c take the rows,
 * and this file knows what the values mean. What nobody wants is stepped over.
 * Triangles are as many as faces in nearly every file, so that is the room made first. Larger faces and
 * strips are counted on, and when there were any, faces and strips are read once more into exact room. Larger
 * faces lie down as fans and are cut at the end, when all vertices are known. Texture coordinates at corners
 * (texcoord) stay when all faces have them; those of vertices come before them.
 * Memory: the mesh (in files with larger faces, first a smaller one), 8 bytes a larger face. Cost:
 * O(bytes). */
#include "io_mesh/ply_file.h"

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
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "PLY: the file has %u triangles, the limit is below 2^31", triangles);

    /* A second call makes the arrays anew: what the first pass has written is too short by now. */
    if (f->uvs_at_corners) bvxi_drop_uvs(ctx, mesh);
    bvxi_mesh_release(ctx, mesh, BVXI_MESH_TRIANGLES);
    mesh->triangle_count = mesh->triangle_capacity = 0;
    BVXI_TRY(bvxi_make_triangles(ctx, mesh, triangles));
    f->room = triangles;
    f->triangle_count = f->uv_count = f->polygon_count = 0;

    /* Where texture coordinates belong to corners, there is one for each corner of each face. */
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

    /* Elements after the last wanted one are not even stepped over: their rows may be broken. */
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

    /* The first pass has counted: fans, triangles and texture coordinates now get exact room. */
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

    /* As if all faces were triangles; strips have no room at first, and so are read in the second pass. */
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
    bvxi_drop(source->ctx, f.fans);
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
