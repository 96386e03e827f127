/* sign_normal.c - inside by the plane of the closest triangle, in the band and beyond it.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013. Where an edge or a corner
 * is closest, several triangles are at one distance and the one of least number decides, whose plane may have
 * the centre on its wrong side. It is the paper's rule; those of the solid mend that.
 *
 * In the band a centre's own closest triangle decides. Beyond it signs are carried on (carry_signs.c), which
 * depends on all of the lattice; so where a window has centres beyond the band, the band of the whole lattice
 * is made, and the window holds its bits. A band of less than a voxel may have the surface at its very end,
 * so one of a voxel is made for the signs too. A lattice without any band lies on one side of the mesh, that
 * of its first centre. */
#include "field/room.h"
#include "field/signs.h"
#include "nearest/closest.h"
#include "mesh/facet.h"
#include "core/vec3.h"

/* ---- On which side of its closest triangle a centre lies ---- */

/* The closest point of the triangle is computed once more, in doubles, whatever type the field's values have;
 * a centre is inside when the normal points away from it. Square to the normal, or where the triangle has no
 * area, it is outside. A centre on the surface counts as moved by (e_x, e_y, e_z), e_x >> e_y >> e_z > 0, as
 * by the solid's rules. */

enum { SIDE_GRAIN = 1 << 10 /* values of the smallest task, about */ };

typedef struct side_job {
    const bvx_mesh_view *mesh;
    const bvxi_sparse *band;
    bvx_grid *inside;
    double scale;   /* power of two that brings mesh and window into [-1, 1] */
    double of_mesh; /* the same for the mesh alone, so that a normal's products neither vanish nor overflow */
} side_job;

static int is_rounding(double v)
{
    return v < 0x1p-40 && v > -0x1p-40;
}

static int side_of(const side_job *job, int32_t x, int32_t y, int32_t z, uint64_t value)
{
    uint32_t const triangle = job->band->triangles[value];
    double p[3], t[3][3], q[3], away[3], outwards[3];

    bvxi_field_centre(&job->band->where, x, y, z, p);
    for (int k = 0; k < 3; k++) p[k] *= job->scale;
    bvxi_view_scaled(job->mesh, triangle, job->scale, t);
    bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
    for (int a = 0; a < 3; a++) away[a] = p[a] - q[a];
    bvxi_view_scaled(job->mesh, triangle, job->of_mesh, t);
    bvxi_facet_cross((const double(*)[3])t, outwards);

    double const along = bvxi_vec_dot(outwards, away);
    /* On the surface, as far as doubles know: the side that the moved centre lies on decides. */
    if (along != 0.0 || !is_rounding(away[0]) || !is_rounding(away[1]) || !is_rounding(away[2]))
        return along < 0.0;
    if (outwards[0] != 0.0) return outwards[0] < 0.0;
    return outwards[1] != 0.0 ? outwards[1] < 0.0 : outwards[2] < 0.0;
}

static void decide_sides(void *user, uint64_t row, uint64_t end)
{
    const side_job *const job = user;
    const bvx_grid *const g = &job->band->where;

    for (; row < end; row++) {
        uint64_t const at = row * (uint64_t)g->words_per_row;
        int32_t const y = (int32_t)(row % (uint64_t)g->size[1]), z = (int32_t)(row / (uint64_t)g->size[1]);
        uint64_t value = job->band->first[row];
        for (int32_t k = 0; k < g->words_per_row; k++) {
            uint64_t set = 0;
            for (uint64_t left = g->words[at + (uint64_t)k]; left != 0; left &= left - 1, value++) {
                int32_t const bit = bvxi_lowest(left);
                if (side_of(job, k * BVXI_WORD_BITS + bit, y, z, value)) set |= UINT64_C(1) << bit;
            }
            job->inside->words[at + (uint64_t)k] = set;
        }
    }
}

static bvx_status sign_band(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                            bvx_grid *inside)
{
    uint64_t const rows = bvxi_grid_rows(&band->where), each = band->count / rows;
    side_job job = {.mesh = mesh, .band = band, .inside = inside};
    double low[3], high[3];
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    job.scale = bvxi_field_scale(&band->where, low, high);
    job.of_mesh = bvxi_unit_scale(low, high);
    return BVXI_SHARE(call.ctx, call.from, call.to,
                      bvxi_for(call.ctx, call.stage, rows, 1 + SIDE_GRAIN / (1 + each), decide_sides, &job));
}

/* ---- Beyond the band ---- */

/* All of inside's window as the first centre of the lattice. */
static bvx_status sign_by_first_centre(bvxi_call call, const bvxi_nearest *nearest, const bvx_mesh_view *mesh,
                                       bvx_grid *inside)
{
    bvxi_call const at_once = bvxi_call_part(call, call.from, call.from);
    uint64_t word = 1, set = 0, first[2] = {0, 1};
    uint32_t triangle = 0;
    bvxi_sparse one = {.first = first, .count = 1, .value_type = BVX_F32, .triangles = &triangle};

    one.where.lattice = inside->lattice;
    one.where.words = &word;
    one.where.word_capacity = 1;
    one.where.words_per_row = one.where.size[0] = one.where.size[1] = one.where.size[2] = 1;
    bvx_grid its_side = one.where;
    its_side.words = &set;
    BVXI_TRY(bvxi_nearest_fill(at_once, nearest, HUGE_VAL, &one));
    BVXI_TRY(sign_band(at_once, mesh, &one, &its_side));
    memset(inside->words, 0, (size_t)bvxi_grid_words(inside) * 8);
    if (set != 0) {
        uint64_t const rows = bvxi_grid_rows(inside);
        for (uint64_t r = 0; r < rows; r++)
            bvxi_set_run(inside->words + r * (uint64_t)inside->words_per_row, 0, inside->size[0]);
    }
    return BVX_OK;
}

static bvx_status sign_whole_band(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                                  bvx_grid *inside)
{
    bvx_grid whole = band->where;
    BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, bvxi_grid_words(&whole) * 8, "the lattice's inside",
                             &whole.words));
    BVXI_TRY(sign_band(call, mesh, band, &whole));
    BVXI_TRY(bvxi_carry_signs(bvxi_call_part(call, call.to, call.to), &band->where, &whole));

    /* The bits of whole in the window of part. */
    int32_t const shift = inside->low[0] & 63, column = inside->low[0] >> 6;

    for (int32_t z = 0; z < inside->size[2]; z++)
        for (int32_t y = 0; y < inside->size[1]; y++) {
            const uint64_t *const from = bvxi_grid_row(&whole, y + inside->low[1], z + inside->low[2]);
            uint64_t *const to = bvxi_grid_row(inside, y, z);

            /* The window need not begin at a word: each of its words comes from two. */
            for (int32_t k = 0; k < inside->words_per_row; k++) {
                uint64_t w = from[column + k] >> shift;
                if (shift != 0 && column + k + 1 < whole.words_per_row)
                    w |= from[column + k + 1] << (64 - shift);
                to[k] = k + 1 == inside->words_per_row ? w & bvxi_tail_mask(inside->size[0]) : w;
            }
        }
    return BVX_OK;
}

static bvx_status sign_as_whole(bvxi_call call, const bvxi_nearest *nearest, double width,
                                const bvx_mesh_view *mesh, bvx_grid *inside)
{
    double const middle = call.from + (call.to - call.from) * 0.7;
    bvx_grid shape = {.lattice = inside->lattice};
    bvxi_sparse band;

    memcpy(shape.size, inside->lattice.dims, sizeof shape.size);
    shape.words_per_row = bvxi_row_words(shape.size[0]);
    shape.word_capacity = bvxi_grid_words(&shape);
    BVXI_TRY(bvxi_sparse_open(call.ctx, &shape, &band));
    memset(band.where.words, 0, (size_t)bvxi_grid_words(&shape) * 8);
    /* The band of the whole lattice with its triangles, made for the signs only. */
    double const part = call.from + (middle - call.from) * 0.4;
    uint64_t const rows = bvxi_grid_rows(&shape);
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, (rows + 1) * 8, "the band's rows", &band.first));
    BVXI_TRY(
        bvxi_nearest_band(bvxi_call_part(call, call.from, part), nearest, width, &band.where, band.first));
    band.count = band.first[rows];
    BVXI_TRY(bvxi_sparse_columns(call.ctx, &band, BVX_F32, BVXI_TRIANGLES));
    BVXI_TRY(bvxi_nearest_fill(bvxi_call_part(call, part, middle), nearest, HUGE_VAL, &band));
    return band.count == 0 ? sign_by_first_centre(bvxi_call_part(call, middle, middle), nearest, mesh, inside)
                           : sign_whole_band(bvxi_call_part(call, middle, call.to), mesh, &band, inside);
}

bvx_status bvxi_sign_normal(bvxi_call call, const bvxi_nearest *nearest, double width,
                            const bvx_mesh_view *mesh, const bvxi_sparse *band, bvx_grid *inside)
{
    int const whole = bvxi_grid_is_whole(inside);
    double const voxel = bvxi_largest_spacing(&inside->lattice), enough = width < voxel ? voxel : width;
    if (band->count == bvxi_grid_rows(inside) * (uint64_t)inside->size[0])
        return sign_band(call, mesh, band, inside);
    if (!whole || width < voxel)
        return BVXI_SCOPE(call.ctx, sign_as_whole(call, nearest, enough, mesh, inside));
    if (band->count == 0)
        return sign_by_first_centre(bvxi_call_part(call, call.from, call.from), nearest, mesh, inside);
    BVXI_TRY(sign_band(call, mesh, band, inside));
    return bvxi_carry_signs(bvxi_call_part(call, call.to, call.to), &band->where, inside);
}
