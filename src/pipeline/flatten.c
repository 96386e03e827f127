/* flatten.c - the surface of thickened walls put back to where the mesh has it.
 *
 * Marching cubes give a thin wall its connections, as thick as the lattice needs; here its vertices go to
 * their nearest points of the mesh, but for a small part of the way, so that no two come to one place where
 * many have one nearest point. Then crossing triangles, those without area and vertices at one place are
 * looked for; vertices of such go back half of the way, or all of it, until there are none: the surface
 * before had none, so that ends. Each time only what lies beside vertices that went back is looked at.
 * Guarantee: that of the surface before, as every step is checked on the coordinates as written. Threads do
 * not show. */
#include "mesh/cross.h"
#include "mesh/mesh.h"
#include "nearest/closest.h"
#include "pipeline/thicken.h"

#include <math.h>

#define FLATTEN_LEFT    (1.0 / 512.0) /* of the way to the nearest point */
#define FLATTEN_ON_EDGE 0.01          /* of a voxel: a vertex this near to a line of centres lies on it */

enum { FLATTEN_BLOCK = 4 /* voxels a side */, FLATTEN_REACHED = 1, FLATTEN_BESIDE = 2 };
enum { FLATTEN_GRAIN = 256, FLATTEN_PIECES = 1024, FLATTEN_ROUNDS = 12, FLATTEN_SINGLE = 6 };
enum { FLATTEN_ALL_THE_WAY = 0, FLATTEN_STAYS = 2 };

typedef struct flatten_vertex {
    double from[3], to[3]; /* [Units: world, less the mesh's frame] */
    double distance;       /* to the nearest point of a mesh that was asked already; below 0: none was */
    uint32_t vertex;
    uint8_t step, back; /* FLATTEN_...; back: 1 when it must go back further */
    uint8_t changed;    /* 1: it has gone since triangles were looked at */
} flatten_vertex;

typedef struct flatten_job {
    bvx_context *ctx;
    const char *function;
    const bvxi_flat_body *bodies;
    int32_t body_count, asked; /* asked: the body whose mesh is searched */
    const bvx_grid *window;    /* any of the grids: their words aside all are the same */
    bvx_mesh *mesh;
    flatten_vertex *moved; /* [Size: count] */
    uint32_t *number;      /* of each vertex among the moved ones, plus 1 [Size: vertices] */
    uint64_t count, marked;
    int32_t pieces;

    /* the triangles that can meet moved ones, with vertices of their own */
    uint8_t *blocks;
    int32_t block_size[3];
    uint64_t block_count;
    double block_origin[3], block_scale[3]; /* [Units: world, less the mesh's frame] */
    uint32_t *local;                        /* of each vertex among theirs, plus 1 [Size: vertices] */
    uint32_t *vertex;                       /* of each of theirs in the mesh [Size: near.vertex_count] */
    uint32_t *corner;                       /* [Size: near.triangle_count * 3] */
    double *position;                       /* as written [Size: near.vertex_count * 3] */
    bvx_mesh_view near;
    uint32_t *part, *part_corner; /* those of them that can meet what has changed; their corners */
    bvx_mesh_view around_change;
    bvx_closest closest; /* a search among the triangles that thin walls were found with */
} flatten_job;

/* ---- Which vertices move ---- */

/* Reach of a centre; 0 where it is not beside a thin wall. */
static double reach_at(const bvxi_thin *thin, const int32_t at[3])
{
    const bvx_grid *const g = &thin->near.where;
    /* Beyond the window lies no wall. */
    for (int a = 0; a < 3; a++)
        if (at[a] < 0 || at[a] >= g->size[a]) return 0;
    if (!bvx_grid_get(g, at[0], at[1], at[2])) return 0;
    return ((const float *)thin->near.distances)[bvxi_sparse_index(&thin->near, at[0], at[1], at[2])];
}

/* Does a body change along an edge? low, high: its ends, or one centre twice. */
static int changes_along(const bvxi_flat_body *body, const int32_t low[3], const int32_t high[3])
{
    int side[2];

    /* Without a solid any edge counts, and so does a vertex at a centre. */
    if (body->solid == NULL || memcmp(low, high, 3 * sizeof *low) == 0) return 1;
    for (int end = 0; end < 2; end++) {
        const int32_t *const at = end == 0 ? low : high;
        int within = 1;
        for (int a = 0; a < 3; a++) within &= at[a] >= 0 && at[a] < body->solid->size[a];
        side[end] = within && bvx_grid_get(body->solid, at[0], at[1], at[2]);
    }
    return side[0] != side[1];
}

/* The bodies, as bits, whose thin walls a vertex is of: it lies on an edge
 * of the lattice beside one, and beside no sheet. */
static uint32_t thin_walls_at(const flatten_job *f, const double p[3])
{
    const bvx_grid *const g = f->window;
    int32_t low[3], high[3];
    uint32_t found = 0;
    int axes = 0;

    /* Between two centres along one axis, or on a centre: those ends differ along one axis at most. */
    for (int a = 0; a < 3; a++) {
        double const v = (p[a] - g->lattice.origin[a]) / g->lattice.spacing[a] - (double)g->low[a] - 0.5;
        low[a] = (int32_t)floor(v + FLATTEN_ON_EDGE);
        high[a] = (int32_t)floor(v + 1.0 - FLATTEN_ON_EDGE);
        axes += high[a] != low[a];
    }
    /* Inside a cell: no vertex of an edge. */
    if (axes > 1) return 0;
    for (int32_t b = 0; b < f->body_count; b++) {
        const bvxi_thin *const thin = f->bodies[b].thin;

        if (thin->near.where.words == NULL || !changes_along(&f->bodies[b], low, high)) continue;
        double const first = reach_at(thin, low);
        double const second = reach_at(thin, high);
        /* Beside a sheet nothing moves: it has no second side. */
        if (first < 0 || second < 0) return 0;
        if (first > 0 || second > 0) found |= UINT32_C(1) << b;
    }
    return found;
}

static void world_position(const flatten_job *f, const bvx_mesh_view *view, uint64_t v, double p[3])
{
    bvxi_view_position(view, v, p);
    for (int a = 0; a < 3; a++) p[a] += f->mesh->frame[a];
}

static void aim_piece(void *user, int32_t piece)
{
    flatten_job *const f = user;
    bvx_mesh_view view;
    uint32_t hint = 0;
    uint64_t begin, end;

    bvx_mesh_view_of(f->mesh, &view);
    bvxi_piece(view.vertex_count, f->pieces, piece, &begin, &end);
    for (uint64_t v = begin; v < end; v++) {
        bvx_closest_point q;
        double p[3];

        if (f->number[v] == 0) continue;
        flatten_vertex *const m = &f->moved[f->number[v] - 1];
        world_position(f, &view, v, p);
        /* Each body's walls aim at its own mesh. */
        if ((thin_walls_at(f, p) >> f->asked & 1) == 0) continue;
        bvxi_closest_ask(&f->closest, p, &hint, &q);
        if (m->distance >= 0 && m->distance <= q.distance) continue; /* the other body's wall is nearer */
        m->distance = q.distance;
        for (int a = 0; a < 3; a++) {
            m->from[a] = p[a] - f->mesh->frame[a];
            /* A small part of the way stays, so that vertices with one nearest point stay apart. */
            m->to[a] = q.position[a] + (p[a] - q.position[a]) * FLATTEN_LEFT - f->mesh->frame[a];
        }
        m->vertex = (uint32_t)v;
        m->step = FLATTEN_ALL_THE_WAY;
    }
}

/* ---- The triangles around them ---- */

/* The block along an axis that holds a coordinate of the mesh, cut to the window. */
static int32_t block_along(const flatten_job *f, int axis, double p)
{
    double const b = (p - f->block_origin[axis]) * f->block_scale[axis];
    if (!(b > 0)) return 0;
    return b < (double)f->block_size[axis] ? (int32_t)b : f->block_size[axis] - 1;
}

/* The blocks of voxels that a triangle reaches, wherever its vertices stand. */
static void blocks_of(const flatten_job *f, const bvx_mesh_view *all, const uint32_t c[3], int32_t low[3],
                      int32_t high[3])
{
    for (int k = 0; k < 3; k++) {
        double p[2][3]; /* before and after */

        /* A vertex may stand anywhere between both places. */
        bvxi_view_position(all, c[k], p[0]);
        memcpy(p[1], p[0], sizeof p[1]);
        if (f->number[c[k]] != 0) memcpy(p[1], f->moved[f->number[c[k]] - 1].to, sizeof p[1]);
        for (int end = 0; end < 2; end++)
            for (int a = 0; a < 3; a++) {
                int32_t const at = block_along(f, a, p[end][a]);
                if ((k == 0 && end == 0) || at < low[a]) low[a] = at;
                if ((k == 0 && end == 0) || at > high[a]) high[a] = at;
            }
    }
}

static uint8_t *flatten_blocks(const flatten_job *f, int32_t x, int32_t y, int32_t z)
{
    return f->blocks + ((size_t)z * (size_t)f->block_size[1] + (size_t)y) * (size_t)f->block_size[0] +
           (size_t)x;
}

static void mark_block_range(flatten_job *f, const int32_t low[3], const int32_t high[3], int32_t more,
                             uint8_t mark)
{
    int32_t from[3], to[3];
    /* Cut to the window, wider by the blocks requested. */
    for (int a = 0; a < 3; a++) {
        from[a] = low[a] > more ? low[a] - more : 0;
        to[a] = high[a] + more < f->block_size[a] ? high[a] + more : f->block_size[a] - 1;
    }
    for (int32_t z = from[2]; z <= to[2]; z++)
        for (int32_t y = from[1]; y <= to[1]; y++)
            for (int32_t x = from[0]; x <= to[0]; x++) *flatten_blocks(f, x, y, z) |= mark;
}

/* Blocks that triangles with moved vertices reach, and those beside them:
 * other triangles reach no further than a block. */
static void mark_blocks_around(flatten_job *f, const bvx_mesh_view *all)
{
    for (uint64_t t = 0; t < all->triangle_count; t++) {
        const uint32_t *const c = f->mesh->triangles + 3 * t;
        int32_t low[3], high[3];
        if ((f->number[c[0]] | f->number[c[1]] | f->number[c[2]]) == 0) continue;
        blocks_of(f, all, c, low, high);
        mark_block_range(f, low, high, 0, FLATTEN_REACHED);
        mark_block_range(f, low, high, 1, FLATTEN_BESIDE);
    }
}

static int reaches_marked_block(const flatten_job *f, const int32_t low[3], const int32_t high[3])
{
    for (int32_t z = low[2]; z <= high[2]; z++)
        for (int32_t y = low[1]; y <= high[1]; y++)
            for (int32_t x = low[0]; x <= high[0]; x++)
                if (*flatten_blocks(f, x, y, z) & FLATTEN_REACHED) return 1;
    return 0;
}

static int is_around(const flatten_job *f, const bvx_mesh_view *all, const uint32_t c[3])
{
    int32_t low[3], high[3];
    double p[3];

    if ((f->number[c[0]] | f->number[c[1]] | f->number[c[2]]) != 0) return 1;

    /* The block of one corner first, as most triangles lie far from any wall. */
    bvxi_view_position(all, c[0], p);
    if (*flatten_blocks(f, block_along(f, 0, p[0]), block_along(f, 1, p[1]), block_along(f, 2, p[2])) == 0)
        return 0;
    blocks_of(f, all, c, low, high);
    return reaches_marked_block(f, low, high);
}

/* Count the triangles in marked blocks, or with corner list them; their vertices are numbered on the way. */
static void take_around(flatten_job *f, const bvx_mesh_view *all)
{
    uint64_t triangles = 0, vertices = 0;

    for (uint64_t t = 0; t < all->triangle_count; t++) {
        const uint32_t *const c = f->mesh->triangles + 3 * t;

        if (!is_around(f, all, c)) continue;
        for (uint64_t k = 0; k < 3; k++) {
            /* First which vertices there are, then the triangles by their numbers. */
            if (f->corner == NULL) f->local[c[k]] = 1;
            else f->corner[3 * triangles + k] = f->local[c[k]] - 1;
        }
        triangles++;
    }
    f->near.triangle_count = triangles;
    if (f->corner != NULL) return;
    for (uint64_t v = 0; v < all->vertex_count; v++)
        if (f->local[v] != 0) f->local[v] = (uint32_t)++vertices;
    f->near.vertex_count = vertices;
}

static bvx_status open_around(flatten_job *f)
{
    bvx_context *const ctx = f->ctx;
    const bvx_grid *const g = f->window;
    bvx_mesh_view all;
    uint64_t bytes = 1;

    for (int a = 0; a < 3; a++) {
        /* Blocks over the window: what lies nearby is found by them. */
        f->block_size[a] = g->size[a] / FLATTEN_BLOCK + 1;
        f->block_origin[a] = g->lattice.origin[a] + g->lattice.spacing[a] * (double)g->low[a] -
                             f->mesh->frame[a];
        f->block_scale[a] = 1.0 / (g->lattice.spacing[a] * FLATTEN_BLOCK);
        bytes *= (uint64_t)f->block_size[a];
    }
    f->block_count = bytes;
    bvx_mesh_view_of(f->mesh, &all);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the blocks of thin walls", &f->blocks));
    mark_blocks_around(f, &all);
    /* Counted first, so that the arrays have their size. */
    take_around(f, &all);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, f->near.triangle_count * 12, "the triangles of thin walls",
                        &f->corner));
    BVXI_TRY(BVXI_ARRAY(ctx, f->near.vertex_count, "the numbers of vertices at thin walls", f->vertex));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, f->near.vertex_count * 24, "the places of vertices at thin walls",
                        &f->position));
    BVXI_TRY(BVXI_ARRAY(ctx, f->near.triangle_count, "the triangles that change", f->part));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, f->near.triangle_count * 12, "the triangles that change",
                        &f->part_corner));
    /* Listed by now, with the numbers found before. */
    take_around(f, &all);
    /* Their own numbers, so that checks cost what lies around walls, not the mesh. */
    for (uint64_t v = 0; v < all.vertex_count; v++)
        if (f->local[v] != 0) f->vertex[f->local[v] - 1] = (uint32_t)v;
    f->near.positions = f->position;
    f->near.position_type = BVX_F64;
    f->near.indices = f->corner;
    f->near.index_type = BVX_U32;
    return BVX_OK;
}

/* ---- Moving them ---- */

static void write_position(const flatten_job *f, const flatten_vertex *m)
{
    static const double share[3] = {1.0, 0.5, 0.0};
    /* As it was, or a share of the way; rounded as the mesh holds it. */
    for (int a = 0; a < 3; a++) {
        double const p = m->step == FLATTEN_STAYS ? m->from[a]
                                                  : m->from[a] + (m->to[a] - m->from[a]) * share[m->step];
        uint64_t const i = 3 * (uint64_t)m->vertex + (uint64_t)a;
        if (f->mesh->position_type == BVX_F32) ((float *)f->mesh->positions)[i] = (float)p;
        else ((double *)f->mesh->positions)[i] = p;
    }
}

/* v, t: among those around. */
static void mark_vertex(flatten_job *f, uint64_t v)
{
    uint32_t const number = f->number[f->vertex[v]];
    if (number == 0) return;
    flatten_vertex *const m = &f->moved[number - 1];
    /* It cannot go back further, or does already. */
    if (m->step == FLATTEN_STAYS || m->back) return;
    m->back = 1;
    f->marked++;
}

static void mark_triangle(flatten_job *f, uint64_t t)
{
    for (int k = 0; k < 3; k++) mark_vertex(f, f->corner[3 * t + (uint64_t)k]);
}

/* The blocks that a triangle reaches where it is now. t: among those around. */
static int reach_of_triangle(const flatten_job *f, uint64_t t, int32_t low[3], int32_t high[3])
{
    int changed = 0;

    for (int k = 0; k < 3; k++) {
        uint32_t const v = f->corner[3 * t + (uint64_t)k], number = f->number[f->vertex[v]];

        /* Of its own vertices any that has gone since the last look. */
        changed |= number != 0 && f->moved[number - 1].changed;
        for (int a = 0; a < 3; a++) {
            int32_t const at = block_along(f, a, f->position[3 * (uint64_t)v + (uint64_t)a]);
            if (k == 0 || at < low[a]) low[a] = at;
            if (k == 0 || at > high[a]) high[a] = at;
        }
    }
    return changed;
}

/* Triangles that meet what has changed lie in a block with it. Others met nothing before, or nothing that
 * could go back, and so it is still. */
static void take_changed(flatten_job *f)
{
    int32_t low[3], high[3];
    uint64_t count = 0;

    memset(f->blocks, 0, (size_t)f->block_count);

    for (uint64_t t = 0; t < f->near.triangle_count; t++)
        if (reach_of_triangle(f, t, low, high)) mark_block_range(f, low, high, 0, FLATTEN_REACHED);
    for (uint64_t t = 0; t < f->near.triangle_count; t++) {
        (void)reach_of_triangle(f, t, low, high);
        if (!reaches_marked_block(f, low, high)) continue;
        f->part[count] = (uint32_t)t;
        memcpy(f->part_corner + 3 * count++, f->corner + 3 * t, 12);
    }
    f->around_change = f->near;
    f->around_change.indices = f->part_corner;
    f->around_change.triangle_count = count;
    for (uint64_t n = 0; n < f->count; n++) f->moved[n].changed = 0;
}

static bvx_status mark_common_places(flatten_job *f, const bvx_mesh_view *view)
{
    uint64_t const bytes = view->vertex_count * 4;
    uint64_t different;
    uint32_t *same;

    BVXI_TRY(bvxi_alloc(f->ctx, BVXI_SCRATCH, bytes, "the places of vertices", &same));
    BVXI_TRY(bvxi_weld(f->ctx, view, same, &different));
    /* All at places of their own: nothing to look for. */
    for (uint64_t v = 0; different != view->vertex_count && v < view->vertex_count; v++) {
        if (same[v] == v) continue;
        mark_vertex(f, v);
        mark_vertex(f, same[v]);
    }
    bvxi_drop(f->ctx, same);
    return BVX_OK;
}

/* Aim the vertices of one body's thin walls. */
static bvx_status aim_at_body(flatten_job *f, int32_t body)
{
    double const from = 0.3 * body / f->body_count, to = 0.3 * (body + 1) / f->body_count;

    if (f->bodies[body].thin->near.where.words == NULL) return BVX_OK;
    f->asked = body;

    /* Searched anew: a tree kept since the walls were found would be there when memory is scarcest. */
    BVXI_TRY(bvxi_closest_open(bvxi_call_of(f->ctx, f->function, "thin", from, from + (to - from) / 3),
                               &f->bodies[body].thin->mesh, &f->closest));
    bvx_status const status = bvxi_each(f->ctx, "thin", from + (to - from) / 3, to, f->pieces, aim_piece, f);
    bvxi_closest_shut(f->ctx, &f->closest);
    return status;
}

static bvx_status move_around(flatten_job *f)
{
    BVXI_TRY(BVXI_ZEROS(f->ctx, f->mesh->vertex_count, "the vertices around thin walls", f->local));
    BVXI_TRY(open_around(f));

    bvx_mesh_view all;

    for (int32_t round = 0;; round++) {
        /* From the start, so that a step back replaces the way before. */
        for (uint64_t n = 0; n < f->count; n++) write_position(f, &f->moved[n]);
        if (round > FLATTEN_ROUNDS) return BVX_OK;
        bvx_mesh_view_of(f->mesh, &all);
        for (uint64_t v = 0; v < f->near.vertex_count; v++)
            bvxi_view_position(&all, f->vertex[v], f->position + 3 * v);
        take_changed(f);
        for (uint64_t t = 0; t < f->around_change.triangle_count; t++) {
            double p[3][3];
            const double *const corner[3] = {p[0], p[1], p[2]};
            bvxi_view_corners(&f->around_change, t, p);
            if (!bvxi_has_area(corner)) mark_triangle(f, f->part[t]);
        }
        /* Of all of them: vertices meet wherever triangles are. */
        BVXI_TRY(mark_common_places(f, &f->near));

        const bvx_mesh_view *const view = &f->around_change;
        bvx_context *const ctx = f->ctx;
        uint64_t count;
        uint32_t *pairs;

        BVXI_TRY(bvxi_crossing_pairs(ctx, view, UINT64_MAX, &pairs, &count));
        for (uint64_t n = 0; n < 2 * count; n++) mark_triangle(f, f->part[pairs[n]]);
        bvxi_drop(ctx, pairs);

        if (f->marked == 0) return BVX_OK;

        /* Later rounds take the neighbours along, the last one all. */
        for (uint64_t n = 0; n < f->count; n++) {
            flatten_vertex *const m = &f->moved[n];
            /* A change is what the next look goes by. */
            m->changed = m->back || (round >= FLATTEN_ROUNDS && m->step != FLATTEN_STAYS);
            if (round >= FLATTEN_ROUNDS) m->step = FLATTEN_STAYS;
            else if (m->back) m->step = round >= FLATTEN_SINGLE ? FLATTEN_STAYS : (uint8_t)(m->step + 1);
            m->back = 0;
        }
        f->marked = 0;
    }
}

bvx_status bvxi_move_apart(bvx_context *ctx, const char *function, const bvx_grid *window, uint32_t *number,
                           uint64_t count, const double *to, bvx_mesh *mesh)
{
    flatten_job f = {.ctx = ctx, .function = function, .window = window, .mesh = mesh, .number = number};
    bvx_mesh_view view;

    if (count == 0) return BVX_OK;
    f.count = count;
    bvx_mesh_view_of(mesh, &view);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, count * sizeof *f.moved, "the vertices that move", &f.moved));
    for (uint64_t v = 0; v < view.vertex_count; v++) {
        flatten_vertex *const m = number[v] != 0 ? &f.moved[number[v] - 1] : NULL;
        if (m == NULL) continue;
        bvxi_view_position(&view, v, m->from);
        memcpy(m->to, to + 3 * v, sizeof m->to);
        m->vertex = (uint32_t)v;
        m->changed = 1;
    }
    return move_around(&f);
}

bvx_status bvxi_flatten(bvx_context *ctx, const char *function, const bvxi_flat_body *bodies, int32_t count,
                        bvx_mesh *mesh)
{
    uint64_t const bytes = mesh->vertex_count * 4, mark = bvxi_scratch_begin(ctx);
    flatten_job f = {0};

    f.ctx = ctx;
    f.function = function;
    f.bodies = bodies;
    f.body_count = count;
    f.mesh = mesh;
    /* Any wall's grid has the window. */
    for (int32_t b = count; b-- > 0;)
        if (bodies[b].thin->near.where.words != NULL) f.window = &bodies[b].thin->near.where;
    if (f.window == NULL || mesh->vertex_count == 0) return BVX_OK;

    /* Which vertices, then where to, then what lies around them; then they move. */
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices beside thin walls", &f.number));
    bvx_mesh_view view;

    bvx_mesh_view_of(mesh, &view);
    for (uint64_t v = 0; v < view.vertex_count; v++) {
        double p[3];
        world_position(&f, &view, v, p);
        /* Numbers from 1; 0 stays where it is. */
        f.number[v] = thin_walls_at(&f, p) != 0 ? (uint32_t)++f.count : 0;
    }

    if (f.count != 0) {
        /* Vertices are shared by pieces, each with its own hint. */
        uint64_t const pieces = f.mesh->vertex_count / FLATTEN_GRAIN + 1;

        f.pieces = pieces < FLATTEN_PIECES ? (int32_t)pieces : FLATTEN_PIECES;
        BVXI_TRY(BVXI_ZEROS(f.ctx, f.count, "the vertices of thin walls", f.moved));
        for (uint64_t n = 0; n < f.count; n++) {
            f.moved[n].distance = -1;
            f.moved[n].changed = 1;
        }
        for (int32_t b = 0; b < f.body_count; b++) BVXI_TRY(aim_at_body(&f, b));
    }
    return bvxi_scratch_end(ctx, mark, f.count != 0 ? move_around(&f) : BVX_OK);
}
