/* write_3mf.c - a mesh to 3MF: one object in millimeters, in a zip container without packing.
 *
 * Coordinates are the shortest decimals that read back to the same floats, or doubles where the mesh has
 * doubles or a frame. Colours and texture coordinates are left out. The container has the three parts that each
 * reader looks for, with a fixed date, so the same mesh gives the same bytes.
 * Source: 3MF Consortium. 3D Manufacturing Format, Core Specification 1.3; PKWARE. APPNOTE 6.3 (zip). */
#include "io_mesh/mesh_formats.h"

static const char *const zip_names[3] = {"[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"};
static const char *const zip_texts[3] = {
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Types xmlns=\"http://schemas.openxmlformats.org/package/2006/content-types\">"
    "<Default Extension=\"rels\" ContentType=\"application/vnd.openxmlformats-package.relationships+xml\"/>"
    "<Default Extension=\"model\" ContentType=\"application/vnd.ms-package.3dmanufacturing-3dmodel+xml\"/>"
    "</Types>\n",
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">"
    "<Relationship Target=\"/3D/3dmodel.model\" Id=\"rel0\" "
    "Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>\n",
    "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
    "<model unit=\"millimeter\" xml:lang=\"en-US\" "
    "xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\">\n"
    "<resources><object id=\"1\" type=\"model\"><mesh><vertices>\n"};
static const char zip_middle[] = "</vertices><triangles>\n";
static const char zip_last[] =
    "</triangles></mesh></object></resources>\n<build><item objectid=\"1\"/></build></model>\n";

enum { ZIP_LOCAL = 30, ZIP_ENTRY = 46, ZIP_END = 22, ZIP_DATE = 0x21 /* the first day of 1980 */ };

static uint64_t length_of(const char *text)
{
    return (uint64_t)bvxi_text_length(text);
}

/* Directory and record of the end behind the model. */
static uint64_t zip_foot(void)
{
    uint64_t size = ZIP_END;
    for (int i = 0; i < 3; i++) size += ZIP_ENTRY + length_of(zip_names[i]);
    return size;
}

static uint8_t *put_model_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    static const char *const before[3] = {"<vertex x=\"", "\" y=\"", "\" z=\""};
    const bvx_mesh *const mesh = user;
    int const f32 = bvxi_writes_f32(mesh);

    for (uint64_t v = begin; v < end; v++) {
        double p[3];

        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++) {
            memcpy(at, before[a], (size_t)length_of(before[a]));
            at += length_of(before[a]);
            at = f32 ? bvxi_put_float(at, (float)p[a]) : bvxi_put_double(at, p[a]);
        }
        memcpy(at, "\"/>\n", 4);
        at += 4;
    }
    return at;
}

static uint8_t *put_model_triangles(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    static const char *const before[3] = {"<triangle v1=\"", "\" v2=\"", "\" v3=\""};
    const bvx_mesh *const mesh = user;

    for (uint64_t t = begin; t < end; t++) {
        for (size_t k = 0; k < 3; k++) {
            memcpy(at, before[k], (size_t)length_of(before[k]));
            at = bvxi_put_number(at + length_of(before[k]), mesh->triangles[(size_t)t * 3 + k]);
        }
        memcpy(at, "\"/>\n", 4);
        at += 4;
    }
    return at;
}

/* The tags after vertices, and after triangles; what follows those is known when the model is. */
static uint8_t *put_model_text(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    uint64_t const foot = user == zip_last ? zip_foot() : 0;

    (void)begin, (void)end;
    memcpy(at, user, (size_t)length_of(user));
    memset(at + length_of(user), 0, (size_t)foot);
    return at + length_of(user) + foot;
}

/* Heads and directory around the model, of which the text from its first vertex on is there. */
static void put_container(bvx_buffer *file)
{
    uint8_t *const foot = file->bytes + file->size - zip_foot(), *entry = foot, *at = file->bytes;

    for (int i = 0; i < 3; i++) {
        uint64_t const name = length_of(zip_names[i]), known = length_of(zip_texts[i]);
        uint8_t *const text = at + ZIP_LOCAL + name;
        uint32_t const size = (uint32_t)(i < 2 ? known : (uint64_t)(foot - text));

        memcpy(text, zip_texts[i], (size_t)known);
        bvxi_store_u32(at, 0x04034b50);
        /* What local head and directory say of a part, from the version needed on: 26 bytes. */
        memset(at + 4, 0, 26);
        bvxi_store_u16(at + 4, 20);
        bvxi_store_u16(at + 12, ZIP_DATE);
        bvxi_store_u32(at + 14, bvxi_crc32(text, size));
        bvxi_store_u32(at + 18, size);
        bvxi_store_u32(at + 22, size);
        bvxi_store_u16(at + 26, (uint16_t)name);
        memcpy(at + ZIP_LOCAL, zip_names[i], (size_t)name);

        memset(entry, 0, ZIP_ENTRY);
        bvxi_store_u32(entry, 0x02014b50);
        bvxi_store_u16(entry + 4, 20);
        memcpy(entry + 6, at + 4, 26);
        bvxi_store_u32(entry + 42, (uint32_t)(at - file->bytes));
        memcpy(entry + ZIP_ENTRY, zip_names[i], (size_t)name);
        entry += ZIP_ENTRY + name;
        at = text + size;
    }
    bvxi_store_u32(entry, 0x06054b50);
    bvxi_store_u16(entry + 8, 3);
    bvxi_store_u16(entry + 10, 3);
    bvxi_store_u32(entry + 12, (uint32_t)(entry - foot));
    bvxi_store_u32(entry + 16, (uint32_t)(foot - file->bytes));
}

bvx_status bvxi_write_3mf(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    uint64_t const number = bvxi_writes_f32(mesh) ? BVXI_FLOAT_MOST : BVXI_DOUBLE_MOST;
    bvxi_file_part part[4] = {
        {.put = put_model_vertices, .user = mesh, .count = mesh->vertex_count},
        {.put = put_model_text, .user = zip_middle, .count = 1, .most = sizeof zip_middle},
        {.put = put_model_triangles, .user = mesh, .count = mesh->triangle_count},
        {.put = put_model_text, .user = zip_last, .count = 1}};
    bvx_buffer made = {0};
    uint64_t head = 0;

    for (int i = 0; i < 3; i++) head += ZIP_LOCAL + length_of(zip_names[i]) + length_of(zip_texts[i]);
    part[0].most = 25 + 3 * (number + 1);
    part[2].most = 30 + 3 * bvxi_digits(mesh->vertex_count - 1);
    part[3].most = sizeof zip_last + zip_foot();
    BVXI_TRY(bvxi_make_file(ctx, "the 3MF file", 0.0, head, part, 4, &made));
    if (made.size >= UINT32_MAX) {
        bvx_buffer_free(ctx, &made);
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "3MF: the file would have 4 GiB or more; take PLY");
    }
    put_container(&made);
    *file = made;
    return BVX_OK;
}
