/* flat.c - is the surface in a voxel flat within a tolerance?
 *
 * The plane is that of the list's largest triangle (of equals the one with the least number); all corners
 * must lie within the tolerance of it, so all of their points do. Triangles without area anywhere: flat when
 * all corners lie within the tolerance of the first. Doubles, in one stated order: the same on every
 * machine. */
#include "mesh/facet.h"
#include "refine/refine.h"

static void flat_corners(const bvxi_refine_job *job, uint32_t triangle, const int32_t origin[3],
                         double p[3][3])
{
    uint32_t corner[3];
    bvxi_view_triangle(job->view, triangle, corner);
    /* Differences of whole numbers first: they are exact, and near 0 where doubles are densest. */
    for (int c = 0; c < 3; c++)
        for (int a = 0; a < 3; a++)
            p[c][a] = (double)(job->snapped.xyz[3 * (size_t)corner[c] + (size_t)a] - origin[a]) *
                      job->step[a];
}

int bvxi_refine_is_flat(const bvxi_refine_job *job, const uint32_t *list, const uint8_t *hits, uint32_t bit,
                        uint64_t count)
{
    double p[3][3], n[3] = {0, 0, 0}, trial[3], length2 = -1;
    int32_t origin[3] = {0, 0, 0};
    uint32_t best = UINT32_MAX;

    /* The largest triangle has the plane that is known best; of equals the least number. */
    for (uint64_t i = 0; i < count; i++) {
        uint32_t corner[3];
        int32_t first[3];
        if (hits != NULL && (hits[i] >> bit & 1) == 0) continue;
        bvxi_view_triangle(job->view, list[i], corner);
        memcpy(first, job->snapped.xyz + 3 * (size_t)corner[0], sizeof first);
        flat_corners(job, list[i], first, p);
        bvxi_facet_cross((const double(*)[3])p, trial);
        double const l = bvxi_vec_dot(trial, trial);
        if (l < length2 || (l == length2 && list[i] > best)) continue;
        length2 = l;
        best = list[i];
        memcpy(n, trial, sizeof n);
        memcpy(origin, first, sizeof origin);
    }
    for (uint64_t i = 0; i < count; i++) {
        if (hits != NULL && (hits[i] >> bit & 1) == 0) continue;
        flat_corners(job, list[i], origin, p);

        /* A plane at all corners within the tolerance has all points of the triangles within it. Without a plane
         * they are near the origin. */
        for (int c = 0; c < 3; c++) {
            double const d = bvxi_vec_dot(p[c], n), off2 = length2 > 0 ? d * d : bvxi_vec_dot(p[c], p[c]);
            double const most2 = job->tolerance * job->tolerance;
            if (!(off2 <= (length2 > 0 ? most2 * length2 : most2))) return 0;
        }
    }
    return 1;
}
