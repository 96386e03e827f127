/* weld.c - which vertices stand at the same position.
 *
 * Vertices enter an open table in the order of their numbers, so the one found there is always the least of its
 * position, whatever the table looks like. Positions are compared, never their hashes alone.
 * Cost: O(vertices) for input that was not made against the hash. */
#include "mesh/weld.h"
#include "mesh/view.h"

/* 31 well mixed bits of a position; adding 0 makes -0 the same as 0. */
static uint32_t weld_hash(const double p[3])
{
    uint64_t h = 0, bits;
    double x;
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

/* table[slot] is a vertex number plus 1, or 0. */
static uint64_t weld_into(const bvx_mesh_view *v, uint32_t *table, uint64_t size, uint32_t *representative)
{
    uint64_t different = 0;
    double p[3], q[3];
    for (uint64_t i = 0; i < v->vertex_count; i++) {
        bvxi_view_position(v, i, p);
        uint64_t slot = (uint64_t)weld_hash(p) * size >> 31; /* size < 2^33 */
        for (;; slot = slot + 1 == size ? 0 : slot + 1) {
            uint32_t const other = table[slot];
            if (other == 0) {
                table[slot] = (uint32_t)(i + 1);
                representative[i] = (uint32_t)i;
                different++;
                break;
            }
            bvxi_view_position(v, other - 1, q);
            if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) {
                representative[i] = other - 1;
                break;
            }
        }
    }
    return different;
}

bvx_status bvxi_weld(bvx_context *ctx, const bvx_mesh_view *view, uint32_t *representative, uint64_t *different)
{
    uint64_t const size = weld_table_size(view->vertex_count);
    uint32_t *table;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, size * sizeof *table, "the welding table", &table));
    *different = weld_into(view, table, size, representative);
    bvxi_free(ctx, table, size * sizeof *table);
    return BVX_OK;
}
