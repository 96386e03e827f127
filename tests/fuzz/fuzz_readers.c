/* fuzz_readers.c - the readers of meshes and points on damaged files: no crash, no leak, no more memory than
 * the file's size allows; an error in words, or a valid mesh that is written and read to itself. */
#include "fuzz_files.h"
#include "io/formats.h"
#include "mesh/mesh.h"

enum {
    FUZZ_STL,
    FUZZ_OBJ,
    FUZZ_PLY,
    FUZZ_OFF,
    FUZZ_XYZ,
    FUZZ_CLOUD,
    FUZZ_GLB,
    FUZZ_GLTF,
    FUZZ_3MF,
    FUZZ_MODEL
};

static const fuzz_format formats[] = {
    {"stl", BVX_FORMAT_STL},       {"obj", BVX_FORMAT_OBJ},   {"ply", BVX_FORMAT_PLY},
    {"off", BVX_FORMAT_OFF},       {"xyz", BVX_FORMAT_XYZ},   {"ply_points", BVX_FORMAT_PLY},
    {"glb", BVX_FORMAT_GLB},       {"gltf", BVX_FORMAT_GLTF}, {"3mf", BVX_FORMAT_3MF},
    {"3mf_model", BVX_FORMAT_3MF},
};
static const int32_t multiples[] = {READ_STL,    READ_OBJ,  READ_PLY,  READ_OFF, READ_POINTS,
                                    READ_POINTS, READ_GLTF, READ_GLTF, READ_3MF, READ_3MF};

static void fuzz_check_mesh(const bvx_mesh *m)
{
    fuzz_require(m->vertex_count > 0 && m->owned == 1, "a mesh without vertices");
    fuzz_require(m->vertex_capacity == m->vertex_count && m->triangle_capacity == m->triangle_count,
                 "a loose capacity");
    for (uint64_t i = 0; i < m->triangle_count * 3; i++)
        fuzz_require(m->triangles[i] < m->vertex_count, "an index out of range");
    for (uint64_t i = 0; i < m->vertex_count * 3; i++) {
        double const v = m->position_type == BVX_F32 ? (double)((float *)m->positions)[i]
                                                     : ((double *)m->positions)[i];
        fuzz_require(v - v == 0.0, "a coordinate that is not finite");
    }
}

/* Colours and texture coordinates of exact size; numbers into them in range. */
static void fuzz_check_attributes(const bvx_mesh *m)
{
    volatile uint8_t last = 0;

    if (m->colours != NULL) last = m->colours[m->vertex_capacity * 4 - 1];
    (void)last;
    for (uint64_t i = 0; m->normals != NULL && i < m->vertex_count; i++) {
        const float *const n = m->normals + i * 3;
        float const squares = n[0] * n[0] + n[1] * n[1] + n[2] * n[2];
        fuzz_require(squares > 0.999f && squares < 1.001f, "a normal of another length than 1");
    }
    for (uint64_t i = 0; m->materials != NULL && i < m->triangle_count; i++)
        fuzz_require(m->assets != NULL && m->materials[i] <= m->assets->material_count,
                     "a material out of range");
    for (uint64_t i = 0; m->assets != NULL && i < m->assets->image_count; i++)
        if (m->assets->images[i].size > 0) last = m->assets->images[i].bytes[m->assets->images[i].size - 1];
    fuzz_require(m->uvs != NULL || (m->uv_count == 0 && m->uv_triangles == NULL),
                 "texture numbers without coordinates");
    if (m->uvs == NULL) return;
    fuzz_require(m->uv_triangles != NULL || m->uv_count == m->vertex_capacity,
                 "texture coordinates of another count");
    for (uint64_t i = 0; i < m->uv_count * 2; i++)
        fuzz_require(m->uvs[i] - m->uvs[i] == 0.0f, "a texture coordinate that is not finite");
    for (uint64_t i = 0; m->uvs2 != NULL && i < m->vertex_count * 2; i++)
        fuzz_require(m->uvs2[i] - m->uvs2[i] == 0.0f, "a texture coordinate that is not finite");
    for (uint64_t i = 0; m->uv_triangles != NULL && i < m->triangle_count * 3; i++)
        fuzz_require(m->uv_triangles[i] < m->uv_count, "a texture number out of range");
}

/* What was read is written and read again to the same bytes: PLY keeps all of a mesh, OBJ all of doubles. */
static void fuzz_check_writing(bvx_context *ctx, const bvx_mesh *m)
{
    int32_t const format = m->position_type == BVX_F64 && m->vertex_count % 2 == 0 ? BVX_FORMAT_OBJ
                                                                                   : BVX_FORMAT_PLY;
    size_t const bytes = (size_t)m->vertex_count * (m->position_type == BVX_F32 ? 12 : 24);
    bvx_buffer b = {0};
    bvx_mesh back = {0};

    if (m->vertex_count > 10000 || m->triangle_count > 10000) return;
    fuzz_require(bvx_write_mesh(ctx, m, 1, NULL, format, &b) == BVX_OK, "a mesh that cannot be written");
    fuzz_require(bvx_read_mesh(ctx, b.bytes, b.size, format, NULL, &back) == BVX_OK,
                 "a written mesh that cannot be read");
    fuzz_require(back.vertex_count == m->vertex_count && back.triangle_count == m->triangle_count &&
                     back.position_type == m->position_type &&
                     memcmp(back.positions, m->positions, bytes) == 0 &&
                     memcmp(back.triangles, m->triangles, (size_t)m->triangle_count * 12) == 0,
                 "a mesh that changed by writing and reading");
    fuzz_require((back.colours != NULL) == (m->colours != NULL) && (back.uvs != NULL) == (m->uvs != NULL),
                 "colours or texture coordinates lost");
    if (m->colours != NULL && format == BVX_FORMAT_PLY)
        fuzz_require(memcmp(back.colours, m->colours, (size_t)m->vertex_count * 4) == 0,
                     "colours that changed");
    bvx_mesh_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
}

/* Normals are no other mesh, and a mesh and a piece of it are levels of one
 * file: the same bytes each time, and all of it there. */
static void fuzz_check_more_writing(bvx_context *ctx, const bvx_mesh *m)
{
    bvx_mesh levels[2] = {*m, *m};
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_buffer b = {0}, twin = {0};
    bvx_mesh back = {0};
    bvx_status status;
    levels[1].triangle_count = (m->triangle_count + 1) / 2;
    if (m->vertex_count > 10000 || m->triangle_count > 10000) return;
    o.normals = 1;
    fuzz_require(bvx_write_mesh(ctx, m, 1, &o, BVX_FORMAT_PLY, &b) == BVX_OK,
                 "normals that cannot be written");
    fuzz_require(bvx_read_mesh(ctx, b.bytes, b.size, BVX_FORMAT_PLY, NULL, &back) == BVX_OK,
                 "a mesh with normals that cannot be read");
    fuzz_require(back.vertex_count == m->vertex_count && back.triangle_count == m->triangle_count &&
                     memcmp(back.triangles, m->triangles, (size_t)m->triangle_count * 12) == 0,
                 "a mesh that changed by normals");
    bvx_mesh_free(ctx, &back);
    bvx_buffer_free(ctx, &b);

    status = bvx_write_mesh(ctx, levels, 2, NULL, BVX_FORMAT_GLB, &b);
    fuzz_require(status == BVX_OK || status == BVX_ERR_RANGE, "levels that cannot be written");
    if (status != BVX_OK) return; /* wider than floats reach */
    fuzz_require(bvx_write_mesh(ctx, levels, 2, NULL, BVX_FORMAT_GLB, &twin) == BVX_OK &&
                     twin.size == b.size && memcmp(twin.bytes, b.bytes, (size_t)b.size) == 0,
                 "levels that changed from call to call");
    fuzz_require(b.size % 4 == 0 && b.size > m->triangle_count * 12, "a file of levels that is too small");
    bvx_buffer_free(ctx, &b);
    bvx_buffer_free(ctx, &twin);
}

/* What is reported of a file is what reading it gives, and what does not fit is refused. */
static void fuzz_check_written(bvx_context *ctx, const bvx_mesh *m)
{
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_write_report r;
    bvx_buffer b = {0};
    bvx_mesh back = {0};
    bvx_certificate c;
    bvx_mesh_view view;
    bvx_status status;

    if (m->vertex_count > 10000 || m->triangle_count > 10000) return;
    o.reports = &r;
    status = bvx_write_mesh(ctx, m, 1, &o, BVX_FORMAT_STL, NULL);
    o.reports = NULL;
    fuzz_require(status == BVX_OK || status == BVX_ERR_RANGE, "a mesh whose file cannot be judged");
    if (status != BVX_OK) return; /* wider than floats reach */
    status = bvx_write_mesh(ctx, m, 1, NULL, BVX_FORMAT_STL, &b);
    fuzz_require((status == BVX_OK) == (r.fits != 0), "a refusal that the report does not know");
    bvx_buffer_free(ctx, &b);

    o.rounding = BVX_ROUNDING_ALLOW;
    fuzz_require(bvx_write_mesh(ctx, m, 1, &o, BVX_FORMAT_STL, &b) == BVX_OK, "rounding that is not allowed");
    fuzz_require(bvx_read_mesh(ctx, b.bytes, b.size, BVX_FORMAT_STL, NULL, &back) == BVX_OK,
                 "a rounded mesh that cannot be read");
    bvx_mesh_view_of(&back, &view);
    fuzz_require(bvx_mesh_check(ctx, &view, 1, &c) == BVX_OK && c.closed == r.file.closed &&
                     c.vertices == r.file.vertices && c.collapsed == r.file.collapsed &&
                     c.components == r.file.components && c.euler == r.file.euler,
                 "a certificate that is not the file's");
    bvx_mesh_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
}

/* What bvx_read_mesh reads is read the same; what it refuses for coordinates may be read without them. */
static void fuzz_check_finite(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format,
                              const bvx_mesh *whole)
{
    bvx_mesh m = {0};
    uint64_t dropped = 0, a, b;
    bvx_read_report report = {0};
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_status status;

    o.drop_nonfinite = 1;
    o.report = &report;
    status = bvx_read_mesh(ctx, file, size, format, &o, &m);

    if (whole != NULL) {
        fuzz_require(status == BVX_OK && report.dropped == 0, "a finite mesh of which something was dropped");
        fuzz_must(ctx, bvx_mesh_hash(ctx, whole, &a));
        fuzz_must(ctx, bvx_mesh_hash(ctx, &m, &b));
        fuzz_require(a == b, "a finite mesh that is read otherwise");
    } else if (status == BVX_OK) {
        fuzz_require(m.triangle_count != 0, "a mesh of nothing");
        fuzz_must(ctx, bvx_mesh_drop_nonfinite(ctx, &m, &dropped));
        fuzz_require(dropped == 0, "triangles that are dropped the second time");
    }
    bvx_mesh_free(ctx, &m);
}

/* A file that is kept has its mesh again, and a triangle more for each primitive that has lost all. */
static void fuzz_check_kept(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format)
{
    bvx_mesh m = {0}, back = {0};
    bvx_buffer b = {0};
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_write_options w = {.struct_size = sizeof w};
    bvx_status status;

    o.keep_file = 1;
    w.source = &m;
    w.rounding = BVX_ROUNDING_ALLOW;
    status = bvx_read_mesh(ctx, file, size, format, &o, &m);
    fuzz_require(status == BVX_OK || status == BVX_ERR_BUDGET, "a mesh that is not read with its file");
    if (status == BVX_OK && m.assets != NULL && m.assets->document != NULL) {
        status = bvx_write_mesh(ctx, &m, 1, &w, BVX_FORMAT_GLB, &b);
        fuzz_require(status == BVX_OK || status == BVX_ERR_BUDGET || status == BVX_ERR_RANGE,
                     "a kept file that is not written");
        if (status == BVX_OK) status = bvx_read_mesh(ctx, b.bytes, b.size, BVX_FORMAT_GLB, NULL, &back);
        else status = BVX_ERR_BUDGET;
        fuzz_require(status == BVX_ERR_BUDGET ||
                         (status == BVX_OK && back.vertex_count == m.vertex_count &&
                          back.triangle_count >= m.triangle_count &&
                          memcmp(back.positions, m.positions, (size_t)m.vertex_count * 12) == 0),
                     "a kept file with another mesh");
    }
    bvx_mesh_free(ctx, &back);
    bvx_mesh_free(ctx, &m);
    bvx_buffer_free(ctx, &b);
}

/* A container of one model, which is text; room for FUZZ_AROUND bytes more than that has. */
enum { FUZZ_AROUND = 30 + 46 + 22 + 2 * 16 };

static size_t fuzz_pack_model(const void *text, size_t n, uint8_t *file)
{
    uint8_t *const entry = file + 46 + n, *const end = entry + 62;
    uint32_t const crc = bvxi_crc32(text, n);

    memset(file, 0, n + FUZZ_AROUND);
    for (int local = 1; local >= 0; local--) {
        uint8_t *const head = local ? file : entry, *const facts = head + (local ? 14 : 16);
        bvxi_store_u32(head, local ? 0x04034b50 : 0x02014b50);
        bvxi_store_u32(facts, crc);
        bvxi_store_u32(facts + 4, (uint32_t)n);
        bvxi_store_u32(facts + 8, (uint32_t)n);
        bvxi_store_u16(facts + 12, 16);
        memcpy(head + (local ? 30 : 46), "3D/3dmodel.model", 16);
    }
    memcpy(file + 46, text, n);
    bvxi_store_u32(end, 0x06054b50);
    bvxi_store_u16(end + 10, 1);
    bvxi_store_u32(end + 16, (uint32_t)(46 + n));
    return n + FUZZ_AROUND;
}

static int fuzz_read_as(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    static const bvx_mesh empty = {0};
    int32_t const number = formats[format].number;
    int const is_points = format == FUZZ_XYZ || format == FUZZ_CLOUD;
    bvx_mesh m = {0};
    bvx_status const status = is_points ? bvx_read_points(ctx, file, size, number, &m)
                                        : bvx_read_mesh(ctx, file, size, number, NULL, &m);
    /* Nodes may repeat a mesh into more than the target's memory. */
    int const good = status == BVX_ERR_BUDGET && format >= FUZZ_GLB
                         ? 0
                         : fuzz_was_read(ctx, status, multiples[format], size, 0);

    if (good) {
        fuzz_require((m.triangle_count == 0) == is_points, "points with triangles, or a mesh without");
        fuzz_check_mesh(&m);
        fuzz_check_attributes(&m);
        if (!is_points) fuzz_check_writing(ctx, &m);
        if (!is_points) fuzz_check_more_writing(ctx, &m);
        if (!is_points) fuzz_check_written(ctx, &m);
        if (!is_points) fuzz_check_finite(ctx, file, size, number, &m);
        if (format >= FUZZ_GLB) fuzz_check_kept(ctx, file, size, number);
    } else {
        if (!is_points && status == BVX_ERR_RANGE) fuzz_check_finite(ctx, file, size, number, NULL);
        fuzz_require(memcmp(&m, &empty, sizeof m) == 0, "a result behind an error");
    }
    bvx_mesh_free(ctx, &m);
    return good;
}

/* The text of a model is damaged by itself, since no damaged container would have its check sum. */
static int fuzz_read(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    uint8_t *const packed = format == FUZZ_MODEL ? malloc(size + FUZZ_AROUND) : NULL;
    int good;

    fuzz_require((packed != NULL) == (format == FUZZ_MODEL), "no memory");
    if (packed != NULL) size = fuzz_pack_model(file, size, packed);
    good = fuzz_read_as(ctx, packed != NULL ? packed : file, size, format);
    free(packed);
    return good;
}

/* ---- files to begin with ---- */

static void fuzz_put_u32(fuzz_file *s, uint32_t v, int big)
{
    uint8_t b[4];
    for (int i = 0; i < 4; i++) b[i] = (uint8_t)(v >> 8 * (big ? 3 - i : i) & 0xff);
    fuzz_put(s, b, 4);
}

static void fuzz_put_f32(fuzz_file *s, float v, int big)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    fuzz_put_u32(s, bits, big);
}

static void fuzz_seed_stl(fuzz_file *s)
{
    static const int corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};

    fuzz_put_text(s, "solid tetrahedron in a binary file");
    while (s->size < 80) fuzz_put(s, "", 1);
    fuzz_put_u32(s, 4, 0);
    for (int t = 0; t < 4; t++) {
        for (int i = 0; i < 3; i++) fuzz_put_f32(s, 0, 0);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) fuzz_put_f32(s, corners[t][k] == a + 1 ? 1.5f : -0.0f, 0);
        fuzz_put(s, "\0", 2);
    }
}

static void fuzz_seed_ply(fuzz_file *s, int big)
{
    fuzz_put_text(s,
                  big ? "ply\nformat binary_big_endian 1.0\n" : "ply\r\nformat binary_little_endian 1.0\r\n");
    fuzz_put_text(
        s,
        big ? "element other 2\nproperty list uchar short a\nelement vertex 4\nproperty uchar r\nproperty float z\n"
              "property float x\nproperty float y\nelement face 2\nproperty list ushort uint vertex_index\n"
              "property char c\nend_header\n"
            : "comment x\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
              "property int i\r\nelement face 2\r\nproperty list uchar int vertex_indices\r\nend_header\r\n");
    if (big) fuzz_put(s, "\0\2abcd", 6);
    for (uint32_t v = 0; v < 4; v++) {
        if (big) fuzz_put(s, "r", 1);
        for (uint32_t a = 0; a < 3; a++) fuzz_put_f32(s, (float)(v * 3 + a) / 7, big);
        if (!big) fuzz_put_u32(s, v, 0);
    }
    for (uint32_t f = 0; f < 2; f++) {
        fuzz_put(s, big ? f == 0 ? "\0\3" : "\0\4" : "\3", big ? 2 : 1);
        for (uint32_t k = 0; k < (big && f == 1 ? 4 : 3); k++) fuzz_put_u32(s, (f + k) % 4, big);
        if (big) fuzz_put(s, "c", 1);
    }
}

static const char *const fuzz_stl_text =
    "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 -0\n   vertex 0.5 1.25 3\n  endloop\n"
    " endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n"
    "  endloop\n endfacet\nendsolid a\n";
static const char *const fuzz_obj_text =
    "# x\nmtllib a.mtl\nv 0 0 0\nv 1.0 0.125 -3e-2\r\nv 12345678901234567890.5 1 1 0.5 0.5 0.5\nv 0 \\\n1 0\nvt 0 0\n"
    "vn 0 0 1\ng a\nf 1 2 3\nf 1/1 2/1 3/1 4/1\nf -1//1 -2//1 \\\n -3//1\nf 1/1/1 2/1/1 4/1/1\n";
static const char *const fuzz_ply_text =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "property list uchar int l\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0\n1 0.1 1e-300 2 5 6\n0.30000000000000004 1 0 1 9\n0 1 1 0\n3 0 1 2\n4 0 1 2 3\n3 2 1 0\n";

static const char *const fuzz_obj_coloured =
    "v 0 0 0 1 0 0\nv 1.0 0.125 -3e-2 0.5 .5 0\nv 1 1 1 1 0.5 0.5 0.5\nv 0 \\\n1 0 0 0 1\nvt 0 0\nvt 1\nvt 0.5 1 2\nvt 0 0\n"
    "f 1/1 2/2 3/3\nf 1/1 2/1/7 3/4 4/1\nf -1/-1 -2/2/1 \\\n -3/1\nf 1/1/1 2/1/1 4/1/1\n";
static const char *const fuzz_ply_coloured =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
    "property ushort green\nproperty float blue\nproperty float u\nproperty float v\n"
    "property list uchar int l\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0 1 2 .5 0 1 0\n1 0.1 1e-300 2 5 0.6 1 1 2 5 6\n0.30000000000000004 1 0 1 9 0 9 9 0\n0 1 1 0 0 0 0 0 1 3\n"
    "3 0 1 2 6 0 0 0 1 1 1\n4 0 1 2 3 8 1 2 3 4 5 6 7 8\n6 0 1 2 -1 3 2\n";
static const char *const fuzz_off_text =
    "OFF # x\n5 3 0\n0 0 0\n1 0.125 -3e-2\n\n12345678901234567890.5 1 1\n0 1 0\n.3 .3 0\n3 0 1 2 255 0 0\n4 0 1 2 3\n5 0 1 2 3 4\n";
static const char *const fuzz_off_coloured =
    "STCNOFF 4 2 5\n0 0 0 0 0 1 255 0 0 255 0 1\n1 0 0 0 0 1 0 255 0 255 1 0\n1 1 0 0 0 1 0 0 255 128 1 1\n0 1 1 0 0 1 9 9 9 9 0 0\n"
    "3 0 1 2\n4 0 1 2 3 0.5 0.5 0.5\n";

static const char *const fuzz_xyz_text =
    "\xef\xbb\xbfx;y;z;nx\n# points\n0 0 0\n1,2.5,-3e-2,255,0,0\n// x\n\n1e300\t0 .5\r\n% x\n7;8;9;10;11;12;13\n";
/* A description with ' for \", and its bytes as a GLB. */
static void fuzz_seed_glb(fuzz_file *s, const char *text, const uint8_t *bytes, size_t size)
{
    size_t const n = (strlen(text) + 3) / 4 * 4;

    fuzz_put_text(s, "glTF");
    fuzz_put_u32(s, 2, 0);
    fuzz_put_u32(s, (uint32_t)(28 + n + size), 0);
    fuzz_put_u32(s, (uint32_t)n, 0);
    fuzz_put_text(s, "JSON");
    for (size_t i = 0; i < n; i++)
        fuzz_put(s, i >= strlen(text) ? " " : text[i] == '\'' ? "\"" : &text[i], 1);
    fuzz_put_u32(s, (uint32_t)size, 0);
    fuzz_put(s, "BIN\0", 4);
    fuzz_put(s, bytes, size);
}

#define FUZZ_ARRAYS                                                                                                    \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},{'bufferView':1,'componentType':5123," \
    "'count':6,'type':'SCALAR'},{'bufferView':0,'componentType':5121,'normalized':true,'count':4,'type':'VEC4'},"      \
    "{'bufferView':0,'componentType':5122,'count':4,'type':'VEC2','sparse':{'count':1,'indices':{'bufferView':1,"      \
    "'componentType':5123},'values':{'bufferView':0}}},{'componentType':5126,'count':4,'type':'VEC3'}],"               \
    "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12}],"

static const char *const fuzz_glb_scene =
    "{'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0,3]}],'nodes':[{'children':[1,2],'scale':[1,-2,1]},{'mesh':0,"
    "'rotation':[0,0,0.6,0.8]},{'mesh':0,'matrix':[1,0,0,0,0,1,0,0,0,0,1,0,1e6,3,4,1]},{'mesh':1,'translation':[1,2,3]}],"
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':0,'TEXCOORD_0':3,'COLOR_0':2},'indices':1,'material':0},"
    "{'attributes':{'POSITION':0,'TEXCOORD_1':3},'mode':5},{'attributes':{'POSITION':0},'mode':6,'targets':[{}]}]},"
    "{'primitives':[{'attributes':{'POSITION':0,'_X':4},'indices':1},{'attributes':{'POSITION':0},'mode':0}]}],"
    "'materials':[{'name':'a','extensions':{'KHR_materials_unlit':{}}}],'textures':[{'source':0}],'extensionsUsed':"
    "['KHR_materials_unlit'],'images':[{'bufferView':0},{'uri':'a%20b.png'}]," FUZZ_ARRAYS
    "'buffers':[{'byteLength':60}]}";
static const char *const fuzz_glb_plain =
    "{'asset':{'version':'2.0'},'nodes':[{'mesh':0}],'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}]," FUZZ_ARRAYS
    "'buffers':[{'byteLength':60}]}";
static const char *const fuzz_gltf_text =
    "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"mesh\":0}],\"meshes\":[{\"primitives\":[{\"attributes\":"
    "{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36,\"uri\":\"data:;base64,"
    "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAgD8AAAAA\"}],\"extras\":[true,null,-1.5e3,\"\\u00e9\\\\\"]}\n";

static const char *const fuzz_model_bodies =
    "<?xml version=\"1.0\"?><model unit=\"inch\"><resources><basematerials id=\"1\"><base name=\"a\" displaycolor=\"#102030\"/>"
    "<base name=\"b\"/></basematerials><object id=\"2\" pid=\"1\" pindex=\"1\"><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/>"
    "<vertex x=\"1\" y=\"0\" z=\"0\" /><vertex z='0' y='1' x='0'/><vertex x=\"0\" y=\"0\" z=\"1e0\"></vertex></vertices><triangles>"
    "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\" p1=\"0\" p2=\"1\"/>"
    "<triangle v1=\"1\" v2=\"2\" v3=\"3\" pid=\"7\" p1=\"0\"/></triangles></mesh></object><object id=\"3\"><components>"
    "<component objectid=\"2\" transform=\"1 0 0 0 1 0 0 0 -1 5 6 7\"/><component objectid=\"2\"/></components></object></resources>"
    "<build><item objectid=\"3\" transform=\"0 1 0 1 0 0 0 0 1 0 0 0\"/><item objectid=\"2\"/></build></model>";
static const char *const fuzz_model_colours =
    "<model requiredextensions=\"m p\"><!-- c --><resources><m:colorgroup id=\"9\"><m:color color=\"#FFaa0080\"/></m:colorgroup>"
    "<object id=\"1\"><mesh><vertices><vertex x=\"-1.5\" y=\".25\" z=\"0\"/>\n<vertex x=\"1\" y=\"0\" z=\"0\"/><vertex x=\"0\" "
    "y=\"9\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/><triangle v1=\"0\" v2=\"2\" v3=\"1\" pid=\"9\" "
    "p1=\"0\"/></triangles></mesh></object></resources><build><item p:path=\"/3D/3dmodel.model\" objectid=\"1\"/></build></model>";

static void fuzz_seed_square(fuzz_file *s, const char *text)
{
    static const float corners[12] = {0, 0, 1, 2, 0, 1, 2, 1, 1, 0, 1, 1};
    static const uint8_t indices[12] = {0, 0, 1, 0, 2, 0, 0, 0, 2, 0, 3, 0};
    fuzz_file bytes;

    bytes.size = 0;
    for (int i = 0; i < 12; i++) fuzz_put_f32(&bytes, corners[i], 0);
    fuzz_put(&bytes, indices, 12);
    fuzz_seed_glb(s, text, bytes.bytes, bytes.size);
}

static const char *const fuzz_words[] = {"<item objectid=\"2\"/>",
                                         "<component objectid=\"2\"/>",
                                         "<vertex x=\"1\" y=\"2\" z=\"nan\"/>",
                                         "<triangle v1=\"0\" v2=\"1\" v3=\"2\"/>",
                                         "<!--",
                                         "\"byteOffset\":",
                                         "\"byteStride\":",
                                         "\"sparse\":{",
                                         "\"count\":",
                                         "\"componentType\":",
                                         "5120",
                                         "5121",
                                         "5125",
                                         "5126",
                                         "\"SCALAR\"",
                                         "\"children\":[0]",
                                         "\"extensionsRequired\":[",
                                         "\"NORMAL\":0",
                                         "{\"mesh\":0},",
                                         "\"uri\":\"data:;base64,",
                                         "[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[[",
                                         "\\u0041",
                                         "1e400",
                                         "4294967295",
                                         "-1",
                                         "nan",
                                         "1e999",
                                         " ",
                                         "\n",
                                         "\\\n",
                                         "0",
                                         "99999999999999999999",
                                         "/",
                                         "list ",
                                         "end_header\n",
                                         "facet ",
                                         "vertex ",
                                         "endloop",
                                         "endfacet",
                                         "outer loop",
                                         "endsolid",
                                         "element face 2\n",
                                         "element tristrips 1\n",
                                         "property char x\n",
                                         "property list uchar uchar vertex_indices\n",
                                         "texcoord",
                                         "binary_big_endian",
                                         "ascii",
                                         "comment ",
                                         "f 1 2 3 4\n",
                                         "vt 0 1\n",
                                         "v 1 2 3\n",
                                         "STOFF ",
                                         "COFF ",
                                         "NOFF ",
                                         "#",
                                         ",",
                                         ";"};

static int fuzz_make_seeds(bvx_context *ctx, fuzz_file *seeds)
{
    fuzz_file *f;
    int n = 0;

    (void)ctx;
    fuzz_seed_stl(fuzz_begin_file(seeds, &n, "stl"));
    fuzz_seed_ply(fuzz_begin_file(seeds, &n, "ply"), 0);
    fuzz_seed_ply(fuzz_begin_file(seeds, &n, "ply"), 1);
    fuzz_seed_text(seeds, &n, "stl", fuzz_stl_text);
    fuzz_seed_text(seeds, &n, "obj", fuzz_obj_text);
    fuzz_seed_text(seeds, &n, "ply", fuzz_ply_text);
    fuzz_seed_text(seeds, &n, "obj", fuzz_obj_coloured);
    fuzz_seed_text(seeds, &n, "ply", fuzz_ply_coloured);
    fuzz_seed_text(seeds, &n, "off", fuzz_off_text);
    fuzz_seed_text(seeds, &n, "off", fuzz_off_coloured);
    fuzz_seed_text(seeds, &n, "xyz", fuzz_xyz_text);
    fuzz_seed_ply(fuzz_begin_file(seeds, &n, "ply_points"), 1);
    fuzz_seed_text(seeds, &n, "ply_points", fuzz_ply_coloured);
    fuzz_seed_square(fuzz_begin_file(seeds, &n, "glb"), fuzz_glb_scene);
    fuzz_seed_square(fuzz_begin_file(seeds, &n, "glb"), fuzz_glb_plain);
    fuzz_seed_text(seeds, &n, "gltf", fuzz_gltf_text);
    fuzz_seed_text(seeds, &n, "3mf_model", fuzz_model_bodies);
    fuzz_seed_text(seeds, &n, "3mf_model", fuzz_model_colours);
    f = fuzz_begin_file(seeds, &n, "3mf");
    f->size = fuzz_pack_model(fuzz_model_bodies, strlen(fuzz_model_bodies), f->bytes);
    return n;
}

static const fuzz_target *fuzz_reader(void)
{
    static const fuzz_target target = {formats,        sizeof formats / sizeof formats[0],
                                       fuzz_words,     sizeof fuzz_words / sizeof fuzz_words[0],
                                       fuzz_read,      NULL,
                                       fuzz_make_seeds};
    return &target;
}
