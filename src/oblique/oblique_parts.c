/* oblique_parts.c - parts of a surface that contours leave open whether they are one.
 *
 * Planes part space into cells, of which each contour point has one on either side. A part that comes into a
 * cell through one plane alone ends there. If another part is in the same cell but not on that plane, no
 * contour is between them: tails and legs that few planes meet come off so. Bodies that lie apart have
 * planes between them, or end side by side. */
#include "oblique/oblique.h"
#include "mesh/mesh.h"

enum { PARTS_IN_CELL = 64 };

#define PARTS_ON_PLANE 1e-3 /* cells */

typedef struct part_stretch {
    uint32_t root, plane;
    const double *at;
} part_stretch;

typedef struct part_work {
    part_stretch *stretch;
    uint64_t *key; /* cells, by the planes that they are above */
    uint32_t *order, count;
} part_work;

static uint64_t plane_key(uint32_t plane)
{
    uint64_t const x = (plane + 1) * UINT64_C(0x9e3779b97f4a7c15);
    return (x ^ x >> 29) * UINT64_C(0xbf58476d1ce4e5b9);
}

/* The cell below the plane at one of its points; 0 where another plane is too near to say. */
static uint64_t cell_below(const bvxi_oblique *o, uint32_t plane, const double *world)
{
    double at[3];
    uint64_t key = 1;
    bvxi_oblique_in_cells(o, world, at);
    for (uint32_t j = 0; j < o->plane_count; j++) {
        double const height = bvxi_oblique_height(&o->plane[j], at);
        if (j == plane) continue;
        if (bvxi_absolute(height) < PARTS_ON_PLANE) return 0;
        if (height > 0.0) key += plane_key(j);
    }
    return key;
}

static void add_stretches(const bvxi_oblique *o, const uint32_t *joined, uint32_t plane, uint32_t first,
                          part_work *w)
{
    const bvxi_plane *const p = &o->plane[plane].plane;

    for (uint32_t c = 0; c < p->contour_count; c++) {
        uint64_t before = 0;
        for (uint32_t n = p->contour[c].first; n < p->contour[c].first + p->contour[c].count; n++) {
            const double *const at = o->given->points + 3 * (uint64_t)p->given[n];
            uint32_t const v = o->point_vertex[first + n];
            uint32_t const root = v == BVXI_NONE || o->output[v] == BVXI_NONE ? BVXI_NONE
                                                                              : joined[o->output[v]];
            uint64_t const below = root == BVXI_NONE || !o->kept[root] ? 0 : cell_below(o, plane, at);
            if (below == 0 || below == before || p->contour[c].hole) continue;
            before = below;
            for (int side = 0; side < 2; side++) {
                w->stretch[w->count] = (part_stretch){root, plane, at};
                w->key[w->count] = below + (side != 0 ? plane_key(plane) : 0);
                w->order[w->count] = w->count;
                w->count++;
            }
        }
    }
}

static int is_on_plane(const part_work *w, const uint32_t *cell, uint32_t count, uint32_t root,
                       uint32_t plane)
{
    for (uint32_t i = 0; i < count; i++)
        if (w->stretch[cell[i]].root == root && w->stretch[cell[i]].plane == plane) return 1;
    return 0;
}

static int ends_in_cell(const part_work *w, const uint32_t *cell, uint32_t count, const part_stretch *a)
{
    for (uint32_t i = 0; i < count; i++)
        if (w->stretch[cell[i]].root == a->root && w->stretch[cell[i]].plane != a->plane) return 0;
    return 1;
}

/* Parts that end in a cell are joined to those that they end towards. */
static void join_in_cell(bvxi_oblique *o, const part_work *w, const uint32_t *cell, uint32_t count,
                         uint32_t *joined)
{
    for (uint32_t i = 0; i < count; i++) {
        const part_stretch *const a = &w->stretch[cell[i]];
        if (!ends_in_cell(w, cell, count, a)) continue;
        for (uint32_t j = 0; j < count; j++) {
            const part_stretch *const b = &w->stretch[cell[j]];
            if (bvxi_root(joined, a->root) == bvxi_root(joined, b->root) ||
                is_on_plane(w, cell, count, b->root, a->plane))
                continue;
            if (o->apart++ == 0) memcpy(o->apart_at, a->at, 24);
            bvxi_join(joined, a->root, b->root);
        }
    }
}

static bvx_status find_apart(bvxi_oblique *o, uint32_t *joined)
{
    uint64_t const most = 2 * (uint64_t)o->point_count;
    uint32_t first = 0;
    part_work w = {0};

    BVXI_TRY(BVXI_ARRAY(o->ctx, most, "contours in cells", w.stretch));
    BVXI_TRY(BVXI_ARRAY(o->ctx, most, "contours in cells", w.key));
    BVXI_TRY(BVXI_ARRAY(o->ctx, most, "contours in cells", w.order));
    for (uint32_t i = 0; i < o->plane_count; first += o->plane[i++].plane.point_count)
        add_stretches(o, joined, i, first, &w);
    BVXI_TRY(bvxi_radix_sort(o->ctx, w.key, w.order, w.count));
    for (uint32_t i = 0, n; i < w.count; i += n) {
        for (n = 1; i + n < w.count && w.key[i + n] == w.key[i];) n++;
        join_in_cell(o, &w, w.order + i, n < PARTS_IN_CELL ? n : PARTS_IN_CELL, joined);
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_apart(bvxi_oblique *o, uint32_t *joined)
{
    return BVXI_SCOPE(o->ctx, find_apart(o, joined));
}
