/* edge_vector.c - where a lattice edge is cut, from the vectors to the closest points of both its ends.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013, section 2.3. V and W are
 * the edge's ends, A and B their closest points; the cut lies where the line AB passes nearest to the edge's
 * line. The paper's
 *     lambda = ((VW.AB)(AB.VA) - (AB.AB)(VW.VA)) / ((VW.VW)(AB.AB) - (VW.AB)^2) has the sign the wrong way
 * round: V = (0,0,0), W = (1,0,0), A = (.3,1,.2), B = (.3,-1,.2) must give +0.3. As the edge runs along an
 * axis, the formula shrinks. Seen along the edge, the lines' nearest place is that of AB to a point, so
 *     s = -(AB'.VA') / (AB'.AB'),  lambda = (VA + s AB along the edge) / length where ' leaves out the edge's
 * axis: exact for flat surfaces, and no difference of near-equal products is left.
 *
 * A = B, a flat face square to the edge or one corner closest to both, has no line: A's projection. AB along
 * the edge, or a place beyond its ends: the ratio of the distances, which is the signed distance taken as
 * linear.
 *
 * Ours is BVX_EDGE_TANGENT: the plane through A square to VA touches the surface there, and so does B's.
 * Where each of A and B lies behind the other's plane the solid is what both planes have behind them, and
 * from outside the edge gets in at the later of its two crossings; where both lie in front, at the earlier.
 * That is exact for one and for two flat facets, and nearer than a chord on what is curved. Where A and B
 * disagree, the line's place is taken, s kept between A and B. */
#include "surface/field_surface.h"

/* Squares of lengths in edge lengths. Vectors of f32 hold 2^-22 of an edge in a band of a few voxels. */
#define SAME_POINT2 (1.0 / 1099511627776.0) /* 2^-40: closest points this near are one */
#define NO_NORMAL2  (1.0 / 8589934592.0)    /* 2^-33: vectors shorter than this give no plane */
#define PARALLEL2   (1.0 / 1073741824.0)    /* 2^-30: square of the sine below which AB runs along the edge */

/* The edge from V = 0 to W = (1, 0, 0): A, B from V, and B from W. */
typedef struct unit_cut {
    double a[3], b[3], wb[3];
} unit_cut;

static unit_cut scale_cut(const bvxi_cut_edge *e)
{
    double const scale = 1.0 / e->length;
    unit_cut u;

    for (int32_t k = 0; k < 3; k++) {
        int32_t const axis = e->axis + k < 3 ? e->axis + k : e->axis + k - 3;
        u.a[k] = e->low[axis] * scale;
        u.wb[k] = e->high[axis] * scale;
        u.b[k] = u.wb[k] + (k == 0 ? 1.0 : 0.0);
    }
    return u;
}

/* 1 and the ratio where the line AB gives it, 0 where it runs along the
 * edge or is no number. between: no further than A and B. */
static int cut_by_line(const unit_cut *u, int between, double *ratio)
{
    double const dx = u->b[0] - u->a[0], dy = u->b[1] - u->a[1], dz = u->b[2] - u->a[2];
    double const across2 = dy * dy + dz * dz;
    double s;

    if (dx * dx + across2 <= SAME_POINT2) {
        *ratio = 0.5 * (u->a[0] + u->b[0]);
        return 1;
    }
    if (!(across2 > PARALLEL2 * (dx * dx))) return 0;
    s = -((dy * u->a[1] + dz * u->a[2]) / across2);
    if (between) s = s < 0.0 ? 0.0 : s > 1.0 ? 1.0 : s;
    *ratio = u->a[0] + dx * s;
    return *ratio - *ratio == 0.0;
}

static int is_ratio(double t)
{
    return t >= 0.0 && t <= 1.0;
}

/* 1 and the ratio where the planes at A and B give it. */
static int cut_by_planes(const unit_cut *u, double *ratio)
{
    double const d[3] = {u->b[0] - u->a[0], u->b[1] - u->a[1], u->b[2] - u->a[2]};
    double const aa = u->a[0] * u->a[0] + u->a[1] * u->a[1] + u->a[2] * u->a[2];
    double const bb = u->wb[0] * u->wb[0] + u->wb[1] * u->wb[1] + u->wb[2] * u->wb[2];
    /* > 0: B lies beyond A's plane, seen from V */
    double const b_beyond = d[0] * u->a[0] + d[1] * u->a[1] + d[2] * u->a[2];
    /* > 0: A lies beyond B's plane, seen from W */
    double const a_beyond = -(d[0] * u->wb[0] + d[1] * u->wb[1] + d[2] * u->wb[2]);
    double const p = aa / u->a[0], q = 1.0 + bb / u->wb[0];
    /* V outside: behind A's plane, take the later; V inside: in front of it, the later too */
    int const later = b_beyond > 0.0;

    if (!(aa > NO_NORMAL2) || !(bb > NO_NORMAL2) || later == (a_beyond > 0.0)) return 0;
    if (!is_ratio(p) && !is_ratio(q)) return 0;
    if (!is_ratio(p) || !is_ratio(q)) *ratio = is_ratio(p) ? p : q;
    else *ratio = (p > q) == later ? p : q;
    return 1;
}

static int32_t cut_by_distances(const bvxi_cut_edge *e, double *ratio)
{
    double const t = e->low_distance / (e->low_distance + e->high_distance);
    int const told = is_ratio(t); /* not so for 0 / 0 and for what is no number */
    *ratio = told ? t : 0.5;
    return told ? BVXI_CUT_SCALAR : BVXI_CUT_MIDDLE;
}

int32_t bvxi_find_cut(const bvxi_cut_edge *edge, int32_t interpolation, double *ratio)
{
    unit_cut u;
    int told;

    *ratio = 0.5;
    if (interpolation == BVX_EDGE_MIDDLE) return BVXI_CUT_MIDDLE;
    if (interpolation == BVX_EDGE_SCALAR) return cut_by_distances(edge, ratio);
    u = scale_cut(edge);
    told = (interpolation == BVX_EDGE_TANGENT && cut_by_planes(&u, ratio)) ||
           cut_by_line(&u, interpolation == BVX_EDGE_TANGENT, ratio);
    if (told && is_ratio(*ratio)) return BVXI_CUT_VECTOR;
    if (interpolation != BVX_EDGE_PAPER) return cut_by_distances(edge, ratio);
    /* the nearer end; along the edge V5, the end inside */
    *ratio = !told ? (double)edge->high_inside : *ratio < 0.0 ? 0.0 : 1.0;
    return BVXI_CUT_SCALAR;
}
