/* fuzz_volumes.c - random volumes of every type and layout, with NaN and infinities: thresholds and labels
 * are those of a count, the surface of a level is certified and of the size foretold, windows merge to the
 * whole's bytes, threads equal one, raw files of either byte order are read as what was written. */
#include "fuzz_input.h"

#include <math.h>

enum { FUZZ_VALUES = 8, FUZZ_SAMPLES = 140 * 10 * 10, FUZZ_STEPS = 6 };

typedef struct fuzz_volume {
    bvx_volume_view view;
    uint8_t memory[FUZZ_SAMPLES * 8 + 10 * 10 * FUZZ_STEPS + 10 * FUZZ_STEPS + 16];
    double value[FUZZ_SAMPLES];  /* packed, x fastest */
    uint64_t bits[FUZZ_SAMPLES]; /* of the number as it stands in memory */
    int bytes, floats;
} fuzz_volume;

static int fuzz_is_big(void)
{
    uint16_t const one = 1;
    uint8_t first;
    memcpy(&first, &one, 1);
    return first == 0;
}

static size_t fuzz_sample_count(const fuzz_volume *v)
{
    return (size_t)v->view.size[0] * (size_t)v->view.size[1] * (size_t)v->view.size[2];
}

/* ---- Volumes ---- */

/* A number of the type: small, so that a level meets it, or the least or greatest that the type has. */
static uint64_t fuzz_take_value(fuzz_input *in, const fuzz_volume *v, double *value)
{
    int const bits = 8 * v->bytes, kind = fuzz_range(in, 0, 15), is_signed = v->view.sample_type % 2 == 0;
    int32_t const small = fuzz_range(in, is_signed || v->floats ? -20 : 0, 20);
    uint64_t made = (uint64_t)(int64_t)small;
    float f;

    if (!v->floats) {
        if (kind == 0) made = is_signed ? UINT64_C(1) << (bits - 1) : 0;
        if (kind == 1) made = is_signed ? (UINT64_C(1) << (bits - 1)) - 1 : UINT64_MAX;
        if (bits < 64) made &= (UINT64_C(1) << bits) - 1;
        *value = (double)made;
        if (is_signed && (made >> (bits - 1)) != 0)
            *value = -(double)((bits < 64 ? UINT64_C(1) << bits : 0) - made);
        return made;
    }
    *value = kind == 0   ? (double)NAN
             : kind == 1 ? (double)INFINITY
             : kind == 2 ? -(double)INFINITY
             : kind == 3 ? 1e30
                         : small / 4.0;
    f = (float)*value;
    if (v->bytes == 4) {
        uint32_t half;
        memcpy(&half, &f, sizeof half);
        *value = (double)f;
        return half;
    }
    memcpy(&made, value, sizeof made);
    return made;
}

/* Axes in any order and direction, with gaps, at an odd address. */
static void fuzz_layout(fuzz_input *in, fuzz_volume *v)
{
    static const int orders[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    const int *const order = orders[fuzz_range(in, 0, 5)];
    int64_t step = v->bytes, first = fuzz_range(in, 0, 7);

    if (fuzz_range(in, 0, 3) == 0) { /* packed, and not said */
        v->view.samples = v->memory;
        return;
    }
    for (int n = 0; n < 3; n++) {
        int const a = order[n], back = fuzz_range(in, 0, 1);
        v->view.strides[a] = back ? -step : step;
        if (back) first += step * (v->view.size[a] - 1);
        step = step * v->view.size[a];
        if (n < 2) step += fuzz_range(in, 0, FUZZ_STEPS);
    }
    v->view.samples = v->memory + first;
}

static void fuzz_store(fuzz_volume *v)
{
    int64_t const packed[3] = {v->bytes, (int64_t)v->bytes * v->view.size[0],
                               (int64_t)v->bytes * v->view.size[0] * v->view.size[1]};
    const int64_t *const step = v->view.strides[0] == 0 ? packed : v->view.strides;
    int const big = fuzz_is_big();
    size_t i = 0;

    for (int32_t z = 0; z < v->view.size[2]; z++)
        for (int32_t y = 0; y < v->view.size[1]; y++)
            for (int32_t x = 0; x < v->view.size[0]; x++, i++) {
                uint8_t *const at = v->memory + ((const uint8_t *)v->view.samples - v->memory) + x * step[0] +
                                    y * step[1] + z * step[2];
                for (int k = 0; k < v->bytes; k++)
                    at[big ? v->bytes - 1 - k : k] = (uint8_t)(v->bits[i] >> 8 * k & 0xff);
            }
}

/* Few values, strewn or in slanted layers. */
static void fuzz_take_volume(fuzz_input *in, bvx_context *ctx, fuzz_volume *v)
{
    static const double origin[3] = {-1.5, 2.0, 0.25};
    static const int size_of[11] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    double value[FUZZ_VALUES], spacing[3];
    uint64_t bits[FUZZ_VALUES], state;
    int32_t dims[3], slope[3];
    int const values = fuzz_range(in, 1, FUZZ_VALUES);
    int const strewn = fuzz_range(in, 0, 2);
    int const most = fuzz_range(in, 0, 3) == 0 ? 140 : 24;

    memset(v, 0, sizeof *v);
    v->view.sample_type = fuzz_range(in, BVX_SAMPLE_U8, BVX_SAMPLE_F64);
    if (fuzz_range(in, 0, 2) == 0) v->view.sample_type = BVX_SAMPLE_F32;
    v->bytes = size_of[v->view.sample_type];
    v->floats = v->view.sample_type >= BVX_SAMPLE_F32;
    for (int a = 0; a < 3; a++) {
        v->view.low[a] = fuzz_range(in, 0, 3);
        v->view.size[a] = fuzz_range(in, 1, a == 0 ? most : 10);
        dims[a] = v->view.low[a] + v->view.size[a] + fuzz_range(in, 0, 2);
        spacing[a] = fuzz_range(in, 1, 12) / 8.0;
        slope[a] = fuzz_range(in, 0, 7);
    }
    fuzz_must(ctx, bvx_lattice_make(ctx, origin, spacing, dims, &v->view.lattice));
    for (int n = 0; n < values; n++) bits[n] = fuzz_take_value(in, v, &value[n]);
    state = fuzz_byte(in) * 2 + 1;
    for (size_t i = 0; i < fuzz_sample_count(v); i++) {
        int32_t const x = (int32_t)(i % (size_t)v->view.size[0]);
        int32_t const y = (int32_t)(i / (size_t)v->view.size[0] % (size_t)v->view.size[1]);
        int32_t const z = (int32_t)(i / (size_t)v->view.size[0] / (size_t)v->view.size[1]);
        int which;
        state ^= state << 13, state ^= state >> 7, state ^= state << 17;
        which = (slope[0] * x + slope[1] * y + slope[2] * z) / 8 % values;
        if (strewn == 2 || (strewn == 1 && (state >> 40 & 15) == 0))
            which = (int)((state >> 30) % (uint64_t)values);
        v->value[i] = value[which];
        v->bits[i] = bits[which];
    }
    fuzz_layout(in, v);
    fuzz_store(v);
}

/* ---- Thresholds and labels against a count ---- */

static int fuzz_finite(double v)
{
    return v - v == 0.0;
}

static void fuzz_report(const fuzz_volume *v, const bvx_volume_report *r, uint64_t inside)
{
    uint64_t nan = 0, infinite = 0;
    double least = HUGE_VAL, greatest = -HUGE_VAL;

    for (size_t i = 0; i < fuzz_sample_count(v); i++) {
        nan += v->value[i] != v->value[i];
        infinite += v->value[i] == v->value[i] && !fuzz_finite(v->value[i]);
        if (!fuzz_finite(v->value[i])) continue;
        if (v->value[i] < least) least = v->value[i];
        if (v->value[i] > greatest) greatest = v->value[i];
    }
    if (least > greatest) least = greatest = 0;
    fuzz_require(r->nan == nan && r->infinite == infinite && r->inside == inside,
                 "samples that are not counted");
    fuzz_require(r->least == least && r->greatest == greatest, "another least or greatest sample");
}

static void fuzz_threshold(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_volume *v)
{
    double const low = fuzz_range(in, 0, 7) == 0 ? -HUGE_VAL : fuzz_range(in, -80, 80) / 4.0;
    double const high = fuzz_range(in, 0, 7) == 0 ? HUGE_VAL : low + fuzz_range(in, -1, 40) / 4.0;
    bvx_volume_report report;
    bvx_grid grid = {0}, twin = {0};
    uint64_t inside = 0;
    size_t i = 0;

    fuzz_must(ctx, bvx_threshold(ctx, &v->view, low, high, &report, &grid));
    fuzz_must(other, bvx_threshold(other, &v->view, low, high, NULL, &twin));
    fuzz_good_calls += 2;
    fuzz_grids_equal(&grid, &twin, "another threshold with more threads");
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++, i++) {
                int const set = fuzz_finite(v->value[i]) && low <= v->value[i] && v->value[i] <= high;
                fuzz_require(bvx_grid_get(&grid, x, y, z) == set, "a voxel whose sample lies elsewhere");
                inside += (uint64_t)set;
            }
    fuzz_report(v, &report, inside);
    bvx_grid_free(ctx, &grid);
    bvx_grid_free(other, &twin);
}

/* Of integers between integers the same as between the doubles of these. */
static void fuzz_threshold_whole(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_volume *v)
{
    int64_t const low = fuzz_range(in, 1, 80), high = low + fuzz_range(in, -1, 40);
    bvx_grid grid = {0}, twin = {0};

    if (v->view.sample_type == BVX_SAMPLE_F32 || v->view.sample_type == BVX_SAMPLE_F64) return;
    fuzz_must(ctx, bvx_threshold_whole(ctx, &v->view, low, high, NULL, &grid));
    fuzz_must(other, bvx_threshold(other, &v->view, (double)low, (double)high, NULL, &twin));
    fuzz_good_calls += 2;
    fuzz_grids_equal(&grid, &twin, "another threshold of integers");
    bvx_grid_free(ctx, &grid);
    bvx_grid_free(other, &twin);
}

static int fuzz_above(const fuzz_volume *v, int64_t a, int64_t b)
{
    return v->view.sample_type == BVX_SAMPLE_U64 ? (uint64_t)a > (uint64_t)b : a > b;
}

/* What a label's value is of a sample's bits. */
static int64_t fuzz_label_of(const fuzz_volume *v, size_t i)
{
    int const bits = 8 * v->bytes;
    if (v->view.sample_type % 2 == 1 || bits == 64 || (v->bits[i] >> (bits - 1)) == 0)
        return (int64_t)v->bits[i];
    return -(int64_t)((UINT64_C(1) << bits) - v->bits[i]);
}

static void fuzz_labels(bvx_context *ctx, const fuzz_volume *v)
{
    bvx_label labels[FUZZ_VALUES];
    uint64_t count = 0, all = 0, zeros = 0;
    bvx_status const status = bvx_list_labels(ctx, &v->view, labels, FUZZ_VALUES, &count);

    if (v->floats) {
        fuzz_require(status == BVX_ERR_UNSUPPORTED, "labels of floats");
        return;
    }
    fuzz_must(ctx, status);
    fuzz_good_calls++;
    for (size_t i = 0; i < fuzz_sample_count(v); i++) zeros += v->bits[i] == 0;
    for (uint64_t n = 0; n < count; n++) {
        int32_t low[3] = {999, 999, 999}, high[3] = {-1, -1, -1};
        uint64_t voxels = 0;
        fuzz_require(n == 0 || fuzz_above(v, labels[n].value, labels[n - 1].value), "labels out of order");
        for (size_t i = 0; i < fuzz_sample_count(v); i++) {
            int32_t const at[3] = {(int32_t)(i % (size_t)v->view.size[0]),
                                   (int32_t)(i / (size_t)v->view.size[0] % (size_t)v->view.size[1]),
                                   (int32_t)(i / (size_t)v->view.size[0] / (size_t)v->view.size[1])};
            if (fuzz_label_of(v, i) != labels[n].value) continue;
            voxels++;
            for (int a = 0; a < 3; a++) {
                if (at[a] < low[a]) low[a] = at[a];
                if (at[a] > high[a]) high[a] = at[a];
            }
        }
        fuzz_require(labels[n].value != 0 && labels[n].voxels == voxels && voxels > 0,
                     "a label of other voxels");
        for (int a = 0; a < 3; a++)
            fuzz_require(labels[n].low[a] == low[a] && labels[n].size[a] == high[a] - low[a] + 1,
                         "a label in another box");
        all += voxels;
    }
    fuzz_require(all + zeros == fuzz_sample_count(v), "a label that is not listed");
}

/* Every body is manifold, and closed but in open windows, and has the volume of its voxels on the staircase; smoothed, nothing crosses. */
static void fuzz_label_surfaces(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_volume *v)
{
    bvx_labels_options o = {.struct_size = sizeof o};
    bvx_complex complex_ = {0}, twin = {0};
    bvx_mesh mesh = {0};
    bvx_mesh_view view;
    bvx_certificate c;
    uint64_t count, hash[2];

    if (v->floats) return;
    o.staircase = fuzz_range(in, 0, 1);
    o.local_frame = 1;
    if (!o.staircase && fuzz_range(in, 0, 1)) o.triangles = (uint64_t)fuzz_range(in, 1, 500);
    o.open = fuzz_range(in, 0, 1);
    fuzz_must(ctx, bvx_label_surfaces(ctx, &v->view, &o, &complex_));
    fuzz_must(other, bvx_label_surfaces(other, &v->view, &o, &twin));
    fuzz_good_calls += 2;
    fuzz_must(ctx, bvx_mesh_hash(ctx, &complex_.mesh, &hash[0]));
    fuzz_must(other, bvx_mesh_hash(other, &twin.mesh, &hash[1]));
    fuzz_require(hash[0] == hash[1], "another complex with more threads");
    bvx_mesh_view_of(&complex_.mesh, &view);
    fuzz_must(ctx, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
    fuzz_require(count == 0, "faces of labels that cross");
    for (uint64_t n = 0; n < complex_.label_count; n++) {
        fuzz_must(ctx, bvx_label_mesh(ctx, &complex_, n, &mesh));
        bvx_mesh_view_of(&mesh, &view);
        fuzz_must(ctx, bvx_mesh_check(ctx, &view, 0, &c));
        /* Labels inside of open windows have no faces there, and bodies of the staircase touch themselves in seams. */
        if (o.open && (o.staircase || c.triangles == 0)) continue;
        fuzz_require((c.closed || o.open) && c.edge_manifold && c.vertex_manifold && c.oriented &&
                         c.duplicates == 0,
                     "a label's body that is not certified");
    }
    bvx_mesh_free(ctx, &mesh);
    bvx_complex_free(ctx, &complex_);
    bvx_complex_free(other, &twin);
}

/* ---- Surfaces ---- */

static void fuzz_same_bytes(const bvx_mesh *a, const bvx_mesh *b, const char *what)
{
    size_t const position = a->position_type == BVX_F64 ? 24 : 12;
    fuzz_require(a->vertex_count == b->vertex_count && a->triangle_count == b->triangle_count, what);
    if (a->triangle_count == 0) return;
    fuzz_require(memcmp(a->positions, b->positions, (size_t)a->vertex_count * position) == 0 &&
                     memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * 12) == 0 &&
                     memcmp(a->vertex_keys, b->vertex_keys, (size_t)a->vertex_count * 8) == 0 &&
                     memcmp(a->triangle_keys, b->triangle_keys, (size_t)a->triangle_count * 8) == 0,
                 what);
}

/* Two windows that share a layer of samples, open where they meet. */
static void fuzz_halves(bvx_context *ctx, fuzz_input *in, const fuzz_volume *v,
                        const bvx_scalar_options *whole_options, const bvx_mesh *whole)
{
    int const axis = fuzz_range(in, 0, 2);
    const int32_t *const size = v->view.size;
    int64_t const packed[3] = {v->bytes, (int64_t)v->bytes * size[0], (int64_t)v->bytes * size[0] * size[1]};
    bvx_scalar_options o = *whole_options;
    bvx_volume_view half[2];
    bvx_mesh part[2] = {{0}, {0}}, merged = {0};
    int32_t at;

    if (size[axis] < 3) return;
    at = fuzz_range(in, 1, size[axis] - 2);
    o.report = NULL;
    for (int n = 0; n < 2; n++) {
        half[n] = v->view;
        if (v->view.strides[0] == 0) memcpy(half[n].strides, packed, sizeof packed);
        half[n].size[axis] = n == 0 ? at + 1 : size[axis] - at;
        if (n == 1) {
            half[n].low[axis] += at;
            half[n].samples = (const uint8_t *)half[n].samples + at * half[n].strides[axis];
        }
        o.open_sides = (n == 0 ? 2 : 1) << 2 * axis;
        fuzz_must(ctx, bvx_extract_scalar(ctx, &half[n], &o, &part[n]));
    }
    fuzz_must(ctx, bvx_mesh_merge(ctx, part, 2, &merged));
    fuzz_same_bytes(&merged, whole, "windows that do not merge to the whole");
    bvx_mesh_free(ctx, &part[0]);
    bvx_mesh_free(ctx, &part[1]);
    bvx_mesh_free(ctx, &merged);
}

/* As many vertices and triangles as the set of the samples inside foretells. */
static void fuzz_foretold(bvx_context *ctx, const fuzz_volume *v, const bvx_scalar_options *o,
                          const bvx_mesh *mesh)
{
    bvx_extract_options e = {.struct_size = sizeof e};
    bvx_grid inside = {0};
    uint64_t vertices = 0, triangles = 0;

    e.face_rule = o->face_rule;
    fuzz_must(ctx, bvx_threshold(ctx, &v->view, o->below ? -HUGE_VAL : o->level,
                                 o->below ? o->level : HUGE_VAL, NULL, &inside));
    fuzz_must(ctx, bvx_extract_count(ctx, &inside, &e, &vertices, &triangles));
    fuzz_require(mesh->vertex_count == vertices && mesh->triangle_count == triangles,
                 "a surface of another size than its voxels'");
    bvx_grid_free(ctx, &inside);
}

static void fuzz_scalar(bvx_context *ctx, bvx_context *other, fuzz_input *in, const fuzz_volume *v)
{
    bvx_scalar_options o = {.struct_size = sizeof o};
    bvx_volume_report report;
    bvx_mesh mesh = {0}, twin = {0};
    uint64_t inside = 0;

    o.level = fuzz_range(in, -80, 80) / 4.0;
    o.below = fuzz_range(in, 0, 1);
    o.face_rule = fuzz_range(in, 0, 1);
    o.position_type = fuzz_range(in, BVX_F32, BVX_F64);
    o.local_frame = fuzz_range(in, 0, 1);
    o.keys = 1;
    o.report = &report;
    fuzz_must(ctx, bvx_extract_scalar(ctx, &v->view, &o, &mesh));
    fuzz_good_calls++;
    fuzz_certified(ctx, &mesh, "a level's surface that is not certified");
    for (size_t i = 0; i < fuzz_sample_count(v); i++)
        inside += fuzz_finite(v->value[i]) && (o.below ? v->value[i] <= o.level : v->value[i] >= o.level);
    fuzz_report(v, &report, inside);
    fuzz_foretold(ctx, v, &o, &mesh);
    o.report = NULL;
    fuzz_must(other, bvx_extract_scalar(other, &v->view, &o, &twin));
    fuzz_same_bytes(&mesh, &twin, "another surface with more threads");
    fuzz_halves(ctx, in, v, &o, &mesh);
    bvx_mesh_free(ctx, &mesh);
    bvx_mesh_free(other, &twin);
}

/* ---- Files ---- */

static void fuzz_raw_file(bvx_context *ctx, fuzz_input *in, const fuzz_volume *v)
{
    size_t const count = fuzz_sample_count(v);
    size_t const before = (size_t)fuzz_range(in, 0, 9);
    size_t const bytes = (size_t)v->bytes;
    size_t const size = before + count * bytes;
    uint8_t *const file = malloc(size);
    bvx_read_volume_options o = {.struct_size = sizeof o};
    bvx_volume read = {0};

    o.sample_type = v->view.sample_type;
    o.big_endian = fuzz_range(in, 0, 1);
    o.offset = before;
    memcpy(o.size, v->view.size, sizeof o.size);
    fuzz_require(file != NULL, "no memory");
    memset(file, 0xa5, before);
    for (size_t i = 0; i < count * bytes; i++) {
        size_t const k = i % bytes;
        file[before + i] = (uint8_t)(v->bits[i / bytes] >> 8 * (o.big_endian ? bytes - 1 - k : k) & 0xff);
    }
    fuzz_must(ctx, bvx_read_volume(ctx, file, size, BVX_FORMAT_RAW, &o, &read));
    fuzz_require(memcmp(read.view.size, o.size, sizeof o.size) == 0 && read.view.sample_type == o.sample_type,
                 "a file of another shape or type");
    for (size_t i = 0; i < count; i++) {
        const uint8_t *const at = (const uint8_t *)read.view.samples + i * bytes;
        uint64_t bits = 0;
        for (size_t k = 0; k < bytes; k++) bits |= (uint64_t)at[fuzz_is_big() ? bytes - 1 - k : k] << 8 * k;
        fuzz_require(bits == v->bits[i], "a sample that was read as another");
    }
    bvx_volume_free(ctx, &read);
    if (size > before + bytes) {
        fuzz_require(bvx_read_volume(ctx, file, size - 1, BVX_FORMAT_RAW, &o, &read) == BVX_ERR_FORMAT,
                     "a file that is cut off");
        fuzz_require(read.view.samples == NULL, "a volume behind an error");
    }
    free(file);
}

static void fuzz_one(fuzz_input *in)
{
    static fuzz_volume v;
    bvx_context *const ctx = fuzz_context_with(1, BVX_CPU_PORTABLE);
    bvx_context *const other = fuzz_context_with(3, BVX_CPU_BEST);

    fuzz_take_volume(in, ctx, &v);
    fuzz_threshold(ctx, other, in, &v);
    fuzz_labels(ctx, &v);
    fuzz_label_surfaces(ctx, other, in, &v);
    fuzz_scalar(ctx, other, in, &v);
    fuzz_raw_file(ctx, in, &v);
    fuzz_threshold_whole(ctx, other, in, &v);
    fuzz_end(ctx);
    fuzz_end(other);
}
