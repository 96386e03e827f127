/* labels.c - the values of a label map: bvx_list_labels.
 *
 * Rows are read as runs of one value. A run is added to its value's entry, which is looked up among all
 * entries by hashing, but mostly is that of the run before. Where the table searches too long, as for values
 * that were made against the hash, a tree takes its place (core/key_tree.h). Guarantee: ascending values;
 * nothing of the table's order is seen. */
#include "core/key_tree.h"
#include "volume/room.h"
#include "mesh/mesh.h"

static const char labels_name[] = "bvx_list_labels";

enum { FIRST_LABELS = 64 };

/* One value; high is the last voxel of its box. */
typedef struct label_entry {
    uint64_t value, voxels;
    int32_t low[3], high[3];
} label_entry;

typedef struct label_table {
    bvx_context *ctx;
    label_entry *entries;
    uint32_t *slots;      /* entry and 1, 0 for none [Size: 2 * room]; NULL beside the tree */
    uint64_t count, room; /* room is a power of two */
    uint64_t skip;        /* the value that is not listed */
    uint64_t searches, probes;
    bvxi_key_tree tree;
} label_table;

static uint64_t label_slot(label_table *t, uint64_t value)
{
    /* Higher bits of a product by an odd constant: neighbours spread over the table. */
    uint64_t h = (value ^ value >> 32) * UINT64_C(0x9e3779b97f4a7c15);
    t->searches++;
    h = (h >> 29) & (2 * t->room - 1);
    for (; t->slots[h] != 0 && t->entries[t->slots[h] - 1].value != value; t->probes++)
        h = (h + 1) & (2 * t->room - 1);
    return h;
}

/* A bvxi_key_fn. */
static void label_key(const void *user, uint64_t number, uint32_t key[BVXI_KEY_WORDS])
{
    const label_table *const t = user;
    key[0] = (uint32_t)t->entries[number].value;
    key[1] = (uint32_t)(t->entries[number].value >> 32);
}

static void free_label_slots(label_table *t)
{
    bvxi_drop(t->ctx, t->slots);
    t->slots = NULL;
}

static bvx_status grow_labels(label_table *t)
{
    uint64_t const room = t->room == 0 ? FIRST_LABELS : 2 * t->room;

    if (room > UINT32_MAX / 2)
        return bvxi_fail_for(t->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%s: more than 2^30 labels",
                             labels_name);

    free_label_slots(t);
    BVXI_TRY(bvxi_resize(t->ctx, BVXI_SCRATCH, &t->entries, t->room * sizeof *t->entries,
                         room * sizeof *t->entries, "the labels"));
    t->room = room;
    if (t->tree.key != NULL) return bvxi_key_tree_grow(t->ctx, &t->tree, room);
    BVXI_TRY(BVXI_ZEROS(t->ctx, 2 * room, "the table of labels", t->slots));
    for (uint64_t i = 0; i < t->count; i++) t->slots[label_slot(t, t->entries[i].value)] = (uint32_t)(i + 1);
    return BVX_OK;
}

static bvx_status find_label(label_table *t, uint64_t value, uint64_t *entry)
{
    if (t->count == t->room) BVXI_TRY(grow_labels(t));
    /* Far more probes than a good hash needs: someone made these values against it. */
    if (t->tree.key == NULL && t->probes > bvxi_probe_limit(t->searches)) {
        free_label_slots(t);
        BVXI_TRY(bvxi_key_tree_open(t->ctx, &t->tree, label_key, t, t->room));
        for (uint64_t i = 0; i < t->count; i++) bvxi_key_tree_find(&t->tree, i);
    }
    /* The entry is written first: where the value is new, it is there already. */
    t->entries[t->count].value = value;
    if (t->tree.key != NULL) {
        *entry = bvxi_key_tree_find(&t->tree, t->count);
    } else {
        uint64_t const slot = label_slot(t, value);
        if (t->slots[slot] == 0) t->slots[slot] = (uint32_t)(t->count + 1);
        *entry = t->slots[slot] - 1;
    }
    if (*entry == t->count) {
        label_entry *const e = &t->entries[t->count++];
        e->voxels = 0;
        for (int a = 0; a < 3; a++) {
            e->low[a] = INT32_MAX;
            e->high[a] = -1;
        }
    }
    return BVX_OK;
}

static bvx_status list_row(label_table *t, const bvx_volume_view *v, const uint8_t *row, int64_t step,
                           int32_t y, int32_t z, uint64_t *last)
{
    int64_t const size = bvxi_type_size(v->sample_type);
    int32_t const n = v->size[0];
    for (int32_t x = 0; x < n;) {
        uint64_t const value = bvxi_whole_sample(row + (ptrdiff_t)(x * step), v->sample_type);
        int32_t const begin = x;
        /* Eight bytes that equal those one sample later lie in one run. */
        for (x++; step == size && x <= n - 8 / (int32_t)size; x += 8 / (int32_t)size)
            if (memcmp(row + (ptrdiff_t)(x * step), row + (ptrdiff_t)((x - 1) * step), 8) != 0) break;
        while (x < n && bvxi_whole_sample(row + (ptrdiff_t)(x * step), v->sample_type) == value) x++;
        if (value == t->skip) continue;
        /* Mostly the value of the run before; only others are searched for. */
        if (*last >= t->count || t->entries[*last].value != value) BVXI_TRY(find_label(t, value, last));

        label_entry *const e = &t->entries[*last];
        int32_t const low[3] = {begin, y, z}, high[3] = {x - 1, y, z};
        e->voxels += (uint64_t)(x - begin);
        for (int a = 0; a < 3; a++) {
            if (low[a] < e->low[a]) e->low[a] = low[a];
            if (high[a] > e->high[a]) e->high[a] = high[a];
        }
    }
    return BVX_OK;
}

static bvx_status list_volume(label_table *t, const bvx_volume_view *v, const int64_t stride[3])
{
    const uint8_t *const first = v->samples;
    uint64_t last = 0;
    for (int32_t z = 0; z < v->size[2]; z++) {
        BVXI_TRY(bvxi_progress(t->ctx, "labels", (double)z / (double)v->size[2]));
        for (int32_t y = 0; y < v->size[1]; y++)
            BVXI_TRY(
                list_row(t, v, first + (ptrdiff_t)(y * stride[1] + z * stride[2]), stride[0], y, z, &last));
    }
    return BVX_OK;
}

/* Ascending; those of signed types begin with the negative ones. */
static bvx_status give_labels(label_table *t, int is_signed, bvx_label *labels)
{
    uint64_t const flip = is_signed ? UINT64_C(1) << 63 : 0;
    uint64_t *keys = NULL;
    uint32_t *order = NULL;

    BVXI_TRY(bvxi_alloc(t->ctx, BVXI_SCRATCH, t->count * 8, "the labels' order", &keys));
    BVXI_TRY(bvxi_alloc(t->ctx, BVXI_SCRATCH, t->count * 4, "the labels' numbers", &order));
    /* The highest bit turned: negative values come first. */
    for (uint64_t i = 0; i < t->count; i++) {
        keys[i] = t->entries[i].value ^ flip;
        order[i] = (uint32_t)i;
    }
    BVXI_TRY(bvxi_radix_sort(t->ctx, keys, order, t->count));
    for (uint64_t i = 0; i < t->count; i++) {
        const label_entry *const e = &t->entries[order[i]];
        memset(&labels[i], 0, sizeof labels[i]);
        memcpy(&labels[i].value, &e->value, sizeof e->value);
        labels[i].voxels = e->voxels;
        for (int a = 0; a < 3; a++) {
            labels[i].low[a] = e->low[a];
            labels[i].size[a] = e->high[a] - e->low[a] + 1;
        }
    }
    return BVX_OK;
}

bvx_status bvxi_make_label_list(bvx_context *ctx, const bvx_volume_view *volume, const int64_t stride[3],
                                uint64_t skip, bvx_label **labels, uint64_t *count)
{
    label_table t = {.ctx = ctx, .skip = skip};
    BVXI_TRY(list_volume(&t, volume, stride));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, t.count * sizeof **labels, "the labels", labels));
    *count = t.count;
    return t.count == 0 ? BVX_OK : give_labels(&t, volume->sample_type % 2 == 0, *labels);
}

static bvx_status run_list_labels(bvx_context *context, const bvx_volume_view *volume, bvx_label *labels,
                                  uint64_t capacity, uint64_t *count)
{
    int64_t stride[3];

    if (count == NULL) return bvxi_fail_null(context, labels_name, "count");
    BVXI_TRY(bvxi_volume_check(context, labels_name, volume, stride));
    if (volume->sample_type >= BVX_SAMPLE_F32)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: the samples are floats; labels are whole numbers",
                         labels_name);
    label_table t = {.ctx = context};
    BVXI_TRY(list_volume(&t, volume, stride));
    /* The count is given even where the array is too small. */
    *count = t.count;
    if (labels != NULL && capacity < t.count)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: there are %u labels, the array holds %u",
                         labels_name, t.count, capacity);
    else if (labels != NULL && t.count != 0) BVXI_TRY(give_labels(&t, volume->sample_type % 2 == 0, labels));
    return BVX_OK;
}

bvx_status bvx_list_labels(bvx_context *context, const bvx_volume_view *volume, bvx_label *labels,
                           uint64_t capacity, uint64_t *count)
{
    return BVXI_CALL(context, run_list_labels(context, volume, labels, capacity, count));
}
