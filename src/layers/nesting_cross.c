/* nesting_cross.c - do levels of one slab cross?
 *
 * Where the surface follows the field they cannot. A wall much thinner than a cell may turn within it, and
 * then triangles of one level can reach through those of another. A triangle lies in one cell of the grid, so
 * only cells with triangles of several levels are looked at: with walls that are wider than cells there are
 * hardly any. All pairs of these are tested exactly. */
#include "layers/slab.h"

#include <math.h>

#define NEST_SPARE 1e-6 /* of a cell: more than rounding moves a vertex */

typedef struct nest_mesh {
    bvxi_stack *s;
    const bvxi_slab *slab;
    uint32_t count;
    uint64_t *seen, *shared; /* cells with triangles of one level, of several; rows of words */
    double *position;        /* of the triangles that were kept, three each */
    uint32_t *owner;         /* their slabs */
    uint64_t triangles, position_room, owner_room;
} nest_mesh;

static const double *nest_slab_vertex(const nest_mesh *m, const bvxi_slab *slab, uint32_t v)
{
    uint64_t const rings = m->s->mesh.vertex_count;
    return v < rings ? m->s->mesh.position + 3 * (uint64_t)v : slab->mesh.position + 3 * (v - rings);
}

/* The cells that a triangle lies in or touches: first and last of both axes. */
static void nest_cells_of_triangle(const nest_mesh *m, const bvxi_slab *slab, uint64_t triangle,
                                   int32_t first[2], int32_t last[2])
{
    const bvxi_stack *const s = m->s;

    for (int k = 0; k < 2; k++) {
        double low = 1e300, high = -1e300;
        for (int c = 0; c < 3; c++) {
            const double *const p = nest_slab_vertex(m, slab,
                                                     slab->mesh.triangle[3 * triangle + (uint64_t)c]);
            double const at = (bvxi_along_axis(s->axis[k], p) - s->origin[k]) / s->step[k];
            bvxi_widen(&low, &high, &at, 1);
        }
        /* A little wider, as vertices on a border belong to both cells. */
        low = floor(low - NEST_SPARE);
        high = floor(high + NEST_SPARE);
        first[k] = low > 0.0 ? (int32_t)low : 0;
        last[k] = high < s->size[k] - 1 ? (int32_t)high : s->size[k] - 1;
    }
}

/* A cell becomes one of several levels when an earlier level of its slab was there. */
static void nest_mark_cells(nest_mesh *m, const bvxi_slab *slab, uint64_t *own)
{
    uint64_t const words = (uint64_t)m->s->size[1] * (uint64_t)m->s->words;

    memset(own, 0, (size_t)words * 8);
    for (uint64_t t = 0; t < slab->mesh.triangle_count; t++) {
        int32_t first[2], last[2];
        nest_cells_of_triangle(m, slab, t, first, last);
        for (int32_t j = first[1]; j <= last[1]; j++)
            for (int32_t i = first[0]; i <= last[0]; i++)
                own[(size_t)j * (size_t)m->s->words + (size_t)(i >> 6)] |= UINT64_C(1) << (i & 63);
    }
    for (uint64_t i = 0; i < words; i++) {
        m->shared[i] |= m->seen[i] & own[i];
        m->seen[i] |= own[i];
    }
}

static int nest_is_shared(const nest_mesh *m, const bvxi_slab *slab, uint64_t triangle)
{
    int32_t first[2], last[2];
    nest_cells_of_triangle(m, slab, triangle, first, last);
    for (int32_t j = first[1]; j <= last[1]; j++)
        for (int32_t i = first[0]; i <= last[0]; i++)
            if ((m->shared[(size_t)j * (size_t)m->s->words + (size_t)(i >> 6)] >> (i & 63) & 1) != 0)
                return 1;
    return 0;
}

static bvx_status nest_keep_triangle(nest_mesh *m, uint32_t number, uint64_t triangle)
{
    const bvxi_slab *const slab = &m->slab[number];
    BVXI_TRY(BVXI_GROW_BY(m->s, m->position, m->triangles, m->position_room, 72, "the surfaces of levels"));
    BVXI_TRY(BVXI_GROW(m->s, m->owner, m->triangles, m->owner_room, "the surfaces of levels"));
    /* Corners are copied, since slabs number their vertices apart. */
    for (int c = 0; c < 3; c++)
        memcpy(m->position + 9 * m->triangles + 3 * c,
               nest_slab_vertex(m, slab, slab->mesh.triangle[3 * triangle + (uint64_t)c]), 24);
    m->owner[m->triangles++] = number;
    return BVX_OK;
}

/* Mark the slabs in which triangles of two levels cross; within one level they are the cells' matter. */
static void nest_mark_pairs(const nest_mesh *m, const uint32_t *pairs, uint64_t count, uint32_t *found)
{
    uint8_t *const joined = m->s->nesting.joined;

    for (uint64_t i = 0; i < count; i++) {
        const bvxi_slab *const a = &m->slab[m->owner[pairs[2 * i]]];
        const bvxi_slab *const b = &m->slab[m->owner[pairs[2 * i + 1]]];
        if (a->below != b->below || a->level == b->level || joined[a->below] >= BVXI_LEVELS_CROSSED) continue;
        joined[a->below] |= BVXI_LEVELS_CROSSED;
        ++*found;
    }

    /* A cubic blend gives way to the linear one first; levels that cross even then are joined. */
    for (uint32_t i = 0; i < m->s->plane_count; i++) {
        int const was_cubic = m->s->options.slabs.blend == BVX_BLEND_CUBIC &&
                              joined[i] == BVXI_LEVELS_CROSSED;
        if (joined[i] >= BVXI_LEVELS_CROSSED) joined[i] = was_cubic ? BVXI_LEVELS_LINEAR : BVXI_LEVELS_JOINED;
    }
}

bvx_status bvxi_nesting_crossed(bvxi_stack *s, const bvxi_slab *slabs, uint32_t count, uint32_t *found)
{
    uint64_t const cells = (uint64_t)s->size[1] * (uint64_t)s->words;
    nest_mesh m = {.s = s, .slab = slabs, .count = count};
    bvx_mesh_view view = {0}; /* corner by corner: vertices at one place are one there */
    uint32_t *pairs;
    uint64_t *own, crossings;

    *found = 0;
    if (s->nesting.plane_count == 0) return BVX_OK;
    BVXI_TRY(BVXI_ARRAY(s->ctx, cells, "the cells of levels", m.seen));
    BVXI_TRY(BVXI_ARRAY(s->ctx, cells, "the cells of levels", m.shared));
    BVXI_TRY(BVXI_ARRAY(s->ctx, cells, "the cells of levels", own));
    uint64_t const bytes = (uint64_t)m.s->size[1] * (uint64_t)m.s->words * 8;

    for (uint32_t i = 0, end; i < m.count; i = end) {
        end = i + 1;
        if (m.slab[i].plane[0]->whole == NULL) continue;
        while (end < m.count && m.slab[end].below == m.slab[i].below) end++;

        BVXI_TRY(bvxi_progress(m.s->ctx, "levels", 0.5 * (double)i / m.count));
        memset(m.seen, 0, (size_t)bytes);
        memset(m.shared, 0, (size_t)bytes);
        for (uint32_t k = i; k < end; k++) nest_mark_cells(&m, &m.slab[k], own);
        for (uint32_t k = i; k < end; k++)
            for (uint64_t t = 0; t < m.slab[k].mesh.triangle_count; t++)
                if (nest_is_shared(&m, &m.slab[k], t)) BVXI_TRY(nest_keep_triangle(&m, k, t));
    }

    if (m.triangles == 0) return BVX_OK;
    view.positions = m.position;
    view.vertex_count = 3 * m.triangles;
    view.triangle_count = m.triangles;
    view.position_type = BVX_F64;

    /* Counted first: nearly always there is none, and no list is needed. */
    BVXI_TRY(BVXI_SHARE(s->ctx, 0.5, 0.9, bvx_mesh_crossings(s->ctx, &view, &crossings, NULL, 0)));
    if (crossings == 0) return BVX_OK;
    BVXI_TRY(BVXI_ARRAY(s->ctx, 2 * crossings, "the crossings of levels", pairs));
    BVXI_TRY(BVXI_SHARE(s->ctx, 0.9, 1.0, bvx_mesh_crossings(s->ctx, &view, &crossings, pairs, crossings)));
    nest_mark_pairs(&m, pairs, crossings, found);
    return BVX_OK;
}
