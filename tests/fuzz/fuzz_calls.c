/* fuzz_calls.c - what else is done with random meshes and their grids: distances, carrying,
 * dense fields, slices to sections and back to bodies, normals, trees chosen and asked, pictures, files by
 * parts. Many threads give what one gives. */
#include "fuzz_input.h"

static void fuzz_dense(bvx_context *ctx, fuzz_input *in, const fuzz_mesh *m, const bvx_lattice *lattice)
{
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_field field = {0};
    bvx_buffer file = {0};

    o.half_width = fuzz_range(in, 1, 8) / 4.0;
    o.sign = fuzz_range(in, BVX_FILL_AUTO, BVX_FILL_VOTE);
    o.features = 1;
    if (fuzz_good(ctx, bvx_measure_field(ctx, &m->view, lattice, &o, &field))) {
        uint64_t const voxels = (uint64_t)lattice->dims[0] * (uint64_t)lattice->dims[1] *
                                (uint64_t)lattice->dims[2];
        float *const values = malloc((size_t)voxels * sizeof *values);
        fuzz_require(values != NULL, "no memory");
        if (fuzz_good(ctx, bvx_field_dense(ctx, &field, 0, values)))
            for (uint64_t i = 0; i < voxels; i++) {
                int32_t const x = (int32_t)(i % (uint64_t)lattice->dims[0]);
                int32_t const y = (int32_t)(i / (uint64_t)lattice->dims[0] % (uint64_t)lattice->dims[1]);
                int32_t const z = (int32_t)(i / (uint64_t)lattice->dims[0] / (uint64_t)lattice->dims[1]);
                fuzz_require(bvx_grid_get(&field.inside, x, y, z) ? values[i] <= 0 : values[i] >= 0,
                             "a dense value on the other side");
            }
        free(values);
        fuzz_must(ctx, bvx_write_field(ctx, &field, fuzz_range(in, 0, 1), BVX_FORMAT_NRRD, &file));
        bvx_buffer_free(ctx, &file);
    }
    bvx_field_free(ctx, &field);
}

/* A solid's own surface: closed, so slices of it close, and sections of it give a closed body. */
static void fuzz_slices(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_mesh *surface)
{
    bvx_mesh_view view;
    bvx_slice_options o = {.struct_size = sizeof o};
    bvx_sections_options b = {.struct_size = sizeof b};
    bvx_sections sections = {0};
    bvx_mesh body = {0}, twin = {0};

    bvx_mesh_view_of(surface, &view);
    o.normal[0] = fuzz_range(in, -2, 2);
    o.normal[1] = fuzz_range(in, -2, 2);
    o.spacing = fuzz_range(in, 2, 32) / 8.0;
    if (!fuzz_good(ctx, bvx_slice_mesh(ctx, &view, &o, &sections))) return;
    b.slabs.grid[0] = fuzz_range(in, 2, 20);
    b.slabs.grid[1] = fuzz_range(in, 2, 20);
    b.caps = fuzz_range(in, BVX_CAPS_FLAT, BVX_CAPS_TAPER);
    b.slabs.crossings = fuzz_range(in, BVX_CROSSINGS_EXACT, BVX_CROSSINGS_CLASSIC);
    b.slabs.depth = fuzz_range(in, BVX_NONE, 5);
    { /* contours of voxel surfaces may touch themselves, which is refused in words */
        bvx_status const status = bvx_build_sections(ctx, &sections, &b, &body);
        if (status == BVX_ERR_FORMAT) fuzz_require(bvx_last_message(ctx)[0] != 0, "a failure without words");
        else if (fuzz_good(ctx, status)) {
            fuzz_certified(ctx, &body, "a body that is not certified");
            fuzz_must(other, bvx_build_sections(other, &sections, &b, &twin));
            fuzz_meshes_equal(ctx, &body, &twin, "another body with more threads");
        }
    }
    bvx_mesh_free(ctx, &body);
    bvx_mesh_free(other, &twin);
    bvx_sections_free(ctx, &sections);
}

static void fuzz_distances(bvx_context *ctx, fuzz_input *in, const fuzz_mesh *m, bvx_mesh *surface)
{
    static uint8_t colours[4 * FUZZ_VERTICES];
    bvx_mesh_view view;
    bvx_distance_report r;
    bvx_mesh source = {0};

    bvx_mesh_view_of(surface, &view);
    if (fuzz_good(ctx, bvx_mesh_distance(ctx, &m->view, &view, 50, (uint64_t)fuzz_range(in, 0, 255), &r)))
        fuzz_require(r.mean_a_to_b <= r.max_a_to_b && r.mean_b_to_a <= r.max_b_to_a && r.mean >= 0,
                     "a mean above the maximum");
    for (size_t i = 0; i < sizeof colours; i++) colours[i] = (uint8_t)(i * 31);
    source.positions = (void *)(uintptr_t)m->view.positions;
    source.triangles = (uint32_t *)(uintptr_t)m->view.indices;
    source.vertex_count = source.vertex_capacity = m->vertices;
    source.triangle_count = source.triangle_capacity = m->triangles;
    source.position_type = BVX_F64;
    source.colours = colours;
    if (fuzz_good(ctx, bvx_mesh_carry(ctx, &source, surface)))
        fuzz_require(surface->colours != NULL, "colours that were not carried");
}

/* Labels of voxels come back from a file with their colours. */
static void fuzz_label(bvx_context *ctx, const bvx_mesh *surface, const bvx_grid *grid)
{
    uint64_t const voxels = (uint64_t)grid->size[0] * (uint64_t)grid->size[1] * (uint64_t)grid->size[2];
    uint8_t *const labels = malloc((size_t)voxels), palette[1024], other[1024];
    bvx_buffer file = {0}, back = {0};

    fuzz_require(labels != NULL, "memory");
    if (surface->colours != NULL && fuzz_good(ctx, bvx_label_voxels(ctx, surface, grid, labels, palette)) &&
        fuzz_good(ctx, bvx_write_labels(ctx, grid, labels, palette, BVX_FORMAT_VOX, &file)) &&
        fuzz_good(ctx, bvx_read_labels(ctx, file.bytes, file.size, BVX_FORMAT_VOX, &back, other)))
        fuzz_require(back.size == voxels && memcmp(back.bytes, labels, (size_t)voxels) == 0 &&
                         memcmp(palette + 4, other + 4, 1020) == 0,
                     "labels that are others in a file");
    bvx_buffer_free(ctx, &file);
    bvx_buffer_free(ctx, &back);
    free(labels);
}

/* Bounds are finite and not negative, the tensor is one of a body, and more threads change no byte. */
static void fuzz_measure(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_mesh_view *view)
{
    bvx_measure_options const o = {.struct_size = sizeof o, .resolution = fuzz_range(in, 1, 24)};
    bvx_measure_report r, twin;

    if (!fuzz_good(ctx, bvx_measure(ctx, view, &o, &r))) return;
    fuzz_require(r.volume >= 0 && r.volume_error >= 0 && r.center_error >= 0 && r.inertia_error >= 0 &&
                     r.inertia_error <= 1e300,
                 "a bound that is none");
    for (int a = 0; a < 3; a++)
        fuzz_require(r.inertia[a] <= r.inertia[(a + 1) % 3] + r.inertia[(a + 2) % 3] + 4 * r.inertia_error,
                     "a tensor that no body has");
    fuzz_must(other, bvx_measure(other, view, &o, &twin));
    fuzz_require(memcmp(&r, &twin, sizeof r) == 0, "another mass with more threads");
}

/* Counts and places agree, what is least is not more than any share, and more threads change no byte. */
static void fuzz_inspect(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_mesh_view *view)
{
    static bvx_finding found[BVX_FINDING_COUNT][4], twins[BVX_FINDING_COUNT][4];
    bvx_inspect_options o = {.struct_size = sizeof o, .most = 4, .findings = &found[0][0]};
    bvx_inspect_report r, twin;

    o.fit.resolution = fuzz_range(in, 1, 24);
    o.walls = fuzz_range(in, 0, 9) * 0.25;
    o.gaps = fuzz_range(in, 0, 9) * 0.25;
    o.up = fuzz_range(in, BVX_UP_Z, BVX_UP_Y);
    memset(found, 0, sizeof found);
    memset(twins, 0, sizeof twins);
    if (!fuzz_good(ctx, bvx_inspect(ctx, view, &o, &r))) return;
    for (int k = 0; k < 4; k++) fuzz_require(r.thickness[k] >= r.least_thickness, "a share below the least");
    for (int kind = 0; kind < BVX_FINDING_COUNT; kind++)
        for (uint64_t i = 0; i < 4 && i < r.found[kind]; i++) {
            const bvx_finding *const f = &found[kind][i];
            fuzz_require(f->voxels > 0 && f->size >= 0, "a finding of nothing");
            for (int a = 0; a < 3; a++)
                fuzz_require(f->low[a] <= f->position[a] && f->position[a] <= f->high[a],
                             "a place beside its box");
        }
    o.findings = &twins[0][0];
    fuzz_must(other, bvx_inspect(other, view, &o, &twin));
    fuzz_require(memcmp(&r, &twin, sizeof r) == 0 && memcmp(found, twins, sizeof found) == 0,
                 "other findings with more threads");
}

/* In order, each once, and the same pairs with more threads. */
static void fuzz_crossings(bvx_context *ctx, bvx_context *other, const bvx_mesh_view *view)
{
    static uint32_t pairs[FUZZ_TRIANGLES * FUZZ_TRIANGLES], twins[FUZZ_TRIANGLES * FUZZ_TRIANGLES];
    uint64_t count = 0, again = 0;

    if (!fuzz_good(ctx, bvx_mesh_crossings(ctx, view, &count, NULL, 0))) return;
    fuzz_must(ctx, bvx_mesh_crossings(ctx, view, &again, pairs, count));
    fuzz_require(count == again && count <= view->triangle_count * (view->triangle_count - 1) / 2,
                 "another count with a list");
    for (uint64_t i = 0; i < count; i++) {
        fuzz_require(pairs[2 * i] < pairs[2 * i + 1] && pairs[2 * i + 1] < view->triangle_count,
                     "a pair that is none");
        fuzz_require(i == 0 || pairs[2 * i - 2] < pairs[2 * i] ||
                         (pairs[2 * i - 2] == pairs[2 * i] && pairs[2 * i - 1] < pairs[2 * i + 1]),
                     "pairs out of order");
    }
    fuzz_must(other, bvx_mesh_crossings(other, view, &again, twins, count));
    fuzz_require(count == again && memcmp(pairs, twins, (size_t)count * 8) == 0,
                 "other pairs with more threads");
}

static void fuzz_normals(bvx_context *ctx, fuzz_input *in, const bvx_mesh_view *view)
{
    static float vertex[3 * FUZZ_VERTICES], facet[3 * FUZZ_TRIANGLES];
    if (!fuzz_good(ctx, bvx_mesh_normals(ctx, view, fuzz_range(in, 0, 1), vertex, facet))) return;
    for (uint64_t i = 0; i < view->vertex_count + view->triangle_count; i++) {
        const float *const n = i < view->vertex_count ? vertex + 3 * i : facet + 3 * (i - view->vertex_count);
        double const square = ((double)n[0] * n[0] + (double)n[1] * n[1]) + (double)n[2] * n[2];
        fuzz_require(square > 0.99999 && square < 1.00001, "a normal that is not of length 1");
    }
}

/* Any mesh: numbers that are finite, the same by more threads, and no pair of triangles that cross anew. */
static void fuzz_smooth(bvx_context *ctx, bvx_context *other, fuzz_input *in, const bvx_mesh_view *view)
{
    static double one[3 * FUZZ_VERTICES], two[3 * FUZZ_VERTICES];
    bvx_smooth_options o = {.struct_size = sizeof o};
    size_t const size = (view->position_type == BVX_F32 && view->transform == NULL ? 12u : 24u) *
                        (size_t)view->vertex_count;
    o.method = fuzz_range(in, 0, 1);
    o.iterations = fuzz_range(in, 1, 30);
    o.sharp_angle = fuzz_range(in, 0, 2) * 30;
    o.hold_border = fuzz_range(in, 0, 1);
    o.no_crossings = fuzz_range(in, 0, 1);
    if (!fuzz_good(ctx, bvx_mesh_smooth(ctx, view, &o, one))) return;
    fuzz_must(other, bvx_mesh_smooth(other, view, &o, two));
    fuzz_require(memcmp(one, two, size) == 0, "other positions with more threads");
    if (!o.no_crossings) return;
    bvx_mesh_view moved = *view;
    uint64_t own, count;
    moved.positions = one;
    moved.position_type = size == 12 * (size_t)view->vertex_count ? BVX_F32 : BVX_F64;
    moved.position_stride = 0;
    moved.transform = NULL;
    (void)bvx_mesh_crossings(ctx, view, &own, NULL, 0);
    (void)bvx_mesh_crossings(ctx, &moved, &count, NULL, 0);
    fuzz_require(count <= own, "new crossings");
}

static void fuzz_chosen_tree(bvx_context *ctx, fuzz_input *in, const fuzz_mesh *m)
{
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL;
    bvx_octree_leaf leaf[4];
    double points[12];

    for (int i = 0; i < 12; i++) points[i] = fuzz_range(in, -8, 72) / 8.0;
    if (!fuzz_good(ctx, bvx_refine_choose(ctx, &m->view, fuzz_range(in, 1, 40), &o, &base)) ||
        !fuzz_good(ctx, bvx_refine(ctx, &m->view, &base, &o, &tree)))
        return;
    fuzz_must(ctx, bvx_octree_find(ctx, tree, points, 4, leaf));
    for (int i = 0; i < 4; i++)
        fuzz_require(leaf[i].state == BVX_STATE_OUTSIDE || leaf[i].state == BVX_STATE_INSIDE ||
                         leaf[i].state == BVX_STATE_SURFACE,
                     "a leaf of no state");
    bvx_octree_free(ctx, tree);
}

static void fuzz_pictures(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_mesh *m,
                          const bvx_grid *solid)
{
    bvx_render_options o = {.struct_size = sizeof o};
    bvx_image image = {0}, twin = {0};
    bvx_buffer file = {0};
    int const kind = fuzz_range(in, 0, 2);

    o.width = fuzz_range(in, 1, 40);
    o.height = fuzz_range(in, 1, 40);
    o.samples = fuzz_range(in, 1, 2);
    o.smooth = fuzz_range(in, 0, 1);
    o.wireframe = fuzz_range(in, 0, 1);
    o.camera.direction[0] = fuzz_range(in, -4, 4);
    int const cut = fuzz_range(in, 0, 2);
    o.cut.sides = BVX_OPEN_X_LOW << 2 * cut;
    o.cut.low[cut] = fuzz_range(in, -8, 64) / 8.0;
    for (int turn = 0; turn < 2; turn++) {
        bvx_context *const c = turn == 0 ? ctx : other;
        bvx_image *const i = turn == 0 ? &image : &twin;
        bvx_status status;
        if (kind == 0) status = bvx_render_mesh(c, &m->view, &o, i);
        else if (kind == 1) status = bvx_render_grid(c, solid, &o, i);
        else status = bvx_render_difference(c, solid, solid, &o, i);
        if (!fuzz_good(c, status)) break;
    }
    if (image.pixels != NULL) {
        fuzz_require(twin.pixels != NULL && memcmp(image.pixels, twin.pixels,
                                                   (size_t)image.width * (size_t)image.height * 3) == 0,
                     "another picture with more threads");
        fuzz_must(ctx, bvx_write_png(ctx, &image, &file));
        bvx_buffer_free(ctx, &file);
    }
    bvx_image_free(ctx, &image);
    bvx_image_free(other, &twin);
}

/* Head and slices are the file; the side-car puts a grid back on its lattice. */
static void fuzz_parts(bvx_context *ctx, const bvx_grid *solid)
{
    bvx_buffer whole = {0}, head = {0}, slices = {0}, side = {0};
    bvx_grid copy = {0};
    uint64_t first = 0, second = 0;

    fuzz_must(ctx, bvx_write_grid(ctx, solid, BVX_FORMAT_BVX, &whole));
    fuzz_must(ctx, bvx_write_head(ctx, &solid->lattice, NULL, &head));
    fuzz_must(ctx, bvx_write_slices(ctx, solid, &slices));
    fuzz_require(whole.size == head.size + slices.size &&
                     memcmp(whole.bytes, head.bytes, (size_t)head.size) == 0 &&
                     memcmp(whole.bytes + head.size, slices.bytes, (size_t)slices.size) == 0,
                 "parts that are not the file");
    fuzz_must(ctx, bvx_write_lattice(ctx, solid, &side));
    fuzz_must(ctx, bvx_read_grid(ctx, whole.bytes, whole.size, BVX_FORMAT_BVX, NULL, &copy));
    memset(&copy.lattice.origin, 0, sizeof copy.lattice.origin);
    fuzz_must(ctx, bvx_read_lattice(ctx, side.bytes, side.size, &copy));
    fuzz_must(ctx, bvx_grid_hash(ctx, solid, &first));
    fuzz_must(ctx, bvx_grid_hash(ctx, &copy, &second));
    fuzz_require(first == second, "another grid from its file and side-car");
    bvx_grid_free(ctx, &copy);
    bvx_buffer_free(ctx, &whole);
    bvx_buffer_free(ctx, &head);
    bvx_buffer_free(ctx, &slices);
    bvx_buffer_free(ctx, &side);
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_mesh surface = {0};

    fuzz_take_mesh(in, &m);
    if (m.triangles > 0 && fuzz_take_lattice(in, ctx, &m, 16, &lattice) &&
        fuzz_good(ctx, bvx_voxelize_solid(ctx, &m.view, &lattice, NULL, &solid))) {
        bvx_extract_options o = {.struct_size = sizeof o};
        o.position_type = BVX_F64;
        fuzz_must(ctx, bvx_extract_surface(ctx, &solid, &o, &surface));
        switch (fuzz_range(in, 0, 7)) {
        case 0:
        case 1: fuzz_dense(ctx, in, &m, &lattice); break;
        case 2:
            if (surface.triangle_count > 0) fuzz_slices(ctx, other, in, &surface);
            break;
        case 3:
            if (surface.triangle_count > 0) fuzz_distances(ctx, in, &m, &surface);
            fuzz_label(ctx, &surface, &solid);
            break;
        case 4: fuzz_chosen_tree(ctx, in, &m); break;
        case 5: fuzz_pictures(ctx, other, in, &m, &solid); break;
        case 6:
            fuzz_normals(ctx, in, &m.view);
            fuzz_smooth(ctx, other, in, &m.view);
            fuzz_crossings(ctx, other, &m.view);
            fuzz_measure(ctx, other, in, &m.view);
            fuzz_inspect(ctx, other, in, &m.view);
            break;
        default: fuzz_parts(ctx, &solid);
        }
    }
    bvx_mesh_free(ctx, &surface);
    bvx_grid_free(ctx, &solid);
    fuzz_end(ctx);
    fuzz_end(other);
}
