/* weld_triangles.h - triangles that bring their own corners, as STL has them, to an indexed mesh. Not
 * installed. */
#ifndef BVXI_WELD_TRIANGLES_H
#define BVXI_WELD_TRIANGLES_H

#include "core/key_tree.h"
#include "io_mesh/mesh_formats.h"

enum { BVXI_SOUP_BATCH = 256 }; /* triangles */

/* The mesh as it grows, and the triangles that wait for their vertices' numbers. */
typedef struct bvxi_soup {
    bvxi_source *source;
    float *positions;    /* scratch */
    uint32_t *triangles; /* scratch, or the result when the count is known */
    /* vertex index plus 1, or 0; scratch, size a power of two, at most half full; NULL: the tree is used */
    uint32_t *table;
    bvxi_key_tree tree;
    uint64_t probes; /* steps from slot to slot of the table */
    uint64_t vertex_count, vertex_room, triangle_count, triangle_room, table_size;
    int32_t triangle_kind;                 /* BVXI_RESULT or BVXI_SCRATCH */
    uint32_t waiting;                      /* triangles in the batch */
    uint32_t bits[BVXI_SOUP_BATCH * 3][3]; /* coordinates as 32-bit floats without -0 */
    uint64_t hash[BVXI_SOUP_BATCH * 3];
} bvxi_soup;

/* Ready a zeroed soup. count: of all triangles, 0 when it is not known.
 * Freed by bvxi_soup_free, also after a failure. */
bvx_status bvxi_soup_begin(bvxi_soup *soup, bvxi_source *source, uint64_t count);

/* Number the vertices of the triangles that wait. Vertices at equal
 * coordinates are one, numbered by their first corner. */
bvx_status bvxi_soup_weld(bvxi_soup *soup);

/* Hand over arrays of exact size when no triangle waits any more. The mesh has one triangle at least. */
bvx_status bvxi_soup_finish(bvxi_soup *soup, bvx_mesh *mesh);
void bvxi_soup_free(bvxi_soup *soup);

/* The bits of a coordinate, 0 for -0. */
static inline uint32_t bvxi_soup_bits(float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits << 1 == 0 ? 0 : bits;
}

#endif
