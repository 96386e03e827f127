/* merge.c - surfaces of windows joined by their keys: bvx_mesh_merge.
 *
 * Vertices on a shared layer come from both windows with one key and one position; sorting by key brings them
 * together and puts everything into the whole's order. Triangles of a cell come from one window, in the order
 * of its slots, which a stable sort keeps. Guarantee: the bytes of the surface extracted at once. */
#include "mesh/mesh.h"

static const char merge_name[] = "bvx_mesh_merge";

typedef struct merge_work {
    const bvx_mesh *parts;
    uint64_t part_count, vertices, triangles; /* of all parts */
    uint64_t *keys;                           /* [Size: the greater of both] */
    uint32_t *order, *renumber;               /* [Size: the greater of both], [Size: vertices] */
    uint64_t entries;
} merge_work;

static bvx_status check_parts(bvx_context *ctx, merge_work *w)
{
    const bvx_mesh *const first = w->parts;

    for (uint64_t p = 0; p < w->part_count; p++) {
        const bvx_mesh *const m = &w->parts[p];
        BVXI_TRY(bvxi_mesh_check_reserved(ctx, merge_name, m));
        /* before sums of them could wrap */
        if (m->vertex_count >= UINT32_MAX || m->triangle_count >= UINT32_MAX)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: part %i has %u vertices and %u triangles; 2^32 - 2 are possible",
                                 merge_name, p, m->vertex_count, m->triangle_count);
        if (m->vertex_count != 0 && (m->positions == NULL || m->vertex_keys == NULL))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                                 "%s: part %i has no vertex keys; extract it with keys", merge_name, p);
        if (m->triangle_count != 0 && (m->triangles == NULL || m->triangle_keys == NULL))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                                 "%s: part %i has no triangle keys; extract it with keys", merge_name, p);
        if (m->position_type != first->position_type ||
            (m->position_type != BVX_F32 && m->position_type != BVX_F64))
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                                 "%s: part %i has another position type than part 0", merge_name, p);
        for (int32_t a = 0; a < 3; a++)
            if (!(m->frame[a] == first->frame[a]))
                return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                                     "%s: part %i has another frame than part 0", merge_name, p);
        for (uint64_t i = 0; i < 3 * m->triangle_count; i++)
            if (m->triangles[i] >= m->vertex_count)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                     "%s: triangle %i of part %u has vertex %u; the part has %u", merge_name,
                                     i / 3, p, (uint64_t)m->triangles[i], m->vertex_count);
        w->vertices += m->vertex_count;
        w->triangles += m->triangle_count;
    }
    if (w->vertices >= UINT32_MAX || w->triangles >= UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the parts have %u vertices and %u triangles; 2^32 - 1 are possible",
                             merge_name, w->vertices, w->triangles);
    w->entries = w->vertices > w->triangles ? w->vertices : w->triangles;
    return BVX_OK;
}

/* Sort the parts' keys of one kind; order[n] is the place among all parts of the n-th. */
static bvx_status sort_keys(bvx_context *ctx, merge_work *w, int triangles)
{
    uint64_t n = 0;

    BVXI_TRY(bvxi_progress(ctx, "merge", triangles ? 0.5 : 0.0));
    /* Keys of all parts, one after the other; their place names part and number. */
    for (uint64_t p = 0; p < w->part_count; p++) {
        const bvx_mesh *const m = &w->parts[p];
        uint64_t const count = triangles ? m->triangle_count : m->vertex_count;
        const uint64_t *const keys = triangles ? m->triangle_keys : m->vertex_keys;
        for (uint64_t i = 0; i < count; i++, n++) {
            w->keys[n] = keys[i];
            w->order[n] = (uint32_t)n;
        }
    }
    return bvxi_radix_sort(ctx, w->keys, w->order, n);
}

/* The part of a place among all, by bisection over running totals kept in the caller's array. */
static uint64_t part_of(const uint64_t *start, uint64_t part_count, uint64_t place)
{
    uint64_t low = 0, high = part_count;
    while (high - low > 1) {
        uint64_t const middle = low + (high - low) / 2;
        if (start[middle] <= place) low = middle;
        else high = middle;
    }
    return low;
}

static void start_parts(const merge_work *w, int triangles, uint64_t *start)
{
    uint64_t total = 0;
    for (uint64_t p = 0; p < w->part_count; p++) {
        start[p] = total;
        total += triangles ? w->parts[p].triangle_count : w->parts[p].vertex_count;
    }
}

static bvx_status merge_parts(bvx_context *ctx, merge_work *w, uint64_t *start, uint64_t *vertex_start,
                              bvx_mesh *whole)
{
    /* All keys together say how many vertices there are, before any is made. */
    BVXI_TRY(sort_keys(ctx, w, 0));
    uint64_t different = w->vertices != 0;
    for (uint64_t i = 1; i < w->vertices; i++) different += w->keys[i] != w->keys[i - 1];
    start_parts(w, 0, vertex_start);
    BVXI_TRY(bvxi_mesh_open(ctx, merge_name, w->parts[0].position_type, 1, different, w->triangles, whole));
    memcpy(whole->frame, w->parts[0].frame, sizeof whole->frame);
    size_t const bytes = whole->position_type == BVX_F32 ? 12 : 24;
    uint64_t n = 0;

    for (uint64_t i = 0; i < w->vertices; i++) {
        uint64_t const place = w->order[i];
        /* The first of equal keys gives the position: they are the same in all parts. */
        if (i == 0 || w->keys[i] != w->keys[i - 1]) {
            uint64_t const p = part_of(vertex_start, w->part_count, place);
            memcpy((unsigned char *)whole->positions + n * bytes,
                   (const unsigned char *)w->parts[p].positions + (place - vertex_start[p]) * bytes, bytes);
            whole->vertex_keys[n++] = w->keys[i];
        }
        w->renumber[place] = (uint32_t)(n - 1);
    }
    bvx_status const status = sort_keys(ctx, w, 1);
    if (status != BVX_OK) {
        bvx_mesh_free(ctx, whole);
        return status;
    }
    start_parts(w, 1, start);
    for (uint64_t i = 0; i < w->triangles; i++) {
        uint64_t const place = w->order[i], p = part_of(start, w->part_count, place);
        const uint32_t *const from = w->parts[p].triangles + 3 * (place - start[p]);
        for (int32_t c = 0; c < 3; c++)
            whole->triangles[3 * i + (uint64_t)c] = w->renumber[vertex_start[p] + from[c]];
        whole->triangle_keys[i] = w->keys[i];
    }
    return BVX_OK;
}

static bvx_status run_mesh_merge(bvx_context *context, const bvx_mesh *parts, uint64_t part_count,
                                 bvx_mesh *whole)
{
    uint64_t *start = NULL, mark;
    bvx_mesh made = {0};

    if (parts == NULL || whole == NULL)
        return bvxi_fail_null(context, merge_name, parts == NULL ? "parts" : "whole");
    if (part_count == 0) return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: there are no parts", merge_name);
    /* Arrays of the caller's are filled; the library's own are replaced once the new ones are whole. */
    int const brought = whole->owned != 1 && (whole->positions != NULL || whole->triangles != NULL);
    if (brought) made = *whole;
    merge_work w = {.parts = parts, .part_count = part_count};
    BVXI_TRY(check_parts(context, &w));
    mark = bvxi_scratch_begin(context);
    BVXI_TRY(bvxi_alloc(context, BVXI_SCRATCH, w.entries * 8, "the keys", &w.keys));
    BVXI_TRY(bvxi_alloc(context, BVXI_SCRATCH, w.entries * 4, "the order", &w.order));
    BVXI_TRY(bvxi_alloc(context, BVXI_SCRATCH, w.vertices * 4, "the new numbers", &w.renumber));
    BVXI_TRY(bvxi_alloc(context, BVXI_SCRATCH, part_count * 16, "the parts' places", &start));
    BVXI_TRY(bvxi_scratch_end(context, mark, merge_parts(context, &w, start, start + part_count, &made)));

    if (!brought) bvx_mesh_free(context, whole);
    *whole = made;
    return BVX_OK;
}

bvx_status bvx_mesh_merge(bvx_context *context, const bvx_mesh *parts, uint64_t part_count, bvx_mesh *whole)
{
    return BVXI_CALL(context, run_mesh_merge(context, parts, part_count, whole));
}
