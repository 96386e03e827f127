/* glb_seams.c - vertices repeated where their corners have several texture coordinates.
 *
 * Corners are sorted by vertex and texture coordinate; the sort keeps the order of equal ones, so the first
 * of each group is its first use. One more walk over the corners gives out the numbers.
 * Guarantee: the order is that of first use. Cost: O(corners), whatever the indices are. */
#include "io_mesh/glb.h"
#include "mesh/radix.h"

/* first[corner] becomes the first corner with the same pair. Returns how many pairs there are. */
static uint64_t find_first_corners(const uint64_t *keys, const uint32_t *corner, uint64_t corners,
                                   uint32_t *first)
{
    uint64_t pairs = 0;
    uint32_t leader = 0;

    for (uint64_t i = 0; i < corners; i++) {
        if (i == 0 || keys[i] != keys[i - 1]) {
            leader = corner[i];
            pairs++;
        }
        first[corner[i]] = leader;
    }
    return pairs;
}

static bvx_status sort_corners(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams)
{
    uint64_t const corners = mesh->triangle_count * 3;
    uint64_t *keys = NULL;
    uint32_t *corner = NULL;
    bvx_status status = bvxi_alloc(ctx, BVXI_SCRATCH, corners * 8, "the corners' keys", &keys);

    if (status == BVX_OK)
        status = bvxi_alloc(ctx, BVXI_SCRATCH, corners * 4, "the corners' numbers", &corner);
    if (status == BVX_OK) {
        for (uint64_t c = 0; c < corners; c++) {
            /* Vertex above, texture coordinate below: equal keys
             * are corners that can share one vertex of the file. */
            keys[c] = (uint64_t)mesh->triangles[c] << 32 | mesh->uv_triangles[c];
            corner[c] = (uint32_t)c;
        }
        status = bvxi_radix_sort(ctx, keys, corner, corners);
    }
    if (status == BVX_OK) seams->count = find_first_corners(keys, corner, corners, seams->triangles);
    bvxi_drop(ctx, corner);
    bvxi_drop(ctx, keys);
    return status;
}

/* A corner that is the first of its pair gets the next number; the others have been given theirs before. */
static void number_vertices_by_use(const bvx_mesh *mesh, bvxi_seams *seams)
{
    uint32_t n = 0;

    for (uint64_t c = 0; c < mesh->triangle_count * 3; c++) {
        if (seams->triangles[c] == c) {
            seams->vertex[n] = mesh->triangles[c];
            seams->uv[n] = mesh->uv_triangles[c];
            seams->triangles[c] = n++;
        } else {
            /* The leader comes before its group, so its entry is
             * an index of the file by now, no longer a corner. */
            seams->triangles[c] = seams->triangles[seams->triangles[c]];
        }
    }
}

bvx_status bvxi_split_seams(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams)
{
    bvx_status status;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, mesh->triangle_count * 12, "the triangles with seams",
                        &seams->triangles));
    status = sort_corners(ctx, mesh, seams);

    /* Both lists have one entry a pair, which is known only after the sort. */
    if (status == BVX_OK)
        status = bvxi_alloc(ctx, BVXI_SCRATCH, seams->count * 4, "the vertices at seams", &seams->vertex);
    if (status == BVX_OK)
        status = bvxi_alloc(ctx, BVXI_SCRATCH, seams->count * 4, "the texture coordinates at seams",
                            &seams->uv);
    if (status == BVX_OK) number_vertices_by_use(mesh, seams);
    else bvxi_free_seams(ctx, seams);
    return status;
}

void bvxi_free_seams(bvx_context *ctx, bvxi_seams *seams)
{
    bvxi_drop(ctx, seams->uv);
    bvxi_drop(ctx, seams->vertex);
    bvxi_drop(ctx, seams->triangles);
    memset(seams, 0, sizeof *seams);
}
