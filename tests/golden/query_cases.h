/* query_cases.h - golden cases of questions to grids, meshes, octrees and
 * fields, of files and of pictures; read in by golden.c. */
#ifndef QUERY_CASES_H
#define QUERY_CASES_H

/* Numbers are hashed one after the other as little-endian bytes, whatever the machine's order. */
static uint64_t mixed_word(uint64_t hash, uint64_t v)
{
    uint8_t bytes[8];
    for (int i = 0; i < 8; i++) bytes[i] = (uint8_t)(v >> 8 * i & 0xff);
    return bvx_hash(bytes, sizeof bytes, hash);
}

static uint64_t mixed_doubles(uint64_t hash, const double *values, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        uint64_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        hash = mixed_word(hash, bits);
    }
    return hash;
}

static uint64_t mixed_floats(uint64_t hash, const float *values, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &values[i], sizeof bits);
        hash = mixed_word(hash, bits);
    }
    return hash;
}

static uint64_t mixed_integers(uint64_t hash, const int32_t *values, uint64_t count)
{
    for (uint64_t i = 0; i < count; i++) hash = mixed_word(hash, (uint64_t)(int64_t)values[i]);
    return hash;
}

/* Of triangles that are summed up, and of voxels that are counted where a fifth of them is missing. */
static void mass_values(golden *g, const bvx_mesh_view *view)
{
    bvx_measure_options o = {.struct_size = sizeof o, .density = 3.0, .resolution = 24};
    bvx_measure_report whole, rest;
    bvx_mesh_view open = *view;

    open.triangle_count -= open.triangle_count / 5;
    if (golden_good(g, bvx_measure(g->context, view, &o, &whole)) &&
        golden_good(g, bvx_measure(g->context, &open, &o, &rest)))
        golden_hex(g, "mass", mixed_doubles(mixed_doubles(0, &whole.volume, 15), &rest.volume, 15));
}

/* What is measured along rays, and the places that voxels make of it. */
static void inspect_values(golden *g, const bvx_mesh_view *view)
{
    static bvx_finding found[BVX_FINDING_COUNT][8];
    bvx_inspect_options o = {
        .struct_size = sizeof o, .walls = 1.0, .gaps = 2.5, .most = 8, .findings = &found[0][0]};
    bvx_inspect_report r;
    uint64_t hash;

    memset(found, 0, sizeof found);
    o.fit.resolution = 32;
    if (!golden_good(g, bvx_inspect(g->context, view, &o, &r))) return;
    hash = mixed_doubles(mixed_doubles(0, &r.volume, 14), &r.thin_area, 9);
    for (int i = 0; i < BVX_FINDING_COUNT * 8; i++) hash = mixed_doubles(hash, &found[i / 8][i % 8].size, 10);
    golden_hex(g, "inspection", hash);
}

enum { QUERY_COUNT = 200, QUERY_PAIRS = 20000 };

/* Points and rays from a fixed generator, in and around the torus. */
static void query_numbers(double *numbers, uint64_t count)
{
    uint64_t state = 99;
    for (uint64_t i = 0; i < count; i++)
        numbers[i] = (double)(shape_random(&state) >> 40) / 16777216.0 * 7.0 - 3.5;
}

static uint64_t mixed_hits(const bvx_ray_hit hits[QUERY_COUNT])
{
    uint64_t h = 0;
    for (int i = 0; i < QUERY_COUNT; i++) {
        h = mixed_integers(mixed_doubles(h, &hits[i].t, 1), hits[i].voxel, 3);
        h = mixed_doubles(h, hits[i].position, 3) + (uint64_t)(hits[i].axis + 2 * hits[i].hit);
    }
    return h;
}

static void grid_questions(golden *g, const bvx_grid *a, const bvx_grid *b)
{
    static double rays[6 * QUERY_COUNT], values[QUERY_COUNT], gradients[3 * QUERY_COUNT];
    static bvx_ray_hit hits[QUERY_COUNT];
    bvx_grid_difference d;
    bvx_rays *caster = NULL;

    query_numbers(rays, 6 * QUERY_COUNT);
    if (golden_good(g, bvx_grid_cast(g->context, a, rays, QUERY_COUNT, 1e9, hits)))
        golden_hex(g, "cast", mixed_hits(hits));
    /* The bricks of b, then of a: what an update leaves shows. */
    if (golden_good(g, bvx_rays_create(g->context, b, &caster)) &&
        golden_good(g, bvx_rays_update(g->context, caster, a, NULL)) &&
        golden_good(g, bvx_rays_cast(g->context, caster, rays, QUERY_COUNT, 1e9, hits)))
        golden_hex(g, "rays_kept", mixed_hits(hits));
    bvx_rays_free(g->context, caster);
    if (golden_good(g, bvx_grid_sample(g->context, a, rays, QUERY_COUNT, values, gradients)))
        golden_hex(g, "sample",
                   mixed_doubles(mixed_doubles(0, values, QUERY_COUNT), gradients, 3 * QUERY_COUNT));
    if (golden_good(g, bvx_grid_compare(g->context, a, b, &d))) {
        golden_u64(g, "only_a", d.only_a);
        golden_u64(g, "only_b", d.only_b);
        golden_u64(g, "pieces", d.components_only_a + d.components_only_b);
    }
}

static void mesh_questions(golden *g, const bvx_mesh_view *view, bvx_mesh *surface)
{
    static double points[3 * QUERY_COUNT];
    static bvx_closest_point found[QUERY_COUNT];
    static bvx_mesh_hit hits[QUERY_COUNT];
    static int64_t turns[QUERY_COUNT];
    static uint64_t offsets[QUERY_COUNT + 1];
    static uint32_t corners[3 * QUERY_COUNT], pairs[2 * QUERY_PAIRS];
    bvx_closest *closest = NULL;
    bvx_certificate c;
    bvx_distance_report r;
    bvx_mesh_view other, loose = *view;
    uint64_t h = 0, crossings = 0;

    query_numbers(points, 3 * QUERY_COUNT);
    bvx_mesh_view_of(surface, &other);
    if (golden_good(g, bvx_closest_create(g->context, view, &closest)) &&
        golden_good(g, bvx_closest_find(g->context, closest, points, QUERY_COUNT, found))) {
        for (int i = 0; i < QUERY_COUNT; i++) {
            h = mixed_doubles(mixed_doubles(h, found[i].position, 3), found[i].weight, 3);
            h = mixed_word(mixed_doubles(h, &found[i].distance, 1),
                           found[i].triangle * 8u + (uint32_t)found[i].feature);
        }
        golden_hex(g, "closest", h);
    }
    if (golden_good(g, bvx_closest_cast(g->context, closest, points, QUERY_COUNT / 2, 8, hits)) &&
        golden_good(g, bvx_closest_winding(g->context, closest, points, QUERY_COUNT, turns))) {
        h = 0;
        for (int i = 0; i < QUERY_COUNT / 2; i++) {
            h = mixed_doubles(mixed_doubles(mixed_doubles(h, hits[i].position, 3), hits[i].weight, 3),
                              &hits[i].t, 1);
            h = mixed_word(h, hits[i].triangle * 8u + (uint32_t)(hits[i].side + 1));
        }
        for (int i = 0; i < QUERY_COUNT; i++) h = mixed_word(h, (uint32_t)turns[i]);
        if (golden_good(g, bvx_closest_crossings(g->context, closest, points, QUERY_COUNT / 2, 1e9, offsets,
                                                 NULL, 0)))
            h = mixed_word(h, (uint32_t)offsets[QUERY_COUNT / 2]);
        golden_hex(g, "rays", h);
    }
    bvx_closest_free(g->context, closest);
    if (golden_good(g, bvx_mesh_check(g->context, view, 1, &c))) {
        golden_u64(g, "edges", c.edges);
        golden_hex(g, "volume", mixed_doubles(mixed_doubles(0, &c.volume, 1), &c.area, 1));
    }
    mass_values(g, view);
    inspect_values(g, view);
    /* across the body */
    for (uint32_t i = 0; i < 3 * QUERY_COUNT; i++) corners[i] = i * 37 % (uint32_t)view->vertex_count;
    loose.indices = corners;
    loose.index_type = BVX_U32;
    loose.index_stride = 0;
    loose.triangle_count = QUERY_COUNT;
    if (golden_good(g, bvx_mesh_crossings(g->context, &loose, &crossings, pairs, QUERY_PAIRS))) {
        h = 0;
        for (uint64_t i = 0; i < 2 * crossings; i++) h = mixed_word(h, pairs[i]);
        golden_u64(g, "crossings", crossings);
        golden_hex(g, "pairs", h);
    }
    if (golden_good(g, bvx_mesh_distance(g->context, view, &other, 500, 3, &r)))
        golden_hex(g, "distance", mixed_doubles(0, &r.mean_a_to_b, 6));
}

/* Labels by colours of a mesh, more than there are labels, and back from a file. */
static void golden_labels(golden *g, const bvx_mesh *surface, const bvx_grid *grid)
{
    static uint8_t colours[4 * 20000], labels[1 << 17], palette[1024];
    bvx_mesh painted = *surface;
    bvx_buffer file = {0}, back = {0};
    size_t const voxels = (size_t)grid->size[0] * (size_t)grid->size[1] * (size_t)grid->size[2];

    if (surface->vertex_count > 20000 || voxels > sizeof labels) return;
    for (uint64_t i = 0; i < surface->vertex_count * 4; i++) colours[i] = (uint8_t)(i * 37 % 251);
    painted.colours = colours;
    if (golden_good(g, bvx_label_voxels(g->context, &painted, grid, labels, palette)))
        golden_hex(g, "labels", bvx_hash(labels, voxels, bvx_hash(palette, sizeof palette, 0)));
    if (golden_good(g, bvx_write_labels(g->context, grid, labels, palette, BVX_FORMAT_VOX, &file)) &&
        golden_good(g, bvx_read_labels(g->context, file.bytes, file.size, BVX_FORMAT_VOX, &back, palette)))
        golden_hex(g, "labels_read",
                   bvx_hash(back.bytes, (size_t)back.size, bvx_hash(palette, sizeof palette, 0)));
    if (golden_good(g, bvx_write_labels(g->context, grid, labels, palette, BVX_FORMAT_NRRD, &file)))
        golden_hex(g, "segments", bvx_hash(file.bytes, (size_t)file.size, 0));
    bvx_buffer_free(g->context, &file);
    bvx_buffer_free(g->context, &back);
}

/* Of one slice. */
static void golden_links(golden *g, const bvx_mesh_view *view, const bvx_grid *grid)
{
    static float values[2000 * 18];
    bvx_window const one = {{grid->low[0], grid->low[1], grid->low[2] + grid->size[2] / 2},
                            {grid->size[0], grid->size[1], 1}};
    bvx_closest *closest = NULL;
    bvx_grid slice = {0};
    uint64_t count = 0;

    if (golden_good(g, bvx_closest_create(g->context, view, &closest)) &&
        golden_good(g, bvx_grid_crop(g->context, grid, &one, &slice)) &&
        golden_good(g, bvx_grid_count(g->context, &slice, &count)) && count <= 2000 &&
        golden_good(g, bvx_closest_links(g->context, closest, &slice, 18, values))) {
        uint64_t h = 0;
        for (uint64_t i = 0; i < count * 18; i++) {
            double const value = (double)values[i];
            h = mixed_doubles(h, &value, 1);
        }
        golden_hex(g, "links", h);
    }
    bvx_closest_free(g->context, closest);
    bvx_grid_free(g->context, &slice);
}

static void question_cases(golden *g)
{
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid parity = {0}, conservative = {0}, filled = {0};
    bvx_mesh surface = {0}, faces = {0};
    bvx_seed seed;
    int32_t pocket[3] = {0, 0, 0};
    uint64_t pockets = 0, vertices = 0, triangles = 0;

    shape_torus(&golden_shape, 48, 20, 0.25, 7);
    shape_view(&golden_shape, &view);
    golden_begin(g, "torus_40");
    if (golden_good(g, bvx_lattice_fit(g->context, &view, 40, &lattice)) &&
        golden_good(g, bvx_voxelize_solid(g->context, &view, &lattice, NULL, &parity)) &&
        golden_good(g, bvx_voxelize_surface(g->context, &view, &lattice, NULL, &conservative)) &&
        golden_good(g, bvx_extract_surface(g->context, &parity, NULL, &surface))) {
        grid_questions(g, &parity, &conservative);
        mesh_questions(g, &view, &surface);
        if (golden_good(g, bvx_extract_count(g->context, &parity, NULL, &vertices, &triangles)))
            golden_u64(g, "vertices", vertices);
        if (golden_good(g, bvx_extract_faces(g->context, &parity, NULL, &faces)))
            golden_u64(g, "faces", faces.triangle_count);
        golden_labels(g, &surface, &parity);
        golden_links(g, &view, &conservative);
        if (golden_good(g, bvx_find_seed(g->context, &conservative, &view, 0, &seed)))
            golden_hex(g, "seed", mixed_integers(0, seed.voxel, 3));
        if (golden_good(g, bvx_find_pockets(g->context, &conservative, &view, pocket, 1, &pockets)) &&
            golden_good(g, bvx_grid_fill(g->context, &conservative, pocket, pockets, 6, &filled)))
            grid_value(g, "pocket", &filled);
    }
    golden_end(g);
    bvx_mesh_free(g->context, &surface);
    bvx_mesh_free(g->context, &faces);
    bvx_grid_free(g->context, &conservative);
    bvx_grid_free(g->context, &parity);
}

/* ---- Octrees: what they answer ---- */

static void tree_questions(golden *g, const bvx_octree *tree)
{
    static double rays[6 * QUERY_COUNT];
    static bvx_octree_leaf leaves[QUERY_COUNT];
    static bvx_octree_hit hits[QUERY_COUNT];
    bvx_octree_level level[8];
    uint64_t h = 0, beside = 0;
    bvx_lattice lattice;
    int32_t const first[3] = {0, 0, 0};

    query_numbers(rays, 6 * QUERY_COUNT);
    if (golden_good(g, bvx_octree_find(g->context, tree, rays, QUERY_COUNT, leaves))) {
        for (int i = 0; i < QUERY_COUNT; i++)
            h = mixed_word(mixed_integers(h, leaves[i].ijk, 3), leaves[i].level * 8u + leaves[i].state);
        golden_hex(g, "find", h);
    }
    h = 0;
    if (golden_good(g, bvx_octree_cast(g->context, tree, 0, rays, QUERY_COUNT, 1e9, hits))) {
        for (int i = 0; i < QUERY_COUNT; i++)
            h = mixed_integers(mixed_doubles(h, hits[i].position, 3), hits[i].leaf.ijk, 3);
        golden_hex(g, "cast", h);
    }
    if (golden_good(g, bvx_octree_at(g->context, tree, first, 1, leaves)) &&
        golden_good(g, bvx_octree_neighbours(g->context, tree, &leaves[0], 3, NULL, 0, &beside)))
        golden_u64(g, "beside", beside);
    if (golden_good(g, bvx_octree_count(g->context, tree, level, 8)))
        golden_u64(g, "inside", level[bvx_octree_levels(tree)].inside);
    if (golden_good(g, bvx_octree_lattice(g->context, tree, 0, &lattice)))
        golden_hex(g, "base", mixed_doubles(0, lattice.spacing, 3));
    if (golden_good(g, bvx_octree_leaves(g->context, tree, 0, NULL, 0, &beside)))
        golden_u64(g, "leaves", beside);
}

static void file_value(golden *g, const char *key, bvx_status status, bvx_buffer *file)
{
    if (golden_good(g, status)) golden_hex(g, key, bvx_hash(file->bytes, (size_t)file->size, 0));
    bvx_buffer_free(g->context, file);
}

static void tree_question_cases(golden *g)
{
    bvx_mesh_view view;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL, *back = NULL;
    bvx_buffer file = {0};
    bvx_grid grid = {0};

    shape_torus(&golden_shape, 48, 20, 0.25, 7);
    shape_view(&golden_shape, &view);
    golden_begin(g, "torus_60");
    if (golden_good(g, bvx_refine_choose(g->context, &view, 60, &o, &base)) &&
        golden_good(g, bvx_refine(g->context, &view, &base, &o, &tree))) {
        golden_u64(g, "levels", (uint64_t)o.levels);
        tree_questions(g, tree);
        if (golden_good(g, bvx_octree_expand(g->context, tree, o.levels, 0, NULL, &grid)))
            grid_value(g, "expanded", &grid);
        file_value(g, "vtu", bvx_write_octree(g->context, tree, 0, BVX_FORMAT_VTU, &file), &file);
        if (golden_good(g, bvx_write_octree(g->context, tree, 0, BVX_FORMAT_BVX, &file)) &&
            golden_good(g, bvx_read_octree(g->context, file.bytes, file.size, &back))) {
            golden_hex(g, "bvx", bvx_hash(file.bytes, (size_t)file.size, 0));
            bvx_octree_free(g->context, back);
        }
        bvx_buffer_free(g->context, &file);
    }
    golden_end(g);
    bvx_octree_free(g->context, tree);
}

/* ---- Files: written, read again, written again to the same bytes ---- */

static void grid_files(golden *g, const bvx_grid *grid)
{
    static const struct {
        const char *name;
        int32_t format;
    } formats[] = {{"npy", BVX_FORMAT_NPY},   {"binvox", BVX_FORMAT_BINVOX}, {"vox", BVX_FORMAT_VOX},
                   {"nrrd", BVX_FORMAT_NRRD}, {"vti", BVX_FORMAT_VTI},       {"bvx", BVX_FORMAT_BVX}};
    bvx_buffer side = {0}, head = {0}, slices = {0};
    golden_begin(g, "grids");
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        bvx_buffer file = {0};
        bvx_grid back = {0};
        uint64_t set = 0;
        if (!golden_good(g, bvx_write_grid(g->context, grid, formats[i].format, &file))) continue;
        golden_hex(g, formats[i].name, bvx_hash(file.bytes, (size_t)file.size, 0));
        if (golden_good(g,
                        bvx_read_grid(g->context, file.bytes, file.size, formats[i].format, NULL, &back)) &&
            golden_good(g, bvx_grid_count(g->context, &back, &set)))
            golden_u64(g, "set", set);
        bvx_grid_free(g->context, &back);
        bvx_buffer_free(g->context, &file);
    }
    if (golden_good(g, bvx_write_lattice(g->context, grid, &side))) {
        bvx_grid copy = {0};
        golden_hex(g, "side_car", bvx_hash(side.bytes, (size_t)side.size, 0));
        if (golden_good(g, bvx_grid_create(g->context, &grid->lattice, NULL, &copy)) &&
            golden_good(g, bvx_read_lattice(g->context, side.bytes, side.size, &copy)))
            golden_hex(g, "origin", mixed_doubles(0, copy.lattice.origin, 3));
        bvx_grid_free(g->context, &copy);
    }
    bvx_buffer_free(g->context, &side);
    file_value(g, "head", bvx_write_head(g->context, &grid->lattice, NULL, &head), &head);
    file_value(g, "slices", bvx_write_slices(g->context, grid, &slices), &slices);
    golden_end(g);
}

static void mesh_files(golden *g, bvx_mesh *mesh)
{
    static const struct {
        const char *name;
        int32_t format;
    } formats[] = {{"stl", BVX_FORMAT_STL},
                   {"obj", BVX_FORMAT_OBJ},
                   {"ply", BVX_FORMAT_PLY},
                   {"off", BVX_FORMAT_OFF},
                   {"glb", BVX_FORMAT_GLB}};
    golden_begin(g, "meshes");
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        bvx_buffer file = {0};
        bvx_mesh back = {0};
        if (!golden_good(g, bvx_write_mesh(g->context, mesh, 1, NULL, formats[i].format, &file))) continue;
        golden_hex(g, formats[i].name, bvx_hash(file.bytes, (size_t)file.size, 0));
        if (formats[i].format != BVX_FORMAT_GLB &&
            golden_good(g, bvx_read_mesh(g->context, file.bytes, file.size, formats[i].format, NULL, &back)))
            mesh_value(g, "back", BVX_OK, &back);
        bvx_buffer_free(g->context, &file);
    }
    golden_end(g);
}

/* The mesh as a file of doubles with every seventh vertex at infinity. */
static void finite_mesh(golden *g, const bvx_mesh *mesh)
{
    bvx_buffer file = {0};
    bvx_mesh spoilt = {0};
    uint64_t dropped = 0;
    bvx_read_report report = {0};
    bvx_read_options options = {.struct_size = sizeof options};

    options.drop_nonfinite = 1;
    options.report = &report;
    golden_begin(g, "finite");
    if (golden_good(g, bvx_write_mesh(g->context, mesh, 1, NULL, BVX_FORMAT_OBJ, &file)) &&
        golden_good(g, bvx_read_mesh(g->context, file.bytes, file.size, BVX_FORMAT_OBJ, &options, &spoilt))) {
        golden_u64(g, "of_finite", report.dropped);
        for (uint64_t v = 0; v < spoilt.vertex_count; v += 7)
            ((double *)spoilt.positions)[v * 3 + v % 3] = HUGE_VAL;
        if (golden_good(g, bvx_mesh_drop_nonfinite(g->context, &spoilt, &dropped)))
            golden_u64(g, "dropped", dropped);
        mesh_value(g, "remains", BVX_OK, &spoilt);
    }
    bvx_buffer_free(g->context, &file);
    golden_end(g);
}

/* What 32-bit floats leave of a mesh of doubles in metres of a map projection. */
static void written_value(golden *g, const bvx_mesh *mesh)
{
    bvx_mesh far = *mesh;
    bvx_write_report r;
    bvx_write_options const o = {.struct_size = sizeof o, .reports = &r};

    far.frame[0] = 600000.0;
    far.frame[1] = 5000000.0;
    if (golden_good(g, bvx_write_mesh(g->context, &far, 1, &o, BVX_FORMAT_STL, NULL)))
        golden_hex(g, "written", r.merged << 40 ^ r.spoilt << 20 ^ r.file.vertices << 1 ^ (uint64_t)r.fits);
}

/* Normals in the formats that hold them, and levels of detail in one file. */
static void mesh_files_with(golden *g, const bvx_mesh *mesh, const bvx_mesh *finer)
{
    bvx_mesh levels[2];
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_buffer file = {0};

    golden_begin(g, "meshes_with");
    o.normals = 1;
    file_value(g, "obj_normals", bvx_write_mesh(g->context, mesh, 1, &o, BVX_FORMAT_OBJ, &file), &file);
    file_value(g, "ply_normals", bvx_write_mesh(g->context, mesh, 1, &o, BVX_FORMAT_PLY, &file), &file);
    levels[0] = *finer;
    levels[1] = *mesh;
    file_value(g, "levels", bvx_write_mesh(g->context, levels, 2, NULL, BVX_FORMAT_GLB, &file), &file);
    written_value(g, mesh);
    o.quantize = 1;
    o.turn = BVX_TURN_Z_TO_Y;
    file_value(g, "quantized", bvx_write_mesh(g->context, levels, 2, &o, BVX_FORMAT_GLB, &file), &file);
    golden_end(g);
}

/* Colours by position on one mesh, carried to another. */
static void carried(golden *g, bvx_mesh *source, bvx_mesh *target)
{
    static uint8_t colours[4 * 20000];

    if (source->vertex_count > 20000) return;
    for (uint64_t i = 0; i < source->vertex_count * 4; i++) colours[i] = (uint8_t)(i * 37 % 251);
    golden_begin(g, "carried");
    source->colours = colours;
    if (golden_good(g, bvx_mesh_carry(g->context, source, target)))
        golden_hex(g, "colours", bvx_hash(target->colours, (size_t)target->vertex_count * 4, 0));
    source->colours = NULL;
    golden_end(g);
}

static void dense_values(golden *g, const bvx_mesh_view *view, const bvx_lattice *lattice)
{
    static float values[1 << 16];
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_field field = {0};

    golden_begin(g, "dense");
    o.features = 1;
    o.half_width = 1;
    if (golden_good(g, bvx_measure_field(g->context, view, lattice, &o, &field))) {
        uint64_t const voxels = (uint64_t)field.band.size[0] * (uint64_t)field.band.size[1] *
                                (uint64_t)field.band.size[2];
        if (voxels <= sizeof values / sizeof values[0] &&
            golden_good(g, bvx_field_dense(g->context, &field, 0, values))) {
            uint64_t h = 0;
            for (uint64_t i = 0; i < voxels; i++) {
                double const v = (double)values[i];
                h = mixed_doubles(h, &v, 1);
            }
            golden_hex(g, "distances", h);
            h = 0;
            for (int32_t x = 0; x < field.band.size[0]; x++)
                h = mixed_word(h, bvx_field_value(&field, x, field.band.size[1] / 2, field.band.size[2] / 2));
            golden_hex(g, "numbers", h);
        }
    }
    bvx_field_free(g->context, &field);
    golden_end(g);
}

static void file_cases(golden *g)
{
    bvx_mesh_view view;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice lattice;
    bvx_grid solid = {0};
    bvx_extract_options o = {.struct_size = sizeof o};
    bvx_mesh parts[1] = {{0}}, merged = {0};

    shape_torus(&golden_shape, 24, 12, 0.25, 5);
    shape_view(&golden_shape, &view);
    fit.resolution = 30;
    fit.padding = 1;
    o.keys = 1;
    if (bvx_lattice_fit_with(g->context, &view, &fit, &lattice) == BVX_OK &&
        bvx_voxelize_solid(g->context, &view, &lattice, NULL, &solid) == BVX_OK &&
        bvx_extract_surface(g->context, &solid, &o, &parts[0]) == BVX_OK) {
        grid_files(g, &solid);
        dense_values(g, &view, &lattice);
        golden_begin(g, "merged");
        if (golden_good(g, bvx_mesh_merge(g->context, parts, 1, &merged))) {
            uint64_t hash = 0;
            if (golden_good(g, bvx_mesh_hash(g->context, &merged, &hash))) golden_hex(g, "mesh", hash);
        }
        golden_end(g);
        mesh_files(g, &merged);
        finite_mesh(g, &merged);
        mesh_files_with(g, &merged, &parts[0]);
        carried(g, &parts[0], &merged);
    }
    bvx_mesh_free(g->context, &merged);
    bvx_mesh_free(g->context, &parts[0]);
    bvx_grid_free(g->context, &solid);
}

/* ---- Pictures ---- */

static void picture_value(golden *g, const char *key, bvx_status status, bvx_image *image)
{
    bvx_buffer file = {0};
    if (golden_good(g, status)) file_value(g, key, bvx_write_png(g->context, image, &file), &file);
    bvx_image_free(g->context, image);
}

static void picture_cases(golden *g)
{
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_grid solid = {0}, thin = {0};
    bvx_render_options o = {.struct_size = sizeof o};
    bvx_surface_options s = {.struct_size = sizeof s};
    bvx_image image = {0};

    shape_torus(&golden_shape, 48, 20, 0.25, 7);
    shape_view(&golden_shape, &view);
    s.mode = BVX_SURFACE_THIN;
    o.width = 160;
    o.height = 120;
    golden_begin(g, "torus");
    if (golden_good(g, bvx_lattice_fit(g->context, &view, 40, &lattice)) &&
        golden_good(g, bvx_voxelize_solid(g->context, &view, &lattice, NULL, &solid)) &&
        golden_good(g, bvx_voxelize_surface(g->context, &view, &lattice, &s, &thin))) {
        picture_value(g, "mesh", bvx_render_mesh(g->context, &view, &o, &image), &image);
        picture_value(g, "grid", bvx_render_grid(g->context, &solid, &o, &image), &image);
        picture_value(g, "difference", bvx_render_difference(g->context, &solid, &thin, &o, &image), &image);
    }
    golden_end(g);
    bvx_grid_free(g->context, &thin);
    bvx_grid_free(g->context, &solid);
}

#endif
