/* read_ply.c - PLY, ASCII and binary in both byte orders, to an indexed mesh.
 *
 * Source: Turk. The PLY Polygon File Format. 1994.
 * The header (ply_header.c) tells where coordinates and corners stand in a row; everything else is stepped over. Values
 * of a text are separated by any space. Rows of the commonest shapes, floats in a fixed place and a list of three
 * 32-bit corners, have loops of their own; the loops over properties are the specification.
 * Triangles are as many as faces in nearly every file, so that is the room made first. Faces of more corners become
 * fans, are counted on, and when there were any the faces are read once more into exact room.
 * Memory: the mesh alone (in files with larger faces, first a smaller one). Cost: O(bytes). */
#include "io/ply_header.h"

typedef struct ply_file {
    bvxi_source *source;
    const ply_header *header;
    bvx_mesh *mesh;
    const char *p;           /* reading is here */
    uint64_t vertex_count;
    uint64_t triangle_count; /* found so far; those beyond the mesh's room are only counted */
    uint64_t room;
    int32_t big;             /* byte order of a binary file */
} ply_file;

/* ---- failures: each says where, by the line of a text or the byte of a binary file ---- */

static const char *ply_unit(const ply_file *f)
{
    return f->header->encoding == PLY_ASCII ? "line" : "byte";
}

static uint64_t ply_place(const ply_file *f, const char *at)
{
    return f->header->encoding == PLY_ASCII ? bvxi_source_line(f->source, at) : bvxi_source_byte(f->source, at);
}

static BVXI_COLD bvx_status ply_fail_end(const ply_file *f, const ply_element *e, uint64_t row)
{
    const char *const name = e->kind == PLY_VERTEX ? "vertex" : e->kind == PLY_FACE ? "face" : "row";
    return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT, "PLY: the file ends (%s %u) inside %s %u of %u", ply_unit(f),
                     ply_place(f, f->source->end), name, row, e->count);
}

static BVXI_COLD bvx_status ply_fail_finite(const ply_file *f, const char *at, uint64_t row)
{
    return bvxi_fail(f->source->ctx, BVX_ERR_RANGE, "PLY: vertex %u (%s %u) has a coordinate that is not finite", row,
                     ply_unit(f), ply_place(f, at));
}

static BVXI_COLD bvx_status ply_fail_corner(const ply_file *f, const char *at, uint64_t row, int64_t corner)
{
    return bvxi_fail(f->source->ctx, BVX_ERR_RANGE, "PLY: face %u (%s %u) names vertex %d, but there are %u", row,
                     ply_unit(f), ply_place(f, at), corner, f->vertex_count);
}

static BVXI_COLD bvx_status ply_fail_length(const ply_file *f, const ply_element *e, uint64_t row, int64_t count)
{
    if (e->kind == PLY_FACE && count >= 0)
        return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT, "PLY: face %u (%s %u) has %d corners; it needs three", row,
                         ply_unit(f), ply_place(f, f->p), count);
    return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT, "PLY: row %u (%s %u) of the element in line %u: a list of %d", row,
                     ply_unit(f), ply_place(f, f->p), bvxi_source_line(f->source, e->name), count);
}

/* ---- values ---- */

static int64_t ply_integer(const uint8_t *p, int32_t type, int big)
{
    switch (type) {
    case PLY_I8: return (int64_t)p[0] - (p[0] > INT8_MAX ? 256 : 0);
    case PLY_U8: return p[0];
    case PLY_I16: return (int64_t)bvxi_load_u16(p, big) - (bvxi_load_u16(p, big) > INT16_MAX ? 65536 : 0);
    case PLY_U16: return bvxi_load_u16(p, big);
    case PLY_I32: return (int64_t)bvxi_load_u32(p, big) - (bvxi_load_u32(p, big) > INT32_MAX ? INT64_C(4294967296) : 0);
    default: return bvxi_load_u32(p, big);
    }
}

static double ply_number(const uint8_t *p, int32_t type, int big)
{
    if (type == PLY_F32) return (double)bvxi_load_f32(p, big);
    return type == PLY_F64 ? bvxi_load_f64(p, big) : (double)ply_integer(p, type, big);
}

static void ply_put_coordinate(const ply_file *f, uint64_t row, int32_t axis, double value)
{
    size_t const i = (size_t)row * 3 + (size_t)axis;
    if (f->mesh->position_type == BVX_F32) ((float *)f->mesh->positions)[i] = (float)value;
    else ((double *)f->mesh->positions)[i] = value;
}

/* A face has three corners or more; other lists may be empty. */
static int64_t ply_least_length(const ply_property *property)
{
    return property->role == PLY_ROLE_CORNERS ? 3 : 0;
}

/* One more corner of a face: from the third on, each closes a triangle of the fan. */
static inline void ply_add_corner(ply_file *f, uint64_t number, uint32_t fan[2], uint32_t corner)
{
    if (number == 0) fan[0] = corner;
    if (number >= 2) {
        if (f->triangle_count < f->room) {
            uint32_t *const t = f->mesh->triangles + (size_t)f->triangle_count * 3;
            t[0] = fan[0];
            t[1] = fan[1];
            t[2] = corner;
        }
        f->triangle_count++;
    }
    fan[1] = corner;
}

/* ---- binary ---- */

static int ply_has(const ply_file *f, uint64_t bytes)
{
    return bytes <= (uint64_t)(f->source->end - f->p);
}

/* The corners of a face in the file, count of them, whose bytes are there. */
static bvx_status ply_take_corners(ply_file *f, const ply_property *property, uint64_t row, int64_t count)
{
    size_t const size = ply_type_size(property->type);
    uint32_t fan[2] = {0, 0};
    const uint8_t *p = (const uint8_t *)f->p;
    for (uint64_t i = 0; i < (uint64_t)count; i++, p += size) {
        int64_t const corner = ply_integer(p, property->type, f->big);
        if (corner < 0 || (uint64_t)corner >= f->vertex_count)
            return ply_fail_corner(f, (const char *)p, row, corner);
        ply_add_corner(f, i, fan, (uint32_t)corner);
    }
    return BVX_OK;
}

/* One row, property by property: the specification for binary files. */
static bvx_status ply_take_row(ply_file *f, const ply_element *e, uint64_t row)
{
    for (uint32_t i = e->first; i < e->end; i++) {
        const ply_property *const property = &f->header->properties[i];
        size_t const size = ply_type_size(property->type);
        int64_t count = 1;
        if (property->count_type != PLY_NONE) {
            size_t const count_size = ply_type_size(property->count_type);
            if (!ply_has(f, count_size)) return ply_fail_end(f, e, row);
            count = ply_integer((const uint8_t *)f->p, property->count_type, f->big);
            f->p += count_size;
            if (count < ply_least_length(property)) return ply_fail_length(f, e, row, count);
        }
        if (!ply_has(f, (uint64_t)count * size)) return ply_fail_end(f, e, row);
        if (property->role == PLY_ROLE_CORNERS) {
            BVXI_TRY(ply_take_corners(f, property, row, count));
        } else if (property->role != PLY_ROLE_NONE) {
            double const v = ply_number((const uint8_t *)f->p, property->type, f->big);
            if (!(v - v == 0.0)) return ply_fail_finite(f, f->p, row);
            ply_put_coordinate(f, row, property->role, v);
        }
        f->p += (size_t)count * size;
    }
    return BVX_OK;
}

static bvx_status ply_take_rows(ply_file *f, const ply_element *e)
{
    if (e->kind == PLY_OTHER && e->lists == 0) { /* the header's check found the bytes, unless lists took more */
        if (!ply_has(f, e->count * e->least_bytes)) return ply_fail_end(f, e, 0);
        f->p += (size_t)(e->count * e->least_bytes);
        return BVX_OK;
    }
    for (uint64_t row = 0; row < e->count; row++) {
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        BVXI_TRY(ply_take_row(f, e, row));
    }
    return BVX_OK;
}

/* Vertices whose x, y, z are floats that stand side by side, in rows of one size. */
static bvx_status ply_take_float_vertices(ply_file *f, const ply_element *e, size_t offset)
{
    size_t const size = (size_t)e->least_bytes;
    float *out = f->mesh->positions;
    if (!ply_has(f, e->count * e->least_bytes)) return ply_fail_end(f, e, (uint64_t)(f->source->end - f->p) / size);
    for (uint64_t row = 0; row < e->count; row++, out += 3) {
        const uint8_t *const p = (const uint8_t *)f->p + offset;
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        out[0] = bvxi_load_f32(p, f->big);
        out[1] = bvxi_load_f32(p + 4, f->big);
        out[2] = bvxi_load_f32(p + 8, f->big);
        float const sum = out[0] * 0.0f + out[1] * 0.0f + out[2] * 0.0f;
        if (!(sum == 0.0f)) return ply_fail_finite(f, f->p, row);
        f->p += size;
    }
    return BVX_OK;
}

/* 1 when the rows are such, with the bytes before x in *offset. */
static int ply_is_float_vertices(const ply_header *h, const ply_element *e, size_t *offset)
{
    *offset = 0;
    if (e->kind != PLY_VERTEX || e->lists != 0) return 0;
    for (uint32_t i = e->first; i + 2 < e->end; i++) {
        const ply_property *const p = &h->properties[i];
        if (p[0].role == PLY_ROLE_X && p[1].role == PLY_ROLE_Y && p[2].role == PLY_ROLE_Z)
            return p[0].type == PLY_F32 && p[1].type == PLY_F32 && p[2].type == PLY_F32;
        *offset += ply_type_size(p->type);
    }
    return 0;
}

/* Faces that are one list of 32-bit corners with a length of one byte; what is not a triangle takes the long way. */
static bvx_status ply_take_simple_faces(ply_file *f, const ply_element *e)
{
    for (uint64_t row = 0; row < e->count; row++) {
        const uint8_t *const p = (const uint8_t *)f->p;
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        if (ply_has(f, 13) && p[0] == 3 && f->triangle_count < f->room) {
            uint32_t *const t = f->mesh->triangles + (size_t)f->triangle_count * 3;
            t[0] = bvxi_load_u32(p + 1, f->big);
            t[1] = bvxi_load_u32(p + 5, f->big);
            t[2] = bvxi_load_u32(p + 9, f->big);
            if (t[0] < f->vertex_count && t[1] < f->vertex_count && t[2] < f->vertex_count) {
                f->triangle_count++;
                f->p += 13;
                continue;
            }
        }
        BVXI_TRY(ply_take_row(f, e, row));
    }
    return BVX_OK;
}

/* Corners of type int are below 2^31, so those above the vertices are refused also when there are more of these. */
static int ply_is_simple_faces(const ply_file *f, const ply_element *e)
{
    const ply_property *const p = &f->header->properties[e->first];
    return e->kind == PLY_FACE && e->end == e->first + 1 && p->role == PLY_ROLE_CORNERS && p->count_type == PLY_U8 &&
           (p->type == PLY_U32 || (p->type == PLY_I32 && f->vertex_count <= INT32_MAX));
}

static bvx_status ply_take_binary(ply_file *f, const ply_element *e)
{
    size_t offset;
    if (ply_is_float_vertices(f->header, e, &offset)) return ply_take_float_vertices(f, e, offset);
    if (ply_is_simple_faces(f, e)) return ply_take_simple_faces(f, e);
    return ply_take_rows(f, e);
}

/* ---- ASCII ---- */

static bvx_status ply_text_integer(ply_file *f, const char *expected, int64_t *value)
{
    const char *const end = f->source->end, *const at = bvxi_skip_space(f->p, end);
    const char *p = at;
    int const negative = p < end && *p == '-';
    int64_t v = 0;
    p += negative || (p < end && *p == '+');
    const char *const digits = p;
    for (; p < end && *p >= '0' && *p <= '9'; p++)
        if (v < INT64_C(100000000000000000)) v = v * 10 + (*p - '0');
    if (p == digits || (p < end && !bvxi_is_space(*p))) return bvxi_fail_expected(f->source, at, expected);
    *value = negative ? -v : v;
    f->p = p;
    return BVX_OK;
}

static bvx_status ply_text_coordinate(ply_file *f, uint64_t row, int32_t axis)
{
    const char *const end = f->source->end, *const at = bvxi_skip_space(f->p, end);
    int const is_float = f->mesh->position_type == BVX_F32;
    float v32 = 0;
    double v = 0;
    size_t const used = is_float ? bvxi_parse_float(at, end, &v32) : bvxi_parse_double(at, end, &v);
    f->p = at + used;
    if (used == 0 || (f->p < end && !bvxi_is_space(*f->p))) return bvxi_fail_expected(f->source, at, "a coordinate");
    if (is_float) v = (double)v32;
    if (!(v - v == 0.0)) return ply_fail_finite(f, at, row);
    ply_put_coordinate(f, row, axis, v);
    return BVX_OK;
}

static bvx_status ply_text_corners(ply_file *f, uint64_t row, int64_t count)
{
    uint32_t fan[2] = {0, 0};
    int64_t corner;
    for (uint64_t i = 0; i < (uint64_t)count; i++) {
        BVXI_TRY(ply_text_integer(f, "a vertex number", &corner));
        if (corner < 0 || (uint64_t)corner >= f->vertex_count) return ply_fail_corner(f, f->p, row, corner);
        ply_add_corner(f, i, fan, (uint32_t)corner);
    }
    return BVX_OK;
}

static bvx_status ply_text_skip(ply_file *f, const ply_element *e, uint64_t row, int64_t count)
{
    const char *const end = f->source->end;
    for (int64_t i = 0; i < count; i++) {
        f->p = bvxi_skip_space(f->p, end);
        if (f->p == end) return ply_fail_end(f, e, row);
        f->p = bvxi_skip_word(f->p, end);
    }
    return BVX_OK;
}

static bvx_status ply_take_text(ply_file *f, const ply_element *e)
{
    for (uint64_t row = 0; row < e->count && e->end > e->first; row++) {
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        for (uint32_t i = e->first; i < e->end; i++) {
            const ply_property *const property = &f->header->properties[i];
            int64_t count = 1;
            if (property->count_type != PLY_NONE) BVXI_TRY(ply_text_integer(f, "the length of a list", &count));
            if (property->count_type != PLY_NONE && count < ply_least_length(property))
                return ply_fail_length(f, e, row, count);
            if (property->role == PLY_ROLE_CORNERS) BVXI_TRY(ply_text_corners(f, row, count));
            else if (property->role != PLY_ROLE_NONE) BVXI_TRY(ply_text_coordinate(f, row, property->role));
            else BVXI_TRY(ply_text_skip(f, e, row, count));
        }
    }
    return BVX_OK;
}

/* ---- both ---- */

static bvx_status ply_take_element_rows(ply_file *f, const ply_element *e)
{
    return f->header->encoding == PLY_ASCII ? ply_take_text(f, e) : ply_take_binary(f, e);
}

static bvx_status ply_make_room(ply_file *f, uint64_t triangles)
{
    bvx_context *const ctx = f->source->ctx;
    if (triangles > INT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "PLY: the file has %u triangles, the limit is below 2^31", triangles);
    bvxi_free(ctx, f->mesh->triangles, f->mesh->triangle_capacity * 12);
    f->mesh->triangles = NULL;
    f->mesh->triangle_count = f->mesh->triangle_capacity = 0;
    BVXI_TRY(bvxi_make_triangles(ctx, f->mesh, triangles));
    f->room = triangles;
    f->triangle_count = 0;
    return BVX_OK;
}

static bvx_status ply_take_faces(ply_file *f, const ply_element *e)
{
    const char *const start = f->p;
    BVXI_TRY(ply_take_element_rows(f, e));
    if (f->triangle_count == f->room) return BVX_OK;
    BVXI_TRY(ply_make_room(f, f->triangle_count));
    f->p = start;
    bvxi_source_pass(f->source, 0, 1);
    return ply_take_element_rows(f, e);
}

/* Rows of all elements up to the last that is wanted. */
static bvx_status ply_take_data(ply_file *f)
{
    const ply_header *const h = f->header;
    const ply_element *const last = h->vertex > h->face ? h->vertex : h->face;
    for (const ply_element *e = h->elements; e <= last; e++)
        BVXI_TRY(e == h->face ? ply_take_faces(f, e) : ply_take_element_rows(f, e));
    return BVX_OK;
}

bvx_status bvxi_read_ply(bvxi_source *source, bvx_mesh *mesh)
{
    ply_header header = {0};
    ply_file f = {0};
    bvx_status status = bvxi_ply_header_read(source, &header);
    if (status == BVX_OK) {
        f.source = source;
        f.header = &header;
        f.mesh = mesh;
        f.p = header.data;
        f.big = header.encoding == PLY_BIG;
        f.vertex_count = header.vertex->count;
        status = bvxi_make_positions(source->ctx, mesh, header.position_type, f.vertex_count);
        if (status == BVX_OK) status = ply_make_room(&f, header.face->count);
        if (status == BVX_OK) status = ply_take_data(&f);
    }
    bvxi_ply_header_free(source->ctx, &header);
    return status;
}
