/* ply_rows.c - the rows of a PLY file, from text or from bytes of either order: corners, strips,
 * coordinates, colours; and messages for what is wrong with one.
 *
 * Text and bytes give the same calls, so a mesh does not depend on the kind of file. */
#include "io_mesh/ply_file.h"

/* ---- What the values of a row of a PLY file mean: corners, strips, coordinates, colours; and what is
 * wrong with one that cannot be ---- */

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

bvx_status bvxi_ply_fail_end(const ply_file *f, const ply_element *e, uint64_t row)
{
    return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "the file ends (%s %u) inside %s %u of %u", ply_unit(f),
                          ply_place(f, f->source->end),
                          e->kind == PLY_VERTEX   ? "vertex"
                          : e->kind == PLY_FACE   ? "face"
                          : e->kind == PLY_STRIPS ? "strip"
                                                  : "row",
                          row, e->count);
}

bvx_status bvxi_ply_fail_finite(const ply_file *f, const char *at, uint64_t row, int32_t role)
{
    static const char *const names[] = {"coordinate", "colour", "texture coordinate"};
    return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                              "%s %u (%s %u) has a %s that is not finite",
                              role == PLY_ROLE_UVS ? "face" : "vertex", row, ply_unit(f), ply_place(f, at),
                              names[role <= PLY_ROLE_Z       ? 0
                                    : role <= PLY_ROLE_ALPHA ? 1
                                                             : 2]);
}

bvx_status bvxi_ply_fail_corner(const ply_file *f, const char *name, const char *at, uint64_t row,
                                int64_t corner)
{
    return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_INDEX,
                              "%s %u (%s %u) names vertex %d, but there are %u", name, row, ply_unit(f),
                              ply_place(f, at), corner, f->vertex_count);
}

bvx_status bvxi_ply_fail_length(const ply_file *f, const ply_element *e, uint64_t row, int64_t count)
{
    if (e->kind == PLY_FACE && count >= 0)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "face %i (%s %u) has %d corners; it needs three",
                              row, ply_unit(f), ply_place(f, f->p), count);
    return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "row %u (%s %u) of the element in line %u: a list of %d",
                          row, ply_unit(f), ply_place(f, f->p), bvxi_source_line(f->source, e->name), count);
}

/* ---- what values mean ---- */

/* A number of a vertex, or of a list of texture coordinates, that stands at a place. */
static bvx_status ply_put(ply_file *f, const ply_property *property, const char *at, uint64_t row,
                          double value)
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
        /* Floats are shares of 1, 16 bits are brought down to 8, and other integers are taken as bytes. */
        double const full = property->type == PLY_F32 || property->type == PLY_F64 ? 1.0
                            : property->type == PLY_U16                            ? 65535.0
                                                                                   : 255.0;
        mesh->colours[(size_t)row * 4 + (size_t)(role - PLY_ROLE_RED)] = bvxi_colour_byte(value / full);
    } else {
        /* A value that no float can hold would be an infinity in the mesh. */
        if (!(narrow - narrow == 0.0f)) return bvxi_ply_fail_finite(f, at, row, role);
        if (role != PLY_ROLE_UVS) {
            mesh->uvs[(size_t)row * 2 + (size_t)(role - PLY_ROLE_U)] = narrow;
        } else {
            /* Numbers beyond the list are counted all the same:
             * the end of the row says how many there were. */
            uint64_t const i = f->uv_count * 2 + f->uv_numbers++;
            if (f->uvs_at_corners && i < mesh->uv_count * 2) mesh->uvs[i] = narrow;
        }
    }
    return BVX_OK;
}

/* The texture coordinates of a face's corners stand one after the other:
 * its triangles are the same fan of them. */
static bvx_status ply_end_uvs(ply_file *f, uint64_t row, uint64_t triangle)
{
    if (f->uv_numbers == 0) { /* not all faces have them, so none shall */
        bvxi_drop_uvs(f->source->ctx, f->mesh);
        f->uvs_at_corners = 0;
        return BVX_OK;
    }
    if (f->uv_numbers != 2 * f->corners)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT,
                              "face %i (%s %u) has %u corners and %u numbers in texcoord", row, ply_unit(f),
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

static bvx_status ply_end_row(ply_file *f, const ply_element *e, uint64_t row)
{
    if (e->kind != PLY_FACE) return BVX_OK;

    /* The row's triangles are the last ones, so its fan begins that many before the end. */
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

/* ---- The rows of an ASCII PLY file ---- */

/* Values are separated by any space: a row need not be a line. */

static inline bvx_status ply_text_integer(ply_file *f, const char *expected, int64_t *value)
{
    const char *const end = f->source->end, *const at = bvxi_skip_space(f->p, end);
    const char *p = at;
    if (!bvxi_take_integer(&p, end, value) || (p < end && !bvxi_is_space(*p)))
        return bvxi_fail_expected(f->source, at, expected);
    f->p = p;
    return BVX_OK;
}

/* A number of type float, or a coordinate that is one in the mesh, is rounded once. */
static bvx_status ply_text_number(ply_file *f, const ply_property *property, uint64_t row)
{
    const char *const end = f->source->end, *const at = bvxi_skip_space(f->p, end);
    int const is_float = property->role <= PLY_ROLE_Z ? f->mesh->position_type == BVX_F32
                                                      : property->type == PLY_F32;
    float v32 = 0;
    double v = 0;
    /* Reading the text as a float at once avoids the second rounding that a double on the way would bring. */
    size_t const used = is_float ? bvxi_parse_float(at, end, &v32) : bvxi_parse_double(at, end, &v);

    f->p = at + used;
    if (used == 0 || (f->p < end && !bvxi_is_space(*f->p)))
        return bvxi_fail_expected(f->source, at, property->role <= PLY_ROLE_Z ? "a coordinate" : "a number");
    return ply_put(f, property, at, row, is_float ? (double)v32 : v);
}

static bvx_status ply_take_text_row(ply_file *f, const ply_element *e, uint64_t row)
{
    const char *const end = f->source->end;
    bvxi_ply_begin_row(f);
    for (uint32_t i = e->first; i < e->end; i++) {
        const ply_property *const property = &f->header->properties[i];
        int64_t count = 1;
        /* A row is read value by value: what is not wanted
         * must be stepped over, as lists have no known length. */
        if (property->count_type != PLY_NONE) BVXI_TRY(ply_text_integer(f, "the length of a list", &count));
        if (property->count_type != PLY_NONE && count < bvxi_ply_least_length(property))
            return bvxi_ply_fail_length(f, e, row, count);
        for (int64_t k = 0; k < count; k++) {
            int64_t corner = 0;
            if (property->role == PLY_ROLE_CORNERS || property->role == PLY_ROLE_STRIP) {
                BVXI_TRY(ply_text_integer(f, "a vertex index", &corner));
                BVXI_TRY(bvxi_ply_take_corner(f, property, f->p, row, corner));
            } else if (property->role != PLY_ROLE_NONE) {
                BVXI_TRY(ply_text_number(f, property, row));
            } else {
                f->p = bvxi_skip_space(f->p, end);
                if (f->p == end) return bvxi_ply_fail_end(f, e, row);
                f->p = bvxi_skip_word(f->p, end);
            }
        }
    }
    return ply_end_row(f, e, row);
}

bvx_status bvxi_ply_take_text(ply_file *f, const ply_element *e)
{
    for (uint64_t row = 0; row < e->count && e->end > e->first; row++) {
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        BVXI_TRY(ply_take_text_row(f, e, row));
    }
    return BVX_OK;
}

/* ---- The rows of a binary PLY file, in either byte order ---- */

/* ply_take_row goes property by property and is the specification. Rows of the commonest shapes have loops of
 * their own: vertices of one size with floats x y z and bytes red green blue side by side, and faces that are
 * one list of three 32-bit corners. */

/* rows of vertices that stay near while their properties are taken one after the other */
enum { PLY_BLOCK = 2048 };

static int64_t ply_integer(const uint8_t *p, int32_t type, int big)
{
    switch (type) {
    case PLY_I8: return (int64_t)p[0] - (p[0] > INT8_MAX ? 256 : 0);
    case PLY_U8: return p[0];
    case PLY_I16: return (int64_t)bvxi_load_u16(p, big) - (bvxi_load_u16(p, big) > INT16_MAX ? 65536 : 0);
    case PLY_U16: return bvxi_load_u16(p, big);
    case PLY_I32:
        return (int64_t)bvxi_load_u32(p, big) - (bvxi_load_u32(p, big) > INT32_MAX ? INT64_C(4294967296) : 0);
    default: return bvxi_load_u32(p, big);
    }
}

static double ply_number(const uint8_t *p, int32_t type, int big)
{
    if (type == PLY_F32) return (double)bvxi_load_f32(p, big);
    return type == PLY_F64 ? bvxi_load_f64(p, big) : (double)ply_integer(p, type, big);
}

static int ply_has(const ply_file *f, uint64_t bytes)
{
    return bytes <= (uint64_t)(f->source->end - f->p);
}

/* count values of a wanted property, whose bytes are there. */
static bvx_status ply_take_items(ply_file *f, const ply_property *property, uint64_t row, int64_t count)
{
    size_t const size = ply_type_size(property->type);
    int const is_corners = property->role == PLY_ROLE_CORNERS || property->role == PLY_ROLE_STRIP;
    const char *at = f->p;

    /* What to do with a value depends on its property only,
     * and its size is known: the end was checked before. */
    for (int64_t i = 0; i < count; i++, at += size) {
        const uint8_t *const p = (const uint8_t *)at;
        if (is_corners)
            BVXI_TRY(bvxi_ply_take_corner(f, property, at, row, ply_integer(p, property->type, f->big)));
        else BVXI_TRY(ply_put(f, property, at, row, ply_number(p, property->type, f->big)));
    }
    return BVX_OK;
}

static bvx_status ply_take_row(ply_file *f, const ply_element *e, uint64_t row)
{
    bvxi_ply_begin_row(f);
    for (uint32_t i = e->first; i < e->end; i++) {
        const ply_property *const property = &f->header->properties[i];
        size_t const size = ply_type_size(property->type);
        int64_t count = 1;

        /* The length comes from the file, so the bytes that it promises are checked before one is read. */
        if (property->count_type != PLY_NONE) {
            size_t const count_size = ply_type_size(property->count_type);
            if (!ply_has(f, count_size)) return bvxi_ply_fail_end(f, e, row);
            count = ply_integer((const uint8_t *)f->p, property->count_type, f->big);
            f->p += count_size;
            if (count < bvxi_ply_least_length(property)) return bvxi_ply_fail_length(f, e, row, count);
        }
        if (!ply_has(f, (uint64_t)count * size)) return bvxi_ply_fail_end(f, e, row);
        if (property->role != PLY_ROLE_NONE) BVXI_TRY(ply_take_items(f, property, row, count));
        f->p += (size_t)count * size;
    }
    return ply_end_row(f, e, row);
}

/* ---- vertices without lists: rows of one size ---- */

/* Properties from the given one on that have these roles and this type, one after the other. */
static int ply_is_run(const ply_header *h, const ply_element *e, uint32_t first, int32_t role, uint32_t count,
                      int32_t type)
{
    for (uint32_t i = 0; i < count; i++) {
        const ply_property *const p = &h->properties[first + i];
        if (first + i >= e->end || p->role != role + (int32_t)i || p->type != type) return 0;
    }
    return 1;
}

/* x, y, z as floats side by side, of rows from the given one on. */
static bvx_status ply_take_floats(ply_file *f, const ply_element *e, const uint8_t *p, uint64_t row,
                                  uint64_t count)
{
    size_t const size = (size_t)e->least_bytes;
    float *out = (float *)f->mesh->positions + (size_t)row * 3;

    for (uint64_t i = 0; i < count; i++, p += size, out += 3) {
        out[0] = bvxi_load_f32(p, f->big);
        out[1] = bvxi_load_f32(p + 4, f->big);
        out[2] = bvxi_load_f32(p + 8, f->big);

        /* An infinity or a NaN times 0 is NaN: one sum tests all three coordinates. */
        float const sum = out[0] * 0.0f + out[1] * 0.0f + out[2] * 0.0f;
        if (!(sum == 0.0f) && !f->source->takes_any)
            return bvxi_ply_fail_finite(f, (const char *)p, row + i, PLY_ROLE_X);
    }
    return BVX_OK;
}

/* Property number i, and those after it that are taken with it, of some rows; *taken is how many
 * properties. */
static bvx_status ply_take_column(ply_file *f, const ply_element *e, uint32_t i, const uint8_t *p,
                                  uint64_t row, uint64_t count, uint32_t *taken)
{
    const ply_header *const h = f->header;
    const ply_property *const property = &h->properties[i];

    *taken = 3;
    /* Positions in doubles take the general loop below, which widens each value. */
    if (ply_is_run(h, e, i, PLY_ROLE_X, 3, PLY_F32) && f->mesh->position_type == BVX_F32)
        return ply_take_floats(f, e, p, row, count);
    if (ply_is_run(h, e, i, PLY_ROLE_RED, 3, PLY_U8)) {
        int const alpha = ply_is_run(h, e, i, PLY_ROLE_RED, 4, PLY_U8);
        /* Red, green, blue as bytes side by side; perhaps with alpha. */
        uint8_t *out = f->mesh->colours + (size_t)row * 4;
        for (uint64_t k = 0; k < count; k++, p += e->least_bytes, out += 4) {
            out[0] = p[0];
            out[1] = p[1];
            out[2] = p[2];
            if (alpha) out[3] = p[3];
        }
        *taken += alpha ? 1 : 0;
        return BVX_OK;
    }
    *taken = 1;
    for (uint64_t k = 0; k < count && property->role != PLY_ROLE_NONE; k++, p += e->least_bytes)
        BVXI_TRY(ply_put(f, property, (const char *)p, row + k, ply_number(p, property->type, f->big)));
    return BVX_OK;
}

/* ---- faces ---- */

/* Faces that are one list of 32-bit corners with a length of one byte; what
 * is not a triangle takes the long way. */
static bvx_status ply_take_simple_faces(ply_file *f, const ply_element *e)
{
    for (uint64_t row = 0; row < e->count; row++) {
        const uint8_t *const p = (const uint8_t *)f->p;
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        /* 13 bytes: the length and three corners. A corner
         * out of range goes the long way, which reports it. */
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

bvx_status bvxi_ply_take_binary(ply_file *f, const ply_element *e)
{
    /* the header's check found the bytes, unless lists took more */
    if (e->kind == PLY_OTHER && e->lists == 0) {
        if (!ply_has(f, e->count * e->least_bytes)) return bvxi_ply_fail_end(f, e, 0);
        f->p += (size_t)(e->count * e->least_bytes);
        return BVX_OK;
    }

    if (e->kind == PLY_VERTEX && e->lists == 0) {
        for (uint64_t row = 0; row < e->count; row += PLY_BLOCK) {
            uint64_t const count = e->count - row < PLY_BLOCK ? e->count - row : PLY_BLOCK;
            const uint8_t *p = (const uint8_t *)f->p;

            /* The rows have one size, so one comparison covers the
             * block; a short file is reported with the row it ends in. */
            BVXI_TRY(bvxi_source_at(f->source, f->p));
            if (!ply_has(f, count * e->least_bytes))
                return bvxi_ply_fail_end(f, e, row + (uint64_t)(f->source->end - f->p) / e->least_bytes);
            /* Column by column: each loop has one type and no
             * decision in it, while the block stays in the cache. */
            for (uint32_t i = e->first, taken; i < e->end; i += taken) {
                BVXI_TRY(ply_take_column(f, e, i, p, row, count, &taken));
                for (uint32_t k = 0; k < taken; k++) p += ply_type_size(f->header->properties[i + k].type);
            }
            f->p += (size_t)(count * e->least_bytes);
        }
        return BVX_OK;
    }

    /* Corners of type int are below 2^31, so those above the vertices are
     * refused also when there are more of these. */
    const ply_property *const list = &f->header->properties[e->first];
    if (e->kind == PLY_FACE && e->end == e->first + 1 && list->role == PLY_ROLE_CORNERS &&
        list->count_type == PLY_U8 &&
        (list->type == PLY_U32 || (list->type == PLY_I32 && f->vertex_count <= INT32_MAX)))
        return ply_take_simple_faces(f, e);
    for (uint64_t row = 0; row < e->count && e->end > e->first; row++) {
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        BVXI_TRY(ply_take_row(f, e, row));
    }
    return BVX_OK;
}
