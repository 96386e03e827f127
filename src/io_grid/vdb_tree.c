/* vdb_tree.c - which blocks of a grid or field are leaves, nodes and tiles, and what is in a leaf.
 *
 * Source: Museth. VDB: High-Resolution Sparse Volumes with Dynamic Topology. 2013 */
#include "io_grid/vdb_tree.h"

static uint64_t vdb_block_index(const bvxi_vdb_blocks *b, const int32_t at[3])
{
    return ((uint64_t)at[2] * (uint64_t)b->n[1] + (uint64_t)at[1]) * (uint64_t)b->n[0] + (uint64_t)at[0];
}

int bvxi_vdb_kind(const bvxi_vdb_blocks *b, const int32_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] >= b->n[a]) return BVXI_VDB_OUTSIDE;
    return b->kind[vdb_block_index(b, at)];
}

/* The leaves of 64 voxels along x at once: what is set in some, and in all, of their rows. */
static void find_leaves(const bvxi_vdb_tree *t, const int32_t leaf[3], uint8_t *kind, int32_t count)
{
    const bvx_grid *const g = t->active, *const s = t->shape;
    int32_t const y = 8 * leaf[1], z = 8 * leaf[2];
    uint64_t active = 0, some = 0, all = y + 8 <= g->size[1] && z + 8 <= g->size[2] ? UINT64_MAX : 0;

    for (int32_t k = z; k < z + 8 && k < g->size[2]; k++)
        for (int32_t j = y; j < y + 8 && j < g->size[1]; j++) {
            uint64_t const w = s->words != NULL ? bvxi_grid_row(s, j, k)[leaf[0] / 8] : 0;

            some |= w;
            all &= w;
            if (t->field != NULL) active |= bvxi_grid_row(g, j, k)[leaf[0] / 8];
        }
    for (int32_t i = 0; i < count; i++, active >>= 8, some >>= 8, all >>= 8)
        kind[i] = (active & 255) == 0 && (some & 255) == 0    ? BVXI_VDB_OUTSIDE
                  : (active & 255) == 0 && (all & 255) == 255 ? BVXI_VDB_INSIDE
                                                              : BVXI_VDB_BELOW;
}

/* The kind of all that is in a node, or that it is one. */
static uint8_t node_kind(const bvxi_vdb_blocks *below, int level, const int32_t at[3])
{
    int32_t p[3];
    bvxi_vdb_below(level, at, 0, p);
    int const first = bvxi_vdb_kind(below, p);
    for (int32_t i = 1; i < BVXI_VDB_TABLE(level); i++) {
        bvxi_vdb_below(level, at, i, p);
        if (bvxi_vdb_kind(below, p) != first) return BVXI_VDB_BELOW;
    }
    return (uint8_t)first;
}

/* ---- leaves ---- */

/* The eight voxels along x of a row, of which bit 0 is the first. */
static uint64_t row_byte(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    if (y >= g->size[1] || z >= g->size[2] || g->words == NULL) return 0;
    return bvxi_grid_row(g, y, z)[x / 8] >> x % 8 * 8 & 255;
}

void bvxi_vdb_leaf_bits(const bvx_grid *g, const int32_t at[3], uint64_t word[8])
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

void bvxi_vdb_leaf_values(const bvxi_vdb_tree *t, const int32_t at[3], double value[512])
{
    for (int32_t y = 0; y < 8; y++)
        for (int32_t z = 0; z < 8; z++) {
            int32_t const row_y = 8 * at[1] + y, row_z = 8 * at[2] + z, first = 8 * at[0];
            uint64_t byte = row_byte(t->active, at[0], row_y, row_z);

            if (byte == 0) continue;
            /* The index of the first value at or after a voxel of a row. */
            const bvx_grid *const g = &t->field->band;
            const uint64_t *const row = bvxi_grid_row(g, row_y, row_z);
            uint64_t rank = t->field->row_values[(uint64_t)row_z * (uint64_t)g->size[1] + (uint64_t)row_y];
            for (int32_t k = 0; k < first / 64; k++) rank += (uint64_t)bvxi_popcount(row[k]);
            if (first % 64 != 0) rank += (uint64_t)bvxi_popcount(row[first / 64] << (64 - first % 64));
            for (int32_t x = 0; byte != 0; x++, byte >>= 1)
                if ((byte & 1) != 0) {
                    value[64 * x + 8 * y + z] = t->bytes == 4
                                                    ? (double)((const float *)t->field->distances)[rank]
                                                    : ((const double *)t->field->distances)[rank];
                    rank++;
                }
        }
}

bvx_status bvxi_vdb_find_tree(bvx_context *ctx, const char *format, const bvx_grid *grid,
                              const bvx_field *field, bvxi_vdb_tree *t)
{
    BVXI_TRY(bvxi_check_written_corner(ctx, format, grid));
    *t = (bvxi_vdb_tree){.active = grid, .shape = grid, .field = field, .bytes = 1};
    bvxi_grid_corner(grid, t->first);
    for (int a = 0; a < 3; a++) t->first[a] += 0.5 * grid->lattice.spacing[a];
    if (field != NULL) {
        t->shape = &field->inside;
        t->bytes = field->value_type == BVX_F32 ? 4 : 8;
        t->background = field->half_width;
        /* Where all centres have a value, one beyond the lattice is as far as that is long. */
        if (t->background - t->background != 0.0) t->background = 0.0;
        for (int a = 0; a < 3 && !(field->half_width - field->half_width == 0.0); a++)
            t->background += (double)grid->size[a] * grid->lattice.spacing[a];
    }

    for (int l = 0; l < 3; l++) {
        bvxi_vdb_blocks *const b = &t->level[l];
        int32_t const side = l == 0 ? 8 : l == 1 ? 16 : 32, step = l == 0 ? 8 : 1;
        int32_t at[3];

        for (int a = 0; a < 3; a++)
            b->n[a] = ((l == 0 ? t->active->size[a] : t->level[l - 1].n[a]) - 1) / side + 1;
        BVXI_TRY(BVXI_ARRAY(ctx, (uint64_t)b->n[0] * (uint64_t)b->n[1] * (uint64_t)b->n[2],
                            "the blocks of the tree", b->kind));
        for (at[2] = 0; at[2] < b->n[2]; at[2]++)
            for (at[1] = 0; at[1] < b->n[1]; at[1]++)
                for (at[0] = 0; at[0] < b->n[0]; at[0] += step) {
                    uint8_t *const kind = &b->kind[vdb_block_index(b, at)];
                    int32_t const left = b->n[0] - at[0];

                    if (l == 0) find_leaves(t, at, kind, left < step ? left : step);
                    else *kind = node_kind(&t->level[l - 1], l, at);
                }
        BVXI_TRY(bvxi_progress(ctx, "write", 0.1 * (l + 1)));
    }
    return BVX_OK;
}
