/* finite.h - a mesh without what is not finite. Not installed. */
#ifndef BVXI_FINITE_H
#define BVXI_FINITE_H

#include "core/core.h"

/* Drop vertices that are not finite and the triangles that use them, in the mesh's
 * own arrays; dropped counts the triangles. BVX_ERR_ARGUMENT, BVX_ERR_RANGE (an
 * index, with its triangle), BVX_ERR_MEMORY, BVX_ERR_BUDGET: the mesh is unchanged. */
bvx_status bvxi_mesh_drop_nonfinite(bvx_context *ctx, const char *function, bvx_mesh *mesh,
                                    uint64_t *dropped);

#endif
