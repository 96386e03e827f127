/* edge_cut.c - where a lattice edge is cut: by the vectors from its ends to their closest points, or by the
 * planes of the facets there.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013, 2.3, with its formula
 * corrected. Guarantee: strictly inside the edge, for any values. */
#include "surface/field_surface.h"
#include "core/vec3.h"
#include "nearest/closest.h"
#include "mesh/facet.h"

/* ---- By vectors ---- */

/* V and W are the edge's ends, A and B their closest points; the cut lies where the line AB passes nearest to the edge's
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

/* Squares of lengths in edge lengths. Vectors of f32 hold 2^-22 of an edge in a band of a few voxels. */
#define SAME_POINT2 (1.0 / 1099511627776.0) /* 2^-40: closest points this near are one */
#define NO_NORMAL2  (1.0 / 8589934592.0)    /* 2^-33: vectors shorter than this give no plane */
#define PARALLEL2   (1.0 / 1073741824.0)    /* 2^-30: square of the sine below which AB runs along the edge */

/* The edge from V = 0 to W = (1, 0, 0): A, B from V, and B from W. */
typedef struct unit_cut {
    double a[3], b[3], wb[3];
} unit_cut;

/* 1 and the ratio where the line AB gives it, 0 where it runs along the
 * edge or is no number. between: no further than A and B. */
static int cut_by_line(const unit_cut *u, int between, double *ratio)
{
    double const dx = u->b[0] - u->a[0], dy = u->b[1] - u->a[1], dz = u->b[2] - u->a[2];
    double const across2 = dy * dy + dz * dz;
    if (dx * dx + across2 <= SAME_POINT2) {
        *ratio = 0.5 * (u->a[0] + u->b[0]);
        return 1;
    }
    if (!(across2 > PARALLEL2 * (dx * dx))) return 0;
    double s = -((dy * u->a[1] + dz * u->a[2]) / across2);
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

#define ON_SURFACE (1.0 / 1048576.0) /* 2^-20: an end this near lies on the surface */

static int32_t cut_by_distances(const bvxi_cut_edge *e, double *ratio)
{
    double const t = e->low_distance / (e->low_distance + e->high_distance);
    int const told = is_ratio(t); /* not so for 0 / 0 and for what is no number */
    *ratio = told ? t : 0.5;
    return told ? BVXI_CUT_SCALAR : BVXI_CUT_MIDDLE;
}

int32_t bvxi_find_cut(const bvxi_cut_edge *edge, int32_t interpolation, double *ratio)
{
    *ratio = 0.5;
    if (interpolation == BVX_EDGE_MIDDLE) return BVXI_CUT_MIDDLE;
    if (interpolation == BVX_EDGE_SCALAR) return cut_by_distances(edge, ratio);
    double const scale = 1.0 / edge->length;
    unit_cut u;
    for (int32_t k = 0; k < 3; k++) {
        int32_t const axis = edge->axis + k < 3 ? edge->axis + k : edge->axis + k - 3;
        u.a[k] = edge->low[axis] * scale;
        u.wb[k] = edge->high[axis] * scale;
        u.b[k] = u.wb[k] + (k == 0 ? 1.0 : 0.0);
    }
    int told = (interpolation == BVX_EDGE_TANGENT && cut_by_planes(&u, ratio)) ||
               cut_by_line(&u, interpolation == BVX_EDGE_TANGENT, ratio);
    if (!told && interpolation == BVX_EDGE_TANGENT) {
        /* One end lies on the surface, and the line AB runs along the edge: a wall whose one side has the end and
         * whose other side the edge goes through, where the other end's closest point is. In walls that were made
         * thicker a vector without length does not mean that. */
        int const low = bvxi_absolute(edge->low_distance) <= ON_SURFACE * edge->length;
        int const high = bvxi_absolute(edge->high_distance) <= ON_SURFACE * edge->length;
        const double *const way = low ? u.wb : u.a;
        if (low != high && bvxi_vec_dot(way, way) > NO_NORMAL2) {
            *ratio = low ? u.b[0] : u.a[0];
            told = is_ratio(*ratio);
        }
    }
    if (told && is_ratio(*ratio)) return BVXI_CUT_VECTOR;
    if (interpolation != BVX_EDGE_PAPER) return cut_by_distances(edge, ratio);
    /* the nearer end; along the edge V5, the end inside */
    *ratio = !told ? (double)edge->high_inside : *ratio < 0.0 ? 0.0 : 1.0;
    return BVXI_CUT_SCALAR;
}

/* The planes of the mesh's facets at the cut of a lattice edge, and the cut where they have
 * it.
 *
 * Where the closest triangles of the edge's ends are known, the planes are theirs, and the cut moves to where
 * the edge passes through one of them; where it passes through neither, to where it passes through the plane
 * of one, if that is nearer to the two triangles: the formula above cuts off what is sharp. Else a
 * plane is square to the vector of an end: inside a facet that is the facet's own, and on an edge or corner
 * of the mesh it is one of the planes that touch it there, so it too runs through the edge or corner. All in
 * units of the largest spacing, from the edge's low end. */

/* Shorter vectors of f32 have no direction worth taking. */
#define SHORTEST2 (1.0 / 16777216.0) /* (2^-12)^2 */

typedef struct facet_edge {
    double length, along; /* along 1: the low end is inside, -1: the high end */
    /* of the low and of the high end: vector away from the inside, 0 on the surface */
    double outward[2][3], closest[2][3];
    double corners[2][3][3], normal[2][3]; /* of the ends' triangles */
    double size[2];                        /* of the normals; 0: no such triangle */
    int32_t axis;
} facet_edge;

static void load_facet(const bvxi_cuts *c, const bvx_mesh_view *mesh, facet_edge *f, int32_t end,
                       uint32_t triangle, const double centre[3])
{
    double const scale = 1.0 / c->unit;
    uint32_t corner[3];
    /* From the centre, in the largest spacing: sizes near 1 whatever the coordinates are. */
    bvxi_view_triangle(mesh, triangle, corner);
    for (int32_t k = 0; k < 3; k++) {
        bvxi_view_position(mesh, corner[k], f->corners[end][k]);
        for (int32_t a = 0; a < 3; a++) f->corners[end][k][a] = (f->corners[end][k][a] - centre[a]) * scale;
    }
    bvxi_order_corners(f->corners[end]);
    f->size[end] = bvxi_facet_normal((const double(*)[3])f->corners[end], f->normal[end]);
    /* Not finite: such a triangle has no plane. */
    if (f->size[end] - f->size[end] != 0.0) f->size[end] = 0.0;
}

static void open_facet_edge(const bvxi_cuts *c, const bvxi_cut_rule *v, const bvxi_cut_edge *e,
                            const double centre[3], facet_edge *f)
{
    double const scale = 1.0 / c->unit;
    const uint32_t *const triangles = v->mesh != NULL ? v->values->triangles : NULL;

    f->axis = e->axis;
    f->length = e->length * scale;
    f->along = e->high_inside ? -1.0 : 1.0;
    for (int32_t a = 0; a < 3; a++) {
        f->closest[0][a] = e->low[a] * scale;
        f->closest[1][a] = e->high[a] * scale + (a == e->axis ? f->length : 0.0);
        /* Away from the inside: against the vector on one end, along it on the other. */
        f->outward[0][a] = f->along * e->low[a] * scale;
        f->outward[1][a] = -f->along * e->high[a] * scale;
    }
    f->size[0] = f->size[1] = 0.0;
    if (triangles == NULL) return;
    uint32_t const low = triangles[(size_t)e->value[0]], high = triangles[(size_t)e->value[1]];
    load_facet(c, v->mesh, f, 0, low, centre);
    if (low != high || f->size[0] == 0.0) load_facet(c, v->mesh, f, 1, high, centre);
}

static void point_of_edge(const facet_edge *f, double ratio, double p[3])
{
    p[0] = p[1] = p[2] = 0.0;
    p[f->axis] = ratio * f->length;
}

/* Where the edge passes through a triangle, seen along the edge; 0 where it misses or runs along it. */
static int pass_triangle(const facet_edge *f, int32_t end, double *ratio)
{
    const double(*const t)[3] = (const double(*)[3])f->corners[end];
    int32_t const x = f->axis, y = x == 2 ? 0 : x + 1, z = y == 2 ? 0 : y + 1;
    double const a = t[1][y] * t[2][z] - t[1][z] * t[2][y], b = t[2][y] * t[0][z] - t[2][z] * t[0][y];
    double const c = t[0][y] * t[1][z] - t[0][z] * t[1][y];
    /* Different signs: the line passes beside the triangle. */
    if ((a < 0.0 || b < 0.0 || c < 0.0) && (a > 0.0 || b > 0.0 || c > 0.0)) return 0;
    *ratio = (a * t[0][x] + b * t[1][x] + c * t[2][x]) / ((a + b + c) * f->length);
    return *ratio >= 0.0 && *ratio <= 1.0;
}

static double distance2_to_facets(const facet_edge *f, double ratio)
{
    double p[3], q[3], best = -1.0;
    point_of_edge(f, ratio, p);
    for (int32_t end = 0; end < 2; end++) {
        if (f->size[end] == 0.0) continue;
        double const d2 = bvxi_closest_on_triangle(p, (const double(*)[3])f->corners[end], q);
        if (best < 0.0 || d2 < best) best = d2;
    }
    return best;
}

static double cut_facets(const facet_edge *f, double ratio)
{
    double place[2] = {ratio, ratio}, best;
    int passes[2];

    /* Through both triangles: the one nearer to what the formula says. */
    for (int32_t end = 0; end < 2; end++)
        passes[end] = f->size[end] != 0.0 && pass_triangle(f, end, &place[end]);
    if (passes[0] && passes[1])
        return (place[1] - ratio) * (place[1] - ratio) < (place[0] - ratio) * (place[0] - ratio) ? place[1]
                                                                                                 : place[0];
    if (passes[0] || passes[1]) return place[passes[0] ? 0 : 1];
    /* Through neither: a plane's place is taken only where it is nearer to the triangles. */
    best = distance2_to_facets(f, ratio);
    for (int32_t end = 0; end < 2; end++) {
        if (f->size[end] == 0.0) continue;
        place[end] = bvxi_vec_dot(f->normal[end], f->corners[end][0]) / (f->normal[end][f->axis] * f->length);
        if (!(place[end] >= 0.0 && place[end] <= 1.0)) continue;
        double const d2 = distance2_to_facets(f, place[end]);
        if (!(d2 < best)) continue;
        best = d2;
        ratio = place[end];
    }
    return ratio;
}

static void put_plane(const double cut[3], const double n[3], double length, const double on[3],
                      bvxi_facet_plane *plane)
{
    double offset = 0.0;
    for (int32_t a = 0; a < 3; a++) {
        /* A unit normal, and how far the plane lies from the cut along it. */
        plane->n[a] = (float)(n[a] / length);
        offset += n[a] / length * (on[a] - cut[a]);
    }
    plane->offset = (float)offset;
}

static int planes_of_facets(const facet_edge *f, const double cut[3], bvxi_facet_plane planes[2])
{
    double best = 0.0;
    int found = 0;

    for (int32_t end = 0; end < 2; end++) {
        double q[3], d2;
        if (f->size[end] == 0.0) continue;
        d2 = bvxi_closest_on_triangle(cut, (const double(*)[3])f->corners[end], q);
        /* Triangles may be turned: the end closest to one decides what is outward, clearly along the vector or
         * against it; in between, along the facet, the edge's direction decides. */
        double const s = bvxi_vec_dot(f->normal[end], f->outward[end]);
        double const size = f->size[end] * sqrt(bvxi_vec_dot(f->outward[end], f->outward[end]));
        int const turned = s > 0.5 * size ? 0 : s < -0.5 * size || f->normal[end][f->axis] * f->along < 0.0;
        put_plane(cut, f->normal[end], turned ? -f->size[end] : f->size[end], q, &planes[found]);
        if (found != 0 && d2 < best) {
            bvxi_facet_plane const nearer = planes[1];
            planes[1] = planes[0];
            planes[0] = nearer;
        }
        best = d2;
        found++;
    }
    return found != 0;
}

double bvxi_facet_cut(const bvxi_cuts *cuts, const bvxi_cut_rule *values, const bvxi_cut_edge *edge,
                      const double centre[3], double ratio, bvxi_facet_plane planes[2])
{
    facet_edge f;
    double cut[3];
    open_facet_edge(cuts, values, edge, centre, &f);
    if (cuts->interpolation != BVX_EDGE_MIDDLE) ratio = cut_facets(&f, ratio);
    /* Strictly inside, so that no triangle is without area. */
    ratio = bvxi_keep_off_ends(ratio);
    point_of_edge(&f, ratio, cut);
    if (!planes_of_facets(&f, cut, planes)) {
        int32_t const nearer = bvxi_vec_distance2(cut, f.closest[0]) <= bvxi_vec_distance2(cut, f.closest[1])
                                   ? 0
                                   : 1;
        int32_t found = 0;
        for (int32_t k = 0; k < 2; k++) {
            int32_t const end = k == 0 ? nearer : 1 - nearer;
            double const length2 = bvxi_vec_dot(f.outward[end], f.outward[end]);
            /* Too short to have a direction, or not finite. */
            if (!(length2 > SHORTEST2) || length2 - length2 != 0.0) continue;
            put_plane(cut, f.outward[end], sqrt(length2), f.closest[end], &planes[found++]);
        }
    }
    return ratio;
}
