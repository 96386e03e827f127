/* fuzz_simplify.c - meshes to fewer triangles: surfaces of random bits, their vertices moved, some of their
 * triangles taken out or turned, and whatever a random mesh has. Each level is certified, closed where the
 * mesh was, with the handles and pieces of the mesh, crosses nothing where the mesh did not, and is the same
 * for many threads and any order of the triangles. */
#include "fuzz_input.h"

enum { SIDE = 6 };

/* The surface of random bits: pinched, thin, with handles and cavities. */
static void fuzz_take_surface(bvx_context *ctx, fuzz_input *in, bvx_mesh *surface)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t dims[3];
    bvx_lattice lattice;
    bvx_grid bits = {0};
    bvx_extract_options o = {.struct_size = sizeof o};
    int32_t const often = fuzz_range(in, 1, 4);
    for (int a = 0; a < 3; a++) dims[a] = fuzz_range(in, 1, SIDE);
    fuzz_must(ctx, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    fuzz_must(ctx, bvx_grid_create(ctx, &lattice, NULL, &bits));
    for (int32_t z = 0; z < dims[2]; z++)
        for (int32_t y = 0; y < dims[1]; y++)
            for (int32_t x = 0; x < dims[0]; x++) bvx_grid_set(&bits, x, y, z, fuzz_range(in, 0, often) == 0);
    o.position_type = BVX_F64;
    o.face_rule = fuzz_range(in, 0, 1);
    fuzz_must(ctx, bvx_extract_surface(ctx, &bits, &o, surface));
    bvx_grid_free(ctx, &bits);

    /* Moved far, triangles cross; moved by little, or to where others are, they hardly do. */
    for (int n = fuzz_range(in, 0, 7) * 8; n > 0 && surface->vertex_count > 0; n--) {
        double *const p = (double *)surface->positions +
                          3 * ((uint64_t)fuzz_range(in, 0, 65535) % surface->vertex_count);
        p[fuzz_range(in, 0, 2)] += fuzz_range(in, -64, 64) / (n % 5 == 0 ? 16.0 : 256.0);
    }
}

static uint64_t fuzz_crossings_of(bvx_context *ctx, const bvx_mesh_view *view)
{
    uint64_t count = 0;
    fuzz_must(ctx, bvx_mesh_crossings(ctx, view, &count, NULL, 0));
    return count;
}

static int fuzz_is_sound(const bvx_certificate *c)
{
    return c->closed && c->edge_manifold && c->vertex_manifold && c->oriented;
}

/* f32 may join or cross what is a hair apart, so only doubles keep it all. Where a level has colours, indices part
 * it along their seams, and the report knows it without them. */
static void fuzz_level(bvx_context *ctx, const bvx_mesh *level, const bvx_certificate *told,
                       const bvx_certificate *before, uint64_t crossings, int32_t type, int by_error)
{
    bvx_mesh_view view;
    bvx_certificate c;

    bvx_mesh_view_of(level, &view);
    fuzz_must(ctx, bvx_mesh_check(ctx, &view, 0, &c));
    if (level->colours != NULL) c = *told;

    /* By error the collapse has gone on, so that the report has such a level by positions: parts that touch do. */
    if (level->colours != NULL && by_error) {
        if (fuzz_is_sound(before)) fuzz_require(c.closed, "a level by error that is not closed");
        return;
    }
    fuzz_require(c.edge_manifold && c.oriented && c.unused_vertices == 0, "a level that is not certified");
    if (fuzz_is_sound(before)) fuzz_require(c.closed, "a level that is not closed");
    if (type == BVX_F32) return;
    fuzz_require(c.vertex_manifold, "a level whose parts touch");
    if (!before->edge_manifold || !before->vertex_manifold || !before->oriented || before->duplicates != 0)
        return;
    fuzz_require(c.boundary_edges <= before->boundary_edges && c.closed == before->closed,
                 "a level of other borders");
    fuzz_require(c.euler == before->euler && c.components == before->components,
                 "a level of other handles or pieces");
    if (crossings == 0) fuzz_require(fuzz_crossings_of(ctx, &view) == 0, "a level that crosses itself");
}

/* Take triangles out of a surface, turn some and double some. */
static void fuzz_open_surface(fuzz_input *in, bvx_mesh *surface)
{
    for (int n = fuzz_range(in, 0, 15); n > 0 && surface->triangle_count > 1; n--) {
        uint32_t *const t = surface->triangles +
                            3 * ((uint64_t)fuzz_range(in, 0, 65535) % surface->triangle_count);
        uint32_t const corner = t[0];
        switch (fuzz_range(in, 0, 4)) {
        case 0:
            t[0] = t[1];
            t[1] = corner;
            break;
        case 1: memcpy(surface->triangles, t, 12); break;
        default: surface->triangle_count--; memmove(t, surface->triangles + 3 * surface->triangle_count, 12);
        }
    }
}

/* Triangles backwards, each begun at another corner. */
static void fuzz_turn(bvx_mesh_view *view, uint32_t *to)
{
    const uint32_t *const from = view->indices;
    for (uint64_t t = 0; t < view->triangle_count; t++)
        for (uint64_t k = 0; k < 3; k++)
            to[3 * (view->triangle_count - 1 - t) + k] = from[3 * t + (k + t) % 3];
    view->indices = to;
}

static int fuzz_two_at_one_place(const bvx_certificate *c)
{
    return c->degenerate + c->duplicates + c->collapsed != 0;
}

static void fuzz_simplify(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_mesh_view *plain)
{
    bvx_mesh_view coloured = *plain;
    const bvx_mesh_view *const view = &coloured;
    uint8_t *const colours = malloc(4 * (size_t)plain->vertex_count + 1);
    uint64_t targets[2];
    double errors[2];
    bvx_mesh level[2] = {{0}}, twin[2] = {{0}};
    bvx_level_report reports[2];
    bvx_mesh_view turned;
    bvx_simplify_options o = {.struct_size = sizeof o};
    bvx_certificate before;
    bvx_status status;
    uint64_t crossings;
    uint32_t *corners;
    fuzz_require(colours != NULL, "no memory");
    fuzz_must(ctx, bvx_mesh_check(ctx, view, 1, &before));
    crossings = fuzz_crossings_of(ctx, view);
    for (int i = 0; i < 2; i++) {
        targets[i] = (uint64_t)fuzz_range(in, 1, 600);
        errors[i] = fuzz_range(in, 1, 64) / 64.0;
    }
    switch (fuzz_range(in, 0, 3)) {
    case 0: break;
    case 1: o.targets.errors = errors; break;
    default: o.targets.triangles = targets;
    }
    o.targets.error_kind = fuzz_range(in, 0, 1);
    o.collapse.position_type = fuzz_range(in, BVX_F32, BVX_F64);
    o.targets.even = fuzz_range(in, 0, 2) / 2.0 * fuzz_range(in, 0, 255) / 255.0;
    o.targets.samples = (uint64_t)fuzz_range(in, 0, 1) * 20;
    if (o.targets.errors != NULL) o.targets.samples = 50;
    o.reports = reports;
    if (fuzz_range(in, 0, 2) == 0) {
        for (uint64_t i = 0; i < 4 * view->vertex_count; i++) colours[i] = (uint8_t)fuzz_range(in, 0, 255);
        coloured.colours = colours;
        o.collapse.attribute_weight = fuzz_range(in, 0, 255) / 16.0;
    }
    turned = coloured;
    status = bvx_mesh_simplify(ctx, view, &o, 2, level);
    fuzz_require(status != BVX_ERR_ARGUMENT, bvx_last_message(ctx));
    if (!fuzz_good(ctx, status)) {
        free(colours);
        return;
    }
    for (int i = 0; i < 2; i++)
        fuzz_level(ctx, &level[i], &reports[i].certificate, &before, crossings, o.collapse.position_type,
                   o.targets.errors != NULL);

    corners = malloc((size_t)view->triangle_count * 12);
    fuzz_require(corners != NULL, "no memory");
    if (before.edge_manifold && before.oriented && !fuzz_two_at_one_place(&before))
        fuzz_turn(&turned, corners);
    o.reports = NULL;
    fuzz_must(other, bvx_mesh_simplify(other, &turned, &o, 2, twin));
    for (int i = 0; i < 2; i++) {
        fuzz_meshes_equal(ctx, &level[i], &twin[i], "another level with more threads or for another order");
        bvx_mesh_free(other, &twin[i]);
        bvx_mesh_free(ctx, &level[i]);
    }
    free(corners);
    free(colours);
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_mesh surface = {0};

    if (fuzz_range(in, 0, 3) != 0) {
        bvx_mesh_view view;
        fuzz_take_surface(ctx, in, &surface);
        if (surface.triangle_count > 1 && fuzz_range(in, 0, 1)) fuzz_open_surface(in, &surface);
        bvx_mesh_view_of(&surface, &view);
        if (surface.triangle_count > 0) fuzz_simplify(ctx, other, in, &view);
    } else {
        fuzz_take_mesh(in, &m);
        if (m.triangles > 0) fuzz_simplify(ctx, other, in, &m.view);
    }
    bvx_mesh_free(ctx, &surface);
    fuzz_end(ctx);
    fuzz_end(other);
}
