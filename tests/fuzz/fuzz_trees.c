/* fuzz_trees.c - the octree reader on damaged files: no crash, no leak, an error in words, or a tree that is written to the same
 * bytes and can be asked anything.
 *
 * A libFuzzer target: the input is the file. With BVX_FUZZ_MAIN it is a program of its own that damages trees of a few
 * tetrahedra by a fixed generator: fuzz_trees [inputs [seed]]. */
#include "bitvox.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_MEMORY = 16 << 20 };

static void fuzz_require(int good, const char *what)
{
    if (good) return;
    fprintf(stderr, "fuzz_trees: %s\n", what);
    abort();
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

/* ---- what a tree that was read must stand ---- */

static void fuzz_check_writing(bvx_context *ctx, const bvx_octree *tree, const uint8_t *data, size_t size)
{
    bvx_buffer b = {0};
    fuzz_require(bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &b) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(b.size == size && memcmp(b.bytes, data, size) == 0, "a tree that is written to other bytes");
    bvx_buffer_free(ctx, &b);
}

/* Every leaf is found at its own place, and its neighbours are leaves too. */
static void fuzz_check_leaves(bvx_context *ctx, const bvx_octree *tree)
{
    int32_t const levels = bvx_octree_levels(tree);
    uint64_t count = 0;
    bvx_octree_leaf *leaf;
    fuzz_require(bvx_octree_leaves(ctx, tree, 7, NULL, 0, &count) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(count > 0, "a tree without leaves");
    leaf = malloc((size_t)count * sizeof *leaf);
    fuzz_require(leaf != NULL, "no memory");
    fuzz_require(bvx_octree_leaves(ctx, tree, 7, leaf, count, &count) == BVX_OK, bvx_last_message(ctx));
    for (uint64_t n = 0; n < count; n += 1 + count / 50) {
        bvx_octree_leaf found;
        int32_t v[3];
        for (int a = 0; a < 3; a++) v[a] = leaf[n].ijk[a] << (levels - leaf[n].level);
        fuzz_require(bvx_octree_at(ctx, tree, v, 1, &found) == BVX_OK, bvx_last_message(ctx));
        fuzz_require(memcmp(&found, &leaf[n], sizeof found) == 0, "a leaf that is not at its place");
        for (int32_t d = 0; d < 6; d++) {
            uint64_t beside = 0;
            fuzz_require(bvx_octree_neighbours(ctx, tree, &leaf[n], d, NULL, 0, &beside) == BVX_OK, bvx_last_message(ctx));
        }
    }
    free(leaf);
}

static void fuzz_check_queries(bvx_context *ctx, const bvx_octree *tree)
{
    static const double rays[12] = {-1, 2, 3, 1, 0.1, 0.2, 2, 2, 2, 0.3, -0.4, 0.5};
    bvx_octree_level level[26];
    bvx_octree_hit hit[2];
    bvx_lattice lattice;
    bvx_mesh mesh = {0};
    fuzz_require(bvx_octree_count(ctx, tree, level, 26) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(bvx_octree_cast(ctx, tree, 0, rays, 2, 1e9, hit) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(bvx_octree_lattice(ctx, tree, bvx_octree_levels(tree), &lattice) == BVX_OK, bvx_last_message(ctx));
    if (lattice.dims[0] > 256 || lattice.dims[1] > 256 || lattice.dims[2] > 256) return;
    (void)bvx_extract_octree(ctx, tree, 0, NULL, &mesh); /* lattices of any place and spacing have no surface in floats */
    bvx_mesh_free(ctx, &mesh);
}

static bvx_status fuzz_read(bvx_context *ctx, const uint8_t *data, size_t size)
{
    bvx_octree *tree = NULL;
    bvx_status const status = bvx_read_octree(ctx, data, size, &tree);
    if (status == BVX_OK) {
        fuzz_require(tree != NULL, "no tree");
        fuzz_check_writing(ctx, tree, data, size);
        fuzz_check_leaves(ctx, tree);
        fuzz_check_queries(ctx, tree);
    } else {
        const char *const message = bvx_last_message(ctx);
        fuzz_require(tree == NULL, "a tree behind an error");
        fuzz_require(strlen(message) > 10 && strchr(message, '\n') == NULL, "an error without a line of words");
        fuzz_require(status == BVX_ERR_FORMAT || status == BVX_ERR_UNSUPPORTED || status == BVX_ERR_BUDGET, "an error of another kind");
    }
    bvx_octree_free(ctx, tree);
    fuzz_require(bvx_memory_used(ctx) == 0, "memory that is not given back");
    return status;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bvx_context *const ctx = fuzz_context();
    if (size > 0) fuzz_read(ctx, data, size);
    bvx_context_destroy(ctx);
    return 0;
}

#if defined(BVX_FUZZ_MAIN)

enum { FUZZ_SIZE = 16384, FUZZ_SEEDS = 5, FUZZ_HEAD = 128, FUZZ_LEVEL = 24 };

typedef struct fuzz_seed {
    size_t size;
    uint8_t bytes[FUZZ_SIZE];
} fuzz_seed;

static uint64_t fuzz_state;

static size_t fuzz_below(size_t n)
{
    fuzz_state ^= fuzz_state << 13;
    fuzz_state ^= fuzz_state >> 7;
    fuzz_state ^= fuzz_state << 17;
    return (size_t)((fuzz_state >> 16) % n); /* the same on machines of 32 bits */
}

/* Whole, with a window, with a tolerance, the base alone, one voxel of many levels. */
static void fuzz_seed_of(bvx_context *ctx, int kind, fuzz_seed *s)
{
    static const float positions[24] = {0.2f, 0.3f, 0.4f, 4.7f, 0.5f, 0.6f, 1, 4.2f, 0.7f, 2, 2, 4.4f, 3, 3, 3, 4.5f, 3, 3, 3, 4.1f, 3, 3, 3, 4.6f};
    static const uint32_t triangles[24] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 4, 6, 5, 4, 5, 7, 5, 6, 7, 6, 4, 7};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {5, 5, 5}, one[3] = {1, 1, 1};
    bvx_mesh_view view = {0};
    bvx_refine_options o;
    bvx_lattice base;
    bvx_octree *tree = NULL;
    bvx_buffer b = {0};
    view.positions = positions;
    view.indices = triangles;
    view.vertex_count = 8;
    view.triangle_count = 8;
    view.position_type = BVX_F32;
    view.index_type = BVX_U32;
    bvx_refine_options_init(&o, sizeof o);
    o.levels = kind == 3 ? 0 : kind == 4 ? 9 : 3;
    if (kind == 2) o.tolerance = 0.05;
    for (int a = 0; a < 3 && (kind == 1 || kind == 4); a++) {
        o.window.low[a] = kind == 1 ? 10 : 100;
        o.window.size[a] = kind == 1 ? 6 : 1;
    }
    fuzz_require(bvx_lattice_make(ctx, origin, spacing, kind == 4 ? one : dims, &base) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(bvx_refine(ctx, &view, &base, &o, &tree) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &b) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(b.size <= FUZZ_SIZE, "a seed that is too long");
    memcpy(s->bytes, b.bytes, (size_t)b.size);
    s->size = (size_t)b.size;
    bvx_buffer_free(ctx, &b);
    bvx_octree_free(ctx, tree);
}

/* One damage: a bit, a byte, a number, a piece copied, cut out, or a tail cut off. */
static size_t fuzz_damage(uint8_t *file, size_t size)
{
    static const uint32_t numbers[] = {0, 1, 2, 3, 0xffffffffu, 0x7fffffffu, 0x80000000u, 0xffff, 256, 1 << 25, 1 << 28};
    size_t const at = fuzz_below(2) == 0 ? fuzz_below(size) : fuzz_below(size < 256 ? size : 256);
    switch (fuzz_below(6)) {
    case 0:
    case 1: file[at] ^= (uint8_t)(1u << fuzz_below(8)); break;
    case 2: file[at] = (uint8_t)fuzz_below(256); break;
    case 3: {
        uint32_t const v = numbers[fuzz_below(sizeof numbers / sizeof numbers[0])];
        size_t const whole = at & ~(size_t)3;
        for (size_t i = 0; i < 4 && whole + i < size; i++) file[whole + i] = (uint8_t)(v >> 8 * i & 0xff);
        break;
    }
    case 4: { /* words twice, or cut out */
        size_t const n = 8 * (1 + fuzz_below(4));
        if (n > size - at) break;
        if (fuzz_below(2) == 0) {
            memmove(file + at, file + at + n, size - at - n);
            return size - n;
        }
        if (size + n > FUZZ_SIZE) break;
        memmove(file + at + n, file + at, size - at);
        return size + n;
    }
    default: return fuzz_below(4) == 0 ? at + 1 : size;
    }
    return size;
}

static void fuzz_store(uint8_t *p, uint64_t v)
{
    for (int i = 0; i < 8; i++) p[i] = (uint8_t)(v >> 8 * i & 0xff);
}

/* Right checksums again, as far as the levels can be followed: else nothing behind them would ever be tried. */
static void fuzz_seal(uint8_t *file, size_t size)
{
    uint64_t frame;
    size_t at = FUZZ_HEAD;
    if (size < at) return;
    fuzz_store(file + 120, bvx_hash(file, 120, 0));
    frame = bvx_hash(file + 16, 104, 0);
    while (size - at >= FUZZ_LEVEL) {
        uint64_t const arrays = file[at + 12] == 2 ? 3 : 2;
        uint64_t n = 0;
        for (int i = 8; i-- > 0;) n = n << 8 | file[at + 16 + (size_t)i];
        if (n > (size - at - FUZZ_LEVEL) / 8 / arrays) return;
        n *= 8 * arrays;
        fuzz_store(file + at, bvx_hash(file + at + 8, FUZZ_LEVEL - 8 + (size_t)n, frame));
        at += FUZZ_LEVEL + (size_t)n;
    }
}

int main(int argc, char **argv)
{
    static fuzz_seed seeds[FUZZ_SEEDS];
    static uint8_t work[FUZZ_SIZE];
    unsigned long const inputs = argc > 1 ? strtoul(argv[1], NULL, 10) : 20000;
    unsigned long read = 0;
    bvx_context *const ctx = fuzz_context();
    fuzz_state = argc > 2 ? strtoul(argv[2], NULL, 10) : 1;
    fuzz_state = fuzz_state * 2 + 1; /* never 0 */
    for (int i = 0; i < FUZZ_SEEDS; i++) {
        fuzz_seed_of(ctx, i, &seeds[i]);
        fuzz_require(fuzz_read(ctx, seeds[i].bytes, seeds[i].size) == BVX_OK, bvx_last_message(ctx));
    }
    for (unsigned long i = 0; i < inputs; i++) {
        const fuzz_seed *const seed = &seeds[i % FUZZ_SEEDS];
        size_t size = seed->size;
        memcpy(work, seed->bytes, size);
        for (size_t n = 1 + fuzz_below(3); n > 0 && size > 0; n--) size = fuzz_damage(work, size);
        if (fuzz_below(8) != 0) fuzz_seal(work, size);
        if (size == 0) continue;
        uint8_t *const exact = malloc(size); /* so that a sanitizer sees a read beyond the end */
        fuzz_require(exact != NULL, "no memory");
        memcpy(exact, work, size);
        read += fuzz_read(ctx, exact, size) == BVX_OK;
        free(exact);
    }
    bvx_context_destroy(ctx);
    printf("fuzz_trees: %lu inputs, %lu of them read, 0 failures\n", inputs, read);
    return 0;
}

#endif
