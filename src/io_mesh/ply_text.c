/* ply_text.c - the rows of an ASCII PLY file. Values are separated by any space: a row need not be a line. */
#include "io_mesh/ply_file.h"

static inline bvx_status ply_text_integer(ply_file *f, const char *expected, int64_t *value)
{
    const char *const end = f->source->end, *const at = bvxi_skip_space(f->p, end);
    const char *p = at;
    if (!bvxi_take_integer(&p, end, value) || (p < end && !bvxi_is_space(*p)))
        return bvxi_fail_expected(f->source, at, expected);
    f->p = p;
    return BVX_OK;
}

static bvx_status ply_text_corners(ply_file *f, const ply_property *property, uint64_t row, int64_t count)
{
    int64_t corner = 0;
    for (int64_t i = 0; i < count; i++) {
        BVXI_TRY(ply_text_integer(f, "a vertex index", &corner));
        BVXI_TRY(bvxi_ply_take_corner(f, property, f->p, row, corner));
    }
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
    return bvxi_ply_put(f, property, at, row, is_float ? (double)v32 : v);
}

static bvx_status ply_text_numbers(ply_file *f, const ply_property *property, uint64_t row, int64_t count)
{
    for (int64_t i = 0; i < count; i++) BVXI_TRY(ply_text_number(f, property, row));
    return BVX_OK;
}

static bvx_status ply_text_skip(ply_file *f, const ply_element *e, uint64_t row, int64_t count)
{
    const char *const end = f->source->end;
    for (int64_t i = 0; i < count; i++) {
        f->p = bvxi_skip_space(f->p, end);
        if (f->p == end) return bvxi_ply_fail_end(f, e, row);
        f->p = bvxi_skip_word(f->p, end);
    }
    return BVX_OK;
}

bvx_status bvxi_ply_take_text(ply_file *f, const ply_element *e)
{
    for (uint64_t row = 0; row < e->count && e->end > e->first; row++) {
        BVXI_TRY(bvxi_source_at(f->source, f->p));
        bvxi_ply_begin_row(f);
        for (uint32_t i = e->first; i < e->end; i++) {
            const ply_property *const property = &f->header->properties[i];
            int64_t count = 1;
            /* A row is read value by value: what is not wanted
             * must be stepped over, as lists have no known length. */
            if (property->count_type != PLY_NONE)
                BVXI_TRY(ply_text_integer(f, "the length of a list", &count));
            if (property->count_type != PLY_NONE && count < bvxi_ply_least_length(property))
                return bvxi_ply_fail_length(f, e, row, count);
            if (property->role == PLY_ROLE_CORNERS || property->role == PLY_ROLE_STRIP)
                BVXI_TRY(ply_text_corners(f, property, row, count));
            else if (property->role != PLY_ROLE_NONE) BVXI_TRY(ply_text_numbers(f, property, row, count));
            else BVXI_TRY(ply_text_skip(f, e, row, count));
        }
        BVXI_TRY(bvxi_ply_end_row(f, e, row));
    }
    return BVX_OK;
}
