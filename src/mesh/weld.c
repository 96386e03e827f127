/* weld.c - which vertices stand at the same position.
 *
 * Vertices enter an open table in the order of their numbers, so the one found there is always the least of
 * its position, whatever the table looks like. Positions are compared, never their hashes only. Where the
 * table searches too long, as for input that was made against the hash, a tree begins anew (core/key_tree.h).
 * Cost: O(vertices). */
#include "mesh/topology.h"
#include "core/key_tree.h"
#include "mesh/view.h"

enum { WELD_ASKS = 1 << 20 }; /* vertices between asking progress */

static inline bvx_status weld_ask(bvx_context *ctx, const bvx_mesh_view *v, uint64_t i)
{
    if (BVXI_UNLIKELY(i % WELD_ASKS == WELD_ASKS - 1))
        return bvxi_progress(ctx, "weld", (double)i / (double)v->vertex_count);
    return BVX_OK;
}

/* 31 well mixed bits of a position; adding 0 makes -0 the same as 0. */
static uint32_t weld_hash(const double p[3])
{
    uint64_t h = 0, bits;
    double x;

    /* Each coordinate is mixed in before the next, so that equal bits at other places give another hash. */
    for (int a = 0; a < 3; a++) {
        x = p[a] + 0.0;
        memcpy(&bits, &x, sizeof bits);
        h = (h ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
        h ^= h >> 29;
    }
    h *= UINT64_C(0xbf58476d1ce4e5b9);
    return (uint32_t)(h >> 33);
}

static uint64_t weld_table_size(uint64_t vertices)
{
    return vertices + vertices / 2 + 1;
}

/* table[slot] is a vertex index plus 1, or 0. *different becomes 0 when it was searched too long. */
static bvx_status weld_into(bvx_context *ctx, const bvx_mesh_view *v, uint32_t *table, uint64_t size,
                            uint32_t *representative, uint64_t *different)
{
    uint64_t const limit = bvxi_probe_limit(v->vertex_count);
    uint64_t found = 0, probes = 0;
    double p[3], q[3];

    *different = 0;
    for (uint64_t i = 0; i < v->vertex_count; i++) {
        BVXI_TRY(weld_ask(ctx, v, i));
        bvxi_view_position(v, i, p);

        /* The high bits of the hash times the size spread over the table without a division. */
        uint64_t slot = (uint64_t)weld_hash(p) * size >> 31; /* size < 2^33 */
        for (;; slot = slot + 1 == size ? 0 : slot + 1, probes++) {
            uint32_t const other = table[slot];
            if (other == 0) {
                table[slot] = (uint32_t)(i + 1);
                representative[i] = (uint32_t)i;
                found++;
                break;
            }
            bvxi_view_position(v, other - 1, q);
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
                representative[i] = other - 1;
                break;
            }
        }
        /* Too many steps so far: whatever was found is thrown away, and the tree begins anew. */
        if (BVXI_UNLIKELY(probes > limit)) return BVX_OK;
    }
    *different = found;
    return BVX_OK;
}

/* A bvxi_key_fn: the bits of a position. */
static void weld_key(const void *user, uint64_t vertex, uint32_t key[BVXI_KEY_WORDS])
{
    double p[3];
    bvxi_view_position(user, vertex, p);
    for (int a = 0; a < 3; a++) p[a] += 0.0;
    memcpy(key, p, sizeof p);
}

static bvx_status weld_by_tree(bvx_context *ctx, const bvx_mesh_view *view, uint32_t *representative,
                               uint64_t *different)
{
    bvx_status status = BVX_OK;
    bvxi_key_tree tree;

    BVXI_TRY(bvxi_key_tree_open(ctx, &tree, weld_key, view, view->vertex_count));
    for (uint64_t i = 0; i < view->vertex_count && status == BVX_OK; i++) {
        status = weld_ask(ctx, view, i);
        representative[i] = (uint32_t)bvxi_key_tree_find(&tree, i);
        /* A vertex that finds itself is the first at its position. */
        *different += representative[i] == i;
    }
    bvxi_key_tree_close(ctx, &tree);
    return status;
}

bvx_status bvxi_weld(bvx_context *ctx, const bvx_mesh_view *view, uint32_t *representative,
                     uint64_t *different)
{
    uint64_t const size = weld_table_size(view->vertex_count);
    uint32_t *table;
    bvx_status status;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, size * sizeof *table, "the welding table", &table));
    status = weld_into(ctx, view, table, size, representative, different);
    bvxi_drop(ctx, table);

    /* No vertex at all has been found different: the mark of a search that was given up. */
    if (status != BVX_OK || *different != 0 || view->vertex_count == 0) return status;
    return weld_by_tree(ctx, view, representative, different);
}
