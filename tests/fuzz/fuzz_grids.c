/* fuzz_grids.c - the grid readers on damaged files: no crash, no leak, an error in words or a valid grid that is written and
 * read to itself, and whose windows hold what it holds.
 *
 * A libFuzzer target: the first byte of the input chooses the format, the rest is the file. With BVX_FUZZ_MAIN it is a
 * program of its own that damages built-in files by a fixed generator: fuzz_grids [inputs [seed]]. */
#include "bitvox.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_MEMORY = 16 << 20, FUZZ_FORMATS = 6 };

static const int32_t fuzz_formats[FUZZ_FORMATS] = {BVX_FORMAT_NPY,  BVX_FORMAT_BINVOX, BVX_FORMAT_VOX,
                                                   BVX_FORMAT_NRRD, BVX_FORMAT_VTI,    BVX_FORMAT_BVX};

static void fuzz_require(int good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_grids: %s\n", what);
    abort();
}

static size_t fuzz_words(const bvx_grid *g)
{
    return (size_t)g->words_per_row * (size_t)g->size[1] * (size_t)g->size[2];
}

static void fuzz_check_grid(const bvx_grid *g)
{
    fuzz_require(g->words != NULL && g->owned == 1 && g->word_capacity >= fuzz_words(g), "a grid without words");
    fuzz_require(g->words_per_row == (g->size[0] + 63) / 64, "words per row that do not fit");
    for (int a = 0; a < 3; a++) {
        fuzz_require(g->size[a] >= 1 && g->low[a] >= 0 && g->low[a] <= g->lattice.dims[a] - g->size[a], "a window outside its lattice");
        fuzz_require(g->lattice.spacing[a] > 0 && g->lattice.spacing[a] - g->lattice.spacing[a] == 0, "a spacing that is none");
        fuzz_require(g->lattice.origin[a] - g->lattice.origin[a] == 0, "an origin that is not finite");
    }
    if (g->size[0] % 64 == 0) return;
    for (size_t i = (size_t)g->words_per_row - 1; i < fuzz_words(g); i += (size_t)g->words_per_row)
        fuzz_require(g->words[i] >> g->size[0] % 64 == 0, "bits past a row's end");
}

/* BVX keeps all of a grid. */
static void fuzz_check_writing(bvx_context *ctx, const bvx_grid *g)
{
    bvx_buffer b = {0};
    bvx_grid back = {0};
    if (fuzz_words(g) > 4096) return;
    fuzz_require(bvx_write_grid(ctx, g, BVX_FORMAT_BVX, &b) == BVX_OK, "a grid that cannot be written");
    fuzz_require(bvx_read_grid(ctx, b.bytes, b.size, BVX_FORMAT_BVX, NULL, &back) == BVX_OK, "a written grid that cannot be read");
    fuzz_require(memcmp(&back.lattice, &g->lattice, sizeof g->lattice) == 0 && memcmp(back.low, g->low, sizeof g->low) == 0 &&
                     memcmp(back.size, g->size, sizeof g->size) == 0 && memcmp(back.words, g->words, 8 * fuzz_words(g)) == 0,
                 "a grid that changed by writing and reading");
    bvx_grid_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
}

/* The window in the middle of what was read. */
static void fuzz_check_window(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format, const bvx_grid *g)
{
    bvx_window w;
    bvx_grid part = {0};
    if (fuzz_words(g) > 4096) return;
    for (int a = 0; a < 3; a++) {
        w.low[a] = g->size[a] / 3;
        w.size[a] = (g->size[a] - w.low[a] + 1) / 2;
    }
    fuzz_require(bvx_read_grid(ctx, file, size, format, &w, &part) == BVX_OK, "a window that cannot be read");
    fuzz_check_grid(&part);
    for (int32_t z = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++)
                fuzz_require(bvx_grid_get(&part, x, y, z) == bvx_grid_get(g, x + w.low[0], y + w.low[1], z + w.low[2]),
                             "a window that differs from the whole");
    bvx_grid_free(ctx, &part);
}

static int32_t fuzz_unpack(void *user, const void *packed, uint64_t packed_size, void *plain, uint64_t plain_size)
{
    (void)user;
    if (packed_size < plain_size) return 1;
    memcpy(plain, packed, (size_t)plain_size);
    return 0;
}

/* The same file as a volume: a view that is read whole, and what a grid of it holds. */
static void fuzz_read_volume(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format)
{
    static const bvx_volume empty = {0};
    bvx_read_volume_options o;
    bvx_volume v = {0};
    bvx_grid other = {0}, g = {0};
    bvx_status status;
    uint64_t files = 0;
    char name[64];
    bvx_read_volume_options_init(&o, sizeof o);
    o.inflate = fuzz_unpack;
    o.data = file;
    o.data_size = size;
    status = bvx_read_volume(ctx, file, size, format, &o, &v);
    if (status == BVX_OK && bvx_threshold(ctx, &v.view, 1e-300, 1e300, NULL, &g) == BVX_OK) {
        fuzz_check_grid(&g);
        if (bvx_read_grid(ctx, file, size, format, NULL, &other) == BVX_OK)
            for (size_t i = 0; i < fuzz_words(&g); i++) fuzz_require((g.words[i] & ~other.words[i]) == 0, "a sample that the grid lacks");
    }
    fuzz_require(status == BVX_OK || memcmp(&v, &empty, sizeof v) == 0, "a volume behind an error");
    if (format == BVX_FORMAT_NRRD && bvx_volume_data_name(ctx, file, size, 0, NULL, 0, &files) == BVX_OK && files != 0)
        bvx_volume_data_name(ctx, file, size, files - 1, name, sizeof name, &files);
    bvx_grid_free(ctx, &other);
    bvx_grid_free(ctx, &g);
    bvx_volume_free(ctx, &v);
    fuzz_require(bvx_memory_used(ctx) == 0, "a volume's memory that is not given back");
}

static int32_t fuzz_read(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format)
{
    static const bvx_grid empty = {0};
    bvx_grid g = {0};
    bvx_status const status = bvx_read_grid(ctx, file, size, format, NULL, &g);
    if (status == BVX_OK) {
        fuzz_check_grid(&g);
        fuzz_check_writing(ctx, &g);
        fuzz_check_window(ctx, file, size, format, &g);
    } else {
        const char *const message = bvx_last_message(ctx);
        fuzz_require(memcmp(&g, &empty, sizeof g) == 0, "a result behind an error");
        fuzz_require(strlen(message) > 10 && strchr(message, '\n') == NULL, "an error without a line of words");
        fuzz_require(status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE || status == BVX_ERR_UNSUPPORTED ||
                         status == BVX_ERR_BUDGET, "an error of another kind");
    }
    bvx_grid_free(ctx, &g);
    fuzz_require(bvx_memory_used(ctx) == 0, "memory that is not given back");
    if (format == BVX_FORMAT_NPY || format == BVX_FORMAT_NRRD || format == BVX_FORMAT_VTI) fuzz_read_volume(ctx, file, size, format);
    return status;
}

static bvx_context *fuzz_context(void)
{
    bvx_context_options o;
    bvx_context *ctx = NULL;
    bvx_context_options_init(&o, sizeof o);
    o.threads = 1;
    o.memory_limit = FUZZ_MEMORY;
    fuzz_require(bvx_context_create(&o, &ctx) == BVX_OK, "no context");
    return ctx;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bvx_context *const ctx = fuzz_context();
    if (size > 1) fuzz_read(ctx, data + 1, size - 1, fuzz_formats[data[0] % FUZZ_FORMATS]);
    bvx_context_destroy(ctx);
    return 0;
}

#if defined(BVX_FUZZ_MAIN)

enum { FUZZ_SEED_SIZE = 2048, FUZZ_SIZE = 4096, FUZZ_SEEDS = 16 };

typedef struct fuzz_seed {
    int32_t format;
    size_t size;
    uint8_t bytes[FUZZ_SEED_SIZE];
} fuzz_seed;

static uint64_t fuzz_state;

static size_t fuzz_below(size_t n)
{
    fuzz_state ^= fuzz_state << 13;
    fuzz_state ^= fuzz_state >> 7;
    fuzz_state ^= fuzz_state << 17;
    return (size_t)((fuzz_state >> 16) % n); /* the same on machines of 32 bits */
}

/* A grid of 70 x 3 x 4 voxels, with rows of noise and rows of runs. */
static void fuzz_seed_written(bvx_context *ctx, fuzz_seed *s, int32_t format)
{
    static const double origin[3] = {1, -2.5, 3}, spacing[3] = {0.5, 0.5, 0.5};
    static const int32_t dims[3] = {70, 3, 4};
    bvx_lattice lattice;
    bvx_grid g = {0};
    bvx_buffer b = {0};
    fuzz_require(bvx_lattice_make(ctx, origin, spacing, dims, &lattice) == BVX_OK, "no lattice");
    fuzz_require(bvx_grid_create(ctx, &lattice, NULL, &g) == BVX_OK, "no grid");
    for (int32_t z = 0; z < 4; z++)
        for (int32_t y = 0; y < 3; y++)
            for (int32_t x = 0; x < 70; x++)
                bvx_grid_set(&g, x, y, z, z == 1 ? (x * 11 + y * 5) % 7 % 2 : x + z > 30 && x - y < 50);
    fuzz_require(bvx_write_grid(ctx, &g, format, &b) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(b.size <= FUZZ_SEED_SIZE, "a seed that is too long");
    memcpy(s->bytes, b.bytes, (size_t)b.size);
    s->size = (size_t)b.size;
    s->format = format;
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void fuzz_put(fuzz_seed *s, const void *bytes, size_t n)
{
    memcpy(s->bytes + s->size, bytes, n);
    s->size += n;
}

static void fuzz_seed_text(fuzz_seed *s, int32_t format, const char *text, const void *data, size_t n)
{
    s->format = format;
    s->size = 0;
    fuzz_put(s, text, strlen(text));
    fuzz_put(s, data, n);
}

/* An array of big-endian int16, rows last to first. */
static void fuzz_seed_npy(fuzz_seed *s)
{
    static const char dict[] = "{'descr': '>i2', 'fortran_order': False, 'shape': (3, 2, 2), }";
    uint8_t head[10] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, 118, 0};
    s->format = BVX_FORMAT_NPY;
    fuzz_put(s, head, sizeof head);
    fuzz_put(s, dict, sizeof dict - 1);
    while (s->size < 127) fuzz_put(s, " ", 1);
    fuzz_put(s, "\n\0\1\0\0\1\0\0\0\0\0\0\3\0\0\200\0\0\0\0\0\0\1\0\2", 25);
}

static int fuzz_seed_all(bvx_context *ctx, fuzz_seed *seeds)
{
    int n = 0;
    for (int i = 0; i < FUZZ_FORMATS; i++) fuzz_seed_written(ctx, &seeds[n++], fuzz_formats[i]);
    fuzz_seed_npy(&seeds[n++]);
    fuzz_seed_text(&seeds[n++], BVX_FORMAT_BINVOX,
                   "#binvox 2\r\n# comment\r\nscale 1.5e0\r\ndim 5 4 3\r\nother\r\ntranslate -1 0.25 1e3\r\ndata\r\n",
                   "\0\12\7\5\7\0\1\5\0\50", 10);
    fuzz_seed_text(&seeds[n++], BVX_FORMAT_VOX, "VOX ",
                   "\310\0\0\0MAIN\0\0\0\0\133\0\0\0PACK\4\0\0\0\0\0\0\0\1\0\0\0SIZE\14\0\0\0\0\0\0\0\5\0\0\0\6\0\0\0\7\0\0\0"
                   "XYZI\14\0\0\0\0\0\0\0\2\0\0\0\0\0\0\1\4\5\6\377nTRN\3\0\0\0\14\0\0\0abcLAYR\0\0\0\0\0\0\0\0", 107);
    fuzz_seed_text(&seeds[n++], BVX_FORMAT_NRRD,
                   "NRRD0005\n# comment\ntype: float\ndimension: 3\nsizes: 2 3 2\nspacings: 1 2 0.5\nencoding: ascii\nkey:=value\n\n"
                   "0 1 0.5 -0 nan 1e-40 2 0 0 1 0 -1\n", "", 0);
    fuzz_seed_text(&seeds[n++], BVX_FORMAT_NRRD,
                   "NRRD0004\ntype: int16\ndimension: 3\nspace: left-posterior-superior\nsizes: 2 2 2\nspace directions: (2,0,0) "
                   "(0,1,0) (0,0,1)\nspace origin: (1,2,3)\nendian: big\nencoding: raw\n\n",
                   "\0\1\0\0\1\0\0\0\0\0\200\0\0\0\0\1", 16);
    fuzz_seed_text(&seeds[n++], BVX_FORMAT_VTI,
                   "<?xml version=\"1.0\"?>\n<!-- c -->\n<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\">\n"
                   "<ImageData WholeExtent=\"0 2 0 2 0 1\" Origin=\"0 1 2\" Spacing=\"1 1 2\">\n<Piece Extent=\"0 2 0 2 0 1\">\n"
                   "<CellData Scalars='a'>\n<DataArray type=\"Int32\" Name=\"a\" format=\"ascii\">\n1 0 -1 0\n</DataArray>\n"
                   "</CellData>\n</Piece>\n</ImageData>\n</VTKFile>\n", "", 0);
    fuzz_seed_text(&seeds[n++], BVX_FORMAT_VTI,
                   "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">\n"
                   "<ImageData WholeExtent=\"0 2 0 1 0 1\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 2 0 1 0 1\">"
                   "<CellData><DataArray type=\"UInt8\" Name=\"a\" format=\"binary\">AgAAAAEA</DataArray></CellData></Piece>"
                   "</ImageData></VTKFile>", "", 0);
    return n;
}

/* One damage: a bit, a byte, a number of four bytes, a piece copied, cut out, or a tail cut off. */
static size_t fuzz_damage(uint8_t *file, size_t size)
{
    static const uint32_t numbers[] = {0, 1, 2, 0xffffffffu, 0x7fffffffu, 0x80000000u, 0xffff, 256, 1 << 25};
    static const char *const words[] = {"4294967295", "-1", "nan", "1e999", " ", "\n", "0", "99999999999999999999", "dim 9 9 9\n",
                                        "encoding: gzip\n", "data file: a%03d 1 9 2\n", "data file: LIST\n",
                                        "data\n", "SIZE", "XYZI", "<", "/>", "\"", "ascii", "double", "(3,4)", "\xff\xff\xff\xff\x7f"};
    size_t const at = fuzz_below(size);
    switch (fuzz_below(8)) {
    case 0: file[at] ^= (uint8_t)(1u << fuzz_below(8)); break;
    case 1: file[at] = (uint8_t)fuzz_below(256); break;
    case 2: file[at] = (uint8_t)"0123456789-+.e /\n\r\t#"[fuzz_below(20)]; break;
    case 3: {
        uint32_t const v = numbers[fuzz_below(sizeof numbers / sizeof numbers[0])];
        for (size_t i = 0; i < 4 && at + i < size; i++) file[at + i] = (uint8_t)(v >> 8 * i & 0xff);
        break;
    }
    case 4: { /* a word laid over what was there */
        const char *const word = words[fuzz_below(sizeof words / sizeof words[0])];
        for (size_t i = 0; word[i] != 0 && at + i < size; i++) file[at + i] = (uint8_t)word[i];
        break;
    }
    case 5: { /* a word or a piece put between */
        const char *const word = words[fuzz_below(sizeof words / sizeof words[0])];
        int const piece = fuzz_below(2) == 0;
        size_t n = piece ? 1 + fuzz_below(60) : strlen(word);
        if (piece && n > size - at) n = size - at;
        if (size + n > FUZZ_SIZE) break;
        memmove(file + at + n, file + at, size - at);
        if (!piece) memcpy(file + at, word, n);
        return size + n;
    }
    case 6: {
        size_t const n = fuzz_below(size - at < 40 ? size - at + 1 : 40);
        memmove(file + at, file + at + n, size - at - n);
        return size - n;
    }
    default: return fuzz_below(4) == 0 ? at + 1 : size;
    }
    return size;
}

static void fuzz_store(uint8_t *p, uint64_t v)
{
    for (int i = 0; i < 8; i++) p[i] = (uint8_t)(v >> 8 * i & 0xff);
}

/* Right checksums again, as far as the slices can be followed: else nothing behind them would ever be tried. */
static void fuzz_seal(uint8_t *file, size_t size)
{
    uint64_t frame;
    size_t at = 128;
    if (size < at) return;
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

int main(int argc, char **argv)
{
    static fuzz_seed seeds[FUZZ_SEEDS];
    unsigned long const inputs = argc > 1 ? strtoul(argv[1], NULL, 10) : 20000;
    unsigned long read = 0;
    bvx_context *const ctx = fuzz_context();
    int const count = fuzz_seed_all(ctx, seeds);
    fuzz_state = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    fuzz_state = fuzz_state * 2 + 1; /* never 0 */
    for (int i = 0; i < count; i++)
        fuzz_require(fuzz_read(ctx, seeds[i].bytes, seeds[i].size, seeds[i].format) == BVX_OK, bvx_last_message(ctx));
    for (unsigned long i = 0; i < inputs; i++) {
        const fuzz_seed *const seed = &seeds[i % (unsigned long)count];
        static uint8_t work[FUZZ_SIZE];
        size_t size = seed->size;
        memcpy(work, seed->bytes, size);
        for (size_t n = 1 + fuzz_below(4); n > 0 && size > 0; n--) size = fuzz_damage(work, size);
        if (seed->format == BVX_FORMAT_BVX && fuzz_below(8) != 0) fuzz_seal(work, size);
        if (size == 0) continue;
        uint8_t *const exact = malloc(size); /* so that a sanitizer sees a read beyond the end */
        fuzz_require(exact != NULL, "no memory");
        memcpy(exact, work, size);
        read += fuzz_read(ctx, exact, size, fuzz_below(50) == 0 ? fuzz_formats[fuzz_below(FUZZ_FORMATS)] : seed->format) == BVX_OK;
        free(exact);
    }
    bvx_context_destroy(ctx);
    printf("fuzz_grids: %lu inputs, %lu of them read, 0 failures\n", inputs, read);
    return 0;
}

#endif
