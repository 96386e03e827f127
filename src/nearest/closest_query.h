/* closest_query.h - what stands behind the public bvx_closest, for other
 * rooms that require nearest points. Not installed. */
#ifndef BVXI_CLOSEST_QUERY_H
#define BVXI_CLOSEST_QUERY_H

#include "nearest/closest.h"

struct bvx_closest {
    bvxi_closest_tree tree;
};

/* Check a mesh and build its search tree, in place; stage, from and to are
 * for progress. The view may go afterwards. On failure nothing is held. */
bvx_status bvxi_closest_open(bvxi_call call, const bvx_mesh_view *mesh, bvx_closest *closest);
void bvxi_closest_shut(bvx_context *ctx, bvx_closest *closest);

/* The nearest point of a finite point. *hint is any number at first and then best left alone from point to
 * point: it makes the search faster and changes nothing. */
void bvxi_closest_ask(const bvx_closest *closest, const double point[3], uint32_t *hint,
                      bvx_closest_point *found);

/* Where on triangle t its closest point q to p lies, as in bvx_closest_point.feature. */
int32_t bvxi_closest_feature(const double p[3], const double t[3][3], const double q[3]);

#endif
