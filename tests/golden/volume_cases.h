/* volume_cases.h - golden cases of scalar volumes: thresholds, surfaces of
 * levels, labels and files; read in by golden.c. */
#ifndef VOLUME_CASES_H
#define VOLUME_CASES_H

enum {
    VOLUME_X = 37,
    VOLUME_Y = 21,
    VOLUME_Z = 19,
    VOLUME_SAMPLES = VOLUME_X * VOLUME_Y * VOLUME_Z,
    VOLUME_TYPES = 10
};

static const char *const sample_names[1 + VOLUME_TYPES] = {"",    "u8",  "i8",  "u16", "i16", "u32",
                                                           "i32", "u64", "i64", "f32", "f64"};
static const int sample_bytes[1 + VOLUME_TYPES] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};

/* ---- Samples: a ragged bowl of whole numbers from 0 to 2078, spread over each type ---- */

static int32_t bowl_sample(int32_t i)
{
    static int32_t bowl[VOLUME_SAMPLES];

    if (bowl[VOLUME_SAMPLES - 1] == 0) {
        uint64_t state = 23;
        for (int32_t n = 0; n < VOLUME_SAMPLES; n++) {
            int32_t const x = n % VOLUME_X - 18;
            int32_t const y = n / VOLUME_X % VOLUME_Y - 10;
            int32_t const z = n / VOLUME_X / VOLUME_Y - 9;
            bowl[n] = 3 * x * x + 5 * y * y + 7 * z * z + (int32_t)((shape_random(&state) >> 40) % 40);
        }
    }
    return bowl[i];
}

/* The bits of sample i; floats have some samples that are no number or infinite. */
static uint64_t sample_bits(int32_t type, int32_t i)
{
    int64_t const v = bowl_sample(i);
    double const d = (double)(v - 700) / 3.0;
    float const f = (float)d;
    uint64_t bits = 0;
    uint32_t half = 0;
    int const odd = i % 211 == 5 ? 1 + i / 211 % 3 : 0; /* NaN, infinity, -infinity */

    switch (type) {
    case BVX_SAMPLE_U8: return (uint64_t)(v / 9);
    case BVX_SAMPLE_I8: return (uint64_t)(v / 9 - 115);
    case BVX_SAMPLE_U16: return (uint64_t)(v * 30);
    case BVX_SAMPLE_I16: return (uint64_t)(v * 15 - 16000);
    case BVX_SAMPLE_U32: return (uint64_t)(v * 2000003);
    case BVX_SAMPLE_I32: return (uint64_t)(v * 1000003 - 1000000000);
    case BVX_SAMPLE_U64: return ((uint64_t)v << 52) + 1;
    case BVX_SAMPLE_I64: return (uint64_t)((v - 1000) * (INT64_C(1) << 52) - 1);
    case BVX_SAMPLE_F32:
        if (odd != 0) return odd == 1 ? 0x7fc00000 : odd == 2 ? 0x7f800000 : 0xff800000;
        memcpy(&half, &f, sizeof half);
        return half;
    default:
        if (odd != 0)
            return odd == 1   ? UINT64_C(0x7ff8000000000000)
                   : odd == 2 ? UINT64_C(0x7ff0000000000000)
                              : UINT64_C(0xfff0000000000000);
        memcpy(&bits, &d, sizeof bits);
        return bits;
    }
}

/* Bits as the bytes of a number, the highest first or last. */
static void put_bytes(uint8_t *at, uint64_t bits, int size, int big)
{
    for (int k = 0; k < size; k++) at[big ? size - 1 - k : k] = (uint8_t)(bits >> 8 * k & 0xff);
}

static int this_machine_is_big(void)
{
    uint16_t const one = 1;
    uint8_t first;
    memcpy(&first, &one, 1);
    return first == 0;
}

/* All samples in this machine's order: packed with x fastest, or (turned) z
 * fastest and all axes backwards. The memory holds 8 bytes for each. */
static void volume_of(golden *g, int32_t type, int turned, uint8_t *memory, bvx_volume_view *view)
{
    static const double origin[3] = {-3.25, 10.5, 0.1}, spacing[3] = {0.5, 0.75, 1.3};
    static const int32_t dims[3] = {VOLUME_X + 3, VOLUME_Y, VOLUME_Z + 1};
    static const int32_t size[3] = {VOLUME_X, VOLUME_Y, VOLUME_Z};
    int64_t const bytes = sample_bytes[type];

    memset(view, 0, sizeof *view);
    if (!golden_good(g, bvx_lattice_make(g->context, origin, spacing, dims, &view->lattice))) return;
    view->sample_type = type;
    view->low[0] = 2;
    memcpy(view->size, size, sizeof size);
    view->strides[0] = turned ? -bytes * VOLUME_Z * VOLUME_Y : bytes;
    view->strides[1] = turned ? -bytes * VOLUME_Z : bytes * VOLUME_X;
    view->strides[2] = turned ? -bytes : bytes * VOLUME_X * VOLUME_Y;
    view->samples = memory + (turned ? bytes * (VOLUME_SAMPLES - 1) : 0);
    for (int32_t i = 0; i < VOLUME_SAMPLES; i++) {
        int64_t const x = i % VOLUME_X, y = i / VOLUME_X % VOLUME_Y, z = i / VOLUME_X / VOLUME_Y;
        uint8_t *const first = memory + (turned ? bytes * (VOLUME_SAMPLES - 1) : 0);
        put_bytes(first + x * view->strides[0] + y * view->strides[1] + z * view->strides[2],
                  sample_bits(type, i), (int)bytes, this_machine_is_big());
    }
}

/* ---- Thresholds, surfaces, labels ---- */

static void threshold_values(golden *g, uint8_t *memory)
{
    static const double range[1 + VOLUME_TYPES][2] = {{0, 0},
                                                      {20, 99.5},
                                                      {-100, -20},
                                                      {1000, 20000},
                                                      {-15000, -2000.5},
                                                      {1e8, 1.5e9},
                                                      {-9e8, 5e8},
                                                      {4503599627370497.0, 9007199254740992e3},
                                                      {-4e18, 1e18},
                                                      {-100, 100.25},
                                                      {-1e300, 150}};

    golden_begin(g, "threshold");
    for (int32_t type = 1; type <= VOLUME_TYPES; type++) {
        bvx_volume_view view;
        bvx_volume_report r;
        bvx_grid grid = {0};
        uint64_t h;
        volume_of(g, type, type & 1, memory, &view);
        if (!golden_good(g, bvx_threshold(g->context, &view, range[type][0], range[type][1], &r, &grid)))
            continue;
        h = mixed_word(mixed_word(mixed_word(0, r.nan), r.infinite), r.inside);
        golden_u64(g, sample_names[type], r.inside);
        golden_hex(g, "report", mixed_doubles(mixed_doubles(h, &r.least, 1), &r.greatest, 1));
        grid_value(g, "bits", &grid);
    }
    golden_end(g);

    golden_begin(g, "threshold_whole");
    for (int32_t type = BVX_SAMPLE_U64; type <= BVX_SAMPLE_I64; type++) {
        bvx_volume_view view;
        bvx_grid grid = {0};

        volume_of(g, type, type & 1, memory, &view);
        if (golden_good(g, bvx_threshold_whole(g->context, &view, INT64_C(1) << 60, INT64_MAX, NULL, &grid)))
            grid_value(g, sample_names[type], &grid);
    }
    golden_end(g);
}

static void keyed_value(golden *g, const char *key, bvx_status status, bvx_mesh *mesh)
{
    uint64_t h = 0;

    if (golden_good(g, status) && golden_good(g, bvx_mesh_hash(g->context, mesh, &h))) {
        for (uint64_t i = 0; mesh->vertex_keys != NULL && i < mesh->vertex_count; i++)
            h = mixed_word(h, mesh->vertex_keys[i]);
        for (uint64_t i = 0; mesh->triangle_keys != NULL && i < mesh->triangle_count; i++)
            h = mixed_word(h, mesh->triangle_keys[i]);
        golden_u64(g, key, mesh->triangle_count);
        golden_hex(g, "mesh", h);
    }
    bvx_mesh_free(g->context, mesh);
}

static void scalar_values(golden *g, uint8_t *memory)
{
    static const struct {
        const char *name;
        int32_t type, below, join, f64, open, keys, local;
        double level;
    } cases[] = {
        {"u8", BVX_SAMPLE_U8, 1, 0, 0, 0, 1, 0, 70},
        {"i16", BVX_SAMPLE_I16, 1, 1, 1, 63, 1, 1, -4000},
        {"u64", BVX_SAMPLE_U64, 0, 0, 1, 0, 0, 0, 3e18},
        {"f32", BVX_SAMPLE_F32, 0, 0, 0, 0, 1, 0, 0},
        {"below", BVX_SAMPLE_F32, 1, 1, 1, 21, 0, 0, 33.5},
        {"f64", BVX_SAMPLE_F64, 1, 0, 1, 0, 1, 1, 1.0 / 3.0},
        {"local", BVX_SAMPLE_F64, 0, 1, 0, 42, 1, 1, -77},
    };
    golden_begin(g, "surface");
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        bvx_volume_view view;
        bvx_scalar_options o = {.struct_size = sizeof o};
        bvx_mesh mesh = {0};
        volume_of(g, cases[i].type, (int)(i & 1), memory, &view);
        o.level = cases[i].level;
        o.below = cases[i].below;
        o.face_rule = cases[i].join ? BVX_FACE_JOIN : BVX_FACE_SEPARATE;
        o.position_type = cases[i].f64 ? BVX_F64 : BVX_F32;
        o.open_sides = cases[i].open;
        o.keys = cases[i].keys;
        o.local_frame = cases[i].local;
        keyed_value(g, cases[i].name, bvx_extract_scalar(g->context, &view, &o, &mesh), &mesh);
    }
    golden_end(g);
}

static void label_values(golden *g, uint8_t *memory)
{
    static bvx_label labels[VOLUME_SAMPLES];

    golden_begin(g, "labels");
    for (int32_t type = 1; type <= BVX_SAMPLE_I64; type++) {
        bvx_volume_view view;
        uint64_t count = 0, h = 0;
        volume_of(g, type, type & 1, memory, &view);
        if (!golden_good(g, bvx_list_labels(g->context, &view, labels, VOLUME_SAMPLES, &count))) continue;
        for (uint64_t i = 0; i < count; i++) {
            h = mixed_word(mixed_word(h, (uint64_t)labels[i].value), labels[i].voxels);
            h = mixed_integers(mixed_integers(h, labels[i].low, 3), labels[i].size, 3);
        }
        golden_u64(g, sample_names[type], count);
        golden_hex(g, "boxes", h);
    }
    golden_end(g);
}

static void label_surface_values(golden *g, uint8_t *memory)
{
    if (golden_skips(g, "label_surfaces")) return;
    golden_begin(g, "label_surfaces");
    for (int32_t type = 1; type <= BVX_SAMPLE_I64; type++) {
        bvx_labels_options o = {.struct_size = sizeof o};
        bvx_complex complex_ = {0};
        bvx_mesh mesh = {0};
        bvx_volume_view view;
        uint64_t whole = 0, body = 0;

        volume_of(g, type, type & 1, memory, &view);
        o.staircase = type == BVX_SAMPLE_U16;
        o.position_type = type == BVX_SAMPLE_I32 ? BVX_F64 : BVX_F32;
        if (!golden_good(g, bvx_label_surfaces(g->context, &view, &o, &complex_)) ||
            !golden_good(g, bvx_label_mesh(g->context, &complex_, complex_.label_count / 2, &mesh)) ||
            !golden_good(g, bvx_mesh_hash(g->context, &complex_.mesh, &whole)) ||
            !golden_good(g, bvx_mesh_hash(g->context, &mesh, &body)))
            continue;
        golden_u64(g, sample_names[type], complex_.face_count);
        golden_hex(g, "whole", whole);
        golden_hex(g, "body", body);
        bvx_mesh_free(g->context, &mesh);
        bvx_complex_free(g->context, &complex_);
    }
    golden_end(g);
}

/* Slabs that are askew to each other: junctions of three labels and points of four. */
enum { SLABS = 24 };
static int make_slabs(golden *g, uint8_t *memory, bvx_volume_view *view)
{
    static double const origin[3] = {-7, 0.5, 100}, spacing[3] = {1, 0.75, 1.5};
    static int32_t const dims[3] = {SLABS, SLABS, SLABS};

    *view = (bvx_volume_view){.samples = memory, .sample_type = BVX_SAMPLE_U8, .size = {SLABS, SLABS, SLABS}};
    for (int32_t n = 0; n < SLABS * SLABS * SLABS; n++) {
        int32_t const x = n % SLABS, y = n / SLABS % SLABS, z = n / SLABS / SLABS;
        memory[n] = (uint8_t)((x + 2 * y) / 13 + (3 * z + y) / 17 * 3) % 7;
    }
    return golden_good(g, bvx_lattice_make(g->context, origin, spacing, dims, &view->lattice));
}

/* Both halves as open windows. */
static void label_open_values(golden *g, uint8_t *memory)
{
    bvx_volume_view view;

    if (golden_skips(g, "label_surfaces_open")) return;
    golden_begin(g, "label_surfaces_open");
    if (!make_slabs(g, memory, &view)) return;
    view.size[2] = SLABS / 2 + 1;
    for (int32_t n = 0; n < 4; n++) {
        bvx_labels_options o = {.struct_size = sizeof o, .open = 1};
        bvx_complex complex_ = {0};
        uint64_t whole = 0;

        o.triangles = n < 2 ? 0 : 1500;
        view.low[2] = n % 2 == 0 ? 0 : SLABS / 2 - 1;
        view.samples = memory + SLABS * SLABS * view.low[2];
        if (!golden_good(g, bvx_label_surfaces(g->context, &view, &o, &complex_)) ||
            !golden_good(g, bvx_mesh_hash(g->context, &complex_.mesh, &whole)))
            continue;
        golden_u64(g, n % 2 == 0 ? "low" : "high", complex_.face_count);
        golden_hex(g, "whole", whole);
        bvx_complex_free(g->context, &complex_);
    }
    golden_end(g);
}

static void label_fewer_values(golden *g, uint8_t *memory)
{
    bvx_volume_view view;

    if (golden_skips(g, "label_surfaces_fewer")) return;
    golden_begin(g, "label_surfaces_fewer");
    if (!make_slabs(g, memory, &view)) return;
    for (int32_t by_error = 0; by_error < 2; by_error++) {
        bvx_labels_options o = {.struct_size = sizeof o, .position_type = by_error ? BVX_F64 : BVX_F32};
        bvx_complex complex_ = {0};
        uint64_t whole = 0;

        o.triangles = by_error ? 0 : 2000;
        o.error = by_error ? 0.05 : 0;
        if (!golden_good(g, bvx_label_surfaces(g->context, &view, &o, &complex_)) ||
            !golden_good(g, bvx_mesh_hash(g->context, &complex_.mesh, &whole)))
            continue;
        golden_u64(g, by_error ? "error" : "count", complex_.face_count);
        golden_hex(g, "whole", whole);
        for (uint64_t i = 0; i < 2 * complex_.face_count; i++)
            whole = whole * UINT64_C(0x9E3779B97F4A7C15) + complex_.sides[i]; /* of any byte order */
        golden_hex(g, "sides", whole);
        bvx_complex_free(g->context, &complex_);
    }
    golden_end(g);
}

/* ---- Files ---- */

/* The numbers of a volume whatever its layout, and where they stand in the world. */
static uint64_t mixed_volume(const bvx_volume_view *v)
{
    int const bytes = sample_bytes[v->sample_type], big = this_machine_is_big();
    int64_t const packed[3] = {bytes, (int64_t)bytes * v->size[0], (int64_t)bytes * v->size[0] * v->size[1]};
    const int64_t *const step = v->strides[0] == 0 && v->strides[1] == 0 && v->strides[2] == 0 ? packed
                                                                                               : v->strides;
    uint64_t h = mixed_doubles(mixed_doubles((uint64_t)v->sample_type, v->lattice.origin, 3),
                               v->lattice.spacing, 3);

    h = mixed_integers(mixed_integers(h, v->lattice.dims, 3), v->size, 3);
    for (int32_t z = 0; z < v->size[2]; z++)
        for (int32_t y = 0; y < v->size[1]; y++)
            for (int32_t x = 0; x < v->size[0]; x++) {
                const uint8_t *const at = (const uint8_t *)v->samples + x * step[0] + y * step[1] +
                                          z * step[2];
                uint64_t bits = 0;
                for (int k = 0; k < bytes; k++) bits |= (uint64_t)at[big ? bytes - 1 - k : k] << 8 * k;
                h = mixed_word(h, bits);
            }
    return h;
}

/* "Packed" data that is what it stands for. */
static int32_t unpack_as_it_is(void *user, const void *packed, uint64_t packed_size, void *plain,
                               uint64_t plain_size)
{
    (void)user;
    if (packed_size != plain_size) return 1;
    memcpy(plain, packed, (size_t)plain_size);
    return 0;
}

static void read_value(golden *g, const char *key, const uint8_t *file, size_t size, int32_t format,
                       int32_t raw_type)
{
    bvx_read_volume_options o = {.struct_size = sizeof o};
    bvx_volume volume = {0};

    o.inflate = unpack_as_it_is;
    if (format == BVX_FORMAT_RAW) {
        o.sample_type = raw_type;
        o.big_endian = 1;
        o.size[0] = VOLUME_X;
        o.size[1] = VOLUME_Y;
        o.size[2] = VOLUME_Z;
        o.offset = 3;
        o.origin[1] = 0.1;
        o.spacing[2] = 1.7;
    }
    if (golden_good(g, bvx_read_volume(g->context, file, size, format, &o, &volume)))
        golden_hex(g, key, mixed_volume(&volume.view));
    bvx_volume_free(g->context, &volume);
}

/* The samples behind a head, as bytes of either order or as a text of thousandths. */
static size_t put_samples(uint8_t *file, size_t at, int32_t type, int big)
{
    for (int32_t i = 0; i < VOLUME_SAMPLES; i++, at += (size_t)sample_bytes[type])
        put_bytes(file + at, sample_bits(type, i), sample_bytes[type], big);
    return at;
}

static size_t put_text(uint8_t *file, size_t at, const char *end)
{
    for (int32_t i = 0; i < VOLUME_SAMPLES; i++)
        at += (size_t)sprintf((char *)file + at, "%de-3%s", (int)bowl_sample(i) - 900,
                              i % 7 == 6 ? "\n" : " ");
    return at + (size_t)sprintf((char *)file + at, "%s", end);
}

static size_t put_npy_head(uint8_t *file, const char *type, int fortran)
{
    char dict[119];
    snprintf(dict, sizeof dict, "{'descr': '%s', 'fortran_order': %s, 'shape': (%d, %d, %d), }", type,
             fortran ? "True" : "False", VOLUME_X, VOLUME_Y, VOLUME_Z);
    memcpy(file, "\x93NUMPY\x01\x00\x76\x00", 10); /* 118 bytes of head */
    sprintf((char *)file + 10, "%-117s\n", dict);
    return 128;
}

static void nrrd_values(golden *g, uint8_t *file)
{
    static const char head[] = "NRRD0004\ndimension: 3\nsizes: 37 21 19\n";
    size_t n;

    n = (size_t)sprintf(
        (char *)file, "%stype: int16\nencoding: raw\nendian: big\nspacings: 0.5 0.25 2\naxis mins: 1 2 3\n\n",
        head);
    read_value(g, "nrrd_i16_big", file, put_samples(file, n, BVX_SAMPLE_I16, 1), BVX_FORMAT_NRRD, 0);
    n = (size_t)sprintf(
        (char *)file,
        "%stype: int16\nencoding: raw\nendian: little\nspacings: 0.5 0.25 2\naxis mins: 1 2 3\n\n", head);
    read_value(g, "nrrd_i16_little", file, put_samples(file, n, BVX_SAMPLE_I16, 0), BVX_FORMAT_NRRD, 0);
    n = (size_t)sprintf(
        (char *)file,
        "%stype: double\nencoding: gzip\nendian: big\nspace: left-posterior-superior\nspace directions: (0.1,0,0) (0,0.3,0) (0,0,7)\n\n",
        head);
    read_value(g, "nrrd_f64_packed", file, put_samples(file, n, BVX_SAMPLE_F64, 1), BVX_FORMAT_NRRD, 0);
    n = (size_t)sprintf((char *)file, "%stype: float\nencoding: ascii\n\n", head);
    read_value(g, "nrrd_f32_text", file, put_text(file, n, ""), BVX_FORMAT_NRRD, 0);
    n = (size_t)sprintf((char *)file, "%stype: double\nencoding: ascii\n\n", head);
    read_value(g, "nrrd_f64_text", file, put_text(file, n, ""), BVX_FORMAT_NRRD, 0);
}

static void data_names(golden *g)
{
    static const char head[] =
        "NRRD0004\ndimension: 3\nsizes: 2 2 4\ntype: uint8\nencoding: raw\ndata file: part.%03d.raw 8 2 -2 2\n";
    uint64_t count = 0, h = 0;

    for (uint64_t i = 0; i < 4; i++) {
        char name[32] = "";
        if (golden_good(
                g, bvx_volume_data_name(g->context, head, sizeof head - 1, i, name, sizeof name, &count)))
            h = bvx_hash(name, strlen(name), h);
    }
    golden_u64(g, "names", count);
    golden_hex(g, "text", h);
}

static void read_values(golden *g)
{
    uint8_t *const file = malloc(16 * VOLUME_SAMPLES + 4096);
    size_t n;

    if (file == NULL) exit(2);
    golden_begin(g, "files");
    nrrd_values(g, file);
    data_names(g);
    n = put_npy_head(file, ">f4", 0);
    read_value(g, "npy_f4_big", file, put_samples(file, n, BVX_SAMPLE_F32, 1), BVX_FORMAT_NPY, 0);
    n = put_npy_head(file, "<u8", 1);
    read_value(g, "npy_u8_fortran", file, put_samples(file, n, BVX_SAMPLE_U64, 0), BVX_FORMAT_NPY, 0);
    n = put_npy_head(file, "<f2", 1);
    read_value(g, "npy_half", file, put_samples(file, n, BVX_SAMPLE_U16, 0), BVX_FORMAT_NPY, 0);
    n = (size_t)sprintf(
        (char *)file,
        "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 37 0 21 0 19\" Origin=\"0.1 0 0\" Spacing=\"1 0.3 1\">"
        "<Piece Extent=\"0 37 0 21 0 19\"><CellData Scalars=\"d\"><DataArray type=\"Float32\" Name=\"d\" format=\"ascii\">\n");
    read_value(g, "vti_text", file,
               put_text(file, n, "</DataArray></CellData></Piece></ImageData></VTKFile>\n"), BVX_FORMAT_VTI,
               0);
    memcpy(file, "abc", 3);
    read_value(g, "raw_i64", file, put_samples(file, 3, BVX_SAMPLE_I64, 1), BVX_FORMAT_RAW, BVX_SAMPLE_I64);
    golden_end(g);
    free(file);
}

static void volume_cases(golden *g)
{
    static uint8_t memory[8 * VOLUME_SAMPLES];
    threshold_values(g, memory);
    scalar_values(g, memory);
    label_values(g, memory);
    label_surface_values(g, memory);
    label_fewer_values(g, memory);
    label_open_values(g, memory);
    read_values(g);
}

#endif
