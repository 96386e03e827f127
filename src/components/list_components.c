/* list_components.c - the connected parts of a grid, listed and as numbers of voxels: bvx_grid_components,
 * bvx_grid_label.
 *
 * Runs are joined to spaces (components.c); their numbers are handed out to boxes and counts, or to the
 * voxels of each row.
 * Guarantee: exact; numbers follow from the least voxels only. */
#include "components/room.h"

static const char parts_name[] = "bvx_grid_components";
static const char label_name[] = "bvx_grid_label";

typedef struct parts_list {
    const bvx_grid *grid;
    bvx_component *parts;
    uint32_t seen;
} parts_list;

/* size holds the box's high end until all runs were seen. */
static void list_part_run(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    parts_list *const list = user;
    bvx_component *const p = &list->parts[space];

    if (space == list->seen) { /* spaces are numbered as they come */
        const bvx_grid *const g = list->grid;
        memset(p, 0, sizeof *p);
        p->first = ((uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y) * (uint64_t)g->size[0] +
                   (uint64_t)begin;
        p->low[0] = begin;
        p->low[1] = y;
        p->low[2] = z;
        list->seen++;
    }

    p->voxels += (uint64_t)(end - begin);
    p->low[0] = begin < p->low[0] ? begin : p->low[0];
    p->low[1] = y < p->low[1] ? y : p->low[1];
    p->size[0] = end > p->size[0] ? end : p->size[0];
    p->size[1] = y + 1 > p->size[1] ? y + 1 : p->size[1];
    p->size[2] = z + 1;
}

static bvx_status run_grid_components(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                      bvx_component *parts, uint64_t capacity, uint64_t *count)
{
    bvxi_spaces spaces;
    if (count == NULL) return bvxi_fail_null(context, parts_name, "count");
    BVXI_TRY(bvxi_grid_check(context, parts_name, grid));
    BVXI_TRY(bvxi_check_connectivity(context, parts_name, connectivity));
    BVXI_TRY(bvxi_spaces_open(context, parts_name, "components", grid, 0, connectivity, &spaces));
    /* The count is known even where the array is too short, so that the caller can make a longer one. */
    *count = spaces.count;
    if (parts != NULL && spaces.count > capacity)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the grid has %u parts, the array given holds %u",
                         parts_name, spaces.count, capacity);
    if (parts != NULL) {
        parts_list list = {spaces.grid, parts, 0};
        bvxi_spaces_each(&spaces, list_part_run, &list);
        for (uint64_t i = 0; i < spaces.count; i++)
            for (int32_t a = 0; a < 3; a++) parts[i].size[a] -= parts[i].low[a];
    }
    return BVX_OK;
}

bvx_status bvx_grid_components(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                               bvx_component *parts, uint64_t capacity, uint64_t *count)
{
    return BVXI_CALL(context, run_grid_components(context, grid, connectivity, parts, capacity, count));
}

/* A word's voxels; label: after the run at the word's begin. Returns where it stands at its end. */
static const uint32_t *label_word(uint64_t w, uint64_t last, const uint32_t *label, uint32_t *to)
{
    uint64_t starts = w & ~(w << 1 | last);

    /* Which way is quicker depends on how long the runs are. */
    if (bvxi_popcount(w) < 4 * bvxi_popcount(starts)) { /* short runs: voxel by voxel */
        for (; w != 0; w &= w - 1) {
            int32_t const x = bvxi_lowest(w);
            label += starts >> x & 1;
            to[x] = label[-1] + 1;
        }
        return label;
    }
    while (w != 0) {
        int32_t const begin = bvxi_lowest(w);
        uint64_t const rest = ~(w >> begin); /* 0 when the run fills the word */
        int32_t const end = rest == 0 ? BVXI_WORD_BITS : begin + bvxi_lowest(rest);
        label += starts >> begin & 1;
        uint32_t const value = label[-1] + 1;
        for (int32_t x = begin; x < end; x++) to[x] = value;
        w &= end == BVXI_WORD_BITS ? 0 : ~UINT64_C(0) << end;
    }
    return label;
}

static const uint32_t *label_row(const uint64_t *row, int32_t size, const uint32_t *label, uint32_t *to)
{
    uint64_t last = 0;
    memset(to, 0, (size_t)size * sizeof *to);
    for (int32_t k = 0; k * BVXI_WORD_BITS < size; k++) {
        uint64_t const w = size - k * BVXI_WORD_BITS < BVXI_WORD_BITS ? row[k] & bvxi_tail_mask(size)
                                                                      : row[k];
        if (w != 0) label = label_word(w, last, label, to + (size_t)k * BVXI_WORD_BITS);
        last = w >> 63;
    }
    return label;
}

enum {
    VOXELS_BETWEEN_REPORTS = 1 << 22 /* 16 MB of numbers: some hundredths of a second where memory is new */
};

/* Empty rows are cleared as one stretch: large ones cost no reading of what is overwritten. */
static bvx_status label_rows(bvx_context *ctx, const bvxi_spaces *spaces, uint32_t *labels)
{
    const bvx_grid *const g = spaces->grid;
    const uint32_t *label = spaces->parts.label;
    const uint64_t *row = g->words;
    size_t const nx = (size_t)g->size[0], slice = nx * (size_t)g->size[1];
    size_t empty = 0; /* voxels before labels that are still to be cleared */
    size_t due = 0;   /* voxels until the next report */

    for (int32_t z = 0; z < g->size[2]; z++) {
        if (due < slice) {
            /* What is cleared late would keep the next report waiting. */
            memset(labels - empty, 0, empty * sizeof *labels);
            empty = 0;
            BVXI_TRY(bvxi_progress(ctx, "label", (double)z / (double)g->size[2]));
            due = VOXELS_BETWEEN_REPORTS;
        }
        due = due > slice ? due - slice : 0;
        for (int32_t y = 0; y < g->size[1]; y++, row += g->words_per_row, labels += nx) {
            uint64_t any = 0;
            for (int32_t k = 0; k < g->words_per_row; k++) any |= row[k];
            if (any == 0) {
                empty += nx;
                continue;
            }

            /* The empty rows before this one, all at once. */
            memset(labels - empty, 0, empty * sizeof *labels);
            empty = 0;
            label = label_row(row, g->size[0], label, labels);
        }
    }
    memset(labels - empty, 0, empty * sizeof *labels);
    return BVX_OK;
}

static bvx_status run_grid_label(bvx_context *context, const bvx_grid *grid, int32_t connectivity,
                                 uint32_t *labels, uint64_t capacity, uint64_t *count)
{
    uint64_t voxels = 1;
    bvxi_spaces spaces;
    int ok = 1;

    if (labels == NULL) return bvxi_fail_null(context, label_name, "labels");
    BVXI_TRY(bvxi_grid_check(context, label_name, grid));
    BVXI_TRY(bvxi_check_connectivity(context, label_name, connectivity));
    for (int32_t a = 0; a < 3; a++) voxels = bvxi_mul(voxels, (uint64_t)grid->size[a], &ok);
    if (!ok || capacity < voxels)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: the window has %u voxels, the array given holds %u",
                         label_name, voxels, capacity);
    /* Runs are joined by words; each voxel's number is written, mostly to memory that is new. */
    BVXI_TRY(BVXI_SHARE(context, 0.0, 0.2,
                        bvxi_spaces_open(context, label_name, "components", grid, 0, connectivity, &spaces)));
    BVXI_TRY(BVXI_SHARE(context, 0.2, 1.0, label_rows(context, &spaces, labels)));
    if (count != NULL) *count = spaces.count;
    return BVX_OK;
}

bvx_status bvx_grid_label(bvx_context *context, const bvx_grid *grid, int32_t connectivity, uint32_t *labels,
                          uint64_t capacity, uint64_t *count)
{
    return BVXI_CALL(context, run_grid_label(context, grid, connectivity, labels, capacity, count));
}
