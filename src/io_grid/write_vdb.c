/* write_vdb.c - a grid or the distances of a field to OpenVDB's file: active voxels as a tree of bits or numbers.
 *
 * Source: Museth. VDB: High-Resolution Sparse Volumes with Dynamic Topology. 2013; file version 224 of OpenVDB.
 *
 * Leaves have 8 voxels a side, nodes above them 16 leaves, nodes above those 32 such nodes; bits and values run z
 * fastest. Blocks of one kind are tiles: active ones of a mask, or inactive ones that are inside or outside of a
 * field. Index 0,0,0 is the window's first voxel, at its centre. Values of inactive voxels are left out, by the
 * format's own rule (COMPRESS_ACTIVE_MASK): false, or + and - the background. The file is laid out twice by the
 * same steps, to count and to fill. */
#include "field/room.h"
#include "io_grid/grid_formats.h"

enum {
    VDB_SIDE = 8,
    VDB_WORDS = 512,
    VDB_BY_ACTIVE = 2 /* the compression */,
    VDB_SELECTED = 3 /* + or - the background */
};
enum { VDB_OUTSIDE, VDB_INSIDE, VDB_BELOW }; /* of a block: a tile, or a node below */

/* Blocks of one size; those beyond the ends are outside. */
typedef struct vdb_blocks {
    uint8_t *kind;
    int32_t n[3];
} vdb_blocks;

typedef struct vdb_file {
    const bvx_grid *active, *shape; /* of a mask both are the grid; shape without words: nothing is inside */
    const bvx_field *field;         /* NULL: a mask */
    uint64_t bytes;                 /* of a number */
    double background;
    vdb_blocks level[3]; /* leaves, nodes of leaves, nodes of those */
    bvxi_output out;
} vdb_file;

static int block_kind(const vdb_blocks *b, const int32_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] >= b->n[a]) return VDB_OUTSIDE;
    return b
        ->kind[((uint64_t)at[2] * (uint64_t)b->n[1] + (uint64_t)at[1]) * (uint64_t)b->n[0] + (uint64_t)at[0]];
}

/* ---- which blocks are leaves, nodes, tiles ---- */

/* The leaves of 64 voxels along x at once: what is set in some, and in all, of their rows. */
static void find_leaves(const vdb_file *f, int32_t y, int32_t z, int32_t word, uint8_t *kind, int32_t count)
{
    const bvx_grid *const g = f->active, *const s = f->shape;
    int const whole = y * VDB_SIDE + VDB_SIDE <= g->size[1] && z * VDB_SIDE + VDB_SIDE <= g->size[2];
    uint64_t active = 0, some = 0, all = whole ? UINT64_MAX : 0;

    for (int32_t k = z * VDB_SIDE; k < z * VDB_SIDE + VDB_SIDE && k < g->size[2]; k++)
        for (int32_t j = y * VDB_SIDE; j < y * VDB_SIDE + VDB_SIDE && j < g->size[1]; j++) {
            uint64_t const at = ((uint64_t)k * (uint64_t)g->size[1] + (uint64_t)j) *
                                    (uint64_t)g->words_per_row +
                                (uint64_t)word;
            uint64_t const w = s->words != NULL ? s->words[at] : 0;

            some |= w;
            all &= w;
            if (f->field != NULL) active |= g->words[at];
        }
    for (int32_t i = 0; i < count; i++, active >>= 8, some >>= 8, all >>= 8)
        kind[i] = (active & 255) == 0 && (some & 255) == 0    ? VDB_OUTSIDE
                  : (active & 255) == 0 && (all & 255) == 255 ? VDB_INSIDE
                                                              : VDB_BELOW;
}

static bvx_status find_blocks(bvx_context *ctx, vdb_file *f)
{
    for (int l = 0; l < 3; l++) {
        vdb_blocks *const b = &f->level[l];
        int32_t const side = l == 0 ? VDB_SIDE : l == 1 ? 16 : 32;
        uint8_t *kind;
        int32_t at[3];

        for (int a = 0; a < 3; a++) {
            int32_t const below = l == 0 ? f->active->size[a] : f->level[l - 1].n[a];
            b->n[a] = below / side + (below % side != 0);
        }
        BVXI_TRY(BVXI_ARRAY(ctx, (uint64_t)b->n[0] * (uint64_t)b->n[1] * (uint64_t)b->n[2],
                            "the blocks of the tree", b->kind));
        kind = b->kind;
        for (at[2] = 0; at[2] < b->n[2]; at[2]++)
            for (at[1] = 0; at[1] < b->n[1]; at[1]++)
                for (at[0] = 0; at[0] < b->n[0];
                     at[0] += l == 0 ? VDB_SIDE : 1, kind += l == 0 ? VDB_SIDE : 1) {
                    int32_t const left = b->n[0] - at[0];
                    int32_t in[3], first;

                    if (l == 0) {
                        find_leaves(f, at[1], at[2], at[0] / VDB_SIDE, kind,
                                    left < VDB_SIDE ? left : VDB_SIDE);
                        if (left < VDB_SIDE) kind -= VDB_SIDE - left;
                        continue;
                    }
                    for (int a = 0; a < 3; a++) in[a] = at[a] * side;
                    first = block_kind(&f->level[l - 1], in);
                    *kind = (uint8_t)first;
                    for (int32_t i = 0; i < side * side * side && *kind == first; i++) {
                        int32_t const p[3] = {in[0] + i % side, in[1] + i / side % side,
                                              in[2] + i / side / side};
                        if (block_kind(&f->level[l - 1], p) != first) *kind = VDB_BELOW;
                    }
                }
        BVXI_TRY(bvxi_progress(ctx, "write", 0.1 * (l + 1)));
    }
    return BVX_OK;
}

/* ---- numbers and texts ---- */

static void put_u32(vdb_file *f, uint32_t v)
{
    uint8_t b[4];
    bvxi_store_u32(b, v);
    bvxi_output_add(&f->out, b, 4);
}

static void put_words(vdb_file *f, const uint64_t *words, uint64_t count)
{
    uint8_t b[8];

    for (uint64_t i = 0; i < count; i++) {
        bvxi_store_u64(b, words[i]);
        bvxi_output_add(&f->out, b, 8);
    }
}

static void put_double(vdb_file *f, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    put_words(f, &bits, 1);
}

/* In the type of the tree. */
static void put_value(vdb_file *f, double v)
{
    uint8_t b[8] = {0};

    if (f->bytes == 4) bvxi_store_f32(b, bvxi_field_float(v));
    if (f->bytes == 8) bvxi_store_f64(b, v);
    bvxi_output_add(&f->out, b, (size_t)f->bytes);
}

static void put_text(vdb_file *f, const char *text)
{
    put_u32(f, (uint32_t)bvxi_text_length(text));
    bvxi_output_print(&f->out, "%s", text);
}

static void put_node_place(vdb_file *f, const int32_t at[3], int32_t side)
{
    for (int a = 0; a < 3; a++) put_u32(f, (uint32_t)(at[a] * side));
}

/* ---- leaves ---- */

/* The eight voxels along x of a row, of which bit 0 is the first. */
static uint64_t row_byte(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    if (y >= g->size[1] || z >= g->size[2] || g->words == NULL) return 0;
    return bvxi_grid_row(g, y, z)[x / 8] >> x % 8 * 8 & 255;
}

/* Word x, bit 8 y + z. */
static void leaf_words(const bvx_grid *g, const int32_t at[3], uint64_t word[8])
{
    memset(word, 0, 64);
    for (int32_t y = 0; y < 8; y++) {
        uint64_t t = 0, m;

        for (int32_t z = 0; z < 8; z++) t |= row_byte(g, at[0], 8 * at[1] + y, 8 * at[2] + z) << 8 * z;
        /* Byte z, bit x becomes byte x, bit z. */
        m = (t ^ t >> 7) & UINT64_C(0x00aa00aa00aa00aa), t ^= m ^ m << 7;
        m = (t ^ t >> 14) & UINT64_C(0x0000cccc0000cccc), t ^= m ^ m << 14;
        m = (t ^ t >> 28) & UINT64_C(0x00000000f0f0f0f0), t ^= m ^ m << 28;
        for (int32_t x = 0; x < 8; x++) word[x] |= (t >> 8 * x & 255) << 8 * y;
    }
}

/* The index of the first value at or after a voxel of a row. */
static uint64_t rank_in_row(const bvx_field *field, int32_t x, int32_t y, int32_t z)
{
    const bvx_grid *const g = &field->band;
    const uint64_t *const row = bvxi_grid_row(g, y, z);
    uint64_t rank = field->row_values[(uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y];

    for (int32_t k = 0; k < x / 64; k++) rank += (uint64_t)bvxi_popcount(row[k]);
    return x % 64 == 0 ? rank : rank + (uint64_t)bvxi_popcount(row[x / 64] << (64 - x % 64));
}

static void put_values(vdb_file *f, const int32_t at[3], const uint64_t word[8])
{
    double value[VDB_WORDS];

    for (int32_t y = 0; y < 8; y++)
        for (int32_t z = 0; z < 8; z++) {
            uint64_t byte = row_byte(f->active, at[0], 8 * at[1] + y, 8 * at[2] + z), rank;

            if (byte == 0) continue;
            rank = rank_in_row(f->field, 8 * at[0], 8 * at[1] + y, 8 * at[2] + z);
            for (int32_t x = 0; byte != 0; x++, byte >>= 1)
                if ((byte & 1) != 0) {
                    value[64 * x + 8 * y + z] = f->bytes == 4
                                                    ? (double)((const float *)f->field->distances)[rank]
                                                    : ((const double *)f->field->distances)[rank];
                    rank++;
                }
        }
    for (int32_t i = 0; i < VDB_WORDS; i++)
        if ((word[i / 64] >> i % 64 & 1) != 0) put_value(f, value[i]);
}

/* Its bits; again, with its values, where the tree is there. */
static void put_leaf_node(vdb_file *f, const int32_t at[3], int values)
{
    static const uint8_t selected = VDB_SELECTED;
    uint64_t word[8] = {0}, shape[8] = {0};

    if (f->out.bytes != NULL) leaf_words(f->active, at, word);
    put_words(f, word, 8);
    if (!values) return;
    if (f->field == NULL) {
        put_node_place(f, at, VDB_SIDE);
        put_words(f, word, 8);
        return;
    }
    bvxi_output_add(&f->out, &selected, 1);
    if (f->out.bytes != NULL) leaf_words(f->shape, at, shape);
    for (int x = 0; x < 8; x++) shape[x] = ~shape[x];
    put_words(f, shape, 8);
    if (f->out.bytes != NULL) put_values(f, at, word);
}

/* ---- nodes ---- */

/* A node of level 2 or 1 at a place among those; its masks and tiles, then what is below, or the values of that. */
static void put_node(vdb_file *f, int level, const int32_t at[3], int values)
{
    int32_t const side = level == 2 ? 32 : 16, count = side * side * side;
    uint64_t mask[3][VDB_WORDS] = {{0}}; /* below, active tiles, outside */
    uint64_t tiles = 0;
    uint8_t const kind = f->field != NULL ? VDB_SELECTED : 0;

    for (int32_t i = 0; i < count; i++) {
        int32_t const p[3] = {at[0] * side + i / side / side, at[1] * side + i / side % side,
                              at[2] * side + i % side};
        int const is = block_kind(&f->level[level - 1], p);

        mask[0][i / 64] |= (uint64_t)(is == VDB_BELOW) << i % 64;
        mask[1][i / 64] |= (uint64_t)(is == VDB_INSIDE && f->field == NULL) << i % 64;
        mask[2][i / 64] |= (uint64_t)(is != VDB_INSIDE) << i % 64;
        tiles += is == VDB_INSIDE && f->field == NULL;
    }
    if (!values) {
        put_words(f, mask[0], (uint64_t)count / 64);
        put_words(f, mask[1], (uint64_t)count / 64);
        bvxi_output_add(&f->out, &kind, 1);
        if (f->field != NULL) put_words(f, mask[2], (uint64_t)count / 64);
        for (; tiles > 0; tiles--) bvxi_output_add(&f->out, "\1", 1);
    }
    for (int32_t i = 0; i < count; i++) {
        int32_t const p[3] = {at[0] * side + i / side / side, at[1] * side + i / side % side,
                              at[2] * side + i % side};

        if ((mask[0][i / 64] >> i % 64 & 1) == 0) continue;
        if (level == 2) put_node(f, 1, p, values);
        else put_leaf_node(f, p, values);
    }
}

/* All nodes below the root, or their number. */
static uint32_t put_nodes(vdb_file *f, int put, int values)
{
    const vdb_blocks *const b = &f->level[2];
    uint32_t nodes = 0;
    int32_t at[3];

    for (at[0] = 0; at[0] < b->n[0]; at[0]++)
        for (at[1] = 0; at[1] < b->n[1]; at[1]++)
            for (at[2] = 0; at[2] < b->n[2]; at[2]++) {
                if (block_kind(b, at) == VDB_OUTSIDE) continue;
                nodes++;
                if (put && !values) put_node_place(f, at, VDB_SIDE * 16 * 32);
                if (put) put_node(f, 2, at, values);
            }
    return nodes;
}

/* ---- the file ---- */

static void put_transform(vdb_file *f)
{
    const double *const s = f->active->lattice.spacing;
    double corner[3];

    bvxi_grid_corner(f->active, corner);
    put_text(f, s[0] == s[1] && s[1] == s[2] ? "UniformScaleTranslateMap" : "ScaleTranslateMap");
    for (int a = 0; a < 3; a++) put_double(f, corner[a] + 0.5 * s[a]);
    for (int a = 0; a < 6; a++) put_double(f, s[a % 3]);
    for (int a = 0; a < 3; a++) put_double(f, 1.0 / s[a]);
    for (int a = 0; a < 3; a++) put_double(f, 1.0 / s[a] * (1.0 / s[a]));
    for (int a = 0; a < 3; a++) put_double(f, 0.5 / s[a]);
}

static void put_file(vdb_file *f)
{
    static const char uuid[] = "00000000-0000-0000-0000-000000000000", head[8] = {' ', 'B', 'D', 'V'};
    const char *const name = f->field != NULL ? "distance" : "solid";
    uint64_t place, grid, block;

    f->out.size = 0;
    bvxi_output_add(&f->out, head, sizeof head);
    put_u32(f, 224); /* file, library */
    put_u32(f, 9);
    put_u32(f, 0);
    bvxi_output_print(&f->out, "\1%s", uuid); /* places of grids are there */
    put_u32(f, 0);                            /* remarks on the file */
    put_u32(f, 1);                            /* grids */
    put_text(f, name);
    put_text(f, f->bytes == 1 ? "Tree_bool_5_4_3" : f->bytes == 4 ? "Tree_float_5_4_3" : "Tree_double_5_4_3");
    put_u32(f, 0); /* no instance of another */
    place = f->out.size;
    for (int i = 0; i < 6; i++) put_u32(f, 0);

    grid = f->out.size;
    put_u32(f, VDB_BY_ACTIVE);
    put_u32(f, f->field != NULL && f->shape->words != NULL ? 2 : 1);
    put_text(f, "name");
    put_text(f, "string");
    put_text(f, name);
    if (f->field != NULL && f->shape->words != NULL) {
        put_text(f, "class");
        put_text(f, "string");
        put_text(f, "level set");
    }
    put_transform(f);
    put_u32(f, 1); /* buffers */
    put_value(f, f->background);
    put_u32(f, 0); /* tiles of the root */
    put_u32(f, put_nodes(f, 0, 0));
    put_nodes(f, 1, 0);
    block = f->out.size;
    put_nodes(f, 1, 1);
    if (f->out.bytes == NULL) return;
    bvxi_store_u64(f->out.bytes + place, grid);
    bvxi_store_u64(f->out.bytes + place + 8, block);
    bvxi_store_u64(f->out.bytes + place + 16, f->out.size);
}

bvx_status bvxi_write_vdb(bvx_context *ctx, const bvx_grid *grid, const bvx_field *field, bvx_buffer *file)
{
    vdb_file f = {.active = grid, .shape = grid, .field = field, .bytes = 1};
    uint64_t values = 0;

    BVXI_TRY(bvxi_check_written_corner(ctx, "VDB", grid));
    if (field != NULL) {
        f.shape = &field->inside;
        f.bytes = field->value_type == BVX_F32 ? 4 : 8;
        f.background = field->half_width;
        values = field->value_count * f.bytes; /* not counted by the leaves */
        /* Where all centres have a value, one beyond the lattice is as far as that is long. */
        if (f.background - f.background != 0.0) f.background = 0.0;
        for (int a = 0; a < 3 && !(field->half_width - field->half_width == 0.0); a++)
            f.background += (double)grid->size[a] * grid->lattice.spacing[a];
    }
    BVXI_TRY(find_blocks(ctx, &f));
    put_file(&f);
    BVXI_TRY(bvxi_progress(ctx, "write", 0.5));
    BVXI_TRY(bvxi_make_buffer(ctx, f.out.size + values, "the VDB file", file));
    f.out.bytes = file->bytes;
    put_file(&f);
    return BVX_OK;
}
