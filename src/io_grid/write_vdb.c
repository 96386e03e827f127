/* write_vdb.c - a grid or the distances of a field to OpenVDB's file: active voxels as a tree of bits or numbers.
 *
 * Source: Museth. VDB: High-Resolution Sparse Volumes with Dynamic Topology. 2013; file version 224 of OpenVDB.
 *
 * Values of inactive voxels are left out, by the format's own rule (COMPRESS_ACTIVE_MASK): false, or + and - the
 * background. The file is laid out twice by the same steps, to count and to fill. */
#include "io_grid/vdb_tree.h"

enum { VDB_BY_ACTIVE = 2 /* the compression */, VDB_SELECTED = 3 /* + or - the background */ };

typedef struct vdb_file {
    bvxi_vdb_tree tree;
    bvxi_output out;
} vdb_file;

/* ---- numbers and texts ---- */

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
    if (f->tree.bytes == 4) bvxi_store_f32(b, bvxi_field_float(v));
    if (f->tree.bytes == 8) bvxi_store_f64(b, v);
    bvxi_output_add(&f->out, b, (size_t)f->tree.bytes);
}

static void put_text(vdb_file *f, const char *text)
{
    bvxi_output_u32(&f->out, bvxi_text_length(text));
    bvxi_output_print(&f->out, "%s", text);
}

static void put_node_place(vdb_file *f, const int32_t at[3], int32_t side)
{
    for (int a = 0; a < 3; a++) bvxi_output_u32(&f->out, (uint32_t)(at[a] * side));
}

/* ---- leaves ---- */

/* Its bits; again, with its values, where the tree is there. */
static void put_leaf_node(vdb_file *f, const int32_t at[3], int values)
{
    static const uint8_t selected = VDB_SELECTED;
    uint64_t word[8] = {0}, shape[8] = {0};
    double value[512];

    if (f->out.bytes != NULL) bvxi_vdb_leaf_bits(f->tree.active, at, word);
    put_words(f, word, 8);
    if (!values) return;
    if (f->tree.field == NULL) {
        put_node_place(f, at, 8);
        put_words(f, word, 8);
        return;
    }
    bvxi_output_add(&f->out, &selected, 1);
    if (f->out.bytes != NULL) bvxi_vdb_leaf_bits(f->tree.shape, at, shape);
    for (int x = 0; x < 8; x++) shape[x] = ~shape[x];
    put_words(f, shape, 8);
    if (f->out.bytes == NULL) return;
    bvxi_vdb_leaf_values(&f->tree, at, value);
    for (int32_t i = 0; i < 512; i++)
        if ((word[i / 64] >> i % 64 & 1) != 0) put_value(f, value[i]);
}

/* ---- nodes ---- */

/* A node of level 2 or 1 at a place among those; its masks and tiles, then what is below, or the values of that. */
static void put_node(vdb_file *f, int level, const int32_t at[3], int values)
{
    int32_t const count = BVXI_VDB_TABLE(level);
    int32_t p[3];
    uint64_t mask[3][BVXI_VDB_WORDS] = {{0}}; /* below, active tiles, outside */
    uint64_t tiles = 0;
    uint8_t const kind = f->tree.field != NULL ? VDB_SELECTED : 0;

    for (int32_t i = 0; i < count; i++) {
        bvxi_vdb_below(level, at, i, p);
        int const is = bvxi_vdb_kind(&f->tree.level[level - 1], p);

        mask[0][i / 64] |= (uint64_t)(is == BVXI_VDB_BELOW) << i % 64;
        mask[1][i / 64] |= (uint64_t)(is == BVXI_VDB_INSIDE && f->tree.field == NULL) << i % 64;
        mask[2][i / 64] |= (uint64_t)(is != BVXI_VDB_INSIDE) << i % 64;
        tiles += is == BVXI_VDB_INSIDE && f->tree.field == NULL;
    }
    if (!values) {
        put_words(f, mask[0], (uint64_t)count / 64);
        put_words(f, mask[1], (uint64_t)count / 64);
        bvxi_output_add(&f->out, &kind, 1);
        if (f->tree.field != NULL) put_words(f, mask[2], (uint64_t)count / 64);
        for (; tiles > 0; tiles--) bvxi_output_add(&f->out, "\1", 1);
    }
    for (int32_t i = 0; i < count; i++) {
        if ((mask[0][i / 64] >> i % 64 & 1) == 0) continue;
        bvxi_vdb_below(level, at, i, p);
        if (level == 2) put_node(f, 1, p, values);
        else put_leaf_node(f, p, values);
    }
}

/* All nodes below the root, or their number. */
static uint32_t put_nodes(vdb_file *f, int put, int values)
{
    const bvxi_vdb_blocks *const b = &f->tree.level[2];
    uint32_t nodes = 0;
    int32_t at[3];

    for (at[0] = 0; at[0] < b->n[0]; at[0]++)
        for (at[1] = 0; at[1] < b->n[1]; at[1]++)
            for (at[2] = 0; at[2] < b->n[2]; at[2]++) {
                if (bvxi_vdb_kind(b, at) == BVXI_VDB_OUTSIDE) continue;
                nodes++;
                if (put && !values) put_node_place(f, at, 8 * 16 * 32);
                if (put) put_node(f, 2, at, values);
            }
    return nodes;
}

/* ---- the file ---- */

static void put_transform(vdb_file *f)
{
    const double *const s = f->tree.active->lattice.spacing;
    put_text(f, s[0] == s[1] && s[1] == s[2] ? "UniformScaleTranslateMap" : "ScaleTranslateMap");
    for (int a = 0; a < 3; a++) put_double(f, f->tree.first[a]);
    for (int a = 0; a < 6; a++) put_double(f, s[a % 3]);
    for (int a = 0; a < 3; a++) put_double(f, 1.0 / s[a]);
    for (int a = 0; a < 3; a++) put_double(f, 1.0 / s[a] * (1.0 / s[a]));
    for (int a = 0; a < 3; a++) put_double(f, 0.5 / s[a]);
}

static void put_file(vdb_file *f)
{
    static const char uuid[] = "00000000-0000-0000-0000-000000000000", head[8] = {' ', 'B', 'D', 'V'};
    const char *const name = f->tree.field != NULL ? "distance" : "solid";
    uint64_t place, grid, block;

    f->out.size = 0;
    bvxi_output_add(&f->out, head, sizeof head);
    bvxi_output_u32(&f->out, 224); /* file, library */
    bvxi_output_u32(&f->out, 9);
    bvxi_output_u32(&f->out, 0);
    bvxi_output_print(&f->out, "\1%s", uuid); /* places of grids are there */
    bvxi_output_u32(&f->out, 0);              /* remarks on the file */
    bvxi_output_u32(&f->out, 1);              /* grids */
    put_text(f, name);
    put_text(f, f->tree.bytes == 1   ? "Tree_bool_5_4_3"
                : f->tree.bytes == 4 ? "Tree_float_5_4_3"
                                     : "Tree_double_5_4_3");
    bvxi_output_u32(&f->out, 0); /* no instance of another */
    place = f->out.size;
    for (int i = 0; i < 6; i++) bvxi_output_u32(&f->out, 0);

    grid = f->out.size;
    bvxi_output_u32(&f->out, VDB_BY_ACTIVE);
    bvxi_output_u32(&f->out, f->tree.field != NULL && f->tree.shape->words != NULL ? 2 : 1);
    put_text(f, "name");
    put_text(f, "string");
    put_text(f, name);
    if (f->tree.field != NULL && f->tree.shape->words != NULL) {
        put_text(f, "class");
        put_text(f, "string");
        put_text(f, "level set");
    }
    put_transform(f);
    bvxi_output_u32(&f->out, 1); /* buffers */
    put_value(f, f->tree.background);
    bvxi_output_u32(&f->out, 0); /* tiles of the root */
    bvxi_output_u32(&f->out, put_nodes(f, 0, 0));
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
    vdb_file f = {.out = {NULL, 0}};

    BVXI_TRY(bvxi_vdb_find_tree(ctx, "VDB", grid, field, &f.tree));
    put_file(&f);
    BVXI_TRY(bvxi_progress(ctx, "write", 0.5));
    /* Values are not counted by the leaves. */
    BVXI_TRY(bvxi_make_buffer(ctx, f.out.size + (field != NULL ? field->value_count * f.tree.bytes : 0),
                              "the VDB file", file));
    f.out.bytes = file->bytes;
    put_file(&f);
    return BVX_OK;
}
