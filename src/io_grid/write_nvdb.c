/* write_nvdb.c - a grid or the distances of a field to NanoVDB's file: the tree of OpenVDB as one block of memory.
 *
 * Source: Museth. NanoVDB: A GPU-Friendly and Portable VDB Data Structure For Real-Time Rendering And Simulation.
 * 2021; version 32.4 of NanoVDB, which OpenVDB 10 has.
 *
 * A head of the file with what the grid is; the grid with its map to the world; the tree with how many nodes there
 * are; the root with a tile for each node; nodes of 32 a side, then those of 16, then leaves, in one order. A node
 * names what is below it by the distance in bytes. There are no checksum and no statistics, as flags say.
 * Nodes are counted, then written, by the same steps. */
#include "io_grid/vdb_tree.h"

enum { NVDB_HEAD = 16, NVDB_META = 176, NVDB_GRID = 672, NVDB_ROOT = NVDB_GRID + 64, NVDB_TILE = 32 };
enum { NVDB_VERSION = 32 << 21 | 4 << 10 };
enum {
    NVDB_FLOAT = 1,
    NVDB_DOUBLE = 2,
    NVDB_MASK = 8,
    NVDB_LEVEL_SET = 1,
    NVDB_TOPOLOGY = 6,
    NVDB_BREADTH_FIRST = 32
};

typedef struct nvdb_file {
    bvxi_vdb_tree tree;
    uint8_t *grid; /* NULL: nodes are counted */
    uint64_t begin[3], size[3], count[3],
        tiles[3]; /* leaves, nodes of leaves, nodes of those; active tiles */
} nvdb_file;

static void put_number(const nvdb_file *f, uint8_t *to, double v)
{
    if (f->tree.bytes == 1) *to = v != 0.0;
    else if (f->tree.bytes == 4) bvxi_store_f32(to, bvxi_field_float(v));
    else bvxi_store_f64(to, v);
}

static void put_nvdb_leaf(const nvdb_file *f, const int32_t at[3], uint8_t *leaf)
{
    const bvxi_vdb_tree *const t = &f->tree;
    uint64_t word[8], shape[8];
    double value[512];

    memset(leaf + 12, 7, 3); /* from its first to its last voxel */
    bvxi_vdb_leaf_bits(t->active, at, word);
    for (int i = 0; i < 8; i++) bvxi_store_u64(leaf + 16 + 8 * i, word[i]);
    if (t->field == NULL) return;
    bvxi_vdb_leaf_bits(t->shape, at, shape);
    for (int i = 0; i < 512; i++)
        value[i] = (shape[i / 64] >> i % 64 & 1) != 0 ? 0.0 - t->background : t->background;
    bvxi_vdb_leaf_values(t, at, value);
    leaf += f->size[0] - 512 * t->bytes;
    for (int i = 0; i < 512; i++) put_number(f, leaf + (uint64_t)i * t->bytes, value[i]);
}

/* A node of level 2, 1 or 0 at a place among those, and all below it; where it stands. */
static uint64_t put_nvdb_node(nvdb_file *f, int level, const int32_t at[3])
{
    static const int32_t side[3] = {8, 8 * 16, 8 * 16 * 32};
    uint64_t const place = f->begin[level] + f->count[level]++ * f->size[level];
    uint8_t *const node = f->grid != NULL ? f->grid + place : NULL;
    int32_t p[3];

    if (node != NULL) {
        /* The box of a node, whose flags and statistics stay 0. */
        int const ends = level > 0;
        for (int a = 0; a < 3; a++) {
            bvxi_store_u32(node + 4 * a, (uint32_t)(at[a] * side[level]));
            if (ends) bvxi_store_u32(node + 12 + 4 * a, (uint32_t)(at[a] * side[level] + side[level] - 1));
        }
    }
    if (level == 0) {
        if (node != NULL) put_nvdb_leaf(f, at, node);
        return place;
    }

    /* After the box a bit for each active tile and for each node below; last what each block is. */
    for (int32_t i = 0, blocks = BVXI_VDB_TABLE(level); i < blocks; i++) {
        bvxi_vdb_below(level, at, i, p);
        int const kind = bvxi_vdb_kind(&f->tree.level[level - 1], p);
        int const tile = kind == BVXI_VDB_INSIDE && f->tree.field == NULL;
        uint64_t const child = kind == BVXI_VDB_BELOW ? put_nvdb_node(f, level - 1, p) : 0;

        f->tiles[level - 1] += (uint64_t)tile;
        if (node == NULL) continue;
        uint8_t *const block = node + f->size[level] - 8 * (uint64_t)(blocks - i);
        if (tile) node[32 + i / 8] |= (uint8_t)(1 << i % 8);
        if (child != 0) {
            node[32 + blocks / 8 + i / 8] |= (uint8_t)(1 << i % 8);
            bvxi_store_u64(block, child - place);
        } else {
            put_number(f, block,
                       tile                      ? 1.0
                       : kind == BVXI_VDB_INSIDE ? 0.0 - f->tree.background
                                                 : f->tree.background);
        }
    }
    return place;
}

/* All nodes, and for each of the root's a tile after its head, in the order of their keys. */
static uint32_t put_nvdb_nodes(nvdb_file *f, uint64_t tiles)
{
    const bvxi_vdb_blocks *const b = &f->tree.level[2];
    int32_t at[3];

    memset(f->count, 0, sizeof f->count);
    memset(f->tiles, 0, sizeof f->tiles);
    for (at[0] = 0; at[0] < b->n[0]; at[0]++)
        for (at[1] = 0; at[1] < b->n[1]; at[1]++)
            for (at[2] = 0; at[2] < b->n[2]; at[2]++) {
                if (bvxi_vdb_kind(b, at) == BVXI_VDB_OUTSIDE) continue;
                uint64_t const child = put_nvdb_node(f, 2, at);
                if (f->grid == NULL) continue;
                uint8_t *const tile = f->grid + tiles + NVDB_TILE * (f->count[2] - 1);
                bvxi_store_u64(tile, (uint64_t)at[0] << 42 | (uint64_t)at[1] << 21 | (uint64_t)at[2]);
                bvxi_store_u64(tile + 8, child - NVDB_ROOT);
            }
    return (uint32_t)f->count[2];
}

/* The boxes of active voxels, in the world and in the root: none is from the largest numbers to the smallest. */
static void put_nvdb_bounds(const nvdb_file *f, uint64_t voxels)
{
    const double *const s = f->tree.active->lattice.spacing;
    double const most = 0x1.fffffffffffffp1023;
    bvx_window w;

    bvxi_grid_content(f->tree.active, &w);
    for (int a = 0; a < 3; a++) {
        int32_t const first = w.low[a] - f->tree.active->low[a];
        double const low = f->tree.first[a] + (double)first * s[a];
        uint8_t *const world = f->grid + 560 + 8 * a, *const root = f->grid + NVDB_ROOT + 4 * a;

        bvxi_store_f64(world, voxels > 0 ? low : most);
        bvxi_store_f64(world + 24, voxels > 0 ? low + (double)w.size[a] * s[a] : -most);
        bvxi_store_u32(root, (uint32_t)(voxels > 0 ? first : INT32_MAX));
        bvxi_store_u32(root + 12, (uint32_t)(voxels > 0 ? first + w.size[a] - 1 : INT32_MIN));
    }
}

/* The grid with its map to the world, the tree, the root. */
static void put_nvdb_grid(const nvdb_file *f, const char *name, uint64_t size, uint64_t voxels)
{
    const bvxi_vdb_tree *const t = &f->tree;
    uint8_t *const g = f->grid, *const map = g + 296, *const tree = g + NVDB_GRID;

    memcpy(g, "NanoVDB0", 8);
    memset(g + 8, 255, 8); /* no checksum */
    bvxi_store_u32(g + 16, NVDB_VERSION);
    bvxi_store_u32(g + 20, NVDB_BREADTH_FIRST);
    bvxi_store_u32(g + 28, 1); /* grid */
    bvxi_store_u64(g + 32, size);
    memcpy(g + 40, name, (size_t)bvxi_text_length(name));
    for (int a = 0; a < 3; a++) {
        double const s = t->active->lattice.spacing[a];

        /* Two matrices by rows and what is added, as floats and as doubles. */
        bvxi_store_f32(map + 16 * a, bvxi_field_float(s));
        bvxi_store_f32(map + 36 + 16 * a, bvxi_field_float(1.0 / s));
        bvxi_store_f32(map + 72 + 4 * a, bvxi_field_float(t->first[a]));
        bvxi_store_f64(map + 88 + 32 * a, s);
        bvxi_store_f64(map + 160 + 32 * a, 1.0 / s);
        bvxi_store_f64(map + 232 + 8 * a, t->first[a]);
        bvxi_store_f64(g + 608 + 8 * a, s);
        bvxi_store_u64(tree + 8 * a, f->begin[a] - NVDB_GRID);
        bvxi_store_u32(tree + 32 + 4 * a, (uint32_t)f->count[a]);
        bvxi_store_u32(tree + 44 + 4 * a, (uint32_t)f->tiles[a]);
    }
    bvxi_store_f32(map + 84, 1);
    bvxi_store_f64(map + 256, 1);
    bvxi_store_u32(g + 632, t->field == NULL ? NVDB_TOPOLOGY : t->shape->words != NULL ? NVDB_LEVEL_SET : 0);
    bvxi_store_u32(g + 636, t->bytes == 1 ? NVDB_MASK : t->bytes == 4 ? NVDB_FLOAT : NVDB_DOUBLE);
    bvxi_store_u64(tree + 24, NVDB_ROOT - NVDB_GRID);
    bvxi_store_u64(tree + 56, voxels);
    put_nvdb_bounds(f, voxels);
    bvxi_store_u32(g + NVDB_ROOT + 24, (uint32_t)f->count[2]);
    put_number(f, g + NVDB_ROOT + (t->bytes == 8 ? 32 : 28), t->background);
}

/* What the file says before the grid, which says it again. */
static void put_nvdb_head(const nvdb_file *f, uint8_t *head, const char *name, uint64_t size, uint64_t voxels)
{
    const uint8_t *const g = f->grid;
    uint8_t *const meta = head + NVDB_HEAD;
    uint64_t key = 0, length = bvxi_text_length(name);

    for (uint64_t i = 0; i < length; i++) key = key * 67 + (uint8_t)name[i] + (key >> 56);
    memcpy(head, g, 8);
    bvxi_store_u32(head + 8, NVDB_VERSION);
    bvxi_store_u16(head + 12, 1); /* grid, not packed */
    bvxi_store_u64(meta, size);
    bvxi_store_u64(meta + 8, size);
    bvxi_store_u64(meta + 16, key);
    bvxi_store_u64(meta + 24, voxels);
    memcpy(meta + 32, g + 636, 4);
    memcpy(meta + 36, g + 632, 4);
    memcpy(meta + 40, g + 560, 48);
    memcpy(meta + 88, g + NVDB_ROOT, 24);
    memcpy(meta + 112, g + 608, 24);
    bvxi_store_u32(meta + 136, (uint32_t)length + 1);
    memcpy(meta + 140, g + NVDB_GRID + 32, 12);
    bvxi_store_u32(meta + 152, 1); /* root */
    memcpy(meta + 156, g + NVDB_GRID + 44, 12);
    bvxi_store_u32(meta + 172, NVDB_VERSION);
    memcpy(meta + NVDB_META, name, (size_t)length);
}

bvx_status bvxi_write_nvdb(bvx_context *ctx, const bvx_grid *grid, const bvx_field *field, bvx_buffer *file)
{
    const char *const name = field != NULL ? "distance" : "solid";
    uint64_t const head = NVDB_HEAD + NVDB_META + bvxi_text_length(name) + 1;
    nvdb_file f = {.size = {96, 1088 + 8 * 4096, 8256 + 8 * 32768}};
    uint64_t end, tiles, voxels;

    BVXI_TRY(bvxi_vdb_find_tree(ctx, "NVDB", grid, field, &f.tree));
    BVXI_TRY(bvx_grid_count(ctx, grid, &voxels));

    /* Each part begins at a multiple of 32. */
    tiles = NVDB_ROOT + (f.tree.bytes == 8 ? 96 : 64);
    f.size[0] = f.tree.bytes == 1 ? 96 : f.tree.bytes == 4 ? 96 + 512 * 4 : 128 + 512 * 8;
    end = tiles + NVDB_TILE * put_nvdb_nodes(&f, tiles);
    for (int level = 2; level >= 0; level--) {
        f.begin[level] = end;
        end += f.count[level] * f.size[level];
    }
    BVXI_TRY(bvxi_progress(ctx, "write", 0.5));
    BVXI_TRY(bvxi_make_buffer(ctx, head + end, "the NVDB file", file));
    memset(file->bytes, 0, (size_t)(head + end));
    f.grid = file->bytes + head;
    put_nvdb_nodes(&f, tiles);
    put_nvdb_grid(&f, name, end, voxels);
    put_nvdb_head(&f, file->bytes, name, end, voxels);
    return BVX_OK;
}
