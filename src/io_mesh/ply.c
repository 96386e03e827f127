/* ply.c - PLY, to meshes and from them. ply_header.c says what each value of a row is for, ply_rows.c takes
 * the rows, and this file makes the mesh.
 *
 * Source: Turk. The PLY Polygon File Format. 1994. */
#include "io_mesh/ply_file.h"

/* ---- Read ---- */

/* Triangles are as many as faces in nearly every file, so that is the room made first. Larger faces and
 * strips are counted on, and when there were any, faces and strips are read once more into exact room. Larger
 * faces lie down as fans and are cut at the end, when all vertices are known. Texture coordinates at corners
 * (texcoord) stay when all faces have them; those of vertices come before them.
 * Memory: the mesh (in files with larger faces, first a smaller one), 8 bytes a larger face. Cost:
 * O(bytes). */

/* ---- passes over the rows ---- */

static bvx_status ply_take_element_rows(ply_file *f, ply_element *e)
{
    e->rows = f->p;
    return f->header->encoding == PLY_ASCII ? bvxi_ply_take_text(f, e) : bvxi_ply_take_binary(f, e);
}

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

    if (!f->uvs_at_corners) return BVX_OK;
    BVXI_TRY(bvxi_make_uvs(ctx, mesh, corners));
    return bvxi_make_array(ctx, mesh, BVXI_MESH_UV_TRIANGLES);
}

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

static bvx_status read_ply_file(bvxi_source *source, int32_t points, bvx_mesh *mesh)
{
    ply_header header = {.points = points};
    BVXI_TRY(bvxi_ply_header_read(source, &header));
    ply_file f = {.source = source,
                  .header = &header,
                  .mesh = mesh,
                  .p = header.data,
                  .big = header.encoding == PLY_BIG,
                  .vertex_count = header.vertex->count,
                  .uvs_at_corners = header.uvs == 2};
    if (points && f.vertex_count == 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the file has no vertices");
    BVXI_TRY(bvxi_make_positions(source->ctx, mesh, header.position_type, f.vertex_count));
    if (header.colours) BVXI_TRY(bvxi_make_array(source->ctx, mesh, BVXI_MESH_COLOURS));
    if (header.colours && !header.alpha) memset(mesh->colours, 255, (size_t)f.vertex_count * 4);
    if (header.uvs == 1) BVXI_TRY(bvxi_make_uvs(source->ctx, mesh, f.vertex_count));
    if (points) return ply_take_all(&f);

    /* As if all faces were triangles; strips have no room at first, and so are read in the second pass. */
    uint64_t const faces = header.face == NULL ? 0 : header.face->count;
    BVXI_TRY(ply_make_room(&f, faces, f.uvs_at_corners ? faces * 3 : 0));
    BVXI_TRY(ply_take_all(&f));
    if (f.triangle_count != f.room) {
        int const strips_first = header.face == NULL ||
                                 (header.strips != NULL && header.strips < header.face);
        ply_element *const order[2] = {strips_first ? header.strips : header.face,
                                       strips_first ? header.face : header.strips};

        f.fan_room = f.polygon_count;
        BVXI_TRY(ply_make_room(&f, f.triangle_count, f.uv_count));
        BVXI_TRY(BVXI_ARRAY(source->ctx, f.fan_room, "the polygons of the file", f.fans));
        bvxi_source_pass(source, 0, 1);
        for (int i = 0; i < 2 && order[i] != NULL; i++) {
            f.p = order[i]->rows;
            BVXI_TRY(ply_take_element_rows(&f, order[i]));
        }
    }
    if (f.triangle_count == 0) return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the strips have no triangle");
    return bvxi_cut_fans(source, mesh, f.fans, f.polygon_count);
}

bvx_status bvxi_read_ply(bvxi_source *source, bvx_mesh *mesh)
{
    return read_ply_file(source, 0, mesh);
}

bvx_status bvxi_read_ply_points(bvxi_source *source, bvx_mesh *points)
{
    return read_ply_file(source, 1, points);
}

/* ---- Written ---- */

/* Binary little-endian: floats, or doubles where the mesh has doubles or a frame. Normals, where requested, are the floats nx ny nz of vertices, after the coordinates as readers expect
 * them. Colours are the properties red green blue alpha of vertices, texture coordinates s t of vertices, or
 * the list texcoord of faces (two numbers a corner) where the corners have their own. */

/* how many there are and the numbers: three, six */
enum { PLY_WRITTEN_FACE = 13, PLY_WRITTEN_TEXCOORD = 25 };

static void ply_put_property(const char *type, const char *const *names, int count, bvxi_output *out)
{
    for (int i = 0; i < count; i++) bvxi_output_print(out, "property %s %s\n", type, names[i]);
}

static void ply_put_header(const bvxi_written *what, bvxi_output *out)
{
    const bvx_mesh *const mesh = what->mesh;
    static const char *const axes[] = {"x", "y", "z"}, *const normal[] = {"nx", "ny", "nz"};
    static const char *const colours[] = {"red", "green", "blue", "alpha"};
    static const char *const uvs[] = {"s", "t"};
    static const char *const corners[] = {"vertex_indices"};
    static const char *const texcoord[] = {"texcoord"};

    /* Properties stand in the order in which ply_put_vertices and ply_put_faces write the values. */
    bvxi_output_print(out,
                      "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex %u\n",
                      mesh->vertex_count);
    ply_put_property(bvxi_writes_f32(mesh) ? "float" : "double", axes, 3, out);
    if (what->normals) ply_put_property("float", normal, 3, out);
    if (mesh->colours != NULL) ply_put_property("uchar", colours, 4, out);
    if (mesh->uvs != NULL && mesh->uv_triangles == NULL) ply_put_property("float", uvs, 2, out);
    bvxi_output_print(out, "element face %u\n", mesh->triangle_count);
    /* Many readers know only the type int; uint is there for meshes that need it. */
    ply_put_property(mesh->vertex_count > INT32_MAX ? "list uchar uint" : "list uchar int", corners, 1, out);
    if (mesh->uv_triangles != NULL) ply_put_property("list uchar float", texcoord, 1, out);
    bvxi_output_print(out, "end_header\n");
}

static uint8_t *ply_put_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_written *const what = user;
    const bvx_mesh *const mesh = what->mesh;
    int const f32 = bvxi_writes_f32(mesh), uvs = mesh->uvs != NULL && mesh->uv_triangles == NULL;
    double world[3];
    float normal[3];

    for (uint64_t v = begin; v < end; v++) {
        bvxi_world_position(mesh, v, world);
        for (int a = 0; a < 3; a++, at += f32 ? 4 : 8) {
            if (f32) bvxi_store_f32(at, (float)world[a]);
            else bvxi_store_f64(at, world[a]);
        }

        /* The sum becomes a unit vector here, so no array of floats is kept beside it. */
        if (what->normals) {
            bvxi_written_normal(mesh, what->sum, v, normal);
            for (int a = 0; a < 3; a++, at += 4) bvxi_store_f32(at, normal[a]);
        }
        if (mesh->colours != NULL) {
            memcpy(at, mesh->colours + (size_t)v * 4, 4);
            at += 4;
        }
        if (uvs) {
            bvxi_store_f32(at, mesh->uvs[(size_t)v * 2]);
            bvxi_store_f32(at + 4, mesh->uvs[(size_t)v * 2 + 1]);
            at += 8;
        }
    }
    return at;
}

static uint8_t *ply_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = ((const bvxi_written *)user)->mesh;

    for (uint64_t t = begin; t < end; t++) {
        *at++ = 3;
        for (size_t k = 0; k < 3; k++, at += 4) bvxi_store_u32(at, mesh->triangles[(size_t)t * 3 + k]);
        if (mesh->uv_triangles == NULL) continue;
        *at++ = 6;
        for (size_t k = 0; k < 3; k++, at += 8) {
            const float *const uv = mesh->uvs + (size_t)mesh->uv_triangles[(size_t)t * 3 + k] * 2;
            bvxi_store_f32(at, uv[0]);
            bvxi_store_f32(at + 4, uv[1]);
        }
    }
    return at;
}

bvx_status bvxi_write_ply(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file)
{
    const bvx_mesh *const mesh = what->mesh;
    double const from = what->normals ? BVXI_NORMALS_SHARE : 0.0;
    bvxi_file_part part[2] = {{.put = ply_put_vertices, .user = what}, {.put = ply_put_faces, .user = what}};
    bvxi_output head = {0};

    ply_put_header(what, &head);
    part[0].count = mesh->vertex_count;
    part[0].most = bvxi_writes_f32(mesh) ? 12 : 24;
    if (what->normals) part[0].most += 12;
    if (mesh->colours != NULL) part[0].most += 4;
    if (mesh->uvs != NULL && mesh->uv_triangles == NULL) part[0].most += 8;
    part[1].count = mesh->triangle_count;
    part[1].most = PLY_WRITTEN_FACE + (mesh->uv_triangles != NULL ? PLY_WRITTEN_TEXCOORD : 0);
    BVXI_TRY(bvxi_make_file(ctx, "the PLY file", from, head.size, part, 2, file));

    head.bytes = file->bytes;
    head.size = 0;
    ply_put_header(what, &head);
    return BVX_OK;
}
