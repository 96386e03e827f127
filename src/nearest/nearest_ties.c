/* nearest_ties.c - which of equally near triangles is taken, by geometry only.
 *
 * Beside an edge or corner all of its triangles are equally near. The one whose plane is farthest from the
 * centre is the one that the centre sees most of: its plane bounds the body there, others run past behind it.
 * Where planes are equally far as well, the order of closest points decides, then that of corners; so no
 * numbering and no orientation shows. */
#include "nearest/nearest_pairs.h"
#include "nearest/closest.h"
#include "mesh/facet.h"

static void read_near_pair(const bvxi_near_pairs *p, int32_t i, double point[3], double t[3][3])
{
    for (int a = 0; a < 3; a++) point[a] = p->point[a][i];
    for (int v = 0; v < 9; v++) t[v / 3][v % 3] = p->corner[v][i];
}

double bvxi_near_height2(const bvxi_near_pairs *pairs, int32_t i)
{
    double point[3], t[3][3], n[3], along = 0.0, length;

    read_near_pair(pairs, i, point, t);
    length = bvxi_facet_normal((const double(*)[3])t, n);
    if (!(length > 0.0)) return 0.0;
    for (int a = 0; a < 3; a++) along += n[a] / length * (point[a] - t[0][a]);
    return along * along;
}

/* -1, 0 or 1: a comes before b, is the same, comes after. */
static int compare_near_places(const double a[3], const double b[3])
{
    return bvxi_corner_before(a, b) ? -1 : bvxi_corner_before(b, a);
}

int bvxi_near_is_first(const bvxi_nearest *n, const bvxi_near_pairs *pairs, int32_t i, uint32_t other)
{
    double point[3], t[3][3], u[3][3], q[3];
    double const closest[3] = {pairs->closest[0][i], pairs->closest[1][i], pairs->closest[2][i]};
    int order;

    read_near_pair(pairs, i, point, t);
    bvxi_near_corners(n, other, u);
    bvxi_order_corners(u);

    bvxi_closest_on_triangle(point, (const double(*)[3])u, q);
    order = compare_near_places(closest, q);
    for (int k = 0; k < 3 && order == 0; k++) order = compare_near_places(t[k], u[k]);
    return order != 0 ? order < 0 : pairs->triangle[i] < other;
}
