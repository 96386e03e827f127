/* fuzz_grids.c - the readers of grids, volumes and lattices on damaged files: no crash, no leak, no more
 * memory than the file's size allows beside the grid; an error in words, or a valid grid that is written and
 * read to itself, and whose windows hold what it holds. */
#include "fuzz_files.h"

enum {
    FUZZ_NPY,
    FUZZ_BINVOX,
    FUZZ_VOX,
    FUZZ_NRRD,
    FUZZ_VTI,
    FUZZ_BVX,
    FUZZ_RAW,
    FUZZ_LATTICE,
    FUZZ_RAW_HEAD = 12,
    FUZZ_WORDS = 4096
};

static const fuzz_format formats[] = {
    {"npy", BVX_FORMAT_NPY},   {"binvox", BVX_FORMAT_BINVOX},   {"vox", BVX_FORMAT_VOX},
    {"nrrd", BVX_FORMAT_NRRD}, {"vti", BVX_FORMAT_VTI},         {"bvx", BVX_FORMAT_BVX},
    {"raw", BVX_FORMAT_RAW},   {"lattice", BVX_FORMAT_UNKNOWN},
};

static size_t fuzz_grid_words(const bvx_grid *g)
{
    return (size_t)g->words_per_row * (size_t)g->size[1] * (size_t)g->size[2];
}

static void fuzz_check_lattice(const bvx_grid *g)
{
    for (int a = 0; a < 3; a++) {
        fuzz_require(g->size[a] >= 1 && g->low[a] >= 0 && g->low[a] <= g->lattice.dims[a] - g->size[a],
                     "a window outside its lattice");
        fuzz_require(g->lattice.spacing[a] > 0 && g->lattice.spacing[a] - g->lattice.spacing[a] == 0,
                     "a spacing that is none");
        fuzz_require(g->lattice.origin[a] - g->lattice.origin[a] == 0, "an origin that is not finite");
    }
}

static void fuzz_check_grid(const bvx_grid *g)
{
    fuzz_require(g->words != NULL && g->owned == 1 && g->word_capacity >= fuzz_grid_words(g),
                 "a grid without words");
    fuzz_require(g->words_per_row == (g->size[0] + 63) / 64, "words per row that do not fit");
    fuzz_check_lattice(g);
    if (g->size[0] % 64 == 0) return;
    for (size_t i = (size_t)g->words_per_row - 1; i < fuzz_grid_words(g); i += (size_t)g->words_per_row)
        fuzz_require(g->words[i] >> g->size[0] % 64 == 0, "bits past a row's end");
}

/* BVX keeps all of a grid. */
static void fuzz_check_writing(bvx_context *ctx, const bvx_grid *g)
{
    bvx_buffer b = {0};
    bvx_grid back = {0};

    if (fuzz_grid_words(g) > FUZZ_WORDS) return;
    fuzz_require(bvx_write_grid(ctx, g, BVX_FORMAT_BVX, &b) == BVX_OK, "a grid that cannot be written");
    fuzz_require(bvx_read_grid(ctx, b.bytes, b.size, BVX_FORMAT_BVX, NULL, &back) == BVX_OK,
                 "a written grid that cannot be read");
    fuzz_require(memcmp(&back.lattice, &g->lattice, sizeof g->lattice) == 0 &&
                     memcmp(back.low, g->low, sizeof g->low) == 0 &&
                     memcmp(back.size, g->size, sizeof g->size) == 0 &&
                     memcmp(back.words, g->words, 8 * fuzz_grid_words(g)) == 0,
                 "a grid that changed by writing and reading");
    bvx_grid_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
}

/* The window in the middle of what was read. */
static void fuzz_check_window(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format,
                              const bvx_grid *g)
{
    bvx_window w;
    bvx_grid part = {0};

    if (fuzz_grid_words(g) > FUZZ_WORDS) return;
    for (int a = 0; a < 3; a++) {
        w.low[a] = g->size[a] / 3;
        w.size[a] = (g->size[a] - w.low[a] + 1) / 2;
    }
    fuzz_require(bvx_read_grid(ctx, file, size, format, &w, &part) == BVX_OK, "a window that cannot be read");
    fuzz_check_grid(&part);
    for (int32_t z = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++)
                fuzz_require(bvx_grid_get(&part, x, y, z) ==
                                 bvx_grid_get(g, x + w.low[0], y + w.low[1], z + w.low[2]),
                             "a window that differs from the whole");
    bvx_grid_free(ctx, &part);
}

/* ---- volumes ---- */

/* As deflate does, this makes up to a thousand times what is given. */
static int32_t fuzz_unpack(void *user, const void *packed, uint64_t packed_size, void *plain,
                           uint64_t plain_size)
{
    (void)user;
    if (packed_size == 0 || packed_size < plain_size / 1032) return 1;
    for (uint64_t i = 0; i < plain_size; i++)
        ((uint8_t *)plain)[i] = ((const uint8_t *)packed)[i % packed_size];
    return 0;
}

/* What a grid of the samples holds, the file's grid holds too; with halves
 * and numbers near 0 it may hold more. */
static void fuzz_check_samples(bvx_context *ctx, const bvx_volume *v, const bvx_grid *whole)
{
    bvx_grid g = {0};
    if (bvx_threshold(ctx, &v->view, 1e-300, 1e300, NULL, &g) == BVX_OK) {
        fuzz_check_grid(&g);
        for (size_t i = 0; whole != NULL && i < fuzz_grid_words(&g); i++)
            fuzz_require((g.words[i] & ~whole->words[i]) == 0, "a sample that the grid lacks");
    }
    bvx_grid_free(ctx, &g);
}

static int fuzz_read_volume(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format,
                            const bvx_read_volume_options *o, const bvx_grid *whole)
{
    static const bvx_volume empty = {0};
    bvx_volume v = {0};
    int good;

    bvx_memory_reset_peak(ctx);
    uint64_t const before = bvx_memory_used(ctx);
    good = fuzz_was_read(ctx, bvx_read_volume(ctx, file, size, format, o, &v),
                         o->inflate != NULL ? READ_GZIP : READ_VOLUME, size, before);
    if (good) fuzz_check_samples(ctx, &v, whole);
    else fuzz_require(memcmp(&v, &empty, sizeof v) == 0, "a volume behind an error");
    bvx_volume_free(ctx, &v);
    return good;
}

/* Packed samples, and those of a detached head, which are the same file here. */
static void fuzz_read_packed(bvx_context *ctx, const uint8_t *file, size_t size)
{
    bvx_read_volume_options o = {.struct_size = sizeof o};
    uint64_t files = 0;
    char name[64];

    o.data = file;
    o.data_size = size;
    fuzz_read_volume(ctx, file, size, BVX_FORMAT_NRRD, &o, NULL);
    o.inflate = fuzz_unpack;
    fuzz_read_volume(ctx, file, size, BVX_FORMAT_NRRD, &o, NULL);
    if (bvx_volume_data_name(ctx, file, size, 0, NULL, 0, &files) == BVX_OK && files != 0)
        (void)bvx_volume_data_name(ctx, file, size, files - 1, name, sizeof name, &files);
}

/* The options stand in the file's first bytes. */
static int fuzz_read_raw(bvx_context *ctx, const uint8_t *file, size_t size)
{
    bvx_read_volume_options o = {.struct_size = sizeof o};

    if (size <= FUZZ_RAW_HEAD) return 0;
    o.sample_type = 1 + file[0] % 10;
    o.big_endian = file[1] & 1;
    for (int a = 0; a < 3; a++) o.size[a] = 1 + (file[2 + 2 * a] << (file[3 + 2 * a] & 31) % 22);
    o.offset = file[8];
    o.spacing[0] = (1 + file[9]) / 16.0;
    return fuzz_read_volume(ctx, file + FUZZ_RAW_HEAD, size - FUZZ_RAW_HEAD, BVX_FORMAT_RAW, &o, NULL);
}

/* ---- lattices ---- */

/* On a grid of the window's size or not; what was read is written and read to itself. */
static int fuzz_read_lattice(bvx_context *ctx, const uint8_t *file, size_t size)
{
    static uint64_t words[24];
    bvx_grid g = {0}, before, back;
    bvx_buffer b = {0};
    int good;

    for (int a = 0; a < 3; a++) g.size[a] = g.lattice.dims[a] = 2 + a, g.lattice.spacing[a] = 1;
    g.lattice.fraction_bits = 16;
    g.words = words;
    g.words_per_row = 1;
    g.word_capacity = 24;
    before = back = g;
    bvx_status const status = bvx_read_lattice(ctx, file, size, &g);
    if (status == BVX_ERR_LATTICE)
        return fuzz_require(memcmp(&g, &before, sizeof g) == 0, "a lattice behind an error"), 1;
    good = fuzz_was_read(ctx, status, 0, size, 0);
    if (!good) return fuzz_require(memcmp(&g, &before, sizeof g) == 0, "a lattice behind an error"), 0;
    fuzz_check_lattice(&g);
    fuzz_require(bvx_write_lattice(ctx, &g, &b) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(bvx_read_lattice(ctx, b.bytes, b.size, &back) == BVX_OK && memcmp(&back, &g, sizeof g) == 0,
                 "a lattice that changed by writing and reading");
    bvx_buffer_free(ctx, &b);
    return 1;
}

/* ---- grids ---- */

/* BINVOX: 64 layers of x. */
static uint64_t fuzz_layers(const bvx_grid *g)
{
    return (uint64_t)g->size[2] * (uint64_t)((g->size[1] + 63) / 64) * 8 *
           (uint64_t)(g->size[0] < 64 ? g->size[0] : 64);
}

/* Into words of one's own nothing comes on top of the file's size, whatever it asks for. */
static void fuzz_read_into_words(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format,
                                 const bvx_grid *whole)
{
    static uint64_t words[FUZZ_WORDS];
    uint64_t const before = bvx_memory_used(ctx);
    bvx_grid g = {0};
    bvx_status status;

    g.words = words;
    g.word_capacity = FUZZ_WORDS;
    bvx_memory_reset_peak(ctx);
    status = bvx_read_grid(ctx, file, size, format, NULL, &g);
    int32_t const limit = format == BVX_FORMAT_VOX ? READ_VOX : READ_GRID;
    fuzz_require(g.words == words && g.owned == 0, "words of the caller's that were changed for others");
    if (status == BVX_ERR_CAPACITY) {
        fuzz_require(bvx_memory_peak(ctx) - before <= read_limit(limit, size),
                     "more memory than the file's size allows");
        fuzz_require(whole == NULL || fuzz_grid_words(whole) > FUZZ_WORDS, "a grid that fits and is refused");
        return;
    }
    if (!fuzz_was_read(ctx, status, limit, size,
                       before + (format == BVX_FORMAT_BINVOX ? fuzz_layers(whole != NULL ? whole : &g) : 0)))
        return;
    fuzz_require(whole != NULL && memcmp(whole->words, words, 8 * fuzz_grid_words(whole)) == 0,
                 "a grid that differs in words of the caller's");
}

/* The same file with its colours: labels are where voxels are set, unless the caller's limit is in the way. */
static void fuzz_read_labels(bvx_context *ctx, const uint8_t *file, size_t size, const bvx_grid *whole)
{
    uint8_t palette[1024];
    bvx_buffer labels = {0};
    bvx_status const status = bvx_read_labels(ctx, file, size, BVX_FORMAT_VOX, &labels, palette);

    fuzz_require((status == BVX_OK) == (labels.bytes != NULL), "labels behind an error");
    fuzz_require(whole != NULL ? status == BVX_OK || status == BVX_ERR_BUDGET : status != BVX_OK,
                 "labels of a file that is not a grid, or none of a grid");
    if (status == BVX_OK) {
        uint64_t i = 0;

        for (int32_t z = 0; z < whole->size[2]; z++)
            for (int32_t y = 0; y < whole->size[1]; y++)
                for (int32_t x = 0; x < whole->size[0]; x++, i++)
                    fuzz_require((labels.bytes[i] != 0) == bvx_grid_get(whole, x, y, z),
                                 "a label and its voxel that differ");
        fuzz_require(i == labels.size, "labels of another box");
    }
    bvx_buffer_free(ctx, &labels);
}

static int fuzz_read_grid(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    static const bvx_grid empty = {0};
    int32_t const number = formats[format].number;
    int const has_samples = format == FUZZ_NPY || format == FUZZ_NRRD || format == FUZZ_VTI;
    bvx_read_volume_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    bvx_status const status = bvx_read_grid(ctx, file, size, number, NULL, &g);
    int good = 0;

    if (status == BVX_OK) fuzz_check_grid(&g);
    if (status != BVX_ERR_BUDGET) /* a grid may be as large as the file says */
        good = fuzz_was_read(ctx, status, format == FUZZ_VOX ? READ_VOX : READ_GRID, size,
                             status != BVX_OK
                                 ? FUZZ_MEMORY
                                 : 8 * fuzz_grid_words(&g) + (format == FUZZ_BINVOX ? fuzz_layers(&g) : 0));
    if (good) {
        fuzz_check_writing(ctx, &g);
        fuzz_check_window(ctx, file, size, number, &g);
    } else {
        fuzz_require(memcmp(&g, &empty, sizeof g) == 0, "a result behind an error");
    }
    fuzz_read_into_words(ctx, file, size, number, good ? &g : NULL);
    if (has_samples) fuzz_read_volume(ctx, file, size, number, &o, good ? &g : NULL);
    if (format == FUZZ_NRRD) fuzz_read_packed(ctx, file, size);
    if (format == FUZZ_VOX) fuzz_read_labels(ctx, file, size, good ? &g : NULL);
    bvx_grid_free(ctx, &g);
    return good;
}

static int fuzz_read(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    if (format == FUZZ_LATTICE) return fuzz_read_lattice(ctx, file, size);
    return format == FUZZ_RAW ? fuzz_read_raw(ctx, file, size) : fuzz_read_grid(ctx, file, size, format);
}

/* ---- files to begin with ---- */

/* A grid of 70 x 3 x 4 voxels, with rows of noise and rows of runs; or the lattice of 2 x 3 x 4. */
static void fuzz_seed_written(bvx_context *ctx, fuzz_file *s)
{
    static const double origin[3] = {1, -2.5, 3}, spacing[3] = {0.5, 0.5, 0.5};
    int32_t const dims[3] = {s->format == FUZZ_LATTICE ? 2 : 70, 3, 4};
    bvx_lattice lattice;
    bvx_grid g = {0};
    bvx_buffer b = {0};

    fuzz_require(bvx_lattice_make(ctx, origin, spacing, dims, &lattice) == BVX_OK, "no lattice");
    fuzz_require(bvx_grid_create(ctx, &lattice, NULL, &g) == BVX_OK, "no grid");
    for (int32_t z = 0; z < 4; z++)
        for (int32_t y = 0; y < 3; y++)
            for (int32_t x = 0; x < dims[0]; x++)
                bvx_grid_set(&g, x, y, z, z == 1 ? (x * 11 + y * 5) % 7 % 2 : x + z > 30 && x - y < 50);
    if (s->format == FUZZ_LATTICE) fuzz_must(ctx, bvx_write_lattice(ctx, &g, &b));
    else fuzz_must(ctx, bvx_write_grid(ctx, &g, formats[s->format].number, &b));
    fuzz_put(s, b.bytes, (size_t)b.size);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* An array of big-endian int16, rows last to first. */
static void fuzz_seed_npy(fuzz_file *s)
{
    static const char dict[] = "{'descr': '>i2', 'fortran_order': False, 'shape': (3, 2, 2), }";
    uint8_t head[10] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, 118, 0};
    fuzz_put(s, head, sizeof head);
    fuzz_put(s, dict, sizeof dict - 1);
    while (s->size < 127) fuzz_put(s, " ", 1);
    fuzz_put(s, "\n\0\1\0\0\1\0\0\0\0\0\0\3\0\0\200\0\0\0\0\0\0\1\0\2", 25);
}

/* Three models in a scene. */
static void fuzz_seed_scene(bvx_context *ctx, fuzz_file *s)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {520, 1, 2};
    bvx_lattice lattice;
    bvx_buffer b = {0};
    bvx_grid g = {0};

    fuzz_must(ctx, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    fuzz_must(ctx, bvx_grid_create(ctx, &lattice, NULL, &g));
    for (int32_t x = 0; x < 520; x += 30) bvx_grid_set(&g, x, 0, x & 1, 1);
    fuzz_must(ctx, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
    fuzz_put(s, b.bytes, (size_t)b.size);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* Text, and bytes after it. */
static void fuzz_seed_with(fuzz_file *s, const char *text, const void *data, size_t n)
{
    fuzz_put_text(s, text);
    fuzz_put(s, data, n);
}

static int fuzz_make_seeds(bvx_context *ctx, fuzz_file *seeds)
{
    int n = 0;

    for (int format = 0; format <= FUZZ_LATTICE; format++)
        if (format != FUZZ_RAW) fuzz_seed_written(ctx, fuzz_begin_file(seeds, &n, formats[format].name));
    fuzz_seed_with(fuzz_begin_file(seeds, &n, "raw"), "\3\1\1",
                   "\0\1\0\1\0\0\20\0\0\1\2\3\4\5\6\7\10\11\12\13\14\15\16\17\20", 25);
    fuzz_seed_with(fuzz_begin_file(seeds, &n, "raw"), "\11", "\0\0\0\0\0\0\0\0\20\0\0\0\0\200\77\0\0\300\177",
                   19);
    fuzz_seed_npy(fuzz_begin_file(seeds, &n, "npy"));
    fuzz_seed_with(
        fuzz_begin_file(seeds, &n, "binvox"),
        "#binvox 2\r\n# comment\r\nscale 1.5e0\r\ndim 5 4 3\r\nother\r\ntranslate -1 0.25 1e3\r\ndata\r\n",
        "\0\12\7\5\7\0\1\5\0\50", 10);
    fuzz_seed_with(
        fuzz_begin_file(seeds, &n, "vox"), "VOX ",
        "\310\0\0\0MAIN\0\0\0\0\133\0\0\0PACK\4\0\0\0\0\0\0\0\1\0\0\0SIZE\14\0\0\0\0\0\0\0\5\0\0\0\6\0\0\0\7\0\0\0"
        "XYZI\14\0\0\0\0\0\0\0\2\0\0\0\0\0\0\1\4\5\6\377nTRN\3\0\0\0\14\0\0\0abcLAYR\0\0\0\0\0\0\0\0",
        107);
    fuzz_seed_scene(ctx, fuzz_begin_file(seeds, &n, "vox"));
    fuzz_seed_with(
        fuzz_begin_file(seeds, &n, "nrrd"),
        "NRRD0005\n# comment\ntype: float\ndimension: 3\nsizes: 2 3 2\nspacings: 1 2 0.5\nencoding: ascii\nkey:=value\n\n"
        "0 1 0.5 -0 nan 1e-40 2 0 0 1 0 -1\n",
        "", 0);
    fuzz_seed_with(
        fuzz_begin_file(seeds, &n, "nrrd"),
        "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\nspace directions: (2,0,0) "
        "(0,1,0) (0,0,1)\nspace origin: (1,2,3)\nendian: big\nencoding: raw\n\n",
        "\0\1\0\0\1\0\0\0\0\0\200\0\0\0\0\1", 16);
    fuzz_seed_with(
        fuzz_begin_file(seeds, &n, "vti"),
        "<?xml version=\"1.0\"?>\n<!-- c -->\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
        "<ImageData WholeExtent=\"0 2 0 2 0 1\" Origin=\"0 1 2\" Spacing=\"1 1 2\">\n<Piece Extent=\"0 2 0 2 0 1\">\n"
        "<CellData Scalars='a'>\n<DataArray type=\"Int32\" Name=\"a\" format=\"ascii\">\n1 0 -1 0\n</DataArray>\n"
        "</CellData>\n</Piece>\n</ImageData>\n</VTKFile>\n",
        "", 0);
    fuzz_seed_with(
        fuzz_begin_file(seeds, &n, "vti"),
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n"
        "<ImageData WholeExtent=\"0 2 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 2 0 1 0 1\">"
        "<CellData><DataArray type=\"UInt8\" Name=\"a\" format=\"binary\">AgAAAAEA</DataArray></CellData></Piece>"
        "</ImageData></VTKFile>",
        "", 0);
    return n;
}

static void fuzz_store(uint8_t *p, uint64_t v)
{
    for (int i = 0; i < 8; i++) p[i] = (uint8_t)(v >> 8 * i & 0xff);
}

/* Right checksums again, as far as the slices can be followed: else nothing after them would ever be
 * tried. */
static void fuzz_seal(uint8_t *file, size_t size, int format)
{
    uint64_t frame;
    size_t at = 128;

    if (size < at || format != FUZZ_BVX) return;
    fuzz_store(file + 120, bvx_hash(file, 120, 0));
    frame = bvx_hash(file + 16, 80, 0);
    while (size - at >= 24) {
        uint64_t n = 0;
        for (int i = 8; i-- > 0;) n = n << 8 | file[at + 16 + (size_t)i];
        if (n > size - at - 24) return;
        fuzz_store(file + at, bvx_hash(file + at + 8, 16 + (size_t)n, frame));
        at += 24 + (size_t)n;
    }
}

static const char *const fuzz_words[] = {"4294967295",
                                         "-1",
                                         "nan",
                                         "1e999",
                                         " ",
                                         "\n",
                                         "0",
                                         "99999999999999999999",
                                         "dim 9 9 9\n",
                                         "translate ",
                                         "scale ",
                                         "encoding: gzip\n",
                                         "encoding: ascii\n",
                                         "data file: a%03d 1 9 2\n",
                                         "data file: LIST\n",
                                         "type: double\n",
                                         "sizes: 2 2 2\n",
                                         "endian: big\n",
                                         "line skip: 1\n",
                                         "byte skip: -1\n",
                                         "data\n",
                                         "SIZE",
                                         "XYZI",
                                         "PACK",
                                         "<",
                                         "/>",
                                         "\"",
                                         "ascii",
                                         "binary",
                                         "appended",
                                         "double",
                                         "Float64",
                                         "encoding=\"base64\"",
                                         "(3,4)",
                                         "'<f8'",
                                         "'>f2'",
                                         "True",
                                         "\xff\xff\xff\xff\x7f",
                                         "\"window\": ",
                                         "[",
                                         "{",
                                         "null"};

static const fuzz_target *fuzz_reader(void)
{
    static const fuzz_target target = {formats,        sizeof formats / sizeof formats[0],
                                       fuzz_words,     sizeof fuzz_words / sizeof fuzz_words[0],
                                       fuzz_read,      fuzz_seal,
                                       fuzz_make_seeds};
    return &target;
}
