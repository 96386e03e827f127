/* fuzz_fields.c - meshes to distance fields, their surfaces, closest points and
 * repaired meshes: windows hold the whole's values, threads equal one, distances
 * are those of the nearest points, every surface is certified whatever the mesh. */
#include "fuzz_input.h"

#include <math.h>

enum { FUZZ_HITS = 64, FUZZ_LINKED = 4000 };

static void fuzz_values_equal(const bvx_field *part, const bvx_field *whole)
{
    for (int32_t z = 0; z < part->band.size[2]; z++)
        for (int32_t y = 0; y < part->band.size[1]; y++)
            for (int32_t x = 0; x < part->band.size[0]; x++) {
                int32_t const u = x + part->band.low[0] - whole->band.low[0],
                              v = y + part->band.low[1] - whole->band.low[1],
                              w = z + part->band.low[2] - whole->band.low[2];
                uint64_t const a = bvx_field_value(part, x, y, z), b = bvx_field_value(whole, u, v, w);
                fuzz_require((a == UINT64_MAX) == (b == UINT64_MAX), "another band in a window");
                if (a == UINT64_MAX) continue;
                fuzz_require(memcmp((const double *)part->distances + a, (const double *)whole->distances + b,
                                    sizeof(double)) == 0,
                             "another distance in a window");
                fuzz_require(memcmp((const double *)part->vectors + 3 * a,
                                    (const double *)whole->vectors + 3 * b, 3 * sizeof(double)) == 0,
                             "another vector in a window");
            }
}

/* All hits along x make the winding number, and the first of them is the nearest. */
static void fuzz_rays(bvx_context *ctx, const bvx_closest *closest, const double p[3])
{
    double const ray[6] = {p[0], p[1], p[2], 1, 0, 0};
    bvx_mesh_hit nearest, hits[FUZZ_HITS];
    uint64_t offsets[2];
    int64_t turns, sum = 0;

    fuzz_must(ctx, bvx_closest_winding(ctx, closest, p, 1, &turns));
    fuzz_must(ctx, bvx_closest_cast(ctx, closest, ray, 1, 1e300, &nearest));
    fuzz_must(ctx, bvx_closest_crossings(ctx, closest, ray, 1, 1e300, offsets, NULL, 0));
    fuzz_require((offsets[1] != 0) == (nearest.side != 0), "a nearest hit of none");
    if (offsets[1] == 0 || offsets[1] > FUZZ_HITS) return;
    fuzz_must(ctx, bvx_closest_crossings(ctx, closest, ray, 1, 1e300, offsets, hits, FUZZ_HITS));
    fuzz_require(hits[0].triangle == nearest.triangle && hits[0].t == nearest.t, "another nearest hit");
    for (uint64_t i = 0; i < offsets[1]; i++) sum -= hits[i].side;
    fuzz_require(hits[0].t == 0 || sum == turns, "another winding number than along the ray");
}

/* A link meets what a ray to the neighbour meets. */
static void fuzz_links(bvx_context *ctx, const bvx_closest *closest, const bvx_grid *grid, uint64_t count)
{
    static float values[FUZZ_LINKED * 18];
    const bvx_lattice *const l = &grid->lattice;
    const float *value = values;

    if (count > FUZZ_LINKED) return;
    fuzz_must(ctx, bvx_closest_links(ctx, closest, grid, 18, values));
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++) {
                int32_t const voxel[3] = {x, y, z};
                double ray[6] = {0, 0, 0, 0, 0, -l->spacing[2]};
                bvx_mesh_hit hit;
                if (!bvx_grid_get(grid, x, y, z)) continue;
                for (int a = 0; a < 3; a++)
                    ray[a] = l->origin[a] + (grid->low[a] + voxel[a] + 0.5) * l->spacing[a];
                fuzz_must(ctx, bvx_closest_cast(ctx, closest, ray, 1, 1, &hit));
                fuzz_require(value[2] == (hit.side != 0 ? (float)hit.t : -1.0F),
                             "another link than the ray down");
                value += 18;
            }
}

/* Its values are the distances to the nearest points by the other engine, up to rounding. */
static void fuzz_nearest(bvx_context *ctx, const fuzz_mesh *m, const bvx_lattice *lattice,
                         const bvx_field *field)
{
    bvx_closest *closest = NULL;

    fuzz_must(ctx, bvx_closest_create(ctx, &m->view, &closest));
    for (int32_t z = 0; z < field->band.size[2]; z += 3)
        for (int32_t y = 0; y < field->band.size[1]; y += 2)
            for (int32_t x = 0; x < field->band.size[0]; x++) {
                uint64_t const n = bvx_field_value(field, x, y, z);
                bvx_closest_point found;
                double p[3], distance;
                if (n == UINT64_MAX) continue;
                p[0] = lattice->origin[0] + (x + field->band.low[0] + 0.5) * lattice->spacing[0];
                p[1] = lattice->origin[1] + (y + field->band.low[1] + 0.5) * lattice->spacing[1];
                p[2] = lattice->origin[2] + (z + field->band.low[2] + 0.5) * lattice->spacing[2];
                fuzz_must(ctx, bvx_closest_find(ctx, closest, p, 1, &found));
                distance = ((const double *)field->distances)[n];
                fuzz_require(fabs(fabs(distance) - found.distance) <= 1e-9 * (1 + found.distance),
                             "a distance that is not the nearest point's");
                if (n % 8 == 0) fuzz_rays(ctx, closest, p);
            }
    fuzz_links(ctx, closest, &field->band, field->value_count);
    bvx_closest_free(ctx, closest);
}

static void fuzz_field_surface(bvx_context *ctx, fuzz_input *in, const fuzz_mesh *m, const bvx_field *field)
{
    bvx_field_surface_options o = {.struct_size = sizeof o};
    bvx_grid changed = {0};
    bvx_mesh mesh = {0};

    if (field->inside.words == NULL) return;
    if (fuzz_range(in, 0, 1)) {
        fuzz_must(ctx, bvx_grid_combine(ctx, &field->inside, &field->inside, BVX_BOOLEAN_UNION, &changed));
        for (int32_t n = 0; n < 12; n++)
            bvx_grid_set(&changed, fuzz_range(in, 0, changed.size[0] - 1),
                         fuzz_range(in, 0, changed.size[1] - 1), fuzz_range(in, 0, changed.size[2] - 1),
                         fuzz_range(in, 0, 1));
        o.grid = &changed;
        o.offset = fuzz_range(in, -8, 8) * field->inside.lattice.spacing[0] / 4.0;
    }
    o.placing.interpolation = fuzz_range(in, BVX_EDGE_TANGENT, BVX_EDGE_PAPER);
    o.placing.face_rule = fuzz_range(in, 0, 1);
    o.placing.sharp = fuzz_range(in, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS);
    o.placing.position_type = BVX_F64;
    if (fuzz_good(ctx, bvx_extract_field_surface(ctx, field, &m->view, &o, &mesh)))
        fuzz_certified(ctx, &mesh, "a field's surface that is not certified");
    bvx_mesh_free(ctx, &mesh);
    bvx_grid_free(ctx, &changed);
}

static void fuzz_field(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *m,
                       const bvx_lattice *lattice)
{
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_field whole = {0}, twin = {0}, part = {0};

    o.half_width = fuzz_range(in, 1, 16) / 4.0;
    o.sign = fuzz_range(in, BVX_FILL_AUTO, BVX_FILL_NONE);
    if ((BVX_FILLS_OF_FIELD >> o.sign & 1) == 0) o.sign = BVX_FILL_AUTO;
    o.value_type = BVX_F64;
    o.features = fuzz_range(in, 0, 1);
    if (!fuzz_good(ctx, bvx_measure_field(ctx, &m->view, lattice, &o, &whole))) return;
    fuzz_must(other, bvx_measure_field(other, &m->view, lattice, &o, &twin));
    fuzz_grids_equal(&whole.band, &twin.band, "another band with more threads");
    fuzz_require(whole.value_count == twin.value_count &&
                     (whole.value_count == 0 ||
                      memcmp(whole.distances, twin.distances, (size_t)whole.value_count * 8) == 0),
                 "other distances with more threads");
    if (whole.inside.words != NULL)
        fuzz_grids_equal(&whole.inside, &twin.inside, "another inside with more threads");
    o.window = fuzz_take_window(in, lattice);
    fuzz_must(ctx, bvx_measure_field(ctx, &m->view, lattice, &o, &part));
    fuzz_values_equal(&part, &whole);
    if (whole.inside.words != NULL)
        fuzz_part_equals_whole(&part.inside, &whole.inside, "another inside in a window");
    fuzz_nearest(ctx, m, lattice, &whole);
    fuzz_field_surface(ctx, in, m, &whole);
    bvx_field_free(ctx, &whole);
    bvx_field_free(other, &twin);
    bvx_field_free(ctx, &part);
}

static void fuzz_repaired(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *m)
{
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0}, twin = {0};

    o.fit.resolution = fuzz_range(in, 1, 24);
    o.sign = fuzz_range(in, 0, 2) == 0 ? BVX_FILL_VOTE : BVX_FILL_AUTO;
    o.placing.interpolation = fuzz_range(in, BVX_EDGE_TANGENT, BVX_EDGE_PAPER);
    o.placing.sharp = fuzz_range(in, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS);
    o.shell = fuzz_range(in, 0, 3) == 0 ? 0 : 1.5 + fuzz_range(in, 0, 4) / 4.0;
    o.parts.least_part = (uint64_t)fuzz_range(in, 0, 3);
    o.parts.keep_largest = (uint64_t)fuzz_range(in, 0, 2);
    o.parts.least_cavity = (uint64_t)fuzz_range(in, 0, 3);
    o.placing.position_type = BVX_F64;
    if (!fuzz_good(ctx, bvx_repair(ctx, &m->view, &o, &mesh))) return;
    fuzz_require(mesh.triangle_count > 0, "an empty success");
    fuzz_certified(ctx, &mesh, "a repaired mesh that is not certified");
    fuzz_must(other, bvx_repair(other, &m->view, &o, &twin));
    fuzz_meshes_equal(ctx, &mesh, &twin, "another repaired mesh with more threads");
    bvx_mesh_free(ctx, &mesh);
    bvx_mesh_free(other, &twin);
}

static void fuzz_hull(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *m)
{
    bvx_hull_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0}, twin = {0};

    o.fit.resolution = fuzz_range(in, 1, 24);
    o.close_gaps = fuzz_range(in, 0, 6);
    o.placing.interpolation = fuzz_range(in, BVX_EDGE_TANGENT, BVX_EDGE_PAPER);
    o.placing.sharp = fuzz_range(in, BVX_SHARP_AUTO, BVX_SHARP_ALWAYS);
    o.shell = fuzz_range(in, 0, 3) == 0 ? BVX_NONE : 1.5 + fuzz_range(in, 0, 4) / 4.0;
    o.parts.least_part = (uint64_t)fuzz_range(in, 0, 3);
    o.parts.keep_largest = (uint64_t)fuzz_range(in, 0, 2);
    o.placing.position_type = BVX_F64;
    if (fuzz_range(in, 0, 3) == 0) {
        o = (bvx_hull_options){.struct_size = sizeof o};
        o.enclose = fuzz_range(in, 1, 40) * 0.25;
    }
    if (!fuzz_good(ctx, bvx_hull(ctx, &m->view, &o, 1, &mesh))) return;
    fuzz_require(mesh.triangle_count > 0, "an empty success");
    fuzz_certified(ctx, &mesh, "a hull that is not certified");
    fuzz_must(other, bvx_hull(other, &m->view, &o, 1, &twin));
    fuzz_meshes_equal(ctx, &mesh, &twin, "another hull with more threads");
    bvx_mesh_free(ctx, &mesh);
    bvx_mesh_free(other, &twin);
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_lattice lattice;

    fuzz_take_mesh(in, &m);
    if (m.triangles > 0) {
        if (fuzz_range(in, 0, 1) == 0 && fuzz_take_lattice(in, ctx, &m, 14, &lattice))
            fuzz_field(ctx, other, in, &m, &lattice);
        else if (fuzz_range(in, 0, 1) == 0) fuzz_repaired(ctx, other, in, &m);
        else fuzz_hull(ctx, other, in, &m);
    }
    fuzz_end(ctx);
    fuzz_end(other);
}
