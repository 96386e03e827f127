/* oblique_surface.c - the surface between inside and outside, tetrahedron by tetrahedron.
 *
 * Source: Doi, Koide. An efficient method of triangulating equi-valued surfaces by using tetrahedral cells.
 * 1991 (marching tetrahedra), over split cells and over the six of each other cell alike.
 *
 * A contour's vertex counts as outside, and all crossings next to it are at its place, as one vertex: what is
 * left of a triangle then has three different ones or goes. Signs are such that this keeps a manifold
 * (oblique_signs.c). Bodies that no contour touches are left out. */
#include "oblique/oblique.h"

#include "mesh/mesh.h"

/* ---- parts that contours leave open ---- */

/* Planes part space into cells, of which each contour point has one on either side. A part that comes into a cell
 * through one plane alone ends there; no contour is between it and another part that is in the cell but not on that
 * plane: tails and legs that few planes meet come off so. */

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

static void add_stretches(const bvxi_oblique *o, const uint32_t *joined, uint32_t plane, part_work *w)
{
    const bvxi_plane *const p = &o->plane[plane].plane;

    for (uint32_t c = 0; c < p->contour_count; c++) {
        uint64_t before = 0;
        for (uint32_t n = p->contour[c].first; n < p->contour[c].first + p->contour[c].count; n++) {
            const double *const at = o->given->points + 3 * (uint64_t)p->given[n];
            uint32_t const v = o->plane[plane].vertex[n];
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

static bvx_status find_apart(bvxi_oblique *o, uint32_t *joined)
{
    uint64_t const most = 2 * (uint64_t)o->point_count;
    part_work w = {0};

    BVXI_TRY(BVXI_ARRAY(o->ctx, most, "contours in cells", w.stretch));
    BVXI_TRY(BVXI_ARRAY(o->ctx, most, "contours in cells", w.key));
    BVXI_TRY(BVXI_ARRAY(o->ctx, most, "contours in cells", w.order));
    for (uint32_t i = 0; i < o->plane_count; i++) add_stretches(o, joined, i, &w);
    BVXI_TRY(bvxi_radix_sort(o->ctx, w.key, w.order, w.count));
    for (uint32_t i = 0, n; i < w.count; i += n) {
        for (n = 1; i + n < w.count && w.key[i + n] == w.key[i];) n++;
        /* Parts that end in a cell are joined to those that they end towards. */
        uint32_t const count = n < PARTS_IN_CELL ? n : PARTS_IN_CELL, *const cell = w.order + i;
        for (uint32_t k = 0; k < count; k++) {
            const part_stretch *const a = &w.stretch[cell[k]];
            int ends = 1;
            for (uint32_t j = 0; j < count; j++)
                ends &= w.stretch[cell[j]].root != a->root || w.stretch[cell[j]].plane == a->plane;
            if (!ends) continue;
            for (uint32_t j = 0; j < count; j++) {
                uint32_t const root = w.stretch[cell[j]].root;
                if (bvxi_root(joined, a->root) == bvxi_root(joined, root) ||
                    is_on_plane(&w, cell, count, root, a->plane))
                    continue;
                if (o->apart++ == 0) memcpy(o->apart_at, a->at, 24);
                bvxi_join(joined, a->root, root);
            }
        }
    }
    return BVX_OK;
}

/* ---- the surface ---- */

enum { HANDLE_ROUNDS = 3 };

#define ONE_PLACE 1e-12 /* of the contours' longest side */

/* ---- vertices ---- */

static bvx_status add_position(bvxi_oblique *o, const double at[3], uint32_t *number)
{
    BVXI_TRY(BVXI_GROW_BY(o, o->mesh.position, o->mesh.vertex_count, o->mesh.vertex_room, 24,
                          "the vertices of the surface"));
    for (int k = 0; k < 3; k++)
        o->mesh.position[3 * o->mesh.vertex_count + (uint64_t)k] = o->origin[k] + o->step * at[k];
    *number = (uint32_t)o->mesh.vertex_count++;
    return BVX_OK;
}

/* The vertex that plain cells have on an edge of the lattice, or BVXI_NONE. */
static uint32_t vertex_of_plain(const bvxi_oblique *o, uint32_t a, uint32_t b)
{
    const bvxi_tetra_vertex *const x = &o->vertex[a], *const y = &o->vertex[b];
    uint32_t const one = x->parent[1], two = y->parent[1];
    int32_t place[2][3];
    int up = 0, down = 0;
    uint32_t slot;

    if (!x->lattice || !y->lattice || one == BVXI_NONE || two == BVXI_NONE) return BVXI_NONE;
    for (int e = 0; e < 2; e++) {
        slot = e == 0 ? one : two;
        bvxi_oblique_block_place(o, o->known[slot / BVXI_BLOCK_SIZE], place[e]);
        for (int k = 0; k < 3; k++) place[e][k] += (int32_t)(slot >> 2 * k & 3);
    }
    /* All edges between vertices of the lattice run one step along some axes at once, up or down. */
    for (int k = 0; k < 3; k++) {
        up |= (place[1][k] > place[0][k]) << k;
        down |= (place[1][k] < place[0][k]) << k;
    }

    /* Edges belong to their lower end, and are numbered there by the axes that they run along. */
    slot = up != 0 ? one : two;
    return bvxi_oblique_plain_vertex(o, slot / BVXI_BLOCK_SIZE, (int)(slot % BVXI_BLOCK_SIZE), up | down);
}

/* Where an edge from inside to outside is crossed. */
static bvx_status edge_vertex(bvxi_oblique *o, uint32_t in, uint32_t out, uint32_t *number)
{
    const bvxi_tetra_vertex *const a = &o->vertex[in], *const b = &o->vertex[out];
    uint32_t *found;

    if (b->sign == 0) {
        if (o->output[out] == BVXI_NONE) BVXI_TRY(add_position(o, b->at, &o->output[out]));
        *number = o->output[out];
        return BVX_OK;
    }

    *number = vertex_of_plain(o, in, out);
    if (*number != BVXI_NONE) return BVX_OK;
    BVXI_TRY(bvxi_edge_add(o, &o->crossing, in, out, &found));
    if (*found == BVXI_NONE) {
        double at[3];
        bvxi_oblique_cross_edge(a->at, bvxi_absolute(a->value), b->at, bvxi_absolute(b->value), at);
        bvxi_oblique_cross_again(a->at, bvxi_absolute(a->value), b->at, bvxi_absolute(b->value),
                                 bvxi_oblique_number(o, at), at);
        BVXI_TRY(add_position(o, at, found));
    }
    *number = *found;
    return BVX_OK;
}

/* ---- triangles ---- */

/* Corners may be one vertex of a contour: a triangle is left then, or nothing. */
static bvx_status march_tetrahedron(bvxi_oblique *o, uint32_t tetra, int inside)
{
    const uint32_t *const v = o->tetra[tetra].v;
    uint8_t edge[4][2];
    uint32_t number[4];
    int const n = bvxi_oblique_case(inside, edge);
    for (int k = 0; k < n; k++) BVXI_TRY(edge_vertex(o, v[edge[k][0]], v[edge[k][1]], &number[k]));
    for (int k = 2; k < n; k++) {
        static const char what[] = "the triangles of the surface";
        uint32_t const corner[3] = {number[0], number[k - 1], number[k]};
        uint64_t const t = o->mesh.triangle_count - o->plain_triangles;

        if (corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]) continue;
        BVXI_TRY(BVXI_GROW_BY(o, o->mesh.triangle, o->mesh.triangle_count, o->mesh.triangle_room, 12, what));
        BVXI_TRY(BVXI_GROW(o, o->owner, t, o->owner_room, what));
        memcpy(o->mesh.triangle + 3 * o->mesh.triangle_count++, corner, sizeof corner);
        o->owner[t] = tetra;
    }
    return BVX_OK;
}

typedef struct march_job {
    bvxi_oblique *o;
    int32_t pieces;
    uint64_t triangles[BVXI_MOST_PIECES];
} march_job;

/* Which corners are inside, and how many triangles that makes at most. */
static void mark_inside_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    march_job *const job = user;
    const bvxi_oblique *const o = job->o;
    uint64_t triangles = 0;
    for (uint64_t t = begin; t < end; t++) {
        static const uint8_t many[16] = {0, 1, 1, 2, 1, 2, 2, 1, 1, 2, 2, 1, 2, 1, 1, 0};
        int inside = 0;
        for (int k = 0; k < 4; k++) inside |= (o->vertex[o->tetra[t].v[k]].sign > 0) << k;
        o->mark[t] = (uint8_t)inside;
        triangles += many[inside];
    }
    job->triangles[index] = triangles;
}

static bvx_status march_all(bvxi_oblique *o)
{
    march_job job = {.o = o, .pieces = bvxi_piece_count(o->tetra_count, 4096)};
    uint64_t more = 0;

    /* Also after handles have split tetrahedra. */
    bvxi_map_clear(&o->crossing);
    o->mesh.vertex_count = o->mesh.triangle_count = 0;
    BVXI_TRY(BVXI_RESERVE(o, o->output, o->vertex_count + 1, o->output_room, "the vertices on contours"));
    BVXI_TRY(BVXI_RESERVE(o, o->mark, o->tetra_count, o->mark_room, "the marks of tetrahedra"));
    memset(o->output, 0xff, (size_t)o->output_room * 4);

    /* Signs of lattice vertices that were settled are those of the lattice too. */
    for (uint64_t i = 0; i < o->vertex_count; i++) {
        const bvxi_tetra_vertex *const x = &o->vertex[i];
        if (x->lattice && x->sign != 0 && x->parent[1] != BVXI_NONE) o->value[x->parent[1]] = x->value;
    }
    BVXI_TRY(
        bvxi_for_pieces(o->ctx, "surface", 0.0, 0.1, job.pieces, o->tetra_count, mark_inside_piece, &job));
    for (int32_t i = 0; i < job.pieces; i++) more += job.triangles[i];
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.1, 0.4, bvxi_oblique_plain(o, more)));

    /* In order by their ends, but where contours have so many points that thousands of edges share an end. */
    o->crossing.near = o->point_count < o->vertex_count / 8;
    BVXI_TRY(bvxi_map_reserve(o->ctx, &o->crossing, more / 2));
    for (uint64_t t = 0; t < o->tetra_count; t++) {
        if (t % 262144 == 0)
            BVXI_TRY(bvxi_progress(o->ctx, "surface", 0.4 + 0.6 * (double)t / (double)o->tetra_count));
        /* All corners on one side: most of them, and nothing else of them is looked at. */
        if (o->mark[t] == 0 || o->mark[t] == 15) continue;
        BVXI_TRY(march_tetrahedron(o, (uint32_t)t, o->mark[t]));
    }
    return BVX_OK;
}

/* ---- what is kept ---- */

/* Handles of all bodies, of a closed surface: V - E + F = 2 (parts - handles), E = 3 F / 2. */
static bvx_status count_handles(bvxi_oblique *o, int64_t *handles)
{
    int64_t parts = (int64_t)o->mesh.vertex_count;
    uint32_t *joined;
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->mesh.vertex_count, "the parts of the surface", joined));
    for (uint64_t i = 0; i < o->mesh.vertex_count; i++) joined[i] = (uint32_t)i;
    for (uint64_t t = 0; t < o->mesh.triangle_count; t++)
        for (int k = 1; k < 3; k++)
            parts -= bvxi_join(joined, o->mesh.triangle[3 * t], o->mesh.triangle[3 * t + (uint64_t)k]);
    *handles = parts - ((int64_t)o->mesh.vertex_count - (int64_t)(o->mesh.triangle_count / 2)) / 2;
    return BVX_OK;
}

/* Most bodies have no handle, and then nothing of this is done. */
static bvx_status close_handles(bvxi_oblique *o)
{
    int64_t handles;
    uint64_t settled = 1;

    for (int round = 0; round < HANDLE_ROUNDS && settled > 0; round++) {
        uint64_t const vertices = o->vertex_count;
        BVXI_TRY(BVXI_SCOPE(o->ctx, count_handles(o, &handles)));
        if (handles <= 0 || o->mesh.triangle_count == o->plain_triangles) return BVX_OK;
        BVXI_TRY(BVXI_SHARE(o->ctx, (double)round / HANDLE_ROUNDS, (round + 0.7) / HANDLE_ROUNDS,
                            bvxi_oblique_handles(o, o->owner, &settled)));
        if (settled == 0 && o->vertex_count == vertices) return BVX_OK;
        BVXI_TRY(
            BVXI_SHARE(o->ctx, (round + 0.7) / HANDLE_ROUNDS, (round + 1.0) / HANDLE_ROUNDS, march_all(o)));
    }
    return BVX_OK;
}

static void oblique_count_unkept(bvxi_oblique *o, const uint32_t *renumbered)
{
    double const most = ONE_PLACE * o->longest * o->step;
    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t n = 0; n < p->point_count; n++) {
            uint32_t const v = o->plane[i].vertex[n];
            const double *const given = o->given->points + 3 * (uint64_t)p->given[n];
            int kept = v != BVXI_NONE && o->output[v] != BVXI_NONE && renumbered[o->output[v]] != BVXI_NONE;
            /* Points of two planes may be one place but for rounding: the first one's coordinates are both's. */
            for (uint64_t k = 0; k < 3 && kept; k++)
                kept = bvxi_absolute(o->mesh.position[3 * (uint64_t)o->output[v] + k] - given[k]) <= most;
            if (kept) continue;
            o->report.unkept_points++;
            bvxi_report_place(&o->report, given);
        }
    }
}

/* Bodies that hold most of some contour are marked at their roots: 2 for a small one alone, else 1. */
static void mark_bodies(bvxi_oblique *o, const uint32_t *joined)
{
    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t c = 0; c < p->contour_count; c++) {
            const bvxi_contour *const loop = &p->contour[c];
            uint32_t most = BVXI_NONE, lead = 0;
            /* the one with more than half of the points, if any (Boyer, Moore 1981), is the last to lead */
            for (uint32_t n = 0; n < loop->count; n++) {
                uint32_t const v = o->plane[i].vertex[loop->first + n];
                uint32_t const root = v == BVXI_NONE || o->output[v] == BVXI_NONE ? BVXI_NONE
                                                                                  : joined[o->output[v]];
                if (lead == 0) most = root;
                lead = root == most ? lead + 1 : lead - 1;
            }
            if (lead == 0 || most == BVXI_NONE) continue;
            /* A small one fits into a cell, wherever it begins. */
            double low[3] = {1e300, 1e300, 1e300}, high[3] = {-1e300, -1e300, -1e300};
            int small = 1;
            for (uint32_t n = 0; n < loop->count; n++)
                bvxi_widen(low, high, o->given->points + 3 * (uint64_t)p->given[loop->first + n], 3);
            for (int k = 0; k < 3; k++) small &= high[k] - low[k] <= o->step;
            o->kept[most] = o->kept[most] == 0 && small ? 2 : 1;
        }
    }
    for (uint64_t i = 0; i < o->mesh.vertex_count; i++) o->specks += o->kept[i] == 2;
}

/* Bodies with contours on them, their vertices numbered anew; joined becomes the new numbers. */
static bvx_status keep_bodies(bvxi_oblique *o, uint32_t *joined, uint64_t *vertices)
{
    uint64_t kept = 0;

    for (uint64_t i = 0; i < o->mesh.vertex_count; i++) joined[i] = (uint32_t)i;
    for (uint64_t t = 0; t < o->mesh.triangle_count; t++)
        for (int k = 1; k < 3; k++)
            bvxi_join(joined, o->mesh.triangle[3 * t], o->mesh.triangle[3 * t + (uint64_t)k]);
    for (uint64_t i = 0; i < o->mesh.vertex_count; i++) joined[i] = bvxi_root(joined, (uint32_t)i);
    memset(o->kept, 0, (size_t)o->mesh.vertex_count);
    mark_bodies(o, joined);
    BVXI_TRY(BVXI_SCOPE(o->ctx, find_apart(o, joined)));

    for (uint64_t t = 0; t < o->mesh.triangle_count; t++) {
        if (!o->kept[joined[o->mesh.triangle[3 * t]]]) continue;
        if (kept != t) memcpy(o->mesh.triangle + 3 * kept, o->mesh.triangle + 3 * t, 12);
        kept++;
    }
    o->mesh.triangle_count = kept;

    /* Vertices in the order in which triangles come to them; those of none have no number. */
    memset(joined, 0xff, (size_t)o->mesh.vertex_count * 4);
    *vertices = 0;
    for (uint64_t t = 0; t < 3 * o->mesh.triangle_count; t++) {
        uint32_t *const number = &joined[o->mesh.triangle[t]];
        if (*number == BVXI_NONE) *number = (uint32_t)(*vertices)++;
        o->mesh.triangle[t] = *number;
    }
    return BVX_OK;
}

bvx_status bvxi_oblique_surface(bvxi_oblique *o, bvx_mesh *mesh)
{
    uint32_t *joined;
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.0, 0.6, march_all(o)));
    BVXI_TRY(BVXI_SHARE(o->ctx, 0.6, 0.7, close_handles(o)));
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->mesh.vertex_count, "the parts of the surface", joined));
    BVXI_TRY(BVXI_ARRAY(o->ctx, o->mesh.vertex_count, "the parts of the surface", o->kept));
    uint64_t vertices;

    memset(o->kept, 0, (size_t)o->mesh.vertex_count);

    for (uint32_t i = 0; i < o->plane_count; i++) {
        const bvxi_plane *const p = &o->plane[i].plane;
        for (uint32_t n = 0; n < p->point_count; n++) {
            uint32_t const v = o->plane[i].vertex[n];
            if (v == BVXI_NONE || o->output[v] == BVXI_NONE || o->kept[o->output[v]]) continue;
            o->kept[o->output[v]] = 1; /* the first of two points at one vertex */
            memcpy(o->mesh.position + 3 * (uint64_t)o->output[v],
                   o->given->points + 3 * (uint64_t)p->given[n], 24);
        }
    }

    BVXI_TRY(keep_bodies(o, joined, &vertices));
    oblique_count_unkept(o, joined);
    if (o->mesh.triangle_count == 0)
        return bvxi_fail_for(o->ctx, BVX_ERR_EMPTY, BVX_REASON_EMPTY,
                             "%s: no point of the lattice lies inside; take more cells", o->function);
    if (o->mesh.triangle_count > INT32_MAX)
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the surface has more than 2^31 triangles", o->function);
    BVXI_TRY(bvxi_mesh_open(o->ctx, o->function, o->options.position_type, 0, vertices,
                            o->mesh.triangle_count, mesh));
    memcpy(mesh->triangles, o->mesh.triangle, (size_t)o->mesh.triangle_count * 12);
    for (uint64_t i = 0; i < o->mesh.vertex_count; i++) {
        const double *const at = o->mesh.position + 3 * i;
        if (joined[i] == BVXI_NONE) continue;
        bvxi_put_position(mesh, o->options.position_type, joined[i], at[0], at[1], at[2]);
    }
    return BVX_OK;
}
