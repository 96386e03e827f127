/* ply_rows.c - what the values of a row of a PLY file mean: corners, strips, coordinates, colours; and what
 * is wrong with one that cannot be. */
#include "io_mesh/ply_file.h"

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
    return bvxi_fail_for(f->source->ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                         "PLY: %s %u (%s %u) names vertex %d, but there are %u", name, row, ply_unit(f),
                         ply_place(f, at), corner, f->vertex_count);
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
    /* Floats are for colours and texture coordinates too; doubles stay what they are. */
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
        return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT,
                         "PLY: face %i (%s %u) has %u corners and %u numbers in texcoord", row, ply_unit(f),
                         ply_place(f, f->p), f->corners, f->uv_numbers);

    /* The same fan as that of the corners: first, previous, this one. */
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
