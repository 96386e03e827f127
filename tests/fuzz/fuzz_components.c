/* fuzz_components.c - parts of grids, cavities, topology, clouds of points and
 * files of them: labels, lists and what is kept agree with each other; many threads
 * and fast kernels equal one portable thread; windows of clouds equal the whole. */
#include "fuzz_input.h"

enum { FUZZ_VOXELS = 150 * 12 * 12, FUZZ_TEXT = 400 };

static void fuzz_take_grid(bvx_context *ctx, fuzz_input *in, bvx_grid *g)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {fuzz_range(in, 1, 150), fuzz_range(in, 1, 12), fuzz_range(in, 1, 12)};
    uint64_t state = (uint64_t)fuzz_range(in, 0, 65535) * 2 + 1;
    int const dense = fuzz_range(in, 0, 3);
    bvx_lattice l;

    fuzz_must(ctx, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    fuzz_must(ctx, bvx_grid_create(ctx, &l, NULL, g));
    for (int32_t z = 0; z < dims[2]; z++)
        for (int32_t y = 0; y < dims[1]; y++)
            for (int32_t x = 0; x < dims[0]; x++) {
                state ^= state << 13, state ^= state >> 7, state ^= state << 17;
                bvx_grid_set(g, x, y, z, (int)(state >> 40 & 7) < 1 + 2 * dense);
            }
    for (int n = fuzz_range(in, 0, 6); n > 0; n--) { /* boxes, set or empty */
        int32_t low[3], high[3];
        int const set = fuzz_range(in, 0, 1);
        for (int a = 0; a < 3; a++) {
            low[a] = fuzz_range(in, 0, dims[a] - 1);
            high[a] = fuzz_range(in, low[a], dims[a] - 1);
        }
        for (int32_t z = low[2]; z <= high[2]; z++)
            for (int32_t y = low[1]; y <= high[1]; y++)
                for (int32_t x = low[0]; x <= high[0]; x++) bvx_grid_set(g, x, y, z, set);
    }
}

/* Labels count what the list says, begin where it says, and neighbours across faces share them. */
static uint64_t fuzz_labels(bvx_context *ctx, bvx_context *other, const bvx_grid *g, int32_t connectivity)
{
    static uint32_t labels[FUZZ_VOXELS], twin[FUZZ_VOXELS];
    static bvx_component parts[FUZZ_VOXELS];
    static uint64_t voxels[FUZZ_VOXELS + 1];
    uint64_t const n = (uint64_t)g->size[0] * (uint64_t)g->size[1] * (uint64_t)g->size[2];
    uint64_t const nx = (uint64_t)g->size[0], slice = nx * (uint64_t)g->size[1];
    uint64_t count = 0, labelled = 0;

    fuzz_must(ctx, bvx_grid_components(ctx, g, connectivity, parts, FUZZ_VOXELS, &count));
    fuzz_must(ctx, bvx_grid_label(ctx, g, connectivity, labels, n, &labelled));
    fuzz_must(other, bvx_grid_label(other, g, connectivity, twin, n, &labelled));
    fuzz_require(count == labelled && memcmp(labels, twin, (size_t)n * 4) == 0,
                 "other labels with more threads");
    memset(voxels, 0, (size_t)(count + 1) * sizeof voxels[0]);
    for (uint64_t i = 0; i < n; i++) {
        int32_t const x = (int32_t)(i % nx), y = (int32_t)(i % slice / nx), z = (int32_t)(i / slice);
        fuzz_require(labels[i] <= count && (labels[i] != 0) == bvx_grid_get(g, x, y, z),
                     "a label where no voxel is, or none");
        voxels[labels[i]]++;
        if (labels[i] == 0) continue;
        fuzz_require(voxels[labels[i]] > 1 || parts[labels[i] - 1].first == i, "a part begins elsewhere");
        fuzz_require(x == 0 || labels[i - 1] == 0 || labels[i - 1] == labels[i], "two labels along x");
        fuzz_require(y == 0 || labels[i - nx] == 0 || labels[i - nx] == labels[i], "two labels along y");
        fuzz_require(z == 0 || labels[i - slice] == 0 || labels[i - slice] == labels[i],
                     "two labels along z");
    }
    for (uint64_t i = 0; i < count; i++) {
        fuzz_require(parts[i].voxels == voxels[i + 1], "a part of another size");
        fuzz_require(i == 0 || parts[i].first > parts[i - 1].first, "parts out of order");
    }
    return count;
}

static void fuzz_keep(bvx_context *ctx, fuzz_input *in, const bvx_grid *g, int32_t connectivity,
                      uint64_t count)
{
    int32_t seeds[6];
    bvx_keep_options o = {.struct_size = sizeof o};
    bvx_keep_report r;
    bvx_grid kept = {0};
    uint64_t left = 0, parts = 0;

    for (int i = 0; i < 6; i++) seeds[i] = fuzz_range(in, 0, g->size[i % 3] - 1);
    o.connectivity = connectivity;
    o.at_least = (uint64_t)fuzz_range(in, 0, 9);
    o.largest = (uint64_t)fuzz_range(in, 0, 5);
    o.seeds = seeds;
    o.seed_count = (uint64_t)fuzz_range(in, 0, 2);
    o.report = &r;
    fuzz_must(ctx, bvx_grid_keep(ctx, g, &o, &kept));
    fuzz_must(ctx, bvx_grid_count(ctx, &kept, &left));
    fuzz_must(ctx, bvx_grid_components(ctx, &kept, connectivity, NULL, 0, &parts));
    fuzz_require(r.kept + r.dropped == count && r.kept == parts && r.voxels_kept == left,
                 "another number kept than told");
    fuzz_require(o.largest == 0 || parts <= o.largest, "too many kept");
    bvx_grid_free(ctx, &kept);
}

static void fuzz_topology(bvx_context *ctx, bvx_context *other, fuzz_input *in, bvx_grid *g)
{
    int32_t const connectivity = fuzz_range(in, 0, 1) ? 6 : 26;
    bvx_topology t, twin, after;
    uint64_t filled = 0;

    fuzz_must(ctx, bvx_grid_topology(ctx, g, connectivity, &t));
    fuzz_must(other, bvx_grid_topology(other, g, connectivity, &twin));
    fuzz_require(memcmp(&t, &twin, sizeof t) == 0, "another topology with more threads");
    fuzz_require(t.tunnels >= 0, "fewer tunnels than none");
    fuzz_must(ctx, bvx_grid_fill_cavities(ctx, g, connectivity == 6 ? 26 : 6, 0, g, &filled));
    fuzz_must(ctx, bvx_grid_topology(ctx, g, connectivity, &after));
    fuzz_require(after.cavities == 0 && after.voxels == t.voxels + filled &&
                     (filled != 0) == (t.cavities != 0),
                 "cavities that are left");
}

static void fuzz_cloud(bvx_context *ctx, fuzz_input *in)
{
    static fuzz_mesh m;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_points_options o = {.struct_size = sizeof o};
    bvx_points_report r;
    bvx_lattice lattice, boxed;
    bvx_grid whole = {0}, part = {0}, body = {0};
    double low_high[2][3], *const low = low_high[0], *const high = low_high[1];
    bvx_mesh_view const box = {.positions = low_high, .vertex_count = 2, .position_type = BVX_F64};

    fuzz_take_mesh(in, &m);
    m.view.triangle_count = 0;
    fit.resolution = fuzz_range(in, 1, 40);
    if (!fuzz_good(ctx, bvx_lattice_fit_with(ctx, &m.view, &fit, &lattice))) return;
    for (int a = 0; a < 3; a++) {
        low[a] = high[a] = m.v[0][a];
        for (uint64_t v = 1; v < m.vertices; v++) {
            low[a] = m.v[v][a] < low[a] ? m.v[v][a] : low[a];
            high[a] = m.v[v][a] > high[a] ? m.v[v][a] : high[a];
        }
    }
    fuzz_must(ctx, bvx_lattice_fit_with(ctx, &box, &fit, &boxed));
    fuzz_require(memcmp(&boxed, &lattice, sizeof boxed) == 0,
                 "the box of points has another lattice than they have");
    o.minimum = fuzz_range(in, 1, 5);
    o.report = &r;
    fuzz_must(ctx, bvx_voxelize_points(ctx, &m.view, &lattice, &o, &whole));
    fuzz_require(r.outside == 0 && r.inside == m.vertices,
                 "points beyond the lattice that was fitted to them");
    o.window = fuzz_take_window(in, &lattice);
    fuzz_must(ctx, bvx_voxelize_points(ctx, &m.view, &lattice, &o, &part));
    fuzz_part_equals_whole(&part, &whole, "a window that differs from the whole");
    memset(&o.window, 0, sizeof o.window);
    o.body = 1;
    o.close_gaps = fuzz_range(in, 0, 4);
    fuzz_must(ctx, bvx_voxelize_points(ctx, &m.view, &lattice, &o, &body));
    for (uint64_t i = 0; i < bvx_grid_bound(&lattice, NULL); i++)
        fuzz_require((whole.words[i] & ~body.words[i]) == 0, "a body that lacks voxels of its points");
    bvx_grid_free(ctx, &whole);
    bvx_grid_free(ctx, &part);
    bvx_grid_free(ctx, &body);
}

/* Texts of the characters that numbers, gaps and comments are made of. */
static void fuzz_text(bvx_context *ctx, fuzz_input *in)
{
    static const char letters[] = "0123456789..--+eE  \t,;\n\n\n#/%xn";
    char text[FUZZ_TEXT];
    int const size = fuzz_range(in, 0, FUZZ_TEXT);
    uint64_t state = (uint64_t)fuzz_range(in, 0, 65535) * 2 + 1;
    bvx_mesh m = {0};
    bvx_status status;

    for (int i = 0; i < size; i++) {
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        text[i] = i % 7 == 6 ? '\n' : letters[(state >> 33) % (sizeof letters - 1)];
    }
    status = bvx_read_points(ctx, text, (uint64_t)size, BVX_FORMAT_XYZ, &m);
    fuzz_require(status == BVX_OK || status == BVX_ERR_FORMAT || status == BVX_ERR_EMPTY ||
                     status == BVX_ERR_RANGE,
                 bvx_last_message(ctx));
    fuzz_require((status == BVX_OK) == (m.positions != NULL), "points behind an error");
    bvx_mesh_free(ctx, &m);
}

static void fuzz_one(fuzz_input *in)
{
    static const int32_t kinds[3] = {6, 18, 26};
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);
    int32_t const connectivity = kinds[fuzz_range(in, 0, 2)];
    bvx_grid g = {0};

    fuzz_take_grid(ctx, in, &g);
    fuzz_keep(ctx, in, &g, connectivity, fuzz_labels(ctx, other, &g, connectivity));
    fuzz_topology(ctx, other, in, &g);
    fuzz_cloud(ctx, in);
    fuzz_text(ctx, in);
    fuzz_good_calls++;
    bvx_grid_free(ctx, &g);
    fuzz_end(ctx);
    fuzz_end(other);
}
