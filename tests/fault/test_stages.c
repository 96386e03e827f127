/* test_stages.c - every stage with every allocation failing once, cancelled at every progress call, under
 * every memory limit, and in an arena with no other memory. After each failure results are empty, nothing is
 * held, and the same context does the work. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

#include <math.h>

/* ---- The heap of the C library, watched: these two stand in for src/core/heap.c, so that no call is missed  */

static uint64_t heap_calls;

void *bvxi_heap_alloc(void *user, size_t size, size_t align);
void bvxi_heap_free(void *user, void *block, size_t size, size_t align);

void *bvxi_heap_alloc(void *user, size_t size, size_t align)
{
    static fault_heap unused;
    (void)user;
    heap_calls++;
    return fault_alloc(&unused, size, align);
}

void bvxi_heap_free(void *user, void *block, size_t size, size_t align)
{
    (void)user, (void)block, (void)size, (void)align; /* what setup took stays until the program ends */
}

/* ---- Inputs, made once ---- */

enum { PARTS = 3 };

static maker_mesh star, holes; /* closed; with triangles missing and turned */
static bvx_mesh_view star_view, holes_view;
static bvx_lattice lattice, coarse;
static bvx_grid solid, small;
static bvx_mesh surface, part[PARTS];
static bvx_buffer file[4]; /* by format */
static bvx_context *maker; /* what made them */

static int make_inputs(void **state)
{
    static const double centre[3] = {17, 16, 15}, radius[3] = {14, 13, 12};
    uint64_t seed = 4711;
    bvx_context_options o = default_options();
    bvx_extract_options e = {.struct_size = sizeof e};

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.3, 9, 15, 65536);
    maker_star(&holes, &seed, centre, radius, 0.3, 9, 15, 65536);
    for (int i = 0; i < 9; i++) maker_remove(&holes, (size_t)maker_below(&seed, (int32_t)holes.triangles));
    maker_flip(&holes, 20, 40);
    star_view = maker_view(&star);
    holes_view = maker_view(&holes);
    assert_int_equal(bvx_lattice_fit(maker, &star_view, 70, &lattice), BVX_OK);
    assert_int_equal(bvx_voxelize_solid(maker, &star_view, &lattice, NULL, &solid), BVX_OK);
    assert_int_equal(bvx_extract_surface(maker, &solid, NULL, &surface), BVX_OK);
    assert_int_equal(bvx_lattice_fit(maker, &star_view, 16, &coarse), BVX_OK);
    assert_int_equal(bvx_voxelize_solid(maker, &star_view, &coarse, NULL, &small), BVX_OK);
    for (int32_t format = BVX_FORMAT_STL; format <= BVX_FORMAT_PLY; format++)
        assert_int_equal(bvx_write_mesh(maker, &surface, 1, NULL, format, &file[format]), BVX_OK);
    e.keys = 1;
    for (int32_t i = 0; i < PARTS; i++) { /* thirds along z that share a layer */
        bvx_window w = {{0, 0, 0}, {0, 0, 0}};
        bvx_voxelize_options v = {.struct_size = sizeof v};
        bvx_grid g = {0};
        memcpy(w.size, lattice.dims, sizeof w.size);
        w.low[2] = (lattice.dims[2] - 1) * i / PARTS;
        w.size[2] = (lattice.dims[2] - 1) * (i + 1) / PARTS - w.low[2] + 1;
        v.window = w;
        e.open_sides = (i > 0 ? BVX_OPEN_Z_LOW : 0) | (i < PARTS - 1 ? BVX_OPEN_Z_HIGH : 0);
        assert_int_equal(bvx_voxelize_solid(maker, &star_view, &lattice, &v, &g), BVX_OK);
        assert_int_equal(bvx_extract_surface(maker, &g, &e, &part[i]), BVX_OK);
        bvx_grid_free(maker, &g);
    }
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    maker_free(&star);
    maker_free(&holes);
    return 0;
}

/* ---- Stages: each frees what it got, leaves its mark, and says on failure whether its results are empty  */

static void note_left(const void *result, const void *before, size_t size)
{
    left_behind |= memcmp(result, before, size) != 0;
}

static bvx_status end_with_grid(bvx_context *ctx, bvx_status status, bvx_grid *grid)
{
    static const bvx_grid empty = {0};
    if (status == BVX_OK) {
        assert_int_equal(bvx_grid_hash(ctx, grid, &mark), BVX_OK);
        bvx_grid_free(ctx, grid);
    } else note_left(grid, &empty, sizeof empty);
    return status;
}

static bvx_status end_with_mesh(bvx_context *ctx, bvx_status status, bvx_mesh *mesh)
{
    static const bvx_mesh empty = {0};
    if (status == BVX_OK) {
        assert_int_equal(bvx_mesh_hash(ctx, mesh, &mark), BVX_OK);
        bvx_mesh_free(ctx, mesh);
    } else note_left(mesh, &empty, sizeof empty);
    return status;
}

static bvx_status end_with_buffer(bvx_context *ctx, bvx_status status, bvx_buffer *buffer)
{
    static const bvx_buffer empty = {0};
    if (status == BVX_OK) {
        mark = bvx_hash(buffer->bytes, (size_t)buffer->size, 0);
        bvx_buffer_free(ctx, buffer);
    } else note_left(buffer, &empty, sizeof empty);
    return status;
}

static bvx_status end_with_plain(bvx_status status, const void *report, size_t size)
{
    static const unsigned char empty[512] = {0};
    assert_true(size <= sizeof empty);
    if (status == BVX_OK) mark = bvx_hash(report, size, 0);
    else note_left(report, empty, size);
    return status;
}

static bvx_status voxelize(bvx_context *ctx, const bvx_mesh_view *view, int32_t fill)
{
    static const bvx_solid_report empty = {0};
    bvx_solid_report report = {0};
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_grid grid = {0};
    bvx_status status;

    o.fill = fill;
    o.report = &report;
    if (fill != BVX_FILL_BELOW) o.check_thin = BVX_CHECK_ALWAYS; /* by default it is left out under a limit */
    status = bvx_voxelize_solid(ctx, view, &lattice, &o, &grid);
    if (status != BVX_OK) note_left(&report, &empty, sizeof empty);
    else assert_true((report.unbalanced_rows != 0) == (view == &holes_view));
    return end_with_grid(ctx, status, &grid);
}

static bvx_status voxelize_parity(void *user, bvx_context *ctx)
{
    (void)user;
    return voxelize(ctx, &star_view, BVX_FILL_PARITY);
}
static bvx_status voxelize_nonzero(void *user, bvx_context *ctx)
{
    (void)user;
    return voxelize(ctx, &star_view, BVX_FILL_NONZERO);
}
static bvx_status voxelize_holes(void *user, bvx_context *ctx)
{
    (void)user;
    return voxelize(ctx, &holes_view, BVX_FILL_PARITY);
}
static bvx_status voxelize_holes_nonzero(void *user, bvx_context *ctx)
{
    (void)user;
    return voxelize(ctx, &holes_view, BVX_FILL_NONZERO);
}

static bvx_status extract(void *user, bvx_context *ctx)
{
    bvx_mesh mesh = {0};
    (void)user;
    return end_with_mesh(ctx, bvx_extract_surface(ctx, &solid, NULL, &mesh), &mesh);
}

static bvx_status extract_keys(void *user, bvx_context *ctx)
{
    bvx_extract_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};

    (void)user;
    o.keys = 1;
    o.position_type = BVX_F64;
    o.local_frame = 1;
    return end_with_mesh(ctx, bvx_extract_surface(ctx, &solid, &o, &mesh), &mesh);
}

static bvx_status extract_count(void *user, bvx_context *ctx)
{
    uint64_t count[2] = {0, 0};
    (void)user;
    return end_with_plain(bvx_extract_count(ctx, &solid, NULL, &count[0], &count[1]), count, sizeof count);
}

static bvx_status merge(void *user, bvx_context *ctx)
{
    bvx_mesh mesh = {0};
    (void)user;
    return end_with_mesh(ctx, bvx_mesh_merge(ctx, part, PARTS, &mesh), &mesh);
}

static bvx_status check(void *user, bvx_context *ctx)
{
    bvx_certificate certificate;
    (void)user;
    memset(&certificate, 0, sizeof certificate);
    return end_with_plain(bvx_mesh_check(ctx, &holes_view, 1, &certificate), &certificate,
                          sizeof certificate);
}

static bvx_status normals(void *user, bvx_context *ctx)
{
    enum { MOST = 512 };
    static const float empty[2][3 * MOST] = {{0}};
    static float vectors[2][3 * MOST];
    bvx_status status;
    (void)user;
    assert_true(star_view.vertex_count <= MOST && star_view.triangle_count <= MOST);
    memset(vectors, 0, sizeof vectors);
    status = bvx_mesh_normals(ctx, &star_view, 1, vectors[0], vectors[1]);
    if (status == BVX_OK) mark = bvx_hash(vectors, sizeof vectors, 0);
    else note_left(vectors, empty, sizeof vectors);
    return status;
}

static bvx_status smooth(void *user, bvx_context *ctx)
{
    enum { MOST = 512 };
    static double positions[3 * MOST];
    bvx_smooth_options const o = {.struct_size = sizeof o, .no_crossings = 1};
    (void)user;
    assert_true(star_view.vertex_count <= MOST);
    memset(positions, 0, sizeof positions);
    bvx_status const status = bvx_mesh_smooth(ctx, &star_view, &o, positions);
    if (status == BVX_OK) mark = bvx_hash(positions, sizeof positions, 0);
    return status;
}

/* Of triangles that have nothing to do with each other. */
static bvx_status crossings(void *user, bvx_context *ctx)
{
    enum { SOUP = 40, MOST = SOUP * SOUP };
    static float soup[9 * SOUP];
    static uint32_t pairs[2 * MOST];
    bvx_mesh_view view;
    uint64_t count, from = 5;
    bvx_status status;
    (void)user;
    for (int i = 0; i < 9 * SOUP; i++) soup[i] = (float)maker_below(&from, 1000);
    memset(&view, 0, sizeof view);
    view.positions = soup;
    view.position_type = BVX_F32;
    view.vertex_count = 3 * SOUP;
    view.triangle_count = SOUP;
    status = bvx_mesh_crossings(ctx, &view, &count, pairs, MOST);
    if (status == BVX_OK) {
        assert_true(count > 10);
        mark = bvx_hash(pairs, (size_t)count * 8, 0);
    } else note_left(&count, &(uint64_t){0}, sizeof count);
    return status;
}

/* Voxels counted over holes. */
static bvx_status mass(void *user, bvx_context *ctx)
{
    bvx_measure_options o = {.struct_size = sizeof o, .resolution = 12};
    bvx_measure_report report;
    (void)user;
    memset(&report, 0, sizeof report);
    return end_with_plain(bvx_measure(ctx, &holes_view, &o, &report), &report, sizeof report);
}

static bvx_status inspect(void *user, bvx_context *ctx)
{
    bvx_inspect_options o = {.struct_size = sizeof o, .walls = 1e9, .gaps = 1e9, .up = BVX_UP_X};
    bvx_inspect_report report;
    (void)user;
    o.fit.resolution = 12;
    memset(&report, 0, sizeof report);
    return end_with_plain(bvx_inspect(ctx, &holes_view, &o, &report), &report, sizeof report);
}

static bvx_status distance(void *user, bvx_context *ctx)
{
    bvx_distance_report report;
    bvx_mesh_view view;
    (void)user;
    memset(&report, 0, sizeof report);
    bvx_mesh_view_of(&surface, &view);
    return end_with_plain(bvx_mesh_distance(ctx, &star_view, &view, 500, 7, &report), &report, sizeof report);
}

static bvx_status read_file(bvx_context *ctx, int32_t format)
{
    bvx_mesh mesh = {0};
    return end_with_mesh(ctx, bvx_read_mesh(ctx, file[format].bytes, file[format].size, format, NULL, &mesh),
                         &mesh);
}

static bvx_status read_stl(void *user, bvx_context *ctx)
{
    (void)user;
    return read_file(ctx, BVX_FORMAT_STL);
}
static bvx_status read_obj(void *user, bvx_context *ctx)
{
    (void)user;
    return read_file(ctx, BVX_FORMAT_OBJ);
}
static bvx_status read_ply(void *user, bvx_context *ctx)
{
    (void)user;
    return read_file(ctx, BVX_FORMAT_PLY);
}

/* A file of doubles, then the mesh with a vertex that is not finite. */
static bvx_status read_finite(void *user, bvx_context *ctx)
{
    bvx_mesh mesh = {0};
    uint64_t dropped = 0;
    bvx_read_options options = {.struct_size = sizeof options};
    bvx_status status;

    (void)user;
    options.drop_nonfinite = 1;
    status = bvx_read_mesh(ctx, file[BVX_FORMAT_OBJ].bytes, file[BVX_FORMAT_OBJ].size, BVX_FORMAT_OBJ,
                           &options, &mesh);
    if (status == BVX_OK) {
        ((double *)mesh.positions)[0] = HUGE_VAL;
        status = bvx_mesh_drop_nonfinite(ctx, &mesh, &dropped);
        if (status == BVX_OK) assert_true(dropped > 0);
        else bvx_mesh_free(ctx, &mesh);
    }
    return end_with_mesh(ctx, status, &mesh);
}

/* Every kind of memory that a reader of glTF takes, and a file that is closed whatever happens. */
static const char gltf_text[] =
    "{\"asset\":{\"version\":\"2.0\"},\"nodes\":[{\"children\":[1,2]},{\"mesh\":0},{\"mesh\":0,\"translation\":[9,0,0]}],"
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"NORMAL\":0,\"TEXCOORD_0\":2,\"TEXCOORD_1\":2,"
    "\"COLOR_0\":0},\"indices\":1,\"material\":0},{\"attributes\":{\"POSITION\":0},\"mode\":5}]}],\"materials\":[{}],"
    "\"images\":[{\"uri\":\"a.png\"},{\"uri\":\"data:image\\/png;base64,AAAA\"},{\"bufferView\":0}],\"accessors\":["
    "{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\"},{\"bufferView\":1,\"componentType\":5121,"
    "\"count\":3,\"type\":\"SCALAR\"},{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC2\"}],"
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,\"byteLength\":3}],"
    "\"buffers\":[{\"byteLength\":39,\"uri\":\"data:;base64,AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAgD8AAAAAAAEC\"}]}";

static int32_t open_beside(void *user, const char *name, bvx_file_bytes *beside)
{
    (void)name;
    ++*(int *)user;
    beside->bytes = "abcd";
    beside->size = 4;
    return 0;
}

static void close_beside(void *user, bvx_file_bytes *beside)
{
    (void)beside;
    --*(int *)user;
}

static bvx_status read_gltf(void *user, bvx_context *ctx)
{
    int open = 0;
    bvx_mesh mesh = {0};
    bvx_read_options options = {.struct_size = sizeof options};
    bvx_status status;

    (void)user;
    options.open_file = open_beside;
    options.close_file = close_beside;
    options.user = &open;
    status = bvx_read_mesh(ctx, gltf_text, sizeof gltf_text - 1, BVX_FORMAT_GLTF, &options, &mesh);
    assert_int_equal(open, 0);
    return end_with_mesh(ctx, status, &mesh);
}

static bvx_status write_file(bvx_context *ctx, int32_t format)
{
    bvx_buffer buffer = {0};
    return end_with_buffer(ctx, bvx_write_mesh(ctx, &surface, 1, NULL, format, &buffer), &buffer);
}

static bvx_status write_stl(void *user, bvx_context *ctx)
{
    (void)user;
    return write_file(ctx, BVX_FORMAT_STL);
}
static bvx_status write_obj(void *user, bvx_context *ctx)
{
    (void)user;
    return write_file(ctx, BVX_FORMAT_OBJ);
}
static bvx_status write_ply(void *user, bvx_context *ctx)
{
    (void)user;
    return write_file(ctx, BVX_FORMAT_PLY);
}

static bvx_status write_npy(void *user, bvx_context *ctx)
{
    bvx_buffer buffer = {0};
    (void)user;
    return end_with_buffer(ctx, bvx_write_grid(ctx, &solid, BVX_FORMAT_NPY, &buffer), &buffer);
}

static bvx_status lods(bvx_context *ctx, const bvx_grid *grid, const bvx_lod_options *o)
{
    static const bvx_mesh empty[3] = {{0}};
    bvx_mesh level[3];
    bvx_status status;

    memset(level, 0, sizeof level);
    status = bvx_build_lods(ctx, grid, o, 3, level);
    if (status != BVX_OK) {
        note_left(level, empty, sizeof level);
        return status;
    }
    mark = 0;
    for (int i = 0; i < 3; i++) {
        uint64_t hash;
        assert_int_equal(bvx_mesh_hash(ctx, &level[i], &hash), BVX_OK);
        mark = mark * 31 + hash;
    }
    for (int i = 3; i-- > 0;) bvx_mesh_free(ctx, &level[i]);
    return status;
}

static bvx_status lods_by_resolution(void *user, bvx_context *ctx)
{
    static const int32_t resolutions[3] = {30, 17, 8};
    bvx_lod_options o = {.struct_size = sizeof o};
    (void)user;
    o.sampling.method = BVX_LOD_EDGE_RATIO;
    o.resolutions = resolutions;
    return lods(ctx, &solid, &o);
}

static bvx_status lods_by_coverage(void *user, bvx_context *ctx)
{
    static const int32_t resolutions[9] = {30, 20, 25, 14, 14, 15, 8, 9, 7};
    bvx_lod_options o = {.struct_size = sizeof o};
    (void)user;
    o.sampling.method = BVX_LOD_COVERAGE;
    o.axis_resolutions = resolutions;
    return lods(ctx, &solid, &o);
}

static bvx_status lods_by_target(void *user, bvx_context *ctx)
{
    static const uint64_t targets[3] = {500, 200, 60};
    bvx_lod_options o = {.struct_size = sizeof o};
    (void)user;
    o.target_triangles = targets;
    o.collapse = 3;
    return lods(ctx, &small, &o);
}

static bvx_status render(void *user, bvx_context *ctx)
{
    bvx_render_options o = {.struct_size = sizeof o};
    bvx_image image = {0}, empty;
    bvx_status status;

    (void)user;
    memset(&empty, 0, sizeof empty);
    o.width = 40;
    o.height = 30;
    o.samples = 1;
    o.smooth = 1;
    status = bvx_render_mesh(ctx, &star_view, &o, &image);
    if (status == BVX_OK) {
        mark = bvx_hash(image.pixels, (size_t)image.width * (size_t)image.height * 3, 0);
        bvx_image_free(ctx, &image);
    } else note_left(&image, &empty, sizeof empty);
    return status;
}

static fault_row stages[] = {
    {"voxelize, parity", voxelize_parity, 1, 1, 0},
    {"voxelize, nonzero", voxelize_nonzero, 1, 1, 0},
    {"voxelize, parity with holes", voxelize_holes, 1, 1, 0},
    {"voxelize, nonzero with holes", voxelize_holes_nonzero, 1, 1, 0},
    {"extract", extract, 1, 1, 0},
    {"extract with keys", extract_keys, 1, 1, 0},
    {"count", extract_count, 1, 1, 0},
    {"merge", merge, 1, 1, 0},
    {"check", check, 1, 1, 0},
    {"normals", normals, 1, 0, 0},
    {"smooth", smooth, 1, 1, 0},
    {"crossings", crossings, 1, 1, 0},
    {"mass", mass, 1, 1, 0},
    {"inspection", inspect, 1, 1, 0},
    {"distance", distance, 1, 1, 0},
    {"read STL", read_stl, 1, 1, 0},
    {"read OBJ", read_obj, 1, 1, 0},
    {"read PLY", read_ply, 1, 1, 0},
    {"read OBJ, finite", read_finite, 1, 1, 0},
    {"read glTF", read_gltf, 20, 1, 0},
    {"write STL", write_stl, 1, 0, 0},
    {"write OBJ", write_obj, 1, 0, 0},
    {"write PLY", write_ply, 1, 0, 0},
    {"write NPY", write_npy, 1, 0, 0},
    {"LOD by resolution", lods_by_resolution, 1, 1, 0},
    {"LOD by coverage", lods_by_coverage, 1, 1, 0},
    {"LOD by target", lods_by_target, 1, 1, 0},
    {"render", render, 1, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(stages));
}

static void test_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(stages));
}

/* More rows than the solid takes at once (65535 along an axis) are still
 * one stage, whose fraction only grows. */
static void test_progress_grows_over_several_blocks(void **state)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 0.0005, 1};
    static const int32_t dims[3] = {40, 70000, 1};

    (void)state;
    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
        fault_progress progress = {0};
        bvx_context_options o = default_options();
        bvx_voxelize_options v = {.struct_size = sizeof v};
        bvx_lattice l;
        bvx_grid grid = {0};
        bvx_context *ctx;
        o.progress.call = fault_on_progress;
        o.progress.user = &progress;
        o.threads = 1;
        ctx = context_with(&o);
        assert_int_equal(bvx_lattice_make(ctx, origin, spacing, dims, &l), BVX_OK);
        v.fill = fill;
        assert_int_equal(bvx_voxelize_solid(ctx, &holes_view, &l, &v, &grid), BVX_OK);
        assert_true(progress.calls > 10);
        if (progress.wrong != NULL) fail_msg("%s", progress.wrong);
        bvx_grid_free(ctx, &grid);
        bvx_context_destroy(ctx);
    }
}

static void test_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(stages), 60);
}

/* In an arena of every size the stage works, twice, or says that there is no memory; the heap is never
 * asked. */
static void test_stages_live_in_an_arena(void **state)
{
    enum { STEPS = 40 };
    size_t const most = (size_t)8 << 20;
    unsigned char *const memory = malloc(most + 16);
    (void)state;
    assert_non_null(memory);
    for (size_t i = 0; i < sizeof stages / sizeof *stages; i++) {
        int good = 0;

        begin_row(&stages[i]);
        uint64_t const calls = heap_calls;
        for (size_t n = 1; n <= STEPS; n++) {
            bvx_context_options o = default_options();
            size_t const size = n == STEPS ? most : most / 8 * n * n / STEPS / STEPS, skew = n % 16;
            bvx_context *ctx;
            bvx_status first, second;
            o.arena.memory = memory + skew;
            o.arena.size = size;
            o.threads = 1;
            memset(memory, 0xA5, skew);
            memset(memory + skew + size, 0xA5, 16 - skew);
            if (bvx_context_create(&o, &ctx) != BVX_OK) {
                assert_true(size < 4096); /* a context with its warnings */
                continue;
            }
            first = run_row(&stages[i], ctx);
            second = run_row(&stages[i], ctx);
            assert_int_equal(first, second);
            assert_true(first == BVX_OK || first == BVX_ERR_MEMORY);
            assert_int_equal(bvx_memory_used(ctx), 0);
            bvx_context_destroy(ctx);
            for (size_t k = 0; k < 16; k++)
                if (memory[k < skew ? k : size + k] != 0xA5)
                    fail_msg("%s: written outside the arena", stages[i].name);
            good += first == BVX_OK;
            if (n == STEPS) assert_int_equal(first, BVX_OK);
        }
        assert_true(good > 0);
        if (heap_calls != calls) fail_msg("%s: asked the heap though it had an arena", stages[i].name);
        end_row(&stages[i], NULL);
    }
    free(memory);
}

/* The main job from file to levels in one arena, results kept side by side. */
static void test_the_main_job_in_one_arena(void **state)
{
    static const int32_t resolutions[2] = {20, 9};
    size_t const most = (size_t)8 << 20;
    unsigned char *const memory = malloc(most);
    uint64_t const calls = heap_calls;
    bvx_context_options o = default_options();
    bvx_context *ctx;
    bvx_mesh mesh = {0}, whole = {0}, level[2];
    bvx_mesh_view view;
    bvx_lattice fitted;
    bvx_grid grid = {0};
    bvx_lod_options l = {.struct_size = sizeof l};
    bvx_buffer out = {0};
    bvx_certificate c;

    (void)state;
    assert_non_null(memory);
    memset(level, 0, sizeof level);
    o.arena.memory = memory;
    o.arena.size = most;
    o.threads = 2;
    ctx = context_with(&o);
    l.resolutions = resolutions;
    assert_int_equal(bvx_read_mesh(ctx, file[BVX_FORMAT_PLY].bytes, file[BVX_FORMAT_PLY].size, BVX_FORMAT_PLY,
                                   NULL, &mesh),
                     BVX_OK);
    bvx_mesh_view_of(&mesh, &view);
    assert_int_equal(bvx_lattice_fit(ctx, &view, 80, &fitted), BVX_OK);
    assert_int_equal(bvx_voxelize_solid(ctx, &view, &fitted, NULL, &grid), BVX_OK);
    assert_int_equal(bvx_extract_surface(ctx, &grid, NULL, &whole), BVX_OK);
    assert_int_equal(bvx_build_lods(ctx, &grid, &l, 2, level), BVX_OK);
    for (int i = 0; i < 2; i++) {
        bvx_mesh_view_of(&level[i], &view);
        assert_int_equal(bvx_mesh_check(ctx, &view, 0, &c), BVX_OK);
        assert_true(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented && c.volume > 0);
    }
    assert_int_equal(bvx_write_mesh(ctx, &level[1], 1, NULL, BVX_FORMAT_STL, &out), BVX_OK);
    bvx_mesh_free(ctx, &mesh); /* in an order of their own */
    bvx_grid_free(ctx, &grid);
    bvx_buffer_free(ctx, &out);
    bvx_mesh_free(ctx, &level[0]);
    bvx_mesh_free(ctx, &whole);
    bvx_mesh_free(ctx, &level[1]);
    assert_int_equal(bvx_memory_used(ctx), 0);
    bvx_context_destroy(ctx);
    assert_int_equal(heap_calls, calls);
    free(memory);
}

/* A failure after the caller's own arrays were taken leaves them his. */
static void test_callers_arrays_survive_failures(void **state)
{
    uint64_t const words = bvx_grid_bound(&lattice, NULL);
    uint64_t *const array = malloc((size_t)words * 8);

    (void)state;
    assert_non_null(array);
    for (uint64_t n = 1;; n++) {
        fault_heap heap = {0};
        bvx_context_options const base = default_options(), o = fault_options(&base, &heap);
        bvx_context *const ctx = context_with(&o);
        bvx_grid grid = {0}, before;
        bvx_voxelize_options by_rows = {.struct_size = sizeof by_rows};
        bvx_status status;
        uint64_t hash, want;
        grid.words = array;
        grid.word_capacity = words;
        before = grid;
        heap.asked = 0;
        heap.fail_at = n;
        by_rows.fill = BVX_FILL_PARITY;
        status = bvx_voxelize_solid(ctx, &holes_view, &lattice, &by_rows, &grid);
        if (status == BVX_OK) {
            begin_row(&stages[2]);
            want = stages[2].want;
            heap.fail_at = 0;
            assert_int_equal(bvx_grid_hash(ctx, &grid, &hash), BVX_OK);
            assert_int_equal(hash, want);
            bvx_grid_free(ctx, &grid);
        } else {
            assert_int_equal(status, BVX_ERR_MEMORY);
            assert_memory_equal(&grid, &before, sizeof grid);
        }
        assert_int_equal(bvx_memory_used(ctx), 0);
        bvx_context_destroy(ctx);
        assert_null(fault_end(&heap));
        if (status == BVX_OK) break;
    }
    free(array);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_cancel_at_every_progress_call),
        cmocka_unit_test(test_progress_grows_over_several_blocks),
        cmocka_unit_test(test_every_memory_limit),
        cmocka_unit_test(test_stages_live_in_an_arena),
        cmocka_unit_test(test_the_main_job_in_one_arena),
        cmocka_unit_test(test_callers_arrays_survive_failures),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
