/* label_voxels.c - a label for each voxel of a grid by the material or colour of the mesh's nearest point: bvx_label_voxels.
 *
 * Colours of voxels are sorted, so that each is looked at once. Where there are more than 255, those that share their
 * leading bits become one, their mean: 15 bits of green, red and blue by turns, or fewer, the most that suffice.
 * Guarantee: a voxel's label depends on the mesh and the grid alone; no thread shows in it. */
#include "grid/grid.h"
#include "mesh/mesh.h"
#include "nearest/closest.h"
#include "nearest/nearest_tree.h"

#include <math.h>

enum { LABEL_MOST = 255, LABEL_CELLS = 32 * 32 * 32 };

typedef struct voxel_labels {
    const bvx_mesh *mesh;
    const bvx_grid *grid;
    bvxi_nearest *nearest;
    int by_material;
    uint64_t *first; /* set voxels before each row */
    uint64_t *keys;  /* of each set voxel: its material, or red, green, blue */
    uint32_t *voxel; /* its triangle, then its number, sorted by keys */
} voxel_labels;

/* The colour of a material times that of its triangle's corners at the voxel's closest point, as bytes of sRGB. */
static uint64_t colour_key(const voxel_labels *w, uint32_t triangle, const int32_t voxel[3])
{
    const bvx_mesh *const m = w->mesh;
    const bvx_assets *const assets = m->assets;
    const bvx_lattice *const l = &w->grid->lattice;
    uint32_t const material = m->materials != NULL ? m->materials[triangle] : UINT32_MAX;
    const uint32_t *const corner = m->triangles + 3 * (size_t)triangle;
    bvx_closest_point at;
    uint64_t key = 0;

    if (m->colours != NULL) {
        double p[3], t[3][3], q[3];

        for (int a = 0; a < 3; a++)
            p[a] = (l->origin[a] + ((double)(w->grid->low[a] + voxel[a]) + 0.5) * l->spacing[a]) *
                   w->nearest->scale;
        bvxi_near_corners(w->nearest, triangle, t);
        bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
        bvxi_closest_place(p, (const double(*)[3])t, q, &at);
    }

    for (int i = 0; i < 3; i++) {
        double v = 255.0;

        if (assets != NULL && assets->base_colours != NULL && material < assets->material_count)
            v = (double)assets->base_colours[4 * (size_t)material + (size_t)i];
        if (m->colours != NULL) {
            double sum = 0.0;
            for (int k = 0; k < 3; k++) sum += at.weight[k] * m->colours[4 * (size_t)corner[k] + (size_t)i];
            v = v * sum / 255.0;
        }
        key = key << 8 | (uint64_t)(v >= 255.0 ? 255 : (int32_t)(v + 0.5));
    }
    return key;
}

/* A voxel's key from its triangle, which stands in voxel before the number. */
static void label_slices(void *user, uint64_t begin, uint64_t end)
{
    const voxel_labels *const w = user;
    const bvx_grid *const g = w->grid;

    for (uint64_t z = begin; z < end; z++) {
        uint64_t next = w->first[z * (uint64_t)g->size[1]];

        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t k = 0; k < g->words_per_row; k++)
                for (uint64_t bits = bvxi_grid_row(g, y, (int32_t)z)[k]; bits != 0;
                     bits &= bits - 1, next++) {
                    int32_t const v[3] = {k * BVXI_WORD_BITS + bvxi_lowest(bits), y, (int32_t)z};
                    uint32_t const triangle = w->voxel[next];

                    w->keys[next] = w->by_material ? w->mesh->materials[triangle]
                                                   : colour_key(w, triangle, v);
                    w->voxel[next] = (uint32_t)next;
                }
    }
}

/* ---- a palette of colours in rising order ---- */

typedef struct palette_cell {
    uint64_t sum[3], count;
    uint8_t label;
} palette_cell;

/* Of so many bits, of which green has no fewer than red, and that no fewer than blue. */
static uint32_t cell_of(uint64_t key, int bits)
{
    uint32_t cell = 0;
    for (int a = 0; a < 3; a++) {
        int const own = (bits + (a == 0 ? 1 : a == 1 ? 2 : 0)) / 3;
        cell = cell << own | (uint32_t)(key >> (24 - 8 * a - own) & ((1u << own) - 1));
    }
    return cell;
}

/* Means of the cells of so many bits; returns how many cells there are. */
static uint32_t fill_colour_cells(const voxel_labels *w, uint64_t count, int bits, palette_cell *cell,
                                  uint8_t *palette)
{
    uint32_t used = 0;

    memset(cell, 0, LABEL_CELLS * sizeof *cell);
    for (uint64_t i = 0; i < count; i++) {
        palette_cell *const c = &cell[cell_of(w->keys[i], bits)];
        used += c->count++ == 0;
        for (int a = 0; a < 3; a++) c->sum[a] += w->keys[i] >> (16 - 8 * a) & 255;
    }
    if (used > LABEL_MOST) return used;
    used = 0;
    for (uint32_t k = 0; k < LABEL_CELLS; k++) {
        if (cell[k].count == 0) continue;
        cell[k].label = (uint8_t)++used;
        for (int a = 0; a < 3; a++)
            palette[4 * used + (uint32_t)a] = (uint8_t)((cell[k].sum[a] + cell[k].count / 2) / cell[k].count);
    }
    return used;
}

/* The keys become labels. */
static bvx_status make_palette(bvx_context *ctx, voxel_labels *w, uint64_t count, uint8_t *palette)
{
    palette_cell *cell;
    uint64_t colours = 0;
    int bits = 15;

    BVXI_TRY(bvxi_radix_sort(ctx, w->keys, w->voxel, count));
    for (uint64_t i = 0; i < count; i++) colours += i == 0 || w->keys[i] != w->keys[i - 1];
    if (colours <= LABEL_MOST) {
        uint64_t before = UINT64_MAX;

        colours = 0;
        for (uint64_t i = 0; i < count; i++) {
            uint64_t const key = w->keys[i];
            colours += key != before;
            before = key;
            for (int a = 0; a < 3; a++)
                palette[4 * colours + (uint64_t)a] = (uint8_t)(key >> (16 - 8 * a) & 255);
            w->keys[i] = colours;
        }
        return BVX_OK;
    }
    BVXI_TRY(BVXI_ARRAY(ctx, LABEL_CELLS, "cells of colours", cell));
    while (fill_colour_cells(w, count, bits, cell, palette) > LABEL_MOST) bits--;
    for (uint64_t i = 0; i < count; i++) w->keys[i] = cell[cell_of(w->keys[i], bits)].label;
    return BVX_OK;
}

/* ---- the call ---- */

static bvx_status run_label_voxels(bvx_context *ctx, const bvx_mesh *mesh, const bvx_grid *grid,
                                   uint8_t *labels, uint8_t *palette)
{
    static const char *const function = "bvx_label_voxels";
    voxel_labels w = {.mesh = mesh, .grid = grid};
    bvx_mesh_view view;
    uint64_t next = 0;

    if (mesh == NULL) return bvxi_fail_null(ctx, function, "mesh");
    if (labels == NULL || palette == NULL)
        return bvxi_fail_null(ctx, function, labels == NULL ? "labels" : "palette");
    BVXI_TRY(bvxi_check_carried_mesh(ctx, function, mesh));
    BVXI_TRY(bvxi_grid_check(ctx, function, grid));
    BVXI_TRY(bvxi_grid_check_past(ctx, function, grid));
    uint64_t const materials = mesh->assets != NULL ? mesh->assets->material_count : 0;
    if (mesh->colours == NULL && (mesh->materials == NULL || materials == 0))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: the mesh has neither colours of its vertices nor materials", function);
    if (mesh->materials != NULL && materials != 0 && mesh->assets->textured != 0)
        BVXI_WARN(ctx, BVX_WARN_LOST, (double)mesh->assets->textured);
    w.by_material = mesh->colours == NULL && materials < LABEL_MOST;
    bvx_mesh_view_of(mesh, &view);

    BVXI_TRY(BVXI_ARRAY(ctx, bvxi_grid_rows(grid) + 1, "the rows' numbers", w.first));
    uint64_t const count = bvxi_sparse_number(grid, w.first);
    if (count >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u voxels are set; 2^32 - 2 are possible, label windows of the grid",
                             function, count);
    BVXI_TRY(BVXI_ARRAY(ctx, count, "colours of voxels", w.keys));
    BVXI_TRY(BVXI_ARRAY(ctx, count, "numbers of voxels", w.voxel));
    BVXI_TRY(
        bvxi_nearest_open(bvxi_call_of(ctx, function, "label", 0.0, 0.1), &view, &grid->lattice, &w.nearest));
    bvxi_sparse const triangles = {.where = *grid, .first = w.first, .count = count, .triangles = w.voxel};
    BVXI_TRY(
        bvxi_nearest_fill(bvxi_call_of(ctx, function, "label", 0.1, 0.8), w.nearest, HUGE_VAL, &triangles));
    BVXI_TRY(BVXI_SHARE(ctx, 0.8, 0.9, bvxi_for(ctx, "label", (uint64_t)grid->size[2], 1, label_slices, &w)));
    bvxi_nearest_close(ctx, w.nearest);

    memset(palette, 255, 1024);
    memset(palette, 0, 4);
    if (!w.by_material) BVXI_TRY(make_palette(ctx, &w, count, palette));
    for (uint64_t i = 0; w.by_material && i < materials && mesh->assets->base_colours != NULL; i++)
        memcpy(palette + 4 * (i + 1), mesh->assets->base_colours + 4 * i, 4);

    /* Sorted or not: each voxel has its number among those that are set; its label goes there, then to its place. */
    uint8_t *by_rank;
    BVXI_TRY(BVXI_ARRAY(ctx, count, "labels of voxels", by_rank));
    for (uint64_t i = 0; i < count; i++)
        by_rank[w.voxel[i]] = (uint8_t)(w.by_material ? (w.keys[i] < materials ? w.keys[i] : materials) + 1
                                                      : w.keys[i]);
    uint64_t const rows = bvxi_grid_rows(grid), x = (uint64_t)grid->size[0];
    memset(labels, 0, (size_t)(rows * x));
    for (uint64_t r = 0; r < rows; r++)
        for (int32_t k = 0; k < grid->words_per_row; k++)
            for (uint64_t bits = grid->words[r * (uint64_t)grid->words_per_row + (uint64_t)k]; bits != 0;
                 bits &= bits - 1)
                labels[r * x + (uint64_t)(k * BVXI_WORD_BITS + bvxi_lowest(bits))] = by_rank[next++];
    return BVX_OK;
}

bvx_status bvx_label_voxels(bvx_context *context, const bvx_mesh *mesh, const bvx_grid *grid, uint8_t *labels,
                            uint8_t *palette)
{
    return BVXI_CALL(context, run_label_voxels(context, mesh, grid, labels, palette));
}
