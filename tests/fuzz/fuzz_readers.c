/* fuzz_readers.c - the mesh readers on damaged files: no crash, no leak, an error in words or a valid mesh that is
 * written and read to itself.
 *
 * A libFuzzer target: the first byte of the input chooses the format, the rest is the file. With BVX_FUZZ_MAIN it is a
 * program of its own that damages built-in files by a fixed generator: fuzz_readers [inputs [seed]]. */
#include "bitvox.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const int32_t formats[4] = {BVX_FORMAT_STL, BVX_FORMAT_OBJ, BVX_FORMAT_PLY, BVX_FORMAT_OFF};

enum { FUZZ_MEMORY = 16 << 20 };

static void fuzz_require(int good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_readers: %s\n", what);
    abort();
}

static void fuzz_check_mesh(const bvx_mesh *m)
{
    fuzz_require(m->triangle_count > 0 && m->owned == 1, "a mesh without triangles");
    fuzz_require(m->vertex_capacity == m->vertex_count && m->triangle_capacity == m->triangle_count, "a loose capacity");
    for (uint64_t i = 0; i < m->triangle_count * 3; i++)
        fuzz_require(m->triangles[i] < m->vertex_count, "an index out of range");
    for (uint64_t i = 0; i < m->vertex_count * 3; i++) {
        double const v = m->position_type == BVX_F32 ? (double)((float *)m->positions)[i] : ((double *)m->positions)[i];
        fuzz_require(v - v == 0.0, "a coordinate that is not finite");
    }
}

/* Colours and texture coordinates of exact size; numbers into them in range. */
static void fuzz_check_attributes(const bvx_mesh *m)
{
    volatile uint8_t last = 0;
    if (m->colours != NULL) last = m->colours[m->vertex_capacity * 4 - 1];
    (void)last;
    fuzz_require(m->uvs != NULL || (m->uv_count == 0 && m->uv_triangles == NULL), "texture numbers without coordinates");
    if (m->uvs == NULL) return;
    fuzz_require(m->uv_triangles != NULL || m->uv_count == m->vertex_capacity, "texture coordinates of another count");
    for (uint64_t i = 0; i < m->uv_count * 2; i++) fuzz_require(m->uvs[i] - m->uvs[i] == 0.0f, "a texture coordinate that is not finite");
    for (uint64_t i = 0; m->uv_triangles != NULL && i < m->triangle_count * 3; i++)
        fuzz_require(m->uv_triangles[i] < m->uv_count, "a texture number out of range");
}

/* What was read is written and read again to the same bytes: PLY keeps all of a mesh, OBJ all of doubles. */
static void fuzz_check_writing(bvx_context *ctx, const bvx_mesh *m)
{
    int32_t const format = m->position_type == BVX_F64 && m->vertex_count % 2 == 0 ? BVX_FORMAT_OBJ : BVX_FORMAT_PLY;
    size_t const bytes = (size_t)m->vertex_count * (m->position_type == BVX_F32 ? 12 : 24);
    bvx_buffer b = {0};
    bvx_mesh back = {0};
    if (m->vertex_count > 10000 || m->triangle_count > 10000) return;
    fuzz_require(bvx_write_mesh(ctx, m, format, &b) == BVX_OK, "a mesh that cannot be written");
    fuzz_require(bvx_read_mesh(ctx, b.bytes, b.size, format, &back) == BVX_OK, "a written mesh that cannot be read");
    fuzz_require(back.vertex_count == m->vertex_count && back.triangle_count == m->triangle_count &&
                     back.position_type == m->position_type && memcmp(back.positions, m->positions, bytes) == 0 &&
                     memcmp(back.triangles, m->triangles, (size_t)m->triangle_count * 12) == 0,
                 "a mesh that changed by writing and reading");
    fuzz_require((back.colours != NULL) == (m->colours != NULL) && (back.uvs != NULL) == (m->uvs != NULL), "colours or texture coordinates lost");
    if (m->colours != NULL && format == BVX_FORMAT_PLY)
        fuzz_require(memcmp(back.colours, m->colours, (size_t)m->vertex_count * 4) == 0, "colours that changed");
    bvx_mesh_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
}

static int32_t fuzz_read(bvx_context *ctx, const uint8_t *file, size_t size, int32_t format)
{
    static const bvx_mesh empty = {0};
    bvx_mesh m = {0};
    bvx_status const status = bvx_read_mesh(ctx, file, size, format, &m);
    if (status == BVX_OK) {
        fuzz_check_mesh(&m);
        fuzz_check_attributes(&m);
        fuzz_check_writing(ctx, &m);
    } else {
        const char *const message = bvx_last_message(ctx);
        fuzz_require(memcmp(&m, &empty, sizeof m) == 0, "a result behind an error");
        fuzz_require(strlen(message) > 10 && strchr(message, '\n') == NULL, "an error without a line of words");
        fuzz_require(status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE || status == BVX_ERR_EMPTY ||
                         status == BVX_ERR_BUDGET || status == BVX_ERR_UNSUPPORTED,
                     message);
    }
    bvx_mesh_free(ctx, &m);
    fuzz_require(bvx_memory_used(ctx) == 0, "memory that is not given back");
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
    if (size > 0) fuzz_read(ctx, data + 1, size - 1, formats[data[0] % 4]);
    bvx_context_destroy(ctx);
    return 0;
}

#if defined(BVX_FUZZ_MAIN)

enum { FUZZ_SEED_SIZE = 1200, FUZZ_SIZE = 4096, SEEDS = 10 };

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

static void fuzz_put(fuzz_seed *s, const void *bytes, size_t n)
{
    memcpy(s->bytes + s->size, bytes, n);
    s->size += n;
}

static void fuzz_put_text(fuzz_seed *s, const char *text)
{
    fuzz_put(s, text, strlen(text));
}

static void fuzz_put_u32(fuzz_seed *s, uint32_t v, int big)
{
    uint8_t b[4];
    for (int i = 0; i < 4; i++) b[i] = (uint8_t)(v >> 8 * (big ? 3 - i : i) & 0xff);
    fuzz_put(s, b, 4);
}

static void fuzz_put_f32(fuzz_seed *s, float v, int big)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    fuzz_put_u32(s, bits, big);
}

static void fuzz_seed_stl(fuzz_seed *s)
{
    static const int corners[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
    s->format = BVX_FORMAT_STL;
    fuzz_put_text(s, "solid tetrahedron in a binary file");
    while (s->size < 80) fuzz_put(s, "", 1);
    fuzz_put_u32(s, 4, 0);
    for (int t = 0; t < 4; t++) {
        for (int i = 0; i < 3; i++) fuzz_put_f32(s, 0, 0);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) fuzz_put_f32(s, corners[t][k] == a + 1 ? 1.5f : -0.0f, 0);
        fuzz_put(s, "\0", 2);
    }
}

static void fuzz_seed_ply(fuzz_seed *s, int big)
{
    s->format = BVX_FORMAT_PLY;
    fuzz_put_text(s, big ? "ply\nformat binary_big_endian 1.0\n" : "ply\r\nformat binary_little_endian 1.0\r\n");
    fuzz_put_text(s, big ? "element other 2\nproperty list uchar short a\nelement vertex 4\nproperty uchar r\nproperty float z\n"
                           "property float x\nproperty float y\nelement face 2\nproperty list ushort uint vertex_index\n"
                           "property char c\nend_header\n"
                         : "comment x\r\nelement vertex 4\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
                           "property int i\r\nelement face 2\r\nproperty list uchar int vertex_indices\r\nend_header\r\n");
    if (big) fuzz_put(s, "\0\2abcd", 6);
    for (uint32_t v = 0; v < 4; v++) {
        if (big) fuzz_put(s, "r", 1);
        for (uint32_t a = 0; a < 3; a++) fuzz_put_f32(s, (float)(v * 3 + a) / 7, big);
        if (!big) fuzz_put_u32(s, v, 0);
    }
    for (uint32_t f = 0; f < 2; f++) {
        fuzz_put(s, big ? f == 0 ? "\0\3" : "\0\4" : "\3", big ? 2 : 1);
        for (uint32_t k = 0; k < (big && f == 1 ? 4 : 3); k++) fuzz_put_u32(s, (f + k) % 4, big);
        if (big) fuzz_put(s, "c", 1);
    }
}

static const char *const fuzz_stl_text =
    "solid a\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1e0 0 -0\n   vertex 0.5 1.25 3\n  endloop\n"
    " endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n"
    "  endloop\n endfacet\nendsolid a\n";
static const char *const fuzz_obj_text =
    "# x\nmtllib a.mtl\nv 0 0 0\nv 1.0 0.125 -3e-2\r\nv 12345678901234567890.5 1 1 0.5 0.5 0.5\nv 0 \\\n1 0\nvt 0 0\n"
    "vn 0 0 1\ng a\nf 1 2 3\nf 1/1 2/1 3/1 4/1\nf -1//1 -2//1 \\\n -3//1\nf 1/1/1 2/1/1 4/1/1\n";
static const char *const fuzz_ply_text =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
    "property list uchar int l\nelement face 3\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0 0\n1 0.1 1e-300 2 5 6\n0.30000000000000004 1 0 1 9\n0 1 1 0\n3 0 1 2\n4 0 1 2 3\n3 2 1 0\n";

static const char *const fuzz_obj_coloured =
    "v 0 0 0 1 0 0\nv 1.0 0.125 -3e-2 0.5 .5 0\nv 1 1 1 1 0.5 0.5 0.5\nv 0 \\\n1 0 0 0 1\nvt 0 0\nvt 1\nvt 0.5 1 2\nvt 0 0\n"
    "f 1/1 2/2 3/3\nf 1/1 2/1/7 3/4 4/1\nf -1/-1 -2/2/1 \\\n -3/1\nf 1/1/1 2/1/1 4/1/1\n";
static const char *const fuzz_ply_coloured =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nproperty uchar red\n"
    "property ushort green\nproperty float blue\nproperty float u\nproperty float v\n"
    "property list uchar int l\nelement face 2\nproperty list uchar int vertex_indices\nproperty list uchar float texcoord\n"
    "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    "0 0 0 1 2 .5 0 1 0\n1 0.1 1e-300 2 5 0.6 1 1 2 5 6\n0.30000000000000004 1 0 1 9 0 9 9 0\n0 1 1 0 0 0 0 0 1 3\n"
    "3 0 1 2 6 0 0 0 1 1 1\n4 0 1 2 3 8 1 2 3 4 5 6 7 8\n6 0 1 2 -1 3 2\n";
static const char *const fuzz_off_text =
    "OFF # x\n5 3 0\n0 0 0\n1 0.125 -3e-2\n\n12345678901234567890.5 1 1\n0 1 0\n.3 .3 0\n3 0 1 2 255 0 0\n4 0 1 2 3\n5 0 1 2 3 4\n";
static const char *const fuzz_off_coloured =
    "STCNOFF 4 2 5\n0 0 0 0 0 1 255 0 0 255 0 1\n1 0 0 0 0 1 0 255 0 255 1 0\n1 1 0 0 0 1 0 0 255 128 1 1\n0 1 1 0 0 1 9 9 9 9 0 0\n"
    "3 0 1 2\n4 0 1 2 3 0.5 0.5 0.5\n";

/* One damage: a bit, a byte, a number of four bytes, a piece copied, cut out, or a tail cut off. */
static size_t fuzz_damage(uint8_t *file, size_t size)
{
    static const uint32_t numbers[] = {0, 1, 2, 0xffffffffu, 0x7fffffffu, 0x80000000u, 0xffff, 0x7f800000u, 0x7fc00000u};
    static const char *const words[] = {"4294967295", "-1", "nan", "1e999", " ", "\n", "\\\n", "0", "99999999999999999999", "/",
                                        "list ", "end_header\n", "facet ", "element face 2\n", "property char x\n"};
    size_t const at = fuzz_below(size);
    switch (fuzz_below(8)) {
    case 0: file[at] ^= (uint8_t)(1u << fuzz_below(8)); break;
    case 1: file[at] = (uint8_t)fuzz_below(256); break;
    case 2: file[at] = (uint8_t)"0123456789-+.e /\n\r\t#"[fuzz_below(20)]; break;
    case 3: {
        uint32_t const v = numbers[fuzz_below(sizeof numbers / sizeof numbers[0])];
        int const big = (int)fuzz_below(2);
        for (size_t i = 0; i < 4 && at + i < size; i++) file[at + i] = (uint8_t)(v >> 8 * (big ? 3 - i : i) & 0xff);
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

int main(int argc, char **argv)
{
    static fuzz_seed seeds[SEEDS];
    unsigned long const inputs = argc > 1 ? strtoul(argv[1], NULL, 10) : 20000;
    unsigned long read = 0;
    bvx_context *const ctx = fuzz_context();
    fuzz_state = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    fuzz_state = fuzz_state * 2 + 1; /* never 0 */
    fuzz_seed_stl(&seeds[0]);
    fuzz_seed_ply(&seeds[1], 0);
    fuzz_seed_ply(&seeds[2], 1);
    fuzz_put_text(&seeds[3], fuzz_stl_text);
    fuzz_put_text(&seeds[4], fuzz_obj_text);
    fuzz_put_text(&seeds[5], fuzz_ply_text);
    seeds[3].format = BVX_FORMAT_STL;
    seeds[4].format = BVX_FORMAT_OBJ;
    seeds[5].format = BVX_FORMAT_PLY;
    fuzz_put_text(&seeds[6], fuzz_obj_coloured);
    fuzz_put_text(&seeds[7], fuzz_ply_coloured);
    fuzz_put_text(&seeds[8], fuzz_off_text);
    fuzz_put_text(&seeds[9], fuzz_off_coloured);
    seeds[6].format = BVX_FORMAT_OBJ;
    seeds[7].format = BVX_FORMAT_PLY;
    seeds[8].format = seeds[9].format = BVX_FORMAT_OFF;
    for (int i = 0; i < SEEDS; i++)
        fuzz_require(fuzz_read(ctx, seeds[i].bytes, seeds[i].size, seeds[i].format) == BVX_OK, bvx_last_message(ctx));
    for (unsigned long i = 0; i < inputs; i++) {
        const fuzz_seed *const seed = &seeds[i % SEEDS];
        static uint8_t work[FUZZ_SIZE];
        size_t size = seed->size;
        memcpy(work, seed->bytes, size);
        for (size_t n = 1 + fuzz_below(4); n > 0 && size > 0; n--) size = fuzz_damage(work, size);
        uint8_t *const exact = malloc(size > 0 ? size : 1); /* so that a sanitizer sees a read beyond the end */
        fuzz_require(exact != NULL, "no memory");
        memcpy(exact, work, size);
        read += fuzz_read(ctx, exact, size, fuzz_below(50) == 0 ? formats[fuzz_below(4)] : seed->format) == BVX_OK;
        free(exact);
    }
    bvx_context_destroy(ctx);
    printf("fuzz_readers: %lu inputs, %lu of them read, 0 failures\n", inputs, read);
    return 0;
}

#endif
