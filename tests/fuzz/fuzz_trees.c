/* fuzz_trees.c - the octree reader on damaged files: no crash, no leak, no more memory than the file's size
 * allows; an error in words, or a tree that is written to the same bytes and can be asked anything. */
#include "fuzz_files.h"

static const fuzz_format formats[] = {
    {"octree", BVX_FORMAT_BVX},
};

enum { FUZZ_HEAD = 128, FUZZ_LEVEL = 24 };

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
            fuzz_require(bvx_octree_neighbours(ctx, tree, &leaf[n], d, NULL, 0, &beside) == BVX_OK,
                         bvx_last_message(ctx));
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
    fuzz_require(bvx_octree_lattice(ctx, tree, bvx_octree_levels(tree), &lattice) == BVX_OK,
                 bvx_last_message(ctx));
    if (lattice.dims[0] > 256 || lattice.dims[1] > 256 || lattice.dims[2] > 256) return;
    /* lattices of any place and spacing have no surface in floats */
    (void)bvx_extract_octree(ctx, tree, 0, NULL, &mesh);
    bvx_mesh_free(ctx, &mesh);
}

static int fuzz_read(bvx_context *ctx, const uint8_t *file, size_t size, int format)
{
    bvx_octree *tree = NULL;
    int const good = fuzz_was_read(ctx, bvx_read_octree(ctx, file, size, &tree), READ_OCTREE, size, 0);

    (void)format;
    fuzz_require(good == (tree != NULL), "a tree behind an error, or none");
    if (good) {
        fuzz_check_writing(ctx, tree, file, size);
        fuzz_check_leaves(ctx, tree);
        fuzz_check_queries(ctx, tree);
    }
    bvx_octree_free(ctx, tree);
    return good;
}

/* ---- files to begin with ---- */

/* Whole, with a window, with a tolerance, the base only, one voxel of many levels. */
static void fuzz_seed_of(bvx_context *ctx, int kind, fuzz_file *s)
{
    static const float positions[24] = {0.2f, 0.3f, 0.4f, 4.7f, 0.5f, 0.6f, 1, 4.2f, 0.7f, 2, 2, 4.4f,
                                        3,    3,    3,    4.5f, 3,    3,    3, 4.1f, 3,    3, 3, 4.6f};
    static const uint32_t triangles[24] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3,
                                           4, 6, 5, 4, 5, 7, 5, 6, 7, 6, 4, 7};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {5, 5, 5}, one[3] = {1, 1, 1};
    bvx_mesh_view view = {0};
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL;
    bvx_buffer b = {0};

    view.positions = positions;
    view.indices = triangles;
    view.vertex_count = 8;
    view.triangle_count = 8;
    view.position_type = BVX_F32;
    view.index_type = BVX_U32;
    o.levels = kind == 3 ? BVX_NONE : kind == 4 ? 9 : 3;
    if (kind == 2) o.tolerance = 0.05;
    for (int a = 0; a < 3 && (kind == 1 || kind == 4); a++) {
        o.window.low[a] = kind == 1 ? 10 : 100;
        o.window.size[a] = kind == 1 ? 6 : 1;
    }
    fuzz_require(bvx_lattice_make(ctx, origin, spacing, kind == 4 ? one : dims, &base) == BVX_OK,
                 bvx_last_message(ctx));
    fuzz_require(bvx_refine(ctx, &view, &base, &o, &tree) == BVX_OK, bvx_last_message(ctx));
    fuzz_require(bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &b) == BVX_OK, bvx_last_message(ctx));
    fuzz_put(s, b.bytes, (size_t)b.size);
    bvx_buffer_free(ctx, &b);
    bvx_octree_free(ctx, tree);
}

static void fuzz_store(uint8_t *p, uint64_t v)
{
    for (int i = 0; i < 8; i++) p[i] = (uint8_t)(v >> 8 * i & 0xff);
}

/* Right checksums again, as far as the levels can be followed: else nothing after them would ever be
 * tried. */
static void fuzz_seal(uint8_t *file, size_t size, int format)
{
    uint64_t frame;
    size_t at = FUZZ_HEAD;

    (void)format;
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

static const char *const fuzz_words[] = {
    "\1", "\2", "\3", "\377\377\377\377\377\377\377\377", "\377\377\377\17", "\200"};

static int fuzz_make_seeds(bvx_context *ctx, fuzz_file *seeds)
{
    int n = 0;
    for (int kind = 0; kind < 5; kind++) fuzz_seed_of(ctx, kind, fuzz_begin_file(seeds, &n, "octree"));
    return n;
}

static const fuzz_target *fuzz_reader(void)
{
    static const fuzz_target target = {formats,        sizeof formats / sizeof formats[0],
                                       fuzz_words,     sizeof fuzz_words / sizeof fuzz_words[0],
                                       fuzz_read,      fuzz_seal,
                                       fuzz_make_seeds};
    return &target;
}
